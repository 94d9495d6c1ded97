"""The part as a closed body of triangles: boundaries extruded along Z, layer by layer.

All faces are flat at a few heights, so the body is built directly from its polygons: every vertex
remains the double that the fit gave. (A cross-section of manifold3d rounds to 1e-8 mm.) A chamfer
is a band between the polygon of its wall and the parallel of that polygon, vertex by vertex, so its
facets are flat in pairs and as many as those of an upright wall. Along corners with an arc, which
are bent, it goes in steps from parallel to parallel.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from itertools import combinations, count, groupby, pairwise, takewhile
from typing import NamedTuple

import manifold3d
import numpy as np
import shapely

from camgeo.errors import FileError, GeometryError, ToleranceError
from camgeo.geometry.contour.contour import Contour, Pieces, least_distance
from camgeo.geometry.contour.parallel import count_steps
from camgeo.numeric.arrays import BoolArray, ComplexArray, FloatArray, IntArray
from camgeo.part.boundaries import matching_chords
from camgeo.part.part import Band, Bevel, Boundary, Level, Part
from camgeo.reading import FACETS
from camgeo.units import counted

FIT_SHARE = 0.98
"""Share of the tolerance that the chords may use; the rest is for the rounding of the file and for
the slack of the bound by which it is measured."""

LEAST_SHARE = 0.2
"""Share of the tolerance below which rounding leaves too little for the chords."""

LEAST_CHAMFER_SHARE = 1e-3
"""The same where the edge of a chamfer deviates more than its wall: around a hole the edge has the
larger radius, so its chords deviate more.
"""

BENT = 0.25
"""Share of the chords' tolerance reserved for bent corners of chamfers between two steps."""

Rounding = Callable[[FloatArray], FloatArray]


@dataclass(frozen=True, slots=True, eq=False)
class Body:
    """A closed body, lower face at Z = 0.

    Attributes
    ----------
    vertices : (n, 3) [mm].
    triangles : (m, 3) indices, counter-clockwise seen from outside.
    volume : [mm^3].
    """

    vertices: FloatArray
    triangles: IntArray
    volume: float


def body(part: Part, tolerance: float, rounding: Rounding) -> Body:
    """The part as a body whose edges lie within `tolerance` [mm] of its boundaries.

    `rounding` turns coordinates [mm] into those which the file can hold. Raises GeometryError with
    the key of a height that the scene does not give or that is below the tolerance, or with the key
    "part" if walls come closer than the tolerance; FileError if the body would have more facets
    than `camgeo.reading` allows.
    """
    part.require_steps(tolerance)
    levels = part.levels
    rings: dict[str, ComplexArray] = {}
    for boundary in part.boundaries:
        rings |= _rings(boundary, part, tolerance, rounding)
    strips = [strip for band in part.bands for strip in _strips(band, rings)]
    least = sum(2 * len(rings[strip.lower]) for strip in strips)
    limit_facets(least, "the body would have at least")
    require_gaps(part, polygon_gaps(rings, tolerance), tolerance)
    mesh = _Mesh()
    corners: dict[tuple[str, float], IntArray] = {}
    for _, group in groupby(strips, lambda strip: (strip.z0, strip.z1)):
        same = list(group)
        for lower in (True, False):
            ends = [(strip.lower, strip.z0) if lower else (strip.upper, strip.z1)
                    for strip in same]  # fmt: skip
            new = [end for end in ends if end not in corners]  # a chamfer has some of its wall
            if not new:
                continue
            height = float(rounding(np.array(new[0][1] - levels[0].z)))
            indices = mesh.level([rings[name] for name, _ in new], height)
            corners |= dict(zip(new, indices, strict=True))
    lowest, *others = levels
    mesh.add_faces(lowest, rings, corners)
    for strip in strips:
        mesh.wall(corners[strip.lower, strip.z0], corners[strip.upper, strip.z1], skew=strip.skew)
    for level in others:
        mesh.add_faces(level, rings, corners)
    return mesh.close()


def limit_facets(facets: int, has: str = "the body would have") -> None:
    """Raise FileError if a file of that many facets could not be read back."""
    if facets > FACETS:
        raise FileError(
            f"{has} {counted(facets, 'facet')}; at most {FACETS:,} are allowed in a file that is"
            " read; a larger tolerance needs fewer"
        )


def _rings(
    boundary: Boundary, part: Part, tolerance: float, rounding: Rounding
) -> dict[str, ComplexArray]:
    """(n,) complex [mm] polygons of the boundary and of the edges of its chamfers, by their names,
    in the file's precision, material on their left.
    """
    edges = {bevel.edge.name: bevel for bevel in part.bevels if bevel.boundary == boundary}
    share = FIT_SHARE * tolerance
    # Rounding moves vertices only after the fit. If both exceed the tolerance, the fit is repeated
    # with what rounding has left, scaled by how much of its share it has used.
    while True:
        if boundary.corner_radius is None or not edges:
            outlines, deviations = _polygons(boundary, edges, share)
        else:
            outlines, deviations = _mitred(boundary, edges, share)
        points = {name: rounding(polygon.real) + 1j * rounding(polygon.imag)
                  for name, polygon in outlines.items()}  # fmt: skip
        moved = max(float(abs(points[name] - polygon).max()) for name, polygon in outlines.items())
        largest = max(deviations.values())
        if largest + moved <= tolerance:
            break
        left = tolerance - moved
        share = FIT_SHARE * min(left, share * left / largest)
        if FIT_SHARE * left < LEAST_SHARE * tolerance or share < LEAST_CHAMFER_SHARE * tolerance:
            raise ToleranceError(
                f"the number format of the file is too coarse for the {boundary.name}",
                tolerance,
                moved / (1.0 - LEAST_SHARE),
            )
    # Rounding may make neighbours coincide. Such a vertex is dropped from all polygons, so that
    # they still correspond vertex by vertex.
    distinct = np.all([polygon != np.roll(polygon, 1) for polygon in points.values()], axis=0)
    polygons = {name: polygon[distinct] for name, polygon in points.items()}
    return {name: polygon[::-1] if boundary.hole else polygon for name, polygon in polygons.items()}


Polygons = tuple[dict[str, ComplexArray], dict[str, float]]
"""Polygons (n,) complex [mm] of boundaries by their names, and the deviation [mm] of each."""


def _polygons(boundary: Boundary, edges: Mapping[str, Bevel], share: float) -> Polygons:
    """The polygons of a boundary within `share` [mm], and of the edges of its chamfers, which are
    parallels of that polygon.
    """
    fit = boundary.polyline(share)
    exact = fit.contour.vertices
    outlines = {boundary.name: exact}
    deviations = {boundary.name: fit.deviation}
    for name, bevel in edges.items():
        # Counter-clockwise, so a hole has its material on the right.
        outlines[name] = _parallel(exact, -bevel.width if boundary.hole else bevel.width)
        deviations[name] = bevel.edge.deviation(Contour.polygon(outlines[name]))
    return outlines, deviations


def _mitred(boundary: Boundary, edges: Mapping[str, Bevel], share: float) -> Polygons:
    """The polygons of a boundary with corners, of the edges of its chamfers, and of the steps
    between them.
    """
    bounds = {boundary.name: boundary}
    for name, bevel in edges.items():
        shift = bevel.width if boundary.hole else -bevel.width
        steps = count_steps(boundary.arcs(share).contour, shift, BENT * share)
        for k in range(1, steps):
            step = _step(name, k)
            bounds[step] = boundary.inset(k / steps * bevel.width, step)
        bounds[name] = bevel.edge
    contours = [bound.arcs(share).contour for bound in bounds.values()]
    polygons = matching_chords(contours, (1.0 - BENT) * share)
    outlines = dict(zip(bounds, polygons, strict=True))
    deviations = {name: bound.deviation(Contour.polygon(outlines[name])) + BENT * share
           for name, bound in bounds.items()}  # fmt: skip
    return outlines, deviations


def _step(name: str, number: int) -> str:
    """The name of a step between a wall and the edge of its chamfer."""
    return f"step {number} to the {name}"


class _Strip(NamedTuple):
    """The facets between two rings, by their names, and their heights [mm]; `skew` where arcs end
    at bent corners.
    """

    lower: str
    upper: str
    z0: float
    z1: float
    skew: bool


def _strips(band: Band, rings: Mapping[str, ComplexArray]) -> Iterator[_Strip]:
    """The strips of facets of a band; those of a chamfer are as many as its steps."""
    downwards = band.lower is not band.wall
    edge = band.lower if downwards else band.upper
    steps = takewhile(lambda name: name in rings, (_step(edge.name, k) for k in count(1)))
    names = [band.wall.name, *(() if band.is_upright else steps), edge.name]
    shares = np.linspace(0.0, 1.0, len(names)).tolist()
    if downwards:
        names.reverse()
    heights = [(1.0 - share) * band.z0 + share * band.z1 for share in shares]
    for (one, other), (z0, z1) in zip(pairwise(names), pairwise(heights), strict=True):
        yield _Strip(one, other, z0, z1, one != other and band.wall.corner_radius is not None)


def _parallel(polygon: ComplexArray, shift: float) -> ComplexArray:
    """The polygon whose sides lie `shift` [mm] to the left of those of a counter-clockwise one."""
    sides = np.roll(polygon, -1) - polygon
    normals = 1j * sides / np.abs(sides)
    preceding = np.roll(normals, 1)
    # Both sides at a vertex move by as much along their normals.
    return np.asarray(
        polygon + shift * (preceding + normals) / (1.0 + (preceding * np.conj(normals)).real)
    )


def _bounds_upward_face(ring: ComplexArray, rings: list[ComplexArray]) -> bool:
    """Whether `ring` bounds an upward face, among the disjoint `rings` of a height.

    An upward face has its outermost ring counter-clockwise and its holes clockwise.
    """
    start = shapely.Point(ring[0].real, ring[0].imag)
    others = (_polygon(other) for other in rings if other is not ring)
    around = sum(other.contains(start) for other in others)
    return bool(shapely.is_ccw(_polygon(ring).exterior)) == (around % 2 == 0)


def _polygon(ring: ComplexArray) -> shapely.Polygon:
    return shapely.Polygon(np.column_stack((ring.real, ring.imag)))


class _Mesh:
    """Triangles under construction."""

    def __init__(self) -> None:
        self.points: list[FloatArray] = []
        self.faces: list[IntArray] = []
        self.triangulated: dict[tuple[bytes, ...], IntArray] = {}
        self.count = 0

    def level(self, rings: list[ComplexArray], z: float) -> list[IntArray]:
        """Add vertices of `rings` at height `z`; return their indices, ring by ring."""
        indices = []
        for ring in rings:
            indices.append(np.arange(self.count, self.count + len(ring)))
            self.points.append(np.column_stack((ring.real, ring.imag, np.full(len(ring), z))))
            self.count += len(ring)
        return indices

    def add_faces(
        self,
        level: Level,
        rings: dict[str, ComplexArray],
        corners: dict[tuple[str, float], IntArray],
    ) -> None:
        """Add the flat faces at one height: upward where material ends, downward where it begins.

        Seen from above, the rings that end and the reversed rings that begin wind once around the
        upward faces and once backwards around the downward ones.
        """
        sides = [
            (rings[boundary.name], corners[boundary.name, level.z]) for boundary in level.below
        ]
        sides += [
            (rings[boundary.name][::-1], corners[boundary.name, level.z][::-1])
            for boundary in level.above
        ]
        upward = [_bounds_upward_face(ring, [other for other, _ in sides]) for ring, _ in sides]
        upper = [side for side, upwards in zip(sides, upward, strict=True) if upwards]
        lower = [side for side, upwards in zip(sides, upward, strict=True) if not upwards]
        if upper:
            self.face(upper, upwards=True)
        if lower:
            self.face([(ring[::-1], indices[::-1]) for ring, indices in lower], upwards=False)

    def face(self, sides: list[tuple[ComplexArray, IntArray]], upwards: bool) -> None:
        """Add the flat face on the left of rings with the indices of their points."""
        key = tuple(ring.tobytes() for ring, _ in sides)
        if key not in self.triangulated:  # the faces of a plate differ only in height
            self.triangulated[key] = triangulate([ring for ring, _ in sides])
        triangles = np.concatenate([indices for _, indices in sides])[self.triangulated[key]]
        self.faces.append(triangles if upwards else triangles[:, ::-1])

    def wall(self, lower: IntArray, upper: IntArray, *, skew: bool = False) -> None:
        """Add the wall between a ring and the same ring above it; if places of the latter do not
        lie over those of the former, by the shorter diagonals.
        """
        lower_next, upper_next = np.roll(lower, -1), np.roll(upper, -1)
        # The ends of the diagonal of each quadrilateral, which both of its facets share.
        one, other = lower, upper_next
        if skew:
            points = np.concatenate(self.points)
            rising, falling = (
                np.linalg.norm(points[start] - points[end], axis=1)
                for start, end in ((lower, upper_next), (lower_next, upper))
            )
            shorter = falling < rising
            one, other = np.where(shorter, lower_next, lower), np.where(shorter, upper, upper_next)
        self.faces += [
            np.column_stack((lower, lower_next, other)),
            np.column_stack((one, upper_next, upper)),
        ]

    def close(self) -> Body:
        """The body; raises ArithmeticError if the triangles do not enclose one, FileError if there
        are too many.
        """
        vertices = np.concatenate(self.points)
        triangles = np.concatenate(self.faces)
        limit_facets(len(triangles))
        mesh = manifold3d.Mesh64(vertices, np.ascontiguousarray(triangles, dtype=np.uint64))
        solid = manifold3d.Manifold(mesh)
        if solid.status() != manifold3d.Error.NoError or not solid.volume() > 0.0:
            raise ArithmeticError(f"the triangles enclose no body: {solid.status()}")
        return Body(vertices, triangles, float(solid.volume()))


# -- triangles ------------------------------------------------------------------------------------
# Triangles of a flat face between rings, with no vertices but theirs.
#
# The triangulation of manifold3d cuts ears, in a time that can grow with the square of the points,
# so a face of many is divided along diagonals first. A diagonal counts only if its sign tests, in
# doubles with the bound of their error, prove that it meets no side: where none is found the face
# stays whole, and what is lost is time.


PIECE = 2000
"""Points of a face above which it is divided. On the face of a disc with a bore, cutting ears off
that many points takes twice the time per point that 250 points take, which is about what division
adds."""

STARTS, QUARTERS = 8, 4
"""Vertices at which a diagonal is looked for, evenly over a ring, and the parts of the ring in each
of which it may end, at the nearest vertex."""

ROUNDING = 4.0 * 2.0**-53
"""Relative error of a sign test in doubles is below this: (3 + 16 u) u with u = 2^-53, J. R.
Shewchuk, Adaptive Precision Floating-Point Arithmetic and Fast Robust Geometric Predicates (1997).
"""

TILT, TOWARDS = 0.25, np.exp(1.0j)
"""Tilt of a face that is triangulated, and the direction [rad] in which it recedes: an axis of
symmetry that no drawing has."""


@dataclass(frozen=True, slots=True, eq=False)
class _Face:
    """A face: indices of the points of its outer ring, counter-clockwise, and of its holes."""

    outer: IntArray
    holes: tuple[IntArray, ...]

    @property
    def rings(self) -> tuple[IntArray, ...]:
        return self.outer, *self.holes

    @property
    def count(self) -> int:
        return sum(map(len, self.rings))


def triangulate(rings: list[ComplexArray], most: int = PIECE) -> IntArray:
    """(m, 3) counter-clockwise triangles of the face on the left of disjoint rings.

    They index the points of all rings in one row. Of n points around h holes there are n - 2 + 2 h
    triangles (a further outer ring has two less). `most` points are triangulated at once.
    """
    points, tilted = np.concatenate(rings), np.concatenate(_tilted(rings))
    # Positions of the points of each ring among those of all.
    indices = np.split(np.arange(len(points)), np.cumsum([len(ring) for ring in rings])[:-1])
    flat = np.column_stack((tilted.real, tilted.imag))
    if len(points) <= most:
        whole: IntArray = manifold3d.triangulate([flat[ring] for ring in indices])
        return whole
    outward = [_area(points[ring]) > 0.0 for ring in indices]
    waiting = _faces(
        [ring for ring, outer in zip(indices, outward, strict=True) if outer],
        [ring for ring, outer in zip(indices, outward, strict=True) if not outer],
        points,
    )
    triangles: list[IntArray] = []
    while waiting:
        face = waiting.pop()
        halves = _divided(face, points, tilted) if face.count > most else []
        waiting += halves
        if not halves:
            ears = manifold3d.triangulate([flat[ring] for ring in face.rings])
            triangles.append(np.concatenate(face.rings)[ears])
    return np.concatenate(triangles)


def _tilted(rings: list[ComplexArray]) -> list[ComplexArray]:
    """The rings in perspective, where the same triangles are as good.

    Straight lines stay straight and no triangle turns over, but nothing is symmetric. Of the equal
    choices that symmetry offers the last digits would pick one, and they differ by processor.
    """
    size = max(float(np.max(np.abs(ring))) for ring in rings)
    return [ring / (1.0 + TILT / size * (ring * np.conj(TOWARDS)).real) for ring in rings]


def _faces(outers: list[IntArray], holes: list[IntArray], points: ComplexArray) -> list[_Face]:
    """Each hole in the smallest of the outer rings around it."""
    if len(outers) == 1:
        return [_Face(outers[0], tuple(holes))]
    outers = sorted(outers, key=lambda ring: _area(points[ring]))
    polygons = [
        shapely.Polygon(np.column_stack((points[ring].real, points[ring].imag))) for ring in outers
    ]
    shapely.prepare(polygons)
    inner: list[list[IntArray]] = [[] for _ in outers]
    for hole in holes:
        start = shapely.Point(points[hole[0]].real, points[hole[0]].imag)
        inner[[polygon.contains(start) for polygon in polygons].index(True)].append(hole)
    return [_Face(outer, tuple(enclosed)) for outer, enclosed in zip(outers, inner, strict=True)]


def _divided(face: _Face, points: ComplexArray, tilted: ComplexArray) -> list[_Face]:
    """The face divided into two with the same points; empty if no diagonal was found."""
    if not face.holes:
        return _across(face, points, tilted)
    return _through_hole(face, points, tilted) or _across(face, points, tilted)


def _across(face: _Face, points: ComplexArray, tilted: ComplexArray) -> list[_Face]:
    """The face divided along the shortest diagonal found, a quarter of the ring on either side."""
    ring, count = face.outer, len(face.outer)
    least = max(2, count // 4)  # a side is no diagonal
    pairs = [
        (start, (start + end) % count)
        for start in _evenly(count)
        for end in _nearest(
            tilted[ring[start]], tilted[np.roll(ring, -start)], least, count - least + 1
        )
    ]
    corners = tilted[ring]
    for i, j in sorted(pairs, key=lambda pair: float(abs(corners[pair[0]] - corners[pair[1]]))):
        parts = [_along(ring, i, j), _along(ring, j, i)]
        # A diagonal outside of the ring would leave one of them clockwise.
        if all(_turns_left(points[part]) for part in parts) and _clear(
            face, points, ring[i], ring[j]
        ):
            return _faces(parts, list(face.holes), points)
    return []


def _through_hole(face: _Face, points: ComplexArray, tilted: ComplexArray) -> list[_Face]:
    """The face divided along two diagonals, from its largest hole to the outer ring."""
    order = sorted(range(len(face.holes)), key=lambda k: len(face.holes[k]))
    hole = face.holes[order[-1]]
    bridges: list[tuple[int, int]] = []
    for start in _evenly(len(hole)):
        ends = _nearest(tilted[hole[start]], tilted[face.outer], 0, len(face.outer))
        for end in sorted(
            ends, key=lambda j: float(abs(tilted[hole[start]] - tilted[face.outer[j]]))
        ):
            if _clear(face, points, face.outer[end], hole[start]):
                bridges.append((end, start))
                break
    best: list[IntArray] = []
    for (i, k), (j, m) in combinations(bridges, 2):
        there, here = points[face.outer[[i, j]]], points[hole[[k, m]]]
        if i == j or not _are_disjoint(there[0], here[0], there[1], here[1]):
            continue
        # Cut along both bridges, the ring and the hole make two rings.
        parts = [
            np.concatenate((_along(face.outer, i, j), _along(hole, m, k))),
            np.concatenate((_along(face.outer, j, i), _along(hole, k, m))),
        ]
        if not best or min(map(len, parts)) > min(map(len, best)):
            best = parts
    return _faces(best, [face.holes[k] for k in sorted(order[:-1])], points) if best else []


def _evenly(count: int) -> list[int]:
    """Positions of at most `STARTS` vertices, evenly spread over a ring of `count` vertices."""
    return sorted({count * k // STARTS for k in range(STARTS)})


def _nearest(target: complex, ring: ComplexArray, first: int, end: int) -> Iterator[int]:
    """Positions of the vertices nearest to a point, one in each part of ring[first:end]."""
    away = ring - target
    squares = away.real**2 + away.imag**2
    limits = [first + (end - first) * k // QUARTERS for k in range(QUARTERS + 1)]
    for low, high in pairwise(limits):
        if low < high:
            yield low + int(np.argmin(squares[low:high]))


def _along(ring: IntArray, i: int, j: int) -> IntArray:
    """The ring from position i on to position j, both included."""
    return ring[i : j + 1] if i < j else np.concatenate((ring[i:], ring[: j + 1]))


def _area(ring: ComplexArray) -> float:
    """Signed area of a polygon, positive if it runs counter-clockwise."""
    # From the first vertex, which keeps rounding small where the polygon lies far from the origin.
    arms = ring - ring[0]
    return 0.5 * float(np.sum((np.conj(arms) * np.roll(arms, -1)).imag))


def _turns_left(ring: ComplexArray) -> bool:
    """Whether a ring is proved counter-clockwise by its area, the rounding of the sum included."""
    reach = float(np.max(np.abs(ring - ring[0])))
    # Each of the n terms is at most reach^2 and is carried through at most n roundings.
    return _area(ring) > len(ring) ** 2 * ROUNDING * reach**2


def _clear(face: _Face, points: ComplexArray, i: int, j: int) -> bool:
    """Whether the segment between two vertices is proved to meet no side that ends at neither."""
    for ring in face.rings:
        following = np.roll(ring, -1)
        ends_there = (ring == i) | (ring == j) | (following == i) | (following == j)
        if not np.all(
            ends_there | _are_disjoint(points[i], points[j], points[ring], points[following])
        ):
            return False
    return True


def _are_disjoint(
    p: complex, q: complex, a: ComplexArray | complex, b: ComplexArray | complex
) -> BoolArray:
    """Whether segments pq and ab are proved disjoint: one lies on one side of the other's line."""
    return np.asarray(
        (_side(p, q, a) * _side(p, q, b) > 0.0) | (_side(a, b, p) * _side(a, b, q) > 0.0)
    )


def _side(
    p: ComplexArray | complex, q: ComplexArray | complex, a: ComplexArray | complex
) -> FloatArray:
    """1 where point a is proved left of the line from p to q, -1 where right, otherwise 0."""
    along, offset = np.subtract(q, p), np.subtract(a, p)
    left, right = along.real * offset.imag, along.imag * offset.real
    product = left - right
    proved = np.abs(product) > ROUNDING * (np.abs(left) + np.abs(right))
    return np.asarray(np.where(proved, np.sign(product), 0.0))


# -- apart ----------------------------------------------------------------------------------------
# Walls of a solid that its tolerance does not keep apart.


Nearest = Callable[[str, str], tuple[float, complex] | None]
"""Gives the smallest distance [mm] of the rings of two boundaries, by their names, and its place;
None if that distance exceeds the tolerance."""


def require_gaps(part: Part, nearest: Nearest, tolerance: float) -> None:
    """Raise GeometryError with key "part" and the place if two walls, or edges at one height, come
    within `tolerance` [mm], that of the rings: a file with that tolerance cannot separate them.
    """
    groups: list[Iterable[Boundary]] = [layer.boundaries for layer in part.layers]
    groups += [level.boundaries for level in part.levels]
    pairs = ((one.name, other.name) for group in groups for one, other in combinations(group, 2))
    for one, other in dict.fromkeys(pairs):
        if (closest := nearest(one, other)) is not None:
            distance, place = closest
            raise GeometryError(
                f"a solid within {tolerance:g} mm cannot separate the {one} and the {other}, which"
                f" are {distance:.3g} mm apart near ({place.real:.5g}, {place.imag:.5g}) mm; choose"
                " a smaller tolerance",
                key="part",
            )


def polygon_gaps(rings: Mapping[str, ComplexArray], tolerance: float) -> Nearest:
    """The smallest distances of rings that are polygons (n,) complex [mm]."""
    lines = {
        name: shapely.LinearRing(np.column_stack((ring.real, ring.imag)))
        for name, ring in rings.items()
    }
    # Without their trees each side of one is compared with each of the other.
    shapely.prepare(list(lines.values()))

    def nearest(one: str, other: str) -> tuple[float, complex] | None:
        if not shapely.dwithin(lines[one], lines[other], tolerance):
            return None
        x, y = shapely.get_coordinates(shapely.shortest_line(lines[one], lines[other]))[0]
        return float(shapely.distance(lines[one], lines[other])), complex(x, y)

    return nearest


def contour_gaps(contours: Mapping[str, Contour], tolerance: float) -> Nearest:
    """The smallest distances of rings that are contours of lines and arcs, in closed form."""
    boxes = {name: _box(contour) for name, contour in contours.items()}

    def nearest(one: str, other: str) -> tuple[float, complex] | None:
        if not shapely.dwithin(boxes[one], boxes[other], tolerance):
            return None
        distance = least_distance(*([Pieces.around([contours[name]]) for name in (one, other)]))
        if distance > tolerance:
            return None
        corners = contours[one].vertices, contours[other].vertices
        distances = np.abs(corners[0][:, None] - corners[1])
        return distance, complex(corners[0][np.argmin(np.min(distances, axis=1))])

    return nearest


def _box(contour: Contour) -> shapely.Polygon:
    """A box around the contour: no point of a piece is farther from its chord than the sagitta."""
    # r (1 - cos(sweep / 2)), in the form that does not cancel for flat arcs; 0 for lines.
    high = np.where(
        contour.sweeps != 0.0, 2.0 * contour.radii * np.sin(0.25 * contour.sweeps) ** 2, 0.0
    )
    points = np.concatenate((contour.vertices, contour.ends))
    reach = float(np.max(high, initial=0.0))
    low, top = np.min(points.real), np.max(points.real)
    left, right = np.min(points.imag), np.max(points.imag)
    return shapely.box(low - reach, left - reach, top + reach, right + reach)
