"""Polynomials of given boundary values, for every motion task.

`polynomial-5` meets velocity and acceleration at both ends (VDI 2143-1 section 6.4, eqs. (131) to
(150), and its kin in 6.7, 6.9 and 6.10), `polynomial-7` the jerk as well. `polynomial` meets only
what is given, with the lowest degree possible. Any of them may overshoot.
"""

from __future__ import annotations

import functools
import itertools
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from decimal import Decimal
from fractions import Fraction
from types import MappingProxyType
from typing import Any, Final

import numpy as np

from camgeo.errors import GeometryError
from camgeo.kinematics.laws.family import Family, LawParameters, boundary_parameters
from camgeo.kinematics.laws.law import Boundary, Law, Region, Values
from camgeo.kinematics.motion import TASKS
from camgeo.numeric.arrays import FloatArray, ascending
from camgeo.numeric.extremes import derivative, horner, largest_magnitude, product, roots_inside


def _complete(name: str, orders: str) -> Family:
    """The family that meets these orders at both ends, 0 where they are not given."""

    def make(task: str, parameters: LawParameters) -> Law:
        values = {order + end: parameters.get(order + end, 0.0) for end in "01" for order in orders}
        return law_of_boundary_values(name, task, values, parameters)

    return Family(name, {task: boundary_parameters(task, orders) for task in TASKS}, make)


def _lowest_degree(task: str, parameters: LawParameters) -> Law:
    return law_of_boundary_values("polynomial", task, parameters, parameters)


FAMILIES: Final[tuple[Family, ...]] = (
    _complete("polynomial-5", "va"),
    _complete("polynomial-7", "vaj"),
    Family("polynomial", {"B-B": ("v0", "a0", "j0", "v1", "a1", "j1")}, _lowest_degree),
)


# -- two point ------------------------------------------------------------------------------------
# Polynomials through boundary values: f(0) = 0, f(1) = 1 and any of f', f'', f''' at both ends.
#
# VDI 2143-1, section 6.4 (eqs. (131) to (150)) gives the quintic with f' and f'' at both ends; this
# is the polynomial of lowest degree for any choice of the six values. The coefficients are rational
# in the boundary values and are computed exactly; the polynomial and its derivatives are evaluated
# in Bernstein form, whose coefficients are rounded once.


ORDERS: Final = {"v": 1, "a": 2, "j": 3}
"""Order of the derivative for each letter in the names of boundary values."""


def law_of_boundary_values(
    name: str,
    task: str,
    values: Mapping[str, float],
    parameters: Mapping[str, float],
    rise: float = 1.0,
) -> Law:
    """The polynomial of lowest degree with these boundary values.

    Parameters
    ----------
    values : derivatives at z = 0 and at z = 1 by their names, "v0" to "j1".
    parameters : the parameters that the law lists as its own.
    rise : f(1) if the polynomial is not normalised; then all values are in the unit of the rise.

    Raises
    ------
    GeometryError
        If the values do not determine a polynomial, such as f''' without f' and f''.
    """
    start, end = (
        {ORDERS[key[0]]: value for key, value in values.items() if key[1] == side} for side in "01"
    )
    powers = _coefficients(start, end, rise)
    slopes = [powers]
    for _ in range(3):
        slopes.append([k * c for k, c in enumerate(slopes[-1])][1:] or [powers[0] * 0])
    rest = [-c for c in powers]
    # rest is g = rise - f, exactly, so that its digits near the end do not cancel.
    rest[0] += Fraction(rise)
    try:
        lift, left, *derivatives = (
            bernstein(polynomial) for polynomial in (powers, rest, *slopes[1:])
        )
        regions = _regions(tuple(float(c) for c in powers), lift, left, derivatives)
    except OverflowError:
        raise GeometryError(
            "the boundary values are too large for a polynomial", key="law"
        ) from None
    return Law(
        name=name,
        task=task,
        regions=regions,
        borders=(),
        start=Boundary(*(form[0] for form in derivatives)),
        end=Boundary(*(form[-1] for form in derivatives)),
        parameters=MappingProxyType(dict(parameters)),
        recipe=(law_of_boundary_values, (name, task, dict(values), dict(parameters), rise)),
    )


def _turns(powers: tuple[float, ...]) -> FloatArray:
    first = derivative(powers)
    second = derivative(first)
    third = derivative(second)
    slopes = [first, second, third, derivative(third), derivative(product(first, second))]
    return ascending(np.concatenate([roots_inside(slope, 0.0, 1.0) for slope in slopes]))


def _coefficients(
    start: Mapping[int, float], end: Mapping[int, float], rise: float
) -> list[Fraction]:
    """Coefficients in ascending powers of z, exactly.

    The values at the start fix the coefficients of their orders; the others follow from the values
    at the end, one linear equation each.
    """
    # f(0) and f(1) are prescribed too, so there is one coefficient for each condition.
    count = 2 + len(start) + len(end)
    known = {0: Fraction(0)}
    known |= {order: Fraction(value) / math.factorial(order) for order, value in start.items()}
    free = [power for power in range(count) if power not in known]
    rows = []
    for order, value in {0: rise, **end}.items():
        # The derivative of z^p of order k is p (p - 1) ... (p - k + 1) at z = 1, which is perm(p,
        # k).
        row = [Fraction(math.perm(power, order)) for power in free]
        fixed = sum(math.perm(power, order) * c for power, c in known.items())
        rows.append([*row, Fraction(value) - fixed])
    # A prescribed derivative beyond the degree cannot be met.
    if any(power >= count for power in known):
        raise _undetermined()
    solved = dict(zip(free, _solved(rows), strict=True))
    return [known[power] if power in known else solved[power] for power in range(count)]


def _solved(rows: list[list[Fraction]]) -> list[Fraction]:
    """Solution of the linear equations `rows` (right-hand side last), by elimination."""
    size = len(rows)
    for column in range(size):
        pivot = next((row for row in range(column, size) if rows[row][column]), None)
        if pivot is None:
            raise _undetermined()
        rows[column], rows[pivot] = rows[pivot], rows[column]
        head = rows[column][column]
        rows[column] = [value / head for value in rows[column]]
        for row in range(size):
            if row != column and rows[row][column]:
                factor = rows[row][column]
                rows[row] = [
                    value - factor * above
                    for value, above in zip(rows[row], rows[column], strict=True)
                ]
    return [row[-1] for row in rows]


def _undetermined() -> GeometryError:
    return GeometryError(
        "these boundary values do not determine a polynomial; give the lower orders first"
        " (velocity before acceleration before jerk)",
        key="law",
    )


def bernstein(powers: Sequence[Decimal] | Sequence[Fraction]) -> tuple[float, ...]:
    """(n + 1,) c_i, each rounded once, of the sum of c_i z^i w^(n - i) with w = 1 - z.

    From exact coefficients in ascending powers of z. The terms cancel less than those of any other
    form over [0, 1]; where all c_i have one sign, not at all.
    """
    exact = [Fraction(c) for c in powers]
    n = len(exact) - 1
    # Sums of integers over one denominator: adding fractions takes most of the time of a law.
    below = math.lcm(*(c.denominator for c in exact))
    above = [c.numerator * (below // c.denominator) for c in exact]
    return tuple(
        sum(math.comb(n - k, i - k) * above[k] for k in range(i + 1)) / below for i in range(n + 1)
    )


def scaled_horner(
    coefficients: Sequence[float] | FloatArray, small: FloatArray, large: FloatArray
) -> FloatArray:
    """The sum of c_i small^i large^(n - i) = large^n times a polynomial in small/large."""
    value = horner(coefficients, small / large)
    for _ in range(len(coefficients) - 1):
        value *= large
    return value


@dataclass(frozen=True, slots=True)
class _Half:
    """The formula of a half of the range, evaluated from the end to which it belongs.

    Attributes
    ----------
    size : number of coefficients of the near value; each derivative has one less than the one
        before it, but at least one.
    """

    size: int

    def __call__(self, z: FloatArray, w: FloatArray, numbers: Any) -> Values:
        from_end, *coefficients = numbers
        # In its half the near variable is the smaller one, so that small/large <= 1 and powers do
        # not overflow.
        small, large = np.where(from_end, w, z), np.where(from_end, z, w)
        values = []
        for order in range(4):
            size = max(self.size - order, 1)
            values.append(scaled_horner(coefficients[:size], small, large))
            coefficients = coefficients[size:]
        return np.array(values)


def _regions(
    powers: tuple[float, ...],
    lift: tuple[float, ...],
    left: tuple[float, ...],
    derivatives: list[tuple[float, ...]],
) -> tuple[Region, Region]:
    """The two regions [0, 1/2] and [1/2, 1].

    `powers` are the coefficients of f in powers of z; `lift`, `left` and `derivatives` the
    Bernstein coefficients of f, of 1 - f and of f', f'', f'''.
    """
    third = derivative(derivative(derivative(powers)))
    formula = _Half(len(powers))

    @functools.cache
    def turns() -> tuple[float, ...]:
        return tuple(_turns(powers))

    return (
        Region(
            start=0.0,
            end=0.5,
            formula=formula,
            far=lambda z, w: scaled_horner(left, z, w),
            jerk_bound=largest_magnitude(third, 0.0, 0.5),
            from_end=False,
            numbers=(0.0, *itertools.chain(lift, *derivatives)),
            turns=turns,
        ),
        Region(
            start=0.5,
            end=1.0,
            formula=formula,
            far=lambda z, w: scaled_horner(lift[::-1], w, z),
            jerk_bound=largest_magnitude(third, 0.5, 1.0),
            from_end=True,
            # In reverse order, Bernstein coefficients belong to the same polynomial in w = 1 - z.
            numbers=(1.0, *itertools.chain.from_iterable(c[::-1] for c in (left, *derivatives))),
            turns=turns,
        ),
    )
