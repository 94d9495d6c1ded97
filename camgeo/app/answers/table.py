"""What `camgeo table` finds: the value table of a scene, or of a motion law."""

from __future__ import annotations

from dataclasses import dataclass
from decimal import Decimal
from typing import ClassVar, Final

from camgeo.app.answers.answer import Answer, Key
from camgeo.design.design import Design
from camgeo.design.value_table import Table
from camgeo.kinematics.laws.law import Law
from camgeo.kinematics.tables import NAMES, PRINTED_STEP, law_table

PRINTED_NAMES: Final = NAMES[:4]
"""The guideline does not print f'''."""


@dataclass(frozen=True, slots=True, eq=False)
class ValueTable(Answer):
    """A value table.

    Attributes
    ----------
    table : its columns.
    """

    command: ClassVar[str] = "table"

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
