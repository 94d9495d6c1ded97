"""Jobs that do what no job should; light, so that processes for them start soon."""

from __future__ import annotations

import io
import os
import sys
from collections.abc import Callable
from typing import Any

from camgeo.app.designing.children import Job


def prepared() -> Callable[[Job], dict[str, Any]]:
    """What does the jobs of this module."""
    return lambda job: JOBS[job.arguments.get("as", job.kind)](job)


def fine(job: Job) -> dict[str, Any]:
    os.write(1, b"what is printed is no result")
    return {"process": os.getpid(), "text": job.text}


def endless(_: Job) -> dict[str, Any]:
    while True:
        pass


def greedy(_: Job) -> dict[str, Any]:
    taken = []
    while True:
        taken.append(bytearray(50_000_000))


def gone(_: Job) -> dict[str, Any]:
    os._exit(3)


def broken(_: Job) -> dict[str, Any]:
    sys.stderr = io.StringIO()
    return {"a": [][0]}


def deep(_: Job) -> dict[str, Any]:
    found: dict[str, Any] = {}
    for _depth in range(100_000):
        found = {"a": found}
    return found


def infinite(_: Job) -> dict[str, Any]:
    sys.stderr = io.StringIO()
    return {"a": float("inf")}


JOBS = {each.__name__: each for each in (fine, endless, greedy, gone, broken, deep, infinite)}
JOBS["build"] = fine
