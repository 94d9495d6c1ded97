"""Rules on which machines an effect, or keys of its table, can be used with.

A rule checks the table of one effect against the machine before anything is computed. Most rules
are data, `Only`, from which the descriptions in the schema of the scene are generated too.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Final, Literal

from camgeo.kinematics.mechanism.values import UNIT_OF

if TYPE_CHECKING:
    from camgeo.kinematics.mechanism.values import Member, Touching
    from camgeo.units import LiftUnit


@dataclass(frozen=True, slots=True)
class Machine:
    """The properties of a machine that rules depend on.

    Attributes
    ----------
    lift : unit of the follower's lift, "mm" in a guide, "rad" for a rocker; None if unknown.
    touching : what touches the cam, "roller" or "face"; None if unknown.
    edged : whether it is a knife edge.
    far : the far end of its linkage, empty if there is no linkage; None if unknown.
    paired : whether a return disc holds the follower back.
    yoked : whether the follower has a second contact beyond the cam axis.
    """

    lift: LiftUnit | None
    touching: Touching | None
    edged: bool = False
    far: Member | Literal[""] | None = ""
    paired: bool = False
    yoked: bool = False

    @property
    def demanded(self) -> LiftUnit | None:
        """Unit of the demanded motion; None if unknown."""
        return UNIT_OF[self.far] if self.far else None if self.far is None else self.lift

    @property
    def straight(self) -> bool | None:
        """Whether it has a guided follower or a slider; None if unknown."""
        units = (self.lift, self.demanded)
        return True if "mm" in units else None if None in units else False


@dataclass(frozen=True, slots=True)
class Table:
    """The table of an effect in a scene.

    Attributes
    ----------
    values : by key; None where the value is known to be wrong.
    meant : missing keys that a misspelt key was probably meant to be.
    """

    values: Mapping[str, Any]
    meant: Collection[str] = field(default=())

    def lacks(self, key: str) -> bool:
        """Whether the key is missing, and no misspelt key was meant to be it."""
        return key not in self.values and key not in self.meant


Rule = Callable[[Machine, Table], Iterator[tuple[str, str]]]
"""Yields the keys of the table at fault, empty for the effect as a whole, with the reason."""


@dataclass(frozen=True, slots=True)
class Kind:
    """A kind of machine.

    Attributes
    ----------
    of : the attribute of `Machine` that distinguishes it.
    others : values of this attribute that certainly mean another kind.
    refusal : the message for a scene with another kind of machine.
    description : the same, as a sentence for the schema.
    barring : key of [follower] in the scene that makes it another kind; empty if there is none.
    """

    of: str
    others: tuple[str | bool, ...]
    refusal: str
    description: str
    barring: str = ""


@dataclass(frozen=True, slots=True, init=False)
class Only:
    """The effect, or the named keys of its table, apply to one kind of machine only."""

    kind: Kind
    keys: tuple[str, ...]

    def __init__(self, kind: Kind, *keys: str) -> None:
        object.__setattr__(self, "kind", kind)
        object.__setattr__(self, "keys", keys)

    def __call__(self, machine: Machine, table: Table) -> Iterator[tuple[str, str]]:
        """See `Rule`."""
        if getattr(machine, self.kind.of) in self.kind.others:
            for key in self.keys or ("",):
                if not key or key in table.values:
                    yield key, self.kind.refusal


GUIDED: Final = Kind(
    "lift",
    ("rad",),
    "is for translating followers, and this follower is a rocker",
    "Translating followers only.",
)
ROCKING: Final = Kind(
    "lift", ("mm",), "is for rockers, and this follower is translating", "Rockers only."
)
ROLLERS: Final = Kind("touching", ("face",), "is for roller followers", "Roller followers only.")
ROUND: Final = Kind(
    "edged", (True,), "is for rollers: the follower has a knife edge", "Not with a knife edge."
)
FLATS: Final = Kind(
    "touching", ("roller",), "is for flat-faced followers", "Flat-faced followers only."
)
ONE_DISC: Final = Kind(
    "paired",
    (True,),
    "supports a single disc, and a conjugate pair, [follower.return], has two",
    "Not with a conjugate pair.",
    "return",
)
ONE_ROLLER: Final = Kind(
    "paired",
    (True,),
    "supports a single roller, and a conjugate pair, [follower.return], has two",
    "Not with a conjugate pair.",
    "return",
)
PLAYED: Final = Kind(
    "yoked",
    (True,),
    "is not for a yoke, [follower.yoke], whose play follows from its breadth",
    "Not with a yoke.",
    "yoke",
)
LINKED: Final = Kind(
    "far", ("",), "is for linkages, and the scene has no [linkage]", "Only with a linkage."
)
DRIVING_SLIDER: Final = Kind(
    "far",
    ("", "lever", "crank"),
    "is for a slider that drives a rocker, and the scene has no such linkage",
    "Only with a slider that drives a rocker.",
)
STRAIGHT: Final = Kind(
    "straight",
    (False,),
    DRIVING_SLIDER.refusal,
    "Translating followers, or sliders that drive rockers, only.",
)
TURNING: Final = Kind(
    "far",
    ("", "slider"),
    "is for the lever of a four-bar linkage, or a crank driven by a slider",
    "Only with the lever of a four-bar linkage, or a crank driven by a slider.",
)
LENGTHS: Final = Kind(
    "demanded",
    ("rad",),
    "is for a demanded motion that is a length, and here it is an angle",
    "Only where the demanded motion is a length.",
)
ANGLES: Final = Kind(
    "demanded",
    ("mm",),
    "is for a demanded motion that is an angle, and here it is a length",
    "Only where the demanded motion is an angle.",
)
