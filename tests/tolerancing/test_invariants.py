"""Deviations whose effect follows from geometry alone, and linkages computed in another way."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from camgeo.kinematics.mechanism.linkages import SliderCrank
from camgeo.numeric.arrays import ComplexArray
from camgeo.studies.tolerancing.linear import replay_machines
from camgeo.studies.tolerancing.stated import Deviations, Freedom, Sensitivities, machine_dimensions
from tests.tolerancing.machines import errors, fixture

SIZE = 0.4
"""[mm], far beyond any tolerance."""

TURNED = 0.01
"""[rad]."""


def together(nominal: Sensitivities, *keys: str) -> Deviations:
    """One machine with `SIZE` of each dimension."""
    known = machine_dimensions(nominal.machine)
    values: dict[Freedom, ComplexArray] = {}
    for key in keys:
        unit = known[key].unit
        earlier = values.get(unit.freedom, np.zeros(1, complex))
        values[unit.freedom] = earlier + SIZE * unit.factor
    return Deviations(1, values)


@pytest.mark.parametrize(
    ("name", "keys"),
    [
        ("shuttle", ("shaft.x", "follower.pivot[1]")),
        ("flat_rocker", ("shaft.y", "follower.pivot[2]")),
        ("four_bar", ("shaft.x", "follower.pivot[1]", "linkage.shaft[1]")),
    ],
)
def test_a_machine_that_is_displaced_as_a_whole_does_not_err(
    name: str, keys: tuple[str, ...]
) -> None:
    nominal = fixture(name)
    found = replay_machines(nominal, together(nominal, *keys)).position[0, 0]
    np.testing.assert_allclose(found, nominal.positions[0], rtol=0, atol=1e-12)
    part = replay_machines(nominal, together(nominal, *keys[1:])).position[0, 0]
    assert np.max(np.abs(part - nominal.positions[0])) > 1e-4


@pytest.mark.parametrize("name", ["setzhub", "tappet", "plate_translating", "crank_slider"])
def test_a_disc_that_runs_ahead_makes_the_motion_earlier(name: str) -> None:
    nominal = fixture(name)
    unit = machine_dimensions(nominal.machine)["mounting.angle"].unit
    plan = nominal.machine.cam.drive.plan
    expected = plan.jet(nominal.phi + TURNED)[0] - nominal.positions[0]
    (found,) = errors(nominal, unit, TURNED)
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-11)


@pytest.mark.parametrize("name", ["tappet", "plate_translating", "ring"])
def test_a_guide_that_is_turned_meets_the_cam_later_or_earlier(name: str) -> None:
    """Turned as the cam turns, it meets each place of it that much later."""
    nominal = fixture(name)
    unit = machine_dimensions(nominal.machine)["follower.guide_angle"].unit
    cam = nominal.machine.cam
    expected = cam.drive.plan.jet(nominal.phi - cam.rotation * TURNED)[0] - nominal.positions[0]
    (found,) = errors(nominal, unit, TURNED)
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-11)


@pytest.mark.parametrize("key", ["crank", "coupler"])
def test_a_slider_crank_of_another_size(key: str) -> None:
    """A linkage of that size on the same guide, at the slider's place, has the same crank angle.

    Its guide keeps its height e = l cos alpha, and the place X of the slider is counted from the
    shaft.
    """
    nominal = fixture("setzhub")
    linkage = nominal.machine.linkage
    assert isinstance(linkage, SliderCrank)
    longer = getattr(linkage, key) + SIZE
    crank = longer if key == "crank" else linkage.crank
    deflection = math.acos(linkage.guide_height / crank)
    other = replace(linkage, deflection=deflection, **{key: longer})
    (found,) = errors(nominal, machine_dimensions(nominal.machine)[f"linkage.{key}"].unit, SIZE)
    place, _ = linkage.pin(nominal.positions[0] + found)
    stroke = linkage.stroke_direction * (place - other.start_position)
    expected = linkage.crank_angle(nominal.positions[0])
    np.testing.assert_allclose(other.crank_angle(stroke), expected, rtol=0, atol=1e-12)
    assert np.max(np.abs(found)) > 0.01
