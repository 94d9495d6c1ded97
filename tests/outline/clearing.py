"""Distances from the pitch curve by sampling and narrowing, and dense points of paths."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from camgeo.geometry.outline.path import Path, Pivot, Stretch
from camgeo.geometry.pitch_curve import PitchCurve
from camgeo.numeric.arrays import ComplexArray, FloatArray
from camgeo.units import TURN

FORMULA = 65
"""Samples of each formula of the motion."""

ROUNDS = 12
"""Of narrowing by sixteen: from a hundredth of a turn to a cam angle.s rounding."""


def distances(pitch: PitchCurve, points: ComplexArray) -> FloatArray:
    """(n,) smallest distance of each point from the whole pitch curve."""
    marks = np.concatenate((pitch.borders, [TURN]))
    grid = np.concatenate([np.linspace(a, b, FORMULA) for a, b in pairwise(marks)])
    grid = np.unique(np.concatenate((grid, np.linspace(0.0, TURN, 721))))
    away = np.abs(pitch.point(grid[:-1])[:, None] - points)
    before, after = np.roll(away, 1, axis=0), np.roll(away, -1, axis=0)
    place, which = np.nonzero((away <= before) & (away <= after))
    steps = np.diff(grid)
    # Two steps either way: of two samples that differ by rounding either may be the nearer one.
    low = grid[place] - steps[place - 1] - steps[place - 2]
    high = grid[place] + steps[place] + steps[(place + 1) % len(steps)]
    for _ in range(ROUNDS):
        part = low[:, None] + (high - low)[:, None] * np.linspace(0.0, 1.0, 33)
        found = np.abs(pitch.point(part.ravel()).reshape(part.shape) - points[which][:, None])
        best = np.argmin(found, axis=1)
        rows = np.arange(len(best))
        low, high = part[rows, np.maximum(best - 1, 0)], part[rows, np.minimum(best + 1, 32)]
    nearest = np.full(len(points), np.inf)
    np.minimum.at(nearest, which, found[rows, best])
    return nearest


def dense(path: Path, count: int) -> ComplexArray:
    """Points of a path, `count` for each smooth part of it, its ends left out."""
    shares = (np.arange(count) + 0.5) / count
    parts = []
    for each in path.elements:
        if isinstance(each, Stretch):
            borders = np.concatenate((each.curve.borders, each.curve.borders + TURN))
            inside = borders[(borders > each.start) & (borders < each.end)]
            marks = np.concatenate(([each.start], inside, [each.end]))
            phi = (marks[:-1, None] + np.diff(marks)[:, None] * shares).ravel()
            parts.append(each.curve.point(phi))
        else:
            turned = np.exp(1j * each.sweep * shares)
            parts.append(each.centre + each.distance * each.normal * turned)
    return np.concatenate(parts)


def corners(path: Path) -> list[Pivot]:
    """The corners of a path."""
    return [pivot for pivot in path.pivots if pivot.distance == 0.0]
