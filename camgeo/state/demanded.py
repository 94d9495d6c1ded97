"""The demanded motion as the state: the cam does exactly what the scene states."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from camgeo.cam.cam import Cam
from camgeo.cam.drive import Drive, smooth_angles
from camgeo.curve.pitch_curve import PitchCurve
from camgeo.errors import GeometryError
from camgeo.motion.joints import breaks
from camgeo.motion.motion import Motion
from camgeo.motion.time_course import TimeCourse, TimeExtremes, plan_extremes
from camgeo.numeric.arrays import BoolArray, FloatArray, Side
from camgeo.state.state import Model, order_with


@dataclass(frozen=True)
class Demanded:
    """The demanded motion; see `camgeo.state.state.State`.

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
