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
"""Begin of the messages about keys that a table lacks."""

DIAMETER: Final = "output.gcode.tool_diameter"


def parse(table: Mapping[str, Any]) -> GcodeSpec:
    """The options of the table `[output.gcode]`; raises GeometryError with the key."""
    options = dict(table)
    if "tools" in options:
        options["tools"] = options["tools"].name
    if "safe_height" in options:
        options["clearance_height"] = options.pop("safe_height")
    return instance_from_table(GcodeSpec, options)


def milling_has_a_tool(values: Values) -> Iterator[tuple[str, str]]:
    """A tool is stated, in the scene, in a library or by earlier keys."""
    earlier = any(values.get(*TABLE, key) is not None for key in EARLIER)
    if not _has_tools(values) and not earlier:
        yield "", "needs [[tool]]: a tool, and how it is run"


def earlier_keys_state_a_whole_tool(values: Values) -> Iterator[tuple[str, str]]:
    """Earlier keys exclude `[[tool]]`; a program needs all of them that have no default."""
    stated = [key for key in EARLIER if values.get(*TABLE, key) is not None]
    if stated and not values.lacks("tool"):
        for key in stated:
            yield key, f"contradicts [[tool]]: state it as {EARLIER[key]} there"
        return
    if stated and values.lacks(*TABLE, "tool_diameter"):
        yield "", f"needs {DIAMETER}: the other keys state how this tool is run"
    if "tool_diameter" in stated:
        for key in NEEDED:
            if values.lacks(*TABLE, key):
                yield "", f"needs output.gcode.{key}: {STATE}"
    heights = (values.get(*TABLE, key) for key in ("safe_height", "clearance_height"))
    if None not in heights:
        yield "safe_height", "contradicts clearance_height; state only that"


def a_through_cut_is_held(values: Values) -> Iterator[tuple[str, str]]:
    """A scene with a cut through the blank states how the blank is held."""
    if not values.lacks("holding"):
        return
    bore = values.get("part", "bore")
    through = values.get("follower", "contact") != "groove" or (
        bore is not None and values.get("stock", "bore") != bore
    )
    if through:
        yield (
            "",
            "needs [holding]: a cut goes through the blank, and what it cuts free must be held",
        )


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
    """The machine has the coolant, the work offset and the compensation that are asked for; for a
    profile that is a file the writer checks it.
    """
    keys = ("coolant", "work_offset", "compensation")
    stated = {key: values.get("output", "gcode", key) for key in keys}
    machine = values.get("output", "gcode", "machine") or GcodeSpec().machine
    if not any(stated.values()) or machine.endswith(".toml"):
        return
    from camgeo.milling.machine import load  # a declaration imports nothing that computes

    profile = load(machine)
    allowed = {
        "coolant": profile.coolant.kinds,
        "work_offset": tuple(profile.work_offsets),
        "compensation": profile.compensations,
    }
    for key, value in stated.items():
        if value and value not in allowed[key]:
            choices = ", ".join(f'"{choice}"' for choice in allowed[key])
            yield key, f"must be one of {choices} for {profile.name}"


def a_corner_is_known(values: Values) -> Iterator[tuple[str, str]]:
    """A zero on a corner of the blank, of either side, needs a plate of stated size."""
    for place in (TABLE, ("second_side",)):
        zero = values.get(*place, "zero")
        if zero not in (None, AXIS) and values.lacks("stock", "length"):
            where = f'{".".join(place)}.zero = "{zero}"'
            yield "", f"needs [stock] length and width of a plate, for {where}"


def tables_are_whole(values: Values) -> Iterator[tuple[str, str]]:
    """The tables on milling are complete: there are no defaults for cutting data."""
    for name, faults in FAULTS.items():
        stated = values.get(*name.split("."))
        several = isinstance(stated, list)
        for number, table in enumerate(stated if several else [stated] if stated else [], start=1):
            for key, message in faults(table):
                if key not in table:
                    place = f"{name}[{number}]" if several else name
                    yield "", f"needs {place}.{key}: {message.removeprefix(MISSING)}"


def program_suffix(spec: GcodeSpec) -> str:
    """The suffix of the machine's programs; SceneError if there is no such machine."""
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
