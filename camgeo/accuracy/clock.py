"""Seconds that something takes."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Final, TypeVar

Result = TypeVar("Result")

RUNS: Final = 3
"""Runs at most, the quickest of which counts: what else a machine does only makes things slower."""

PATIENCE: Final = 0.2
"""Seconds after which nothing is run again."""


def timed(work: Callable[[], Result]) -> tuple[Result, float]:
    """What `work` returns, and its seconds."""
    start = time.perf_counter()
    result, best, total = work(), float("inf"), 0.0
    for run in range(RUNS):
        if run:
            start = time.perf_counter()
            result = work()
        elapsed = time.perf_counter() - start
        best, total = min(best, elapsed), total + elapsed
        if total > PATIENCE:
            break
    return result, best
