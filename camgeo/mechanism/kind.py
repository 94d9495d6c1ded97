"""What a kind of follower or linkage declares: its name, the keys of its table, how it is built.

A declaration imports nothing that computes; what it builds is imported when it is built. What reads
scenes knows kinds by their declarations alone.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final, Literal

if TYPE_CHECKING:
    from camgeo.mechanism.linkage_protocol import Linkage, Member
    from camgeo.mechanism.values import Values
    from camgeo.units import LiftUnit

Touching = Literal["roller", "face"]
"""The part of a follower that touches the cam."""

Mover = Literal["follower", "rocker"]
"""The part of a follower that moves."""

UNIT_OF: Final[Mapping[Member, LiftUnit]] = {"slider": "mm", "lever": "rad", "crank": "rad"}
"""Unit of the positions of a linkage's far end."""

Rule = Callable[[Mapping[str, Any]], Iterator[tuple[str, str]]]
"""Yields the keys at fault in a table and why; values known to be wrong are left out of it."""


@dataclass(frozen=True, slots=True)
class FollowerKind:
    """A kind of follower.

    Attributes
    ----------
    name : as scenes write it.
    description : what it is, in a sentence.
    unit : of its lift.
    touching : the part that touches the cam.
    schema : JSON Schema of its table, without its kind.
    build : makes the follower of a table.
    build_return : makes the `conjugate.Mount` of the second roller of a conjugate pair of the table
        [follower.return]; None if this kind has none.
    sizes : keys of the lengths that a tolerance is compared with; nested ones with a dot.
    rules : conditions that relate its keys.
    """

    name: str
    description: str
    unit: LiftUnit
    touching: Touching
    schema: Mapping[str, Any]
    build: Callable[[Values], Any]
    sizes: tuple[str, ...]
    build_return: Callable[[Values], Any] | None = None
    rules: tuple[Rule, ...] = ()


@dataclass(frozen=True, slots=True)
class LinkageKind:
    """A kind of linkage.

    Attributes
    ----------
    name : as scenes write it.
    description : what it is, in a sentence or two.
    members : whose motion is demanded, by the unit of lift of the follower that it drives.
    schema : JSON Schema of its table, without its kind.
    build : makes the linkage of a table, for a follower whose lift has that unit.
    templates : names of the scenes with it that `camgeo new` writes.
    """

    name: str
    description: str
    members: Mapping[LiftUnit, Member]
    schema: Mapping[str, Any]
    build: Callable[[Values, LiftUnit], Linkage]
    templates: tuple[str, ...] = ()
