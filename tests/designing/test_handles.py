"""Handles: where they are, and the way back from where they are dropped."""

from __future__ import annotations

import math
import pathlib
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from camgeo.app.designing.handles import Handle, dragged, handles
from camgeo.design.design import Design
from camgeo.errors import CamgeoError, SceneError, UnknownNameError
from camgeo.pictures import motion
from tests.designing.scenes import CHOSEN, FILES, design, name_of

SETZHUB = design(FILES[[file.stem for file in FILES].index("setzhub")])

ROUNDING = 1e-6
"""Finest step of a value [mm or degrees]."""


def handle(of: Design, name: str) -> Handle:
    return next(each for each in handles(of) if each.name == name)


@pytest.mark.parametrize("file", CHOSEN, ids=name_of)
def test_a_handle_dropped_where_it_is_changes_nothing(file: pathlib.Path) -> None:
    own = design(file)
    found = list(handles(own))
    assert len({each.name for each in found}) == len(found)
    for each in found:
        for step in (None, 0.01, 1, [5.0, 0.2]):
            assert dragged(own, each.name, each.place, step)[1] == {}


@settings(max_examples=50, deadline=None)
@given(data=st.data())
def test_a_handle_is_where_it_was_dropped(data: st.DataObject) -> None:
    """Or as near to it as it can move; dropped there, it stays."""
    own = design(data.draw(st.sampled_from(FILES)))
    each = data.draw(st.sampled_from(list(handles(own))))
    way = st.floats(-3.0, 3.0)
    to = each.place[0] + data.draw(way), each.place[1] + data.draw(way)
    try:
        _, edits = dragged(own, each.name, to)
        after = Design(own.scene.with_values(edits))
    except CamgeoError:
        return  # it cannot be there
    there = handle(after, each.name)
    off = [abs(one - other) for one, other in zip(there.place, to, strict=True)]
    near = ROUNDING * _steepness(own, each)
    if each.space == "plan":
        joints = [float(angle) for angle in own.drive.plan.joints_deg]
        index = min(range(len(joints)), key=lambda k: abs(joints[k] - each.place[0]))
        inside = each.kind == "point" or joints[index - 1] < to[0] < joints[index + 1]
        assert off[0] <= near or "x" not in each.moves or not inside or each.kind == "point"
        assert off[1] <= near or "y" not in each.moves
    elif each.moves == "xy":
        assert math.hypot(*off) <= near
    elif each.moves == "x":
        assert off[0] <= near
    again = dragged(own, each.name, there.place)[1]
    assert again.keys() == edits.keys()
    for key, value in edits.items():
        assert _numbers(again[key]) == pytest.approx(_numbers(value), abs=3.0 * near)


def _steepness(own: Design, each: Handle) -> float:
    """How far a handle moves at most [mm] when one of its values moves by 1 mm, or 1 degree.

    An angle moves it by its distance; arm and base radius that meet at a small angle by the
    reciprocal of its sine.
    """
    if each.space == "plan":
        return 1.0
    follower = own.scene.follower
    assert follower is not None
    far = 1.0 + math.hypot(*each.place) + abs(follower.pivot or 0.0)
    here = complex(*each.place)
    arms = [here, here - (follower.pivot or 1j * here)]
    sine = abs((arms[0] * arms[1].conjugate()).imag) / max(abs(arms[0] * arms[1]), 1e-9)
    return far + 2.0 / max(sine, 0.02)


def _numbers(value: Any) -> list[float]:
    return [float(each) for each in value] if isinstance(value, list) else [float(value)]


def test_values_snap_to_round_steps() -> None:
    _, edits = dragged(SETZHUB, "roller centre", [-30.0, 40.0], 0.3)
    assert {key: float(value) for key, value in edits.items()} == {
        "follower.base_radius": 50.0,
        "follower.arm": 102.6,
    }


@pytest.mark.parametrize("shift", [0.05j, -0.05j])
def test_a_handle_stays_on_its_side(shift: complex) -> None:
    """The roller of an arm that lies counter-clockwise of the line from the pivot to the axis."""
    pivot = complex(*SETZHUB.scene.values["follower"]["pivot"])
    to = pivot * (0.4 + shift)
    allowed = shift.imag < 0.0  # seen from the pivot, the axis ahead
    if allowed:
        edits = dragged(SETZHUB, "roller centre", [to.real, to.imag])[1]
        after = SETZHUB.scene.with_values(edits).follower
        assert after is not None
        assert after.pivot is not None
        assert abs(after.pivot + after.start_arm - to) < 1e-3
        return
    with pytest.raises(SceneError) as caught:
        dragged(SETZHUB, "roller centre", [to.real, to.imag])
    assert caught.value.faults[0].key == "follower.arm_side"


def test_handles_of_the_plan_are_in_its_panel() -> None:
    figure = motion.figure(SETZHUB.disc)
    for each in handles(SETZHUB):
        if each.space == "plan":
            panel = figure.panels[each.panel]
            assert panel.y.label == "s [mm]"
            (low, high), (left, right) = panel.y.limits, panel.x.limits
            assert low < each.place[1] < high
            assert left < each.place[0] < right


@pytest.mark.parametrize("file", CHOSEN, ids=name_of)
def test_handles_of_the_mechanism_are_on_its_bodies(file: pathlib.Path) -> None:
    """In the picture at cam angle 0, which is made by other code."""
    own = design(file)
    if own.scene.follower is None:
        return
    sketch = own.disc.pictured.mechanism_sketch(0.0)
    # A lift table that is smoothed need not start at 0, where grips are.
    near = 1e-9 + abs(own.cam.follower.reach * own.drive.motion.jet(np.zeros(1))[0, 0])
    places = {
        "pivot": sketch.shafts,
        "joint": sketch.joints,
        "arm": [centre for centre, _ in sketch.rollers],
    }
    for each in handles(own):
        at = complex(*each.place)
        if each.kind in ("pivot", "joint", "arm") and each.space == "mechanism":
            assert min(abs(at - place) for place in places[each.kind]) < near
        elif each.kind == "roller":
            assert min(abs(abs(at - c) - radius) for c, radius in sketch.rollers) < near
        elif each.kind == "base-circle":
            assert abs(at) == pytest.approx(own.scene.follower.base_radius)
        elif each.name in ("face start", "face end"):
            (start, end), *_ = sketch.faces
            assert abs(((at - start) / (end - start)).imag) < 1e-9


@pytest.mark.parametrize(
    ("to", "step"),
    [
        (None, None), ([1], None), ([1, "2"], None), ([True, 1], None), ([math.nan, 1], None),
        ([1, math.inf], None), ([1e10, 0], None), ([10**400, 0], None), ({}, None),
        ([1, 1], 0), ([1, 1], -1), ([1, 1], "1"), ([1, 1], [1]), ([1, 1], math.nan), ([1, 1], {}),
    ],
)  # fmt: skip
def test_places_and_steps_that_are_none_are_refused(to: Any, step: Any) -> None:
    with pytest.raises(SceneError):
        dragged(SETZHUB, "pivot", to, step)


def test_a_handle_that_there_is_not_is_refused() -> None:
    with pytest.raises(UnknownNameError):
        dragged(SETZHUB, "handle", [0, 0])
