"""`camgeo slotted-lever`: extremes, value table and diagram of a crank with a slotted lever."""

from __future__ import annotations

import argparse
import sys
from decimal import Decimal
from pathlib import Path
from typing import Final

from camgeo.answers.answer import FINE
from camgeo.cli.command import (
    CallError,
    add_json,
    decimal,
    print_json,
    require_beside,
    write_told,
)
from camgeo.cli.plot import add_picture, drawn
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

TABLE_OPTIONS: Final = {"step": PRINTED_STEP, "from": Decimal(0), "to": FULL_TURN}
"""With their defaults."""


SUMMARY: Final = "tell extremes and time ratio of a slotted-lever, its value table, its diagram"

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
        help="R, radius of the crank; with R > a the lever turns round",
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
    _check_options(arguments)
    driven = _driven(arguments)
    table = None
    if arguments.table or arguments.csv is not None:
        table = _table(driven, arguments)
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


def _check_options(arguments: argparse.Namespace) -> None:
    if not arguments.table and arguments.csv is None:
        given = [f"--{name}" for name in TABLE_OPTIONS if getattr(arguments, name) is not None]
        given += ["--printed"] * arguments.printed
        if given:
            raise CallError(f"{', '.join(given)}: allowed with --table or --csv only")
    require_beside("--csv", arguments.csv, arguments.output)


def _driven(arguments: argparse.Namespace) -> DrivenLever:
    frame = _length("frame", arguments.frame, "mm")
    if arguments.swing is None:
        crank = _length("crank", arguments.crank, "mm")
    else:
        crank = crank_for_swing(frame, float(arguments.swing))
        if crank < LOWEST:
            raise GeometryError(
                f"makes a crank of {crank:g} mm; from {LOWEST:g} mm is allowed",
                key="swing",
                value=str(arguments.swing),
            )
    speed = _length("speed", arguments.speed, "rev/min")
    return DrivenLever(SlottedLever(crank, frame), speed * RPM)


def _length(key: str, given: Decimal, unit: str) -> float:
    value = float(given)
    if not LOWEST <= value <= HIGHEST:
        message = f"must be from {LOWEST:g} to {HIGHEST:g} {unit}"
        raise GeometryError(message, key=key, value=str(given))
    return value


def _table(driven: DrivenLever, arguments: argparse.Namespace) -> LeverTable:
    given = {key: getattr(arguments, key) for key in TABLE_OPTIONS}
    known = {key: value for key, value in given.items() if value is not None}
    return lever_table(driven, *(TABLE_OPTIONS | known).values())


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
