"""Shift of the inflection point: an asymmetric law from a symmetric one (VDI 2143-1, 6.1.2).

With lambda the z of the inflection point, eqs. (66) to (75): the half law runs stretched over
[0, lambda], its mirror image over [lambda, 1]; f' keeps its values, f'' and f''' scale with the
stretching. f'' stays continuous at lambda wherever the base law has f''(1/2) = 0, f''' jumps.
"""

from __future__ import annotations

import math

from camgeo.errors import GeometryError
from camgeo.motion.laws import HALVES
from camgeo.motion.laws.law import Characteristic, Law, fall_regions, rise_regions


def shift(law: Law, inflection: float) -> Law:
    """Return `law` with its inflection point at z = `inflection`.

    Parameters
    ----------
    law : one of the symmetric laws of `camgeo.motion.laws`.
    inflection : lambda, 0 < lambda < 1; 1/2 gives the law itself.

    Raises
    ------
    GeometryError
        If lambda is not inside (0, 1): the acceleration would be infinite.
    """
    if not 0.0 < inflection < 1.0:
        raise GeometryError(
            "the inflection point must lie strictly between 0 and 1",
            key="inflection",
            value=repr(inflection),
        )
    half = HALVES[law.name]
    if inflection == 0.5:
        return law
    rest = 1.0 - inflection
    straight = half.end_velocity != 0.0  # nothing bends, so nothing shifts
    borders = tuple(2.0 * inflection * border for border in half.borders)
    after = tuple(1.0 - 2.0 * rest * border for border in reversed(half.borders))
    start = half.end_acceleration / (2.0 * inflection)
    end = -half.end_acceleration / (2.0 * rest)
    return Law(
        name=law.name,
        regions=rise_regions(half, inflection) + fall_regions(half, inflection),
        borders=() if straight else (*borders, inflection, *after),
        characteristic=_shifted(half.characteristic, inflection),
        end_velocity=half.end_velocity,
        end_acceleration=(start, end),
        inflection=inflection,
    )


def _shifted(base: Characteristic, inflection: float) -> Characteristic:
    """Eqs. (76) to (81), the bars lost in print restored: they are the base law's values."""
    if math.isinf(base.acceleration):
        return base
    rise, fall = 2.0 * inflection, 2.0 * (1.0 - inflection)
    return Characteristic(
        velocity=base.velocity,
        acceleration=base.acceleration / rise,
        deceleration=base.deceleration / fall,
        jerk=base.jerk / min(rise, fall) ** 2,
        moment=base.moment / rise,
        braking_moment=base.braking_moment / fall,
    )
