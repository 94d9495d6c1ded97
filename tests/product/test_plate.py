"""Plates: what lies on them, apart, in a row of the positive quadrant."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import pytest

import camgeo
from camgeo.design.plate import STEP, Piece, plate_of
from tests.contour.cams import SCENES
from tests.findings import known
from tests.part.parts import refused


def _plate(name: str, values: dict[str, Any]) -> tuple[Piece, ...]:
    design = camgeo.load(SCENES / f"{name}.toml")
    return plate_of(camgeo.Design(design.scene.with_values(values)).disc)


BODIES = ["cam", "return-cam", "roller", "return-roller", "test-ring"]


def test_no_plate() -> None:
    assert _plate("plate_translating", {}) == ()


@pytest.mark.parametrize("gap", [0.1, 7.0])
def test_bodies_lie_apart(gap: float) -> None:
    plate = _plate("conjugate_carriage", {"output.3mf.plate": BODIES, "output.3mf.gap": gap})
    assert [each.kind for each in plate] == BODIES
    assert [each.name for each in plate] == [
        "conjugate_carriage", "conjugate_carriage-return", "roller", "return roller", "test ring",
    ]  # fmt: skip
    assert len({each.colour for each in plate}) == len(plate)
    for each in plate:
        assert each.part.outermost.farthest()[0] == pytest.approx(each.reach, abs=1e-6)
        assert each.y - each.reach >= gap - 1e-6
        assert each.x * 1000.0 == pytest.approx(round(each.x * 1000.0), abs=1e-6)
    assert gap - 1e-6 <= plate[0].x - plate[0].reach <= gap + 2.0 * STEP
    for one, other in pairwise(plate):
        between = other.x - other.reach - (one.x + one.reach)
        assert gap - 1e-6 <= between <= gap + 2.0 * STEP


def test_sizes() -> None:
    """The rollers are those of the followers, as wide as the disc or as the scene says."""
    names = ["roller", "return-roller"]
    main, returning = _plate("conjugate_carriage", {"output.3mf.plate": names})
    assert (main.reach, returning.reach) == (12.0, 10.0)
    assert main.part.thickness == returning.part.thickness == 14.0
    wide, _ = _plate(
        "conjugate_carriage", {"output.3mf.plate": names, "output.3mf.roller_width": 9}
    )
    assert wide.part.thickness == 9.0


def test_all_are_compensated() -> None:
    values = {
        "print.bore_clearance": 0.2,
        "print.shrinkage": {"xy": 1.0},
        "print.elephant_foot": {"inset": 0.2, "height": 0.4},
        "output.3mf.plate": ["roller", "test-ring", "cam"],
        "output.3mf.roller_bore": 6,
    }
    roller, ring, cam = _plate("conjugate_carriage", values)
    assert roller.reach == pytest.approx(12.0 / 0.99, abs=1e-6)
    bores = [each.part.layers[-1].boundaries[-1].nearest() for each in (roller, ring, cam)]
    assert bores == pytest.approx([3.1 / 0.99, 12.6 / 0.99, 12.6 / 0.99])
    feet = [each.part.layers[0].boundaries[-1].nearest() for each in (roller, ring, cam)]
    assert feet == pytest.approx([each + 0.2 for each in bores])


def test_a_pair_in_one_piece() -> None:
    """It is the cam; its rollers are as wide as it states."""
    values = {"part.pair": {"gap": 8, "spacer": 40, "roller_width": 11}}
    design = camgeo.load(SCENES / "conjugate_carriage.toml")
    kinds = ["cam", "return-roller", "test-ring"]
    scene = design.scene.with_values({**values, "output.3mf.plate": kinds})
    pair = known(camgeo.Design(scene).disc.pair)
    cam, roller, ring = plate_of(pair)
    assert cam.part is pair.drawn.printed.target
    assert cam.part.thickness == 14.0 + 8.0 + 14.0
    assert roller.part.thickness == 11.0
    assert ring.part.layers[0].boundaries[1].nearest() == 12.5


def test_a_disc_without_another() -> None:
    disc = camgeo.load(SCENES / "conjugate_carriage.toml")
    scene = disc.scene.with_values({"output.3mf.plate": ["return-cam"]})
    alone = camgeo.Design(scene).discs[1]
    with refused("output.3mf.plate", "no return disc of its own"):
        plate_of(alone)
