"""What holds for every follower, over random valid ones; also run backwards, or mirrored."""

from __future__ import annotations

import cmath
import math
from decimal import Decimal

import mpmath
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from mpmath import mp, mpc, mpf

from camgeo.errors import GeometryError, UndercutError
from camgeo.geometry.outline.outline import Outline, real_outline
from camgeo.geometry.outline.path import area
from camgeo.geometry.pieces import touch
from camgeo.geometry.pitch_curve import PitchCurve, WorkingCurve
from camgeo.kinematics.mechanism.flat import OscillatingFlat, TranslatingFlat
from camgeo.kinematics.mechanism.linkage import LinkedMotion
from camgeo.kinematics.mechanism.rollers import (
    FLAT,
    OscillatingRoller,
    TranslatingRoller,
    hypot_rest,
    return_on_carriage,
    return_on_lever,
)
from camgeo.kinematics.motion import Motion
from camgeo.kinematics.plan import Dwell, MotionPlan, Move
from camgeo.numeric.arrays import ComplexArray, FloatArray, phase
from camgeo.units import TURN
from tests.integrals import cells
from tests.laws import LAWS
from tests.long_form import examples
from tests.mechanism.flat_faces import convex_curves, flat_curves
from tests.outline.clearing import corners
from tests.pairs import Lever, Pair, pairs
from tests.reference import POLYNOMIAL, plan_of, shift
from tests.stability.series import Series, direction, variable
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


# Return rollers of conjugate cams -----------------------------------------------------------------

EPS = float(np.finfo(np.float64).eps)

GUIDE = TranslatingRoller(base_radius=50.0, roller_radius=8.0, offset=30.0)
ROCKER = OscillatingRoller(complex(-96.0, -72.0), 80.0, 90.0, 5.0)


def rounding(pair: Pair) -> float:
    """[mm] what is lost in the start angle of a triangle, and in the height of a guide.

    An angle psi of a triangle is known from its side r to eps r^2 / (l_1 l_3 sin psi), sin psi at
    least sin 20 deg here and r below l_1 + l_3; a height from its hypotenuse to eps r^2 / height,
    at least 15 mm of 90. A few such roundings of each of two rollers, 20 in all, are moved by arms
    and radii of `size`.
    """
    size = max(float(np.max(np.abs(curve.point(np.zeros(1))))) for curve in (pair.main, pair.other))
    if isinstance(pair.body, Lever):
        length = abs(pair.body.pivot) + max(pair.body.arms)
        lowest = abs(pair.body.pivot) * min(pair.body.arms) * math.sin(math.radians(20.0))
        return 20.0 * EPS * length * length**2 / lowest
    return 20.0 * EPS * (size + 130.0) ** 2 / 15.0


@settings(attack, max_examples=examples(16, long=40))
@given(pairs(), st.lists(st.floats(0.0, TURN), min_size=20, max_size=20))
def test_both_rollers_are_where_the_rigid_follower_holds_them(
    pair: Pair, angles: list[float]
) -> None:
    phi = np.array(angles)
    main, other = pair.in_cam(phi)
    slack = rounding(pair)
    assert np.max(np.abs(pair.main.point(phi) - main)) <= slack
    assert np.max(np.abs(pair.other.point(phi) - other)) <= slack


def test_what_is_not_given_is_that_of_the_main_roller() -> None:
    carriage = return_on_carriage(GUIDE, 95.0)
    assert (carriage.offset, carriage.roller_radius) == (-30.0, 8.0)
    # 40 mm above the axis, so 55 mm below it.
    assert carriage.base_radius == pytest.approx(math.hypot(30.0, 55.0), rel=1e-15)
    lever = return_on_lever(ROCKER, -2.0)
    assert (lever.arm, lever.roller_radius, lever.pivot) == (80.0, 5.0, ROCKER.pivot)


def test_behind_a_linkage_the_lift_stays_the_levers_own_angle() -> None:
    linked = OscillatingRoller(complex(-96.0, -72.0), 80.0, 90.0, 5.0, 1, None)
    assert return_on_lever(linked, -2.0).direction is None


@pytest.mark.parametrize("spacing", [39.0, 40.0, 40.0 + 20.0 * FLAT])
def test_a_carriage_whose_rollers_lie_on_one_side_is_refused(spacing: float) -> None:
    with pytest.raises(GeometryError, match=r"other side of the cam axis: .* 40 mm") as caught:
        return_on_carriage(GUIDE, spacing)
    assert caught.value.key == "follower.return.spacing"


@pytest.mark.parametrize("turns", [0.0, 0.5, -0.5, 1.0])
@pytest.mark.parametrize("off", [0.0, 0.5 * FLAT, -0.5 * FLAT])
@pytest.mark.parametrize("arm", [80.0, 120.0, 1e-3])
def test_a_return_arm_on_the_line_of_centres_is_refused(
    turns: float, off: float, arm: float
) -> None:
    """An arm of 120 mm on it holds the roller in the cam axis itself."""
    angle = turns * TURN - ROCKER.start_angle + off
    with pytest.raises(GeometryError, match="lies on the line from the pivot") as caught:
        return_on_lever(ROCKER, angle, arm)
    assert caught.value.key == "follower.return.arm_angle"


# Oscillating rollers ------------------------------------------------------------------------------

PIVOT = complex(-96.0, -72.0)  # 120 mm from the cam axis
SWING = 0.4
SWINGING = MotionPlan((Move(Decimal(180), SWING, POLYNOMIAL), Move(Decimal(180), 0.0, POLYNOMIAL)))
TOP = np.array([math.pi])


@pytest.mark.parametrize("base", [39.999, 40.0, 200.0, 200.001])
def test_a_base_radius_that_closes_no_triangle_is_refused(base: float) -> None:
    with pytest.raises(GeometryError, match="between 40 and 200 mm") as caught:
        OscillatingRoller(PIVOT, 80.0, base, 5.0)
    assert caught.value.key == "follower.base_radius"
    assert caught.value.value == f"{base:g}"


def test_a_pivot_may_lie_as_close_to_an_axis_as_numbers_can_tell() -> None:
    """Its angle is then smaller than the smallest normal number."""
    near, at = (
        PitchCurve(SWINGING, OscillatingRoller(complex(-120.0, height), 80.0, 60.0, 5.0), 1)
        for height in (5e-324, 0.0)
    )
    assert np.array_equal(near.point(TOP), at.point(TOP))
    assert np.array_equal(near.curvature(TOP), at.curvature(TOP))


@pytest.mark.parametrize("base", [40.001, 60.0, 120.0, 199.999])
def test_the_start_angle_is_that_of_the_triangle(base: float) -> None:
    angle = OscillatingRoller(PIVOT, 80.0, base, 5.0).start_angle
    # Law of cosines, the other way round.
    square = 120.0**2 + 80.0**2 - 2.0 * 120.0 * 80.0 * math.cos(angle)
    assert math.sqrt(square) == pytest.approx(base, rel=1e-12)


def test_the_start_angle_keeps_its_digits_where_the_arccosine_loses_them() -> None:
    base = 40.0 * (1.0 + 2.0**-40)
    # 1 - cos is (base^2 - 40^2) / (2 l_1 l_3), and the angle small.
    expected = 2.0 * math.asin(math.sqrt(1600.0 * (2.0**-39 + 2.0**-80) / (4.0 * 9600.0)))
    assert OscillatingRoller(PIVOT, 80.0, base, 5.0).start_angle == pytest.approx(
        expected, rel=4e-16
    )


@pytest.mark.parametrize("arm_side", [1, -1])
def test_without_direction_the_lift_is_the_rockers_own_angle(arm_side: int) -> None:
    follower = OscillatingRoller(PIVOT, 80.0, 90.0, 5.0, arm_side, None)
    curve = PitchCurve(SWINGING, follower, 1)
    start = curve.point(np.zeros(1))[0] - PIVOT
    top = curve.point(TOP)[0] * cmath.exp(1j * math.pi) - PIVOT
    assert phase(top / start) == pytest.approx(SWING, rel=1e-14)


# Distant pivots -------------------------------------------------------------------------------


@st.composite
def rockers(draw: st.DrawFn) -> tuple[OscillatingRoller, float]:
    """A rocker with its pivot up to 1e9 base radii away, for any base circle; and its size."""
    size = 10.0 ** draw(st.floats(-6.0, 6.0))
    distance = size * 10.0 ** draw(st.floats(0.0, 9.0))
    pivot = cmath.rect(distance, draw(st.floats(0.0, TURN)))
    arm = abs(pivot) + draw(st.floats(-0.9, 0.9)) * size
    side, direction = draw(st.sampled_from([1, -1])), draw(st.sampled_from([1, -1, None]))
    return OscillatingRoller(pivot, arm, size, 0.0, side, direction), size


@attack
@given(rockers(), st.tuples(*[st.floats(-0.3, 0.3)] * 4), st.sampled_from([1, -1]))
def test_a_distant_pivot_costs_no_digits(
    made: tuple[OscillatingRoller, float], shares: tuple[float, ...], rotation: int
) -> None:
    """Against the law of cosines and W = l_3 exp(i chi) - l_1 with 60 digits."""
    rocker, size = made
    jet = np.array(shares)[:, np.newaxis] * (size / rocker.arm)
    found = rocker.relative_jet(jet, rotation)
    tangent = rocker.tangent_jet(jet, rotation)
    with mp.workdps(60):
        l1, l3 = mp.hypot(rocker.pivot.real, rocker.pivot.imag), mpf(rocker.arm)
        start = mp.acos((l1**2 + l3**2 - mpf(rocker.base_radius) ** 2) / (2 * l1 * l3))
        swing = Series(tuple(mpf(float(s)) / mp.factorial(k) for k, s in enumerate(jet[:, 0])))
        chi = rocker.arm_side * start + rocker.swing_sense * swing
        centre = (l3 * direction(chi) - l1) * direction(variable(mpf(0), mpf(-rotation), 4))
        exact = [centre.derivative(order) for order in range(4)]
        forward = rotation * exact[1] * mp.expj(-chi.terms[0])
        # Sums of a dozen terms, each of at most a few sizes and rounded a few times.
        room = 512 * 2.0**-53 * size
        for own, along, across in zip(exact, found.along[:, 0], found.across[:, 0], strict=True):
            assert abs(own - mpc(float(along), float(across))) <= room
        assert abs(forward - mpc(float(found.u[0]), -float(found.v[0]))) <= room
        assert abs(forward - mpc(float(tangent.u[0, 0]), float(tangent.w[0, 0]))) <= room


def test_bounds_do_not_grow_with_the_distance_of_the_pivot() -> None:
    """The same path of the roller on ever larger circles: its bounds tend to those of a guide."""
    low = np.linspace(0.0, TURN, 65)[:-1]
    found = []
    for distance in (1e4, 1e8):
        way = MotionPlan(
            (
                Move(Decimal(180), 20.0 / distance, POLYNOMIAL),
                Move(Decimal(180), 0.0, POLYNOMIAL),
            )
        )
        rocker = OscillatingRoller(complex(-distance, 0.0), distance, 50.0, 5.0)
        found.append(PitchCurve(way, rocker, 1).speed_bounds(low, low + TURN / 64.0))
    assert np.all(found[1] <= 1.01 * found[0])
    assert np.all(found[0] <= 1000.0)


# What the rounding of a length took ------------------------------------------------------------

lengths = st.floats(1e-12, 1e12)
signed = st.builds(lambda size, sign: sign * size, lengths, st.sampled_from([-1.0, 1.0]))


@given(signed, signed)
def test_the_rest_of_a_length_is_what_its_rounding_took(x: float, y: float) -> None:
    size = abs(complex(x, y))
    rest = hypot_rest(complex(x, y), size)
    with mpmath.workdps(80):
        exact = mpmath.hypot(x, y) - size
        # The rest is divided by 2 size instead of the sum of both, and is itself rounded.
        assert abs(exact - rest) <= 2.0**-100 * size
    assert abs(rest) <= 2.0**-51 * size


@given(signed)
def test_along_an_axis_nothing_is_lost(x: float) -> None:
    assert hypot_rest(complex(x, 0.0), abs(x)) == 0.0
    assert hypot_rest(complex(0.0, x), abs(x)) == 0.0
    assert hypot_rest(0j, 0.0) == 0.0


# Flat faces, with other formulas than theirs ----------------------------------------------------


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
