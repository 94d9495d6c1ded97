"""The part in the plane: its closed boundaries, and on which side of each the material is."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

from camgeo.contour.contour import Contour
from camgeo.contour.fit import Effort, Fit
from camgeo.contour.spline import SplineContour, SplineFit


class Boundary(Protocol):
    """One closed boundary of the part.

    Attributes
    ----------
    name : "outline", "inner flank", "outer flank", "rim" or "bore".
    hole : True where the material lies outside of the boundary.
    """

    @property
    def name(self) -> str: ...

    @property
    def hole(self) -> bool: ...

    def arcs(self, tolerance: float, effort: Effort = "fewest") -> Fit:
        """Lines and arcs within `tolerance` [mm] of the exact boundary, counter-clockwise."""

    def polyline(self, tolerance: float, effort: Effort = "fewest") -> Fit:
        """Straight pieces within `tolerance` [mm] of the exact boundary, counter-clockwise."""

    def spline(self, tolerance: float, effort: Effort = "fewest") -> SplineFit:
        """Cubic splines and arcs within `tolerance` [mm] of the exact boundary,
        counter-clockwise.
        """

    def deviation(self, contour: Contour | SplineContour) -> float:
        """Proved upper bound [mm] of the distance between `contour` and the exact boundary."""


@dataclass(frozen=True, slots=True)
class Part:
    """The part: boundaries through its whole thickness, and those of a groove in its upper face.

    Attributes
    ----------
    through : boundaries of the body, the outermost first; then its holes.
    groove : () or (inner flank, outer flank) of the groove; the groove lies between the two.
    thickness : [mm], or None if the scene gives none: then there is a drawing but no solid.
    groove_depth : [mm] from the upper face; 0 without groove.
    """

    through: tuple[Boundary, ...]
    groove: tuple[Boundary, ...]
    thickness: float | None
    groove_depth: float

    @property
    def boundaries(self) -> tuple[Boundary, ...]:
        """All boundaries, in the order of drawing."""
        return self.through + self.groove
