"""The contours of a design over the tolerance: pieces, proof, files, times."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Final, TypeVar

from camgeo.accuracy.rows import EFFORTS, FORMS, ContourRow, Count, FileCost
from camgeo.contour.contour import Contour, Effort, Form
from camgeo.contour.least_pieces import forced_pieces, least_arcs, least_chords, least_cubics
from camgeo.design import Design
from camgeo.errors import EffectError, FileError, GeometryError, SceneError, ToleranceError
from camgeo.formats import gcode
from camgeo.outline.path import Flank, Path
from camgeo.outline.replay import replay_contour
from camgeo.part.boundaries import CurveBoundary
from camgeo.part.boundary import HALF_TURN, written_contour
from camgeo.product.product import Product
from camgeo.toolpath.machine import Machine, load
from camgeo.toolpath.machining_time import contour_time
from camgeo.writing.writer import find_writer, pieces_of

Progress = Callable[[str], None]

Result = TypeVar("Result")

Least = Callable[[Path, float], float]

LEAST: Final[dict[Form, Least]] = {
    "polyline": least_chords,
    "arcs": least_arcs,
    "spline": least_cubics,
}

RUNS: Final = 3
"""Most runs, of which the fastest counts: other load on a machine only adds time."""

PATIENCE: Final = 0.01
"""Time [s] after which nothing is run again: longer work differs little from run to run, and all
that is long would take several times as long."""

DRAWING: Final = "dxf"
PROGRAM: Final = "gcode"
"""Names of the writers."""


def flanks_of(design: Design) -> tuple[CurveBoundary, ...]:
    """The boundaries of the part that are flanks; bore and rim are exact at any tolerance."""
    return tuple(
        each for each in design.disc.drawn.part.boundaries if isinstance(each, CurveBoundary)
    )


def contour_rows(
    design: Design, tolerances: Sequence[float], *, ripple: bool, progress: Progress
) -> tuple[ContourRow, ...]:
    """One row per form, effort and tolerance [mm], in this order.

    A row states what cannot be reached.
    """
    rows = []
    for form in FORMS:
        for effort in EFFORTS:
            drawn = drawn_as(design, form, effort)
            _warm(drawn, form, effort, max(tolerances))
            for tolerance in tolerances:
                progress(f"{form}, {effort}, {tolerance:g} mm")
                rows.append(_row(drawn, ContourRow(form, effort, tolerance), ripple=ripple))
    return tuple(rows)


def drawn_as(design: Design, form: Form, effort: Effort) -> Design:
    """The same design with its drawing in another form."""
    return design.with_output({"fit": effort, "dxf.entity": form})


def _warm(design: Design, form: Form, effort: Effort, tolerance: float) -> None:
    """Compute what does not depend on a tolerance, so that its time is in no row."""
    for flank in flanks_of(design):
        try:
            written_contour(flank, form, effort, tolerance)
        except (ToleranceError, GeometryError):  # which the row will state
            return


def _row(design: Design, row: ContourRow, *, ripple: bool) -> ContourRow:
    """The row with all values that exist."""
    form, effort, tolerance = row.form, row.effort, row.tolerance
    # Machine of the scene, or the default; without a tool there is no feed, and no time.
    spec = design.disc.options[gcode.FORMAT]
    machine = load(spec.machine)
    flanks = flanks_of(design)
    try:
        fits, seconds = timed(
            lambda: [written_contour(replace(each), form, effort, tolerance) for each in flanks]
        )
        contours = [fit.contour for fit in fits]
        _, proof = timed(
            lambda: [
                replace(flank).deviation(contour)
                for flank, contour in zip(flanks, contours, strict=True)
            ]
        )
        row = replace(
            row,
            count=Count(
                pieces=sum(len(contour) for contour in contours),
                # A polyline has no arcs: its limit also applies to dwells and turns.
                forced=0
                if form == "polyline"
                else sum(forced_pieces(each.path, HALF_TURN) for each in flanks),
                least=sum(LEAST[form](flank.path, tolerance) for flank in flanks),
                deviation=max(fit.deviation for fit in fits),
                fit_seconds=seconds,
                proof_seconds=proof,
            ),
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
        row = replace(row, drawing=file_cost(design.disc, DRAWING, tolerance))
        if form == "arcs" and not gcode.FORMAT.lacking(design.disc.values):
            row = replace(row, program=file_cost(design.disc, PROGRAM, tolerance))
    except (ToleranceError, GeometryError, SceneError) as error:
        return replace(row, fault=reason(error))
    return row


def _round(
    contours: Sequence[Contour], feed: float, machine: Machine, tolerance: float
) -> float | None:
    """Time [s] of one round along all `contours`; None without any, or without dynamics."""
    if not contours or machine.dynamics is None:
        return None
    smoothing, chord = machine.smoothed(tolerance), machine.arcs.interpolation
    return math.fsum(
        contour_time(each, feed, machine.dynamics, chord=chord, smoothing=smoothing)
        for each in contours
    )


def timed(work: Callable[[], Result]) -> tuple[Result, float]:
    """The result of `work`, and its time [s]."""
    start = time.perf_counter()
    result, best, total = work(), float("inf"), 0.0
    for run in range(RUNS):
        if run:
            start = time.perf_counter()
            result = work()
        elapsed = time.perf_counter() - start
        best, total = min(best, elapsed), total + elapsed
        if total > PATIENCE:
            break
    return result, best


def file_cost(product: Product, format: str, tolerance: float) -> FileCost:  # noqa: A002 - its name
    """The file of one format, or all of its files, written and read back; facts of the first.

    Raises ToleranceError if its tolerance cannot be reached.
    """
    writer = find_writer(format)
    pieces = pieces_of(writer, product)
    written, write = timed(
        lambda: [writer.write(without_fits(each, tolerance), tolerance) for each in pieces]
    )
    found, read = timed(
        lambda: [
            writer.measure(without_fits(each, tolerance), file.data)
            for each, file in zip(pieces, written, strict=True)
        ]
    )
    deviation = max((each for each in found if each is not None), default=None)
    if deviation is not None and not deviation <= tolerance:
        raise ToleranceError(f"the {format} file, read back, is off", tolerance, deviation)
    size = sum(len(each.data) for each in written)
    return FileCost(size, deviation, write, read, written[0].facts)


def without_fits(product: Product, tolerance: float) -> Product:
    """The same design without computed fits and proofs, but those looser than `tolerance` [mm]: the
    polygons by which contours are told apart are the same for all files.
    """
    for boundary in product.drawn.part.boundaries:
        if isinstance(boundary, CurveBoundary):
            known = boundary.known
            for key in [key for key in known if isinstance(key, bytes) or key[1] <= tolerance]:
                del known[key]
    return product


def reason(error: ToleranceError | GeometryError | EffectError | SceneError | FileError) -> str:
    """Why a row has no value, in one short sentence."""
    if isinstance(error, FileError):
        return str(error)
    if isinstance(error, SceneError):
        return "; ".join(fault.message for fault in error.faults)
    return error.reason if isinstance(error, ToleranceError) else error.message


def _ripple(
    design: Design, flanks: Sequence[CurveBoundary], contours: Sequence[Contour]
) -> float | None:
    """The largest ripple of all flanks; None where no acceleration is prescribed, or where the
    roller drops off an edge.
    """
    found = []
    for flank, contour in zip(flanks, contours, strict=True):
        side = Flank.OUTER if flank.hole else Flank.INNER
        ripple = replay_contour(design.cam.disc.pitch_curve, contour, side).ripple
        if ripple is not None:
            found.append(ripple)
    return max(found, default=None)
