"""What a scene says of the part."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Keyway:
    """Keyway of the bore, a slot with parallel sides.

    Attributes
    ----------
    width : width of the slot [mm].
    depth : from the bore's edge to the bottom, measured on the middle line [mm] (t2 of DIN 6885).
    angle : direction of the middle line from the x axis at cam angle 0 [rad], counter-clockwise.
    """

    width: float
    depth: float
    angle: float = 0.0


@dataclass(frozen=True, slots=True)
class PartSpec:
    """What a scene says of the part; every length in mm, None where the scene is silent.

    Attributes
    ----------
    thickness : of the disc.
    bore : diameter of the bore.
    keyway : of the bore.
    rim : diameter of the blank, the outer boundary of a groove cam or of a cam whose roller runs
        inside ("outer" contact).
    groove_depth : of a groove cam, less than the thickness; the groove is open to the upper face.
    """

    thickness: float | None = None
    bore: float | None = None
    keyway: Keyway | None = None
    rim: float | None = None
    groove_depth: float | None = None
