"""Biarcs between points of a curve, many at once, and their distance from it.

At the ends of a smooth piece they have the curve's own tangents, between them those that deviate
least. The curve is evaluated at `PARTS` places per span, in one call for all spans. Its crossing of
the middle of a biarc, and its distance between the places, follow from Hermite cubics.

The best G1 arcs, two of equal length h a span, pass through the curve at the joints and in the
middles, but not along its tangent: e = kappa' h^3 B_3(t) / 6 over each arc, B_3 Bernoulli's
polynomial, has the slope kappa' h^2 / 12 there. So biarcs whose tangents are turned by that follow
a curve as closely as any arcs, 3.08 times as closely as biarcs with its own tangents. As kappa'
varies and as pieces end with given tangents the angles come from least squares, which have the same
limit.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Self

import numpy as np

from camgeo.contour.bezier import at
from camgeo.contour.chain import Chain
from camgeo.contour.hermite import highest
from camgeo.curve.working_curve import WorkingCurve
from camgeo.numeric.arrays import BoolArray, ComplexArray, FloatArray, IntArray

OUTERMOST = 0.5
"""Weight of a piece's outermost spans, whose outer tangent is given. With less, the neighbouring
rotations are those of a piece that continues, and the outermost spans have to be short; with more,
the others deviate more."""


def tangent_turns(apart: FloatArray, lengths: FloatArray, last: IntArray) -> FloatArray:
    """(2, S) [rad] by which the tangents at the start and at the end of each span turn.

    Spans that join have the same rotation there; at both ends of a chain it is 0.

    Parameters
    ----------
    apart : (S, p) [mm] how far the curve lies to the right of the biarcs with its own tangents, at
        p places that divide each span evenly.
    lengths : (S,) [mm] of the spans' chords.
    last : (k,) number of the last span of each chain.
    """
    turns = np.zeros((2, len(lengths)))
    if len(lengths) == len(last):
        return turns
    closes = np.zeros(len(lengths), dtype=np.bool_)
    closes[last] = True
    weight = np.where(closes | np.roll(closes, 1), OUTERMOST, 1.0)
    # Displacement of the biarc by a rotation of 1 at the start, or at the end, of a span of length
    # 1.
    places = np.arange(1, apart.shape[1] + 1) / (apart.shape[1] + 1)
    ahead = np.where(places < 0.5, places - 1.5 * places * places, 0.5 * (1.0 - places) ** 2)
    behind = -ahead[::-1]
    pull = weight * lengths
    before, after = pull * (apart @ behind), pull * (apart @ ahead)
    square = pull * lengths
    joined = ~closes[:-1]
    both = joined[:-1] & joined[1:]
    own = float(ahead @ ahead) * (square[:-1] + square[1:])
    cross = np.where(both, float(ahead @ behind) * square[1:-1], 0.0)
    found = _tridiagonal(cross, own, np.where(joined, -(before[:-1] + after[1:]), 0.0))
    turns[1, :-1] = found
    turns[0, 1:] = found
    return turns


def _tridiagonal(outer: FloatArray, middle: FloatArray, right: FloatArray) -> FloatArray:
    """Solution (n,) with the main band `middle` (n,) and `outer` (n - 1,) on both sides of it."""
    from scipy.linalg import solveh_banded  # only for making a contour

    if len(middle) == 1:  # which scipy does not accept
        return right / middle
    bands = np.zeros((2, len(middle)))
    bands[0, 1:], bands[1] = outer, middle
    found: FloatArray = solveh_banded(bands, right, overwrite_ab=True, check_finite=False)
    return found


PARTS = 6
"""Places per span: for a curve whose curvature has a constant slope the distance is a cubic over
each of the two arcs, and Hermite cubics are exact."""

STEPS = 4
"""Newton steps to the middle, which lies near half way."""

FLAT = 2e-12
"""An arc whose sagitta is a smaller fraction of the largest distance from the cam axis is a line:
its centre has no significant digits."""


@dataclass(frozen=True, slots=True, eq=False)
class Ends:
    """Points, unit tangents and paces (k,) at the ends of smooth pieces, left-hand values there."""

    points: ComplexArray
    tangents: ComplexArray
    paces: FloatArray


@dataclass(frozen=True, slots=True, eq=False)
class Biarcs:
    """Biarcs along smooth pieces, span by span; S spans.

    Attributes
    ----------
    angles : (S, 2) [rad] of the start of each arc: the first joint, and where the curve crosses
        the middle, square to both arcs.
    vertices, tangents : (S, 2) complex [mm], starts of the arcs and unit tangents there.
    curvatures : (S, 2) [1/mm], counter-clockwise positive; 0 is a line.
    ends : (S,) complex [mm] ends of the second arcs.
    distances : (S,) [mm] largest distance found from the curve.
    least_step : (S,) [mm] smallest distance between neighbouring places.
    """

    angles: FloatArray
    vertices: ComplexArray
    tangents: ComplexArray
    curvatures: FloatArray
    ends: ComplexArray
    distances: FloatArray
    least_step: FloatArray

    @classmethod
    def along(cls, curve: WorkingCurve, joints: FloatArray, stops: IntArray, ends: Ends) -> Self:
        """Biarcs along several chains of spans, one after the other.

        Parameters
        ----------
        joints : (S + k,) [rad] of all k chains, each with its last one.
        stops : (k,) places of the last joints in `joints`.
        ends : of each chain.
        """
        inner = np.ones(len(joints), dtype=np.bool_)
        inner[stops] = False
        starts = np.flatnonzero(inner)
        first, step = joints[starts], np.diff(joints)[inner[:-1]] / PARTS
        phi = first[:, None] + step[:, None] * np.arange(PARTS)
        shape = (len(starts), PARTS + 1)
        points, tangents = np.empty((2, *shape), dtype=np.complex128)
        slopes = np.empty(shape)
        last = stops - np.arange(1, len(stops) + 1)
        traced, at_ends = curve.traced(phi.ravel()), (ends.points, ends.tangents, ends.paces)
        for whole, part, end in zip((points, tangents, slopes), traced, at_ends, strict=True):
            whole[:, :-1] = part.reshape(phi.shape)
            whole[:-1, -1] = whole[1:, 0]
            whole[last, -1] = end
        slopes *= step[:, None]
        outer = tangents[:, (0, -1)].T
        plain = _Arcs.between(points, *outer)
        lengths = np.abs(points[:, -1] - points[:, 0])
        turns = tangent_turns(plain.near(points[:, 1:-1]), lengths, last)
        arcs = _Arcs.between(points, *(outer * np.exp(1j * turns)))
        angles, apart, peaks = arcs.distances_to(points, tangents, slopes)
        distances = np.maximum(peaks, np.max(np.abs(apart), axis=1))
        least = np.min(np.abs(np.diff(points, axis=1)), axis=1)
        parts = arcs.vertices, arcs.tangents, arcs.curvatures, points[:, -1]
        return cls(first[:, None] + step[:, None] * angles, *parts, distances, least)

    @classmethod
    def along_cubics(cls, pieces: ComplexArray) -> Self:
        """Biarcs along Bezier `pieces` (S, 4) [mm], with its tangents; `angles` are parts."""
        t = np.linspace(0.0, 1.0, PARTS + 1)
        points, sides = at(pieces, t), 3.0 * np.diff(pieces, axis=1)
        rates = sides @ np.stack(((1.0 - t) ** 2, 2.0 * t * (1.0 - t), t * t))
        # Where the first side has no length the tangent is that of the next one, or of the chord.
        for place, side in ((0, points[:, 1] - points[:, 0]), (-1, points[:, -1] - points[:, -2])):
            rates[:, place] = np.where(rates[:, place] == 0.0, side, rates[:, place])
        slopes = np.abs(rates)
        tangents = rates / np.where(slopes > 0.0, slopes, 1.0)
        arcs = _Arcs.between(points, tangents[:, 0], tangents[:, -1])
        angles, apart, peaks = arcs.distances_to(points, tangents, slopes / PARTS)
        distances = np.maximum(peaks, np.max(np.abs(apart), axis=1))
        parts = arcs.vertices, arcs.tangents, arcs.curvatures, points[:, -1]
        return cls(angles, *parts, distances, np.min(np.abs(np.diff(points, axis=1)), axis=1))

    def turned_over(self, curve: WorkingCurve) -> BoolArray:
        """(S,) spans with an arc whose parallel on the pitch curve has turned inside out."""
        bad: BoolArray = np.any(
            -curve.pitch.rotation * curve.distance * self.curvatures >= 1.0, axis=1
        )
        return bad

    def chain(self) -> Chain:
        """The arcs one after the other; the flattest are lines."""
        starts, tangents = self.vertices.ravel(), self.tangents.ravel()
        chords = np.append(starts[1:], self.ends[-1]) - starts
        half = np.angle(chords * np.conj(tangents))
        lengths = np.abs(chords)
        flat = lengths * np.abs(half) <= 4.0 * FLAT * np.max(np.abs(starts), initial=0.0)
        radii = lengths / (2.0 * np.sin(np.where(flat, 1.0, half)))
        centres = np.where(flat, 0.0, starts + 1j * tangents * radii)
        return Chain(self.angles.ravel(), starts, np.where(flat, 0.0, 2.0 * half), centres)


@dataclass(frozen=True, slots=True, eq=False)
class _Arcs:
    """Vertices, tangents and curvatures (S, 2) of biarcs, as of `Biarcs`."""

    vertices: ComplexArray
    tangents: ComplexArray
    curvatures: FloatArray

    @classmethod
    def between(cls, points: ComplexArray, t0: ComplexArray, t1: ComplexArray) -> Self:
        """From the first to the last of `points` (S, PARTS + 1), with the unit tangents there."""
        start, end = points[:, 0], points[:, -1]
        # Next to a cusp two joints may be one point; they are too near to each other to be kept.
        end = np.where(np.abs(end - start) <= 4.0 * np.spacing(np.abs(end)), start + t0, end)
        chord = end - start
        # Equal tangent lengths d at both ends: |chord - d (t0 + t1)| = 2 d.
        both = t0 + t1
        square = chord.real**2 + chord.imag**2
        along = chord.real * both.real + chord.imag * both.imag
        opening = 2.0 * (1.0 - (t0.real * t1.real + t0.imag * t1.imag))
        length = square / (along + np.sqrt(along * along + opening * square))
        middle = 0.5 * (start + end + length * (t0 - t1))
        across = (chord - length * both) / (2.0 * length)
        vertices, directions = np.stack((start, middle), 1), np.stack((t0, across), 1)
        chords = np.stack((middle - start, end - middle), 1)
        # Where the curve turns back at once, one of the arcs has no length.
        squares = np.abs(chords) ** 2
        squares = np.where(squares > 0.0, squares, 1.0)
        curvatures = 2.0 * (np.conj(directions) * chords).imag / squares
        return cls(vertices, directions, curvatures)

    def near(self, places: ComplexArray) -> FloatArray:
        """How far (S, PARTS - 1) [mm] the `places` inside lie to the right of the arcs, nearly."""
        arc = (np.arange(1, PARTS) > 0.5 * PARTS).astype(np.intp)
        arm = places - self.vertices[:, arc]
        bend, ahead = self.curvatures[:, arc], self.tangents[:, arc]
        right = arm.real * ahead.imag - arm.imag * ahead.real
        near: FloatArray = 0.5 * bend * (arm.real**2 + arm.imag**2) + right
        return near

    def distances_to(
        self, points: ComplexArray, tangents: ComplexArray, slopes: FloatArray
    ) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Parts of the span (S, 2) at which the arcs begin, distances (S, PARTS + 1) [mm] of the
        places to the right of the arcs, and the largest such distance (S,) between places.

        `slopes`: of the arc length over a part of a span [mm].
        """
        # The curve seen from the middle: its way along the common tangent, and off it.
        middle, across = self.vertices[:, 1], self.tangents[:, 1]
        back = np.conj(across)[:, None]
        local, rates = back * (points - middle[:, None]), back * tangents * slopes
        rows = np.arange(len(points))
        before = np.sum(local[:, 1:-1].real < 0.0, axis=1)
        t, off, turn = _crossing(local[rows, before], local[rows, before + 1],
                                 rates[rows, before], rates[rows, before + 1])  # fmt: skip

        # From the first arc up to the part with the middle, from the second after it.
        second = np.arange(PARTS + 1) > before[:, None]
        arc = second.astype(np.intp)
        row = rows[:, None]
        arm = points - self.vertices[row, arc]
        bend, ahead = self.curvatures[row, arc], 1j * self.tangents[row, arc]
        bent = bend * (arm.real**2 + arm.imag**2) - 2.0 * (np.conj(ahead) * arm).real
        root = np.sqrt(np.maximum(1.0 + bend * bent, 0.0))
        apart = bent / (1.0 + root)
        outward = (bend * arm - ahead) / root
        growth = (np.conj(outward) * tangents).real * slopes
        peaks = highest(apart[:, :-1], apart[:, 1:], growth[:, :-1], growth[:, 1:])
        # Within the part with the middle the second arc takes over from the first.
        near, far = (rows, before), (rows, before + 1)
        sides = highest(
            np.stack((apart[near], off)), np.stack((off, apart[far])),
            np.stack((t * growth[near], (1.0 - t) * turn)),
            np.stack((t * turn, (1.0 - t) * growth[far])),
        )  # fmt: skip
        peaks[near] = np.maximum(np.abs(off), np.max(sides, axis=0))
        angles = np.stack((np.zeros(len(t)), before + t), 1)
        return angles, apart, np.max(peaks, axis=1)


def _crossing(
    here: ComplexArray, there: ComplexArray, rate: ComplexArray, rate_there: ComplexArray
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Where in [0, 1] Hermite's cubic between `here` and `there` has the real part 0, and minus its
    imaginary part and the slope of that there.
    """
    chord = there - here
    square, cube = 3.0 * chord - 2.0 * rate - rate_there, rate + rate_there - 2.0 * chord
    a, b, c, d = here.real, rate.real, square.real, cube.real
    t = np.clip(-a / np.where(chord.real > 0.0, chord.real, 1.0), 0.0, 1.0)
    for _ in range(STEPS):
        slope = b + t * (2.0 * c + 3.0 * t * d)
        value = a + t * (b + t * (c + t * d))
        t = np.clip(t - value / np.where(slope > 0.0, slope, np.inf), 0.0, 1.0)
    off = here.imag + t * (rate.imag + t * (square.imag + t * cube.imag))
    turn = rate.imag + t * (2.0 * square.imag + 3.0 * t * cube.imag)
    return t, -off, -turn
