"""A motion law: regions with one formula each, from z = 0 to z = 1.

z is the normalised cam angle, f the normalised lift (VDI 2143-1, eqs. 9 to 14). Each region is
evaluated from the end it belongs to: from the start in z it gives f, from the end in w = 1 - z it
gives g = 1 - f, so that neither is a difference of two nearly equal numbers.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Any

import numpy as np

from camgeo.displayed import Displayed
from camgeo.numeric.arrays import FloatArray

Values = FloatArray
"""(4, n)."""
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
    far : z, w -> the other one of f and g.
    jerk_bound : at least |f'''| everywhere in the region.
    from_end : which of the two the near value is.
    harmonic : rate k where f''' = -k^2 f': f swings about a fixed middle; 0 elsewhere.
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
    task : the motion task it is made for, "R-R" to "B-B", see `camgeo.motion.boundary`.
    regions : from z = 0 to z = 1 without gaps.
    borders : inner z at which f'', f''' or the fourth derivative jumps.
    start, end : f', f'', f''' at z = 0 and at z = 1. An end of the class R has 0 here, but
        not that of a straight line from rest to rest, which starts with a shock.
    inflection : z at which the accelerating part ends and the decelerating one begins; None for
        laws without parts.
    parameters : the parameters it was made with, by the names that `make_law` takes.
    recipe : the function of a module that makes it, and its arguments; every law of a family has
        one, see `camgeo.motion.laws.law_of`.
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
        rest: FloatArray = self._evaluate(z, complement=True)[0]
        return rest

    def _evaluate(self, z: FloatArray, *, complement: bool) -> Values:
        z = np.asarray(z, dtype=np.float64)
        out: Values = np.empty((4, *z.shape))
        starts = np.array([region.start for region in self.regions])
        index = np.clip(np.searchsorted(starts, z, side="right") - 1, 0, len(starts) - 1)
        for number, region in enumerate(self.regions):
            here = index == number
            out[:, here] = region.values(z[here])
            if region.from_end != complement:
                out[0, here] = region.far(z[here], 1.0 - z[here])
        return out
