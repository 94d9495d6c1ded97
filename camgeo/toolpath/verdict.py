"""The verdict on a planned program: what its simulation finds, as findings."""

from __future__ import annotations

from typing import Final

from camgeo.check.finding import Finding
from camgeo.part.part import Part
from camgeo.toolpath.guard import LOOSE_CORE
from camgeo.toolpath.judged import runs_of, setup_of
from camgeo.toolpath.milling import MillingSpec
from camgeo.toolpath.moves import Toolpath
from camgeo.toolpath.simulation import simulate

FINENESS: Final = 1e-3
"""Of the contours with which the part is compared [mm]."""


def verdict(toolpath: Toolpath, part: Part, milling: MillingSpec) -> tuple[Finding, ...]:
    """What a machinist must not run, "broken", and what is to be watched, "warning"."""
    setup = setup_of(toolpath, part, milling.stock, milling.holding, FINENESS)
    return tuple(
        Finding(
            LOOSE_CORE if each.name == "loose" and each.watched else each.name,
            "warning" if each.watched else "broken",
            each.sentence,
            each.value,
            each.limit,
            each.unit,
        )
        for each in simulate(setup, runs_of(toolpath)).flaws
    )
