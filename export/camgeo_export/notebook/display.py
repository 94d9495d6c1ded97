"""What a notebook shows of camgeo's objects: HTML, or a picture in front ends without HTML."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import singledispatch
from html import escape
from typing import Any, cast

from camgeo.answers import render
from camgeo.answers.answer import MANY, MARKS, Answer, verdict_on
from camgeo.answers.check import Check
from camgeo.answers.compare import Cell, Compare
from camgeo.answers.laws import UNITS, LawRow, Laws
from camgeo.answers.laws.rendering import HEAD, PHYSICAL_HEAD
from camgeo.answers.report import Report, advised
from camgeo.answers.report.steps import next_step
from camgeo.answers.sweep import Sweep
from camgeo.answers.sweep.rendering import FEW, headed
from camgeo.answers.sweep.rendering import shown as cell
from camgeo.answers.table import ValueTable
from camgeo.answers.verify import Verification
from camgeo.check.finding import Finding, Findings, LazyFindings, Severity
from camgeo.check.judge import Judgement
from camgeo.design import Design
from camgeo.displayed import Displayed
from camgeo.effects.effect import Result
from camgeo.errors import CamgeoError
from camgeo.figure import plots
from camgeo.figure.model import Figure
from camgeo.motion.laws.comparison import QUANTITIES, entry_of
from camgeo.motion.laws.law import Law
from camgeo.product.value_table import Table
from camgeo.wording import counted
from camgeo.writing.write import Report as Written
from camgeo_export.notebook import markup


@dataclass(frozen=True, slots=True)
class Shown:
    """An object as HTML, above its picture.

    Attributes
    ----------
    html : safe to be put into a page.
    figure : the picture; None if there is none.
    told : a description of the picture.
    below : HTML below it.
    """

    html: str
    figure: Figure | None = None
    told: str = ""
    below: str = ""


def display(value: Displayed) -> dict[str, str | bytes]:
    """The renderings of an object by media type; a picture is in the HTML too.

    An error of camgeo is shown in place of what it prevents.
    """
    try:
        found = shown(value)
    except CamgeoError as error:
        found = Shown(markup.heading(repr(value)) + markup.preformatted(str(error)))
    html, png = found.html, None
    if found.figure is not None:
        from camgeo_export.plots.render import render as drawn  # many objects have no picture

        png = drawn(found.figure, ".png")
        html += markup.picture(png, found.figure.size[0], found.told)
    html = f"<div>{html}{found.below}</div>"
    return {"text/html": html} | ({} if png is None else {"image/png": png})


@singledispatch
def shown(value: object) -> Shown:
    """How one kind of object is shown."""
    raise TypeError(f"{type(value).__name__} is not displayed")


@shown.register
def _(value: Design) -> Shown:
    """Name, picture of the cam and findings; of a motion alone its diagrams."""
    scene = value.scene
    stated = [
        f"{table}: {_stated(scene.values[table])}; lengths in {scene.unit}"
        for table in ("follower", "linkage")
        if table in scene.values
    ]
    what = [plots.MOTION if scene.follower is None else plots.CAM]
    try:
        figure, why = plots.of_design(value, what)[0], ""
    except CamgeoError as error:
        figure, why = None, markup.preformatted(str(error))
    head = markup.heading(value.name, verdict_on(value.findings))
    told = "".join(map(markup.paragraph, stated))
    below = _findings(value.findings)
    return Shown(head + told + why, figure, f"{what[0].capitalize()} of {value.name}", below)


def _stated(table: Mapping[str, Any]) -> str:
    """The single values in a table of a scene, as stated."""
    single = {key: value for key, value in table.items() if not isinstance(value, Mapping)}
    return ", ".join(f"{key} = {_spelled(value)}" for key, value in single.items())


def _spelled(value: object) -> str:
    if isinstance(value, tuple):
        return f"[{', '.join(map(_spelled, value))}]"
    return str(value).lower() if isinstance(value, bool) else str(value)


def _findings(found: Findings) -> str:
    """The findings that are not "ok", each with its next step; the others are folded."""
    wrong = [("", each, next_step(each, ())) for each in found if each.severity != "ok"]
    right = [("", each, "") for each in found if each.severity == "ok"]
    table = markup.findings(wrong) if wrong else ""
    several = Counter[str](each.verdict for _, each, _ in right)
    told = ", ".join(counted(several[each], MARKS[each], MANY[each]) for each in several)
    return table + (markup.folded(told, markup.findings(right)) if right else "")


@shown.register
def _(value: Finding) -> Shown:
    return Shown(markup.findings([("", value, next_step(value, ()))]))


@shown.register
def _(value: LazyFindings) -> Shown:
    return shown(Findings(value))


@shown.register
def _(value: Findings) -> Shown:
    found = [("", each, next_step(each, ())) for each in value]
    return Shown(markup.findings(found) if found else markup.paragraph("no findings"))


@shown.register
def _(value: Judgement) -> Shown:
    return Shown(markup.paragraph(verdict_on(value.findings)), below=_findings(value.findings))


@shown.register
def _(value: Result) -> Shown:
    return shown(Findings(value.findings))


@shown.register
def _(value: Table) -> Shown:
    return Shown(markup.values(value))


@shown.register
def _(value: Figure) -> Shown:
    return Shown("", value, value.texts[0].text if value.texts else "figure")


@shown.register
def _(value: Law) -> Shown:
    return shown(Laws((LawRow(entry_of(value)),)))


@shown.register
def _(value: Answer) -> Shown:
    """Its text, and its picture if answers of this kind have one."""
    words = markup.preformatted(render.text(value))
    if not render.has(value, "figure"):
        return Shown(words)
    return Shown(words, render.figure(value), f"picture of camgeo {value.command}")


@shown.register
def _(value: Check) -> Shown:
    found = [(each.about, each.finding, each.step) for each in advised(value)]
    items = "".join(f"<li>{escape(each.statement)}</li>" for each in value.cures)
    listed = f"<p>Each of these cures the fault that it names:</p><ul>{items}</ul>" if items else ""
    table = markup.heading(value.scene.name) + markup.findings(found) + listed
    return Shown(table + _as_text(value))


def _as_text(value: Answer) -> str:
    """What the command prints; it has numbers that the table lacks."""
    return markup.folded("as text", markup.preformatted(render.text(value)))


@shown.register
def _(value: Report) -> Shown:
    """The findings, and a sentence on each diagram; the page has the rest."""
    checked = shown(value.check)
    told = [f"{each.title}: {each.sentence}" for each in value.charts]
    told += [f"left out: {each}" for each in value.left_out]
    return Shown(checked.html + "".join(map(markup.paragraph, told)))


@shown.register
def _(value: ValueTable) -> Shown:
    return shown(value.table)


@shown.register
def _(value: Laws) -> Shown:
    """The characteristic values of laws side by side, or the families for each task."""
    if value.rows is None:
        told = [
            (escape(each.task), escape(" to ".join(each.ends)), escape(", ".join(each.families)))
            for each in value.tasks or ()
        ]
        return Shown(markup.rows_of(("task", "from, to", "laws"), told, numbers=False))
    rows = [[escape(cell) for cell in _of_law(row)] for row in value.rows]
    table = markup.rows_of(("law", "parameters", *HEAD), rows, numbers=False)
    table += _of_move(value.rows) + _as_text(value)
    return Shown(table, render.figure(value), "f', f'', f''' and f' f'' of each law over the move")


def _of_move(rows: Sequence[LawRow]) -> str:
    """The same values of a move at its speed; nothing without one."""
    moved = [(row.entry.name, row.physical) for row in rows if row.physical is not None]
    if not moved:
        return ""
    heads = [f"{symbol} [{unit}]" for symbol, unit in zip(PHYSICAL_HEAD, UNITS, strict=True)]
    found = [
        [
            escape(name),
            *("unbounded" if e is None else f"{e.value + 0.0:.5g}" for e in own.values()),
        ]
        for name, own in moved
    ]
    return markup.rows_of(("law", *heads), found, numbers=False)


def _of_law(row: LawRow) -> list[str]:
    given = ", ".join(f"{name} {value:.6g}" for name, value in row.parameters.items())
    if row.entry.law is None:
        return [row.entry.name, given, row.entry.reason, *[""] * (len(HEAD) - 1)]
    numbers = [row.entry.bounded(each) for each in QUANTITIES]
    cells = ("unbounded" if each is None else f"{each + 0.0:.6g}" for each in numbers)
    return [row.entry.name, given, *cells]


@shown.register
def _(value: Written) -> Shown:
    """Each file with what is proved about it."""
    heads = ("file", "format", "bytes", "proved deviation [mm]", "tolerance [mm]")
    rows = [
        (
            escape(each.name),
            escape(each.format),
            f"{each.size:,}",
            "-" if each.deviation is None else f"{each.deviation:.3g}",
            f"{each.tolerance:g}",
        )
        for each in value.files
    ]
    told = [("", finding, "") for each in value.files for finding in each.findings]
    below = markup.findings(told) if told else ""
    folder = {str(path.parent) for path in value.paths}
    table = markup.rows_of(heads, rows, numbers=False)
    return Shown(table + markup.paragraph(", ".join(sorted(folder))) + below)


@shown.register
def _(value: Verification) -> Shown:
    """Each file with its verdict and the checks that it fails; the list of all checks is folded."""
    rows = []
    for path, verdict in zip(value.paths, value.verdicts, strict=True):
        failed = [f"{each.name} {each.of}".rstrip() for each in verdict.checks if each.ok is False]
        off, tolerance = verdict.deviation, verdict.tolerance
        rows.append(
            (
                markup.badge("ok", "pass") if verdict.passed else markup.badge("broken", "FAIL"),
                escape(path.name),
                "-" if off is None else f"{off:.3g}",
                "-" if tolerance is None else f"{tolerance[0]:g}, by {escape(tolerance[1])}",
                escape(", ".join(failed)),
            )
        )
    heads = ("verdict", "file", "deviation [mm]", "tolerance [mm]", "fails")
    return Shown(markup.rows_of(heads, rows, numbers=False) + _as_text(value))


@shown.register
def _(value: Sweep) -> Shown:
    """The rows of a small family; for a larger one, what the command prints."""
    if value.count > FEW:
        return Shown(markup.preformatted(render.text(value)))
    heads = [*value.keys, *map(headed, value.spans), *(["reason"] if value.failed else [])]
    rows = []
    for each in value.designs:
        cells = [*map(cell, (*each.values.values(), *each.answers.values()))]
        rows.append([escape(text) for text in (*cells, each.reason)][: len(heads)])
    return Shown(markup.rows_of(heads, rows, numbers=False))


@shown.register
def _(value: Compare) -> Shown:
    """Keys that differ, verdicts and findings, a column for each design."""
    rows = [
        [escape(each.key), *(escape(text) or "-" for text in each.values)] for each in value.keys
    ]
    if any(each.verdict for each in value.designs):
        verdicts = [markup.badge(cast("Severity", each.verdict)) for each in value.designs]
        rows.append(["verdict", *verdicts])
    rows += [[escape(line.name), *map(_compared, line.cells)] for line in value.lines]
    heads = ["", *(each.label for each in value.designs)]
    reasons = dict.fromkeys(one.reason for line in value.lines for one in line.cells if one.reason)
    told = "".join(map(markup.paragraph, reasons))
    table = markup.rows_of(heads, rows, numbers=False) + told
    return Shown(table, render.figure(value), "flanks and curves of the designs over each other")


def _compared(found: Cell) -> str:
    text = "-" if found.value is None else f"{cell(found.value)} {found.unit}".rstrip()
    if found.severity in ("", "ok"):
        return escape(found.verdict if found.value is None and found.verdict else text)
    mark = markup.badge(cast("Severity", found.severity))
    return mark if found.value is None else f"{escape(text)} {mark}"
