"""Jobs of a session: for which text each is done, how long it may take, and which are given up."""

from __future__ import annotations

import asyncio
import json
import re
import time
from collections.abc import Callable, Container, Mapping
from concurrent.futures import ThreadPoolExecutor
from typing import Any, Final

from camgeo.designing.children import Result
from camgeo.designing.desk import Desk
from camgeo.designing.job import Job

Compute = Callable[[Job, float], Result]
"""Does a job within some seconds, in a process of its own; a CamgeoError if it has no result."""

SECONDS: Final[Mapping[str, float]] = {
    "curves": 10.0,
    "change": 10.0,
    "laws": 10.0,
    "templates": 10.0,
    "effects": 10.0,
    "findings": 60.0,
    "solid": 60.0,
    "size": 120.0,
    "build": 600.0,
}
"""Most seconds that each kind of job may take."""

PICTURES: Final = ("curves", "change")
"""Kinds of jobs whose results are shown at once."""

DECODER: Final = json.JSONDecoder()

THREADS: Final = 16
"""Most threads that wait for processes: more than there can be jobs."""


SPACE: Final = re.compile(r"[ \t\r\n,:]*")
"""What separates keys and values."""


def head_of(text: bytes, last: Container[str]) -> dict[str, Any]:
    """The members of a JSON object up to the first whose key is one of `last`, or all.

    What follows, pictures say, is not read: that takes longer than all else that is done here.
    """
    decoded = text.decode()
    found: dict[str, Any] = {}
    at = _after_space(decoded, decoded.index("{") + 1)
    while decoded[at] != "}":
        key, at = DECODER.raw_decode(decoded, at)
        found[key], at = DECODER.raw_decode(decoded, _after_space(decoded, at))
        if key in last:
            break
        at = _after_space(decoded, at)
    return found


def _after_space(text: str, at: int) -> int:
    found = SPACE.match(text, at)
    return at if found is None else found.end()


class Jobs:
    """Does the jobs of a session, each for the text that is on the desk when it begins.

    Parameters
    ----------
    desk : with the scene.
    compute : what does a job; it is called in threads.
    cancel : ends the job of a kind that is being done.
    """

    def __init__(self, desk: Desk, compute: Compute, cancel: Callable[[str], None]) -> None:
        self._desk = desk
        self._compute, self._cancel = compute, cancel
        self._threads = ThreadPoolExecutor(THREADS, "camgeo-designer")
        self._began: dict[str, list[float]] = {}
        self._painted = 0.0

    @property
    def idle(self) -> float:
        """Seconds since the last picture was computed; 0 while one is."""
        if any(self._began.get(kind) for kind in PICTURES):
            return 0.0
        return time.monotonic() - self._painted

    async def do(self, kind: str, arguments: Mapping[str, Any] | None = None) -> Result:
        """The result of a job; CamgeoError if there is none."""
        desk = self._desk
        file = "" if desk.opened is None else str(desk.opened.path)
        job = Job(kind, desk.text, file, str(desk.beside), arguments or {})
        began = self._began.setdefault(kind, [])
        began.append(now := time.monotonic())
        try:
            loop = asyncio.get_running_loop()
            return await loop.run_in_executor(self._threads, self._compute, job, SECONDS[kind])
        finally:
            began.remove(now)
            if kind in PICTURES:
                self._painted = time.monotonic()

    def give_up(self, kind: str, patience: float, *, unless: str = "") -> None:
        """End jobs of a kind that were begun more than `patience` seconds ago.

        Nothing is ended while there is a job `unless`, which the same process does.
        """
        began = self._began.get(kind)
        if began and not self._began.get(unless) and time.monotonic() - began[0] > patience:
            self._cancel(kind)

    def close(self) -> None:
        """Wait for nothing more; threads end when the processes do."""
        self._threads.shutdown(wait=False, cancel_futures=True)
