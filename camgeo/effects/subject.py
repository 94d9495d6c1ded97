"""A cam as its effects see it."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Literal, Protocol

if TYPE_CHECKING:
    from camgeo.cam.cam import Cam
    from camgeo.cam.contact import Contact
    from camgeo.curve.pitch_curve import PitchCurve
    from camgeo.curve.working_curve import WorkingCurve
    from camgeo.mechanism.kinds import AnyFollower
    from camgeo.mechanism.linkage_protocol import Linkage
    from camgeo.motion.motion import Motion
    from camgeo.motion.plan import MotionPlan
    from camgeo.motion.time_course import TimeCourse
    from camgeo.numeric.arrays import FloatArray
    from camgeo.outline.outline import Outline
    from camgeo.outline.path import Path
    from camgeo.part.part import Part
    from camgeo.part.spec import PartSpec
    from camgeo.units import LengthUnit


class HasPart(Protocol):
    """What makes the part when it is asked for."""

    @property
    def part(self) -> Part: ...


@dataclass(frozen=True)
class CamSubject:
    """A `camgeo.effects.effect.Subject`.

    Attributes
    ----------
    cam : the cam.
    unit : of length of the scene, for sentences; values are in mm.
    part_spec : what the scene says of the part.
    made : gives the part.
    returning : the return disc of a conjugate pair, of the same motion; None if there is none.
    """

    cam: Cam
    unit: LengthUnit
    part_spec: PartSpec | None
    made: HasPart = field(repr=False, compare=False)
    returning: CamSubject | None = None

    def beside(self, other: CamSubject) -> CamSubject:
        """The same with the return disc `other`."""
        return replace(self, returning=other)

    @property
    def rotation(self) -> int:
        """See `Subject`."""
        return self.cam.rotation

    @property
    def contact(self) -> Contact:
        """See `Subject`."""
        return self.cam.contact

    @property
    def side_clearance(self) -> float:
        """See `Subject`."""
        return self.cam.clearance

    @property
    def flank_distance(self) -> float:
        """See `Subject`."""
        return self.cam.disc.flank_distance

    @property
    def plan(self) -> MotionPlan:
        """See `Subject`."""
        return self.cam.drive.plan

    @property
    def linkage(self) -> Linkage | None:
        """See `Subject`."""
        return self.cam.drive.linkage

    @property
    def follower(self) -> AnyFollower:
        """See `Subject`."""
        return self.cam.follower

    @property
    def has_yoke(self) -> bool:
        """See `Subject`."""
        return self.cam.yoke is not None

    @property
    def motion(self) -> Motion:
        """See `Subject`."""
        return self.cam.drive.motion

    @property
    def lift_unit(self) -> Literal["mm", "rad"]:
        """See `Subject`."""
        return self.cam.lift_unit

    @property
    def pitch_curve(self) -> PitchCurve:
        """See `Subject`."""
        return self.cam.disc.pitch_curve

    @property
    def inner_curve(self) -> WorkingCurve:
        """See `Subject`."""
        return self.cam.disc.inner_curve

    @property
    def outer_curve(self) -> WorkingCurve:
        """See `Subject`."""
        return self.cam.disc.outer_curve

    @property
    def time_course(self) -> TimeCourse | None:
        """See `Subject`."""
        return self.cam.drive.time_course

    @property
    def smooth_angles(self) -> FloatArray:
        """See `Subject`."""
        return self.cam.drive.smooth_angles

    @property
    def part(self) -> Part:
        """See `Subject`."""
        return self.made.part

    def outline(self, flank: str) -> Outline:
        """See `Subject`."""
        return self.cam.disc.outline(flank)

    @property
    def flank_paths(self) -> tuple[Path, Path]:
        """See `Subject`."""
        return self.cam.disc.flank_paths
