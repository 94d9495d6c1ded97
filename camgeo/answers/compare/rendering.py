"""What `camgeo compare` finds, as text and as a picture."""

from __future__ import annotations

from typing import Final

from camgeo.answers.answer import MARKS
from camgeo.answers.compare import Cell, Compare
from camgeo.answers.sweep.rendering import aligned, shown_in
from camgeo.figure import compare
from camgeo.figure.model import Figure
from camgeo.units import LengthUnit, in_unit
from camgeo.wording import counted, shortened

MOST_KEYS: Final = 30
"""Keys that are printed; scenes that differ in more have little in common."""

LONGEST: Final = 40
"""Characters of a cell."""


def text(answer: Compare) -> str:
    """Keys in which the scenes differ, then the findings, a column for each design."""
    labels = [each.label for each in answer.designs]
    rows = [["", *labels]]
    for key in answer.keys[:MOST_KEYS]:
        rows.append([key.key, *(shortened(value, LONGEST) or "-" for value in key.values)])
    rest = len(answer.keys) - MOST_KEYS
    if rest > 0:
        rows.append([f"and {counted(rest, 'other key')}", *("" for _ in labels)])
    rows.append(["" for _ in rows[0]])
    if any(each.verdict for each in answer.designs):
        rows.append(["verdict", *(each.verdict for each in answer.designs)])
    units = [each.design.scene.unit for each in answer.designs]
    rows += [[line.name, *map(_cell, line.cells, units)] for line in answer.lines]
    lines = aligned(rows)
    told = dict.fromkeys(
        f"{label}: {line.name}: {in_unit(cell.reason, unit)}"
        for line in answer.lines
        for label, cell, unit in zip(labels, line.cells, units, strict=True)
        if cell.reason
    )
    return "\n".join([*lines, *(["", *told] if told else [])])


def _cell(cell: Cell, length: LengthUnit) -> str:
    mark = "" if cell.severity in ("", "ok") else MARKS[cell.severity]
    if cell.value is None:
        return mark or (cell.verdict or "-")
    return " ".join(filter(None, (*shown_in(length, cell.value, cell.unit), mark)))


def figure(answer: Compare) -> Figure:
    """The designs over each other."""
    return compare.figure([(each.label, each.design) for each in answer.designs])
