"""Nanoseconds per point of s to s''' of a plan of six laws, relative to the functions they need.

The plan has six moves of 60 degrees by six different laws. It cannot do without a sine and a cosine
at each point at which a law runs on a sine: everywhere in five of them except the two constant
stretches of the modified trapezoid, nowhere in the polynomial. Both are timed on the same array of
cam angles, in the same run and in turns; arithmetic, memory and the search for the segment are not
counted on the bare side.


    python benchmarks/motion.py [--points 1000,10000,100000,1000000] [--rounds 15]
"""

from __future__ import annotations

import argparse
import functools
import itertools
import platform
import statistics
import time
from collections.abc import Callable
from decimal import Decimal
from typing import Final

import numpy as np

from camgeo.motion.plan import Move
from camgeo.motion.planning.planner import plan_motion
from camgeo.motion.planning.request import MoveRequest
from camgeo.units import TURN

MOVES: Final = (
    (10.0, "modified-sine", 1.0),
    (25.0, "inclined-sine", 1.0),
    (40.0, "modified-trapezoid", 0.5),
    (20.0, "polynomial-345", 0.0),
    (30.0, "harmonic-combination", 1.0),
    (0.0, "double-harmonic", 1.0),
)
"""Position at the end, law, and share of the move that runs on sines."""

LEAST_TIME: Final = 2e-3
"""A measurement is repeated until it takes this long [s], of which a clock tick is below 0.1 %."""


def nanoseconds(work: Callable[[], object], points: int) -> float:
    """Time of `work` [ns] for each of its points, once."""
    repeats, began = 0, time.perf_counter()
    while True:
        work()
        repeats += 1
        took = time.perf_counter() - began
        if took >= LEAST_TIME:
            return 1e9 * took / (repeats * points)


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--points", default="1000,10000,100000,1000000")
    parser.add_argument("--rounds", type=int, default=15)
    arguments = parser.parse_args()
    print(
        f"Python {platform.python_version()}, numpy {np.__version__}, {platform.machine()},"
        f" median of {arguments.rounds} rounds"
    )
    plan = plan_motion([MoveRequest(Decimal(60), to, law) for to, law, _ in MOVES])
    share = statistics.fmean(part for _, _, part in MOVES)
    laws = [segment.law for segment in plan.segments if isinstance(segment, Move)]
    print(", ".join(f"{law.name} {law.task}" for law in laws))
    print(f"{'points':>9}{'ns a point':>12}{'sin':>8}{'cos':>8}{'needed':>9}{'ratio':>8}")
    for points in map(int, arguments.points.split(",")):
        phi = np.linspace(0.0, TURN, points, endpoint=False)
        out = np.empty_like(phi)
        asked = (phi + start for start in itertools.count(0.0, 1e-9))  # none twice
        work: dict[str, Callable[[], object]] = {
            "jet": lambda asked=asked: plan.jet(next(asked)),  # type: ignore[misc]  # mypy infers no type for a lambda with defaults
            "sin": functools.partial(np.sin, phi, out=out),
            "cos": functools.partial(np.cos, phi, out=out),
        }
        times: dict[str, list[float]] = {name: [] for name in work}
        for call in work.values():
            call()
        for _ in range(arguments.rounds):
            for name, call in work.items():
                times[name].append(nanoseconds(call, points))
        jet, sine, cosine = (statistics.median(times[name]) for name in ("jet", "sin", "cos"))
        needed = share * (sine + cosine)
        print(
            f"{points:>9}{jet:>12.1f}{sine:>8.1f}{cosine:>8.1f}{needed:>9.1f}{jet / needed:>8.2f}"
        )


if __name__ == "__main__":
    main()
