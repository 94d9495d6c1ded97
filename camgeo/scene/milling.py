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
    OWN_TABLES,
    SECOND_SIDE,
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
from camgeo.scene.keys import KeyPath, path_of
from camgeo.scene.schema import MILLING, Composed, milling_tables, schema
from camgeo.scene.values import Broken, Inside, ValidValues, document, judged

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
    """All that is wrong between the keys of the tables, each with its place.

    Keys that are missing are faults of tables that must be `whole`: in a scene a program alone
    needs them, see `camgeo.scene.formats.gcode`.
    """
    for name, faults in FAULTS.items():
        for place in _places(values, name):
            table = values.get(*place)
            for key, message in faults(table) if table is not None else ():
                if key in table or (whole and values.lacks(*place, key)):
                    yield (*place, key), message
    yield from _tools_are_told_apart(values)
    yield from _machine_compensates(values)
    yield from _one_tool_fits(values)


def _one_tool_fits(values: ValidValues) -> Iterator[Broken]:
    """A single end mill for a planned sequence fits into groove and bore."""
    places = _places(values, "tool")
    if len(places) != 1 or values.has("operation") or values.has(*LIBRARY):
        return
    key = (*places[0], "diameter")
    written = values.exact(*key)
    if written is not None and values.get(*places[0], "kind") in (None, END_MILL):
        yield from ((key, message) for message in misfits(values, written))


def _machine_compensates(values: ValidValues) -> Iterator[Broken]:
    """Operations ask for no compensation that the machine lacks, nor the second side for a work
    offset; of a profile file the writer tells it.
    """
    asked: set[KeyPath] = {
        (*place, "compensation") for name in OPERATIONS for place in _places(values, name)
    }
    asked.add((SECOND_SIDE, "work_offset"))
    given = [(key, f"{key[-1]}") for key in sorted(asked, key=str) if values.get(*key)]
    machine = values.get("output", "gcode", "machine") or GcodeSpec().machine
    if not given or machine.endswith(".toml"):
        return
    from camgeo.milling.machine import load  # only scenes that ask for it need the profile

    profile = load(machine)
    allowed = {
        "compensation": profile.compensations,
        "work_offset": tuple(profile.work_offsets),
    }
    for key, name in given:
        if values.get(*key) not in allowed[name]:
            choices = ", ".join(f'"{each}"' for each in allowed[name])
            yield key, f"must be one of {choices} for {profile.name}"


def _places(values: ValidValues, name: str) -> list[KeyPath]:
    """Where the tables of that name are, one with a dot within another table."""
    path = tuple(name.split("."))
    given = values.raw(*path)
    if isinstance(given, list):
        return [(*path, k) for k in range(len(given))]
    return [] if given is None else [path]


def _tools_are_told_apart(values: ValidValues) -> Iterator[Broken]:
    numbers = [values.get(*place, "number") for place in _places(values, "tool")]
    for k, number in enumerate(numbers):
        if number is not None and number in numbers[:k]:
            yield ("tool", k, "number"), "belongs to another tool; each needs its own"
    if None in numbers or not numbers or values.has(*LIBRARY):
        return
    for place in (each for name in OPERATIONS for each in _places(values, name)):
        number = values.get(*place, "tool")
        if number is not None and number not in numbers:
            known = ", ".join(str(each) for each in sorted(numbers))
            yield (*place, "tool"), f"there is no such tool; there are {known}"


class MillingBuilder:
    """Builds what a scene says on milling; the faults go to `inside`."""

    def __init__(self, inside: Inside) -> None:
        self._inside = inside
        self._values = inside.values

    def spec(self, program: GcodeSpec | None) -> MillingSpec | None:
        """All of it; None if the scene says nothing, or nothing valid, or not all of a table."""
        values = self._values
        earlier = _earlier_tool(program)
        named = any(values.has(name) for name in MILLING) or values.has(*LIBRARY)
        if not named and earlier is None:
            return None
        if any(values.has(name) and not values.valid(name) for name in MILLING):
            return None
        if any(tables_are_whole(values)):
            return None
        before = len(self._inside.faults)
        tools: list[Tool] = self.each("tool", tool_of)
        if earlier is not None:
            tools.append(earlier)
        known = {tool.number for tool in tools}
        library = self._library()
        tools += [tool for tool in library or () if tool.number not in known]
        stock: Stock | None = self._one("stock", partial(instance_from_table, Stock))
        holding: Holding | None = self._one("holding", holding_of)
        operations, from_below = (self._operations(name, tools, library) for name in OPERATIONS)
        second: SecondSide | None = self._one(SECOND_SIDE, second_side_of)
        if library is None or len(self._inside.faults) > before:
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
        """Those of one side; their tools must be known, unless there are faults in the library."""
        made: list[OperationSpec] = self.each(name, operation_of)
        known = {tool.number for tool in tools}
        for place, each in zip(_places(self._values, name), made, strict=False):
            if library is not None and known and each.tool not in known:
                numbers = ", ".join(str(number) for number in sorted(known))
                self._inside.fault((*place, "tool"), f"there is no such tool; there are {numbers}")
        return made

    def each(self, name: str, make: Callable[[Mapping[str, Any]], Built]) -> list[Built]:
        """What `make` builds of each table of a list, without those that it refuses."""
        # The tables of a second side have the keys of those of the first.
        node = milling_tables()[name.rpartition(".")[2]]["items"]
        places = _places(self._values, name)
        made = [self._made(place, self._inside.table(place, node), make) for place in places]
        return [each for each in made if each is not None]

    def _one(self, name: str, make: Callable[[Mapping[str, Any]], Built]) -> Built | None:
        if not self._values.has(name):
            return None
        return self._made((name,), self._inside.table((name,), milling_tables()[name]), make)

    def _made(
        self, place: KeyPath, table: Mapping[str, Any], make: Callable[[Mapping[str, Any]], Built]
    ) -> Built | None:
        """What `make` builds; None, with a fault, if a value is not valid beyond its schema."""
        try:
            return make(table)
        except GeometryError as error:
            key = path_of(error.key) or ()
            inner = place == (SECOND_SIDE,) != key[:1]  # a table within the table
            self._inside.fault((*place, *(key if inner else key[1:])), error.message)
            return None

    def _library(self) -> list[Tool] | None:
        """The tools of the file that the scene names; None if there are faults in it, which are
        those of the key.
        """
        if self._values.get(*LIBRARY) is None:
            return []
        data = self._inside.read(LIBRARY)
        if data is None:
            return None
        try:
            return tools_of(data)
        except SceneError as error:
            for fault in error.faults:
                where = "" if fault.line is None else f"line {fault.line}: "
                what = f"{fault.key}: " if fault.key else ""
                self._inside.fault(LIBRARY, f"{where}{what}{fault.message}", fault.hint)
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


def tools_of(data: bytes) -> list[Tool]:
    """The tools of a library, a TOML file with `[[tool]]` like those of a scene, and `[units]`.

    Raises
    ------
    SceneError
        With all its faults.
    """
    found = document(data)
    verdict = judged(found, _library_schema())
    values = ValidValues(found, verdict.bad, verdict.meant)
    faults: list[Fault] = [*found.faults, *verdict.faults]
    faults += [found.fault(*each) for each in broken_tables(values, whole=True)]
    inside = Inside(values)
    tools: list[Tool] = []
    if not faults:
        builder = MillingBuilder(inside)
        tools = builder.each("tool", tool_of)
        faults = inside.faults
    if faults:
        raise SceneError(faults)
    return tools


# Building ---------------------------------------------------------------------------------------


def tool_of(table: Mapping[str, Any]) -> Tool:
    """The tool of a converted table `[[tool]]`; raises GeometryError with the key in `tool`."""
    given = dict(table)
    cutting, load = given.pop("cutting_speed", None), given.pop("chip_load", None)
    if cutting is not None:
        # As a controller shows it, and as the feed of each edge is reckoned from.
        given["spindle_speed"] = max(1.0, float(round(cutting / (math.pi * given["diameter"]))))
    if load is not None:
        given["feed"] = load * given["flutes"] * float(given["spindle_speed"])
    if given.get("kind") == DRILL:
        given["plunge_feed"] = given["feed"]
    return instance_from_table(Tool, given)


def holding_of(table: Mapping[str, Any]) -> Holding:
    """The holding of a converted table; raises GeometryError with the key in `holding`."""
    given = dict(table)
    clamps = [instance_from_table(Clamp, each) for each in given.pop("clamp", ())]
    clamps += [_screw(each) for each in given.pop("screw", ())]
    tabs = None
    if given["kind"] == TABS:
        tabs = instance_from_table(
            Tabs, {key: given.pop(key) for key in ("count", "width", "height")}
        )
    return Holding(
        kind=given["kind"],
        through=given.get("through", 0.0),
        tabs=tabs,
        skin=given.get("thickness"),
        clamps=tuple(clamps),
    )


def _screw(table: Mapping[str, Any]) -> Clamp:
    given = dict(table)
    width = given.pop("head_diameter")
    return instance_from_table(Clamp, {**given, "length": width, "width": width, "round": True})


def operation_of(table: Mapping[str, Any]) -> OperationSpec:
    """The operation of a converted table; raises GeometryError with the key in `operation`."""
    given = dict(table)
    climb = given.pop("direction", "climb") == "climb"
    return instance_from_table(OperationSpec, {**given, "climb": climb})


def second_side_of(table: Mapping[str, Any]) -> SecondSide:
    """The setup of a converted table `[second_side]`; raises GeometryError with the key in it."""
    given = {key: value for key, value in table.items() if key not in OWN_TABLES}
    return SecondSide(**given, holding=holding_of(table["holding"]))


# Faults of planning -----------------------------------------------------------------------------


def refused(values: ValidValues, error: GeometryError, file: str) -> SceneError:
    """What planning a program raises, as the fault of its scene: file, key, value and line."""
    fault = values.scene.fault(_blamed(values, error), error.message)
    fault = fault if fault.value else replace(fault, value=error.value)
    return SceneError([fault], file)


def _blamed(values: ValidValues, error: GeometryError) -> KeyPath:
    """The place in the scene that an error of planning is about."""
    if isinstance(error, ToolError):
        return _place_of(values, error.number, error.field)
    path = path_of(error.key) or PROGRAM
    if path[0] == "toolpath":
        return PROGRAM
    return path if path[0] != "tool" or values.has("tool") else _tools_elsewhere(values)


def is_missing(values: ValidValues, fault: Fault) -> bool:
    """Whether a fault of planning is a key that the scene lacks, and not one that is wrong."""
    path = path_of(fault.key)
    if path in (None, (), PROGRAM):
        return False
    return path[:2] == FORMATS or values.lacks(*path)


def _place_of(values: ValidValues, number: int, field: str) -> KeyPath:
    """Of a field of a tool, or of the whole one: in the scene, in earlier keys, in a library."""
    for place in _places(values, "tool"):
        if values.get(*place, "number") == number:
            return (*place, field) if field else place
    if values.has(*PROGRAM, "tool_diameter"):
        keys = {name: key for key, name in EARLIER.items()}
        return (*PROGRAM, keys.get(field, "tool_diameter"))
    return LIBRARY


def _tools_elsewhere(values: ValidValues) -> KeyPath:
    return LIBRARY if values.has(*LIBRARY) else (*PROGRAM, "tool_diameter")
