"""The answer of `camgeo size` in words and for JSON."""

from __future__ import annotations

import math
from typing import Any

from camgeo.check.sizing.smallest import Active, Rating, Sizing
from camgeo.check.sizing.task import Task
from camgeo.cli.command import identity
from camgeo.design import Design
from camgeo.units import MM_PER

WIDTH = 24
"""Of the first column."""

CELL = 15


def lines(design: Design, task: Task, sizing: Sizing, present: Rating | None) -> list[str]:
    """What is printed; lengths in the unit of the scene, angles in degrees."""
    second = task.second
    head = (f"r_G [{design.scene.unit}]", f"{second} [{design.scene.unit}]", "mu [deg]", "at [deg]")
    required = (
        f"required: transmission angle at least {math.degrees(sizing.angle):g} deg,"
        f" r_R/r_K at most {sizing.ratio:g}"
    )
    found = [
        required,
        f"{'':{WIDTH}}" + "".join(f"{cell:>{CELL}}" for cell in (*head, "r_R/r_K", "at [deg]")),
        _row(design, "present design", task, present),
        _row(design, "Flocke", task, sizing.flocke),
        _row(design, "mu alone, exact", task, sizing.for_angle),
        _row(design, "smallest, exact", task, sizing.answer),
    ]
    arm, present_arm = (getattr(each.cam.follower, "arm", 0.0) for each in (task, design))
    if arm != present_arm:
        told = f"{arm / MM_PER[design.scene.unit]:.4f} {design.scene.unit}"
        found.append(f"all but the present design with an arm of {told}")
    if sizing.answer is not None:
        found.append("decided by " + " and ".join(_active(each, sizing) for each in sizing.active))
    else:
        found.append(reason(design, sizing))
    return [*found, *_of_flocke(sizing)]


def reason(design: Design, sizing: Sizing) -> str:
    """Why there is no answer, and what there is instead."""
    if sizing.for_angle is None:
        nearest = math.degrees(sizing.nearest_angle or 0.0)
        return (
            f"infeasible: no place of the cam axis keeps a transmission angle of"
            f" {math.degrees(sizing.angle):g} deg over the whole turn, for the swing is too large;"
            f" the largest that can be kept is {math.floor(nearest * 1e4) / 1e4:.4f} deg"
        )
    reach = sizing.reach or 0.0
    sure = "there is no place" if sizing.none_below > reach else "no place was found"
    told = (
        "infeasible: where the transmission angle is kept, the roller is too large for the"
        f" curvature of the pitch curve; {sure} with r_R/r_K at most {sizing.ratio:g} up to a base"
        f" radius of {reach / MM_PER[design.scene.unit]:.4g} {design.scene.unit}"
    )
    if sizing.nearest_ratio is None:
        return told
    return f"{told}; the least that was found is about {sizing.nearest_ratio:.3g}"


def _of_flocke(sizing: Sizing) -> list[str]:
    """Where Flocke's proposal is too large, and where it promises too much."""
    if sizing.flocke is None:
        return [
            "Flocke's region is empty: it asks for the largest velocities at both end positions"
        ]
    found = []
    if sizing.for_angle is not None:
        more = sizing.flocke.base_radius / sizing.for_angle.base_radius - 1.0
        found.append(
            f"Flocke's base circle is {more:.0%} larger than the transmission angle needs: it asks"
            " for the largest velocities at both end positions"
        )
    ratio, phi = sizing.flocke.radius_ratio
    if ratio > sizing.ratio:
        found.append(
            f"Flocke's proposal is optimistic: it knows no curvature, and has r_R/r_K = {ratio:.4g}"
            f" at cam angle {math.degrees(phi):.4f} deg, above {sizing.ratio:g}"
        )
    return found


def _row(design: Design, name: str, task: Task, rating: Rating | None) -> str:
    if rating is None:
        return f"{name:{WIDTH}}{'none':>{CELL}}"
    unit = MM_PER[design.scene.unit]
    mu, at = rating.transmission_angle
    ratio, where = rating.radius_ratio
    second = task.second_of(rating.place) / unit + 0.0
    cells = (
        f"{rating.base_radius / unit:.4f}", f"{second:.4f}",
        f"{math.degrees(mu):.4f}", f"{math.degrees(at):.3f}",
        f"{ratio:.4f}", f"{math.degrees(where):.3f}",
    )  # fmt: skip
    return f"{name:{WIDTH}}" + "".join(f"{cell:>{CELL}}" for cell in cells)


def _active(active: Active, sizing: Sizing) -> str:
    at = f"at cam angle {math.degrees(active.cam_angle):.4f} deg"
    if active.name == "transmission-angle":
        return f"the transmission angle of {math.degrees(sizing.angle):g} deg {at}"
    return f"r_R/r_K of {sizing.ratio:g} {at}"


# JSON ---------------------------------------------------------------------------------------------


def document(design: Design, task: Task, sizing: Sizing, present: Rating | None) -> dict[str, Any]:
    """The answer for JSON; lengths in mm, angles in degrees."""
    return {
        **identity(design.scene),
        "required": {
            "transmission_angle_deg": math.degrees(sizing.angle),
            "radius_ratio": sizing.ratio,
        },
        "present": _record(task, present),
        "flocke": _record(task, sizing.flocke),
        "transmission_angle_alone": _record(task, sizing.for_angle),
        "smallest": _record(task, sizing.answer),
        "active": [
            {"condition": each.name, "cam_angle_deg": math.degrees(each.cam_angle)}
            for each in sizing.active
        ],
        "infeasible": None if sizing.answer is not None else reason(design, sizing),
        "nearest": {
            "transmission_angle_deg": None
            if sizing.nearest_angle is None
            else math.degrees(sizing.nearest_angle),
            "radius_ratio": sizing.nearest_ratio,
        },
    }


def _record(task: Task, rating: Rating | None) -> dict[str, Any] | None:
    if rating is None:
        return None
    record: dict[str, Any] = {"base_radius_mm": rating.base_radius}
    record |= task.record(rating.place)
    mu, at = rating.transmission_angle
    ratio, where = rating.radius_ratio
    record["transmission_angle_deg"] = {
        "value": math.degrees(mu),
        "cam_angle_deg": math.degrees(at),
    }
    record["radius_ratio"] = {"value": ratio, "cam_angle_deg": math.degrees(where)}
    return record
