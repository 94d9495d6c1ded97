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
from dataclasses import dataclass

import numpy as np

from camgeo.curve.extremes import Extremes
from camgeo.curve.pitch_curve import PitchCurve
from camgeo.curve.working_curve import WorkingCurve
from camgeo.displayed import Brief
from camgeo.errors import GeometryError, UndercutError
from camgeo.numeric.arrays import FloatArray
from camgeo.outline.clearance import (
    are_clear,
    nearest_to_axis,
    stays_on_one_side,
    surely_clear_of_axis,
)
from camgeo.outline.crossings import Node, find_crossings, find_nodes
from camgeo.outline.cusps import backward_ranges
from camgeo.outline.division import divide
from camgeo.outline.envelope import Envelope, envelope_of
from camgeo.outline.path import Element, Path, Pivot, Stretch, whole
from camgeo.units import TURN

ROUND = 1024
"""Places of the envelope at which its winding number is taken, at least eight per part."""

NEIGHBOURHOOD = 1.0
"""Turn of the tangent [rad] up to which neighbours of a point provably do not cover it, by bounds
over cells; more than twice `camgeo.outline.division.STEEPEST`."""


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
class _Part:
    """The envelope from one crossing to the next, path parameters start < end."""

    start: float
    end: float
    from_node: int
    to_node: int


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
    envelope = envelope_of(flank)
    backward = backward_ranges(envelope, bends)
    nodes = tuple(n for n in find_nodes(envelope, backward) if not n.touching)
    if not nodes:
        if backward and backward != [(0.0, envelope.total)]:
            raise GeometryError(
                f"the flank runs back {_unsettled(envelope, backward, nodes)}, where it does not"
                " cross itself by more than rounding: it cannot be decided what is left of it"
            )
        if backward:
            raise UndercutError(
                "the roller is larger than the pitch curve allows all round: nothing is left of"
                " the disc"
            )
        return Outline(Path(envelope.elements), (), ())
    parts = _parts(envelope, nodes)
    loops = _loops(nodes, _kept(envelope, nodes, backward, parts))
    paths = [_path(envelope, nodes, loop) for loop in loops]
    windings = [_winding(envelope, loop) for loop in loops]
    main = [k for k, winding in enumerate(windings) if winding != 0]
    if len(main) != 1:
        # Where the axis is free, there is a disc about it, and the rest lies around all rollers.
        raise GeometryError(
            "it cannot be decided what is left of the flank: its sides touch to rounding"
            f" {_unsettled(envelope, backward, nodes)}"
        )
    lobes = tuple(path for k, path in enumerate(paths) if k != main[0])
    return Outline(paths[main[0]], lobes, _dropped(paths[main[0]]))


def _unsettled(
    envelope: Envelope, backward: list[tuple[float, float]], nodes: tuple[Node, ...]
) -> str:
    """In words, the first range in which the flank runs back and which no crossing cuts off; or if
    there is none, the first crossing.
    """
    total = envelope.total
    spans = [(each.first, each.second) for each in nodes]
    cut = [(a, b) if b - a < 0.5 * total else (b, a + total) for a, b in spans]
    places = [
        0.5 * (start + end)
        for start, end in backward
        if not any(
            a + k * total <= start and end <= b + k * total for a, b in cut for k in (-1, 0, 1)
        )
    ]
    place = envelope.within(np.array([*places, *(first for first, _ in spans)][:1]))
    return f"at cam angle {math.degrees(envelope.angles_at(place)[0]):.6f} deg"


def _convex_outline(flank: WorkingCurve) -> Outline:
    """The whole contact curve of a flat face, or what remains of it where it undercuts.

    `camgeo.outline.convex` shows why the whole one does not cross itself.
    """
    from camgeo.outline.convex import convexity  # only few cams have a flat face

    found = convexity(flank.pitch)
    if found.is_convex:
        return Outline(whole(flank), (), ())
    from camgeo.outline.face_outline import trimmed_path  # few of them undercut

    path = trimmed_path(flank, found)
    return Outline(path, (), _dropped(path))


def require_room(flank: WorkingCurve) -> None:
    """Raise UndercutError if the roller reaches over the cam axis, GeometryError if it would run
    through its own flank: trimming helps neither.
    """
    if flank.distance <= 0.0:
        _require_axis(flank)
    _require_simple(flank.pitch)


def _require_axis(flank: WorkingCurve) -> None:
    if surely_clear_of_axis(flank.pitch, -flank.distance):
        return
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


def _parts(envelope: Envelope, nodes: tuple[Node, ...]) -> list[_Part]:
    events = sorted(
        (place, k) for k, node in enumerate(nodes) for place in (node.first, node.second)
    )
    following = [*events[1:], (events[0][0] + envelope.total, events[0][1])]
    return [
        _Part(start, end, k, other)
        for (start, k), (end, other) in zip(events, following, strict=True)
    ]


def _kept(
    envelope: Envelope,
    nodes: tuple[Node, ...],
    backward: list[tuple[float, float]],
    parts: list[_Part],
) -> list[_Part]:
    """The parts on the boundary: regular, on the free side at their ends, and clear."""
    start, end = np.array([(part.start, part.end) for part in parts]).T
    ranges = np.array(backward).reshape(-1, 2)
    turns = np.repeat([-envelope.total, 0.0, envelope.total], len(ranges))
    low, high = np.append(np.tile(ranges, (3, 1)) + turns[:, None], [[np.inf, np.inf]], axis=0).T
    regular = low[np.searchsorted(high, start, side="right")] >= end
    arriving = np.where(end >= envelope.total, end - envelope.total, end)
    sides = [
        _sides(envelope, [nodes[number] for number in numbers], places, low, high)
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
    owns = _owns(envelope, free, middles)
    clear = are_clear(envelope.curve.pitch, points, abs(envelope.curve.distance), owns)
    return [part for part, is_clear in zip(free, clear, strict=True) if is_clear]


def _sides(
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
    own, crossed = (envelope.samples(each).tangents for each in (places, other))
    sense = -math.copysign(1.0, envelope.curve.distance) * envelope.curve.pitch.rotation
    towards_roller = sense * 1j * crossed
    return np.where(behind, np.nan, (np.conj(towards_roller) * own).real)


def _owns(envelope: Envelope, parts: list[_Part], middles: FloatArray) -> FloatArray:
    """(n, 2) cam angles about `middles` (n,) along which the tangent provably turns little, inside
    each of the `parts`; the second above the first.
    """
    cells, total = divide(envelope, np.empty(0)).cells, envelope.total
    turns = np.repeat([0.0, total, 2.0 * total], len(cells))
    low, high = np.tile(cells.low, 3) + turns, np.tile(cells.high, 3) + turns
    turned = np.concatenate(([0.0], np.cumsum(np.tile(2.0 * cells.turn, 3))))
    shift = envelope.within(middles) + total - middles  # into the second of three turns
    own = np.searchsorted(low, middles + shift, side="right") - 1
    # A cell turns by less than that, so that its own is among them.
    first = np.searchsorted(turned, turned[own + 1] - NEIGHBOURHOOD, side="right")
    last = np.searchsorted(turned, turned[own] + NEIGHBOURHOOD) - 2
    starts, ends = np.array([(part.start, part.end) for part in parts]).T
    ranges = np.maximum(low[first] - shift, starts), np.minimum(high[last] - shift, ends)
    owns = envelope.angles_at(envelope.within(np.column_stack(ranges)))
    owns[:, 1] += np.where(owns[:, 1] >= owns[:, 0], 0.0, TURN)
    return owns


def _loops(nodes: tuple[Node, ...], kept: list[_Part]) -> list[list[_Part]]:
    """The kept parts linked at their crossings: each continues along the other branch."""
    following: dict[int, list[_Part]] = {}
    for part in kept:
        following.setdefault(part.from_node, []).append(part)
    loops: list[list[_Part]] = []
    for first in kept:
        if first not in following.get(first.from_node, ()):
            continue
        following[first.from_node].remove(first)
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


def _path(envelope: Envelope, nodes: tuple[Node, ...], loop: list[_Part]) -> Path:
    elements: list[Element] = []
    rotation = envelope.curve.pitch.rotation
    meeting = zip(loop, [*loop[1:], loop[0]], strict=True)
    places = envelope.within(np.array([(part.end, other.start) for part, other in meeting]))
    tangents = envelope.samples(places.ravel()).tangents.reshape(places.shape)
    angles = envelope.angles_at(places).tolist()
    for part, (one, other), (before, after) in zip(loop, tangents, angles, strict=True):
        elements += _elements(envelope, part)
        sweep = float(np.angle(other * np.conj(one)))
        normal = 1j * rotation * complex(one)
        elements.append(Pivot(nodes[part.to_node].point, 0.0, normal, sweep, before, after))
    return Path(tuple(elements))


def _elements(envelope: Envelope, part: _Part) -> list[Element]:
    """The elements of a part: stretches and turns, cut at its ends."""
    found: list[Element] = []
    curve = envelope.curve
    if len(envelope.elements) == 1:
        return [Stretch(curve, part.start, part.end)]
    for turn in (0.0, envelope.total):
        for start, each in zip(envelope.starts + turn, envelope.elements, strict=True):
            span = abs(each.sweep) if isinstance(each, Pivot) else each.end - each.start
            low, high = max(part.start, start), min(part.end, start + span)
            if high <= low:
                continue
            if isinstance(each, Stretch):
                first = each.start + float(low - start)
                last = each.end if high == start + span else each.start + float(high - start)
                shift = TURN if first >= TURN else 0.0
                found.append(Stretch(curve, first - shift, last - shift))
            else:
                sense = math.copysign(1.0, each.sweep)
                normal = each.normal * complex(np.exp(1j * sense * (low - start)))
                sweep = sense * float(high - low)
                found.append(
                    Pivot(each.centre, each.distance, normal, sweep, each.before, each.after)
                )
    return found


def _winding(envelope: Envelope, loop: list[_Part]) -> int:
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


def _dropped(path: Path) -> tuple[tuple[float, float], ...]:
    """Ranges of cam angle between the stretches of the disc."""
    corners = [pivot for pivot in path.pivots if pivot.distance == 0.0]
    return tuple(
        sorted((p.before % TURN, p.before % TURN + (p.after - p.before) % TURN) for p in corners)
    )
