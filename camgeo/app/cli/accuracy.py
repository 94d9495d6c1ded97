"""`camgeo accuracy`: what accuracy costs, as a table and a picture; when it stops paying off."""

from __future__ import annotations

import argparse
import math
from typing import Final

from camgeo.app.cli.command import (
    add_json,
    add_scene,
    notify_main_disc,
    opened,
    positive,
    show,
    write_files,
)
from camgeo.app.cli.plot import add_picture, pictures
from camgeo.scene.formats.format import LARGEST_TOLERANCE, SMALLEST_TOLERANCE
from camgeo.units import RPM

EXAMPLE: Final = (
    "camgeo accuracy fixtures/scenes/setzhub.toml -o setzhub-accuracy.svg\n"
    "  camgeo accuracy my-cam.toml --tolerances 1e-2,1e-3,1e-4 --ripple\n"
    "  camgeo accuracy my-cam.toml --speed 600\n"
    "  camgeo accuracy my-cam.toml --all\n"
    "  camgeo accuracy my-cam.toml --bill --ripple -o my-cam-bill.svg\n"
    "  camgeo accuracy my-cam.toml --json"
)


def options(parser: argparse.ArgumentParser) -> None:
    """Add those of the command."""
    add_scene(parser)
    parser.add_argument(
        "--tolerances",
        metavar="MM",
        type=_tolerances,
        help="comma-separated, in mm; default 1e-1 to 1e-6, one per decade; finer ones take long",
    )
    parser.add_argument(
        "--all",
        action="store_true",
        help="measure all forms and fits of the contour, solids, value tables and effects too; so"
        " does --json",
    )
    parser.add_argument(
        "--ripple",
        action="store_true",
        help="also replay the contours: how far the follower's acceleration is off",
    )
    parser.add_argument(
        "--bill",
        action="store_true",
        help="also build the scene within each tolerance: the seconds of each stage",
    )
    parser.add_argument(
        "--speed",
        metavar="RPM",
        type=positive,
        help="also tell which tolerance of each form is enough at this speed of the cam",
    )
    add_json(parser)
    add_picture(parser)


def run(arguments: argparse.Namespace) -> int:
    """Measure, and print or draw the results."""
    from camgeo.app.answers.accuracy import accuracy
    from camgeo.studies.accuracy.survey import TOLERANCES  # with all that it measures

    design = opened(arguments)
    notify_main_disc(design, "figures")
    found = accuracy(
        design,
        arguments.tolerances or TOLERANCES,
        ripple=arguments.ripple or None,
        complete=arguments.all or arguments.json,
        bill=arguments.bill,
        speed=None if arguments.speed is None else arguments.speed * RPM,
        progress=arguments.progress,
    )
    write_files(pictures(found, arguments, "pieces, bytes, seconds"), arguments)
    return show(found, arguments)


def _tolerances(text: str) -> tuple[float, ...]:
    """The tolerances of `--tolerances`, each once, the loosest first."""
    found = set()
    for word in text.split(","):
        try:
            value = float(word)
        except ValueError:
            value = math.nan
        if not SMALLEST_TOLERANCE <= value <= LARGEST_TOLERANCE:
            raise argparse.ArgumentTypeError(
                f"{word.strip()!r} must be a length of {SMALLEST_TOLERANCE:g} to"
                f" {LARGEST_TOLERANCE:g} mm"
            )
        found.add(value)
    return tuple(sorted(found, reverse=True))
