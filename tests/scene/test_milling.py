"""The tables on milling: faults with key and line, units, libraries, identity."""

from __future__ import annotations

import math
import re
from pathlib import Path

import pytest

from camgeo.app.answers.check import check
from camgeo.app.answers.setup import setup_sheet
from camgeo.design.design import Design
from camgeo.errors import SceneError
from camgeo.milling.milling import Clamp, Tabs, Tool
from camgeo.scene.formats.format import find_format
from camgeo.scene.scene import Scene, load_scene, parse_scene
from tests.findings import known
from tests.scene.scenes import PLATE, refusal_by, refusal_of, spoilt

HEAD = PLATE[: PLATE.index("[[tool]]")]
TOOL = PLATE[PLATE.index("[[tool]]") : PLATE.index("[holding]")]
HOLDING = PLATE[PLATE.index("[holding]") :]


def faults(*tables: str) -> list[str]:
    return [str(fault) for fault in refusal_of(HEAD + "".join(tables)).faults]


def tool(*changes: tuple[str, str]) -> str:
    return spoilt(TOOL, *changes)


@pytest.mark.parametrize(
    ("tables", "expected"),
    [
        ((tool(("plunge_feed", "plunge_fed")), HOLDING), "did you mean plunge_feed"),
        (
            (tool(("stepdown = 3", "stepdown = 3\ncorner_radius = 6")), HOLDING),
            "tool[1].corner_radius = 6: must be at most half the diameter, 5 mm",
        ),
        ((TOOL, TOOL, HOLDING), "tool[2].number = 1: is the number of another tool"),
        (
            (TOOL, HOLDING, '[[operation]]\nkind = "bore"\ntool = 7\n'),
            "operation[1].tool = 7: there is no such tool; there are 1",
        ),
        ((TOOL, spoilt(HOLDING, ("fixture", "clamp"))), 'holding.kind = "clamp": must be one of'),
    ],
)
def test_faults(tables: tuple[str, ...], expected: str) -> None:
    found = faults(*tables)
    assert len(found) == 1, found
    assert expected in found[0]


def lacking(*tables: str) -> list[str]:
    """What a scene that can be checked lacks for its program."""
    scene = parse_scene(HEAD + "".join(tables))
    found = scene.lacking([find_format("gcode")])
    assert {fault.key for fault in found} <= {"output.formats[2]"}
    assert (scene.milling is None) >= any("[1]." in fault.message for fault in found)
    told = check(Design(scene))
    assert told.machining is None
    assert [each.sentence for each in told.formats] == [str(fault) for fault in found]
    assert [each.severity for each in told.formats] == ["broken"] * len(found)
    assert told.exit_code == 1
    return [fault.message for fault in found]


@pytest.mark.parametrize(
    ("tables", "expected"),
    [
        (
            (tool(("spindle_speed = 3000\n", "")), HOLDING),
            "needs tool[1].spindle_speed: state it or cutting_speed; there is no default",
        ),
        (
            (tool(("\nfeed = 300", "")), HOLDING),
            "needs tool[1].feed: state it or chip_load; there is no default",
        ),
        (
            (tool(("\nfeed = 300", "\nchip_load = 0.03")), HOLDING),
            "needs tool[1].flutes: chip_load needs it",
        ),
        ((tool(("stepdown = 3\n", "")), HOLDING), "needs tool[1].stepdown: the largest depth of"),
        ((tool(("plunge_feed = 100\n", "")), HOLDING), "needs tool[1].plunge_feed: the feed of"),
        ((TOOL, '[stock]\nshape = "round"\n', HOLDING), "needs stock.diameter: a round blank"),
        ((TOOL, "[stock]\nwidth = 3\n", HOLDING), "needs stock.length: a plate states"),
        ((TOOL,), "needs [holding]: a cut goes through the blank, and what it cuts free must"),
        ((HOLDING,), "needs [[tool]]: a tool, and how it is run"),
        ((TOOL, spoilt(HOLDING, ("through = 0.5\n", ""))), "needs holding.through: how far"),
        (
            (TOOL, '[holding]\nkind = "tabs"\nthrough = 0.5\ncount = 4\nwidth = 5\n'),
            "needs holding.height: tabs need it",
        ),
        (
            (TOOL, '[holding]\nkind = "screws"\nthrough = 0.5\n'),
            'needs holding.screw: kind "screws" needs it at least once',
        ),
        (
            (TOOL, HOLDING, '[[operation]]\nkind = "finish"\ntool = 1\n'),
            'needs operation[1].boundary: which wall is to be cut by "finish"',
        ),
    ],
)
def test_what_a_program_lacks_is_found_and_refused(
    tables: tuple[str, ...], expected: str, tmp_path: Path
) -> None:
    """The scene is checked all the same, and its other files are made."""
    (found,) = lacking(*tables)
    assert found.startswith(expected)
    design = Design(parse_scene(HEAD + "".join(tables)))
    with pytest.raises(SceneError, match=re.escape(f'"gcode": {found}')):
        design.write(tmp_path)
    with pytest.raises(SceneError, match=re.escape(f'"gcode": {found}')):
        setup_sheet(design)
    assert not any(tmp_path.iterdir())
    assert len(design.write(tmp_path, ["dxf"]).files) == 1


def test_a_program_that_nobody_asks_for_lacks_something() -> None:
    """It is told, and breaks nothing."""
    scene = parse_scene(HEAD.replace(', "gcode"', "") + TOOL)
    found = check(Design(scene))
    (own,) = found.formats
    assert (own.severity, found.exit_code, found.machining) == ("ok", 0, None)
    assert own.sentence.startswith("format = gcode: needs [holding]")


def test_a_tool_lacks_what_its_operation_needs() -> None:
    """A stepover is needed by some operations only, so that the plan asks for it."""
    face = "[stock]\nlength = 200\nwidth = 200\ntop = 1\n"
    found = check(Design(parse_scene(HEAD + TOOL + face + HOLDING)))
    (own,) = known(found.machining).findings
    assert (own.severity, found.exit_code) == ("broken", 1)
    assert "tool[1].stepover: tool 1 states no stepover" in own.sentence


def test_all_that_is_lacking_is_reported_at_once() -> None:
    bare = "[[tool]]\nnumber = 1\ndiameter = 6\n"
    found = lacking(bare, '[holding]\nkind = "onion-skin"\n')
    assert len(found) == 5, found
    text = "\n".join(found)
    for key in ("spindle_speed", "feed", "plunge_feed", "stepdown"):
        assert f"needs tool[1].{key}: " in text
    assert "needs holding.thickness: onion skin need it" in text


def test_earlier_keys_lack_what_nobody_may_invent() -> None:
    text = HEAD.replace('machine = "linuxcnc"', "tool_diameter = 8") + HOLDING
    found = [fault.message for fault in parse_scene(text).lacking([find_format("gcode")])]
    keys = ("spindle_speed", "feed", "plunge_feed", "pass_depth")
    assert [each.partition(":")[0] for each in found] == [
        f"needs output.gcode.{key}" for key in keys
    ]
    assert "has no default; preferably state the tool in [[tool]]" in found[0]
    whole = text.replace(
        "tool_diameter = 8",
        "tool_diameter = 10\nspindle_speed = 3000\nfeed = 300\nplunge_feed = 100\npass_depth = 3",
    )
    told = Design(parse_scene(whole)).disc.milled.notes
    assert any("earlier keys of [output.gcode], which are still read" in each for each in told)
    both = spoilt(PLATE, ('machine = "linuxcnc"', "pass_depth = 3"))
    with pytest.raises(SceneError, match=r"contradicts \[\[tool\]\]: state it as stepdown there"):
        parse_scene(both)


def test_speed_and_feed_follow_from_what_is_stated() -> None:
    text = tool(
        ("spindle_speed = 3000", "cutting_speed = 120\nflutes = 3"),
        ("\nfeed = 300", "\nchip_load = 0.04"),
        ("stepdown = 3", "stepdown = 3\nramp_angle = 3\nengagement = 60"),
    )
    scene = parse_scene(HEAD + text + HOLDING)
    (found,) = known(scene.milling).tools
    speed = 3820  # 120e3 / (10 pi) is 3819.7
    assert found.spindle_speed == speed
    assert found.feed == pytest.approx(0.04 * 3 * speed, rel=1e-15)
    assert found.ramp_angle == pytest.approx(math.radians(3.0))
    assert found.engagement == pytest.approx(math.radians(60.0))


def test_holding_and_stock_are_converted() -> None:
    tables = """[stock]
shape = "round"
diameter = 6
centre = [0.5, -1]
top = 0.1
[holding]
kind = "tabs"
through = 0.02
count = 4
width = 0.25
height = 0.08
[[holding.clamp]]
place = [2, 0]
length = 1
width = 0.5
angle = 90
height = 0.4
until = "rough outline"
"""
    head = HEAD.replace('"mm"', '"inch"').replace("tolerance = 0.001", "tolerance = 0.0001")
    milling = known(parse_scene(head + TOOL + tables).milling)
    assert milling.stock.diameter == 6 * 25.4
    assert milling.stock.centre == complex(12.7, -25.4)
    assert known(milling.holding).tabs == Tabs(4, 6.35, 0.08 * 25.4)
    clamp = Clamp(
        place=50.8 + 0j, length=25.4, width=12.7, height=0.4 * 25.4, angle=0.5 * math.pi,
        until="rough outline",
    )  # fmt: skip
    assert known(milling.holding).clamps == (clamp,)


def library(folder: Path, text: str) -> Scene:
    (folder / "shop.toml").write_text(text)
    scene = folder / "scene.toml"
    stated = HEAD.replace('machine = "linuxcnc"', 'tools = "shop.toml"')
    scene.write_text(stated + HOLDING)
    return load_scene(scene)


def test_a_library_has_tools_in_its_own_unit(tmp_path: Path) -> None:
    text = (
        '[units]\nlength = "inch"\n[[tool]]\nnumber = 7\ndiameter = 0.5\nspindle_speed = 3000\n'
        "feed = 10\nplunge_feed = 3\nstepdown = 0.1\n"
    )
    scene = library(tmp_path, text)
    assert known(scene.milling).tools == (
        Tool(number=7, diameter=12.7, spindle_speed=3000.0, feed=254.0, plunge_feed=3 * 25.4,
             stepdown=2.54),
    )  # fmt: skip
    assert {cut.tool.number for cut in Design(scene).disc.milled.cuts} == {7}
    # The scene's identities are those of what the file holds.
    other = library(tmp_path, text.replace("feed = 10", "feed = 11"))
    assert other.made != scene.made
    assert other.identity != scene.identity


def test_faults_of_a_library_are_those_of_its_key(tmp_path: Path) -> None:
    caught = refusal_by(
        library, tmp_path, "[[tool]]\nnumber = 7\ndiameter = -1\nspindle_speed = 300\nfeeds = 1\n"
    )
    assert {fault.key for fault in caught.faults} == {"output.gcode.tools"}
    messages = "\n".join(fault.message for fault in caught.faults)
    assert "line 3: tool[1].diameter: must be a positive number" in messages
    assert "tool[1].feeds: is not a known key" in messages


@pytest.mark.parametrize(
    "change",
    [
        {"tool[1].feed": 301},
        {"tool[1].stepdown": 2.5},
        {"holding.through": 0.6},
        {"stock": {"bore": 5}},
        {"operation": [{"kind": "finish", "boundary": "outline", "tool": 1}]},
    ],
)
def test_files_name_all_that_decides_their_bytes(change: dict[str, object]) -> None:
    scene = parse_scene(PLATE)
    assert scene.with_values(change).made != scene.made


def test_defaults_are_what_their_absence_stands_for() -> None:
    scene = parse_scene(PLATE)
    stated = scene.with_values(
        {"tool[1].kind": "end-mill", "tool[1].plunges": False, "stock": {"shape": "plate"}}
    )
    assert stated.milling == scene.milling
    assert scene.with_values({"tool[1].kind": "end-mill"}).made == scene.made


def test_a_library_that_cannot_be_read_is_one_fault(tmp_path: Path) -> None:
    """Its tools are not told to be missing, too."""
    stated = HEAD.replace('machine = "linuxcnc"', 'tools = "none.toml"')
    operation = '[[operation]]\nkind = "rough"\nboundary = "outline"\ntool = 3\n'
    (fault,) = refusal_of(stated + HOLDING + operation, str(tmp_path / "s.toml")).faults
    assert fault.key == "output.gcode.tools"
    assert "cannot be read" in fault.message
