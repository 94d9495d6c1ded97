"""Which cutters reach all of a wall, and where the tightest place is."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from camgeo.curve.extremes import curvature_extremes
from camgeo.errors import GeometryError
from camgeo.outline.path import Stretch
from camgeo.part.boundaries import CurveBoundary, ExactBoundary
from camgeo.part.part import Boundary
from camgeo.units import TURN
from camgeo.wording import at_cam_angles


@dataclass(frozen=True, slots=True)
class Tightest:
    """The smallest concave radius of a wall.

    Attributes
    ----------
    radius : of the wall [mm], seen from the side without material; that of the largest cutter that
        fits.
    cam_angle : where [rad]; None for a wall that is the same all round.
    """

    radius: float
    cam_angle: float | None = None

    @property
    def sentence(self) -> str:
        """How large it is, and where."""
        where = "" if self.cam_angle is None else f" {at_cam_angles(self.cam_angle, form='.4f')}"
        return f"its smallest concave radius is {self.radius:.6g} mm{where}"


def tightest(boundary: Boundary) -> Tightest | None:
    """The place of a wall that limits cutters most; None where it is convex all round.

    Of a flank it follows from the extremes of the pitch curve's curvature: the parallel on which
    the cutter's centre runs is regular while 1 + d kappa > 0, with d its distance from the curve.
    """
    if isinstance(boundary, ExactBoundary):
        return Tightest(boundary.round_radius) if boundary.hole else None
    if not isinstance(boundary, CurveBoundary):
        return None
    found = [_of_stretch(each, hole=boundary.hole) for each in boundary.path.stretches]
    return min((each for each in found if each is not None), key=_radius, default=None)


def _radius(place: Tightest) -> float:
    return place.radius


def _of_stretch(stretch: Stretch, *, hole: bool) -> Tightest | None:
    curve = stretch.curve
    try:
        bends = curvature_extremes(curve.pitch)
    except GeometryError:  # a cusp, in what is trimmed away: the fit of the path decides
        return None
    inside = (bends.phi - stretch.start) % TURN <= stretch.end - stretch.start
    ends = np.array([stretch.start, stretch.end])
    kappa = np.concatenate(
        (
            bends.values[inside],
            curve.pitch.curvature(ends[:1], "right"),
            curve.pitch.curvature(ends[1:], "left"),
        )
    )
    phi = np.concatenate((bends.phi[inside], ends))
    # Outside, d grows with the cutter, and kappa < 0 is the limit; in a hole it is kappa > 0.
    bend = kappa if hole else -kappa
    worst = int(np.argmax(bend))
    if bend[worst] <= 0.0:
        return None
    distance = curve.distance if hole else -curve.distance
    return Tightest(float(1.0 / bend[worst] + distance), float(phi[worst]) % TURN)


def core(bore: float, diameter: float) -> float:
    """Diameter [mm] of what one round of a cutter of `diameter` inside `bore` [mm] leaves; or 0."""
    return max(0.0, bore - 2.0 * diameter)


def largest_diameter(place: Tightest) -> float:
    """Of a cutter that fits, in steps of a hundredth of a millimetre [mm]."""
    return math.floor(200.0 * place.radius) / 100.0
