"""Reader of closed contours from any DXF drawing, whichever program wrote it.

It reads what a drawing shows: lines, arcs, circles, ellipses, polylines with bulges and splines, in
blocks too, on layers that are on; open pieces are chained at their end points. Pieces that close
nothing are left out and reported.
"""

from __future__ import annotations

import cmath
import codecs
import io
import math
import re
from array import array
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import count, pairwise
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from camgeo.errors import FileError, GeometryError
from camgeo.geometry.contour.contour import Contour
from camgeo.geometry.contour.foreign import Outlines, contour_centre
from camgeo.geometry.contour.spline import CUBIC, Arc, CubicSpline, SplineContour, bezier_points
from camgeo.numeric.arrays import BoolArray, ComplexArray, FloatArray, IntArray
from camgeo.reading import CONTOURS, COORDINATE, DRAWING, beyond, check_text, parse_number
from camgeo.units import MM_PER, TURN, LengthUnit, counted, place_text
from camgeo_export.reading import CUT, AnyContour, part_layers

# -- entities -------------------------------------------------------------------------------------
# The contents of a DXF file: tags, and the entities that they make up.
#
# The file is gone through once, and of each entity only its place is kept: its tags, which take
# many times the memory of their text, are made anew whenever it is asked for.


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
"""Most spellings of group codes that are remembered."""

PIECES: Final = (b"VERTEX", b"SEQEND")
"""Entities that belong to the POLYLINE before them."""

REPORTED: Final = 1_000_000
"""Lines after which progress is reported again."""

Progress = Callable[[str], object]


class EntityError(FileError):
    """The error for an entity that cannot be used, whatever the rest of the drawing is."""


def finite(text: str, name: str, line: int) -> float:
    """The number `text` in a line of the file `name`.

    Raises FileError if it is none, not finite, or beyond the limits of `camgeo.reading`.
    """
    number = parse_number(text)
    if number is None:
        what = f"is not a finite number of at most {COORDINATE:g}"
        raise FileError(f"{name}, line {line}: {text[:40]!r} {what}")
    return number


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
    def from_tags(cls, name: str, tags: list[Tag]) -> Item:
        """The entity of its tags, from the one that names its kind to the last of its vertices."""
        firsts = [*(place for place, tag in enumerate(tags) if tag.code == 0), len(tags)]
        entity, *parts = (
            cls(name, tags[low].value, tags[low].line, tuple(tags[low + 1 : high]))
            for low, high in pairwise(firsts)
        )
        vertices = tuple(part for part in parts if part.kind == "VERTEX")
        return cls(name, entity.kind, entity.line, entity.tags, vertices)

    @property
    def layer(self) -> str:
        """The layer of the entity, "0" if it names none."""
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
        # Three numbers at a time, from a single iterator.
        numbers = iter(self.places)
        for start, end, line in zip(numbers, numbers, numbers, strict=True):
            lines = self.data[start : end - 1].decode("utf-8", "replace").split("\n")
            codes, values = map(int, lines[0::2]), map(str.strip, lines[1::2])
            yield Item.from_tags(self.name, list(map(Tag, codes, values, count(line + 2, 2))))


Contents = tuple[dict[str, Tag], Items, Items, dict[str, str], dict[str, tuple[Item, Items]]]
"""Header variables, each with its value; entities of the model space; records of the layers; names
of the layers that entities are on, by their lower case; record and entities of the blocks, too."""


def read_contents(data: bytes, name: str, progress: Progress = lambda _: None) -> Contents:
    """The contents of the file `name`; `progress` is called from time to time with a sentence.

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
        targets = {"HEADER": header, "ENTITIES": None if paper else items, "BLOCKS": block}
        target = targets.get(section, layers if kind == "LAYER" else None)
        if target is not None and (kind != "SECTION" or target is header):
            target.places.extend(place)
    if kind != "EOF":
        raise FileError(f"{name}: not a complete DXF file: no EOF at its end")
    spelled = {_text(layer).lower(): _text(layer) for layer in sorted(written)}
    # The record of a layer decides how its name is spelled.
    spelled |= {record.text(2).lower(): record.text(2) for record in layers}
    names = {_text(layer).lower(): spelled[_text(layer).lower()] for layer in written}
    pairs = (pair for item in header for pair in pairwise(item.tags))
    variables = {variable.value: value for variable, value in pairs if variable.code == VARIABLE}
    blocks = {
        head.text(2).lower(): (head, entities) for head, entities in zip(heads, inner, strict=True)
    }
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
            if kind == "POLYLINE" and value.strip() in PIECES:
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
    # A code and a value at a time, from a single iterator.
    lines = iter(io.BytesIO(data))
    for written, value in zip(lines, lines, strict=False):
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


# -- curves ---------------------------------------------------------------------------------------
# The curves that DXF entities draw: lines, arcs and cubics, placed in the plane of the drawing.
#
# What is exactly one of these stays it, wherever blocks are inserted. An ellipse, and an arc in a
# block that is stretched, is followed by the images of cubics close to a circle; splines that are
# rational or of a higher degree by cubics with their points and tangents.


Strand = CubicSpline | Arc

CURVES: Final = ("LINE", "ARC", "CIRCLE", "LWPOLYLINE", "POLYLINE", "SPLINE", "ELLIPSE")

DEGREES: Final = tuple(map(float, range(1, 11)))

RATIONAL: Final = 1e-12
"""Weights that differ by a larger fraction make a spline rational."""

NEAR: Final = 1e-7
"""Distance [mm] within which cubics approximate other curves."""

LOOKS: Final = np.array([0.25, 0.5, 0.75])
"""Parameters at which a cubic is compared with the spline that it follows."""

END_SHARE: Final = 1e-9
"""Share of a span before its end at which its last derivative is taken: at the end itself the next
span begins."""

MOST_FIT: Final = 1_000
"""Most points through which a spline is fitted: memory grows with their square."""

MOST_SPANS: Final = 20_000
"""Most cubics along one curve."""

TILTED: Final = 1e-9
"""Largest part along x or y of an extrusion that still points along z."""

CLOSED: Final = 1
"""Bit of group 70 that marks a polyline as closed."""

MESH: Final = 16 | 64
"""Bits of group 70 of a POLYLINE that is a mesh."""

FRAME: Final = 16
"""Bit of group 70 of a VERTEX that is not on the curve but a control point of its splines."""


@dataclass(frozen=True, slots=True)
class Placement:
    """An affine map of the plane, z -> turn z + mirror conj(z) + shift.

    Attributes
    ----------
    turn, mirror : parts that keep and that reverse orientation; with one of them 0 circles stay
        circles.
    shift : where 0 goes.
    """

    turn: complex = 1.0 + 0.0j
    mirror: complex = 0.0j
    shift: complex = 0.0j

    def point(self, z: complex) -> complex:
        """Where z goes."""
        return self.turn * z + self.mirror * z.conjugate() + self.shift

    def compose(self, inner: Placement) -> Placement:
        """The map that applies the `inner` one first, then this one."""
        turn = self.turn * inner.turn + self.mirror * inner.mirror.conjugate()
        mirror = self.turn * inner.mirror + self.mirror * inner.turn.conjugate()
        return Placement(turn, mirror, self.point(inner.shift))

    @property
    def sense(self) -> float:
        """1 if circles stay circles, -1 if they are also reversed, 0 if they become ellipses."""
        sizes = abs(self.turn), abs(self.mirror)
        if min(sizes) > RATIONAL * max(sizes):
            return 0.0
        return 1.0 if sizes[0] > sizes[1] else -1.0

    def strand(self, strand: Strand) -> Strand:
        """Where a strand goes."""
        if isinstance(strand, CubicSpline):
            z = strand.controls
            return CubicSpline(strand.knots, self.turn * z + self.mirror * z.conj() + self.shift)
        ends = self.point(strand.start), self.point(strand.end)
        if not strand.sweep:
            return Arc(*ends, 0.0, 0j)
        if self.sense:
            return Arc(*ends, self.sense * strand.sweep, self.point(strand.centre))
        return _followed(lambda t: self._jet(strand, t), (0.0, 0.5, 1.0), NEAR)

    def _jet(self, arc: Arc, share: float) -> tuple[complex, complex]:
        """Point and derivative of an arc by its `share`, where they go."""
        arm = (arc.start - arc.centre) * cmath.rect(1.0, arc.sweep * share)
        way = 1j * arc.sweep * arm
        return self.point(arc.centre + arm), self.turn * way + self.mirror * way.conjugate()

    def oriented(self, item: Item) -> Placement:
        """The placement for an entity in axes of its own, of which x points the other way if its
        extrusion is (0, 0, -1); EntityError if they are tilted.
        """
        x, y, z = (item.number(code, default) for code, default in ((210, 0), (220, 0), (230, 1)))
        if max(abs(x), abs(y), abs(abs(z) - 1.0)) > TILTED:
            raise item.fault("does not lie in the plane of the drawing")
        return self if z > 0.0 else self.compose(Placement(0.0j, -1.0 + 0.0j))


def entity_strands(item: Item, place: Placement) -> tuple[list[Strand], bool]:
    """The pieces of an entity [mm], possibly none, and whether they are its curve; if not, cubics
    follow that within `NEAR`, or as CAD programs draw it through points.

    `place` maps the axes of the drawing to mm.

    Raises FileError with the line if the entity is not flat or not whole.
    """
    if item.kind == "LINE":  # in the axes of the drawing, whatever the extrusion is
        start, end = item.point(10), item.point(11)
        return [place.strand(Arc(start, end, 0.0, 0j))] if start != end else [], True
    if item.kind == "SPLINE":
        strand, exact = _spline(item, place)
        return [place.strand(strand)], exact
    arcs = _polyline(item) if "POLYLINE" in item.kind else _arcs(item)
    if item.kind == "ELLIPSE":
        major, ratio = item.point(11), item.number(40)
        if not abs(major) * ratio > 0.0:
            raise item.fault("has an axis of no length")
        side = ratio * Placement().oriented(item).sense
        half = 0.5 * major
        # Maps the unit circle: 1 goes to the end of the major axis, i to that of the minor one.
        place = place.compose(Placement(half * (1.0 + side), half * (1.0 - side), item.point(10)))
    else:
        place = place.oriented(item)
    exact = place.sense != 0.0 or not any(arc.sweep for arc in arcs)
    return [place.strand(arc) for arc in arcs], exact


def _arcs(item: Item) -> list[Arc]:
    """An ARC or CIRCLE; of an ELLIPSE the circle of radius 1 that it is an image of. A whole circle
    is two.
    """
    if item.kind == "ELLIPSE":
        centre, radius, ends = 0j, 1.0, (item.number(41, 0.0), item.number(42, TURN))
    else:
        centre, radius = item.point(10), item.number(40)
        ends = (math.radians(item.number(50, 0.0)), math.radians(item.number(51, 0.0)))
    if radius <= 0.0:
        raise item.fault("has no radius above 0")
    # Equal angles mean the whole circle.
    sweep = (ends[1] - ends[0]) % TURN
    if sweep and item.kind != "CIRCLE":
        first, last = (centre + cmath.rect(radius, angle) for angle in ends)
        return [Arc(first, last, sweep, centre)]
    sides = (centre + radius, centre - radius)
    return [Arc(start, end, math.pi, centre) for start, end in (sides, sides[::-1])]


def _polyline(item: Item) -> list[Arc]:
    """The pieces of a polyline, without those of zero length."""
    flags = int(item.number(70, 0.0))
    rows: list[list[float]] = []
    if item.kind == "POLYLINE":
        if flags & MESH:
            raise item.fault("is a mesh, not a curve")
        for vertex in item.vertices:
            if not int(vertex.number(70, 0.0)) & FRAME:
                rows.append([vertex.number(10), vertex.number(20), vertex.number(42, 0.0)])
    else:
        for tag in item.tags:
            # Group 10 begins a vertex, to which 20 and 42 add y and the bulge.
            if tag.code == 10:
                rows.append([item.value(tag), 0.0, 0.0])
            elif tag.code in (20, 42) and rows:
                rows[-1][1 if tag.code == 20 else 2] = item.value(tag)
        _require_count(item, 90, len(rows), "vertex", "vertices")
    if not rows:
        return []
    x, y, bulges = np.array(rows).T
    rows.clear()  # there may be millions
    whole = Contour.through(x + 1j * y, 4.0 * np.arctan(bulges))
    columns = (whole.vertices, whole.ends, whole.sweeps, whole.centres)
    pieces = list(map(Arc, *(column.tolist() for column in columns)))
    segments = pieces if flags & CLOSED else pieces[:-1]
    return [piece for piece in segments if piece.start != piece.end]


def _require_count(item: Item, code: int, count: int, *noun: str) -> None:
    """Raise EntityError if group `code` states a number other than `count`."""
    if item.number(code, count) != count:
        raise item.fault(f"has {counted(count, *noun)}, not as many as it states")


def _spline(item: Item, place: Placement) -> tuple[CubicSpline, bool]:
    """A SPLINE in the axes of the drawing, and whether it is exactly this one."""
    tags = [(tag.code, item.value(tag)) for tag in item.tags if 10 <= tag.code < 80]

    def group_values(code: int) -> FloatArray:
        return np.array([value for group, value in tags if group == code])

    def group_points(code: int) -> ComplexArray:
        x, y, z = (group_values(code + k) for k in (0, 10, 20))
        if len(y) != len(x) or (len(z) and np.ptp(z) > TILTED):
            raise item.fault("does not lie in the plane of the drawing")
        return x + 1j * y

    knots, weights, controls, fit = (
        group_values(40),
        group_values(41),
        group_points(10),
        group_points(11),
    )
    if not len(controls):
        return _through(
            item, fit, [z for code in (12, 13) for z in group_points(code).tolist()]
        ), False
    _require_count(item, 72, len(knots), "knot")
    _require_count(item, 73, len(controls), "control point")
    degree = item.number(71)
    if degree not in DEGREES or len(weights) not in (0, len(controls)) or np.any(weights <= 0.0):
        raise item.fault(
            f"is of degree {degree:g}, not of 1 to 10, or has weights that are not above 0"
        )
    rational = len(weights) and np.ptp(weights) > RATIONAL * np.max(weights)
    try:
        if degree <= CUBIC and not rational:
            return CubicSpline.from_bspline(int(degree), knots, controls), True
        if not len(controls) + degree + 1 == len(knots) > 2 * degree + 1 or np.any(
            np.diff(knots) < 0
        ):
            raise GeometryError(f"its {counted(len(knots), 'knot')} do not ascend, or do not match")
        from ezdxf.math import BSpline  # few drawings have such splines

        points = [(z.real, z.imag) for z in controls.tolist()]
        curve = BSpline(points, int(degree) + 1, knots.tolist(), weights.tolist() or None)

        def jet(t: float) -> tuple[complex, complex]:
            point, way = curve.derivative(t, 1)
            return complex(point.x, point.y), complex(way.x, way.y)

        near = max(
            NEAR / (abs(place.turn) + abs(place.mirror)), RATIONAL * float(np.max(np.abs(controls)))
        )
        return _followed(jet, knots[int(degree) : -int(degree)], near), False
    except GeometryError as error:
        raise item.fault(f"is not a spline: {error}") from None


def _through(item: Item, points: ComplexArray, ways: Sequence[complex]) -> CubicSpline:
    """The spline through `points` (n,) that has no control points, as CAD programs draw it; `ways`
    are its directions at both ends, if stated.
    """
    from ezdxf.math import fit_points_to_cad_cv  # few drawings have such splines

    distinct = points[np.diff(points, append=np.nan) != 0.0].tolist()
    if not 2 <= len(distinct) <= MOST_FIT:
        raise item.fault(f"has neither control points nor 2 to {MOST_FIT:,} fit points")
    both = [(way.real, way.imag) for way in ways] if len(ways) == 2 and all(ways) else None
    spline = fit_points_to_cad_cv([(z.real, z.imag) for z in distinct], both)
    controls = np.array([complex(control.x, control.y) for control in spline.control_points])
    return CubicSpline.from_bspline(spline.degree, np.array(spline.knots()), controls)


def _followed(
    jet: Callable[[float], tuple[complex, complex]], knots: ArrayLike, near: float
) -> CubicSpline:
    """Cubics along a curve, with its points and derivatives at `knots` and between them, until they
    are `near` at three places of each, which is sampled, not proved.

    `jet` is the curve with its derivative over a parameter. Raises GeometryError if that takes too
    many.
    """
    t, far = np.unique(knots), np.ones(1, dtype=np.bool_)
    while np.any(far):
        width = np.diff(t)
        # At a knot itself the derivative is the one after it.
        starts, ends = (
            np.array([jet(parameter) for parameter in places]).T
            for places in (t[:-1].tolist(), (t[1:] - END_SHARE * width).tolist())
        )
        ends[0] = np.append(starts[0, 1:], jet(float(t[-1]))[0])
        # Cubics whose first and last legs are a third of the derivatives at their ends.
        pieces = np.stack(
            (starts[0], starts[0] + starts[1] * width / 3.0,
             ends[0] - ends[1] * width / 3.0, ends[0]), axis=1,
        )  # fmt: skip
        looks = (t[:-1, np.newaxis] + width[:, np.newaxis] * LOOKS).tolist()
        there = np.array([[jet(parameter)[0] for parameter in row] for row in looks])
        far = np.max(np.abs(bezier_points(pieces, LOOKS) - there), axis=1) > 0.8 * near
        t = np.sort(np.concatenate((t, (t[:-1] + 0.5 * width)[far])))
        if len(t) > MOST_SPANS:
            raise GeometryError(f"it bends too sharply to be approximated within {NEAR:g} mm")
    # With triple knots each span is one of the cubics.
    places = np.arange(len(pieces) + 1.0)
    inner = np.append(pieces[:, :3].ravel(), pieces[-1, 3])
    return CubicSpline(np.concatenate(([0.0], np.repeat(places, 3), places[-1:])), inner)


def closed(strands: Sequence[Strand]) -> AnyContour:
    """The closed contour of strands end to end; the caller has limited the gaps.

    Where two ends differ, arcs and lines are moved to splines, and a strand to the next one. A
    contour without splines consists of lines and arcs.
    """
    starts = []
    for previous, strand in zip((strands[-1], *strands[:-1]), strands, strict=True):
        snaps_to_spline = isinstance(previous, CubicSpline) and isinstance(strand, Arc)
        starts.append(previous.end if snaps_to_spline else strand.start)
    arcs = [strand for strand in strands if isinstance(strand, Arc)]
    if len(arcs) == len(strands):
        return Contour.through(np.array(starts), np.array([arc.sweep for arc in arcs]))
    ends = [*starts[1:], starts[0]]
    return SplineContour(
        tuple(
            strand.with_ends(start, end)
            for strand, start, end in zip(strands, starts, ends, strict=True)
        )
    )


# -- drawing ---------------------------------------------------------------------------------------
# What a drawing shows on its layers, in blocks too, and the closed contours of it.


MM_PER_INSUNIT: Final = {1: 25.4, 2: 304.8, 4: 1.0, 5: 10.0, 6: 1000.0}
"""Millimetres of the units that $INSUNITS names: inch, foot, mm, cm, m."""

DEFPOINTS: Final = "defpoints"
"""Layer of points that dimensions refer to, in lower case; it is never plotted."""

FROZEN: Final = 1
"""Bit of group 70 that marks a layer as frozen."""

PARTS: Final = ("ATTRIB", "ATTDEF", "ENDBLK", "SEQEND", "VERTEX", "VIEWPORT")
"""Entities that are no curves and of no interest."""

GAPS: Final = (0.0, 1e-9, 1e-7, 1e-5, 1e-3, 1e-1)
"""Gaps [mm] that are joined in turn: pieces may be shorter than the largest that is allowed."""

ALIKE: Final = 1e-6
NEARLY: Final = 1e-3
"""Contours lie on each other if their areas and lengths differ by less than the first fraction and
their middles by less than the second one, of a length and its square."""

DEEPEST: Final = 32
"""Deepest nesting of blocks."""

EVERY: Final = 100_000
"""Entities after which progress is reported again."""

MOST_PLACES: Final = 3
"""Most places that a note names of the pieces that are left out for one reason."""


def gap_steps(most: float) -> tuple[float, ...]:
    """The gaps [mm] to be tried, up to `most`."""
    return (*(gap for gap in GAPS if gap < most), most)


@dataclass(frozen=True, slots=True)
class Drawing:
    """A drawing that was read.

    Attributes
    ----------
    name : of the file, for messages.
    header : the header variables, each with its first value.
    items : the entities of the model space, in the order of the file.
    layers : the records of the layers.
    names : of the layers that entities are on, by their lower case, without which they are alike.
    blocks : record, with name and base point, and entities of each, by its name in lower case.
    """

    name: str
    header: Mapping[str, Tag]
    items: Items | tuple[Item, ...]
    layers: Items | tuple[Item, ...]
    names: Mapping[str, str] = field(default_factory=dict)
    blocks: Mapping[str, tuple[Item, Items]] = field(default_factory=dict)

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

    def contours(self, layer: str | None, gap: float = 0.0) -> tuple[AnyContour, ...]:
        """The closed contours [mm] of a drawing in which all must be part of one, as `outlines`.

        Raises FileError as that does, and for the first entity that is part of none.
        """
        return self.outlines(layer, gaps=(gap,), strict=True).contours

    def outlines(
        self,
        layer: str | None,
        unit: LengthUnit | None = None,
        gaps: Sequence[float] = (0.0,),
        *,
        strict: bool = False,
        progress: Progress = lambda _: None,
    ) -> Outlines:
        """The closed contours [mm], counter-clockwise, the largest first, and what is left.

        A contour without splines consists of lines and arcs. Where two ends lie apart, one is moved
        to the other: that of an arc or line to that of a spline.

        Parameters
        ----------
        layer : whose entities are read; None for layer CUT and those of edges that do not go
            through, if CUT exists, else for all.
        unit : of the drawing, needed if the drawing does not state it.
        gaps : end points up to this far apart [mm] are joined, by that of these with which the
            least is left, the smallest of such; 0 for rounding only.
        strict : whether what is left is an error.

        Raises
        ------
        FileError
            With name and line, if the unit is unknown, a number is none, or there is no contour.
        """
        visible = _Visible(self, self._wanted(layer), progress)
        runs = list(visible.runs(Placement(complex(self.scale(unit)))))
        ends = [(run.pieces[-1].end, run.pieces[0].start) for run in runs]
        open_runs = [run for run, (end, start) in zip(runs, ends, strict=True) if end != start]
        loops, left = chain_runs(open_runs, gaps[0])
        for gap in gaps[1:]:
            if all(leftover.why == DOUBLE for leftover in left):
                break
            progress(f"{self.name}, pieces joined with gaps up to {gap:g} mm")
            # A larger gap counts only if it leaves less.
            attempt = chain_runs(open_runs, gap)
            loops, left = attempt if len(attempt[1]) < len(left) else (loops, left)
        whole = (run for run, (end, start) in zip(runs, ends, strict=True) if end == start)
        loops = [(list(run.pieces), [run]) for run in whole] + loops
        if len(loops) > CONTOURS:
            raise beyond(self.name, counted(len(loops), "closed contour"), CONTOURS, DRAWING)
        contours, others = _contours(loops, doubles=strict)
        left = sorted([*left, *others], key=lambda leftover: leftover.why == DOUBLE)
        reasons = [str(error) for error in visible.faults]
        reasons += [self._fault(leftover, gaps[-1]) for leftover in left[:1]]
        notes = tuple(visible.notes(runs, left))
        if reasons and (strict or not contours):
            raise FileError(reasons[0])
        if not contours:
            plain_notes = [note.removeprefix(f"{self.name}: ") for note in notes]
            details = "; ".join(plain_notes) or f"supported: {', '.join(CURVES)}, INSERT"
            raise FileError(f"{self.name}: no contour found; {details}")
        # The largest gap that was actually joined.
        gap = max(
            abs(previous.end - piece.start)
            for pieces, _ in loops
            for previous, piece in zip([pieces[-1], *pieces], pieces, strict=False)
        )
        followed = 0.0 if all(run.exact for run in runs) else NEAR
        loose = reasons[-1] if left and left[0].why == LOOSE else ""
        return Outlines(tuple(contours), gap, notes, followed, loose)

    def curves_on_layer(self, layer: str | None) -> Iterator[Item]:
        """The curves that are shown on a layer; see `outlines`."""
        visible = _Visible(self, self._wanted(layer))
        return (item for item, _ in visible.placed(Placement()) if item.kind in CURVES)

    def _wanted(self, layer: str | None) -> set[str]:
        """The layers that are read, in lower case; all if there is none."""
        if layer is not None and layer.lower() not in self.names:
            known = ", ".join(sorted(self.names.values()))
            raise FileError(f"{self.name}: has no layer {layer!r}; there are {known}")
        if layer is not None or CUT.lower() not in self.names:
            return set() if layer is None else {layer.lower()}
        return {name.lower() for name in part_layers(map(str.upper, self.names))}

    def _fault(self, left: Leftover, gap: float) -> str:
        """What is wrong with a run that is part of no contour."""
        run, place, why = left
        rest = f"; pieces must form closed contours, with gaps of at most {gap:g} mm"
        where = f"{why} at {place_text(place)}{rest if why in (LOOSE, BRANCH) else ''}"
        return f"{self.name}, line {run.line}: {run.kind} {where}"


PLACED: Final = 100_000
"""Most entities of a drawing that come from blocks, each counted as often as it is inserted."""


@dataclass(slots=True)
class _Visible:
    """What is shown of a drawing on the layers `wanted`, and a count of what is not.

    Attributes
    ----------
    hidden_layers : layers that are not shown, in lower case.
    hidden : how many entities of each layer are not shown.
    unread : how many entities of each kind are shown but not read.
    faults : errors of entities that cannot be used.
    count : how many entities have come from blocks.
    """

    drawing: Drawing
    wanted: set[str]
    progress: Progress = lambda _: None
    hidden_layers: frozenset[str] = field(init=False)
    hidden: Counter[str] = field(default_factory=Counter)
    unread: Counter[str] = field(default_factory=Counter)
    faults: list[EntityError] = field(default_factory=list)
    count: int = 0

    def __post_init__(self) -> None:
        self.hidden_layers = frozenset(
            record.text(2).lower()
            for record in self.drawing.layers
            if record.number(62, 7.0) < 0.0 or int(record.number(70, 0.0)) & FROZEN
        )

    def runs(self, place: Placement) -> Iterator[EntityRun]:
        """The curves, as far as they have any length, where `place` puts them."""
        for number, (item, inner) in enumerate(self.placed(place)):
            if not number % EVERY:
                self.progress(f"{self.drawing.name}, {number:,} entities taken")
            if item.kind not in CURVES:
                self.unread[item.kind] += item.kind not in PARTS
                continue
            try:
                pieces, exact = entity_strands(item, inner)
            except EntityError as error:
                self.faults.append(error)
                continue
            if pieces:
                yield EntityRun(item.kind, item.line, pieces, exact)

    def placed(
        self,
        place: Placement,
        items: Iterable[Item] | None = None,
        layer: str | None = None,
        enclosing: tuple[str, ...] = (),
    ) -> Iterator[tuple[Item, Placement]]:
        """The entities that are shown, with their places; those of blocks in place of insertions.

        `layer` is that on which the block with the `items` is inserted, `enclosing` the names of
        the blocks around it.
        """
        for item in self.drawing.items if items is None else items:
            item_layer = item.layer.lower()
            item_layer = layer if layer is not None and item_layer == "0" else item_layer
            if (
                item_layer in self.hidden_layers
                or item_layer == DEFPOINTS
                or item.number(60, 0.0) == 1.0
            ):
                self.hidden[self.drawing.names.get(item_layer, item_layer)] += 1
            elif item.kind == "INSERT":
                yield from self._inserted(item, place, item_layer, enclosing)
            elif not self.wanted or item_layer in self.wanted:
                yield item, place

    def _inserted(
        self, item: Item, place: Placement, layer: str, enclosing: tuple[str, ...]
    ) -> Iterator[tuple[Item, Placement]]:
        """The entities of the block that `item` inserts, once or in rows and columns."""
        name = item.text(2).lower()
        record, items = self.drawing.blocks.get(name, (None, ()))
        if record is None or name in enclosing or len(enclosing) == DEEPEST:
            what = "that is not there" if record is None else "into itself, or too deeply"
            self.faults.append(item.fault(f"inserts a block {what}: {item.text(2)[:60]!r}"))
            return
        x, y = item.number(41, 1.0), item.number(42, 1.0)
        turn = cmath.rect(1.0, math.radians(item.number(50, 0.0)))
        base = Placement(shift=-record.point(10, 0.0))
        columns, rows = (max(1, int(item.number(code, 1.0))) for code in (70, 71))
        for row, column in (divmod(number, columns) for number in range(columns * rows)):
            step = complex(column * item.number(44, 0.0), row * item.number(45, 0.0))
            corner = item.point(10) + turn * step
            # Scaling by x and y along the axes is z -> (x + y) / 2 z + (x - y) / 2 conj(z).
            block_place = Placement(turn * (0.5 * (x + y)), turn * (0.5 * (x - y)), corner).compose(
                base
            )
            for placed_item in self.placed(
                place.oriented(item).compose(block_place), items, layer, (*enclosing, name)
            ):
                yield placed_item
                self.count += 1
            self.count += 1
            if self.count > PLACED:
                entities = counted(self.count, "entity", "entities")
                raise beyond(self.drawing.name, f"{entities} in blocks", PLACED, DRAWING)

    def notes(self, runs: Sequence[EntityRun], left: Sequence[Leftover]) -> Iterator[str]:
        """What is not shown, not read, cannot be used, is left or not exact."""
        name = self.drawing.name
        if self.hidden:
            count = counted(self.hidden.total(), "entity", "entities")
            layers = ", ".join(sorted(self.hidden))
            yield f"{name}: {count} not read that the drawing does not show, on layer {layers}"
        if kinds := +self.unread:
            yield f"{name}: not read: {_listed(kinds)}"
        yield from (f"{error}; left out" for error in self.faults[:MOST_PLACES])
        for why in (LOOSE, BRANCH, DOUBLE, EMPTY):
            leftovers = [one for one in left if one.why == why]
            places = [
                f"{r.kind} in line {r.line} {why} at {place_text(z)}"
                for r, z, _ in leftovers[:MOST_PLACES]
            ]
            if leftovers:
                count = f"{counted(len(leftovers), 'piece')} left out"
                more = "; ..." if len(leftovers) > MOST_PLACES else ""
                yield f"{name}: {count}: {'; '.join(places)}{more}"
        if kinds := Counter(run.kind for run in runs if not run.exact):
            yield f"{name}: {_listed(kinds)} followed by cubics within {NEAR:g} mm"


def _listed(kinds: Counter[str]) -> str:
    return ", ".join(f"{count} {kind}" for kind, count in kinds.most_common())


def _contours(loops: Sequence[Loop], *, doubles: bool) -> tuple[list[AnyContour], list[Leftover]]:
    """The contours of closed chains, the largest first, each once unless `doubles` count too, and
    the runs of the others.
    """
    left = []
    outlines: list[tuple[AnyContour, Loop]] = []
    for pieces, runs in loops:
        single = len(pieces) < 2 and isinstance(pieces[0], Arc)
        if single or (contour := closed(pieces)).area == 0.0:
            left.append(Leftover(runs[0], pieces[0].start, EMPTY))
        else:
            outlines.append((contour.counter_clockwise(), (pieces, runs)))
    distinct: list[tuple[AnyContour, complex]] = []
    for contour, (pieces, runs) in sorted(outlines, key=lambda outline: -outline[0].area):
        middle = contour_centre(contour)
        if not doubles and any(_same(contour, middle, *other) for other in distinct):
            left += [Leftover(run, pieces[0].start, DOUBLE) for run in runs]
        else:
            distinct.append((contour, middle))
    return [contour for contour, _ in distinct], left


def _same(one: AnyContour, middle: complex, other: AnyContour, place: complex) -> bool:
    """Whether two contours have the same area, length and middle, and so lie on each other."""
    return (
        abs(one.area - other.area) <= ALIKE * one.length**2
        and abs(one.length - other.length) <= ALIKE * one.length
        and abs(middle - place) <= NEARLY * one.length
    )


def read_drawing(
    data: bytes, name: str = "the drawing", progress: Progress = lambda _: None
) -> Drawing:
    """The drawing in the file `name`; FileError if it is not DXF, or truncated."""
    return Drawing(name, *read_contents(data, name, progress))


class DxfReader:
    """Reads closed contours from a DXF drawing."""

    def read(
        self,
        data: bytes,
        name: str,
        *,
        layer: str | None,
        unit: LengthUnit | None,
        gap: float,
        progress: Progress = lambda _: None,
    ) -> Outlines:
        """See `Drawing.outlines`."""
        drawing = read_drawing(data, name, progress)
        return drawing.outlines(layer, unit, gap_steps(gap), progress=progress)


READER = DxfReader()


# -- chains ---------------------------------------------------------------------------------------
# Pieces of a drawing joined end to end into closed chains, among others that close nothing.
#
# Ends at the same place are a node. Where just two pieces meet one follows the other; chains with a
# loose end are left, until there is none. Where several meet, shapely's polygonizer finds the
# faces: what lies on the border of exactly one bounds the shape; bridges and what divides a face
# are left.


JOINED: Final = 1e-12
"""Ends closer than this fraction of the drawing's reach are the same, written once as an angle and
once as a point."""

LEAST: Final = 1e-30
"""Gap [mm] of a drawing whose ends are all at the origin."""

SAMPLES: Final = np.arange(1, 8) / 8.0
"""Shares of a curved piece whose points distinguish faces; no geometry is computed from them."""

PAIRS: Final = 10_000_000
"""Most pairs of ends that are close to each other."""

PATHS: Final = 10_000
"""Most chains between places where several pieces meet."""

NONE: Final = -1
"""Stands for the end that follows another one where there is none."""

LOOSE: Final = "has a loose end"
BRANCH: Final = "meets more than one other piece"
DOUBLE: Final = "is drawn a second time"
EMPTY: Final = "encloses nothing"
"""Reasons why a run is left out."""


class EntityRun(NamedTuple):
    """Pieces of an entity end to end.

    Attributes
    ----------
    kind, line : of the entity.
    pieces : one or more [mm].
    exact : whether they are its curve, and do not only follow it.
    """

    kind: str
    line: int
    pieces: Sequence[Strand]
    exact: bool


class Leftover(NamedTuple):
    """A run that is part of no closed chain, or is drawn already, with the place [mm] and why."""

    run: EntityRun
    place: complex
    why: str


Loop = tuple[list[Strand], Sequence[EntityRun]]
"""The pieces of a closed chain, and the runs that they are from."""

Way = list[int]
"""Runs one after the other, by the ends at which they are entered: 2 k is the start of run k."""


def chain_runs(runs: Sequence[EntityRun], gap: float) -> tuple[list[Loop], list[Leftover]]:
    """The closed chains of open `runs`, whose ends are joined if they are at most `gap` apart [mm],
    or the same but for rounding; and what is left.
    """
    # Ends 2 k and 2 k + 1 are those of run k, so `end ^ 1` is the other end of the same run.
    both = [end for run in runs for end in (run.pieces[0].start, run.pieces[-1].end)]
    if not both:
        return [], []
    ends = np.array(both)
    gap = max(gap, JOINED * float(np.max(np.abs(ends))), LEAST)
    nodes = _nodes(ends, gap)
    used = ~_doubles(runs, nodes, gap)
    left = [Leftover(runs[k], both[2 * k], DOUBLE) for k in np.flatnonzero(~used).tolist()]
    while True:
        following, degrees = _following(nodes, np.repeat(used, 2))
        ways = list(_ways(following.tolist(), used))
        single = [way for way in ways if 1 in (degrees[way[0]], degrees[way[-1] ^ 1])]
        if not single:
            break
        for way in single:
            end = way[0] if degrees[way[0]] == 1 else way[-1] ^ 1
            used[[entry // 2 for entry in way]] = False
            order = way if end == way[0] else way[::-1]
            left += [Leftover(runs[entry // 2], both[end], LOOSE) for entry in order]
    closed_ways = [way for way in ways if following[way[0]] != NONE]
    others = {k: way for k, way in enumerate(ways) if following[way[0]] == NONE}
    # One place for each node, that of its last end: the polygonizer needs ends that are equal.
    spots = np.empty_like(ends)
    spots[nodes] = ends
    rings = _outer_rings({k: _path(runs, way, spots[nodes]) for k, way in others.items()})
    for ring in rings:
        parts = (others[k] if ahead else [e ^ 1 for e in others[k][::-1]] for k, ahead in ring)
        closed_ways.append([end for part in parts for end in part])
    for k in others.keys() - {k for ring in rings for k, _ in ring}:
        left += [Leftover(runs[end // 2], both[end], BRANCH) for end in others[k]]
    return [
        ([piece for end in way for piece in _pieces(runs, end)], [runs[end // 2] for end in way])
        for way in closed_ways
    ], left


def _pieces(runs: Sequence[EntityRun], end: int) -> Sequence[Strand]:
    """The pieces of a run from that end on."""
    pieces = runs[end // 2].pieces
    return [piece.reversed() for piece in pieces[::-1]] if end % 2 else pieces


def _nodes(ends: ComplexArray, gap: float) -> IntArray:
    """(n,) the same number for `ends` (n,) that are at most `gap` apart, or by way of others."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components
    from scipy.spatial import cKDTree

    known, numbers = np.unique(ends, return_inverse=True)
    tree = cKDTree(np.column_stack((known.real, known.imag)))
    count = int(tree.count_neighbors(tree, gap))
    if count > PAIRS:
        raise beyond("the drawing", counted(count, "pair") + " of near ends", PAIRS, DRAWING)
    one, other = tree.query_pairs(gap, output_type="ndarray").T
    links = coo_array((np.ones(len(one)), (one, other)), shape=(len(known), len(known)))
    return np.asarray(connected_components(links, directed=False)[1])[numbers]


def _doubles(runs: Sequence[EntityRun], nodes: IntArray, gap: float) -> BoolArray:
    """(n,) which of the `runs` (n,) lie on another one: the same ends, the same middle."""
    marks = np.array([sum(map(_middle, run.pieces)) / len(run.pieces) for run in runs])
    ends = np.sort(nodes.reshape(-1, 2), axis=1)
    # Runs with the same ends become neighbours, ordered by their middles.
    order = np.lexsort((marks.imag, marks.real, ends[:, 1], ends[:, 0]))
    same = np.all(ends[order[1:]] == ends[order[:-1]], axis=1)
    doubles = np.zeros(len(runs), dtype=np.bool_)
    doubles[order[1:][same & (np.abs(np.diff(marks[order])) <= gap)]] = True
    return doubles


def _middle(piece: Strand) -> complex:
    if isinstance(piece, CubicSpline):
        return complex(np.mean(piece.controls))
    if not piece.sweep:
        return 0.5 * (piece.start + piece.end)
    return piece.centre + (piece.start - piece.centre) * cmath.exp(0.5j * piece.sweep)


def _following(nodes: IntArray, used: BoolArray) -> tuple[IntArray, IntArray]:
    """(n,) the other end at the node of each `used` one if there are just these two, else NONE; and
    how many there are.
    """
    order = np.flatnonzero(used)
    order = order[np.argsort(nodes[order], kind="stable")]
    firsts = np.flatnonzero(np.diff(nodes[order], prepend=NONE))
    counts = np.diff(np.append(firsts, len(order)))
    two = firsts[counts == 2]
    following, degrees = np.full((2, len(nodes)), NONE)
    following[order[two]], following[order[two + 1]] = order[two + 1], order[two]
    degrees[order] = np.repeat(counts, counts)
    return following, degrees


def _ways(following: list[int], used: BoolArray) -> Iterator[Way]:
    """All `used` runs, each in one way: first those from an end that none follows, then rings."""
    free = used.tolist()
    ends = range(len(following))
    for end in (*(e for e in ends if following[e] == NONE), *ends[::2]):
        way: Way = []
        while end != NONE and free[end // 2]:
            free[end // 2] = False
            way.append(end)
            end = following[end ^ 1]
        if way:
            yield way


def _path(runs: Sequence[EntityRun], way: Way, spots: ComplexArray) -> ComplexArray:
    """Points along a way, each other than the one before; its ends are those of their nodes."""
    parts = [spots[way[:1]]]
    for piece in (piece for end in way for piece in _pieces(runs, end)):
        if isinstance(piece, CubicSpline):
            parts.append(bezier_points(piece.beziers, SAMPLES).ravel())
        elif piece.sweep:
            parts.append(piece.points_by_share(SAMPLES))
        parts.append(np.array([piece.end]))
    parts[-1] = spots[[way[-1] ^ 1]]
    points: ComplexArray = np.concatenate(parts)
    distinct: ComplexArray = points[np.diff(points, prepend=np.nan) != 0.0]
    return distinct


Ring = list[tuple[int, bool]]
"""Paths one after the other by their numbers, and whether they are run through forwards."""


def _outer_rings(paths: Mapping[int, ComplexArray]) -> list[Ring]:
    """The borders of the shapes that the `paths` enclose, without what lies between two faces."""
    rings = _rings(paths)
    borders = Counter(k for ring in rings for k, _ in ring)
    outer = {k: paths[k] for k, count in borders.items() if count == 1}
    return rings if len(outer) == len(borders) else _rings(outer)


def _rings(paths: Mapping[int, ComplexArray]) -> list[Ring]:
    """The outer borders of the faces between the `paths`, which meet only at their ends."""
    import shapely

    if len(paths) > PATHS:
        raise beyond("the drawing", f"{len(paths):,} chains between crossings", PATHS, DRAWING)
    long = {k: path for k, path in paths.items() if len(path) > 1}
    # The first step of a path in either direction tells which path a border follows.
    heads = {(path[0], path[1]): (k, True) for k, path in long.items()}
    heads |= {(path[-1], path[-2]): (k, False) for k, path in long.items()}
    lines = [shapely.LineString(np.column_stack((z.real, z.imag))) for z in long.values()]
    rings = shapely.get_exterior_ring(shapely.get_parts(shapely.polygonize(lines)))
    # Rows (x, y) as x + iy.
    borders = (shapely.get_coordinates(ring) @ (1.0, 1.0j) for ring in rings)
    return [[heads[step] for step in pairwise(z.tolist()) if step in heads] for z in borders]
