"""Outlines of letters as boundaries: fits, their proofs, and moments."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from camgeo.errors import GeometryError, ToleranceError
from camgeo.geometry.contour.contour import Contour, Pieces, distances, winding_number
from camgeo.geometry.contour.spline import CubicSpline, SplineContour, area, at, elevated
from camgeo.numeric.arrays import ComplexArray
from camgeo.part.glyphs import glyph
from camgeo.part.lettering import LetterBoundary
from tests.strategies import attack

TURNED = 30.0 * np.exp(2.0j)


def boundary(letter: str = "S", height: float = 5.0, place: complex = TURNED) -> LetterBoundary:
    pieces = place + height * np.exp(0.4j) * glyph(letter).outlines[0]
    return LetterBoundary("engraving 1 letter 1 outline 1", True, pieces, 0.004 * height)


def sampled(made: LetterBoundary, count: int = 60) -> ComplexArray:
    points = at(elevated(made.pieces), np.linspace(0.0, 1.0, count))
    return np.asarray(points.ravel(), dtype=np.complex128)


@given(
    st.sampled_from("SOeg8%Ø@"),
    st.floats(1.0, 30.0),
    st.floats(-4.0, -1.0),
    st.complex_numbers(max_magnitude=200.0),
)
@attack
def test_fits_lie_within_what_they_state(
    letter: str, height: float, power: float, place: complex
) -> None:
    made, tolerance = boundary(letter, height, place), 10.0**power
    points = sampled(made)
    for fit in (made.arcs(tolerance), made.polyline(tolerance), made.beside(tolerance)):
        assert fit.deviation <= min(tolerance, made.coarsest)
        assert np.max(distances(points, Pieces.around([fit.contour]))) <= fit.deviation
        assert fit.contour.area > 0.0
        # The bound is a proof of its own: not less than what samples show, and hardly more.
        found = made.deviation(fit.contour)
        assert found <= 1.01 * fit.deviation
        assert found >= np.max(distances(points, Pieces.around([fit.contour])))


def test_the_spline_is_the_outline_itself() -> None:
    made = boundary()
    fit = made.spline(1e-3)
    assert fit.deviation == 0.0
    assert fit.contour.area == pytest.approx(area(elevated(made.pieces)), rel=1e-12)
    assert made.deviation(fit.contour) <= 1e-12
    assert made.deviation(fit.contour.reversed()) <= 1e-12
    strands = fit.contour.strands
    assert made.deviation(SplineContour((*strands[5:], *strands[:5]))) <= 1e-12


def test_a_spline_of_other_pieces_is_compared_as_a_curve() -> None:
    made = boundary("J")
    strands = list(made.spline(1e-3).contour.strands)
    first = next(k for k, each in enumerate(strands) if isinstance(each, CubicSpline))
    curve = strands[first]
    assert isinstance(curve, CubicSpline)
    strands[first : first + 1] = curve.divided(0.4)
    same = SplineContour(tuple(strands))
    assert made.deviation(same) <= 2e-5 * made.coarsest
    controls = curve.controls + np.array([0.0, 0.03j, 0.03j, 0.0])
    bent = CubicSpline(curve.knots, controls)
    strands[first : first + 2] = bent.divided(0.4)
    points = at(bent.beziers, np.linspace(0.0, 1.0, 200))[0]
    off = np.max(distances(points, Pieces.around([made.arcs(1e-6).contour])))
    assert made.deviation(SplineContour(tuple(strands))) == pytest.approx(off, rel=0.01)


@pytest.mark.parametrize("off", [1e-5, 1e-3, 0.3])
def test_what_lies_beside_is_found(off: float) -> None:
    made = boundary()
    fit = made.arcs(1e-6).contour
    moved = Contour(fit.vertices + off, fit.sweeps, np.where(fit.sweeps, fit.centres + off, 0.0))
    assert made.deviation(moved) == pytest.approx(off, rel=0.2)
    spline = made.spline(1e-3).contour
    strands = tuple(
        CubicSpline(each.knots, each.controls + off)
        if isinstance(each, CubicSpline)
        else type(each)(each.start + off, each.end + off, 0.0, 0j)
        for each in spline.strands
    )
    assert made.deviation(SplineContour(strands)) == pytest.approx(off, rel=0.2)


def test_moments_are_those_of_fine_polygons() -> None:
    made = boundary()
    fine = made.polyline(1e-6).contour
    found, expected = made.moments(1e-9), fine.moments
    room = 1e-6 * fine.length
    assert abs(found.area - expected.area) <= room
    assert abs(found.first - expected.first) <= room * 35.0
    assert abs(found.area - area(elevated(made.pieces))) <= 1e-12
    polar = made.second_moments(1e-9)
    mean = expected.first / expected.area
    assert polar.polar == pytest.approx(expected.area * abs(mean) ** 2, rel=0.01)
    assert polar.square == pytest.approx(expected.area * mean**2, rel=0.01)


@pytest.mark.parametrize("letter", ["O", "S"])
def test_radii_are_those_of_samples(letter: str) -> None:
    far, around = boundary(letter), boundary(letter, 20.0, -8.0 - 10.0j)
    for made in (far, around):
        reach, place = made.farthest()
        assert place is None
        assert reach == pytest.approx(np.max(np.abs(sampled(made))), rel=1e-4)
    assert far.nearest() == 0.0
    inside = winding_number(around.arcs(1e-3).contour, 0j) != 0
    expected = np.min(np.abs(sampled(around))) if inside else 0.0
    assert around.nearest() == pytest.approx(expected, rel=1e-4)


def test_refusals() -> None:
    made = boundary()
    with pytest.raises(GeometryError, match="no cutter"):
        made.offset(1.0)
    with pytest.raises(GeometryError, match="end to end and closed"):
        LetterBoundary("open", True, made.pieces[:-1], 0.01)
    bow = np.array([0.0, 2.0 + 2.0j, 2.0, 2.0j]) + 10.0
    ends = np.roll(bow, -1)
    crossed = LetterBoundary("bow", True, np.stack((bow, 0.5 * (bow + ends), ends), axis=1), 0.01)
    for form in (crossed.arcs, crossed.polyline, crossed.spline):
        with pytest.raises(GeometryError, match="the bow crosses itself"):
            form(1e-3)
    with pytest.raises(ToleranceError):
        made.arcs(1e-15)


