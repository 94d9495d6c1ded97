"""The result of `camgeo check`, rendered as text and as JSON."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from camgeo.answers.check import check
from camgeo.answers.render import text
from camgeo.design import Design
from camgeo.scene.load import load_scene
from camgeo.wording import clock
from tests.answers.documents import FIXTURES, SCENES, document, explained

SETZHUB = FIXTURES / "scenes" / "setzhub.toml"

TOOL = {
    "number": 1,
    "diameter": 10.0,
    "flute_length": 22.0,
    "spindle_speed": 3000.0,
    "feed": 300.0,
    "plunge_feed": 100.0,
    "stepdown": 3.0,
}


@pytest.mark.parametrize("scene", SCENES, ids=lambda path: path.stem)
def test_documents_are_what_their_schema_says(scene: Path) -> None:
    design = explained(scene)[0]
    found = check(design)
    reported = document(found)
    assert len(reported["findings"]) == len(design.findings)
    assert {name: len(each) for name, each in reported["effects"].items()} == {
        name: len(design.effects.findings(name)) for name in design.scene.effects
    }
    assert list(reported["discs"]) == [each.name for each in design.discs]
    assert text(found).count("\n") >= len(design.findings) - 1


def test_text_asks_for_no_outline_that_the_findings_do_not_need(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def refused(*_: object) -> None:
        raise AssertionError("an outline")

    monkeypatch.setattr("camgeo.answers.check._remains", refused)
    found = check(Design(load_scene(SETZHUB)))
    assert text(found)
    with pytest.raises(AssertionError, match="an outline"):
        document(found)


def test_text_and_document_are_of_one_result() -> None:
    found = check(Design(load_scene(SETZHUB)))
    first, *rest = found.findings
    sentence = "the linkage has gone"
    changed = replace(
        found, findings=(replace(first, sentence=sentence, severity="invalid"), *rest)
    )
    assert sentence in text(changed).splitlines()[0]
    assert text(changed).startswith("INVALID")
    assert document(changed)["findings"][0]["sentence"] == sentence
    assert (found.exit_code, changed.exit_code) == (0, 2)
    assert text(found).splitlines()[1:] == text(changed).splitlines()[1:]


@pytest.mark.parametrize("name", ["near_dead_centre", "dead_centre"])
def test_text_and_document_agree_on_a_linkage_near_a_dead_centre(name: str) -> None:
    """Near the limit the roller is harmless; at it there is no disc, and the rest is unknown."""
    found = check(Design(load_scene(FIXTURES / "found" / f"{name}.toml")))
    reported, dead = document(found), name == "dead_centre"
    worst = {each.name for each in found.findings if each.severity == "no-disc"}
    assert worst == ({"dead-centre"} if dead else set())
    assert text(found).count("NO DISC") == len(worst)
    remains = reported["discs"][name]["inner"]
    if dead:
        assert remains is None
        return
    (ratio,) = (each for each in found.findings if each.name == "radius-ratio-inner")
    assert "smallest r_K 26.8722 mm" in ratio.sentence
    assert remains["left_out_deg"] == []


def test_a_crank_that_its_slider_cannot_turn_has_no_disc() -> None:
    found = check(Design(load_scene(FIXTURES / "found" / "driven_crank_dead.toml")))
    (fatal,) = (each for each in found.findings if each.severity == "no-disc")
    assert fatal.name == "linkage-transmission-angle"
    assert "the slider cannot turn the crank there" in fatal.sentence
    assert "cam angle 72.4073 deg" in fatal.sentence
    assert found.exit_code == 1


def test_the_machining_time_of_each_operation() -> None:
    found = check(Design(load_scene(SETZHUB)))
    machining = found.machining
    assert machining is not None
    assert machining.machine == "LinuxCNC"
    names = [each.name for each in machining.operations]
    assert names[-1] == "outline"
    reported = document(found)["machining"]
    assert [each["name"] for each in reported["operations"]] == names
    assert sum(each["seconds"] for each in reported["operations"]) == pytest.approx(
        machining.seconds
    )
    (head,) = (line for line in text(found).splitlines() if line.startswith("machining on "))
    assert clock(machining.seconds) in head


def test_a_program_that_cannot_be_planned_has_a_reason() -> None:
    short = load_scene(SETZHUB).with_values({"tool": [{**TOOL, "flute_length": 5.0}]})
    machining = check(Design(short)).machining
    assert machining is not None
    assert machining.operations == ()
    assert machining.fault
    assert f"machining: {machining.fault}" in text(check(Design(short)))


def test_no_machining_without_a_tool_or_without_a_disc() -> None:
    bare = FIXTURES / "effects" / "conjugate_lever.toml"
    assert check(Design(load_scene(bare))).machining is None
    refused = FIXTURES / "refused" / "undercut_tappet.toml"
    assert check(Design(load_scene(refused))).machining is None
    assert document(check(Design(load_scene(bare))))["machining"] is None
