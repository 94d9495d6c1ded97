"""Numerical effects over their tolerance: rows, what they compare, and how they are shown."""

from __future__ import annotations

import math
from collections.abc import Callable
from copy import copy
from dataclasses import replace
from decimal import Decimal
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from camgeo.check.finding import Finding
from camgeo.design.design import Design
from camgeo.dynamics.effects.effect import Bound, Column, Effect, Request, Result
from camgeo.dynamics.effects.graph import Effects
from camgeo.errors import EffectError, GeometryError
from camgeo.pictures.accuracy import figure
from camgeo.pictures.model import Figure
from camgeo.studies.accuracy import survey as surveys
from camgeo.studies.accuracy.contours import EffectRow
from camgeo.studies.accuracy.survey import (
    TIGHTER,
    TOLERANCES_OF_EFFECTS,
    Survey,
    compare_figures,
    effect_rows,
    result_figures,
)
from tests import kept
from tests.accuracy.rows import EFFECTS
from tests.effects.fakes import fake
from tests.effects.scenes import design
from tests.findings import known

BENT = 3.0
"""Error of the effects made up here, in tolerances of their largest magnitude."""


def curve(size: float) -> Column:
    return Column("force", "N", lambda phi, side: size * np.sin(phi))


def off(request: Request[Any]) -> float:
    return 50.0 * (1.0 + BENT * request.tolerance)


def with_column(request: Request[Any]) -> Result:
    columns = (curve(0.0), replace(curve(off(request)), name="torque"))
    bound = Bound(2.0 * BENT * 50.0 * request.tolerance, 50.0)
    return Result(columns=columns, errors={"torque": bound})


def with_findings(request: Request[Any]) -> Result:
    findings = (
        Finding("speed", "ok", "speed", value=7.0, unit="rev/min"),
        Finding("none", "ok", "none"),
        Finding("rest", "ok", "rest", value=50.0 - off(request), unit="N m"),
    )
    bound = Bound(2.0 * BENT * 50.0 * request.tolerance, 50.0)
    return Result(findings=findings, columns=(curve(7.0),), errors={"rest": bound})


def too_sure(request: Request[Any]) -> Result:
    """States a smaller error than its figure has."""
    sure = with_column(request)
    return Result(columns=sure.columns, errors={"torque": Bound(50.0 * request.tolerance, 50.0)})


def unstated(request: Request[Any]) -> Result:
    """Has a figure that depends on the tolerance, but states no error for it."""
    return Result(columns=with_column(request).columns)


def settled(request: Request[Any]) -> Result:
    """Its figures change with the tolerance by rounding only."""
    columns = (curve(50.0 + 1e-13 * (request.tolerance < 1e-9)),)
    return Result(columns=columns, errors={"force": Bound(2e-13, 50.0)})


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

    def rows(
        self, *names: str, tolerances: tuple[float, ...] = TOLERANCES_OF_EFFECTS
    ) -> list[EffectRow]:
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
    for name in ("force", "work"):
        own = [each for each in reported if each.startswith(name)]
        assert own == [f"{name}, reference to 1e-06", f"{name}, 0.01", f"{name}, 0.0001"]
    # Each tolerance is computed as often as it is timed, the reference once.
    assert {name for name, _ in made.calls} == {"force", "work"}
    assert {tolerance for _, tolerance in made.calls} == {1e-2, 1e-4, 1e-4 / TIGHTER}
    for name in ("force", "work"):
        assert made.calls.count((name, 1e-4 / TIGHTER)) == 1


@pytest.mark.parametrize(("compute", "figure"), [(with_column, "torque"), (with_findings, "rest")])
def test_every_figure_is_compared_with_a_much_tighter_result(
    made: Made, compute: Callable[[Request[Any]], Result], figure: str
) -> None:
    """Not only the first column, which here does not depend on the tolerance."""
    made.add("effect", compute)
    rows = made.rows("effect")
    assert [row.tolerance for row in rows] == list(TOLERANCES_OF_EFFECTS)
    for row in rows:
        expected = BENT * (row.tolerance - TOLERANCES_OF_EFFECTS[-1] / TIGHTER)
        assert row.difference == pytest.approx(expected, rel=1e-4)
        assert row.figure == figure
        assert row.error == pytest.approx(2.0 * BENT * row.tolerance)
        assert not row.rounded
    assert all(row.seconds is not None and row.seconds >= 0.0 for row in rows)
    assert [row.fault for row in rows] == [""] * len(rows)


@pytest.mark.parametrize("compute", [too_sure, unstated])
def test_a_figure_off_by_more_than_stated_is_reported(
    made: Made, compute: Callable[[Request[Any]], Result]
) -> None:
    made.add("effect", compute)
    for row in made.rows("effect", tolerances=(1e-2, 1e-4)):
        assert row.fault == "off by more than estimated: torque"
        assert row.difference is not None
        assert not row.rounded


def test_an_effect_that_reaches_rounding_at_once_has_one_row(made: Made) -> None:
    made.add("effect", settled)
    (row,) = made.rows("effect")
    assert row.rounded
    assert row.tolerance == TOLERANCES_OF_EFFECTS[0]
    assert row.error == 2e-13 / 50.0
    assert 0.0 < known(row.difference) <= row.error
    assert {tolerance for _, tolerance in made.calls} == {
        TOLERANCES_OF_EFFECTS[0],
        TOLERANCES_OF_EFFECTS[-1] / TIGHTER,
    }


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


def test_rows_too_near_the_tightest_that_has_an_answer_are_not_compared(made: Made) -> None:
    made.add("effect", not_beyond)
    rows = made.rows("effect", tolerances=(1e-2, 1e-6, 1e-8))
    assert [row.fault for row in rows] == ["", "", "cannot be had to this tolerance"]
    assert rows[0].difference == pytest.approx(BENT * 1e-2, rel=1e-3)
    assert rows[1].difference is None
    assert (rows[2].seconds, rows[2].difference, rows[2].error) == (None, None, None)


@pytest.mark.parametrize("error", [GeometryError("no spring without it"), ZeroDivisionError()])
def test_missing_data_are_a_reason_too_and_other_errors_are_not_hidden(
    made: Made, error: Exception
) -> None:
    def compute(request: Request[Any]) -> Any:
        raise error

    made.add("effect", compute)
    if isinstance(error, GeometryError):
        assert [row.fault for row in made.rows("effect", tolerances=(1e-2,))] == [str(error)]
    else:
        with pytest.raises(ZeroDivisionError):
            made.rows("effect", tolerances=(1e-2,))


# Comparing ----------------------------------------------------------------------------------------


def of_value(value: float, *, bound: Bound | None = None) -> Result:
    finding = Finding("force", "ok", "force", value=value, unit="N")
    return Result(findings=(finding,), errors={} if bound is None else {"force": bound})


@pytest.mark.parametrize(
    ("value", "bound", "exact", "share", "holds"),
    [
        (2.0, Bound(1.5, 100.0), 1.0, 0.01, True),
        (2.0, Bound(0.5, 100.0), 1.0, 0.01, False),
        # Without a bound it may differ by rounding.
        (1.0, None, 1.0 + 2.0**-50, 2.0**-50, True),
        (1.0, None, 1.0 + 1e-12, 1e-12, False),
        (0.0, None, 0.0, 0.0, True),
    ],
)
def test_shares_are_of_the_scale_of_each_figure(
    value: float, bound: Bound | None, exact: float, share: float, holds: bool
) -> None:
    (found,) = compare_figures(of_value(value, bound=bound), of_value(exact))
    assert (found.figure, found.difference, found.holds) == ("force", abs(value - exact), holds)
    assert found.share == pytest.approx(share, rel=1e-3)


def test_what_is_not_in_both_is_not_compared() -> None:
    assert compare_figures(of_value(1.0), Result()) == ()
    twice = Result(findings=(*of_value(1.0).findings, *of_value(2.0).findings))
    assert compare_figures(twice, of_value(1.0)) == ()


def test_all_findings_and_columns_are_figures() -> None:
    both = Result(
        findings=(*of_value(3.0).findings, *of_value(4.0).findings), columns=(curve(1.0),)
    )
    figures = result_figures(replace(both, columns=(replace(curve(1.0), name="torque"),)))
    assert figures["force"].tolist() == [3.0, 4.0]
    assert np.max(figures["torque"]) == pytest.approx(1.0, abs=1e-5)
    assert result_figures(Result()) == {}


# In the survey ------------------------------------------------------------------------------------


def test_the_survey_has_them(made: Made, monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("contour_rows", "solid_rows", "table_rows"):
        monkeypatch.setattr(surveys, name, lambda *_, **__: ())
    made.add("effect", with_column)
    reported: list[str] = []
    found = surveys.survey(made.named("effect"), (1e-3,), (Decimal(5),), progress=reported.append)
    assert [row.tolerance for row in found.effects] == list(TOLERANCES_OF_EFFECTS)
    assert reported[:2] == ["effect, reference to 1e-12", "effect, 0.01"]
    assert len(reported) == 1 + len(TOLERANCES_OF_EFFECTS)
    assert surveys.survey(made.named(), (1e-3,), (Decimal(5),)).effects == ()


# The picture --------------------------------------------------------------------------------------


def pictured(rows: tuple[EffectRow, ...], *, computing: bool = True) -> Figure:
    return figure(Survey((), (), (), None, rows), title="made up", computing=computing)


def test_the_picture_has_a_panel_more_if_there_are_seconds() -> None:
    without, found = pictured(()), pictured(EFFECTS)
    assert len(found.panels) == len(without.panels) + 1
    assert found.size[1] > without.size[1] + 2.5
    slower = (replace(EFFECTS[0], seconds=0.3), *EFFECTS[1:])
    assert kept.marks(pictured(slower)) != kept.marks(found)
    for figures in (
        (pictured(EFFECTS[2:]), without),
        (pictured(EFFECTS, computing=False), pictured((), computing=False)),
    ):
        one, other = map(kept.marks, figures)
        assert one == other


def test_tolerances_of_a_scene_are_left_alone(made: Made, tmp_path: Path) -> None:
    """The survey changes no table of the scene."""
    made.add("effect", with_column)
    named = made.named("effect")
    effect_rows(named, (1e-2, 1e-3), progress=lambda _: None)
    assert named.effects.tables == {"effect": {}}
    assert named.effect("effect").error == pytest.approx(2.0 * BENT * 1e-6)
    assert math.isclose(made.calls[-1][1], 1e-6)
