"""The motion that a trimmed flank makes as the state: the replay of the real outline."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

from camgeo.cam.cam import Cam
from camgeo.cam.drive import smooth_angles
from camgeo.curve.pitch_curve import PitchCurve
from camgeo.errors import GeometryError
from camgeo.motion.joints import breaks
from camgeo.motion.motion import Motion
from camgeo.motion.time_course import TimeCourse, TimeExtremes, time_extremes
from camgeo.numeric.arrays import BoolArray, FloatArray, Side
from camgeo.outline.replay_result import Replay
from camgeo.state.face_curve import FaceCurve
from camgeo.state.far import FarMotion
from camgeo.state.replayed import ReplayedMotion
from camgeo.state.state import Model, order_with


@dataclass(frozen=True)
class OfOutline:
    """The motion of a follower on its real flank; see `camgeo.state.state.State`.

    The roller that turns about a corner of the disc touches it along the normal of the path of its
    centre, as it does on a flank, so that path alone gives the direction of the contact force. A
    flat face rocks over the corner, and is pushed along its own normal, see `FaceCurve`.

    Attributes
    ----------
    cam : whose only flank is trimmed.
    replay : of that flank, on which the lift does not jump.
    course : how the cam turns; None if that is not known.
    """

    cam: Cam
    replay: Replay
    course: TimeCourse | None

    @property
    def model(self) -> Model:
        """See `State`."""
        return "outline"

    @property
    def sense(self) -> int:
        """See `State`."""
        return self.cam.contact.push

    @cached_property
    def motion(self) -> ReplayedMotion:
        """See `State`."""
        return ReplayedMotion(self.cam.drive.motion, self.replay.lift)

    @cached_property
    def output(self) -> Motion:
        """See `State`."""
        drive = self.cam.drive
        if drive.linkage is None:
            return self.motion
        return FarMotion(self.motion, drive.linkage, drive.plan)

    @property
    def is_followed(self) -> bool:
        """Whether the far end of a linkage follows over each corner, at the replay's samples."""
        phi = self.replay.phi[self.motion.on_corner(self.replay.phi, "right")]
        try:
            self.output.jet(phi, "right", 1)
        except GeometryError:
            return False
        return True

    @cached_property
    def smooth_angles(self) -> FloatArray:
        """See `State`."""
        return smooth_angles(self.motion, self.course)

    @property
    def order(self) -> int:
        """See `State`: at both ends of a corner the acceleration jumps."""
        free = self.motion.breaks
        kept = [each.order for each in breaks(self.cam.drive.plan) if each.cam_angle in free]
        own = min([0 if self.shocks else 1, *kept])
        return min(own, order_with(self.output, self.course))

    @property
    def shocks(self) -> tuple[float, ...]:
        """See `State`."""
        return tuple(self.replay.shocks.phi.tolist())

    @cached_property
    def curve(self) -> PitchCurve:
        """See `State`."""
        kind = PitchCurve if self.cam.follower.has_pitch_curve else FaceCurve
        return kind(self.motion, self.cam.follower, self.cam.rotation)

    def on_corner(self, phi: FloatArray, side: Side) -> BoolArray:
        """See `State`."""
        return self.motion.on_corner(phi, side)

    def output_extremes(self, course: TimeCourse) -> TimeExtremes:
        """See `State`."""
        return time_extremes(self.output, course, self.cam.drive.unit)

    def turning(self, course: TimeCourse) -> OfOutline:
        """See `State`."""
        return replace(self, course=course)
