"""Cells of places: excluded ones break a condition everywhere, and nothing else decides."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from camgeo.check.sizing.bends import (
    GAP,
    Conditions,
    conditions,
    excluded,
    nearest_cells,
    samples_of,
    within,
)
from camgeo.check.sizing.smallest import size
from camgeo.check.sizing.task import Task
from tests.check.sizing_scenes import BENT, required


def asked(name: str) -> tuple[Task, Conditions, float]:
    """Conditions of a scene at the first cam angles, and the answer's base radius [mm]."""
    task, angle, ratio = required(name)
    answer = size(task, angle, ratio).answer
    assert answer is not None
    return task, conditions(task, math.tan(angle), ratio, samples_of(task)), answer.base_radius


@pytest.mark.parametrize("name", BENT)
def test_what_is_excluded_has_no_place_and_what_is_within_has_all(name: str) -> None:
    task, now, radius = asked(name)
    now = replace(now, tangent=0.0)  # the curvature decides most
    rng = np.random.default_rng(8)
    count = 1000
    middle = task.start + radius * rng.uniform(0.1, 1.4, count) * np.exp(
        1j * rng.uniform(-math.pi, 0.0, count)
    )
    half = np.abs(middle - task.start) * rng.uniform(0.02, 0.5, count)
    out = excluded(now, middle, half)
    assert 0.1 < np.mean(out) < 1.0
    for place, reach, gone in zip(middle, half, out, strict=True):
        inside = place + reach * rng.uniform(0.0, 1.0, 60) ** 0.1 * np.exp(
            1j * rng.uniform(0.0, 2.0 * math.pi, 60)
        )
        met = now.met(inside)
        assert not (gone and np.any(met))
        # Fewer cam angles, the same verdict on every place of the neighbourhood.
        assert np.array_equal(within(now, np.array([place]), float(reach)).met(inside), met)


@pytest.mark.parametrize("name", BENT)
def test_the_bound_is_sharp(name: str) -> None:
    """No place is nearer than the bound, and the answer, for more angles, is not much farther."""
    task, now, radius = asked(name)
    least = 0.2 * radius
    found = nearest_cells(now, task.start, least, 10.0 * radius)
    assert found.starts
    assert found.bound <= radius
    assert found.bound == pytest.approx(min(start[1] for start in found.starts), rel=5.0 * GAP)
    theta = np.linspace(-math.pi, 0.0, 720)
    for share in (0.5, 0.9, 0.99, 0.9999):
        assert not np.any(now.met(task.start + share * found.bound * np.exp(1j * theta)))


def test_where_there_is_none_all_are_excluded() -> None:
    task, now, radius = asked("schnitt")
    found = nearest_cells(now, task.start, 0.3 * radius, 0.9 * radius)
    assert found.starts == ()
    assert found.bound == math.inf
