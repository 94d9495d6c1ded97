"""G1 arc splines along smooth pieces of a curve: the least deviation for a number of arcs.

A joint lies a little off the curve, on the normal of its cam angle, and its tangent is rotated
slightly from the curve's. Along the curve the deviation of such arcs is that of a C1 quadratic
spline from a function with the third derivative dkappa/ds. For given joints least squares find it,
under the condition of each arc that its chord bisects the angle of its tangents; for joints with
equal deviations of all arcs, least squares are also the best fit except for the first arcs at the
ends. Biarcs, which have the curve's points and tangents at every other joint, need 1.45 times as
many.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from camgeo.contour.arcs.biarcs import FLAT
from camgeo.contour.arcs.joints import ArcSystem, Difficulty, Layout, evened
from camgeo.contour.chain import Chain
from camgeo.contour.decided import clearly_less
from camgeo.contour.joints import APART, Bends
from camgeo.curve.pieces import Piece
from camgeo.curve.working_curve import WorkingCurve
from camgeo.numeric.arrays import BoolArray, ComplexArray, FloatArray, IntArray


@dataclass(frozen=True, slots=True, eq=False)
class Strands:
    """Smooth pieces of one parallel, none a dwell, ready for arcs.

    Attributes
    ----------
    curve : the parallel.
    difficulty : of its pieces, p.
    points, tangents : (2, p) complex [mm], unit; one-sided, at starts and ends.
    """

    curve: WorkingCurve
    difficulty: Difficulty
    points: ComplexArray
    tangents: ComplexArray

    @classmethod
    def of(cls, curve: WorkingCurve, pieces: Sequence[Piece], bends: Sequence[Bends]) -> Strands:
        """The `pieces` of `curve`, whose bends along them are `bends`."""
        first = curve.traced(np.array([piece.start for piece in pieces]))
        last = curve.traced(np.array([piece.end for piece in pieces]), "left")
        points, tangents = np.stack((first[0], last[0])), np.stack((first[1], last[1]))
        return cls(curve, Difficulty.of(pieces, bends), points, tangents)


@dataclass(frozen=True, slots=True, eq=False)
class JointedCurve:
    """The curve sampled at the joints of a batch and between them.

    Attributes
    ----------
    angles, points, tangents : (j,) cam angle [rad], point [mm] and unit tangent of the joints.
    samples : (n, m) complex [mm] points of the curve along each arc.
    scale : (j,) [mm] length of the chords about each joint, which makes its turn a length.
    valid : (k,) False for splines that have joints too close to each other.
    """

    layout: Layout
    angles: FloatArray
    points: ComplexArray
    tangents: ComplexArray
    samples: ComplexArray
    scale: FloatArray
    valid: BoolArray

    @classmethod
    def of(
        cls, strands: Strands, layout: Layout, pieces: IntArray, places: FloatArray, probes: int
    ) -> JointedCurve:
        """The curve at the `places` (j,) of joints along `pieces` (k,), and at `probes` per arc."""
        angles = strands.difficulty.angles(layout, pieces, places)
        left, right = layout.left, layout.left + 1
        parts = (np.arange(probes) + 0.5) / probes
        between = angles[left, None] + (angles[right] - angles[left])[:, None] * parts
        points, tangents, _ = strands.curve.traced(np.concatenate((angles, between.ravel())))
        samples = points[len(angles) :].reshape(between.shape)
        points, tangents = points[: len(angles)], tangents[: len(angles)]
        points[layout.first], points[layout.last] = strands.points[:, pieces]
        tangents[layout.first], tangents[layout.last] = strands.tangents[:, pieces]
        chords = np.abs(points[right] - points[left])
        apart = (chords > APART * np.max(np.abs(points))) & (angles[right] > angles[left])
        valid = np.logical_and.reduceat(apart, layout.first_arcs)
        scale = np.zeros(len(angles))
        scale[left] += chords
        scale[right] += chords
        return cls(layout, angles, points, tangents, samples, scale, valid)

    def step(self, system: ArcSystem, off: FloatArray) -> FloatArray:
        """Gauss-Newton step (j, 2) from `off` (j, 2), offsets [mm] and turns [rad] of joints."""
        arcs = Arcs.of(self, off)
        errors, t = arcs.errors(self.samples)
        left, right = self.layout.left, self.layout.left + 1
        # To first order arcs move by the Hermite cubic of the motion of their ends, a quadratic as
        # far as the condition holds. The present residual of the condition is a cubic part of the
        # error.
        rest = 1.0 - t
        errors += (0.5 * arcs.length * arcs.miss)[:, None] * t * rest * (rest - t)
        before, after = arcs.length / self.scale[left], arcs.length / self.scale[right]
        basis = np.stack(
            (
                rest * rest * (1.0 + 2.0 * t),
                rest * rest * t * before[:, None],
                t * t * (1.0 + 2.0 * rest),
                -t * t * rest * after[:, None],
            ),
            axis=1,
        )
        cosine = (np.conj(arcs.along) * self.tangents[left]).real
        end_cosine = (np.conj(arcs.along) * self.tangents[right]).real
        valid = self.valid & np.isfinite(self.layout.largest(np.max(np.abs(errors), axis=1)))
        free = self.layout.of_joints(valid)
        free[self.layout.first] = free[self.layout.last] = False
        found = system.solved(
            basis @ basis.transpose(0, 2, 1),
            (basis @ errors[:, :, None])[:, :, 0],
            np.stack((-2.0 * cosine, -before, 2.0 * end_cosine, -after), axis=1),
            -arcs.length * arcs.miss,
            free,
        )
        # Joints between chords of no length are not free, and do not turn.
        scale = np.where(self.scale > 0.0, self.scale, 1.0)
        steps: FloatArray = found / np.stack((np.ones(len(found)), scale), axis=1)
        return steps

    def deviations(self, off: FloatArray) -> FloatArray:
        """(n,) [mm] largest distance of the curve from each arc, from samples."""
        errors = np.abs(Arcs.of(self, off).errors(self.samples)[0])
        joints = np.abs(off[:, 0])
        found = np.maximum(joints[self.layout.left], joints[self.layout.left + 1])
        inside, before, after = errors[:, 1:-1], errors[:, :-2], errors[:, 2:]
        bend = 2.0 * inside - before - after
        top = (inside >= before) & (inside >= after) & (bend > 0.0)
        rise = np.where(top, (after - before) ** 2, 0.0) / np.where(top, 8.0 * bend, 1.0)
        peaks: FloatArray = np.maximum(np.max(errors, axis=1), np.max(inside + rise, axis=1))
        return np.maximum(found, peaks)


@dataclass(frozen=True, slots=True, eq=False)
class Arcs:
    """The arcs of a batch between joints off the curve.

    Attributes
    ----------
    vertices : (j,) complex [mm].
    middle, along, length : (n,) of the chords: middle [mm], unit vector, length [mm].
    halves : (n,) [rad] half the sweeps.
    miss : (n,) [rad] by which the angle from the first tangent to the chord exceeds that from the
        chord to the last tangent; both are half the sweep if the arcs are G1.
    """

    vertices: ComplexArray
    middle: ComplexArray
    along: ComplexArray
    length: FloatArray
    halves: FloatArray
    miss: FloatArray

    @classmethod
    def of(cls, jointed: JointedCurve, off: FloatArray) -> Arcs:
        """The arcs along `jointed` with offsets and turns `off` (j, 2) of the joints."""
        left, right = jointed.layout.left, jointed.layout.left + 1
        vertices = jointed.points + 1j * jointed.tangents * off[:, 0]
        tangents = jointed.tangents * np.exp(1j * off[:, 1])
        chords = vertices[right] - vertices[left]
        length = np.abs(chords)
        none = length == 0.0
        along = chords / np.where(none, 1.0, length)
        length[none] = np.nan
        before = np.angle(along * np.conj(tangents[left]))
        after = np.angle(tangents[right] * np.conj(along))
        middle = 0.5 * (vertices[left] + vertices[right])
        return cls(vertices, middle, along, length, 0.5 * (before + after), before - after)

    def errors(self, points: ComplexArray) -> tuple[FloatArray, FloatArray]:
        """Signed distances (n, m) [mm] of `points` (n, m) from the arcs, positive on their left,
        and the places (n, m) of their feet on the chords, 0 to 1 between the ends.
        """
        local = (points - self.middle[:, None]) * np.conj(self.along)[:, None]
        x = local.real
        y = local.imag + (0.5 * self.length * np.tan(0.5 * self.halves))[:, None]
        # From a circle through the origin along x, without using its centre, which may be far
        # away.
        bend = (2.0 * np.sin(self.halves) / self.length)[:, None]
        root = np.sqrt((bend * x) ** 2 + (1.0 - bend * y) ** 2)
        return (2.0 * y - bend * (x * x + y * y)) / (1.0 + root), x / self.length[:, None] + 0.5


ROUNDS = 14
"""Rounds of evening out the arcs' deviations."""

FIRST_POWER, MOST_POWER, CALMER, BOLDER = 1.0 / 6.0, 0.25, 0.7, 1.2
"""Power of its deviation by which an arc is shortened in a round. Where arcs change alternately,
each at its neighbours' cost, deviations grow with about the sixth power of lengths: any power near
one third would oscillate. An arc that oscillates nevertheless is damped."""

EVEN, REPEATS = 0.15, 3
"""Where an arc still deviates by this much (a logarithm) more than the mean, as where dkappa/ds has
a zero every other arc, the rounds are repeated."""

STEPS = 5
"""Final Gauss-Newton steps. Their conditions have exact derivatives and hold to rounding after
three, or after five if arcs turn by a radian."""

PROBES, CLOSE_PROBES = 12, 16
"""Points per arc at which its deviation is sampled: for least squares, and at the end."""

TANGENT = 2.0**-52 * 8.0
"""Largest angle between neighbouring arcs that is rounding: times the chord, as a fraction of the
distance from the cam axis."""

WIDEST = 1.5
"""Largest half sweep of an arc [rad]: chords do not determine arcs of half a turn."""


@dataclass(frozen=True, slots=True, eq=False)
class ArcSpline:
    """Arcs along one smooth piece.

    Attributes
    ----------
    angles : (n + 1,) [rad] cam angles of the vertices' feet, ascending.
    vertices : (n + 1,) complex [mm].
    halves : (n,) [rad] half the sweep of each arc.
    deviation : sampled distance of curve and arcs [mm]; infinite if the arcs are invalid.
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

    Their deviation is nearly the least possible. Each depends only on its piece and number of arcs.
    """
    layout = Layout.of(counts)
    best, excess = _settled(strands, layout, pieces, strands.difficulty.joints(layout, pieces))
    uneven = np.flatnonzero(excess > EVEN)
    if len(uneven):
        part = Layout.of(counts[uneven])
        chosen = layout.of_joints(excess > EVEN)
        for _ in range(REPEATS):
            best[chosen] = _settled(strands, part, pieces[uneven], best[chosen])[0]
    jointed = JointedCurve.of(strands, layout, pieces, best, PROBES)
    system = ArcSystem.of(layout)
    off = np.zeros((len(best), 2))
    for _ in range(STEPS):
        off = off + jointed.step(system, off)
    return _splines(
        strands.curve, JointedCurve.of(strands, layout, pieces, best, CLOSE_PROBES), off
    )


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
        jointed = JointedCurve.of(strands, layout, pieces, places, PROBES)
        deviations = jointed.deviations(jointed.step(system, np.zeros((len(places), 2))))
        worst, excess = layout.largest(deviations), layout.excess(deviations)
        better = clearly_less(worst, least)
        best = np.where(layout.of_joints(better), places, best)
        uneven = np.where(better, layout.largest(excess), uneven)
        least = np.where(better, worst, least)
        swings = excess * last < 0.0
        power = np.where(swings, CALMER * power, np.minimum(BOLDER * power, MOST_POWER))
        places, last = evened(layout, places, power * excess), excess
    return best, uneven


def _splines(curve: WorkingCurve, jointed: JointedCurve, off: FloatArray) -> list[ArcSpline]:
    """The splines of a batch, for the final offsets and turns `off` (j, 2) of its joints."""
    arcs, layout = Arcs.of(jointed, off), jointed.layout
    # A proof adds the distance of joints from their feet along the arcs.
    gaps = np.abs(off[:, 0] * np.sin(off[:, 1]))
    total = jointed.deviations(off) + np.maximum(gaps[layout.left], gaps[layout.left + 1])
    # Each arc has a parallel on the pitch curve.
    side = -curve.pitch.rotation * np.sign(arcs.halves) * curve.distance
    good = (arcs.length > 2.0 * np.abs(np.sin(arcs.halves)) * side) & np.isfinite(total)
    good &= np.abs(arcs.length * arcs.miss) <= TANGENT * np.max(np.abs(jointed.points))
    good &= np.abs(arcs.halves) <= WIDEST
    valid = jointed.valid & np.logical_and.reduceat(good, layout.first_arcs)
    deviations = np.where(valid, layout.largest(total), np.inf)
    found = []
    for k, (first, last) in enumerate(zip(layout.first, layout.last, strict=True)):
        joints, own = slice(first, last + 1), slice(first - k, last - k)
        angles, vertices = jointed.angles[joints], arcs.vertices[joints]
        found.append(ArcSpline(angles, vertices, arcs.halves[own], float(deviations[k])))
    return found
