"""What does not go together: an effect, or keys of its table, and a kind of machine.

A rule looks at one effect's table and at the machine, before anything is computed. Most rules are
data, `Only`, of which the descriptions in the scene's schema are made too.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Final, Literal

from camgeo.mechanism.kind import UNIT_OF

if TYPE_CHECKING:
    from camgeo.mechanism.kind import Touching, Unit
    from camgeo.mechanism.linkage_protocol import Member


@dataclass(frozen=True, slots=True)
class Machine:
    """What rules ask of a machine.

    Attributes
    ----------
    lift : unit of the follower's own lift, "mm" in a guide, "rad" of a rocker; None if not known.
    touching : what touches the cam, "roller" or "face"; None if not known.
    edged : whether it is a knife edge.
    far : the far end of its linkage, empty if there is no linkage; None if not known.
    paired : whether a return disc holds the follower back.
    yoked : whether the follower has a second side beyond the cam axis.
    """

    lift: Unit | None
    touching: Touching | None
    edged: bool = False
    far: Member | Literal[""] | None = ""
    paired: bool = False
    yoked: bool = False

    @property
    def demanded(self) -> Unit | None:
        """Unit of the motion that is demanded; None if not known."""
        return UNIT_OF[self.far] if self.far else None if self.far is None else self.lift

    @property
    def straight(self) -> bool | None:
        """Whether it has a follower in a guide or a slider; None if not known."""
        units = (self.lift, self.demanded)
        return True if "mm" in units else None if None in units else False


@dataclass(frozen=True, slots=True)
class Table:
    """The table of an effect in a scene.

    Attributes
    ----------
    values : by the keys that it has; None where the value is known to be wrong.
    meant : keys that it lacks but, by a misspelt one, was meant to have.
    """

    values: Mapping[str, Any]
    meant: Collection[str] = field(default=())

    def lacks(self, key: str) -> bool:
        """Whether the table neither has the key nor was meant to."""
        return key not in self.values and key not in self.meant


Rule = Callable[[Machine, Table], Iterator[tuple[str, str]]]
"""The keys of the table that are at fault, empty for the effect as a whole, and why."""


@dataclass(frozen=True, slots=True)
class Kind:
    """Machines of a kind.

    Attributes
    ----------
    of : the attribute of a `Machine` that tells it.
    others : its values in machines that are surely of another kind.
    refusal : what is said to a scene of another kind.
    told : the same as a sentence of a description.
    barring : key of the scene's [follower] that makes a machine of another kind; empty if none.
    """

    of: str
    others: tuple[str | bool, ...]
    refusal: str
    told: str
    barring: str = ""


@dataclass(frozen=True, slots=True, init=False)
class Only:
    """The effect, or the named keys of its table, are for machines of a kind alone."""

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
    "is for translating followers, and this one is a rocker",
    "Translating followers only.",
)
ROCKING: Final = Kind(
    "lift", ("mm",), "is for rockers, and this follower is a translating one", "Rockers only."
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
    "knows one disc; a conjugate pair, [follower.return], has two",
    "Not with a conjugate pair.",
    "return",
)
ONE_ROLLER: Final = Kind(
    "paired",
    (True,),
    "knows one roller; a conjugate pair, [follower.return], has two",
    "Not with a conjugate pair.",
    "return",
)
ONE_CONTACT: Final = Kind(
    "yoked",
    (True,),
    "knows one contact; a yoke, [follower.yoke], has two",
    "Not with a yoke.",
    "yoke",
)
LINKED: Final = Kind(
    "far", ("",), "is for linkages, and there is no [linkage]", "Only with a linkage."
)
DRIVING_SLIDER: Final = Kind(
    "far",
    ("", "lever", "crank"),
    "is for a slider that drives a rocker; no such linkage is here",
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
    "is for the lever of a four-bar, or for a crank that a slider turns",
    "Only with the lever of a four-bar, or a crank that a slider turns.",
)
LENGTHS: Final = Kind(
    "demanded",
    ("rad",),
    "is for a demanded motion that is a length; here it is an angle",
    "Only where the motion that is demanded is a length.",
)
ANGLES: Final = Kind(
    "demanded",
    ("mm",),
    "is for a demanded motion that is an angle; here it is a length",
    "Only where the motion that is demanded is an angle.",
)
