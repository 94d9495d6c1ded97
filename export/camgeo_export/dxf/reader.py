"""Reader of our DXF drawings: group codes, closed polylines and circles, and what closes to
contours of splines, arcs and lines. Nothing else.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from camgeo.contour.contour import Contour
from camgeo_export.chain import chain
from camgeo_export.dxf.curves import Curve, Strand, arc_of, in_order, line_of, spline_of
from camgeo_export.errors import FileError

Tag = tuple[int, str]

MM_PER_INSUNIT = {1: 25.4, 4: 1.0}
"""Millimetres of the units that $INSUNITS names."""

CLOSED = 1
"""Bit of group 70 of a closed LWPOLYLINE."""

STRANDS = ("SPLINE", "ARC", "LINE")
"""Entities that follow each other round a contour."""

JOINED = 1e-12
"""Ends that are nearer than this share of the drawing's reach are the same, written as an angle and
as a point."""


@dataclass(frozen=True, slots=True)
class Entity:
    """One entity of the drawing: its type, layer and group codes."""

    kind: str
    layer: str
    tags: tuple[Tag, ...]

    def number(self, code: int) -> float:
        """The first value of group `code`; 0 where it is absent, as DXF has it."""
        return next((float(value) for group, value in self.tags if group == code), 0.0)


@dataclass(frozen=True, slots=True)
class DxfFile:
    """A drawing.

    Attributes
    ----------
    header : the header variables, each with its first value.
    properties : the custom document properties.
    entities : of the model space, in the order of the file.
    """

    header: dict[str, str]
    properties: dict[str, str]
    entities: tuple[Entity, ...]

    @property
    def mm_per_unit(self) -> float:
        """Millimetres of one drawing unit, by $INSUNITS."""
        code = int(self.header.get("$INSUNITS", "0"))
        if code not in MM_PER_INSUNIT:
            raise FileError(f"$INSUNITS is {code}, neither mm (4) nor inch (1)")
        return MM_PER_INSUNIT[code]

    def contours(self, layer: str) -> list[Contour]:
        """The closed polylines of `layer` [mm]; raises FileError if one is open."""
        return [
            _contour(entity, self.mm_per_unit)
            for entity in self.entities
            if entity.kind == "LWPOLYLINE" and entity.layer == layer
        ]

    def curves(self, layer: str) -> list[Curve]:
        """The closed contours of `layer` [mm]: polylines, and splines with arcs and lines between.

        Raises FileError if one is open.
        """
        scale = self.mm_per_unit
        chosen = [e for e in self.entities if e.kind in STRANDS and e.layer == layer]
        strands = [_strand(entity, scale) for entity in chosen]
        reach = max((abs(strand.start) for strand in strands), default=0.0)
        return [*self.contours(layer), *in_order(strands, JOINED * reach, layer)]

    def circles(self, layer: str) -> list[tuple[complex, float]]:
        """Centres and radii [mm] of the circles of `layer`."""
        scale = self.mm_per_unit
        return [
            (complex(entity.number(10), entity.number(20)) * scale, entity.number(40) * scale)
            for entity in self.entities
            if entity.kind == "CIRCLE" and entity.layer == layer
        ]


def read(data: bytes) -> DxfFile:
    """Read a DXF file; raises FileError if it is none, or is cut short."""
    tags = _tags(data)
    if not tags or tags[-1] != (0, "EOF"):
        raise FileError("not a whole DXF file: no EOF at its end")
    sections: dict[str, list[Tag]] = {}
    name = ""
    for index, (code, value) in enumerate(tags):
        if (code, value) == (0, "SECTION"):
            name = tags[index + 1][1]
            sections[name] = []
        elif name:
            sections[name].append((code, value))
    header, properties = _header(sections.get("HEADER", []))
    return DxfFile(header, properties, _entities(sections.get("ENTITIES", [])))


def _tags(data: bytes) -> list[Tag]:
    lines = data.decode("cp1252", errors="replace").split("\n")
    try:
        return [
            (int(code), value.strip())
            for code, value in zip(lines[0::2], lines[1::2], strict=False)
        ]
    except ValueError as error:
        raise FileError(f"not a DXF file: {error}") from None


def _header(tags: list[Tag]) -> tuple[dict[str, str], dict[str, str]]:
    header: dict[str, str] = {}
    properties: dict[str, str] = {}
    label = ""
    for (code, value), (_, content) in pairwise(tags):
        if code != 9:
            continue
        if value == "$CUSTOMPROPERTYTAG":
            label = content
        elif value == "$CUSTOMPROPERTY":
            properties[label] = content
        else:
            header[value] = content
    return header, properties


def _entities(tags: list[Tag]) -> tuple[Entity, ...]:
    starts = [index for index, (code, _) in enumerate(tags) if code == 0]
    entities = []
    for start, end in pairwise(starts):
        body = tuple(tags[start + 1 : end])
        layer = next((value for code, value in body if code == 8), "0")
        entities.append(Entity(tags[start][1], layer, body))
    return tuple(entities)


def _strand(entity: Entity, scale: float) -> Strand:
    if not all(math.isfinite(float(value)) for code, value in entity.tags if 10 <= code < 60):
        raise FileError(f"{entity.kind} with a value that is not finite on layer {entity.layer}")
    if entity.kind == "SPLINE":
        numbers = [(code, float(value)) for code, value in entity.tags if 10 <= code < 80]
        try:
            return spline_of(numbers, scale)
        except FileError as error:
            raise FileError(f"SPLINE on layer {entity.layer} {error}") from None
    first = complex(entity.number(10), entity.number(20)) * scale
    if entity.kind == "LINE":
        return line_of(first, complex(entity.number(11), entity.number(21)) * scale)
    return arc_of(first, entity.number(40) * scale, entity.number(50), entity.number(51))


def _contour(entity: Entity, scale: float) -> Contour:
    if not int(entity.number(70)) & CLOSED:
        raise FileError(f"open polyline on layer {entity.layer}")
    rows: list[list[float]] = []
    for code, value in entity.tags:
        if code == 10:
            rows.append([float(value), 0.0, 0.0])
        elif code in (20, 42) and rows:
            rows[-1][1 if code == 20 else 2] = float(value)
    if len(rows) != int(entity.number(90)) or len(rows) < 2:
        raise FileError(f"polyline with {len(rows)} vertices on layer {entity.layer}")
    x, y, bulge = np.array(rows).T
    if not all(math.isfinite(value) for row in rows for value in row):
        raise FileError(f"polyline with a value that is not finite on layer {entity.layer}")
    vertices = (x + 1j * y) * scale
    return chain(vertices, 4.0 * np.arctan(bulge))
