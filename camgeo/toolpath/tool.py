"""A tool, and how it is run."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from typing import Annotated, Final

from camgeo.mechanism.values import Length
from camgeo.numeric.checked import check_fields, positive, whole

LARGEST_NUMBER: Final = 99_999
"""Of a tool in the tables of controllers."""

ToolNumber = Annotated[int, partial(whole, least=1, most=LARGEST_NUMBER)]
SpindleSpeed = Annotated[float, partial(positive, unit="rev/min")]
FeedRate = Annotated[float, partial(positive, unit="mm/min")]


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

    number: Annotated[ToolNumber, "tool_number"]
    diameter: Annotated[Length, "tool_diameter"]
    spindle_speed: SpindleSpeed
    feed: FeedRate
    plunge_feed: FeedRate

    def __post_init__(self) -> None:
        check_fields(self, "output.gcode.")

    @property
    def radius(self) -> float:
        """Half the diameter [mm]."""
        return self.diameter / 2.0
