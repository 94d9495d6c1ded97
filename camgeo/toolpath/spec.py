"""The specification of the milling program in a scene."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import partial
from types import MappingProxyType
from typing import TYPE_CHECKING, Annotated, Final

from camgeo.errors import GeometryError
from camgeo.mechanism.values import Length
from camgeo.numeric.checked import check_fields, instance, number, one_of, whole
from camgeo.toolpath.tool import (
    COMPUTED,
    CompensationWord,
    CoolantWord,
    FeedRate,
    SpindleSpeed,
    Text,
    Tool,
    ToolNumber,
)

if TYPE_CHECKING:
    from camgeo.toolpath.moves import Heights

LONGEST_SPIN_UP: Final = 600.0
"""Seconds that a spindle may take."""

AXIS: Final = "axis"

CORNERS: Final[Mapping[str, tuple[int, int]]] = MappingProxyType(
    {
        "front-left": (-1, -1),
        "front-right": (1, -1),
        "back-left": (-1, 1),
        "back-right": (1, 1),
    }
)
"""Corners of a plate, seen by who stands where y is least: on which sides in x and y they lie."""

PART_TOP: Final = "part-top"

HEIGHTS: Final = (PART_TOP, "part-bottom", "blank-top", "blank-bottom")
"""Faces on which Z may be 0."""

CLEARANCE: Final = 5.0
"""Z of traverses [mm] unless a scene states it."""

SpinUp = Annotated[float, partial(number, least=0.0, most=LONGEST_SPIN_UP, unit="s")]
ProgramNumber = Annotated[int, partial(whole, least=1, most=9999)]

Profile = Annotated[
    str, partial(instance, kind=str, what="the name or the file of a machine profile")
]

EARLIER: Final = {
    "tool_diameter": "diameter",
    "tool_number": "number",
    "spindle_speed": "spindle_speed",
    "feed": "feed",
    "plunge_feed": "plunge_feed",
    "pass_depth": "stepdown",
}
"""Earlier keys that state the one tool of a program, with those of `[[tool]]`."""

NEEDED: Final = ("spindle_speed", "feed", "plunge_feed", "pass_depth")
"""Those of them that nobody may invent."""


@dataclass(frozen=True, slots=True)
class GcodeSpec:
    """`[output.gcode]`, lengths in mm, feeds in mm/min.

    Attributes
    ----------
    machine : name of a machine profile, or the path of a profile file (TOML).
    tools : name of the file with tools that the scene names; empty for none.
    clearance_height : Z of traverses between operations, above the upper face.
    retract_height : Z of traverses within an operation; None for the clearance height.
    tool_change_height : Z at which tools are changed, the operator works and programs end, where
        the machine's retract is a height; None for the clearance height.
    coolant : "off" or another kind that the machine has, for tools that do not state theirs.
    compensation : one of `COMPENSATIONS`, of finishes that do not state theirs.
    zero : where X and Y are 0: "axis" of the cam or one of `CORNERS`.
    zero_height : where Z is 0: one of `HEIGHTS`.
    work_offset : its name in the machine's profile; empty for the first there.
    spin_up : dwell behind the start of the spindle [s]; None for the machine's own.
    program_number : on controllers that number programs.
    tool_diameter, tool_number, spindle_speed, feed, plunge_feed, pass_depth : of the one tool of
        earlier scenes; None, or 1 for its number, where it is not stated.

    Raises
    ------
    GeometryError
        With the key, if a value is invalid, or an earlier key lacks another one.
    """

    machine: Profile = "linuxcnc"
    tools: Text = ""
    clearance_height: Length = CLEARANCE
    retract_height: Length | None = None
    tool_change_height: Length | None = None
    coolant: CoolantWord = "off"
    compensation: CompensationWord = COMPUTED
    zero: Annotated[str, partial(one_of, choices=(AXIS, *CORNERS))] = AXIS
    zero_height: Annotated[str, partial(one_of, choices=HEIGHTS)] = PART_TOP
    work_offset: Text = ""
    spin_up: SpinUp | None = None
    program_number: ProgramNumber = 1
    tool_diameter: Length | None = None
    tool_number: ToolNumber | None = None
    spindle_speed: SpindleSpeed | None = None
    feed: FeedRate | None = None
    plunge_feed: FeedRate | None = None
    pass_depth: Length | None = None

    def __post_init__(self) -> None:
        check_fields(self, "output.gcode.")
        if self.retract_height is not None:
            key = "output.gcode.retract_height"
            number(key, self.retract_height, most=self.clearance_height, unit="mm")
        if self.tool_change_height is not None:
            key = "output.gcode.tool_change_height"
            number(key, self.tool_change_height, least=self.clearance_height, unit="mm")

    @property
    def heights(self) -> Heights:
        """Of traverses."""
        from camgeo.toolpath.moves import Heights  # a declaration imports nothing that computes

        clearance = self.clearance_height
        return Heights(clearance, self.retract_height or clearance)

    @property
    def safe_height(self) -> float:
        """Z of traverses between operations [mm]."""
        return self.clearance_height

    @property
    def tool(self) -> Tool | None:
        """The tool of the earlier keys; None if they state none.

        It plunges, as programs with these keys always did.

        Raises
        ------
        GeometryError
            With the key that is missing.
        """
        if self.tool_diameter is None:
            return None
        given = {name: getattr(self, key) for key, name in EARLIER.items()}
        for key in NEEDED:
            if given[EARLIER[key]] is None:
                raise GeometryError(f"is missing: {STATE}", f"output.gcode.{key}")
        return Tool(**{**given, "number": self.tool_number or 1}, plunges=True)


STATE: Final = "nothing about how a tool is run is invented; better state the tool in [[tool]]"
"""What to do where an earlier key is missing."""
