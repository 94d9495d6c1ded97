"""The crossings of a flank with itself, all of them: boxes exclude, halving decides, Newton
refines.

See `camgeo.outline.division` for what is proved of neighbouring cells. Cells that lie apart are
excluded by their boxes or halved; where the tangents of two cells provably differ they cross at
most once, and Newton's method finds whether they do. So does `camgeo.outline.swallow_tail` for the
one crossing of a swallow tail, far below the size at which points of the flank are distinct.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from camgeo.curve.extremes import Extremes
from camgeo.curve.working_curve import WorkingCurve
from camgeo.errors import GeometryError
from camgeo.numeric.arrays import BoolArray, FloatArray, IntArray
from camgeo.outline.cells import PLACE, ROUNDING, Cells, cross_once, halved, meet, overlapping
from camgeo.outline.cusps import backward_ranges
from camgeo.outline.division import Division, divide
from camgeo.outline.envelope import Envelope, envelope_of

if TYPE_CHECKING:
    from camgeo.outline.swallow_tail import SwallowTail

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


def crosses_itself(curve: WorkingCurve) -> bool:
    """Whether the parallel `curve` has crossings with itself: the search ends with the first.

    Raises
    ------
    GeometryError
        If none was found before a question that cannot be decided.
    """
    envelope = envelope_of(curve)
    nodes = find_nodes(envelope, backward_ranges(envelope), first_only=True)
    return any(not node.touching for node in nodes)


def find_nodes(
    envelope: Envelope, backward: list[tuple[float, float]], *, first_only: bool = False
) -> tuple[Node, ...]:
    """All crossings and contacts of `envelope`, given the ranges in which it runs backwards; or if
    `first_only` what is found up to the first crossing.
    """
    ends = np.array([place for span in backward for place in span])
    division = divide(envelope, envelope.within(ends) if len(ends) else ends)
    tails: tuple[SwallowTail, ...] = ()
    if backward:
        from camgeo.outline.swallow_tail import swallow_tails  # few cams have such tails

        tails = swallow_tails(division, backward)
    pairs = _apart(division, tails)
    nodes = [_node(tail.first, tail.second, tail.point) for tail in tails]
    if not (first_only and nodes):
        nodes += _decide(envelope, division.cells, pairs, first_only=first_only)
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


def _decide(
    envelope: Envelope, cells: Cells, pairs: tuple[IntArray, IntArray], *, first_only: bool
) -> list[Node]:
    """Halve until each pair is apart, crosses once, or is too small to be halved; or if
    `first_only` until one crosses.
    """
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
            if first_only and nodes:
                return found
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
