"""Global undercut as a condition on the place of the cam axis."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

import camgeo
from camgeo.check.judge import disc_findings
from camgeo.check.sizing.rounding import sound
from camgeo.check.sizing.smallest import size
from camgeo.check.sizing.task import TOUCHING, Task, covered, pairs_of, task_of
from camgeo.units import TURN
from tests.check.sizing_scenes import BENT, EASY, required

FOUND = Path(__file__).parents[2] / "fixtures" / "found" / "size_global_undercut.toml"
ANGLE, RATIO = math.radians(8.0), 0.7

LOCAL = complex(-5.57106515722, -14.69360434080)
"""The place with the smallest base circle, r_R/0.7, if only curvature matters."""


def lobe() -> Task:
    return task_of(camgeo.load(FOUND).cam)


@pytest.mark.parametrize("name", [*EASY, *BENT])
def test_a_pair_is_the_distance_of_roller_and_flank(name: str) -> None:
    task, _, _ = required(name)
    rng = np.random.default_rng(5)
    first, second = rng.uniform(0.0, TURN, (2, 200))
    for side in task.sides:
        disc = side.cam_at(side.present).disc
        for _, flank in disc.flanks:
            gap, _ = pairs_of(side, first, second, flank.distance).gap(np.array([side.present]))
            apart = np.abs(flank.point(first) - disc.pitch_curve.point(second))
            np.testing.assert_allclose(gap[0], apart - abs(flank.distance), rtol=0.0, atol=1e-11)


@pytest.mark.parametrize("name", BENT)
def test_a_pair_changes_no_faster_than_its_bound(name: str) -> None:
    task, _, _ = required(name)
    rng = np.random.default_rng(6)
    first, second = rng.uniform(0.0, TURN, (2, 300))
    pairs = pairs_of(task, first, second, task.cam.distances[0])
    for half in (0.01, 1.0, 20.0):
        gap, pace = pairs.gap(np.array([task.present]))
        bound = pairs.change(np.array([[half]]), pace)
        moves = half * np.exp(1j * rng.uniform(0.0, TURN, 50)) * rng.uniform(0.0, 1.0, 50)
        others, _ = pairs.gap(task.present + moves)
        assert np.all(np.abs(others - gap) <= bound + 1e-12)


def test_what_is_cut_off_is_found_at_its_deepest() -> None:
    task = lobe()
    found = covered(task, LOCAL)
    gap = found.gap(np.array([LOCAL]))[0][0]
    assert len(gap) > 1
    assert gap[0] == np.min(gap)
    # No point of the flank lies deeper in any roller, to within the width of the grid.
    disc = task.cam_at(LOCAL).disc
    around = np.linspace(0.0, TURN, 1500)
    flank, rollers = disc.inner_curve.point(around), disc.pitch_curve.point(around)
    dense = np.abs(flank[:, np.newaxis] - rollers) - disc.flank_distance
    assert gap[0] == pytest.approx(np.min(dense), abs=1e-2)
    assert gap[0] <= np.min(dense) + 1e-9


@pytest.mark.parametrize("name", ["plate_translating", "groove", "straight_moves"])
def test_nothing_is_found_where_nothing_is_cut_off(name: str) -> None:
    """Corners of the pitch curve, which every size has, do not count either."""
    task, _, _ = required(name)
    assert len(covered(task, task.present).first) == 0


def test_the_smallest_cam_is_not_cut_off() -> None:
    """15.7143 mm would keep r_R/r_K but lose 116.9 of 120 mm of the lift; 17.4184 mm are needed."""
    task, limits = lobe(), camgeo.load(FOUND).scene.limits
    lost = {each.name: each for each in disc_findings(task.cam_at(LOCAL), limits)}
    assert lost["lost-stroke-inner"].value == pytest.approx(116.9, abs=0.1)
    found = size(task, ANGLE, RATIO)
    assert found.answer is not None
    # The motion is its own mirror image, so the axis lies below the guide.
    assert found.answer.place.real == pytest.approx(0.0, abs=0.01)
    assert found.answer.base_radius == pytest.approx(17.418378, abs=1e-6)
    assert [each.name for each in found.active] == ["global-undercut"]
    assert found.none_below == pytest.approx(found.answer.base_radius, rel=2e-3)
    assert not found.exact
    # Without offset, touching sides follow from the pitch curve alone: its shortest chord that is
    # normal to it at both ends is as long as the roller is wide.
    below = -1j * found.answer.base_radius
    deep = covered(task, below * (1.0 - 1e-4))
    curve = task.pitch_curve_at(below)
    chord = abs(complex(np.diff(curve.point(np.array([deep.first[0], deep.second[0]])))[0]))
    assert chord == pytest.approx(2.0 * 11.0, abs=2e-3)
    for share in (1.0 - 1e-6, 0.95):
        for turn in (0.0, 0.02, -0.4):
            place = below * share * np.exp(1j * turn)
            assert not sound(task.cam_at(complex(place)), ANGLE, RATIO)
    assert sound(task.cam_at(below * (1.0 + 10.0 * TOUCHING)), ANGLE, RATIO)
