"""`camgeo slotted-lever`: extremes, value table and diagram of a crank with a slotted lever."""

from __future__ import annotations

import argparse
from typing import Final

from camgeo.app.answers import answer
from camgeo.app.answers.answer import FINE
from camgeo.app.answers.slotted_lever import FULL_TURN, slotted_lever
from camgeo.app.cli.command import (
    CallError,
    add_json,
    decimal,
    require_beside,
    show,
    tables,
    write_files,
)
from camgeo.app.cli.plot import add_picture, pictures
from camgeo.app.cli.streams import write

TABLE_OPTIONS: Final = dict(zip(("step", "from", "to"), FULL_TURN, strict=True))
"""With their defaults."""


EXAMPLE: Final = (
    "camgeo slotted-lever --frame 150 --swing 60 --speed 90 -o slotted-lever.png\n"
    "  camgeo slotted-lever --frame 150 --swing 60 --speed 90 --table --printed\n"
    "  camgeo slotted-lever --frame 50 --crank 80 --speed 90 --csv turning.csv --step 0.5"
)


def options(parser: argparse.ArgumentParser) -> None:
    """Add those of the command."""
    parser.add_argument(
        "--frame",
        metavar="MM",
        type=decimal,
        required=True,
        help="a, distance between the axes of crank and lever",
    )
    size = parser.add_mutually_exclusive_group(required=True)
    size.add_argument(
        "--swing",
        metavar="DEG",
        type=decimal,
        help="whole swing of the lever; the crank is a sin(swing/2)",
    )
    size.add_argument(
        "--crank",
        metavar="MM",
        type=decimal,
        help="R, radius of the crank; with R > a the lever makes full turns",
    )
    parser.add_argument(
        "--speed", metavar="RPM", type=decimal, required=True, help="speed of the crank in rev/min"
    )
    group = parser.add_argument_group("value table")
    group.add_argument("--table", action="store_true", help="print the value table as CSV instead")
    group.add_argument("--csv", metavar="FILE", help="write the value table to a file")
    group.add_argument(
        "--step", metavar="DEG", type=decimal, help="step of the crank angle, default 1"
    )
    group.add_argument("--from", metavar="DEG", type=decimal, help="first crank angle, default 0")
    group.add_argument("--to", metavar="DEG", type=decimal, help="last crank angle, default 360")
    group.add_argument(
        "--printed", action="store_true", help="to three decimals, as the SAM exercise prints it"
    )
    add_json(parser)
    add_picture(parser)


def run(arguments: argparse.Namespace) -> int:
    """Print extremes or table; write table and picture, both or none."""
    tabled = arguments.table or arguments.csv is not None
    given = {key: getattr(arguments, key) for key in TABLE_OPTIONS}
    known = {key: value for key, value in given.items() if value is not None}
    if not tabled and (known or arguments.printed):
        names = [f"--{name}" for name in known] + ["--printed"] * arguments.printed
        raise CallError(f"{', '.join(names)}: allowed with --table or --csv only")
    require_beside("--csv", arguments.csv, arguments.output)
    step, first, last = (TABLE_OPTIONS | known).values()
    found = slotted_lever(
        arguments.frame,
        arguments.speed,
        crank=arguments.crank,
        swing=arguments.swing,
        rows=(step, first, last) if tabled else None,
        printed=arguments.printed,
    )
    files = tables(found, arguments.csv) + pictures(found, arguments, "phi, omega2, eps2")
    write_files(files, arguments)
    if arguments.table and not arguments.json:
        write(answer.table(found).csv())
        return FINE
    return show(found, arguments)
