"""Wording, units and findings that several effects share."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from camgeo.check.finding import Finding
from camgeo.effects.touching import holds_both_ways
from camgeo.errors import EffectError
from camgeo.numeric.extremes import piecewise_extremes
from camgeo.units import TURN
from camgeo.wording import at_cam_angles, cam_angle, over_cam_angles

if TYPE_CHECKING:
    from camgeo.check.finding import Severity
    from camgeo.effects.effect import Quantity, Subject
    from camgeo.numeric.arrays import FloatArray
    from camgeo.numeric.extremes import Extreme, Extremes
    from camgeo.units import LiftUnit

N_M: Final = 1e-3
"""From N mm to N m or J, and from N mm/s to W."""

KG: Final = 1e3
"""From t to kg."""

KG_M2: Final = 1e-3
"""From t mm^2 to kg m^2."""


@dataclass(frozen=True, slots=True)
class Label:
    """How a quantity is displayed: its name, its unit, and the factor from the internal unit."""

    word: str
    unit: str
    scale: float


FORCES: Final[Mapping[LiftUnit, Label]] = {
    "mm": Label("force", "N", 1.0),
    "rad": Label("torque", "N m", N_M),
}
"""The generalised force on a follower, by the unit of its lift."""

TOUCH: Final = 1e-9
"""A contact force of the wrong sign is rounding below this share of the largest one."""


def at(phi: float) -> str:
    """The place `phi` [rad] in words."""
    return at_cam_angles(phi, form=".4f")


def degrees(phi: float) -> str:
    """The cam angle `phi` [rad], in any turn, as text in degrees."""
    return f"{cam_angle(phi, '.4f')} deg"


def between(stretch: tuple[float, float]) -> str:
    """The range (from, to) [rad] in words."""
    return over_cam_angles(*stretch, form=".4f")


def placed(
    name: str,
    sentence: str,
    end: Extreme,
    unit: str,
    limit: float | None = None,
    severity: Severity = "ok",
) -> Finding:
    """The finding of a value [`unit`] with its place, which may be in any turn."""
    return Finding(name, severity, sentence, end.value, limit, unit, end.place % TURN)


def extreme_finding(name: str, words: str, end: Extreme, unit: str, sign: str = "") -> Finding:
    """The finding of an extreme value [`unit`] with its place; `sign` says what is positive."""
    sentence = f"{words} {end.value:.6g} {unit}{sign}, {at_cam_angles(end.place)}"
    return placed(name, sentence, end, unit)


def extreme_findings(
    name: str, words: str, ends: Extremes, unit: str, sign: str = ""
) -> list[Finding]:
    """The findings of the largest and the smallest value, see `extreme_finding`."""
    return [
        extreme_finding(f"{which}-{name}", f"{which} {words}", end, unit, sign)
        for which, end in (("largest", ends.highest), ("smallest", ends.lowest))
    ]


def missed(
    what: str, error: float, of: str, tolerance: float, cam_angle: float | None = None
) -> EffectError:
    """The exception for a numerical effect whose `error`, relative to `of`, exceeds the
    tolerance.
    """
    return EffectError(
        f"{what} has an error of {error:.3g} of {of}; the tolerance is {tolerance:g}",
        value=error,
        limit=tolerance,
        cam_angle=cam_angle,
    )


def loss_of_contact(
    name: str, what: str, subject: Subject, normal: Quantity, edges: FloatArray
) -> tuple[Finding, ...]:
    """A warning if the only flank would have to pull, so that `what` is not valid.

    `normal` is the contact force [N], positive where the inner flank carries, smooth between
    neighbouring `edges` (k,) [rad].
    """
    if holds_both_ways(subject):
        return ()
    push = float(subject.cam.contact.push)
    ends = piecewise_extremes(lambda phi, side: push * normal(phi, side), edges)
    lowest = ends.lowest
    if lowest.value >= -TOUCH * ends.magnitude:
        return ()
    sentence = (
        f"the {subject.cam.follower.touching} leaves the flank, and the {what} is valid only while"
        f" it does not: contact force {lowest.value:.5g} N {at(lowest.place)}"
    )
    return (placed(name, sentence, lowest, "N", 0.0, "warning"),)
