"""`[output.3mf]`: what may lie on a plate."""

from __future__ import annotations

from typing import Any

import pytest

import camgeo
from camgeo.errors import SceneError
from camgeo.scene.formats.threemf import BODIES, FORMAT, ThreeMfSpec, parse
from tests.contour.cams import SCENES
from tests.part.parts import refused

PLATE: dict[str, Any] = {"output.3mf.plate": ["cam", "roller", "test-ring"], "part.bore": 20}


def test_defaults_and_a_whole_table() -> None:
    assert parse({}) == ThreeMfSpec((), 5.0, None, None)
    found = parse({"plate": ("cam", "roller"), "gap": 2.0, "roller_bore": 6.0})
    assert found == ThreeMfSpec(("cam", "roller"), 2.0, None, 6.0)


@pytest.mark.parametrize(
    ("table", "key"),
    [
        ({"plate": ("cam", "cam")}, "plate"),
        ({"plate": ("gear",)}, "plate"),
        ({"gap": 0.0}, "gap"),
        ({"roller_width": -1.0}, "roller_width"),
    ],
)
def test_doors(table: dict[str, Any], key: str) -> None:
    with refused(f"output.3mf.{key}"):
        parse(table)


def test_a_scene_with_a_plate() -> None:
    scene = camgeo.load(SCENES / "plate_translating.toml").scene
    found = scene.with_values({**PLATE, "output.3mf.gap": 3}).output.options[FORMAT]
    assert found == ThreeMfSpec(("cam", "roller", "test-ring"), 3.0)
    assert scene.output.options[FORMAT] == ThreeMfSpec()
    assert scene.with_values(PLATE).made != scene.with_values({"part.bore": 20}).made


@pytest.mark.parametrize(
    ("name", "values", "key", "message"),
    [
        ("plate_translating", {"plate": ["gear"]}, "plate[1]", "must be one of"),
        ("plate_translating", {"plate": []}, "plate", "must be a list, each named once"),
        ("plate_translating", {"plate": ["return-cam"]}, "plate", "needs .follower.return. for"),
        (
            "conjugate_carriage",
            {"plate": ["return-cam"]},
            "plate",
            r"has no .return-cam.: it is one piece with .cam.",
        ),
        ("tappet", {"plate": ["roller"]}, "plate", "has no roller"),
        ("knife_edge", {"plate": ["roller"]}, "plate", "is a knife edge"),
        ("plate_translating", {"gap": 2}, "gap", "needs plate"),
        (
            "plate_translating",
            {"plate": ["cam"], "roller_bore": 3},
            "roller_bore",
            "needs a roller",
        ),
        (
            "plate_translating",
            {"plate": ["roller"], "roller_bore": 20},
            "roller_bore",
            "must be less than the diameter of the roller, 20",
        ),
    ],
)
def test_refusals(name: str, values: dict[str, Any], key: str, message: str) -> None:
    scene = camgeo.load(SCENES / f"{name}.toml").scene
    if name == "conjugate_carriage":
        scene = scene.with_values({"part.pair": {"gap": 8, "spacer": 40}})
    with pytest.raises(SceneError, match=message) as caught:
        scene.with_values({f"output.3mf.{each}": value for each, value in values.items()})
    assert [fault.key for fault in caught.value.faults] == [f"output.3mf.{key}"]


def test_a_ring_needs_a_bore() -> None:
    scene = camgeo.load(SCENES / "plate_translating.toml").scene
    values = {"part.bore": None, "part.keyway": None, "output.3mf.plate": ["test-ring"]}
    with pytest.raises(SceneError, match=r"needs .part. bore for"):
        scene.with_values(values)


def test_all_bodies_are_described() -> None:
    items = FORMAT.schema["properties"]["plate"]
    assert tuple(items["items"]["enum"]) == BODIES
    assert all(f'"{each}"' in items["description"] for each in BODIES)
