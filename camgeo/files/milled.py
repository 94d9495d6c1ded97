"""A disc as milling programs make it."""

from __future__ import annotations

from typing import Protocol

from camgeo.toolpath.cut import Cut
from camgeo.toolpath.moves import Toolpath


class Milled(Protocol):
    """What programs make of a disc; `camgeo.views.milled.MilledDisc` is one."""

    @property
    def cuts(self) -> tuple[Cut, ...]:
        """What the milling program cuts, exactly."""

    def toolpath(self, tolerance: float) -> Toolpath:
        """The milling program; its arcs lie within `tolerance` [mm] of the exact cutter path."""
