"""What varies: ranges, lists and tied keys, as a command line writes them."""

from __future__ import annotations

from decimal import Decimal
from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from camgeo.errors import GeometryError
from camgeo.studies.sweep.family import Listed, Range, Variable, parse


def rows(text: str) -> list[tuple[object, ...]]:
    values = parse(text).values
    return [values.row(place) for place in range(values.count)]


def test_ranges_have_both_ends_and_exact_numbers_between_them() -> None:
    assert rows("a=30:60:31") == [(number,) for number in range(30, 61)]
    assert rows("a=0:0.3:4") == [(0,), (0.1,), (0.2,), (0.3,)]
    assert rows("a=1:-1:3") == [(1,), (0,), (-1,)]
    assert rows("a=5:5:1") == [(5,)]
    assert all(isinstance(value, int) for (value,) in rows("a=30:60:31"))  # for a whole number


@given(
    st.decimals(-1000, 1000, places=3),
    st.decimals(-1000, 1000, places=3),
    st.integers(2, 1000),
)
def test_numbers_of_a_range_are_rounded_once(start: Decimal, stop: Decimal, count: int) -> None:
    if start == stop:
        return
    values = Range(start, stop, count)
    for place in (0, 1, count // 2, count - 1):
        exact = Fraction(start) + (Fraction(stop) - Fraction(start)) * place / (count - 1)
        assert values.row(place) == (float(exact),)
    assert values.row(0) == (float(start),)
    assert values.row(count - 1) == (float(stop),)


def test_lists_have_numbers_words_and_truth_values() -> None:
    assert rows("a=1, 2.5 ,x,true,'1',\"a,b:c\"") == [
        (1,),
        (2.5,),
        ("x",),
        (True,),
        ("1",),
        ("a,b:c",),
    ]
    assert parse("a='1:2'").values == Listed((("1:2",),))


def test_tied_keys_take_one_value_or_one_each() -> None:
    assert parse("a,b=1:3:2") == Variable(("a", "b"), Range(Decimal(1), Decimal(3), 2, 2))
    assert rows("a,b=1:3:2") == [(1, 1), (3, 3)]
    assert rows("a,b=1/2,3/x,5") == [(1, 2), (3, "x"), (5, 5)]
    assert rows("a=d/e.csv") == [("d/e.csv",)]


@given(st.floats(0.0, 1.0, exclude_max=True))
def test_samples_stay_within_their_range(share: float) -> None:
    (number,) = Range(Decimal(30), Decimal(60), None).row_at_share(share)
    assert isinstance(number, int | float)
    assert 30 <= number <= 60
    assert Listed((("x",), ("y",), ("z",))).row_at_share(share) in (("x",), ("y",), ("z",))


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("a", "vary = a: must be START:STOP:COUNT"),
        ("=1", "must be START:STOP:COUNT"),
        ("a=", "must be START:STOP:COUNT"),
        ("a=1:2:3:4", "must be START:STOP:COUNT"),
        ("a=1:x:3", "must be START:STOP:COUNT"),
        ("a=1:nan:3", "must be START:STOP:COUNT"),
        ("a=1:2:2.5", "COUNT must be a whole number"),
        ("a=1:2:0", "a = 1:2:0: is an empty range"),
        ("a=1:2:-3", "is an empty range"),
        ("a=2:2:5", "both ends are the same"),
        ("a=1:2:1", "one number for two ends"),
        ("a=1:1e999:3", "too large a number"),
        ("a=1,2,1.0", "a = 1: is listed twice"),
        ("a=x,\udcff", "a text that UTF-8 cannot encode"),
        ("a,b=1/2/3", "1/2/3: must have a value for each of 2 keys"),
    ],
)
def test_what_is_wrong_is_told_with_its_key(text: str, message: str) -> None:
    with pytest.raises(GeometryError) as error:
        parse(text)
    assert message in str(error.value)
