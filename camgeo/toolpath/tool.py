"""A tool, and how it is run."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

from camgeo.numeric.checked import hold, positive, whole

LARGEST_NUMBER: Final = 99_999
"""Of a tool in the tables of controllers."""


@dataclass(frozen=True, slots=True)
class Tool:
    """An end mill.

    Attributes
    ----------
    number : in the tool table.
    diameter : [mm].
    spindle_speed : [rev/min], clockwise.
    feed, plunge_feed : in the plane and along Z [mm/min].

    Raises
    ------
    GeometryError
        With the key of the scene, if a value is not above 0.
    """

    number: int
    diameter: float
    spindle_speed: float
    feed: float
    plunge_feed: float

    def __post_init__(self) -> None:
        key = "output.gcode"
        hold(
            self,
            number=whole(f"{key}.tool_number", self.number, 1, LARGEST_NUMBER),
            diameter=positive(f"{key}.tool_diameter", self.diameter, "mm"),
            spindle_speed=positive(f"{key}.spindle_speed", self.spindle_speed, "rev/min"),
            feed=positive(f"{key}.feed", self.feed, "mm/min"),
            plunge_feed=positive(f"{key}.plunge_feed", self.plunge_feed, "mm/min"),
        )

    @property
    def radius(self) -> float:
        """Half the diameter [mm]."""
        return self.diameter / 2.0
