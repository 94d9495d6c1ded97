"""Array types, and arrays made read-only on their way into a frozen dataclass."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import fields, is_dataclass
from typing import Any, Final, Literal, Protocol, TypeVar

import numpy as np
from numpy.typing import DTypeLike, NDArray

FloatArray = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]
IntArray = NDArray[np.intp]
BoolArray = NDArray[np.bool_]

Side = Literal["right", "left"]
"""Which one-sided value a function of an array has at a break: "right" is the limit from above."""

SIDES: Final[tuple[Side, Side]] = ("left", "right")

Rows = TypeVar("Rows")
"""A dataclass of arrays whose rows belong together."""

Number = TypeVar("Number", bound=np.generic)


def phase(value: complex) -> float:
    """The angle of a complex number [rad], -pi to pi.

    The same as `cmath.phase`, except that it accepts an angle below the smallest normal number, for
    which `cmath.phase` raises an OverflowError (that of a pivot at [-90, 5e-324], for example).
    """
    return math.atan2(value.imag, value.real)


def frozen(values: Any, dtype: DTypeLike) -> NDArray[Any]:
    """Return a read-only copy of `values` as an array of `dtype`."""
    return read_only(np.array(values, dtype=dtype))


def read_only(array: NDArray[Number]) -> NDArray[Number]:
    """`array` itself, from now on read-only: for a result that is handed out more than once."""
    array.flags.writeable = False
    return array


def dot(a: ComplexArray, b: ComplexArray | complex) -> FloatArray:
    """(n,) scalar products of plane vectors."""
    return np.asarray(a.real * b.real + a.imag * b.imag)


def ascending(values: FloatArray) -> FloatArray:
    """The distinct `values` (n,), ascending.

    `numpy.unique` does the same but takes 15 ms at its first call, because it imports masked
    arrays.
    """
    ordered = np.sort(values)
    if not len(ordered):
        return ordered
    return np.asarray(ordered[np.concatenate(([True], ordered[1:] != ordered[:-1]))])


def grouped(counts: IntArray) -> tuple[IntArray, IntArray]:
    """For k groups of `counts` (k,) items, m in total: (m,) the group of each item, and (m,) the
    number of each item within its group.
    """
    group = np.repeat(np.arange(len(counts)), counts)
    return group, np.arange(len(group)) - np.repeat(np.cumsum(counts) - counts, counts)


def merged(angles: FloatArray) -> FloatArray:
    """The distinct `angles` (n,) [rad] of one turn, ascending; angles that differ by rounding are
    merged.

    Of angles that are merged the first remains, but at the end of the range the last, so that both
    ends of the range are exact.
    """
    ordered = ascending(angles)
    if len(ordered) < 2:
        return ordered
    # Both ends of the range are rounded to the spacing of the largest angle, and each angle is the
    # sum of a few such roundings.
    distinct = np.diff(ordered) > 8.0 * np.spacing(ordered[-1])
    first = ordered[np.concatenate(([True], distinct))]
    first[-1] = ordered[-1]
    return first


def taken(rows: Rows, which: IntArray | BoolArray | slice | list[int]) -> Rows:
    """The selected rows of all arrays of `rows`."""
    return type(rows)(*(column[which] for column in _columns(rows)))


def joined(parts: Sequence[Rows]) -> Rows:
    """The rows of all `parts` one after the other; a column may itself be such a dataclass."""
    columns = zip(*map(_columns, parts), strict=True)
    return type(parts[0])(
        *(
            joined(column) if is_dataclass(column[0]) else np.concatenate(column)
            for column in columns
        )
    )


def _columns(rows: Any) -> list[Any]:
    return [getattr(rows, entry.name) for entry in fields(rows)]


# -- rounding -------------------------------------------------------------------------------------
# Sums that are 0 up to rounding.
#
# The sum of n terms is off by at most the roundings of each term and those of the additions, each a
# half unit in the last place of the magnitudes: |error| <= (k + m) u sum |terms|, u = 2^-53, with k
# roundings in a term and m additions that a term passes through (Higham, "Accuracy and Stability of
# Numerical Algorithms", 2nd ed., sections 3.1 and 4.2). A force or torque at a cam angle takes some
# tens of operations after the motion law, which has as many; a rule of 16 nodes adds 16 times, and
# numpy adds n partial sums in pairs of pairs, log2 n <= 20 times for a million of them. So k + m <=
# 128, which is `SHARE` of the sum of magnitudes.


SHARE: Final = 128.0 * 2.0**-53
"""A sum below this share of the sum of its terms' magnitudes is rounding."""


def resolved(value: float, size: float) -> float:
    """`value`; 0 if it is rounding of terms whose magnitudes sum up to `size`."""
    return 0.0 if abs(value) <= SHARE * size else value


# -- many -----------------------------------------------------------------------------------------
# Quantities of many objects of a kind, such as the pitch curves of many designs, at once.
#
# Each object has, to the last bit, the values that it has when it is computed alone.


Quantity = Callable[[FloatArray, Side], FloatArray]
"""(..., n) values at n arguments, approached from the given side."""

AnyQuantity = TypeVar("AnyQuantity", contravariant=True)


class Many(Protocol[AnyQuantity]):
    """Several objects with the same quantities, evaluated together or each at its own places.

    Attributes
    ----------
    count : number of objects.
    """

    @property
    def count(self) -> int: ...

    def everywhere(self, quantity: AnyQuantity, x: FloatArray, side: Side) -> FloatArray:
        """(..., count, n) values of each object at x (n,)."""

    def paired_values(
        self, quantity: AnyQuantity, x: FloatArray, side: Side, which: IntArray
    ) -> FloatArray:
        """(..., n) values at x (n,), each of the object with the number in `which` (n,)."""


class One:
    """A single object, whose quantities are functions."""

    count = 1

    def everywhere(self, quantity: Quantity, x: FloatArray, side: Side) -> FloatArray:
        """See `Many.everywhere`."""
        # The axis of the objects has length 1 and stands before that of x.
        return quantity(x, side)[..., None, :]

    def paired_values(
        self, quantity: Quantity, x: FloatArray, side: Side, _: IntArray
    ) -> FloatArray:
        """See `Many.paired_values`."""
        return quantity(x, side)


ONE: Final = One()
