"""A session of the designer: one scene, the pages that show it, and the processes that compute it.

Every change of the text makes a revision. What is computed of one is sent to all pages, unless a
later one has been made meanwhile: the newest wins.
"""

from __future__ import annotations

import asyncio
from collections import deque
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Final

from camgeo.designing import opened
from camgeo.designing.desk import Desk
from camgeo.designing.job import Job, JobError
from camgeo.designing.opened import OverwriteError
from camgeo.errors import CamgeoError
from camgeo.scene.new import KINDS, template
from camgeo.writing.writer import writer_names
from camgeo_export.designer.files import Files
from camgeo_export.designer.messages import MessageError, Said, understood
from camgeo_export.designer.pages import Page

Compute = Callable[[Job, float], Mapping[str, Any]]
"""Does a job within some seconds, in a process of its own; Refused if it has no result."""

PAUSE: Final = 0.12
"""Seconds after the last change before findings are computed."""

EVERY: Final = 1.0
"""Seconds between two looks at the file on disk, and two times that edits are put on disk."""

SECONDS: Final[Mapping[str, float]] = {
    "curves": 10.0,
    "change": 10.0,
    "laws": 10.0,
    "templates": 10.0,
    "effects": 10.0,
    "findings": 60.0,
    "solid": 60.0,
    "size": 120.0,
    "build": 600.0,
}
"""That each kind of job may take."""

ANSWERS: Final[Mapping[str, str]] = {
    "build": "built",
    "size": "sized",
    "solid": "solid",
    "laws": "laws",
    "templates": "templates",
    "effects": "effects",
}
"""Jobs that a page asks for, and the kind of their answer."""

LONG: Final = ("build", "size", "solid")
"""Jobs that a page is told of when they begin."""

MOST_ASKED: Final = 100
"""Requests that wait to be done."""

NOTHING: Final[Mapping[str, Any]] = {
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
class Asked:
    """A request, and the page that it is from."""

    page: Page
    said: Said


class Session:
    """What all pages of a designer share.

    Parameters
    ----------
    desk : the scene.
    compute : what does the jobs; it is called in threads.
    cancel : ends the job of a kind that is being done.
    """

    def __init__(self, desk: Desk, compute: Compute, cancel: Callable[[str], None]) -> None:
        self.desk = desk
        self.files = Files()
        self._compute, self._cancel = compute, cancel
        self._pages: set[Page] = set()
        self._asked: deque[Asked] = deque()
        self._wake = asyncio.Event()
        self._revision = 0
        self._painted = -1
        self._curves: dict[str, Any] = {}
        self._findings: dict[str, Any] | None = None
        self._pinned: dict[str, Any] | None = None
        self._disk = desk.disk
        self._scenes = list(opened.scenes(desk.folder))
        self._formats = writer_names()
        self._unsynced = False
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
                    page.put({"kind": "refused", "id": error.id, "message": f"{error}"})
        finally:
            self._pages.discard(page)
            sending.cancel()

    def _hear(self, page: Page, said: Said) -> None:
        """Answer at once what needs no computing; line up the rest."""
        if said.kind == "hello":
            self._greet(page)
            return
        if said.kind in ANSWERS:
            self._begin(self._answer(page, said))
            return
        waiting = self._asked[-1] if self._asked else None
        if waiting is not None and waiting.page is page and _replaces(said, waiting.said):
            self._asked.pop()
        if len(self._asked) >= MOST_ASKED:
            raise MessageError("too much is asked at once", said.id)
        self._asked.append(Asked(page, said))
        self._wake.set()

    def _greet(self, page: Page) -> None:
        page.put(self._state(whole=True))
        if self._painted == self._revision:
            page.put({**self._curves, "answers": None})
        if self._findings is not None:
            page.put(self._findings)
        if self._pinned is not None:
            page.put({"kind": "pinned", "curves": self._pinned})

    # -- the scene ---------------------------------------------------------------------------------

    async def run(self) -> None:
        """Do what pages ask, one after the other, until this is cancelled."""
        watching = asyncio.create_task(self._watch())
        try:
            self._tell()
            await self._paint(None)
            while True:
                await self._wake.wait()
                self._wake.clear()
                while self._asked:
                    await self._do(self._asked.popleft())
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
        except OverwriteError as error:
            self._refuse(asked, str(error), force=True)
        except (CamgeoError, JobError) as error:
            self._refuse(asked, str(error))
        self._tell()

    async def _change(self, asked: Asked) -> None:
        """Change the text as the page asks, by a job that paints the new text too."""
        arguments = dict(asked.said.arguments)
        gesture = arguments.pop("gesture", "")
        result = dict(await self._job("change", arguments))
        text, label = result.pop("text", None), result.pop("label", None)
        if not isinstance(text, str) or "refused" in result:
            sentence = str(result.get("refused") or "this cannot be changed so")
            self._refuse(asked, sentence, faults=result.get("faults", []))
            return
        self._apply(lambda: self.desk.change(text, str(label or "change"), gesture))
        self._painted = self._revision
        self._show({**result, "label": label}, asked)
        self._broadcast(self._state())

    async def _step(self, asked: Asked) -> None:
        """Anything but a change by a job: the text is known at once, and painted if it is new."""
        said, given = asked.said, asked.said.arguments
        desk = self.desk
        match said.kind:
            case "text":
                gesture = given.get("gesture", "")
                self._apply(lambda: desk.change(given["text"], "text", gesture))
            case "undo":
                self._apply(desk.undo)
            case "redo":
                self._apply(desk.redo)
            case "reload":
                self._apply(desk.reload)
            case "open":
                self._apply(lambda: desk.open(given["path"]))
            case "new":
                self._apply(lambda: self._new(given["template"]))
            case "save":
                await asyncio.to_thread(
                    desk.save, given.get("path"), force=given.get("force", False)
                )
            case "pin" | "unpin":
                self._pin(said.kind == "pin")
        self._disk = desk.disk
        whole = said.kind in ("undo", "redo", "reload", "open", "new")
        self._broadcast(self._state(whole=whole))
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

    def _pin(self, pinned: bool) -> None:
        self._pinned = self._curves if pinned else None
        self._broadcast({"kind": "pinned", "curves": self._pinned})

    # -- what is computed --------------------------------------------------------------------------

    async def _paint(self, asked: Asked | None) -> None:
        """Compute the curves of the present text and show them."""
        revision = self._revision
        result: Mapping[str, Any] = NOTHING
        if self.desk.text.strip():
            try:
                result = await self._job("curves")
            except CamgeoError as error:
                result = {"faults": [_fault(str(error))]}
        self._painted = revision
        self._show(result, asked)
        if self._findings is None:
            self._judge()

    def _show(self, result: Mapping[str, Any], asked: Asked | None) -> None:
        """Show curves of the present text to all pages."""
        known = {"kind": "curves", "revision": self._revision, "text": self.desk.text}
        self._curves = {**result, **known}
        for page in self._pages:
            answers = asked.said.id if asked is not None and page is asked.page else None
            page.put({**self._curves, "answers": answers})

    def _judge(self) -> None:
        """Compute the findings once nothing has changed for a while."""
        self._findings = None
        if self._judging is None or self._judging.done():
            self._judging = asyncio.create_task(self._find())

    async def _find(self) -> None:
        revision = -1
        while revision != self._revision:
            while revision != self._revision:
                revision = self._revision
                await asyncio.sleep(PAUSE)
            if not self.desk.text.strip():
                found: Mapping[str, Any] = {"faults": [], "findings": [], "cures": [], "places": []}
            else:
                try:
                    found = await self._job("findings")
                except CamgeoError as error:
                    found = {"faults": [_fault(str(error))]}
        self._findings = {**found, "kind": "findings", "revision": revision}
        self._broadcast(self._findings)

    async def _answer(self, page: Page, said: Said) -> None:
        """Do a job that one page asks for, and answer it."""
        arguments = dict(said.arguments)
        if said.kind == "size":
            arguments = dict(arguments.get("arguments", {}))
        if said.kind in LONG:
            page.put({"kind": "busy", "what": said.kind})
        revision = self._revision
        try:
            result = dict(await self._job(said.kind, arguments))
        except CamgeoError as error:
            page.put({"kind": "refused", "id": said.id, "message": str(error)})
            return
        if said.kind == "build":
            result["files"] = self.files.take(result.get("files", ()))
        answer = {"kind": ANSWERS[said.kind], "revision": revision, "answers": said.id}
        page.put({**arguments, **result, **answer})

    async def _job(
        self, kind: str, arguments: Mapping[str, Any] | None = None
    ) -> Mapping[str, Any]:
        """The result of a job for the present text; Refused, JobError if there is none."""
        file = "" if self.desk.opened is None else str(self.desk.opened.path)
        folder = self.desk.folder if self.desk.opened is None else self.desk.opened.path.parent
        job = Job(kind, self.desk.text, file, str(folder), arguments or {})
        return await asyncio.to_thread(self._compute, job, SECONDS[kind])

    # -- what pages are told -----------------------------------------------------------------------

    def _state(self, *, whole: bool = False) -> dict[str, Any]:
        """The state of the session; `whole` with the text, and the folder looked at anew."""
        desk = self.desk
        found = {
            "kind": "state",
            "revision": self._revision,
            "file": desk.name,
            "saved": desk.saved,
            "undo": desk.history.undo,
            "redo": desk.history.redo,
            "disk": self._disk,
            "pinned": self._pinned is not None,
            "folder": str(desk.folder),
            "templates": KINDS,
            "formats": self._formats,
        }
        if whole:
            self._scenes = list(opened.scenes(desk.folder))
            found["text"] = desk.text
        found["folder_files"] = self._scenes
        return found

    def _broadcast(self, message: dict[str, Any]) -> None:
        for page in self._pages:
            page.put(message)

    def _tell(self) -> None:
        for sentence in self.desk.told():
            self._broadcast({"kind": "told", "message": sentence})

    def _refuse(self, asked: Asked, sentence: str, **more: Any) -> None:
        message = {"kind": "refused", "id": asked.said.id, "message": sentence, **more}
        asked.page.put(message)

    def _begin(self, work: Any) -> None:
        task = asyncio.create_task(work)
        self._tasks.add(task)
        task.add_done_callback(self._tasks.discard)

    async def _watch(self) -> None:
        """Look again and again whether the file has changed, and put edits on disk."""
        while True:
            await asyncio.sleep(EVERY)
            if self._unsynced:
                self._unsynced = False
                await asyncio.to_thread(self.desk.sync)
            if self._pages and (disk := self.desk.disk) != self._disk:
                self._disk = disk
                self._broadcast(self._state())
                if disk != "same":
                    message = f"{self.desk.name} has been {BECOME[disk]}"
                    self._broadcast({"kind": "told", "message": message})


def _replaces(said: Said, waiting: Said) -> bool:
    """Whether a message makes one needless that still waits: a later place of the same drag."""
    gesture = said.arguments.get("gesture")
    alike = said.kind == waiting.kind and said.arguments.keys() == waiting.arguments.keys()
    return bool(gesture) and alike and waiting.arguments.get("gesture") == gesture


def _fault(sentence: str) -> dict[str, Any]:
    return {"key": "", "value": "", "message": sentence, "hint": "", "line": None}
