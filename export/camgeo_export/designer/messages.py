"""What a page may send to the server: JSON texts, each checked before it is acted on."""

from __future__ import annotations

import asyncio
import json
import math
import re
import time
from collections.abc import Callable, Container, Mapping
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from typing import Any, Final

from camgeo.app.designing.children import Job, Result
from camgeo.app.designing.desk import Desk
from camgeo.errors import CamgeoError
from camgeo.reading import SCENE

LARGEST: Final = 3 * SCENE.size
"""Most bytes of a message: JSON spells some characters of a scene with two or more."""

DEEPEST: Final = 8
"""Most levels of tables and lists in a message."""

LONGEST_NAME: Final = 200
"""Most characters of names, keys and identifiers."""

MOST_EDITS: Final = 200
"""Most keys that one message changes."""


class MessageError(CamgeoError, ValueError):
    """A message that is not understood.

    Attributes
    ----------
    id : of the message, if it has one.
    """

    def __init__(self, sentence: str, id_: str | int | None = None) -> None:
        super().__init__(sentence)
        self.id = id_


@dataclass(frozen=True, slots=True)
class Said:
    """A message from a page.

    Attributes
    ----------
    kind : what is asked for.
    id : that the answer carries; None if the page gave none.
    arguments : of that kind of message.
    """

    kind: str
    id: str | int | None = None
    arguments: Mapping[str, Any] = field(default_factory=dict)

    def replaces(self, waiting: Said) -> bool:
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
"""Jobs that a page asks for, and the kind of their answer."""

LONG: Final = ("build", "size", "solid")
"""Jobs that a page is told of when they begin."""

WHOLE: Final = ("undo", "redo", "reload", "open", "new")
"""Requests after which pages are sent the text with the state."""

TEXTUAL: Final = ("edits", "effect", "segment", "table")
"""Changes that need nothing but the text."""

MOST_ASKED: Final = 100
"""Requests that wait to be done."""

MOST_JOBS: Final = 8
"""Jobs of ANSWERS that wait or are being done."""


def understood(text: str) -> Said:
    """The message in a text.

    Raises
    ------
    MessageError
        If it is not JSON, or not as its kind must be.
    """
    try:
        found = json.loads(text, parse_constant=_no_number)
        flat = _is_flat(found, DEEPEST)
    except (ValueError, RecursionError):
        raise MessageError("a message must be JSON, with finite numbers") from None
    if not isinstance(found, dict) or not flat:
        raise MessageError(f"a message must be a table, at most {DEEPEST} deep, of finite numbers")
    id_ = found.pop("id", None)
    if id_ is not None and not (_is_index(id_) or _is_name(id_)):
        raise MessageError("id must be a short text or a whole number")
    kind = found.pop("kind", None)
    if not isinstance(kind, str) or kind not in KINDS:
        raise MessageError(f"kind must be one of {', '.join(KINDS)}", id_)
    for key, value in found.items():
        check = KINDS[kind].get(key)
        if check is None:
            raise MessageError(f"{kind} has no {key[:LONGEST_NAME]!r}", id_)
        if value is None:
            continue
        if not check(value):
            raise MessageError(f"{key} of {kind} is not what it must be", id_)
    given = {key: value for key, value in found.items() if value is not None}
    for key in NEEDED.get(kind, ()):
        if key not in given:
            raise MessageError(f"{kind} needs {key}", id_)
    if kind == "change":
        _check_change(given, id_)
    return Said(kind, id_, given)


def _check_change(given: Mapping[str, Any], id_: str | int | None) -> None:
    stated = [key for key in CHANGES if key in given]
    if len(stated) != 1:
        raise MessageError(f"change needs one of {', '.join(CHANGES)}", id_)
    if ("handle" in given) != ("to" in given):
        raise MessageError("a handle needs a place to go to, and only that", id_)


def _is_flat(value: Any, depth: int) -> bool:
    """Whether a value has at most `depth` levels, and no infinite number."""
    if isinstance(value, float):
        return math.isfinite(value)
    if isinstance(value, dict):
        return depth > 0 and all(_is_flat(each, depth - 1) for each in value.values())
    if isinstance(value, list):
        return depth > 0 and all(_is_flat(each, depth - 1) for each in value)
    return True


def _no_number(name: str) -> float:
    raise ValueError(name)


# -- jobs -----------------------------------------------------------------------------------------
# Jobs of a session: for which text each is done, how long it may take, and which are given up.


Compute = Callable[[Job, float], Result]
"""Does a job within some seconds, in a process of its own; a CamgeoError if it has no result."""

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


def head_of(text: bytes, last: Container[str]) -> dict[str, Any]:
    """The members of a JSON object up to the first whose key is one of `last`, or all.

    What follows, pictures say, is not read: that takes longer than all else that is done here.
    """
    decoded = text.decode()
    found: dict[str, Any] = {}
    at = _after_space(decoded, decoded.index("{") + 1)
    while decoded[at] != "}":
        key, at = DECODER.raw_decode(decoded, at)
        found[key], at = DECODER.raw_decode(decoded, _after_space(decoded, at))
        if key in last:
            break
        at = _after_space(decoded, at)
    return found


def _after_space(text: str, at: int) -> int:
    found = SPACE.match(text, at)
    return at if found is None else found.end()


class Jobs:
    """Does the jobs of a session, each for the text that is on the desk when it begins.

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

    async def do(self, kind: str, arguments: Mapping[str, Any] | None = None) -> Result:
        """The result of a job; CamgeoError if there is none."""
        desk = self._desk
        file = "" if desk.opened is None else str(desk.opened.path)
        job = Job(kind, desk.text, file, str(desk.beside), arguments or {})
        began = self._began.setdefault(kind, [])
        began.append(now := time.monotonic())
        try:
            loop = asyncio.get_running_loop()
            return await loop.run_in_executor(self._threads, self._compute, job, SECONDS[kind])
        finally:
            began.remove(now)
            if kind in PICTURES:
                self._painted = time.monotonic()

    def give_up(self, kind: str, patience: float, *, unless: str = "") -> None:
        """End jobs of a kind that were begun more than `patience` seconds ago.

        Nothing is ended while there is a job `unless`, which the same process does.
        """
        began = self._began.get(kind)
        if began and not self._began.get(unless) and time.monotonic() - began[0] > patience:
            self._cancel(kind)

    def close(self) -> None:
        """Wait for nothing more; threads end when the processes do."""
        self._threads.shutdown(wait=False, cancel_futures=True)
