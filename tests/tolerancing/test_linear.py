"""Extremes of the linear analysis in closed form, at cam angles between those of its tables."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from tests.tolerancing.machines import FOLLOWERS, lifter

ROUNDING = 1e-12
"""Of a value, relative to it."""

FLAT = 1e-7
"""Of the place [rad] of a smooth extreme, near which values differ by less than rounding."""

GUIDE = FOLLOWERS["translating-flat"]["guide_angle"]


def test_a_stated_sigma_and_limits_to_one_side() -> None:
    linear = lifter(
        {"key": "follower.base_radius", "limits": [0.0, 0.06], "sigma": 0.02},
    )
    assert linear.worst.value == pytest.approx(-0.03 - 3.0 * 0.02)
    assert linear.mean[0] == pytest.approx(-0.03)


def test_an_eccentric_disc_errs_most_where_it_lies_along_the_guide() -> None:
    """Off by 0.4 and 0.3 mm, with any direction of the rest, it lifts a face by 0.5 mm at most.

    It lies against the lift atan(3/4) before it would if it were off along x, and the face's own
    zero makes that the larger error.
    """
    spread, zero = 0.03, 0.1
    linear = lifter(
        {"key": "mounting.x", "limits": [0.4 - spread, 0.4 + spread]},
        {"key": "mounting.y", "limits": [0.3 - spread, 0.3 + spread]},
        {"key": "follower.base_radius", "limits": [0.0, zero]},
    )
    worst = -(0.5 + 0.5 * zero + math.hypot(spread, 0.5 * zero))
    assert linear.worst.value == pytest.approx(worst, rel=ROUNDING)
    place = math.pi + math.radians(GUIDE) - math.atan2(0.3, 0.4)
    assert linear.worst.place == pytest.approx(place, abs=FLAT)
    assert np.min(linear.band[0]) > worst + 1e-6  # no angle of the tables has it


def test_a_disc_that_runs_ahead_errs_by_the_velocity() -> None:
    """That of polynomial 3-4-5 is largest halfway, 15/8 of the mean one."""
    stroke, span, plus_minus = 10.0, 85.0, 0.2
    motion: list[dict[str, Any]] = [
        {"dwell": 30},
        {"law": "polynomial-345", "span": span, "to": stroke},
        {"dwell": 45},
        {"law": "polynomial-345", "span": 130, "to": 0},
        {"dwell": 70},
    ]
    linear = lifter({"key": "mounting.angle", "plus_minus": plus_minus}, motion=motion)
    (found,) = linear.contributions
    fastest = 15.0 / 8.0 * stroke / math.radians(span)
    assert found.sensitivity.value == pytest.approx(fastest, rel=ROUNDING)
    assert found.sensitivity.place == pytest.approx(math.radians(30.0 + 0.5 * span), abs=FLAT)
    size = fastest * math.radians(plus_minus)
    for each in (found.spread.value, abs(linear.worst.value)):
        assert each == pytest.approx(size, rel=ROUNDING)


def test_no_wave_is_passed_over() -> None:
    """Set on a wave, a face errs by up to two of them: the same in all, and seen in the right one.

    At 250 degrees an eccentric disc is lowest, and the 198 waves have a crest.
    """
    height, off, spread = 1e-5, 0.01, 1e-5  # a flat face would not touch all of higher waves
    linear = lifter(
        {"key": "mounting.x", "limits": [off - spread, off + spread]},
        form=[{"plus_minus": height, "waves": 198}],
        set_at=0,
    )
    _, waves = linear.contributions
    assert waves.sensitivity.value == pytest.approx(2.0, rel=ROUNDING)
    assert (waves.mean.value, GUIDE) == (0.0, 70)
    fall = 1.0 + math.cos(math.radians(GUIDE))
    worst = -off * fall - math.hypot(spread * fall, 3.0 * 2.0 * height / math.sqrt(2.0))
    assert linear.worst.value == pytest.approx(worst, rel=ROUNDING)
    assert linear.worst.place == pytest.approx(math.radians(250), abs=FLAT)
