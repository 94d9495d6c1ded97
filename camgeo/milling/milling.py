"""What a scene says on milling: tools, blank, holding, operations; declared, checked and built.

The tables are in milling.json, with lengths and angles as in all tables of a scene.
"""

from __future__ import annotations

import json
import math
from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import partial
from types import MappingProxyType
from typing import TYPE_CHECKING, Annotated, Any, Final

from camgeo.errors import GeometryError
from camgeo.kinematics.mechanism.values import Length, Place, Radius
from camgeo.milling.holding import AXES, NOT, ONION_SKIN, TABS, Clamp, Holding, Tabs, rectangle
from camgeo.milling.tool import (
    CHAMFER_MILL,
    COMPUTED,
    DRILL,
    END_MILL,
    CompensationWord,
    CoolantWord,
    FeedRate,
    Rounds,
    SpindleSpeed,
    Text,
    Tool,
    ToolNumber,
    Truth,
)
from camgeo.numeric.checked import check_fields, hold, instance, instances, number, one_of, whole
from camgeo.record import Brief, schema_beside

if TYPE_CHECKING:
    from camgeo.milling.moves import Heights
    from camgeo.part.boundaries import ExactBoundary


TABLES: Final = ("tool", "stock", "holding", "operation", "second_side")
"""Keys at the top of a scene."""

SECOND_SIDE: Final = "second_side"

FACE: Final = "face"
DRILLING: Final = "drill"
BORE: Final = "bore"
ROUGH: Final = "rough"
FINISH: Final = "finish"
SLOT: Final = "slot"
CHAMFER: Final = "chamfer"
ENGRAVE: Final = "engrave"

OPERATIONS: Final = (FACE, DRILLING, BORE, ROUGH, FINISH, SLOT, CHAMFER, ENGRAVE)

RAMP: Final = "ramp"
TROCHOIDAL: Final = "trochoidal"
SPIRAL: Final = "spiral"

STRATEGIES: Final = (RAMP, TROCHOIDAL, SPIRAL)
"""Of roughing."""

ALONG_A_WALL: Final = (ROUGH, FINISH, CHAMFER)
"""Kinds of operations that name their boundary."""

MAY_NAME_IT: Final = (DRILLING, ENGRAVE)
"""Kinds that have a usual one."""


@dataclass(frozen=True, slots=True, kw_only=True)
class OperationSpec:
    """One `[[operation]]`; None for what is as with the tool.

    Attributes
    ----------
    kind : one of `OPERATIONS`.
    tool : its number.
    boundary : name of the wall that is cut; empty where the kind says it.
    name : in the program; empty for kind and boundary.
    allowance : left on the wall [mm].
    depth : from the upper end of the wall [mm]; None for all of it.
    strategy : of roughing, one of `STRATEGIES`; empty for what suits the blank.
    size : of a chamfer along the face [mm].
    stepdown, stepover : [mm].
    springs : rounds at full depth behind the one that finishes.
    climb : climb milling, not conventional.
    spindle_speed : [rev/min].
    feed, plunge_feed : [mm/min].
    coolant : one of `camgeo.milling.tool.COOLANTS`.
    compensation : of a finish, one of `camgeo.milling.milling.COMPENSATIONS`; None for that of all.
    stop : what the operator does before it; empty for no stop.
    note : for the operator.

    Raises
    ------
    GeometryError
        With the key in `operation`, if a value is invalid.
    """

    kind: Annotated[str, partial(one_of, choices=OPERATIONS)]
    tool: ToolNumber
    boundary: Text = ""
    name: Text = ""
    allowance: Radius = 0.0
    depth: Length | None = None
    strategy: Annotated[str, partial(one_of, choices=("", *STRATEGIES))] = ""
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

    def __post_init__(self) -> None:
        # `tool` is a number here, and no table of its own.
        check_fields(self, "operation.")

    def run(self, tool: Tool) -> Tool:
        """The tool as it is run in this operation; raises GeometryError like `Tool`."""
        keys = ("stepdown", "stepover", "spindle_speed", "feed", "plunge_feed", "coolant")
        own = {key: getattr(self, key) for key in keys if getattr(self, key) is not None}
        return replace(tool, **own)


@dataclass(frozen=True, slots=True, kw_only=True)
class MillingSpec(Brief):
    """All that a scene says on milling, in mm, rad and mm/min.

    Attributes
    ----------
    tools : in the order in which they are tried.
    stock : the blank.
    holding : None if nobody says how the blank is held.
    operations : empty for a sequence that is planned.
    earlier : whether the tool is stated by earlier keys of `[output.gcode]`.
    second : how the second side is set up; None if there is none.
    second_operations : from that side; empty for a sequence that is planned.
    turned : the axis of the machine about which the work has been turned over: then all of this is
        that of the second side.
    done : names of the walls that the first side has finished.

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
    turned: Annotated[str, partial(one_of, choices=(NOT, *AXES))] = NOT
    done: frozenset[str] = frozenset()

    def __post_init__(self) -> None:
        check_fields(self, "")
        tools = instances("tool", instance("tool", self.tools, tuple, "tools"), (Tool,), "tools")
        given = instance("operation", self.operations, tuple, "operations")
        hold(self, tools=tools, operations=instances("operation", given, (OperationSpec,), "them"))
        given = instance("second_side.operation", self.second_operations, tuple, "operations")
        instances("second_side.operation", given, (OperationSpec,), "operations")
        instance("second_side", self.done, frozenset, "names of walls")
        counts = Counter(tool.number for tool in tools)
        if repeated := [number for number, count in counts.items() if count > 1]:
            raise GeometryError("each tool needs its own number", "tool", f"{repeated[0]}")

    @property
    def up(self) -> str:
        """Which face of the part lies up: "upper", or "lower" on the second side."""
        return "lower" if self.turned else "upper"

    def of_second_side(self, *, faced: bool, done: frozenset[str]) -> MillingSpec | None:
        """What is stated on the second side, as if it were all; None if there is none.

        The first side has taken off what was above the part if it has `faced` it, and has finished
        the walls that are `done`.
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
            done=done,
        )


def tables() -> dict[str, dict[str, Any]]:
    """The JSON Schemas of the tables, by their keys."""
    found = schema_beside(__file__)
    second = found[SECOND_SIDE]["properties"]
    for name in OWN_TABLES:
        text = json.dumps(found[name]).replace(f"[{name}", f"[{SECOND_SIDE}.{name}")
        second[name] = {**json.loads(text), "x-as": name, **second[name]}
    return found


def tool_of(table: Mapping[str, Any]) -> Tool:
    """The tool of a converted table `[[tool]]`; raises GeometryError with the key in `tool`."""
    given = _with_counts(table)
    cutting, load = given.pop("cutting_speed", None), given.pop("chip_load", None)
    if cutting is not None:
        # As a controller shows it, and as the feed of each edge is reckoned from.
        given["spindle_speed"] = max(1.0, float(round(cutting / (math.pi * given["diameter"]))))
    if load is not None:
        given["feed"] = load * given["flutes"] * given["spindle_speed"]
    if given.get("kind") == DRILL:
        given["plunge_feed"] = given["feed"]
    return Tool(**given)


def stock_of(table: Mapping[str, Any]) -> Stock:
    """The blank of a converted table `[stock]`; raises GeometryError with the key in `stock`."""
    given = dict(table)
    if "centre" in given:
        given["centre"] = complex(*given["centre"])
    return Stock(**given)


def holding_of(table: Mapping[str, Any]) -> Holding:
    """The holding of a converted table; raises GeometryError with the key in `holding`."""
    given = _with_counts(table)
    clamps = [_clamp(each) for each in given.pop("clamp", ())]
    clamps += [_screw(each) for each in given.pop("screw", ())]
    tabs = None
    if given["kind"] == TABS:
        tabs = Tabs(*(given.pop(key) for key in ("count", "width", "height")))
    return Holding(
        kind=given["kind"],
        through=given.get("through", 0.0),
        tabs=tabs,
        skin=given.get("thickness"),
        clamps=tuple(clamps),
    )


def _clamp(table: Mapping[str, Any]) -> Clamp:
    return Clamp(**{**table, "place": complex(*table["place"])})


def _screw(table: Mapping[str, Any]) -> Clamp:
    given = dict(table)
    width = given.pop("head_diameter")
    return _clamp({**given, "length": width, "width": width, "round": True})


def operation_of(table: Mapping[str, Any]) -> OperationSpec:
    """The operation of a converted table; raises GeometryError with the key in `operation`."""
    given = _with_counts(table)
    climb = given.pop("direction", "climb") == "climb"
    return OperationSpec(**given, climb=climb)


def second_side_of(table: Mapping[str, Any]) -> SecondSide:
    """The setup of a converted table `[second_side]`; raises GeometryError with the key in it."""
    given = {key: value for key, value in table.items() if key not in OWN_TABLES}
    return SecondSide(**given, holding=holding_of(table["holding"]))


NUMBERS: Final[Mapping[str, Callable[[Any], Any]]] = {
    **dict.fromkeys(("number", "flutes", "count", "springs", "tool"), int),
    "spindle_speed": float,
}
"""What keys of converted tables are made: whole numbers, and the speed as it is written."""


def _with_counts(table: Mapping[str, Any]) -> dict[str, Any]:
    """The table, in which whole numbers are such, and the speed as it is written is a number."""
    return {key: NUMBERS[key](value) if key in NUMBERS else value for key, value in table.items()}


# Rules between keys ---------------------------------------------------------------------------


def tool_faults(table: Mapping[str, Any]) -> Iterator[tuple[str, str]]:
    """Keys of one table `[[tool]]` that are missing or too many, each with the reason."""
    kind = table.get("kind", END_MILL)
    for one, other in (("spindle_speed", "cutting_speed"), ("feed", "chip_load")):
        if one in table and other in table:
            yield other, f"contradicts {one}; give one of them"
        elif one not in table and other not in table:
            yield one, f"is missing: give it or {other}; camgeo invents none"
    if "chip_load" in table and "flutes" not in table:
        yield "flutes", "is missing: chip_load needs it"
    if kind != DRILL and "plunge_feed" not in table:
        yield "plunge_feed", "is missing: the feed of ramps, helices and plunges"
    if kind == END_MILL and "stepdown" not in table:
        yield "stepdown", "is missing: the largest depth of a pass into full material"
    if kind == END_MILL and "tip_angle" in table:
        yield "tip_angle", f'belongs to kind "{DRILL}" or "{CHAMFER_MILL}"'
    if kind != END_MILL and "tip_angle" not in table:
        yield "tip_angle", "is missing: the included angle of its point"


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
        yield missing, "is missing: a plate has length and width, or an outline that is not known"


def holding_faults(table: Mapping[str, Any]) -> Iterator[tuple[str, str]]:
    """Keys of `[holding]` that are missing or too many, each with the reason."""
    kind = table["kind"]
    own = {"count": TABS, "width": TABS, "height": TABS, "thickness": ONION_SKIN}
    for key, needed_by in own.items():
        if kind == needed_by and key not in table:
            yield key, f"is missing: {needed_by.replace('-', ' ')} need it"
        elif kind != needed_by and key in table:
            yield key, f'belongs to kind "{needed_by}"'
    if kind == ONION_SKIN and "through" in table:
        yield "through", "belongs to the other kinds: an onion skin is not cut through"
    elif kind != ONION_SKIN and "through" not in table:
        yield "through", "is missing: how far cuts go below the part; 0 ends them at its lower face"
    for key, needed_by in (("clamp", "clamps"), ("screw", "screws")):
        if kind == needed_by and key not in table:
            yield key, f'is missing: kind "{needed_by}" needs it at least once'


def operation_faults(table: Mapping[str, Any]) -> Iterator[tuple[str, str]]:
    """Keys of one `[[operation]]` that are missing or too many, each with the reason."""
    kind = table["kind"]
    if kind in ALONG_A_WALL and "boundary" not in table:
        yield "boundary", f'is missing: which wall is to be cut by "{kind}"'
    if kind not in (*ALONG_A_WALL, *MAY_NAME_IT) and "boundary" in table:
        known = ", ".join((*ALONG_A_WALL, *MAY_NAME_IT))
        yield "boundary", f'belongs to {known}; "{kind}" knows what it cuts'
    if kind != ROUGH and "strategy" in table:
        yield "strategy", f'belongs to kind "{ROUGH}"'
    if kind not in (ROUGH, FINISH, BORE) and "depth" in table:
        yield "depth", f'belongs to kinds "{ROUGH}", "{FINISH}", "{BORE}"'
    if kind == CHAMFER and "size" not in table:
        yield "size", "is missing: how wide the chamfer is"
    if kind != FINISH and "compensation" in table:
        yield "compensation", f'belongs to kind "{FINISH}"'
    if kind != CHAMFER and "size" in table:
        yield "size", f'belongs to kind "{CHAMFER}"'


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
        from camgeo.milling.moves import Heights  # a declaration imports nothing that computes

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
        given = {name: getattr(self, key) for key, name in EARLIER.items()}
        for key in NEEDED:
            if given[EARLIER[key]] is None:
                raise GeometryError(f"is missing: {STATE}", f"output.gcode.{key}")
        return Tool(**{**given, "number": self.tool_number or 1}, plunges=True)


STATE: Final = "nothing about how a tool is run is invented; better state the tool in [[tool]]"
"""What to do where an earlier key is missing."""


# -- side -----------------------------------------------------------------------------------------
# What a scene states on the second side of a milling job; imports nothing that computes.


OWN_KEYS: Final = ("zero", "zero_height", "work_offset", "clearance_height", "retract_height")
"""Keys of `[output.gcode]` that the second side states for itself."""

OWN_TABLES: Final = ("holding", "operation")
"""Tables that it has for itself."""


@dataclass(frozen=True, slots=True, kw_only=True)
class SecondSide:
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

    def __post_init__(self) -> None:
        check_fields(self, "second_side.")

    def program(self, first: GcodeSpec) -> GcodeSpec:
        """What its program is asked for, beside what that of the `first` side is; raises
        GeometryError with the key in `second_side`.
        """
        given = {key: getattr(self, key) for key in OWN_KEYS}
        try:
            return replace(
                first, **{key: value for key, value in given.items() if value is not None}
            )
        except GeometryError as error:
            raise of_second_side(error) from error


def of_second_side(error: GeometryError) -> GeometryError:
    """The same with the key of the second side, if it has one of its own."""
    head, _, rest = error.key.partition(".")
    if head.partition("[")[0] in OWN_TABLES:
        return GeometryError(error.message, f"second_side.{error.key}", error.value)
    _, _, name = rest.partition(".")
    if head == "output" and name in OWN_KEYS:
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
        """What lies there for a second side; `faced` says whether the first one has taken off what
        was above the part.
        """
        return replace(self, top=self.bottom, bottom=0.0 if faced else self.top)

    @property
    def hole(self) -> ExactBoundary:
        """The hole that it has on the cam axis; GeometryError if there is none."""
        if self.bore is None:
            raise GeometryError("the blank has no bore", "stock.bore")
        from camgeo.geometry.contour.contour import Contour
        from camgeo.part.boundaries import ExactBoundary

        circle = Contour.circle(self.bore / 2.0)
        return ExactBoundary("hole in the blank", hole=True, exact=circle)

    @property
    def outline(self) -> ExactBoundary | None:
        """The upright face around it; None if it is not known."""
        from camgeo.geometry.contour.contour import Contour
        from camgeo.part.boundaries import ExactBoundary

        if self.diameter is not None:
            exact = Contour.circle(self.diameter / 2.0, self.centre)
        elif self.length is None or self.width is None:
            return None
        else:
            exact = rectangle(0.5 * complex(self.length, self.width), self.centre)
        return ExactBoundary("stock", hole=False, exact=exact)
