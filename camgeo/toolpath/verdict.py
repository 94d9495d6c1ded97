"""The verdict on a program: what its simulation finds, and what of it must not be run."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from typing import Final

from camgeo.check.finding import Finding
from camgeo.part.part import Part
from camgeo.toolpath.cut import Cut
from camgeo.toolpath.guard import LOOSE_CORE
from camgeo.toolpath.judged import runs_of, setup_of
from camgeo.toolpath.milling import MillingSpec
from camgeo.toolpath.moves import Toolpath
from camgeo.toolpath.simulation import ALLOWED, simulate
from camgeo.toolpath.stages import Flaw

FINENESS: Final = 1e-3
"""Of the contours with which the part is compared [mm]."""


def flaws_of(
    toolpath: Toolpath, part: Part, milling: MillingSpec, tolerance: float
) -> tuple[Flaw, ...]:
    """What is wrong with a program planned within `tolerance` [mm], and what is to be watched."""
    cuts, runs = [operation.cut for operation in toolpath.operations], runs_of(toolpath)
    setup = setup_of(cuts, runs, part, milling.stock, milling.holding, FINENESS)
    found = simulate(setup, runs, allowed=ALLOWED + tolerance)
    return settled(found.flaws, milling, cuts, part)


def settled(
    flaws: Iterable[Flaw], milling: MillingSpec, cuts: Iterable[Cut], part: Part
) -> tuple[Flaw, ...]:
    """The flaws, of which a rest is one to be watched if the operations that the scene states leave
    a wall of the part unfinished.
    """
    finished = {name for cut in cuts for name in finished_by(cut)}
    left = milling.operations and any(wall.boundary.name not in finished for wall in part.walls)
    return tuple(
        replace(each, watched=True) if left and each.name == "rest" else each for each in flaws
    )


def finished_by(cut: Cut) -> tuple[str, ...]:
    """Names of the walls that a cut leaves as they are to be."""
    return () if cut.allowance else cut.produced


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
