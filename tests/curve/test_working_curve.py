"""Parallels of the pitch curve: where they lie, how they run, and how they turn."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from camgeo.geometry.pitch_curve import PitchCurve, WorkingCurve
from camgeo.numeric.arrays import SIDES, FloatArray
from camgeo.units import TURN
from tests.integrals import cells, integrals
from tests.reference import inner_of, mechanisms, outer_of, pitch_curve_of
from tests.strategies import SMOOTH, attack, pitch_curves

PHI = np.linspace(0.0, TURN, 145)


by_name = pytest.mark.parametrize("name", mechanisms())
"""Cams without undercut, all of them, on either flank."""


@attack
@given(curve=pitch_curves(), distance=st.floats(-12.0, 12.0))
def test_an_offset_lies_square_to_the_pitch_curve(curve: PitchCurve, distance: float) -> None:
    z, z1 = curve.jet(PHI)[:2]
    normal = (WorkingCurve(curve, distance).point(PHI) - z) * np.conj(z1) / np.abs(z1)
    limit = 1e-14 * np.max(np.abs(z)) * np.max(np.abs(z1)) / np.min(np.abs(z1))
    # Run through clockwise for sigma = +1, a curve has its outside on the left.
    assert np.max(np.abs(normal - 1j * curve.rotation * distance)) <= limit


@by_name
def test_outer_encloses_pitch_encloses_inner(name: str) -> None:
    """With no undercut the areas are those of parallels of a simple closed curve (Steiner):
    A +- r L + pi r^2."""
    curve = pitch_curve_of(mechanisms()[name]["params"])
    roller = curve.follower.roller_radius
    low, high = cells(curve.borders, 12)

    def sector(points: WorkingCurve) -> float:
        """Area by Green's theorem along the exact curve."""

        def rate(phi: FloatArray) -> FloatArray:
            point, tangent, pace = points.traced(phi)
            return 0.5 * np.imag(np.conj(point) * tangent) * pace

        return -curve.rotation * float(np.sum(integrals(rate, low, high)))

    length = float(np.sum(integrals(lambda phi: np.abs(curve.jet(phi)[1]), low, high)))
    pitch = sector(WorkingCurve(curve, 0.0))
    inner, outer = sector(inner_of(curve)), sector(outer_of(curve))
    assert outer > pitch > inner > 0.0
    assert outer == pytest.approx(pitch + roller * length + math.pi * roller**2, rel=1e-11)
    assert inner == pytest.approx(pitch - roller * length + math.pi * roller**2, rel=1e-11)


@attack
@given(curve=pitch_curves(SMOOTH), distance=st.floats(-8.0, 8.0))
def test_points_run_along_the_tangent_at_the_pace(curve: PitchCurve, distance: float) -> None:
    offset = WorkingCurve(curve, distance)
    low, high = cells(curve.borders, 12)
    speed = np.abs(curve.jet(PHI)[1])
    assume(np.min(speed) > 0.2 * np.max(speed))  # else 24 points do not follow it
    found = integrals(lambda phi: offset.tangent(phi) * offset.traced(phi)[2], low, high)
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
    turning = offset.curvature(PHI) * offset.traced(PHI)[2]
    assert turning == pytest.approx(kappa * speed, rel=1e-13)
    curved = np.abs(kappa) > 1e-4
    radius = 1.0 / offset.curvature(PHI)[curved]
    # A radius of at most 1e4 mm, and d added to it.
    assert radius == pytest.approx(1.0 / kappa[curved] + distance, rel=1e-13, abs=2e-12)


@by_name
def test_traced_is_point_tangent_and_pace(name: str) -> None:
    curve = pitch_curve_of(mechanisms()[name]["params"])
    for flank in (inner_of(curve), WorkingCurve(curve, 0.0), outer_of(curve)):
        for side in SIDES:
            points, tangents, pace = flank.traced(PHI, side)
            # The same sums in another order: some ulps of 100 mm, and of 1.
            assert np.max(np.abs(points - flank.point(PHI, side))) <= 1e-12
            assert np.max(np.abs(tangents - flank.tangent(PHI, side))) <= 1e-14
            assert pace == pytest.approx(
                np.abs(curve.jet(PHI, side)[1]) * flank.regularity(PHI, side), rel=1e-13, abs=1e-12
            )
