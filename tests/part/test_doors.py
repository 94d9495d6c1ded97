"""Refusals of the classes of a part, beyond those that tests/mechanism/test_values.py covers."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import pytest

from camgeo.errors import GeometryError
from camgeo.part.assembly import bore_boundary
from camgeo.part.part import Wall
from camgeo.part.spec import DShaft, Engraving, Hub, Keyway, Pair, PartSpec, SetScrew
from tests.part.parts import refused

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
