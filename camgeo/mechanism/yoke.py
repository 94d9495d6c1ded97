"""The yoke of a cam of constant breadth: a follower with a second side beyond the cam axis."""

from __future__ import annotations

from dataclasses import dataclass

from camgeo.mechanism.values import length
from camgeo.numeric.checked import hold


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

    breadth: float | None = None

    def __post_init__(self) -> None:
        if self.breadth is not None:
            hold(self, breadth=length("follower.yoke.breadth", self.breadth))
