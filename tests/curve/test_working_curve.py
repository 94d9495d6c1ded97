from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from camgeo.geometry.pitch_curve import PitchCurve
from camgeo.geometry.working_curve import WorkingCurve
from camgeo.numeric.arrays import ComplexArray, FloatArray, Side
from camgeo.units import TURN
from tests.integrals import cells, integrals
from tests.reference import angles, hard_case, inner_of, mechanisms, outer_of, pitch_curve_of
from tests.strategies import SMOOTH, attack, pitch_curves

PHI = np.linspace(0.0, TURN, 145)

SIDES: tuple[Side, ...] = ("right", "left")

by_name = pytest.mark.parametrize("name", mechanisms())
"""Cams without undercut, all of them, on either flank."""


def area(points: ComplexArray) -> float:
    return abs(0.5 * float(np.sum(np.imag(np.conj(points) * np.roll(points, -1)))))


@attack
@given(curve=pitch_curves(), distance=st.floats(-12.0, 12.0))
def test_an_offset_lies_square_to_the_pitch_curve(curve: PitchCurve, distance: float) -> None:
    z, z1 = curve.jet(PHI)[:2]
    normal = (WorkingCurve(curve, distance).point(PHI) - z) * np.conj(z1) / np.abs(z1)
    limit = 1e-14 * np.max(np.abs(z)) * np.max(np.abs(z1)) / np.min(np.abs(z1))
    # Run through clockwise for sigma = +1, a curve has its outside on the left.
    assert np.max(np.abs(normal - 1j * curve.rotation * distance)) <= limit


@by_name
def test_the_roller_touches_the_working_curve(name: str) -> None:
    """The circle of the roller at phi and the flank near its point: to first order they touch, to
    second order they part by |Z'|^2 (1 + d kappa) delta^2 / (2 r_R), outside the roller."""
    curve = pitch_curve_of(mechanisms()[name]["params"])
    roller = curve.follower.roller_radius
    delta = 1e-5
    for flank in (inner_of(curve), outer_of(curve)):
        phi = PHI[np.min(np.abs(PHI[:, np.newaxis] - curve.breaks), axis=1) > 1e-3][1:-1]
        point, speed = flank.point(phi), np.abs(curve.jet(phi)[1])
        for step in (-delta, delta):
            parted = np.abs(point - curve.point(phi + step)) - roller
            expected = (speed * step) ** 2 * flank.regularity(phi) / (2.0 * roller)
            assert np.all(parted > 0.0)
            # The next order is a share delta of this, times |Z''|/|Z'| by 1 + d kappa, below 500.
            # Lengths of 60 mm round to 1e-14, 1e-5 of what is measured.
            assert np.max(np.abs(parted / expected - 1.0)) <= 500.0 * delta


@by_name
def test_no_point_of_a_flank_lies_inside_the_roller_anywhere(name: str) -> None:
    """These cams have no undercut, neither local nor global."""
    curve = pitch_curve_of(mechanisms()[name]["params"])
    centres = curve.point(np.linspace(0.0, TURN, 2000))
    roller = curve.follower.roller_radius
    for flank in (inner_of(curve), outer_of(curve)):
        distances = np.abs(flank.point(PHI)[:, np.newaxis] - centres)
        assert np.min(distances) >= roller * (1.0 - 1e-13)


@by_name
def test_outer_encloses_pitch_encloses_inner(name: str) -> None:
    """With no undercut the areas are those of parallels of a simple closed curve (Steiner):
    A +- r L + pi r^2."""
    curve = pitch_curve_of(mechanisms()[name]["params"])
    roller = curve.follower.roller_radius
    low, high = cells(curve.borders, 12)

    def sector(points: WorkingCurve) -> float:
        """Area by Green's theorem along the exact curve."""
        rate = integrals(
            lambda phi: (
                0.5 * np.imag(np.conj(points.point(phi)) * points.tangent(phi)) * points.pace(phi)
            ),
            low,
            high,
        )
        return -curve.rotation * float(np.sum(rate))

    length = float(np.sum(integrals(lambda phi: np.abs(curve.jet(phi)[1]), low, high)))
    pitch = sector(WorkingCurve(curve, 0.0))
    inner, outer = sector(inner_of(curve)), sector(outer_of(curve))
    assert outer > pitch > inner > 0.0
    assert outer == pytest.approx(pitch + roller * length + math.pi * roller**2, rel=1e-11)
    assert inner == pytest.approx(pitch - roller * length + math.pi * roller**2, rel=1e-11)
    # And the polygon of its points says the same, to the sagitta of 2.5 degrees.
    assert area(inner_of(curve).point(PHI[:-1])) == pytest.approx(inner, rel=2e-3)


@attack
@given(curve=pitch_curves(SMOOTH), distance=st.floats(-8.0, 8.0))
def test_points_run_along_the_tangent_at_the_pace(curve: PitchCurve, distance: float) -> None:
    offset = WorkingCurve(curve, distance)
    low, high = cells(curve.borders, 12)
    speed = np.abs(curve.jet(PHI)[1])
    assume(np.min(speed) > 0.2 * np.max(speed))  # else 24 points do not follow it
    found = integrals(lambda phi: offset.tangent(phi) * offset.pace(phi), low, high)
    change = offset.point(high, "left") - offset.point(low, "right")
    assert np.max(np.abs(found - change)) <= 1e-9 * np.max(np.abs(offset.point(PHI)))
    assert np.abs(offset.tangent(PHI)) == pytest.approx(np.ones(len(PHI)), rel=1e-14)


@attack
@given(curve=pitch_curves(SMOOTH), distance=st.floats(-8.0, 8.0))
def test_an_offset_turns_as_the_pitch_curve_does(curve: PitchCurve, distance: float) -> None:
    """kappa_d ds_d = kappa ds, and r_K of the offset is r_K + d."""
    offset = WorkingCurve(curve, distance)
    regular = offset.regularity(PHI)
    assume(np.min(np.abs(regular)) > 1e-3)
    kappa, speed = curve.curvature(PHI), np.abs(curve.jet(PHI)[1])
    assert regular == pytest.approx(1.0 + distance * kappa, rel=1e-15)
    turning = offset.curvature(PHI) * offset.pace(PHI)
    assert turning == pytest.approx(kappa * speed, rel=1e-13)
    curved = np.abs(kappa) > 1e-4
    radius = 1.0 / offset.curvature(PHI)[curved]
    # A radius of at most 1e4 mm, and d added to it.
    assert radius == pytest.approx(1.0 / kappa[curved] + distance, rel=1e-13, abs=2e-12)


@attack
@given(curve=pitch_curves(SMOOTH), distance=st.floats(-8.0, 8.0))
def test_curvature_changes_by_the_integral_of_its_slope(curve: PitchCurve, distance: float) -> None:
    offset = WorkingCurve(curve, distance)
    assume(np.min(offset.regularity(PHI)) > 0.1)
    speed = np.abs(curve.jet(PHI)[1])
    assume(np.min(speed) > 0.2 * np.max(speed))  # else 24 points do not follow it
    low, high = cells(curve.borders, 12)

    def rate(phi: FloatArray) -> FloatArray:
        # By the chain rule, kappa_d = kappa / (1 + d kappa).
        return np.asarray(curve.curvature_slope(phi) / offset.regularity(phi) ** 2)

    change = offset.curvature(high, "left") - offset.curvature(low, "right")
    scale = np.max(np.abs(offset.curvature(PHI)))
    assert np.max(np.abs(integrals(rate, low, high) - change)) <= 1e-8 * scale


def test_distance_zero_is_the_pitch_curve_itself() -> None:
    curve = pitch_curve_of(mechanisms()["osc_F_sp"]["params"])
    assert np.array_equal(WorkingCurve(curve, 0.0).point(PHI), curve.point(PHI))


@pytest.mark.parametrize("side", ["cusp1", "cusp2"])
@pytest.mark.parametrize("name", ["HC21b", "HC21c"])
def test_cusps_of_an_undercut_flank(name: str, side: str) -> None:
    params, expected = hard_case(name)
    flank = inner_of(pitch_curve_of(params))
    phi = angles(expected[f"{side}_phi_deg"])
    point = complex(*(float(part) for part in expected[side]))
    # The angle is given to 30 digits; 1e-16 of it moves nothing where the flank has a cusp.
    assert flank.point(phi)[0] == pytest.approx(point, rel=1e-13)
    assert flank.regularity(phi)[0] == pytest.approx(0.0, abs=1e-12)


def test_hc12_a_flank_a_kilometre_out() -> None:
    params, expected = hard_case("HC12")
    curve = pitch_curve_of(params)
    # The case states the radius of a flank with roller 10: of the pitch curve less 10 mm.
    radius = abs(WorkingCurve(curve, -10.0).point(angles(params["phi_deg"]))[0])
    assert radius == pytest.approx(float(expected["inner_radius"]), rel=1e-15)


@by_name
def test_traced_is_point_tangent_and_pace(name: str) -> None:
    curve = pitch_curve_of(mechanisms()[name]["params"])
    for flank in (inner_of(curve), WorkingCurve(curve, 0.0), outer_of(curve)):
        for side in SIDES:
            points, tangents, pace = flank.traced(PHI, side)
            # The same sums in another order: some ulps of 100 mm, and of 1.
            assert np.max(np.abs(points - flank.point(PHI, side))) <= 1e-12
            assert np.max(np.abs(tangents - flank.tangent(PHI, side))) <= 1e-14
            assert np.array_equal(pace, flank.pace(PHI, side))
