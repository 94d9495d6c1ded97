"""A round disc on a bore that is off its middle, in closed form for each kind of follower.

The disc is a circle of the radius R about C, which turns about the cam axis with C = E exp(i sigma
phi). Elementary geometry gives the lift; nothing of camgeo computes here.
"""

from __future__ import annotations

import cmath
import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from camgeo.kinematics.mechanism.declared.registry import FOLLOWERS as KINDS
from camgeo.studies.tolerancing.linear import replay_machines
from camgeo.studies.tolerancing.stated import Deviations, Freedom, Way, machine_dimensions
from tests.long_form import examples
from tests.tolerancing.machines import FOLLOWERS, ROUND, errors, round_cam, turned

Array = np.ndarray[Any, Any]


def on_guide(follower: dict[str, Any], centre: Array, radius: float) -> Array:
    """Height of a roller's centre on its guide."""
    local = centre * cmath.exp(1j * np.radians(90 - follower["guide_angle"]))
    return np.asarray(local.imag + np.sqrt(radius**2 - (follower["offset"] - local.real) ** 2))


def on_arm(follower: dict[str, Any], centre: Array, radius: float) -> Array:
    """Angle of an arm from its pivot, counter-clockwise, by the law of cosines."""
    to_centre = centre - complex(*follower["pivot"])
    arm, away = follower["arm"], np.abs(to_centre)
    angle = np.arccos((arm**2 + away**2 - radius**2) / (2.0 * arm * away))
    return np.asarray(np.angle(to_centre) - angle)


def under_face(follower: dict[str, Any], centre: Array, radius: float) -> Array:
    """Height of a face square to its guide."""
    along = centre * cmath.exp(-1j * np.radians(follower["guide_angle"]))
    return np.asarray(along.real + radius)


def under_rocker(follower: dict[str, Any], centre: Array, radius: float) -> Array:
    """Angle of a face that is tangent, `face_offset` beyond its pivot."""
    to_centre = centre - complex(*follower["pivot"])
    rest = np.arcsin((radius - follower["face_offset"]) / np.abs(to_centre))
    return np.asarray(np.angle(to_centre) - rest)


CLOSED = {
    "translating-roller": (on_guide, 1),
    "oscillating-roller": (on_arm, -1),
    "translating-flat": (under_face, 1),
    "oscillating-flat": (under_rocker, -1),
}
"""The position, and its sign in the lift: rockers with their arm clockwise swing so outward."""


def test_there_is_a_closed_form_of_each_kind() -> None:
    assert set(CLOSED) == set(FOLLOWERS) == set(KINDS)


@pytest.mark.parametrize("kind", KINDS)
@given(
    size=st.floats(0.0, 3.0),
    phase=st.floats(-math.pi, math.pi),
    grown=st.floats(-1.0, 1.0),
)
@settings(max_examples=examples(8, long=200))
def test_the_exact_motion(kind: str, size: float, phase: float, grown: float) -> None:
    """To rounding, with a clearance, a larger roller or a flank with stock on it as well."""
    nominal = round_cam(kind)
    position, sign = CLOSED[kind]
    rest = position(FOLLOWERS[kind], np.zeros(1, complex), ROUND)
    place = cmath.rect(size, phase)
    values = {
        Freedom(Way.SEAT): np.array([place]),
        Freedom(Way.GROWTH): np.array([complex(grown)]),
    }
    found = replay_machines(nominal, Deviations(1, values)).position[0, 0]
    middle = turned(place, nominal)
    expected = sign * (position(FOLLOWERS[kind], middle, ROUND + grown) - rest)
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-12)


def test_a_larger_roller_on_an_outer_flank_lies_farther_inward() -> None:
    """Inside a round hole, by its excess along the normal."""
    kind, size = "translating-roller", 0.3
    nominal = round_cam(kind, {"contact": "outer"}, part={"rim": 160, "thickness": 8})
    unit = machine_dimensions(nominal.machine)["follower.roller_radius"].unit
    here, there = (
        on_guide(FOLLOWERS[kind], np.zeros(1, complex), ROUND - less) for less in (0.0, size)
    )
    (found,) = errors(nominal, unit, size)
    np.testing.assert_allclose(found, float(there[0] - here[0]), rtol=0, atol=1e-12)


def test_a_shaft_that_is_displaced_is_a_bore_that_does_not_turn() -> None:
    """Of a face: the height of the cam axis along the guide, at every cam angle."""
    nominal = round_cam("translating-flat")
    known = machine_dimensions(nominal.machine)
    (found,) = errors(nominal, known["shaft.y"].unit, 0.25)
    np.testing.assert_allclose(found, 0.25 * np.sin(np.radians(70)), rtol=0, atol=1e-14)
