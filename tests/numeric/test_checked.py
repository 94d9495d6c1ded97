"""Values checked where they come in: numbers of any kind pass, anything else is refused."""

from __future__ import annotations

import math
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from camgeo.errors import GeometryError
from camgeo.numeric import checked

NO_NUMBERS: tuple[Any, ...] = (
    None,
    True,
    False,
    "1",
    b"1",
    1 + 0j,
    [1.0],
    np.ones(1),
    np.True_,
    object(),
    math.nan,
    math.inf,
    -math.inf,
    np.float64("nan"),
    10**400,
    -(10**400),
    10**5000,
    1e308,
    -1e31,
)


@pytest.mark.parametrize("value", NO_NUMBERS, ids=lambda value: str(type(value).__name__))
@pytest.mark.parametrize("check", [checked.finite, checked.positive, checked.point])
def test_what_is_no_number_is_refused(check: Any, value: Any) -> None:
    if check is checked.point and isinstance(value, complex):
        return
    with pytest.raises(GeometryError, match="must be") as caught:
        check("arm", value)
    assert caught.value.key == "arm"
    assert 0 < len(caught.value.value) < 80


@pytest.mark.parametrize(
    "value", [2, 2.0, np.float64(2), np.float32(2), np.int8(2), np.uint64(2), Fraction(2)]
)
def test_numbers_of_any_kind_become_floats(value: Any) -> None:
    for check in (checked.finite, checked.positive):
        found = check("arm", value)
        assert type(found) is float
        assert found == 2.0
    assert type(checked.point("pivot", value)) is complex


@given(value=st.floats())
def test_a_positive_number_is_itself_or_refused(value: float) -> None:
    if checked.SMALLEST <= value <= checked.LARGEST:
        assert checked.positive("arm", value) == value
    else:
        with pytest.raises(GeometryError):
            checked.positive("arm", value)


@pytest.mark.parametrize(
    ("bounds", "inside", "outside", "message"),
    [
        ({}, (-1.0, 0.0, 5e-324), (), ""),
        ({"above": 0.0}, (1.0,), (0.0, -0.0, -1.0), "must be a number above 0"),
        ({"least": 0.0}, (0.0, 1.0), (-5e-324,), "must be a number from 0"),
        ({"most": 3.0}, (3.0, -9.0), (4.0,), "must be a number up to 3"),
        ({"below": 3.0}, (2.0, -9.0), (3.0,), "must be a number below 3"),
        ({"above": 0.0, "most": 90.0}, (90.0,), (0.0, 91.0), "must be a number above 0 to 90"),
        ({"least": 0.0, "below": 1.0}, (0.0,), (1.0,), "must be a number from 0 and below 1"),
    ],
)
def test_bounds_are_held_and_reported(
    bounds: dict[str, Any], inside: tuple[float, ...], outside: tuple[float, ...], message: str
) -> None:
    for value in inside:
        assert checked.number("arm", value, **bounds) == value
    for value in outside:
        with pytest.raises(GeometryError) as caught:
            checked.number("arm", value, unit="mm", **bounds)
        assert caught.value.message == f"{message} (mm)"
        assert caught.value.value == repr(value)


def test_whole_numbers() -> None:
    assert checked.whole("count", np.int64(3), 1, 3) == 3
    for value in (0, 4, 1.0, True, None, "2", 10**400):
        with pytest.raises(GeometryError, match="a whole number from 1 to 3"):
            checked.whole("count", value, 1, 3)


def test_one_of_a_few() -> None:
    assert checked.one_of("direction", np.int64(-1), (1, -1)) == -1
    assert checked.one_of("task", "R-R", ("R-R", "R-U")) == "R-R"
    for value in (True, 0, None, "1", math.nan, np.ones(2), [1]):
        with pytest.raises(GeometryError, match="must be one of 1, -1"):
            checked.one_of("direction", value, (1, -1))
    with pytest.raises(GeometryError, match='must be one of "R-R"'):
        checked.one_of("task", 1, ("R-R",))


def test_instances() -> None:
    assert checked.instance("law", "text", str, "a name") == "text"
    with pytest.raises(GeometryError, match="must be a name"):
        checked.instance("law", 3, str, "a name")


def test_arrays_are_copied_and_read_only() -> None:
    given_values = np.array([1, 2, 3])
    found = checked.array("t", given_values)
    assert found.dtype == np.float64
    assert not found.flags.writeable
    own = np.array([1.0, 2.0])
    found = checked.array("t", own)
    own[0] = 7.0
    assert found.tolist() == [1.0, 2.0]
    assert checked.array("t", [[1.0], [2.0]], 2).shape == (2, 1)


@pytest.mark.parametrize(
    "values",
    [
        None,
        "12",
        ["1", "2"],
        [1.0, None],
        [True, False],
        [[1.0], [2.0, 3.0]],
        [1.0 + 0j],
        [1.0, math.nan],
        [math.inf],
        [1e308],
        [10**400],
        3.0,
        [[1.0, 2.0]],
        (x for x in (1.0, 2.0)),
    ],
)
def test_what_is_no_array_of_numbers_is_refused(values: Any) -> None:
    with pytest.raises(GeometryError, match="must be") as caught:
        checked.array("t", values)
    assert caught.value.key == "t"
