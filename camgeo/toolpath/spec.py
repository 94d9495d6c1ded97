"""The specification of the milling program in a scene."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from typing import Annotated, Final

from camgeo.mechanism.values import Length
from camgeo.numeric.checked import check_fields, instance, number, whole
from camgeo.toolpath.tool import FeedRate, SpindleSpeed, Tool, ToolNumber

LONGEST_SPIN_UP: Final = 600.0
"""Seconds that a spindle may take."""

SpinUp = Annotated[float, partial(number, least=0.0, most=LONGEST_SPIN_UP, unit="s")]
Name = Annotated[str, partial(instance, kind=str, what="a text")]
ProgramNumber = Annotated[int, partial(whole, least=1, most=9999)]

Profile = Annotated[
    str, partial(instance, kind=str, what="the name or the file of a machine profile")
]


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
            number=self.tool_number,
            diameter=self.tool_diameter,
            spindle_speed=self.spindle_speed,
            feed=self.feed,
            plunge_feed=self.plunge_feed,
            stepdown=self.pass_depth,
            plunges=True,
        )
