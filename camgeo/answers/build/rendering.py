"""What `camgeo build` writes, in words."""

from __future__ import annotations

from pathlib import Path

from camgeo.answers.build import Build
from camgeo.product.relation import in_one_piece
from camgeo.units import MM_PER, LengthUnit
from camgeo.wording import counted
from camgeo.writing.write import FileReport

WIDTH = 39
"""Of the paths."""


def text(answer: Build) -> str:
    """A line for each file, and one for the certificate; lengths in the scene's unit."""
    folder, unit = Path(answer.folder), answer.scene.unit
    lines = [f"{folder / file.name!s:{WIDTH}} {_size(file, unit)}" for file in answer.files]
    relation = _relation(answer)
    lines += [relation] if relation and answer.files else []
    if answer.certificate is not None:
        lines.append(f"{folder / answer.certificate!s:{WIDTH}} the proof of these deviations")
    return "\n".join(lines)


def _relation(answer: Build) -> str:
    """How the discs of a pair in one piece stand to each other; empty of other designs."""
    part = answer.scene.part
    return "" if part is None or part.pair is None else in_one_piece(part.pair)


def _size(file: FileReport, unit: LengthUnit) -> str:
    size = f"{counted(file.size, 'byte'):>16}"
    if file.deviation is None:
        return size
    off, tolerance = file.deviation / MM_PER[unit], file.tolerance / MM_PER[unit]
    return f"{size}, at most {off:.3g} {unit} off (tolerance {tolerance:g} {unit})"
