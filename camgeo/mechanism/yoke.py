"""The yoke of a cam of constant breadth: a follower with a second side beyond the cam axis."""

from __future__ import annotations

from dataclasses import dataclass

from camgeo.mechanism.values import Length
from camgeo.numeric.checked import check_fields


@dataclass(frozen=True, slots=True)
class Yoke:
    """What a scene says of a yoke.

    Attributes
    ----------
    breadth : distance of its two faces, or of its two roller centres [mm]; None for the one with
        the least closing error.

    Raises
    ------
    GeometryError
        With key "follower.yoke.breadth", if that is no length above 0.
    """

    breadth: Length | None = None

    def __post_init__(self) -> None:
        check_fields(self, "follower.yoke.")
