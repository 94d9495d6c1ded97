"""Width of a cam of constant breadth between the two sides of its yoke.

A yoke holds two parallel faces, or two rollers in line with the cam axis, at a fixed distance b.
The follower's height above the axis is h(phi) = h_0 + kappa_F s(phi) on one side; on the other side
the cam requires h(phi + pi), as the yoke does not turn. So the width of the cam is

    w(phi) = h(phi) + h(phi + pi),

and it must be b at every cam angle.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from camgeo.curve.extremes import extremes
from camgeo.errors import GeometryError
from camgeo.mechanism.values import Length
from camgeo.motion.motion import Dwell, Motion
from camgeo.numeric.arrays import FloatArray, Side, merged
from camgeo.numeric.checked import check_fields
from camgeo.units import TURN

if TYPE_CHECKING:
    from camgeo.mechanism.follower import Follower

HALF = 0.5 * TURN

ROUNDING: Final = 1e-12
"""Widths that differ by less than this share of the largest are equal but for rounding."""


@dataclass(frozen=True)
class Breadth:
    """Width of a cam between the two sides of a yoke, as a function of the cam angle.

    Attributes
    ----------
    motion : the follower's lift [mm].
    height : h_0, of the face or the roller centre above the cam axis at lift 0 [mm].
    reach : +1 if a positive lift moves the yoke's first side outward, -1 inward.
    """

    motion: Motion
    height: float
    reach: float

    @property
    def breaks(self) -> FloatArray:
        """(m,) cam angles [rad] at which a derivative may jump on either side."""
        return _on_both_sides(self.motion.breaks)

    @property
    def borders(self) -> FloatArray:
        """(k,) cam angles [rad] at which the formula changes on either side."""
        return _on_both_sides(self.motion.borders)

    @property
    def dwells(self) -> tuple[Dwell, ...]:
        """None: where both sides dwell the slope is simply 0."""
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
        """The breadth of the yoke [mm] that minimizes the largest error."""
        (least, _), (most, _) = self.range
        return 0.5 * (least + most)

    @property
    def variation(self) -> float:
        """Largest width minus least one [mm]; 0 for a cam of constant breadth."""
        (least, _), (most, _) = self.range
        return most - least if most - least > ROUNDING * most else 0.0

    def play(self, breadth: float) -> float:
        """Least gap [mm] of a yoke of `breadth` [mm], negative where the cam squeezes it; 0 if only
        rounding is left.
        """
        _, (most, _) = self.range
        return breadth - most if abs(breadth - most) > ROUNDING * most else 0.0

    def opposite(self, follower: Follower) -> Follower:
        """The second side of the yoke, a follower in its own right with the lift of `follower`, the
        first one, on a cam that is `best` wide everywhere.

        It is the first one turned by half a turn about the cam axis, and what moves one of them
        outward moves the other inward. A breadth that gives it play does not move its disc, so it
        is not that of the yoke.

        Raises
        ------
        GeometryError
            With key "follower.yoke", if the cam is so far from constant breadth that there is none.
        """
        first: Any = follower  # only followers in a guide have a yoke
        height, angle = self.best - self.height, first.guide_angle
        if not height > 0.0:
            raise GeometryError(
                "the cam is so far from constant breadth that its width leaves no room for the"
                " second side",
                key="follower.yoke",
            )
        turned: Follower = replace(
            first,
            base_radius=height,
            guide_angle=angle - HALF if angle > 0.0 else angle + HALF,
            direction=-first.direction,
        )
        return turned


def _on_both_sides(angles: FloatArray) -> FloatArray:
    """The cam `angles` (m,) [rad], and those half a turn from them."""
    return merged(np.concatenate((angles, (angles + HALF) % TURN)))


@dataclass(frozen=True, slots=True)
class Yoke:
    """A yoke as a scene describes it.

    Attributes
    ----------
    breadth : distance between its two faces, or its two roller centres [mm]; None for the one
        with the smallest closing error.

    Raises
    ------
    GeometryError
        With key "follower.yoke.breadth" if that is not a length above 0.
    """

    breadth: Length | None = None

    def __post_init__(self) -> None:
        check_fields(self, "follower.yoke.")
