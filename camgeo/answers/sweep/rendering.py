"""What `camgeo sweep` finds, as text and as a table."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterable, Sequence
from typing import Final

from camgeo.answers.sweep import Design, Span, Sweep
from camgeo.units import LengthUnit, unit_in
from camgeo.wording import counted, listed, shortened

FEW: Final = 40
"""Rows that are printed; of more, only the least and the greatest answers."""

MOST_REASONS: Final = 8

LONGEST: Final = 100
"""Characters of a reason that are printed."""

REASON: Final = "reason"


def text(answer: Sweep) -> str:
    """What the family answers; of a small one all rows."""
    lines = [f"{answer.scene.name}: {counted(answer.count, 'design')}{_drawn(answer)}"]
    if answer.count <= FEW:
        lines += ["", *aligned(_cells(answer, answer.designs))]
    else:
        for span in answer.spans:
            lines += ["", *_span(span, answer.scene.unit)]
    if answer.failed:
        lines += ["", f"{counted(answer.failed, 'design')} failed:"]
        for reason, count in list(answer.reasons.items())[:MOST_REASONS]:
            lines.append(f"  {count:>7,}  {shortened(reason, LONGEST)}")
        rest = len(answer.reasons) - MOST_REASONS
        if rest > 0:
            lines.append(f"           and for {counted(rest, 'other reason')}")
    return "\n".join(lines)


def _drawn(answer: Sweep) -> str:
    sample = answer.sample
    if sample is None:
        return ""
    return f", drawn with {sample.method}, seed {sample.seed}"


def _span(span: Span, length: LengthUnit) -> list[str]:
    """The least and the greatest answer to a question, each with its design."""
    head = headed(span, length)
    if span.words:
        found = ", ".join(f"{word} {count:,}" for word, count in span.words.items())
        return [f"{head}: {found}"]
    if span.mixed:
        return [f"{head}: {counted(span.count, 'answer')} in different units, {listed(span.units)}"]
    if span.least is None or span.greatest is None:
        return [f"{head}: no design has an answer"]
    lines = [f"{head}: {counted(span.count, 'answer')}"]
    for what, design in (("least", span.least), ("greatest", span.greatest)):
        found, _ = shown_in(length, design.answers[span.word], span.unit)
        values = ", ".join(f"{key} = {shown(value)}" for key, value in design.values.items())
        lines.append(f"  {what:8}  {found}  at {values}")
    return lines


def headed(span: Span, length: LengthUnit = "mm") -> str:
    """Heading of the answers, with their unit if they have one, in a unit of length."""
    unit, _ = unit_in(span.unit, length)
    return f"{span.word} [{unit}]" if unit else span.word


def _cells(answer: Sweep, designs: Iterable[Design]) -> list[list[str]]:
    length = answer.scene.unit
    rows = [[*answer.keys, *(headed(span, length) for span in answer.spans), REASON]]
    common = {span.word: span.unit for span in answer.spans}
    for each in designs:
        answers = (
            " ".join(filter(None, _answer(each, word, common.get(word, ""), length)))
            for word in each.answers
        )
        values = map(shown, each.values.values())
        rows.append([*values, *answers, shortened(each.reason, LONGEST)])
    if not answer.failed:
        rows = [row[:-1] for row in rows]
    return rows


def _answer(design: Design, word: str, common: str, length: LengthUnit) -> tuple[str, str]:
    """An answer, with its unit where that is not the `common` one of the column."""
    own = design.units.get(word, "")
    found, unit = shown_in(length, design.answers[word], own or common)
    return found, unit if own else ""


def aligned(rows: Sequence[Sequence[str]]) -> list[str]:
    """Rows of cells as lines, columns two spaces apart."""
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    return [
        "  ".join(f"{cell:{width}}" for cell, width in zip(row, widths, strict=True)).rstrip()
        for row in rows
    ]


def shown_in(length: LengthUnit, value: object, unit: str) -> tuple[str, str]:
    """A value and its `unit` for reading, in the unit of length of a scene."""
    unit, divisor = unit_in(unit, length)
    return shown(value / divisor if isinstance(value, float) else value), unit


def shown(value: object) -> str:
    """A value for reading."""
    if value is None:
        return "-"
    if isinstance(value, bool):
        return str(value).lower()
    return f"{value:.7g}" if isinstance(value, float) else str(value)


def comma_separated(answer: Sweep) -> bytes:
    """All rows as CSV in UTF-8; each number in the shortest form that reads back the same.

    Where designs state an answer in different units, a column with them follows.
    """
    found = io.BytesIO()
    stream = io.TextIOWrapper(found, "utf-8", newline="")
    rows = csv.writer(stream, lineterminator="\n")
    heads = list(answer.keys)
    for span in answer.spans:
        heads += [headed(span), *([f"{span.word} unit"] if span.mixed else [])]
    rows.writerow([*heads, REASON])
    for each in answer.designs:
        cells = [exact(value) for value in each.values.values()]
        for word, value in each.answers.items():
            cells += [exact(value), *([each.units[word]] if word in each.units else [])]
        rows.writerow([*cells, each.reason])
    stream.flush()
    return found.getvalue()


def exact(value: object) -> str:
    """A value in the shortest form that reads back the same; empty if there is none."""
    if value is None:
        return ""
    return str(value).lower() if isinstance(value, bool) else str(value)
