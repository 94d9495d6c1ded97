"""The crossings of a flank with itself, all of them: boxes exclude, halving decides, Newton
refines.

See `camgeo.geometry.outline.envelope` for what is proved of neighbouring cells. Cells that lie
apart are excluded by their boxes or halved; where the tangents of two cells provably differ they
cross at most once, and Newton's method finds whether they do. So does
`camgeo.geometry.outline.crossings` for the one crossing of a swallow tail, far below the size at
which points of the flank are distinct.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from camgeo.errors import GeometryError
from camgeo.geometry.outline.cusps import backward_ranges
from camgeo.geometry.outline.envelope import (
    PLACE,
    ROUNDING,
    STRAIGHT,
    Cells,
    Division,
    Envelope,
    EnvelopeSamples,
    cross_once,
    divide,
    envelope_of,
    halved,
    meet,
    overlapping,
)
from camgeo.geometry.pieces import Extremes
from camgeo.geometry.working_curve import WorkingCurve
from camgeo.numeric.arrays import BoolArray, ComplexArray, FloatArray, IntArray, joined
from camgeo.numeric.quadrature import gauss

HALVINGS = 60
"""Most rounds of halving."""

MOST = 20_000
"""Most pairs of cells in a round; more means a flank that lies on itself along a stretch."""

NEWTON = 8
"""Newton steps; from a cell in which the tangents provably differ they converge at once."""

OUTSIDE = 0.05
"""Distance outside its cell at which a crossing still counts for it, as a fraction of the cell; a
crossing found by two neighbours counts once."""

SAME, TOUCHING = 1e-9, 1e-5
"""Crossings, and contacts, whose path parameters differ by less are the same."""


@dataclass(frozen=True, slots=True)
class Crossing:
    """A point that a flank passes twice.

    Attributes
    ----------
    first, second : cam angles [rad] in [0, 2 pi), first < second.
    point : its place [mm].
    """

    first: float
    second: float
    point: complex


@dataclass(frozen=True, slots=True)
class Node:
    """A crossing by its path parameters in [0, total), first < second.

    `touching` if the flank only touches itself there, to rounding.
    """

    first: float
    second: float
    point: complex
    touching: bool = False


def find_crossings(curve: WorkingCurve, bends: Extremes | None = None) -> tuple[Crossing, ...]:
    """All crossings of the parallel `curve` with itself, by the first cam angle.

    Mere contacts are not crossings. `bends` are the extremes of the pitch curve's curvature, if
    known.

    Raises
    ------
    GeometryError
        If the question cannot be decided, e.g. where the flank lies on itself along a stretch.
    """
    envelope = envelope_of(curve)
    nodes = find_nodes(envelope, backward_ranges(envelope, bends))
    crossing = [node for node in nodes if not node.touching]
    places = np.array([(node.first, node.second) for node in crossing]).reshape(-1, 2)
    angles = envelope.angles_at(places).tolist()
    found = [
        Crossing(first, second, node.point)
        for (first, second), node in zip(angles, crossing, strict=True)
    ]
    return tuple(sorted(found, key=lambda each: (each.first, each.second)))


def find_nodes(envelope: Envelope, backward: list[tuple[float, float]]) -> tuple[Node, ...]:
    """All crossings and contacts of `envelope`, given the ranges in which it runs backwards."""
    ends = np.array([place for span in backward for place in span])
    division = divide(envelope, envelope.within(ends) if len(ends) else ends)
    tails: tuple[SwallowTail, ...] = ()
    if backward:
        tails = swallow_tails(division, backward)
    pairs = _apart(division, tails)
    nodes = [_node(tail.first, tail.second, tail.point) for tail in tails]
    nodes += _decide(envelope, division.cells, pairs)
    return _distinct(nodes, envelope.total)


def _apart(division: Division, tails: tuple[SwallowTail, ...]) -> tuple[IntArray, IntArray]:
    """Pairs of cells that may cross and do not belong to a run already settled."""
    first, second = overlapping(division.envelope, division.cells)
    count = len(division.cells)
    plain = division.is_plain(first, second) | division.is_plain(second, first + count)
    # Both inside the run of a tail is what is known: how far a run gets that holds each cell.
    reach = np.zeros(count, dtype=np.intp)
    for tail in tails:
        reach[tail.start] = max(reach[tail.start], tail.start + tail.cells)
        reach[0] = max(reach[0], tail.start + tail.cells - count)
    reach = np.maximum.accumulate(reach)
    plain |= (reach[first] > second) | (reach[second] > first + count)
    first, second = first[~plain], second[~plain]
    both = meet(division.cells.some(first), division.cells.some(second))
    return first[both], second[both]


def _decide(envelope: Envelope, cells: Cells, pairs: tuple[IntArray, IntArray]) -> list[Node]:
    """Halve until each pair is apart, crosses once, or is too small to be halved."""
    found: list[Node] = []
    first, second = pairs
    for _ in range(HALVINGS):
        if not len(first):
            return found
        if len(first) > MOST:
            break
        one, other = cells.some(first), cells.some(second)
        once = cross_once(one, other)
        done = np.zeros(len(first), dtype=np.bool_)
        small = ~once & _slim(envelope, one) & _slim(envelope, other)
        if np.any(once):
            known, blurred, nodes = _newton(envelope, one.some(once), other.some(once))
            done[once], small[once] = known, blurred
            found += nodes
        small |= ~done & _tiny(envelope, one) & _tiny(envelope, other)
        for k in np.flatnonzero(small):
            point = complex(one.middle[k])
            found.append(_node(float(one.low[k]), float(other.low[k]), point, touching=True))
        done |= small
        cells, first, second = _refined(envelope, cells, first[~done], second[~done])
    if not len(first):
        return found
    one, other = cells.some(first), cells.some(second)
    apart = np.abs(one.middle - other.middle)
    nearest = [int(np.argmin(apart))]
    angles = [math.degrees(envelope.angles_at(each.low[nearest])[0]) for each in (one, other)]
    raise GeometryError(
        f"about cam angles {angles[0]:.6f} and {angles[1]:.6f} deg two stretches of the flank lie"
        f" on each other, to {apart[nearest[0]]:.2g} mm: it cannot be decided what is left of it"
    )


def _slim(envelope: Envelope, cells: Cells) -> BoolArray:
    """Cells that bend by no more than rounding: their neighbours there touch them."""
    size = np.abs(cells.middle) + abs(envelope.curve.distance)
    slim: BoolArray = cells.across <= 2.0 * ROUNDING * size
    return slim


def _tiny(envelope: Envelope, cells: Cells) -> BoolArray:
    """Cells no longer than rounding, on the curve or in the path parameter."""
    size = np.abs(cells.middle) + abs(envelope.curve.distance)
    tiny: BoolArray = cells.along <= 4.0 * ROUNDING * size
    tiny |= cells.high - cells.low <= 4.0 * np.spacing(cells.high)
    return tiny


def _refined(
    envelope: Envelope, cells: Cells, first: IntArray, second: IntArray
) -> tuple[Cells, IntArray, IntArray]:
    """The pairs of the halves of each pair whose boxes still meet."""
    if not len(first):
        return cells, first, second
    used, place = np.unique_inverse(np.concatenate((first, second)))
    fine = halved(envelope, cells.some(used))
    one, other = 2 * place[: len(first)], 2 * place[len(first) :]
    one = np.concatenate((one, one, one + 1, one + 1))
    other = np.concatenate((other, other + 1, other, other + 1))
    both = meet(fine.some(one), fine.some(other))
    return fine, one[both], other[both]


def _newton(
    envelope: Envelope, one: Cells, other: Cells
) -> tuple[BoolArray, BoolArray, list[Node]]:
    """The crossings of pairs of cells that cross at most once.

    (k,) True where a pair crosses; (k,) True where both are too nearly parallel for their points to
    decide; and the crossings.
    """
    x, y = 0.5 * (one.low + one.high), 0.5 * (other.low + other.high)
    wide_x, wide_y = one.high - one.low, other.high - other.low
    points = one.middle
    inside = np.ones(len(x), dtype=np.bool_)
    for _ in range(NEWTON):
        at_x, at_y = envelope.samples(x), envelope.samples(y)
        gap = at_y.points - at_x.points
        points = 0.5 * (at_x.points + at_y.points)
        # a_x t_x dx - a_y t_y dy = gap
        sine = (np.conj(at_x.tangents) * at_y.tangents).imag
        if not np.any(inside):  # no place moves any more
            break
        with np.errstate(divide="ignore", invalid="ignore"):
            dx = (np.conj(at_y.tangents) * gap).imag / (-sine * at_x.pace)
            dy = (np.conj(at_x.tangents) * gap).imag / (-sine * at_y.pace)
        inside &= np.isfinite(dx) & np.isfinite(dy)
        x = np.where(inside, x + np.clip(dx, -wide_x, wide_x), x)
        y = np.where(inside, y + np.clip(dy, -wide_y, wide_y), y)
        inside &= _near(x, one, 1.0) & _near(y, other, 1.0)
    size = np.abs(points) + abs(envelope.curve.distance)
    inside &= _near(x, one, OUTSIDE) & _near(y, other, OUTSIDE)
    # Where the pace is large, the rounding of the cam angle counts as well.
    fastest = np.maximum(np.abs(at_x.pace), np.abs(at_y.pace))
    inside &= np.abs(gap) <= 4.0 * ROUNDING * size + PLACE * fastest
    with np.errstate(divide="ignore", invalid="ignore"):
        blur = ROUNDING * size / np.abs(sine)
        clear = blur < OUTSIDE * np.abs(at_x.pace) * wide_x
        clear &= blur < OUTSIDE * np.abs(at_y.pace) * wide_y
    blurred = ~clear & _slim(envelope, one) & _slim(envelope, other)
    inside &= clear
    nodes = []
    for k in np.flatnonzero(inside):
        places = envelope.within(np.array([x[k], y[k]]))
        nodes.append(_node(float(places[0]), float(places[1]), complex(points[k])))
    return inside, blurred, nodes


def _node(one: float, other: float, point: complex, *, touching: bool = False) -> Node:
    return Node(min(one, other), max(one, other), point, touching)


def _near(places: FloatArray, cells: Cells, share: float) -> BoolArray:
    room = share * (cells.high - cells.low)
    near: BoolArray = (places >= cells.low - room) & (places <= cells.high + room)
    return near


def _distinct(nodes: list[Node], total: float) -> tuple[Node, ...]:
    """Each node once; of a crossing and a contact next to it, the crossing."""
    kept: list[Node] = []
    fields = max(1, int(total / TOUCHING))
    near: dict[int, list[Node]] = {}  # the nodes kept, by the fields about both of their places
    for node in sorted(nodes, key=lambda node: (node.touching, node.first, node.second)):
        limit = TOUCHING if node.touching else SAME
        field = int(node.first / TOUCHING)
        if any(_same(node, other, limit, total) for other in near.get(field % fields, ())):
            continue
        kept.append(node)
        about = {
            int(place / TOUCHING) + step
            for place in (node.first, node.second)
            for step in (-1, 0, 1)
        }
        for each in {field % fields for field in about}:
            near.setdefault(each, []).append(node)
    return tuple(sorted(kept, key=lambda node: (node.first, node.second)))


def _same(one: Node, other: Node, limit: float, total: float) -> bool:
    pairs = [(other.first, other.second), (other.second, other.first)]
    apart = np.abs(np.array(pairs) - [one.first, one.second])
    return bool(np.any(np.all(np.minimum(apart, total - apart) < limit, axis=1)))


# -- swallow tail ---------------------------------------------------------------------------------
# Swallow tails: between two cusps the flank runs back and crosses itself once.
#
# At the crossing the displacement from one side to the other, the integral of a exp(i theta),
# vanishes. It is computed by Gauss-Legendre quadrature where the tail is small: the pace a has its
# digits also where the points of the flank differ by less than their own rounding.
#
# That there is one crossing at most is sure of a run of cells about the two cusps in which the
# tangent turns one way, see `camgeo.geometry.outline.envelope`. Where it turns back at the cusps,
# as next to a corner of the pitch curve, a run is known if what runs back is short, of length L:
# along the tangent there, the parts before and after it add up to at most L for a pair of points
# that coincide. So both lie within 1.2 L of the cusps, if the tangent turns by less than half a
# radian there, and by less than a right angle farther out. Of two such pairs one would be inside
# the other, and the two sums of directions between them equal. They are not if the tangents of both
# parts lie in cones apart; nor if both parts of a pair, 1.2 L together, turn by less than the
# tangent turns back between the cusps: going from one pair to the other, the tangent of one part
# would be ahead of that of the other all the way.


REACH = 1.2
"""Length of the parts next to the cusps in which a crossing must lie, as a multiple of what runs
back; more than 1 / cos(0.5)."""

SLIGHT = 0.5
"""Largest angle [rad] by which the tangent turns in these parts."""

SQUARE = 1.5
"""Largest angle [rad] by which it turns in the run: less than a right angle."""

SAMPLES = 33
"""Places at which the tangents of a part are sampled; over so short a part, with few borders, they
turn steadily."""


STEPS = 60
"""Most Newton steps; from the guess six suffice."""

SMALL = 1e-2
"""A tail whose flank is shorter than this fraction of its distance from the axis is small."""

NODES = 12
"""Nodes of a quadrature over each smooth part."""

MOST_BREAKS = 4
"""Most borders inside a tail that is integrated by quadrature, or that short parts are known of."""

SETTLED = 1e-7
"""After a Newton step of this fraction of the tail's width the next one is mere rounding."""

NOISE = 2.0**-52 * 64.0
"""Rounding of the pace, as a fraction of the speed of the roller centre."""


@dataclass(frozen=True, slots=True)
class Run:
    """Consecutive cells in which there is at most one crossing.

    Attributes
    ----------
    first, cells : number of the first cell, and how many there are.
    low, high : path parameters between which the crossing lies, counted so that the cusps between
        them begin in [0, total).
    """

    first: int
    cells: int
    low: float
    high: float


class Line:
    """The cells of a division over three turns, so that none of them is at an end."""

    def __init__(self, division: Division) -> None:
        cells, total = division.cells, division.envelope.total
        self.count = len(cells)
        thrice = joined([cells, cells, cells])
        turns = np.repeat([-total, 0.0, total], self.count)
        self.low, self.high, bend = thrice.low + turns, thrice.high + turns, thrice.bend
        self.negative: BoolArray = np.tile(division.negative, 3)
        self.turn = np.tile(2.0 * cells.turn, 3)
        self.bending = {0.0: bend == bend, 1.0: bend == 1.0, -1.0: bend == -1.0}

    def steady_run(self, start: float, end: float) -> Run | None:
        """The longest run about the range [start, end] in which the tangent turns one way, below
        pi. None if it does not turn one way between the cusps.
        """
        inner = slice(*self._cells_of(start, end))
        for sense in (1.0, -1.0):
            if np.all(self.bending[sense][inner]):
                run = self._grown(inner, STRAIGHT, sense)
                return run if run is not None and run.low < start and end < run.high else None
        return None

    def short_run(self, start: float, end: float) -> Run | None:
        """The run about the range [start, end] that turns by less than a right angle, either way,
        for `small_runs` to look at.
        """
        run = self._grown(slice(*self._cells_of(start, end)), SQUARE, 0.0)
        return run if run is not None and run.low < start and end < run.high else None

    def _cells_of(self, start: float, end: float) -> tuple[int, int]:
        """First cell, and the one after the last, of a range that begins and ends with cells."""
        return int(np.searchsorted(self.low, start)), int(np.searchsorted(self.high, end)) + 1

    def _grown(self, inner: slice, most: float, sense: float) -> Run | None:
        """The run of the cells `inner`, backward ones, with cells added on both sides in turn.

        As long as the pace is positive there, they bend in the `sense`, 0 for any, and all turn by
        less than `most` [rad]. None if there are none, or they turn by more.
        """
        left, right = inner.start, inner.stop - 1
        turned = float(np.sum(self.turn[inner]))
        if turned >= most or right < left or not np.all(self.negative[inner]):
            return None
        fit, is_open = self.bending[sense], [True, True]
        while any(is_open):
            for side in (0, 1):
                k = right + 1 if side else left - 1
                is_open[side] &= bool(
                    fit[k]
                    and not self.negative[k]
                    and turned + self.turn[k] < most
                    and right - left + 1 < self.count
                )
                if is_open[side]:
                    turned += float(self.turn[k])
                    left, right = (left, k) if side else (k, right)
        cells = right - left + 1
        return Run(left % self.count, cells, float(self.low[left]), float(self.high[right]))


def small_runs(
    envelope: Envelope, runs: Sequence[Run], start: FloatArray, end: FloatArray
) -> list[Run | None]:
    """The `runs` about short ranges [start, end] (m,), cut to where a crossing must lie; None for
    those that may hold more than one, see above.
    """
    half, shares = 0.5 * (end - start), (np.arange(SAMPLES) + 0.5) / SAMPLES
    within = _samples(envelope, start[:, None] + (end - start)[:, None] * shares)
    length = 2.0 * half * np.max(np.abs(within.pace), axis=1)
    sure = np.ones(len(runs), dtype=np.bool_)
    reaches, tangents, rates = [], [], []
    for cusp, limit in ((start, [run.low for run in runs]), (end, [run.high for run in runs])):
        away, room = np.sign(limit - cusp), np.abs(limit - cusp)
        pace = envelope.samples(cusp + 1e-3 * away * half).pace
        reach = cusp + away * np.minimum(REACH * length / np.maximum(pace, 1e-300), room)
        way = reach - cusp
        along = _samples(
            envelope, cusp[:, None] + way[:, None] * np.linspace(0.0, 1.0, SAMPLES)[1:]
        )
        sure &= np.mean(along.pace, axis=1) * np.abs(way) >= length
        sure &= np.min(along.pace, axis=1) > 0.0
        steps = np.abs(np.angle(along.tangents[:, 1:] * np.conj(along.tangents[:, :-1])))
        with np.errstate(divide="ignore", invalid="ignore"):  # where the pace is not above 0
            fastest = np.max(steps / along.pace[:, 1:], axis=1) * SAMPLES / np.abs(way)
        reaches.append(reach)
        tangents.append(along.tangents)
        rates.append(fastest)
    before, after = (np.angle(each * np.conj(tangents[0][:, :1])) for each in tangents)
    apart = np.max(before, axis=1) < np.min(after, axis=1)
    apart |= np.max(after, axis=1) < np.min(before, axis=1)
    first, last = _samples(envelope, np.stack((start, end))).tangents
    apart |= np.maximum(*rates) * REACH * length < np.abs(np.angle(last * np.conj(first)))
    sure &= apart & (np.max(np.abs(np.hstack((before, after))), axis=1) < SLIGHT)
    inside = np.searchsorted(_borders(envelope), reaches)
    sure &= inside[1] - inside[0] <= MOST_BREAKS
    return [
        replace(run, low=float(low), high=float(high)) if one else None
        for run, low, high, one in zip(runs, *reaches, sure, strict=True)
    ]


def _samples(envelope: Envelope, places: FloatArray) -> EnvelopeSamples:
    """The envelope at `places` of any shape."""
    samples = envelope.samples(places.ravel())
    return EnvelopeSamples(
        samples.points.reshape(places.shape),
        samples.tangents.reshape(places.shape),
        samples.pace.reshape(places.shape),
    )


@dataclass(frozen=True, slots=True)
class SwallowTail:
    """The one crossing of a run of cells with two cusps.

    Attributes
    ----------
    first, second : path parameters in [0, total) of the crossing, before and after the cusps.
    point : its place [mm].
    start, cells : the run in which there is no other: its first cell and their number.
    """

    first: float
    second: float
    point: complex
    start: int
    cells: int


def swallow_tails(
    division: Division, backward: list[tuple[float, float]]
) -> tuple[SwallowTail, ...]:
    """The tails of the ranges `backward` that cross within a short run of cells."""
    envelope, line = division.envelope, Line(division)
    spans = [span for span in backward if span[1] - span[0] < envelope.total]
    runs = [line.steady_run(*span) for span in spans]
    short = {k: line.short_run(*span) for k, span in enumerate(spans) if runs[k] is None}
    looked_at = {k: run for k, run in short.items() if run is not None}
    if looked_at:
        start, end = np.array([spans[k] for k in looked_at]).T
        small = small_runs(envelope, tuple(looked_at.values()), start, end)
        for k, run in zip(looked_at, small, strict=True):
            runs[k] = run
    known = [(span, run) for span, run in zip(spans, runs, strict=True) if run is not None]
    return _tails(envelope, known) if known else ()


def _tails(
    envelope: Envelope, known: list[tuple[tuple[float, float], Run]]
) -> tuple[SwallowTail, ...]:
    """The crossings of the runs about ranges, all by Newton's method at once."""
    start, end, low, high = np.array([(*span, run.low, run.high) for span, run in known]).T
    middle, half = 0.5 * (start + end), 0.5 * (end - start)
    # Of a pace that is a parabola between the cusps the crossing lies root 3 times as far out.
    x = np.maximum(middle - np.sqrt(3.0) * half, 0.5 * (low + start))
    y = np.minimum(middle + np.sqrt(3.0) * half, 0.5 * (end + high))
    speed = np.abs(envelope.curve.pitch.jet(envelope.angles_at(start))[1])
    settled = np.zeros(len(x), dtype=np.bool_)
    found = settled.copy()
    k = np.arange(len(x))  # those still iterated
    for _ in range(STEPS):
        ends = _samples(envelope, np.stack((x[k], y[k])))
        gap = _ways(envelope, x[k], y[k], ends)
        (t_x, t_y), (a_x, a_y) = ends.tangents, ends.pace
        sine = _across(t_x, t_y)
        forward = (sine != 0.0) & (a_x > 0.0) & (a_y > 0.0)
        k, gap, sine, t_x, t_y, a_x, a_y = (
            part[forward] for part in (k, gap, sine, t_x, t_y, a_x, a_y)
        )
        if not len(k):
            break
        dx, dy = _across(t_y, gap) / (-sine * a_x), _across(t_x, gap) / (-sine * a_y)
        # Stay on the same side of the cusps, and inside the run.
        room = np.minimum(_room(x[k], dx, low[k], start[k]), _room(y[k], dy, end[k], high[k]))
        share = np.minimum(1.0, room)
        x[k], y[k] = x[k] + share * dx, y[k] + share * dy
        found[k] = settled[k]
        # The pace is a difference of speeds; of a tiny tail it has few digits left.
        noise = NOISE * speed[k] / np.minimum(a_x, a_y)
        least = (SETTLED + noise) * (y[k] - x[k]) + 8.0 * np.spacing(y[k])
        settled[k] = np.abs(dx) + np.abs(dy) <= least
        k = k[~found[k]]
    found &= (low <= x) & (x < start) & (end < y) & (y <= high)
    chosen = np.flatnonzero(found)
    places = envelope.within(np.stack((x[chosen], y[chosen])))
    points = np.mean(_samples(envelope, places).points, axis=0)
    return tuple(
        SwallowTail(first, second, complex(point), known[k][1].first, known[k][1].cells)
        for k, (first, second), point in zip(
            chosen, places.T.tolist(), points.tolist(), strict=True
        )
    )


def _borders(envelope: Envelope) -> FloatArray:
    """(k,) path parameters of the borders in three turns, ascending."""
    turns = envelope.total * np.array([[-1.0], [0.0], [1.0]])
    return np.sort((envelope.borders + turns), axis=None)


def _across(one: ComplexArray, other: ComplexArray) -> FloatArray:
    """(n,) the part of `other` (n,) to the left of the unit vectors `one` (n,)."""
    return one.real * other.imag - one.imag * other.real


def _room(place: FloatArray, step: FloatArray, low: FloatArray, high: FloatArray) -> FloatArray:
    """Fraction of `step` that stays short of the end it goes towards."""
    room = 0.9 * np.where(step > 0.0, high - place, place - low)
    size = np.abs(step)
    return np.divide(room, size, out=np.ones_like(size), where=size > room)


def _ways(envelope: Envelope, x: FloatArray, y: FloatArray, ends: EnvelopeSamples) -> ComplexArray:
    """(n,) from the envelope at x (n,) to that at y (n,), `ends` (2, n)."""
    way: ComplexArray = ends.points[1] - ends.points[0]
    size = np.max(np.abs(ends.points), axis=0) + abs(envelope.curve.distance)
    small = np.sum(np.abs(ends.pace), axis=0) * (y - x) <= SMALL * size
    breaks = _borders(envelope)
    first = np.searchsorted(breaks, x, side="right")
    count = np.searchsorted(breaks, y) - first
    for inside in range(MOST_BREAKS + 1):
        k = np.flatnonzero(small & (count == inside))
        if len(k):
            inner = breaks[first[k, None] + np.arange(inside)]
            marks = np.column_stack((x[k], inner, y[k]))
            places, half, weights = gauss(marks[:, :-1].ravel(), marks[:, 1:].ravel(), NODES)
            samples = _samples(envelope, places.reshape(len(k), -1))
            parts = (half[:, None] * weights).reshape(len(k), -1) * samples.pace * samples.tangents
            way[k] = np.sum(parts, axis=1)
    return way
