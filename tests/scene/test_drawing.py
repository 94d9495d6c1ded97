"""The table [drawing] of a scene."""

from __future__ import annotations

import pytest

from camgeo.errors import SceneError
from camgeo.scene.formats.drawing import DrawingSpec
from camgeo.scene.scene import parse_scene
from camgeo.scene.schema import schema_of_all
from tests.scene.scenes import PLATE


def test_a_scene_without_the_table_has_the_defaults_and_its_old_identity() -> None:
    """A format's table with a default would be part of every scene's hash."""
    assert parse_scene(PLATE).drawing == DrawingSpec()
    top = schema_of_all({})["properties"]
    assert "default" not in top["drawing"]
    assert "default" not in top["output"]["properties"]["drawing"]


def test_its_values_are_taken() -> None:
    table = '[drawing]\nsheet = "A4"\nstep = 20\nflank_tolerance = 0.02\nbore_fit = "H7"\n'
    spec = parse_scene(PLATE + table).drawing
    assert (spec.sheet, spec.step, spec.flank_tolerance, spec.bore_fit) == ("A4", 20, 0.02, "H7")
    inches = parse_scene(PLATE.replace('length = "mm"', 'length = "inch"') + table).drawing
    assert inches.flank_tolerance == pytest.approx(0.508)


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ('scale = "1:3"', r'drawing\.scale = "1:3": must be a standard scale'),
        ('date = "1.3.2026"', "must be a date in quotes"),
        ('title = ""', "must be a text of 1 to 80 characters"),
        ('title = "100%"', "without %"),
        ('bore_fit = "tight"', "must be a tolerance class"),
        ("step = 7", r"drawing\.step = 7: must be 5, 10, 15"),
        ('sheet = "A5"', 'must be one of "A3", "A4"'),
        ('langauge = "de"', r"is not a known key \(did you mean language\?\)"),
    ],
)
def test_wrong_values_are_refused_with_their_key(line: str, message: str) -> None:
    with pytest.raises(SceneError, match=message):
        parse_scene(f"{PLATE}[drawing]\n{line}\n")
