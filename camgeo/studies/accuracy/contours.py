"""Measures the contours of a design over the tolerance: pieces, proof, files, times."""

from __future__ import annotations

import math
import statistics
import time
from collections import defaultdict
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, fields, is_dataclass, replace
from decimal import Decimal
from functools import partial
from typing import Any, Final, TypeVar

import numpy as np

from camgeo.design.design import Design
from camgeo.design.drawn import TOPOLOGY_TOLERANCE
from camgeo.design.product import Product
from camgeo.design.writing import Written, file_products, find_writer
from camgeo.errors import EffectError, FileError, GeometryError, SceneError, ToleranceError
from camgeo.geometry.contour.arcs import ARC
from camgeo.geometry.contour.contour import Contour, Effort, Fit, Form
from camgeo.geometry.contour.legs import StretchLeg, TurnLeg, path_legs
from camgeo.geometry.contour.spline import SplineFit
from camgeo.geometry.outline.path import Flank, Path
from camgeo.geometry.outline.replay import replay_contour
from camgeo.geometry.pieces import SmoothPiece
from camgeo.geometry.pitch_curve import WorkingCurve
from camgeo.milling.cut import ContourCut
from camgeo.milling.machine import Machine, load
from camgeo.milling.machining_time import contour_time
from camgeo.numeric.arrays import FloatArray
from camgeo.part.boundaries import CurveBoundary, ExactBoundary
from camgeo.part.part import written_contour
from camgeo.scene.formats.gcode import FORMAT
from camgeo.units import TURN

# -- rows -----------------------------------------------------------------------------------------
# The measured rows: one for each form of the contour, each solid, table step and effect.


FORMS: Final[tuple[Form, ...]] = ("polyline", "arcs", "spline")
"""Forms of a contour, named by the entities of a drawing."""

EFFORTS: Final[tuple[Effort, ...]] = ("fewest", "fast")

ORDER: Final[dict[Form, int]] = {"polyline": 2, "arcs": 3, "spline": 4}
"""The number of pieces of a form grows with the power -1/order of the tolerance."""


@dataclass(frozen=True, slots=True)
class Count:
    """The contours of all flanks in use, fitted and proved.

    Attributes
    ----------
    pieces : of all flanks together.
    forced : how many of them are dwells and arcs about a point, which any tolerance needs.
    least : asymptotic limit of the number of the others for small tolerances, see `LEAST`.
    deviation : the largest deviation that is proved [mm].
    fit_seconds, proof_seconds : time of the fits with their own proof, and of the proofs repeated
        from the finished contours alone.
    spread : of both times, see `Timing`.
    """

    pieces: int
    forced: int
    least: float
    deviation: float
    fit_seconds: float
    proof_seconds: float
    spread: float = 1.0

    @property
    def ratio(self) -> float | None:
        """Pieces that are not forced, as a multiple of their limit; None where the limit is 0."""
        return (self.pieces - self.forced) / self.least if self.least > 0.0 else None


@dataclass(frozen=True, slots=True)
class FileCost:
    """A file written and read back.

    Attributes
    ----------
    size : in bytes.
    deviation : proved for the file as read back [mm]; None if the format states none.
    write_seconds, read_seconds : time of writing it, fits included, and of reading it back and
        proving its deviation.
    facts : what its writer reports about it.
    spread : of these times without the fits of a drawing, see `Timing`.
    """

    size: int
    deviation: float | None
    write_seconds: float
    read_seconds: float
    facts: dict[str, int | float | str]
    spread: float = 1.0

    @property
    def seconds(self) -> float:
        """Time of writing the file and reading it back."""
        return self.write_seconds + self.read_seconds


@dataclass(frozen=True, slots=True)
class ContourRow:
    """One form of the contour at one tolerance.

    Attributes
    ----------
    form, effort, tolerance : as requested; the tolerance in mm.
    count : of the contours; None if there are none.
    drawing : the DXF with that entity; None if there is none.
    program : the G-code; only of arcs, if it was requested and the scene states milling.
    round_seconds : estimated time of milling once along the flanks; None for splines, and where the
        machine's acceleration is not known.
    ripple : largest error of the acceleration in a replay, relative to its prescribed peak; None if
        it was not requested, and for splines.
    shortest_seconds : time of the same round at the largest feed that the controller can hold.
    fault : why a value is missing; empty if none is.
    decimals : number of decimals of a program within that tolerance; None without milling.
    """

    form: Form
    effort: Effort
    tolerance: float
    count: Count | None = None
    drawing: FileCost | None = None
    program: FileCost | None = None
    round_seconds: float | None = None
    ripple: float | None = None
    shortest_seconds: float | None = None
    fault: str = ""
    decimals: int | None = None

    @property
    def spread(self) -> float:
        """Spread of the drawing's times: the larger one of its fits and of its file."""
        return max((cost.spread for cost in (self.count, self.drawing) if cost), default=1.0)


@dataclass(frozen=True, slots=True)
class SolidRow:
    """A solid at one tolerance [mm]; `fault` states why there is no `file`."""

    format: str
    tolerance: float
    file: FileCost | None = None
    fault: str = ""


@dataclass(frozen=True, slots=True)
class TableRow:
    """The value table at one step.

    Attributes
    ----------
    step : of the cam angle [degrees].
    rows, size : number of rows of the table, and size of its CSV file in bytes.
    seconds : time of computing it.
    error : bound on the error of the lift interpolated linearly between rows [mm or rad].
    spread : of the time, see `Timing`.
    """

    step: Decimal
    rows: int
    size: int
    seconds: float
    error: float
    spread: float = 1.0


@dataclass(frozen=True, slots=True)
class EffectRow:
    """A numerical effect at one tolerance.

    Attributes
    ----------
    effect : its name.
    tolerance : requested, relative to the scale of each figure, see
        `camgeo.dynamics.effects.effect.Bound`.
    seconds : time of computing it, without the effects that it needs; None if it has no answer.
    error : its own estimate for the worst figure, relative to its scale; None if it is exact.
    difference : largest difference of a figure from the result at a tolerance of at most a
        hundredth, relative to its scale; None where there is no such result.
    fault : why it has no answer, or which figures deviate by more than estimated; else empty.
    figure : name of the finding or column with this difference; empty if it is 0.
    rounded : whether estimate and difference are rounding errors. The effect then has no further
        rows, as no tolerance changes it.
    spread : of the time, see `Timing`.
    """

    effect: str
    tolerance: float
    seconds: float | None = None
    error: float | None = None
    difference: float | None = None
    fault: str = ""
    figure: str = ""
    rounded: bool = False
    spread: float = 1.0


def in_length(row: Any, mm: float, moved: float = 1.0) -> Any:
    """A row in another unit of length, which has `mm` millimetres: its tolerance and deviations.

    Octaves of the acceleration are divided by `moved`, as the output may be an angle.
    """
    values: dict[str, Any] = {}
    for field in fields(row):
        value = getattr(row, field.name)
        if is_dataclass(value):
            values[field.name] = in_length(value, mm, moved)
        elif field.name in ("tolerance", "deviation") and value is not None:
            values[field.name] = value / mm
        elif field.name == "octaves":
            values[field.name] = tuple(octave / moved for octave in value)
    return replace(row, **values)


# -- clock ----------------------------------------------------------------------------------------
# Computing time: CPU time of this process, as the median of several runs, and how far they differ.
#
# Other work on the computer makes a run wait, which does not count as CPU time, and slows it down
# by the resources that they share, the caches above all, which does. So a row is run several times,
# each time with all its steps: their medians belong together.


Result = TypeVar("Result")

RUNS: Final = 3
"""Least number of runs, where all of them take less than `LONG`."""

SHORT_RUNS: Final = 5
"""Least number of runs, where all of them take less than `SHORT`."""

MOST_RUNS: Final = 15
"""Largest number of runs, where they are short and differ."""

ALIKE: Final = 1.15
"""Spread up to which `SHORT_RUNS` are enough."""

SHORT: Final = 0.3
"""CPU time [s] of all runs from which on there are no more than `RUNS`."""

LONG: Final = 1.0
"""CPU time [s] of all runs after which nothing is run again."""


@dataclass(frozen=True, slots=True)
class Timing:
    """The CPU time of some steps.

    Attributes
    ----------
    seconds : the median time of each step, by name.
    spread : ratio of the upper to the lower quartile of all runs, see `repeated`.
    """

    seconds: Mapping[str, float]
    spread: float


class Clock:
    """The CPU time of the steps of one run, by name."""

    def __init__(self) -> None:
        self.seconds: defaultdict[str, float] = defaultdict(float)

    def step(self, name: str, work: Callable[[], Result]) -> Result:
        """Return the result of `work` and add its time to the step `name`."""
        start = time.process_time()
        result = work()
        self.seconds[name] += time.process_time() - start
        return result


def repeated(run: Callable[[Clock], Result], most_runs: int = MOST_RUNS) -> tuple[Result, Timing]:
    """The result of `run`, which does all its work in steps of the clock, and their times.

    `run` is called several times. The medians and the spread, the ratio of the upper quartile to
    the lower one, are those of all runs but the first, which fills the caches of the motion. The
    spread of a single run is 1.
    """
    clocks: list[Clock] = []
    totals: list[float] = []
    while _again(totals, most_runs):
        clocks.append(Clock())
        result = run(clocks[-1])
        totals.append(math.fsum(clocks[-1].seconds.values()))
    counted = [clock.seconds for clock in (clocks[1:] if len(clocks) >= RUNS else clocks)]
    medians = {name: statistics.median(seconds[name] for seconds in counted) for name in counted[0]}
    return result, Timing(medians, _spread(totals))


def _again(totals: Sequence[float], most_runs: int) -> bool:
    """Whether another run is needed after those that took `totals` [s]."""
    count, spent = len(totals), math.fsum(totals)
    if count < min(RUNS, most_runs):
        return spent < LONG
    return count < most_runs and spent < SHORT and (count < SHORT_RUNS or _spread(totals) > ALIKE)


def _spread(totals: Sequence[float]) -> float:
    # The first run fills caches, so it counts only where there are too few others.
    counted = totals[1:] if len(totals) >= RUNS else totals
    if len(counted) < 2 or min(counted) <= 0.0:
        return 1.0
    lower, _, upper = statistics.quantiles(counted, n=4, method="inclusive")
    return upper / lower


# -- least pieces ---------------------------------------------------------------------------------
# Asymptotic counts of the fewest pieces of a contour, in each of the three forms, for small
# tolerances.
#
# For a small tolerance eps the best spline of order k with one free number a piece leaves, on a
# span h, the error C |D| h^k, where D is the k-th derivative that it cannot follow. Spans that
# share the error out evenly number (C/eps)^(1/k) times the integral of |D|^(1/k) ds:
#
# - chords, vertices off the curve on one side as far as their middles on the other: D = kappa,
#   C = 1/16 (the sagitta kappa h^2/8, halved);
# - G1 arcs: D = dkappa/ds, C = sqrt(3)/216 (a C1 quadratic spline leaves B_3(t)/6 of a cubic, and
#   the largest value of B_3 is sqrt(3)/36), hence 0.2002 = C^(1/3);
# - C2 cubics over the arc length: D = kappa'' - kappa^3, the normal part of the fourth derivative
#   of the point, C = 1/768 (B_4(t)/24 less its middle; B_4 swings by 1/16).
#
# B_k are Bernoulli's polynomials, the errors of splines that are free of the ends and equally
# spaced. A finite contour needs a little more: its pieces are whole numbers, and where smooth
# pieces meet, point and tangent are given. A planar cubic could also choose its parameter, which
# the third form does not: over the arc length its order is 4, as for the graph of a function.


CHORD = 1.0 / 16.0
CUBIC = 1.0 / 768.0
"""C of chords and of cubics: the error on a span h is C |D| h^k; that of arcs is `ARC`."""

CELLS = 4096
"""Cells a smooth piece over which is summed. The integrands have cube and fourth roots of zeros, so
the error falls with the power 5/4: some 3e-5 of a piece."""


def least_chords(path: Path, tolerance: float) -> float:
    """Asymptotic number of chords of a polyline within `tolerance` [mm] of `path`, including those
    of dwells and of arcs about a point.
    """
    total = 0.0
    for leg in path_legs(path):
        if isinstance(leg, TurnLeg):
            # The integral of sqrt(kappa) ds over an arc: kappa = 1/r and ds = r times the angle.
            total += math.sqrt(leg.radius) * leg.end
        else:
            total += math.fsum(_chords(leg.curve, piece) for piece in leg.pieces)
    return total * math.sqrt(CHORD / tolerance)


def least_arcs(path: Path, tolerance: float) -> float:
    """Asymptotic number of arcs of a G1 contour within `tolerance` [mm] of `path`, in addition to
    `forced_pieces`.
    """
    total = math.fsum(_arcs(curve, piece) for curve, piece in _curved(path))
    return total * math.cbrt(ARC / tolerance)


def least_cubics(path: Path, tolerance: float) -> float:
    """Asymptotic number of cubics of a spline within `tolerance` [mm] of `path`, in addition to
    `forced_pieces`.
    """
    total = math.fsum(_cubics(curve, piece) for curve, piece in _curved(path))
    return total * math.sqrt(math.sqrt(CUBIC / tolerance))


def forced_pieces(path: Path, widest: float = TURN) -> int:
    """Number of arcs for dwells and for turns about a point of `path`, whatever the tolerance.

    Each of these is one arc, or several of at most `widest` [rad].
    """
    legs = path_legs(path)
    sweeps = [leg.end for leg in legs if isinstance(leg, TurnLeg)]
    stretches = [leg.pieces for leg in legs if isinstance(leg, StretchLeg)]
    sweeps += [piece.end - piece.start for pieces in stretches for piece in pieces if piece.is_arc]
    # As in the split of a contour, where rounding does not make an arc too wide.
    return sum(max(1, math.ceil(sweep / widest - 1e-12)) for sweep in sweeps)


def _curved(path: Path) -> list[tuple[WorkingCurve, SmoothPiece]]:
    """The smooth pieces that are not dwells, each with its curve."""
    stretches = [leg for leg in path_legs(path) if isinstance(leg, StretchLeg)]
    return [(leg.curve, piece) for leg in stretches for piece in leg.pieces if not piece.is_arc]


def _middles(piece: SmoothPiece) -> tuple[FloatArray, float]:
    """(CELLS,) middles of equal cells of a piece [rad], and the width of a cell [rad]."""
    borders = np.linspace(piece.start, piece.end, CELLS + 1)
    return 0.5 * (borders[:-1] + borders[1:]), (piece.end - piece.start) / CELLS


def _speed(curve: WorkingCurve, phi: FloatArray) -> FloatArray:
    """(n,) |Z'| of the pitch curve [mm/rad]."""
    return curve.pitch.speed(curve.pitch.relative_jet(phi, order=1))


def _chords(curve: WorkingCurve, piece: SmoothPiece) -> float:
    """Integral of sqrt(|kappa_d|) ds = sqrt(|kappa| (1 + d kappa)) |Z'| dphi, finite at a cusp."""
    phi, width = _middles(piece)
    kappa = curve.pitch.curvature(phi)
    regular = np.maximum(1.0 + curve.distance * kappa, 0.0)
    return width * float(np.sum(np.sqrt(np.abs(kappa) * regular) * _speed(curve, phi)))


def _arcs(curve: WorkingCurve, piece: SmoothPiece) -> float:
    """Integral of |dkappa/ds|^(1/3) ds, which is the same for all parallels."""
    phi, width = _middles(piece)
    speed = _speed(curve, phi)
    return width * float(np.sum(np.cbrt(np.abs(curve.pitch.curvature_slope(phi)) * speed * speed)))


def _cubics(curve: WorkingCurve, piece: SmoothPiece) -> float:
    """Integral of |kappa'' - kappa^3|^(1/4) ds, with the curvature kappa of the parallel itself.

    The mean of kappa'' over a cell is the growth of kappa' over it, divided by its length, so that
    no fourth derivative of the motion is needed.
    """
    phi, width = _middles(piece)
    # One-sided values at both ends, from inside: kappa' may jump between pieces.
    borders = np.concatenate(([phi[0]], 0.5 * (phi[:-1] + phi[1:]), [phi[-1]]))
    growth = np.diff(_bend_slope(curve, borders))
    kappa = curve.pitch.curvature(phi)
    regular = np.maximum(1.0 + curve.distance * kappa, 0.0)
    length = width * _speed(curve, phi) * regular
    length[[0, -1]] *= 0.5  # from the middle of an outermost cell to its inner border
    moves = length > 0.0
    bend = kappa[moves] / regular[moves]
    fourth = np.abs(growth[moves] / length[moves] - bend**3)
    # The outermost half cells are as difficult as their neighbouring halves.
    weight = np.ones(len(phi))
    weight[[0, -1]] = 2.0
    return float(np.sum((weight * length)[moves] * fourth**0.25))


def _bend_slope(curve: WorkingCurve, phi: FloatArray) -> FloatArray:
    """dkappa_d/ds [1/mm^2] of the parallel; 0 at a cusp, where there is none."""
    kappa = curve.pitch.curvature(phi)
    regular = 1.0 + curve.distance * kappa
    slope = curve.pitch.curvature_slope(phi)
    denominator = _speed(curve, phi) * regular**3
    bend_slope: FloatArray = np.zeros_like(slope)
    return np.divide(slope, denominator, out=bend_slope, where=denominator > 0.0)


# -- contours -------------------------------------------------------------------------------------


Progress = Callable[[str], None]

Least = Callable[[Path, float], float]

LEAST: Final[dict[Form, Least]] = {
    "polyline": least_chords,
    "arcs": least_arcs,
    "spline": least_cubics,
}

DRAWING: Final = "dxf"
PROGRAM: Final = "gcode"
"""Names of the writers."""

NOT_WRITTEN: Final = (ToleranceError, GeometryError, SceneError, FileError)
"""Errors that say why there is no contour or no file; a row states them."""


def flank_boundaries(design: Design) -> tuple[CurveBoundary, ...]:
    """The boundaries of the part that are fitted: its flanks. Bore and rim are exact anyway."""
    return tuple(
        boundary
        for boundary in design.disc.drawn.part.boundaries
        if isinstance(boundary, CurveBoundary)
    )


def contour_rows(
    design: Design,
    tolerances: Sequence[float],
    *,
    ripple: bool,
    progress: Progress,
    forms: Sequence[Form] = FORMS,
    efforts: Sequence[Effort] = EFFORTS,
    programs: bool = True,
    timed: bool = True,
) -> tuple[ContourRow, ...]:
    """One row per form, effort and tolerance [mm], in this order.

    A row states what cannot be reached. The time of what all rows share is in none of them.

    Parameters
    ----------
    ripple : whether the contours are also replayed.
    progress : called with the name of each row.
    programs : whether G-code of arcs is written too, if the scene states milling.
    timed : whether computing times matter; else everything is computed once.
    """
    runs = MOST_RUNS if timed else 1
    rows = []
    for form in forms:
        for effort in efforts:
            variant = with_contour_form(design, form, effort)
            with suppress(*NOT_WRITTEN):  # which the row will state
                # Loads modules and fills caches, so that the first row is not slower than others.
                file_cost(variant.disc, DRAWING, max(tolerances), runs=1)
            for tolerance in tolerances:
                progress(f"{form}, {effort}, {tolerance:g} mm")
                rows.append(
                    _row(
                        variant, ContourRow(form, effort, tolerance), ripple=ripple,
                        programs=programs, runs=runs,
                    )
                )  # fmt: skip
    return tuple(rows)


def with_contour_form(design: Design, form: Form, effort: Effort) -> Design:
    """The same design with another form of the contour in its drawing."""
    return design.with_output({"fit": effort, "dxf.entity": form})


def _row(design: Design, row: ContourRow, *, ripple: bool, programs: bool, runs: int) -> ContourRow:
    """The row with all values that can be computed."""
    form, effort, tolerance = row.form, row.effort, row.tolerance
    # The scene's machine, or the default one; without a tool there is no feed, and hence no time.
    spec = design.disc.options[FORMAT]
    machine = load(spec.machine)
    flanks, milled = flank_boundaries(design), not FORMAT.lacking(design.disc.values)

    def fitted_and_proved(clock: Clock) -> list[Fit | SplineFit]:
        forget(design.disc, tolerance)  # so that every run fits and proves anew
        fits = clock.step(
            "fit", lambda: [written_contour(flank, form, effort, tolerance) for flank in flanks]
        )
        for flank, fit in zip(flanks, fits, strict=True):
            # `replace` copies the flank without what it has already proved.
            clock.step("proof", partial(replace(flank).deviation, fit.contour))
        return fits

    try:
        fits, timing = repeated(fitted_and_proved, runs)
        contours = [fit.contour for fit in fits]
        row = replace(
            row,
            count=Count(
                pieces=sum(len(contour) for contour in contours),
                # A polyline has no arcs: its limit also applies to dwells and turns.
                forced=0
                if form == "polyline"
                else sum(forced_pieces(flank.path, math.pi) for flank in flanks),
                least=sum(LEAST[form](flank.path, tolerance) for flank in flanks),
                deviation=max(fit.deviation for fit in fits),
                fit_seconds=timing.seconds["fit"],
                proof_seconds=timing.seconds["proof"],
                spread=timing.spread,
            ),
            decimals=machine.decimals(design.scene.unit, tolerance) if milled else None,
        )
        plain = [contour for contour in contours if isinstance(contour, Contour)]
        if design.scene.milling is not None:
            feed = design.scene.milling.tools[0].feed
            row = replace(
                row,
                round_seconds=_round(plain, feed, machine, tolerance),
                shortest_seconds=_round(plain, math.inf, machine, tolerance),
            )
        if plain and ripple:
            row = replace(row, ripple=_ripple(design, flanks, plain))
        row = replace(
            row,
            drawing=file_cost(design.disc, DRAWING, tolerance, timing.seconds["fit"], runs),
        )
        if programs and form == "arcs" and milled:
            row = replace(row, program=file_cost(design.disc, PROGRAM, tolerance, runs=runs))
    except NOT_WRITTEN as error:
        return replace(row, fault=reason(error))
    return row


def _round(
    contours: Sequence[Contour], feed: float, machine: Machine, tolerance: float
) -> float | None:
    """Time [s] of milling once along all `contours`; None without contours, or if the machine's
    dynamics are not known.
    """
    if not contours or machine.dynamics is None:
        return None
    smoothing, chord = machine.smoothed(tolerance), machine.arcs.interpolation
    return math.fsum(
        contour_time(contour, feed, machine.dynamics, chord=chord, smoothing=smoothing)
        for contour in contours
    )


def file_cost(
    product: Product,
    format: str,  # noqa: A002 - its name
    tolerance: float,
    fit_seconds: float | None = None,
    runs: int = MOST_RUNS,
) -> FileCost:
    """The cost of writing and reading back the file of one format, or all its files.

    The facts are those of the first file. `fit_seconds` is the time of fits that are known already,
    which counts for writing. Everything is done at most `runs` times.

    Raises
    ------
    ToleranceError
        If the tolerance cannot be reached.
    """
    writer = find_writer(format)
    pieces = file_products(writer, product)

    def written_and_read(clock: Clock) -> tuple[list[Written], list[float | None]]:
        for piece in pieces:
            forget(piece, tolerance, fits=fit_seconds is None, plans=format == PROGRAM)
        written = clock.step("write", lambda: [writer.write(piece, tolerance) for piece in pieces])
        for piece in pieces:
            forget(piece, tolerance, fits=False)
        read = zip(pieces, written, strict=True)
        return written, clock.step("read", lambda: [writer.measure(a, b.data) for a, b in read])

    (written, deviations), timing = repeated(written_and_read, runs)
    deviation = max((deviation for deviation in deviations if deviation is not None), default=None)
    if deviation is not None and not deviation <= tolerance:
        raise ToleranceError(f"the {format} file, read back, is off", tolerance, deviation)
    size = sum(len(file.data) for file in written)
    seconds = ((fit_seconds or 0.0) + timing.seconds["write"], timing.seconds["read"])
    return FileCost(size, deviation, *seconds, written[0].facts, timing.spread)


def forget(product: Product, tolerance: float, *, fits: bool = True, plans: bool = False) -> None:
    """Discard what was computed for a file: proofs, and if requested fits and milling plans.

    Fits looser than `tolerance` [mm] are kept, and so are those that only decide how contours lie
    to each other, which are the same for all files.
    """
    boundaries = list(product.drawn.part.boundaries)
    if plans:
        for milled in filter(None, (product.milled, product.milled.whole)):
            milled.kept.clear()
        boundaries += [cut.centre for cut in product.milled.cuts if isinstance(cut, ContourCut)]
    for boundary in boundaries:
        if isinstance(boundary, CurveBoundary | ExactBoundary):
            known = boundary.known
            for key in [
                key
                for key in known
                if isinstance(key, bytes)
                or (fits and key[1] <= tolerance and key[1] != TOPOLOGY_TOLERANCE)
            ]:
                del known[key]


def reason(error: ToleranceError | GeometryError | EffectError | SceneError | FileError) -> str:
    """Why a row has no value, in one short sentence, without keys and places."""
    if isinstance(error, FileError):
        return str(error)
    if isinstance(error, SceneError):
        return "; ".join(fault.message for fault in error.faults)
    return error.reason if isinstance(error, ToleranceError) else error.message


def _ripple(
    design: Design, flanks: Sequence[CurveBoundary], contours: Sequence[Contour]
) -> float | None:
    """The largest ripple of all flanks; None where no acceleration is prescribed, and where the
    roller drops off an edge.
    """
    ripples = (
        replay_contour(
            design.cam.disc.pitch_curve, contour, Flank.OUTER if flank.hole else Flank.INNER
        ).ripple
        for flank, contour in zip(flanks, contours, strict=True)
    )
    return max((ripple for ripple in ripples if ripple is not None), default=None)
