"""Sizes as they are written: rounded up, to a sensible number of decimals."""

from __future__ import annotations

import math
from decimal import Decimal

import pytest
from hypothesis import given
from hypothesis import strategies as st

from camgeo.check.sizing.rounding import exponent_of, rounded, sound, upward
from camgeo.check.sizing.smallest import rate, size
from camgeo.numeric.arrays import phase
from tests.check.sizing_scenes import required


@pytest.mark.parametrize(
    ("length", "unit", "exponent"),
    [
        (44.5059, 1.0, -4),
        (1.0, 1.0, -4),
        (9999.0, 1.0, -4),
        (0.5, 1.0, -5),
        (2.5e-6, 1.0, -10),
        (1.2e4, 1.0, -3),
        (3.7e8, 1.0, 1),
        (23.5, 25.4, -5),
    ],
)
def test_the_last_decimal(length: float, unit: float, exponent: int) -> None:
    """0.1 um from 1 mm to 10 m, otherwise a fraction of the length; one digit more in inches."""
    assert exponent_of(length, unit) == exponent


@given(st.floats(1e-9, 1e12), st.sampled_from((1.0, 25.4)))
def test_a_length_is_rounded_up_by_less_than_its_last_decimal(length: float, unit: float) -> None:
    exponent = exponent_of(length, unit)
    found = upward(length, exponent, unit)
    last = Decimal(1).scaleb(exponent)
    assert found % last == 0
    exact = Decimal(length / unit)
    assert exact * (1 - Decimal("1.1e-11")) <= found < exact + last
    assert float(last) * unit <= 2.55e-4 * length


def test_a_limit_that_has_so_many_decimals_is_kept() -> None:
    """14 mm / 0.7 is 20 mm, though not in binary."""
    assert upward(14.0 / 0.7, -4, 1.0) == 20
    assert upward(20.0 * (1.0 + 1e-13), -4, 1.0) == 20
    assert upward(20.0 * (1.0 + 1e-10), -4, 1.0) == Decimal("20.0001")


@pytest.mark.parametrize("name", ["setzhub", "schnitt", "groove", "ring", "plate_translating"])
def test_what_is_written_keeps_the_limits_in_as_few_decimals_as_it_can(name: str) -> None:
    task, angle, ratio = required(name)
    found = size(task, angle, ratio)
    assert found.answer is not None
    assert found.examined is not None
    made = rounded(task, found.answer.place, found.examined, angle, ratio, 1.0)
    assert made is not None
    assert sound(made.cam, angle, ratio)
    base = made.lengths["base_radius"]
    assert isinstance(base, float)
    assert repr(base) == repr(round(base, 4))
    assert found.answer.base_radius <= base < found.answer.base_radius + 1e-4
    assert all(
        each == round(each, 6)
        for value in made.lengths.values()
        for each in (value if isinstance(value, list) else [value])
    )
    # With a base radius one digit smaller, no place on that circle keeps both.
    theta = phase(found.answer.place - task.start)
    for turn in (0.0, 1e-6, -1e-6, 1e-4, -1e-4):
        way = theta + turn
        place = task.start + (base - 1e-4) * complex(math.cos(way), math.sin(way))
        rating = rate(task, place)
        assert rating is None or (
            rating.transmission_angle.value < angle or rating.radius_ratio.value > ratio
        )
