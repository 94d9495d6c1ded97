"""`camgeo lint`: milling programs of any origin, run as their controller would run them."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Final

from camgeo.app.answers.lint import lint
from camgeo.app.cli.command import CallError, add_json, number, opened, show
from camgeo.design.linting import Bench

EXAMPLE: Final = (
    "camgeo lint part.nc --machine fanuc\n"
    "  camgeo lint *.ngc --machine linuxcnc --stock-top 0 --clearance 5\n"
    "  camgeo lint part.tap --machine my-mill.toml --json\n"
    "  camgeo lint part.ngc --machine linuxcnc --scene part.toml"
)


def options(parser: argparse.ArgumentParser) -> None:
    """Add those of the command."""
    parser.add_argument("files", metavar="PROGRAM", nargs="+", help="files, of any origin")
    parser.add_argument(
        "--machine", metavar="NAME|PROFILE", required=True,
        help="machine profile: the name of one, or a TOML file",
    )  # fmt: skip
    parser.add_argument(
        "--stock-top", metavar="MM", type=number, default=0.0,
        help="Z of the highest stock; default 0",
    )  # fmt: skip
    parser.add_argument(
        "--clearance", metavar="MM", type=number,
        help="Z from which on traverses may go anywhere; default: the top of the stock",
    )  # fmt: skip
    parser.add_argument(
        "--radius", metavar="D=MM", action="append", default=[], type=_radius,
        help="what offset D holds, where the control compensates for the cutter: its radius, or its"
        " wear alone",
    )  # fmt: skip
    parser.add_argument(
        "--scene", metavar="SCENE",
        help="scene whose tools, blank, holding and part the programs are run with",
    )  # fmt: skip
    parser.add_argument(
        "--second-side", action="store_true",
        help="the programs mill the second side of the scene; those of camgeo say so themselves",
    )  # fmt: skip
    add_json(parser)


def run(arguments: argparse.Namespace) -> int:
    """Show what was found; 0 for nothing, 1 for something, 2 if a file cannot be read."""
    clearance = arguments.clearance
    if clearance is not None and clearance < arguments.stock_top:
        raise CallError("argument --clearance: is below the top of the stock")
    bench = Bench(arguments.stock_top, clearance, tuple(arguments.radius))
    paths = [Path(name) for name in arguments.files]
    design = opened(arguments) if arguments.scene is not None else None
    second = arguments.second_side
    if second and design is None:
        raise CallError("argument --second-side: needs --scene, whose second side it is")
    return show(lint(paths, arguments.machine, bench, design, second_side=second), arguments)


def _radius(text: str) -> tuple[int, float]:
    offset, mark, radius = text.partition("=")
    if not (mark and offset.isascii() and offset.isdigit() and len(offset) <= 6):
        raise argparse.ArgumentTypeError(f"{text!r} is not an offset and its radius, like 1=3.0")
    return int(offset), number(radius)
