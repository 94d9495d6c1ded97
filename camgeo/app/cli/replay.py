"""`camgeo replay`: the motion of the follower on the real disc, or on any contour from a file."""

from __future__ import annotations

import argparse
import math
from decimal import Decimal
from typing import Final

from camgeo.app.answers.replay import FLAT, GAP, STEP, Reading, replay
from camgeo.app.cli.command import (
    add_json,
    add_origin,
    add_output,
    add_scene,
    check_step,
    decimal,
    from_0,
    opened,
    show,
    tables,
    write_files,
)
from camgeo.app.cli.plot import SUFFIXES, pictures
from camgeo.app.cli.streams import notify
from camgeo.geometry.outline.path import Flank

SMALLEST_STEP: Final = Decimal("0.001")
LARGEST_STEP: Final = Decimal(10)

TABLE: Final = ".csv"
"""How the name of a table ends; that of a picture in one of `SUFFIXES`."""

EXAMPLE: Final = (
    "camgeo replay fixtures/scenes/setzhub.toml\n"
    "  camgeo replay fixtures/scenes/setzhub.toml out/setzhub.dxf -o ripple.png\n"
    "  camgeo replay my-cam.toml measured.csv --unit mm --json\n"
    "  camgeo replay pair.toml out/pair.dxf out/pair-return.dxf"
)


def options(parser: argparse.ArgumentParser) -> None:
    """Add those of the command."""
    add_scene(parser)
    parser.add_argument(
        "contours",
        metavar="CONTOUR",
        nargs="*",
        help="drawing (DXF, SVG), or vertices (CSV: x, y, and bulge if a heading names it), in the"
        " axes of the scene's cam; default the scene's real outline. Of a conjugate pair one of"
        " each disc, or of one disc alone: that of the return disc has a name that ends in -return",
    )
    parser.add_argument("--layer", metavar="NAME", help="layer of the drawing; default CUT, or all")
    parser.add_argument(
        "--unit", choices=("mm", "inch"), help="unit of CONTOUR, if it does not state one"
    )
    parser.add_argument(
        "--gap", metavar="MM", type=from_0, default=GAP,
        help=f"end points of a drawing up to this far apart are joined; default {GAP:g}",
    )  # fmt: skip
    add_origin(parser, "CONTOUR")
    parser.add_argument(
        "--corner", metavar="DEG", type=from_0, default=FLAT,
        help=f"corners of CONTOUR up to this angle are ignored; default {FLAT:g}",
    )  # fmt: skip
    parser.add_argument(
        "--flank", choices=tuple(map(str, Flank)), help="flank of the follower; default the scene's"
    )
    parser.add_argument(
        "--step", metavar="DEG", type=decimal, default=STEP,
        help=f"step of the cam angle; default {STEP}",
    )  # fmt: skip
    add_json(parser)
    contents = f"file to write: a table ({TABLE}) or a picture ({', '.join(SUFFIXES)})"
    add_output(parser, contents, (TABLE, *SUFFIXES))


def run(arguments: argparse.Namespace) -> int:
    """Replay, and print or write the results."""
    check_step(arguments.step, SMALLEST_STEP, LARGEST_STEP)
    corner = math.radians(arguments.corner)
    origin = complex(*arguments.origin)
    reading = Reading(arguments.layer, arguments.unit, arguments.gap, corner, origin)
    found = replay(
        opened(arguments),
        arguments.contours,
        arguments.flank,
        step=arguments.step,
        reading=reading,
        progress=arguments.progress,
    )
    for each in found.discs:
        for note in filter(None, (each.note, *each.notes)):
            notify(note)
    if (arguments.output or "").endswith(TABLE):
        files = tables(found, arguments.output)
    else:
        files = pictures(found, arguments, "lift, velocity, acceleration")
    write_files(files, arguments)
    return show(found, arguments)
