"""`camgeo table`: the value table of a scene or of a normalised motion law, as CSV."""

from __future__ import annotations

import argparse
from typing import Final

from camgeo.app.answers.table import ValueTable, table_of_law, table_of_scene
from camgeo.app.cli.command import (
    CallError,
    add_json,
    add_output,
    check_step,
    decimal,
    deliver,
    document,
    notify_main_disc,
    opened,
)
from camgeo.app.cli.laws import DEFAULT_TASK, add_law_options, given_options, parameters_from
from camgeo.kinematics.laws import make_law
from camgeo.kinematics.tables import PRINTED_STEP
from camgeo.scene.formats.csv import LARGEST_STEP, SMALLEST_STEP
from camgeo.units import counted

EXAMPLE: Final = (
    "camgeo table fixtures/scenes/setzhub.toml --step 0.5 -o setzhub.csv\n"
    "  camgeo table --law modified-sine --step 0.002 --printed"
)


def options(parser: argparse.ArgumentParser) -> None:
    """Add those of the command."""
    parser.add_argument("scene", metavar="SCENE", nargs="?", help="scene file (TOML)")
    parser.add_argument(
        "--step",
        metavar="STEP",
        type=decimal,
        help="step of the cam angle in degrees; with --law, step of z, default 0.002",
    )
    add_output(parser, "file to write; default: print to the terminal")
    add_json(parser)
    parser.add_argument(
        "--printed", action="store_true", help="with --law: rounded as the tables of VDI 2143 are"
    )
    add_law_options(parser)


def run(arguments: argparse.Namespace) -> int:
    """Print or write the table."""
    if arguments.scene is None and arguments.law is None:
        raise CallError("one of SCENE and --law NAME is needed")
    if arguments.scene is not None and arguments.law is not None:
        raise CallError("SCENE and --law are both given; only one of them is allowed")
    if arguments.scene is None:
        step = PRINTED_STEP if arguments.step is None else arguments.step
        task = arguments.task or DEFAULT_TASK
        law = make_law(arguments.law, task, **parameters_from(arguments))
        return _deliver(table_of_law(law, step, printed=arguments.printed), arguments)
    only_with_law = given_options(arguments) + ["--printed"] * arguments.printed
    if only_with_law:
        raise CallError(f"{', '.join(only_with_law)}: allowed with --law only, not with SCENE")
    check_step(arguments.step, SMALLEST_STEP, LARGEST_STEP)
    design = opened(arguments)
    found = table_of_scene(design, arguments.step)
    notify_main_disc(design, "curves")
    return _deliver(found, arguments)


def _deliver(found: ValueTable, arguments: argparse.Namespace) -> int:
    """The table as CSV or JSON, to the terminal or into a file."""
    text = document(found) if arguments.json else found.table.csv()
    return deliver(text, arguments, counted(len(found.table.values), "row"))
