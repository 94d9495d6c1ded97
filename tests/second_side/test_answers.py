"""What commands say of both sides, and what a scene must state of the second."""

from __future__ import annotations

from functools import cache
from pathlib import Path
from typing import Final

import numpy as np
import pytest

from camgeo.app.answers.answer import text, to_json
from camgeo.app.answers.check import check
from camgeo.app.answers.lint import Lint, lint
from camgeo.app.answers.setup import SetupSheet, html, setup_sheet
from camgeo.design.product import sides_of
from camgeo.errors import SceneError
from camgeo.milling.milling import HOW
from camgeo.pictures.backplot import figure
from camgeo.pictures.model import Area
from camgeo.scene.scene import parse_scene
from camgeo_export.gcode.writer import WRITER
from tests.answers.documents import validator
from tests.second_side.scenes import FACED, FROM_BELOW, TOLERANCE, design, scene, second

SIDE: Final = FROM_BELOW[FROM_BELOW.index("[second_side]") :]


@cache
def sheet_of(tables: str) -> SetupSheet:
    return setup_sheet(design(scene(tables)), TOLERANCE)


def test_the_sheet_has_a_part_for_each_side() -> None:
    sheet = sheet_of(FROM_BELOW)
    assert sheet.side == "first side"
    assert sheet.second is not None
    assert sheet.second.side == f"second side, the work {HOW['x']}"
    assert sheet.exit_code == 0
    shown = text(sheet)
    assert shown.count("Simulated: ") == 2
    first, other = shown.split("second side, the work turned over about X", 1)
    assert "blank     plate, 84 x 76 mm, 6 mm high" in first
    assert "Z 0 on what lies lowest" in other
    assert "screws: screw at 41, 37 mm, top at Z 14" in other
    page = html(sheet, "<svg></svg>")
    assert page.count("<h1>") == 2
    assert page.count("<h2>Backplot</h2>") == 1


def test_its_json_is_as_its_schema_says() -> None:
    document = to_json(sheet_of(FROM_BELOW))
    validator("camgeo.app.answers.setup").validate(document)
    assert document["second_side"]["side"].startswith("second side")
    assert [each["name"] for each in document["second_side"]["operations"]] == [
        "rough outline",
        "outline",
    ]
    alone = to_json(sheet_of(FROM_BELOW.partition("[second_side]")[0]))
    assert not {"side", "second_side"} & set(alone)


def test_the_check_judges_and_times_both() -> None:
    found = check(design(scene(FROM_BELOW)))
    assert found.machining is not None
    assert list(found.machining.programs) == ["both", "both-second-side"]
    assert found.exit_code == 0
    seconds = [each.seconds for each in found.machining.programs.values()]
    assert found.machining.seconds == pytest.approx(sum(each or 0.0 for each in seconds))
    assert "milling of both-second-side: simulated, nothing found" in text(found)
    validator("camgeo.app.answers.check").validate(to_json(found))


def test_the_backplot_shows_the_work_as_it_lies() -> None:
    disc = design(scene(FROM_BELOW, about="y")).disc
    first, *others = figure(disc).panels
    assert [first.title, *(each.title for each in others)] == [
        "chamfer outline",
        "second side: rough outline",
        "second side: outline",
    ]
    # The blank reaches from -39 to 45 on the first side, from -45 to 39 on the second.
    reach = []
    for panel in (first, others[0]):
        blank = panel.marks[0]
        assert isinstance(blank, Area)
        x = blank.rings[0][:, 0]
        reach.append((float(np.min(x)), float(np.max(x))))
    assert reach == [pytest.approx((-39.0, 45.0)), pytest.approx((-45.0, 39.0))]


def linted(
    tmp_path: Path,
    name: str,
    program: str,
    *,
    second_side: bool = False,
    tables: str = FROM_BELOW,
) -> Lint:
    path = tmp_path / f"{name}.ngc"
    path.write_text(program)
    known = design(scene(tables))
    return lint([path], "linuxcnc", design=known, second_side=second_side)


def test_lint_knows_the_side_by_what_a_program_says(tmp_path: Path) -> None:
    product = second(scene(FROM_BELOW))
    program = WRITER.write(product, TOLERANCE).data.decode()
    work = [
        each.found.rule
        for each in linted(tmp_path, "any", program).programs[0].findings
        if each.found.concerns == "work"
    ]
    assert work == []


def test_lint_is_told_the_side_of_a_program_that_does_not_say_it(tmp_path: Path) -> None:
    """From below it cuts the cam, from above its mirror image."""
    zero = 'zero = "front-left"\nzero_height = "blank-bottom"\n'
    tables = FROM_BELOW.replace(zero, "")
    program = WRITER.write(second(scene(tables)), TOLERANCE).data.decode()
    silent = "\n".join(line for line in program.splitlines() if not line.startswith("("))
    for told in (True, False):
        answer = linted(tmp_path, "silent", silent, second_side=told, tables=tables)
        rules = {each.found.rule for each in answer.programs[0].findings}
        assert rules == (set() if told else {"gouged-part", "rest"})


def test_lint_finds_what_goes_wrong_on_the_second_side(tmp_path: Path) -> None:
    """Its place is as the work lies, and its line that of the program."""
    product = second(scene(FROM_BELOW))
    program = WRITER.write(product, TOLERANCE).data.decode()
    wrong = program.replace("Z-0.3000", "Z-2.5000")
    found = linted(tmp_path, "both-second-side", wrong).programs[0].findings
    assert {each.found.rule for each in found} >= {"too-low"}
    line = next(each.line for each in found if each.found.rule == "too-low")
    assert line is not None
    assert "Z-2.5000" in wrong.splitlines()[line - 1]


def test_a_side_that_there_is_not_cannot_be_linted(tmp_path: Path) -> None:
    path = tmp_path / "a.ngc"
    path.write_text("M2\n")
    one_sided = design(scene(FACED.partition("[second_side]")[0]))
    with pytest.raises(SceneError, match="second_side: is not stated"):
        lint([path], "linuxcnc", design=one_sided, second_side=True)


@pytest.mark.parametrize(
    ("old", "new", "expected"),
    [
        ('turned_about = "{about}"\n', "", "second_side.turned_about: is missing"),
        ('"{about}"', '"z"', 'second_side.turned_about = "z": must be one of "x", "y"'),
        (SIDE[SIDE.index("[second_side.holding]") :], "", "second_side.holding: is missing"),
        (
            'kind = "rough"\nboundary = "outline"\ntool = 4',
            'kind = "rough"\nboundary = "outline"\ntool = 9',
            "second_side.operation[1].tool = 9: there is no such tool; there are 4, 5",
        ),
        (
            'zero_height = "blank-bottom"', 'work_offset = "G60"',
            'second_side.work_offset = "G60": must be one of "G54"',
        ),
        (
            'zero_height = "blank-bottom"', "clearance_height = 2",
            "second_side.retract_height",
        ),
        (
            'tool = 5\nsize = 0.4', 'tool = 5\nsize = 0.4\ndepth = 2',
            'operation[1].depth = 2: belongs to kinds "rough", "finish", "bore"',
        ),
        ("head_diameter = 24", "head_diameter = -1", "second_side.holding.screw[1].head_diameter"),
    ],
)  # fmt: skip
def test_a_wrong_second_side_is_refused_with_its_key(old: str, new: str, expected: str) -> None:
    wrong = FROM_BELOW.replace(old, new, 1)
    assert wrong != FROM_BELOW
    with pytest.raises(SceneError) as caught:
        _ = sides_of(design(scene(wrong)).disc)[1].milled.zero
    assert expected in str(caught.value)


@pytest.mark.parametrize(
    ("old", "new", "expected"),
    [
        ('kind = "screws"', 'kind = "tabs"', "needs second_side.holding.count: tabs need it"),
        ('kind = "screws"', 'kind = "clamps"', 'needs second_side.holding.clamp: kind "clamps"'),
        (
            'kind = "rough"\nboundary = "outline"', 'kind = "rough"',
            "needs second_side.operation[1].boundary: which wall",
        ),
        (
            "length = 84\nwidth = 76\n", "",
            'needs [stock] length and width of a plate, for second_side.zero = "front-left"',
        ),
    ],
)  # fmt: skip
def test_what_a_second_side_lacks_is_found(old: str, new: str, expected: str) -> None:
    lacking = design(scene(FROM_BELOW.replace(old, new, 1)))
    found = [each.sentence for each in check(lacking).formats]
    assert any(expected in each for each in found), found


def test_lengths_are_in_the_unit_of_the_scene() -> None:
    inches = scene(FROM_BELOW).replace("camgeo = 1", 'camgeo = 1\nunits.length = "inch"')
    inches = inches.replace("[second_side]", "[second_side]\nretract_height = 2", 1)
    milling = parse_scene(inches).milling
    assert milling is not None
    assert milling.second is not None
    assert milling.second.retract_height == 2 * 25.4
    screw, _ = milling.second.holding.clamps
    assert screw.length == 24 * 25.4
    assert milling.second_operations[0].allowance == 0.4 * 25.4
