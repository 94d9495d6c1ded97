"""Several followers, or linkages, of a kind as one, whose numbers are arrays.

Their formulas take each value of the lift by itself: numbers that are arrays, a value for each of
the lifts, give every member the bits that it has alone.
"""

from __future__ import annotations

import inspect
from collections.abc import Hashable, Sequence
from dataclasses import fields, is_dataclass
from types import MethodType
from typing import Any, Generic, TypeVar, cast

import numpy as np

from camgeo.numeric.arrays import IntArray

Member = TypeVar("Member")


def several(members: Sequence[Member], which: IntArray) -> Member:
    """The `members`, which are `alike`, as one that is evaluated at n lifts at once.

    Parameters
    ----------
    which : (n,) the number of the member to which each lift belongs.

    Only its formulas over the lift can be used: methods are those of the class, with the properties
    of the members. AttributeError where these are no numbers and differ.
    """
    return cast("Member", _Several(members, which))


def alike(member: object) -> Hashable:
    """Equal for members that differ in numbers only, and so can be one of `several`."""
    values = (getattr(member, each.name) for each in fields(member))  # type: ignore[arg-type]  # followers and linkages are dataclasses
    return type(member), *(_sort(value) for value in values)


def _sort(value: Any) -> Hashable:
    """The type of a measure, and whatever else decides between formulas."""
    if type(value) is tuple:
        return tuple(map(_sort, value))
    if is_dataclass(value):
        return alike(value)
    found: Hashable = type(value).__name__ if type(value) in (float, complex) else value
    return found


class _Several(Generic[Member]):
    """See `several`."""

    def __init__(self, members: Sequence[Member], which: IntArray) -> None:
        self._members, self._which = members, which

    def __getattr__(self, name: str) -> Any:
        """Called where nothing is kept by that name.

        Properties are evaluated member by member, so those that decide between formulas must stay
        properties, like `FourBar._far_shaft`: inlined, they would be asked of all members at once.
        """
        of_class = inspect.getattr_static(type(self._members[0]), name, None)
        if inspect.isfunction(of_class):
            return MethodType(of_class, self)
        found = self._column(name, [getattr(each, name) for each in self._members])
        setattr(self, name, found)
        return found

    def _column(self, name: str, values: list[Any]) -> Any:
        first = values[0]
        if all(each is first for each in values):
            return first
        if type(first) is tuple:
            return tuple(self._column(name, [*each]) for each in zip(*values, strict=True))
        if is_dataclass(first):
            return several(values, self._which)
        column = np.array(values)
        if column.dtype.kind in "fc":
            same = column.tobytes() == column[:1].tobytes() * len(values)
            return first if same else column[self._which]
        if all(each == first for each in values):
            return first
        raise AttributeError(f"{name} differs, and is no number")
