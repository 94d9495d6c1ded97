"""The limits that a design is checked against, with the defaults of the sources."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import partial
from typing import Annotated, Final, Literal

from camgeo.mechanism.values import Length, RightAngle
from camgeo.numeric.checked import check_fields, number, one_of
from camgeo.units import RPM, LiftUnit

SLOW = 30.0 * RPM
"""Up to 30 rev/min a mechanism counts as slow (Wirsig, section 2.4)."""

OF_SLOW: Final[Mapping[LiftUnit, float]] = {"mm": 60.0, "rad": 45.0}
"""Smallest transmission angles to aim for [degrees] in slow mechanisms, by the unit of the lift."""

OF_FAST: Final = 60.0

RULE_OF_THUMB: Final = 0.7
"""Largest r_R / r_K of a roller (Wirsig eq. 3.36)."""

OF_SLOW_LINKAGE, OF_FAST_LINKAGE = 40.0, 50.0
"""Smallest transmission angles to aim for [degrees] in slow and in fast linkages, as is customary
(Volmer, Getriebetechnik)."""


@dataclass(frozen=True, slots=True)
class Limits:
    """The limits of a scene; None takes the default, where there is one.

    Attributes
    ----------
    transmission_angle : smallest allowed [rad], up to pi/2.
    linkage_transmission_angle : smallest allowed of the linkage, where it drives its far end [rad],
        up to pi/2.
    radius_ratio : largest allowed r_R / r_K (Wirsig eq. 3.36: r_K >= r_R / 0.7).
    undercut : whether a disc that undercuts is refused, or trimmed to what remains of it.
    closing_error : largest allowed play or squeeze of a conjugate pair whose discs are true to the
        tolerance, as travel of the main roller [mm].
    diameter : largest allowed of a part [mm], of the circle about the cam axis that it sweeps; None
        for no limit.
    mass : largest allowed of a part [t]; None for no limit.
    wall : smallest allowed between two boundaries of a part [mm]; None for what is usual, see
        `camgeo.part.webs`.

    Raises
    ------
    GeometryError
        With the key of an invalid value.
    """

    transmission_angle: RightAngle | None = None
    linkage_transmission_angle: RightAngle | None = None
    radius_ratio: Annotated[float, partial(number, above=0.0, most=1.0)] = RULE_OF_THUMB
    undercut: Annotated[Literal["refuse", "trim"], partial(one_of, choices=("refuse", "trim"))] = (
        "refuse"
    )
    closing_error: Length = 0.02
    diameter: Length | None = None
    mass: Annotated[float, partial(number, above=0.0)] | None = None
    wall: Length | None = None

    def __post_init__(self) -> None:
        check_fields(self, "limits.")


def default_transmission_angle(unit: LiftUnit, speed: float | None) -> float:
    """Smallest transmission angle to aim for [rad] (Wirsig, section 2.4).

    60 degrees at any speed for translating followers, whose lift has the `unit` mm; for the others
    45 degrees if the mechanism is slow, or no `speed` [rad/s] is given, else 60 degrees.
    """
    return math.radians(OF_SLOW[unit] if _is_slow(speed) else OF_FAST)


def default_linkage_transmission_angle(speed: float | None) -> float:
    """Smallest transmission angle to aim for in a linkage [rad]; `speed` [rad/s] as above."""
    return math.radians(OF_SLOW_LINKAGE if _is_slow(speed) else OF_FAST_LINKAGE)


def _is_slow(speed: float | None) -> bool:
    return speed is None or speed <= SLOW
