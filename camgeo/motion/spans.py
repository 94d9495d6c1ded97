"""Spans of the cam angle [degrees], exactly as written: which are valid, and their sums."""

from __future__ import annotations

from collections.abc import Iterable
from decimal import Context, Decimal, localcontext
from functools import partial
from numbers import Real
from typing import Annotated, Any, Final

from camgeo.errors import GeometryError
from camgeo.numeric import checked

FULL_TURN: Final = Decimal(360)

SHORTEST_SPAN: Final = Decimal("1e-6")
"""Shortest span of a segment that moves; below it, velocities exceed what a double can resolve."""

DECIMALS: Final = 300
"""Most decimals of a span."""

EXACT: Final = Context(prec=DECIMALS + 100)
"""In which spans are added and subtracted exactly."""


def span_of(key: str, value: Any, shortest: Decimal = Decimal(0)) -> Decimal:
    """A span from a decimal or another number; a float counts as Python prints it.

    Raises
    ------
    GeometryError
        Unless it is 0 or a number from `shortest` to 360.
    """
    found = Decimal(repr(checked.finite(key, value))) if isinstance(value, Real) else value
    if (
        not isinstance(found, Decimal)
        or not found.is_finite()
        or not (found == 0 or shortest <= found <= FULL_TURN)
        or int(found.as_tuple().exponent) < -DECIMALS
    ):
        lowest = f"0, or from {shortest} to 360" if shortest else "from 0 to 360"
        raise GeometryError(
            f"must be {lowest} (degrees), with at most {DECIMALS} decimals",
            key=key,
            value=checked.shown(str(value) if isinstance(value, Decimal) else value),
        )
    return found


Span = Annotated[Decimal, span_of]
MovingSpan = Annotated[Decimal, partial(span_of, shortest=SHORTEST_SPAN)]


def joints_of(spans: Iterable[Decimal]) -> tuple[Decimal, ...]:
    """Sums of the spans, from 0 on.

    Raises
    ------
    GeometryError
        With key "motion", if they do not end at 360 degrees exactly.
    """
    joints = [Decimal(0)]
    with localcontext(EXACT):
        for span in spans:
            joints.append(joints[-1] + span)
    if joints[-1] != FULL_TURN:
        raise GeometryError(
            f"the spans add up to {joints[-1]} degrees, they must add up to exactly 360",
            key="motion",
            value=str(joints[-1]),
        )
    return tuple(joints)
