"""What a kind of follower or linkage declares: its name, the keys of its table, how it is built.

A declaration imports nothing that computes; what it builds is imported when it is built. Rooms
that read scenes know kinds by their declarations alone.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final, Literal

if TYPE_CHECKING:
    from camgeo.mechanism.linkage_protocol import Linkage, Member
    from camgeo.mechanism.values import Values

Unit = Literal["mm", "rad"]
"""Of a lift or of a demanded position."""

Touching = Literal["roller", "face"]
"""What of a follower touches the cam."""

Mover = Literal["follower", "rocker"]
"""What of a follower moves."""

UNIT_OF: Final[Mapping[Member, Unit]] = {"slider": "mm", "lever": "rad", "crank": "rad"}
"""Of the positions of a linkage's far end."""

Rule = Callable[[Mapping[str, Any]], Iterator[tuple[str, str]]]
"""The key at fault in a table and why; a value that is known to be wrong is missing in it."""


@dataclass(frozen=True, slots=True)
class FollowerKind:
    """A kind of follower.

    Attributes
    ----------
    name : in scenes.
    told : what it is, a sentence.
    unit : of its lift.
    touching : what touches the cam.
    schema : JSON Schema of its table, without its kind.
    build : the follower of a table.
    build_return : the second roller of a conjugate pair, of the main follower and the table
        [follower.return]; None if there is none for this kind.
    sizes : keys of the lengths that a tolerance is held against, those of tables in it with a dot.
    rules : what its keys have to do with each other.
    """

    name: str
    told: str
    unit: Unit
    touching: Touching
    schema: Mapping[str, Any]
    build: Callable[[Values], Any]
    sizes: tuple[str, ...]
    build_return: Callable[[Any, Values], Any] | None = None
    rules: tuple[Rule, ...] = ()


@dataclass(frozen=True, slots=True)
class LinkageKind:
    """A kind of linkage.

    Attributes
    ----------
    name : in scenes.
    told : what it is, a sentence or two.
    members : whose motion is demanded, for the units of lift of the followers that it drives.
    schema : JSON Schema of its table, without its kind.
    build : the linkage of a table, for a follower whose lift has that unit.
    templates : names of the scenes that `camgeo new` has of it.
    """

    name: str
    told: str
    members: Mapping[Unit, Member]
    schema: Mapping[str, Any]
    build: Callable[[Values, Unit], Linkage]
    templates: tuple[str, ...] = ()
