"""Milling strategies: each makes the moves of a cut. A new one is a function and a line in
`STRATEGIES`.

Each begins with a traverse at the clearance height above its first point; `cut_moves` ends at that
height.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from itertools import pairwise, takewhile
from typing import Final

import numpy as np
import shapely

from camgeo.errors import GeometryError, UndercutError
from camgeo.geometry.contour.contour import Contour, Effort, Fit, least_distance
from camgeo.milling.clear import MOST_TURNS, clear, moat
from camgeo.milling.compensation import compensation_side
from camgeo.milling.cut import AreaCut, ContourCut, Cut, LetterCut, LineCut, PointCut
from camgeo.milling.milling import CONTROL, END_MILL, Heights, Tool, ToolError
from camgeo.milling.moves import Move, too_long
from camgeo.milling.polygons import Area, parts, polygon
from camgeo.milling.track import (
    LeadSpec,
    Track,
    begin_at_distance,
    begin_in_piece,
    chain_tracks,
    flattest,
    join_leads,
)
from camgeo.milling.walk import (
    SPENT,
    ToolpathBuilder,
    along,
    coarse,
    cut_of_kind,
    descend,
    descent,
    engagement_limit,
    ramp_angle,
    require_clear,
)
from camgeo.numeric.arrays import ComplexArray
from camgeo.part.nozzle import unreached
from camgeo.part.part import Boundary
from camgeo.reading import PROGRAM_LINES

# -- around ---------------------------------------------------------------------------------------
# Rounds along the closed path of the cutter's centre: finishes, slots, chamfers.
#
# The path is the exact parallel, fitted once within the tolerance, or that of a roughing within its
# slack; each round runs all of it.


def profile(builder: ToolpathBuilder, tolerance: float, effort: Effort) -> None:
    """A finish along one boundary, around the material or inside a hole.

    Where the material beside the path is cleared: down next to it, onto it and once around at each
    depth, with tangential leads, and back beside it between depths. Else the cutter comes down
    along the path itself, see `slot`. Spring rounds follow at the last depth.

    Raises
    ------
    GeometryError
        If the cutter is too large for the boundary, or there is no room for leads.
    """
    cut = cut_of_kind(builder.cut, ContourCut, "runs along a path")
    if not (cut.cleared and cut.room):
        slot(builder, tolerance, effort)
        return
    path = fit_path(cut, tolerance, effort)
    side = compensation_side(cut)
    spec = LeadSpec(
        free=builder.free,
        usual=cut.tool.radius,
        straight=bool(side),
        aside=cut.tool.radius if cut.compensation == CONTROL else 0.0,
        avoid=builder.avoid(cut.bottom),
        least=0.0 if cut.tool.plunges else cut.rest,
    )
    place = None if cut.tabs is None else farthest_along_x(path)
    try:
        contour, lead = join_leads(path, cut.room, spec, place=place)
    except GeometryError as error:
        raise GeometryError(f"{cut.name}: {error.message}", error.key, error.value) from None
    track = Track.around(contour)
    back = Track.line(lead.exit.end, lead.entry.start)
    builder.traverse(lead.entry.start)
    for number, z in enumerate(cut.depths):
        if number:
            builder.follow(back)
        builder.lower(z)
        _run_entry(builder, lead.entry, side)
        for _ in range(1 + (cut.springs if z == cut.bottom else 0)):
            builder.follow_heights(track, round_heights(cut, track, z, z))
        _run_exit(builder, lead.exit, side)


def _run_entry(builder: ToolpathBuilder, entry: Track, side: str) -> None:
    """Follow a lead onto the path; its first piece switches compensation on to a `side`, if any."""
    first = float(entry.lengths[0]) if side else 0.0
    if side:
        builder.follow(entry.section(0.0, first), switch=side)
    builder.follow(entry.section(first, entry.length))


def _run_exit(builder: ToolpathBuilder, exit_track: Track, side: str) -> None:
    """Follow a lead off the path; its last piece switches compensation off if a `side` is on."""
    last = exit_track.length - float(exit_track.lengths[-1]) if side else exit_track.length
    builder.follow(exit_track.section(0.0, last))
    if side:
        builder.follow(exit_track.section(last, exit_track.length), switch="off")


def slot(builder: ToolpathBuilder, tolerance: float, effort: Effort) -> None:
    """Rounds in full material, or between two boundaries with a cutter as wide as the gap.

    Down to the material on the path itself, then along it, no steeper than the tool may, to each
    depth in turn without leaving the path, and once around at the last one; spring rounds follow.

    Raises
    ------
    GeometryError
        If the cutter is too large for the path, or the path so short that the descent would take
        more than `MOST_ROUNDS`.
    """
    cut = cut_of_kind(builder.cut, ContourCut, "runs along a path")
    contour = fit_path(cut, tolerance, effort)
    if cut.tabs is None:
        contour = begin_in_piece(contour, next(flattest(contour)))
    else:
        contour = begin_at_distance(contour, farthest_along_x(contour))
    track = Track.around(contour)
    builder.traverse(track.start)
    both = bool(cut.left)
    if cut.tool.plunges:
        for z in cut.depths:
            builder.lower(z)
            builder.follow_heights(track, round_heights(cut, track, z, z), both=both)
    else:
        builder.lower(cut.top)
        for z in cut.depths:
            for end in descent(cut, builder.z, z, track.length):
                builder.follow_heights(track, round_heights(cut, track, builder.z, end), both=both)
        builder.follow_heights(track, round_heights(cut, track, cut.bottom, cut.bottom), both=both)
    for _ in range(cut.springs):
        builder.follow_heights(track, round_heights(cut, track, cut.bottom, cut.bottom), both=both)


def farthest_along_x(contour: Contour) -> float:
    """Distance [mm] along the contour from its first vertex to its point with the largest x.

    Parallels have these points on one normal.
    """
    # On an arc x is largest where the arm points along +x, if the arc gets there: `turned` is the
    # angle from its start, in its own direction.
    arms = contour.vertices - contour.centres
    turned = np.mod(-np.angle(arms) * np.where(contour.sweeps < 0.0, -1.0, 1.0), 2.0 * np.pi)
    round_there = (contour.sweeps != 0.0) & (turned < np.abs(contour.sweeps))
    most = np.where(round_there, contour.centres.real + contour.radii, contour.vertices.real)
    index = int(np.argmax(most))
    passed = float(np.sum(contour.lengths[:index]))
    return passed + (float(turned[index] * contour.radii[index]) if round_there[index] else 0.0)


def fit_path(cut: ContourCut, tolerance: float, effort: Effort) -> Contour:
    """The cutter's path as lines and arcs within `tolerance` [mm], in the direction of cutting.

    Within a larger slack of the cut it is fitted fast.

    Raises
    ------
    GeometryError
        With key "tool", if the cutter cannot reach the whole boundary.
    """
    try:
        coarse = cut.slack > tolerance
        fit = cut.centre.arcs(cut.slack, "fast") if coarse else cut.centre.arcs(tolerance, effort)
    except UndercutError as error:
        raise ToolError(
            f"the cutter is too large for the {cut.name}: a concave part of it is more tightly"
            f" curved than the cutter ({error.message})",
            cut.tool,
        ) from None
    contour = fit.contour
    return contour if cut.centre.hole == cut.climb else contour.reversed()


# -- tabs -----------------------------------------------------------------------------------------
# Heights along a round: even, or lifted over the tabs that hold the part.


RISE = math.radians(30.0)
"""Angle [rad] of the way up onto a tab, through the slot that the cutter has just made."""

STEEPEST = math.radians(45.0)
"""Angle [rad] of the way down from a tab, for a tool that may plunge."""


def round_heights(
    cut: ContourCut, track: Track, start: float, end: float
) -> list[tuple[float, float]]:
    """(distance along the round, z) [mm] from `start` to `end` of a round, evenly but for tabs.

    Over each tab the cutter stays above its top, which is given above the last depth, over the
    width of the tab and its own diameter, so that its circle leaves that width. It rises steeply
    and comes down no steeper than it may enter material. The first tab lies half a space behind the
    start, where leads join. Rounds with tabs start at the point with the largest x, so that a
    finish leaves the tabs where the roughing has left them.

    Raises
    ------
    ToolError
        With field "ramp_angle", if the ramps down from the tabs are too flat for the space between.
    GeometryError
        With key "holding.count", if the tabs do not fit one after the other at all.
    """
    length = track.length
    tabs = cut.tabs
    top = -math.inf if tabs is None else cut.bottom + tabs.height
    if tabs is None or min(start, end) >= top:
        return [(0.0, start), (length, end)]
    # Along the path of the centre, whose circle reaches its radius beyond both ends of the top.
    wide = tabs.width + cut.tool.diameter
    drop = top - min(start, end)
    down = 1.0 if cut.tool.plunges else math.tan(ramp_angle(cut))
    rise, fall = drop / math.tan(RISE), drop / down
    space = length / tabs.count
    needed = rise + wide + fall
    if needed > space:
        room = space - rise - wide
        least = math.atan2(drop, room)
        if not cut.tool.plunges and least < STEEPEST:
            raise ToolError(
                f"ramps of {math.degrees(ramp_angle(cut)):.3g} degrees down from {tabs.count} tabs"
                f" do not fit between them on the {length:.4g} mm of {cut.name}: at least"
                f" {math.degrees(least):.3g} degrees are needed, or fewer or lower tabs, or a tool"
                " that plunges",
                cut.tool,
                "ramp_angle",
            )
        # How many tabs fit with the steepest descent allowed, 45 degrees: as long as it is deep.
        most = math.floor(length / (rise + wide + drop))
        raise GeometryError(
            f"{tabs.count} tabs, each wider than stated by the cutter's diameter, and the ramps"
            f" onto them and down again do not fit on the {length:.4g} mm of {cut.name}; there is"
            f" room for {most}",
            key="holding.count",
            value=f"{tabs.count}",
        )
    middles = space * (np.arange(tabs.count) + 0.5)
    # Four corners over each tab: begin of the rise, both ends of the top, end of the descent; the
    # whole shape is shifted so that its middle, not that of the top, is in the middle of a space.
    shape = np.array([-0.5 * wide - rise, -0.5 * wide, 0.5 * wide, 0.5 * wide + fall])
    places = (middles[:, None] + shape + 0.5 * (rise - fall)).ravel()
    plain = start + ((end - start) / length) * places
    on_top = np.tile([False, True, True, False], tabs.count)
    heights = np.where(on_top, np.maximum(plain, top), plain)
    inner = list(zip(places.tolist(), heights.tolist(), strict=True))
    return [(0.0, start), *inner, (length, end)]


# -- drill -----------------------------------------------------------------------------------------


def drill(builder: ToolpathBuilder, tolerance: float, effort: Effort) -> None:  # noqa: ARG001  all strategies are called alike
    """Each hole is drilled to its depths one after the other; after each the drill is retracted, to
    clear the chips.

    All of it at the feed of a drill, or the plunge feed of a cutter: no rapid enters a hole.
    """
    cut = cut_of_kind(builder.cut, PointCut, "cuts at points")
    for place in cut.points:
        builder.traverse(place)
        for z in cut.depths:
            builder.lower(z, feed=cut.sinking)
            builder.retract()


# -- engrave --------------------------------------------------------------------------------------
# A mark as wide as the cutter: to and fro along a line.


def engrave(builder: ToolpathBuilder, tolerance: float, effort: Effort) -> None:  # noqa: ARG001  all strategies are called alike
    """At each depth the cutter comes down by ramps along the line, or straight if it may plunge,
    and runs once along it.
    """
    cut = cut_of_kind(builder.cut, LineCut, "cuts along a line")
    line = Track.line(cut.start, cut.end)
    builder.traverse(cut.start)
    builder.lower(cut.top)
    above = cut.top
    for z in cut.depths:
        if cut.tool.plunges:
            builder.lower(z)
        else:
            for end in descent(cut, above, z, line.length):
                builder.follow(line, end, both=True)
                line = line.reversed()
        builder.follow(line, both=True)
        line = line.reversed()
        above = z


# -- letters --------------------------------------------------------------------------------------
# The strokes of engraved letters, and what a round cutter makes of them: rounds within each, from
# the inside outwards.
#
# Strokes are polygons a thousandth of a millimetre off at most; where the centre of a cutter may
# be, they are shrunk by slightly more than its radius, and the paths that follow are proved to keep
# off the exact outlines.


FINE: Final = 1e-3
"""Tolerance [mm] of the outlines of strokes, of their chords, and of what paths are thinned by."""

STANDOFF: Final = 4.0 * FINE
"""Distance [mm] that cutters keep from letters, so that their paths can be proved to cut none:
`FINE` for each of its three uses, and once for the chords of round corners."""

CORNERS: Final = 24
"""Chords of a quarter of a round corner."""


def letters(builder: ToolpathBuilder, tolerance: float, effort: Effort) -> None:  # noqa: ARG001  all strategies are called alike
    """Rounds within the strokes: straight down and once around at each depth in turn, then on to
    the next round at the clearance height.

    Raises
    ------
    GeometryError
        With key "toolpath", if a path comes too near to an outline.
    """
    cut = cut_of_kind(builder.cut, LetterCut, "cuts letters")
    walls = [wall.arcs(FINE, "fast") for wall in cut.walls]
    for stroke in strokes(cut.walls):
        around = [wall for wall in walls if _bounds(wall, stroke)]
        for path in centres(stroke, cut):
            _require_clear(path, around, cut)
            track = Track.around(path)
            builder.traverse(track.start)
            builder.lower(cut.top)
            for z in cut.depths:
                builder.lower(z)
                builder.follow(track)


def _bounds(wall: Fit, stroke: Area) -> bool:
    """Whether a wall bounds a stroke."""
    point = complex(wall.contour.vertices[0])
    distance = shapely.distance(shapely.Point(point.real, point.imag), shapely.boundary(stroke))
    return float(distance) <= 2.0 * FINE


def _require_clear(path: Contour, walls: list[Fit], cut: LetterCut) -> None:
    needed = cut.tool.radius + cut.allowance
    for wall in walls:
        distance = least_distance(Track.around(path), Track.around(wall.contour)) - wall.deviation
        if distance < needed:
            raise GeometryError(
                f"{cut.name} comes {needed - distance:.3g} mm too near to an outline",
                key="toolpath",
            )


def strokes(walls: Sequence[Boundary]) -> list[Area]:
    """A polygon for each connected stroke [mm]."""
    return parts(polygon([wall.arcs(FINE, "fast").contour for wall in walls], FINE))


def unfit_for_letters(tool: Tool, walls: Sequence[Boundary]) -> str:
    """Why a tool cannot cut the strokes of letters; empty if it can."""
    if tool.kind != END_MILL or tool.corner_radius:
        return "letters are cut with a flat end mill"
    if not tool.plunges:
        return "letters take a tool that plunges"
    for stroke in strokes(walls):
        place = unreached(stroke, tool.radius + STANDOFF)
        if place is not None:
            x, y = place
            return f"{tool.diameter:g} mm are wider than a stroke at X {x:.4g}, Y {y:.4g} mm"
    return ""


def centres(stroke: Area, cut: LetterCut) -> list[Contour]:
    """Paths of the cutter's centre that clear a stroke, the innermost first: counter-clockwise in a
    hole and clockwise around what stands in it, where the cut climbs.

    Raises
    ------
    GeometryError
        With key "tool.stepover", if they are more than `MOST_TURNS`.
    """
    step = min(cut.stepover, cut.tool.radius)
    first = cut.tool.radius + cut.allowance + STANDOFF
    shrunk = (
        # Enough offsets to shrink any stroke to nothing: it is narrower than half its perimeter.
        shapely.buffer(stroke, -(first + number * step), quad_segs=CORNERS)
        for number in range(int(stroke.length / step) + 2)
    )
    paths: list[Contour] = []
    for number, area in enumerate(takewhile(lambda area: not area.is_empty, shrunk)):
        if number == MOST_TURNS:
            raise GeometryError(
                f"is too small: {cut.name} would need more than {MOST_TURNS} rounds in a stroke",
                "tool.stepover",
                f"{cut.stepover:g}",
            )
        thin = shapely.orient_polygons(shapely.simplify(area, FINE))
        paths += [_round(ring[:-1], climb=cut.climb) for ring in rings(thin)]
    return paths[::-1]


def _round(ring: ComplexArray, *, climb: bool) -> Contour:
    """A path along a ring in the direction of cutting; outer rings come counter-clockwise."""
    contour = Contour.polygon(ring)
    return contour if climb else contour.reversed()


def rings(area: Area) -> tuple[ComplexArray, ...]:
    """All rings of `area`, outer and inner, as complex [mm]."""
    outlines = []
    for part in parts(area):
        for ring in (part.exterior, *part.interiors):
            points = shapely.get_coordinates(ring)
            outlines.append(points[:, 0] + 1j * points[:, 1])
    return tuple(outlines)


def letter_outlines(cut: LetterCut) -> list[Contour]:
    """The outlines that the cutter makes of the letters: their corners are round."""
    # All places of the cutter's centre, then all that its circle covers from there: an opening.
    outlines: list[Contour] = []
    for stroke in strokes(cut.walls):
        centre_area = shapely.buffer(stroke, -cut.tool.radius, quad_segs=CORNERS)
        cut_area = shapely.buffer(centre_area, cut.tool.radius, quad_segs=CORNERS)
        outlines += [Contour.polygon(ring[:-1]) for ring in rings(cut_area)]
    return outlines


# -- trochoid -------------------------------------------------------------------------------------
# A slot cut by loops: wider than the cutter, deep, and at a bounded engagement.
#
# Down by a helix, and along the wall by full circles that touch the cutter's path there from its
# free side, each a little ahead of the one before it, with the path itself between them. A circle
# of a radius below that of the cutter sweeps a whole disc, so the next one is engaged at most where
# it is ahead of that disc: by the crossings of two circles, at every place of the next circle and
# of the way onto it. The path along the wall is run all round, so that no cusps are left on it.


NARROWEST: Final = 0.1
"""Radius of a loop as a share of that of the cutter, at least."""

HOLLOW: Final = 0.45
"""Radius of a loop as a share of that of the path, where it bends towards the loops, at most."""

SHORTER: Final = 0.97
"""Factor by which a step is shortened until the loops are near enough."""

PLACES: Final = 721
"""Places on a loop at which its engagement is computed."""

ROUNDING: Final = 1e-4
"""Angle [rad] by which the engagement may be larger between these places."""

BISECTED: Final = 40
"""Steps of the bisection for the largest advance: to 2 ** -40 of its range."""

MOVES: Final = 4
"""Least number of moves of a loop: the way to it, two in its cutting part, and the way back."""

SHORTEST: Final = 1e-3
"""Least step, as a share of the cutter's radius: a limit that requires less cannot be kept."""


def trochoid(builder: ToolpathBuilder, tolerance: float, effort: Effort) -> None:  # noqa: ARG001  all strategies are called alike
    """A slot of at most the width `cut.slot` along the first wall, to each depth in turn without
    leaving it.

    Raises
    ------
    GeometryError
        If the cutter is too large for the wall or the slot, or no step keeps the engagement.
    """
    cut = cut_of_kind(builder.cut, AreaCut, "clears an area")
    fine, wall = coarse(cut, tolerance), cut.walls[0]
    path = along(wall, cut, fine)
    path = begin_in_piece(path, next(flattest(path)))
    path = path if wall.hole == cut.climb else path.reversed()
    size = _loop(cut, path, builder.free, fine)
    steps = list(_steps(cut, Track.around(path), builder.free, size, fine))
    level = chain_tracks([track for track, _ in steps])
    for boundary in cut.walls:
        require_clear(level, boundary, cut, fine)
    # The round of the helix at its depth: its floor is still sloping.
    helix = _circle(Track.around(path), 0.0, builder.free, size)
    for above, z in pairwise((cut.top, *cut.depths)):
        descend(builder, helix, above, z)
        builder.follow(helix)
        for track, air in steps:
            builder.follow(track, air=air)
    # Off the wall by half a loop, before the cutter is lifted.
    builder.follow(helix.section(0.0, 0.5 * helix.length))


def _loop(cut: AreaCut, path: Contour, free: int, fine: float) -> float:
    """Radius of the loops [mm] that fit the slot and the hollows of the path."""
    radius = cut.tool.radius
    # Loop and cutter together span the slot, less the tolerances that the path keeps off the wall.
    size = 0.5 * cut.slot - radius - SPENT * fine
    if size < NARROWEST * radius:
        raise GeometryError(
            f"the cutter is too large for loops in a slot of {cut.slot:.4g} mm; the largest that"
            f" fits has {_hundredths((cut.slot - 2.0 * SPENT * fine) / (1.0 + NARROWEST)):g} mm",
            "tool", f"{cut.tool.diameter:g}",
        )  # fmt: skip
    # In a hollow of the path loops must be smaller than it; between two walls they must keep their
    # full size, to reach the other wall.
    whole, hollow = size, path.radii[path.sweeps * free > 0.0]
    size = min(size, HOLLOW * float(np.min(hollow, initial=np.inf)))
    if size < NARROWEST * radius or (len(cut.walls) > 1 and size < whole):
        raise GeometryError(
            f"there is no room for loops in the hollows of the {cut.walls[0].name}", "tool",
            f"{cut.tool.diameter:g}",
        )  # fmt: skip
    return size


def _hundredths(diameter: float) -> float:
    """The diameter [mm] in whole hundredths, no larger."""
    return math.floor(100.0 * diameter) / 100.0


def _circle(path: Track, place: float, free: int, size: float) -> Track:
    """A full circle that touches the path at `place` [mm] along it, on its free side."""
    (point,), (heading,) = path.points_and_tangents(np.array([place]))
    centre = complex(point + free * 1j * heading * size)
    return Track.arc(complex(point), centre, free * 2.0 * math.pi)


def _steps(
    cut: AreaCut, path: Track, free: int, size: float, fine: float
) -> Iterator[tuple[Track, bool]]:
    """Tracks along the path, each followed by a circle in two parts, and whether each is in air.

    A circle leaves the material slightly after half of it, as its centre is at most `largest` [mm]
    ahead of that of the circle before.
    """
    length, limit = path.length, engagement_limit(cut, fine)
    largest = min(cut.stepover, largest_advance(size, cut.tool.radius, limit))
    least = SHORTEST * cut.tool.radius
    if largest < least:
        raise GeometryError(
            "is too small for loops along the wall", "tool.engagement", f"{math.degrees(limit):g}"
        )
    # Refused before the moves are made: each step has at least `MOVES` at each depth.
    if MOVES * len(cut.depths) * length > PROGRAM_LINES * largest:
        raise too_long()
    # Half a turn to the side away from the wall, and on to where the circle crosses the one before,
    # whose centre is at most `largest` behind.
    cutting = size * (math.pi + math.asin(min(0.5 * largest / size, 1.0)))
    place, previous = 0.0, _circle(path, 0.0, free, size)
    while place < length:
        step = min(largest, length - place)
        # Where the path bends away from the loops their middles are farther apart than the steps.
        while (
            step > least
            and _centre_distance(previous, _circle(path, place + step, free, size)) > largest
        ):
            step *= SHORTER
        end = place + step if length - place - step > least else length
        yield path.section(place, end), False
        previous = _circle(path, end, free, size)
        yield previous.section(0.0, cutting), False
        yield previous.section(cutting, previous.length), True
        place = end


def _centre_distance(one: Track, other: Track) -> float:
    return abs(complex(one.centres[0] - other.centres[0]))


def largest_advance(size: float, radius: float, limit: float) -> float:
    """How far a loop may be ahead of the one before it [mm] for an engagement of `limit` [rad].

    Parameters
    ----------
    size : radius of the loops [mm], below that of the cutter.
    radius : of the cutter [mm].
    """
    low, high = 0.0, 2.0 * (size + radius)
    for _ in range(BISECTED):
        middle = 0.5 * (low + high)
        if loop_engagement(size, radius, middle) <= limit - ROUNDING:
            low = middle
        else:
            high = middle
    return low


def loop_engagement(size: float, radius: float, advance: float) -> float:
    """Largest engagement [rad] on a loop whose middle is `advance` [mm] ahead of the previous one.

    The cutter is in material outside the disc that the loop before has swept: up to its crossings
    with the circle around that disc, which lie about the ray from the middle of the disc. Ahead of
    that ray's normal it is engaged the more, the more the ray leans forward.
    """
    around = np.linspace(-np.pi, 0.0, PLACES)
    # The cutter's centre, seen from the middle of the loop before, from which the next one's middle
    # is `advance` away. By the law of cosines the crossings are `half` off the ray to the centre.
    arm = advance + size * np.exp(1j * around)
    far = np.abs(arm)
    reach = size + radius
    cosine = (reach * reach - far * far - radius * radius) / (2.0 * far * radius)
    half = np.arccos(np.clip(cosine, -1.0, 1.0))
    turned = np.abs(np.angle(1j * np.exp(1j * around) / arm))
    # Only the leading half of the cutter cuts: both ends are limited to a right angle.
    angles = np.minimum(turned + half, 0.5 * np.pi) - np.maximum(turned - half, -0.5 * np.pi)
    return float(np.max(np.maximum(angles, 0.0)))


# -- all ------------------------------------------------------------------------------------------


Strategy = Callable[[ToolpathBuilder, float, Effort], None]
"""Adds the moves of a cut to its toolpath builder, from the tolerance of its path [mm] and the
effort of fitting."""

STRATEGIES: Final[dict[str, Strategy]] = {
    "profile": profile,
    "slot": slot,
    "face": clear,
    "bore": clear,
    "rough": clear,
    "drill": drill,
    "trochoid": trochoid,
    "moat": moat,
    "engrave": engrave,
    "letters": letters,
}


def cut_moves(cut: Cut, heights: Heights, tolerance: float, effort: Effort) -> list[Move]:
    """The moves of a cut by its strategy, and up to the clearance height.

    Raises
    ------
    GeometryError
        With key "toolpath", if there is no such strategy; `ToolError` for what is wrong with its
        tool.
    """
    if cut.strategy not in STRATEGIES:
        raise GeometryError(
            f"{cut.name} has no such strategy; there are {', '.join(STRATEGIES)}",
            "toolpath",
            cut.strategy,
        )
    builder = ToolpathBuilder(cut, heights)
    try:
        STRATEGIES[cut.strategy](builder, tolerance, effort)
    except GeometryError as error:
        if error.key == "tool" and not isinstance(error, ToolError):
            raise ToolError(f"{cut.name}: {error.message}", cut.tool) from error
        raise
    builder.lift()
    return builder.moves
