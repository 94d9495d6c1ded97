"""The chamfers of a part on its sheet: their edges from above, and corners of the section."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from camgeo.geometry.contour.contour import Effort
from camgeo.geometry.contour.parallel import corners, parallel, steps_to
from camgeo.numeric.arrays import ComplexArray
from camgeo.part.part import WRITTEN_SHARE, Bevel, Boundary, written_contour
from camgeo.pictures.sheet.marks import Chain, Hatched, Mark, line
from camgeo.pictures.sheet.shape import COARSE, Shape, crossings

NEAR: Final = 30.0 * COARSE
"""Share of the size of a part within which places of a section are the same."""


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
