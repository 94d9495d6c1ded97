"""A job as a simulation judges it: its runs, what each side starts from, and the verdict; and which
features of the part its operations make.
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
from camgeo.milling.moves import Course, Move, Point, Stop, Toolpath, course_of
from camgeo.milling.simulation import (
    ALLOWED,
    Body,
    Chamfer,
    Flaw,
    Run,
    Setup,
    Simulation,
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
"""Diameters of the cutter by which a blank of unknown outline reaches beyond the course."""


PART_FINENESS: Final = 1e-3
"""Of the contours with which the part is compared [mm]."""


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


@dataclass(frozen=True, slots=True, eq=False)
class Side:
    """One setup of a job: what is to be made, and what its tools do.

    Attributes
    ----------
    part, milling : as tools from above see them.
    cuts : that are planned.
    runs : what is run.
    density : of the material [t/mm^3]; None if it is not stated.
    """

    part: Part
    milling: MillingSpec
    cuts: tuple[Cut, ...]
    runs: tuple[Run, ...]
    density: float | None = None

    @property
    def lowest(self) -> float:
        """Z of the part's lower face [mm]."""
        return self.part.layers[0].z0

    @property
    def left_to_do(self) -> MillingSpec | None:
        """What is stated on the second side, with what this first one has done; None without one.

        Of a planned sequence all walls that tools reach are done: what it leaves out is there, or
        made otherwise.
        """
        done = frozenset(
            wall.boundary.name
            for wall in self.part.walls
            if (is_finished(wall, [self]) if self.milling.operations else is_open(self.part, wall))
        )
        return self.milling.of_second_side(faced=any(map(faces, self.cuts)), done=done)


def setup_of(side: Side, tolerance: float = PART_FINENESS, others: Iterable[Cut] = ()) -> Setup:
    """What a program starts from, and the part that must come of it, within `tolerance` [mm].

    Its cuts say which walls are cut, and where the outline of the blank is not known, its runs how
    far it must reach. Holes and marks that neither they nor `others` make, the cuts of another
    side, are none of that part: they are made otherwise.
    A bore with a keyway counts as round: a round cutter leaves the keyway to be broached. Letters
    count as what the cutter makes of them. Without a
    holding nothing is said of pieces that come loose; with one, only what it holds is held: clamps
    and screws as long as they are set.
    """
    part, stock, holding = side.part, side.milling.stock, side.milling.holding
    every = (*side.cuts, *others)
    made, letters = part.without(left_out(part, every)), _letters(every)
    bodies = tuple(
        Body(
            layer.name,
            layer.z0,
            layer.z1,
            tuple(_contours(layer.boundaries, letters, tolerance)),
        )
        for layer in made.layers
    )
    low, high = side.lowest, part.layers[-1].z1
    outline, rim, known = _blank(side, tolerance)
    blank = [outline]
    if stock.bore is not None:
        blank.append(Contour.circle(0.5 * stock.bore))
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


def left_out(part: Part, cuts: Iterable[Cut]) -> tuple[str, ...]:
    """Names of the holes, marks and letters that no cut makes, and of a bore if no round cutter
    makes it.
    """
    made = _produced(cuts)
    return tuple(
        each.name
        for each in part.boundaries
        if (isinstance(each, ExactBoundary) and each.hole) or text_name(each.name)
        if each.name not in made
        if each.name != BORE or not (isinstance(each, ExactBoundary) and each.is_round)
    )


def _chamfers(cuts: Iterable[Cut], tolerance: float) -> Iterator[Chamfer]:
    """The edges that cones take off the part on their exact courses."""
    for cut in cuts:
        if isinstance(cut, ContourCut) and cut.tool.kind == CHAMFER_MILL:
            course = level(cut.centre.arcs(tolerance, "fast").contour, cut.bottom)
            yield Chamfer(run_with(cut.tool, cut.name, (), (), None), course, cut.top)


def level(contour: Contour, z: float) -> Course:
    """Around a closed contour at one height [mm], as a single move."""
    flat = Pieces.around([contour])
    heights, moves = np.full(len(flat), z), np.zeros(len(flat), dtype=np.intp)
    return Course(flat.starts, flat.ends, flat.sweeps, flat.centres, heights, heights, moves)


def _letters(cuts: Iterable[Cut]) -> dict[str, list[Contour]]:
    """What cutters make of texts, by the name of the first boundary of each."""
    found = [each for each in cuts if isinstance(each, LetterCut)]
    if not found:
        return {}
    from camgeo.milling.strategies import reached

    return {each.produced[0]: reached(each) for each in found}


def _contours(
    boundaries: Iterable[Boundary], letters: Mapping[str, list[Contour]], tolerance: float
) -> Iterator[Contour]:
    for each in boundaries:
        if text_name(each.name):
            yield from letters.get(each.name, ())
        else:
            yield _contour(each, tolerance)


def _contour(boundary: Boundary, tolerance: float) -> Contour:
    core = boundary.core if isinstance(boundary, ExactBoundary) else None
    return boundary.arcs(tolerance, "fast").contour if core is None else core


def _body(obstacle: Obstacle) -> Body:
    contour = obstacle.outline.arcs(ROUGHLY, "fast").contour
    return Body(obstacle.name, -np.inf, obstacle.top, (contour,))


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
        share = 1.0 - RIM / float(np.max(np.abs(outline.vertices)))
        inner = Contour(share * outline.vertices, outline.sweeps, share * outline.centres)
        return outline, (outline, inner), True
    else:
        ends = [course_of(run.moves, run.start).ends for run in side.runs]
        both = [np.abs(part) for each in ends for part in (each.real, each.imag)]
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


def finished_by(cut: Cut) -> tuple[str, ...]:
    """Names of the walls that a cut leaves as they are to be."""
    return () if cut.allowance else cut.produced


def finished_down_to(cuts: Iterable[Cut], name: str) -> float:
    """Z down to which cuts leave a wall as it is to be [mm]; infinite if none does."""
    return min((cut.bottom for cut in cuts if name in finished_by(cut)), default=math.inf)


def lowest_of(wall: Wall, holding: Holding | None) -> float:
    """Z down to which a wall is to be cut [mm]: a skin is left, to be removed by hand."""
    return wall.z0 + (0.0 if holding is None else holding.skin or 0.0)


def faces(cut: Cut) -> bool:
    """Whether a cut takes off all that lies above the part."""
    return isinstance(cut, AreaCut) and not cut.walls


# -- sides ----------------------------------------------------------------------------------------
# A job of one side or two, simulated: the second side starts from what the first one has left.
#
# Each side is judged in coordinates in which its tools come from above (`camgeo.milling.milling`);
# what is handed on is turned over, slab by slab. What the part must be in the end is asked after
# the last side alone, of the material that both have left.


@dataclass(frozen=True, slots=True, eq=False)
class Done:
    """A side that is simulated."""

    side: Side
    setup: Setup
    simulation: Simulation


def setups_of(sides: Sequence[Side], of: int) -> tuple[Setup, ...]:
    """What each side, the first ones `of` a job, starts from but for the material that is left, and
    what must come of it.
    """
    found: list[Setup] = []
    for k, side in enumerate(sides):
        others = [cut for other in sides if other is not side for cut in other.cuts]
        setup = setup_of(side, others=others)
        if k:
            setup = _second(setup, side, sides[k - 1], found[k - 1])
        found.append(
            replace(
                setup,
                final=k == of - 1,
                density=side.density,
                unfinished=tuple(_unfinished(sides)),
            )
        )
    return tuple(found)


def simulated(sides: Sequence[Side], *, allowed: float, level: float, of: int) -> tuple[Done, ...]:
    """Each of the first sides `of` a job, as `simulate` judges it, from what the one before it has
    left.
    """
    done: list[Done] = []
    for side, setup in zip(sides, setups_of(sides, of), strict=True):
        own = setup
        if done:
            first = done[-1]
            left = first.simulation.turned_over(first.setup, first.side.runs, first.side.lowest)
            own = replace(setup, before=left)
        done.append(Done(side, own, simulate(own, side.runs, allowed=allowed, level=level)))
    return tuple(done)


def settled(done: Sequence[Done]) -> tuple[tuple[Flaw, ...], ...]:
    """The flaws of each side, as its work lies."""
    return tuple(tuple(_seen(flaw, each.side) for flaw in each.simulation.flaws) for each in done)


def _unfinished(sides: Sequence[Side]) -> Iterator[Contour]:
    """The walls that stated operations leave unfinished: what they leave there is to be watched."""
    if not any(side.milling.operations for side in sides):
        return
    for wall in sides[0].part.walls:
        if not is_finished(wall, sides):
            yield wall.boundary.arcs(PART_FINENESS, "fast").contour


def is_finished(wall: Wall, sides: Sequence[Side]) -> bool:
    """Whether one side leaves all of a wall as it is to be, or two that meet on it."""
    first, name = sides[0], wall.boundary.name
    down = finished_down_to(first.cuts, name)
    if down <= lowest_of(wall, first.milling.holding):
        return True
    if len(sides) == 1:
        return False
    second, low = sides[1], first.lowest
    turned = replace(wall, z0=low - wall.z1, z1=low - wall.z0)
    below = finished_down_to(second.cuts, name)
    return below <= lowest_of(turned, second.milling.holding) or down <= low - below


def _seen(flaw: Flaw, side: Side) -> Flaw:
    """The same with its place as the work lies."""
    x, y, z = flaw.place
    place = mirrored(complex(x, y), side.milling.turned)
    return replace(flaw, place=(place.real, place.imag, z))


def _second(setup: Setup, side: Side, first: Side, before: Setup) -> Setup:
    """The setup of a second side, whose blank is what the first one has left.

    A fixture holds the part alone. What the first side has left hanging may stay, unless a wall is
    finished that frees the part.
    """
    holding = side.milling.holding
    own, hanging = _height_left(holding), _height_left(first.milling.holding)
    if any(_frees(cut, side) for cut in side.cuts):
        hanging = None
    held = setup.held
    if holding is not None and holding.kind == FIXTURE:
        held = tuple(body.contours for body in setup.part)
    chamfers = (replace(each, turned=first.lowest) for each in before.chamfers)
    return replace(
        setup,
        held=held,
        joined=None if own is None else side.lowest + own,
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
    return bool(around & set(finished_by(cut)))


# -- features -------------------------------------------------------------------------------------
# The features of a part compared with the operations that make them, on one side or two.


CHAMFERS = "chamfers"
LEFT_OUT = "left-out"
KEYWAY = "keyway"
UNLIKE_THE_PART = "unlike-the-part"
"""Names of findings on features that no operation makes, and on those that one makes otherwise."""

UNMADE = "no operation makes it"

EDGE = " edge of the "
"""In the name of an edge, before that of its wall."""


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
    def edge_of(self) -> str:
        """Name of the wall of which it is an edge; empty of anything else."""
        return self.name.partition(EDGE)[2]

    @property
    def sentence(self) -> str:
        """In words, with the operations."""
        by = ", ".join(self.operations)
        return f"{self.name}: {'; '.join(each for each in (by, self.difference) if each)}"


def features_of(part: Part, keyway: Keyway | None, sides: Sequence[Side]) -> tuple[Feature, ...]:
    """Every wall, edge and face of a part, as the sides of its job make them.

    Parameters
    ----------
    part : with its chamfers.
    keyway : of its bore; None without one.
    sides : the first one, from above, and perhaps a second.
    """
    found: dict[str, Feature] = {}
    for wall in sides[0].part.walls:
        feature = _wall(wall, sides)
        if feature.name not in found or found[feature.name].severity == "ok":
            found[feature.name] = feature
    return (
        *_faces(sides),
        *found.values(),
        *(_keyway(keyway) if keyway is not None and BORE in found else ()),
        *_edges(part, sides),
    )


def findings_of(features: Iterable[Feature]) -> Iterator[Finding]:
    """What is told of features that are not made as the part states; those that no operation makes
    in one sentence.
    """
    features = tuple(features)
    unmade = [each for each in features if each.difference == UNMADE and each.severity != "ok"]
    walls = [each.name for each in unmade if each.finding == LEFT_OUT]
    if walls:
        yield Finding(LEFT_OUT, "warning", f"no operation makes {', '.join(walls)}")
    if any(each.edge_of for each in unmade):
        others = {each.edge_of for each in features if each.edge_of and each not in unmade}
        named = (each.name if each.edge_of in others else each.edge_of for each in unmade)
        listed = ", ".join(dict.fromkeys(name for name in named if name))
        yield Finding(CHAMFERS, "warning", f"no operation makes the chamfers of {listed}")
    for each in features:
        if each.severity != "ok" and each not in unmade:
            yield Finding(
                each.finding, each.severity, each.sentence, each.made, each.stated,
                "" if each.made is None else "mm",
            )  # fmt: skip


def _faces(sides: Sequence[Side]) -> Iterator[Feature]:
    """The face that lies up, and the one below."""
    stock = sides[0].milling.stock
    for name, more, own in (
        ("upper face", stock.top, sides[:1]),
        ("lower face", stock.bottom, sides[1:]),
    ):
        cuts = [cut.name for side in own for cut in side.cuts if faces(cut)]
        if not more:
            yield Feature(name, LEFT_OUT, difference="that of the blank")
        elif cuts:
            yield Feature(name, LEFT_OUT, tuple(cuts))
        else:
            text = f"no operation takes off {more:g} mm of the blank"
            yield Feature(name, UNLIKE_THE_PART, (), "warning", text, 0.0, more)


def _wall(wall: Wall, sides: Sequence[Side]) -> Feature:
    name = wall.boundary.name
    cuts = [cut for side in sides for cut in side.cuts if name in cut.produced]
    made = tuple(cut.name for cut in cuts if name in finished_by(cut))
    called = text_name(name) or name
    stated = any(side.milling.operations for side in sides)
    severity: Severity = "warning" if stated else "ok"
    if is_finished(wall, sides):
        return Feature(called, LEFT_OUT, made)
    if made:
        return Feature(called, UNLIKE_THE_PART, made, severity, "not all of its height is finished")
    if cuts:
        left = min(cut.allowance for cut in cuts)
        by = tuple(cut.name for cut in cuts)
        return Feature(
            called, UNLIKE_THE_PART, by, severity, f"{left:g} mm are left on it", 0.0, left
        )
    if _is_in_the_blank(wall, sides[0].part, sides[0].milling.stock):
        return Feature(called, LEFT_OUT, difference="the blank has it")
    return Feature(called, LEFT_OUT, (), severity, UNMADE)


def _is_in_the_blank(wall: Wall, part: Part, stock: Stock) -> bool:
    """Whether a bore or a rim is that of the blank; a rim is, unless the blank is another."""
    boundary = wall.boundary
    if not isinstance(boundary, ExactBoundary) or not boundary.is_round:
        return False
    diameter = 2.0 * boundary.round_radius
    there = stock.bore if boundary.name == BORE else stock.diameter
    if there is not None and not (boundary.name != BORE and stock.centre):
        return abs(there - diameter) <= SAME * diameter
    return boundary == part.outermost and stock.outline is None


def _keyway(keyway: Keyway) -> Iterator[Feature]:
    """A round cutter leaves it."""
    angle = math.degrees(keyway.angle)
    text = f"{keyway.width:g} mm wide at {angle:g} deg: no operation makes it, it is to be broached"
    yield Feature(KEYWAY, KEYWAY, (), "warning", text)


def _edges(part: Part, sides: Sequence[Side]) -> Iterator[Feature]:
    """The chamfers that the part states, and those that operations make beside them."""
    made: dict[tuple[str, bool], list[ContourCut]] = {}
    for upper, side in zip((True, False), sides, strict=False):
        for cut in side.cuts:
            if isinstance(cut, ContourCut) and cut.edge:
                made.setdefault((cut.edge, upper), []).append(cut)
    for bevel in part.bevels:
        yield _edge(bevel, made.pop((bevel.boundary.name, bevel.upper), []))
    for (name, upper), cuts in made.items():
        width = max(cut.width for cut in cuts)
        text = f"{width:g} mm wide, the part states a sharp edge"
        by = tuple(cut.name for cut in cuts)
        yield Feature(_called(name, upper=upper), CHAMFERS, by, "warning", text, 0.0, width)


def _edge(bevel: Bevel, cuts: Sequence[Cut]) -> Feature:
    """A chamfer of the part, with the cuts along its edge; a cone whose point has another angle
    makes it as wide on the face, and lower or higher on the wall.
    """
    name = _called(bevel.boundary.name, upper=bevel.upper)
    by = tuple(cut.name for cut in cuts)
    if not cuts:
        return Feature(name, CHAMFERS, (), "warning", UNMADE, bevel.width, 0.0)
    width = max(cut.width for cut in cuts if isinstance(cut, ContourCut))
    slope = max(cut.tool.tip_length / cut.tool.radius for cut in cuts)
    off = max(width - bevel.width, width * slope - bevel.height, key=abs)
    if abs(off) > ALLOWED:
        text = (
            f"{width:g} mm wide and {width * slope:.3g} mm high, the part states {bevel.width:g} mm"
            f" and {bevel.height:g} mm"
        )
        severity: Severity = "broken" if off > 0.0 else "warning"
        return Feature(name, CHAMFERS, by, severity, text, bevel.width, width)
    if bevel.boundary.corner_radius is not None:
        return Feature(
            name, CHAMFERS, by, "warning", "it is made along the circle alone", bevel.width, width
        )
    return Feature(name, CHAMFERS, by, stated=bevel.width, made=width)


def _called(name: str, *, upper: bool) -> str:
    return f"{'upper' if upper else 'lower'}{EDGE}{name}"
