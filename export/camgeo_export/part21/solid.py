"""The solid in a file: its faces, their loops of edges, and the vertices."""

from __future__ import annotations

from dataclasses import dataclass, field

from camgeo_export.errors import FileError
from camgeo_export.part21.curves import (
    Geometry,
    Strand,
    Surface,
    off_rising,
    strands_of,
)
from camgeo_export.part21.model import Entity, Model
from camgeo_export.part21.parabola import Parabola, Point

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
"""Types of shapes, and of places in assemblies, that a file of one solid has none of."""

STEEP = 0.1
"""Rise of an edge, by its extent in the plane, from which on it is not a level one."""

PREFIXES = {None: 1000.0, "MILLI": 1.0, "CENTI": 10.0, "DECI": 100.0, "MICRO": 1e-3, "KILO": 1e6}
"""Millimetres in a metre with a prefix."""

CONVERTED = 3
"""Units that may be stated by others, one after the other."""

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
    off : how far its ends are from its curve [mm].
    bend : the curve of one that rises along a parabola, in whichever direction.
    """

    number: int
    ends: tuple[int, int]
    places: tuple[Point, Point]
    strands: tuple[Strand, ...]
    off: float
    bend: Parabola | None = None

    @property
    def z(self) -> float:
        """Height of a level edge [mm]."""
        return self.places[0].z


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
    def told(self) -> str:
        """Its number and name in messages."""
        return f"face #{self.number}" + (f" ({self.name[:40]})" if self.name else "")


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

    @property
    def unit_name(self) -> str:
        """The name of its unit."""
        return NAMES.get(self.unit, f"{self.unit:g} mm")


def solid_of(model: Model) -> Solid:
    """The only solid of a file; FileError if there are others, or it is not an upright one."""
    others = model.all_of(*OTHERS)
    if others:
        raise others[0].fault("only files of one solid, in its own place, can be read")
    solids = model.all_of(*SOLIDS)
    if len(solids) != 1:
        raise FileError(f"{len(solids)} solids (MANIFOLD_SOLID_BREP), expected one")
    (solid,) = solids
    context = _context(model, solid.number)
    unit = _unit(model, context)
    shell = model.entity(solid.ref(1), "CLOSED_SHELL")
    builder = _Builder(model, Geometry(model, unit, _angle(model, context)))
    faces = tuple(builder.face(ref) for ref in shell.refs(1))
    products = tuple(each.text(1) for each in model.all_of("PRODUCT"))
    uncertainty = _uncertainty(model, context)
    return Solid(solid.number, solid.text(0), products, unit, uncertainty, faces)


def _context(model: Model, solid: int) -> int:
    """The context of the representation that holds the solid."""
    holders = [
        each
        for each in model.all_of("ADVANCED_BREP_SHAPE_REPRESENTATION", "SHAPE_REPRESENTATION")
        if solid in each.refs(1)
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
        found = model.entity(ref, "SI_UNIT", "CONVERSION_BASED_UNIT")
        if found.kind == "SI_UNIT":
            return _checked(found, factor * _metres(found))
        measure = model.entity(found.ref(1), "LENGTH_MEASURE_WITH_UNIT", "MEASURE_WITH_UNIT")
        factor *= measure.measure(0)
        ref = measure.ref(1)
    raise FileError(f"#{ref}: units are stated by units more than {CONVERTED} times")


def _metres(unit: Entity) -> float:
    """Millimetres in a unit of the SI."""
    prefix = None if unit.values[:1] == (None,) else unit.word(0)
    if unit.word(1) != "METRE" or prefix not in PREFIXES:
        raise unit.fault("is not a unit of length that can be read")
    return PREFIXES[prefix]


def _checked(unit: Entity, size: float) -> float:
    if not 1e-6 <= size <= 1e6:
        raise unit.fault(f"is {size:g} mm")
    return size


def _uncertainty(model: Model, context: int) -> float | None:
    """The first uncertainty of lengths [mm]; None if there is none."""
    if not model.is_a(context, "GLOBAL_UNCERTAINTY_ASSIGNED_CONTEXT"):
        return None
    for ref in model.entity(context, "GLOBAL_UNCERTAINTY_ASSIGNED_CONTEXT").refs(0):
        found = model.entity(ref, "UNCERTAINTY_MEASURE_WITH_UNIT")
        if model.is_a(found.ref(1), "LENGTH_UNIT"):
            return found.measure(0) * _millimetres(model, found.ref(1))
    return None


@dataclass(frozen=True, slots=True)
class _Builder:
    """Builds faces; edges that are shared are built once."""

    model: Model
    geometry: Geometry
    edges: dict[int, Edge] = field(default_factory=dict)
    used: set[int] = field(default_factory=set)

    def face(self, ref: int) -> Face:
        self._once(ref)
        found = self.model.entity(ref, "ADVANCED_FACE", "FACE_SURFACE")
        surface = self.geometry.surface(found.ref(2))
        loops = tuple(self._loop(bound) for bound in found.refs(1))
        if not loops:
            raise found.fault("has no bounds")
        return Face(ref, found.text(0), surface, found.flag(3), loops)

    def _once(self, ref: int) -> None:
        """Raise FileError if a part of the shell is there for the second time."""
        if ref in self.used:
            raise FileError(f"#{ref} is in the shell twice")
        self.used.add(ref)

    def _loop(self, ref: int) -> tuple[Use, ...]:
        self._once(ref)
        bound = self.model.entity(ref, "FACE_OUTER_BOUND", "FACE_BOUND")
        loop = self.model.entity(bound.ref(1), "EDGE_LOOP")
        uses = tuple(self._use(each) for each in loop.refs(1))
        if not uses:
            raise loop.fault("has no edges")
        if bound.flag(2):
            return uses
        return tuple(Use(use.edge, not use.forward) for use in uses[::-1])

    def _use(self, ref: int) -> Use:
        self._once(ref)
        found = self.model.entity(ref, "ORIENTED_EDGE")
        number = found.ref(3)
        if number not in self.edges:
            self.edges[number] = self._edge(number)
        return Use(self.edges[number], found.flag(4))

    def _edge(self, ref: int) -> Edge:
        found = self.model.entity(ref, "EDGE_CURVE")
        ends = (int(found.ref(1)), int(found.ref(2)))
        places = (self._vertex(ends[0]), self._vertex(ends[1]))
        start, end = places
        curve, same = self.geometry.curve(found.ref(3)), found.flag(4)
        if abs(end.z - start.z) > STEEP * abs(end.place - start.place):
            off = off_rising(curve, *places, same=same)
            return Edge(ref, ends, places, (), off, curve if isinstance(curve, Parabola) else None)
        strands, off = strands_of(curve, start, end, same=same)
        return Edge(ref, ends, places, strands, max(off, abs(end.z - start.z)))

    def _vertex(self, ref: int) -> Point:
        return self.geometry.point(self.model.entity(ref, "VERTEX_POINT").ref(1))


def swept(face: Face) -> tuple[float, float]:
    """The lowest and the highest place of a face [mm]."""
    heights = [point.z for loop in face.loops for use in loop for point in use.edge.places]
    return min(heights), max(heights)
