"""G-code: the milling program."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from decimal import Decimal
from typing import Any, Final

from camgeo.declared import schema_beside
from camgeo.formats.format import Format, Values, groove_has_a_depth
from camgeo.toolpath.spec import GcodeSpec


def parse(table: Mapping[str, Any]) -> GcodeSpec:
    """The options of the table."""
    numbers = {"tool_number": int, "program_number": int, "spindle_speed": float}
    converted = {key: make(table[key]) for key, make in numbers.items() if key in table}
    return GcodeSpec(**{**table, **converted})


def tool_fits(values: Values) -> Iterator[tuple[str, str]]:
    """The end mill fits into the groove and the bore."""
    key = "tool_diameter"
    tool = values.get("output", "gcode", key)
    if tool is None:
        return
    contact = values.get("follower", "contact")
    roller = values.exact("follower", "roller_radius")
    if contact == "groove" and roller and values.valid("follower", "side_clearance"):
        play = values.exact("follower", "side_clearance") or Decimal(0)
        width = 2 * roller + play  # as they are written: a cutter may fill the groove
        written = values.exact("output", "gcode", key)
        if written is not None and written > width:
            what = "the roller's diameter and side_clearance" if play else "the roller's diameter"
            yield key, f"must not exceed the width of the groove, {what} {float(width):g}"
    bore = values.get("part", "bore")
    if contact != "outer" and bore is not None and tool >= bore:
        yield key, f"must be less than the bore to be milled, {bore:g}"


def machine_has(values: Values) -> Iterator[tuple[str, str]]:
    """Coolant and work offset are those of the machine; of a profile file the writer tells it."""
    given = {key: values.get("output", "gcode", key) for key in ("coolant", "work_offset")}
    machine = values.get("output", "gcode", "machine") or GcodeSpec().machine
    if not any(given.values()) or machine.endswith(".toml"):
        return
    from camgeo.toolpath.machine import load  # a declaration imports nothing that computes

    profile = load(machine)
    allowed = {"coolant": profile.coolant.kinds, "work_offset": tuple(profile.work_offsets)}
    for key, value in given.items():
        if value and value not in allowed[key]:
            choices = ", ".join(f'"{each}"' for each in allowed[key])
            yield key, f"must be one of {choices} for {profile.name}"


def program_suffix(spec: GcodeSpec) -> str:
    """That of the machine's programs; SceneError if there is no such machine."""
    from camgeo.toolpath.machine import load  # a declaration imports nothing that computes

    return load(spec.machine).extension


FORMAT: Final = Format(
    "gcode",
    ".ngc",
    parse,
    schema_beside(__file__),
    ("follower", "part.thickness", "output.gcode.tool_diameter"),
    (groove_has_a_depth, tool_fits, machine_has),
    program_suffix,
)
