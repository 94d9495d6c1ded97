"""STEP, AP242: the part as one solid between cylinders and planes, or splines drawn out.

Its walls follow the same lines, arcs or splines as the drawing, its edges are shared, and faces
have the names of the part's boundaries and levels. The lower face is at Z = 0.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import groupby, pairwise
from typing import Union

import numpy as np

from camgeo.design.drawn import TOPOLOGY_TOLERANCE
from camgeo.design.product import Product, display_title, solid_products
from camgeo.design.writing import Written
from camgeo.errors import FileError, GeometryError, ToleranceError
from camgeo.geometry.contour.contour import Contour, winding_number
from camgeo.geometry.contour.cubic_proof import approximating_arcs
from camgeo.geometry.contour.parallel import parallel as mitred
from camgeo.geometry.contour.spline import (
    DEGREE,
    Arc,
    CubicSpline,
    SplineContour,
    as_spline_contour,
)
from camgeo.numeric.quadrature import gauss, nodes_for_singularity
from camgeo.part.part import Band, Bevel, Boundary, Level, Part, written_contour
from camgeo.reading import INSTANCES
from camgeo.scene.formats.step import FORMAT
from camgeo.units import MM_PER, LengthUnit, counted
from camgeo_export.solid.prism import contour_gaps, require_gaps
from camgeo_export.verify.step import measure as deviation_of

ENTITIES = 20
"""Entities of a file for each piece of a wall, at least."""


class StepWriter:
    """Writes a STEP file."""

    format = FORMAT
    pieces = staticmethod(solid_products)  # the disc, or the pair that it is one piece with
    measure = staticmethod(deviation_of)

    def write(self, product: Product, tolerance: float) -> Written:
        """The solid, in the unit of the product, within `tolerance` [mm].

        Raises GeometryError with the key of a height that the scene does not give or that is below
        the tolerance, or with the key "part" if walls come closer than the tolerance; FileError if
        the file would be larger than `camgeo.reading` allows.
        """
        part = product.drawn.part
        part.require_steps(tolerance)
        rings = {
            boundary.name: boundary_ring(boundary, product, tolerance)
            for boundary in part.boundaries
        }
        for bevel in part.bevels:
            if bevel.edge.name not in rings:
                rings[bevel.edge.name] = bevel_ring(bevel, rings[bevel.boundary.name])
        pieces = sum(len(rings[band.wall.name].strands) for band in part.bands)
        if ENTITIES * pieces > INSTANCES:  # such a solid would not be read back
            raise FileError(
                f"the solid would have walls of {counted(pieces, 'piece')}, of {ENTITIES} entities"
                f" each; at most {INSTANCES:,} are allowed in a STEP file that is read; a larger"
                " tolerance needs fewer"
            )
        contours = {name: ring.contour for name, ring in rings.items()}
        require_gaps(part, contour_gaps(contours, tolerance), tolerance)
        file = Entities()
        shape = add_product(file, display_title(product))
        context = add_context(file, product.unit)
        pen = Pen(file, MM_PER[product.unit])
        shell = Shell(pen, part, rings)
        solid = file.add("MANIFOLD_SOLID_BREP", display_title(product), shell.add())
        representation = file.add(
            "ADVANCED_BREP_SHAPE_REPRESENTATION",
            display_title(product),
            (pen.axes(0.0), solid),
            context,
        )
        file.add("SHAPE_DEFINITION_REPRESENTATION", shape, representation)
        text = "\n".join([*header(product, tolerance), *file.lines, *END, ""])
        return Written(text.encode("ascii"), _facts(part, rings, len(shell.faces)))


def _facts(part: Part, rings: dict[str, Ring], faces: int) -> dict[str, int | float | str]:
    """How many faces there are, of which kinds the pieces of walls are, and the volume."""
    bands = [(band, rings[band.wall.name].strands) for band in part.bands]
    pieces = {
        upright: [
            piece for band, strands in bands if band.is_upright == upright for piece in strands
        ]
        for upright in (True, False)
    }
    bent, cones = (
        sum(1 for strand in pieces[upright] if isinstance(strand, Arc) and strand.sweep)
        for upright in (True, False)
    )
    splines = sum(not isinstance(strand, Arc) for strand in pieces[True])
    volumes = [_area(band, strands) * (band.z1 - band.z0) for band, strands in bands]
    counts: dict[str, int | float | str] = {"faces": faces, "cylinders": bent}
    counts |= {"cones": cones} if cones else {}
    counts |= {"splines": splines} if splines else {}
    return counts | {"planes": faces - bent - cones - splines, "volume_mm3": math.fsum(volumes)}


def _area(band: Band, strands: tuple[Strand, ...]) -> float:
    """Mean of the area within a band [mm^2] over its height; of a chamfer by Simpson's rule, exact
    for the squares of lengths, and beside mitred corners like `camgeo.part.mass`.
    """
    whole = math.fsum(strand.moment for strand in strands)
    if band.is_upright:
        return whole

    def section_area(share: float) -> float:
        moved = parallel(strands, share * band.width, band.wall.name)
        return math.fsum(strand.moment for strand in moved)

    if (radius := band.wall.corner_radius) is None:
        return (whole + 4.0 * section_area(0.5) + section_area(1.0)) / 6.0
    shares, _, weights = gauss(
        np.zeros(1), np.ones(1), nodes_for_singularity(-1.0 - radius / band.width)
    )
    return 0.5 * math.fsum(
        weight * section_area(share) for weight, share in zip(weights, shares[0], strict=True)
    )


WRITER = StepWriter()


# -- rings ----------------------------------------------------------------------------------------
# The boundaries of a part as rings of strands that STEP can hold.


FLATTEST = 1e7
"""Radius [mm] beyond which an arc is drawn as a line if the tolerance allows: its ends would miss
the circle by the rounding of its centre."""

SAGITTA = 0.01
"""Share of the tolerance by which an arc that is drawn as a line may leave its chord."""


def boundary_ring(boundary: Boundary, product: Product, tolerance: float) -> Ring:
    """A boundary within `tolerance` [mm], material on its left.

    Raises ToleranceError if an arc is so flat that the ends miss its circle by more than the
    uncertainty that the file states.
    """
    form, effort = product.options[FORMAT].walls, product.drawn.effort
    curve = written_contour(boundary, form, effort, tolerance).contour
    if isinstance(curve, Contour):
        contour = _without_flattest(curve, tolerance)
        strands = as_spline_contour(contour).strands
    else:
        # Arcs near the splines suffice to show what lies inside.
        contour = approximating_arcs(curve, TOPOLOGY_TOLERANCE).contour
        strands = _open(curve)
    gap = max((_circle_gap(strand) for strand in strands if isinstance(strand, Arc)), default=0.0)
    if gap > UNCERTAINTY:
        raise ToleranceError(
            f"arcs of the {boundary.name} are too flat for the number format of the file",
            UNCERTAINTY,
            gap,
        )
    if boundary.hole:
        strands = tuple(strand.reversed() for strand in strands[::-1])
    return Ring(strands, contour)


def bevel_ring(bevel: Bevel, wall: Ring) -> Ring:
    """The edge of a chamfer, as far from the ring of its wall as the exact one from the wall."""
    strands = parallel(wall.strands, bevel.width, bevel.boundary.name)
    return Ring(strands, as_contour(strands))


def _without_flattest(contour: Contour, tolerance: float) -> Contour:
    """The contour with the flattest arcs as lines."""
    sagittas = 2.0 * contour.radii * np.sin(0.25 * contour.sweeps) ** 2
    flat = sagittas <= SAGITTA * tolerance
    curved = ~(flat & (contour.radii > FLATTEST))
    return Contour(
        contour.vertices,
        np.where(curved, contour.sweeps, 0.0),
        np.where(curved, contour.centres, 0.0),
    )


def _open(curve: SplineContour) -> tuple[Strand, ...]:
    """The strands of a curve; a single closed spline is divided, as an edge must have two ends."""
    (strand, *others) = curve.strands
    if others or not isinstance(strand, CubicSpline):
        return curve.strands
    inner = strand.knots[(strand.knots > strand.knots[0]) & (strand.knots < strand.knots[-1])]
    return strand.divided(float(inner[len(inner) // 2]))


def _circle_gap(arc: Arc) -> float:
    """The distance [mm] of an arc's ends from the circle that the file states for it."""
    if not arc.sweep:
        return 0.0
    # The radius is the mean of both arms; rounding of the centre adds to their difference.
    return 0.5 * abs(abs(arc.start - arc.centre) - abs(arc.end - arc.centre)) + (
        4.0 * math.ulp(abs(arc.centre))
    )


# -- shell ----------------------------------------------------------------------------------------
# The closed shell of a part: a face for each piece of a wall, and the flat faces with their holes.
#
# Neighbours share their edges, which each uses once in either direction.


@dataclass(frozen=True, slots=True)
class Ring:
    """A boundary of the part as the file has it.

    Attributes
    ----------
    strands : its pieces, one after the other, with the material on their left.
    contour : of lines and arcs, the same or close to it; shows what lies inside.
    """

    strands: tuple[Strand, ...]
    contour: Contour


@dataclass(frozen=True, slots=True)
class FlatFace:
    """A flat face by the names of its boundaries: the outer one first, then those of its holes."""

    names: tuple[str, ...]
    upwards: bool


def flat_faces(level: Level, rings: dict[str, Ring]) -> list[FlatFace]:
    """The faces at one height: each between a ring and those that lie next inside it.

    Along a boundary that ends here the face looks upwards on the side of the material, along one
    that begins it looks downwards there.
    """
    ends = {boundary.name for boundary in level.below}
    holes = {boundary.name for boundary in level.boundaries if boundary.hole}
    names = [boundary.name for boundary in level.boundaries]
    around = {name: _around(name, names, rings) for name in names}
    faces = []
    for name in names:
        # Inside an even number of others a ring bounds a face, inside an odd number a hole.
        if len(around[name]) % 2 == 0:
            inner = [one for one in names if around[one] == {*around[name], name}]
            faces.append(FlatFace((name, *inner), upwards=(name in ends) != (name in holes)))
    return faces


def _around(name: str, names: Sequence[str], rings: dict[str, Ring]) -> set[str]:
    """The names of the rings that enclose the ring `name`."""
    place = complex(rings[name].contour.vertices[0])
    return {one for one in names if one != name and winding_number(rings[one].contour, place)}


def require_one_body(part: Part, faces: dict[float, list[FlatFace]]) -> None:
    """Raise GeometryError if walls do not connect all flat faces, given by their heights."""
    groups: dict[tuple[float, FlatFace], set[tuple[float, FlatFace]]] = {}
    for z, flat in faces.items():
        groups |= {(z, face): {(z, face)} for face in flat}
    for bands in wall_bands(part):
        feet = (bands[0].z0, bands[0].lower.name), (bands[-1].z1, bands[-1].upper.name)
        one, other = (
            groups[z, next(face for face in faces[z] if name in face.names)] for z, name in feet
        )
        # A wall connects its two faces, and with them all that is connected already.
        if one is not other:
            one |= other
            groups |= dict.fromkeys(other, one)
    if len({id(group) for group in groups.values()}) > 1:
        raise GeometryError(
            "a STEP file holds one body without closed cavities, which this part is not", key="part"
        )


def wall_bands(part: Part) -> list[list[Band]]:
    """The bands of each wall, from its lower to its upper end."""
    walls: list[list[Band]] = []
    for band in part.bands:
        if walls and walls[-1][-1].wall is band.wall and walls[-1][-1].z1 == band.z0:
            walls[-1].append(band)
        else:
            walls.append([band])
    return walls


class Shell:
    """Adds the faces of a part, its lowest one at Z = 0."""

    def __init__(self, pen: Pen, part: Part, rings: dict[str, Ring]) -> None:
        self.pen = pen
        self.part = part
        self.rings = rings
        self.bottom = part.levels[0].z
        self.edges: dict[tuple[str, float], list[Ref]] = {}
        self.faces: list[Ref] = []

    def add(self) -> Ref:
        """Add the shell; GeometryError if the part would need several."""
        flat = {level.z: flat_faces(level, self.rings) for level in self.part.levels}
        require_one_body(self.part, flat)
        for bands in wall_bands(self.part):
            if len(bands) == 1:
                self._wall(bands[0])
            else:
                self._bevelled(bands)
        for level in self.part.levels:
            ends = {boundary.name for boundary in level.below}
            for face in flat[level.z]:
                self._flat(level, face, ends)
        return self.pen.file.add("CLOSED_SHELL", "", self.faces)

    def _bevelled(self, bands: Sequence[Band]) -> None:
        """Add the faces of a wall with chamfers, from below, and all edges between them."""
        ends = [(bands[0].lower.name, bands[0].z0), *((band.upper.name, band.z1) for band in bands)]
        rows = [add_row(self.pen, self.rings[name].strands, z - self.bottom) for name, z in ends]
        for band, (lower, upper) in zip(bands, pairwise(rows), strict=True):
            edge = band.upper if band.lower is band.wall else band.lower
            posts = add_posts(self.pen, lower, upper)
            for k in range(len(posts)):
                following = (k + 1) % len(posts)
                around = [
                    (lower.edges[k], True),
                    (posts[following], True),
                    (upper.edges[k], False),
                    (posts[k], False),
                ]
                surface, outwards = add_surface(self.pen, lower, upper, k)
                self._face(edge.name, [self._loop(around)], surface, outwards)
        for end, row in zip(ends, rows, strict=True):
            self.edges[end] = row.edges

    def _wall(self, wall: Band) -> None:
        """Add the faces along a boundary, and their edges above and below."""
        name, file = wall.wall.name, self.pen.file
        strands = self.rings[name].strands
        heights = (wall.z0 - self.bottom, wall.z1 - self.bottom)
        points = [[self.pen.point(strand.start, z) for strand in strands] for z in heights]
        feet, heads = ([file.add("VERTEX_POINT", "", point) for point in row] for row in points)
        posts = [
            file.add("EDGE_CURVE", "", feet[k], heads[k], self.pen.post(point), flag(True))
            for k, point in enumerate(points[0])
        ]
        lower, upper = [], []
        for k, strand in enumerate(strands):
            following = (k + 1) % len(strands)
            ends = [Ends(z, row[k], row[following]) for z, row in zip(heights, points, strict=True)]
            (below, above), surface, ahead = self.pen.piece(strand, *ends)
            lower.append(file.add("EDGE_CURVE", "", feet[k], feet[following], below, flag(ahead)))
            upper.append(file.add("EDGE_CURVE", "", heads[k], heads[following], above, flag(ahead)))
            around = [
                (lower[k], True),
                (posts[following], True),
                (upper[k], False),
                (posts[k], False),
            ]
            self._face(name, [self._loop(around)], surface, ahead)
        self.edges |= {(name, wall.z0): lower, (name, wall.z1): upper}

    def _flat(self, level: Level, face: FlatFace, ends: set[str]) -> None:
        """Add one flat face. A wall that ends here uses their common edges backwards, so the face
        uses them forwards; along a wall that begins here it is the other way round.
        """
        loops = []
        for name in face.names:
            edges = [(edge, name in ends) for edge in self.edges[name, level.z]]
            loops.append(self._loop(edges if name in ends else edges[::-1]))
        axes = self.pen.axes(level.z - self.bottom, UPWARDS if face.upwards else DOWNWARDS)
        self._face(level.name, loops, self.pen.file.add("PLANE", "", axes), same=True)

    def _loop(self, edges: Iterable[tuple[Ref, bool]]) -> Ref:
        file = self.pen.file
        uses = [
            file.add("ORIENTED_EDGE", "", DERIVED, DERIVED, edge, flag(forward))
            for edge, forward in edges
        ]
        return file.add("EDGE_LOOP", "", uses)

    def _face(self, name: str, loops: list[Ref], surface: Ref, same: bool) -> None:
        kinds = ["FACE_OUTER_BOUND", *["FACE_BOUND"] * (len(loops) - 1)]
        bounds = [
            self.pen.file.add(kind, "", loop, flag(True))
            for kind, loop in zip(kinds, loops, strict=True)
        ]
        self.faces.append(self.pen.file.add("ADVANCED_FACE", name, bounds, surface, flag(same)))


# -- geometry -------------------------------------------------------------------------------------
# Points, curves and surfaces of a STEP file, from strands in the plane and heights.
#
# What is shared is shared because it is the same by construction, never because two computed
# numbers happen to be equal: on another processor they might not be.


Strand = Arc | CubicSpline

UPWARDS, DOWNWARDS, ACROSS = (0.0, 0.0, 1.0), (0.0, 0.0, -1.0), (1.0, 0.0, 0.0)


@dataclass(frozen=True, slots=True)
class Ends:
    """The points at both ends of a strand at one height [mm]."""

    z: float
    start: Ref
    end: Ref


@dataclass(frozen=True, slots=True)
class Pen:
    """What adds geometry to a file in its unit.

    Attributes
    ----------
    file : takes the entities.
    scale : of its unit [mm].
    """

    file: Entities
    scale: float

    def point(self, place: complex, z: float) -> Ref:
        """The point over `place` [mm] at the height `z` [mm]."""
        numbers = (place.real / self.scale, place.imag / self.scale, z / self.scale)
        return self.file.add("CARTESIAN_POINT", "", numbers)

    def axes(self, z: float, axis: tuple[float, float, float] = UPWARDS) -> Ref:
        """Axes on the cam axis at a height [mm], the third one up or down."""
        return self._placement(self.point(0j, z), self._fixed(axis), self._fixed(ACROSS))

    def post(self, foot: Ref) -> Ref:
        """The vertical line through a point."""
        return self.file.add("LINE", "", foot, self._vertical())

    def rising(self, foot: Ref, along: complex, high: float) -> Ref:
        """The line from a point `along` in the plane and up by `high` [mm]."""
        size = math.hypot(abs(along), high)
        numbers = (along.real / size, along.imag / size, high / size)
        vector = self.file.add("VECTOR", "", self.file.add("DIRECTION", "", numbers), 1.0)
        return self.file.add("LINE", "", foot, vector)

    def parabola(self, controls: tuple[Ref, Ref, Ref]) -> Ref:
        """The parabola of three control points."""
        form, knots = Word(".PARABOLIC_ARC."), Word(".UNSPECIFIED.")
        return self.file.add(
            "B_SPLINE_CURVE_WITH_KNOTS", "", 2, list(controls), form, flag(False), flag(False),
            [3, 3], [0.0, 1.0], knots,
        )  # fmt: skip

    def level(self, strand: Strand, ends: Ends) -> tuple[Ref, bool]:
        """The curve of a level edge, and whether it has the direction of the strand."""
        if isinstance(strand, CubicSpline):
            return self._spline(strand, ends), True
        if not strand.sweep:
            vector = self.file.add("VECTOR", "", self._direction(strand.end - strand.start), 1.0)
            return self.file.add("LINE", "", ends.start, vector), True
        # A CIRCLE runs counter-clockwise, from its first axis on.
        ahead = strand.sweep > 0.0
        first = (strand.start if ahead else strand.end) - strand.centre
        axes = self.placement(strand.centre, ends.z, UPWARDS, first)
        return self.file.add("CIRCLE", "", axes, mean_radius(strand) / self.scale), ahead

    def upright(self, strand: Strand, ends: Ends) -> tuple[Ref, bool]:
        """The upright surface on a line or an arc, and whether its normal points to the right."""
        assert not isinstance(strand, CubicSpline)  # of which walls with chamfers have none
        if not strand.sweep:
            way = strand.end - strand.start
            return self.plane(ends.start, (-1j * way, 0.0), way), True
        ahead = strand.sweep > 0.0
        first = (strand.start if ahead else strand.end) - strand.centre
        axes = self.placement(strand.centre, ends.z, UPWARDS, first)
        radius = mean_radius(strand) / self.scale
        return self.file.add("CYLINDRICAL_SURFACE", "", axes, radius), ahead

    def plane(self, through: Ref, normal: tuple[complex, float], way: complex) -> Ref:
        """The plane through a point, by its normal in the plane and upwards, and a level way."""
        across, rise = normal
        size = math.hypot(abs(across), rise)
        axis = self.file.add("DIRECTION", "", (across.real / size, across.imag / size, rise / size))
        return self.file.add(
            "PLANE", "", self._placement(through, axis, self._direction(way))
        )  # fmt: skip

    def placement(
        self, centre: complex, z: float, axis: tuple[float, float, float], first: complex
    ) -> Ref:
        """Axes at a place [mm], the third one up or down, the first one level."""
        return self._placement(self.point(centre, z), self._fixed(axis), self._direction(first))

    def piece(self, strand: Strand, lower: Ends, upper: Ends) -> tuple[tuple[Ref, Ref], Ref, bool]:
        """The face on a strand between two heights: the curves of its lower and its upper edge, its
        surface, and whether the curves have the direction of the strand and the normal points to
        its right.
        """
        if isinstance(strand, CubicSpline):
            curves = (self._spline(strand, lower), self._spline(strand, upper))
            surface = self.file.add("SURFACE_OF_LINEAR_EXTRUSION", "", curves[0], self._vertical())
            return curves, surface, True
        if not strand.sweep:
            return self._straight(strand, lower, upper)
        radius = mean_radius(strand) / self.scale
        # The arc turns counter-clockwise from the first axis, so that it crosses no seam.
        first = self._direction(
            (strand.start if strand.sweep > 0.0 else strand.end) - strand.centre
        )
        axes = [
            self._placement(self.point(strand.centre, ends.z), self._fixed(UPWARDS), first)
            for ends in (lower, upper)
        ]
        below, above = (self.file.add("CIRCLE", "", placement, radius) for placement in axes)
        surface = self.file.add("CYLINDRICAL_SURFACE", "", axes[0], radius)
        return (below, above), surface, strand.sweep > 0.0

    def _straight(self, line: Arc, lower: Ends, upper: Ends) -> tuple[tuple[Ref, Ref], Ref, bool]:
        along = line.end - line.start
        way, normal = self._direction(along), self._direction(-1j * along)
        vector = self.file.add("VECTOR", "", way, 1.0)
        below, above = (self.file.add("LINE", "", ends.start, vector) for ends in (lower, upper))
        surface = self.file.add("PLANE", "", self._placement(lower.start, normal, way))
        return (below, above), surface, True

    def _spline(self, spline: CubicSpline, ends: Ends) -> Ref:
        inner = [self.point(control, ends.z) for control in spline.controls[1:-1].tolist()]
        knots = [(knot, len(list(equal))) for knot, equal in groupby(spline.knots.tolist())]
        return self.file.add(
            "B_SPLINE_CURVE_WITH_KNOTS",
            "",
            DEGREE,
            [ends.start, *inner, ends.end],
            Word(".UNSPECIFIED."),
            flag(False),
            flag(False),
            [count for _, count in knots],
            [knot for knot, _ in knots],
            Word(".UNSPECIFIED."),
        )

    def _direction(self, along: complex) -> Ref:
        """The direction of a vector in the plane, of any length; the file states it of length 1."""
        unit = along / abs(along)
        return self.file.add("DIRECTION", "", (unit.real, unit.imag, 0.0))

    def _fixed(self, direction: tuple[float, float, float]) -> Ref:
        return self.file.shared("DIRECTION", "", direction)

    def _vertical(self) -> Ref:
        return self.file.shared("VECTOR", "", self._fixed(UPWARDS), 1.0)

    def _placement(self, origin: Ref, axis: Ref, first: Ref) -> Ref:
        return self.file.add("AXIS2_PLACEMENT_3D", "", origin, axis, first)


def mean_radius(arc: Arc) -> float:
    """The mean distance [mm] of both ends from the centre."""
    return 0.5 * (abs(arc.start - arc.centre) + abs(arc.end - arc.centre))


# -- slopes ---------------------------------------------------------------------------------------
# Walls with chamfers: rings of edges that faces share, cones on arcs and inclined planes on lines.
#
# The edge of a chamfer has a line or an arc for each of its wall's, at the same angles about the
# same centres, so that their ends lie on straight lines in both faces that meet there. Where a line
# and an arc meet in a corner, it is mitred, and the plane and the cone meet along a parabola.


SHARPEST = 1e-3
"""Change of direction [rad] at a joint up to which arcs of the parallel end on their circles."""


def parallel(strands: Sequence[Strand], width: float, name: str) -> tuple[Arc, ...]:
    """The strands `width` [mm] farther to the left, where the material is.

    Raises
    ------
    GeometryError
        With key "output.step.walls" for splines, with "part.chamfers" where an arc is too small.
    ToleranceError
        If ends are off their circles by more than the uncertainty that the file states.
    """
    arcs = [strand for strand in strands if isinstance(strand, Arc)]
    if len(arcs) < len(strands):
        raise GeometryError(
            "chamfers need walls of lines and arcs: a parallel of a spline is not a spline",
            key="output.step.walls",
            value='"spline"',
        )
    if any(_is_bent(*pair) for pair in zip((arcs[-1], *arcs[:-1]), arcs, strict=True)):
        return _mitred(arcs, width, name)
    places = []
    for previous, following in zip((arcs[-1], *arcs[:-1]), arcs, strict=True):
        one, other = (1j * arc.heading(following.start) for arc in (previous, following))
        # The corner of the parallel moves by the width along the normals of both neighbours.
        one, other = one / abs(one), other / abs(other)
        places.append(
            following.start + width * (one + other) / (1.0 + (one.conjugate() * other).real)
        )
    parallels = []
    for strand, (start, end) in zip(arcs, pairwise((*places, places[0])), strict=True):
        radius = mean_radius(strand) - math.copysign(width, strand.sweep)
        if strand.sweep and not radius > 0.0:
            raise GeometryError(
                f"an arc of the {name} has no parallel {width:g} mm inside the material",
                key="part.chamfers",
                value=f"{width:g}",
            )
        moved = Arc(start, end, strand.sweep, strand.centre)
        gap = max(abs(abs(point - strand.centre) - radius) for point in (start, end))
        if strand.sweep and gap > UNCERTAINTY:
            raise ToleranceError(
                f"arcs of the {name} do not meet at the edge of its chamfer", UNCERTAINTY, gap
            )
        parallels.append(moved)
    return tuple(parallels)


def _mitred(arcs: Sequence[Arc], width: float, name: str) -> tuple[Arc, ...]:
    """The parallel of strands of which some meet in corners."""
    try:
        moved = mitred(as_contour(arcs), -width)
    except GeometryError:
        raise GeometryError(
            f"the {name} has no parallel {width:g} mm inside the material",
            key="part.chamfers",
            value=f"{width:g}",
        ) from None
    pieces = zip(moved.vertices.tolist(), moved.ends.tolist(), moved.sweeps.tolist(),
                 moved.centres.tolist(), strict=True)  # fmt: skip
    return tuple(Arc(*piece) for piece in pieces)


def _is_bent(previous: Arc, following: Arc) -> bool:
    """Whether a line and an arc meet in a corner; raises GeometryError if two arcs do."""
    if not previous.sweep and not following.sweep:
        return False
    one, other = (arc.heading(following.start) for arc in (previous, following))
    if abs(other / abs(other) - one / abs(one)) <= SHARPEST:
        return False
    if previous.sweep and following.sweep:
        raise GeometryError(
            "two arcs meet in a corner, along which no chamfer is possible", key="part.chamfers"
        )
    return True


def _bend(line: Arc, arc: Arc, start: complex, end: complex) -> tuple[complex, float]:
    """The middle control point of the parabola along which a corner moves from `start` to `end`:
    its place, and its height as a share of the difference in height.

    Along the line, u from the foot of the centre, it moves evenly with the parameter of the
    parabola; across it and upwards with u^2.
    """
    way = (line.end - line.start) / abs(line.end - line.start)
    one, other = (abs(((point - arc.centre) * way.conjugate()).real) for point in (start, end))
    share = one / (one + other)
    along = ((end - start) * way.conjugate()).real * way
    return start + 0.5 * along + share * (end - start - along), share


def as_contour(strands: Sequence[Arc]) -> Contour:
    """The contour of strands that are lines and arcs."""
    vertices, sweeps, centres = zip(
        *((strand.start, strand.sweep, strand.centre) for strand in strands), strict=True
    )
    return Contour(np.array(vertices), np.array(sweeps), np.array(centres))


@dataclass(frozen=True, slots=True)
class StrandRow:
    """The ends and the edges of strands at one height.

    Attributes
    ----------
    strands : their pieces.
    z : height [mm].
    points, vertices, edges : of the file, one for each strand; vertices at their starts.
    """

    strands: tuple[Strand, ...]
    z: float
    points: list[Ref]
    vertices: list[Ref]
    edges: list[Ref]


def add_row(pen: Pen, strands: tuple[Strand, ...], z: float) -> StrandRow:
    """Add the edges along strands at a height [mm]."""
    file = pen.file
    points = [pen.point(strand.start, z) for strand in strands]
    vertices = [file.add("VERTEX_POINT", "", point) for point in points]
    edges = []
    for k, strand in enumerate(strands):
        following = (k + 1) % len(strands)
        curve, same = pen.level(strand, Ends(z, points[k], points[following]))
        edges.append(
            file.add("EDGE_CURVE", "", vertices[k], vertices[following], curve, flag(same))
        )  # fmt: skip
    return StrandRow(strands, z, points, vertices, edges)


def add_posts(pen: Pen, lower: StrandRow, upper: StrandRow) -> list[Ref]:
    """Add the edges from the ends of one row to those of the row above."""
    posts = []
    for k, (one, other) in enumerate(zip(lower.strands, upper.strands, strict=True)):
        along = other.start - one.start
        previous, following = lower.strands[k - 1], one
        if lower.strands is upper.strands:
            line = pen.post(lower.points[k])
        elif (
            isinstance(previous, Arc)
            and isinstance(following, Arc)
            and _is_bent(previous, following)
        ):
            pair = (previous, following) if following.sweep else (following, previous)
            place, share = _bend(*pair, one.start, other.start)
            middle = pen.point(place, (1.0 - share) * lower.z + share * upper.z)
            line = pen.parabola((lower.points[k], middle, upper.points[k]))
        else:
            line = pen.rising(lower.points[k], along, upper.z - lower.z)
        ends = (lower.vertices[k], upper.vertices[k])
        posts.append(pen.file.add("EDGE_CURVE", "", *ends, line, flag(True)))
    return posts


def add_surface(pen: Pen, lower: StrandRow, upper: StrandRow, k: int) -> tuple[Ref, bool]:
    """Add the surface between strands `k` of two rows; also whether its normal points to their
    right.
    """
    one, other = lower.strands[k], upper.strands[k]
    if lower.strands is upper.strands:
        return pen.upright(one, Ends(lower.z, lower.points[k], lower.points[k]))
    assert isinstance(one, Arc)  # as all strands of chamfers are
    assert isinstance(other, Arc)
    high = upper.z - lower.z
    if not one.sweep:
        way = (one.end - one.start) / abs(one.end - one.start)
        inwards = ((other.start - one.start) * (1j * way).conjugate()).real
        # To the right of the way by the height, and up by as much as the face leans in.
        return pen.plane(lower.points[k], (-1j * way * high, inwards), way), True
    radii = mean_radius(one), mean_radius(other)
    angle = math.atan2(abs(radii[1] - radii[0]), high)
    grows = radii[1] > radii[0]
    # From its smaller end up or down; it runs counter-clockwise about its axis, from the first.
    ahead = (one.sweep > 0.0) == grows
    longer = one if abs(one.sweep) >= abs(other.sweep) else other
    first = (longer.start if ahead else longer.end) - one.centre
    base = pen.placement(
        one.centre, lower.z if grows else upper.z, UPWARDS if grows else DOWNWARDS, first
    )
    # About the third axis of its base, with the radius there, which grows along it.
    return pen.file.add("CONICAL_SURFACE", "", base, min(radii) / pen.scale, angle), one.sweep > 0.0


# -- text -----------------------------------------------------------------------------------------
# Text of a STEP file by ISO 10303-21: numbers, strings, and entities with their numbers.


CODED = re.compile("[^ -~\U00010000-\U0010ffff]+|[\U00010000-\U0010ffff]+")
"""Characters that a string does not hold as they are, of four hexadecimal digits or of eight."""


class Ref(int):
    """The number of an entity."""


class Word(str):
    """What is written as it stands: an enumeration, `$`, `*`."""

    __slots__ = ()


Value = Union[Ref, Word, str, int, float, "Typed", Sequence["Value"]]


@dataclass(frozen=True, slots=True)
class Typed:
    """A value that names its type."""

    kind: str
    value: Value


NONE, DERIVED = Word("$"), Word("*")


def flag(value: bool) -> Word:
    """A truth value."""
    return Word(".T." if value else ".F.")


def parameter_text(value: Value) -> str:
    """A parameter as text."""
    # A Ref is an int and a Word a str, so these come first.
    match value:
        case Ref():
            return f"#{int(value)}"
        case Word():
            return str(value)
        case str():
            return f"'{string_text(value)}'"
        case float():
            return real(value)
        case int():
            return str(value)
        case Typed():
            return f"{value.kind}({parameter_text(value.value)})"
    return f"({','.join(map(parameter_text, value))})"


def real(value: float) -> str:
    """A number with the point that the format demands, shortest, and read as the same double."""
    text = repr(value + 0.0)  # -0.0 becomes 0.0
    mantissa, _, exponent = text.partition("e")
    mantissa = mantissa.removesuffix("0") if mantissa.endswith(".0") else mantissa
    mantissa = mantissa if "." in mantissa else f"{mantissa}."
    return f"{mantissa}E{int(exponent)}" if exponent else mantissa


def string_text(text: str) -> str:
    """A string in the characters of ISO 646, with directives for all others; quotes and backslashes
    are doubled.
    """
    return CODED.sub(_directive, text.replace("\\", "\\\\").replace("'", "''"))


def _directive(match: re.Match[str]) -> str:
    digits = 4 if match[0][0] <= "\uffff" else 8
    codes = "".join(f"{ord(character):0{digits}X}" for character in match[0])
    return f"\\X{digits // 2}\\{codes}\\X0\\"


class Entities:
    """The entities of a file, numbered from 1 as they are added."""

    def __init__(self) -> None:
        self.lines: list[str] = []
        self._known: dict[str, Ref] = {}

    def add(self, kind: str, *values: Value) -> Ref:
        """A new entity."""
        return self._line(f"{kind}{parameter_text(values)}")

    def shared(self, kind: str, *values: Value) -> Ref:
        """The entity with this text, which all that need it share."""
        text = f"{kind}{parameter_text(values)}"
        if text not in self._known:
            self._known[text] = self._line(text)
        return self._known[text]

    def complex(self, *parts: tuple[str, tuple[Value, ...]]) -> Ref:
        """An entity of several types, in the order of the alphabet."""
        return self._line(
            f"({''.join(f'{kind}{parameter_text(values)}' for kind, values in parts)})"
        )

    def _line(self, text: str) -> Ref:
        self.lines.append(f"#{len(self.lines) + 1}={text};")
        return Ref(len(self.lines))


# -- frame ----------------------------------------------------------------------------------------
# What a STEP file has around its solid: header, product, units and uncertainty, by AP242.


SCHEMA = "AP242_MANAGED_MODEL_BASED_3D_ENGINEERING_MIM_LF { 1 0 10303 442 1 1 4 }"
"""The first edition of AP242, which programs have been able to read for the longest time."""

FIXED_DATE = "1970-01-01T00:00:00"
"""The time stamp: the file's bytes depend only on its content."""

UNCERTAINTY = 1e-7
"""Distance [mm] within which ends meet: the accuracy of CAD programs, far above that of doubles."""


def header(product: Product, tolerance: float) -> list[str]:
    """The lines of the header; the description states the origin."""
    description = (
        f"camgeo {product.version}",
        f"scene {product.scene_hash}",
        f"tolerance {tolerance!r} mm",
    )
    system, nobody = f"camgeo {product.version}", ("",)
    name = (f"{product.name}.step", FIXED_DATE, nobody, nobody, system, "camgeo", "")
    records: list[tuple[str, tuple[Value, ...]]] = [
        ("FILE_DESCRIPTION", (description, "2;1")),
        ("FILE_NAME", name),
        ("FILE_SCHEMA", ((SCHEMA,),)),
    ]
    lines = [f"{kind}{parameter_text(values)};" for kind, values in records]
    return ["ISO-10303-21;", "HEADER;", *lines, "ENDSEC;", "DATA;"]


END = ["ENDSEC;", "END-ISO-10303-21;"]


def add_product(file: Entities, name: str) -> Ref:
    """Add a product of that name with its definition; return what shapes are attached to."""
    context = file.add("APPLICATION_CONTEXT", "managed model based 3d engineering")
    file.add(
        "APPLICATION_PROTOCOL_DEFINITION",
        "international standard",
        "ap242_managed_model_based_3d_engineering",
        2014,
        context,
    )
    discipline = file.add("PRODUCT_CONTEXT", "", context, "mechanical")
    product = file.add("PRODUCT", name, name, "", (discipline,))
    file.add("PRODUCT_RELATED_PRODUCT_CATEGORY", "part", "", (product,))
    version = file.add("PRODUCT_DEFINITION_FORMATION", "", "", product)
    stage = file.add("PRODUCT_DEFINITION_CONTEXT", "part definition", context, "design")
    definition = file.add("PRODUCT_DEFINITION", "design", "", version, stage)
    return file.add("PRODUCT_DEFINITION_SHAPE", "", "", definition)


def add_context(file: Entities, unit: LengthUnit) -> Ref:
    """Add the units and the uncertainty of a representation; return their context."""
    length = _length_unit(file, unit)
    angle = file.complex(
        ("NAMED_UNIT", (DERIVED,)),
        ("PLANE_ANGLE_UNIT", ()),
        ("SI_UNIT", (NONE, Word(".RADIAN."))),
    )
    solid_angle = file.complex(
        ("NAMED_UNIT", (DERIVED,)),
        ("SI_UNIT", (NONE, Word(".STERADIAN."))),
        ("SOLID_ANGLE_UNIT", ()),
    )
    uncertainty = file.add(
        "UNCERTAINTY_MEASURE_WITH_UNIT",
        Typed("LENGTH_MEASURE", UNCERTAINTY / MM_PER[unit]),
        length,
        "distance_accuracy_value",
        "ends and edges meet within it",
    )
    return file.complex(
        ("GEOMETRIC_REPRESENTATION_CONTEXT", (3,)),
        ("GLOBAL_UNCERTAINTY_ASSIGNED_CONTEXT", ((uncertainty,),)),
        ("GLOBAL_UNIT_ASSIGNED_CONTEXT", ((length, angle, solid_angle),)),
        ("REPRESENTATION_CONTEXT", ("", "3D")),
    )


def _length_unit(file: Entities, unit: LengthUnit) -> Ref:
    millimetre = file.complex(
        ("LENGTH_UNIT", ()),
        ("NAMED_UNIT", (DERIVED,)),
        ("SI_UNIT", (Word(".MILLI."), Word(".METRE."))),
    )
    if unit == "mm":
        return millimetre
    exponents = file.add("DIMENSIONAL_EXPONENTS", 1.0, *(0.0,) * 6)
    factor = Typed("LENGTH_MEASURE", MM_PER[unit])
    measure = file.add("LENGTH_MEASURE_WITH_UNIT", factor, millimetre)
    return file.complex(
        ("CONVERSION_BASED_UNIT", (unit.upper(), measure)),
        ("LENGTH_UNIT", ()),
        ("NAMED_UNIT", (exponents,)),
    )
