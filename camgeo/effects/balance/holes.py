"""Equal holes through a disc that cancel its unbalance.

The holes stand in a row on a circle about the cam axis, symmetric about the heavy direction. Each
of n holes of diameter d on the radius R, through the thickness b of a disc of density rho, takes
off the mass rho b pi d^2 / 4; the directions of neighbours differ by the angle delta. Together
they take off the unbalance

    U = rho b pi d^2 / 4 * R * sin(n delta/2) / sin(delta/2),

the sum of n vectors of one length, each turned by delta against the one before (Norton, "Machine
Design", chapter on balancing, static balance, for the vector sum of the m r products). Between two
neighbours half a diameter of material is left: sin(delta/2) = 3 d / (4 R).
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final

import numpy as np

from camgeo.numeric.arrays import FloatArray
from camgeo.numeric.roots import bracketed_roots

MOST_HOLES: Final = 24
"""With more the disc is a matter of its design, not of balancing."""

PITCH: Final = 1.5
"""Distance of neighbouring holes from centre to centre, in diameters."""


@dataclass(frozen=True, slots=True)
class Row:
    """A row of equal holes.

    Attributes
    ----------
    count : number of holes.
    diameter : of each [mm].
    radius : of the circle of their centres about the cam axis [mm].
    directions : of their centres [rad], counter-clockwise from the x axis, ascending.
    """

    count: int
    diameter: float
    radius: float
    directions: tuple[float, ...]

    @property
    def centres(self) -> tuple[complex, ...]:
        """Of the holes, in cam coordinates [mm]."""
        return tuple(
            complex(self.radius * math.cos(angle), self.radius * math.sin(angle))
            for angle in self.directions
        )

    def moment(self, per_area: float) -> complex:
        """What they take off of the unbalance [t mm], for `per_area` [t/mm^2] of the disc."""
        each = per_area * 0.25 * math.pi * self.diameter**2
        return each * complex(
            math.fsum(centre.real for centre in self.centres),
            math.fsum(centre.imag for centre in self.centres),
        )


def rows(unbalance: complex, per_area: float, radius: float, largest: float) -> Iterator[Row]:
    """Rows of holes that cancel `unbalance`, of few holes first.

    Parameters
    ----------
    unbalance : [t mm], its direction in cam coordinates; not 0.
    per_area : mass a unit of area of the disc [t/mm^2], density times thickness.
    radius : of the circle of their centres [mm].
    largest : diameter of a hole at most [mm].

    With its gaps a row goes round half a turn at most, where more holes still take off more.
    """
    heavy = math.atan2(unbalance.imag, unbalance.real)
    for count in range(1, MOST_HOLES + 1):
        diameter = _diameter(abs(unbalance), per_area, radius, count)
        if diameter is None or diameter > largest:
            continue
        delta = 0.0 if count == 1 else 2.0 * math.asin(0.5 * PITCH * diameter / radius)
        middle = 0.5 * (count - 1)
        directions = tuple(heavy + (k - middle) * delta for k in range(count))
        yield Row(count, diameter, radius, directions)


def _diameter(unbalance: float, per_area: float, radius: float, count: int) -> float | None:
    """Of `count` holes that cancel `unbalance`; None if half a turn has no room for them."""
    share = unbalance / (per_area * 0.25 * math.pi * radius)  # d^2 sin(n delta/2) / sin(delta/2)
    if count == 1:
        return math.sqrt(share)
    # With u = delta/2 and d = 2 R sin(u) / PITCH: sin(u) sin(n u), which grows up to n u = pi/2.
    sought = share * (0.5 * PITCH / radius) ** 2
    last = 0.5 * math.pi / count
    if sought > math.sin(last):
        return None

    def missing(u: FloatArray) -> FloatArray:
        found: FloatArray = np.sin(u) * np.sin(count * u) - sought
        return found

    u = bracketed_roots(missing, np.array([0.0]), np.array([last]))
    return 2.0 * radius * math.sin(float(u[0])) / PITCH


def most(per_area: float, radius: float, largest: float) -> float:
    """The largest unbalance [t mm] that a row of holes can cancel."""

    def of(count: int) -> float:
        if count == 1:
            return largest**2
        u = min(math.asin(min(0.5 * PITCH * largest / radius, 1.0)), 0.5 * math.pi / count)
        diameter = min(largest, 2.0 * radius * math.sin(u) / PITCH)
        return diameter**2 * math.sin(count * u) / math.sin(u)

    best = max(of(count) for count in range(1, MOST_HOLES + 1))
    return per_area * 0.25 * math.pi * radius * best
