"""Closed contours of a file compared with exact outlines: deviation, kinks and area."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from camgeo.design.drawn import TOPOLOGY_TOLERANCE
from camgeo.design.verify import Check, at_most, failed, near
from camgeo.errors import FileError, GeometryError, ToleranceError, UndercutError
from camgeo.geometry.contour.contour import Contour
from camgeo.geometry.contour.spline import Arc, CubicSpline, SplineContour, bezier_points
from camgeo.geometry.outline.path import Path
from camgeo.geometry.outline.path import area as area_of_path
from camgeo.numeric.arrays import ComplexArray, FloatArray
from camgeo.part.boundaries import CurveBoundary, ExactBoundary
from camgeo.part.compensation import ScaledBoundary
from camgeo.part.part import Boundary
from camgeo.units import counted, place_text
from camgeo_export.reading import AnyContour

SLOPE = 18.0
"""Largest slope, times length over tolerance, of a piece's deviation along its length: a polynomial
of degree n that stays within eps over a length h has slopes of at most 2 n^2 eps/h (Markov), and to
leading order arcs leave a curve by a cubic, lines by a parabola. A contour within its tolerance has
no larger kinks than two such slopes."""

FINER = 0.1
"""Tolerance of the outline whose bends are examined, as a fraction of that of the contour."""

FINE = 1e-4
"""Tolerance of the polygons that distinguish contours, as a fraction of the outline's length: the
relative error of their areas is at most about twelve times as large."""

ROUNDING = 1e-9
"""Kinks below this [rad] are rounding errors of none; which is the largest depends on the
processor."""

INCH_SHARE = 0.01
"""Relative deviation of a ratio of sizes from 25.4 up to which mm and inch may be mixed up."""


def matched(
    contours: Sequence[AnyContour], shapes: Sequence[Shape]
) -> tuple[list[tuple[Shape, AnyContour | None]], Check]:
    """Each shape with its contour, if any, and the check that their numbers agree.

    A wrong pairing shows as a large deviation, never as a small one.
    """
    names = ", ".join(shape.name for shape in shapes)
    equal = len(contours) == len(shapes)
    note = "" if equal else f"closed contours expected: {names}"
    count = Check("contours", "", float(len(contours)), float(len(shapes)), ok=equal, note=note)
    remaining = sorted(contours, key=lambda contour: abs(contour.area))
    wanted = sorted(shapes, key=_size)
    if equal:
        outlines = [shape.polygon(FINE * shape.length) for shape in wanted]
        return list(zip(wanted, paired(contours, outlines), strict=True)), count
    pairs: list[tuple[Shape, AnyContour | None]] = []
    # Their numbers differ: each shape, the largest first, gets the contour nearest in area.
    for shape in reversed(wanted):
        best = min(
            remaining, key=lambda contour: abs(abs(contour.area) - _size(shape)), default=None
        )
        remaining = [contour for contour in remaining if contour is not best]
        pairs.insert(0, (shape, best))
    return pairs, count


def all_checks(
    contours: Sequence[AnyContour], shapes: Sequence[Shape], tolerance: float, extra: float = 0.0
) -> Iterator[Check]:
    """The number of the contours, and all checks of each; see `contour_checks`."""
    pairs, count = matched(contours, shapes)
    yield count
    for shape, contour in pairs:
        yield from contour_checks(shape, contour, tolerance, extra=extra)


def _size(shape: Shape) -> float:
    if shape.area is not None:
        return shape.area
    return abs(shape.polygon(1e-2 * shape.length).area)


def contour_checks(
    shape: Shape,
    contour: AnyContour | None,
    tolerance: float,
    *,
    extra: float = 0.0,
    where: str = "",
) -> list[Check]:
    """All checks of one contour.

    Parameters
    ----------
    shape, contour : which belong together.
    tolerance : [mm].
    extra : further contributions to the deviation [mm], e.g. gaps that were joined.
    where : location of the contour, appended to the shape's name.
    """
    label = f"{shape.name}, {where}" if where else shape.name
    if contour is None:
        return [failed("deviation", "the file has no contour for it", label)]
    if not (math.isfinite(contour.length) and contour.area != 0.0):
        return [failed("deviation", "the contour encloses nothing", label)]
    contour = contour.counter_clockwise()
    checks = [
        _deviation(shape, contour, tolerance, extra, label),
        _kink(shape, contour, tolerance, label),
    ]
    if shape.area is not None:
        allowed = tolerance * (shape.length + math.pi * tolerance)
        checks.append(near("area", contour.area, shape.area, allowed, "mm^2", label))
    return checks


def _deviation(
    shape: Shape, contour: AnyContour, tolerance: float, extra: float, label: str
) -> Check:
    try:
        value = shape.deviation(contour) + extra
    except (GeometryError, ToleranceError) as error:
        reason = error.message if isinstance(error, GeometryError) else error.reason
        if (
            isinstance(error, GeometryError) and error.key
        ):  # the fault is the contour's all the same
            reason = "the contour cannot be compared with the exact curve"
        return failed("deviation", f"{reason}; {_where(shape, contour, tolerance)}", label)
    note = "" if value <= tolerance else _where(shape, contour, tolerance)
    return at_most("deviation", value, tolerance, "mm", label, note)


def _where(shape: Shape, contour: AnyContour, tolerance: float) -> str:
    """Where the contour deviates most, by at least how much, and a possible reason."""
    share = 0.25 * tolerance
    try:
        polygon = shape.polygon(share)
    except (ToleranceError, UndercutError):
        return "the exact outline cannot be computed for comparison"
    distance, place = farthest(polygon, contour, share)
    # Polygon and chords may each be off by the share.
    least = max(distance - 2.0 * share, 0.0)
    text = f"at least {least:.3g} mm off near {place_text(place)}"
    ratio = contour.length / shape.length
    for factor, sizes in ((25.4, "inch taken for mm"), (1.0 / 25.4, "mm taken for inch")):
        if abs(ratio * factor - 1.0) < INCH_SHARE:
            text += f"; {1.0 / factor:.4g} times as large: {sizes}?"
    return text


def _kink(shape: Shape, contour: AnyContour, tolerance: float, label: str) -> Check:
    """The largest kink where the exact outline has no corner.

    The limit is what the tolerance permits: whoever rounds the numbers of a file or redraws its
    curves within the tolerance turns its pieces by no more. `SLOPE` suffices where the outline
    hardly bends along a piece; elsewhere its own turn there is allowed in addition.
    """
    joints = contour_joints(contour)
    with np.errstate(divide="ignore"):
        limits = SLOPE * tolerance * (1.0 / joints.previous_length + 1.0 / joints.next_length)
    limits = np.minimum(limits, math.pi)
    smooth = joints.kinks > ROUNDING
    for corner in shape.corners:
        distances = np.abs(joints.places - corner)
        # A corner of the outline permits a kink at the joints near it, at least at the nearest one.
        smooth &= (distances > 2.0 * tolerance) & (distances > np.min(distances))
    kinks: FloatArray = np.where(smooth, joints.kinks, 0.0)
    # The bends of the outline are computed only where they matter: they need a fine polygon.
    for k in np.flatnonzero(kinks > limits):
        limits[k] += _turn_near(shape, complex(joints.places[k]), float(kinks[k]), tolerance)
    beyond = kinks > limits
    # The largest excess if there is any, else the largest kink.
    worst = int(np.argmax(np.where(beyond, kinks - limits, -1.0) if np.any(beyond) else kinks))
    value, limit = math.degrees(float(kinks[worst])), math.degrees(float(limits[worst]))
    return at_most(
        "kink", value, limit, "deg", label, f"at {place_text(complex(joints.places[worst]))}"
    )


def _turn_near(shape: Shape, place: complex, kink: float, tolerance: float) -> float:
    """By how much [rad] the exact outline turns where it may cause a vertex's kink.

    The vertex lies within the tolerance of the outline. A bend of that angle farther from it than
    the tolerance over its sine would lie too far off the straight extension of a piece.
    """
    reach = tolerance * (1.0 + 1.0 / math.sin(min(kink, 0.5 * math.pi)))
    try:
        joints = contour_joints(shape.polygon(FINER * tolerance))
    except (ToleranceError, UndercutError):
        return 0.0
    return float(np.sum(joints.kinks[np.abs(joints.places - place) <= reach]))


# -- shapes ---------------------------------------------------------------------------------------
# The exact outlines that a file is compared with, and the joints of what is compared.


LOOSE = 1e-3
"""Tolerance of an outline's coarse polygon, as a fraction of its extent; it gives sizes, places and
lengths for limits."""

FLAT = 1e-5
"""Kinks of an outline of lines and arcs up to this angle [rad] are not corners: those from rounding
are far smaller, those of an intended corner far larger."""


@dataclass(frozen=True, slots=True, eq=False)
class Shape:
    """One exact outline.

    Attributes
    ----------
    name : of the boundary or the operation.
    deviation : proved bound [mm] on a contour's distance from it; raises GeometryError if the
        contour does not follow it.
    polygon : straight pieces within a tolerance [mm] of it.
    corners : (k,) complex [mm].
    length : [mm], to within the fraction `LOOSE` of the extent.
    area : [mm^2]; None where it is not known exactly.
    """

    name: str
    deviation: Callable[[AnyContour], float]
    polygon: Callable[[float], Contour]
    corners: ComplexArray
    length: float
    area: float | None


def boundary_shapes(
    boundaries: tuple[Boundary, ...], extent: float, tolerance: float
) -> list[Shape]:
    """The shapes of a part's boundaries.

    Parameters
    ----------
    extent : size of the part [mm], for limits.
    tolerance : of the files [mm]; shorter arcs of an outline count as corners.
    """
    return [_shape(boundary, LOOSE * extent, tolerance) for boundary in boundaries]


def _shape(boundary: Boundary, loose: float, tolerance: float) -> Shape:
    if isinstance(boundary, ScaledBoundary):
        return _scaled(boundary, loose, tolerance)

    def polygon(limit: float) -> Contour:
        return boundary.polyline(limit, "fast").contour

    length = polygon(loose).length
    if isinstance(boundary, CurveBoundary):
        corners = corners_of_path(boundary.path, tolerance)
        area: float | None = abs(area_of_path(boundary.path))
    else:
        exact = isinstance(boundary, ExactBoundary)
        contour = boundary.arcs(tolerance, "fast").contour
        corners = corners_of_contour(contour)
        area = abs(contour.area) if exact else None
    return Shape(boundary.name, boundary.deviation, polygon, corners, length, area)


def _scaled(boundary: ScaledBoundary, loose: float, tolerance: float) -> Shape:
    unscaled, factor = (
        _shape(boundary.unscaled, loose / boundary.factor, tolerance),
        boundary.factor,
    )
    return replace(
        unscaled,
        deviation=boundary.deviation,
        polygon=lambda limit: boundary.polyline(limit, "fast").contour,
        corners=unscaled.corners * factor,
        length=unscaled.length * factor,
        area=None if unscaled.area is None else unscaled.area * factor**2,
    )


def corners_of_path(path: Path, tolerance: float) -> ComplexArray:
    """(k,) complex [mm] corners of `path`, and the ends of its arcs shorter than `tolerance`."""
    slight = [pivot for pivot in path.pivots if abs(pivot.distance * pivot.sweep) <= tolerance]
    points = [point for pivot in slight for point in (pivot.start, pivot.end)]
    return np.array(points, dtype=np.complex128)


def corners_of_contour(contour: Contour) -> ComplexArray:
    """(k,) complex [mm] vertices at which a contour of tangent pieces still has a kink."""
    joints = contour_joints(contour)
    return np.asarray(joints.places[joints.kinks > FLAT])


@dataclass(frozen=True, slots=True, eq=False)
class ContourJoints:
    """The joints of a contour; joint k is where piece k begins.

    Attributes
    ----------
    places : (n,) complex [mm].
    kinks : (n,) [rad] angle between the pieces on both sides, from 0.
    previous_length, next_length : (n,) [mm] lengths of the pieces on both sides.
    """

    places: ComplexArray
    kinks: FloatArray
    previous_length: FloatArray
    next_length: FloatArray


def contour_joints(contour: AnyContour) -> ContourJoints:
    """The joints of `contour`; each cubic of a spline counts as a piece, as a file's splines need
    not be smooth inside.
    """
    if isinstance(contour, Contour):
        return _piece_joints(contour)
    parts = [_strand_joints(strand) for strand in contour.strands]
    places, starts, ends, lengths = (np.concatenate([part[k] for part in parts]) for k in range(4))
    return _joints(places, starts, ends, lengths.real)


def _piece_joints(contour: Contour) -> ContourJoints:
    chords = contour.ends - contour.vertices
    turning = 1j * np.sign(contour.sweeps)
    arcs = contour.sweeps != 0.0
    # The tangent of an arc is its arm, turned by a right angle in the sense of the sweep.
    starts = np.where(arcs, (contour.vertices - contour.centres) * turning, chords)
    ends = np.where(arcs, (contour.ends - contour.centres) * turning, chords)
    return _joints(contour.vertices, starts, ends, contour.lengths)


def _joints(
    places: ComplexArray, starts: ComplexArray, ends: ComplexArray, lengths: FloatArray
) -> ContourJoints:
    """The joints of pieces with these directions at their starts and ends, of any length."""
    # Joint k is between the end of piece k - 1 and the start of piece k.
    kinks = np.abs(np.angle(starts * np.conj(np.roll(ends, 1))))
    return ContourJoints(places, kinks, np.roll(lengths, 1), lengths)


def _strand_joints(strand: CubicSpline | Arc) -> tuple[ComplexArray, ...]:
    """Starts of the pieces of a strand, their directions at start and end, and their lengths."""
    if isinstance(strand, CubicSpline):
        pieces = strand.beziers
        first, last = pieces[:, :1], pieces[:, 3:]
        # The control polygon stands for the length: it is no shorter, so no limit of a kink is too
        # wide.
        starts = _first_leg(pieces[:, 1:] - first)
        ends = _first_leg(last - pieces[:, 2::-1])
        return pieces[:, 0], starts, ends, np.abs(np.diff(pieces, axis=1)).sum(axis=1) + 0j
    starts, ends = (np.array([strand.heading(end)]) for end in (strand.start, strand.end))
    return np.array([strand.start]), starts, ends, np.array([strand.length + 0j])


def _first_leg(legs: ComplexArray) -> ComplexArray:
    """(n,) the first of `legs` (n, 3) that is not 0: control points may coincide."""
    index = np.argmax(legs != 0.0, axis=1)
    return np.asarray(np.take_along_axis(legs, index[:, None], axis=1)[:, 0])


# -- matching -------------------------------------------------------------------------------------
# Assignment of a file's contours to the boundaries of the part.


ALIKE = 0.05
"""Areas that differ by less than this fraction do not show which is which: that of a small hole is
known no better with a tolerance for the whole drawing."""


def deviation(contours: Sequence[AnyContour], boundaries: tuple[Boundary, ...]) -> float:
    """Proved bound [mm] on the distance between the `contours` of a file and the `boundaries`.

    A wrong pairing would show as a large deviation, never as a small one. Raises FileError unless
    there are as many contours as boundaries.
    """
    if len(contours) != len(boundaries):
        names = ", ".join(boundary.name for boundary in boundaries)
        count = counted(len(contours), "closed contour")
        raise FileError(f"{count}, expected {len(boundaries)}: {names}")
    outlines = [boundary.arcs(TOPOLOGY_TOLERANCE, "fast").contour for boundary in boundaries]
    pairs = zip(boundaries, paired(contours, outlines), strict=True)
    return max(boundary.deviation(contour.counter_clockwise()) for boundary, contour in pairs)


def paired(contours: Sequence[AnyContour], outlines: Sequence[Contour]) -> list[AnyContour]:
    """The contours of a file in the order of as many `outlines`, approximate polygons of the part.

    The order of the areas distinguishes boundaries that lie inside each other; those of about the
    same size, such as the holes of a bolt circle and letters, lie at different places.
    """
    (wanted, middles), (areas, places) = map(_areas_and_middles, (outlines, contours))
    unsure = [TOPOLOGY_TOLERANCE * outline.length for outline in outlines]
    order = np.argsort(wanted, kind="stable").tolist()
    free = np.argsort(areas, kind="stable").tolist()
    matches: dict[int, AnyContour] = {}
    while order:
        alike = _alike([(wanted[k], unsure[k]) for k in order])
        ours, free = free[:alike], free[alike:]
        for k in order[:alike]:
            # Middles and sizes count alike, as lengths.
            away = np.abs(places[ours] - middles[k])
            away += np.abs(np.sqrt(areas[ours]) - np.sqrt(wanted[k]))
            matches[k] = contours[ours.pop(int(np.argmin(away)))]
        order = order[alike:]
    return [matches[k] for k in range(len(outlines))]


def _alike(areas: Sequence[tuple[float, float]]) -> int:
    """How many of the first of ascending areas [mm^2], each with its uncertainty, are too close to
    their predecessors to be told apart by order.
    """
    limit, count = math.inf, 0
    for area, unsure in areas:
        if area - unsure > limit:
            break
        limit = area * (1.0 + ALIKE) + unsure
        count += 1
    return count


def _areas_and_middles(contours: Sequence[AnyContour]) -> tuple[FloatArray, ComplexArray]:
    """(n,), (n,) complex areas [mm^2] and middles [mm] of contours."""
    areas = np.array([abs(contour.area) for contour in contours])
    return areas, np.array([_middle(contour) for contour in contours])


def _middle(contour: AnyContour) -> complex:
    """Middle of the contour's bounding box [mm]."""
    points = sample_points(contour, LOOSE * contour_reach(contour))
    sides = (points.real, points.imag)
    x, y = (0.5 * float(np.min(coordinates) + np.max(coordinates)) for coordinates in sides)
    return complex(x, y)


def contour_reach(contour: AnyContour) -> float:
    """Largest distance of the contour's vertices or control points from the cam axis [mm]."""
    if isinstance(contour, SplineContour):
        return contour.reach
    return float(abs(contour.vertices).max())


PARTS = 16
"""Points per line or cubic."""


def farthest(polygon: Contour, contour: AnyContour, sagitta: float) -> tuple[float, complex]:
    """Largest sampled distance [mm] between polygon and contour, and its place [mm].

    It is measured in both directions; for splines, only from them to the polygon. Arcs are replaced
    by chords that lie within `sagitta` [mm] of them.
    """
    largest = [_largest(polygon.vertices, sample_points(contour, sagitta))]
    if isinstance(contour, Contour):
        largest.append(_largest(contour.points(sagitta), polygon.vertices))
    return max(largest, key=lambda pair: pair[0])


def sample_points(contour: AnyContour, sagitta: float) -> ComplexArray:
    """(m,) complex [mm] points on the contour, in any order."""
    share = np.arange(PARTS) / PARTS
    if isinstance(contour, Contour):
        lines = contour.sweeps == 0.0
        starts, ends = contour.vertices[lines, None], contour.ends[lines, None]
        line_points = (starts + (ends - starts) * share).ravel()
        return np.concatenate((contour.points(sagitta), line_points))
    parts: list[ComplexArray] = []
    for strand in contour.strands:
        if isinstance(strand, CubicSpline):
            parts.append(bezier_points(strand.beziers, share).ravel())
        else:
            parts.append(strand.points_by_share(share))
    return np.concatenate(parts)


def _largest(course: ComplexArray, points: ComplexArray) -> tuple[float, complex]:
    """Largest distance of `points` from the closed polygon `course`, and where."""
    distances = distances_to_polygon(course, points)
    index = int(np.argmax(distances))
    return float(distances[index]), complex(points[index])


def distances_to_polygon(course: ComplexArray, points: ComplexArray) -> FloatArray:
    """(n,) distance of `points` from the closed polygon `course`."""
    import shapely

    ends = np.stack((course, np.roll(course, -1)), axis=1)
    sides = np.asarray(shapely.linestrings(np.stack((ends.real, ends.imag), axis=2)))
    tree = shapely.STRtree(sides)
    places = shapely.points(points.real, points.imag)
    index, distances = tree.query_nearest(places, return_distance=True, all_matches=False)
    nearest = np.zeros(len(points))
    nearest[index[0]] = distances
    return nearest
