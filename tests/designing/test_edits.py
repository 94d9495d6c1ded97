"""Changes of a scene's text."""

from __future__ import annotations

import pathlib

import pytest

from camgeo.designing.edits import changed
from camgeo.errors import SceneError

FIXTURES = pathlib.Path(__file__).parents[2] / "fixtures" / "scenes"
SETZHUB = (FIXTURES / "setzhub.toml").read_text("utf-8")


def test_a_key_is_changed_in_the_text() -> None:
    found = changed(SETZHUB, "", FIXTURES, {"edits": {"follower.roller_radius": 8}})
    assert found.text == SETZHUB.replace("roller_radius = 7.0", "roller_radius = 8")
    assert found.label == "roller radius 8"


@pytest.mark.parametrize("arguments", [{}, {"edits": 3}, {"edits": {"motion[9].to": 1}}])
def test_what_cannot_be_changed_is_refused(arguments: dict[str, object]) -> None:
    with pytest.raises(SceneError):
        changed(SETZHUB, "", FIXTURES, arguments)
