"""Fixture scenes at four tolerances: written, measured as read back, and verified.

Each scene is written in one form at one end of the tolerances: a drawing of arcs, a
program and one of its solids, or a drawing of chords or splines. `tests/contour` fits curves at all
tolerances, `test_solids` proves that both solids are one body, and `test_verify` verifies all files
of all scenes at their own tolerance. The long form writes and verifies every
scene in all forms at both ends, and between them.
"""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import Final

import pytest

import camgeo
from camgeo.app.answers.verify import Reference, Wanted, verifiable_files, verify_files
from camgeo.design.design import Design
from camgeo.design.writing import Report
from camgeo.geometry.contour.contour import Form
from camgeo.studies.accuracy.contours import FORMS, with_contour_form
from tests.end_to_end.built import SCENES
from tests.long_form import LONG

TOLERANCES: Final = (1e-2, 1e-3, 1e-4, 1e-5)

FORMATS: Final[dict[Form, tuple[str, ...]]] = {
    "arcs": ("dxf", "gcode", "stl", "3mf", "step"),
    "polyline": ("dxf",),
    "spline": ("dxf",),
}
"""Only the drawing knows the form."""


USUAL: Final[tuple[tuple[Form, float], ...]] = (
    ("arcs", min(TOLERANCES)),
    ("polyline", max(TOLERANCES)),
    ("arcs", max(TOLERANCES)),
    ("spline", min(TOLERANCES)),
    ("arcs", min(TOLERANCES)),
    ("polyline", min(TOLERANCES)),
    ("arcs", max(TOLERANCES)),
    ("spline", max(TOLERANCES)),
)
"""The form and the tolerance of a scene, by turns."""


def _written(number: int) -> list[tuple[Form, float]]:
    """The forms and tolerances in which a scene is written."""
    if not LONG:
        return [USUAL[number % len(USUAL)]]
    loose, tight = max(TOLERANCES), min(TOLERANCES)
    between = [
        (FORMS[(number + step) % len(FORMS)], tolerance)
        for step, tolerance in enumerate(TOLERANCES)
        if tight < tolerance < loose
    ]
    return [(form, tolerance) for tolerance in (loose, tight) for form in FORMS] + between


@pytest.mark.parametrize("scene", SCENES, ids=lambda path: path.stem)
def test_every_file_is_written_and_verified(scene: Path, tmp_path: Path) -> None:
    base = camgeo.load(scene)
    number = SCENES.index(scene)
    for form, tolerance in _written(number):
        design = with_contour_form(base, form, "fewest")
        folder = tmp_path / f"{form}-{tolerance:g}"
        formats = _formats(design, form, number)
        report = design.write(folder, formats, tolerance=tolerance)
        assert len(report.files) == len(design.discs) * len(formats)
        for file in report.files:
            assert file.deviation is not None
            # Of what may be used, most is: pieces are paid for.
            assert 0.2 * tolerance < file.deviation <= tolerance, f"{form} {tolerance:g}"
        _verify(design, folder, tolerance, report)


def _verify(design: Design, folder: Path, tolerance: float, report: Report) -> None:
    """All files pass, with the deviations that were measured when they were written."""
    against = partial(_against, Reference(design.discs, tolerance))
    verdicts = {
        each.file: each for each in verify_files(verifiable_files(folder), against, Wanted())
    }
    assert len(verdicts) == len(report.files)
    for file in report.files:
        verdict = verdicts[file.name]
        failed = [check.name for check in verdict.checks if check.ok is False]
        assert verdict.passed, f"{folder.name} {file.name}: {failed}"
        assert verdict.deviation is not None
        assert 0.2 * tolerance < verdict.deviation <= tolerance
        # The readers are others, and the sense in which a contour is run may be too.
        assert verdict.deviation == pytest.approx(file.deviation, rel=0.02, abs=1e-9)


def _against(found: Reference, _folder: Path, _hash: str) -> Reference:
    """The scene, wherever it is searched for."""
    return found


def _formats(design: Design, form: Form, number: int) -> tuple[str, ...]:
    asked = {"dxf", "step", *design.scene.output.formats}
    if not LONG:
        asked -= {"stl" if number // 4 % 2 else "3mf"}
    return tuple(name for name in FORMATS[form] if name in asked)
