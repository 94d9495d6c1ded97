"""What several effects tell alike."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from camgeo.check.finding import Finding
from camgeo.effects.touching import holds_both_ways
from camgeo.errors import EffectError
from camgeo.numeric.extremes import piecewise_extremes
from camgeo.units import TURN

if TYPE_CHECKING:
    from camgeo.check.finding import Severity
    from camgeo.effects.effect import Quantity, Subject
    from camgeo.mechanism.kind import Unit
    from camgeo.numeric.arrays import FloatArray
    from camgeo.numeric.extremes import Extreme, Extremes

N_M: Final = 1e-3
"""N m, or J, in an N mm; W in an N mm/s."""

KG: Final = 1e3
"""kg in a t."""

KG_M2: Final = 1e-3
"""kg m^2 in a t mm^2."""


@dataclass(frozen=True, slots=True)
class Shown:
    """What a quantity is called, in which unit it is shown, and how many of it are one inside."""

    word: str
    unit: str
    scale: float


FORCES: Final[Mapping[Unit, Shown]] = {
    "mm": Shown("force", "N", 1.0),
    "rad": Shown("torque", "N m", N_M),
}
"""The generalised force on a follower, by the unit of its lift."""

TOUCH: Final = 1e-9
"""A contact force on the wrong side of zero by less than this share of the largest is rounding."""


def at(phi: float) -> str:
    """The place `phi` [rad], in words."""
    return f"at cam angle {degrees(phi)}"


def degrees(phi: float) -> str:
    """The cam angle `phi` [rad], of any turn, in degrees."""
    return f"{math.degrees(phi % TURN):.4f} deg"


def between(stretch: tuple[float, float]) -> str:
    """The stretch from, to [rad], in words."""
    first, last = (math.degrees(each) for each in stretch)
    return f"from cam angle {first:.4f} to {last:.4f} deg"


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


def missed(
    what: str, error: float, of: str, tolerance: float, cam_angle: float | None = None
) -> EffectError:
    """The error of a numerical effect that reaches no more than `error`, a share of `of`."""
    return EffectError(
        f"{what} has an error of {error:.3g} of {of}; the tolerance is {tolerance:g}",
        value=error,
        limit=tolerance,
        cam_angle=cam_angle,
    )


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
        f"the {subject.cam.follower.touching} leaves the flank, and the {what} holds only as long"
        f" as it does not: contact force {lowest.value:.5g} N {at(lowest.place)}"
    )
    return (placed(name, sentence, lowest, "N", 0.0, "warning"),)
