"""Distances of paths from the cam axis, and whether they go round it, from dense points."""

from __future__ import annotations

import cmath
import math
from pathlib import Path as File

import numpy as np
import pytest

import camgeo
from camgeo.geometry.outline.crossings import find_crossings
from camgeo.geometry.outline.outline import real_outline
from camgeo.geometry.outline.path import Path, Pivot, encloses_axis, radii
from camgeo.geometry.pitch_curve import PitchCurve
from camgeo.geometry.working_curve import WorkingCurve
from camgeo.kinematics.mechanism.translating_roller import TranslatingRoller
from camgeo.kinematics.plan import MotionPlan
from tests.contour.cams import dwell, move
from tests.contour.paths import PATHS, dense_path, hard_curve
from tests.outline.clearing import dense

SCENES = File(__file__).parents[2] / "fixtures" / "scenes"


def scene_paths() -> dict[str, Path]:
    """Outlines of guides and rockers, with pieces that are cut off, and parallels outside them."""
    found: dict[str, Path] = {}
    for scene in ("schnitt", "cut_lobe", "straight_moves", "points", "crank_slider"):
        path = camgeo.load(SCENES / f"{scene}.toml").cam.disc.outline("inner").path
        found |= {scene: path, f"{scene} by 3 mm": path.offset(3.0)}
    return found


@pytest.mark.parametrize("path", [*PATHS.values(), *scene_paths().values()],
                         ids=[*PATHS, *scene_paths()])  # fmt: skip
def test_no_point_is_nearer_or_farther(path: Path) -> None:
    made = path() if callable(path) else path
    found, points = radii(made), np.abs(dense_path(made, 20_000))
    # Dense points are 0.02 mm apart: of a bend of 10 mm at an extreme 5e-6 mm are left out.
    assert found.lowest.value == pytest.approx(float(np.min(points)), abs=2e-5)
    assert found.highest.value == pytest.approx(float(np.max(points)), abs=2e-5)
    assert found.lowest.value <= np.min(points) + 1e-9
    assert found.highest.value >= np.max(points) - 1e-9
    assert encloses_axis(made)
    for end in (found.lowest, found.highest):
        assert 0.0 <= end.place < 2.0 * math.pi


@pytest.mark.parametrize("centre", [0j, 30.0 - 12.0j, 3.0 + 1.0j, 9.999j, 10.001j])
@pytest.mark.parametrize("sense", [1.0, -1.0])
def test_a_ring_of_arcs(centre: complex, sense: float) -> None:
    """Three arcs of a circle of 10 mm: round the axis if that is nearer to its centre, however near
    it is to the circle.
    """
    sweeps = sense * np.array([1.0, 2.5, 2.0 * math.pi - 3.5])
    starts = 0.4 + np.concatenate(([0.0], np.cumsum(sweeps)[:-1]))
    path = Path(
        tuple(
            Pivot(centre, 10.0, cmath.exp(1j * float(start)), float(sweep), 0.0, 0.0)
            for start, sweep in zip(starts, sweeps, strict=True)
        )
    )
    found = radii(path)
    away = abs(centre)
    assert found.lowest.value == pytest.approx(abs(10.0 - away), abs=1e-12)
    assert found.highest.value == pytest.approx(10.0 + away, abs=1e-12)
    assert encloses_axis(path) == (away < 10.0)


def test_an_arc_that_does_not_reach_the_line_through_its_centre_is_extreme_at_its_ends() -> None:
    for start, sweep in ((0.3, 1.0), (2.0, -0.9), (-2.0, 1.2)):
        arc = Pivot(20.0 + 0j, 5.0, cmath.exp(1j * start), sweep, 0.0, 0.0)
        ends = sorted((abs(arc.start), abs(arc.end)))
        found = radii(Path((arc,)))
        assert [found.lowest.value, found.highest.value] == pytest.approx(ends, abs=1e-12)


def test_a_lobe_that_falls_away_does_not_go_round_the_axis() -> None:
    outline = real_outline(hard_curve("HC22"))
    assert encloses_axis(outline.path)
    (lobe,) = outline.lobes
    assert not encloses_axis(lobe)
    points = np.abs(dense(lobe, 4001))
    assert radii(lobe).highest.value == pytest.approx(float(np.max(points)), abs=1e-3)


def test_a_flank_that_lies_on_itself_is_not_decided() -> None:
    """Rests at 40 and 60 mm half a turn apart: 50 mm inside of both lies the same arc of 10 mm."""
    plan = MotionPlan((dwell(60), move(120, 20.0), dwell(60), move(120, 0.0)))
    pitch = PitchCurve(plan, TranslatingRoller(40.0, 5.0), 1)
    with pytest.raises(camgeo.CamgeoError, match=r"lie on each other|too close to be separated"):
        find_crossings(WorkingCurve(pitch, -50.0))
    found = find_crossings(WorkingCurve(pitch, -49.0))
    assert found
    for crossing in found:
        ends = WorkingCurve(pitch, -49.0).point(np.array([crossing.first, crossing.second]))
        assert np.max(np.abs(ends - crossing.point)) <= 1e-10


def test_a_parallel_that_runs_back_all_round_does_not_cross_itself() -> None:
    pitch = PitchCurve(MotionPlan((dwell(360),)), TranslatingRoller(10.0, 5.0), 1)
    assert find_crossings(WorkingCurve(pitch, -12.0)) == ()
