"""Outlines that consist of lines and arcs, e.g. a bore: approximation and proof."""

from __future__ import annotations

import math

import numpy as np

from camgeo.contour.chords.arc_chords import (
    arc_angles,
    arc_count,
    arc_offset,
    circle_count,
    circle_offset,
)
from camgeo.contour.contour import Contour
from camgeo.contour.counts import too_many
from camgeo.errors import GeometryError
from camgeo.numeric.arrays import BoolArray, ComplexArray, FloatArray, IntArray, grouped

MAX_CHORDS = 2_000_000
"""Chords at most."""

WIDEST = 1.6
"""Largest span of a chord [rad], however small the arc: a circle keeps four."""

ROUNDING = 2.0**-52 * 8.0
"""Rounding of a distance, as a fraction of the outline's size."""


def chords_of(exact: Contour, tolerance: float) -> Contour:
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
    return Contour.polygon(np.where(exact.sweeps[index] == 0.0, exact.vertices[index], turned))


def fewest_chords_of(exact: Contour, tolerance: float) -> Contour:
    """The fewest straight pieces within `tolerance` [mm] of `exact`, on both sides of it.

    Corners of `exact` are vertices; along its arcs vertices lie off them. A whole circle has no
    corner. There are never more pieces than from `chords_of`.

    Raises
    ------
    ToleranceError
        If more than `MAX_CHORDS` pieces would be needed.
    """
    each = np.arange(len(exact))
    if np.all(_same_circle(exact, np.zeros_like(each), each)):
        return _chords_of_circle(exact, tolerance)
    found: list[ComplexArray] = []
    for start, sweep, centre, radius in zip(
        exact.vertices, exact.sweeps, exact.centres, exact.radii, strict=True
    ):
        if sweep == 0.0:
            found.append(np.array([start]))
            continue
        count = _checked(arc_count(tolerance, radius, abs(sweep), WIDEST), tolerance)
        offset = arc_offset(count, radius, abs(sweep))
        turned = arc_angles(count, radius, abs(sweep), offset)[1:-1]
        arm = (1.0 + offset / radius) * (start - centre)
        found.append(np.append(start, centre + arm * np.exp(1j * np.sign(sweep) * turned)))
    return Contour.polygon(np.concatenate(found))


def _chords_of_circle(exact: Contour, tolerance: float) -> Contour:
    centre, radius = complex(exact.centres[0]), float(exact.radii[0])
    count = _checked(circle_count(tolerance, radius, WIDEST), tolerance)
    arm = (1.0 + circle_offset(count, radius) / radius) * (complex(exact.vertices[0]) - centre)
    step = math.copysign(2.0 * math.pi / count, float(exact.sweeps[0]))
    return Contour.polygon(centre + arm * np.exp(1j * step * np.arange(count)))


def _checked(count: int, tolerance: float) -> int:
    if count > MAX_CHORDS:
        raise too_many(MAX_CHORDS, "straight pieces", tolerance)
    return count


def distance_between(exact: Contour, contour: Contour) -> float:
    """Upper bound [mm] of the distance between two closed contours, in both directions.

    Each piece of `contour` is compared in closed form with the piece of `exact` that its middle is
    nearest to; where the pieces of `exact` change, its corner with the vertex there.

    Raises
    ------
    GeometryError
        If `contour` does not follow `exact` once round.
    """
    if exact.area * contour.area < 0.0:
        contour = contour.reversed()
    owner = np.argmin(_distances(exact, _middles(contour)), axis=0)
    beside = _largest_distances(exact, owner, contour)
    # Past the end of its owner the distance of a piece is that from the corner there: for a
    # straight piece at most that at its own end, for an arc at most its length more; rounding does
    # not count as past.
    ends = np.maximum(
        _distances_from_owner(exact, owner, contour.vertices),
        _distances_from_owner(exact, owner, contour.ends),
    )
    rounding = ROUNDING * float(np.max(np.abs(exact.vertices)))
    past = (ends > beside * (1.0 + 1e-9) + rounding) & (contour.sweeps != 0.0)
    beyond = np.where(past, ends + contour.lengths, ends)
    largest = float(np.max(np.maximum(beside, beyond)))
    before = np.roll(owner, 1)
    changes = np.flatnonzero(owner != before)
    corners = _corner_distances(exact, before[changes], owner[changes], contour.vertices[changes])
    _check_round(exact, contour)
    _check_all_followed(exact, owner)
    _check_gaps(exact, owner, contour)
    return max(largest, float(np.max(corners, initial=0.0))) + rounding


def _middles(contour: Contour) -> ComplexArray:
    chord = 0.5 * (contour.vertices + contour.ends)
    arm = contour.vertices - contour.centres
    on_arc = contour.centres + arm * np.exp(0.5j * contour.sweeps)
    return np.where(contour.sweeps != 0.0, on_arc, chord)


def _distance_to_piece(exact: Contour, k: int, points: ComplexArray) -> FloatArray:
    """Distance (n,) of `points` from piece k itself, its ends included."""
    start, end = complex(exact.vertices[k]), complex(exact.ends[k])
    at_ends: FloatArray = np.minimum(np.abs(points - start), np.abs(points - end))
    if exact.sweeps[k] == 0.0:
        along = (end - start) / abs(end - start)
        local = (points - start) * np.conj(along)
        beside = (local.real >= 0.0) & (local.real <= abs(end - start))
        straight: FloatArray = np.where(beside, np.abs(local.imag), at_ends)
        return straight
    arm: ComplexArray = points - exact.centres[k]
    turned = np.angle(arm / (start - exact.centres[k])) * np.sign(exact.sweeps[k])
    turned = np.where(turned < 0.0, turned + 2.0 * np.pi, turned)
    beside = turned <= abs(exact.sweeps[k])
    round_off: FloatArray = np.where(beside, np.abs(np.abs(arm) - exact.radii[k]), at_ends)
    return round_off


def _distances(exact: Contour, points: ComplexArray) -> FloatArray:
    """(pieces, n) distance of `points` (n,) from each piece of `exact`."""
    return np.stack([_distance_to_piece(exact, k, points) for k in range(len(exact))])


def _distances_from_owner(exact: Contour, owner: IntArray, points: ComplexArray) -> FloatArray:
    """Distance (n,) of each point from its owner; arcs of one circle count as one piece."""
    each = np.arange(len(exact))
    one, other = (grid.ravel() for grid in np.meshgrid(each, each, indexing="ij"))
    together = (_same_circle(exact, one, other) | (one == other)).reshape(len(exact), -1)
    apart = np.where(together[:, owner], _distances(exact, points), np.inf)
    nearest: FloatArray = np.min(apart, axis=0)
    return nearest


def _largest_distances(exact: Contour, owner: IntArray, contour: Contour) -> FloatArray:
    """Largest distance (n,) of each piece of `contour` from the line or circle of its owner."""
    start, end = contour.vertices, contour.ends
    base, far = exact.vertices[owner], exact.ends[owner]
    centre, radius = exact.centres[owner], exact.radii[owner]
    line = exact.sweeps[owner] == 0.0
    along = np.where(line, far - base, 1.0)
    along = along / np.abs(along)

    def off(points: ComplexArray) -> FloatArray:
        from_line = np.abs(((points - base) * np.conj(along)).imag)
        distances: FloatArray = np.where(line, from_line, np.abs(np.abs(points - centre) - radius))
        return distances

    found = np.maximum(off(start), off(end))
    # A chord is nearest to the centre at its foot; the extremes of an arc are in line with the
    # centres.
    chord = end - start
    length = np.where(chord == 0.0, 1.0, np.abs(chord))
    foot = ((centre - start) * np.conj(chord / length)).real
    inside = (contour.sweeps == 0.0) & ~line & (foot > 0.0) & (foot < length)
    found = np.where(inside, np.maximum(found, off(start + chord / length * foot)), found)
    arcs = contour.sweeps != 0.0
    towards = np.where(line, 1j * along, centre - contour.centres)
    towards = np.where(towards == 0.0, 1.0, towards)
    towards = towards / np.abs(towards)
    for sign in (1.0, -1.0):
        place = contour.centres + sign * towards * contour.radii
        reached = arcs & _on_arc(contour, place)
        found = np.where(reached, np.maximum(found, off(place)), found)
    return found


def _on_arc(contour: Contour, points: ComplexArray) -> BoolArray:
    arm = np.where(contour.sweeps != 0.0, contour.vertices - contour.centres, 1.0)
    turned = np.angle((points - contour.centres) / arm) * np.sign(contour.sweeps)
    turned = np.where(turned < 0.0, turned + 2.0 * np.pi, turned)
    return turned <= np.abs(contour.sweeps)


def _corner_distances(
    exact: Contour, before: IntArray, after: IntArray, vertices: ComplexArray
) -> FloatArray:
    """Distance (k,) of `vertices` from the corners at which piece `before` meets piece `after`."""
    same_circle = _same_circle(exact, before, after)
    following = after == (before + 1) % len(exact)
    if np.any(~same_circle & ~following):
        raise GeometryError("the contour does not follow the exact outline piece by piece")
    return np.where(same_circle, 0.0, np.abs(vertices - exact.vertices[after]))


def _same_circle(exact: Contour, one: IntArray, other: IntArray) -> BoolArray:
    """Whether the pieces `one` and `other` (k,) are arcs of the same circle."""
    same: BoolArray = (
        (exact.sweeps[one] != 0.0)
        & (exact.sweeps[other] != 0.0)
        & (exact.centres[one] == exact.centres[other])
        & np.isclose(exact.radii[one], exact.radii[other], rtol=1e-12, atol=0.0)
    )
    return same


def _check_all_followed(exact: Contour, owner: IntArray) -> None:
    """GeometryError if a piece is omitted, e.g. a slot by a full circle; a circle counts as one."""
    each = np.arange(len(exact))
    before, after = np.roll(each, 1), np.roll(each, -1)
    joined = _same_circle(exact, before, each)
    followed = np.isin(each, owner)
    while not np.all(followed):
        more = followed | (joined & followed[before]) | (joined[after] & followed[after])
        if np.array_equal(more, followed):
            raise GeometryError("the contour leaves out a part of the exact outline")
        followed = more


def _check_gaps(exact: Contour, owner: IntArray, contour: Contour) -> None:
    """GeometryError if a piece passes the gap of an arc, e.g. a slot in a bore, on the far side of
    its centre.

    Its ends would be near the arc, but the points between them farther off than the circle.
    """
    arm = exact.vertices - exact.centres
    each = np.arange(len(exact))
    alone = ~_same_circle(exact, each, np.roll(each, 1))
    alone &= ~_same_circle(exact, each, np.roll(each, -1))
    facing = (arm * np.exp(0.5j * exact.sweeps))[owner]
    centre = exact.centres[owner]
    with_gap = (exact.sweeps[owner] != 0.0) & alone[owner]
    start = np.angle((contour.vertices - centre) * np.conj(facing))
    end = np.angle((contour.ends - centre) * np.conj(facing))
    short_way = np.angle((contour.ends - centre) * np.conj(contour.vertices - centre))
    turned = np.where(contour.sweeps != 0.0, contour.sweeps, short_way)
    if np.any(with_gap & (np.abs(end - start - turned) > np.pi)):
        raise GeometryError("the contour passes a gap of the exact outline")


def _check_round(exact: Contour, contour: Contour) -> None:
    """GeometryError unless both contours enclose about the same area: else one omits a part."""
    if abs(exact.area - contour.area) > 0.5 * abs(exact.area):
        raise GeometryError("the contour does not go once round the exact outline")
