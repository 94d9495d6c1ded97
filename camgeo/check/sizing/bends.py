"""The smallest base circle where r_R against r_K, or global undercut, matters too: not a convex
problem.

Seen from the roller centre at cam angle 0 the cam axis lies in a direction theta in (-pi, 0). Cells
of places that certainly break a condition at one of some cam angles are excluded, which leaves the
neighbourhoods of the nearest places (`cells`); there the nearest place is sought along each
direction, and the direction with the smallest is enclosed. Then the cam angles at which the place
found is extreme join the set, and the pairs at which its flanks are cut off, until it meets the
conditions at all of them.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from camgeo.check.sizing.cells import Start, nearest_cells, within
from camgeo.check.sizing.conditions import Conditions, conditions, samples_of
from camgeo.check.sizing.covering import covered, no_pairs
from camgeo.check.sizing.task import Task
from camgeo.curve.extremes import curvature_extremes
from camgeo.errors import GeometryError
from camgeo.numeric.arrays import FloatArray
from camgeo.outline.clearance import nearest_to_axis

REACH, ROOM = 40.0, 4.0
"""The largest base radius searched: as a multiple of that for the transmission angle, and of
r_R/ratio. Far out the pitch curve is nearly a circle, and r_K nearly the base radius."""

DIRECTIONS, RADII = 61, 81
"""Size of the grid of places on which the smallest ratio is sought if none is small enough."""

ZOOM, FINEST = 8.0, 1e-12
"""Each step encloses the direction eight times closer, down to this [rad]."""

STEPS = 40
"""Most steps; a step that ends at the end of its range moves the range, and widens it."""

LEAST_WIDTH, LEAST_SHARE = 1e-6, 1e-4
AGAIN = 4.0, 100.0
"""Range of directions and of radii of a later search: these multiples of the last move, at least
these, and at most those of the first one."""

WIDTH = 1e-2
"""Half the range of directions [rad] about the last place in which the next one is sought."""

JUMP = 1e-3
"""If the nearest place is this fraction beyond the bound of the cells, they are searched again."""

BELOW, ABOVE = 0.06, 0.03
"""Range about the last radius in which the next one is sought at first; a third of it each step."""

DIGITS = 1e-12
"""Width of the last halves of a range of radii, as a fraction of the first range."""

CLOSE = 1e-12
"""Conditions broken by this fraction of their terms count as met."""

ROUNDS = 40
"""Most rounds; a dozen is usual."""

STEP, GROWTH = 1e-9, 4.0
"""After the last round: the first step outward, as a fraction of the radius, and its growth."""


def worst_ratio(task: Task, place: complex) -> tuple[float, float]:
    """Largest r_R/r_K for the sign that matters, at least 0, and its cam angle [rad].

    Raises GeometryError if the roller centre stands still in the cam.
    """
    bends = curvature_extremes(task.pitch_curve_at(place))
    found = [(sign, bends.largest() if sign > 0.0 else bends.smallest()) for sign in task.signs]
    sign, (kappa, phi) = max(found, key=lambda each: each[0] * each[1][0])
    return max(task.follower.roller_radius * sign * kappa, 0.0), phi


@dataclass(frozen=True, slots=True, eq=False)
class Nearest:
    """The place of the smallest base circle for all conditions.

    Attributes
    ----------
    place : [mm]; None if none was found.
    bound : base radius [mm] below which there certainly is no place; infinite if there is none up
        to the largest one searched.
    least_ratio : without a place, the smallest r_R/r_K of a grid of places that keep the
        transmission angle; infinite if there are none.
    reach : largest base radius [mm] searched.
    rounds : of the exchange that it took.
    examined : all cam angles, and pairs of them, that were examined.
    """

    place: complex | None
    bound: float
    least_ratio: float
    reach: float
    rounds: int
    examined: Conditions


def smallest_with_bends(task: Task, tangent: float, ratio: float, least: float) -> Nearest:
    """The smallest base circle for mu and r_R/r_K, without undercut.

    Parameters
    ----------
    tangent : T of the transmission angle.
    ratio : largest r_R/r_K.
    least : base radius [mm] below which there is no place.
    """
    reach = max(REACH * least, ROOM * (task.follower.roller_radius / ratio + abs(task.start)))
    phi, covers = samples_of(task), no_pairs(task)
    last: tuple[Start, ...] = ()
    share, bound = 1.0, least
    before = 0.0, math.inf
    for number in range(1, ROUNDS + 1):
        now = conditions(task, tangent, ratio, phi, covers)
        reached = [_enclosed(task, now, start, least, share) for start in last]
        radius = min((each[1] for each in reached), default=math.inf)
        # Conditions are only added, so the nearest place can only move away; the cells are searched
        # again if it has moved by more than they left open.
        if not radius <= bound * (1.0 + JUMP):
            found = nearest_cells(now, task.start, bound, reach, task.directions)
            bound = max(bound, found.bound)
            if not found.starts:
                least_ratio = _least_ratio(task, now, least, reach)
                return Nearest(None, bound, least_ratio, reach, number, now)
            reached += [_enclosed(task, now, start, least) for start in found.starts]
            reached += [start[:2] for start in found.starts]
        theta, radius = min(reached, key=lambda each: each[1])
        place = _place(task, theta, radius)
        extreme, broken = extreme_angles(task, place, tangent, ratio)
        more = no_pairs(task) if broken else covered(task, place)
        if not (broken or len(more.first)):
            return Nearest(place, bound, 0.0, reach, number, now)
        moves = abs(theta - before[0]), abs(radius - before[1]) / radius
        last = ((theta, radius, min(max(AGAIN[0] * moves[0], LEAST_WIDTH), WIDTH)),)
        share, before = min(max(AGAIN[1] * moves[1], LEAST_SHARE), 1.0), (theta, radius)
        phi = np.unique(np.concatenate((phi, extreme)))
        covers = covers + more
    place_beyond = _outward(task, theta, radius, tangent, ratio, reach)
    return Nearest(place_beyond, bound, math.inf, reach, ROUNDS, now)


def _place(task: Task, theta: float, radius: float) -> complex:
    return complex(task.start + radius * np.exp(1j * theta))


def _outward(
    task: Task, theta: float, radius: float, tangent: float, ratio: float, reach: float
) -> complex | None:
    """The first place farther out in a direction that meets everything; None if none is met."""
    step = STEP
    while radius * (1.0 + step) < reach:
        place = _place(task, theta, radius * (1.0 + step))
        if meets(task, place, tangent, ratio):
            return place
        step *= GROWTH
    return None


def meets(task: Task, place: complex, tangent: float, ratio: float) -> bool:
    """Whether the cam axis at `place` meets all conditions over the whole turn, to rounding."""
    try:
        broken = extreme_angles(task, place, tangent, ratio)[1]
    except GeometryError:
        return False
    return not broken and not len(covered(task, place).first)


def extreme_angles(
    task: Task, place: complex, tangent: float, ratio: float
) -> tuple[FloatArray, bool]:
    """Cam angles [rad] at which the conditions are extreme, and whether one is broken."""
    angles, broken = [], False
    size = abs(place) + abs(task.start)
    for t in (tangent, -tangent):
        found = task.slack(place, t)
        broken = broken or float(np.min(found.values)) < -CLOSE * size * math.hypot(1.0, t)
        angles.append(found.phi)
    curve = task.pitch_curve_at(place)
    try:
        bends = curvature_extremes(curve)
    except GeometryError:  # it stands still somewhere
        return np.concatenate(angles), True
    angles.append(bends.phi)
    for sign in task.signs:
        worst = float(np.max(sign * bends.values)) * task.follower.roller_radius
        broken = broken or worst > ratio * (1.0 + CLOSE)
    if task.half > 0.0:
        apart, phi = nearest_to_axis(curve)
        broken = broken or apart <= task.half
        angles.append(np.array([phi]))
    return np.concatenate(angles), broken


def _least_ratio(task: Task, now: Conditions, least: float, reach: float) -> float:
    first, last = task.directions
    theta = first + (last - first) * (np.arange(DIRECTIONS) + 0.5) / DIRECTIONS
    radii = np.geomspace(least, reach, RADII)
    places = (task.start + radii * np.exp(1j * theta)[:, np.newaxis]).ravel()
    free = Conditions(now.terms, now.tangent, 0.0, 1.0, now.signs)
    kept = places[free.met(places)]
    return float(np.min(now.worst_ratio(kept))) if len(kept) else math.inf


def _enclosed(
    task: Task, now: Conditions, start: Start, least: float, share: float = 1.0
) -> tuple[float, float]:
    """Direction and base radius of the smallest circle near `start`; infinite if there is none.

    `share` is that of the range of radii to begin with.
    """
    best, radius, width = start
    for _ in range(STEPS):
        # Cam angles at which the whole neighbourhood meets the conditions can be skipped.
        places = np.array([task.start + radius * np.exp(1j * best)])
        near = within(now, places, 1.1 * radius * (width + BELOW * share))
        theta = np.clip(best + width * np.linspace(-1.0, 1.0, 33), *task.directions)
        scan = radius * np.linspace(1.0 - BELOW * share, 1.0 + ABOVE * share, 46)
        halvings = max(1, math.ceil(math.log2(share / DIGITS)))
        reached = _nearest_along(task, near, theta, np.maximum(scan, least), halvings)
        index = int(np.argmin(reached))
        if not np.isfinite(reached[index]):
            return best, math.inf
        moved = theta[index] != best and index in (0, len(theta) - 1)
        best, radius = float(theta[index]), float(reached[index])
        if moved:  # it may lie beyond the end of the range
            width = min(2.0 * width, WIDTH)
            continue
        if width <= FINEST:
            break
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
