"""The real outline: what is left of a flank when the roller has removed what it must.

The roller stands for the cutter. Where the flank crosses itself, the way on is along the branch
that the other one does not cover; what runs back, and what another roller covers, is dropped. So
the outline consists of stretches of the working curve itself with exact corners between them.

Only crossings of the flank with itself matter, and not those with the other flank: a pitch curve
that does not cross itself has an inside and an outside, and no point is inside of one part and
outside of another unless a third part runs between, whose roller covers it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from camgeo.curve.extremes import Extremes, extremes
from camgeo.curve.pitch_curve import PitchCurve
from camgeo.curve.turn_cells import halves, turn_cells
from camgeo.curve.working_curve import WorkingCurve
from camgeo.errors import GeometryError, UndercutError
from camgeo.motion.extremes import lift_range
from camgeo.motion.motion import Side
from camgeo.numeric.arrays import FloatArray
from camgeo.outline.crossings import Node, find_crossings, find_nodes
from camgeo.outline.cusps import backward_ranges
from camgeo.outline.envelope import Envelope
from camgeo.outline.path import Element, Path, Pivot, Stretch, whole
from camgeo.units import TURN

NEIGHBOURHOOD = 1.0
"""Turn of the tangent [rad] up to which neighbours of a point surely do not cover it."""


@dataclass(frozen=True, slots=True)
class Outline:
    """What is left of a flank.

    Attributes
    ----------
    path : the boundary of the disc, or of the hole of an outer flank, once round the cam axis.
    lobes : boundaries of what is cut off from it and falls away.
    dropped : ranges (start, end) of cam angle [rad] whose stretch of the flank is not on `path`,
        start in [0, 2 pi), end above it by less than a turn.
    """

    path: Path
    lobes: tuple[Path, ...]
    dropped: tuple[tuple[float, float], ...]

    @property
    def is_trimmed(self) -> bool:
        """True if the follower does not make all of its motion."""
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
        If nothing is left of the disc: the roller reaches over the cam axis, or covers everything.
        Or if the cam of a flat face is not convex.
    GeometryError
        If the roller centre stands still in the cam (Z' = 0), or it cannot be decided what is left.
    """
    if not flank.pitch.follower.has_pitch_curve:
        return _convex_outline(flank)
    if flank.distance <= 0.0:
        _require_axis(flank)
    _require_simple(flank.pitch)
    envelope = Envelope(flank)
    backward = backward_ranges(envelope, bends)
    nodes = tuple(n for n in find_nodes(envelope, backward) if not n.touching)
    if not nodes:
        if backward and backward != [(0.0, envelope.total)]:
            raise GeometryError(
                "the flank runs back where it does not cross itself by more than rounding: it"
                " cannot be decided what is left of it"
            )
        if backward:
            raise UndercutError(
                "the roller is larger than the pitch curve allows all round: nothing is left of"
                " the disc"
            )
        return Outline(Path(envelope.elements), (), ())
    parts = _parts(envelope, nodes)
    kept = [part for part in parts if _is_kept(envelope, nodes, backward, part)]
    loops = _loops(nodes, kept)
    paths = [_path(envelope, nodes, loop) for loop in loops]
    windings = [_winding(envelope, loop) for loop in loops]
    main = [k for k, winding in enumerate(windings) if winding != 0]
    if len(main) != 1:
        # Wherever the axis is free there is a disc about it, and around all rollers the rest.
        raise GeometryError(
            "it cannot be decided what is left of the flank: its sides touch to rounding"
        )
    lobes = tuple(path for k, path in enumerate(paths) if k != main[0])
    return Outline(paths[main[0]], lobes, _dropped(paths[main[0]]))


def _convex_outline(flank: WorkingCurve) -> Outline:
    """All of the contact curve of a flat face: see `camgeo.outline.convex` why nothing crosses."""
    from camgeo.outline.convex import convexity  # few cams have a flat face

    if not convexity(flank.pitch).is_convex:
        raise UndercutError("a flat face touches only a convex cam, and this one is not")
    return Outline(whole(flank), (), ())


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

    It cannot where the follower stays on one side of the cam axis: then its lift tells the distance
    of the roller centre from the axis, and the cam angle the direction, one by one.
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


def _is_kept(
    envelope: Envelope,
    nodes: tuple[Node, ...],
    backward: list[tuple[float, float]],
    part: _Part,
) -> bool:
    """Whether a part is on the boundary: regular, on the free side at its ends, and clear."""
    total = envelope.total
    for start, end in backward:
        for shift in (-total, 0.0, total):
            if start + shift < part.end and end + shift > part.start:
                return False
    leaves = _side(envelope, nodes[part.from_node], part.start, backward)
    arrives = _side(envelope, nodes[part.to_node], part.end - total * (part.end >= total), backward)
    if leaves is None or arrives is None or leaves > 0.0 or arrives < 0.0:
        return False
    middle = 0.5 * (part.start + part.end)
    point = complex(envelope.course(np.array([middle])).points[0])
    radius = abs(envelope.curve.distance)
    return is_clear(envelope.curve.pitch, point, radius, _own(envelope, part, middle))


def _side(
    envelope: Envelope, node: Node, place: float, backward: list[tuple[float, float]]
) -> float | None:
    """Positive if the branch at `place` runs into what the other branch removes, else negative.

    None if the other branch runs back there: its roller covers the crossing itself.
    """
    other = node.second if abs(place - node.first) <= abs(place - node.second) else node.first
    for start, end in backward:
        if start < other < end or start < other + envelope.total < end:
            return None
    course = envelope.course(np.array([place, other]))
    own, crossed = complex(course.tangents[0]), complex(course.tangents[1])
    curve = envelope.curve
    towards_roller = -math.copysign(1.0, curve.distance) * 1j * curve.pitch.rotation * crossed
    return (towards_roller.conjugate() * own).real


def _own(envelope: Envelope, part: _Part, middle: float) -> tuple[float, float]:
    """Cam angles about `middle` along which the tangent turns little, inside the part."""
    places = np.linspace(part.start, part.end, 129)
    tangents = envelope.course(places).tangents
    turned = np.concatenate(
        ([0.0], np.cumsum(np.abs(np.angle(tangents[1:] * np.conj(tangents[:-1])))))
    )
    near = np.abs(turned - np.interp(middle, places, turned)) < 0.5 * NEIGHBOURHOOD
    inside = places[near]
    low = min(float(inside[0]), middle)
    high = max(float(inside[-1]), middle)
    start = envelope.angle_at(float(envelope.within(np.array([low]))[0]))
    end = envelope.angle_at(float(envelope.within(np.array([high]))[0]))
    return start, end if end >= start else end + TURN


def _loops(nodes: tuple[Node, ...], kept: list[_Part]) -> list[list[_Part]]:
    """The kept parts linked at their crossings: each goes on along the other branch."""
    total_left = list(kept)
    loops: list[list[_Part]] = []
    while total_left:
        loop = [total_left.pop(0)]
        while loop[-1].to_node != loop[0].from_node:
            following = [p for p in total_left if p.from_node == loop[-1].to_node]
            if len(following) != 1:
                raise GeometryError(
                    "it cannot be decided what is left of the flank: more than two branches meet"
                    f" at {nodes[loop[-1].to_node].point:.6g} mm"
                )
            loop.append(following[0])
            total_left.remove(following[0])
        loops.append(loop)
    return loops


def _path(envelope: Envelope, nodes: tuple[Node, ...], loop: list[_Part]) -> Path:
    elements: list[Element] = []
    for part, following in zip(loop, [*loop[1:], loop[0]], strict=True):
        elements += _elements(envelope, part)
        node = nodes[part.to_node]
        places = envelope.within(np.array([part.end, following.start]))
        tangents = envelope.course(places).tangents
        before, after = (envelope.angle_at(float(place)) for place in places)
        elements.append(
            Pivot(
                node.point,
                0.0,
                1j * envelope.curve.pitch.rotation * complex(tangents[0]),
                float(np.angle(tangents[1] * np.conj(tangents[0]))),
                before=before,
                after=after,
            )
        )
    return Path(tuple(elements))


def _elements(envelope: Envelope, part: _Part) -> list[Element]:
    """What a part runs through: stretches and turns, cut at its ends."""
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
    """How often a loop goes round the cam axis."""
    places = np.concatenate([np.linspace(part.start, part.end, 1025)[:-1] for part in loop])
    points = envelope.course(places).points
    return round(float(np.sum(np.angle(np.roll(points, -1) * np.conj(points)))) / TURN)


def _dropped(path: Path) -> tuple[tuple[float, float], ...]:
    """Ranges of cam angle between the stretches of the disc."""
    corners = [pivot for pivot in path.pivots if pivot.distance == 0.0]
    return tuple(
        sorted((p.before % TURN, p.before % TURN + (p.after - p.before) % TURN) for p in corners)
    )


HALVINGS = 50
"""Rounds of halving at most."""

CLOSE = 1e-9
"""A point nearer than the roller's radius by this share of it is covered; one nearer to the radius
than this is touched."""


def is_clear(pitch: PitchCurve, point: complex, radius: float, own: tuple[float, float]) -> bool:
    """True if no roller of `radius` [mm] on the pitch curve covers `point`.

    Surely: what a cell of cam angle cannot exclude is halved.

    Parameters
    ----------
    own : cam angles [rad], start in [0, 2 pi) and end above it, that are not looked at: the point
        is touched there, and its neighbours are known to be regular.
    """
    start, end = own
    low, high = turn_cells(pitch, start, end)
    outside = (0.5 * (low + high) - start) % TURN > end - start
    low, high = low[outside], high[outside]
    for _ in range(HALVINGS):
        middle, half = 0.5 * (low + high), 0.5 * (high - low)
        distance = np.abs(pitch.point(middle) - point)
        if len(distance) and float(np.min(distance)) < (1.0 - CLOSE) * radius:
            return False
        reach = half * pitch.speed_bounds(low, high)[0]
        near = distance - reach < (1.0 - CLOSE) * radius
        if not np.any(near):
            return True
        low, high = halves(low, high, near)
    return True  # touched, to rounding


def nearest_to_axis(pitch: PitchCurve) -> tuple[float, float]:
    """Smallest distance of the roller centre from the cam axis [mm] and its cam angle [rad]."""

    def square(phi: FloatArray, side: Side) -> FloatArray:
        relative = pitch.relative_jet(phi, side, order=1)
        return np.asarray(relative.along[0] ** 2 + relative.across[0] ** 2)

    def slope(phi: FloatArray, side: Side) -> FloatArray:
        relative = pitch.relative_jet(phi, side, order=1)
        (a0, a1), (b0, b1) = relative.along[:2], relative.across[:2]
        return np.asarray(a0 * a1 + b0 * b1)

    smallest, phi = extremes(pitch, square, slope).smallest()
    return float(np.sqrt(smallest)), phi


def surely_clear_of_axis(pitch: PitchCurve, radius: float) -> bool:
    """True if bounds over cells show that the roller centre stays farther than `radius` [mm].

    False says nothing; `nearest_to_axis` does then.
    """
    low, high = turn_cells(pitch)
    jet, bounds = pitch.jet_and_bounds(low, high)
    return bool(np.all(np.abs(jet[0]) - 0.5 * (high - low) * bounds[0] > radius))


def stays_on_one_side(pitch: PitchCurve) -> bool:
    """True if the roller centre never passes the foot of the guide, or the line of centres.

    There the transmission angle is 0, and the same distance from the cam axis comes again.
    """
    middle, bounds = pitch.motion.jet_and_bounds(*turn_cells(pitch))
    reach = np.array([np.min(middle[0] - bounds[0]), np.max(middle[0] + bounds[0])])
    if pitch.follower.on_one_side(reach):
        return True
    return pitch.follower.on_one_side(np.array(lift_range(pitch.motion)))
