"""Values that are dragged, rounded to decimal steps."""

from __future__ import annotations

from decimal import Decimal

import pytest
from hypothesis import given
from hypothesis import strategies as st

from camgeo.app.designing.edits import rounded
from camgeo.app.designing.form import step_near
from camgeo.app.designing.handles import snapped

VALUES = st.floats(-1e9, 1e9)
STEPS = st.floats(1e-9, 1e6)


@given(step=STEPS)
def test_a_step_is_round_and_no_larger(step: float) -> None:
    found = step_near(step)
    assert found.normalize().as_tuple().digits in ((1,), (2,), (5,))
    assert 0.39 * step <= found <= Decimal(step) * Decimal("1.000001")


@pytest.mark.parametrize(("step", "near"), [(0, "1e-9"), (1e300, "1e6"), (0.3, "0.2"), (1, "1")])
def test_steps_have_limits(step: float, near: str) -> None:
    assert step_near(step) == Decimal(near)


@given(value=VALUES, step=STEPS)
def test_a_value_is_the_nearest_multiple(value: float, step: float) -> None:
    by = step_near(step)
    found = Decimal(snapped(value, step))
    assert found % by == 0
    assert abs(found - Decimal(value)) <= by / 2
    assert snapped(float(found), step) == found or abs(value) > 1e6


@given(value=VALUES, step=STEPS, share=st.floats(-0.49, 0.49))
def test_a_value_that_hardly_moves_stays(value: float, step: float, share: float) -> None:
    before = Decimal(repr(value))
    moved = value + share * float(step_near(step))
    if abs(moved - value) <= 0.5 * float(step_near(step)):
        assert snapped(moved, step, before) is before


@pytest.mark.parametrize(
    ("value", "before", "written"),
    [
        (8.0, 7, "8"), (8.0, Decimal("7.0"), "8"), (8.25, 7, "8.2"), (-0.01, 7, "0"),
        (12.0, None, "12"), (100.0, Decimal("7.5"), "100"),
    ],
)  # fmt: skip
def test_numbers_are_written_as_before(
    value: float, before: int | Decimal | None, written: str
) -> None:
    found = snapped(value, 0.1, before)
    assert str(found) == written
    assert isinstance(found, int if type(before) is not Decimal and "." not in written else Decimal)


@pytest.mark.parametrize(
    ("value", "few"), [("0", "0"), ("1234.5", "1230"), ("0.012345", "0.0123"), ("29.25", "29.2")]
)
def test_a_value_that_is_made_has_few_digits(value: str, few: str) -> None:
    assert str(rounded(Decimal(value))) == few
