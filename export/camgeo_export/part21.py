"""STEP files read: the text of an exchange file by ISO 10303-21, its header and its instances with
all values; and the solid in it.
"""

from __future__ import annotations

import cmath
import math
import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from itertools import chain, pairwise
from typing import Any, Final, NoReturn, TypeVar

import numpy as np

from camgeo.errors import FileError, GeometryError
from camgeo.geometry.contour.spline import Arc, CubicSpline
from camgeo.numeric.arrays import phase
from camgeo.reading import COORDINATE, INSTANCES, Limits, beyond, check_size, parse_number

STEP: Final = Limits("STEP file", 8_000_000)

PARAMETERS: Final = 500_000
"""Commas and brackets of a STEP file, which begin or end its parameters."""

NESTED: Final = 8
"""Deepest nesting of lists in a parameter of a STEP file; shapes need no more than two."""

FIRST, LAST = "ISO-10303-21", "END-ISO-10303-21"

TOKEN: Final = re.compile(
    r"(?P<space>(?:[ \t\r\n\f]++|/\*(?:[^*]++|\*(?!/))*+\*/)++)"
    r"|(?P<ref>\#[0-9]{1,9}+)"
    r"|(?P<real>[+-]?[0-9]++\.[0-9]*+(?:[Ee][+-]?[0-9]++)?)"
    r"|(?P<whole>[+-]?[0-9]++)"
    r"|(?P<string>'(?:[^']++|'')*+')"
    r"|(?P<enumeration>\.[A-Z_][A-Z0-9_]*+\.)"
    r"|(?P<word>!?[A-Z_][A-Z0-9_-]*+)"
    r'|(?P<binary>"[0-9A-F]*+")'
    r"|(?P<mark>[()=;,$*])"
    r"|(?P<wrong>.)",
    re.DOTALL,
)
"""Blanks and comments between tokens, or one token, or a character that begins none: wherever it
begins there is a match, and no text is searched twice.
"""

CODED: Final = re.compile(
    r"\\X2\\((?:[0-9A-F]{4})++)\\X0\\|\\X4\\((?:[0-9A-F]{8})++)\\X0\\"
    r"|\\X\\([0-9A-F]{2})|\\S\\([ -~])|\\P[A-I]\\|\\\\|(\\)"
)
"""A directive in a string, a backslash that is doubled, or one that is wrong."""

RECORDS: Final = 20
"""Most records of a header, which has three, and at most four more."""

BEYOND: Final = 0x110000
"""First number that is no character."""


class Ref(int):
    """A reference to an instance."""


class Word(str):
    """An enumeration, without its points; `*` for a value that is derived."""

    __slots__ = ()


@dataclass(frozen=True, slots=True)
class Record:
    """A type and its parameters: texts, numbers, `Ref`, `Word`, None, records or tuples of these.

    A parameter that names its type is a record.
    """

    kind: str
    values: tuple[Any, ...]


@dataclass(frozen=True, slots=True)
class Exchange:
    """The contents of a file.

    Attributes
    ----------
    header : the records of the header section.
    instances : by their numbers; several records for one of several types.
    """

    header: tuple[Record, ...]
    instances: dict[int, tuple[Record, ...]]


def read_exchange(data: bytes, *, whole: bool = True) -> Exchange:
    """The contents of a file, or with `whole` false its header alone.

    Raises FileError with the line where it breaks the syntax, or if it is beyond the limits of
    `camgeo.reading`.
    """
    check_size(len(data), STEP, "the file")
    # Bounds the number of parameters before anything is parsed: each begins behind one of these.
    count = data.count(b",") + data.count(b"(")
    if count > PARAMETERS:
        raise beyond("the file", f"{count:,} commas and brackets", PARAMETERS, STEP)
    if not data.lstrip()[: len(FIRST)] == FIRST.encode():
        raise FileError("not a STEP file: it does not begin with ISO-10303-21")
    if not data.rstrip().endswith(f"{LAST};".encode()):
        raise FileError(f"not a complete STEP file: no {LAST} at its end")
    return _Parser(data.decode("utf-8", "replace")).exchange(whole)


def header_record(data: bytes, kind: str) -> Record:
    """A record of the header of a file; FileError unless there is one."""
    records = [record for record in read_exchange(data, whole=False).header if record.kind == kind]
    if len(records) != 1:
        raise FileError(f"the header has {kind} {len(records)} times, expected once")
    return records[0]


class _Parser:
    """Reads a text once, from its start."""

    def __init__(self, text: str) -> None:
        self.text = text
        self.end = 0
        self.tokens = self._tokens()
        self.kind = self.token = ""
        self.next()

    def _tokens(self) -> Iterator[tuple[str, str]]:
        for match in TOKEN.finditer(self.text):
            kind = match.lastgroup
            if kind == "wrong":
                self.fail(f"{self.text[self.end : self.end + 20]!r} is not a token of STEP")
            self.end = match.end()
            if kind != "space":
                yield str(kind), match.group()

    def fail(self, what: str) -> NoReturn:
        line = 1 + self.text.count("\n", 0, self.end)
        raise FileError(f"line {line}: {what}")

    def next(self) -> None:
        self.kind, self.token = next(self.tokens, ("end", "the end of the file"))

    def take(self, token: str) -> None:
        if self.token != token:
            self.fail(f"{token!r} expected, not {self.token[:40]!r}")
        self.next()

    def exchange(self, whole: bool) -> Exchange:
        for token in (FIRST, ";", "HEADER", ";"):
            self.take(token)
        header = []
        while self.token != "ENDSEC":
            header.append(self.record())
            self.take(";")
            if len(header) > RECORDS:
                self.fail(f"the header has more than {RECORDS} records")
        instances: dict[int, tuple[Record, ...]] = {}
        if whole:
            for token in ("ENDSEC", ";", "DATA", ";"):
                self.take(token)
            while self.kind == "ref":
                self.instance(instances)
            for token in ("ENDSEC", ";", LAST, ";"):
                self.take(token)
            if self.kind != "end":
                self.fail("there is text after the end of the file")
        return Exchange(tuple(header), instances)

    def instance(self, instances: dict[int, tuple[Record, ...]]) -> None:
        number = int(self.token[1:])
        if number in instances:
            self.fail(f"#{number} appears twice")
        if len(instances) == INSTANCES:
            raise beyond("the file", "more entities", INSTANCES, STEP)
        self.next()
        self.take("=")
        records = []
        if self.token == "(":
            self.next()
            while self.token != ")":
                records.append(self.record())
            self.next()
        else:
            records.append(self.record())
        self.take(";")
        instances[number] = tuple(records)

    def record(self) -> Record:
        if self.kind != "word":
            self.fail(f"a type expected, not {self.token[:40]!r}")
        kind = self.token
        self.next()
        self.take("(")
        return Record(kind, self.values(NESTED))

    def values(self, depth: int) -> tuple[Any, ...]:
        """The parameters after an opening bracket."""
        if depth == 0:
            self.fail(f"lists are nested more than {NESTED} deep")
        parameters: list[Any] = []
        if self.token == ")":
            self.next()
            return ()
        while True:
            parameters.append(self.value(depth))
            if self.token == ")":
                self.next()
                return tuple(parameters)
            self.take(",")

    def value(self, depth: int) -> Any:
        kind, token = self.kind, self.token
        self.next()
        match kind:
            case "ref":
                return Ref(token[1:])
            case "real" | "whole":
                return self.number(kind, token)
            case "string":
                return self.string(token)
            case "enumeration":
                return Word(token[1:-1])
            case "word":
                self.take("(")
                return Record(token, self.values(depth - 1))
            case "binary":
                return Word(token)
        if token == "(":
            return self.values(depth - 1)
        if token not in ("$", "*"):
            self.fail(f"a value expected, not {token[:40]!r}")
        return None if token == "$" else Word(token)

    def number(self, kind: str, token: str) -> float | int:
        value = parse_number(token)
        if value is None:
            self.fail(f"{token[:40]} is not a number of at most {COORDINATE:g}")
        return int(token) if kind == "whole" else value

    def string(self, token: str) -> str:
        # A quote inside a string is doubled.
        text = token[1:-1].replace("''", "'")
        return CODED.sub(self.decoded, text) if "\\" in text else text

    def decoded(self, match: re.Match[str]) -> str:
        """The characters of a directive."""
        two, four, one, shifted, wrong = match.groups()
        if wrong:
            self.fail("a string has a backslash that begins no directive")
        if shifted:
            # The directive means the character 128 places further on, in ISO 8859.
            return chr(ord(shifted) + 128)
        if one:
            return chr(int(one, 16))
        digits, size = (two, 4) if two else (four, 8)
        if digits is None:
            return "\\" if match.group() == "\\\\" else ""
        codes = [int(digits[k : k + size], 16) for k in range(0, len(digits), size)]
        # Half of a surrogate pair is no character.
        if any(code >= BEYOND or 0xD800 <= code < 0xE000 for code in codes):
            self.fail(f"a string has {match.group()[:40]}, which is not a character")
        return "".join(map(chr, codes))


# -- solid ----------------------------------------------------------------------------------------
# The solid in a file: its faces, their loops of edges, and the vertices.


SOLIDS = ("MANIFOLD_SOLID_BREP",)

OTHERS = (
    "BREP_WITH_VOIDS",
    "FACETED_BREP",
    "SHELL_BASED_SURFACE_MODEL",
    "GEOMETRIC_CURVE_SET",
    "TESSELLATED_SOLID",
    "MAPPED_ITEM",
    "ITEM_DEFINED_TRANSFORMATION",
)
"""Types of shapes, and of places in assemblies, that a file of a single solid does not have."""

STEEP = 0.1
"""Rise of an edge over its extent in the plane above which it is not level."""

PREFIXES = {None: 1000.0, "MILLI": 1.0, "CENTI": 10.0, "DECI": 100.0, "MICRO": 1e-3, "KILO": 1e6}
"""Millimetres in a metre with a prefix."""

CONVERTED = 3
"""Most units that may be defined by another one in a row."""

NAMES = {25.4: "inch", 1.0: "mm", 304.8: "foot", 10.0: "cm", 1000.0: "m"}
"""Names of units by their size [mm]."""


@dataclass(frozen=True, slots=True)
class Edge:
    """An edge.

    Attributes
    ----------
    number : of its instance.
    ends : the instances of the vertices at its start and its end.
    places : its start and its end [mm].
    strands : its pieces in the plane, from start to end; none if it rises from one height to
        another.
    gap : how far its ends are from its curve [mm].
    bend : its curve if it rises along a parabola, in whichever direction; else None.
    """

    number: int
    ends: tuple[int, int]
    places: tuple[Point, Point]
    strands: tuple[Strand, ...]
    gap: float
    bend: Parabola | None = None

    @property
    def z(self) -> float:
        """Height of a level edge [mm]."""
        return self.places[0].z

    @property
    def foot(self) -> int:
        """The vertex at the lower end of an edge between two heights."""
        one, other = self.places
        return self.ends[0] if one.z < other.z else self.ends[1]

    def section_point(self, z: float) -> complex:
        """The place [mm] at which an edge between two heights crosses the height `z` [mm]."""
        if self.bend is not None:
            return self.bend.section_point(z)
        one, other = self.places
        share = (z - one.z) / (other.z - one.z)
        return (1.0 - share) * one.place + share * other.place


@dataclass(frozen=True, slots=True)
class Use:
    """An edge in a loop, in its own direction if `forward`."""

    edge: Edge
    forward: bool

    @property
    def ends(self) -> tuple[int, int]:
        """The vertices at its start and its end, in the direction of the loop."""
        return self.edge.ends if self.forward else self.edge.ends[::-1]

    @property
    def strands(self) -> tuple[Strand, ...]:
        """The pieces in the direction of the loop."""
        if self.forward:
            return self.edge.strands
        return tuple(strand.reversed() for strand in self.edge.strands[::-1])


@dataclass(frozen=True, slots=True)
class Face:
    """A face; its normal is that of the surface if `same`."""

    number: int
    name: str
    surface: Surface
    same: bool
    loops: tuple[tuple[Use, ...], ...]

    @property
    def label(self) -> str:
        """What the face is called in messages, by its number and name."""
        return f"face #{self.number}" + (f" ({self.name[:40]})" if self.name else "")

    @property
    def uses(self) -> tuple[Use, ...]:
        """The uses of edges in all loops."""
        return tuple(chain.from_iterable(self.loops))

    @property
    def heights(self) -> tuple[float, float]:
        """The lowest and the highest place [mm]."""
        heights = [point.z for use in self.uses for point in use.edge.places]
        return min(heights), max(heights)

    @property
    def is_level(self) -> bool:
        """Whether the face is level."""
        return isinstance(self.surface, Plane) and abs(self.surface.normal.place) <= ALIGNED

    @property
    def is_inclined(self) -> bool:
        """Whether the face is neither level nor upright."""
        if isinstance(self.surface, Plane):
            normal = self.surface.normal
            return min(abs(normal.place), abs(normal.z)) > ALIGNED
        return isinstance(self.surface, Cone)

    @property
    def is_upward(self) -> bool:
        """Whether the face is level with its normal upwards."""
        return isinstance(self.surface, Plane) and (self.surface.normal.z > 0.0) == self.same

    def edge_distance(self, edge: Edge) -> float:
        """The largest distance [mm] of one of its edges from its surface."""
        surface = self.surface
        if edge.bend is not None:
            # The distance of a parabola from a cone vanishes with a polynomial of fourth degree,
            # so it vanishes everywhere if it does at five points.
            points = [edge.bend.evaluate(share) for share in (0.0, 0.25, 0.5, 0.75, 1.0)]
        elif not edge.strands:
            one, other = edge.places
            points = [one, Point(0.5 * (one.place + other.place), 0.5 * (one.z + other.z)), other]
        else:
            points = list(edge.places)
        distances = [surface_distance(surface, point.place, point.z) for point in points]
        for strand in edge.strands:
            if isinstance(surface, Extrusion):
                distances.append(_extrusion_distance(surface, strand))
            elif isinstance(strand, Arc):
                distances.append(surface_distance(surface, _middle(strand), edge.z))
            elif isinstance(surface, Cylinder | Cone):
                distances.append(math.inf)  # no spline follows a circle
            else:
                distances += [
                    surface_distance(surface, control, edge.z)
                    for control in strand.controls.tolist()
                ]
        if isinstance(surface, Extrusion) and not edge.strands:
            # An upright edge of an extruded spline stands at one end of it.
            ends = (surface.curve.start, surface.curve.end)
            distances.append(min(abs(end - edge.places[0].place) for end in ends))
        return max(distances)

    def rises_to_left(self, strand: Strand) -> bool:
        """Whether up is on the left of a strand seen from outside the face."""
        surface = self.surface
        if isinstance(surface, Extrusion):
            ahead = isinstance(strand, CubicSpline) and (
                spline_distance(surface.curve, strand)
                <= spline_distance(surface.curve, strand.reversed())
            )
            return (surface.sense > 0.0) == (self.same == ahead)
        place, heading = strand.start, strand.end - strand.start
        if isinstance(strand, Arc):
            place = _middle(strand)
            heading = strand.heading(place)
        normal = surface.normal.place if isinstance(surface, Plane) else place - surface.centre
        # Seen from outside, up is on the left of a heading that is counter-clockwise from the
        # normal.
        return ((normal.conjugate() * heading).imag > 0.0) == self.same


def _extrusion_distance(surface: Extrusion, strand: Strand) -> float:
    if isinstance(strand, Arc):
        return math.inf
    return min(
        spline_distance(surface.curve, strand), spline_distance(surface.curve, strand.reversed())
    )


def _middle(arc: Arc) -> complex:
    """The middle of an arc, at which it is compared with surfaces and their senses."""
    return complex(arc.points_by_share(np.array([0.5]))[0])


@dataclass(frozen=True, slots=True)
class Solid:
    """The solid in a file.

    Attributes
    ----------
    number : of its instance.
    name : of it.
    products : names of the products in the file.
    unit : of the file [mm].
    uncertainty : that the file states [mm]; None for none.
    faces : of its shell.
    """

    number: int
    name: str
    products: tuple[str, ...]
    unit: float
    uncertainty: float | None
    faces: tuple[Face, ...]

    @classmethod
    def from_bytes(cls, data: bytes) -> Solid:
        """The only solid in a file; FileError unless there is exactly one, and it is upright."""
        model = Model.from_exchange(read_exchange(data))
        others = model.entities(*OTHERS)
        if others:
            raise others[0].fault("only files of one solid, outside of assemblies, can be read")
        solids = model.entities(*SOLIDS)
        if len(solids) != 1:
            raise FileError(f"{len(solids)} solids (MANIFOLD_SOLID_BREP), expected one")
        (solid,) = solids
        context = _context(model, solid.number)
        unit = _unit(model, context)
        shell = model.entity(solid.ref(1), "CLOSED_SHELL")
        builder = _Builder(Geometry(model, unit, _angle(model, context)))
        faces = tuple(builder.face(ref) for ref in shell.refs(1))
        products = tuple(product.text(1) for product in model.entities("PRODUCT"))
        return cls(solid.number, solid.text(0), products, unit, _uncertainty(model, context), faces)

    @property
    def unit_name(self) -> str:
        """Name of the unit of lengths."""
        return NAMES.get(self.unit, f"{self.unit:g} mm")


def _context(model: Model, solid: int) -> int:
    """The context of the representation that holds the solid."""
    holders = [
        holder
        for holder in model.entities("ADVANCED_BREP_SHAPE_REPRESENTATION", "SHAPE_REPRESENTATION")
        if solid in holder.refs(1)
    ]
    if len(holders) != 1:
        raise FileError(f"#{solid}: {len(holders)} representations hold the solid, expected one")
    return holders[0].ref(2)


def _unit(model: Model, context: int) -> float:
    """Millimetres in the unit of length of a context."""
    units = model.entity(context, "GLOBAL_UNIT_ASSIGNED_CONTEXT").refs(0)
    lengths = [ref for ref in units if model.is_a(ref, "LENGTH_UNIT")]
    if len(lengths) != 1:
        raise FileError(f"#{context}: {len(lengths)} units of length, expected one")
    return _millimetres(model, lengths[0])


def _angle(model: Model, context: int) -> float:
    """Radians in the unit of angles of a context; 1 if it states none."""
    for ref in model.entity(context, "GLOBAL_UNIT_ASSIGNED_CONTEXT").refs(0):
        if model.is_a(ref, "PLANE_ANGLE_UNIT") and model.is_a(ref, "CONVERSION_BASED_UNIT"):
            other = model.entity(ref, "CONVERSION_BASED_UNIT").ref(1)
            kinds = ("PLANE_ANGLE_MEASURE_WITH_UNIT", "MEASURE_WITH_UNIT")
            return model.entity(other, *kinds).measure(0)
    return 1.0


def _millimetres(model: Model, ref: int) -> float:
    """Millimetres in a unit of length."""
    factor = 1.0
    for _ in range(CONVERTED):
        entity = model.entity(ref, "SI_UNIT", "CONVERSION_BASED_UNIT")
        if entity.kind == "SI_UNIT":
            prefix = None if entity.values[:1] == (None,) else entity.word(0)
            if entity.word(1) != "METRE" or prefix not in PREFIXES:
                raise entity.fault("is not a unit of length that can be read")
            size = factor * PREFIXES[prefix]
            if not 1e-6 <= size <= 1e6:
                raise entity.fault(f"is {size:g} mm")
            return size
        measure = model.entity(entity.ref(1), "LENGTH_MEASURE_WITH_UNIT", "MEASURE_WITH_UNIT")
        factor *= measure.measure(0)
        ref = measure.ref(1)
    raise FileError(f"#{ref}: units are defined by other units more than {CONVERTED} times")


def _uncertainty(model: Model, context: int) -> float | None:
    """The first uncertainty of lengths [mm]; None if there is none."""
    if not model.is_a(context, "GLOBAL_UNCERTAINTY_ASSIGNED_CONTEXT"):
        return None
    for ref in model.entity(context, "GLOBAL_UNCERTAINTY_ASSIGNED_CONTEXT").refs(0):
        measure = model.entity(ref, "UNCERTAINTY_MEASURE_WITH_UNIT")
        if model.is_a(measure.ref(1), "LENGTH_UNIT"):
            return measure.measure(0) * _millimetres(model, measure.ref(1))
    return None


@dataclass(frozen=True, slots=True)
class _Builder:
    """Builds faces; edges that are shared are built once."""

    geometry: Geometry
    edges: dict[int, Edge] = field(default_factory=dict)
    used: set[int] = field(default_factory=set)

    def face(self, ref: int) -> Face:
        self._once(ref)
        entity = self.geometry.model.entity(ref, "ADVANCED_FACE", "FACE_SURFACE")
        surface = self.geometry.surface(entity.ref(2))
        loops = tuple(self._loop(bound) for bound in entity.refs(1))
        if not loops:
            raise entity.fault("has no bounds")
        return Face(ref, entity.text(0), surface, entity.flag(3), loops)

    def _once(self, ref: int) -> None:
        """Raise FileError if a part of the shell appears for the second time."""
        if ref in self.used:
            raise FileError(f"#{ref} appears twice in the shell")
        self.used.add(ref)

    def _loop(self, ref: int) -> tuple[Use, ...]:
        self._once(ref)
        bound = self.geometry.model.entity(ref, "FACE_OUTER_BOUND", "FACE_BOUND")
        loop = self.geometry.model.entity(bound.ref(1), "EDGE_LOOP")
        uses = tuple(self._use(edge) for edge in loop.refs(1))
        if not uses:
            raise loop.fault("has no edges")
        if bound.flag(2):
            return uses
        # A bound may be stated against the sense of its loop.
        return tuple(Use(use.edge, not use.forward) for use in uses[::-1])

    def _use(self, ref: int) -> Use:
        self._once(ref)
        entity = self.geometry.model.entity(ref, "ORIENTED_EDGE")
        number = entity.ref(3)
        if number not in self.edges:
            self.edges[number] = self._edge(number)
        return Use(self.edges[number], entity.flag(4))

    def _edge(self, ref: int) -> Edge:
        entity = self.geometry.model.entity(ref, "EDGE_CURVE")
        ends = (int(entity.ref(1)), int(entity.ref(2)))
        places = (self._vertex(ends[0]), self._vertex(ends[1]))
        start, end = places
        curve, same = self.geometry.curve(entity.ref(3)), entity.flag(4)
        if abs(end.z - start.z) > STEEP * abs(end.place - start.place):
            gap = rising_gap(curve, *places, same=same)
            return Edge(ref, ends, places, (), gap, curve if isinstance(curve, Parabola) else None)
        strands, gap = edge_strands(curve, start, end, same=same)
        return Edge(ref, ends, places, strands, max(gap, abs(end.z - start.z)))

    def _vertex(self, ref: int) -> Point:
        return self.geometry.point(self.geometry.model.entity(ref, "VERTEX_POINT").ref(1))


# -- parabola -------------------------------------------------------------------------------------
# The edges between chamfers that meet at a corner of a line and an arc.


@dataclass(frozen=True, slots=True)
class Point:
    """A place and its height [mm]."""

    place: complex
    z: float


@dataclass(frozen=True, slots=True)
class Parabola:
    """A whole parabola between two heights, by its three control points."""

    start: Point
    middle: Point
    end: Point

    def evaluate(self, share: float) -> Point:
        """The point at a parameter from 0 to 1."""
        weights = ((1.0 - share) ** 2, 2.0 * share * (1.0 - share), share**2)
        points = (self.start, self.middle, self.end)
        return Point(
            sum(weight * point.place for weight, point in zip(weights, points, strict=True)),
            sum(weight * point.z for weight, point in zip(weights, points, strict=True)),
        )

    @property
    def _heights(self) -> tuple[float, float]:
        """The coefficients of the square and of the first power of the parameter in the height."""
        low, middle, high = self.start.z, self.middle.z, self.end.z
        return low - 2.0 * middle + high, 2.0 * (middle - low)

    @property
    def turning(self) -> float:
        """The height [mm] at which the curve is level; infinite if it is nowhere."""
        square, along = self._heights
        return self.start.z - along**2 / (4.0 * square) if square else math.inf

    @property
    def is_monotonic(self) -> bool:
        """Whether it rises all the way, or falls."""
        low, high = sorted((self.start.z, self.end.z))
        return low < self.middle.z < high and not low <= self.turning <= high

    def section_point(self, z: float) -> complex:
        """The place [mm] at a height `z` [mm] between its ends, if it is monotonic."""
        square, along = self._heights
        height = z - self.start.z
        # The root of a t^2 + b t = h in the form that holds for a = 0 as well. The slope b at the
        # start has the sign of the direction, so nothing cancels.
        root = math.sqrt(max(along**2 + 4.0 * square * height, 0.0))
        return self.evaluate(
            2.0 * height / (along + math.copysign(root, self.end.z - self.start.z))
        ).place

    def distance_to_ends(self, start: Point, end: Point) -> float:
        """The larger distance [mm] of two points from its ends; infinite if it rises and falls."""
        if not self.is_monotonic:
            return math.inf
        pairs = ((self.start, start), (self.end, end))
        return max(math.hypot(abs(a.place - b.place), a.z - b.z) for a, b in pairs)


# -- curves ---------------------------------------------------------------------------------------
# Curves and surfaces of solids along Z: level lines, circles and splines, walls and chamfers.
#
# Places are complex in the plane XY, heights apart; all lengths in mm.


Strand = Arc | CubicSpline

ALIGNED = 1e-9
"""Sine of the angle by which a direction may miss Z or the plane XY."""

RATIONAL = 1e-12
"""Weights that differ by a larger fraction make a spline rational."""

KNOTS = 100_000
"""Most knots of a spline with all multiplicities."""


@dataclass(frozen=True, slots=True)
class StraightLine:
    """A straight line."""

    origin: Point
    way: Point


@dataclass(frozen=True, slots=True)
class Circle:
    """A level circle; `turns` is 1 where it runs counter-clockwise seen from above, else -1."""

    centre: Point
    radius: float
    turns: float


@dataclass(frozen=True, slots=True)
class Spline:
    """A level spline."""

    curve: CubicSpline
    z: float


Curve = StraightLine | Circle | Spline | Parabola


@dataclass(frozen=True, slots=True)
class Plane:
    """A plane, level, upright or inclined."""

    origin: Point
    normal: Point


@dataclass(frozen=True, slots=True)
class Cylinder:
    """A cylinder along Z; its normal points away from the axis."""

    centre: complex
    radius: float


@dataclass(frozen=True, slots=True)
class Cone:
    """A cone about an axis along Z; its normal points away from the axis.

    Attributes
    ----------
    centre : of the axis.
    radius : at the height `z` [mm].
    rise : by how much the radius grows with the height [mm/mm].
    """

    centre: complex
    radius: float
    z: float
    rise: float

    def section_radius(self, z: float) -> float:
        """Radius at a height [mm]."""
        return self.radius + self.rise * (z - self.z)


@dataclass(frozen=True, slots=True)
class Extrusion:
    """A spline that is extruded along Z, upwards for the `sense` 1, downwards for -1; the normal is
    to the right of the curve if upwards.
    """

    curve: CubicSpline
    sense: float


Surface = Plane | Cylinder | Cone | Extrusion


@dataclass(frozen=True, slots=True)
class Geometry:
    """Reads geometry in units of `scale` mm and of `angle` rad."""

    model: Model
    scale: float
    angle: float = 1.0

    def point(self, ref: int) -> Point:
        """A point [mm]."""
        x, y, z = self._triple(self.model.entity(ref, "CARTESIAN_POINT"))
        return Point(complex(x, y) * self.scale, z * self.scale)

    def direction(self, ref: int) -> Point:
        """A direction of length 1."""
        entity = self.model.entity(ref, "DIRECTION")
        x, y, z = self._triple(entity)
        size = math.hypot(x, y, z)
        if not size > 0.0:
            raise entity.fault("is of length 0")
        return Point(complex(x / size, y / size), z / size)

    def axes(self, ref: int) -> tuple[Point, Point]:
        """Origin and third axis of a placement; without a third axis it is Z. Where the first axis
        points does not matter here.
        """
        entity = self.model.entity(ref, "AXIS2_PLACEMENT_3D")
        axis, first = (
            self.direction(entity.ref(place))
            if entity.values[place : place + 1] != (None,)
            else None
            for place in (2, 3)
        )
        axis = axis or Point(0j, 1.0)
        if first is not None:
            along = (first.place * axis.place.conjugate()).real + first.z * axis.z
            if not abs(along) < 1.0 - ALIGNED:
                raise entity.fault("has a first axis parallel to its third axis")
        return self.point(entity.ref(1)), axis

    def curve(self, ref: int) -> Curve:
        """The curve of an edge; of a curve that is given on surfaces too, the one in space."""
        entity = self.model.entity(
            ref, "LINE", "CIRCLE", "B_SPLINE_CURVE_WITH_KNOTS", "SURFACE_CURVE", "SEAM_CURVE"
        )
        if entity.kind in ("SURFACE_CURVE", "SEAM_CURVE"):
            entity = self.model.entity(entity.ref(1), "LINE", "CIRCLE", "B_SPLINE_CURVE_WITH_KNOTS")
        if entity.kind == "LINE":
            vector = self.model.entity(entity.ref(2), "VECTOR")
            return StraightLine(self.point(entity.ref(1)), self.direction(vector.ref(1)))
        if entity.kind == "CIRCLE":
            centre, axis = self.axes(entity.ref(1))
            if abs(axis.place) > ALIGNED:
                raise entity.fault("is not level: only upright solids can be read")
            # It runs counter-clockwise about its axis, which may point down.
            return Circle(centre, self._radius(entity), math.copysign(1.0, axis.z))
        return self._spline(entity.number)

    def surface(self, ref: int) -> Surface:
        """The surface of a face."""
        entity = self.model.entity(
            ref, "PLANE", "CYLINDRICAL_SURFACE", "CONICAL_SURFACE", "SURFACE_OF_LINEAR_EXTRUSION"
        )
        if entity.kind == "SURFACE_OF_LINEAR_EXTRUSION":
            way = self.direction(self.model.entity(entity.ref(2), "VECTOR").ref(1))
            if abs(way.place) > ALIGNED:
                raise entity.fault("is not extruded along Z")
            curve = self.curve(entity.ref(1))
            if not isinstance(curve, Spline):
                raise entity.fault("does not extrude a spline")
            return Extrusion(curve.curve, math.copysign(1.0, way.z))
        origin, axis = self.axes(entity.ref(1))
        if entity.kind == "PLANE":
            return Plane(origin, axis)
        if abs(axis.place) > ALIGNED:
            raise entity.fault("does not stand along Z: only upright solids can be read")
        if entity.kind == "CYLINDRICAL_SURFACE":
            return Cylinder(origin.place, self._radius(entity))
        angle = entity.real(3) * self.angle
        if not 0.0 < angle < 0.5 * math.pi:
            raise entity.fault("has a half angle that is not between 0 and 90 degrees")
        # The radius of a cone grows along its axis, which may point down.
        radius = entity.real(2) * self.scale
        return Cone(origin.place, radius, origin.z, math.copysign(math.tan(angle), axis.z))

    def _triple(self, entity: Entity) -> list[float]:
        numbers = entity.numbers(1)
        if len(numbers) != 3:
            raise entity.fault("does not have three coordinates")
        return numbers

    def _radius(self, entity: Entity) -> float:
        radius = entity.real(2) * self.scale
        if not radius > 0.0:
            raise entity.fault("has no radius above 0")
        return radius

    def _spline(self, ref: int) -> Spline | Parabola | StraightLine:
        """A spline with its knots; of several types, as those with weights are, or of one."""
        knots = self.model.entity(ref, "B_SPLINE_CURVE_WITH_KNOTS")
        # In an instance of several types the parameters are divided among them; in one of a single
        # type the name comes first, and the knots follow six other parameters.
        if self.model.is_a(ref, "B_SPLINE_CURVE"):
            shape, first = self.model.entity(ref, "B_SPLINE_CURVE"), 0
        else:
            shape, first = knots, 1
        place = 0 if shape is not knots else 6
        if self.model.is_a(ref, "RATIONAL_B_SPLINE_CURVE"):
            weights = self.model.entity(ref, "RATIONAL_B_SPLINE_CURVE").numbers(0)
            if not weights or max(weights) - min(weights) > RATIONAL * max(map(abs, weights)):
                raise knots.fault("is rational: its weights differ")
        points = [self.point(ref) for ref in shape.refs(first + 1)]
        heights = [point.z for point in points] or [0.0]
        if max(heights) - min(heights) > ALIGNED:
            # Degree, multiplicities and number of control points.
            form = [shape.real(first), *knots.numbers(place), len(points)]
            if form == [2, 3, 3, 3]:
                return Parabola(*points)
            if form == [1, 2, 2, 2]:
                return _through(*points)
            raise knots.fault("is not level: only upright solids can be read")
        counts = [int(count) for count in knots.numbers(place)]
        values = knots.numbers(place + 1)
        whole = min(counts, default=0) >= 1 and sum(counts) <= KNOTS
        if len(counts) != len(values) or not whole:
            raise knots.fault("does not have as many knots as multiplicities above 0")
        degree = int(shape.real(first))
        try:
            curve = CubicSpline.from_bspline(
                degree,
                np.repeat(values, counts).astype(np.float64),
                np.array([point.place for point in points], dtype=np.complex128),
            )
        except (GeometryError, IndexError) as error:
            raise knots.fault(f"is not a spline that can be read: {error}") from None
        return Spline(curve, heights[0])


def _through(one: Point, other: Point) -> StraightLine:
    """The line through two points of different heights."""
    along, rise = other.place - one.place, other.z - one.z
    size = math.hypot(abs(along), rise)
    return StraightLine(one, Point(along / size, rise / size))


def edge_strands(
    curve: Curve, start: Point, end: Point, *, same: bool
) -> tuple[tuple[Strand, ...], float]:
    """The pieces of a level edge from `start` to `end`, arcs of half a turn at most, and how far
    [mm] its ends are from the curve.

    `same` says whether it has the direction of the curve. Raises FileError if it ends on the way
    along a spline.
    """
    if isinstance(curve, StraightLine):
        along = end.place - start.place
        gap = max(_line_distance(curve, point) for point in (start, end))
        backwards = (along * curve.way.place.conjugate()).real < 0.0
        if backwards == same:  # it runs the other way
            gap = math.inf
        return (Arc(start.place, end.place, 0.0, 0j),), gap
    if isinstance(curve, Parabola):
        return (Arc(start.place, end.place, 0.0, 0j),), math.inf
    if isinstance(curve, Spline):
        spline = curve.curve if same else curve.curve.reversed()
        gap = max(
            abs(spline.start - start.place),
            abs(spline.end - end.place),
            abs(curve.z - start.z),
            abs(curve.z - end.z),
        )
        return (spline.with_ends(start.place, end.place),), gap
    return _circle_arcs(curve, start, end, same=same)


def _circle_arcs(
    circle: Circle, start: Point, end: Point, *, same: bool
) -> tuple[tuple[Strand, ...], float]:
    centre = circle.centre.place
    turns = circle.turns if same else -circle.turns
    arms = (start.place - centre, end.place - centre)
    gap = max(
        *(abs(abs(arm) - circle.radius) for arm in arms),
        *(abs(point.z - circle.centre.z) for point in (start, end)),
    )
    if not min(map(abs, arms)) > 0.0:
        raise FileError("an edge ends in the centre of its circle")
    turned = phase(arms[1] / arms[0]) * turns % (2.0 * math.pi)
    # An edge whose ends coincide is the whole circle.
    sweep = turned if start != end and turned > 0.0 else 2.0 * math.pi
    count = 1 if sweep <= math.pi * (1.0 + ALIGNED) else 2
    # Inner ends lie on the circle itself, even if the ends of the edge miss it.
    inner = [
        centre + circle.radius * arms[0] / abs(arms[0]) * cmath.exp(1j * turns * sweep * k / count)
        for k in range(1, count)
    ]
    places = pairwise([start.place, *inner, end.place])
    return tuple(Arc(a, b, turns * sweep / count, centre) for a, b in places), gap


def _line_distance(line: StraightLine, point: Point) -> float:
    """Distance [mm] of a point from a line."""
    place, z = point.place - line.origin.place, point.z - line.origin.z
    way = line.way
    along = (place * way.place.conjugate()).real + z * way.z
    return math.hypot(abs(place - along * way.place), z - along * way.z)


def rising_gap(line: Curve, start: Point, end: Point, *, same: bool) -> float:
    """How far [mm] the ends of an edge between two heights are from its line or parabola; infinite
    for any other curve, or if the line runs the other way.
    """
    if isinstance(line, Parabola):
        return line.distance_to_ends(*((start, end) if same else (end, start)))
    if not isinstance(line, StraightLine) or ((end.z - start.z) * line.way.z > 0.0) != same:
        return math.inf
    return max(_line_distance(line, point) for point in (start, end))


def surface_distance(surface: Surface, place: complex, z: float) -> float:
    """Distance [mm] of a point from a surface; 0 for an extrusion, see `spline_distance`."""
    if isinstance(surface, Plane):
        offset, normal = place - surface.origin.place, surface.normal
        return abs((offset * normal.place.conjugate()).real + (z - surface.origin.z) * normal.z)
    if isinstance(surface, Cylinder):
        return abs(abs(place - surface.centre) - surface.radius)
    if isinstance(surface, Cone):
        across = abs(abs(place - surface.centre) - surface.section_radius(z))
        return across / math.hypot(1.0, surface.rise)
    return 0.0


def spline_distance(one: CubicSpline, other: CubicSpline) -> float:
    """Bound [mm] on the distance between two splines, by their control points; infinite if they do
    not have the same knots up to scale.
    """
    if len(one.knots) != len(other.knots) or len(one.controls) != len(other.controls):
        return math.inf
    scale = (one.knots[-1] - one.knots[0]) / (other.knots[-1] - other.knots[0])
    shifted = one.knots[0] + (other.knots - other.knots[0]) * scale
    if np.max(np.abs(shifted - one.knots)) > RATIONAL * (one.knots[-1] - one.knots[0]):
        return math.inf
    # With the same knots the difference is a spline too, which its control points enclose.
    return float(np.max(np.abs(one.controls - other.controls)))


# -- model ----------------------------------------------------------------------------------------
# Instances by their types, with the parameters that geometry needs.


Kind = TypeVar("Kind")


@dataclass(frozen=True, slots=True)
class Entity:
    """One type of an instance, with its parameters by their places."""

    number: int
    kind: str
    values: tuple[Any, ...]

    def fault(self, message: str) -> FileError:
        """An error that names the instance and its type."""
        return FileError(f"#{self.number}, {self.kind}: {message}")

    def _typed_value(self, place: int, kind: type[Kind], what: str) -> Kind:
        value = self.values[place] if place < len(self.values) else None
        if not isinstance(value, kind):
            raise self.fault(f"parameter {place + 1} is not {what}")
        return value

    def ref(self, place: int) -> Ref:
        """A reference."""
        return self._typed_value(place, Ref, "a reference")

    def text(self, place: int) -> str:
        """A text."""
        return self._typed_value(place, str, "a text")

    def word(self, place: int) -> str:
        """An enumeration."""
        return self._typed_value(place, Word, "an enumeration")

    def flag(self, place: int) -> bool:
        """A truth value."""
        word = self.word(place)
        if word not in ("T", "F"):
            raise self.fault(f"parameter {place + 1} is not .T. or .F.")
        return word == "T"

    def real(self, place: int) -> float:
        """A number."""
        return self._number(self.values[place] if place < len(self.values) else None, place)

    def measure(self, place: int) -> float:
        """The number in a measure that names its type."""
        record = self._typed_value(place, Record, "a measure")
        return self._number(record.values[0] if len(record.values) == 1 else None, place)

    def _number(self, value: Any, place: int) -> float:
        if isinstance(value, Ref) or not isinstance(value, int | float):
            raise self.fault(f"parameter {place + 1} is not a number")
        return float(value)

    def row(self, place: int) -> tuple[Any, ...]:
        """A list."""
        return self._typed_value(place, tuple, "a list")

    def refs(self, place: int) -> tuple[Ref, ...]:
        """A list of references."""
        members = self.row(place)
        if not all(isinstance(member, Ref) for member in members):
            raise self.fault(f"parameter {place + 1} is not a list of references")
        return members

    def numbers(self, place: int) -> list[float]:
        """A list of numbers."""
        return [self._number(member, place) for member in self.row(place)]


@dataclass(frozen=True, slots=True)
class Model:
    """The instances of a file."""

    instances: dict[int, tuple[Record, ...]]

    @classmethod
    def from_exchange(cls, exchange: Exchange) -> Model:
        """The model of a file; FileError if an instance refers to one that is not there."""
        for number, records in exchange.instances.items():
            for ref in references(records):
                if ref not in exchange.instances:
                    raise FileError(f"#{number} refers to #{ref}, which does not exist")
        return cls(exchange.instances)

    def entity(self, ref: int, *kinds: str) -> Entity:
        """An instance as the first of the `kinds` that it has; FileError if it has none of them."""
        records = {record.kind: record for record in self.instances[ref]}
        for kind in kinds:
            if kind in records:
                return Entity(ref, kind, records[kind].values)
        raise FileError(f"#{ref} is {' '.join(records) or 'nothing'}, not {' or '.join(kinds)}")

    def is_a(self, ref: int, kind: str) -> bool:
        """Whether an instance is of a type."""
        return any(record.kind == kind for record in self.instances[ref])

    def entities(self, *kinds: str) -> list[Entity]:
        """All instances of these types, in the order of the file."""
        return [
            Entity(number, record.kind, record.values)
            for number, records in self.instances.items()
            for record in records
            if record.kind in kinds
        ]


def references(records: tuple[Record, ...]) -> Iterator[Ref]:
    """All references in the parameters of records."""
    left: list[Any] = list(records)
    while left:
        value = left.pop()
        if isinstance(value, Ref):
            yield value
        elif isinstance(value, tuple):
            left.extend(value)
        elif isinstance(value, Record):
            left.extend(value.values)
