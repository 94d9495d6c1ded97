"""Fits of arcs and of straight pieces: within tolerance, tangent, with the fewest joints' law."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from camgeo.errors import GeometryError, ToleranceError, UndercutError
from camgeo.geometry.contour.arcs import fit_arcs
from camgeo.geometry.contour.chords import fit_polyline
from camgeo.geometry.contour.contour import Fit, require_simple
from camgeo.geometry.contour.least_pieces import forced_pieces
from camgeo.geometry.outline.path import Path, whole
from camgeo.geometry.pieces import smooth_pieces
from camgeo.geometry.pitch_curve import PitchCurve
from camgeo.geometry.working_curve import WorkingCurve
from camgeo.kinematics.mechanism.translating_roller import TranslatingRoller
from camgeo.kinematics.plan import MotionPlan
from camgeo.numeric.arrays import Side
from camgeo.part.boundaries import CurveBoundary
from tests.contour.cams import FLANKS, TURN, Dense, curves, dense_flank, dwell, flank, move, outline
from tests.contour.cams import translating as cam
from tests.contour.paths import break_count
from tests.contour.tangents import PLACE, check_shared_ends, check_tangent
from tests.long_form import examples
from tests.reference import hard_case

Fitter = Callable[[Path, float], Fit]

FITTERS: tuple[Fitter, ...] = (fit_arcs, fit_polyline)

SIDES: tuple[Side, ...] = ("right", "left")

SAGITTA = 2e-6
"""Chords of the dense curve by which is measured, see `Dense` [mm]."""

some = settings(
    max_examples=examples(5, long=15),
    deadline=None,
    suppress_health_check=[HealthCheck.too_slow, HealthCheck.filter_too_much],
)


def _check_fit(exact: Dense, fit: Fit, tolerance: float) -> None:
    assert fit.tolerance == tolerance
    assert fit.deviation <= tolerance
    assert fit.contour.area > 0.0
    found = exact.measured(fit.contour)
    assert found <= fit.deviation + SAGITTA
    # The proof's own slack is 1 %; dense sampling finds all but (1/100)^2 of a piece's bulge. To
    # this come the gaps at the feet: the distance times the sine of the angle between piece and
    # curve there, 0.03 where the coarsest arcs turn by a radian.
    assert fit.deviation <= 1.05 * found + 1e-9


@pytest.mark.parametrize("fitter", FITTERS)
@pytest.mark.parametrize("tolerance", [0.02, 0.001])
@pytest.mark.parametrize("name", FLANKS, ids=str)
def test_fixture_flanks(name: tuple[str, int], tolerance: float, fitter: Fitter) -> None:
    _check_fit(dense_flank(name), fitter(whole(flank(*name)), tolerance), tolerance)


@some
@given(curves(), st.sampled_from([0.03, 0.002]), st.sampled_from(FITTERS))
def test_any_cam(curve: WorkingCurve, tolerance: float, fitter: Fitter) -> None:
    _check_fit(Dense.of(curve), fitter(whole(curve), tolerance), tolerance)


@pytest.mark.parametrize("tolerance", [0.01, 1e-5])
@pytest.mark.parametrize("name", FLANKS, ids=str)
def test_arcs_are_tangent_and_meet(name: tuple[str, int], tolerance: float) -> None:
    contour = fit_arcs(whole(flank(*name)), tolerance).contour
    check_tangent(contour, np.empty(0, dtype=np.complex128))
    check_shared_ends(contour)


@some
@given(curves(), st.sampled_from([0.03, 1e-4]))
def test_arcs_of_any_cam_are_tangent_and_meet(curve: WorkingCurve, tolerance: float) -> None:
    contour = fit_arcs(whole(curve), tolerance).contour
    check_tangent(contour, np.empty(0, dtype=np.complex128))
    check_shared_ends(contour)


@some
@given(curves())
def test_breaks_are_joints_and_a_dwell_is_one_arc_about_the_axis(curve: WorkingCurve) -> None:
    for fitter in FITTERS:
        vertices = fitter(whole(curve), 0.01).contour.vertices
        for place in curve.point(curve.breaks):
            assert np.min(np.abs(vertices - place)) <= PLACE
    contour = fit_arcs(whole(curve), 0.01).contour
    about_axis = (contour.sweeps != 0.0) & (contour.centres == 0.0)
    rests = [piece for piece in smooth_pieces(curve) if piece.dwell]
    assert np.count_nonzero(about_axis) == len(rests)
    found = sorted(contour.sweeps[about_axis].tolist())
    spans = sorted(piece.end - piece.start for piece in rests)
    assert found == pytest.approx(spans, rel=1e-15)
    for piece in rests:
        radius = abs(curve.point(np.array([piece.start]))[0])
        assert np.min(np.abs(contour.radii[about_axis] - radius)) <= PLACE


@pytest.mark.parametrize("rotation", [1, -1])
@pytest.mark.parametrize(
    ("plan", "spans"),
    [
        ((dwell(30), move(100, 20.0), dwell(40), move(120, 0.0), dwell(70)), [100.0, 40.0]),
        ((dwell(250), move(60, 10.0), move(50, 0.0)), [250.0]),
        ((move(60, 10.0), dwell(200), move(50, 0.0), dwell(50)), [200.0, 50.0]),
        ((dwell(360),), [360.0]),
        ((dwell(100), dwell(0), dwell(260)), [360.0]),
    ],
)
def test_dwells_across_the_start_and_beyond_half_a_turn(
    plan: tuple[Any, ...], spans: list[float], rotation: int
) -> None:
    contour = fit_arcs(whole(cam(*plan, rotation=rotation)), 0.001).contour
    about_axis = (contour.sweeps != 0.0) & (contour.centres == 0.0)
    found = sorted(np.degrees(contour.sweeps[about_axis]).tolist())
    assert found == pytest.approx(sorted(spans), rel=1e-15)


def test_cam_that_rests_all_turn_is_a_circle() -> None:
    fit = fit_arcs(whole(cam(dwell(360))), 1e-9)
    assert len(fit.contour) == 1
    assert fit.contour.area == pytest.approx(np.pi * 32.0**2, rel=1e-15)
    assert fit.deviation < 1e-11


@pytest.mark.parametrize("fitter", FITTERS)
def test_curve_torn_apart_by_a_shock_is_refused(fitter: Fitter) -> None:
    curve = cam(dwell(40), move(140, 15.0, "straight-line"), dwell(60), move(120, 0.0))
    gap = np.abs(np.subtract(*(curve.point(np.radians([40.0]), side) for side in SIDES)))
    assert gap[0] > 1.0
    with pytest.raises(GeometryError, match="torn apart at cam angle 40 degrees"):
        fitter(whole(curve), 0.001)


@pytest.mark.parametrize(("fitter", "power"), [(fit_arcs, 3.0), (fit_polyline, 2.0)])
@pytest.mark.parametrize("name", [("setzhub", -1), ("plate_translating", -1)], ids=str)
def test_counts_follow_their_law(name: tuple[str, int], fitter: Fitter, power: float) -> None:
    """Pieces ~ tolerance^(-1/3) for G1 arcs, ^(-1/2) for chords."""
    path = whole(flank(*name))
    pieces = break_count(path) - forced_pieces(path)
    # The ends of a smooth piece cost the same at every tolerance: for arcs 1.3 pairs, as their
    # tangents there are given.
    ends = forced_pieces(path) + 2.6 * pieces if fitter is fit_arcs else 0.0
    tolerances = (1e-3, 1e-4, 1e-5, 1e-6)
    counts = [len(fitter(path, tolerance).contour) - ends for tolerance in tolerances]
    slope = -math.log(counts[-1] / counts[0]) / math.log(tolerances[-1] / tolerances[0])
    # Each smooth piece has whole pairs of arcs: 2 more than needed at most. Besides, a change of
    # sign of the slope of curvature costs some arcs, always as many, which are 10 % of the coarse
    # count at most.
    margin = math.log((1.0 + 2.0 * pieces / counts[0]) * 1.1) / math.log(1e3)
    assert slope == pytest.approx(1.0 / power, abs=margin)
    assert margin < 0.1


@pytest.mark.parametrize("fitter", FITTERS)
def test_tolerance_beyond_arithmetic_is_refused(fitter: Fitter) -> None:
    with pytest.raises(ToleranceError, match="tolerance 1e-14 mm requested") as caught:
        fitter(whole(flank("querhub", -1)), 1e-14)
    assert caught.value.reached > caught.value.asked == 1e-14


@pytest.mark.parametrize("fitter", FITTERS)
def test_undercut_is_refused(fitter: Fitter) -> None:
    # A lobe of 20 mm in 80 degrees: sharper at its tip than a roller of 20 mm.
    curve = cam(move(40, 20.0), move(40, 0.0), dwell(280), roller=20.0)
    assert np.min(curve.regularity(np.linspace(0.0, TURN, 3601))) < 0.0
    with pytest.raises(UndercutError, match="cusp or undercut between cam angles"):
        fitter(whole(curve), 0.001)


@pytest.mark.parametrize("case", ["HC22", "HC22b"])
def test_global_undercut_is_refused(case: str) -> None:
    """Regular everywhere, yet two flanks cut each other off."""
    parameters, expected = hard_case(case)
    spans = parameters["phi_H"]
    stroke = float(parameters["s_H"])
    plan = MotionPlan(
        (dwell(spans[0]), move(spans[1], stroke), dwell(spans[2]), move(spans[3], 0.0),
         dwell(spans[4]))
    )  # fmt: skip
    roller = float(parameters["r_R"])
    curve = WorkingCurve(PitchCurve(plan, TranslatingRoller(parameters["r_G"], roller), 1), -roller)
    assert np.min(curve.regularity(np.linspace(0.0, TURN, 36_001))) > 0.0
    fit = fit_arcs(whole(curve), 0.001)
    with pytest.raises(UndercutError, match=r"outline crosses itself .*global undercut"):
        require_simple(fit.contour, "outline")
    for refused in (
        CurveBoundary("outline", False, whole(curve)).arcs,
        CurveBoundary("outline", False, whole(curve)).polyline,
    ):
        with pytest.raises(UndercutError, match="global undercut"):
            refused(0.01)
    # The crossing that is named lies where the reference has one of its two.
    with pytest.raises(UndercutError) as caught:
        require_simple(fit.contour, "outline")
    place = caught.value.message.split("[")[1].split("]")[0].split()
    radius = abs(complex(float(place[0]), float(place[1])))
    radii = [float(value) for value in expected["radial_position_mm"]]
    # Chords of the test for simplicity lie 1e-5 of the outline's length off.
    assert min(abs(radius - value) for value in radii) < 0.05


def test_outlines_of_the_fixtures_are_simple() -> None:
    for name in FLANKS:
        require_simple(fit_arcs(whole(flank(*name)), 0.01).contour, "outline")
    assert len(outline(fit_arcs(whole(flank("setzhub", -1)), 0.01).contour).starts) < 60
