"""Joints near a cusp are kept apart; a cusp at one point is distinguished from undercut."""

from __future__ import annotations

import math

import numpy as np
import pytest

from camgeo.errors import UndercutError
from camgeo.geometry.contour.legs import APART, Bends, joints_apart, require_regular
from camgeo.geometry.pieces import Piece
from camgeo.geometry.working_curve import WorkingCurve
from tests.contour.cams import dwell, move, translating
from tests.contour.paths import hard_curve

CUSP = math.radians(78.9790897521664912236687251744)


def test_a_cusp_in_one_point_is_regular_and_beyond_is_not() -> None:
    """The samples' own middle falls on the cusp of HC21a."""
    piece = Piece(CUSP - 0.1, CUSP + 0.1)
    curve = hard_curve("HC21a")
    assert abs(curve.regularity(np.array([CUSP]))[0]) < 1e-13
    require_regular(curve, piece)
    with pytest.raises(UndercutError, match=r"between cam angles 73\.2495 and 84\.7087 degrees"):
        require_regular(WorkingCurve(curve.pitch, curve.distance * (1.0 + 1e-11)), piece)


@pytest.mark.parametrize(("roller", "regular"), [(39.999, True), (40.0, False), (40.001, False)])
def test_dwell_needs_a_radius(roller: float, regular: bool) -> None:
    pitch = translating(dwell(180), move(100, 1.0), move(80, 0.0)).pitch
    curve, piece = WorkingCurve(pitch, -roller), Piece(0.0, math.pi, 0j)
    if regular:
        require_regular(curve, piece)
        return
    with pytest.raises(UndercutError):
        require_regular(curve, piece)


def test_joints_near_a_cusp_are_kept_apart() -> None:
    curve = hard_curve("HC21a")
    near = np.geomspace(1e-7, 0.05, 200)
    joints = np.concatenate((CUSP - near[::-1], [CUSP], CUSP + near))
    points = curve.point(joints)
    least = APART * np.max(np.abs(points))
    assert np.min(np.abs(np.diff(points))) < 1e-3 * least
    kept = joints_apart(curve, joints)
    assert (kept[0], kept[-1]) == (joints[0], joints[-1])
    assert np.all(np.isin(kept, joints))
    assert np.min(np.abs(np.diff(curve.point(kept)))) >= least
    # Those that are far enough from each other all stay.
    assert len(kept) >= np.count_nonzero(np.abs(np.diff(points)) >= least)


def test_joints_of_a_regular_curve_all_stay() -> None:
    curve = translating(dwell(60), move(120, 15.0), dwell(60), move(120, 0.0))
    joints = np.linspace(1.1, 3.1, 100_000)
    assert joints_apart(curve, joints) is joints


def test_refined_bends_are_linear_and_no_speed_is_negative() -> None:
    """At the end of a steep move the speed grows more than threefold from cell to cell."""
    steep, even = np.array([1e-3, 1e2, 1e4]), np.array([-1.0, 0.0, 1.0])
    fine = Bends(steep, even, even, even).refined()
    assert np.min(fine.speed) >= 0.0
    # Eight cells for one: in the outer half cells the straight line is carried on.
    np.testing.assert_allclose(fine.slope, (np.arange(24) - 11.5) / 8.0, atol=1e-15)
