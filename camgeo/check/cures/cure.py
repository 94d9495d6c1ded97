"""A cure: one knob of the design, turned just far enough to remove cusps and undercut."""

from __future__ import annotations

import math
from dataclasses import dataclass
from decimal import ROUND_CEILING, ROUND_FLOOR, Decimal

DIGITS = 6
"""Significant digits of a length in a sentence, unless the change needs more."""

OF_CHANGE = 3
"""Significant digits of a change that the lengths before and after must show."""

Value = float | Decimal | str


@dataclass(frozen=True, slots=True)
class Change:
    """One key of the scene with another value.

    Attributes
    ----------
    key : path of the key in the scene, e.g. "motion[2].span".
    value_from, value_to : the present and the new value [mm or degrees], or names of laws.
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
    """The smallest change of one knob that removes cusps and undercut; or that there is none.

    Attributes
    ----------
    knob : "base radius", "roller radius", "offset", "arm", "longer segment" or "other law".
    key : path of its key in the scene.
    value_from : the present value, in `unit`; for a law its name.
    value_to : for a length the limit itself, at which the finding is about to disappear; for a span
        the next millionth of a degree beyond the limit; for a law its name. None if the knob has
        no cure.
    unit : "mm", "deg" or "".
    cost : relative change, referred to the base radius for an offset; for a law the relative
        increase of its peak acceleration, 0 if that does not grow. The largest one if several
        moves change. None if the knob has no cure.
    sentence : all of this in words.
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

    The cost is the change relative to `scale` [mm]. Without a limit it is no cure, as `none` says.
    """
    key = f"follower.{knob.replace(' ', '_')}"
    if limit is None:
        return no_cure(knob, key, old, "mm", none)
    near = "just " if knob in ("offset", "arm") else ""
    digits = digits_for(old, limit)
    limit_text, present = rounded_beyond(limit, digits, upward=upward), f"{old:.{digits}g}"
    cost = abs(limit - old) / scale
    sentence = (
        f"{knob} {near}{'above' if upward else 'below'} {limit_text} mm instead of {present} mm"
        f" ({key}, a change by {percent(cost)})"
    )
    return Cure(knob, key, old, limit, "mm", cost, sentence)


def no_cure(knob: str, key: str, old: Value, unit: str, reason: str) -> Cure:
    """The statement that a knob has no cure, with the reason as a sentence."""
    return Cure(knob, key, old, None, unit, None, reason)


def digits_for(old: float, new: float) -> int:
    """Significant digits that show the change from `old` to `new`."""
    change, size = abs(new - old), max(abs(old), abs(new))
    if change == 0.0:
        return DIGITS
    return min(max(DIGITS, OF_CHANGE + math.ceil(math.log10(size / change))), 17)


def rounded_beyond(value: float, digits: int, *, upward: bool) -> str:
    """`value` rounded up or down to significant digits, to the side on which it cures."""
    exact = Decimal(value)
    if not exact:
        return "0"
    step = Decimal(1).scaleb(exact.adjusted() + 1 - digits)
    rounded = exact.quantize(step, rounding=ROUND_CEILING if upward else ROUND_FLOOR)
    return f"{rounded.normalize():f}"


def percent(share: float) -> str:
    """A fraction in per cent, for a sentence."""
    return f"{100.0 * share:.3g} %"
