"""Answer of `camgeo table`: the value table of a scene, or of a motion law."""

from __future__ import annotations

import argparse
import math
from dataclasses import dataclass
from decimal import Decimal, localcontext
from fractions import Fraction
from typing import Final

import numpy as np

from camgeo.app.answers.answer import Answer, Key
from camgeo.app.answers.laws import DEFAULT_TASK, law_arguments, law_parameters, stated_options
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
from camgeo.numeric import checked
from camgeo.numeric.arrays import FloatArray
from camgeo.scene.formats.csv import LARGEST_STEP, SMALLEST_STEP
from camgeo.units import counted

# -- value table ----------------------------------------------------------------------------------
# The value table of a normalised law, as the appendix of VDI 2143-1 prints it for four laws.


SMALLEST_STEP_OF_Z: Final = Decimal("0.000001")
LARGEST_STEP_OF_Z: Final = Decimal("0.5")

PRINTED_STEP: Final = Decimal("0.002")
"""The step of the guideline's tables."""

NAMES: Final = ("z", "f", "f1", "f2", "f3")

PRINTED_NAMES: Final = NAMES[:4]
"""The guideline does not print f'''."""

PRINTED_DECIMALS: Final = (7, 4, 4)
"""Decimals of f, f' and f'' in the guideline's tables."""

PRINTED_DECIMALS_OF_Z: Final = 3
"""Decimals of z; a finer step needs more."""


@dataclass(frozen=True, slots=True, eq=False)
class LawTable:
    """Values of a law at equidistant z.

    Attributes
    ----------
    z : (n,) from 0 to 1, exact.
    values : (n, 5), the columns `NAMES`: z, each rounded once from its decimal, f, f', f'', f'''.
        Right-hand values at the law's borders, left-hand ones at z = 1; no -0.0.
    """

    z: tuple[Decimal, ...]
    values: FloatArray

    def printed(self) -> list[tuple[str, str, str, str]]:
        """The rows z, f, f', f'' rounded as in the guideline: 7 decimals of f, 4 of f' and f''.

        A double is rounded from all its digits, a tie to the even digit; what rounds to zero has no
        sign. z is exact, with at least three decimals.
        """
        step = f"{self.z[1]:f}".partition(".")[2].rstrip("0")
        places = max(PRINTED_DECIMALS_OF_Z, len(step))
        f, f1, f2 = PRINTED_DECIMALS
        return [
            (f"{z:.{places}f}", f"{row[1]:z.{f}f}", f"{row[2]:z.{f1}f}", f"{row[3]:z.{f2}f}")
            for z, row in zip(self.z, self.values.tolist(), strict=True)
        ]


def law_table(law: Law, step: Decimal | float = PRINTED_STEP) -> LawTable:
    """Tabulate a law at z = 0, step, 2 step, ... below 1, and at 1.

    The multiples are exact, so rounding neither drops nor doubles a row; a step that does not
    divide 1 makes the last interval shorter.

    Parameters
    ----------
    law : any normalised law.
    step : of z, from 1e-6 to 0.5; a float counts as the decimal number that Python prints for it.

    Raises
    ------
    GeometryError
        If the step is outside these limits.
    """
    step = checked.decimal("step", step, SMALLEST_STEP_OF_Z, LARGEST_STEP_OF_Z, what="step of z")
    with localcontext() as context:
        # Fewer than 10^7 multiples: seven digits more than the step has hold each of them.
        context.prec = max(context.prec, len(step.as_tuple().digits) + 7)
        count = math.ceil(1 / Fraction(step))
        z = (*(step * number for number in range(count)), Decimal(1))
    rounded = np.array([float(place) for place in z])
    values = np.column_stack((rounded, *law(rounded)))
    return LawTable(z, values + 0.0)


# -- answer ----------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True, eq=False)
class ValueTable(Answer):
    """A value table.

    Attributes
    ----------
    table : columns with their headings.
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
# The keys of its JSON document.


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
# The answer of `camgeo table` as CSV.


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
        law = make_law(arguments.law, task, **law_parameters(arguments))
        answer = table_of_law(law, step, printed=arguments.printed)
    else:
        only_with_law = stated_options(arguments) + ["--printed"] * arguments.printed
        if only_with_law:
            raise CallError(f"{', '.join(only_with_law)}: allowed with --law only, not with SCENE")
        check_step(arguments.step, SMALLEST_STEP, LARGEST_STEP)
        design = opened(arguments)
        answer = table_of_scene(design, arguments.step)
        notify_main_disc(design, "curves")
    text = document(answer) if arguments.json else answer.table.csv()
    return deliver(text, arguments, counted(len(answer.table.values), "row"))
