"""What the roller covers, and how near it comes to the axis, against brute force."""

from __future__ import annotations

import math
from dataclasses import replace
from decimal import Decimal

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from camgeo.geometry.outline.clearance import (
    are_clear,
    nearest_to_axis,
    stays_on_one_side,
    surely_clear_of_axis,
)
from camgeo.geometry.pitch_curve import PitchCurve
from camgeo.kinematics.mechanism.oscillating_roller import OscillatingRoller
from camgeo.kinematics.mechanism.translating_roller import TranslatingRoller
from camgeo.kinematics.plan import Dwell, MotionPlan, Move
from camgeo.numeric.arrays import ComplexArray, FloatArray
from camgeo.units import TURN
from tests.laws import LAWS
from tests.outline.clearing import distances
from tests.strategies import attack, pitch_curves, wild_pitch_curves

DENSE = np.linspace(0.0, TURN, 4001)

SURE = 2e-3
"""Distance [mm] up to which the samples do not decide: a step of 1.6e-3 rad on a path of up to
1,000 mm/rad passes a minimum by 0.8 mm, of which h^2 / 2 r is left at a distance r of 200 mm."""

CELL = TURN / 64.0
"""Width of the cells in which verdicts are sought first."""


def outside(pitch: PitchCurve, points: ComplexArray, owns: FloatArray) -> FloatArray:
    """(n,) smallest distance of each point from the pitch curve but in its own range."""
    phi = np.unique(np.concatenate((DENSE[:-1], pitch.borders)))
    start, end = owns.T
    away = np.minimum(
        np.abs(pitch.point(phi)[:, None] - points),
        np.abs(pitch.point(phi, "left")[:, None] - points),
    )
    away[(phi[:, None] - start) % TURN <= end - start] = np.inf
    ends = [np.abs(pitch.point(each % TURN) - points) for each in (start, end)]
    found: FloatArray = np.min(np.vstack((away, ends)), axis=0)
    return found


def ranges(rng: np.random.Generator, about: FloatArray) -> FloatArray:
    """(n, 2) own ranges: about the angle itself or anywhere, within a cell, of some cells that
    they share both ends with, of nearly all of the turn, and of less than nothing."""
    count = len(about)
    wide = rng.choice([1e-9, 0.02, CELL, 0.7, 3.0 * CELL, 3.0, TURN - 0.03, TURN - CELL], count)
    start = np.where(rng.random(count) < 0.6, about - rng.random(count) * wide, TURN * rng.random())
    start = np.where(rng.random(count) < 0.3, np.round(start / CELL) * CELL, start) % TURN
    return np.column_stack((start, start + wide))


@attack
@given(pitch=wild_pitch_curves(), seed=st.integers(0, 2**32 - 1))
def test_covered_is_what_is_nearer_to_the_path_of_the_centre(pitch: PitchCurve, seed: int) -> None:
    rng = np.random.default_rng(seed)
    about = TURN * rng.random(80)
    radius = pitch.follower.roller_radius
    beside = radius * (1.0 + rng.choice([-0.3, -0.02, -1e-3, 1e-3, 0.02, 0.3, 2.0], 80))
    points = pitch.point(about) + beside * np.exp(1j * TURN * rng.random(80))
    owns = ranges(rng, about)
    nearest = outside(pitch, points, owns)
    found = are_clear(pitch, points, radius, owns)
    sure = np.abs(nearest - radius) > SURE
    assert np.array_equal(found[sure], nearest[sure] > radius)


@pytest.mark.parametrize("start", [0.0, 1.0, 6.2])
def test_a_billionth_of_the_radius_within_it_is_covered(start: float) -> None:
    """Half as much is rounding; the centre runs on a circle of 40 mm."""
    pitch = PitchCurve(MotionPlan((Dwell(Decimal(360)),)), TranslatingRoller(40.0, 8.0), 1)
    away = 8.0 * (1.0 - 1e-9 * np.array([2.0, 1.1, 0.9, 0.5, 0.0, -1.0]))
    points = np.concatenate((40.0 - away, 40.0 + away)) * np.exp(0.7j)
    nowhere = np.tile([start, start + 1e-12], (12, 1))
    expected = [False, False, True, True, True, True] * 2
    assert are_clear(pitch, points, 8.0, nowhere).tolist() == expected
    # As the cam turns, that is at 0.7 rad before the start of the guide.
    there = (math.pi / 2.0 - 0.7) % TURN
    everywhere = np.tile([(there - 0.5) % TURN, (there - 0.5) % TURN + 1.0], (12, 1))
    assert np.all(are_clear(pitch, points, 8.0, everywhere))


@attack
@given(pitch=pitch_curves())
def test_the_centre_is_nearest_to_the_axis_where_it_says(pitch: PitchCurve) -> None:
    nearest, phi = nearest_to_axis(pitch)
    assert nearest == pytest.approx(float(distances(pitch, np.zeros(1, np.complex128))[0]))
    assert abs(pitch.point(np.array([phi]))[0]) == pytest.approx(nearest, rel=1e-12)
    assert 0.0 <= phi < TURN
    # A bound over cells is no more than that, and not much less where the motion is mild.
    assert not surely_clear_of_axis(pitch, nearest)
    assert surely_clear_of_axis(pitch, 0.6 * nearest)


def test_a_centre_that_is_slow_but_far_from_the_axis_is_surely_clear_of_it() -> None:
    """On a guide 40 mm beside the axis, of which the move takes most: |Z'| falls below 32 mm."""
    half = Decimal(180)
    law = LAWS["polynomial-345"]
    plan = MotionPlan((Move(half, 60.0, law), Move(half, 0.0, law)))
    for rotation in (1, -1):
        pitch = PitchCurve(plan, TranslatingRoller(50.0, 5.0, offset=40.0), rotation)
        assert float(np.min(np.abs(pitch.jet(DENSE)[1]))) < 45.0
        assert surely_clear_of_axis(pitch, 45.0)


TO_LINE = math.radians(20.0)
"""Swing that brings the rocker onto the line of centres."""


@pytest.mark.parametrize("side", [1, -1])
@pytest.mark.parametrize("law", ["polynomial-345", "simple-sine"])
@pytest.mark.parametrize(
    ("swing", "stays"),
    [(0.1, True), (TO_LINE - 1e-9, True), (TO_LINE + 1e-9, False), (1.2, False), (-1.2, True)],
)
def test_a_rocker_stays_on_one_side_until_it_reaches_the_line_of_centres(
    swing: float, stays: bool, law: str, side: int
) -> None:
    third = Decimal(120)
    base = math.sqrt(100.0**2 + 60.0**2 - 2.0 * 100.0 * 60.0 * math.cos(TO_LINE))
    for direction in (1, -1):
        to = -direction * swing
        plan = MotionPlan((Dwell(third), Move(third, to, LAWS[law]), Move(third, 0.0, LAWS[law])))
        rocker = OscillatingRoller(100.0 + 0.0j, 60.0, base, 5.0, side, direction)
        for rotation in (1, -1):
            assert stays_on_one_side(PitchCurve(plan, rocker, rotation)) == stays


@pytest.mark.parametrize(("stroke", "stays"), [(39.999999, True), (40.000001, False)])
def test_a_guided_follower_stays_above_the_foot_of_its_guide(stroke: float, stays: bool) -> None:
    half = Decimal(180)
    plan = MotionPlan(
        (Move(half, stroke, LAWS["simple-sine"]), Move(half, 0.0, LAWS["simple-sine"]))
    )
    follower = TranslatingRoller(50.0, 5.0, offset=30.0, direction=-1)
    assert stays_on_one_side(PitchCurve(plan, follower, 1)) == stays
    assert stays_on_one_side(PitchCurve(plan, replace(follower, direction=1), 1))


def test_a_point_beside_the_centre_of_a_rest_is_decided_in_few_cells(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """The roller centre goes round it at a distance that hardly changes: |Z'| says nothing."""
    plan = MotionPlan((Dwell(Decimal(360)),))
    monkeypatch.setattr("camgeo.geometry.pieces.MOST", 1000)
    off = 1e-6
    pitch = PitchCurve(plan, TranslatingRoller(10.0, 9.0), 1)
    own = np.array([[0.0, 1e-3]])
    # It is 10 mm -+ off from the roller centre.
    for radius, clear in ((10.0 - 1.1 * off, True), (10.0 - 0.9 * off, False)):
        assert are_clear(pitch, np.array([off + 0j]), radius, own)[0] == clear
