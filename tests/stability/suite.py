"""The suite: all cases by group, the selection to run, and the table of results."""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Iterable, Mapping
from dataclasses import dataclass, replace
from typing import Final

from tests.stability import cams, extremes, faces, laws, outlines, slotted_levers, tables
from tests.stability.cams import CAMS, LINKAGES, CamSpec, cases_of
from tests.stability.measure import Case, Reading, measure

GROUPS: Final[Mapping[str, Callable[[], tuple[Case, ...]]]] = {
    laws.GROUP: laws.cases,
    tables.GROUP: tables.cases,
    CAMS: lambda: _of_each(cams.specs(), cases_of),
    faces.GROUP: lambda: _of_each(faces.specs(), faces.cases_of),
    LINKAGES: lambda: _of_each(cams.linked_specs(), cases_of),
    slotted_levers.GROUP: slotted_levers.cases,
    extremes.GROUP: extremes.cases,
    outlines.GROUP: outlines.cases,
}
"""The cases of each part of the suite; those listed here are run, tested and drawn."""

LIMIT: Final = 64.0
"""Largest ratio of error to conditioning that passes. Fewer than 128 operations, including those of
the law, lie between the cam angle and any quantity, each rounded by at most half an ulp. If none of
them does more harm than half an ulp of an input, all together do less than 64 times the harm of the
inputs. Above the limit one of them loses digits that the inputs still have."""


@dataclass(frozen=True, slots=True)
class Row:
    """The result for one quantity.

    Attributes
    ----------
    quantity : its name.
    count : number of its values that were compared.
    largest_error, largest_ratio : the worst readings of each.
    """

    quantity: str
    count: int
    largest_error: Reading
    largest_ratio: Reading

    @property
    def within_limit(self) -> bool:
        """Whether no ratio is above the limit."""
        return self.largest_ratio.ratio <= LIMIT


def all_cases() -> tuple[Case, ...]:
    """Every case, group by group."""
    return tuple(case for make in GROUPS.values() for case in make())


def names(cases: Iterable[Case]) -> tuple[str, ...]:
    """The names that `run` accepts: groups, quantities, cases, each once, in this order."""
    cases = tuple(cases)
    found = [case.group for case in cases]
    found += [quantity for case in cases for quantity in case.quantities]
    found += [case.name for case in cases]
    return tuple(dict.fromkeys(found))


def run(
    cases: Iterable[Case],
    only: Collection[str] = (),
    *,
    quick: bool = False,
    progress: Callable[[str], None] = lambda _: None,
) -> tuple[Reading, ...]:
    """The readings of the cases.

    Parameters
    ----------
    cases : what to run.
    only : names of groups, quantities and cases; readings of others are omitted. If empty, all.
    quick : two places of each case only.
    progress : called with the name of each case as it begins.
    """
    readings: list[Reading] = []
    for case in cases:
        whole = not only or case.group in only or case.name in only
        if not whole and not set(case.quantities) & set(only):
            continue
        progress(f"{case.group}: {case.name}")
        found = measure(replace(case, places=_two_of(case.places)) if quick else case)
        readings += [each for each in found if whole or each.quantity in only]
    return tuple(readings)


def table(readings: Iterable[Reading]) -> tuple[Row, ...]:
    """A row for each quantity, the largest ratio first."""
    by_quantity: dict[str, list[Reading]] = {}
    for reading in readings:
        by_quantity.setdefault(reading.quantity, []).append(reading)
    rows = [
        Row(
            quantity,
            len(found),
            max(found, key=lambda each: each.error),
            max(found, key=lambda each: each.ratio),
        )
        for quantity, found in by_quantity.items()
    ]
    return tuple(sorted(rows, key=lambda row: (-row.largest_ratio.ratio, row.quantity)))


def worst_of_cases(readings: Iterable[Reading]) -> tuple[Reading, ...]:
    """For a picture, the largest error and the largest ratio of each quantity of each case.

    All readings would overlap. Where camgeo gave no value there is no point.
    """
    by_case: dict[tuple[str, str, str], list[Reading]] = {}
    for reading in readings:
        if math.isfinite(reading.error):
            key = (reading.quantity, reading.group, reading.case)
            by_case.setdefault(key, []).append(reading)
    worst: list[Reading] = []
    for found in by_case.values():
        worst.append(max(found, key=lambda each: each.error))
        worst.append(max(found, key=lambda each: each.ratio))
    return tuple(dict.fromkeys(worst))


def _two_of(places: tuple[float, ...]) -> tuple[float, ...]:
    """The first place, nearest to the start of a move, and the middle one."""
    return tuple(dict.fromkeys((places[0], places[len(places) // 2])))


def _of_each(
    specs: Iterable[CamSpec], cases_of: Callable[[CamSpec], list[Case]]
) -> tuple[Case, ...]:
    return tuple(case for spec in specs for case in cases_of(spec))
