"""The real outline compared with polygon offsets, and what the analysis of a cam costs.

First the outline of the same flanks by camgeo and by shapely's buffer, Clipper2 (through pyclipr)
and manifold3d's `CrossSection.offset`, each with its error and its time. The peers get the polygon
of exact points of the pitch curve and offset it by the roller radius; of the settings tried
(segments per quarter circle, integer scale, arc tolerance) the one with the smallest error counts.
Their time is that of the points and of the offset, from a single run if it takes a second, else
the best of many. The motion is made beforehand and not counted for anyone.

camgeo has two entries:

- "stretches": the extremes of the curvature, the search for all crossings, the outline of stretches
  of the exact curve, and as many points of it as the finest peer was given;
- "arcs": the same search, and instead of points the contour of tangent arcs with its proof, for a
  tolerance of a thousandth of the best peer's error.

Errors [mm]:

- of a peer: the largest distance of its vertices and of three points of each edge from the exact
  outline, which is the amount by which their distance from the pitch curve differs from the roller
  radius (beyond a corner it is even more); and of points and corners of the exact outline from its
  polygon;
- of the stretches: the largest distance of points at equal cam angles, and of corners, from the
  exact ones, with 40 digits by `tests.stability.exact_cam`, which has no formula in common with
  the engine; it solves for the corners to 30 digits;
- of the arcs: the proved deviation.

Then the time of `Design.findings`, which includes all checks and the search for global undercut,
for cams of 2 to 200 segments: moves up and down with rests between them, and no undercut.

The time of Clipper2 grows with the square of the number of points here: runs that would take longer
than `--patience` are left out, which the output states. The whole run takes several minutes.


    pip install pyclipr  # not among the requirements; without it that peer is skipped
    python benchmarks/outline.py [--points 3600,14400,57600] [--patience 5] [--rounds 30]
        [--cams setzhub,HC22] [--segments 2,4,10,20,50,100,200]
"""

from __future__ import annotations

import argparse
import functools
import importlib
import json
import math
import platform
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from decimal import Decimal
from importlib.metadata import version
from itertools import pairwise
from pathlib import Path
from types import ModuleType
from typing import Any, Final

import mpmath
import numpy as np
import shapely
from scipy.spatial import KDTree

from camgeo.design.design import Design
from camgeo.errors import ToleranceError
from camgeo.geometry.contour.arcs import fit_arcs
from camgeo.geometry.outline.outline import real_outline, sure_bends
from camgeo.geometry.outline.path import Path as OutlinePath
from camgeo.geometry.pieces import curvature_extremes
from camgeo.geometry.pitch_curve import PitchCurve, WorkingCurve
from camgeo.kinematics.laws import make_law
from camgeo.kinematics.mechanism.linkages import SliderCrank
from camgeo.kinematics.mechanism.rollers import OscillatingRoller, TranslatingRoller
from camgeo.kinematics.motion import Motion
from camgeo.kinematics.plan import Dwell, MotionPlan, Move
from camgeo.numeric.arrays import ComplexArray, FloatArray
from camgeo.scene.scene import load_scene, parse_scene
from camgeo.units import TURN
from tests.stability.exact_cam import Stage

FIXTURES: Final = Path(__file__).resolve().parents[1] / "fixtures"

SCENES: Final = ("plate_translating", "setzhub", "groove")
"""Offset guide with two laws; rocker behind a slider-crank; rocker in a groove, two flanks."""

HARD_CASES: Final = ("HC21c", "HC22")
"""A swallow tail; a lobe that is cut off."""

GAIN: Final = 1000.0
"""Error of the best peer over that of camgeo: the target."""

PATIENT: Final = 1.0
"""What takes longer [s] is not repeated."""

EXACT_POINTS: Final = 192
"""Points at which camgeo is compared with 40 digits, besides all corners."""

STEPS: Final = 6
"""Newton steps to a corner: from the engine's, correct to 14 digits, three suffice."""

SECTORS: Final = 8
"""Parts of the turn in each of which the nearest point of the pitch curve is sought."""

SAMPLES: Final = 1024
"""Points of the pitch curve in each sector, from which Newton's method starts."""

MOST: Final = 60_000
"""Edges of a result that are measured; of more, every second, third and so on."""

Peer = Callable[[FloatArray, float], Sequence[FloatArray]]
"""Vertices (n, 2) of a polygon and the signed offset [mm] -> the rings (m, 2) of the result."""


# -- the cams ------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class Cam:
    """A flank to be compared: the parallel at `distance` [mm] of the pitch curve."""

    name: str
    plan: MotionPlan
    motion: Motion
    linkage: SliderCrank | None
    follower: TranslatingRoller | OscillatingRoller
    rotation: int
    distance: float

    def flank(self) -> WorkingCurve:
        """The whole working curve, made anew."""
        return WorkingCurve(PitchCurve(self.motion, self.follower, self.rotation), self.distance)


def all_cams() -> list[Cam]:
    """The flanks of the scenes and of the hard cases."""
    found = []
    for name in SCENES:
        scene = load_scene(FIXTURES / "scenes" / f"{name}.toml")
        design = Design(scene)
        linkage = scene.linkage
        if linkage is not None and not isinstance(linkage, SliderCrank):
            continue  # there are no exact values of the others
        follower: Any = design.cam.follower
        for flank, curve in design.cam.disc.flanks:
            title = name if len(design.cam.disc.flanks) == 1 else f"{name} {flank}"
            found.append(
                Cam(
                    title, scene.plan, design.cam.drive.motion, linkage,
                    follower, scene.rotation, curve.distance,
                )
            )  # fmt: skip
    cases = json.loads((FIXTURES / "reference" / "hard_cases.json").read_text("utf-8"))
    for name in HARD_CASES:
        (params,) = [case["params"] for case in cases if case["id"] == name]
        law = make_law("polynomial-345", "R-R")
        first, rise, rest, back, last = (Decimal(str(span)) for span in params["phi_H"])
        stroke, roller = float(params["s_H"]), float(params["r_R"])
        segments = (
            Dwell(first), Move(rise, stroke, law), Dwell(rest), Move(back, 0.0, law), Dwell(last),
        )  # fmt: skip
        plan = MotionPlan(segments)
        follower = TranslatingRoller(float(params["r_G"]), roller, offset=float(params["e"]))
        found.append(Cam(name, plan, plan, None, follower, params["sigma"], -roller))
    return found


# -- camgeo --------------------------------------------------------------------------------------


def search(cam: Cam) -> OutlinePath:
    """The outline from nothing but the motion."""
    flank = cam.flank()
    return real_outline(flank, sure_bends(flank, curvature_extremes(flank.pitch))).path


def points_of(path: OutlinePath, count: int) -> tuple[FloatArray, ComplexArray]:
    """About `count` points of all stretches, evenly over the cam angle, and their cam angles."""
    whole = math.fsum(stretch.end - stretch.start for stretch in path.stretches)
    angles, points = [], []
    for stretch in path.stretches:
        share = (stretch.end - stretch.start) / whole
        phi = np.linspace(
            stretch.start, stretch.end, max(2, round(count * share)), endpoint=not path.is_whole
        )
        angles.append(phi)
        points.append(stretch.curve.point(phi))
    return np.concatenate(angles), np.concatenate(points)


class Exact:
    """The flank by its definition, to 40 digits."""

    DIGITS: Final = 40

    def __init__(self, cam: Cam) -> None:
        self.distance = cam.distance
        self.stages: list[tuple[float, Stage, tuple[float, ...]]] = []
        position = 0.0
        for segment, joints in zip(cam.plan.segments, pairwise(cam.plan.joints_deg), strict=True):
            start, end = (math.radians(float(joint)) for joint in joints)
            law, inflection, goal = "polynomial-345", 0.5, position
            if isinstance(segment, Move):
                law, goal = segment.law.name, segment.to
                inflection = float(segment.law.parameters.get("inflection", 0.5))
            elif not isinstance(segment, Dwell):
                raise SystemExit(f"{cam.name}: no exact values of a motion by data")
            if end > start:
                stage = Stage(law, cam.follower, cam.linkage, cam.rotation)
                numbers = stage.parameters(start, end, position, goal, inflection)
                self.stages.append((start, stage, numbers))
            position = goal

    def point(self, phi: Any) -> Any:
        """The point at a cam angle [rad]."""
        with mpmath.workdps(self.DIGITS):
            phi = mpmath.mpf(phi)
            phi -= TURN if phi >= TURN else 0
            _, stage, numbers = [each for each in self.stages if each[0] <= phi][-1]
            jet = stage.jet(phi, [mpmath.mpf(number) for number in numbers], 2)
            return jet.parallel(mpmath.mpf(self.distance))

    def corner(self, before: float, after: float) -> Any:
        """Where the flank crosses itself, by Newton's method from two cam angles [rad] near it."""
        with mpmath.workdps(self.DIGITS):
            x, y, step = mpmath.mpf(before), mpmath.mpf(after), mpmath.mpf(10) ** -20
            for _ in range(STEPS):
                at_x, at_y = self.point(x), self.point(y)
                along_x = (self.point(x + step) - at_x) / step
                along_y = (self.point(y + step) - at_y) / step
                gap = at_y - at_x
                # along_x dx - along_y dy = gap
                sine = mpmath.im(mpmath.conj(along_y) * along_x)
                dx = mpmath.im(mpmath.conj(along_y) * gap) / sine
                dy = mpmath.im(mpmath.conj(along_x) * gap) / sine
                x, y = x + dx, y + dy
            if not abs(self.point(x) - self.point(y)) < mpmath.mpf(10) ** -30:
                raise SystemExit("the corner was not found to 30 digits")
            return self.point(x)

    def error(self, path: OutlinePath, phi: FloatArray, points: ComplexArray) -> float:
        """Largest distance [mm] of some of `points` at `phi`, and of all corners, from theirs."""
        places = np.linspace(0, len(phi) - 1, EXACT_POINTS).astype(int)
        found = [abs(self.point(phi[k]) - mpmath.mpc(complex(points[k]))) for k in places]
        found += [
            abs(self.corner(pivot.phi_start, pivot.phi_end) - mpmath.mpc(pivot.centre))
            for pivot in path.pivots
        ]
        return float(max(found))


# -- the peers -----------------------------------------------------------------------------------


@functools.cache
def find_peers() -> dict[str, dict[str, Peer]]:
    """Settings of each peer, by their names."""
    peers: dict[str, dict[str, Peer]] = {}
    segments = (16, 64, 256, 1024)
    peers["shapely"] = {f"quad_segs {n}": functools.partial(by_shapely, n) for n in segments}
    pyclipr = module("pyclipr", "Clipper2")
    if pyclipr is not None:
        # Arcs within 1e-9 mm; finer ones are more points and no smaller error.
        settings = ((1e9, 1.0), (1e12, 1e3), (1e15, 1e6))
        peers["Clipper2"] = {
            f"scale {scale:.0e}": functools.partial(by_clipper, pyclipr, scale, tolerance)
            for scale, tolerance in settings
        }
    manifold = module("manifold3d", "manifold3d")
    if manifold is not None:
        peers["manifold3d"] = {
            f"{n} segments": functools.partial(by_manifold, manifold, n) for n in (1024, 16384)
        }
    return peers


def module(name: str, peer: str) -> ModuleType | None:
    """The module, or None and a line that says so."""
    try:
        return importlib.import_module(name)
    except ImportError:
        print(f"{peer} skipped: {name} is not installed (pip install {name})")
        return None


def by_shapely(segments: int, polygon: FloatArray, offset: float) -> Sequence[FloatArray]:
    """`shapely.buffer` with round joints."""
    moved = shapely.get_parts(shapely.buffer(shapely.Polygon(polygon), offset, quad_segs=segments))
    return [np.asarray(part.exterior.coords)[:-1] for part in moved]


def by_clipper(
    pyclipr: Any, scale: float, tolerance: float, polygon: FloatArray, offset: float
) -> Sequence[FloatArray]:
    """Clipper2's offset; `tolerance` of arcs in units of the integers that `scale` makes."""
    clipper = pyclipr.ClipperOffset()
    clipper.scaleFactor = scale
    clipper.arcTolerance = tolerance
    clipper.addPath(polygon, pyclipr.JoinType.Round, pyclipr.EndType.Polygon)
    return [np.asarray(ring) for ring in clipper.execute(offset)]


def by_manifold(
    manifold: Any, segments: int, polygon: FloatArray, offset: float
) -> Sequence[FloatArray]:
    """manifold3d's offset; `segments` a full circle."""
    section = manifold.CrossSection([polygon], manifold.FillRule.NonZero)
    moved = section.offset(offset, manifold.JoinType.Round, circular_segments=segments)
    return [np.asarray(ring) for ring in moved.to_polygons()]


def polygon_of(cam: Cam, count: int) -> FloatArray:
    """(count, 2) [mm] exact points of the pitch curve."""
    return columns(cam.flank().pitch.point(np.linspace(0.0, TURN, count, endpoint=False)))


def columns(points: ComplexArray) -> FloatArray:
    """(n, 2) x and y."""
    return np.column_stack((points.real, points.imag))


def ring_about_axis(rings: Sequence[FloatArray]) -> ComplexArray:
    """(n,) the largest ring that goes round the cam axis."""
    best, largest = np.empty(0, dtype=np.complex128), 0.0
    for ring in rings:
        points = ring[:, 0] + 1j * ring[:, 1]
        steps = np.conj(points) * np.roll(points, -1)
        area = abs(float(np.sum(steps.imag)))
        if abs(float(np.sum(np.angle(steps)))) > 1.0 and area > largest:
            best, largest = points, area
    return best


class Measure:
    """Distances from the exact outline of one flank, in double precision."""

    def __init__(self, cam: Cam, path: OutlinePath) -> None:
        self.pitch, self.roller = cam.flank().pitch, abs(cam.distance)
        self.step = TURN / (SECTORS * SAMPLES)
        self.sectors = [
            self.step * (SAMPLES * sector + np.arange(SAMPLES, dtype=np.float64))
            for sector in range(SECTORS)
        ]
        self.fastest = float(np.max(np.abs(self.pitch.jet(np.concatenate(self.sectors))[1])))
        self.trees = [KDTree(columns(self.pitch.point(phi))) for phi in self.sectors]
        corners = [pivot.centre for pivot in path.pivots]
        self.outline = np.concatenate((points_of(path, 3600)[1], corners))

    def off(self, points: ComplexArray) -> FloatArray:
        """(n,) how far the distance from the pitch curve is from the roller radius [mm]."""
        found = [tree.query(columns(points)) for tree in self.trees]
        least = np.min([away for away, _ in found], axis=0)
        # From the sample to the nearest point it is a step along the curve at most.
        reach = least + self.step * self.fastest
        for (away, nearest), phi in zip(found, self.sectors, strict=True):
            near = np.flatnonzero(away < reach)
            least[near] = np.minimum(least[near], self._settled(points[near], phi[nearest[near]]))
        return np.asarray(np.abs(least - self.roller), dtype=np.float64)

    def _settled(self, points: ComplexArray, phi: FloatArray) -> FloatArray:
        """(n,) distance of the pitch curve near `phi` (n,) by Newton's method."""
        least = np.full(len(phi), math.inf)
        for _ in range(6):
            jet = self.pitch.jet(phi)
            way = jet[0] - points
            least = np.minimum(least, np.abs(way))
            slope = (way * np.conj(jet[1])).real
            bend = np.abs(jet[1]) ** 2 + (way * np.conj(jet[2])).real
            with np.errstate(divide="ignore", invalid="ignore"):
                phi = phi - np.clip(np.nan_to_num(slope / bend), -self.step, self.step)
        return np.asarray(np.minimum(least, np.abs(self.pitch.point(phi) - points)))

    def error(self, ring: ComplexArray) -> float:
        """Largest distance [mm] between a polygon and the exact outline, either way."""
        if len(ring) < 3:
            return math.inf
        every = slice(None, None, math.ceil(len(ring) / MOST))
        starts, edges = ring[every], (np.roll(ring, -1) - ring)[every]
        shares = (0.0, 0.25, 0.5, 0.75)
        there = max(float(np.max(self.off(starts + share * edges))) for share in shares)
        line = shapely.LinearRing(columns(ring))
        shapely.prepare(line)
        back = shapely.distance(line, shapely.points(columns(self.outline)))
        return max(there, float(np.max(back)))


# -- comparison ----------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class Row:
    """One line of the table: error [mm] and time [s]; `points` are vertices or arcs."""

    method: str
    points: int
    error: float
    seconds: float


def best_time(work: Callable[[], object], rounds: int) -> float:
    """Shortest time of `work` [s] in at most `rounds` runs."""
    least, spent = math.inf, 0.0
    for _ in range(rounds):
        began = time.perf_counter()
        work()
        took = time.perf_counter() - began
        least, spent = min(least, took), spent + took
        if spent > PATIENT:
            break
    return least


def rows_of_peers(
    cam: Cam, measure: Measure, counts: Sequence[int], rounds: int, patience: float
) -> tuple[list[Row], list[str]]:
    """The rows, and what was left out."""
    rows: list[Row] = []
    left: list[str] = []
    for peer, settings in find_peers().items():
        chosen, last = "", (0, 0.0)
        for count in counts:
            expected = last[1] * (count / last[0]) ** 2 if last[0] else 0.0
            if expected > patience and last[1] > 0.02:
                left.append(f"{peer} of {count} points: some {expected:.0f} s to be expected")
                continue
            tried: dict[str, tuple[float, int]] = {}
            seconds = math.inf
            for name in [chosen] if chosen else settings:
                began = time.perf_counter()
                rings = settings[name](polygon_of(cam, count), cam.distance)
                seconds = time.perf_counter() - began
                ring = ring_about_axis(rings)
                tried[name] = (measure.error(ring), len(ring))
            chosen = min(tried, key=lambda name: tried[name][0])
            offset = settings[chosen]

            def work(count: int = count, offset: Peer = offset) -> None:
                offset(polygon_of(cam, count), cam.distance)

            if seconds < PATIENT or len(tried) > 1:
                seconds = best_time(work, rounds)
            last = (count, seconds)
            error, vertices = tried[chosen]
            rows.append(Row(f"{peer} of {count}, {chosen}", vertices, error, seconds))
    return rows, left


def compare(cam: Cam, counts: Sequence[int], rounds: int, patience: float) -> bool:
    """Print the table of one flank; True if the target is reached."""
    path, finest = search(cam), max(counts)
    phi, points = points_of(path, finest)
    measure = Measure(cam, path)
    if float(np.max(measure.off(points))) > 1e-7:
        raise SystemExit(f"{cam.name}: what camgeo keeps is not at the roller radius")
    peers, left = rows_of_peers(cam, measure, counts, rounds, patience)
    best = min(peers, key=lambda row: row.error)

    own = Row(
        "camgeo, stretches",
        len(points),
        Exact(cam).error(path, phi, points),
        best_time(lambda: points_of(search(cam), finest), rounds),
    )
    rows = [own, *peers]
    try:
        fit = fit_arcs(path, best.error / GAIN)
        seconds = best_time(lambda: fit_arcs(search(cam), best.error / GAIN), rounds)
        rows.insert(1, Row("camgeo, arcs", len(fit.contour), fit.deviation, seconds))
    except ToleranceError as error:
        left.append(f"camgeo, arcs: {error}")

    corners = len(path.pivots)
    print(f"\n{cam.name}: offset {cam.distance:+g} mm, {corners} corner{'s' * (corners != 1)}")
    print(
        f"{'':<42}{'points':>8}{'error [mm]':>12}{'time [ms]':>11}{'error':>11}{'time':>8}"
        "  as a multiple of the first row"
    )
    for row in rows:
        print(
            f"{row.method:<42}{row.points:>8}{row.error:>12.2e}{1e3 * row.seconds:>11.1f}"
            f"{row.error / own.error:>11.1e}{row.seconds / own.seconds:>8.2f}"
        )
    for line in left:
        print(f"left out: {line}")
    kept = [
        row
        for row in rows
        if row.method.startswith("camgeo")
        and GAIN * row.error <= best.error
        and row.seconds <= best.seconds
    ]
    exact = " and ".join(row.method for row in kept)
    print(
        f"best peer: {best.method}; a thousandth of its error in no more time: {exact or 'MISSED'}"
    )
    return bool(kept)


# -- analysis ------------------------------------------------------------------------------------


def scene_of(segments: int) -> str:
    """A scene of so many segments: moves up and down, rests between them.

    The acceleration is the same for all, so that no roller is too large.
    """
    stroke = 80.0 / segments**2
    moves = max(2, segments // 2)
    goals = [stroke if number % 2 == 0 else 0.0 for number in range(moves)]
    if moves % 2:
        goals[-2:] = [0.5 * stroke, 0.0]
    lines = [
        "camgeo = 1",
        f'name = "of-{segments}"',
        '[cam]\nrotation = "ccw"',
        '[follower]\nkind = "translating-roller"\nbase_radius = 100\nroller_radius = 10',
    ]
    span = Decimal(360) / segments
    for number, goal in enumerate(goals):
        law = ("polynomial-345", "modified-sine")[number % 2]
        lines.append(f'[[motion]]\nlaw = "{law}"\nspan = {span}\nto = {goal!r}')
        if segments > 2:
            lines.append(f"[[motion]]\ndwell = {span}")
    return "\n".join(lines) + "\n"


def analyse(segments: int, rounds: int) -> tuple[float, float, float]:
    """Times [s] of the findings, of the extremes of the curvature, of the outline's search."""
    scene = parse_scene(scene_of(segments))
    if any(finding.severity != "ok" for finding in Design(scene).findings):
        raise SystemExit(f"{segments} segments: the cam has undercut")
    findings = best_time(lambda: Design(scene).findings, rounds)
    bends = best_time(lambda: Design(scene).cam.disc.bends, rounds)
    design = Design(scene)
    flank, known = design.cam.disc.inner_curve, design.cam.disc.bends
    return findings, bends, best_time(lambda: real_outline(flank, known), rounds)


def print_analysis(counts: Sequence[int], rounds: int) -> None:
    """Print the table and the exponent of its growth."""
    print(f"\nall checks of one cam, best of at most {rounds}")
    print(
        f"{'segments':>8}{'findings':>12}{'a segment':>12}{'curvature':>12}{'crossings':>12}"
        f"{'share':>8}"
    )
    times = {}
    for count in counts:
        findings, bends, crossings = analyse(count, rounds)
        times[count] = findings
        print(
            f"{count:>8}{1e3 * findings:>9.1f} ms{1e3 * findings / count:>9.2f} ms"
            f"{1e3 * bends:>9.1f} ms{1e3 * crossings:>9.1f} ms{100 * crossings / findings:>6.0f} %"
        )
    long = {count: seconds for count, seconds in times.items() if count >= 10}
    if len(long) > 1:
        exponent = np.polyfit(np.log(list(long)), np.log(list(long.values())), 1)[0]
        print(f"from {min(long)} to {max(long)} segments it grows with the power {exponent:.2f}")


def numbers(text: str) -> list[int]:
    """Whole numbers with commas between them, ascending."""
    return sorted(int(part) for part in text.split(","))


def main() -> int:
    """Measure and print; exit with 1 if the target is missed on a flank."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--points", type=numbers, default=[3600, 14400, 57600])
    parser.add_argument("--patience", type=float, default=5.0, help="seconds a peer may take")
    parser.add_argument("--rounds", type=int, default=30)
    parser.add_argument("--cams", default="", help="beginnings of their names; else all")
    parser.add_argument("--segments", type=numbers, default=[2, 4, 10, 20, 50, 100, 200])
    arguments = parser.parse_args()
    print(
        f"Python {platform.python_version()}, {platform.machine()},"
        f" best of at most {arguments.rounds}; "
        + ", ".join(f"{name} {version(name)}" for name in ("numpy", "shapely"))
    )
    chosen = tuple(arguments.cams.split(","))
    reached = [
        compare(cam, arguments.points, arguments.rounds, arguments.patience)
        for cam in all_cams()
        if cam.name.startswith(chosen)
    ]
    print_analysis(arguments.segments, arguments.rounds)
    return 0 if all(reached) else 1


if __name__ == "__main__":
    raise SystemExit(main())
