"""The setup sheet: its document, its text and its page."""

from __future__ import annotations

import math
import re
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path

import pytest

from camgeo.app.answers.answer import text
from camgeo.app.answers.setup import SetupSheet, html, setup_sheet
from camgeo.app.cli.main import main
from camgeo.design.design import Design
from camgeo.milling.plan import OperationEngagement
from camgeo.milling.simulation import Flaw
from camgeo.scene.scene import load_scene
from tests.answers.documents import FIXTURES, document

SETZHUB = FIXTURES / "scenes" / "setzhub.toml"

FLAW = Flaw("gouge", "outline", "goes <too> deep & far", 0.3, 0.02, (1.0, 2.0, -3.0))

VOID = {"meta"}


@pytest.fixture(scope="module")
def sheet() -> SetupSheet:
    return setup_sheet(Design(load_scene(SETZHUB)))


class Tags(HTMLParser):
    """Checks that all elements are closed, and keeps the texts."""

    def __init__(self) -> None:
        super().__init__()
        self.open: list[str] = []
        self.texts: list[str] = []

    def handle_starttag(self, tag: str, attrs: object) -> None:
        if tag not in VOID:
            self.open.append(tag)

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        self.texts.append(data)


def test_a_flaw_of_the_simulated_program_is_the_verdict(sheet: SetupSheet) -> None:
    assert sheet.exit_code == 0
    assert "which the fixture must hold, comes loose" in text(sheet)
    assert "nothing comes loose" in text(replace(sheet, flaws=()))
    wrong = replace(sheet, flaws=(FLAW,))
    assert wrong.exit_code == 1
    assert FLAW.sentence in text(wrong)
    assert "nothing comes loose" not in text(wrong)
    assert document(wrong)["flaws"][0]["place"] == [1.0, 2.0, -3.0]


def test_the_operator_reads_notes_stops_and_what_is_left_to_be_done() -> None:
    scene = FIXTURES / "milling" / "moved_clamps.toml"
    found = setup_sheet(Design(load_scene(scene)))
    (second,) = (each for each in found.steps if each.stops)
    noted = [each for each in found.steps if each.operation.cut.note]
    assert "clamp at 0, -40 mm, top at Z 10, until rough outline" in found.holding
    assert "clamp at 0, 0 mm, top at Z 10, from rough outline on" in found.holding
    told = ("a skin of 0.3 mm is left below the part, to be removed by hand",)
    found = replace(found, remarks=told)
    assert told[0] in text(found)
    shown = html(found, "<svg></svg>")
    assert all(each in shown for each in (second.stops[0], noted[0].operation.cut.note, *told))
    assert setup_sheet(Design(load_scene(scene.parent / "onion_skin.toml"))).remarks == told


def test_the_engagement_of_an_operation_that_clears_an_area(sheet: SetupSheet) -> None:
    found = OperationEngagement("bore", 100.0, 0.071, 0.8, 0.9, 0.95, 1j)
    steps = (replace(sheet.steps[0], engaged=found), *sheet.steps[1:])
    changed = replace(sheet, steps=steps)
    in_air = f"{steps[0].operation.name}: 7 % of its length is in air, the cutter is engaged over"
    assert in_air in text(changed)
    first, *others = (each["engagement"] for each in document(changed)["operations"])
    assert first["air"] == 0.071
    assert first["largest_deg"] == pytest.approx(math.degrees(0.9))
    assert others == [None] * len(others)


def test_it_says_what_the_offsets_of_compensated_tools_hold(sheet: SetupSheet) -> None:
    scene = sheet.scene.with_values({"output.gcode.compensation": "wear"})
    worn = setup_sheet(Design(scene))
    told = {step.operation.name: step.compensation for step in worn.steps if step.compensation}
    assert set(told) == {"bore", "outline"}
    for name, sentence in told.items():
        assert f"{name}: {sentence}" in text(worn)
        assert f"<li>{name}: {sentence}</li>" in html(worn, "<svg></svg>")
        assert re.search(r"holds twice the wear alone.* at most 0\.\d+ mm either way", sentence)
    told = {each["name"]: each["compensation"] for each in document(worn)["operations"]}
    assert told == {step.operation.name: step.compensation for step in worn.steps}
    assert not any(step.compensation for step in sheet.steps)


def test_texts_of_the_page_are_escaped(sheet: SetupSheet) -> None:
    tools = (replace(sheet.tools[0], name="<b>mill</b> & co"),)
    page = html(replace(sheet, tools=tools, flaws=(FLAW,)), "<svg></svg>")
    assert "<b>" not in page
    assert "&lt;b&gt;mill&lt;/b&gt; &amp; co" in page
    assert "goes &lt;too&gt; deep &amp; far" in page
    tags = Tags()
    tags.feed(page)
    assert tags.open == []
    assert "<b>mill</b> & co" in "".join(tags.texts)


def test_a_page_stands_alone(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "setup.html"
    assert main(["setup", str(SETZHUB), "-o", str(file)]) == 0
    page = file.read_text("utf-8")
    assert page.count("<svg") == 1
    tags = Tags()
    tags.feed(page)
    assert tags.open == []
    # Nothing is loaded: the only addresses are names of XML.
    assert set(re.findall(r"(?:src|href)=\"([^#\"]+)", page)) == set()
    assert "script" not in page
    assert "outline" in capsys.readouterr().out
    again = tmp_path / "again.html"
    main(["setup", str(SETZHUB), "-o", str(again)])
    assert again.read_bytes() == file.read_bytes()
