"""How near polygons come: the verdict of shapely."""

from __future__ import annotations

import math

import numpy as np
import shapely
from hypothesis import given
from hypothesis import strategies as st

from camgeo.numeric.arrays import ComplexArray
from camgeo_export.solid.prism import of_polygons


def circle(radius: float, count: int) -> ComplexArray:
    return np.asarray(radius * np.exp(2j * math.pi * np.arange(count) / count))


def line(ring: ComplexArray) -> shapely.LinearRing:
    return shapely.LinearRing(np.column_stack((ring.real, ring.imag)))


@given(st.floats(4.5, 5.5), st.integers(3, 40), st.integers(3, 40), st.floats(1e-3, 2.0))
def test_nearest_is_the_distance_if_within_the_tolerance(
    radius: float, one: int, other: int, tolerance: float
) -> None:
    rings = {"one": circle(5.0, one), "other": 0.3 + circle(radius, other)}
    found = of_polygons(rings, tolerance)("one", "other")
    distance = shapely.distance(line(rings["one"]), line(rings["other"]))
    if distance > tolerance:
        assert found is None
    else:
        assert found is not None
        assert found[0] == distance
        # The place is on the one of both, within the rounding of 5 mm.
        assert line(rings["one"]).distance(shapely.Point(found[1].real, found[1].imag)) < 1e-14
