"""What `camgeo probe` finds, in words and as tables."""

from __future__ import annotations

import math
from decimal import Decimal

import numpy as np

from camgeo.answers.answer import finding_lines
from camgeo.answers.probe import STEP, ProbedFlank, Probing
from camgeo.numeric.arrays import FloatArray
from camgeo.product.value_table import Table, cam_angles
from camgeo.units import MM_PER
from camgeo.wording import at_cam_angles, counted


def text(answer: Probing) -> str:
    """The points of each flank, summed up."""
    lines = []
    for each in answer.flanks:
        spaced = "evenly along it" if answer.step is None else f"every {answer.step} deg"
        lines.append(
            f"{each.disc.name}: {counted(each.count, 'point')} of the {each.flank} flank, {spaced},"
            f" {each.length:.6g} mm long"
        )
        off = each.off_radius
        lines.append(
            f"        {'normals':26}up to {math.degrees(off.value):.4g} deg off the radius,"
            f" {at_cam_angles(off.place)}"
        )
        lines += finding_lines(each.findings)
    return "\n".join(lines)


def table(answer: Probing) -> Table:
    """The points of the first flank: a curve in the plane with its normals, out of the material."""
    return flank_table(answer, answer.flanks[0])


def flank_table(answer: Probing, flank: ProbedFlank) -> Table:
    """The points of one flank, in the unit of the scene.

    `upper` and `lower` are the deviations allowed, positive for more material.
    """
    unit, places = answer.scene.unit, flank.points.places
    mm = MM_PER[unit]
    columns = {
        "phi [deg]": _degrees(places.phi, answer.step),
        f"x [{unit}]": places.points.real / mm,
        f"y [{unit}]": places.points.imag / mm,
        "nx": places.normals.real,
        "ny": places.normals.imag,
        _lift(answer): _scaled(answer, flank.lifts),
    }
    if answer.ball > 0.0:
        columns[f"ball x [{unit}]"] = flank.points.centres.real / mm
        columns[f"ball y [{unit}]"] = flank.points.centres.imag / mm
    if answer.tolerance is not None:
        half = np.full(flank.count, 0.5 * answer.tolerance / mm)
        columns[f"upper [{unit}]"], columns[f"lower [{unit}]"] = half, -half
    return Table(tuple(columns), np.column_stack(tuple(columns.values())))


def lift_table(answer: Probing) -> Table:
    """The lift curve."""
    phi, lifts = answer.lift_curve.T
    columns = (_degrees(phi, answer.step or STEP), _scaled(answer, lifts))
    return Table(("phi [deg]", _lift(answer)), np.column_stack(columns))


def _degrees(phi: FloatArray, step: Decimal | None) -> FloatArray:
    """(n,) cam angles [deg]: at a step those that it states, which radians would round twice."""
    if step is None:
        return np.degrees(phi)
    stated = cam_angles(step)
    return stated[np.searchsorted(np.radians(stated), phi)]


def _turns(answer: Probing) -> bool:
    return answer.flanks[0].disc.cam.lift_unit == "rad"


def _lift(answer: Probing) -> str:
    return "psi [deg]" if _turns(answer) else f"s [{answer.scene.unit}]"


def _scaled(answer: Probing, lifts: np.ndarray) -> np.ndarray:
    return np.degrees(lifts) if _turns(answer) else lifts / MM_PER[answer.scene.unit]
