"""The content of a scene as a tree of plain values, with numbers as written, and their lines."""

from __future__ import annotations

import datetime as dt
import itertools
import pathlib
import re
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from decimal import Decimal
from types import MappingProxyType
from typing import Any, Final, Self

from camgeo.displayed import Brief
from camgeo.errors import Fault, FileError
from camgeo.reading import SCENE, check_toml
from camgeo.scene.keys import Path, key_lines, line_of, spelled, value_at
from camgeo.scene.noted import ABSENT
from camgeo.scene.tree import DEEPEST, Taking, Tree, refused
from camgeo.units import LengthUnit, in_unit

LONGEST_VALUE: Final = 60
"""Characters shown of a value."""

INTEGER_BITS: Final = 64
"""Bits of TOML's integers; a longer one is no size of a cam, and slow to print."""

BYTE_ORDER_MARK: Final = "\ufeff"

NOTHING: Final = (ABSENT, None)

TOML_PLACE: Final = re.compile(r" \(at (?:line (?P<line>\d+), column \d+|end of document)\)$")
"""The place that tomllib appends to its messages."""


@dataclass(frozen=True, slots=True)
class Document(Brief):
    """The values of a scene, right or wrong.

    Attributes
    ----------
    exact : the tree with each decimal number as a Decimal, exactly as written.
    plain : the same tree with floats; None stands for a value that no scene may have.
    faults : what is wrong at those places.
    bad : the paths of those places.
    lines : of the keys, if the scene came from a text.
    """

    exact: Tree
    plain: Tree
    faults: tuple[Fault, ...]
    bad: frozenset[Path]
    lines: dict[Path, int] = field(default_factory=dict)

    def fault(self, path: Path, message: str, hint: str = "") -> Fault:
        """A fault of the value at `path`, which need not exist, with its line; the message states
        lengths in mm, the fault in the unit of the scene.
        """
        message = in_unit(message, self.unit)
        return Fault(spelled(path), written(self.at(path)), message, hint, self.line(path))

    @property
    def unit(self) -> LengthUnit:
        """The unit of length, mm if it is not valid."""
        return "inch" if self.at(("units", "length")) == "inch" else "mm"

    def line(self, path: Path) -> int | None:
        """Line of `path`, else of what is around it."""
        return line_of(path, self.lines)

    def at(self, path: Path) -> Any:
        """The exact value at `path`, or None if there is none."""
        return value_at(self.exact, path)


@dataclass(frozen=True, slots=True)
class Source(Brief):
    """What a scene was made from, in addition to its values.

    Attributes
    ----------
    file : path of the scene file as given; empty without one.
    folder : in which the files lie that the scene names, absolute; None if there is none.
    text : TOML whose comments and order the scene keeps; empty if it was made from values.
    contents : of the files that the scene names, by these names, as they were read.
    """

    file: str = ""
    folder: pathlib.Path | None = None
    text: str = ""
    contents: Mapping[str, bytes] = field(default_factory=lambda: MappingProxyType({}))

    @classmethod
    def of(cls, file: str, folder: str | pathlib.Path | None, text: str = "") -> Self:
        """The source of a scene in `folder`, or in the folder of its file."""
        if folder is None:
            return cls(file, pathlib.Path(file).resolve().parent if file else None, text)
        return cls(file, pathlib.Path(folder).resolve(), text)

    def having(self, contents: Mapping[str, bytes]) -> Self:
        """The same source with these contents of its files."""
        return replace(self, contents=MappingProxyType(dict(contents)))


def data_of(text: str) -> bytes:
    """The bytes of a scene's text; raises SceneError if it is none."""
    try:
        return text.encode()
    except UnicodeEncodeError as error:
        raise refused("is not text that UTF-8 can encode") from error


def document(data: bytes) -> Document:
    """Parse the bytes of a TOML file; raises SceneError if they are not valid TOML."""
    text = _text(data)
    try:
        check_toml(text)
    except FileError as error:
        raise refused(str(error)) from None
    try:
        exact = tomllib.loads(text, parse_float=Decimal)
        found = document_of_tree(exact, key_lines(text.replace("\r\n", "\n")))
    except tomllib.TOMLDecodeError as error:
        place = TOML_PLACE.search(str(error))
        message = TOML_PLACE.sub("", str(error))
        line = int(place["line"]) if place and place["line"] else None
        if place and line is None:
            message += " before the end of the file"
        raise refused(f"is not valid TOML: {message}", line) from error
    except RecursionError as error:
        raise refused("is nested too deeply for a scene") from error
    except (ValueError, ArithmeticError) as error:
        # Python refuses to read an integer of thousands of digits.
        raise refused("holds a number with too many digits") from error
    if not exact:
        raise refused("is empty; `camgeo new` writes a scene to start from")
    return found


def document_of(values: Mapping[str, Any]) -> Document:
    """Take values from Python, see `camgeo.scene.tree.Taking`; raises SceneError as that does."""
    if not isinstance(values, Mapping):
        raise refused(f"must be a mapping of its tables, and not {type(values).__name__}")
    return document_of_tree(Taking().take(values))


def document_of_tree(
    exact: Tree, lines: dict[Path, int] | None = None, earlier: Document | None = None
) -> Document:
    """The document of a tree, which must not be changed afterwards, with the lines of its keys.

    What the tree shares with that of an `earlier` document without faults is taken from there.
    """
    troubles: dict[Path, str] = {}
    known = NOTHING if earlier is None else (earlier.exact, earlier.plain)
    plain = _plain(exact, (), troubles, known)
    found = Document(exact, plain, (), frozenset(troubles), lines or {})
    return replace(found, faults=tuple(itertools.starmap(found.fault, troubles.items())))


def written(value: Any) -> str:
    """Return a value as it stands in TOML, cut if it is long; nothing for a table or for None."""
    if value is None or isinstance(value, dict):
        return ""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        text = '"' + value[: LONGEST_VALUE + 1].replace("\\", "\\\\").replace('"', '\\"') + '"'
        text = "".join(c if c.isprintable() else f"\\u{ord(c):04X}" for c in text)
    elif isinstance(value, list):
        if any(isinstance(item, dict | list) for item in value):
            return ""
        text = "[" + ", ".join(written(item) for item in value[:LONGEST_VALUE]) + "]"
    elif isinstance(value, int) and value.bit_length() > INTEGER_BITS:
        text = hex(value)
    elif not isinstance(value, int | Decimal | dt.date | dt.time):
        text = f"<{type(value).__name__}>"
    else:
        text = str(value).lower().replace("infinity", "inf").replace("e+", "e")
    return text if len(text) <= LONGEST_VALUE else text[:LONGEST_VALUE] + "..."


def _text(data: bytes) -> str:
    if len(data) > SCENE.size:
        raise refused(f"is larger than {SCENE.size:,} bytes, too large for a scene")
    try:
        text = data.decode("utf-8").removeprefix(BYTE_ORDER_MARK)
    except UnicodeDecodeError as error:
        line = data.count(b"\n", 0, error.start) + 1
        raise refused("is not UTF-8 text; save it in that encoding", line) from error
    if not text.strip():
        raise refused("is empty; `camgeo new` writes a scene to start from")
    return text


def _trouble(value: Any) -> str:
    """Why a single value cannot be a value of any scene; empty if it can."""
    if isinstance(value, Decimal):
        if not value.is_finite():
            return "must be a finite number"
        if not abs(float(value)) < float("inf"):
            return "is too large for a number"
    elif isinstance(value, int):
        if value.bit_length() > INTEGER_BITS:
            return "is too large for a number"
    elif isinstance(value, str):
        if not value.isascii() and value != value.encode(errors="replace").decode():
            return "is not text that UTF-8 can encode"
    elif isinstance(value, dt.date | dt.time):
        return "a date or time has no place in a scene"
    else:
        return "must be text, a number, true or false, a list or a table"
    return ""


def _plain(
    value: Any, path: Path, troubles: dict[Path, str], known: tuple[Any, Any] = NOTHING
) -> Any:
    """The value with floats, None for what no scene may have; the reason goes into `troubles`.

    `known` is a value without troubles and what was made of it.
    """
    if len(path) > DEEPEST:
        raise RecursionError
    if value is known[0]:
        return known[1]
    if isinstance(value, dict):
        exact, plain = known if isinstance(known[0], dict) else ({}, {})
        return {
            key: _plain(item, (*path, key), troubles, (exact.get(key, ABSENT), plain.get(key)))
            for key, item in value.items()
        }
    if isinstance(value, list):
        return [_plain(item, (*path, index), troubles) for index, item in enumerate(value)]
    if trouble := _trouble(value):
        troubles[path] = trouble
        return None
    return float(value) if isinstance(value, Decimal) else value
