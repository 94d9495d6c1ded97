"""What a scene states of a part: doors, defaults, keyways against published tables.

`DIN`: DIN 6885-1, August 1968, page 1: width b, and depth t2 in the hub with clearance above the
key. `FLENDER`: Siemens, FLENDER Standard Couplings, catalogue MD 10.1, 2015, page 15/3, which
begins at 10 mm. Both have one row more: above 440 mm b is 100 mm, and t2 19.5 or 19.4 mm.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from camgeo.errors import GeometryError
from camgeo.part.assembly import bore_boundary
from camgeo.part.part import Wall
from camgeo.part.spec import (
    ROWS,
    SMALLEST,
    Chamfer,
    Counterbore,
    DShaft,
    Engraving,
    Holes,
    Hub,
    Keyway,
    Mark,
    Pair,
    PartSpec,
    Row,
    SetScrew,
    din_6885_1,
)
from tests.part.parts import refused
from tests.strategies import attack

WRONG_LENGTHS: tuple[Any, ...] = (
    0, 0.0, -5.0, math.nan, math.inf, -math.inf, 5e-324, 1e300, 10**400, "3", True, 1j, [1.0], {},
)  # fmt: skip

SPEC = PartSpec(12.0, 20.0, Keyway(6.0, 2.8), 100.0, 5.0)

TEXT = Engraving("Ø8", 4.0, 0.5, 20.0)


@pytest.mark.parametrize(
    ("changes", "key", "message"),
    [
        ({"groove_depth": 12.0}, "groove_depth", "below 12"),
        ({"bore": None}, "keyway", "belongs to a bore"),
        ({"d_shaft": DShaft(18.0)}, "d_shaft", "not both"),
        ({"keyway": None, "d_shaft": DShaft(10.0)}, "d_shaft.across", "above 10 .* below 20"),
        ({"keyway": None, "d_shaft": DShaft(20.0)}, "d_shaft.across", "above 10 .* below 20"),
        ({"set_screw": SetScrew(5.0, 4.0)}, "set_screw", "a hub with a bore"),
        ({"hub": Hub(30.0, 8.0), "set_screw": SetScrew(8.0, 4.0)}, "set_screw.diameter", "below 8"),
        ({"hub": Hub(30.0, 8.0), "set_screw": SetScrew(5.0, 2.5)}, "set_screw.height", "above 2.5"),
        ({"keyway": (6.0, 2.8)}, "keyway", "must be a .Keyway."),
        ({"thickness": None, "groove_depth": None, "pair": Pair(5.0, 30.0)}, "pair", "thickness"),
        ({"pair": Pair(5.0, 20.0)}, "pair.spacer", "above 20"),
        ({"engraving": (TEXT, replace(TEXT, depth=12.0))}, "engraving[2].depth", "below 12"),
        ({"engraving": 21 * (TEXT,)}, "engraving", "at most 20"),
        ({"engraving": ("cam",)}, "engraving", "texts"),
    ],
)
def test_what_does_not_go_together(changes: dict[str, Any], key: str, message: str) -> None:
    with refused(f"part.{key}", message):
        replace(SPEC, **changes)


@pytest.mark.parametrize("value", WRONG_LENGTHS, ids=repr)
def test_diameter_of_a_bore(value: Any) -> None:
    with refused("part.bore"):
        bore_boundary(value, None)


def test_values_are_floats_inside() -> None:
    assert type(replace(SPEC, thickness=12).thickness) is float


@pytest.mark.parametrize("heights", [(0.0, -1.0), (-1.0, -1.5)])
def test_walls_reach_upwards(heights: tuple[float, float]) -> None:
    with refused("part"):
        Wall(bore_boundary(20.0, None), *heights)


def test_only_round_outlines_have_parallels_of_their_own() -> None:
    keyed = bore_boundary(20.0, Keyway(6.0, 2.8))
    assert keyed.offset(3.0).round_radius == bore_boundary(20.0, None).offset(3.0).round_radius == 7
    with pytest.raises(GeometryError, match="is not round"):
        replace(keyed, core=None).offset(3.0)
    with pytest.raises(GeometryError, match="above 0"):
        keyed.offset(10.0)


VALUES: dict[str, tuple[type, dict[str, float]]] = {
    "part.keyway": (Keyway, {"width": 6.0, "depth": 2.8}),
    "part.d_shaft": (DShaft, {"across": 17.0}),
    "part.hub": (Hub, {"diameter": 40.0, "height": 6.0}),
    "part.set_screw": (SetScrew, {"diameter": 4.0, "height": 3.0}),
    "part.mark": (Mark, {"radius": 25.0, "width": 2.0, "depth": 1.0}),
    "part.bolt_circle.counterbore": (Counterbore, {"diameter": 6.0, "depth": 3.0}),
    "part.holes": (Holes, {"count": 3, "circle": 40.0, "hole": 5.0}),
    "part.pair": (Pair, {"gap": 7.0, "spacer": 36.0}),
    "part.chamfers": (Chamfer, {"width": 1.0}),
    "part.engraving": (Engraving, {"height": 4.0, "depth": 0.5, "radius": 20.0}),
}


@pytest.mark.parametrize("table", VALUES)
def test_each_value_is_checked_under_its_key(table: str) -> None:
    kind, values = VALUES[table]
    given: dict[str, Any] = {"text": "a", **values} if kind is Engraving else values
    made = kind(**given)
    assert getattr(made, "angle", 0.0) == 0.0
    for name in values:
        with refused(f"{table}.{name}"):
            kind(**{**given, name: -1})
    if hasattr(made, "angle"):
        with refused(f"{table}.angle"):
            kind(**{**given, "angle": 6.3})


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
