"""The motion plan as rows."""

from __future__ import annotations

import json
import pathlib
from typing import Any

import pytest

from camgeo.app.designing.form import Fields
from camgeo.scene.values import Document, document
from tests.designing.scenes import CHOSEN, design, name_of


@pytest.mark.parametrize("file", CHOSEN, ids=name_of)
def test_rows_are_the_segments(file: pathlib.Path) -> None:
    found = Fields(document(file.read_bytes())).plan()
    own = design(file).drive.plan
    assert [each["from"] for each in found] == [float(angle) for angle in own.joints_deg[:-1]]
    assert found[-1]["to"] == 360.0
    assert all(each["fields"] for each in found)
    json.dumps(found, allow_nan=False)


def test_a_row_has_the_parameters_that_its_law_takes() -> None:
    def keys(law: Any, **more: Any) -> set[str]:
        move = {"law": law, "span": 360, "to": 0, **more}
        (row,) = Fields(Document.from_values({"motion": [move]})).plan()
        return {each["title"] for each in row["fields"]} - {
            "law",
            "span",
            "to",
            "velocity",
            "acceleration",
        }

    assert keys("polynomial-345") == {"inflection"}
    assert keys("polynomial-7") == {"jerk"}
    assert keys("polynomial-5") == set()
    assert keys("scca") == {"inflection", "sine", "cosine", "curved"}
    assert keys("cycloidal") == {"inflection"}
    assert keys("auto") > {"optimise", "inflection"}
    assert keys("polynomial-5", jerk=3) == {"jerk"}
    assert {"sine", "inflection"} <= keys("no") & keys([])


def test_a_default_may_depend_on_the_law() -> None:
    (row,) = Fields(
        Document.from_values({"motion": [{"law": "scca", "span": 360, "to": 0}]})
    ).plan()
    assert {each["title"]: each.get("default") for each in row["fields"]}["sine"] == 0.25


@pytest.mark.parametrize(
    "motion",
    [
        3, {}, [], [3], [[]], [{"dwell": "x"}], [{"law": 3}], [{"law": "no", "span": -1}],
        [{"span": 10**50}], [{"dwell": True}], [{"law": "points", "points": 3, "span": 360}],
        [{"dwell": 0}] * 3000,
    ],
)  # fmt: skip
def test_any_motion_has_rows(motion: Any) -> None:
    data = Fields(Document.from_values({"motion": motion})).plan()
    json.dumps(data, allow_nan=False)
    assert len(data) <= 400
