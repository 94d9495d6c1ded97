"""The contents of a DXF file: tags, and the entities that they make up.

The file is gone through once, and of each entity only its place is kept: its tags, which take many
times the memory of their text, are made anew whenever it is asked for.
"""

from __future__ import annotations

import codecs
import io
import re
from array import array
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field
from itertools import count, pairwise
from typing import Final, NamedTuple

from camgeo.reading import DRAWING, check_text
from camgeo_export.errors import FileError, finite

CODE: Final = re.compile(rb"\s*-?[0-9]{1,4}\s*")
"""A line with a group code."""

COMMENT: Final = 999
"""Group code of comments, which alone may come before the first section."""

NAME: Final = 2
LAYER: Final = 8
VARIABLE: Final = 9
PAPER: Final = 67
"""Group codes of names, layers, variables of the header, and of what is in paper space."""

MOST_CODES: Final = 1_000
"""Ways to write a group code that are remembered."""

PARTS: Final = (b"VERTEX", b"SEQEND")
"""Entities that belong to the POLYLINE before them."""

REPORTED: Final = 1_000_000
"""Lines after which progress is reported again."""

Progress = Callable[[str], object]


class EntityError(FileError):
    """The error for an entity that cannot be used, whatever the rest of the drawing is."""


class Tag(NamedTuple):
    """A group code with its value and its line number."""

    code: int
    value: str
    line: int


@dataclass(frozen=True, slots=True)
class Item:
    """An entity of the drawing with its first line and its vertices, if any."""

    name: str
    kind: str
    line: int
    tags: tuple[Tag, ...]
    vertices: tuple[Item, ...] = ()

    @classmethod
    def of(cls, name: str, tags: list[Tag]) -> Item:
        """Of its tags, from the one that names its kind to the last of its vertices."""
        firsts = [*(place for place, tag in enumerate(tags) if tag.code == 0), len(tags)]
        own, *parts = (
            cls(name, tags[low].value, tags[low].line, tuple(tags[low + 1 : high]))
            for low, high in pairwise(firsts)
        )
        vertices = tuple(part for part in parts if part.kind == "VERTEX")
        return cls(name, own.kind, own.line, own.tags, vertices)

    @property
    def layer(self) -> str:
        """Its layer, 0 if it names none."""
        return self.text(8, "0")

    def fault(self, message: str) -> EntityError:
        """An error that names the entity and its line."""
        return EntityError(f"{self.name}, line {self.line}: {self.kind} {message}")

    def text(self, code: int, default: str = "") -> str:
        """The first value of group `code` as it is written."""
        return next((tag.value for tag in self.tags if tag.code == code), default)

    def number(self, code: int, default: float | None = None) -> float:
        """The first value of group `code`."""
        tag = next((tag for tag in self.tags if tag.code == code), None)
        if tag is None:
            if default is None:
                raise self.fault(f"has no group {code}")
            return default
        return self.value(tag)

    def value(self, tag: Tag) -> float:
        """The finite number in one of its tags."""
        return finite(tag.value, self.name, tag.line)

    def point(self, code: int, default: float | None = None) -> complex:
        """The place in group `code` and the one of its y, in units of the drawing."""
        return complex(self.number(code, default), self.number(code + 10, default))


@dataclass(frozen=True, slots=True)
class Items:
    """The entities of a part of the file, in order; each is made when it is asked for.

    Attributes
    ----------
    name : of the file, for messages.
    data : its text, with LF at the ends of lines.
    places : where each begins and ends in it, and the line before it, one after the other.
    """

    name: str
    data: bytes = field(repr=False)
    places: array[int] = field(default_factory=lambda: array("q"), repr=False)

    def __len__(self) -> int:
        return len(self.places) // 3

    def __iter__(self) -> Iterator[Item]:
        each = iter(self.places)
        for start, end, line in zip(each, each, each, strict=True):
            lines = self.data[start : end - 1].decode("utf-8", "replace").split("\n")
            codes, values = map(int, lines[0::2]), map(str.strip, lines[1::2])
            yield Item.of(self.name, list(map(Tag, codes, values, count(line + 2, 2))))


Contents = tuple[dict[str, Tag], Items, Items, dict[str, str], dict[str, tuple[Item, Items]]]
"""Header variables, each with its value; entities of the model space; records of the layers; names
of the layers that entities are on, by their lower case; record and entities of the blocks, too."""


def read_contents(data: bytes, name: str, progress: Progress = lambda _: None) -> Contents:
    """The contents of the file `name`; `progress` is told from time to time how far it has come.

    Raises FileError with the line if it is not a DXF file in text, or ends before its end.
    """
    if data.startswith(b"AutoCAD Binary DXF"):
        raise FileError(f"{name}: is a binary DXF; save it as text (ASCII)")
    check_text(data, DRAWING, name)
    data = data.removeprefix(codecs.BOM_UTF8)
    if b"\r" in data:
        data = data.replace(b"\r\n", b"\n").replace(b"\r", b"\n")
    header, items, layers, heads = (Items(name, data) for _ in range(4))
    inner: list[Items] = []  # of each block
    written: set[bytes] = set()
    kind = ""
    for section, kind, place, paper in _records(_tags(data, name, progress), written):
        if section == "BLOCKS" and kind == "BLOCK":
            inner.append(Items(name, data))
        block = heads if kind == "BLOCK" else inner[-1] if inner else None
        own = {"HEADER": header, "ENTITIES": None if paper else items, "BLOCKS": block}
        into = own.get(section, layers if kind == "LAYER" else None)
        if into is not None and (kind != "SECTION" or into is header):
            into.places.extend(place)
    if kind != "EOF":
        raise FileError(f"{name}: not a complete DXF file: no EOF at its end")
    spelled = {_text(each).lower(): _text(each) for each in sorted(written)}
    spelled |= {each.text(2).lower(): each.text(2) for each in layers}
    names = {_text(each).lower(): spelled[_text(each).lower()] for each in written}
    pairs = (pair for item in header for pair in pairwise(item.tags))
    variables = {variable.value: value for variable, value in pairs if variable.code == VARIABLE}
    blocks = {head.text(2).lower(): (head, own) for head, own in zip(heads, inner, strict=True)}
    return variables, items, layers, names, blocks


def _text(value: bytes) -> str:
    return value.strip().decode("utf-8", "replace")


def _records(
    tags: Iterable[tuple[int, int, int, bytes]], layers: set[bytes]
) -> Iterator[tuple[str, str, tuple[int, int, int], bool]]:
    """Section and kind of each entity or record, its place as of `Items`, and whether it is in
    paper space; the layers of entities are added to `layers`.
    """
    section = kind = ""
    start = first = line = 0
    paper = False
    for line, place, code, value in tags:
        if code == 0:
            if kind == "POLYLINE" and value.strip() in PARTS:
                continue
            if kind:
                yield section, kind, (start, place, first), paper
            kind, start, first, paper = _text(value), place, line - 2, False
            if kind in ("SECTION", "ENDSEC", "EOF"):
                section = ""
        elif code == LAYER and section in ("ENTITIES", "BLOCKS"):
            layers.add(value)
        elif code == PAPER:
            paper = value.strip() != b"0"
        elif code == NAME and kind == "SECTION" and not section:
            section = _text(value)
    if kind:
        yield section, kind, (start, start, first), paper


def _tags(data: bytes, name: str, progress: Progress) -> Iterator[tuple[int, int, int, bytes]]:
    """Line of the value, place, group code and value of each tag."""
    known: dict[bytes, int] = {}
    line = place = 0
    each = iter(io.BytesIO(data))
    for written, value in zip(each, each, strict=False):
        code = known.get(written)
        if code is None:
            if not CODE.fullmatch(written):
                what = f"{_text(written)[:40]!r} is not a group code: not a DXF file"
                raise FileError(f"{name}, line {line + 1}: {what}")
            code = int(written)
            if len(known) < MOST_CODES:
                known[written] = code
        if not line % REPORTED:
            if not line and (code, value.strip()) != (0, b"SECTION") and code != COMMENT:
                raise FileError(f"{name}, line 1: not a DXF file: it begins with no section")
            progress(f"{name}, {100 * place // len(data)} % read")
        line += 2
        yield line, place, code, value
        place += len(written) + len(value)
