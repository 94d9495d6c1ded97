"""The course of a cutter: its pieces, and the parts of them below a height."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from camgeo.milling.course import below, course_of
from camgeo.milling.moves import ArcFeed, Feed, Move, Rapid, Stop
from camgeo.milling.simulation import unlifted

FEED = 100.0


def test_traverses_and_halts_are_left_out() -> None:
    moves: list[Move | Stop] = [
        Rapid((0.0, 0.0, 5.0)),
        Feed((0.0, 0.0, -1.0), FEED),
        Stop("turn it"),
        Feed((4.0, 3.0, -1.0), FEED),
        Rapid((9.0, 9.0, -1.0)),
        ArcFeed((9.0, 5.0, -2.0), (9.0, 7.0), True, FEED),
    ]
    course = course_of(moves)
    assert course.moves.tolist() == [1, 3, 5]
    assert course.lengths == pytest.approx([0.0, 5.0, 2.0 * math.pi])
    assert course.starts[2] == 9.0 + 9.0j
    assert course.from_z.tolist() == [5.0, -1.0, -1.0]
    assert course.lowest.tolist() == [-1.0, -1.0, -2.0]


@given(st.floats(-3.0, 1.0), st.booleans(), st.booleans())
def test_below_a_height_is_the_share_that_lies_there(z: float, down: bool, arc: bool) -> None:
    """A ramp between 0 and -2, on a line or an arc of the same length."""
    first, last = (0.0, -2.0) if down else (-2.0, 0.0)
    half = math.pi * 5.0
    ramp: Move = (
        ArcFeed((10.0, 0.0, last), (5.0, 0.0), True, FEED)
        if arc
        else Feed((half, 0.0, last), FEED)
    )  # fmt: skip
    course = course_of([ramp], (0.0, 0.0, first))
    found = below(course, z)
    share = min(1.0, max(0.0, 0.5 * (z + 2.0)))
    assert math.fsum(found.lengths) == pytest.approx(share * half, abs=1e-9)
    if len(found):
        assert np.max(found.highest) <= z
        kept = found.ends[0] if down else found.starts[0]
        assert kept == (course.ends[0] if down else course.starts[0])
        # What was cut off ends on the same ramp.
        other = complex((found.starts if down else found.ends)[0])
        place = course.at(np.array([1.0 - share if down else share]))
        assert abs(other - place[0]) < 1e-9


@given(st.lists(st.floats(0.1, 3.0), min_size=1, max_size=9), st.floats(0.0, 2.0))
def test_pecks_are_one_plunge(steps: list[float], back: float) -> None:
    """However often the drill is lifted, and stops above the depth that it has reached."""
    place = (3.0, 4.0)
    depths = np.cumsum(steps).tolist()
    moves: list[Move] = [Rapid((*place, 5.0))]
    for k, depth in enumerate(depths):
        if k:
            moves += [Rapid((*place, 5.0)), Rapid((*place, back - depths[k - 1]))]
        moves.append(Feed((*place, -depth), FEED))
    moves += [Rapid((*place, 5.0)), Rapid((9.0, 9.0, 5.0))]
    whole = [moves[0], Feed((*place, -depths[-1]), FEED), *moves[-2:]]
    assert unlifted(moves) == whole


def test_lifts_after_which_it_is_not_the_same_stay() -> None:
    """A cut in the plane, or a traverse deeper than the hole."""
    down, up = Feed((0.0, 0.0, -2.0), FEED), Rapid((0.0, 0.0, 5.0))
    for again in (
        [Rapid((0.0, 0.0, -1.0)), Feed((4.0, 0.0, -1.0), FEED)],
        [Rapid((0.0, 0.0, -2.5)), Feed((0.0, 0.0, -3.0), FEED)],
        [Feed((0.0, 0.0, -1.5), FEED)],
    ):
        moves: list[Move] = [up, down, up, *again]
        assert unlifted(moves) == moves
