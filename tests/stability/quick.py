"""The suite's quick run, made once for all tests of its results; `tests.dealing` names them."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from typing import Final

from tests.long_form import LONG
from tests.stability.measure import Case, Reading
from tests.stability.suite import all_cases, run

CHEAP: Final = ("laws", "slotted-levers")
"""Groups of which each case is measured at two places in the usual form, too."""

SAME: Final = ("linkages", "extremes")
"""Groups of which a return or another scale is measured in the long form only: the formulas are
those of the rise, and `cams` has both.
"""

DEAR: Final = ("HC22 neck of a lobe", ("area of the disc",))
"""A case for the long form: an area takes as long as all cams together, and HC21c's is one."""


def remembering(case: Case) -> Case:
    """A case whose exact values, minutes of which are those of outlines, are computed once."""
    return replace(case, exact=cache(case.exact)) if case.group == "outlines" else case


CASES: Final = tuple(map(remembering, all_cases()))


def at_one_place(number: int, case: Case) -> Case:
    """Of two places of a case the first or, every second time, the last."""
    if LONG or case.group in CHEAP or len(case.places) == 1:
        return case
    return replace(case, places=case.places[:1] if number % 2 else case.places[-1:])


def is_usual(case: Case) -> bool:
    """Whether a case belongs to the usual form."""
    again = case.group in SAME and ("scale" in case.name or case.name.endswith(", return"))
    return LONG or not (again or (case.name, case.quantities) == DEAR)


@cache
def quick() -> tuple[Reading, ...]:
    cases = [at_one_place(*each) for each in enumerate(CASES) if is_usual(each[1])]
    return run(cases, quick=True)
