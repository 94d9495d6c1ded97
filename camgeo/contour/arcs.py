"""Fit by lines and G1 arcs: biarcs between points of the curve with its own tangents there."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from camgeo.contour.chain import Chain
from camgeo.contour.fit import Fit
from camgeo.contour.locate import foot_points
from camgeo.contour.proved import proved_fit
from camgeo.contour.spread import Spread
from camgeo.curve.pieces import Piece
from camgeo.curve.working_curve import WorkingCurve
from camgeo.errors import ToleranceError, UndercutError
from camgeo.motion.motion import Side
from camgeo.numeric.arrays import ComplexArray, FloatArray

BIARC_CONSTANT = 0.2912
"""Arcs of plain biarcs needed, asymptotically: 0.2912 eps^(-1/3) times the integral of
|dkappa/ds|^(1/3) ds."""

AIM = 0.98
"""Share of the tolerance that the sampled distance may reach; the proof takes the rest."""

PROBES = 8
"""Points an arc at which its distance is sampled while the number of arcs is sought."""

FLAT = 1e-10
"""An arc with a smaller sagitta [mm] is a line: its centre has no digits left to be known by."""

MAX_ARCS = 200_000
"""Arcs a smooth piece at most; more is a tolerance beyond the arithmetic."""


def fit_arcs(curve: WorkingCurve, tolerance: float) -> Fit:
    """One pass of biarcs within `tolerance` [mm] of `curve`, counter-clockwise.

    Breaks are joints of the contour and each dwell is one arc about the cam axis, of any sweep.

    Raises
    ------
    UndercutError
        If the curve is not regular.
    ToleranceError
        If the tolerance cannot be reached in double precision.
    """

    def fit_piece(piece: Piece, aim: float) -> Chain:
        return _fit_piece(curve, piece, aim, tolerance)

    return proved_fit(curve, tolerance, AIM * tolerance, fit_piece)


def _fit_piece(curve: WorkingCurve, piece: Piece, aim: float, tolerance: float) -> Chain:
    if piece.dwell:
        return dwell_arc(curve, piece)

    def density(phi: FloatArray) -> FloatArray:
        pace, bend = curve.arc_density(phi)
        return np.cbrt(bend) * pace

    require_regular(curve, piece)
    spread = Spread(piece, density)
    count = max(1, math.ceil(0.5 * BIARC_CONSTANT * spread.total * aim ** (-1.0 / 3.0)))
    while True:
        chain, distance = _biarcs(curve, spread.joints(count))
        if distance <= aim:
            return chain
        if 2 * count > MAX_ARCS or aim <= 0.0:
            raise ToleranceError("arcs cannot follow the curve", tolerance, distance)
        count = max(count + 1, math.ceil(count * min(2.0, (distance / aim) ** (1.0 / 3.0))))


def dwell_arc(curve: WorkingCurve, piece: Piece) -> Chain:
    """The one arc about the cam axis that a dwell is."""
    start = np.array([piece.start])
    sweep = -curve.pitch.rotation * (piece.end - piece.start)
    return Chain(start, curve.point(start), np.array([sweep]), np.zeros(1, dtype=np.complex128))


def require_regular(curve: WorkingCurve, piece: Piece) -> None:
    """Raise UndercutError if 1 + d kappa is not positive at some sample of the piece."""
    grid = np.linspace(piece.start, piece.end, 257)[1:-1]
    if float(np.min(curve.regularity(grid))) <= 0.0:
        raise UndercutError(
            "the offset curve has a cusp or undercut between cam angles"
            f" {math.degrees(piece.start):.6g} and {math.degrees(piece.end):.6g} degrees"
            f" (offset {curve.distance:g} mm); no outline can be made of it"
        )


def _biarcs(curve: WorkingCurve, joints: FloatArray) -> tuple[Chain, float]:
    """Biarcs between `joints` (n + 1,) [rad], and the largest distance found by sampling."""
    points = _ends(curve.point, joints)
    tangents = _ends(curve.tangent, joints)
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
    angles = np.ravel(np.column_stack((joints[:-1], foot_points(curve, middle, guess))))
    chain = Chain(angles, vertices, sweeps, centres)
    return chain, _sampled_distance(curve, chain, ends, np.append(angles[1:], joints[-1]))


def arcs_from_tangents(
    starts: ComplexArray, tangents: ComplexArray, ends: ComplexArray
) -> tuple[FloatArray, ComplexArray]:
    """Sweeps and centres of the arcs that leave `starts` along `tangents` and reach `ends`."""
    chords = ends - starts
    half = np.angle(chords * np.conj(tangents))
    flat = np.abs(chords) * np.abs(half) < 4.0 * FLAT
    safe = np.where(flat, 1.0, half)
    radii = np.abs(chords) / (2.0 * np.sin(safe))
    centres = np.where(flat, 0.0, starts + 1j * tangents * radii)
    return np.where(flat, 0.0, 2.0 * half), centres


def _ends(function: Callable[[FloatArray, Side], ComplexArray], joints: FloatArray) -> ComplexArray:
    """Values at the joints of one smooth piece: right-hand at its start, left-hand at its end."""
    values = function(joints, "right")
    values[-1] = function(joints[-1:], "left")[0]
    return values


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
