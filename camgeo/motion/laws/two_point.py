"""Polynomials through boundary values: f(0) = 0, f(1) = 1 and any of f', f'', f''' at both ends.

VDI 2143-1, section 6.4 (eqs. (131) to (150)) gives the quintic with f' and f'' at both ends; this
is the polynomial of least degree for any choice of the six values. The coefficients are rational in
the boundary values and are worked out exactly; the polynomial and its derivatives are evaluated in
Bernstein's form, whose coefficients are rounded once.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import TYPE_CHECKING, Final

import numpy as np

from camgeo.errors import GeometryError
from camgeo.motion.laws.law import Boundary, Law, Region, Values
from camgeo.numeric.arrays import FloatArray, ascending
from camgeo.numeric.polynomial import (
    Bernstein,
    derivative,
    largest_magnitude,
    product,
    roots_inside,
)

if TYPE_CHECKING:
    from fractions import Fraction


ORDERS: Final = {"v": 1, "a": 2, "j": 3}
"""Order of the derivative that each letter of a boundary value's name stands for."""


def law_of_boundary_values(
    name: str,
    task: str,
    values: Mapping[str, float],
    parameters: Mapping[str, float],
    rise: float = 1.0,
) -> Law:
    """The polynomial of least degree with these boundary values.

    Parameters
    ----------
    values : derivatives at z = 0 and at z = 1 by their names, "v0" to "j1".
    parameters : what the law shall say it was made of.
    rise : f(1), if it is not normalised; then all values are in the unit of the rise.

    Raises
    ------
    GeometryError
        If the values given do not determine a polynomial: one of f''' alone, for instance.
    """
    start, end = (
        {ORDERS[key[0]]: value for key, value in values.items() if key[1] == side} for side in "01"
    )
    powers = _coefficients(start, end, rise)
    try:
        shape = _Shape.of(powers, rise)
    except OverflowError:
        raise GeometryError(
            "the boundary values are too large for a polynomial", key="law"
        ) from None
    return Law(
        name=name,
        task=task,
        regions=(_region(shape, from_end=False), _region(shape, from_end=True)),
        borders=(),
        start=_boundary(shape, 0.0),
        end=_boundary(shape, 1.0),
        parameters=MappingProxyType(dict(parameters)),
        recipe=(law_of_boundary_values, (name, task, dict(values), dict(parameters), rise)),
    )


@dataclass(frozen=True, slots=True)
class _Shape:
    """A polynomial in the forms that are needed.

    Attributes
    ----------
    lift, rest, derivatives : f, 1 - f, and f', f'', f''' as Bernstein polynomials.
    powers : coefficients of f in powers of z.
    turns : gives all z in [0, 1] at which f, f', f'', f''' or f' f'' may have an extremum.
    """

    lift: Bernstein
    rest: Bernstein
    derivatives: tuple[Bernstein, Bernstein, Bernstein]
    powers: tuple[float, ...]
    turns: Callable[[], FloatArray]

    @staticmethod
    def of(powers: list[Fraction], rise: float) -> _Shape:
        from fractions import Fraction

        rest = [Fraction(rise) - powers[0], *(-c for c in powers[1:])]
        orders, derived = [], powers
        for _ in range(3):
            derived = [k * c for k, c in enumerate(derived)][1:] or [Fraction(0)]
            orders.append(Bernstein.of(derived))
        first, second, third = orders
        coefficients = tuple(float(c) for c in powers)
        return _Shape(
            lift=Bernstein.of(powers),
            rest=Bernstein.of(rest),
            derivatives=(first, second, third),
            powers=coefficients,
            turns=functools.cache(lambda: _turns(coefficients)),
        )


def _turns(powers: tuple[float, ...]) -> FloatArray:
    first = derivative(powers)
    second = derivative(first)
    third = derivative(second)
    slopes = [first, second, third, derivative(third), derivative(product(first, second))]
    return ascending(np.concatenate([roots_inside(slope, 0.0, 1.0) for slope in slopes]))


def _boundary(shape: _Shape, z: float) -> Boundary:
    place = np.array([z])
    values = (
        float((form.upper if z else form.lower)(place, 1.0 - place)[0])
        for form in shape.derivatives
    )
    return Boundary(*values)


def _coefficients(
    start: Mapping[int, float], end: Mapping[int, float], rise: float
) -> list[Fraction]:
    """Coefficients in ascending powers of z, exactly.

    Those of the orders given at the start are known; the others follow from the values at the end.
    """
    from fractions import Fraction

    count = 2 + len(start) + len(end)
    known = {0: Fraction(0)}
    known |= {order: Fraction(value) / math.factorial(order) for order, value in start.items()}
    free = [power for power in range(count) if power not in known]
    rows = []
    for order, value in {0: rise, **end}.items():
        row = [Fraction(math.perm(power, order)) for power in free]
        fixed = sum(math.perm(power, order) * c for power, c in known.items())
        rows.append([*row, Fraction(value) - fixed])
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


def _region(shape: _Shape, *, from_end: bool) -> Region:
    """Half of the range."""
    third = derivative(derivative(derivative(shape.powers)))
    half = (0.5, 1.0) if from_end else (0.0, 0.5)
    near, far = (shape.rest, shape.lift) if from_end else (shape.lift, shape.rest)

    def value(form: Bernstein, z: FloatArray, w: FloatArray) -> FloatArray:
        return form.upper(z, w) if from_end else form.lower(z, w)

    def formula(z: FloatArray, w: FloatArray) -> Values:
        f1, f2, f3 = (value(form, z, w) for form in shape.derivatives)
        return value(near, z, w), f1, f2, f3

    return Region(
        start=half[0],
        end=half[1],
        formula=formula,
        far=lambda z, w: value(far, z, w),
        jerk_bound=largest_magnitude(third, *half),
        from_end=from_end,
        turns=lambda: tuple(shape.turns()),
    )
