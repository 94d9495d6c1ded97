"""Splines and contours of them: compared with scipy and with their reverses."""

from __future__ import annotations

import cmath
import math

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from scipy.interpolate import BSpline, make_interp_spline

from camgeo.errors import GeometryError
from camgeo.geometry.contour.spline import (
    Arc,
    CubicSpline,
    SplineContour,
    at,
    beziers_of_spline,
    cut,
)
from camgeo.numeric.arrays import ComplexArray, FloatArray
from tests.contour.splines import dense, points_of

T = np.linspace(0.0, 1.0, 7)

some = settings(max_examples=40, deadline=None, suppress_health_check=[HealthCheck.too_slow])


@st.composite
def splines(draw: st.DrawFn) -> tuple[int, FloatArray, ComplexArray]:
    """Degree, knots and control points of any spline: not clamped, double knots, spans of 0."""
    degree = draw(st.integers(1, 3))
    count = draw(st.integers(degree + 1, 9))
    steps = [draw(st.sampled_from((0.0, 0.5, 1.0, 3.0))) for _ in range(count + degree)]
    knots = np.concatenate(([-1.0], -1.0 + np.cumsum(steps)))
    multiple = [int(np.count_nonzero(knots == knot)) for knot in knots]
    # A knot of a higher multiplicity tears the curve apart.
    inner = knots[1:-1]
    if max(multiple) > degree + 1 or any(np.count_nonzero(inner == k) > degree for k in inner):
        knots = np.arange(count + degree + 1.0)
    place = st.floats(-100.0, 100.0)
    controls = np.array([complex(draw(place), draw(place)) for _ in range(count)])
    return degree, knots, controls


def blob(bumps: int, depth: float) -> SplineContour:
    """A closed C2 curve with bumps as one spline, with a corner at its start."""
    angles = np.linspace(0.0, 2.0 * np.pi, 40)
    points = 50.0 * np.exp(1j * angles) * (1.0 + depth * np.cos(bumps * angles))
    points[-1] = points[0]
    found = make_interp_spline(angles, points, k=3)
    return SplineContour((CubicSpline(found.t, found.c),))


def slot() -> SplineContour:
    """Two lines, a half circle, and a spline for the other half; counter-clockwise."""
    controls = np.array([-10.0 + 5.0j, -16.0 + 5.0j, -16.0 - 5.0j, -10.0 - 5.0j])
    knots = np.array([0.0, 0.0, 0.0, 0.0, 2.0, 2.0, 2.0, 2.0])
    return SplineContour(
        (
            Arc(-10.0 - 5.0j, 10.0 - 5.0j, 0.0, 0j),
            Arc(10.0 - 5.0j, 10.0 + 5.0j, math.pi, 10.0 + 0j),
            Arc(10.0 + 5.0j, -10.0 + 5.0j, 0.0, 0j),
            CubicSpline(knots, controls),
        )
    )


@some
@given(splines())
def test_pieces_are_those_of_scipy(spline: tuple[int, FloatArray, ComplexArray]) -> None:
    degree, knots, controls = spline
    spans = [k for k in range(degree, len(controls)) if knots[k + 1] > knots[k]]
    if not spans:
        with pytest.raises(GeometryError, match="without a span"):
            beziers_of_spline(degree, knots, controls)
        return
    exact = BSpline(knots, controls, degree)
    inside = np.linspace(0.05, 0.95, 7)
    wanted = np.stack([exact(knots[k] + (knots[k + 1] - knots[k]) * inside) for k in spans])
    pieces = beziers_of_spline(degree, knots, controls)
    # 3 levels of convex sums, and those of scipy: some 20 ulp of the largest control point.
    assert np.max(np.abs(at(pieces, inside) - wanted)) < 2e-12
    whole = CubicSpline.of(degree, knots, controls)
    assert len(whole) == len(spans)
    assert np.max(np.abs(whole.beziers - pieces)) < 2e-12
    assert abs(whole.start - pieces[0, 0]) + abs(whole.end - pieces[-1, 3]) < 2e-12


@some
@given(splines(), st.integers(1, 5))
def test_parts_are_the_piece(spline: tuple[int, FloatArray, ComplexArray], count: int) -> None:
    degree, knots, controls = spline
    try:
        pieces = beziers_of_spline(degree, knots, controls)
    except GeometryError:
        return
    parts = cut(pieces, np.full(len(pieces), count))
    for k in range(count):
        wanted = at(pieces, (k + T) / count)
        assert np.max(np.abs(at(parts[k::count], T) - wanted)) < 2e-12
    # Neighbours share their ends to the last bit, and the outer ends are those of the piece.
    starts, ends = parts[:, 0].reshape(-1, count), parts[:, 3].reshape(-1, count)
    assert np.array_equal(starts[:, 0], pieces[:, 0])
    assert np.array_equal(ends[:, -1], pieces[:, 3])
    assert np.max(np.abs(starts[:, 1:] - ends[:, :-1]), initial=0.0) < 1e-13


def test_clamped_cubics_keep_their_knots() -> None:
    spline = slot().splines[0]
    assert np.array_equal(CubicSpline.of(3, spline.knots, spline.controls).knots, spline.knots)


@pytest.mark.parametrize(
    ("degree", "knots", "message"),
    [
        (4, 10, "degree 4; degrees 1 to 3"),
        (3, 8, "5 control points and 8 knots"),
        (3, 0, "do not ascend"),
    ],
)
def test_what_is_no_spline_is_refused(degree: int, knots: int, message: str) -> None:
    places = np.arange(float(knots)) if knots else np.array([0, 0, 0, 0, 2, 1, 3, 3, 3.0])
    with pytest.raises(GeometryError, match=message):
        beziers_of_spline(degree, places, np.arange(5).astype(np.complex128))


@pytest.mark.parametrize("contour", [blob(3, 0.2), blob(5, 0.05), slot()], ids=str)
def test_area_and_length(contour: SplineContour) -> None:
    points = dense(contour, 4000)
    chords = np.roll(points, -1) - points
    area = 0.5 * float(np.sum((np.conj(points) * chords).imag))
    # Chords h of an arc of radius r lose h^2/(24 r^2) of its length and h^2/6r of area a length:
    # h < 5e-3 mm, r > 1 mm.
    assert contour.area == pytest.approx(area, rel=1e-6)
    assert contour.length == pytest.approx(float(np.sum(np.abs(chords))), rel=2e-6)


def test_area_of_a_parabola_is_exact() -> None:
    """y = 1 - x^2 over [-1, 1] as a spline of degree 2, and the line below it."""
    bow = CubicSpline.of(2, np.array([0.0, 0, 0, 1, 1, 1]), np.array([1.0, 2j, -1.0]))
    contour = SplineContour((Arc(-1.0 + 0j, 1.0 + 0j, 0.0, 0j), bow))
    assert contour.area == pytest.approx(4.0 / 3.0, rel=1e-15)
    exact = math.sqrt(5.0) + 0.5 * math.asinh(2.0)
    assert bow.length == pytest.approx(exact, rel=1e-12)


def test_turned_round() -> None:
    contour = slot()
    back = contour.reversed()
    assert back.area == pytest.approx(-contour.area, rel=1e-14)
    assert back.length == pytest.approx(contour.length, rel=1e-14)
    assert len(back) == len(contour) == 4
    for strand, other in zip(contour.strands, back.strands[::-1], strict=True):
        gap = np.abs(points_of(strand) - points_of(other)[::-1])
        assert np.max(gap) < 1e-13
    assert back.counter_clockwise().area > 0.0
    assert contour.counter_clockwise() is contour
    assert np.max(np.abs(dense(contour))) <= contour.reach


def test_arcs_between_other_ends() -> None:
    arc = Arc(10.0 + 0j, 10j, 0.5 * math.pi, 0j)
    moved = arc.between(10.0 + 1e-3j, 10j)
    assert moved.sweep == arc.sweep
    assert abs(moved.start - moved.centre) == pytest.approx(abs(moved.end - moved.centre))
    assert abs(arc.between(arc.start, arc.end).centre) < 1e-14


@pytest.mark.parametrize("sweep", [5.5, -5.5, 3.0, 2.0 * math.pi])
def test_split_arcs_are_the_same_in_equal_parts(sweep: float) -> None:
    centre, start = 3.0 + 1.0j, 3.5 + 2.0j
    end = centre + (start - centre) * cmath.exp(1j * sweep)
    arc = Arc(start, end, sweep, centre)
    parts = SplineContour((arc, Arc(end, start, 0.0, 0j))).split(math.pi).strands
    arcs, line = parts[:-1], parts[-1]
    assert len(arcs) == (2 if abs(sweep) > math.pi else 1)
    assert line == Arc(end, start, 0.0, 0j)
    assert (arcs[0].start, arcs[-1].end) == (start, end)
    assert sum(part.length for part in arcs) == pytest.approx(arc.length, rel=1e-15)
    for part in arcs:
        assert isinstance(part, Arc)
        assert abs(part.sweep) <= math.pi
        assert abs(part.end - centre) == pytest.approx(arc.radius, rel=1e-15)


@pytest.mark.parametrize(
    "knots", [(1.0, 2.5, 3.0, 4.0), (3.0,), (3.0, 3.0, 5.0), (2.0, 3.0, 3.0, 3.0)]
)
def test_a_spline_divided_at_a_knot_is_the_same(knots: tuple[float, ...]) -> None:
    random = np.random.default_rng(1)
    controls = random.normal(size=len(knots) + 4) + 1j * random.normal(size=len(knots) + 4)
    spline = CubicSpline(np.array([0.0] * 4 + list(knots) + [6.0] * 4), controls)
    one, other = spline.divided(3.0)
    both = np.concatenate((one.beziers, other.beziers))
    assert np.max(np.abs(both - spline.beziers)) <= 1e-15 * len(controls)
    assert (one.start, one.end, other.end) == (spline.start, other.start, spline.end)
    assert (one.knots[-4:] == 3.0).all()
    assert (other.knots[:4] == 3.0).all()
