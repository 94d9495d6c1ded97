"""What a state of motion is: the one motion for which the effects of a scene are computed."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Final, Literal, Protocol

import numpy as np

from camgeo.cam.cam import Cam, Drive, smooth_angles
from camgeo.errors import GeometryError
from camgeo.geometry.pitch_curve import PitchCurve
from camgeo.kinematics.motion import FULL_ORDER, Motion
from camgeo.kinematics.plan import breaks
from camgeo.kinematics.time_course import TimeCourse, TimeExtremes, plan_extremes
from camgeo.numeric.arrays import BoolArray, FloatArray, Side

if TYPE_CHECKING:
    from camgeo.check.finding import Limits

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
    """What a result was computed for.

    Attributes
    ----------
    motion : whose.
    speed : of the cam; None if there is none.
    sense : the side that makes the motion, as `State.sense`.
    """

    motion: Model
    speed: Speed | None
    sense: int = 0


def order_with(output: Motion, course: TimeCourse | None) -> int:
    """The order of the highest derivative of `output` over time that the `course` lets be
    continuous, up to `FULL_ORDER`: where alpha jumps, so does the acceleration unless s' is 0.
    """
    if course is None or not len(course.jumps):
        return FULL_ORDER
    moving = np.abs(output.jet(course.jumps, "right", 1)[1]) > AT_REST
    return 1 if np.any(moving) else FULL_ORDER


class State(Protocol):
    """The motion of follower and output, and how the cam turns.

    Cam angles are in rad, motions in mm or rad over the cam angle.

    Attributes
    ----------
    model : whose motion it is.
    sense : the side on which the follower makes this motion, `FIRST` or `SECOND`; 0 if it is that
        of no flank, as the demanded one, which is the same on both sides.
    motion : of the follower.
    output : of the member with the demanded motion; that of the follower without a linkage.
    course : how the cam turns in time; None if no speed is given.
    smooth_angles : (k,) cam angles [rad] from 0 to 2 pi, both included, ascending. Between two
        neighbours all derivatives of `motion` and `course` are smooth, and the follower's velocity
        keeps its sign.
    order : of the highest derivative of `output` over time that is continuous over the turn, -1 to
        3.
    shocks : cam angles [rad] in [0, 2 pi), ascending, at which the velocity jumps.
    """

    @property
    def model(self) -> Model: ...

    @property
    def sense(self) -> int: ...

    @property
    def motion(self) -> Motion: ...

    @property
    def output(self) -> Motion: ...

    @property
    def course(self) -> TimeCourse | None: ...

    @property
    def smooth_angles(self) -> FloatArray: ...

    @property
    def order(self) -> int: ...

    @property
    def shocks(self) -> tuple[float, ...]: ...

    @property
    def curve(self) -> PitchCurve:
        """The path of the roller centre in the cam with this motion, or of the contact of a flat
        face; its normals are those of the contact. GeometryError with key "follower" without one.
        """

    def on_corner(self, phi: FloatArray, side: Side) -> BoolArray:
        """(n,) whether the follower touches a sharp corner of the disc at `phi` (n,) [rad]."""

    def output_extremes(self, course: TimeCourse) -> TimeExtremes:
        """Extremes in time of `output` with the cam turning as `course` says."""

    def turning(self, course: TimeCourse) -> State:
        """The same motion over the cam angle with the cam turning as `course` says."""


# -- demanded -------------------------------------------------------------------------------------
# The demanded motion as the state: the cam does exactly what the scene states.


@dataclass(frozen=True)
class Demanded:
    """The demanded motion; see `camgeo.dynamics.state.state.State`.

    Attributes
    ----------
    drive : what moves the follower.
    cam : of which the follower runs on the disc; None without a follower.
    course : how the cam turns; None if that is not known.
    """

    drive: Drive
    cam: Cam | None
    course: TimeCourse | None

    @property
    def model(self) -> Model:
        """See `State`."""
        return "demanded"

    @property
    def sense(self) -> int:
        """See `State`."""
        return 0

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
        own = min(joint.order for joint in breaks(self.drive.plan))
        return min(own, order_with(self.output, self.course))

    @property
    def shocks(self) -> tuple[float, ...]:
        """See `State`."""
        return tuple(each.cam_angle for each in breaks(self.drive.plan) if each.order < 1)

    @property
    def curve(self) -> PitchCurve:
        """See `State`."""
        if self.cam is None:
            raise GeometryError("needs [follower]", key="follower")
        return self.cam.disc.pitch_curve

    def on_corner(self, phi: FloatArray, side: Side) -> BoolArray:
        """See `State`: nowhere, the flank is taken to be whole."""
        del side
        return np.zeros(len(phi), dtype=np.bool_)

    def output_extremes(self, course: TimeCourse) -> TimeExtremes:
        """See `State`."""
        return plan_extremes(self.drive.plan, course, self.drive.unit)

    def turning(self, course: TimeCourse) -> Demanded:
        """See `State`."""
        return replace(self, course=course)


# -- choice ---------------------------------------------------------------------------------------
# Which state of motion a scene states; what follows from the disc is in `Subject.state`.


def model_of(stated: Model | None, limits: Limits) -> Model:
    """What a scene states, or its default: a trimmed disc is meant to move the follower."""
    return stated or ("outline" if limits.undercut == "trim" else "demanded")


SIDES: Final[Mapping[Carrier, int]] = {
    "inner": FIRST,
    "main": FIRST,
    "outer": SECOND,
    "return": SECOND,
    "opposite": SECOND,
}


def side_named(flank: Carrier | None) -> int:
    """The side that a scene states, or its default, as `State.sense`."""
    return FIRST if flank is None else SIDES[flank]
