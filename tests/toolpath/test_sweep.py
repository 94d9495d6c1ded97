"""Areas that a cutter sweeps, against closed forms, within what their chords allow."""

from __future__ import annotations

import math

import numpy as np
import pytest

from camgeo.geometry.contour.contour import Contour
from camgeo.milling.course import below, course_of
from camgeo.milling.moves import ArcFeed, Feed, Move, Rapid
from camgeo.milling.stages import (
    NOTHING,
    Known,
    parts,
    place_in,
    polygon,
    rings,
    swept,
    swept_below,
)

FEED = 100.0

RADIUS = 3.0

LINE: list[Move] = [Feed((20.0, 0.0, 0.0), FEED)]
ARC: list[Move] = [
    ArcFeed((-30.0, 0.0, 0.0), (0.0, 0.0), True, FEED),
    ArcFeed((30.0, 0.0, 0.0), (0.0, 0.0), True, FEED),
]


@pytest.mark.parametrize("fineness", [1e-2, 1e-3, 1e-4])
def test_a_line_and_a_ring(fineness: float) -> None:
    """The area is off by less than twice the fineness along the edge."""
    line = swept(course_of(LINE, (0.0, 0.0, 0.0)), RADIUS, fineness)
    assert line.area == pytest.approx(120.0 + math.pi * 9.0, abs=2.0 * fineness * 2.0 * math.pi * 3)
    ring = swept(course_of(ARC, (30.0, 0.0, 0.0)), RADIUS, fineness)
    edge = 2.0 * math.pi * (33.0 + 27.0)
    assert ring.area == pytest.approx(math.pi * (33.0**2 - 27.0**2), abs=2.0 * fineness * edge)
    outer, inner = rings(ring)
    for points, radius in ((outer, 33.0), (inner, 27.0)):
        assert np.max(np.abs(np.abs(points) - radius)) < 2.0 * fineness


def test_separate_pieces_are_joined_where_they_overlap() -> None:
    moves = [*LINE, Rapid((0.0, 5.0, 0.0)), Feed((20.0, 5.0, 0.0), FEED)]
    found = swept(course_of(moves, (0.0, 0.0, 0.0)), RADIUS, 1e-3)
    assert len(parts(found)) == 1
    apart = swept(course_of(moves, (0.0, 0.0, 0.0)), 2.0, 1e-3)
    assert len(parts(apart)) == 2
    assert abs(place_in(apart).imag) < 8.0


def test_nothing_is_swept_by_nothing() -> None:
    assert swept(course_of([]), RADIUS, 1e-3).is_empty
    assert parts(NOTHING) == []


def test_contours_within_contours_are_holes() -> None:
    found = polygon([Contour.circle(10.0), Contour.circle(4.0), Contour.circle(1.0)], 1e-4)
    assert found.area == pytest.approx(math.pi * (100.0 - 16.0 + 1.0), rel=1e-4)


@pytest.mark.parametrize("rounds", [2, 5])
def test_further_rounds_sweep_nothing_more(rounds: int) -> None:
    once = swept(course_of(ARC, (30.0, 0.0, 0.0)), RADIUS, 1e-3)
    again = swept(course_of(ARC * rounds, (30.0, 0.0, 0.0)), RADIUS, 1e-3)
    assert again.equals(once)
    assert len(again.exterior.coords) == len(once.exterior.coords)


def test_what_is_new_at_each_height_is_added() -> None:
    """Rounds at several depths, down a ramp each: as if each height were swept afresh."""
    fineness, step = 1e-3, 2.0
    moves: list[Move] = []
    for depth in (step, 2.0 * step):
        moves += [
            ArcFeed((-30.0, 0.0, -depth), (0.0, 0.0), True, FEED),
            ArcFeed((30.0, 0.0, -depth), (0.0, 0.0), True, FEED),
            ArcFeed((-30.0, 0.0, -depth), (0.0, 0.0), True, FEED),
        ]
        moves.append(Feed((30.0, 0.0, -depth), FEED))
    course = course_of(moves, (30.0, 0.0, 0.0))
    heights = [-5.0, -4.0, -3.1, -2.0, -1.3, 0.0, 1.0]
    found = swept_below(course, heights, RADIUS, fineness, {})
    for z, area in zip(heights, found, strict=True):
        afresh = swept(below(course, z), RADIUS, fineness)
        assert area.symmetric_difference(afresh).area < 4.0 * fineness * 4.0 * math.pi * 33.0
    assert found[0].is_empty
    assert found[-1] is found[-2]  # nothing is new there


def test_what_is_swept_again_is_the_same_object() -> None:
    """Ramps that end elsewhere in each pass, as read from a program, leave the areas as they are:
    what is asked of slabs is asked once.
    """
    around = [0.0, 0.4, 0.9, 2.0, 2.7, 3.5, 4.4, 5.2]
    moves: list[Move] = []
    for depth in range(1, 30):
        for lap in (around, [each + 0.01 * depth for each in around]):
            moves += [
                ArcFeed(
                    (30.0 * math.cos(end), 30.0 * math.sin(end), -depth), (0.0, 0.0), True, FEED
                )
                for end in [*lap[1:], lap[0]]
            ]
    course = course_of(moves, (30.0, 0.0, 0.0))
    heights = [-29.0 + 0.5 * k for k in range(58)]
    known: Known = {}
    found = swept_below(course, heights, RADIUS, 1e-3, known)
    assert len({id(each) for each in found}) == 1
    again = swept_below(course, heights[:1], RADIUS, 1e-3, known)
    assert again[0] is known[next(iter(known))][0]
