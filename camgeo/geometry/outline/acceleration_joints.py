"""Joints at which the exact acceleration jumps, as they lie on a disc that was made.

Such a joint lies on the disc within the disc's position error of its place. So close to it, an
acceleration, or what follows from it, between the values of its two sides is not off.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Final, Self

import numpy as np

from camgeo.kinematics.motion import Motion
from camgeo.numeric.arrays import SIDES, FloatArray, Quantity, Side, frozen
from camgeo.units import TURN

SHIFT: Final = 4.0
"""This multiple of the error of the lift at places around a joint certainly covers how far off the
joint is: between two borders the error is that of one piece from one formula, of which four places
see more than a quarter."""

PLACES: Final = (np.arange(4) + 0.5) / 4.0
"""Of each smooth piece at which the error is taken, as shares of it."""

AROUND: Final = 0.02
"""Range [rad] on both sides of a joint from which the error of the lift around it is taken."""

SEAM: Final = 1e-9
"""Least distance [rad] within which a joint is sought: rounding of cam angles."""


@dataclass(frozen=True, slots=True, eq=False)
class AccelerationJoints:
    """The joints of an exact motion.

    Attributes
    ----------
    places, reaches : (k,) cam angles [rad] in [0, 2 pi), and how near to them the disc may place
        the joints.
    """

    places: FloatArray
    reaches: FloatArray

    @classmethod
    def between(
        cls,
        shift_of: Callable[[float, FloatArray], FloatArray],
        made: Callable[[FloatArray], FloatArray],
        exact: Motion,
        edges: FloatArray,
    ) -> Self:
        """Those of `exact` on a disc; `shift_of` as of `camgeo.geometry.outline.roller.DiscLift`.

        `made` gives the lift with two derivatives (3 or more, n), smooth between the `edges` (m,)
        [rad] over a turn, as `exact` is.
        """
        left, right = (exact.jet(exact.breaks, side, 2)[2] for side in SIDES)
        joints = exact.breaks[left != right]
        phi = (edges[:-1, np.newaxis] + np.diff(edges)[:, np.newaxis] * PLACES).ravel()
        errors = made(phi)[:3] - exact.jet(phi, "right", 2)[:3] if len(joints) else np.empty((3, 0))
        shifts = []
        for joint in joints.tolist():
            shift = shift_of(joint, errors[:, _away(phi, joint) < AROUND])
            shifts.append(float(np.max(shift, initial=0.0)))
        return cls(frozen(joints, np.float64), frozen(SEAM + SHIFT * np.array(shifts), np.float64))

    @property
    def ends(self) -> FloatArray:
        """(3 k,) cam angles [rad] in [0, 2 pi) of the joints and of the ends of what is near."""
        apart = self.reaches * np.array([[-1.0], [0.0], [1.0]])
        return np.asarray(np.remainder(self.places + apart, TURN).ravel())

    def deviation(self, quantity: Quantity, exact: Quantity) -> Quantity:
        """How far a quantity is off the exact one, which jumps at the joints."""
        sides = np.sort([exact(self.places, side) for side in SIDES], axis=0)
        joints = list(zip(self.places.tolist(), self.reaches.tolist(), *sides, strict=True))

        def off(phi: FloatArray, side: Side) -> FloatArray:
            values = quantity(phi, side)
            found = values - exact(phi, side)
            for joint, reach, low, high in joints:
                near = _away(phi, joint) <= reach
                found[near] = values[near] - np.clip(values[near], low, high)
            return found

        return off


def _away(phi: FloatArray, joint: float) -> FloatArray:
    """(n,) distance [rad] of `phi` (n,) from a joint, round the turn."""
    return np.abs(np.remainder(phi - joint + 0.5 * TURN, TURN) - 0.5 * TURN)
