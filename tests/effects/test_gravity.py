"""Gravity on a guide, by hand; behind linkages test_pins has it."""

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


def force(made: Any) -> FloatArray:
    """(721,) c0 on the follower."""
    coefficients = made.effect("gravity").force.coefficients(PHI, "right")
    assert not np.any(coefficients[1:])
    found: FloatArray = coefficients[0]
    return found


FAST = (('rotation = "ccw"', 'rotation = "ccw"\nspeed = 60'),)  # for the ring, which has none
INWARD = (('direction = "outward"', 'direction = "inward"'),)


@pytest.mark.parametrize(
    ("scene", "changes", "angle", "expected"),
    [
        ("plate_translating", (), -90.0, -1.0),  # outward is up
        ("plate_translating", INWARD, -90.0, 1.0),
        ("plate_translating", (), 90.0, 1.0),
        ("plate_translating", (), 0.0, 0.0),
        ("plate_translating", (), -60.0, -math.sqrt(0.75)),
        ("ring", FAST, -90.0, 0.0),  # outward is to the right
        ("ring", FAST, 0.0, 1.0),
        ("ring", FAST, 180.0, -1.0),
    ],
)
def test_on_a_guide_the_share_along_it_counts(
    scene: str, changes: Any, angle: float, expected: float
) -> None:
    """Of 0.9 kg; 1 kg weighs 9.80665 N (3rd CGPM 1901)."""
    made = design(scene, f"{FOLLOWER}[effects.gravity]\nangle = {angle}\n", *changes)
    # The cosine of 90 degrees is 6e-17.
    assert force(made) == pytest.approx(np.full(721, 0.9 * 9.80665 * expected), abs=1e-14)
    weight = made.effect("gravity").findings[0]
    assert (weight.name, weight.unit) == ("weight", "N")
    assert weight.value == pytest.approx(0.9 * 9.80665, rel=4e-16)


def test_without_masses_nothing_weighs() -> None:
    made = design("groove", "[effects.inertia]\n[effects.gravity]\n")
    assert not np.any(force(made))
    assert [each.value for each in made.effect("gravity").findings] == [0.0, 0.0, 0.0]
