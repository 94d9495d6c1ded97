"""What a program of any origin does to the blank of a scene, by line."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from types import MappingProxyType
from typing import Final

import numpy as np

from camgeo.contour.nearness import distances
from camgeo.errors import SceneError
from camgeo.product.milled import job
from camgeo.product.product import Product
from camgeo.toolpath.bench import Bench
from camgeo.toolpath.course import course_of
from camgeo.toolpath.cut import ContourCut, Cut
from camgeo.toolpath.moves import Feed, Rapid, Stop
from camgeo.toolpath.plane.track import Track
from camgeo.toolpath.reach import Depth, depths
from camgeo.toolpath.setup import Run, Setup
from camgeo.toolpath.sides import Done, Side, settled, simulated
from camgeo.toolpath.simulation import ALLOWED
from camgeo.toolpath.stages import Flaw
from camgeo.toolpath.tool import END_MILL, Tool
from camgeo.verifying.linting import LineFinding
from camgeo_export.errors import FileError
from camgeo_export.interpreter.run import Run as Program
from camgeo_export.verify.simulated import Traced, traced

WORK: Final = "work"
"""What these findings concern."""

RULES: Final[Mapping[str, str]] = MappingProxyType(
    {
        "rapid": "rapid-in-material",
        "plunge": "plunge",
        "gouge": "gouged-part",
        "obstacle": "collision",
        "depth": "too-low",
        "shank": "shank",
        "loose": "loose-piece",
        "rest": "rest",
    }
)
"""Rules by the names of flaws."""

DEEPER: Final = 1e-3
"""By how much a depth may exceed what is stated [mm]: heights are printed rounded."""


def work_findings(product: Product, program: Program) -> tuple[LineFinding, ...]:
    """What the tools of the scene, run as the program says, do to its blank and its part."""
    milled = product.milled
    spec = milled.spec
    assert spec is not None  # for the scene has a tool
    cuts = _cuts(product)
    try:
        found = traced(product, program, cuts)
    except FileError as error:
        place, _, what = str(error).rpartition(": ")
        line = int(place.removeprefix("line ")) if place else 0
        return (LineFinding(line, "unknown-tool", WORK, what),)
    if not found:
        return ()
    runs = tuple(_named_apart([each.run for each in found]))
    level = program.step if math.isfinite(program.step) else 0.0
    done = _done(product, cuts, runs, level)
    bench = Bench(milled.part, spec)
    told = []
    for side, flaws in zip(done, settled(done), strict=True):
        own = side.side.runs is runs
        for flaw, seen in zip(side.simulation.flaws, flaws, strict=True):
            if not seen.watched:
                told.append(_finding(flaw, seen, found, bench) if own else _of_other(seen))
        told += _too_deep(side.setup, found) if own else ()
    return tuple(sorted(told, key=lambda each: each.line or math.inf))


def _done(
    product: Product, cuts: tuple[Cut, ...], runs: tuple[Run, ...], level: float
) -> tuple[Done, ...]:
    """Both sides of the job, or the only one; also where nothing can be planned of it."""
    milled = product.milled
    try:
        tolerance = product.scene.output.tolerance
        return job(milled, cuts, runs, tolerance, level=level, allowed=ALLOWED)
    except SceneError:
        assert milled.spec is not None  # for the scene has a tool
        side = Side(milled.part, milled.spec, cuts, runs)
        return simulated([side], allowed=ALLOWED, level=level, of=1)


def _of_other(flaw: Flaw) -> LineFinding:
    """What goes wrong with the other side of the job, as it is planned, or is left after both."""
    return LineFinding(0, RULES[flaw.name], WORK, f"of the other side, {flaw.sentence}")


def _cuts(product: Product) -> tuple[Cut, ...]:
    """Those that the scene plans; stand-ins that cut every wall, where its own tools cannot."""
    try:
        return product.milled.cuts
    except SceneError:
        spec = product.milled.spec
        assert spec is not None  # for the scene has a tool
        return tuple(
            ContourCut(
                name=wall.boundary.name,
                strategy="profile",
                tool=spec.tools[0],
                top=wall.z1,
                depths=(wall.z0,),
                centre=wall.boundary,
                right=wall.boundary.name,
            )
            for wall in product.milled.part.walls
        )


def _named_apart(runs: Sequence[Run]) -> list[Run]:
    """The runs by names of their own: what is wrong is told once for each name."""
    return [replace(run, name=f"{number} {run.name}") for number, run in enumerate(runs)]


def _finding(flaw: Flaw, seen: Flaw, found: Sequence[Traced], bench: Bench) -> LineFinding:
    """A flaw with its line; `seen` is the same with its place as the work lies."""
    number, _, name = flaw.operation.partition(" ")
    each = found[int(number)]
    what = seen.sentence.removeprefix(f"{flaw.operation}: ")
    reason = _too_large(flaw, each.tool, bench) if flaw.name in ("gouge", "rest") else ""
    what = f"{name}: {what}; {reason}" if reason else f"{name}: {what}"
    return LineFinding(_line(flaw, each), RULES[flaw.name], WORK, what)


def _too_large(flaw: Flaw, tool: Tool, bench: Bench) -> str:
    """Whether the wall at the place of a flaw is too narrow for the tool; empty if not."""
    place = np.array([complex(*flaw.place[:2])])
    contours = [wall.boundary.arcs(ALLOWED, "fast").contour for wall in bench.part.walls]
    away = [float(distances(place, Track.around(each))[0]) for each in contours]
    return bench.too_large(tool, bench.part.walls[int(np.argmin(away))].boundary)


def _line(flaw: Flaw, each: Traced) -> int:
    """The first line of a run that comes to the place of a flaw as deep as it is told."""
    run = each.run
    if flaw.name == "rest":
        return 0
    if flaw.name == "loose":
        return max((line for line, move in _lined(each) if not isinstance(move, Rapid)), default=0)
    moves = [
        move if isinstance(move, Stop) or not isinstance(move, Rapid) else Feed(move.end, 1.0)
        for move in run.moves
    ]
    course = course_of(moves, run.start)
    kind = isinstance
    wanted = np.array(
        [kind(run.moves[k], Rapid) == (flaw.name == "rapid") for k in course.moves.tolist()]
    )
    x, y, z = flaw.place
    away = course.apart(np.full(len(course), complex(x, y)))
    away = np.where(wanted & (course.lowest <= z + DEEPER), away, np.inf)
    if not np.any(np.isfinite(away)):
        return 0
    touching = np.flatnonzero(away <= max(run.radius, float(np.min(away))) + ALLOWED)
    return each.lines[int(course.moves[touching[0]])]


def _lined(each: Traced) -> Iterator[tuple[int, object]]:
    return zip(each.lines, each.run.moves, strict=True)


def _too_deep(setup: Setup, found: Sequence[Traced]) -> Iterator[LineFinding]:
    """The first move of each run that digs deeper than its tool may, for each limit."""
    told: set[tuple[int, str]] = set()
    for depth in depths(setup, [each.run for each in found]):
        each = found[depth.run]
        for rule, value, limit, what in _limits(each.tool, depth):
            if value > limit + DEEPER and (depth.run, rule) not in told:
                told.add((depth.run, rule))
                x, y, _ = depth.place
                text = f"{each.run.name}: {what} at X {x:.4g}, Y {y:.4g} mm"
                line = each.lines[depth.move]
                yield LineFinding(line, rule, WORK, text, f"{value:.4g} mm", f"{limit:g} mm")


def _limits(tool: Tool, depth: Depth) -> Iterator[tuple[str, float, float, str]]:
    """Rule, depth, limit and words for what a tool must not do."""
    if tool.kind != END_MILL:
        return
    if tool.stepdown is not None:
        yield "slot-depth", depth.ahead, tool.stepdown, "a slot deeper than the tool's stepdown"
    if tool.flute_length is not None:
        yield "flute-length", depth.beside, tool.flute_length, "deeper than the cutting edges are"
    if tool.stick_out is not None:
        yield (
            "holder",
            depth.beside,
            tool.stick_out,
            "deeper than the tool sticks out of its holder",
        )
