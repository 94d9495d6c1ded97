"""Simulation of a milling program: what is left of the blank, and what goes wrong on the way.

The blank is cut into slabs between all heights that matter: those of the part, of the blank, and of
passes at one depth. In each slab the material is an area, and every move takes away what its cutter
sweeps there. So it judges any moves, whatever planned them: those of camgeo's strategies as well as
those of a program that the interpreter has read. `camgeo.milling.polygons` says how exact the areas
are.

In each slab a cutter has the radius that it has in its middle: exactly that of an upright wall, and
of cones and rounded corners at heights between which slabs are thin.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise, product
from typing import Any, Final

import numpy as np
import shapely

from camgeo.check.finding import Finding, Severity
from camgeo.geometry.contour.contour import Contour
from camgeo.milling.moves import Course, Feed, Move, Point, Rapid, Stop, alike, feed_course
from camgeo.milling.polygons import NOTHING, Area, grown, parts, polygon
from camgeo.numeric.arrays import ComplexArray, FloatArray, taken

FINENESS: Final = 1e-3
"""Deviation of chords [mm] unless stated."""

ALLOWED: Final = 0.02
"""Length [mm] by which part and path may overlap or miss each other unless stated: far above the
deviation of the polygons, and not visible on a part."""

STEP: Final = 5e-3
"""Step [mm] to which the radii of a point or a rounded corner are rounded on sloping moves: always
to the disadvantage of the program."""

LEVEL: Final = 1e-6
"""Heights [mm] that differ by less are one, unless stated."""


@dataclass(frozen=True, slots=True, eq=False)
class UprightBody:
    """An upright body between two heights [mm]; a point is in it if within an odd number of its
    contours.
    """

    name: str
    z0: float
    z1: float
    contours: tuple[Contour, ...]


@dataclass(frozen=True, slots=True, eq=False)
class Slab:
    """The material between two heights [mm]."""

    z0: float
    z1: float
    material: Area

    @property
    def middle(self) -> float:
        """Height of its middle [mm]."""
        return 0.5 * (self.z0 + self.z1)


@dataclass(frozen=True, slots=True, eq=False)
class Stage:
    """The material after an operation, slab by slab from the lowest."""

    operation: str
    slabs: tuple[Slab, ...]

    @property
    def volume(self) -> float:
        """Volume of the material [mm^3]."""
        return sum((slab.z1 - slab.z0) * float(slab.material.area) for slab in self.slabs)


LOOSE_CORE: Final = "loose-core"
"""Code of findings on waste that is cut free in one piece."""


@dataclass(frozen=True, slots=True)
class Flaw:
    """A fault of a program, or something for the machinist to watch.

    Attributes
    ----------
    name : "rapid", "plunge", "gouge", "obstacle", "depth", "shank", "loose" or "rest".
    operation : in which it arises.
    text : what is wrong, in words.
    value, limit : what was found and what is allowed, in `unit`.
    place : of its largest extent, in the part's coordinates; as the work lies where it is shown.
    watched : whether it is no fault, but something for the machinist to watch.
    """

    name: str
    operation: str
    text: str
    value: float
    limit: float
    place: Point
    unit: str = "mm"
    watched: bool = False

    @property
    def sentence(self) -> str:
        """The flaw in words, with its operation and its place."""
        x, y, z = self.place
        return f"{self.operation}: {self.text} at X {x:.4g}, Y {y:.4g}, Z {z:.4g} mm"

    @property
    def excess(self) -> float:
        """By how much the limit is missed."""
        return abs(self.value - self.limit)

    @property
    def finding(self) -> Finding:
        """The finding: "broken" for a program that must not be run, "warning" for what the
        machinist is to watch.
        """
        name = LOOSE_CORE if self.name == "loose" and self.watched else self.name
        severity: Severity = "warning" if self.watched else "broken"
        return Finding(name, severity, self.sentence, self.value, self.limit, self.unit)


def _without(material: Area, area: Area) -> Area:
    """What is left of the material when `area` is taken away."""
    gone = material.is_empty or area.is_empty
    return material if gone else shapely.difference(material, area)


def areas(slabs: Iterable[Slab]) -> list[Area]:
    """The material of each slab."""
    return [slab.material for slab in slabs]


def map_distinct(answer: Callable[..., Any], *several: Iterable[Any]) -> list[Any]:
    """`map` over one or several sequences of equal length; equal combinations of the same objects
    are computed once.
    """
    # Objects are compared by identity: comparing or hashing large polygons would take longer.
    rows = list(zip(*several, strict=True))
    keys = [tuple(map(id, row)) for row in rows]
    known = {key: answer(*row) for key, row in dict(zip(keys, rows, strict=True)).items()}
    return [known[key] for key in keys]


# -- setup ----------------------------------------------------------------------------------------
# What a simulation of a milling program is given: what each tool does, and what it starts from.


SLICES: Final = 4
"""Number of slabs into which the height of a cutter's point or rounded corner is divided where it
runs lowest."""


@dataclass(frozen=True, slots=True, eq=False)
class ToolRun:
    """What one tool does: an operation.

    Attributes
    ----------
    name : of the operation.
    moves : in order, halts among them.
    radius : of the cutter [mm].
    point : height [mm] of its point or its rounded corners, below the full radius.
    rounded : whether that is a rounded corner, and not a cone.
    plunges : whether it may go straight down into material.
    shank : radius above the cutting edges, and their length [mm]; None if not known.
    obstacles : that no move may touch below their tops.
    start : where it stands before; None if the first move is a traverse.
    """

    name: str
    moves: tuple[Move | Stop, ...]
    radius: float
    point: float = 0.0
    rounded: bool = False
    plunges: bool = True
    shank: tuple[float, float] | None = None
    obstacles: tuple[UprightBody, ...] = ()
    start: Point | None = None

    def cutter_radii(self, height: FloatArray) -> FloatArray:
        """(n,) radius of the cutter [mm] at heights (n,) [mm] above its tip; below it, that of the
        tip.
        """
        if self.point <= 0.0:
            return np.full(len(height), self.radius)
        rise = np.clip(height, 0.0, self.point)
        if self.rounded:  # the quarter circle of a corner of the radius `point`
            return self.radius - self.point + np.sqrt(rise * (2.0 * self.point - rise))
        return self.radius * rise / self.point

    def slices(self, tip: float, top: float) -> list[float]:
        """Z [mm] from a tip up to a `top` between which the radius changes by equal steps or so."""
        share = np.arange(1, SLICES + 1) / SLICES
        if self.rounded:
            share = 1.0 - np.cos(0.5 * np.pi * share)  # equal angles of the quarter circle
        high = self.point if self.rounded else min(self.point, max(top - tip, 0.0))
        return (tip + high * share).tolist() if high > 0.0 else []


@dataclass(frozen=True, slots=True, eq=False)
class Chamfer:
    """An edge of the part that a cone takes off.

    Attributes
    ----------
    run : of the cone; its moves do not matter.
    course : exact, of its tip, all at one height.
    top : Z above which it is to take nothing off [mm].
    turned : height of the part's other face [mm], if it was taken off from there: run, course and
        top are those of that side.
    """

    run: ToolRun
    course: Course
    top: float
    turned: float | None = None

    def height(self, z: float) -> float:
        """The height `z` [mm] in the coordinates of the side from which the chamfer was cut, and
        back again: a reflection is its own inverse.
        """
        return z if self.turned is None else self.turned - z

    @property
    def heights(self) -> list[float]:
        """Heights [mm] between which the section of the part changes by about equal steps."""
        side_heights = self.run.slices(float(np.min(self.course.lowest)), self.top)
        return [self.height(z) for z in side_heights]


@dataclass(frozen=True, slots=True, eq=False)
class Leftover:
    """The material that another side has left, in the coordinates of this one.

    Attributes
    ----------
    slabs : of the material, from the lowest.
    corners : heights [mm] between which rounded corners of its cutters were lowest.
    """

    slabs: tuple[Slab, ...]
    corners: tuple[tuple[float, float], ...] = ()


@dataclass(frozen=True, slots=True, eq=False)
class Setup:
    """What a program starts from, and what must come of it.

    Attributes
    ----------
    blank : contours, of which a point of it is within an odd number.
    top, bottom : of the blank, Z [mm].
    part : what must be left.
    held : outlines within which the blank is held all the time, beside the clamps and screws of
        each run; None if that is not to be judged.
    rim : contours of the strip along the outline of the blank by which it is held where nothing
        else holds it, as with tabs; None if it is not.
    fixture : whether a fixture below all of the blank is to hold what nothing else holds.
    chamfers : edges that the part lacks.
    lowest : Z below which no tip may go but for its point [mm]; None for no limit.
    joined : Z up to which waste may hold on to the part [mm]: tabs, a skin; None for none.
    hanging : Z from which on it may do so; None for none.
    leftover : what an earlier side has left of the blank; None for all of it.
    final : whether the part must be all there is in the end, and no other side follows.
    unfinished : walls that the stated operations of all sides leave unfinished, or roughed.
    known : whether the outline of the blank is stated, and not one that reaches beyond all cuts.
    density : of the material [t/mm^3]; None if it is not stated.
    """

    blank: tuple[Contour, ...]
    top: float
    bottom: float
    part: tuple[UprightBody, ...] = ()
    held: tuple[tuple[Contour, ...], ...] | None = None
    rim: tuple[Contour, ...] | None = None
    fixture: bool = False
    chamfers: tuple[Chamfer, ...] = ()
    lowest: float | None = None
    joined: float | None = None
    hanging: float | None = None
    leftover: Leftover | None = None
    final: bool = True
    unfinished: tuple[Contour, ...] = ()
    known: bool = True
    density: float | None = None


# -- simulation ---


@dataclass(frozen=True, slots=True, eq=False)
class Simulation:
    """A program simulated.

    Attributes
    ----------
    stages : the material after each operation.
    flaws : in the order in which they arise; empty for a sound program. Of one kind in one
        operation only the worst is reported.
    part : the area of the part in each slab of a stage.
    """

    stages: tuple[Stage, ...]
    flaws: tuple[Flaw, ...]
    part: tuple[Area, ...]

    def turned_over(self, setup: Setup, runs: Iterable[ToolRun], lowest: float) -> Leftover:
        """The piece with the part in it as it lies for the other side; the lower face of the part
        is at Z `lowest` [mm].
        """
        slabs = self.stages[-1].slabs if self.stages else ()
        return Leftover(
            tuple(
                Slab(lowest - slab.z1, lowest - slab.z0, slab.material)
                for slab in reversed(_with_the_part(slabs, self.part))
            ),
            tuple((lowest - z1, lowest - z0) for z0, z1 in corner_heights(setup, runs)),
        )


def simulate(
    setup: Setup,
    runs: Sequence[ToolRun],
    *,
    fineness: float = FINENESS,
    allowed: float = ALLOWED,
    level: float = LEVEL,
) -> Simulation:
    """Run a program in its blank.

    Parameters
    ----------
    fineness : deviation of chords [mm].
    allowed : [mm] by which a cutter may enter the part, or material stay on it.
    level : heights [mm] that differ by less are one: the last decimal of a printed program.
    """
    heights = _heights(setup, runs, level)
    whole = polygon(setup.blank, fineness)
    slabs = tuple(
        Slab(z0, z1, _material(setup, whole, 0.5 * (z0 + z1))) for z0, z1 in pairwise(heights)
    )
    part = tuple(_sections(setup, slabs, fineness))
    bench = _Workpiece(setup, slabs, part, fineness, allowed, level)
    stages, flaws = [], []
    for run in runs:
        flaws += bench.run(run)
        stages.append(Stage(run.name, bench.slabs))
    flaws += _loose_pieces(stages, part, runs, setup, allowed)
    if stages and setup.final:
        flaws += _residue_flaws(stages[-1], part, setup, allowed, corner_heights(setup, runs))
    order = {run.name: place for place, run in enumerate(runs)}
    flaws.sort(key=lambda flaw: order[flaw.operation])
    return Simulation(tuple(stages), tuple(flaws), part)


def corner_heights(setup: Setup, runs: Iterable[ToolRun]) -> tuple[tuple[float, float], ...]:
    """Heights [mm], lower and upper, of the rounded corners of cutters where they run lowest."""
    rounded = (run for run in runs if run.rounded and run.point > 0.0)
    corners = (
        (tip, tip + run.point)
        for run in rounded
        for tip in _lowest(feed_course(run.moves, run.start))
    )
    return (*corners, *(() if setup.leftover is None else setup.leftover.corners))


def _material(setup: Setup, whole: Area, z: float) -> Area:
    """The material at the height `z` [mm] at the beginning; `whole` is the section of the blank."""
    if setup.leftover is None:
        return whole if setup.bottom < z < setup.top else NOTHING
    return next((slab.material for slab in setup.leftover.slabs if slab.z0 < z < slab.z1), NOTHING)


def _heights(setup: Setup, runs: Sequence[ToolRun], level: float) -> list[float]:
    """Ascending borders of the slabs [mm]."""
    highest = max([setup.top, *(body.z1 for body in setup.part)])
    candidates = [
        *(setup.top, setup.bottom),
        *(z for body in setup.part for z in (body.z0, body.z1)),
        *(z for z in (setup.joined, setup.hanging) if z is not None),
        *(z for chamfer in setup.chamfers for z in chamfer.heights),
    ]
    lowest = setup.bottom
    if setup.leftover is not None:
        borders = [z for slab in setup.leftover.slabs for z in (slab.z0, slab.z1)]
        lowest, highest = min([lowest, *borders]), max([highest, *borders])
        candidates += borders
    for run in runs:
        course = feed_course(run.moves, run.start)
        flat = (course.from_z == course.to_z) & (course.lengths > 0.0)
        straight = course.lengths == 0.0  # plunges and drilled holes, of which each peck goes on
        continues = (
            straight[1:]
            & (course.ends[1:] == course.ends[:-1])
            & (course.to_z[1:] < course.to_z[:-1])
        )
        candidates += [
            *course.from_z[flat].tolist(),
            *course.to_z[straight & ~np.append(continues, False)].tolist(),
            *(z for tip in _lowest(course) for z in run.slices(tip, highest)),
        ]
    heights: list[float] = []
    # Borders outside blank and part are of no interest; those that differ by rounding are one.
    for z in sorted(z for z in candidates if lowest <= z <= highest):
        if not heights or z - heights[-1] > level:
            heights.append(z)
    return heights


def _lowest(course: Course) -> list[float]:
    """Z [mm] at which the tip runs lowest, in a list of one; empty if the cutter does not move."""
    return [float(np.min(course.lowest))] if len(course) else []


def _sections(setup: Setup, slabs: Iterable[Slab], fineness: float) -> Iterator[Area]:
    """The area of the part in each slab; one object in all slabs that lie in the same bodies."""
    known: dict[tuple[bool, ...], Area] = {}
    for z in (slab.middle for slab in slabs):
        key = tuple(body.z0 < z < body.z1 for body in setup.part)
        if any(chamfer.height(z) < chamfer.top for chamfer in setup.chamfers):
            yield _section(setup, z, fineness)
            continue
        if key not in known:
            known[key] = _section(setup, z, fineness)
        yield known[key]


def _section(setup: Setup, z: float, fineness: float) -> Area:
    """The area of the part at one height."""
    bodies = [polygon(body.contours, fineness) for body in setup.part if body.z0 < z < body.z1]
    section: Area = shapely.union_all(bodies) if bodies else NOTHING
    for chamfer in setup.chamfers:
        if (height := chamfer.height(z)) < chamfer.top:
            section = shapely.difference(
                section, _passed_area(chamfer.run, chamfer.course, height, fineness)
            )
    return section


def _passed_area(
    run: ToolRun, course: Course, z: float, fineness: float, *, most: bool = False
) -> Area:
    """The area that a cutter passes over at the height `z` [mm]: on sloping moves a lower bound, or
    an upper one if `most` is true.
    """
    if run.point <= 0.0:
        return swept_area(course, run.radius, fineness)
    radii = run.cutter_radii(z - (course.lowest if most else course.cleared))
    # On sloping moves each piece would have a radius of its own: rounded, many share one sweep.
    sloping = (course.from_z != course.to_z) & (course.lengths > 0.0)
    radii[sloping] = STEP * (np.ceil if most else np.floor)(radii[sloping] / STEP)
    swept_areas = [
        swept_area(taken(course, radii == radius), radius, fineness) for radius in np.unique(radii)
    ]
    return shapely.union_all(swept_areas) if swept_areas else NOTHING


class _Workpiece:
    """The material while it is cut, and the part within it."""

    def __init__(
        self,
        setup: Setup,
        slabs: tuple[Slab, ...],
        part: tuple[Area, ...],
        fineness: float,
        allowed: float,
        level: float,
    ) -> None:
        self.setup, self.slabs, self.part = setup, slabs, part
        self.fineness, self.allowed, self.level = fineness, allowed, level
        # The part without its rim of the allowed depth: what touches that is a gouge.
        self.kernels = map_distinct(lambda area: grown(area, -allowed), part)
        self.known: Known = {}

    def run(self, run: ToolRun) -> list[Flaw]:
        """The flaws of one operation, the worst of each kind."""
        flaws: list[Flaw] = []
        # Feed moves are collected and swept as one chain. Before a traverse, or a plunge of a tool
        # that must not plunge, the chain is cut: these are checked against what is left by then.
        chain: list[Move] = []
        position, begin = run.start, run.start
        for move in unlifted(run.moves):
            down = (
                position is not None and move.end[:2] == position[:2] and move.end[2] < position[2]
            )
            if isinstance(move, Rapid) or (down and not run.plunges):
                flaws += self._cut(run, feed_course(chain, begin))
                chain, begin = [], position
                if position is not None:
                    flaws += self._enter(run, position, move)
            if isinstance(move, Rapid):
                begin = move.end
            else:
                chain.append(move)
            position = move.end
        flaws += self._cut(run, feed_course(chain, begin))
        worst: dict[str, Flaw] = {}
        for flaw in flaws:
            if flaw.name not in worst or flaw.excess > worst[flaw.name].excess:
                worst[flaw.name] = flaw
        return list(worst.values())

    def _enter(self, run: ToolRun, position: Point, move: Move) -> Iterator[Flaw]:
        """The flaws of a traverse, or of a plunge of a tool that cannot plunge: neither may meet
        material.
        """
        course = _straight_course(position, move.end)
        yield from self._clear(run, course)
        if move.end[2] > position[2]:
            return
        rapid = isinstance(move, Rapid)
        text = "a traverse goes {:.3g} mm deep into material" if rapid else (
            "the tool plunges {:.3g} mm deep into material, although it must not plunge"
        )  # fmt: skip
        yield from self._meets(
            replace(run, radius=run.radius - self.allowed),
            course,
            areas(self.slabs),
            "rapid" if rapid else "plunge",
            text.format,
        )

    def _cut(self, run: ToolRun, course: Course) -> Iterator[Flaw]:
        """Remove what a chain of feed moves sweeps from the material, and yield its flaws."""
        if not len(course):
            return
        yield from self._clear(run, course)
        reached, cleared = self._swept(run, course)
        yield from self._gouges(run, course, reached)
        left = map_distinct(
            _without, areas(self.slabs), cleared
        )  # slabs of one section are cut once
        self.slabs = tuple(
            replace(slab, material=material)
            for slab, material in zip(self.slabs, left, strict=True)
        )
        if run.shank is not None:
            radius, length = run.shank
            yield from self._meets(
                replace(run, radius=radius - self.allowed, point=0.0),
                course,
                areas(self.slabs),
                "shank",
                "the shank is {:.3g} mm deep in material".format,
                length,
            )

    def _swept(self, run: ToolRun, course: Course) -> tuple[list[Area], list[Area]]:
        """The area in each slab that a cutter may reach, an upper bound that decides on gouges, and
        the one that it clears, a lower bound; empty in slabs without part or without material.
        """
        # A tip reaches a slab only if it goes clearly below its top, and clears it if it goes down
        # to its bottom, to `level`: borders of slabs are heights of moves, to rounding.
        level = self.level
        tops = [
            -np.inf if kernel.is_empty else slab.z1 - 2.0 * level
            for slab, kernel in zip(self.slabs, self.kernels, strict=True)
        ]
        bottoms = [-np.inf if slab.material.is_empty else slab.z0 + level for slab in self.slabs]
        if run.point <= 0.0:
            heights = sorted({*tops, *bottoms})
            areas = swept_areas_below(course, heights, run.radius, self.fineness, self.known)
            area_by_height = dict(zip(heights, areas, strict=True))
            return [area_by_height[z] for z in tops], [area_by_height[z] for z in bottoms]
        middles = [slab.middle for slab in self.slabs]
        reached = [
            _passed_area(run, course.below(top), z, self.fineness, most=True)
            for top, z in zip(tops, middles, strict=True)
        ]
        cleared = [
            _passed_area(run, course.below(bottom), z, self.fineness)
            for bottom, z in zip(bottoms, middles, strict=True)
        ]
        return reached, cleared

    def _meets(
        self,
        run: ToolRun,
        course: Course,
        bodies: Sequence[Area],
        name: str,
        text: Callable[[float], str],
        above: float = 0.0,
    ) -> Iterator[Flaw]:
        """Flaws where a cutter whose lower end is `above` [mm] the tip meets `bodies`, one area for
        each slab; `text` makes the sentence from the depth [mm].
        """
        for slab, body in zip(self.slabs, bodies, strict=True):
            if body.is_empty:
                continue
            # The end that is meant, of the cutter or of its shank, runs `above` the tip.
            low = course.below(slab.z1 - above - 2.0 * self.level)
            reached = _passed_area(run, low, slab.middle - above, self.fineness, most=True)
            touched = shapely.intersection(reached, body)
            if parts(touched):
                tip = float(np.min(low.lowest))
                depth = slab.z1 - above - tip
                yield Flaw(
                    name, run.name, text(depth), depth, 0.0, _point(interior_point(touched), tip)
                )

    def _gouges(self, run: ToolRun, course: Course, reached: Sequence[Area]) -> Iterator[Flaw]:
        both = map_distinct(shapely.intersection, reached, self.kernels)
        for number, (slab, touched) in enumerate(zip(self.slabs, both, strict=True)):
            if parts(touched):
                low = course.below(slab.z1 - 2.0 * self.level)
                depth, where = self._depth(number, touched)
                if depth <= self.allowed + 2.0 * self.fineness:  # an edge that is rounded
                    continue
                text = f"the cutter goes {depth:.3g} mm into the part"
                place = _point(where, float(np.min(low.lowest)))
                yield Flaw("gouge", run.name, text, depth, self.allowed, place)

    def _depth(self, number: int, touched: Area) -> tuple[float, complex]:
        """Depth [mm] of the area `touched` of a slab in the part, and the place of the deepest
        point: below the face over it or behind the wall beside it, whichever is nearer.
        """
        edge = shapely.boundary(self.part[number])
        _, middle = farthest(touched, edge)
        places = np.vstack((shapely.get_coordinates(touched), (middle.real, middle.imag)))
        points = shapely.points(places)
        face = np.full(len(places), self.slabs[number].z1)
        # Upwards through the slabs, as long as the part goes on over a point, to the face over it.
        covered = np.ones(len(places), dtype=np.bool_)
        for slab, part in zip(self.slabs[number + 1 :], self.part[number + 1 :], strict=True):
            covered &= shapely.intersects(part, points)
            face[covered] = slab.z1
        depths = np.minimum(shapely.distance(points, edge), face - self.slabs[number].z0)
        deepest = int(np.argmax(depths))
        return float(depths[deepest]), complex(*places[deepest])

    def _clear(self, run: ToolRun, course: Course) -> Iterator[Flaw]:
        """Flaws of a course that touches obstacles or goes too deep."""
        cylinders = [("cutter", run.radius, 0.0)]
        cylinders += [("shank", *run.shank)] if run.shank is not None else []
        for body, (what, radius, above) in product(run.obstacles, cylinders):
            outline = polygon(body.contours, self.fineness)
            low = course.below(body.z1 - above - self.level)
            touched = shapely.intersection(swept_area(low, radius, self.fineness), outline)
            if parts(touched):
                # The path itself has no area: widened by what is allowed, it has a distance.
                away = shapely.distance(swept_area(low, self.allowed, self.fineness), outline)
                depth = max(0.0, radius - self.allowed - float(away))
                text = f"the {what} goes {depth:.3g} mm into the {body.name}"
                tip = float(np.min(low.lowest))
                yield Flaw(
                    "obstacle", run.name, text, depth, 0.0, _point(interior_point(touched), tip)
                )
        tip = float(np.min(course.lowest))
        point = 0.0 if run.rounded else run.point
        limit = None if self.setup.lowest is None else self.setup.lowest - point
        if limit is not None and tip < limit - self.level:
            piece = int(np.argmin(course.lowest))
            text = f"the tip goes {limit - tip:.3g} mm below Z {limit:g} mm"
            place = _point(complex(course.ends[piece]), tip)
            yield Flaw("depth", run.name, text, tip, limit, place)


def unlifted(moves: Iterable[Move | Stop]) -> list[Move]:
    """The moves without halts, and with the pecks of a drill as one: without traverses straight up
    from a cut and down again no deeper, after which it goes straight on.
    """
    merged: list[Move] = []
    lifts: list[Rapid] = []
    for move in moves:
        if isinstance(move, Stop):
            continue
        last = merged[-1] if merged else None
        if last is not None and not isinstance(last, Rapid) and move.end[:2] == last.end[:2]:
            if isinstance(move, Rapid) and move.end[2] >= last.end[2]:
                lifts.append(move)
                continue
            if isinstance(move, Feed) and move.end[2] < last.end[2]:
                lifts = []
                if len(merged) > 1 and _falls(merged[-2].end, last.end):
                    merged.pop()
        merged += lifts
        lifts = []
        merged.append(move)
    return [*merged, *lifts]


def _falls(start: Point, end: Point) -> bool:
    return start[:2] == end[:2] and start[2] > end[2]


def _straight_course(start: Point, end: Point) -> Course:
    """A straight move, at feed or not."""
    return feed_course([Feed(end, 1.0)], start)


def _point(place: complex, z: float) -> Point:
    return (place.real, place.imag, z)


# -- left -----------------------------------------------------------------------------------------
# What is left of a blank: pieces that nothing holds any more, and material left on the part.


TOUCHING = 1e-4
"""Area [mm^2] that two pieces must share to count as connected; rounding leaves less."""

PART = "the part"


@dataclass(frozen=True, slots=True, eq=False)
class MaterialPiece:
    """A connected part of the material: areas with the number of their slab."""

    areas: tuple[tuple[int, Area], ...]

    def volume(self, slabs: Sequence[Slab]) -> float:
        """Volume of the piece [mm^3]."""
        return sum((slabs[k].z1 - slabs[k].z0) * float(area.area) for k, area in self.areas)

    def shared(self, others: Sequence[Area]) -> float:
        """Area [mm^2] shared with one area for each slab, all slabs together."""
        return sum(float(shapely.intersection(area, others[k]).area) for k, area in self.areas)


def connected_pieces(slabs: Sequence[Slab]) -> tuple[MaterialPiece, ...]:
    """The connected parts of the material."""
    by_slab = map_distinct(parts, areas(slabs))
    single = [[(k, area) for area in slab_areas] for k, slab_areas in enumerate(by_slab)]
    offsets = np.concatenate(([0], np.cumsum([len(numbered) for numbered in single]))).astype(int)
    # Union-find over all areas, numbered through the slabs: areas of neighbouring slabs that
    # overlap belong to one piece, which is named by the root of its areas.
    owner = list(range(int(offsets[-1])))

    def root(number: int) -> int:
        while owner[number] != number:
            number = owner[number]
        return number

    for k, shared in enumerate(map_distinct(overlap, by_slab[:-1], by_slab[1:])):
        for low, high in np.argwhere(shared > TOUCHING).tolist():
            owner[root(int(offsets[k] + low))] = root(int(offsets[k + 1] + high))
    flat = [numbered_area for slab in single for numbered_area in slab]
    groups: dict[int, list[tuple[int, Area]]] = {}
    for number, numbered_area in enumerate(flat):
        groups.setdefault(root(number), []).append(numbered_area)
    return tuple(MaterialPiece(tuple(group)) for group in groups.values())


def overlap(areas: Sequence[Area], others: Sequence[Area]) -> np.ndarray[Any, Any]:
    """(n, m) areas [mm^2] that each of `areas` (n,) shares with each of `others` (m,)."""
    if not areas or not others:
        return np.zeros((len(areas), len(others)))
    first = np.array(areas, dtype=object)[:, None]
    second = np.array(others, dtype=object)[None, :]
    shared: np.ndarray[Any, Any] = shapely.area(shapely.intersection(first, second))
    return shared


def _with_the_part(slabs: Sequence[Slab], part: Sequence[Area]) -> tuple[Slab, ...]:
    """The material of the piece with the part; other pieces are removed by hand."""
    gone: dict[int, list[Area]] = {}
    for piece in connected_pieces(slabs):
        if piece.shared(part) <= TOUCHING:
            for k, area in piece.areas:
                gone.setdefault(k, []).append(area)
    return tuple(
        replace(slab, material=_without(slab.material, shapely.union_all(gone[k])))
        if k in gone
        else slab
        for k, slab in enumerate(slabs)
    )


def _loose_pieces(
    stages: Sequence[Stage],
    part: Sequence[Area],
    runs: Sequence[ToolRun],
    setup: Setup,
    allowed: float,
) -> Iterator[Flaw]:
    """Flaws of pieces that come loose, each once: neither the holding nor a clamp of the run holds
    them. None if the holding is not to be checked.

    Slivers nowhere thicker than `allowed` [mm] are ignored. Until the first clamp is set, a blank
    that is still in one piece counts as held in a way that is not stated: screws often stand in a
    bore that is milled first.
    """
    if setup.held is None:
        return
    always = [polygon(contours, FINENESS) for contours in setup.held]
    known: list[MaterialPiece] = []
    clamped = bool(always) or setup.rim is not None
    rim = [] if setup.rim is None else [polygon(setup.rim, FINENESS)]
    for stage, run in zip(stages, runs, strict=True):
        connected = connected_pieces(stage.slabs)
        held = [*always, *(polygon(body.contours, FINENESS) for body in run.obstacles)]
        clamped |= bool(run.obstacles)
        if not clamped and len(connected) == 1:
            continue
        fixed = [piece for piece in connected if _meets(piece, held or rim)]
        if not held:  # what holds the rim is not stated; it holds what hangs on the part
            fixed = [piece for piece in fixed if piece.shared(part) > TOUCHING] or fixed
        for piece in connected:
            is_known = piece in fixed or any(_same(piece, earlier) for earlier in known)
            if not is_known and not _is_dust(piece, allowed):
                known.append(piece)
                yield _loose(stage, piece, part, setup)


def _meets(piece: MaterialPiece, held: Sequence[Area]) -> bool:
    return any(
        float(shapely.intersection(area, holder).area) > TOUCHING
        for _, area in piece.areas
        for holder in held
    )


def _is_dust(piece: MaterialPiece, allowed: float) -> bool:
    """Whether a piece is nowhere thicker than the deviation allowed for paths, so that it may not
    exist.
    """
    return all(grown(area, -0.5 * allowed).is_empty for _, area in piece.areas)


def _same(piece: MaterialPiece, other: MaterialPiece) -> bool:
    """Whether a piece is a remainder of another one, which came loose earlier."""
    earlier_areas = dict(other.areas)
    return all(
        k in earlier_areas and float(shapely.intersection(area, earlier_areas[k]).area) > TOUCHING
        for k, area in piece.areas[:1]
    )


def _loose(stage: Stage, piece: MaterialPiece, part: Sequence[Area], setup: Setup) -> Flaw:
    """The flaw of a piece that comes loose: what it is, its size, its mass and its place."""
    k, area = max(piece.areas, key=lambda numbered: numbered[1].area)
    left, low, right, high = area.bounds
    place, value, unit = interior_point(area), piece.volume(stage.slabs), "mm^3"
    what = _name(piece, place, part)
    size = f"{what} of {right - left:.3g} x {high - low:.3g} mm, {value:.3g} mm^3"
    if setup.density is not None:
        size += f", {1e3 * setup.density * value:.3g} kg"
    # A blank of unknown outline is simulated as a square about the cam axis, half a side being the
    # distance of a corner over sqrt(2): of a piece that reaches its edge the size is not known.
    edge = float(np.max(np.abs(setup.blank[0].vertices)))
    if not setup.known and max(map(abs, area.bounds)) > edge / np.sqrt(2.0) - LEVEL:
        size, value, unit = f"{what}, in a blank of unstated size", 1.0, "pieces"
    watched = setup.fixture and what != PART
    text = f"{size}, which the fixture must hold, comes loose" if watched else (
        f"{size}, comes loose and nothing holds it"
    )  # fmt: skip
    where = (place.real, place.imag, stage.slabs[k].z0)
    return Flaw("loose", stage.operation, text, value, 0.0, where, unit, watched=watched)


def _name(piece: MaterialPiece, place: complex, part: Sequence[Area]) -> str:
    """What a piece is: the part, a core within it, or waste beside it."""
    if piece.shared(part) > 0.5 * sum(area.area for area in part):
        return PART
    rings = [ring for area in part for ring in parts(area)]
    point = shapely.Point(place.real, place.imag)
    inside = any(shapely.intersects(shapely.Polygon(ring.exterior), point) for ring in rings)
    return "a core" if inside or not rings else "waste"


def _may_stay(slab: Slab, setup: Setup) -> bool:
    """Whether waste may stay on the part in a slab: up to the height of tabs or a skin, or, on a
    second side, from the height at which the first one has left them.
    """
    low, high = setup.joined, setup.hanging
    if low is not None and slab.z1 <= low + LEVEL:
        return True
    top = max((body.z1 for body in setup.part), default=setup.top)
    return high is not None and high - LEVEL <= slab.z0 and slab.z1 <= top + LEVEL


def _residues(
    material: Area, target: Area, near: Iterable[Area], allowed: float
) -> Iterator[tuple[Area, float]]:
    """Material left beside the section `target` of the part, each with its thickness [mm]; 0 for
    material that lies only on a face, over or under one of the sections `near` by.
    """
    excess = shapely.difference(material, grown(target, allowed))
    # Shrunk and grown again (a morphological opening): slivers thinner than allowed vanish.
    thick = parts(grown(grown(excess, -0.5 * allowed), 0.5 * allowed))
    close = grown(target, 2.0 * allowed)
    faces = shapely.difference(shapely.union_all(list(near)), target)
    for residue in thick:
        if not target.is_empty and shapely.intersects(residue, close):
            yield residue, farthest(residue, target)[0]
        elif float(shapely.intersection(residue, faces).area) > TOUCHING:
            yield residue, 0.0


def _residue_flaws(
    stage: Stage,
    part: Sequence[Area],
    setup: Setup,
    allowed: float,
    corners: Sequence[tuple[float, float]],
) -> Iterator[Flaw]:
    """Flaws of material that is left beside the part, or on one of its faces, thicker than
    `allowed` [mm]; what the rounded corners of cutters leave between the heights `corners` [mm] is
    a kind of its own. At most one flaw of each kind, the thickest.
    """
    worst: dict[int, Flaw] = {}  # the largest fault, of what is meant, and of what corners leave
    known: dict[tuple[int, ...], list[tuple[Area, float]]] = {}
    unfinished = shapely.boundary(
        [polygon([contour], 0.5 * allowed) for contour in setup.unfinished]
    )
    for k, (slab, target) in enumerate(zip(stage.slabs, part, strict=True)):
        if slab.material.is_empty or _may_stay(slab, setup):
            continue
        near = {id(section): section for section in part[max(k - 1, 0) : k + 2]}
        same = (id(slab.material), id(target), *sorted(near))
        if same not in known:
            known[same] = list(_residues(slab.material, target, near.values(), allowed))
        for residue, thickness in known[same]:
            size = thickness or slab.z1 - slab.z0
            left, low, right, high = residue.bounds
            rounding = max((z1 - z0 for z0, z1 in corners if z0 < slab.middle < z1), default=0.0)
            by_corner = size <= rounding + allowed
            meant = thickness and np.any(shapely.distance(unfinished, residue) <= 2.0 * allowed)
            text = (
                f"material is left on the part, up to {size:.3g} mm thick, {right - left:.3g} mm"
                f" along X, {high - low:.3g} mm along Y and {slab.z1 - slab.z0:.3g} mm high"
            )
            text += ", where the corners of a cutter are rounded" if by_corner else ""
            place = interior_point(residue)
            where = (place.real, place.imag, slab.z0)
            kind = 2 if by_corner else 1 if meant else 0
            if kind not in worst or size > worst[kind].value:
                worst[kind] = Flaw(
                    "rest", stage.operation, text, size, allowed, where, watched=kind > 0
                )
    yield from (worst[kind] for kind in sorted(worst))


# -- sweep ----------------------------------------------------------------------------------------
# Areas that a cutter passes over on its course.


FINEST: Final = 1e-5
"""Least deviation of chords [mm] that has an effect, see `camgeo.milling.polygons`."""

SHARE: Final = 0.005
"""Share of the distance of the farthest point of an area to which it is determined."""

LONGEST: Final = 200
"""Largest number of points of a line that is widened at once. A line of several turns overlaps
itself at every turn: widened in parts it takes a quarter of the time."""


def swept_area(course: Course, radius: float, fineness: float) -> Area:
    """What a circle of `radius` [mm] passes over on `course`."""
    if not len(course) or radius <= 0.0:
        return NOTHING
    chains = (part for chain in _chains(_once(course), fineness) for part in _split_chain(chain))
    shapes = [_shape(part) for part in chains]
    merged = shapely.buffer(shapes, radius, quad_segs=_quarter(radius, fineness))
    while len(merged) > 1:  # neighbours first: half the time of all at once
        merged = np.append(
            shapely.union(merged[:-1:2], merged[1::2]), merged[len(merged) // 2 * 2 :]
        )
    return merged[0]


Known = dict[tuple[float, float, bytes], tuple[Area, Area]]
"""Swept areas, each with the same area slightly grown, by radius, fineness and pieces."""


def swept_areas_below(
    course: Course, heights: Iterable[float], radius: float, fineness: float, known: Known
) -> list[Area]:
    """What a circle of `radius` [mm] passes over with its tip not above each of `heights` [mm],
    which ascend.

    What is new at a height is added to the area at the one before. Where nothing reaches beyond
    that by more than twice the fineness, as chords of the same path do, both are the same object,
    so that what follows is computed once for all slabs between passes. What equal pieces sweep is
    looked up in `known`, and added to it.
    """
    same = alike(course)
    highest, lowest = course.highest, course.lowest
    level = course.from_z == course.to_z
    finished = np.zeros(len(course), dtype=np.bool_)
    area: Area = NOTHING
    wide: Area = NOTHING
    areas_below = []
    for z in heights:
        fresh = (lowest <= z) & ~finished[same]
        for which in (fresh & level, fresh & ~level):
            if not np.any(which):
                continue
            more, more_wide = _known_swept_area(
                taken(course, which).below(z), radius, fineness, known
            )
            if area.is_empty:
                area, wide = more, more_wide
            elif not shapely.covers(wide, more):
                area = shapely.union(area, more)
                wide = _wide(area, fineness)
        finished[same[fresh & (highest <= z)]] = True
        areas_below.append(area)
    return areas_below


def _known_swept_area(
    course: Course, radius: float, fineness: float, known: Known
) -> tuple[Area, Area]:
    """The swept area, looked up in `known` or added to it, and the same area slightly grown."""
    columns = (course.starts, course.ends, course.sweeps, course.centres)
    key = (radius, fineness, b"".join(column.tobytes() for column in columns))
    if key not in known:
        area = swept_area(course, radius, fineness)
        known[key] = area, _wide(area, fineness)
    return known[key]


def _wide(area: Area, fineness: float) -> Area:
    """`area` grown by what chords may miss at its edge, prepared for fast predicates."""
    wide = grown(area, 2.0 * fineness)
    shapely.prepare(wide)
    return wide


def interior_point(area: Area) -> complex:
    """A point within the largest part of `area`."""
    point = shapely.point_on_surface(max(parts(area), key=lambda part: part.area))
    return complex(point.x, point.y)


def farthest(area: Area, edge: Area) -> tuple[float, complex]:
    """Largest distance [mm] of a point of `area` from `edge`, to `SHARE`, and that point; the point
    may lie inside the area.
    """
    # The farthest corner is a lower bound. A distance is exceeded if anything of the area is left
    # outside of the edge grown by it: first slightly beyond the bound, where the search often ends,
    # then doubled until nothing is left, then by bisection.
    corners = shapely.get_coordinates(area)
    away = shapely.distance(shapely.points(corners), edge)
    most = int(np.argmax(away))
    low, high, place = max(float(away[most]), FINEST), np.inf, complex(*corners[most])
    step = SHARE
    while high > (1.0 + SHARE) * low:
        middle = (1.0 + step) * low if np.isinf(high) else 0.5 * (low + high)
        beyond = shapely.difference(area, grown(edge, middle))
        if parts(beyond):
            low, place, step = middle, interior_point(beyond), 1.0
        else:
            high = middle
    return float(shapely.distance(shapely.Point(place.real, place.imag), edge)), place


def _quarter(radius: float, fineness: float) -> int:
    """Number of chords of a quarter of a circle of `radius` [mm] within `fineness` [mm]."""
    # The sagitta of a chord over an angle 2 h is radius (1 - cos h).
    angle = 2.0 * np.arccos(max(0.0, 1.0 - max(fineness, FINEST) / radius))
    return max(4, int(np.ceil(0.5 * np.pi / angle)))


def _once(course: Course) -> Course:
    """The course without pieces that it repeats: further rounds of a path sweep nothing more, and
    what overlaps itself takes GEOS far longer.
    """
    first = alike(course) == np.arange(len(course))
    return course if np.all(first) else taken(course, first)


def _chains(course: Course, fineness: float) -> list[ComplexArray]:
    """Points along the course, one array for each part without a gap."""
    piece, ends = course.chords(max(fineness, FINEST))
    gaps = np.flatnonzero(course.starts[1:] != course.ends[:-1]) + 1
    starts = course.starts[np.concatenate(([0], gaps))]
    parts = np.split(ends, np.searchsorted(piece, gaps))
    return [np.concatenate(([start], part)) for start, part in zip(starts, parts, strict=True)]


def _split_chain(chain: ComplexArray) -> Iterator[ComplexArray]:
    """Parts of a chain of points, at most `LONGEST` pieces each, that follow each other."""
    for first in range(0, max(len(chain) - 1, 1), LONGEST):
        yield chain[first : first + LONGEST + 1]


def _shape(chain: ComplexArray) -> Any:
    """A line through the points, or a point if all of them are equal."""
    keep = np.concatenate(([True], np.diff(chain) != 0.0))
    points = np.column_stack((chain[keep].real, chain[keep].imag))
    return shapely.LineString(points) if len(points) > 1 else shapely.Point(points[0])
