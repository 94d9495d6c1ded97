"""Areas between walls and the outline of the blank, each cleared by the strategy that its walls ask
for: an outside, a hole, a ring between two walls, or a face without walls.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Self

import numpy as np

from camgeo.errors import GeometryError
from camgeo.geometry.contour.contour import Contour, Effort, least_distance
from camgeo.milling.cut import AreaCut
from camgeo.milling.track import (
    FLAT,
    LeadSpec,
    Track,
    begin_at_distance,
    begin_in_piece,
    chain_tracks,
    fit_leads,
    flattest,
)
from camgeo.milling.walk import (
    SAME,
    SPENT,
    ToolpathBuilder,
    along,
    coarse,
    cut_of_kind,
    descend,
    descent,
    engagement_limit,
    require_clear,
)
from camgeo.numeric.arrays import ComplexArray, FloatArray, Side, ascending, phase
from camgeo.numeric.extremes import Extremes, piecewise_extremes
from camgeo.part.part import Boundary
from camgeo.units import TURN


def clear(builder: ToolpathBuilder, tolerance: float, effort: Effort) -> None:  # noqa: ARG001  all strategies are called alike
    """The moves that clear an area; its paths are fitted fast, and coarsely within the allowance.

    Raises
    ------
    GeometryError
        If the cutter is too large for the area, or no strategy clears an area with such walls.
    """
    cut = cut_of_kind(builder.cut, AreaCut, "clears an area")
    holes = [wall for wall in cut.walls if wall.hole]
    solids = [wall for wall in cut.walls if not wall.hole]
    match solids, holes:
        case [], []:
            face(builder, cut, tolerance)
        case [solid], []:
            outside(builder, cut, solid, tolerance)
        case [], [hole]:
            inside(builder, cut, hole, tolerance)
        case [solid], [hole]:
            ring(builder, cut, solid, hole, tolerance)
        case _:
            names = ", ".join(wall.name for wall in cut.walls)
            raise GeometryError(
                "an area may have at most one wall around it and one within it", "part", names
            )


# -- face -----------------------------------------------------------------------------------------
# Facing: the whole upper face of the blank by a spiral from outside inward.


ENTRY = 0.75
"""Radius of the quarter turns into the blank, as a share of the cutter's; and the room of the lead
off what is left, if there is as much."""

INNERMOST = 0.9
"""Radius of the last round as a share of that within which the cutter is flat."""


def face(builder: ToolpathBuilder, cut: AreaCut, tolerance: float) -> None:
    """At each depth the cutter goes down in the air beside the blank, and spirals inward to its
    middle.

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
    begin = Star.from_contour(grown(blank, radius), middle)
    ends = [
        Star.from_contour(Contour.circle(end_radius, middle), middle)
        for end_radius in (radius, INNERMOST * flat)
    ]
    if begin is None or ends[0] is None or ends[1] is None:
        raise GeometryError("the blank is too long and narrow to be faced by a spiral", "stock")
    # Within the cutter's radius of the middle nothing is left, so the engagement is paced only up
    # to there; the last bit inward is run at the same pace per turn.
    paced = spiral(cut, begin, ends[0], 0.0, fine, outward=False)
    wide = begin.distances().highest.value
    longer = (wide - INNERMOST * flat) / (wide - radius)
    morph = replace(paced, b=ends[1], turns=paced.turns * longer)
    turned = fit_spiral(morph, fine)
    circle = Track.arc(turned.end, middle, morph.sense * 2.0 * np.pi)
    level = chain_tracks((_entry(morph, turned, radius), turned, circle))
    for z in cut.depths:
        builder.link(level.start)
        builder.lower(z)
        builder.follow(level)


# -- inside ---------------------------------------------------------------------------------------
# Clearing of a hole: down by a helix, and outward by a spiral, so that no core comes loose.


HELIX = 0.75
"""Radius of the helix as a share of that within which the cutter is flat: nothing is left in the
middle, and the middle of the cutter, which may not cut, stays out of it."""

WHOLE = 0.95
"""A round hole with a path of at most this share of the cutter's radius is bored by the helix
alone."""

INSIDE_ROOM = 0.5
"""Room of the lead off the wall of a hole, as a share of the cutter's radius."""


def inside(builder: ToolpathBuilder, cut: AreaCut, wall: Boundary, tolerance: float) -> None:
    """To each depth in turn by a helix, near the middle or around a hole of the blank; from there a
    spiral out to the wall and a full round along it. A narrow round hole is made by the helix
    alone.

    Raises
    ------
    GeometryError
        If the cutter is too large for the hole, or no spiral possible.
    """
    fine = coarse(cut, tolerance)
    path = along(wall, cut, fine)
    # A ball mill has no flat end: then a quarter of the radius is used.
    flat = max(cut.tool.radius - cut.tool.corner_radius, 0.25 * cut.tool.radius)
    star = require_star(path, wall.name)
    least = star.distances().lowest.value
    turned = 2.0 * math.pi if cut.climb else -2.0 * math.pi
    if _is_circle(path) and least <= WHOLE * flat:
        whole = Track.around(path if cut.climb else path.reversed())
        require_clear(whole, wall, cut, fine)
        for above, z in pairwise((cut.top, *cut.depths)):
            descend(builder, whole, above, z)
        builder.follow(whole)
        builder.follow(Track.line(whole.start, 0j))
        return
    hole = _hole(cut, fine)
    middle = min(HELIX * flat, 0.5 * least) if hole is None else min(hole, 0.9 * least)
    finish = flattest_direction(path)
    outward = fit_spiral(
        spiral(
            cut, require_star(Contour.circle(middle), "helix"), star, finish, fine, outward=True
        ),
        fine,
    )
    helix = Track.arc(outward.start, 0j, turned)
    last = begin_at_distance(path, star.along(finish))
    last = last if cut.climb else last.reversed()
    lead = fit_leads(
        last,
        INSIDE_ROOM * min(cut.tool.radius, least),
        LeadSpec(free=builder.free, usual=cut.tool.radius),
    )
    lead_off_track = () if lead is None else (lead.exit,)
    # A round at depth first: the helix has left a sloping floor, on which the spiral would begin.
    first = (helix,) if hole is None else ()
    level = chain_tracks((*first, outward, Track.around(last), *lead_off_track))
    require_clear(level, wall, cut, fine)
    for number, (above, z) in enumerate(pairwise((cut.top, *cut.depths))):
        if number:
            builder.follow(Track.line(builder.place, helix.start))
        if hole is None:
            descend(builder, helix, above, z)
        else:
            if not number:
                builder.traverse(helix.start)
            builder.lower(z)
        builder.follow(level)
    # Off the wall, half way to the cam axis, before the cutter is lifted.
    builder.follow(Track.line(builder.place, 0.5 * builder.place))


def _is_circle(path: Contour) -> bool:
    return bool(np.all(path.sweeps != 0.0) and np.max(np.abs(path.centres)) < SAME)


def _hole(cut: AreaCut, fine: float) -> float | None:
    """Radius [mm] of a path of the cutter's centre inside the largest hole of the blank.

    None if the cutter does not fit into any with room to come down.
    """
    largest = None
    for boundary in cut.cleared:
        star = Star.from_contour(boundary.arcs(fine, "fast").contour)
        if star is not None:
            room = star.distances().lowest.value - cut.tool.radius - 2.0 * fine
            if room > 0.1 * cut.tool.radius:
                largest = max(room, largest or 0.0)
    return largest


# -- moat -----------------------------------------------------------------------------------------
# Clearing around a round boss in full material: a slot along it, widened outward by a spiral.


def moat(builder: ToolpathBuilder, tolerance: float, effort: Effort) -> None:  # noqa: ARG001  all strategies are called alike
    """To each depth in turn by a helix along the boss, from there a spiral out to the wall around
    it, and a full round along that.

    Raises
    ------
    GeometryError
        If the cutter is too large for the area, or that is none around a boss.
    """
    cut = builder.cut
    if not isinstance(cut, AreaCut) or [wall.hole for wall in cut.walls] != [False, True]:
        raise GeometryError(
            "must be cleared between a boss and a wall around it", "toolpath", cut.name
        )
    boss, edge = cut.walls
    fine = coarse(cut, tolerance)
    inner, outer = along(boss, cut, fine), along(edge, cut, fine)
    morph = spiral(
        cut, require_star(inner, boss.name), require_star(outer, edge.name), 0.0, fine, outward=True
    )
    outward = fit_spiral(morph, fine)
    helix = Track.arc(outward.start, 0j, 2.0 * math.pi if cut.climb else -2.0 * math.pi)
    last = begin_at_distance(outer, morph.b.along(morph.finish))
    level = chain_tracks((helix, outward, Track.around(last if cut.climb else last.reversed())))
    for wall in cut.walls:
        require_clear(level, wall, cut, fine)
    # Between depths the cutter passes over what it has cleared, but not across the boss: the circle
    # lies within the cutter's innermost path.
    barrier = Track.around(Contour.circle(float(np.min(np.abs(inner.vertices))) - fine))
    for number, (above, z) in enumerate(pairwise((cut.top, *cut.depths))):
        if number:
            builder.link(helix.start, barrier)
            builder.lower(above)
        descend(builder, helix, above, z)
        builder.follow(level)


# -- outside --------------------------------------------------------------------------------------
# Roughing of an outside: a spiral from the outline of the blank to the wall.


SHORTEST_START = 0.05
"""Least length of a piece at which a round begins [mm]: shorter ones could vanish in rounding."""

MOST_TRIALS, MORE = 20, 0.02
"""Trials of the spiral of the next depth, and the share by which its turns grow each time."""


def outside(builder: ToolpathBuilder, cut: AreaCut, wall: Boundary, tolerance: float) -> None:
    """At each depth a spiral from where the cutter first touches the blank to the wall, and a full
    round along the wall.

    The cutter goes down in the air beside the blank, and returns there between depths without being
    lifted: each depth begins in the direction in which the previous one has ended.

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
    begin, end = require_star(edge, "blank"), require_star(path, wall.name)
    morph = spiral(cut, begin, end, flattest_direction(path), fine, outward=False)
    for number, z in enumerate(cut.depths):
        if number:
            morph = _next_depth_spiral(cut, morph, builder.place, fine)
        track = _depth_track(cut, morph, path, fine)
        require_clear(track, wall, cut, fine)
        builder.link(track.start, Track.around(path))
        builder.lower(z)
        builder.follow(track)


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
    return (
        Star.from_contour(edge) is not None
        and Star.from_contour(along(wall, cut, fine)) is not None
    )


def require_star(contour: Contour, what: str) -> Star:
    """The contour as distances from the cam axis; `what` names it in messages.

    Raises
    ------
    GeometryError
        With key "toolpath", if rays from there meet it more than once.
    """
    star = Star.from_contour(contour)
    if star is None:
        raise GeometryError(
            f"the {what} cannot be cleared by a spiral: rays from the cam axis meet the cutter's"
            " path more than once, or at too flat an angle",
            key="toolpath",
        )
    return star


def flattest_direction(path: Contour) -> float:
    """The direction [rad] of the flattest place of a path."""
    return phase(complex(begin_in_piece(path, next(flattest(path))).vertices[0]))


def avoid_joints(path: Contour, star: Star, direction: float) -> float:
    """The `direction` [rad] in which a round of the path may begin: as given, or that of the
    nearest joint of its pieces if that is closer than `SHORTEST_START`, so that no piece is
    shorter.
    """
    place = star.along(direction)
    joints = np.concatenate(([0.0], np.cumsum(path.lengths)))
    nearest = int(np.argmin(np.abs(joints - place)))
    if abs(joints[nearest] - place) >= SHORTEST_START:
        return direction
    turned = phase(complex(path.vertices[nearest % len(path)]) * np.exp(-1j * direction))
    return direction + turned


def _depth_track(cut: AreaCut, morph: Morph, path: Contour, fine: float) -> Track:
    """The track at one depth: onto the spiral, along it, once round the wall, and off."""
    morph = replace(morph, finish=avoid_joints(path, morph.b, morph.finish))
    turned = fit_spiral(morph, fine)
    last = begin_at_distance(path, morph.b.along(morph.finish))
    if morph.sense < 0:
        last = last.reversed()
    radius = cut.tool.radius
    return chain_tracks(
        (_entry(morph, turned, radius), turned, Track.around(last), *_exit(last, morph, radius))
    )


def _entry(morph: Morph, turned: Track, radius: float) -> Track:
    """A quarter turn from the air onto the beginning of the spiral."""
    # Built backwards from the spiral's start: the reverse of a turn away from the material.
    free = -morph.side
    centre = turned.start + free * 1j * turned.headings[0] * ENTRY * radius
    return Track.arc(turned.start, centre, -free * 0.5 * np.pi).reversed()


def _next_depth_spiral(cut: AreaCut, morph: Morph, place: complex, fine: float) -> Morph:
    """The spiral of the next depth: onto it the way is straight out from `place`, where the one
    before it has ended.

    It ends elsewhere, so that it may take slightly more turns to keep the engagement.
    """
    limit = engagement_limit(cut, fine)
    for _ in range(MOST_TRIALS):
        turned = fit_spiral(morph, fine)
        # The start of the entry arc must lie in the direction of `place`; seen from the cam axis it
        # is `aside` of the spiral's start, which lies all turns before the finish.
        aside = phase(_entry(morph, turned, cut.tool.radius).start / turned.start)
        finish = phase(place) - aside + morph.sense * 2.0 * np.pi * morph.turns
        morph = replace(morph, finish=finish)
        if float(np.max(engagements(morph, cut.tool.radius))) <= limit:
            break
        morph = replace(morph, turns=morph.turns * (1.0 + MORE))
    return morph


def _exit(last: Contour, morph: Morph, radius: float) -> tuple[Track, ...]:
    """The lead off the last round, as large as there is room for; empty if there is none."""
    for size in (ENTRY * radius, 0.3 * radius, 0.1 * radius):
        lead = fit_leads(last, size, LeadSpec(free=-morph.side, usual=radius))
        if lead is not None:
            return (lead.exit,)
    return ()


CORNER = 1e-9
"""Turn [rad] below which two pieces join without a corner."""


def grown(contour: Contour, distance: float) -> Contour:
    """The parallel at `distance` [mm] outside a convex contour, counter-clockwise, its corners
    round.

    Raises
    ------
    GeometryError
        With key "stock", if the contour is not convex.
    """
    contour = contour.counter_clockwise()
    pieces = Track.around(contour).pieces
    leaving, arriving = pieces.tangents(pieces.starts), pieces.tangents(pieces.ends)
    # Turn at the start of each piece, from the end of the one before it.
    turns = np.angle(leaving * np.conj(np.roll(arriving, 1)))
    if np.any(turns < -CORNER) or np.any(contour.sweeps < 0.0):
        raise GeometryError("the outline of the blank must be convex", "stock")
    vertices: list[complex] = []
    sweeps: list[float] = []
    centres: list[complex] = []
    for k, turn in enumerate(turns.tolist()):
        corner = complex(contour.vertices[k])
        if turn > CORNER:  # the parallel rolls around the corner
            vertices.append(corner - 1j * distance * complex(arriving[k - 1]))
            sweeps.append(turn)
            centres.append(corner)
        # -1j times the heading points outward, as the contour runs counter-clockwise.
        vertices.append(corner - 1j * distance * complex(leaving[k]))
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
    outer, inner = require_star(edge, "blank"), require_star(path, "wall")
    lacking = inner.distances(beyond=outer).highest.value
    if lacking > 0.5 * radius:
        raise GeometryError(
            f"the blank is too small: {lacking:.3g} mm are missing at one side of the part",
            key="stock",
        )
    if lacking >= 0.0:
        # Slightly farther out than what is missing: the spiral begins outside of the path all
        # round.
        edge = grown(blank, radius + 1.1 * lacking + 1e-3)
    return edge


# -- ring -----------------------------------------------------------------------------------------
# Clearing of a groove: a slot along its middle, widened on both sides towards the walls.


def ring(
    builder: ToolpathBuilder, cut: AreaCut, solid: Boundary, hole: Boundary, tolerance: float
) -> None:
    """A groove between an outer wall, `hole`, and an inner one, `solid`, which are parallel.

    At each depth first a slot along the middle, then rounds ever nearer to the outer wall, then
    rounds ever nearer to the inner one, all by climb milling.

    Raises
    ------
    GeometryError
        If the cutter is too large for the groove, or there are more than `MOST_TURNS` rounds.
    """
    fine = coarse(cut, tolerance)
    outer, inner = (Track.around(wall.arcs(tolerance, "fast").contour) for wall in (hole, solid))
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
        raise GeometryError(
            f"is too small: more than {MOST_TURNS} rounds would be needed on each side of the"
            " groove's middle",
            "tool.stepover",
            f"{cut.stepover:g}",
        )
    # On each side equal steps, the last of which ends at the allowance itself, offset 0.
    count = math.ceil(0.5 * play / cut.stepover)
    offsets = [0.5 * play * (count - k) / count for k in range(1, count + 1)] if count else []
    middle = _middle_track(along(hole, cut, fine, 0.5 * play), climb=cut.climb)
    point = middle.start
    sides = [
        [
            _round_from_ray(wall, along(wall, cut, fine, offset), point, ccw=ccw)
            for offset in offsets
        ]
        for wall, ccw in ((hole, cut.climb), (solid, not cut.climb))
    ]
    for track in (middle, *sides[0], *sides[1]):
        for wall in (hole, solid):
            require_clear(track, wall, cut, fine)
    builder.traverse(point)
    builder.lower(cut.top)
    for above, z in pairwise((cut.top, *cut.depths)):
        for end in descent(cut, above, z, middle.length):
            builder.follow(middle, end, both=True)
        builder.follow(middle, both=True)
        for rounds in sides:
            for track in rounds:
                builder.follow(Track.line(builder.place, track.start))
                builder.follow(track)
            builder.follow(Track.line(builder.place, point))


def _middle_track(path: Contour, *, climb: bool) -> Track:
    path = begin_in_piece(path, next(flattest(path)))
    return Track.around(path if climb else path.reversed())


def _round_from_ray(wall: Boundary, path: Contour, point: complex, *, ccw: bool) -> Track:
    """One round of a path along `wall`, from where the ray through `point` meets it."""
    star = require_star(path, wall.name)
    path = begin_at_distance(path, star.along(avoid_joints(path, star, phase(point))))
    return Track.around(path if ccw else path.reversed())


# -- spiral ---------------------------------------------------------------------------------------
# Spirals between contours that rays from a pole meet once.
#
# In each direction the distance from the pole is r = (1 - u) a + u b, with a the curve at which the
# cutter first touches the stock and b that on which the cut ends. u grows evenly with the angle
# turned, or ever more slowly where the end is what limits the pace, as at hollow flanks; it eases
# into 1, where the path joins b along its tangent.
#
# The cutter's engagement is measured on what the turn before has left: the arc of its circle from
# the point where it makes the new wall forward to where it crosses the wall of that turn, and in
# the first turn that of the stock.


PER_TURN = 720
"""Places per turn at which the engagement is measured for pacing."""

EASE = 0.25
"""Turns over which the spiral eases into the curve on which it ends."""

MOST_TURNS = 500
"""Most turns of a spiral: if more are needed, the stepover is far too small for the stock."""

NEARLY = 0.01
"""Turns by which a spiral may be longer than it has to."""

SLOWINGS = (0.2, 0.35, 0.5)
"""Values of `Morph.slowing` that are tried; each is taken only if it saves `WORTH` turns."""

WORTH = 0.2

PLACES = (0.1, 0.2, 0.3, 0.4, 0.6, 0.7, 0.8, 0.9)
"""Shares of a span at which a fit is compared with the spiral."""

SPANS, MOST_SPANS = 8, 4096
"""Biarcs per turn with which a fit begins, and at most."""


@dataclass(frozen=True, slots=True)
class Morph:
    """The spiral r = (1 - u) a + u b; `w` is the angle turned along it [rad], 0 where u is 0.

    Attributes
    ----------
    a, b : where it begins and where it ends, about the same pole.
    sense : 1 counter-clockwise, -1 clockwise.
    side : where the material is, -1 on the right of the path, as in climb milling, 1 on its left.
    finish : direction [rad] in which it joins b.
    turns : number of turns from a to b.
    slowing : share of its first pace, 0 to 1, that it has lost where it begins to ease into b.
    """

    a: Star
    b: Star
    sense: int
    side: int
    finish: float
    turns: float
    slowing: float = 0.0

    @property
    def ease(self) -> float:
        """Turns over which it eases into b."""
        return min(EASE, 0.5 * self.turns)

    @property
    def rate(self) -> float:
        """Growth of u per turn at the beginning, where it is largest."""
        # The integral of the pace over all turns is 1: it falls evenly from `rate` to the share
        # 1 - slowing, and over the turns of easing from there to 0.
        plain = self.turns - self.ease
        return 1.0 / (plain * (1.0 - 0.5 * self.slowing) + 0.5 * self.ease * (1.0 - self.slowing))

    def share(self, turn: FloatArray) -> tuple[FloatArray, FloatArray]:
        """(m,) u and its derivative at `turn` (m,), in turns; 0 before 0 and 1 beyond `turns`."""
        left = self.turns - turn
        ease, rate, lost = self.ease, self.rate, self.slowing / (self.turns - self.ease)
        last = rate * (1.0 - self.slowing)
        u = np.where(
            left < ease, 1.0 - 0.5 * last * left**2 / ease, rate * turn * (1.0 - 0.5 * lost * turn)
        )
        slope = np.where(left < ease, last * left / ease, rate * (1.0 - lost * turn))
        u = np.where(turn <= 0.0, 0.0, np.where(left <= 0.0, 1.0, u))
        return u, np.where((turn < 0.0) | (left <= 0.0), 0.0, slope)

    def points_and_tangents(self, turn: FloatArray) -> tuple[ComplexArray, ComplexArray]:
        """(m,) complex points [mm] and unit tangents at `turn` (m,), in turns from where u leaves
        0.
        """
        direction = self.finish + self.sense * 2.0 * np.pi * (turn - self.turns)
        (ra, sa), (rb, sb) = self.a.radii_and_slopes(direction), self.b.radii_and_slopes(direction)
        u, slope = self.share(turn)
        r = (1.0 - u) * ra + u * rb
        # dr per radian turned: u changes by slope / 2 pi; the curves' own slopes are by direction,
        # which runs with `sense`.
        growth = slope / (2.0 * np.pi) * (rb - ra) + self.sense * ((1.0 - u) * sa + u * sb)
        ray = np.exp(1j * direction)
        along = ray * (growth + 1j * self.sense * r)
        return self.a.pole + ray * r, along / np.abs(along)


def engagements(morph: Morph, radius: float, per_turn: int = PER_TURN) -> FloatArray:
    """(m,) [rad] engagement of a cutter of `radius` [mm] at even steps along `morph`.

    From its beginning to one turn beyond its end; 0 where the cutter runs in air.
    """
    count = math.ceil((morph.turns + 1.0) * per_turn)
    turn = np.arange(-per_turn, count + 1) / per_turn
    points, tangents = morph.points_and_tangents(turn)
    # The wall that the cutter makes lies on the side of the material. One turn earlier the spiral
    # was `per_turn` places before, beside the same ray; the first of these turns runs along a.
    walls = points + 1j * morph.side * tangents * radius
    now = np.arange(per_turn, len(turn))
    centre, normal = points[now], 1j * morph.side * tangents[now]
    angles = np.zeros(len(now))
    inside = np.abs(walls[now - per_turn] - centre) < radius
    # Forward along the wall of the turn before until it leaves the cutter's circle.
    previous_points = walls[now - per_turn]
    waiting = np.flatnonzero(inside)
    for step in range(1, per_turn):
        ahead = np.minimum(now[waiting] - per_turn + step, now[waiting])
        next_points = walls[ahead]
        is_outside = np.abs(next_points - centre[waiting]) >= radius
        crossed = waiting[is_outside]
        start, way = (
            previous_points[crossed] - centre[crossed],
            next_points[is_outside] - previous_points[crossed],
        )
        # The point between the two on the circle, |start + share way| = radius: the positive root,
        # as the start lies inside.
        half, square = (np.conj(start) * way).real, np.abs(way) ** 2
        rest = radius**2 - np.abs(start) ** 2
        share = (np.sqrt(half**2 + square * rest) - half) / np.where(square > 0.0, square, 1.0)
        arm = start + np.clip(share, 0.0, 1.0) * way
        angles[crossed] = -morph.side * np.angle(arm * np.conj(normal[crossed]))
        previous_points[waiting] = next_points
        waiting = waiting[~is_outside]
        if not len(waiting):
            break
    angles[waiting] = np.pi  # the wall never leaves the circle
    return np.maximum(angles, 0.0)


def spiral(
    cut: AreaCut, a: Star, b: Star, finish: float, tolerance: float, *, outward: bool
) -> Morph:
    """The spiral from a to b, outward in a hole, that ends in the direction `finish` [rad]."""
    return shortest_spiral(
        a,
        b,
        sense=1 if outward == cut.climb else -1,
        side=-1 if cut.climb else 1,
        finish=finish,
        radius=cut.tool.radius,
        limit=engagement_limit(cut, tolerance),
        # No more than the flat end is wide, so that no ridges stay between turns; a ball has none.
        step=min(cut.stepover, 2.0 * (cut.tool.radius - cut.tool.corner_radius) or cut.stepover),
    )


def shortest_spiral(
    a: Star,
    b: Star,
    *,
    sense: int,
    side: int,
    finish: float,
    radius: float,
    limit: float,
    step: float,
) -> Morph:
    """The shortest spiral whose engagement is at most `limit` [rad] and whose turns lie at most
    `step` [mm] apart along any ray.

    Raises
    ------
    GeometryError
        If that takes more than `MOST_TURNS`.
    """
    rays = np.linspace(0.0, 2.0 * np.pi, PER_TURN, endpoint=False)
    # The pitch of the turns along a ray is at most `rate` times the distance between a and b.
    travel = float(np.max(np.abs(a.radii_and_slopes(rays)[0] - b.radii_and_slopes(rays)[0])))
    fewest = max(travel / step, 1e-3)
    if fewest > MOST_TURNS:
        raise GeometryError(
            f"is too small: the roughing spiral would need more than {MOST_TURNS} turns",
            key="tool.stepover",
            value=f"{step:g}",
        )

    # Without slowing, 1 / rate is the number of turns less half of those in which it eases.
    plain = Morph(a, b, sense, side, finish, fewest + 0.5 * min(EASE, fewest))

    def holds(morph: Morph) -> bool:
        if morph.rate * travel > step * (1.0 + 1e-9):
            return False
        return float(np.max(engagements(morph, radius))) <= limit

    best = _fewest_turns(plain, MOST_TURNS, holds)
    if best is None:
        raise GeometryError(
            f"is too small: no roughing spiral of up to {MOST_TURNS} turns stays below it",
            "tool.engagement",
            f"{math.degrees(limit):g}",
        )
    for slowing in SLOWINGS:
        shorter = replace(best, turns=best.turns - WORTH, slowing=slowing)
        if shorter.turns > plain.turns and holds(shorter):
            best = _fewest_turns(replace(plain, slowing=slowing), best.turns, holds) or shorter
    return best


def _fewest_turns(morph: Morph, most: float, holds: Callable[[Morph], bool]) -> Morph | None:
    """The spiral with the fewest turns for which `holds` is true, at least its own and about `most`
    at most; None if there is none.
    """
    if holds(morph):
        return morph
    low = high = morph.turns
    while not holds(replace(morph, turns=high)):
        if high > most:
            return None
        low, high = high, 1.3 * high + 0.5
    while high - low > NEARLY:
        middle = 0.5 * (low + high)
        if holds(replace(morph, turns=middle)):
            high = middle
        else:
            low = middle
    return replace(morph, turns=high)


def fit_spiral(morph: Morph, tolerance: float) -> Track:
    """The spiral as tangential arcs within `tolerance` [mm] of it, from its beginning to where it
    joins b.

    Distances are measured at `PLACES` of each span, and a fifth of the tolerance is kept in reserve
    for places between them. How near the arcs come to the part is proved from the arcs themselves.
    """
    spans = max(2, math.ceil(SPANS * morph.turns))
    joints = np.linspace(0.0, morph.turns, spans + 1)
    # A joint where the curvature jumps, and no short span beside it.
    easing = morph.turns - morph.ease
    joints[1 + int(np.argmin(np.abs(joints[1:-1] - easing)))] = easing
    most = MOST_SPANS * math.ceil(morph.turns)
    while len(joints) <= most:
        points, tangents = morph.points_and_tangents(joints)
        track = biarcs(points, tangents)
        coarse = np.zeros(len(joints) - 1, dtype=np.bool_)
        for share in PLACES:
            there, _ = morph.points_and_tangents(joints[:-1] + share * np.diff(joints))
            coarse |= _span_distances(there, track) > 0.8 * tolerance
        if not np.any(coarse):
            return track
        middles = 0.5 * (joints[:-1] + joints[1:])[coarse]
        joints = np.sort(np.concatenate((joints, middles)))
    raise GeometryError(f"cannot follow the spiral within {tolerance:g} mm", "toolpath")


def _span_distances(points: ComplexArray, track: Track) -> FloatArray:
    """(n,) distance [mm] of each point from the two arcs of its span."""
    nearest = np.empty(len(points))
    for parity in (0, 1):
        pieces = slice(parity, None, 2)
        start, end = track.starts[pieces], track.ends[pieces]
        sweep, centre = track.sweeps[pieces], track.centres[pieces]
        # Distance from the chord's line, or from the arc's circle: within a span that is the arc.
        line = np.abs((np.conj(end - start) * (points - start)).imag) / np.abs(end - start)
        distance = np.where(
            sweep == 0.0, line, np.abs(np.abs(points - centre) - np.abs(start - centre))
        )
        nearest = distance if parity == 0 else np.minimum(nearest, distance)
    return nearest


def biarcs(points: ComplexArray, tangents: ComplexArray) -> Track:
    """Two arcs of equal tangent length between each pair of neighbouring `points`.

    Parameters
    ----------
    points : (n,) complex [mm], distinct neighbours.
    tangents : (n,) unit, less than half a turn between neighbours.
    """
    start, end = points[:-1], points[1:]
    chord, both = end - start, tangents[:-1] + tangents[1:]
    # Equal tangent lengths d at both ends: |chord - d (t0 + t1)| = 2 d.
    square = np.abs(chord) ** 2
    along = (np.conj(chord) * both).real
    opening = 2.0 * (1.0 - (np.conj(tangents[:-1]) * tangents[1:]).real)
    length = square / (along + np.sqrt(along * along + opening * square))
    middle = 0.5 * (start + end + length * (tangents[:-1] - tangents[1:]))
    across = (chord - length * both) / (2.0 * length)
    vertices = np.append(np.column_stack((start, middle)).ravel(), points[-1])
    return tangential(vertices, np.column_stack((tangents[:-1], across)).ravel())


def tangential(vertices: ComplexArray, tangents: ComplexArray) -> Track:
    """The arcs between `vertices` (n + 1,) [mm] that leave in the directions `tangents` (n,), of
    length 1.
    """
    # The angle between tangent and chord is half the sweep; sagitta = chord / 2 tan(half / 2),
    # about chord * half / 4.
    chords = np.diff(vertices)
    half = np.angle(chords * np.conj(tangents))
    lengths = np.abs(chords)
    flat = lengths * np.abs(half) <= 4.0 * FLAT
    radii = lengths / (2.0 * np.sin(np.where(flat, 1.0, half)))
    centres = np.where(flat, 0.0, vertices[:-1] + 1j * tangents * radii)
    return Track(vertices, np.where(flat, 0.0, 2.0 * half), centres)


# -- star -----------------------------------------------------------------------------------------
# Closed contours that every ray from a pole meets once: their distance from it by direction.


STEEPEST = 0.05
"""Least cosine of the angle between a ray's normal and the contour: a steeper one is refused."""

SPLIT = 0.5 * np.pi
"""Arcs are cut into parts of at most this sweep, so that none reaches round its centre."""


@dataclass(frozen=True, slots=True, eq=False)
class Star:
    """A contour by its distance from a pole, over the direction; every ray meets it once.

    Attributes
    ----------
    pole : complex [mm].
    angles : (n,) [rad] directions at which the pieces begin, ascending from `angles[0]` over less
        than one turn.
    starts, ends, centres : (n,) complex [mm] of the pieces, relative to the pole.
    sweeps : (n,) [rad].
    """

    pole: complex
    angles: FloatArray
    starts: ComplexArray
    ends: ComplexArray
    centres: ComplexArray
    sweeps: FloatArray

    @classmethod
    def from_contour(cls, contour: Contour, pole: complex = 0j) -> Self | None:
        """The contour as distances from `pole` [mm].

        None if some ray may meet it more than once, or nearly along it.
        """
        pieces = contour.counter_clockwise().split(SPLIT)
        starts, ends = pieces.vertices - pole, pieces.ends - pole
        centres, sweeps = pieces.centres - pole, pieces.sweeps
        turns = np.angle(ends * np.conj(starts))
        if np.min(_uprightness(starts, ends, centres, sweeps)) < STEEPEST:
            return None
        if np.any(turns <= 0.0) or abs(float(np.sum(turns)) - 2.0 * np.pi) > 1e-6:
            return None
        angles = float(np.angle(starts[0])) + np.concatenate(([0.0], np.cumsum(turns)[:-1]))
        return cls(pole, angles, starts, ends, np.where(sweeps == 0.0, 0.0, centres), sweeps)

    def radii_and_slopes(self, directions: FloatArray) -> tuple[FloatArray, FloatArray]:
        """(m,) distances r [mm] from the pole in `directions` (m,) [rad], and dr/d(direction)."""
        ahead = np.mod(directions - self.angles[0], 2.0 * np.pi) + self.angles[0]
        index = np.clip(np.searchsorted(self.angles, ahead, "right") - 1, 0, len(self.angles) - 1)
        ray = np.exp(1j * directions)
        start, centre, sweep = self.starts[index], self.centres[index], self.sweeps[index]
        chord = self.ends[index] - start
        # A line: start + t chord lies on the ray where start x chord = r (ray x chord).
        straight = (np.conj(start) * chord).imag / (np.conj(ray) * chord).imag
        # An arc: in the frame of the ray the centre is (foot, offset). Where the contour bulges
        # outward, counter-clockwise, the ray meets the far side of the circle, else the near one.
        seen = np.conj(ray) * centre
        foot, offset = seen.real, seen.imag
        half = np.sqrt(np.maximum(np.abs(start - centre) ** 2 - offset * offset, 0.0))
        r = np.where(sweep == 0.0, straight, foot + np.sign(sweep) * half)
        along = np.where(sweep == 0.0, chord, 1j * np.sign(sweep) * (r * ray - centre))
        # The tangent in the frame of the ray: dr by r dphi is its radial by its transverse part.
        turned = np.conj(ray) * along
        return r, r * turned.real / turned.imag

    def distances(self, beyond: Star | None = None) -> Extremes:
        """Smallest and largest distance [mm] from the pole, or `beyond` another contour about the
        same pole, each with its direction [rad].
        """
        stars = [self] if beyond is None else [self, beyond]
        turns = np.concatenate([np.mod(star.angles, TURN) for star in stars])

        def distance(directions: FloatArray, _: Side) -> FloatArray:
            # Between breaks of either contour the difference is smooth, so piecewise extremes find
            # all.
            radii = self.radii_and_slopes(directions)[0]
            return radii if beyond is None else radii - beyond.radii_and_slopes(directions)[0]

        return piecewise_extremes(distance, ascending(np.append(turns, [0.0, TURN])))

    def along(self, direction: float) -> float:
        """Distance [mm] along the contour, counter-clockwise from its first vertex, to where the
        ray in `direction` [rad] meets it.
        """
        point = complex(self.points(np.array([direction]))[0]) - self.pole
        ahead = (direction - self.angles[0]) % (2.0 * np.pi) + self.angles[0]
        index = max(int(np.searchsorted(self.angles, ahead, "right")) - 1, 0)
        arms = self.starts - self.centres
        straight = np.abs(self.ends - self.starts)
        lengths = np.where(self.sweeps == 0.0, straight, np.abs(self.sweeps * arms))
        way = abs(point - self.starts[index])
        if self.sweeps[index]:
            turned = np.angle((point - self.centres[index]) / arms[index])
            way = abs(turned) * abs(arms[index])
        return float(np.sum(lengths[:index]) + way)

    def points(self, directions: FloatArray) -> ComplexArray:
        """(m,) complex [mm] of the contour in `directions` (m,) [rad]."""
        contour_points: ComplexArray = self.pole + self.radii_and_slopes(directions)[0] * np.exp(
            1j * directions
        )
        return contour_points


def _uprightness(
    starts: ComplexArray, ends: ComplexArray, centres: ComplexArray, sweeps: FloatArray
) -> FloatArray:
    """(n,) the least cosine along each piece of the angle between it and the normal of the ray.

    It is weighted by the distance from the pole over the least one of the piece's ends.
    """
    chord = ends - starts
    size = np.where(chord == 0.0, 1.0, np.abs(chord))
    straight = (np.conj(starts) * chord).imag / size
    radius = np.abs(starts - centres)
    sign = np.where(sweeps < 0.0, -1.0, 1.0)
    arms = [vertices - centres for vertices in (starts, ends)]
    centre_distances = np.abs(centres)
    toward = np.where(
        centre_distances > 0.0,
        -centres / np.where(centre_distances > 0.0, centre_distances, 1.0),
        1.0,
    )
    unit = np.where(radius > 0.0, radius, 1.0)
    # A point is p = c + R a with |a| = 1. The cosine times |p| is p x t = sign (R + c . a), t being
    # the unit tangent: least at an end, or inside the arc where a points back to the pole.
    values = [sign * (radius + (np.conj(centres) * arm).real / unit) for arm in arms]
    least = np.minimum(*values)
    inner = sign * toward
    turned = np.mod(sign * np.angle(inner * np.conj(arms[0])), 2.0 * np.pi)
    there = sign * (radius + (np.conj(centres) * inner).real)
    least = np.where(turned < np.abs(sweeps), np.minimum(least, there), least)
    reach = np.minimum(np.abs(starts), np.abs(ends))
    uprightness: FloatArray = np.where(sweeps == 0.0, straight, least) / np.where(
        reach > 0.0, reach, 1.0
    )
    return uprightness
