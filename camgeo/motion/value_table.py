"""The value table of a normalised law, as the appendix of VDI 2143-1 prints it for four laws."""

from __future__ import annotations

import math
from dataclasses import dataclass
from decimal import Decimal, localcontext
from fractions import Fraction
from typing import Final

import numpy as np

from camgeo.motion.laws.law import Law
from camgeo.numeric import checked
from camgeo.numeric.arrays import FloatArray, frozen
from camgeo.pickled import Pickled

SMALLEST_STEP: Final = Decimal("0.000001")
LARGEST_STEP: Final = Decimal("0.5")

PRINTED_STEP: Final = Decimal("0.002")
"""The step of the guideline's tables."""

NAMES: Final = ("z", "f", "f1", "f2", "f3")

PRINTED_DECIMALS: Final = (7, 4, 4)
"""Decimals of f, f' and f'' in the guideline's tables."""

PRINTED_DECIMALS_OF_Z: Final = 3
"""Decimals of z; a finer step needs more."""


@dataclass(frozen=True, slots=True, eq=False)
class LawTable(Pickled):
    """Values of a law at equidistant z.

    Attributes
    ----------
    z : (n,) from 0 to 1, exact.
    values : (n, 5), the columns `NAMES`: z, each rounded once from its decimal, f, f', f'', f'''.
        Right-hand values at the law's borders, left-hand ones at z = 1; no -0.0.
    """

    z: tuple[Decimal, ...]
    values: FloatArray

    def __post_init__(self) -> None:
        checked.hold(self, values=frozen(self.values, np.float64))

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
    step = checked.decimal("step", step, SMALLEST_STEP, LARGEST_STEP, what="step of z")
    with localcontext() as context:
        # Fewer than 10^7 multiples: seven digits more than the step has hold each of them.
        context.prec = max(context.prec, len(step.as_tuple().digits) + 7)
        count = math.ceil(1 / Fraction(step))
        z = (*(step * number for number in range(count)), Decimal(1))
    rounded = np.array([float(place) for place in z])
    values = np.column_stack((rounded, *law(rounded)))
    return LawTable(z, values + 0.0)
