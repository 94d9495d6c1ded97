"""A session of the designer: one scene, the pages that show it, and the processes that compute it.

Every change of the text makes a revision. What is computed of one is sent to all pages, unless a
later one has been made meanwhile: the newest wins.
"""

from __future__ import annotations

import asyncio
import base64
import io
import json
import re
import time
import zipfile
from collections import deque
from collections.abc import Callable, Coroutine, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, Final
from urllib.parse import quote

from starlette.websockets import WebSocket, WebSocketDisconnect

from camgeo.app.designing import desk as opened
from camgeo.app.designing import edits
from camgeo.app.designing.children import Refused
from camgeo.app.designing.desk import Desk
from camgeo.app.designing.faults import verdict_of
from camgeo.design.writing import writer_names
from camgeo.errors import CamgeoError
from camgeo.scene.toml import TEMPLATE_KINDS, template
from camgeo.scene.values import Stamp, named, stamp
from camgeo_export.designer.messages import (
    ANSWERS,
    LONG,
    MOST_ASKED,
    MOST_JOBS,
    TEXTUAL,
    WHOLE,
    Jobs,
    MessageError,
    Said,
    head_of,
    understood,
)

PAUSE: Final = 0.12
"""Seconds after the last picture before findings are computed."""

FIRST: Final = 0.1
"""Seconds that the rest of a picture waits for findings."""

PATIENCE: Final = 4.0
"""Seconds after which a picture, or findings, are given up if there is a newer text. It costs a
process, of which a new one takes a second to be ready."""

EVERY: Final = 1.0
"""Seconds between two looks at the file on disk, and two times that edits are put on disk."""

QUICK: Final = 100_000
"""Characters of a text that is changed at once here, if its picture takes too long."""


class Session:
    """What all pages of a designer share.

    Parameters
    ----------
    desk : the scene.
    jobs : what computes.
    notes : sentences that the first page is told.
    """

    def __init__(self, desk: Desk, jobs: Jobs, notes: Sequence[str] = ()) -> None:
        self.desk = desk
        self.files = Files()
        self._jobs = jobs
        self._notes = tuple(notes)
        self._pages: set[Page] = set()
        self._asked: deque[Asked] = deque()
        self._wake = asyncio.Event()
        self._revision = 0
        self._painted = -1
        self._curves = Message("curves")
        self._findings: Message | None = None
        self._results: dict[str, Mapping[str, Any]] = {}  # what the verdict is made of
        self._verdict = Message("verdict", {"revision": 0, **verdict_of({})})
        self._pinned: bytes | None = None
        self._disk = desk.disk
        self._scenes = list(opened.scenes(desk.folder))
        self._formats = writer_names()
        self._unsynced = self._outdated = False
        self._judging: asyncio.Task[None] | None = None
        self._tasks: set[asyncio.Task[None]] = set()

    # -- what pages say ----------------------------------------------------------------------------

    @property
    def pages(self) -> int:
        """How many are connected."""
        return len(self._pages)

    async def serve(self, page: Page) -> None:
        """Take what a page says, until it is gone."""
        self._pages.add(page)
        sending = asyncio.create_task(page.send())
        try:
            while True:
                text = await page.receive()
                try:
                    self._hear(page, understood(text))
                except MessageError as error:
                    page.put(refused(error.id, str(error)))
        finally:
            self._pages.discard(page)
            sending.cancel()

    def _hear(self, page: Page, said: Said) -> None:
        """Answer at once what needs no computing; line up the rest."""
        if said.kind == "hello":
            self._greet(page)
        elif said.kind in ANSWERS:
            if len(self._tasks) >= MOST_JOBS:
                raise MessageError("too much is computed at once", said.id)
            self._begin(self._answer(page, said))
        else:
            waiting = self._asked[-1] if self._asked else None
            if waiting is not None and waiting.page is page and said.replaces(waiting.said):
                self._asked.pop()
            if len(self._asked) >= MOST_ASKED:
                raise MessageError("too much is asked at once", said.id)
            self._asked.append(Asked(page, said))
            self._wake.set()
            self._jobs.give_up("curves", PATIENCE)

    def _greet(self, page: Page) -> None:
        page.put(self._state(whole=True))
        page.put(self._verdict)
        if self._painted == self._revision:
            page.put(self._curves)
        if self._findings is not None:
            page.put(self._findings)
        page.put(self._pinned_message())
        for sentence in self._notes:
            page.put(told(sentence))
        self._notes = ()

    # -- the scene ---------------------------------------------------------------------------------

    async def run(self) -> None:
        """Do what pages ask, one after the other, until this is cancelled."""
        watching = asyncio.create_task(self._watch())
        try:
            await self._paint(None)
            while True:
                await self._wake.wait()
                self._wake.clear()
                while self._asked:
                    await self._do(self._asked.popleft())
                if self._painted != self._revision and self._jobs.idle >= PAUSE:
                    await self._paint(None)  # a drag has paused
                if self._outdated:
                    self._outdated = False
                    await self._paint(None)
                    self._judge()
        finally:
            for task in (watching, self._judging, *self._tasks):
                if task is not None:
                    task.cancel()

    async def _do(self, asked: Asked) -> None:
        """Do one request; what is wrong with it is told to the page that made it."""
        try:
            if asked.said.kind == "change":
                await self._change(asked)
            else:
                await self._step(asked)
        except opened.OverwriteError as error:
            asked.page.put(refused(asked.said.id, str(error), force=True))
        except CamgeoError as error:
            asked.page.put(refused(asked.said.id, str(error)))
        for sentence in self.desk.told():
            self._broadcast(told(sentence))

    async def _change(self, asked: Asked) -> None:
        """Change the text as the page asks, by a job that paints the new text too."""
        arguments = dict(asked.said.arguments)
        gesture = arguments.pop("gesture", "")
        if gesture:
            arguments["moving"] = True
        try:
            found = await self._jobs.do("change", arguments)
            data, painting = head_of(found.text, ("label", "refused")), found.text
        except Refused as error:
            data = await asyncio.to_thread(self._changed_here, arguments, error)
            painting = unpainted(error, label=data["label"])
        if "refused" in data or not isinstance(data.get("text"), str):
            sentence = str(data.get("refused") or "this cannot be changed so")
            asked.page.put(refused(asked.said.id, sentence, faults=data.get("faults", [])))
            return
        label = str(data.get("label") or "change")
        self._apply(lambda: self.desk.change(data["text"], label, gesture))
        moving = data.get("moving") is True
        if not moving:
            self._painted = self._revision
        self._show(painting, asked, moving=moving)
        self._broadcast(self._state())

    def _changed_here(self, arguments: Mapping[str, Any], error: Refused) -> dict[str, Any]:
        """The changed text without its picture, which takes too long; `error` if it needs one."""
        desk = self.desk
        if len(desk.text) > QUICK or not any(key in arguments for key in TEXTUAL):
            raise error
        found = edits.changed(desk.text, desk.name or "", desk.folder, arguments)
        return {"text": found.text, "label": found.label}

    async def _step(self, asked: Asked) -> None:
        """Anything but a change by a job: the text is known at once, and painted if it is new."""
        said, given, desk = asked.said, asked.said.arguments, self.desk
        match said.kind:
            case "text":
                gesture = given.get("gesture", "")
                self._apply(lambda: desk.change(given["text"], "text", gesture))
            case "open":
                self._apply(lambda: desk.open(given["path"]))
            case "new":
                self._apply(lambda: self._new(given["template"]))
            case "save":
                force = given.get("force", False)
                await asyncio.to_thread(desk.save, given.get("path"), force=force)
            case "pin" | "unpin":
                if self._painted != self._revision:
                    await self._paint(None)
                self._pinned = self._curves.text.encode() if said.kind == "pin" else None
                self._broadcast(self._pinned_message())
            case _:
                self._apply({"undo": desk.undo, "redo": desk.redo}.get(said.kind, desk.reload))
        self._disk = desk.disk
        self._scenes = list(opened.scenes(desk.folder))
        self._broadcast(self._state(whole=said.kind in WHOLE))
        if not self._asked and (self._painted != self._revision or said.id is not None):
            await self._paint(asked)

    def _apply(self, change: Callable[[], None]) -> None:
        """Change the desk; a revision is made if text or file have changed."""
        before = self.desk.text, self.desk.opened
        change()
        if (self.desk.text, self.desk.opened) != before:
            self._revision += 1
            self._unsynced = True
            self._judge()

    def _new(self, name: str) -> None:
        text = template(name)  # UnknownNameError if there is none
        self.desk.begin()
        self.desk.change(text, f"new scene, {name}")

    # -- what is computed --------------------------------------------------------------------------

    async def _paint(self, asked: Asked | None) -> None:
        """Compute the curves of the present text and show them."""
        painting = body(EMPTY)
        if self.desk.text.strip():
            try:
                painting = (await self._jobs.do("curves")).text
            except CamgeoError as error:
                if self._asked:
                    return  # given up for something newer
                painting = unpainted(error)
        self._painted = self._revision
        self._show(painting, asked)
        if self._findings is None:
            self._judge()

    def _show(self, painting: bytes, asked: Asked | None, *, moving: bool = False) -> None:
        """Show curves of the present text to all pages, or only what moves of them."""
        head = {"revision": self._revision, "text": self.desk.text, "answers": None}
        if moving:
            self._results["curves"] = {}  # what can be dragged has no faults
        else:
            self._tell_verdict("curves", head_of(painting, ("faults",)), self._revision)
            self._curves = Message("curves", head, painting)
        kind = "moved" if moving else "curves"
        for page in self._pages:
            answers = asked.said.id if asked is not None and page is asked.page else None
            page.put(Message(kind, {**head, "answers": answers}, painting))

    def _judge(self) -> None:
        """Compute the findings once nothing has changed for a while."""
        self._findings = None
        self._results = {kind: self._results[kind] for kind in self._results if kind == "curves"}
        self._jobs.give_up("findings", PATIENCE, unless="solid")
        if self._judging is None or self._judging.done():
            self._judging = asyncio.create_task(self._find())

    async def _find(self) -> None:
        revision = -1
        found = NOTHING
        while revision != self._revision:
            while (left := PAUSE - self._jobs.idle) > 0.0:  # a drag goes on
                await asyncio.sleep(left)
            revision = self._revision
            # What has not been painted of it follows: a page shows findings sooner before it.
            rest = asyncio.get_running_loop().call_later(FIRST, self._wake.set)
            found = body({"faults": [], "refused": "there is no scene yet"})
            if self.desk.text.strip():
                try:
                    found = (await self._jobs.do("findings")).text
                except CamgeoError as error:
                    found = body({"faults": [], "refused": str(error)})
            rest.cancel()
            self._wake.set()
        self._findings = Message("findings", {"revision": revision}, found)
        self._tell_verdict("findings", head_of(found, ("findings",)), revision)
        self._broadcast(self._findings)

    async def _answer(self, page: Page, said: Said) -> None:
        """Do a job that one page asks for, and answer it."""
        arguments = dict(said.arguments)
        if said.kind in LONG:
            page.put(Message("busy", {"what": said.kind}))
        head = {**arguments, "revision": (revision := self._revision), "answers": said.id}
        try:
            found = await self._jobs.do(said.kind, arguments)
        except CamgeoError as error:
            if said.kind == "build" and isinstance(error, Refused):
                self._tell_verdict("build", {"refused": str(error)}, revision)
            page.put(refused(said.id, str(error)))
            return
        painting = found.text
        if said.kind == "build":
            self._tell_verdict("build", {"faults": found.data["faults"]}, revision)
            files = self.files.take(found.data.get("files", ()))
            painting = body({**found.data, "files": files})
        page.put(Message(ANSWERS[said.kind], head, painting))

    # -- what pages are told -----------------------------------------------------------------------

    def _state(self, *, whole: bool = False) -> Message:
        """The state of the session, `whole` with the text."""
        desk = self.desk
        found = {
            "revision": self._revision,
            "file": desk.name,
            "saved": desk.saved,
            "undo": desk.history.undo,
            "redo": desk.history.redo,
            "disk": self._disk,
            "pinned": self._pinned is not None,
            "folder": str(desk.folder),
            "folder_files": self._scenes,
            "templates": TEMPLATE_KINDS,
            "formats": self._formats,
        }
        return Message("state", {**found, "text": desk.text} if whole else found)

    def _tell_verdict(self, kind: str, result: Mapping[str, Any], revision: int) -> None:
        """Tell all pages the verdict, now that a job has a `result`, if that is of this text."""
        if revision != self._revision:
            return
        self._results[kind] = result
        found = verdict_of(self._results)
        self._verdict = Message("verdict", {"revision": self._revision, **found})
        self._broadcast(self._verdict)

    def _pinned_message(self) -> Message:
        return Message("pinned", {}, self._pinned or b"null", "curves")

    def _broadcast(self, message: Message) -> None:
        for page in self._pages:
            page.put(message)

    def _begin(self, work: Coroutine[Any, Any, None]) -> None:
        task = asyncio.create_task(work)
        self._tasks.add(task)
        task.add_done_callback(self._tasks.discard)

    async def _watch(self) -> None:
        """Look again and again whether files have changed, and put edits on disk."""
        files = NamedFiles()
        while True:
            await asyncio.sleep(EVERY)
            if await files.changed(self.desk.text, self.desk.beside):
                self._outdated = True
                self._wake.set()
            if self._unsynced:
                self._unsynced = False
                await asyncio.to_thread(self.desk.sync)
            disk = self.desk.disk
            if disk != self._disk:
                self._disk = disk
                self._broadcast(self._state())
                if disk != "same":
                    self._broadcast(told(f"{self.desk.name} has been {BECOME[disk]}"))


# -- files ----------------------------------------------------------------------------------------
# The files of the last build, for download.


ALL: Final = "all.zip"
"""The name under which all files are downloaded as one."""

EARLIEST: Final = (1980, 1, 1, 0, 0, 0)
"""Time of files in an archive: always the same, so that the same files give the same bytes."""


class Files:
    """The files of the last build, by their names."""

    def __init__(self) -> None:
        self._data: dict[str, bytes] = {}
        self._build = 0

    def take(self, built: Iterable[Mapping[str, Any]]) -> list[dict[str, Any]]:
        """Replace the files by those of a build; return what pages are told about them."""
        self._data = {str(each["name"]): base64.b64decode(each["bytes"]) for each in built}
        self._build += 1
        return [
            {**_told(each), "url": f"/files/{quote(str(each['name']))}?build={self._build}"}
            for each in built
        ]

    def get(self, name: str, build: str) -> bytes | None:
        """The file of that name, if it is of the last build; `build` may be empty."""
        if build and build != str(self._build):
            return None
        if name == ALL and self._data and ALL not in self._data:
            return self._archive()
        return self._data.get(name)

    def _archive(self) -> bytes:
        stream = io.BytesIO()
        with zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED) as archive:
            for name, data in self._data.items():
                archive.writestr(zipfile.ZipInfo(name, EARLIEST), data)
        return stream.getvalue()


def disposition(name: str) -> str:
    """The header that makes a browser save a file under its name."""
    plain = re.sub(r"[^A-Za-z0-9._-]", "_", name)
    return f"attachment; filename=\"{plain}\"; filename*=UTF-8''{quote(name, safe='')}"


def _told(each: Mapping[str, Any]) -> dict[str, Any]:
    return {key: value for key, value in each.items() if key != "bytes"}


# -- named files ----------------------------------------------------------------------------------
# The files that the scene on a desk names, and whether they have changed.


LONGEST: Final = 200_000
"""Most characters of a text that is searched for names; searching holds up other threads."""


class NamedFiles:
    """The files that a text names, checked at intervals."""

    def __init__(self) -> None:
        self._text = ""
        self._files: tuple[Path, ...] = ()
        self._seen: dict[Path, Stamp] = {}

    async def changed(self, text: str, folder: Path) -> bool:
        """Whether a file that the `text` names has changed since the last call; not on the first.

        While the text is not TOML, the last known names count.
        """
        if text != self._text and len(text) <= LONGEST:
            self._text = text
            found = await asyncio.to_thread(named, text, folder)
            self._files = self._files if found is None else found
        now = {path: stamp(path) for path in self._files}
        seen, self._seen = self._seen, now
        return any(seen.get(path, now[path]) != now[path] for path in now)


# -- pages ----------------------------------------------------------------------------------------
# The pages that show a session: what waits to be sent to each, and how fast each may ask.


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
