"""Leverage: the work of a normal force is that of the follower, and its torque that of the cam."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import assume, given

from camgeo.errors import GeometryError
from camgeo.geometry.pitch_curve import PitchCurve
from camgeo.kinematics.mechanism.oscillating_roller import OscillatingRoller
from camgeo.kinematics.mechanism.translating_roller import TranslatingRoller
from camgeo.numeric.arrays import ComplexArray, FloatArray
from camgeo.units import TURN
from tests.integrals import cells
from tests.reference import hard_case, mechanisms, pitch_curve_of
from tests.strategies import BENT, attack, pitch_curves

EPS = float(np.finfo(np.float64).eps)

STEP = 1e-4
"""Step of the lift [mm or rad], for central differences."""


def turned(curve: PitchCurve, phi: FloatArray, along: ComplexArray) -> ComplexArray:
    """`along` (n,) of the cam, in the fixed frame."""
    there: ComplexArray = along * np.exp(1j * curve.rotation * phi)
    return there


def outward(curve: PitchCurve, phi: FloatArray) -> ComplexArray:
    """(n,) outward normals of the pitch curve in the fixed frame.

    For a cam that turns counter-clockwise the curve is run through clockwise: outside is to the
    left of its tangent.
    """
    tangent = curve.jet(phi)[1]
    return turned(curve, phi, 1j * curve.rotation * tangent / np.abs(tangent))


def centres(curve: PitchCurve, lift: FloatArray) -> ComplexArray:
    """(n,) roller centres in the fixed frame, the cam axis the origin."""
    jet = np.zeros((2, len(lift)))
    jet[0] = lift
    relative = curve.follower.relative_jet(jet, curve.rotation, 1)
    centre: ComplexArray = relative.along[0] + 1j * relative.across[0]
    centre *= np.exp(1j * relative.axis)
    return centre


def angles(curve: PitchCurve) -> FloatArray:
    """Some in each piece, rests among them, away from standstills of the roller in the cam."""
    phi, _ = cells(curve.borders, 7)
    phi = np.mod(phi + 1e-3, TURN)
    moving: FloatArray = phi[np.abs(curve.jet(phi)[1]) > 0.1]
    return moving


@attack
@given(curve=pitch_curves(BENT))
def test_it_is_the_way_along_the_normal_for_a_small_lift(curve: PitchCurve) -> None:
    """The cam stands, the follower is moved by hand."""
    phi = angles(curve)
    assume(len(phi))
    lift = curve.motion.jet(phi)[0]
    way = (centres(curve, lift + STEP) - centres(curve, lift - STEP)) / (2.0 * STEP)
    found = np.real(np.conj(outward(curve, phi)) * way)
    # A circle of the arm's radius leaves arm step^2/6 of the difference, a straight line nothing;
    # places up to 300 mm are rounded a few times, and the normal where |Z'| is small.
    arm = abs(curve.follower.reach)
    curved = arm * STEP**2 / 6.0 if isinstance(curve.follower, OscillatingRoller) else 0.0
    places = np.abs(centres(curve, lift))
    rounding = 16.0 * EPS * (places + arm + 200.0) / STEP
    normal = 64.0 * EPS * (places + 200.0) * (arm + 1.0) / np.abs(curve.jet(phi)[1])
    assert np.all(np.abs(curve.leverage(phi) - found) <= curved + rounding + normal)


@attack
@given(curve=pitch_curves(BENT))
def test_its_size_is_the_sine_of_the_transmission_angle(curve: PitchCurve) -> None:
    phi = angles(curve)
    assume(len(phi))
    arm = curve.follower.arm if isinstance(curve.follower, OscillatingRoller) else 1.0
    expected = arm * np.sin(curve.transmission_angle(phi))
    # u, its square and its root; atan2 and the sine: a few roundings each.
    assert np.abs(curve.leverage(phi)) == pytest.approx(expected, rel=8.0 * EPS, abs=1e-300)


@attack
@given(curve=pitch_curves(BENT))
def test_the_torque_of_the_normal_force_is_the_power_of_the_lift(curve: PitchCurve) -> None:
    """Newton at the disc: a unit force along the normal through the roller centre has the moment
    Im(conj(Z) n) about the cam axis; by virtual work it is leverage times q' in the cam's sense.
    """
    phi = angles(curve)
    assume(len(phi))
    lift = curve.motion.jet(phi)
    centre = centres(curve, lift[0])
    moment = curve.rotation * np.imag(np.conj(centre) * outward(curve, phi))
    found = curve.leverage(phi) * lift[1]
    # The moment is a difference of terms up to |Z|, with the normal's rounding; q' and its sines
    # have that of cam angles in radians near a border of the motion.
    speed = np.abs(curve.jet(phi)[1])
    scale = np.abs(centre) + np.abs(curve.follower.reach * lift[1]) + 200.0
    assert np.all(np.abs(moment - found) <= 64.0 * EPS * scale * (1.0 + scale / speed))


@pytest.mark.parametrize("direction", [1, -1])
@pytest.mark.parametrize("rotation", [1, -1])
@pytest.mark.parametrize("name", ["trans_F_sp_e12", "osc_F_sp"])
def test_its_sign_is_that_of_outward_motion(name: str, rotation: int, direction: int) -> None:
    """In the rest at lift 0 nothing but the direction counts: the normal is radial there."""
    curve = pitch_curve_of(mechanisms()[name]["params"])
    follower = curve.follower
    assert isinstance(follower, TranslatingRoller | OscillatingRoller)
    turned_round = PitchCurve(curve.motion, replace(follower, direction=direction), rotation)
    middles = np.array([dwell.start + 0.5 * dwell.span for dwell in turned_round.dwells]) % TURN
    phi = middles[turned_round.motion.jet(middles)[0] == 0.0][:1]
    found = turned_round.leverage(phi)[0]
    assert math.copysign(1.0, found) == direction
    centre = centres(turned_round, turned_round.motion.jet(phi)[0])
    radial = np.abs(centres(turned_round, turned_round.motion.jet(phi)[0] + STEP)) - np.abs(centre)
    # The distance from the cam axis bends by at most way^2/r, and the way is 1 or 100 mm/rad.
    reach = abs(follower.reach)
    assert radial[0] / STEP == pytest.approx(
        found, rel=0.0, abs=reach * (reach / 20.0 + 1.0) * STEP
    )


def test_a_centred_guide_has_all_of_it_in_a_rest() -> None:
    params = mechanisms()["trans_F_sp_e12"]["params"]
    curve = pitch_curve_of(params)
    assert isinstance(curve.follower, TranslatingRoller)
    centred = PitchCurve(curve.motion, replace(curve.follower, offset=0.0), curve.rotation)
    dwell = centred.dwells[0]
    assert centred.leverage(np.array([dwell.start + 0.5 * dwell.span]))[0] == 1.0


def test_both_sides_of_a_kink() -> None:
    """Where the velocity jumps, so does the normal, and with it the leverage."""
    curve = pitch_curve_of(mechanisms()["trans_F_sp_e12"]["params"])
    phi = curve.borders[:3]
    near = 1e-9
    assert curve.leverage(phi, "left") == pytest.approx(curve.leverage(phi - near), abs=1e-6)
    assert curve.leverage(phi, "right") == pytest.approx(curve.leverage(phi + near), abs=1e-6)


def test_hc19_jams_where_the_normal_passes_through_the_pivot() -> None:
    params, expected = hard_case("HC19")
    curve = pitch_curve_of(params)
    phi = np.radians([params["phi_deg"]])
    arm = abs(curve.follower.reach)
    found = abs(curve.leverage(phi)[0])
    assert found == pytest.approx(arm * math.sin(math.radians(expected["mu"])), rel=1e-12)


def test_hc18_where_the_roller_stands_still_there_is_none() -> None:
    params, _ = hard_case("HC18")
    curve = pitch_curve_of(params)
    with pytest.raises(GeometryError, match="stands still in the turning cam"):
        curve.leverage(np.radians([100.0, params["phi_deg"]]))
