"""What a cure is: one knob of the design, turned as little as removes cusps and undercut."""

from __future__ import annotations

import math
from dataclasses import dataclass
from decimal import ROUND_CEILING, ROUND_FLOOR, Decimal

DIGITS = 6
"""Significant digits of a length in a sentence, where the change does not ask for more."""

OF_CHANGE = 3
"""Significant digits of a change that can be read from the lengths before and after."""

Value = float | Decimal | str


@dataclass(frozen=True, slots=True)
class Change:
    """One key of the scene with another value.

    Attributes
    ----------
    key : path of the key in the scene, e.g. "motion[2].span".
    value_from, value_to : the present value and the other one [mm or degrees], or names of laws.
    """

    key: str
    value_from: Value
    value_to: Value

    def cure(
        self, knob: str, unit: str, cost: float, sentence: str, also: tuple[Change, ...]
    ) -> Cure:
        """The cure that it is, `also` the other changes that go with it."""
        return Cure(knob, self.key, self.value_from, self.value_to, unit, cost, sentence, also)


@dataclass(frozen=True, slots=True)
class Cure:
    """The smallest turn of one knob that removes cusps and undercut; or that none does.

    Attributes
    ----------
    knob : "base radius", "roller radius", "offset", "arm", "longer segment" or "other law".
    key : path of its key in the scene; empty if no single key is at fault.
    value_from : the present value, in `unit`; the name of a law.
    value_to : of a length the limit itself, where the finding is about to disappear; of a span the
        next millionth of a degree beyond the limit; of a law its name. None if the knob has no
        cure.
    unit : "mm", "deg" or "".
    cost : share of the present value by which it changes, of the base radius for an offset; of a
        law the share by which the peak of its acceleration grows, 0 if it does not. The largest
        one if several moves change. None if the knob has no cure.
    sentence : all this in words.
    also : the other keys that change with it, e.g. the dwells beside a longer move.
    """

    knob: str
    key: str
    value_from: Value
    value_to: Value | None
    unit: str
    cost: float | None
    sentence: str
    also: tuple[Change, ...] = ()

    @property
    def works(self) -> bool:
        """Whether the knob has a cure."""
        return self.value_to is not None


def length_cure(
    knob: str, old: float, limit: float | None, scale: float, none: str, *, upward: bool = True
) -> Cure:
    """The cure by the follower's length `knob` [mm]: above `limit` if `upward`, else below.

    The cost is the change as a share of `scale` [mm]. Without a limit it is none, and says `none`.
    """
    key = f"follower.{knob.replace(' ', '_')}"
    if limit is None:
        return no_cure(knob, key, old, "mm", none)
    near = "just " if knob in ("offset", "arm") else ""
    digits = digits_for(old, limit)
    told, present = told_beyond(limit, digits, upward=upward), f"{old:.{digits}g}"
    cost = abs(limit - old) / scale
    sentence = (
        f"{knob} {near}{'above' if upward else 'below'} {told} mm instead of {present} mm"
        f" ({key}, a change by {told_share(cost)})"
    )
    return Cure(knob, key, old, limit, "mm", cost, sentence)


def no_cure(knob: str, key: str, old: Value, unit: str, reason: str) -> Cure:
    """That a knob has no cure, with the reason as a sentence."""
    return Cure(knob, key, old, None, unit, None, reason)


def digits_for(old: float, new: float) -> int:
    """Significant digits in which the change from `old` to `new` can be read."""
    change, size = abs(new - old), max(abs(old), abs(new))
    if change == 0.0:
        return DIGITS
    return min(max(DIGITS, OF_CHANGE + math.ceil(math.log10(size / change))), 17)


def told_beyond(value: float, digits: int, *, upward: bool) -> str:
    """`value` rounded up, or down, to significant digits: to the side where the cure is."""
    exact = Decimal(value)
    if not exact:
        return "0"
    step = Decimal(1).scaleb(exact.adjusted() + 1 - digits)
    rounded = exact.quantize(step, rounding=ROUND_CEILING if upward else ROUND_FLOOR)
    return f"{rounded.normalize():f}"


def told_share(share: float) -> str:
    """A share in per cent, for a sentence."""
    return f"{100.0 * share:.3g} %"
