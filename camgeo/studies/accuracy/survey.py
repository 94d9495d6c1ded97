"""Measures one design: contours, solids, value tables, effects, and whole builds."""

from __future__ import annotations

import math
import tempfile
import time
from collections.abc import Iterable, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from decimal import Decimal
from functools import partial
from typing import Any, Final, Literal, cast

import numpy as np

from camgeo.design.design import Design
from camgeo.design.value_table import cam_angles
from camgeo.design.writing import Report
from camgeo.dynamics.effects.effect import Bound, Column, Result
from camgeo.errors import EffectError, GeometryError, ToleranceError
from camgeo.geometry.contour.contour import Effort, Form
from camgeo.kinematics.motion import Motion
from camgeo.lazy import Computation
from camgeo.numeric.arrays import SHARE, FloatArray, ascending
from camgeo.part.boundaries import CurveBoundary
from camgeo.part.part import written_contour
from camgeo.scene.formats.dxf import FORMAT
from camgeo.scene.scene import Scene
from camgeo.studies.accuracy.benefit import BenefitRow, Knee, find_knee
from camgeo.studies.accuracy.contours import (
    EFFORTS,
    FORMS,
    NOT_WRITTEN,
    Clock,
    ContourRow,
    EffectRow,
    Progress,
    SolidRow,
    TableRow,
    contour_rows,
    file_cost,
    in_length,
    reason,
    repeated,
)
from camgeo.units import MM_PER, TURN, LengthUnit

# -- effects --------------------------------------------------------------------------------------
# The numerical effects of a design over their tolerance: computing time and error.
#
# Every figure, that is the value of each finding and each column over a revolution, is compared
# with that of a computation whose tolerance is smaller by a factor of at least `TIGHTER`. The error
# that a result states holds if no figure deviates by more.


TOLERANCES_OF_EFFECTS: Final = (1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10)
"""Tolerances at which effects are measured, see `camgeo.dynamics.effects.effect.Bound`."""

TIGHTER: Final = 100.0
"""Factor from the tolerance of the reference to those of the rows compared with it."""

ROUNDED: Final = 1e-11
"""Relative errors up to this are rounding errors, which no tolerance changes: some thousand
roundings, as many as motion, mechanism, forces and a sum over the revolution have."""

ANGLES: Final = 720
"""Number of cam angles over a revolution at which columns are compared."""

OFFSET: Final = 0.381966
"""Offset of the first of these angles from 0, as a fraction of their spacing. With the golden
section the ends of motions, where a quantity may jump, are hardly ever among these angles."""

Figures = dict[str, FloatArray]
"""The values of findings, in order, and of columns over the turn, by name."""


@dataclass(frozen=True, slots=True)
class FigureDifference:
    """How far a figure deviates from that of the reference.

    Attributes
    ----------
    figure : name of the finding or column.
    difference : from the reference, in the unit of the figure.
    bound : the error that the result states.
    """

    figure: str
    difference: float
    bound: Bound

    @property
    def share(self) -> float:
        """The difference relative to the scale of the figure."""
        return Bound(self.difference, self.bound.scale).share

    @property
    def holds(self) -> bool:
        """Whether the figure deviates by no more than stated."""
        return self.difference <= self.bound.error


def effect_rows(
    design: Design, tolerances: Sequence[float] = TOLERANCES_OF_EFFECTS, *, progress: Progress
) -> tuple[EffectRow, ...]:
    """Rows of the numerical effects that the scene names.

    Each effect has a row for each of `tolerances`, the loosest first; a row states why it has no
    answer. An effect whose error is rounding at the loosest tolerance has this row alone, see
    `EffectRow.rounded`.
    """
    rows: list[EffectRow] = []
    for name in design.scene.effects:
        if design.effects.effect(name).numerical:
            rows += _rows(design, name, sorted(tolerances, reverse=True), progress)
    return tuple(rows)


def _rows(
    design: Design, name: str, tolerances: Sequence[float], progress: Progress
) -> list[EffectRow]:
    """The rows of one effect, the loosest first."""
    reference = _reference(design, name, tolerances, progress)
    rows: list[EffectRow] = []
    for tolerance in tolerances:
        progress(f"{name}, {tolerance:g}")
        row, result = _row(design, name, tolerance)
        if result is not None and reference is not None and reference[0] * TIGHTER <= tolerance:
            row = _with_difference(row, result, reference[1])
        if row.rounded and not rows:
            return [row]
        rows.append(replace(row, rounded=False))
    return rows


def _reference(
    design: Design, name: str, tolerances: Sequence[float], progress: Progress
) -> tuple[float, Result] | None:
    """The most accurate result, with its tolerance; None if there is no answer.

    Its tolerance is the tightest of `tolerances` divided by `TIGHTER`, or the next one that can be
    reached. Computing it first keeps what does not depend on the tolerance out of the times of the
    rows.
    """
    tightest = tolerances[-1]
    for tolerance in (tightest / TIGHTER, tightest, *reversed(tolerances[:-1])):
        progress(f"{name}, reference to {tolerance:g}")
        try:
            return tolerance, _result(design, name, tolerance)
        except (EffectError, GeometryError, ToleranceError):  # which a row will state
            continue
    return None


def _result(design: Design, name: str, tolerance: float) -> Result:
    """The effect recomputed; the effects that it depends on are computed only once."""
    result: Result = design.effects.recomputed(name, tolerance).result(name)
    return result


def _row(design: Design, name: str, tolerance: float) -> tuple[EffectRow, Result | None]:
    """A row without its difference, and the result."""
    row = EffectRow(name, tolerance)
    try:
        result, timing = repeated(
            lambda clock: clock.step(name, lambda: _result(design, name, tolerance))
        )
    except (EffectError, GeometryError, ToleranceError) as error:
        return replace(row, fault=reason(error)), None
    return replace(
        row, seconds=timing.seconds[name], error=result.error, spread=timing.spread
    ), result


def _with_difference(row: EffectRow, result: Result, reference: Result) -> EffectRow:
    """The row with its difference; a figure that deviates by more than stated is a fault."""
    differences = compare_figures(result, reference)
    wrong = [difference.figure for difference in differences if not difference.holds]
    largest = max(differences, key=lambda each: each.share, default=None)
    share = None if largest is None else largest.share
    return replace(
        row,
        difference=share,
        figure="" if largest is None or not share else largest.figure,
        rounded=max(share or 0.0, row.error or 0.0) <= ROUNDED and not wrong,
        fault=f"off by more than estimated: {', '.join(wrong)}" if wrong else "",
    )


def compare_figures(result: Result, reference: Result) -> tuple[FigureDifference, ...]:
    """The differences of all figures that both results have.

    A figure for which the result states no error is exact except for rounding, which is
    `camgeo.numeric.arrays.SHARE` of its largest magnitude.
    """
    figures, reference_figures = result_figures(result), result_figures(reference)
    differences = []
    for name, values in figures.items():
        if name not in reference_figures or reference_figures[name].shape != values.shape:
            continue
        size = float(max(np.max(np.abs(values)), np.max(np.abs(reference_figures[name]))))
        bound = result.errors.get(name, Bound(SHARE * size, size))
        differences.append(
            FigureDifference(name, float(np.max(np.abs(values - reference_figures[name]))), bound)
        )
    return tuple(differences)


def result_figures(result: Result) -> Figures:
    """The figures of a result by name: values of findings, and columns over the revolution."""
    finding_values: dict[str, list[float]] = {}
    for finding in result.findings:
        if finding.value is not None:
            finding_values.setdefault(finding.name, []).append(finding.value)
    figures = {name: np.array(values, dtype=np.float64) for name, values in finding_values.items()}
    return figures | {column.name: _sampled(column) for column in result.columns}


def _sampled(column: Column) -> FloatArray:
    phi: FloatArray = (np.arange(ANGLES, dtype=np.float64) + OFFSET) * (TURN / ANGLES)
    return column.values(phi, "right")


# -- tables ---------------------------------------------------------------------------------------
# The value table of a design over its step: rows, bytes, and the error of interpolation.
#
# Between two rows with the step h, a lift s with a continuous velocity deviates from its chord by
# at most max|s''| h^2/8. A jump j of the velocity at the distance x after a row adds j x (h - x)/h.


STEPS: Final = tuple(
    Decimal(text) for text in ("10", "5", "2", "1", "0.5", "0.2", "0.1", "0.05", "0.02", "0.01")
)
"""Steps of the cam angle that are measured [degrees]."""

CELL: Final = np.radians(0.05)
"""Largest cell [rad] over which |s''| is bounded. The bound exceeds the largest value in the cell
by the change of s'' over half of it: some thousandths of the peak of a law of 40 degrees."""


def table_rows(
    design: Design, steps: Sequence[Decimal], *, progress: Progress
) -> tuple[TableRow, ...]:
    """One row per step [degrees]; the lift is that of the motion plan.

    Effects with columns in the table are computed beforehand, as no step changes them.
    """
    if steps:
        design.tabulated.table(max(steps))
    rows = []
    for step in steps:
        progress(f"value table, {step} degrees")

        def compute_table(step: Decimal = step) -> tuple[int, int]:
            table = design.tabulated.table(step)
            return len(table.values), len(table.encoded())

        (count, size), timing = repeated(partial(Clock.step, name="table", work=compute_table))
        error = interpolation_error(design.scene.plan, np.radians(cam_angles(step)))
        rows.append(TableRow(step, count, size, timing.seconds["table"], error, timing.spread))
    return tuple(rows)


def interpolation_error(motion: Motion, phi: FloatArray) -> float:
    """Bound [mm or rad] of |s - chord| over a turn, chords between the rows `phi`.

    Parameters
    ----------
    motion : whose lift is interpolated.
    phi : (n,) [rad] ascending in [0, 2 pi), the first 0; the last chord ends at 2 pi.
    """
    rows = np.append(phi, TURN)
    # Cells of equal number in each chord, narrow enough for the bounds to be sharp, and cut at the
    # borders of the motion, where s'' may jump.
    parts = max(1, int(np.ceil(np.max(np.diff(rows)) / CELL)))
    shares = np.arange(parts) / parts
    cuts = (rows[:-1, None] + np.diff(rows)[:, None] * shares).ravel()
    borders = motion.borders[(motion.borders > 0.0) & (motion.borders < TURN)]
    cuts = ascending(np.concatenate((cuts, borders, [TURN])))
    low, high = cuts[:-1], cuts[1:]
    _, bounds = motion.jet_and_bounds(low, high)
    # Each cell lies in one chord, as the rows are among the cuts.
    chord = np.clip(np.searchsorted(rows, 0.5 * (low + high), side="right") - 1, 0, len(phi) - 1)
    largest = np.zeros(len(phi))
    np.maximum.at(largest, chord, bounds[2])  # unbuffered: many cells belong to one chord
    steps = np.diff(rows)
    errors = largest * steps**2 / 8.0
    kinks = motion.breaks[(motion.breaks > 0.0) & (motion.breaks < TURN)]
    # The deviations by curvature and by jumps add up in the worst case.
    if len(kinks):
        jumps = np.abs(motion.jet(kinks, "right", 1)[1] - motion.jet(kinks, "left", 1)[1])
        place = np.clip(np.searchsorted(rows, kinks, side="right") - 1, 0, len(phi) - 1)
        behind = kinks - rows[place]
        np.add.at(errors, place, jumps * behind * (steps[place] - behind) / steps[place])
    return float(np.max(errors))


# -- survey ---------------------------------------------------------------------------------------


TOLERANCES: Final = (1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6)
"""Default tolerances [mm]. Another decade would multiply the number of straight pieces and
triangles by 3.16, and with it the time of the survey: two thirds of that would go into files of
some 7 MB."""

SOLIDS: Final = ("stl", "3mf", "step")
"""Names of the writers of solids."""


@dataclass(frozen=True, slots=True)
class Survey:
    """The cost of accuracy.

    Attributes
    ----------
    contours, solids, tables : the measured rows.
    knee : the contour beyond which more cost gains nothing; None if no tolerance can be reached.
    effects : rows of the numerical effects that the scene names and that a tolerance changes.
    rounded : one row for each of the others, whose error is rounding at any tolerance.
    bill : rows of whole builds; empty if they were not requested.
    """

    contours: tuple[ContourRow, ...]
    solids: tuple[SolidRow, ...]
    tables: tuple[TableRow, ...]
    knee: Knee | None
    effects: tuple[EffectRow, ...] = ()
    rounded: tuple[EffectRow, ...] = ()
    bill: tuple[BillRow, ...] = ()

    def in_length(self, length: LengthUnit) -> Survey:
        """The same with tolerances and deviations of contours, solids and builds in a unit of
        length; the knee stays in mm.
        """
        mm = MM_PER[length]
        return replace(
            self,
            contours=tuple(in_length(row, mm) for row in self.contours),
            solids=tuple(in_length(row, mm) for row in self.solids),
            bill=tuple(in_length(row, mm) for row in self.bill),
        )


def survey(
    design: Design,
    tolerances: Sequence[float] = TOLERANCES,
    steps: Sequence[Decimal] = STEPS,
    *,
    ripple: bool = False,
    complete: bool = True,
    bill: bool = False,
    benefits: Sequence[BenefitRow] = (),
    timed: bool = True,
    progress: Progress = lambda _: None,
) -> Survey:
    """Measure `design` at `tolerances` [mm], and its value table at `steps` [degrees].

    Parameters
    ----------
    ripple : whether the contours are also replayed.
    complete : whether not only the contour that the scene asks for is measured, but all forms and
        fits, programs, solids, value tables and effects.
    bill : whether all files are also built.
    benefits : what the contours do at one speed of the cam, if that is known.
    timed : whether computing times matter; else contours are made once, and the knee does not
        depend on times.
    progress : called with the name of each step.

    Raises
    ------
    UndercutError
        If the cam has no outline.
    GeometryError
        If the part is impossible.
    """
    form, effort = scene_contour(design.scene)
    forms, efforts = (FORMS, EFFORTS) if complete else ((form,), (effort,))
    contours = contour_rows(
        design, tolerances, ripple=ripple, progress=progress, forms=forms, efforts=efforts,
        programs=complete, timed=timed,
    )  # fmt: skip
    effects: tuple[EffectRow, ...] = ()
    if complete and design.scene.effects:
        effects = effect_rows(design, progress=progress)
    return Survey(
        contours,
        solid_rows(design, tolerances, progress=progress) if complete else (),
        table_rows(design, steps, progress=progress) if complete else (),
        find_knee(
            scene_rows(design.scene, contours),
            [row for row in benefits if row.form == form],
            timed=timed,
        ),
        tuple(row for row in effects if not row.rounded),
        tuple(row for row in effects if row.rounded),
        bill_rows(design, tolerances, progress=progress) if bill else (),
    )


def scene_contour(scene: Scene) -> tuple[Form, Effort]:
    """Form and effort of the contour that the drawing of a scene has."""
    return scene.output.options[FORMAT].form, scene.output.fit


def scene_rows(scene: Scene, rows: Sequence[ContourRow]) -> tuple[ContourRow, ...]:
    """The `rows` of the contour that the drawing of a scene has."""
    return tuple(row for row in rows if (row.form, row.effort) == scene_contour(scene))


def solid_rows(
    design: Design, tolerances: Sequence[float], *, progress: Progress
) -> tuple[SolidRow, ...]:
    """One row per format and tolerance [mm]; none if the part has no thickness."""
    if not design.disc.drawn.part.thickness:
        return ()
    rows = []
    for name in SOLIDS:
        for tolerance in tolerances:
            progress(f"{name}, {tolerance:g} mm")
            try:
                # The first run loads modules, which must not count for the first row.
                if tolerance == tolerances[0]:
                    file_cost(design.disc, name, tolerance, runs=1)
                rows.append(SolidRow(name, tolerance, file_cost(design.disc, name, tolerance)))
            except NOT_WRITTEN as error:
                rows.append(SolidRow(name, tolerance, fault=reason(error)))
    return tuple(rows)


# -- bill -----------------------------------------------------------------------------------------
# Where the CPU time of a build is spent, measured on the build itself.
#
# A new design is built into a folder of its own, and its ledger states the time of each quantity
# without that of the quantities it depends on. Each quantity belongs to one stage. Time in no
# quantity, that of the certificate and the disk, belongs to writing. So the stages add up to the
# whole time from the loaded scene to the last file.

Stage = Literal["evaluate", "fit", "prove", "write", "read"]

STAGES: Final[tuple[Stage, ...]] = ("evaluate", "fit", "prove", "write", "read")
"""`evaluate` has motion, mechanism, findings, part, effects and tool paths; `fit` the contours with
the proofs that decide their fit; `prove` further proofs, also of what was read back; `write` and
`read` the files."""

FITS: Final = ("arcs of ", "chords of ", "cubics of ", "distances from ")
PROOFS: Final = ("proof of ",)
WRITTEN, READ = " file", " file, measured"
"""By what names of quantities their stage is recognised: how they begin, or what they contain."""


@dataclass(frozen=True, slots=True)
class BillRow:
    """A whole build within one tolerance.

    Attributes
    ----------
    tolerance : [mm].
    evaluate, fit, prove, write, read : seconds of the stages, see `STAGES`; None if nothing was
        built.
    pieces : number of pieces of the flanks of all discs in the drawings.
    size : of all files, including the certificate [bytes].
    machining_seconds : time that the programs estimate; None if none states it.
    fault : why nothing was built; else empty.
    spread : of the seconds, see `camgeo.studies.accuracy.contours.Timing`.
    """

    tolerance: float
    evaluate: float | None = None
    fit: float | None = None
    prove: float | None = None
    write: float | None = None
    read: float | None = None
    pieces: int | None = None
    size: int | None = None
    machining_seconds: float | None = None
    fault: str = ""
    spread: float = 1.0

    @property
    def stages(self) -> dict[Stage, float]:
        """Seconds by stage; empty if nothing was built."""
        seconds_by_stage: dict[Stage, float | None] = {name: getattr(self, name) for name in STAGES}
        return {name: seconds for name, seconds in seconds_by_stage.items() if seconds is not None}

    @property
    def total(self) -> float | None:
        """Seconds from the loaded scene to the last file; None if nothing was built."""
        return math.fsum(self.stages.values()) if self.stages else None


def bill_rows(
    design: Design, tolerances: Sequence[float], *, progress: Progress = lambda _: None
) -> tuple[BillRow, ...]:
    """One row per tolerance [mm]: a build of all formats of the scene within it."""
    rows = []
    progress("build, to load what all builds use")
    with suppress(*NOT_WRITTEN):
        _built(design.scene, max(tolerances), Clock())
    for tolerance in tolerances:
        progress(f"build, {tolerance:g} mm")
        rows.append(_built_row(design.scene, BillRow(tolerance)))
    return tuple(rows)


def _built(scene: Scene, tolerance: float, clock: Clock) -> tuple[Design, Report, int]:
    """A new design after its build, the report, and the size of its files [bytes].

    The time of each stage is added to `clock`.
    """
    design, build = Design(scene), Clock()
    design.ledger.clock = time.process_time
    with tempfile.TemporaryDirectory() as folder:
        report = build.step("build", lambda: design.write(folder, tolerance=tolerance))
        size = sum(path.stat().st_size for path in report.paths)
    clock.seconds.update(staged(design.ledger.runs, build.seconds["build"]))
    return design, report, size


def _built_row(scene: Scene, row: BillRow) -> BillRow:
    try:
        (design, report, size), timing = repeated(partial(_built, scene, row.tolerance))
    except NOT_WRITTEN as error:
        return replace(row, fault=reason(error))
    return replace(
        row,
        **cast("Any", timing.seconds),
        spread=timing.spread,
        pieces=_pieces(design, row.tolerance),
        size=size,
        machining_seconds=_machining(report),
    )


def staged(runs: Iterable[Computation], total: float) -> dict[str, float]:
    """Seconds by stage of a build that took `total` seconds, in which `runs` were computed."""
    seconds_by_stage: dict[str, list[float]] = {stage: [] for stage in STAGES}
    for run in runs:
        seconds_by_stage[quantity_stage(run.name)].append(run.net_seconds)
    spent = {stage: math.fsum(seconds) for stage, seconds in seconds_by_stage.items()}
    spent["write"] += total - math.fsum(spent.values())  # what no quantity accounts for
    return spent


def quantity_stage(name: str) -> Stage:
    """The stage to which the quantity of that name belongs."""
    # The name of a file read back also contains that of a file written, so it is tested first.
    if READ in name:
        return "read"
    if WRITTEN in name:
        return "write"
    if name.startswith(FITS):
        return "fit"
    return "prove" if name.startswith(PROOFS) else "evaluate"


def _pieces(design: Design, tolerance: float) -> int:
    """Number of pieces of the flanks of all discs; fits of written drawings are known already."""
    output = design.scene.output
    form = output.options[FORMAT].form
    return sum(
        len(written_contour(boundary, form, output.fit, tolerance).contour)
        for disc in design.discs
        for boundary in disc.drawn.part.boundaries
        if isinstance(boundary, CurveBoundary)
    )


def _machining(report: Report) -> float | None:
    """Sum of the machining times [s] that the programs state; None if none states it."""
    known = [float(file.facts[MACHINED]) for file in report.files if MACHINED in file.facts]
    return math.fsum(known) if known else None


MACHINED: Final = "machining_time_s"
"""Name of the fact by which a program states its machining time."""
