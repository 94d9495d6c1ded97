"""Jobs as they are simulated: the runs, what each side starts from, and the flaws; and which
features of the part the operations make.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from camgeo.check.finding import Finding, Severity
from camgeo.geometry.contour.contour import Contour, Pieces, rectangle
from camgeo.milling.bench import BORE, SAME, is_open
from camgeo.milling.cut import AreaCut, ContourCut, Cut, LetterCut
from camgeo.milling.milling import (
    CHAMFER_MILL,
    DRILL,
    FIXTURE,
    ONION_SKIN,
    TABS,
    Holding,
    MillingSpec,
    Obstacle,
    Stock,
    Tool,
    mirrored,
)
from camgeo.milling.moves import Course, Move, Point, Stop, Toolpath, feed_course
from camgeo.milling.simulation import (
    ALLOWED,
    Chamfer,
    Flaw,
    Setup,
    Simulation,
    ToolRun,
    UprightBody,
    simulate,
)
from camgeo.part.boundaries import ExactBoundary
from camgeo.part.part import Bevel, Boundary, Part, Wall
from camgeo.part.spec import Keyway, text_name

RIM: Final = 1.0
"""Width [mm] of the strip along the outline of a blank by which it is held where tabs or a skin
hold the part."""

ROUGHLY: Final = 1.0
"""Tolerance [mm] of contours of clamps, which are lines and arcs."""

UNKNOWN: Final = 2.0
"""Diameters of the largest cutter by which a blank of unknown outline reaches beyond all moves."""


PART_FINENESS: Final = 1e-3
"""Tolerance [mm] of the contours of the part with which a simulation is compared."""


def toolpath_runs(toolpath: Toolpath) -> tuple[ToolRun, ...]:
    """The operations as they run one after the other."""
    runs = []
    position: Point | None = None
    for operation in toolpath.operations:
        obstacles = operation.cut.obstacles
        runs.append(tool_run(operation.tool, operation.name, operation.moves, obstacles, position))
        position = operation.travel[-1].end
    return tuple(runs)


def tool_run(
    tool: Tool,
    name: str,
    moves: tuple[Move | Stop, ...],
    obstacles: Iterable[Obstacle],
    start: Point | None,
) -> ToolRun:
    """The run of a tool from `start` [mm], which is None if the first move is a traverse."""
    shank = None
    if tool.shank_diameter is not None and tool.flute_length is not None:
        shank = (0.5 * tool.shank_diameter, tool.flute_length)
    return ToolRun(
        name,
        moves,
        tool.radius,
        tool.tip_length,
        tool.tip_angle is None,
        tool.plunges or tool.kind == DRILL,
        shank,
        tuple(_body(obstacle) for obstacle in obstacles),
        start,
    )


@dataclass(frozen=True, slots=True, eq=False)
class Side:
    """One side of a job: the part to be made in one setup, and what the tools do there.

    Attributes
    ----------
    part, milling : in coordinates in which the tools come from above.
    cuts : planned operations.
    runs : operations as they are simulated.
    density : of the material [t/mm^3]; None if it is not stated.
    """

    part: Part
    milling: MillingSpec
    cuts: tuple[Cut, ...]
    runs: tuple[ToolRun, ...]
    density: float | None = None

    @property
    def lowest(self) -> float:
        """Z of the part's lower face [mm]."""
        return self.part.layers[0].z0

    @property
    def left_to_do(self) -> MillingSpec | None:
        """What is stated for the second side, with what this first side has finished; None without
        a second side.

        A planned sequence finishes all walls that its tools reach: what it leaves out is in the
        blank already, or made otherwise.
        """
        finished = frozenset(
            wall.boundary.name
            for wall in self.part.walls
            if (is_finished(wall, [self]) if self.milling.operations else is_open(self.part, wall))
        )
        return self.milling.of_second_side(
            faced=any(map(faces, self.cuts)), finished_walls=finished
        )


def simulation_setup(
    side: Side, tolerance: float = PART_FINENESS, others: Iterable[Cut] = ()
) -> Setup:
    """What a program starts from, and the part that must come of it, within `tolerance` [mm].

    The part to compare with has no holes and marks that neither its own cuts nor `others`, those of
    the other side, make: they are made otherwise. A bore with a keyway counts as round, as a round
    cutter leaves the keyway to be broached; letters have the rounded corners that the cutter
    leaves. Where the outline of the blank is not known, it reaches beyond all moves of the runs.

    Without a holding, pieces that come loose are not checked; with one, nothing else holds them:
    clamps and screws do so while they are set.
    """
    part, stock, holding = side.part, side.milling.stock, side.milling.holding
    every = (*side.cuts, *others)
    target, letters = part.without(unmade_names(part, every)), _letters(every)
    bodies = tuple(
        UprightBody(
            layer.name,
            layer.z0,
            layer.z1,
            tuple(_contours(layer.boundaries, letters, tolerance)),
        )
        for layer in target.layers
    )
    low, high = side.lowest, part.layers[-1].z1
    outline, rim, known = _blank(side, tolerance)
    blank = [outline]
    if stock.bore is not None:
        blank.append(Contour.circle(0.5 * stock.bore))
    # What lies below the part, tabs or a skin join waste to it up to that height.
    joined = [low] if stock.bottom > 0.0 else []
    held = None
    lowest = None
    if holding is not None:
        held = (bodies[0].contours,) if holding.kind == FIXTURE else ()
        left = _height_left(holding)
        joined += [] if left is None else [low + left]
        lowest = low - max(holding.through, 0.0)
    return Setup(
        tuple(blank),
        high + stock.top,
        low - stock.bottom,
        bodies,
        held,
        rim if holding is not None and holding.kind in (TABS, ONION_SKIN) else None,
        fixture=holding is not None and holding.kind == FIXTURE,
        chamfers=tuple(_chamfers(side.cuts, tolerance)),
        lowest=lowest,
        joined=max(joined, default=None),
        known=known,
    )


def unmade_names(part: Part, cuts: Iterable[Cut]) -> tuple[str, ...]:
    """Names of the holes, marks and letters that no cut makes, and of a bore if no round cutter
    makes it.
    """
    produced = _produced(cuts)
    return tuple(
        boundary.name
        for boundary in part.boundaries
        if (isinstance(boundary, ExactBoundary) and boundary.hole) or text_name(boundary.name)
        if boundary.name not in produced
        if boundary.name != BORE or not (isinstance(boundary, ExactBoundary) and boundary.is_round)
    )


def _chamfers(cuts: Iterable[Cut], tolerance: float) -> Iterator[Chamfer]:
    """The chamfers that cones cut, each with the exact course of the cone's tip."""
    for cut in cuts:
        if isinstance(cut, ContourCut) and cut.tool.kind == CHAMFER_MILL:
            course = level(cut.centre.arcs(tolerance, "fast").contour, cut.bottom)
            yield Chamfer(tool_run(cut.tool, cut.name, (), (), None), course, cut.top)


def level(contour: Contour, z: float) -> Course:
    """The course once around a closed contour at the height `z` [mm], as a single move."""
    flat = Pieces.around([contour])
    heights, moves = np.full(len(flat), z), np.zeros(len(flat), dtype=np.intp)
    return Course(flat.starts, flat.ends, flat.sweeps, flat.centres, heights, heights, moves)


def _letters(cuts: Iterable[Cut]) -> dict[str, list[Contour]]:
    """The outlines that cutters make of texts, by the name of the first boundary of each text."""
    letter_cuts = [cut for cut in cuts if isinstance(cut, LetterCut)]
    if not letter_cuts:
        return {}
    from camgeo.milling.strategies import letter_outlines

    return {cut.produced[0]: letter_outlines(cut) for cut in letter_cuts}


def _contours(
    boundaries: Iterable[Boundary], letters: Mapping[str, list[Contour]], tolerance: float
) -> Iterator[Contour]:
    for boundary in boundaries:
        if text_name(boundary.name):
            yield from letters.get(boundary.name, ())
        else:
            yield _contour(boundary, tolerance)


def _contour(boundary: Boundary, tolerance: float) -> Contour:
    core = boundary.core if isinstance(boundary, ExactBoundary) else None
    return boundary.arcs(tolerance, "fast").contour if core is None else core


def _body(obstacle: Obstacle) -> UprightBody:
    contour = obstacle.outline.arcs(ROUGHLY, "fast").contour
    return UprightBody(obstacle.name, -np.inf, obstacle.top, (contour,))


def _blank(side: Side, tolerance: float) -> tuple[Contour, tuple[Contour, ...], bool]:
    """The outline of the blank, the strip along it, and whether the outline is known.

    Where it is not known it is the outermost boundary of the part, if nothing cuts that one, else
    a square around all.
    """
    stock, outermost = side.milling.stock, side.part.outermost
    if stock.diameter is not None:
        radius = 0.5 * stock.diameter
        outline = Contour.circle(radius, stock.centre)
        inner = Contour.circle(max(radius - RIM, 0.5 * radius), stock.centre)
        return outline, (outline, inner), True
    known = True
    if stock.length is not None and stock.width is not None:
        corner, centre = 0.5 * complex(stock.length, stock.width), stock.centre
    elif outermost.name not in _produced(side.cuts):
        outline = _contour(outermost, tolerance)
        # The strip inside the outline: scaled about the cam axis, `RIM` wide where it is farthest.
        share = 1.0 - RIM / float(np.max(np.abs(outline.vertices)))
        inner = Contour(share * outline.vertices, outline.sweeps, share * outline.centres)
        return outline, (outline, inner), True
    else:
        ends = [feed_course(run.moves, run.start).ends for run in side.runs]
        # A square about the cam axis that reaches beyond the farthest coordinate of any move.
        both = [np.abs(part) for points in ends for part in (points.real, points.imag)]
        reach = max((float(np.max(part, initial=0.0)) for part in both), default=0.0)
        wide = 2.0 * UNKNOWN * max((run.radius for run in side.runs), default=0.0)
        corner, centre, known = (reach + wide) * (1.0 + 1.0j), 0j, False
    outline = rectangle(corner, centre)
    return outline, (outline, rectangle(corner - RIM * (1.0 + 1.0j), centre)), known


def _produced(cuts: Iterable[Cut]) -> set[str]:
    """Names of the boundaries that are cut."""
    return {name for cut in cuts for name in cut.produced}


# -- verdict --------------------------------------------------------------------------------------
# The verdict on a program: what its simulation finds, and what of it must not be run.


def finished_walls(cut: Cut) -> tuple[str, ...]:
    """Names of the walls that a cut finishes: those that it produces without an allowance."""
    return () if cut.allowance else cut.produced


def finished_depth(cuts: Iterable[Cut], name: str) -> float:
    """Z down to which cuts finish the wall `name` [mm]; infinite if none does."""
    return min((cut.bottom for cut in cuts if name in finished_walls(cut)), default=math.inf)


def required_depth(wall: Wall, holding: Holding | None) -> float:
    """Z down to which a wall is to be cut [mm]: a skin is left, to be removed by hand."""
    return wall.z0 + (0.0 if holding is None else holding.skin or 0.0)


def faces(cut: Cut) -> bool:
    """Whether a cut is a facing, which removes all that lies above the part."""
    return isinstance(cut, AreaCut) and not cut.walls


# -- sides ----------------------------------------------------------------------------------------
# A job of one side or two, simulated: the second side starts from what the first one has left.
#
# Each side is simulated in coordinates in which its tools come from above
# (`camgeo.milling.milling`); what is handed on is turned over, slab by slab. What the part must be
# in the end is asked after the last side alone, of the material that both have left.


@dataclass(frozen=True, slots=True, eq=False)
class SimulatedSide:
    """A side of a job with the setup and the result of its simulation."""

    side: Side
    setup: Setup
    simulation: Simulation


def simulation_setups(sides: Sequence[Side], side_count: int) -> tuple[Setup, ...]:
    """The setup of each of the first `sides` of a job with `side_count` sides, without the material
    that an earlier side leaves, which only its simulation knows.
    """
    setups: list[Setup] = []
    for k, side in enumerate(sides):
        others = [cut for other in sides if other is not side for cut in other.cuts]
        setup = simulation_setup(side, others=others)
        if k:
            setup = _second_setup(setup, side, sides[k - 1], setups[k - 1])
        setups.append(
            replace(
                setup,
                final=k == side_count - 1,
                density=side.density,
                unfinished=tuple(_unfinished(sides)),
            )
        )
    return tuple(setups)


def simulate_sides(
    sides: Sequence[Side], *, allowed: float, level: float, side_count: int
) -> tuple[SimulatedSide, ...]:
    """Simulate the first `sides` of a job with `side_count` sides one after the other, each from
    the material that the one before it has left; `allowed` and `level` as of `simulate`.
    """
    simulated_sides: list[SimulatedSide] = []
    for side, setup in zip(sides, simulation_setups(sides, side_count), strict=True):
        side_setup = setup
        if simulated_sides:
            first = simulated_sides[-1]
            left = first.simulation.turned_over(first.setup, first.side.runs, first.side.lowest)
            side_setup = replace(setup, leftover=left)
        simulated_sides.append(
            SimulatedSide(
                side, side_setup, simulate(side_setup, side.runs, allowed=allowed, level=level)
            )
        )
    return tuple(simulated_sides)


def side_flaws(done: Sequence[SimulatedSide]) -> tuple[tuple[Flaw, ...], ...]:
    """The flaws of each side, their places as its work lies on the machine."""
    return tuple(
        tuple(_placed_flaw(flaw, simulated_side.side) for flaw in simulated_side.simulation.flaws)
        for simulated_side in done
    )


def _unfinished(sides: Sequence[Side]) -> Iterator[Contour]:
    """The walls that stated operations leave unfinished: material there is a warning, no error."""
    if not any(side.milling.operations for side in sides):
        return
    for wall in sides[0].part.walls:
        if not is_finished(wall, sides):
            yield wall.boundary.arcs(PART_FINENESS, "fast").contour


def is_finished(wall: Wall, sides: Sequence[Side]) -> bool:
    """Whether all of a wall is finished, by one side or by two that meet on it."""
    first, name = sides[0], wall.boundary.name
    down = finished_depth(first.cuts, name)
    if down <= required_depth(wall, first.milling.holding):
        return True
    if len(sides) == 1:
        return False
    second, low = sides[1], first.lowest
    # The second side sees heights reflected, from the lower face up: z becomes low - z.
    turned = replace(wall, z0=low - wall.z1, z1=low - wall.z0)
    below = finished_depth(second.cuts, name)
    return below <= required_depth(turned, second.milling.holding) or down <= low - below


def _placed_flaw(flaw: Flaw, side: Side) -> Flaw:
    """The flaw with its place as the work lies on the machine."""
    x, y, z = flaw.place
    place = mirrored(complex(x, y), side.milling.turned)
    return replace(flaw, place=(place.real, place.imag, z))


def _second_setup(setup: Setup, side: Side, first: Side, before: Setup) -> Setup:
    """The setup of a second side, whose blank is what the first one has left.

    A fixture holds the part alone. Waste that the first side has left on tabs or a skin may stay,
    unless this side finishes a wall around the part, which frees it.
    """
    holding = side.milling.holding
    remaining, hanging = _height_left(holding), _height_left(first.milling.holding)
    if any(_frees(cut, side) for cut in side.cuts):
        hanging = None
    held = setup.held
    if holding is not None and holding.kind == FIXTURE:
        held = tuple(body.contours for body in setup.part)
    chamfers = (replace(chamfer, turned=first.lowest) for chamfer in before.chamfers)
    return replace(
        setup,
        held=held,
        joined=None if remaining is None else side.lowest + remaining,
        hanging=None if hanging is None else -hanging,
        chamfers=(*setup.chamfers, *chamfers),
    )


def _height_left(holding: Holding | None) -> float | None:
    """Height [mm] of what a holding leaves on the part: tabs, a skin; None for nothing."""
    if holding is None or holding.tabs is None:
        return None if holding is None else holding.skin
    return holding.tabs.height


def _frees(cut: Cut, side: Side) -> bool:
    """Whether a cut of the second side finishes a wall around the part."""
    around = {wall.boundary.name for wall in side.part.walls if not wall.boundary.hole}
    return bool(around & set(finished_walls(cut)))


# -- features -------------------------------------------------------------------------------------
# The features of a part compared with the operations that make them, on one side or two.


CHAMFERS = "chamfers"
OMITTED = "left-out"
KEYWAY = "keyway"
UNLIKE_THE_PART = "unlike-the-part"
"""Codes of findings on features that no operation makes, or that an operation makes otherwise than
the part states."""

UNMADE = "no operation makes it"

EDGE = " edge of the "
"""Part of the name of an edge before the name of its wall."""


@dataclass(frozen=True, slots=True)
class Feature:
    """A feature of the part, and what makes it.

    Attributes
    ----------
    name : "outline", "bolt hole 1", "upper edge of the outline".
    finding : name of the finding where it is not made as the part states.
    operations : that make it, or touch it if none finishes it.
    severity : "ok" if it is made, or there is nothing to be done; "broken" if more is taken off
        than the part states.
    difference : between part and operations, or who else makes it; empty if they make it.
    stated, made : width of a chamfer, or what is to be left and is left [mm]; None elsewhere.
    """

    name: str
    finding: str
    operations: tuple[str, ...] = ()
    severity: Severity = "ok"
    difference: str = ""
    stated: float | None = None
    made: float | None = None

    @property
    def edge_wall(self) -> str:
        """Name of the wall whose edge the feature is; empty if it is no edge."""
        return self.name.partition(EDGE)[2]

    @property
    def sentence(self) -> str:
        """The feature in words: its name, its operations and what differs."""
        listed = ", ".join(self.operations)
        return f"{self.name}: {'; '.join(text for text in (listed, self.difference) if text)}"


def compare_features(
    part: Part, keyway: Keyway | None, sides: Sequence[Side]
) -> tuple[Feature, ...]:
    """All walls, edges and faces of a part, compared with what the sides of its job make.

    Parameters
    ----------
    part : with its chamfers.
    keyway : of its bore; None without one.
    sides : the first one, from above, and perhaps a second.
    """
    features: dict[str, Feature] = {}
    for wall in sides[0].part.walls:
        feature = _wall(wall, sides)
        if feature.name not in features or features[feature.name].severity == "ok":
            features[feature.name] = feature
    return (
        *_faces(sides),
        *features.values(),
        *(_keyway(keyway) if keyway is not None and BORE in features else ()),
        *_edges(part, sides),
    )


def feature_findings(features: Iterable[Feature]) -> Iterator[Finding]:
    """The findings on features that are not made as the part states; all features that no operation
    makes share one sentence.
    """
    features = tuple(features)
    unmade = [
        feature for feature in features if feature.difference == UNMADE and feature.severity != "ok"
    ]
    walls = [feature.name for feature in unmade if feature.finding == OMITTED]
    if walls:
        yield Finding(OMITTED, "warning", f"no operation makes {', '.join(walls)}")
    if any(feature.edge_wall for feature in unmade):
        others = {
            feature.edge_wall for feature in features if feature.edge_wall and feature not in unmade
        }
        named = (
            feature.name if feature.edge_wall in others else feature.edge_wall for feature in unmade
        )
        listed = ", ".join(dict.fromkeys(name for name in named if name))
        yield Finding(CHAMFERS, "warning", f"no operation makes the chamfers of {listed}")
    for feature in features:
        if feature.severity != "ok" and feature not in unmade:
            yield Finding(
                feature.finding, feature.severity, feature.sentence, feature.made, feature.stated,
                "" if feature.made is None else "mm",
            )  # fmt: skip


def _faces(sides: Sequence[Side]) -> Iterator[Feature]:
    """The upper and the lower face of the part as features."""
    stock = sides[0].milling.stock
    for name, more, responsible in (
        ("upper face", stock.top, sides[:1]),
        ("lower face", stock.bottom, sides[1:]),
    ):
        cuts = [cut.name for side in responsible for cut in side.cuts if faces(cut)]
        if not more:
            yield Feature(name, OMITTED, difference="that of the blank")
        elif cuts:
            yield Feature(name, OMITTED, tuple(cuts))
        else:
            text = f"no operation takes off {more:g} mm of the blank"
            yield Feature(name, UNLIKE_THE_PART, (), "warning", text, 0.0, more)


def _wall(wall: Wall, sides: Sequence[Side]) -> Feature:
    name = wall.boundary.name
    cuts = [cut for side in sides for cut in side.cuts if name in cut.produced]
    finishing = tuple(cut.name for cut in cuts if name in finished_walls(cut))
    called = text_name(name) or name
    stated = any(side.milling.operations for side in sides)
    severity: Severity = "warning" if stated else "ok"
    if is_finished(wall, sides):
        return Feature(called, OMITTED, finishing)
    if finishing:
        return Feature(
            called, UNLIKE_THE_PART, finishing, severity, "not all of its height is finished"
        )
    if cuts:
        left = min(cut.allowance for cut in cuts)
        names = tuple(cut.name for cut in cuts)
        return Feature(
            called, UNLIKE_THE_PART, names, severity, f"{left:g} mm are left on it", 0.0, left
        )
    if _is_in_the_blank(wall, sides[0].part, sides[0].milling.stock):
        return Feature(called, OMITTED, difference="the blank has it")
    return Feature(called, OMITTED, (), severity, UNMADE)


def _is_in_the_blank(wall: Wall, part: Part, stock: Stock) -> bool:
    """Whether the blank has a bore or a rim already; a rim counts as its own unless its outline is
    stated and differs.
    """
    boundary = wall.boundary
    if not isinstance(boundary, ExactBoundary) or not boundary.is_round:
        return False
    diameter = 2.0 * boundary.round_radius
    there = stock.bore if boundary.name == BORE else stock.diameter
    if there is not None and not (boundary.name != BORE and stock.centre):
        return abs(there - diameter) <= SAME * diameter
    return boundary == part.outermost and stock.outline is None


def _keyway(keyway: Keyway) -> Iterator[Feature]:
    """The keyway as a feature: a round cutter leaves it to be broached."""
    angle = math.degrees(keyway.angle)
    text = f"{keyway.width:g} mm wide at {angle:g} deg: no operation makes it; it must be broached"
    yield Feature(KEYWAY, KEYWAY, (), "warning", text)


def _edges(part: Part, sides: Sequence[Side]) -> Iterator[Feature]:
    """The chamfers that the part states, and further ones that operations make."""
    chamfer_cuts: dict[tuple[str, bool], list[ContourCut]] = {}
    for upper, side in zip((True, False), sides, strict=False):
        for cut in side.cuts:
            if isinstance(cut, ContourCut) and cut.edge:
                chamfer_cuts.setdefault((cut.edge, upper), []).append(cut)
    for bevel in part.bevels:
        yield _edge(bevel, chamfer_cuts.pop((bevel.boundary.name, bevel.upper), []))
    for (name, upper), cuts in chamfer_cuts.items():
        width = max(cut.width for cut in cuts)
        text = f"{width:g} mm wide, but the part states a sharp edge"
        names = tuple(cut.name for cut in cuts)
        yield Feature(_edge_name(name, upper=upper), CHAMFERS, names, "warning", text, 0.0, width)


def _edge(bevel: Bevel, cuts: Sequence[Cut]) -> Feature:
    """A chamfer of the part, compared with the cuts along its edge: a cone whose point has another
    angle makes it as wide on the face, but lower or higher on the wall.
    """
    name = _edge_name(bevel.boundary.name, upper=bevel.upper)
    names = tuple(cut.name for cut in cuts)
    if not cuts:
        return Feature(name, CHAMFERS, (), "warning", UNMADE, bevel.width, 0.0)
    width = max(cut.width for cut in cuts if isinstance(cut, ContourCut))
    slope = max(cut.tool.tip_length / cut.tool.radius for cut in cuts)
    # The deviation of the larger magnitude, in width or in height; positive if too much is taken
    # off.
    deviation = max(width - bevel.width, width * slope - bevel.height, key=abs)
    if abs(deviation) > ALLOWED:
        text = (
            f"{width:g} mm wide and {width * slope:.3g} mm high, the part states {bevel.width:g} mm"
            f" and {bevel.height:g} mm"
        )
        severity: Severity = "broken" if deviation > 0.0 else "warning"
        return Feature(name, CHAMFERS, names, severity, text, bevel.width, width)
    if bevel.boundary.corner_radius is not None:
        return Feature(
            name,
            CHAMFERS,
            names,
            "warning",
            "only its circular part is made",
            bevel.width,
            width,
        )
    return Feature(name, CHAMFERS, names, stated=bevel.width, made=width)


def _edge_name(name: str, *, upper: bool) -> str:
    return f"{'upper' if upper else 'lower'}{EDGE}{name}"
