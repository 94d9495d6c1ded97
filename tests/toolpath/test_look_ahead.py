"""The plan of speeds: values by hand, and what must hold for any blocks."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from camgeo.milling.machine import Dynamics
from camgeo.milling.machining_time import SECONDS, Blocks, block_times, blocks_of
from camgeo.milling.moves import Feed, Move
from camgeo.numeric.arrays import FloatArray

MACHINE = Dynamics(acceleration=500.0, rapid_feed=6000.0, look_ahead=10)
"""v = 100 mm/s after 0.2 s and 10 mm."""

ROUNDING = 1e-9
"""Of sums of squares of speeds along some thousand blocks, and their differences."""


def straight(*lengths: float, feed: float = 600.0) -> Blocks:
    """Blocks of `lengths` one behind the other along x."""
    count = len(lengths)
    way = np.tile((1.0, 0.0, 0.0), (count, 1))
    zero = np.zeros(count)
    return Blocks(
        np.array(lengths),
        np.full(count, feed / SECONDS),
        zero,
        way,
        way,
        zero == 1.0,
        np.arange(count),
    )


def seconds(blocks: Blocks, machine: Dynamics, smoothing: float | None = None) -> float:
    return math.fsum(block_times(blocks, machine, smoothing)[0])


@st.composite
def paths(draw: st.DrawFn) -> Blocks:
    places = st.floats(-50.0, 50.0).map(lambda value: round(value, 3))
    points = draw(st.lists(st.tuples(places, places, places), min_size=2, max_size=30))
    feeds = draw(st.lists(st.floats(10.0, 1e4), min_size=len(points), max_size=len(points)))
    moves: list[Move] = [Feed(point, feed) for point, feed in zip(points, feeds, strict=True)]
    blocks = blocks_of(moves, (60.0, 0.0, 0.0))
    assert len(blocks)
    return blocks


machines = st.builds(
    Dynamics,
    acceleration=st.floats(10.0, 1e4),
    rapid_feed=st.floats(100.0, 1e5),
    look_ahead=st.integers(1, 40),
    junction_deviation=st.sampled_from([0.0, 0.005, 0.02, 0.5]),
    velocity_jump=st.sampled_from([0.0, 0.05, 5.0]),
    block_time=st.sampled_from([0.0, 0.001, 0.02]),
)


@pytest.mark.parametrize(
    ("ahead", "count", "expected"),
    [
        # From rest to 10 mm/s takes 0.1 mm; 1 mm in one block takes 0.1 s and two ramps of 0.01 s.
        (1, 1, 0.12),
        (10, 10, 0.12),  # ten blocks of 0.1 mm, of which all but one are used to brake
        # With one block of look-ahead the speed at each joint is sqrt(2 500 0.1) = 10 mm/s.
        (1, 10, 0.12),
        # Blocks of 0.025 mm: 5 mm/s at each joint, and between them up to
        # sqrt(5^2 + 500 0.025) = sqrt(37.5); 5 mm/s take 0.01 s at both ends.
        (1, 40, 38 * 2.0 * (math.sqrt(37.5) - 5.0) / 500.0 + 2 * 0.01),
    ],
)
def test_a_line_in_pieces_by_hand(ahead: int, count: int, expected: float) -> None:
    machine = replace(MACHINE, look_ahead=ahead)
    found = seconds(straight(*[1.0 / count] * count), machine)
    assert found == pytest.approx(expected, rel=ROUNDING)


def test_corners_by_hand() -> None:
    """A right angle with 0.02 mm: r = 0.02 / (sqrt(2) - 1), and sqrt(2) of the acceleration."""
    moves = [Feed((10.0, 0.0, 0.0), 6000.0), Feed((10.0, 10.0, 0.0), 6000.0)]
    blocks = blocks_of(moves, (0.0, 0.0, 0.0))
    machine = replace(MACHINE, junction_deviation=0.02)
    _, speeds = block_times(blocks, machine)
    radius = 0.02 / (math.sqrt(2.0) - 1.0)
    assert speeds[1] == pytest.approx(math.sqrt(500.0 * math.sqrt(2.0) * radius), rel=ROUNDING)
    assert block_times(blocks, MACHINE)[1][1] == 0.0
    # Both axes change by the speed: the velocity jumps by sqrt(2) of it.
    jump = block_times(blocks, replace(MACHINE, velocity_jump=3.0))[1][1]
    assert jump == pytest.approx(3.0 / math.sqrt(2.0), rel=ROUNDING)
    # The same arc when it is run; as long as it does not reach beyond the middle of a block.
    assert block_times(blocks, MACHINE, 0.02)[1][1] == pytest.approx(speeds[1], rel=ROUNDING)
    _, wide = block_times(blocks, MACHINE, 10.0)
    assert wide[1] == pytest.approx(math.sqrt(500.0 * math.sqrt(2.0) * 5.0), rel=ROUNDING)


def test_chords_of_a_circle_that_are_smoothed_are_as_slow_as_the_circle() -> None:
    """The arc through each corner has the radius of the circle, whatever is allowed."""
    angles = np.linspace(0.0, 2.0 * np.pi, 401)[1:]
    moves = [Feed((2.0 * math.cos(a) - 2.0, 2.0 * math.sin(a), 0.0), 6000.0) for a in angles]
    machine = replace(MACHINE, look_ahead=100)
    _, speeds = block_times(blocks_of(moves, (0.0, 0.0, 0.0)), machine, 0.1)
    assert 1.0 <= np.max(speeds[100:300]) / math.sqrt(500.0 * 2.0) <= math.sqrt(math.sqrt(2.0))


@given(paths(), machines)
def test_no_limit_is_exceeded(blocks: Blocks, machine: Dynamics) -> None:
    times, speeds = block_times(blocks, machine)
    leave = np.append(speeds[1:], 0.0)
    share = np.max(np.abs(blocks.starts), axis=1)
    able = machine.acceleration / share
    slack = 1e-6 * (1.0 + speeds**2 + leave**2)
    assert np.all(np.abs(leave**2 - speeds**2) <= 2.0 * able * blocks.lengths + slack)
    assert np.all(times >= blocks.lengths / blocks.feeds * (1.0 - ROUNDING))
    assert np.all(times >= machine.block_time * (1.0 - ROUNDING))
    # It can stop within the blocks that it has planned.
    ahead = machine.look_ahead
    gains = 2.0 * able * blocks.lengths
    for number, speed in enumerate(speeds):
        assert speed**2 <= np.sum(gains[number : number + ahead]) * (1.0 + 1e-6) + 1e-6


@given(paths(), machines, st.integers(2, 5))
def test_more_blocks_for_the_same_path_save_no_time(
    blocks: Blocks, machine: Dynamics, parts: int
) -> None:
    split = Blocks(
        np.repeat(blocks.lengths / parts, parts),
        np.repeat(blocks.feeds, parts),
        np.repeat(blocks.radii, parts),
        np.repeat(blocks.starts, parts, axis=0),
        np.repeat(blocks.ends, parts, axis=0),
        np.repeat(blocks.rests, parts) & (np.arange(parts * len(blocks)) % parts == 0),
        np.repeat(blocks.moves, parts),
    )
    assert seconds(split, machine) >= seconds(blocks, machine) * (1.0 - 1e-6)


@given(paths(), machines)
def test_a_better_machine_is_no_slower(blocks: Blocks, machine: Dynamics) -> None:
    whole = seconds(blocks, machine) * (1.0 + 1e-6) + 1e-9
    better = (
        replace(machine, acceleration=2.0 * machine.acceleration),
        replace(machine, rapid_feed=2.0 * machine.rapid_feed),
        replace(machine, look_ahead=machine.look_ahead + 1),
        replace(machine, junction_deviation=2.0 * machine.junction_deviation),
        replace(machine, velocity_jump=2.0 * machine.velocity_jump),
        replace(machine, block_time=0.5 * machine.block_time),
    )
    assert all(seconds(blocks, each) <= whole for each in better)


@given(paths(), machines)
def test_the_distance_of_each_block_is_its_length(blocks: Blocks, machine: Dynamics) -> None:
    """The time of a block lies between those at its fastest and its slowest possible course."""
    times, speeds = block_times(blocks, machine)
    leave = np.append(speeds[1:], 0.0)
    mean: FloatArray = np.divide(blocks.lengths, times)
    assert np.all(mean >= np.minimum(speeds, leave) * (1.0 - 1e-6))


def test_no_blocks_take_no_time() -> None:
    assert seconds(straight(), MACHINE) == 0.0
