"""Programs of parts with a hub, a timing mark and holes: planned, stated, and what is left out."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

import camgeo
from camgeo.app.answers.answer import text
from camgeo.app.answers.check import check
from camgeo.app.answers.setup import setup_sheet
from camgeo.cam.cam import Contact
from camgeo.check.finding import Finding
from camgeo.design.design import Design
from camgeo.design.milled import MilledDisc, compared
from camgeo.errors import GeometryError, SceneError
from camgeo.milling.cut import AreaCut, LineCut
from camgeo.milling.judged import Feature, unmade_names
from camgeo.milling.machine import load
from camgeo.milling.moves import Feed, Stop
from camgeo.milling.plan import plan_toolpath
from camgeo.milling.strategies import cut_moves
from tests.answers.documents import document
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
    assert unmade_names(milled.part, milled.cuts) == ()
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
    with pytest.raises(GeometryError, match="between a boss and a wall"):
        cut_moves(replace(cut, strategy="moat", walls=cut.walls[::-1]), HEIGHTS, 0.01, "fast")


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
        ("warning", "upper edge of the bore: chamfer bore; only its circular part is made"),
    ]


# -- feature comparison ----------------------------------------------------------------------------
# Parts compared with their operations, feature by feature: check, JSON and setup sheet.


FOUND = Path(__file__).parents[2] / "fixtures" / "found"

CHAMFERED = (FOUND / "chamfer_contradicts_part.toml").read_text("utf-8")

CHAMFERS = "chamfers = { outline = { width = 0.8 }, bore = { width = 1 } }\n"
MARK = "mark = { radius = 26, width = 3, depth = 1, angle = 90 }\n"


@cache
def designed(scene: str) -> Design:
    """The design of a scene, computed once for all tests."""
    return camgeo.loads(scene)


def told(scene: str) -> dict[str, list[Finding]]:
    """The findings on the program, by their names, that are more than "ok"."""
    found = check(designed(scene)).machining
    assert found is not None
    names: dict[str, list[Finding]] = {}
    for each in found.findings:
        if each.severity != "ok":
            names.setdefault(each.name, []).append(each)
    return names


def test_a_chamfer_that_is_larger_than_that_of_the_part_is_refused(tmp_path: Path) -> None:
    design = designed(CHAMFERED)
    found = told(CHAMFERED)
    larger = found["chamfers"][-1]
    assert (larger.severity, larger.value, larger.limit, larger.unit) == ("broken", 2.0, 0.8, "mm")
    assert larger.sentence.startswith("upper edge of the outline: chamfer outline; 2 mm wide")
    assert check(design).exit_code == 1
    with pytest.raises(camgeo.errors.UnsafeError, match=r"the part states 0\.8 mm"):
        design.write(tmp_path, ["gcode"])
    assert not any(tmp_path.iterdir())
    sheet = setup_sheet(design)
    assert sheet.exit_code == 1
    assert "no gouge" not in text(sheet)
    assert f"BROKEN  {larger.sentence}" in text(sheet).splitlines()


def test_every_feature_is_named_with_what_makes_it() -> None:
    """In JSON of both answers the same."""
    design = designed(CHAMFERED)
    (program,) = document(check(design))["machining"]["programs"].values()
    rows = {each["name"]: each for each in program["features"]}
    assert document(setup_sheet(design))["features"] == program["features"]
    by = {name: (each["operations"], each["severity"]) for name, each in rows.items()}
    assert by == {
        "upper face": ([], "ok"),
        "lower face": ([], "ok"),
        "outline": (["outline"], "ok"),
        "bore": ([], "ok"),
        "mark": ([], "warning"),
        "keyway": ([], "warning"),
        "lower edge of the outline": ([], "warning"),
        "upper edge of the outline": (["chamfer outline"], "broken"),
        "lower edge of the bore": ([], "warning"),
        "upper edge of the bore": ([], "warning"),
    }
    assert (rows["upper edge of the outline"]["stated_mm"], 2.0) == (
        0.8,
        rows["upper edge of the outline"]["made_mm"],
    )
    assert "8 mm wide at 90 deg" in rows["keyway"]["sentence"]
    found = told(CHAMFERED)
    assert [each.sentence for each in found["left-out"]] == ["no operation makes mark"]
    assert found["chamfers"][0].sentence == (
        "no operation makes the chamfers of lower edge of the outline, bore"
    )


def edge(scene: str) -> Feature:
    """The upper edge of the outline."""
    features = compared(camgeo.loads(scene.replace(MARK, "")).disc.milled)
    (found,) = (each for each in features if each.name == "upper edge of the outline")
    return found


SIZE = "size = 2\n"


@pytest.mark.parametrize(
    ("changes", "severity", "words"),
    [
        ({}, "broken", ""),
        ({SIZE: "size = 0.9\n"}, "broken", ""),
        ({SIZE: "size = 0.8\n"}, "ok", ""),
        ({SIZE: "size = 0.5\n"}, "warning", ""),
        # 60 degrees at the point: as wide on the face, 0.8 / tan 30 = 1.39 mm high.
        (
            {SIZE: "size = 0.8\n", "tip_angle = 90": "tip_angle = 60"},
            "broken",
            "0.8 mm wide and 1.39 mm high",
        ),
        ({CHAMFERS: ""}, "warning", "2 mm wide, but the part states a sharp edge"),
    ],
)
def test_a_chamfer_of_another_shape_is_told(
    changes: dict[str, str], severity: str, words: str
) -> None:
    scene = CHAMFERED
    for old, new in changes.items():
        assert old in scene
        scene = scene.replace(old, new)
    found = edge(scene)
    assert found.severity == severity
    assert words in found.sentence


def test_what_the_blank_is_higher_is_told() -> None:
    """Its lower face is cut by nobody."""
    scene = CHAMFERED.replace("bottom = 0\n", "bottom = 1.5\n").replace('"screws"', '"fixture"')
    _, found, *_ = compared(camgeo.loads(scene).disc.milled)
    assert found.sentence == "lower face: no operation takes off 1.5 mm of the blank"
    assert (found.severity, found.stated, found.made) == ("warning", 0.0, 1.5)
