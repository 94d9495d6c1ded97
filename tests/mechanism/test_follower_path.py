"""The path of the roller centre: coordinates of the plane, and where it meets lines and circles;
that of a flat face on a circle.
"""

from __future__ import annotations

import cmath
import math

import mpmath
import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from camgeo.errors import GeometryError
from camgeo.geometry.outline.face import face_path_of
from camgeo.geometry.pitch_curve import PitchCurve
from camgeo.kinematics.mechanism.flat import FlatFollower, OscillatingFlat, TranslatingFlat
from camgeo.kinematics.mechanism.follower_path import Bows, FollowerPath, path_of
from camgeo.kinematics.mechanism.rollers import OscillatingRoller, TranslatingRoller
from tests.strategies import attack, oscillating_rollers, pitch_curves, signs, translating_rollers

FOLLOWERS = (
    TranslatingRoller(40.0, 6.0, offset=9.0),
    TranslatingRoller(40.0, 6.0, offset=-9.0, guide_angle=0.4, direction=-1),
    OscillatingRoller(complex(-90.0, -30.0), 70.0, 50.0, 6.0),
    OscillatingRoller(complex(60.0, 70.0), 60.0, 50.0, 6.0, arm_side=-1, direction=-1),
)

PHI = np.linspace(0.0, 2.0 * math.pi, 37, endpoint=False)


def one(value: complex) -> np.ndarray[tuple[int], np.dtype[np.complex128]]:
    return np.array([value], dtype=np.complex128)


@attack
@given(pitch_curves(), st.integers(0, 10**9))
def test_the_pitch_curve_has_its_own_coordinates(curve: PitchCurve, seed: int) -> None:
    # A point is known to 1e-16 of itself; near h = 0 or psi = 0, pi that is worth more in q. The
    # strategies keep off those by a tenth of the base radius and more.
    path = path_of(curve.follower, curve.rotation)
    phi = np.random.default_rng(seed).uniform(0.0, 2.0 * math.pi, 20)
    found, q = path.cam_coordinates(curve.point(phi))
    assert np.max(np.abs(np.exp(1j * (found - phi)) - 1.0)) < 1e-13
    lift = path.outward * (q - path.start)
    assert lift == pytest.approx(curve.motion.jet(phi)[0], abs=1e-12)
    assert np.max(np.abs(path.point(found, q) - curve.point(phi))) < 1e-11


@pytest.mark.parametrize("follower", FOLLOWERS)
@pytest.mark.parametrize("sigma", [1, -1])
def test_q_grows_outward_along_the_path(
    follower: TranslatingRoller | OscillatingRoller, sigma: int
) -> None:
    path = path_of(follower, sigma)
    q = np.full(len(PHI), path.start)
    step = 1e-6
    along, bend = path.along(PHI, q)
    ahead, behind = path.point(PHI, q + step), path.point(PHI, q - step)
    assert np.all(np.abs(ahead) > np.abs(behind))
    # Central differences: error step^2/6 and rounding 1e-14/step.
    assert np.max(np.abs((ahead - behind) / (2.0 * step) - along)) < 1e-7
    forth, back = path.along(PHI, q + step)[0], path.along(PHI, q - step)[0]
    assert np.max(np.abs((forth - back) / (2.0 * step) - bend)) < 1e-7


@st.composite
def meetings(draw: st.DrawFn) -> tuple[FollowerPath, float, float, Bows]:
    """A path, a cam angle and q on it, and a bow through that point, across the path."""
    follower: TranslatingRoller | OscillatingRoller
    if draw(st.booleans()):
        follower = draw(translating_rollers(0.0))
    else:
        follower = draw(oscillating_rollers(0.0))
    path = path_of(follower, draw(signs()))
    phi = draw(st.floats(0.0, 6.28))
    at = np.array([phi]), np.array([path.start])
    point, along = path.point(*at), path.along(*at)[0]
    tilt = draw(st.floats(-1.2, 1.2)) + (math.pi if draw(st.booleans()) else 0.0)
    normal = along / np.abs(along) * cmath.exp(1j * tilt)
    kappa = draw(st.sampled_from([0.0, 1e-9, 1e-3, 0.05, 1.0]) | st.floats(-0.2, 0.2))
    # Known at another of its points, up to 0.3 rad or 5 mm away.
    away = draw(st.floats(-1.0, 1.0)) * min(5.0, 0.3 / max(abs(kappa), 1e-12))
    turn = kappa * away
    chord = away * float(np.sinc(0.5 * turn / math.pi))
    other = point + normal * 1j * chord * cmath.exp(0.5j * turn)
    return path, phi, path.start, Bows(other, normal * cmath.exp(1j * turn), np.array([kappa]))


@attack
@given(meetings())
def test_the_path_meets_what_passes_through_its_point(
    meeting: tuple[FollowerPath, float, float, Bows],
) -> None:
    path, phi, q, bows = meeting
    at = np.array([phi]), np.array([q])
    facing = np.sign((bows.unit_normals(path.point(*at)).conj() * path.along(*at)[0]).real)
    found = path.meet(at[0], bows, facing)
    # The point is known to 1e-14 mm or so; the tilt of 1.2 rad makes 1/cos = 3 of it.
    assert found[0] == pytest.approx(q, abs=1e-11)


@attack
@given(meetings())
def test_derivatives_by_mpmath(meeting: tuple[FollowerPath, float, float, Bows]) -> None:
    """Against the contact condition solved with 40 digits by a root finder, and differentiated."""
    path, phi, q, bows = meeting
    at = np.array([phi])
    facing = np.sign(
        (bows.unit_normals(path.point(at, np.array([q]))).conj() * path.along(at, np.array([q]))[0]
    ).real)  # fmt: skip
    jet = bows.lift_jet(path, at, path.meet(at, bows, facing))
    follower = path.follower
    a, n = mpmath.mpmathify(complex(bows.points[0])), mpmath.mpmathify(complex(bows.normals[0]))
    kappa = mpmath.mpf(float(bows.curvatures[0]))

    def centre(angle: mpmath.mpf, lift: mpmath.mpf) -> mpmath.mpc:
        turn = mpmath.expj(-path.rotation * angle)
        if isinstance(follower, TranslatingRoller):
            base, e = mpmath.mpf(follower.base_radius), mpmath.mpf(follower.offset)
            height = mpmath.sqrt(base**2 - e**2) + follower.direction * lift
            return mpmath.mpc(e, height) * mpmath.expj(follower.guide_angle) / 1j * turn
        l1, l3 = abs(mpmath.mpmathify(follower.pivot)), mpmath.mpf(follower.arm)
        start = mpmath.acos((l1**2 + l3**2 - mpmath.mpf(follower.base_radius) ** 2) / (2 * l1 * l3))
        chi = follower.arm_side * start + follower.swing_sense * lift
        pivot = mpmath.mpmathify(follower.pivot)
        return (pivot - pivot / l1 * l3 * mpmath.expj(chi)) * turn

    def lift_at(angle: mpmath.mpf) -> mpmath.mpf:
        def contact(lift: mpmath.mpf) -> mpmath.mpf:
            d = centre(angle, lift) - a
            return mpmath.re(mpmath.conj(n) * d) + kappa * abs(d) ** 2 / 2

        near = mpmath.mpf(float(jet[0, 0]))
        return mpmath.findroot(contact, (near, near + mpmath.mpf("1e-6")))

    with mpmath.workdps(40):
        middle = mpmath.mpf(phi)
        step = mpmath.mpf("1e-8")
        least, low, here, high, most = (lift_at(middle + k * step) for k in (-2, -1, 0, 1, 2))
        velocity = (high - low) / (2 * step)
        acceleration = (high - 2 * here + low) / step**2
        jerk = (most - 2 * high + 2 * low - least) / (2 * step**3)
    # The differences leave step^2 of higher derivatives, which grow with 1/cos^4 of the tilt.
    assume(abs(float(acceleration)) < 1e5)
    scale = 1.0 + abs(float(velocity)) + abs(float(acceleration))
    assert jet[0, 0] == pytest.approx(float(here), abs=1e-11)
    assert jet[1, 0] == pytest.approx(float(velocity), abs=1e-10 * scale)
    assert jet[2, 0] == pytest.approx(float(acceleration), abs=1e-9 * scale)
    scale += abs(float(jerk))
    assert jet[3, 0] == pytest.approx(float(jerk), abs=1e-8 * scale)


@pytest.mark.parametrize("follower", FOLLOWERS)
def test_a_touched_circle_is_touched(follower: TranslatingRoller | OscillatingRoller) -> None:
    """All places at which the path is tangent are named; others are tangent to the path's rest."""
    path = path_of(follower, 1)
    centre, radius = complex(45.0, 10.0), 8.0
    normal = one(cmath.exp(0.3j))
    bows = Bows(centre + radius * normal, normal, np.array([1.0 / radius]))
    places = path.touching(bows)[:, 0]
    places = places[np.isfinite(places)]
    points = np.concatenate([bows.evaluate(np.array([place])) for place in places])
    phi, q = path.cam_coordinates(points)
    across = ((points - centre) / radius).conj() * path.along(phi, q)[0]
    named = np.count_nonzero(np.abs(across.real) < 1e-10 * np.abs(across))
    # Where the cam angle turns back along the circle, found by dense points.
    ring = centre + radius * np.exp(1j * np.linspace(0.0, 2.0 * math.pi, 20001))
    turning = np.unwrap(path.cam_coordinates(ring)[0])
    turns = np.count_nonzero(np.diff(np.sign(np.diff(turning))))
    assert turns == named == 2
    assert len(places) == 4


def test_no_meeting_is_an_error() -> None:
    path = path_of(FOLLOWERS[0], 1)
    away = Bows(one(1000.0), one(1.0), np.array([1.0]))
    with pytest.raises(GeometryError, match="does not meet"):
        path.meet(np.zeros(1), away, np.ones(1))
    with pytest.raises(GeometryError, match="must lie at least 9 mm from the cam axis"):
        path.cam_coordinates(one(1.0))


@pytest.mark.parametrize("distance", [1e3, 1e6, 1e9])
@pytest.mark.parametrize("side", [1, -1])
def test_a_distant_pivot_costs_no_digits(distance: float, side: int) -> None:
    """Against W = l_3 exp(i chi) - l_1 with 50 digits; a line is met on both sides of the path."""
    pivot = cmath.rect(distance, 2.0)
    follower = OscillatingRoller(pivot, abs(pivot) + 7.0, 50.0, 6.0, side)
    path, phi = path_of(follower, 1), np.array([0.3, 1.7, 4.0])
    q = path.start + path.outward * np.array([0.0, 3.0, 17.0]) / distance
    found = path.point(phi, q)
    with mpmath.workdps(50):
        l1 = mpmath.hypot(pivot.real, pivot.imag)
        for at, angle, point in zip(q.tolist(), phi.tolist(), found.tolist(), strict=True):
            w = follower.arm * mpmath.expj(side * mpmath.mpf(at)) - l1
            exact = w * mpmath.expj(mpmath.arg(-mpmath.mpc(pivot)) - angle)
            assert abs(exact - point) <= 64 * 2.0**-53 * 50.0
    angles, again = path.cam_coordinates(found)
    assert angles == pytest.approx(phi, rel=64 * 2.0**-53)
    assert again == pytest.approx(q, rel=64 * 2.0**-53)
    along = path.along(phi, q)[0]
    bows = Bows(found, along / np.abs(along), np.zeros(3))
    assert path.meet(phi, bows, np.ones(3)) == pytest.approx(q, rel=64 * 2.0**-53)


@pytest.mark.parametrize("follower", FOLLOWERS)
def test_a_place_is_within_reach_up_to_its_rounding(
    follower: TranslatingRoller | OscillatingRoller,
) -> None:
    """At both ends of the reach, and a little beyond."""
    path = path_of(follower, 1)
    low, high = path.reach
    ends = [(low, -1.0, low)] if math.isinf(high) else [(low, -1.0, high), (high, 1.0, high)]
    for end, sign, size in ends:
        for share in (0.0, 0.9):
            angle, _ = path.cam_coordinates(one(end + sign * share * 1e-9 * size))
            assert 0.0 <= angle[0] < 2.0 * math.pi
        with pytest.raises(GeometryError, match="cannot reach that place"):
            path.cam_coordinates(one(end + sign * 1.1e-9 * size))


# Paths of flat faces ------------------------------------------------------------------------------

FACED: dict[str, FlatFollower] = {
    "guided": TranslatingFlat(40.0, 0.7, 1),
    "guided, inward": TranslatingFlat(35.0, -1.2, -1),
    "rocking": OscillatingFlat(-90.0 + 30.0j, 45.0, 6.0, 1, 1),
    "rocking, inward, other side": OscillatingFlat(80.0 - 20.0j, 40.0, -5.0, -1, -1),
    "rocking, through the pivot": OscillatingFlat(-70.0 - 40.0j, 45.0, 0.0, -1, 1),
}

CENTRES = np.array([6.0 + 3.0j, -4.0 + 9.0j, 0.5 - 7.0j])
RADII = np.array([33.0, 0.0, 41.0])

by_kind = pytest.mark.parametrize("name", FACED)
each_way = pytest.mark.parametrize("rotation", [1, -1])

TURNED = np.array([0.3, 1.9, 4.4])


def foot(follower: FlatFollower) -> complex:
    """From where places on the face are measured, but for what the face lies beyond it."""
    return follower.pivot if isinstance(follower, OscillatingFlat) else 0j


@by_kind
@each_way
def test_the_face_is_tangent_to_the_turned_circle(name: str, rotation: int) -> None:
    follower = FACED[name]
    path = face_path_of(follower, rotation)
    assert path.rotation == rotation
    lift, *derivatives = path.jet(TURNED, CENTRES, RADII)
    normal = follower.normal(lift)
    turned = CENTRES * np.exp(1j * rotation * TURNED)
    touch = turned + RADII * normal
    # Where the face is: square to its normal, as far from the axis or from the pivot as stated.
    seen = touch - foot(follower)
    height = (np.conj(normal) * seen).real
    if isinstance(follower, TranslatingFlat):
        expected = follower.base_radius + follower.direction * lift
    else:
        assert isinstance(follower, OscillatingFlat)
        expected = np.full(3, follower.face_offset)
    assert height == pytest.approx(expected, abs=1e-12 * 100.0)
    along = (np.conj(-1j * normal) * seen).real * follower.facing
    assert path.contact(TURNED, CENTRES, RADII) == pytest.approx(along, abs=1e-10)
    # The derivatives by central differences of the one before.
    h = 1e-5
    ahead, behind = (path.jet(TURNED + step, CENTRES, RADII) for step in (h, -h))
    for order, found in enumerate(derivatives):
        rate = (ahead[order] - behind[order]) / (2.0 * h)
        assert found == pytest.approx(rate, abs=1e-7 * (1.0 + float(np.max(np.abs(rate)))))


@by_kind
@each_way
def test_a_face_is_found_again_by_its_distance_and_its_normal(name: str, rotation: int) -> None:
    follower = FACED[name]
    path = face_path_of(follower, rotation)
    lift = path.jet(TURNED, CENTRES, RADII)[0]
    normal = follower.normal(lift)
    distance = (np.conj(normal) * (CENTRES * np.exp(1j * rotation * TURNED))).real + RADII
    assert path.lift(distance) == pytest.approx(lift, abs=1e-11)
    assert np.all(np.sign(path.lift(distance + 1e-3) - lift) == path.outward)
    theta = np.angle(normal) - rotation * TURNED
    found = path.cam_angles(theta, lift)
    assert np.exp(1j * (found - TURNED)) == pytest.approx(np.ones(3), abs=1e-12)
    # As continuous as theta: a turn of the normal is a turn of the cam, the other way round.
    turns = path.cam_angles(theta + 2.0 * math.pi, lift) - found
    assert turns == pytest.approx(np.full(3, -2.0 * math.pi * rotation), abs=1e-12)


@by_kind
@each_way
def test_the_contact_is_extreme_where_it_turns(name: str, rotation: int) -> None:
    """Its place has no slope there, and is the largest and the smallest of a turn."""
    path = face_path_of(FACED[name], rotation)
    all_round = np.linspace(0.0, 2.0 * math.pi, 2001)
    for centre, radius in zip(CENTRES, RADII, strict=True):
        places = path.turning(np.array([centre]))[:, 0]
        circle = np.full(len(all_round), centre), np.full(len(all_round), radius)
        dense = path.contact(all_round, *circle)
        there = path.contact(places, np.full(2, centre), np.full(2, radius))
        assert sorted(there) == pytest.approx([np.min(dense), np.max(dense)], abs=1e-4)
        assert min(there) <= np.min(dense) + 1e-12
        assert max(there) >= np.max(dense) - 1e-12


@pytest.mark.parametrize("name", ["guided", "rocking", "rocking, inward, other side"])
def test_the_contact_wanders_with_the_velocity_of_the_lift(name: str) -> None:
    """On a circle about the cam axis it is at rest; each velocity moves it as far as stated."""
    follower = FACED[name]
    path = face_path_of(follower, 1)
    # At rest at lift 0, and with a small velocity there.
    small = 1e-6
    jets = np.zeros((4, 2))
    jets[1] = (0.0, small)
    at = follower.touch(jets, 1)
    moved = abs(at.contact[0, 1] - at.contact[0, 0]) / small
    assert path.wander(follower.touch(jets[:, :1], 1))[0] == pytest.approx(moved, rel=1e-5)


def test_beyond_its_reach_a_rockers_face_is_nowhere() -> None:
    follower = FACED["rocking"]
    assert isinstance(follower, OscillatingFlat)
    path = face_path_of(follower, 1)
    reach = follower.farthest
    nearest = follower.face_offset - follower.centre_distance
    assert np.all(np.isfinite(path.lift(np.array([reach, max(nearest, 1.0)]))))
    with pytest.raises(GeometryError, match="cannot lie on the contour all round") as caught:
        path.lift(np.array([40.0, reach * (1.0 + 1e-9)]))
    assert f"needs it at 40 to {reach:.6g} mm" in caught.value.message
    assert f"it can be at {nearest:.6g} to {reach:.6g} mm" in caught.value.message
    far = path.contact(np.zeros(1), np.array([200.0 + 0j]), np.array([400.0]))
    assert np.isnan(far[0])
    with pytest.raises(
        GeometryError, match='flat-faced follower is needed here, and this one is of the kind "tra'
    ):
        face_path_of(TranslatingRoller(40.0, 6.0), 1)
