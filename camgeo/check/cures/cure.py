"""A cure: one knob of the design, turned just far enough to remove a fault."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from decimal import ROUND_CEILING, ROUND_FLOOR, Decimal
from typing import Self

from camgeo.units import MM_PER, LengthUnit

DIGITS = 6
"""Significant digits of a length in a sentence, unless the change needs more."""

OF_CHANGE = 3
"""Significant digits of a change that the lengths before and after must show."""

MOST_DIGITS = 17
"""Significant digits that tell any two doubles apart."""

Value = float | Decimal | str


@dataclass(frozen=True, slots=True)
class Change:
    """One key of the scene with another value.

    Attributes
    ----------
    key : path of the key in the scene, e.g. "motion[2].span".
    value_from, value_to : the present and the new value, in the unit of the scene or in degrees, or
        names of laws.
    """

    key: str
    value_from: Value
    value_to: Value

    def cure(
        self, knob: str, unit: str, cost: float, sentence: str, also: tuple[Change, ...]
    ) -> Cure:
        """The change as a cure, with `also` the changes that go with it."""
        return Cure(knob, self.key, self.value_from, self.value_to, unit, cost, sentence, also)


@dataclass(frozen=True, slots=True)
class Cure:
    """The nearest value of one knob at which a fault is gone; or that there is none.

    Attributes
    ----------
    knob : "base radius", "roller radius", "offset", "arm", "longer segment" or "other law".
    key : path of its key in the scene.
    value_from : the present value, in `unit`; for a law its name.
    value_to : the value that cures: for a length the limit rounded to the side on which it cures,
        as the sentence has it; for a span the next millionth of a degree beyond the limit; for a
        law its name. None if the knob has no cure.
    unit : of both: that of the scene for a length, "deg", or "".
    cost : relative change, referred to the base radius for an offset; for a law the relative
        increase of its peak acceleration, 0 if that does not grow. The largest one if several
        moves change. None if the knob has no cure.
    sentence : all of this in words.
    also : the other keys that change with it, e.g. the dwells beside a longer move.
    limit : for a length, the exact value [mm] at which the finding disappears.
    fault : that it removes: "undercut", "radius ratio", "transmission angle" or "convexity".
    breaks : names of the findings that report limits which held, and which it breaks: empty unless
        the knob has no value that breaks none.
    """

    knob: str
    key: str
    value_from: Value
    value_to: Value | None
    unit: str
    cost: float | None
    sentence: str
    also: tuple[Change, ...] = ()
    limit: float | None = None
    fault: str = ""
    breaks: tuple[str, ...] = ()

    @property
    def statement(self) -> str:
        """The sentence, after the fault, and whether there is a cure of it."""
        return f"{self.fault}: {'' if self.works else 'no cure: '}{self.sentence}"

    @property
    def works(self) -> bool:
        """Whether the knob has a cure."""
        return self.value_to is not None


@dataclass(frozen=True, slots=True)
class Length:
    """A length that cures, and how messages show it.

    Attributes
    ----------
    limit : beyond which lengths cure [mm].
    stated : a length beyond it with few digits, which cures, in the unit of the scene.
    value : the same [mm].
    digits : number of significant digits that show the change to it.
    """

    limit: float
    stated: float
    value: float
    digits: int

    @classmethod
    def beyond(
        cls,
        old: float,
        limit: float,
        cures: Callable[[float], bool],
        unit: LengthUnit,
        *,
        upward: bool,
    ) -> Self | None:
        """The length with the fewest digits, above `limit` if `upward`, else below, that `cures`.

        The digits, in `unit`, show the change from the `old` one. All lengths in mm. None if no
        such length cures.
        """
        mm = MM_PER[unit]
        for digits in range(digits_for(old, limit), MOST_DIGITS + 1):
            for steps in (0, 1):  # a rounded length may be the limit itself
                stated = float(rounded_beyond(limit / mm, digits, upward=upward, steps=steps))
                if cures(mm * stated):
                    return cls(limit, stated, mm * stated, digits)
        return None


def length_cure(
    knob: str,
    key: str,
    old: float,
    length: Length | None,
    scale: float,
    none: str,
    unit: LengthUnit,
    bound: str = "",
) -> Cure:
    """The cure by the `length` of the follower at `key`, now `old` [mm], stated in `unit`.

    `bound` is "at least " or "at most " if all lengths beyond it cure as well. The cost is the
    change relative to `scale` [mm]. Without a length it is no cure, as `none` says.
    """
    present = old / MM_PER[unit]
    if length is None:
        return no_cure(knob, key, present, unit, none)
    cost = abs(length.limit - old) / scale
    sentence = (
        f"{knob} {bound}{shown(length.stated)} {unit} instead of {present:.{length.digits}g} {unit}"
        f" ({key}, a change by {percent(cost)})"
    )
    return Cure(knob, key, present, length.stated, unit, cost, sentence, limit=length.limit)


def no_cure(knob: str, key: str, old: Value, unit: str, reason: str) -> Cure:
    """The statement that a knob has no cure, with the reason as a sentence."""
    return Cure(knob, key, old, None, unit, None, reason)


def digits_for(old: float, new: float) -> int:
    """Significant digits that show the change from `old` to `new`."""
    change, size = abs(new - old), max(abs(old), abs(new))
    if change == 0.0:
        return DIGITS
    return min(max(DIGITS, OF_CHANGE + math.ceil(math.log10(size / change))), MOST_DIGITS)


def rounded_beyond(value: float, digits: int, *, upward: bool, steps: int = 0) -> str:
    """`value` rounded up or down to significant digits, to the side on which it cures, and `steps`
    units of the last digit farther.
    """
    exact = Decimal(value)
    if not exact and not steps:
        return "0"
    step = Decimal(1).scaleb((exact.adjusted() if exact else 0) + 1 - digits)
    rounded = exact.quantize(step, rounding=ROUND_CEILING if upward else ROUND_FLOOR)
    return f"{(rounded + (steps if upward else -steps) * step).normalize():f}"


def shown(value: float) -> str:
    """A rounded length with the digits that it has."""
    return f"{Decimal(repr(value)).normalize():f}"


def percent(share: float) -> str:
    """A fraction in per cent, for a sentence."""
    return f"{100.0 * share:.3g} %"
