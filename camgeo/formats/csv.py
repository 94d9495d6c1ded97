"""CSV: the value table."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from decimal import Decimal
from typing import Any, Final

from camgeo.formats.format import Format
from camgeo.numeric.checked import instance, number

SMALLEST_STEP: Final = 0.0001
LARGEST_STEP: Final = 90


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
        key = "output.csv.step"
        instance(key, self.step, Decimal, "a decimal number")
        step = float(self.step) if self.step.is_finite() else math.nan
        number(key, step, least=SMALLEST_STEP, most=LARGEST_STEP, unit="degrees")


def parse(table: Mapping[str, Any]) -> CsvSpec:
    """The options of the table."""
    return CsvSpec(**table)


SCHEMA: Final[Mapping[str, Any]] = {
    "description": "The value table.",
    "type": "object",
    "additionalProperties": False,
    "properties": {
        "step": {
            "description": "Step of the cam angle [degrees], 0.0001 to 90. Default 1.",
            "type": "number",
            "minimum": SMALLEST_STEP,
            "maximum": LARGEST_STEP,
            "default": 1,
            "x-unit": "degrees",
            "x-exact": True,
        }
    },
}

FORMAT: Final = Format("csv", ".csv", parse, SCHEMA)
