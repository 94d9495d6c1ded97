"""Machining time of moves and contours: values by hand, and how moves become blocks."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from camgeo.geometry.contour.contour import Contour
from camgeo.milling.cut import ContourCut
from camgeo.milling.machine import Dynamics
from camgeo.milling.machining_time import (
    SECONDS,
    Blocks,
    block_times,
    contour_time,
    controller_blocks,
    toolpath_times,
)
from camgeo.milling.milling import Heights, Tool
from camgeo.milling.moves import ArcFeed, Feed, Move, Operation, Rapid, Stop, Toolpath, arc_sweep
from camgeo.numeric.arrays import FloatArray
from camgeo.part.boundaries import ExactBoundary

MACHINE = Dynamics(acceleration=500.0, rapid_feed=6000.0, look_ahead=10)
"""v = 100 mm/s after 0.2 s and 10 mm."""

TOOL = Tool(number=1, diameter=6.0, spindle_speed=3000.0, feed=300.0, plunge_feed=100.0)

ROUNDING = 1e-12
"""Of sums of a few products and roots, far above 2^-52 times their number."""


def seconds_of(toolpath: Toolpath) -> float:
    """Time [s] of a whole program."""
    return math.fsum(each.seconds for each in toolpath_times(toolpath, MACHINE))


def program(*operations: tuple[Move | Stop, ...]) -> Toolpath:
    rim = ExactBoundary("rim", hole=False, exact=Contour.circle(10.0))
    cuts = [
        ContourCut(
            name=f"cut {number}", strategy="profile", tool=TOOL, top=0.0, depths=(-1.0,), centre=rim
        )
        for number in range(len(operations))
    ]
    return Toolpath(
        Heights(5.0, 5.0),
        tuple(Operation(cut, moves) for cut, moves in zip(cuts, operations, strict=True)),
    )


@pytest.mark.parametrize(
    ("length", "seconds"),
    [
        (5.0, 0.2),  # never at full speed
        (20.0, 0.4),  # just
        (120.0, 1.4),  # 1 s at full speed
    ],
)
def test_traverses_by_hand(length: float, seconds: float) -> None:
    moves = Rapid((0.0, 0.0, 5.0)), Rapid((length, 0.0, 5.0))
    assert seconds_of(program(moves)) == pytest.approx(seconds, rel=ROUNDING)


def test_one_round_of_a_circle() -> None:
    """The ramps at both ends take as long again as a quarter of the ramp does at full speed."""
    circle = Contour.circle(10.0)
    slow = 2.0 * math.pi + 10.0 / 500.0
    assert contour_time(circle, 600.0, MACHINE) == pytest.approx(slow, rel=ROUNDING)
    # sqrt(500 10) mm/s is all that the circle allows; the machine would take 100.
    speed = math.sqrt(5000.0)
    fast = 20.0 * math.pi / speed + speed / 500.0
    assert contour_time(circle, math.inf, MACHINE) == pytest.approx(fast, rel=ROUNDING)


def test_the_time_of_operations_by_hand() -> None:
    first = (
        Rapid((10.0, 0.0, 5.0)),  # from where the machine stands: not known, not counted
        Feed((10.0, 0.0, -5.0), 120.0),  # 10 mm at 2 mm/s, up to there and down in 4 ms each
        ArcFeed((-10.0, 0.0, -5.0), (0.0, 0.0), True, 600.0),  # half a turn at 10 mm/s
        Rapid((-10.0, 0.0, 15.0)),  # 20 mm: 0.4 s
    )
    second = (
        Rapid((0.0, 0.0, 15.0)),  # 10 mm: 0.282... s
        Stop("move the clamp"),
        Feed((0.0, 0.0, -5.0), 600.0),
        Rapid((0.0, 0.0, 15.0)),
    )
    one, two = toolpath_times(program(first, second), MACHINE)
    assert one.traverses == pytest.approx(0.4, rel=ROUNDING)
    ramps = 2.0 / 500.0, 10.0 / 500.0
    assert one.cutting == pytest.approx(5.0 + math.pi + sum(ramps), rel=ROUNDING)
    assert one.blocks == 3
    assert one.slowed == pytest.approx(sum(ramps) / one.cutting, rel=1e-9)
    assert two.cutting == pytest.approx(2.0 + 10.0 / 500.0, rel=ROUNDING)
    assert two.traverses == pytest.approx(2.0 * math.sqrt(10.0 / 500.0) + 0.4, rel=ROUNDING)
    whole = seconds_of(program(first, second))
    assert whole == pytest.approx(one.seconds + two.seconds, rel=ROUNDING)


def test_a_program_without_cuts() -> None:
    assert seconds_of(program((Rapid((1.0, 2.0, 5.0)),))) == 0.0


def test_arcs_are_divided_as_grbl_divides_them() -> None:
    """Half a turn of 50 mm within 2 um: floor(0.5 pi 50 / sqrt(0.002 (100 - 0.002))) chords."""
    half = ArcFeed((-50.0, 0.0, -1.0), (0.0, 0.0), True, 600.0)
    blocks = controller_blocks([half], (50.0, 0.0, 0.0), chord=0.002)
    assert len(blocks) == 175
    assert np.all(blocks.radii == 0.0)
    assert np.sum(blocks.lengths) == pytest.approx(math.hypot(50.0 * math.pi, 1.0), rel=1e-4)
    # The last one ends at the end of the arc, at the height of its end.
    assert np.sum(blocks.lengths * blocks.ends[:, 2]) == pytest.approx(-1.0, rel=1e-9)


@given(st.floats(0.1, 100.0), st.floats(0.1, math.pi), st.floats(-5.0, 5.0), st.booleans())
def test_a_helix_is_as_long_as_its_chords(
    radius: float, turn: float, rise: float, ccw: bool
) -> None:
    angle = turn if ccw else -turn
    end = (radius * math.cos(angle), radius * math.sin(angle), rise)
    move = ArcFeed(end, (0.0, 0.0), ccw, 600.0)
    arc = controller_blocks([move], (radius, 0.0, 0.0))
    chords = controller_blocks([move], (radius, 0.0, 0.0), chord=1e-6 * radius)
    assert float(arc.lengths[0]) == pytest.approx(math.fsum(chords.lengths), rel=1e-6)
    # The direction at both ends is that of its first and of its last chord, turned by half a chord.
    for way, near in ((arc.starts[0], chords.starts[0]), (arc.ends[0], chords.ends[-1])):
        assert np.linalg.norm(way) == pytest.approx(1.0, rel=ROUNDING)
        assert np.dot(way, near) == pytest.approx(1.0, abs=1e-5)


def test_what_has_no_length_is_no_block() -> None:
    moves = Rapid((1.0, 0.0, 5.0)), Feed((1.0, 0.0, 5.0), 100.0), Feed((2.0, 0.0, 5.0), 100.0)
    assert controller_blocks(moves, None).moves.tolist() == [2]


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
    moves: list[Move] = [Rapid((13.0, 4.0, -1.0))]
    for end, centre in zip(contour.ends, contour.centres, strict=True):
        point = (float(end.real), float(end.imag), -1.0)
        moves.append(ArcFeed(point, (float(centre.real), float(centre.imag)), True, 300.0))
    whole = contour_time(contour, 300.0, MACHINE)
    assert seconds_of(program(tuple(moves))) == pytest.approx(whole, rel=ROUNDING)


# -- look ahead ------------------------------------------------------------------------------------
# The plan of speeds: values by hand, and what must hold for any blocks.


SPEED_ROUNDING = 1e-9
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
    blocks = controller_blocks(moves, (60.0, 0.0, 0.0))
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
    assert found == pytest.approx(expected, rel=SPEED_ROUNDING)


def test_corners_by_hand() -> None:
    """A right angle with 0.02 mm: r = 0.02 / (sqrt(2) - 1), and sqrt(2) of the acceleration."""
    moves = [Feed((10.0, 0.0, 0.0), 6000.0), Feed((10.0, 10.0, 0.0), 6000.0)]
    blocks = controller_blocks(moves, (0.0, 0.0, 0.0))
    machine = replace(MACHINE, junction_deviation=0.02)
    _, speeds = block_times(blocks, machine)
    radius = 0.02 / (math.sqrt(2.0) - 1.0)
    assert speeds[1] == pytest.approx(
        math.sqrt(500.0 * math.sqrt(2.0) * radius), rel=SPEED_ROUNDING
    )
    assert block_times(blocks, MACHINE)[1][1] == 0.0
    # Both axes change by the speed: the velocity jumps by sqrt(2) of it.
    jump = block_times(blocks, replace(MACHINE, velocity_jump=3.0))[1][1]
    assert jump == pytest.approx(3.0 / math.sqrt(2.0), rel=SPEED_ROUNDING)
    # The same arc when it is run; as long as it does not reach beyond the middle of a block.
    assert block_times(blocks, MACHINE, 0.02)[1][1] == pytest.approx(speeds[1], rel=SPEED_ROUNDING)
    _, wide = block_times(blocks, MACHINE, 10.0)
    assert wide[1] == pytest.approx(math.sqrt(500.0 * math.sqrt(2.0) * 5.0), rel=SPEED_ROUNDING)


def test_chords_of_a_circle_that_are_smoothed_are_as_slow_as_the_circle() -> None:
    """The arc through each corner has the radius of the circle, whatever is allowed."""
    angles = np.linspace(0.0, 2.0 * np.pi, 401)[1:]
    moves = [Feed((2.0 * math.cos(a) - 2.0, 2.0 * math.sin(a), 0.0), 6000.0) for a in angles]
    machine = replace(MACHINE, look_ahead=100)
    _, speeds = block_times(controller_blocks(moves, (0.0, 0.0, 0.0)), machine, 0.1)
    assert 1.0 <= np.max(speeds[100:300]) / math.sqrt(500.0 * 2.0) <= math.sqrt(math.sqrt(2.0))


@given(paths(), machines)
def test_no_limit_is_exceeded(blocks: Blocks, machine: Dynamics) -> None:
    times, speeds = block_times(blocks, machine)
    leave = np.append(speeds[1:], 0.0)
    share = np.max(np.abs(blocks.starts), axis=1)
    able = machine.acceleration / share
    slack = 1e-6 * (1.0 + speeds**2 + leave**2)
    assert np.all(np.abs(leave**2 - speeds**2) <= 2.0 * able * blocks.lengths + slack)
    assert np.all(times >= blocks.lengths / blocks.feeds * (1.0 - SPEED_ROUNDING))
    assert np.all(times >= machine.block_time * (1.0 - SPEED_ROUNDING))
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
