"""Undercut is found even where the known extremes of the curvature do not show it; what the roller
covers, and how near it comes to the axis, against brute force."""

from __future__ import annotations

import math
from dataclasses import replace
from decimal import Decimal
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import camgeo
from camgeo.errors import GeometryError
from camgeo.geometry.outline.outline import are_clear, backward_angles, sure_bends, undercut_ranges
from camgeo.geometry.pieces import (
    Extremes,
    curvature_extremes,
    nearest_to_axis,
    stays_on_one_side,
    surely_clear_of_axis,
)
from camgeo.geometry.pitch_curve import PitchCurve, WorkingCurve
from camgeo.kinematics.mechanism.rollers import OscillatingRoller, TranslatingRoller
from camgeo.kinematics.plan import Dwell, MotionPlan, Move
from camgeo.numeric.arrays import ComplexArray, FloatArray, frozen
from camgeo.units import TURN
from tests.draws.trimmed import drawn, miss
from tests.laws import LAWS
from tests.outline.clearing import distances
from tests.reference import hard_case, inner_of, pitch_curve_of
from tests.strategies import attack, pitch_curves, signs, wild_pitch_curves


def ends_only(bends: Extremes, curve: PitchCurve) -> Extremes:
    """The extremes, reduced to those at breaks."""
    kept = np.isin(np.mod(bends.phi, 2.0 * math.pi), np.mod(curve.breaks, 2.0 * math.pi))
    kept[[0, -1]] = True
    return Extremes(frozen(bends.phi[kept], np.float64), frozen(bends.values[kept], np.float64))


@pytest.mark.parametrize("case", ["HC21b", "HC21c"])
def test_a_missed_extreme_is_found(case: str) -> None:
    """Of HC21b's loop of 0.029 degrees not one sample of 257 a piece need be inside."""
    params, expected = hard_case(case)
    flank = inner_of(pitch_curve_of({"kappa": 1, **params}))
    blind = ends_only(curvature_extremes(flank.pitch), flank.pitch)
    assert undercut_ranges(flank, blind) == [], "the extremes left do not show the loop"
    ((start, end),) = undercut_ranges(flank, sure_bends(flank, blind))
    assert math.degrees(start) == pytest.approx(float(expected["cusp1_phi_deg"]), abs=1e-9)
    assert math.degrees(end) == pytest.approx(float(expected["cusp2_phi_deg"]), abs=1e-9)


@attack
@given(wild_pitch_curves(), signs())
def test_blind_to_all_extremes_it_finds_the_same_ranges(pitch: PitchCurve, side: int) -> None:
    flank = WorkingCurve(pitch, side * pitch.follower.roller_radius)
    try:
        bends = curvature_extremes(pitch)
        seen = undercut_ranges(flank, bends)
        found = undercut_ranges(flank, sure_bends(flank, ends_only(bends, pitch)))
    except GeometryError:  # Z' = 0
        return
    margins = 1.0 + flank.distance * bends.values
    if np.min(np.abs(margins)) < 1e-6:
        return  # a range that only just is one may be found or not
    assert len(found) == len(seen)
    for one, other in zip(sorted(found), sorted(seen), strict=True):
        assert one == pytest.approx(other, abs=1e-9)


TABLE = """
camgeo = 1
name = "noisy"
[cam]
rotation = "cw"
[follower]
{follower}
base_radius = 45
[[motion]]
law = "table"
span = 360
file = "lift.csv"
[output]
formats = ["csv"]
"""


def noisy(folder: Path, follower: str, step: float, noise: float) -> PitchCurve:
    """The pitch curve of a table with rows every `step` degrees that are off by `noise` mm."""
    phi = np.arange(0.0, 360.0, step)
    lift = 10.0 * (1.0 - np.cos(np.radians(phi)))
    lift += np.random.default_rng(39).normal(0.0, noise, len(phi))
    rows = zip([*phi, 360.0], [*lift, lift[0]] - np.min(lift), strict=True)
    (folder / "lift.csv").write_text("".join(f"{a:.6g},{s:.9f}\n" for a, s in rows), "utf-8")
    (folder / "s.toml").write_text(TABLE.format(follower=follower), "utf-8")
    return camgeo.load(folder / "s.toml").cam.disc.pitch_curve


def ranges_of(negative: np.ndarray) -> int:
    return int(np.count_nonzero(negative & ~np.roll(negative, 1)))


DENSE = np.linspace(0.0, TURN, 360_001)[:-1]


def inside(ranges: list[tuple[float, float]]) -> np.ndarray:
    """(n,) which of `DENSE` are inside."""
    found = np.zeros(len(DENSE), dtype=np.bool_)
    for start, end in ranges:
        found |= (DENSE - start) % TURN < (end - start) % TURN
    return found


@pytest.mark.parametrize("step", [0.5, 1.0])
def test_every_range_of_a_noisy_table_is_found(step: float, tmp_path: Path) -> None:
    """A hundred ranges of undercut, of which the known extremes show none."""
    kind = 'kind = "translating-roller"\nroller_radius = 14'
    pitch = noisy(tmp_path, kind, step, 8e-3 * step**2)
    flank = WorkingCurve(pitch, -14.0)
    blind = ends_only(curvature_extremes(pitch), pitch)
    found = undercut_ranges(flank, sure_bends(flank, blind))
    undercut = 1.0 - 14.0 * pitch.curvature(DENSE) < 0.0
    assert len(found) == ranges_of(undercut) > 10
    assert np.array_equal(inside(found), undercut)


def test_every_range_in_which_a_face_turns_back_is_found(tmp_path: Path) -> None:
    pitch = noisy(tmp_path, 'kind = "translating-flat"', 1.0, 5e-3)
    found = backward_angles(pitch, 1.0)
    lift = pitch.motion.jet(DENSE)
    back = 45.0 + lift[0] + lift[2] < 0.0
    assert len(found) == ranges_of(back) > 80
    assert np.array_equal(inside(found), back)


@pytest.mark.parametrize("number", [5, 7, 22, 23, 77])
def test_what_remains_of_a_noisy_table_is_clear_of_the_follower(
    number: int, tmp_path: Path
) -> None:
    """Drawn cases in which ranges of undercut, or their crossings, were once lost."""
    assert miss(*drawn(np.random.default_rng([7, number]), tmp_path)) == ""


ROUND = np.linspace(0.0, TURN, 4001)


SURE = 2e-3
"""Distance [mm] up to which the samples do not decide: a step of 1.6e-3 rad on a path of up to
1,000 mm/rad passes a minimum by 0.8 mm, of which h^2 / 2 r is left at a distance r of 200 mm."""


CELL = TURN / 64.0
"""Width of the cells in which verdicts are sought first."""


def outside(pitch: PitchCurve, points: ComplexArray, owns: FloatArray) -> FloatArray:
    """(n,) smallest distance of each point from the pitch curve but in its own range."""
    phi = np.unique(np.concatenate((ROUND[:-1], pitch.borders)))
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
        assert float(np.min(np.abs(pitch.jet(ROUND)[1]))) < 45.0
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
