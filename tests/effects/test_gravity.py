"""Gravity: weights by hand, potential energy compared with force, and no work over a turn."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from camgeo.numeric.arrays import FloatArray
from camgeo.units import TURN
from tests.effects.scenes import design

PHI = np.linspace(0.0, TURN, 721)

FOLLOWER = "[effects.inertia]\nmass = 0.8\nroller_mass = 0.1\n"
SPEED = ('rotation = "ccw"', 'rotation = "ccw"\nspeed = 60')  # for the ring, which has none
MIRRORED = (
    ("mirrored = false", "mirrored = true"),
    ('direction = "inward"', 'direction = "outward"'),
)


def force(made: Any) -> FloatArray:
    """(721,) c0 on the follower."""
    coefficients = made.effect("gravity").force.coefficients(PHI, "right")
    assert not np.any(coefficients[1:])
    found: FloatArray = coefficients[0]
    return found


def test_the_weight_of_a_mass_is_that_of_the_standard() -> None:
    """1 kg weighs 9.80665 N (3rd CGPM 1901)."""
    made = design("plate_translating", "[effects.inertia]\nmass = 1\n[effects.gravity]\n")
    weight = made.effect("gravity").findings[0]
    assert (weight.name, weight.unit) == ("weight", "N")
    assert weight.value == pytest.approx(9.80665, rel=1e-15)


@pytest.mark.parametrize(
    ("scene", "angle", "expected"),
    [
        ("plate_translating", -90.0, -1.0),  # outward is up
        ("plate_translating", 90.0, 1.0),
        ("plate_translating", 0.0, 0.0),
        ("plate_translating", -60.0, -math.sqrt(0.75)),
        ("ring", -90.0, 0.0),  # outward is to the right
        ("ring", 0.0, 1.0),
        ("ring", 180.0, -1.0),
    ],
)
def test_on_a_guide_the_share_along_it_counts(scene: str, angle: float, expected: float) -> None:
    changes = (SPEED,) if scene == "ring" else ()
    made = design(scene, f"{FOLLOWER}[effects.gravity]\nangle = {angle}\n", *changes)
    # 0.9 kg; the cosine of 90 degrees is 6e-17.
    assert force(made) == pytest.approx(np.full(721, 0.9 * 9.80665 * expected), abs=1e-14)


def test_a_lift_inward_falls_where_one_outward_rises() -> None:
    inward = ('direction = "outward"', 'direction = "inward"')
    made = design("plate_translating", f"{FOLLOWER}[effects.gravity]\n", inward)
    assert force(made) == pytest.approx(np.full(721, 0.9 * 9.80665), rel=1e-14)


@pytest.mark.parametrize(("changes", "sense"), [((), 1.0), (MIRRORED, -1.0)])
def test_a_slider_falls_along_the_x_axis(changes: Any, sense: float) -> None:
    """setzhub: a positive stroke moves the slider to the right, mirrored to the left. A pull to the
    right does the work m g s; one downwards none."""
    text = "[effects.inertia]\nmass = 2\n[effects.gravity]\nangle = {}\n"
    made = design("setzhub", text.format(0), *changes)
    swing, stroke = made.cam.drive.motion.jet(PHI), made.cam.drive.plan.jet(PHI)
    work = sense * 2.0 * 9.80665 * stroke[1]
    assert force(made) * swing[1] == pytest.approx(work, abs=1e-12 * np.max(np.abs(work)))
    # cos(-90 deg) rounds to 6e-17 times 2 kg.
    assert np.max(np.abs(force(design("setzhub", text.format(-90), *changes)))) < 1e-12


def test_without_masses_nothing_weighs() -> None:
    made = design("groove", "[effects.inertia]\n[effects.gravity]\n")
    assert not np.any(force(made))
    assert [each.value for each in made.effect("gravity").findings] == [0.0, 0.0, 0.0]
