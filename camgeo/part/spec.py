"""The specification of the part in a scene."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Annotated, Any, Final, Self

from camgeo.errors import GeometryError
from camgeo.mechanism.values import Angle, Length
from camgeo.numeric.checked import check_fields, number, one_of
from camgeo.part.keyways import din_6885_1

UPPER: Final = "upper"
LOWER: Final = "lower"
BOTH: Final = "both"

SIDES: Final = (UPPER, LOWER, BOTH)
"""Faces of the disc on which a hub stands."""


@dataclass(frozen=True, slots=True)
class Keyway:
    """Keyway of the bore, a slot with parallel sides.

    Attributes
    ----------
    width : width of the slot [mm].
    depth : from the bore's edge to the bottom, measured on the middle line [mm] (t2 of DIN 6885).
    angle : direction of the middle line from the x axis at cam angle 0 [rad], counter-clockwise,
        -2 pi to 2 pi.

    Raises
    ------
    GeometryError
        With the key, if a value is invalid.
    """

    width: Length
    depth: Length
    angle: Angle = 0.0

    def __post_init__(self) -> None:
        check_fields(self, "part.keyway.")

    @classmethod
    def by_standard(cls, bore: float, angle: float = 0.0) -> Self:
        """By DIN 6885-1, deep form, for a bore of that diameter [mm]; raises GeometryError with key
        "part.keyway.standard" if the table has no such bore.
        """
        row = din_6885_1(bore)
        return cls(row.width, row.depth, angle)


@dataclass(frozen=True, slots=True)
class Hub:
    """A round hub about the cam axis, on one face of the disc or on both.

    Attributes
    ----------
    diameter : of the hub [mm].
    height : above the face on which it stands [mm]; on both faces the same.
    side : one of `SIDES`.

    Raises
    ------
    GeometryError
        With the key, if a value is invalid.
    """

    diameter: Length
    height: Length
    side: Annotated[str, partial(one_of, choices=SIDES)] = UPPER

    def __post_init__(self) -> None:
        check_fields(self, "part.hub.")


@dataclass(frozen=True, slots=True)
class Mark:
    """A timing mark sunk in the upper face of the disc: a radial slot with round ends, or a dot.

    Attributes
    ----------
    radius : distance of its middle from the cam axis [mm].
    width : of the slot, diameter of the dot [mm].
    depth : below the upper face [mm].
    length : of the slot from end to end, along the ray [mm]; None for a dot.
    angle : direction of its middle from the x axis at cam angle 0 [rad], counter-clockwise, -2 pi
        to 2 pi.

    Raises
    ------
    GeometryError
        With the key, if a value is invalid, or the slot no longer than wide.
    """

    radius: Length
    width: Length
    depth: Length
    length: Length | None = None
    angle: Angle = 0.0

    def __post_init__(self) -> None:
        check_fields(self, "part.mark.")
        if self.length is not None:
            number("part.mark.length", self.length, above=self.width, unit="mm")


@dataclass(frozen=True, slots=True)
class PartSpec:
    """The specification of the part; every length in mm, None if the scene does not give it.

    Attributes
    ----------
    thickness : of the disc.
    bore : diameter of the bore.
    keyway : of the bore.
    rim : diameter of the blank, the outer boundary of a groove cam, or of a cam whose roller runs
        inside ("outer" contact).
    groove_depth : of a groove cam, less than the thickness; the groove is open to the upper face.
    hub : about the bore.
    mark : for timing, less deep than the disc is thick.

    Raises
    ------
    GeometryError
        With the key, if a value is invalid, groove or mark are as deep as the disc, a keyway has no
        bore, or the hub is no larger than the bore.
    """

    thickness: Length | None = None
    bore: Length | None = None
    keyway: Keyway | None = None
    rim: Length | None = None
    groove_depth: Length | None = None
    hub: Hub | None = None
    mark: Mark | None = None

    def __post_init__(self) -> None:
        check_fields(self, "part.")
        if self.groove_depth is not None and self.thickness is not None:
            number("part.groove_depth", self.groove_depth, below=self.thickness, unit="mm")
        if self.mark is not None and self.thickness is not None:
            number("part.mark.depth", self.mark.depth, below=self.thickness, unit="mm")
        if self.hub is not None and self.bore is not None:
            number("part.hub.diameter", self.hub.diameter, above=self.bore, unit="mm")
        if self.keyway is not None and self.bore is None:
            raise GeometryError("a keyway belongs to a bore", key="part.keyway")


def part_of(table: Mapping[str, Any]) -> PartSpec:
    """The specification of a converted table `[part]`, in mm and rad; raises GeometryError."""
    given = dict(table)
    features: Mapping[str, Callable[..., Any]] = {"keyway": Keyway, "hub": Hub, "mark": Mark}
    for name, made in features.items():
        if name not in given:
            continue
        own = dict(given[name])
        if own.pop("standard", None):
            given[name] = Keyway.by_standard(given["bore"], **own)
        else:
            given[name] = made(**own)
    return PartSpec(**given)
