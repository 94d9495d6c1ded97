"""What holds for every flat-faced follower, over random ones; with other formulas than theirs."""

from __future__ import annotations

import cmath
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from camgeo.errors import GeometryError
from camgeo.geometry.pieces import touch
from camgeo.geometry.pitch_curve import PitchCurve
from camgeo.kinematics.mechanism.flat import OscillatingFlat, TranslatingFlat
from camgeo.numeric.arrays import ComplexArray, FloatArray, phase
from camgeo.units import TURN
from tests.integrals import cells
from tests.laws import LAWS
from tests.mechanism.flat_faces import convex_curves, flat_curves
from tests.reference import plan_of
from tests.strategies import attack

PHI = np.linspace(0.0, TURN, 121)

ROUNDING = 1e-13
"""As a share of the largest value, as for rollers: some hundred ulp."""


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
@given(curve=flat_curves(tuple(LAWS)), count=st.integers(1, 30))
def test_bounds_do_all_that_is_asked_of_them(curve: PitchCurve, count: int) -> None:
    """Of Z' and Z'' all over each cell; the third as `camgeo.kinematics.mechanism.flat` says."""
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
