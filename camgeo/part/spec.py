"""The specification of the part in a scene."""

from __future__ import annotations

from dataclasses import dataclass

from camgeo.errors import GeometryError
from camgeo.mechanism.values import Angle, Length
from camgeo.numeric.checked import check_fields, number


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

    Raises
    ------
    GeometryError
        With the key, if a value is invalid, the groove is as deep as the disc, or a keyway has no
        bore.
    """

    thickness: Length | None = None
    bore: Length | None = None
    keyway: Keyway | None = None
    rim: Length | None = None
    groove_depth: Length | None = None

    def __post_init__(self) -> None:
        check_fields(self, "part.")
        if self.groove_depth is not None and self.thickness is not None:
            number("part.groove_depth", self.groove_depth, below=self.thickness, unit="mm")
        if self.keyway is not None and self.bore is None:
            raise GeometryError("a keyway belongs to a bore", key="part.keyway")
