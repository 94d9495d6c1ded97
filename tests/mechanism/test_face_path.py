"""A flat face on a circle of the cam: tangent to it from outside, at every cam angle."""

from __future__ import annotations

import math

import numpy as np
import pytest

from camgeo.errors import GeometryError
from camgeo.geometry.outline.face import face_path_of
from camgeo.kinematics.mechanism.face import FlatFollower
from camgeo.kinematics.mechanism.oscillating_flat import OscillatingFlat
from camgeo.kinematics.mechanism.translating_flat import TranslatingFlat
from camgeo.kinematics.mechanism.translating_roller import TranslatingRoller

FOLLOWERS: dict[str, FlatFollower] = {
    "guided": TranslatingFlat(40.0, 0.7, 1),
    "guided, inward": TranslatingFlat(35.0, -1.2, -1),
    "rocking": OscillatingFlat(-90.0 + 30.0j, 45.0, 6.0, 1, 1),
    "rocking, inward, other side": OscillatingFlat(80.0 - 20.0j, 40.0, -5.0, -1, -1),
    "rocking, through the pivot": OscillatingFlat(-70.0 - 40.0j, 45.0, 0.0, -1, 1),
}

CENTRES = np.array([6.0 + 3.0j, -4.0 + 9.0j, 0.5 - 7.0j])
RADII = np.array([33.0, 0.0, 41.0])

by_kind = pytest.mark.parametrize("name", FOLLOWERS)
each_way = pytest.mark.parametrize("rotation", [1, -1])

PHI = np.array([0.3, 1.9, 4.4])


def foot(follower: FlatFollower) -> complex:
    """From where places on the face are measured, but for what the face lies beyond it."""
    return follower.pivot if isinstance(follower, OscillatingFlat) else 0j


@by_kind
@each_way
def test_the_face_is_tangent_to_the_turned_circle(name: str, rotation: int) -> None:
    follower = FOLLOWERS[name]
    path = face_path_of(follower, rotation)
    assert path.rotation == rotation
    lift, *derivatives = path.jet(PHI, CENTRES, RADII)
    normal = follower.normal(lift)
    turned = CENTRES * np.exp(1j * rotation * PHI)
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
    assert path.contact(PHI, CENTRES, RADII) == pytest.approx(along, abs=1e-10)
    # The derivatives by central differences of the one before.
    h = 1e-5
    ahead, behind = (path.jet(PHI + step, CENTRES, RADII) for step in (h, -h))
    for order, found in enumerate(derivatives):
        rate = (ahead[order] - behind[order]) / (2.0 * h)
        assert found == pytest.approx(rate, abs=1e-7 * (1.0 + float(np.max(np.abs(rate)))))


@by_kind
@each_way
def test_a_face_is_found_again_by_its_distance_and_its_normal(name: str, rotation: int) -> None:
    follower = FOLLOWERS[name]
    path = face_path_of(follower, rotation)
    lift = path.jet(PHI, CENTRES, RADII)[0]
    normal = follower.normal(lift)
    distance = (np.conj(normal) * (CENTRES * np.exp(1j * rotation * PHI))).real + RADII
    assert path.lift_of(distance) == pytest.approx(lift, abs=1e-11)
    assert np.all(np.sign(path.lift_of(distance + 1e-3) - lift) == path.outward)
    theta = np.angle(normal) - rotation * PHI
    found = path.angle_of(theta, lift)
    assert np.exp(1j * (found - PHI)) == pytest.approx(np.ones(3), abs=1e-12)
    # As continuous as theta: a turn of the normal is a turn of the cam, the other way round.
    turns = path.angle_of(theta + 2.0 * math.pi, lift) - found
    assert turns == pytest.approx(np.full(3, -2.0 * math.pi * rotation), abs=1e-12)


@by_kind
@each_way
def test_the_contact_is_extreme_where_it_turns(name: str, rotation: int) -> None:
    """Its place has no slope there, and is the largest and the smallest of a turn."""
    path = face_path_of(FOLLOWERS[name], rotation)
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
    follower = FOLLOWERS[name]
    path = face_path_of(follower, 1)
    # At rest at lift 0, and with a small velocity there.
    small = 1e-6
    jets = np.zeros((4, 2))
    jets[1] = (0.0, small)
    at = follower.touch(jets, 1)
    moved = abs(at.contact[0, 1] - at.contact[0, 0]) / small
    assert path.wander(follower.touch(jets[:, :1], 1))[0] == pytest.approx(moved, rel=1e-5)


def test_beyond_its_reach_a_rockers_face_is_nowhere() -> None:
    follower = FOLLOWERS["rocking"]
    assert isinstance(follower, OscillatingFlat)
    path = face_path_of(follower, 1)
    reach = follower.farthest
    nearest = follower.face_offset - follower.centre_distance
    assert np.all(np.isfinite(path.lift_of(np.array([reach, max(nearest, 1.0)]))))
    with pytest.raises(GeometryError, match="cannot lie on the contour all round") as caught:
        path.lift_of(np.array([40.0, reach * (1.0 + 1e-9)]))
    assert f"reaches from 40 to {reach:.6g} mm" in caught.value.message
    assert f"the face from {nearest:.6g} to {reach:.6g} mm" in caught.value.message
    far = path.contact(np.zeros(1), np.array([200.0 + 0j]), np.array([400.0]))
    assert np.isnan(far[0])
    with pytest.raises(GeometryError, match='needs a flat-faced follower, and this one is "tra'):
        face_path_of(TranslatingRoller(40.0, 6.0), 1)
