"""The contours of a design over the tolerance: pieces, proof, files, times."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import replace
from functools import partial
from typing import Final

from camgeo.accuracy.clock import MOST_RUNS, Clock, repeated
from camgeo.accuracy.rows import EFFORTS, FORMS, ContourRow, Count, FileCost
from camgeo.contour.contour import Contour, Effort, Fit, Form
from camgeo.contour.least_pieces import forced_pieces, least_arcs, least_chords, least_cubics
from camgeo.contour.spline import SplineFit
from camgeo.design import Design
from camgeo.errors import EffectError, FileError, GeometryError, SceneError, ToleranceError
from camgeo.formats import gcode
from camgeo.outline.path import Flank, Path
from camgeo.outline.replay import replay_contour
from camgeo.part.boundaries import CurveBoundary, ExactBoundary
from camgeo.part.boundary import written_contour
from camgeo.product.drawn import TOPOLOGY_TOLERANCE
from camgeo.product.product import Product
from camgeo.toolpath.cut import ContourCut
from camgeo.toolpath.machine import Machine, load
from camgeo.toolpath.machining_time import contour_time
from camgeo.writing.writer import Written, find_writer, pieces_of

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


def flanks_of(design: Design) -> tuple[CurveBoundary, ...]:
    """The boundaries of the part that are flanks; bore and rim are exact at any tolerance."""
    return tuple(
        each for each in design.disc.drawn.part.boundaries if isinstance(each, CurveBoundary)
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

    A row states what cannot be reached. The first use of what all rows use is in none of them.

    Parameters
    ----------
    ripple : whether the contours are also replayed.
    progress : called with the name of each row.
    programs : whether those of arcs are written too, if the scene asks for milling.
    timed : whether seconds of computing matter; else everything is done once.
    """
    runs = MOST_RUNS if timed else 1
    rows = []
    for form in forms:
        for effort in efforts:
            drawn = drawn_as(design, form, effort)
            with suppress(*NOT_WRITTEN):  # which the row will state
                file_cost(drawn.disc, DRAWING, max(tolerances), runs=1)
            for tolerance in tolerances:
                progress(f"{form}, {effort}, {tolerance:g} mm")
                rows.append(
                    _row(
                        drawn, ContourRow(form, effort, tolerance), ripple=ripple,
                        programs=programs, runs=runs,
                    )
                )  # fmt: skip
    return tuple(rows)


def drawn_as(design: Design, form: Form, effort: Effort) -> Design:
    """The same design with its drawing in another form."""
    return design.with_output({"fit": effort, "dxf.entity": form})


def _row(design: Design, row: ContourRow, *, ripple: bool, programs: bool, runs: int) -> ContourRow:
    """The row with all values that exist."""
    form, effort, tolerance = row.form, row.effort, row.tolerance
    # Machine of the scene, or the default; without a tool there is no feed, and no time.
    spec = design.disc.options[gcode.FORMAT]
    machine = load(spec.machine)
    flanks, milled = flanks_of(design), not gcode.FORMAT.lacking(design.disc.values)

    def fitted_and_proved(clock: Clock) -> list[Fit | SplineFit]:
        forget(design.disc, tolerance)
        fits = clock.step(
            "fit", lambda: [written_contour(each, form, effort, tolerance) for each in flanks]
        )
        for flank, fit in zip(flanks, fits, strict=True):
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
    """Time [s] of one round along all `contours`; None without any, or without dynamics."""
    if not contours or machine.dynamics is None:
        return None
    smoothing, chord = machine.smoothed(tolerance), machine.arcs.interpolation
    return math.fsum(
        contour_time(each, feed, machine.dynamics, chord=chord, smoothing=smoothing)
        for each in contours
    )


def file_cost(
    product: Product,
    format: str,  # noqa: A002 - its name
    tolerance: float,
    fit_seconds: float | None = None,
    runs: int = MOST_RUNS,
) -> FileCost:
    """The file of one format, or all of its files, written and read back; facts of the first.

    `fit_seconds` are those of fits that are known, and counted for writing; it is done `runs` times
    at most.

    Raises
    ------
    ToleranceError
        If its tolerance cannot be reached.
    """
    writer = find_writer(format)
    pieces = pieces_of(writer, product)

    def written_and_read(clock: Clock) -> tuple[list[Written], list[float | None]]:
        for piece in pieces:
            forget(piece, tolerance, fits=fit_seconds is None, plans=format == PROGRAM)
        written = clock.step("write", lambda: [writer.write(each, tolerance) for each in pieces])
        for piece in pieces:
            forget(piece, tolerance, fits=False)
        read = zip(pieces, written, strict=True)
        return written, clock.step("read", lambda: [writer.measure(a, b.data) for a, b in read])

    (written, found), timing = repeated(written_and_read, runs)
    deviation = max((each for each in found if each is not None), default=None)
    if deviation is not None and not deviation <= tolerance:
        raise ToleranceError(f"the {format} file, read back, is off", tolerance, deviation)
    size = sum(len(each.data) for each in written)
    seconds = ((fit_seconds or 0.0) + timing.seconds["write"], timing.seconds["read"])
    return FileCost(size, deviation, *seconds, written[0].facts, timing.spread)


def forget(product: Product, tolerance: float, *, fits: bool = True, plans: bool = False) -> None:
    """Make what was computed for a file be computed again: proofs, and if asked for fits and plans.

    Fits looser than `tolerance` [mm] are kept, and those by which contours are told apart, which
    are the same for all files.
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
                each
                for each in known
                if isinstance(each, bytes)
                or (fits and each[1] <= tolerance and each[1] != TOPOLOGY_TOLERANCE)
            ]:
                del known[key]


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
    found = (
        replay_contour(
            design.cam.disc.pitch_curve, contour, Flank.OUTER if flank.hole else Flank.INNER
        ).ripple
        for flank, contour in zip(flanks, contours, strict=True)
    )
    return max((ripple for ripple in found if ripple is not None), default=None)
