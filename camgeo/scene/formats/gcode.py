"""G-code: the milling program."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from decimal import Decimal
from typing import Any, Final

from camgeo.milling.milling import AXIS, EARLIER, FAULTS, NEEDED, STATE, GcodeSpec
from camgeo.numeric.checked import instance_from_table
from camgeo.record import stored_schema
from camgeo.scene.formats.format import BODY, Format, Values

TABLE: Final = ("output", "gcode")

MISSING: Final = "is missing: "
"""Begins the reasons for keys that a table lacks."""

DIAMETER: Final = "output.gcode.tool_diameter"


def parse(table: Mapping[str, Any]) -> GcodeSpec:
    """The options of the table."""
    given = dict(table)
    if "tools" in given:
        given["tools"] = given["tools"].name
    if "safe_height" in given:
        given["clearance_height"] = given.pop("safe_height")
    return instance_from_table(GcodeSpec, given)


def milling_has_a_tool(values: Values) -> Iterator[tuple[str, str]]:
    """A tool is stated, in the scene, in a library or by earlier keys."""
    earlier = any(values.get(*TABLE, key) is not None for key in EARLIER)
    if not _has_tools(values) and not earlier:
        yield "", "needs [[tool]]: a tool, and how it is run"


def earlier_keys_state_a_whole_tool(values: Values) -> Iterator[tuple[str, str]]:
    """Earlier keys stand alone; a program needs all of them that nobody may invent."""
    given = [key for key in EARLIER if values.get(*TABLE, key) is not None]
    if given and not values.lacks("tool"):
        for key in given:
            yield key, f"contradicts [[tool]]: state it as {EARLIER[key]} there"
        return
    if given and values.lacks(*TABLE, "tool_diameter"):
        yield "", f"needs {DIAMETER}: the other keys state how this tool is run"
    if "tool_diameter" in given:
        for key in NEEDED:
            if values.lacks(*TABLE, key):
                yield "", f"needs output.gcode.{key}: {STATE}"
    heights = (values.get(*TABLE, key) for key in ("safe_height", "clearance_height"))
    if None not in heights:
        yield "safe_height", "contradicts clearance_height; give that alone"


def a_through_cut_is_held(values: Values) -> Iterator[tuple[str, str]]:
    """It is stated how the blank is held, wherever a cut goes through it."""
    if not values.lacks("holding"):
        return
    bore = values.get("part", "bore")
    through = values.get("follower", "contact") != "groove" or (
        bore is not None and values.get("stock", "bore") != bore
    )
    if through:
        yield "", "needs [holding]: a cut goes through the blank, and what it cuts free is held"


def tool_fits(values: Values) -> Iterator[tuple[str, str]]:
    """The one end mill of earlier keys fits into the groove and the bore."""
    written = values.exact(*TABLE, "tool_diameter")
    if written is not None:
        yield from (("tool_diameter", message) for message in misfits(values, written))


def misfits(values: Values, diameter: Decimal) -> Iterator[str]:
    """Why an end mill, with a diameter as it is written, does not fit into groove and bore."""
    contact = values.get("follower", "contact")
    roller = values.exact("follower", "roller_radius")
    if contact == "groove" and roller and values.valid("follower", "side_clearance"):
        play = values.exact("follower", "side_clearance") or Decimal(0)
        width = 2 * roller + play  # as they are written: a cutter may fill the groove
        if diameter > width:
            what = "the roller's diameter and side_clearance" if play else "the roller's diameter"
            yield f"must not exceed the width of the groove, {what} {float(width):g}"
    bore = values.exact("part", "bore")
    if contact == "outer" or bore is None or bore == values.exact("stock", "bore"):
        return
    if diameter >= bore:
        yield f"must be less than the bore to be milled, {float(bore):g}"


def _has_tools(values: Values) -> bool:
    return not (values.lacks("tool") and values.lacks(*TABLE, "tools"))


def machine_has(values: Values) -> Iterator[tuple[str, str]]:
    """Coolant, work offset and compensation are those of the machine; of a profile file the writer
    tells it.
    """
    keys = ("coolant", "work_offset", "compensation")
    given = {key: values.get("output", "gcode", key) for key in keys}
    machine = values.get("output", "gcode", "machine") or GcodeSpec().machine
    if not any(given.values()) or machine.endswith(".toml"):
        return
    from camgeo.milling.machine import load  # a declaration imports nothing that computes

    profile = load(machine)
    allowed = {
        "coolant": profile.coolant.kinds,
        "work_offset": tuple(profile.work_offsets),
        "compensation": profile.compensations,
    }
    for key, value in given.items():
        if value and value not in allowed[key]:
            choices = ", ".join(f'"{each}"' for each in allowed[key])
            yield key, f"must be one of {choices} for {profile.name}"


def a_corner_is_known(values: Values) -> Iterator[tuple[str, str]]:
    """The corners of the blank on which the zeros of the program and of its second side are."""
    for place in (TABLE, ("second_side",)):
        zero = values.get(*place, "zero")
        if zero not in (None, AXIS) and values.lacks("stock", "length"):
            where = f'{".".join(place)}.zero = "{zero}"'
            yield "", f"needs [stock] length and width of a plate, for {where}"


def tables_are_whole(values: Values) -> Iterator[tuple[str, str]]:
    """The tables on milling have all that nobody may invent."""
    for name, faults in FAULTS.items():
        given = values.get(*name.split("."))
        several = isinstance(given, list)
        for number, table in enumerate(given if several else [given] if given else [], start=1):
            for key, message in faults(table):
                if key not in table:
                    place = f"{name}[{number}]" if several else name
                    yield "", f"needs {place}.{key}: {message.removeprefix(MISSING)}"


def program_suffix(spec: GcodeSpec) -> str:
    """That of the machine's programs; SceneError if there is no such machine."""
    from camgeo.milling.machine import load  # a declaration imports nothing that computes

    return load(spec.machine).extension


NEEDS_OF_BODY, RULES_OF_BODY = BODY

FORMAT: Final = Format(
    "gcode",
    ".ngc",
    parse,
    stored_schema(__file__),
    ("follower", *NEEDS_OF_BODY),
    (
        *RULES_OF_BODY,
        milling_has_a_tool,
        a_through_cut_is_held,
        earlier_keys_state_a_whole_tool,
        tool_fits,
        machine_has,
        a_corner_is_known,
        tables_are_whole,
    ),
    program_suffix,
)
