"""What `camgeo build` writes, in words."""

from __future__ import annotations

from pathlib import Path

from camgeo.answers.build import Build
from camgeo.wording import counted
from camgeo.writing.write import FileReport

WIDTH = 39
"""Of the paths."""


def text(answer: Build) -> str:
    """A line for each file, and one for the certificate."""
    folder = Path(answer.folder)
    lines = [f"{folder / file.name!s:{WIDTH}} {_size(file)}" for file in answer.files]
    if answer.certificate is not None:
        lines.append(f"{folder / answer.certificate!s:{WIDTH}} the proof of these deviations")
    return "\n".join(lines)


def _size(file: FileReport) -> str:
    size = f"{counted(file.size, 'byte'):>16}"
    if file.deviation is None:
        return size
    return f"{size}, at most {file.deviation:.3g} mm off (tolerance {file.tolerance:g} mm)"
