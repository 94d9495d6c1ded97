"""`camgeo inspect`: a measured disc compared with the exact one."""

from __future__ import annotations

import argparse
from typing import Final

from camgeo.app.answers.inspect import inspect
from camgeo.app.cli.command import (
    CallError,
    add_json,
    add_output,
    add_scene,
    from_0,
    opened,
    positive,
    show,
    tables,
    write_files,
)
from camgeo.app.cli.plot import SUFFIXES, pictures
from camgeo.geometry.outline.path import Flank
from camgeo.studies.inspection import Align

TABLE: Final = ".csv"
"""How the name of a table ends; that of a picture in one of `SUFFIXES`."""

EXAMPLE: Final = (
    "camgeo inspect my-cam.toml measured.csv --tolerance 0.02\n"
    "  camgeo inspect my-cam.toml centres.csv --ball 1.5 -o deviations.png\n"
    "  camgeo inspect my-cam.toml measured.csv --align free --json"
)


def options(parser: argparse.ArgumentParser) -> None:
    """Add those of the command."""
    add_scene(parser)
    parser.add_argument(
        "measured",
        metavar="MEASURED",
        help="points (CSV: x, y, perhaps nx, ny) in the axes of the scene's cam; a name that ends"
        " in -return is of the return disc of a conjugate pair, in -inner or -outer of that flank",
    )
    parser.add_argument(
        "--align", choices=tuple(map(str, Align)), default=str(Align.DATUM),
        help="what to fit: nothing (the points were measured from bore and key), the turn about the"
        " cam axis, or shift and turn; a fit hides eccentricity and phase; default %(default)s",
    )  # fmt: skip
    parser.add_argument(
        "--robust", action="store_true",
        help="of a fit: pass over local errors of form, which would sway the least squares",
    )  # fmt: skip
    parser.add_argument(
        "--unit", choices=("mm", "inch"), help="unit of MEASURED, if it does not state one; default"
        " the scene's",
    )  # fmt: skip
    parser.add_argument(
        "--flank", choices=tuple(map(str, Flank)), help="flank; default by the name, or the scene's"
    )
    parser.add_argument(
        "--ball", metavar="MM", type=from_0, default=0.0,
        help="the points are centres of a ball of this radius",
    )  # fmt: skip
    parser.add_argument(
        "--tolerance", metavar="MM", type=positive,
        help="profile tolerance: width of the zone about the flank that must hold all points",
    )  # fmt: skip
    add_json(parser)
    contents = f"file to write: a table ({TABLE}) or a picture ({', '.join(SUFFIXES)})"
    add_output(parser, contents, (TABLE, *SUFFIXES))


def run(arguments: argparse.Namespace) -> int:
    """Compare, and print or write the results."""
    if arguments.robust and arguments.align == Align.DATUM:
        raise CallError("--robust: allowed with --align rotation or free only")
    found = inspect(
        opened(arguments),
        arguments.measured,
        arguments.flank,
        align=arguments.align,
        robust=arguments.robust,
        unit=arguments.unit,
        ball=arguments.ball,
        tolerance=arguments.tolerance,
    )
    if (arguments.output or "").endswith(TABLE):
        files = tables(found, arguments.output)
    else:
        files = pictures(found, arguments, "deviations, lift errors")
    write_files(files, arguments)
    return show(found, arguments)
