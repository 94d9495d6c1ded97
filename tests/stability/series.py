"""Numbers with many digits: roots, and short Taylor series for derivatives without differences.

A function of t is the tuple of its Taylor coefficients c_0, c_1, ... at t = 0, in numbers of
mpmath, real or complex. Sums, products and powers of series are exact to the digits of mpmath; the
k-th derivative is k! c_k.
"""

from __future__ import annotations

import math
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

    def root(
        self, value_and_slope: Callable[[Number], Sequence[Number]], guess: Number, decimals: int
    ) -> Number:
        """The root near `guess`, by `newton` from the first one that was found there."""
        place = newton(value_and_slope, self.near(guess), decimals)
        self.keep(guess, place)
        return place

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


# Series ---------------------------------------------------------------------------------------


# No text of its own: mpmath makes that of what is not a number before it leaves a product to it.
@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Series:
    """A Taylor series truncated after its last term; operands have the same number of terms."""

    terms: tuple[Number, ...]

    def __add__(self, other: Any) -> Series:
        if isinstance(other, Series):
            return Series(tuple(a + b for a, b in zip(self.terms, other.terms, strict=True)))
        return Series((self.terms[0] + other, *self.terms[1:]))

    __radd__ = __add__

    def __neg__(self) -> Series:
        return Series(tuple(-a for a in self.terms))

    def __sub__(self, other: Any) -> Series:
        difference: Series = self + (-other)
        return difference

    def __rsub__(self, other: Any) -> Series:
        difference: Series = -self + other
        return difference

    def __mul__(self, other: Any) -> Series:
        if not isinstance(other, Series):
            return Series(tuple(a * other for a in self.terms))
        a, b = self.terms, other.terms
        return Series(tuple(_fold(a, b, k) for k in range(len(a))))

    __rmul__ = __mul__

    def __truediv__(self, other: Any) -> Series:
        if not isinstance(other, Series):
            return Series(tuple(a / other for a in self.terms))
        quotient: list[Number] = []
        for k, term in enumerate(self.terms):
            known = sum(quotient[i] * other.terms[k - i] for i in range(k))
            quotient.append((term - known) / other.terms[0])
        return Series(tuple(quotient))

    def __pow__(self, power: int) -> Series:
        result = self
        for _ in range(power - 1):
            result = result * self
        return result

    @property
    def real(self) -> Series:
        """The series of the real part, for a real t."""
        return Series(tuple(a.real for a in self.terms))

    @property
    def imag(self) -> Series:
        """The series of the imaginary part, for a real t."""
        return Series(tuple(a.imag for a in self.terms))

    def derivative(self, order: int) -> Number:
        """The derivative of that order at t = 0."""
        return self.terms[order] * math.factorial(order)

    def slope(self) -> Series:
        """The series of the derivative, one term shorter."""
        return Series(tuple(k * a for k, a in enumerate(self.terms))[1:])


def variable(value: Number, rate: Number, terms: int) -> Series:
    """value + rate t."""
    return Series((value, rate, *(mp.mpf(0),) * (terms - 2)))


def polynomial(coefficients: Sequence[Number], x: Series) -> Series:
    """The polynomial of x with these coefficients, in ascending powers."""
    f: Series = x * 0
    for coefficient in reversed(coefficients):
        f = f * x + coefficient
    return f


def exponential(x: Series) -> Series:
    """exp(x): y' = x' y."""
    a = x.terms
    y = [mp.exp(a[0])]
    for k in range(1, len(a)):
        y.append(sum(i * a[i] * y[k - i] for i in range(1, k + 1)) / k)
    return Series(tuple(y))


def logarithm(x: Series) -> Series:
    """log(x), its main branch at t = 0: x y' = x'."""
    a = x.terms
    y = [mp.log(a[0])]
    for k in range(1, len(a)):
        known = sum(i * y[i] * a[k - i] for i in range(1, k))
        y.append((k * a[k] - known) / (k * a[0]))
    return Series(tuple(y))


def root(x: Series) -> Series:
    """sqrt(x): y y = x."""
    a = x.terms
    y = [mp.sqrt(a[0])]
    for k in range(1, len(a)):
        known = sum(y[i] * y[k - i] for i in range(1, k))
        y.append((a[k] - known) / (2 * y[0]))
    return Series(tuple(y))


def direction(angle: Series) -> Series:
    """exp(i angle), complex."""
    return exponential(angle * mp.mpc(0, 1))


def sine(angle: Series) -> Series:
    """sin(angle) for a real angle."""
    return direction(angle).imag


def cosine(angle: Series) -> Series:
    """cos(angle) for a real angle."""
    return direction(angle).real


def _fold(a: tuple[Number, ...], b: tuple[Number, ...], k: int) -> Number:
    total = a[0] * b[k]
    for i in range(1, k + 1):
        total = total + a[i] * b[k - i]
    return total
