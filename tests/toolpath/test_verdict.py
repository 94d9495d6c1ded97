"""The verdict on programs: what must not be run, and what is to be watched."""

from __future__ import annotations

from pathlib import Path

import camgeo
from camgeo.check.finding import Finding

SCENES = Path(__file__).resolve().parents[2] / "fixtures" / "scenes"

ROUGH = '\n[[operation]]\nkind = "rough"\nboundary = "outline"\ntool = 1\nallowance = 0.4\n'
FINISH = '\n[[operation]]\nkind = "finish"\nboundary = "outline"\ntool = 1\n'
STEPS = "stepdown = 3\nstepover = 4\nramp_angle = 10"

BORE = """
[[operation]]
kind = "rough"
boundary = "bore"
tool = 1
[[operation]]
kind = "finish"
boundary = "bore"
tool = 1
"""


def findings(text: str) -> tuple[Finding, ...]:
    design = camgeo.loads(text)
    milled = design.disc.milled
    return milled.findings(milled.toolpath(0.01), 0.01)


def setzhub(operations: str) -> str:
    """Held below a frame, which comes loose, and is to be watched."""
    return (SCENES / "setzhub.toml").read_text() + operations


def test_a_rest_that_operations_mean_to_leave_is_to_be_watched() -> None:
    left, keyway, loose, rest = findings(setzhub(BORE + ROUGH))
    assert [keyway.name, left.name, loose.name] == ["keyway", "unlike-the-part", "loose-core"]
    assert left.sentence == "outline: rough outline; 0.4 mm are left on it"
    assert {keyway.severity, left.severity, loose.severity} == {"warning"}
    assert (rest.name, rest.severity) == ("rest", "warning")
    assert rest.value is not None
    assert rest.value > 0.39


def test_operations_that_finish_all_walls_leave_nothing() -> None:
    names = [each.name for each in findings(setzhub(BORE + ROUGH + FINISH))]
    assert names == ["keyway", "loose-core"]


def test_a_planned_program_must_leave_no_rest() -> None:
    """The blank is higher than the sequence, made without it, takes down."""
    design = camgeo.loads(setzhub(""))
    milled, spec = design.disc.milled, design.scene.milling
    toolpath = milled.toolpath(0.01)
    assert spec is not None
    thick = camgeo.loads(setzhub("").replace("[holding]", "[stock]\ntop = 1\n[holding]"))
    (rest,) = (each for each in thick.disc.milled.flaws(toolpath, 0.01) if each.name == "rest")
    assert not rest.watched


def test_tabs_hold_the_part_in_a_round_blank() -> None:
    """A spiral would clear away the frame that they hold on to."""
    tabs = 'kind = "tabs"\ncount = 4\nwidth = 5\nheight = 1.5\n'
    text = setzhub("").replace('kind = "fixture"\n', tabs).replace("stepdown = 3", STEPS)
    blank = '[stock]\nshape = "round"\ndiameter = 140\n[holding]'
    found = findings(text.replace("[holding]", blank))
    assert not any(each.severity == "broken" for each in found), found


def test_finishes_with_tabs_begin_in_the_slot() -> None:
    """Where its path begins, between two arcs, neither of which says where the slot runs."""
    tabs = 'kind = "tabs"\ncount = 4\nwidth = 5\nheight = 1.5\n'
    text = setzhub(ROUGH.replace("0.4", "1.4") + FINISH)
    text = text.replace('kind = "fixture"\n', tabs).replace("stepdown = 3", STEPS)
    found = findings(text)
    assert not any(each.severity == "broken" for each in found), found
