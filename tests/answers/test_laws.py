"""The result of `camgeo laws`, rendered as text, JSON and picture."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest

from camgeo.app.answers.answer import text
from camgeo.app.answers.laws import laws_of_all_tasks
from camgeo.errors import GeometryError
from camgeo.kinematics.laws.comparison import Running
from camgeo.kinematics.motion import TASKS
from tests.answers.documents import document

MOVE = Running(4.0 * math.pi, math.radians(60.0), 25.0)


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
