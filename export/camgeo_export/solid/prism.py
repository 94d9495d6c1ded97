"""The part as a closed body of triangles: boundaries extruded along Z, layer by layer.

All faces are flat at a few heights, so the body is built directly from its polygons: every vertex
remains the double that the fit gave. (A cross-section of manifold3d rounds to 1e-8 mm.) A chamfer
is a band between the polygon of its wall and the parallel of that polygon, vertex by vertex, so its
facets are flat in pairs and as many as those of an upright wall.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import groupby

import manifold3d
import numpy as np
import shapely

from camgeo.contour.contour import Contour
from camgeo.errors import FileError, ToleranceError
from camgeo.numeric.arrays import ComplexArray, FloatArray, IntArray
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
    levels, bands = part.levels, part.bands
    rings: dict[str, ComplexArray] = {}
    for each in part.boundaries:
        rings |= _rings(each, part, tolerance, rounding)
    least = sum(2 * len(rings[band.wall.name]) for band in bands)
    limit_facets(least, "the body would have at least")
    require_apart(part, of_polygons(rings, tolerance), tolerance)
    mesh = _Mesh()
    corners: dict[tuple[str, float], IntArray] = {}
    for _, group in groupby(bands, lambda band: (band.z0, band.z1)):
        same = list(group)
        for lower in (True, False):
            ends = [(band.lower.name, band.z0) if lower else (band.upper.name, band.z1)
                    for band in same]  # fmt: skip
            new = [end for end in ends if end not in corners]  # a chamfer has some of its wall
            if not new:
                continue
            height = float(rounding(np.array(new[0][1] - levels[0].z)))
            indices = mesh.level([rings[name] for name, _ in new], height)
            corners |= dict(zip(new, indices, strict=True))
    lowest, *others = levels
    mesh.faces_of(lowest, rings, corners)
    for band in bands:
        mesh.wall(corners[band.lower.name, band.z0], corners[band.upper.name, band.z1])
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
        fit = boundary.polyline(share)
        exact = fit.contour.vertices
        outlines = {boundary.name: exact}
        off = {boundary.name: fit.deviation}
        for name, bevel in edges.items():
            # Counter-clockwise, so a hole has its material on the right.
            by = -bevel.width if boundary.hole else bevel.width
            outlines[name] = _parallel(exact, by)
            off[name] = bevel.edge.deviation(Contour.polygon(outlines[name]))
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

    def wall(self, lower: IntArray, upper: IntArray) -> None:
        """Add the wall between a ring and the same ring above it."""
        lower_next, upper_next = np.roll(lower, -1), np.roll(upper, -1)
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
