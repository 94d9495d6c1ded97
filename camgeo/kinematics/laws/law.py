"""A motion law: regions with one formula each, from z = 0 to z = 1.

z is the normalised cam angle, f the normalised lift (VDI 2143-1, eqs. 9 to 14). Each region is
evaluated from the end it belongs to: from the start in z it gives f, from the end in w = 1 - z it
gives g = 1 - f, so that neither is a difference of two nearly equal numbers.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import lru_cache
from types import MappingProxyType
from typing import Any

import numpy as np

from camgeo.numeric.arrays import BoolArray, FloatArray
from camgeo.numeric.extremes import Extreme
from camgeo.record import Displayed

Values = FloatArray
"""(4, n) near value (f or g = 1 - f), f', f'', f''' at n values of z."""
Formula = Callable[[FloatArray, FloatArray, Any], Values]
"""z (n,), w = 1 - z (n,), k numbers, each one or (n,) -> (4, n) near value, f', f'', f'''."""
Complement = Callable[[FloatArray, FloatArray], FloatArray]
Turns = Callable[[], tuple[float, ...]]
Recipe = tuple[Callable[..., "Law"], tuple[Any, ...]]


@dataclass(frozen=True, slots=True)
class Region:
    """A stretch of a law with one formula.

    Attributes
    ----------
    start, end : in z.
    formula : what gives the values. Regions that differ only by `numbers` have equal formulas, so
        that a plan evaluates all of them at once. The near value is f, or, if `from_end`,
        g = 1 - f; derivatives are with respect to z in both cases.
    numbers : (k,) the other arguments of the formula, after z and w.
    far : z, w -> (n,) the far value, that of f and g which is not the near value.
    jerk_bound : at least |f'''| everywhere in the region.
    from_end : whether the near value is g, counted from the end of the law, else f.
    harmonic : rate k of a region in which f''' = -k^2 f', so that f swings about a fixed
        middle; 0 for other regions.
    turns : gives all z inside the region at which one of f, f', f'', f''' and f' f'' may have an
        extremum; other values may be among them, inside or outside the region.
    """

    start: float
    end: float
    formula: Formula
    far: Complement
    jerk_bound: float
    from_end: bool
    numbers: tuple[float, ...] = ()
    harmonic: float = 0.0
    turns: Turns = tuple

    def values(self, z: FloatArray) -> Values:
        """(4, n) near value, f', f'', f''' at `z` (n,) in the region, its ends included."""
        return self.formula(z, 1.0 - z, np.array(self.numbers))

    @property
    def places(self) -> FloatArray:
        """All z, ascending, at which an extremum may be: the turns inside, and both ends."""
        inside = (z for z in self.turns() if self.start < z < self.end)
        return np.array(sorted({self.start, *inside, self.end}))


@dataclass(frozen=True, slots=True)
class Boundary:
    """f', f'', f''' at one end of a law."""

    velocity: float = 0.0
    acceleration: float = 0.0
    jerk: float = 0.0


@dataclass(frozen=True, slots=True)
class Law(Displayed):
    """A normalised motion law: f(0) = 0, f(1) = 1.

    A pickle or copy of a law holds only its recipe, from which the law is made again.

    Attributes
    ----------
    name : as written in a scene.
    task : the motion task it is made for, "R-R" to "B-B", see `camgeo.kinematics.motion`.
    regions : from z = 0 to z = 1 without gaps.
    borders : inner z at which f'', f''' or the fourth derivative jumps.
    start, end : f', f'', f''' at z = 0 and at z = 1. An end of the class R has 0 here, but
        not that of a straight line from rest to rest, which starts with a shock.
    inflection : z at which the accelerating part ends and the decelerating one begins; None for
        laws without parts.
    parameters : the parameters it was made with, by the names that `make_law` takes.
    recipe : a module's function that makes the law, and its arguments; every law of a family has
        one, see `camgeo.kinematics.laws.build_law`.
    """

    name: str
    task: str
    regions: tuple[Region, ...] = field(compare=False)
    borders: tuple[float, ...]
    start: Boundary
    end: Boundary
    inflection: float | None = None
    parameters: Mapping[str, float] = field(default_factory=lambda: MappingProxyType({}))
    recipe: Recipe | None = field(default=None, repr=False)

    def __reduce__(self) -> Recipe:
        if self.recipe is None:
            raise TypeError(f"the law {self.name} has no recipe from which to make it again")
        return self.recipe

    def __call__(self, z: FloatArray) -> Values:
        """(4, n) f, f', f'', f''' at `z` (n,) in [0, 1]; right-hand values at the borders."""
        return self._evaluate(z, complement=False)

    def complement(self, z: FloatArray) -> FloatArray:
        """g = 1 - f at `z` (n,), to the last digits also where f rounds to 1."""
        return np.asarray(self._evaluate(z, complement=True)[0])

    def _evaluate(self, z: FloatArray, *, complement: bool) -> Values:
        z = np.asarray(z, dtype=np.float64)
        values: Values = np.empty((4, *z.shape))
        starts = np.array([region.start for region in self.regions])
        # side="right" gives a border to the region on its right; the clip puts rounding outside [0,
        # 1] into the first and the last region.
        index = np.clip(np.searchsorted(starts, z, side="right") - 1, 0, len(starts) - 1)
        for number, region in enumerate(self.regions):
            here = index == number
            values[:, here] = region.values(z[here])
            if region.from_end != complement:
                values[0, here] = region.far(z[here], 1.0 - z[here])
        return values


# -- characteristic -------------------------------------------------------------------------------
# Characteristic values of a law (Kennwerte, VDI 2143-1, section 5.1), signed, with places.


ROUNDING = 1e-13
"""A jump below this fraction of the largest value is rounding."""

BORDER = 4.0 * 2.0**-52
"""Rounding of the place of a border, as a fraction of the span of the move."""


@dataclass(frozen=True, slots=True)
class Characteristic:
    """Characteristic values of a law.

    For a law with an accelerating part before the inflection point and a decelerating one after it,
    the starred values are those of the second part; for a law without parts (a polynomial, the
    double harmonic) the values without star are the largest over the whole move, the starred ones
    the smallest. (For U-R and U-G the guideline exchanges the names: there the star marks the part
    at the reversal, which is the first.)

    Attributes
    ----------
    velocity : C_v, largest f'. Also C_Mstat.
    least_velocity : smallest f'; negative where the law runs back.
    acceleration, deceleration : C_a, C_a*: the extreme of f'' in each part.
    jerk, braking_jerk : C_j, C_j*: the extreme of f''' in each part; of equal ones the one that is
        nearer to the border of the move.
    moment, braking_moment : C_Mdyn, C_Mdyn*: the extreme of f' f'' in each part.
    largest_acceleration, least_acceleration, largest_jerk, least_jerk, largest_moment,
    least_moment : largest and smallest f'', f''', f' f'' over the whole move.
    lift, least_lift : largest and smallest f: beyond [0, 1] where the law overshoots.
    """

    velocity: Extreme
    least_velocity: Extreme
    acceleration: Extreme
    deceleration: Extreme
    jerk: Extreme
    braking_jerk: Extreme
    moment: Extreme
    braking_moment: Extreme
    largest_acceleration: Extreme
    least_acceleration: Extreme
    largest_jerk: Extreme
    least_jerk: Extreme
    largest_moment: Extreme
    least_moment: Extreme
    lift: Extreme
    least_lift: Extreme


def characteristic(law: Law) -> Characteristic:
    """The characteristic values of `law`.

    The extremes are evaluated at all places where one can be: at the ends of each region, from
    inside, and where its formula has a turning point, known in closed form or as the root of a
    polynomial.
    """
    return _characteristic(law.regions, has_parts=law.inflection is not None)


@lru_cache(maxsize=256)
def _characteristic(regions: tuple[Region, ...], *, has_parts: bool) -> Characteristic:
    values = [_values(region) for region in regions]
    z = np.concatenate([value[0] for value in values])
    f, f1, f2, f3 = (np.concatenate([v[k] for v in values]) for k in range(1, 5))
    power = f1 * f2
    everywhere = np.ones(len(z), dtype=bool)
    if not has_parts:
        first = second = everywhere
        pick: tuple[_Pick, _Pick, _Pick] = (_largest, _smallest, _smallest)
    else:
        # A region counted from the end belongs to the decelerating part, as each part is counted
        # from its own border.
        second = np.concatenate(
            [np.full(len(v[0]), region.from_end) for v, region in zip(values, regions, strict=True)]
        )
        first = ~second
        # Of equal jerks of the second part the last one lies at its border, see `Characteristic`.
        pick = (_extreme, _extreme, _outermost)
    return Characteristic(
        velocity=_largest(z, f1, everywhere),
        least_velocity=_smallest(z, f1, everywhere),
        acceleration=pick[0](z, f2, first),
        deceleration=pick[1](z, f2, second),
        jerk=pick[0](z, f3, first),
        braking_jerk=pick[2](z, f3, second),
        moment=pick[0](z, power, first),
        braking_moment=pick[1](z, power, second),
        largest_acceleration=_largest(z, f2, everywhere),
        least_acceleration=_smallest(z, f2, everywhere),
        largest_jerk=_largest(z, f3, everywhere),
        least_jerk=_smallest(z, f3, everywhere),
        largest_moment=_largest(z, power, everywhere),
        least_moment=_smallest(z, power, everywhere),
        lift=_largest(z, f, everywhere),
        least_lift=_smallest(z, f, everywhere),
    )


def acceleration_jumps(law: Law) -> tuple[float, ...]:
    """The z inside the law at which f'' jumps, which VDI 2143-1 calls jerks."""
    return _acceleration_jumps(law.regions)


@lru_cache(maxsize=256)
def _acceleration_jumps(regions: tuple[Region, ...]) -> tuple[float, ...]:
    ends = []
    for region in regions:
        ends.append(region.values(np.array([region.start, region.end]))[2])
    scale = float(np.max(np.abs(ends)))
    jumps = []
    for (first, left), (second, right) in itertools.pairwise(zip(regions, ends, strict=True)):
        # The border is rounded, so both accelerations may be off by that rounding times the jerk.
        moved = BORDER * max(first.jerk_bound, second.jerk_bound)
        if abs(float(right[0] - left[1])) > ROUNDING * scale + moved:
            jumps.append(second.start)
    return tuple(jumps)


_Pick = Callable[[FloatArray, FloatArray, BoolArray], Extreme]


def _values(region: Region) -> tuple[FloatArray, ...]:
    """z, f, f', f'', f''' at the ends of a region and at its turns, ascending in z."""
    z = region.places
    near, f1, f2, f3 = region.values(z)
    return z, 1.0 - near if region.from_end else near, f1, f2, f3


def _largest(z: FloatArray, values: FloatArray, among: BoolArray) -> Extreme:
    return _first(z, values, among, float(np.max(values[among])))


def _smallest(z: FloatArray, values: FloatArray, among: BoolArray) -> Extreme:
    return _first(z, values, among, float(np.min(values[among])))


def _extreme(z: FloatArray, values: FloatArray, among: BoolArray) -> Extreme:
    """The value of largest magnitude, the first of equal ones."""
    return _first(z, values, among, _values_of_largest_magnitude(values, among)[0])


def _outermost(z: FloatArray, values: FloatArray, among: BoolArray) -> Extreme:
    """The value of largest magnitude, the last of equal ones: that of the border at z = 1."""
    return _first(z, values, among, _values_of_largest_magnitude(values, among)[-1])


def _values_of_largest_magnitude(values: FloatArray, among: BoolArray) -> list[float]:
    part = values[among]
    size = np.abs(part)
    largest = float(np.max(size))
    signs = np.sign(part[size >= (1.0 - ROUNDING) * largest])
    return [float(sign) * largest for sign in signs]


def _first(z: FloatArray, values: FloatArray, among: BoolArray, value: float) -> Extreme:
    """The first place at which the quantity has `value`, except for rounding."""
    near = np.abs(values - value) <= ROUNDING * abs(value)
    # argmax of booleans is the index of the first True.
    return Extreme(value, float(z[np.argmax(near & among)]))
