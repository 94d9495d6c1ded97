"""CSV: the value table."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from decimal import Decimal
from typing import Any, Final

from camgeo.declared import schema_beside
from camgeo.formats.format import Format
from camgeo.numeric.checked import decimal, hold

SMALLEST_STEP: Final = Decimal("0.001")
LARGEST_STEP: Final = Decimal(90)
"""Of the cam angle [degrees]."""


@dataclass(frozen=True, slots=True)
class CsvSpec:
    """`[output.csv]`: the rows of the value table.

    Attributes
    ----------
    step : of the cam angle [degrees], exactly as written, so that the rows fall on the angles that
        the designer wrote.
    """

    step: Decimal = Decimal(1)

    def __post_init__(self) -> None:
        hold(self, step=exact_step(self.step))


def exact_step(step: Decimal | float) -> Decimal:
    """A step of the cam angle [degrees], see `camgeo.numeric.checked.decimal`."""
    return decimal("output.csv.step", step, SMALLEST_STEP, LARGEST_STEP, "degrees")


def parse(table: Mapping[str, Any]) -> CsvSpec:
    """The options of the table."""
    return CsvSpec(**table)


FORMAT: Final = Format("csv", ".csv", parse, schema_beside(__file__))
