"""Undo and redo of texts: each step can be taken back and made again, whatever was changed."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from camgeo.app.designing import desk
from camgeo.app.designing.desk import History, splice, spliced

TEXTS = st.text(alphabet="ab\n#ä", max_size=12)


@given(TEXTS, TEXTS)
def test_a_splice_leads_from_one_text_to_the_other_and_back(before: str, after: str) -> None:
    at, gone, there = splice(before, after)
    assert spliced(before, at, gone, there) == after
    assert spliced(after, at, there, gone) == before
    assert not gone or not there or (gone[0] != there[0] and gone[-1] != there[-1])


def test_a_splice_that_does_not_fit_is_refused() -> None:
    with pytest.raises(ValueError, match="does not fit"):
        spliced("abc", 1, "x", "y")


@given(st.lists(TEXTS, max_size=6))
def test_what_is_undone_can_be_redone(texts: list[str]) -> None:
    found = History("start")
    seen = [found]
    for text in texts:
        found = found.changed(text, f"to {text}")
        if found.text != seen[-1].text:
            seen.append(found)
    for before in reversed(seen[:-1]):
        found = found.undone()
        assert found.text == before.text
        assert found.undo == before.undo
    assert found.undone() == found
    for after in seen[1:]:
        found = found.redone()
        assert (found.text, found.undo) == (after.text, after.undo)
    assert found.redone() == found


def test_a_change_ends_what_can_be_redone() -> None:
    found = History("a").changed("b", "one").undone().changed("c", "two")
    assert found.redo is None
    assert found.undone().text == "a"


@given(st.lists(TEXTS, min_size=1, max_size=6))
def test_a_gesture_is_one_step(texts: list[str]) -> None:
    found = History("start").changed("before", "step")
    for text in texts:
        found = found.changed(text, f"to {text}", "drag")
    assert found.undone().text == ("before" if texts[-1] != "before" else "start")
    assert len(found.past) == 1 + (texts[-1] != "before")


def test_two_gestures_are_two_steps_and_one_that_was_undone_is_over() -> None:
    found = History("a").changed("b", "one", "first").changed("c", "two", "second")
    assert [step.label for step in found.past] == ["one", "two"]
    again = found.undone().redone().changed("d", "more", "second")
    assert [step.label for step in again.past] == ["one", "two", "more"]


def test_steps_are_bounded_in_number_and_in_size(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(desk, "MOST_STEPS", 5)
    found = History("")
    for number in range(20):
        found = found.changed(str(number), str(number))
    assert [step.label for step in found.past] == ["15", "16", "17", "18", "19"]
    monkeypatch.setattr(desk, "MOST_CHARACTERS", 1000)
    large = found.changed("x" * 2000, "large")
    assert [step.label for step in large.past] == ["large"]
    assert large.undone().text == "19"


def test_a_small_change_of_a_large_text_keeps_little() -> None:
    text = "x = 1\n" * 100_000
    (step,) = History(text).changed(f"{text[:300_000]}y{text[300_001:]}", "one").past
    assert len(step) <= 2
