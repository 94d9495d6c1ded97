"""`camgeo stability`: what is computed in doubles, held against mpmath, as table and picture."""

from __future__ import annotations

import argparse
import math
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from camgeo._version import __version__
from camgeo.answers.answer import BROKEN, FINE
from camgeo.cli.command import (
    CallError,
    add_json,
    print_json,
)
from camgeo.cli.earlier import present_name
from camgeo.cli.plot import add_picture, write_picture
from camgeo.cli.progress import clear
from camgeo.errors import meant

if TYPE_CHECKING:  # the suite is imported when it is run
    from camgeo.stability.measure import Reading
    from camgeo.stability.suite import Row

COLUMNS: Final = """\
values: how many values of the quantity were compared with mpmath's
error: largest distance from the exact value, in units in its last place (ulp), those of its length
    for a vector; where the inputs leave no digit of it certain, those of what they make of it
conditioning: by how many ulp the exact value moves there if each input moves by half an ulp of its
    own; the joints are inputs too, degrees turned to radians and rounded once
at: case and place of that error, z of a law, cam angle or crank angle
ratio: largest error / max(1, conditioning); near 1 there is no better algorithm in doubles"""
"""What stands in the table, explained below it."""

NUMBER, WIDE = 9, 14
"""Widths of a column of numbers."""


SUMMARY: Final = (
    "measure the rounding errors of every quantity against mpmath, on the hard cases too"
)

EXAMPLE: Final = (
    "camgeo stability -o stability.svg\n"
    "  camgeo stability --only curvature HC14 --json\n"
    "  camgeo stability --quick"
)


def options(parser: argparse.ArgumentParser) -> None:
    """Add those of the command."""
    parser.add_argument(
        "--only",
        metavar="NAME",
        nargs="+",
        default=[],
        help="groups (laws, tables, cams, linkages, slotted-levers, extremes, outlines),"
        " quantities, or beginnings of case names",
    )
    parser.add_argument("--quick", action="store_true", help="two places of each case only")
    add_json(parser)
    add_picture(parser)


def run(arguments: argparse.Namespace) -> int:
    """Run the suite; 0 if all ratios are within the limit, else 1."""
    from camgeo.stability import suite

    cases = suite.all_cases()
    only = _known(arguments.only, suite.names(cases))
    readings = suite.run(cases, only, quick=arguments.quick, tell=arguments.progress)
    rows = suite.table(readings)
    if arguments.output is not None:
        from camgeo.figure import stability

        points = suite.worst_of_cases(readings)
        figure = stability.figure(points, suite.LIMIT)
        told = f"{len(points)} points"
        write_picture(figure, Path(arguments.output), told, force=arguments.force)
    clear()
    if arguments.json:
        print_json(_document(rows, suite.LIMIT, quick=arguments.quick))
    else:
        _print_table(rows, suite.LIMIT)
    return FINE if all(row.sound for row in rows) else BROKEN


def _known(asked: Sequence[str], known: tuple[str, ...]) -> frozenset[str]:
    """The names that are asked for; one that is not known itself stands for all that begin so."""
    found: set[str] = set()
    for name in map(present_name, asked):
        these = [name] if name in known else [each for each in known if each.startswith(name)]
        if not these:
            told = f"argument --only: there is no {name!r}"
            hint = meant(name, known, '"')
            raise CallError(f"{told}; {hint}" if hint else told)
        found.update(these)
    return frozenset(found)


# The table ----------------------------------------------------------------------------------------


def _print_table(rows: tuple[Row, ...], limit: float) -> None:
    width = max(len(row.quantity) for row in rows) + 2
    places = [_place(row.largest_error) for row in rows]
    second = max(map(len, places)) + 2
    print(
        f"{'quantity':{width}}{'values':>6}{'error':>{NUMBER}}{'conditioning':>{WIDE}}"
        f"  {'at':{second}}{'ratio':>{NUMBER}}"
    )
    for row, place in zip(rows, places, strict=True):
        worst = row.largest_error
        print(
            f"{row.quantity:{width}}{row.count:>6}{_number(worst.error):>{NUMBER}}"
            f"{_number(worst.conditioning):>{WIDE}}  {place:{second}}"
            f"{_number(row.largest_ratio.ratio):>{NUMBER}}"
        )
    print()
    print(COLUMNS)
    beyond = [row for row in rows if not row.sound]
    print(f"limit of the ratio {limit:g}: {'kept' if not beyond else 'broken'}")
    for row in beyond:
        worst = row.largest_ratio
        print(
            f"  {row.quantity}: ratio {_number(worst.ratio)} at {_place(worst)}, error"
            f" {_number(worst.error)}, conditioning {_number(worst.conditioning)}"
        )


def _number(value: float) -> str:
    return f"{value:.2g}" if math.isfinite(value) else "no value"


def _place(reading: Reading) -> str:
    name, place = _coordinate(reading)
    return f"{reading.case}, {place:.9g}{' deg' if name != 'z' else ''}"


def _coordinate(reading: Reading) -> tuple[str, float]:
    if reading.group == "laws":
        return "z", reading.place
    if reading.group == "slotted-levers":
        return "crank_angle_deg", math.degrees(reading.place)
    return "cam_angle_deg", math.degrees(reading.place)


# JSON ---------------------------------------------------------------------------------------------


def _document(rows: tuple[Row, ...], limit: float, *, quick: bool) -> dict[str, Any]:
    return {
        "camgeo": __version__,
        "quick": quick,
        "limit": limit,
        "kept": all(row.sound for row in rows),
        "quantities": [
            {
                "quantity": row.quantity,
                "values": row.count,
                "largest_error": _record(row.largest_error),
                "largest_ratio": _record(row.largest_ratio),
            }
            for row in rows
        ],
    }


def _record(reading: Reading) -> dict[str, Any]:
    """A reading; error and ratio are null where camgeo gave no value."""
    name, place = _coordinate(reading)
    finite = math.isfinite(reading.error)
    return {
        "group": reading.group,
        "case": reading.case,
        name: place,
        "value": reading.value,
        "error_ulp": reading.error if finite else None,
        "conditioning_ulp": reading.conditioning,
        "ratio": reading.ratio if finite else None,
    }
