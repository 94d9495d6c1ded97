"""`camgeo table`: the value table of a scene or of a normalised motion law, as CSV."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable
from functools import partial
from pathlib import Path

import numpy as np

from camgeo.cli.command import (
    FINE,
    Subparsers,
    add_output,
    decimal_of,
    new_parser,
    print_json,
    step_of,
    tell_main_disc,
    write_told,
)
from camgeo.cli.law_options import add_law_options, given_options, law_from
from camgeo.design import Design
from camgeo.files.value_table import Table
from camgeo.formats.csv import LARGEST_STEP, SMALLEST_STEP
from camgeo.motion.value_table import NAMES, PRINTED_STEP, law_table
from camgeo.scene.load import load_scene

PRINTED_NAMES = NAMES[:4]
"""The guideline prints no f'''."""


def register(subparsers: Subparsers[argparse.ArgumentParser]) -> None:
    """Add the command."""
    parser = new_parser(
        subparsers,
        "table",
        "print the value table as CSV: motion, curves, transmission angle, curvature; or that of a"
        " motion law",
        "camgeo table fixtures/scenes/setzhub.toml --step 0.5 -o setzhub.csv\n"
        "  camgeo table --law modified-sine --step 0.002 --printed",
    )
    parser.add_argument("scene", metavar="SCENE", nargs="?", help="scene file (TOML)")
    parser.add_argument(
        "--step",
        metavar="STEP",
        help="step of the cam angle in degrees; with --law, step of z, default 0.002",
    )
    add_output(parser, "file to write; else the terminal")
    parser.add_argument("--json", action="store_true", help="print JSON")
    parser.add_argument(
        "--printed", action="store_true", help="with --law: rounded as the tables of VDI 2143 are"
    )
    add_law_options(parser)
    parser.set_defaults(run=partial(run, parser))


def run(parser: argparse.ArgumentParser, arguments: argparse.Namespace) -> int:
    """Print or write the table."""
    if arguments.scene is None and arguments.law is None:
        parser.error("one of SCENE and --law NAME is needed")
    if arguments.scene is not None and arguments.law is not None:
        parser.error("SCENE and --law are both given; only one of them is allowed")
    if arguments.scene is None:
        return _of_law(parser, arguments)
    only_with_law = given_options(arguments) + ["--printed"] * arguments.printed
    if only_with_law:
        parser.error(f"{', '.join(only_with_law)}: allowed with --law only, not with SCENE")
    return _of_scene(parser, arguments)


def _of_scene(parser: argparse.ArgumentParser, arguments: argparse.Namespace) -> int:
    step = None
    if arguments.step is not None:
        step = step_of(parser, arguments.step, SMALLEST_STEP, LARGEST_STEP)
    design = Design(load_scene(arguments.scene))
    table = design.tabulated.table(step)
    tell_main_disc(design, "curves")
    return _deliver(table, table.csv, arguments)


def _of_law(parser: argparse.ArgumentParser, arguments: argparse.Namespace) -> int:
    step = PRINTED_STEP
    if arguments.step is not None:
        step = decimal_of(parser, "step", arguments.step)
    exact = law_table(law_from(arguments), step)
    if not arguments.printed:
        table = Table(NAMES, exact.values)
        return _deliver(table, table.csv, arguments)
    rows = exact.printed()
    table = Table(PRINTED_NAMES, np.array(rows, dtype=np.float64))
    lines = [",".join(row) + "\n" for row in (PRINTED_NAMES, *rows)]
    return _deliver(table, lambda: "".join(lines), arguments)


def _deliver(table: Table, text: Callable[[], str], arguments: argparse.Namespace) -> int:
    """Print the table as JSON, or its text to the terminal or into a file."""
    if arguments.json:
        columns = dict(zip(table.names, table.values.T.tolist(), strict=True))
        print_json(columns)
        return FINE
    if arguments.output is None:
        sys.stdout.write(text())
        return FINE
    told = f"{len(table.values)} rows"
    files = [(Path(arguments.output), text().encode(), told)]
    write_told(files, force=arguments.force)
    return FINE
