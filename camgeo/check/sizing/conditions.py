"""All conditions on a place of the cam axis, at a set of cam angles."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from camgeo.check.sizing.covering import Covers
from camgeo.check.sizing.task import Task, Terms
from camgeo.curve.pieces import smooth_pieces
from camgeo.numeric.arrays import BoolArray, ComplexArray, FloatArray, joined

SAMPLES = 17
"""Cam angles per piece to start with; the exchange adds those that matter."""

BLOCK = 4_000_000
"""Most values computed at once."""


@dataclass(frozen=True, slots=True, eq=False)
class Conditions:
    """All conditions at a set of cam angles.

    Attributes
    ----------
    terms : at these cam angles.
    tangent : of the transmission angle.
    roller : r_R [mm].
    ratio : the largest r_R/r_K.
    signs : of the curvatures that count.
    half : see `Task.half`.
    covers : pairs of cam angles; None if global undercut is left out.
    """

    terms: Terms
    tangent: float
    roller: float
    ratio: float
    signs: tuple[float, ...]
    half: float = 0.0
    covers: Covers | None = None

    @property
    def count(self) -> int:
        """The number of conditions on a place."""
        return len(self.terms.q) + (0 if self.covers is None else len(self.covers.first))

    def met(self, places: ComplexArray) -> BoolArray:
        """(k,) whether the places (k,) meet all of them."""
        parts = np.array_split(places, 1 + len(places) * self.count // BLOCK)
        return np.concatenate([self._met(part) for part in parts])

    def _met(self, places: ComplexArray) -> BoolArray:
        u, v = self.terms.across_and_along(places[:, np.newaxis])
        met = np.asarray(np.all(u >= self.tangent * np.abs(v), axis=1) & np.all(u > 0.0, axis=1))
        if np.any(met) and self.half > 0.0:
            apart = self.terms.to_axis(places[met][:, np.newaxis])
            met[met] = np.all(apart > self.half, axis=1)
        if np.any(met):
            met[met] = self.worst_ratio(places[met]) <= self.ratio
        if np.any(met) and self.covers is not None:
            met[met] = self.covers.met(places[met])
        return met

    def room(self, places: ComplexArray) -> FloatArray:
        """(k,) margin of the tightest condition at the places (k,), as a fraction of its limit or
        as an angle [rad]; negative where one is broken.
        """
        u, v = self.terms.across_and_along(places[:, np.newaxis])
        with np.errstate(divide="ignore", invalid="ignore"):
            kept = (u - self.tangent * np.abs(v)) / np.hypot(u, v)
            left = [np.min(kept, axis=1) / math.hypot(1.0, self.tangent)]
            left.append(1.0 - self.worst_ratio(places) / self.ratio)
        if self.half > 0.0:
            apart = self.terms.to_axis(places[:, np.newaxis])
            left.append(np.min(apart, axis=1) / self.half - 1.0)
        if self.covers is not None and len(self.covers.first):
            gap = self.covers.gap(places)[0] / np.abs(self.covers.distance)
            left.append(np.min(gap, axis=1))
        return np.asarray(np.nan_to_num(np.min(left, axis=0), nan=-np.inf))

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


def with_more(task: Task, now: Conditions, phi: FloatArray, covers: Covers) -> Conditions:
    """`now` and the conditions at the cam angles `phi` (n,) [rad] and of the pairs `covers`."""
    more = conditions(task, now.tangent, now.ratio, phi, covers).terms
    terms = joined((now.terms, more))
    return replace(now, terms=terms, covers=covers if now.covers is None else now.covers + covers)


def conditions(
    task: Task, tangent: float, ratio: float, phi: FloatArray, covers: Covers | None = None
) -> Conditions:
    """The conditions at the cam angles `phi` (n,) [rad] and on both sides of each break, and those
    of the pairs `covers`.
    """
    breaks = task.motion.breaks
    right = task.terms(np.concatenate((phi, breaks)))
    terms = joined((right, task.terms(breaks, "left")))
    roller, half = task.follower.roller_radius, task.half
    return Conditions(terms, tangent, roller, ratio, task.signs, half, covers)
