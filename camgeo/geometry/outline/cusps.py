"""Undercut of a flank: cusps, and the ranges between them in which the envelope runs backwards; and
where it crosses itself.

One scalar decides: 1 + d kappa of the parallel at d, or the pace that has its sign. Between
neighbouring extremes of the curvature it is monotone, so that no range is missed, however narrow.

No undercut is missed, because the known extremes are checked against enclosures of the pace. They
are found where the slope of the curvature changes its sign from one sample to the next; two changes
between neighbouring samples would be missed. Over a cell whose pace provably keeps its sign there
is no cusp. Undecided cells are halved, and where the pace has another sign than the known extremes
imply, the extremes there are added; then all cells are looked at once more.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from camgeo.geometry.outline.envelope import (
    Cells,
    Envelope,
    envelope_of,
    find_nodes,
    halved,
    unresolved,
)
from camgeo.geometry.outline.path import Pivot
from camgeo.geometry.pieces import Extremes, curvature_extremes
from camgeo.geometry.pitch_curve import PitchCurve
from camgeo.geometry.working_curve import WorkingCurve
from camgeo.numeric.arrays import BoolArray, FloatArray, frozen
from camgeo.numeric.extremes import bracketed_roots, roots_on_grid
from camgeo.units import TURN

CUSP = 1e-12
"""1 + d kappa within this of zero is a cusp: twenty times the rounding of the curvature."""

INSIDE = 1e-13
"""A cam angle this far from a break [rad] is not taken for the break itself; 6e-12 degrees."""


def undercut_ranges(flank: WorkingCurve, bends: Extremes) -> list[tuple[float, float]]:
    """Ranges of cam angle (start, end) [rad] with 1 + d kappa < 0, ends in [0, 2 pi).

    `bends` are the extremes of the pitch curve's curvature. The whole turn is (0, 2 pi).
    """
    phi = np.append(bends.phi, bends.phi[0] + TURN)
    values = 1.0 + flank.distance * np.append(bends.values, bends.values[0])
    if np.all(values < 0.0):
        return [(0.0, TURN)]
    crossing = (values[:-1] < 0.0) != (values[1:] < 0.0)
    # Two entries at one cam angle are the two sides of a break: a jump, not a root.
    jump = crossing & (phi[1:] == phi[:-1])
    smooth = np.flatnonzero(crossing & ~jump)
    angles = np.where(jump, phi[:-1], 0.0)
    angles[smooth] = _crossings(flank, phi[smooth], phi[smooth + 1])
    places = np.flatnonzero(crossing)
    marks = [(float(angles[k]), bool(values[k + 1] < 0.0)) for k in places]
    if marks and not marks[0][1]:
        marks = [*marks[1:], marks[0]]
    starts = [angle for angle, begins in marks if begins]
    ends = [angle for angle, begins in marks if not begins]
    return [(start % TURN, end % TURN) for start, end in zip(starts, ends, strict=True)]


def _crossings(flank: WorkingCurve, low: FloatArray, high: FloatArray) -> FloatArray:
    """Where 1 + d kappa passes zero in each smooth stretch [low, high] (n,) [rad].

    Its ends may be breaks, at which the value from the other side does not count here.
    """
    low, high = low + INSIDE, high - INSIDE
    at_low, at_high = flank.regularity(low), flank.regularity(high)
    roots = np.where(np.abs(at_low) < np.abs(at_high), low, high)
    within = np.flatnonzero((at_low < 0.0) != (at_high < 0.0))
    roots[within] = bracketed_roots(flank.regularity, low[within], high[within])
    return roots


def backward_ranges(envelope: Envelope, bends: Extremes | None = None) -> list[tuple[float, float]]:
    """Ranges of the path parameter (start, end) in which the envelope runs backwards.

    start in [0, total), end above start, possibly beyond the total. A curvature that only touches
    its limit, to rounding, makes no range. The whole turn is (0, total).
    """
    flank = envelope.curve
    ranges = deep_ranges(flank, curvature_extremes(flank.pitch) if bends is None else bends)
    if ranges == [(0.0, TURN)]:
        return [(0.0, envelope.total)]
    found = [(envelope.place_of(start), envelope.place_of(end, "left")) for start, end in ranges]
    rotation = flank.pitch.rotation
    for start, each in zip(envelope.starts, envelope.elements, strict=True):
        if isinstance(each, Pivot) and rotation * each.distance * each.sweep > 0.0:
            found.append((float(start), float(start) + abs(each.sweep)))
    return _joined(found, envelope.total)


def deep_ranges(flank: WorkingCurve, bends: Extremes) -> list[tuple[float, float]]:
    """As `undercut_ranges`, without those in which the curvature only touches its limit, to
    rounding.
    """
    margins = 1.0 + flank.distance * bends.values
    if np.min(margins) >= -CUSP:
        return []
    ranges = undercut_ranges(flank, bends)
    if ranges == [(0.0, TURN)]:
        return ranges
    least = _least_within(bends.phi, margins, ranges)
    return [each for each, value in zip(ranges, least, strict=True) if value < -CUSP]


def _least_within(
    phi: FloatArray, margins: FloatArray, ranges: list[tuple[float, float]]
) -> FloatArray:
    """(k,) smallest of the `margins` (n,) at `phi` (n,) [rad] in each range of cam angle."""
    start, end = np.array(ranges).T
    order = np.argsort(np.mod(phi, TURN), kind="stable")
    turn = np.mod(phi, TURN)[order]
    angles = np.concatenate((turn - TURN, turn, turn + TURN))
    values = np.append(np.tile(margins[order], 3), np.inf)
    first = np.searchsorted(angles, start - INSIDE)
    last = np.searchsorted(angles, start + (end - start) % TURN + INSIDE, side="right")
    return np.minimum.reduceat(values, np.column_stack((first, last)).ravel())[::2]


def _joined(ranges: list[tuple[float, float]], total: float) -> list[tuple[float, float]]:
    """Ranges that meet are merged, in order; those of a whole turn need no merging."""
    ordered = sorted((start, end if end > start else end + total) for start, end in ranges)
    joined: list[tuple[float, float]] = []
    for start, end in ordered:
        if joined and start <= joined[-1][1] + INSIDE:
            joined[-1] = (joined[-1][0], max(end, joined[-1][1]))
        else:
            joined.append((start, end))
    if len(joined) > 1 and joined[-1][1] >= total + joined[0][0] - INSIDE:
        first = joined.pop(0)
        joined[-1] = (joined[-1][0], max(joined[-1][1], first[1] + total))
    return joined


HALVINGS = 14
"""Rounds of halving, to cells of less than 1e-5 rad, in which a motion has no features."""

PASSES = 40
"""Most passes over the cells. Each adds extremes, and in all but the last one some were missing."""

SAMPLES = 65
"""Places among which an added extreme is sought."""


def sure_bends(flank: WorkingCurve, bends: Extremes) -> Extremes:
    """`bends` with the extremes that the undercut of `flank` shows to be missing; usually none.

    Raises
    ------
    GeometryError
        If they are so many that no number of passes finds all.
    """
    envelope = envelope_of(flank)
    cells = envelope.undivided
    # Turns about corners have no curvature of the pitch curve.
    cells = cells.some(~envelope.is_pivot[envelope.element_at(cells.low)])
    for _ in range(PASSES):
        missed = _missed(envelope, cells, backward_ranges(envelope, bends))
        if not len(missed):
            return bends
        bends = with_places(flank.pitch, bends, missed)
    raise unresolved(envelope, missed)


def _missed(envelope: Envelope, cells: Cells, known: list[tuple[float, float]]) -> FloatArray:
    """(k,) cam angles [rad] in and about the `cells` in which the pace has not the sign that the
    `known` ranges imply: none is left out, however narrow, once there are none.
    """
    missed = [np.empty(0)]
    for _ in range(HALVINGS):
        if not len(cells):
            break
        middle = 0.5 * (cells.low + cells.high)
        wrong = (cells.pace < 0.0) != _inside(middle, known, envelope.total)
        if np.any(wrong):
            wrong &= np.abs(cells.pace) > CUSP * _speeds(envelope, middle)
        if np.any(wrong):
            missed.append(_extremes_near(envelope, cells.some(wrong)))
        cells = halved(envelope, cells.some(~wrong & (cells.sign == 0.0)))
    return np.concatenate(missed)


def _inside(places: FloatArray, ranges: list[tuple[float, float]], total: float) -> BoolArray:
    inside: BoolArray = np.zeros(len(places), dtype=np.bool_)
    if ranges:
        start, end = np.array(ranges).T
        last = np.searchsorted(start, places, side="right") - 1  # before the first: the last one
        inside = (places - start[last]) % total < (end - start)[last]
    return inside


def _speeds(envelope: Envelope, places: FloatArray) -> FloatArray:
    """|Z'| at path parameters; 1 on the turns about a corner, whose pace is not a difference."""
    index = envelope.element_at(places)
    speeds: FloatArray = np.ones(len(places))
    along = ~envelope.is_pivot[index]
    angles = places[along] + envelope.angle_offsets[index[along]]
    speeds[along] = np.abs(envelope.curve.pitch.jet(angles)[1])
    return speeds


def _extremes_near(envelope: Envelope, cells: Cells) -> FloatArray:
    """Cam angles of the middles of cells and of extremes of the curvature in them."""
    shift = envelope.angle_offsets[envelope.element_at(cells.low)]
    ends = cells.low + shift, cells.high + shift
    grid = np.linspace(*ends, SAMPLES + 2, axis=1)[:, 1:-1]
    found = roots_on_grid(envelope.curve.pitch.curvature_slope, grid)
    return np.concatenate((found, 0.5 * (ends[0] + ends[1])))


def with_places(pitch: PitchCurve, bends: Extremes, angles: FloatArray) -> Extremes:
    """`bends` and the curvature of `pitch` at `angles` (k,) [rad], in their order."""
    first = float(bends.phi[0])
    added = first + np.mod(angles - first, TURN)
    phi = np.concatenate((bends.phi, added))
    values = np.concatenate((bends.values, pitch.curvature(added)))
    order = np.argsort(phi, kind="stable")
    return Extremes(frozen(phi[order], np.float64), frozen(values[order], np.float64))


@dataclass(frozen=True, slots=True)
class Crossing:
    """A point that a flank passes twice.

    Attributes
    ----------
    first, second : cam angles [rad] in [0, 2 pi), first < second.
    point : its place [mm].
    """

    first: float
    second: float
    point: complex


def find_crossings(curve: WorkingCurve, bends: Extremes | None = None) -> tuple[Crossing, ...]:
    """All crossings of the parallel `curve` with itself, by the first cam angle.

    Mere contacts are not crossings. `bends` are the extremes of the pitch curve's curvature, if
    known.

    Raises
    ------
    GeometryError
        If the question cannot be decided, e.g. where the flank lies on itself along a stretch.
    """
    envelope = envelope_of(curve)
    nodes = find_nodes(envelope, backward_ranges(envelope, bends))
    crossing = [node for node in nodes if not node.touching]
    places = np.array([(node.first, node.second) for node in crossing]).reshape(-1, 2)
    angles = envelope.angles_at(places).tolist()
    found = [
        Crossing(first, second, node.point)
        for (first, second), node in zip(angles, crossing, strict=True)
    ]
    return tuple(sorted(found, key=lambda each: (each.first, each.second)))
