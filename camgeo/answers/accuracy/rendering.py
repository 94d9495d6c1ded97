"""What `camgeo accuracy` finds, as tables and as a picture."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Final

from camgeo.accuracy.bill import STAGES, BillRow
from camgeo.accuracy.rows import ContourRow, EffectRow, SolidRow, TableRow
from camgeo.accuracy.spectrum import harmonics
from camgeo.answers.accuracy import Accuracy
from camgeo.figure import accuracy
from camgeo.figure.model import Figure
from camgeo.units import MM_PER, LengthUnit

COLUMNS: Final = """\
pieces: in the contours of the flanks; of least: pieces other than dwells and turns, as a multiple
    of the least number possible for small tolerances
deviation: proved, both ways and for every point
fit, proof, write, read: seconds of computing on this machine: the fit with its proof, the proof
    again from the finished contour alone, the drawing written with all its curves, and read back
round, shortest: seconds to mill once along the flanks at the feed of the scene, and as fast as the
    controller can run these pieces, by its look-ahead, corners and accelerations
ripple: largest error of the acceleration in a replay, as a share of its demanded peak
error: bound on the error of the lift if it is interpolated linearly between two rows"""
"""The columns of the tables, explained below them."""

BILL_COLUMNS: Final = """\
build: seconds of a whole build of the scene, from the loaded scene to the last file; evaluate:
    motion, mechanism, findings, part, effects and tool paths; fit: contours with the proofs that
    decide them; prove: further proofs, also of what was read back; write: the files and their
    certificate; read: reading them back; machining: of all programs together"""
"""The same for the table of builds."""

BENEFIT_COLUMNS: Final = """\
written: the follower on the contour as written; acceleration, force: largest deviation from the
    exact motion; ripple: that of the acceleration as a share of its exact peak; least: contact
    force, negative where the follower would have to be pulled or, held both ways, where the other
    side carries; lifts off: from this speed of the cam on [rev/min]; octave: harmonics of the cam's
    speed in which most of the deviation of the acceleration is, and its effective value in them"""
"""The same for the table of benefits."""

EFFECT_COLUMNS: Final = """\
effects: tolerance, estimate and off are shares of the scale of a figure, e.g. the largest torque;
    computed: seconds, without the effects that it needs; estimate: what it states of its error;
    off: the difference from a result to a hundredth of the tightest tolerance, with the figure
    that it is in; estimate and off are the largest of all values and columns"""
"""The same for the table of effects."""

CONTOURS: Final = (
    "contour", "effort", "tolerance", "pieces", "of least", "deviation", "DXF", "G-code", "fit",
    "proof", "write", "read", "round", "shortest",
)  # fmt: skip
BILL: Final = ("build", *STAGES, "total", "pieces", "bytes", "machining")
SOLIDS: Final = ("solid", "tolerance", "faces", "deviation", "bytes", "write", "read")
EFFECTS: Final = ("effect", "tolerance", "computed", "estimate", "off", "figure")
"""Heads of the columns; lengths in mm, sizes in bytes, times in seconds."""

NONE: Final = "-"
"""Shown in place of a missing value."""


def text(answer: Accuracy) -> str:
    """A table each of contours, solids, builds, benefits, value tables and effects; the advice."""
    length = answer.scene.unit
    found, ripple = answer.survey.in_length(length), answer.ripple
    lines = [f"{answer.scene.name}: what accuracy costs, in {length}, bytes and seconds", ""]
    heads = [*CONTOURS, "ripple"] if ripple else list(CONTOURS)
    lines += _columns(heads, [_contour_cells(row, ripple=ripple) for row in found.contours])
    if found.solids:
        lines += ["", *_columns(SOLIDS, [_solid_cells(row) for row in found.solids])]
    if found.bill:
        lines += ["", *_columns(BILL, [_bill_cells(row) for row in found.bill])]
    if answer.benefits:
        lines += [
            "",
            *_columns(_benefits(answer), [_benefit_cells(row, length) for row in answer.written]),
        ]
    heads = ["step [deg]", "rows", "bytes", "made", f"error [{answer.unit}]"]
    lines += ["", *_columns(heads, [_table_cells(row, answer) for row in found.tables])]
    if found.effects:
        lines += ["", *_columns(EFFECTS, [_effect_cells(row) for row in found.effects])]
    if found.rounded:
        lines += ["", *map(_rounded, found.rounded)]
    lines += ["", COLUMNS, *([BILL_COLUMNS] if found.bill else [])]
    lines += [BENEFIT_COLUMNS] if answer.benefits else []
    lines += [EFFECT_COLUMNS] if found.effects else []
    lines.append(f"advice: {answer.advice}")
    return "\n".join([*lines, *answer.enough])


def figure(answer: Accuracy) -> Figure:
    """What was measured over the tolerance, a panel for each kind of cost."""
    buys = " and buys" if answer.benefits else ""
    title = f"{answer.scene.name}: what accuracy costs{buys}"
    return accuracy.figure(
        answer.survey,
        title=title,
        benefits=answer.benefits,
        form=answer.form,
        unit="rad" if answer.turns else "mm",
        length=answer.scene.unit,
    )


def _columns(heads: Sequence[str], rows: Sequence[tuple[list[str], str]]) -> list[str]:
    """Columns, right-aligned except the first; a row with gaps is followed by the reason."""
    table = [list(heads), *(cells for cells, _ in rows)]
    widths = [max(len(cells[column]) for cells in table) for column in range(len(heads))]
    faults = ["", *(fault for _, fault in rows)]
    lines = []
    for cells, fault in zip(table, faults, strict=True):
        line = "  ".join(
            cell.rjust(width) if column else cell.ljust(width)
            for column, (cell, width) in enumerate(zip(cells, widths, strict=True))
        )
        lines.append(f"{line}  {fault}".rstrip())
    return lines


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
        NONE if row.shortest_seconds is None else f"{row.shortest_seconds:.1f}",
    ]
    if ripple:
        cells.append(NONE if row.ripple is None else f"{100.0 * row.ripple:.3g} %")
    return cells, row.fault


def _solid_cells(row: SolidRow) -> tuple[list[str], str]:
    file, cells = row.file, [row.format, f"{row.tolerance:g}"]
    if file is None:
        return [*cells, *[NONE] * 5], row.fault
    faces = file.facts.get("triangles") or file.facts["faces"]
    cells += [f"{faces:,}", f"{file.deviation:.3g}", f"{file.size:,}"]
    cells += [_seconds(file.write_seconds), _seconds(file.read_seconds)]
    return cells, row.fault


def _bill_cells(row: BillRow) -> tuple[list[str], str]:
    seconds = [row.stages.get(stage) for stage in STAGES]
    cells = [f"{row.tolerance:g}", *map(_seconds, (*seconds, row.total))]
    cells += [NONE if each is None else f"{each:,}" for each in (row.pieces, row.size)]
    return [*cells, _seconds(row.machining_seconds)], row.fault


def _benefits(answer: Accuracy) -> list[str]:
    """Heads of the table of benefits."""
    heads = ["written", "tolerance", f"acceleration [{answer.unit}/s^2]", "ripple"]
    return [*heads, "force [N]", "least [N]", "lifts off", "octave", f"in it [{answer.unit}/s^2]"]


def _benefit_cells(row: dict[str, Any], length: LengthUnit) -> tuple[list[str], str]:
    ripple = row["ripple"]
    figures = (row["force_N"], row["lowest_force_N"], row["lift_off_rpm"])
    cells = [
        row["contour"],
        f"{row['tolerance_mm'] / MM_PER[length]:.6g}",
        _three(row["acceleration"]),
        NONE if ripple is None else f"{100.0 * ripple:.3g} %",
        *map(_three, figures),
    ]
    octaves = row["octaves"]
    strongest = max(range(len(octaves)), key=octaves.__getitem__, default=None)
    cells += [NONE] * 2 if strongest is None else [
        harmonics(strongest), _three(octaves[strongest]),
    ]  # fmt: skip
    return cells, row["fault"]


def _three(value: float | None) -> str:
    """Three digits, the units at least."""
    return NONE if value is None else f"{value:,.0f}" if abs(value) >= 100.0 else f"{value:.3g}"


def _table_cells(row: TableRow, answer: Accuracy) -> tuple[list[str], str]:
    error = f"{answer.shown(row.error):.2g}"
    return [f"{row.step}", f"{row.rows:,}", f"{row.size:,}", _seconds(row.seconds), error], ""


def _effect_cells(row: EffectRow) -> tuple[list[str], str]:
    cells = [row.effect, f"{row.tolerance:g}", _seconds(row.seconds), _share(row.error)]
    return [*cells, _share(row.difference), row.figure or NONE], row.fault


def _rounded(row: EffectRow) -> str:
    """The sentence on an effect that no tolerance changes."""
    estimate = "it is exact" if row.error is None else f"estimate {_share(row.error)}"
    return (
        f"{row.effect}: rounding at any tolerance ({estimate}, off {_share(row.difference)}),"
        f" computed in {_seconds(row.seconds)} s"
    )


def _share(value: float | None) -> str:
    return NONE if value is None else f"{value:.2g}"


def _seconds(value: float | None) -> str:
    return NONE if value is None else f"{value:.2g}" if value < 10.0 else f"{value:.0f}"
