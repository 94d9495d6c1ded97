"""What a motion law is: regions with one formula each, from z = 0 to z = 1.

z is the normalised cam angle, f the normalised lift (VDI 2143-1, eqs. 9 to 14). Each region is
evaluated from the end it is nearer to: from the start in z it gives f, from the end in w = 1 - z it
gives g = 1 - f, so that neither is ever the difference of two nearly equal numbers.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from camgeo.numeric.arrays import FloatArray

Values = tuple[FloatArray, FloatArray, FloatArray, FloatArray]
Formula = Callable[[FloatArray, FloatArray], Values]
Complement = Callable[[FloatArray, FloatArray], FloatArray]


@dataclass(frozen=True, slots=True)
class Region:
    """A stretch of a law with one formula.

    Attributes
    ----------
    start, end : in z.
    formula : z (n,), w = 1 - z (n,) -> near value, f', f'', f''' each (n,). The near value is f,
        or, if `from_end`, g = 1 - f; derivatives are with respect to z in both cases.
    far : z, w -> the other one of f and g.
    jerk_bound : at least |f'''| everywhere in the region.
    from_end : which of the two the near value is.
    """

    start: float
    end: float
    formula: Formula
    far: Complement
    jerk_bound: float
    from_end: bool


@dataclass(frozen=True, slots=True)
class Characteristic:
    """Characteristic values of a law (VDI 2143-1, section 5.1), all positive.

    Attributes
    ----------
    velocity : C_v, largest f'.
    acceleration : C_a, largest f'' of the accelerating part.
    deceleration : C_a*, largest -f'' of the decelerating part.
    jerk : C_j, largest |f'''|; infinite where f'' jumps.
    moment : C_Mdyn, largest f' f'' of the accelerating part.
    braking_moment : C_Mdyn*, largest -f' f'' of the decelerating part.
    """

    velocity: float
    acceleration: float
    deceleration: float
    jerk: float
    moment: float
    braking_moment: float


@dataclass(frozen=True, slots=True)
class Law:
    """A normalised motion law from rest to rest.

    Attributes
    ----------
    name : as written in a scene.
    regions : from z = 0 to z = 1 without gaps.
    borders : inner z at which f'', f''' or the fourth derivative jumps.
    characteristic : the law's characteristic values.
    end_velocity : f'(0) = f'(1); not 0 only where the law starts and ends with a shock.
    end_acceleration : f''(0) and f''(1); not 0 where the law has a jerk at its ends.
    inflection : lambda, the z of the inflection point.
    """

    name: str
    regions: tuple[Region, ...]
    borders: tuple[float, ...]
    characteristic: Characteristic
    end_velocity: float = 0.0
    end_acceleration: tuple[float, float] = (0.0, 0.0)
    inflection: float = 0.5

    def __call__(self, z: FloatArray) -> Values:
        """f, f', f'', f''' at `z` (n,) in [0, 1]; right-hand values at the borders."""
        return self._evaluate(z, complement=False)

    def complement(self, z: FloatArray) -> FloatArray:
        """g = 1 - f at `z` (n,), to the last digits also where f rounds to 1."""
        return self._evaluate(z, complement=True)[0]

    def _evaluate(self, z: FloatArray, *, complement: bool) -> Values:
        z = np.asarray(z, dtype=np.float64)
        out = np.empty((4, *z.shape))
        starts = np.array([region.start for region in self.regions])
        index = np.clip(np.searchsorted(starts, z, side="right") - 1, 0, len(starts) - 1)
        for number, region in enumerate(self.regions):
            here = index == number
            forward, backward = z[here], 1.0 - z[here]
            out[:, here] = region.formula(forward, backward)
            if region.from_end != complement:
                out[0, here] = region.far(forward, backward)
        return out[0], out[1], out[2], out[3]


@dataclass(frozen=True, slots=True)
class HalfRegion:
    """A stretch of a half law with one formula.

    Attributes
    ----------
    start, end : in z.
    formula : z (n,), r = 1/2 - z (n,) -> f, f', f'', f''' each (n,). Both arguments are exact to
        their own last bits, so that f keeps its digits at z = 0 and f'' at r = 0.
    jerk_bound : at least |f'''| everywhere in the region.
    """

    start: float
    end: float
    formula: Formula
    jerk_bound: float


@dataclass(frozen=True, slots=True)
class HalfLaw:
    """The first half of a law that is its own mirror image about the middle, f(1/2) = 1/2.

    Attributes
    ----------
    name : as written in a scene.
    regions : from z = 0 to z = 1/2.
    centre : r (n,) in [0, 1/2] -> 1/2 - f(1/2 - r), to the last digits also for small r.
    characteristic : of the symmetric law.
    borders : z inside (0, 1/2) at which f'', f''' or the fourth derivative jumps.
    middle_jumps : True if f'' or f''' jumps at z = 1/2 in the symmetric law.
    end_velocity, end_acceleration : f'(0), f''(0).
    """

    name: str
    regions: tuple[HalfRegion, ...]
    centre: Callable[[FloatArray], FloatArray]
    characteristic: Characteristic
    borders: tuple[float, ...] = ()
    middle_jumps: bool = False
    end_velocity: float = 0.0
    end_acceleration: float = 0.0


def rise_regions(half: HalfLaw, inflection: float) -> tuple[Region, ...]:
    """The half law stretched over [0, lambda], lambda = `inflection` (eqs. 66 to 70)."""
    factor = 2.0 * inflection

    def far(z: FloatArray, _w: FloatArray) -> FloatArray:
        return (1.0 - inflection) + factor * half.centre((inflection - z) / factor)

    def stretched(region: HalfRegion) -> Region:
        def formula(z: FloatArray, _w: FloatArray) -> Values:
            if factor == 1.0:
                return region.formula(z, 0.5 - z)
            f, f1, f2, f3 = region.formula(z / factor, (inflection - z) / factor)
            return factor * f, f1, f2 / factor, f3 / (factor * factor)

        end = inflection if region.end == 0.5 else factor * region.end
        jerk = region.jerk_bound / (factor * factor)
        return Region(factor * region.start, end, formula, far, jerk, from_end=False)

    return tuple(stretched(region) for region in half.regions)


def fall_regions(half: HalfLaw, inflection: float) -> tuple[Region, ...]:
    """The half law's mirror image over [lambda, 1] (eqs. 71 to 75).

    The mirror image F(z) = 1 - f(1 - z) has F' = f'(1 - z), F'' = -f''(1 - z), F''' = f'''(1 - z).
    """
    factor = 2.0 * (1.0 - inflection)

    def far(z: FloatArray, _w: FloatArray) -> FloatArray:
        return inflection + factor * half.centre((z - inflection) / factor)

    def mirrored(region: HalfRegion) -> Region:
        def formula(z: FloatArray, w: FloatArray) -> Values:
            if factor == 1.0:
                g, f1, f2, f3 = region.formula(w, z - 0.5)
                return g, f1, -f2, f3
            g, f1, f2, f3 = region.formula(w / factor, (z - inflection) / factor)
            return factor * g, f1, -f2 / factor, f3 / (factor * factor)

        start = inflection if region.end == 0.5 else 1.0 - factor * region.end
        jerk = region.jerk_bound / (factor * factor)
        return Region(start, 1.0 - factor * region.start, formula, far, jerk, from_end=True)

    return tuple(mirrored(region) for region in reversed(half.regions))


def symmetric(half: HalfLaw) -> Law:
    """The whole law of a half (VDI 2143-1, section 6.1.1)."""
    middle = (0.5,) if half.middle_jumps else ()
    return Law(
        name=half.name,
        regions=rise_regions(half, 0.5) + fall_regions(half, 0.5),
        borders=half.borders + middle + tuple(1.0 - border for border in reversed(half.borders)),
        characteristic=half.characteristic,
        end_velocity=half.end_velocity,
        end_acceleration=(half.end_acceleration, -half.end_acceleration),
    )
