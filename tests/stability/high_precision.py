"""Numbers with many digits, and roots of what is computed with them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any, Final

from mpmath import mp

from camgeo.errors import GeometryError

Number = Any
"""A real or complex number of mpmath, which has no type annotations."""

DIGITS: Final = 80
"""Digits of the references. The textbook formulas lose most of them where a lift begins: f = 1e-48
of the 4-5-6-7 polynomial at z = 1e-12 leaves 32 digits of 1 - f; a double needs 16, a change by
half an ulp 16 more."""


STEPS: Final = 20
"""Most steps; from seven digits four suffice, from the first digits of a swallow tail's width six.
"""


@dataclass(frozen=True, slots=True)
class Roots:
    """Exact roots by their guesses.

    The first root is that of the unchanged inputs. Half an ulp of an input moves it very little, so
    that one step from it suffices where the guess needs several.

    Attributes
    ----------
    decimals : of the guesses, which identify them.
    """

    decimals: int
    _known: dict[float, Number] = field(default_factory=dict)

    def near(self, guess: Number) -> Number:
        """The known root for `guess`, or `guess` itself."""
        return self._known.get(self._key(guess), guess)

    def keep(self, guess: Number, root: Number) -> None:
        """Remember the first root of a guess."""
        self._known.setdefault(self._key(guess), root)

    def _key(self, guess: Number) -> float:
        return round(float(guess), self.decimals)


def newton(
    value_and_slope: Callable[[Number], Sequence[Number]], guess: Number, decimals: int
) -> Number:
    """The root near `guess`; a step that vanishes to that many decimals is the last one.

    Its error is about the square of that step. GeometryError if the steps do not converge.
    """
    place, enough = guess, mp.mpf(10) ** -decimals
    for _ in range(STEPS):
        value, slope = value_and_slope(place)
        step = value / slope
        place = place - step
        if abs(step) < enough:
            return place
    raise GeometryError(f"there is no root near {float(guess)!r}")
