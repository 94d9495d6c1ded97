"""The value table of a law, and the guideline's own four: equal in every cell but the listed ones.

`fixtures/tables` holds the tables as printed and two lists of the cells that are not the exact
value rounded: misprints, and last digits cut off or rounded the wrong way.
"""

from __future__ import annotations

import csv
import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from decimal import Decimal
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from camgeo.errors import GeometryError
from camgeo.kinematics.laws import make_law
from camgeo.kinematics.tables import LARGEST_STEP, NAMES, SMALLEST_STEP, law_table
from tests.long_form import examples

FOLDER = Path(__file__).parents[2] / "fixtures" / "tables"

TABLES = {
    "polynomial-345": "poly345",
    "inclined-sine": "inclined_sine",
    "modified-trapezoid": "mod_acc_trapezoid",
    "modified-sine": "mod_sine",
}
"""The guideline's laws and what the lists call their tables."""

by_table = pytest.mark.parametrize("name", TABLES)

Place = tuple[str, str]
"""A cell: z as printed and the column."""

Cells = Mapping[Place, str]


@dataclass(frozen=True, slots=True)
class Listed:
    """A printed cell that is known not to be the exact value rounded, and what it ought to be."""

    printed: str
    rounded: str


def cells(rows: Iterable[Iterable[str]]) -> dict[Place, str]:
    found: dict[Place, str] = {}
    for z, *row in rows:
        for column, text in zip(("f", "f1", "f2"), row, strict=True):
            assert (z, column) not in found
            found[z, column] = text
    return found


def read_printed(name: str) -> dict[Place, str]:
    with (FOLDER / f"{name}_printed.csv").open(newline="", encoding="utf-8") as file:
        head, *rows = csv.reader(file)
    assert head == ["z", "f", "f1", "f2"]
    return cells(rows)


def read_list(file_name: str, table: str) -> dict[Place, Listed]:
    with (FOLDER / file_name).open(newline="", encoding="utf-8") as file:
        rows = [row for row in csv.DictReader(file) if row["table"] == table]
    found = {
        (row["z"], row["column"]): Listed(row["printed"], row["correct_rounded"]) for row in rows
    }
    assert len(found) == len(rows)
    return found


def read_lists(name: str) -> dict[Place, Listed]:
    errata, rounding = (read_list(f"{kind}.csv", TABLES[name]) for kind in ("errata", "rounding"))
    assert not errata.keys() & rounding.keys()
    return errata | rounding


def computed(name: str) -> dict[Place, str]:
    return cells(law_table(make_law(name), Decimal("0.002")).printed())


# The guideline's tables -----------------------------------------------------------------------


@by_table
def test_the_printed_table_differs_in_the_listed_cells_only(name: str) -> None:
    printed, listed = read_printed(name), read_lists(name)
    assert len(printed) == 3 * 501
    assert all(printed[place] == each.printed != each.rounded for place, each in listed.items())
    assert computed(name) == printed | {place: each.rounded for place, each in listed.items()}


def test_the_lists_are_of_these_tables() -> None:
    """87 misprints, 476 roundings and four zeros with a sign, all of them compared above."""
    for file_name, count in (("errata.csv", 87), ("rounding.csv", 476 + 4)):
        with (FOLDER / file_name).open(newline="", encoding="utf-8") as file:
            assert sum(1 for _ in file) - 1 == count
        assert sum(len(read_list(file_name, table)) for table in TABLES.values()) == count
    signed = [
        (name, place)
        for name in TABLES
        for place, text in read_printed(name).items()
        if text == "-0.0000"
    ]
    assert signed == [
        ("polynomial-345", ("1.000", "f2")),
        ("inclined-sine", ("1.000", "f2")),
        ("modified-trapezoid", ("1.000", "f1")),
        ("modified-sine", ("1.000", "f2")),
    ]
    assert all(read_lists(name)[place] == Listed("-0.0000", "0.0000") for name, place in signed)


# The table of any law -------------------------------------------------------------------------

few = settings(max_examples=examples(10, long=60))

steps = st.decimals(SMALLEST_STEP * 200, LARGEST_STEP, allow_nan=False, places=8)


@few
@given(name=st.sampled_from([*TABLES, "quadratic-parabola"]), step=steps)
def test_z_runs_over_the_exact_multiples_and_ends_at_1(name: str, step: Decimal) -> None:
    law = make_law(name)
    table = law_table(law, step)
    exact = [Fraction(z) for z in table.z]
    assert exact[:-1] == [Fraction(step) * number for number in range(len(exact) - 1)]
    assert 0 < exact[-1] - exact[-2] <= Fraction(step)
    assert exact[-1] == 1
    z = table.values[:, 0]
    assert z.tolist() == [float(place) for place in table.z]
    assert table.values.shape == (len(exact), len(NAMES))
    assert np.array_equal(table.values[:, 1:], law(z).T)
    assert not np.any(np.signbit(table.values) & (table.values == 0.0))


def test_a_third_has_all_its_digits() -> None:
    """40 digits are more than decimals are computed with by default."""
    third = Decimal("0." + 40 * "3")
    table = law_table(make_law("modified-sine"), third)
    assert [Fraction(z) for z in table.z[:4]] == [Fraction(third) * number for number in range(4)]
    assert len(table.z) == 5
    assert table.printed()[1][0] == str(third)


@pytest.mark.parametrize(
    "step",
    [
        SMALLEST_STEP * 20,
        # A million rows are made as fifty thousand are.
        pytest.param(SMALLEST_STEP, marks=pytest.mark.long),
    ],
)
def test_the_finest_table(step: Decimal) -> None:
    table, count = law_table(make_law("polynomial-345"), step), int(1 / step)
    assert table.values.shape == (count + 1, 5)
    assert table.values[:, 0].tolist() == [number / count for number in range(count + 1)]


@pytest.mark.parametrize(
    "step",
    [
        *map(Decimal, ("0", "-0.002", "0.0000009", "0.500001", "1", "NaN", "sNaN", "Infinity")),
        *(Decimal("-Infinity"), None, "0.002", 1, math.nan, True),
    ],
)
def test_a_step_outside_the_limits_is_refused(step: Any) -> None:
    with pytest.raises(GeometryError, match=r"a step of z from 0\.000001 to 0\.5") as raised:
        law_table(make_law("modified-sine"), step)
    assert raised.value.key == "step"
    assert not isinstance(step, Decimal) or raised.value.value == str(step)


def test_the_values_of_the_most_extreme_law_are_numbers() -> None:
    """The jerk of an inflection point at 1e-30 has 1e60; none is nearer to the border."""
    with pytest.raises(GeometryError, match="strictly between 0 and 1") as raised:
        make_law("modified-sine", inflection=1e-31)
    assert raised.value.key == "inflection"
    table = law_table(make_law("modified-sine", inflection=1e-30))
    assert 1e60 < table.values[0, 4] < 1e62


def test_a_float_is_the_decimal_that_it_is_written_as() -> None:
    law = make_law("modified-sine")
    assert law_table(law, 0.1).z == law_table(law, Decimal("0.1")).z


def test_rounding_is_of_the_double_itself() -> None:
    """1/32 = 0.03125 is a tie at four decimals: to the even digit. 0.00015 is not the tie it
    looks like: as a double it is smaller, so it rounds down. What rounds to zero has no sign."""
    table = law_table(make_law("modified-sine"), Decimal("0.5"))
    values = [[0.0, 3 * 2.0**-8, 0.03125, 0.00015, 0.0], [0.5, -4e-8, -4e-5, -0.09375, 0.0]]
    rows = replace(table, z=table.z[:2], values=np.array(values)).printed()
    # 3/256 = 0.01171875 is a tie at seven decimals, 0.09375 one at four.
    assert rows == [
        ("0.000", "0.0117188", "0.0312", "0.0001", ),
        ("0.500", "0.0000000", "0.0000", "-0.0938"),
    ]  # fmt: skip
