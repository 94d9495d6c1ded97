"""`camgeo accuracy`: what accuracy costs, as table and picture, and where it stops paying."""

from __future__ import annotations

import argparse
import math
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from camgeo.answers.answer import FINE
from camgeo.cli.command import (
    add_json,
    add_scene,
    identity,
    opened,
    print_json,
    tell_main_disc,
)
from camgeo.cli.plot import add_picture, write_picture
from camgeo.cli.progress import clear
from camgeo.design import Design
from camgeo.formats.format import LARGEST_TOLERANCE, SMALLEST_TOLERANCE
from camgeo.units import MM_PER

if TYPE_CHECKING:  # what is measured is imported when it is asked for
    from camgeo.accuracy.rows import ContourRow, EffectRow, FileCost, SolidRow, TableRow
    from camgeo.accuracy.survey import Survey

COLUMNS: Final = """\
pieces: of the flanks' contours; of least: pieces, without those that dwells and turns are, in times
    of the limit for small tolerances
deviation: proved, both ways and for every point
fit, proof, write, read: seconds of computing, on this machine: the fit with its proof, the proof
    anew from the finished contour, the drawing written with all its curves, and read back
round: seconds of milling once along the flanks, by feed and acceleration
ripple: largest error of the acceleration in a replay, of its demanded peak
error: bound of the error of the lift between two rows, interpolated linearly"""
"""What stands in the tables, explained below them."""

EFFECT_COLUMNS: Final = """\
effects: tolerance, estimate and off are shares of the largest magnitude of what an effect gives;
    computed: seconds without the effects that it needs; estimate: its own, of its error; off: its
    difference from the result at the tightest tolerance"""
"""The same of the table of effects."""

CONTOURS: Final = (
    "contour", "effort", "tolerance", "pieces", "of least", "deviation", "DXF", "G-code", "fit",
    "proof", "write", "read", "round",
)  # fmt: skip
SOLIDS: Final = ("solid", "tolerance", "triangles", "deviation", "bytes", "write", "read")
EFFECTS: Final = ("effect", "tolerance", "computed", "estimate", "off")
"""Heads of the columns; lengths in mm, sizes in bytes, times in seconds."""

NONE: Final = "-"
"""What has no value."""


SUMMARY: Final = (
    "measure what accuracy costs: pieces, bytes, computing and machining time over the"
    " tolerance, and say where it stops paying"
)

EXAMPLE: Final = (
    "camgeo accuracy fixtures/scenes/setzhub.toml -o setzhub-accuracy.svg\n"
    "  camgeo accuracy my-cam.toml --tolerances 1e-2,1e-3,1e-4 --ripple\n"
    "  camgeo accuracy my-cam.toml --json"
)


def options(parser: argparse.ArgumentParser) -> None:
    """Add those of the command."""
    add_scene(parser)
    parser.add_argument(
        "--tolerances",
        metavar="MM",
        type=_tolerances,
        help="comma-separated, in mm; default 1e-1 to 1e-7, one a decade",
    )
    parser.add_argument(
        "--ripple",
        action="store_true",
        help="replay the contours too: how far the follower's acceleration is off",
    )
    add_json(parser)
    add_picture(parser)


def run(arguments: argparse.Namespace) -> int:
    """Measure, and print or draw what was found."""
    design = opened(arguments)
    from camgeo.accuracy.survey import TOLERANCES, survey

    tell_main_disc(design, "figures")
    ripple = arguments.ripple or design.scene.output.accuracy_ripple
    tolerances = arguments.tolerances or TOLERANCES
    found = survey(design, tolerances, ripple=ripple, tell=arguments.progress)
    if arguments.output is not None:
        from camgeo.figure import accuracy

        figure = accuracy.figure(found, title=f"{design.name}: what accuracy costs")
        told = "pieces, bytes, seconds"
        write_picture(figure, Path(arguments.output), told, force=arguments.force)
    clear()
    if arguments.json:
        print_json({**identity(design.scene), **_document(design, found)})
    else:
        _print_tables(design, found, ripple=ripple)
    return FINE


def _tolerances(text: str) -> tuple[float, ...]:
    """The tolerances of `--tolerances`, each once, the loosest first."""
    found = set()
    for word in text.split(","):
        try:
            value = float(word)
        except ValueError:
            value = math.nan
        if not SMALLEST_TOLERANCE <= value <= LARGEST_TOLERANCE:
            raise argparse.ArgumentTypeError(
                f"{word.strip()!r} must be a length of {SMALLEST_TOLERANCE:g} to"
                f" {LARGEST_TOLERANCE:g} mm"
            )
        found.add(value)
    return tuple(sorted(found, reverse=True))


# The tables ---------------------------------------------------------------------------------------


def _print_tables(design: Design, found: Survey, *, ripple: bool) -> None:
    from camgeo.accuracy.knee import advice

    print(f"{design.name}: what accuracy costs, in mm, bytes and seconds")
    print()
    heads = [*CONTOURS, "ripple"] if ripple else list(CONTOURS)
    _print_columns(heads, [_contour_cells(row, ripple=ripple) for row in found.contours])
    if found.solids:
        print()
        _print_columns(SOLIDS, [_solid_cells(row) for row in found.solids])
    print()
    unit, factor = _lift_unit(design)
    heads = ["step [deg]", "rows", "bytes", "made", f"error [{unit}]"]
    _print_columns(heads, [_table_cells(row, factor) for row in found.tables])
    if found.effects:
        print()
        _print_columns(EFFECTS, [_effect_cells(row) for row in found.effects])
    print()
    print(COLUMNS)
    if found.effects:
        print(EFFECT_COLUMNS)
    print(f"advice: {advice(found.knee)}")


def _print_columns(heads: Sequence[str], rows: Sequence[tuple[list[str], str]]) -> None:
    """Right-aligned columns, but for the first; behind a row why it has gaps."""
    table = [list(heads), *(cells for cells, _ in rows)]
    widths = [max(len(cells[column]) for cells in table) for column in range(len(heads))]
    faults = ["", *(fault for _, fault in rows)]
    for cells, fault in zip(table, faults, strict=True):
        line = "  ".join(
            cell.rjust(width) if column else cell.ljust(width)
            for column, (cell, width) in enumerate(zip(cells, widths, strict=True))
        )
        print(f"{line}  {fault}".rstrip())


def _contour_cells(row: ContourRow, *, ripple: bool) -> tuple[list[str], str]:
    count, drawing = row.count, row.drawing
    cells = [row.form, row.effort, f"{row.tolerance:g}"]
    cells += [
        NONE if count is None else f"{count.pieces:,}",
        NONE if count is None or count.ratio is None else f"{count.ratio:.3f}",
        NONE if count is None else f"{count.deviation:.3g}",
        NONE if drawing is None else f"{drawing.size:,}",
        NONE if row.program is None else f"{row.program.size:,}",
        _seconds(None if count is None else count.fit_seconds),
        _seconds(None if count is None else count.proof_seconds),
        _seconds(None if drawing is None else drawing.write_seconds),
        _seconds(None if drawing is None else drawing.read_seconds),
        NONE if row.round_seconds is None else f"{row.round_seconds:.1f}",
    ]
    if ripple:
        cells.append(NONE if row.ripple is None else f"{100.0 * row.ripple:.3g} %")
    return cells, row.fault


def _solid_cells(row: SolidRow) -> tuple[list[str], str]:
    file, cells = row.file, [row.format, f"{row.tolerance:g}"]
    if file is None:
        return [*cells, *[NONE] * 5], row.fault
    cells += [f"{file.facts['triangles']:,}", f"{file.deviation:.3g}", f"{file.size:,}"]
    cells += [_seconds(file.write_seconds), _seconds(file.read_seconds)]
    return cells, row.fault


def _table_cells(row: TableRow, factor: float) -> tuple[list[str], str]:
    error = f"{row.error * factor:.2g}"
    return [f"{row.step}", f"{row.rows:,}", f"{row.size:,}", _seconds(row.seconds), error], ""


def _effect_cells(row: EffectRow) -> tuple[list[str], str]:
    cells = [row.effect, f"{row.tolerance:g}", _seconds(row.seconds), _share(row.error)]
    return [*cells, _share(row.difference)], row.fault


def _share(value: float | None) -> str:
    return NONE if value is None else f"{value:.2g}"


def _seconds(value: float | None) -> str:
    return NONE if value is None else f"{value:.2g}" if value < 10.0 else f"{value:.0f}"


def _lift_unit(design: Design) -> tuple[str, float]:
    """Unit of the plan's positions in the table, and how many of it are in 1 mm or rad."""
    if design.drive.unit == "rad":
        return "deg", math.degrees(1.0)
    return design.scene.unit, 1.0 / MM_PER[design.scene.unit]


# JSON ---------------------------------------------------------------------------------------------


def _document(design: Design, found: Survey) -> dict[str, Any]:
    from camgeo.accuracy.knee import advice

    unit, factor = _lift_unit(design)
    knee = found.knee
    document = {
        "contours": [_contour_record(row) for row in found.contours],
        "solids": [_solid_record(row) for row in found.solids],
        "tables": [
            {
                "step_deg": float(row.step),
                "rows": row.rows,
                "bytes": row.size,
                "seconds": row.seconds,
                "interpolation_error": row.error * factor,
                "unit": unit,
            }
            for row in found.tables
        ],
        "knee": knee
        and {
            "contour": knee.row.form,
            "fit": knee.row.effort,
            "tolerance_mm": knee.row.tolerance,
            "end": knee.end,
        },
        "advice": advice(knee),
    }
    if found.effects:
        document["effects"] = [_effect_record(row) for row in found.effects]
    return document


def _contour_record(row: ContourRow) -> dict[str, Any]:
    count = row.count
    return {
        "contour": row.form,
        "fit": row.effort,
        "tolerance_mm": row.tolerance,
        "count": count
        and {
            "pieces": count.pieces,
            "forced": count.forced,
            "least": count.least,
            "ratio": count.ratio,
            "deviation_mm": count.deviation,
            "fit_seconds": count.fit_seconds,
            "proof_seconds": count.proof_seconds,
        },
        "dxf": row.drawing and _file_record(row.drawing),
        "gcode": row.program and _file_record(row.program),
        "round_seconds": row.round_seconds,
        "ripple": row.ripple,
        "fault": row.fault or None,
    }


def _solid_record(row: SolidRow) -> dict[str, Any]:
    file = row.file and _file_record(row.file)
    return {
        "format": row.format,
        "tolerance_mm": row.tolerance,
        "file": file,
        "fault": row.fault or None,
    }


def _effect_record(row: EffectRow) -> dict[str, Any]:
    return {**asdict(row), "fault": row.fault or None}


def _file_record(file: FileCost) -> dict[str, Any]:
    return {
        "bytes": file.size,
        "deviation_mm": file.deviation,
        "write_seconds": file.write_seconds,
        "read_seconds": file.read_seconds,
        **file.facts,
    }
