"""What a scene states on printing, and the rollers and test rings on its plate."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import pytest

from camgeo.cam.cam import Contact
from camgeo.design.plate import ring_part, roller_part
from camgeo.errors import GeometryError
from camgeo.part.compensation import Foot, PrintSpec, Shrinkage, print_of, with_clearance
from camgeo.part.mass import solid
from camgeo.part.spec import Keyway, PartSpec
from tests.part.parts import made, refused

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


DISC = PartSpec(thickness=10.0, bore=20.0, rim=140.0, keyway=Keyway(6.0, 2.8, 0.4))


@pytest.mark.parametrize("bore", [None, 6.0])
def test_a_roller(bore: float | None) -> None:
    for spec, clearance in ((None, 0.0), (PrintSpec(bore_clearance=0.2), 0.2)):
        part = roller_part(8.0, 5.0, bore, spec)
        hole = 0.0 if bore is None else 0.5 * (bore + clearance)
        assert solid(part).volume == pytest.approx(math.pi * (64.0 - hole**2) * 5.0, rel=1e-12)
        assert part.outermost.farthest()[0] == 8.0


def test_a_roller_with_too_large_a_bore() -> None:
    with refused("output.3mf.roller_bore", r"less than 15\.8 mm"):
        roller_part(8.0, 5.0, 15.9, PrintSpec(bore_clearance=0.2))


def test_a_ring_has_the_bore_of_the_part() -> None:
    spec = with_clearance(DISC, PrintSpec(bore_clearance=0.2, key_clearance=0.1))
    fitted = made(Contact.INNER, spec)
    ring = ring_part(fitted)
    outer, bore = ring.layers[0].boundaries
    assert bore in fitted.boundaries
    assert outer.nearest() == pytest.approx(abs(complex(12.85, 3.05)) + 3.0, abs=1e-9)
    assert ring.thickness == 6.0
    thin = ring_part(made(Contact.INNER, replace(DISC, thickness=4.0)))
    assert thin.thickness == 4.0
    large = ring_part(made(Contact.INNER, replace(DISC, bore=40.0, keyway=None)))
    assert large.layers[0].boundaries[0].nearest() == pytest.approx(24.0)


def test_a_ring_needs_a_bore() -> None:
    with refused("output.3mf.plate", "needs the bore"):
        ring_part(made(Contact.INNER, replace(DISC, bore=None, keyway=None)))
