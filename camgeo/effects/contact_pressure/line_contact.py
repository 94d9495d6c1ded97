"""The contact of roller and flank over the cam angle: force, relative curvature, pressure.

Both are cylinders with parallel axes. A flank is the parallel of the pitch curve at the distance d
= -s r_R, with s = +1 for the inner flank and -1 for the outer one. It has the curvature kappa/(1 +
d kappa) if the pitch curve has kappa (Wirsig eqs. 2.53, 2.54: the radius of curvature of a parallel
is longer by d). The disc lies outside its outer flank, which counts mirrored. The relative
curvature is

    1/R = 1/r_R + s kappa/(1 + d kappa) = 1/(r_R (1 + d kappa)),       R = r_R (1 + d kappa).

In a groove with side clearance c, d = -s (r_R + c/2), and the same sum gives

    R = r_R (1 + d kappa)/(1 - s c/2 kappa).

A flat face has no curvature: R = 1/kappa there, the radius of curvature of the cam.

So R is 0 at a cusp of the flank and nowhere else, and a flank without undercut is never curved more
tightly than the roller that runs on it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final, NoReturn

import numpy as np

from camgeo.effects.effect import Quantity, Subject
from camgeo.effects.touching import INNER, OUTER
from camgeo.effects.wording import at
from camgeo.errors import EffectError, GeometryError
from camgeo.numeric.arrays import FloatArray, Side
from camgeo.numeric.extremes import piecewise_lowest
from camgeo.units import TURN

if TYPE_CHECKING:
    from camgeo.state.state import Model

CUSP: Final = 1e-12
"""Values of 1 + d kappa up to here are a rounded 0, a cusp."""


@dataclass(frozen=True, slots=True, eq=False)
class LineContact:
    """The line contact.

    Attributes
    ----------
    subject : the design.
    normal : force of the cam on the follower [N], positive where the inner flank carries.
    modulus : E* [MPa].
    width : L [mm].
    """

    subject: Subject
    normal: Quantity
    modulus: float
    width: float

    @property
    def scale(self) -> float:
        """r_R [mm], the scale for detecting a cusp; r_G with a flat face."""
        follower = self.subject.cam.follower
        return follower.roller_radius or follower.base_radius

    def carried(self, phi: FloatArray, side: Side) -> tuple[FloatArray, FloatArray]:
        """(n,) force F of the follower on a flank [N], 0 or more, and (n,) which flank.

        A flank on which no roller runs carries nothing: there the roller has lifted off.
        """
        normal = self.normal(phi, side)
        if self.subject.cam.contact.closed_by_form:
            return np.abs(normal), np.where(normal < 0.0, float(OUTER), float(INNER))
        sense = self.subject.cam.contact.push
        return np.maximum(sense * normal, 0.0), np.full(len(phi), float(sense))

    def curvature(self, phi: FloatArray, side: Side) -> FloatArray:
        """(n,) of the pitch curve [1/mm], positive where it is convex.

        Raises
        ------
        EffectError
            Where the pitch curve has a cusp.
        """
        try:
            return self.subject.state.curve.curvature(phi, side)
        except GeometryError as error:
            raise EffectError(f"there is no contact pressure: {error.message}") from error

    def load_and_radius(self, phi: FloatArray, side: Side) -> tuple[FloatArray, FloatArray]:
        """(n,) F [N] and (n,) R [mm], which is 0 on a corner of the disc."""
        load, sense = self.carried(phi, side)
        kappa = sense * self.curvature(phi, side)
        cam, state = self.subject.cam, self.subject.state
        radius = cam.follower.contact_radius(kappa, cam.disc.flank_distance)
        return load, np.where(state.on_corner(phi, side), 0.0, radius)

    def square(self, phi: FloatArray, side: Side) -> FloatArray:
        """(n,) p^2 [MPa^2], smooth where F and the curvature are; 0 without force.

        Raises
        ------
        EffectError
            Where a cusp or undercut is loaded.
        """
        load, radius = self.load_and_radius(phi, side)
        loaded = load > 0.0
        beyond = loaded & (radius <= CUSP * self.scale)
        if np.any(beyond):
            self._refuse(float(phi[beyond][0]), float(np.min(radius[beyond])))
        found = np.zeros(len(phi))
        share = self.modulus / (math.pi * self.width)
        np.divide(share * load, radius, out=found, where=loaded)
        return found

    def pressure(self, phi: FloatArray, side: Side) -> FloatArray:
        """(n,) p [MPa], see `square`."""
        return np.sqrt(self.square(phi, side))

    def refuse_cusps(self, edges: FloatArray) -> None:
        """Raise EffectError if a cusp or undercut is loaded between `edges` (k,) [rad]."""
        scale = self.scale

        def under_load(phi: FloatArray, side: Side) -> FloatArray:
            load, radius = self.load_and_radius(phi, side)
            return np.where(load > 0.0, radius, scale)

        lowest = piecewise_lowest(under_load, edges)
        if lowest.value <= CUSP * scale:
            self._refuse(lowest.place, lowest.value)

    def _refuse(self, angle: float, radius: float) -> NoReturn:
        value = radius / self.scale
        what = "a cusp of the flank" if value >= -CUSP else "an undercut flank"
        what = CORNERS.get(self.subject.state.model, what)
        touching = self.subject.cam.follower.touching
        raise EffectError(
            f"the pressure is infinite {at(angle)}: {what} carries the {touching} there; 1 + d"
            f" kappa is {value:.6g} and must be above 0",
            finding="infinite-contact-pressure",
            value=value,
            limit=0.0,
            cam_angle=angle % TURN,
        )


CORNERS: Final[dict[Model, str]] = {
    "outline": "a sharp corner of the trimmed flank",
    "written": "a vertex of the written contour",
}
"""What holds the follower where the pressure is infinite, by the motion of the state."""

GOLDEN: Final = 0.5 * (math.sqrt(5.0) - 1.0)

SHEAR_SHARE: Final[float] = GOLDEN**2.5
"""Largest shear below the contact as a share of the pressure, 0.30028."""

SHEAR_DEPTH: Final = math.sqrt(GOLDEN)
"""Its depth as a share of the half width, 0.78615."""


def largest_pressure(load: float, modulus: float, radius: float) -> float:
    """p [MPa] for F/L `load` [N/mm], E* `modulus` [MPa] and R `radius` [mm] above 0."""
    return math.sqrt(load * modulus / (math.pi * radius))


def half_width(load: float, modulus: float, radius: float) -> float:
    """b [mm] for F/L `load` [N/mm], E* `modulus` [MPa] and R `radius` [mm] above 0."""
    return math.sqrt(4.0 * load * radius / (math.pi * modulus))


def needed_radius(load: float, modulus: float, pressure: float) -> float:
    """R [mm] at which the largest pressure is `pressure` [MPa] above 0, see `largest_pressure`."""
    return load * modulus / (math.pi * pressure * pressure)


def roller_radii(needed: float, curvature: float) -> tuple[float, float] | None:
    """Range of roller radii, from and to [mm], for which R is at least `needed` [mm].

    Parameters
    ----------
    needed : the R needed, 0 or more.
    curvature : of the pitch curve, positive if convex towards the roller [1/mm]; it is unchanged.

    Returns
    -------
    The upper end is infinite where the path is straight or concave; None if no radius will do.

    R = r (1 - r kappa) for the roller radius r, see `camgeo.effects.contact_pressure.line_contact`.
    On a convex path it has a maximum, 1/(4 kappa), at half the radius of curvature. The lower root
    of the quadratic equation is computed from the upper one, to avoid cancellation.
    """
    rest = 1.0 - 4.0 * needed * curvature
    if rest < 0.0:
        return None
    root = 1.0 + math.sqrt(rest)
    return 2.0 * needed / root, root / (2.0 * curvature) if curvature > 0.0 else math.inf
