"""Who is let in: the browser that was given the address, and no other; and how much it may take."""

from __future__ import annotations

import asyncio
import contextlib
import resource
import socket
from urllib.parse import quote

import pytest
from starlette.types import Message
from starlette.websockets import WebSocket, WebSocketState
from websockets.exceptions import ConnectionClosed, InvalidStatus
from websockets.sync.client import connect

from camgeo.errors import CamgeoError
from camgeo_export.designer import serve, session
from camgeo_export.designer.serve import (
    HEADERS,
    LARGEST,
    MOST_CONNECTIONS,
    Address,
    Keys,
    is_loopback,
    listening,
)
from tests.designer.served import Clock, Served
from tests.long_form import examples
from tests.waiting import PATIENCE


def test_a_token_is_exchanged_for_a_cookie(server: Served) -> None:
    reply = server.get(f"/?token={server.keys.token}", let_in=False)
    assert (reply.status, reply.headers["location"]) == (303, "/")
    name, _, rest = reply.headers["set-cookie"].partition("=")
    value, *attributes = rest.split("; ")
    assert (name, value) == (f"camgeo-design-{server.port}", server.keys.cookie)
    assert {"HttpOnly", "SameSite=Strict", "Path=/"} == set(attributes)
    assert server.keys.token not in str(reply.headers)
    assert server.get("/").status == 200


def test_a_page_that_leads_here_gets_a_page_that_goes_on(server: Served) -> None:
    reply = server.get(
        f"/?token={server.keys.token}", let_in=False, Sec_Fetch_Site="cross-site",
        Sec_Fetch_Mode="navigate",
    )  # fmt: skip
    assert reply.status == 200
    assert b'content="0;url=/"' in reply.text  # type: ignore[attr-defined]  # see Served.get


@pytest.mark.parametrize(
    "path", ["/", "/designer.js", "/solid.js", "/designer.css", "/files/cam.dxf", "/none"]
)
@pytest.mark.parametrize(
    "cookie", ["", "camgeo-design-{port}=wrong", "camgeo-design-1={value}", "other={value}"]
)
def test_nothing_is_to_be_had_without_the_cookie(server: Served, path: str, cookie: str) -> None:
    given = cookie.format(port=server.port, value=server.keys.cookie)
    assert server.get(path, let_in=False, Cookie=given).status == 401


@pytest.mark.parametrize("token", ["", "wrong", "é", "%00", "x" * 1000])
def test_a_wrong_token_does_not_let_in(server: Served, token: str) -> None:
    reply = server.get(f"/?token={quote(token)}", let_in=False)
    assert reply.status == 401
    assert "set-cookie" not in reply.headers


@pytest.mark.parametrize(
    "host",
    ["evil.example:{port}", "127.0.0.1", "127.0.0.1:1", "localhost.evil.example:{port}", "",
     "127.0.0.1:{port}.evil.example", "127.0.0.1:{port}x", "[::1:{port}", "192.168.0.1:{port}"],
)  # fmt: skip
def test_another_host_is_refused(server: Served, host: str) -> None:
    """A name that a stranger's page has pointed to this machine (DNS rebinding)."""
    for path in ("/", f"/?token={server.keys.token}"):
        reply = server.get(path, Host=host.format(port=server.port))
        assert reply.status in (400, 421)
        assert "set-cookie" not in reply.headers


@pytest.mark.parametrize("host", ["127.0.0.1:{port}", "localhost:{port}", "[::1]:{port}"])
def test_all_names_of_this_machine_are_taken(server: Served, host: str) -> None:
    assert server.get("/", Host=host.format(port=server.port)).status == 200


@pytest.mark.parametrize(
    "origin",
    ["http://evil.example", "null", "https://127.0.0.1:{port}", "http://127.0.0.1:1",
     "http://localhost:{port}", ""],
)  # fmt: skip
def test_another_origin_is_refused(server: Served, origin: str) -> None:
    stated = origin.format(port=server.port)
    assert server.get("/", Origin=stated).status == 403
    with pytest.raises(InvalidStatus) as refused:
        connect(
            f"ws://{server.host}/ws",
            additional_headers={"Cookie": server.cookie, "Origin": stated},
            open_timeout=PATIENCE,
        )
    assert refused.value.response.status_code == 403
    assert b"other origins" in (refused.value.response.body or b"")


def test_a_socket_needs_origin_and_cookie(server: Served) -> None:
    origin = f"http://{server.host}"
    for headers, status in (
        ({"Cookie": server.cookie}, 403),
        ({"Origin": origin}, 401),
    ):
        with pytest.raises(InvalidStatus) as refused:
            connect(f"ws://{server.host}/ws", additional_headers=headers, open_timeout=PATIENCE)
        assert refused.value.response.status_code == status
    with server.page() as page:
        page.say("hello")
        assert page.hear("state")["file"] == "cam.toml"


@pytest.mark.parametrize("site", ["cross-site", "same-site"])
def test_what_pages_of_others_fetch_is_refused(server: Served, site: str) -> None:
    """Cookies do not tell ports apart: a page of another server here has ours sent along."""
    assert server.get("/designer.js", Sec_Fetch_Site=site, Sec_Fetch_Mode="no-cors").status == 403
    assert server.get("/", Sec_Fetch_Site=site, Sec_Fetch_Mode="navigate").status == 200
    assert server.get("/designer.js", Sec_Fetch_Site="same-origin").status == 200


@pytest.mark.parametrize("let_in", [True, False])
def test_every_reply_has_the_headers(server: Served, let_in: bool) -> None:
    for path in ("/", "/designer.js", "/none", "/favicon.ico"):
        found = server.get(path, let_in=let_in).headers
        for name, value in HEADERS:
            assert found.get_all(name.decode()) == [value.decode()]
        policy = found["content-security-policy"]
        assert "unsafe" not in policy
        assert "connect-src 'self'" in policy


@pytest.mark.parametrize("method", ["POST", "PUT", "DELETE", "OPTIONS", "TRACE"])
def test_nothing_but_get_is_understood(server: Served, method: str) -> None:
    assert server.get("/", method=method).status == 405


@pytest.mark.parametrize(
    "path",
    ["/files/../cam.toml", "/../cam.toml", "/files/..%2fcam.toml", "/%2e%2e/cam.toml", "/cam.toml",
     "//etc/passwd", "/files//etc/passwd", "/files/cam.toml", "/designer.js/../../x", "/static/x"],
)  # fmt: skip
def test_no_path_leads_to_a_file(server: Served, path: str) -> None:
    assert server.get(path).status == 404


@pytest.mark.parametrize("coding", ["Content-Length: 100000000", "Transfer-Encoding: chunked"])
@pytest.mark.parametrize("method", ["GET", "POST"])
def test_a_large_body_is_refused_without_reading_it(
    server: Served, coding: str, method: str
) -> None:
    with socket.create_connection(("127.0.0.1", server.port), timeout=PATIENCE) as found:
        head = f"{method} / HTTP/1.1\r\nHost: {server.host}\r\nCookie: {server.cookie}\r\n{coding}"
        found.sendall(f"{head}\r\n\r\n".encode())
        reply = b""
        while chunk := found.recv(65536):  # it answers and closes, though nothing was sent
            reply += chunk
    assert reply.startswith(b"HTTP/1.1 413" if method == "GET" else b"HTTP/1.1 405")
    assert server.get("/").status == 200


def test_heads_are_bounded(server: Served) -> None:
    with socket.create_connection(("127.0.0.1", server.port), timeout=PATIENCE) as found:
        found.sendall(b"GET / HTTP/1.1\r\nX: ")
        for _ in range(5):
            found.sendall(b"x" * 4000)
        assert found.recv(65536).startswith(b"HTTP/1.1 400")


def test_a_lent_token_is_taken_once() -> None:
    keys = Keys()
    lent = keys.lend()
    assert lent != keys.token
    assert [keys.takes(lent), keys.takes(lent)] == [True, False]
    assert [keys.takes(keys.token), keys.takes(keys.token)] == [True, True]


@pytest.mark.parametrize(
    ("host", "stated", "meant"),
    [
        ("127.0.0.1", "127.0.0.1:8000", True),
        ("127.0.0.1", "192.168.1.2:8000", False),
        ("0.0.0.0", "192.168.1.2:8000", True),
        ("::", "[fe80::1]:8000", True),
        ("0.0.0.0", "evil.example:8000", False),
        ("0.0.0.0", f"{socket.gethostname()}:8000", True),
        ("cam.lan", "cam.lan:8000", True),
        ("cam.lan", "CAM.LAN:8000", True),
        ("cam.lan", "192.168.1.2:8000", False),
    ],
)
def test_the_host_is_one_of_the_server(host: str, stated: str, meant: bool) -> None:
    assert Address(host, 8000).is_meant(stated) is meant


def test_port_80_needs_no_number() -> None:
    assert Address("127.0.0.1", 80).is_meant("127.0.0.1")
    assert Address("127.0.0.1", 80).netloc == "127.0.0.1"
    assert Address("::", 81).netloc == "127.0.0.1:81"
    assert Address("::1", 81).netloc == "[::1]:81"


@pytest.mark.parametrize(
    ("host", "alone"),
    [("127.0.0.1", True), ("::1", True), ("localhost", True), ("127.8.8.8", True),
     ("0.0.0.0", False), ("::", False), ("cam.lan", False), ("192.168.1.2", False), ("", False)],
)  # fmt: skip
def test_loopback_is_told_from_the_rest(host: str, alone: bool) -> None:
    assert is_loopback(host) is alone


def test_messages_are_sent_at_once() -> None:
    """A socket without its protocol would wait for the page to confirm the message before: 40 ms in
    each step of a drag."""
    with listening("127.0.0.1", 0) as found:
        assert found.proto == socket.IPPROTO_TCP


def test_a_port_that_is_taken_is_told() -> None:
    with listening("127.0.0.1", 0) as found:
        port = found.getsockname()[1]
        with pytest.raises(CamgeoError, match=f"cannot listen at 127.0.0.1, port {port}: "):
            listening("127.0.0.1", port)


# Limits -------------------------------------------------------------------------------------------
# What strangers, and pages that have gone wrong, can take of the server: little.


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
