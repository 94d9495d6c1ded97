"""Pieces and time of the contours, compared with the curve itself and with other programs.

First the fits of one flank with their proofs, as multiples of the time that the flank with its
derivatives takes at 30,000 and at 600,000 points, measured in turns in one run: the pitch curve
with three derivatives, and the points and the curvature of the flank, as `camgeo table` computes
them; and their numbers of pieces over the least possible for small tolerances, see
`camgeo.studies.accuracy.contours`.

Then each form compared with the programs of `peers.py`. They get exact points, evenly spaced and so
dense that less than a hundredth of the tolerance is lost. Bisection of its own parameter brings
each to the fewest pieces whose measured deviation is within the tolerance. All contours, camgeo's
too, are measured in the same way: points of the contour, at least 16 a piece, from the exact
curve, and finally points of the exact curve from the contour.

In favour of the peers:

- they get the closed curve, and then each smooth piece by itself; the better result counts;
- in the latter case their pieces need not meet at the ends, and a dwell counts as one arc or cubic
  at no cost;
- their time is that of the one call with the best parameter, without the search for it and without
  the conversion of the points to their types. The points are timed separately: "points" is the
  time to evaluate them, "call" that of the call, "search" that of the points and of all calls of
  the search, without the measurements in between. camgeo's time runs from the curve to the end of
  the proof, which the peers do not have.

The target is fewer pieces than every peer, in less time than its points and call. Joints that are
worse than camgeo's are reported: G1 where those are C2, and gaps where pieces meet.

    pip install fonttools cadquery-ocp-novtk kurbopy  # peers that are not among the requirements
    python benchmarks/contour.py [--tolerances 1e-2,1e-3,1e-4] [--rounds 5] [--patience 0.5]
        [--cams setzhub,plate_translating,groove] [--forms chords,arcs,cubics]
"""

from __future__ import annotations

import argparse
import functools
import itertools
import math
import platform
import statistics
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path
from typing import Any, Final

import numpy as np
from scipy.spatial import KDTree

from benchmarks.peers import (
    Form,
    Peer,
    Sample,
    Shape,
    arcs,
    bspline,
    chords,
    columns,
    fewest,
    find_peers,
    joined,
)
from camgeo.design.design import Design
from camgeo.geometry.contour.arcs import fewest_arcs, fit_arcs
from camgeo.geometry.contour.chords import fit_polyline
from camgeo.geometry.contour.contour import Contour
from camgeo.geometry.contour.cubics import fewest_cubics, fit_spline
from camgeo.geometry.contour.fewest_chords import fewest_chords
from camgeo.geometry.contour.spline import CubicSpline, SplineContour
from camgeo.geometry.outline.path import Path as OutlinePath
from camgeo.geometry.pieces import SmoothPiece, smooth_pieces
from camgeo.geometry.pitch_curve import WorkingCurve
from camgeo.numeric.arrays import ComplexArray, FloatArray, IntArray
from camgeo.scene.scene import load_scene
from camgeo.studies.accuracy.contours import forced_pieces, least_arcs, least_chords, least_cubics
from camgeo.units import TURN

Fitting = Callable[[OutlinePath, float], Any]

SCENES: Final = Path(__file__).resolve().parents[1] / "fixtures" / "scenes"

CAMS: Final = ("setzhub", "plate_translating", "groove")
"""Rocker behind a slider-crank; offset guide with two laws; rocker in a groove, two flanks."""

TIMED: Final = (1e-2, 1e-3, 1e-4, 1e-5)
"""Tolerances [mm] of the first table; the target is stated for a thousandth."""

EVALUATIONS: Final = {"fast": 30_000, "fewest": 600_000}
"""Points at which evaluating the curve with its derivatives takes as long as a fit may."""

FORMS: Final[tuple[Form, ...]] = ("chords", "arcs", "cubics")

FITS: Final[dict[tuple[Form, str], Fitting]] = {
    ("chords", "fast"): fit_polyline,
    ("chords", "fewest"): fewest_chords,
    ("arcs", "fast"): fit_arcs,
    ("arcs", "fewest"): fewest_arcs,
    ("cubics", "fast"): fit_spline,
    ("cubics", "fewest"): fewest_cubics,
}

SHARE: Final = 0.005
"""Largest sagitta between points for chords, as a share of the tolerance."""

DENSE: Final = 40
"""Fewest points for each necessary cubic; arcs get the same points."""

FEWEST: Final = 2000
"""Fewest points of the whole curve."""

RULER: Final = 20_000
"""Exact points from whose parabolas the distances are measured."""

A_PIECE: Final = 16
"""Points of each piece of a contour that are measured, at least."""

A_CONTOUR: Final = 4000
"""Points of a whole contour that are measured, evenly over its length."""

BLUR: Final = 0.002
"""Largest sagitta between points of a contour that the exact points are measured from, as a share
of the tolerance."""

SAME: Final = 1e-12
"""Points closer together than this share of the length of the curve count as one."""

GAP: Final = 0.01
"""Gaps between pieces larger than this share of the tolerance are reported."""

ENOUGH: Final = 0.3
"""What takes longer in total [s] is not repeated."""


# -- measuring ----------------------------------------------------------------------------------


def evenly(curve: WorkingCurve, start: float, end: float, count: int) -> FloatArray:
    """(count + 1,) cam angles from `start` to `end`, about even over the arc length."""
    phi = np.linspace(start, end, 4001)
    places = np.concatenate(([0.0], np.cumsum(np.abs(np.diff(curve.point(phi))))))
    found = np.interp(np.linspace(0.0, places[-1], count + 1), places, phi)
    found[0], found[-1] = start, end
    return found


def one_sided(of: Callable[..., Any], phi: FloatArray) -> Any:
    """Values at `phi`, at the last angle the left-hand ones."""
    values = of(phi)
    values[-1] = of(phi[-1:], "left")[0]
    return values


class Ruler:
    """Distances from the exact curve and back."""

    def __init__(self, curve: WorkingCurve, pieces: Sequence[SmoothPiece]) -> None:
        angle = sum(piece.end - piece.start for piece in pieces)
        points, tangents, bends = [], [], []
        for piece in pieces:
            count = math.ceil(RULER * (piece.end - piece.start) / angle)
            phi = evenly(curve, piece.start, piece.end, count)
            points.append(one_sided(curve.point, phi))
            tangents.append(one_sided(curve.tangent, phi))
            # Curvature, positive to the left; each sample has that of its own piece.
            bends.append(-curve.pitch.rotation * one_sided(curve.curvature, phi))
        self.points = np.concatenate(points)
        self.tangents = np.concatenate(tangents)
        self.bends = np.concatenate(bends)
        self.tree = KDTree(columns(self.points))

    def _off(self, points: ComplexArray) -> FloatArray:
        """(n,) distance from the parabola at the nearest sample; its error is of third order in
        half the distance of two samples.
        """
        nearest = self.tree.query(columns(points))[1]
        local = (points - self.points[nearest]) * np.conj(self.tangents[nearest])
        off: FloatArray = local.imag - 0.5 * self.bends[nearest] * local.real**2
        return np.abs(off)

    def there(self, shape: Shape) -> float:
        """Largest distance [mm] of the contour from the curve."""
        points = along(shape, A_CONTOUR)
        return float(np.max(self._off(points))) if np.all(np.isfinite(points)) else math.inf

    def back(self, shape: Shape, tolerance: float) -> float:
        """Largest distance [mm] of the curve from the contour, nearer than `BLUR`."""
        length = float(np.sum(np.abs(np.diff(self.points))))
        bend = float(np.max(np.abs(self.bends)))
        count = math.ceil(length * math.sqrt(bend / (8.0 * BLUR * tolerance)))
        points = along(shape, max(A_CONTOUR, count))
        step = np.abs(points - np.roll(points, 1))
        points = points[step > SAME * length]
        # The edges are short: the nearest is one of those about the nearest vertex.
        exact = self.points[::2]
        nearest = KDTree(columns(points)).query(columns(exact))[1]
        edges = [_from_edges(exact, points, nearest + side) for side in (-2, -1, 0, 1)]
        return float(np.max(np.minimum.reduce(edges)))


def _from_edges(exact: ComplexArray, points: ComplexArray, first: IntArray) -> FloatArray:
    """(n,) distance of each of `exact` from the edge that begins at its vertex `first` (n,)."""
    start = points[first % len(points)]
    side = points[(first + 1) % len(points)] - start
    square = side.real**2 + side.imag**2
    share = ((exact - start) * np.conj(side)).real / np.where(square > 0.0, square, 1.0)
    return np.abs(exact - start - np.clip(share, 0.0, 1.0) * side)


def along(shape: Shape, count: int) -> ComplexArray:
    """About `count` points of a contour, evenly over its length, all ends of pieces among them."""
    every = np.arange(shape.pieces)
    coarse = [shape.at(every, np.full(shape.pieces, share)) for share in np.linspace(0, 1, 9)]
    lengths = np.sum(np.abs(np.diff(coarse, axis=0)), axis=0)
    if not np.all(np.isfinite(lengths)):
        return np.full(1, np.inf + 0j)
    counts = np.maximum(A_PIECE, np.ceil(count * lengths / np.sum(lengths))).astype(int) + 1
    piece = np.repeat(every, counts)
    step = np.arange(len(piece)) - np.repeat(np.cumsum(counts) - counts, counts)
    return shape.at(piece, step / (counts[piece] - 1.0))


# -- the flanks ----------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True, eq=False)
class Flank:
    """A flank that is cut off nowhere."""

    name: str
    path: OutlinePath
    curve: WorkingCurve
    pieces: tuple[SmoothPiece, ...]
    ruler: Ruler
    length: float

    def sample(self, piece: SmoothPiece, count: int, *, closed: bool) -> Sample:
        """About `count` points a whole turn, of `piece`."""
        phi = self.angles(piece, count)
        points = one_sided(self.curve.point, phi)
        if closed:
            points[-1] = points[0]
        return Sample(points, one_sided(self.curve.tangent, phi), closed)

    def angles(self, piece: SmoothPiece, count: int) -> FloatArray:
        """Cam angles of its points."""
        share = self.part(piece) / self.length
        return evenly(self.curve, piece.start, piece.end, max(16, math.ceil(share * count)))

    def part(self, piece: SmoothPiece) -> float:
        """Length of `piece` [mm]."""
        phi = np.linspace(piece.start, piece.end, 4001)
        return float(np.sum(np.abs(np.diff(self.curve.point(phi)))))

    def density(self, form: Form, tolerance: float) -> int:
        """The points of the whole turn for the peers."""
        if form != "chords":
            return max(FEWEST, math.ceil(DENSE * least_cubics(self.path, tolerance)))
        bend = float(np.max(np.abs(self.ruler.bends)))
        return max(FEWEST, math.ceil(self.length * math.sqrt(bend / (8.0 * SHARE * tolerance))))

    def least(self, form: Form, tolerance: float) -> float:
        """The limit for small tolerances, besides forced pieces."""
        least = {"chords": least_chords, "arcs": least_arcs, "cubics": least_cubics}
        return least[form](self.path, tolerance)


def all_flanks(beginnings: tuple[str, ...]) -> list[tuple[Design, Flank]]:
    """The flanks in use of `CAMS`."""
    found = []
    for name in CAMS:
        design = Design(load_scene(SCENES / f"{name}.toml"))
        for side, curve in design.cam.disc.flanks:
            title = f"{name} {side}"
            path = design.cam.disc.outline(side).path
            if not title.startswith(beginnings) or not path.is_whole:
                continue
            pieces = smooth_pieces(curve)
            phi = np.linspace(0.0, TURN, 20_001)
            length = float(np.sum(np.abs(np.diff(curve.point(phi)))))
            found.append((design, Flank(title, path, curve, pieces, Ruler(curve, pieces), length)))
    return found


# -- camgeo --------------------------------------------------------------------------------------


def own_shape(contour: Contour | SplineContour) -> Shape:
    """A contour of camgeo in the form of those of the peers."""
    if isinstance(contour, SplineContour):
        return joined(
            [
                bspline(strand.knots, strand.controls)
                if isinstance(strand, CubicSpline)
                else arcs(
                    np.array([strand.start]),
                    np.array([strand.end]),
                    np.array([strand.sweep]),
                    np.array([strand.centre]),
                )
                for strand in contour.strands
            ]
        )
    if not np.any(contour.sweeps):
        return chords(np.append(contour.vertices, contour.vertices[0]))
    return arcs(contour.vertices, contour.ends, contour.sweeps, contour.centres)


def seconds_of(work: Callable[[], object], rounds: int) -> float:
    """Shortest time of `work` [s] in at most `rounds` runs."""
    least, spent = math.inf, 0.0
    for _ in range(rounds):
        began = time.perf_counter()
        work()
        took = time.perf_counter() - began
        least, spent = min(least, took), spent + took
        if spent > ENOUGH:
            break
    return least


def print_times(design: Design, flank: Flank, forms: Sequence[Form], rounds: int) -> bool:
    """Table of the fits as multiples of the curve; True if the targets are reached."""
    pitch, curve = design.cam.disc.pitch_curve, flank.curve

    starts = itertools.count(0.0, 1e-9)  # each once

    def evaluate(count: int) -> None:
        pitch.jet(next(starts) + np.linspace(0.0, TURN, count, endpoint=False))

    def evaluate_all(count: int) -> None:
        phi = next(starts) + np.linspace(0.0, TURN, count, endpoint=False)
        pitch.jet(phi)
        curve.point(phi)
        curve.curvature(phi)

    works: dict[str, Callable[[], Any]] = {}
    for count in EVALUATIONS.values():
        works[f"{count}"] = functools.partial(evaluate, count)
        works[f"{count} all"] = functools.partial(evaluate_all, count)
    rows = []
    for tolerance in TIMED:
        for form in forms:
            for effort in EVALUATIONS:
                name = f"{tolerance:g} {form} {effort}"
                works[name] = functools.partial(FITS[form, effort], flank.path, tolerance)
                rows.append((name, tolerance, form, effort))
    results: dict[str, Any] = {}
    times: dict[str, list[float]] = {name: [] for name in works}
    for turn in range(rounds + 1):  # the first run warms up
        for name, work in works.items():
            began = time.perf_counter()
            results[name] = work()
            if turn:
                times[name].append(time.perf_counter() - began)
    middle = {name: statistics.median(each) for name, each in times.items()}

    print(f"\n{flank.name}: fit and proof, medians of {rounds} turns")
    for count in EVALUATIONS.values():
        print(
            f"{count:,} points of the flank with its derivatives:"
            f" {1e3 * middle[f'{count} all']:.1f} ms, of these the pitch curve's alone"
            f" {1e3 * middle[f'{count}']:.1f} ms"
        )
    few, many = EVALUATIONS.values()
    print(
        f"{'tolerance':>9} {'form':<8}{'effort':<8}{'pieces':>8}{'over limit':>11}{'proved':>8}"
        f"{'time [ms]':>11}{f'in {few:,}':>11}{f'in {many:,}':>12}"
    )
    reached = []
    for name, tolerance, form, effort in rows:
        fit = results[name]
        forced = 0 if form == "chords" else forced_pieces(flank.path)
        ratio = (len(fit.contour) - forced) / flank.least(form, tolerance)
        share = middle[name] / middle[f"{EVALUATIONS[effort]} all"]
        message_ = ""
        if tolerance == 1e-3:
            reached.append(share <= 1.0)
            message_ = "" if share <= 1.0 else "  MISSED"
        print(
            f"{tolerance:>9g} {form:<8}{effort:<8}{len(fit.contour):>8}{ratio:>11.3f}"
            f"{fit.deviation / tolerance:>8.3f}{1e3 * middle[name]:>11.1f}"
            f"{middle[name] / middle[f'{few} all']:>11.2f}"
            f"{middle[name] / middle[f'{many} all']:>12.2f}{message_}"
        )
    return all(reached)


# -- comparison ----------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class Row:
    """One line of a table: measured deviation [mm], times [s]."""

    name: str
    joints: str
    pieces: int
    off: float
    gap: float
    points: float
    call: float
    search: float

    @property
    def seconds(self) -> float:
        """Everything that counts as part of the one call."""
        return self.points + self.call


def gap_of(shape: Shape) -> float:
    """Largest distance [mm] from the end of a piece to the start of the next one."""
    every = np.arange(shape.pieces)
    starts, ends = (shape.at(every, np.full(shape.pieces, share)) for share in (0.0, 1.0))
    return float(np.max(np.abs(np.roll(starts, -1) - ends)))


def own_row(flank: Flank, form: Form, effort: str, tolerance: float, rounds: int) -> Row:
    """camgeo's line; its measured deviation must not exceed the proved one."""
    fit = FITS[form, effort]
    result = fit(flank.path, tolerance)
    shape = own_shape(result.contour)
    off = max(flank.ruler.there(shape), flank.ruler.back(shape, tolerance))
    if off > result.deviation + BLUR * tolerance:
        raise SystemExit(f"{flank.name}, {form}: {off:g} mm measured, {result.deviation:g} proved")
    if shape.pieces != len(result.contour):
        raise SystemExit(f"{flank.name}, {form}: pieces are not counted alike")
    call = seconds_of(lambda: fit(flank.path, tolerance), rounds)
    joints = {"chords": "C0", "arcs": "G1", "cubics": "C2"}[form]
    return Row(f"camgeo {effort}", joints, shape.pieces, off, gap_of(shape), 0.0, call, call)


def peer_row(
    flank: Flank, peer: Peer, tolerance: float, rounds: int, patience: float
) -> tuple[Row | None, str]:
    """The peer's line with the fewest pieces, the closed curve or piece by piece; or why none."""
    rows, why = [], "comes not near enough"
    start = flank.pieces[0].start
    whole = (SmoothPiece(start, start + TURN),)
    ways = [("closed", whole)] + ([("by pieces", flank.pieces)] if len(flank.pieces) > 1 else [])
    for way, pieces in ways:
        row = row_of(flank, peer, pieces, way, tolerance, rounds, patience)
        if isinstance(row, Row):
            rows.append(row)
        else:
            why = row
    if not rows:
        return None, why
    return min(rows, key=lambda row: (row.pieces, row.seconds)), ""


def row_of(
    flank: Flank,
    peer: Peer,
    pieces: Sequence[SmoothPiece],
    way: str,
    tolerance: float,
    rounds: int,
    patience: float,
) -> Row | str:
    """One way of calling a peer."""
    count = flank.density(peer.form, tolerance) // peer.thin
    whole = True
    shapes: list[Shape] = []
    points = call = search = off = 0.0
    for piece in pieces:
        if piece.dwell and peer.form != "chords":
            shapes.append(_rest(flank.curve, piece))
            continue
        sample = flank.sample(piece, count, closed=way == "closed")
        given = peer.prepare(sample)
        guess = math.ceil(flank.least(peer.form, tolerance) * flank.part(piece) / flank.length)
        found = fewest(peer, given, flank.ruler.there, tolerance, guess, patience)
        if found is None:
            return "comes not near enough"
        whole = whole and found.whole
        shapes.append(found.shape)
        evaluate = functools.partial(flank.curve.point, flank.angles(piece, count))
        points += seconds_of(evaluate, rounds)
        call += seconds_of(functools.partial(peer.fit, given, found.parameter), rounds)
        off = max(off, found.off)
        search += found.spent
    shape = joined(shapes)
    off = max(off, flank.ruler.back(shape, tolerance))
    way = way if whole else f"{way}, search cut short"
    gap = gap_of(shape)
    name = f"{peer.name}, {way}"
    return Row(name, peer.joints, shape.pieces, off, gap, points, call, points + search)


def _rest(curve: WorkingCurve, piece: SmoothPiece) -> Shape:
    """A dwell as an arc."""
    ends = np.array([piece.start, piece.end])
    points = curve.point(ends)
    sweep = -curve.pitch.rotation * (piece.end - piece.start)
    return arcs(points[:1], points[1:], np.array([sweep]), np.zeros(1, dtype=np.complex128))


def compare(
    flank: Flank, form: Form, tolerance: float, peers: Sequence[Peer], rounds: int, patience: float
) -> bool:
    """Print one table; True if the target is reached."""
    own = [own_row(flank, form, effort, tolerance, rounds) for effort in ("fewest", "fast")]
    others: list[Row] = []
    left: list[str] = []
    for peer in peers:
        if peer.form == form:
            row, why = peer_row(flank, peer, tolerance, rounds, patience)
            if row is None:
                left.append(f"{peer.name}: {why}")
            else:
                others.append(row)
    forced = 0 if form == "chords" else forced_pieces(flank.path)
    least = flank.least(form, tolerance)
    print(
        f"\n{flank.name}, {form} within {tolerance:g} mm: the limit is {least:.1f}"
        + (f" and {forced} for dwells" if forced else "")
        + f"; peers get {flank.density(form, tolerance)} points"
    )
    print(
        f"{'':<40}{'joints':>7}{'pieces':>8}{'over limit':>11}{'off/tol':>9}{'gap/tol':>9}"
        f"{'points':>8}{'call':>8}{'sum [ms]':>10}{'search':>9}"
    )
    for row in [*own, *sorted(others, key=lambda row: row.pieces)]:
        print(
            f"{row.name:<40}{row.joints:>7}{row.pieces:>8}{(row.pieces - forced) / least:>11.2f}"
            f"{row.off / tolerance:>9.3f}{row.gap / tolerance:>9.3f}{1e3 * row.points:>8.1f}"
            f"{1e3 * row.call:>8.1f}{1e3 * row.seconds:>10.1f}{1e3 * row.search:>9.1f}"
        )
    for line in left:
        print(f"left out: {line}")
    if not others:
        print("no peer to compare with")
        return True
    return verdict(own, others, tolerance)


def verdict(own: Sequence[Row], others: Sequence[Row], tolerance: float) -> bool:
    """Print who has fewer pieces and who is faster."""
    reached = False
    for row in own:
        fewer = [other for other in others if other.pieces <= row.pieces]
        faster = [other for other in others if other.seconds <= row.seconds]
        found = [other for other in faster if other.search <= row.seconds]
        message_ = [
            f"{other.name} ({other.joints}{', with gaps' if other.gap > GAP * tolerance else ''})"
            for other in fewer
        ]
        print(f"{row.name}: fewer: {'no, ' + '; '.join(message_) if message_ else 'yes'}")
        for kind, quicker in (("one call", faster), ("its search", found)):
            names = "; ".join(other.name for other in quicker)
            print(f"    faster than {kind}: {'no, ' + names if names else 'yes'}")
        reached = reached or not (fewer or faster)
    return reached


def numbers(text: str) -> list[float]:
    """Numbers with commas between them, descending."""
    return sorted((float(part) for part in text.split(",")), reverse=True)


def main() -> int:
    """Measure and print; exit with 1 if a target is missed."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--tolerances", type=numbers, default=[1e-2, 1e-3, 1e-4])
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--patience", type=float, default=0.5, help="seconds a search may take")
    parser.add_argument("--cams", default=CAMS[0], help=f"of {', '.join(CAMS)}")
    parser.add_argument("--forms", default=",".join(FORMS))
    arguments = parser.parse_args()
    print(
        f"Python {platform.python_version()}, {platform.machine()}; "
        + ", ".join(f"{name} {version(name)}" for name in ("numpy", "scipy", "shapely"))
    )
    forms = [form for form in FORMS if form in arguments.forms.split(",")]
    flanks = all_flanks(tuple(arguments.cams.split(",")))
    reached = [print_times(*flanks[0], forms, arguments.rounds)]
    peers = find_peers()
    for _, flank in flanks:
        for form in forms:
            for tolerance in arguments.tolerances:
                reached.append(
                    compare(flank, form, tolerance, peers, arguments.rounds, arguments.patience)
                )
    return 0 if all(reached) else 1


if __name__ == "__main__":
    raise SystemExit(main())
