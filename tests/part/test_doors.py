"""Every value of the part is checked where it comes in, with its key."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import pytest

from camgeo.contour.contour import Contour
from camgeo.errors import GeometryError
from camgeo.part.bore import bore_boundary
from camgeo.part.boundaries import CurveBoundary, ExactBoundary
from camgeo.part.part import Wall
from camgeo.part.spec import Keyway, PartSpec

WRONG_LENGTHS: tuple[Any, ...] = (
    0, 0.0, -5.0, math.nan, math.inf, -math.inf, 5e-324, 1e300, 10**400, "3", True, 1j, [1.0], {},
)  # fmt: skip

SPEC = PartSpec(12.0, 20.0, Keyway(6.0, 2.8), 100.0, 5.0)

CIRCLE = Contour.circle(10.0)

BOUNDARY = ExactBoundary("bore", hole=True, exact=CIRCLE)


@pytest.mark.parametrize("value", WRONG_LENGTHS, ids=repr)
@pytest.mark.parametrize("name", ["thickness", "bore", "rim", "groove_depth"])
def test_lengths_of_the_part(name: str, value: Any) -> None:
    with pytest.raises(GeometryError) as caught:
        replace(SPEC, **{name: value})
    assert caught.value.key == f"part.{name}"
    assert caught.value.value


@pytest.mark.parametrize("value", WRONG_LENGTHS, ids=repr)
@pytest.mark.parametrize("name", ["width", "depth"])
def test_lengths_of_the_keyway(name: str, value: Any) -> None:
    with pytest.raises(GeometryError) as caught:
        replace(Keyway(6.0, 2.8), **{name: value})
    assert caught.value.key == f"part.keyway.{name}"


@pytest.mark.parametrize("value", [math.nan, math.inf, "90", None], ids=repr)
def test_direction_of_the_keyway(value: Any) -> None:
    with pytest.raises(GeometryError) as caught:
        Keyway(6.0, 2.8, value)
    assert caught.value.key == "part.keyway.angle"


def test_what_does_not_go_together() -> None:
    with pytest.raises(GeometryError, match="below 12") as caught:
        replace(SPEC, groove_depth=12.0)
    assert caught.value.key == "part.groove_depth"
    with pytest.raises(GeometryError, match="belongs to a bore") as caught:
        replace(SPEC, bore=None)
    assert caught.value.key == "part.keyway"
    with pytest.raises(GeometryError, match=r"must be a .Keyway.") as caught:
        replace(SPEC, keyway=(6.0, 2.8))  # type: ignore[arg-type]
    assert caught.value.key == "part.keyway"


@pytest.mark.parametrize("value", WRONG_LENGTHS, ids=repr)
def test_diameter_of_a_bore(value: Any) -> None:
    with pytest.raises(GeometryError) as caught:
        bore_boundary(value, None)
    assert caught.value.key == "part.bore"


def test_values_are_floats_inside() -> None:
    assert type(replace(SPEC, thickness=12).thickness) is float


@pytest.mark.parametrize("change", [{"name": 3}, {"hole": 1}, {"exact": None}, {"core": 5.0}])
def test_boundaries_are_of_their_kind(change: dict[str, Any]) -> None:
    with pytest.raises(GeometryError) as caught:
        replace(BOUNDARY, **change)
    assert caught.value.key == "part"


def test_a_flank_needs_its_path() -> None:
    with pytest.raises(GeometryError, match="must be an outline"):
        CurveBoundary("outline", hole=False, path=CIRCLE)  # type: ignore[arg-type]


@pytest.mark.parametrize("heights", [(0.0, -1.0), (math.nan, 1.0), (0.0, math.inf), ("0", 1.0)])
def test_walls_reach_upwards(heights: tuple[Any, Any]) -> None:
    with pytest.raises(GeometryError) as caught:
        Wall(BOUNDARY, *heights)
    assert caught.value.key == "part"


def test_only_round_outlines_have_parallels_of_their_own() -> None:
    keyed = bore_boundary(20.0, Keyway(6.0, 2.8))
    assert keyed.beside(3.0).round_radius == bore_boundary(20.0, None).beside(3.0).round_radius == 7
    with pytest.raises(GeometryError, match="is not round"):
        replace(keyed, core=None).beside(3.0)
    with pytest.raises(GeometryError, match="above 0"):
        keyed.beside(10.0)
