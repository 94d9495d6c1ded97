"""The contents of a DXF file: tags, and the entities that they make up.

The file is gone through once, and of each entity only its place is kept: its tags, which take many
times the memory of their text, are made anew whenever it is asked for.
"""

from __future__ import annotations

import cmath
import codecs
import io
import math
import re
from array import array
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from itertools import count, pairwise
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from camgeo.errors import FileError, GeometryError
from camgeo.geometry.contour.contour import Contour
from camgeo.geometry.contour.spline import CUBIC, Arc, CubicSpline, SplineContour, at
from camgeo.numeric.arrays import ComplexArray, FloatArray
from camgeo.reading import DRAWING, check_text
from camgeo.units import TURN, counted
from camgeo_export.reading import finite

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


# -- curves ---------------------------------------------------------------------------------------
# The curves that DXF entities draw: lines, arcs and cubics, placed in the plane of the drawing.
#
# What is exactly one of these stays it, wherever blocks are inserted. An ellipse, and an arc in a
# block that is stretched, is followed by the images of cubics close to a circle; splines that are
# rational or of a higher degree by cubics with their points and tangents.


Strand = CubicSpline | Arc
Curve = Contour | SplineContour

CURVES: Final = ("LINE", "ARC", "CIRCLE", "LWPOLYLINE", "POLYLINE", "SPLINE", "ELLIPSE")

DEGREES: Final = tuple(map(float, range(1, 11)))

RATIONAL: Final = 1e-12
"""Weights that differ by a larger fraction make a spline rational."""

NEAR: Final = 1e-7
"""Distance [mm] within which cubics follow what is none."""

LOOKS: Final = np.array([0.25, 0.5, 0.75])
"""Parameters at which a cubic is compared with the spline that it follows."""

BEFORE: Final = 1e-9
"""Share of a span before its end at which its own last derivative is taken."""

MOST_FIT: Final = 1_000
"""Points through which a spline is fitted: memory grows with their square."""

MOST_SPANS: Final = 20_000
"""Cubics along one curve."""

TILTED: Final = 1e-9
"""Largest part along x or y of an extrusion that still points along z."""

CLOSED: Final = 1
"""Bit of group 70 that marks a polyline as closed."""

MESH: Final = 16 | 64
"""Bits of group 70 of a POLYLINE that is a mesh."""

FRAME: Final = 16
"""Bit of group 70 of a VERTEX that is none of the curve but steers its splines."""


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

    def after(self, inner: Placement) -> Placement:
        """First the `inner` map, then this one."""
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

    def seen(self, item: Item) -> Placement:
        """The same after the axes of an entity, of which x may point the other way (extrusion 0, 0,
        -1); EntityError if they are tilted.
        """
        x, y, z = (item.number(code, default) for code, default in ((210, 0), (220, 0), (230, 1)))
        if max(abs(x), abs(y), abs(abs(z) - 1.0)) > TILTED:
            raise item.fault("does not lie in the plane of the drawing")
        return self if z > 0.0 else self.after(Placement(0.0j, -1.0 + 0.0j))


def strands_of(item: Item, place: Placement) -> tuple[list[Strand], bool]:
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
        side = ratio * Placement().seen(item).sense
        half = 0.5 * major
        place = place.after(Placement(half * (1.0 + side), half * (1.0 - side), item.point(10)))
    else:
        place = place.seen(item)
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
    sweep = (ends[1] - ends[0]) % TURN
    if sweep and item.kind != "CIRCLE":
        first, last = (centre + cmath.rect(radius, angle) for angle in ends)
        return [Arc(first, last, sweep, centre)]
    sides = (centre + radius, centre - radius)
    return [Arc(start, end, math.pi, centre) for start, end in (sides, sides[::-1])]


def _polyline(item: Item) -> list[Arc]:
    """Its pieces, without those of zero length."""
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
    drawn = pieces if flags & CLOSED else pieces[:-1]
    return [piece for piece in drawn if piece.start != piece.end]


def _require_count(item: Item, code: int, found: int, *noun: str) -> None:
    """EntityError unless as many are found as group `code` states, if it does."""
    if item.number(code, found) != found:
        raise item.fault(f"has {counted(found, *noun)}, not as many as it states")


def _spline(item: Item, place: Placement) -> tuple[CubicSpline, bool]:
    """A SPLINE in the axes of the drawing, and whether it is exactly this one."""
    tags = [(tag.code, item.value(tag)) for tag in item.tags if 10 <= tag.code < 80]

    def all_of(code: int) -> FloatArray:
        return np.array([value for group, value in tags if group == code])

    def points_of(code: int) -> ComplexArray:
        x, y, z = (all_of(code + k) for k in (0, 10, 20))
        if len(y) != len(x) or (len(z) and np.ptp(z) > TILTED):
            raise item.fault("does not lie in the plane of the drawing")
        return x + 1j * y

    knots, weights, controls, fit = all_of(40), all_of(41), points_of(10), points_of(11)
    if not len(controls):
        return _through(
            item, fit, [z for code in (12, 13) for z in points_of(code).tolist()]
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
            return CubicSpline.of(int(degree), knots, controls), True
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

    apart = points[np.diff(points, append=np.nan) != 0.0].tolist()
    if not 2 <= len(apart) <= MOST_FIT:
        raise item.fault(f"has no control points, nor 2 to {MOST_FIT:,} to be fitted through")
    both = [(way.real, way.imag) for way in ways] if len(ways) == 2 and all(ways) else None
    spline = fit_points_to_cad_cv([(z.real, z.imag) for z in apart], both)
    controls = np.array([complex(each.x, each.y) for each in spline.control_points])
    return CubicSpline.of(spline.degree, np.array(spline.knots()), controls)


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
            np.array([jet(each) for each in places]).T
            for places in (t[:-1].tolist(), (t[1:] - BEFORE * width).tolist())
        )
        ends[0] = np.append(starts[0, 1:], jet(float(t[-1]))[0])
        pieces = np.stack(
            (starts[0], starts[0] + starts[1] * width / 3.0,
             ends[0] - ends[1] * width / 3.0, ends[0]), axis=1,
        )  # fmt: skip
        looks = (t[:-1, np.newaxis] + width[:, np.newaxis] * LOOKS).tolist()
        there = np.array([[jet(each)[0] for each in row] for row in looks])
        far = np.max(np.abs(at(pieces, LOOKS) - there), axis=1) > 0.8 * near
        t = np.sort(np.concatenate((t, (t[:-1] + 0.5 * width)[far])))
        if len(t) > MOST_SPANS:
            raise GeometryError(f"it turns too sharply to be followed within {NEAR:g} mm")
    places = np.arange(len(pieces) + 1.0)
    inner = np.append(pieces[:, :3].ravel(), pieces[-1, 3])
    return CubicSpline(np.concatenate(([0.0], np.repeat(places, 3), places[-1:])), inner)


def closed(strands: Sequence[Strand]) -> Curve:
    """The closed contour of strands end to end; the caller has limited the gaps.

    Where two ends differ, arcs and lines are moved to splines, and a strand to the next one. A
    contour without splines consists of lines and arcs.
    """
    starts = []
    for before, strand in zip((strands[-1], *strands[:-1]), strands, strict=True):
        given_way = isinstance(before, CubicSpline) and isinstance(strand, Arc)
        starts.append(before.end if given_way else strand.start)
    arcs = [strand for strand in strands if isinstance(strand, Arc)]
    if len(arcs) == len(strands):
        return Contour.through(np.array(starts), np.array([arc.sweep for arc in arcs]))
    ends = [*starts[1:], starts[0]]
    return SplineContour(
        tuple(
            strand.between(start, end)
            for strand, start, end in zip(strands, starts, ends, strict=True)
        )
    )
