"""The result of `camgeo laws`, rendered as text, JSON and picture."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest

from camgeo.app.answers.answer import text
from camgeo.app.answers.laws import LawRow, laws_of_all_tasks, laws_of_task
from camgeo.errors import GeometryError
from camgeo.kinematics.laws.comparison import Running, compare
from camgeo.kinematics.motion import TASKS
from tests.answers.documents import document

MOVE = Running(4.0 * math.pi, math.radians(60.0), 25.0)


def test_text_and_document_are_of_one_result() -> None:
    found = laws_of_task("R-R", {}, ["modified-sine", "scca"], running=MOVE, places=True)
    reported = document(found)
    assert reported["running"]["speed_rad_per_s"] == MOVE.speed
    other, rows = LawRow(compare("U-U", {}, ["simple-sine"])[0]), found.rows or ()
    changed = replace(found, rows=(other, rows[1]))
    assert [each["law"] for each in document(changed)["laws"]] == ["simple-sine", "scca"]
    assert "modified-sine" not in text(changed)
    acceleration = document(changed)["laws"][0]["values"]["acceleration"]["value"]
    assert f"{acceleration:.5f}" in text(changed)
    assert f"{acceleration:.5f}" not in text(found)
    assert reported["laws"][1] == document(changed)["laws"][1]
    assert text(replace(found, places=False)).count("at z") == 0 < text(found).count("at z")


def test_all_tasks_as_text_and_document() -> None:
    found = laws_of_all_tasks(["cycloidal", "modified-sine"])
    reported = document(found)
    assert "laws" not in reported
    assert [each["task"] for each in reported["tasks"]] == list(TASKS)
    assert list(reported["tasks"][0]["laws"]) == ["inclined-sine", "modified-sine"]
    changed = replace(found, tasks=(replace((found.tasks or ())[0], families={"lunar": ("v0",)}),))
    assert document(changed)["tasks"][0]["laws"] == {"lunar": ["v0"]}
    assert text(changed).endswith("lunar")
    with pytest.raises(GeometryError, match="did you mean modified-sine"):
        laws_of_all_tasks(["modified-sin"])
