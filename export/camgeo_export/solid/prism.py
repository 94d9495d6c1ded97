"""The part as a closed body of triangles: boundaries drawn up along Z, a groove sunk from above.

All faces are flat at a few heights, so the body is put together directly from its polygons: every
vertex stays the double that the fit gave. (A cross-section of manifold3d rounds to 1e-8 mm.)
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import manifold3d
import numpy as np

from camgeo.errors import ToleranceError
from camgeo.numeric.arrays import ComplexArray, FloatArray, IntArray
from camgeo.part.part import Boundary, Part

FIT_SHARE = 0.98
"""Share of the tolerance that the chords may use; the rest is for the rounding of the file and for
the slack of the bound with which it is measured."""

LEAST_SHARE = 0.2
"""Share of the tolerance below which rounding leaves too little for the chords."""

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

    `rounding` turns coordinates [mm] into those which the file can hold.
    """
    if part.thickness is None:
        raise ValueError("a part without thickness is no body")
    top = float(rounding(np.array(part.thickness)))
    floor = float(rounding(np.array(part.thickness - part.groove_depth)))
    through = [_ring(boundary, tolerance, rounding) for boundary in part.through]
    groove = [_ring(boundary, tolerance, rounding) for boundary in part.groove]
    mesh = _Mesh()
    below = mesh.level(through, 0.0)
    above = mesh.level(through, top)
    mesh.face(through, below, upwards=False)
    for lower, upper in zip(below, above, strict=True):
        mesh.wall(lower, upper)
    if groove:
        sunk = mesh.level(groove, floor)
        rim = mesh.level(groove, top)
        for lower, upper in zip(sunk, rim, strict=True):
            mesh.wall(lower, upper)
        # The rings of the groove run with the material on their left; its floor lies on the right.
        backwards = [ring[::-1] for ring in groove]
        mesh.face(backwards, [indices[::-1] for indices in sunk], upwards=True)
        mesh.face(through + groove, above + rim, upwards=True)
    else:
        mesh.face(through, above, upwards=True)
    return mesh.close()


def _ring(boundary: Boundary, tolerance: float, rounding: Rounding) -> ComplexArray:
    """(n,) complex [mm] polygon of the boundary as the file can hold it, material on its left."""
    share = FIT_SHARE * tolerance
    while True:
        fit = boundary.polyline(share)
        exact = fit.contour.vertices
        points = rounding(exact.real) + 1j * rounding(exact.imag)
        moved = float(abs(points - exact).max())
        if fit.deviation + moved <= tolerance:
            break
        share = (tolerance - moved) * FIT_SHARE
        if share < LEAST_SHARE * tolerance:
            message = f"the numbers of the format are too coarse for the {boundary.name}"
            raise ToleranceError(message, tolerance, moved / (1.0 - LEAST_SHARE))
    polygon: ComplexArray = points[points != np.roll(points, 1)]
    return polygon[::-1] if boundary.hole else polygon


class _Mesh:
    """Triangles in the making."""

    def __init__(self) -> None:
        self.points: list[FloatArray] = []
        self.faces: list[IntArray] = []
        self.count = 0

    def level(self, rings: list[ComplexArray], z: float) -> list[IntArray]:
        """Vertices of `rings` at height `z`; their indices, ring by ring."""
        indices = []
        for ring in rings:
            indices.append(np.arange(self.count, self.count + len(ring)))
            self.points.append(np.column_stack((ring.real, ring.imag, np.full(len(ring), z))))
            self.count += len(ring)
        return indices

    def face(self, rings: list[ComplexArray], indices: list[IntArray], upwards: bool) -> None:
        """The flat face on the left of `rings`."""
        polygons = [np.column_stack((ring.real, ring.imag)) for ring in rings]
        triangles = np.concatenate(indices)[manifold3d.triangulate(polygons)]
        self.faces.append(triangles if upwards else triangles[:, ::-1])

    def wall(self, lower: IntArray, upper: IntArray) -> None:
        """The wall between a ring and the same ring above it."""
        lower_next, upper_next = np.roll(lower, -1), np.roll(upper, -1)
        self.faces.append(np.column_stack((lower, lower_next, upper_next)))
        self.faces.append(np.column_stack((lower, upper_next, upper)))

    def close(self) -> Body:
        """The body; raises ArithmeticError if the triangles do not enclose one."""
        vertices = np.concatenate(self.points)
        triangles = np.concatenate(self.faces)
        mesh = manifold3d.Mesh64(vertices, np.ascontiguousarray(triangles, dtype=np.uint64))
        solid = manifold3d.Manifold(mesh)
        if solid.status() != manifold3d.Error.NoError or not solid.volume() > 0.0:
            raise ArithmeticError(f"the triangles enclose no body: {solid.status()}")
        return Body(vertices, triangles, float(solid.volume()))
