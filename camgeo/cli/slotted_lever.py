"""`camgeo slotted-lever`: extremes, value table and diagram of a crank with a slotted lever."""

from __future__ import annotations

import argparse
import sys
from decimal import Decimal
from functools import partial
from pathlib import Path
from typing import Final

from camgeo.cli.command import (
    FINE,
    Subparsers,
    decimal_of,
    new_parser,
    print_json,
    require_beside,
    write_told,
)
from camgeo.cli.plot import add_picture, check_picture, drawn
from camgeo.cli.slotted_lever_told import document, lines
from camgeo.errors import GeometryError
from camgeo.mechanism.slotted_lever import SlottedLever
from camgeo.mechanism.slotted_lever_drive import (
    FULL_TURN,
    NAMES,
    PRINTED_STEP,
    DrivenLever,
    LeverTable,
    crank_for_swing,
    lever_table,
)
from camgeo.units import RPM

LOWEST, HIGHEST = 1e-100, 1e100
"""Of lengths [mm] and speeds [rev/min]: what is made of them is far from overflow."""

TABLE_OPTIONS: Final = ("step", "from", "to")


def register(subparsers: Subparsers[argparse.ArgumentParser]) -> None:
    """Add the command."""
    parser = new_parser(
        subparsers,
        "slotted-lever",
        "tell extremes and time ratio of a slotted lever, its value table, its diagram",
        "camgeo slotted-lever --frame 150 --swing 60 --speed 90 -o slotted-lever.png\n"
        "  camgeo slotted-lever --frame 150 --swing 60 --speed 90 --table --printed\n"
        "  camgeo slotted-lever --frame 50 --crank 80 --speed 90 --csv turning.csv --step 0.5",
    )
    parser.add_argument(
        "--frame", metavar="MM", required=True, help="a, distance of the axes of crank and lever"
    )
    size = parser.add_mutually_exclusive_group(required=True)
    size.add_argument(
        "--swing", metavar="DEG", help="whole swing of the lever; the crank is a sin(swing/2)"
    )
    size.add_argument(
        "--crank", metavar="MM", help="R, radius of the crank; with R > a the lever turns round"
    )
    parser.add_argument(
        "--speed", metavar="RPM", required=True, help="speed of the crank in rev/min"
    )
    group = parser.add_argument_group("value table")
    group.add_argument("--table", action="store_true", help="print the value table as CSV instead")
    group.add_argument("--csv", metavar="FILE", help="write the value table to a file")
    group.add_argument("--step", metavar="DEG", help="step of the crank angle, default 1")
    group.add_argument("--from", metavar="DEG", help="first crank angle, default 0")
    group.add_argument("--to", metavar="DEG", help="last crank angle, default 360")
    group.add_argument(
        "--printed", action="store_true", help="to three decimals, as the SAM exercise prints it"
    )
    parser.add_argument("--json", action="store_true", help="print JSON")
    add_picture(parser)
    parser.set_defaults(run=partial(run, parser))


def run(parser: argparse.ArgumentParser, arguments: argparse.Namespace) -> int:
    """Print extremes or table; write table and picture, both or none."""
    check_picture(parser, arguments.output)
    _check_options(parser, arguments)
    driven = _driven(parser, arguments)
    table = None
    if arguments.table or arguments.csv is not None:
        table = _table(parser, driven, arguments)
    _write(driven, table, arguments)
    shown = table if arguments.table else None
    if arguments.json:
        print_json(document(driven, shown, printed=arguments.printed))
    elif shown is not None:
        sys.stdout.write(_csv(shown, printed=arguments.printed))
    else:
        print("\n".join(lines(driven)))
    return FINE


# What is given ------------------------------------------------------------------------------------


def _check_options(parser: argparse.ArgumentParser, arguments: argparse.Namespace) -> None:
    if not arguments.table and arguments.csv is None:
        given = [f"--{name}" for name in TABLE_OPTIONS if getattr(arguments, name) is not None]
        given += ["--printed"] * arguments.printed
        if given:
            parser.error(f"{', '.join(given)}: allowed with --table or --csv only")
    require_beside(parser, "--csv", arguments.csv, arguments.output)


def _driven(parser: argparse.ArgumentParser, arguments: argparse.Namespace) -> DrivenLever:
    frame = _length(parser, "frame", arguments.frame, "mm")
    if arguments.swing is None:
        crank = _length(parser, "crank", arguments.crank, "mm")
    else:
        crank = crank_for_swing(frame, float(decimal_of(parser, "swing", arguments.swing)))
        if crank < LOWEST:
            raise GeometryError(
                f"makes a crank of {crank:g} mm; from {LOWEST:g} mm is allowed",
                key="swing",
                value=arguments.swing,
            )
    speed = _length(parser, "speed", arguments.speed, "rev/min")
    return DrivenLever(SlottedLever(crank, frame), speed * RPM)


def _length(parser: argparse.ArgumentParser, key: str, text: str, unit: str) -> float:
    value = float(decimal_of(parser, key, text))
    if not LOWEST <= value <= HIGHEST:
        raise GeometryError(f"must be from {LOWEST:g} to {HIGHEST:g} {unit}", key=key, value=text)
    return value


def _table(
    parser: argparse.ArgumentParser, driven: DrivenLever, arguments: argparse.Namespace
) -> LeverTable:
    defaults = (PRINTED_STEP, Decimal(0), FULL_TURN)
    given = [
        default
        if getattr(arguments, key) is None
        else decimal_of(parser, key, getattr(arguments, key))
        for key, default in zip(TABLE_OPTIONS, defaults, strict=True)
    ]
    return lever_table(driven, *given)


# Files --------------------------------------------------------------------------------------------


def _write(driven: DrivenLever, table: LeverTable | None, arguments: argparse.Namespace) -> None:
    files = []
    if arguments.csv is not None:
        assert table is not None  # made for this file
        data = _csv(table, printed=arguments.printed).encode()
        files.append((Path(arguments.csv), data, f"{len(table.values)} rows"))
    if arguments.output is not None:
        from camgeo.figure import slotted_lever

        target = Path(arguments.output)
        picture = drawn(slotted_lever.figure(driven), target.suffix)
        files.append((target, picture, "phi, omega2, eps2"))
    write_told(files, force=arguments.force)


def _csv(table: LeverTable, *, printed: bool) -> str:
    if printed:
        return "".join(",".join(row) + "\n" for row in (NAMES, *table.printed()))
    from camgeo.files.value_table import Table

    return Table(NAMES, table.values).csv()
