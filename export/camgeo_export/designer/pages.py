"""The pages that show a session: what waits to be sent to each, and how fast each may ask."""

from __future__ import annotations

import asyncio
import json
import time
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any, Final

from starlette.websockets import WebSocket, WebSocketDisconnect

from camgeo_export.designer.messages import Said

LATEST: Final = (
    "state", "verdict", "curves", "moved", "findings", "pinned", "built", "sized", "solid",
    "templates", "effects",
)  # fmt: skip
"""Kinds of messages of which a page needs the latest only: a page that takes them slowly, or not at
all, has no more than one of each waiting."""

MOST_WAITING: Final = 50
"""Other messages that wait for a page; later ones are dropped."""

RATE: Final = 100.0
"""Messages in a second that are taken from a page; a drag makes sixty. The rest waits there."""

BURST: Final = 200.0
"""Messages that it may send at once."""

NOTHING: Final = b"{}"

EMPTY: Final[Mapping[str, Any]] = {
    "faults": [], "name": "", "unit": "mm", "animation": None, "charts": [], "handles": [],
    "plan": [], "form": [],
}  # fmt: skip
"""Curves of no scene."""

BECOME: Final[Mapping[str, str]] = {
    "changed": "changed on disk; it is not overwritten unless you ask for it",
    "gone": "removed from disk",
}
"""What has become of the file."""


@dataclass(frozen=True, slots=True)
class Message:
    """A message to a page.

    Attributes
    ----------
    kind : of it.
    head : what is said of the body, or the whole message.
    body : a JSON object with more, as the process that computed it wrote it.
    key : under which the body is; empty if it is on a level with the head.
    """

    kind: str
    head: Mapping[str, Any] = field(default_factory=dict)
    body: bytes = NOTHING
    key: str = ""

    @property
    def text(self) -> str:
        """The message as JSON."""
        head = json.dumps(
            {"kind": self.kind, **self.head}, ensure_ascii=False, allow_nan=False
        ).removesuffix("}")
        body = self.body.decode()
        if self.key:
            return f'{head}, "{self.key}": {body}}}'
        rest = body.lstrip().removeprefix("{")
        return f"{head}{'' if rest.strip() == '}' else ', '}{rest}"

    def after(self, before: Message) -> Message:
        """The later one of two messages of a kind, with what only the earlier one says."""
        if self.kind == "state":
            return replace(self, head={**before.head, **self.head})
        if self.kind in ("curves", "moved") and self.head.get("answers") is None:
            return replace(self, head={**self.head, "answers": before.head.get("answers")})
        return self


def body(found: Mapping[str, Any]) -> bytes:
    """A JSON object as the body of a message."""
    return json.dumps(found, ensure_ascii=False, allow_nan=False).encode()


def unpainted(error: Exception, **more: Any) -> bytes:
    """Curves of a text whose picture cannot be had, and why: that is no fault of the scene."""
    return body({"faults": [], "refused": f"the picture ({error})", **more})


def refused(id_: str | int | None, sentence: str, **more: Any) -> Message:
    """That the message `id_` is not done, and why."""
    return Message("refused", {"id": id_, "message": sentence, **more})


def told(sentence: str) -> Message:
    """A sentence for the user."""
    return Message("told", {"message": sentence})


class Page:
    """A page that is connected."""

    def __init__(self, socket: WebSocket) -> None:
        self.socket = socket
        self._waiting: dict[object, Message] = {}
        self._ready = asyncio.Event()
        self._left, self._seen = BURST, time.monotonic()

    def put(self, message: Message) -> None:
        """Send a message as soon as the page takes it; of some kinds only the latest."""
        key: object = message.kind if message.kind in LATEST else object()
        before = self._waiting.pop(key, None)
        if before is not None:
            message = message.after(before)
        if key == message.kind or len(self._waiting) < MOST_WAITING:
            self._waiting[key] = message
        self._ready.set()

    async def send(self) -> None:
        """Send what waits, until the page is gone."""
        while True:
            await self._ready.wait()
            self._ready.clear()
            while self._waiting:
                await self.socket.send_text(self._waiting.pop(next(iter(self._waiting))).text)

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
            raise WebSocketDisconnect(message.get("code", 1003))
        return str(text)


@dataclass(frozen=True, slots=True)
class Asked:
    """A request, and the page that it is from."""

    page: Page
    said: Said
