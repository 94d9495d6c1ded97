"""Parts compared with their operations, feature by feature: check, JSON and setup sheet."""

from __future__ import annotations

from functools import cache
from pathlib import Path

import pytest

import camgeo
from camgeo.app.answers.answer import text
from camgeo.app.answers.check import check
from camgeo.app.answers.setup import setup_sheet
from camgeo.check.finding import Finding
from camgeo.design.design import Design
from camgeo.design.milled import compared
from camgeo.milling.features import Feature
from tests.answers.documents import document

FOUND = Path(__file__).parents[2] / "fixtures" / "found"

SCENE = (FOUND / "chamfer_contradicts_part.toml").read_text("utf-8")

CHAMFERS = "chamfers = { outline = { width = 0.8 }, bore = { width = 1 } }\n"
MARK = "mark = { radius = 26, width = 3, depth = 1, angle = 90 }\n"


@cache
def designed(scene: str) -> Design:
    """The design of a scene, computed once for all tests."""
    return camgeo.loads(scene)


def told(scene: str) -> dict[str, list[Finding]]:
    """The findings on the program, by their names, that are more than "ok"."""
    found = check(designed(scene)).machining
    assert found is not None
    names: dict[str, list[Finding]] = {}
    for each in found.findings:
        if each.severity != "ok":
            names.setdefault(each.name, []).append(each)
    return names


def test_a_chamfer_that_is_larger_than_that_of_the_part_is_refused(tmp_path: Path) -> None:
    design = designed(SCENE)
    found = told(SCENE)
    larger = found["chamfers"][-1]
    assert (larger.severity, larger.value, larger.limit, larger.unit) == ("broken", 2.0, 0.8, "mm")
    assert larger.sentence.startswith("upper edge of the outline: chamfer outline; 2 mm wide")
    assert check(design).exit_code == 1
    with pytest.raises(camgeo.errors.UnsafeError, match=r"the part states 0\.8 mm"):
        design.write(tmp_path, ["gcode"])
    assert not any(tmp_path.iterdir())
    sheet = setup_sheet(design)
    assert sheet.exit_code == 1
    assert "no gouge" not in text(sheet)
    assert f"BROKEN  {larger.sentence}" in text(sheet).splitlines()


def test_every_feature_is_named_with_what_makes_it() -> None:
    """In JSON of both answers the same."""
    design = designed(SCENE)
    (program,) = document(check(design))["machining"]["programs"].values()
    rows = {each["name"]: each for each in program["features"]}
    assert document(setup_sheet(design))["features"] == program["features"]
    by = {name: (each["operations"], each["severity"]) for name, each in rows.items()}
    assert by == {
        "upper face": ([], "ok"),
        "lower face": ([], "ok"),
        "outline": (["outline"], "ok"),
        "bore": ([], "ok"),
        "mark": ([], "warning"),
        "keyway": ([], "warning"),
        "lower edge of the outline": ([], "warning"),
        "upper edge of the outline": (["chamfer outline"], "broken"),
        "lower edge of the bore": ([], "warning"),
        "upper edge of the bore": ([], "warning"),
    }
    assert (rows["upper edge of the outline"]["stated_mm"], 2.0) == (
        0.8,
        rows["upper edge of the outline"]["made_mm"],
    )
    assert "8 mm wide at 90 deg" in rows["keyway"]["sentence"]
    found = told(SCENE)
    assert [each.sentence for each in found["left-out"]] == ["no operation makes mark"]
    assert found["chamfers"][0].sentence == (
        "no operation makes the chamfers of lower edge of the outline, bore"
    )


def edge(scene: str) -> Feature:
    """The upper edge of the outline."""
    features = compared(camgeo.loads(scene.replace(MARK, "")).disc.milled)
    (found,) = (each for each in features if each.name == "upper edge of the outline")
    return found


@pytest.mark.parametrize(
    ("size", "severity"),
    [("2", "broken"), ("0.9", "broken"), ("0.8", "ok"), ("0.5", "warning")],
)
def test_a_chamfer_of_another_size_is_told(size: str, severity: str) -> None:
    assert edge(SCENE.replace("size = 2\n", f"size = {size}\n")).severity == severity


def test_a_cone_of_another_angle_makes_another_chamfer() -> None:
    """60 degrees at the point: as wide on the face, 0.8 / tan 30 = 1.39 mm high."""
    scene = SCENE.replace("size = 2\n", "size = 0.8\n")
    found = edge(scene.replace("tip_angle = 90", "tip_angle = 60"))
    assert found.severity == "broken"
    assert "0.8 mm wide and 1.39 mm high" in found.sentence


def test_a_chamfer_that_the_part_does_not_have_is_told() -> None:
    found = edge(SCENE.replace(CHAMFERS, ""))
    assert found.severity == "warning"
    assert found.sentence.endswith("2 mm wide, the part states a sharp edge")


def test_what_the_blank_is_higher_is_told() -> None:
    """Its lower face is cut by nobody."""
    scene = SCENE.replace("bottom = 0\n", "bottom = 1.5\n").replace('"screws"', '"fixture"')
    _, found, *_ = compared(camgeo.loads(scene).disc.milled)
    assert found.sentence == "lower face: no operation takes off 1.5 mm of the blank"
    assert (found.severity, found.stated, found.made) == ("warning", 0.0, 1.5)
