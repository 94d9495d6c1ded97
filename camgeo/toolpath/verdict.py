"""The verdict on a program: what its simulation finds, and what of it must not be run."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import Final

from camgeo.check.finding import Finding
from camgeo.part.part import Wall
from camgeo.toolpath.bench import Bench, is_open
from camgeo.toolpath.cut import AreaCut, Cut
from camgeo.toolpath.guard import LOOSE_CORE
from camgeo.toolpath.holding import Holding
from camgeo.toolpath.stages import Flaw

FINENESS: Final = 1e-3
"""Of the contours with which the part is compared [mm]."""


def finished_by(cut: Cut) -> tuple[str, ...]:
    """Names of the walls that a cut leaves as they are to be."""
    return () if cut.allowance else cut.produced


def finished_down_to(cuts: Iterable[Cut], name: str) -> float:
    """Z down to which cuts leave a wall as it is to be [mm]; infinite if none does."""
    return min((cut.bottom for cut in cuts if name in finished_by(cut)), default=math.inf)


def lowest_of(wall: Wall, holding: Holding | None) -> float:
    """Z down to which a wall is to be cut [mm]: a skin is left, to be removed by hand."""
    return wall.z0 + (0.0 if holding is None else holding.skin or 0.0)


def done_by(bench: Bench, cuts: Iterable[Cut]) -> frozenset[str]:
    """Names of the walls that are done with the cuts of one side; of a planned sequence all that
    tools reach: what it leaves out is there, or made otherwise.
    """
    if bench.milling.operations:
        cuts = tuple(cuts)
        names = ((wall, wall.boundary.name) for wall in bench.part.walls)
        return frozenset(
            name for wall, name in names
            if finished_down_to(cuts, name) <= lowest_of(wall, bench.milling.holding)
        )  # fmt: skip
    return frozenset(wall.boundary.name for wall in bench.part.walls if is_open(bench.part, wall))


def faces(cut: Cut) -> bool:
    """Whether a cut takes off all that lies above the part."""
    return isinstance(cut, AreaCut) and not cut.walls


def verdict(flaws: Iterable[Flaw]) -> tuple[Finding, ...]:
    """What a machinist must not run, "broken", and what is to be watched, "warning"."""
    return tuple(
        Finding(
            LOOSE_CORE if each.name == "loose" and each.watched else each.name,
            "warning" if each.watched else "broken",
            each.sentence,
            each.value,
            each.limit,
            each.unit,
        )
        for each in flaws
    )
