"""What holds for every flat-faced follower, over random ones; with other formulas than theirs."""

from __future__ import annotations

import cmath
import math
from dataclasses import replace

import mpmath
import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from scipy.optimize import brentq, minimize_scalar

from camgeo.errors import GeometryError
from camgeo.geometry.outline.convex import touch
from camgeo.geometry.pitch_curve import PitchCurve
from camgeo.kinematics.mechanism.oscillating_flat import OscillatingFlat
from camgeo.kinematics.mechanism.translating_flat import TranslatingFlat
from camgeo.kinematics.plan import MotionPlan
from camgeo.numeric.arrays import ComplexArray, FloatArray, phase
from camgeo.units import TURN
from tests.integrals import cells, integrals
from tests.laws import LAWS
from tests.mechanism.flat_faces import convex_curves, flat_curves
from tests.mechanism.test_followers import backwards
from tests.reference import plan_of
from tests.strategies import SMOOTH, attack, cam_angles

PHI = np.linspace(0.0, TURN, 121)

ROUNDING = 1e-13
"""As a share of the largest value, as for rollers: some hundred ulp."""


def size(values: FloatArray | ComplexArray) -> FloatArray:
    """(k, 1) largest absolute values of each row."""
    return np.asarray(np.max(np.abs(values), axis=-1, keepdims=True))


def face_line(curve: PitchCurve, lift: FloatArray) -> tuple[ComplexArray, ComplexArray]:
    """A point of the face and its direction, in the fixed frame, at lifts (n,): rigid bodies.

    At lift 0 the face is the tangent of the base circle; then it is shifted, or turned about the
    pivot.
    """
    follower = curve.follower
    if isinstance(follower, TranslatingFlat):
        out = cmath.exp(1j * follower.guide_angle)
        places = out * (follower.base_radius + follower.direction * lift)
        return np.asarray(places), np.full(len(lift), -1j * out)
    assert isinstance(follower, OscillatingFlat)
    # The tangent of the base circle that has the pivot at its distance, on the side of the face.
    axis, away = phase(-follower.pivot), follower.base_radius - follower.face_offset
    slope = follower.arm_side * math.asin(away / abs(follower.pivot))
    along = cmath.exp(1j * (axis + slope))
    foot = follower.pivot + 1j * follower.arm_side * along * follower.face_offset
    turned = np.exp(1j * follower.swing_sense * lift)
    return follower.pivot + (foot - follower.pivot) * turned, along * turned


def face_in_cam(curve: PitchCurve, phi: FloatArray) -> tuple[ComplexArray, ComplexArray]:
    """A point of the face and its normal away from the cam axis, in the cam."""
    place, along = face_line(curve, curve.motion.jet(phi)[0])
    back = np.exp(-1j * curve.rotation * phi)
    # Of a face that passes the cam axis the normal keeps its side: that of cam angle 0.
    start, direction = face_line(curve, np.zeros(1))
    sense = np.sign((np.conj(1j * direction) * start).real)
    return place * back, sense * 1j * along * back


@attack
@given(curve=flat_curves())
def test_the_contact_lies_on_the_face_and_runs_along_it(curve: PitchCurve) -> None:
    """The curve touches the face: it is the envelope, whether it is convex or not."""
    place, normal = face_in_cam(curve, PHI)
    z, z1, _ = curve.jet(PHI)
    limit = ROUNDING * (np.max(np.abs(z)) + np.max(np.abs(place)))
    assert np.max(np.abs((np.conj(normal) * (z - place)).real)) <= limit
    assert np.max(np.abs((np.conj(normal) * z1).real)) <= ROUNDING * np.max(np.abs(z1))
    at = touch(curve, PHI)
    assert np.max(np.abs((np.conj(normal) * z).real - at.distance)) <= limit
    # Forwards where p > 0: the outward normal is i sigma times the tangent.
    ahead = (np.conj(normal) * 1j * curve.rotation * z1).real
    assert np.max(np.abs(ahead - at.pace[0])) <= ROUNDING * np.max(np.abs(z1))


@attack
@given(curve=convex_curves())
def test_no_face_cuts_into_a_convex_cam(curve: PitchCurve) -> None:
    """Every position of the face leaves all of the cam on its inner side."""
    place, normal = face_in_cam(curve, PHI)
    z = curve.point(np.linspace(0.0, TURN, 500))
    beyond = (np.conj(normal)[:, None] * (z[None, :] - place[:, None])).real
    assert np.max(beyond) <= ROUNDING * np.max(np.abs(z)) * 4.0


@attack
@given(curve=convex_curves(), phi=cam_angles())
def test_the_cam_asks_for_the_lift_that_it_was_made_for(curve: PitchCurve, phi: float) -> None:
    """Turn the cam and lower the face on it: the lift at which it touches is the motion's.

    How far the cam reaches beyond the face is found by maximising over its points, the lift at
    which that is nothing by bracketing. A maximum is known to the root of the rounding in its
    place, and to rounding in its value.
    """
    back = np.exp(-1j * curve.rotation * phi)
    grid = np.linspace(0.0, TURN, 400)
    sampled = curve.point(grid)
    demanded = float(curve.motion.jet(np.array([phi]))[0, 0])
    inward = face_in_cam(curve, np.array([phi]))[1][0]

    def overlap(lift: float) -> float:
        place, along = (part[0] * back for part in face_line(curve, np.array([lift])))
        normal = 1j * along
        normal *= np.sign((np.conj(normal) * inward).real)
        best = grid[np.argmax((np.conj(normal) * (sampled - place)).real)]

        def below(at: float) -> float:
            return -float((np.conj(normal) * (curve.point(np.array([at]))[0] - place)).real)

        step = grid[1]
        found = minimize_scalar(
            below, bounds=(best - step, best + step), method="bounded", options={"xatol": 1e-9}
        )
        return -float(found.fun)

    # How far the face goes where it touches, a unit of lift.
    lever = abs(float(curve.leverage(np.array([phi]))[0]))
    assume(lever >= 1.0)
    reach = 0.05 / lever
    lift = brentq(overlap, demanded - reach, demanded + reach, xtol=1e-13)
    assert abs(lift - demanded) * lever <= 1e-9


@attack
@given(curve=flat_curves(SMOOTH))
def test_each_derivative_is_the_derivative_of_the_one_before(curve: PitchCurve) -> None:
    low, high = cells(curve.borders, 6)
    change = curve.jet(high, "left")[:2] - curve.jet(low, "right")[:2]
    found = integrals(lambda phi: curve.jet(phi)[1:], low, high)
    # 100 times the rounding of rollers: w^2 and w^3 stand before the derivatives of the lift.
    limit = 100.0 * ROUNDING * (size(curve.jet(PHI))[:2] + size(found))
    assert np.all(np.abs(found - change) <= limit)

    # The tangent's own derivatives, and those of the contact and of tau, by the same test.
    def rates(phi: FloatArray) -> FloatArray:
        at = touch(curve, phi)
        return np.stack((at.pace[1], at.contact[1], at.turn[1]))

    def values(phi: FloatArray, side: str) -> FloatArray:
        at = touch(curve, phi, "left" if side == "left" else "right")
        return np.stack((at.pace[0], at.contact[0], at.turn[0]))

    wandered = values(high, "left") - values(low, "right")
    summed = integrals(rates, low, high)
    spare = size(values(PHI, "right")) + size(summed) + size(rates(PHI))
    assert np.all(np.abs(summed - wandered) <= 100.0 * ROUNDING * spare)


@pytest.mark.parametrize("rotation", [1, -1])
@pytest.mark.parametrize("side", [0, 1, -1])
def test_curvature_against_differences_of_the_point(rotation: int, side: int) -> None:
    """By mpmath with 40 digits, from the lift's formula: kappa = -sigma Im(conj Z' Z'')/|Z'|^3."""
    plan = plan_of({"phi_H": [30, 90, 40, 120, 80]}, 0.2 if side else 9.0)
    follower = (
        OscillatingFlat(complex(-70.0, 50.0), 35.0, 7.0, side, 1)
        if side
        else TranslatingFlat(40.0, 0.4, 1)
    )
    curve = PitchCurve(plan, follower, rotation)
    start, span, stroke = math.radians(30.0), math.radians(90.0), 0.2 if side else 9.0
    with mpmath.workdps(40):

        def support(phi: mpmath.mpf) -> tuple[mpmath.mpf, mpmath.mpf]:
            """h and nu."""
            z = (phi - mpmath.mpf(start)) / mpmath.mpf(span)
            lift = stroke * (10 * z**3 - 15 * z**4 + 6 * z**5)
            if isinstance(follower, TranslatingFlat):
                return follower.base_radius + lift, mpmath.mpf(follower.guide_angle)
            l1 = mpmath.sqrt(70**2 + 50**2)
            chi = mpmath.asin((35 - 7) / l1) + lift
            line = mpmath.atan2(-50, 70)
            return l1 * mpmath.sin(chi) + 7, line + side * (chi + mpmath.pi / 2)

        def point(phi: mpmath.mpf) -> mpmath.mpc:
            theta1 = mpmath.diff(lambda x: support(x)[1], phi) - rotation
            h, nu = support(phi)
            rate = mpmath.diff(lambda x: support(x)[0], phi)
            return (h + 1j * rate / theta1) * mpmath.expj(nu - rotation * phi)

        for degrees in (35.0, 60.0, 75.0, 90.0, 110.0):
            phi = math.radians(degrees)
            first, second = (
                mpmath.diff(point, mpmath.mpf(phi), k, h=mpmath.mpf("1e-8")) for k in (1, 2)
            )
            expected = -rotation * (mpmath.conj(first) * second).imag / abs(first) ** 3
            found = curve.curvature(np.array([phi]))[0]
            assert found == pytest.approx(float(expected), rel=1e-9)
            step = 1e-5
            near = curve.curvature(np.array([phi - step, phi + step]))
            slope = (near[1] - near[0]) / (2.0 * step)
            assert curve.curvature_slope(np.array([phi]))[0] == pytest.approx(slope, rel=1e-6)


@attack
@given(curve=flat_curves())
def test_virtual_work_gives_the_leverage(curve: PitchCurve) -> None:
    """A face that is moved by dq goes dn along its normal where the contact is."""
    at = curve.point(PHI)
    lift, step = curve.motion.jet(PHI)[0], 1e-6
    normal = face_in_cam(curve, PHI)[1]
    back = np.exp(-1j * curve.rotation * PHI)

    def height(lifts: FloatArray) -> FloatArray:
        """Where the line through the contact along the normal meets the face."""
        place, along = (part * back for part in face_line(curve, lifts))
        away = place - at
        return np.asarray((np.conj(1j * along) * away).real / (np.conj(1j * along) * normal).real)

    expected = (height(lift + step) - height(lift - step)) / (2.0 * step)
    # On a reversed stretch the outward normal of the curve is the other one.
    expected = expected * np.sign(touch(curve, PHI).pace[0])
    # Rounding of places of some 400 mm by the step, far above what step^2 neglects.
    limit = 4e-16 * 400.0 * 8.0 / step + 1e-9 * np.max(np.abs(expected))
    assert np.all(np.abs(curve.leverage(PHI) - expected) <= limit)


@attack
@given(curve=flat_curves())
def test_transmission_angle_by_its_definition(curve: PitchCurve) -> None:
    """Between the guide's normal or the lever, pivot -> contact, and the normal of the curve."""
    follower = curve.follower
    normal = face_in_cam(curve, PHI)[1] * np.exp(1j * curve.rotation * PHI)
    if isinstance(follower, TranslatingFlat):
        assert np.all(curve.transmission_angle(PHI) == math.pi / 2.0)
        return
    assert isinstance(follower, OscillatingFlat)
    lever = curve.point(PHI) * np.exp(1j * curve.rotation * PHI) - follower.pivot
    product = np.conj(lever) * normal
    expected = np.arctan2(np.abs(product.imag), np.abs(product.real))
    limit = 100.0 * ROUNDING * (np.max(np.abs(lever)) + 200.0) / np.abs(lever)
    assert np.all(np.abs(curve.transmission_angle(PHI) - expected) <= limit)


@attack
@given(curve=flat_curves(SMOOTH))
def test_the_same_cam_turned_the_other_way(curve: PitchCurve) -> None:
    """Z of -sigma for the plan run backwards is Z of sigma, point for point."""
    assert isinstance(curve.motion, MotionPlan)
    other = PitchCurve(backwards(curve.motion), curve.follower, -curve.rotation)
    here, there = curve.point(PHI), other.point(-PHI)
    assert np.max(np.abs(here - there)) <= 100.0 * ROUNDING * np.max(np.abs(here))


@attack
@given(curve=flat_curves(), angle=st.floats(-math.pi, math.pi))
def test_mirrored_and_turned(curve: PitchCurve, angle: float) -> None:
    """In a mirror on the x axis the cam turns the other way, and the other side is the rocker's."""
    follower = curve.follower
    turn = cmath.exp(1j * angle)
    if isinstance(follower, TranslatingFlat):
        mirrored = replace(follower, guide_angle=-follower.guide_angle)
        turned: TranslatingFlat | OscillatingFlat = replace(
            follower, guide_angle=follower.guide_angle + angle
        )
        image: TranslatingFlat | OscillatingFlat = mirrored
    else:
        assert isinstance(follower, OscillatingFlat)
        if follower.direction is None:
            return  # the lift is an angle with a sign of its own
        image = replace(follower, pivot=follower.pivot.conjugate(), arm_side=-follower.arm_side)
        turned = replace(follower, pivot=follower.pivot * turn)
    here = curve.jet(PHI)
    there = PitchCurve(curve.motion, image, -curve.rotation).jet(PHI)
    assert np.all(np.abs(np.conj(here) - there) <= ROUNDING * size(here))
    there = PitchCurve(curve.motion, turned, curve.rotation).jet(PHI)
    assert np.all(np.abs(turn * here - there) <= ROUNDING * size(here))


@attack
@given(curve=flat_curves(tuple(LAWS)), count=st.integers(1, 30))
def test_bounds_do_all_that_is_asked_of_them(curve: PitchCurve, count: int) -> None:
    """Of Z' and Z'' all over each cell; the third as `camgeo.kinematics.mechanism.face` says."""
    low, high = cells(curve.borders, count)
    middle, (first, second, third) = curve.jet_and_bounds(low, high)
    half = 0.5 * (high - low)
    for share in np.linspace(0.0, 1.0, 33):
        phi = np.clip(low + share * (high - low), low, high)
        z, z1, z2 = curve.jet(phi, "left" if share == 1.0 else "right")
        way = phi - 0.5 * (low + high)
        spare = 1e-12 * (first + second)
        assert np.all(np.abs(z1) <= first + spare)
        assert np.all(np.abs(z2) <= second + spare)
        assert np.all(np.abs(z2 - middle[2]) <= third * half + spare)
        assert np.all(np.abs(z1 - middle[1] - middle[2] * way) <= 0.5 * third * half**2 + spare)
        off = z - middle[0] - middle[1] * way - 0.5 * middle[2] * way**2
        assert np.all(np.abs(off) <= third * half**3 / 6.0 + spare)


def test_a_third_bound_without_its_jump_is_seen() -> None:
    """The test above can fail: what Z''' would be bounded by does not hold as such."""
    curve = PitchCurve(plan_of({"phi_H": [30, 90, 40, 120, 80]}, 9.0), TranslatingFlat(40.0), 1)
    low, high = cells(curve.borders, 4)
    middle, bounds = curve.jet_and_bounds(low, high)
    half = 0.5 * (high - low)
    _, limits = curve.motion.jet_and_bounds(low, high)
    smooth = bounds[2] - 3.0 * (np.abs(curve.motion.jet(0.5 * (low + high))[3]) + limits[3]) / half
    change = np.abs(curve.jet(high - 1e-12)[2] - middle[2])
    assert np.all(change <= bounds[2] * half)
    assert not np.all(change <= smooth * half)


def test_bounds_in_a_rest_are_the_values() -> None:
    """There the curve is an arc about the cam axis, and Z''' what it is."""
    for follower in (TranslatingFlat(40.0), OscillatingFlat(-70.0 + 20j, 40.0, 5.0)):
        curve = PitchCurve(plan_of({"phi_H": [30, 90, 40, 120, 80]}, 0.1), follower, 1)
        _, bounds = curve.jet_and_bounds(np.array([0.0]), np.radians([30.0]))
        assert bounds[:, 0] == pytest.approx([40.0, 40.0, 40.0], rel=1e-12)


def test_a_rocker_whose_face_cannot_lie_there() -> None:
    with pytest.raises(GeometryError, match="between 0 and 58 mm") as error:
        OscillatingFlat(50.0 + 0j, 58.0, 8.0)
    assert error.value.key == "follower.base_radius"
    with pytest.raises(GeometryError, match="between 30 and 130 mm"):
        OscillatingFlat(50.0 + 0j, 30.0, 80.0)
    assert OscillatingFlat(50.0 + 0j, 57.9, 8.0).start_angle == pytest.approx(math.asin(0.998))


def test_a_translating_tappet_by_hand() -> None:
    """Cam counter-clockwise, guide upwards: it lifts with its right-hand side, at x = s'."""
    plan = plan_of({"phi_H": [30, 90, 40, 120, 80]}, 9.0)
    curve = PitchCurve(plan, TranslatingFlat(40.0), 1)
    phi = np.radians([75.0])
    s, s1, s2, _ = plan.jet(phi)[:, 0]
    contact = curve.point(phi)[0] * cmath.exp(1j * phi[0])
    assert contact == pytest.approx(complex(s1, 40.0 + s), rel=1e-14)
    assert s1 > 0.0
    assert 1.0 / curve.curvature(phi)[0] == pytest.approx(40.0 + s + s2, rel=1e-14)
    assert touch(curve, phi).contact[0] == pytest.approx([s1])
