"""Trochoidal slots: engagement, width, walls, entries, and the bound by which loops are spaced."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from camgeo.errors import GeometryError
from camgeo.geometry.contour.contour import Contour, distances
from camgeo.geometry.outline.path import whole
from camgeo.geometry.working_curve import WorkingCurve
from camgeo.milling.strategies import NARROWEST, ahead, engaged
from camgeo.milling.track import Track, chained
from camgeo.part.boundaries import CurveBoundary
from camgeo.part.part import Boundary
from tests.contour.cams import curves
from tests.long_form import examples
from tests.part.parts import refused
from tests.toolpath.cutting import engagements, levels, steps_of
from tests.toolpath.strategies.sound import (
    DISC,
    LIMIT,
    TOOL,
    cleared,
    descents,
    made,
    require_allowance,
    require_sound,
    steepest,
)
from tests.toolpath.strategies.test_inside import RING

FULL = Contour.circle(300.0)
"""A blank without an edge near the slot."""

CUT = cleared("trochoid", DISC, slot=16.0)


@pytest.mark.parametrize(("wall", "climb"), [(DISC, True), (RING, False)])
def test_engagement_keeps_its_limit(wall: Boundary, climb: bool) -> None:
    """By what the cutter has swept, independent of the spacing."""
    moves = made(replace(CUT, walls=(wall,), climb=climb))
    require_sound(moves)
    # Behind the first round of the helix.
    found = engagements(levels(moves, 0.0)[-8.0], FULL, TOOL.radius, 15, 6.0 * math.pi + 0.1)
    assert 0.5 * LIMIT < np.max(found) <= LIMIT


def test_one_entry_by_a_helix_and_no_retract() -> None:
    moves = made(CUT)
    require_sound(moves, rapids=3)
    assert sum(drop for _, drop in descents(moves)[1:]) == pytest.approx(8.0)
    assert steepest(moves) > 0.0


def test_the_slot_is_swept_up_to_the_allowance() -> None:
    """No core, no cusps along the wall, and no wider than it says."""
    (track,) = levels(made(replace(CUT, depths=(-4.0,))), 0.0).values()
    require_allowance(track, CUT, 0.05)
    for off in np.linspace(CUT.allowance + 0.1, CUT.allowance + CUT.slot - 0.6, 9):
        beside = DISC.offset(float(off)).arcs(0.01, "fast").contour.points(0.05)
        assert np.max(distances(beside, track)) <= TOOL.radius
    wall = Track.around(DISC.arcs(1e-3, "fast").contour)
    widest = np.max(distances(track.vertices, wall))
    assert widest <= CUT.allowance + CUT.slot - TOOL.radius + 1e-3


def test_the_contact_runs_at_the_feed_and_the_way_back_faster() -> None:
    inner = {
        round(step.feed * (step.radius + TOOL.radius) / step.radius, 6)
        for step in steps_of(made(CUT))
        if step.sweep > 0.0 and step.low == CUT.bottom and step.radius < 3.0
    }
    assert min(inner) == pytest.approx(TOOL.feed)
    assert all(each == pytest.approx(TOOL.feed) or each > 2.0 * TOOL.feed for each in inner)


@given(size=st.floats(0.6, 4.5), limit=st.floats(0.3, 1.5), turn=st.floats(0.05, 0.95))
@settings(max_examples=25, deadline=None)
def test_the_bound_holds_on_a_straight_wall(size: float, limit: float, turn: float) -> None:
    """Two loops, the second ahead by what the bound allows, at any place of it."""
    apart = ahead(size, 5.0, limit)
    assert engaged(size, 5.0, apart) == pytest.approx(limit, abs=2e-4)
    first = Track.arc(0j, 1j * size, 2.0 * math.pi)
    second = Track.arc(complex(apart), apart + 1j * size, 2.0 * math.pi)
    way = chained((first, Track.line(0j, complex(apart)), second))
    at = first.length + apart + turn * second.length
    (found,) = engagements(way, FULL, 5.0, 1, at)
    assert found <= limit + 1e-6


@settings(max_examples=examples(1, long=8), deadline=None)
@given(curve=curves(), diameter=st.floats(7.0, 14.0), share=st.floats(0.15, 0.5))
def test_any_disc(curve: WorkingCurve, diameter: float, share: float) -> None:
    wall = CurveBoundary("outline", hole=False, path=whole(curve))
    tool = replace(TOOL, diameter=diameter, engagement=math.radians(70.0))
    slot = diameter * (1.0 + share)
    cut = cleared("trochoid", wall, tool=tool, slot=slot, depths=(-2.0,), stepover=0.3 * diameter)
    try:
        moves = made(cut)
    except GeometryError:
        assume(False)  # no disc, or none for such a cutter
    require_sound(moves, tool)
    (track,) = levels(moves, 0.0).values()
    require_allowance(track, cut, 0.06)
    first = math.pi * (slot - diameter) + 0.1
    assert np.max(engagements(track, FULL, tool.radius, 5, first)) <= math.radians(70.0)


@pytest.mark.parametrize(
    ("changes", "key"),
    [
        ({"slot": TOOL.diameter * (1.0 + 0.5 * NARROWEST)}, "tool"),
        ({"tool": replace(TOOL, engagement=0.01)}, "tool.engagement"),
        ({"tool": replace(TOOL, diameter=40.0)}, "tool"),
    ],
)
def test_what_leaves_no_room_is_refused(changes: dict[str, Any], key: str) -> None:
    with refused(key):
        made(replace(CUT, **changes))
