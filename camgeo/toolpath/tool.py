"""A tool, and how it is run."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Tool:
    """An end mill.

    Attributes
    ----------
    number : in the tool table.
    diameter : [mm].
    spindle_speed : [rev/min], clockwise.
    feed, plunge_feed : in the plane and along Z [mm/min].
    """

    number: int
    diameter: float
    spindle_speed: float
    feed: float
    plunge_feed: float

    @property
    def radius(self) -> float:
        """Half the diameter [mm]."""
        return self.diameter / 2.0
