"""The dimensions of a part: definition points on its edges, and numbers that are measured."""

from __future__ import annotations

import cmath
import math
from dataclasses import dataclass

import numpy as np

from camgeo.formats.drawing import DrawingSpec
from camgeo.numeric.arrays import phase
from camgeo.sheet.marks import Chain, Diameter, Distance, Mark
from camgeo.sheet.placing import LETTERS, LIFTED, has_room, placed
from camgeo.sheet.shape import COARSE, Edge, Shape, crossings, extreme
from camgeo.units import LengthUnit

EXACT: dict[LengthUnit, int] = {"mm": 4, "inch": 5}
"""Decimals of lengths that the scene states."""

AUXILIARY: dict[LengthUnit, int] = {"mm": 2, "inch": 3}
"""Decimals of auxiliary dimensions, in brackets, of what follows from the curve."""

STEP = 9.0
"""Between dimension lines, and from the part to the first [mm of paper]."""

BEYOND = 10.0
"""From the bottom of a keyway to the dimension of its width [mm of paper]."""

UPRIGHT = 0.5
"""Cosine of the direction of a keyway below which it counts as upright."""

OUTSIDE = 8.0
"""From a circle to the middle of its diameter outside [mm of paper]."""

SHELF = 0.5 * LETTERS + LIFTED
"""From there down to the line below the text [mm of paper]."""

DIAMETER = "%%c"
"""The diameter sign, as every CAD program knows it."""


@dataclass(frozen=True, slots=True)
class Keyway:
    """A keyway as it lies in a bore [mm].

    Attributes
    ----------
    left, right : the corners of its bottom.
    far : the point of the bore opposite.
    outward : unit vector from the cam axis along its middle.
    radius : of the bore.
    """

    left: complex
    right: complex
    far: complex
    outward: complex
    radius: float

    @property
    def datum(self) -> tuple[complex, complex]:
        """The corner of its bottom where its datum stands, and the unit vector to there: away from
        the frame of the flank, which is on the upper left.
        """
        if self.outward.real < -UPRIGHT:
            return self.right, -1j * self.outward
        return self.left, 1j * self.outward

    @property
    def bottom(self) -> float:
        """Distance of its bottom from the cam axis [mm]."""
        return ((self.left + self.right) / 2.0 * self.outward.conjugate()).real


def keyway_of(edge: Edge) -> Keyway | None:
    """The keyway of a bore: three lines and the rest of the circle; None if it has none."""
    contour, circle = edge.contour, edge.circle
    lines = np.flatnonzero(contour.sweeps == 0.0)
    if not edge.boundary.hole or circle is None or len(lines) != 3:
        return None
    side = int(next((k for k in lines if (k - 1) % len(contour) not in lines), -1))
    if side < 0:
        return None
    corners = [complex(contour.vertices[(side + k) % len(contour)]) for k in (1, 2)]
    outward = (sum(corners) / 2.0) - circle[0]
    outward /= abs(outward)
    return Keyway(corners[1], corners[0], circle[0] - circle[1] * outward, outward, circle[1])


def of_keyway(key: Keyway, spec: DrawingSpec, unit: LengthUnit, scale: float) -> list[Mark]:
    """Width and depth of a keyway; the depth is measured through the bore."""
    across = phase(key.outward) + 0.5 * math.pi
    beyond = key.outward * (key.bottom + BEYOND / scale)
    below = _beside(key.outward)
    aside = below * (key.radius + 8.0 / scale)
    near = key.right if (key.right * below.conjugate()).real > 0.0 else key.left
    suffix = f" {spec.keyway_fit}" if spec.keyway_fit else ""
    width = Distance(key.right, key.left, beyond, across, suffix=suffix, decimals=EXACT[unit])
    depth = Distance(key.far, near, aside, phase(key.outward), decimals=EXACT[unit])
    return [
        *placed(width, scale, unit, -key.datum[1]),
        *placed(depth, scale, unit, -key.outward),
    ]


def _beside(outward: complex) -> complex:
    """On which side of a bore the depth of its keyway is, as a unit vector: below, or on the left
    of an upright one, on whose right the diameter is.
    """
    upright = abs(outward.real) < UPRIGHT
    aside = -1j * outward
    return min(aside, -aside, key=lambda way: way.real if upright else way.imag)


def of_flat(edge: Edge, unit: LengthUnit, scale: float) -> list[Mark]:
    """The size across the flat of a bore for a D-shaft; nothing without one."""
    contour, circle = edge.contour, edge.circle
    flats = np.flatnonzero(contour.sweeps == 0.0)
    if circle is None or len(flats) != 1:
        return []
    ends = [complex(each[flats[0]]) for each in (contour.vertices, contour.ends)]
    middle = 0.5 * (ends[0] + ends[1]) - circle[0]
    outward = middle / abs(middle)
    below = _beside(outward)
    near = max(ends, key=lambda end: (end * below.conjugate()).real)
    far, line = circle[0] - circle[1] * outward, below * (circle[1] + 8.0 / scale)
    mark = Distance(far, near, line, phase(outward), decimals=EXACT[unit])
    return list(placed(mark, scale, unit, -outward))


def overall(
    shape: Shape, box: tuple[complex, complex], unit: LengthUnit, scale: float
) -> list[Mark]:
    """Width and height of an outermost boundary that is no circle, in brackets."""
    edge = shape.outermost
    if edge.circle is not None:
        return []
    contours = (edge.contour,)
    low, _ = box
    decimals = AUXILIARY[unit]
    below, aside = low.imag - 2.0 * STEP / scale, low.real - 1.4 * STEP / scale
    width = Distance(
        extreme(contours, -1.0), extreme(contours, 1.0), 1j * below, 0.0, "(", ")", decimals
    )
    height = Distance(
        extreme(contours, -1j), extreme(contours, 1j), complex(aside), 0.5 * math.pi, "(", ")",
        decimals,
    )  # fmt: skip
    return [*placed(width, scale, unit, 1.0), *placed(height, scale, unit, 1j)]


@dataclass(frozen=True, slots=True)
class Turned:
    """A diameter about the cam axis, and the heights between which its edge stands [mm]."""

    edge: Edge
    radius: float
    z0: float
    z1: float
    keyway: Keyway | None


def turned(shape: Shape) -> list[Turned]:
    """The round boundaries about the cam axis, the smallest first."""
    low = shape.part.layers[0].z0
    found: list[Turned] = []
    for wall in shape.part.walls:
        edge = shape.edge(wall.boundary)
        if edge.circle is not None and abs(edge.circle[0]) <= 1e-9 * shape.size:
            key = keyway_of(edge)
            if any(math.isclose(each.radius, edge.circle[1], rel_tol=1e-9) for each in found):
                continue  # the hubs on both sides
            found.append(Turned(edge, edge.circle[1], wall.z0 - low, wall.z1 - low, key))
    return sorted(found, key=lambda each: each.radius)


def in_section(each: Turned) -> bool:
    """Whether both ends of the diameter are on its edge in the section."""
    return all(each.edge.has(end) for end in (1j * each.radius, -1j * each.radius))


def of_diameters(
    rounds: list[Turned], thickness: float, spec: DrawingSpec, unit: LengthUnit, scale: float
) -> list[Mark]:
    """The diameters beside the section, the smallest nearest."""
    marks: list[Mark] = []
    for number, each in enumerate(each for each in rounds if in_section(each)):
        place = thickness + STEP * (number + 1) / scale
        height = 1j * each.radius
        mark = Distance(
            each.z1 - height, each.z1 + height, complex(place), 0.5 * math.pi,
            DIAMETER, fit(each, spec), EXACT[unit],
        )  # fmt: skip
        marks += placed(mark, scale, unit, 1j)
    return marks


def fit(each: Turned, spec: DrawingSpec) -> str:
    """The tolerance class behind a diameter, empty without one."""
    is_bore = each.edge.boundary.name == "bore"
    return f" {spec.bore_fit}" if is_bore and spec.bore_fit else ""


@dataclass(frozen=True, slots=True)
class Height:
    """How high a wall stands that the section cuts: from `z0` to `z1`, where y is `place` [mm]."""

    z0: float
    z1: float
    place: float


def heights(shape: Shape, unit: LengthUnit, scale: float) -> tuple[tuple[Height, ...], ...]:
    """The heights of the walls that the section cuts, in rows without overlap, the smallest first;
    that of the whole part is not among them, nor those of letters, of which notes speak. One whose
    text stands outside has its own row.
    """
    base, size = shape.part.layers[0].z0, shape.size
    found: dict[tuple[float, float], Height] = {}
    for wall in shape.part.walls:
        edge = shape.edge(wall.boundary)
        if edge.is_letter:
            continue
        ring = edge.contour.points(COARSE * size)
        cut = crossings(1j * ring.conj(), 0.0)
        span = wall.z0 - base, wall.z1 - base
        if len(cut) and span != (0.0, shape.part.thickness):
            place = max(float(np.max(cut)), found[span].place if span in found else -math.inf)
            found[span] = Height(*span, place)
    rows: list[list[Height]] = []
    alone: list[list[Height]] = []
    for each in sorted(found.values(), key=lambda height: (height.z1 - height.z0, height.z0)):
        start, end = complex(each.z0, each.place), complex(each.z1, each.place)
        if not has_room(Distance(start, end, start, decimals=EXACT[unit]), scale, unit):
            alone.append([each])
            continue
        free = (row for row in rows if all(each.z1 <= o.z0 or each.z0 >= o.z1 for o in row))
        row = next(free, None)
        if row is None:
            rows.append([each])
        else:
            row.append(each)
    return tuple(tuple(row) for row in (*alone, *rows))


def of_heights(
    shape: Shape, drawn: list[Mark], box: tuple[complex, complex], unit: LengthUnit, scale: float
) -> list[Mark]:
    """The thickness below the section `drawn`, and the heights of its walls above it."""
    layers, decimals = shape.part.layers, EXACT[unit]
    base = layers[0].z0
    low = _lowest(drawn, 0.0, layers[0].z1 - base)
    last = _lowest(drawn, layers[-1].z0 - base, shape.part.thickness)
    place = complex(0.0, box[0].imag - STEP / scale)
    start, end = complex(0.0, low), complex(shape.part.thickness, last)
    marks = [*placed(Distance(start, end, place, decimals=decimals), scale, unit, -1.0)]
    for number, row in enumerate(heights(shape, unit, scale)):
        place = complex(0.0, box[1].imag + STEP * (number + 1) / scale)
        for each in row:
            start, end = complex(each.z0, each.place), complex(each.z1, each.place)
            marks += placed(Distance(start, end, place, decimals=decimals), scale, unit, -1.0)
    return marks


def _lowest(drawn: list[Mark], z0: float, z1: float) -> float:
    """Lowest y [mm] of the edges of a section along the layer from `z0` to `z1`."""
    found = []
    for mark in drawn:
        if isinstance(mark, Chain) and mark.vertices[0].imag == mark.vertices[1].imag:
            start, end = sorted(mark.vertices.real.tolist())
            if start <= z0 and end >= z1:
                found.append(float(mark.vertices[0].imag))
    return min(found, default=0.0)


def of_holes(shape: Shape, unit: LengthUnit) -> list[Mark]:
    """Round holes off the cam axis: one of each kind, with their number, and each pitch circle."""
    kinds: dict[tuple[float, float], list[tuple[complex, float]]] = {}
    for edge in shape.edges:
        if edge.circle is None or abs(edge.circle[0]) <= 1e-9 * shape.size:
            continue
        centre, radius = edge.circle
        kinds.setdefault((round(radius, 9), round(abs(centre), 9)), []).append((centre, radius))
    marks: list[Mark] = []
    circles: set[float] = set()
    for number, ((_, circle), found) in enumerate(kinds.items()):
        # Holes of another size at the same places are dimensioned at the next of them.
        centre, radius = found[number % len(found) if circle in circles else 0]
        count = f" ({len(found)}x)" if len(found) > 1 else ""
        marks.append(Diameter(centre, radius, phase(centre), count, EXACT[unit]))
        if len(found) > 1 and circle not in circles:
            circles.add(circle)
            aside = phase(centre * cmath.exp(0.3j))
            marks.append(Diameter(0j, abs(centre), aside, decimals=EXACT[unit]))
    return marks
