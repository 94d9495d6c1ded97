"""Joints of a motion plan: what meets there, and how smoothly."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from camgeo.motion.boundary import End, end_of
from camgeo.motion.kept import kept_with_owner
from camgeo.motion.plan import MotionPlan
from camgeo.motion.spans import FULL_TURN
from camgeo.numeric import checked
from camgeo.numeric.arrays import FloatArray, ascending, frozen
from camgeo.numeric.isolation import cells_between
from camgeo.pickled import Pickled
from camgeo.units import TURN

ROUNDING = 1e-9
"""A value below this fraction of a bound of its order in its segment counts as zero; the rounding
of conversions from degrees is a thousand times smaller."""

JUMP = 1e-10
"""A jump below this fraction of the largest value of its order on either side is not a jump."""

JERK = 3
"""Highest order that may jump."""


@dataclass(frozen=True, slots=True, eq=False)
class Joint(Pickled):
    """A place where two segments meet; the first one is cam angle 0, where the turn closes.

    Attributes
    ----------
    cam_angle : [rad] in [0, 2 pi).
    position : lift [mm or rad].
    before, after : class of the end of the segment before and of the start of the one after.
    order : of the highest derivative that is continuous, -1 (none) to 3.
    left, right : (4,) lift and three derivatives with respect to the cam angle from either side.
    """

    cam_angle: float
    position: float
    before: End
    after: End
    order: int
    left: FloatArray
    right: FloatArray

    def __post_init__(self) -> None:
        checked.hold(self, left=frozen(self.left, np.float64), right=frozen(self.right, np.float64))


@kept_with_owner
def joints(plan: MotionPlan) -> tuple[Joint, ...]:
    """The joints of `plan`, by ascending cam angle; a segment of zero length adds no joint."""
    return _joints_at(plan, _angles(plan))


@kept_with_owner
def breaks(plan: MotionPlan) -> tuple[Joint, ...]:
    """As `joints`, including the places inside the laws at which a derivative may jump."""
    return _joints_at(plan, ascending(np.append(_angles(plan), plan.breaks)))


def _angles(plan: MotionPlan) -> FloatArray:
    degrees = [float(angle) for angle in plan.joints_deg if angle < FULL_TURN]
    return ascending(np.radians(degrees))


def _joints_at(plan: MotionPlan, angles: FloatArray) -> tuple[Joint, ...]:
    left, right = plan.jet(angles, "left"), plan.jet(angles)
    before, after = _scales(plan, angles, left, right)
    jumps = np.abs(right - left) > _slack(angles) * np.maximum(before, after)
    left = np.where(np.abs(left) > ROUNDING * before, left, 0.0)
    right = np.where(np.abs(right) > ROUNDING * after, right, 0.0)
    return tuple(
        Joint(
            cam_angle=float(angles[k]),
            position=float(right[0, k]),
            before=end_of(float(left[1, k]), float(left[2, k])),
            after=end_of(float(right[1, k]), float(right[2, k])),
            order=int(np.argmax([*jumps[:, k], True])) - 1,
            left=left[:, k],
            right=right[:, k],
        )
        for k in range(len(angles))
    )


def _slack(angles: FloatArray) -> FloatArray:
    """(k,) fraction of a derivative below which a jump at each of `angles` is none.

    The length of a segment is a difference of rounded cam angles, so its derivatives of order n are
    off by n times the rounding over the length: 1.5e-7 for the jerk of the shortest segments.
    """
    lengths = np.diff(np.append(angles, angles[0] + TURN))
    shorter = np.minimum(lengths, np.roll(lengths, 1))
    slack: FloatArray = JUMP + JERK * math.ulp(TURN) / shorter
    return slack


def _scales(
    plan: MotionPlan, angles: FloatArray, left: FloatArray, right: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """(4, k) bounds of each derivative in the segment before and in the one after each joint."""
    low, high = cells_between(np.append(plan.borders, TURN))
    middle, bounds = plan.jet_and_bounds(low, high)
    own = np.concatenate((np.abs(middle[:1]) + bounds[:1], bounds[1:]))
    first = np.searchsorted(0.5 * (low + high), angles)
    size = np.maximum.reduceat(own, first, axis=1)
    size = np.maximum(size, np.abs(right))
    after: FloatArray = np.maximum(size, np.abs(np.roll(left, -1, axis=1)))
    after[0] = np.max(after[0])
    return np.roll(after, 1, axis=1), after
