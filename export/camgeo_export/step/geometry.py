"""Points, curves and surfaces of a STEP file, from strands in the plane and heights.

What is shared is shared because it is the same by construction, never because two computed numbers
happen to be equal: on another processor they might not be.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import groupby

from camgeo.contour.spline import DEGREE, Arc, CubicSpline
from camgeo_export.step.text import Entities, Ref, Word, flag

Strand = Arc | CubicSpline

UP, DOWN, ACROSS = (0.0, 0.0, 1.0), (0.0, 0.0, -1.0), (1.0, 0.0, 0.0)


@dataclass(frozen=True, slots=True)
class Ends:
    """The points at both ends of a strand at one height [mm]."""

    z: float
    start: Ref
    end: Ref


@dataclass(frozen=True, slots=True)
class Piece:
    """The geometry of one face of a wall.

    Attributes
    ----------
    curves : of its lower and its upper edge.
    same : whether they have the direction of the strand.
    surface : of the face.
    outwards : whether its normal points to the strand's right.
    """

    curves: tuple[Ref, Ref]
    same: bool
    surface: Ref
    outwards: bool


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
        return self.file.add("CARTESIAN_POINT", "", numbers)

    def axes(self, z: float, axis: tuple[float, float, float] = UP) -> Ref:
        """Axes on the cam axis at a height [mm], the third one up or down."""
        return self._placement(self.point(0j, z), self._fixed(axis), self._fixed(ACROSS))

    def level_plane(self, z: float, *, upwards: bool) -> Ref:
        """The plane at a height [mm] and where its normal points."""
        return self.file.add("PLANE", "", self.axes(z, UP if upwards else DOWN))

    def post(self, foot: Ref) -> Ref:
        """The vertical line through a point."""
        return self.file.add("LINE", "", foot, self._up())

    def rising(self, foot: Ref, along: complex, high: float) -> Ref:
        """The line from a point `along` in the plane and up by `high` [mm]."""
        size = math.hypot(abs(along), high)
        numbers = (along.real / size, along.imag / size, high / size)
        vector = self.file.add("VECTOR", "", self.file.add("DIRECTION", "", numbers), 1.0)
        return self.file.add("LINE", "", foot, vector)

    def parabola(self, controls: tuple[Ref, Ref, Ref]) -> Ref:
        """The parabola of three control points."""
        form, knots = Word(".PARABOLIC_ARC."), Word(".UNSPECIFIED.")
        return self.file.add(
            "B_SPLINE_CURVE_WITH_KNOTS", "", 2, list(controls), form, flag(False), flag(False),
            [3, 3], [0.0, 1.0], knots,
        )  # fmt: skip

    def level(self, strand: Strand, ends: Ends) -> tuple[Ref, bool]:
        """The curve of a level edge, and whether it has the direction of the strand."""
        if isinstance(strand, CubicSpline):
            return self._spline(strand, ends), True
        if not strand.sweep:
            vector = self.file.add("VECTOR", "", self._direction(strand.end - strand.start), 1.0)
            return self.file.add("LINE", "", ends.start, vector), True
        ahead = strand.sweep > 0.0
        first = (strand.start if ahead else strand.end) - strand.centre
        axes = self.placement(strand.centre, ends.z, UP, first)
        return self.file.add("CIRCLE", "", axes, radius_of(strand) / self.scale), ahead

    def upright(self, strand: Strand, ends: Ends) -> tuple[Ref, bool]:
        """The upright surface on a line or an arc, and whether its normal points to the right."""
        assert not isinstance(strand, CubicSpline)  # of which walls with chamfers have none
        if not strand.sweep:
            way = strand.end - strand.start
            return self.plane(ends.start, (-1j * way, 0.0), way), True
        ahead = strand.sweep > 0.0
        first = (strand.start if ahead else strand.end) - strand.centre
        axes = self.placement(strand.centre, ends.z, UP, first)
        radius = radius_of(strand) / self.scale
        return self.file.add("CYLINDRICAL_SURFACE", "", axes, radius), ahead

    def plane(self, through: Ref, normal: tuple[complex, float], way: complex) -> Ref:
        """The plane through a point, by its normal in the plane and upwards, and a level way."""
        across, up = normal
        size = math.hypot(abs(across), up)
        numbers = (across.real / size, across.imag / size, up / size)
        axis = self.file.add("DIRECTION", "", numbers)
        return self.file.add(
            "PLANE", "", self._placement(through, axis, self._direction(way))
        )  # fmt: skip

    def cone(self, base: Ref, radius: float, angle: float) -> Ref:
        """The cone about the third axis of `base`, of a radius [mm] there that grows along it."""
        return self.file.add("CONICAL_SURFACE", "", base, radius / self.scale, angle)

    def placement(
        self, centre: complex, z: float, axis: tuple[float, float, float], first: complex
    ) -> Ref:
        """Axes at a place [mm], the third one up or down, the first one level."""
        return self._placement(self.point(centre, z), self._fixed(axis), self._direction(first))

    def piece(self, strand: Strand, lower: Ends, upper: Ends) -> Piece:
        """The face on a strand between two heights."""
        if isinstance(strand, CubicSpline):
            curves = (self._spline(strand, lower), self._spline(strand, upper))
            surface = self.file.add("SURFACE_OF_LINEAR_EXTRUSION", "", curves[0], self._up())
            return Piece(curves, True, surface, True)
        if not strand.sweep:
            return self._straight(strand, lower, upper)
        radius = radius_of(strand) / self.scale
        # The arc turns counter-clockwise from the first axis, so that it crosses no seam.
        first = self._direction(
            (strand.start if strand.sweep > 0.0 else strand.end) - strand.centre
        )
        axes = [
            self._placement(self.point(strand.centre, ends.z), self._fixed(UP), first)
            for ends in (lower, upper)
        ]
        below, above = (self.file.add("CIRCLE", "", each, radius) for each in axes)
        surface = self.file.add("CYLINDRICAL_SURFACE", "", axes[0], radius)
        ahead = strand.sweep > 0.0
        return Piece((below, above), ahead, surface, ahead)

    def _straight(self, line: Arc, lower: Ends, upper: Ends) -> Piece:
        along = line.end - line.start
        way, normal = self._direction(along), self._direction(-1j * along)
        vector = self.file.add("VECTOR", "", way, 1.0)
        below, above = (self.file.add("LINE", "", ends.start, vector) for ends in (lower, upper))
        surface = self.file.add("PLANE", "", self._placement(lower.start, normal, way))
        return Piece((below, above), True, surface, True)

    def _spline(self, spline: CubicSpline, ends: Ends) -> Ref:
        inner = [self.point(each, ends.z) for each in spline.controls[1:-1].tolist()]
        knots = [(knot, len(list(equal))) for knot, equal in groupby(spline.knots.tolist())]
        return self.file.add(
            "B_SPLINE_CURVE_WITH_KNOTS",
            "",
            DEGREE,
            [ends.start, *inner, ends.end],
            Word(".UNSPECIFIED."),
            flag(False),
            flag(False),
            [count for _, count in knots],
            [knot for knot, _ in knots],
            Word(".UNSPECIFIED."),
        )

    def _direction(self, along: complex) -> Ref:
        """Of any length in, of length 1 out."""
        unit = along / abs(along)
        return self.file.add("DIRECTION", "", (unit.real, unit.imag, 0.0))

    def _fixed(self, direction: tuple[float, float, float]) -> Ref:
        return self.file.shared("DIRECTION", "", direction)

    def _up(self) -> Ref:
        return self.file.shared("VECTOR", "", self._fixed(UP), 1.0)

    def _placement(self, origin: Ref, axis: Ref, first: Ref) -> Ref:
        return self.file.add("AXIS2_PLACEMENT_3D", "", origin, axis, first)


def radius_of(arc: Arc) -> float:
    """The radius [mm] that both ends are nearest to."""
    return 0.5 * (abs(arc.start - arc.centre) + abs(arc.end - arc.centre))
