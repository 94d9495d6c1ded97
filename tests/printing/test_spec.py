"""What a scene states on printing, in numbers and in words."""

from __future__ import annotations

from typing import Any

import pytest

from camgeo.errors import GeometryError
from camgeo.part.printing import Foot, PrintSpec, Shrinkage, print_of
from tests.part.parts import refused

TABLE = {
    "bore_clearance": 0.2,
    "key_clearance": 0.1,
    "elephant_foot": {"inset": 0.3, "height": 0.6, "steps": 3.0},
    "shrinkage": {"xy": 0.5, "z": -1.0},
}


def test_a_whole_table() -> None:
    spec = print_of(TABLE)
    assert spec.elephant_foot == Foot(0.3, 0.6, 3)
    assert spec.elephant_foot.insets == pytest.approx((0.3, 0.2, 0.1))
    assert spec.scale_xy == pytest.approx(100.0 / 99.5, rel=1e-15)
    assert spec.scale_z == pytest.approx(100.0 / 101.0, rel=1e-15)
    assert spec.compensates
    assert spec.facts == {
        "bore_clearance_mm": 0.2,
        "key_clearance_mm": 0.1,
        "foot_inset_mm": 0.3,
        "foot_height_mm": 0.6,
        "foot_steps": 3,
        "scale_xy": spec.scale_xy,
        "scale_z": spec.scale_z,
    }
    assert spec.text == (
        "bore 0.2 mm larger in diameter, 0.1 mm per side; keyway or flat with 0.1 mm clearance,"
        " 0.05 mm per side; lowest 0.6 mm drawn in by 0.3 mm per side in 3 steps; scaled by 1.00503"
        " in X and Y, 0.990099 in Z"
    )


@pytest.mark.parametrize("table", [{}, {"shrinkage": {}}, {"shrinkage": {"xy": 0, "z": 0.0}}])
def test_what_compensates_nothing(table: dict[str, Any]) -> None:
    spec = print_of(table)
    assert not spec.compensates
    assert spec.facts == {}
    assert spec.text == ""


@pytest.mark.parametrize(
    ("table", "key"),
    [
        ({"bore_clearance": 0.0}, "bore_clearance"),
        ({"key_clearance": -0.1}, "key_clearance"),
        ({"elephant_foot": {"inset": 0.1, "height": 0.0}}, "elephant_foot.height"),
        ({"elephant_foot": {"inset": "x", "height": 0.1}}, "elephant_foot.inset"),
        ({"elephant_foot": {"inset": 1, "height": 1, "steps": 21}}, "elephant_foot.steps"),
        ({"shrinkage": {"xy": 20.5}}, "shrinkage.xy"),
        ({"shrinkage": {"z": float("nan")}}, "shrinkage.z"),
    ],
)
def test_refusals(table: dict[str, Any], key: str) -> None:
    with refused(f"print.{key}"):
        print_of(table)


def test_types() -> None:
    with pytest.raises(GeometryError):
        PrintSpec(elephant_foot=Shrinkage())  # type: ignore[arg-type]  # wrong on purpose
