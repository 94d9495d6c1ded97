"""`camgeo accuracy`: tables, JSON, picture, advice."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace
from decimal import Decimal
from pathlib import Path
from typing import Any

import pytest

from camgeo.pictures.accuracy import figure
from camgeo.pictures.model import Line, Rule, Text
from camgeo.studies.accuracy import survey as surveys
from camgeo.studies.accuracy.benefit import BenefitRow, find_knee
from camgeo.studies.accuracy.contours import FORMS, ContourRow, SolidRow, TableRow
from camgeo.studies.accuracy.survey import BillRow, Survey
from camgeo.units import RPM
from camgeo_export.plots import render
from tests import kept
from tests.accuracy.rows import EFFECTS, ROUNDED, file, missing, row
from tests.answers.documents import validator
from tests.cli.calling import SCENES, Called, called, changed

SETZHUB = SCENES / "setzhub.toml"

TOLERANCES = (1e-2, 1e-3)


def made_up() -> Survey:
    contours: list[ContourRow] = []
    for form in FORMS:
        seconds = None if form == "spline" else 47.9
        decimals = 4 if form == "arcs" else None
        measured = zip((1200, 2400), (0.221, 0.105), TOLERANCES, strict=True)
        for pieces, ripple, tolerance in measured:
            contours.append(
                row(
                    form,
                    tolerance,
                    10 * pieces if form == "polyline" else pieces,
                    size=23_456,
                    seconds=seconds,
                    decimals=decimals,
                    ripple=None if seconds is None else ripple,
                )
            )
    contours.append(missing("spline", 1e-4))
    solids = (
        SolidRow("stl", 1e-2, file(45_284, triangles=904)),
        SolidRow("stl", 1e-6, None, "the numbers are too coarse"),
    )
    tables = (TableRow(Decimal("0.5"), 720, 249_114, 0.0131, 1.7e-3),)
    own = [each for each in contours if each.form == "arcs"]
    return Survey(tuple(contours), solids, tables, find_knee(own))


@pytest.fixture
def found(monkeypatch: pytest.MonkeyPatch) -> list[dict[str, Any]]:
    """The arguments that the survey gets; it measures nothing here."""
    asked: list[dict[str, Any]] = []

    def survey(design: Any, tolerances: Any, **options: Any) -> Survey:
        asked.append({"name": design.name, "tolerances": tolerances, **options})
        return made_up()

    monkeypatch.setattr(surveys, "survey", survey)
    return asked


def call(*words: object) -> Called:
    return called("accuracy", *words)


def test_what_is_said_is_as_kept(
    found: list[dict[str, Any]], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Tables and documents, with effects and benefits; seconds and ripple are of `made_up`."""
    whole = replace(made_up(), effects=EFFECTS, rounded=ROUNDED)
    fault = replace(
        at_speed()[2], fault="cannot be reached", acceleration=None, lift_off_speed=math.inf
    )
    heard = replace(at_speed()[0], octaves=(20.0, 30.0, 10.0), octave_error=1e-9, strongest=3)
    rows = (heard, at_speed()[1], fault, replace(at_speed()[1], form="spline"))
    monkeypatch.setattr("camgeo.app.answers.accuracy.benefit_rows", lambda *_, **__: rows)

    def parts() -> Iterator[tuple[str, str]]:
        for survey, words in (
            (made_up(), ("--ripple",)),
            (made_up(), ("--json",)),
            (whole, ("--ripple", "--all")),
            (whole, ("--speed", "600", "--all")),
            (whole, ("--speed", "600", "--json")),
        ):
            monkeypatch.setattr(surveys, "survey", lambda *_, survey=survey, **__: survey)
            said = call(SETZHUB, *words)
            assert (said.code, said.err) == (0, "")
            if "--json" in words:
                validator("camgeo.app.answers.accuracy").validate(said.document)
            text = kept.document(said.document) if "--json" in words else said.out
            yield f"{len(survey.effects)} effects: {' '.join(words)}", text

    call(SETZHUB)
    call(SETZHUB, "--all")
    assert [asked["complete"] for asked in found] == [False, True]
    kept.compare("cli/accuracy.txt", parts())


@pytest.mark.usefixtures("found")
def test_angles_are_stated_in_degrees() -> None:
    table = call(SCENES / "flat_rocker.toml", "--json").document["tables"][0]
    assert table["unit"] == "deg"
    assert table["interpolation_error"] == pytest.approx(1.7e-3 * 57.29577951308232)


def test_what_is_asked_reaches_the_survey(found: list[dict[str, Any]], tmp_path: Path) -> None:
    call(SETZHUB, "--tolerances", "1e-3, 0.1,1e-3")
    assert found[-1]["tolerances"] == (0.1, 1e-3)
    call(SETZHUB)
    assert found[-1]["tolerances"] == surveys.TOLERANCES
    ripple = "\n[output.accuracy]\nripple = true\n"
    call(changed(SETZHUB, tmp_path / "ripple.toml", more=ripple))
    assert [asked["ripple"] for asked in found] == [False, False, True]


def test_ctrl_c_leaves_nothing(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    def interrupted(*_: object, **__: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(surveys, "survey", interrupted)
    said = call(SETZHUB, "-o", tmp_path / "new" / "a.svg")
    assert said.code == 130
    assert "interrupted" in said.err
    assert list(tmp_path.iterdir()) == []


def test_a_disc_that_cannot_be_is_refused(tmp_path: Path) -> None:
    wide = ("roller_radius = 7.0", "roller_radius = 40.0")
    said = call(changed(SETZHUB, tmp_path / "cusp.toml", wide))
    assert (said.code, said.out) == (1, "")


# The picture --------------------------------------------------------------------------------------


def at_speed() -> tuple[BenefitRow, ...]:
    """Arcs that are off by half, a fifth and a quarter of it less at the tighter tolerance."""
    return tuple(
        BenefitRow("arcs", tolerance, 600.0 * RPM, 50.0 * factor, 100.0, 0.0, 16.0 * factor, 1.0,
                   90.0, 2.0, 80.0, 100.0 - 25.0 * factor, 100.0)
        for tolerance, factor in zip((*TOLERANCES, 1e-4), (1.0, 0.1, 0.08), strict=True)
    )  # fmt: skip


def test_cost_rises_and_what_is_off_falls_in_one_panel() -> None:
    """In per cent of the exact motion, and in multiples of the cost at the loosest tolerance."""
    built = tuple(
        BillRow(tolerance, seconds, seconds, seconds, seconds, seconds)
        for tolerance, seconds in zip(TOLERANCES, (0.2, 0.6), strict=True)
    )
    survey = replace(made_up(), bill=built)
    panel = figure(survey, title="made up", benefits=at_speed()).panels[0]
    drawn = {
        mark.label: mark.points[:, 1] for mark in panel.marks if isinstance(mark, Line)
    }  # fmt: skip
    assert drawn["acceleration off"].tolist() == pytest.approx([50.0, 5.0, 4.0])
    assert drawn["contact force off"].tolist() == pytest.approx([20.0, 2.0, 1.6])
    assert drawn["lift-off speed lost"].tolist() == pytest.approx([25.0, 2.5, 2.0])
    assert drawn["pieces"].tolist() == [1.0, 2.0]
    assert drawn["seconds of a build"].tolist() == pytest.approx([1.0, 3.0])
    assert panel.title == "made up"


def test_all_forms_and_the_spectrum_of_the_one_drawn_have_panels() -> None:
    arcs = tuple(replace(row, octaves=(3.0, 2.0), strongest=1) for row in at_speed())
    splines = tuple(replace(row, form="spline", acceleration=9.0) for row in at_speed())
    panels = figure(made_up(), title="made up", benefits=(*arcs, *splines), form="spline").panels
    assert panels[0].y.label.startswith("spline: off [%")
    drawn = [mark for mark in panels[1].marks if isinstance(mark, Line)]
    assert [mark.label for mark in drawn] == ["acceleration off, arcs", "acceleration off, spline"]
    assert drawn[1].points[:, 1].tolist() == pytest.approx([9.0] * 3)
    assert not any("octaves" in panel.y.label for panel in panels)
    last = figure(made_up(), title="", computing=False, benefits=(*arcs, *splines)).panels[-1]
    assert last.y.label == "arcs: off, by octaves [mm/s²]"
    assert [mark.points.tolist() for mark in last.marks if isinstance(mark, Line)] == [
        [[1.0, 3.0], [2.0, 2.0]]
    ] * 3


def test_the_knee_is_marked_with_its_reason() -> None:
    """That of the benefits at a speed, where they are known; else the advice."""
    missing = (BenefitRow("arcs", 1e-2, 1.0, fault="no"),)
    for benefits, tolerance, begin in (
        (at_speed(), 1e-3, "enough at 600 rev/min: arcs within 0.001 mm, the acceleration is off"),
        (missing, 1e-3, "advice: arcs (fewest) within 0.001 mm: 2,400 pieces, "),
        ((), 1e-3, "advice: arcs (fewest) within 0.001 mm: 2,400 pieces, "),
    ):
        panels = figure(made_up(), title="made up", benefits=benefits).panels
        for panel in panels:
            (rule,) = (mark for mark in panel.marks if isinstance(mark, Rule))
            assert rule.at == tolerance
        (reason,) = (mark.text for mark in panels[0].marks if isinstance(mark, Text))
        assert reason.replace("\n", " ").startswith(begin)


def test_without_computing_no_second_of_this_machine_is_drawn() -> None:
    without = [
        kept.marks(figure(survey, title="made up", computing=False))
        for survey in (made_up(), _slower(made_up()))
    ]
    assert without[0] == without[1]
    # Seconds are drawn, and the title.
    drawn = [
        kept.marks(figure(survey, title=title))
        for survey, title in (
            (made_up(), "made up"),
            (_slower(made_up()), "made up"),
            (made_up(), "other"),
        )
    ]
    assert len(set(drawn)) == 3


def _slower(survey: Survey) -> Survey:
    contours = tuple(
        row if row.count is None else replace(row, count=replace(row.count, fit_seconds=7.0))
        for row in survey.contours
    )
    return replace(survey, contours=contours)


def test_a_picture_of_nothing() -> None:
    empty = Survey((), (), (), None)
    assert render(figure(empty, title=""), ".png").startswith(b"\x89PNG")


@pytest.mark.usefixtures("found")
def test_the_picture_is_written_next_to_the_table(tmp_path: Path) -> None:
    target = tmp_path / "accuracy.svg"
    said = call(SETZHUB, "-o", target)
    assert said.out.startswith("setzhub: what accuracy costs, in mm, bytes and seconds\n")
    assert said.err == f"{target}: pieces, bytes, seconds\n"
    assert target.read_bytes().startswith(b"<?xml")
