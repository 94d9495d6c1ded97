"""What `camgeo size` finds, in words and as a picture."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from camgeo.answers.size import CamSize
from camgeo.check.sizing.smallest import Active, Rating, Sizing
from camgeo.units import MM_PER

if TYPE_CHECKING:
    from camgeo.figure.model import Figure

WIDTH = 24
"""Of the first column."""

CELL = 15

VELOCITIES = "it assumes the largest velocities at both end positions"


def text(answer: CamSize) -> str:
    """The requirement, and one row per design; lengths in the scene's unit, angles in degrees."""
    task, sizing, unit = answer.task, answer.sizing, answer.scene.unit
    angle = f"transmission angle at least {math.degrees(sizing.angle):g} deg"
    head = (f"r_G [{unit}]", f"{task.second} [{unit}]", "mu [deg]", "at [deg]")
    lines = [
        f"required: {angle}, r_R/r_K at most {sizing.ratio:g}",
        f"{'':{WIDTH}}" + "".join(f"{cell:>{CELL}}" for cell in (*head, "r_R/r_K", "at [deg]")),
        _row(answer, "present design", answer.present),
        _row(answer, "Flocke", sizing.flocke),
        _row(answer, "mu alone, exact", sizing.for_angle),
        _row(answer, "smallest, exact", sizing.answer),
    ]
    arms = [getattr(each, "arm", 0.0) for each in (task.follower, answer.scene.follower)]
    if arms[0] != arms[1]:
        length = f"{arms[0] / MM_PER[unit]:.4f} {unit}"
        lines.append(f"all but the present design have an arm of {length}")
    decided = "decided by " + " and ".join(_active(each, sizing) for each in sizing.active)
    return "\n".join([*lines, answer.infeasible or decided, *_of_flocke(sizing)])


def figure(answer: CamSize) -> Figure:
    """Where the cam axis may lie."""
    from camgeo.figure import size

    return size.figure(answer.scene.name, answer.task, answer.sizing)


def _of_flocke(sizing: Sizing) -> list[str]:
    """Where Flocke's proposal is too large, and where it is too optimistic."""
    if sizing.flocke is None:
        return [f"Flocke's region is empty: {VELOCITIES}"]
    found = []
    if sizing.for_angle is not None:
        more = sizing.flocke.base_radius / sizing.for_angle.base_radius - 1.0
        found.append(
            f"Flocke's base circle is {more:.0%} larger than the transmission angle needs:"
            f" {VELOCITIES}"
        )
    largest = sizing.flocke.radius_ratio
    if largest.value > sizing.ratio:
        found.append(
            "Flocke's proposal is optimistic: it ignores curvature, and has r_R/r_K ="
            f" {largest.value:.4g} at cam angle {math.degrees(largest.place):.4f} deg, above"
            f" {sizing.ratio:g}"
        )
    return found


def _row(answer: CamSize, name: str, rating: Rating | None) -> str:
    if rating is None:
        return f"{name:{WIDTH}}{'none':>{CELL}}"
    unit = MM_PER[answer.scene.unit]
    angle, ratio = rating.transmission_angle, rating.radius_ratio
    cells = (
        f"{rating.base_radius / unit:.4f}",
        f"{answer.task.second_of(rating.place) / unit + 0.0:.4f}",
        f"{math.degrees(angle.value):.4f}",
        f"{math.degrees(angle.place):.3f}",
        f"{ratio.value:.4f}",
        f"{math.degrees(ratio.place):.3f}",
    )
    return f"{name:{WIDTH}}" + "".join(f"{cell:>{CELL}}" for cell in cells)


def _active(active: Active, sizing: Sizing) -> str:
    at = f"at cam angle {math.degrees(active.cam_angle):.4f} deg"
    if active.name == "transmission-angle":
        return f"the transmission angle of {math.degrees(sizing.angle):g} deg {at}"
    return f"r_R/r_K of {sizing.ratio:g} {at}"
