"""The setup sheet as text, and as one HTML page that needs nothing else."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from html import escape
from typing import Final

from camgeo.answers.answer import MARKS
from camgeo.answers.setup import SetupSheet, Step, shown
from camgeo.toolpath.tool import Tool
from camgeo.units import MM_PER, LengthUnit, in_unit
from camgeo.wording import clock, counted

NONE: Final = "-"
"""Shown where nobody states a value."""

TOOLS: Final = ("T", "tool", "diameter", "flutes", "cutting length", "stick-out", "shank")
STEPS: Final = ("", "operation", "T", "speed", "feed", "plunge", "down to Z", "coolant", "time")
"""Heads of the columns; lengths and feeds in the unit of the scene, speeds in rev/min."""

FEED: Final[dict[LengthUnit, int]] = {"mm": 0, "inch": 2}
"""Decimals of feeds."""

STYLE: Final = """
body { font: 14px/1.4 sans-serif; margin: 2em auto; max-width: 60em; color: #111; }
h1 { font-size: 1.5em; } h2 { font-size: 1.1em; margin-top: 1.5em; }
table { border-collapse: collapse; }
th, td { border: 1px solid #999; padding: 0.2em 0.6em; text-align: right; }
th:nth-child(2), td:nth-child(2) { text-align: left; }
dt { font-weight: bold; } dd { margin: 0 0 0.4em 0; }
.flaw { color: #b3261e; } svg { max-width: 100%; height: auto; }
@media print { body { margin: 0; } h2, figure { break-inside: avoid; } }
"""


def text(answer: SetupSheet) -> str:
    """The sheet for a terminal, one side after the other."""
    return "\n\n".join(_side_text(sheet) for sheet in answer.sheets)


def _side_text(answer: SetupSheet) -> str:
    lines = [_head(answer), ""]
    lines += [f"{name:10}{value}" for name, value in _facts(answer)]
    unit = answer.scene.unit
    lines += ["", *_columns(TOOLS, [_tool(tool, unit) for tool in answer.tools])]
    steps = [_step(k, step, unit) for k, step in enumerate(answer.steps, 1)]
    lines += ["", *_columns(STEPS, steps), _units(unit)]
    lines += [f"   {each}" for each in _remarks(answer)]
    marks = {True: MARKS["warning"], False: "FLAW"}
    flaws = [f"{marks[flaw.watched]:8}{flaw.name:10}{flaw.sentence}" for flaw in answer.flaws]
    lines += [""] * bool(answer.features)
    lines += [f"{MARKS[each.severity]:8}{each.sentence}" for each in answer.features]
    lines += ["", *flaws]
    return "\n".join(lines if answer.flaws else [*lines, _verdict(answer)])


def html(answer: SetupSheet, picture: str) -> str:
    """The sheet as a page; `picture` is an SVG element, all other texts are escaped."""
    name = escape(answer.scene.name)
    sides = "".join(_side_html(sheet) for sheet in answer.sheets)
    return f"""<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta http-equiv="Content-Security-Policy" content="default-src 'none'; style-src 'unsafe-inline'">
<title>{name}: setup</title>
<style>{STYLE}</style>
</head>
<body>
{sides}<h2>Backplot</h2>
<figure>{picture}</figure>
</body>
</html>
"""


def _side_html(answer: SetupSheet) -> str:
    """One side, from its heading to its simulation."""
    facts = "".join(
        f"<dt>{escape(key)}</dt><dd>{escape(value)}</dd>" for key, value in _facts(answer)
    )
    remarks = "".join(f"<li>{escape(each)}</li>" for each in _remarks(answer))
    listed = f"<ul>{remarks}</ul>" if remarks else ""
    unit = answer.scene.unit
    features = "".join(
        _item(each.sentence, unit, flaw=each.severity != "ok") for each in answer.features
    )
    part = f"<h2>Part</h2>\n<ul>{features}</ul>\n" if features else ""
    flaws = "".join(_item(each.sentence, unit, flaw=True) for each in answer.flaws)
    verdict = f"<ul>{flaws}</ul>" if flaws else f"<p>{escape(_verdict(answer))}</p>"
    steps = [_step(k, step, unit) for k, step in enumerate(answer.steps, 1)]
    return f"""<h1>{escape(_head(answer))}</h1>
<dl>{facts}</dl>
<h2>Tools</h2>
{_table(TOOLS, [_tool(tool, unit) for tool in answer.tools])}
<h2>Operations</h2>
{_table(STEPS, steps)}
{listed}
<p>{_units(unit)} Each operation can be started alone.</p>
{part}<h2>Simulation</h2>
{verdict}
"""


def _item(sentence: str, unit: LengthUnit, *, flaw: bool) -> str:
    mark = ' class="flaw"' if flaw else ""
    return f"<li{mark}>{escape(in_unit(sentence, unit))}</li>"


def _head(answer: SetupSheet) -> str:
    side = "" if answer.side is None else f", {answer.side}"
    return f"{answer.scene.name}: setup for {answer.machine}{side}"


def svg_element(data: bytes) -> str:
    """The SVG element of a picture, without the prologue of a file."""
    source = data.decode("utf-8")
    return source[source.index("<svg") :].strip()


def _facts(answer: SetupSheet) -> list[tuple[str, str]]:
    found = [
        ("blank" if answer.second is not None or answer.side is None else "work", answer.blank),
        ("zero", answer.zero),
        ("offset", answer.work_offset),
        ("held", answer.holding),
        ("traverses", answer.traverses),
    ]
    if answer.seconds is not None:
        found.append(("time", f"{clock(answer.seconds)}, tool changes left out"))
    return found


def _verdict(answer: SetupSheet) -> str:
    steps = counted(len(answer.steps), "operation")
    unlike = any(each.severity == "broken" for each in answer.features)
    gouge = "more is taken off than the part states" if unlike else "no gouge"
    return f"Simulated: {steps}, {gouge}, no rest, nothing comes loose."


def _remarks(answer: SetupSheet) -> Iterator[str]:
    """What the operator reads of each operation, and of the sequence."""
    for step in answer.steps:
        yield from (f"stop before {step.name}: {note}" for note in step.stops)
        yield from (f"{step.name}: {each}" for each in (step.compensation, step.note) if each)
        if step.engaged is not None:
            yield f"{step.name}: {step.engaged.sentence}"
    yield from answer.told


def _units(unit: LengthUnit) -> str:
    return f"Lengths in {unit}, feeds in {unit}/min, speeds in rev/min."


def _tool(tool: Tool, unit: LengthUnit) -> list[str]:
    def length(mm: float | None) -> str:
        return NONE if mm is None else shown(mm, unit)

    kind = tool.kind.replace("-", " ")
    return [
        f"{tool.number}",
        f"{tool.name}, {kind}" if tool.name else kind,
        length(tool.diameter),
        NONE if tool.flutes is None else f"{tool.flutes}",
        length(tool.flute_length),
        length(tool.stick_out),
        length(tool.shank_diameter),
    ]


def _step(number: int, step: Step, unit: LengthUnit) -> list[str]:
    tool, scale = step.tool, 1.0 / MM_PER[unit]
    feeds = (f"{each * scale:.{FEED[unit]}f}" for each in (tool.feed, tool.plunge_feed))
    return [
        f"{number}",
        step.name,
        f"{tool.number}",
        f"{tool.spindle_speed:.0f}",
        *feeds,
        f"{step.lowest * scale:.4g}",
        tool.coolant or NONE,
        NONE if step.seconds is None else clock(step.seconds),
    ]


def _columns(heads: Sequence[str], rows: Sequence[Sequence[str]]) -> list[str]:
    table = [heads, *rows]
    widths = [max(len(row[column]) for row in table) for column in range(len(heads))]
    return [
        "  ".join(
            cell.ljust(width) if column == 1 else cell.rjust(width)
            for column, (cell, width) in enumerate(zip(row, widths, strict=True))
        ).rstrip()
        for row in table
    ]


def _table(heads: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    def line(tag: str, cells: Sequence[str]) -> str:
        return f"<tr>{''.join(f'<{tag}>{escape(cell)}</{tag}>' for cell in cells)}</tr>"

    return f"<table>{line('th', heads)}{''.join(line('td', row) for row in rows)}</table>"
