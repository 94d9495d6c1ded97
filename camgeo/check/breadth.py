"""Check of a constant-breadth cam: whether both sides of its yoke touch all through the turn.

A yoke holds two parallel faces, or two rollers in line with the cam axis, at a fixed distance b.
The follower's height over the axis is h(phi) = h_0 + kappa_F s(phi) on one side, and what the cam
asks for on the other side is h(phi + pi), as the yoke does not turn: the cam is as wide as

    w(phi) = h(phi) + h(phi + pi),

which must be b at every cam angle.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from camgeo.check.finding import Finding
from camgeo.curve.extremes import extremes
from camgeo.motion.motion import Dwell, Motion, Side
from camgeo.numeric.arrays import FloatArray, merged
from camgeo.units import TURN

HALF = 0.5 * TURN


@dataclass(frozen=True)
class Breadth:
    """How wide a cam is between the two sides of a yoke, over the cam angle.

    Attributes
    ----------
    motion : the follower's lift [mm].
    height : h_0, of the face or the roller centre over the cam axis at lift 0 [mm].
    reach : +1 if a positive lift moves the yoke's first side outward, -1 inward.
    """

    motion: Motion
    height: float
    reach: float

    @property
    def breaks(self) -> FloatArray:
        """(m,) cam angles [rad] at which a derivative may jump on either side."""
        breaks = self.motion.breaks
        return merged(np.concatenate((breaks, (breaks + HALF) % TURN)))

    @property
    def dwells(self) -> tuple[Dwell, ...]:
        """None: where both sides rest the slope is 0 as where they do not."""
        return ()

    def width(self, phi: FloatArray, side: Side = "right") -> FloatArray:
        """(n,) w [mm] at `phi` (n,) [rad]."""
        return 2.0 * self.height + self.reach * self._sum(phi, side, 0)

    def slope(self, phi: FloatArray, side: Side = "right") -> FloatArray:
        """(n,) w' [mm/rad]."""
        return self.reach * self._sum(phi, side, 1)

    def _sum(self, phi: FloatArray, side: Side, order: int) -> FloatArray:
        one = self.motion.jet(phi, side, 1)[order]
        other = self.motion.jet(phi + HALF, side, 1)[order]
        return np.asarray(one + other)

    @cached_property
    def range(self) -> tuple[tuple[float, float], tuple[float, float]]:
        """Least and largest width [mm], each with its cam angle [rad]."""
        found = extremes(self, self.width, self.slope)
        return found.smallest(), found.largest()

    @property
    def best(self) -> float:
        """Breadth of the yoke [mm] whose largest error is least."""
        (least, _), (most, _) = self.range
        return 0.5 * (least + most)


def check_breadth(cam: Breadth, breadth: float, limit: float) -> Finding:
    """Hold the difference of the width of `cam` from the `breadth` [mm] of a yoke to `limit` [mm].

    Where the cam is wider the yoke is squeezed, where it is narrower the yoke has play.
    """
    (least, narrow), (most, wide) = cam.range
    error, phi = max((most - breadth, wide), (breadth - least, narrow))
    broken = error > limit
    return Finding(
        name="closing-error",
        severity="broken" if broken else "ok",
        sentence=(
            f"yoke of breadth {breadth:.6g} mm: the cam is {least:.6g} to {most:.6g} mm wide, off"
            f" by up to {error + 0.0:.3g} mm at cam angle {math.degrees(phi):.4f} deg,"
            f" {'above' if broken else 'at most'} {limit:g} mm"
        ),
        value=error,
        limit=limit,
        unit="mm",
        cam_angle=phi,
    )
