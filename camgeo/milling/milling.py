"""What a scene says on milling: tools, blank, holding, operations; declared and checked.

The tables are in milling.json, with lengths and angles as in all tables of a scene.
"""

from __future__ import annotations

import cmath
import json
import math
from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from enum import StrEnum
from functools import partial
from types import MappingProxyType
from typing import TYPE_CHECKING, Annotated, Any, Final

from camgeo.errors import GeometryError
from camgeo.kinematics.mechanism.values import Angle, Length, Place, Radius
from camgeo.numeric.checked import (
    CheckedFields,
    check_fields,
    finite,
    hold,
    instance,
    instances,
    number,
    one_of,
    positive,
    whole,
)
from camgeo.record import Brief, stored_schema

if TYPE_CHECKING:
    from camgeo.numeric.arrays import ComplexArray
    from camgeo.part.boundaries import ExactBoundary
    from camgeo.part.part import Boundary


# -- tool ------------------------------------------------------------------------------------------
# Tools, and how each is run.


LARGEST_NUMBER: Final = 99_999
"""Largest number of a tool in a controller's tool table."""

MOST_FLUTES: Final = 100

MOST_SPRINGS: Final = 10
"""Most spring rounds of an operation; further ones remove nothing."""

END_MILL: Final = "end-mill"
DRILL: Final = "drill"
CHAMFER_MILL: Final = "chamfer-mill"

KINDS: Final = (END_MILL, DRILL, CHAMFER_MILL)

COOLANTS: Final = ("off", "flood", "mist", "through")

COMPUTED: Final = "computed"
WEAR: Final = "wear"
CONTROL: Final = "control"

COMPENSATIONS: Final = (COMPUTED, WEAR, CONTROL)
"""Ways to compensate the cutter's radius: by the computed path; by the computed path, with the
controller adding the wear of the cutter; by the controller alone."""


LONGEST_SPIN_UP_TIME: Final = 600.0
"""Longest time [s] that a spindle may take to reach its speed."""


ToolNumber = Annotated[int, partial(whole, least=1, most=LARGEST_NUMBER)]
FluteCount = Annotated[int, partial(whole, least=1, most=MOST_FLUTES)]
Rounds = Annotated[int, partial(whole, least=0, most=MOST_SPRINGS)]
SpindleSpeed = Annotated[float, partial(positive, unit="rev/min")]
FeedRate = Annotated[float, partial(positive, unit="mm/min")]
ToolKind = Annotated[str, partial(one_of, choices=KINDS)]
CoolantWord = Annotated[str, partial(one_of, choices=COOLANTS)]
CompensationWord = Annotated[str, partial(one_of, choices=COMPENSATIONS)]
Engagement = Annotated[float, partial(number, above=0.0, most=math.pi, unit="rad")]
Steepness = Annotated[float, partial(number, above=0.0, most=0.5 * math.pi, unit="rad")]
Tip = Annotated[float, partial(number, above=0.0, most=math.pi, unit="rad")]
Text = Annotated[str, partial(instance, kind=str, what="a text")]
Truth = Annotated[bool, partial(instance, kind=bool, what="true or false")]


class ToolError(GeometryError):
    """A tool cannot do what an operation asks of it, or lacks a statement that this needs.

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
    """A tool and its cutting data; None for what is not stated.

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
    kind: ToolKind = END_MILL
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
            raise GeometryError(
                f"must be at most half the diameter, {self.radius:g} mm",
                "tool.corner_radius",
                f"{self.corner_radius:g}",
            )
        if self.stepover is not None and self.stepover > self.diameter:
            raise GeometryError(
                f"must be at most the diameter, {self.diameter:g} mm",
                "tool.stepover",
                f"{self.stepover:g}",
            )
        flutes, reach = self.flute_length, self.stick_out
        if flutes is not None and reach is not None and reach < flutes:
            raise GeometryError(
                f"must be at least the flute length, {flutes:g} mm", "tool.stick_out", f"{reach:g}"
            )

    @property
    def radius(self) -> float:
        """Half the diameter [mm]."""
        return self.diameter / 2.0

    @property
    def tip_length(self) -> float:
        """Length of the point or the rounded corners, below the full diameter [mm]; 0 if flat."""
        if self.tip_angle is None:
            return self.corner_radius
        return self.radius / math.tan(0.5 * self.tip_angle)


# -- holding ---------------------------------------------------------------------------------------
# How a blank is held while it is milled.


TABS: Final = "tabs"
SCREWS: Final = "screws"
ONION_SKIN: Final = "onion-skin"
CLAMPS: Final = "clamps"
FIXTURE: Final = "fixture"

HOLDINGS: Final = (TABS, SCREWS, ONION_SKIN, CLAMPS, FIXTURE)

MOST_TABS: Final = 100

TabCount = Annotated[int, partial(whole, least=1, most=MOST_TABS)]


@dataclass(frozen=True, slots=True)
class Tabs(CheckedFields, path="holding."):
    """Bridges that a through-cut leaves between part and waste.

    Attributes
    ----------
    count : evenly spaced along the wall.
    width : of each along the wall [mm].
    height : above the lower face of the part [mm]; in a cut, above its last depth.

    Raises
    ------
    GeometryError
        With the key in `holding`, if a value is invalid.
    """

    count: TabCount
    width: Length
    height: Length


@dataclass(frozen=True, slots=True)
class Obstacle:
    """An upright body that no cutter may touch, up to `top` [mm] above the upper face of the part.

    Attributes
    ----------
    name : for messages.
    outline : around it.
    top : its height; 0 is the upper face of the part.
    """

    name: str
    outline: Boundary
    top: float

    def __post_init__(self) -> None:
        from camgeo.part.part import require_boundary

        instance("holding", self.name, str, "a text")
        require_boundary(self.outline)
        hold(self, top=finite("holding.height", self.top, "mm"))


@dataclass(frozen=True, slots=True, kw_only=True)
class Clamp(CheckedFields, path="clamp."):
    """A clamp on the blank, a rectangle, or a screw, a circle.

    Attributes
    ----------
    place : of its centre, seen from the cam axis [mm].
    length, width : along its own x and y [mm]; of a circle both are its diameter.
    height : of its top above the upper face of the part [mm].
    angle : of its x from that of the cam [rad].
    round : whether it is a circle.
    since : name of the operation before which it is set; empty if it is there from the start.
    until : name of the operation before which it is taken away; empty if it stays.
    called : its place in messages, where that is not its own; None for its own.

    Raises
    ------
    GeometryError
        With the key in `clamp`, if a value is invalid.
    """

    place: Place
    length: Length
    width: Length
    height: Length
    angle: Angle = 0.0
    round: Truth = False
    since: Text = ""
    until: Text = ""
    called: Place | None = None

    def turned_over(self, about: str) -> Clamp:
        """The clamp in the part's coordinates, if it is stated as work turned over about that axis
        lies on the machine.
        """
        place = mirrored(self.place, about)
        return replace(self, place=place, angle=-self.angle, called=self.place)

    @property
    def what(self) -> str:
        """The word for it: "screw" or "clamp"."""
        return "screw" if self.round else "clamp"

    @property
    def obstacle(self) -> Obstacle:
        """The body that cutters must clear."""
        from camgeo.geometry.contour.contour import Contour, rectangle
        from camgeo.part.boundaries import ExactBoundary

        name = (
            f"{self.what} at {_coordinates(self.place if self.called is None else self.called)} mm"
        )
        if self.round:
            contour = Contour.circle(self.length / 2.0, self.place)
        else:
            half = 0.5 * complex(self.length, self.width)
            contour = rectangle(half, self.place, cmath.exp(1j * self.angle))
        return Obstacle(name, ExactBoundary(self.what, hole=False, exact=contour), self.height)


@dataclass(frozen=True, slots=True, kw_only=True)
class Holding:
    """How the blank is held, and what becomes of the part when it is cut out of it.

    Attributes
    ----------
    kind : "tabs"; "screws" through the part, onto what lies below; "onion-skin", a skin below the
        part that is removed later; "clamps" on the part; "fixture", from below: vacuum, tape, soft
        jaws, a longer blank in a chuck.
    through : how far through-cuts go below the lower face of the part [mm].
    tabs : of kind "tabs".
    skin : thickness of an onion skin [mm].
    clamps : and screws, of any kind.

    Raises
    ------
    GeometryError
        With the key in `holding`, if a value is invalid, missing, or belongs to another kind.
    """

    kind: Annotated[str, partial(one_of, choices=HOLDINGS)]
    through: Radius = 0.0
    tabs: Tabs | None = None
    skin: Length | None = None
    clamps: tuple[Clamp, ...] = ()

    def __post_init__(self) -> None:
        check_fields(self, "holding.")
        entries = instance("holding.clamps", self.clamps, tuple, "a tuple of clamps")
        hold(self, clamps=instances("holding.clamps", entries, (Clamp,), "clamps"))
        kinds_by_key = {"tabs": TABS, "skin": ONION_SKIN}
        for key, kind in kinds_by_key.items():
            if (getattr(self, key) is not None) != (self.kind == kind):
                message = "is missing" if self.kind == kind else f'belongs to kind "{kind}"'
                raise GeometryError(message, f"holding.{key}")
        if self.kind in (CLAMPS, SCREWS) and not self.clamps:
            what = self.kind.removesuffix("s")
            raise GeometryError(
                f"needs [[holding.{what}]] at least once", "holding.kind", self.kind
            )

    def turned_over(self, about: str) -> Holding:
        """The holding with its clamps, which are stated as the work lies, in part coordinates."""
        return replace(self, clamps=tuple(clamp.turned_over(about) for clamp in self.clamps))


def _coordinates(place: complex) -> str:
    return f"{place.real:g}, {place.imag:g}"


# -- turning --------------------------------------------------------------------------------------
# Work that is turned over for its second side: how coordinates of part and machine correspond.
#
# Cuts and moves are those of a part whose tools come from above, on both sides. For the second side
# its heights are reflected (`Part.turned_over`), its X and Y are kept, so that all curves stay what
# they are, exactly. On the machine the work has been turned by half a turn about X or Y: what lies
# there is the mirror image of that part: arcs change their sense, left and right change places.


X: Final = "x"
Y: Final = "y"

AXES: Final = (X, Y)
"""Axes of the machine about which work is turned over."""

FIRST_SIDE: Final = ""
"""In place of an axis: the work is not turned over."""

MIRRORED_SIDE: Final[Mapping[str, str]] = MappingProxyType(
    {"left": "right", "right": "left", "off": "off", "": ""}
)
"""Names of the sides of a path when it is mirrored."""


TURNING_NOTE: Final[Mapping[str, str]] = MappingProxyType(
    {
        X: "turned over about X: what was in front is at the back",
        Y: "turned over about Y: what was on the left is on the right",
    }
)
"""How the work is turned over, in words for the operator."""


def mirrored(place: complex, about: str) -> complex:
    """A place or a direction of the part as it lies on the machine, where work is turned over
    `about` an axis. The same function converts back, as a reflection is its own inverse.
    """
    # Adding 0 keeps a negative zero out of print.
    if about == X:
        return complex(place.real, 0.0 - place.imag)
    if about == Y:
        return complex(0.0 - place.real, place.imag)
    return place


def mirrored_all(places: ComplexArray, about: str) -> ComplexArray:
    """Places of the part as they lie on the machine, like `mirrored`."""
    if about == X:
        return places.conjugate()
    return -places.conjugate() if about == Y else places


# -- operations ------------------------------------------------------------------------------------
# What operations do, and all that is stated; imports nothing that computes.


TABLES: Final = ("tool", "stock", "holding", "operation", "second_side")
"""Keys at the top of a scene."""

SECOND_SIDE: Final = "second_side"


class Kind(StrEnum):
    """Kinds of operations."""

    FACE = "face"
    DRILL = "drill"
    BORE = "bore"
    ROUGH = "rough"
    FINISH = "finish"
    SLOT = "slot"
    CHAMFER = "chamfer"
    ENGRAVE = "engrave"


class Roughing(StrEnum):
    """Strategies for roughing a wall."""

    RAMP = "ramp"
    TROCHOIDAL = "trochoidal"
    SPIRAL = "spiral"


ALONG_A_WALL: Final = (Kind.ROUGH, Kind.FINISH, Kind.CHAMFER)
"""Kinds of operations that must name their boundary."""

MAY_NAME_IT: Final = (Kind.DRILL, Kind.ENGRAVE)
"""Kinds of operations that have a usual boundary, and may name another."""


@dataclass(frozen=True, slots=True, kw_only=True)
class OperationSpec(CheckedFields, path="operation."):
    """One `[[operation]]`; None for cutting data that are those of the tool.

    Attributes
    ----------
    kind : one of `Kind`.
    tool : its number.
    boundary : name of the wall that is cut; empty where the kind says it.
    name : in the program; empty for kind and boundary.
    allowance : left on the wall [mm].
    depth : from the upper end of the wall [mm]; None for all of it.
    strategy : of roughing, one of `Roughing`; empty for what suits the blank.
    size : of a chamfer along the face [mm].
    stepdown, stepover : [mm].
    springs : rounds at full depth behind the one that finishes.
    climb : climb milling, not conventional.
    spindle_speed : [rev/min].
    feed, plunge_feed : [mm/min].
    coolant : one of `COOLANTS`.
    compensation : of a finish, one of `COMPENSATIONS`; None for that of all.
    stop : what the operator does before it; empty for no stop.
    note : for the operator.

    Raises
    ------
    GeometryError
        With the key in `operation`, if a value is invalid.
    """

    kind: Annotated[str, partial(one_of, choices=[kind.value for kind in Kind])]
    tool: ToolNumber
    boundary: Text = ""
    name: Text = ""
    allowance: Radius = 0.0
    depth: Length | None = None
    strategy: Annotated[
        str, partial(one_of, choices=["", *(roughing.value for roughing in Roughing)])
    ] = ""
    size: Length | None = None
    stepdown: Length | None = None
    stepover: Length | None = None
    springs: Rounds = 0
    climb: Truth = True
    spindle_speed: SpindleSpeed | None = None
    feed: FeedRate | None = None
    plunge_feed: FeedRate | None = None
    coolant: CoolantWord | None = None
    compensation: CompensationWord | None = None
    stop: Text = ""
    note: Text = ""

    def run(self, tool: Tool) -> Tool:
        """The tool as it is run in this operation; raises GeometryError like `Tool`."""
        keys = ("stepdown", "stepover", "spindle_speed", "feed", "plunge_feed", "coolant")
        overrides = {key: getattr(self, key) for key in keys if getattr(self, key) is not None}
        return replace(tool, **overrides)


@dataclass(frozen=True, slots=True, kw_only=True)
class MillingSpec(Brief):
    """All that a scene says on milling, in mm, rad and mm/min.

    Attributes
    ----------
    tools : in the order in which they are tried.
    stock : the blank.
    holding : None if the scene does not state how the blank is held.
    operations : empty for a sequence that is planned.
    earlier : whether the tool is stated by earlier keys of `[output.gcode]`.
    second : how the second side is set up; None if there is none.
    second_operations : from that side; empty for a sequence that is planned.
    turned : the axis of the machine about which the work has been turned over: then all of this is
        that of the second side.
    finished_walls : names of the walls that the first side has finished.

    Raises
    ------
    GeometryError
        With key "tool", if two tools have the same number.
    """

    tools: tuple[Tool, ...]
    stock: Stock
    holding: Holding | None = None
    operations: tuple[OperationSpec, ...] = ()
    earlier: Truth = False
    second: SecondSide | None = None
    second_operations: tuple[OperationSpec, ...] = ()
    turned: Annotated[str, partial(one_of, choices=(FIRST_SIDE, *AXES))] = FIRST_SIDE
    finished_walls: frozenset[str] = frozenset()

    def __post_init__(self) -> None:
        check_fields(self, "")
        tools = instances("tool", instance("tool", self.tools, tuple, "tools"), (Tool,), "tools")
        entries = instance("operation", self.operations, tuple, "operations")
        hold(
            self, tools=tools, operations=instances("operation", entries, (OperationSpec,), "them")
        )
        entries = instance("second_side.operation", self.second_operations, tuple, "operations")
        instances("second_side.operation", entries, (OperationSpec,), "operations")
        instance("second_side", self.finished_walls, frozenset, "names of walls")
        counts = Counter(tool.number for tool in tools)
        if repeated := [number for number, count in counts.items() if count > 1]:
            raise GeometryError("each tool needs its own number", "tool", f"{repeated[0]}")

    @property
    def top_face(self) -> str:
        """Which face of the part lies up: "upper", or "lower" on the second side."""
        return "lower" if self.turned else "upper"

    def of_second_side(self, *, faced: bool, finished_walls: frozenset[str]) -> MillingSpec | None:
        """The statements on the second side as a specification of its own; None without one.

        `faced` says whether the first side has taken off what was above the part, `finished_walls`
        are the names of the walls that it has finished.
        """
        second = self.second
        if second is None:
            return None
        return replace(
            self,
            stock=self.stock.turned_over(faced=faced),
            holding=second.holding.turned_over(second.turned_about),
            operations=self.second_operations,
            second=None,
            second_operations=(),
            turned=second.turned_about,
            finished_walls=finished_walls,
        )


def tables() -> dict[str, dict[str, Any]]:
    """The JSON Schemas of the tables, by their keys."""
    schemas = stored_schema(__file__)
    second = schemas[SECOND_SIDE]["properties"]
    for name in SECOND_SIDE_TABLES:
        text = json.dumps(schemas[name]).replace(f"[{name}", f"[{SECOND_SIDE}.{name}")
        second[name] = {**json.loads(text), "x-as": name, **second[name]}
    return schemas


# Rules between keys ---------------------------------------------------------------------------


def tool_faults(table: Mapping[str, Any]) -> Iterator[tuple[str, str]]:
    """Keys of one table `[[tool]]` that are missing or too many, each with the reason."""
    kind = table.get("kind", END_MILL)
    for one, other in (("spindle_speed", "cutting_speed"), ("feed", "chip_load")):
        if one in table and other in table:
            yield other, f"contradicts {one}; state only one of them"
        elif one not in table and other not in table:
            yield one, f"is missing: state it or {other}; there is no default"
    for key, needed, reason in (
        ("flutes", "chip_load" in table, "chip_load needs it"),
        ("plunge_feed", kind != DRILL, "the feed of ramps, helices and plunges"),
        ("stepdown", kind == END_MILL, "the largest depth of a pass into full material"),
        ("tip_angle", kind != END_MILL, "the included angle of its point"),
    ):
        if needed and key not in table:
            yield key, f"is missing: {reason}"
    if kind == END_MILL and "tip_angle" in table:
        yield "tip_angle", f'belongs to kind "{DRILL}" or "{CHAMFER_MILL}"'


def stock_faults(table: Mapping[str, Any]) -> Iterator[tuple[str, str]]:
    """Keys of `[stock]` that are missing or too many, each with the reason."""
    shape = table.get("shape", PLATE)
    if shape == ROUND and "diameter" not in table:
        yield "diameter", "is missing: a round blank needs it"
    for key in ("length", "width") if shape == ROUND else ("diameter",):
        if key in table:
            yield key, f'belongs to shape "{PLATE if shape == ROUND else ROUND}"'
    if shape == PLATE and ("length" in table) != ("width" in table):
        missing = "width" if "length" in table else "length"
        yield missing, "is missing: a plate states both length and width, or neither"


def holding_faults(table: Mapping[str, Any]) -> Iterator[tuple[str, str]]:
    """Keys of `[holding]` that are missing or too many, each with the reason."""
    kind = table["kind"]
    kinds_by_key = {"count": TABS, "width": TABS, "height": TABS, "thickness": ONION_SKIN}
    for key, needing in kinds_by_key.items():
        if kind == needing and key not in table:
            yield key, f"is missing: {needing.replace('-', ' ')} need it"
        elif kind != needing and key in table:
            yield key, f'belongs to kind "{needing}"'
    if kind == ONION_SKIN and "through" in table:
        yield "through", "belongs to the other kinds: an onion skin is not cut through"
    elif kind != ONION_SKIN and "through" not in table:
        yield "through", "is missing: how far cuts go below the part; 0 ends them at its lower face"
    for key, needing in (("clamp", "clamps"), ("screw", "screws")):
        if kind == needing and key not in table:
            yield key, f'is missing: kind "{needing}" needs it at least once'


def operation_faults(table: Mapping[str, Any]) -> Iterator[tuple[str, str]]:
    """Keys of one `[[operation]]` that are missing or too many, each with the reason."""
    kind = table["kind"]
    if kind in ALONG_A_WALL and "boundary" not in table:
        yield "boundary", f'is missing: which wall is to be cut by "{kind}"'
    if kind not in (*ALONG_A_WALL, *MAY_NAME_IT) and "boundary" in table:
        known = ", ".join((*ALONG_A_WALL, *MAY_NAME_IT))
        yield "boundary", f'belongs to {known}; "{kind}" knows what it cuts'
    if kind != Kind.ROUGH and "strategy" in table:
        yield "strategy", f'belongs to kind "{Kind.ROUGH}"'
    if kind not in (Kind.ROUGH, Kind.FINISH, Kind.BORE) and "depth" in table:
        yield "depth", f'belongs to kinds "{Kind.ROUGH}", "{Kind.FINISH}", "{Kind.BORE}"'
    if kind == Kind.CHAMFER and "size" not in table:
        yield "size", "is missing: how wide the chamfer is"
    if kind != Kind.FINISH and "compensation" in table:
        yield "compensation", f'belongs to kind "{Kind.FINISH}"'
    if kind != Kind.CHAMFER and "size" in table:
        yield "size", f'belongs to kind "{Kind.CHAMFER}"'


TableFaults = Callable[[Mapping[str, Any]], Iterator[tuple[str, str]]]

FAULTS: Final[Mapping[str, TableFaults]] = {
    "tool": tool_faults,
    "stock": stock_faults,
    "holding": holding_faults,
    "operation": operation_faults,
    f"{SECOND_SIDE}.holding": holding_faults,
    f"{SECOND_SIDE}.operation": operation_faults,
}


# -- spec -----------------------------------------------------------------------------------------
# The specification of the milling program in a scene.


AXIS: Final = "axis"

CORNERS: Final[Mapping[str, tuple[int, int]]] = MappingProxyType(
    {
        "front-left": (-1, -1),
        "front-right": (1, -1),
        "back-left": (-1, 1),
        "back-right": (1, 1),
    }
)
"""Corners of a plate, as seen from where y is least: on which sides in x and y they lie."""

PART_TOP: Final = "part-top"

HEIGHTS: Final = (PART_TOP, "part-bottom", "blank-top", "blank-bottom")
"""Faces on which Z may be 0."""

CLEARANCE: Final = 5.0
"""Z of traverses [mm] unless the scene states another."""

SpinUp = Annotated[float, partial(number, least=0.0, most=LONGEST_SPIN_UP_TIME, unit="s")]
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
"""Those of them that have no default."""


@dataclass(frozen=True, slots=True)
class Heights:
    """Z of traverses [mm].

    Attributes
    ----------
    clearance : between operations, above blank and clamps.
    retract : within an operation, above the blank.

    Raises
    ------
    GeometryError
        With the key in `output.gcode`, if a height is not above 0, or the retract height above the
        clearance.
    """

    clearance: float
    retract: float

    def __post_init__(self) -> None:
        clearance = positive("output.gcode.clearance_height", self.clearance, "mm")
        key = "output.gcode.retract_height"
        retract = number(key, self.retract, above=0.0, most=clearance, unit="mm")
        hold(self, clearance=clearance, retract=retract)


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
        """The heights of traverses [mm]."""
        clearance = self.clearance_height
        return Heights(clearance, self.retract_height or clearance)

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
        values = {name: getattr(self, key) for key, name in EARLIER.items()}
        for key in NEEDED:
            if values[EARLIER[key]] is None:
                raise GeometryError(f"is missing: {STATE}", f"output.gcode.{key}")
        return Tool(**{**values, "number": self.tool_number or 1}, plunges=True)


STATE: Final = "how a tool is run has no default; preferably state the tool in [[tool]]"
"""What to do where an earlier key is missing; ends a message."""


# -- side -----------------------------------------------------------------------------------------
# What a scene states on the second side of a milling job; imports nothing that computes.


SECOND_SIDE_KEYS: Final = (
    "zero",
    "zero_height",
    "work_offset",
    "clearance_height",
    "retract_height",
)
"""Keys of `[output.gcode]` that the second side states for itself."""

SECOND_SIDE_TABLES: Final = ("holding", "operation")
"""Tables that the second side states for itself."""


@dataclass(frozen=True, slots=True, kw_only=True)
class SecondSide(CheckedFields, path="second_side."):
    """How `[second_side]` is set up, in mm: as the work lies when it has been turned over.

    Attributes
    ----------
    turned_about : axis of the machine about which it is turned over.
    holding : then.
    zero, zero_height, work_offset : of its program.
    clearance_height, retract_height : of traverses, above the face of the part that lies up; None
        for those of the first side.

    Raises
    ------
    GeometryError
        With the key in `second_side`, if a value is invalid.
    """

    turned_about: Annotated[str, partial(one_of, choices=AXES)]
    holding: Holding
    zero: Annotated[str, partial(one_of, choices=(AXIS, *CORNERS))] = AXIS
    zero_height: Annotated[str, partial(one_of, choices=HEIGHTS)] = PART_TOP
    work_offset: Text = ""
    clearance_height: Length | None = None
    retract_height: Length | None = None

    def program(self, first: GcodeSpec) -> GcodeSpec:
        """The options of its program: those of the `first` side, with what the second one states
        itself; raises GeometryError with the key in `second_side`.
        """
        stated = {key: getattr(self, key) for key in SECOND_SIDE_KEYS}
        try:
            return replace(
                first, **{key: value for key, value in stated.items() if value is not None}
            )
        except GeometryError as error:
            raise of_second_side(error) from error


def of_second_side(error: GeometryError) -> GeometryError:
    """The error with the key of the second side, if that states the key for itself."""
    head, _, rest = error.key.partition(".")
    if head.partition("[")[0] in SECOND_SIDE_TABLES:
        return GeometryError(error.message, f"second_side.{error.key}", error.value)
    _, _, name = rest.partition(".")
    if head == "output" and name in SECOND_SIDE_KEYS:
        return GeometryError(error.message, f"second_side.{name}", error.value)
    return error


# -- stock ----------------------------------------------------------------------------------------
# The blank from which a part is milled; imports nothing that computes.


ROUND: Final = "round"
PLATE: Final = "plate"

SHAPES: Final = (ROUND, PLATE)


@dataclass(frozen=True, slots=True, kw_only=True)
class Stock:
    """The blank, upright walls between two flat faces.

    Attributes
    ----------
    shape : "round" or "plate".
    diameter : of a round blank [mm].
    length, width : of a plate along x and y [mm]; both None if its outline is not known.
    centre : of the outline, seen from the cam axis [mm].
    bore : diameter of the hole that it has on the cam axis already [mm]; None without one.
    top : of its upper face above that of the part [mm].
    bottom : of its lower face below that of the part [mm].

    Raises
    ------
    GeometryError
        With the key in `stock`, if a value is invalid, missing, or belongs to the other shape.
    """

    shape: Annotated[str, partial(one_of, choices=SHAPES)] = PLATE
    diameter: Length | None = None
    length: Length | None = None
    width: Length | None = None
    centre: Place = 0j
    bore: Length | None = None
    top: Radius = 0.0
    bottom: Radius = 0.0

    def __post_init__(self) -> None:
        check_fields(self, "stock.")
        if self.shape == ROUND and self.diameter is None:
            raise GeometryError("a round blank needs its diameter", "stock.diameter")
        if (self.length is None) != (self.width is None):
            key = "stock.length" if self.length is None else "stock.width"
            raise GeometryError("a plate needs its length and its width, or neither", key)
        other = ("length", "width") if self.shape == ROUND else ("diameter",)
        for key in other:
            if getattr(self, key) is not None:
                shape = PLATE if self.shape == ROUND else ROUND
                raise GeometryError(f'belongs to shape "{shape}"', f"stock.{key}")

    def turned_over(self, *, faced: bool) -> Stock:
        """The blank as it lies for the second side; `faced` says whether the first side has taken
        off what was above the part.
        """
        return replace(self, top=self.bottom, bottom=0.0 if faced else self.top)

    @property
    def hole(self) -> ExactBoundary:
        """The hole of the blank about the cam axis; GeometryError if it has none."""
        if self.bore is None:
            raise GeometryError("the blank has no bore", "stock.bore")
        from camgeo.geometry.contour.contour import Contour
        from camgeo.part.boundaries import ExactBoundary

        return ExactBoundary("hole in the blank", hole=True, exact=Contour.circle(self.bore / 2.0))

    @property
    def outline(self) -> ExactBoundary | None:
        """The outline of the blank; None if it is not known."""
        from camgeo.geometry.contour.contour import Contour, rectangle
        from camgeo.part.boundaries import ExactBoundary

        if self.diameter is not None:
            exact = Contour.circle(self.diameter / 2.0, self.centre)
        elif self.length is None or self.width is None:
            return None
        else:
            exact = rectangle(0.5 * complex(self.length, self.width), self.centre)
        return ExactBoundary("stock", hole=False, exact=exact)
