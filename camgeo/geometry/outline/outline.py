"""The real outline: the part of a flank that the roller, as a cutter, does not remove.

The roller represents the cutter. Where the flank crosses itself, the outline continues along the
branch that the other one does not cover; parts that run backwards, or that the roller covers
elsewhere, are dropped. So the outline consists of stretches of the working curve itself with exact
corners between them.

Only crossings of the flank with itself matter, and not those with the other flank: a pitch curve
that does not cross itself has an inside and an outside, and no point is inside of one part and
outside of another unless a third part runs between, whose roller covers it.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from typing import Any, Final, Self

import numpy as np

from camgeo.errors import GeometryError, UndercutError
from camgeo.geometry.outline.envelope import (
    Envelope,
    Node,
    divide,
    find_nodes,
    halved,
    unresolved_error,
)
from camgeo.geometry.outline.envelope import FlankCells as FlankCells
from camgeo.geometry.outline.path import Element, Path, Pivot, Stretch, whole
from camgeo.geometry.pieces import (
    SMALLEST,
    Convexity,
    Extremes,
    convexity,
    curvature_extremes,
    halves,
    nearest_to_axis,
    rigid_centres,
    stays_on_one_side,
    surely_clear_of_axis,
    touch,
    turn_cells,
)
from camgeo.geometry.pitch_curve import PitchCurve, WorkingCurve
from camgeo.kinematics.mechanism.flat import flat_follower
from camgeo.numeric.arrays import (
    BoolArray,
    ComplexArray,
    FloatArray,
    IntArray,
    ascending,
    frozen,
    grouped,
)
from camgeo.numeric.extremes import bracketed_roots, roots_on_grid
from camgeo.numeric.kept import kept_with_owner
from camgeo.numeric.quadrature import gauss
from camgeo.record import Brief
from camgeo.units import TURN

ROUND = 1024
"""Places of the envelope at which its winding number is taken, at least eight per part."""

NEIGHBOURHOOD = 1.0
"""Turn of the tangent [rad] up to which neighbours of a point provably do not cover it, by bounds
over cells; more than twice `camgeo.geometry.outline.envelope.STEEPEST`."""


@dataclass(frozen=True, slots=True)
class Outline(Brief):
    """The remaining part of a flank.

    Attributes
    ----------
    path : the boundary of the disc, or of the hole of an outer flank, once round the cam axis.
    lobes : boundaries of the parts that are cut off and fall away.
    dropped : ranges (start, end) of cam angle [rad] whose stretch of the flank is not on `path`,
        start in [0, 2 pi), end above it by less than a turn.
    """

    path: Path
    lobes: tuple[Path, ...]
    dropped: tuple[tuple[float, float], ...]

    @property
    def is_trimmed(self) -> bool:
        """Whether the follower does not make all of its motion."""
        return bool(self.dropped)


@dataclass(frozen=True, slots=True)
class _EnvelopePart:
    """The envelope from one crossing to the next, path parameters start < end."""

    start: float
    end: float
    from_node: int
    to_node: int


@kept_with_owner
def flank_envelope(curve: WorkingCurve) -> Envelope:
    """The envelope at the distance of `curve`."""
    return Envelope(curve)


def real_outline(flank: WorkingCurve, bends: Extremes | None = None) -> Outline:
    """The real outline of `flank`, the working curve at d = -r_R (inner) or +r_R (outer).

    `bends` are the extremes of the pitch curve's curvature, if they are known.

    Raises
    ------
    UndercutError
        If nothing remains of the disc: the roller reaches over the cam axis, or covers everything.
        Or if a flat face turns back in the cam, or its contact jumps.
    GeometryError
        If the roller centre stands still in the cam (Z' = 0), or it cannot be decided what remains.
    """
    if not flank.pitch.follower.has_pitch_curve:
        return _convex_outline(flank)
    require_room(flank)
    envelope = flank_envelope(flank)
    backward = backward_ranges(envelope, bends)
    nodes = tuple(n for n in find_nodes(envelope, backward) if not n.touching)
    if not nodes:
        if backward and backward != [(0.0, envelope.total)]:
            raise GeometryError(
                "the flank runs back at cam angle"
                f" {_undecided_angle(envelope, backward, nodes):.6f} deg, where it does not cross"
                " itself by more than rounding: it cannot be decided what is left of it"
            )
        if backward:
            raise UndercutError(
                "the roller is larger than the pitch curve allows all round: nothing is left of"
                " the disc"
            )
        return Outline(Path(envelope.elements), (), ())
    parts = _parts(envelope, nodes)
    loops = _loops(nodes, _boundary_parts(envelope, nodes, backward, parts))
    paths = [_path(envelope, nodes, loop) for loop in loops]
    windings = [_winding(envelope, loop) for loop in loops]
    main = [k for k, winding in enumerate(windings) if winding != 0]
    if len(main) != 1:
        # Where the axis is free, there is a disc about it, and the rest lies around all rollers.
        raise GeometryError(
            "it cannot be decided what is left of the flank: its sides touch to rounding"
            f" at cam angle {_undecided_angle(envelope, backward, nodes):.6f} deg"
        )
    lobes = tuple(path for k, path in enumerate(paths) if k != main[0])
    return Outline(paths[main[0]], lobes, _dropped_ranges(paths[main[0]]))


def _undecided_angle(
    envelope: Envelope, backward: list[tuple[float, float]], nodes: tuple[Node, ...]
) -> float:
    """Cam angle [deg] in the middle of the first range in which the flank runs back and which no
    crossing cuts off; if there is none, of the first crossing.
    """
    total = envelope.total
    spans = [(node.first, node.second) for node in nodes]
    cut = [(a, b) if b - a < 0.5 * total else (b, a + total) for a, b in spans]
    places = [
        0.5 * (start + end)
        for start, end in backward
        if not any(
            a + k * total <= start and end <= b + k * total for a, b in cut for k in (-1, 0, 1)
        )
    ]
    place = envelope.wrapped(np.array([*places, *(first for first, _ in spans)][:1]))
    return math.degrees(envelope.cam_angles(place)[0])


def _convex_outline(flank: WorkingCurve) -> Outline:
    """The whole contact curve of a flat face, or what remains of it where it undercuts.

    `camgeo.geometry.pieces` shows why the whole one does not cross itself.
    """
    shape = convexity(flank.pitch)
    if shape.is_convex:
        return Outline(whole(flank), (), ())

    path = trimmed_path(flank, shape)
    return Outline(path, (), _dropped_ranges(path))


def require_room(flank: WorkingCurve) -> None:
    """Raise UndercutError if the roller reaches over the cam axis, GeometryError if it would run
    through its own flank: trimming helps neither.
    """
    inside = flank.distance <= 0.0
    if inside and not surely_clear_of_axis(flank.pitch, -flank.distance):
        _require_axis(flank)
    _require_simple(flank.pitch)


def _require_axis(flank: WorkingCurve) -> None:
    """Raise UndercutError if the roller reaches over the cam axis."""
    nearest, phi = nearest_to_axis(flank.pitch)
    if nearest <= -flank.distance:
        raise UndercutError(
            f"the roller reaches over the cam axis at cam angle {math.degrees(phi):.6g} deg"
            f" (its centre comes as near as {nearest:.6g} mm): no disc is left"
        )


def _require_simple(pitch: PitchCurve) -> None:
    """Raise GeometryError if the pitch curve crosses itself.

    It cannot if the follower stays on one side of the cam axis: then lift and distance of the
    roller centre from the axis correspond one to one, and so do cam angle and direction.
    """
    if stays_on_one_side(pitch):
        return
    crossings = find_crossings(WorkingCurve(pitch, 0.0))
    if crossings:
        angles = [math.degrees(angle) for angle in (crossings[0].first, crossings[0].second)]
        raise GeometryError(
            f"the pitch curve crosses itself at cam angles {angles[0]:.6f} and {angles[1]:.6f} deg:"
            " the roller would run through the flank that is to guide it"
        )


def _parts(envelope: Envelope, nodes: tuple[Node, ...]) -> list[_EnvelopePart]:
    """The parts of the envelope from each crossing to the next, once round."""
    events = sorted(
        (place, k) for k, node in enumerate(nodes) for place in (node.first, node.second)
    )
    following = [*events[1:], (events[0][0] + envelope.total, events[0][1])]
    return [
        _EnvelopePart(start, end, k, other)
        for (start, k), (end, other) in zip(events, following, strict=True)
    ]


def _boundary_parts(
    envelope: Envelope,
    nodes: tuple[Node, ...],
    backward: list[tuple[float, float]],
    parts: list[_EnvelopePart],
) -> list[_EnvelopePart]:
    """The parts on the boundary: regular, on the free side at their ends, and clear."""
    start, end = np.array([(part.start, part.end) for part in parts]).T
    ranges = np.array(backward).reshape(-1, 2)
    turns = np.repeat([-envelope.total, 0.0, envelope.total], len(ranges))
    # Over three turns, so that each part meets its ranges; the infinite one ends every search.
    low, high = np.append(np.tile(ranges, (3, 1)) + turns[:, None], [[np.inf, np.inf]], axis=0).T
    regular = low[np.searchsorted(high, start, side="right")] >= end
    # A part may reach beyond the turn by which path parameters are counted.
    arriving = np.where(end >= envelope.total, end - envelope.total, end)
    sides = [
        _branch_sides(envelope, [nodes[number] for number in numbers], places, low, high)
        for numbers, places in (
            ([part.from_node for part in parts], start),
            ([part.to_node for part in parts], arriving),
        )
    ]
    free = [parts[k] for k in np.flatnonzero(regular & (sides[0] <= 0.0) & (sides[1] >= 0.0))]
    if not free:
        return []
    middles = np.array([0.5 * (part.start + part.end) for part in free])
    points = envelope.samples(middles).points
    owns = _own_ranges(envelope, free, middles)
    clear = are_clear(envelope.curve.pitch, points, abs(envelope.curve.distance), owns)
    return [part for part, is_clear in zip(free, clear, strict=True) if is_clear]


def _branch_sides(
    envelope: Envelope, nodes: list[Node], places: FloatArray, low: FloatArray, high: FloatArray
) -> FloatArray:
    """(n,) positive where the branch at `places` (n,) of the `nodes` enters the part that the other
    one removes, else negative.

    NaN where the other branch runs backwards there, in one of the ranges from `low` to `high` over
    three turns: its roller covers the crossing itself.
    """
    first, second = np.array([(node.first, node.second) for node in nodes]).T
    other = np.where(np.abs(places - first) <= np.abs(places - second), second, first)
    behind = low[np.searchsorted(high, other, side="right")] < other
    branch_tangents, crossed = (
        envelope.samples(parameters).tangents for parameters in (places, other)
    )
    # The roller centre lies at -d n from the flank, with the outward normal n = i sigma t.
    sense = -math.copysign(1.0, envelope.curve.distance) * envelope.curve.pitch.rotation
    towards_roller = sense * 1j * crossed
    return np.where(behind, np.nan, (np.conj(towards_roller) * branch_tangents).real)


def _own_ranges(envelope: Envelope, parts: list[_EnvelopePart], middles: FloatArray) -> FloatArray:
    """(n, 2) cam angles about `middles` (n,) along which the tangent provably turns little, inside
    each of the `parts`; the second above the first.
    """
    cells, total = divide(envelope, np.empty(0)).cells, envelope.total
    turns = np.repeat([0.0, total, 2.0 * total], len(cells))
    low, high = np.tile(cells.low, 3) + turns, np.tile(cells.high, 3) + turns
    turned = np.concatenate(([0.0], np.cumsum(np.tile(2.0 * cells.turn, 3))))
    shift = envelope.wrapped(middles) + total - middles  # into the second of three turns
    cell = np.searchsorted(low, middles + shift, side="right") - 1
    # A cell turns by less than that, so that its own is among them.
    first = np.searchsorted(turned, turned[cell + 1] - NEIGHBOURHOOD, side="right")
    last = np.searchsorted(turned, turned[cell] + NEIGHBOURHOOD) - 2
    starts, ends = np.array([(part.start, part.end) for part in parts]).T
    ranges = np.maximum(low[first] - shift, starts), np.minimum(high[last] - shift, ends)
    owns = envelope.cam_angles(envelope.wrapped(np.column_stack(ranges)))
    owns[:, 1] += np.where(owns[:, 1] >= owns[:, 0], 0.0, TURN)
    return owns


CLEAR_HALVINGS = 50
"""Most rounds of halving for `are_clear`."""

CLOSE = 1e-9
"""A point closer than the roller's radius by this fraction of it is covered; one within this
fraction of the radius is touched."""


def are_clear(
    pitch: PitchCurve, points: ComplexArray, radius: float, owns: FloatArray
) -> BoolArray:
    """(n,) True for those of `points` (n,) that no roller of `radius` [mm] on the pitch curve
    covers.

    This is proved: a cell of cam angle that cannot decide it is halved.

    Parameters
    ----------
    owns : (n, 2) cam angles [rad] for each point, start in [0, 2 pi) and end above it, that are not
        examined: the point is touched there, and its neighbours are known to be regular.
    """
    cover_radius = (1.0 - CLOSE) * radius
    clear = np.ones(len(points), dtype=np.bool_)
    low, high = turn_cells(pitch)
    wide = high - low
    centres, reach = pitch.point(0.5 * (low + high)), _Reach.from_cells(pitch, low, high)
    owners, lows, highs = [], [], []
    for k, (start, end) in enumerate(owns.tolist()):
        # Cells are counted from the start of the point's own angles on.
        ahead, span = (low - start) % TURN, end - start
        whole = (ahead >= span) & (ahead + wide <= TURN)
        distance = np.abs(centres[whole] - points[k])
        clear[k] = not np.any(distance < cover_radius)
        near = distance - reach.distance_changes(points[k])[whole] < cover_radius
        nearer = halves(low[whole], high[whole], near)
        # Of the cells in which its own angles begin or end, the part outside of these.
        cut = np.flatnonzero(~whole & (ahead + wide > span))
        both = cut[ahead[cut] + wide[cut] - TURN > span]
        ends = np.full(len(both), end % TURN)
        left = np.where(ahead[cut] >= span, low[cut], end % TURN)
        right = np.where(ahead[cut] + wide[cut] <= TURN, high[cut], start)
        lows.append(np.concatenate((nearer[0], left, ends)))
        highs.append(np.concatenate((nearer[1], right, high[both])))
        owners.append(np.full(len(lows[-1]), k))
    owner, low, high = (np.concatenate(parts) for parts in (owners, lows, highs))
    for _ in range(CLEAR_HALVINGS):
        wanted = clear[owner]
        owner, low, high = owner[wanted], low[wanted], high[wanted]
        if not len(owner):
            break
        distance = np.abs(pitch.point(0.5 * (low + high)) - points[owner])
        clear[owner[distance < cover_radius]] = False
        near = (
            distance - _Reach.from_cells(pitch, low, high).distance_changes(points[owner])
            < cover_radius
        )
        owner = np.tile(owner[near], 2)
        low, high = halves(low, high, near)
    return clear  # or touched, to rounding


@dataclass(frozen=True, slots=True, eq=False)
class _Reach:
    """How far the roller centre goes in n cells from its place in the middle of each.

    Attributes
    ----------
    half : (n,) half the cells [rad].
    pace : (n,) bound of |Z'| [mm/rad].
    centres : (n,) complex [mm] the point about which it turns with the cam; NaN where it does not.
    """

    half: FloatArray
    pace: FloatArray
    centres: ComplexArray

    @classmethod
    def from_cells(cls, pitch: PitchCurve, low: FloatArray, high: FloatArray) -> Self:
        """The reach over the cells [low, high] (n,) [rad]."""
        centres = rigid_centres(pitch, 0.5 * (low + high))
        return cls(0.5 * (high - low), pitch.speed_bounds(low, high)[0], centres)

    def distance_changes(self, points: ComplexArray | complex) -> FloatArray:
        """(n,) bound [mm] of how far the roller centre's distance from `points` (n,), or from one
        point, changes in a cell.

        Where the centre turns about a point, it is as if `points` turned about that one.
        """
        return np.asarray(self.half * np.fmin(self.pace, np.abs(points - self.centres)))


def _loops(nodes: tuple[Node, ...], parts: list[_EnvelopePart]) -> list[list[_EnvelopePart]]:
    """The kept parts linked at their crossings: each continues along the other branch."""
    following: dict[int, list[_EnvelopePart]] = {}
    for part in parts:
        following.setdefault(part.from_node, []).append(part)
    loops: list[list[_EnvelopePart]] = []
    for first in parts:
        if first not in following.get(first.from_node, ()):
            continue
        following[first.from_node].remove(first)
        # A loop is closed by continuing along the other branch at each crossing.
        loop = [first]
        while loop[-1].to_node != first.from_node:
            ways = following.pop(loop[-1].to_node, [])
            if len(ways) != 1:
                raise GeometryError(
                    "it cannot be decided what is left of the flank: more than two branches meet"
                    f" at {nodes[loop[-1].to_node].point:.6g} mm"
                )
            loop += ways
        loops.append(loop)
    return loops


def _path(envelope: Envelope, nodes: tuple[Node, ...], loop: list[_EnvelopePart]) -> Path:
    """The closed path of a loop of parts, with a corner at each crossing."""
    elements: list[Element] = []
    rotation = envelope.curve.pitch.rotation
    meeting = zip(loop, [*loop[1:], loop[0]], strict=True)
    places = envelope.wrapped(np.array([(part.end, other.start) for part, other in meeting]))
    tangents = envelope.samples(places.ravel()).tangents.reshape(places.shape)
    angles = envelope.cam_angles(places).tolist()
    for part, (one, other), (phi_start, phi_end) in zip(loop, tangents, angles, strict=True):
        elements += _elements(envelope, part)
        # At a crossing the path turns from the tangent of one branch to that of the other.
        sweep = float(np.angle(other * np.conj(one)))
        normal = 1j * rotation * complex(one)
        elements.append(Pivot(nodes[part.to_node].point, 0.0, normal, sweep, phi_start, phi_end))
    return Path(tuple(elements))


def _elements(envelope: Envelope, part: _EnvelopePart) -> list[Element]:
    """The elements of a part: stretches and turns, cut at its ends."""
    elements: list[Element] = []
    curve = envelope.curve
    if len(envelope.elements) == 1:
        return [Stretch(curve, part.start, part.end)]
    # Twice round, as a part may reach across the end of the turn.
    for turn in (0.0, envelope.total):
        for start, element in zip(envelope.starts + turn, envelope.elements, strict=True):
            span = abs(element.sweep) if isinstance(element, Pivot) else element.end - element.start
            low, high = max(part.start, start), min(part.end, start + span)
            if high <= low:
                continue
            if isinstance(element, Stretch):
                first = element.start + float(low - start)
                last = element.end if high == start + span else element.start + float(high - start)
                shift = TURN if first >= TURN else 0.0
                elements.append(Stretch(curve, first - shift, last - shift))
            else:
                sense = math.copysign(1.0, element.sweep)
                normal = element.normal * complex(np.exp(1j * sense * (low - start)))
                sweep = sense * float(high - low)
                elements.append(
                    Pivot(
                        element.centre,
                        element.distance,
                        normal,
                        sweep,
                        element.phi_start,
                        element.phi_end,
                    )
                )
    return elements


def _winding(envelope: Envelope, loop: list[_EnvelopePart]) -> int:
    """Winding number of a loop about the cam axis."""
    shares = [max(ROUND * (part.end - part.start) / envelope.total, 8.0) for part in loop]
    places = np.concatenate(
        [
            np.linspace(part.start, part.end, math.ceil(share) + 1)[:-1]
            for part, share in zip(loop, shares, strict=True)
        ]
    )
    points = envelope.samples(places).points
    return round(float(np.sum(np.angle(np.roll(points, -1) * np.conj(points)))) / TURN)


def _dropped_ranges(path: Path) -> tuple[tuple[float, float], ...]:
    """Ranges of cam angle between the stretches of the disc."""
    corners = [pivot for pivot in path.pivots if pivot.distance == 0.0]
    return tuple(
        sorted(
            (p.phi_start % TURN, p.phi_start % TURN + (p.phi_end - p.phi_start) % TURN)
            for p in corners
        )
    )


# -- undercut -------------------------------------------------------------------------------------
# Undercut of a flank: cusps, and the ranges between them in which the envelope runs backwards; and
# where it crosses itself.
#
# One scalar decides: 1 + d kappa of the parallel at d, or the pace that has its sign. Between
# neighbouring extremes of the curvature it is monotone, so that no range is missed, however narrow.
#
# No undercut is missed, because the known extremes are checked against enclosures of the pace. They
# are found where the slope of the curvature changes its sign from one sample to the next; two
# changes between neighbouring samples would be missed. Over a cell whose pace provably keeps its
# sign there is no cusp. Undecided cells are halved, and where the pace has another sign than the
# known extremes imply, the extremes there are added; then all cells are looked at once more.


CUSP = 1e-12
"""1 + d kappa within this of zero is a cusp: twenty times the rounding of the curvature."""

INSIDE = 1e-13
"""A cam angle this far from a break [rad] is not taken for the break itself; 6e-12 degrees."""


def undercut_ranges(flank: WorkingCurve, bends: Extremes) -> list[tuple[float, float]]:
    """Ranges of cam angle (start, end) [rad] with 1 + d kappa < 0, ends in [0, 2 pi).

    `bends` are the extremes of the pitch curve's curvature. The whole turn is (0, 2 pi).
    """
    phi = np.append(bends.phi, bends.phi[0] + TURN)
    values = 1.0 + flank.distance * np.append(bends.values, bends.values[0])
    if np.all(values < 0.0):
        return [(0.0, TURN)]
    crossing = (values[:-1] < 0.0) != (values[1:] < 0.0)
    # Two entries at one cam angle are the two sides of a break: a jump, not a root.
    jump = crossing & (phi[1:] == phi[:-1])
    smooth = np.flatnonzero(crossing & ~jump)
    angles = np.where(jump, phi[:-1], 0.0)
    angles[smooth] = _crossings(flank, phi[smooth], phi[smooth + 1])
    places = np.flatnonzero(crossing)
    marks = [(float(angles[k]), bool(values[k + 1] < 0.0)) for k in places]
    # A first mark that ends a range belongs to one that began before it, at the last mark.
    if marks and not marks[0][1]:
        marks = [*marks[1:], marks[0]]
    starts = [angle for angle, begins in marks if begins]
    ends = [angle for angle, begins in marks if not begins]
    return [(start % TURN, end % TURN) for start, end in zip(starts, ends, strict=True)]


def _crossings(flank: WorkingCurve, low: FloatArray, high: FloatArray) -> FloatArray:
    """Where 1 + d kappa passes zero in each smooth stretch [low, high] (n,) [rad].

    Its ends may be breaks, at which the value from the other side does not count here.
    """
    # At a break itself the value of the other side would count.
    low, high = low + INSIDE, high - INSIDE
    at_low, at_high = flank.regularity(low), flank.regularity(high)
    # Without a change of sign the root is lost in rounding next to an end.
    roots = np.where(np.abs(at_low) < np.abs(at_high), low, high)
    crossing = np.flatnonzero((at_low < 0.0) != (at_high < 0.0))
    roots[crossing] = bracketed_roots(flank.regularity, low[crossing], high[crossing])
    return roots


def backward_ranges(envelope: Envelope, bends: Extremes | None = None) -> list[tuple[float, float]]:
    """Ranges of the path parameter (start, end) in which the envelope runs backwards.

    start in [0, total), end above start, possibly beyond the total. A curvature that only touches
    its limit, to rounding, makes no range. The whole turn is (0, total).
    """
    flank = envelope.curve
    ranges = deep_ranges(flank, curvature_extremes(flank.pitch) if bends is None else bends)
    if ranges == [(0.0, TURN)]:
        return [(0.0, envelope.total)]
    backward = [
        (envelope.path_parameter(start), envelope.path_parameter(end, "left"))
        for start, end in ranges
    ]
    rotation = flank.pitch.rotation
    for start, element in zip(envelope.starts, envelope.elements, strict=True):
        # Such an arc is traversed against its tangent, as its pace is -sigma d times the sense of
        # its sweep.
        if isinstance(element, Pivot) and rotation * element.distance * element.sweep > 0.0:
            backward.append((float(start), float(start) + abs(element.sweep)))
    return _merge_ranges(backward, envelope.total)


def deep_ranges(flank: WorkingCurve, bends: Extremes) -> list[tuple[float, float]]:
    """As `undercut_ranges`, without those in which the curvature only touches its limit, to
    rounding.
    """
    margins = 1.0 + flank.distance * bends.values
    if np.min(margins) >= -CUSP:
        return []
    ranges = undercut_ranges(flank, bends)
    if ranges == [(0.0, TURN)]:
        return ranges
    least = _least_margins(bends.phi, margins, ranges)
    return [span for span, value in zip(ranges, least, strict=True) if value < -CUSP]


def _least_margins(
    phi: FloatArray, margins: FloatArray, ranges: list[tuple[float, float]]
) -> FloatArray:
    """(k,) smallest of the `margins` (n,) at `phi` (n,) [rad] in each range of cam angle."""
    start, end = np.array(ranges).T
    order = np.argsort(np.mod(phi, TURN), kind="stable")
    turn = np.mod(phi, TURN)[order]
    angles = np.concatenate((turn - TURN, turn, turn + TURN))
    values = np.append(np.tile(margins[order], 3), np.inf)
    first = np.searchsorted(angles, start - INSIDE)
    last = np.searchsorted(angles, start + (end - start) % TURN + INSIDE, side="right")
    # `reduceat` gives the ranges and what lies between them in turn: every other one is a range.
    return np.minimum.reduceat(values, np.column_stack((first, last)).ravel())[::2]


def _merge_ranges(ranges: list[tuple[float, float]], total: float) -> list[tuple[float, float]]:
    """Ranges that meet are merged, in order; those of a whole turn need no merging."""
    ordered = sorted((start, end if end > start else end + total) for start, end in ranges)
    joined: list[tuple[float, float]] = []
    for start, end in ordered:
        if joined and start <= joined[-1][1] + INSIDE:
            joined[-1] = (joined[-1][0], max(end, joined[-1][1]))
        else:
            joined.append((start, end))
    # The last range may reach into the first one, a turn later.
    if len(joined) > 1 and joined[-1][1] >= total + joined[0][0] - INSIDE:
        first = joined.pop(0)
        joined[-1] = (joined[-1][0], max(joined[-1][1], first[1] + total))
    return joined


HALVINGS = 14
"""Rounds of halving, to cells of less than 1e-5 rad, in which a motion has no features."""

PASSES = 40
"""Most passes over the cells. Each adds extremes, and in all but the last one some were missing."""

PLACES_NEAR = 65
"""Places among which an added extreme is searched for."""


def sure_bends(flank: WorkingCurve, bends: Extremes) -> Extremes:
    """`bends` with the extremes that the undercut of `flank` shows to be missing; usually none.

    Raises
    ------
    GeometryError
        If they are so many that no number of passes finds all.
    """
    envelope = flank_envelope(flank)
    cells = envelope.undivided
    # Turns about corners have no curvature of the pitch curve.
    cells = cells.some(~envelope.is_pivot[envelope.element_indices(cells.low)])
    for _ in range(PASSES):
        missed = _missed_of_cells(envelope, cells, backward_ranges(envelope, bends))
        if not len(missed):
            return bends
        bends = with_places(flank.pitch, bends, missed)
    raise unresolved_error(envelope, missed)


def _missed_of_cells(
    envelope: Envelope, cells: FlankCells, known: list[tuple[float, float]]
) -> FloatArray:
    """(k,) cam angles [rad] in and about the `cells` in which the pace has not the sign that the
    `known` ranges imply: none is left out, however narrow, once there are none.
    """
    missed = [np.empty(0)]
    for _ in range(HALVINGS):
        if not len(cells):
            break
        middle = 0.5 * (cells.low + cells.high)
        wrong = (cells.pace < 0.0) != _inside_ranges(middle, known, envelope.total)
        if np.any(wrong):
            # A pace of rounding has no sign.
            wrong &= np.abs(cells.pace) > CUSP * _speeds(envelope, middle)
        if np.any(wrong):
            missed.append(_extremes_near(envelope, cells.some(wrong)))
        cells = halved(envelope, cells.some(~wrong & (cells.sign == 0.0)))
    return np.concatenate(missed)


def _inside_ranges(
    places: FloatArray, ranges: list[tuple[float, float]], total: float
) -> BoolArray:
    """(n,) whether `places` (n,) lie in one of the `ranges`, which may reach beyond `total`."""
    inside: BoolArray = np.zeros(len(places), dtype=np.bool_)
    if ranges:
        start, end = np.array(ranges).T
        last = np.searchsorted(start, places, side="right") - 1  # before the first: the last one
        inside = (places - start[last]) % total < (end - start)[last]
    return inside


def _speeds(envelope: Envelope, places: FloatArray) -> FloatArray:
    """|Z'| at path parameters; 1 on the turns about a corner, whose pace is not a difference."""
    index = envelope.element_indices(places)
    speeds: FloatArray = np.ones(len(places))
    along = ~envelope.is_pivot[index]
    angles = places[along] + envelope.angle_offsets[index[along]]
    speeds[along] = np.abs(envelope.curve.pitch.jet(angles)[1])
    return speeds


def _extremes_near(envelope: Envelope, cells: FlankCells) -> FloatArray:
    """Cam angles of the middles of cells and of extremes of the curvature in them."""
    shift = envelope.angle_offsets[envelope.element_indices(cells.low)]
    ends = cells.low + shift, cells.high + shift
    # Without the ends of the cells, which may be breaks.
    grid = np.linspace(*ends, PLACES_NEAR + 2, axis=1)[:, 1:-1]
    roots = roots_on_grid(envelope.curve.pitch.curvature_slope, grid)
    return np.concatenate((roots, 0.5 * (ends[0] + ends[1])))


def with_places(pitch: PitchCurve, bends: Extremes, angles: FloatArray) -> Extremes:
    """`bends` and the curvature of `pitch` at `angles` (k,) [rad], in their order."""
    first = float(bends.phi[0])
    added = first + np.mod(angles - first, TURN)
    phi = np.concatenate((bends.phi, added))
    values = np.concatenate((bends.values, pitch.curvature(added)))
    order = np.argsort(phi, kind="stable")
    return Extremes(frozen(phi[order], np.float64), frozen(values[order], np.float64))


def find_crossings(curve: WorkingCurve, bends: Extremes | None = None) -> tuple[Node, ...]:
    """All crossings of the parallel `curve` with itself, each by its cam angles [rad] in [0, 2 pi)
    in place of path parameters, ordered by the first one.

    Mere contacts are not crossings. `bends` are the extremes of the pitch curve's curvature, if
    known.

    Raises
    ------
    GeometryError
        If the question cannot be decided, e.g. where the flank lies on itself along a stretch.
    """
    envelope = flank_envelope(curve)
    nodes = find_nodes(envelope, backward_ranges(envelope, bends))
    crossing = [node for node in nodes if not node.touching]
    places = np.array([(node.first, node.second) for node in crossing]).reshape(-1, 2)
    angles = envelope.cam_angles(places).tolist()
    crossings = [
        Node(first, second, node.point)
        for (first, second), node in zip(angles, crossing, strict=True)
    ]
    return tuple(sorted(crossings, key=lambda node: (node.first, node.second)))


# -- face outline ---------------------------------------------------------------------------------
# The disc that remains when a flat face cuts it: the intersection of the half planes below it.
#
# With h(psi) the distance of the face from the cam axis and psi the angle by which its normal has
# turned in the cam, the disc is the largest convex one whose support function H does not exceed h.
# Where p = tau h + (h'/tau)' < 0 the envelope of the face runs back, and H < h: there H is the sine
#
#     S(psi) = Re(conj(n(psi)) P)
#
# of a corner P, in which the envelope crosses itself: Z(x) = Z(y) = P. So H is for sines what the
# lower convex hull of a graph is for straight lines, and is found in the same way. The stretches
# with p > 0 are convex arcs. Between two of them there is one common sine at most, tangent to h at
# x on the first and at y on the second: as x grows, S rises everywhere ahead within half a turn. An
# arc that its sines to the left and to the right touch in the wrong order lies above the sine that
# passes it by, and is left out (Graham's scan, round the turn).
#
# With the arcs in order, stretches and corners form a closed curve whose tangent turns one way by
# one turn, which is convex. It is the boundary: no larger H has these tangent sines. As long as h >
# 0, something is left about the cam axis, and p is positive somewhere: over the turn its mean is
# that of h.


STEPS: Final = 60
"""Most Newton steps; from the guess six suffice."""

SMALL_STEP: Final = 1e-7
"""After a Newton step of this fraction of the tail's width the next one is mere rounding."""

SHORT: Final = 0.05
"""Width [rad] of a tail up to which its ends are compared by quadrature: their points differ by
less than is left of their digits."""

NODES: Final = 12
"""Nodes of the quadrature over each smooth part; of a part this short it has all digits."""

SAMPLES: Final = 257
"""Places of an arc among which a common sine is searched for where Newton's method does not find
it."""

ROUNDS: Final = 4
"""Rounds of the search for a common sine, each between two of the places of the round before."""

BISECTIONS: Final = 40
"""Halvings of the first arc, for each of which the second one is searched."""

END: Final = 1e-9
"""Fraction of an arc next to its ends that counts as the end."""

LOST: Final = 16.0
"""Largest rounding error of p / tau at the ends of ranges, in units in the last place of the
distance by which a face is moved out to find them; 2 were observed."""


@dataclass(frozen=True, slots=True)
class _Bridge:
    """The sine that two arcs have in common.

    Attributes
    ----------
    x, y : cam angles [rad] where it touches the first and the second one.
    exact : False where it touches the end of an arc, beyond which it would go on.
    """

    x: float
    y: float
    exact: bool


Arc = tuple[float, float]
"""Cam angles [rad] between which p > 0, the end above the start."""


def trimmed_path(flank: WorkingCurve, shape: Convexity) -> Path:
    """The boundary of what is left of a flat face's disc, `shape` being its `convexity`.

    Raises
    ------
    UndercutError
        If there is no such disc: the face turns back in the cam, its contact jumps, or it comes
        over the cam axis.
    GeometryError
        If it cannot be decided what is left.
    """
    if shape.turn[0] <= 0.0 or shape.jumps or shape.clearance[0] <= SMALLEST * shape.size:
        raise UndercutError("a flat face can only touch a convex cam, and this cam is not convex")
    ranges = backward_angles(flank.pitch, shape.turn[0])
    if not ranges:
        return Path((Stretch(flank, 0.0, TURN),))
    arcs = [
        (end - TURN, start) if end > start else (end, start)
        for (_, end), (start, _) in zip([ranges[-1], *ranges[:-1]], ranges, strict=True)
    ]
    arcs = sorted((start % TURN, start % TURN + (end - start)) for start, end in arcs)
    return _face_path(flank, _scan_arcs(_Face(flank.pitch), arcs))


def backward_angles(pitch: PitchCurve, turn: float) -> list[tuple[float, float]]:
    """Ranges of cam angle (start, end) [rad] with p < 0, ends in [0, 2 pi); the whole turn is
    (0, 2 pi).

    `turn` is the smallest tau, above 0. Moved out by more than a bound of |p| over it, the face has
    a regular outline, whose parallel inwards is this one: p < 0 where that undercuts. None is
    missed, because cells are halved until p keeps its sign over each, or is that of the known
    ranges.

    Raises
    ------
    GeometryError
        If the face is so fast somewhere that too few digits are left elsewhere to find all.
    """
    follower: Any = pitch.follower  # a frozen dataclass
    names = [key.removeprefix("follower.") for key in flat_follower(follower).raising_keys]
    shift = _speed_bound(pitch) / turn + follower.base_radius
    # Moved out until every part of the outline is regular; the disc is its parallel inwards.
    moved = replace(follower, **{name: getattr(follower, name) + shift for name in names})
    parallel = WorkingCurve(replace(pitch, follower=moved), -shift)
    bends = curvature_extremes(parallel.pitch)
    for _ in range(PASSES):
        ranges = deep_ranges(parallel, bends)
        missed = _missed_angles(pitch, ranges, shift)
        if not len(missed):
            return sorted(ranges)
        bends = with_places(parallel.pitch, bends, missed)
    raise _undecided_error(pitch)


def _undecided_error(pitch: PitchCurve) -> GeometryError:
    """The error for a face whose disc cannot be decided, with the place where its contact is
    fastest.
    """
    low, high = turn_cells(pitch)
    middles = 0.5 * (low + high)
    place = float(middles[np.argmax(pitch.speed_bounds(middles, middles)[0])])
    return GeometryError(
        "it cannot be decided what a flat face leaves of the disc: its contact runs too fast for"
        f" double precision near cam angle {math.degrees(place % TURN):.6f} deg; give the move"
        " there a longer span or a shorter stroke",
        "motion",
    )


def _speed_bound(pitch: PitchCurve) -> float:
    """A bound of |p| [mm] over the turn, at most twice its largest value, so that few digits of the
    lift are lost where the face is moved out by it.
    """
    low, high = turn_cells(pitch)
    known = fastest = 0.0
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        known = max(known, float(np.max(pitch.speed_bounds(middle, middle)[0])))
        bounds = pitch.speed_bounds(low, high)[0]
        wide = ~(bounds <= 2.0 * known)
        fastest = max(fastest, float(np.max(bounds[~wide], initial=0.0)))
        if not np.any(wide):
            return fastest
        low, high = halves(low, high, wide)
    raise _undecided_error(pitch)


def _missed_angles(
    pitch: PitchCurve, ranges: list[tuple[float, float]], shift: float
) -> FloatArray:
    """Cam angles [rad] at which the sign of p contradicts the `ranges` of p < 0 by more than
    rounding, which includes that of the face moved out by `shift` [mm].
    """
    start, end = np.array(ranges).reshape(-1, 2).T
    low, high = turn_cells(pitch)
    missed = []
    for _ in range(HALVINGS):
        middle, half = 0.5 * (low + high), 0.5 * (high - low)
        contact = touch(pitch, middle)
        inside = np.any((middle[:, None] - start) % TURN < (end - start) % TURN, axis=1)
        noise = CUSP * np.max(np.abs(contact.distance)) + LOST * math.ulp(shift) * contact.turn[0]
        wrong = ((contact.pace[0] < 0.0) != inside) & (np.abs(contact.pace[0]) > noise)
        missed.append(middle[wrong])
        unsure = ~wrong & np.isnan(rigid_centres(pitch, middle))
        unsure &= np.abs(contact.pace[0]) <= half * pitch.speed_bounds(low, high)[1]
        if not np.any(unsure):
            break
        low, high = halves(low, high, unsure)
    return np.concatenate(missed)


class _Face:
    """The demanded contact of a face, at single cam angles."""

    def __init__(self, pitch: PitchCurve) -> None:
        self.pitch = pitch
        self.breaks = np.concatenate([pitch.borders + k * TURN for k in (-1, 0, 1, 2)])

    def contacts(self, phi: FloatArray) -> tuple[ComplexArray, ComplexArray, FloatArray]:
        """(n,) contacts Z [mm], tangents t and p [mm/rad] at `phi` (n,) [rad]; t = -i sigma n turns
        steadily where Z turns back.
        """
        pitch, sigma = self.pitch, self.pitch.rotation
        normals = flat_follower(pitch.follower).normal(pitch.motion.jet(phi, "right", 1)[0])
        tangents = -1j * sigma * normals * np.exp(-1j * sigma * phi)
        return pitch.point(phi), tangents, touch(pitch, phi).pace[0]

    def turning(self, phi: FloatArray) -> FloatArray:
        """(n,) psi [rad] but for a constant, at `phi` (n,) [rad] of any turn."""
        lift = self.pitch.motion.jet(phi, "right", 1)[0]
        return np.asarray(phi - self.pitch.rotation * self.pitch.follower.swing_sense * lift)

    def way(self, x: float, y: float, ends: ComplexArray) -> complex:
        """Z(y) - Z(x) [mm], from their values `ends` (2,) unless these are too close."""
        if y - x > SHORT:
            return complex(ends[1] - ends[0])
        inner = self.breaks[(self.breaks > x) & (self.breaks < y)]
        marks = np.concatenate(([x], inner, [y]))
        places, half, weights = gauss(marks[:-1], marks[1:], NODES)
        _, tangents, pace = self.contacts(places.ravel())
        parts = (half[:, None] * weights).ravel() * pace * tangents
        return complex(np.sum(parts))


def _scan_arcs(face: _Face, arcs: list[Arc]) -> list[tuple[Arc, _Bridge]]:
    """The arcs that count, each with its bridge to the next one."""
    bridges: list[_Bridge | None] = [None] * len(arcs)
    while arcs:
        for k, (arc, bridge) in enumerate(zip(arcs, bridges, strict=True)):
            if bridge is None:
                next_arc = arcs[(k + 1) % len(arcs)]
                shift = TURN if k + 1 == len(arcs) else 0.0
                bridges[k] = _bridge(face, arc, (next_arc[0] + shift, next_arc[1] + shift))
        known = [bridge for bridge in bridges if bridge is not None]
        lefts = [known[-1].y - TURN, *(bridge.y for bridge in known[:-1])]
        hidden = [k for k, bridge in enumerate(known) if lefts[k] >= bridge.x]
        if not hidden:
            if not all(bridge.exact for bridge in known):
                break
            return list(zip(arcs, known, strict=True))
        place = hidden[0]
        del arcs[place], bridges[place]
        if bridges:
            bridges[place - 1] = None
    raise _undecided_error(face.pitch)


def _bridge(face: _Face, first: Arc, second: Arc) -> _Bridge:
    """The bridge between two arcs, the second one ahead."""
    middle, half = 0.5 * (first[1] + second[0]), 0.5 * (second[0] - first[1])
    # Of a p that is a parabola between the cusps the crossing lies root 3 times as far out.
    x = max(middle - math.sqrt(3.0) * half, 0.5 * (first[0] + first[1]))
    y = min(middle + math.sqrt(3.0) * half, 0.5 * (second[0] + second[1]))
    bridge = _newton(face, first, second, x, y)
    if bridge is not None:
        return bridge
    guess = _bisect_bridge(face, first, second)
    if guess.exact:
        bridge = _newton(face, first, second, guess.x, guess.y)
    return bridge or guess


def _newton(face: _Face, first: Arc, second: Arc, x: float, y: float) -> _Bridge | None:
    """The bridge by Newton's method from a guess; None if it does not converge inside the arcs."""
    small_step = False
    for _ in range(STEPS):
        points, (t_x, t_y), (p_x, p_y) = face.contacts(np.array([x, y]))
        sine = float((np.conj(t_x) * t_y).imag)
        if not (p_x > 0.0 and p_y > 0.0 and sine != 0.0):
            return None
        way = face.way(x, y, points)
        dx = float((np.conj(way) * t_y).imag) / (p_x * sine)
        dy = float((np.conj(way) * t_x).imag) / (p_y * sine)
        share = min(1.0, _step_share(x, dx, first), _step_share(y, dy, second))
        x, y = x + share * dx, y + share * dy
        if small_step:
            turned = face.turning(np.array([x, y]))
            # Half a turn on, and the same place once more: neither is a sine in common.
            return _Bridge(x, y, exact=True) if turned[1] - turned[0] < math.pi else None
        small_step = abs(dx) + abs(dy) <= SMALL_STEP * (y - x) + 8.0 * math.ulp(TURN)
    return None


def _step_share(place: float, step: float, arc: Arc) -> float:
    """Fraction of `step` that stays inside the `arc`."""
    room = 0.9 * ((arc[1] - place) if step > 0.0 else (place - arc[0]))
    return room / abs(step) if abs(step) > room else 1.0


def _bisect_bridge(face: _Face, first: Arc, second: Arc) -> _Bridge:
    """The bridge by bisection, or the ends of arcs where it would lie beyond them."""
    places = np.linspace(*second, SAMPLES)
    points, tangents, _ = face.contacts(places)
    normals = 1j * face.pitch.rotation * tangents
    ahead = face.turning(places)

    def lowest(x: float) -> tuple[float, float]:
        """Smallest h - S [mm] over the second arc for the sine that touches the first one at `x`,
        and where; half a turn ahead at most.
        """
        start = face.contacts(np.array([x]))[0]
        visible = ahead < float(face.turning(np.array([x]))[0]) + math.pi
        above = np.where(visible, (np.conj(normals) * (points - start)).real, np.inf)
        k = int(np.argmin(above))
        low, high = float(places[max(k - 1, 0)]), float(places[min(k + 1, SAMPLES - 1)])
        for _ in range(ROUNDS):
            near = np.linspace(low, high, SAMPLES)
            there, along, _ = face.contacts(near)
            falls = (np.conj(along) * (there - start)).real < 0.0  # h - S does
            k = int(np.count_nonzero(falls))
            low, high = float(near[max(k - 1, 0)]), float(near[min(k, SAMPLES - 1)])
        k = min(k, SAMPLES - 1)
        normal = 1j * face.pitch.rotation * along[k]
        return float((np.conj(normal) * (there[k] - start)).real[0]), float(near[k])

    starts = np.linspace(*first, SAMPLES)
    low = float(starts[np.argmax(face.turning(starts) > ahead[0] - math.pi)])
    high = first[1]
    for end, wrong in ((low, -1.0), (high, 1.0)):
        value, y = lowest(end)
        if wrong * value > 0.0:
            return _Bridge(end, y, exact=False)
    for _ in range(BISECTIONS):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if lowest(middle)[0] > 0.0 else (low, middle)
    y = lowest(low)[1]
    room = END * (second[1] - second[0])
    return _Bridge(low, y, exact=second[0] + room < y < second[1] - room)


def _face_path(flank: WorkingCurve, parts: list[tuple[Arc, _Bridge]]) -> Path:
    """Stretches from bridge to bridge, and the corners between them."""
    rotation = flank.pitch.rotation
    face = _Face(flank.pitch)
    elements: list[tuple[float, list[Element]]] = []
    for k, (_, bridge) in enumerate(parts):
        # The stretch before the first corner begins at the last one, a turn earlier.
        previous_end = parts[k - 1][1].y - (TURN if k == 0 else 0.0)
        ends = np.array([bridge.x, bridge.y])
        points, tangents, _ = face.contacts(ends)
        normals = 1j * rotation * tangents
        sweep = float(np.angle(normals[1] * np.conj(normals[0])))
        corner = Pivot(
            complex(np.mean(points)), 0.0, complex(normals[0]), sweep, *(ends % TURN).tolist()
        )
        start = previous_end % TURN
        stretch = Stretch(flank, start, start + (bridge.x - previous_end))
        elements.append((start, [stretch, corner]))
    ordered = sorted(elements, key=lambda element: element[0])
    return Path(tuple(element for _, pair in ordered for element in pair))


# -- layers ---------------------------------------------------------------------------------------
# The outermost of many pieces over a turn, each of which covers a range of it.
#
# This shows what holds a follower: of the branches that its path meets, over the cam angle, or of
# the circles that a flat face touches, over the direction of its normal. Which piece is outermost
# changes only at the ends of ranges and where two pieces cross, so it is known everywhere, not just
# at samples.


NONE = -1
"""Number in place of a piece where there is none."""

MOST_PAIRS = 2_000_000
"""Most pairs of a piece and a cell: 25 layers of a contour of 20,000 pieces. A contour that is
smooth except for a few corners has one layer."""

Pairs = tuple[IntArray, IntArray]
"""(p,) cells, ascending, and (p,) pieces that cover them, ascending in each cell."""


@dataclass(frozen=True, slots=True, eq=False)
class AngleCells:
    """Ranges (m,) of an angle [rad] between neighbouring ends of ranges; the last crosses 0."""

    low: FloatArray
    high: FloatArray

    @classmethod
    def from_nodes(cls, nodes: FloatArray) -> AngleCells:
        """The ranges between `nodes` (m,) in [0, 2 pi), ascending."""
        return cls(nodes, np.append(nodes[1:], nodes[0] + TURN))

    def __len__(self) -> int:
        return len(self.low)


def cover_cells(cells: AngleCells, first: IntArray, count: IntArray, what: str) -> Pairs:
    """The pieces k (n,) that cover `count` (n,) cells from `first` (n,) on, cell by cell.

    Raises GeometryError if there are too many pairs; `what` are the pieces, in a message.
    """
    if np.sum(count) > MOST_PAIRS:
        raise too_rough_error(what, np.sum(count) / len(cells))
    piece, rank = grouped(count)
    cell = np.remainder(first[piece] + rank, len(cells))
    # Stable, so that pieces ascend within each cell.
    order = np.argsort(cell, kind="stable")
    return cell[order], piece[order]


def too_rough_error(what: str, layers: float) -> GeometryError:
    """The error for a contour of too many layers."""
    return GeometryError(
        f"the contour is too rough to be replayed: {what} in {layers:.0f} layers; smooth it first"
    )


def visible_pieces(cell: IntArray, low: FloatArray, high: FloatArray) -> BoolArray:
    """(p,) False for pieces that lie behind another one throughout their `cell` (p,), where their
    heights are between `low` and `high` (p,).
    """
    least = np.full(int(np.max(cell, initial=-1)) + 1, -np.inf)
    # The highest lower bound in each cell: what stays below it is hidden.
    np.maximum.at(least, cell, low)
    return np.asarray(high >= least[cell])


def pairs_in_cells(cell: IntArray) -> Iterator[Pairs]:
    """All pairs of places in `cell` (p,), ascending, that have the same one, in batches."""
    step = 1
    # Equal cells are neighbours: pairs one place apart, then two, and so on.
    while np.any(same := cell[step:] == cell[:-step]):
        index = np.flatnonzero(same)
        yield index, index + step
        step += 1


def outermost(
    cells: AngleCells,
    pairs: Pairs,
    crossings: FloatArray,
    height: Callable[[IntArray, FloatArray], FloatArray],
) -> tuple[FloatArray, IntArray, IntArray]:
    """Borders (g,) [rad]; the cell that each of them lies in or begins; and (g,) the highest piece
    from each to the next, the last one of several, or `NONE`.

    Parameters
    ----------
    crossings : (k,) [rad] in [0, 2 pi), where pieces of `pairs` in one cell are of the same height.
    height : of the pieces (q,) at angles (q,) [rad].
    """
    cell, piece = pairs
    borders = ascending(np.concatenate((cells.low, crossings)))
    # Before the first node it is still the last cell, which reaches across 0.
    parent = np.remainder(np.searchsorted(cells.low, borders, "right") - 1, len(cells))
    first = np.searchsorted(cell, parent, "left")
    count = np.searchsorted(cell, parent, "right") - first
    fine, rank = grouped(count)
    candidate = piece[first[fine] + rank]
    # A piece that is alone in its cell needs no height.
    several = count[fine] > 1
    middle = 0.5 * (borders + np.append(borders[1:], borders[0] + TURN))
    heights = np.zeros(len(fine))
    heights[several] = height(candidate[several], middle[fine[several]])
    # By border, then height: the last of each border is on top.
    order = np.lexsort((heights, fine))
    fine, candidate = fine[order], candidate[order]
    top = np.flatnonzero(np.diff(fine, append=-1))
    held = np.full(len(borders), NONE)
    held[fine[top]] = candidate[top]
    return borders, parent, held


def changes(borders: FloatArray, held: IntArray) -> tuple[FloatArray, IntArray]:
    """The `borders` (g,) at which the piece changes, at least one, each with the piece that
    follows.
    """
    changed = held != np.roll(held, 1)
    changed[0] |= not np.any(changed)
    return borders[changed], held[changed]
