"""Reader of closed contours from any DXF drawing, whichever program wrote it.

It reads lines, arcs, circles, polylines with bulges and, for callers that accept curves, polynomial
splines of degree 1 to 3; open pieces are chained at their end points. What has no exact form in
these is refused rather than approximated.
"""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from camgeo.contour.contour import Contour
from camgeo.contour.spline import Arc, CubicSpline
from camgeo.reading import CONTOURS, DRAWING, beyond
from camgeo.units import MM_PER, LengthUnit
from camgeo.wording import counted
from camgeo_export.dxf.curves import Curve, Strand, arc_of, closed, spline_of
from camgeo_export.dxf.items import Item, Tag, read_items
from camgeo_export.errors import FileError, finite
from camgeo_export.layers import CUT, of_the_part

MM_PER_INSUNIT = {1: 25.4, 2: 304.8, 4: 1.0, 5: 10.0, 6: 1000.0}
"""Millimetres of the units that $INSUNITS names: inch, foot, mm, cm, m."""

LINES_AND_ARCS = ("LINE", "ARC", "CIRCLE", "LWPOLYLINE", "POLYLINE")
CURVES = (*LINES_AND_ARCS, "SPLINE")

REFUSED = ("SPLINE", "ELLIPSE", "INSERT", "HELIX", "MLINE", "REGION", "3DFACE", "SOLID", "HATCH")
"""Entities that may be part of an outline but are neither lines nor arcs."""

CLOSED = 1
"""Bit of group 70 that marks a polyline as closed."""

NOT_FLAT = 2 | 4 | 8 | 16 | 64
"""Bits of group 70 of a POLYLINE that is curve-fitted, a polygon mesh or three-dimensional."""


JOINED = 1e-12
"""Ends closer than this fraction of the drawing's reach are the same, written once as an angle and
once as a point."""


@dataclass(frozen=True, slots=True)
class Run:
    """Pieces of the drawing joined end to end; `item` is the entity of the first."""

    item: Item
    pieces: Sequence[Strand]

    @property
    def closed(self) -> bool:
        """True if its last piece leads back to where the first begins."""
        return self.pieces[-1].end == self.pieces[0].start

    def reversed(self) -> Run:
        """The same in the opposite direction."""
        return Run(self.item, [piece.reversed() for piece in self.pieces[::-1]])


@dataclass(frozen=True, slots=True)
class Drawing:
    """A drawing that was read.

    Attributes
    ----------
    name : of the file, for messages.
    header : the header variables, each with its first value.
    items : the entities of the model space, in the order of the file.
    layers : the records of the layers.
    """

    name: str
    header: dict[str, Tag]
    items: tuple[Item, ...]
    layers: tuple[Item, ...]

    def value(self, variable: str) -> str:
        """The value of a header variable; empty if there is none."""
        return self.header[variable].value if variable in self.header else ""

    def scale(self, unit: LengthUnit | None = None) -> float:
        """Millimetres per drawing unit; `unit` is needed if the drawing does not state it.

        Raises FileError if it is unknown, or contradicts the drawing.
        """
        name, tag = self.name, self.header.get("$INSUNITS")
        code = 0 if tag is None else int(finite(tag.value, name, tag.line))
        if code == 0:
            if unit is None:
                message = "does not state its unit ($INSUNITS); give mm or inch (--unit)"
                raise FileError(f"{name}: {message}")
            return MM_PER[unit]
        if code not in MM_PER_INSUNIT:
            raise FileError(f"{name}: $INSUNITS is {code}; supported: inch, foot, mm, cm and m")
        if unit is not None and MM_PER[unit] != MM_PER_INSUNIT[code]:
            raise FileError(f"{name}: $INSUNITS is {code}, which is not {unit}")
        return MM_PER_INSUNIT[code]

    def contours(
        self,
        layer: str | None,
        unit: LengthUnit | None = None,
        gap: float | None = None,
        kinds: tuple[str, ...] = CURVES,
    ) -> tuple[Curve, ...]:
        """The closed contours [mm], counter-clockwise, the largest first; see `joined`."""
        return self.joined(layer, unit, None if gap is None else (gap,), kinds)[0]

    def joined(
        self,
        layer: str | None,
        unit: LengthUnit | None = None,
        gaps: Sequence[float] | None = None,
        kinds: tuple[str, ...] = CURVES,
    ) -> tuple[tuple[Curve, ...], float]:
        """The closed contours [mm], counter-clockwise, the largest first, and the largest gap
        [mm] that was joined.

        A contour without splines consists of lines and arcs. Where two ends lie apart, one is moved
        to the other: that of an arc or line to that of a spline.

        Parameters
        ----------
        layer : whose entities are read; None for layer CUT and those of edges that do not go
            through, if CUT exists, else for all.
        unit : of the drawing, needed if the drawing does not state it.
        gaps : end points up to this far apart [mm] are joined, by the first of these that joins
            all pieces to closed contours; None for rounding only.
        kinds : of entities that are read.

        Raises
        ------
        FileError
            With name and line, if the unit is unknown, an entity is of another kind, or pieces do
            not form closed contours.
        """
        scale = self.scale(unit)
        runs = [run for item in self.on(layer, kinds) if (run := _run(item, scale)).pieces]
        if gaps is None:
            gaps = (JOINED * max((abs(run.pieces[0].start) for run in runs), default=0.0),)
        chains, largest = _first_chained([run for run in runs if not run.closed], gaps)
        found = [*(run for run in runs if run.closed), *chains]
        if not found:
            raise FileError(f"{self.name}: no contour found; supported: {', '.join(kinds)}")
        if len(found) > CONTOURS:
            raise beyond(self.name, counted(len(found), "closed contour"), CONTOURS, DRAWING)
        return tuple(sorted(map(_contour, found), key=lambda contour: -contour.area)), largest

    def on(self, layer: str | None, kinds: tuple[str, ...] = CURVES) -> list[Item]:
        """The entities of those `kinds` on a layer; see `joined`."""
        layers = {item.layer for item in self.items}
        if layer is not None and layer not in layers:
            known = ", ".join(sorted(layers))
            raise FileError(f"{self.name}: has no layer {layer!r}; there are {known}")
        ours = of_the_part(layers) if CUT in layers else layers
        wanted = ours if layer is None else {layer}
        chosen = [item for item in self.items if item.layer in wanted]
        for item in chosen:
            if item.kind in REFUSED and item.kind not in kinds:
                raise item.fault(f"is not a line or arc; supported: {', '.join(kinds)}")
        return [item for item in chosen if item.kind in kinds]


def drawing_of(data: bytes, name: str = "the drawing") -> Drawing:
    """The drawing in the file `name`; FileError if it is not DXF, or truncated."""
    header, layers, items = read_items(data, name)
    return Drawing(name, header, tuple(items), tuple(layers))


class DxfReader:
    """Reads closed contours of lines and arcs from a DXF drawing."""

    def read(
        self, data: bytes, name: str, *, layer: str | None, unit: LengthUnit | None, gap: float
    ) -> tuple[Contour, ...]:
        """See `Drawing.contours`."""
        found = drawing_of(data, name).contours(layer, unit, gap, LINES_AND_ARCS)
        return tuple(contour for contour in found if isinstance(contour, Contour))  # all of them


def _run(item: Item, scale: float) -> Run:
    """The pieces of an entity [mm], possibly none."""
    if item.kind == "LINE":
        start, end = (complex(item.number(x), item.number(x + 10)) * scale for x in (10, 11))
        return Run(item, [Arc(start, end, 0.0, 0j)] if start != end else [])
    if item.kind == "SPLINE":
        return Run(item, [_spline(item, scale)])
    pieces = _arcs(item, scale) if item.kind in ("ARC", "CIRCLE") else _polyline(item, scale)
    if item.mirrored:
        pieces = [_mirrored(arc) for arc in pieces]
    return Run(item, pieces)


def _mirrored(arc: Arc) -> Arc:
    start, end, centre = (-each.conjugate() for each in (arc.start, arc.end, arc.centre))
    return Arc(start, end, -arc.sweep, centre)


def _arcs(item: Item, scale: float) -> list[Arc]:
    """An ARC or CIRCLE; a whole circle in two halves."""
    centre = complex(item.number(10), item.number(20)) * scale
    radius = item.number(40) * scale
    if radius <= 0.0:
        raise item.fault("has no radius above 0")
    if item.kind == "ARC":
        arc = arc_of(centre, radius, item.number(50), item.number(51))
        if arc.sweep < 2.0 * math.pi:
            return [arc]
    ends = (centre + radius, centre - radius)
    return [Arc(start, end, math.pi, centre) for start, end in (ends, ends[::-1])]


def _spline(item: Item, scale: float) -> CubicSpline:
    numbers = [(tag.code, item.value(tag)) for tag in item.tags if 10 <= tag.code < 80]
    try:
        return spline_of(numbers, scale)
    except FileError as error:
        raise item.fault(str(error)) from None


def _polyline(item: Item, scale: float) -> list[Arc]:
    """Its pieces, without those of zero length."""
    flags = int(item.number(70, 0.0))
    rows: list[list[float]] = []
    if item.kind == "POLYLINE":
        if flags & NOT_FLAT:
            raise item.fault("is curve-fitted or not flat; explode it into lines and arcs")
        for vertex in item.vertices:
            rows.append([vertex.number(10), vertex.number(20), vertex.number(42, 0.0)])
    else:
        for tag in item.tags:
            if tag.code == 10:
                rows.append([item.value(tag), 0.0, 0.0])
            elif tag.code in (20, 42) and rows:
                rows[-1][1 if tag.code == 20 else 2] = item.value(tag)
        if len(rows) != item.number(90, len(rows)):
            found = counted(len(rows), "vertex", "vertices")
            raise item.fault(f"has {found}, not as many as it states")
    points = [complex(x, y) * scale for x, y, _ in rows]
    sweeps = (4.0 * np.arctan([bulge for _, _, bulge in rows])).tolist()
    following = [*points[1:], *points[:1]] if flags & CLOSED else points[1:]
    pieces = zip(points, following, sweeps, strict=False)
    return [Arc(start, end, sweep, 0j) for start, end, sweep in pieces if start != end]


def _first_chained(runs: list[Run], gaps: Sequence[float]) -> tuple[list[Run], float]:
    """As `_chained`, with the first of `gaps` [mm] that makes all runs closed ones."""
    for gap in gaps[:-1]:
        try:
            return _chained(runs, gap)
        except FileError:
            continue
    return _chained(runs, gaps[-1])


def _chained(runs: list[Run], gap: float) -> tuple[list[Run], float]:
    """Open runs joined at their ends into closed ones, and the largest gap between two [mm]."""
    partner, largest = _partners(runs, gap)
    left = set(range(len(runs)))
    found = []
    while left:
        start = min(left)
        pieces: list[Strand] = []
        end = 2 * start  # where the next run starts
        while end // 2 in left:
            left.remove(end // 2)
            run = runs[end // 2]
            pieces += run.pieces if end % 2 == 0 else run.reversed().pieces
            end = partner[end ^ 1]
        found.append(Run(runs[start].item, pieces))
    return found, largest


def _partners(runs: list[Run], gap: float) -> tuple[list[int], float]:
    """For each end, 2 k and 2 k + 1 of run k, the other end at the same place, and the largest
    distance between two such ends [mm].
    """
    ends = [end for run in runs for end in (run.pieces[0].start, run.pieces[-1].end)]
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
            what = "has a loose end" if not near else "meets more than one other piece"
            raise runs[number // 2].item.fault(
                f"{what} at ({point.real:.6g}, {point.imag:.6g}) mm; pieces must form closed"
                f" contours, with gaps of at most {gap:g} mm"
            )
        partner.append(near[0])
    apart = (abs(ends[one] - ends[other]) for one, other in enumerate(partner))
    return partner, max(apart, default=0.0)


def _contour(run: Run) -> Curve:
    if len(run.pieces) < 2 and isinstance(run.pieces[0], Arc):
        raise run.item.fault("encloses nothing")
    contour = closed(run.pieces)
    if contour.area == 0.0:
        raise run.item.fault("encloses no area")
    return contour.counter_clockwise()


READER = DxfReader()
