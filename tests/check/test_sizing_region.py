"""The region in which the cam axis may lie: against brute force, and Flocke's inside it."""

from __future__ import annotations

import math

import numpy as np
import pytest

from camgeo.check.flank import transmission_angle_extremes
from camgeo.check.sizing.smallest import (
    flocke,
    flocke_limits,
    nearest_point,
    ratio_map,
    row_limits,
    size,
)
from camgeo.check.sizing.task import Task
from camgeo.geometry.pieces import curvature_extremes
from camgeo.numeric.arrays import BoolArray, FloatArray
from tests.check.sizing_scenes import BENT, EASY, required


def _brute_map(
    task: Task, tangent: float, columns: FloatArray, rows: FloatArray, angles: int
) -> BoolArray:
    """(rows, columns) whether mu >= atan(`tangent`) at so many cam angles with P there."""
    terms = task.terms(np.linspace(0.0, 2.0 * np.pi, angles, endpoint=False))
    out = np.empty((len(rows), len(columns)), dtype=np.bool_)
    for number, row in enumerate(rows):
        u, v = terms.across_and_along((columns + 1j * row)[:, np.newaxis])
        out[number] = np.all((u > 0.0) & (u >= tangent * np.abs(v)), axis=1)
    return out


@pytest.mark.parametrize("name", ["plate_translating", "setzhub", "schnitt"])
def test_the_map_is_that_of_brute_force(name: str) -> None:
    task, angle, _ = required(name)
    tangent = math.tan(angle)
    found = size(task, angle, 1.0)
    assert found.for_angle is not None
    place, radius = found.for_angle.place, found.for_angle.base_radius
    columns = place.real + radius * np.linspace(-2.0, 2.0, 200)
    rows = place.imag + radius * np.linspace(-3.0, 1.5, 200)
    low, high = row_limits(task, tangent, rows)
    exact = (columns >= low[:, np.newaxis]) & (columns <= high[:, np.newaxis])
    brute = _brute_map(task, tangent, columns, rows, 1440)
    assert 0.1 < np.mean(exact) < 0.9
    # Brute force misses what lies between its angles, so it can only be too generous.
    assert not np.any(exact & ~brute)
    for row, column in zip(*np.nonzero(exact != brute), strict=True):
        curve = task.pitch_curve_at(complex(columns[column], rows[row]))
        smallest = transmission_angle_extremes(curve).smallest()[0]
        assert angle - 1e-4 < smallest < angle
    assert np.sum(exact != brute) < 10


def test_row_ends_are_at_the_limit() -> None:
    for name in ("plate_translating", "setzhub"):
        task, angle, _ = required(name)
        tangent = math.tan(angle)
        place = task.present
        rows = place.imag * np.array([1.0, 1.3, 1.9])
        low, high = row_limits(task, tangent, rows)
        assert np.all(low < high)
        for ends in (low, high):
            for x, y in zip(ends, rows, strict=True):
                curve = task.pitch_curve_at(complex(x, y))
                smallest = transmission_angle_extremes(curve).smallest()[0]
                assert smallest == pytest.approx(angle, abs=1e-9)


@pytest.mark.parametrize("name", [*EASY, *BENT])
def test_flockes_region_lies_in_the_exact_one(name: str) -> None:
    task, angle, _ = required(name)
    tangent = math.tan(angle)
    rows = task.present.imag * np.linspace(0.3, 3.0, 40)
    low, high = row_limits(task, tangent, rows)
    inner_low, inner_high = flocke_limits(flocke(task, tangent), rows)
    met = inner_low <= inner_high
    assert np.any(met)
    assert np.all(low[met] <= inner_low[met] + 1e-9)
    assert np.all(high[met] >= inner_high[met] - 1e-9)


def test_ratio_map_is_that_of_the_curvature() -> None:
    task, _, _ = required("schnitt")
    place = task.present
    ((value,),) = ratio_map(task, np.array([place.real]), np.array([place.imag]), 3.0)
    exact = curvature_extremes(task.pitch_curve_at(place)).largest()[0]
    assert value == pytest.approx(task.follower.roller_radius * exact, rel=1e-2)


def test_nearest_point_of_half_planes() -> None:
    one = np.array([1.0 + 0j, 1j])
    assert nearest_point(one, np.array([2.0, 3.0]), 0j) == pytest.approx(2.0 + 3.0j)
    assert nearest_point(one, np.array([2.0, -1.0]), 0j) == pytest.approx(2.0)
    assert nearest_point(one, np.array([-2.0, -1.0]), 0j) == 0j
    assert nearest_point(np.array([1.0 + 0j, -1.0 + 0j]), np.array([1.0, 0.0]), 0j) is None
