"""What a notebook shows of camgeo's objects: HTML, or a picture in front ends without HTML."""

from __future__ import annotations

import base64
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import singledispatch
from html import escape
from itertools import starmap
from typing import Any, Final, cast

from camgeo.app.answers import answer
from camgeo.app.answers.answer import MANY, MARKS, Answer, findings_summary
from camgeo.app.answers.check import Check
from camgeo.app.answers.compare import Compare
from camgeo.app.answers.laws import Laws
from camgeo.app.answers.report import Report, advised, next_step
from camgeo.app.answers.sweep import Sweep
from camgeo.app.answers.table import ValueTable
from camgeo.app.answers.verify import Verification
from camgeo.check.finding import Finding, Findings, LazyFindings, Severity, Verdict
from camgeo.check.judge import Judgement
from camgeo.design.design import Design
from camgeo.design.value_table import Table
from camgeo.design.writing import Report as Written
from camgeo.dynamics.effects.effect import Result
from camgeo.errors import CamgeoError
from camgeo.kinematics.laws.law import Law
from camgeo.pictures import plots
from camgeo.pictures.model import Figure
from camgeo.record import Displayed
from camgeo.units import counted


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
        found = Shown(heading(repr(value)) + preformatted(str(error)))
    html, png = found.html, None
    if found.figure is not None:
        from camgeo_export.plots import render as drawn  # many objects have no picture

        png = drawn(found.figure, ".png")
        html += picture(png, found.figure.size[0], found.told)
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
        figure, why = None, preformatted(str(error))
    head = heading(value.name, findings_summary(value.findings))
    told = "".join(map(paragraph, stated))
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
    table = findings(wrong) if wrong else ""
    several = Counter[str](each.verdict for _, each, _ in right)
    told = ", ".join(counted(several[each], MARKS[each], MANY[each]) for each in several)
    return table + (folded(told, findings(right)) if right else "")


@shown.register
def _(value: Finding) -> Shown:
    return Shown(findings([("", value, next_step(value, ()))]))


@shown.register
def _(value: Findings | LazyFindings) -> Shown:
    found = [("", each, next_step(each, ())) for each in value]
    return Shown(findings(found) if found else paragraph("no findings"))


@shown.register
def _(value: Judgement) -> Shown:
    return Shown(paragraph(findings_summary(value.findings)), below=_findings(value.findings))


@shown.register
def _(value: Result) -> Shown:
    return shown(Findings(value.findings))


@shown.register
def _(value: Table) -> Shown:
    return Shown(values(value))


@shown.register
def _(value: Figure) -> Shown:
    return Shown("", value, value.texts[0].text if value.texts else "figure")


@shown.register
def _(value: Law) -> Shown:
    return shown(Laws.from_law(value))


@shown.register
def _(value: Answer) -> Shown:
    """Its text, and its picture if answers of this kind have one."""
    words = preformatted(answer.text(value))
    if not answer.has(value, "figure"):
        return Shown(words)
    return Shown(words, answer.figure(value), f"picture of camgeo {value.command}")


@shown.register
def _(value: Check) -> Shown:
    found = [(each.subject, each.finding, each.step) for each in advised(value)]
    items = "".join(f"<li>{escape(each.statement)}</li>" for each in value.cures)
    listed = f"<p>Each of these cures the fault that it names:</p><ul>{items}</ul>" if items else ""
    return Shown(heading(value.scene.name) + findings(found) + listed + _as_text(value))


def _as_text(value: Answer) -> str:
    """What the command prints; it has numbers that the table lacks."""
    return folded("as text", preformatted(answer.text(value)))


@shown.register
def _(value: Report) -> Shown:
    """The findings, and a sentence on each diagram; the page has the rest."""
    checked = shown(value.check)
    told = [f"{each.title}: {each.sentence}" for each in value.charts]
    told += [f"left out: {each}" for each in value.omissions]
    return Shown(checked.html + "".join(map(paragraph, told)))


@shown.register
def _(value: ValueTable) -> Shown:
    return shown(value.table)


@shown.register
def _(value: Laws) -> Shown:
    """The characteristic values of laws side by side, or the families for each task."""
    if value.rows is None:
        rows = (
            (each.task, " to ".join(each.ends), ", ".join(each.families))
            for each in value.tasks or ()
        )
        return Shown(texts((("task", "from, to", "laws"), *rows)))
    tables = "".join(map(texts, filter(None, (value.cells, value.physical_cells))))
    return Shown(
        tables + _as_text(value),
        answer.figure(value),
        "f', f'', f''' and f' f'' of each law over the move",
    )


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
    below = findings(told) if told else ""
    folder = {str(path.parent) for path in value.paths}
    return Shown(rows_of(heads, rows, numbers=False) + paragraph(", ".join(sorted(folder))) + below)


@shown.register
def _(value: Verification) -> Shown:
    """Each file with its verdict and the checks that it fails; the list of all checks is folded."""
    rows = []
    for path, verdict in zip(value.paths, value.verdicts, strict=True):
        failed = [f"{each.name} {each.of}".rstrip() for each in verdict.checks if each.ok is False]
        off, tolerance = verdict.deviation, verdict.tolerance
        rows.append(
            (
                badge("ok", "pass") if verdict.passed else badge("broken", "FAIL"),
                escape(path.name),
                "-" if off is None else f"{off:.3g}",
                "-" if tolerance is None else f"{tolerance[0]:g}, by {escape(tolerance[1])}",
                escape(", ".join(failed)),
            )
        )
    heads = ("verdict", "file", "deviation [mm]", "tolerance [mm]", "fails")
    return Shown(rows_of(heads, rows, numbers=False) + _as_text(value))


@shown.register
def _(value: Sweep) -> Shown:
    """The rows of a small family; for a larger one, what the command prints."""
    rows = value.cells
    return Shown(texts(rows) if rows else preformatted(answer.text(value)))


@shown.register
def _(value: Compare) -> Shown:
    """Keys that differ, verdicts and findings, a column for each design."""
    rows = [
        [escape(each.key), *(escape(text) or "-" for text in each.values)] for each in value.keys
    ]
    if any(each.verdict for each in value.designs):
        verdicts = [badge(cast("Severity", each.verdict)) for each in value.designs]
        rows.append(["verdict", *verdicts])
    units = [each.design.scene.unit for each in value.designs]
    for line in value.lines:
        told = (cell.words(unit) for cell, unit in zip(line.cells, units, strict=True))
        rows.append([escape(line.name), *starmap(_marked, told)])
    heads = ["", *(each.label for each in value.designs)]
    reasons = dict.fromkeys(one.reason for line in value.lines for one in line.cells if one.reason)
    table = rows_of(heads, rows, numbers=False) + "".join(map(paragraph, reasons))
    return Shown(table, answer.figure(value), "flanks and curves of the designs over each other")


def _marked(words: str, severity: str) -> str:
    mark = badge(cast("Severity", severity)) if severity else ""
    return " ".join(filter(None, (escape(words), mark)))


# -- markup ---------------------------------------------------------------------------------------
# The HTML of a notebook: tables, pictures and words, with every text escaped.
#
# There are no scripts, no style sheets and no text colours: it can be read on light and dark pages,
# and a front end that does not trust a notebook removes nothing that matters.


FIRST_ROWS, LAST_ROWS = 12, 4
"""Rows of a long table that are shown, from its beginning and from its end."""

DIGITS: Final = 6
"""Significant digits of its numbers."""

NUMBERS: Final = "text-align:right;font-variant-numeric:tabular-nums;white-space:nowrap"
"""Of a table; its cells inherit it."""

TEXTS: Final = ' style="text-align:left;vertical-align:top"'
"""Of each cell: front ends align cells to the right."""

ALIGNED: Final = (
    "font-family:monospace;white-space:pre;word-break:normal;overflow-x:auto;line-height:1.3"
)
"""Of text in columns, which front ends would wrap and set like sentences."""

BADGE: Final = "padding:0 .4em;border-radius:.2em;white-space:nowrap;font-weight:bold"

BADGES: Final[dict[Verdict, tuple[str, str]]] = {
    "invalid": ("✗", f"{BADGE};background:#a3121f;color:#fff"),
    "no-disc": ("✗", f"{BADGE};background:#a3121f;color:#fff"),
    "broken": ("✗", f"{BADGE};background:#a3121f;color:#fff"),
    "warning": ("!", f"{BADGE};background:#ffd257;color:#241a00"),
    "ok": ("✓", "white-space:nowrap"),
    "figure": ("=", "white-space:nowrap"),
    "note": ("–", "white-space:nowrap"),
}
"""Sign and style of a verdict; its word says the same as its colours."""


def paragraph(text: str) -> str:
    """A text."""
    return f"<p>{escape(text)}</p>"


def heading(text: str, more: str = "") -> str:
    """The name of what is shown, and what it is; not a heading of the page around it."""
    return f"<p><strong>{escape(text)}</strong>{f', {escape(more)}' if more else ''}</p>"


def preformatted(text: str) -> str:
    """Lines that are aligned by spaces."""
    return f'<pre style="{ALIGNED}">{escape(text)}</pre>'


def folded(summary: str, content: str) -> str:
    """Content that opens at a click."""
    return f"<details><summary>{escape(summary)}</summary>{content}</details>"


def picture(png: bytes, width: float, told: str) -> str:
    """A picture at most `width` [inch] wide, with alternative text; on white, whatever the page."""
    data = base64.b64encode(png).decode()
    return (
        f'<img src="data:image/png;base64,{data}" alt="{escape(told)}" width="{96.0 * width:.0f}"'
        ' style="max-width:100%;height:auto;background:#fff">'
    )


def rows_of(heads: Sequence[str], rows: Iterable[Sequence[str]], *, numbers: bool) -> str:
    """A table of cells that are already HTML, below headings that are escaped here."""
    style = "" if numbers else TEXTS
    head = "".join(f'<th scope="col"{style}>{escape(each)}</th>' for each in heads)
    cells = ("".join(f"<td{style}>{cell}</td>" for cell in row) for row in rows)
    body = "".join(f"<tr>{row}</tr>" for row in cells)
    whole = f' style="{NUMBERS}"' if numbers else ""
    return (
        f'<div style="overflow-x:auto" tabindex="0"><table{whole}>'
        f"<thead><tr>{head}</tr></thead><tbody>{body}</tbody></table></div>"
    )


def texts(rows: Sequence[Sequence[str]]) -> str:
    """A table of texts, which are escaped here, below the headings in the first row."""
    return rows_of(rows[0], (list(map(escape, row)) for row in rows[1:]), numbers=False)


def badge(verdict: Verdict, word: str = "") -> str:
    """A verdict as sign and word, by default its own word."""
    sign, style = BADGES[verdict]
    return f'<span style="{style}">{sign} {escape(word or MARKS[verdict])}</span>'


def findings(found: Iterable[tuple[str, Finding, str]]) -> str:
    """A table of findings, each with what was judged and with its next step.

    Empty columns are left out.
    """
    told = [
        (badge(each.verdict), *map(escape, (about, each.name, each.sentence, step)))
        for about, each, step in found
    ]
    heads = ("verdict", "of", "finding", "in words", "next step")
    kept = [k for k in range(len(heads)) if any(row[k] for row in told)]
    rows = [[row[k] for k in kept] for row in told]
    return rows_of([heads[k] for k in kept], rows, numbers=False)


def values(table: Table) -> str:
    """A table of numbers, a long one cut to its beginning and end, with the number of rows."""
    count = len(table.values)
    shown = [*range(count)]
    if count > FIRST_ROWS + LAST_ROWS + 1:
        shown = [*range(FIRST_ROWS), *range(count - LAST_ROWS, count)]
    rows = [[f"{value + 0.0:.{DIGITS}g}" for value in table.values[k].tolist()] for k in shown]
    if len(shown) < count:
        rows.insert(FIRST_ROWS, ["⋮"] * len(table.names))
    return rows_of(table.names, rows, numbers=True) + paragraph(
        f"{counted(count, 'row')}, {counted(len(table.names), 'column')}"
    )
