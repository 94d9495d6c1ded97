"""What several effects tell alike."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final

from camgeo.check.finding import Finding
from camgeo.effects.carrier import holds_both_ways
from camgeo.effects.effect import toucher
from camgeo.numeric.extremes import piecewise_extremes
from camgeo.units import TURN

if TYPE_CHECKING:
    from camgeo.check.finding import Severity
    from camgeo.effects.effect import Quantity, Subject
    from camgeo.numeric.arrays import FloatArray
    from camgeo.numeric.extremes import Extreme, Extremes

TOUCH: Final = 1e-9
"""A contact force on the wrong side of zero by less than this share of the largest is rounding."""


def at(phi: float) -> str:
    """The place `phi` [rad], in words."""
    return f"at cam angle {degrees(phi)}"


def degrees(phi: float) -> str:
    """The cam angle `phi` [rad], of any turn, in degrees."""
    return f"{math.degrees(phi % TURN):.4f} deg"


def placed(
    name: str,
    sentence: str,
    end: Extreme,
    unit: str,
    limit: float | None = None,
    severity: Severity = "ok",
) -> Finding:
    """A value [`unit`] with its place, which may be of any turn."""
    return Finding(name, severity, sentence, end.value, limit, unit, end.place % TURN)


def extreme_finding(name: str, words: str, end: Extreme, unit: str, sign: str = "") -> Finding:
    """A largest or smallest value [`unit`] with its place; `sign` says what is positive."""
    angle = f"{math.degrees(end.place):.6g} deg"
    return placed(name, f"{words} {end.value:.6g} {unit}{sign}, at cam angle {angle}", end, unit)


def extreme_findings(
    name: str, words: str, ends: Extremes, unit: str, sign: str = ""
) -> list[Finding]:
    """The largest and the smallest value, see `extreme_finding`."""
    return [
        extreme_finding(f"{which}-{name}", f"{which} {words}", end, unit, sign)
        for which, end in (("largest", ends.highest), ("smallest", ends.lowest))
    ]


def loss_of_contact(
    name: str, what: str, subject: Subject, normal: Quantity, edges: FloatArray
) -> tuple[Finding, ...]:
    """A warning if the one flank there is would have to pull; `what` does not hold then.

    `normal` is the contact force [N], positive where the inner flank carries, smooth between two
    of `edges` (k,) [rad].
    """
    if holds_both_ways(subject):
        return ()
    push = float(subject.cam.contact.push)
    ends = piecewise_extremes(lambda phi, side: push * normal(phi, side), edges)
    lowest = ends.lowest
    if lowest.value >= -TOUCH * ends.magnitude:
        return ()
    sentence = (
        f"the {toucher(subject)} leaves the flank, and the {what} holds only as long as it does"
        f" not: contact force {lowest.value:.5g} N {at(lowest.place)}"
    )
    return (placed(name, sentence, lowest, "N", 0.0, "warning"),)
