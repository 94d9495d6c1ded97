"""What a state of motion is: the one motion for which the effects of a scene are computed."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import ClassVar, Final, Literal

import numpy as np

from camgeo.cam.cam import Cam, Drive, smooth_angles
from camgeo.errors import GeometryError
from camgeo.geometry.pitch_curve import PitchCurve
from camgeo.kinematics.motion import FULL_ORDER, Motion
from camgeo.kinematics.plan import breaks
from camgeo.kinematics.time_course import TimeCourse, TimeExtremes, plan_extremes
from camgeo.numeric.arrays import BoolArray, FloatArray, Side

Model = Literal["demanded", "outline", "written"]
"""Whose motion it is: the one that the scene demands, the one that the real outline of the disc
makes, or the one that its contour makes as it is written.
"""

Carrier = Literal["inner", "outer", "main", "return", "opposite"]
"""On which side a follower runs that is held both ways: the flank of a groove, the disc of a
conjugate pair, or the side of a yoke.
"""

Train = Literal["elastic", "rigid"]
"""How the output follows the follower: by the elastic train of the effect `vibration`, where a
scene names it, or as if that were rigid.
"""


FIRST: Final = 1
SECOND: Final = -1
"""The sides of a follower: an inner flank or main disc, and an outer flank or return disc. So they
have the sign of the contact force."""

AT_REST: Final = 1e-12
"""Velocities s' [mm or rad] up to this are those of a rest, but for rounding."""

Speed = Literal["stated", "found"]
"""How the cam turns: as the scene states, or as the effect `speed-fluctuation`
or `camshaft-windup` finds."""


@dataclass(frozen=True, slots=True)
class Used:
    """The state for which a result was computed.

    Attributes
    ----------
    motion : whose.
    speed : of the cam; None if there is none.
    sense : the side that makes the motion, as `State.sense`.
    """

    motion: Model
    speed: Speed | None
    sense: int = 0


def time_order(output: Motion, course: TimeCourse | None) -> int:
    """The order of the highest derivative of `output` over time that the `course` lets be
    continuous, up to `FULL_ORDER`: where alpha jumps, so does the acceleration unless s' is 0.
    """
    if course is None or not len(course.jumps):
        return FULL_ORDER
    # x'' omega^2 + x' alpha jumps with alpha unless x' is 0.
    moving = np.abs(output.jet(course.jumps, "right", 1)[1]) > AT_REST
    return 1 if np.any(moving) else FULL_ORDER


# -- demanded -------------------------------------------------------------------------------------
# The demanded motion as the state: the cam does exactly what the scene states.


@dataclass(frozen=True)
class Demanded:
    """The demanded motion; see `camgeo.dynamics.state.written.State`.

    Attributes
    ----------
    drive : what moves the follower.
    cam : of which the follower runs on the disc; None without a follower.
    course : how the cam turns; None if that is not known.
    """

    drive: Drive
    cam: Cam | None
    course: TimeCourse | None

    model: ClassVar[Model] = "demanded"
    sense: ClassVar[int] = 0

    @property
    def motion(self) -> Motion:
        """See `State`; GeometryError with key "linkage" if the linkage does not close."""
        return self.drive.motion

    @property
    def output(self) -> Motion:
        """See `State`."""
        return self.drive.plan

    @cached_property
    def smooth_angles(self) -> FloatArray:
        """See `State`."""
        if self.course is self.drive.time_course:
            return self.drive.smooth_angles  # which others use too
        return smooth_angles(self.motion, self.course)

    @property
    def order(self) -> int:
        """See `State`."""
        plan_order = min(joint.order for joint in breaks(self.drive.plan))
        return min(plan_order, time_order(self.output, self.course))

    @property
    def shocks(self) -> tuple[float, ...]:
        """See `State`."""
        return tuple(joint.cam_angle for joint in breaks(self.drive.plan) if joint.order < 1)

    @property
    def curve(self) -> PitchCurve:
        """See `State`."""
        if self.cam is None:
            raise GeometryError("needs [follower]", key="follower")
        return self.cam.disc.pitch_curve

    def on_corner(self, phi: FloatArray, side: Side) -> BoolArray:
        """See `State`: nowhere, the flank is taken to be whole."""
        return np.zeros(len(phi), dtype=np.bool_)

    def output_extremes(self, course: TimeCourse) -> TimeExtremes:
        """See `State`."""
        return plan_extremes(self.drive.plan, course, self.drive.unit)

    def turning(self, course: TimeCourse) -> Demanded:
        """See `State`."""
        return replace(self, course=course)
