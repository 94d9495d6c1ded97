"""Spans of a motion's segments, whose sum is exact and stays whole, and values that are dragged."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from decimal import ROUND_HALF_EVEN, Decimal, localcontext
from itertools import accumulate
from typing import Any, Final, TypeGuard

from camgeo.errors import GeometryError
from camgeo.kinematics.plan import EXACT, FULL_TURN, SHORTEST_SPAN

Segment = Mapping[str, Any]
"""A segment of a scene, as it is stated."""


def span_key(segment: Segment) -> str:
    """The key of its span."""
    return "dwell" if "dwell" in segment else "span"


def span_of(segment: Any) -> Decimal | None:
    """Its span [degrees], exactly as written; None if it has no possible one."""
    found = segment.get(span_key(segment)) if isinstance(segment, dict) else None
    return Decimal(found) if is_number(found) and 0 <= found <= FULL_TURN else None


def spans_of(motion: Any) -> list[Decimal] | None:
    """The spans of all segments; None if one of them has none."""
    if not isinstance(motion, list):
        return None
    found = [span_of(each) for each in motion]
    spans = [each for each in found if each is not None]
    return spans if len(spans) == len(found) else None


def joints(spans: Sequence[Decimal]) -> list[Decimal]:
    """The cam angles at which segments begin, and that of the end."""
    with localcontext(EXACT):
        return list(accumulate(spans, initial=Decimal(0)))


def least_span(segment: Segment) -> Decimal:
    """The shortest span that the segment may have, judged by its own values."""
    if "dwell" in segment:
        return Decimal(0)
    points = segment.get("points")
    last = points[-1].get("at") if isinstance(points, list) and points else None
    return SHORTEST_SPAN if last is None else Decimal(last) + SHORTEST_SPAN


def is_fixed(segment: Segment) -> bool:
    """Whether a file decides its span."""
    return segment.get("law") == "table"


def span_beside(first: Segment, second: Segment, span: Decimal) -> Decimal:
    """The span of the second of two neighbours, whose sum stays, if that of the first is `span`;
    GeometryError if one has no room.
    """
    before = span_of(first), span_of(second)
    assert before[0] is not None  # only valid scenes have handles
    assert before[1] is not None
    with localcontext(EXACT):
        other = before[1] - (span - before[0])
    for segment, new, name in (
        (first, span, "this segment"),
        (second, other, "the one beside it"),
    ):
        if new < least_span(segment):
            message = f"leaves no room for {name}: {new.normalize():f} degrees"
            raise GeometryError(message, "motion", f"{new.normalize():f}")
    return other


# -- snapping -------------------------------------------------------------------------------------
# Dragged values: rounded to decimal steps, and left alone where they hardly change.


FINEST: Final = 1e-6
"""Step if none is stated [unit of the scene, degrees]."""

STEPS: Final = (1e-9, 1e6)
"""Least and greatest step."""

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
