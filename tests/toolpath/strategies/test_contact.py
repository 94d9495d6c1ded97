"""No strategy runs the contact of cutter and wall faster than the tool's feed."""

from __future__ import annotations

from dataclasses import replace

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from camgeo.milling.cut import AreaCut, ContourCut, Cut
from tests.long_form import examples
from tests.toolpath.cutting import steps_of
from tests.toolpath.strategies import test_around, test_inside, test_others, test_outside
from tests.toolpath.strategies.sound import TOOL, cleared, made, require_sound, round_hole

CUTS: tuple[Cut, ...] = (
    test_around.FINISH,
    test_around.SLOT,
    replace(test_around.SLOT, centre=round_hole(9.0).offset(TOOL.radius), right="bore"),
    test_outside.CUT,
    test_inside.CUT,
    replace(test_inside.CUT, walls=(round_hole(7.0),)),
    replace(test_inside.CUT, walls=(test_inside.RING,)),
    test_others.FACE,
    test_others.GROOVE,
)


def slowest(cut: Cut) -> float:
    """Feed of the slowest level arc [mm/min], none of whose contacts is faster than the tool's.

    The wall is on the right of a cutter that climbs: its contact is farther from the middle of an
    arc to the left than the centre is, and nearer to that of one to the right.
    """
    moves = made(cut)
    require_sound(moves, cut.tool)
    found = cut.tool.feed
    for step in steps_of(moves):
        if not step.sweep or step.low < step.high:
            continue
        arm, outside = step.radius, (step.sweep > 0.0) == cut.climb
        at_contact = abs(arm + cut.contact_radius) if outside else abs(arm - cut.contact_radius)
        if outside or arm > cut.contact_radius:
            assert step.feed * at_contact / arm <= cut.tool.feed * (1.0 + 1e-9)
        found = min(found, step.feed)
    return found


@pytest.mark.parametrize(
    ("cut", "climb"),
    [
        pytest.param(cut, climb, id=f"{cut.strategy}-{cut.name}-{climb}")
        for cut in CUTS
        for climb in (True, False)
    ],
)
def test_the_contact_is_no_faster_than_the_feed(cut: Cut, climb: bool) -> None:
    cut = replace(cut, climb=climb)
    assert slowest(cut) <= cut.tool.feed
    if isinstance(cut, AreaCut) and cut.walls and cut.walls[0].hole:
        assert slowest(cut) < 0.95 * cut.tool.feed


@settings(max_examples=examples(5, long=10), deadline=None)
@given(radius=st.floats(5.8, 30.0), diameter=st.floats(4.0, 11.0), finish=st.booleans())
def test_bores(radius: float, diameter: float, finish: bool) -> None:
    """Of any size: the last round at its wall runs at the stated feed there."""
    tool, wall = replace(TOOL, diameter=diameter, stepover=0.3 * diameter), round_hole(radius)
    cut: Cut = cleared("bore", wall, tool=tool, depths=(-2.0,), allowance=0.05, stepover=0.9)
    arm = radius - 0.5 * diameter
    if finish:
        cut = ContourCut(
            name="bore", strategy="profile", tool=tool, top=0.0, depths=(-2.0,),
            centre=wall.offset(tool.radius), right="bore", room=0.5 * arm, cleared=True,
        )  # fmt: skip
    assert slowest(cut) <= tool.feed * arm / (arm + tool.radius) * (1.0 + 1e-9)
