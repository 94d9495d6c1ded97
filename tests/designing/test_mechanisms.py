"""Other kinds of followers and linkages."""

from __future__ import annotations

import pathlib
from typing import Any

import pytest

from camgeo.app.designing.edits import changed
from camgeo.errors import SceneError, UnknownNameError
from camgeo.kinematics.mechanism.declared.registry import FOLLOWERS, LINKAGES
from tests.designing.scenes import CHOSEN, FILES, FIXTURES, SETZHUB, TEXT, design, name_of
from tests.designing.test_edits import exact

OTHERS = [
    *(("follower", kind) for kind in FOLLOWERS),
    *(("linkage", kind) for kind in (*LINKAGES, None)),
]
BY_FILE = "measured"
"""A scene whose lift table gives a unit that other followers do not have."""


@pytest.mark.parametrize("file", CHOSEN, ids=name_of)
def test_every_kind_makes_a_valid_scene(file: pathlib.Path) -> None:
    text = file.read_text("utf-8")
    for key, kind in OTHERS[FILES.index(file) % 2 :: 2]:
        found = changed(text, str(file), None, {"table": {"key": key, "kind": kind}}, design(file))
        assert found.scene is not None or file.stem == BY_FILE, (key, kind)
        table = exact(found.text).get(key)
        assert (None if table is None else table["kind"]) == kind


def test_positions_change_with_their_unit() -> None:
    """A rocker of the arm l swings by s / l for a lift s."""
    file = FIXTURES / "scenes" / "shuttle.toml"
    scene: dict[str, Any] = exact(file.read_text("utf-8"))
    asked = {"key": "follower", "kind": "translating-roller"}
    found = changed(file.read_text("utf-8"), str(file), None, {"table": asked}, design(file))
    arm = float(scene["follower"]["arm"])
    for one, other in zip(scene["motion"], exact(found.text)["motion"], strict=True):
        if "to" in one:
            expected = float(one["to"]) * arm * 3.14159265 / 180
            assert float(other["to"]) == pytest.approx(expected, rel=0.005)


@pytest.mark.parametrize(
    ("asked", "error"),
    [
        ({"key": "follower", "kind": "no"}, UnknownNameError),
        ({"key": "follower", "kind": 3}, UnknownNameError),
        (None, SceneError),
        ({}, SceneError),
        ({"key": "cam", "kind": "x"}, SceneError),
    ],
)
def test_a_table_or_kind_that_there_is_not_is_refused(asked: Any, error: type[Exception]) -> None:
    with pytest.raises(error):
        changed(TEXT, str(SETZHUB), None, {"table": asked})
