"""The limits that a design is held to, with the defaults of the sources."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final, Literal

from camgeo.mechanism.kind import Unit
from camgeo.mechanism.values import length, right_angle
from camgeo.numeric.checked import hold, number, one_of
from camgeo.units import RPM

SLOW = 30.0 * RPM
"""Up to 30 rev/min a mechanism counts as slow (Wirsig, section 2.4)."""

OF_SLOW: Final[Mapping[Unit, float]] = {"mm": 60.0, "rad": 45.0}
"""Smallest transmission angles to aim for [degrees] in slow mechanisms, by the unit of the lift."""

OF_FAST: Final = 60.0


@dataclass(frozen=True, slots=True)
class Limits:
    """What a scene demands; None takes the default.

    Attributes
    ----------
    transmission_angle : smallest allowed [rad], up to pi/2.
    radius_ratio : largest allowed r_R / r_K (Wirsig eq. 3.36: r_K >= r_R / 0.7).
    undercut : whether a disc that undercuts is refused, or trimmed to what is left of it.
    closing_error : largest allowed play or squeeze of a conjugate pair whose discs are true to the
        tolerance, as way of the main roller [mm].

    Raises
    ------
    GeometryError
        With the key, if a value is not what it has to be.
    """

    transmission_angle: float | None = None
    radius_ratio: float = 0.7
    undercut: Literal["refuse", "trim"] = "refuse"
    closing_error: float = 0.02

    def __post_init__(self) -> None:
        if self.transmission_angle is not None:
            least = right_angle("limits.transmission_angle", self.transmission_angle)
            hold(self, transmission_angle=least)
        hold(
            self,
            radius_ratio=number("limits.radius_ratio", self.radius_ratio, above=0.0, most=1.0),
            undercut=one_of("limits.undercut", self.undercut, ("refuse", "trim")),
            closing_error=length("limits.closing_error", self.closing_error),
        )


def default_transmission_angle(unit: Unit, speed: float | None) -> float:
    """Smallest transmission angle to aim for [rad] (Wirsig, section 2.4).

    60 degrees for translating followers, of whose lift the `unit` is mm, at any speed; for the
    others 45 degrees for slow mechanisms, or where no `speed` [rad/s] is given, and 60 degrees for
    fast ones.
    """
    slow = speed is None or speed <= SLOW
    return math.radians(OF_SLOW[unit] if slow else OF_FAST)
