"""The least possible number of pieces: closed forms, and integrals over points of the curve."""

from __future__ import annotations

import math

import numpy as np
import pytest

from camgeo.geometry.contour.least_pieces import (
    forced_pieces,
    least_arcs,
    least_chords,
    least_cubics,
)
from camgeo.geometry.outline.path import whole
from camgeo.geometry.pieces import smooth_pieces
from camgeo.numeric.arrays import FloatArray
from tests.contour.cams import dwell, flank, move, translating
from tests.contour.paths import break_count

EPS = 1e-3

POINTS = 1000
"""Points a smooth piece for differences, steps h of some 0.1 mm: the rounding of a double at 50 mm,
7e-15 mm, enters the fourth difference by 7e-15/h^4 = 1e-10/mm^3, a hundred thousandth of kappa^3;
the error of the differences is (h/50)^2."""


def test_a_disc_without_a_move_needs_its_one_arc() -> None:
    path = whole(translating(dwell(360), base=40.0, roller=8.0))
    assert least_arcs(path, EPS) == 0.0
    # Two-sided chords of a circle: 2 pi sqrt(r / (16 eps)) by the small sagitta that is meant.
    assert least_chords(path, EPS) == pytest.approx(2.0 * math.pi * math.sqrt(32.0 / 16.0 / EPS))
    assert least_cubics(path, EPS) == 0.0
    assert forced_pieces(path) == 1
    assert break_count(path) == 1


def test_dwells_and_joints_are_counted() -> None:
    path = whole(translating(dwell(100), move(80, 10.0), dwell(20), move(160, 0.0)))
    assert forced_pieces(path) == 2
    assert break_count(path) == 4


def _whole(values: FloatArray, steps: FloatArray, lengths: FloatArray) -> float:
    """Integral over a whole piece, of which the `steps` leave out a little at both ends."""
    share = np.sum(lengths) * POINTS / len(lengths) / np.sum(steps)
    return float(np.sum(values * steps) * share)


@pytest.mark.parametrize("name", [("setzhub", -1), ("groove", 1), ("plate_translating", -1)])
def test_integrals_agree_with_points_of_the_flank(name: tuple[str, int]) -> None:
    """Curvature by the turn of chords, and its differences, on dense points of each piece."""
    curve = flank(*name)
    chords = arcs = cubics = 0.0
    for piece in smooth_pieces(curve):
        points = curve.point(np.linspace(piece.start, piece.end, POINTS + 1)[:-1])
        chord = np.diff(points)
        length = np.abs(chord)
        step = 0.5 * (length[1:] + length[:-1])
        kappa = np.angle(chord[1:] / chord[:-1]) / step
        slope = np.diff(kappa) / length[1:-1]
        fourth = np.diff(slope) / step[1:-1] - kappa[1:-1] ** 3
        chords += 0.25 * _whole(np.sqrt(np.abs(kappa) / EPS), step, length)
        if not piece.dwell:
            arcs += 0.2002 * _whole(np.cbrt(np.abs(slope) / EPS), length[1:-1], length)
            cubics += 0.18996 * _whole((np.abs(fourth) / EPS) ** 0.25, step[1:-1], length)
    path = whole(curve)
    # Each sum takes a point or three of 1,000 at the ends of each piece for as large as its mean.
    assert least_chords(path, EPS) == pytest.approx(chords, rel=2e-3)
    assert least_arcs(path, EPS) == pytest.approx(arcs, rel=3e-3)
    assert least_cubics(path, EPS) == pytest.approx(cubics, rel=5e-3)


def test_the_powers_of_the_tolerance() -> None:
    path = whole(flank("setzhub", -1))
    for limit, power in ((least_chords, 1 / 2), (least_arcs, 1 / 3), (least_cubics, 1 / 4)):
        assert limit(path, 1e-6) == pytest.approx(limit(path, 1e-3) * 1000.0**power)
