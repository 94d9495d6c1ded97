"""The part as a sheet needs it: its contours, where they end, and what is seen."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from camgeo.geometry.contour.contour import Contour, Effort
from camgeo.numeric.arrays import ComplexArray, FloatArray
from camgeo.part.part import Boundary, Layer, Part, written_contour
from camgeo.part.spec import text_of
from camgeo.pictures.sheet.marks import Mark
from camgeo.units import LengthUnit

COARSE = 1e-5
"""Of the size of a part, by which chords may leave its arcs where it is only asked what is seen."""


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
        starts, sweeps = contour.vertices[bent], contour.sweeps[bent]
        centres = contour.centres[bent]
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

    @property
    def holes(self) -> list[tuple[complex, float]]:
        """Centre and radius [mm] of the round boundaries off the cam axis."""
        circles = [edge.circle for edge in self.edges]
        return [each for each in circles if each is not None and abs(each[0]) > ROUND * self.size]

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
        starts, sweeps = contour.vertices[bent], contour.sweeps[bent]
        centres = contour.centres[bent]
        turned = np.angle(direction / (starts - centres)) * np.sign(sweeps) % (2.0 * np.pi)
        reached = turned <= np.abs(sweeps)
        tops = (centres + np.abs(starts - centres) * direction)[reached]
        for point in np.concatenate((contour.vertices, tops)).tolist():
            along = (point * direction.conjugate()).real
            if along > far:
                best, far = point, along
    return best


@dataclass(frozen=True, slots=True)
class Drawn:
    """What the views are made of.

    Attributes
    ----------
    shape : the part.
    pitch : the pitch curve; None if it is the outline.
    base_radius : of the base circle [mm]; None if it is not drawn: a pair in one piece has two.
    cut : the marks of the section, with sharp edges; empty without thickness.
    unit : of the dimensions.
    edges : of chamfers that are seen from above.
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
    def alone(self) -> Drawn:
        """The part without pitch curve and base circle."""
        return replace(self, pitch=None, base_radius=None)
