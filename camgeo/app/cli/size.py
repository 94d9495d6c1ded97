"""`camgeo size`: the smallest base circle for a transmission angle and a ratio of radii."""

from __future__ import annotations

import argparse
import math
from pathlib import Path
from typing import Final

from camgeo.app.answers.size import CamSize, size, sized_scene
from camgeo.app.cli.command import (
    CallError,
    add_json,
    add_scene,
    notify_main_disc,
    number,
    opened,
    require_beside,
    show,
    write_files,
)
from camgeo.app.cli.plot import add_picture, pictures
from camgeo.app.cli.streams import notify
from camgeo.errors import Fault, SceneError
from camgeo.units import MM_PER

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
        type=number,
        help="smallest allowed, in degrees; default: the scene's",
    )
    parser.add_argument(
        "--radius-ratio",
        metavar="RATIO",
        type=number,
        help="largest allowed r_R/r_K, above 0 to 1; default: the scene's",
    )
    parser.add_argument(
        "--radius-of-curvature",
        metavar="LENGTH",
        type=number,
        default=0.0,
        help="smallest allowed for the cam of a flat face, in the scene's unit; default 0",
    )
    parser.add_argument(
        "--arm",
        nargs=2,
        metavar=("LOW", "HIGH"),
        type=number,
        help="also choose the arm of a rocker, between two lengths in the scene's unit",
    )
    parser.add_argument(
        "--scene",
        metavar="FILE",
        dest="target",
        help="write the scene with the answer's base_radius, offset or pivot, and arm_side",
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
    notify_main_disc(design, "sizes")
    angle, arm, unit = arguments.transmission_angle, arguments.arm, MM_PER[design.scene.unit]
    found = size(
        design,
        transmission_angle=None if angle is None else math.radians(angle),
        radius_ratio=arguments.radius_ratio,
        radius_of_curvature=unit * arguments.radius_of_curvature,
        arms=None if arm is None else (unit * arm[0], unit * arm[1]),
    )
    _write(found, arguments)
    return show(found, arguments)


def _write(found: CamSize, arguments: argparse.Namespace) -> None:
    files, unit = [], found.scene.unit
    if arguments.target is not None and found.written is not None:
        target, source = Path(arguments.target), Path(arguments.scene)
        if found.scene.files and target.resolve().parent != source.resolve().parent:
            raise SceneError(
                [Fault("--scene", str(target), "must be in the folder of SCENE, which names files")]
            )
        radius = f"base radius {found.written.base_radius / MM_PER[unit]:.12g} {unit}"
        files.append((target, sized_scene(found).to_toml().encode(), radius))
    elif arguments.target is not None:
        notify(f"{arguments.target}: not written, there is no such mechanism")
    files += pictures(found, arguments, "region of the cam axis")
    write_files(files, arguments)
