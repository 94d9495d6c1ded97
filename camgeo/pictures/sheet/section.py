"""The section through the cam axis, from the layers of the part alone.

The plane is upright in the front view, x = 0, and one looks along +x, as at a view from the left:
in first-angle projection it stands to the right of the front view, with the upper face of the disc
on its right. At a height y of the front view and in a layer, what is seen is the first material at
or behind the plane. Between the heights at which a boundary passes the plane, turns back or has a
corner, that changes steadily; so lines are where it differs between neighbouring layers, or jumps
between neighbouring heights.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import count, islice, pairwise, takewhile
from typing import Final

import numpy as np

from camgeo.numeric.arrays import ComplexArray, phase
from camgeo.pictures.sheet.front import SMALL_BEYOND
from camgeo.pictures.sheet.marks import (
    DIAMETER,
    Chain,
    Diameter,
    Distance,
    Hatched,
    Layer,
    Mark,
    datum,
    line,
    moved,
)
from camgeo.pictures.sheet.placing import (
    Option,
    Options,
    has_arrows_outside,
    number_of,
    placed,
    shelf_of,
)
from camgeo.pictures.sheet.shape import (
    COARSE,
    NEAR,
    Edge,
    Shape,
    corners_of,
    crossings,
    extreme,
    kinks,
)
from camgeo.scene.formats.drawing import DrawingSpec
from camgeo.units import LengthUnit

NOTHING = math.inf
"""Distance of the first material where there is none."""

SAME = 1e-6
"""Fraction of the size of the part by which distances of the same face may differ."""

JUMP = 0.02
"""Fraction of the size by which the distance of the first material jumps at an edge."""

RECTANGLE = 4
"""Corners of a face without chamfers."""


def section(shape: Shape) -> list[Mark]:
    """The cut part: across is the height over its lowest face, up is y of the front view [mm]."""
    size, layers = shape.size, shape.part.layers
    rings = [[c.points(COARSE * size) for c in shape.contours(layer)] for layer in layers]
    sharp = [np.concatenate([kinks(c) for c in shape.contours(layer)]) for layer in layers]
    places = _places(rings, sharp, size)
    middles = [0.5 * (low + high) for low, high in pairwise(places)]
    seen = [[_first(own, y) for y in middles] for own in rings]
    low = layers[0].z0
    heights = [layers[0].z0 - low, *(layer.z1 - low for layer in layers)]
    marks: list[Mark] = []
    for k, own in enumerate(seen):
        for index, away in enumerate(own):
            if away == 0.0:
                marks.append(_face(heights[k], heights[k + 1], places[index], places[index + 1]))
    nothing = [NOTHING] * len(middles)
    for k, height in enumerate(heights):
        below = seen[k - 1] if k else nothing
        above = seen[k] if k < len(seen) else nothing
        for first, last, layer in _runs(below, above, SAME * size):
            marks.append(line(height + 1j * places[first], height + 1j * places[last], layer))
    for y in places:
        drawn = [_edge(own, tips, y, size) for own, tips in zip(rings, sharp, strict=True)]
        start = 0
        while start < len(drawn):
            end = start
            while end < len(drawn) and drawn[end] == drawn[start]:
                end += 1
            found = drawn[start]
            if found is not None:
                marks.append(line(heights[start] + 1j * y, heights[end] + 1j * y, found))
            start = end
    return marks


def hatching(face: Hatched, step: float) -> Iterator[tuple[complex, complex]]:
    """The lines of a cut face, at 45 degrees and `step` [mm] apart, through the same points in all
    faces of a view.
    """
    x0, x1 = float(face.corners.real.min()), float(face.corners.real.max())
    y0, y1 = float(face.corners.imag.min()), float(face.corners.imag.max())
    along = step * math.sqrt(2.0)
    for number in range(math.ceil((y0 - x1) / along), math.floor((y1 - x0) / along) + 1):
        rise = number * along
        start, end = max(x0, y0 - rise), min(x1, y1 - rise)
        if len(face.corners) != RECTANGLE:
            start, end = _inside(face.corners, rise, start, end)
        if start < end:
            yield complex(start, start + rise), complex(end, end + rise)


def _inside(corners: ComplexArray, rise: float, start: float, end: float) -> tuple[float, float]:
    """What of the line y = x + `rise`, x from `start` to `end`, lies in a convex polygon that runs
    counter-clockwise.
    """
    for one, other in zip(corners.tolist(), np.roll(corners, -1).tolist(), strict=True):
        normal = 1j * (other - one)  # inwards
        at_zero = ((complex(0.0, rise) - one) * normal.conjugate()).real
        pace = normal.real + normal.imag
        if pace > 0.0:
            start = max(start, -at_zero / pace)
        elif pace < 0.0:
            end = min(end, -at_zero / pace)
        elif at_zero < 0.0:
            return 0.0, 0.0
    return start, end


def _face(z0: float, z1: float, y0: float, y1: float) -> Hatched:
    return Hatched(np.array([z0 + 1j * y0, z1 + 1j * y0, z1 + 1j * y1, z0 + 1j * y1]))


def _places(
    rings: Sequence[Sequence[ComplexArray]], sharp: Sequence[ComplexArray], size: float
) -> list[float]:
    """Heights [mm], ascending, between which what is seen changes steadily in every layer."""
    found: list[float] = []
    for ring in (ring for own in rings for ring in own):
        found += crossings(1j * ring.conj(), 0.0).tolist()  # of its mirror image with x = 0
        before, after = np.roll(ring, 1), np.roll(ring, -1)
        turns = (ring.imag - before.imag) * (after.imag - ring.imag) <= 0.0
        found += ring[turns & (ring.real > 0.0)].imag.tolist()
    for tips in sharp:
        found += tips[tips.real > 0.0].imag.tolist()
    merged: list[float] = []
    for y in sorted(found):
        if not merged or y - merged[-1] > 10.0 * COARSE * size:
            merged.append(y)
    return merged


def _first(rings: Sequence[ComplexArray], y: float) -> float:
    """Distance from the plane to the first material at the height y [mm]; 0 in cut material."""
    ahead = [x for ring in rings for x in crossings(ring, y).tolist() if x > 0.0]
    if len(ahead) % 2:
        return 0.0
    return min(ahead, default=NOTHING)


def _runs(
    below: Sequence[float], above: Sequence[float], same: float
) -> Iterator[tuple[int, int, Layer]]:
    """Where a line separates two layers: first and last place, and what the line is."""
    kinds: list[Layer | None] = []
    for one, other in zip(below, above, strict=True):
        if one == other or abs(one - other) <= same:
            kinds.append(None)
        else:
            kinds.append("SECTION" if 0.0 in (one, other) else "EDGES")
    start = 0
    while start < len(kinds):
        end = start
        while end < len(kinds) and kinds[end] == kinds[start]:
            end += 1
        kind = kinds[start]
        if kind is not None:
            yield start, end, kind
        start = end


def _edge(
    rings: Sequence[ComplexArray], sharp: ComplexArray, y: float, size: float
) -> Layer | None:
    """What is drawn in a layer along the height y: a cut edge, one behind the plane, or nothing."""
    step = 20.0 * COARSE * size
    one, other = _first(rings, y - step), _first(rings, y + step)
    if one == other:
        return None
    if 0.0 in (one, other):
        return "SECTION"
    near = min(one, other)
    edges = sharp[np.abs(sharp.imag - y) <= step]
    cornered = bool(np.any(np.abs(edges.real - near) <= JUMP * size))
    return "EDGES" if cornered or abs(one - other) > JUMP * size else None


# -- section dimensions ---------------------------------------------------------------------------
# The dimensions of the section: heights above and below it, diameters beside it.


PLACES: Final = 24
"""Distances from the section that are tried."""


def diameters(rounds: Sequence[Turned], thickness: float, bench: Bench) -> Iterator[Options]:
    """The diameters that the section shows, the smallest first, which stands nearest; the datum A
    is at that of the bore.
    """
    for each in rounds:
        if in_section(each):
            yield _diameter(each, thickness, bench)


def hole_centres(shape: Shape, scale: float) -> Iterator[Mark]:
    """Centre lines of the holes off the cam axis whose middles are in the plane."""
    base, far = shape.part.layers[0].z0, SMALL_BEYOND / scale
    for wall in shape.part.walls:
        circle = shape.edge(wall.boundary).circle
        if circle is not None and abs(circle[0].real) <= 1e-9 * shape.size < abs(circle[0]):
            level = 1j * circle[0].imag
            yield line(wall.z0 - base - far + level, wall.z1 - base + far + level, "CENTRE")


def _diameter(each: Turned, thickness: float, bench: Bench) -> Options:
    height = 1j * each.radius
    for price, place in _dimension_places(thickness, bench):
        mark = Distance(each.z1 - height, each.z1 + height, complex(place), 0.5 * math.pi,
                        DIAMETER, fit(each, bench.spec), EXACT[bench.unit])  # fmt: skip
        for more, marks in placed(mark, bench.scale, bench.unit, 1j):
            if each.is_bore and bench.spec.flank_tolerance is not None:
                yield from with_datum((price + more, marks), "A", bench.scale)
            else:
                yield price + more, marks


def _dimension_places(start: float, bench: Bench) -> Iterator[tuple[float, float]]:
    """Distances beyond an edge of the section [mm of the part], and what they cost."""
    steps = islice(count(STEP, FINER), PLACES)
    return ((FARTHER * (each - STEP), start + each / bench.scale) for each in steps)


def heights(
    shape: Shape, drawn: Sequence[Mark], box: tuple[complex, complex], bench: Bench
) -> Iterator[Options]:
    """The thickness below the section `drawn` with sharp edges, and above it the heights of its
    walls, the smallest first; that of the whole part is not among them, nor those of letters, of
    which notes speak. Their points are on the faces, beside chamfers.
    """
    layers, thickness = shape.part.layers, shape.part.thickness
    corners = corners_of(shape)

    def on_faces(ends: tuple[complex, complex]) -> tuple[complex, complex]:
        one, other = (
            next((each.on_face for each in corners if each.has(end, NEAR * shape.size)), end)
            for end in ends
        )
        return one, other

    base = layers[0].z0
    ends = (complex(0.0, _lowest(drawn, 0.0, layers[0].z1 - base)),
            complex(thickness, _lowest(drawn, layers[-1].z0 - base, thickness)))  # fmt: skip
    yield _height(on_faces(ends), -1j, -box[0].imag, bench)
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
    for price, place in _dimension_places(edge, bench):
        mark = Distance(*ends, way * place, decimals=EXACT[bench.unit])
        for more, marks in placed(mark, bench.scale, bench.unit, -1.0):
            yield price + more, marks


def _lowest(drawn: Sequence[Mark], z0: float, z1: float) -> float:
    """Lowest y [mm] of the edges of a section along the layer from `z0` to `z1`."""
    found = []
    for mark in drawn:
        if isinstance(mark, Chain) and mark.vertices[0].imag == mark.vertices[1].imag:
            start, end = sorted(mark.vertices.real.tolist())
            if start <= z0 and end >= z1:
                found.append(float(mark.vertices[0].imag))
    return min(found, default=0.0)


# -- dimensions -----------------------------------------------------------------------------------
# The dimensions of a part: definition points on its edges, and numbers that are measured.
#
# Each function gives the places that a dimension may have, for `placing` to choose from.


EXACT: Final[dict[LengthUnit, int]] = {"mm": 4, "inch": 5}
"""Decimals of lengths that the scene states."""

AUXILIARY: Final[dict[LengthUnit, int]] = {"mm": 2, "inch": 3}
"""Decimals of auxiliary dimensions, in brackets, of what follows from the curve."""

STEP: Final = 9.0
"""From an edge to the nearest dimension line [mm of paper]."""

FINER: Final = 3.0
"""Between places that are tried, away from there [mm of paper]."""

FARTHER: Final = 0.1
"""What each millimetre farther away costs: twenty are as bad as to cross an edge."""

TURNED: Final = 0.2
"""What each direction costs that is tried after others."""

BEYOND: Final = 24.0
"""How far beyond a view dimensions may stand [mm of paper]."""

FIRST_LEADER: Final = 8.0
"""Shortest leader [mm of paper]."""

SLANTED: Final = math.radians(-60.0)
"""Direction of the leader to a circle about the cam axis where there is room."""

LEANING: Final = 0.06
"""By which leaders that would be upright are turned [rad]: texts are where they lean to."""

MOST_HOLES: Final = 12
"""Of a pattern, at which its dimension may stand."""


@dataclass(frozen=True, slots=True)
class Bench:
    """What places depend on.

    Attributes
    ----------
    spec : what the scene states.
    unit : of the dimensions.
    scale : millimetres of paper for each of the part.
    reach : distance from the cam axis within which the view is [mm of the part].
    """

    spec: DrawingSpec
    unit: LengthUnit
    scale: float
    reach: float

    def places(self, start: float) -> Iterator[tuple[float, float]]:
        """Distances from the cam axis [mm of the part], `STEP` of paper after `start` and more,
        and what they cost.
        """
        far = (self.reach + BEYOND / self.scale - start) * self.scale
        steps = takewhile(lambda each: each <= max(far, STEP), count(STEP, FINER))
        return ((FARTHER * (each - STEP), start + each / self.scale) for each in steps)


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


def with_datum(option: Option, name: str, scale: float) -> Iterator[Option]:
    """The option's dimension with a datum at either end of its line where no text is, in place of
    an arrow that would be there.
    """
    price, (mark, *rest) = option
    assert isinstance(mark, Distance)
    along = cmath.rect(1.0, mark.angle)
    for bare, end, way in ((1, mark.first, -along), (2, mark.second, along)):
        if mark.aside and (mark.aside > 0.0) == (bare == 2):
            continue
        foot = mark.line + along * ((end - mark.line) * along.conjugate()).real
        own = replace(mark, bare=bare) if has_arrows_outside(mark, scale) else mark
        yield price, (own, *rest, *moved(datum(0j, way, name), foot, scale))


def keyway_width(key: Keyway, bench: Bench) -> Options:
    """The width of a keyway, with the datum B if there are datums."""
    across = phase(key.outward) + 0.5 * math.pi
    suffix = f" {bench.spec.keyway_fit}" if bench.spec.keyway_fit else ""
    for price, beyond in bench.places(key.bottom):
        mark = Distance(key.right, key.left, key.outward * beyond, across, suffix=suffix,
                        decimals=EXACT[bench.unit])  # fmt: skip
        for more, marks in placed(mark, bench.scale, bench.unit, 1j * key.outward):
            option = price + more, marks
            if bench.spec.flank_tolerance is None:
                yield option
            else:
                yield from with_datum(option, "B", bench.scale)


def keyway_depth(key: Keyway, bench: Bench) -> Options:
    """The depth of a keyway, measured through the bore."""
    ends = {1.0: key.left, -1.0: key.right}
    for sense, near in ends.items():
        aside = sense * 1j * key.outward
        upper = TURNED if aside.imag > 0.0 else 0.0
        for price, place in bench.places(key.radius):
            mark = Distance(key.far, near, aside * place, phase(key.outward),
                            decimals=EXACT[bench.unit])  # fmt: skip
            for more, marks in placed(mark, bench.scale, bench.unit, -key.outward):
                yield price + more + upper, marks


def of_flat(edge: Edge, bench: Bench) -> Options:
    """The size across the flat of a bore for a D-shaft; nothing without one."""
    contour, circle = edge.contour, edge.circle
    flats = np.flatnonzero(contour.sweeps == 0.0)
    if circle is None or len(flats) != 1:
        return
    ends = [complex(each[flats[0]]) for each in (contour.vertices, contour.ends)]
    middle = 0.5 * (ends[0] + ends[1]) - circle[0]
    outward = middle / abs(middle)
    far = circle[0] - circle[1] * outward
    for aside in (1j * outward, -1j * outward):
        near = max(ends, key=lambda end: (end * aside.conjugate()).real)
        upper = TURNED if aside.imag > 0.0 else 0.0
        for price, place in bench.places(circle[1]):
            mark = Distance(far, near, aside * place, phase(outward), decimals=EXACT[bench.unit])
            for more, marks in placed(mark, bench.scale, bench.unit, -outward):
                yield price + more + upper, marks


def overall(shape: Shape, box: tuple[complex, complex], bench: Bench) -> Iterator[Options]:
    """Width and height of a part whose outermost boundary is no circle, in brackets."""
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
    for later, (aside, edge) in enumerate((near, far)):
        for number in range(8):
            place = aside * (edge + (STEP + FINER * number) / bench.scale)
            mark = Distance(*ends, place, phase(way), "(", ")", decimals)
            for more, marks in placed(mark, bench.scale, bench.unit, way):
                yield FARTHER * FINER * number + 2.0 * later + more, marks


@dataclass(frozen=True, slots=True)
class Turned:
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


def turned(shape: Shape) -> list[Turned]:
    """The round boundaries about the cam axis, the smallest first."""
    low = shape.part.layers[0].z0
    found: list[Turned] = []
    for wall in shape.part.bands:
        if not wall.is_upright:
            continue
        edge = shape.edge(wall.wall)
        if edge.circle is not None and abs(edge.circle[0]) <= 1e-9 * shape.size:
            key = keyway_of(edge)
            if any(math.isclose(each.radius, edge.circle[1], rel_tol=1e-9) for each in found):
                continue  # the hubs on both sides
            found.append(Turned(edge, edge.circle[1], wall.z0 - low, wall.z1 - low, key))
    return sorted(found, key=lambda each: each.radius)


def in_section(each: Turned) -> bool:
    """Whether both ends of the diameter are on its edge in the section."""
    return all(each.edge.has(end) for end in (1j * each.radius, -1j * each.radius))


def fit(each: Turned, spec: DrawingSpec) -> str:
    """The tolerance class behind a diameter, empty without one."""
    return f" {spec.bore_fit}" if each.is_bore and spec.bore_fit else ""


def of_round(each: Turned, bench: Bench) -> Options:
    """A diameter about the cam axis in the front view, with the datum A at that of the bore."""
    has_datum = each.is_bore and bench.spec.flank_tolerance is not None
    text = fit(each, bench.spec)
    ways = [SLANTED + math.radians(each) for each in (0, 15, -15, 30, -30, 105, 120, 180, 225, 240)]
    for price, mark in leaders(0j, each.radius, ways, text, bench):
        if not has_datum:
            yield price, (mark,)
            continue
        yield price, (mark, *moved(datum(0j, -1j, "A"), _shelf(mark, bench), bench.scale))


def _shelf(mark: Diameter, bench: Bench) -> complex:
    """The middle of the line below the text of a diameter [mm of the part]."""
    tip = mark.centre + cmath.rect(mark.radius, mark.angle)
    knee = tip + cmath.rect(mark.reach / bench.scale, mark.angle)
    half = 0.5 * shelf_of(number_of(mark, bench.unit)) / bench.scale
    return knee + (half if knee.real > tip.real else -half)


def leaders(
    centre: complex, radius: float, ways: Sequence[float], suffix: str, bench: Bench
) -> Iterator[tuple[float, Diameter]]:
    """A diameter with leaders in some directions, the better ones first, and of many lengths."""
    outside = (bench.reach - abs(centre) - radius) * bench.scale + BEYOND
    for number, way in enumerate(ways):
        angle = way if abs(math.cos(way)) > 0.5 * LEANING else way + LEANING
        for length in takewhile(lambda each: each <= outside, count(FIRST_LEADER, FINER)):
            price = TURNED * number + FARTHER * (length - FIRST_LEADER)
            yield price, Diameter(centre, radius, angle, length, 1, suffix, EXACT[bench.unit])


def of_holes(shape: Shape, bench: Bench) -> Iterator[Options]:
    """Round holes off the cam axis: one of each kind, after their number, and each pitch circle."""
    kinds: dict[tuple[float, float], list[complex]] = {}
    for edge in shape.edges:
        if edge.circle is not None and abs(edge.circle[0]) > 1e-9 * shape.size:
            centre, radius = edge.circle
            kinds.setdefault((round(radius, 9), round(abs(centre), 9)), []).append(edge.circle[0])
    for (radius, _), found in kinds.items():
        yield _of_hole(found, radius, bench)
    circles = {size: found for (_, size), found in reversed(kinds.items()) if len(found) > 1}
    for found in circles.values():
        yield _of_circle(found, bench)


def _of_hole(found: Sequence[complex], radius: float, bench: Bench) -> Options:
    """The diameter of one of equal holes, after their number."""
    for number, centre in enumerate(found[:MOST_HOLES]):
        ways = [phase(centre) + math.radians(each) for each in (0, 30, -30, 60, -60, 90, -90)]
        for price, mark in leaders(centre, radius, ways, "", bench):
            yield price + TURNED * number, (replace(mark, count=len(found)),)


def _of_circle(found: Sequence[complex], bench: Bench) -> Options:
    """The diameter of the circle through the middles of holes, between two of them."""
    between = math.pi / len(found)
    first = [phase(centre) for centre in found[:MOST_HOLES]]
    ways = [each + share * between for share in (1.0, 0.6, 1.4) for each in first]
    for price, mark in leaders(0j, abs(found[0]), ways, "", bench):
        yield price, (mark,)
