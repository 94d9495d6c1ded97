"""The motion that a disc makes as it is: what remains of a flank that is trimmed, or the contour as
it is written into a file, with its lines, arcs or cubics.

A written contour keeps to the exact curve within a tolerance, and its tangents and curvatures less
and less closely: the lift is off by the tolerance over the sine of the transmission angle, the
acceleration by the error of the curvature.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import ClassVar, Final, Protocol, Self

import numpy as np

from camgeo.cam.cam import Cam, smooth_angles
from camgeo.dynamics.state.state import FIRST, SECOND, Demanded, Model, time_order
from camgeo.errors import GeometryError
from camgeo.geometry.contour.contour import Contour, Effort, Form
from camgeo.geometry.contour.spline import SplineContour
from camgeo.geometry.outline.path import Flank
from camgeo.geometry.outline.replay import Replay, extreme_play, replay_contour, replay_spline
from camgeo.geometry.outline.roller import AS_DEMANDED, DiscLift
from camgeo.geometry.pitch_curve import PitchCurve
from camgeo.kinematics.mechanism.flat import FlatFollower, flat_follower
from camgeo.kinematics.mechanism.follower import RelativeJet
from camgeo.kinematics.mechanism.linkage import Linkage
from camgeo.kinematics.motion import FULL_ORDER, Jet, MergedDwell, Motion
from camgeo.kinematics.plan import breaks
from camgeo.kinematics.time_course import TimeCourse, TimeExtremes, time_extremes
from camgeo.numeric.arrays import BoolArray, FloatArray, IntArray, Side, ascending, read_only
from camgeo.numeric.extremes import Extreme, Extremes
from camgeo.numeric.kept import Answers
from camgeo.part.part import Part, written_contour
from camgeo.units import TURN

KEY: Final = "state.motion"
MODEL: Final[Model] = "written"


@dataclass(frozen=True)
class OnDisc:
    """The common part of states whose follower goes along its disc as it is, not as demanded.

    Attributes
    ----------
    cam : that sees the motion.
    replay : of the follower on the disc; the lift does not jump.
    course : how the cam turns; None if that is not known.
    """

    cam: Cam
    replay: Replay
    course: TimeCourse | None

    @property
    def motion(self) -> Motion:
        """See `State`."""
        raise NotImplementedError

    @cached_property
    def output(self) -> Motion:
        """See `State`."""
        drive = self.cam.drive
        if drive.linkage is None:
            return self.motion
        return FarMotion(self.motion, drive.linkage, drive.plan)

    @cached_property
    def smooth_angles(self) -> FloatArray:
        """See `State`."""
        return smooth_angles(self.motion, self.course)

    @property
    def shocks(self) -> tuple[float, ...]:
        """See `State`: where the roller touches two pieces in a corner that turns in, and where a
        flat face lies on a straight piece or bridges a hollow.
        """
        return tuple(self.replay.shocks.phi.tolist())

    @cached_property
    def curve(self) -> PitchCurve:
        """See `State`."""
        kind = PitchCurve if self.cam.follower.has_pitch_curve else FaceCurve
        return kind(self.motion, self.cam.follower, self.cam.rotation)

    def output_extremes(self, course: TimeCourse) -> TimeExtremes:
        """See `State`."""
        return time_extremes(self.output, course, self.cam.drive.unit)

    def turning(self, course: TimeCourse) -> Self:
        """See `State`."""
        return replace(self, course=course)


# -- far ------------------------------------------------------------------------------------------
# The motion of the far end of a linkage that the follower drives.


STEPS = 12
"""Most Newton steps; from a demanded position that is off by a tolerance a few are enough."""

SETTLED = 1e-9
"""After a step below this share of the largest position no other one is needed: the next would be
of the order of its square."""


@dataclass(frozen=True)
class FarMotion:
    """The motion of the far end for a motion of the follower near the demanded one; see `Motion`.

    With q = T(x) from the far end's position x to the follower's coordinate q, the chain rule gives
    q' = T_1 x', q'' = T_1 x'' + T_2 x'^2 and q''' = T_1 x''' + 3 T_2 x' x'' + T_3 x'^3.

    Attributes
    ----------
    follower : the motion of the follower.
    linkage : between both.
    demanded : of the far end, near which its positions are searched for.
    """

    follower: Motion
    linkage: Linkage
    demanded: Motion
    _jets: Answers[Jet] = field(default_factory=Answers, init=False, repr=False, compare=False)

    @property
    def breaks(self) -> FloatArray:
        """See `Motion`."""
        return self.follower.breaks

    @property
    def borders(self) -> FloatArray:
        """See `Motion`."""
        return self.follower.borders

    @property
    def dwells(self) -> tuple[MergedDwell, ...]:
        """See `Motion`: it rests with the follower."""
        return self.follower.dwells

    def jet(self, phi: FloatArray, side: Side = "right", order: int = FULL_ORDER) -> Jet:
        """See `Motion`. Read-only, and the same values for recent requests, like those of a plan.

        Raises
        ------
        GeometryError
            If the follower goes beyond a dead centre of the linkage, or rests there.
        """
        jet = self._jets.recall(lambda: read_only(self._jet(phi, side)), side, phi)
        return jet[: order + 1]

    def _jet(self, phi: FloatArray, side: Side) -> Jet:
        """(4, n) position and derivatives."""
        follower = self.follower.jet(phi, side, FULL_ORDER)
        x = self.demanded.jet(phi, side, 1)[0].copy()
        scale = max(1.0, float(np.max(np.abs(x), initial=0.0)))
        # Beyond a dead centre the slope of the linkage changes its sign.
        sense = np.sign(self._along(x, 1)[1])
        for _ in range(STEPS):
            here, slope = self._along(x, 1)
            if np.any(slope * sense <= 0.0):  # beyond a dead centre the far end moves the other way
                raise _dead_centre_error()
            step = (follower[0] - here) / slope
            x = x + step
            if np.max(np.abs(step), initial=0.0) <= SETTLED * scale:
                break
        else:
            raise _dead_centre_error()
        _, first, second, third = self._along(x, FULL_ORDER)
        jet = np.empty_like(follower)
        jet[0] = x
        # The chain rule, solved for x', x'' and x''' one after the other.
        jet[1] = follower[1] / first
        jet[2] = (follower[2] - second * jet[1] ** 2) / first
        jet[3] = (follower[3] - 3.0 * second * jet[1] * jet[2] - third * jet[1] ** 3) / first
        return jet

    def _along(self, x: FloatArray, order: int) -> Jet:
        """(order + 1, n) the follower's coordinate and its derivatives by the position `x` (n,)."""
        way = np.zeros((4, len(x)))
        way[0], way[1] = x, 1.0
        return self.linkage.transform(way, order)

    def jet_and_bounds(self, low: FloatArray, high: FloatArray) -> tuple[Jet, Jet]:
        """See `Motion`: without any bound."""
        jet = self.jet(0.5 * (low + high))
        return jet, np.full_like(jet, np.inf)


def _dead_centre_error() -> GeometryError:
    return GeometryError(
        "the far end cannot follow the motion that the disc gives the follower: the linkage is at a"
        " dead centre",
        key="linkage",
    )


# -- outline --------------------------------------------------------------------------------------
# The motion that a trimmed flank makes: the replay of the real outline.


@dataclass(frozen=True)
class OutlineState(OnDisc):
    """The motion of a follower on its real flank; see `State`.

    The roller that turns about a corner of the disc touches it along the normal of the path of its
    centre, as it does on a flank, so that path alone gives the direction of the contact force. A
    flat face rocks over the corner, and is pushed along its own normal, see `FaceCurve`.

    The only flank of its `cam` is trimmed, and on its `replay` the lift does not jump.
    """

    model: ClassVar[Model] = "outline"

    @property
    def sense(self) -> int:
        """See `State`."""
        return self.cam.contact.push

    @cached_property
    def motion(self) -> ReplayedMotion:
        """See `State`."""
        return ReplayedMotion(self.cam.drive.motion, self.replay.lift)

    @property
    def is_followed(self) -> bool:
        """Whether the far end of a linkage follows over each corner, at the replay's samples."""
        phi = self.replay.phi[self.motion.on_corner(self.replay.phi, "right")]
        try:
            self.output.jet(phi, "right", 1)
        except GeometryError:
            return False
        return True

    @property
    def order(self) -> int:
        """See `State`: at both ends of a corner the acceleration jumps."""
        free = self.motion.breaks
        orders = [joint.order for joint in breaks(self.cam.drive.plan) if joint.cam_angle in free]
        joint_order = min([0 if self.shocks else 1, *orders])
        return min(joint_order, time_order(self.output, self.course))

    def on_corner(self, phi: FloatArray, side: Side) -> BoolArray:
        """See `State`."""
        return self.motion.on_corner(phi, side)


# -- replayed -------------------------------------------------------------------------------------
# The motion of a follower that is pressed against what remains of its flank.


SEAM = 1e-9
"""Ranges of the cam angle [rad] this short are rounding."""


@dataclass(frozen=True)
class ReplayedMotion:
    """The demanded motion where the flank is whole, and the motion over its corners; see `Motion`.

    On a corner the roller turns about a point of the disc, over which a flat face rocks, so the
    lift and three derivatives are known in closed form
    (`camgeo.kinematics.mechanism.follower_path.Bows.lift_jet`,
    `camgeo.geometry.outline.face.GuidedFace.jet`).

    Attributes
    ----------
    demanded : the follower's demanded motion.
    lift : on the disc, without play.
    """

    demanded: Motion
    lift: DiscLift

    @cached_property
    def ranges(self) -> tuple[tuple[float, float], ...]:
        """Start in [0, 2 pi) and end [rad] of each range over which one corner holds the roller; an
        end may be beyond a turn.
        """
        starts = self.lift.borders
        if not len(starts):
            return ()
        ends = np.append(starts[1:], starts[0] + TURN)
        # The ranges run from border to border, the last one past the end of the turn.
        held = (self.lift.numbers != AS_DEMANDED) & (ends - starts > SEAM)
        return tuple(zip(starts[held].tolist(), ends[held].tolist(), strict=True))

    @cached_property
    def breaks(self) -> FloatArray:
        """See `Motion`."""
        return self._with_corners(self.demanded.breaks)

    @cached_property
    def borders(self) -> FloatArray:
        """See `Motion`."""
        return self._with_corners(self.demanded.borders)

    def _with_corners(self, places: FloatArray) -> FloatArray:
        """(k,) those of `places` [rad] at which no corner holds the roller, and ends of corners."""
        free = np.ones(len(places), dtype=np.bool_)
        for start, end in self.ranges:
            free &= np.remainder(places - start, TURN) >= end - start
        ends = np.array(self.ranges).ravel() % TURN
        return ascending(np.concatenate((places[free], ends)))

    @cached_property
    def dwells(self) -> tuple[MergedDwell, ...]:
        """The remaining parts of the demanded dwells, see `Motion`."""
        return tuple(
            part for dwell in self.demanded.dwells for part in self._remaining_dwells(dwell)
        )

    def _remaining_dwells(self, dwell: MergedDwell) -> Iterator[MergedDwell]:
        start, end = dwell.start, dwell.start + dwell.span
        corners = [
            # A corner may hold the follower across cam angle 0.
            (low + turn, high + turn)
            for low, high in self.ranges
            for turn in (-TURN, 0.0, TURN)
        ]
        for low, high in sorted(corners):
            if high <= start or low >= end:
                continue
            if low - start > SEAM:
                yield MergedDwell(start % TURN, low - start)
            start = high
        if end - start > SEAM:
            yield MergedDwell(start % TURN, end - start)

    def on_corner(self, phi: FloatArray, side: Side) -> BoolArray:
        """(n,) whether a corner of the disc holds the follower at `phi` (n,) [rad]."""
        return np.asarray(self.lift.number(phi, side) != AS_DEMANDED)

    def jet(self, phi: FloatArray, side: Side = "right", order: int = FULL_ORDER) -> Jet:
        """See `Motion`."""
        return self.lift.jet(phi, side, 3)[: order + 1]

    def jet_and_bounds(self, low: FloatArray, high: FloatArray) -> tuple[Jet, Jet]:
        """See `Motion`; the bounds are infinite where a corner holds the roller."""
        jet, bounds = self.demanded.jet_and_bounds(low, high)
        middle = 0.5 * (low + high)
        held = self.on_corner(middle, "right")
        jet, bounds = jet.copy(), bounds.copy()
        jet[:, held] = self.jet(middle[held])
        bounds[:, held] = np.inf
        return jet, bounds


# -- written --------------------------------------------------------------------------------------
# The motion on a contour of pieces.


RESTING = 1e-10
"""A piece over which the derivatives of the lift are below this share of the largest of the turn is
an arc about the cam axis: the follower rests."""


@dataclass(frozen=True)
class WrittenMotion:
    """The motion of a follower on a contour of pieces, without linkage; see `Motion`.

    Attributes
    ----------
    lift : on the contour, with all its pieces.
    """

    lift: DiscLift
    _jets: Answers[Jet] = field(default_factory=Answers, init=False, repr=False, compare=False)

    @property
    def breaks(self) -> FloatArray:
        """See `Motion`: where the follower passes from piece to piece."""
        return self.lift.borders

    @property
    def borders(self) -> FloatArray:
        """See `Motion`."""
        return self.lift.borders

    @cached_property
    def _rests(self) -> BoolArray:
        """(k,) whether the follower rests from each of the borders to the next."""
        starts = self.lift.borders
        # A piece is an arc about the axis all over or not at all: its middle tells.
        middles = 0.5 * (starts + np.append(starts[1:], starts[0] + TURN))
        rates = np.abs(self.lift.jet(middles, "right", 3)[1:])
        most = np.max(rates, axis=1, keepdims=True)
        return np.asarray(np.all(rates <= RESTING * most, axis=0))

    @cached_property
    def dwells(self) -> tuple[MergedDwell, ...]:
        """See `Motion`."""
        starts, rests = self.lift.borders, self._rests
        if np.all(rests):
            return (MergedDwell(0.0, TURN),)
        # Pieces that rest one after the other are one dwell, also across cam angle 0.
        firsts = np.flatnonzero(rests & ~np.roll(rests, 1))
        ends = np.flatnonzero(~rests & np.roll(rests, 1))
        pauses = []
        for first in firsts.tolist():
            end = ends[np.argmin(np.remainder(ends - first, len(starts)))]
            span = float(starts[end] - starts[first]) % TURN
            pauses.append(MergedDwell(float(starts[first]), span))
        return tuple(pauses)

    def jet(self, phi: FloatArray, side: Side = "right", order: int = FULL_ORDER) -> Jet:
        """See `Motion`; the derivatives of a rest are 0, without rounding.

        Read-only, and the same values for recent requests, like those of a plan.
        """

        def compute_jet() -> Jet:
            jet = self.lift.jet(phi, side, 3)
            jet[1:, self._rests[self.piece(phi, side)]] = 0.0
            return read_only(jet)

        return self._jets.recall(compute_jet, side, phi)[: order + 1]

    def piece(self, phi: FloatArray, side: Side) -> IntArray:
        """(n,) number of the range between borders at `phi` (n,) [rad], from 0."""
        number = np.searchsorted(self.lift.borders, np.remainder(phi, TURN), side) - 1
        return np.asarray(number, dtype=np.intp)

    def on_corner(self, phi: FloatArray, side: Side) -> BoolArray:
        """(n,) whether a vertex of the contour holds the follower at `phi` (n,) [rad]."""
        elements, _ = self.lift.holding_elements(self.lift.number(phi, side))
        return np.asarray(elements < 0)

    def jet_and_bounds(self, low: FloatArray, high: FloatArray) -> tuple[Jet, Jet]:
        """See `Motion`: without any bound."""
        jet = self.jet(0.5 * (low + high))
        return jet, np.full_like(jet, np.inf)


@dataclass(frozen=True)
class Written(OnDisc):
    """The motion on a written contour; see `State`.

    The roller touches a vertex of the contour as it does a piece, along the normal of the path of
    its centre. A flat face touches the convex hull of the contour, see
    `camgeo.geometry.outline.face`.

    Attributes
    ----------
    contour : as files have it.
    deviation : proved, of the contour from the exact curve [mm].
    sense : see `State`.
    touches : whether it is this cam's contour, not that of the other disc of a pair.
    """

    contour: Contour | SplineContour
    deviation: float
    sense: int
    touches: bool = True

    model: ClassVar[Model] = MODEL

    @cached_property
    def motion(self) -> WrittenMotion:
        """See `State`."""
        return WrittenMotion(self.replay.lift)

    @property
    def order(self) -> int:
        """See `State`: from piece to piece the acceleration jumps. The cubics within a spline pass
        it on, but not across its ends, even if the contour is one spline that closes on itself.
        """
        return 0 if self.shocks else 1

    def on_corner(self, phi: FloatArray, side: Side) -> BoolArray:
        """See `State`; another contour than the one of the motion is taken to be whole."""
        if not self.touches:
            return np.zeros(len(phi), dtype=np.bool_)
        return self.motion.on_corner(phi, side)


State = Demanded | OutlineState | Written
"""The motion of follower and output, and how the cam turns.

Cam angles are in rad, motions in mm or rad over the cam angle. Each state has

model : whose motion it is.
sense : the side on which the follower makes this motion, `FIRST` or `SECOND`; 0 if it is that of no
    flank, as the demanded one, which is the same on both sides.
motion : of the follower.
output : of the member with the demanded motion; that of the follower without a linkage.
course : how the cam turns in time; None if no speed is given.
smooth_angles : (k,) cam angles [rad] from 0 to 2 pi, both included, ascending. Between two
    neighbours all derivatives of `motion` and `course` are smooth, and the follower's velocity
    keeps its sign.
order : of the highest derivative of `output` over time that is continuous over the turn, -1 to 3.
shocks : cam angles [rad] in [0, 2 pi), ascending, at which the velocity jumps.
curve : the path of the roller centre in the cam with this motion, or of the contact of a flat face;
    its normals are those of the contact. GeometryError with key "follower" without one.
on_corner : (n,) whether the follower touches a sharp corner of the disc at n cam angles.
output_extremes : extremes in time of `output` with the cam turning as a course says.
turning : the same motion over the cam angle with the cam turning as a course says.
"""


# -- contours -------------------------------------------------------------------------------------
# The contours of a cam as they are written, and the follower pressed against each.
#
# A follower on a single flank has the motion of that one. One that is held both ways, in a groove,
# between two discs or by a yoke on both sides of one, runs on the side that carries, and passes to
# the other where the force on it changes sign. From one written contour to the other its lift would
# jump by the play between them, which no finite force brings about, and which is an impact across
# the clearance if there is any. So the state is the motion on one side all round, the one that the
# scene says; how far the other one is from it, `Contours.play`, and where that one carries is
# reported with every figure.


class HasPart(Protocol):
    """A disc that computes its part on demand."""

    @property
    def cam(self) -> Cam: ...

    @property
    def part(self) -> Part: ...


@dataclass(frozen=True, slots=True)
class Writing:
    """How a contour is written.

    Attributes
    ----------
    form : of its pieces.
    tolerance : within which it keeps to the exact curve [mm].
    effort : of the fit.
    """

    form: Form
    tolerance: float
    effort: Effort = "fewest"


@dataclass(frozen=True, slots=True)
class Pressed:
    """The follower pressed against one written contour.

    Attributes
    ----------
    cam : whose flank it is.
    contour : that is written.
    replay : of the contour.
    deviation : proved, of the contour from the exact curve [mm].
    """

    cam: Cam
    contour: Contour | SplineContour
    replay: Replay
    deviation: float


@dataclass(frozen=True)
class Contours:
    """The contours on which a follower runs, as they are written.

    Attributes
    ----------
    discs : the main one, and the return disc of a conjugate pair, or the main one once more as the
        second side of its yoke touches it.
    writing : how they are written.
    sense : side on which a follower runs that is held both ways, as `State.sense`.
    """

    discs: tuple[HasPart, ...]
    writing: Writing
    sense: int = FIRST

    @property
    def is_held_both_ways(self) -> bool:
        """Whether there are two of them, or one that is touched twice."""
        return len(self.discs) > 1 or self.discs[0].cam.contact.closed_by_form

    def written_state(self, cam: Cam) -> Written:
        """The motion on them, as `cam` sees it, which is that of one of the discs.

        Raises
        ------
        GeometryError
            With the key, if the follower drops off an edge of the contour; from the replay, if it
            cannot be followed.
        ToleranceError
            If the tolerance cannot be reached.
        UndercutError
            If there is no disc.
        """
        pressed = self._carrying
        if len(pressed.replay.drops):
            raise GeometryError(
                "the follower drops off an edge of the contour: its velocity is unbounded there",
                key=KEY,
                value=MODEL,
            )
        sense = self.sense if self.is_held_both_ways else cam.contact.push
        return Written(
            cam, pressed.replay, cam.drive.time_course, pressed.contour, pressed.deviation, sense,
            touches=cam is pressed.cam,
        )  # fmt: skip

    @cached_property
    def play(self) -> Extremes:
        """How far [mm or rad of the lift] the other side lets the follower move off, over the turn;
        negative where both squeeze it. Of two sides only; raises as `written_state`.
        """
        sides = {self.sense: self._carrying, -self.sense: self._opposite}
        extremes = extreme_play(sides[FIRST].replay, sides[SECOND].replay)
        main = self.discs[0].cam
        if main.breadth is None:
            return extremes
        # The second side is that of a yoke as wide as the exact cam.
        wider = main.yoke_breadth - main.breadth.best
        ends = (
            Extreme(extreme.value + wider, extreme.place)
            for extreme in (extremes.lowest, extremes.highest)
        )
        return Extremes(*ends)

    @cached_property
    def _carrying(self) -> Pressed:
        """The follower on the contour whose motion it is."""
        main = self.discs[0].cam
        return self._pressed(self.sense if self.is_held_both_ways else main.contact.push)

    @cached_property
    def _opposite(self) -> Pressed:
        return self._pressed(-self.sense)

    def _pressed(self, sense: int) -> Pressed:
        disc, name, flank = self.discs[0], "outline", Flank.INNER
        if len(self.discs) > 1:
            disc = self.discs[0 if sense == FIRST else 1]
        else:
            flank = Flank.INNER if sense == FIRST else Flank.OUTER
        if disc.cam.contact.closed_by_form:
            name = f"{flank} flank"
        (boundary,) = (candidate for candidate in disc.part.boundaries if candidate.name == name)
        writing = self.writing
        fit = written_contour(boundary, writing.form, writing.effort, writing.tolerance)
        replay = _replayed(disc.cam.disc.pitch_curve, fit.contour, flank)
        return Pressed(disc.cam, fit.contour, replay, fit.deviation)


def _replayed(pitch: PitchCurve, contour: Contour | SplineContour, flank: Flank) -> Replay:
    if isinstance(contour, SplineContour):
        if not pitch.follower.has_pitch_curve:
            raise GeometryError(
                "the motion of a flat face on a contour of splines is not computed",
                key=KEY,
                value=MODEL,
            )
        return replay_spline(pitch, contour, flank)
    return replay_contour(pitch, contour, flank)


# -- face curve -----------------------------------------------------------------------------------
# The path of the contact of a flat face on a contour with vertices, on which it stands still.


POINT: Final = 1e-9
"""Radius, over the base radius, of the arc for which a vertex counts: far above the rounding of the
contact's pace, and far below any radius that is made."""


@dataclass(frozen=True, slots=True)
class FaceCurve(PitchCurve):
    """The path of the contact of a flat face that is pressed against a contour.

    On a vertex the contact stands still, and the path has no tangent of its own there, but the
    contact has one: the face. So the pace p (`camgeo.kinematics.mechanism.flat`) is not below that
    on an arc of the radius `POINT` r_b.
    """

    def relative_jet(
        self, phi: FloatArray, side: Side = "right", order: int = FULL_ORDER
    ) -> RelativeJet:
        """See `PitchCurve`; u, v and R_1 have the direction of the face everywhere."""
        follower = flat_follower(self.follower)
        jet = self._moving(follower, self.motion.jet(phi, side))
        return follower.relative_jet(jet, self.rotation, order)

    def _moving(self, follower: FlatFollower, jet: Jet) -> Jet:
        """The jet (4, n) with the second derivative that gives at least the least pace, to which
        it is in proportion.
        """
        touch = follower.touch(jet, self.rotation)
        lacking = POINT * follower.base_radius * touch.turn[0] - touch.pace[0]
        short = lacking > 0.0
        if not np.any(short):
            return jet
        more = jet[:, short]
        more[2] += 1.0
        gain = follower.touch(more, self.rotation).pace[0] - touch.pace[0][short]
        moved = jet.copy()
        moved[2, short] += lacking[short] / gain
        return moved
