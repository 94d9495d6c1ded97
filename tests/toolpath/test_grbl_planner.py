"""The plan of speeds against Grbl's own planner, compiled.

`CAMGEO_GRBL_PLANNER` names a program made of it (`tests.judges.grbl_planner`). Where it is absent,
the times that it gave are compared: gnea/grbl at bfb67f0, compiled by gcc for x86-64.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import camgeo
from camgeo.milling.machine import load
from camgeo.milling.machining_time import block_times, controller_blocks
from camgeo.milling.moves import Feed, Move, Point, Rapid
from camgeo.numeric.arrays import FloatArray
from tests.judges.grbl_planner import FLOAT, MACHINE, PLANNER, planned, times_of

planner = pytest.mark.skipif(bool(PLANNER.absent()), reason=PLANNER.absent() or "is there")

PLACES = 2e-6
"""[s] Grbl's places, too, are floats of 24 bits: at 100 mm lengths are off by 8e-6 mm, and the time
of a block by that over its speed, of which few are below 5 mm/s here."""

START: Point = (0.0, 0.0, 0.0)


def run(*moves: Move) -> FloatArray:
    return block_times(controller_blocks(moves, START), MACHINE)[0]


def judged(*moves: Move) -> FloatArray:
    """Seconds of each block by Grbl's planner."""
    return planned(controller_blocks(moves, START), START)


def random_moves(seed: int, step: float, count: int = 120) -> tuple[Move, ...]:
    rng = np.random.default_rng(seed)
    points = np.cumsum(rng.normal(size=(count, 3)) * (step, step, 0.1 * step), axis=0).round(4)
    feeds = rng.choice([300.0, 1000.0, 5000.0, 0.0], count)
    places = [(float(x), float(y), float(z)) for x, y, z in points]
    return tuple(
        Feed(place, float(feed)) if feed else Rapid(place)
        for place, feed in zip(places, feeds, strict=True)
    )


def chords(count: int, feed: float) -> tuple[Move, ...]:
    """A circle of 50 mm in `count` chords."""
    angles = np.linspace(0.0, 2.0 * np.pi, count + 1)[1:]
    points = np.column_stack((50.0 * np.cos(angles) - 50.0, 50.0 * np.sin(angles))).round(4)
    return tuple(Feed((float(x), float(y), 0.0), feed) for x, y in points)


RECORDED = {
    "corner": (
        (Feed((10.0, 0.0, 0.0), 600.0), Feed((10.0, 10.0, 0.0), 600.0), Rapid(START)),
        2.298173054,
    ),
    "back and forth": ((Feed((10.0, 0.0, 0.0), 3000.0), Feed(START, 3000.0)), 0.6),
    "steps of 5 mm": (random_moves(1, 5.0), 50.5223301652),
    "steps of 50 um": (random_moves(2, 0.05), 1.50641961367),
    "circle, 500 chords": (chords(500, 3000.0), 6.3831352062),
    "circle, 5000 chords": (chords(5000, 3000.0), 10.00995400547),
    "circle, 20000 chords": (chords(20000, 3000.0), 19.93016676031),
}
"""Moves, and the seconds by Grbl's planner."""


@pytest.mark.parametrize("name", RECORDED)
def test_the_time_is_that_of_grbls_planner(name: str) -> None:
    moves, seconds = RECORDED[name]
    assert np.sum(run(*moves)) == pytest.approx(seconds, rel=FLOAT)


@planner
@pytest.mark.parametrize("name", RECORDED)
def test_each_block_takes_as_long_in_grbls_planner(name: str) -> None:
    moves, seconds = RECORDED[name]
    own, other = run(*moves), judged(*moves)
    assert np.max(np.abs(own - other)) < FLOAT * np.max(own) + PLACES
    assert np.sum(other) == pytest.approx(seconds, rel=FLOAT)


@planner
@pytest.mark.parametrize("name", ["setzhub", "groove", "inch"])
def test_each_operation_of_a_program_takes_as_long(name: str) -> None:
    """Its arcs in the chords that Grbl makes of them."""
    assert load("grbl").dynamics == MACHINE
    design = camgeo.load(Path(__file__).parents[2] / "fixtures" / "scenes" / f"{name}.toml")
    for times in times_of(design):
        assert np.max(np.abs(times.own - times.other)) < FLOAT * np.max(times.own) + times.places
        assert np.sum(times.other) == pytest.approx(np.sum(times.own), rel=FLOAT)
