"""What `camgeo laws` finds, as a table and as a picture."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Final

from camgeo.answers.laws import UNITS, LawRow, Laws, TaskLaws
from camgeo.motion.laws import ALIASES, OPTIONS
from camgeo.motion.laws.comparison import QUANTITIES, Entry, Running
from camgeo.units import RPM

if TYPE_CHECKING:
    from camgeo.figure.model import Figure

HEAD: Final = ("C_v", "C_a", "C_a*", "C_j", "C_j*", "C_Mdyn", "C_Mdyn*")
"""Symbols of `QUANTITIES`, as in VDI 2143."""

PHYSICAL_HEAD: Final = ("v", "a", "a*", "j", "j*", "M/m", "M/m*")
"""Those of the same quantities of a move; M/m is the torque against the inertia of 1 kg."""

SYMBOLS: Final = {
    "inflection": "lambda",
    **{name: option.symbol for name, option in OPTIONS.items()},
}
"""Names in the table for parameters to which the guideline gives a letter."""

CELL: Final = 12


def text(answer: Laws) -> str:
    """The comparison, one row per law, or the list of the tasks."""
    if answer.tasks is not None:
        return "\n".join(_tasks(answer.tasks))
    rows = answer.rows or ()
    width = max(len(row.entry.name) for row in rows) + 2
    lines = _compared(rows, width, places=answer.places)
    if answer.running is not None:
        lines += _physical(rows, answer.running, width)
    return "\n".join([*lines, *_notes([row.entry for row in rows])])


def figure(answer: Laws) -> Figure:
    """The curves of the laws of one task, one row per law."""
    from camgeo.figure import laws

    return laws.figure([row.entry for row in answer.rows or ()])


def _tasks(tasks: Sequence[TaskLaws]) -> list[str]:
    ends = [" to ".join(each.ends) for each in tasks]
    width = max(map(len, ends)) + 2
    return [
        f"{each.task:6}{end:{width}}{', '.join(each.families) or 'none of these'}"
        for each, end in zip(tasks, ends, strict=True)
    ]


def _compared(rows: Sequence[LawRow], width: int, *, places: bool) -> list[str]:
    parameters = [_parameters(row) for row in rows]
    second = max(len("parameters"), *map(len, parameters)) + 2
    head = "".join(f"{name:>{CELL}}" for name in HEAD)
    lines = [f"{'law':{width}}{'parameters':{second}}{head}  remarks"]
    for row, given in zip(rows, parameters, strict=True):
        name, values = row.entry.name, row.values
        if values is None:
            lines.append(f"{name:{width}}not possible: {row.entry.reason}")
            continue
        extremes = [values[quantity] for quantity in QUANTITIES]
        cells = "".join(_cell(None if each is None else each.value, ".5f") for each in extremes)
        lines.append(f"{name:{width}}{given:{second}}{cells}  {_remarks(row.entry)}".rstrip())
        if places:
            cells = "".join(
                _cell(None if each is None else each.place, ".5f", "-") for each in extremes
            )
            lines.append(f"{'':{width}}{'  at z':{second}}{cells}")
    return lines


def _physical(rows: Sequence[LawRow], running: Running, width: int) -> list[str]:
    move = (
        f"{running.speed / RPM:g} rev/min, {math.degrees(running.span):g} degrees,"
        f" stroke {running.stroke:g} mm; M/m: torque against the inertia of 1 kg"
    )
    head = f"{'law':{width}}" + "".join(f"{name:>{CELL}}" for name in PHYSICAL_HEAD)
    units = " " * width + "".join(f"{f'[{unit}]':>{CELL}}" for unit in UNITS)
    lines = ["", move, head, units]
    for row in rows:
        if row.physical is not None:
            cells = (
                _cell(None if each is None else each.value, ".5g") for each in row.physical.values()
            )
            lines.append(f"{row.entry.name:{width}}" + "".join(cells))
    return lines


def _cell(value: float | None, form: str, missing: str = "unbounded") -> str:
    return f"{missing if value is None else format(value + 0.0, form):>{CELL}}"


def _parameters(row: LawRow) -> str:
    return " ".join(f"{SYMBOLS.get(key, key)}={value:.6g}" for key, value in row.parameters.items())


def _remarks(entry: Entry) -> str:
    """Shocks and jerks with their z, and whether the move runs back or overshoots."""
    found = []
    for word, places in (("shock", entry.shocks), ("jerk", entry.jerks)):
        if places:
            found.append(f"{word} at z = {', '.join(f'{place:.6g}' for place in places)}")
    if entry.runs_back:
        found.append("overshoots" if entry.overshoots else "runs back")
    return "; ".join(found)


def _notes(entries: Sequence[Entry]) -> list[str]:
    """The parameters ignored or assumed in each row, and alternative names of the laws."""
    ignored: dict[tuple[str, ...], list[str]] = {}
    assumed: dict[tuple[str, ...], list[str]] = {}
    for entry in entries:
        if entry.law is not None:
            ignored.setdefault(entry.ignored, []).append(entry.name)
            assumed.setdefault(entry.assumed, []).append(entry.name)
    kinds = (
        (f"ignored, no parameters for {entries[0].task}", ignored),
        ("not given, taken as 0", assumed),
    )
    found = [
        f"{start}: {', '.join(keys)} ({', '.join(names)})"
        for start, groups in kinds
        for keys, names in groups.items()
        if keys
    ]
    listed = {entry.name for entry in entries}
    found += [f"{alias} is {name}" for alias, name in ALIASES.items() if name in listed]
    return ["", *found] if found else []
