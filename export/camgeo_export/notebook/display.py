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
class Rendering:
    """An object as HTML, above its picture.

    Attributes
    ----------
    html : safe to be put into a page.
    figure : the picture; None if there is none.
    description : of the picture, as its alternative text.
    below : HTML below it.
    """

    html: str
    figure: Figure | None = None
    description: str = ""
    below: str = ""


def display(value: Displayed) -> dict[str, str | bytes]:
    """The renderings of an object by media type; a picture is in the HTML too.

    An error of camgeo is shown in place of what it prevents.
    """
    try:
        rendering = make_rendering(value)
    except CamgeoError as error:
        rendering = Rendering(heading(repr(value)) + preformatted(str(error)))
    html, png = rendering.html, None
    if rendering.figure is not None:
        from camgeo_export.plots import render  # many objects have no picture

        png = render(rendering.figure, ".png")
        html += picture(png, rendering.figure.size[0], rendering.description)
    html = f"<div>{html}{rendering.below}</div>"
    return {"text/html": html} | ({} if png is None else {"image/png": png})


@singledispatch
def make_rendering(value: object) -> Rendering:
    """The rendering of an object, by its kind."""
    raise TypeError(f"{type(value).__name__} is not displayed")


@make_rendering.register
def _(value: Design) -> Rendering:
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
    description = "".join(map(paragraph, stated))
    below = _findings(value.findings)
    return Rendering(
        head + description + why, figure, f"{what[0].capitalize()} of {value.name}", below
    )


def _stated(table: Mapping[str, Any]) -> str:
    """The single values in a table of a scene, as stated."""
    single = {key: value for key, value in table.items() if not isinstance(value, Mapping)}
    return ", ".join(f"{key} = {_spelled(value)}" for key, value in single.items())


def _spelled(value: object) -> str:
    if isinstance(value, tuple):
        return f"[{', '.join(map(_spelled, value))}]"
    return str(value).lower() if isinstance(value, bool) else str(value)


def _findings(all_findings: Findings) -> str:
    """The findings that are not "ok", each with its next step; the others are folded."""
    wrong = [
        ("", finding, next_step(finding, ()))
        for finding in all_findings
        if finding.severity != "ok"
    ]
    right = [("", finding, "") for finding in all_findings if finding.severity == "ok"]
    table = findings(wrong) if wrong else ""
    several = Counter[str](finding.verdict for _, finding, _ in right)
    summary = ", ".join(
        counted(several[verdict], MARKS[verdict], MANY[verdict]) for verdict in several
    )
    return table + (folded(summary, findings(right)) if right else "")


@make_rendering.register
def _(value: Finding) -> Rendering:
    return Rendering(findings([("", value, next_step(value, ()))]))


@make_rendering.register
def _(value: Findings | LazyFindings) -> Rendering:
    rows = [("", finding, next_step(finding, ())) for finding in value]
    return Rendering(findings(rows) if rows else paragraph("no findings"))


@make_rendering.register
def _(value: Judgement) -> Rendering:
    return Rendering(paragraph(findings_summary(value.findings)), below=_findings(value.findings))


@make_rendering.register
def _(value: Result) -> Rendering:
    return make_rendering(Findings(value.findings))


@make_rendering.register
def _(value: Table) -> Rendering:
    return Rendering(values(value))


@make_rendering.register
def _(value: Figure) -> Rendering:
    return Rendering("", value, value.texts[0].text if value.texts else "figure")


@make_rendering.register
def _(value: Law) -> Rendering:
    return make_rendering(Laws.from_law(value))


@make_rendering.register
def _(value: Answer) -> Rendering:
    """The text of an answer, and its picture if answers of this kind have one."""
    words = preformatted(answer.text(value))
    if not answer.has(value, "figure"):
        return Rendering(words)
    return Rendering(words, answer.figure(value), f"picture of camgeo {value.command}")


@make_rendering.register
def _(value: Check) -> Rendering:
    rows = [(entry.subject, entry.finding, entry.step) for entry in advised(value)]
    items = "".join(f"<li>{escape(cure.statement)}</li>" for cure in value.cures)
    listed = (
        f"<p>Each of these remedies removes the fault that it names:</p><ul>{items}</ul>"
        if items
        else ""
    )
    return Rendering(heading(value.scene.name) + findings(rows) + listed + _as_text(value))


def _as_text(value: Answer) -> str:
    """What the command prints; it has numbers that the table lacks."""
    return folded("as text", preformatted(answer.text(value)))


@make_rendering.register
def _(value: Report) -> Rendering:
    """The findings, and a sentence on each diagram; the page has the rest."""
    checked = make_rendering(value.check)
    lines = [f"{chart.title}: {chart.sentence}" for chart in value.charts]
    lines += [f"left out: {omission}" for omission in value.omissions]
    return Rendering(checked.html + "".join(map(paragraph, lines)))


@make_rendering.register
def _(value: ValueTable) -> Rendering:
    return make_rendering(value.table)


@make_rendering.register
def _(value: Laws) -> Rendering:
    """The characteristic values of laws side by side, or the families for each task."""
    if value.rows is None:
        rows = (
            (task.task, " to ".join(task.ends), ", ".join(task.families))
            for task in value.tasks or ()
        )
        return Rendering(texts((("task", "from, to", "laws"), *rows)))
    tables = "".join(map(texts, filter(None, (value.cells, value.physical_cells))))
    return Rendering(
        tables + _as_text(value),
        answer.figure(value),
        "f', f'', f''' and f' f'' of each law over the move",
    )


@make_rendering.register
def _(value: Written) -> Rendering:
    """Each file with what is proved about it."""
    heads = ("file", "format", "bytes", "proved deviation [mm]", "tolerance [mm]")
    rows = [
        (
            escape(file.name),
            escape(file.format),
            f"{file.size:,}",
            "-" if file.deviation is None else f"{file.deviation:.3g}",
            f"{file.tolerance:g}",
        )
        for file in value.files
    ]
    notes = [("", finding, "") for file in value.files for finding in file.findings]
    below = findings(notes) if notes else ""
    folder = {str(path.parent) for path in value.paths}
    return Rendering(
        html_table(heads, rows, numbers=False) + paragraph(", ".join(sorted(folder))) + below
    )


@make_rendering.register
def _(value: Verification) -> Rendering:
    """Each file with its verdict and the checks that it fails; the list of all checks is folded."""
    rows = []
    for path, verdict in zip(value.paths, value.verdicts, strict=True):
        failed = [
            f"{check.name} {check.of}".rstrip() for check in verdict.checks if check.ok is False
        ]
        deviation, tolerance = verdict.deviation, verdict.tolerance
        rows.append(
            (
                badge("ok", "pass") if verdict.passed else badge("broken", "FAIL"),
                escape(path.name),
                "-" if deviation is None else f"{deviation:.3g}",
                "-" if tolerance is None else f"{tolerance[0]:g}, by {escape(tolerance[1])}",
                escape(", ".join(failed)),
            )
        )
    heads = ("verdict", "file", "deviation [mm]", "tolerance [mm]", "fails")
    return Rendering(html_table(heads, rows, numbers=False) + _as_text(value))


@make_rendering.register
def _(value: Sweep) -> Rendering:
    """The rows of a small family; for a larger one, what the command prints."""
    rows = value.cells
    return Rendering(texts(rows) if rows else preformatted(answer.text(value)))


@make_rendering.register
def _(value: Compare) -> Rendering:
    """Keys that differ, verdicts and findings, a column for each design."""
    rows = [[escape(key.key), *(escape(text) or "-" for text in key.values)] for key in value.keys]
    if any(design.verdict for design in value.designs):
        verdicts = [badge(cast("Severity", design.verdict)) for design in value.designs]
        rows.append(["verdict", *verdicts])
    units = [design.design.scene.unit for design in value.designs]
    for line in value.lines:
        cells = (cell.words(unit) for cell, unit in zip(line.cells, units, strict=True))
        rows.append([escape(line.name), *starmap(_marked, cells)])
    heads = ["", *(design.label for design in value.designs)]
    reasons = dict.fromkeys(one.reason for line in value.lines for one in line.cells if one.reason)
    table = html_table(heads, rows, numbers=False) + "".join(map(paragraph, reasons))
    return Rendering(
        table, answer.figure(value), "flanks and curves of the designs over each other"
    )


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
"""Style of a table of numbers; its cells inherit it."""

TEXTS: Final = ' style="text-align:left;vertical-align:top"'
"""Style of each cell with text: front ends align cells to the right by default."""

ALIGNED: Final = (
    "font-family:monospace;white-space:pre;word-break:normal;overflow-x:auto;line-height:1.3"
)
"""Style of text in columns, which front ends would wrap and set like sentences."""

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
    """A text as a paragraph."""
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


def picture(png: bytes, width: float, description: str) -> str:
    """A picture at most `width` [inch] wide, with alternative text; on white, whatever the page."""
    data = base64.b64encode(png).decode()
    return (
        f'<img src="data:image/png;base64,{data}" alt="{escape(description)}"'
        f' width="{96.0 * width:.0f}" style="max-width:100%;height:auto;background:#fff">'
    )


def html_table(heads: Sequence[str], rows: Iterable[Sequence[str]], *, numbers: bool) -> str:
    """A table of cells that are already HTML, below headings that are escaped here."""
    style = "" if numbers else TEXTS
    head = "".join(f'<th scope="col"{style}>{escape(text)}</th>' for text in heads)
    cells = ("".join(f"<td{style}>{cell}</td>" for cell in row) for row in rows)
    body = "".join(f"<tr>{row}</tr>" for row in cells)
    whole = f' style="{NUMBERS}"' if numbers else ""
    return (
        f'<div style="overflow-x:auto" tabindex="0"><table{whole}>'
        f"<thead><tr>{head}</tr></thead><tbody>{body}</tbody></table></div>"
    )


def texts(rows: Sequence[Sequence[str]]) -> str:
    """A table of texts, which are escaped here, below the headings in the first row."""
    return html_table(rows[0], (list(map(escape, row)) for row in rows[1:]), numbers=False)


def badge(verdict: Verdict, word: str = "") -> str:
    """A verdict as sign and word, by default its own word."""
    sign, style = BADGES[verdict]
    return f'<span style="{style}">{sign} {escape(word or MARKS[verdict])}</span>'


def findings(judged: Iterable[tuple[str, Finding, str]]) -> str:
    """A table of findings, each with what was judged and with its next step.

    Empty columns are left out.
    """
    cells = [
        (badge(finding.verdict), *map(escape, (subject, finding.name, finding.sentence, step)))
        for subject, finding, step in judged
    ]
    heads = ("verdict", "subject", "finding", "description", "next step")
    columns = [k for k in range(len(heads)) if any(row[k] for row in cells)]
    rows = [[row[k] for k in columns] for row in cells]
    return html_table([heads[k] for k in columns], rows, numbers=False)


def values(table: Table) -> str:
    """A table of numbers, a long one cut to its beginning and end, with the number of rows."""
    count = len(table.values)
    indices = [*range(count)]
    if count > FIRST_ROWS + LAST_ROWS + 1:
        indices = [*range(FIRST_ROWS), *range(count - LAST_ROWS, count)]
    rows = [[f"{value + 0.0:.{DIGITS}g}" for value in table.values[k].tolist()] for k in indices]
    if len(indices) < count:
        rows.insert(FIRST_ROWS, ["⋮"] * len(table.names))
    return html_table(table.names, rows, numbers=True) + paragraph(
        f"{counted(count, 'row')}, {counted(len(table.names), 'column')}"
    )
