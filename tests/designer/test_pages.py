"""Messages to pages: as computed, and no more of them waiting than a page needs."""

from __future__ import annotations

import asyncio
import json
from typing import Any

from hypothesis import given
from hypothesis import strategies as st
from starlette.websockets import WebSocket

from camgeo_export.designer.session import MOST_WAITING, Message, Page, body

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
            found.put(Message(kind, {"revision": number}))
    assert {(each["kind"], each["revision"]) for each in waiting(found)} == {
        (kind, 999) for kind in ("state", "curves", "findings", "solid")
    }
    for number in range(1000):
        found.put(Message("told", {"message": str(number)}))
    assert len(waiting(found)) == MOST_WAITING


def test_the_latest_says_what_only_the_earlier_one_said() -> None:
    found = page()
    found.put(Message("curves", {"revision": 1, "answers": 7}))
    found.put(Message("curves", {"revision": 2, "answers": None}))
    found.put(Message("state", {"revision": 1, "text": "a"}))
    found.put(Message("state", {"revision": 2}))
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
            found.put(Message("curves", {"revision": number}))
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
