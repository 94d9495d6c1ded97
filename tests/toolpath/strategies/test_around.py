"""Rounds along a path: finishes, slots, descents, spring rounds, tabs."""

from __future__ import annotations

import math
import re
from dataclasses import replace

import numpy as np
import pytest

from camgeo.errors import GeometryError
from camgeo.geometry.contour.contour import distances
from camgeo.milling.cut import ContourCut, roughing_slack
from camgeo.milling.milling import Clamp, Tabs, ToolError
from camgeo.milling.moves import ArcFeed, Feed
from camgeo.numeric.arrays import FloatArray
from tests.findings import known
from tests.measuring import DensePath
from tests.part.parts import refused
from tests.toolpath.cutting import levels, steps_of
from tests.toolpath.plane.tracks import dense
from tests.toolpath.strategies.sound import (
    DISC,
    HEIGHTS,
    TOLERANCE,
    TOOL,
    descents,
    made,
    require_sound,
    round_hole,
    steepest,
)

FINISH = ContourCut(
    name="outline",
    strategy="profile",
    tool=TOOL,
    top=0.0,
    depths=(-8.0,),
    centre=DISC.offset(TOOL.radius),
    right="outline",
    room=TOOL.radius,
    cleared=True,
    springs=2,
)

SLOT = replace(FINISH, name="rough", strategy="slot", depths=(-3.0, -6.0, -8.0), springs=0)

RING = DISC.polyline(1e-4).contour.vertices

WALL = DensePath(RING)

TABS = Tabs(count=3, width=4.0, height=1.5)


@pytest.mark.parametrize("climb", [True, False])
@pytest.mark.parametrize("room", [0.25, 5.0])
def test_a_finish_runs_at_full_depth_with_spring_rounds(room: float, climb: bool) -> None:
    cut = replace(FINISH, room=room, climb=climb)
    moves = made(cut)
    require_sound(moves, rapids=3)
    track = levels(moves, 0.0)[-8.0]
    points = dense(track, 12)
    apart = WALL.distances(points)
    assert np.min(apart) >= TOOL.radius - TOLERANCE - 1e-4
    on = np.abs(apart - TOOL.radius) <= TOLERANCE + 1e-4
    assert np.mean(on) > 0.9
    assert np.max(apart) <= TOOL.radius + room + 1e-3
    # Three rounds, and leads; the second and the third take nothing off.
    once = cut.centre.arcs(TOLERANCE).contour.length
    assert 3.0 * once < track.length < 3.0 * once + 4.0 * max(room, TOOL.radius)
    area = 0.5 * np.sum((np.conj(points[:-1]) * points[1:]).imag)
    assert (area < 0.0) == climb


def test_a_finish_comes_down_beside_what_is_left_on_the_wall() -> None:
    """Beside a clamp only smaller leads fit, which end in that, unless the cutter may plunge."""

    def off(cut: ContourCut) -> FloatArray:
        moves = made(cut)
        ends = np.array([complex(*moves[k].end[:2]) for k in (0, -1)])
        found: FloatArray = WALL.distances(ends) - TOOL.radius
        return found

    cut = replace(FINISH, tabs=TABS, room=0.6, rest=0.5)
    assert off(cut) == pytest.approx(cut.room, abs=TOLERANCE + 1e-4)
    edge = float(np.max(RING.real)) + 2.0 * TOOL.radius + 0.45
    clamp = Clamp(place=complex(edge + 2.0, 0.0), length=4.0, width=80.0, height=6.0)
    beside = replace(cut, obstacles=(clamp.obstacle,))
    with pytest.raises(GeometryError, match="no room for a tangential lead-in"):
        made(beside)
    small = off(replace(beside, tool=replace(TOOL, plunges=True)))
    assert small == pytest.approx(0.5 * cut.room, abs=TOLERANCE + 1e-4)


def test_depths_of_a_finish_stay_down() -> None:
    cut = replace(FINISH, depths=(-4.0, -8.0), springs=0)
    moves = made(cut)
    require_sound(moves, rapids=3)
    assert tuple(levels(moves, 0.0)) == cut.depths
    assert all(way == 0.0 for way, _ in descents(moves))


def test_leads_of_compensation_begin_and_end_with_lines() -> None:
    moves = made(replace(FINISH, compensation="wear"))
    flat = [type(move) for move in moves if move.end[2] == -8.0]
    assert flat[:3] == [Feed, Feed, ArcFeed]  # the first straight down
    assert flat[-2:] == [ArcFeed, Feed]


def test_a_roughing_leaves_its_allowance_in_few_arcs() -> None:
    """No less than the allowance, and at most two slacks more."""
    allowance, slack = 0.5, roughing_slack(0.5)
    centre = DISC.offset(TOOL.radius + allowance + slack)
    cut = replace(SLOT, centre=centre, allowance=allowance, slack=slack)
    moves = made(cut)
    require_sound(moves)
    left = WALL.distances(dense(levels(moves, 0.0)[-8.0], 12)) - TOOL.radius
    assert np.min(left) >= allowance - 1e-4
    assert TOLERANCE < np.ptp(left) <= 2.0 * slack + 1e-4
    assert len(moves) < 0.8 * len(made(replace(cut, slack=0.0)))


def test_a_slot_comes_down_along_itself() -> None:
    moves = made(SLOT)
    require_sound(moves, rapids=3)
    down = descents(moves)
    assert down[0] == (0.0, HEIGHTS.retract)  # to the upper face, in air
    assert steepest(moves) > 0.0
    assert sum(drop for _, drop in down[1:]) == pytest.approx(8.0)
    # One full round at the bottom, and none deeper than a pass.
    found = levels(moves, 0.0)
    assert tuple(found) == (-8.0,)
    once = SLOT.centre.arcs(TOLERANCE).contour.length
    assert found[-8.0].length == pytest.approx(once)
    rounds = sum(way for way, _ in down[1:]) / once
    assert rounds == pytest.approx(round(rounds))
    assert 8.0 / rounds <= 3.0


def test_steep_descents_take_more_rounds() -> None:
    small = replace(SLOT, centre=round_hole(8.0).offset(5.0), left="", right="bore")
    moves = made(small)
    require_sound(moves)
    assert steepest(moves) > 0.0
    with pytest.raises(GeometryError, match="is too flat for it; at least"):
        made(replace(small, tool=replace(TOOL, ramp_angle=1e-5)))


def test_a_tool_that_plunges_may() -> None:
    moves = made(replace(SLOT, tool=replace(TOOL, plunges=True)))
    require_sound(moves)
    assert tuple(levels(moves, 0.0)) == SLOT.depths
    assert all(way == 0.0 for way, _ in descents(moves))


@pytest.mark.parametrize("cut", [SLOT, replace(FINISH, springs=0)])
def test_tabs_are_left(cut: ContourCut) -> None:
    """Over each the cutter stays above its top, over its width and the cutter's diameter."""
    moves = made(replace(cut, tabs=TABS))
    require_sound(moves)
    top = cut.bottom + TABS.height
    assert min(move.end[2] for move in moves) == cut.bottom
    # Where the last round is lifted: three stretches at the top of the tabs.
    steps = steps_of(moves)
    last = next(k for k, step in enumerate(steps) if step.low == cut.bottom)
    raised = [step for step in steps[last:] if step.high == step.low == pytest.approx(top)]
    along = sum(abs(step.end - step.start) for step in raised)
    assert along == pytest.approx(3.0 * (TABS.width + TOOL.diameter), rel=0.02)
    assert steepest(moves) > 0.0


def test_a_finish_leaves_the_tabs_of_the_roughing() -> None:
    rough = replace(SLOT, centre=DISC.offset(TOOL.radius + 0.4), allowance=0.4, tabs=TABS)
    finish = replace(FINISH, springs=0, room=0.4, tabs=TABS)
    middles = []
    for cut in (rough, finish):
        top = cut.bottom + TABS.height
        tabs: list[list[complex]] = []
        for step in steps_of(made(cut)):
            if step.high == step.low == pytest.approx(top):
                if not tabs or tabs[-1][-1] != step.start:
                    tabs.append([step.start])
                tabs[-1].append(step.end)
        assert len(tabs) >= TABS.count
        middles.append(np.array([0.5 * (tab[0] + tab[-1]) for tab in tabs[-TABS.count :]]))
    # Parallels 0.4 mm apart, whose lengths between two normals differ by that times their angle.
    assert np.max(np.abs(middles[0] - middles[1])) < 0.4 * 3.0


def test_tabs_that_do_not_fit_are_refused() -> None:
    with refused("holding.count", "there is room for"):
        made(replace(SLOT, tabs=replace(TABS, count=40)))


def test_ramps_that_do_not_fit_between_tabs_are_those_of_the_tool() -> None:
    """With the angle that the message asks for they fit; with a little less they do not."""

    def ramping(angle: float) -> ContourCut:
        tool = replace(SLOT.tool, plunges=False, ramp_angle=math.radians(angle))
        return replace(SLOT, tool=tool, tabs=replace(TABS, count=6))

    with pytest.raises(ToolError, match="do not fit between them") as caught:
        made(ramping(2.0))
    assert (caught.value.key, caught.value.number) == ("tool.ramp_angle", SLOT.tool.number)
    found = re.search(r"at least ([0-9.]+) degrees", caught.value.message)
    assert found is not None
    least = float(found[1])
    fits = ramping(1.01 * least)
    moves = made(fits)
    require_sound(moves, fits.tool)
    assert steepest(moves, known(fits.tool.ramp_angle)) > 0.0
    with pytest.raises(ToolError, match="do not fit between them"):
        made(ramping(0.99 * least))


def test_clamps_are_not_touched() -> None:
    there = complex(SLOT.centre.arcs(TOLERANCE).contour.vertices[3])
    clamp = Clamp(place=there, length=8.0, width=8.0, height=6.0)
    with refused("holding", "would touch the clamp"):
        made(replace(SLOT, obstacles=(clamp.obstacle,)))
    # Leads go where there is none.
    free = made(FINISH)
    start = complex(*free[0].end[:2])
    beside = Clamp(place=start * 1.1, length=4.0, width=4.0, height=6.0, round=True)
    moves = made(replace(FINISH, obstacles=(beside.obstacle,)))
    require_sound(moves)
    for track in levels(moves, 0.0).values():
        assert distances(np.array([beside.place]), track)[0] >= 2.0 + TOOL.radius - 1e-6
