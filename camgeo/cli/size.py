"""`camgeo size`: the smallest base circle for a transmission angle and a ratio of radii."""

from __future__ import annotations

import argparse
import math
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Final

from camgeo.answers.answer import BROKEN, FINE
from camgeo.check.judge import transmission_angle_limit
from camgeo.check.sizing.arm import size_with_arm
from camgeo.check.sizing.smallest import Sizing, rate, size
from camgeo.check.sizing.task import Task, task_of
from camgeo.cli.command import (
    CallError,
    add_json,
    add_scene,
    opened,
    print_json,
    require_beside,
    tell,
    tell_main_disc,
    write_told,
)
from camgeo.cli.plot import add_picture, drawn
from camgeo.cli.size_told import document, lines
from camgeo.design import Design
from camgeo.errors import Fault, GeometryError, SceneError
from camgeo.units import MM_PER

if TYPE_CHECKING:
    from camgeo.scene.scene import Scene

MARGIN: Final = 1e-11
"""By how much [rad, and as a share of the ratio] a scene that is written keeps its limits: at the
limit itself rounding would decide what `camgeo check` says."""


SUMMARY: Final = (
    "tell the smallest base circle, with offset or pivot, that keeps the limits, and Flocke's"
    " proposal"
)

EXAMPLE: Final = (
    "camgeo size fixtures/scenes/setzhub.toml -o size.png\n"
    "  camgeo size my-cam.toml --transmission-angle 50 --scene my-smaller-cam.toml"
)


def options(parser: argparse.ArgumentParser) -> None:
    """Add those of the command."""
    add_scene(parser)
    parser.add_argument(
        "--transmission-angle",
        metavar="DEG",
        type=float,
        help="smallest allowed, in degrees; default that of the scene",
    )
    parser.add_argument(
        "--radius-ratio",
        metavar="RATIO",
        type=float,
        help="largest allowed r_R/r_K, above 0 to 1; default that of the scene",
    )
    parser.add_argument(
        "--arm",
        nargs=2,
        metavar=("LOW", "HIGH"),
        type=float,
        help="look for the arm of a rocker too, between two lengths in the scene's unit",
    )
    parser.add_argument(
        "--scene",
        metavar="FILE",
        dest="target",
        help="write the scene with the answer's base_radius and offset or pivot",
    )
    add_json(parser)
    add_picture(parser)


def run(arguments: argparse.Namespace) -> int:
    """Print the answer; write picture and scene, both or none."""
    require_beside("--scene", arguments.target, arguments.output)
    if arguments.arm is not None and arguments.output is not None:
        raise CallError(
            "-o draws places for one arm: write the scene with --scene, and draw that one"
        )
    design = opened(arguments)
    tell_main_disc(design, "sizes")
    angle, ratio = _required(design, arguments)
    task = task_of(design.cam)
    present = rate(task, task.present)
    if arguments.arm is not None:
        low, high = (MM_PER[design.scene.unit] * arm for arm in arguments.arm)
        task, sizing = size_with_arm(task, angle, ratio, low, high)
    else:
        sizing = size(task, angle, ratio)
    _write(design, task, sizing, arguments)
    if arguments.json:
        print_json(document(design, task, sizing, present))
    else:
        print("\n".join(lines(design, task, sizing, present)))
    return FINE if sizing.answer is not None else BROKEN


def _required(design: Design, arguments: argparse.Namespace) -> tuple[float, float]:
    """Transmission angle [rad] and ratio that are asked for."""
    angle, ratio = (
        transmission_angle_limit(design.cam, design.scene.limits),
        design.scene.limits.radius_ratio,
    )
    if arguments.transmission_angle is not None:
        angle = math.radians(arguments.transmission_angle)
    if arguments.radius_ratio is not None:
        ratio = arguments.radius_ratio
    return angle, ratio


def _write(design: Design, task: Task, sizing: Sizing, arguments: argparse.Namespace) -> None:
    files = []
    if arguments.target is not None and sizing.answer is not None:
        target = Path(arguments.target)
        scene = _scene(design, task, sizing, arguments, target)
        told = f"base radius {_told(design, sizing.answer.base_radius)}"
        files.append((target, scene, told))
    elif arguments.target is not None:
        tell(f"{arguments.target}: not written, there is no such mechanism")
    if arguments.output is not None:
        from camgeo.figure import size as region

        target = Path(arguments.output)
        picture = drawn(region.figure(design.name, task, sizing), target.suffix)
        files.append((target, picture, "region of the cam axis"))
    write_told(files, force=arguments.force)


def _scene(
    design: Design, task: Task, sizing: Sizing, arguments: argparse.Namespace, target: Path
) -> bytes:
    """The scene with the answer, which keeps its requirement."""
    source = Path(arguments.scene)
    if design.disc.scene_files and target.resolve().parent != source.resolve().parent:
        raise SceneError(
            [Fault("--scene", str(target), "must lie beside SCENE, which reads files there")]
        )
    kept = size(task, sizing.angle + MARGIN, sizing.ratio * (1.0 - MARGIN))
    if kept.answer is None:
        raise GeometryError("the requirement can only just be met: no scene keeps it surely")
    lengths = {"base_radius": kept.answer.base_radius, **task.moved(kept.answer.place)}
    if arguments.arm is not None:
        lengths["arm"] = task.follower.arm
    written = resized(design.scene, lengths)
    again = task_of(Design(written).cam)
    rating = rate(again, again.present)
    if (
        rating is None
        or rating.transmission_angle[0] < sizing.angle
        or rating.radius_ratio[0] > sizing.ratio
    ):
        raise GeometryError("the scene cannot be written back: rounding breaks its requirement")
    return written.to_toml().encode()


def resized(scene: Scene, lengths: Mapping[str, complex]) -> Scene:
    """The scene with other lengths of its follower [mm], by their keys; points are complex."""

    def told(length: complex) -> float | list[float]:
        inside = length / MM_PER[scene.unit]
        if isinstance(inside, float):
            return inside + 0.0  # 0, and not -0
        return [inside.real + 0.0, inside.imag + 0.0]

    return scene.with_values({f"follower.{key}": told(each) for key, each in lengths.items()})


def _told(design: Design, length: float) -> str:
    return f"{length / MM_PER[design.scene.unit]:.6g} {design.scene.unit}"
