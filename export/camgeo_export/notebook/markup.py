"""The HTML of a notebook: tables, pictures and words, with every text escaped.

There are no scripts, no style sheets and no text colours: it can be read on light and dark pages,
and a front end that does not trust a notebook removes nothing that matters.
"""

from __future__ import annotations

import base64
from collections.abc import Iterable, Sequence
from html import escape
from typing import Final

from camgeo.answers.answer import MARKS
from camgeo.check.finding import Finding, Verdict
from camgeo.product.value_table import Table
from camgeo.wording import counted

HEAD, TAIL = 12, 4
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
    if count > HEAD + TAIL + 1:
        shown = [*range(HEAD), *range(count - TAIL, count)]
    rows = [[_number(value) for value in table.values[k].tolist()] for k in shown]
    if len(shown) < count:
        rows.insert(HEAD, ["⋮"] * len(table.names))
    size = f"{counted(count, 'row')}, {counted(len(table.names), 'column')}"
    return rows_of(table.names, rows, numbers=True) + paragraph(size)


def _number(value: float) -> str:
    return f"{value + 0.0:.{DIGITS}g}"
