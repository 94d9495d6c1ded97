"""A drive: the prescribed motion, the linkage ahead of the follower, and the speed of the cam.

It needs no disc: motion, time and kinematics follow from it alone.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Literal

import numpy as np

from camgeo.errors import GeometryError
from camgeo.lazy import Ledger, lazy
from camgeo.mechanism.linkage import linked
from camgeo.mechanism.linkage_protocol import Member
from camgeo.motion.motion import Jet, Motion
from camgeo.motion.plan import MotionPlan
from camgeo.numeric.arrays import FloatArray, Side, merged
from camgeo.pickled import Pickled
from camgeo.units import TURN, LiftUnit

if TYPE_CHECKING:
    from camgeo.mechanism.far_end import FarEnd
    from camgeo.mechanism.linkage_protocol import Linkage
    from camgeo.motion.time_course import SpeedCurve, TimeCourse

Demanded = Literal["follower"] | Member
"""Whose motion is prescribed: the follower's, or that of the far end of a linkage."""


@dataclass(frozen=True)
class Drive(Pickled):
    """What moves the follower; everything is computed on demand.

    Cam angles are in radians, any number of turns, arrays (n,); lengths in mm.

    Attributes
    ----------
    plan : the prescribed motion: of the far end of a linkage if there is one, else of the follower.
    linkage : between plan and follower, or None.
    unit : of the plan's positions.
    speed : of the cam, positive [rad/s], the mean if it varies; None if none is given.
    speed_curve : how the speed varies over the turn; None if it does not.
    ledger : records what has been computed.

    Raises
    ------
    GeometryError
        If the linkage's far end moves in another unit.
    """

    plan: MotionPlan
    linkage: Linkage | None = None
    unit: LiftUnit = "mm"
    speed: float | None = None
    speed_curve: SpeedCurve | None = None
    ledger: Ledger = field(default_factory=Ledger, repr=False, compare=False)

    def __post_init__(self) -> None:
        if self.linkage is not None and self.linkage.unit != self.unit:
            message = f"must be {self.linkage.unit!r}, in which the linkage's far end moves"
            raise GeometryError(message, key="unit", value=self.unit)

    @property
    def demanded_of(self) -> Demanded:
        """Whose motion is prescribed."""
        return "follower" if self.linkage is None else self.linkage.member

    @lazy
    def motion(self) -> Motion:
        """The follower's own motion, at the near end of a linkage if there is one [mm or rad].

        Raises GeometryError with key "linkage" if the linkage does not close.
        """
        return self.plan if self.linkage is None else linked(self.plan, self.linkage)

    @property
    def far_end(self) -> FarEnd | None:
        """The far end of the linkage with the follower anywhere; None without a linkage."""
        if self.linkage is None:
            return None
        from camgeo.mechanism.far_end import far_end  # few followers leave the cam

        return far_end(self.plan, self.linkage)

    @lazy
    def time_course(self) -> TimeCourse | None:
        """How the cam turns in time; None if no speed is given."""
        if self.speed_curve is not None:
            return self.speed_curve
        from camgeo.motion.time_course import ConstantSpeed

        return None if self.speed is None else ConstantSpeed(self.speed)

    def in_time(self, phi: FloatArray, side: Side = "right") -> Jet:
        """(4, n) position, velocity, acceleration, jerk [mm or rad per s^k] of the plan at `phi`.

        Raises GeometryError if there is no speed.
        """
        if self.time_course is None:
            raise GeometryError("needs [cam] speed or speed_curve", key="cam.speed")
        from camgeo.motion.time_course import in_time

        angles = np.atleast_1d(phi)
        return in_time(self.plan.jet(angles, side), self.time_course, angles)

    @lazy
    def smooth_angles(self) -> FloatArray:
        """(k,) cam angles [rad] from 0 to 2 pi, both included, ascending.

        Between two neighbours all derivatives of the motion and of the time course are smooth, and
        the follower's velocity keeps its sign.
        """
        return smooth_angles(self.motion, self.time_course)

    @property
    def joints(self) -> tuple[float, ...]:
        """Cam angles [rad] at which the segments of the plan begin, from 0 upwards."""
        return tuple(math.radians(float(angle)) for angle in self.plan.joints_deg[:-1])

    @property
    def far_angle(self) -> float:
        """The first cam angle [rad] at which the prescribed motion is farthest from its start."""
        from camgeo.motion.extremes import turning_angles

        angles = merged(np.concatenate((self.plan.borders, turning_angles(self.plan))))
        return float(angles[np.argmax(np.abs(self.plan.jet(angles)[0]))]) if len(angles) else 0.0


def smooth_angles(motion: Motion, course: TimeCourse | None) -> FloatArray:
    """(k,) cam angles [rad] as of `Drive.smooth_angles`, for a follower with this `motion`."""
    from camgeo.motion.extremes import turning_angles

    edges = [motion.borders, turning_angles(motion), np.array([0.0, TURN])]
    if course is not None:
        edges.append(course.borders)
    return merged(np.concatenate(edges))
