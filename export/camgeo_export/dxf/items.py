"""The contents of a DXF file: tags, and the entities that they make up."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass

from camgeo.reading import DRAWING, check_text, lines_of
from camgeo_export.errors import FileError, finite

CODE = re.compile(r"-?[0-9]{1,4}")
"""A group code."""

LAYER = "LAYER"
"""Kind of the records of layers, which are in the tables."""


@dataclass(frozen=True, slots=True)
class Tag:
    """A group code with its value and its line number."""

    code: int
    value: str
    line: int


NOTHING = Tag(-1, "", 0)
"""In place of the tag before the first one."""


@dataclass(frozen=True, slots=True)
class Item:
    """An entity of the drawing with its first line and its vertices, if any."""

    name: str
    kind: str
    line: int
    tags: tuple[Tag, ...]
    vertices: tuple[Item, ...] = ()

    @property
    def layer(self) -> str:
        """Its layer, 0 if it names none."""
        return self.text(8, "0")

    def fault(self, message: str) -> FileError:
        """An error that names the entity and its line."""
        return FileError(f"{self.name}, line {self.line}: {self.kind} {message}")

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

    @property
    def mirrored(self) -> bool:
        """True if its own x axis points the other way (extrusion 0, 0, -1)."""
        x, y, z = (self.number(code, default) for code, default in ((210, 0), (220, 0), (230, 1)))
        if x or y or abs(z) != 1.0:
            raise self.fault("does not lie in the plane of the drawing")
        return z < 0.0


def tags_of(data: bytes, name: str) -> Iterator[Tag]:
    """All tags of the file `name`, in order."""
    if data.startswith(b"AutoCAD Binary DXF"):
        raise FileError(f"{name}: is a binary DXF; save it as text (ASCII)")
    check_text(data, DRAWING, name)
    lines = lines_of(data)
    for line, (first, second) in enumerate(zip(lines, lines, strict=False)):
        code = first.strip()
        if not CODE.fullmatch(code):
            what = f"{first[:40]!r} is not a group code: not a DXF file"
            raise FileError(f"{name}, line {2 * line + 1}: {what}")
        yield Tag(int(code), second.strip(), 2 * line + 2)


def read_items(data: bytes, name: str) -> tuple[dict[str, Tag], list[Item], list[Item]]:
    """Header variables, each with its first value, the records of layers, and the entities of the
    model space.
    """
    header: dict[str, Tag] = {}
    items: list[Item] = []
    layers: list[Item] = []
    section, first, before = "", None, NOTHING
    own: list[Tag] = []  # of the entity or record that begins with the tag `first`
    for tag in tags_of(data, name):
        if before.code == 0 and before.value == "SECTION":
            section = tag.value
        elif before.code == 9 and section == "HEADER":
            header[before.value] = tag
        before = tag
        if tag.code != 0:
            if first is not None:
                own.append(tag)
            continue
        if first is not None:
            item = Item(name, first.value, first.line, tuple(own))
            (items if section == "ENTITIES" else layers).append(item)
        ends = tag.value in ("SECTION", "ENDSEC", "EOF")
        section = "" if ends else section
        kept = not ends and (section == "ENTITIES" or tag.value == LAYER)
        first, own = tag if kept else None, []
    if (before.code, before.value) != (0, "EOF"):
        raise FileError(f"{name}: not a complete DXF file: no EOF at its end")
    model = (item for item in items if item.number(67, 0.0) == 0.0)
    return header, layers, list(_with_vertices(list(model)))


def _with_vertices(items: list[Item]) -> Iterator[Item]:
    """The entities, with VERTEX entities gathered into their POLYLINE."""
    place = 0
    while place < len(items):
        item = items[place]
        place += 1
        if item.kind == "POLYLINE":
            first = place
            while place < len(items) and items[place].kind == "VERTEX":
                place += 1
            item = Item(item.name, item.kind, item.line, item.tags, tuple(items[first:place]))
        yield item
