"""Tools, and how each is run."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import partial
from typing import Annotated, Final

from camgeo.errors import GeometryError
from camgeo.kinematics.mechanism.values import Length, Radius
from camgeo.numeric.checked import check_fields, instance, number, one_of, positive, whole

LARGEST_NUMBER: Final = 99_999
"""Of a tool in a controller's tool table."""

MOST_FLUTES: Final = 100

MOST_SPRINGS: Final = 10
"""Rounds that take nothing off any more."""

END_MILL: Final = "end-mill"
DRILL: Final = "drill"
CHAMFER_MILL: Final = "chamfer-mill"

KINDS: Final = (END_MILL, DRILL, CHAMFER_MILL)

COOLANTS: Final = ("off", "flood", "mist", "through")

COMPUTED: Final = "computed"
WEAR: Final = "wear"
CONTROL: Final = "control"

COMPENSATIONS: Final = (COMPUTED, WEAR, CONTROL)
"""Of the cutter's radius: by the computed path; by that, with the controller adding the wear; by
the controller."""

ToolNumber = Annotated[int, partial(whole, least=1, most=LARGEST_NUMBER)]
FluteCount = Annotated[int, partial(whole, least=1, most=MOST_FLUTES)]
Rounds = Annotated[int, partial(whole, least=0, most=MOST_SPRINGS)]
SpindleSpeed = Annotated[float, partial(positive, unit="rev/min")]
FeedRate = Annotated[float, partial(positive, unit="mm/min")]
Kind = Annotated[str, partial(one_of, choices=KINDS)]
CoolantWord = Annotated[str, partial(one_of, choices=COOLANTS)]
CompensationWord = Annotated[str, partial(one_of, choices=COMPENSATIONS)]
Engagement = Annotated[float, partial(number, above=0.0, most=math.pi, unit="rad")]
Steepness = Annotated[float, partial(number, above=0.0, most=0.5 * math.pi, unit="rad")]
Tip = Annotated[float, partial(number, above=0.0, most=math.pi, unit="rad")]
Text = Annotated[str, partial(instance, kind=str, what="a text")]
Truth = Annotated[bool, partial(instance, kind=bool, what="true or false")]


class ToolError(GeometryError):
    """A tool cannot do what is asked of it, or lacks what that takes.

    Attributes
    ----------
    number : of the tool.
    field : its attribute that is at fault, or empty for the tool as a whole.
    """

    def __init__(self, message: str, tool: Tool, field: str = "") -> None:
        super().__init__(message, f"tool.{field}" if field else "tool")
        self.number = tool.number
        self.field = field


@dataclass(frozen=True, slots=True, kw_only=True)
class Tool:
    """A tool, and how it is run; None for what nobody has stated.

    Attributes
    ----------
    number : in the tool table.
    diameter : [mm].
    spindle_speed : [rev/min], clockwise.
    feed : in the plane at the contact of cutter and wall, of a drill along Z [mm/min].
    plunge_feed : of ramps, helices and plunges into material [mm/min].
    name : for the operator; may be empty.
    kind : one of `KINDS`.
    corner_radius : of an end mill [mm], at most half the diameter.
    tip_angle : included angle of the point of a drill or a chamfer mill [rad].
    flutes : number of cutting edges.
    flute_length : of the cutting edges, from the tip [mm].
    stick_out : from the tip to the holder [mm], at least the flute length.
    shank_diameter : above the cutting edges [mm].
    stepdown : largest depth of a pass that does not follow a roughed wall [mm].
    stepover : largest distance of neighbouring paths that clear an area [mm].
    engagement : largest angle over which the cutter is in contact outside slots and entries [rad].
    plunges : whether it may enter material straight along Z.
    ramp_angle : steepest entry into material [rad].
    coolant : one of `COOLANTS`.

    Raises
    ------
    GeometryError
        With the key in `tool`, if a value is invalid.
    """

    number: ToolNumber
    diameter: Length
    spindle_speed: SpindleSpeed
    feed: FeedRate
    plunge_feed: FeedRate
    name: Text = ""
    kind: Kind = END_MILL
    corner_radius: Radius = 0.0
    tip_angle: Tip | None = None
    flutes: FluteCount | None = None
    flute_length: Length | None = None
    stick_out: Length | None = None
    shank_diameter: Length | None = None
    stepdown: Length | None = None
    stepover: Length | None = None
    engagement: Engagement | None = None
    plunges: Truth = False
    ramp_angle: Steepness | None = None
    coolant: CoolantWord | None = None

    def __post_init__(self) -> None:
        check_fields(self, "tool.")
        if self.corner_radius > self.radius:
            message = f"must be at most half the diameter, {self.radius:g} mm"
            raise GeometryError(message, "tool.corner_radius", f"{self.corner_radius:g}")
        if self.stepover is not None and self.stepover > self.diameter:
            message = f"must be at most the diameter, {self.diameter:g} mm"
            raise GeometryError(message, "tool.stepover", f"{self.stepover:g}")
        flutes, out = self.flute_length, self.stick_out
        if flutes is not None and out is not None and out < flutes:
            message = f"must be at least the flute length, {flutes:g} mm"
            raise GeometryError(message, "tool.stick_out", f"{out:g}")

    @property
    def radius(self) -> float:
        """Half the diameter [mm]."""
        return self.diameter / 2.0

    @property
    def tip_length(self) -> float:
        """Length of the point, which does not cut at the full diameter [mm]; 0 of a flat one."""
        if self.tip_angle is None:
            return self.corner_radius
        return self.radius / math.tan(0.5 * self.tip_angle)
