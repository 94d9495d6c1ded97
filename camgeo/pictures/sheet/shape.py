"""The part as a sheet needs it: its contours, where they end, what is seen, and its chamfers."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from camgeo.geometry.contour.contour import Contour, Effort
from camgeo.geometry.contour.parallel import corners, parallel, steps_to
from camgeo.numeric.arrays import ComplexArray, FloatArray
from camgeo.part.part import WRITTEN_SHARE, Bevel, Boundary, Layer, Part, written_contour
from camgeo.part.spec import text_of
from camgeo.pictures.sheet.marks import Chain, Hatched, Mark, line

COARSE = 1e-5
"""Of the size of a part, by which chords may leave its arcs where it is only asked what is seen."""

NEAR: Final = 30.0 * COARSE
"""Share of the size of a part within which places of a section are the same."""

CORNER = 0.1
"""Smallest turn of a contour's direction that is seen as an edge from the side [rad]."""

FLANKS = frozenset(("outline", "return outline", "inner flank", "outer flank"))
"""Boundaries on which a follower runs."""

ROUND = 1e-9
"""Of the size of a part: centres that differ by less are the same."""


@dataclass(frozen=True, slots=True, eq=False)
class Edge:
    """A boundary with its contour, within the tolerance.

    Attributes
    ----------
    hidden : whether all of it is below material, seen from above.
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
        return bool(text_of(self.boundary.name))

    @property
    def circle(self) -> tuple[complex, float] | None:
        """Centre and radius [mm] of a round boundary, perhaps with a keyway or a flat; None if it
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
        starts, sweeps, centres = (
            contour.vertices[bent],
            contour.sweeps[bent],
            contour.centres[bent],
        )
        turned = np.angle((point - centres) / (starts - centres)) * np.sign(sweeps)
        return bool(np.any(turned % (2.0 * np.pi) <= np.abs(sweeps)))


@dataclass(frozen=True, slots=True, eq=False)
class Shape:
    """A part with the contours of its boundaries.

    Attributes
    ----------
    part : the part.
    edges : of its boundaries, in its order.
    """

    part: Part
    edges: tuple[Edge, ...]

    @property
    def size(self) -> float:
        """Largest distance of the part from the cam axis, about [mm]."""
        return max(float(np.max(np.abs(edge.contour.vertices))) for edge in self.edges)

    @property
    def outermost(self) -> Edge:
        """The edge that goes around all others."""
        return max(self.edges, key=lambda edge: float(np.max(np.abs(edge.contour.vertices))))

    @property
    def has_heights(self) -> bool:
        """Whether the part has a thickness, and each of its layers."""
        return all(layer.z1 > layer.z0 for layer in self.part.layers)

    def edge(self, boundary: Boundary) -> Edge:
        """The edge along a boundary."""
        return next(edge for edge in self.edges if edge.boundary is boundary)

    def contours(self, layer: Layer) -> tuple[Contour, ...]:
        """Those of the boundaries of a layer."""
        return tuple(self.edge(each).contour for each in layer.boundaries)


def shape_of(part: Part, tolerance: float, effort: Effort) -> Shape:
    """The part with contours within `tolerance` [mm], those of a DXF for cutting."""
    fits = [written_contour(each, "arcs", effort, tolerance).contour for each in part.boundaries]
    found = {each.name: fit for each, fit in zip(part.boundaries, fits, strict=True)}
    coarse = COARSE * max(float(np.max(np.abs(fit.vertices))) for fit in fits)
    chords = {name: fit.points(coarse) for name, fit in found.items()}
    edges = []
    for each in part.boundaries:
        top = max(k for k, layer in enumerate(part.layers) if each in layer.boundaries)
        above = part.layers[top + 1 :]
        hidden = any(_covers([chords[b.name] for b in layer.boundaries], chords[each.name])
                     for layer in above)  # fmt: skip
        edges.append(Edge(each, found[each.name], hidden))
    return Shape(part, tuple(edges))


def _covers(section: Sequence[ComplexArray], points: ComplexArray) -> bool:
    """Whether all `points` lie in the material of a layer with these boundaries."""
    some = points[:: max(1, len(points) // 24)]
    return all(enclosing(section, point) % 2 == 1 for point in some.tolist())


def enclosing(rings: Sequence[ComplexArray], point: complex) -> int:
    """How often the ray from `point` to the right crosses closed polygons."""
    return sum(int(np.count_nonzero(crossings(each, point.imag) > point.real)) for each in rings)


def crossings(ring: ComplexArray, y: float) -> FloatArray:
    """(k,) x of the crossings of a closed polygon with a horizontal line."""
    ends = np.roll(ring, -1)
    across = (ring.imag > y) != (ends.imag > y)
    start, end = ring[across], ends[across]
    found: FloatArray = start.real + (y - start.imag) / (end.imag - start.imag) * (end - start).real
    return found


def extreme(contours: Sequence[Contour], direction: complex) -> complex:
    """The point of the contours farthest along a unit vector [mm]; exact for their arcs."""
    best, far = 0j, -np.inf
    for contour in contours:
        bent = contour.sweeps != 0.0
        starts, sweeps, centres = (
            contour.vertices[bent],
            contour.sweeps[bent],
            contour.centres[bent],
        )
        turned = np.angle(direction / (starts - centres)) * np.sign(sweeps) % (2.0 * np.pi)
        reached = turned <= np.abs(sweeps)
        tops = (centres + np.abs(starts - centres) * direction)[reached]
        for point in np.concatenate((contour.vertices, tops)).tolist():
            along = (point * direction.conjugate()).real
            if along > far:
                best, far = point, along
    return best


def kinks(contour: Contour) -> ComplexArray:
    """(k,) vertices at which the direction of the contour jumps [mm]."""
    chord = contour.ends - contour.vertices
    first = np.angle(chord) - 0.5 * contour.sweeps
    last = np.roll(first + contour.sweeps, 1)
    turn = np.abs((first - last + np.pi) % (2.0 * np.pi) - np.pi)
    return contour.vertices[turn > CORNER]


# Chamfers ---------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class Corner:
    """A corner of the section that a chamfer cuts off; across is the height, up is y [mm].

    Attributes
    ----------
    sharp : where it would be.
    on_face, on_wall : the ends of the chamfer.
    hole : whether the wall is that of a hole.
    """

    sharp: complex
    on_face: complex
    on_wall: complex
    hole: bool

    def has(self, point: complex, near: float) -> bool:
        """Whether a point is the corner."""
        return abs(point - self.sharp) <= near


def edges_above(shape: Shape, tolerance: float, effort: Effort) -> Iterator[Chain]:
    """The edges of chamfers on faces that look up, each a wide line within `tolerance` [mm]."""
    for bevel in shape.part.bevels:
        if bevel.upper:
            contour = written_contour(bevel.edge, "arcs", effort, tolerance).contour
            yield Chain(contour.vertices, contour.sweeps, "EDGES", closed=True)
            yield from _mitres(bevel, WRITTEN_SHARE * tolerance)


def _mitres(bevel: Bevel, tolerance: float) -> Iterator[Chain]:
    """The edges between the faces of a chamfer, along corners of its boundary."""
    if bevel.boundary.corner_radius is None:
        return
    contour = bevel.boundary.arcs(tolerance).contour
    by = bevel.width if bevel.boundary.hole else -bevel.width
    shares = np.linspace(0.0, 1.0, steps_to(contour, by, tolerance) + 1).tolist()
    ways = np.array([parallel(contour, share * by).vertices for share in shares])
    for k in np.flatnonzero(corners(contour)):
        yield Chain(ways[:, k], np.zeros(len(shares)), "EDGES")


def corners_of(shape: Shape) -> list[Corner]:
    """The corners of the section at which there are chamfers."""
    found = []
    base, size = shape.part.layers[0].z0, shape.size
    for bevel in shape.part.bevels:
        near = _crossings(bevel.edge, size)
        for y in _crossings(bevel.boundary, size):
            ends = [end for end in near if abs(end - y) <= 4.0 * bevel.width]
            if ends:
                end = min(ends, key=lambda each: abs(each - y))
                found.append(
                    Corner(
                        complex(bevel.z - base, y),
                        complex(bevel.z - base, end),
                        complex(bevel.foot - base, y),
                        bevel.boundary.hole,
                    )
                )
    return found


def _crossings(boundary: Boundary, size: float) -> list[float]:
    """Where a boundary crosses the plane of the section [mm], ascending."""
    ring = boundary.beside(COARSE * size).contour.points(COARSE * size)
    return sorted(crossings(1j * ring.conj(), 0.0).tolist())


def bevelled(marks: Sequence[Mark], shape: Shape) -> list[Mark]:
    """The marks of a section with its chamfers."""
    corners, near = corners_of(shape), NEAR * shape.size
    found: list[Mark] = []
    for mark in marks:
        if isinstance(mark, Hatched):
            found.append(_cut(mark, corners))
        elif isinstance(mark, Chain) and mark.layer == "SECTION":
            found.append(_shortened(mark, corners, near))
        else:
            found.append(mark)
    for corner in corners:
        found.append(line(corner.on_face, corner.on_wall, "SECTION"))
        if corner.hole:  # behind the plane the edge on the face goes on
            found.append(line(corner.sharp, corner.on_face, "EDGES"))
    found += _feet(shape)
    return found


def _cut(face: Hatched, corners: Sequence[Corner]) -> Hatched:
    """A face without the corners that chamfers cut off."""
    points = face.corners
    for each in corners:
        z = sorted((each.on_wall.real, each.sharp.real))
        y = sorted((each.on_face.imag, each.sharp.imag))
        low, high = min(points.real), max(points.real)
        left, right = min(points.imag), max(points.imag)
        if min(z[1], high) > max(z[0], low) and min(y[1], right) > max(y[0], left):
            points = _clipped(points, each.on_face, each.on_wall, each.sharp)
    return Hatched(points)


def _clipped(points: ComplexArray, one: complex, other: complex, out: complex) -> ComplexArray:
    """A convex polygon (n,) without what lies beyond a line, on the side of `out`."""
    way = other - one
    side = np.sign(((out - one) * way.conjugate()).imag)
    beyond = ((points - one) * np.conj(way)).imag * side
    kept: list[complex] = []
    for k, point in enumerate(points.tolist()):
        after = (k + 1) % len(points)
        if beyond[k] <= 0.0:
            kept.append(point)
        if (beyond[k] > 0.0) != (beyond[after] > 0.0):
            share = beyond[k] / (beyond[k] - beyond[after])
            kept.append(complex(point + share * (points[after] - point)))
    return np.array(kept, dtype=np.complex128)


def _shortened(chain: Chain, corners: Sequence[Corner], near: float) -> Chain:
    """A line up to the chamfers at its ends."""
    ends = chain.vertices.tolist()
    for k in (0, 1):
        for each in corners:
            if not each.has(ends[k], near):
                continue
            along = ends[1 - k] - ends[k]
            for end in (each.on_face, each.on_wall):
                way = end - each.sharp
                if (along * way.conjugate()).real > 0.5 * abs(along) * abs(way):
                    ends[k] = end
    return Chain(np.array(ends), chain.sweeps, chain.layer, chain.closed)


def _feet(shape: Shape) -> Iterator[Mark]:
    """The edges between the chamfers of holes and their walls, seen behind the plane; not where
    something else stands in the hole.
    """
    base, size = shape.part.layers[0].z0, shape.size
    for bevel in shape.part.bevels:
        if not bevel.boundary.hole:
            continue
        own = _crossings(bevel.boundary, size)
        others = [y for each in _beside(shape, bevel) for y in _crossings(each, size)]
        for low, high in zip(own[::2], own[1::2], strict=False):
            if not any(low < y < high for y in others):
                z = bevel.foot - base
                yield line(complex(z, low), complex(z, high), "EDGES")


def _beside(shape: Shape, bevel: Bevel) -> list[Boundary]:
    """The other boundaries at the height of a chamfer's foot."""
    return [
        each
        for layer in shape.part.layers
        if layer.z0 <= bevel.foot <= layer.z1
        for each in layer.boundaries
        if each != bevel.boundary
    ]
