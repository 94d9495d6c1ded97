"""Answer of `camgeo setup`: the setup sheet of a milling program, which is simulated for it."""

from __future__ import annotations

import argparse
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from html import escape
from pathlib import Path
from typing import Final

from camgeo.app.answers.answer import (
    BROKEN,
    FEATURE,
    FINE,
    MARKS,
    SCENE,
    Answer,
    Key,
    Keys,
    aligned,
)
from camgeo.app.cli.command import (
    SCENE_FILE,
    draw_figure,
    notify_main_disc,
    opened,
    output_options,
    show,
    write_files,
)
from camgeo.design.design import Design
from camgeo.design.milled import compared
from camgeo.design.product import Product, product_sides, side_programs
from camgeo.errors import GeometryError
from camgeo.milling.compensation import offset_limits
from camgeo.milling.judged import Feature
from camgeo.milling.machine import Machine, load
from camgeo.milling.machining_time import OperationTime, machine_times
from camgeo.milling.milling import (
    CLAMPS,
    FIXTURE,
    ONION_SKIN,
    SCREWS,
    TABS,
    TURNING_NOTE,
    Clamp,
    Heights,
    Holding,
    Tool,
)
from camgeo.milling.moves import Operation, Stop, Toolpath, Zero, described
from camgeo.milling.plan import OperationEngagement
from camgeo.milling.planned import SEQUENCE
from camgeo.milling.simulation import Flaw
from camgeo.scene.scene import Scene
from camgeo.units import MM_PER, LengthUnit, clock, counted, in_unit

DECIMALS: Final[dict[LengthUnit, int]] = {"mm": 4, "inch": 6}
"""Decimals of lengths in words."""


@dataclass(frozen=True, slots=True)
class OperationRow:
    """One operation, in its order.

    Attributes
    ----------
    operation : the operation itself.
    seconds : its machining time; None where the machine's dynamics are not known.
    engaged : engagement of its cutter; None unless it clears an area.
    compensation : what to enter as the offset of its tool, and within which limits; may be empty.
    base : Z of the program's zero above the upper face of the part [mm].
    """

    operation: Operation
    seconds: float | None
    engaged: OperationEngagement | None = None
    compensation: str = ""
    base: float = 0.0

    @property
    def lowest(self) -> float:
        """Lowest Z of the tool tip, from the program's zero [mm]."""
        # Moves are in coordinates of the part, with Z 0 on its upper face.
        return min(move.end[2] for move in self.operation.travel) - self.base

    @property
    def stops(self) -> tuple[str, ...]:
        """Instructions for the operator at each stop."""
        return tuple(move.note for move in self.operation.moves if isinstance(move, Stop))


@dataclass(frozen=True, slots=True)
class SetupSheet(Answer):
    """A setup sheet.

    Attributes
    ----------
    scene : the scene whose main disc is milled.
    machine : name of the controller.
    work_offset : as the scene states it; empty for the machine's first.
    blank, holding, zero, traverses : in words; lengths in the unit of the scene.
    tools : each once, in the order in which they are called.
    steps : the operations.
    remarks : sentences on what is not milled, and what is left to be done.
    flaws : found by the simulation, including what the machinist has to watch.
    features : of the part, with the operations of all its sides; empty for a second side.
    side : which side this is, and how the work lies, in words; None if there is but one.
    second : the sheet of the second side; None if there is none, or if this is it.
    """

    scene: Scene
    machine: str
    work_offset: str
    blank: str
    holding: str
    zero: str
    traverses: str
    tools: tuple[Tool, ...]
    steps: tuple[OperationRow, ...]
    remarks: tuple[str, ...]
    flaws: tuple[Flaw, ...]
    features: tuple[Feature, ...] = ()
    side: str | None = None
    second: SetupSheet | None = None

    @property
    def sheets(self) -> tuple[SetupSheet, ...]:
        """The sheets of all sides, the first side first."""
        return (self,) if self.second is None else (self, self.second)

    @property
    def seconds(self) -> float | None:
        """Machining time of all operations; None where it is not known."""
        times = [step.seconds for step in self.steps]
        return None if None in times else math.fsum(time for time in times if time is not None)

    @property
    def exit_code(self) -> int:
        """1 if the program must not be run."""
        watched = (flaw.watched for sheet in self.sheets for flaw in sheet.flaws)
        spoilt = any(feature.severity == "broken" for feature in self.features)
        return FINE if all(watched) and not spoilt else BROKEN


def setup_sheet(design: Design, tolerance: float | None = None) -> SetupSheet:
    """The sheet of the main disc's program, with that of its second side.

    Parameters
    ----------
    tolerance : of the toolpath [mm]; None for that of the scene.

    Raises
    ------
    GeometryError
        With the key of the scene, if it has no program.
    """
    if not design.scene.states_milling:
        raise GeometryError("is not stated: there is no program to set up", key="tool")
    tolerance = design.scene.output.tolerance if tolerance is None else tolerance
    first, *others = product_sides(design.disc)
    sheet = _sheet(design, first, tolerance)
    if not others:
        return sheet
    (second,) = others
    axis = second.milled.zero.turned
    return replace(
        sheet,
        side="first side",
        second=replace(
            _sheet(design, second, tolerance), side=f"second side, the work {TURNING_NOTE[axis]}"
        ),
    )


def _sheet(design: Design, product: Product, tolerance: float) -> SetupSheet:
    """The sheet of one side."""
    milled = product.milled
    toolpath, spec = milled.toolpath(tolerance), milled.spec
    assert spec is not None  # for there is a program
    machine, options = load(milled.gcode.machine), milled.gcode
    zero, unit = milled.zero, design.scene.unit
    sentences = (
        finding.sentence for finding in milled.sequence.findings if finding.name != SEQUENCE
    )
    return SetupSheet(
        design.scene,
        machine.name,
        options.work_offset or next(iter(machine.work_offsets)),
        described(spec.stock, milled.part, zero, unit),
        _holding(spec.holding, zero, unit),
        zero.sentence,
        _traverses(options.heights, zero, unit),
        _tools(toolpath),
        _steps(
            toolpath,
            machine_times(machine, toolpath, tolerance),
            milled.engaged(toolpath),
            machine,
            zero,
            unit,
        ),
        (*sentences, *_programs(product, machine)),
        milled.flaws(toolpath, tolerance),
        compared(milled),
    )


def _steps(
    toolpath: Toolpath,
    times: Sequence[OperationTime] | None,
    engagements: Sequence[OperationEngagement],
    machine: Machine,
    zero: Zero,
    unit: LengthUnit,
) -> tuple[OperationRow, ...]:
    seconds = {} if times is None else {operation.name: operation.seconds for operation in times}
    engaged = {engagement.operation: engagement for engagement in engagements}
    words = machine.compensation
    notes = {
        name: limit.sentence(words, lambda mm: f"{length_text(mm, unit)} {unit}")
        for name, limit in offset_limits(toolpath.operations).items()
        if words is not None
    }
    return tuple(
        OperationRow(operation, seconds.get(name), engaged.get(name), notes.get(name, ""), zero.z)
        for name, operation in ((operation.name, operation) for operation in toolpath.operations)
    )


def _programs(side: Product, machine: Machine) -> Iterator[str]:
    """A sentence per program file with its operations, where a machine needs one for each tool."""
    products = side_programs(side)
    for program in products if len(products) > 1 else ():
        names = ", ".join(cut.name for cut in program.milled.cuts)
        tool = program.milled.cuts[0].tool.number
        yield f"{program.name}{machine.extension}: {names}, with tool {tool} in the spindle"


def _tools(toolpath: Toolpath) -> tuple[Tool, ...]:
    tools: dict[int, Tool] = {}
    for operation in toolpath.operations:
        tools.setdefault(operation.tool.number, operation.tool)
    return tuple(tools.values())


def length_text(mm: float, unit: LengthUnit) -> str:
    """A length in the unit of the scene, to a ten-thousandth of a millimetre."""
    return f"{round(mm / MM_PER[unit], DECIMALS[unit]) + 0.0:g}"


def _holding(holding: Holding | None, zero: Zero, unit: LengthUnit) -> str:
    """The holding in words, from the program's zero."""
    if holding is None:
        return "not stated; no cut goes through"
    length = partial(length_text, unit=unit)
    tabs, skin = holding.tabs, holding.skin
    words = {
        FIXTURE: "from below: vacuum, tape, soft jaws or a chuck",
        TABS: "" if tabs is None
        else f"{tabs.count} tabs, {length(tabs.width)} x {length(tabs.height)} {unit}",
        ONION_SKIN: "" if skin is None else f"a skin of {length(skin)} {unit}",
        CLAMPS: "clamps",
        SCREWS: "screws",
    }[holding.kind]  # fmt: skip
    places = "; ".join(_clamp(clamp, zero, unit) for clamp in holding.clamps)
    through = holding.through
    below = f"; cuts go {length(through)} {unit} below the part" if through else ""
    return f"{words}{': ' if places else ''}{places}{below}"


def _clamp(clamp: Clamp, zero: Zero, unit: LengthUnit) -> str:
    """Place of a clamp from the program's zero, its height, and the operations that it is there
    for.
    """
    length, place = partial(length_text, unit=unit), zero.to_program(clamp.place)
    where = f"{clamp.what} at {length(place.real)}, {length(place.imag)} {unit}"
    since = f", from {clamp.since} on" if clamp.since else ""
    until = f", until {clamp.until}" if clamp.until else ""
    return f"{where}, top at Z {length(clamp.height - zero.z)}{since}{until}"


def _traverses(heights: Heights, zero: Zero, unit: LengthUnit) -> str:
    """Heights of the traverses in words, from the program's zero."""
    clearance, retract = (
        length_text(height - zero.z, unit) for height in (heights.clearance, heights.retract)
    )
    if retract == clearance:
        return f"at Z {clearance}"
    return f"at Z {clearance} between operations, at Z {retract} within them"


# -- document -------------------------------------------------------------------------------------
# The keys of its JSON document.


TOOL: Final = Key(
    "A tool, lengths in mm.",
    {
        "number": "Number in the tool table.",
        "name": "Name that the scene states; may be empty.",
        "kind": "Kind of tool.",
        "diameter": "Diameter of the tool.",
        "flutes": "Number of cutting edges; null if not stated.",
        "flute_length": "Length of the cutting edges; null if not stated.",
        "stick_out": "Distance from the tip to the holder; null if not stated.",
        "shank_diameter": "Diameter above the cutting edges; null if not stated.",
    },
)

ENGAGEMENT: Final = Key(
    "Engagement of the cutter at the last depth of an operation that clears an area, without the"
    " entries.",
    {
        "air": "Share of the length in no material.",
        "usual_deg": "Angle that is not exceeded on 99.5 % of the length.",
        "largest_deg": "Largest angle.",
        "limit_deg": "Limit of the tool, or the angle at a straight wall with the stepover.",
    },
)

OPERATION: Final = Key(
    "An operation.",
    {
        "name": Key("Name of the operation.", of="operation.name"),
        "tool": Key("Number of the tool.", of="operation.tool.number"),
        "spindle_speed": Key("Spindle speed [rev/min].", of="operation.tool.spindle_speed"),
        "feed": Key("Feed in the plane [mm/min].", of="operation.tool.feed"),
        "plunge_feed": Key(
            "Feed when plunging into material [mm/min].", of="operation.tool.plunge_feed"
        ),
        "lowest": "Lowest Z of the tool tip, mm.",
        "seconds": "Machining time; null if the dynamics of the machine are not known.",
        "compensation": (
            "What to enter as the offset of its tool, and within which limits; empty without"
            " compensation."
        ),
        "stops": "Instructions for the operator at each stop.",
        "note": Key("Note for the operator; may be empty.", of="operation.cut.note"),
        "engagement": Key(
            "How the cutter is engaged; null if it clears no area.", ENGAGEMENT, of="engaged"
        ),
    },
)

FLAW: Final = Key(
    "What a machinist would not accept.",
    {
        "name": "Kind of flaw: rapid, plunge, gouge, obstacle, depth, shank, loose, rest.",
        "operation": "The operation in which it arises.",
        "sentence": "The flaw in words, lengths in the unit of the scene.",
        "value": "The simulated value.",
        "limit": "The allowed value.",
        "unit": "Unit of value and limit.",
        "place": "X, Y and Z [mm].",
        "watched": (
            "Whether it is no fault, but something for the machinist to watch: a piece that a"
            " fixture must hold, or a rest that stated operations leave."
        ),
    },
)

SHEET: Final[Keys] = {
    "work_offset": "The work offset, as in scenes.",
    "blank": "The blank in words, lengths in the unit of the scene.",
    "zero": "The zero of the program, in words.",
    "holding": "The holding in words, lengths in the unit of the scene.",
    "traverses": "Heights of the traverses, in words, in the unit of the scene.",
    "seconds": (
        "Machining time of all operations; null if the dynamics of the machine are not known."
    ),
    "tools": Key("The tools, each once, in the order in which they are called.", TOOL),
    "operations": Key("The operations, in their order.", OPERATION, of="steps"),
    "told": Key("What is not milled, and what is left to be done; a sentence each.", of="remarks"),
    "flaws": Key("Found by the simulation, including what the machinist has to watch.", FLAW),
}
"""Keys of the sheet of either side."""

SECOND_SIDE: Final = Key(
    "The sheet of the second side, as the work then lies.",
    {
        "side": Key("Which side this is, and how the work lies, in words.", type=str),
        **SHEET,
    },
)

DOCUMENT: Final = Key(
    "The setup sheet of a milling program.",
    {
        "scene": SCENE,
        "machine": "Name of the controller.",
        **SHEET,
        "features": Key(
            "The part, feature by feature, with the operations of all its sides.", FEATURE
        ),
        "side": Key(
            "Which side this is, and how the work lies, in words. Omitted if there is but one.",
            optional=True,
        ),
        "second_side": Key(
            "The sheet of the second side; omitted if there is none.",
            SECOND_SIDE,
            of="second",
            optional=True,
        ),
    },
    type=SetupSheet,
)


# -- rendering ------------------------------------------------------------------------------------
# The setup sheet as text, and as one HTML page that needs nothing else.


NONE: Final = "-"
"""Printed where no value is stated."""

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
    lines += [f"   {remark}" for remark in _remarks(answer)]
    marks = {True: MARKS["warning"], False: "FLAW"}
    flaws = [f"{marks[flaw.watched]:8}{flaw.name:10}{flaw.sentence}" for flaw in answer.flaws]
    lines += [""] * bool(answer.features)
    lines += [f"{MARKS[feature.severity]:8}{feature.sentence}" for feature in answer.features]
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
    remarks = "".join(f"<li>{escape(remark)}</li>" for remark in _remarks(answer))
    listed = f"<ul>{remarks}</ul>" if remarks else ""
    unit = answer.scene.unit
    features = "".join(
        _item(feature.sentence, unit, flaw=feature.severity != "ok") for feature in answer.features
    )
    part = f"<h2>Part</h2>\n<ul>{features}</ul>\n" if features else ""
    flaws = "".join(_item(flaw.sentence, unit, flaw=True) for flaw in answer.flaws)
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
    facts = [
        ("blank" if answer.second is not None or answer.side is None else "work", answer.blank),
        ("zero", answer.zero),
        ("offset", answer.work_offset),
        ("held", answer.holding),
        ("traverses", answer.traverses),
    ]
    if answer.seconds is not None:
        facts.append(("time", f"{clock(answer.seconds)}, excluding tool changes"))
    return facts


def _verdict(answer: SetupSheet) -> str:
    steps = counted(len(answer.steps), "operation")
    unlike = any(feature.severity == "broken" for feature in answer.features)
    gouge = "more is taken off than the part states" if unlike else "no gouge"
    return f"Simulated: {steps}, {gouge}, no material left standing, nothing comes loose."


def _remarks(answer: SetupSheet) -> Iterator[str]:
    """Notes to the operator on each operation, then those on the whole sequence."""
    for step in answer.steps:
        yield from (f"stop before {step.operation.name}: {note}" for note in step.stops)
        name, notes = step.operation.name, (step.compensation, step.operation.cut.note)
        yield from (f"{name}: {remark}" for remark in notes if remark)
        if step.engaged is not None:
            yield f"{name}: {step.engaged.sentence}"
    yield from answer.remarks


def _units(unit: LengthUnit) -> str:
    return f"Lengths in {unit}, feeds in {unit}/min, speeds in rev/min."


def _tool(tool: Tool, unit: LengthUnit) -> list[str]:
    def length(mm: float | None) -> str:
        return NONE if mm is None else length_text(mm, unit)

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


def _step(number: int, step: OperationRow, unit: LengthUnit) -> list[str]:
    tool, scale = step.operation.tool, 1.0 / MM_PER[unit]
    feeds = (f"{feed * scale:.{FEED[unit]}f}" for feed in (tool.feed, tool.plunge_feed))
    return [
        f"{number}",
        step.operation.name,
        f"{tool.number}",
        f"{tool.spindle_speed:.0f}",
        *feeds,
        f"{step.lowest * scale:.4g}",
        tool.coolant or NONE,
        NONE if step.seconds is None else clock(step.seconds),
    ]


def _columns(heads: Sequence[str], rows: Sequence[Sequence[str]]) -> list[str]:
    # The second column has names, all others numbers.
    return aligned([heads, *rows], {*range(len(heads))} - {1})


def _table(heads: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    def line(tag: str, cells: Sequence[str]) -> str:
        return f"<tr>{''.join(f'<{tag}>{escape(cell)}</{tag}>' for cell in cells)}</tr>"

    return f"<table>{line('th', heads)}{''.join(line('td', row) for row in rows)}</table>"


# -- command line ----------------------------------------------------------------------------------


EXAMPLE: Final = "camgeo setup fixtures/scenes/setzhub.toml -o setzhub.html"


ARGUMENTS: Final = (
    SCENE_FILE,
    *output_options("page to write, .html; default: print to the terminal", (".html",)),
)


def run(arguments: argparse.Namespace) -> int:
    """Print the sheet, and write the page."""
    from camgeo.pictures import backplot

    design = opened(arguments)
    sheet = setup_sheet(design)
    if arguments.output is not None:
        picture = svg_element(draw_figure(backplot.figure(design.disc), ".svg"))
        page = html(sheet, picture).encode("utf-8")
        write_files([(Path(arguments.output), page, "setup sheet")], arguments)
    notify_main_disc(design, "operations")
    return show(sheet, arguments)
