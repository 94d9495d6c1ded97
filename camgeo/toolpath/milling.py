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
from typing import Annotated, Any, Final

from camgeo.declared import schema_beside
from camgeo.displayed import Brief
from camgeo.errors import GeometryError
from camgeo.mechanism.values import Length, Radius
from camgeo.numeric.checked import check_fields, hold, instance, instances, one_of
from camgeo.toolpath.holding import ONION_SKIN, TABS, Clamp, Holding, Tabs
from camgeo.toolpath.side import OWN_TABLES, SecondSide
from camgeo.toolpath.stock import PLATE, ROUND, Stock
from camgeo.toolpath.tool import (
    CHAMFER_MILL,
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
from camgeo.toolpath.turning import AXES, NOT

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
    coolant : one of `camgeo.toolpath.tool.COOLANTS`.
    compensation : of a finish, one of `camgeo.toolpath.spec.COMPENSATIONS`; None for that of all.
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
        if repeated := [number for number, count in numbers_of(tools).items() if count > 1]:
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


def numbers_of(tools: tuple[Tool, ...]) -> Counter[int]:
    """How often each number stands for a tool."""
    return Counter(tool.number for tool in tools)


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


def _with_counts(table: Mapping[str, Any]) -> dict[str, Any]:
    """The table, in which whole numbers are such, and the speed as it is written is a number."""
    made = {**dict.fromkeys(("number", "flutes", "count", "springs", "tool"), int)}
    makers: dict[str, Callable[[Any], Any]] = {**made, "spindle_speed": float}
    return {key: makers.get(key, _as_it_is)(value) for key, value in table.items()}


def _as_it_is(value: Any) -> Any:
    return value


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
