"""STEP of each fixture scene: one solid, its faces counted, measured against the exact cam."""

from __future__ import annotations

from collections import Counter
from typing import Any

import numpy as np
import pytest

import camgeo
from camgeo.geometry.contour.contour import Contour
from camgeo.scene.formats.dxf import FORMAT as DXF
from camgeo.units import MM_PER
from camgeo_export.part21 import Solid, solid_of
from camgeo_export.step.writer import WRITER
from camgeo_export.verify.step import bounds_of, volume_of
from tests.end_to_end.built import SCENES, Built

READ: dict[str, Solid] = {}


@pytest.fixture
def solid(built: Built) -> Solid:
    """The solid, read once for each scene."""
    if built.design.name not in READ:
        data = built.file(".step").read_bytes()
        READ[built.design.name] = solid_of(data)
    return READ[built.design.name]


def _facts(built: Built) -> dict[str, Any]:
    files = {record["file"]: record for record in built.certificate["files"]}
    found: dict[str, Any] = files[built.file(".step").name]
    return found


def test_each_piece_of_the_drawing_is_a_wall(built: Built, solid: Solid) -> None:
    """And the flat faces are one at each height, but for what a groove leaves."""
    walls = [face for face in solid.faces if not face.is_level]
    assert len(solid.faces) == _facts(built)["faces"]
    # What a groove leaves inside has an upper face of its own.
    grooved = built.design.cam.contact == "groove"
    assert len(solid.faces) - len(walls) == len(built.heights) + grooved
    if built.design.disc.options[DXF].entity == "arcs":
        drawn: Any = built.drawing.modelspace().query('LWPOLYLINE[layer!="PITCH_CURVE"]')
        assert len(walls) == sum(len(polyline) for polyline in drawn)
    names = {face.name for face in walls}
    assert names == {each.name for each in built.design.disc.drawn.part.boundaries}


def test_its_volume_is_that_of_its_arcs(built: Built, solid: Solid) -> None:
    found = volume_of(bounds_of(solid), ())
    assert found == pytest.approx(_facts(built)["volume_mm3"], rel=1e-12)
    assert found == pytest.approx(built.volume, abs=built.tolerance * built.length * built.height)
    assert solid.unit == MM_PER[built.design.scene.unit]


def test_areas_and_centroids_are_those_of_the_cam(built: Built, solid: Solid) -> None:
    """Of all loops of all flat faces."""
    for _, contour in bounds_of(solid):
        assert isinstance(contour, Contour)
        moments = contour.moments
        centroid = moments.first / moments.area
        exact = min(
            built.boundaries,
            key=lambda each: (
                abs(each.area - abs(contour.area)) / each.length + abs(each.centroid - centroid)
            ),
        )
        slack = built.tolerance * exact.length
        assert abs(contour.area) == pytest.approx(exact.area, abs=slack)
        off = abs(centroid - exact.centroid)
        assert off <= slack * float(np.max(np.abs(exact.points))) / exact.area


def test_all_features_of_a_part_are_faces_of_one_solid() -> None:
    """Hubs on both sides, holes, a D-shaft and a mark that is sunk in the upper face."""
    base = camgeo.load(next(path for path in SCENES if path.stem == "four_bar"))
    features = {
        "part.hub": {"diameter": 40, "height": 9, "side": "both"},
        "part.d_shaft": {"across": 20},
        "part.mark": {"radius": 36, "width": 3, "length": 8, "depth": 1.0, "angle": 200},
        "part.lightening_holes": {"count": 5, "circle": 70, "hole": 12, "angle": 10},
    }
    product = camgeo.Design(base.scene.with_values(features)).disc
    written = WRITER.write(product, 0.01)
    assert WRITER.measure(product, written.data) <= 0.01
    solid = solid_of(written.data)
    walls = Counter(face.name for face in solid.faces if not face.is_level)
    assert {name: walls[name] for name in walls if name != "outline"} == {
        "bore": 3, "lower hub": 2, "hub": 2, "mark": 4,
        **{f"lightening hole {k}": 2 for k in range(1, 6)},
    }  # fmt: skip
    flat = Counter(face.name for face in solid.faces if face.is_level)
    levels = [level.name for level in product.drawn.part.levels]
    assert flat == Counter(levels)
    assert len(levels) == 5
    assert volume_of(bounds_of(solid), ()) == pytest.approx(written.facts["volume_mm3"], rel=1e-12)
