"""Areas between walls and the outline of the blank, each cleared by the strategy that its walls ask
for: an outside, a hole, a ring between two walls, or a face without walls.
"""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import pairwise

import numpy as np

from camgeo.errors import GeometryError
from camgeo.geometry.contour.contour import Contour, Effort, least_distance
from camgeo.milling.areas import MOST_TURNS, Morph, Star, engagements, fitted
from camgeo.milling.cut import AreaCut, Cut
from camgeo.milling.moves import Heights, Move
from camgeo.milling.strategies.around import descend, descent
from camgeo.milling.strategies.walk import (
    SAME,
    SHORTEST_START,
    SPENT,
    Walk,
    along,
    coarse,
    limit_of,
    require_clear,
    spiral,
)
from camgeo.milling.track import Beside, Track, begun, chained, flattest, lead_at, started
from camgeo.numeric.arrays import phase
from camgeo.part.part import Boundary


def clear(cut: Cut, heights: Heights, tolerance: float, effort: Effort) -> list[Move]:  # noqa: ARG001  all strategies are called alike
    """The moves that clear an area; its paths are fitted fast, and coarsely within the allowance.

    Raises
    ------
    GeometryError
        If the cutter is too large for the area, or no strategy clears an area with such walls.
    """
    if not isinstance(cut, AreaCut):
        raise TypeError(f"{cut.name}: the strategy {cut.strategy} clears an area")
    holes = [wall for wall in cut.walls if wall.hole]
    solids = [wall for wall in cut.walls if not wall.hole]
    match solids, holes:
        case [], []:
            return face(cut, heights, tolerance)
        case [solid], []:
            return outside(cut, solid, heights, tolerance)
        case [], [hole]:
            return inside(cut, hole, heights, tolerance)
        case [solid], [hole]:
            return ring(cut, solid, hole, heights, tolerance)
    names = ", ".join(wall.name for wall in cut.walls)
    raise GeometryError("an area has at most one wall around it and one within it", "part", names)


# -- face -----------------------------------------------------------------------------------------
# Facing: the whole upper face of the blank by a spiral from outside inward.


ENTRY = 0.75
"""Radius of the quarter turns into the blank, as a share of the cutter's; and the room of the lead
off what is left, if there is as much."""

INNERMOST = 0.9
"""Radius of the last round as a share of that within which the cutter is flat."""


def face(cut: AreaCut, heights: Heights, tolerance: float) -> list[Move]:
    """At each depth: down in the air beside the blank, and round it inward to its middle.

    Between depths the cutter runs out again over what it has cleared.

    Raises
    ------
    GeometryError
        If the blank is unknown, or too long and narrow for a spiral.
    """
    if cut.stock is None:
        raise GeometryError(f"{cut.name} needs the outline of the blank", "stock")
    fine = coarse(cut, tolerance)
    blank = cut.stock.arcs(fine, "fast").contour
    middle = blank.moments.first / blank.area
    radius = cut.tool.radius
    flat = max(radius - cut.tool.corner_radius, 0.25 * radius)
    begin = Star.of(grown(blank, radius), middle)
    ends = [Star.of(Contour.circle(each, middle), middle) for each in (radius, INNERMOST * flat)]
    if begin is None or ends[0] is None or ends[1] is None:
        raise GeometryError("the blank is too long and narrow to be faced by a spiral", "stock")
    # Nothing is left within the cutter's radius: there is no engagement to measure.
    paced = spiral(cut, begin, ends[0], 0.0, fine, outward=False)
    wide = begin.distances().highest.value
    longer = (wide - INNERMOST * flat) / (wide - radius)
    morph = replace(paced, b=ends[1], turns=paced.turns * longer)
    turned = fitted(morph, fine)
    circle = Track.arc(turned.end, middle, morph.sense * 2.0 * np.pi)
    level = chained((_entry(morph, turned, radius), turned, circle))
    walk = Walk(cut, heights)
    for z in cut.depths:
        walk.over(level.start)
        walk.down(z)
        walk.follow(level)
    walk.up()
    return walk.moves


# -- inside ---------------------------------------------------------------------------------------
# Clearing of a hole: down by a helix, and outward by a spiral, so that no core comes loose.


HELIX = 0.75
"""Radius of the helix as a share of that within which the cutter is flat: nothing is left in the
middle, and the middle of the cutter, which may not cut, stays out of it."""

WHOLE = 0.95
"""A round hole with a path of at most this share of the cutter's radius is bored by the helix
alone."""

INSIDE_ROOM = 0.5
"""Of the way off the wall, as a share of the cutter's radius."""


def inside(cut: AreaCut, wall: Boundary, heights: Heights, tolerance: float) -> list[Move]:
    """A helix down to each depth in turn, from the middle or round a hole that is there, and from
    it a spiral out to the wall and a full round along it; a narrow round hole by the helix alone.

    Raises
    ------
    GeometryError
        If the cutter is too large for the hole, or no spiral possible.
    """
    fine = coarse(cut, tolerance)
    path = along(wall, cut, fine)
    flat = max(cut.tool.radius - cut.tool.corner_radius, 0.25 * cut.tool.radius)
    star = star_of(path, wall.name)
    least = star.distances().lowest.value
    walk = Walk(cut, heights)
    turned = 2.0 * math.pi if cut.climb else -2.0 * math.pi
    if _is_circle(path) and least <= WHOLE * flat:
        whole = Track.around(path if cut.climb else path.reversed())
        require_clear(whole, wall, cut, fine)
        for above, z in pairwise((cut.top, *cut.depths)):
            descend(walk, whole, above, z)
        walk.follow(whole)
        walk.follow(Track.line(whole.start, 0j))
        walk.up()
        return walk.moves
    hole = _hole(cut, fine)
    middle = min(HELIX * flat, 0.5 * least) if hole is None else min(hole, 0.9 * least)
    finish = flattest_direction(path)
    morph = spiral(cut, _circle(middle), star, finish, fine, outward=True)
    outward = fitted(morph, fine)
    helix = Track.arc(outward.start, 0j, turned)
    last = begun(path, star.along(finish))
    last = last if cut.climb else last.reversed()
    lead = lead_at(
        last,
        INSIDE_ROOM * min(cut.tool.radius, least),
        Beside(free=walk.free, usual=cut.tool.radius),
    )
    off = () if lead is None else (lead.off,)
    # The first round of the spiral begins on that of the helix, whose floor is still sloping.
    first = (helix,) if hole is None else ()
    level = chained((*first, outward, Track.around(last), *off))
    require_clear(level, wall, cut, fine)
    for number, (above, z) in enumerate(pairwise((cut.top, *cut.depths))):
        if number:
            walk.follow(Track.line(walk.place, helix.start))
        if hole is None:
            descend(walk, helix, above, z)
        else:
            if not number:
                walk.above(helix.start)
            walk.down(z)
        walk.follow(level)
    walk.follow(Track.line(walk.place, 0.5 * walk.place))
    walk.up()
    return walk.moves


def _circle(radius: float) -> Star:
    found = Star.of(Contour.circle(radius))
    assert found is not None  # as of every circle about the pole
    return found


def _is_circle(path: Contour) -> bool:
    return bool(np.all(path.sweeps != 0.0) and np.max(np.abs(path.centres)) < SAME)


def _hole(cut: AreaCut, fine: float) -> float | None:
    """Radius [mm] of the cutter's path inside a hole about the axis that is there.

    None without one that it fits into with room to come down.
    """
    found = None
    for each in cut.cleared:
        star = Star.of(each.arcs(fine, "fast").contour)
        if star is not None:
            room = star.distances().lowest.value - cut.tool.radius - 2.0 * fine
            if room > 0.1 * cut.tool.radius:
                found = max(room, found or 0.0)
    return found


# -- moat -----------------------------------------------------------------------------------------
# Clearing around a round boss in full material: a slot along it, widened outward by a spiral.


def moat(cut: Cut, heights: Heights, tolerance: float, effort: Effort) -> list[Move]:  # noqa: ARG001  all strategies are called alike
    """To each depth in turn by a helix along the boss, from there a spiral out to the wall around
    it, and a full round along that.

    Raises
    ------
    GeometryError
        If the cutter is too large for the area, or that is none around a boss.
    """
    if not isinstance(cut, AreaCut) or [wall.hole for wall in cut.walls] != [False, True]:
        raise GeometryError("is cleared around a boss, within a wall", "toolpath", cut.name)
    boss, edge = cut.walls
    fine = coarse(cut, tolerance)
    inner, outer = along(boss, cut, fine), along(edge, cut, fine)
    morph = spiral(
        cut, star_of(inner, boss.name), star_of(outer, edge.name), 0.0, fine, outward=True
    )
    outward = fitted(morph, fine)
    helix = Track.arc(outward.start, 0j, 2.0 * math.pi if cut.climb else -2.0 * math.pi)
    last = begun(outer, morph.b.along(morph.finish))
    level = chained((helix, outward, Track.around(last if cut.climb else last.reversed())))
    for wall in cut.walls:
        require_clear(level, wall, cut, fine)
    # The cutter may pass where it has been, but not over the boss.
    kept = Track.around(Contour.circle(float(np.min(np.abs(inner.vertices))) - fine))
    walk = Walk(cut, heights)
    for number, (above, z) in enumerate(pairwise((cut.top, *cut.depths))):
        if number:
            walk.over(helix.start, kept)
            walk.down(above)
        descend(walk, helix, above, z)
        walk.follow(level)
    walk.up()
    return walk.moves


# -- outside --------------------------------------------------------------------------------------
# Roughing of an outside: a spiral from the outline of the blank to the wall.


MOST_TRIALS, MORE = 20, 0.02
"""Of a depth's spiral, and by which share its turns grow each time."""


def outside(cut: AreaCut, wall: Boundary, heights: Heights, tolerance: float) -> list[Move]:
    """At each depth: from where the cutter first touches the blank once around it after the other,
    ever nearer to the wall, and a full round along it.

    Down in the air beside the blank, and out there again between depths without being lifted: each
    depth begins in the direction in which the one before has ended.

    Raises
    ------
    GeometryError
        If the cutter is too large for the wall, the blank too small, or no spiral possible.
    """
    if cut.stock is None:
        raise GeometryError(f"{cut.name} needs the outline of the blank", "stock")
    fine = coarse(cut, tolerance)
    path = along(wall, cut, fine)
    edge = _edge(cut, cut.stock.arcs(fine, "fast").contour, path)
    begin, end = star_of(edge, "blank"), star_of(path, wall.name)
    walk = Walk(cut, heights)
    morph = spiral(cut, begin, end, flattest_direction(path), fine, outward=False)
    for number, z in enumerate(cut.depths):
        if number:
            morph = _continued(cut, morph, walk.place, fine)
        track = _level(cut, morph, path, fine)
        require_clear(track, wall, cut, fine)
        walk.over(track.start, Track.around(path))
        walk.down(z)
        walk.follow(track)
    walk.up()
    return walk.moves


def spirals(cut: AreaCut, wall: Boundary, tolerance: float) -> bool:
    """Whether rays from the cam axis meet both the wall's path and the edge of the blank once, so
    that a spiral leads from one to the other.

    Raises
    ------
    GeometryError
        If the cutter is too large for the wall, or the blank is not convex.
    """
    assert cut.stock is not None  # the caller has a blank
    fine = coarse(cut, tolerance)
    edge = grown(cut.stock.arcs(fine, "fast").contour, cut.tool.radius)
    return Star.of(edge) is not None and Star.of(along(wall, cut, fine)) is not None


def star_of(contour: Contour, what: str) -> Star:
    """The contour seen from the cam axis.

    Raises
    ------
    GeometryError
        With key "toolpath", if rays from there meet it more than once.
    """
    star = Star.of(contour)
    if star is None:
        raise GeometryError(
            f"the {what} cannot be cleared by a spiral: rays from the cam axis meet the cutter's"
            " path more than once, or nearly along it",
            key="toolpath",
        )
    return star


def flattest_direction(path: Contour) -> float:
    """The direction [rad] of the flattest place of a path."""
    return phase(complex(started(path, next(flattest(path))).vertices[0]))


def off_joints(path: Contour, star: Star, direction: float) -> float:
    """The `direction` [rad] in which a round of the path begins, or that of a joint of its pieces
    next to it: no piece of a round is shorter than `SHORTEST`.
    """
    place = star.along(direction)
    joints = np.concatenate(([0.0], np.cumsum(path.lengths)))
    nearest = int(np.argmin(np.abs(joints - place)))
    if abs(joints[nearest] - place) >= SHORTEST_START:
        return direction
    turned = phase(complex(path.vertices[nearest % len(path)]) * np.exp(-1j * direction))
    return direction + turned


def _level(cut: AreaCut, morph: Morph, path: Contour, fine: float) -> Track:
    """The way at one depth: onto the spiral, along it, once round, and off."""
    morph = replace(morph, finish=off_joints(path, morph.b, morph.finish))
    turned = fitted(morph, fine)
    last = begun(path, morph.b.along(morph.finish))
    if morph.sense < 0:
        last = last.reversed()
    radius = cut.tool.radius
    return chained(
        (_entry(morph, turned, radius), turned, Track.around(last), *_off(last, morph, radius))
    )


def _entry(morph: Morph, turned: Track, radius: float) -> Track:
    """A quarter turn from the air onto the beginning of the spiral."""
    free = -morph.side
    centre = turned.start + free * 1j * turned.headings[0] * ENTRY * radius
    return Track.arc(turned.start, centre, -free * 0.5 * np.pi).reversed()


def _continued(cut: AreaCut, morph: Morph, place: complex, fine: float) -> Morph:
    """The spiral of the next depth: onto it the way is straight out from `place`, where the one
    before it has ended.

    It ends elsewhere, so that it may take slightly more turns to keep the engagement.
    """
    limit = limit_of(cut, fine)
    for _ in range(MOST_TRIALS):
        turned = fitted(morph, fine)
        aside = phase(_entry(morph, turned, cut.tool.radius).start / turned.start)
        finish = phase(place) - aside + morph.sense * 2.0 * np.pi * morph.turns
        morph = replace(morph, finish=finish)
        if float(np.max(engagements(morph, cut.tool.radius))) <= limit:
            break
        morph = replace(morph, turns=morph.turns * (1.0 + MORE))
    return morph


def _off(last: Contour, morph: Morph, radius: float) -> tuple[Track, ...]:
    """The way off the last round, none where there is no room for one."""
    for size in (ENTRY * radius, 0.3 * radius, 0.1 * radius):
        lead = lead_at(last, size, Beside(free=-morph.side, usual=radius))
        if lead is not None:
            return (lead.off,)
    return ()


CORNER = 1e-9
"""Turn [rad] below which two pieces join without a corner."""


def grown(contour: Contour, by: float) -> Contour:
    """The parallel at `by` [mm] outside a convex contour, counter-clockwise, round at its corners.

    Raises
    ------
    GeometryError
        With key "stock", if the contour is not convex.
    """
    contour = contour.counter_clockwise()
    pieces = Track.around(contour).pieces
    leaving, arriving = pieces.tangents(pieces.starts), pieces.tangents(pieces.ends)
    turns = np.angle(leaving * np.conj(np.roll(arriving, 1)))
    if np.any(turns < -CORNER) or np.any(contour.sweeps < 0.0):
        raise GeometryError("the outline of the blank must be convex", "stock")
    vertices: list[complex] = []
    sweeps: list[float] = []
    centres: list[complex] = []
    for k, turn in enumerate(turns.tolist()):
        corner = complex(contour.vertices[k])
        if turn > CORNER:
            vertices.append(corner - 1j * by * complex(arriving[k - 1]))
            sweeps.append(turn)
            centres.append(corner)
        vertices.append(corner - 1j * by * complex(leaving[k]))
        sweeps.append(float(contour.sweeps[k]))
        centres.append(complex(contour.centres[k]))
    return Contour(np.array(vertices), np.array(sweeps), np.array(centres))


def _edge(cut: AreaCut, blank: Contour, path: Contour) -> Contour:
    """The path on which the cutter touches the blank, or all round outside the last path.

    Raises
    ------
    GeometryError
        With key "stock", if the blank does not contain the part with its allowance.
    """
    radius = cut.tool.radius
    edge = grown(blank, radius)
    outer, inner = star_of(edge, "blank"), star_of(path, "wall")
    lacking = inner.distances(beyond=outer).highest.value
    if lacking > 0.5 * radius:
        raise GeometryError(
            f"the blank is too small: {lacking:.3g} mm are missing at one side of the part",
            key="stock",
        )
    if lacking >= 0.0:
        edge = grown(blank, radius + 1.1 * lacking + 1e-3)
    return edge


# -- ring -----------------------------------------------------------------------------------------
# Clearing of a groove: a slot along its middle, widened on both sides towards the walls.


def ring(
    cut: AreaCut, solid: Boundary, hole: Boundary, heights: Heights, tolerance: float
) -> list[Move]:
    """Between a wall around it, `hole`, and one within it, `solid`, which are parallel.

    To each depth in turn along the middle, and from there rounds nearer to the outer wall, then
    back and nearer to the inner one, each by climb milling.

    Raises
    ------
    GeometryError
        If the cutter is too large for the groove, or there are more than `MOST_TURNS` rounds.
    """
    fine = coarse(cut, tolerance)
    outer, inner = (Track.around(each.arcs(tolerance, "fast").contour) for each in (hole, solid))
    width = least_distance(outer, inner)
    play = width - cut.tool.diameter - 2.0 * cut.allowance - 2.0 * SPENT * fine
    if play < 0.0:
        raise GeometryError(
            f"the cutter must be narrower than the groove of {width:.4g} mm with the allowances on"
            " both sides",
            key="tool",
            value=f"{cut.tool.diameter:g}",
        )
    if 0.5 * play > MOST_TURNS * cut.stepover:
        message = f"makes more than {MOST_TURNS} rounds on each side of the groove's middle"
        raise GeometryError(message, "tool.stepover", f"{cut.stepover:g}")
    count = math.ceil(0.5 * play / cut.stepover)
    offs = [0.5 * play * (count - k) / count for k in range(1, count + 1)] if count else []
    middle = _begun(along(hole, cut, fine, 0.5 * play), climb=cut.climb)
    point = middle.start
    sides = [
        [_beside(wall, along(wall, cut, fine, off), point, ccw=ccw) for off in offs]
        for wall, ccw in ((hole, cut.climb), (solid, not cut.climb))
    ]
    for track in (middle, *sides[0], *sides[1]):
        for wall in (hole, solid):
            require_clear(track, wall, cut, fine)
    walk = Walk(cut, heights)
    walk.above(point)
    walk.down(cut.top)
    for above, z in pairwise((cut.top, *cut.depths)):
        for end in descent(cut, above, z, middle.length):
            walk.follow(middle, end, both=True)
        walk.follow(middle, both=True)
        for rounds in sides:
            for track in rounds:
                walk.follow(Track.line(walk.place, track.start))
                walk.follow(track)
            walk.follow(Track.line(walk.place, point))
    walk.up()
    return walk.moves


def _begun(path: Contour, *, climb: bool) -> Track:
    path = started(path, next(flattest(path)))
    return Track.around(path if climb else path.reversed())


def _beside(wall: Boundary, path: Contour, point: complex, *, ccw: bool) -> Track:
    """Once round a path, from where the ray through `point` meets it."""
    star = star_of(path, wall.name)
    path = begun(path, star.along(off_joints(path, star, phase(point))))
    return Track.around(path if ccw else path.reversed())
