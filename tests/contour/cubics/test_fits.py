"""Fits of cubic splines: within tolerance, C2 and tangent, near the fewest possible cubics."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from camgeo.errors import GeometryError, ToleranceError, UndercutError
from camgeo.geometry.contour import cubics
from camgeo.geometry.contour.cubic_proof import (
    approximating_arcs,
    fitted_deviation,
    parts_of,
    spline_deviation,
)
from camgeo.geometry.contour.cubics import fewest_cubics, fit_spline
from camgeo.geometry.contour.least_pieces import forced_pieces, least_cubics
from camgeo.geometry.contour.legs import legs_of
from camgeo.geometry.contour.spline import Arc, CubicSpline, SplineContour, SplineFit
from camgeo.geometry.outline.path import Path, whole
from camgeo.geometry.pieces import smooth_pieces
from camgeo.geometry.working_curve import WorkingCurve
from tests.contour.cams import FLANKS, TURN, curves, dwell, flank, move
from tests.contour.cams import translating as cam
from tests.contour.paths import PATHS, SAGITTA, break_count, dense_path
from tests.contour.splines import curve_of, dense, tangents
from tests.long_form import examples
from tests.measuring import DensePath

Fitter = Callable[[Path, float], SplineFit]

FITTERS: tuple[Fitter, ...] = (fit_spline, fewest_cubics)

TIGHT = (1e-4, 1e-5, 1e-6, 1e-7)

some = settings(
    max_examples=examples(4, long=6),
    deadline=None,
    suppress_health_check=[HealthCheck.too_slow, HealthCheck.filter_too_much],
)


@cache
def fitted(fitter: Fitter, name: tuple[str, int], tolerance: float) -> SplineFit:
    """The fit of a fixture flank, made once for all tests that use it."""
    return fitter(whole(flank(*name)), tolerance)


def _measured(path: Path, contour: SplineContour) -> float:
    """Largest distance found by dense sampling in both directions."""
    exact, found = dense_path(path, 40_000), dense(contour, 2000 if len(contour) < 40 else 500)
    there = DensePath(found).distances(exact[::7])
    back = DensePath(exact).distances(found[::11])
    return max(float(np.max(there)), float(np.max(back)))


def _check_fit(path: Path, fit: SplineFit, tolerance: float) -> None:
    assert fit.tolerance == tolerance
    assert fit.deviation <= tolerance
    assert fit.contour.area > 0.0
    found = _measured(path, fit.contour)
    assert found <= fit.deviation + SAGITTA
    # 1 % for the cells of the proof, 1.5 % for its arcs, and once more these, as they may lie
    # farther off than the spline where it is farthest; 1 % for what lies between dense points.
    assert fit.deviation <= 1.05 * found + SAGITTA


def _check_smooth(contour: SplineContour, corners: int) -> None:
    """C2 inside by simple knots; tangent at all joints except for the corners."""
    turns = []
    for strand, after in zip(
        contour.strands, (*contour.strands[1:], contour.strands[0]), strict=True
    ):
        assert strand.end == after.start
        turns.append(abs(np.angle(tangents(after)[0] / tangents(strand)[1])))
        if isinstance(strand, CubicSpline):
            inner = strand.knots[4:-4]
            assert np.all(np.diff(strand.knots[3:-3]) > 0.0)
            assert np.all(strand.knots[:4] == 0.0)
            assert np.all(strand.knots[-4:] == strand.knots[-1])
            bend = curve_of(strand).derivative(2)
            nearby = 1e-9 * strand.knots[-1]
            jump = np.abs(bend(inner + nearby) - bend(inner - nearby))
            # The third derivative, constant in each span, times the way across the knot.
            middles = 0.5 * (strand.knots[3:-4] + strand.knots[4:-3])
            steepest = np.max(np.abs(curve_of(strand).derivative(3)(middles)))
            assert np.all(jump <= 2.0 * nearby * steepest + 1e-12)
    # A leg of a spline is 1e-3 mm long at least, its ends rounded to 1e-13 mm.
    assert sum(turn > 1e-9 for turn in turns) <= corners


@pytest.mark.parametrize(("fitter", "tolerance"), [(fit_spline, 0.02), (fewest_cubics, 0.001)])
@pytest.mark.parametrize("name", FLANKS, ids=str)
def test_fixture_flanks(name: tuple[str, int], tolerance: float, fitter: Fitter) -> None:
    path = whole(flank(*name))
    fit = fitted(fitter, name, tolerance)
    _check_fit(path, fit, tolerance)
    _check_smooth(fit.contour, 0)


@some
@given(curves(), st.sampled_from([0.03, 0.002]), st.sampled_from(FITTERS))
def test_any_cam(curve: WorkingCurve, tolerance: float, fitter: Fitter) -> None:
    fit = fitter(whole(curve), tolerance)
    _check_fit(whole(curve), fit, tolerance)
    _check_smooth(fit.contour, 0)


@pytest.mark.parametrize("name", PATHS)
def test_corners_turns_and_cusps(name: str) -> None:
    path = PATHS[name]()
    fit = fewest_cubics(path, 1e-3)
    _check_fit(path, fit, 1e-3)
    _check_smooth(fit.contour, len(path.pivots))


@pytest.mark.parametrize("fitter", FITTERS)
@pytest.mark.parametrize("tolerance", [1e-5, 1e-7])
def test_fine_tolerances_are_proved(tolerance: float, fitter: Fitter) -> None:
    """Finer than dense chords can show: perpendiculars at samples of the fit's own parameter."""
    curve = flank("plate_translating", -1)
    fit = fitter(whole(curve), tolerance)
    assert 0.5 * tolerance < fit.deviation <= tolerance
    places = dense(fit.contour, 30)[::3]
    angle = np.linspace(0.0, TURN, 100_001)
    near = DensePath(curve.point(angle[:-1])).distances(places)
    # h = 3.2e-3 mm, kappa < 0.1/mm: the chords' sagitta.
    assert float(np.max(near)) <= fit.deviation + 1.3e-7


@pytest.mark.parametrize("name", FLANKS, ids=str)
def test_counts_are_near_the_limit_and_never_grow(name: tuple[str, int]) -> None:
    path = whole(flank(*name))
    forced, breaks = forced_pieces(path), break_count(path)
    before = 0
    for tolerance in (1e-1, 1e-2, 1e-3, 1e-4, 1e-6):
        few = len(fitted(fewest_cubics, name, tolerance).contour) - forced
        quick = len(fitted(fit_spline, name, tolerance).contour) - forced
        limit = least_cubics(path, tolerance)
        assert few <= 1.10 * limit + 3 * breaks
        assert quick <= 1.50 * limit + 3 * breaks
        assert few >= before
        before = few


@some
@given(curves())
def test_counts_of_any_cam_are_near_the_limit(curve: WorkingCurve) -> None:
    path = whole(curve)
    forced, breaks = forced_pieces(path), break_count(path)
    before = 0
    for tolerance in (1e-2, 1e-4, 1e-6):
        few = len(fewest_cubics(path, tolerance).contour) - forced
        assert few <= 1.10 * least_cubics(path, tolerance) + 3 * breaks
        assert few >= before
        before = few


@pytest.mark.parametrize("name", FLANKS, ids=str)
def test_slope_is_a_quarter(name: tuple[str, int]) -> None:
    """Of the counts less the arcs of dwells, and one cubic for the two ends of each piece.

    A span at an end, where point and tangent are given, has twice the error of one inside, and so
    is 2^(-1/4) as long: 0.3 of a cubic a piece; to make the number whole takes 0.5 on the average.
    """
    path = whole(flank(*name))
    ends = break_count(path) - forced_pieces(path)
    counts = [
        len(fewest_cubics(path, tolerance).contour) - forced_pieces(path) - ends
        for tolerance in (TIGHT[0], TIGHT[-1])
    ]
    slope = math.log(counts[1] / counts[0]) / math.log(TIGHT[0] / TIGHT[-1])
    assert slope == pytest.approx(0.25, abs=0.02)


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
    arcs, bound = fine.contour, fine.apart
    assert np.any(arcs.sweeps == 0.0)
    assert np.max(arcs.radii) * 2.0**-52 <= tolerance / 64.0
    assert bound <= 1.1 * tolerance


def test_points_between_cells_are_those_of_the_curve() -> None:
    """Hermite's cubics are off by h^4/384 of the fourth derivative over the arc length, and their
    slopes by the largest slope of t^2 (1 - t)^2/24, 1/124, of h^3 times it.

    A tenth more, as the difficulty is that of means over cells.
    """
    curve = flank("plate_translating", -1)
    pieces = [piece for piece in smooth_pieces(curve) if not piece.dwell]
    legs = legs_of(whole(curve))
    courses = [part.course for part in parts_of(legs, 1e-3)]
    course = next(each for each in courses if each is not None)
    for number, piece in enumerate(pieces):
        ends = course.s[number]
        s = (ends[:-1, None] + np.diff(ends)[:, None] * np.array([0.25, 0.5, 0.75])).ravel()
        which = np.full(len(s), number)
        at, along = course.near(which, s)
        angles = course.angles(which, s)
        assert piece.start < angles[0] < angles[-1] < piece.end
        points, tangents, _ = curve.traced(angles)
        step, fourth = np.max(np.diff(ends)), np.max(course.density[number]) ** 4
        off, turned = np.conj(tangents) * (at - points), np.conj(tangents) * along
        # Points are rounded to some 1e-14 mm, the cell is a tenth of a mm.
        assert np.max(np.abs(off.imag)) <= 1.1 * step**4 / 384.0 * fourth + 1e-13
        assert np.max(np.abs(turned.imag)) <= 1.1 * step**3 / 124.0 * fourth + 1e-12


@pytest.mark.parametrize("rotation", [1, -1])
@pytest.mark.parametrize("fitter", FITTERS)
def test_a_dwell_is_one_arc_about_the_axis(fitter: Fitter, rotation: int) -> None:
    curve = cam(dwell(250), move(60, 10.0), move(50, 0.0), rotation=rotation)
    arcs = fitter(whole(curve), 0.001).contour.arcs
    assert [arc.centre for arc in arcs] == [0j]
    assert math.degrees(arcs[0].sweep) == pytest.approx(250.0, rel=1e-15)
    assert len(smooth_pieces(curve)) == 3


def test_cam_that_rests_all_turn_is_a_circle() -> None:
    fit = fewest_cubics(whole(cam(dwell(360))), 1e-9)
    assert [type(strand) for strand in fit.contour.strands] == [Arc]
    assert fit.contour.area == pytest.approx(np.pi * 32.0**2, rel=1e-15)
    assert fit.deviation < 1e-11


@pytest.mark.parametrize("fitter", FITTERS)
def test_the_same_numbers_each_time(fitter: Fitter) -> None:
    path = whole(flank("setzhub", -1))
    fitter(whole(flank("ring", 1)), 1e-4)
    first, second = (fitter(path, 1e-4).contour.splines for _ in range(2))
    for one, other in zip(first, second, strict=True):
        assert np.array_equal(one.controls, other.controls)
        assert np.array_equal(one.knots, other.knots)


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
        assert bound == pytest.approx(_measured(path, moved), rel=0.03)


def test_a_contour_run_clockwise_and_begun_elsewhere_has_the_same_bound() -> None:
    path = whole(flank("plate_translating", -1))
    fit = fit_spline(path, 1e-3)
    strands = fit.contour.reversed().strands
    turned = SplineContour((*strands[2:], *strands[:2]))
    assert spline_deviation(path, turned) == pytest.approx(fit.deviation, rel=0.03)


@pytest.mark.parametrize("fitter", FITTERS)
def test_tolerance_beyond_arithmetic_is_refused(fitter: Fitter) -> None:
    with pytest.raises(ToleranceError, match="tolerance 1e-14 mm requested") as caught:
        fitter(whole(flank("setzhub", -1)), 1e-14)
    assert caught.value.reached > caught.value.asked == 1e-14


@pytest.mark.parametrize("fitter", FITTERS)
def test_undercut_is_refused(fitter: Fitter) -> None:
    # A lobe of 20 mm in 80 degrees: sharper at its tip than a roller of 20 mm.
    curve = cam(move(40, 20.0), move(40, 0.0), dwell(280), roller=20.0)
    with pytest.raises(UndercutError, match="cusp or undercut between cam angles"):
        fitter(whole(curve), 0.001)


@pytest.mark.parametrize("fitter", FITTERS)
def test_curve_torn_apart_by_a_shock_is_refused(fitter: Fitter) -> None:
    curve = cam(dwell(40), move(140, 15.0, "straight-line"), dwell(60), move(120, 0.0))
    with pytest.raises(GeometryError, match="torn apart at cam angle 40 degrees"):
        fitter(whole(curve), 0.001)
