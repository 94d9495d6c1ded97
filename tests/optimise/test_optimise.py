"""Optima of real scenes: against `camgeo size`, against a grid, and where there is none."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import astuple, replace
from multiprocessing import active_children

import pytest

from camgeo import loads
from camgeo.app.answers.size import size
from camgeo.design.design import Design
from camgeo.scene.scene import load_scene
from camgeo.studies.optimise.optimise import DUMB, IMPOSSIBLE, Judge, RowVerdict, optimise, task_of
from camgeo.studies.sweep.family import Point
from camgeo.studies.sweep.pool import Pool
from camgeo.studies.sweep.rows import Chunks, Work, dead
from tests.answers.documents import RING, UNHELD
from tests.findings import known
from tests.long_form import LONG
from tests.optimise.cams import PLAIN, bare


def test_the_radius_of_camgeo_size() -> None:
    """Flat tappet: its size is exact, decided by convexity, within the rounding of which a cusp
    counts as none.
    """
    scene = bare("tappet")
    exact = size(Design(scene)).best.base_radius
    task = task_of(scene, ["follower.base_radius=8:9"], least=["diameter"])
    found = optimise(task, evaluations=2000 if LONG else 40)
    near = 1e-6 if LONG else 5e-3
    assert found.best.feasible
    assert found.best.point[0] == pytest.approx(exact, rel=near)
    assert known(found.made).point[0] == pytest.approx(exact, rel=near)
    assert float(known(found.made).point[0]) >= exact * (1.0 - 1e-6)


@pytest.mark.skipif(not LONG, reason="2,000 designs; CAMGEO_LONG=1 runs them")
def test_the_radius_and_offset_of_camgeo_size() -> None:
    """Where the transmission angles of rise and return reach their limit at once."""
    scene = bare("plate_translating")
    answer = known(size(Design(scene)).best.sizing.answer)
    vary = ["follower.base_radius=20:40", "follower.offset=-5:10"]
    found = optimise(task_of(scene, vary, least=["diameter"]), evaluations=3000)
    assert found.best.point == pytest.approx((answer.base_radius, answer.place.real), rel=1e-6)


def test_no_design_of_a_grid_is_better() -> None:
    task = task_of(
        PLAIN,
        ["follower.base_radius=44:56:5", "motion.2.law=modified-sine,polynomial-345"],
        least=["diameter"],
        keep=["transmission-angle>=40"],
    )
    grid = optimise(task)
    kept = [each for each in grid.trials if each.feasible]
    assert 0 < len(kept) < len(grid.trials) == 10 + (grid.start is not None)
    free = task_of(
        PLAIN,
        ["follower.base_radius=44:56", "motion.2.law=modified-sine,polynomial-345"],
        least=["diameter"],
        keep=["transmission-angle>=40"],
    )
    found = optimise(free, evaluations=300 if LONG else 40)
    best = min(each.costs[0] for each in kept)
    step = 2.0 * 3.0  # of the diameter for that of the radius
    assert best - step < known(found.made).costs[0] < best + (0.0 if LONG else 0.2)


@pytest.mark.long  # tests/sweep/test_pool.py has rows of the loop
def test_the_same_designs_are_tried_wherever_they_are_computed() -> None:
    """Bit for bit, in all phases of a search, by the same processes throughout."""
    task = task_of(PLAIN, ["follower.base_radius=44:56", "cam.speed=60,90"], least=["peak:a"])
    pool = Counted(2)
    found = [optimise(task, seed=4, evaluations=60, engine=each) for each in (None, pool)]
    one, other = (
        [(each.place is None or each.place.tobytes(), *astuple(replace(each, place=None)))
         for each in result.trials]
        for result in found
    )  # fmt: skip
    assert one == other
    assert found[0].made is not None
    assert pool.generations > 2
    assert len(pool.started) == 2


class Counted(Pool):
    """A pool that counts what it is given, and the processes that it starts."""

    def __init__(self, workers: int) -> None:
        super().__init__(workers)
        self.generations = 0
        self.started: set[int] = set()

    def rows(self, work: Work, points: Iterator[Point]) -> Chunks:
        self.generations += 1
        for rows in super().rows(work, points):
            self.started |= {each.pid or 0 for each in active_children()}
            yield rows


def test_a_design_that_ends_its_process_is_beyond_all_limits() -> None:
    judge = Judge.for_task(task_of(PLAIN, ["follower.base_radius=44:56"], least=["diameter"]))
    found = dead(judge, (50,), 2)
    assert isinstance(found, RowVerdict)
    assert found.violation == IMPOSSIBLE
    assert "died, 2 times" in found.broken[0]
    assert len(found.costs) == 1


def test_designs_that_fail_are_beyond_a_limit() -> None:
    task = task_of(PLAIN, ["follower.base_radius=-5,25,50.199"], least=["diameter"])
    found = optimise(task)
    start, wrong, small = found.trials
    assert found.start is start
    assert start.feasible
    assert wrong.violation == IMPOSSIBLE
    assert wrong.broken[0].startswith("follower.base_radius = -5: must be")
    assert 0.0 < small.violation < IMPOSSIBLE
    assert found.best is found.made is start


def test_the_limits_of_the_scene_hold_unless_they_do_not_count() -> None:
    vary = ["follower.base_radius=48,49.199"]
    assert optimise(task_of(PLAIN, vary, least=["diameter"])).made is None
    ignoring = optimise(task_of(PLAIN, vary, least=["diameter"], ignore=["transmission-angle"]))
    assert known(ignoring.made).point == (48,)
    assert ["below 41 deg" in each for each in known(ignoring.made).remarks] == [True]


def test_a_program_that_must_not_be_run_is_not_the_shortest() -> None:
    """A core that falls out counts where the machining time is asked for, and only there."""
    vary = ["tool[1].feed=1000,2000"]
    loose = loads(UNHELD)
    found = optimise(task_of(loose.scene, vary, least=["machining-time"], ignore=["smallest-wall"]))
    assert found.made is None
    assert ["nothing holds it" in each.broken[0] for each in found.trials] == [True] * 2
    held = load_scene(RING)
    shortest = known(optimise(task_of(held, vary, least=["machining-time"])).made)
    assert shortest.point == (2000,)


def test_an_objective_that_no_design_answers() -> None:
    task = task_of(PLAIN, ["follower.base_radius=45:55"], least=["mass"])
    found = optimise(task, evaluations=DUMB + 10)
    assert len(found.trials) == DUMB
    assert found.ended == "no design has an answer to mass: the scene has no [part]"
    assert found.made is None
