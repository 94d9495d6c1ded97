"""Scaled boundaries: circles have exact ones to compare with, flanks their own proofs."""

from __future__ import annotations

import pickle

import numpy as np
import pytest

from camgeo.errors import GeometryError
from camgeo.geometry.contour.contour import Contour
from camgeo.part.assembly import bore_outline
from camgeo.part.boundaries import CurveBoundary, ExactBoundary
from camgeo.part.compensation import ScaledBoundary, scaled, scaled_contour, scaled_splines
from camgeo.part.spec import Keyway
from tests.export.stub_product import CircleBoundary
from tests.part.parts import INNER

FACTOR = 1.02

CENTRE = 3.0 - 4.0j

CIRCLE = ScaledBoundary(CircleBoundary("bore", True, 10.0, CENTRE), FACTOR)

EXACT = CircleBoundary("bore", True, 10.0 * FACTOR, CENTRE * FACTOR)

FLANK = CurveBoundary("outline", False, INNER)

TOLERANCE = 0.01


def test_lines_and_arcs_stay_exact() -> None:
    bore = ExactBoundary("bore", True, bore_outline(20.0, Keyway(6.0, 2.8)), Contour.circle(10.0))
    found = scaled(bore, FACTOR)
    assert isinstance(found, ExactBoundary)
    larger = bore_outline(20.0 * FACTOR, Keyway(6.0 * FACTOR, 2.8 * FACTOR))
    assert found.exact.vertices == pytest.approx(larger.vertices, abs=1e-14)
    assert found.round_radius == pytest.approx(10.0 * FACTOR, rel=1e-15)
    assert scaled(bore, 1.0) is bore


@pytest.mark.parametrize("form", ["arcs", "polyline", "beside", "spline"])
def test_a_fit_keeps_its_tolerance_at_the_larger_scale(form: str) -> None:
    for boundary in (CIRCLE, scaled(FLANK, FACTOR)):
        found = getattr(boundary, form)(TOLERANCE)
        assert 0.0 <= found.deviation <= TOLERANCE == found.tolerance
        assert boundary.hole is (boundary is CIRCLE)
        if boundary is CIRCLE and form in ("arcs", "polyline"):
            off = EXACT.deviation(found.contour)
            assert off <= found.deviation + 1e-13
            assert off >= 0.9 * TOLERANCE  # the stub spends what it is given
        if boundary is not CIRCLE:
            proved = boundary.deviation(found.contour)
            assert proved <= TOLERANCE * (1.0 + 1e-9)


def test_a_contour_that_is_off_is_found_to_be() -> None:
    boundary = scaled(FLANK, FACTOR)
    unscaled = FLANK.polyline(1e-3).contour
    nearest, (farthest, _) = FLANK.nearest(), FLANK.farthest()
    assert boundary.deviation(unscaled) >= (FACTOR - 1.0) * nearest - 1e-3
    assert boundary.deviation(scaled_contour(unscaled, FACTOR)) <= 1.1 * FACTOR * 1e-3
    splines = FLANK.spline(1e-2).contour
    assert boundary.deviation(scaled_splines(splines, FACTOR)) <= 1.1 * FACTOR * 1e-2
    assert boundary.deviation(splines) >= (FACTOR - 1.0) * nearest - 1e-2
    assert boundary.nearest() == FACTOR * nearest
    assert boundary.farthest()[0] == FACTOR * farthest


def test_moments_and_parallels() -> None:
    moments, exact = CIRCLE.moments(1e-10), EXACT.moments(1e-10)
    assert moments.area == pytest.approx(exact.area, rel=1e-14)
    assert moments.first == pytest.approx(exact.first, rel=1e-13)
    second, whole = CIRCLE.second_moments(1e-10), EXACT.second_moments(1e-10)
    assert second.polar == pytest.approx(whole.polar, rel=1e-13)
    assert second.square == pytest.approx(whole.square, rel=1e-13)
    cutter = CIRCLE.offset(2.0)
    points = cutter.arcs(1e-6).contour.vertices
    assert np.abs(points - CENTRE * FACTOR) == pytest.approx(10.0 * FACTOR - 2.0, abs=1e-12)


def test_pickles_and_doors() -> None:
    found = pickle.loads(pickle.dumps(CIRCLE))
    assert (found.name, found.factor) == ("bore", FACTOR)
    assert found.unscaled.__reduce__() == CIRCLE.unscaled.__reduce__()
    with pytest.raises(GeometryError, match="must be a boundary"):
        ScaledBoundary("bore", 1.1)  # type: ignore[arg-type]  # wrong on purpose
    with pytest.raises(GeometryError):
        ScaledBoundary(CIRCLE, -1.0)
