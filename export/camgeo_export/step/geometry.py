"""Points, curves and surfaces of a STEP file, from strands in the plane and heights."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import groupby

from camgeo.contour.spline import DEGREE, Arc, CubicSpline
from camgeo_export.step.text import Entities, Ref, Word, flag

Strand = Arc | CubicSpline

UP = (0.0, 0.0, 1.0)


@dataclass(frozen=True, slots=True)
class Pen:
    """What adds geometry to a file in its unit.

    Attributes
    ----------
    file : takes the entities.
    scale : of its unit [mm].
    """

    file: Entities
    scale: float

    def point(self, place: complex, z: float) -> Ref:
        """`place` [mm] at the height `z` [mm]."""
        numbers = (place.real / self.scale, place.imag / self.scale, z / self.scale)
        return self.file.shared("CARTESIAN_POINT", "", numbers)

    def direction(self, along: complex, z: float = 0.0) -> Ref:
        """Of any length in, of length 1 out."""
        size = abs(along) or 1.0
        numbers = (along.real / size, along.imag / size, z)
        return self.file.shared("DIRECTION", "", numbers)

    def along(self, way: complex, z: float = 0.0) -> Ref:
        """The vector of length 1."""
        return self.file.shared("VECTOR", "", self.direction(way, z), 1.0)

    def placement(self, origin: Ref, axis: Ref, x: complex) -> Ref:
        """Axes at a point: the third is `axis`, the first `x`, of any length."""
        return self.file.shared("AXIS2_PLACEMENT_3D", "", origin, axis, self.direction(x))

    def level_plane(self, z: float, *, upwards: bool) -> Ref:
        """The plane at a height [mm] and where its normal points."""
        axis = self.direction(0j, 1.0 if upwards else -1.0)
        return self.file.add("PLANE", "", self.placement(self.point(0j, z), axis, 1.0))

    def edge_curve(self, strand: Strand, z: float) -> tuple[Ref, bool]:
        """The curve of a strand at a height [mm], and whether both have the same direction."""
        if isinstance(strand, CubicSpline):
            return self._spline(strand, z), True
        if not strand.sweep:
            way = self.along(strand.end - strand.start)
            return self.file.add("LINE", "", self.point(strand.start, z), way), True
        axes = self.arc_axes(strand, z)
        return self.file.add("CIRCLE", "", axes, radius_of(strand) / self.scale), strand.sweep > 0.0

    def arc_axes(self, arc: Arc, z: float) -> Ref:
        """The axes of its circle, from whose first axis the arc turns counter-clockwise."""
        first = arc.start if arc.sweep > 0.0 else arc.end
        return self.placement(
            self.point(arc.centre, z), self.direction(0j, 1.0), first - arc.centre
        )

    def wall(self, strand: Strand, z: float, curve: Ref) -> tuple[Ref, bool]:
        """The upright surface on a strand, and whether its normal points to the strand's right.

        `curve` is that of the strand at the height `z` [mm].
        """
        if isinstance(strand, CubicSpline):
            up = self.along(0j, 1.0)
            return self.file.add("SURFACE_OF_LINEAR_EXTRUSION", "", curve, up), True
        if not strand.sweep:
            way = strand.end - strand.start
            axes = self.placement(self.point(strand.start, z), self.direction(-1j * way), way)
            return self.file.add("PLANE", "", axes), True
        radius = radius_of(strand) / self.scale
        surface = self.file.add("CYLINDRICAL_SURFACE", "", self.arc_axes(strand, z), radius)
        return surface, strand.sweep > 0.0

    def upright(self, place: complex, z: float) -> Ref:
        """The vertical line through a point."""
        return self.file.add("LINE", "", self.point(place, z), self.along(0j, 1.0))

    def _spline(self, spline: CubicSpline, z: float) -> Ref:
        knots = [(knot, len(list(equal))) for knot, equal in groupby(spline.knots.tolist())]
        return self.file.add(
            "B_SPLINE_CURVE_WITH_KNOTS",
            "",
            DEGREE,
            [self.point(each, z) for each in spline.controls.tolist()],
            Word(".UNSPECIFIED."),
            flag(False),
            flag(False),
            [count for _, count in knots],
            [knot for knot, _ in knots],
            Word(".UNSPECIFIED."),
        )


def radius_of(arc: Arc) -> float:
    """The radius [mm] that both ends are nearest to."""
    return 0.5 * (abs(arc.start - arc.centre) + abs(arc.end - arc.centre))
