"""What a scene says of the milling program."""

from __future__ import annotations

from dataclasses import dataclass


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
    """

    machine: str = "linuxcnc"
    tool_diameter: float = 6.0
    tool_number: int = 1
    spindle_speed: float = 3000.0
    feed: float = 300.0
    plunge_feed: float = 100.0
    pass_depth: float | None = None
    safe_height: float = 5.0
