"""Reader of closed contours from any DXF drawing, by whatever program it was written.

Lines, arcs, circles, polylines with bulges and, for those who take curves, polynomial splines of
degree 1 to 3 count; pieces that lie open are chained at their end points. What has no exact form in
these is refused rather than approximated.
"""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from camgeo.contour.contour import Contour
from camgeo.contour.spline import Arc, CubicSpline
from camgeo.units import MM_PER, LengthUnit
from camgeo_export.chain import chain
from camgeo_export.dxf.curves import Curve, closed, spline_of
from camgeo_export.dxf.items import Item, Tag, number_of, read_items
from camgeo_export.errors import FileError

MM_PER_INSUNIT = {1: 25.4, 2: 304.8, 4: 1.0, 5: 10.0, 6: 1000.0}
"""Millimetres of the units that $INSUNITS names: inch, foot, mm, cm, m."""

CUT = "CUT"
"""Layer that is taken if no other is asked for and it is there."""

READ = ("LINE", "ARC", "CIRCLE", "LWPOLYLINE", "POLYLINE")

REFUSED = ("SPLINE", "ELLIPSE", "INSERT", "HELIX", "MLINE", "REGION", "3DFACE", "SOLID", "HATCH")
"""Entities that may be part of an outline but are no lines and arcs."""

CLOSED = 1
"""Bit of group 70 of a closed polyline."""

NOT_FLAT = 2 | 4 | 8 | 16 | 64
"""Bits of group 70 of a POLYLINE that is fitted by a curve, or is a polygon mesh or in space."""


@dataclass(frozen=True, slots=True)
class Strand:
    """Pieces from end to end: vertices, one more than sweeps [rad] if it is open.

    `splines` has the curve of each piece that is one; it then has no sweep.
    """

    item: Item
    vertices: list[complex]
    sweeps: list[float]
    splines: list[CubicSpline | None]

    @classmethod
    def of(cls, item: Item, vertices: list[complex], sweeps: list[float]) -> Strand:
        """Of lines and arcs."""
        return cls(item, vertices, sweeps, [None] * len(sweeps))

    @property
    def closed(self) -> bool:
        """True if its last piece leads back to its first vertex."""
        return len(self.vertices) == len(self.sweeps)

    def reversed(self) -> Strand:
        """The same, run the other way."""
        splines = [None if each is None else each.reversed() for each in self.splines[::-1]]
        sweeps = [-sweep for sweep in self.sweeps[::-1]]
        return Strand(self.item, self.vertices[::-1], sweeps, splines)


class ForeignDxfReader:
    """Reads closed contours from a DXF drawing."""

    suffixes = (".dxf",)

    def read(
        self, data: bytes, name: str, *, layer: str | None, unit: LengthUnit | None, gap: float
    ) -> tuple[Contour, ...]:
        """The closed contours [mm], counter-clockwise, the largest first.

        Parameters
        ----------
        data, name : the file and its name for messages.
        layer : whose entities are read; None for layer CUT if there is one, else for all.
        unit : of the drawing, needed if the drawing does not say it.
        gap : end points up to this far apart [mm] are joined.

        Raises
        ------
        FileError
            With name and line, if the file is no DXF, its unit is unknown, an entity is no line or
            arc, or pieces do not close to contours.
        """
        contours = [_contour(strand) for strand in _closed(data, name, layer, unit, gap, READ)]
        return tuple(sorted(contours, key=lambda contour: -contour.area))

    def read_curves(
        self, data: bytes, name: str, *, layer: str | None, unit: LengthUnit | None, gap: float
    ) -> tuple[Curve, ...]:
        """As `read`, but SPLINE entities of degree 1 to 3 are read too.

        A contour with splines becomes a `SplineContour`. Where two ends lie apart, by `gap` at
        most, one is moved to the other: that of an arc or line to that of a spline.
        """
        strands = _closed(data, name, layer, unit, gap, (*READ, "SPLINE"))
        contours = [_curve(strand) for strand in strands]
        return tuple(sorted(contours, key=lambda contour: -contour.area))


def _closed(
    data: bytes,
    name: str,
    layer: str | None,
    unit: LengthUnit | None,
    gap: float,
    kinds: tuple[str, ...],
) -> list[Strand]:
    """The closed strands of the entities of `kinds`."""
    header, items = read_items(data, name)
    scale = _scale(header, unit, name)
    chosen = _on_layer(items, layer, name, kinds)
    strands = [strand for item in chosen for strand in _strands(item, scale)]
    found = [strand for strand in strands if strand.closed]
    found += _chained([strand for strand in strands if not strand.closed], gap)
    if not found:
        raise FileError(f"{name}: no contour found; read are {', '.join(kinds)}")
    return found


def _scale(header: dict[str, Tag], unit: LengthUnit | None, name: str) -> float:
    """Millimetres of a drawing unit."""
    tag = header.get("$INSUNITS")
    code = 0 if tag is None else int(number_of(tag, name))
    if code == 0:
        if unit is None:
            raise FileError(f"{name}: does not say its unit ($INSUNITS); say mm or inch (--unit)")
        return MM_PER[unit]
    if code not in MM_PER_INSUNIT:
        raise FileError(f"{name}: $INSUNITS is {code}; read are inch, foot, mm, cm and m")
    if unit is not None and MM_PER[unit] != MM_PER_INSUNIT[code]:
        raise FileError(f"{name}: $INSUNITS is {code}, which is not {unit}")
    return MM_PER_INSUNIT[code]


def _on_layer(
    items: list[Item], layer: str | None, name: str, kinds: tuple[str, ...]
) -> list[Item]:
    layers = sorted({item.layer for item in items})
    if layer is not None and layer not in layers:
        raise FileError(f"{name}: has no layer {layer!r}; there are {', '.join(layers)}")
    wanted = layer if layer is not None else CUT if CUT in layers else None
    chosen = [item for item in items if wanted is None or item.layer == wanted]
    for item in chosen:
        if item.kind in REFUSED and item.kind not in kinds:
            raise item.fault(f"is no line or arc; read are {', '.join(kinds)}")
    return [item for item in chosen if item.kind in kinds]


def _strands(item: Item, scale: float) -> Iterator[Strand]:
    """The pieces of an entity [mm]."""
    if item.kind == "LINE":
        start, end = (complex(item.number(x), item.number(x + 10)) * scale for x in (10, 11))
        if start != end:
            yield Strand.of(item, [start, end], [0.0])
        return
    if item.kind == "SPLINE":
        yield _spline(item, scale)
        return
    strand = _arc(item, scale) if item.kind in ("ARC", "CIRCLE") else _polyline(item, scale)
    if item.mirrored:
        vertices = [-vertex.conjugate() for vertex in strand.vertices]
        strand = Strand.of(item, vertices, [-sweep for sweep in strand.sweeps])
    if strand.sweeps:
        yield strand


def _arc(item: Item, scale: float) -> Strand:
    centre = complex(item.number(10), item.number(20)) * scale
    radius = item.number(40) * scale
    if radius <= 0.0:
        raise item.fault("has no radius above 0")
    if item.kind == "CIRCLE":
        return Strand.of(item, [centre + radius, centre - radius], [math.pi, math.pi])
    first, last = math.radians(item.number(50)), math.radians(item.number(51))
    sweep = (last - first) % (2.0 * math.pi) or 2.0 * math.pi
    if sweep == 2.0 * math.pi:
        return Strand.of(item, [centre + radius, centre - radius], [math.pi, math.pi])
    ends = [centre + radius * complex(math.cos(a), math.sin(a)) for a in (first, first + sweep)]
    return Strand.of(item, ends, [sweep])


def _spline(item: Item, scale: float) -> Strand:
    numbers = [(tag.code, number_of(tag, item.name)) for tag in item.tags if 10 <= tag.code < 80]
    try:
        spline = spline_of(numbers, scale)
    except FileError as error:
        raise item.fault(str(error)) from None
    return Strand(item, [spline.start, spline.end], [0.0], [spline])


def _polyline(item: Item, scale: float) -> Strand:
    flags = int(item.number(70, 0.0))
    rows: list[list[float]] = []
    if item.kind == "POLYLINE":
        if flags & NOT_FLAT:
            raise item.fault("is fitted by a curve or not flat; explode it into lines and arcs")
        for vertex in item.vertices:
            rows.append([vertex.number(10), vertex.number(20), vertex.number(42, 0.0)])
    else:
        for tag in item.tags:
            if tag.code == 10:
                rows.append([number_of(tag, item.name), 0.0, 0.0])
            elif tag.code in (20, 42) and rows:
                rows[-1][1 if tag.code == 20 else 2] = number_of(tag, item.name)
    points = [complex(x, y) * scale for x, y, _ in rows]
    sweeps = [4.0 * math.atan(bulge) for _, _, bulge in rows]
    if not flags & CLOSED:
        points, sweeps = _without_repeats(points, sweeps[:-1])
        if len(points) > 2 and points[0] == points[-1]:
            points = points[:-1]
    else:
        points, sweeps = _without_repeats([*points, *points[:1]], sweeps)
        points = points[:-1]
    return Strand.of(item, points, sweeps)


def _without_repeats(
    points: list[complex], sweeps: list[float]
) -> tuple[list[complex], list[float]]:
    """Without pieces of no length."""
    kept = [k for k in range(len(sweeps)) if points[k] != points[k + 1]]
    return [*points[:1], *(points[k + 1] for k in kept)], [sweeps[k] for k in kept]


def _chained(strands: list[Strand], gap: float) -> list[Strand]:
    """Open strands joined at their ends to closed ones."""
    ends = [complex(strand.vertices[side]) for strand in strands for side in (0, -1)]
    partner = _partners(strands, ends, gap)
    left = set(range(len(strands)))
    found = []
    while left:
        start = min(left)
        vertices: list[complex] = []
        sweeps: list[float] = []
        splines: list[CubicSpline | None] = []
        end = 2 * start  # where the next strand is entered
        while end // 2 in left:
            left.remove(end // 2)
            strand = strands[end // 2]
            run = strand if end % 2 == 0 else strand.reversed()
            vertices += run.vertices[:-1]
            sweeps += run.sweeps
            splines += run.splines
            end = partner[end ^ 1]
        found.append(Strand(strands[start].item, vertices, sweeps, splines))
    return found


def _partners(strands: list[Strand], ends: list[complex], gap: float) -> list[int]:
    """The other end at the same place of each end, 2 k and 2 k + 1 of strand k."""
    cells: dict[tuple[int, int], list[int]] = defaultdict(list)
    size = 2.0 * gap if gap > 0.0 else 1.0
    for number, point in enumerate(ends):
        cells[math.floor(point.real / size), math.floor(point.imag / size)].append(number)
    partner = []
    for number, point in enumerate(ends):
        x, y = math.floor(point.real / size), math.floor(point.imag / size)
        near = [
            other
            for i in (-1, 0, 1)
            for j in (-1, 0, 1)
            for other in cells.get((x + i, y + j), ())
            if other != number and abs(ends[other] - point) <= gap
        ]
        if len(near) != 1:
            what = "ends free" if not near else "meets more than one other piece"
            raise strands[number // 2].item.fault(
                f"{what} at ({point.real:.6g}, {point.imag:.6g}) mm; pieces must close to contours,"
                f" with gaps of at most {gap:g} mm"
            )
        partner.append(near[0])
    return partner


def _contour(strand: Strand) -> Contour:
    if len(strand.sweeps) < 2:
        raise strand.item.fault("encloses nothing")
    contour = chain(np.array(strand.vertices), np.array(strand.sweeps))
    if contour.area == 0.0:
        raise strand.item.fault("encloses no area")
    return contour.counter_clockwise()


def _curve(strand: Strand) -> Curve:
    if all(spline is None for spline in strand.splines):
        return _contour(strand)
    ends = [*strand.vertices[1:], strand.vertices[0]]
    pieces = zip(strand.vertices, ends, strand.sweeps, strand.splines, strict=True)
    curve = closed(
        [
            Arc(start, end, sweep, 0j).between(start, end) if spline is None else spline
            for start, end, sweep, spline in pieces
        ]
    )
    if curve.area == 0.0:
        raise strand.item.fault("encloses no area")
    return curve.counter_clockwise()


READER = ForeignDxfReader()
