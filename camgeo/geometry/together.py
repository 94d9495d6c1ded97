"""Many curves, or discs, with motions that one plan demands, as one to be evaluated at once."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Hashable, Iterator, Sequence
from dataclasses import dataclass, fields, is_dataclass, replace
from types import MethodType
from typing import Any, Generic, TypeVar, cast

import numpy as np

from camgeo.geometry.pitch_curve import BLOCK, PitchCurve
from camgeo.kinematics.mechanism.linkage import LinkedMotion
from camgeo.kinematics.motion import FULL_ORDER, Jet, MergedDwell, Motion
from camgeo.numeric.arrays import FloatArray, IntArray, Quantity, Side
from camgeo.record import Pickled

# -- several ---------------------------------------------------------------------------------------
# Several followers, or linkages, of a kind as one, whose numbers are arrays.
#
# Their formulas take each value of the lift by itself: numbers that are arrays, a value for each of
# the lifts, give every member the bits that it has alone.


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
    values = (getattr(member, field.name) for field in fields(member))  # type: ignore[arg-type]  # followers and linkages are dataclasses
    return type(member), *(_formula_key(value) for value in values)


def _formula_key(value: Any) -> Hashable:
    """What of a value decides between formulas: of a float or complex number only its type."""
    if type(value) is tuple:
        return tuple(map(_formula_key, value))
    if is_dataclass(value):
        return alike(value)
    kind: Hashable = type(value).__name__ if type(value) in (float, complex) else value
    return kind


class _Several(Generic[Member]):
    """See `several`."""

    def __init__(self, members: Sequence[Member], which: IntArray) -> None:
        self._members, self._which = members, which

    def __getattr__(self, name: str) -> Any:
        """Called only while the instance has no attribute of that name.

        Properties are evaluated member by member, so those that decide between formulas must stay
        properties, like `FourBar._far_shaft`: inlined, they would be evaluated for all members at
        once.
        """
        # A method is bound to this object, so that it reads the columns; a property is not called
        # here.
        of_class = inspect.getattr_static(type(self._members[0]), name, None)
        if inspect.isfunction(of_class):
            return MethodType(of_class, self)
        column = self._column(name, [getattr(member, name) for member in self._members])
        setattr(self, name, column)
        return column

    def _column(self, name: str, values: list[Any]) -> Any:
        """The `values` of the members as one: the same for all, or an array with one a place."""
        first = values[0]
        if all(value is first for value in values):
            return first
        if type(first) is tuple:
            return tuple(self._column(name, [*column]) for column in zip(*values, strict=True))
        if is_dataclass(first):
            return several(values, self._which)
        # Equal numbers stay a scalar, so that a formula gives the same bits as for one member.
        column = np.array(values)
        if column.dtype.kind in "fc":
            # Compared by their bytes: 0.0 and -0.0 differ then, and a NaN equals itself.
            same = column.tobytes() == column[:1].tobytes() * len(values)
            return first if same else column[self._which]
        if all(value == first for value in values):
            return first
        raise AttributeError(f"{name} differs, and is no number")


# -- together --------------------------------------------------------------------------------------


Join = Callable[[tuple[Member, ...], IntArray, int], Member]
"""Joins members into one: (members, (n,) number of the member at each place, how often the places
are repeated) -> the joined member, see `Together`."""


@dataclass(frozen=True, slots=True, eq=False)
class Repeated(Pickled):
    """A motion at the same cam angles for each of many followers.

    Attributes
    ----------
    motion : the one that it repeats.
    times : how often; the cam angles asked for are so many times the same ones.
    """

    motion: Motion
    times: int

    @property
    def breaks(self) -> FloatArray:
        """See `Motion`."""
        return self.motion.breaks

    @property
    def borders(self) -> FloatArray:
        """See `Motion`."""
        return self.motion.borders

    @property
    def dwells(self) -> tuple[MergedDwell, ...]:
        """See `Motion`."""
        return self.motion.dwells

    def jet(self, phi: FloatArray, side: Side = "right", order: int = FULL_ORDER) -> Jet:
        """See `Motion.jet`."""
        return self._tiled(self.motion.jet(self._once(phi), side, order))

    def jet_and_bounds(self, low: FloatArray, high: FloatArray) -> tuple[Jet, Jet]:
        """See `Motion.jet_and_bounds`."""
        jet, bounds = self.motion.jet_and_bounds(self._once(low), self._once(high))
        return self._tiled(jet), self._tiled(bounds)

    def _once(self, phi: FloatArray) -> FloatArray:
        """The first repetition of the cam angles `phi`."""
        return phi[: len(phi) // self.times]

    def _tiled(self, jet: Jet) -> Jet:
        """`jet` for all repetitions."""
        return np.tile(jet, self.times)


@dataclass(frozen=True, slots=True)
class LinkedMotions(LinkedMotion):
    """The followers' motions behind `several` linkages, each of which is known to close."""

    def __post_init__(self) -> None:
        """Nothing to check."""


def one_motion(motions: Sequence[Motion], which: IntArray, times: int) -> Motion:
    """The `motions` as one, see `Join`: one and the same, or `LinkedMotion`s that the same motion
    is demanded of, with linkages that are `alike`.
    """

    def repeated(motion: Motion) -> Motion:
        return motion if times == 1 else Repeated(motion, times)

    first = motions[0]
    if all(motion is first for motion in motions):
        return repeated(first)
    linked = cast("Sequence[LinkedMotion]", motions)
    linkage = several([motion.linkage for motion in linked], which)
    return LinkedMotions(repeated(linked[0].demanded), linkage)


def one_curve(curves: Sequence[PitchCurve], which: IntArray, times: int) -> PitchCurve:
    """`curves` of the same sense, with motions for `one_motion` and followers that are `alike`, as
    one: a `Join`.
    """
    motion = one_motion([curve.motion for curve in curves], which, times)
    follower = several([curve.follower for curve in curves], which)
    return replace(curves[0], motion=motion, follower=follower)


@dataclass(frozen=True, slots=True)
class Together(Generic[Member]):
    """`Many` members, asked for quantities that are made of a member.

    Attributes
    ----------
    members : at least one.
    join : makes one member of them that has the values of each at its own places.
    """

    members: tuple[Member, ...]
    join: Join[Member]

    @property
    def count(self) -> int:
        """See `Many`."""
        return len(self.members)

    def everywhere(
        self, quantity: Callable[[Member], Quantity], x: FloatArray, side: Side
    ) -> FloatArray:
        """See `Many.everywhere`; the motion is evaluated once for all that fit into a block."""
        blocks = []
        for joined, times in self.blocks(len(x)):
            values = quantity(joined)(np.tile(x, times), side)
            blocks.append(values.reshape(*values.shape[:-1], times, len(x)))
        return np.concatenate(blocks, axis=-2)

    def blocks(self, length: int) -> Iterator[tuple[Member, int]]:
        """As many members as fit into a block, `length` places of each, and how many these are."""
        # At least one member a block, even if its places alone exceed `BLOCK`.
        most = max(1, BLOCK // max(length, 1))
        for start in range(0, self.count, most):
            some = self.members[start : start + most]
            times = len(some)
            which = np.repeat(np.arange(times), length)
            yield (some[0] if times == 1 else self.join(some, which, times)), times

    def paired_values(
        self, quantity: Callable[[Member], Quantity], x: FloatArray, side: Side, which: IntArray
    ) -> FloatArray:
        """See `Many.paired_values`."""
        if self.count == 1:
            return quantity(self.members[0])(x, side)
        starts = range(0, max(len(x), 1), BLOCK)
        blocks = [slice(start, start + BLOCK) for start in starts]
        values = [
            quantity(self.join(self.members, which[block], 1))(x[block], side) for block in blocks
        ]
        return np.concatenate(values, axis=-1)


def curves_together(curves: Sequence[PitchCurve]) -> Together[PitchCurve]:
    """Pitch curves as for `one_curve`."""
    return Together(tuple(curves), one_curve)
