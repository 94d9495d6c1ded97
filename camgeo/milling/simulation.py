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
from camgeo.milling.moves import Course, Feed, Move, Point, Rapid, Stop, alike, course_of
from camgeo.milling.polygons import NOTHING, Area, grown, parts, polygon
from camgeo.numeric.arrays import ComplexArray, FloatArray, taken

FINENESS: Final = 1e-3
"""Deviation of chords [mm] unless stated."""

ALLOWED: Final = 0.02
"""[mm] by which part and path may overlap or miss each other unless stated: far above what the
polygons are off, and not seen on a part."""

STEP: Final = 5e-3
"""Of the radii that a point has on slopes [mm]: they are rounded, against the program."""

LEVEL: Final = 1e-6
"""Heights [mm] that differ by less are one, unless stated."""


@dataclass(frozen=True, slots=True, eq=False)
class Body:
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
        """Of the material [mm^3]."""
        return sum((slab.z1 - slab.z0) * float(slab.material.area) for slab in self.slabs)


LOOSE_CORE: Final = "loose-core"
"""Name of findings on waste that is cut free in one piece."""


@dataclass(frozen=True, slots=True)
class Flaw:
    """Something that a machinist would not accept.

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
        """In words, with its operation and its place."""
        x, y, z = self.place
        return f"{self.operation}: {self.text} at X {x:.4g}, Y {y:.4g}, Z {z:.4g} mm"

    @property
    def excess(self) -> float:
        """By how much the limit is missed."""
        return abs(self.value - self.limit)

    @property
    def finding(self) -> Finding:
        """What a machinist must not run, "broken", or is to watch, "warning"."""
        name = LOOSE_CORE if self.name == "loose" and self.watched else self.name
        severity: Severity = "warning" if self.watched else "broken"
        return Finding(name, severity, self.sentence, self.value, self.limit, self.unit)


def _without(material: Area, area: Area) -> Area:
    """What is left of the material when `area` is taken away."""
    gone = material.is_empty or area.is_empty
    return material if gone else shapely.difference(material, area)


def areas(slabs: Iterable[Slab]) -> list[Area]:
    """The material of each."""
    return [slab.material for slab in slabs]


def each_once(answer: Callable[..., Any], *several: Iterable[Any]) -> list[Any]:
    """The `answer` to each of `several`, or to those of one place in all of them, once for those
    that are the same objects.
    """
    rows = list(zip(*several, strict=True))
    keys = [tuple(map(id, row)) for row in rows]
    known = {key: answer(*row) for key, row in dict(zip(keys, rows, strict=True)).items()}
    return [known[key] for key in keys]


# -- setup ----------------------------------------------------------------------------------------
# What a simulation of a milling program is given: what each tool does, and what it starts from.


SLICES: Final = 4
"""Slabs of a point or of rounded corners at their lowest."""


@dataclass(frozen=True, slots=True, eq=False)
class Run:
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
    obstacles: tuple[Body, ...] = ()
    start: Point | None = None

    def radius_at(self, height: FloatArray) -> FloatArray:
        """(n,) radius [mm] at heights (n,) above the tip, that of the tip below it."""
        if self.point <= 0.0:
            return np.full(len(height), self.radius)
        up = np.clip(height, 0.0, self.point)
        if self.rounded:
            return self.radius - self.point + np.sqrt(up * (2.0 * self.point - up))
        return self.radius * up / self.point

    def slices(self, tip: float, top: float) -> list[float]:
        """Z [mm] from a tip up to a `top` between which the radius changes by equal steps or so."""
        share = np.arange(1, SLICES + 1) / SLICES
        if self.rounded:
            share = 1.0 - np.cos(0.5 * np.pi * share)
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

    run: Run
    course: Course
    top: float
    turned: float | None = None

    def height(self, z: float) -> float:
        """A height of the side from which it was taken off, seen from this one; and back [mm]."""
        return z if self.turned is None else self.turned - z

    @property
    def heights(self) -> list[float]:
        """Between which the section of the part changes by equal steps or so [mm]."""
        own = self.run.slices(float(np.min(self.course.lowest)), self.top)
        return [self.height(z) for z in own]


@dataclass(frozen=True, slots=True, eq=False)
class Before:
    """What another side has left, seen from this one.

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
    before : what an earlier side has left of the blank; None for all of it.
    final : whether the part must be all there is in the end, and no other side follows.
    unfinished : walls that the stated operations of all sides leave unfinished, or roughed.
    known : whether the outline of the blank is stated, and not one that reaches beyond all cuts.
    density : of the material [t/mm^3]; None if it is not stated.
    """

    blank: tuple[Contour, ...]
    top: float
    bottom: float
    part: tuple[Body, ...] = ()
    held: tuple[tuple[Contour, ...], ...] | None = None
    rim: tuple[Contour, ...] | None = None
    fixture: bool = False
    chamfers: tuple[Chamfer, ...] = ()
    lowest: float | None = None
    joined: float | None = None
    hanging: float | None = None
    before: Before | None = None
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
        operation there is the worst only.
    part : the area of the part in each slab of a stage.
    """

    stages: tuple[Stage, ...]
    flaws: tuple[Flaw, ...]
    part: tuple[Area, ...]

    def turned_over(self, setup: Setup, runs: Iterable[Run], lowest: float) -> Before:
        """What is left of the piece with the part in it, seen from the other side of a part whose
        lower face is at Z `lowest` [mm].
        """
        slabs = self.stages[-1].slabs if self.stages else ()
        return Before(
            tuple(
                Slab(lowest - each.z1, lowest - each.z0, each.material)
                for each in reversed(_with_the_part(slabs, self.part))
            ),
            tuple((lowest - z1, lowest - z0) for z0, z1 in corners_of(setup, runs)),
        )


def simulate(
    setup: Setup,
    runs: Sequence[Run],
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
    bench = _Bench(setup, slabs, part, fineness, allowed, level)
    stages, flaws = [], []
    for run in runs:
        flaws += bench.run(run)
        stages.append(Stage(run.name, bench.slabs))
    flaws += _loose_pieces(stages, part, runs, setup, allowed)
    if stages and setup.final:
        flaws += _rests(stages[-1], part, setup, allowed, corners_of(setup, runs))
    order = {run.name: place for place, run in enumerate(runs)}
    flaws.sort(key=lambda each: order[each.operation])
    return Simulation(tuple(stages), tuple(flaws), part)


def corners_of(setup: Setup, runs: Iterable[Run]) -> tuple[tuple[float, float], ...]:
    """Heights [mm] between which rounded corners of cutters are, where those are lowest."""
    rounded = (run for run in runs if run.rounded and run.point > 0.0)
    own = (
        (tip, tip + run.point)
        for run in rounded
        for tip in _lowest(course_of(run.moves, run.start))
    )
    return (*own, *(() if setup.before is None else setup.before.corners))


def _material(setup: Setup, whole: Area, z: float) -> Area:
    """What is there at first at the height `z` [mm]; `whole` is the section of the blank."""
    if setup.before is None:
        return whole if setup.bottom < z < setup.top else NOTHING
    return next((slab.material for slab in setup.before.slabs if slab.z0 < z < slab.z1), NOTHING)


def _heights(setup: Setup, runs: Sequence[Run], level: float) -> list[float]:
    """Ascending borders of the slabs [mm]."""
    highest = max([setup.top, *(body.z1 for body in setup.part)])
    found = [
        *(setup.top, setup.bottom),
        *(z for body in setup.part for z in (body.z0, body.z1)),
        *(z for z in (setup.joined, setup.hanging) if z is not None),
        *(z for chamfer in setup.chamfers for z in chamfer.heights),
    ]
    lowest = setup.bottom
    if setup.before is not None:
        borders = [z for slab in setup.before.slabs for z in (slab.z0, slab.z1)]
        lowest, highest = min([lowest, *borders]), max([highest, *borders])
        found += borders
    for run in runs:
        course = course_of(run.moves, run.start)
        flat = (course.from_z == course.to_z) & (course.lengths > 0.0)
        straight = course.lengths == 0.0  # plunges and drilled holes, of which each peck goes on
        on = (
            straight[1:]
            & (course.ends[1:] == course.ends[:-1])
            & (course.to_z[1:] < course.to_z[:-1])
        )
        found += [
            *course.from_z[flat].tolist(),
            *course.to_z[straight & ~np.append(on, False)].tolist(),
            *(z for tip in _lowest(course) for z in run.slices(tip, highest)),
        ]
    heights: list[float] = []
    for z in sorted(z for z in found if lowest <= z <= highest):
        if not heights or z - heights[-1] > level:
            heights.append(z)
    return heights


def _lowest(course: Course) -> list[float]:
    """Z of the tip at its lowest, if it moves at all [mm]."""
    return [float(np.min(course.lowest))] if len(course) else []


def _sections(setup: Setup, slabs: Iterable[Slab], fineness: float) -> Iterator[Area]:
    """The area of the part in each slab; one object in all slabs that lie in the same bodies."""
    known: dict[tuple[bool, ...], Area] = {}
    for z in (slab.middle for slab in slabs):
        key = tuple(body.z0 < z < body.z1 for body in setup.part)
        if any(each.height(z) < each.top for each in setup.chamfers):
            yield _section(setup, z, fineness)
            continue
        if key not in known:
            known[key] = _section(setup, z, fineness)
        yield known[key]


def _section(setup: Setup, z: float, fineness: float) -> Area:
    """The area of the part at one height."""
    bodies = [polygon(body.contours, fineness) for body in setup.part if body.z0 < z < body.z1]
    found: Area = shapely.union_all(bodies) if bodies else NOTHING
    for each in setup.chamfers:
        if (own := each.height(z)) < each.top:
            found = shapely.difference(found, _passed(each.run, each.course, own, fineness))
    return found


def _passed(run: Run, course: Course, z: float, fineness: float, *, most: bool = False) -> Area:
    """What a cutter passes over at the height `z` [mm], at least; or at `most` where it slopes."""
    if run.point <= 0.0:
        return swept(course, run.radius, fineness)
    radii = run.radius_at(z - (course.lowest if most else course.cleared))
    sloping = (course.from_z != course.to_z) & (course.lengths > 0.0)
    radii[sloping] = STEP * (np.ceil if most else np.floor)(radii[sloping] / STEP)
    found = [swept(taken(course, radii == each), each, fineness) for each in np.unique(radii)]
    return shapely.union_all(found) if found else NOTHING


class _Bench:
    """The material while it is cut."""

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
        self.kernels = each_once(lambda area: grown(area, -allowed), part)
        self.known: Known = {}

    def run(self, run: Run) -> list[Flaw]:
        """The flaws of one operation, the worst of each kind."""
        found: list[Flaw] = []
        chain: list[Move] = []
        at, begin = run.start, run.start
        for move in unlifted(run.moves):
            down = at is not None and move.end[:2] == at[:2] and move.end[2] < at[2]
            if isinstance(move, Rapid) or (down and not run.plunges):
                found += self._cut(run, course_of(chain, begin))
                chain, begin = [], at
                if at is not None:
                    found += self._enter(run, at, move)
            if isinstance(move, Rapid):
                begin = move.end
            else:
                chain.append(move)
            at = move.end
        found += self._cut(run, course_of(chain, begin))
        worst: dict[str, Flaw] = {}
        for each in found:
            if each.name not in worst or each.excess > worst[each.name].excess:
                worst[each.name] = each
        return list(worst.values())

    def _enter(self, run: Run, at: Point, move: Move) -> Iterator[Flaw]:
        """A traverse, or a plunge of a tool that must not: it may meet no material."""
        course = _straight(at, move.end)
        yield from self._clear(run, course)
        if move.end[2] > at[2]:
            return
        rapid = isinstance(move, Rapid)
        text = "a traverse goes {:.3g} mm deep into material" if rapid else (
            "a plunge goes {:.3g} mm deep into material, which the tool must not"
        )  # fmt: skip
        yield from self._meets(
            replace(run, radius=run.radius - self.allowed),
            course,
            areas(self.slabs),
            "rapid" if rapid else "plunge",
            text.format,
        )

    def _cut(self, run: Run, course: Course) -> Iterator[Flaw]:
        """Take away what a chain of feed moves sweeps; what is wrong with it."""
        if not len(course):
            return
        yield from self._clear(run, course)
        reached, cleared = self._swept(run, course)
        yield from self._gouges(run, course, reached)
        left = each_once(_without, areas(self.slabs), cleared)  # slabs of one section are cut once
        self.slabs = tuple(
            replace(slab, material=each) for slab, each in zip(self.slabs, left, strict=True)
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

    def _swept(self, run: Run, course: Course) -> tuple[list[Area], list[Area]]:
        """What a cutter reaches in each slab at most, where there is part, and what it clears at
        least, where there is material; nothing elsewhere.
        """
        level = self.level
        tops = [
            -np.inf if kernel.is_empty else slab.z1 - 2.0 * level
            for slab, kernel in zip(self.slabs, self.kernels, strict=True)
        ]
        bottoms = [-np.inf if slab.material.is_empty else slab.z0 + level for slab in self.slabs]
        if run.point <= 0.0:
            heights = sorted({*tops, *bottoms})
            areas = swept_below(course, heights, run.radius, self.fineness, self.known)
            at = dict(zip(heights, areas, strict=True))
            return [at[z] for z in tops], [at[z] for z in bottoms]
        middles = [slab.middle for slab in self.slabs]
        reached = [
            _passed(run, course.below(top), z, self.fineness, most=True)
            for top, z in zip(tops, middles, strict=True)
        ]
        cleared = [
            _passed(run, course.below(bottom), z, self.fineness)
            for bottom, z in zip(bottoms, middles, strict=True)
        ]
        return reached, cleared

    def _meets(
        self,
        run: Run,
        course: Course,
        bodies: Sequence[Area],
        name: str,
        text: Callable[[float], str],
        above: float = 0.0,
    ) -> Iterator[Flaw]:
        """Where a cutter that begins `above` the tip meets `bodies`, one for each slab."""
        for slab, body in zip(self.slabs, bodies, strict=True):
            if body.is_empty:
                continue
            low = course.below(slab.z1 - above - 2.0 * self.level)
            reached = _passed(run, low, slab.middle - above, self.fineness, most=True)
            touched = shapely.intersection(reached, body)
            if parts(touched):
                tip = float(np.min(low.lowest))
                depth = slab.z1 - above - tip
                yield Flaw(name, run.name, text(depth), depth, 0.0, _point(place_in(touched), tip))

    def _gouges(self, run: Run, course: Course, reached: Sequence[Area]) -> Iterator[Flaw]:
        both = each_once(shapely.intersection, reached, self.kernels)
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
        """How deep in the part the area `touched` of a slab lies [mm], and where: below the face
        over it or behind the wall beside it, whichever is nearer.
        """
        edge = shapely.boundary(self.part[number])
        _, middle = farthest(touched, edge)
        places = np.vstack((shapely.get_coordinates(touched), (middle.real, middle.imag)))
        points = shapely.points(places)
        face = np.full(len(places), self.slabs[number].z1)
        under = np.ones(len(places), dtype=np.bool_)
        for slab, part in zip(self.slabs[number + 1 :], self.part[number + 1 :], strict=True):
            under &= shapely.intersects(part, points)
            face[under] = slab.z1
        depths = np.minimum(shapely.distance(points, edge), face - self.slabs[number].z0)
        deepest = int(np.argmax(depths))
        return float(depths[deepest]), complex(*places[deepest])

    def _clear(self, run: Run, course: Course) -> Iterator[Flaw]:
        """Obstacles touched, and depths that are too large."""
        cylinders = [("cutter", run.radius, 0.0)]
        cylinders += [("shank", *run.shank)] if run.shank is not None else []
        for body, (what, radius, above) in product(run.obstacles, cylinders):
            outline = polygon(body.contours, self.fineness)
            low = course.below(body.z1 - above - self.level)
            touched = shapely.intersection(swept(low, radius, self.fineness), outline)
            if parts(touched):
                away = shapely.distance(swept(low, self.allowed, self.fineness), outline)
                within = max(0.0, radius - self.allowed - float(away))
                text = f"the {what} goes {within:.3g} mm into the {body.name}"
                tip = float(np.min(low.lowest))
                yield Flaw("obstacle", run.name, text, within, 0.0, _point(place_in(touched), tip))
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
    found: list[Move] = []
    lifts: list[Rapid] = []
    for move in moves:
        if isinstance(move, Stop):
            continue
        last = found[-1] if found else None
        if last is not None and not isinstance(last, Rapid) and move.end[:2] == last.end[:2]:
            if isinstance(move, Rapid) and move.end[2] >= last.end[2]:
                lifts.append(move)
                continue
            if isinstance(move, Feed) and move.end[2] < last.end[2]:
                lifts = []
                if len(found) > 1 and _falls(found[-2].end, last.end):
                    found.pop()
        found += lifts
        lifts = []
        found.append(move)
    return [*found, *lifts]


def _falls(start: Point, end: Point) -> bool:
    return start[:2] == end[:2] and start[2] > end[2]


def _straight(start: Point, end: Point) -> Course:
    """A straight move, at feed or not."""
    return course_of([Feed(end, 1.0)], start)


def _point(place: complex, z: float) -> Point:
    return (place.real, place.imag, z)


# -- left -----------------------------------------------------------------------------------------
# What is left of a blank: pieces that nothing holds any more, and material left on the part.


TOUCHING = 1e-4
"""Area [mm^2] that two pieces must share to hang together; rounding leaves less."""

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

    for k, shared in enumerate(each_once(overlap, apart[:-1], apart[1:])):
        for low, high in np.argwhere(shared > TOUCHING).tolist():
            owner[root(int(offsets[k] + low))] = root(int(offsets[k + 1] + high))
    flat = [each for slab in single for each in slab]
    groups: dict[int, list[tuple[int, Area]]] = {}
    for number, each in enumerate(flat):
        groups.setdefault(root(number), []).append(each)
    return tuple(Piece(tuple(group)) for group in groups.values())


def overlap(areas: Sequence[Area], others: Sequence[Area]) -> np.ndarray[Any, Any]:
    """(n, m) areas [mm^2] that each of `areas` (n,) shares with each of `others` (m,)."""
    if not areas or not others:
        return np.zeros((len(areas), len(others)))
    first = np.array(areas, dtype=object)[:, None]
    second = np.array(others, dtype=object)[None, :]
    found: np.ndarray[Any, Any] = shapely.area(shapely.intersection(first, second))
    return found


def _with_the_part(slabs: Sequence[Slab], part: Sequence[Area]) -> tuple[Slab, ...]:
    """The material without pieces that are apart from the part: they are taken away."""
    gone: dict[int, list[Area]] = {}
    for piece in pieces(slabs):
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
    runs: Sequence[Run],
    setup: Setup,
    allowed: float,
) -> Iterator[Flaw]:
    """Pieces that neither what holds the blank all the time nor the clamps of a run hold, each once
    where it comes loose; none if what holds it is not to be judged.

    What is nowhere thicker than `allowed` [mm] is no piece. Until the first clamp is set, a blank
    that is still one piece is held in a way that is not stated: screws often stand in a bore that
    is milled first.
    """
    if setup.held is None:
        return
    always = [polygon(each, FINENESS) for each in setup.held]
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
            told = piece in kept or any(_same(piece, each) for each in known)
            if not told and not _is_dust(piece, allowed):
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
    if not setup.known and max(map(abs, area.bounds)) > edge / np.sqrt(2.0) - LEVEL:
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
    if low is not None and slab.z1 <= low + LEVEL:
        return True
    top = max((body.z1 for body in setup.part), default=setup.top)
    return high is not None and high - LEVEL <= slab.z0 and slab.z1 <= top + LEVEL


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
    """Material that is left beside the part, or on one of its faces, thicker than `allowed` [mm];
    where rounded corners of cutters are lowest, between heights `corners` [mm], it is told apart.
    """
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


# -- sweep ----------------------------------------------------------------------------------------
# Areas that a cutter passes over on its course.


FINEST: Final = 1e-5
"""Of chords [mm], see `camgeo.milling.polygons`."""

SHARE: Final = 0.005
"""Of a distance, to which the farthest point of an area is sought."""

LONGEST: Final = 200
"""Points of a line that is widened at once. A line of several turns is met by itself at every turn:
in parts its area takes a quarter of the time."""


def swept(course: Course, radius: float, fineness: float) -> Area:
    """What a circle of `radius` [mm] passes over on `course`."""
    if not len(course) or radius <= 0.0:
        return NOTHING
    chains = (part for chain in _chains(_once(course), fineness) for part in _in_parts(chain))
    shapes = [_shape(part) for part in chains]
    found = shapely.buffer(shapes, radius, quad_segs=_quarter(radius, fineness))
    while len(found) > 1:  # neighbours first: half the time of all at once
        found = np.append(shapely.union(found[:-1:2], found[1::2]), found[len(found) // 2 * 2 :])
    return found[0]


Known = dict[tuple[float, float, bytes], tuple[Area, Area]]
"""What has been swept: areas and the same a little grown, by radius, fineness and pieces."""


def swept_below(
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
    done = np.zeros(len(course), dtype=np.bool_)
    area: Area = NOTHING
    wide: Area = NOTHING
    found = []
    for z in heights:
        fresh = (lowest <= z) & ~done[same]
        for which in (fresh & level, fresh & ~level):
            if not np.any(which):
                continue
            more, more_wide = _swept_once(taken(course, which).below(z), radius, fineness, known)
            if area.is_empty:
                area, wide = more, more_wide
            elif not shapely.covers(wide, more):
                area = shapely.union(area, more)
                wide = _wide(area, fineness)
        done[same[fresh & (highest <= z)]] = True
        found.append(area)
    return found


def _swept_once(course: Course, radius: float, fineness: float, known: Known) -> tuple[Area, Area]:
    """What is swept, looked up in `known` or added to it, and the same a little grown."""
    columns = (course.starts, course.ends, course.sweeps, course.centres)
    key = (radius, fineness, b"".join(each.tobytes() for each in columns))
    if key not in known:
        area = swept(course, radius, fineness)
        known[key] = area, _wide(area, fineness)
    return known[key]


def _wide(area: Area, fineness: float) -> Area:
    """`area` with what chords may leave at its edge, prepared for questions."""
    found = grown(area, 2.0 * fineness)
    shapely.prepare(found)
    return found


def place_in(area: Area) -> complex:
    """A point within the largest part of `area`."""
    point = shapely.point_on_surface(max(parts(area), key=lambda each: each.area))
    return complex(point.x, point.y)


def farthest(area: Area, edge: Area) -> tuple[float, complex]:
    """How far from `edge` a point of `area` lies at most [mm], and that point: of all points, not
    of its corners alone, to a hundredth.
    """
    corners = shapely.get_coordinates(area)
    away = shapely.distance(shapely.points(corners), edge)
    most = int(np.argmax(away))
    low, high, place = max(float(away[most]), FINEST), np.inf, complex(*corners[most])
    step = SHARE
    while high > (1.0 + SHARE) * low:
        middle = (1.0 + step) * low if np.isinf(high) else 0.5 * (low + high)
        beyond = shapely.difference(area, grown(edge, middle))
        if parts(beyond):
            low, place, step = middle, place_in(beyond), 1.0
        else:
            high = middle
    return float(shapely.distance(shapely.Point(place.real, place.imag), edge)), place


def _quarter(radius: float, fineness: float) -> int:
    """Chords of a quarter of a circle within `fineness`."""
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


def _in_parts(chain: ComplexArray) -> Iterator[ComplexArray]:
    """Parts of a chain, each from the end of the one before."""
    for first in range(0, max(len(chain) - 1, 1), LONGEST):
        yield chain[first : first + LONGEST + 1]


def _shape(chain: ComplexArray) -> Any:
    """A line through points, or the point that all of them are."""
    keep = np.concatenate(([True], np.diff(chain) != 0.0))
    points = np.column_stack((chain[keep].real, chain[keep].imag))
    return shapely.LineString(points) if len(points) > 1 else shapely.Point(points[0])
