"""What pages say, and what they are told: taken apart, or answered; no more waits than needed."""

from __future__ import annotations

import asyncio
import contextlib
import json
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st
from starlette.websockets import WebSocket

from camgeo_export.designer.session import (
    KINDS,
    MOST_WAITING,
    Message,
    MessageError,
    Page,
    PageMessage,
    body,
    parse_message,
)

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
    assert parse_message(json.dumps({**message, "id": 7})) == PageMessage(
        message["kind"], 7, arguments
    )


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
        ('{"kind": "text", "text": 1}', "text of text has"),
        ('{"kind": "open", "path": "' + "x" * 201 + '"}', "path of open has"),
        ('{"kind": "change"}', "change needs one of"),
        ('{"kind": "change", "cure": 1, "edits": {}}', "change needs one of"),
        ('{"kind": "change", "cure": true}', "cure of change has"),
        ('{"kind": "change", "handle": "a"}', "the place `to` is needed"),
        ('{"kind": "change", "handle": "a", "to": [1]}', "to of change has"),
        ('{"kind": "change", "handle": "a", "to": [1, NaN]}', "must be JSON"),
        ('{"kind": "change", "handle": "a", "to": [1, 1e999]}', "finite numbers"),
        ('{"kind": "change", "edits": {"a": [[[[[[[[1]]]]]]]]}}', "8 deep"),
    ],
)
def test_others_are_answered_with_a_sentence(text: str, sentence: str) -> None:
    with pytest.raises(MessageError, match=sentence):
        parse_message(text)


def test_an_answer_has_the_id_of_its_message() -> None:
    with pytest.raises(MessageError) as refused:
        parse_message('{"kind": "nonsense", "id": "a7"}')
    assert refused.value.id == "a7"


@given(st.text(max_size=20) | JSON.map(json.dumps))
def test_any_text_is_understood_or_refused(text: str) -> None:
    with contextlib.suppress(MessageError):
        assert parse_message(text).kind in KINDS


NAMES = ("id", "text", "to", "edits", "path", "cure", "handle", "segment", "gesture")


@given(st.sampled_from(sorted(KINDS)), st.dictionaries(st.sampled_from(NAMES), JSON))
def test_any_arguments_are_understood_or_refused(kind: str, given: dict[str, Any]) -> None:
    with contextlib.suppress(MessageError):
        message = parse_message(json.dumps({"kind": kind, **given}))
        assert message.arguments.keys() <= KINDS[kind].keys()


# To pages -----------------------------------------------------------------------------------------
# Messages to pages: as computed, and no more of them waiting than a page needs.


TABLES = st.dictionaries(st.sampled_from("abc"), st.integers() | st.text())


async def nothing(*_: Any) -> Any:
    """No page is there."""


def page() -> Page:
    return Page(WebSocket({"type": "websocket", "headers": []}, nothing, nothing))


def waiting(found: Page) -> list[dict[str, Any]]:
    return [json.loads(message.text) for message in found._waiting.values()]


@given(TABLES, st.dictionaries(st.sampled_from("xyz"), st.integers() | st.text()))
def test_a_body_is_part_of_its_message(head: dict[str, Any], rest: dict[str, Any]) -> None:
    assert json.loads(Message("told", head, body(rest)).text) == {"kind": "told", **head, **rest}
    inside = Message("told", head, body(rest), "in").text
    assert json.loads(inside) == {"kind": "told", **head, "in": rest}


def test_of_what_a_page_does_not_take_the_latest_waits() -> None:
    found = page()
    for number in range(1000):
        for kind in ("state", "curves", "findings", "solid"):
            found.enqueue(Message(kind, {"revision": number}))
    assert {(each["kind"], each["revision"]) for each in waiting(found)} == {
        (kind, 999) for kind in ("state", "curves", "findings", "solid")
    }
    for number in range(1000):
        found.enqueue(Message("told", {"message": str(number)}))
    assert len(waiting(found)) == MOST_WAITING


def test_the_latest_says_what_only_the_earlier_one_said() -> None:
    found = page()
    found.enqueue(Message("curves", {"revision": 1, "answers": 7}))
    found.enqueue(Message("curves", {"revision": 2, "answers": None}))
    found.enqueue(Message("state", {"revision": 1, "text": "a"}))
    found.enqueue(Message("state", {"revision": 2}))
    assert waiting(found) == [
        {"kind": "curves", "revision": 2, "answers": 7},
        {"kind": "state", "revision": 2, "text": "a"},
    ]


def test_a_page_that_is_slow_still_gets_the_last_word() -> None:
    sent: list[int] = []

    async def talk() -> None:
        begins, takes, ends = (asyncio.Queue[None]() for _ in range(3))

        async def slow(message: Any) -> None:
            begins.put_nowait(None)
            await takes.get()
            sent.append(json.loads(message["text"])["revision"])
            ends.put_nowait(None)

        found = page()
        found.socket._send = slow
        found.socket.application_state = found.socket.client_state.CONNECTED
        sending = asyncio.create_task(found.send())
        for number in range(50):
            found.enqueue(Message("curves", {"revision": number}))
            if number in (0, 20, 49):
                await begins.get()  # it is being sent, and what follows waits
            if number in (19, 40):
                takes.put_nowait(None)
        takes.put_nowait(None)
        for _ in range(3):
            await ends.get()
        sending.cancel()

    asyncio.run(talk())
    assert sent == [0, 20, 49]
