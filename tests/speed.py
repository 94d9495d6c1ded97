"""Computing time in units of the machine: a limit in them is the same on a slow and a busy one.

Where a test can count what is done (cells, evaluations, bytes), it does; else it measures processor
time, never time itself, and states its limit in `cpu_second()`, four times what is measured.
"""

from __future__ import annotations

import os
import subprocess
import sys
import time
from collections.abc import Generator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Final

STARTS: Final = 5
"""So many starts of an interpreter with numpy are one second: about half of a real one."""

RUNS: Final = 3
"""The fastest of so many is taken; nothing makes one faster than the machine is."""

KEPT: Final = "CAMGEO_CPU_SECOND"
"""Variable of the environment by which processes that a test starts know what was measured."""

START: Final = "import numpy, time; print(time.process_time())"


def cpu() -> float:
    """Processor time [s] that this process has used."""
    return time.process_time()


def cpu_second() -> float:
    """Processor time [s] of this machine for what is called a second of computing."""
    if KEPT not in os.environ:
        os.environ[KEPT] = repr(STARTS * min(_started() for _ in range(RUNS)))
    return float(os.environ[KEPT])


def _started() -> float:
    one = dict.fromkeys(("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS"), "1")
    call = [sys.executable, "-c", START]
    return float(subprocess.check_output(call, env=os.environ | one, text=True))


@dataclass(slots=True)
class Spent:
    """What was spent inside of `spending`, in seconds of computing."""

    seconds: float = 0.0


@contextmanager
def spending() -> Generator[Spent]:
    """Measure what is done inside."""
    spent, unit = Spent(), cpu_second()
    began = cpu()
    try:
        yield spent
    finally:
        spent.seconds = (cpu() - began) / unit
