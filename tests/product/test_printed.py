"""What is found of a disc that is to be printed: in checks, and of builds what is poor."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import pytest

import camgeo
from camgeo.design.drawn import COMPENSATED
from camgeo.design.judged_part import findings_on, poor_in
from camgeo.errors import GeometryError
from tests.contour.cams import SCENES


def _found(values: dict[str, Any]) -> tuple[Mapping[str, str], Mapping[str, str]]:
    """Names and severities of the findings on printing, in checks and in builds."""
    scene = camgeo.load(SCENES / "plate_translating.toml").scene.with_values(values)
    disc = camgeo.Design(scene).disc
    first, second = (
        {each.name: each.severity for each in found if each.name.startswith("print-")}
        for found in (findings_on(disc), poor_in(disc))
    )
    return first, second


def test_nothing_without_a_nozzle() -> None:
    assert _found({}) == ({}, {})
    assert _found({"print.bore_clearance": 0.2}) == ({}, {})


def test_a_nozzle_is_told_what_it_cannot_make() -> None:
    mark = {"radius": 20, "width": 0.3, "depth": 0.5, "length": 4}
    assert _found({"part.mark": mark, "print.nozzle": 0.4}) == (
        {"print-wall": "ok", "print-radius": "ok", "print-stroke": "warning"},
        {"print-stroke": "warning"},
    )


def test_walls_are_those_beside_the_clearance() -> None:
    """The wall is thinned on its side of the bore by half of the diametral clearance."""
    holes = {"count": 1, "circle": 42, "hole": 19.0, "angle": 200}
    part = {"part.bore": 22, "part.keyway": None, "part.bolt_circle": holes, "print.nozzle": 0.24}
    for clearance, severity in ((None, "ok"), (0.06, "warning")):
        found, _ = _found({**part, "print.bore_clearance": clearance})
        assert found["print-wall"] == severity


@pytest.mark.parametrize(
    "values",
    [
        {"print.bore_clearance": 60},
        {"print.nozzle": 0.4, "print.elephant_foot": {"inset": 50, "height": 1}},
    ],
)
def test_a_compensation_without_room_is_found_by_a_check(values: dict[str, Any]) -> None:
    found, _ = _found(values)
    assert found == {COMPENSATED: "broken"}


def test_why_there_is_no_room_is_said_once() -> None:
    """Of a keyway that the clearance eats, and of a bore that reaches the outline."""
    scene = camgeo.load(SCENES / "hub_and_holes.toml").scene
    for clearance in (6.0, 10.0, 60.0):
        asked = scene.with_values({"print.bore_clearance": clearance})
        with pytest.raises(GeometryError, match="no room for it") as caught:
            _ = camgeo.Design(asked).disc.drawn.printed.fitted
        assert caught.value.key == "print.bore_clearance"
        assert caught.value.message.count("no room for it") == 1
