"""Serving the designer: its socket, its processes, its end."""

from __future__ import annotations

import asyncio
import contextlib
import os
import socket
import sys
import threading
import webbrowser
from collections.abc import Callable, Sequence
from typing import Final

import uvicorn
from uvicorn.protocols.http.h11_impl import H11Protocol
from uvicorn.protocols.websockets.websockets_sansio_impl import WebSocketsSansIOProtocol

from camgeo.designing.children import Children
from camgeo.designing.desk import Desk
from camgeo.errors import CamgeoError, unreadable
from camgeo_export.designer.application import application
from camgeo_export.designer.guard import Address, Guard, Keys, is_loopback
from camgeo_export.designer.jobs import Jobs
from camgeo_export.designer.messages import LARGEST
from camgeo_export.designer.session import Session

MOST_CONNECTIONS: Final = 64
"""Most connections at the same time; a page needs two or three. For each one more, the oldest that
is not a page's socket is closed, so silent ones keep nobody out."""

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
        self.made = self.loop.time()
        self.loop.call_later(PATIENCE, self._give_up)
        if len(self.connections) > MOST_CONNECTIONS:
            found = (each for each in self.connections if isinstance(each, Connection))
            min(found, key=lambda each: each.made).abort()

    def abort(self) -> None:
        """Close it at once, whatever it is doing."""
        self.transport.abort()
        self.connections.discard(self)

    def _give_up(self) -> None:
        if self in self.connections and not self.headers:  # None until there is a request
            self.abort()


def listening(host: str, port: int) -> socket.socket:
    """A socket that listens at host and port; CamgeoError if it cannot."""
    family = socket.AF_INET6 if ":" in host else socket.AF_INET
    # With its protocol stated, asyncio sends each message at once, not 40 ms later.
    found = socket.socket(family, socket.SOCK_STREAM, socket.IPPROTO_TCP)
    try:
        found.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        found.bind((host, port))
        found.listen(BACKLOG)
    except OSError as error:
        found.close()
        raise CamgeoError(f"cannot listen at {host}, port {port}: {unreadable(error)}") from error
    return found


def serve(
    desk: Desk,
    host: str,
    port: int,
    tell: Callable[[str, bool], None],
    *,
    notes: Sequence[str] = (),
    browser: bool = True,
) -> None:
    """Serve the scene on a desk until a signal arrives; then nothing is left running.

    Parameters
    ----------
    host, port : where to listen; port 0 for any that is free.
    tell : called once, with the address and whether only this machine can reach it.
    notes : sentences for the first page.
    browser : whether to open it.

    Raises
    ------
    CamgeoError
        If it cannot listen there.
    """
    with contextlib.closing(desk), listening(host, port) as found, Children() as children:
        address = Address(host, found.getsockname()[1])
        jobs = Jobs(desk, children.submit, children.cancel)
        keys = Keys()
        url = f"http://{address.shown}/?token="

        def ready() -> None:
            tell(f"{url}{keys.token}", is_loopback(host))
            if browser and _has_screen():
                # The end does not wait for this thread: some browsers keep it while they run.
                threading.Thread(target=_open, args=(url + keys.lend(),), daemon=True).start()

        asyncio.run(_serve(Session(desk, jobs, notes), address, keys, found, ready))


def server_of(app: Guard) -> uvicorn.Server:
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
    found: socket.socket,
    ready: Callable[[], None],
) -> None:
    server = server_of(application(session, address, keys))
    working = asyncio.create_task(session.run())
    working.add_done_callback(lambda _: setattr(server, "should_exit", True))
    ready()
    try:
        await server.serve(sockets=[found])
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
