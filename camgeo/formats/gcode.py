"""G-code: the milling program."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from decimal import Decimal
from typing import Any, Final

from camgeo.formats.format import Format, Values
from camgeo.formats.solid import groove_has_a_depth
from camgeo.toolpath.spec import GcodeSpec

MACHINES: Final = ("linuxcnc",)
"""Machine profiles that come with camgeo; any other is a file."""


def parse(table: Mapping[str, Any]) -> GcodeSpec:
    """The options of the table."""
    numbers = {"tool_number": int, "spindle_speed": float}
    return GcodeSpec(**{key: numbers.get(key, _same)(value) for key, value in table.items()})


def _same(value: Any) -> Any:
    return value


def tool_fits(values: Values) -> Iterator[tuple[str, str]]:
    """The end mill fits into what it has to mill."""
    key = "tool_diameter"
    tool = values.get("output", "gcode", key)
    if tool is None:
        return
    contact = values.get("follower", "contact")
    roller = values.exact("follower", "roller_radius")
    if contact == "groove" and roller and values.sound("follower", "side_clearance"):
        play = values.exact("follower", "side_clearance") or Decimal(0)
        width = 2 * roller + play  # as they are written: a cutter may fill the groove
        written = values.exact("output", "gcode", key)
        if written is not None and written > width:
            what = "the roller's diameter and side_clearance" if play else "the roller's diameter"
            yield key, f"must not exceed the width of the groove, {what} {float(width):g}"
    bore = values.get("part", "bore")
    if contact != "outer" and bore is not None and tool >= bore:
        yield key, f"must be less than the bore to be milled, {bore:g}"


SCHEMA: Final[Mapping[str, Any]] = {
    "description": "The milling program; needed by format gcode.",
    "type": "object",
    "required": ["tool_diameter"],
    "additionalProperties": False,
    "properties": {
        "machine": {
            "description": 'Machine profile: "linuxcnc" (default), or a profile file: a path ending'
            " in .toml, relative to the scene and inside its folder.",
            "type": "string",
            "pattern": "^linuxcnc$|^[^\\u0000-\\u001f]{1,200}\\.toml$",
            "default": MACHINES[0],
            "x-values": list(MACHINES),
            "x-later": ["grbl", "fanuc", "sinumerik"],
            "x-allowed": 'must be "linuxcnc" or the path of a machine profile ending in .toml',
            "x-path": True,
        },
        "tool_diameter": {"description": "Diameter of the end mill.", "$ref": "#/$defs/length"},
        "tool_number": {
            "description": "Number of the end mill in the tool table, 1 to 99999. Default 1.",
            "type": "integer",
            "minimum": 1,
            "maximum": 99999,
            "default": 1,
        },
        "spindle_speed": {
            "description": "Speed of the spindle [rev/min]. Default 3000.",
            "$ref": "#/$defs/speed",
            "default": 3000,
            "x-exact": True,
        },
        "feed": {
            "description": "Feed in the plane, in the scene's unit of length per minute. Default"
            " 300 mm/min.",
            "$ref": "#/$defs/length",
            "x-default-mm": 300,
        },
        "plunge_feed": {
            "description": "Feed along Z, in the scene's unit of length per minute. Default"
            " 100 mm/min.",
            "$ref": "#/$defs/length",
            "x-default-mm": 100,
        },
        "pass_depth": {
            "description": "Largest depth of one pass. Default: one pass over the whole depth.",
            "$ref": "#/$defs/length",
        },
        "safe_height": {
            "description": "Height of traverses above the upper face. Default 5 mm.",
            "$ref": "#/$defs/length",
            "x-default-mm": 5,
        },
    },
}

FORMAT: Final = Format(
    "gcode",
    ".ngc",
    parse,
    SCHEMA,
    ("part.thickness", "output.gcode.tool_diameter"),
    (groove_has_a_depth, tool_fits),
)
