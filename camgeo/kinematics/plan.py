"""Motion plan: dwells and moves in the order of the cam angle, closing after one turn.

Joints are sums of the spans exactly as written in degrees, each rounded to a double once; nothing
is accumulated in floating point (VDI 2143-1, eqs. 5 to 18).
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from decimal import Context, Decimal, localcontext
from functools import cached_property, partial
from itertools import groupby
from numbers import Real
from operator import attrgetter
from typing import TYPE_CHECKING, Annotated, Any, Final

import numpy as np

from camgeo.errors import GeometryError
from camgeo.kinematics.laws.law import Formula, Law
from camgeo.kinematics.motion import FULL_ORDER, End, Jet, end_class
from camgeo.kinematics.motion import MergedDwell as DwellSpan
from camgeo.numeric import checked
from camgeo.numeric.arrays import FloatArray, IntArray, Side, ascending, frozen, read_only
from camgeo.numeric.extremes import isolation_cells
from camgeo.numeric.kept import Answers, Kept, kept_with_owner
from camgeo.record import Pickled
from camgeo.units import TURN

if TYPE_CHECKING:
    from camgeo.kinematics.splines import FitReport, Spline


@dataclass(frozen=True, slots=True)
class Dwell(checked.CheckedFields):
    """A rest over `span` degrees, exactly as written; one of zero length is a momentary rest."""

    span: Span


@dataclass(frozen=True, slots=True)
class Move(checked.CheckedFields):
    """A move over `span` degrees, exactly as written, to the position `to` [mm or rad] by `law`.

    Attributes
    ----------
    scale : factor of the values of the law [mm or rad]; None for a normalised law, which the stroke
        scales. A move that returns to where it started has a law of its own size.
    """

    span: MovingSpan
    to: checked.Finite
    law: Law
    scale: checked.Finite | None = None


@dataclass(frozen=True, slots=True)
class SplineMove:
    """A move by data over `span` degrees: a spline in place of a law.

    Attributes
    ----------
    to : position at the end [mm or rad].
    spline : over z in [0, 1], the displacement from the position at the start [mm or rad].
    report : deviation of the spline from the rows of a lift table; None for a motion through
        points.
    shift : amount added to every row of the table [mm or rad], so that the first row lies where the
        segment starts.
    """

    span: Decimal
    to: float
    spline: Spline
    report: FitReport | None = None
    shift: float = 0.0

    def __post_init__(self) -> None:
        knots = getattr(self.spline, "knots", None)
        if knots is None or (knots[0], knots[-1]) != (0.0, 1.0):
            raise GeometryError("must be a spline over 0 to 1", "spline", checked.value_text(knots))
        span, to = checked_span("span", self.span, SHORTEST_SPAN), checked.finite("to", self.to)
        checked.hold(self, span=span, to=to)


Segment = Dwell | Move | SplineMove


@dataclass(frozen=True)
class MotionPlan(Pickled):
    """Segments that fill one turn; the lift is counted from the position at cam angle 0.

    Attributes
    ----------
    segments : in the order of the cam angle.
    kept : the last result of each function of the plan, see `kept_with_owner`.

    Raises
    ------
    GeometryError
        With key "motion", if the spans do not add up to 360 degrees exactly, a move of zero length
        has a stroke, or the last position is not the first one.
    """

    segments: tuple[Segment, ...]
    joints_deg: tuple[Decimal, ...] = field(init=False, repr=False)
    _answers: Answers[Jet] = field(default_factory=Answers, init=False, repr=False, compare=False)
    kept: Kept = field(default_factory=dict, init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        segments = checked.instances("motion", self.segments, (Dwell, Move, SplineMove), "segments")
        joints = sum_spans(segment.span for segment in segments)
        checked.hold(self, segments=segments, joints_deg=joints)
        position = 0.0
        for number, segment in enumerate(self.segments, start=1):
            if isinstance(segment, Dwell):
                continue
            if segment.span == 0 and segment.to != position:
                raise GeometryError(
                    "a move of zero length cannot change the position (infinite velocity)",
                    key=f"motion[{number}].span",
                    value=str(segment.span),
                )
            position = segment.to
        if position != 0.0:
            raise GeometryError(
                f"the motion starts at 0 and ends at {position:g}, so it does not close after one"
                " turn; the last move must return to 0",
                key="motion",
            )

    @cached_property
    def stretches(self) -> tuple[tuple[Segment, float, float], ...]:
        """Each segment that has a length, and the cam angles [rad] at which it begins and ends."""
        joints = [math.radians(float(degrees)) for degrees in self.joints_deg]
        ends = zip(self.segments, joints[:-1], joints[1:], strict=True)
        return tuple(stretch for stretch in ends if stretch[0].span > 0)

    @cached_property
    def _pieces(self) -> tuple[Piece, ...]:
        pieces: list[Piece] = []
        position = 0.0
        for segment, start, end in self.stretches:
            if isinstance(segment, SplineMove):
                pieces.append(spline_piece(segment.spline, position, start, end))
                position = segment.to
                continue
            if isinstance(segment, Dwell) or (segment.scale is None and segment.to == position):
                pieces.append(Piece(start, end, position))
                continue
            for region in segment.law.regions:
                # At 0 and 1 the joints themselves, so that neighbouring pieces meet exactly.
                piece = Piece(
                    start=start + region.start * (end - start) if region.start > 0.0 else start,
                    end=start + region.end * (end - start) if region.end < 1.0 else end,
                    origin=segment.to if region.from_end else position,
                    lift=segment.to - position if segment.scale is None else segment.scale,
                    formula=region.formula,
                    numbers=region.numbers,
                    segment_start=start,
                    segment_end=end,
                    jerk_bound=region.jerk_bound,
                    from_end=region.from_end,
                    harmonic=region.harmonic,
                )
                # A region shorter than the rounding of the cam angle is no piece.
                if piece.end > piece.start:
                    pieces.append(piece)
            position = segment.to
        return tuple(pieces)

    @cached_property
    def _columns(self) -> Pieces:
        return Pieces(self._pieces)

    @cached_property
    def borders(self) -> FloatArray:
        """(k,) cam angles [rad] at which the formula changes, ascending from 0."""
        knots = [piece.knots for piece in self._pieces if piece.spline is not None]
        return frozen(ascending(np.concatenate([self._columns.starts, *knots])), np.float64)

    @cached_property
    def breaks(self) -> FloatArray:
        """(m,) cam angles [rad] in [0, 2 pi) at which s' to s''' may jump, ascending.

        The joints, and the inner borders of the laws; not the middle of a rest.
        """
        angles: list[float] = []
        inner = {
            start + border * (end - start)
            for segment, start, end in self.stretches
            if isinstance(segment, Move)
            for border in segment.law.borders
        }
        for previous, following in zip(
            self._pieces[-1:] + self._pieces[:-1], self._pieces, strict=True
        ):
            if previous.rests and following.rests:
                continue
            inside = previous.segment_start == following.segment_start
            if previous.rests or following.rests or not inside or following.start in inner:
                angles.append(following.start)
        return frozen(angles, np.float64)

    @cached_property
    def dwells(self) -> tuple[DwellSpan, ...]:
        """All rests, neighbours merged, also across cam angle 0."""
        runs = [[*run] for rests, run in groupby(self._pieces, attrgetter("rests")) if rests]
        spans = [[run[0].start, run[-1].end] for run in runs]
        # A rest across cam angle 0 begins with the last piece and goes on with the first one.
        if len(spans) > 1 and self._pieces[0].rests and self._pieces[-1].rests:
            spans[-1][1] += spans[0][1]
            spans = spans[1:]
        return tuple(DwellSpan(start, end - start) for start, end in spans)

    @cached_property
    def harmonics(self) -> tuple[DwellSpan, ...]:
        """The pieces without a rest in which s''' = -s': the lift swings about a fixed middle with
        the period of one turn.
        """
        return tuple(
            DwellSpan(piece.start, piece.end - piece.start)
            for piece in self._pieces
            if abs(piece.harmonic - piece.length) <= ULPS * piece.length
        )

    def jet(self, phi: FloatArray, side: Side = "right", _order: int = FULL_ORDER) -> Jet:
        """(4, n) lift and derivatives at the cam angles `phi` (n,) [rad], any number of turns.

        All orders, because the higher ones cost little once the law's sines are computed.
        Read-only, and the same array for recent requests: forces, contact and torque each need the
        lift at the same cam angles, and so does another follower of the same motion.
        """
        phi = np.array(phi, dtype=np.float64, ndmin=1)  # a copy of our own

        def compute_jet() -> Jet:
            return read_only(self._columns.jet(in_turn(phi, side), side))

        return self._answers.recall(compute_jet, side, phi)

    def jet_and_bounds(self, low: FloatArray, high: FloatArray) -> tuple[Jet, Jet]:
        """The lift (4, n) in the middle of the cells [low, high] [rad], and bounds over them.

        These are bounds (4, n) of |s - s(middle)|, |s'|, |s''|, |s'''|.

        Taylor's theorem from the middle of each cell with the law's bound of |f'''|.
        """
        middle = 0.5 * (low + high)
        half = 0.5 * (high - low)
        values = self.jet(middle)
        bounds = np.abs(values)
        piece = self._columns.piece_numbers(middle, "right")
        jerk = bounds[3]
        # A view of the last row of `bounds`: from here on it holds the bound of the jerk.
        jerk[:] = self._columns.jerk_limits[piece]
        bounds[0] = half * (bounds[1] + half * (bounds[2] / 2.0 + half * jerk / 6.0))
        bounds[1] += half * (bounds[2] + half * jerk / 2.0)
        bounds[2] += half * jerk
        if self._by_data:
            for number, index in indices_by_key(piece):
                if self._pieces[number].spline is not None:
                    bounds[:, index] = self._pieces[number].spline_bounds(low[index], high[index])
        return values, bounds

    @cached_property
    def _by_data(self) -> bool:
        return any(piece.spline is not None for piece in self._pieces)


def in_turn(phi: FloatArray, side: Side = "right") -> FloatArray:
    """The cam angles `phi` (n,) [rad] reduced to [0, 2 pi), or (0, 2 pi] for the left-hand side."""
    phi = np.atleast_1d(np.asarray(phi, dtype=np.float64))
    if len(phi) and not (phi.min() >= 0.0 and phi.max() < TURN - SNAP):
        if not np.all(np.isfinite(phi)):
            raise GeometryError("cam angles must be finite numbers")
        phi = phi - TURN * np.floor(phi / TURN)
        # An angle just below a whole turn is the joint at 0, rounded.
        phi = np.where(phi >= TURN - SNAP, 0.0, phi)
    if side == "left":
        phi = np.where(phi <= SNAP, TURN, phi)
    return phi


# -- piece ----------------------------------------------------------------------------------------
# The pieces of a motion plan: stretches of the turn with one formula, and how they are evaluated.
#
# A plan may have thousands of pieces and is evaluated at a dozen cam angles or at thousands. Pieces
# with equal formulas are evaluated in one call, each angle with the numbers of its piece; where
# there are many more angles than pieces each piece has a call of its own, with nothing to look up.


BLOCK: Final = 8192
"""Angles evaluated at a time, so that intermediate results stay in the processor's cache."""

MANY: Final = 64
"""Mean number of angles per piece from which pieces are evaluated one by one."""

SNAP: Final = 4.0 * math.ulp(TURN)
"""Two cam angles [rad] closer than this are the same angle, rounded differently in the conversion
from degrees; an angle so close to a joint counts as the joint. A millionth of a degree is 5 million
times wider."""

ULPS: Final = 2.0**-52 * 8.0
"""Rounding of the rate of a harmonic, as a fraction of it."""

COLUMNS: Final = 8
"""How many numbers of a piece stand before those of its formula: start and end of the segment, the
reciprocal of its length, the origin, and the factors of the near value and of the derivatives."""


@dataclass(frozen=True, slots=True)
class Piece:
    """A stretch of the turn with one formula; a dwell has none.

    s = origin + lift * (near value), with the near value f counted from the segment's start or
    g = 1 - f counted from its end.
    """

    start: float
    end: float
    origin: float
    lift: float = 0.0
    formula: Formula | None = None
    numbers: tuple[float, ...] = ()
    segment_start: float = 0.0
    segment_end: float = 1.0
    jerk_bound: float = 0.0
    from_end: bool = False
    spline: Spline | None = None
    harmonic: float = 0.0

    @property
    def rests(self) -> bool:
        """Whether nothing moves."""
        return self.formula is None

    @property
    def length(self) -> float:
        """Cam angle of the whole segment [rad]."""
        return self.segment_end - self.segment_start

    @property
    def knots(self) -> FloatArray:
        """Cam angles [rad] inside the piece at which the polynomial of a spline changes."""
        if self.spline is None:
            return np.empty(0)
        inner = self.spline.knots[1:-1]
        return np.asarray(self.segment_start + inner * self.length)

    def spline_bounds(self, low: FloatArray, high: FloatArray) -> Jet:
        """(4, n) the bounds of `MotionPlan.jet_and_bounds` for cells of a piece with a spline."""
        assert self.spline is not None  # called for those only
        shares = [np.clip((a - self.segment_start) / self.length, 0.0, 1.0) for a in (low, high)]
        bounds = self.spline.cell_bounds(*shares)
        return bounds / self.length ** np.arange(4.0)[:, np.newaxis]


def spline_piece(spline: Spline, position: float, start: float, end: float) -> Piece:
    """The piece of a motion by data: `spline` over z in [0, 1], added to `position`; a rest if the
    spline is constant.
    """
    if not np.any(spline.taylor[:, 1:]):
        return Piece(start, end, position + float(spline.taylor[0, 0]))

    def formula(z: FloatArray, _w: FloatArray, _: Any) -> FloatArray:
        return spline.values(np.clip(z, 0.0, 1.0))

    return Piece(
        start, end, position, 1.0, formula, (), start, end,
        jerk_bound=float(np.max(spline.bounds(3))), spline=spline,
    )  # fmt: skip


class Pieces:
    """The pieces of a turn as columns.

    Attributes
    ----------
    starts : (m,) cam angles [rad].
    jerk_limits : (m,) bounds of |s'''|.
    """

    def __init__(self, pieces: Sequence[Piece]) -> None:
        self.starts = np.array([piece.start for piece in pieces])
        start = np.array([piece.segment_start for piece in pieces])
        end = np.array([piece.segment_end for piece in pieces])
        lift, length = np.array([piece.lift for piece in pieces]), end - start
        # g = 1 - f falls as f rises, and is counted from the end position.
        near = np.where([piece.from_end for piece in pieces], -lift, lift)
        # Powers of Python's floats; those of numpy differ from them in the last bit.
        squares, cubes = (np.array([float(span) ** k for span in length]) for k in (2, 3))
        bounds = np.array([piece.jerk_bound for piece in pieces])
        self.jerk_limits = np.abs(lift) / cubes * bounds
        origin = np.array([piece.origin for piece in pieces])
        scale = (near, lift / length, lift / squares, lift / cubes)
        columns = np.stack((start, end, 1.0 / length, origin, *scale))
        self._formulas = [*dict.fromkeys(piece.formula for piece in pieces)]
        numbers = {formula: group for group, formula in enumerate(self._formulas)}
        self._group = np.array([numbers[piece.formula] for piece in pieces])
        # Pieces with the same formula form a group with a table of its own, one column for each
        # piece.
        self._row = np.empty(len(pieces), dtype=np.intp)
        self._tables = []
        for group in range(len(self._formulas)):
            members = np.flatnonzero(self._group == group)
            self._row[members] = np.arange(len(members))
            rest = np.array([pieces[place].numbers for place in members.tolist()]).T
            self._tables.append(np.concatenate((columns[:, members], rest)))

    def jet(self, phi: FloatArray, side: Side) -> Jet:
        """(4, n) lift and derivatives at `phi` (n,) in [0, 2 pi] [rad]."""
        values = np.empty((4, len(phi)))
        for first in range(0, len(phi), BLOCK):
            block = slice(first, first + BLOCK)
            here, there = phi[block], values[:, block]
            if len(here) > MANY * len(self.starts):
                for piece, places in self._parts(here, side):
                    group, row = int(self._group[piece]), int(self._row[piece])
                    self._write(group, row, here, there, places)
                continue
            pieces = self.piece_numbers(here, side)
            groups, rows = self._group[pieces], self._row[pieces]
            for group in np.flatnonzero(np.bincount(groups)).tolist():
                places = np.flatnonzero(groups == group)
                self._write(group, rows[places], here, there, places)
        return values

    def piece_numbers(self, phi: FloatArray, side: Side) -> IntArray:
        """(n,) the number of the piece in which each of `phi` (n,) lies."""
        nudge = SNAP if side == "right" else -SNAP
        return self.starts[1:].searchsorted(phi + nudge, side=side)

    def _parts(self, phi: FloatArray, side: Side) -> list[tuple[int, slice | IntArray]]:
        """Each piece in which some of `phi` (n,) lie, with their indices."""
        if not np.all(phi[1:] >= phi[:-1]):
            return [*indices_by_key(self.piece_numbers(phi, side))]
        nudge = SNAP if side == "right" else -SNAP
        inner = self.starts[1:] - nudge
        ends = np.searchsorted(phi, inner, side="left" if nudge > 0.0 else "right").tolist()
        runs = enumerate(zip([0, *ends], [*ends, len(phi)], strict=True))
        return [(piece, slice(*bounds)) for piece, bounds in runs if bounds[0] < bounds[1]]

    def _write(
        self,
        group: int,
        rows: int | IntArray,
        phi: FloatArray,
        out: Jet,
        places: slice | IntArray,
    ) -> None:
        """Write the values of the formula of a `group` to `places` of `out`.

        `rows` is the number of one piece in the table of the group, or one for each place.
        """
        numbers, formula = self._tables[group][:, rows], self._formulas[group]
        if formula is None:
            out[0, places], out[1:, places] = numbers[3], 0.0
            return
        phi, (start, end, rate) = phi[places], numbers[:3]
        values = formula((phi - start) * rate, (end - phi) * rate, numbers[COLUMNS:])
        # A slice is a view, into which the product goes directly; indices make a copy, which is
        # written back.
        target = out[:, places] if isinstance(places, slice) else values
        np.multiply(values, numbers[4:COLUMNS].reshape(4, -1), out=target)
        target[0] += numbers[3]
        if target is values:
            out[:, places] = values


def indices_by_key(keys: IntArray) -> list[tuple[int, IntArray]]:
    """Each distinct key of `keys` (n,), ascending, with the indices at which it occurs."""
    order = np.argsort(keys, kind="stable")
    ends = np.flatnonzero(np.diff(keys[order])) + 1
    return [(int(keys[places[0]]), places) for places in np.split(order, ends) if len(places)]


# -- joints ---------------------------------------------------------------------------------------
# Joints of a motion plan: which segments meet there, and how smoothly.


ROUNDING = 1e-9
"""A derivative below this fraction of the bound of its order in its segment counts as zero; the
rounding of conversions from degrees is a thousand times smaller."""

JUMP = 1e-10
"""A jump below this fraction of the largest value of its order on either side is not a jump."""

JERK = 3
"""Highest order that may jump."""


@dataclass(frozen=True, slots=True, eq=False)
class Joint(Pickled, checked.CheckedFields):
    """A place where two segments meet; the first one is cam angle 0, where the turn closes.

    Attributes
    ----------
    cam_angle : [rad] in [0, 2 pi).
    position : lift [mm or rad].
    before, after : class of the end of the segment before the joint, and of the start of the one
        after it.
    order : order of the highest continuous derivative, -1 (none) to 3.
    left, right : (4,) lift and three derivatives with respect to the cam angle from either side.
    """

    cam_angle: float
    position: float
    before: End
    after: End
    order: int
    left: checked.Floats
    right: checked.Floats


@kept_with_owner
def joints(plan: MotionPlan) -> tuple[Joint, ...]:
    """The joints of `plan`, by ascending cam angle; a segment of zero length adds no joint."""
    return _evaluate_joints(plan, _angles(plan))


@kept_with_owner
def breaks(plan: MotionPlan) -> tuple[Joint, ...]:
    """The `joints` together with the places inside the laws at which a derivative may jump."""
    return _evaluate_joints(plan, ascending(np.append(_angles(plan), plan.breaks)))


def _angles(plan: MotionPlan) -> FloatArray:
    degrees = [float(angle) for angle in plan.joints_deg if angle < FULL_TURN]
    return ascending(np.radians(degrees))


def _evaluate_joints(plan: MotionPlan, angles: FloatArray) -> tuple[Joint, ...]:
    left, right = plan.jet(angles, "left"), plan.jet(angles)
    left_scale, right_scale = _scales(plan, angles, left, right)
    jumps = np.abs(right - left) > _slack(angles) * np.maximum(left_scale, right_scale)
    left = np.where(np.abs(left) > ROUNDING * left_scale, left, 0.0)
    right = np.where(np.abs(right) > ROUNDING * right_scale, right, 0.0)
    return tuple(
        Joint(
            cam_angle=float(angles[k]),
            position=float(right[0, k]),
            before=end_class(float(left[1, k]), float(left[2, k])),
            after=end_class(float(right[1, k]), float(right[2, k])),
            # The order of the first jump, less one; the True stands for no jump up to the third
            # derivative.
            order=int(np.argmax([*jumps[:, k], True])) - 1,
            left=left[:, k],
            right=right[:, k],
        )
        for k in range(len(angles))
    )


def _slack(angles: FloatArray) -> FloatArray:
    """(k,) fraction of a derivative up to which a difference at each of `angles` is rounding.

    The length of a segment is a difference of rounded cam angles, so derivatives of order n have a
    relative error of n times the rounding over the length: 1.5e-7 for the jerk of the shortest
    segments.
    """
    lengths = np.diff(np.append(angles, angles[0] + TURN))
    shorter = np.minimum(lengths, np.roll(lengths, 1))
    return np.asarray(JUMP + JERK * math.ulp(TURN) / shorter)


def _scales(
    plan: MotionPlan, angles: FloatArray, left: FloatArray, right: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """(4, k), (4, k) bounds of the derivatives in the segments before and after each joint."""
    low, high = isolation_cells(np.append(plan.borders, TURN))
    middle, bounds = plan.jet_and_bounds(low, high)
    cell_bounds = np.concatenate((np.abs(middle[:1]) + bounds[:1], bounds[1:]))
    first = np.searchsorted(0.5 * (low + high), angles)
    # The maximum over all cells from one joint to the next.
    size = np.maximum.reduceat(cell_bounds, first, axis=1)
    size = np.maximum(size, np.abs(right))
    right_scale: FloatArray = np.maximum(size, np.abs(np.roll(left, -1, axis=1)))
    # Positions are compared with the largest lift of the whole turn.
    right_scale[0] = np.max(right_scale[0])
    return np.roll(right_scale, 1, axis=1), right_scale


# -- spans ----------------------------------------------------------------------------------------
# Spans of the cam angle [degrees], exactly as written: which are valid, and their sums.


FULL_TURN: Final = Decimal(360)

SHORTEST_SPAN: Final = Decimal("1e-6")
"""Shortest span of a segment that moves; below it, velocities exceed what a double can resolve."""

DECIMALS: Final = 300
"""Most decimals of a span."""

EXACT: Final = Context(prec=DECIMALS + 100)
"""The context in which spans are added and subtracted exactly."""


def checked_span(key: str, value: Any, shortest: Decimal = Decimal(0)) -> Decimal:
    """A span from a decimal or another number; a float counts as Python prints it.

    Raises
    ------
    GeometryError
        Unless it is 0 or a number from `shortest` to 360.
    """
    span = Decimal(repr(checked.finite(key, value))) if isinstance(value, Real) else value
    if (
        not isinstance(span, Decimal)
        or not span.is_finite()
        or not (span == 0 or shortest <= span <= FULL_TURN)
        or int(span.as_tuple().exponent) < -DECIMALS
    ):
        lowest = f"0, or from {shortest} to 360" if shortest else "from 0 to 360"
        raise GeometryError(
            f"must be {lowest} (degrees), with at most {DECIMALS} decimals",
            key=key,
            value=checked.value_text(str(value) if isinstance(value, Decimal) else value),
        )
    return span


Span = Annotated[Decimal, checked_span]
MovingSpan = Annotated[Decimal, partial(checked_span, shortest=SHORTEST_SPAN)]


def sum_spans(spans: Iterable[Decimal]) -> tuple[Decimal, ...]:
    """The joints [degrees] between segments with these `spans`: their partial sums, from 0 to 360.

    Raises
    ------
    GeometryError
        With key "motion", if they do not end at 360 degrees exactly.
    """
    joints = [Decimal(0)]
    with localcontext(EXACT):
        for span in spans:
            joints.append(joints[-1] + span)
    if joints[-1] != FULL_TURN:
        raise GeometryError(
            f"the spans add up to {joints[-1]} degrees; they must add up to exactly 360",
            key="motion",
            value=str(joints[-1]),
        )
    return tuple(joints)
