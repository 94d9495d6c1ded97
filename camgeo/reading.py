"""Limits for files that are read, of any origin, which are checked before anything is parsed.

A file may be damaged, come from another program, or be made to do harm. Each limit is far above the
needs of a cam, and low enough that a file within it can neither exhaust the memory nor occupy the
machine. This module has the limits that several readers share; others are in the module of their
reader. docs/robustness.md lists all of them; `tests/hostile` checks that the readers keep them.
"""

from __future__ import annotations

import io
import os
import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from camgeo.errors import FileError
from camgeo.units import counted


@dataclass(frozen=True, slots=True)
class Limits:
    """The largest allowed size of a file of one kind.

    Attributes
    ----------
    kind : name of the kind in messages.
    size : in bytes.
    lines : number of lines of a text that is read line by line; None if that does not matter.
    """

    kind: str
    size: int
    lines: int | None = None


SCENE: Final = Limits("scene", 2_000_000)
"""10,000 segments with generous comments."""

TABLE: Final = Limits("table", 16_000_000, lines=400_000)
"""A table of lifts, speeds, loads, points or a contour: 200,000 rows, and as many comments."""

DRAWING_LINES: Final = 40_000_000
DRAWING: Final = Limits("DXF drawing", 256_000_000, DRAWING_LINES)
"""A polyline takes four lines for each vertex, a single line or arc about twenty: a million and a
half of these."""

PROGRAM_LINES: Final = 200_000
PROGRAM: Final = Limits("milling program", 16_000_000, PROGRAM_LINES)

INSTANCES: Final = 100_000
"""Most entities of a STEP file; a piece of a wall takes twenty."""

VERIFIED: Final = Limits("file to be verified", DRAWING.size)
"""A file of any format; the limit of the format itself may be lower."""

FACETS: Final = 150_000
"""Most facets of a mesh, counting all copies of its objects."""

CONTOURS: Final = 1_000
"""Most closed contours of a drawing."""

COORDINATE: Final = 1e9
"""Largest magnitude of a number in drawings, meshes and programs, in any unit."""

DIGITS: Final = 60
"""Most characters of such a number; exact doubles have no more than 24."""

KEY_PARTS: Final = 16
"""Most parts of a dotted key of TOML; scenes need four."""

MARKS: Final = 300_000
"""Most characters that begin a value or a part of a key in TOML: = , [ { and points."""

TABLES: Final = 40_000
"""Most tables of TOML: headers, inline tables, and dotted keys."""

QUOTED: Final = re.compile(
    r'"""(?:[^"\\]++|\\.?|"(?!""))*+(?:"{3,5})?'
    r"|'''(?:[^']++|'(?!''))*+(?:'{3,5})?"
    r'|"(?:[^"\\\n]++|\\.?)*+"?'
    r"|'[^'\n]*+'?"
    r"|#[^\n]*+",
    re.DOTALL,
)
"""Strings and comments of TOML. An unterminated one extends to the end of the line or the text, and
repetitions are possessive, so that no text is searched twice."""

DEEP: Final = re.compile(rf"(?<![\w-])(?:[\w-]++[ \t]*+\.[ \t]*+){{{KEY_PARTS}}}")
"""A dotted key of too many parts, in a text whose strings are replaced by a letter."""

DOTTED: Final = re.compile(r"(?<![\w-])(?:[\w-]++[ \t]*+\.[ \t]*+)++[\w-]++[ \t]*+[=\]]")
"""A dotted key, or the last number of an array, which is counted as well: there are few of these.
"""

HEADER: Final = re.compile(r"^[ \t]*+\[", re.MULTILINE)


def read_limited(path: Path, limits: Limits) -> bytes:
    """The bytes of the file at `path`.

    Raises
    ------
    FileError
        If it is larger than allowed; then it is not read.
    OSError, ValueError
        If it cannot be read; the latter for a path that no file can have.
    """
    with path.open("rb") as stream:
        size = os.fstat(stream.fileno()).st_size
        # One byte more than allowed shows a file without a size, such as a pipe, that is too large.
        data = stream.read(limits.size + 1) if size <= limits.size else b""
    check_size(max(size, len(data)), limits, path.name)
    return data


def check_size(size: int, limits: Limits, name: str) -> None:
    """Raise FileError if a file of `size` bytes is too large."""
    if size > limits.size:
        raise beyond(name, counted(size, "byte"), limits.size, limits)


def check_text(data: bytes, limits: Limits, name: str) -> None:
    """Raise FileError if a file is too large, or has too many lines."""
    check_size(len(data), limits, name)
    # Lines end with LF, CR, or both.
    lines = data.count(b"\n") + data.count(b"\r") - data.count(b"\r\n")
    if limits.lines is not None and lines > limits.lines:
        raise beyond(name, counted(lines, "line"), limits.lines, limits)


def beyond(name: str, size_text: str, allowed: float, limits: Limits) -> FileError:
    """The error for a file that has `size_text`, a number in words, where less is `allowed`."""
    return FileError(f"{name}: has {size_text}; at most {allowed:,} are allowed in a {limits.kind}")


def text_lines(data: bytes, encoding: str = "utf-8", newline: str | None = None) -> Iterator[str]:
    """The lines of a text one by one, without their ends: LF, CR or both, or `newline` alone.

    Bytes that `encoding` cannot decode become replacement characters; a byte order mark is dropped.
    """
    text = io.TextIOWrapper(io.BytesIO(data), encoding, errors="replace", newline=newline)
    for number, line in enumerate(text):
        content = line.removesuffix("\n")
        yield content.removeprefix("\N{BYTE ORDER MARK}") if number == 0 else content


def parse_number(text: str) -> float | None:
    """The number in `text`; None if there is none, or it is beyond the limits of a coordinate."""
    # float() also accepts underscores and the digits of other scripts.
    if len(text) > DIGITS or not text.isascii() or "_" in text:
        return None
    try:
        number = float(text)
    except ValueError:
        return None
    # NaN and infinite numbers fail this comparison as well.
    return number if abs(number) <= COORDINATE else None


def check_toml(text: str) -> None:
    """Raise FileError if the TOML `text` has too many values, or keys of too many parts.

    A parser makes a table of each part of a dotted key, and looks each one up from the root.
    """
    plain = QUOTED.sub(_blank, text)
    marks = sum(map(plain.count, "=,[{."))
    if marks > MARKS:
        raise FileError(
            f"has {marks:,} characters = , [ {{ and points, which begin values and parts of keys;"
            f" allowed: at most {MARKS:,}"
        )
    deep = DEEP.search(plain)
    if deep is not None:
        line = 1 + plain.count("\n", 0, deep.start())
        raise FileError(
            f"is nested too deeply: the key in line {line} has more than {KEY_PARTS} parts, the"
            " limit"
        )
    tables = plain.count("{") + sum(
        1 for pattern in (DOTTED, HEADER) for _ in pattern.finditer(plain)
    )
    if tables > TABLES:
        raise FileError(f"has {tables:,} tables and dotted keys; allowed: at most {TABLES:,}")


def _blank(quoted: re.Match[str]) -> str:
    """The replacement of a string or a comment, which keeps the numbers of the lines."""
    text = quoted[0]
    return "" if text[0] == "#" else "s" + "\n" * text.count("\n")
