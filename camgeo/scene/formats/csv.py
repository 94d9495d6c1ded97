"""CSV: the value table."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from decimal import Decimal
from functools import partial
from typing import Annotated, Final

from camgeo.errors import GeometryError
from camgeo.numeric.checked import (
    Truth,
    check_fields,
    decimal,
    instance_from_table,
    one_of,
    whole,
)
from camgeo.record import stored_schema
from camgeo.scene.formats.format import Format, Values
from camgeo.units import MM_PER, LengthUnit

SMALLEST_STEP: Final = Decimal("0.001")
LARGEST_STEP: Final = Decimal(90)
"""Smallest and largest step of the cam angle [degrees]."""


SEPARATORS: Final = {",": ",", ";": ";", "tab": "\t"}
"""Separators of columns, by their names in scenes."""

MOST_DECIMALS: Final = 15


exact_step = partial(decimal, least=SMALLEST_STEP, most=LARGEST_STEP, unit="degrees")
"""A step of the cam angle [degrees], see `camgeo.numeric.checked.decimal`."""


@dataclass(frozen=True, slots=True)
class CsvSpec:
    """`[output.csv]`: the rows and columns of the value table, and how its numbers are written.

    Attributes
    ----------
    step : of the cam angle [degrees], exactly as written, so that the rows fall on the angles that
        the designer wrote.
    columns : names of columns without their units, in order; None for the whole table.
    decimals : of all numbers; None for as many as it takes to read back the same.
    decimal_comma : whether numbers have a comma.
    separator : between columns, a key of `SEPARATORS`; None for a comma, or for a semicolon with
        decimal commas.
    unit : of lengths; None for that of the scene.
    angle : unit of angles, "deg" or "rad".

    Raises
    ------
    GeometryError
        With the key, if a value is invalid, or numbers with commas would be parted by commas.
    """

    step: Annotated[Decimal, exact_step] = Decimal(1)
    columns: tuple[str, ...] | None = None
    decimals: Annotated[int, partial(whole, least=0, most=MOST_DECIMALS)] | None = None
    decimal_comma: Truth = False
    separator: Annotated[str, partial(one_of, choices=tuple(SEPARATORS))] | None = None
    unit: Annotated[LengthUnit, partial(one_of, choices=tuple(MM_PER))] | None = None
    angle: Annotated[str, partial(one_of, choices=("deg", "rad"))] = "deg"

    def __post_init__(self) -> None:
        check_fields(self, "output.csv.")
        if self.decimal_comma and self.separator == ",":
            raise GeometryError(CONFUSED, "output.csv.separator", self.separator)

    @property
    def delimiter(self) -> str:
        """Text between two columns."""
        return SEPARATORS[self.separator or (";" if self.decimal_comma else ",")]


def commas_are_unambiguous(values: Values) -> Iterator[tuple[str, str]]:
    """A comma may stand in numbers or between columns, not both."""
    table = ("output", "csv")
    if values.get(*table, "decimal_comma") and values.get(*table, "separator") == ",":
        yield "separator", CONFUSED


CONFUSED: Final = 'must be ";" or "tab" where numbers have a decimal comma'

FORMAT: Final = Format(
    "csv",
    ".csv",
    partial(instance_from_table, CsvSpec),
    stored_schema(__file__),
    rules=(commas_are_unambiguous,),
)
