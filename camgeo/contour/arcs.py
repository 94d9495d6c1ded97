"""Fit by lines and G1 arcs: biarcs between points of the curve with its own tangents there."""

from __future__ import annotations

import math

import numpy as np

from camgeo.contour.chain import Chain
from camgeo.contour.fit import Fit
from camgeo.contour.joints import joints_apart, require_regular, values_at_joints
from camgeo.contour.legs import StretchLeg, TurnLeg
from camgeo.contour.locate import foot_points
from camgeo.contour.proved import proved_fit
from camgeo.contour.spread import Spread
from camgeo.curve.pieces import Piece
from camgeo.curve.working_curve import WorkingCurve
from camgeo.errors import ToleranceError
from camgeo.numeric.arrays import ComplexArray, FloatArray
from camgeo.outline.path import Path

BIARC_CONSTANT = 0.2912
"""Arcs of plain biarcs needed, asymptotically: 0.2912 eps^(-1/3) times the integral of
|dkappa/ds|^(1/3) ds."""

AIM = 0.98
"""Share of the tolerance that the sampled distance may reach; the proof takes the rest."""

PROBES = 8
"""Points an arc at which its distance is sampled while the number of arcs is sought."""

FLAT = 2e-12
"""An arc with a sagitta of a smaller share of the largest distance from the cam axis is a line: its
centre has no digits left to be known by."""

HALVINGS = 8
"""Rounds of halving at most."""

MAX_ARCS = 200_000
"""Arcs a smooth piece at most; more is a tolerance beyond the arithmetic."""


def fit_arcs(path: Path, tolerance: float) -> Fit:
    """One pass of biarcs within `tolerance` [mm] of `path`, counter-clockwise.

    Breaks are joints of the contour, each dwell is one arc about the cam axis, of any sweep, and
    each arc of the path is one arc. Corners are where the path has them and nowhere else.

    Raises
    ------
    UndercutError
        If the path is not regular.
    ToleranceError
        If the tolerance cannot be reached in double precision.
    GeometryError
        If the contour cannot be compared with the path.
    """

    def fit_piece(leg: StretchLeg, piece: Piece, aim: float) -> Chain:
        return _fit_piece(leg.curve, piece, aim, tolerance)

    def fit_turn(leg: TurnLeg, _aim: float) -> Chain:
        return Chain(
            np.zeros(1), np.array([leg.first]), np.array([leg.sweep]), np.array([leg.centre])
        )

    return proved_fit(path, tolerance, AIM * tolerance, fit_piece, fit_turn)


def _fit_piece(curve: WorkingCurve, piece: Piece, aim: float, tolerance: float) -> Chain:
    require_regular(curve, piece)
    if piece.dwell:
        return dwell_arc(curve, piece)

    def density(phi: FloatArray) -> FloatArray:
        # (|dkappa/ds|)^(1/3) ds is the same for all parallels, also where one has a cusp.
        speed = curve.pitch.speed(curve.pitch.relative_jet(phi, order=1))
        return np.cbrt(np.abs(curve.pitch.curvature_slope(phi)) * speed * speed)

    spread = Spread(piece, density)
    count = max(1, math.ceil(0.5 * BIARC_CONSTANT * spread.total * aim ** (-1.0 / 3.0)))
    while True:
        chain, distance = _sound_biarcs(curve, joints_apart(curve, spread.joints(count)))
        if distance <= aim:
            return chain
        if 2 * count > MAX_ARCS or aim <= 0.0:
            raise ToleranceError("arcs cannot follow the curve", tolerance, distance)
        count = max(count + 1, math.ceil(count * min(2.0, (distance / aim) ** (1.0 / 3.0))))


def dwell_arc(curve: WorkingCurve, piece: Piece) -> Chain:
    """The one arc about the cam axis that a dwell, or a part of one, is."""
    start = np.array([piece.start])
    sweep = -curve.pitch.rotation * (piece.end - piece.start)
    return Chain(start, curve.point(start), np.array([sweep]), np.zeros(1, dtype=np.complex128))


def _sound_biarcs(curve: WorkingCurve, joints: FloatArray) -> tuple[Chain, float]:
    """Biarcs whose arcs have a parallel on the pitch curve, see `camgeo.contour.deviation`.

    Beside a cusp the curvature may grow so fast between two joints that the second arc has to turn
    back, with less than the roller's radius: such spans are halved.
    """
    chain, distance = _biarcs(curve, joints)
    for _ in range(HALVINGS):
        side = -curve.pitch.rotation * np.sign(chain.sweeps)
        radii = np.abs(chain.vertices - chain.centres)
        bad = (chain.sweeps != 0.0) & (radii <= side * curve.distance)
        if not np.any(bad):
            break
        spans = np.flatnonzero(bad[0::2] | bad[1::2])
        halves = 0.5 * (joints[spans] + joints[spans + 1])
        joints = joints_apart(curve, np.insert(joints, spans + 1, halves))
        chain, distance = _biarcs(curve, joints)
    return chain, distance


def _biarcs(curve: WorkingCurve, joints: FloatArray) -> tuple[Chain, float]:
    """Biarcs between `joints` (n + 1,) [rad], and the largest distance found by sampling."""
    points = values_at_joints(curve.point, joints)
    tangents = values_at_joints(curve.tangent, joints)
    chord = points[1:] - points[:-1]
    t0, t1 = tangents[:-1], tangents[1:]
    # Equal tangent lengths d at both ends: |chord - d (t0 + t1)| = 2 d.
    both = t0 + t1
    square = chord.real**2 + chord.imag**2
    along = chord.real * both.real + chord.imag * both.imag
    opening = 2.0 * (1.0 - (t0.real * t1.real + t0.imag * t1.imag))
    length = square / (along + np.sqrt(along * along + opening * square))
    middle = 0.5 * (points[:-1] + points[1:] + length * (t0 - t1))
    middle_tangent = (chord - length * both) / (2.0 * length)

    vertices = np.ravel(np.column_stack((points[:-1], middle)))
    directions = np.ravel(np.column_stack((t0, middle_tangent)))
    ends = np.append(vertices[1:], points[-1])
    sweeps, centres = arcs_from_tangents(vertices, directions, ends)

    guess = 0.5 * (joints[:-1] + joints[1:])
    feet = foot_points(curve, middle, guess)
    # Beside a cusp, where the curve hardly moves with the angle, the search may leave the joints.
    feet = np.where((feet > joints[:-1]) & (feet < joints[1:]), feet, guess)
    angles = np.ravel(np.column_stack((joints[:-1], feet)))
    chain = Chain(angles, vertices, sweeps, centres)
    return chain, _sampled_distance(curve, chain, ends, np.append(angles[1:], joints[-1]))


def arcs_from_tangents(
    starts: ComplexArray, tangents: ComplexArray, ends: ComplexArray
) -> tuple[FloatArray, ComplexArray]:
    """Sweeps and centres of the arcs that leave `starts` along `tangents` and reach `ends`."""
    chords = ends - starts
    half = np.angle(chords * np.conj(tangents))
    flat = np.abs(chords) * np.abs(half) <= 4.0 * FLAT * np.max(np.abs(starts), initial=0.0)
    safe = np.where(flat, 1.0, half)
    radii = np.abs(chords) / (2.0 * np.sin(safe))
    centres = np.where(flat, 0.0, starts + 1j * tangents * radii)
    return np.where(flat, 0.0, 2.0 * half), centres


def _sampled_distance(
    curve: WorkingCurve, chain: Chain, ends: ComplexArray, end_angles: FloatArray
) -> float:
    """Largest distance from the chain of `PROBES` points of the curve beside each of its arcs."""
    parts = (np.arange(PROBES) + 0.5) / PROBES
    phi = chain.angles[:, None] + (end_angles - chain.angles)[:, None] * parts
    points = curve.point(phi.ravel()).reshape(phi.shape)
    radii = np.abs(chain.vertices - chain.centres)[:, None]
    from_arc = np.abs(np.abs(points - chain.centres[:, None]) - radii)
    along = ends - chain.vertices
    along = (along / np.abs(along))[:, None]
    from_line = np.abs((np.conj(along) * (points - chain.vertices[:, None])).imag)
    distance = np.where(chain.sweeps[:, None] != 0.0, from_arc, from_line)
    return float(np.max(distance))
