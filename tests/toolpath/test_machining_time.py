"""The estimate of the machining time: values by hand, and what must hold for any blocks."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from camgeo.contour.contour import Contour
from camgeo.part.boundaries import ExactBoundary
from camgeo.toolpath.cut import ContourCut
from camgeo.toolpath.machining_time import (
    Dynamics,
    arc_sweep,
    block_times,
    contour_time,
    toolpath_time,
    traverse_time,
)
from camgeo.toolpath.moves import ArcFeed, Feed, Heights, Move, Operation, Rapid, Stop, Toolpath
from camgeo.toolpath.tool import Tool

MACHINE = Dynamics(acceleration=500.0, rapid_feed=6000.0)
"""v = 100 mm/s after 0.2 s and 10 mm."""

TOOL = Tool(number=1, diameter=6.0, spindle_speed=3000.0, feed=300.0, plunge_feed=100.0)

ROUNDING = 1e-12
"""Of sums of a few products and roots, far above 2^-52 times their number."""

lengths = st.floats(1e-6, 1e3)
feeds = st.floats(1.0, 1e5)
accelerations = st.floats(1.0, 1e5)


def time_of(length: float, radius: float, feed: float, acceleration: float) -> float:
    return float(block_times(np.array([length]), np.array([radius]), feed, acceleration)[0])


def program(*moves: Move) -> Toolpath:
    rim = ExactBoundary("rim", hole=False, exact=Contour.circle(10.0))
    cut = ContourCut(
        name="rim", strategy="profile", tool=TOOL, top=0.0, depths=(-1.0,), centre=rim, right="rim"
    )
    return Toolpath(Heights.of(5.0), (Operation(cut, moves),))


@pytest.mark.parametrize(
    ("length", "radius", "feed", "acceleration", "seconds"),
    [
        (10.0, 0.0, 600.0, 500.0, 1.0),  # 10 mm/s, for 10 mm are longer than 10^2/1000 = 0.1 mm
        (0.1, 0.0, 600.0, 500.0, 0.01),  # as long as that: the feed is just reached
        (0.025, 0.0, 600.0, 500.0, 0.005),  # a quarter: half the feed
        (10.0, 0.2, 600.0, 500.0, 1.0),  # sqrt(500 0.2) = 10 mm/s: the arc just allows the feed
        (10.0, 0.05, 600.0, 500.0, 2.0),  # a quarter of that radius: half the feed
        (0.025, 0.05, 600.0, 500.0, 0.005),  # both limits are 5 mm/s
        (0.0, 0.0, 600.0, 500.0, 0.0),
    ],
)
def test_blocks_by_hand(
    length: float, radius: float, feed: float, acceleration: float, seconds: float
) -> None:
    assert time_of(length, radius, feed, acceleration) == pytest.approx(seconds, rel=ROUNDING)


@given(lengths, st.sampled_from([0.0, 1e-3, 1.0, 1e3]), feeds, accelerations)
def test_no_block_is_quicker_than_feed_and_acceleration_allow(
    length: float, radius: float, feed: float, acceleration: float
) -> None:
    time = time_of(length, radius, feed, acceleration) * (1.0 + ROUNDING)
    assert time >= length / (feed / 60.0)
    assert (length / time) ** 2 <= 2.0 * acceleration * length * (1.0 + 3.0 * ROUNDING)
    if radius > 0.0:
        assert (length / time) ** 2 / radius <= acceleration * (1.0 + 3.0 * ROUNDING)


@given(lengths, st.integers(2, 50), feeds, accelerations)
def test_splitting_a_block_never_saves_time(
    length: float, parts: int, feed: float, acceleration: float
) -> None:
    whole = time_of(length, 0.0, feed, acceleration)
    split = parts * time_of(length / parts, 0.0, feed, acceleration)
    assert split >= whole * (1.0 - ROUNDING)
    reaches_feed = length / parts >= (feed / 60.0) ** 2 / (2.0 * acceleration) * (1.0 + ROUNDING)
    if reaches_feed:
        assert split == pytest.approx(whole, rel=ROUNDING)


@given(lengths, feeds, accelerations, st.floats(1.0, 10.0))
def test_a_better_machine_is_no_slower(
    length: float, feed: float, acceleration: float, factor: float
) -> None:
    time = time_of(length, 0.0, feed, acceleration) * (1.0 + ROUNDING)
    assert time_of(length, 0.0, factor * feed, acceleration) <= time
    assert time_of(length, 0.0, feed, factor * acceleration) <= time


def test_traverses_by_hand() -> None:
    assert traverse_time(0.0, MACHINE) == 0.0
    assert traverse_time(5.0, MACHINE) == pytest.approx(0.2, rel=ROUNDING)  # never at full speed
    assert traverse_time(20.0, MACHINE) == pytest.approx(0.4, rel=ROUNDING)  # just
    assert traverse_time(120.0, MACHINE) == pytest.approx(1.4, rel=ROUNDING)  # 1 s at full speed


@given(st.floats(1e-6, 1e4), st.floats(1e-6, 1e4), feeds, accelerations)
def test_a_stop_on_the_way_costs_time(
    first: float, second: float, feed: float, acceleration: float
) -> None:
    machine = Dynamics(acceleration, feed)
    whole = traverse_time(first + second, machine)
    assert traverse_time(first, machine) + traverse_time(second, machine) >= whole * (1 - ROUNDING)
    assert whole >= (first + second) / (feed / 60.0) * (1 - ROUNDING)


def test_one_round_of_a_circle() -> None:
    circle = Contour.circle(10.0)
    assert contour_time(circle, 600.0, 500.0) == pytest.approx(2.0 * math.pi, rel=ROUNDING)
    # sqrt(500 10) mm/s is all that the circle allows.
    fast = 20.0 * math.pi / math.sqrt(5000.0)
    assert contour_time(circle, 60_000.0, 500.0) == pytest.approx(fast, rel=ROUNDING)


def test_a_program_by_hand() -> None:
    moves = (
        Rapid((10.0, 0.0, 5.0)),  # from where the machine stands: not known, not counted
        Feed((10.0, 0.0, -5.0), 120.0),  # 10 mm at 2 mm/s
        ArcFeed((-10.0, 0.0, -5.0), (0.0, 0.0), True, 600.0),  # half a turn at 10 mm/s
        ArcFeed((0.0, 10.0, -5.0), (0.0, 0.0), False, 600.0),  # a quarter back
        Feed((0.0, 12.0, -5.0), 600.0),
        Rapid((0.0, 12.0, 15.0)),  # 20 mm: 0.4 s
    )
    seconds = 5.0 + math.pi + math.pi / 2.0 + 0.2 + 0.4
    assert toolpath_time(program(*moves), MACHINE) == pytest.approx(seconds, rel=ROUNDING)


def test_a_program_without_cuts() -> None:
    assert toolpath_time(program(Rapid((1.0, 2.0, 5.0))), MACHINE) == 0.0


@given(
    st.floats(0.1, 100.0),
    st.floats(-math.pi, math.pi),
    st.floats(1e-6, math.pi),
    st.booleans(),
)
def test_sweeps_of_arcs(radius: float, begin: float, turn: float, ccw: bool) -> None:
    def arm(angle: float) -> complex:
        return radius * complex(math.cos(angle), math.sin(angle))

    sweep = arc_sweep(arm(begin), arm(begin + (turn if ccw else -turn)), ccw=ccw)
    assert sweep == pytest.approx(turn if ccw else -turn, abs=1e-14 * (1.0 + abs(begin) + turn))


def test_a_sweep_rounded_below_zero_is_no_whole_turn() -> None:
    assert arc_sweep(1.0 + 0.0j, complex(1.0, -1e-17), ccw=True) == 0.0
    assert arc_sweep(1.0 + 0.0j, complex(1.0, 1e-17), ccw=False) == 0.0


def test_the_time_of_a_contour_is_that_of_its_moves() -> None:
    contour = Contour.circle(10.0, 3.0 + 4.0j)
    moves: list[Any] = [Rapid((13.0, 4.0, -1.0))]
    for end, centre in zip(contour.ends, contour.centres, strict=True):
        point = (float(end.real), float(end.imag), -1.0)
        moves.append(ArcFeed(point, (float(centre.real), float(centre.imag)), True, 300.0))
    whole = contour_time(contour, 300.0, MACHINE.acceleration)
    assert toolpath_time(program(*moves), MACHINE) == pytest.approx(whole, rel=ROUNDING)


def test_a_helix_is_as_long_as_its_path_and_a_halt_takes_no_time() -> None:
    """Half a turn of radius 10 with a rise of 10 pi: both legs of the helix are equally long."""
    start = Rapid((10.0, 0.0, 5.0))
    down = Feed((10.0, 0.0, 0.0), 300.0)
    helix = ArcFeed((-10.0, 0.0, -10.0 * math.pi), (0.0, 0.0), True, 60.0)
    before = toolpath_time(program(start, down), MACHINE)
    whole = toolpath_time(program(start, down, helix), MACHINE)
    assert whole - before == pytest.approx(10.0 * math.pi * math.sqrt(2.0), rel=1e-9)
    rim = program(start, down, helix).operations[0]
    halted = Toolpath(Heights.of(5.0), (Operation(rim.cut, (*rim.moves, Stop("turn it over"))),))
    assert toolpath_time(halted, MACHINE) == whole
