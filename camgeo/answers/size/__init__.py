"""What `camgeo size` finds: the smallest base circle, and the scene with it."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar, Final

from camgeo.answers.answer import BROKEN, FINE, Answer
from camgeo.check.judge import transmission_angle_limit
from camgeo.check.sizing import smallest
from camgeo.check.sizing.arm import size_with_arm
from camgeo.check.sizing.smallest import Rating, Sizing, rate
from camgeo.check.sizing.task import Task, task_of
from camgeo.design import Design
from camgeo.errors import GeometryError
from camgeo.scene.scene import Scene
from camgeo.units import MM_PER

MARGIN: Final = 1e-11
"""Margin [rad, and as a share of the ratio] by which a written scene keeps its limits: at the limit
itself rounding would decide the result of `camgeo check`."""


@dataclass(frozen=True, slots=True)
class CamSize(Answer):
    """How small a cam may be.

    Attributes
    ----------
    scene : of the present design.
    task : what was sized; its follower has the arm that was found, if one was looked for.
    sizing : the requirement, and the smallest cams that meet it.
    present : the present design; None if there is no such mechanism.
    """

    command: ClassVar[str] = "size"

    scene: Scene
    task: Task
    sizing: Sizing
    present: Rating | None

    @property
    def infeasible(self) -> str | None:
        """Why there is no answer, and what there is instead; None if there is one."""
        sizing, unit = self.sizing, self.scene.unit
        if sizing.answer is not None:
            return None
        if sizing.for_angle is None:
            nearest = math.degrees(sizing.nearest_angle or 0.0)
            return (
                f"infeasible: no place of the cam axis keeps a transmission angle of"
                f" {math.degrees(sizing.angle):g} deg over the whole turn, because the swing is too"
                f" large; the largest that can be kept is {math.floor(nearest * 1e4) / 1e4:.4f} deg"
            )
        reach = sizing.reach or 0.0
        sure = "there is no place" if sizing.none_below > reach else "no place was found"
        message = (
            "infeasible: where the transmission angle is kept, the roller is too large for the"
            f" curvature of the pitch curve; {sure} with r_R/r_K at most {sizing.ratio:g} up to a"
            f" base radius of {reach / MM_PER[unit]:.4g} {unit}"
        )
        if sizing.nearest_ratio is None:
            return message
        return f"{message}; the smallest ratio found is about {sizing.nearest_ratio:.3g}"

    @property
    def exit_code(self) -> int:
        """1 if nothing meets the requirement."""
        return FINE if self.infeasible is None else BROKEN


def size(
    design: Design,
    *,
    transmission_angle: float | None = None,
    radius_ratio: float | None = None,
    arms: tuple[float, float] | None = None,
) -> CamSize:
    """Look for the smallest base circle.

    Parameters
    ----------
    transmission_angle : the smallest that is allowed [rad]; None for that of the scene.
    radius_ratio : the largest r_R/r_K that is allowed; None for that of the scene.
    arms : the shortest and the longest arm of a rocker [mm], to look for its arm too.

    Raises
    ------
    GeometryError
        As `check.sizing.smallest.size` and `check.sizing.arm.size_with_arm`, and if the follower
        has no roller.
    """
    task, limits = task_of(design.cam), design.scene.limits
    present = rate(task, task.present)
    angle, ratio = transmission_angle, radius_ratio
    if angle is None:
        angle = transmission_angle_limit(design.cam, limits)
    if ratio is None:
        ratio = limits.radius_ratio
    if arms is None:
        return CamSize(design.scene, task, smallest.size(task, angle, ratio), present)
    return CamSize(design.scene, *size_with_arm(task, angle, ratio, *arms), present)


def sized_scene(found: CamSize) -> Scene:
    """The scene with the sizes that were found, which certainly meets the requirement.

    Raises
    ------
    GeometryError
        If there is no such scene.
    """
    task, sizing = found.task, found.sizing
    kept = smallest.size(task, sizing.angle + MARGIN, sizing.ratio * (1.0 - MARGIN)).answer
    if kept is None:
        raise GeometryError("the requirement can only just be met: no scene surely keeps it")
    lengths = {"base_radius": kept.base_radius, **task.moved(kept.place)}
    if task.held is not None and found.present and task.follower.arm != found.present.follower.arm:
        lengths["arm"] = task.follower.arm
    written = resized(found.scene, lengths)
    again = task_of(Design(written).cam)
    rating = rate(again, again.present)
    if (
        rating is None
        or rating.transmission_angle.value < sizing.angle
        or rating.radius_ratio.value > sizing.ratio
    ):
        raise GeometryError("the scene cannot be written back: rounding breaks its requirement")
    return written


def resized(scene: Scene, lengths: Mapping[str, complex]) -> Scene:
    """The scene with other lengths of its follower [mm], by their keys; points are complex."""

    def stated(length: complex) -> float | list[float]:
        inside = length / MM_PER[scene.unit]
        if isinstance(inside, float):
            return inside + 0.0  # 0, and not -0
        return [inside.real + 0.0, inside.imag + 0.0]

    return scene.with_values({f"follower.{key}": stated(each) for key, each in lengths.items()})
