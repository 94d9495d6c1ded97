"""Which cases of a test with many run in a usual run of all tests; in the long form all do.

`benchmarks/test_suite.py --write` measures what functions take: of the cases of those that take
longer than `MOST` one of each so many runs that they take about that. Where a function begins
follows from its name, so that no scene of those that many sweep is left out by all. Whoever names
single tests (`FILE::TEST`) gets all.
"""

from __future__ import annotations

import json
import math
import os
import zlib
from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import Final, TypeVar

from tests.long_form import LONG

TESTS: Final = Path(__file__).with_name("expensive_tests.json")

MOST: Final = 0.3
"""CPU time [s] of the cases of one function that run."""

EXPENSIVE: Final[dict[str, float]] = json.loads(TESTS.read_text("utf-8"))
"""CPU time [s] of all cases of functions with several of them, by module and name."""

SHARED: Final = frozenset({"tests/answers/test_kept.py::test_what_is_said_is_as_kept"})
"""Functions of which each case takes a `share` itself."""

WHOLE: Final = LONG or bool(os.environ.get("CAMGEO_EVERY_CASE"))
"""Whether all cases run."""


T = TypeVar("T")


def share(items: Sequence[T], one_of: int) -> Sequence[T]:
    """Of `items` that a single test goes through, those of a usual run: one of so many."""
    return items if WHOLE else items[::one_of]


def function_of(test: str) -> str:
    """The name of a test without its parameters."""
    return test.partition("[")[0]


def kept(tests: Sequence[str], expensive: dict[str, float]) -> list[bool]:
    """Whether each of `tests` runs, of functions that are as `expensive`."""
    cases = Counter(map(function_of, tests))
    seen: Counter[str] = Counter()
    found = []
    for name in map(function_of, tests):
        seconds = 0.0 if name in SHARED else expensive.get(name, 0.0)
        every = min(math.ceil(seconds / MOST) or 1, cases[name])
        found.append(seen[name] % every == zlib.crc32(name.encode()) % every)
        seen[name] += 1
    return found
