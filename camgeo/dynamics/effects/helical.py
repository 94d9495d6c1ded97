"""A helical compression spring of round wire.

With the wire diameter d, the mean coil diameter D, n active coils and the shear modulus G, the
spring index C = D/d, and a force F,

    k = G d^4 / (8 D^3 n),      tau = K 8 F D / (pi d^3),      K = (4 C - 1)/(4 C - 4) + 0.615/C,

with Wahl's factor K for the curvature of the wire and the direct shear. As a rod that carries waves
along its axis, held at one end and driven at the other, it has the natural frequencies j f_1 with

    f_1 = 1/2 sqrt(k/m),      m = rho pi^2 d^2 D n / 4,

the mass of the active coils. Its ends seated so that a buckled spring has the effective length
alpha L_0, a spring of steel is stable at any deflection if its free length L_0 < 2.63 D/alpha.
Budynas, Nisbett, Shigley's Mechanical Engineering Design, 8th ed., chapter 10; Wahl, Mechanical
Springs, on the factor; Norton, Machine Design, chapter on springs.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final, Literal

Seats = Literal["flat", "flat-hinged", "hinged", "flat-free"]

EFFECTIVE: Final[Mapping[Seats, float]] = {
    "flat": 0.5,
    "flat-hinged": 0.707,
    "hinged": 1.0,
    "flat-free": 2.0,
}
"""alpha: effective length of the buckled spring as a share of its length, by its two seats."""

STABLE: Final = 2.63
"""Free length of a stable spring of steel in coil diameters, for alpha = 1."""


@dataclass(frozen=True, slots=True)
class HelicalSpring:
    """The spring.

    Attributes
    ----------
    wire : d [mm].
    coil : D [mm], above d.
    active, total : coils that deflect, n, and all coils.
    free_length : L_0 [mm], longer than the solid spring.
    shear_modulus : G [MPa].
    density : rho [t/mm^3].
    seats : see `EFFECTIVE`.
    strength : largest shear stress allowed [MPa]; None for no limit.
    """

    wire: float
    coil: float
    active: float
    total: float
    free_length: float
    shear_modulus: float
    density: float
    seats: Seats
    strength: float | None = None

    @property
    def index(self) -> float:
        """C."""
        return self.coil / self.wire

    @property
    def stiffness(self) -> float:
        """k [N/mm]."""
        return self.shear_modulus * self.wire / (8.0 * self.index**3 * self.active)

    @property
    def solid_length(self) -> float:
        """Length with all coils touching and ground ends [mm]."""
        return self.wire * self.total

    @property
    def solid_force(self) -> float:
        """Force at that length [N]."""
        return self.stiffness * (self.free_length - self.solid_length)

    @property
    def stress_per_force(self) -> float:
        """tau/F [1/mm^2]."""
        index = self.index
        factor = (4.0 * index - 1.0) / (4.0 * index - 4.0) + 0.615 / index
        return factor * 8.0 * index / (math.pi * self.wire**2)

    @property
    def stable_length(self) -> float:
        """Free length below which it cannot buckle [mm]."""
        return STABLE * self.coil / EFFECTIVE[self.seats]

    @property
    def surge_frequency(self) -> float:
        """2 pi f_1 [rad/s]."""
        mass = 0.25 * self.density * math.pi**2 * self.wire**2 * self.coil * self.active
        return math.pi * math.sqrt(self.stiffness / mass)
