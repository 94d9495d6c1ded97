"""Effects that are switched on and off."""

from __future__ import annotations

import contextlib
import pathlib
from typing import Any

import pytest

from camgeo.app.designing.edits import EXAMPLES, changed
from camgeo.dynamics.effects.registry import EFFECTS
from camgeo.errors import SceneError, UnknownNameError
from tests.designing.scenes import CHOSEN, FILES, FIXTURES, SETZHUB, TEXT, design, name_of
from tests.designing.test_edits import comments, exact


def test_examples_are_of_effects() -> None:
    assert EXAMPLES.keys() <= set(EFFECTS)


REFUSALS = (
    "supports a ", "is for roller", "contradicts [", "is missing: spring-surge",
    "is 0, a knife edge",
)  # fmt: skip


@pytest.mark.parametrize("file", CHOSEN, ids=name_of)
def test_an_effect_is_switched(file: pathlib.Path) -> None:
    """The scene is valid then; what the machine cannot have is refused with the reason."""
    text, own = file.read_text("utf-8"), design(file)
    for name in list(EFFECTS)[FILES.index(file) % 3 :: 3]:
        on = name not in own.scene.effects
        asked = {"effect": {"name": name, "on": on}}
        try:
            found = changed(text, str(file), None, asked, own)
        except SceneError as error:
            reasons = [fault.message for fault in error.faults]
            assert on
            assert any(each.startswith(REFUSALS) for each in reasons), reasons
            continue
        assert found.scene is not None
        assert (name in found.scene.effects) == on
        assert found.label == f"{name.replace('-', ' ')} {'on' if on else 'off'}"
        if on:
            assert comments(found.text) == comments(text)
            off = changed(found.text, str(file), None, {"effect": {"name": name, "on": False}})
            assert name not in exact(off.text).get("effects", {})


def test_what_an_effect_needs_comes_with_it() -> None:
    text = TEXT.replace("speed = 90\n", "")
    found = exact(
        changed(text, str(SETZHUB), None, {"effect": {"name": "gravity", "on": True}}).text
    )
    assert found["effects"].keys() == {"inertia", "gravity"}
    assert found["cam"]["speed"] == 60


def test_what_needs_an_effect_goes_with_it() -> None:
    file = FIXTURES / "effects" / "press.toml"
    asked = {"effect": {"name": "inertia", "on": False}}
    found = exact(changed(file.read_text("utf-8"), str(file), None, asked).text)
    assert "gravity" not in found["effects"]
    assert "spring" in found["effects"]


@pytest.mark.parametrize("asked", [3, {}, {"name": "spring"}, {"name": "spring", "on": 1}])
def test_what_is_no_effect_is_refused(asked: object) -> None:
    with pytest.raises(SceneError):
        changed(TEXT, str(SETZHUB), None, {"effect": asked})
    with pytest.raises(UnknownNameError):
        changed(TEXT, str(SETZHUB), None, {"effect": {"name": "no", "on": True}})
    with pytest.raises(SceneError, match="is off"):
        changed(TEXT, str(SETZHUB), None, {"effect": {"name": "spring", "on": False}})


@pytest.mark.parametrize("number", ["nan", "-inf", "1e9999999"])
@pytest.mark.parametrize(
    ("stated", "asked"),
    [
        ("speed = 90", {"effect": {"name": "speed-fluctuation", "on": True}}),
        ("base_radius = 50.199", {"effect": {"name": "friction", "on": True}}),
        ("thickness = 12", {"edits": {"follower.contact": "groove"}}),
        ("thickness = 12", {"edits": {"follower.contact": "outer"}}),
    ],
)
def test_a_scene_with_a_number_that_is_none_can_be_changed(
    stated: str, asked: dict[str, Any], number: str
) -> None:
    """Its fault stays, and values to start from are made without it; or it is refused."""
    key = stated.partition(" ")[0]
    assert stated in TEXT
    text = TEXT.replace(stated, f"{key} = {number}")
    with contextlib.suppress(SceneError):
        assert f"{key} = {number}\n" in changed(text, str(SETZHUB), None, asked).text
