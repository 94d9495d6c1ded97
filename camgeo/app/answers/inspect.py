"""Answer of `camgeo inspect`: a measured disc compared with the exact one."""

from __future__ import annotations

import argparse
import math
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Final, Literal

import numpy as np

from camgeo.app.answers.answer import (
    FINDING,
    SCENE,
    Answer,
    Key,
    display_unit,
    exit_code,
    finding_lines,
    named_line,
    read_named,
    scaled,
    small_extreme,
    whose_lift,
)
from camgeo.app.cli.command import (
    SCENE_FILE,
    TABLE_OR_PICTURE,
    Argument,
    CallError,
    non_negative,
    opened,
    positive,
    show,
)
from camgeo.check.finding import Finding, limit_finding
from camgeo.design.design import Design
from camgeo.design.product import Product, find_disc
from camgeo.design.value_table import Table
from camgeo.errors import GeometryError
from camgeo.geometry.outline.exact_flank import ExactFlank
from camgeo.geometry.outline.path import Flank
from camgeo.numeric.arrays import ComplexArray, frozen
from camgeo.numeric.columns import NumberColumn, RequestedColumns, fault, read_columns
from camgeo.numeric.extremes import Extremes
from camgeo.pictures.model import Figure
from camgeo.reading import TABLE
from camgeo.record import Pickled
from camgeo.scene.scene import Scene
from camgeo.studies.inspection import (
    CONFIDENCE,
    LENGTHS,
    TELLING,
    Align,
    Alignment,
    Deviations,
    LiftErrors,
    false_share,
    measured_points,
    other_axes,
    radius_angles,
    stated_normals,
)
from camgeo.units import (
    MM_PER,
    LengthUnit,
    at_cam_angles,
    cam_angle,
    cam_angle_range,
    counted,
    small,
)

WIDEST_GAP: Final = math.radians(10.0)
"""Widest range of the path [rad] without a point at which the follower is still replayed."""

LEAST_FORM: Final = 1e-6
"""Form errors [mm] below a nanometre are rounding errors."""

UNSURE: Final = math.radians(0.1)
"""Uncertainty of the rotation [rad] above which the points do not determine it: about what the play
of a keyway allows."""


@dataclass(frozen=True, slots=True, eq=False)
class LiftEffect:
    """Effect of the deviations on the follower, in `unit`; cam angles in rad.

    Attributes
    ----------
    errors : over the cam angle [mm or rad].
    member : "rocker" behind a linkage, else "follower".
    unit : that of the scene, or "deg".
    factor : `unit` per mm or rad.
    extremes : smallest and largest error.
    uncertainty : of the error of the larger magnitude, from that of the deviations.
    """

    errors: LiftErrors
    member: str
    unit: str
    factor: float
    extremes: Extremes
    uncertainty: float


@dataclass(frozen=True, slots=True, eq=False)
class Inspection(Answer):
    """A measured flank.

    Attributes
    ----------
    scene : specifies the disc.
    disc, flank : which one was measured.
    file : name of the file with the points.
    count : of its points.
    ball : radius [mm] of the ball whose centres they are, 0 for points of the flank.
    tolerance : width [mm] of the zone about the flank in which points may lie; None if not stated.
    robust : whether the fit disregards local form errors.
    alignment : how the points lie on the flank.
    deviations : over the cam angle.
    lift : effect on the follower; None if it cannot be determined, see the findings.
    findings : worst first.
    """

    scene: Scene
    disc: Product
    flank: Flank
    file: str
    count: int
    ball: float
    tolerance: float | None
    robust: bool
    alignment: Alignment
    deviations: Deviations
    lift: LiftEffect | None
    findings: tuple[Finding, ...]

    @property
    def exit_code(self) -> int:
        """1 if the profile is out of tolerance."""
        return exit_code(self.findings)

    @property
    def align(self) -> str:
        """Kind of alignment: "datum", "rotation" or "free"."""
        return self.alignment.align.value

    @property
    def confidence(self) -> float:
        """Confidence level of all uncertainties."""
        return CONFIDENCE

    @property
    def shift(self) -> complex | None:
        """Shift of the part in the axes of the measurement [mm]; None if it was not fitted."""
        uncertainty = self.alignment.shift_uncertainty
        return None if uncertainty is None else self.alignment.frame.shift

    @property
    def turn(self) -> float | None:
        """Rotation of the part in the axes of the measurement [rad], counter-clockwise positive;
        None if it was not fitted.
        """
        uncertainty = self.alignment.turn_uncertainty
        return None if uncertainty is None else self.alignment.frame.turn

    @property
    def delay(self) -> float | None:
        """Cam angle [rad] by which the motion is late because the part is rotated; None if that was
        not fitted.
        """
        return None if self.turn is None else -self.scene.rotation * self.turn


def inspect(
    design: Design,
    file: str | Path,
    flank: str | None = None,
    *,
    align: str = Align.DATUM,
    robust: bool = False,
    unit: LengthUnit | None = None,
    ball: float = 0.0,
    tolerance: float | None = None,
) -> Inspection:
    """Compare the points of a file with the exact flank of a design.

    Parameters
    ----------
    file : CSV, see `camgeo.studies.inspection`. The end of its name states the disc of a
        conjugate pair ("-return") and the flank of a groove ("-inner", "-outer").
    flank : "inner" or "outer"; None for the one that the file's name states, or else the one that
        closes the contact.
    align : "datum", "rotation" or "free", see `camgeo.studies.inspection`.
    robust : whether a fit disregards local form errors; without a fit it makes no difference.
    unit : of a file that states none; None for that of the scene.
    ball : radius [mm] of the ball whose centres the points are; 0 for points of the flank.
    tolerance : width [mm] of the zone about the flank in which all points must lie.

    Raises
    ------
    SceneError
        If the file cannot be read.
    FileError, GeometryError
        If it is too large, or has no such points; if there is no such disc; if the fit does not
        converge.
    """
    path = Path(file)
    disc, side = _measured(design, path.stem, flank)
    measured = read_points(
        read_named(path, TABLE, "MEASURED"), path.name, unit or design.scene.unit
    )
    return inspect_points(
        disc,
        side,
        measured,
        path.name,
        align=Align(align),
        robust=robust,
        ball=ball,
        tolerance=tolerance,
    )


def inspect_points(
    disc: Product,
    side: Flank,
    measured: MeasuredPoints,
    name: str,
    *,
    align: Align = Align.DATUM,
    robust: bool = False,
    ball: float = 0.0,
    tolerance: float | None = None,
) -> Inspection:
    """Compare `measured` points with the flank `side` of `disc`; `name` is that of their file."""
    cam = disc.cam
    exact = ExactFlank(cam.disc.outline(side).path, side)
    alignment = Alignment.from_points(exact, measured.points, align, ball, robust=robust)
    deviations = Deviations.from_feet(exact, alignment.feet, alignment.deviations)
    findings = [
        _profile(deviations, tolerance),
        _coverage(deviations),
        *_turn(alignment),
        *([] if robust else _form(alignment, deviations)),
        *_axes(exact, measured, deviations, ball),
        *_normals(alignment, measured),
    ]
    effect = None
    if deviations.widest.width <= WIDEST_GAP:
        try:
            effect = _effect(disc, exact, deviations)
        except GeometryError as error:
            sentence = f"the follower cannot be pressed on the measured disc: {error}"
            findings.append(Finding("lift-error", "warning", sentence))
    # The sort is stable: findings of one severity stay in the order of the checks.
    order = ("broken", "warning", "ok")
    findings.sort(key=lambda finding: order.index(finding.severity))
    return Inspection(
        disc.scene,
        disc,
        side,
        name,
        len(measured.points),
        ball,
        tolerance,
        robust and align is not Align.DATUM,
        alignment,
        deviations,
        effect,
        tuple(findings),
    )


def _measured(design: Design, stem: str, flank: str | None) -> tuple[Product, Flank]:
    """The disc and the flank that a file named `stem` without its ending was measured on."""
    if flank is not None:
        return find_disc(design.discs, stem), Flank(flank)
    for side in design.cam.contact.flanks:
        if stem.lower().endswith(f"-{side}"):
            # The flank comes last in a name: pair-return-inner.
            return find_disc(design.discs, stem[: -len(side) - 1]), side
    return find_disc(design.discs, stem), design.cam.contact.main


def _effect(disc: Product, exact: ExactFlank, deviations: Deviations) -> LiftEffect:
    """The effect of the deviations on the follower, in the unit of the scene."""
    cam = disc.cam
    errors = LiftErrors.from_deviations(exact, deviations, clearance=cam.clearance)
    unit, factor = display_unit(disc.scene.unit, is_angle=cam.lift_unit == "rad")
    low, high = (
        scaled(extreme, factor) for extreme in (errors.extremes.lowest, errors.extremes.highest)
    )
    worst = high if high.value >= -low.value else low
    # A deviation of the flank moves the follower by 1 / leverage of it, and so does its
    # uncertainty.
    leverage = abs(float(exact.curve.pitch.leverage(np.array([worst.place]))[0]))
    uncertainty = math.inf if leverage == 0.0 else deviations.uncertainty * factor / leverage
    return LiftEffect(errors, whose_lift(cam), unit, factor, Extremes(low, high), uncertainty)


def _profile(deviations: Deviations, tolerance: float | None) -> Finding:
    extremes = deviations.extremes
    worst = max(extremes.highest, extremes.lowest, key=lambda extreme: abs(extreme.value))
    what = "excess" if worst.value > 0.0 else "missing"
    statement = (
        f"the largest deviation is {small(abs(worst.value), 'mm')} of {what} material"
        f" {at_cam_angles(worst.place)}; all points lie in a zone"
        f" {small(deviations.profile, 'mm')} wide"
    )
    return limit_finding("profile", statement, deviations.profile, tolerance, "mm", worst.place)


def _coverage(deviations: Deviations) -> Finding:
    width, start = deviations.widest.width, deviations.widest.place
    degrees = math.degrees(width)
    where = cam_angle_range(start, start + width)
    if width <= WIDEST_GAP:
        sentence = f"the widest gap between points is {degrees:.3g} deg, {where}"
        return Finding("coverage", "ok", sentence, degrees, unit="deg", cam_angle=start)
    sentence = (
        f"there are no points {where}: the effect of the deviations on the follower is reported"
        f" only for points at most {math.degrees(WIDEST_GAP):g} deg apart"
    )
    return Finding("coverage", "warning", sentence, degrees, math.degrees(WIDEST_GAP), "deg", start)


def _turn(alignment: Alignment) -> Iterator[Finding]:
    unsure, other = alignment.turn_uncertainty, alignment.other_turn
    if unsure is None:
        return
    limit, degrees = math.degrees(UNSURE), math.degrees(unsure)
    if math.isinf(unsure):
        sentence = (
            "the flank is too nearly circular to show the rotation of the part: any angle fits"
        )
        yield Finding("turn", "warning", sentence, None, limit, "deg")
    elif unsure > UNSURE:
        sentence = (
            f"the flank shows the rotation of the part only to within {small(degrees, 'deg')}"
        )
        yield Finding("turn", "warning", sentence, degrees, limit, "deg")
    else:
        sentence = f"the rotation of the part is known to within {small(degrees, 'deg')}"
        yield Finding("turn", "ok", sentence, degrees, limit, "deg")
    if other is not None:
        value = math.degrees(other)
        sentence = f"the points fit equally well with the part turned by {value:.6g} deg"
        yield Finding("other-turn", "warning", sentence, value, unit="deg")


def _form(alignment: Alignment, deviations: Deviations) -> Iterator[Finding]:
    """Form errors, which the stated uncertainty of a fit does not include."""
    form = deviations.form
    if alignment.align is Align.DATUM or form < LEAST_FORM:
        return
    shift, turn = (form * sway for sway in alignment.sway)
    bounds = [small(shift, "mm")] * (alignment.align is Align.FREE)
    bounds += [small(math.degrees(turn), "deg")] * (turn > 0.0)
    sentence = (
        f"form errors of {small(form, 'mm')} (root mean square) may have moved the fit by up to"
        f" {' and '.join(bounds)}, which its uncertainty does not include;"
        " --robust disregards local ones"
    )
    if bounds:
        yield Finding("form", "warning", sentence, form, unit="mm")


def _axes(
    exact: ExactFlank, measured: MeasuredPoints, deviations: Deviations, ball: float
) -> Iterator[Finding]:
    """Other axes in which points fit far better than in those of the scene's cam."""
    other_fit = other_axes(exact, measured.points, deviations.root_mean_square, ball)
    if other_fit is None:
        return
    frame = other_fit.frame
    part = (
        f"shifted by {small(frame.shift.real, 'mm')} and {small(frame.shift.imag, 'mm')} and turned"
        f" by {small(math.degrees(frame.turn), 'deg')}"
    )
    left = f"to {small(other_fit.left, 'mm')} (root mean square)"
    sentence = (
        f"the points fit {left} with the part {part}: they are not in the axes of the scene's cam;"
        " measure from bore and key, or use --align free"
    )
    if other_fit.mirrored:
        sentence = (
            f"with y reversed the points fit {left}, the part {part}: they were measured from the"
            " other side of the disc"
        )
    yield Finding("axes", "warning", sentence, other_fit.left, unit="mm")


def _normals(alignment: Alignment, measured: MeasuredPoints) -> Iterator[Finding]:
    if measured.normals is None:
        return
    feet = alignment.feet
    stated = stated_normals(feet, alignment.frame.turn, measured.normals)
    largest, limit = math.degrees(stated.largest.value), math.degrees(TELLING)
    place = stated.largest.place
    if stated.radial:
        share = float(np.max(false_share(radius_angles(feet))))
        sentence = (
            f"the normals of the file point along the radius, up to {largest:.3g} deg off the"
            " true ones"
            f" at cam angle {cam_angle(place)} deg: if the ball was compensated along them, the"
            f" flank seems to have up to {share:.3g} mm too much material per mm of the ball's"
            " radius; measure with the normals of camgeo probe, or inspect the ball's centres with"
            " --ball"
        )
        yield Finding("radial-normals", "warning", sentence, largest, limit, "deg", place)
    elif stated.largest.value > TELLING:
        sentence = (
            f"the normals of the file are up to {largest:.3g} deg off the true ones,"
            f" {at_cam_angles(place)}"
        )
        yield Finding("normals", "warning", sentence, largest, limit, "deg", place)
    else:
        sentence = f"the normals of the file are within {small(largest, 'deg')} of the true ones"
        yield Finding("normals", "ok", sentence, largest, limit, "deg", place)
    if stated.into_material:
        yield Finding(
            "normals-inward", "warning", "the normals of the file point into the material", None
        )


# -- measured -------------------------------------------------------------------------------------
# Measured points from a CSV file: x, y and, if it has them, normals nx, ny.


FEWEST: Final = 12
MOST: Final = 50_000

NORMALS: Final = (NumberColumn("nx", ("nx", "i")), NumberColumn("ny", ("ny", "j")))

POINT_COLUMNS: Final = RequestedColumns(LENGTHS, NORMALS, FEWEST, MOST)


@dataclass(frozen=True, slots=True, eq=False)
class MeasuredPoints(Pickled):
    """Points as measured.

    Attributes
    ----------
    points : (n,) complex [mm].
    normals : (n,) complex, as stated, of any length but 0; None if there are none.
    """

    points: ComplexArray
    normals: ComplexArray | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "points", frozen(self.points, np.complex128))
        if self.normals is not None:
            object.__setattr__(self, "normals", frozen(self.normals, np.complex128))


def read_points(data: bytes | str, file: str, unit: LengthUnit = "mm") -> MeasuredPoints:
    """Read measured points.

    The format is that of `camgeo.numeric.columns`: x and y, or x, y, nx and ny; a heading may have
    further columns and may call the normals i and j, and may state mm or inch in brackets.

    Parameters
    ----------
    unit : of a file whose heading states none.

    Raises
    ------
    GeometryError
        With file and line, if the table is not as described, x and y have different units, a
        coordinate is too large or a normal is zero, or there are fewer than 12 different points.
    """
    columns = read_columns(data, file, POINT_COLUMNS)
    points = measured_points(columns, file, unit)
    stated = columns.values[len(LENGTHS) :]
    if len(np.unique(points)) < FEWEST:
        message = f"fewer than {FEWEST} different points; allowed: {FEWEST} or more"
        raise fault(file, columns.lines[-1], "", message)
    if not len(stated):
        return MeasuredPoints(points)
    # A normal of no length stays 0 here and is refused below, where its line is known.
    size = np.hypot(*stated)
    normals = np.divide(stated[0] + 1j * stated[1], size, out=np.zeros_like(points), where=size > 0)
    if not np.all(size > 0.0):
        row = int(np.flatnonzero(size == 0.0)[0])
        raise fault(file, columns.lines[row], "", "a normal of no length; allowed: a direction")
    return MeasuredPoints(points, normals)


# -- document -------------------------------------------------------------------------------------
# The keys of its JSON document.


DEVIATION: Final = Key(
    "A largest or smallest deviation.",
    {
        "value_mm": Key("Positive where there is more material.", of="value"),
        "cam_angle_deg": Key("Cam angle of the value.", of="place"),
    },
)

ERROR: Final = Key(
    "A largest or smallest error of the lift.",
    {
        "value": "The error, in the unit of the lift.",
        "cam_angle_deg": Key("Cam angle of the value.", of="place"),
    },
)

LIFT: Final = Key(
    "The lift on the measured disc less that on the exact one.",
    {
        "of": Key(
            "Whose lift: that of the rocker of a linkage, or of the follower.",
            of="member",
            type=Literal["follower", "rocker"],
        ),
        "unit": Key('Unit of the lift, "deg" for a swing.', type=Literal["mm", "inch", "deg"]),
        "largest": Key("A largest or smallest error of the lift.", ERROR, of="extremes.highest"),
        "smallest": Key("A largest or smallest error of the lift.", ERROR, of="extremes.lowest"),
        "uncertainty": Key(
            "Uncertainty of the error of the larger magnitude, from that of the deviations; null if"
            " it has no bound.",
            type=float | None,
        ),
    },
)

DOCUMENT: Final = Key(
    "A measured flank compared with the exact one. Deviations are positive where there is more"
    " material than there should be.",
    {
        "scene": SCENE,
        "name": Key("Name of the disc, the stem of its files.", of="disc.name"),
        "flank": "The measured flank.",
        "file": "Name of the file with the points.",
        "count": "Number of its points.",
        "ball_mm": "Radius of the ball whose centres the points are; 0 for points of the flank.",
        "align": Key(
            "What was fitted: nothing, the rotation about the cam axis, or shift and rotation.",
            type=Literal["datum", "rotation", "free"],
        ),
        "robust": "Whether the fit disregards local form errors.",
        "confidence": "Confidence level of each uncertainty.",
        "tolerance_mm": (
            "Profile tolerance: width of the zone about the flank that must hold all points; null"
            " if not stated."
        ),
        "shift_mm": (
            "Shift of the part in the axes of the measurement, x and y; null if not fitted."
        ),
        "shift_uncertainty_mm": Key(
            "Uncertainty of x and y, from the scatter of the residuals; null if not fitted.",
            of="alignment.shift_uncertainty",
        ),
        "turn_deg": (
            "Rotation of the part in the axes of the measurement, counter-clockwise positive; null"
            " if not fitted."
        ),
        "turn_uncertainty_deg": Key(
            "Uncertainty from the scatter of the residuals; null if not fitted, or if the flank"
            " is too nearly circular to show the rotation.",
            of="alignment.turn_uncertainty",
        ),
        "delay_deg": (
            "Cam angle by which the motion is late because the part is rotated; null if not fitted."
        ),
        "deviation": Key(
            "Deviations of the points from the exact flank.",
            {
                "largest": Key(
                    "A largest or smallest deviation.", DEVIATION, of="extremes.highest"
                ),
                "smallest": Key(
                    "A largest or smallest deviation.", DEVIATION, of="extremes.lowest"
                ),
                "profile_mm": (
                    "Width of the zone about the flank, half of it on each side, that holds all"
                    " points."
                ),
                "root_mean_square_mm": "Root mean square of all deviations.",
                "scatter_mm": (
                    "Standard deviation of a single reading, from each deviation and its"
                    " neighbours."
                ),
                "uncertainty_mm": (
                    "Uncertainty within which all deviations are known at once, from the scatter"
                    " alone."
                ),
                "gap": Key(
                    "The widest range of the flank without a point.",
                    {
                        "width_deg": Key("Width of the range in cam angle.", of="width"),
                        "cam_angle_deg": Key("Cam angle at which the range begins.", of="place"),
                    },
                    of="widest",
                ),
            },
            of="deviations",
        ),
        "lift": Key(
            "Effect of the deviations on the follower, pressed on the measured disc; null if that"
            " cannot be determined, see the findings.",
            LIFT,
        ),
        "findings": Key("All findings, worst first.", FINDING),
    },
    type=Inspection,
)


# -- rendering ------------------------------------------------------------------------------------
# The answer of `camgeo inspect` in words, as a table and as a picture.


ALIGNED: Final = {
    "datum": "as measured from the datum",
    "rotation": "turned to fit",
    "free": "shifted and turned to fit",
}


def text(answer: Inspection) -> str:
    """The deviations, the frame that was fitted, and what the follower does."""
    points = counted(answer.count, "point" if answer.ball == 0.0 else "centre")
    head = f"{answer.disc.name}: {points} of the {answer.flank} flank, {answer.file}"
    deviations, sure = answer.deviations, f"{100.0 * answer.confidence:g} %"
    scatter = f"{small(deviations.scatter, 'mm')} of a reading; all deviations within"
    lines = [
        f"{head}, {_fitted(answer)}",
        named_line("more material", small_extreme(deviations.extremes.highest, "mm")),
        named_line("less material", small_extreme(deviations.extremes.lowest, "mm")),
        named_line("profile", f"{small(deviations.profile, 'mm')}, twice the larger of the two"),
        named_line("root mean square", small(deviations.root_mean_square, "mm")),
        named_line("scatter", f"{scatter} {small(deviations.uncertainty, 'mm')} ({sure})"),
    ]
    alignment = answer.alignment
    if (shift := answer.shift) is not None and alignment.shift_uncertainty is not None:
        for name, value, uncertainty in zip(
            "xy", (shift.real, shift.imag), alignment.shift_uncertainty, strict=True
        ):
            bound = f"± {small(uncertainty, 'mm')} ({sure})"
            lines.append(
                named_line(f"shift in {name}", f"{small(value, 'mm', signed=True)} {bound}")
            )
    if answer.turn is not None and alignment.turn_uncertainty is not None:
        uncertainty = math.degrees(alignment.turn_uncertainty)
        bound = (
            f"± {small(uncertainty, 'deg')} ({sure})" if math.isfinite(uncertainty) else "± unknown"
        )
        turn = small(math.degrees(answer.turn), "deg", signed=True)
        delay = math.degrees(answer.delay or 0.0)
        when = f"the motion comes {small(abs(delay), 'deg')} {'late' if delay > 0.0 else 'early'}"
        lines.append(named_line("turn", f"{turn} {bound}; {when}"))
    if answer.lift is not None:
        lines += _lift_lines(answer.lift, sure)
    return "\n".join([*lines, *finding_lines(answer.findings)])


def table(answer: Inspection) -> Table:
    """One row for each measured point, in the order of the path: its foot on the exact flank, the
    true normal, the deviation and the error of the lift there, in the unit of the scene.
    """
    unit, places = answer.scene.unit, answer.deviations.places
    mm = MM_PER[unit]
    columns = {
        "phi [deg]": np.degrees(places.phi),
        f"x [{unit}]": places.points.real / mm,
        f"y [{unit}]": places.points.imag / mm,
        "nx": places.normals.real,
        "ny": places.normals.imag,
        f"deviation [{unit}]": answer.deviations.values / mm,
    }
    if (lift := answer.lift) is not None:
        # The errors are known at these very angles, among others: the search only finds them again.
        index = np.searchsorted(lift.errors.phi, places.phi)
        columns[f"lift error [{lift.unit}]"] = lift.errors.errors[index] * lift.factor
    return Table(tuple(columns), np.column_stack(tuple(columns.values())))


def figure(answer: Inspection) -> Figure:
    """Deviations and lift errors over the cam angle."""
    from camgeo.pictures.deviations import inspection_figure

    mm, lift = MM_PER[answer.scene.unit], answer.lift
    return inspection_figure(
        answer.deviations,
        None if lift is None else lift.errors,
        title=f"{answer.disc.name}: {answer.flank} flank, {answer.file}, {_fitted(answer)}",
        unit=(answer.scene.unit, 1.0 / mm),
        lift_unit=("", 1.0) if lift is None else (lift.unit, lift.factor),
        tolerance=answer.tolerance,
        joints=answer.disc.cam.drive.joints,
    )


def _fitted(answer: Inspection) -> str:
    return ALIGNED[answer.align] + ", disregarding local errors" * answer.robust


def _lift_lines(lift: LiftEffect, sure: str) -> list[str]:
    low, high = lift.extremes.lowest, lift.extremes.highest
    return [
        named_line("lift error", f"{small_extreme(high, lift.unit)}, of the {lift.member}"),
        named_line(
            "", f"{small_extreme(low, lift.unit)}; ± {small(lift.uncertainty, lift.unit)} ({sure})"
        ),
    ]


# -- command line ----------------------------------------------------------------------------------


EXAMPLE: Final = (
    "camgeo inspect my-cam.toml measured.csv --tolerance 0.02\n"
    "  camgeo inspect my-cam.toml centres.csv --ball 1.5 -o deviations.png\n"
    "  camgeo inspect my-cam.toml measured.csv --align free --json"
)


ARGUMENTS: Final = (
    SCENE_FILE,
    Argument(
        "measured",
        metavar="MEASURED",
        help="points (CSV: x, y, optionally nx, ny) in the axes of the scene's cam; a name that"
        " ends"
        " in -return stands for the return disc of a conjugate pair, in -inner or -outer for that"
        " flank",
    ),
    Argument(
        "--align",
        choices=tuple(map(str, Align)),
        default=str(Align.DATUM),
        help="what to fit: nothing (the points were measured from bore and key), the rotation about"
        " the cam axis, or shift and rotation; a fit hides eccentricity and phase; default"
        " %(default)s",
    ),
    Argument(
        "--robust",
        action="store_true",
        help="with a fit: disregard local form errors, which would distort the least squares",
    ),
    Argument(
        "--unit",
        choices=("mm", "inch"),
        help="unit of MEASURED, if it does not state one; default the scene's",
    ),
    Argument(
        "--flank", choices=tuple(map(str, Flank)), help="flank; default by the name, or the scene's"
    ),
    Argument(
        "--ball",
        metavar="MM",
        type=non_negative,
        default=0.0,
        help="the points are centres of a ball of this radius",
    ),
    Argument(
        "--tolerance",
        metavar="MM",
        type=positive,
        help="profile tolerance: width of the zone about the flank that must hold all points",
    ),
    *TABLE_OR_PICTURE,
)


def run(arguments: argparse.Namespace) -> int:
    """Compare, and print or write the results."""
    if arguments.robust and arguments.align == Align.DATUM:
        raise CallError("--robust: allowed with --align rotation or free only")
    answer = inspect(
        opened(arguments),
        arguments.measured,
        arguments.flank,
        align=arguments.align,
        robust=arguments.robust,
        unit=arguments.unit,
        ball=arguments.ball,
        tolerance=arguments.tolerance,
    )
    return show(answer, arguments, contents="deviations, lift errors")
