"""The application: page, scripts and style, the socket of messages, and files to be downloaded."""

from __future__ import annotations

import logging
from collections.abc import Awaitable, Callable
from importlib.resources import files
from typing import Final

from starlette.applications import Starlette
from starlette.requests import Request
from starlette.responses import PlainTextResponse, Response
from starlette.routing import Route, WebSocketRoute
from starlette.websockets import WebSocket, WebSocketDisconnect

from camgeo_export.designer.files import disposition
from camgeo_export.designer.guard import Address, Guard, Keys
from camgeo_export.designer.pages import Page
from camgeo_export.designer.session import Session

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

    async def socket(found: WebSocket) -> None:
        await found.accept()
        if session.pages >= MOST_PAGES:
            await found.close(FULL, "too many pages of this designer are open")
            return
        try:
            await session.serve(Page(found))
        except WebSocketDisconnect as gone:
            if gone.code == NO_TEXT:
                await found.close(NO_TEXT, "messages are texts")
        except Exception:
            LOG.exception("a page of the designer has ended with an error in camgeo")
            await found.close(BROKEN, "an error in camgeo")

    async def built(request: Request) -> Response:
        name = request.path_params["name"]
        data = session.files.get(name, request.query_params.get("build", ""))
        if data is None:
            return PlainTextResponse("This file is not of the last build.\n", 404)
        headers = {"content-disposition": disposition(name)}
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


def _source(name: str) -> Callable[[Request], Awaitable[Response]]:
    """An endpoint that answers with a file of the page."""
    folder, kind = PAGE[name]

    async def answer(_: Request) -> Response:
        data = files("camgeo_export.browser").joinpath(folder, name).read_bytes()
        return Response(data, media_type=kind)

    return answer


async def _nothing(_: Request) -> Response:
    return Response(status_code=204)
