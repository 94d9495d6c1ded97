"""Motion plan: dwells and moves in the order of the cam angle, closing after one turn.

Joints are sums of the spans exactly as written in degrees, each rounded to a double once; nothing
is accumulated in floating point (VDI 2143-1, eqs. 5 to 18).
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from decimal import Decimal
from functools import cached_property
from itertools import groupby
from operator import attrgetter
from typing import TYPE_CHECKING

import numpy as np

from camgeo.errors import GeometryError
from camgeo.motion.kept import Answers, Kept
from camgeo.motion.laws.law import Law
from camgeo.motion.motion import FULL_ORDER, Jet
from camgeo.motion.motion import Dwell as DwellSpan
from camgeo.motion.piece import SNAP, Piece, Pieces, places_of, spline_piece
from camgeo.motion.spans import SHORTEST_SPAN, MovingSpan, Span, joints_of, span_of
from camgeo.numeric import checked
from camgeo.numeric.arrays import FloatArray, Side, ascending, frozen, read_only
from camgeo.pickled import Pickled
from camgeo.units import TURN

if TYPE_CHECKING:  # only a motion by data needs splines
    from camgeo.motion.points import FitReport
    from camgeo.motion.spline import Spline


@dataclass(frozen=True, slots=True)
class Dwell:
    """A rest over `span` degrees, exactly as written; one of zero length is a momentary rest."""

    span: Span

    def __post_init__(self) -> None:
        checked.check_fields(self)


@dataclass(frozen=True, slots=True)
class Move:
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

    def __post_init__(self) -> None:
        checked.check_fields(self)


@dataclass(frozen=True, slots=True)
class SplineMove:
    """A move by data over `span` degrees: a spline in place of a law.

    Attributes
    ----------
    to : position at the end [mm or rad].
    spline : over z in [0, 1], the displacement from the position at the start [mm or rad].
    report : how far it is from the rows of a lift table; None for a motion through points.
    shift : what was added to every row of the table [mm or rad], so that the first one lies where
        the segment starts.
    """

    span: Decimal
    to: float
    spline: Spline
    report: FitReport | None = None
    shift: float = 0.0

    def __post_init__(self) -> None:
        knots = getattr(self.spline, "knots", None)
        if knots is None or (knots[0], knots[-1]) != (0.0, 1.0):
            raise GeometryError("must be a spline over 0 to 1", "spline", checked.shown(knots))
        span, to = span_of("span", self.span, SHORTEST_SPAN), checked.finite("to", self.to)
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
        joints = joints_of(segment.span for segment in segments)
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
                f"the motion starts at 0 and ends at {position:g}, it does not close after one"
                " turn; the last move must return to 0",
                key="motion",
            )

    @cached_property
    def stretches(self) -> tuple[tuple[Segment, float, float], ...]:
        """Each segment that has a length, and the cam angles [rad] at which it begins and ends."""
        joints = [math.radians(float(degrees)) for degrees in self.joints_deg]
        ends = zip(self.segments, joints[:-1], joints[1:], strict=True)
        return tuple(each for each in ends if each[0].span > 0)

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
        found: list[float] = []
        for before, after in zip(self._pieces[-1:] + self._pieces[:-1], self._pieces, strict=True):
            if before.rests and after.rests:
                continue
            inside = before.segment_start == after.segment_start
            if before.rests or after.rests or not inside or after.start in self._inner_breaks:
                found.append(after.start)
        return frozen(found, np.float64)

    @cached_property
    def _inner_breaks(self) -> frozenset[float]:
        found: set[float] = set()
        for segment, start, end in self.stretches:
            if isinstance(segment, Move):
                found.update(start + border * (end - start) for border in segment.law.borders)
        return frozenset(found)

    @cached_property
    def dwells(self) -> tuple[DwellSpan, ...]:
        """All rests, neighbours merged, also across cam angle 0."""
        runs = [[*run] for rests, run in groupby(self._pieces, attrgetter("rests")) if rests]
        found = [[run[0].start, run[-1].end] for run in runs]
        if len(found) > 1 and self._pieces[0].rests and self._pieces[-1].rests:
            found[-1][1] += found[0][1]
            found = found[1:]
        return tuple(DwellSpan(start, end - start) for start, end in found)

    @cached_property
    def harmonics(self) -> tuple[DwellSpan, ...]:
        """Where s''' = -s' without a rest, one for each formula."""
        chosen = (piece for piece in self._pieces if piece.is_harmonic)
        return tuple(DwellSpan(piece.start, piece.end - piece.start) for piece in chosen)

    def jet(self, phi: FloatArray, side: Side = "right", _order: int = FULL_ORDER) -> Jet:
        """(4, n) lift and derivatives at the cam angles `phi` (n,) [rad], any number of turns.

        All orders, because the higher ones cost little once the law's sines are computed.
        Read-only, and the same array for recent requests: forces, contact and torque each need the
        lift at the same cam angles, and so does another follower of the same motion.
        """
        phi = np.array(phi, dtype=np.float64, ndmin=1)  # a copy of our own

        def made() -> Jet:
            return read_only(self._columns.jet(in_turn(phi, side), side))

        return self._answers.recall(made, side, phi)

    def jet_and_bounds(self, low: FloatArray, high: FloatArray) -> tuple[Jet, Jet]:
        """The lift (4, n) in the middle of the cells [low, high] [rad], and bounds over them.

        These are bounds (4, n) of |s - s(middle)|, |s'|, |s''|, |s'''|.

        Taylor's theorem from the middle of each cell with the law's bound of |f'''|.
        """
        middle = 0.5 * (low + high)
        half = 0.5 * (high - low)
        values = self.jet(middle)
        out = np.abs(values)
        piece = self._columns.at(middle, "right")
        jerk = out[3]
        jerk[:] = self._columns.jerk_limits[piece]
        out[0] = half * (out[1] + half * (out[2] / 2.0 + half * jerk / 6.0))
        out[1] += half * (out[2] + half * jerk / 2.0)
        out[2] += half * jerk
        if self._by_data:
            for number, index in places_of(piece):
                if self._pieces[number].spline is not None:
                    out[:, index] = self._pieces[number].spline_bounds(low[index], high[index])
        return values, out

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
        phi = np.where(phi >= TURN - SNAP, 0.0, phi)
    if side == "left":
        phi = np.where(phi <= SNAP, TURN, phi)
    return phi
