"""Where the smallest base circle may be: cells that certainly break a condition are excluded.

A cell is a patch of directions and distances seen from the roller centre at cam angle 0. Between
its middle and any of its places (u, v) changes by at most half the diagonal, h, so all of it breaks

- the transmission angle, if u - T |v| + h sqrt(1 + T^2) < 0 at one cam angle;
- the curvature of one sign, if the largest value of
  K rho^3 - sign (rho^2 - alpha u + beta v), K = ratio/r_R, rho = |(u, v)|,
  is below 0 at one cam angle: the linear terms change by at most h |(alpha, beta)|, and the rest
  has no maximum inside the range of rho;
- the distance of the roller from the cam axis, if at one cam angle it is below half - h;
- that no point of a flank is covered, see `camgeo.check.sizing.covering`.

The remaining cells are halved both ways. No place is dropped without proof: only those nearer than
the best one found, by more than `GAP` of its distance, still matter.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from camgeo.check.sizing.conditions import Conditions
from camgeo.numeric.arrays import BoolArray, ComplexArray, FloatArray, taken

DIRECTIONS = 32
"""Number of directions of the first cells, which are as long as they are wide."""

LEVELS = 11
"""The last cells are 1e-4 of their distance wide."""

GAP = 2e-4
"""A place nearer by less than this fraction is left to the search along directions."""

MOST_CELLS = 12_000
MOST_RUNS = 4
"""Neighbourhoods of the nearest places that are searched further."""

BLOCK = 2_000_000
"""Most values computed at once."""

Start = tuple[float, float, float]
"""Direction, base radius, and half the range of directions to search."""


@dataclass(frozen=True, slots=True)
class Found:
    """Neighbourhoods of the nearest places.

    Attributes
    ----------
    starts : one for each, empty if the middle of no cell meets the conditions.
    bound : base radius [mm] below which every place breaks a condition; infinite if all do.
    """

    starts: tuple[Start, ...]
    bound: float


def nearest_cells(
    now: Conditions,
    start: complex,
    least: float,
    reach: float,
    directions: tuple[float, float] = (-math.pi, 0.0),
) -> Found:
    """The places nearest to `start` that meet `now`, from `least` to `reach` [mm], in some
    `directions` [rad]; in a single one the cells have no width.
    """
    first, last = directions
    count = DIRECTIONS if first < last else 1
    rows = max(1, math.ceil(math.log(reach / least) * DIRECTIONS / math.pi))
    height = 0.5 * math.log(reach / least) / rows
    width = 0.5 * (last - first) / count
    theta = first + width * (2.0 * np.arange(count) + 1.0)
    depth = math.log(least) + height * (2.0 * np.arange(rows) + 1.0)
    theta, depth = (each.ravel() for each in np.meshgrid(theta, depth))
    best, bound = math.inf, math.inf
    good = np.empty((2, 0))
    for _ in range(LEVELS):
        radius = np.exp(depth)
        places = start + radius * np.exp(1j * theta)
        half = radius * math.exp(height) * math.hypot(width, height)
        left = ~excluded(now, places, half)
        theta, depth, radius, places = theta[left], depth[left], radius[left], places[left]
        met = now.met(places)
        if np.any(met):
            best = min(best, float(np.min(radius[met])))
            good = np.concatenate((good, np.stack((theta[met], radius[met]))), axis=1)
        lower = np.exp(depth - height)
        open_ = lower < (1.0 - GAP) * best
        theta, depth, lower = theta[open_], depth[open_], lower[open_]
        if len(theta) > MOST_CELLS:
            order = np.argsort(lower)
            bound = min(bound, float(lower[order[MOST_CELLS]]))
            theta, depth = theta[order[:MOST_CELLS]], depth[order[:MOST_CELLS]]
        if not len(theta):
            break
        width, height = 0.5 * width, 0.5 * height
        ways = (-1.0, 1.0) if width > 0.0 else (0.0,)
        theta, depth = (
            np.concatenate([theta + s * width for s in ways for _ in range(2)]),
            np.concatenate([depth + s * height for _ in ways for s in (-1.0, 1.0)]),
        )
    if len(theta):
        bound = min(bound, float(np.exp(np.min(depth) - height)))
    return Found(_starts(good, best, width), min(bound, (1.0 - GAP) * best))


def excluded(now: Conditions, places: ComplexArray, half: FloatArray) -> BoolArray:
    """(k,) whether all places within `half` (k,) [mm] of `places` (k,) break a condition."""
    count = 1 + len(places) * now.count // BLOCK
    parts = zip(np.array_split(places, count), np.array_split(half, count), strict=True)
    return np.concatenate([_excluded(now, each[:, None], reach[:, None]) for each, reach in parts])


def _excluded(now: Conditions, places: ComplexArray, half: FloatArray) -> BoolArray:
    terms = now.terms
    u, v = terms.across_and_along(places)
    tilted = u - now.tangent * np.abs(v) + half * math.hypot(1.0, now.tangent)
    out: BoolArray = np.any(tilted < 0.0, axis=1)
    if now.half > 0.0:
        out |= np.any(terms.to_axis(places) + half <= now.half, axis=1)
    if now.covers is not None and len(now.covers.first) and not np.all(out):
        rest = ~out
        gap, pace = now.covers.gap(places[rest, 0])
        sure = gap + now.covers.change(half[rest], pace) < 0.0
        out[rest] = np.any(sure, axis=1)
    rest = ~out
    if not np.any(rest) or not now.roller > 0.0:
        return out
    u, v, half = u[rest], v[rest], half[rest]
    rho = np.hypot(u, v)
    linear = terms.alpha * u - terms.beta * v
    slack = half * np.hypot(terms.alpha, terms.beta)
    bent = np.zeros(len(u), dtype=np.bool_)
    for sign in now.signs:
        value = np.full(rho.shape, -np.inf)
        for end in (np.maximum(rho - half, 0.0), rho + half):
            square = end * end
            value = np.maximum(value, (now.ratio / now.roller) * square * end - sign * square)
        bent |= np.any(value + sign * linear + slack < 0.0, axis=1)
    out[rest] = bent
    return out


def within(now: Conditions, place: ComplexArray, half: float) -> Conditions:
    """`now` without the cam angles and the pairs at which all places within `half` [mm] of `place`
    (1,) meet it.

    At least one cam angle remains.
    """
    terms = now.terms
    u, v = terms.across_and_along(place)
    asked = u - now.tangent * np.abs(v) - half * math.hypot(1.0, now.tangent) < 0.0
    asked |= terms.to_axis(place) - half <= now.half
    covers = now.covers
    if covers is not None:
        gap, pace = covers.gap(place)
        covers = covers.some((gap - covers.change(np.array([[half]]), pace) < 0.0)[0])
    if now.roller > 0.0:
        slope = now.ratio / now.roller
        rho = np.hypot(u, v)
        low, high = np.maximum(rho - half, 0.0), rho + half
        linear = terms.alpha * u - terms.beta * v
        slack = half * np.hypot(terms.alpha, terms.beta)
        for sign in now.signs:
            # The minimum of slope rho^3 - sign rho^2, at 2/(3 slope) if that is in the range.
            end = np.clip(2.0 / (3.0 * slope), low, high) if sign > 0.0 else low
            asked |= end * end * (slope * end - sign) + sign * linear - slack < 0.0
    if not np.any(asked):
        asked[0] = True
    return replace(now, terms=taken(terms, asked), covers=covers)


def _starts(good: FloatArray, best: float, width: float) -> tuple[Start, ...]:
    """Runs of neighbouring directions whose places are about as near as the nearest."""
    near = good[:, good[1] <= (1.0 + 4.0 * GAP) * best]
    if not near.shape[1]:
        return ()
    near = near[:, np.argsort(near[0])]
    cuts = np.flatnonzero(np.diff(near[0]) > 0.05) + 1
    runs = np.split(near, cuts, axis=1)
    runs.sort(key=lambda run: float(np.min(run[1])))
    found = []
    for run in runs[:MOST_RUNS]:
        first = int(np.argmin(run[1]))
        reach = float(np.max(np.abs(run[0] - run[0, first])))
        found.append((float(run[0, first]), float(run[1, first]), reach + 4.0 * width + 1e-3))
    return tuple(found)
