"""What pages say: taken apart, or answered with a sentence, whatever it is."""

from __future__ import annotations

import contextlib
import json
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from camgeo_export.designer.session import KINDS, MessageError, Said, understood

JSON = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=5),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=5), inner),
    max_leaves=8,
)


@pytest.mark.parametrize(
    ("message", "arguments"),
    [
        ({"kind": "change", "edits": {"follower.roller_radius": 8}}, None),
        ({"kind": "change", "handle": "joint-2", "to": [30, 1.5], "gesture": "g"}, None),
        ({"kind": "change", "handle": "joint-2", "to": [30, 1.5], "step": 0.5}, None),
        ({"kind": "change", "segment": {"action": "split", "at": 2}}, None),
        ({"kind": "change", "cure": 0, "gesture": None}, {"cure": 0}),
        ({"kind": "text", "text": "a = 1"}, None),
        ({"kind": "save"}, None),
        ({"kind": "save", "path": "a.toml", "force": True}, None),
        ({"kind": "build", "formats": ["dxf"]}, None),
        ({"kind": "undo"}, None),
    ],
)  # fmt: skip
def test_messages_of_the_page_are_understood(
    message: dict[str, Any], arguments: dict[str, Any] | None
) -> None:
    if arguments is None:
        arguments = {key: value for key, value in message.items() if key != "kind"}
    assert understood(json.dumps({**message, "id": 7})) == Said(message["kind"], 7, arguments)


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("", "must be JSON"),
        ("{", "must be JSON"),
        ("[" * 100_000, "must be JSON"),
        ('{"a":' * 100_000, "must be JSON"),
        ("[]", "must be a table"),
        ("1", "must be a table"),
        ("9" * 5000, "must be JSON"),
        ("{}", "kind must be one of hello"),
        ('{"kind": 1}', "kind must be one of"),
        ('{"kind": []}', "kind must be one of"),
        ('{"kind": "undo", "x": 1}', "undo has no 'x'"),
        ('{"kind": "undo", "id": []}', "id must be"),
        ('{"kind": "undo", "id": 1e400}', "finite numbers"),
        ('{"kind": "text"}', "text needs text"),
        ('{"kind": "text", "text": 1}', "text of text is not"),
        ('{"kind": "open", "path": "' + "x" * 201 + '"}', "path of open is not"),
        ('{"kind": "change"}', "change needs one of"),
        ('{"kind": "change", "cure": 1, "edits": {}}', "change needs one of"),
        ('{"kind": "change", "cure": true}', "cure of change is not"),
        ('{"kind": "change", "handle": "a"}', "a place to go to"),
        ('{"kind": "change", "handle": "a", "to": [1]}', "to of change is not"),
        ('{"kind": "change", "handle": "a", "to": [1, NaN]}', "must be JSON"),
        ('{"kind": "change", "handle": "a", "to": [1, 1e999]}', "finite numbers"),
        ('{"kind": "change", "edits": {"a": [[[[[[[[1]]]]]]]]}}', "8 deep"),
    ],
)
def test_others_are_answered_with_a_sentence(text: str, sentence: str) -> None:
    with pytest.raises(MessageError, match=sentence):
        understood(text)


def test_an_answer_has_the_id_of_its_message() -> None:
    with pytest.raises(MessageError) as refused:
        understood('{"kind": "nonsense", "id": "a7"}')
    assert refused.value.id == "a7"


@given(st.text(max_size=20) | JSON.map(json.dumps))
def test_any_text_is_understood_or_refused(text: str) -> None:
    with contextlib.suppress(MessageError):
        assert understood(text).kind in KINDS


NAMES = ("id", "text", "to", "edits", "path", "cure", "handle", "segment", "gesture")


@given(st.sampled_from(sorted(KINDS)), st.dictionaries(st.sampled_from(NAMES), JSON))
def test_any_arguments_are_understood_or_refused(kind: str, given: dict[str, Any]) -> None:
    with contextlib.suppress(MessageError):
        said = understood(json.dumps({"kind": kind, **given}))
        assert said.arguments.keys() <= KINDS[kind].keys()
