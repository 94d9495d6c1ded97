"""What every closed boundary of a part can do."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any, Final, Literal, Protocol, overload

from camgeo.contour.contour import Contour, Effort, Fit, Form
from camgeo.contour.spline import SplineContour, SplineFit
from camgeo.errors import GeometryError
from camgeo.numeric.checked import shown
from camgeo.outline.moments import Moments, SecondMoments

WRITTEN_SHARE: Final = 0.98
"""Share of the tolerance that the fit of a written contour may use; the rest is for rounding to the
nearest double and for the slack of the bound by which the file is measured."""


class Boundary(Protocol):
    """One closed boundary of the part.

    Attributes
    ----------
    name : its identity, unique in the part: "outline", "inner flank", "outer flank", "rim", "bore",
        "hub", "lower hub", "mark".
        Faces of a solid, dimensions and milling operations refer to it.
    hole : True if the material lies outside the boundary.
    """

    @property
    def name(self) -> str: ...

    @property
    def hole(self) -> bool: ...

    @property
    def corner_radius(self) -> float | None:
        """Radius [mm] of the smallest arc that ends at a corner; None if there is none."""

    def arcs(self, tolerance: float, effort: Effort = "fewest") -> Fit:
        """Lines and arcs within `tolerance` [mm] of the exact boundary, counter-clockwise."""

    def beside(self, tolerance: float) -> Fit:
        """Lines and arcs within `tolerance` [mm] from which distances are taken, with no library;
        that they do not cross themselves is not shown.
        """

    def polyline(self, tolerance: float, effort: Effort = "fewest") -> Fit:
        """Straight pieces within `tolerance` [mm] of the exact boundary, counter-clockwise."""

    def sampled(self, tolerance: float) -> Contour:
        """Straight pieces for pictures, counter-clockwise: where a flank was sampled, they are
        within `tolerance` [mm] of it. Nothing is proved.
        """

    def spline(self, tolerance: float, effort: Effort = "fewest") -> SplineFit:
        """Cubic splines and arcs within `tolerance` [mm] of the exact boundary,
        counter-clockwise.
        """

    def deviation(self, contour: Contour | SplineContour) -> float:
        """Proved upper bound [mm] on the distance between `contour` and the exact boundary."""

    def offset(self, distance: float) -> Boundary:
        """The path of a cutter's centre at `distance` [mm], on the side without material.

        A hole gives a hole. Raises GeometryError if the boundary has no such parallel curve.
        """

    def inset(self, distance: float, name: str) -> Boundary:
        """The exact parallel at `distance` [mm] within the material, with a name of its own.

        Nothing is trimmed: `camgeo.part.bevels` makes sure that there is such a parallel. Corners
        of lines and arcs stay corners; of a flank there are none, or GeometryError is raised.
        """

    def moments(self, tolerance: float) -> Moments:
        """Area and first moments of all that it encloses, counter-clockwise.

        `tolerance` is a share, see `camgeo.outline.moments.path_moments`.
        """

    def second_moments(self, tolerance: float) -> SecondMoments:
        """Second moments of all that it encloses, counter-clockwise; see `moments`."""

    def farthest(self) -> tuple[float, float | None]:
        """Largest distance from the cam axis [mm]; of a flank, with the first cam angle [rad] at
        which that is in contact.
        """

    def nearest(self) -> float:
        """Smallest distance from the cam axis [mm]; 0 if the axis lies outside."""


@overload
def written_contour(
    boundary: Boundary,
    form: Literal["arcs", "polyline"],
    effort: Effort,
    tolerance: float,
    widest: float = ...,
) -> Fit: ...
@overload
def written_contour(
    boundary: Boundary, form: Form, effort: Effort, tolerance: float, widest: float = ...
) -> Fit | SplineFit: ...
def written_contour(
    boundary: Boundary, form: Form, effort: Effort, tolerance: float, widest: float = math.pi
) -> Fit | SplineFit:
    """The contour of `boundary` that is written into a file, counter-clockwise, with its proof.

    The files that have it, what the follower does on it and what it costs are all of this one.

    Parameters
    ----------
    form : of its pieces.
    tolerance : of the file [mm]; the fit takes `WRITTEN_SHARE` of it.
    widest : arc [rad]; wider ones are divided.

    Raises
    ------
    ToleranceError, GeometryError
        As `Boundary` does.
    """
    fit: Any = getattr(boundary, form)(WRITTEN_SHARE * tolerance, effort)  # a method for each form
    found: Fit | SplineFit = replace(fit, contour=fit.contour.split(widest))
    return found


def require_boundary(value: Any) -> None:
    """Raise GeometryError with key "part" unless `value` has the members of a boundary."""
    if not (isinstance(getattr(value, "name", None), str) and hasattr(value, "offset")):
        raise GeometryError("must be a boundary of a part", "part", shown(value))
