"""Quantities of many objects of a kind, such as the pitch curves of many designs, at once.

Whatever is computed of several objects together has, of each, the bits that it has alone.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Final, Protocol, TypeVar

from camgeo.numeric.arrays import FloatArray, IntArray, Side

Quantity = Callable[[FloatArray, Side], FloatArray]
"""(..., n) values at n arguments, approached from the given side."""

Asked = TypeVar("Asked", contravariant=True)


class Many(Protocol[Asked]):
    """Objects that are asked for the values of a quantity, together or each at its own places.

    Attributes
    ----------
    count : of the objects.
    """

    @property
    def count(self) -> int: ...

    def everywhere(self, quantity: Asked, x: FloatArray, side: Side) -> FloatArray:
        """(..., count, n) values of each object at x (n,)."""

    def at(self, quantity: Asked, x: FloatArray, side: Side, which: IntArray) -> FloatArray:
        """(..., n) values at x (n,), each of the object with the number in `which` (n,)."""


class One:
    """A single object, whose quantities are functions."""

    count = 1

    def everywhere(self, quantity: Quantity, x: FloatArray, side: Side) -> FloatArray:
        """See `Many.everywhere`."""
        return quantity(x, side)[..., None, :]

    def at(self, quantity: Quantity, x: FloatArray, side: Side, _: IntArray) -> FloatArray:
        """See `Many.at`."""
        return quantity(x, side)


ONE: Final = One()
