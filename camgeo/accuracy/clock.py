"""Seconds of work: CPU time of this process, the median of several runs, and how far they differ.

Other work on a machine makes a run wait, which is in no CPU time, and slows it down by what they
share, the caches above all, which is in all of its runs. So a row is run several times, and all its
steps with it: their medians belong together.
"""

from __future__ import annotations

import math
import statistics
import time
from collections import defaultdict
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Final, TypeVar

Result = TypeVar("Result")

RUNS: Final = 3
"""Fewest runs of what takes less than `LONG`."""

SHORT_RUNS: Final = 5
"""Fewest runs of what takes less than `SHORT`."""

MOST_RUNS: Final = 15
"""Most runs, where they are short and differ."""

ALIKE: Final = 1.15
"""Spread up to which `SHORT_RUNS` are enough."""

SHORT: Final = 0.3
"""CPU time [s] of all runs from which on there are no more than `RUNS`."""

LONG: Final = 1.0
"""CPU time [s] of all runs after which nothing is run again."""


@dataclass(frozen=True, slots=True)
class Timing:
    """The CPU time of some steps.

    Attributes
    ----------
    seconds : the median of each, by name.
    spread : of all of them together, see `repeated`.
    """

    seconds: Mapping[str, float]
    spread: float


class Clock:
    """The CPU time of the steps of one run, by name."""

    def __init__(self) -> None:
        self.seconds: defaultdict[str, float] = defaultdict(float)

    def step(self, name: str, work: Callable[[], Result]) -> Result:
        """The result of `work`, whose time counts for the step `name`."""
        start = time.process_time()
        result = work()
        self.seconds[name] += time.process_time() - start
        return result


def repeated(run: Callable[[Clock], Result], most_runs: int = MOST_RUNS) -> tuple[Result, Timing]:
    """The result of `run`, which does all its work in steps of the clock, and what they take.

    It is called several times. Medians, and the spread, the ratio of the upper quartile to the
    lower one, are those of all runs but the first, which fills the caches of the motion; the spread
    of one run is 1.
    """
    clocks: list[Clock] = []
    totals: list[float] = []
    while _again(totals, most_runs):
        clocks.append(Clock())
        result = run(clocks[-1])
        totals.append(math.fsum(clocks[-1].seconds.values()))
    counted = [each.seconds for each in (clocks[1:] if len(clocks) >= RUNS else clocks)]
    medians = {name: statistics.median(each[name] for each in counted) for name in counted[0]}
    return result, Timing(medians, _spread(totals))


def _again(totals: Sequence[float], most_runs: int) -> bool:
    """Whether there is to be another run after those that took `totals` [s]."""
    count, spent = len(totals), math.fsum(totals)
    if count < min(RUNS, most_runs):
        return spent < LONG
    return count < most_runs and spent < SHORT and (count < SHORT_RUNS or _spread(totals) > ALIKE)


def _spread(totals: Sequence[float]) -> float:
    counted = totals[1:] if len(totals) >= RUNS else totals
    if len(counted) < 2 or min(counted) <= 0.0:
        return 1.0
    lower, _, upper = statistics.quantiles(counted, n=4, method="inclusive")
    return upper / lower
