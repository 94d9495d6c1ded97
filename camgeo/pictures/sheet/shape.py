"""The part as a sheet needs it: its contours, what is seen of them, and the front view."""

from __future__ import annotations

import cmath
import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Final

import numpy as np

from camgeo.geometry.contour.contour import Contour, Effort
from camgeo.numeric.arrays import ComplexArray, FloatArray
from camgeo.part.part import Boundary, Part, written_contour
from camgeo.part.part import Layer as PartLayer
from camgeo.part.spec import text_of
from camgeo.pictures.sheet.marks import Chain, Label, Layer, Mark, Round, line
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

    def contours(self, layer: PartLayer) -> tuple[Contour, ...]:
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


# -- front -----------------------------------------------------------------------------------------
# The front view: the part from above, with centre lines, pitch curve and base circle.


DASH_DOT = (8.4, 1.05, 0.25, 1.05)
"""Line 04.1 of ISO 128-2 for lines 0.35 wide: dash, gap, dot, gap [mm of paper]."""

DASH_DOTS = (8.4, 1.05, 0.25, 1.05, 0.25, 1.05)
"""Line 05.1: the same with two dots."""

PATTERNS = {"CENTRE": DASH_DOT, "BASE_CIRCLE": DASH_DOTS}

BEYOND = 4.0
"""How far centre lines go beyond what they are of [mm of paper]."""

SMALL_BEYOND = 2.0
"""The same of holes."""


def outlines(shape: Shape) -> list[Mark]:
    """The edges of the part as they are seen from above."""
    return [mark for edge in shape.edges for mark in chains_of(shape, edge)]


def hole_centres(shape: Shape, scale: float) -> list[Mark]:
    """Centre lines of round boundaries off the cam axis: radial and along their pitch circle."""
    marks: list[Mark] = []
    circles: set[float] = set()
    holes = shape.holes
    for centre, radius in holes:
        outward = centre / abs(centre)
        far = radius + SMALL_BEYOND / scale
        marks.append(line(centre - far * outward, centre + far * outward, "CENTRE"))
        if sum(math.isclose(abs(each), abs(centre), rel_tol=1e-9) for each, _ in holes) > 1:
            if not any(math.isclose(each, abs(centre), rel_tol=1e-9) for each in circles):
                circles.add(abs(centre))
                marks.append(Round(0j, abs(centre), "CENTRE"))
        else:
            across = far * 1j * outward
            marks.append(line(centre - across, centre + across, "CENTRE"))
    return marks


def in_dashes(marks: Iterable[Mark], scale: float) -> Iterator[Mark]:
    """The marks of a view, with its centre lines and auxiliary curves in dashes and dots.

    These are lines of their own: many programs know no patterns, have patterns of another size, or
    begin them anew at each vertex, so that a curve of short arcs is drawn solid.
    """
    for mark in marks:
        pattern = PATTERNS.get(getattr(mark, "layer", ""))
        if pattern is None or isinstance(mark, Label):
            yield mark
        elif isinstance(mark, Round):
            circle = Contour.circle(mark.radius, mark.centre)
            yield from dashed(circle, scale, mark.layer, pattern)
        elif isinstance(mark, Chain) and len(mark.vertices) == 2:
            yield from _dashed_line(mark, scale, pattern)
        else:
            yield mark


def dashed(
    contour: Contour, scale: float, layer: Layer, pattern: Sequence[float]
) -> Iterator[Chain]:
    """A closed contour in dashes and dots, with a whole number of patterns around it."""
    total = float(np.cumsum(contour.lengths)[-1])
    count = max(1, round(total * scale / sum(pattern)))
    share = total / (count * sum(pattern))
    ends = _dashes(pattern, count * len(pattern), share, -0.5 * pattern[0] * share)
    for place, size in ends:
        yield cut_out(contour, place % total, size, layer)


def dashed_stretch(mark: Chain, scale: float, pattern: Sequence[float]) -> Iterator[Chain]:
    """Lines and arcs end to end in dashes, a closed chain with a whole number of patterns around
    it, an open one with a dash at each end; what is too short for a gap stays as it is.
    """
    contour = Contour.through(mark.vertices, mark.sweeps)
    if mark.closed:
        yield from dashed(contour, scale, mark.layer, pattern)
        return
    length = float(np.sum(contour.lengths[:-1]))
    count = round((length * scale - pattern[0]) / sum(pattern))
    if count < 1:
        yield mark
        return
    share = length / (count * sum(pattern) + pattern[0])
    for place, size in _dashes(pattern, count * len(pattern) + 1, share):
        yield cut_out(contour, place, min(size, length - place), mark.layer)


def _dashed_line(mark: Chain, scale: float, pattern: Sequence[float]) -> Iterator[Chain]:
    """A straight line that begins and ends with a dash; a short one is one dash."""
    start, end = (complex(each) for each in mark.vertices)
    count = round((abs(end - start) * scale - pattern[0]) / sum(pattern))
    if count < 1:
        yield mark
        return
    share = 1.0 / (count * sum(pattern) + pattern[0])
    for place, size in _dashes(pattern, count * len(pattern) + 1, share):
        way = end - start
        yield line(start + place * way, start + (place + size) * way, mark.layer)


def _dashes(
    pattern: Sequence[float], pieces: int, share: float, place: float = 0.0
) -> Iterator[tuple[float, float]]:
    """Where each dash begins and how long it is, of so many dashes and gaps in turn."""
    for number in range(pieces):
        size = pattern[number % len(pattern)] * share
        if number % 2 == 0:
            yield place, size
        place += size


def cut_out(contour: Contour, first: float, size: float, layer: Layer) -> Chain:
    """The stretch of the length `size` that begins at the length `first` [mm], below the whole."""
    lengths = contour.lengths
    starts = np.concatenate(([0.0], np.cumsum(lengths)))
    index = min(int(np.searchsorted(starts, first, side="right")) - 1, len(contour) - 1)
    inside = first - float(starts[index])
    vertices, sweeps, left = [], [], size
    while True:
        share = inside / lengths[index] if lengths[index] else 0.0
        taken = min(left, float(lengths[index]) - inside)
        part = taken / float(lengths[index]) if lengths[index] else 0.0
        vertices.append(on(contour, index, share))
        sweeps.append(float(contour.sweeps[index]) * part)
        left -= taken
        if left <= 1e-12 * size:
            vertices.append(on(contour, index, share + part))
            return Chain(np.array(vertices), np.array([*sweeps, 0.0]), layer)
        index, inside = (index + 1) % len(contour), 0.0


def on(contour: Contour, index: int, share: float) -> complex:
    """The point of a piece at a share of its length."""
    start, sweep = complex(contour.vertices[index]), float(contour.sweeps[index])
    if sweep == 0.0:
        return start + share * (complex(contour.ends[index]) - start)
    centre = complex(contour.centres[index])
    return centre + (start - centre) * cmath.exp(1j * sweep * share)


# -- hidden ---------------------------------------------------------------------------------------
# Edges of which a part is hidden: the outline of the lower disc of a pair in one piece.
#
# What is seen of an edge changes where it passes under an edge above it. Places along it are
# compared one by one, as polygons, so a stretch shorter than their distance may be drawn as its
# neighbours are; the edge itself stays what it is, as its stretches are cut from its lines and
# arcs.


PLACES: Final = 720
"""Along an edge."""

NEAR: Final = 1e-4
"""Of the size of the part: an edge nearer than that to one above it is seen."""

FINE: Final = 1e-7
"""Of the length of an edge, to which the ends of its stretches are found."""


def chains_of(shape: Shape, edge: Edge) -> list[Chain]:
    """The edge as it is drawn: whole, or in stretches that are seen and hidden in turn."""
    contour, layer = edge.contour, _layer(edge)
    whole = Chain(contour.vertices, contour.sweeps, layer, closed=True)
    covers = _above(shape, edge) if layer == "OUTLINE" and not edge.boundary.hole else []
    if not covers:
        return [whole]
    size, length = shape.size, float(np.sum(contour.lengths))

    def covered(place: float) -> bool:
        here = cut_out(contour, place * length, 0.0, "OUTLINE").vertices[0]
        return any(_inside(rings, complex(here), NEAR * size) for rings in covers)

    ends = _changes(covered)
    if not ends:
        return [whole]
    found = []
    for first, last in pairwise([*ends, ends[0] + 1.0]):
        layer = "HIDDEN" if covered(0.5 * (first + last) % 1.0) else "OUTLINE"
        found.append(cut_out(contour, first * length, (last - first) * length, layer))
    return found


def _layer(edge: Edge) -> Layer:
    if edge.is_letter:
        return "ENGRAVING"
    return "HIDDEN" if edge.hidden else "OUTLINE"


def _above(shape: Shape, edge: Edge) -> list[list[ComplexArray]]:
    """The boundaries of each layer above an edge that reaches it, as polygons."""
    layers, coarse = shape.part.layers, COARSE * shape.size
    top = max(k for k, layer in enumerate(layers) if edge.boundary in layer.boundaries)
    above = [shape.contours(layer) for layer in layers[top + 1 :]]
    polygons = [[each.points(coarse) for each in contours] for contours in above]
    nearest = float(np.min(np.abs(edge.contour.points(coarse))))
    return [rings for rings in polygons if float(np.max(np.abs(rings[0]))) > nearest]


def _inside(rings: Sequence[ComplexArray], point: complex, near: float) -> bool:
    """Whether a point lies in the material of a layer, and not on its edge."""
    if not enclosing(rings, point) % 2:
        return False
    return all(_distance(ring, point) > near for ring in rings)


def _distance(ring: ComplexArray, point: complex) -> float:
    way = np.roll(ring, -1) - ring
    share = np.clip(((point - ring) * way.conj()).real / np.abs(way) ** 2, 0.0, 1.0)
    return float(np.min(np.abs(ring + share * way - point)))


def _changes(covered: Callable[[float], bool]) -> list[float]:
    """The places, as shares of the length, at which an edge goes under another or comes out."""
    places = (np.arange(PLACES + 1) / PLACES).tolist()
    seen = [covered(each) for each in places[:-1]]
    found = []
    for (low, high), before, after in zip(
        pairwise(places), seen, [*seen[1:], seen[0]], strict=True
    ):
        if before == after:
            continue
        while high - low > FINE:
            middle = 0.5 * (low + high)
            low, high = (middle, high) if covered(middle) == before else (low, middle)
        found.append(0.5 * (low + high))
    return found
