"""The part as a sheet needs it: its edges as seen from above, its section through the cam axis, and
their dimensions.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import count, groupby, islice, pairwise, takewhile
from typing import Final

import numpy as np

from camgeo.geometry.contour.contour import Contour, Effort
from camgeo.geometry.contour.parallel import corners, count_steps, parallel
from camgeo.numeric.arrays import ComplexArray, FloatArray, phase
from camgeo.part.part import WRITTEN_SHARE, Bevel, Boundary, Part, written_contour
from camgeo.part.part import Layer as PartLayer
from camgeo.part.spec import text_name
from camgeo.pictures.sheet.marks import (
    ARROW,
    CELL,
    DIAMETER,
    LETTER,
    LETTERS,
    LIFTED,
    Chain,
    Diameter,
    Distance,
    Filled,
    Hatched,
    Label,
    Layer,
    Mark,
    Option,
    Options,
    dimension_text,
    line,
    moved,
    rectangle,
    shelf_length,
    text_width,
)
from camgeo.scene.formats.drawing import DrawingSpec
from camgeo.units import LengthUnit

# -- shape -----------------------------------------------------------------------------------------
# The part as a sheet needs it: its contours, and what is visible of them.


COARSE = 1e-5
"""Sagitta of chords, relative to the size of a part, where only visibility is decided."""


FLANKS = frozenset(("outline", "return outline", "inner flank", "outer flank"))
"""Boundaries on which a follower runs."""

ROUND = 1e-9
"""Centres that differ by less than this, relative to the size of a part, are the same."""


@dataclass(frozen=True, slots=True, eq=False)
class Edge:
    """A boundary with its contour within the tolerance.

    Attributes
    ----------
    hidden : whether all of it is below material, as seen from above.
    """

    boundary: Boundary
    contour: Contour
    hidden: bool

    @property
    def is_flank(self) -> bool:
        """Whether the follower runs on it."""
        return self.boundary.name in FLANKS

    @property
    def is_letter(self) -> bool:
        """Whether it is an outline of an engraved letter."""
        return bool(text_name(self.boundary.name))

    @property
    def circle(self) -> tuple[complex, float] | None:
        """Centre and radius [mm] of a round boundary, which may have a keyway or a flat; None if it
        is not round.
        """
        contour = self.contour
        bent = contour.sweeps != 0.0
        if abs(float(np.sum(contour.sweeps))) < np.pi:
            return None
        centres, radii = contour.centres[bent], contour.radii[bent]
        size = float(np.max(radii))
        if np.max(np.abs(centres - centres[0])) > ROUND * size or np.ptp(radii) > ROUND * size:
            return None
        return complex(centres[0]), float(radii[0])

    def has(self, point: complex) -> bool:
        """Whether a point of its circle is on the boundary, not cut away by a keyway or a flat."""
        contour = self.contour
        bent = contour.sweeps != 0.0
        starts, sweeps = contour.vertices[bent], contour.sweeps[bent]
        centres = contour.centres[bent]
        # The angle from the start of each arc to the point, in the direction of the arc.
        turned = np.angle((point - centres) / (starts - centres)) * np.sign(sweeps)
        return bool(np.any(turned % (2.0 * np.pi) <= np.abs(sweeps)))


@dataclass(frozen=True, slots=True, eq=False)
class Shape:
    """A part with the contours of its boundaries.

    Attributes
    ----------
    part : the part.
    edges : the edges along its boundaries, in the order of the part.
    """

    part: Part
    edges: tuple[Edge, ...]

    @property
    def size(self) -> float:
        """Largest distance of the vertices of the part from the cam axis [mm]."""
        return max(float(np.max(np.abs(edge.contour.vertices))) for edge in self.edges)

    @property
    def outermost(self) -> Edge:
        """The edge that goes around all others."""
        return max(self.edges, key=lambda edge: float(np.max(np.abs(edge.contour.vertices))))

    @property
    def has_heights(self) -> bool:
        """Whether all layers of the part have a thickness."""
        return all(layer.z1 > layer.z0 for layer in self.part.layers)

    @property
    def holes(self) -> list[tuple[complex, float]]:
        """Centre and radius [mm] of the round boundaries off the cam axis."""
        circles = [edge.circle for edge in self.edges]
        return [
            circle
            for circle in circles
            if circle is not None and abs(circle[0]) > ROUND * self.size
        ]

    def edge(self, boundary: Boundary) -> Edge:
        """The edge along a boundary."""
        return next(edge for edge in self.edges if edge.boundary is boundary)

    def contours(self, layer: PartLayer) -> tuple[Contour, ...]:
        """The contours of the boundaries of a layer."""
        return tuple(self.edge(boundary).contour for boundary in layer.boundaries)

    @property
    def outlines(self) -> list[Mark]:
        """The edges of the part as they are seen from above."""
        return [mark for edge in self.edges for mark in self.edge_chains(edge)]

    def edge_chains(self, edge: Edge) -> list[Chain]:
        """The edge as it is drawn: whole, or in alternately visible and hidden stretches."""
        contour, layer = edge.contour, _layer(edge)
        whole = Chain(contour.vertices, contour.sweeps, layer, closed=True)
        covers = _above(self, edge) if layer == "OUTLINE" and not edge.boundary.hole else []
        if not covers:
            return [whole]
        size, length = self.size, float(np.sum(contour.lengths))

        def covered(place: float) -> bool:
            here = Chain.along(contour, place * length, 0.0, "OUTLINE").vertices[0]
            return any(_inside(rings, complex(here), SEEN_DISTANCE * size) for rings in covers)

        ends = _changes(covered)
        if not ends:
            return [whole]
        chains = []
        for first, last in pairwise([*ends, ends[0] + 1.0]):
            layer = "HIDDEN" if covered(0.5 * (first + last) % 1.0) else "OUTLINE"
            chains.append(Chain.along(contour, first * length, (last - first) * length, layer))
        return chains

    @staticmethod
    def from_part(part: Part, tolerance: float, effort: Effort) -> Shape:
        """The part with contours within `tolerance` [mm], those of a DXF for cutting."""
        fits = [
            written_contour(boundary, "arcs", effort, tolerance).contour
            for boundary in part.boundaries
        ]
        contour_by_name = {
            boundary.name: fit for boundary, fit in zip(part.boundaries, fits, strict=True)
        }
        coarse = COARSE * max(float(np.max(np.abs(fit.vertices))) for fit in fits)
        chords = {name: fit.points(coarse) for name, fit in contour_by_name.items()}
        edges = []
        for boundary in part.boundaries:
            top = max(k for k, layer in enumerate(part.layers) if boundary in layer.boundaries)
            above = part.layers[top + 1 :]
            hidden = any(_covers([chords[b.name] for b in layer.boundaries], chords[boundary.name])
                         for layer in above)  # fmt: skip
            edges.append(Edge(boundary, contour_by_name[boundary.name], hidden))
        return Shape(part, tuple(edges))


def _covers(section: Sequence[ComplexArray], points: ComplexArray) -> bool:
    """Whether all `points` lie in the material of a layer with these boundaries."""
    some = points[:: max(1, len(points) // 24)]
    return all(enclosing(section, point) % 2 == 1 for point in some.tolist())


def enclosing(rings: Sequence[ComplexArray], point: complex) -> int:
    """How often the ray from `point` to the right crosses closed polygons; odd inside material."""
    return sum(int(np.count_nonzero(crossings(ring, point.imag) > point.real)) for ring in rings)


def crossings(ring: ComplexArray, y: float) -> FloatArray:
    """(k,) x of the crossings of a closed polygon with the horizontal line at `y`."""
    ends = np.roll(ring, -1)
    # Half-open: a vertex on the line belongs to one side, so it is not counted twice.
    across = (ring.imag > y) != (ends.imag > y)
    start, end = ring[across], ends[across]
    x_crossings: FloatArray = (
        start.real + (y - start.imag) / (end.imag - start.imag) * (end - start).real
    )
    return x_crossings


def extreme(contours: Sequence[Contour], direction: complex) -> complex:
    """The point of contours that is farthest along a unit vector [mm]; exact for arcs."""
    best, far = 0j, -np.inf
    for contour in contours:
        bent = contour.sweeps != 0.0
        starts, sweeps = contour.vertices[bent], contour.sweeps[bent]
        centres = contour.centres[bent]
        turned = np.angle(direction / (starts - centres)) * np.sign(sweeps) % (2.0 * np.pi)
        reached = turned <= np.abs(sweeps)  # arcs that contain the farthest point of their circle
        tops = (centres + np.abs(starts - centres) * direction)[reached]
        for point in np.concatenate((contour.vertices, tops)).tolist():
            along = (point * direction.conjugate()).real
            if along > far:
                best, far = point, along
    return best


@dataclass(frozen=True, slots=True)
class ViewSubject:
    """What the views of a sheet show.

    Attributes
    ----------
    shape : the part.
    pitch : the pitch curve; None if it is the outline, or is not drawn.
    base_radius : radius of the base circle [mm]; None if it is not drawn, as of a pair in one
        piece, which has two.
    cut : marks of the section with sharp edges; empty without thickness.
    unit : unit of the dimensions.
    edges : edges of chamfers that are visible from above.
    """

    shape: Shape
    pitch: Contour | None
    base_radius: float | None
    cut: tuple[Mark, ...]
    unit: LengthUnit
    edges: tuple[Mark, ...] = ()

    @property
    def box(self) -> tuple[complex, complex]:
        """Lower left and upper right corner of all that the front view shows [mm]."""
        contours = [edge.contour for edge in self.shape.edges]
        if self.base_radius is not None:
            contours.append(Contour.circle(self.base_radius))
        if self.pitch is not None:
            contours.append(self.pitch)
        left, right, low, high = (extreme(contours, way) for way in (-1.0, 1.0, -1j, 1j))
        return complex(left.real, low.imag), complex(right.real, high.imag)

    @property
    def alone(self) -> ViewSubject:
        """The part without pitch curve and base circle."""
        return replace(self, pitch=None, base_radius=None)


# -- hidden ---------------------------------------------------------------------------------------
# Edges that are partly hidden: the outline of the lower disc of a pair in one piece.
#
# The visibility of an edge changes where it passes under an edge above it. It is determined at
# places along the edge, with polygons, so a stretch shorter than their distance may be drawn as its
# neighbours are. The edge itself stays exact, as its stretches are cut from its lines and arcs.


ALONG: Final = 720
"""Number of places along an edge at which its visibility is determined."""

SEEN_DISTANCE: Final = 1e-4
"""Distance from an edge above, relative to the size of the part, within which an edge is
visible."""

FINE: Final = 1e-7
"""Accuracy of the ends of stretches, relative to the length of the edge."""


def _layer(edge: Edge) -> Layer:
    """The layer of an edge that is drawn whole."""
    if edge.is_letter:
        return "ENGRAVING"
    return "HIDDEN" if edge.hidden else "OUTLINE"


def _above(shape: Shape, edge: Edge) -> list[list[ComplexArray]]:
    """The boundaries of each layer above an edge that may cover it, as polygons."""
    layers, coarse = shape.part.layers, COARSE * shape.size
    top = max(k for k, layer in enumerate(layers) if edge.boundary in layer.boundaries)
    above = [shape.contours(layer) for layer in layers[top + 1 :]]
    polygons = [[contour.points(coarse) for contour in contours] for contours in above]
    nearest = float(np.min(np.abs(edge.contour.points(coarse))))
    return [rings for rings in polygons if float(np.max(np.abs(rings[0]))) > nearest]


def _inside(rings: Sequence[ComplexArray], point: complex, near: float) -> bool:
    """Whether a point lies in the material of a layer, and not on its edge."""
    if not enclosing(rings, point) % 2:
        return False
    return all(_distance(ring, point) > near for ring in rings)


def _distance(ring: ComplexArray, point: complex) -> float:
    """Distance of a point from a closed polygon [mm]."""
    way = np.roll(ring, -1) - ring
    share = np.clip(((point - ring) * way.conj()).real / np.abs(way) ** 2, 0.0, 1.0)
    return float(np.min(np.abs(ring + share * way - point)))


def _changes(covered: Callable[[float], bool]) -> list[float]:
    """Places, as shares of the length, at which an edge passes under another one or out of it."""
    places = (np.arange(ALONG + 1) / ALONG).tolist()
    seen = [covered(place) for place in places[:-1]]
    changes = []
    for (low, high), state, next_state in zip(
        pairwise(places), seen, [*seen[1:], seen[0]], strict=True
    ):
        if state == next_state:
            continue
        while high - low > FINE:
            middle = 0.5 * (low + high)
            low, high = (middle, high) if covered(middle) == state else (low, middle)
        changes.append(0.5 * (low + high))
    return changes


# -- section ---------------------------------------------------------------------------------------
# The section through the cam axis, from the layers of the part alone.
#
# The plane is vertical in the front view, at x = 0, and seen along +x, as a view from the left. In
# first-angle projection it stands to the right of the front view, with the upper face of the disc
# on its right. At a height y of the front view and in one layer, the first material at or behind
# the plane is visible. Its distance is a continuous function of y, except at the heights at which a
# boundary passes the plane, turns back or has a corner. So a line is drawn where the distance
# differs between adjacent layers, or jumps between adjacent heights.


NOTHING = math.inf
"""Distance of the first material if there is none."""

SAME = 1e-6
"""Largest difference of distances of the same face, relative to the size of the part."""

JUMP = 0.02
"""Least jump of the distance of the first material at an edge, relative to the size of the part."""


NEAR: Final = 30.0 * COARSE
"""Places of a section within this distance, relative to the size of a part, are the same."""


SMALL_BEYOND = 2.0
"""How far centre lines of holes extend beyond them [mm of paper]."""


CORNER = 0.1
"""Smallest jump of a contour's direction that is visible as an edge from the side [rad]."""


def section(shape: Shape) -> list[Mark]:
    """The cut part [mm]: x is the height over its lowest face, y is that of the front view."""
    size, layers = shape.size, shape.part.layers
    rings = [[c.points(COARSE * size) for c in shape.contours(layer)] for layer in layers]
    sharp = [np.concatenate([kinks(c) for c in shape.contours(layer)]) for layer in layers]
    places = _places(rings, sharp, size)
    # Between two places the distance is continuous, so the middle stands for all heights.
    middles = [0.5 * (low + high) for low, high in pairwise(places)]
    seen = [[_first(layer_rings, y) for y in middles] for layer_rings in rings]
    low = layers[0].z0
    heights = [layers[0].z0 - low, *(layer.z1 - low for layer in layers)]
    marks: list[Mark] = []
    for k, distances in enumerate(seen):
        for index, away in enumerate(distances):
            if away == 0.0:
                (z0, z1), (y0, y1) = heights[k : k + 2], places[index : index + 2]
                sides = [z0 + 1j * y0, z1 + 1j * y0, z1 + 1j * y1, z0 + 1j * y1]
                marks.append(Hatched(np.array(sides)))
    # Lines along the faces between layers, and at the outer faces.
    nothing = [NOTHING] * len(middles)
    for k, height in enumerate(heights):
        below = seen[k - 1] if k else nothing
        above = seen[k] if k < len(seen) else nothing
        for first, last, layer in _stretches(_boundary_lines(below, above, SAME * size)):
            marks.append(line(height + 1j * places[first], height + 1j * places[last], layer))
    # Lines along the heights at which the first material jumps within a layer.
    for y in places:
        edge_layers = [
            _edge(layer_rings, tips, y, size)
            for layer_rings, tips in zip(rings, sharp, strict=True)
        ]
        for first, last, layer in _stretches(edge_layers):
            marks.append(line(heights[first] + 1j * y, heights[last] + 1j * y, layer))
    return marks


def _places(
    rings: Sequence[Sequence[ComplexArray]], sharp: Sequence[ComplexArray], size: float
) -> list[float]:
    """Heights [mm], ascending, between which the visible distance is continuous in every layer."""
    candidates: list[float] = []
    for ring in (ring for layer_rings in rings for ring in layer_rings):
        candidates += crossings(1j * ring.conj(), 0.0).tolist()  # of its mirror image with x = 0
        previous, following = np.roll(ring, 1), np.roll(ring, -1)
        # Vertices at which the polygon turns back in y: there an outer edge begins or ends.
        turns = (ring.imag - previous.imag) * (following.imag - ring.imag) <= 0.0
        candidates += ring[turns & (ring.real > 0.0)].imag.tolist()
    for tips in sharp:
        candidates += tips[tips.real > 0.0].imag.tolist()
    merged: list[float] = []
    for y in sorted(candidates):
        if not merged or y - merged[-1] > 10.0 * COARSE * size:
            merged.append(y)
    return merged


def _first(rings: Sequence[ComplexArray], y: float) -> float:
    """Distance from the plane to the first material at the height y [mm]; 0 in cut material."""
    # An odd number of crossings ahead means that the plane itself is in material.
    ahead = [x for ring in rings for x in crossings(ring, y).tolist() if x > 0.0]
    if len(ahead) % 2:
        return 0.0
    return min(ahead, default=NOTHING)


def _boundary_lines(
    below: Sequence[float], above: Sequence[float], same: float
) -> Iterator[Layer | None]:
    """The layer of the line between two layers of the part at each place; None without a line."""
    for one, other in zip(below, above, strict=True):
        if one == other or abs(one - other) <= same:
            yield None
        else:
            yield "SECTION" if 0.0 in (one, other) else "EDGES"


def _stretches(lines: Iterable[Layer | None]) -> Iterator[tuple[int, int, Layer]]:
    """Start, end and layer of each line, joined from the layers at successive places."""
    start = 0
    for layer, group in groupby(lines):
        end = start + len(list(group))
        if layer is not None:
            yield start, end, layer
        start = end


def _edge(
    rings: Sequence[ComplexArray], sharp: ComplexArray, y: float, size: float
) -> Layer | None:
    """The line of a layer at the height y: a cut edge, one behind the plane, or None."""
    step = 20.0 * COARSE * size  # far enough from y for the chords of curves to make no difference
    one, other = _first(rings, y - step), _first(rings, y + step)
    if one == other:
        return None
    if 0.0 in (one, other):
        return "SECTION"
    near = min(one, other)
    edges = sharp[np.abs(sharp.imag - y) <= step]
    cornered = bool(np.any(np.abs(edges.real - near) <= JUMP * size))
    return "EDGES" if cornered or abs(one - other) > JUMP * size else None


def kinks(contour: Contour) -> ComplexArray:
    """(k,) vertices at which the direction of the contour jumps [mm]."""
    chord = contour.ends - contour.vertices
    # An arc begins half its sweep before the direction of its chord, and ends as much after it.
    first = np.angle(chord) - 0.5 * contour.sweeps
    last = np.roll(first + contour.sweeps, 1)
    turn = np.abs((first - last + np.pi) % (2.0 * np.pi) - np.pi)
    return contour.vertices[turn > CORNER]


# -- chamfers -------------------------------------------------------------------------------------
# The edges of chamfers from above, and the section with its corners cut off.


@dataclass(frozen=True, slots=True)
class Corner:
    """A corner of the section that a chamfer cuts off, in the coordinates of the section [mm].

    Attributes
    ----------
    sharp : place of the corner without the chamfer.
    on_face, on_wall : ends of the chamfer.
    hole : whether the wall is that of a hole.
    """

    sharp: complex
    on_face: complex
    on_wall: complex
    hole: bool

    def has(self, point: complex, near: float) -> bool:
        """Whether a point is the corner, within `near` [mm]."""
        return abs(point - self.sharp) <= near


def edges_above(shape: Shape, tolerance: float, effort: Effort) -> Iterator[Chain]:
    """The edges of chamfers on upper faces, as wide lines within `tolerance` [mm]."""
    for bevel in shape.part.bevels:
        if bevel.upper:
            contour = written_contour(bevel.edge, "arcs", effort, tolerance).contour
            yield Chain(contour.vertices, contour.sweeps, "EDGES", closed=True)
            yield from _mitres(bevel, WRITTEN_SHARE * tolerance)


def _mitres(bevel: Bevel, tolerance: float) -> Iterator[Chain]:
    """The edges between the faces of a chamfer, at the corners of its boundary."""
    if bevel.boundary.corner_radius is None:
        return
    contour = bevel.boundary.arcs(tolerance).contour
    offset = bevel.width if bevel.boundary.hole else -bevel.width
    shares = np.linspace(0.0, 1.0, count_steps(contour, offset, tolerance) + 1).tolist()
    ways = np.array([parallel(contour, share * offset).vertices for share in shares])
    for k in np.flatnonzero(corners(contour)):
        yield Chain(ways[:, k], np.zeros(len(shares)), "EDGES")


def chamfer_corners(shape: Shape) -> list[Corner]:
    """The corners of the section that have chamfers."""
    cut_corners = []
    base, size = shape.part.layers[0].z0, shape.size
    for bevel in shape.part.bevels:
        near = _crossings(bevel.edge, size)
        for y in _crossings(bevel.boundary, size):
            ends = [end for end in near if abs(end - y) <= 4.0 * bevel.width]
            if ends:
                end = min(ends, key=lambda each: abs(each - y))
                cut_corners.append(
                    Corner(
                        complex(bevel.z - base, y),
                        complex(bevel.z - base, end),
                        complex(bevel.foot - base, y),
                        bevel.boundary.hole,
                    )
                )
    return cut_corners


def _crossings(boundary: Boundary, size: float) -> list[float]:
    """The y at which a boundary crosses the plane of the section [mm], ascending."""
    ring = boundary.distance_fit(COARSE * size).contour.points(COARSE * size)
    return sorted(crossings(1j * ring.conj(), 0.0).tolist())


def bevelled(marks: Sequence[Mark], shape: Shape) -> list[Mark]:
    """The marks of a section with its chamfers."""
    corners, near = chamfer_corners(shape), NEAR * shape.size
    bevelled_marks: list[Mark] = []
    for mark in marks:
        if isinstance(mark, Hatched):
            bevelled_marks.append(_cut(mark, corners))
        elif isinstance(mark, Chain) and mark.layer == "SECTION":
            bevelled_marks.append(_shortened(mark, corners, near))
        else:
            bevelled_marks.append(mark)
    for corner in corners:
        bevelled_marks.append(line(corner.on_face, corner.on_wall, "SECTION"))
        if corner.hole:  # behind the plane, the edge on the face continues
            bevelled_marks.append(line(corner.sharp, corner.on_face, "EDGES"))
    bevelled_marks += _feet(shape)
    return bevelled_marks


def _cut(face: Hatched, corners: Sequence[Corner]) -> Hatched:
    """A face without the corners that chamfers cut off."""
    points = face.corners
    for corner in corners:
        z = sorted((corner.on_wall.real, corner.sharp.real))
        y = sorted((corner.on_face.imag, corner.sharp.imag))
        low, high = min(points.real), max(points.real)
        left, right = min(points.imag), max(points.imag)
        if min(z[1], high) > max(z[0], low) and min(y[1], right) > max(y[0], left):
            points = _clipped(points, corner.on_face, corner.on_wall, corner.sharp)
    return Hatched(points)


def _clipped(points: ComplexArray, one: complex, other: complex, outer: complex) -> ComplexArray:
    """A convex polygon (n,) without what lies beyond a line, on the side of the point `outer`."""
    way = other - one
    side = np.sign(((outer - one) * way.conjugate()).imag)
    beyond = ((points - one) * np.conj(way)).imag * side
    vertices: list[complex] = []
    for k, point in enumerate(points.tolist()):
        following = (k + 1) % len(points)
        if beyond[k] <= 0.0:
            vertices.append(point)
        if (beyond[k] > 0.0) != (beyond[following] > 0.0):
            share = beyond[k] / (beyond[k] - beyond[following])
            vertices.append(complex(point + share * (points[following] - point)))
    return np.array(vertices, dtype=np.complex128)


def _shortened(chain: Chain, corners: Sequence[Corner], near: float) -> Chain:
    """A line up to the chamfers at its ends."""
    ends = chain.vertices.tolist()
    for k in (0, 1):
        for corner in corners:
            if not corner.has(ends[k], near):
                continue
            along = ends[1 - k] - ends[k]
            for end in (corner.on_face, corner.on_wall):
                way = end - corner.sharp
                if (along * way.conjugate()).real > 0.5 * abs(along) * abs(way):
                    ends[k] = end
    return Chain(np.array(ends), chain.sweeps, chain.layer, chain.closed)


def _feet(shape: Shape) -> Iterator[Mark]:
    """The edges between the chamfers of holes and their walls, visible behind the plane.

    They are left out where something else stands in the hole.
    """
    base, size = shape.part.layers[0].z0, shape.size
    for bevel in shape.part.bevels:
        if not bevel.boundary.hole:
            continue
        wall_crossings = _crossings(bevel.boundary, size)
        others = [y for boundary in _neighbours(shape, bevel) for y in _crossings(boundary, size)]
        for low, high in zip(wall_crossings[::2], wall_crossings[1::2], strict=False):
            if not any(low < y < high for y in others):
                z = bevel.foot - base
                yield line(complex(z, low), complex(z, high), "EDGES")


def _neighbours(shape: Shape, bevel: Bevel) -> list[Boundary]:
    """The other boundaries at the height of a chamfer's foot."""
    return [
        boundary
        for layer in shape.part.layers
        if layer.z0 <= bevel.foot <= layer.z1
        for boundary in layer.boundaries
        if boundary != bevel.boundary
    ]


# -- section dimensions ---------------------------------------------------------------------------
# The dimensions of the section: heights above and below it, diameters beside it.


PLACES: Final = 24
"""Number of distances from the section that are tried."""


def diameters(
    rounds: Sequence[TurnedDiameter], thickness: float, bench: Bench
) -> Iterator[Options]:
    """The diameters that the section shows; the smallest comes first and is nearest to it.

    The datum A is at the diameter of the bore.
    """
    for diameter in rounds:
        if in_section(diameter):
            yield _diameter(diameter, thickness, bench)


def hole_centres(shape: Shape, scale: float) -> Iterator[Mark]:
    """Centre lines of the holes off the cam axis whose centres are in the plane."""
    base, far = shape.part.layers[0].z0, SMALL_BEYOND / scale
    for wall in shape.part.walls:
        circle = shape.edge(wall.boundary).circle
        if circle is not None and abs(circle[0].real) <= 1e-9 * shape.size < abs(circle[0]):
            level = 1j * circle[0].imag
            yield line(wall.z0 - base - far + level, wall.z1 - base + far + level, "CENTRE")


def _diameter(diameter: TurnedDiameter, thickness: float, bench: Bench) -> Options:
    """The places of a diameter's dimension beside the section."""
    height = 1j * diameter.radius
    mark = Distance(diameter.z1 - height, diameter.z1 + height, 0j, 0.5 * math.pi,
                    DIAMETER, fit(diameter, bench.spec), EXACT[bench.unit])  # fmt: skip
    options = dimension_options(mark, 1.0 + 0.0j, _dimension_places(thickness, bench), 1j, bench)
    return with_datum(options, "A", bench) if diameter.is_bore else options


def _dimension_places(start: float, bench: Bench) -> Iterator[tuple[float, float]]:
    """Places beyond an edge of the section [mm of the part], each after its cost."""
    steps = islice(count(STEP, FINER), PLACES)
    return ((FARTHER * (distance - STEP), start + distance / bench.scale) for distance in steps)


def heights(
    shape: Shape, section_marks: Sequence[Mark], box: tuple[complex, complex], bench: Bench
) -> Iterator[Options]:
    """The dimension of the thickness below the section, and those of the heights of its walls above
    it, the smallest first.

    A wall as high as the whole part has none, nor have letters, which the notes describe. Points
    that are measured lie on the faces, beside chamfers; `section_marks` have sharp edges.
    """
    layers, thickness = shape.part.layers, shape.part.thickness
    corners = chamfer_corners(shape)

    def on_faces(ends: tuple[complex, complex]) -> tuple[complex, complex]:
        one, other = (
            next((corner.on_face for corner in corners if corner.has(end, NEAR * shape.size)), end)
            for end in ends
        )
        return one, other

    base = layers[0].z0
    ends = (
        complex(0.0, _lowest(section_marks, 0.0, layers[0].z1 - base)),
        complex(thickness, _lowest(section_marks, layers[-1].z0 - base, thickness)),
    )
    yield _height(on_faces(ends), -1j, -box[0].imag, bench)
    # Walls between the same heights share a dimension, at the outermost of them.
    tops: dict[tuple[float, float], float] = {}
    for wall in shape.part.walls:
        edge = shape.edge(wall.boundary)
        if edge.is_letter:
            continue
        ring = edge.contour.points(COARSE * shape.size)
        cut = crossings(1j * ring.conj(), 0.0)
        span = wall.z0 - base, wall.z1 - base
        if len(cut) and span != (0.0, thickness):
            tops[span] = max(float(np.max(cut)), tops.get(span, -math.inf))
    for span in sorted(tops, key=lambda each: (each[1] - each[0], each[0])):
        ends = complex(span[0], tops[span]), complex(span[1], tops[span])
        yield _height(on_faces(ends), 1j, box[1].imag, bench)


def _height(ends: tuple[complex, complex], way: complex, edge: float, bench: Bench) -> Options:
    """The places of a height's dimension above or below the section."""
    mark = Distance(*ends, 0j, decimals=EXACT[bench.unit])
    return dimension_options(mark, way, _dimension_places(edge, bench), -1.0, bench)


def _lowest(marks: Sequence[Mark], z0: float, z1: float) -> float:
    """Lowest y [mm] of the edges of a section along the layer from `z0` to `z1`."""
    levels = []
    for mark in marks:
        if isinstance(mark, Chain) and mark.vertices[0].imag == mark.vertices[1].imag:
            start, end = sorted(mark.vertices.real.tolist())
            if start <= z0 and end >= z1:
                levels.append(float(mark.vertices[0].imag))
    return min(levels, default=0.0)


# -- dimensions -----------------------------------------------------------------------------------
# The dimensions of a part: their definition points are on its edges, and their numbers are
# measured.
#
# Each function gives the places that a dimension may have, from which `placed_marks` chooses.


EXACT: Final[dict[LengthUnit, int]] = {"mm": 4, "inch": 5}
"""Decimals of lengths that the scene states."""

AUXILIARY: Final[dict[LengthUnit, int]] = {"mm": 2, "inch": 3}
"""Decimals of auxiliary dimensions, in brackets, which follow from the curve."""

STEP: Final = 9.0
"""Distance from an edge to the nearest dimension line [mm of paper]."""

FINER: Final = 3.0
"""Distance between further places that are tried [mm of paper]."""

FARTHER: Final = 0.1
"""Cost of each millimetre farther away: twenty cost as much as crossing an edge."""

TURNED: Final = 0.2
"""Cost of each further direction that is tried."""

BEYOND: Final = 24.0
"""Largest distance of dimensions from a view [mm of paper]."""

FIRST_LEADER: Final = 8.0
"""Shortest leader [mm of paper]."""

SLANTED: Final = math.radians(-60.0)
"""Preferred direction of the leader to a circle about the cam axis [rad]."""

LEANING: Final = 0.06
"""Angle by which upright leaders are turned [rad]: the text is on the side to which they lean."""

MOST_HOLES: Final = 12
"""Largest number of holes of a pattern at which its dimension may stand."""


UPRIGHT: Final = 1e-9
"""Angles within this of 0 or a quarter turn [rad] are meant to be that; on the wrong side of it,
CAD programs turn texts over."""


TEXT_OUTSIDE: Final = 7.5
"""Distance from the measured stretch to a text outside, for an arrow with its tail [mm of
paper]."""


@dataclass(frozen=True, slots=True)
class Bench:
    """What the places of dimensions depend on.

    Attributes
    ----------
    spec : the drawing that the scene states.
    unit : unit of the dimensions.
    scale : millimetres of paper for each millimetre of the part.
    reach : largest distance of the view from the cam axis [mm of the part].
    """

    spec: DrawingSpec
    unit: LengthUnit
    scale: float
    reach: float

    def places(self, start: float) -> Iterator[tuple[float, float]]:
        """Distances from the cam axis [mm of the part], each after its cost.

        They begin `STEP` of paper beyond `start` [mm of the part].
        """
        far = (self.reach + BEYOND / self.scale - start) * self.scale
        steps = takewhile(lambda distance: distance <= max(far, STEP), count(STEP, FINER))
        return ((FARTHER * (distance - STEP), start + distance / self.scale) for distance in steps)


@dataclass(frozen=True, slots=True)
class Keyway:
    """A keyway as it lies in a bore [mm].

    Attributes
    ----------
    left, right : corners of its bottom.
    far : the opposite point of the bore.
    outward : unit vector from the cam axis through the middle of the keyway.
    radius : radius of the bore.
    """

    left: complex
    right: complex
    far: complex
    outward: complex
    radius: float

    @property
    def bottom(self) -> float:
        """Distance of its bottom from the cam axis [mm]."""
        return ((self.left + self.right) / 2.0 * self.outward.conjugate()).real


def find_keyway(edge: Edge) -> Keyway | None:
    """The keyway of a bore, from its contour of three lines and an arc; None if it has none."""
    contour, circle = edge.contour, edge.circle
    lines = np.flatnonzero(contour.sweeps == 0.0)
    if not edge.boundary.hole or circle is None or len(lines) != 3:
        return None
    # The first of the three lines is the one that does not follow another line.
    side = int(next((k for k in lines if (k - 1) % len(contour) not in lines), -1))
    if side < 0:
        return None
    corners = [complex(contour.vertices[(side + k) % len(contour)]) for k in (1, 2)]
    outward = (sum(corners) / 2.0) - circle[0]
    outward /= abs(outward)
    return Keyway(corners[1], corners[0], circle[0] - circle[1] * outward, outward, circle[1])


def datum(foot: complex, outward: complex, name: str) -> list[Mark]:
    """Datum (ISO 5459): its triangle stands on a line at `foot`, its letter is along `outward`."""
    base = (foot + 1.7j * outward, foot - 1.7j * outward, foot + 3.0 * outward)
    middle = foot + (7.0 + 0.5 * CELL) * outward
    corner = middle - complex(0.5 * CELL, 0.5 * CELL)
    return [
        Filled(base),
        line(foot + 3.0 * outward, foot + 7.0 * outward, "SYMBOL"),
        rectangle(corner, CELL, CELL, "SYMBOL"),
        Label(name, middle - 0.5j * LETTER, LETTER, "centre", "SYMBOL"),
    ]


def has_room(mark: Distance, scale: float, unit: LengthUnit) -> bool:
    """Whether the text of a dimension fits between its extension lines."""
    return text_width(dimension_text(mark, unit), LETTERS) + 1.0 <= mark.measure * scale


def has_arrows_outside(mark: Distance, scale: float) -> bool:
    """Whether there is no room for the arrows of a dimension between its extension lines."""
    return mark.measure * scale < 2.0 * ARROW + LIFTED


def upright(mark: Distance) -> Distance:
    """The same dimension with its text readable from below or from the right, and ends in order."""
    angle = math.remainder(mark.angle, math.pi)
    if abs(angle + 0.5 * math.pi) < UPRIGHT:
        angle = 0.5 * math.pi
    angle = 0.0 if abs(angle) < UPRIGHT else angle
    along = cmath.rect(1.0, angle)
    ends = sorted((mark.first, mark.second), key=lambda end: (end * along.conjugate()).real)
    return replace(mark, angle=angle, first=ends[0], second=ends[1])


def placed(mark: Distance, scale: float, unit: LengthUnit, preferred: complex) -> Iterator[Option]:
    """The dimension with its text in the middle, if there is room, and at either side.

    A text outside is rather in the direction `preferred`, and the dimension line continues below
    it.
    """
    mark = upright(mark)
    along = cmath.rect(1.0, mark.angle)
    inside = has_room(mark, scale, unit)
    if inside:
        yield 0.0, (mark,)
    wide, room = text_width(dimension_text(mark, unit), LETTERS), mark.measure * scale
    better = 1.0 if (preferred * along.conjugate()).real >= 0.0 else -1.0
    for sense in (better, -better):
        price = (1.0 if inside else 0.0) + (0.5 if sense != better else 0.0)
        moved = replace(mark, aside=sense * (0.5 * room + TEXT_OUTSIDE + 0.5 * wide))
        start = line_middle(moved) + sense * along * (0.5 * room + 0.5 * ARROW) / scale
        end = line_middle(moved) + sense * along * (0.5 * room + TEXT_OUTSIDE + wide) / scale
        yield price, (moved, line(start, end, "DIMENSION"))


def line_middle(mark: Distance) -> complex:
    """The middle of the measured stretch on the dimension line."""
    along = cmath.rect(1.0, mark.angle)
    offset = 0.5 * (mark.first + mark.second) - mark.line
    return mark.line + along * (offset * along.conjugate()).real


def dimension_options(
    mark: Distance,
    way: complex,
    places: Iterable[tuple[float, float]],
    preferred: complex,
    bench: Bench,
) -> Iterator[Option]:
    """The dimension at each of the `places` along `way`, which come after their costs.

    Its text is where `placed` puts it.
    """
    for price, place in places:
        candidate = replace(mark, line=way * place)
        for more, marks in placed(candidate, bench.scale, bench.unit, preferred):
            yield price + more, marks


def with_datum(options: Iterable[Option], name: str, bench: Bench) -> Iterator[Option]:
    """Each option with a datum at one end of the dimension line, if the drawing has datums.

    The datum is at an end without text, in place of an arrow that would be outside.
    """
    if bench.spec.flank_tolerance is None:
        yield from options
        return
    for price, (mark, *rest) in options:
        assert isinstance(mark, Distance)
        along = cmath.rect(1.0, mark.angle)
        for bare, end, way in ((1, mark.first, -along), (2, mark.second, along)):
            if mark.aside and (mark.aside > 0.0) == (bare == 2):
                continue
            foot = mark.line + along * ((end - mark.line) * along.conjugate()).real
            dimension = replace(mark, bare=bare) if has_arrows_outside(mark, bench.scale) else mark
            yield price, (dimension, *rest, *moved(datum(0j, way, name), foot, bench.scale))


def keyway_width(key: Keyway, bench: Bench) -> Options:
    """The width of a keyway, with the datum B if there are datums."""
    across = phase(key.outward) + 0.5 * math.pi
    suffix = f" {bench.spec.keyway_fit}" if bench.spec.keyway_fit else ""
    mark = Distance(key.right, key.left, 0j, across, suffix=suffix, decimals=EXACT[bench.unit])
    places = bench.places(key.bottom)
    return with_datum(
        dimension_options(mark, key.outward, places, 1j * key.outward, bench), "B", bench
    )


def keyway_depth(key: Keyway, bench: Bench) -> Options:
    """The depth of a keyway, measured through the bore."""
    yield from _through_bore(key.far, (key.left, key.right), key.outward, key.radius, bench)


def flat_options(edge: Edge, bench: Bench) -> Options:
    """The size across the flat of a bore for a D-shaft; no options without a flat."""
    contour, circle = edge.contour, edge.circle
    flats = np.flatnonzero(contour.sweeps == 0.0)
    if circle is None or len(flats) != 1:
        return
    ends = [complex(points[flats[0]]) for points in (contour.vertices, contour.ends)]
    middle = 0.5 * (ends[0] + ends[1]) - circle[0]
    outward = middle / abs(middle)
    yield from _through_bore(circle[0] - circle[1] * outward, ends, outward, circle[1], bench)


def _through_bore(
    far: complex, ends: Sequence[complex], outward: complex, radius: float, bench: Bench
) -> Options:
    """A distance along `outward` from the point `far` of a bore to a flat bottom.

    It is measured to that of the two `ends` of the bottom that is on the side of the dimension
    line.
    """
    for aside in (1j * outward, -1j * outward):
        near = max(ends, key=lambda end: (end * aside.conjugate()).real)
        upper = TURNED if aside.imag > 0.0 else 0.0
        mark = Distance(far, near, 0j, phase(outward), decimals=EXACT[bench.unit])
        for price, marks in dimension_options(mark, aside, bench.places(radius), -outward, bench):
            yield price + upper, marks


def overall(shape: Shape, box: tuple[complex, complex], bench: Bench) -> Iterator[Options]:
    """Width and height of a part whose outermost boundary is not a circle, in brackets."""
    if shape.outermost.circle is not None:
        return
    contours = tuple(edge.contour for edge in shape.edges)
    decimals = AUXILIARY[bench.unit]
    low, high = box
    for way, down, near, far in (
        (1.0, -1j, -low.imag, high.imag),
        (1j, -1.0, -low.real, high.real),
    ):
        ends = extreme(contours, -way), extreme(contours, way)
        yield _along(ends, way, (down, near), (-down, far), decimals, bench)


def _along(
    ends: tuple[complex, complex], way: complex, near: tuple[complex, float],
    far: tuple[complex, float], decimals: int, bench: Bench,
) -> Options:  # fmt: skip
    """The distance of two ends along `way`, beyond the view on one side or the other."""
    mark = Distance(*ends, 0j, phase(way), "(", ")", decimals)
    for later, (aside, edge) in enumerate((near, far)):
        places = [
            (FARTHER * FINER * number + 2.0 * later, edge + (STEP + FINER * number) / bench.scale)
            for number in range(8)
        ]
        yield from dimension_options(mark, aside, places, way, bench)


@dataclass(frozen=True, slots=True)
class TurnedDiameter:
    """A diameter about the cam axis, and the heights between which its edge stands [mm]."""

    edge: Edge
    radius: float
    z0: float
    z1: float
    keyway: Keyway | None

    @property
    def is_bore(self) -> bool:
        """Whether it is the bore, which centres the part on its shaft."""
        return self.edge.boundary.name == "bore"


def find_diameters(shape: Shape) -> list[TurnedDiameter]:
    """The diameters of round boundaries about the cam axis, the smallest first."""
    low = shape.part.layers[0].z0
    turned_diameters: list[TurnedDiameter] = []
    for wall in shape.part.bands:
        if not wall.is_upright:
            continue
        edge = shape.edge(wall.wall)
        if edge.circle is not None and abs(edge.circle[0]) <= 1e-9 * shape.size:
            key = find_keyway(edge)
            if any(
                math.isclose(other.radius, edge.circle[1], rel_tol=1e-9)
                for other in turned_diameters
            ):
                continue  # the hubs on both sides
            turned_diameters.append(
                TurnedDiameter(edge, edge.circle[1], wall.z0 - low, wall.z1 - low, key)
            )
    return sorted(turned_diameters, key=lambda each: each.radius)


def in_section(diameter: TurnedDiameter) -> bool:
    """Whether both ends of the diameter are on its edge in the plane of the section."""
    return all(diameter.edge.has(end) for end in (1j * diameter.radius, -1j * diameter.radius))


def fit(diameter: TurnedDiameter, spec: DrawingSpec) -> str:
    """The tolerance class after a diameter; empty without one."""
    return f" {spec.bore_fit}" if diameter.is_bore and spec.bore_fit else ""


def round_options(diameter: TurnedDiameter, bench: Bench) -> Options:
    """A diameter about the cam axis in the front view, with the datum A at that of the bore."""
    ways = [
        SLANTED + math.radians(degrees)
        for degrees in (0, 15, -15, 30, -30, 105, 120, 180, 225, 240)
    ]
    for price, mark in leaders(0j, diameter.radius, ways, fit(diameter, bench.spec), bench):
        marks: list[Mark] = [mark]
        if diameter.is_bore and bench.spec.flank_tolerance is not None:
            marks += moved(datum(0j, -1j, "A"), _shelf(mark, bench), bench.scale)
        yield price, marks


def _shelf(mark: Diameter, bench: Bench) -> complex:
    """The middle of the line below the text of a diameter [mm of the part]."""
    tip = mark.centre + cmath.rect(mark.radius, mark.angle)
    knee = tip + cmath.rect(mark.reach / bench.scale, mark.angle)
    half = 0.5 * shelf_length(dimension_text(mark, bench.unit)) / bench.scale
    return knee + (half if knee.real > tip.real else -half)


def leaders(
    centre: complex, radius: float, ways: Sequence[float], suffix: str, bench: Bench
) -> Iterator[tuple[float, Diameter]]:
    """A diameter with leaders in several directions, the better ones first, and of many lengths."""
    outside = (bench.reach - abs(centre) - radius) * bench.scale + BEYOND
    for number, way in enumerate(ways):
        angle = way if abs(math.cos(way)) > 0.5 * LEANING else way + LEANING
        for length in takewhile(lambda each: each <= outside, count(FIRST_LEADER, FINER)):
            price = TURNED * number + FARTHER * (length - FIRST_LEADER)
            yield price, Diameter(centre, radius, angle, length, 1, suffix, EXACT[bench.unit])


def hole_requests(shape: Shape, bench: Bench) -> Iterator[Options]:
    """Dimensions of round holes off the cam axis: one for each kind and each pitch circle."""
    kinds: dict[tuple[float, float], list[complex]] = {}
    for centre, radius in shape.holes:
        # Rounded to 1e-9 mm, so that equal holes have equal keys.
        kinds.setdefault((round(radius, 9), round(abs(centre), 9)), []).append(centre)
    for (radius, _), centres in kinds.items():
        yield _hole_options(centres, radius, bench)
    circles = {size: centres for (_, size), centres in reversed(kinds.items()) if len(centres) > 1}
    for centres in circles.values():
        yield _pitch_circle_options(centres, bench)


def _hole_options(centres: Sequence[complex], radius: float, bench: Bench) -> Options:
    """The places of the diameter of equal holes, at any of them, with their number before it."""
    for number, centre in enumerate(centres[:MOST_HOLES]):
        ways = [phase(centre) + math.radians(degrees) for degrees in (0, 30, -30, 60, -60, 90, -90)]
        for price, mark in leaders(centre, radius, ways, "", bench):
            yield price + TURNED * number, (replace(mark, count=len(centres)),)


def _pitch_circle_options(centres: Sequence[complex], bench: Bench) -> Options:
    """The places of the diameter of a pitch circle, with the leader between two of its holes."""
    half_pitch = math.pi / len(centres)
    first = [phase(centre) for centre in centres[:MOST_HOLES]]
    ways = [direction + share * half_pitch for share in (1.0, 0.6, 1.4) for direction in first]
    for price, mark in leaders(0j, abs(centres[0]), ways, "", bench):
        yield price, (mark,)
