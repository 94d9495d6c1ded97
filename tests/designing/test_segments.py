"""Changes of a motion's segments."""

from __future__ import annotations

import pathlib
import tomllib
from decimal import Decimal
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from camgeo.app.designing.edits import changed
from camgeo.app.designing.segments import ACTIONS, spans_of, total
from camgeo.errors import SceneError
from tests.designing.scenes import FILES, FIXTURES, design

SETZHUB = FIXTURES / "scenes" / "setzhub.toml"
TEXT = SETZHUB.read_text("utf-8")


def motion(text: str) -> list[dict[str, Any]]:
    found: list[dict[str, Any]] = tomllib.loads(text, parse_float=Decimal)["motion"]
    return found


def after(action: str, at: int, text: str = TEXT) -> list[dict[str, Any]]:
    found = changed(text, "", FIXTURES, {"segment": {"action": action, "at": at}}, design(SETZHUB))
    assert found.scene is not None
    return motion(found.text)


def test_a_dwell_is_inserted() -> None:
    found = after("insert", 1)
    assert [each.get("span", each.get("dwell")) for each in found] == [110, 40, 40, 20, 90, 60]
    assert found[2] == {"dwell": 40}


def test_a_segment_is_removed_and_a_dwell_takes_its_span() -> None:
    assert after("remove", 0)[0] == {"law": "polynomial-345", "span": 190, "to": Decimal("58.5")}
    assert [each.get("dwell") for each in after("remove", 2)] == [110, None, None, 60]
    with pytest.raises(SceneError):
        changed("motion = [{ dwell = 360 }]", "", None, {"segment": {"action": "remove", "at": 0}})


def test_the_last_of_two_moves_cannot_go_without_the_other() -> None:
    """Unless it is the first one: then nothing is left to return from."""
    found = changed(TEXT, "", None, {"segment": {"action": "remove", "at": 3}}, design(SETZHUB))
    assert [each.get("to") for each in motion(found.text)][1] in (0, Decimal("58.5"))


def test_a_segment_is_split() -> None:
    dwells = after("split", 0)
    assert dwells[:2] == [{"dwell": 55}, {"dwell": 55}]
    moves = after("split", 1)
    assert [(each["span"], each["to"]) for each in moves[1:3]] == [
        (40, Decimal("29.25")),
        (40, Decimal("58.5")),
    ]


def test_segments_change_places() -> None:
    assert after("down", 1)[1] == {"dwell": 20}
    assert after("up", 2) == after("down", 1)
    with pytest.raises(SceneError, match="end of the motion"):
        after("up", 0)


def test_a_move_becomes_a_dwell_and_a_dwell_a_move() -> None:
    assert after("to-move", 2)[2]["to"] == Decimal("29.25")
    rise, fall = after("to-move", 4)[4:]
    assert (rise["to"], fall["to"], rise["span"] + fall["span"]) == (Decimal("58.5"), 0, 60)
    text = TEXT.replace("to = 0", "to = 20", 1) + "\n"
    text = text.replace("[[motion]]\ndwell = 60", '[[motion]]\nlaw="auto"\nspan = 60\nto = 0')
    assert after("to-dwell", 1, text)[1] == {"dwell": 80}


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
        spans = spans_of(motion(text))
        assert spans is not None
        assert total(spans) == 360


def test_comments_of_other_segments_stay() -> None:
    text = TEXT.replace("dwell = 20", "dwell = 20  # upper rest").replace(
        "to = 0", "to = 0  # back"
    )
    found = changed(text, "", None, {"segment": {"action": "remove", "at": 0}}).text
    assert "dwell = 20  # upper rest" in found
    assert "to = 0  # back" in found
