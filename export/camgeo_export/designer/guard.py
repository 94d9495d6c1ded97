"""Who may talk to the designer: the browser that was given its address, and no other page or host.

The server gives access to files and to processes that compute, on a machine whose browser also
shows strangers' pages. Therefore each request must name this server as its host; otherwise a
stranger's domain name that resolves to this machine would make his page one of ours (DNS
rebinding). Requests from pages of other origins are refused, and nothing is served without the
cookie, for which the token of the printed address is exchanged. No request needs a body, so none is
read.
"""

from __future__ import annotations

import ipaddress
import secrets
import socket
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from http import HTTPStatus
from typing import Final
from urllib.parse import parse_qsl

from starlette.types import ASGIApp, Message, Receive, Scope, Send

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
"""Of every reply."""

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
"""In place of a redirect if another page led here: browsers send no strict cookie with that."""


@dataclass(frozen=True, slots=True)
class Keys:
    """What proves that a browser was let in.

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
        found = next((each for each in self.spare if _same(token, each)), None)
        self.spare.discard(found or "")
        return found is not None

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
        own = (socket.gethostname(),) if self.everywhere else (self.host,)
        return frozenset(each.lower() for each in (*LOOPBACK, *own))

    @property
    def shown(self) -> str:
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
        found = self._refusal(scope, headers)
        if found is not None:
            await _answer(scope, guarded, *found)
            return
        token = _token(scope)
        if token is not None and self.keys.takes(token):
            await self._let_in(guarded, headers)
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
            return 421, "The request is meant for another host than this designer."
        origins = headers.get("origin", ())
        if any(each.lower() != f"http://{hosts[0].lower()}" for each in origins):
            return 403, "Pages of other origins have no access to this designer."
        if scope["type"] == "websocket":
            return None if origins else (403, "A WebSocket must name its origin.")
        if scope["method"] not in METHODS:
            return 405, "Only GET is understood here."
        if "transfer-encoding" in headers or headers.get("content-length", ("0",)) != ("0",):
            return 413, "Requests here have no body; this one was not read."
        navigates = headers.get("sec-fetch-mode") == ("navigate",)
        if headers.get("sec-fetch-site", ("",))[0] in STRANGERS and not navigates:
            return 403, "Pages of other origins have no access to this designer."
        return None

    async def _let_in(self, send: Send, headers: Mapping[str, tuple[str, ...]]) -> None:
        """Exchange the token for the cookie, and redirect to the address without it."""
        given = f"{self._cookie}={self.keys.cookie}; Path=/; HttpOnly; SameSite=Strict"
        found = [(b"set-cookie", given.encode())]
        if headers.get("sec-fetch-site", ("none",))[0] == "none":
            await _reply(send, 303, b"", [*found, (b"location", ENTRY.encode())])
        else:
            await _reply(send, 200, BOUNCE, [*found, (b"content-type", b"text/html")])


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
    found: dict[str, tuple[str, ...]] = {}
    for name, value in scope["headers"]:
        key = name.decode("latin-1").lower()
        found[key] = (*found.get(key, ()), value.decode("latin-1"))
    return found


def _token(scope: Scope) -> str | None:
    """The token in the address, if that is the one at which tokens are exchanged."""
    if scope["type"] != "http" or scope["path"] != ENTRY:
        return None
    query = scope["query_string"].decode("latin-1")
    return dict(parse_qsl(query)).get("token") if len(query) < 500 else None


def _cookie(headers: Mapping[str, tuple[str, ...]], name: str) -> str:
    for each in ";".join(headers.get("cookie", ())).split(";"):
        key, _, value = each.partition("=")
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
    head = {"type": "http.response.start", "status": status, "headers": [*headers, length]}
    await send(head)
    await send({"type": "http.response.body", "body": data})
