"""Writes docs/machines.md: `python docs/machines_page.py`. A test holds the page to it.

The page is made from the schema of machine profiles and from the profiles of camgeo.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import fields
from pathlib import Path
from typing import Any, Final

from camgeo.app.answers.machines import WORDS, Listed, machines
from camgeo.milling.machine import EARLIER, EVIDENCE, Machine, RadiusDifference, ReaderRules, schema

PAGE: Final = Path(__file__).with_name("machines.md")

HEAD: Final = """\
# Machine profiles

<!-- Made from camgeo/milling/machine.schema.json and the profiles in camgeo/milling/machines by
docs/machines_page.py; change them there. -->

A machine profile is a TOML file that says what programs for a controller look like and what the
controller accepts. Programs are written, and read back, by the profile alone. A scene names one of
camgeo's or a file of its own:

```toml
[output.gcode]
machine = "mill.toml"   # relative to the scene, inside its folder
```

`camgeo machines` lists the profiles, `camgeo machines haas` shows one with all its keys, and
`camgeo machines mill.toml` checks one of your own: it reports all faults, each with its key, its
value and what is allowed. To make one, copy the profile that is nearest and change what differs.

Every profile says what it rests on. No program of camgeo's has been run on a machine yet: before
the first one, compare these tables with the manual of yours, above all what is not confirmed, and
let the first program run in air.
"""

FRAME: Final = """\
## What stands where in a program

1. `program.start`, `program.blank` if the outline of the blank is known, then comments on the whole
   program.
2. For each operation, so that it can be restarted alone: its comments, `program.safe_start`,
   smoothing, `retract.blocks`, `spindle.off` before another tool, `tool_change.change`,
   `tool_change.length_offset`, the approach with `spindle.clockwise`, the dwell and coolant, then
   its moves. "z-first" goes up to the clearance height before the spindle starts, because the
   cutter may stand on the work; "xy-first" starts it at the height of the retract. The comments of
   the first operation stand behind the tool change, as those of the program are above it; before
   the first tool change there is a retract only with `retract.first`. A retract to the clearance
   height, {z}, stands at the end of an operation instead, while the length of its tool holds.
3. `coolant.off`, `retract.blocks`, `spindle.off`, `smoothing.end`, `program.end`.

Blocks are texts in which names in braces are filled in: {unit}, {work_offset}, {tool}, {speed},
{z} (the clearance height), {dwell}, {p} (the largest deviation of smoothing), {name} and {number}
of the program. A traverse moves either in Z or in X and Y, because the rapids of many machines are
not straight. Arcs are checked in their printed digits; where the printed ends of an arc coincide,
which controllers take for a full circle, it is left out. Where a controller has no helix, where an
arc's radius is out of its range, or where its own arcs would take more than half of the tolerance,
it gets lines within the tolerance.
"""

BLANK: Final = "–"


def page() -> str:
    """The page."""
    listed = machines().listed or ()
    parts = [HEAD, *_overview(listed), "", *_reading(listed), "", FRAME, *_keys(), ""]
    parts += _evidence(listed)
    return "\n".join(parts).rstrip() + "\n"


def _overview(listed: tuple[Listed, ...]) -> Iterator[str]:
    rows: dict[str, Callable[[Machine], str]] = {
        "controller": lambda each: each.controller,
        "ending": lambda each: f"`{each.extension}`",
        "decimals, mm and inch": _decimals,
        "10 without a point": _without_point,
        "dwell of 2 s": _dwell,
        "arcs": _arcs,
        "radii may differ by": lambda each: f"{each.arcs.radius_tolerance:g} mm",
        "retract": lambda each: _code(each.retract.blocks),
        "tool change": _change,
        "coolant": lambda each: ", ".join(each.coolant.kinds),
        "smoothing": lambda each: _code(each.smoothing.on) if each.smoothing else BLANK,
        "comment": lambda each: f"`{each.text.comment_open}...{each.text.comment_close}`",
    }
    yield "## The profiles"
    yield ""
    for each in listed:
        yield f"### {each.profile}"
        yield ""
        yield "| | |"
        yield "|---|---|"
        for name, value in rows.items():
            yield f"| {name} | {value(each.machine)} |"
        yield ""


READING: Final = """\
## What each takes

Rules by which [camgeo lint](lint.md) reads a program of any origin, by control: the keys of
`[reading]`, which are described [below](#keys), and what they rest on, of which the
[evidence](#what-the-profiles-rest-on) says more. Where a profile says nothing (-) the default
holds, which is what most controllers do or, in a limit, what is written for this one.
"""


def _reading(listed: tuple[Listed, ...]) -> Iterator[str]:
    """The rules of reading, by control."""
    yield READING
    names = [each.profile for each in listed]
    yield f"| rule | default | {' | '.join(names)} |"
    yield "|---" * (len(names) + 2) + "|"
    default = ReaderRules()
    for field in fields(ReaderRules):
        own = getattr(default, field.name)
        cells = [_rule(each.machine, field.name, own) for each in listed]
        yield f"| `{field.name}` | {_shown(own) or BLANK} | {' | '.join(cells)} |"


def _rule(machine: Machine, key: str, default: object) -> str:
    value = getattr(machine.reading, key)
    if value == default:
        return "-"
    kinds = [each.kind for each in machine.evidence if f"reading.{key}" in each.about]
    best = min(kinds, key=EVIDENCE.index)
    return f"{_shown(value)}, {WORDS[best]}"


def _shown(value: object) -> str:
    """A value of a rule in a cell."""
    if isinstance(value, RadiusDifference):
        share = f", or {100.0 * value.relative:g} % of the radius" if value.relative else ""
        return f"{value.mm:g} mm, in inches {value.inch:g} mm{share}"
    if isinstance(value, tuple):
        sets = [each for each in value if " " in each and each[0] in "GM"]
        return f"{len(sets)} sets" if sets else ", ".join(value)
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, float):
        return f"{value:g} mm"
    return BLANK if value is None else f"{value}" or "none"


def _decimals(machine: Machine) -> str:
    least, most = machine.numbers.decimals, machine.numbers.most_decimals
    texts = []
    for unit in ("mm", "inch"):
        low, high = getattr(least, unit), getattr(most, unit)
        texts.append(f"{low}" if low == high else f"{low} to {high}")
    return ", ".join(texts)


def _without_point(machine: Machine) -> str:
    increment = machine.numbers.increment
    return "10 mm" if increment is None else f"{10 * increment.mm:g} mm"


def _dwell(machine: Machine) -> str:
    time = "2000" if machine.dwell.unit == "ms" else "2"
    return _code([block.format(dwell=time) for block in machine.dwell.blocks])


def _arcs(machine: Machine) -> str:
    arcs = machine.arcs
    centre = {
        "incremental": "I and J from the start",
        "absolute": "I and J absolute",
        "block": "centre in a block of its own",
    }[arcs.centre]
    own = f"; run within {arcs.interpolation:g} mm" if arcs.interpolation else ""
    return f"{centre}; {'helices' if arcs.helical else 'no helices'}{own}"


def _change(machine: Machine) -> str:
    blocks = machine.tool_change.change + machine.tool_change.length_offset
    return _code(blocks) if machine.tool_change.change else "none: one tool in a program"


def _code(blocks: tuple[str, ...] | list[str]) -> str:
    return ", ".join(f"`{block}`" for block in blocks)


def _keys() -> Iterator[str]:
    yield "## Keys"
    yield ""
    yield "Keys with a default may be left out, like the tables in parentheses."
    yield ""
    own = schema()
    plain = {key: node for key, node in own["properties"].items() if "properties" not in node}
    yield from _table("", {"properties": plain, "required": own["required"]})
    for key, node in own["properties"].items():
        if "properties" in node:
            name = f"`[{key}]`" if key in own["required"] else f"(`[{key}]`)"
            yield ""
            yield f"### {name}"
            yield ""
            yield node["description"]
            yield ""
            yield from _table("", node)
    node = own["properties"]["evidence"]["items"]
    yield ""
    yield "### (`[[evidence]]`)"
    yield ""
    yield node["description"]
    yield ""
    yield from _table("", node)
    yield ""
    earlier = ", ".join(f"`{old}` is `{new}`" for old, new in EARLIER.items())
    yield f"Of the keys of earlier profiles {earlier} now."


def _table(path: str, node: Mapping[str, Any]) -> Iterator[str]:
    yield "| key | value | meaning |"
    yield "|---|---|---|"
    yield from _rows(path, node)


def _rows(path: str, node: Mapping[str, Any]) -> Iterator[str]:
    for key, each in node["properties"].items():
        if "properties" in each:
            names = ", ".join(each["properties"])
            yield f"| `{path}{key}` | table of {names} | {_meaning(each)} |"
        else:
            yield f"| `{path}{key}` | {_value(each)} | {_meaning(each)} |"


def _meaning(node: Mapping[str, Any]) -> str:
    filled = ", ".join(f"{{{name}}}" for name in node.get("x-filled", ()))
    text = str(node["description"])
    return f"{text} With {filled}." if filled and "{" not in text else text


def _value(node: Mapping[str, Any]) -> str:
    if "enum" in node:
        return ", ".join(f'"{each}"' for each in node["enum"])
    kind = {"array": "list", "object": "table", "string": "text", "boolean": "true or false"}
    text = kind.get(node["type"], "number")
    low = node.get("minimum", node.get("exclusiveMinimum"))
    high = node.get("maximum")
    if low is not None:
        text += f" from {low:g}" if "minimum" in node else f" above {low:g}"
    if high is not None:
        text += f" to {high:g}"
    unit = node.get("x-unit")
    return f"{text} ({unit})" if unit else text


def _evidence(listed: tuple[Listed, ...]) -> Iterator[str]:
    yield "## What the profiles rest on"
    yield ""
    yield (
        "Posts are programs of others that write for the controller: good evidence of what is in"
        " use, none of why."
    )
    for each in listed:
        yield ""
        yield f"### {each.profile}, evidence"
        yield ""
        for one in each.machine.evidence:
            about = ", ".join(f"`{key}`" for key in one.about)
            source = f" ({one.source})" if one.source else ""
            yield f"- {about}, {WORDS[one.kind]}: {one.text}{source}"


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
