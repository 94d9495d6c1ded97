"""CSV: the value table."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from decimal import Decimal
from typing import Any, Final

from camgeo.errors import GeometryError
from camgeo.numeric.checked import decimal, hold, instance, one_of, whole
from camgeo.record import schema_beside
from camgeo.scene.formats.format import Format, Values
from camgeo.units import MM_PER, LengthUnit

SMALLEST_STEP: Final = Decimal("0.001")
LARGEST_STEP: Final = Decimal(90)
"""Of the cam angle [degrees]."""


SEPARATORS: Final = {",": ",", ";": ";", "tab": "\t"}
"""Separators of columns, by their names in scenes."""

MOST_DECIMALS: Final = 15


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

    step: Decimal = Decimal(1)
    columns: tuple[str, ...] | None = None
    decimals: int | None = None
    decimal_comma: bool = False
    separator: str | None = None
    unit: LengthUnit | None = None
    angle: str = "deg"

    def __post_init__(self) -> None:
        hold(self, step=exact_step(self.step))
        if self.decimals is not None:
            hold(self, decimals=whole("output.csv.decimals", self.decimals, 0, MOST_DECIMALS))
        instance("output.csv.decimal_comma", self.decimal_comma, bool, "true or false")
        one_of("output.csv.angle", self.angle, ("deg", "rad"))
        if self.unit is not None:
            one_of("output.csv.unit", self.unit, tuple(MM_PER))
        if self.separator is not None:
            one_of("output.csv.separator", self.separator, tuple(SEPARATORS))
            if self.decimal_comma and self.separator == ",":
                raise GeometryError(CONFUSED, "output.csv.separator", self.separator)

    @property
    def between(self) -> str:
        """What stands between two columns."""
        return SEPARATORS[self.separator or (";" if self.decimal_comma else ",")]


def exact_step(step: Decimal | float) -> Decimal:
    """A step of the cam angle [degrees], see `camgeo.numeric.checked.decimal`."""
    return decimal("output.csv.step", step, SMALLEST_STEP, LARGEST_STEP, "degrees")


def parse(table: Mapping[str, Any]) -> CsvSpec:
    """The options of the table."""
    given = dict(table)
    if "columns" in given:
        given["columns"] = tuple(given["columns"])
    if "decimals" in given:
        given["decimals"] = int(given["decimals"])
    return CsvSpec(**given)


def commas_are_told_apart(values: Values) -> Iterator[tuple[str, str]]:
    """Commas in numbers and between columns are not the same."""
    table = ("output", "csv")
    if values.get(*table, "decimal_comma") and values.get(*table, "separator") == ",":
        yield "separator", CONFUSED


CONFUSED: Final = 'must be ";" or "tab" where numbers have a decimal comma'

FORMAT: Final = Format(
    "csv", ".csv", parse, schema_beside(__file__), rules=(commas_are_told_apart,)
)
