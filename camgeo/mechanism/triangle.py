"""The triangle of a linkage: shaft, pin and the tip of the crank, closed by crank and coupler."""

from __future__ import annotations

import numpy as np

from camgeo.mechanism.sketch import MechanismSketch
from camgeo.numeric.arrays import ComplexArray, FloatArray

ROUNDING = 8.0 * 2.0**-52
"""A difference of lengths of this share of crank and coupler is zero, rounded."""

SLACK = 64.0 * 2.0**-52
"""An angle [rad] beyond the end of a range by no more lies at its end."""

IN_LINE = 1e-6
"""Sine of the angle between two members up to which they are those that were looked for in line;
on the other branch of the linkage they are far from it."""


def half_angle(
    crank: float,
    coupler: float,
    start_gaps: tuple[float, float],
    growth: FloatArray,
    d: FloatArray,
) -> tuple[FloatArray, FloatArray]:
    """Sine and cosine, times a common factor, of half the angle pin - shaft - tip, in (0, pi).

    `d` (n,) is the distance shaft - pin [mm], `growth` (n,) its square less the one at the start
    [mm^2], `start_gaps` are (crank + coupler)^2 - d^2 and d^2 - (crank - coupler)^2 [mm^2] there: a
    dead centre at the start keeps the digits of the motion, which d has no longer.

    The squares add up to 4 l_sk d; the product is D/2, twice the area of the triangle shaft, pin,
    tip, zero at a dead centre (D as in the robust form of Wirsig eq. 3.10).
    """
    outer, inner = start_gaps
    difference = crank - coupler
    reach = d + abs(difference)
    near = (inner + growth) / reach  # d - |l_sk - l_4|
    cancels = inner + np.abs(growth) > reach * reach  # the pin has come near to the shaft
    near = np.where(cancels, d - abs(difference), near)
    short, long = (near, reach) if difference > 0.0 else (reach, near)
    total = d + (crank + coupler)
    first = (outer - growth) / total * short
    second = long * total
    # At a dead centre the radicand may round to a tiny negative number.
    return np.sqrt(np.maximum(first, 0.0)), np.sqrt(np.maximum(second, 0.0))


def in_line(places: tuple[float, ...], areas: FloatArray, full: float) -> tuple[float, ...]:
    """Those of `places` at which two members of the product `full` [mm^2] lie on one line.

    `areas` (n,) [mm^2] are `full` times the sine of their angle there. The other places are on the
    other branch.
    """
    sines = np.abs(areas) / full
    return tuple(each for each, sine in zip(places, sines, strict=True) if sine <= IN_LINE)


def dot(a: ComplexArray, b: ComplexArray) -> FloatArray:
    """(n,) scalar products of plane vectors."""
    found: FloatArray = a.real * b.real + a.imag * b.imag
    return found


def turning(joint: ComplexArray, rates: FloatArray) -> ComplexArray:
    """(2, n) first and second derivative of `joint` (n,), which turns about 0 with `rates` (2, n).

    `rates` are the derivatives of its angle: z' = i a' z, z'' = (i a'' - a'^2) z.
    """
    first, second = rates
    return np.stack((1j * first * joint, (1j * second - first * first) * joint))


def drawn(shaft: complex, joints: tuple[ComplexArray, ComplexArray]) -> MechanismSketch:
    """Crank and coupler of a linkage on the rocker's `shaft` [mm], its `joints` seen from there."""
    pin, tip = (shaft + complex(joint[0]) for joint in joints)
    return MechanismSketch(links=((shaft, tip), (tip, pin)), joints=(tip, pin), shafts=(shaft,))
