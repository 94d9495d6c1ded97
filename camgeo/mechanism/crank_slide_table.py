"""The value table of a driven crank-slide, as the SAM exercise prints it for one of them."""

from __future__ import annotations

import math
from dataclasses import dataclass
from decimal import Decimal, localcontext
from fractions import Fraction
from typing import Final

import numpy as np

from camgeo.errors import GeometryError
from camgeo.mechanism.crank_slide_drive import DrivenSlide
from camgeo.numeric.arrays import FloatArray, frozen

NAMES: Final = ("crank [deg]", "time [s]", "phi [deg]", "omega2 [rad/s]", "eps2 [rad/s^2]")
"""Columns in the order of the exercise's table."""

SMALLEST_STEP: Final = Decimal("0.001")
LARGEST_STEP: Final = Decimal(90)

PRINTED_STEP: Final = Decimal(1)
"""The step of the exercise's table [deg]."""

PRINTED_DECIMALS: Final = 3
"""Decimals of all its columns but the crank angle."""

MOST_DECIMALS: Final = 12
"""Of a step and of the ends of a table."""

FULL_TURN: Final = Decimal(360)


@dataclass(frozen=True, slots=True, eq=False)
class SlideTable:
    """Values of a crank-slide at equidistant crank angles.

    Attributes
    ----------
    crank : (n,) crank angles [deg], exact.
    values : (n, 5), the columns `NAMES`; angles are counted as the crank turns, the time from the
        crank angle 0. Finite, no -0.0.
    """

    crank: tuple[Decimal, ...]
    values: FloatArray

    def __post_init__(self) -> None:
        object.__setattr__(self, "values", frozen(self.values, np.float64))

    def printed(self) -> list[tuple[str, ...]]:
        """The rows rounded as in the exercise, to three decimals.

        A double is rounded from all its digits; what rounds to zero has no sign. The crank angle is
        exact, with as many decimals as the rows need.
        """
        places = max(_places(angle) for angle in self.crank)
        return [
            (f"{angle:.{places}f}", *(f"{value:z.{PRINTED_DECIMALS}f}" for value in row[1:]))
            for angle, row in zip(self.crank, self.values.tolist(), strict=True)
        ]


def slide_table(
    driven: DrivenSlide,
    step: Decimal = PRINTED_STEP,
    first: Decimal = Decimal(0),
    last: Decimal = FULL_TURN,
) -> SlideTable:
    """Tabulate a crank-slide at first, first + step, ... below last, and at last.

    The multiples are exact, so no row is lost or doubled by rounding; a step that does not divide
    the range makes the last interval a shorter one. Past 180 degrees the values are those of 360
    degrees less the angle with the signs that symmetry gives, so that both halves agree to the last
    digit and phi and eps_2 at 180 degrees are 0.

    Parameters
    ----------
    driven : the crank-slide and its speed.
    step : of the crank angle [deg], from 0.001 to 90.
    first, last : crank angles [deg], 0 <= first < last <= 360.
        All three with at most twelve decimals.

    Raises
    ------
    GeometryError
        With key "step", "from" or "to" outside these limits; with key "from" or "to", if the crank
        is as long as the distance of the axes and the range has 0 or 360, where phi is undefined.
    """
    _check(step, first, last)
    with localcontext() as context:
        # Three digits before the point and `MOST_DECIMALS` after it: every sum is exact.
        context.prec = max(context.prec, 28)
        count = math.ceil(Fraction(last - first) / Fraction(step))
        crank = (*(first + step * number for number in range(count)), last)
        folded = [min(angle, FULL_TURN - angle) for angle in crank]
    half = FULL_TURN / 2
    side = np.array([float((angle < half) - (angle > half)) for angle in crank])
    slide = driven.slide
    if slide.crank == slide.distance:
        for key, end in (("from", first), ("to", last)):
            if end % FULL_TURN == 0:
                raise GeometryError(
                    "the crank is as long as the distance of the axes, and at 0 and 360 degrees its"
                    " pin lies in the axis of the slide, whose angle is undefined there; allowed is"
                    " what lies between",
                    key=key,
                    value=str(end),
                )
    phi, omega, eps = driven.output(np.radians([float(angle) for angle in folded]))
    degrees = np.array([float(angle) for angle in crank])
    columns = (degrees, degrees / 360.0 * driven.turn_time, side * np.degrees(phi), omega)
    return SlideTable(crank, np.column_stack((*columns, side * eps)) + 0.0)


def _check(step: Decimal, first: Decimal, last: Decimal) -> None:
    for key, number in (("step", step), ("from", first), ("to", last)):
        if number.is_finite() and _places(number) > MOST_DECIMALS:
            raise GeometryError(
                f"at most {MOST_DECIMALS} decimals are allowed", key=key, value=str(number)
            )
    if not (step.is_finite() and SMALLEST_STEP <= step <= LARGEST_STEP):
        raise GeometryError(
            f"the step of the crank angle must be from {SMALLEST_STEP} to {LARGEST_STEP} degrees",
            key="step",
            value=str(step),
        )
    if not (first.is_finite() and 0 <= first < FULL_TURN):
        raise GeometryError(
            "the first crank angle must be from 0 to less than 360 degrees",
            key="from",
            value=str(first),
        )
    if not (last.is_finite() and first < last <= FULL_TURN):
        raise GeometryError(
            f"the last crank angle must be above the first, {first}, and at most 360 degrees",
            key="to",
            value=str(last),
        )


def _places(number: Decimal) -> int:
    """Decimals of a finite number, those that are 0 at its end left out."""
    exponent = number.normalize().as_tuple().exponent
    assert isinstance(exponent, int)  # it is a letter for what is no number
    return max(0, -exponent)
