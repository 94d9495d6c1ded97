"""Outlines that consist of lines and arcs, e.g. a bore: approximation and proof."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from camgeo.errors import GeometryError
from camgeo.geometry.contour.contour import Contour, Fit
from camgeo.geometry.contour.hausdorff import ROUNDING, distance
from camgeo.geometry.contour.legs import too_many
from camgeo.numeric.arrays import BoolArray, ComplexArray, FloatArray, IntArray, grouped

# -- arc chords -----------------------------------------------------------------------------------
# Chords of circular arcs with the arc on both sides of them, in closed form.
#
# Vertices lie at the radius r + u and chords touch the circle of radius r - u, so that a chord from
# vertex to vertex spans 2 arccos((r - u)/(r + u)). Differences of nearly equal numbers are avoided
# by 1 - cos x = 2 sin^2(x/2).


HALVINGS = 60
"""Halvings in the search for the least offset: double precision resolves no more."""


def circle_count(tolerance: float, radius: float, most_turn: float) -> int:
    """Fewest chords of a whole circle within `tolerance` [mm] on both sides.

    No chord spans more than `most_turn` [rad], and there are at least three.
    """
    step = min(2.0 * _reach(tolerance, radius), most_turn)
    return max(3, _ceil(2.0 * math.pi / step))


def circle_offset(count: int, radius: float) -> float:
    """u [mm] of the vertices of `count` chords of a whole circle: r tan^2(pi/(2 count))."""
    return radius * math.tan(0.5 * math.pi / count) ** 2


def arc_count(tolerance: float, radius: float, sweep: float, most_turn: float) -> int:
    """Fewest chords within `tolerance` [mm] of an arc, its ends exact vertices.

    Parameters
    ----------
    sweep : angle of the arc [rad], positive.
    most_turn : largest span of a chord [rad]; those at the ends span less.
    """
    on_arc = min(2.0 * _end_reach(tolerance, radius), most_turn)
    plain = max(1, _ceil(sweep / on_arc))
    tolerance = min(tolerance, _offset_at_most(radius, most_turn))
    rest = sweep - 2.0 * _end_reach(tolerance, radius)
    return min(plain, 1 + max(0, _ceil(rest / (2.0 * _reach(tolerance, radius)))))


def arc_offset(count: int, radius: float, sweep: float) -> float:
    """Least u [mm] with which `count` chords with exact ends cover an arc of `sweep` [rad]."""
    low, high = 0.0, radius
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        reach = 2.0 * _end_reach(middle, radius) + 2.0 * (count - 1) * _reach(middle, radius)
        low, high = (middle, high) if reach < sweep else (low, middle)
    return high


def arc_angles(count: int, radius: float, sweep: float, offset: float) -> FloatArray:
    """(count + 1,) [rad] angles of the vertices along the arc, both ends included."""
    last = _end_reach(offset, radius) + _reach(offset, radius)
    if count < 3:
        return np.linspace(0.0, sweep, count + 1)
    inner = np.linspace(last, sweep - last, count - 1)
    return np.concatenate(([0.0], inner, [sweep]))


def _reach(offset: float, radius: float) -> float:
    """Half the angle [rad] of a chord between two vertices at r + u."""
    return 2.0 * math.asin(math.sqrt(min(offset / (radius + offset), 0.5)))


def _end_reach(offset: float, radius: float) -> float:
    """Angle [rad] from a vertex on the circle to where its chord touches that of r - u."""
    return 2.0 * math.asin(math.sqrt(min(0.5 * offset / radius, 0.5)))


def _offset_at_most(radius: float, turn: float) -> float:
    """u [mm] at which a chord between two vertices at r + u spans `turn` [rad]."""
    return radius * math.tan(0.25 * turn) ** 2


def _ceil(share: float) -> int:
    """Smallest whole number not below `share` by more than rounding."""
    return math.ceil(share * (1.0 - 2.0**-46))


# -- outlines of lines and arcs ------------------------------------------------------------------

MAX_CHORDS = 2_000_000
"""Chords at most."""

WIDEST = 1.6
"""Largest span of a chord [rad], however small the arc: a circle keeps four."""


def chords_of(exact: Contour, tolerance: float) -> Fit:
    """Straight pieces with vertices on `exact`, at most `tolerance` [mm] off it."""
    radii = exact.radii
    largest = float(np.max(radii, initial=0.0))
    if largest > 0.0 and math.pi * math.sqrt(largest / (2.0 * tolerance)) > MAX_CHORDS:
        raise too_many(MAX_CHORDS, "straight pieces", tolerance)
    with np.errstate(divide="ignore", invalid="ignore"):
        # Sagitta r (1 - cos(step/2)) = tolerance, without the cancellation of 1 - cos.
        steps = 4.0 * np.arcsin(np.sqrt(np.minimum(tolerance / (2.0 * radii), 0.5)))
    counts = np.where(radii > 0.0, np.ceil(np.abs(exact.sweeps) / np.minimum(steps, WIDEST)), 1)
    index, number = grouped(counts.astype(np.intp))
    arm = exact.vertices[index] - exact.centres[index]
    turned = exact.centres[index] + arm * np.exp(1j * exact.sweeps[index] * number / counts[index])
    vertices = np.where(exact.sweeps[index] == 0.0, exact.vertices[index], turned)
    return _fit(exact, vertices, index, tolerance)


def fewest_chords_of(exact: Contour, tolerance: float) -> Fit:
    """The fewest straight pieces within `tolerance` [mm] of `exact`, on both sides of it.

    Corners of `exact` are vertices; along its arcs vertices lie off them. A whole circle has no
    corner. There are never more pieces than from `chords_of`.

    Raises
    ------
    ToleranceError
        If more than `MAX_CHORDS` pieces would be needed.
    """
    if np.all(_on_first_circle(exact)):
        return _chords_of_circle(exact, tolerance)
    found: list[ComplexArray] = []
    for k, (sweep, radius) in enumerate(zip(exact.sweeps, exact.radii, strict=True)):
        if sweep == 0.0:
            found.append(exact.vertices[k : k + 1])
            continue
        count = _checked(arc_count(tolerance, radius, abs(sweep), WIDEST), tolerance)
        found.append(_along_arc(exact, k, count, radius, abs(sweep)))
    index = np.repeat(np.arange(len(exact)), [len(each) for each in found])
    return _fit(exact, np.concatenate(found), index, tolerance)


def matching_chords_of(contours: Sequence[Contour], tolerance: float) -> list[ComplexArray]:
    """(n,) complex [mm] polygons within `tolerance` [mm] of contours with the same kinds of pieces,
    such as parallels, as many pieces along each: vertices that belong together have the same index.
    """
    found: list[list[ComplexArray]] = [[] for _ in contours]
    for k, sweep in enumerate(contours[0].sweeps):
        if sweep == 0.0:
            for own, contour in zip(found, contours, strict=True):
                own.append(contour.vertices[k : k + 1])
            continue
        sizes = [(float(each.radii[k]), float(abs(each.sweeps[k]))) for each in contours]
        count = max(_checked(arc_count(tolerance, *size, WIDEST), tolerance) for size in sizes)
        for own, contour, (radius, turned) in zip(found, contours, sizes, strict=True):
            own.append(_along_arc(contour, k, count, radius, turned))
    return [np.concatenate(own) for own in found]


def _along_arc(contour: Contour, k: int, count: int, radius: float, sweep: float) -> ComplexArray:
    """(count,) vertices of the chords of an arc, the first one its start."""
    start, centre = contour.vertices[k], contour.centres[k]
    offset = arc_offset(count, radius, sweep)
    turned = arc_angles(count, radius, sweep, offset)[1:-1]
    arm = (1.0 + offset / radius) * (start - centre)
    along = centre + arm * np.exp(1j * np.sign(contour.sweeps[k]) * turned)
    return np.append(start, along)


def _chords_of_circle(exact: Contour, tolerance: float) -> Fit:
    centre, radius = complex(exact.centres[0]), float(exact.radii[0])
    count = _checked(circle_count(tolerance, radius, WIDEST), tolerance)
    arm = (1.0 + circle_offset(count, radius) / radius) * (complex(exact.vertices[0]) - centre)
    step = math.copysign(2.0 * math.pi / count, float(exact.sweeps[0]))
    vertices = centre + arm * np.exp(1j * step * np.arange(count))
    return _fit(exact, vertices, np.zeros(count, dtype=np.intp), tolerance)


def _fit(exact: Contour, vertices: ComplexArray, index: IntArray, tolerance: float) -> Fit:
    """The polygon of `vertices` (n,) [mm], whose chord i belongs to the piece `index[i]` (n,).

    A chord and its part of an arc lie within the same angle about the centre, and along each ray
    from there within the largest difference of their radii: at a vertex, or at the foot of the
    perpendicular.
    """
    contour, centres, radii = Contour.polygon(vertices), exact.centres[index], exact.radii[index]
    start, end = contour.vertices - centres, contour.ends - centres
    along = (end - start) / np.where(end == start, 1.0, np.abs(end - start))
    foot = np.abs((np.conj(along) * 0.5 * (start + end)).imag)
    off = np.max(np.abs([np.abs(start) - radii, np.abs(end) - radii, radii - foot]), axis=0)
    largest = float(np.max(off[radii > 0.0], initial=0.0))
    rounding = 2.0 * ROUNDING * float(np.max(np.abs(vertices)))
    return Fit(contour, largest + rounding, tolerance)


def _checked(count: int, tolerance: float) -> int:
    if count > MAX_CHORDS:
        raise too_many(MAX_CHORDS, "straight pieces", tolerance)
    return count


def distance_between(exact: Contour, contour: Contour) -> float:
    """Upper bound [mm] of the distance between two closed contours, in both directions.

    It changes no faster than the numbers of `contour` do, see `camgeo.geometry.contour.hausdorff`.

    Raises
    ------
    GeometryError
        If `contour` does not follow `exact` once round.
    """
    if abs(abs(exact.area) - abs(contour.area)) > 0.5 * abs(exact.area):
        raise GeometryError("the contour does not go once round the exact outline")
    return distance(exact, contour)


def _on_first_circle(exact: Contour) -> BoolArray:
    """(n,) whether a piece is an arc of the same circle as the first one."""
    same: BoolArray = (
        (exact.sweeps != 0.0)
        & (exact.sweeps[0] != 0.0)
        & (exact.centres == exact.centres[0])
        & np.isclose(exact.radii, exact.radii[0], rtol=1e-12, atol=0.0)
    )
    return same
