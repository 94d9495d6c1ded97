"""Changes of a motion's segments."""

from __future__ import annotations

import pathlib
import tomllib
from decimal import Decimal
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from camgeo.app.designing.edits import ACTIONS, changed, total
from camgeo.app.designing.form import motion_spans
from camgeo.errors import SceneError
from tests.designing.scenes import FILES, FIXTURES, SETZHUB, TEXT, design


def motion(text: str) -> list[dict[str, Any]]:
    found: list[dict[str, Any]] = tomllib.loads(text, parse_float=Decimal)["motion"]
    return found


def test_the_only_segment_cannot_be_removed() -> None:
    with pytest.raises(SceneError):
        changed("motion = [{ dwell = 360 }]", "", None, {"segment": {"action": "remove", "at": 0}})


def test_a_move_becomes_a_dwell() -> None:
    text = TEXT.replace("to = 0", "to = 20", 1) + "\n"
    text = text.replace("[[motion]]\ndwell = 60", '[[motion]]\nlaw="auto"\nspan = 60\nto = 0')
    asked = {"segment": {"action": "to-dwell", "at": 1}}
    found = changed(text, "", FIXTURES, asked, design(SETZHUB))
    assert found.scene is not None
    assert motion(found.text)[1] == {"dwell": 80}


@settings(max_examples=25, deadline=None)
@given(data=st.data())
def test_the_spans_add_up_after_any_changes(data: st.DataObject) -> None:
    file: pathlib.Path = data.draw(st.sampled_from(FILES))
    text = file.read_text("utf-8")
    for _ in range(3):
        at = data.draw(st.integers(0, len(motion(text)) - 1))
        asked = {"action": data.draw(st.sampled_from(sorted(ACTIONS))), "at": at}
        try:
            text = changed(text, str(file), None, {"segment": asked}).text
        except SceneError:
            continue
        spans = motion_spans(motion(text))
        assert spans is not None
        assert total(spans) == 360


def test_comments_of_other_segments_stay() -> None:
    text = TEXT.replace("dwell = 20", "dwell = 20  # upper rest").replace(
        "to = 0", "to = 0  # back"
    )
    found = changed(text, "", None, {"segment": {"action": "remove", "at": 0}}).text
    assert "dwell = 20  # upper rest" in found
    assert "to = 0  # back" in found
