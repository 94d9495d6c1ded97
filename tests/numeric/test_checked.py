"""Values checked where they come in: numbers of any kind pass, anything else is refused."""

from __future__ import annotations

import math
from dataclasses import dataclass
from decimal import Decimal
from fractions import Fraction
from itertools import product
from types import MappingProxyType
from typing import Annotated, Any

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


def test_one_of_a_few() -> None:
    assert checked.one_of("direction", np.int64(-1), (1, -1)) == -1
    assert checked.one_of("task", "R-R", ("R-R", "R-U")) == "R-R"
    for value in (True, 0, None, "1", math.nan, np.ones(2), [1]):
        with pytest.raises(GeometryError, match="must be one of 1, -1"):
            checked.one_of("direction", value, (1, -1))
    with pytest.raises(GeometryError, match='must be one of "R-R"'):
        checked.one_of("task", 1, ("R-R",))


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


@pytest.mark.parametrize(
    "bounds",
    [
        dict(zip(("above", "least", "below", "most"), each, strict=True))
        for each in product((None, 1.0), (None, 2.0), (None, 8.0), (None, 7.0))
    ],
)
def test_each_set_of_bounds_holds_by_itself_and_is_told(bounds: dict[str, Any]) -> None:
    """Each value next to each bound against the words of the bounds; a later word replaces."""
    stated = {name: value for name, value in bounds.items() if value is not None}
    for edge in (1.0, 2.0, 7.0, 8.0):
        for value in (math.nextafter(edge, -9.0), edge, math.nextafter(edge, 9.0)):
            good = (
                value > stated.get("above", -math.inf)
                and value >= stated.get("least", -math.inf)
                and value < stated.get("below", math.inf)
                and value <= stated.get("most", math.inf)
            )
            if good:
                assert checked.number("arm", value, **bounds) == value
                continue
            with pytest.raises(GeometryError) as caught:
                checked.number("arm", value, **bounds)
            told = caught.value.message
            low = "from 2" if "least" in stated else "above 1" if "above" in stated else ""
            high = "to 7" if "most" in stated else "below 8" if "below" in stated else ""
            joint = {"to 7": " " if low else " up ", "below 8": " and " if low else " "}.get(high)
            wanted = f"must be a number{' ' if low else ''}{low}{joint or ''}{high}"
            assert told == wanted
    with pytest.raises(GeometryError) as caught:
        checked.number("arm", math.nan, unit="mm", **bounds)
    assert caught.value.message.endswith(" (mm)")
    if not stated:
        assert caught.value.message == "must be a finite number (mm)"


def test_magnitudes_end_at_their_limits() -> None:
    for largest in (checked.LARGEST, 1e50):
        for value in (largest, -largest):
            assert checked.number("arm", value, largest=largest) == value
            beyond = math.nextafter(value, math.copysign(math.inf, value))
            with pytest.raises(GeometryError) as caught:
                checked.number("arm", beyond, largest=largest)
            assert caught.value.message == f"must be at most {largest:g} in magnitude"
        assert checked.array("t", [largest], largest=largest).tolist() == [largest]
        beyond = math.nextafter(largest, math.inf)
        with pytest.raises(GeometryError, match="finite numbers, at most"):
            checked.array("t", [-beyond], largest=largest)
    below = math.nextafter(checked.SMALLEST, 0.0)
    assert checked.number("arm", below, least=0.0) == below
    with pytest.raises(GeometryError) as caught:
        checked.positive("arm", below)
    assert caught.value.message == "must be at least 1e-30"
    assert checked.number("arm", 1.0 + below, above=1.0 - 1e-9) == 1.0


STEPS = (Decimal("0.1"), Decimal("0.5"))


@pytest.mark.parametrize(
    ("value", "found"),
    [
        (0.1, "0.1"),
        (0.5, "0.5"),
        (0.2, "0.2"),
        (Decimal("0.30000000000000000001"), "0.30000000000000000001"),
        (np.float64(0.2), "0.2"),
        (Fraction(1, 4), "0.25"),
    ],
)
def test_a_decimal_number_is_the_one_that_is_printed(value: Any, found: str) -> None:
    assert checked.decimal("step", value, *STEPS) == Decimal(found)
    assert checked.decimal("step", 3, Decimal(1), Decimal(3)) == 3
    whole = 10**20 + 1
    assert checked.decimal("step", whole, Decimal(1), Decimal(2 * whole)) == whole


@pytest.mark.parametrize(
    ("value", "told"),
    [
        (Decimal("0.09999999999999999999"), "0.09999999999999999999"),
        (Decimal("0.50000000000000000001"), "0.50000000000000000001"),
        (math.nextafter(0.1, 0.0), "0.09999999999999999"),
        (0.6, "0.6"),
        (1, "1.0"),
        (math.nan, "nan"),
        (-math.inf, "-inf"),
        (Decimal("NaN"), "NaN"),
        (Decimal("Infinity"), "Infinity"),
        ("0.2", "0.2"),
        (True, "True"),
        (None, "None"),
    ],
)
def test_what_is_no_decimal_number_in_range_is_refused(value: Any, told: str) -> None:
    for unit, what, words in (
        ("deg", "step", "must be a step from 0.1 to 0.5 (deg)"),
        ("", "number", "must be a number from 0.1 to 0.5"),
    ):
        with pytest.raises(GeometryError) as caught:
            checked.decimal("step", value, *STEPS, unit, what)
        assert caught.value.message == words
        assert (caught.value.key, caught.value.value) == ("step", told)


def test_points_are_told_by_the_part_that_is_wrong() -> None:
    assert checked.point("pivot", 3) == 3 + 0j
    assert checked.point("pivot", -1.5 + 2j, "mm") == -1.5 + 2j
    for value, words in (
        (complex(math.nan, 1.0), "must be a finite number (mm)"),
        (complex(1.0, -math.inf), "must be a finite number (mm)"),
        (True, "must be a point x + i y, a complex number"),
        ((1.0, 2.0), "must be a point x + i y, a complex number"),
    ):
        with pytest.raises(GeometryError) as caught:
            checked.point("pivot", value, "mm")
        assert (caught.value.key, caught.value.message) == ("pivot", words)


def test_whole_numbers_end_at_their_limits() -> None:
    for value in (2, 7, np.int64(3)):
        assert checked.whole("count", value, 2, 7) == value
    for wrong in (4.0, True, None, "2"):
        with pytest.raises(GeometryError, match="a whole number from 2 to 7"):
            checked.whole("count", wrong, 2, 7)
    for value in (1, 8, -(10**400)):
        with pytest.raises(GeometryError) as caught:
            checked.whole("count", value, 2, 7)
        assert caught.value.message == "must be a whole number from 2 to 7"
        assert caught.value.value == repr(float(value) if abs(value) < 9 else -math.inf)


def test_instances_are_told_by_what_they_are_not() -> None:
    assert checked.instances("motion", [1, "a"], (int, str), "parts") == (1, "a")
    assert checked.instances("motion", (), (int,), "parts") == ()
    for values, told in (([1, 2.5], "2.5"), (7, "7.0"), ({"a": 1}, "{'a': 1}")):
        with pytest.raises(GeometryError) as caught:
            checked.instances("motion", values, (int,), "parts")
        assert caught.value.message == "must be a sequence of parts"
        assert (caught.value.key, caught.value.value) == ("motion", told)
    assert checked.among("a", {"a": 1})
    assert not checked.among("b", {"a": 1})
    assert not checked.among(["a"], {"a": 1})


def test_numbers_by_name_are_read_only_and_named_where_they_are_wrong() -> None:
    given_values = {"v0": 1, "a0": np.float32(2.5)}
    found = checked.by_name("parameters", given_values)
    given_values["v0"] = 9
    assert dict(found) == {"v0": 1.0, "a0": 2.5}
    assert list(found) == ["v0", "a0"]
    assert isinstance(found, MappingProxyType)
    for values, key in (([1.0], "parameters"), ({1: 2.0}, "parameters"), ({"v0": "x"}, "v0")):
        with pytest.raises(GeometryError) as caught:
            checked.by_name("parameters", values)
        assert caught.value.key == key
    assert checked.by_name("parameters", {"v": 1e40}, 1e50) == {"v": 1e40}
    with pytest.raises(GeometryError, match=r"at most 1e\+30 in magnitude"):
        checked.by_name("parameters", {"v": 1e40})


@pytest.mark.parametrize(
    ("values", "dimensions", "message", "told"),
    [
        ("12", 1, "must be a row of numbers", "12"),
        ([1.0], 2, "must be rows of numbers of equal length", "[1.0]"),
        ([[1.0], [2.0, 3.0]], 2, "must be rows of numbers of equal length", "[[1.0], [2.0, 3.0]]"),
        (
            [[1.0, 2.0], [3.0, -2e30]],
            2,
            "must be finite numbers, at most 1e+30 in magnitude; number 4 of them is not",
            "-2e+30",
        ),
        (
            [math.nan, math.inf],
            1,
            "must be finite numbers, at most 1e+30 in magnitude; number 1 of them is not",
            "nan",
        ),
    ],
)
def test_arrays_are_told_by_their_shape_or_their_first_wrong_number(
    values: Any, dimensions: int, message: str, told: str
) -> None:
    with pytest.raises(GeometryError) as caught:
        checked.array("t", values, dimensions)
    assert (caught.value.message, caught.value.value) == (message, told)


@dataclass(frozen=True)
class Wheel:
    radius: checked.Positive


@dataclass(frozen=True)
class Cart:
    """Each kind of field that is checked, and one that is not."""

    wheel: Wheel
    spare: Wheel | None
    load: checked.Finite | None
    length: Annotated[float, checked.positive, "cart.size"]
    places: checked.Row
    name: str = ""

    def __post_init__(self) -> None:
        checked.check_fields(self, "shop.")


def test_fields_are_what_their_annotations_say() -> None:
    given_values: dict[str, Any] = {"length": np.int64(3), "places": [1, 2]}
    cart = Cart(Wheel(2), None, None, **given_values)
    assert type(cart.length) is float
    assert cart.places.tolist() == [1.0, 2.0]
    assert not cart.places.flags.writeable
    given_values["name"] = 7  # which has no check
    assert Cart(Wheel(2), Wheel(1), 4, **given_values).load == 4.0


@pytest.mark.parametrize(
    ("changed", "key", "message"),
    [
        ({"wheel": None}, "shop.wheel", "must be a `Wheel`"),
        ({"wheel": 2.0}, "shop.wheel", "must be a `Wheel`"),
        ({"spare": "round"}, "shop.spare", "must be a `Wheel`"),
        ({"load": "much"}, "shop.load", "must be a finite number"),
        ({"length": None}, "shop.cart.size", "must be a number above 0"),
        ({"length": -1.0}, "shop.cart.size", "must be a number above 0"),
        ({"places": None}, "shop.places", "must be a row of numbers"),
    ],
)
def test_fields_that_are_wrong_are_told_by_their_keys(
    changed: dict[str, Any], key: str, message: str
) -> None:
    given_values: dict[str, Any] = {
        "wheel": Wheel(2.0), "spare": None, "load": 1.0, "length": 3.0, "places": [1.0]
    }  # fmt: skip
    with pytest.raises(GeometryError) as caught:
        Cart(**(given_values | changed))
    assert (caught.value.key, caught.value.message) == (key, message)


@pytest.mark.parametrize("what", ["a" * 60, "a" * 61, "a" * 57 + "bcd", [1] * 60, 10**400])
def test_values_are_shown_up_to_sixty_characters(what: Any) -> None:
    found = checked.shown(what)
    assert len(found) <= checked.LONGEST
    if isinstance(what, str):
        assert found == (what if len(what) <= 60 else what[:57] + "...")
    assert checked.shown(10**400) == "inf"
    assert checked.shown(-(10**400)) == "-inf"
    assert checked.shown(Fraction(1, 2)) == "0.5"
