"""The interface of linkages: each transforms a motion into another one, as long as it closes.

At one end of a linkage a member makes the motion that the scene demands: a slider, a lever or a
crank. At the other end is the follower, on a pivot or on a guide, whose motion the linkage computes
backwards. Positions of the demanded motion are in mm for a slider and in rad for what turns.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from decimal import ROUND_CEILING, ROUND_FLOOR, Context
from itertools import pairwise
from typing import TYPE_CHECKING, Final, Literal, Protocol

import numpy as np

from camgeo.errors import GeometryError
from camgeo.kinematics.mechanism.sketch import MechanismSketch, Places
from camgeo.kinematics.mechanism.values import Member, able
from camgeo.kinematics.motion import (
    FULL_ORDER,
    Jet,
    MergedDwell,
    Motion,
    lift_range,
    pieces,
    turning_angles,
)
from camgeo.numeric.arrays import (
    BoolArray,
    ComplexArray,
    FloatArray,
    IntArray,
    Side,
    merged,
    read_only,
)
from camgeo.numeric.extremes import bracketed_roots
from camgeo.numeric.kept import Answers, Kept, kept_with_owner
from camgeo.record import Pickled
from camgeo.units import TURN, LiftUnit, counted

if TYPE_CHECKING:
    from camgeo.kinematics.plan import MotionPlan

Size = Literal["crank", "coupler"]

ROUNDING = 8.0 * 2.0**-52
"""A difference of lengths up to this fraction of crank and coupler is zero up to rounding."""


def periodic_angles(angles: Iterable[float], low: float, high: float) -> tuple[float, ...]:
    """The angles in [low, high] [rad] equal to one of `angles` up to whole turns, ascending."""
    periodic = {
        angle + TURN * turns
        for angle in angles
        for turns in range(math.ceil((low - angle) / TURN), math.floor((high - angle) / TURN) + 1)
    }
    return tuple(sorted(periodic))


TO_FAR_END, TO_FOLLOWER = 0, 1
"""Directions of the force through a linkage: from the follower to the far end, and back from there.
They number the rows of `Linkage.transmission_sines`."""


class Linkage(Protocol):
    """A linkage with a crank and a coupler; lengths in mm."""

    @property
    def crank(self) -> float:
        """Length of the crank."""

    @property
    def coupler(self) -> float:
        """Length of the coupler."""

    @property
    def member(self) -> Member:
        """The member at the far end, whose motion is demanded."""

    @property
    def unit(self) -> LiftUnit:
        """Unit of the demanded positions."""

    @property
    def coupler_tilt(self) -> float:
        """Angle between the coupler at position 0 and the direction that the definition of the
        dimensions gives it [rad], in [0, pi/2].
        """

    def transform(self, jet: Jet, order: int = FULL_ORDER) -> Jet:
        """(order + 1, n) the follower's motion for demanded positions and derivatives `jet` (4, n).

        Measured from the demanded position 0; a rocker's angle is positive counter-clockwise.
        order is at least 1. GeometryError with key "linkage" at a dead centre not passed at rest.
        """

    def transform_bounds(self, jet: Jet, bounds: Jet) -> Jet:
        """(4, n) bounds of the follower's motion over cells, as those of `Motion.jet_and_bounds`.

        `jet` and `bounds` (4, n) are those of the demanded motion: its values in the middle of each
        cell, and its bounds over the cell. Infinite where a cell may touch a dead centre.
        """

    def missing_length(self, position: FloatArray) -> FloatArray:
        """(n,) [mm] the length that is missing to close the linkage; <= 0 where it closes, 0 at a
        dead centre.
        """

    def turning_positions(self, low: float, high: float) -> tuple[float, ...]:
        """The positions in [low, high] at which the missing length may have an extreme."""

    def dead_positions(self, low: float, high: float) -> tuple[float, ...]:
        """The positions in [low, high] at which the missing length is 0."""

    def size_limits(self, size: Size, low: float, high: float) -> tuple[float, ...]:
        """Lengths [mm] of that member at which the linkage just closes at one position of the
        range.

        With all other lengths unchanged. Between two neighbouring values the linkage closes at all
        positions in [low, high] for every length, or for none. Empty if they are not known.
        """

    def resized(self, size: Size, length: float) -> Linkage:
        """The linkage with another `length` [mm] of that member, everything else unchanged.

        GeometryError with key "linkage" if it does not close at position 0.
        """

    def joints(self, position: FloatArray) -> tuple[ComplexArray, ComplexArray]:
        """The coupler's far pin P and the crank's tip T (n,) [mm], seen from the crank's shaft with
        axes as in the drawing of the cam.
        """

    def sketch(
        self, place: complex, outward: complex, position: FloatArray
    ) -> MechanismSketch[Places]:
        """The linkage with its far end at `position` (n,) [mm or rad], in the frame of the cam.

        `place` and `outward` are the results of `Follower.linkage_joint`.
        """

    def joint_rates(
        self, position: FloatArray, demanded: FloatArray, own: FloatArray
    ) -> tuple[ComplexArray, ComplexArray]:
        """(2, n) first and second derivatives of P and of T.

        With respect to the same variable as those of the demanded coordinate and of the
        follower's `own`, both (2, n).
        """

    def transmission_sines(self, position: FloatArray) -> FloatArray:
        """(2, n) sines of the transmission angles, a row for each direction of the force.

        Row `TO_FAR_END` is between coupler and far member, row `TO_FOLLOWER` between coupler and
        the follower's member: a crank or lever itself, or the perpendicular to the guide of a
        slider. Each changes its sign where its member cannot be driven, `TO_FAR_END` in the
        `locked_positions`, `TO_FOLLOWER` in the `dead_positions`.
        """

    def far_turning_positions(self, low: float, high: float) -> tuple[float, ...]:
        """The positions in [low, high] at which the magnitude of the sine `TO_FAR_END` of
        `transmission_sines` may have a minimum, besides those at which it is 0, the
        `locked_positions`; what the `turning_positions` are to `TO_FOLLOWER`.
        """

    def per_follower(self, position: FloatArray) -> FloatArray:
        """(n,) dx/dq: change of the demanded motion x per unit of the follower's coordinate q.

        The reciprocal of `transform`, from the velocities of the closed loop: so it is not 0/0
        at rest, and 0 at a dead centre. GeometryError with key "linkage" where the follower cannot
        move the far end, see `locked_positions`.
        """

    def locked_positions(self, low: float, high: float) -> tuple[float, ...]:
        """The positions in [low, high] at which the follower cannot move the far end."""


# -- far end --------------------------------------------------------------------------------------
# The far end of a linkage for any position of the follower, whether or not it touches the cam.


STEPS: Final = 40
"""Most Newton steps; they start where the demanded motion has the far end, which is close."""

SETTLED: Final = 2.0**-48
"""A step below this fraction of the position, plus its change per unit of q, is the last one."""


@dataclass(frozen=True, slots=True, eq=False)
class FarEnd:
    """The position of a linkage's far end as a function of the follower's coordinate q.

    At a cam angle `phi` the demanded position is the first approximation, which also selects the
    solution if there are several.

    Attributes
    ----------
    demanded : the motion of the far end.
    linkage : from it to the follower.
    """

    demanded: Motion
    linkage: Linkage
    _jets: Answers[Jet] = field(default_factory=Answers, init=False, repr=False)

    def place(self, phi: FloatArray, q: FloatArray) -> FloatArray:
        """(n,) demanded position s [mm or rad] with the follower at `q` (n,), see `jet`."""
        return np.asarray(self.jet(phi, q)[0])

    def jet(self, phi: FloatArray, q: FloatArray) -> Jet:
        """(4, n) s, ds/dq, d^2s/dq^2 [mm or rad per that of q^k] and 0, read-only.

        By Newton's method; the derivatives follow from those of the linkage with q' = 1, q'' = 0.

        Raises
        ------
        GeometryError
            With key "linkage", if it does not close there, or at a dead centre.
        """

        def compute_jet() -> Jet:
            place = self._solve_place(phi, q)
            way = self.linkage.per_follower(place)
            still = np.zeros_like(place)
            # With s' = ds/dq and s'' = 0 the follower's q'' is q_ss s'^2; as q'' must be 0, s'' =
            # -q_ss s'^2 / q_s.
            bend = self.linkage.transform(np.stack((place, way, still, still)), 2)[2]
            return read_only(np.stack((place, way, -bend * way, still)))

        return self._jets.recall(compute_jet, None, phi, q)

    def _solve_place(self, phi: FloatArray, q: FloatArray) -> FloatArray:
        linkage = self.linkage
        place = np.array(self.demanded.jet(phi, "right", 1)[0])
        still = np.zeros_like(place)
        for _ in range(STEPS):
            now = linkage.transform(np.stack((place, still, still, still)), 1)[0]
            way = linkage.per_follower(place)
            step = (q - now) * way
            place = place + step
            if np.all(np.abs(step) <= SETTLED * (np.abs(place) + np.abs(way))):
                return np.asarray(place)
        raise GeometryError(
            "the linkage does not close for this position of the follower", key="linkage"
        )


# -- positions ------------------------------------------------------------------------------------
# Positions of a demanded motion: the cam angles at which it has them, and their texts in messages.


POSITIONS: Final[dict[Member, str]] = {
    "slider": "stroke",
    "lever": "lever angle",
    "crank": "crank angle",
}
"""Name of the demanded position, by the member that has it."""


@dataclass(frozen=True, slots=True, eq=False)
class MonotoneRuns:
    """A motion cut into runs, on each of which it has one formula and one direction.

    Attributes
    ----------
    motion : the demanded motion.
    ends : (k,) cam angles [rad], ascending from 0 to a turn, where the runs begin and end.
    at_ends : (k,) positions there [mm or rad].
    """

    motion: Motion
    ends: FloatArray
    at_ends: FloatArray

    @property
    def range(self) -> tuple[float, float]:
        """Smallest and largest position [mm or rad]."""
        return float(np.min(self.at_ends)), float(np.max(self.at_ends))

    def cuts(self, marks: tuple[float, ...]) -> FloatArray:
        """(n,) the ends of the runs and the cam angles at which the motion is at one of `marks`,
        ascending.
        """
        angles = [self.ends]
        for mark in marks:
            passes = np.flatnonzero(self._passes(mark))
            angles.append(self._passing_angles(mark, passes))
        return merged(np.concatenate(angles))

    def first_angle(self, position: float) -> float:
        """The first cam angle [rad] at which the motion is at `position`; the end of the run that
        is nearest to it if the motion never is.
        """
        nearest = int(np.argmin(np.abs(self.at_ends - position)))
        passes = np.flatnonzero(self._passes(position))[:1]
        there = self.ends[self.at_ends == position][:1]
        angles = np.concatenate((there, self._passing_angles(position, passes)))
        return float(np.min(angles)) if len(angles) else float(self.ends[nearest])

    def _passes(self, mark: float) -> BoolArray:
        beyond = np.sign(self.at_ends - mark)
        # On a run the motion is monotone, so it passes the mark once, or not at all.
        return np.asarray(beyond[:-1] * beyond[1:] < 0.0)

    def _passing_angles(self, mark: float, places: IntArray) -> FloatArray:
        def beyond(phi: FloatArray) -> FloatArray:
            return np.asarray(self.motion.jet(phi)[0] - mark)

        return bracketed_roots(beyond, self.ends[places], self.ends[places + 1])


def monotone_runs(motion: Motion) -> MonotoneRuns:
    """`motion`, cut where its formula changes and where it turns back."""
    ends = merged(np.array([0.0, *(end for _, end in pieces(motion)), *turning_angles(motion)]))
    return MonotoneRuns(motion, ends, np.asarray(motion.jet(ends)[0]))


def first_locked_place(linkage: Linkage, demanded: Motion) -> tuple[float, float] | None:
    """First cam angle [rad] and position [mm or rad] at which the follower cannot move the far end.

    There dx/dq of `Linkage.per_follower` is infinite: a mass or a load at the far end needs an
    infinite force of the follower. None if the motion `demanded` of the far end stays clear of all
    such positions.
    """
    runs = monotone_runs(demanded)
    positions = linkage.locked_positions(*runs.range)
    return min(((runs.first_angle(position), position) for position in positions), default=None)


def position_text(linkage: Linkage, position: float) -> str:
    """A position of the demanded motion [mm or rad], in words."""
    if linkage.unit == "mm":
        return f"stroke {position:.6g} mm"
    return f"{POSITIONS[linkage.member]} {math.degrees(position):.6g} deg"


# -- linked motion --------------------------------------------------------------------------------
# A linkage ahead of the follower: a motion derived from another by the chain rule.


@dataclass(frozen=True, slots=True)
class LinkedMotion(Pickled):
    """The follower's motion, given the motion demanded of the far end of its linkage.

    Attributes
    ----------
    demanded : the motion of the linkage's far end [mm or rad, see `Linkage.unit`].
    linkage : transforms it into the follower's own motion: a rocker's angle [rad],
        counter-clockwise positive, or a stroke [mm].
    kept : the last result of each function of the motion, see `kept_with_owner`.

    Raises
    ------
    GeometryError With key "motion" or "linkage", if the value is not a motion or a linkage; with
    "linkage" also if the linkage fails to close somewhere in the turn. The message then states the
    ranges of cam angles, the missing length, and what would close it.
    """

    demanded: Motion
    linkage: Linkage
    _jets: Answers[Jet] = field(default_factory=Answers, init=False, repr=False, compare=False)
    _bounds: Answers[tuple[Jet, Jet]] = field(
        default_factory=Answers, init=False, repr=False, compare=False
    )
    kept: Kept = field(default_factory=dict, init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        able("motion", self.demanded, "jet_and_bounds", "a motion over the cam angle")
        able("linkage", self.linkage, "transform_bounds", "a linkage")
        _, gap = self.tightest()
        if gap <= ROUNDING * (self.linkage.crank + self.linkage.coupler):
            return

        raise GeometryError(why_open(self.linkage, self.demanded), key="linkage")

    def tightest(self, within: tuple[float, float] | None = None) -> tuple[float, float]:
        """The position [mm or rad] that is nearest to a dead centre, or farthest beyond one, and
        the missing length there [mm], negative if the linkage closes with a margin.

        `within` is the range of the demanded motion; None if it is to be computed.
        """
        low, high = lift_range(self.demanded) if within is None else within
        positions = np.array([low, high, *self.linkage.turning_positions(low, high)])
        missing = self.linkage.missing_length(positions)
        worst = int(np.argmax(missing))
        return float(positions[worst]), float(missing[worst])

    @property
    def runs(self) -> MonotoneRuns:
        """The monotone runs of the demanded motion."""
        return monotone_runs(self.demanded)

    @property
    def breaks(self) -> FloatArray:
        """See `Motion`."""
        return self.demanded.breaks

    @property
    def borders(self) -> FloatArray:
        """See `Motion`."""
        return self.demanded.borders

    @property
    def dwells(self) -> tuple[MergedDwell, ...]:
        """See `Motion`."""
        return self.demanded.dwells

    def jet(self, phi: FloatArray, side: Side = "right", order: int = FULL_ORDER) -> Jet:
        """(order + 1, n) follower's motion and derivatives, see `Motion.jet`.

        Read-only, and the same array for recent requests, like those of a plan.
        """
        phi = np.array(phi, dtype=np.float64, ndmin=1)  # a copy of our own

        def compute_jet() -> Jet:
            return read_only(self.linkage.transform(self.demanded.jet(phi, side, order), order))

        return self._jets.recall(compute_jet, (side, order), phi)

    def jet_and_bounds(self, low: FloatArray, high: FloatArray) -> tuple[Jet, Jet]:
        """See `Motion.jet_and_bounds`; recalled as `jet` is."""

        def compute_bounds() -> tuple[Jet, Jet]:
            middle, bounds = self.demanded.jet_and_bounds(low, high)
            jet = self.linkage.transform(middle, FULL_ORDER)
            return read_only(jet), read_only(self.linkage.transform_bounds(middle, bounds))

        return self._bounds.recall(compute_bounds, None, low, high)


@kept_with_owner
def linked(plan: MotionPlan, linkage: Linkage) -> LinkedMotion:
    """The follower's motion for a `plan` of the far end of `linkage`; GeometryError if the linkage
    does not close.
    """
    return LinkedMotion(plan, linkage)


# -- closing --------------------------------------------------------------------------------------
# Exactly where a linkage does not close, and what would close it.


SIZES: Final[tuple[Size, ...]] = ("coupler", "crank")

DIGITS: Final = 6
"""Significant digits of the numbers in a remedy, rounded to the side on which the linkage
closes."""

FARTHEST: Final = 1e6
"""A length above this multiple of crank and coupler counts as infinite, one below the reciprocal of
this multiple as 0."""

MOST_LISTED: Final = 4
"""Most ranges of cam angles that a message lists."""

AT_START: Final = 1e-7
"""A dead centre this close to position 0, as a fraction of half a turn or of crank and coupler,
counts as at 0: where it is also a turning position, only half of its digits are known."""


@dataclass(frozen=True, slots=True)
class Opening:
    """A range of cam angles in which the linkage does not close.

    Attributes
    ----------
    start, end : its first and last cam angle [rad].
    missing : the largest missing length in it [mm].
    place : the cam angle at which it is that large [rad].
    """

    start: float
    end: float
    missing: float
    place: float


def openings(linkage: Linkage, motion: Motion) -> tuple[Opening, ...]:
    """The ranges of cam angles in which `linkage` does not close, by ascending cam angle.

    Empty if it closes everywhere. The turn is cut where the motion reverses, where the missing
    length is 0 and where it may have an extreme: between two cuts it keeps its sign.
    """
    runs = monotone_runs(motion)
    low, high = runs.range
    marks = (*linkage.dead_positions(low, high), *linkage.turning_positions(low, high))
    cuts = runs.cuts(marks)
    places = np.empty(2 * len(cuts) - 1)
    # Even places are the cuts, odd ones the middles between them.
    places[::2], places[1::2] = cuts, 0.5 * (cuts[:-1] + cuts[1:])
    missing = linkage.missing_length(motion.jet(places)[0])
    is_open = missing > ROUNDING * (linkage.crank + linkage.coupler)
    # Closed on both sides, so that every open range has a first place and a place after its last
    # one.
    edges = np.flatnonzero(np.diff(np.concatenate(([False], is_open, [False]))))
    ranges = []
    for first, stop in edges.reshape(-1, 2):
        worst = int(first + np.argmax(missing[first:stop]))
        # A range that is open at a middle reaches to the cuts on either side of it.
        start, end = places[first - first % 2], places[stop - 1 + (stop - 1) % 2]
        ranges.append(
            Opening(float(start), float(end), float(missing[worst]), float(places[worst]))
        )
    if not ranges:  # narrower than the rounding of the cam angle
        worst = int(np.argmax(missing))
        if missing[worst] > 0.0:
            place = float(places[worst])
            ranges.append(Opening(place, place, float(missing[worst]), place))
    return tuple(ranges)


def clear_range(linkage: Linkage, way: int = TO_FOLLOWER) -> tuple[float, float]:
    """The range of positions [mm or rad] around 0 without a dead centre; infinite if there is none.

    If position 0 is a dead centre itself, the range lies on the side on which the linkage closes.
    With `way` `TO_FAR_END` it also excludes positions in which the far end cannot be driven.
    """
    scale = linkage.crank + linkage.coupler
    far, extent = (math.inf, scale) if linkage.unit == "mm" else (TURN, math.pi)
    marks = linkage.dead_positions(-far, far)
    if way == TO_FAR_END:
        marks += linkage.locked_positions(-far, far)
    near = AT_START * extent
    low = max((mark for mark in marks if mark < -near), default=-math.inf)
    high = min((mark for mark in marks if mark > near), default=math.inf)
    if any(abs(mark) <= near for mark in marks):
        # Halfway to the next dead centre on either side the linkage closes, or does not, as in the
        # whole range.
        halfway = np.array([max(low, -extent), min(high, extent)]) / 2.0
        closes = linkage.missing_length(halfway) <= 0.0
        low, high = (low if closes[0] else 0.0), (high if closes[1] else 0.0)
    return low, high


def closing_sizes(
    linkage: Linkage, size: Size, low: float, high: float
) -> tuple[float, float] | None:
    """Smallest and largest length [mm] of a member with which the linkage closes at all positions
    from `low` to `high`, everything else unchanged.

    Of several ranges of lengths the one nearest to the present length. 0 and infinity where nothing
    bounds it; None if there is no such length, or none is known.
    """
    all_limits = linkage.size_limits(size, low, high)
    if not all_limits:
        return None
    scale = linkage.crank + linkage.coupler
    least, most = scale / FARTHEST, scale * FARTHEST
    limits = sorted(limit for limit in all_limits if least < limit < most)
    ranges: list[tuple[float, float]] = []
    for start, end in pairwise((0.0, *limits, math.inf)):
        # Between two limits the linkage closes for all lengths or for none, so one length decides.
        middle = 0.5 * (start + end) if math.isfinite(end) else 2.0 * max(start, scale)
        if start == end or not _closes(linkage, size, middle, low, high):
            continue
        # Neighbouring ranges that both close are one.
        if ranges and ranges[-1][1] == start:
            start = ranges.pop()[0]
        ranges.append((start, end))
    present = linkage.coupler if size == "coupler" else linkage.crank
    return min(
        ranges, key=lambda limits: max(limits[0] - present, present - limits[1]), default=None
    )


def why_open(linkage: Linkage, motion: Motion) -> str:
    """The message for a `linkage` that does not close throughout `motion`: where it is open, and
    what would close it.
    """
    ranges = openings(linkage, motion)
    gaps = [
        f"{math.degrees(opening.start):.10g} and {math.degrees(opening.end):.10g}"
        for opening in ranges[:MOST_LISTED]
    ]
    left = len(ranges) - MOST_LISTED
    more = f" and in {counted(left, 'more range')}" if left > 0 else ""
    missing = max(opening.missing for opening in ranges)
    low, high = lift_range(motion)
    remedies = [*_size_texts(linkage, low, high), *clear_range_texts(linkage)]
    remedy = f"; it closes {_listed(remedies)}" if remedies else ""
    return (
        f"the linkage does not close between cam angles {' and between '.join(gaps)} degrees{more}:"
        f" it misses by up to {missing:.6g} mm{remedy}"
    )


def clear_range_texts(linkage: Linkage, way: int = TO_FOLLOWER) -> list[str]:
    """The `clear_range` of positions of `linkage` as a text of one item.

    Empty if no dead centre bounds it, or if it is too narrow to be printed.
    """
    low, high = clear_range(linkage, way)
    scale, unit = (1.0, "mm") if linkage.unit == "mm" else (math.degrees(1.0), "degrees")
    least, most = printed(scale * low, ROUND_CEILING), printed(scale * high, ROUND_FLOOR)
    what = f"with the {POSITIONS[linkage.member]} kept"
    if (math.isinf(low) and math.isinf(high)) or least == most:
        return []
    if math.isinf(low):
        return [f"{what} below {most} {unit}"]
    if math.isinf(high):
        return [f"{what} above {least} {unit}"]
    return [f"{what} between {least} and {most} {unit}"]


def printed(value: float, rounding: str) -> str:
    """`value` to a few digits, rounded up (`ROUND_CEILING`) or down (`ROUND_FLOOR`)."""
    return f"{Context(prec=DIGITS, rounding=rounding).create_decimal(value).normalize():f}"


def _size_texts(linkage: Linkage, low: float, high: float) -> Iterator[str]:
    for size in SIZES:
        limits = closing_sizes(linkage, size, low, high)
        if limits is None:
            continue
        least, most = printed(limits[0], ROUND_CEILING), printed(limits[1], ROUND_FLOOR)
        if math.isinf(limits[1]):
            yield f"with a {size} of at least {least} mm"
        elif limits[0] == 0.0:
            yield f"with a {size} of at most {most} mm"
        elif float(least) <= float(most):
            yield f"with a {size} of {least} to {most} mm"


def _closes(linkage: Linkage, size: Size, length: float, low: float, high: float) -> bool:
    try:
        other = linkage.resized(size, length)
    except GeometryError:
        return False
    positions = np.array([low, high, *other.turning_positions(low, high)])
    return bool(np.all(other.missing_length(positions) <= 0.0))


def _listed(words: list[str]) -> str:
    return ", ".join(words[:-1]) + (", or " if len(words) > 1 else "") + words[-1]
