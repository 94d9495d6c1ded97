"""G1 arc splines along smooth pieces of a curve: the least deviation for a number of arcs.

A joint lies a little off the curve, on the normal of its cam angle, and its tangent is turned a
little against the curve's. Along the curve the deviation of such arcs is that of a C1 quadratic
spline from a function with the third derivative dkappa/ds. For given joints least squares find it,
with the condition of each arc that its chord halves the angle of its tangents; for joints at which
all arcs deviate alike, least squares are also the best fit but for the first arcs at the ends.
Biarcs, which have the curve's points and tangents at every other joint, need 1.45 times as many.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from camgeo.contour.arcs.biarcs import FLAT
from camgeo.contour.arcs.course import Arcs, Course, Strands
from camgeo.contour.arcs.joints import Layout, evened
from camgeo.contour.arcs.system import ArcSystem
from camgeo.contour.chain import Chain
from camgeo.curve.working_curve import WorkingCurve
from camgeo.numeric.arrays import ComplexArray, FloatArray, IntArray

ROUNDS = 14
"""Rounds of evening out the arcs' deviations."""

FIRST_POWER, MOST_POWER, CALMER, BOLDER = 1.0 / 6.0, 0.25, 0.7, 1.2
"""Power of its deviation by which an arc is shortened in a round. Where arcs change by turns, each
at its neighbours' cost, deviations go with about the sixth power of lengths: anything near the
third root would swing. An arc that swings all the same is handled more calmly."""

EVEN, REPEATS = 0.15, 3
"""Where an arc still deviates by so much (a logarithm) more than the mean, as it does where
dkappa/ds has a zero every other arc, the rounds are repeated."""

STEPS = 5
"""Gauss-Newton steps at the end. Their conditions have exact derivatives and hold to rounding after
three, where arcs turn by a radian after five."""

PROBES, CLOSE_PROBES = 12, 16
"""Points an arc at which its deviation is sampled for least squares, and when it is final."""

TANGENT = 2.0**-52 * 8.0
"""Largest angle between neighbouring arcs that is rounding: times the chord, as a share of the
distance from the cam axis."""

WIDEST = 1.5
"""Largest half sweep of an arc [rad]: chords tell nothing of arcs of half a turn."""


@dataclass(frozen=True, slots=True, eq=False)
class ArcSpline:
    """Arcs along one smooth piece.

    Attributes
    ----------
    angles : (n + 1,) [rad] cam angles of the vertices' feet, ascending.
    vertices : (n + 1,) complex [mm].
    halves : (n,) [rad] half the sweep of each arc.
    deviation : how far curve and arcs are apart [mm], sampled; infinite if the arcs are of no use.
    """

    angles: FloatArray
    vertices: ComplexArray
    halves: FloatArray
    deviation: float

    def chain(self) -> Chain:
        """The arcs as a chain, very flat ones as lines, see `FLAT`."""
        chords = np.diff(self.vertices)
        sagittas = np.abs(chords) * np.abs(self.halves) / 4.0
        flat = sagittas <= FLAT * np.max(np.abs(self.vertices))
        middle = 0.5 * (self.vertices[1:] + self.vertices[:-1])
        centres = middle + 0.5j * chords / np.tan(np.where(flat, 1.0, self.halves))
        return Chain(
            self.angles[:-1],
            self.vertices[:-1],
            np.where(flat, 0.0, 2.0 * self.halves),
            np.where(flat, 0.0, centres),
        )


def arc_splines(strands: Strands, pieces: IntArray, counts: IntArray) -> list[ArcSpline]:
    """Arc splines of `counts` (k,) arcs along `pieces` (k,), G1 and exact in point and tangent
    at both ends.

    Their deviation is nearly the least that is possible. Each depends on its piece and number
    of arcs alone.
    """
    layout = Layout.of(counts)
    best, excess = _settled(strands, layout, pieces, strands.difficulty.joints(layout, pieces))
    uneven = np.flatnonzero(excess > EVEN)
    if len(uneven):
        part = Layout.of(counts[uneven])
        chosen = layout.of_joints(excess > EVEN)
        for _ in range(REPEATS):
            best[chosen] = _settled(strands, part, pieces[uneven], best[chosen])[0]
    course = Course.of(strands, layout, pieces, best, PROBES)
    system = ArcSystem.of(layout)
    off = np.zeros((len(best), 2))
    for _ in range(STEPS):
        off = off + course.step(system, off)
    return _splines(strands.curve, Course.of(strands, layout, pieces, best, CLOSE_PROBES), off)


def _settled(
    strands: Strands, layout: Layout, pieces: IntArray, places: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Places (j,) of joints with the smallest deviation found from `places` (j,) on, and the excess
    (k,) of the largest one of each spline, see `Layout.excess`.
    """
    system = ArcSystem.of(layout)
    count = len(layout.first)
    best, least, uneven = places, np.full(count, np.inf), np.full(count, np.inf)
    power, last = np.full(len(layout.left), FIRST_POWER), np.zeros(len(layout.left))
    for _ in range(ROUNDS):
        course = Course.of(strands, layout, pieces, places, PROBES)
        deviations = course.deviations(course.step(system, np.zeros((len(places), 2))))
        worst, excess = layout.largest(deviations), layout.excess(deviations)
        better = worst < least
        best = np.where(layout.of_joints(better), places, best)
        uneven = np.where(better, layout.largest(excess), uneven)
        least = np.fmin(least, worst)
        swings = excess * last < 0.0
        power = np.where(swings, CALMER * power, np.minimum(BOLDER * power, MOST_POWER))
        places, last = evened(layout, places, power * excess), excess
    return best, uneven


def _splines(curve: WorkingCurve, course: Course, off: FloatArray) -> list[ArcSpline]:
    """The splines of a batch, for the final offsets and turns `off` (j, 2) of its joints."""
    arcs, layout = Arcs.of(course, off), course.layout
    # A proof adds the distance of joints from their feet along the arcs.
    gaps = np.abs(off[:, 0] * np.sin(off[:, 1]))
    total = course.deviations(off) + np.maximum(gaps[layout.left], gaps[layout.left + 1])
    # Each arc has a parallel on the pitch curve.
    side = -curve.pitch.rotation * np.sign(arcs.halves) * curve.distance
    good = (arcs.length > 2.0 * np.abs(np.sin(arcs.halves)) * side) & np.isfinite(total)
    good &= np.abs(arcs.length * arcs.miss) <= TANGENT * np.max(np.abs(course.points))
    good &= np.abs(arcs.halves) <= WIDEST
    sound = course.sound & np.logical_and.reduceat(good, layout.first_arcs)
    deviations = np.where(sound, layout.largest(total), np.inf)
    found = []
    for k, (first, last) in enumerate(zip(layout.first, layout.last, strict=True)):
        joints, own = slice(first, last + 1), slice(first - k, last - k)
        angles, vertices = course.angles[joints], arcs.vertices[joints]
        found.append(ArcSpline(angles, vertices, arcs.halves[own], float(deviations[k])))
    return found
