"""The result of `camgeo size`, rendered as text, JSON and picture."""

from __future__ import annotations

import json
import math
from dataclasses import replace
from functools import cache
from pathlib import Path

import pytest

from camgeo.answers.render import figure, text
from camgeo.answers.size import CamSize, resized, size, sized_scene
from camgeo.check.sizing.smallest import Sizing
from camgeo.design import Design
from camgeo.errors import GeometryError
from camgeo.scene.load import load_scene
from tests.answers.documents import FIXTURES, document

NAMES = ("inch", "plate_translating", "ring", "setzhub", "vorschub")
"""Guides and rockers, with a linkage and without, in mm and inch, inside and outside."""

SETZHUB = FIXTURES / "scenes" / "setzhub.toml"


@cache
def with_arm() -> CamSize:
    """A sizing whose arm was sought."""
    return size(Design(load_scene(SETZHUB)), arms=(40.0, 60.0))


@pytest.mark.parametrize("name", NAMES)
def test_documents_are_what_their_schema_says(name: str) -> None:
    scene: Path = FIXTURES / "scenes" / f"{name}.toml"
    found = size(Design(load_scene(scene)))
    reported = document(found)
    assert found.sizing.answer is not None
    assert reported["smallest"]["base_radius_mm"] == found.sizing.answer.base_radius
    assert ("pivot_mm" in reported["smallest"]) == (found.task.held is not None)
    assert reported["infeasible"] is None
    assert len(reported["active"]) == text(found).count("at cam angle") - text(found).count(
        "optimistic"
    )
    json.dumps(figure(found).to_data(), allow_nan=False)


def test_what_cannot_be_met_is_reported_in_the_same_way() -> None:
    found = size(Design(load_scene(SETZHUB)), transmission_angle=math.radians(80.0))
    reported = document(found)
    assert (reported["smallest"], reported["active"], found.exit_code) == (None, [], 1)
    assert reported["infeasible"] in text(found).splitlines()
    assert reported["nearest"]["transmission_angle_deg"] < 80.0
    with pytest.raises(GeometryError, match="only just"):
        sized_scene(found)


def test_text_and_document_are_of_one_result() -> None:
    found = with_arm()
    reported = document(found)
    assert (reported["present"]["arm_mm"], reported["smallest"]["arm_mm"]) == (61.29, 40.0)
    answer = found.sizing.answer
    assert answer is not None
    other = replace(answer, radius_ratio=replace(answer.radius_ratio, value=0.1234))
    sizing: Sizing = replace(found.sizing, answer=other)
    changed = replace(found, sizing=sizing)
    assert document(changed)["smallest"]["radius_ratio"]["largest"] == 0.1234
    (row,) = [line for line in text(changed).splitlines() if line.startswith("smallest")]
    assert "0.1234" in row.split()
    assert "0.1234" not in text(found)


def test_the_scene_with_the_answer_keeps_what_was_required() -> None:
    found = with_arm()
    written = sized_scene(found)
    assert found.sizing.answer is not None
    again = size(Design(written))
    assert again.present is not None
    assert again.present.follower.arm == 40.0
    assert again.present.base_radius == pytest.approx(found.sizing.answer.base_radius, rel=1e-9)
    assert again.present.transmission_angle.value >= found.sizing.angle
    assert resized(written, {}) is not found.scene
