"""The dimensions of followers, linkages and parts: how they are checked and converted from a scene.

Lengths in mm and angles in rad. Each check returns the value as it is stored, or raises
`GeometryError` with the key, the value and what is allowed.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from importlib import import_module
from typing import Annotated, Any, Final, Literal, TypeVar

from camgeo.errors import GeometryError
from camgeo.numeric.checked import (
    SMALLEST,
    Check,
    field_checks,
    number,
    one_of,
    point,
    value_text,
)
from camgeo.units import TURN, LiftUnit

Built = TypeVar("Built")

RADIANS: Final = "radians"

SIGNS: Final = {"ccw": 1, "cw": -1, "outward": 1, "inward": -1, "left": 1, "right": -1}
"""The sign for each word of a table."""


def length(key: str, value: Any) -> float:
    """A length above 0 [mm]."""
    return number(key, value, above=0.0, unit="mm")


def radius(key: str, value: Any) -> float:
    """A length [mm] that may be 0."""
    size = number(key, value, least=0.0, unit="mm")
    if 0.0 < size < SMALLEST:
        raise GeometryError(f"must be 0, or at least {SMALLEST:g}", key, value_text(value))
    return size


def coordinate(key: str, value: Any) -> float:
    """A length of either sign [mm]."""
    return number(key, value, unit="mm")


def place(key: str, value: Any) -> complex:
    """A point x + i y [mm]."""
    return point(key, value, "mm")


def angle(key: str, value: Any, low: float = -TURN, high: float = TURN) -> float:
    """An angle from `low` to `high` [rad], a turn either way at most."""
    return number(key, value, least=low, most=high, unit=RADIANS)


def sense(key: str, value: Any) -> int:
    """+1 or -1."""
    return one_of(key, value, (1, -1))


def branch(key: str, value: Any) -> int:
    """+1 or -1, for the side on which a crank's tip lies: +1 is clockwise seen from its shaft."""
    return sense(key, value)


def of_table(check: Check, value: Any, mm: float) -> Any:
    """`value` of a scene's table, converted to mm or rad for a field with this `check`; `mm` is the
    length of the scene's unit.
    """
    # The check of an angle with a range of its own is a `partial` of `angle`.
    check = getattr(check, "func", check)
    if isinstance(value, str):
        # A branch is positive clockwise, while the words count as positive counter-clockwise.
        return -SIGNS[value] if check is branch else SIGNS.get(value)
    if check is place:
        return mm * complex(*value)
    if check is angle:
        return math.radians(value)
    if isinstance(value, list):
        return tuple(mm * entry for entry in value)
    return mm * value if check in (length, radius, coordinate) else value


def able(key: str, value: Any, method: str, what: str) -> None:
    """GeometryError unless `value` has the `method` that makes it `what`."""
    if isinstance(value, type) or not hasattr(value, method):
        raise GeometryError(f"must be {what}", key, value_text(value))


# As types of fields, see `camgeo.numeric.checked.check_fields`.
Length = Annotated[float, length]
Radius = Annotated[float, radius]
Coordinate = Annotated[float, coordinate]
Place = Annotated[complex, place]
Angle = Annotated[float, angle]
Sense = Annotated[int, sense]
Branch = Annotated[int, branch]


@dataclass(frozen=True, slots=True)
class Values:
    """A table with values of the right types and in range, in the units of the scene.

    Attributes
    ----------
    table : the values by their keys.
    mm : millimetres per unit of length.
    linked : whether a linkage drives the follower.
    """

    table: Mapping[str, Any]
    mm: float
    linked: bool = False

    def build(self, make: Callable[..., Built], *first: Any, **others: Any) -> Built:
        """Call `make`, a class or a function, with the values that its annotations name.

        They are converted to mm and rad by the checks in these annotations. The arguments `first`
        precede them, `others` replace those with the same names.
        """
        return make(*first, **(self.arguments(make) | others))

    def arguments(self, make: Callable[..., Any]) -> dict[str, Any]:
        """The values that the annotations of `make` name, converted as for `build`."""
        return {
            name: of_table(check, self.table[key], self.mm)
            for name, (check, key, _) in field_checks(make).items()
            if key in self.table
        }

    def sign(self, key: str, default: str) -> int:
        """+1 or -1 for the word at `key`."""
        return SIGNS[self.table.get(key, default)]


# -- kind -----------------------------------------------------------------------------------------
# The declaration of a kind of follower or linkage: its name, the keys of its table, how it is
# built.
#
# A declaration imports no module that computes; the class of the follower or linkage is imported
# when one is built. Readers of scenes know the kinds by their declarations alone.


Touching = Literal["roller", "face"]
"""The part of a follower that touches the cam."""

Member = Literal["slider", "lever", "crank"]
"""The far end of a linkage, whose motion is demanded."""

MEMBER_UNITS: Final[Mapping[Member, LiftUnit]] = {"slider": "mm", "lever": "rad", "crank": "rad"}
"""Unit of the positions of a linkage's far end."""

Rule = Callable[[Mapping[str, Any]], Iterator[tuple[str, str]]]
"""Yields the keys at fault in a table and why; values known to be wrong are left out of it."""


@dataclass(frozen=True, slots=True)
class FollowerKind:
    """A kind of follower.

    Attributes
    ----------
    name : its name in scenes.
    description : a sentence that describes it.
    unit : unit of its lift.
    touching : the part that touches the cam.
    schema : JSON Schema of its table, without its kind.
    class_path : its class, as "module:name" beside this module.
    return_maker : function that makes the second roller of a conjugate pair, in the same form;
        empty for a kind without conjugate pairs.
    sizes : keys of the lengths that a tolerance is compared with; nested ones with a dot.
    rules : conditions that relate its keys.
    """

    name: str
    description: str
    unit: LiftUnit
    touching: Touching
    schema: Mapping[str, Any]
    class_path: str
    sizes: tuple[str, ...]
    return_maker: str = ""
    rules: tuple[Rule, ...] = ()

    def build(self, values: Values) -> Any:
        """The follower that a table describes.

        Behind a linkage the lift of a rocker is its own angle, so its direction is None.
        """
        overrides = {"direction": None} if values.linked and self.unit == "rad" else {}
        return values.build(_imported(self.class_path), **overrides)

    def mount(self, values: Values) -> Any:
        """The `rollers.Mount` of the second roller that the table [follower.return] describes."""
        make = _imported(self.return_maker)
        return _imported("rollers:Mount")(make, tuple(values.arguments(make).items()))


def _imported(place: str) -> Any:
    """The object with the name "module:name", of a module beside this one."""
    module, name = place.split(":")
    return getattr(import_module(f"camgeo.kinematics.mechanism.{module}"), name)


@dataclass(frozen=True, slots=True)
class LinkageKind:
    """A kind of linkage.

    Attributes
    ----------
    name : its name in scenes.
    description : one or two sentences that describe it.
    members : member whose motion is demanded, by the unit of lift of the follower that it drives.
    schema : JSON Schema of its table, without its kind.
    build : makes the linkage of a table, for a follower whose lift has that unit.
    templates : names of the scenes with it that `camgeo new` writes.
    """

    name: str
    description: str
    members: Mapping[LiftUnit, Member]
    schema: Mapping[str, Any]
    build: Callable[[Values, LiftUnit], Any]
    templates: tuple[str, ...] = ()
