"""Numerical effects over their tolerance: rows, what they compare, and how they are shown."""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from copy import copy
from dataclasses import replace
from decimal import Decimal
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from camgeo.accuracy import survey as surveys
from camgeo.accuracy.effects import TOLERANCES, compared, difference, effect_rows
from camgeo.accuracy.rows import EffectRow
from camgeo.accuracy.survey import Survey
from camgeo.check.finding import Finding
from camgeo.cli.main import parser
from camgeo.design import Design
from camgeo.effects.effect import Column, Effect, Request, Result
from camgeo.effects.graph import Effects
from camgeo.errors import EffectError, GeometryError
from camgeo.figure.accuracy import figure
from camgeo.numeric.arrays import FloatArray
from camgeo_export.plots.render import render
from tests.effects.fakes import fake
from tests.effects.scenes import SCENES, design

Capture = pytest.CaptureFixture[str]

BENT = 3.0
"""Error of the effects made up here, in tolerances of their largest magnitude."""


def curve(size: float) -> Column:
    return Column("force", "N", lambda phi, side: size * np.sin(phi))


def off(request: Request[Any]) -> float:
    return 50.0 * (1.0 + BENT * request.tolerance)


def with_column(request: Request[Any]) -> Result:
    columns = (curve(off(request)), curve(0.0))
    return Result(columns=columns, error=request.tolerance / 2.0)


def with_findings(request: Request[Any]) -> Result:
    findings = (
        Finding("work", "ok", "work", value=off(request), unit="N m"),
        Finding("rest", "ok", "rest", value=50.0 - off(request), unit="N m"),
        Finding("none", "ok", "none"),
        Finding("speed", "ok", "speed", value=7.0, unit="rev/min"),
    )
    return Result(findings=findings, error=request.tolerance)


def no_answer(request: Request[Any]) -> Any:
    raise EffectError("the follower jams at 90 degrees", finding="jamming")


def not_beyond(request: Request[Any]) -> Result:
    if request.tolerance < 5e-7:
        raise EffectError("cannot be had to this tolerance")
    return with_column(request)


class Made:
    """A design with effects made up for a test."""

    def __init__(self) -> None:
        self.design = design("plate_translating", "")
        self.effects: dict[str, Effect] = {}
        self.calls: list[tuple[str, float]] = []

    def add(self, name: str, compute: Callable[[Request[Any]], Any], **options: Any) -> None:
        def counted(request: Request[Any]) -> Any:
            self.calls.append((name, request.tolerance))
            return compute(request)

        options = {"numerical": True, **options}
        self.effects[name] = fake(name, counted, **options)

    def named(self, *names: str) -> Design:
        tables: dict[str, dict[str, Any]] = {name: {} for name in names}
        scene = copy(self.design.scene)
        object.__setattr__(scene, "effects", tables)  # by names that no scene can have
        found = Design(scene)
        graph = Effects(found.effects.subject, tables, found.ledger, find=self.effects.__getitem__)
        found.__dict__["effects"] = graph
        return found

    def rows(self, *names: str, tolerances: tuple[float, ...] = TOLERANCES) -> list[EffectRow]:
        return list(effect_rows(self.named(*names), tolerances, progress=lambda _: None))


@pytest.fixture
def made() -> Made:
    return Made()


def test_a_row_for_each_numerical_effect_and_tolerance(made: Made) -> None:
    made.add("force", with_column)
    made.add("plain", with_column, numerical=False)
    made.add("work", with_findings)
    made.add("unnamed", with_column)
    reported: list[str] = []
    rows = effect_rows(made.named("force", "plain", "work"), (1e-4, 1e-2), progress=reported.append)
    assert [(row.effect, row.tolerance) for row in rows] == [
        ("force", 1e-2), ("force", 1e-4), ("work", 1e-2), ("work", 1e-4),
    ]  # fmt: skip
    assert reported == ["force, 0.01", "force, 0.0001", "work, 0.01", "work, 0.0001"]
    assert {name for name, _ in made.calls} == {"force", "work"}
    assert {tolerance for _, tolerance in made.calls} == {1e-2, 1e-4}


def test_tolerances_are_one_a_decade() -> None:
    assert [f"{each:g}" for each in TOLERANCES] == ["0.01", "0.001", "0.0001"] + [
        f"1e-{k:02}" for k in range(5, 11)
    ]


@pytest.mark.parametrize("compute", [with_column, with_findings])
def test_differences_are_those_from_the_tightest(
    made: Made, compute: Callable[[Request[Any]], Result]
) -> None:
    made.add("effect", compute)
    rows = made.rows("effect")
    assert [row.tolerance for row in rows] == list(TOLERANCES)
    for row in rows[:-1]:
        # The share is of the larger one of both; a double keeps 1e-16 of 1.
        larger = 1.0 + BENT * row.tolerance
        expected = BENT * (row.tolerance - TOLERANCES[-1]) / larger
        assert row.difference == pytest.approx(expected, rel=1e-5)
    assert rows[-1].difference is None
    assert all(row.seconds is not None and row.seconds >= 0.0 for row in rows)
    assert [row.fault for row in rows] == [""] * len(rows)


def test_the_estimate_is_the_effect_s(made: Made) -> None:
    made.add("effect", with_column)
    assert [row.error for row in made.rows("effect")] == [t / 2.0 for t in TOLERANCES]


def test_what_it_needs_is_computed_once_and_not_timed(made: Made) -> None:
    made.add("needed", with_column)
    made.add("effect", with_column, needs=("needed",))
    made.rows("effect")
    assert [call for call in made.calls if call[0] == "needed"] == [("needed", 1e-6)]


def test_an_effect_without_an_answer_has_rows_that_say_why(made: Made) -> None:
    made.add("force", no_answer)
    made.add("torque", with_column, needs=("force",))
    rows = made.rows("torque", tolerances=(1e-2, 1e-3))
    reason = "the follower jams at 90 degrees"
    assert rows == [
        EffectRow("torque", 1e-2, fault=reason),
        EffectRow("torque", 1e-3, fault=reason),
    ]


def test_other_tolerances_are_compared_with_the_tightest_that_has_an_answer(made: Made) -> None:
    made.add("effect", not_beyond)
    rows = made.rows("effect", tolerances=(1e-2, 1e-6, 1e-8))
    assert [row.fault for row in rows] == ["", "", "cannot be had to this tolerance"]
    assert rows[0].difference == pytest.approx(BENT * 1e-2 / (1.0 + BENT * 1e-2), rel=1e-3)
    assert rows[1].difference is None
    assert (rows[2].seconds, rows[2].difference, rows[2].error) == (None, None, None)


def test_missing_data_are_a_reason_too(made: Made) -> None:
    def compute(request: Request[Any]) -> Any:
        raise GeometryError("is missing: no spring without it", key="effects.spring.anchor")

    made.add("effect", compute)
    (row,) = made.rows("effect", tolerances=(1e-2,))
    assert row.fault == "is missing: no spring without it"


def test_other_errors_are_not_hidden(made: Made) -> None:
    def compute(request: Request[Any]) -> Any:
        raise ZeroDivisionError

    made.add("effect", compute)
    with pytest.raises(ZeroDivisionError):
        made.rows("effect", tolerances=(1e-2,))


# Comparing ----------------------------------------------------------------------------------------


def array(*values: float) -> FloatArray:
    return np.array(values)


def test_shares_are_of_the_largest_magnitude_of_the_unit() -> None:
    best = {"N": array(1.0, -100.0), "deg": array(0.5)}
    assert difference({"N": array(2.0, -100.0), "deg": array(0.5)}, best) == pytest.approx(0.01)
    assert difference({"N": array(1.0, -100.0), "deg": array(0.25)}, best) == 0.5
    assert difference({"N": array(0.0)}, {"N": array(0.0)}) == 0.0
    assert difference({"N": array(0.0)}, {"N": array(2.0)}) == 1.0


def test_what_is_not_the_same_is_not_compared() -> None:
    best = {"N": array(1.0, 2.0)}
    assert difference(None, best) is None
    assert difference(best, None) is None
    assert difference({"N": array(1.0)}, best) is None
    assert difference({"mm": array(1.0, 2.0)}, best) is None
    assert difference({}, {}) is None


def test_the_first_column_goes_before_findings() -> None:
    finding = Finding("force", "ok", "force", value=3.0, unit="kN")
    assert set(compared(Result(findings=(finding,), columns=(curve(1.0),)))) == {"N"}
    (values,) = compared(Result(columns=(curve(1.0),))).values()
    assert np.max(values) == pytest.approx(1.0, abs=1e-5)
    assert compared(Result(findings=(finding,))) == {"kN": [3.0]}
    assert compared(Result()) == {}


# In the survey ------------------------------------------------------------------------------------


ROWS = (
    EffectRow("vibration", 1e-2, 0.0123, 3.2e-3, 4.44e-3),
    EffectRow("vibration", 1e-4, 0.5, 1.2e-5, None),
    EffectRow("balance", 1e-2, fault="there is no disc"),
)


def survey_of(effects: tuple[EffectRow, ...]) -> Survey:
    return Survey((), (), (), None, effects)


Found = list[tuple[EffectRow, ...]]


@pytest.fixture
def found(monkeypatch: pytest.MonkeyPatch) -> Found:
    """Rows that the survey finds, in a test in which it measures nothing."""
    rows: Found = [ROWS]
    monkeypatch.setattr(surveys, "survey", lambda *_, **__: survey_of(rows[-1]))
    return rows


def call(*words: str) -> int:
    arguments = parser(("accuracy",)).parse_args(["accuracy", *words])
    code: int = arguments.run(arguments)
    return code


SETZHUB = str(SCENES / "setzhub.toml")


def test_the_survey_has_them(made: Made, monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("contour_rows", "solid_rows", "table_rows"):
        monkeypatch.setattr(surveys, name, lambda *_, **__: ())
    made.add("effect", with_column)
    reported: list[str] = []
    found = surveys.survey(made.named("effect"), (1e-3,), (Decimal(5),), progress=reported.append)
    assert [row.tolerance for row in found.effects] == list(TOLERANCES)
    assert reported[0] == "effect, 0.01"
    assert len(reported) == len(TOLERANCES)
    assert surveys.survey(made.named(), (1e-3,), (Decimal(5),)).effects == ()


def test_the_table(found: Found, capsys: Capture) -> None:
    assert call(SETZHUB) == 0
    captured = capsys.readouterr()
    head, first, second, third = captured.out.split("\n\n")[-2].splitlines()
    assert head.split() == ["effect", "tolerance", "computed", "estimate", "off"]
    assert first.split() == ["vibration", "0.01", "0.012", "0.0032", "0.0044"]
    assert second.split() == ["vibration", "0.0001", "0.5", "1.2e-05", "-"]
    assert third.split() == ["balance", "0.01", "-", "-", "-", "there", "is", "no", "disc"]
    assert captured.out.splitlines()[-1].startswith("advice: ")
    assert "\neffects: tolerance, estimate and off are shares of the largest" in captured.out


def test_json_has_the_same(found: Found, capsys: Capture) -> None:
    assert call(SETZHUB, "--json") == 0
    document: dict[str, Any] = json.loads(capsys.readouterr().out, parse_constant=pytest.fail)
    assert document["effects"] == [
        {
            "effect": "vibration", "tolerance": 0.01, "seconds": 0.0123, "error": 3.2e-3,
            "difference": 4.44e-3, "fault": "",
        },
        {
            "effect": "vibration", "tolerance": 1e-4, "seconds": 0.5, "error": 1.2e-5,
            "difference": None, "fault": "",
        },
        {
            "effect": "balance", "tolerance": 0.01, "seconds": None, "error": None,
            "difference": None, "fault": "there is no disc",
        },
    ]  # fmt: skip


def test_without_effects_they_are_not_mentioned(found: Found, capsys: Capture) -> None:
    found.append(())
    call(SETZHUB)
    assert "effect" not in capsys.readouterr().out
    call(SETZHUB, "--json")
    assert json.loads(capsys.readouterr().out)["effects"] == []


# The picture --------------------------------------------------------------------------------------


def height(svg: bytes) -> float:
    """Height of a figure [points]."""
    text = svg.decode()
    return float(text.split('viewBox="0 0 ')[1].split('"')[0].split()[1])


@cache
def without_rows() -> bytes:
    return render(figure(survey_of(()), title="made up"), ".svg")


def test_the_picture_has_a_panel_more() -> None:
    without = without_rows()
    drawn = render(figure(survey_of(ROWS), title="made up"), ".svg")
    assert height(drawn) > height(without) + 200.0
    assert render(figure(survey_of(ROWS), title="made up"), ".svg") == drawn
    slower = (replace(ROWS[0], seconds=0.3), *ROWS[1:])
    assert render(figure(survey_of(slower), title="made up"), ".svg") != drawn


def test_without_seconds_there_is_no_panel() -> None:
    assert render(figure(survey_of(ROWS[2:]), title="made up"), ".svg") == without_rows()
    plain = render(figure(survey_of(()), title="made up", computing=False), ".svg")
    assert render(figure(survey_of(ROWS), title="made up", computing=False), ".svg") == plain


def test_a_single_row_is_drawn() -> None:
    assert render(figure(survey_of(ROWS[:1]), title=""), ".png").startswith(b"\x89PNG")


def test_tolerances_of_a_scene_are_left_alone(made: Made, tmp_path: Path) -> None:
    """The survey changes no table of the scene."""
    made.add("effect", with_column)
    named = made.named("effect")
    effect_rows(named, (1e-2, 1e-3), progress=lambda _: None)
    assert named.effects.tables == {"effect": {}}
    assert named.effect("effect").error == 0.5e-6
    assert math.isclose(made.calls[-1][1], 1e-6)
