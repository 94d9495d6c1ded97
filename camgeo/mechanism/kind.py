"""What a kind of follower or linkage declares: its name, the keys of its table, how it is built.

A declaration imports nothing that computes; what it builds is imported when it is built. Rooms
that read scenes know kinds by their declarations alone.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final, Literal

if TYPE_CHECKING:
    from camgeo.mechanism.linkage_protocol import Linkage, Member

Unit = Literal["mm", "rad"]
"""Of a lift or of a demanded position."""

Touching = Literal["roller", "face"]
"""What of a follower touches the cam."""

Mover = Literal["follower", "rocker"]
"""What of a follower moves."""

UNIT_OF: Final[Mapping[Member, Unit]] = {"slider": "mm", "lever": "rad", "crank": "rad"}
"""Of the positions of a linkage's far end."""

SIGNS: Final = {"ccw": 1, "cw": -1, "outward": 1, "inward": -1, "left": 1, "right": -1}
"""The engine's signs for the words of a table."""


@dataclass(frozen=True, slots=True)
class Values:
    """A table whose values are of the right types and in range, in the units of the scene.

    Attributes
    ----------
    table : the values by their keys.
    mm : millimetres a unit of length.
    linked : whether a linkage drives the follower.
    """

    table: Mapping[str, Any]
    mm: float
    linked: bool = False

    def __getitem__(self, key: str) -> Any:
        return self.table[key]

    def get(self, key: str) -> Any:
        """The value as it stands; None if there is none."""
        return self.table.get(key)

    def lengths(self, *keys: str) -> dict[str, Any]:
        """Those of `keys` that the table has, in mm."""
        return {key: self.mm * self.table[key] for key in keys if key in self.table}

    def angles(self, *keys: str) -> dict[str, Any]:
        """Those of `keys` that the table has, in rad."""
        return {key: math.radians(self.table[key]) for key in keys if key in self.table}

    def signs(self, *keys: str) -> dict[str, Any]:
        """Those of `keys` that the table has, as +1 or -1."""
        return {key: SIGNS[self.table[key]] for key in keys if key in self.table}

    def point(self, key: str) -> complex:
        """The point at `key`, [x, y], in mm."""
        return self.mm * complex(*self.table[key])

    def ends(self, key: str) -> tuple[float, float] | None:
        """The two lengths at `key`, in mm; None if there are none."""
        if key not in self.table:
            return None
        start, end = self.table[key]
        return self.mm * start, self.mm * end

    def own_direction(self) -> dict[str, Any]:
        """The direction of a rocker's lift; None behind a linkage, which gives its own angle."""
        return {"direction": None} if self.linked else self.signs("direction")


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
