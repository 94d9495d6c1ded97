"""Boundaries scaled about the cam axis."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Annotated, Final, TypeVar

import numpy as np

from camgeo.contour.contour import EPS, Contour, Effort, Fit
from camgeo.contour.spline import Arc, CubicSpline, SplineContour, SplineFit
from camgeo.numeric.checked import check_fields, positive
from camgeo.outline.moments import Moments, SecondMoments
from camgeo.part.boundaries import ExactBoundary
from camgeo.part.part import Boundary, require_boundary
from camgeo.pickled import Pickled

ROUNDING: Final = 4.0 * EPS
"""Of a scaled coordinate, relative: of the factor, of the product and of the proof at both ends."""

Factor = Annotated[float, positive]

Found = TypeVar("Found", Fit, SplineFit)


@dataclass(frozen=True, slots=True)
class ScaledBoundary(Pickled):
    """A boundary scaled about the cam axis, see `camgeo.part.part.Boundary`.

    Every question is put to the boundary itself, at its own scale: a deviation is proved there and
    multiplied by the factor.

    Attributes
    ----------
    unscaled : the boundary itself.
    factor : by which it is larger.
    """

    unscaled: Boundary
    factor: Factor

    def __post_init__(self) -> None:
        require_boundary(self.unscaled)
        check_fields(self)

    @property
    def name(self) -> str:
        """That of the boundary itself."""
        return self.unscaled.name

    @property
    def hole(self) -> bool:
        """As of the boundary itself."""
        return self.unscaled.hole

    def arcs(self, tolerance: float, effort: Effort = "fewest") -> Fit:
        """See `camgeo.part.part.Boundary`."""
        return self._fit(lambda own: self.unscaled.arcs(own, effort), tolerance)

    def beside(self, tolerance: float) -> Fit:
        """See `camgeo.part.part.Boundary`."""
        return self._fit(self.unscaled.beside, tolerance)

    def polyline(self, tolerance: float, effort: Effort = "fewest") -> Fit:
        """See `camgeo.part.part.Boundary`."""
        return self._fit(lambda own: self.unscaled.polyline(own, effort), tolerance)

    def sampled(self, tolerance: float) -> Contour:
        """See `camgeo.part.part.Boundary`."""
        return scaled_contour(self.unscaled.sampled(tolerance / self.factor), self.factor)

    def _fit(self, fit: Callable[[float], Fit], tolerance: float) -> Fit:
        """A fit within what the scaling leaves of the tolerance."""
        lost = self._rounding
        found = fit((tolerance - lost) / self.factor)
        contour = scaled_contour(found.contour, self.factor)
        return Fit(contour, found.deviation * self.factor + lost, tolerance)

    def spline(self, tolerance: float, effort: Effort = "fewest") -> SplineFit:
        """See `camgeo.part.part.Boundary`."""
        lost = self._rounding
        found = self.unscaled.spline((tolerance - lost) / self.factor, effort)
        contour = scaled_splines(found.contour, self.factor)
        return SplineFit(contour, found.deviation * self.factor + lost, tolerance)

    def deviation(self, contour: Contour | SplineContour) -> float:
        """See `camgeo.part.part.Boundary`."""
        back = 1.0 / self.factor
        if isinstance(contour, SplineContour):
            own: Contour | SplineContour = scaled_splines(contour, back)
            reach = contour.reach
        else:
            own = scaled_contour(contour, back)
            reach = float(np.max(np.abs(contour.vertices)))
        return self.unscaled.deviation(own) * self.factor + ROUNDING * reach

    def offset(self, distance: float) -> ScaledBoundary:
        """See `camgeo.part.part.Boundary`."""
        return ScaledBoundary(self.unscaled.offset(distance / self.factor), self.factor)

    @property
    def corner_radius(self) -> float | None:
        """See `camgeo.part.part.Boundary`."""
        own = self.unscaled.corner_radius
        return None if own is None else own * self.factor

    def inset(self, distance: float, name: str) -> ScaledBoundary:
        """See `camgeo.part.part.Boundary`."""
        return ScaledBoundary(self.unscaled.inset(distance / self.factor, name), self.factor)

    def moments(self, tolerance: float) -> Moments:
        """See `camgeo.part.part.Boundary`."""
        own, by = self.unscaled.moments(tolerance), self.factor
        return Moments(
            own.area * by**2, own.first * by**3, own.area_error * by**2, own.first_error * by**3
        )

    def second_moments(self, tolerance: float) -> SecondMoments:
        """See `camgeo.part.part.Boundary`."""
        return self.unscaled.second_moments(tolerance).scaled(self.factor**4)

    def farthest(self) -> tuple[float, float | None]:
        """See `camgeo.part.part.Boundary`."""
        radius, place = self.unscaled.farthest()
        return radius * self.factor, place

    def nearest(self) -> float:
        """See `camgeo.part.part.Boundary`."""
        return self.unscaled.nearest() * self.factor

    @property
    def _rounding(self) -> float:
        """Of a fit's coordinates [mm]."""
        return ROUNDING * self.farthest()[0]


def scaled(boundary: Boundary, factor: float) -> Boundary:
    """The boundary about the cam axis, larger by `factor`; itself if that is 1."""
    if factor == 1.0:
        return boundary
    if isinstance(boundary, ExactBoundary):
        core = None if boundary.core is None else scaled_contour(boundary.core, factor)
        exact = scaled_contour(boundary.exact, factor)
        return ExactBoundary(boundary.name, boundary.hole, exact, core)
    return ScaledBoundary(boundary, factor)


def scaled_contour(contour: Contour, factor: float) -> Contour:
    """The contour about the origin, larger by `factor`."""
    return Contour(contour.vertices * factor, contour.sweeps, contour.centres * factor)


def scaled_splines(contour: SplineContour, factor: float) -> SplineContour:
    """The same, of splines and arcs."""
    return SplineContour(
        tuple(
            CubicSpline(each.knots, each.controls * factor)
            if isinstance(each, CubicSpline)
            else Arc(each.start * factor, each.end * factor, each.sweep, each.centre * factor)
            for each in contour.strands
        )
    )
