"""Answer of `camgeo accuracy`: what accuracy costs, and where more of it stops paying off."""

from __future__ import annotations

import argparse
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Final, Literal

from camgeo.app.answers.answer import SCENE, Answer, Key, Keys, aligned
from camgeo.app.cli.command import (
    SCENE_FILE,
    Argument,
    notify_main_disc,
    opened,
    picture_options,
    positive,
    show,
)
from camgeo.design.design import Design
from camgeo.geometry.contour.contour import Form
from camgeo.pictures.model import Figure
from camgeo.scene.formats.format import LARGEST_TOLERANCE, SMALLEST_TOLERANCE
from camgeo.scene.scene import Scene
from camgeo.studies.accuracy import survey as surveys
from camgeo.studies.accuracy.benefit import (
    BenefitRow,
    advice,
    benefit_rows,
    find_sufficient,
    sufficient_sentence,
)
from camgeo.studies.accuracy.contours import (
    FORMS,
    ContourRow,
    EffectRow,
    SolidRow,
    TableRow,
    in_length,
)
from camgeo.studies.accuracy.survey import (
    STAGES,
    TOLERANCES,
    BillRow,
    Survey,
    scene_contour,
    scene_rows,
)
from camgeo.units import MM_PER, RPM, LengthUnit


def enough_sentences(rows: Sequence[BenefitRow]) -> tuple[str, ...]:
    """One sentence per form of contour: which tolerance suffices at the speed of `rows`, and why.

    Forms for which no motion is known are left out; if that holds for all, one sentence says so.
    """
    verdicts = [find_sufficient([row for row in rows if row.form == form]) for form in FORMS]
    return tuple(sufficient_sentence(verdict) for verdict in verdicts if verdict is not None) or (
        sufficient_sentence(None),
    )


@dataclass(frozen=True, slots=True)
class Accuracy(Answer):
    """The costs of accuracy, and its benefits at one speed.

    Attributes
    ----------
    scene : the scene whose cam was measured.
    survey : the measured sizes and times.
    ripple : whether contours were replayed as well.
    turns : whether the positions of the motion are angles.
    complete : False if only the contour that the scene asks for was measured.
    benefits : what each form achieves at one speed; empty if no speed was requested.
    """

    scene: Scene
    survey: Survey
    ripple: bool
    turns: bool
    complete: bool = True
    benefits: tuple[BenefitRow, ...] = ()

    @property
    def advice(self) -> str:
        """The recommendation, in words."""
        return advice(self.survey.knee)

    @property
    def step(self) -> str:
        """What the last step of accuracy up to the recommended one costs and gains, in words."""
        return "" if self.survey.knee is None else self.survey.knee.step_sentence

    @property
    def drawing_rows(self) -> tuple[ContourRow, ...]:
        """The rows of the contour that the scene asks for."""
        return scene_rows(self.scene, self.survey.contours)

    @property
    def enough(self) -> tuple[str, ...]:
        """Which of the tolerances suffices at the requested speed, one sentence per form."""
        if not self.benefits:
            return ()
        speed = self.benefits[0].speed / RPM
        return tuple(
            f"at {speed:g} rev/min: {sentence}" for sentence in enough_sentences(self.benefits)
        )

    @property
    def form(self) -> Form:
        """Form of the contour in the drawing of the scene."""
        return scene_contour(self.scene)[0]

    @property
    def unit(self) -> str:
        """Unit in which positions of the motion are shown."""
        return "deg" if self.turns else self.scene.unit

    def display_value(self, lift: float) -> float:
        """A lift [mm or rad] in `unit`; derivatives by time are converted in the same way."""
        return math.degrees(lift) if self.turns else lift / MM_PER[self.scene.unit]

    @property
    def tables(self) -> tuple[dict[str, Any], ...]:
        """The rows of value tables, with the errors of their lift in `unit`."""
        return tuple(
            {
                "step_deg": row.step,
                "rows": row.rows,
                "bytes": row.size,
                "seconds": row.seconds,
                "spread": row.spread,
                "interpolation_error": self.display_value(row.error),
                "unit": self.unit,
            }
            for row in self.survey.tables
        )

    @property
    def written(self) -> tuple[dict[str, Any], ...]:
        """What each form achieves at one speed, with accelerations in `unit` per s^2."""
        return tuple(
            {
                "contour": row.form,
                "tolerance_mm": row.tolerance,
                "speed_rpm": row.speed / RPM,
                "acceleration": self._optional_value(row.acceleration),
                "exact_acceleration": self._optional_value(row.exact_acceleration),
                "jump": self._optional_value(row.jump),
                "unit": self.unit,
                "ripple": row.ripple,
                "force_N": row.force,
                "lowest_force_N": row.lowest,
                "highest_force_N": row.highest,
                "exact_lowest_force_N": row.exact_lowest,
                "exact_highest_force_N": row.exact_highest,
                "lift_off_rpm": _finite(row.lift_off_speed),
                "exact_lift_off_rpm": _finite(row.exact_lift_off_speed),
                "octaves": [self.display_value(value) for value in row.octaves],
                "octave_error": self._optional_value(row.octave_error),
                "strongest_harmonic": row.strongest,
                "fault": row.fault,
            }
            for row in self.benefits
        )

    def _optional_value(self, value: float | None) -> float | None:
        return None if value is None else self.display_value(value)


def _finite(speed: float | None) -> float | None:
    """A speed [rad/s] in rev/min; None if there is none or it is infinite."""
    return None if speed is None or math.isinf(speed) else speed / RPM


def accuracy(
    design: Design,
    tolerances: Sequence[float] = TOLERANCES,
    *,
    ripple: bool | None = None,
    complete: bool = True,
    bill: bool = False,
    speed: float | None = None,
    progress: Callable[[str], None] = lambda _: None,
) -> Accuracy:
    """Measure what accuracy costs.

    Parameters
    ----------
    tolerances : to measure [mm], the loosest first.
    ripple : whether contours are replayed too; None for what the scene says.
    speed : cam speed [rad/s] at which the follower on the written contours is computed; None for
        no such comparison.
    complete : whether all forms and fits of the contour are measured, and all other files, value
        tables and effects; else the contour that the scene asks for.
    bill : whether the scene is also built within each of them.
    progress : called with the name of each step.

    Raises
    ------
    UndercutError, GeometryError
        As `camgeo.studies.accuracy.survey.survey`.
    """
    if ripple is None:
        ripple = design.scene.output.accuracy_ripple
    benefits: tuple[BenefitRow, ...] = ()
    if speed is not None:
        forms = FORMS if complete else scene_contour(design.scene)[:1]
        benefits = benefit_rows(design, tolerances, (speed,), forms=forms, progress=progress)
    measured = surveys.survey(
        design, tolerances, ripple=ripple, complete=complete, bill=bill, benefits=benefits,
        progress=progress,
    )  # fmt: skip
    return Accuracy(design.scene, measured, ripple, design.drive.unit == "rad", complete, benefits)


# -- document -------------------------------------------------------------------------------------
# The keys of its JSON document.


COUNT: Final = Key(
    "The contours of all flanks in use; null if they cannot be made.",
    {
        "pieces": "Number of pieces of all flanks together.",
        "forced": "Pieces among them that dwells and turns require, whatever the tolerance.",
        "least": "Lower limit of the others for small tolerances.",
        "ratio": "Pieces that are not forced, as a multiple of that limit; null where it is 0.",
        "deviation_mm": "Largest proved deviation.",
        "fit_seconds": (
            "CPU time for the fits, including their own proof; the median of some runs, as all"
            " seconds of computing."
        ),
        "proof_seconds": "Time for the proofs from the finished contours alone.",
        "spread": "Ratio of the upper quartile of the runs to the lower one; 1 for a single run.",
    },
)

FILE: Final = Key(
    "A file written and read back; null if there is none.",
    {
        "bytes": Key("Size of the file.", of="size"),
        "deviation_mm": "Deviation proved for the file as read back; null if it has none.",
        "write_seconds": "Time to write it, including the fits.",
        "read_seconds": "Time to read it back and prove it.",
        "spread": "Ratio of the upper quartile of the runs to the lower one; 1 for a single run.",
        "facts": "What its writer reports about it, e.g. the number of arcs.",
    },
)

KNEE: Final = Key(
    "The recommended contour; null if no tolerance could be reached.",
    {
        "contour": Key("Form of the contour.", of="row.form", type=str),
        "fit": Key("Effort of the fit.", of="row.effort", type=str),
        "tolerance_mm": Key("Tolerance of the contour.", of="row.tolerance"),
        "end": Key(
            "What a tighter tolerance loses: time, decimals, ripple, benefit or cost; reach if it"
            " cannot be reached, range if no tighter one was examined.",
            type=str,
        ),
    },
)

MEASURED_EFFECT: Final[Keys] = {
    "seconds": ("Time to compute it, without the effects that it needs; null if it has no result."),
    "spread": ("Ratio of the upper quartile of the runs to the lower one; 1 for a single run."),
    "error": (
        "The error that it estimates itself, the largest of all its figures, relative"
        " likewise; null if it gives none."
    ),
    "difference": (
        "The largest difference of all figures, values of findings and columns, from a"
        " result to a tolerance at most a hundredth of this, relative likewise; null"
        " without such a result."
    ),
}
"""Keys of a numerical effect at one tolerance."""

DOCUMENT: Final = Key(
    "What accuracy costs, over the tolerance, and where it stops paying.",
    {
        "scene": SCENE,
        "step": (
            "What the last step of accuracy up to the recommended tolerance costs and buys, in"
            " words; empty if there is none."
        ),
        "contours": Key(
            "A row for each form of the contours at each tolerance.",
            {
                "contour": Key("Form of the contours.", of="form"),
                "fit": Key("Effort of the fit.", of="effort"),
                "tolerance_mm": "The requested tolerance.",
                "count": COUNT,
                "dxf": Key(
                    "The drawing with these contours; null if it cannot be made.",
                    FILE,
                    of="drawing",
                ),
                "gcode": Key(
                    "The milling program, only for arcs and if the scene asks for milling;"
                    " otherwise null.",
                    FILE,
                    of="program",
                ),
                "round_seconds": (
                    "Estimated time of milling once along the flanks; null if it is not known."
                ),
                "shortest_seconds": (
                    "Estimated time at the largest feed that the controller can hold on these"
                    " pieces."
                ),
                "ripple": (
                    "Largest error of the acceleration in a replay, as a fraction of its demanded"
                    " peak; null without a replay."
                ),
                "decimals": (
                    "Decimals of the coordinates in a program within that tolerance; null if the"
                    " scene does not ask for milling."
                ),
                "fault": "Why something is missing, or empty.",
            },
            of="survey.contours",
        ),
        "solids": Key(
            "A row for each format of solids at each tolerance.",
            {
                "format": "Format of the solid.",
                "tolerance_mm": "The requested tolerance.",
                "file": Key("The file; null if it cannot be made.", FILE),
                "fault": "Why something is missing, or empty.",
            },
            of="survey.solids",
        ),
        "tables": Key(
            "A row for each step of the value table.",
            {
                "step_deg": Key("Step of the cam angle.", type=float),
                "rows": Key("Number of rows of the table.", type=int),
                "bytes": Key("Size of its file.", type=int),
                "seconds": Key("Time to make it.", type=float),
                "spread": Key(
                    "Ratio of the upper quartile of the runs to the lower one; 1 for a single run.",
                    type=float,
                ),
                "interpolation_error": Key(
                    "Bound on the error of the lift between two rows with linear interpolation,"
                    " in `unit`.",
                    type=float,
                ),
                "unit": Key("Unit of that error.", type=Literal["mm", "inch", "deg"]),
            },
            by_key=True,
        ),
        "effects": Key(
            "A row for each numerical effect of the scene that a tolerance changes, at each"
            " tolerance; tolerances and errors are relative to the scale of each figure, such as"
            " the largest torque.",
            {
                "effect": "Name of the effect.",
                "tolerance": "The tolerance, as such a fraction.",
                **MEASURED_EFFECT,
                "figure": "Name of the finding or column with this difference; empty if it is 0.",
                "fault": (
                    "Why it has no result, or which figures are off by more than estimated;"
                    " otherwise empty."
                ),
            },
            of="survey.effects",
        ),
        "effects_at_rounding": Key(
            "The other numerical effects of the scene, which reach rounding at the loosest"
            " tolerance.",
            {
                "effect": "Name of the effect.",
                **MEASURED_EFFECT,
            },
            of="survey.rounded",
        ),
        "knee": Key(
            "The recommended contour; null if no tolerance could be reached.",
            KNEE,
            of="survey.knee",
        ),
        "advice": "The recommendation, in words.",
        "bill": Key(
            "Whole builds of the scene, with --bill; else empty.",
            {
                "tolerance_mm": "Largest deviation allowed.",
                "evaluate": Key(
                    "Seconds for motion, mechanism, findings, part, effects and tool paths.",
                    optional=True,
                ),
                "fit": Key("Seconds for contours with the proofs that decide them.", optional=True),
                "prove": Key(
                    "Seconds for further proofs, also of what was read back.", optional=True
                ),
                "write": Key("Seconds for the files and their certificate.", optional=True),
                "read": Key("Seconds for reading them back.", optional=True),
                "total": Key("Seconds from the loaded scene to the last file.", optional=True),
                "spread": Key(
                    "Ratio of the upper quartile of the runs to the lower one; 1 for a single run.",
                    optional=True,
                ),
                "pieces": Key("Number of pieces of the flanks of all discs.", optional=True),
                "bytes": Key("Size of all files.", of="size", optional=True),
                "machining_seconds": Key("Estimated time of all programs.", optional=True),
                "fault": Key("Why nothing was built; otherwise empty.", optional=True),
            },
            of="survey.bill",
        ),
        "benefits": Key(
            "What contours of each form and tolerance do at the speed of --speed: the follower on"
            " the contour as written, compared with the exact motion; empty without.",
            {
                "contour": Key("Form of the contour.", type=str),
                "tolerance_mm": Key("Tolerance of the contour.", type=float),
                "speed_rpm": Key("Constant speed of the cam [rev/min].", type=float),
                "acceleration": Key(
                    "Largest deviation of the acceleration from the exact one, jumps of the"
                    " velocity apart, in `unit`/s^2.",
                    type=float | None,
                ),
                "exact_acceleration": Key(
                    "Largest magnitude of the exact one, in `unit`/s^2.", type=float | None
                ),
                "jump": Key("Largest jump of the velocity, in `unit`/s.", type=float | None),
                "unit": Key("Unit of the motion.", type=Literal["mm", "inch", "deg"]),
                "ripple": Key(
                    "The deviation as a fraction of the exact peak; null if that is 0.",
                    type=float | None,
                ),
                "force_N": Key(
                    "Largest deviation of the contact force, jumps of the velocity apart; null"
                    " without forces.",
                    type=float | None,
                ),
                "lowest_force_N": Key(
                    "Least contact force; negative where the follower would have to be pulled or,"
                    " with form closure, where the opposite flank carries the load.",
                    type=float | None,
                ),
                "highest_force_N": Key("Largest contact force.", type=float | None),
                "exact_lowest_force_N": Key(
                    "The least one of the exact motion.", type=float | None
                ),
                "exact_highest_force_N": Key(
                    "The largest one of the exact motion.", type=float | None
                ),
                "lift_off_rpm": Key(
                    "Lowest cam speed at which the contact force vanishes somewhere (lift-off);"
                    " null"
                    " if it never does, if none was found for an elastic drive train, and if the"
                    " follower has form closure.",
                    type=float | None,
                ),
                "exact_lift_off_rpm": Key("That speed for the exact motion.", type=float | None),
                "octaves": Key(
                    "Effective value of the deviation of the acceleration in the harmonics 1, 2"
                    " to 3, 4 to 7 and so on of the cam's speed, jumps of the velocity included,"
                    " in `unit`/s^2.",
                    type=tuple[float, ...],
                ),
                "octave_error": Key(
                    "Largest error of the amplitude of each harmonic, in `unit`/s^2.",
                    type=float | None,
                ),
                "strongest_harmonic": Key(
                    "Number of the harmonic with the largest amplitude.", type=int | None
                ),
                "fault": Key("Why values are missing; else empty.", type=str),
            },
            of="written",
            by_key=True,
        ),
        "enough": (
            "Which tolerance suffices at the speed of --speed, and why: a sentence for each form"
            " of the contour; empty without it."
        ),
    },
    type=Accuracy,
)


# -- rendering ------------------------------------------------------------------------------------
# The answer of `camgeo accuracy` as tables and as a picture.


SUMMARY_COLUMNS: Final = """\
pieces, bytes: of the contour in the drawing of the scene, and of that file; seconds: of CPU time on
    this machine to fit, prove, write and read it, the median of some runs; spread: the ratio of
    the upper quartile of these to the lower one; machining: seconds to mill once along the flanks;
    --all has all other forms and files"""
"""The columns of the few rows, explained below them."""

COLUMNS: Final = """\
pieces: in the contours of the flanks; of least: pieces other than dwells and turns, as a multiple
    of the least number possible for small tolerances
deviation: proved, both ways and for every point
fit, proof, write, read: seconds of CPU time on this machine: the fit with its proof, the proof
    again from the finished contour alone, the drawing written with all its curves, and read back;
    spread: of them, the ratio of the upper quartile of some runs to the lower one
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
"""The columns of the table of builds."""

BENEFIT_COLUMNS: Final = """\
written: the follower on the contour as written; acceleration, force: largest deviation from the
    exact motion; ripple: that of the acceleration as a share of its exact peak; least: contact
    force, negative where the follower would have to be pulled or, with form closure, where the
    opposite flank carries the load; lifts off: from this cam speed on [rev/min]; octave: harmonics
    of the cam speed that contain most of the deviation of the acceleration, and its rms in them"""
"""The columns of the table of benefits."""

EFFECT_COLUMNS: Final = """\
effects: tolerance, estimate and off are shares of the scale of a figure, e.g. the largest torque;
    computed: seconds, without the effects that it needs; estimate: what it states of its error;
    off: the difference from a result to a hundredth of the tightest tolerance, with the figure
    that it is in; estimate and off are the largest of all values and columns"""
"""The columns of the table of effects."""

SUMMARY: Final = (
    "tolerance", "pieces", "bytes", "seconds", "spread", "machining", "acceleration off",
)  # fmt: skip
CONTOURS: Final = (
    "contour", "effort", "tolerance", "pieces", "of least", "deviation", "DXF", "G-code", "fit",
    "proof", "write", "read", "spread", "round", "shortest",
)  # fmt: skip
BILL: Final = ("build", *STAGES, "total", "spread", "pieces", "bytes", "machining")
SOLIDS: Final = ("solid", "tolerance", "faces", "deviation", "bytes", "write", "read", "spread")
EFFECTS: Final = ("effect", "tolerance", "computed", "spread", "estimate", "off", "figure")
"""Heads of the columns; lengths in mm, sizes in bytes, times in seconds."""

NONE: Final = "-"
"""Shown in place of a missing value."""


def text(answer: Accuracy) -> str:
    """The costs of the scene's contour, or of everything measured in one table of each kind, then
    the step up to the recommended tolerance, and the recommendation.
    """
    name, unit = answer.scene.name, answer.scene.unit
    lines = [f"{name}: what accuracy costs, in {unit}, bytes and seconds", ""]
    lines += _tables(answer) if answer.complete else _summary(answer)
    lines += [answer.step] if answer.step else []
    return "\n".join([*lines, f"advice: {answer.advice}", *answer.enough])


def _summary(answer: Accuracy) -> list[str]:
    """The rows of the scene's own contour, and the table of builds if it was requested."""
    mm, bill = MM_PER[answer.scene.unit], answer.survey.in_length(answer.scene.unit).bill
    ripples = {row.tolerance: row.ripple for row in answer.benefits if row.form == answer.form}
    # The last column is the error of the acceleration, which is known only with a replay.
    count = len(SUMMARY) if ripples or answer.ripple else len(SUMMARY) - 1
    cells = [_summary_cells(in_length(row, mm), ripples.get(row.tolerance, row.ripple))[:count]
             for row in answer.drawing_rows]  # fmt: skip
    rows = [
        (row_cells, row.fault) for row_cells, row in zip(cells, answer.drawing_rows, strict=True)
    ]
    builds = ["", *_columns(BILL, [_bill_cells(row) for row in bill])] if bill else []
    notes = ["", SUMMARY_COLUMNS, BILL_COLUMNS][: 3 if bill else 2]
    return [*_columns(SUMMARY[:count], rows), *builds, *notes]


def _summary_cells(row: ContourRow, ripple: float | None) -> list[str]:
    cells = dict(zip(CONTOURS, _contour_cells(row, ripple=False)[0], strict=True))
    seconds = _seconds(None if row.drawing is None else row.drawing.seconds)
    sizes = [cells[name] for name in ("tolerance", "pieces", "DXF")]
    return [*sizes, seconds, cells["spread"], cells["round"], _percent(ripple)]


def _tables(answer: Accuracy) -> list[str]:
    """A table each of contours, solids, builds, benefits, value tables and effects."""
    length = answer.scene.unit
    survey, ripple = answer.survey.in_length(length), answer.ripple
    steps = ("step [deg]", "rows", "bytes", "made", "spread", f"error [{answer.unit}]")
    tables: tuple[tuple[Sequence[str], list[tuple[list[str], str]], str], ...] = (
        (
            (*CONTOURS, *["ripple"] * ripple),
            [_contour_cells(row, ripple=ripple) for row in survey.contours],
            COLUMNS,
        ),
        (SOLIDS, [_solid_cells(row) for row in survey.solids], ""),
        (BILL, [_bill_cells(row) for row in survey.bill], BILL_COLUMNS),
        (
            _benefits(answer),
            [_benefit_cells(row, length) for row in answer.written],
            BENEFIT_COLUMNS,
        ),
        (steps, [_table_cells(row, answer) for row in survey.tables], ""),
        (EFFECTS, [_effect_cells(row) for row in survey.effects], EFFECT_COLUMNS),
    )
    lines = []
    for heads, rows, _ in tables:
        lines += [*_columns(heads, rows), ""] if rows else []
    if survey.rounded:
        lines += [*map(_rounded, survey.rounded), ""]
    return [*lines, *(legend for _, rows, legend in tables if rows and legend)]


def figure(answer: Accuracy) -> Figure:
    """The measured costs over the tolerance, one panel for each kind."""
    buys = " and buys" if answer.benefits else ""
    title = f"{answer.scene.name}: what accuracy costs{buys}"
    from camgeo.pictures import accuracy as picture

    return picture.figure(
        answer.survey,
        title=title,
        benefits=answer.benefits,
        form=answer.form,
        unit="rad" if answer.turns else "mm",
        length=answer.scene.unit,
    )


def _columns(heads: Sequence[str], rows: Sequence[tuple[list[str], str]]) -> list[str]:
    """Columns, right-aligned except the first; a row with gaps is followed by the reason."""
    lines = [[*heads, ""], *([*cells, fault] for cells, fault in rows)]
    return aligned(lines, range(1, len(heads)))


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
        NONE if count is None else f"{row.spread:.2f}",
        _tenths(row.round_seconds),
        _tenths(row.shortest_seconds),
    ]
    if ripple:
        cells.append(_percent(row.ripple))
    return cells, row.fault


def _solid_cells(row: SolidRow) -> tuple[list[str], str]:
    file, cells = row.file, [row.format, f"{row.tolerance:g}"]
    if file is None:
        return [*cells, *[NONE] * 6], row.fault
    # Meshes report triangles, STEP files report faces.
    faces = file.facts.get("triangles") or file.facts["faces"]
    cells += [f"{faces:,}", f"{file.deviation:.3g}", f"{file.size:,}"]
    cells += [_seconds(file.write_seconds), _seconds(file.read_seconds), f"{file.spread:.2f}"]
    return cells, row.fault


def _bill_cells(row: BillRow) -> tuple[list[str], str]:
    seconds = [row.stages.get(stage) for stage in STAGES]
    cells = [f"{row.tolerance:g}", *map(_seconds, (*seconds, row.total))]
    cells.append(f"{row.spread:.2f}" if row.stages else NONE)
    cells += [NONE if count is None else f"{count:,}" for count in (row.pieces, row.size)]
    return [*cells, _seconds(row.machining_seconds)], row.fault


def _benefits(answer: Accuracy) -> list[str]:
    """Heads of the table of benefits."""
    heads = ["written", "tolerance", f"acceleration [{answer.unit}/s^2]", "ripple"]
    return [*heads, "force [N]", "least [N]", "lifts off", "octave", f"in it [{answer.unit}/s^2]"]


def harmonics(octave: int) -> str:
    """The harmonics of an octave, counted from 0, as text: "1", "2-3", "4-7" and so on."""
    first = 2**octave
    return f"{first}-{2 * first - 1}" if octave else "1"


def _benefit_cells(row: dict[str, Any], length: LengthUnit) -> tuple[list[str], str]:
    figures = (row["force_N"], row["lowest_force_N"], row["lift_off_rpm"])
    cells = [
        row["contour"],
        f"{row['tolerance_mm'] / MM_PER[length]:.6g}",
        _three(row["acceleration"]),
        _percent(row["ripple"]),
        *map(_three, figures),
    ]
    octaves = row["octaves"]
    # The octave with the largest effective value; none if there are no octaves.
    strongest = max(range(len(octaves)), key=octaves.__getitem__, default=None)
    cells += [NONE] * 2 if strongest is None else [
        harmonics(strongest), _three(octaves[strongest]),
    ]  # fmt: skip
    return cells, row["fault"]


def _three(value: float | None) -> str:
    """Three significant digits, but all digits before the decimal point."""
    return NONE if value is None else f"{value:,.0f}" if abs(value) >= 100.0 else f"{value:.3g}"


def _table_cells(row: TableRow, answer: Accuracy) -> tuple[list[str], str]:
    error = f"{answer.display_value(row.error):.2g}"
    return [
        f"{row.step}",
        f"{row.rows:,}",
        f"{row.size:,}",
        _seconds(row.seconds),
        f"{row.spread:.2f}",
        error,
    ], ""


def _effect_cells(row: EffectRow) -> tuple[list[str], str]:
    spread = NONE if row.seconds is None else f"{row.spread:.2f}"
    cells = [row.effect, f"{row.tolerance:g}", _seconds(row.seconds), spread]
    return [*cells, _share(row.error), _share(row.difference), row.figure or NONE], row.fault


def _rounded(row: EffectRow) -> str:
    """The sentence on an effect that is accurate to rounding at any tolerance."""
    estimate = "it is exact" if row.error is None else f"estimate {_share(row.error)}"
    return (
        f"{row.effect}: rounding at any tolerance ({estimate}, off {_share(row.difference)}),"
        f" computed in {_seconds(row.seconds)} s"
    )


def _percent(share: float | None) -> str:
    return NONE if share is None else f"{100.0 * share:.3g} %"


def _tenths(seconds: float | None) -> str:
    return NONE if seconds is None else f"{seconds:.1f}"


def _share(value: float | None) -> str:
    return NONE if value is None else f"{value:.2g}"


def _seconds(value: float | None) -> str:
    return NONE if value is None else f"{value:.2g}" if value < 10.0 else f"{value:.0f}"


# -- command line ----------------------------------------------------------------------------------


EXAMPLE: Final = (
    "camgeo accuracy fixtures/scenes/setzhub.toml -o setzhub-accuracy.svg\n"
    "  camgeo accuracy my-cam.toml --tolerances 1e-2,1e-3,1e-4 --ripple\n"
    "  camgeo accuracy my-cam.toml --speed 600\n"
    "  camgeo accuracy my-cam.toml --all\n"
    "  camgeo accuracy my-cam.toml --bill --ripple -o my-cam-bill.svg\n"
    "  camgeo accuracy my-cam.toml --json"
)


def _tolerances(text: str) -> tuple[float, ...]:
    """The tolerances of `--tolerances`, each once, the loosest first."""
    tolerances = set()
    for word in text.split(","):
        try:
            value = float(word)
        except ValueError:
            value = math.nan
        # NaN fails this comparison as well.
        if not SMALLEST_TOLERANCE <= value <= LARGEST_TOLERANCE:
            raise argparse.ArgumentTypeError(
                f"{word.strip()!r} must be a length of {SMALLEST_TOLERANCE:g} to"
                f" {LARGEST_TOLERANCE:g} mm"
            )
        tolerances.add(value)
    return tuple(sorted(tolerances, reverse=True))


ARGUMENTS: Final = (
    SCENE_FILE,
    Argument(
        "--tolerances",
        metavar="MM",
        type=_tolerances,
        help="comma-separated, in mm; default 1e-1 to 1e-6, one per decade; finer ones take long",
    ),
    Argument(
        "--all",
        action="store_true",
        help="measure all forms and fits of the contour, solids, value tables and effects too; so"
        " does --json",
    ),
    Argument(
        "--ripple",
        action="store_true",
        help="also replay the contours: how far the follower's acceleration is off",
    ),
    Argument(
        "--bill",
        action="store_true",
        help="also build the scene within each tolerance: the seconds of each stage",
    ),
    Argument(
        "--speed",
        metavar="RPM",
        type=positive,
        help="also report which tolerance of each form suffices at this cam speed",
    ),
    *picture_options(),
)


def run(arguments: argparse.Namespace) -> int:
    """Measure, and print or draw the results."""
    design = opened(arguments)
    notify_main_disc(design, "figures")
    answer = accuracy(
        design,
        arguments.tolerances or TOLERANCES,
        ripple=arguments.ripple or None,
        complete=arguments.all or arguments.json,
        bill=arguments.bill,
        speed=None if arguments.speed is None else arguments.speed * RPM,
        progress=arguments.progress,
    )
    return show(answer, arguments, contents="pieces, bytes, seconds")
