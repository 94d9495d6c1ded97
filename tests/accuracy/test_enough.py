"""Which tolerance is enough: where benefits end, on rows made up."""

from __future__ import annotations

from dataclasses import replace

import pytest

from camgeo.app.answers.accuracy import enough_sentences
from camgeo.studies.accuracy.benefit import SHARE, BenefitRow, find_sufficient, sufficient_sentence
from tests.findings import known


def row(tolerance: float, off: float, lift_off: float = 90.0) -> BenefitRow:
    return BenefitRow(
        "arcs", tolerance, 60.0, off, 1.0, 0.0, 40.0 * off, 10.0, 90.0, 11.0, 80.0, lift_off, 100.0
    )


def test_the_loosest_beyond_which_nothing_changes() -> None:
    rows = [row(1e-1, 0.5), row(1e-2, 0.2), row(1e-3, 0.04), row(1e-4, 0.02)]
    found = known(find_sufficient(rows[::-1]))
    assert (found.row, found.last) == (rows[2], False)
    assert found.gain == pytest.approx(0.02)
    assert "0.001 mm" in sufficient_sentence(found)


@pytest.mark.parametrize("over", [0.9, 1.1])
def test_the_lift_off_speed_counts_too(over: float) -> None:
    loose, tight = row(1e-2, 0.02, 90.0), row(1e-3, 0.02, 90.0 + over * SHARE * 100.0)
    found = known(find_sufficient([loose, tight]))
    assert found.row == (loose if over < 1.0 else tight)
    assert found.last == (over > 1.0)


def test_tolerances_without_values_are_none() -> None:
    missing = BenefitRow("arcs", 1e-2, 60.0, fault="cannot be reached")
    assert find_sufficient([missing]) is None
    assert enough_sentences([missing]) == (sufficient_sentence(None),)
    assert find_sufficient([missing, row(1e-1, 0.5)]) is not None


def test_each_form_has_its_own_answer() -> None:
    splines = [replace(row(1e-1, 0.02), form="spline"), replace(row(1e-2, 0.01), form="spline")]
    found = enough_sentences([row(1e-1, 0.5), row(1e-2, 0.2), *splines])
    assert [each.split(" mm")[0] for each in found] == ["arcs within 0.01", "spline within 0.1"]
