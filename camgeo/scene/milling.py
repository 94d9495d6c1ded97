"""The tables of a scene on milling: their rules, and what is built from them."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from functools import cache, partial
from typing import Any, Final, TypeVar

from camgeo.errors import Fault, GeometryError, SceneError
from camgeo.milling.milling import (
    DRILL,
    EARLIER,
    END_MILL,
    FAULTS,
    SECOND_SIDE,
    SECOND_SIDE_TABLES,
    TABS,
    Clamp,
    GcodeSpec,
    Holding,
    MillingSpec,
    OperationSpec,
    SecondSide,
    Stock,
    Tabs,
    Tool,
    ToolError,
)
from camgeo.numeric.checked import instance_from_table
from camgeo.scene.formats.gcode import misfits, tables_are_whole
from camgeo.scene.keys import KeyPath, parse_path
from camgeo.scene.schema import MILLING, Composed, milling_tables, schema
from camgeo.scene.values import Broken, SceneConverter, ValidValues, check_schema, document

PROGRAM: Final = ("output", "gcode")
"""Key of the table with the options of the program."""

FORMATS: Final = ("output", "formats")
"""Key of the formats, to each of which belongs what a scene lacks for it."""

LIBRARY: Final = (*PROGRAM, "tools")
"""Key of the file with further tools."""

OPERATIONS: Final = ("operation", f"{SECOND_SIDE}.operation")
"""Tables with operations, which name their tools."""

Built = TypeVar("Built")


def broken_tables(values: ValidValues, *, whole: bool = False) -> Iterator[Broken]:
    """Contradictions between keys of the tables on milling, each with its place.

    Missing keys are faults only of tables that must be `whole`: in a scene they are needed by a
    program alone, see `camgeo.scene.formats.gcode`.
    """
    for name, faults in FAULTS.items():
        for place in _places(values, name):
            table = values.get(*place)
            for key, message in faults(table) if table is not None else ():
                if key in table or (whole and values.lacks(*place, key)):
                    yield (*place, key), message
    yield from _tools_are_distinct(values)
    yield from _machine_compensates(values)
    yield from _one_tool_fits(values)


def _one_tool_fits(values: ValidValues) -> Iterator[Broken]:
    """A single end mill, with which all is planned, must fit into groove and bore."""
    places = _places(values, "tool")
    if len(places) != 1 or values.has("operation") or values.has(*LIBRARY):
        return
    key = (*places[0], "diameter")
    written = values.exact(*key)
    if written is not None and values.get(*places[0], "kind") in (None, END_MILL):
        yield from ((key, message) for message in misfits(values, written))


def _machine_compensates(values: ValidValues) -> Iterator[Broken]:
    """The machine must have the compensation that operations ask for, and the work offset of the
    second side; for a profile that is a file the writer checks it.
    """
    requests: set[KeyPath] = {
        (*place, "compensation") for name in OPERATIONS for place in _places(values, name)
    }
    requests.add((SECOND_SIDE, "work_offset"))
    stated = [(key, f"{key[-1]}") for key in sorted(requests, key=str) if values.get(*key)]
    machine = values.get("output", "gcode", "machine") or GcodeSpec().machine
    if not stated or machine.endswith(".toml"):
        return
    from camgeo.milling.machine import load  # only scenes that ask for it need the profile

    profile = load(machine)
    allowed = {
        "compensation": profile.compensations,
        "work_offset": tuple(profile.work_offsets),
    }
    for key, name in stated:
        if values.get(*key) not in allowed[name]:
            choices = ", ".join(f'"{choice}"' for choice in allowed[name])
            yield key, f"must be one of {choices} for {profile.name}"


def _places(values: ValidValues, name: str) -> list[KeyPath]:
    """Paths of the tables of that name; a point in it leads to a table within another one."""
    path = tuple(name.split("."))
    tables = values.raw(*path)
    if isinstance(tables, list):
        return [(*path, k) for k in range(len(tables))]
    return [] if tables is None else [path]


def _tools_are_distinct(values: ValidValues) -> Iterator[Broken]:
    numbers = [values.get(*place, "number") for place in _places(values, "tool")]
    for k, number in enumerate(numbers):
        if number is not None and number in numbers[:k]:
            yield ("tool", k, "number"), "is the number of another tool; each tool needs its own"
    if None in numbers or not numbers or values.has(*LIBRARY):
        return
    for place in (
        operation_place for name in OPERATIONS for operation_place in _places(values, name)
    ):
        number = values.get(*place, "tool")
        if number is not None and number not in numbers:
            known = ", ".join(str(known_number) for known_number in sorted(numbers))
            yield (*place, "tool"), f"there is no such tool; there are {known}"


class MillingBuilder:
    """Builds what a scene says on milling; the faults go to `converter`."""

    def __init__(self, converter: SceneConverter) -> None:
        self._converter = converter
        self._values = converter.values

    def spec(self, program: GcodeSpec | None) -> MillingSpec | None:
        """All that the scene states on milling; None if it states nothing, or if a table is not
        valid or not complete.
        """
        values = self._values
        earlier = _earlier_tool(program)
        named = any(values.has(name) for name in MILLING) or values.has(*LIBRARY)
        if not named and earlier is None:
            return None
        if any(values.has(name) and not values.valid(name) for name in MILLING):
            return None
        if any(tables_are_whole(values)):
            return None
        fault_count = len(self._converter.faults)
        tools: list[Tool] = self.build_list("tool", tool_from_table)
        if earlier is not None:
            tools.append(earlier)
        known = {tool.number for tool in tools}
        library = self._library()
        tools += [tool for tool in library or () if tool.number not in known]
        stock: Stock | None = self._one("stock", partial(instance_from_table, Stock))
        holding: Holding | None = self._one("holding", holding_from_table)
        operations, from_below = (self._operations(name, tools, library) for name in OPERATIONS)
        second: SecondSide | None = self._one(SECOND_SIDE, second_side_from_table)
        if library is None or len(self._converter.faults) > fault_count:
            return None
        return MillingSpec(
            tools=tuple(tools),
            stock=stock or Stock(),
            holding=holding,
            operations=tuple(operations),
            earlier=earlier is not None,
            second=second,
            second_operations=tuple(from_below),
        )

    def _operations(
        self, name: str, tools: list[Tool], library: list[Tool] | None
    ) -> list[OperationSpec]:
        """The operations of one side. Their tools must be known; where the library has faults,
        which are reported, an unknown tool may be one of its own.
        """
        operations: list[OperationSpec] = self.build_list(name, operation_from_table)
        known = {tool.number for tool in tools}
        for place, operation in zip(_places(self._values, name), operations, strict=False):
            if library is not None and known and operation.tool not in known:
                numbers = ", ".join(str(number) for number in sorted(known))
                self._converter.fault(
                    (*place, "tool"), f"there is no such tool; there are {numbers}"
                )
        return operations

    def build_list(self, name: str, make: Callable[[Mapping[str, Any]], Built]) -> list[Built]:
        """What `make` builds of each table of a list; a table that it rejects is left out, with a
        fault.
        """
        # The tables of the second side have the same keys as those of the first one.
        node = milling_tables()[name.rpartition(".")[2]]["items"]
        places = _places(self._values, name)
        built = [self._build(place, self._converter.table(place, node), make) for place in places]
        return [instance for instance in built if instance is not None]

    def _one(self, name: str, make: Callable[[Mapping[str, Any]], Built]) -> Built | None:
        if not self._values.has(name):
            return None
        return self._build((name,), self._converter.table((name,), milling_tables()[name]), make)

    def _build(
        self, place: KeyPath, table: Mapping[str, Any], make: Callable[[Mapping[str, Any]], Built]
    ) -> Built | None:
        """What `make` builds; None, with a fault, if it raises GeometryError for a value that the
        schema allows.
        """
        try:
            return make(table)
        except GeometryError as error:
            key = parse_path(error.key) or ()
            inner = place == (SECOND_SIDE,) != key[:1]  # a table within the table
            self._converter.fault((*place, *(key if inner else key[1:])), error.message)
            return None

    def _library(self) -> list[Tool] | None:
        """The tools of the file that the scene names; None if it has faults, each of which is
        reported at the key that names it.
        """
        if self._values.get(*LIBRARY) is None:
            return []
        data = self._converter.read(LIBRARY)
        if data is None:
            return None
        try:
            return parse_tool_library(data)
        except SceneError as error:
            for fault in error.faults:
                where = "" if fault.line is None else f"line {fault.line}: "
                what = f"{fault.key}: " if fault.key else ""
                self._converter.fault(LIBRARY, f"{where}{what}{fault.message}", fault.hint)
            return None


def _earlier_tool(program: GcodeSpec | None) -> Tool | None:
    """The tool of earlier keys; None if there is none, or one that a rule of the format refuses."""
    try:
        return None if program is None else program.tool
    except GeometryError:
        return None


@cache
def _library_schema() -> Composed:
    """The schema of a file of tools."""
    units = schema()["properties"]["units"]
    keys = {"units": {**units, "properties": {"length": units["properties"]["length"]}}}
    root = {
        "type": "object",
        "required": ["tool"],
        "additionalProperties": False,
        "properties": {**keys, "tool": milling_tables()["tool"]},
        "$defs": schema()["$defs"],
    }
    return Composed(root, (), ())


def parse_tool_library(data: bytes) -> list[Tool]:
    """The tools of a library, a TOML file with `[[tool]]` like those of a scene, and `[units]`.

    Raises
    ------
    SceneError
        With all its faults.
    """
    parsed = document(data)
    verdict = check_schema(parsed, _library_schema())
    values = ValidValues(parsed, verdict.bad, verdict.meant)
    faults: list[Fault] = [*parsed.faults, *verdict.faults]
    faults += [parsed.fault(*broken) for broken in broken_tables(values, whole=True)]
    converter = SceneConverter(values)
    tools: list[Tool] = []
    if not faults:
        builder = MillingBuilder(converter)
        tools = builder.build_list("tool", tool_from_table)
        faults = converter.faults
    if faults:
        raise SceneError(faults)
    return tools


# Building ---------------------------------------------------------------------------------------


def tool_from_table(table: Mapping[str, Any]) -> Tool:
    """The tool of a converted table `[[tool]]`; raises GeometryError with the key in `tool`."""
    values = dict(table)
    cutting, load = values.pop("cutting_speed", None), values.pop("chip_load", None)
    if cutting is not None:
        # In whole revolutions per minute, as controllers show it; the feed follows from this speed.
        values["spindle_speed"] = max(1.0, float(round(cutting / (math.pi * values["diameter"]))))
    if load is not None:
        values["feed"] = load * values["flutes"] * float(values["spindle_speed"])
    if values.get("kind") == DRILL:  # it only moves along Z
        values["plunge_feed"] = values["feed"]
    return instance_from_table(Tool, values)


def holding_from_table(table: Mapping[str, Any]) -> Holding:
    """The holding of a converted table; raises GeometryError with the key in `holding`."""
    values = dict(table)
    clamps = [instance_from_table(Clamp, clamp) for clamp in values.pop("clamp", ())]
    clamps += [_screw(screw) for screw in values.pop("screw", ())]
    tabs = None
    if values["kind"] == TABS:
        tabs = instance_from_table(
            Tabs, {key: values.pop(key) for key in ("count", "width", "height")}
        )
    return Holding(
        kind=values["kind"],
        through=values.get("through", 0.0),
        tabs=tabs,
        skin=values.get("thickness"),
        clamps=tuple(clamps),
    )


def _screw(table: Mapping[str, Any]) -> Clamp:
    values = dict(table)
    width = values.pop("head_diameter")
    return instance_from_table(Clamp, {**values, "length": width, "width": width, "round": True})


def operation_from_table(table: Mapping[str, Any]) -> OperationSpec:
    """The operation of a converted table; raises GeometryError with the key in `operation`."""
    values = dict(table)
    climb = values.pop("direction", "climb") == "climb"
    return instance_from_table(OperationSpec, {**values, "climb": climb})


def second_side_from_table(table: Mapping[str, Any]) -> SecondSide:
    """The setup of a converted table `[second_side]`; raises GeometryError with the key in it."""
    values = {key: value for key, value in table.items() if key not in SECOND_SIDE_TABLES}
    return SecondSide(**values, holding=holding_from_table(table["holding"]))


# Faults of planning -----------------------------------------------------------------------------


def planning_error(values: ValidValues, error: GeometryError, file: str) -> SceneError:
    """An error of planning a program as a fault of its scene: with file, key, value and line."""
    fault = values.scene.fault(_blamed(values, error), error.message)
    fault = fault if fault.value else replace(fault, value=error.value)
    return SceneError([fault], file)


def _blamed(values: ValidValues, error: GeometryError) -> KeyPath:
    """The key of the scene that an error of planning is about; that of the program if none is."""
    if isinstance(error, ToolError):
        return _tool_place(values, error.number, error.field)
    path = parse_path(error.key) or PROGRAM
    if path[0] == "toolpath":
        return PROGRAM
    return path if path[0] != "tool" or values.has("tool") else _tools_elsewhere(values)


def is_missing(values: ValidValues, fault: Fault) -> bool:
    """Whether a fault of planning is about a key that the scene lacks, not about a wrong value."""
    path = parse_path(fault.key)
    if path in (None, (), PROGRAM):
        return False
    return path[:2] == FORMATS or values.lacks(*path)


def _tool_place(values: ValidValues, number: int, field: str) -> KeyPath:
    """Key of a field of the tool `number`, or of the whole tool if `field` is empty: in the scene,
    in earlier keys, or that of the library.
    """
    for place in _places(values, "tool"):
        if values.get(*place, "number") == number:
            return (*place, field) if field else place
    if values.has(*PROGRAM, "tool_diameter"):
        keys = {name: key for key, name in EARLIER.items()}
        return (*PROGRAM, keys.get(field, "tool_diameter"))
    return LIBRARY


def _tools_elsewhere(values: ValidValues) -> KeyPath:
    return LIBRARY if values.has(*LIBRARY) else (*PROGRAM, "tool_diameter")
