"""The smallest base circle for a transmission angle: a convex problem, solved by exchange.

Every cam angle gives half-planes in which the cam axis must lie. The place nearest to the roller
centre is found for some of them, those it violates most are added, and so on until none is
violated. The worst violations are roots of a slope, so this converges like Newton's method.
"""

from __future__ import annotations

import math
from typing import Final

import numpy as np

from camgeo.check.sizing.task import Task
from camgeo.numeric.arrays import ComplexArray, FloatArray, Side, dot

CLOSE = 2e-14
"""A condition broken by this fraction of its terms is met up to rounding."""

MOST = 80
"""Most rounds; a dozen is usual."""

BISECTIONS = 26

SIDES: Final[tuple[Side, ...]] = ("right", "left")


def smallest_place(task: Task, tangent: float) -> complex | None:
    """Place [mm] of the cam axis with the smallest base circle and mu >= atan(`tangent`).

    None if no place keeps that angle over the whole turn.
    """
    normals, bounds = task.held_to()
    place: complex = task.start
    for _ in range(MOST):
        broken = False
        for t in (tangent, -tangent):
            found = task.slack(place, t)
            size = (abs(place) + abs(task.start)) * math.hypot(1.0, t)
            size += float(np.max(np.abs(bounds), initial=0.0))
            worst = found.values < -CLOSE * size
            if np.any(worst):
                broken = True
                for side in SIDES:
                    more = task.terms(found.phi[worst], side).half_planes(t)
                    normals = np.concatenate((normals, more[0]))
                    bounds = np.concatenate((bounds, more[1]))
        if not broken:
            return place
        normals, bounds = _different(normals, bounds)
        nearest = nearest_point(normals, bounds, task.start)
        if nearest is None:
            return None
        if nearest == place:
            return place
        place = nearest
    return place


def largest_angle(task: Task) -> float:
    """The largest transmission angle [rad] that some place keeps over the turn, from below."""
    low, high = 0.0, math.radians(89.0)
    for _ in range(BISECTIONS):
        middle = 0.5 * (low + high)
        if smallest_place(task, math.tan(middle)) is None:
            high = middle
        else:
            low = middle
    return low


def _different(normals: ComplexArray, bounds: FloatArray) -> tuple[ComplexArray, FloatArray]:
    """Each half-plane once."""
    rows = np.unique(np.column_stack((normals.real, normals.imag, bounds)), axis=0)
    return rows[:, 0] + 1j * rows[:, 1], rows[:, 2]


ROUNDING = 1e-13
"""A point outside a half-plane by this fraction of the size of all of them lies on its border."""


def nearest_point(normals: ComplexArray, bounds: FloatArray, start: complex) -> complex | None:
    """The point P with Re(conj(n) P) >= c for all n, c that is nearest to `start`.

    Parameters
    ----------
    normals : n (k,) complex, not zero.
    bounds : c (k,).

    Returns
    -------
    None if no point lies in all half-planes. It is `start`, its foot on one of the lines, or a
    crossing of two lines; all of these are tried.
    """
    length = np.abs(normals)
    normals, bounds = normals / length, bounds / length
    feet = start + normals * (bounds - dot(normals, start))
    first, second = np.triu_indices(len(normals), 1)
    n1, n2, c1, c2 = normals[first], normals[second], bounds[first], bounds[second]
    area = n1.real * n2.imag - n1.imag * n2.real
    crossing = np.abs(area) > ROUNDING
    area = np.where(crossing, area, 1.0)
    vertices = ((c1 * n2.imag - c2 * n1.imag) + 1j * (c2 * n1.real - c1 * n2.real)) / area
    points = np.concatenate(([start], feet, vertices[crossing]))
    size = np.abs(points) + np.max(np.abs(bounds), initial=0.0)
    inside = np.ones(len(points), dtype=np.bool_)
    for normal, bound in zip(normals, bounds, strict=True):
        inside &= dot(points, normal) >= bound - ROUNDING * size
    if not np.any(inside):
        return None
    found = points[inside]
    return complex(found[np.argmin(np.abs(found - start))])
