"""Which tolerance is enough at one speed of the cam: beyond it, the cam runs no better.

Of the contours of one form the loosest is enough from which on each tighter one, of those measured,
changes none of three benefits by more than `SHARE` of the exact motion's figure: the deviation of
the acceleration, that of the contact force, and the lift-off speed.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

from camgeo.accuracy.benefit import BenefitRow
from camgeo.accuracy.rows import FORMS

SHARE: Final = 0.05
"""Change of a benefit, relative to the exact motion, that is worth nothing."""


@dataclass(frozen=True, slots=True)
class Enough:
    """The contour that is enough.

    Attributes
    ----------
    row : of it.
    gain : largest share by which a tighter one of those measured changes a benefit; 0 if there is
        none.
    last : whether it is the tightest one measured, so that a tighter one may be worth it.
    """

    row: BenefitRow
    gain: float
    last: bool


def enough(rows: Sequence[BenefitRow]) -> Enough | None:
    """The contour that is enough, of `rows` of one form and speed; None if none has values."""
    known = sorted(
        (row for row in rows if row.acceleration is not None),
        key=lambda row: row.tolerance,
        reverse=True,
    )
    for number, row in enumerate(known):
        gain = max((change(row, other) for other in known[number + 1 :]), default=0.0)
        if gain <= SHARE:
            return Enough(row, gain, last=number == len(known) - 1)
    return None


def change(row: BenefitRow, other: BenefitRow) -> float:
    """The largest change of a benefit from one contour to another, relative to the exact motion."""
    figures = (
        (row.acceleration, other.acceleration, row.exact_acceleration),
        (row.force, other.force, row.exact_force),
        (row.lift_off, other.lift_off, row.exact_lift_off),
    )
    found = [
        abs(one - two) / exact
        for one, two, exact in figures
        if one is not None and two is not None and exact and math.isfinite(one + two + exact)
    ]
    return max(found, default=0.0)


def of_each_form(rows: Sequence[BenefitRow]) -> tuple[str, ...]:
    """What is enough of each form, of `rows` of one speed, and why; forms without values are left
    out.
    """
    each = [enough([row for row in rows if row.form == form]) for form in FORMS]
    return tuple(words(found) for found in each if found is not None) or (words(None),)


def words(found: Enough | None) -> str:
    """What is enough, and why."""
    if found is None:
        return "the motion on the written contour is not known for any of these tolerances"
    row = found.row
    parts = [f"{row.form} within {row.tolerance:g} mm"]
    if row.ripple is not None:
        parts.append(f"the acceleration is off by up to {100.0 * row.ripple:.3g} % of its peak")
    if row.force is not None:
        parts.append(f"the contact force by up to {row.force:.3g} N")
    if found.last:
        return f"{', '.join(parts)}; it still improves, and no tighter tolerance was tried"
    gain = f"{100.0 * found.gain:.2g} %"
    return f"{', '.join(parts)}; tighter ones change none of its benefits by more than {gain}"
