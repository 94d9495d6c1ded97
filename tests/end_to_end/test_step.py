"""STEP of each fixture scene: one solid, measured against the exact cam."""

from __future__ import annotations

import numpy as np
import pytest

from camgeo.geometry.contour.contour import Contour
from camgeo.units import MM_PER
from camgeo_export.part21 import Solid
from camgeo_export.verify.step import level_bounds, volume_by_levels
from tests.end_to_end.built import Built


def test_volume_areas_and_centroids_are_those_of_the_cam(built: Built) -> None:
    """Of all loops of all flat faces; the volume is stated for the arcs of the file."""
    solid = Solid.from_bytes(built.file(".step").read_bytes())
    assert solid.unit == MM_PER[built.design.scene.unit]
    bounds = level_bounds(solid)
    volume = volume_by_levels(bounds, ())
    assert volume == pytest.approx(built.record(".step")["volume_mm3"], rel=1e-12)
    assert volume == pytest.approx(built.volume, abs=built.tolerance * built.length * built.height)
    for _, contour in bounds:
        assert isinstance(contour, Contour)
        centroid = contour.moments.first / contour.moments.area
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
