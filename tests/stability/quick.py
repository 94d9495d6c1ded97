"""The suite's quick run, made once for all tests of its results, which form one group."""

from __future__ import annotations

from functools import cache

import pytest

from camgeo.stability.measure import Reading
from camgeo.stability.suite import all_cases, run

CASES = all_cases()

together = pytest.mark.xdist_group("stability")


@cache
def quick() -> tuple[Reading, ...]:
    return run(CASES, quick=True)
