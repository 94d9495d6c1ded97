"""The table of keyways against published ones.

`DIN`: DIN 6885-1, August 1968, page 1: width b, and depth t2 in the hub with clearance above the
key. `FLENDER`: Siemens, FLENDER Standard Couplings, catalogue MD 10.1, 2015, page 15/3, which
begins at 10 mm. Both have one row more: above 440 mm b is 100 mm, and t2 19.5 or 19.4 mm.
"""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from camgeo.part.spec import ROWS, SMALLEST, Row, din_6885_1
from tests.part.parts import refused
from tests.strategies import attack

DIN = {
    "up to": (
        8, 10, 12, 17, 22, 30, 38, 44, 50, 58, 65, 75, 85, 95, 110, 130, 150, 170, 200, 230, 260,
        290, 330, 380, 440,
    ),
    "b": (
        2, 3, 4, 5, 6, 8, 10, 12, 14, 16, 18, 20, 22, 25, 28, 32, 36, 40, 45, 50, 56, 63, 70, 80,
        90,
    ),
    "t2": (
        1, 1.4, 1.8, 2.3, 2.8, 3.3, 3.3, 3.3, 3.8, 4.3, 4.4, 4.9, 5.4, 5.4, 6.4, 7.4, 8.4, 9.4,
        10.4, 11.4, 12.4, 12.4, 14.4, 15.4, 17.4,
    ),
}  # fmt: skip

FLENDER = (
    (10, 3, 1.4), (12, 4, 1.8), (17, 5, 2.3), (22, 6, 2.8), (30, 8, 3.3), (38, 10, 3.3),
    (44, 12, 3.3), (50, 14, 3.8), (58, 16, 4.3), (65, 18, 4.4), (75, 20, 4.9), (85, 22, 5.4),
    (95, 25, 5.4), (110, 28, 6.4), (130, 32, 7.4), (150, 36, 8.4), (170, 40, 9.4), (200, 45, 10.4),
    (230, 50, 11.4), (260, 56, 12.4), (290, 63, 12.4), (330, 70, 14.4), (380, 80, 15.4),
    (440, 90, 17.4),
)  # fmt: skip


def test_the_table_is_that_of_the_standard() -> None:
    assert list(ROWS) == list(map(Row._make, zip(*DIN.values(), strict=True)))


def test_the_table_is_that_of_a_maker_of_couplings() -> None:
    assert list(ROWS[1:]) == [Row(*row) for row in FLENDER]


def test_widths_and_depths_grow_with_the_bore() -> None:
    """A typing error, as 38 for 28 at 95 to 110 mm in a table that is in circulation, breaks it."""
    widths, depths = [row.width for row in ROWS], [row.depth for row in ROWS]
    assert widths == sorted(set(widths))
    assert depths == sorted(depths)


@given(st.floats(SMALLEST, ROWS[-1].largest, exclude_min=True))
@attack
def test_each_bore_has_one_row(bore: float) -> None:
    found = din_6885_1(bore)
    assert bore <= found.largest
    assert all(row.largest < bore for row in ROWS if row.largest < found.largest)


@pytest.mark.parametrize(
    ("bore", "width"), [(17.0, 5.0), (17.000001, 6.0), (95.0, 25.0), (100.0, 28.0), (110.0, 28.0)]
)
def test_ranges_end_with_their_diameter(bore: float, width: float) -> None:
    assert din_6885_1(bore).width == width


@pytest.mark.parametrize("bore", [6.0, 5.0, 440.1, 500.0])
def test_bores_without_a_row(bore: float) -> None:
    with refused("part.keyway.standard", "above 6 mm, up to 440 mm"):
        din_6885_1(bore)
