"""Each fixture scene at four tolerances: written, and verified from the files.

In every form at the loosest and at the tightest; between them in one, which changes from scene to
scene.
"""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import Final

import pytest

import camgeo
from camgeo.accuracy.contours import drawn_as
from camgeo.accuracy.rows import FORMS, Form
from camgeo.design import Design
from camgeo.files.verify import Against, Wanted, files_in, verify_files
from tests.end_to_end.built import SCENES

TOLERANCES: Final = (1e-2, 1e-3, 1e-4, 1e-5)

FORMATS: Final[dict[Form, tuple[str, ...]]] = {
    "arcs": ("dxf", "gcode", "stl", "3mf"),
    "polyline": ("dxf",),
    "spline": ("dxf",),
}
"""Only the drawing knows the form."""


@pytest.mark.parametrize("scene", SCENES, ids=lambda path: path.stem)
def test_every_file_is_written_and_verified(scene: Path, tmp_path: Path) -> None:
    base = camgeo.load(scene)
    number = SCENES.index(scene)
    for step, tolerance in enumerate(TOLERANCES):
        ends = tolerance in (max(TOLERANCES), min(TOLERANCES))
        for form in FORMS if ends else (FORMS[(number + step) % len(FORMS)],):
            design = drawn_as(base, form, "fewest")
            folder = tmp_path / f"{form}-{tolerance:g}"
            design.write(folder, _formats(design, form), tolerance=tolerance)
            against = partial(_against, Against(design.discs, tolerance))
            verdicts = verify_files(files_in(folder), against, Wanted())
            assert len(verdicts) == len(design.discs) * len(_formats(design, form))
            for verdict in verdicts:
                failed = [check.name for check in verdict.checks if check.ok is False]
                assert verdict.passed, f"{form} {tolerance:g} {verdict.file}: {failed}"
                assert verdict.deviation is not None
                # Of what may be used, most is: pieces are paid for.
                assert 0.2 * tolerance < verdict.deviation <= tolerance


def _against(found: Against, _folder: Path, _hash: str) -> Against:
    """The scene at hand, wherever it is looked for."""
    return found


def _formats(design: Design, form: Form) -> tuple[str, ...]:
    asked = design.scene.output.formats
    return tuple(name for name in FORMATS[form] if name in asked or name == "dxf")
