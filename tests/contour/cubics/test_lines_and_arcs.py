"""Splines as lines and arcs: within the proved bound, compared with dense points and scipy."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from scipy.interpolate import make_interp_spline

from camgeo.errors import GeometryError
from camgeo.geometry.contour.cubic_proof import approximating_arcs
from camgeo.geometry.contour.spline import Arc, CubicSpline, SplineContour
from tests.contour.cams import outline
from tests.contour.splines import dense
from tests.contour.test_spline import blob, slot
from tests.long_form import examples
from tests.measuring import DensePath

some = settings(
    max_examples=examples(7, long=12), deadline=None, suppress_health_check=[HealthCheck.too_slow]
)


def _measured(contour: SplineContour, tolerance: float) -> tuple[float, float]:
    """Largest distance found, both ways, and the bound."""
    fine = approximating_arcs(contour, tolerance)
    arcs, bound = fine.contour, fine.apart
    found = outline(arcs)
    cubics = sum(len(spline) for spline in contour.splines)
    there = float(np.max(found.distances(dense(contour, 4000 // cubics))))
    back = float(np.max(DensePath(dense(contour, 80_000 // cubics)).distances(found.dense(8000))))
    return max(there, back), bound


@pytest.mark.parametrize("tolerance", [1e-1, 1e-3, 1e-5])
@pytest.mark.parametrize("contour", [blob(3, 0.2), blob(8, 0.1), slot()], ids=["3", "8", "slot"])
def test_bound_holds_and_is_sharp(contour: SplineContour, tolerance: float) -> None:
    found, bound = _measured(contour, tolerance)
    # Chords of the dense points are 6e-3 mm long, and bend by 1/4 mm at most: sagitta 1e-6 mm.
    assert found <= bound + 1.2e-6
    assert bound <= tolerance * (1.0 + 1e-6)
    # The coefficients over quarters exceed the cubic error's peaks by a tenth at most.
    assert bound <= 1.12 * found + 1.2e-6


@some
@given(st.lists(st.floats(0.6, 1.4), min_size=6, max_size=12), st.sampled_from([0.2, 1e-3]))
def test_any_closed_spline(radii: list[float], tolerance: float) -> None:
    angles = np.linspace(0.0, 2.0 * np.pi, len(radii) + 1)
    points = 40.0 * np.array([*radii, radii[0]]) * np.exp(1j * angles)
    points[-1] = points[0]
    found = make_interp_spline(angles, points, k=3)
    contour = SplineContour((CubicSpline(found.t, found.c),))
    measured, bound = _measured(contour, tolerance)
    assert measured <= bound + 2e-6
    assert bound <= tolerance * (1.0 + 1e-6)


def test_number_of_arcs_follows_the_law() -> None:
    """Three points an arc: the error is sqrt(3)/216 of the third difference, tolerance^(-1/3)."""
    contour = blob(3, 0.2)
    few, many = (len(approximating_arcs(contour, tolerance).contour) for tolerance in (1e-3, 1e-6))
    # Whole arcs a cubic: of 37 cubics each may have one too many.
    assert many == pytest.approx(10.0 * few, abs=10.0 * 37)
    assert many > 5 * few


def test_arcs_stay_and_lines_are_lines() -> None:
    arcs = approximating_arcs(slot(), 1e-4).contour
    assert np.count_nonzero(arcs.sweeps == np.pi) == 1
    assert arcs.area == pytest.approx(slot().area, abs=1e-4 * slot().length)
    straight = CubicSpline(
        np.array([0.0, 0, 0, 0, 1, 1, 1, 1]), np.array([0, 1, 2, 3], dtype=complex)
    )
    half = Arc(3.0 + 0j, 0j, np.pi, 1.5 + 0j)
    fine = approximating_arcs(SplineContour((straight, half)), 1e-9)
    contour, bound = fine.contour, fine.apart
    assert contour.sweeps.tolist() == [0.0, np.pi]
    assert bound < 1e-13


def test_a_spline_that_turns_back_is_refused() -> None:
    """Out and back on one line: no arc approximates it."""
    knots = np.array([0.0, 0, 0, 0, 1, 1, 1, 1])
    back = CubicSpline(knots, np.array([0.0, 9.0, 5.0, 0.0], dtype=complex))
    with pytest.raises(GeometryError, match="turns back"):
        approximating_arcs(SplineContour((back,)), 1e-3)
