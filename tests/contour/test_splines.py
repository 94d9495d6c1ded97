"""Splines and contours of them, their fits by cubics, and lines and arcs in their place.

Compared with scipy, with dense points, and with the fewest possible cubics."""

from __future__ import annotations

import cmath
import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from scipy.interpolate import BSpline, make_interp_spline

from camgeo.errors import GeometryError
from camgeo.geometry.contour import cubics
from camgeo.geometry.contour.cubic_proof import approximating_arcs
from camgeo.geometry.contour.cubics import fewest_cubics, fit_spline, fitted_deviation
from camgeo.geometry.contour.spline import (
    Arc,
    CubicSpline,
    SplineContour,
    SplineFit,
    bezier_points,
    beziers_of_spline,
    cut,
)
from camgeo.geometry.outline.path import Path, whole
from camgeo.geometry.pieces import smooth_pieces
from camgeo.geometry.pitch_curve import WorkingCurve
from camgeo.numeric.arrays import ComplexArray, FloatArray
from camgeo.part.boundaries import spline_deviation
from tests.contour.cams import TURN, curves, dwell, flank, move, outline
from tests.contour.cams import translating as cam
from tests.contour.paths import Dense, points_of, spline_points
from tests.long_form import examples
from tests.measuring import DensePath

T = np.linspace(0.0, 1.0, 7)


many = settings(max_examples=40, deadline=None, suppress_health_check=[HealthCheck.too_slow])


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


@many
@given(splines())
def test_pieces_are_those_of_scipy(spline: tuple[int, FloatArray, ComplexArray]) -> None:
    degree, knots, controls = spline
    spans = [k for k in range(degree, len(controls)) if knots[k + 1] > knots[k]]
    if not spans:
        with pytest.raises(GeometryError, match="has no span"):
            beziers_of_spline(degree, knots, controls)
        return
    exact = BSpline(knots, controls, degree)
    inside = np.linspace(0.05, 0.95, 7)
    wanted = np.stack([exact(knots[k] + (knots[k + 1] - knots[k]) * inside) for k in spans])
    pieces = beziers_of_spline(degree, knots, controls)
    # 3 levels of convex sums, and those of scipy: many 20 ulp of the largest control point.
    assert np.max(np.abs(bezier_points(pieces, inside) - wanted)) < 2e-12
    whole = CubicSpline.from_bspline(degree, knots, controls)
    assert len(whole) == len(spans)
    assert np.max(np.abs(whole.beziers - pieces)) < 2e-12
    assert abs(whole.start - pieces[0, 0]) + abs(whole.end - pieces[-1, 3]) < 2e-12


@many
@given(splines(), st.integers(1, 5))
def test_parts_are_the_piece(spline: tuple[int, FloatArray, ComplexArray], count: int) -> None:
    degree, knots, controls = spline
    try:
        pieces = beziers_of_spline(degree, knots, controls)
    except GeometryError:
        return
    parts = cut(pieces, np.full(len(pieces), count))
    for k in range(count):
        wanted = bezier_points(pieces, (k + T) / count)
        assert np.max(np.abs(bezier_points(parts[k::count], T) - wanted)) < 2e-12
    # Neighbours share their ends to the last bit, and the outer ends are those of the piece.
    starts, ends = parts[:, 0].reshape(-1, count), parts[:, 3].reshape(-1, count)
    assert np.array_equal(starts[:, 0], pieces[:, 0])
    assert np.array_equal(ends[:, -1], pieces[:, 3])
    assert np.max(np.abs(starts[:, 1:] - ends[:, :-1]), initial=0.0) < 1e-13


def test_clamped_cubics_keep_their_knots() -> None:
    spline = slot().splines[0]
    assert np.array_equal(
        CubicSpline.from_bspline(3, spline.knots, spline.controls).knots, spline.knots
    )


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
    points = spline_points(contour, 4000)
    chords = np.roll(points, -1) - points
    area = 0.5 * float(np.sum((np.conj(points) * chords).imag))
    # Chords h of an arc of radius r lose h^2/(24 r^2) of its length and h^2/6r of area a length:
    # h < 5e-3 mm, r > 1 mm.
    assert contour.area == pytest.approx(area, rel=1e-6)
    assert contour.length == pytest.approx(float(np.sum(np.abs(chords))), rel=2e-6)


def test_area_of_a_parabola_is_exact() -> None:
    """y = 1 - x^2 over [-1, 1] as a spline of degree 2, and the line below it."""
    bow = CubicSpline.from_bspline(2, np.array([0.0, 0, 0, 1, 1, 1]), np.array([1.0, 2j, -1.0]))
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
        assert np.max(np.abs(points_of(strand) - points_of(other)[::-1])) < 1e-13
    assert back.counter_clockwise().area > 0.0
    assert contour.counter_clockwise() is contour
    assert np.max(np.abs(spline_points(contour))) <= contour.reach


def test_arcs_between_other_ends() -> None:
    arc = Arc(10.0 + 0j, 10j, 0.5 * math.pi, 0j)
    moved = arc.with_ends(10.0 + 1e-3j, 10j)
    assert moved.sweep == arc.sweep
    assert abs(moved.start - moved.centre) == pytest.approx(abs(moved.end - moved.centre))
    assert abs(arc.with_ends(arc.start, arc.end).centre) < 1e-14


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


several = settings(
    max_examples=examples(7, long=12), deadline=None, suppress_health_check=[HealthCheck.too_slow]
)


def both_ways(contour: SplineContour, tolerance: float) -> tuple[float, float]:
    """Largest distance found, both ways, and the bound."""
    fine = approximating_arcs(contour, tolerance)
    arcs, bound = fine.contour, fine.distance
    found = outline(arcs)
    cubics = sum(len(spline) for spline in contour.splines)
    there = float(np.max(found.distances(spline_points(contour, 4000 // cubics))))
    back = float(
        np.max(DensePath(spline_points(contour, 80_000 // cubics)).distances(found.dense(8000)))
    )
    return max(there, back), bound


@pytest.mark.parametrize("tolerance", [1e-1, 1e-3, 1e-5])
@pytest.mark.parametrize("contour", [blob(3, 0.2), blob(8, 0.1), slot()], ids=["3", "8", "slot"])
def test_bound_holds_and_is_sharp(contour: SplineContour, tolerance: float) -> None:
    found, bound = both_ways(contour, tolerance)
    # Chords of the dense points are 6e-3 mm long, and bend by 1/4 mm at most: sagitta 1e-6 mm.
    assert found <= bound + 1.2e-6
    assert bound <= tolerance * (1.0 + 1e-6)
    # The coefficients over quarters exceed the cubic error's peaks by a tenth at most.
    assert bound <= 1.12 * found + 1.2e-6


@several
@given(st.lists(st.floats(0.6, 1.4), min_size=6, max_size=12), st.sampled_from([0.2, 1e-3]))
def test_any_closed_spline(radii: list[float], tolerance: float) -> None:
    angles = np.linspace(0.0, 2.0 * np.pi, len(radii) + 1)
    points = 40.0 * np.array([*radii, radii[0]]) * np.exp(1j * angles)
    points[-1] = points[0]
    found = make_interp_spline(angles, points, k=3)
    contour = SplineContour((CubicSpline(found.t, found.c),))
    measured, bound = both_ways(contour, tolerance)
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
    contour, bound = fine.contour, fine.distance
    assert contour.sweeps.tolist() == [0.0, np.pi]
    assert bound < 1e-13


def test_a_spline_that_turns_back_is_refused() -> None:
    """Out and back on one line: no arc approximates it."""
    knots = np.array([0.0, 0, 0, 0, 1, 1, 1, 1])
    back = CubicSpline(knots, np.array([0.0, 9.0, 5.0, 0.0], dtype=complex))
    with pytest.raises(GeometryError, match="turns back"):
        approximating_arcs(SplineContour((back,)), 1e-3)


Fitter = Callable[[Path, float], SplineFit]


FITTERS: tuple[Fitter, ...] = (fit_spline, fewest_cubics)


some = settings(
    max_examples=examples(4, long=6),
    deadline=None,
    suppress_health_check=[HealthCheck.too_slow, HealthCheck.filter_too_much],
)


@pytest.mark.parametrize("fitter", FITTERS)
@pytest.mark.parametrize("tolerance", [1e-5, 1e-7])
def test_fine_tolerances_are_proved(tolerance: float, fitter: Fitter) -> None:
    """Finer than dense chords can show: perpendiculars at samples of the fit's own parameter."""
    curve = flank("plate_translating", -1)
    fit = fitter(whole(curve), tolerance)
    assert 0.5 * tolerance < fit.deviation <= tolerance
    places = spline_points(fit.contour, 30)[::3]
    angle = np.linspace(0.0, TURN, 100_001)
    near = DensePath(curve.point(angle[:-1])).distances(places)
    # h = 3.2e-3 mm, kappa < 0.1/mm: the chords' sagitta.
    assert float(np.max(near)) <= fit.deviation + 1.3e-7


@pytest.mark.parametrize("name", [("setzhub", -1), ("groove", 1)], ids=str)
def test_the_first_proof_holds(name: tuple[str, int], monkeypatch: pytest.MonkeyPatch) -> None:
    """A second one would aim lower, and the counts would grow where the tolerance is loosened."""
    path = whole(flank(*name))
    proofs: list[tuple[float, float]] = []

    def counted(*args: Any) -> float:
        bound = fitted_deviation(*args)
        proofs.append((args[-1], bound))
        return bound

    monkeypatch.setattr(cubics, "fitted_deviation", counted)
    before = 0
    tolerances = np.geomspace(1e-1, 1e-8, 22)
    for tolerance in tolerances:
        proofs.clear()
        fit = fewest_cubics(path, float(tolerance))
        assert len(proofs) == 1
        error, bound = proofs[0]
        # The search takes errors from the peaks of parabolas: at most a hundredth too large.
        assert error <= 1.01 * bound
        assert bound == fit.deviation
        assert len(fit.contour) >= before
        before = len(fit.contour)


@some
@given(curves(), st.sampled_from([1e-2, 1e-5]), st.sampled_from(FITTERS))
def test_proof_agrees_with_that_of_a_foreign_contour(
    curve: WorkingCurve, tolerance: float, fitter: Fitter
) -> None:
    """Other arcs, other places and other cells: each bound exceeds the distance by some 1 %."""
    fit = fitter(whole(curve), tolerance)
    again = spline_deviation(whole(curve), fit.contour)
    assert again == pytest.approx(fit.deviation, rel=0.04, abs=1e-12)


def test_nearly_flat_arcs_become_lines() -> None:
    """The circle of a nearly flat arc is so large that its rounding alone exceeds the tolerance."""
    tolerance = 1e-9
    fit = fewest_cubics(whole(flank("setzhub", -1)), 1e-7)
    fine = approximating_arcs(fit.contour, tolerance)
    arcs, bound = fine.contour, fine.distance
    assert np.any(arcs.sweeps == 0.0)
    assert np.max(arcs.radii) * 2.0**-52 <= tolerance / 64.0
    assert bound <= 1.1 * tolerance


@pytest.mark.parametrize("rotation", [1, -1])
@pytest.mark.parametrize("fitter", FITTERS)
def test_a_dwell_is_one_arc_about_the_axis(fitter: Fitter, rotation: int) -> None:
    curve = cam(dwell(250), move(60, 10.0), move(50, 0.0), rotation=rotation)
    arcs = fitter(whole(curve), 0.001).contour.arcs
    assert [arc.centre for arc in arcs] == [0j]
    assert math.degrees(arcs[0].sweep) == pytest.approx(250.0, rel=1e-15)
    assert len(smooth_pieces(curve)) == 3


def test_the_bound_finds_a_moved_control_point() -> None:
    """A point of a span follows a control point by 2/3 where that weighs most."""
    path = whole(flank("setzhub", -1))
    fit = fewest_cubics(path, 1e-4)
    strands = list(fit.contour.strands)
    place = next(k for k, strand in enumerate(strands) if isinstance(strand, CubicSpline))
    spline = strands[place]
    assert isinstance(spline, CubicSpline)
    for k in (2, len(spline.controls) // 2, len(spline.controls) - 3):
        controls = spline.controls.copy()
        along = controls[k + 1] - controls[k - 1]
        controls[k] += 1e-2j * along / abs(along)
        strands[place] = CubicSpline(spline.knots, controls)
        moved = SplineContour(tuple(strands))
        bound = spline_deviation(path, moved)
        assert 0.5e-2 < bound < 0.9e-2
        assert bound == pytest.approx(Dense.of(path).measured(moved), rel=0.03)


def test_a_contour_run_clockwise_and_begun_elsewhere_has_the_same_bound() -> None:
    path = whole(flank("plate_translating", -1))
    fit = fit_spline(path, 1e-3)
    strands = fit.contour.reversed().strands
    turned = SplineContour((*strands[2:], *strands[:2]))
    assert spline_deviation(path, turned) == pytest.approx(fit.deviation, rel=0.03)
