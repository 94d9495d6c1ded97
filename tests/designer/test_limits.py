"""What strangers, and pages that have gone wrong, can take of the server: little."""

from __future__ import annotations

import contextlib
import resource
import socket
import time

import pytest
from websockets.exceptions import ConnectionClosed

from camgeo_export.designer import application, pages
from camgeo_export.designer.messages import LARGEST
from camgeo_export.designer.serve import MOST_CONNECTIONS
from tests.designer.served import SECONDS, Served
from tests.long_form import examples

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
            found = socket.create_connection(("127.0.0.1", server.port), timeout=SECONDS)
            stack.enter_context(found)
        assert alive(server)
        assert open_at(server) <= MOST_CONNECTIONS
        page.say("change", id=1, edits={"a": 2})  # it was not pushed out
        page.hear("curves", answers=1)


@pytest.mark.parametrize("flood", ["", "GET / HTTP/1.1\r\nHost: x\r\n", "\0" * 100])
def test_connections_of_which_nothing_comes_are_closed(
    server: Served, flood: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("camgeo_export.designer.serve.PATIENCE", 0.1)
    with socket.create_connection(("127.0.0.1", server.port), timeout=SECONDS) as found:
        found.sendall(flood.encode())
        with contextlib.suppress(ConnectionResetError):
            while found.recv(65536):
                pass
    assert alive(server)


def test_pages_are_bounded(server: Served, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(application, "MOST_PAGES", 2)
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


def test_what_is_asked_is_bounded_in_rate(server: Served, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(pages, "BURST", 5.0)
    monkeypatch.setattr(pages, "RATE", 20.0)
    with server.page() as page:
        start = time.monotonic()
        for number in range(15):
            page.say("nonsense", id=number)
        page.hear("refused", id=14)
        assert time.monotonic() - start >= 9 / 20.0
