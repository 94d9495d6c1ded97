"""Machining time of moves and contours: values by hand, and how moves become blocks."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from camgeo.geometry.contour.contour import Contour
from camgeo.milling.cut import ContourCut
from camgeo.milling.machine import Dynamics
from camgeo.milling.machining_time import blocks_of, contour_time, toolpath_times
from camgeo.milling.moves import (
    ArcFeed,
    Feed,
    Heights,
    Move,
    Operation,
    Rapid,
    Stop,
    Toolpath,
    arc_sweep,
)
from camgeo.milling.tool import Tool
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
        Heights.of(5.0),
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
    blocks = blocks_of([half], (50.0, 0.0, 0.0), chord=0.002)
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
    arc = blocks_of([move], (radius, 0.0, 0.0))
    chords = blocks_of([move], (radius, 0.0, 0.0), chord=1e-6 * radius)
    assert float(arc.lengths[0]) == pytest.approx(math.fsum(chords.lengths), rel=1e-6)
    # The direction at both ends is that of its first and of its last chord, turned by half a chord.
    for way, near in ((arc.starts[0], chords.starts[0]), (arc.ends[0], chords.ends[-1])):
        assert np.linalg.norm(way) == pytest.approx(1.0, rel=ROUNDING)
        assert np.dot(way, near) == pytest.approx(1.0, abs=1e-5)


def test_what_has_no_length_is_no_block() -> None:
    moves = Rapid((1.0, 0.0, 5.0)), Feed((1.0, 0.0, 5.0), 100.0), Feed((2.0, 0.0, 5.0), 100.0)
    assert blocks_of(moves, None).moves.tolist() == [2]


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
