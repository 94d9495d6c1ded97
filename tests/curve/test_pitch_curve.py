"""The pitch curve: its curvature, its angles, its joints, and the leverage of a normal force.

The work of a normal force is that of the follower, and its torque that of the cam."""

from __future__ import annotations

import math
from dataclasses import replace
from decimal import Decimal
from typing import Any

import numpy as np
import pytest
from hypothesis import assume, given

from camgeo.geometry.pitch_curve import BLOCK, PitchCurve, in_blocks, joints
from camgeo.kinematics.laws import make_law
from camgeo.kinematics.laws.law import Law
from camgeo.kinematics.mechanism.rollers import OscillatingRoller, TranslatingRoller
from camgeo.kinematics.plan import Dwell, MotionPlan, Move
from camgeo.numeric.arrays import ComplexArray, FloatArray
from camgeo.units import TURN
from tests.integrals import cells, integrals
from tests.reference import inner_of, mechanisms, pitch_curve_of
from tests.strategies import BENT, SMOOTH, attack, pitch_curves

QUADRATURE = 1e-9
"""What the rule of 24 points leaves of a sharp bend, for curves whose speed changes by 1 to 5."""


def steady(curve: PitchCurve) -> bool:
    """True if the rule of 24 points can follow: |Z'| stays off 0."""
    speed = np.abs(curve.jet(np.linspace(0.0, TURN, 721))[1])
    return bool(np.min(speed) > 0.2 * np.max(speed))


@attack
@given(curve=pitch_curves(BENT))
def test_curvature_is_the_turning_of_the_tangent(curve: PitchCurve) -> None:
    """Positive where convex: a convex curve run through clockwise, for sigma = +1, turns so."""
    assume(steady(curve))
    low, high = cells(curve.borders, 12)
    found = integrals(lambda phi: curve.curvature(phi) * np.abs(curve.jet(phi)[1]), low, high)
    ahead, behind = curve.jet(high, "left")[1], curve.jet(low, "right")[1]
    turned = -curve.rotation * np.angle(ahead / behind)
    assert np.max(np.abs(found - turned)) <= QUADRATURE * np.max(np.abs(found))


@attack
@given(curve=pitch_curves(BENT))
def test_the_slope_of_the_curvature_is_its_derivative(curve: PitchCurve) -> None:
    assume(steady(curve))
    low, high = cells(curve.borders, 12)
    found = integrals(curve.curvature_slope, low, high)
    change = curve.curvature(high, "left") - curve.curvature(low, "right")
    scale = np.max(np.abs(curve.curvature(np.linspace(0.0, TURN, 721))))
    assert np.max(np.abs(found - change)) <= QUADRATURE * scale


@pytest.mark.parametrize("name", mechanisms())
def test_the_tangent_turns_once(name: str) -> None:
    """Over a turn of the cam, whatever its inflections: the pitch curve is a simple closed one."""
    curve = pitch_curve_of(mechanisms()[name]["params"])
    low, high = cells(curve.borders, 12)
    found = integrals(lambda phi: curve.curvature(phi) * np.abs(curve.jet(phi)[1]), low, high)
    # The rule of 24 points leaves 1e-12 at the sharpest bend of these cams; a half turn is 3.
    assert np.sum(found) == pytest.approx(TURN, rel=1e-10)


@attack
@given(curve=pitch_curves(BENT))
def test_transmission_and_pressure_angle_fill_the_quarter(curve: PitchCurve) -> None:
    phi = np.linspace(0.0, TURN, 97)
    mu, pressure = curve.transmission_angle(phi), curve.pressure_angle(phi)
    assert np.all((mu >= 0.0) & (mu <= 0.5 * math.pi))
    assert mu + pressure == pytest.approx(np.full(97, 0.5 * math.pi), rel=4e-16)


RIGHT = Decimal(90)


SPAN = math.radians(90.0)


def curve_with(law: Law) -> PitchCurve:
    plan = MotionPlan((Dwell(RIGHT), Move(RIGHT, 10.0, law), Dwell(RIGHT), Move(RIGHT, 0.0, law)))
    return PitchCurve(plan, TranslatingRoller(40.0, 5.0), 1)


@attack
@given(curve=pitch_curves(SMOOTH))
def test_smooth_laws_close_point_and_tangent(curve: PitchCurve) -> None:
    join = joints(curve)
    size = np.max(np.abs(curve.point(join.phi)))
    assert 0.0 in join.phi
    assert set(curve.breaks.tolist()) <= set(join.phi.tolist())
    assert np.max(join.gaps) <= 1e-14 * size
    # u and v of |Z'| may both be small: its direction is right to the lengths in it.
    assert np.max(join.turns) <= 1e-13 * size / np.min(np.abs(curve.jet(join.phi)[1]))


def test_a_straight_line_turns_the_tangent_by_the_angle_of_its_speed() -> None:
    join = joints(curve_with(make_law("straight-line")))
    speed = 10.0 / SPAN
    start = int(np.argmin(np.abs(join.phi - SPAN)))
    assert join.turns[start] == pytest.approx(math.atan2(speed, 40.0), rel=1e-12)
    assert np.max(join.gaps) <= 1e-13


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


@pytest.mark.parametrize("cells", [False, True])
@pytest.mark.parametrize("count", [0, 1, BLOCK - 1, BLOCK, BLOCK + 1, 2 * BLOCK, 3 * BLOCK + 7])
def test_blocks_cover_all_points_or_cells_once_in_order(count: int, cells: bool) -> None:
    sizes = []

    @in_blocks
    def function(_: None, x: FloatArray, other: Any) -> FloatArray:
        sizes.append(len(x))
        return np.stack((x, other if cells else (2.0 if other == "left" else np.nan) * x))

    x = np.arange(float(count))
    found = function(None, x, x + 0.5 if cells else "left")
    assert np.array_equal(found, np.stack((x, x + 0.5 if cells else 2.0 * x)))
    assert max(sizes) <= BLOCK
    assert sum(sizes) == count


def test_a_point_has_the_same_value_in_any_array() -> None:
    curve = pitch_curve_of(mechanisms()["T6_setzhub_sm_program"]["params"])
    phi = np.linspace(0.0, TURN, 2 * BLOCK + 11)
    some = slice(BLOCK - 3, BLOCK + 3)
    assert np.array_equal(curve.jet(phi)[:, some], curve.jet(phi[some]))
    assert np.array_equal(curve.curvature(phi)[some], curve.curvature(phi[some]))
    inner = inner_of(curve)
    assert np.array_equal(inner.point(phi)[some], inner.point(phi[some]))
