"""What `camgeo size` finds, in words and as a picture."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from camgeo.answers.size import CamSize
from camgeo.check.sizing.face_task import FaceTask
from camgeo.check.sizing.smallest import Active, Rating, Sizing
from camgeo.check.sizing.task import Task
from camgeo.units import MM_PER

if TYPE_CHECKING:
    from camgeo.figure.model import Figure

WIDTH = 28
"""Of the first column."""

CELL = 15

VELOCITIES = "it assumes the largest velocities at both end positions"


def text(answer: CamSize) -> str:
    """The requirement, and one row per design; lengths in the scene's unit, angles in degrees."""
    sizing, best = answer.sizing, answer.best
    lines = [
        f"required: {_required(answer)}",
        f"{'':{WIDTH}}" + "".join(f"{cell:>{CELL}}" for cell in _head(answer)),
        _row(answer, "present design", answer.present),
    ]
    if sizing.construction is not None:
        own = answer.own.sizing
        lines += [
            _row(answer, "Flocke", own.flocke),
            _row(answer, "mu alone, exact", own.for_angle),
        ]
    lines.append(_row(answer, "smallest", best.written))
    for side in answer.sides:
        if side is not best:
            own_side = side is answer.own
            name = f"smallest on {'its present' if own_side else 'the other'} side"
            lines.append(_row(answer, name, side.written))
    return "\n".join(
        [
            *lines,
            *_changed(answer),
            answer.infeasible or _decided(sizing),
            *_proved(answer),
            *(f"camgeo check finds in that scene: {each.sentence}" for each in answer.remarks),
            *_of_flocke(answer.own.sizing),
        ]
    )


def figure(answer: CamSize) -> Figure:
    """Where the cam axis may lie."""
    name = answer.scene.name
    faces = [(e.task, e.sizing) for e in answer.sides if isinstance(e.task, FaceTask)]
    if faces:
        from camgeo.figure import size_face  # few cams have a flat face

        return size_face.figure(name, faces, answer.scene.unit)
    from camgeo.figure import size

    sides = [(e.task, e.sizing) for e in answer.sides if isinstance(e.task, Task)]
    return size.figure(name, sides, answer.scene.unit)


def _required(answer: CamSize) -> str:
    sizing, unit = answer.sizing, answer.scene.unit
    angle = f"transmission angle at least {math.degrees(sizing.angle):g} deg"
    if sizing.radius is None:
        return f"{angle}, r_R/r_K at most {sizing.ratio:g}, no undercut"
    if sizing.radius == 0.0:
        return f"{angle}, a convex cam"
    radius = f"{sizing.radius / MM_PER[unit]:g} {unit}"
    return f"{angle}, a convex cam with radii of curvature of at least {radius}"


def _head(answer: CamSize) -> tuple[str, ...]:
    unit = answer.scene.unit
    last = "r_R/r_K" if answer.sizing.radius is None else f"rho [{unit}]"
    second = f"{answer.task.second} [{unit}]"
    return f"r_G [{unit}]", second, "mu [deg]", "at [deg]", last, "at [deg]"


def _row(answer: CamSize, name: str, rating: Rating | None) -> str:
    if rating is None:
        return f"{name:{WIDTH}}{'none':>{CELL}}"
    unit = MM_PER[answer.scene.unit]
    angle, last, per = rating.transmission_angle, rating.radius_ratio, 1.0
    if rating.radius_of_curvature is not None:
        last, per = rating.radius_of_curvature, unit
    digits = 4 if unit == 1.0 else 5
    cells = (
        f"{rating.base_radius / unit:.{digits}f}",
        f"{answer.task.second_of(rating.place) / unit + 0.0:.{digits}f}",
        f"{math.degrees(angle.value):.4f}",
        f"{math.degrees(angle.place):.3f}",
        f"{last.value / per:.4f}",
        f"{math.degrees(last.place):.3f}",
    )
    return f"{name:{WIDTH}}" + "".join(f"{cell:>{CELL}}" for cell in cells)


def _changed(answer: CamSize) -> list[str]:
    """What is not as in the present design, besides the sizes of the rows."""
    found, best, own = [], answer.best, answer.own
    unit = answer.scene.unit
    if best is not own and best.sizing.answer is not None:
        change = f'the smallest has follower.arm_side = "{best.arm_side}", not "{own.arm_side}"'
        if answer.scene.linkage is not None:
            change += ", where the linkage moves the follower the other way, inward for outward"
        found.append(change)
    arms = [getattr(each, "arm", 0.0) for each in (best.task.follower, answer.scene.follower)]
    if arms[0] != arms[1]:
        length = f"{arms[0] / MM_PER[unit]:.4f} {unit}"
        found.append(f"all but the present design have an arm of {length}")
    written = best.written
    if written is not None and written.face is not None:
        low, high = (each.value / MM_PER[unit] for each in written.face)
        needed = f"the contact runs over the face from {low:.4f} to {high:.4f} {unit}"
        longer = best.made.lengths.get("face") if best.made is not None else None
        if longer is not None:
            needed += f", which needs follower.face = {longer}"
        found.append(needed)
    return found


def _decided(sizing: Sizing) -> str:
    return "decided by " + " and ".join(_active(each, sizing) for each in sizing.active)


def _active(active: Active, sizing: Sizing) -> str:
    at = f"at cam angle {math.degrees(active.cam_angle):.4f} deg"
    what = {
        "transmission-angle": f"the transmission angle of {math.degrees(sizing.angle):g} deg",
        "radius-ratio": f"r_R/r_K of {sizing.ratio:g}",
        "global-undercut": "two sides of a flank that touch each other (global undercut)",
        "roller-over-axis": "the roller, which reaches the cam axis",
        "convexity": "the radius of curvature",
        "face-over-axis": "the face, which reaches the cam axis",
    }
    return f"{what[active.name]} {at}"


def _proved(answer: CamSize) -> list[str]:
    """What is known of anything smaller."""
    side, proof = answer.best, answer.proof
    sizing, unit = side.sizing, MM_PER[side.unit]
    if sizing.answer is None:
        return []
    if side.made is None:
        return [
            "no sizes near this limit pass the checks when they are rounded up: none is written"
        ]
    limit = f"{sizing.answer.base_radius / unit:.9g} {side.unit}"
    if sizing.radius == 0.0 and any(each.name == "convexity" for each in sizing.active):
        blunt = "; its radius of curvature comes down to 0: --radius-of-curvature asks for more"
    else:
        blunt = ""
    if proof.exact:
        return [f"the limit is {limit}, exactly: nothing smaller keeps all of this{blunt}"]
    below = math.floor(proof.none_below / unit * 1e4) / 1e4
    gap = sizing.answer.base_radius / unit - below
    known = f"nothing below {below:.4f} {side.unit} keeps all of this"
    within = f"so that the smallest is known within {gap:.2g} {side.unit}"
    return [f"the limit found is {limit}; it is proved that {known}, {within}"]


def _of_flocke(sizing: Sizing) -> list[str]:
    """Where Flocke's proposal is too large, and where it is too optimistic."""
    if sizing.construction is None:
        return []
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
