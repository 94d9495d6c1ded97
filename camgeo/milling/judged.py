"""A toolpath as a simulation judges it: its runs, and the setup that it starts from."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Final

import numpy as np
import shapely

from camgeo.check.finding import Finding
from camgeo.geometry.contour.contour import Contour
from camgeo.milling.bench import BORE, Bench, is_open
from camgeo.milling.course import course_of, level
from camgeo.milling.cut import AreaCut, ContourCut, Cut, LetterCut
from camgeo.milling.guard import LOOSE_CORE
from camgeo.milling.holding import FIXTURE, ONION_SKIN, TABS, Holding, Obstacle
from camgeo.milling.milling import Stock
from camgeo.milling.moves import Move, Point, Stop, Toolpath
from camgeo.milling.stages import (
    Area,
    Body,
    Chamfer,
    Flaw,
    Run,
    Setup,
    Slab,
    Stage,
    areas,
    each_once,
    farthest,
    grown,
    overlap,
    parts,
    place_in,
    polygon,
)
from camgeo.milling.tool import CHAMFER_MILL, DRILL, Tool
from camgeo.part.boundaries import ExactBoundary
from camgeo.part.part import Boundary, Part, Wall
from camgeo.part.spec import text_of

RIM: Final = 1.0
"""Width [mm] of the strip along the outline of a blank by which it is held where tabs or a skin
hold the part."""

ROUGHLY: Final = 1.0
"""Tolerance [mm] of contours of clamps, which are lines and arcs."""

UNKNOWN: Final = 2.0
"""Diameters of the cutter by which a blank of unknown outline reaches beyond the course."""


def runs_of(toolpath: Toolpath) -> tuple[Run, ...]:
    """The operations as they run one after the other."""
    found = []
    at: Point | None = None
    for operation in toolpath.operations:
        obstacles = operation.cut.obstacles
        found.append(run_with(operation.tool, operation.name, operation.moves, obstacles, at))
        at = operation.travel[-1].end
    return tuple(found)


def run_with(
    tool: Tool,
    name: str,
    moves: tuple[Move | Stop, ...],
    obstacles: Iterable[Obstacle],
    start: Point | None,
) -> Run:
    """What a tool does that stands at `start` before; None if the first move is a traverse."""
    shank = None
    if tool.shank_diameter is not None and tool.flute_length is not None:
        shank = (0.5 * tool.shank_diameter, tool.flute_length)
    return Run(
        name,
        moves,
        tool.radius,
        tool.tip_length,
        tool.tip_angle is None,
        tool.plunges or tool.kind == DRILL,
        shank,
        tuple(_body(each) for each in obstacles),
        start,
    )


def setup_of(
    cuts: Iterable[Cut],
    runs: Sequence[Run],
    part: Part,
    stock: Stock,
    holding: Holding | None,
    tolerance: float,
    others: Iterable[Cut] = (),
) -> Setup:
    """What a program starts from, and the part that must come of it, within `tolerance` [mm].

    `cuts` say which walls are cut, and where the outline of the blank is not known, `runs` how far
    it must reach. Holes and marks that neither they nor `others` make, the cuts of another side,
    are none of that part: they are made otherwise.
    A bore with a keyway counts as round: a round cutter leaves the keyway to be broached. Letters
    count as what the cutter makes of them. Without a
    holding nothing is said of pieces that come loose; with one, only what it holds is held: clamps
    and screws as long as they are set.
    """
    made = part.without(left_out(part, every := (*(cuts := tuple(cuts)), *others)))
    letters = _letters(every)
    bodies = tuple(
        Body(
            layer.name,
            layer.z0,
            layer.z1,
            tuple(_contours(layer.boundaries, letters, tolerance)),
        )
        for layer in made.layers
    )
    low, high = part.layers[0].z0, part.layers[-1].z1
    outline, rim, known = _blank(cuts, runs, part, stock, tolerance)
    blank = [outline]
    if stock.bore is not None:
        blank.append(Contour.circle(0.5 * stock.bore))
    joined = [low] if stock.bottom > 0.0 else []
    held = None
    lowest = None
    if holding is not None:
        held = (bodies[0].contours,) if holding.kind == FIXTURE else ()
        if holding.tabs is not None:
            joined.append(low + holding.tabs.height)
        if holding.skin is not None:
            joined.append(low + holding.skin)
        lowest = low - max(holding.through, 0.0)
    return Setup(
        tuple(blank),
        high + stock.top,
        low - stock.bottom,
        bodies,
        held,
        rim if holding is not None and holding.kind in (TABS, ONION_SKIN) else None,
        fixture=holding is not None and holding.kind == FIXTURE,
        chamfers=tuple(_chamfers(cuts, tolerance)),
        lowest=lowest,
        joined=max(joined, default=None),
        known=known,
    )


def left_out(part: Part, cuts: Iterable[Cut]) -> tuple[str, ...]:
    """Names of the holes, marks and letters that no cut makes, and of a bore if no round cutter
    makes it.
    """
    made = _produced(cuts)
    return tuple(
        each.name
        for each in part.boundaries
        if (isinstance(each, ExactBoundary) and each.hole) or text_of(each.name)
        if each.name not in made and (each.name != BORE or not _is_round(each))
    )


def _is_round(boundary: Boundary) -> bool:
    return isinstance(boundary, ExactBoundary) and boundary.is_round


def _chamfers(cuts: Iterable[Cut], tolerance: float) -> Iterator[Chamfer]:
    """The edges that cones take off the part on their exact courses."""
    for cut in cuts:
        if isinstance(cut, ContourCut) and cut.tool.kind == CHAMFER_MILL:
            course = level(cut.centre.arcs(tolerance, "fast").contour, cut.bottom)
            run = run_with(cut.tool, cut.name, (), (), None)
            yield Chamfer(run, course, cut.top)


def _letters(cuts: Iterable[Cut]) -> dict[str, list[Contour]]:
    """What cutters make of texts, by the name of the first boundary of each."""
    found = [each for each in cuts if isinstance(each, LetterCut)]
    if not found:
        return {}
    from camgeo.milling.making import reached

    return {each.produced[0]: reached(each) for each in found}


def _contours(
    boundaries: Iterable[Boundary], letters: Mapping[str, list[Contour]], tolerance: float
) -> Iterator[Contour]:
    for each in boundaries:
        if text_of(each.name):
            yield from letters.get(each.name, ())
        else:
            yield _contour(each, tolerance)


def _contour(boundary: Boundary, tolerance: float) -> Contour:
    core = boundary.core if isinstance(boundary, ExactBoundary) else None
    return boundary.arcs(tolerance, "fast").contour if core is None else core


def _body(obstacle: Obstacle) -> Body:
    contour = obstacle.outline.arcs(ROUGHLY, "fast").contour
    return Body(obstacle.name, -np.inf, obstacle.top, (contour,))


def _blank(
    cuts: Iterable[Cut], runs: Sequence[Run], part: Part, stock: Stock, tolerance: float
) -> tuple[Contour, tuple[Contour, ...], bool]:
    """The outline of the blank, the strip along it, and whether the outline is known.

    Where it is not known it is the outermost boundary of the part, if nothing cuts that one, else
    a square around all.
    """
    if stock.diameter is not None:
        radius = 0.5 * stock.diameter
        outline = Contour.circle(radius, stock.centre)
        inner = Contour.circle(max(radius - RIM, 0.5 * radius), stock.centre)
        return outline, (outline, inner), True
    known = True
    if stock.length is not None and stock.width is not None:
        corner, centre = 0.5 * complex(stock.length, stock.width), stock.centre
    elif part.outermost.name not in _produced(cuts):
        outline = _contour(part.outermost, tolerance)
        share = 1.0 - RIM / float(np.max(np.abs(outline.vertices)))
        inner = Contour(share * outline.vertices, outline.sweeps, share * outline.centres)
        return outline, (outline, inner), True
    else:
        ends = [course_of(run.moves, run.start).ends for run in runs]
        both = [np.abs(part) for each in ends for part in (each.real, each.imag)]
        reach = max((float(np.max(part, initial=0.0)) for part in both), default=0.0)
        wide = 2.0 * UNKNOWN * max((run.radius for run in runs), default=0.0)
        corner, centre, known = (reach + wide) * (1.0 + 1.0j), 0j, False
    outline = _rectangle(corner, centre)
    return outline, (outline, _rectangle(corner - RIM * (1.0 + 1.0j), centre)), known


def _produced(cuts: Iterable[Cut]) -> set[str]:
    """Names of the boundaries that are cut."""
    return {name for cut in cuts for name in cut.produced}


def _rectangle(corner: complex, centre: complex) -> Contour:
    corners = np.array([-corner, corner.conjugate(), corner, -corner.conjugate()])
    return Contour.polygon(centre + corners)


# -- left -----------------------------------------------------------------------------------------
# What is left of a blank: pieces that nothing holds any more, and material left on the part.


TOUCHING = 1e-4
"""Area [mm^2] that two pieces must share to hang together; rounding leaves less."""

FINENESS = 1e-3
"""Deviation of chords of clamps [mm]."""

SAME = 1e-6
"""Heights [mm] that differ by less are one."""

PART = "the part"


@dataclass(frozen=True, slots=True, eq=False)
class Piece:
    """A connected part of the material: areas with the number of their slab."""

    areas: tuple[tuple[int, Area], ...]

    def volume(self, slabs: Sequence[Slab]) -> float:
        """[mm^3]."""
        return sum((slabs[k].z1 - slabs[k].z0) * float(area.area) for k, area in self.areas)

    def shared(self, others: Sequence[Area]) -> float:
        """Area [mm^2] shared with one area for each slab, all slabs together."""
        return sum(float(shapely.intersection(area, others[k]).area) for k, area in self.areas)


def pieces(slabs: Sequence[Slab]) -> tuple[Piece, ...]:
    """The connected parts of the material."""
    apart = each_once(parts, areas(slabs))
    single = [[(k, each) for each in found] for k, found in enumerate(apart)]
    offsets = np.concatenate(([0], np.cumsum([len(each) for each in single]))).astype(int)
    owner = list(range(int(offsets[-1])))

    def root(number: int) -> int:
        while owner[number] != number:
            number = owner[number]
        return number

    shared: dict[tuple[int, int], list[list[int]]] = {}
    for k, (low_parts, high_parts) in enumerate(pairwise(apart)):
        both = (id(low_parts), id(high_parts))
        if both not in shared:
            shared[both] = np.argwhere(overlap(low_parts, high_parts) > TOUCHING).tolist()
        for low, high in shared[both]:
            owner[root(int(offsets[k] + low))] = root(int(offsets[k + 1] + high))
    flat = [each for slab in single for each in slab]
    groups: dict[int, list[tuple[int, Area]]] = {}
    for number, each in enumerate(flat):
        groups.setdefault(root(number), []).append(each)
    return tuple(Piece(tuple(group)) for group in groups.values())


def left_flaws(
    stages: Sequence[Stage],
    part: Sequence[Area],
    runs: Sequence[Run],
    setup: Setup,
    allowed: float,
    *,
    corners: Sequence[tuple[float, float]] = (),
) -> Iterator[Flaw]:
    """Pieces that come loose, each where it does, and what is left on the part at the end.

    Parameters
    ----------
    part : in each slab.
    runs : of each stage, with the clamps and screws that are set.
    setup : what the program starts from, and what it has to leave.
    allowed : thickness [mm] that may be left; what is nowhere thicker is no piece.
    corners : heights [mm] between which rounded corners of cutters are, where those are lowest.
    """
    if setup.held is not None:
        held = [polygon(each, FINENESS) for each in setup.held]
        yield from _loose_pieces(stages, part, runs, held, setup, allowed)
    if stages and setup.final:
        yield from _rests(stages[-1], part, setup, allowed, corners)


def _loose_pieces(
    stages: Sequence[Stage],
    part: Sequence[Area],
    runs: Sequence[Run],
    always: Sequence[Area],
    setup: Setup,
    allowed: float,
) -> Iterator[Flaw]:
    """Pieces that neither what holds `always` nor the clamps of a run hold, each once.

    Until the first clamp is set, a blank that is still one piece is held in a way that is not
    stated: screws often stand in a bore that is milled first.
    """
    known: list[Piece] = []
    clamped = bool(always) or setup.rim is not None
    rim = [] if setup.rim is None else [polygon(setup.rim, FINENESS)]
    for stage, run in zip(stages, runs, strict=True):
        found = pieces(stage.slabs)
        held = [*always, *(polygon(body.contours, FINENESS) for body in run.obstacles)]
        clamped |= bool(run.obstacles)
        if not clamped and len(found) == 1:
            continue
        kept = [piece for piece in found if _meets(piece, held or rim)]
        if not held:  # what holds the rim is not stated; it holds what hangs on the part
            kept = [piece for piece in kept if piece.shared(part) > TOUCHING] or kept
        for piece in found:
            if piece in kept or any(_same(piece, each) for each in known):
                continue
            if _is_dust(piece, allowed):
                continue
            known.append(piece)
            yield _loose(stage, piece, part, setup)


def _meets(piece: Piece, held: Sequence[Area]) -> bool:
    return any(
        float(shapely.intersection(area, each).area) > TOUCHING
        for _, area in piece.areas
        for each in held
    )


def _is_dust(piece: Piece, allowed: float) -> bool:
    """Whether a piece is nowhere thicker than paths may be off: chips, which may not be there."""
    return all(grown(area, -0.5 * allowed).is_empty for _, area in piece.areas)


def _same(piece: Piece, other: Piece) -> bool:
    """Whether a piece is what is left of one that came loose before."""
    before = dict(other.areas)
    return all(
        k in before and float(shapely.intersection(area, before[k]).area) > TOUCHING
        for k, area in piece.areas[:1]
    )


def _loose(stage: Stage, piece: Piece, part: Sequence[Area], setup: Setup) -> Flaw:
    """A piece that comes loose: what it is, how large and heavy, and where."""
    k, area = max(piece.areas, key=lambda each: each[1].area)
    left, low, right, high = area.bounds
    place, value, unit = place_in(area), piece.volume(stage.slabs), "mm^3"
    what = _name(piece, place, part)
    size = f"{what} of {right - left:.3g} x {high - low:.3g} mm, {value:.3g} mm^3"
    if setup.density is not None:
        size += f", {1e3 * setup.density * value:.3g} kg"
    edge = float(np.max(np.abs(setup.blank[0].vertices)))
    if not setup.known and max(map(abs, area.bounds)) > edge / np.sqrt(2.0) - SAME:
        size, value, unit = f"{what}, in a blank of unstated size", 1.0, "pieces"
    watched = setup.fixture and what != PART
    text = f"{size}, which the fixture must hold, comes loose" if watched else (
        f"{size}, comes loose and nothing holds it"
    )  # fmt: skip
    where = (place.real, place.imag, stage.slabs[k].z0)
    return Flaw("loose", stage.operation, text, value, 0.0, where, unit, watched=watched)


def _name(piece: Piece, place: complex, part: Sequence[Area]) -> str:
    """What a piece is: the part, a core within it, or waste beside it."""
    if piece.shared(part) > 0.5 * sum(each.area for each in part):
        return PART
    rings = [ring for each in part for ring in parts(each)]
    point = shapely.Point(place.real, place.imag)
    inside = any(shapely.intersects(shapely.Polygon(ring.exterior), point) for ring in rings)
    return "a core" if inside or not rings else "waste"


def _may_stay(slab: Slab, setup: Setup) -> bool:
    """Whether waste may hold on to the part there: up to a height, or from one on beside it."""
    low, high = setup.joined, setup.hanging
    if low is not None and slab.z1 <= low + SAME:
        return True
    top = max((body.z1 for body in setup.part), default=setup.top)
    return high is not None and high - SAME <= slab.z0 and slab.z1 <= top + SAME


def _left_on(
    material: Area, target: Area, near: Iterable[Area], allowed: float
) -> Iterator[tuple[Area, float]]:
    """What is left beside the section `target` of the part, with its thickness [mm]; or only over
    or under the sections `near` by, with 0.
    """
    beside = shapely.difference(material, grown(target, allowed))
    thick = parts(grown(grown(beside, -0.5 * allowed), 0.5 * allowed))
    close = grown(target, 2.0 * allowed)
    faces = shapely.difference(shapely.union_all(list(near)), target)
    for each in thick:
        if not target.is_empty and shapely.intersects(each, close):
            yield each, farthest(each, target)[0]
        elif float(shapely.intersection(each, faces).area) > TOUCHING:
            yield each, 0.0


def _rests(
    stage: Stage,
    part: Sequence[Area],
    setup: Setup,
    allowed: float,
    corners: Sequence[tuple[float, float]],
) -> Iterator[Flaw]:
    """Material that is left beside the part, or on one of its faces."""
    found: dict[int, Flaw] = {}  # the largest fault, of what is meant, and of what corners leave
    known: dict[tuple[int, ...], list[tuple[Area, float]]] = {}
    unfinished = shapely.boundary([polygon([each], 0.5 * allowed) for each in setup.unfinished])
    for k, (slab, target) in enumerate(zip(stage.slabs, part, strict=True)):
        if slab.material.is_empty or _may_stay(slab, setup):
            continue
        near = {id(each): each for each in part[max(k - 1, 0) : k + 2]}
        same = (id(slab.material), id(target), *sorted(near))
        if same not in known:
            known[same] = list(_left_on(slab.material, target, near.values(), allowed))
        for each, thickness in known[same]:
            size = thickness or slab.z1 - slab.z0
            left, low, right, high = each.bounds
            rounding = max((z1 - z0 for z0, z1 in corners if z0 < slab.middle < z1), default=0.0)
            by_corner = size <= rounding + allowed
            meant = thickness and np.any(shapely.distance(unfinished, each) <= 2.0 * allowed)
            text = (
                f"material is left on the part, up to {size:.3g} mm thick, {right - left:.3g} mm"
                f" along X, {high - low:.3g} mm along Y and {slab.z1 - slab.z0:.3g} mm high"
            )
            text += ", where the corners of a cutter are rounded" if by_corner else ""
            place = place_in(each)
            where = (place.real, place.imag, slab.z0)
            kind = 2 if by_corner else 1 if meant else 0
            if kind not in found or size > found[kind].value:
                found[kind] = Flaw(
                    "rest", stage.operation, text, size, allowed, where, watched=kind > 0
                )
    yield from (found[kind] for kind in sorted(found))


# -- verdict --------------------------------------------------------------------------------------
# The verdict on a program: what its simulation finds, and what of it must not be run.


PART_FINENESS: Final = 1e-3
"""Of the contours with which the part is compared [mm]."""


def finished_by(cut: Cut) -> tuple[str, ...]:
    """Names of the walls that a cut leaves as they are to be."""
    return () if cut.allowance else cut.produced


def finished_down_to(cuts: Iterable[Cut], name: str) -> float:
    """Z down to which cuts leave a wall as it is to be [mm]; infinite if none does."""
    return min((cut.bottom for cut in cuts if name in finished_by(cut)), default=math.inf)


def lowest_of(wall: Wall, holding: Holding | None) -> float:
    """Z down to which a wall is to be cut [mm]: a skin is left, to be removed by hand."""
    return wall.z0 + (0.0 if holding is None else holding.skin or 0.0)


def done_by(bench: Bench, cuts: Iterable[Cut]) -> frozenset[str]:
    """Names of the walls that are done with the cuts of one side; of a planned sequence all that
    tools reach: what it leaves out is there, or made otherwise.
    """
    if bench.milling.operations:
        cuts = tuple(cuts)
        names = ((wall, wall.boundary.name) for wall in bench.part.walls)
        return frozenset(
            name for wall, name in names
            if finished_down_to(cuts, name) <= lowest_of(wall, bench.milling.holding)
        )  # fmt: skip
    return frozenset(wall.boundary.name for wall in bench.part.walls if is_open(bench.part, wall))


def faces(cut: Cut) -> bool:
    """Whether a cut takes off all that lies above the part."""
    return isinstance(cut, AreaCut) and not cut.walls


def verdict(flaws: Iterable[Flaw]) -> tuple[Finding, ...]:
    """What a machinist must not run, "broken", and what is to be watched, "warning"."""
    return tuple(
        Finding(
            LOOSE_CORE if each.name == "loose" and each.watched else each.name,
            "warning" if each.watched else "broken",
            each.sentence,
            each.value,
            each.limit,
            each.unit,
        )
        for each in flaws
    )
