"""The pages that show a session: what waits to be sent to each, and how fast each may ask."""

from __future__ import annotations

import asyncio
import json
import time
from typing import Any, Final

from starlette.websockets import WebSocket, WebSocketDisconnect

LATEST: Final = ("state", "curves", "findings", "pinned")
"""Kinds of messages of which a page needs the latest only: a page that takes them slowly, or not at
all, has no more than one of each waiting."""

MOST_WAITING: Final = 100
"""Messages that wait for a page; one that takes none for so long is given up."""

RATE: Final = 100.0
"""Messages in a second that are taken from a page; a drag makes sixty. The rest waits there."""

BURST: Final = 200.0
"""Messages that it may send at once."""


class Page:
    """A page that is connected."""

    def __init__(self, socket: WebSocket) -> None:
        self.socket = socket
        self._waiting: dict[object, dict[str, Any]] = {}
        self._ready = asyncio.Event()
        self._left, self._seen = BURST, time.monotonic()

    def put(self, message: dict[str, Any]) -> None:
        """Send a message as soon as the page takes it; of some kinds only the latest."""
        kind = message["kind"]
        key: object = kind if kind in LATEST else object()
        before = self._waiting.pop(key, None)
        if before is not None:
            message = _merged(before, message)
        if len(self._waiting) < MOST_WAITING:
            self._waiting[key] = message
        self._ready.set()

    async def send(self) -> None:
        """Send what waits, until the page is gone."""
        while True:
            await self._ready.wait()
            self._ready.clear()
            while self._waiting:
                message = self._waiting.pop(next(iter(self._waiting)))
                text = json.dumps(message, ensure_ascii=False, allow_nan=False)
                await self.socket.send_text(text)

    async def receive(self) -> str:
        """The next message of the page; WebSocketDisconnect if it is gone, or sends no text."""
        now = time.monotonic()
        self._left = min(BURST, self._left + RATE * (now - self._seen)) - 1.0
        self._seen = now
        if self._left < 0.0:
            await asyncio.sleep(-self._left / RATE)
        message = await self.socket.receive()
        text = message.get("text")
        if message["type"] != "websocket.receive" or text is None:
            raise WebSocketDisconnect(1003)
        return str(text)


def _merged(before: dict[str, Any], message: dict[str, Any]) -> dict[str, Any]:
    """The latest of two messages of a kind, with what it only says once from the earlier one."""
    if message["kind"] == "curves" and message.get("answers") is None:
        return {**message, "answers": before.get("answers")}
    if message["kind"] == "state":
        return {**before, **message}
    return message
