"""The contents of a DXF file: tags, and the entities that they make up."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from camgeo_export.errors import FileError, finite

LAYER = "LAYER"
"""Kind of the records of layers, which are in the tables."""


@dataclass(frozen=True, slots=True)
class Tag:
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
    lines = data.decode("utf-8", errors="replace").splitlines()
    for index in range(0, len(lines) - 1, 2):
        try:
            code = int(lines[index])
        except ValueError:
            raise FileError(
                f"{name}, line {index + 1}: {lines[index][:40]!r} is no group code; not a DXF file"
            ) from None
        yield Tag(code, lines[index + 1].strip(), index + 2)


def read_items(data: bytes, name: str) -> tuple[dict[str, Tag], list[Item], list[Item]]:
    """Header variables, each with its first value, the records of layers, and the entities of the
    model space.
    """
    tags = list(tags_of(data, name))
    if not tags or (tags[-1].code, tags[-1].value) != (0, "EOF"):
        raise FileError(f"{name}: not a complete DXF file: no EOF at its end")
    header: dict[str, Tag] = {}
    items: list[Item] = []
    layers: list[Item] = []
    section = ""
    for index, tag in enumerate(tags):
        if tag.code == 0 and tag.value in ("SECTION", "ENDSEC", "EOF"):
            section = tags[index + 1].value if tag.value == "SECTION" else ""
        elif section == "HEADER" and tag.code == 9:
            header[tag.value] = tags[index + 1]
        elif tag.code == 0 and (section == "ENTITIES" or tag.value == LAYER):
            end = index + 1
            while tags[end].code != 0:
                end += 1
            item = Item(name, tag.value, tag.line, tuple(tags[index + 1 : end]))
            (items if section == "ENTITIES" else layers).append(item)
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
