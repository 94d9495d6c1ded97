"""What `camgeo build` writes: the files of a scene, and their certificate."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import chain
from pathlib import Path
from typing import ClassVar

from camgeo.answers.answer import Answer, exit_code
from camgeo.check.finding import Finding
from camgeo.design import Design
from camgeo.scene.scene import Scene
from camgeo.writing.write import FileReport, write_files


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

    command: ClassVar[str] = "build"

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


def told(design: Design) -> tuple[Finding, ...]:
    """What is found in a design and in its parts beyond a limit, or worth a warning; what makes a
    part impossible is left to its files.
    """
    bad = tuple(each for each in design.findings if each.severity != "ok")
    if not design.judgement.has_outline:
        return bad
    from camgeo.product.judged_part import poor_in  # a cam without outline has no part
    from camgeo.product.product import with_pair

    return (*bad, *chain.from_iterable(map(poor_in, with_pair(design.discs))))


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
    """Write the files, as `Design.write` does; none for a cam that has no outline.

    `findings` are those of `told`, where they are known; `progress` is called with the name of each
    step. Raises as `Design.write`.
    """
    output = design.scene.output
    asked = output.tolerance if tolerance is None else tolerance
    bad = told(design) if findings is None else findings
    scene, where = design.scene, str(folder)
    if not design.judgement.has_outline:
        return Build(scene, asked, bad, where)
    names = output.formats if formats is None else tuple(formats)
    report = write_files(design.discs, folder, names, asked, force=force, progress=progress)
    watched = tuple(finding for each in report.files for finding in each.findings)
    return Build(scene, asked, bad + watched, where, report.files, report.paths[-1].name)
