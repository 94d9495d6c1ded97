"""The valid values of a scene: rules are checked on these, whatever else is wrong."""

from __future__ import annotations

from collections.abc import Collection, Hashable
from decimal import Decimal
from typing import TYPE_CHECKING, Any, TypeAlias

from camgeo.cam.contact import Contact
from camgeo.mechanism.declared.registry import FOLLOWERS, LINKAGES
from camgeo.mechanism.kind import UNIT_OF, FollowerKind
from camgeo.scene.document import Document
from camgeo.scene.keys import Path, value_at
from camgeo.scene.noted import Reads, unchanged
from camgeo.units import MM_PER, LengthUnit, LiftUnit

if TYPE_CHECKING:
    from camgeo.mechanism.linkage_protocol import Member

Broken: TypeAlias = tuple[Path, str]
"""What a rule finds: the place at fault, and why."""


class ValidValues:
    """A scene without the values that are known to be wrong.

    A rule reads what it compares and reports nothing where anything is missing, so that no fault
    is a consequence of another one.

    Attributes
    ----------
    scene : with the values that are wrong too. Rules do not look there, see `Noted`.
    flawless : whether no value is wrong by itself.
    reads : what each rule has read, if that was noted.
    """

    def __init__(
        self, scene: Document, bad: Collection[Path] = (), meant: Collection[Path] = ()
    ) -> None:
        self.scene = scene
        self._bad = frozenset(bad)
        self._around_bad = {path[:end] for path in bad for end in range(len(path) + 1)}
        self._meant = frozenset(meant)
        self.flawless = not (bad or meant)
        self.reads: dict[Hashable, Reads] = {}

    def valid(self, *path: str | int) -> bool:
        """Whether nothing is wrong at `path`, around it or in it."""
        if not self._bad:
            return True
        if path in self._around_bad:
            return False
        return not any(path[:end] in self._bad for end in range(len(path) + 1))

    def has(self, *path: str | int) -> bool:
        """Whether the scene names the key, with a valid value or not."""
        return self.scene.at(path) is not None

    def lacks(self, *path: str | int) -> bool:
        """Whether the scene neither names the key nor has a misspelt one meant to be it."""
        meant = any(path[:end] in self._meant for end in range(1, len(path) + 1))
        return not meant and not self.has(*path)

    def get(self, *path: str | int) -> Any:
        """Value at `path`; None if it is absent or not valid."""
        return self.raw(*path) if self.valid(*path) else None

    def raw(self, *path: str | int) -> Any:
        """Value at `path`, valid or not; None if it is absent, or can be the value of no scene."""
        return value_at(self.scene.plain, path)

    def exact(self, *path: str | int) -> Decimal | None:
        """Number at `path` exactly as written; None if it is absent or not valid."""
        if self.get(*path) is None:
            return None
        return Decimal(self.scene.at(path))

    @property
    def unit(self) -> LengthUnit:
        """The scene's unit of length, mm if it is not valid."""
        return "inch" if self.get("units", "length") == "inch" else "mm"

    @property
    def mm(self) -> float:
        """Millimetres per unit of length."""
        return MM_PER[self.unit]

    @property
    def segments(self) -> int:
        """Number of segments of the motion, 0 if `motion` is not a list."""
        motion = self.raw("motion")
        return len(motion) if isinstance(motion, list) else 0

    @property
    def follower_kind(self) -> FollowerKind | None:
        """What kind of follower it is; None if that is not known."""
        return FOLLOWERS.get(self.get("follower", "kind") or "")

    @property
    def contact(self) -> Contact | None:
        """The flank on which the follower runs; None if that is not known."""
        if not self.valid("follower", "contact"):
            return None
        return Contact(self.get("follower", "contact") or Contact.INNER)

    @property
    def flat(self) -> bool:
        """Whether the follower has a flat face."""
        return self.follower_kind is not None and self.follower_kind.touching == "face"

    @property
    def slides(self) -> bool:
        """Whether the follower is a translating one."""
        return self.follower_kind is not None and self.follower_kind.unit == "mm"

    @property
    def lift_unit(self) -> LiftUnit:
        """Of the follower's own motion; without a follower, that of the linkage or the scene."""
        if self.follower_kind is not None:
            return self.follower_kind.unit
        if self.has("linkage"):
            linkage = LINKAGES.get(self.get("linkage", "kind"))
            return "mm" if linkage is None else next(iter(linkage.members))
        return "rad" if self.get("units", "motion") == "degrees" else "mm"

    @property
    def angular(self) -> bool:
        """Whether positions of the motion are angles: of the follower, or of a linkage's end."""
        if self.lacks("linkage"):
            return self.lift_unit == "rad"
        far_end = far_end_of(self)
        return far_end is not None and UNIT_OF[far_end] == "rad"


def far_end_of(values: ValidValues) -> Member | None:
    """The member whose motion a linkage's far end makes; None without one, or if not known."""
    linkage, follower = values.get("linkage", "kind"), values.follower_kind
    if linkage is None or (follower is None and values.has("follower")):
        return None
    return LINKAGES[linkage].members.get(values.lift_unit)


def unchanged_reads(earlier: ValidValues, now: ValidValues) -> dict[Hashable, Reads]:
    """What was read of an `earlier` scene and is the same `now`."""
    return unchanged(earlier.reads, earlier.scene.exact, now.scene.exact)


def tables_of(values: ValidValues, *names: str) -> dict[str, Any]:
    """Those of the scene's tables with these names that it has, valid or not."""
    return {name: values.raw(name) for name in names if values.has(name)}


class Noted(ValidValues):
    """The values of a scene none of which is wrong by itself; notes what is read of them.

    Attributes
    ----------
    noted : all that has been read.
    """

    def __init__(self, scene: Document) -> None:
        super().__init__(scene)
        self.noted = Reads()

    def valid(self, *_: str | int) -> bool:
        """See `ValidValues.valid`."""
        return True

    def has(self, *path: str | int) -> bool:
        """See `ValidValues.has`."""
        self.noted.note_presence(path)
        return super().has(*path)

    def raw(self, *path: str | int) -> Any:
        """See `ValidValues.raw`."""
        self.noted.note(path)
        return super().raw(*path)
