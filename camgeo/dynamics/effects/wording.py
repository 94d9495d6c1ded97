"""Wording, units and findings that several effects share."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Final

from camgeo.check.finding import Finding, Severity
from camgeo.errors import EffectError
from camgeo.numeric.arrays import resolved
from camgeo.numeric.extremes import Extreme, Extremes
from camgeo.units import LiftUnit, at_cam_angles, cam_angle, cam_angle_range, listed

N_M: Final = 1e-3
"""Factor from N mm to N m or J, and from N mm/s to W."""

KG: Final = 1e3
"""Factor from t to kg."""

KG_M2: Final = 1e-3
"""Factor from t mm^2 to kg m^2."""


@dataclass(frozen=True, slots=True)
class Label:
    """How a quantity is displayed: its name, its unit, and the factor from the internal unit."""

    word: str
    unit: str
    scale: float

    def format(self, value: float) -> str:
        """A `value` in the internal unit as text."""
        return f"{self.scale * value:.4g} {self.unit}"


FORCES: Final[Mapping[LiftUnit, Label]] = {
    "mm": Label("force", "N", 1.0),
    "rad": Label("torque", "N m", N_M),
}
"""The generalised force on a follower, by the unit of its lift."""

MASSES: Final[Mapping[LiftUnit, Label]] = {
    "mm": Label("mass", "kg", KG),
    "rad": Label("moment of inertia", "kg m^2", KG_M2),
}
"""The inertia of a follower, by the unit of its lift."""


def spring_scale(unit: str) -> float:
    """The factor from internal units to the `unit` in which a property of a spring is displayed."""
    return N_M if unit.startswith("N m") and not unit.startswith("N mm") else 1.0


def at_angle(phi: float) -> str:
    """The place `phi` [rad] in words."""
    return at_cam_angles(phi, form=".4f")


def degrees(phi: float) -> str:
    """The cam angle `phi` [rad], in any turn, as text in degrees."""
    return f"{cam_angle(phi, '.4f')} deg"


def over_range(stretch: tuple[float, float]) -> str:
    """The range (from, to) [rad] in words."""
    return cam_angle_range(*stretch, form=".4f")


MOST_LISTED: Final = 8
"""Largest number of places that are listed one by one."""


def at_angles(places: Sequence[float]) -> str:
    """The cam angles `places` [rad], one or more, in words."""
    return at_cam_angles(*places, form=".4f", most=MOST_LISTED)


def by_place(places: Sequence[float]) -> list[Sequence[float]]:
    """The `places` [rad] of one kind of finding: one finding each, or a single one for many."""
    if len(places) > MOST_LISTED:
        return [places]
    return [[place] for place in places]


def over_ranges(ranges: Sequence[tuple[float, float]]) -> str:
    """The ranges (from, to) [rad], one or more, in words."""
    if len(ranges) == 1:
        return over_range(ranges[0])
    texts = [f"{cam_angle(start, '.4f')} to {cam_angle(end, '.4f')}" for start, end in ranges]
    return f"from cam angle {listed(texts, MOST_LISTED)} deg"


def placed(
    name: str,
    sentence: str,
    end: Extreme,
    unit: str,
    limit: float | None = None,
    severity: Severity = "ok",
) -> Finding:
    """The finding of a value [`unit`] with its place, which may be in any turn."""
    return Finding(name, severity, sentence, end.value, limit, unit, end.place)


def resolved_ends(ends: Extremes, size: float = 0.0) -> Extremes:
    """The extremes, 0 where they are but rounding of the larger one, or of terms of that `size`."""
    most = max(size, ends.magnitude)
    lowest, highest = (
        replace(end, value=resolved(end.value, most)) for end in (ends.lowest, ends.highest)
    )
    return replace(ends, lowest=lowest, highest=highest)


LEAST_LEFT: Final = 1e-8
"""Share of a disturbance below which no figure of it is stated."""


def remaining_share(share: float, digits: int = 4) -> str:
    """The share of a disturbance that is left, in words."""
    if share < LEAST_LEFT:
        return f"less than {100.0 * LEAST_LEFT:g} %"
    return f"{100.0 * share:.{digits}g} %"


def extreme_finding(name: str, words: str, end: Extreme, unit: str, sign: str = "") -> Finding:
    """The finding of an extreme value [`unit`] with its place; `sign` says what is positive."""
    sentence = f"{words} {end.value:.6g} {unit}{sign}, {at_cam_angles(end.place)}"
    return placed(name, sentence, end, unit)


def extreme_findings(
    name: str, words: str, ends: Extremes, unit: str, sign: str = ""
) -> list[Finding]:
    """The findings of the largest and the smallest value, see `extreme_finding`."""
    extremes = resolved_ends(ends)
    return [
        extreme_finding(f"{which}-{name}", f"{which} {words}", end, unit, sign)
        for which, end in (("largest", extremes.highest), ("smallest", extremes.lowest))
    ]


def tolerance_error(
    what: str, error: float, reference: str, tolerance: float, cam_angle: float | None = None
) -> EffectError:
    """The exception for a numerical effect whose `error`, relative to the `reference`, exceeds the
    tolerance.
    """
    return EffectError(
        f"{what} has an error of {error:.3g} relative to {reference}; the tolerance is"
        f" {tolerance:g}",
        value=error,
        limit=tolerance,
        cam_angle=cam_angle,
    )
