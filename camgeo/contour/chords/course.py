"""How hard each place of a stretch is for straight pieces: what shares it out among them.

A chord with the curve on both sides of it, up to eps on each, spans sqrt(16 eps/|kappa|). So the
integral of sqrt(|kappa|/(16 eps)) ds counts the chords needed, and equal shares of it are chords of
equal deviation; an inflection takes part in it with the chord that runs through it.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from camgeo.contour.chords.interpolation import monotone
from camgeo.curve.working_curve import WorkingCurve
from camgeo.mechanism.follower import bend_of_path
from camgeo.numeric.arrays import FloatArray, ascending
from camgeo.units import TURN

CELLS = 512
"""Cells of the table in each smooth piece; they only place knots, what comes of it is measured."""

NEAR = 64
"""Cells on each side of an inflection, over two of the others: the chord through it may be short,
and beside it the density is a square root."""

STRAIGHT = 1e-9
"""Curvatures of a smaller share of the largest, by the turn of a cell, are none: no inflection is
looked for in their signs."""

FLOOR = 1e-3
"""Chords that are spread evenly, as a share of all: no stretch goes without, however straight."""


@dataclass(frozen=True, slots=True, eq=False)
class Course:
    """The table of a stretch.

    Attributes
    ----------
    grid : (n + 1,) cam angles [rad], ascending.
    bends : (n,) [sqrt(mm)] integral of sqrt(|kappa|) ds over each cell, kappa of the parallel.
    turns : (n,) [rad] angle by which the curve turns in each cell, positive.
    steps : (n,) [mm] length of each cell.
    inflections : (k,) indices of the points of `grid` where the curvature changes its sign.
    sides : (k + 1,) sign of the curvature before, between and after the inflections.
    """

    grid: FloatArray
    bends: FloatArray
    turns: FloatArray
    steps: FloatArray
    inflections: tuple[int, ...]
    sides: FloatArray

    def shares(self, tolerance: float, most_turn: float) -> FloatArray:
        """(n + 1,) chords needed up to each point of the grid, none turning by over `most_turn`."""
        cells = np.maximum(self.bends / (4.0 * np.sqrt(tolerance)), self.turns / most_turn)
        even = self.steps / np.sum(self.steps)
        cells += even * (FLOOR * np.sum(cells) + 1e-9)
        return np.concatenate(([0.0], np.cumsum(cells)))

    def sagittas(
        self, tolerance: float, most_turn: float, shares: FloatArray, at: FloatArray
    ) -> FloatArray:
        """Deviation [mm] of chords that are one share long each, where `shares` reach `at` (m,).

        It is `tolerance` unless they are shorter so as not to turn by over `most_turn`.
        """
        cell = np.clip(np.searchsorted(shares, at) - 1, 0, len(self.bends) - 1)
        bend, turn = self.bends[cell], self.turns[cell]
        longest = most_turn * bend / np.where(turn > 0.0, 4.0 * np.sqrt(tolerance) * turn, 1.0)
        return tolerance * np.where(turn > 0.0, np.minimum(longest, 1.0), 1.0) ** 2

    def angles(self, shares: FloatArray, at: FloatArray) -> FloatArray:
        """Cam angles [rad] at which the `shares` reach the values `at`."""
        return monotone(shares, self.grid, at)


def course(curve: WorkingCurve, start: float, end: float) -> Course:
    """The table of `curve` from cam angle `start` to `end` [rad]."""
    breaks = np.concatenate((curve.breaks - TURN, curve.breaks, curve.breaks + TURN))
    inner = breaks[(breaks > start) & (breaks < end)]
    cuts = ascending(np.concatenate(([start], inner, [end])))
    parts = np.arange(CELLS) / CELLS
    grid = (cuts[:-1, None] + np.diff(cuts)[:, None] * parts).ravel()
    grid = np.append(grid, end)
    crossings = _sign_changes(curve, grid)
    if len(crossings):
        width = 2.0 * (end - start) / len(grid)
        near = crossings[:, None] + width * np.linspace(-1.0, 1.0, 2 * NEAR + 1)
        near = near[(near > start) & (near < end)]
        grid = ascending(np.concatenate((grid, near, crossings)))
    kappa, bends, turns, steps = _cells(curve, grid)
    places = np.searchsorted(grid, crossings)
    edges = [0, *(int(place) for place in places), len(kappa)]
    sides = [float(np.sign(np.sum(turns[a:b] * np.sign(kappa[a:b])))) for a, b in pairwise(edges)]
    return Course(grid, bends, turns, steps, tuple(edges[1:-1]), np.array(sides))


def _cells(
    curve: WorkingCurve, grid: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Curvature of the pitch curve in the middle of each cell, and the cell's bends, turns, steps.

    sqrt(|kappa_d|) ds = sqrt(|kappa| (1 + d kappa)) |Z'| dphi is finite at a cusp too.
    """
    middle, width = 0.5 * (grid[:-1] + grid[1:]), np.diff(grid)
    relative = curve.pitch.relative_jet(middle, order=2)
    speed = curve.pitch.speed(relative)
    kappa = bend_of_path(relative, speed, curve.pitch.rotation)
    regular = np.maximum(1.0 + curve.distance * kappa, 0.0)
    way = speed * width
    return kappa, way * np.sqrt(np.abs(kappa) * regular), way * np.abs(kappa), way * regular


def _sign_changes(curve: WorkingCurve, grid: FloatArray) -> FloatArray:
    """(k,) cam angles [rad] where the curvature changes its sign; straight parts have none."""
    kappa, _, turns, _ = _cells(curve, grid)
    bent = np.flatnonzero(turns > STRAIGHT * np.max(turns))
    if len(bent) < 2:
        return np.empty(0)
    change = np.flatnonzero(np.sign(kappa[bent[:-1]]) != np.sign(kappa[bent[1:]]))
    if not len(change):
        return np.empty(0)
    middle = 0.5 * (grid[:-1] + grid[1:])
    low, high = middle[bent[change]], middle[bent[change + 1]]
    sign = np.sign(kappa[bent[change]])
    for _ in range(40):
        half = 0.5 * (low + high)
        same = np.sign(curve.pitch.curvature(half)) == sign
        low, high = np.where(same, half, low), np.where(same, high, half)
    return ascending(0.5 * (low + high))
