"""Replay: the follower pressed against a real outline, or any contour, over a turn.

The actual motion of the follower, compared with the demanded one: lift, velocity and acceleration
over the cam angle, lost stroke, shocks. The lift is that of the follower itself; behind a linkage
that is the rocker's angle.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Final, Literal, Self

import numpy as np

from camgeo.errors import GeometryError
from camgeo.geometry.outline.face import FaceLift
from camgeo.geometry.outline.path import Flank, Path, Stretch
from camgeo.geometry.outline.roller import AS_DEMANDED, CORNER, ActualLift, DiscLift, PlayedLift
from camgeo.geometry.pieces import extremes
from camgeo.geometry.pitch_curve import PitchCurve, WorkingCurve
from camgeo.kinematics.mechanism.follower_path import path_of
from camgeo.kinematics.motion import Motion
from camgeo.kinematics.plan import SNAP
from camgeo.numeric.arrays import (
    SIDES,
    BoolArray,
    FloatArray,
    IntArray,
    Quantity,
    Side,
    ascending,
    frozen,
)
from camgeo.numeric.checked import CheckedFields, Floats, Integers, Truths
from camgeo.numeric.extremes import (
    Extreme,
    Extremes,
    bracketed_roots,
    piecewise_extremes,
    piecewise_highest,
)
from camgeo.units import TURN

if TYPE_CHECKING:
    from camgeo.geometry.contour.contour import Contour
    from camgeo.geometry.contour.spline import SplineContour

# -- acceleration joints ---------------------------------------------------------------------------
# Joints at which the exact acceleration jumps, as they lie on a disc that was made.
#
# Such a joint lies on the disc within the disc's position error of its place. So close to it, an
# acceleration, or what follows from it, between the values of its two sides is not off.


SHIFT: Final = 4.0
"""This multiple of the error of the lift at places around a joint certainly covers how far off the
joint is: between two borders the error is that of one piece from one formula, of which four places
see more than a quarter."""

PLACES: Final = (np.arange(4) + 0.5) / 4.0
"""Places in each smooth piece at which the error is taken, as shares of the piece."""

AROUND: Final = 0.02
"""Range [rad] on both sides of a joint from which the error of the lift around it is taken."""

SEAM: Final = 1e-9
"""Smallest reach [rad] about a joint: the rounding of cam angles."""


@dataclass(frozen=True, slots=True, eq=False)
class AccelerationJoints:
    """The joints of an exact motion.

    Attributes
    ----------
    places, reaches : (k,) cam angles [rad] in [0, 2 pi), and how near to them the disc may place
        the joints.
    """

    places: FloatArray
    reaches: FloatArray

    @classmethod
    def from_motions(
        cls,
        joint_shift: Callable[[float, FloatArray], FloatArray],
        actual: Callable[[FloatArray], FloatArray],
        exact: Motion,
        edges: FloatArray,
    ) -> Self:
        """The joints of `exact` on a disc; `joint_shift` is that of its `DiscLift`.

        `actual` gives the lift with two derivatives (3 or more, n), smooth between the `edges` (m,)
        [rad] over a turn, as `exact` is.
        """
        left, right = (exact.jet(exact.breaks, side, 2)[2] for side in SIDES)
        # At other breaks only a higher derivative jumps.
        joints = exact.breaks[left != right]
        phi = (edges[:-1, np.newaxis] + np.diff(edges)[:, np.newaxis] * PLACES).ravel()
        errors = (
            actual(phi)[:3] - exact.jet(phi, "right", 2)[:3] if len(joints) else np.empty((3, 0))
        )
        shifts = []
        for joint in joints.tolist():
            shift = joint_shift(joint, errors[:, _angle_distance(phi, joint) < AROUND])
            shifts.append(float(np.max(shift, initial=0.0)))
        return cls(frozen(joints, np.float64), frozen(SEAM + SHIFT * np.array(shifts), np.float64))

    @property
    def ends(self) -> FloatArray:
        """(3 k,) cam angles [rad] in [0, 2 pi) of the joints and of the ends of what is near."""
        shifts = self.reaches * np.array([[-1.0], [0.0], [1.0]])
        return np.asarray(np.remainder(self.places + shifts, TURN).ravel())

    def deviation(self, quantity: Quantity, exact: Quantity) -> Quantity:
        """How far a quantity is off the exact one, which jumps at the joints."""
        # The lower and the higher of the values on both sides of each joint.
        sides = np.sort([exact(self.places, side) for side in SIDES], axis=0)
        joints = list(zip(self.places.tolist(), self.reaches.tolist(), *sides, strict=True))

        def error(phi: FloatArray, side: Side) -> FloatArray:
            values = quantity(phi, side)
            errors = values - exact(phi, side)
            for joint, reach, low, high in joints:
                near = _angle_distance(phi, joint) <= reach
                errors[near] = values[near] - np.clip(values[near], low, high)
            return errors

        return error


def _angle_distance(phi: FloatArray, joint: float) -> FloatArray:
    """(n,) distance [rad] of `phi` (n,) from a joint, round the turn."""
    return np.abs(np.remainder(phi - joint + 0.5 * TURN, TURN) - 0.5 * TURN)


# -- replay ----------------------------------------------------------------------------------------


STEP = math.radians(0.1)
"""Step of the cam angle between the samples, for pictures; the ends of all pieces are sampled as
well."""

DROP = 1e-9
"""Jumps of the lift up to this fraction of the base radius (of 1 rad for a rocker) are rounding."""


def replay_contour(
    pitch: PitchCurve,
    contour: Contour,
    flank: str = Flank.INNER,
    *,
    step: float = STEP,
    corner: float = CORNER,
) -> Replay:
    """The follower of `pitch` on any closed contour of lines and arcs.

    A flat face touches the convex hull of the contour.

    Parameters
    ----------
    contour : in cam coordinates, counter-clockwise round the cam axis: the boundary of the disc for
        the inner flank, that of the hole for the outer one, into which the roller is pressed.
    flank : "inner" or "outer".
    step : of the samples [rad].
    corner : corners up to this angle [rad] are ignored, both as shocks and as ripple.

    Raises
    ------
    GeometryError
        If the contour does not run counter-clockwise, or not round the cam axis within the
        follower's reach; for a flat face on an outer flank.
    """
    press = Flank(flank).sign
    if pitch.follower.has_pitch_curve:
        lift: DiscLift = ActualLift.from_contour(pitch, contour, press)
    else:
        _require_inner(press)
        lift = FaceLift.from_contour(contour, pitch)
    return replay_lift(pitch, lift.without_corners(corner), press, step, corner)


def replay_spline(
    pitch: PitchCurve,
    contour: SplineContour,
    flank: str = Flank.INNER,
    *,
    step: float = STEP,
    corner: float = CORNER,
) -> Replay:
    """The roller of `pitch` on a closed contour of cubics, arcs and lines, counter-clockwise.

    Otherwise as `replay_contour`; raises as `ActualLift.from_splines`.
    """
    press = Flank(flank).sign
    return replay_lift(pitch, ActualLift.from_splines(pitch, contour, press), press, step, corner)


def replay_outline(
    pitch: PitchCurve,
    outline: Path,
    *,
    step: float = STEP,
    clearance: float = 0.0,
) -> Replay:
    """The follower of `pitch` on a real outline, exactly.

    On a stretch of the working curve the roller is where it should be. Where a stretch is missing,
    it runs over the outline's corners: it cannot touch another stretch there, for the roller that
    touches a stretch has its own cam angle. A flat face rocks over the corner itself.

    With a `clearance` [mm] the outline is a flank of a groove that is wider than the roller by it;
    pressed against the flank the roller is off by about half of that everywhere.

    Raises
    ------
    GeometryError
        If the outline has no stretches, or the roller finds no corner where one is missing; with
        clearance if the outline is not the whole flank, or the clearance is too large.
    """
    stretches = outline.stretches
    if not stretches:
        raise GeometryError("an outline without any stretch of the working curve holds no follower")
    distance = stretches[0].curve.distance
    press = -1 if math.copysign(1.0, distance) < 0.0 else 1  # -0 on the inside of a knife edge
    if not pitch.follower.has_pitch_curve:
        _require_inner(press)
        corners = np.array([pivot.centre for pivot in outline.pivots], dtype=np.complex128)
        starts, ends = _gaps(stretches)
        if len(corners) != len(starts):
            raise GeometryError("a stretch is missing where the outline has no corner for the face")
        face = FaceLift.from_corners(pitch, corners, starts, ends)
        return replay_lift(pitch, face, press, step)
    radius = abs(distance)
    # A pivot at no distance from the roller centre is the roller's turn about its own centre.
    pivots = [pivot for pivot in outline.offset(-distance).pivots if pivot.distance != 0.0]
    if any(abs(abs(pivot.distance) - radius) > DROP * radius for pivot in pivots):
        raise GeometryError("the outline has an arc where the roller must find a corner")
    played = None
    if clearance > 0.0:
        if not outline.is_whole:
            raise GeometryError(
                "the flank is trimmed or has a corner, and the groove has side clearance: replay a"
                " drawing of it"
            )
        path = path_of(pitch.follower, pitch.rotation)
        played = PlayedLift(path, WorkingCurve(pitch, 0.5 * press * clearance))
    centres = np.array([pivot.centre for pivot in pivots], dtype=np.complex128)
    # A knife edge has no such pivots.
    lift = ActualLift.from_corners(pitch, centres, press, radius or 1.0, _gaps(stretches), played)
    return replay_lift(pitch, lift, press, step)


def _require_inner(press: int) -> None:
    """Raise GeometryError if a flat face would be pressed outward."""
    if press > 0:
        raise GeometryError(
            "a flat face can only run on the inner flank, the outside of the disc", key="flank"
        )


def _gaps(stretches: tuple[Stretch, ...]) -> tuple[FloatArray, FloatArray]:
    """Starts and ends (k,), (k,) [rad] of the ranges between neighbouring stretches."""
    starts = np.array([stretch.end % TURN for stretch in stretches])
    ends = np.roll([stretch.start for stretch in stretches], -1)
    widths = np.remainder(ends - starts, TURN)
    # Where a stretch follows at once, across a turn of the roller, rounding may add a full turn.
    widths[np.minimum(widths, TURN - widths) <= SNAP] = 0.0
    gaps = np.flatnonzero(widths > 0.0)
    return starts[gaps], starts[gaps] + widths[gaps]


def replay_lift(
    pitch: PitchCurve,
    lift: DiscLift,
    press: int,
    step: float = STEP,
    corner: float = CORNER,
) -> Replay:
    """The replay of `lift`: its samples, and where it or its velocity jumps."""
    motion = pitch.motion
    peaks = [_peak(motion, order) for order in (1, 2)]
    count = math.ceil(TURN / step)
    grid = np.arange(count, dtype=np.float64) * (TURN / count)
    # The samples include the places of the demanded peaks.
    grid = ascending(np.concatenate((grid, [peak.place for peak in peaks])))
    special = ascending(np.concatenate((lift.borders, lift.breaks)))
    lifts = [lift.displacement(special, side) for side in SIDES]
    dropped = np.abs(lifts[1] - lifts[0]) > DROP * pitch.follower.lift_scale
    drops = Jumps(special[dropped], lifts[0][dropped], lifts[1][dropped])
    # At a drop the velocity is unbounded, so that there is no sample.
    special = special[~dropped]
    grid = grid[~np.isin(grid, np.concatenate((special, drops.phi)))]
    left, right = (_Samples.sample(lift, special, side) for side in SIDES)
    shocks = _shocks(lift, left, right, corner)
    # The left side of cam angle 0 is the end of the turn.
    left = replace(left, phi=np.where(left.phi == 0.0, TURN, left.phi))
    parts = (left, _Samples.sample(lift, grid, "right"), right)
    phi = np.concatenate([part.phi for part in parts])
    order = np.argsort(phi, kind="stable")
    numbers = np.concatenate([part.numbers for part in parts])[order]
    element, smooth = contact_elements(lift, numbers, corner)
    return Replay(
        lift=lift,
        press=press,
        corner=corner,
        phi=phi[order],
        demanded=np.concatenate([part.demanded for part in parts], axis=1)[:, order],
        actual=np.concatenate([part.actual for part in parts], axis=1)[:, order],
        element=element,
        smooth=smooth,
        shocks=shocks,
        drops=drops,
        demanded_velocity=peaks[0].value,
        demanded_acceleration=peaks[1].value,
    )


@dataclass(frozen=True, slots=True, eq=False)
class _Samples:
    """Cam angles (n,) [rad], the branches (n,) there, demanded and actual jets (3, n)."""

    phi: FloatArray
    numbers: IntArray
    demanded: FloatArray
    actual: FloatArray

    @classmethod
    def sample(cls, lift: DiscLift, phi: FloatArray, side: Side) -> _Samples:
        return cls(
            phi,
            lift.number(phi, side),
            lift.motion.jet(phi, side, 2)[:3],
            lift.jet(phi, side),
        )


def _shocks(lift: DiscLift, left: _Samples, right: _Samples, corner: float) -> Jumps:
    """The jumps of the velocity where the roller centre turns by more than `corner` [rad]."""
    arriving, leaving = (lift.heading(side.phi, side.actual) for side in (left, right))
    turned = np.abs(np.angle(leaving * arriving.conj()))
    is_shock = turned > corner
    return Jumps(right.phi[is_shock], left.actual[1][is_shock], right.actual[1][is_shock])


def _peak(motion: Motion, order: int) -> Extreme:
    """Largest magnitude of a derivative of the demanded lift, exactly."""
    peaks = extremes(
        motion,
        lambda phi, side: motion.jet(phi, side)[order],
        lambda phi, side: motion.jet(phi, side)[order + 1],
    )
    sides = (peaks.smallest(), peaks.largest())
    value, place = max(sides, key=lambda side: abs(side[0]))
    return Extreme(abs(value), place)


# -- replay result --------------------------------------------------------------------------------
# The result of a replay: the follower's motion on a disc next to the demanded one.
#
# Two replays together give the play that a conjugate pair of real discs leaves the follower.
# Pressed against the main disc alone it has the lift q_1, against the return disc alone q_2. Each
# disc stops it on its side, so that it can be anywhere between them; where they overlap the rollers
# are squeezed.


AS_DEMANDED_ELEMENT = np.iinfo(np.intp).min
"""Number of the element that is the demanded motion itself: no piece or vertex has it."""

EQUAL: Final = 1e-12
"""Magnitudes that differ by less than this share of them differ by rounding."""

POLISHED: Final = 1e-6
"""Range [rad] on both sides of a largest value in which the root of its slope is its place."""


@dataclass(frozen=True, slots=True, eq=False)
class Jumps:
    """Places at which the roller passes from one part of the disc to another with a jump.

    Attributes
    ----------
    phi : (k,) cam angles [rad] in [0, 2 pi), ascending.
    left, right : (k,) the values on both sides.
    """

    phi: FloatArray
    left: FloatArray
    right: FloatArray

    def __len__(self) -> int:
        return len(self.phi)

    def scaled(self, factor: float) -> Jumps:
        """The same jumps in another unit."""
        return Jumps(self.phi, factor * self.left, factor * self.right)

    @property
    def largest(self) -> Extreme | None:
        """The largest jump (after - before) with its cam angle; None if there is none."""
        if not len(self):
            return None
        index = int(np.argmax(np.abs(self.right - self.left)))
        return Extreme(float((self.right - self.left)[index]), float(self.phi[index]))


@dataclass(frozen=True, slots=True, eq=False)
class Replay(CheckedFields):
    """The motion of the follower on a disc, next to the demanded one.

    Samples are for pictures. They lie on a regular grid and at both sides of every place where the
    formula of the actual or of the demanded motion changes; such a place occurs twice in `phi`, its
    left side first. The largest values are searched for in the smooth pieces between these places,
    whatever the grid.

    Attributes
    ----------
    lift : the actual lift as a function of the cam angle.
    press : -1 if the roller is pressed inward, onto a disc, +1 if outward, into a ring.
    corner : corners up to this angle [rad] are ignored.
    phi : (n,) cam angles [rad] from 0 to 2 pi, ascending.
    demanded, actual : (3, n) lift with two derivatives [mm or rad per rad^k].
    element : (n,) number of the contour's piece that holds the roller, -1 - k at its vertex k, or
        of the outline's corner k; `AS_DEMANDED_ELEMENT` where the roller is where it should be.
    smooth : (n,) False at ignored corners, where the acceleration is meaningless.
    shocks : jumps of the velocity [mm or rad per rad], including those that are demanded.
    drops : jumps of the lift itself: the roller falls off an edge.
    demanded_velocity, demanded_acceleration : largest magnitudes [mm or rad per rad^k].
    """

    lift: DiscLift
    press: int
    corner: float
    phi: Floats
    demanded: Floats
    actual: Floats
    element: Integers
    smooth: Truths
    shocks: Jumps
    drops: Jumps
    demanded_velocity: float
    demanded_acceleration: float

    @property
    def lost(self) -> FloatArray:
        """(n,) lost stroke [mm or rad]: how far the roller gets beyond where it should be, into the
        disc. Negative where the disc holds it off.
        """
        difference: FloatArray = self.actual[0] - self.demanded[0]
        return self.press * self.lift.outward * difference

    @property
    def largest_loss(self) -> Extreme:
        """Largest lost stroke with its cam angle; 0 if there is none.

        Between the ends of smooth pieces it lies where both velocities are equal.
        """
        sense = self.press * self.lift.outward
        edges = self._deviating_edges()
        highest = piecewise_highest(lambda phi, side: sense * self._error(phi, side), edges)
        if highest.value <= 0.0:
            return Extreme(0.0, highest.place % TURN)
        # The ends of the smooth piece in which the place lies.
        neighbours = np.searchsorted(edges, highest.place) + np.array([-1, 0])
        low = max(highest.place - POLISHED, float(edges[max(neighbours[0], 0)]))
        high = min(highest.place + POLISHED, float(edges[neighbours[1]]))
        ends = np.array([low, high])
        # A top is flat: the root of the slope gives its place more exactly than the values do.
        slopes = self._error(ends, "right", 1) if low < highest.place < high else np.zeros(2)
        if slopes[0] * slopes[1] < 0.0:
            phi = bracketed_roots(
                lambda phi: self._error(phi, "right", 1), ends[:1], ends[1:], ends=slopes[:, None]
            )
            return Extreme(sense * float(self._error(phi, "right")[0]), float(phi[0]) % TURN)
        return Extreme(highest.value, highest.place % TURN)

    @property
    def largest_error(self) -> Extreme:
        """Difference actual - demanded lift of the largest magnitude, with its cam angle."""
        return _farthest(piecewise_extremes(self._error, self._deviating_edges()))

    @property
    def velocity(self) -> Extreme | None:
        """Actual velocity of the largest magnitude, with its cam angle; None if it is unbounded,
        where the lift jumps.
        """
        return self._peak(lambda phi, side: self.lift.jet(phi, side)[1])

    @property
    def acceleration(self) -> Extreme | None:
        """Actual acceleration of the largest magnitude, with its cam angle; None as of `velocity`.

        At ignored corners it does not count.
        """
        return self._peak(
            lambda phi, side: np.where(self._is_smooth(phi, side), self.lift.jet(phi, side)[2], 0.0)
        )

    @property
    def largest_acceleration_error(self) -> Extreme | None:
        """Actual - demanded acceleration of the largest magnitude; None as of `velocity`.

        A joint where the demanded acceleration jumps lies on the disc only within the disc's
        position error; so close to one, a value between those of its two sides is not an error. Nor
        do ignored corners count.
        """
        if len(self.drops):
            return None
        motion, edges = self.lift.motion, smooth_edges(self.lift)
        joints = AccelerationJoints.from_motions(
            self.lift.joint_shift, self.lift.jet, motion, edges
        )
        error = joints.deviation(
            lambda phi, side: self.lift.jet(phi, side)[2],
            lambda phi, side: motion.jet(phi, side, 2)[2],
        )

        def counted(phi: FloatArray, side: Side) -> FloatArray:
            return np.where(self._is_smooth(phi, side), error(phi, side), 0.0)

        return self._peak(counted, joints.ends)

    @property
    def ripple(self) -> float | None:
        """Largest error of the acceleration over its demanded peak; None if that is 0, or the error
        unbounded.
        """
        error = self.largest_acceleration_error if self.demanded_acceleration else None
        return None if error is None else abs(error.value) / self.demanded_acceleration

    @property
    def largest_shock(self) -> float | None:
        """Largest jump of the velocity over its demanded peak; None if that is 0."""
        if self.demanded_velocity == 0.0:
            return None
        jump = self.shocks.largest
        return 0.0 if jump is None else abs(jump.value) / self.demanded_velocity

    def _error(self, phi: FloatArray, side: Side, order: Literal[0, 1] = 0) -> FloatArray:
        """(n,) actual - demanded lift at `phi` (n,) [rad], or its first derivative."""
        actual = self.lift.jet(phi, side)[1] if order else self.lift.displacement(phi, side)
        return np.asarray(actual - self.lift.motion.jet(phi, side, 2 * order or 1)[order])

    def _is_smooth(self, phi: FloatArray, side: Side) -> BoolArray:
        """(n,) False at ignored corners."""
        return contact_elements(self.lift, self.lift.number(phi, side), self.corner)[1]

    def _deviating_edges(self) -> FloatArray:
        """`smooth_edges` without those inside ranges in which the lift is the demanded one."""
        edges = smooth_edges(self.lift)
        if not self.lift.as_demanded:
            return edges
        deviating = self.lift.number(0.5 * (edges[:-1] + edges[1:])) != AS_DEMANDED
        return np.asarray(edges[np.append(True, deviating) | np.append(deviating, True)])

    def _peak(self, quantity: Quantity, more: FloatArray | None = None) -> Extreme | None:
        """The value of `quantity` of the largest magnitude; None if the lift jumps.

        It is smooth between `smooth_edges` and the cam angles `more` (k,) [rad].
        """
        if len(self.drops):
            return None
        edges = smooth_edges(self.lift)
        edges = edges if more is None else ascending(np.concatenate((edges, more)))
        return _farthest(piecewise_extremes(quantity, edges))


def smooth_edges(*lifts: DiscLift) -> FloatArray:
    """(k,) cam angles [rad] from 0 to 2 pi between which the lifts and what is demanded are
    smooth.
    """
    parts = [part for lift in lifts for part in (lift.borders, lift.knots)]
    return ascending(np.clip(np.concatenate((np.array([0.0, TURN]), *parts)), 0.0, TURN))


def contact_elements(
    lift: DiscLift, numbers: IntArray, corner: float
) -> tuple[IntArray, BoolArray]:
    """(n,) the `element` and (n,) whether it is `smooth`, see `Replay`, where `numbers` (n,) hold
    the follower and corners up to `corner` [rad] are ignored.
    """
    element = np.full(len(numbers), AS_DEMANDED_ELEMENT)
    smooth = np.ones(len(numbers), dtype=np.bool_)
    held = numbers != AS_DEMANDED
    element[held], turns = lift.holding_elements(numbers[held])
    smooth[held] = turns > corner
    return element, smooth


def _farthest(pair: Extremes) -> Extreme:
    """The extreme of the larger magnitude, its place in the first turn; the highest one if both are
    equal but for rounding.
    """
    higher = pair.highest.value >= -pair.lowest.value * (1.0 - EQUAL)
    one = pair.highest if higher else pair.lowest
    return Extreme(one.value, one.place % TURN)


def play(main: Replay, other: Replay, phi: FloatArray, side: Side = "right") -> FloatArray:
    """(n,) play between the discs at the cam angles `phi` (n,) [rad], negative where they squeeze.

    In the unit of the lift [mm or rad]: outward times (q_2 - q_1), outward the sense of a lift that
    takes the main roller away from the cam axis.
    """
    outward = main.lift.outward
    return outward * (other.lift.displacement(phi, side) - main.lift.displacement(phi, side))


def extreme_play(main: Replay, other: Replay) -> Extremes:
    """Smallest and largest `play` over the turn, between two discs, or between two flanks if `main`
    is on the inner one.
    """
    edges = smooth_edges(main.lift, other.lift)
    return piecewise_extremes(lambda phi, side: play(main, other, phi, side), edges)
