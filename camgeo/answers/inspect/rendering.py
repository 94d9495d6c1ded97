"""What `camgeo inspect` finds, in words, as a table and as a picture."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final

import numpy as np

from camgeo.answers.answer import finding_lines
from camgeo.answers.inspect import Inspection, LiftEffect
from camgeo.numeric.extremes import Extreme
from camgeo.product.value_table import Table
from camgeo.units import MM_PER
from camgeo.wording import at_cam_angles, counted, small

if TYPE_CHECKING:
    from camgeo.figure.model import Figure

WIDTH: Final = 22
"""Of the names."""

ALIGNED: Final = {
    "datum": "as measured from the datum",
    "rotation": "turned to fit",
    "free": "shifted and turned to fit",
}


def text(answer: Inspection) -> str:
    """The deviations, the frame that was fitted, and what the follower does."""
    points = counted(answer.count, "point" if answer.ball == 0.0 else "centre")
    head = f"{answer.disc.name}: {points} of the {answer.flank} flank, {answer.file}"
    found, sure = answer.deviations, f"{100.0 * answer.confidence:g} %"
    lines = [f"{head}, {_fitted(answer)}"]
    low, high = found.extremes.lowest, found.extremes.highest
    lines.append(_line("more material", _at(high, "mm")))
    lines.append(_line("less material", _at(low, "mm")))
    lines.append(_line("profile", f"{small(found.profile, 'mm')}, twice the larger of the two"))
    lines.append(_line("root mean square", small(found.root_mean_square, "mm")))
    scatter = f"{small(found.scatter, 'mm')} of a reading; all deviations within"
    lines.append(_line("scatter", f"{scatter} {small(found.uncertainty, 'mm')} ({sure})"))
    alignment = answer.alignment
    if (shift := answer.shift) is not None and alignment.shift_uncertainty is not None:
        for name, value, off in zip(
            "xy", (shift.real, shift.imag), alignment.shift_uncertainty, strict=True
        ):
            within = f"± {small(off, 'mm')} ({sure})"
            lines.append(_line(f"shift in {name}", f"{small(value, 'mm', signed=True)} {within}"))
    if answer.turn is not None and alignment.turn_uncertainty is not None:
        off = math.degrees(alignment.turn_uncertainty)
        within = f"± {small(off, 'deg')} ({sure})" if math.isfinite(off) else "± unknown"
        turn = small(math.degrees(answer.turn), "deg", signed=True)
        delay = math.degrees(answer.delay or 0.0)
        when = f"the motion comes {small(abs(delay), 'deg')} {'late' if delay > 0.0 else 'early'}"
        lines.append(_line("turn", f"{turn} {within}; {when}"))
    if answer.lift is not None:
        lines += _lift_lines(answer.lift, sure)
    return "\n".join([*lines, *finding_lines(answer.findings)])


def table(answer: Inspection) -> Table:
    """One row for each place measured, in the order of the path: its foot on the exact flank, the
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
        index = np.searchsorted(lift.errors.phi, places.phi)
        columns[f"lift error [{lift.unit}]"] = lift.errors.errors[index] * lift.factor
    return Table(tuple(columns), np.column_stack(tuple(columns.values())))


def figure(answer: Inspection) -> Figure:
    """Deviations and lift errors over the cam angle."""
    from camgeo.figure import inspection

    mm, lift = MM_PER[answer.scene.unit], answer.lift
    return inspection.figure(
        answer.deviations,
        None if lift is None else lift.errors,
        title=f"{answer.disc.name}: {answer.flank} flank, {answer.file}, {_fitted(answer)}",
        unit=(answer.scene.unit, 1.0 / mm),
        lift_unit=("", 1.0) if lift is None else (lift.unit, lift.factor),
        tolerance=answer.tolerance,
        joints=answer.disc.cam.drive.joints,
    )


def _fitted(answer: Inspection) -> str:
    return ALIGNED[answer.align] + ", but for local errors" * answer.robust


def _lift_lines(lift: LiftEffect, sure: str) -> list[str]:
    low, high = lift.extremes.lowest, lift.extremes.highest
    return [
        _line("lift error", f"{_at(high, lift.unit)}, of the {lift.of}"),
        _line("", f"{_at(low, lift.unit)}; ± {small(lift.uncertainty, lift.unit)} ({sure})"),
    ]


def _line(name: str, text: str) -> str:
    return f"{name:{WIDTH}}{text}"


def _at(extreme: Extreme, unit: str) -> str:
    return f"{small(extreme.value, unit, signed=True)} {at_cam_angles(extreme.place)}"
