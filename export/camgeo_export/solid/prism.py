"""The part as a closed body of triangles: boundaries extruded along Z, layer by layer.

All faces are flat at a few heights, so the body is built directly from its polygons: every vertex
remains the double that the fit gave. (A cross-section of manifold3d rounds to 1e-8 mm.) A chamfer
is a band between the polygon of its wall and the parallel of that polygon, vertex by vertex, so its
facets are flat in pairs and as many as those of an upright wall. Along corners with an arc, which
are bent, it goes in steps from parallel to parallel.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from itertools import count, groupby, pairwise, takewhile
from typing import NamedTuple

import manifold3d
import numpy as np
import shapely

from camgeo.contour.contour import Contour
from camgeo.contour.exact import matching_chords_of
from camgeo.contour.parallel import steps_to
from camgeo.errors import FileError, ToleranceError
from camgeo.numeric.arrays import ComplexArray, FloatArray, IntArray
from camgeo.part.bands import Band, Bevel
from camgeo.part.part import Boundary, Level, Part
from camgeo.reading import FACETS
from camgeo.wording import counted
from camgeo_export.apart import of_polygons, require_apart
from camgeo_export.solid.triangles import triangulated

FIT_SHARE = 0.98
"""Share of the tolerance that the chords may use; the rest is for the rounding of the file and for
the slack of the bound by which it is measured."""

LEAST_SHARE = 0.2
"""Share of the tolerance below which rounding leaves too little for the chords."""

LEAST_OF_CHAMFERS = 1e-3
"""The same where the edge of a chamfer is farther off than that of its wall: around a hole it has
a larger radius, and chords that are off by more.
"""

BENT = 0.25
"""Share of what chords may use that is left for the bent corners of chamfers between two steps."""

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
    the key of a height that the scene does not give or that is within the tolerance, or with "part"
    if walls are; FileError if the body would have more facets than `camgeo.reading` allows.
    """
    part.require_steps(tolerance)
    levels = part.levels
    rings: dict[str, ComplexArray] = {}
    for each in part.boundaries:
        rings |= _rings(each, part, tolerance, rounding)
    strips = [strip for band in part.bands for strip in _strips(band, rings)]
    least = sum(2 * len(rings[strip.lower]) for strip in strips)
    limit_facets(least, "the body would have at least")
    require_apart(part, of_polygons(rings, tolerance), tolerance)
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
    mesh.faces_of(lowest, rings, corners)
    for strip in strips:
        mesh.wall(corners[strip.lower, strip.z0], corners[strip.upper, strip.z1], skew=strip.skew)
    for level in others:
        mesh.faces_of(level, rings, corners)
    return mesh.close()


def limit_facets(facets: int, has: str = "the body would have") -> None:
    """Raise FileError if a file of so many facets would not be read back."""
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
    edges = {each.edge.name: each for each in part.bevels if each.boundary == boundary}
    share = FIT_SHARE * tolerance
    while True:
        if boundary.corner_radius is None or not edges:
            outlines, off = _polygons(boundary, edges, share)
        else:
            outlines, off = _mitred(boundary, edges, share)
        points = {name: rounding(each.real) + 1j * rounding(each.imag)
                  for name, each in outlines.items()}  # fmt: skip
        moved = max(float(abs(points[name] - each).max()) for name, each in outlines.items())
        largest = max(off.values())
        if largest + moved <= tolerance:
            break
        left = tolerance - moved
        share = FIT_SHARE * min(left, share * left / largest)
        if FIT_SHARE * left < LEAST_SHARE * tolerance or share < LEAST_OF_CHAMFERS * tolerance:
            message = f"the numbers of the format are too coarse for the {boundary.name}"
            raise ToleranceError(message, tolerance, moved / (1.0 - LEAST_SHARE))
    kept = np.all([each != np.roll(each, 1) for each in points.values()], axis=0)
    polygons = {name: each[kept] for name, each in points.items()}
    return {name: each[::-1] if boundary.hole else each for name, each in polygons.items()}


Polygons = tuple[dict[str, ComplexArray], dict[str, float]]
"""Polygons (n,) complex [mm] of boundaries by their names, and how far [mm] each is off."""


def _polygons(boundary: Boundary, edges: Mapping[str, Bevel], share: float) -> Polygons:
    """A boundary within `share` [mm], and the edges of its chamfers as parallels of its polygon."""
    fit = boundary.polyline(share)
    exact = fit.contour.vertices
    outlines = {boundary.name: exact}
    off = {boundary.name: fit.deviation}
    for name, bevel in edges.items():
        # Counter-clockwise, so a hole has its material on the right.
        by = -bevel.width if boundary.hole else bevel.width
        outlines[name] = _parallel(exact, by)
        off[name] = bevel.edge.deviation(Contour.polygon(outlines[name]))
    return outlines, off


def _mitred(boundary: Boundary, edges: Mapping[str, Bevel], share: float) -> Polygons:
    """A boundary with corners, the edges of its chamfers, and the steps to each of them."""
    bounds = {boundary.name: boundary}
    for name, bevel in edges.items():
        by = bevel.width if boundary.hole else -bevel.width
        steps = steps_to(boundary.arcs(share).contour, by, BENT * share)
        for k in range(1, steps):
            step = _step(name, k)
            bounds[step] = boundary.inset(k / steps * bevel.width, step)
        bounds[name] = bevel.edge
    contours = [each.arcs(share).contour for each in bounds.values()]
    polygons = matching_chords_of(contours, (1.0 - BENT) * share)
    outlines = dict(zip(bounds, polygons, strict=True))
    off = {name: each.deviation(Contour.polygon(outlines[name])) + BENT * share
           for name, each in bounds.items()}  # fmt: skip
    return outlines, off


def _step(name: str, number: int) -> str:
    """What a step to the edge of a chamfer is called."""
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
    """A band, a chamfer in as many steps as it has rings."""
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


def _parallel(polygon: ComplexArray, by: float) -> ComplexArray:
    """The polygon whose sides lie `by` [mm] to the left of those of a counter-clockwise one."""
    sides = np.roll(polygon, -1) - polygon
    normals = 1j * sides / np.abs(sides)
    before = np.roll(normals, 1)
    # Both sides at a vertex move by as much along their normals.
    found: ComplexArray = polygon + by * (before + normals) / (
        1.0 + (before * np.conj(normals)).real
    )
    return found


def _winds_up(ring: ComplexArray, rings: list[ComplexArray]) -> bool:
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

    def faces_of(
        self,
        level: Level,
        rings: dict[str, ComplexArray],
        corners: dict[tuple[str, float], IntArray],
    ) -> None:
        """Add the flat faces at one height: upward where material ends, downward where it begins.

        Seen from above, the rings that end and the reversed rings that begin wind once around the
        upward faces and once backwards around the downward ones.
        """
        sides = [(rings[each.name], corners[each.name, level.z]) for each in level.below]
        sides += [
            (rings[each.name][::-1], corners[each.name, level.z][::-1]) for each in level.above
        ]
        up = [_winds_up(ring, [other for other, _ in sides]) for ring, _ in sides]
        upper = [side for side, upwards in zip(sides, up, strict=True) if upwards]
        lower = [side for side, upwards in zip(sides, up, strict=True) if not upwards]
        if upper:
            self.face(upper, upwards=True)
        if lower:
            self.face([(ring[::-1], indices[::-1]) for ring, indices in lower], upwards=False)

    def face(self, sides: list[tuple[ComplexArray, IntArray]], upwards: bool) -> None:
        """Add the flat face on the left of rings with the indices of their points."""
        key = tuple(ring.tobytes() for ring, _ in sides)
        if key not in self.triangulated:  # the faces of a plate differ only in height
            self.triangulated[key] = triangulated([ring for ring, _ in sides])
        triangles = np.concatenate([each for _, each in sides])[self.triangulated[key]]
        self.faces.append(triangles if upwards else triangles[:, ::-1])

    def wall(self, lower: IntArray, upper: IntArray, *, skew: bool = False) -> None:
        """Add the wall between a ring and the same ring above it; if places of the latter do not
        lie over those of the former, by the shorter diagonals.
        """
        lower_next, upper_next = np.roll(lower, -1), np.roll(upper, -1)
        if skew:
            points = np.concatenate(self.points)
            rising, falling = (
                np.linalg.norm(points[one] - points[other], axis=1)
                for one, other in ((lower, upper_next), (lower_next, upper))
            )
            shorter = falling < rising
            one, other = np.where(shorter, lower_next, lower), np.where(shorter, upper, upper_next)
            self.faces.append(np.column_stack((lower, lower_next, other)))
            self.faces.append(np.column_stack((one, upper_next, upper)))
            return
        self.faces.append(np.column_stack((lower, lower_next, upper_next)))
        self.faces.append(np.column_stack((lower, upper_next, upper)))

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
