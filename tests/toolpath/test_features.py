"""Programs of parts with a hub, a timing mark and holes: planned, stated, and what is left out."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

import camgeo
from camgeo.cam.cam import Contact
from camgeo.check.finding import Finding
from camgeo.design.milled import MilledDisc
from camgeo.errors import GeometryError, SceneError
from camgeo.milling.cut import AreaCut, LineCut
from camgeo.milling.judged import left_out
from camgeo.milling.machine import load
from camgeo.milling.moves import Feed, Stop
from camgeo.milling.plan import plan_toolpath
from camgeo.milling.strategies import STRATEGIES
from tests.toolpath.milled import ENGRAVER, HEIGHTS, HUB_TOOLS, HUBBED, named, sequence

SCENE = """
camgeo = 1
name = "hubbed"
[cam]
rotation = "ccw"
[follower]
kind = "translating-roller"
base_radius = 40
roller_radius = 8
[[motion]]
dwell = 60
[[motion]]
law = "polynomial-345"
span = 120
to = 15
[[motion]]
dwell = 60
[[motion]]
law = "polynomial-345"
span = 120
to = 0
[part]
thickness = 10
bore = 20
keyway = { standard = "DIN 6885-1" }
hub = { diameter = 38, height = 6 }
mark = { radius = 26, width = 2, length = 5, depth = 0.5, angle = 70 }
bolt_circle = { count = 3, circle = 52, hole = 4 }
[holding]
kind = "fixture"
through = 0.5
[[tool]]
number = 1
diameter = 12
flute_length = 20
stick_out = 30
spindle_speed = 3000
feed = 300
plunge_feed = 100
stepdown = 9
stepover = 5
[[tool]]
number = 2
kind = "drill"
diameter = 4
tip_angle = 118
spindle_speed = 3000
feed = 100
[[tool]]
number = 3
diameter = 2
spindle_speed = 6000
feed = 100
plunge_feed = 50
stepdown = 0.3
[output]
tolerance = 0.01
formats = ["gcode"]
[stock]
"""

ROUND_BLANK = 'shape = "round"\ndiameter = 102\ntop = 1\n'

STATED = """
[[operation]]
kind = "rough"
boundary = "hub"
tool = 1
allowance = 0.4
[[operation]]
kind = "finish"
boundary = "hub"
tool = 1
[[operation]]
kind = "drill"
boundary = "bolt hole"
tool = 2
[[operation]]
kind = "engrave"
tool = 3
[[operation]]
kind = "bore"
tool = 1
[[operation]]
kind = "rough"
boundary = "outline"
tool = 1
allowance = 0.4
[[operation]]
kind = "finish"
boundary = "outline"
tool = 1
"""


COUNTERBORED = SCENE.replace(
    "hole = 4 }", "hole = 4, counterbore = { diameter = 6, depth = 2 } }"
).replace("[output]", """[[tool]]
number = 4
diameter = 6
spindle_speed = 3000
feed = 100
plunge_feed = 50
plunges = true
stepdown = 2
[output]""")  # fmt: skip


def _milled(text: str) -> MilledDisc:
    return camgeo.loads(text).disc.milled


def _wrong(milled: MilledDisc) -> list[Finding]:
    found = milled.findings(milled.toolpath(0.01), 0.01)
    return [each for each in found if each.severity == "broken"]


@pytest.mark.parametrize("text", [SCENE, SCENE + ROUND_BLANK, SCENE + STATED, COUNTERBORED])
def test_the_simulation_leaves_the_part(text: str) -> None:
    milled = _milled(text)
    assert _wrong(milled) == []
    assert left_out(milled.part, milled.cuts) == ()
    if text.endswith(STATED):
        tops = {cut.name: cut.top for cut in milled.cuts}
        assert tops["rough hub"] == tops["rough bore"] == 0.0
        assert tops["engrave mark"] == tops["rough outline"] == tops["outline"] == -6.0


def test_a_deeper_hub_is_missed_by_the_simulation() -> None:
    """A test of the test: the same program in a part whose hub is wider leaves too little."""
    milled = _milled(SCENE)
    toolpath = milled.toolpath(0.01)
    other = _milled(SCENE.replace("diameter = 38", "diameter = 40"))
    names = {each.name for each in other.findings(toolpath, 0.01) if each.severity == "broken"}
    assert "gouge" in names


def test_what_is_left_out_is_not_judged() -> None:
    """By a planned sequence, and by one that is stated, which is told."""
    lines = SCENE.split("[[tool]]\nnumber = 2")
    assert _wrong(_milled(lines[0] + lines[1][lines[1].index("[output]") :])) == []
    stated = _milled(SCENE + STATED.replace(
        '[[operation]]\nkind = "engrave"\ntool = 3\n', ""))  # fmt: skip
    assert _wrong(stated) == []
    (told,) = (each for each in stated.sequence.findings if each.name == "left-out")
    assert (told.severity, told.sentence) == ("warning", "no operation makes mark")


@pytest.mark.parametrize("plunges", [True, False])
def test_a_slot_is_engraved_to_and_fro(plunges: bool) -> None:
    engraver = replace(ENGRAVER, plunges=plunges)
    cut = named(sequence(Contact.INNER, HUB_TOOLS[0], engraver, spec=HUBBED))["engrave mark"]
    assert isinstance(cut, LineCut)
    assert abs(cut.end - cut.start) == pytest.approx(3.0)
    moves = plan_toolpath((cut,), HEIGHTS, load("linuxcnc").arcs, 0.01).operations[0].moves
    ends = np.array([complex(*each.end[:2]) for each in moves if isinstance(each, Feed)])
    lowest = min(each.end[2] for each in moves if isinstance(each, Feed))
    assert lowest == cut.bottom == -6.5
    off = np.minimum(np.abs(ends - cut.start), np.abs(ends - cut.end))
    assert np.max(off) < 1e-12
    walked = [each for each in moves if not isinstance(each, Stop)]
    for one, other in pairwise(walked):
        if isinstance(other, Feed) and one.end[2] > other.end[2] and other.end[2] < cut.top:
            assert plunges == (one.end[:2] == other.end[:2])


def test_engagement_around_a_hub_in_a_plate() -> None:
    milled = _milled(SCENE)
    found = {each.operation: each for each in milled.engaged(milled.toolpath(0.01))}
    assert found["rough hub"].largest <= found["rough hub"].limit


def test_a_shank_that_meets_the_hub_is_told() -> None:
    """The outline's cutter reaches down 16.5 mm; above 12 mm its shank is 16 mm wide."""
    text = SCENE.replace("diameter = 38", "diameter = 63").replace(
        "flute_length = 20", "flute_length = 12\nshank_diameter = 16"
    )
    text = "\n".join(line for line in text.split("\n") if not line.startswith(("mark", "bolt")))
    text += "bore = 20\n"
    assert {each.name for each in _wrong(_milled(text))} == {"shank"}


def test_holes_beside_a_lower_hub_are_drilled_from_above() -> None:
    """Down to where the second side takes away what lies below the disc."""
    text = SCENE.replace("height = 6 }", 'height = 6, side = "both" }')
    text = text.replace("flute_length = 20\nstick_out = 30", "flute_length = 26\nstick_out = 30")
    turned = '[second_side]\nturned_about = "x"\n[second_side.holding]\nkind = "fixture"\n'
    milled = _milled(f"{text}{ROUND_BLANK.replace('top = 1', '')}{turned}through = 0\n")
    drilled = named(milled.sequence)["drill bolt hole 1, bolt hole 2, bolt hole 3"]
    assert drilled.top == -6.0
    assert drilled.bottom == pytest.approx(drilled.top - 10.0 - drilled.tool.tip_length)
    second = milled.second
    assert second is not None
    assert [cut.name for cut in second.cuts] == ["rough lower hub", "lower hub"]
    assert _wrong(milled) == _wrong(second) == []


def test_a_moat_lies_between_a_boss_and_a_wall() -> None:
    cut = named(sequence(Contact.INNER, *HUB_TOOLS, spec=HUBBED))["rough hub"]
    assert isinstance(cut, AreaCut)
    with pytest.raises(GeometryError, match="around a boss"):
        STRATEGIES["moat"](replace(cut, walls=cut.walls[::-1]), HEIGHTS, 0.01, "fast")


def test_the_scene_names_the_wrong_key() -> None:
    text = SCENE.replace("height = 6 }", 'height = 6, side = "both" }')
    with pytest.raises(SceneError, match=r"part\.hub\.side") as caught:
        _ = _milled(text).sequence
    assert "from there: state [second_side]" in str(caught.value)


def test_chamfers_that_no_operation_makes_are_told() -> None:
    """The program is that of the part with sharp edges."""
    edges = "chamfers = { outline = { width = 0.5 }, hub = { width = 1 } }\n[holding]"
    plain, edged = _milled(SCENE), _milled(SCENE.replace("[holding]", edges))
    assert [cut.name for cut in edged.cuts] == [cut.name for cut in plain.cuts]
    assert edged.part.bevels == ()
    found = {each.name: each for each in edged.findings(edged.toolpath(0.01), 0.01)}
    told = found["chamfers"]
    assert told.severity == "warning"
    assert told.sentence == "no operation makes the chamfers of outline, hub"
    assert "chamfers" not in {each.name for each in plain.findings(plain.toolpath(0.01), 0.01)}


def test_a_chamfer_round_a_bore_leaves_its_keyway_sharp() -> None:
    text = SCENE.replace(
        "hub = { diameter = 38, height = 6 }", "chamfers = { bore = { width = 1 } }"
    )
    text += """
[[tool]]
number = 9
kind = "chamfer-mill"
diameter = 8
tip_angle = 90
flute_length = 4
stick_out = 30
spindle_speed = 3000
feed = 300
plunge_feed = 100
[[operation]]
kind = "chamfer"
boundary = "bore"
tool = 9
size = 1
"""
    milled = _milled(text)
    told = [
        each for each in milled.findings(milled.toolpath(0.01), 0.01) if each.name == "chamfers"
    ]
    assert [(each.severity, each.sentence) for each in told] == [
        ("warning", "no operation makes the chamfers of lower edge of the bore"),
        ("warning", "upper edge of the bore: chamfer bore; it is made along the circle alone"),
    ]
