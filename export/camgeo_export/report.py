"""The page of `camgeo report`: one HTML file that needs nothing else, neither network nor server.

Every text of a scene is escaped, or is data that the script makes into text nodes. The policy in
the page allows its own scripts and style, by their hashes, and nothing to be loaded. Without the
script, findings, tables and sentences are there; diagrams and the turning mechanism are drawn by it
from figures as data. The same report gives the same bytes.
"""

from __future__ import annotations

import base64
import hashlib
import json
import math
from collections.abc import Iterable, Mapping, Sequence
from html import escape
from typing import Any, Final

from camgeo import __version__
from camgeo.app.answers.answer import MARKS, findings_summary
from camgeo.app.answers.report import STEP, Report, triangles
from camgeo.design.value_table import Table
from camgeo.pictures import accuracy
from camgeo.pictures.model import figure_data
from camgeo.pictures.motion import format_value, plain
from camgeo.pictures.plots import Chart
from camgeo.studies.accuracy.benefit import advice
from camgeo.studies.accuracy.survey import Survey
from camgeo.units import MM_PER, LengthUnit, counted, in_unit
from camgeo_export.browser.bundles import bundle

DIGITS: Final = 6
"""Significant digits of coordinates in diagrams: finer than a printed line."""

ABREAST: Final = 7
"""Columns of the value table beside the cam angle, as many as a sheet holds."""

SPEEDS: Final = (30, 15, 8, 4, 2)
SPEED: Final = 8
"""Durations of one revolution [s] that can be chosen, and the one that is chosen at first."""

VIEWS: Final = (
    ("left", "Left"), ("right", "Right"), ("up", "Up"), ("down", "Down"),
    ("closer", "Closer"), ("farther", "Farther"), ("back", "Back"),
)  # fmt: skip
"""Ways to look at a solid, with their names."""

CANVAS: Final = (1280, 800)
"""Pixels of a solid's picture."""

NAMES: Final = {
    "mechanism": "Mechanism",
    "findings": "Findings",
    "diagrams": "Diagrams",
    "solid": "Solid",
    "table": "Value table",
    "prices": "Price list of accuracy",
    "certificate": "Certificate",
    "left-out": "Left out",
}
"""Headings by the identifiers of the sections."""


def render(report: Report) -> bytes:
    """The page of a report, as HTML."""
    scripts = [bundle("report.js"), *([bundle("solid.js")] if report.solids else [])]
    style = bundle("report.css")
    sections = {
        "mechanism": _mechanism(report),
        "findings": _findings(report),
        "diagrams": _diagrams(report.charts),
        "solid": _solids(report.solids),
        "table": "" if report.table is None else _values(report.table),
        "prices": "" if report.prices is None else _prices(report.prices, report.scene.unit),
        "certificate": _certificate(report),
        "left-out": _items(report.omissions),
    }
    there = {name: content for name, content in sections.items() if content}
    links = "".join(f'<li><a href="#{name}-section">{NAMES[name]}</a></li>' for name in there)
    body = "".join(
        f'<section id="{name}-section" aria-labelledby="{name}-title">'
        f'<h2 id="{name}-title">{NAMES[name]}</h2>{content}</section>\n'
        for name, content in there.items()
    )
    name = escape(report.scene.name)
    policy = (
        f"default-src 'none'; script-src {' '.join(map(_hash, scripts))};"
        f" style-src {_hash(style)};"
        " base-uri 'none'; form-action 'none'"
    )
    return f"""<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta http-equiv="Content-Security-Policy" content="{policy}">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>{name}: cam report</title>
<style>{style}</style>
</head>
<body>
<header>
<h1>{name}</h1>
<p>{escape(findings_summary(entry.finding for entry in report.advised))}.</p>
<p>camgeo {escape(__version__)}, scene {escape(report.scene.made)}</p>
<nav aria-label="Sections"><ul>{links}</ul></nav>
<noscript><p>Diagrams and the turning mechanism need scripts.</p></noscript>
</header>
<main>
{_controls()}{body}</main>
<script type="application/json" id="data">{_data(report)}</script>
{"".join(f"<script>{script}</script>" for script in scripts)}
</body>
</html>
""".encode()


def _hash(text: str) -> str:
    return f"'sha256-{base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()}'"


def _data(report: Report) -> str:
    """What the script draws, as JSON that ends no element."""
    prices = None
    if report.prices is not None:
        unit = report.scene.unit
        figure = accuracy.figure(report.prices, title="", computing=False, length=unit)
        sentence = in_unit(advice(report.prices.knee), unit)
        prices = {"figure": figure.to_data(), "sentence": sentence}
    content = {
        "animation": None if report.animation is None else report.animation.to_data(),
        "charts": [
            {"figure": figure_data(chart.figure), "sentence": chart.sentence}
            for chart in report.charts
        ],
        "prices": prices,
        "solids": [{"places": triangles(data)} for data in report.solids.values()],
    }
    text = json.dumps(_rounded(content), ensure_ascii=False, allow_nan=False, separators=(",", ":"))
    # These characters could end the script element, or a line in it.
    for character in "<>&\u2028\u2029":
        text = text.replace(character, f"\\u{ord(character):04x}")
    return text


def _rounded(value: Any) -> Any:
    """`value` with its numbers rounded to `DIGITS` significant digits."""
    if isinstance(value, dict):
        return {key: _rounded(member) for key, member in value.items()}
    if isinstance(value, list):
        return [_rounded(element) for element in value]
    if isinstance(value, float):
        number = float(f"{value:.{DIGITS}g}")
        # Whole numbers are shorter without a fraction.
        return int(number) if number == int(number) else number
    return value


def _mechanism(report: Report) -> str:
    if report.animation is None:
        return "<p>There is no mechanism to show.</p>"
    note = f" {escape(report.animation.note)}." if report.animation.note else ""
    return (
        '<figure id="mechanism"><figcaption>The disc with pitch curve and base circle, the'
        f" follower and what it drives, to scale.{note}</figcaption></figure>"
    )


def _controls() -> str:
    """The cam angle, which the mechanism and all diagrams share."""
    speeds = "".join(
        f'<option value="{time}"{" selected" if time == SPEED else ""}>a turn in {time} s</option>'
        for time in SPEEDS
    )
    return f"""<div class="controls" role="group" aria-label="Cam angle">
<button type="button" id="play" aria-pressed="false">Play</button>
<label>Speed <select id="speed">{speeds}</select></label>
<label class="scrub">Cam angle
<input type="range" id="angle" min="0" max="360" step="0.5" value="0"></label>
<label><input type="number" id="degrees" min="0" max="360" step="any" value="0"
 aria-label="Cam angle in degrees"> °</label>
<p id="state" aria-live="polite"></p>
</div>
"""


def _findings(report: Report) -> str:
    rows = [
        f'<tr><td class="severity {entry.finding.severity}">{MARKS[entry.finding.verdict]}</td>'
        + "".join(
            f"<td>{escape(text)}</td>"
            for text in (
                entry.subject,
                entry.finding.name,
                entry.finding.sentence,
                entry.step or "none",
            )
        )
        + "</tr>"
        for entry in report.advised
    ]
    heads = ("verdict", "subject", "finding", "description", "next step")
    remedies = [cure.statement for cure in report.check.cures]
    listed = (
        f"<p>Each of these remedies removes the fault that it names:</p>{_items(remedies)}"
        if remedies
        else ""
    )
    return _table("Table of findings", heads, rows) + listed


def _diagrams(charts: Sequence[Chart]) -> str:
    return "".join(
        f'<figure class="chart" id="chart-{number}"><figcaption><strong>{escape(chart.title)}'
        f"</strong>: {escape(chart.sentence)}</figcaption>{_readings(chart)}</figure>\n"
        for number, chart in enumerate(charts)
    )


def _readings(chart: Chart) -> str:
    if not chart.readings:
        return ""
    heads = ("curve", "smallest", "at", "largest", "at", "limits drawn")
    rows = []
    for reading in chart.readings:
        limits = "; ".join(f"{name}: {format_value(value)}" for name, value in reading.limits)
        numbers = (
            format_value(reading.low), f"{math.degrees(reading.low_angle):.1f}°",
            format_value(reading.high), f"{math.degrees(reading.high_angle):.1f}°",
        )  # fmt: skip
        rows.append(f"<tr><td>{escape(plain(reading.name))}</td>{_numbers(numbers)}"
                    f"<td>{escape(limits)}</td></tr>")  # fmt: skip
    table = _table(f"Extremes, {chart.title}", heads, rows)
    return f"<details><summary>Extremes as a table</summary>{table}</details>"


def _solids(solids: Mapping[str, bytes]) -> str:
    """A canvas for each body, with buttons for what dragging does."""
    buttons = "".join(
        f'<button type="button" value="{value}">{name}</button>' for value, name in VIEWS
    )
    return "".join(
        f'<figure id="solid-{number}"><canvas width="{CANVAS[0]}" height="{CANVAS[1]}" role="img"'
        f' aria-label="The solid of {escape(name)}"></canvas><div class="views" role="group"'
        f' aria-label="View of {escape(name)}">{buttons}</div><figcaption>{escape(name)}, as camgeo'
        ' build makes it, coarser.<span class="live"> Drag to turn it.</span></figcaption></figure>'
        for number, name in enumerate(solids)
    )


def _values(table: Table) -> str:
    """The value table in blocks of columns, each with the cam angle."""
    first, *others = table.names
    blocks = []
    for start in range(0, len(others), ABREAST):
        names = others[start : start + ABREAST]
        columns = [0, *range(1 + start, 1 + start + len(names))]
        rows = [
            f"<tr>{_numbers(f'{value + 0.0:.{DIGITS}g}' for value in row[columns])}</tr>"
            for row in table.values
        ]
        blocks.append(_table(f"Values from {names[0]} to {names[-1]}", (first, *names), rows))
    return (
        f"<p>One row every {STEP}°; <code>camgeo table</code> gives any step.</p><details><summary>"
        f"{counted(len(table.values), 'row')}</summary>{''.join(blocks)}</details>"
    )


def _prices(survey: Survey, unit: LengthUnit) -> str:
    heads = ("contour", "effort", f"tolerance [{unit}]", "pieces", f"proved deviation [{unit}]",
             "DXF [bytes]", "G-code [bytes]", "milled round [s]")  # fmt: skip
    sentence = in_unit(f"Advice: {advice(survey.knee)}.", unit)
    survey = survey.in_length(unit)
    rows = []
    for row in survey.contours:
        numbers = (
            f"{row.tolerance:.6g}",
            "-" if row.count is None else f"{row.count.pieces:,}",
            "-" if row.count is None else f"{row.count.deviation:.3g}",
            "-" if row.drawing is None else f"{row.drawing.size:,}",
            "-" if row.program is None else f"{row.program.size:,}",
            "-" if row.round_seconds is None else f"{row.round_seconds:.1f}",
        )
        rows.append(f"<tr><td>{escape(row.form)}</td><td>{escape(row.effort)}</td>"
                    f"{_numbers(numbers)}</tr>")  # fmt: skip
    return (
        f'<figure class="chart" id="prices"><figcaption>{escape(sentence)}</figcaption></figure>'
        f"{_table('Pieces, bytes and times', heads, rows)}"
    )


def _certificate(report: Report) -> str:
    certificate = report.certificate
    if certificate is None:
        return ""
    unit = report.scene.unit
    mm = MM_PER[unit]
    heads = ("file", "format", "bytes", f"tolerance [{unit}]", f"proved deviation [{unit}]",
             "SHA-256")  # fmt: skip
    rows = []
    for file in certificate["files"]:
        deviation = file["deviation_mm"]
        numbers = (
            f"{file['bytes']:,}", f"{file['tolerance_mm'] / mm:.6g}",
            "-" if deviation is None else f"{deviation / mm:.3g}",
        )  # fmt: skip
        names = f"<td>{escape(file['file'])}</td><td>{escape(file['format'])}</td>"
        digest = f'<td class="hash">{escape(file["sha256"])}</td>'
        rows.append(f"<tr>{names}{_numbers(numbers)}{digest}</tr>")
    text = escape(json.dumps(certificate, indent=2, ensure_ascii=False))
    table = _table("Table of files", heads, rows)
    return (
        "<p>The files that the scene asks for were made, read back and measured; <code>camgeo"
        f" build</code> writes the same, with this certificate.</p>{table}"
        f'<details><summary>certificate.json</summary><pre class="wide" tabindex="0">{text}'
        "</pre></details>"
    )


def _table(label: str, heads: Sequence[str], rows: Iterable[str]) -> str:
    """A table; `label` must be unique on the page."""
    head = "".join(f'<th scope="col">{escape(heading)}</th>' for heading in heads)
    return (
        f'<div class="wide" tabindex="0" role="region" aria-label="{escape(label)}">'
        f"<table><thead><tr>{head}</tr></thead><tbody>{''.join(rows)}</tbody></table></div>"
    )


def _numbers(cells: Iterable[str]) -> str:
    return "".join(f'<td class="number">{escape(cell)}</td>' for cell in cells)


def _items(texts: Sequence[str]) -> str:
    listed = "".join(f"<li>{escape(text)}</li>" for text in texts)
    return f"<ul>{listed}</ul>" if listed else ""
