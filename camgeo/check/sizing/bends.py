"""The smallest base circle where r_R against r_K matters too: not a convex problem.

Seen from the roller centre at cam angle 0 the cam axis lies in a direction theta in (-pi, 0). Cells
of places that certainly break a condition at one of some cam angles are excluded, which leaves the
neighbourhoods of the nearest places (`cells`); there the nearest place is sought along each
direction, and the direction with the smallest is enclosed. Then the cam angles at which the place
found is extreme join the set, until it meets the conditions at all of them.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from camgeo.check.sizing.cells import Start, nearest_cells, within
from camgeo.check.sizing.conditions import Conditions, conditions, samples_of
from camgeo.check.sizing.task import Task
from camgeo.curve.extremes import curvature_extremes
from camgeo.errors import GeometryError
from camgeo.numeric.arrays import FloatArray

REACH, ROOM = 40.0, 4.0
"""The largest base radius searched: as a multiple of that for the transmission angle, and of
r_R/ratio. Far out the pitch curve is nearly a circle, and r_K nearly the base radius."""

DIRECTIONS, RADII = 61, 81
"""Size of the grid of places on which the smallest ratio is sought if none is small enough."""

ZOOM, STEPS = 8.0, 15
"""Each step encloses the direction eight times closer."""

WIDTH = 1e-2
"""Half the range of directions [rad] about the last place in which the next one is sought."""

JUMP = 1e-3
"""If the nearest place is this fraction beyond the bound of the cells, they are searched again."""

BELOW, ABOVE = 0.06, 0.03
"""Range about the last radius in which the next one is sought at first; a third of it each step."""

HALVINGS = 48
ROUNDS = 60
CLOSE = 1e-12
"""Conditions broken by this fraction of their terms count as met."""


def worst_ratio(task: Task, place: complex) -> tuple[float, float]:
    """Largest r_R/r_K for the sign that matters, at least 0, and its cam angle [rad].

    Raises GeometryError if the roller centre stands still in the cam.
    """
    bends = curvature_extremes(task.pitch_curve_at(place))
    found = [(sign, bends.largest() if sign > 0.0 else bends.smallest()) for sign in task.signs]
    sign, (kappa, phi) = max(found, key=lambda each: each[0] * each[1][0])
    return max(task.follower.roller_radius * sign * kappa, 0.0), phi


@dataclass(frozen=True, slots=True)
class Nearest:
    """The place of the smallest base circle for mu and r_R/r_K.

    Attributes
    ----------
    place : [mm]; None if none was found.
    bound : base radius [mm] below which there certainly is no place; infinite if there is none up
        to the largest one searched.
    least_ratio : without a place, the smallest r_R/r_K of a grid of places that keep the
        transmission angle; infinite if there are none.
    reach : largest base radius [mm] searched.
    """

    place: complex | None
    bound: float
    least_ratio: float
    reach: float


def smallest_with_bends(task: Task, tangent: float, ratio: float, least: float) -> Nearest:
    """The smallest base circle for mu and r_R/r_K.

    Parameters
    ----------
    tangent : T of the transmission angle.
    ratio : largest r_R/r_K.
    least : base radius [mm] for the transmission angle alone, below which there is no place.

    Raises
    ------
    GeometryError
        If the search does not converge.
    """
    reach = max(REACH * least, ROOM * (task.follower.roller_radius / ratio + abs(task.start)))
    phi = samples_of(task)
    last: tuple[Start, ...] = ()
    bound = least
    for _ in range(ROUNDS):
        now = conditions(task, tangent, ratio, phi)
        reached = [_enclosed(task, now, start, least) for start in last]
        radius = min((each[1] for each in reached), default=math.inf)
        # Conditions are only added, so the nearest place can only move away; the cells are searched
        # again if it has moved by more than they left open.
        if not radius <= bound * (1.0 + JUMP):
            found = nearest_cells(now, task.start, least, reach)
            if not found.starts:
                return Nearest(None, found.bound, _least_ratio(task, now, least, reach), reach)
            bound = found.bound
            reached += [_enclosed(task, now, start, least) for start in found.starts]
            reached += [start[:2] for start in found.starts]
        theta, radius = min(reached, key=lambda each: each[1])
        place = complex(task.start + radius * np.exp(1j * theta))
        extreme, broken = _extreme_angles(task, place, tangent, ratio)
        if not broken:
            return Nearest(place, bound, 0.0, reach)
        last = ((theta, radius, WIDTH),)
        phi = np.unique(np.concatenate((phi, extreme)))
    raise GeometryError("the smallest base circle was not enclosed: the search did not converge")


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
    for sign in task.signs:
        worst = float(np.max(sign * bends.values)) * task.follower.roller_radius
        broken = broken or worst > ratio * (1.0 + CLOSE)
    return np.concatenate(angles), broken


def _least_ratio(task: Task, now: Conditions, least: float, reach: float) -> float:
    theta = -np.pi + np.pi * (np.arange(DIRECTIONS) + 0.5) / DIRECTIONS
    radii = np.geomspace(least, reach, RADII)
    places = (task.start + radii * np.exp(1j * theta)[:, np.newaxis]).ravel()
    free = Conditions(now.terms, now.tangent, 0.0, 1.0, now.signs)
    kept = places[free.met(places)]
    return float(np.min(now.worst_ratio(kept))) if len(kept) else math.inf


def _enclosed(task: Task, now: Conditions, start: Start, least: float) -> tuple[float, float]:
    """Direction and base radius of the smallest circle near `start`; infinite if there is none."""
    best, radius, width = start
    share = 1.0
    for step in range(STEPS):
        # Cam angles at which the whole neighbourhood meets the conditions can be skipped.
        places = np.array([task.start + radius * np.exp(1j * best)])
        near = within(now, places, 1.1 * radius * (width + BELOW * share))
        theta = np.clip(best + width * np.linspace(-1.0, 1.0, 33), -np.pi, 0.0)
        scan = radius * np.linspace(1.0 - BELOW * share, 1.0 + ABOVE * share, 46)
        reached = _nearest_along(task, near, theta, np.maximum(scan, least), HALVINGS - step)
        index = int(np.argmin(reached))
        if not np.isfinite(reached[index]):
            return best, math.inf
        best, radius = float(theta[index]), float(reached[index])
        width /= ZOOM
        share /= 3.0
    return best, radius


def _nearest_along(
    task: Task, now: Conditions, theta: FloatArray, scan: FloatArray, halvings: int
) -> FloatArray:
    """(k,) smallest base radius within `scan` in each direction; infinite if there is none."""
    ways = np.exp(1j * theta)
    met = now.met((task.start + scan * ways[:, np.newaxis]).ravel()).reshape(len(theta), -1)
    some = np.any(met, axis=1)
    first = np.argmax(met, axis=1)
    good, bad = scan[first], scan[np.maximum(first - 1, 0)]
    for _ in range(halvings):
        middle = 0.5 * (good + bad)
        fine = now.met(task.start + middle * ways)
        good, bad = np.where(fine, middle, good), np.where(fine, bad, middle)
    return np.where(some, good, np.inf)
