"""Line contact of two elastic cylinders with parallel axes, after Hertz.

With the force F over the width L, the contact modulus E*, 1/E* = (1 - nu_1^2)/E_1 +
(1 - nu_2^2)/E_2, and the relative curvature 1/R = 1/R_1 + 1/R_2 (convex positive), the contact has
the half width b, b^2 = 4 F R / (pi E* L), and its largest pressure is p = 2 F / (pi b L) =
sqrt(F E* / (pi L R)) (Johnson, Contact Mechanics, section 4.2 (c); Norton, Machine Design, 4th ed.,
eqs. 7.14 and 7.15b). This holds if b is small compared with R and L, without friction and without
edge effects.

Below the middle of the contact, at the depth z, the stress along the normal is -p / sqrt(1 +
z^2/b^2), that in the rolling direction -p ((1 + 2 z^2/b^2) / sqrt(1 + z^2/b^2) - 2 z/b), and the
shear half their difference, p (z/b - (z/b)^2 / sqrt(1 + z^2/b^2)) (Johnson, the same section). With
z/b = tan(theta) it is largest where sin(theta)^3 - 2 sin(theta) + 1 = 0: sin(theta) is the golden
ratio 0.618..., which gives the two constants below in closed form. For Poisson's ratios of 0.25 or
more this is the largest shear in any plane; for smaller ones the shear in a plane across the width
is larger, near the surface.
"""

from __future__ import annotations

import math
from typing import Final

GOLDEN: Final = 0.5 * (math.sqrt(5.0) - 1.0)

SHEAR_SHARE: Final[float] = GOLDEN**2.5
"""Largest shear below the contact as a share of the pressure, 0.30028."""

SHEAR_DEPTH: Final = math.sqrt(GOLDEN)
"""Its depth as a share of the half width, 0.78615."""


def largest_pressure(load: float, modulus: float, radius: float) -> float:
    """p [MPa] for F/L `load` [N/mm], E* `modulus` [MPa] and R `radius` [mm] above 0."""
    return math.sqrt(load * modulus / (math.pi * radius))


def half_width(load: float, modulus: float, radius: float) -> float:
    """b [mm] for F/L `load` [N/mm], E* `modulus` [MPa] and R `radius` [mm] above 0."""
    return math.sqrt(4.0 * load * radius / (math.pi * modulus))


def needed_radius(load: float, modulus: float, pressure: float) -> float:
    """R [mm] at which the largest pressure is `pressure` [MPa] above 0, see `largest_pressure`."""
    return load * modulus / (math.pi * pressure * pressure)


def roller_radii(needed: float, curvature: float) -> tuple[float, float] | None:
    """Range of roller radii, from and to [mm], for which R is at least `needed` [mm].

    Parameters
    ----------
    needed : the R needed, 0 or more.
    curvature : of the pitch curve, positive if convex towards the roller [1/mm]; it is unchanged.

    Returns
    -------
    The upper end is infinite where the path is straight or concave; None if no radius will do.

    R = r (1 - r kappa) for the roller radius r, see `camgeo.effects.contact_pressure.line_contact`.
    On a convex path it has a maximum, 1/(4 kappa), at half the radius of curvature. The lower root
    of the quadratic equation is computed from the upper one, to avoid cancellation.
    """
    rest = 1.0 - 4.0 * needed * curvature
    if rest < 0.0:
        return None
    root = 1.0 + math.sqrt(rest)
    return 2.0 * needed / root, root / (2.0 * curvature) if curvature > 0.0 else math.inf
