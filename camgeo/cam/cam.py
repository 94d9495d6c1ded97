"""A cam: a drive, a follower with its contact, and the body that moves the follower."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from enum import StrEnum
from functools import cached_property
from typing import TYPE_CHECKING, Any, ClassVar, Final, Literal

import numpy as np

from camgeo.errors import GeometryError
from camgeo.geometry.outline.path import Flank, Path, whole
from camgeo.geometry.pieces import Extremes, curvature_extremes, extremes
from camgeo.geometry.pitch_curve import PitchCurve, WorkingCurve
from camgeo.kinematics.mechanism.linkage import FarEnd, Linkage, linked
from camgeo.kinematics.mechanism.values import Length, Member
from camgeo.kinematics.motion import Jet, MergedDwell, Motion, turning_angles
from camgeo.kinematics.plan import MotionPlan
from camgeo.lazy import Ledger, built, lazy
from camgeo.numeric.arrays import FloatArray, Side, merged
from camgeo.numeric.checked import check_fields, hold, one_of
from camgeo.numeric.kept import kept_with_owner
from camgeo.record import Pickled
from camgeo.units import TURN, LiftUnit

if TYPE_CHECKING:
    from camgeo.geometry.outline.outline import Outline
    from camgeo.geometry.outline.replay import Replay
    from camgeo.kinematics.mechanism.follower import Follower
    from camgeo.kinematics.mechanism.rollers import Mount
    from camgeo.kinematics.time_course import SpeedCurve, TimeCourse


# -- contact --------------------------------------------------------------------------------------
# The flank or flanks of the disc on which the follower runs.


class Contact(StrEnum):
    """A contact, by its name in scenes."""

    INNER = "inner"
    OUTER = "outer"
    GROOVE = "groove"

    @property
    def flanks(self) -> tuple[Flank, ...]:
        """The flanks in use, the inner one first."""
        return tuple(Flank) if self is Contact.GROOVE else (Flank(self.value),)

    @property
    def closed_by_form(self) -> bool:
        """Whether the roller is guided on both sides."""
        return len(self.flanks) > 1

    @property
    def runs_inside(self) -> bool:
        """Whether a flank in use encloses material around the cam axis; false for a ring."""
        return Flank.INNER in self.flanks

    @property
    def is_plate(self) -> bool:
        """Whether the disc is a plate whose outline is the flank."""
        return self is Contact.INNER

    @property
    def main(self) -> Flank:
        """The flank against which the follower is pressed; for a groove the inner one."""
        return self.flanks[0]

    @property
    def push(self) -> int:
        """Sign of the force that presses the follower onto the `main` flank, positive outward."""
        return -self.main.sign

    def distances(self, half: float) -> dict[Flank, float]:
        """Signed distance [mm] of each flank in use from the pitch curve.

        `half` is the distance of either flank [mm], positive outward: the inner one lies at -half.
        """
        return {flank: flank.sign * half for flank in self.flanks}


def contact_by_name(key: str, value: object) -> Contact:
    """The contact with the name `value`; GeometryError with `key` if there is none."""
    return Contact(one_of(key, value, [contact.value for contact in Contact]))


# -- disc -----------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Disc(Pickled):
    """The curves of a disc, on demand; GeometryError if the mechanism is impossible.

    Attributes
    ----------
    drive : what moves the follower.
    follower : the follower that touches the disc.
    rotation : sense in which the disc turns: +1 counter-clockwise, -1 clockwise.
    contact : the flank on which the follower runs; both for a groove.
    clearance : width of the groove minus the diameter of the roller [mm].
    """

    drive: Drive
    follower: Follower
    rotation: int = 1
    contact: Contact = Contact.INNER
    clearance: float = 0.0
    ledger: Ledger = field(default_factory=Ledger, repr=False, compare=False)

    @property
    def flank_distance(self) -> float:
        """Distance of either flank from the pitch curve [mm]: r_R, or half the groove's width."""
        return self.follower.roller_radius + 0.5 * self.clearance

    def __post_init__(self) -> None:
        hold(self, contact=contact_by_name("follower.contact", self.contact))

    @lazy
    def pitch_curve(self) -> PitchCurve:
        """The pitch curve in cam coordinates; for a flat face the outline itself."""
        return PitchCurve(self.drive.motion, self.follower, self.rotation)

    @lazy
    def inner_curve(self) -> WorkingCurve:
        """The inner working curve."""
        return WorkingCurve(self.pitch_curve, -self.flank_distance)

    @lazy
    def outer_curve(self) -> WorkingCurve:
        """The outer working curve."""
        return WorkingCurve(self.pitch_curve, self.flank_distance)

    @property
    def flanks(self) -> tuple[tuple[str, WorkingCurve], ...]:
        """The working curves in use, with their names, the inner one first."""
        return tuple((flank, self.curve(flank)) for flank in self.contact.flanks)

    def curve(self, flank: Flank) -> WorkingCurve:
        """The working curve of a flank."""
        return {Flank.INNER: self.inner_curve, Flank.OUTER: self.outer_curve}[flank]

    @lazy
    def bends(self) -> Extremes:
        """The extremes of the pitch curve's curvature; GeometryError if the curve stands still
        somewhere, so that it has none.

        Every extreme that could cause undercut on a flank in use is guaranteed to be included.
        """
        bends = curvature_extremes(self.pitch_curve)
        if not self.follower.has_pitch_curve:
            return bends
        from camgeo.geometry.outline.outline import sure_bends

        for _, flank in self.flanks:
            bends = sure_bends(flank, bends)
        return bends

    @lazy
    def inner_outline(self) -> Outline:
        """What remains of the inner flank, see `camgeo.geometry.outline.outline.real_outline`."""
        from camgeo.geometry.outline.outline import real_outline

        return real_outline(self.inner_curve, self.bends if self.follower.has_pitch_curve else None)

    @lazy
    def outer_outline(self) -> Outline:
        """What remains of the outer flank, see `camgeo.geometry.outline.outline.real_outline`."""
        from camgeo.geometry.outline.outline import real_outline

        return real_outline(self.outer_curve, self.bends)

    def outline(self, flank: str) -> Outline:
        """What remains of the "inner" or "outer" flank."""
        remainder: Outline = getattr(self, f"{Flank(flank)}_outline")
        return remainder

    def replay(self, flank: str) -> Replay:
        """The roller pressed against what remains of the "inner" or "outer" flank.

        In a groove with side clearance the roller is treated without play: lost stroke adds to the
        play.
        """
        from camgeo.geometry.outline.replay import replay_outline  # only needed with undercut

        path = self.outline(flank).path
        with self.ledger.entry(f"replay of {flank} flank"):
            return replay_outline(self.pitch_curve, path)

    @property
    def pitch_path(self) -> Path:
        """The pitch curve, with its corners where the velocity jumps."""
        from camgeo.geometry.outline.envelope import Envelope

        return Path(Envelope(WorkingCurve(self.pitch_curve, 0.0)).elements)

    @property
    def untrimmed_paths(self) -> tuple[Path, Path]:
        """Inner and outer flank all round, with what undercut would cut off."""
        from camgeo.geometry.outline.envelope import Envelope

        inner, outer = (Path(Envelope(self.curve(flank)).elements) for flank in Flank)
        return inner, outer

    @property
    def flank_paths(self) -> tuple[Path, Path]:
        """Inner and outer outline; the whole curve for the flank on which no roller runs."""
        used = self.contact.flanks
        inner, outer = (
            self.outline(flank).path if flank in used else whole(self.curve(flank))
            for flank in Flank
        )
        return inner, outer


# -- cam ------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Cam(Pickled):
    """One disc with its drive and follower; a conjugate pair is two cams with one drive.

    Attributes
    ----------
    drive : gives the prescribed motion.
    follower : the follower that touches the disc.
    rotation, contact, clearance : as for `Disc`.
    yoke : the other side of the follower on a cam of constant breadth; None if there is none.
    mount : for the return cam of a conjugate pair, how its roller is fixed to the main follower;
        None for a main cam.
    """

    drive: Drive
    follower: Follower
    rotation: int = 1
    contact: Contact = Contact.INNER
    clearance: float = 0.0
    yoke: Yoke | None = None
    mount: Mount | None = None
    ledger: Ledger = field(default_factory=Ledger, repr=False, compare=False)

    def __post_init__(self) -> None:
        hold(self, contact=contact_by_name("follower.contact", self.contact))

    @built
    def disc(self) -> Disc:
        """The body."""
        return Disc(
            self.drive, self.follower, self.rotation, self.contact, self.clearance, self.ledger
        )

    @property
    def lift_unit(self) -> LiftUnit:
        """Unit of the follower's own motion."""
        return self.follower.lift_unit

    @property
    def distances(self) -> tuple[float, ...]:
        """d [mm] of each flank in use: negative for the inner one, positive for the outer one."""
        return tuple(self.contact.distances(self.disc.flank_distance).values())

    @built
    def breadth(self) -> Breadth | None:
        """Width of the disc between the two sides of its yoke; None if there is no yoke."""
        if self.yoke is None:
            return None

        return Breadth(self.drive.motion, self.follower.base_radius, self.follower.reach)

    @property
    def yoke_breadth(self) -> float:
        """Distance between the two sides of the yoke [mm], see `Yoke`; 0 without one."""
        if self.yoke is None or self.breadth is None:
            return 0.0
        return self.breadth.best if self.yoke.breadth is None else self.yoke.breadth

    @built
    def opposite(self) -> Cam | None:
        """The same disc as a cam for the second side of the yoke, with the same drive; None without
        a yoke. Raises GeometryError as `Breadth.opposite`.
        """
        if self.breadth is None:
            return None
        second = self.breadth.opposite(self.follower)
        return replace(self, follower=second, ledger=self.ledger.named(" of the opposite side"))

    def sized(self, **sizes: complex) -> Cam:
        """The same cam with other dimensions of the follower; GeometryError if they are
        impossible.

        The drive is shared, so its linkage is not checked over the turn again.
        """
        changes: dict[str, Any] = dict(sizes)
        follower: Any = self.follower  # a frozen dataclass
        return replace(self, follower=replace(follower, **changes), ledger=Ledger())

    def moved(self, plan: MotionPlan) -> Cam:
        """The same cam with another motion plan."""
        ledger = Ledger()
        return replace(self, drive=replace(self.drive, plan=plan, ledger=ledger), ledger=ledger)


# -- breadth --------------------------------------------------------------------------------------
# Width of a cam of constant breadth between the two sides of its yoke.
#
# A yoke holds two parallel faces, or two rollers in line with the cam axis, at a fixed distance b.
# The follower's height above the axis is h(phi) = h_0 + kappa_F s(phi) on one side; on the other
# side the cam requires h(phi + pi), as the yoke does not turn. So the width of the cam is
#
#     w(phi) = h(phi) + h(phi + pi),
#
# and it must be b at every cam angle.


HALF = 0.5 * TURN

ROUNDING: Final = 1e-12
"""Widths that differ by less than this fraction of the largest one are equal except for
rounding."""


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
        return _add_opposite_angles(self.motion.breaks)

    @property
    def borders(self) -> FloatArray:
        """(k,) cam angles [rad] at which the formula changes on either side."""
        return _add_opposite_angles(self.motion.borders)

    dwells: ClassVar[tuple[MergedDwell, ...]] = ()
    """Empty: where both sides dwell, the slope is 0, and the search for extremes needs no more."""

    def width(self, phi: FloatArray, side: Side = "right") -> FloatArray:
        """(n,) w [mm] at `phi` (n,) [rad]."""
        return 2.0 * self.height + self.reach * self._sum(phi, side, 0)

    def slope(self, phi: FloatArray, side: Side = "right") -> FloatArray:
        """(n,) w' [mm/rad]."""
        return self.reach * self._sum(phi, side, 1)

    def _sum(self, phi: FloatArray, side: Side, order: int) -> FloatArray:
        # The other side of the yoke touches the cam half a turn away: w(phi) = h(phi) + h(phi +
        # pi).
        one = self.motion.jet(phi, side, 1)[order]
        other = self.motion.jet(phi + HALF, side, 1)[order]
        return np.asarray(one + other)

    @cached_property
    def range(self) -> tuple[tuple[float, float], tuple[float, float]]:
        """Least and largest width [mm], each with its cam angle [rad]."""
        width_extremes = extremes(self, self.width, self.slope)
        return width_extremes.smallest(), width_extremes.largest()

    @property
    def best(self) -> float:
        """The breadth of the yoke [mm] whose largest difference from the width is smallest."""
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

        It is the first one rotated by half a turn about the cam axis, and what moves one of them
        outward moves the other inward. The breadth used is `best`, not that of the yoke: play in
        the yoke changes nothing in the disc.

        Raises
        ------
        GeometryError
            With key "follower.yoke", if the cam is so far from constant breadth that there is none.
        """
        first: Any = follower  # only followers in a guide have a yoke
        # The widest and the narrowest place differ from `best` by the same amount, so the second
        # side starts at what the first one leaves of it.
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
            # Stays within the range of a guide's angle, one turn either way.
            guide_angle=angle - HALF if angle > 0.0 else angle + HALF,
            # The yoke moves as a whole: outward on one side is inward on the other.
            direction=-first.direction,
        )
        return turned


def _add_opposite_angles(angles: FloatArray) -> FloatArray:
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


# -- drive ----------------------------------------------------------------------------------------
# A drive: the prescribed motion, the linkage ahead of the follower, and the speed of the cam.
#
# It needs no disc: motion, time and kinematics follow from it alone.


Demanded = Literal["follower"] | Member
"""The member whose motion is prescribed: the follower, or the far end of a linkage."""


@kept_with_owner
def far_end(plan: MotionPlan, linkage: Linkage) -> FarEnd:
    """The far end of `linkage` with the demanded motion `plan`."""
    return FarEnd(plan, linkage)


@dataclass(frozen=True)
class Drive(Pickled):
    """The drive of the follower; everything is computed on demand.

    Cam angles are in radians, any number of turns, arrays (n,); lengths in mm.

    Attributes
    ----------
    plan : the prescribed motion: of the far end of a linkage if there is one, else of the follower.
    linkage : linkage between plan and follower, or None.
    unit : unit of the plan's positions.
    speed : angular speed of the cam [rad/s], above 0; the mean if it varies, None if none is
        stated.
    speed_curve : variation of the speed over the turn; None for constant speed.
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
    def demanded_member(self) -> Demanded:
        """The member whose motion is prescribed: the follower, or the far end of the linkage."""
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

        return far_end(self.plan, self.linkage)

    @lazy
    def time_course(self) -> TimeCourse | None:
        """The rotation of the cam over time; None if no speed is stated."""
        if self.speed_curve is not None:
            return self.speed_curve
        from camgeo.kinematics.time_course import ConstantSpeed

        return None if self.speed is None else ConstantSpeed(self.speed)

    def in_time(self, phi: FloatArray, side: Side = "right") -> Jet:
        """(4, n) position, velocity, acceleration, jerk [mm or rad per s^k] of the plan at `phi`.

        Raises GeometryError if there is no speed.
        """
        if self.time_course is None:
            raise GeometryError(
                "motion over time needs [cam] speed or speed_curve", key="cam.speed"
            )
        from camgeo.kinematics.time_course import in_time

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
        angles = merged(np.concatenate((self.plan.borders, turning_angles(self.plan))))
        return float(angles[np.argmax(np.abs(self.plan.jet(angles)[0]))]) if len(angles) else 0.0


def smooth_angles(motion: Motion, course: TimeCourse | None) -> FloatArray:
    """(k,) cam angles [rad] as described at `Drive.smooth_angles`, for a follower with this
    `motion` and a cam that turns by `course`, at constant speed if None.
    """
    edges = [motion.borders, turning_angles(motion), np.array([0.0, TURN])]
    if course is not None:
        edges.append(course.borders)
    return merged(np.concatenate(edges))
