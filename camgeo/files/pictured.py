"""A cam as pictures show it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final, Literal, Protocol

from camgeo.cam.contact import Contact
from camgeo.cam.drive import Demanded
from camgeo.motion.joints import Joint
from camgeo.numeric.arrays import ComplexArray, FloatArray
from camgeo.units import LengthUnit

if TYPE_CHECKING:  # few scenes name an effect
    from camgeo.effects.effect import Column
    from camgeo.mechanism.sketch import MechanismSketch

DWELL: Final = "dwell"
"""What a segment of the motion plan that is a rest is called."""


@dataclass(frozen=True, slots=True)
class FollowerSketch:
    """What a picture shows of the follower at cam angle 0.

    Attributes
    ----------
    kind : "guide" for a translating follower, "pivot" for an oscillating one.
    end : complex [mm], the pivot, or any point of the guide further out than the roller centre.
    face : complex [mm], the two ends of a flat face; None for a roller.
    """

    kind: Literal["guide", "pivot"]
    end: complex
    face: tuple[complex, complex] | None = None


@dataclass(frozen=True, slots=True, eq=False)
class PlanSegment:
    """A segment of the motion plan, of any length but 0.

    Attributes
    ----------
    start, end : cam angles [rad] in [0, 2 pi].
    label : name of its motion law; "dwell", or "data" for a motion by data.
    course : (n, 2) cam angles [rad] and positions [unit of the plan] of a motion by data, which is
        asked for as a whole; None for the others.
    """

    start: float
    end: float
    label: str
    course: FloatArray | None = None

    @property
    def is_dwell(self) -> bool:
        """Whether it is a rest."""
        return self.label == DWELL


@dataclass(frozen=True, slots=True, eq=False)
class PlanSketch:
    """What a picture shows of the motion plan.

    Attributes
    ----------
    of : whose motion is planned: the follower's, or with a linkage that of its far end.
    unit : of the plan's positions.
    joints : of the plan, as many as segments: joint k is where segment k begins.
    breaks : the joints, and the places inside the laws at which a derivative may jump.
    segments : by ascending cam angle, without those of no length.
    speed : of the disc [rad/s], positive; None if there is none or it varies.
    """

    of: Demanded
    unit: Literal["mm", "rad"]
    joints: tuple[Joint, ...]
    breaks: tuple[Joint, ...]
    segments: tuple[PlanSegment, ...]
    speed: float | None = None


@dataclass(frozen=True, slots=True, eq=False)
class CutOff:
    """What a picture shows of a flank where the disc has a corner.

    Attributes
    ----------
    flank : "inner" or "outer".
    start, end : cam angles [rad] of the flank at the corner, start in [0, 2 pi), end above it.
    course : (n,) complex [mm], the flank between them, which is not on the disc; it begins and ends
        in the corner.
    """

    flank: str
    start: float
    end: float
    course: ComplexArray

    @property
    def corner(self) -> complex:
        """The corner [mm]."""
        return complex(self.course[0])


class PicturedDrive(Protocol):
    """What pictures show of a motion; `camgeo.views.moving.PicturedMotion` is one."""

    @property
    def lift_unit(self) -> Literal["mm", "rad"]:
        """Unit of `quantity("s", ...)`."""

    @property
    def plan_sketch(self) -> PlanSketch: ...

    def quantity(self, what: str, phi: FloatArray) -> FloatArray:
        """(n,) values at `phi` (n,) [rad]: "s", "s1", "s2", "s3", the lift and its derivatives [mm
        or rad per rad^k].
        """


class Moved(Protocol):
    """What the picture of a motion reads: a `camgeo.files.product.Product`, or the motion alone."""

    @property
    def name(self) -> str: ...

    @property
    def unit(self) -> LengthUnit: ...

    @property
    def pictured(self) -> PicturedDrive: ...


class Pictured(PicturedDrive, Protocol):
    """What pictures show of a cam; `camgeo.views.pictured.PicturedCam` is one."""

    @property
    def contact(self) -> Contact:
        """The flank on which the roller runs."""

    @property
    def rotation(self) -> int:
        """Sense in which the disc turns: +1 counter-clockwise, -1 clockwise."""

    @property
    def roller_radius(self) -> float:
        """Radius r_R of the roller [mm], 0 for a knife edge."""

    @property
    def flank_distance(self) -> float:
        """Distance of either flank from the pitch curve [mm]: r_R, or half the groove's width."""

    @property
    def has_pitch_curve(self) -> bool:
        """False of a flat face, whose contact runs on the outline itself."""

    @property
    def joints(self) -> tuple[float, ...]:
        """Cam angles [rad] at which the segments of the motion plan begin, from 0 upwards."""

    @property
    def far_angle(self) -> float:
        """The cam angle [rad] at which the demanded motion is farthest from its start."""

    @property
    def effect_columns(self) -> tuple[Column, ...]:
        """The effects that the scene calls for, over the cam angle."""

    @property
    def follower_sketch(self) -> FollowerSketch: ...

    def mechanism_sketch(self, phi: float) -> MechanismSketch:
        """The mechanism at the cam angle `phi` [rad]."""

    @property
    def cut_off(self) -> tuple[CutOff, ...]:
        """Where the flanks in use are cut off; empty also if it cannot be told what is left."""

    def curve(self, what: str, phi: FloatArray) -> FloatArray:
        """(n, 2) [mm] points of "pitch", "inner" or "outer" at the cam angles `phi` (n,) [rad]."""

    def quantity(self, what: str, phi: FloatArray) -> FloatArray:
        """(n,) values at `phi` (n,) [rad]: those of a motion, "transmission_angle" [rad], and
        "curvature" [1/mm].
        """
