"""The smallest base circle where the roller against r_K decides too: no convex problem.

Seen from the roller centre at cam angle 0 the cam axis lies in a direction theta in (-pi, 0). Along
each direction the nearest place is looked for that meets all conditions at a set of cam angles, and
the direction with the smallest of them is enclosed. Then the cam angles at which the found place is
extreme join the set, until it meets the conditions at all of them.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, fields

import numpy as np

from camgeo.check.sizing.task import Task, Terms
from camgeo.curve.curvature import curvature_extremes
from camgeo.curve.pieces import smooth_pieces
from camgeo.errors import GeometryError
from camgeo.numeric.arrays import BoolArray, ComplexArray, FloatArray

SAMPLES = 17
"""Cam angles per piece to begin with; the exchange adds those that matter."""

DIRECTIONS, RADII = 121, 161
"""Of the grid on which the neighbourhood of the smallest circle is found. A range of places
narrower than its cells may be passed over: 1.5 degrees by 2 per cent."""

CELL = 1.5 * np.pi / DIRECTIONS
NEAR, MOST_RUNS = 1, 3
"""Directions that reach within a cell of the nearest belong to a run; these many are followed."""

Start = tuple[float, float, float]
"""Direction, base radius, and half the width of directions to look in."""

REACH = 40.0
"""The largest base radius that is looked at, in times of that for the transmission angle."""

ZOOM, STEPS = 8.0, 15
"""Each step encloses the direction eight times closer."""

HALVINGS = 54
ROUNDS = 12
CLOSE = 1e-12
"""Conditions broken by this share of what they are made of are met."""

BLOCK = 4_000_000
"""Values at a time."""


@dataclass(frozen=True, slots=True, eq=False)
class Conditions:
    """All conditions at a set of cam angles; `ratio` is the largest r_R/r_K."""

    terms: Terms
    tangent: float
    roller: float
    ratio: float
    signs: tuple[float, ...]

    def met(self, places: ComplexArray) -> BoolArray:
        """(k,) whether the places (k,) keep all of them."""
        block = max(1, BLOCK // max(len(self.terms.q), 1))
        parts = [self._met(places[i : i + block]) for i in range(0, len(places), block)]
        return np.concatenate(parts) if parts else np.empty(0, dtype=np.bool_)

    def _met(self, places: ComplexArray) -> BoolArray:
        u, v = self.terms.across_and_along(places[:, np.newaxis])
        met = np.asarray(np.all(u >= self.tangent * np.abs(v), axis=1) & np.all(u > 0.0, axis=1))
        if np.any(met):
            met[met] = self.worst_ratio(places[met]) <= self.ratio
        return met

    def worst_ratio(self, places: ComplexArray) -> FloatArray:
        """(k,) largest r_R/r_K of the sign that matters; Z' must not vanish."""
        kappa = self.terms.curvature(places[:, np.newaxis])
        worst = [np.max(sign * kappa, axis=1) for sign in self.signs]
        return np.asarray(self.roller * np.max(worst, axis=0))


def signs_of(task: Task) -> tuple[float, ...]:
    """Signs of the curvature that matter: +1 convex for an inner flank, -1 concave for an outer."""
    return {"inner": (1.0,), "outer": (-1.0,), "groove": (1.0, -1.0)}[task.contact]


def worst_ratio(task: Task, place: complex) -> tuple[float, float]:
    """Largest r_R/r_K of the sign that matters, at least 0, and its cam angle [rad].

    Raises GeometryError if the roller centre stands still in the cam.
    """
    bends = curvature_extremes(task.pitch_curve_at(place))
    found = [(sign, bends.largest() if sign > 0.0 else bends.smallest()) for sign in signs_of(task)]
    sign, (kappa, phi) = max(found, key=lambda each: each[0] * each[1][0])
    return max(task.follower.roller_radius * sign * kappa, 0.0), phi


def samples_of(task: Task) -> FloatArray:
    """(n,) cam angles [rad] inside all pieces, the ends of each among them but for rounding."""
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
    return Conditions(terms, tangent, task.follower.roller_radius, ratio, signs_of(task))


def smallest_with_bends(
    task: Task, tangent: float, ratio: float, least: float
) -> tuple[complex | None, float]:
    """Place [mm] of the smallest base circle for mu and r_R/r_K, and the least ratio seen.

    Parameters
    ----------
    tangent : T of the transmission angle.
    ratio : largest r_R/r_K.
    least : base radius [mm] below which there is no place, that for the transmission angle alone.

    Returns
    -------
    None if the grid shows no such place; the second value is then the smallest r_R/r_K of the
    places of the grid that keep the transmission angle (infinite if there are none).
    """
    phi = samples_of(task)
    starts: tuple[Start, ...] = ()
    for _ in range(ROUNDS):
        now = conditions(task, tangent, ratio, phi)
        fresh = _coarse(task, now, least)
        if not fresh and not starts:
            return None, _least_ratio(task, now, least)
        reached = [_enclosed(task, now, start, least) for start in (*starts, *fresh)]
        theta, radius = min(reached, key=lambda each: each[1])
        if not np.isfinite(radius):
            starts = ()
            continue
        place = complex(task.start + radius * np.exp(1j * theta))
        extreme, broken = _extreme_angles(task, place, tangent, ratio)
        if not broken:
            return place, 0.0
        starts = ((theta, radius, CELL),)
        phi = np.unique(np.concatenate((phi, extreme)))
    raise GeometryError("the smallest base circle could not be enclosed: the search did not settle")


def _extreme_angles(
    task: Task, place: complex, tangent: float, ratio: float
) -> tuple[FloatArray, bool]:
    """Cam angles [rad] at which the conditions are extreme, and whether one is broken."""
    angles, broken = [], False
    size = abs(place) + abs(task.start)
    for t in (tangent, -tangent):
        found = task.slack(place, t)
        broken = broken or float(np.min(found.values)) < -CLOSE * size * math.hypot(1.0, t)
        angles.append(found.phi)
    bends = curvature_extremes(task.pitch_curve_at(place))
    angles.append(bends.phi)
    for sign in signs_of(task):
        worst = float(np.max(sign * bends.values)) * task.follower.roller_radius
        broken = broken or worst > ratio * (1.0 + CLOSE)
    return np.concatenate(angles), broken


def _grid(task: Task, least: float) -> tuple[FloatArray, FloatArray, ComplexArray]:
    theta = -np.pi + np.pi * (np.arange(DIRECTIONS) + 0.5) / DIRECTIONS
    radii = np.geomspace(least, REACH * least, RADII)
    places = task.start + radii * np.exp(1j * theta)[:, np.newaxis]
    return theta, radii, places


def _coarse(task: Task, now: Conditions, least: float) -> tuple[Start, ...]:
    """Where on the grid the smallest circles are: runs of directions that reach about as near."""
    theta, radii, places = _grid(task, least)
    met = now.met(places.ravel()).reshape(places.shape)
    first = np.where(np.any(met, axis=1), np.argmax(met, axis=1), len(radii) + NEAR)
    best = int(np.min(first))
    if best >= len(radii):
        return ()
    near = np.flatnonzero(first <= best + NEAR)
    runs = np.split(near, np.flatnonzero(np.diff(near) > 1) + 1)
    runs.sort(key=lambda run: int(np.min(first[run])))
    return tuple(
        (
            float(0.5 * (theta[run[0]] + theta[run[-1]])),
            float(radii[np.min(first[run])]),
            float(0.5 * (theta[run[-1]] - theta[run[0]])) + CELL,
        )
        for run in runs[:MOST_RUNS]
    )


def _least_ratio(task: Task, now: Conditions, least: float) -> float:
    places = _grid(task, least)[2].ravel()
    free = Conditions(now.terms, now.tangent, 0.0, 1.0, now.signs)
    kept = places[free.met(places)]
    return float(np.min(now.worst_ratio(kept))) if len(kept) else math.inf


def _enclosed(task: Task, now: Conditions, start: Start, least: float) -> tuple[float, float]:
    """Direction and base radius of the smallest circle near `start`; infinite if there is none."""
    best, radius, width = start
    for _ in range(STEPS):
        theta = np.clip(best + width * np.linspace(-1.0, 1.0, 33), -np.pi, 0.0)
        reached = _nearest_along(task, now, theta, least, radius)
        index = int(np.argmin(reached))
        if not np.isfinite(reached[index]):
            return best, math.inf
        best, radius = float(theta[index]), float(reached[index])
        width /= ZOOM
    return best, radius


def _nearest_along(
    task: Task, now: Conditions, theta: FloatArray, least: float, about: float
) -> FloatArray:
    """(k,) smallest base radius in each direction near `about` [mm]; infinite if there is none."""
    ways = np.exp(1j * theta)
    scan = np.linspace(max(least, 0.94 * about), 1.03 * about, 46)
    met = now.met((task.start + scan * ways[:, np.newaxis]).ravel()).reshape(len(theta), -1)
    some = np.any(met, axis=1)
    first = np.argmax(met, axis=1)
    good, bad = scan[first], scan[np.maximum(first - 1, 0)]
    for _ in range(HALVINGS):
        middle = 0.5 * (good + bad)
        fine = now.met(task.start + middle * ways)
        good, bad = np.where(fine, middle, good), np.where(fine, bad, middle)
    return np.where(some, good, np.inf)
