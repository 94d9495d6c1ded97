"""What a scene says of the milling program."""

from __future__ import annotations

from dataclasses import dataclass

from camgeo.numeric.checked import hold, instance, positive
from camgeo.toolpath.tool import Tool


@dataclass(frozen=True, slots=True)
class GcodeSpec:
    """`[output.gcode]`, lengths in mm, feeds in mm/min.

    Attributes
    ----------
    machine : name of a machine profile, or the path of a profile file (TOML).
    tool_diameter, tool_number : of the end mill.
    spindle_speed : rev/min.
    feed, plunge_feed : in the plane and along Z.
    pass_depth : largest depth of one pass; None cuts in one.
    safe_height : Z of traverses above the upper face.

    Raises
    ------
    GeometryError
        With the key, if a value is not what it has to be.
    """

    machine: str = "linuxcnc"
    tool_diameter: float = 6.0
    tool_number: int = 1
    spindle_speed: float = 3000.0
    feed: float = 300.0
    plunge_feed: float = 100.0
    pass_depth: float | None = None
    safe_height: float = 5.0

    def __post_init__(self) -> None:
        key = "output.gcode"
        instance(f"{key}.machine", self.machine, str, "the name or the file of a machine profile")
        tool = self.tool
        hold(
            self,
            tool_diameter=tool.diameter,
            tool_number=tool.number,
            spindle_speed=tool.spindle_speed,
            feed=tool.feed,
            plunge_feed=tool.plunge_feed,
            safe_height=positive(f"{key}.safe_height", self.safe_height, "mm"),
        )
        if self.pass_depth is not None:
            hold(self, pass_depth=positive(f"{key}.pass_depth", self.pass_depth, "mm"))

    @property
    def tool(self) -> Tool:
        """The end mill, and how it is run."""
        return Tool(
            self.tool_number, self.tool_diameter, self.spindle_speed, self.feed, self.plunge_feed
        )
