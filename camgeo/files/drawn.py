"""A disc as drawings and solids show it."""

from __future__ import annotations

from typing import Protocol

from camgeo.contour.contour import Contour
from camgeo.contour.fit import Effort, Fit
from camgeo.part.part import Part


class Drawn(Protocol):
    """What drawings and solids show of a disc; `camgeo.views.drawn.DrawnDisc` is one."""

    @property
    def effort(self) -> Effort:
        """How hard the fits of its contours try."""

    @property
    def part(self) -> Part: ...

    @property
    def base_radius(self) -> float:
        """Radius r_G of the base circle of the pitch curve [mm]."""

    @property
    def has_pitch_curve(self) -> bool:
        """Whether there is a pitch curve beside the outline; with a flat face there is none."""

    def pitch_contour(self, tolerance: float) -> Fit:
        """The pitch curve as lines and arcs within `tolerance` [mm], counter-clockwise."""

    def pitch_deviation(self, contour: Contour) -> float:
        """Proved bound [mm] of the distance between `contour` and the pitch curve."""
