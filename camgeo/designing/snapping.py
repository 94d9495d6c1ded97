"""Dragged values: rounded to decimal steps, and left alone where they hardly change."""

from __future__ import annotations

import math
from decimal import ROUND_HALF_EVEN, Decimal, localcontext
from typing import Any, Final, TypeGuard

FINEST: Final = 1e-6
"""Step if none is stated [unit of the scene, degrees]."""

STEPS: Final = (1e-9, 1e6)
"""Least and greatest step."""

FEW: Final = 3
"""Significant digits of a value that is made for a scene."""

DIGITS: Final = 60
"""Digits with which a value is rounded: more than the largest number has in the least steps."""

LARGEST: Final = 10**12
"""Magnitude of the numbers of a scene."""


def is_number(value: Any) -> TypeGuard[int | Decimal]:
    """Whether a value of a scene, right or wrong, is a finite number that a scene can have."""
    real = isinstance(value, int | Decimal) and not isinstance(value, bool)
    return real and Decimal(value).is_finite() and -LARGEST <= value <= LARGEST


def step_near(step: float) -> Decimal:
    """The greatest power of ten, or 2 or 5 times one, that does not exceed `step`."""
    step = min(max(step, STEPS[0]), STEPS[1])
    exponent = math.floor(math.log10(step * (1.0 + 1e-12)))
    digits = step / 10.0**exponent * (1.0 + 1e-12)
    return Decimal(max(each for each in (1, 2, 5) if each <= digits)).scaleb(exponent)


def snapped(value: float, step: float, before: Any = None) -> Any:
    """`value` rounded to a step of at most `step`, as a number of a scene.

    It is `before`, the number that was there, if that is within half a step of it. A whole number
    is an integer unless `before` was written as a decimal number.
    """
    by = step_near(step)
    if before is not None and abs(value - float(before)) <= 0.5 * float(by):
        return before
    with localcontext() as context:
        context.prec = DIGITS
        steps = (Decimal(value) / by).quantize(Decimal(1), ROUND_HALF_EVEN)
        return styled(steps * by, before)


def styled(value: Decimal, before: Any) -> Any:
    """An exact number, as it is written to replace `before`."""
    if not value:
        value = Decimal(0)  # and not -0
    if value == value.to_integral_value() and not isinstance(before, Decimal):
        return int(value)
    plain = value.normalize()
    return plain.quantize(Decimal(1)) if plain == plain.to_integral_value() else plain


def rounded(value: Decimal) -> Any:
    """A number with few digits."""
    if not value:
        return 0
    last = Decimal(1).scaleb(value.adjusted() + 1 - FEW)
    return styled(value.quantize(last, ROUND_HALF_EVEN), 0)
