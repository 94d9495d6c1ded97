"""Answer of `camgeo compare`: a few designs side by side."""

from __future__ import annotations

import argparse
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from decimal import Decimal
from pathlib import Path
from typing import Any, Final, Literal

from camgeo.app.answers.answer import MARKS, Answer, Key, aligned
from camgeo.app.answers.check import check
from camgeo.app.answers.sweep import display_value
from camgeo.app.cli.command import Argument, load_design, picture_options, repeated_option, show
from camgeo.check.finding import Finding
from camgeo.check.judge import worst
from camgeo.design.design import Design
from camgeo.errors import GeometryError, UnknownNameError
from camgeo.pictures.model import Figure
from camgeo.scene.keys import KeyPath, spelled
from camgeo.studies.sweep.family import split_names
from camgeo.studies.sweep.rows import canonical, parse_questions, read
from camgeo.units import LengthUnit, counted, in_unit, shortened

MOST: Final = 8
"""Designs that can be told apart in a table and a picture."""

NAME: Final = ("name",)
"""The key in which all scenes differ, and which says nothing about the design."""


@dataclass(frozen=True, slots=True)
class Compared:
    """One of the compared designs.

    Attributes
    ----------
    label : distinguishes it from the others.
    design : the design itself.
    verdict : the worst severity of its findings; empty if only some quantities were requested.
    """

    label: str
    design: Design
    verdict: str


@dataclass(frozen=True, slots=True)
class DifferingKey:
    """A key of the scenes with its values in the order of the designs, as text; empty if a scene
    does not state it.
    """

    key: str
    values: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Cell:
    """The finding or quantity of one design.

    Attributes
    ----------
    value : a number in `unit`, or a word; None if there is none.
    severity, verdict : of the finding; empty if there is none.
    reason : why there is no value; or empty.
    """

    value: float | str | None = None
    unit: str = ""
    severity: str = ""
    reason: str = ""
    verdict: str = ""

    def words(self, length: LengthUnit) -> tuple[str, str]:
        """The value in a unit of length, and the severity of the finding unless it is "ok"."""
        severity = "" if self.severity == "ok" else self.severity
        if self.value is None:
            return "" if severity else self.verdict or "-", severity
        return " ".join(filter(None, display_value(length, self.value, self.unit))), severity


@dataclass(frozen=True, slots=True)
class ComparisonLine:
    """A finding or a requested quantity, with the cell of each design."""

    name: str
    cells: tuple[Cell, ...]


@dataclass(frozen=True, slots=True)
class Compare(Answer):
    """A few designs side by side.

    Attributes
    ----------
    designs : in the order given.
    keys : in which the scenes differ.
    lines : the findings of all designs, or the requested quantities.
    """

    designs: tuple[Compared, ...]
    keys: tuple[DifferingKey, ...]
    lines: tuple[ComparisonLine, ...]


def compare(designs: Sequence[tuple[str, Design]], ask: Sequence[str] = ()) -> Compare:
    """Compare designs with their labels.

    Parameters
    ----------
    ask : names, see `camgeo.studies.sweep.rows`; if there are none, all findings of a check.

    Raises
    ------
    GeometryError
        For fewer than two designs, or more than can be told apart.
    UnknownNameError
        If no design knows a name that is asked.
    """
    if not 2 <= len(designs) <= MOST:
        message = f"2 to {MOST} designs can be compared, not {counted(len(designs), 'design')}"
        raise GeometryError(message)
    if ask:
        columns = [_answers(design, ask, designs) for _, design in designs]
        verdicts = [""] * len(designs)
    else:
        checked = [_everything(label, design) for label, design in designs]
        columns = [_findings(findings) for findings in checked]
        verdicts = [worst(findings) for findings in checked]
    # All names, in the order in which they first appear.
    names = dict.fromkeys(name for column in columns for name in column)
    lines = tuple(
        ComparisonLine(name, tuple(column.get(name, Cell()) for column in columns))
        for name in names
    )
    compared = tuple(
        Compared(label, design, verdict)
        for (label, design), verdict in zip(designs, verdicts, strict=True)
    )
    return Compare(compared, _differing([design for _, design in designs]), lines)


def _everything(label: str, design: Design) -> tuple[Finding, ...]:
    """The findings of a check; an error names the design."""
    try:
        return check(design).everything
    except GeometryError as error:
        raise GeometryError(f"{label}: {error.message}", error.key, error.value) from error


def _findings(findings: Sequence[Finding]) -> dict[str, Cell]:
    """The first finding of each name."""
    cells: dict[str, Cell] = {}
    for finding in findings:
        value = None if finding.value is None else float(finding.value)
        cells.setdefault(
            finding.name, Cell(value, finding.unit, finding.severity, "", finding.verdict)
        )
    return cells


def _answers(
    design: Design, ask: Sequence[str], designs: Sequence[tuple[str, Design]]
) -> dict[str, Cell]:
    """The quantities of a design by name; one that only other designs have is left out.

    If no design knows a name, the error of this design is raised.
    """
    cells: dict[str, Cell] = {}
    for word in ask:
        try:
            (question,) = parse_questions(design, [word])
        except (UnknownNameError, GeometryError) as error:
            if not any(_knows(other, word) for _, other in designs):
                raise
            unknown = isinstance(error, UnknownNameError)
            reason = "has no such finding or column" if unknown else str(error)
            cells[canonical(word)] = Cell(reason=reason)
        else:
            reading = read(design, question)
            cells[question.word] = Cell(reading.value, reading.unit, "", reading.reason)
    return cells


def _knows(design: Design, word: str) -> bool:
    try:
        parse_questions(design, [word])
    except (UnknownNameError, GeometryError):
        return False
    return True


def _differing(designs: Sequence[Design]) -> tuple[DifferingKey, ...]:
    """The keys at which the scenes do not all state the same."""
    stated = [dict(_leaves(design.scene.values)) for design in designs]
    paths = dict.fromkeys(path for values in stated for path in values)
    keys = []
    for path in paths:
        values = [values.get(path) for values in stated]
        if path != NAME and any(value != values[0] for value in values):
            keys.append(DifferingKey(spelled(path), tuple(map(_value_text, values))))
    return tuple(keys)


def _leaves(values: Any, path: KeyPath = ()) -> Iterator[tuple[KeyPath, Any]]:
    """The values inside nested tables and lists, with their paths."""
    if isinstance(values, Mapping):
        for key, value in values.items():
            yield from _leaves(value, (*path, key))
    elif isinstance(values, tuple):
        for index, value in enumerate(values):
            yield from _leaves(value, (*path, index))
    else:
        yield path, values


def _value_text(value: Any) -> str:
    if value is None:
        return ""
    if isinstance(value, bool):
        return str(value).lower()
    # Without an exponent, as scenes state numbers, unless the number is huge.
    return f"{value:f}" if isinstance(value, Decimal) and abs(value) < 1e15 else str(value)


# -- document -------------------------------------------------------------------------------------
# The keys of its JSON document.


DOCUMENT: Final = Key(
    "A few designs side by side: what their scenes state differently, and the findings on each.",
    {
        "designs": Key(
            "The designs, in the order given.",
            {
                "label": "Name of the design in the text and the picture.",
                "name": Key("Name of its scene.", of="design.name"),
                "sha256": Key(
                    "SHA-256 of everything that the scene states, hexadecimal.",
                    of="design.scene.identity",
                ),
                "verdict": Key(
                    "The worst severity of its findings; empty if only some quantities were"
                    " requested.",
                    type=Literal["ok", "warning", "broken", "no-disc", "invalid", ""],
                ),
            },
        ),
        "keys": Key(
            "The keys in which the scenes differ.",
            {
                "key": "Path of the key.",
                "values": "What each scene states, as text; empty if it does not state it.",
            },
        ),
        "findings": Key(
            "The findings of all designs, or the requested quantities.",
            {
                "name": (
                    "Name of the finding; of several with that name in a design, the first counts."
                ),
                "values": Key(
                    "The cell of each design.",
                    {
                        "value": "The value, in `unit`; null if there is none.",
                        "unit": "Unit of the number; empty without one.",
                        "severity": (
                            "Severity of the finding; empty if the design has none, or if"
                            " quantities were requested."
                        ),
                        "verdict": (
                            "What is said of it: its severity, or, of a finding that nothing"
                            ' limits, "figure" if it has a value and "note" if not; empty as the'
                            " severity is."
                        ),
                        "reason": "Why the quantity has no value; otherwise empty.",
                    },
                    of="cells",
                ),
            },
            of="lines",
        ),
    },
    type=Compare,
)


# -- rendering ------------------------------------------------------------------------------------
# The answer of `camgeo compare` as text and as a picture.


MOST_KEYS: Final = 30
"""Keys that are printed; scenes that differ in more have little in common."""

LONGEST: Final = 40
"""Characters of a cell."""


def text(answer: Compare) -> str:
    """Keys in which the scenes differ, then the findings, a column for each design."""
    labels = [design.label for design in answer.designs]
    rows = [["", *labels]]
    for key in answer.keys[:MOST_KEYS]:
        rows.append([key.key, *(shortened(value, LONGEST) or "-" for value in key.values)])
    rest = len(answer.keys) - MOST_KEYS
    if rest > 0:
        rows.append([f"and {counted(rest, 'other key')}", *("" for _ in labels)])
    rows.append(["" for _ in rows[0]])
    if any(design.verdict for design in answer.designs):
        rows.append(["verdict", *(design.verdict for design in answer.designs)])
    units = [design.design.scene.unit for design in answer.designs]
    rows += [[line.name, *map(_cell, line.cells, units)] for line in answer.lines]
    lines = aligned(rows)
    reasons = dict.fromkeys(
        f"{label}: {line.name}: {in_unit(cell.reason, unit)}"
        for line in answer.lines
        for label, cell, unit in zip(labels, line.cells, units, strict=True)
        if cell.reason
    )
    return "\n".join([*lines, *(["", *reasons] if reasons else [])])


def _cell(cell: Cell, length: LengthUnit) -> str:
    words, severity = cell.words(length)
    return " ".join(filter(None, (words, MARKS[severity] if severity else "")))


def figure(answer: Compare) -> Figure:
    """The curves of all designs, drawn over each other."""
    from camgeo.pictures.sweep import of_designs

    return of_designs([(compared.label, compared.design) for compared in answer.designs])


# -- command line ----------------------------------------------------------------------------------


EXAMPLE: Final = (
    "camgeo compare fixtures/scenes/setzhub.toml fixtures/scenes/querhub.toml -o both.png\n"
    "  camgeo compare cam-a.toml cam-b.toml --ask transmission-angle,peak:a,diameter"
)


ARGUMENTS: Final = (
    Argument("scenes", metavar="SCENE", nargs="+", help="scene files, two or more"),
    repeated_option(
        "--ask", "NAMES", "compare only these, named as for camgeo sweep; comma-separated"
    ),
    *picture_options(),
)


def run(arguments: argparse.Namespace) -> int:
    """Compare, and print or draw the results."""
    designs = [load_design(name, arguments) for name in arguments.scenes]
    labels = scene_labels(arguments.scenes)
    answer = compare(list(zip(labels, designs, strict=True)), split_names(arguments.ask))
    return show(answer, arguments, contents="flanks, motion, acceleration, mu")


def scene_labels(names: Sequence[str]) -> list[str]:
    """The stems of files, or their paths if two stems are the same."""
    stems = [Path(name).stem for name in names]
    return stems if len(set(stems)) == len(stems) else list(names)
