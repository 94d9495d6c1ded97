"""Paths of single values: all that scenes state is found, and what no scene has is refused."""

from __future__ import annotations

import pytest

from camgeo.errors import SceneError
from camgeo.scene.keys import spelled
from camgeo.scene.scene import load_scene
from camgeo.scene.values import value_path
from tests.answers.documents import FIXTURES
from tests.scene.scenes import values_in


@pytest.mark.parametrize(
    "name", ["scenes/setzhub", "scenes/hub_and_holes", "effects/press", "effects/four_bar"]
)
def test_every_value_of_a_scene_has_a_path(name: str) -> None:
    tree = load_scene(FIXTURES / f"{name}.toml").stated.scene.exact
    for path, value in values_in(tree):
        if isinstance(value, dict | list):
            continue
        assert value_path(tree, spelled(path)) == path
        dotted = ".".join(str(step + 1) if isinstance(step, int) else step for step in path)
        assert value_path(tree, dotted) == path


def test_keys_that_a_scene_may_state_have_one_too() -> None:
    tree = load_scene(FIXTURES / "scenes" / "setzhub.toml").stated.scene.exact
    assert value_path(tree, "limits.diameter") == ("limits", "diameter")
    assert value_path(tree, "motion[2].inflection") == ("motion", 1, "inflection")


@pytest.mark.parametrize(
    ("key", "message"),
    [
        ("", "is no key of a scene"),
        ("motion[2", "is no key of a scene"),
        ("folower.base_radius", "did you mean follower?"),
        ("follower.arm.length", "follower.arm is a single value"),
        ("follower[1]", "follower is not a list"),
        ("motion", "is a list: name a position in it"),
        ("motion[0].law", "its positions are 1 to 5"),
        ("operation[1].kind", "the scene states none of it"),
        ("part", "is a table: name one of its keys"),
    ],
)
def test_what_is_no_single_value(key: str, message: str) -> None:
    tree = load_scene(FIXTURES / "scenes" / "setzhub.toml").stated.scene.exact
    with pytest.raises(SceneError) as error:
        value_path(tree, key)
    assert message in str(error.value)
