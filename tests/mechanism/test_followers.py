"""What holds for every roller follower, over random valid ones; also run backwards, or mirrored."""

from __future__ import annotations

import cmath
import math
from decimal import Decimal

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from camgeo.errors import GeometryError, UndercutError
from camgeo.geometry.outline.outline import Outline, real_outline
from camgeo.geometry.outline.path import area
from camgeo.geometry.pitch_curve import PitchCurve
from camgeo.geometry.working_curve import WorkingCurve
from camgeo.kinematics.mechanism.linkage import LinkedMotion
from camgeo.kinematics.mechanism.oscillating_roller import OscillatingRoller
from camgeo.kinematics.mechanism.translating_roller import TranslatingRoller
from camgeo.kinematics.motion import Motion
from camgeo.kinematics.plan import Dwell, MotionPlan, Move
from camgeo.numeric.arrays import ComplexArray, FloatArray
from camgeo.units import TURN
from tests.integrals import cells
from tests.laws import LAWS
from tests.outline.clearing import corners
from tests.reference import POLYNOMIAL, shift
from tests.strategies import BENT, attack, linked_pitch_curves, pitch_curves, signs

PHI = np.linspace(0.0, TURN, 121)

ROUNDING = 1e-13
"""As a share of the largest value: some hundred ulp. A value takes about 30 operations on lengths
of its size, and cam angles are off by 4 ulp, by the steepness of the jerk, 70 times its size."""


def size(values: FloatArray | ComplexArray) -> FloatArray:
    """(k, 1) largest absolute values of each row."""
    return np.asarray(np.max(np.abs(values), axis=-1, keepdims=True))


def fixed(curve: PitchCurve, phi: FloatArray) -> ComplexArray:
    """The roller centre in the fixed frame."""
    return np.asarray(curve.point(phi) * np.exp(1j * curve.rotation * phi))


def along_guide(follower: TranslatingRoller, vectors: ComplexArray) -> ComplexArray:
    """Vectors in axes across the guide (to its right) and along it."""
    return np.asarray(vectors * cmath.exp(-1j * (follower.guide_angle - math.pi / 2.0)))


@attack
@given(curve=pitch_curves(BENT))
def test_the_roller_stays_where_the_follower_holds_it(curve: PitchCurve) -> None:
    """On the guide at its height, or on the arm at its angle; in the fixed frame."""
    centre, lift = fixed(curve, PHI), curve.motion.jet(PHI)[0]
    follower = curve.follower
    limit = ROUNDING * np.max(np.abs(centre))
    if isinstance(follower, TranslatingRoller):
        local = along_guide(follower, centre)
        height = math.sqrt(follower.base_radius**2 - follower.offset**2)
        assert np.max(np.abs(local.real - follower.offset)) <= limit
        assert np.max(np.abs(local.imag - height - follower.direction * lift)) <= limit
        return
    assert isinstance(follower, OscillatingRoller)
    arm = centre - follower.pivot
    assert np.max(np.abs(np.abs(arm) - follower.arm)) <= 4.0 * limit
    angle = np.angle(arm / -follower.pivot)  # from the line pivot -> cam axis
    assert np.all(np.sign(angle) == follower.arm_side)
    swing = np.abs(angle) - follower.start_angle
    assert follower.direction is not None
    # An angle is a length by the arm.
    assert np.max(np.abs(swing - follower.direction * lift)) <= 4.0 * limit / follower.arm


@attack
@given(curve=pitch_curves(tuple(LAWS)), count=st.integers(1, 5))
def test_speed_bounds_hold_all_over_their_cells(curve: PitchCurve, count: int) -> None:
    low, high = cells(curve.borders, count)
    bounds = curve.speed_bounds(low, high)
    for share in np.linspace(0.0, 1.0, 33):
        phi = np.clip(low + share * (high - low), low, high)
        values = np.abs(curve.jet(phi, "left" if share == 1.0 else "right")[1:])
        assert np.all(values <= bounds + ROUNDING * size(values))


@attack
@given(curve=pitch_curves(tuple(LAWS)))
def test_speed_bounds_are_not_far_above_the_values(curve: PitchCurve) -> None:
    """On small cells only the triangle inequality over the terms of |Z'| makes a difference."""
    low, high = cells(curve.borders, 200)
    values = np.abs(curve.jet(0.5 * (low + high))[1:])
    bounds = curve.speed_bounds(low, high)
    follower = curve.follower
    spare = 2.0 * follower.base_radius
    if isinstance(follower, OscillatingRoller):
        spare = 4.0 * (follower.centre_distance + follower.arm)
    assert np.all(bounds[0] <= 1.1 * values[0] + spare)


# Translating rollers ---------------------------------------------------------------------------

RISE = MotionPlan((Move(Decimal(180), 20.0, POLYNOMIAL), Move(Decimal(180), 0.0, POLYNOMIAL)))


@pytest.mark.parametrize("offset", [50.001, -50.001])
def test_an_offset_above_the_base_radius_is_refused(offset: float) -> None:
    with pytest.raises(GeometryError, match="must not exceed the base radius, 50 mm") as caught:
        TranslatingRoller(50.0, 5.0, offset=offset)
    assert caught.value.key == "follower.offset"
    assert caught.value.value == f"{offset:g}"


@pytest.mark.parametrize("offset", [50.0, -50.0])
def test_an_offset_as_large_as_the_base_radius_starts_level_with_the_axis(offset: float) -> None:
    assert TranslatingRoller(50.0, 5.0, offset=offset).start_height == 0.0


def test_the_start_height_keeps_its_digits_near_the_limit() -> None:
    offset = math.nextafter(50.0, 0.0)
    expected = math.sqrt(100.0 * (50.0 - offset))
    height = TranslatingRoller(50.0, 5.0, offset=offset).start_height
    assert height == pytest.approx(expected, rel=1e-15)


@pytest.mark.parametrize("rotation", [1, -1])
def test_the_offset_that_eases_the_rise(rotation: int) -> None:
    """For a cam that turns counter-clockwise a positive one (mechanisms.md 3.2)."""
    phi = np.radians(np.linspace(10.0, 170.0, 33))
    smallest = {
        offset: np.min(
            PitchCurve(
                RISE, TranslatingRoller(50.0, 5.0, offset=offset), rotation
            ).transmission_angle(phi)
        )
        for offset in (-10.0, 0.0, 10.0)
    }
    assert smallest[10.0 * rotation] > smallest[0.0] > smallest[-10.0 * rotation]


# Mirror images and motions run backwards ----------------------------------------------------------


def backwards(plan: MotionPlan) -> MotionPlan:
    """The motion run from the end: s~(phi) = s(-phi)."""
    segments: list[Dwell | Move] = []
    position = 0.0
    for segment in plan.segments:
        if isinstance(segment, Dwell):
            segments.append(segment)
            continue
        assert isinstance(segment, Move)
        assert segment.law.inflection is not None
        mirrored = shift(LAWS[segment.law.name], 1.0 - segment.law.inflection)
        segments.append(Move(segment.span, position, mirrored))
        position = segment.to
    return MotionPlan(tuple(reversed(segments)))


REVERSED = 1e-12
"""1 - lambda and the cam angles counted from the other end are rounded too, by some ulp of a turn,
times the steepness of a derivative."""

mechanisms = st.one_of(pitch_curves(BENT), linked_pitch_curves(BENT))


def reversed_(curve: PitchCurve) -> PitchCurve:
    """The motion run backwards on a cam that turns the other way."""
    motion: Motion = curve.motion
    if isinstance(motion, LinkedMotion):
        assert isinstance(motion.demanded, MotionPlan)
        motion = LinkedMotion(backwards(motion.demanded), motion.linkage)
    else:
        assert isinstance(motion, MotionPlan)
        motion = backwards(motion)
    return PitchCurve(motion, curve.follower, -curve.rotation)


def outline_of(curve: PitchCurve, side: int, radius: float) -> Outline | None:
    """None where nothing is left, or Z' = 0."""
    try:
        return real_outline(WorkingCurve(curve, side * radius))
    except GeometryError as error:
        if isinstance(error, UndercutError) or "stands still" in error.message:
            return None
        raise


@attack
@given(curve=mechanisms, side=signs(), share=st.floats(0.05, 0.8))
def test_the_motion_run_backwards_leaves_the_same_outline(
    curve: PitchCurve, side: int, share: float
) -> None:
    """With rollers up to undercut: the same corners, the same area run the other way round."""
    radius = share * curve.follower.base_radius
    one, two = outline_of(curve, side, radius), outline_of(reversed_(curve), side, radius)
    assert (one is None) == (two is None)
    if one is None or two is None:
        return
    assert len(one.path.elements) == len(two.path.elements)
    assert len(one.lobes) == len(two.lobes)
    size = REVERSED * (float(np.max(np.abs(curve.point(np.linspace(0.0, TURN, 181))))) + radius)
    ends = np.array([each.centre for each in corners(two.path)])
    for corner in corners(one.path):
        # The more the branches differ, the better the crossing is known.
        known = 64.0 * size / abs(math.sin(corner.sweep))
        assert np.min(np.abs(ends - corner.centre)) <= known
    assert area(two.path) == pytest.approx(-area(one.path), rel=1e-9)
