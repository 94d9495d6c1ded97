"""What strangers, and pages that have gone wrong, can take of the server: little."""

from __future__ import annotations

import asyncio
import contextlib
import resource
import socket

import pytest
from starlette.types import Message
from starlette.websockets import WebSocket, WebSocketState
from websockets.exceptions import ConnectionClosed

from camgeo_export.designer import serve, session
from camgeo_export.designer.serve import MOST_CONNECTIONS
from camgeo_export.designer.session import LARGEST
from tests.designer.served import Clock, Served
from tests.long_form import examples
from tests.waiting import PATIENCE

CONNECTIONS = examples(150, long=1000)


def alive(server: Served) -> bool:
    """Whether a page is still served."""
    with server.page() as page:
        page.say("hello")
        page.hear("state")
    return server.get("/").status == 200


def open_at(server: Served) -> int:
    """Connections that the server has."""
    return len(server.server.server_state.connections)


def test_connections_are_bounded_and_a_page_still_gets_in(server: Served) -> None:
    """Silent ones give way to new ones, the oldest first."""
    soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    resource.setrlimit(resource.RLIMIT_NOFILE, (min(hard, max(soft, 3 * CONNECTIONS)), hard))
    with server.page() as page, contextlib.ExitStack() as stack:
        page.say("hello")
        page.hear("state")
        for _ in range(CONNECTIONS):
            found = socket.create_connection(("127.0.0.1", server.port), timeout=PATIENCE)
            stack.enter_context(found)
        assert alive(server)
        assert open_at(server) <= MOST_CONNECTIONS
        page.say("change", id=1, edits={"a": 2})  # it was not pushed out
        page.hear("curves", answers=1)


@pytest.mark.parametrize("flood", ["", "GET / HTTP/1.1\r\nHost: x\r\n", "\0" * 100])
def test_connections_of_which_nothing_comes_are_closed(
    server: Served, flood: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    with monkeypatch.context() as patch:
        patch.setattr("camgeo_export.designer.serve.PATIENCE", 0.1)
        with socket.create_connection(("127.0.0.1", server.port), timeout=PATIENCE) as found:
            found.sendall(flood.encode())
            with contextlib.suppress(ConnectionResetError):
                while found.recv(65536):
                    pass
    assert alive(server)


def test_pages_are_bounded(server: Served, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(serve, "MOST_PAGES", 2)
    with server.page() as one, server.page() as other:
        for page in (one, other):
            page.say("hello")
            page.hear("state")
        with server.page() as third, pytest.raises(ConnectionClosed, match="1013"):
            third.hear("state")
    assert alive(server)


def test_messages_are_bounded(server: Served) -> None:
    with server.page() as page:
        with contextlib.suppress(ConnectionClosed):  # it may be closed before all is sent
            page.socket.send("x" * (LARGEST + 1))
        with pytest.raises(ConnectionClosed):
            page.hear("state")
    assert alive(server)


def test_what_is_asked_is_bounded_in_rate(monkeypatch: pytest.MonkeyPatch) -> None:
    """After a burst, a page is asked for the next message only so often."""
    clock = Clock()
    monkeypatch.setattr(session, "time", clock)
    monkeypatch.setattr(session, "BURST", 5.0)
    monkeypatch.setattr(session, "RATE", 20.0)
    taken: list[float] = []

    async def asleep(seconds: float) -> None:
        clock.now += seconds

    async def receive() -> Message:
        return {"type": "websocket.receive", "text": "nonsense"}

    async def send(_: Message) -> None:
        """Nothing is sent."""

    async def take(page: session.Page, count: int) -> None:
        for _ in range(count):
            await page.receive()
            taken.append(clock.now)

    monkeypatch.setattr("asyncio.sleep", asleep)
    page = session.Page(WebSocket({"type": "websocket", "headers": []}, receive, send))
    page.socket.client_state = WebSocketState.CONNECTED
    began = clock.now
    asyncio.run(take(page, 15))
    assert [each - began for each in taken[:5]] == [0.0] * 5
    assert [each - began for each in taken[5:]] == pytest.approx([k / 20.0 for k in range(1, 11)])
    clock.now += 1000.0  # a pause allows one burst again, however long it is
    taken.clear()
    asyncio.run(take(page, 7))
    assert [each > taken[0] for each in taken] == [False] * 5 + [True] * 2
