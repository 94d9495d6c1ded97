"""Milling in figures: roughing from round stock, blocks and bytes, what accuracy costs in time.

Roughing: every fixture cam with an outline, from round stock at least DISTANCE larger than the
smallest round blank about the cam axis, in two depths, with one tool. Air and engagement are
computed from exact crossings of cutter, blank and course (`camgeo.milling.plan`), at samples
at most SPACING apart, the largest refined; lifts are those before the end, and what comes loose is
found by the simulation. "passes" is contour-parallel roughing of the same blank with the same tool,
made here by shapely: parallels of the finished outline a stepover apart, whole rounds, joined by
straight feed moves (air and engagement are those of the last depth); "clipped" are the same rounds
where the cutter reaches the blank, with traverses at the retract height between, if those are
quicker than feeding on. Their time is that of the same planner model for the same machine, all at
the same feed.

Segments: the finishing round of the Setzhub cam in arcs, as written, and in the fewest chords
within the same tolerance, printed in the same way.

Tolerances: the finishing round of every fixture cam, in arcs and in chords, over the tolerance,
from rest to rest, at the feed of the scene and as fast as the controller can run it.

    python benchmarks/milling.py [--scenes setzhub,inch,...] [--parts roughing,segments,tolerances]
        [--diameter 10] [--engagement 50] [--spacing 2]

The tool is the largest of DIAMETER and smaller ones that fits the outline; its stepover is a fifth
of its diameter, its allowance that of a planned roughing.
"""

from __future__ import annotations

import argparse
import math
import platform
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Any, Final

import numpy as np
import shapely

import camgeo
from camgeo.design.product import Product
from camgeo.errors import GeometryError
from camgeo.geometry.contour.contour import Contour
from camgeo.milling.cut import AreaCut, ContourCut
from camgeo.milling.judged import Side, simulation_setup, toolpath_runs
from camgeo.milling.machine import Machine, load
from camgeo.milling.machining_time import block_times, contour_time, controller_blocks
from camgeo.milling.milling import Heights, Holding, MillingSpec, Stock, Tool
from camgeo.milling.moves import Course, Feed, Move, Operation, Rapid, Toolpath, feed_course
from camgeo.milling.plan import Cutting, Engagement, plan_toolpath
from camgeo.milling.planned import plan_sequence
from camgeo.milling.simulation import simulate
from camgeo.numeric.arrays import ComplexArray
from camgeo.part.part import Boundary, Part

FIXTURES: Final = Path(__file__).resolve().parents[1] / "fixtures" / "scenes"

PARTS: Final = ("roughing", "segments", "tolerances")

DISTANCE: Final = 4.0
"""Of the diameter of the blank from that of the part about its axis [mm], rounded up to mm."""

SMALLER: Final = (10.0, 8.0, 6.0, 5.0, 4.0, 3.0, 2.0)
"""Diameters that are tried [mm]."""

STEPOVER: Final = 0.2

FEED: Final = 600.0
"""[mm/min]"""

HEIGHTS: Final = Heights(5.0, 2.0)

TOLERANCE: Final = 0.01
"""Of roughing paths and of the rings [mm]."""

QUANTILE: Final = 0.995

AIR: Final = 0.15
"""Aim: share of a roughing path in air, at most."""

TOLERANCES: Final = (1e-2, 1e-3, 1e-4, 1e-5, 1e-6)

MACHINES: Final = ("linuxcnc", "grbl")
"""Profiles whose dynamics are known."""

Place = tuple[float, float, float]


# Roughing -----------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Roughed:
    """A cam roughed from round stock.

    Attributes
    ----------
    operation : the roughing, and `others` its whole program.
    stock : its blank.
    """

    operation: Operation
    whole: Toolpath
    part: Part
    stock: Stock
    holding: Holding

    @property
    def cut(self) -> AreaCut:
        """What is roughed."""
        assert isinstance(self.operation.cut, AreaCut)
        return self.operation.cut

    @property
    def blank(self) -> Contour:
        """Outline of the stock."""
        assert self.stock.diameter is not None
        return Contour.circle(0.5 * self.stock.diameter)


def roughed(product: Product, diameter: float, limit: float) -> Roughed:
    """The program of one disc with the largest tool that fits; GeometryError if none does."""
    part, machine = product.drawn.part, load("linuxcnc")
    outline = next(each for each in part.boundaries if each.name == "outline")
    reach = float(np.max(np.abs(outline.arcs(TOLERANCE, "fast").contour.points(TOLERANCE))))
    bores = [each for each in part.boundaries if each.name == "bore"]
    bore = min((_least(each) for each in bores), default=None)
    stock = Stock(
        shape="round",
        diameter=float(math.ceil(2.0 * reach + DISTANCE)),
        bore=None if bore is None else 2.0 * bore,
    )
    thickness = part.layers[-1].z1 - part.layers[0].z0
    holding = Holding(kind="fixture", through=0.5)
    fault: GeometryError | None = None
    for size in (each for each in SMALLER if each <= diameter):
        tool = Tool(
            number=1, diameter=size, spindle_speed=3000.0, feed=FEED, plunge_feed=FEED / 3.0,
            stepdown=0.5 * (thickness + 0.5), stepover=STEPOVER * size, engagement=limit,
        )  # fmt: skip
        spec = MillingSpec(tools=(tool,), stock=stock, holding=holding)
        try:
            cuts = plan_sequence(part, spec, HEIGHTS).cuts
            whole = plan_toolpath(cuts, HEIGHTS, machine.arcs, TOLERANCE, "fast")
        except GeometryError as error:
            fault = fault or error
            continue
        cleared = [each for each in whole.operations if isinstance(each.cut, AreaCut)]
        if cleared:
            return Roughed(cleared[0], whole, part, stock, holding)
        fault = fault or GeometryError("no spiral clears its hollows")
    assert fault is not None
    raise fault


def _least(bore: Boundary) -> float:
    """Radius of a bore without its keyway [mm]."""
    points = bore.arcs(TOLERANCE, "fast").contour.points(TOLERANCE)
    return float(np.min(np.abs(points)))


def retracts(moves: Sequence[object]) -> int:
    """How often the cutter is lifted before its end."""
    heights = [move.end[2] for move in moves if isinstance(move, Feed | Rapid)]
    return max(0, sum(after > before for before, after in pairwise(heights)) - 1)


def loose(found: Roughed) -> int:
    """Pieces that come loose in the whole program."""
    runs = toolpath_runs(found.whole)
    cuts = tuple(each.cut for each in found.whole.operations)
    spec = MillingSpec(tools=(), stock=found.stock, holding=found.holding)
    setup = simulation_setup(Side(found.part, spec, cuts, runs), 1e-3)
    return sum(each.name == "loose" for each in simulate(setup, runs).flaws)


def engaged(found: Roughed, course: Course, spacing: float, bottom: float = math.inf) -> Engagement:
    """Air and engagement of a course in the blank, of the moves down to `bottom` [mm] alone."""
    cutting = Cutting(course, found.operation.tool.radius, (found.blank,), found.cut.top)
    return cutting.engagement(spacing, course.moves[course.lowest <= bottom].tolist())


def seconds(moves: Sequence[Move], machine: Machine) -> float:
    """Machining time [s], from the first point."""
    assert machine.dynamics is not None
    blocks = controller_blocks(moves, None, chord=machine.arcs.interpolation)
    return math.fsum(block_times(blocks, machine.dynamics, machine.smoothed(TOLERANCE))[0])


# The peer: contour-parallel passes ----------------------------------------------------------------


def rings(found: Roughed) -> list[ComplexArray]:
    """Closed rounds of the cutter's centre, from the outermost to the last along the outline."""
    cut = found.cut
    (wall,) = cut.walls
    contour = wall.offset(cut.tool.radius + cut.allowance).polyline(TOLERANCE, "fast").contour
    last = _polygon(contour.vertices)
    blank = _polygon(found.blank.points(1e-3))
    made = [last]
    # A round more, as long as it would cut anything.
    while not _away(last, len(made) * cut.stepover - cut.tool.radius).covers(blank):
        made.append(_away(last, len(made) * cut.stepover))
    return [_ring(each) for each in reversed(made)]


def _away(area: Any, distance: float) -> Any:
    return area.buffer(distance, quad_segs=_quarter(abs(distance)))


def _polygon(points: ComplexArray) -> Any:
    return shapely.Polygon(np.column_stack((points.real, points.imag)))


def _quarter(radius: float) -> int:
    """Chords of a quarter circle within the tolerance."""
    return max(4, math.ceil(0.25 * math.pi / math.acos(1.0 - min(TOLERANCE / radius, 0.5))))


def _ring(area: Any) -> ComplexArray:
    """Its outline clockwise, without the repeated point."""
    points = shapely.get_coordinates(shapely.simplify(area.exterior, 0.1 * TOLERANCE))[:-1]
    ring: ComplexArray = points[:, 0] + 1j * points[:, 1]
    return ring if not area.exterior.is_ccw else ring[::-1]


def passes(found: Roughed) -> list[Move]:
    """Whole rounds at each depth; in from beside the blank, and out there again at the depth."""
    cut, rounds = found.cut, rings(found)
    radius = 0.5 * (found.stock.diameter or 0.0) + cut.tool.radius + 0.5
    first = rounds[0]
    outside = radius * first[0] / abs(first[0])
    moves: list[Move] = [Rapid(_at(outside, HEIGHTS.clearance)), Rapid(_at(outside, 2.0))]
    for z in cut.depths:
        moves.append(Feed(_at(outside, z), cut.tool.plunge_feed))
        place = outside
        for ring in rounds:
            begin = int(np.argmin(np.abs(ring - place)))
            turned = np.roll(ring, -begin)
            for point in (*turned, turned[0]):
                moves.append(Feed(_at(complex(point), z), cut.tool.feed))
            place = complex(turned[0])
        moves.append(Feed(_at(outside, z), cut.tool.feed))
    moves.append(Rapid(_at(outside, HEIGHTS.clearance)))
    return moves


def clipped(found: Roughed) -> list[Move]:
    """The same rounds only where the cutter reaches the blank, where that is quicker."""
    cut = found.cut
    reach = _polygon(found.blank.points(1e-3)).buffer(cut.tool.radius, quad_segs=32)
    dynamics = load("linuxcnc").dynamics
    assert dynamics is not None
    moves: list[Move] = []
    place: complex | None = None
    for z in cut.depths:
        lift = 2.0 * (HEIGHTS.retract - z) / dynamics.rapid_feed  # [min]
        for ring in rings(found):
            for piece in _pieces(ring, reach, place, lift * cut.tool.feed):
                start = complex(piece[0])
                gap = math.inf if place is None else abs(start - place)
                if gap / cut.tool.feed > lift + gap / dynamics.rapid_feed:
                    top = HEIGHTS.retract if moves else HEIGHTS.clearance
                    if place is not None:
                        moves.append(Rapid(_at(place, top)))
                    moves += [Rapid(_at(start, top)), Rapid(_at(start, z))]
                moves += [Feed(_at(complex(point), z), cut.tool.feed) for point in piece]
                place = complex(piece[-1])
        assert place is not None
        moves.append(Rapid(_at(place, HEIGHTS.retract)))
        place = None
    return moves


def _pieces(
    ring: ComplexArray, reach: Any, place: complex | None, longest: float
) -> Iterator[ComplexArray]:
    """A round without what lies outside of `reach` for more than `longest` [mm]."""
    line = shapely.segmentize(shapely.LineString(_plane(np.append(ring, ring[0]))), 1.0)
    points = shapely.get_coordinates(line)[:-1]
    dense: ComplexArray = points[:, 0] + 1j * points[:, 1]
    within = shapely.contains_xy(reach, dense.real, dense.imag)
    if not np.any(within):
        return
    starts = np.flatnonzero(within & ~np.roll(within, 1))
    if not len(starts):  # all of it is
        begin = 0 if place is None else int(np.argmin(np.abs(dense - place)))
        turned = np.roll(dense, -begin)
        yield np.append(turned, turned[0])
        return
    begin = int(starts[0 if place is None else int(np.argmin(np.abs(dense[starts] - place)))])
    dense, within = np.roll(dense, -begin), np.roll(within, -begin)
    edges = np.flatnonzero(np.diff(within.astype(int))) + 1
    lengths = np.cumsum(np.append(0.0, np.abs(np.diff(dense))))
    first = 0
    for end, again in zip(edges[::2], [*edges[1::2], len(dense)], strict=True):
        away = lengths[min(again, len(dense) - 1)] - lengths[end - 1]
        if again < len(dense) and away <= longest:
            continue
        yield dense[first:end]
        first = again


def _plane(points: ComplexArray) -> Any:
    return np.column_stack((points.real, points.imag))


def _at(place: complex, z: float) -> Place:
    return (float(place.real), float(place.imag), float(z))


def roughing(scenes: Sequence[Path], diameter: float, limit: float, spacing: float) -> None:
    """Print a row for each external cam."""
    machine = load("linuxcnc")
    print(
        f"\nroughing from round stock, limit {math.degrees(limit):g} deg; engagement:"
        f" {100.0 * QUANTILE:g} % quantile and largest; time as a multiple of ours"
    )
    heads = ("blank", "tool", "length", "air", "engagement", "lifts", "loose", "time [s]")
    ours = "".join(f"{head:>12}" for head in heads)
    print(f"{'':24}{ours}   passes: air, engagement, time; clipped: lifts, time")
    worst_air, worst_angle, ratios = 0.0, 0.0, []
    for path in scenes:
        for product in camgeo.load(path).discs:
            boundaries = product.drawn.part.boundaries
            if not any(each.name == "outline" and not each.hole for each in boundaries):
                continue
            try:
                found = roughed(product, diameter, limit)
            except GeometryError as error:
                print(f"{product.name:24}{error}")
                continue
            course = feed_course(found.operation.moves)
            own = engaged(found, course, spacing)
            time = seconds(found.operation.travel, machine)
            whole, parts = passes(found), clipped(found)
            peer = engaged(found, feed_course(whole), spacing, found.cut.bottom)
            times = [seconds(each, machine) / time for each in (whole, parts)]
            worst_air = max(worst_air, own.air_share)
            worst_angle = max(worst_angle, own.peak)
            ratios.append(times)
            print(
                f"{product.name:24}{found.stock.diameter:12g}{found.operation.tool.diameter:12g}"
                f"{np.sum(own.lengths):12.0f}{100.0 * own.air_share:10.1f} %"
                f"{_angles(own):>12}{retracts(found.operation.moves):12d}{loose(found):12d}"
                f"{time:12.1f}   {100.0 * peer.air_share:.0f} %, {_angles(peer)}, {times[0]:.2f};"
                f" {retracts(parts)}, {times[1]:.2f}",
                flush=True,
            )
    means = np.exp(np.mean(np.log(np.array(ratios)), axis=0)) if ratios else ()
    print(
        f"largest share of air {100.0 * worst_air:.1f} % (aim {100.0 * AIR:g} %), largest"
        f" engagement {math.degrees(worst_angle):.1f} deg; mean time of passes, clipped: "
        + ", ".join(f"{each:.2f}" for each in means)
    )


def _angles(found: Engagement) -> str:
    return f"{math.degrees(found.quantile(QUANTILE)):.1f} {math.degrees(found.peak):.1f}"


# Segments -----------------------------------------------------------------------------------------


def finish(product: Product) -> ContourCut:
    """The last cut along a closed path."""
    return product.milled.contour_cuts[-1]


def segments() -> None:
    """Print blocks and bytes of one round of the Setzhub cam."""
    product = camgeo.load(FIXTURES / "setzhub.toml").disc
    centre = finish(product).centre
    print("\nfinishing round of the Setzhub cam: blocks and bytes, arcs and fewest chords")
    for tolerance in (1e-3, 1e-2):
        arcs = centre.arcs(tolerance, "fewest").contour
        chords = centre.polyline(tolerance, "fewest").contour
        sizes = [sum(map(len, printed(each))) for each in (arcs, chords)]
        print(
            f"{1000.0 * tolerance:5g} um{len(arcs):8d} blocks{sizes[0]:8,d} bytes"
            f"{len(chords):8d} blocks{sizes[1]:8,d} bytes; chords"
            f" {len(chords) / len(arcs):.1f} times the blocks, {sizes[1] / sizes[0]:.1f} the bytes"
        )


def printed(contour: Contour) -> Iterator[str]:
    """Its blocks as the writer prints them for LinuxCNC."""
    pieces = zip(contour.vertices, contour.ends, contour.sweeps, contour.centres, strict=True)
    for start, end, sweep, hub in pieces:
        arm = hub - start
        ends = f"X{end.real:.4f} Y{end.imag:.4f}"
        if sweep:
            yield f"G{3 if sweep > 0.0 else 2} {ends} I{arm.real:.4f} J{arm.imag:.4f}\n"
        else:
            yield f"G1 {ends}\n"


# Tolerances ---------------------------------------------------------------------------------------


def tolerances(scenes: Sequence[Path]) -> None:
    """Print the times of a round over the tolerance, as multiples of that at the loosest one."""
    print(
        "\nfinishing round, time at each tolerance as a multiple of that at 0.01 mm: mean, largest"
    )
    print(f"{'':36}" + "".join(f"{each:>14g}" for each in TOLERANCES))
    rounds = []
    for path in scenes:
        design = camgeo.load(path)
        if design.scene.milling is not None:
            rounds += [(finish(each), design.scene.milling.tools[0].feed) for each in design.discs]
    for form in ("arcs", "chords"):
        fits = [
            [_fit(cut.centre, form, tolerance) for tolerance in TOLERANCES] for cut, _ in rounds
        ]
        for name in MACHINES:
            for speed in ("feed", "fastest"):
                times = np.array([
                    [
                        _time(fit, feed if speed == "feed" else math.inf, name, tolerance)
                        for fit, tolerance in zip(row, TOLERANCES, strict=True)
                    ]
                    for row, (_, feed) in zip(fits, rounds, strict=True)
                ])  # fmt: skip
                shares = times / times[:, :1]
                means, most = np.exp(np.mean(np.log(shares), axis=0)), np.max(shares, axis=0)
                cells = (f"{mean:7.2f}{peak:7.2f}" for mean, peak in zip(means, most, strict=True))
                print(f"{form:8}{name:10}{speed:8}{np.sum(times[:, 0]):8.0f} s" + "".join(cells))
    print(f"{len(rounds)} rounds; the seconds are those of all rounds at the loosest tolerance")


def _fit(centre: Boundary, form: str, tolerance: float) -> Contour:
    fit = centre.arcs if form == "arcs" else centre.polyline
    return fit(tolerance, "fast").contour


def _time(contour: Contour, feed: float, name: str, tolerance: float) -> float:
    machine = load(name)
    assert machine.dynamics is not None
    chord, smoothing = machine.arcs.interpolation, machine.smoothed(tolerance)
    return contour_time(contour, feed, machine.dynamics, chord=chord, smoothing=smoothing)


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--scenes", type=lambda text: text.split(","))
    parser.add_argument("--parts", type=lambda text: text.split(","), default=[*PARTS])
    parser.add_argument("--diameter", type=float, default=10.0)
    parser.add_argument("--engagement", type=float, default=50.0)
    parser.add_argument("--spacing", type=float, default=2.0)
    arguments = parser.parse_args()
    print(f"Python {platform.python_version()}, numpy {np.__version__}, {platform.machine()}")
    scenes = [
        path
        for path in sorted(FIXTURES.glob("*.toml"))
        if arguments.scenes is None or path.stem in arguments.scenes
    ]
    if "roughing" in arguments.parts:
        limit = math.radians(arguments.engagement)
        roughing(scenes, arguments.diameter, limit, arguments.spacing)
    if "segments" in arguments.parts:
        segments()
    if "tolerances" in arguments.parts:
        tolerances(scenes)


if __name__ == "__main__":
    main()
