"""Refusals of the classes of a part, beyond those that tests/mechanism/test_values.py covers."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import pytest

from camgeo.errors import GeometryError
from camgeo.part.assembly import bore_boundary
from camgeo.part.part import Wall
from camgeo.part.spec import DShaft, Hub, Keyway, PartSpec, SetScrew

WRONG_LENGTHS: tuple[Any, ...] = (
    0, 0.0, -5.0, math.nan, math.inf, -math.inf, 5e-324, 1e300, 10**400, "3", True, 1j, [1.0], {},
)  # fmt: skip

SPEC = PartSpec(12.0, 20.0, Keyway(6.0, 2.8), 100.0, 5.0)


def test_what_does_not_go_together() -> None:
    with pytest.raises(GeometryError, match="below 12") as caught:
        replace(SPEC, groove_depth=12.0)
    assert caught.value.key == "part.groove_depth"
    with pytest.raises(GeometryError, match="belongs to a bore") as caught:
        replace(SPEC, bore=None)
    assert caught.value.key == "part.keyway"
    with pytest.raises(GeometryError, match="not both") as caught:
        replace(SPEC, d_shaft=DShaft(18.0))
    assert caught.value.key == "part.d_shaft"
    for across in (10.0, 20.0):
        with pytest.raises(GeometryError, match=r"above 10 .* below 20") as caught:
            replace(SPEC, keyway=None, d_shaft=DShaft(across))
        assert caught.value.key == "part.d_shaft.across"
    with pytest.raises(GeometryError, match="a hub with a bore") as caught:
        replace(SPEC, set_screw=SetScrew(5.0, 4.0))
    assert caught.value.key == "part.set_screw"
    for screw, key in ((SetScrew(8.0, 4.0), "diameter"), (SetScrew(5.0, 2.5), "height")):
        with pytest.raises(GeometryError) as caught:
            replace(SPEC, hub=Hub(30.0, 8.0), set_screw=screw)
        assert caught.value.key == f"part.set_screw.{key}"
    with pytest.raises(GeometryError, match=r"must be a .Keyway.") as caught:
        replace(SPEC, keyway=(6.0, 2.8))  # type: ignore[arg-type]  # wrong on purpose
    assert caught.value.key == "part.keyway"


@pytest.mark.parametrize("value", WRONG_LENGTHS, ids=repr)
def test_diameter_of_a_bore(value: Any) -> None:
    with pytest.raises(GeometryError) as caught:
        bore_boundary(value, None)
    assert caught.value.key == "part.bore"


def test_values_are_floats_inside() -> None:
    assert type(replace(SPEC, thickness=12).thickness) is float


@pytest.mark.parametrize("heights", [(0.0, -1.0), (-1.0, -1.5)])
def test_walls_reach_upwards(heights: tuple[float, float]) -> None:
    with pytest.raises(GeometryError) as caught:
        Wall(bore_boundary(20.0, None), *heights)
    assert caught.value.key == "part"


def test_only_round_outlines_have_parallels_of_their_own() -> None:
    keyed = bore_boundary(20.0, Keyway(6.0, 2.8))
    assert keyed.offset(3.0).round_radius == bore_boundary(20.0, None).offset(3.0).round_radius == 7
    with pytest.raises(GeometryError, match="is not round"):
        replace(keyed, core=None).offset(3.0)
    with pytest.raises(GeometryError, match="above 0"):
        keyed.offset(10.0)
