"""The fewest pieces of a contour: asymptotic counts of the three forms for small tolerances.

For a small tolerance eps the best spline of order k with one free number a piece leaves, on a span
h, the error C |D| h^k, where D is the k-th derivative that it cannot follow. Spans that share the
error out evenly number (C/eps)^(1/k) times the integral of |D|^(1/k) ds:

- chords, vertices off the curve on one side as far as their middles on the other: D = kappa,
  C = 1/16 (the sagitta kappa h^2/8, halved);
- G1 arcs: D = dkappa/ds, C = sqrt(3)/216 (a C1 quadratic spline leaves B_3(t)/6 of a cubic, and the
  largest value of B_3 is sqrt(3)/36), hence 0.2002 = C^(1/3);
- C2 cubics over the arc length: D = kappa'' - kappa^3, the normal part of the fourth derivative of
  the point, C = 1/768 (B_4(t)/24 less its middle; B_4 swings by 1/16).

B_k are Bernoulli's polynomials, the errors of splines that are free of the ends and equally spaced.
A finite contour needs a little more: its pieces are whole numbers, and where smooth pieces meet,
point and tangent are given. A planar cubic could also choose its parameter, which the third form
does not: over the arc length its order is 4, as for the graph of a function.
"""

from __future__ import annotations

import math

import numpy as np

from camgeo.geometry.contour.legs import StretchLeg, TurnLeg, legs_of
from camgeo.geometry.outline.path import Path
from camgeo.geometry.pieces import Piece
from camgeo.geometry.working_curve import WorkingCurve
from camgeo.numeric.arrays import FloatArray
from camgeo.units import TURN

CHORD = 1.0 / 16.0
ARC = math.sqrt(3.0) / 216.0
CUBIC = 1.0 / 768.0
"""C of the three forms: the error on a span h is C |D| h^k."""

CELLS = 4096
"""Cells a smooth piece over which is summed. The integrands have cube and fourth roots of zeros, so
the error falls with the power 5/4: some 3e-5 of a piece."""


def least_chords(path: Path, tolerance: float) -> float:
    """Chords that a polyline within `tolerance` [mm] of `path` needs, dwells and turns included."""
    total = 0.0
    for leg in legs_of(path):
        if isinstance(leg, TurnLeg):
            total += math.sqrt(leg.radius) * leg.end
        else:
            total += math.fsum(_chords(leg.curve, piece) for piece in leg.pieces)
    return total * math.sqrt(CHORD / tolerance)


def least_arcs(path: Path, tolerance: float) -> float:
    """Arcs that a G1 contour within `tolerance` [mm] of `path` needs beyond `forced_pieces`."""
    total = math.fsum(_arcs(curve, piece) for curve, piece in _curved(path))
    return total * math.cbrt(ARC / tolerance)


def least_cubics(path: Path, tolerance: float) -> float:
    """Cubics that a spline within `tolerance` [mm] of `path` needs beyond `forced_pieces`."""
    total = math.fsum(_cubics(curve, piece) for curve, piece in _curved(path))
    return total * math.sqrt(math.sqrt(CUBIC / tolerance))


def forced_pieces(path: Path, widest: float = TURN) -> int:
    """Dwells and turns of `path`: each is one arc, or several of at most `widest` [rad], whatever
    the tolerance.
    """
    legs = legs_of(path)
    sweeps = [leg.end for leg in legs if isinstance(leg, TurnLeg)]
    stretches = [leg.pieces for leg in legs if isinstance(leg, StretchLeg)]
    sweeps += [each.end - each.start for pieces in stretches for each in pieces if each.is_arc]
    # As a contour is split: rounding makes no arc wider.
    return sum(max(1, math.ceil(sweep / widest - 1e-12)) for sweep in sweeps)


def _curved(path: Path) -> list[tuple[WorkingCurve, Piece]]:
    """The smooth pieces that are no dwells."""
    stretches = [leg for leg in legs_of(path) if isinstance(leg, StretchLeg)]
    return [(leg.curve, piece) for leg in stretches for piece in leg.pieces if not piece.is_arc]


def _middles(piece: Piece) -> tuple[FloatArray, float]:
    borders = np.linspace(piece.start, piece.end, CELLS + 1)
    return 0.5 * (borders[:-1] + borders[1:]), (piece.end - piece.start) / CELLS


def _speed(curve: WorkingCurve, phi: FloatArray) -> FloatArray:
    return curve.pitch.speed(curve.pitch.relative_jet(phi, order=1))


def _chords(curve: WorkingCurve, piece: Piece) -> float:
    """Integral of sqrt(|kappa_d|) ds = sqrt(|kappa| (1 + d kappa)) |Z'| dphi, finite at a cusp."""
    phi, width = _middles(piece)
    kappa = curve.pitch.curvature(phi)
    regular = np.maximum(1.0 + curve.distance * kappa, 0.0)
    return width * float(np.sum(np.sqrt(np.abs(kappa) * regular) * _speed(curve, phi)))


def _arcs(curve: WorkingCurve, piece: Piece) -> float:
    """Integral of |dkappa/ds|^(1/3) ds, which is the same for all parallels."""
    phi, width = _middles(piece)
    speed = _speed(curve, phi)
    return width * float(np.sum(np.cbrt(np.abs(curve.pitch.curvature_slope(phi)) * speed * speed)))


def _cubics(curve: WorkingCurve, piece: Piece) -> float:
    """Integral of |kappa'' - kappa^3|^(1/4) ds of the parallel itself.

    The mean of kappa'' over a cell is the growth of kappa' over it, divided by its length.
    """
    phi, width = _middles(piece)
    # One-sided values at both ends, from inside.
    borders = np.concatenate(([phi[0]], 0.5 * (phi[:-1] + phi[1:]), [phi[-1]]))
    growth = np.diff(_bend_slope(curve, borders))
    kappa = curve.pitch.curvature(phi)
    regular = np.maximum(1.0 + curve.distance * kappa, 0.0)
    length = width * _speed(curve, phi) * regular
    length[[0, -1]] *= 0.5
    moves = length > 0.0
    bend = kappa[moves] / regular[moves]
    fourth = np.abs(growth[moves] / length[moves] - bend**3)
    # The outermost half cells are as difficult as their neighbouring halves.
    weight = np.ones(len(phi))
    weight[[0, -1]] = 2.0
    return float(np.sum((weight * length)[moves] * fourth**0.25))


def _bend_slope(curve: WorkingCurve, phi: FloatArray) -> FloatArray:
    """dkappa_d/ds [1/mm^2] of the parallel; 0 at a cusp, where there is none."""
    kappa = curve.pitch.curvature(phi)
    regular = 1.0 + curve.distance * kappa
    slope = curve.pitch.curvature_slope(phi)
    denominator = _speed(curve, phi) * regular**3
    out: FloatArray = np.zeros_like(slope)
    return np.divide(slope, denominator, out=out, where=denominator > 0.0)
