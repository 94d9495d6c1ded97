"""What `camgeo table` finds: the value table of a scene, or of a motion law."""

from __future__ import annotations

import argparse
from dataclasses import dataclass
from decimal import Decimal
from typing import Final

from camgeo.app.answers.answer import Answer, Key
from camgeo.app.answers.laws import DEFAULT_TASK, given_options, law_arguments, parameters_from
from camgeo.app.cli.command import (
    Argument,
    CallError,
    check_step,
    decimal,
    deliver,
    document,
    notify_main_disc,
    opened,
    output_options,
)
from camgeo.design.design import Design
from camgeo.design.value_table import Table
from camgeo.kinematics.laws import make_law
from camgeo.kinematics.laws.law import Law
from camgeo.kinematics.tables import NAMES, PRINTED_STEP, law_table
from camgeo.scene.formats.csv import LARGEST_STEP, SMALLEST_STEP
from camgeo.units import counted

PRINTED_NAMES: Final = NAMES[:4]
"""The guideline does not print f'''."""


@dataclass(frozen=True, slots=True, eq=False)
class ValueTable(Answer):
    """A value table.

    Attributes
    ----------
    table : its columns.
    """

    table: Table


def table_of_scene(design: Design, step: Decimal | float | None = None) -> ValueTable:
    """The value table of a scene, see `TabulatedCam.written`; a `step` is in degrees."""
    return ValueTable(design.tabulated.written(step))


def table_of_law(
    law: Law, step: Decimal | float = PRINTED_STEP, *, printed: bool = False
) -> ValueTable:
    """The value table of a law at every `step` of z, or rounded as the tables of VDI 2143 are.

    Raises GeometryError if the step is invalid.
    """
    exact = law_table(law, step)
    if printed:
        return ValueTable(Table.rounded(PRINTED_NAMES, exact.printed()))
    return ValueTable(Table(NAMES, exact.values))


# -- document -------------------------------------------------------------------------------------
# What JSON has of the answer.


DOCUMENT: Final = Key(
    "The value table of a scene, or of a motion law.",
    {
        "columns": Key(
            'The columns, by headings with units, e.g. "phi [deg]": one value per row.',
            of="table.columns",
        ),
    },
    type=ValueTable,
)


# -- rendering ------------------------------------------------------------------------------------
# What `camgeo table` finds, as CSV.


def text(answer: ValueTable) -> str:
    """The table as CSV."""
    return answer.table.csv().rstrip("\n")


def table(answer: ValueTable) -> Table:
    """The table."""
    return answer.table


# -- command line ----------------------------------------------------------------------------------


EXAMPLE: Final = (
    "camgeo table fixtures/scenes/setzhub.toml --step 0.5 -o setzhub.csv\n"
    "  camgeo table --law modified-sine --step 0.002 --printed"
)


ARGUMENTS: Final = (
    Argument("scene", metavar="SCENE", nargs="?", help="scene file (TOML)"),
    Argument(
        "--step",
        metavar="STEP",
        type=decimal,
        help="step of the cam angle in degrees; with --law, step of z, default 0.002",
    ),
    *output_options("file to write; default: print to the terminal"),
    Argument(
        "--printed", action="store_true", help="with --law: rounded as the tables of VDI 2143 are"
    ),
    law_arguments(),
)


def run(arguments: argparse.Namespace) -> int:
    """Print the table as CSV or JSON, or write it."""
    if arguments.scene is None and arguments.law is None:
        raise CallError("one of SCENE and --law NAME is needed")
    if arguments.scene is not None and arguments.law is not None:
        raise CallError("SCENE and --law are both given; only one of them is allowed")
    if arguments.scene is None:
        step = PRINTED_STEP if arguments.step is None else arguments.step
        task = arguments.task or DEFAULT_TASK
        law = make_law(arguments.law, task, **parameters_from(arguments))
        found = table_of_law(law, step, printed=arguments.printed)
    else:
        only_with_law = given_options(arguments) + ["--printed"] * arguments.printed
        if only_with_law:
            raise CallError(f"{', '.join(only_with_law)}: allowed with --law only, not with SCENE")
        check_step(arguments.step, SMALLEST_STEP, LARGEST_STEP)
        design = opened(arguments)
        found = table_of_scene(design, arguments.step)
        notify_main_disc(design, "curves")
    text = document(found) if arguments.json else found.table.csv()
    return deliver(text, arguments, counted(len(found.table.values), "row"))
