"""A session of the designer: one scene, the pages that show it, and the processes that compute it.

Every change of the text makes a revision. What is computed of one is sent to all pages, unless a
later one has been made meanwhile: the newest wins.
"""

from __future__ import annotations

import asyncio
from collections import deque
from collections.abc import Callable, Coroutine, Mapping, Sequence
from typing import Any, Final

from camgeo.designing import edits, opened
from camgeo.designing.children import Refused
from camgeo.designing.desk import Desk
from camgeo.designing.verdict import verdict_of
from camgeo.errors import CamgeoError
from camgeo.scene.new import KINDS, template
from camgeo.writing.writer import writer_names
from camgeo_export.designer.files import Files
from camgeo_export.designer.jobs import Jobs, head_of
from camgeo_export.designer.messages import (
    ANSWERS,
    LONG,
    MOST_ASKED,
    MOST_JOBS,
    TEXTUAL,
    WHOLE,
    MessageError,
    Said,
    understood,
)
from camgeo_export.designer.named_files import NamedFiles
from camgeo_export.designer.pages import (
    BECOME,
    EMPTY,
    NOTHING,
    Asked,
    Message,
    Page,
    body,
    refused,
    told,
    unpainted,
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
            "templates": KINDS,
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
