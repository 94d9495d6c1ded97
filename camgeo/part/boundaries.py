"""Boundaries of a part: outlines of the flanks, and outlines of lines and arcs by nature."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from camgeo.contour.arcs import fit_arcs
from camgeo.contour.contour import Contour
from camgeo.contour.deviation import deviation
from camgeo.contour.exact import chords_of, distance_between
from camgeo.contour.fit import Fit
from camgeo.contour.polyline import fit_polyline
from camgeo.contour.simple import require_simple
from camgeo.outline.path import Path


@dataclass(frozen=True, slots=True)
class CurveBoundary:
    """The outline of a flank as boundary, see `camgeo.part.part.Boundary`."""

    name: str
    hole: bool
    path: Path

    def arcs(self, tolerance: float) -> Fit:
        """Lines and arcs; raises UndercutError if the path is no outline, ToleranceError."""
        return self._simple(fit_arcs(self.path, tolerance))

    def polyline(self, tolerance: float) -> Fit:
        """Straight pieces; raises as `arcs`."""
        return self._simple(fit_polyline(self.path, tolerance))

    def _simple(self, fit: Fit) -> Fit:
        require_simple(fit.contour, self.name)
        return fit

    def deviation(self, contour: Contour) -> float:
        """Proved bound [mm], see `camgeo.contour.deviation`."""
        return deviation(self.path, contour)


@dataclass(frozen=True, slots=True)
class ExactBoundary:
    """An outline of lines and arcs as boundary, see `camgeo.part.part.Boundary`."""

    name: str
    hole: bool
    exact: Contour

    def arcs(self, tolerance: float) -> Fit:
        """The outline itself."""
        return Fit(self.exact.counter_clockwise(), 0.0, tolerance)

    def polyline(self, tolerance: float) -> Fit:
        """Straight pieces with their vertices on the outline."""
        contour = chords_of(self.exact, tolerance).counter_clockwise()
        return Fit(contour, distance_between(self.exact, contour), tolerance)

    def deviation(self, contour: Contour) -> float:
        """Bound [mm] in closed form, see `camgeo.contour.exact`."""
        return distance_between(self.exact, contour)


def largest_radius(contour: Contour) -> float:
    """Largest distance of the contour from the cam axis [mm]."""
    return float(np.max(_radii(contour)[1]))


def smallest_radius(contour: Contour) -> float:
    """Smallest distance of the contour from the cam axis [mm]; 0 if the axis lies outside of it."""
    from camgeo.contour.winding import winding_number

    if winding_number(contour, 0j) == 0:
        return 0.0
    return float(np.min(_radii(contour)[0]))


def _radii(contour: Contour) -> tuple[list[float], list[float]]:
    """Smallest and largest distance of each piece from the cam axis."""
    near, far = [], []
    for start, end, sweep, centre in zip(
        contour.vertices, contour.ends, contour.sweeps, contour.centres, strict=True
    ):
        radii = [abs(start), abs(end)]
        if sweep == 0.0:
            chord = end - start
            share = -(start * np.conj(chord)).real / abs(chord) ** 2
            if 0.0 < share < 1.0:
                radii.append(abs(start + share * chord))
        elif centre != 0.0:
            radius = abs(start - centre)
            for direction in (centre / abs(centre), -centre / abs(centre)):
                turned = np.angle(direction / (start - centre)) * np.sign(sweep)
                if turned % (2.0 * np.pi) <= abs(sweep):
                    radii.append(abs(centre + radius * direction))
        near.append(min(radii))
        far.append(max(radii))
    return near, far
