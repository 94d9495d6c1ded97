"""The specification of the milling program and its tool in a scene."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from typing import Annotated, Final

from camgeo.mechanism.values import Length
from camgeo.numeric.checked import check_fields, instance, number, positive, whole

LARGEST_NUMBER: Final = 99_999
"""Of a tool in a controller's tool table."""

LONGEST_SPIN_UP: Final = 600.0
"""Seconds that a spindle may take."""

ToolNumber = Annotated[int, partial(whole, least=1, most=LARGEST_NUMBER)]
SpindleSpeed = Annotated[float, partial(positive, unit="rev/min")]
FeedRate = Annotated[float, partial(positive, unit="mm/min")]

SpinUp = Annotated[float, partial(number, least=0.0, most=LONGEST_SPIN_UP, unit="s")]
Name = Annotated[str, partial(instance, kind=str, what="a text")]
ProgramNumber = Annotated[int, partial(whole, least=1, most=9999)]

Profile = Annotated[
    str, partial(instance, kind=str, what="the name or the file of a machine profile")
]


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


@dataclass(frozen=True, slots=True)
class GcodeSpec:
    """`[output.gcode]`, lengths in mm, feeds in mm/min.

    Attributes
    ----------
    machine : name of a machine profile, or the path of a profile file (TOML).
    tool_diameter, tool_number : of the end mill.
    spindle_speed : rev/min.
    feed, plunge_feed : in the plane and along Z.
    pass_depth : largest depth of one pass; None for a single pass.
    safe_height : Z of traverses above the upper face.
    coolant : "off" or another kind that the machine has.
    work_offset : its name in the machine's profile; empty for the first there.
    spin_up : dwell behind the start of the spindle [s]; None for the machine's own.
    program_number : on controllers that number programs.

    Raises
    ------
    GeometryError
        With the key, if a value is invalid.
    """

    machine: Profile = "linuxcnc"
    tool_diameter: Length = 6.0
    tool_number: ToolNumber = 1
    spindle_speed: SpindleSpeed = 3000.0
    feed: FeedRate = 300.0
    plunge_feed: FeedRate = 100.0
    pass_depth: Length | None = None
    safe_height: Length = 5.0
    coolant: Name = "off"
    work_offset: Name = ""
    spin_up: SpinUp | None = None
    program_number: ProgramNumber = 1

    def __post_init__(self) -> None:
        check_fields(self, "output.gcode.")

    @property
    def tool(self) -> Tool:
        """The end mill, and how it is run."""
        return Tool(
            self.tool_number, self.tool_diameter, self.spindle_speed, self.feed, self.plunge_feed
        )
