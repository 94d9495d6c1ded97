"""The yoke of a cam of constant breadth: a follower with a second side beyond the cam axis."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Yoke:
    """What a scene says of a yoke.

    Attributes
    ----------
    breadth : distance of its two faces, or of its two roller centres [mm]; None for the one with
        the least closing error.
    """

    breadth: float | None = None
