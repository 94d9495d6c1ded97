"""Answer of `camgeo build`: the files of a scene that were written, and their certificate."""

from __future__ import annotations

import argparse
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import chain
from pathlib import Path
from typing import Final

from camgeo.app.answers.answer import FINDING, SCENE, Answer, Key, exit_code, finding_lines
from camgeo.app.cli.command import SCENE_FILE, Argument, notify, number, opened, settle, show
from camgeo.check.finding import Finding
from camgeo.design.design import Design
from camgeo.design.judged_part import in_one_piece
from camgeo.design.product import with_pair
from camgeo.design.writing import FileReport, write_files
from camgeo.scene.scene import Scene
from camgeo.units import MM_PER, LengthUnit, counted


@dataclass(frozen=True, slots=True)
class Build(Answer):
    """The files that were written.

    Attributes
    ----------
    scene : whose files they are.
    tolerance : largest deviation allowed [mm].
    findings : those that break a limit, and warnings.
    folder : in which the files lie.
    files : that were written; empty if the cam has no outline.
    certificate : its name beside the files; None if there are none.
    """

    scene: Scene
    tolerance: float
    findings: tuple[Finding, ...]
    folder: str
    files: tuple[FileReport, ...] = ()
    certificate: str | None = None

    @property
    def exit_code(self) -> int:
        """2 if there is no such mechanism, 1 if a limit is broken or there is no such disc."""
        return exit_code(self.findings)


def poor_findings(design: Design) -> tuple[Finding, ...]:
    """The findings on a design and on its parts that break a limit or warn.

    What makes a part impossible is not among them: it is reported by the files of that part.
    """
    bad = tuple(finding for finding in design.findings if finding.severity != "ok")
    if not design.judgement.has_outline:
        return bad
    from camgeo.design.judged_part import poor_findings  # a cam without outline has no part

    return (*bad, *chain.from_iterable(map(poor_findings, with_pair(design.discs))))


def build(
    design: Design,
    folder: str | Path,
    formats: Sequence[str] | None = None,
    *,
    tolerance: float | None = None,
    force: bool = False,
    findings: tuple[Finding, ...] | None = None,
    progress: Callable[[str], None] = lambda _: None,
) -> Build:
    """Write the files as `Design.write` does; a cam without an outline has none.

    `findings` are those of `poor_findings`, where they are known; `progress` is called with the
    name of each step. Raises as `Design.write`.
    """
    output = design.scene.output
    limit = output.tolerance if tolerance is None else tolerance
    bad = poor_findings(design) if findings is None else findings
    scene, where = design.scene, str(folder)
    if not design.judgement.has_outline:
        return Build(scene, limit, bad, where)
    names = output.formats if formats is None else tuple(formats)
    report = write_files(design.discs, folder, names, limit, force=force, progress=progress)
    watched = tuple(finding for file in report.files for finding in file.findings)
    return Build(scene, limit, bad + watched, where, report.files, report.paths[-1].name)


# -- document -------------------------------------------------------------------------------------
# The keys of its JSON document.


DOCUMENT: Final = Key(
    "The files written for a scene.",
    {
        "scene": SCENE,
        "tolerance_mm": "Largest deviation allowed.",
        "findings": Key("Findings beyond a limit, and warnings.", FINDING),
        "folder": "Folder of the files.",
        "files": Key(
            "The files.",
            {
                "file": Key("Name of the file.", of="name"),
                "format": "Name of its format.",
                "bytes": Key("Size of the file.", of="size"),
                "tolerance_mm": "Largest deviation allowed.",
                "deviation_mm": (
                    "Largest deviation proved for the file as read back; null for a picture."
                ),
                "facts": "What its writer reports about it, e.g. the number of arcs.",
            },
        ),
        "certificate": (
            "Name of the certificate written with them; null if nothing was written because the"
            " cam has no outline."
        ),
    },
    type=Build,
)


# -- rendering ------------------------------------------------------------------------------------
# The answer of `camgeo build` in words.


WIDTH = 39
"""Width of the column with the paths."""


def text(answer: Build) -> str:
    """A line for each file, and one for the certificate; lengths in the scene's unit."""
    folder, unit = Path(answer.folder), answer.scene.unit
    lines = [f"{folder / file.name!s:{WIDTH}} {_size(file, unit)}" for file in answer.files]
    part = answer.scene.part
    if answer.files and part is not None and part.pair is not None:
        lines.append(in_one_piece(part.pair))
    if answer.certificate is not None:
        lines.append(f"{folder / answer.certificate!s:{WIDTH}} the proof of these deviations")
    return "\n".join(lines)


def _size(file: FileReport, unit: LengthUnit) -> str:
    size = f"{counted(file.size, 'byte'):>16}"
    if file.deviation is None:
        return size
    deviation, tolerance = file.deviation / MM_PER[unit], file.tolerance / MM_PER[unit]
    return f"{size}, at most {deviation:.3g} {unit} off (tolerance {tolerance:g} {unit})"


# -- command line ----------------------------------------------------------------------------------


EXAMPLE: Final = "camgeo build fixtures/scenes/setzhub.toml -o out --only dxf,gcode"


ARGUMENTS: Final = (
    SCENE_FILE,
    Argument(
        "-o", metavar="DIR", dest="output", default=".", help="folder; default: the current one"
    ),
    Argument("--only", metavar="FORMATS", help="comma-separated: dxf,gcode,stl,3mf,..."),
    Argument(
        "--tolerance", metavar="MM", type=number, help="largest deviation, instead of the scene's"
    ),
    Argument("--force", action="store_true", help="overwrite existing files that differ"),
)


def run(arguments: argparse.Namespace) -> int:
    """Write the files; report findings beyond a limit, and refuse a disc that cannot exist."""
    design = opened(arguments)
    findings = poor_findings(design)
    for line in finding_lines(findings):
        notify(line)
    formats = arguments.only
    if formats is not None:
        formats = tuple(name.strip() for name in formats.split(",") if name.strip())
    settle(Path(arguments.output), arguments)
    answer = build(
        design,
        arguments.output,
        formats,
        tolerance=arguments.tolerance,
        force=arguments.force,
        findings=findings,
        progress=arguments.progress,
    )
    if answer.certificate is None:
        notify("nothing was written: the cam has no outline")
    for line in finding_lines(finding for file in answer.files for finding in file.findings):
        notify(line)
    return show(answer, arguments)
