"""Global undercut as a condition on the place of the cam axis.

A flank is cut off where the roller, elsewhere on its way, covers it: where the roller centre at a
cam angle phi_2 is nearer than the flank's distance |d| to the point that the flank has at phi_1. In
the axes of `camgeo.check.sizing.task`, turned with the cam at phi_1, the point less the centre is

    B_1 - P - (B_2 - P) E + d N_1 / |N_1|,

E = exp(-i sense (phi_2 - phi_1)), N_1 = B_1 + i sense B_1' - P, along the normal and as long as the
velocity of the roller centre. Every pair of cam angles at which it is shorter than |d| rules the
place out, whatever else is known of it. Between places h apart it changes by at most h |1 - E| +
|d| times the turn of N_1, whose sine is at most h / |N_1|.

There are too many pairs to examine all of them. The relevant ones are found from what the outline
of a place has lost.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from camgeo.check.sizing.task import Task
from camgeo.errors import GeometryError
from camgeo.numeric.arrays import BoolArray, ComplexArray, FloatArray, IntArray, joined, taken
from camgeo.outline.crossings import find_crossings
from camgeo.units import TURN

TOUCHING = 3e-9
"""A point covered by less than this fraction of |d| counts as touched: somewhat more than in
`camgeo.outline.clearance`."""

AROUND, ACROSS = 720, 17
"""Cam angles over the turn, and between two crossings, at which covering is sought."""

MOST = 120
"""Most pairs taken from one place."""

ZOOMS, GRID = 14, 5
"""Steps of a refinement, each in half the range, and cam angles that it tries on each side."""


@dataclass(frozen=True, slots=True, eq=False)
class Covers:
    """Pairs of cam angles, and what their conditions are made of, see the module.

    Attributes
    ----------
    first, second : (k,) phi_1 and phi_2 [rad].
    distance : (k,) d [mm].
    apart, turned, normal : (k,) complex B_1 - B_2 E, 1 - E, and N_1 + P [mm].
    """

    first: FloatArray
    second: FloatArray
    distance: FloatArray
    apart: ComplexArray
    turned: ComplexArray
    normal: ComplexArray

    def gap(self, places: ComplexArray) -> tuple[FloatArray, FloatArray]:
        """(n, k) distance beyond |d| of point and centre [mm], and |N_1| [mm/rad], at places (n,).

        Negative where the point is covered.
        """
        seen = places[:, np.newaxis]
        normal = self.normal - seen
        pace = np.abs(normal)
        with np.errstate(divide="ignore", invalid="ignore"):
            offset = self.distance * (normal / pace)
        reach = np.abs(self.apart - seen * self.turned + offset)
        return reach - np.abs(self.distance), pace

    def change(self, half: FloatArray, pace: FloatArray) -> FloatArray:
        """(n, k) most by which `gap` [mm] changes within `half` (n, 1) [mm] of places."""
        with np.errstate(divide="ignore", invalid="ignore"):
            turn = np.where(pace > half, math.sqrt(2.0) * half / pace, 2.0)
        return np.asarray(half * np.abs(self.turned) + np.abs(self.distance) * turn)

    def met(self, places: ComplexArray) -> BoolArray:
        """(n,) whether no point is covered with the cam axis at the places (n,)."""
        gap, _ = self.gap(places)
        return np.asarray(np.all(gap >= 0.0, axis=1))

    def some(self, wanted: BoolArray | IntArray) -> Covers:
        """Those of the pairs that are `wanted`."""
        return taken(self, wanted)

    def __add__(self, other: Covers) -> Covers:
        return joined((self, other))


def pairs_of(
    task: Task, first: FloatArray, second: FloatArray, distance: float | FloatArray
) -> Covers:
    """The conditions at the cam angles `first` and `second` (k,) [rad] of flanks at d [mm]."""
    places, ways = _centres(task, first)
    others, _ = _centres(task, second)
    turned = np.exp(-1j * task.sense * (second - first))
    distances = np.broadcast_to(np.asarray(distance, dtype=np.float64), first.shape)
    normals = places + 1j * task.sense * ways
    return Covers(first, second, distances, places - others * turned, 1.0 - turned, normals)


def no_pairs(task: Task) -> Covers:
    """No pairs at all."""
    return pairs_of(task, np.empty(0), np.empty(0), 0.0)


def _centres(task: Task, phi: FloatArray) -> tuple[ComplexArray, ComplexArray]:
    """B and B' (n,) at `phi` (n,) [rad], in the axes of places."""
    terms = task.terms(phi)
    back = np.conj(terms.turn)
    return back * terms.centre, 1j * back * (terms.p1 + terms.turning * terms.centre)


def covered(task: Task, place: complex) -> Covers:
    """Pairs at which the flanks in use are cut off with the cam axis at `place`, the worst first.

    Empty if they are not, or only touch to rounding. What is cut off at a corner of the pitch curve
    is left out: a jump of the velocity rules the disc out at every size.
    """
    disc = task.cam_at(place).disc
    kinks = np.array([pivot.after for pivot in disc.pitch_path.pivots])
    found = no_pairs(task)
    for name, flank in disc.flanks:
        try:
            if not disc.outline(name).is_trimmed:
                continue
            crossings = find_crossings(flank, disc.bends)
        except GeometryError:  # nothing is left, or what is left cannot be decided
            crossings = ()
        angles = sorted(angle for each in crossings for angle in (each.first, each.second))
        ends = [*angles[1:], *(angle + TURN for angle in angles[:1])]
        stretches = list(zip(angles, ends, strict=True)) or [(0.0, TURN)]
        for start, end in stretches:
            if not (angles and np.any((kinks - start) % TURN <= end - start)):
                found = found + _of_stretch(task, place, flank.distance, start, end)
    gap = found.gap(np.array([place]))[0][0]
    order = np.argsort(gap)[:MOST]
    return found.some(order[gap[order] < -TOUCHING * np.abs(found.distance[order])])


def _of_stretch(task: Task, place: complex, distance: float, start: float, end: float) -> Covers:
    """Pairs of the flank between two of its crossings, which is covered as a whole or nowhere.

    Samples of its points, each with the nearest roller centre, and the deepest point, refined.
    """
    count = max(ACROSS, math.ceil(AROUND * (end - start) / (2.0 * TURN)))
    share = (np.arange(count) + 0.5) / count
    first = start + (end - start) * share
    around = np.linspace(0.0, TURN, AROUND, endpoint=False)
    gap = _gaps(task, place, distance, first[:, np.newaxis], around)
    second = around[np.argmin(gap, axis=1)]
    first, second = _deepest(task, place, distance, (first, second), (0.0, TURN / AROUND))
    depth = pairs_of(task, first, second, distance).gap(np.array([place]))[0][0]
    if not np.any(depth < 0.0):
        return no_pairs(task)
    best = np.argmin(depth, keepdims=True)
    wide = (end - start) / count, TURN / AROUND
    one, other = _deepest(task, place, distance, (first[best], second[best]), wide)
    return pairs_of(task, np.append(first, one), np.append(second, other), distance)


def _deepest(
    task: Task,
    place: complex,
    distance: float,
    pairs: tuple[FloatArray, FloatArray],
    wide: tuple[float, float],
) -> tuple[FloatArray, FloatArray]:
    """For each of `pairs` (k,), (k,) the deepest within `wide` [rad] of its two angles."""
    first, second = pairs
    ahead, beside = wide
    share = np.linspace(-1.0, 1.0, 2 * GRID - 1)
    ways = share if ahead > 0.0 else np.zeros(1)
    one, other = (each.ravel() for each in np.meshgrid(ways, share, indexing="ij"))
    every = np.arange(len(first))
    for _ in range(ZOOMS):
        firsts = first[:, np.newaxis] + ahead * one
        seconds = second[:, np.newaxis] + beside * other
        least = np.argmin(_gaps(task, place, distance, firsts, seconds), axis=1)
        first, second = firsts[every, least], seconds[every, least]
        ahead, beside = 0.5 * ahead, 0.5 * beside
    return first, second


def _gaps(
    task: Task, place: complex, distance: float, first: FloatArray, second: FloatArray
) -> FloatArray:
    """`Covers.gap` of one place at cam angles of shapes (k, n) and (n,), or both (k, n) [mm]."""
    starts, ways = _centres(task, first.ravel())
    normals = starts + 1j * task.sense * ways - place
    points = starts - place + distance * (normals / np.abs(normals))
    centres, _ = _centres(task, second.ravel())
    turned = (
        each * np.exp(-1j * task.sense * phi)
        for each, phi in (
            (points.reshape(first.shape), first),
            ((centres - place).reshape(second.shape), second),
        )
    )
    point, centre = turned
    return np.asarray(np.abs(point - centre) - abs(distance))
