"""The suite's quick run, made once for all tests of its results; `tests.dealing` names them."""

from __future__ import annotations

from functools import cache

from camgeo.stability.measure import Reading
from camgeo.stability.suite import all_cases, run

CASES = all_cases()


@cache
def quick() -> tuple[Reading, ...]:
    return run(CASES, quick=True)
