"""What goes through the pipes between the designer and the processes that compute for it."""

from __future__ import annotations

import struct
from typing import IO, Final, Literal

HEAD: Final = struct.Struct(">cQ")
"""Head of a frame: its mark, and how many bytes follow."""

Mark = Literal[b"J", b"W", b"R", b"M"]
"""J: a job, or the JSON of its result. W: the process is warm. R: a sentence that says why there is
no result. M: the same because memory ran out, after which the process ends."""

LARGEST_RESULT: Final = 200_000_000
"""Bytes of a result as JSON: the files of a large part in all formats."""

MARKS: Final[dict[bytes, Mark]] = {b"J": b"J", b"W": b"W", b"R": b"R", b"M": b"M"}


class BrokenFrame(Exception):
    """The other end is gone, or what it sent is not a frame of an allowed size."""


def send(stream: IO[bytes], mark: Mark, data: bytes = b"") -> None:
    """Write a frame; OSError or ValueError if the other end is gone."""
    stream.write(HEAD.pack(mark, len(data)) + data)
    stream.flush()


def receive(stream: IO[bytes], most: int) -> tuple[Mark, bytes]:
    """The next frame, with at most `most` bytes of data.

    Raises
    ------
    BrokenFrame
        If there is none.
    """
    try:
        head = _exactly(stream, HEAD.size)
        mark, size = HEAD.unpack(head)
        if mark not in MARKS or size > most:
            raise BrokenFrame
        return MARKS[mark], _exactly(stream, size)
    except (OSError, ValueError) as error:  # a stream closed in the meantime
        raise BrokenFrame from error


def _exactly(stream: IO[bytes], size: int) -> bytes:
    data = stream.read(size)
    if len(data) < size:
        raise BrokenFrame
    return data
