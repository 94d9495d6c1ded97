"""What goes with a choice."""

from __future__ import annotations

import pathlib
from typing import Any

import pytest

from camgeo.app.designing.edits import changed
from camgeo.errors import Fault, SceneError
from camgeo.scene.scene import parse_scene
from tests.designing.scenes import FILES, SETZHUB, TEXT, design, name_of
from tests.designing.test_edits import comments, exact

ROLLERS = [file for file in FILES if "\nroller_radius" in file.read_text("utf-8")]
ROLLERS = [file for file in ROLLERS if "knife" not in file.stem]  # which no groove holds


def edit(text: str, edits: dict[str, Any]) -> str:
    return changed(text, str(SETZHUB), None, {"edits": edits}).text


@pytest.mark.parametrize("file", ROLLERS, ids=name_of)
@pytest.mark.parametrize("contact", ["inner", "outer", "groove"])
def test_a_cam_runs_on_another_flank(file: pathlib.Path, contact: str) -> None:
    """Formats, effects and milling that do not suit it are told, and nothing else."""
    text = file.read_text("utf-8")
    asked = {"edits": {"follower.contact": contact}}
    found = changed(text, str(file), None, asked, design(file))
    assert exact(found.text)["follower"]["contact"] == contact
    assert comments(found.text)[:3] == comments(text)[:3]
    tables = {each.key.partition(".")[0] for each in faults(found.text, file)}
    assert tables <= {"output", "effects", "stock", "holding", "operation[1]"}


def faults(text: str, file: pathlib.Path) -> tuple[Fault, ...]:
    try:
        parse_scene(text, folder=file.parent)
    except SceneError as error:
        return error.faults
    return ()


def test_a_groove_has_a_blank_and_a_depth() -> None:
    part = exact(edit(TEXT, {"follower.contact": "groove"}))["part"]
    assert part["groove_depth"] == 6
    cam = design(SETZHUB).cam
    assert part["rim"] / 2 > cam.follower.base_radius + cam.follower.roller_radius
    back = edit(edit(TEXT, {"follower.contact": "groove"}), {"follower.contact": "inner"})
    assert exact(back)["part"] == exact(TEXT)["part"]


def test_a_linkage_decides_the_direction() -> None:
    assert "direction" not in exact(edit(TEXT, {"linkage.mirrored": True}))["follower"]
    # Who states it hears of it.
    stated = exact(edit(TEXT, {"linkage.mirrored": True, "follower.direction": "inward"}))
    assert stated["follower"]["direction"] == "inward"


def test_another_law_takes_its_own_parameters() -> None:
    text = TEXT.replace("span = 80", "span = 80\ninflection = 0.4")
    assert "inflection" in edit(text, {"motion[2].law": "modified-trapezoid"})
    found = edit(text, {"motion[2].law": "polynomial-5"})
    assert "inflection" not in found
    parse_scene(found)


def test_a_motion_through_points_starts_with_one() -> None:
    there = edit(TEXT, {"motion[2].law": "points"})
    (point,) = exact(there)["motion"][1]["points"]
    assert {key: float(each) for key, each in point.items()} == {"at": 40, "to": 29.25}
    parse_scene(there)
    back = edit(there, {"motion[2].law": "polynomial-345"})
    assert exact(back) == exact(TEXT)
    assert comments(back) == comments(TEXT)
