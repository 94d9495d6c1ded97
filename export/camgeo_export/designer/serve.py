"""Serving the designer: its socket, its processes, its end."""

from __future__ import annotations

import asyncio
import contextlib
import ipaddress
import logging
import os
import re
import secrets
import socket
import sys
import threading
import webbrowser
from collections.abc import Awaitable, Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from http import HTTPStatus
from importlib.resources import files
from typing import Final
from urllib.parse import parse_qsl, quote

import uvicorn
from starlette.applications import Starlette
from starlette.requests import Request
from starlette.responses import PlainTextResponse, Response
from starlette.routing import Route, WebSocketRoute
from starlette.types import ASGIApp, Message, Receive, Scope, Send
from starlette.websockets import WebSocket, WebSocketDisconnect
from uvicorn.protocols.http.h11_impl import H11Protocol
from uvicorn.protocols.websockets.websockets_sansio_impl import WebSocketsSansIOProtocol

from camgeo.app.designing.children import Children
from camgeo.app.designing.desk import Desk
from camgeo.errors import CamgeoError, unreadable
from camgeo.reading import SCENE
from camgeo_export.designer.session import Jobs, Page, Session

MOST_CONNECTIONS: Final = 64
"""Most connections at the same time; a page needs two or three. For each further one the oldest
that is not a page's socket is closed, so silent connections cannot keep others out."""

HEAD: Final = 16_384
"""Most bytes of the headers of a request."""

PATIENCE: Final = 10.0
"""Seconds within which a connection must have made a request, or opened a page."""

BACKLOG: Final = 128

END: Final = 2
"""Seconds within which connections end when the server does."""


class Connection(H11Protocol):
    """A connection that is closed if nothing comes of it, or if there are too many."""

    def connection_made(self, transport: asyncio.Transport) -> None:  # type: ignore[override]  # uvicorn narrows it too
        super().connection_made(transport)
        self.opened = self.loop.time()
        self.loop.call_later(PATIENCE, self._close_if_idle)
        if len(self.connections) > MOST_CONNECTIONS:
            connections = (
                connection for connection in self.connections if isinstance(connection, Connection)
            )
            min(connections, key=lambda connection: connection.opened).abort()

    def abort(self) -> None:
        """Close it at once, whatever it is doing."""
        self.transport.abort()
        self.connections.discard(self)

    def _close_if_idle(self) -> None:
        if self in self.connections and not self.headers:  # None until there is a request
            self.abort()


def listening(host: str, port: int) -> socket.socket:
    """A socket that listens at host and port; CamgeoError if it cannot."""
    family = socket.AF_INET6 if ":" in host else socket.AF_INET
    # With its protocol stated, asyncio sends each message at once, not 40 ms later.
    listener = socket.socket(family, socket.SOCK_STREAM, socket.IPPROTO_TCP)
    try:
        listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        listener.bind((host, port))
        listener.listen(BACKLOG)
    except OSError as error:
        listener.close()
        raise CamgeoError(f"cannot listen at {host}, port {port}: {unreadable(error)}") from error
    return listener


def serve(
    desk: Desk,
    host: str,
    port: int,
    announce: Callable[[str, bool], None],
    *,
    notes: Sequence[str] = (),
    browser: bool = True,
) -> None:
    """Serve the scene on a desk until a signal arrives; then nothing is left running.

    Parameters
    ----------
    host, port : where to listen; port 0 for any that is free.
    announce : called once, with the address and whether only this machine can reach it.
    notes : sentences for the first page.
    browser : whether to open it.

    Raises
    ------
    CamgeoError
        If it cannot listen there.
    """
    with contextlib.closing(desk), listening(host, port) as listener, Children() as children:
        address = Address(host, listener.getsockname()[1])
        jobs = Jobs(desk, children.submit, children.cancel)
        keys = Keys()
        url = f"http://{address.netloc}/?token="

        def ready() -> None:
            announce(f"{url}{keys.token}", is_loopback(host))
            if browser and _has_screen():
                # The end does not wait for this thread: some browsers keep it while they run.
                threading.Thread(target=_open, args=(url + keys.lend(),), daemon=True).start()

        asyncio.run(_serve(Session(desk, jobs, notes), address, keys, listener, ready))


LARGEST: Final = 3 * SCENE.size
"""Most bytes of a message: JSON spells some characters of a scene with two or more."""


def make_server(app: Guard) -> uvicorn.Server:
    """The server of an application, with all limits. Requests are not logged: one has a token."""
    config = uvicorn.Config(
        app,
        http=Connection,
        ws=WebSocketsSansIOProtocol,
        ws_max_size=LARGEST,
        ws_per_message_deflate=False,
        h11_max_incomplete_event_size=HEAD,
        timeout_keep_alive=30,
        timeout_graceful_shutdown=END,
        lifespan="off",
        log_config=None,
        log_level="critical",  # what strangers send does not belong in the terminal
        access_log=False,
        server_header=False,
        proxy_headers=False,
    )
    return uvicorn.Server(config)


async def _serve(
    session: Session,
    address: Address,
    keys: Keys,
    listener: socket.socket,
    ready: Callable[[], None],
) -> None:
    server = make_server(application(session, address, keys))
    working = asyncio.create_task(session.run())
    working.add_done_callback(lambda _: setattr(server, "should_exit", True))
    ready()
    try:
        await server.serve(sockets=[listener])
    finally:
        working.cancel()
        with contextlib.suppress(asyncio.CancelledError):
            await working  # raises what has ended it


def _has_screen() -> bool:
    """Whether there is a screen for a browser; a browser in the terminal is of no use."""
    if sys.platform in ("win32", "darwin"):
        return True
    return bool(os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"))


def _open(url: str) -> None:
    """Open the browser; if there is none, the user still has the printed address."""
    with contextlib.suppress(webbrowser.Error, OSError):
        webbrowser.open(url)


# -- application ----------------------------------------------------------------------------------
# The application: page, scripts and style, the socket of messages, and files to be downloaded.


MOST_PAGES: Final = 16
"""Most pages that are connected at the same time."""

FULL: Final = 1013
NO_TEXT: Final = 1003
BROKEN: Final = 1011
"""Codes that close a socket: too many pages, a message that is not text, an error in camgeo."""

LOG: Final = logging.getLogger(__name__)

PAGE: Final = {
    "designer.html": ("", "text/html"),
    "designer.css": ("bundle", "text/css"),
    "designer.js": ("bundle", "text/javascript"),
    "solid.js": ("bundle", "text/javascript"),
}
"""Files of the page: their folder in `camgeo_export.browser`, and their media types."""


def application(session: Session, address: Address, keys: Keys) -> Guard:
    """The application of a session at that address."""

    async def socket(websocket: WebSocket) -> None:
        await websocket.accept()
        if session.pages >= MOST_PAGES:
            await websocket.close(FULL, "too many pages of this designer are open")
            return
        try:
            await session.serve(Page(websocket))
        except WebSocketDisconnect as gone:
            if gone.code == NO_TEXT:
                await websocket.close(NO_TEXT, "messages must be text")
        except Exception:
            LOG.exception("a page of the designer has ended with an error in camgeo")
            await websocket.close(BROKEN, "an error in camgeo")

    async def built(request: Request) -> Response:
        name = request.path_params["name"]
        data = session.files.get(name, request.query_params.get("build", ""))
        if data is None:
            return PlainTextResponse("This file does not belong to the last build.\n", 404)
        headers = {"content-disposition": _disposition(name)}
        return Response(data, media_type="application/octet-stream", headers=headers)

    routes = [
        Route("/", _source("designer.html")),
        Route("/designer.css", _source("designer.css")),
        Route("/designer.js", _source("designer.js")),
        Route("/solid.js", _source("solid.js")),
        Route("/favicon.ico", _nothing),
        Route("/files/{name}", built),
        WebSocketRoute("/ws", socket),
    ]
    return Guard(Starlette(routes=routes), address, keys)


def _disposition(name: str) -> str:
    """The header that makes a browser save a file under its name."""
    plain = re.sub(r"[^A-Za-z0-9._-]", "_", name)
    return f"attachment; filename=\"{plain}\"; filename*=UTF-8''{quote(name, safe='')}"


def _source(name: str) -> Callable[[Request], Awaitable[Response]]:
    """An endpoint that answers with a file of the page."""
    folder, kind = PAGE[name]

    async def answer(_: Request) -> Response:
        data = files("camgeo_export.browser").joinpath(folder, name).read_bytes()
        return Response(data, media_type=kind)

    return answer


async def _nothing(_: Request) -> Response:
    return Response(status_code=204)


# -- guard ----------------------------------------------------------------------------------------
# Who may talk to the designer: the browser that was given its address, and no other page or host.
#
# The server gives access to files and to processes that compute, on a machine whose browser also
# shows strangers' pages. Therefore each request must name this server as its host; otherwise a
# stranger's domain name that resolves to this machine would make his page one of ours (DNS
# rebinding). Requests from pages of other origins are refused, and nothing is served without the
# cookie, for which the token of the printed address is exchanged. No request needs a body, so none
# is read.


POLICY: Final = (
    "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data:;"
    " connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
)

HEADERS: Final = (
    (b"content-security-policy", POLICY.encode()),
    (b"cache-control", b"no-store"),
    (b"referrer-policy", b"no-referrer"),
    (b"x-content-type-options", b"nosniff"),
    (b"x-frame-options", b"DENY"),
    (b"cross-origin-opener-policy", b"same-origin"),
    (b"cross-origin-resource-policy", b"same-origin"),
)
"""Headers of every reply."""

LOOPBACK: Final = ("127.0.0.1", "localhost", "::1")

METHODS: Final = ("GET", "HEAD")

STRANGERS: Final = ("cross-site", "same-site")
"""How a browser marks requests from pages of other origins. Cookies do not depend on the port, so
requests from a page of another server on this machine carry ours."""

ENTRY: Final = "/"
"""The path at which a token is exchanged for a cookie."""

BOUNCE: Final = b"""<!DOCTYPE html>
<html lang="en"><head><meta charset="utf-8"><meta http-equiv="refresh" content="0;url=/">
<title>camgeo</title></head><body><p><a href="/">camgeo design</a></p></body></html>
"""
"""The page that is sent instead of a redirect if another page led here: browsers send no strict
cookie with such a redirect."""


@dataclass(frozen=True, slots=True)
class Keys:
    """The secrets that prove that a browser may use the designer.

    Attributes
    ----------
    token : of the printed address.
    cookie : the value that it is exchanged for.
    spare : tokens that work once; the browser is opened with one of them, since other users of the
        machine can see the arguments of processes.
    """

    token: str = field(default_factory=lambda: secrets.token_urlsafe(32))
    cookie: str = field(default_factory=lambda: secrets.token_urlsafe(32))
    spare: set[str] = field(default_factory=set)

    def lend(self) -> str:
        """A token that works once."""
        self.spare.add(token := secrets.token_urlsafe(32))
        return token

    def takes(self, token: str) -> bool:
        """Whether a token is valid; a spare one is used up."""
        if _same(token, self.token):
            return True
        match = next((candidate for candidate in self.spare if _same(token, candidate)), None)
        self.spare.discard(match or "")
        return match is not None

    def knows(self, cookie: str) -> bool:
        """Whether a cookie is the one that was set."""
        return _same(cookie, self.cookie)


@dataclass(frozen=True, slots=True)
class Address:
    """Where the server listens.

    Attributes
    ----------
    host : name or address, as given by the user.
    port : its number.
    """

    host: str
    port: int

    @property
    def everywhere(self) -> bool:
        """Whether it listens at all addresses of the machine."""
        return self.host in ("", "0.0.0.0", "::")

    @property
    def hosts(self) -> frozenset[str]:
        """Names of this server in requests, without the port."""
        names = (socket.gethostname(),) if self.everywhere else (self.host,)
        return frozenset(name.lower() for name in (*LOOPBACK, *names))

    @property
    def netloc(self) -> str:
        """Host and port, as in an address that a browser on this machine can open."""
        return authority(LOOPBACK[0] if self.everywhere else self.host, self.port)

    def is_meant(self, stated: str) -> bool:
        """Whether the `Host` of a request names this server."""
        name, port = _split(stated.lower())
        if port != self.port:
            return False
        return name in self.hosts or (self.everywhere and _is_literal(name))


class Guard:
    """Refuses what is not allowed, and passes on the rest; adds the headers to every reply."""

    def __init__(self, app: ASGIApp, address: Address, keys: Keys) -> None:
        self.app = app
        self.address = address
        self.keys = keys
        self._cookie = f"camgeo-design-{address.port}"  # cookies do not depend on the port

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] not in ("http", "websocket"):
            return

        async def guarded(message: Message) -> None:
            if message["type"] in ("http.response.start", "websocket.http.response.start"):
                message = {**message, "headers": [*message.get("headers", ()), *HEADERS]}
            await send(message)

        headers = _headers(scope)
        refusal = self._refusal(scope, headers)
        if refusal is not None:
            await _answer(scope, guarded, *refusal)
            return
        token = _token(scope)
        if token is not None and self.keys.takes(token):
            await self._exchange_token(guarded, headers)
        elif self.keys.knows(_cookie(headers, self._cookie)):
            await self.app(scope, receive, guarded)
        else:
            await _answer(
                scope, guarded, 401,
                "This page belongs to a running camgeo design. Open the address that it printed in"
                " the terminal.",
            )  # fmt: skip

    def _refusal(
        self, scope: Scope, headers: Mapping[str, tuple[str, ...]]
    ) -> tuple[int, str] | None:
        """Status and sentence for a request that is refused, whoever makes it."""
        hosts = headers.get("host", ())
        if len(hosts) != 1 or not self.address.is_meant(hosts[0]):
            return 421, "The request names a host other than this designer."
        origins = headers.get("origin", ())
        if any(origin.lower() != f"http://{hosts[0].lower()}" for origin in origins):
            return 403, "Pages of other origins have no access to this designer."
        if scope["type"] == "websocket":
            return None if origins else (403, "A WebSocket must name its origin.")
        if scope["method"] not in METHODS:
            return 405, "Only GET and HEAD are allowed here."
        if "transfer-encoding" in headers or headers.get("content-length", ("0",)) != ("0",):
            return 413, "Requests here have no body; this one was not read."
        navigates = headers.get("sec-fetch-mode") == ("navigate",)
        if headers.get("sec-fetch-site", ("",))[0] in STRANGERS and not navigates:
            return 403, "Pages of other origins have no access to this designer."
        return None

    async def _exchange_token(self, send: Send, headers: Mapping[str, tuple[str, ...]]) -> None:
        """Exchange the token for the cookie, and redirect to the address without it."""
        cookie = f"{self._cookie}={self.keys.cookie}; Path=/; HttpOnly; SameSite=Strict"
        cookie_headers = [(b"set-cookie", cookie.encode())]
        if headers.get("sec-fetch-site", ("none",))[0] == "none":
            await _reply(send, 303, b"", [*cookie_headers, (b"location", ENTRY.encode())])
        else:
            await _reply(send, 200, BOUNCE, [*cookie_headers, (b"content-type", b"text/html")])


def authority(host: str, port: int) -> str:
    """Host and port, as in an address; an IPv6 host is in brackets."""
    name = f"[{host}]" if ":" in host else host
    return name if port == 80 else f"{name}:{port}"


def is_loopback(host: str) -> bool:
    """Whether only this machine can reach a server at `host`."""
    try:
        return host == "localhost" or ipaddress.ip_address(host).is_loopback
    except ValueError:
        return False


def _split(stated: str) -> tuple[str, int | None]:
    """Name and port of a `Host`; an IPv6 address without its brackets."""
    name, colon, port = stated.rpartition(":")
    if not colon or stated.endswith("]"):
        name, port = stated, "80"
    if not (port.isascii() and port.isdigit() and len(port) <= 5):
        return "", None
    bracketed = name.startswith("[") and name.endswith("]")
    return name[1:-1] if bracketed else name, int(port)


def _is_literal(name: str) -> bool:
    """Whether a host is a numerical address, which does not depend on anyone's name server."""
    try:
        ipaddress.ip_address(name)
    except ValueError:
        return False
    return True


def _headers(scope: Scope) -> dict[str, tuple[str, ...]]:
    headers: dict[str, tuple[str, ...]] = {}
    for name, value in scope["headers"]:
        key = name.decode("latin-1").lower()
        headers[key] = (*headers.get(key, ()), value.decode("latin-1"))
    return headers


def _token(scope: Scope) -> str | None:
    """The token in the address, if that is the one at which tokens are exchanged."""
    if scope["type"] != "http" or scope["path"] != ENTRY:
        return None
    query = scope["query_string"].decode("latin-1")
    return dict(parse_qsl(query)).get("token") if len(query) < 500 else None


def _cookie(headers: Mapping[str, tuple[str, ...]], name: str) -> str:
    for pair in ";".join(headers.get("cookie", ())).split(";"):
        key, _, value = pair.partition("=")
        if key.strip() == name:
            return value.strip()
    return ""


def _same(one: str, other: str) -> bool:
    return secrets.compare_digest(one.encode(), other.encode())


async def _answer(scope: Scope, send: Send, status: int, sentence: str) -> None:
    """Refuse a request in a sentence, and end its connection."""
    kind = (b"content-type", b"text/plain; charset=utf-8")
    data = f"{status} {HTTPStatus(status).phrase}\n{sentence}\n".encode()
    if scope["type"] == "http":
        await _reply(send, status, data, [kind, (b"connection", b"close")])
    elif "websocket.http.response" in scope.get("extensions", {}):
        head = {"type": "websocket.http.response.start", "status": status, "headers": [kind]}
        await send(head)  # the server states length and end itself
        await send({"type": "websocket.http.response.body", "body": data})
    else:
        await send({"type": "websocket.close", "code": 1008, "reason": sentence})


async def _reply(
    send: Send, status: int, data: bytes, headers: Iterable[tuple[bytes, bytes]]
) -> None:
    length = (b"content-length", str(len(data)).encode())
    await send({"type": "http.response.start", "status": status, "headers": [*headers, length]})
    await send({"type": "http.response.body", "body": data})
