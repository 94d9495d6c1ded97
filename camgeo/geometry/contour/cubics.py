"""Fit by cubic splines: C2 along each smooth piece, tangent at breaks, dwells and turns as arcs."""

from __future__ import annotations

import bisect
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, fields, replace

import numpy as np

from camgeo.errors import GeometryError, ToleranceError
from camgeo.geometry.contour.cubic_proof import FINEST, SHARE, ApproximatingArcs, approximating_arcs
from camgeo.geometry.contour.legs import (
    JOINT_DISTANCE,
    UNTRIED,
    Chain,
    Leg,
    StretchLeg,
    TurnLeg,
    check_regular,
    clearly_less,
    gap_error,
    in_steps,
    join_runs,
    path_legs,
    still_closer,
    too_many_error,
)
from camgeo.geometry.contour.proof import SHARPNESS, fit_until_proved, group_by_curve, proved_bound
from camgeo.geometry.contour.spline import Arc, CubicSpline, SplineContour, SplineFit
from camgeo.geometry.outline.path import Path
from camgeo.geometry.pieces import SmoothPiece
from camgeo.geometry.pitch_curve import WorkingCurve
from camgeo.kinematics.mechanism.follower import bend_of_path
from camgeo.kinematics.motion import FULL_ORDER
from camgeo.numeric.arrays import (
    BoolArray,
    ComplexArray,
    FloatArray,
    IntArray,
    Side,
    grouped,
    taken,
)

# -- parts ----------------------------------------------------------------------------------------
# A path as parts for a fit of splines: smooth pieces, evaluated at once, and arcs.


ROUNDING_OF_PARTS = 2.0**-52 * 64.0
"""Rounding of a point, and smallest tolerance, as a fraction of the distance from the cam axis."""


@dataclass(frozen=True, slots=True, eq=False)
class Part:
    """A part of a path that becomes one strand: a smooth piece of a stretch, or a turn.

    Attributes
    ----------
    leg : number of the leg that it lies on.
    begin : its parameter [rad] where the strand begins.
    start : its point there [mm].
    arc_length, piece : for a spline, the arc length that its knots measure, from the start of the
        piece of that number; None for an arc.
    sweep, centre : of an arc, [rad] and [mm].
    first, last : unit tangents at the ends of a smooth piece.
    """

    leg: int
    begin: float
    start: complex
    arc_length: ArcLength | None = None
    piece: int = 0
    sweep: float = 0.0
    centre: complex = 0j
    first: complex = 0j
    last: complex = 0j

    def arc(self, end: complex) -> Arc | None:
        """The single arc of a dwell or a turn; None for a piece that needs a spline."""
        if self.arc_length is not None:
            return None
        return Arc(self.start, end, self.sweep, self.centre)


def path_parts(legs: Sequence[Leg], tolerance: float) -> list[Part]:
    """The parts of a path, in order; those too short for a strand are omitted.

    Raises
    ------
    UndercutError
        If a piece is not regular.
    GeometryError
        If the path is torn apart inside a stretch.
    """
    stretches = [(k, leg) for k, leg in enumerate(legs) if isinstance(leg, StretchLeg)]
    pieces = [(number, leg, piece) for number, leg in stretches for piece in leg.pieces]
    piece_parts: list[Part | None] = [None] * len(pieces)
    right = np.empty(len(pieces), dtype=np.complex128)
    left = right.copy()
    for curve, chosen in group_by_curve([(leg, piece) for _, leg, piece in pieces]):
        numbers = [pieces[k][0] for k in chosen]
        starts, ends, parts = _curve_parts(curve, [pieces[k][2] for k in chosen], numbers)
        right[chosen], left[chosen] = starts, ends
        for k, part in zip(chosen, parts, strict=True):
            piece_parts[k] = part
    order: list[Part] = []
    begin = 0
    for number, leg in enumerate(legs):
        if isinstance(leg, TurnLeg):
            if not leg.is_slight(tolerance):
                order.append(Part(number, 0.0, leg.first, sweep=leg.sweep, centre=leg.centre))
            continue
        end = begin + len(leg.pieces)
        _require_joined(leg, right[begin:end], left[begin:end], tolerance)
        leg_parts = [part for part in piece_parts[begin:end] if part is not None]
        if leg_parts and not leg.closed:
            # An omitted piece before a part belongs to that part.
            start = leg_parts[0].start if leg.first is None else leg.first
            leg_parts[0] = replace(leg_parts[0], start=start, begin=leg.start)
        order += leg_parts
        begin = end
    return order


def _require_joined(
    leg: StretchLeg, right: ComplexArray, left: ComplexArray, tolerance: float
) -> None:
    """Raise GeometryError where a parallel has a gap: a jump of the follower's velocity tears it.

    `right`, `left` (pieces,) are the starts and the ends of its pieces.
    """
    gaps = np.abs(right - np.roll(left, 1))
    if not leg.closed:
        gaps[0] = 0.0
    if np.any(gaps > np.maximum(tolerance, ROUNDING_OF_PARTS * np.abs(right))):
        raise gap_error(leg.pieces[int(np.argmax(gaps))].start)


def _curve_parts(
    curve: WorkingCurve, pieces: Sequence[SmoothPiece], legs: Sequence[int]
) -> tuple[ComplexArray, ComplexArray, list[Part | None]]:
    """Starts and ends (pieces,) [mm] of pieces of one curve, and the parts that they will be; None
    for one too short. `legs` are the numbers of their legs.

    Two evaluations serve all: one from the right, one from the left, as calls cost more than
    numbers.
    """
    moving = [k for k, piece in enumerate(pieces) if not piece.is_arc]
    rests = [k for k, piece in enumerate(pieces) if piece.is_arc]
    phi, nodes = cell_angles([pieces[k] for k in moving])
    count = len(moving)
    rest_starts = np.array([pieces[k].start for k in rests])
    middle = np.array([0.5 * (pieces[k].start + pieces[k].end) for k in rests])
    # From the right: the starts of the cells, their nodes, then starts and middles of the arcs.
    here = CurveSamples.evaluate(
        curve, np.concatenate((phi[:, :-1].ravel(), nodes.ravel(), rest_starts, middle))
    )
    back = CurveSamples.evaluate(curve, np.array([piece.end for piece in pieces]), "left")

    stop, last = phi[:, :-1].size, phi[:, :-1].size + nodes.size
    cells = here.shaped(slice(0, stop), (count, CELLS))
    inside = here.shaped(slice(stop, last), nodes.shape)
    resting = here.shaped(slice(last, None), (2, len(rests)))
    for place, k in enumerate(moving):
        check_regular(curve, pieces[k], inside.regular[place])
    for place, k in enumerate(rests):
        check_regular(curve, pieces[k], resting.regular[:, place])

    starts = np.empty(len(pieces), dtype=np.complex128)
    middles = starts.copy()
    starts[moving], middles[moving] = cells.points[:, 0], cells.points[:, CELLS // 2]
    starts[rests], middles[rests] = resting.points
    ends = back.points
    # By way of the middle, as a closed piece ends where it starts.
    long = np.abs(middles - starts) + np.abs(ends - middles) > JOINT_DISTANCE * np.abs(starts)

    rows = [place for place, k in enumerate(moving) if long[k]]
    long_pieces = [moving[place] for place in rows]
    arc_length = None
    if long_pieces:
        points = np.column_stack((cells.points[rows], ends[long_pieces]))
        tangents = np.column_stack((cells.tangents[rows], back.tangents[long_pieces]))
        arc_length = ArcLength.from_samples(curve, phi[rows], points, tangents, taken(inside, rows))
    parts: list[Part | None] = [None] * len(pieces)
    for row, (place, k) in enumerate(zip(rows, long_pieces, strict=True)):
        first, arriving = complex(cells.tangents[place, 0]), complex(back.tangents[k])
        begin, start = pieces[k].start, complex(starts[k])
        parts[k] = Part(legs[k], begin, start, arc_length, row, first=first, last=arriving)
    for k in rests:
        if long[k]:
            centre = pieces[k].centre or 0j
            turn = -curve.pitch.rotation * (pieces[k].end - pieces[k].start)
            parts[k] = Part(legs[k], pieces[k].start, complex(starts[k]), sweep=turn, centre=centre)
    return starts, ends, parts


# -- arc length -----------------------------------------------------------------------------------
# Smooth pieces of a curve over their arc length, and their difficulty for a spline.
#
# All pieces of a path are evaluated in one call: the cost is in the calls, not in the points.


CELLS = 160
"""Cells of cam angle per piece. The arc length is only a parameter: its error of some 1e-8 moves a
spline along the curve, not off it."""


NODES = np.sqrt(0.6) * np.array([-1.0, 0.0, 1.0])
"""The three Gauss nodes in [-1, 1]."""


WEIGHTS = np.array([5.0, 8.0, 5.0]) / 9.0


SLOWEST = 1e-9
"""Smallest divisor 1 + d kappa; below it there is a cusp, where the difficulty is infinite at one
point."""


FLOOR = 0.02
"""Smallest density of knots, as a fraction of the piece's mean: every stretch gets knots."""


NEWTON = 4
"""Steps from the arc length to the cam angle, from a start within a cell."""


@dataclass(frozen=True, slots=True, eq=False)
class CurveSamples:
    """One evaluation of a parallel at n cam angles, in arrays of one shape.

    Attributes
    ----------
    points, tangents : complex [mm], and unit in the direction of growing cam angle.
    speed : |Z'| of the pitch curve [mm/rad].
    regular : 1 + d kappa.
    bend : kappa of the pitch curve [1/mm].
    slope : dkappa/dphi of the pitch curve [1/(mm rad)].
    """

    points: ComplexArray
    tangents: ComplexArray
    speed: FloatArray
    regular: FloatArray
    bend: FloatArray
    slope: FloatArray

    @classmethod
    def evaluate(cls, curve: WorkingCurve, phi: FloatArray, side: Side = "right") -> CurveSamples:
        """The evaluation at `phi` (n,) [rad], in one call."""
        pitch = curve.pitch
        relative = pitch.relative_jet(phi, side)
        speed = pitch.speed(relative)
        jet = pitch.in_cam(relative, phi, relative.along[:2], relative.across[:2])
        tangents = jet[1] / speed
        points = jet[0] + (1j * pitch.rotation * curve.distance) * tangents
        bend = bend_of_path(relative, speed, pitch.rotation)
        if len(relative.along) <= FULL_ORDER:  # a flat face has no R_3
            slope = pitch.curvature_slope(phi, side)
        else:
            (_, a1, a2, a3), (_, b1, b2, b3) = relative.along, relative.across
            cube = speed * speed * speed
            growth = (a1 * a2 + b1 * b2) / (speed * speed)
            slope = pitch.rotation * (b1 * a3 - a1 * b3) / cube - 3.0 * bend * growth
        return cls(points, tangents, speed, 1.0 + curve.distance * bend, bend, slope)

    def shaped(self, which: slice, shape: tuple[int, ...]) -> CurveSamples:
        """The part `which` of all arrays, reshaped."""
        part = taken(self, which)
        return CurveSamples(*(getattr(part, column.name).reshape(shape) for column in fields(part)))


@dataclass(frozen=True, slots=True, eq=False)
class ArcLength:
    """Smooth pieces of one parallel, end to end on one line of arc length S.

    Piece k is S in [ends[k], ends[k + 1]] [mm]; its cells of cam angle are uniform.

    Attributes
    ----------
    curve : the parallel.
    phi : (pieces, CELLS + 1) cam angles [rad] of the cells' ends.
    s : (pieces, CELLS + 1) arc length S [mm] there.
    points, tangents : (pieces, CELLS + 1) complex, there [mm] and unit.
    pace : (pieces, CELLS, 3) ds/dphi [mm/rad] at Gauss's nodes.
    density : (pieces, CELLS) difficulty |kappa'' - kappa^3|^(1/4) [1/mm] of each cell.
    """

    curve: WorkingCurve
    phi: FloatArray
    s: FloatArray
    points: ComplexArray
    tangents: ComplexArray
    pace: FloatArray
    density: FloatArray

    @classmethod
    def from_samples(
        cls,
        curve: WorkingCurve,
        phi: FloatArray,
        points: ComplexArray,
        tangents: ComplexArray,
        inside: CurveSamples,
    ) -> ArcLength:
        """Arc length and difficulty, from the curve at the cells' ends and, `inside`, at the nodes;
        see `cell_angles`.

        The pieces must be regular, except for cusps at single points.
        """
        half = 0.5 * (phi[:, -1:] - phi[:, :1]) / CELLS
        regular = np.maximum(inside.regular, SLOWEST)
        pace = inside.speed * regular
        steps = half * (pace @ WEIGHTS)
        lengths = np.sum(steps, axis=1)
        ends = np.concatenate(([0.0], np.cumsum(lengths)))
        s = np.concatenate((np.zeros_like(half), np.cumsum(steps, axis=1)), axis=1)
        # The two curvatures of a parallel: kappa_d = kappa/(1 + d kappa), and its slope over s_d.
        slope = inside.slope / (pace * regular * regular)
        kappa = inside.bend[..., 1] / regular[..., 1]
        node_distance = half * (pace[..., 0] + pace[..., 2]) * 0.5 * (NODES[2] - NODES[0])
        second = (slope[..., 2] - slope[..., 0]) / node_distance
        density = np.sqrt(np.sqrt(np.abs(second - kappa**3)))
        return cls(curve, phi, s + ends[:-1, None], points, tangents, pace, density)

    @property
    def ends(self) -> FloatArray:
        """(pieces + 1,) S [mm] at the ends of the pieces."""
        return np.append(self.s[:, 0], self.s[-1, -1])

    @property
    def totals(self) -> FloatArray:
        """(pieces,) integral of the difficulty over each piece."""
        return np.asarray(np.sum(self.density * np.diff(self.s, axis=1), axis=1))

    def require_finite(self) -> None:
        """Raise GeometryError if the curve stands still or its difficulty is not finite."""
        if not np.all(np.isfinite(self.s)) or np.any(np.diff(self.s, axis=1) <= 0.0):
            raise GeometryError(
                "the curve stands still, so that it has no spline over its arc length"
            )
        if not np.all(np.isfinite(self.totals)):
            raise GeometryError("the curvature is infinite along a stretch of the curve")

    @property
    def shares(self) -> FloatArray:
        """(pieces, CELLS + 1) share of the difficulty up to each cell's end, from 0 to 1, floored;
        evenly along a piece without any.
        """
        steps = np.diff(self.s, axis=1)
        lengths = np.sum(steps, axis=1, keepdims=True)
        work = self.density * steps
        total = np.sum(work, axis=1, keepdims=True)
        least = np.where(total > 0.0, FLOOR * total, 1.0) / lengths
        sums = np.cumsum(work + least * steps, axis=1)
        shares = np.concatenate((np.zeros_like(lengths), sums / sums[:, -1:]), axis=1)
        shares[:, -1] = 1.0
        return shares

    def angles(self, piece: IntArray, s: FloatArray) -> FloatArray:
        """(n,) cam angles [rad] at the arc lengths S `s` (n,) [mm] of the pieces `piece` (n,)."""
        flat = self.s[:, :-1].ravel()
        cell = self._cells(piece, s)
        pace = self.pace.reshape(-1, 3)[cell]
        # Pace as a parabola a + b x + c x^2 over x in [-1, 1]; its integral is the arc length.
        a = pace[:, 1]
        b = (pace[:, 2] - pace[:, 0]) / (2.0 * NODES[2])
        c = (0.5 * (pace[:, 2] + pace[:, 0]) - a) / (NODES[2] * NODES[2])
        low = self.phi[:, :-1].ravel()[cell]
        first, whole = self.phi[:, 1] - self.phi[:, 0], self.phi[:, -1] - self.phi[:, 0]
        # The cells of a piece of some ulps are no longer apart.
        half = 0.5 * np.where(first > 0.0, first, whole / CELLS)[piece]
        wanted = (s - flat[cell]) / half
        x = np.clip(wanted / a - 1.0, -1.0, 1.0)
        for _ in range(NEWTON):
            reached = a * (x + 1.0) + b * (x * x - 1.0) / 2.0 + c * (x * x * x + 1.0) / 3.0
            # Kept positive: next to a cusp the parabola may dip below zero.
            slope = np.maximum(a + x * (b + x * c), 1e-3 * a)
            x = np.clip(x + (wanted - reached) / slope, -1.0, 1.0)
        return low + half * (x + 1.0)

    def near(self, piece: IntArray, s: FloatArray) -> tuple[ComplexArray, ComplexArray]:
        """(n,), (n,) complex points [mm] and approximate unit tangents at S `s` (n,) [mm].

        By cubics between the cells' ends: for spans of at least four cells the cubics are off by
        less than a hundredth of what a spline of such spans is. Costs no evaluation.
        """
        cell = self._cells(piece, s)
        place = cell + cell // CELLS  # of the cell's start among the cells' ends
        flat, points, tangents = self.s.ravel(), self.points.ravel(), self.tangents.ravel()
        low, first, last = flat[place], points[place], points[place + 1]
        step = flat[place + 1] - low
        t = (s - low) / step
        leave, arrive = step * tangents[place], step * tangents[place + 1]
        # Hermite's cubic: the chord, plus terms by which both end slopes differ from it.
        chord = last - first
        bow, lean = leave - chord, arrive - chord
        w = 1.0 - t
        interpolated = first + t * chord + (t * w) * (w * bow - t * lean)
        along = chord + (w * (1.0 - 3.0 * t)) * bow + (t * (3.0 * t - 2.0)) * lean
        return interpolated, along / step

    def _cells(self, piece: IntArray, s: FloatArray) -> IntArray:
        """(n,) number of the cell that each `s` (n,) of the pieces `piece` (n,) lies in."""
        cell = np.searchsorted(self.s[:, :-1].ravel(), s, side="right") - 1
        return np.minimum(np.maximum(cell, piece * CELLS), piece * CELLS + (CELLS - 1))


def cell_angles(pieces: Sequence[SmoothPiece]) -> tuple[FloatArray, FloatArray]:
    """(pieces, CELLS + 1) and (pieces, CELLS, 3) cam angles [rad] of cells' ends and nodes."""
    start = np.array([piece.start for piece in pieces])[:, None]
    end = np.array([piece.end for piece in pieces])[:, None]
    phi = start + (end - start) * (np.arange(CELLS + 1) / CELLS)
    phi[:, -1:] = end
    middle = 0.5 * (phi[:, :-1] + phi[:, 1:])
    half = 0.5 * (end - start) / CELLS
    return phi, middle[..., None] + half[..., None] * NODES


# -- search ---------------------------------------------------------------------------------------
# Spans of least-squares splines: the number and the places of the knots.


CUBIC_CONSTANT = 768.0**-0.25
"""Cubics needed, asymptotically: 0.18996 eps^(-1/4) times the integral of
|kappa'' - kappa^3|^(1/4) ds.

kappa'' - kappa^3 is the normal part of the fourth derivative over the arc length. The error of a
C2 cubic over equal spans h is that times h^4 (B_4(t) - c)/24, B_4 Bernoulli's polynomial, which c
centres to +-1/32. The order is 4; it could be raised by parameters other than the arc length, which
are as free as a plane curve has components, but not by a C2 spline over the length."""

DAMPING = (1.0, 0.8, 0.6, 0.5, 0.4, 0.3, 0.3)
"""Powers of the correction of the spans, round by round: moving a knot changes the errors of all
spans near it."""

FAST_ROUNDS = 2
"""Number of corrections of a fit in one pass."""

SMALLEST = 1e-3
"""Least error of a span that counts, as a fraction of the largest one: it limits the correction."""

LEAST, LESS = 0.95, 1
"""The search for the fewest cubics begins at this fraction of the limit, less this number: a count
below the limit suffices only by chance, where a piece has few cubics."""

CANDIDATES = 6
"""Numbers of cubics that are tried at once."""

ONE_BY_ONE, STEP = 60, 1.015
"""Up to this many cubics each number is tried, then in steps: for a smooth piece of hundreds of
cubics a solution for each number is not worth its cost."""

SPARE = ((1.04, 1), (1.10, 1), (1.17, 2), (1.25, 2))
"""The fast fit tries the limit times the first number, plus the second for the ends."""

MAX_CUBICS = 20_000
"""Most cubics of a smooth piece; a tolerance that needs more is beyond double precision."""


def _ladder() -> list[int]:
    counts = list(range(1, ONE_BY_ONE + 1))
    while counts[-1] < MAX_CUBICS:
        counts.append(math.ceil(counts[-1] * STEP))
    return counts


LADDER = _ladder()


@dataclass(frozen=True, slots=True)
class FittedSpline:
    """A spline for a piece, and its largest distance [mm] found."""

    spline: CubicSpline
    error: float


@dataclass(frozen=True, slots=True, eq=False)
class Trial:
    """The best splines found for a layout.

    Attributes
    ----------
    worst : (splines,) [mm] largest distance found of each.
    """

    layout: SplineLayout
    solution: Solution
    worst: FloatArray

    def fitted_spline(self, number: int) -> FittedSpline:
        """The spline `number`, over its own arc length, which begins at 0."""
        layout, solution = self.layout, self.solution
        count = int(layout.counts[number])
        first = int(layout.span_starts[number])
        begin = int(layout.control_starts[number])
        places = np.append(solution.low[first : first + count], solution.high[first + count - 1])
        places = places - places[0]
        knots = np.concatenate(
            (np.repeat(places[:1], ORDER), places[1:-1], np.repeat(places[-1:], ORDER))
        )
        spline = CubicSpline(knots, solution.controls[begin : begin + count + ORDER - 1])
        return FittedSpline(spline, float(self.worst[number]))


def limits(arc_length: ArcLength, aim: float) -> FloatArray:
    """(pieces,) cubics that each piece needs for `aim` [mm], asymptotically; not whole numbers."""
    return np.asarray(CUBIC_CONSTANT * arc_length.totals * aim**-0.25)


def fewest(
    arc_length: ArcLength, ends: SplineEnds, aim: float, tolerance: float
) -> list[FittedSpline]:
    """A spline for each piece, of the fewest cubics whose distance found is at most `aim` [mm].

    For a number of cubics the distance depends only on the piece, and the numbers tried only on the
    aim at which they begin; so a larger aim never needs more cubics.

    Raises
    ------
    ToleranceError
        If more than `MAX_CUBICS` would be needed, or no number comes closer.
    """
    starts = (bisect.bisect_left(LADDER, LEAST * limit - LESS) for limit in limits(arc_length, aim))
    counts = [LADDER[start : start + CANDIDATES] for start in starts]

    def next_counts(count: int, _excess: float) -> Sequence[int]:
        start = bisect.bisect_right(LADDER, count)
        return LADDER[start : start + CANDIDATES]

    return _search(arc_length, ends, counts, next_counts, DAMPING, aim, tolerance)


def fast(
    arc_length: ArcLength, ends: SplineEnds, aim: float, tolerance: float
) -> list[FittedSpline]:
    """A spline for each piece whose distance found is at most `aim` [mm], nearly always in one
    pass: a few numbers of cubics are tried at once, because calls cost more than numbers.

    Raises
    ------
    ToleranceError
        If more than `MAX_CUBICS` would be needed, or no number comes closer.
    """
    counts = [
        _allowed_counts(sorted({math.ceil(factor * limit) + more for factor, more in SPARE}))
        for limit in limits(arc_length, aim)
    ]

    def next_counts(count: int, excess: float) -> Sequence[int]:
        return _allowed_counts([max(count + 1, math.ceil(count * min(2.0, 1.02 * excess**0.25)))])

    return _search(arc_length, ends, counts, next_counts, DAMPING[:FAST_ROUNDS], aim, tolerance)


def _allowed_counts(counts: list[int]) -> list[int]:
    return counts if counts[-1] <= MAX_CUBICS else []


def _search(
    arc_length: ArcLength,
    ends: SplineEnds,
    counts: Sequence[Sequence[int]],
    next_counts: Callable[[int, float], Sequence[int]],
    damping: tuple[float, ...],
    aim: float,
    tolerance: float,
) -> list[FittedSpline]:
    """A spline for each piece, of the first of its `counts` of cubics whose distance is at most
    `aim` [mm]; if there is none, of those that `next_counts` gives, by the last number and its
    distance over the aim.
    """
    open_counts = dict(enumerate(counts))
    marks = [UNTRIED] * len(counts)
    splines: dict[int, FittedSpline] = {}
    while open_counts:
        if not all(open_counts.values()):
            raise too_many_error(MAX_CUBICS, "cubics", tolerance)
        tried = [(k, count) for k, piece_counts in open_counts.items() for count in piece_counts]
        trial = _equalise_spans(arc_length, ends, tried, damping)
        for number, (k, count) in enumerate(tried):
            worst = float(trial.worst[number])
            if k in splines:
                continue
            if worst <= aim:
                splines[k] = trial.fitted_spline(number)
                del open_counts[k]
            else:
                marks[k] = still_closer(marks[k], count, worst, tolerance)
                open_counts[k] = next_counts(count, worst / aim)
    return [splines[k] for k in range(len(counts))]


def _equalise_spans(
    arc_length: ArcLength,
    ends: SplineEnds,
    tried: list[tuple[int, int]],
    damping: tuple[float, ...],
) -> Trial:
    """Splines for pairs (piece, cubics), their spans shifted until all errors are about equal."""
    piece = np.array([k for k, _ in tried], dtype=np.intp)
    counts = np.array([count for _, count in tried], dtype=np.intp)
    layout = SplineLayout(piece, counts, taken(ends, piece))
    owner, local = grouped(counts)
    # All pieces lie on one line of S, and their shares from 0 to 1 on one from 0 to their number.
    shares = (np.arange(len(arc_length.s))[:, None] + arc_length.shares).ravel()
    line = arc_length.s.ravel()
    low = np.interp(piece[owner] + local / counts[owner], shares, line)
    high = np.interp(piece[owner] + (local + 1) / counts[owner], shares, line)
    solution = solve(arc_length, layout, low, high)
    best_low, best_high = low, high
    worst = np.maximum.reduceat(solution.errors, layout.span_starts)
    for power in damping:
        low, high = _shift_spans(arc_length, layout, owner, solution, power)
        solution = solve(arc_length, layout, low, high)
        now = np.maximum.reduceat(solution.errors, layout.span_starts)
        better = clearly_less(now, worst)
        moved = better[owner]
        best_low, best_high = np.where(moved, low, best_low), np.where(moved, high, best_high)
        worst = np.where(better, now, worst)
    best = solve(arc_length, layout, best_low, best_high, final=True)
    return Trial(layout, best, np.maximum.reduceat(best.errors, layout.span_starts))


def _shift_spans(
    arc_length: ArcLength, layout: SplineLayout, owner: IntArray, solution: Solution, power: float
) -> tuple[FloatArray, FloatArray]:
    """New spans: the density of knots grows with the fourth root of the error, to a power."""
    first = layout.span_starts
    last = first + layout.counts - 1
    worst = np.maximum.reduceat(solution.errors, first)
    share = solution.errors / np.where(worst > 0.0, worst, 1.0)[owner]
    work = np.exp(0.25 * power * in_steps(np.log(share + SMALLEST)))
    sums = np.cumsum(work)
    prior_work = (sums[first] - work[first])[owner]
    total = np.add.reduceat(work, first)[owner]
    # Work up to the end of each span, such that a spline's work is its number of spans.
    progress = first[owner] + (sums - prior_work) / total * layout.counts[owner]
    # Exactly, whatever the sums round to.
    progress[last] = last + 1.0
    lengths = solution.high - solution.low
    far = np.cumsum(lengths)
    line = np.interp(np.arange(len(owner) + 1.0), np.append(0.0, progress), np.append(0.0, far))
    # The line of all spans is moved, spline by spline, onto the pieces of the curve.
    offset = (arc_length.ends[layout.piece] - (far[first] - lengths[first]))[owner]
    low, high = line[:-1] + offset, line[1:] + offset
    low[first], high[last] = arc_length.ends[layout.piece], arc_length.ends[layout.piece + 1]
    return low, high


# -- least squares --------------------------------------------------------------------------------
# C2 cubic splines by least squares: many splines at once, over the arc length of the curve.
#
# The samples are the ends and the middles of the spans, with equal weights. Over equal spans the
# error of a spline then is a sum of Bernoulli polynomials of degree 4, centred so that it is as
# large at knots as between them: the least that a C2 cubic can have, h^4/768 times the fourth
# derivative.


PARTS = np.array([0.0, 0.25, 0.5, 0.75])
"""Places in each span at which the curve is evaluated while knots are shifted; the largest errors
lie near 0 and 1/2."""

FINE_PARTS = np.arange(8) / 8.0
"""Places in each span for the final error; parabolas between them give the peaks."""

CELLS_A_SPAN = 4
"""Cells that a span must have, on average over its piece, for the curve to be interpolated between
them while knots are shifted."""

ORDER = 4


@dataclass(frozen=True, slots=True, eq=False)
class SplineEnds:
    """Where splines begin and end [mm], and their unit tangents there: complex, one each."""

    starts: ComplexArray
    stops: ComplexArray
    first: ComplexArray
    last: ComplexArray


@dataclass(frozen=True, slots=True, eq=False)
class SplineLayout:
    """Splines to be fitted, one after the other, with the indices of their spans and control
    points.

    Attributes
    ----------
    piece : (splines,) the piece of the curve that each follows.
    counts : (splines,) cubics of each.
    ends : of each spline.
    """

    piece: IntArray
    counts: IntArray
    ends: SplineEnds

    @property
    def span_starts(self) -> IntArray:
        """(splines,) first span of each."""
        return np.cumsum(self.counts) - self.counts

    @property
    def control_starts(self) -> IntArray:
        """(splines,) first control point of each."""
        controls = self.counts + ORDER - 1
        return np.cumsum(controls) - controls


@dataclass(frozen=True, slots=True, eq=False)
class Solution:
    """Fitted splines with their errors.

    Attributes
    ----------
    low, high : (spans,) arc length S [mm] of the ends of each span.
    controls : (all control points,) complex [mm].
    errors : (spans,) [mm] largest distance from the curve found in each span.
    """

    low: FloatArray
    high: FloatArray
    controls: ComplexArray
    errors: FloatArray


def solve(
    arc_length: ArcLength,
    layout: SplineLayout,
    low: FloatArray,
    high: FloatArray,
    *,
    final: bool = False,
) -> Solution:
    """The splines with spans from `low` to `high` (spans,) [mm] in S.

    If `final`, the curve itself is evaluated and the error found at `FINE_PARTS`; before, points
    interpolated between the cells of `arc_length` suffice, at `PARTS`.

    Ends and end tangents are those of the curve: the outermost legs are a third of a span long, as
    they are where the parameter is the arc length.
    """
    from scipy.linalg import solveh_banded  # only where a spline is fitted

    spans = len(low)
    owner = np.repeat(np.arange(len(layout.counts)), layout.counts)
    first_span = layout.span_starts[owner]
    local = np.arange(spans) - first_span
    parts = FINE_PARTS if final else PARTS
    # Over each span only the four B-splines `columns` differ from zero.
    basis = _basis(low, high, first_span, first_span + layout.counts[owner] - 1, parts)
    columns = (layout.control_starts[owner] + local)[:, None] + np.arange(ORDER)

    sample_s = low[:, None] + (high - low)[:, None] * parts
    exact = np.full(spans, final) | (layout.counts * CELLS_A_SPAN > CELLS)[owner]
    points, tangents = _curve_points(arc_length, layout.piece[owner], sample_s, exact)

    fixed, held = _fixed_controls(layout, low, high)
    middle = len(parts) // 2
    chosen = basis[:, ::middle]  # ends and middles of the spans
    free = chosen * ~held[columns][:, None, :]
    # In the sums s is the span, q the place in it, and c, i, j one of its four control points.
    rest = points[:, ::middle] - np.einsum("sqc,sc->sq", chosen, fixed[columns])
    products = np.einsum("sqi,sqj->sij", free, free)
    size = len(fixed)
    # The lower half of the banded normal matrix, row k its k-th diagonal below the main one.
    bands = np.zeros((ORDER, size))
    for offset in range(ORDER):
        for i in range(ORDER - offset):
            bands[offset] += np.bincount(
                columns[:, i], weights=products[:, i, i + offset], minlength=size
            )
    # Held control points have no other entries: 1 on the diagonal keeps the matrix regular.
    bands[0] += held
    sides = np.einsum("sqi,sq->si", free, rest)
    right = np.empty((size, 2))
    for k, part in enumerate((sides.real, sides.imag)):
        right[:, k] = np.bincount(columns.ravel(), weights=part.ravel(), minlength=size)
    solved = solveh_banded(bands, right, lower=True, check_finite=False)
    controls = np.where(held, fixed, solved[:, 0] + 1j * solved[:, 1])

    residuals = np.einsum("sqc,sc->sq", basis, controls[columns]) - points
    offsets = (np.conj(tangents) * residuals).imag  # the part along the curve is not a distance
    errors = np.max(np.abs(offsets), axis=1)
    if final:
        first = layout.span_starts
        errors = np.maximum(errors, _peaks(offsets, first, first + layout.counts - 1))
    return Solution(low, high, controls, errors)


def _peaks(offsets: FloatArray, first: IntArray, last: IntArray) -> FloatArray:
    """(spans,) largest magnitude of the parabolas through any three neighbours of `offsets` (spans,
    parts).

    At their vertices; those of the spans before and after count too. Before the spans `first` and
    after the spans `last` (splines,) nothing is off.
    """
    following, previous = np.roll(offsets[:, 0], -1), np.roll(offsets[:, -1], 1)
    following[last] = 0.0
    previous[first] = 0.0
    values = np.column_stack((previous, offsets, following))
    previous, here, following = values[:, :-2], values[:, 1:-1], values[:, 2:]
    slope = 0.5 * (following - previous)
    bend = following - 2.0 * here + previous
    fall = np.divide(0.5 * slope * slope, bend, out=np.zeros_like(bend), where=bend != 0.0)
    peaks = np.where(np.abs(slope) < np.abs(bend), np.abs(here - fall), 0.0)
    return np.asarray(np.max(peaks, axis=1))


def _curve_points(
    arc_length: ArcLength, piece: IntArray, s: FloatArray, exact: BoolArray
) -> tuple[ComplexArray, ComplexArray]:
    """(spans, parts) points and tangents of the curve at S `s`, the curve itself where `exact`
    (spans,), else between its cells.
    """
    sample_piece = np.repeat(piece, s.shape[1]).reshape(s.shape)
    if np.all(exact):
        points, tangents = _exact_points(arc_length, sample_piece.ravel(), s.ravel())
        return points.reshape(s.shape), tangents.reshape(s.shape)
    points, tangents = arc_length.near(sample_piece, s)
    if np.any(exact):
        exact_values = _exact_points(arc_length, sample_piece[exact].ravel(), s[exact].ravel())
        points[exact], tangents[exact] = (part.reshape(-1, s.shape[1]) for part in exact_values)
    return points, tangents


def _exact_points(
    arc_length: ArcLength, piece: IntArray, s: FloatArray
) -> tuple[ComplexArray, ComplexArray]:
    """Points and unit tangents (n,) of the curve itself at S `s` (n,) [mm] of `piece` (n,)."""
    return arc_length.curve.points_and_tangents(arc_length.angles(piece, s))


def _fixed_controls(
    layout: SplineLayout, low: FloatArray, high: FloatArray
) -> tuple[ComplexArray, BoolArray]:
    """(control points,) complex [mm] the four outermost control points of each spline, 0 for all
    others; and a mask of those four.
    """
    fixed = np.zeros(int(np.sum(layout.counts + ORDER - 1)), dtype=np.complex128)
    begin = layout.control_starts
    end = begin + layout.counts + ORDER - 2
    steps = high - low
    spans = layout.span_starts
    ends = layout.ends
    fixed[begin] = ends.starts
    fixed[begin + 1] = ends.starts + ends.first * steps[spans] / 3.0
    fixed[end] = ends.stops
    fixed[end - 1] = ends.stops - ends.last * steps[spans + layout.counts - 1] / 3.0
    held = np.zeros(len(fixed), dtype=np.bool_)
    for place in (begin, begin + 1, end - 1, end):
        held[place] = True
    return fixed, held


def _basis(
    low: FloatArray, high: FloatArray, first: IntArray, last: IntArray, parts: FloatArray
) -> FloatArray:
    """(spans, parts, 4) the four B-splines over each span, clamped at the spans `first`, `last`."""
    index = np.arange(len(low))
    # The recursion of Cox and de Boor; beyond the ends of a spline its knots repeat.
    left_knots = [low[np.maximum(index - k, first)] for k in (2, 1, 0)]
    right_knots = [high[np.minimum(index + k, last)] for k in (0, 1, 2)]
    knots = np.stack((*left_knots, *right_knots), axis=1)[:, None, :]
    x = low[:, None] + (high - low)[:, None] * parts
    values = [np.ones_like(x)]
    for degree in range(1, ORDER):
        grown = [np.zeros_like(x) for _ in range(degree + 1)]
        for k in range(degree):
            left, right = knots[..., 3 - degree + k], knots[..., 3 + k]
            share = values[k] / (right - left)
            grown[k] += (right - x) * share
            grown[k + 1] += (x - left) * share
        values = grown
    return np.stack(values, axis=-1)


# -- fits -----------------------------------------------------------------------------------------


AIM = 0.96
"""Fraction of the tolerance that the distance found may reach. The proof takes 1 % for its cells
and 2 % for its arcs, which may lie farther off than the spline; the rest is for what the parabolas
between samples miss, so that the first proof holds."""

STRAIGHT = 2.0**-52 * 64.0
"""A piece whose sagitta is a smaller fraction of its distance from the cam axis is a line."""

Search = Callable[[ArcLength, SplineEnds, float, float], list[FittedSpline]]


def fit_spline(path: Path, tolerance: float) -> SplineFit:
    """Cubic splines within `tolerance` [mm] of `path`, counter-clockwise, in one pass.

    Each smooth piece between breaks is one spline, C2 inside and along the curve's tangents at both
    ends. Each dwell is one arc about the cam axis, of any sweep, each arc of the path is one arc,
    and a straight piece is one line. Corners are where the path has them and nowhere else.

    Raises
    ------
    UndercutError
        If the path is not regular.
    ToleranceError
        If the tolerance cannot be reached in double precision.
    GeometryError
        If the contour cannot be compared with the path, or the path has a gap.
    """
    return _fit_proved(path, tolerance, fast)


def fewest_cubics(path: Path, tolerance: float) -> SplineFit:
    """As `fit_spline`, with the fewest cubics along each smooth piece, then the least deviation.

    Only splines over the arc length are searched; for their number see `CUBIC_CONSTANT`.
    """
    return _fit_proved(path, tolerance, fewest)


def _fit_proved(path: Path, tolerance: float, search: Search) -> SplineFit:
    legs = path_legs(path)
    parts = path_parts(legs, tolerance)
    size = max(abs(part.start) for part in parts)
    if not tolerance > ROUNDING_OF_PARTS * size:
        raise ToleranceError(
            "a spline cannot follow the curve", tolerance, ROUNDING_OF_PARTS * size
        )
    ends = [part.start for part in (*parts[1:], parts[0])]
    arcs = [part.arc(end) for part, end in zip(parts, ends, strict=True)]
    groups = _groups(parts, ends, [k for k, arc in enumerate(arcs) if arc is None])

    def fit(aim: float) -> tuple[SplineContour, float]:
        whole: list[CubicSpline | Arc | None] = list(arcs)
        error = 0.0
        for chosen, arc_length, spline_ends in groups:
            for k, fitted in zip(
                chosen, search(arc_length, spline_ends, aim, tolerance), strict=True
            ):
                whole[k] = _strand(fitted.spline, size)
                error = max(error, fitted.error)
        return SplineContour(tuple(strand for strand in whole if strand is not None)), error

    def prove(fitted: tuple[SplineContour, float]) -> float:
        return fitted_deviation(legs, parts, *fitted, SHARPNESS * tolerance)

    (contour, _), reached = fit_until_proved(fit, prove, AIM * tolerance, tolerance)
    return SplineFit(contour.counter_clockwise(), reached, tolerance)


def _groups(
    parts: Sequence[Part], ends: Sequence[complex], open_parts: Sequence[int]
) -> list[tuple[list[int], ArcLength, SplineEnds]]:
    """The parts that need splines, by their curve; nearly always there is only one curve."""
    chosen: dict[int, tuple[ArcLength, list[int]]] = {}
    for k in open_parts:
        arc_length = parts[k].arc_length
        if arc_length is not None:
            chosen.setdefault(id(arc_length), (arc_length, []))[1].append(k)
    groups = []
    for arc_length, members in chosen.values():
        arc_length.require_finite()
        spline_ends = SplineEnds(
            np.array([parts[k].start for k in members]),
            np.array([ends[k] for k in members]),
            np.array([parts[k].first for k in members]),
            np.array([parts[k].last for k in members]),
        )
        groups.append((members, arc_length, spline_ends))
    return groups


def _strand(spline: CubicSpline, size: float) -> CubicSpline | Arc:
    """The spline, or a line if it is straight."""
    chord = spline.end - spline.start
    across = np.conj(chord) * (spline.controls - spline.start)
    if len(spline) == 1 and np.max(np.abs(across.imag)) <= STRAIGHT * size * abs(chord):
        return Arc(spline.start, spline.end, 0.0, 0j)
    return spline


ARC_CELLS = 4
"""Cells of an arc to begin with in the proof of a fit. What is not known over a cell falls with the
cube of its width; and these arcs are short enough for a hundredth of the distance, so that cells of
the same width are a fifth as many an arc as where the arcs themselves make the distance."""


def fitted_deviation(
    legs: Sequence[Leg], parts: Sequence[Part], contour: SplineContour, scale: float, enough: float
) -> float:
    """Upper bound [mm] of the distance between a spline contour and its path, where the place of
    each strand along the path is known.

    Parameters
    ----------
    legs : of the path, in order.
    parts : (strands,) the part of the path of each strand; the contour runs in its direction.
    scale : largest distance found [mm].
    enough : a bound [mm] that need not be made sharper.

    Raises
    ------
    GeometryError
        If the contour does not follow the path once round.
    """
    fine = approximating_arcs(contour, max(SHARE * max(scale, enough), FINEST * contour.reach))
    angles = _angles(parts, contour, fine)
    arcs = fine.contour
    ends = np.cumsum(fine.counts)
    chains: list[list[Chain]] = [[] for _ in legs]
    for part, end, count in zip(parts, ends, fine.counts, strict=True):
        which = slice(int(end - count), int(end))
        chains[part.leg].append(
            Chain(angles[which], arcs.vertices[which], arcs.sweeps[which], arcs.centres[which])
        )
    runs = join_runs(
        [(leg, leg_chains or [Chain.empty()]) for leg, leg_chains in zip(legs, chains, strict=True)]
    )
    if any(np.any(np.diff(run.angles) <= 0.0) for run in runs):
        raise GeometryError("the contour does not follow the exact curve once round")
    return proved_bound(runs, ARC_CELLS, enough) + fine.distance


def _angles(parts: Sequence[Part], contour: SplineContour, fine: ApproximatingArcs) -> FloatArray:
    """(n,) parameters [rad] of the legs at the feet of the vertices of the arcs.

    A spline runs over the arc length, except for its deviation along the curve, which is as small
    as that across: one Newton step is enough, and any other place would do, see
    `camgeo.geometry.contour.proof`.
    """
    angles = np.repeat([part.begin for part in parts], fine.counts)
    low, width = [], []
    arc_lengths: dict[int, ArcLength] = {}
    for part, strand in zip(parts, contour.strands, strict=True):
        if part.arc_length is not None:
            arc_lengths[id(part.arc_length)] = part.arc_length
        if isinstance(strand, CubicSpline):
            begin = 0.0 if part.arc_length is None else part.arc_length.s[part.piece, 0]
            low.append(begin + strand.knots[3:-4])
            width.append(np.diff(strand.knots[3:-3]))
    of_strand = np.repeat(np.arange(len(parts)), fine.counts)
    inner = fine.cubics >= 0
    inner[np.cumsum(fine.counts) - fine.counts] = False  # a strand's own start is known
    owner = np.array([id(part.arc_length) for part in parts])[of_strand]
    piece = np.array([part.piece for part in parts])[of_strand]
    for key, arc_length in arc_lengths.items():
        which = np.flatnonzero(inner & (owner == key))
        if not len(which):
            continue
        cubic = fine.cubics[which]
        s = np.concatenate(low)[cubic] + fine.shares[which] * np.concatenate(width)[cubic]
        phi = arc_length.angles(piece[which], s)
        points, tangents, pace = arc_length.curve.traced(phi)
        ahead = (np.conj(tangents) * (fine.contour.vertices[which] - points)).real
        forward = pace > 0.0
        angles[which] = phi + np.where(forward, ahead, 0.0) / np.where(forward, pace, 1.0)
    return angles
