"""All conditions on a place of the cam axis, at a set of cam angles."""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np

from camgeo.check.sizing.task import Task, Terms
from camgeo.curve.pieces import smooth_pieces
from camgeo.numeric.arrays import BoolArray, ComplexArray, FloatArray

SAMPLES = 17
"""Cam angles per piece to start with; the exchange adds those that matter."""

BLOCK = 4_000_000
"""Most values computed at once."""


@dataclass(frozen=True, slots=True, eq=False)
class Conditions:
    """All conditions at a set of cam angles; `ratio` is the largest r_R/r_K."""

    terms: Terms
    tangent: float
    roller: float
    ratio: float
    signs: tuple[float, ...]

    def met(self, places: ComplexArray) -> BoolArray:
        """(k,) whether the places (k,) meet all of them."""
        parts = np.array_split(places, 1 + len(places) * len(self.terms.q) // BLOCK)
        return np.concatenate([self._met(part) for part in parts])

    def _met(self, places: ComplexArray) -> BoolArray:
        u, v = self.terms.across_and_along(places[:, np.newaxis])
        met = np.asarray(np.all(u >= self.tangent * np.abs(v), axis=1) & np.all(u > 0.0, axis=1))
        if np.any(met):
            met[met] = self.worst_ratio(places[met]) <= self.ratio
        return met

    def worst_ratio(self, places: ComplexArray) -> FloatArray:
        """(k,) largest r_R/r_K for the sign that matters; Z' must not vanish."""
        kappa = self.terms.curvature(places[:, np.newaxis])
        worst = [np.max(sign * kappa, axis=1) for sign in self.signs]
        return np.asarray(self.roller * np.max(worst, axis=0))


def samples_of(task: Task) -> FloatArray:
    """(n,) cam angles [rad] inside all pieces, including their ends up to rounding."""
    share = np.linspace(0.0, 1.0, SAMPLES)
    share[0], share[-1] = 1e-9, 1.0 - 1e-9
    found = [
        piece.start + (piece.end - piece.start) * (share[:1] if piece.dwell else share)
        for piece in smooth_pieces(task.motion)
    ]
    return np.concatenate(found)


def conditions(task: Task, tangent: float, ratio: float, phi: FloatArray) -> Conditions:
    """The conditions at the cam angles `phi` (n,) [rad], and on both sides of each break."""
    breaks = task.motion.breaks
    right = task.terms(np.concatenate((phi, breaks)))
    left = task.terms(breaks, "left")
    terms = Terms(
        *(
            np.concatenate((getattr(right, each.name), getattr(left, each.name)))
            for each in fields(Terms)
        )
    )
    return Conditions(terms, tangent, task.follower.roller_radius, ratio, task.signs)
