"""A session of the designer: one scene, the pages that show it, and the processes that compute it.

Every change of the text makes a revision. What is computed of one is sent to all pages, unless a
later one has been made meanwhile: the newest wins.
"""

from __future__ import annotations

import asyncio
import base64
import io
import json
import math
import re
import time
import zipfile
from collections import deque
from collections.abc import Callable, Container, Coroutine, Iterable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, Final
from urllib.parse import quote

from starlette.websockets import WebSocket, WebSocketDisconnect

from camgeo.app.designing import desk as opened
from camgeo.app.designing import edits
from camgeo.app.designing.children import Job, JobResult, Refused
from camgeo.app.designing.desk import Desk
from camgeo.app.designing.faults import scene_verdict
from camgeo.design.writing import writer_names
from camgeo.errors import CamgeoError
from camgeo.scene.toml import TEMPLATE_KINDS, template
from camgeo.scene.values import Stamp, named_files, stamp

# -- messages -------------------------------------------------------------------------------------
# What a page may send to the server: JSON texts, each checked before it is acted on.


DEEPEST: Final = 8
"""Most levels of tables and lists in a message."""

LONGEST_NAME: Final = 200
"""Most characters of names, keys and identifiers."""

MOST_EDITS: Final = 200
"""Most keys that one message changes."""


class MessageError(CamgeoError, ValueError):
    """The error for a message that is not valid.

    Attributes
    ----------
    id : of the message, if it has one.
    """

    def __init__(self, sentence: str, id_: str | int | None = None) -> None:
        super().__init__(sentence)
        self.id = id_


@dataclass(frozen=True, slots=True)
class PageMessage:
    """A message from a page.

    Attributes
    ----------
    kind : what the page asks for.
    id : identifier that the answer repeats; None if the page gave none.
    arguments : those of that kind of message.
    """

    kind: str
    id: str | int | None = None
    arguments: Mapping[str, Any] = field(default_factory=dict)

    def replaces(self, waiting: PageMessage) -> bool:
        """Whether this makes a waiting message unnecessary, as a later place of the same drag."""
        gesture = self.arguments.get("gesture")
        alike = self.kind == waiting.kind and self.arguments.keys() == waiting.arguments.keys()
        return bool(gesture) and alike and waiting.arguments.get("gesture") == gesture


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)


def _is_index(value: Any) -> bool:
    return isinstance(value, int) and not isinstance(value, bool) and abs(value) < 1_000_000


def _is_name(value: Any) -> bool:
    return isinstance(value, str) and len(value) <= LONGEST_NAME


def _is_text(value: Any) -> bool:
    return isinstance(value, str)


def _is_flag(value: Any) -> bool:
    return isinstance(value, bool)


def _is_table(value: Any) -> bool:
    return isinstance(value, dict) and len(value) <= MOST_EDITS and all(map(_is_name, value))


def _is_place(value: Any) -> bool:
    return isinstance(value, list) and len(value) == 2 and all(map(_is_number, value))


def _is_names(value: Any) -> bool:
    return isinstance(value, list) and len(value) <= MOST_EDITS and all(map(_is_name, value))


Check = Callable[[Any], bool]

CHANGES: Final[Mapping[str, Check]] = {
    "edits": _is_table,
    "handle": _is_name,
    "segment": _is_table,
    "table": _is_table,
    "effect": _is_table,
    "cure": _is_index,
    "sized": _is_table,
}
"""What a change may be: one of these."""

KINDS: Final[Mapping[str, Mapping[str, Check]]] = {
    "hello": {},
    "change": {**CHANGES, "to": _is_place, "step": _is_number, "gesture": _is_name},
    "text": {"text": _is_text, "gesture": _is_name},
    "undo": {},
    "redo": {},
    "save": {"path": _is_name, "force": _is_flag},
    "open": {"path": _is_name},
    "new": {"template": _is_name},
    "reload": {},
    "build": {"formats": _is_names},
    "size": {
        "transmission_angle": _is_number,
        "radius_ratio": _is_number,
        "radius_of_curvature": _is_number,
        "arm": _is_place,
    },
    "solid": {},
    "laws": {"segment": _is_index},
    "templates": {},
    "effects": {},
    "pin": {},
    "unpin": {},
}
"""The arguments of each kind of message; NEEDED has those that it must have."""

NEEDED: Final[Mapping[str, tuple[str, ...]]] = {
    "text": ("text",),
    "open": ("path",),
    "new": ("template",),
    "laws": ("segment",),
}

ANSWERS: Final[Mapping[str, str]] = {
    "build": "built",
    "size": "sized",
    "solid": "solid",
    "laws": "laws",
    "templates": "templates",
    "effects": "effects",
}
"""Jobs that a page asks for, and the kinds of messages that answer them."""

LONG: Final = ("build", "size", "solid")
"""Jobs whose beginning is reported to the page that asks for them."""

WHOLE: Final = ("undo", "redo", "reload", "open", "new")
"""Requests after which pages are sent the text with the state."""

TEXTUAL: Final = ("edits", "effect", "segment", "table")
"""Kinds of changes that need nothing but the text."""

MOST_REQUESTS: Final = 100
"""Most requests that wait to be carried out."""

MOST_JOBS: Final = 8
"""Most jobs of `ANSWERS` that wait or are being run."""


def parse_message(text: str) -> PageMessage:
    """The message in a text.

    Raises
    ------
    MessageError
        If it is not JSON, or not as its kind must be.
    """
    try:
        message = json.loads(text, parse_constant=_no_number)
        flat = _is_flat(message, DEEPEST)
    except (ValueError, RecursionError):
        raise MessageError("a message must be JSON, with finite numbers") from None
    if not isinstance(message, dict) or not flat:
        raise MessageError(f"a message must be a table, at most {DEEPEST} deep, of finite numbers")
    id_ = message.pop("id", None)
    if id_ is not None and not (_is_index(id_) or _is_name(id_)):
        raise MessageError("id must be a short text or a whole number")
    kind = message.pop("kind", None)
    if not isinstance(kind, str) or kind not in KINDS:
        raise MessageError(f"kind must be one of {', '.join(KINDS)}", id_)
    for key, value in message.items():
        check = KINDS[kind].get(key)
        if check is None:
            raise MessageError(f"{kind} has no {key[:LONGEST_NAME]!r}", id_)
        if value is None:
            continue
        if not check(value):
            raise MessageError(f"{key} of {kind} has a value of the wrong kind", id_)
    arguments = {key: value for key, value in message.items() if value is not None}
    for key in NEEDED.get(kind, ()):
        if key not in arguments:
            raise MessageError(f"{kind} needs {key}", id_)
    if kind == "change":
        _check_change(arguments, id_)
    return PageMessage(kind, id_, arguments)


def _check_change(arguments: Mapping[str, Any], id_: str | int | None) -> None:
    stated = [key for key in CHANGES if key in arguments]
    if len(stated) != 1:
        raise MessageError(f"change needs one of {', '.join(CHANGES)}", id_)
    if ("handle" in arguments) != ("to" in arguments):
        raise MessageError("the place `to` is needed with a handle, and allowed only with one", id_)


def _is_flat(value: Any, depth: int) -> bool:
    """Whether a value has at most `depth` levels, and no infinite number."""
    if isinstance(value, float):
        return math.isfinite(value)
    if isinstance(value, dict):
        return depth > 0 and all(_is_flat(member, depth - 1) for member in value.values())
    if isinstance(value, list):
        return depth > 0 and all(_is_flat(member, depth - 1) for member in value)
    return True


def _no_number(name: str) -> float:
    raise ValueError(name)


# -- jobs -----------------------------------------------------------------------------------------
# Jobs of a session: for which text each is done, how long it may take, and which are given up.


Compute = Callable[[Job, float], JobResult]
"""Runs a job for at most some seconds, in a process of its own; CamgeoError if it has no result."""

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
"""Most seconds that each kind of job may take."""

PICTURES: Final = ("curves", "change")
"""Kinds of jobs whose results are shown at once."""

DECODER: Final = json.JSONDecoder()

THREADS: Final = 16
"""Most threads that wait for processes: more than there can be jobs."""


SPACE: Final = re.compile(r"[ \t\r\n,:]*")
"""What separates keys and values."""


def read_head(text: bytes, last: Container[str]) -> dict[str, Any]:
    """The members of a JSON object up to the first whose key is one of `last`, or all.

    What follows, pictures say, is not read: that takes longer than all else that is done here.
    """
    decoded = text.decode()
    members: dict[str, Any] = {}
    place = _skip_space(decoded, decoded.index("{") + 1)
    while decoded[place] != "}":
        key, place = DECODER.raw_decode(decoded, place)
        members[key], place = DECODER.raw_decode(decoded, _skip_space(decoded, place))
        if key in last:
            break
        place = _skip_space(decoded, place)
    return members


def _skip_space(text: str, place: int) -> int:
    match = SPACE.match(text, place)
    return place if match is None else match.end()


class Jobs:
    """Runs the jobs of a session, each for the text that is on the desk when it begins.

    Parameters
    ----------
    desk : with the scene.
    compute : what does a job; it is called in threads.
    cancel : ends the job of a kind that is being done.
    """

    def __init__(self, desk: Desk, compute: Compute, cancel: Callable[[str], None]) -> None:
        self._desk = desk
        self._compute, self._cancel = compute, cancel
        self._threads = ThreadPoolExecutor(THREADS, "camgeo-designer")
        self._began: dict[str, list[float]] = {}
        self._painted = 0.0

    @property
    def idle(self) -> float:
        """Seconds since the last picture was computed; 0 while one is."""
        if any(self._began.get(kind) for kind in PICTURES):
            return 0.0
        return time.monotonic() - self._painted

    async def do(self, kind: str, arguments: Mapping[str, Any] | None = None) -> JobResult:
        """The result of a job; CamgeoError if there is none."""
        desk = self._desk
        file = "" if desk.opened is None else str(desk.opened.path)
        job = Job(kind, desk.text, file, str(desk.data_folder), arguments or {})
        began = self._began.setdefault(kind, [])
        began.append(now := time.monotonic())
        try:
            loop = asyncio.get_running_loop()
            return await loop.run_in_executor(self._threads, self._compute, job, SECONDS[kind])
        finally:
            began.remove(now)
            if kind in PICTURES:
                self._painted = time.monotonic()

    def cancel_overdue(self, kind: str, patience: float, *, unless: str = "") -> None:
        """Cancel the jobs of a kind if the oldest began more than `patience` seconds ago.

        Nothing is cancelled while there is a job of the kind `unless`, which the same process runs.
        """
        began = self._began.get(kind)
        if began and not self._began.get(unless) and time.monotonic() - began[0] > patience:
            self._cancel(kind)

    def close(self) -> None:
        """Stop waiting for jobs; the threads end when the processes do."""
        self._threads.shutdown(wait=False, cancel_futures=True)


# -- session ---------------------------------------------------------------------------------------
# What all pages share: a text, its revisions, and what is computed of each.


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
    notes : sentences for the first page.
    """

    def __init__(self, desk: Desk, jobs: Jobs, notes: Sequence[str] = ()) -> None:
        self.desk = desk
        self.files = Files()
        self._jobs = jobs
        self._notes = tuple(notes)
        self._pages: set[Page] = set()
        self._requests: deque[PageRequest] = deque()
        self._wake = asyncio.Event()
        self._revision = 0
        self._painted = -1
        self._curves = Message("curves")
        self._findings: Message | None = None
        self._results: dict[str, Mapping[str, Any]] = {}  # what the verdict is made of
        self._verdict = Message("verdict", {"revision": 0, **scene_verdict({})})
        self._pinned: bytes | None = None
        self._disk = desk.disk
        self._scenes = list(opened.scenes(desk.folder))
        self._formats = writer_names()
        self._unsynced = self._outdated = False
        self._finding_task: asyncio.Task[None] | None = None
        self._tasks: set[asyncio.Task[None]] = set()

    # -- what pages say ----------------------------------------------------------------------------

    @property
    def pages(self) -> int:
        """The number of connected pages."""
        return len(self._pages)

    async def serve(self, page: Page) -> None:
        """Take the messages of a page until it has gone."""
        self._pages.add(page)
        sending = asyncio.create_task(page.send())
        try:
            while True:
                text = await page.receive()
                try:
                    self._hear(page, parse_message(text))
                except MessageError as error:
                    page.enqueue(refusal(error.id, str(error)))
        finally:
            self._pages.discard(page)
            sending.cancel()

    def _hear(self, page: Page, message: PageMessage) -> None:
        """Answer at once what needs no computation, and queue the rest."""
        if message.kind == "hello":
            self._greet(page)
        elif message.kind in ANSWERS:
            if len(self._tasks) >= MOST_JOBS:
                raise MessageError("too many computations are running at the same time", message.id)
            self._begin(self._answer(page, message))
        else:
            waiting = self._requests[-1] if self._requests else None
            if waiting is not None and waiting.page is page and message.replaces(waiting.message):
                self._requests.pop()
            if len(self._requests) >= MOST_REQUESTS:
                raise MessageError("too many requests are waiting", message.id)
            self._requests.append(PageRequest(page, message))
            self._wake.set()
            self._jobs.cancel_overdue("curves", PATIENCE)

    def _greet(self, page: Page) -> None:
        page.enqueue(self._state(whole=True))
        page.enqueue(self._verdict)
        if self._painted == self._revision:
            page.enqueue(self._curves)
        if self._findings is not None:
            page.enqueue(self._findings)
        page.enqueue(self._pinned_message())
        for sentence in self._notes:
            page.enqueue(notice(sentence))
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
                while self._requests:
                    await self._do(self._requests.popleft())
                if self._painted != self._revision and self._jobs.idle >= PAUSE:
                    await self._paint(None)  # a drag has paused
                if self._outdated:
                    self._outdated = False
                    await self._paint(None)
                    self._request_findings()
        finally:
            for task in (watching, self._finding_task, *self._tasks):
                if task is not None:
                    task.cancel()

    async def _do(self, request: PageRequest) -> None:
        """Carry out one request; what is wrong with it is reported to the page that made it."""
        try:
            if request.message.kind == "change":
                await self._change(request)
            else:
                await self._step(request)
        except opened.OverwriteError as error:
            request.page.enqueue(refusal(request.message.id, str(error), force=True))
        except CamgeoError as error:
            request.page.enqueue(refusal(request.message.id, str(error)))
        for sentence in self.desk.take_messages():
            self._broadcast(notice(sentence))

    async def _change(self, request: PageRequest) -> None:
        """Change the text as the page asks, by a job that paints the new text too."""
        arguments = dict(request.message.arguments)
        gesture = arguments.pop("gesture", "")
        if gesture:
            arguments["moving"] = True
        try:
            result = await self._jobs.do("change", arguments)
            data, painting = read_head(result.text, ("label", "refused")), result.text
        except Refused as error:
            data = await asyncio.to_thread(self._changed_here, arguments, error)
            painting = unpainted(error, label=data["label"])
        if "refused" in data or not isinstance(data.get("text"), str):
            sentence = str(data.get("refused") or "this change is not possible")
            request.page.enqueue(
                refusal(request.message.id, sentence, faults=data.get("faults", []))
            )
            return
        label = str(data.get("label") or "change")
        self._apply(lambda: self.desk.change(data["text"], label, gesture))
        moving = data.get("moving") is True
        if not moving:
            self._painted = self._revision
        self._show(painting, request, moving=moving)
        self._broadcast(self._state())

    def _changed_here(self, arguments: Mapping[str, Any], error: Refused) -> dict[str, Any]:
        """The changed text without its picture, which takes too long; `error` if it needs one."""
        desk = self.desk
        if len(desk.text) > QUICK or not any(key in arguments for key in TEXTUAL):
            raise error
        change = edits.changed(desk.text, desk.name or "", desk.folder, arguments)
        return {"text": change.text, "label": change.label}

    async def _step(self, request: PageRequest) -> None:
        """Anything but a change by a job: the text is known at once, and painted if it is new."""
        said, arguments, desk = request.message, request.message.arguments, self.desk
        match said.kind:
            case "text":
                gesture = arguments.get("gesture", "")
                self._apply(lambda: desk.change(arguments["text"], "text", gesture))
            case "open":
                self._apply(lambda: desk.open(arguments["path"]))
            case "new":
                self._apply(lambda: self._new(arguments["template"]))
            case "save":
                force = arguments.get("force", False)
                await asyncio.to_thread(desk.save, arguments.get("path"), force=force)
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
        if not self._requests and (self._painted != self._revision or said.id is not None):
            await self._paint(request)

    def _apply(self, change: Callable[[], None]) -> None:
        """Change the desk; a revision is made if text or file have changed."""
        previous = self.desk.text, self.desk.opened
        change()
        if (self.desk.text, self.desk.opened) != previous:
            self._revision += 1
            self._unsynced = True
            self._request_findings()

    def _new(self, name: str) -> None:
        text = template(name)  # UnknownNameError if there is none
        self.desk.begin()
        self.desk.change(text, f"new scene, {name}")

    # -- what is computed --------------------------------------------------------------------------

    async def _paint(self, request: PageRequest | None) -> None:
        """Compute the curves of the present text and show them."""
        painting = body(EMPTY)
        if self.desk.text.strip():
            try:
                painting = (await self._jobs.do("curves")).text
            except CamgeoError as error:
                if self._requests:
                    return  # given up for something newer
                painting = unpainted(error)
        self._painted = self._revision
        self._show(painting, request)
        if self._findings is None:
            self._request_findings()

    def _show(self, painting: bytes, request: PageRequest | None, *, moving: bool = False) -> None:
        """Send the curves of the present text to all pages, only what moves of them if `moving`."""
        head = {"revision": self._revision, "text": self.desk.text, "answers": None}
        if moving:
            self._results["curves"] = {}  # what can be dragged has no faults
        else:
            self._publish_verdict("curves", read_head(painting, ("faults",)), self._revision)
            self._curves = Message("curves", head, painting)
        kind = "moved" if moving else "curves"
        for page in self._pages:
            answers = request.message.id if request is not None and page is request.page else None
            page.enqueue(Message(kind, {**head, "answers": answers}, painting))

    def _request_findings(self) -> None:
        """Compute the findings once nothing has changed for a while."""
        self._findings = None
        self._results = {kind: self._results[kind] for kind in self._results if kind == "curves"}
        self._jobs.cancel_overdue("findings", PATIENCE, unless="solid")
        if self._finding_task is None or self._finding_task.done():
            self._finding_task = asyncio.create_task(self._find())

    async def _find(self) -> None:
        revision = -1
        findings = NOTHING
        while revision != self._revision:
            while (left := PAUSE - self._jobs.idle) > 0.0:  # a drag goes on
                await asyncio.sleep(left)
            revision = self._revision
            # A text that is not painted yet is painted a little later, so that findings that are
            # quick to compute are shown first.
            rest = asyncio.get_running_loop().call_later(FIRST, self._wake.set)
            findings = body({"faults": [], "refused": "there is no scene yet"})
            if self.desk.text.strip():
                try:
                    findings = (await self._jobs.do("findings")).text
                except CamgeoError as error:
                    findings = body({"faults": [], "refused": str(error)})
            rest.cancel()
            self._wake.set()
        self._findings = Message("findings", {"revision": revision}, findings)
        self._publish_verdict("findings", read_head(findings, ("findings",)), revision)
        self._broadcast(self._findings)

    async def _answer(self, page: Page, message: PageMessage) -> None:
        """Do a job that one page asks for, and answer it."""
        arguments = dict(message.arguments)
        if message.kind in LONG:
            page.enqueue(Message("busy", {"what": message.kind}))
        head = {**arguments, "revision": (revision := self._revision), "answers": message.id}
        try:
            result = await self._jobs.do(message.kind, arguments)
        except CamgeoError as error:
            if message.kind == "build" and isinstance(error, Refused):
                self._publish_verdict("build", {"refused": str(error)}, revision)
            page.enqueue(refusal(message.id, str(error)))
            return
        painting = result.text
        if message.kind == "build":
            self._publish_verdict("build", {"faults": result.data["faults"]}, revision)
            painting = body({**result.data, "files": self.files.take(result.data.get("files", ()))})
        page.enqueue(Message(ANSWERS[message.kind], head, painting))

    # -- what pages are sent -----------------------------------------------------------------------

    def _state(self, *, whole: bool = False) -> Message:
        """The state of the session, `whole` with the text."""
        desk = self.desk
        state = {
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
        return Message("state", {**state, "text": desk.text} if whole else state)

    def _publish_verdict(self, kind: str, result: Mapping[str, Any], revision: int) -> None:
        """Send the verdict to all pages, now that a job has a `result`, if it is of this text."""
        if revision != self._revision:
            return
        self._results[kind] = result
        verdict = scene_verdict(self._results)
        self._verdict = Message("verdict", {"revision": self._revision, **verdict})
        self._broadcast(self._verdict)

    def _pinned_message(self) -> Message:
        return Message("pinned", {}, self._pinned or b"null", "curves")

    def _broadcast(self, message: Message) -> None:
        for page in self._pages:
            page.enqueue(message)

    def _begin(self, work: Coroutine[Any, Any, None]) -> None:
        task = asyncio.create_task(work)
        self._tasks.add(task)
        task.add_done_callback(self._tasks.discard)

    async def _watch(self) -> None:
        """Check at intervals whether files have changed, and put edits on disk."""
        files = NamedFiles()
        while True:
            await asyncio.sleep(EVERY)
            if await files.changed(self.desk.text, self.desk.data_folder):
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
                    self._broadcast(notice(f"{self.desk.name} has been {BECOME[disk]}"))


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
        """Replace the files by those of a build; return what pages need to know about them."""
        self._data = {str(file["name"]): base64.b64decode(file["bytes"]) for file in built}
        self._build += 1
        return [
            {key: value for key, value in file.items() if key != "bytes"}
            | {"url": f"/files/{quote(str(file['name']))}?build={self._build}"}
            for file in built
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
            paths = await asyncio.to_thread(named_files, text, folder)
            self._files = self._files if paths is None else paths
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
"""Most other messages that wait for a page; later ones are dropped."""

RATE: Final = 100.0
"""Messages in a second that are taken from a page; a drag makes sixty. The rest waits there."""

BURST: Final = 200.0
"""Most messages that a page may send at once."""

NOTHING: Final = b"{}"

EMPTY: Final[Mapping[str, Any]] = {
    "faults": [], "name": "", "unit": "mm", "animation": None, "charts": [], "handles": [],
    "plan": [], "form": [],
}  # fmt: skip
"""The curves of an empty text."""

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
    kind : of the message.
    head : members beside the body, or the whole message.
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

    def merge(self, previous: Message) -> Message:
        """The message with what only the previous one of its kind says."""
        if self.kind == "state":
            return replace(self, head={**previous.head, **self.head})
        if self.kind in ("curves", "moved") and self.head.get("answers") is None:
            return replace(self, head={**self.head, "answers": previous.head.get("answers")})
        return self


def body(members: Mapping[str, Any]) -> bytes:
    """A JSON object as the body of a message."""
    return json.dumps(members, ensure_ascii=False, allow_nan=False).encode()


def unpainted(error: Exception, **more: Any) -> bytes:
    """Curves of a text whose picture could not be computed, and why: the scene is not at fault."""
    return body({"faults": [], "refused": f"the picture ({error})", **more})


def refusal(id_: str | int | None, sentence: str, **more: Any) -> Message:
    """The message that the request `id_` is refused, and why."""
    return Message("refused", {"id": id_, "message": sentence, **more})


def notice(sentence: str) -> Message:
    """A message with a sentence for the user."""
    return Message("told", {"message": sentence})


class Page:
    """A page that is connected."""

    def __init__(self, socket: WebSocket) -> None:
        self.socket = socket
        self._waiting: dict[object, Message] = {}
        self._ready = asyncio.Event()
        self._left, self._seen = BURST, time.monotonic()

    def enqueue(self, message: Message) -> None:
        """Queue a message for the page; of the kinds `LATEST` only the latest one waits."""
        key: object = message.kind if message.kind in LATEST else object()
        previous = self._waiting.pop(key, None)
        if previous is not None:
            message = message.merge(previous)
        if key == message.kind or len(self._waiting) < MOST_WAITING:
            self._waiting[key] = message
        self._ready.set()

    async def send(self) -> None:
        """Send the messages that wait, until the page has gone."""
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
class PageRequest:
    """A message of a page that is carried out in turn, and the page."""

    page: Page
    message: PageMessage
