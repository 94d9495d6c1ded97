"""The results of `camgeo build` and of `camgeo verify`, as text and as JSON."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import pytest

import camgeo
from camgeo.app.answers.answer import text
from camgeo.app.answers.build import build, poor_findings
from camgeo.app.answers.verify import verify
from camgeo.design.design import Design
from camgeo.errors import SceneError, UnsafeError
from camgeo.scene.scene import load_scene
from tests.answers.documents import FIXTURES, RING, UNHELD, document

SCENE = FIXTURES / "scenes" / "inch.toml"


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("built")


def test_text_and_document_are_of_one_result(folder: Path) -> None:
    found = build(Design(load_scene(SCENE)), folder, ["dxf", "svg"], tolerance=0.01)
    first, *rest = found.files
    changed = replace(found, files=(replace(first, deviation=0.123), *rest))
    assert document(changed)["files"][0]["deviation_mm"] == 0.123
    assert "at most 0.00484 inch off (tolerance 0.000393701 inch)" in text(changed)

    verified = verify((folder / "inch.dxf", folder / "inch.svg"), scene=SCENE)
    assert document(verified)["passed"] is True
    verdict = verified.verdicts[0]
    worse = replace(verdict, checks=tuple(replace(each, ok=False) for each in verdict.checks))
    failed = replace(verified, verdicts=(worse, verified.verdicts[1]))
    assert document(failed)["passed"] is False
    assert "FAIL" in text(failed).splitlines()[0]
    assert (verified.exit_code, failed.exit_code) == (0, 1)


def test_what_is_to_be_watched_stands_in_report_and_certificate(tmp_path: Path) -> None:
    found = build(Design(load_scene(RING)), tmp_path, ["gcode"], tolerance=0.01)
    (core,) = (each for each in found.findings if each.name == "loose-core")
    assert core.severity == "warning"
    certificate = json.loads((tmp_path / "certificate.json").read_text())
    (stated,) = (each for each in certificate["findings"] if each["name"] == "loose-core")
    assert (stated["value"], stated["unit"]) == (core.value, "mm^3")


def test_a_program_that_must_not_be_run_is_not_written(tmp_path: Path) -> None:
    """Nor are the other files of its set."""
    with pytest.raises(UnsafeError, match=r"a core of .* nothing holds it at X"):
        build(camgeo.loads(UNHELD), tmp_path, ["dxf", "gcode"])
    assert list(tmp_path.iterdir()) == []
    assert build(camgeo.loads(UNHELD), tmp_path, ["dxf"]).exit_code == 0


def test_a_program_that_cannot_be_planned_is_not_written(tmp_path: Path) -> None:
    text = RING.read_text().replace("flute_length = 26", "flute_length = 6")
    with pytest.raises(SceneError) as caught:
        build(camgeo.loads(text), tmp_path, ["gcode"])
    (fault,) = caught.value.faults
    assert (fault.key, fault.value) == ("tool[1].flute_length", "6")
    assert fault.line is not None


def test_a_cam_without_outline_has_no_files(tmp_path: Path) -> None:
    found = build(Design(load_scene(FIXTURES / "refused" / "global_undercut.toml")), tmp_path)
    reported = document(found)
    assert (reported["files"], reported["certificate"], text(found)) == ([], None, "")
    assert found.exit_code == 1
    assert list(tmp_path.iterdir()) == []


def test_a_diameter_is_limited_without_a_part() -> None:
    """The outline alone is a part: build tells of it what check does."""
    design = camgeo.load(FIXTURES / "scenes" / "vorschub.toml")
    edits = {"output.formats": ["csv"], "limits.diameter": 50.0}
    bare = {key: None for key in ("part", "tool", "stock", "holding") if key in design.scene.values}
    found = poor_findings(camgeo.Design(design.scene.with_values({**edits, **bare})))
    assert [each.name for each in found if each.severity == "broken"] == ["largest-diameter"]
