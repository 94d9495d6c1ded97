"""Chords of circular arcs with the arc on both sides of them, in closed form.

Vertices lie at the radius r + u and chords touch the circle of radius r - u, so that a chord from
vertex to vertex spans 2 arccos((r - u)/(r + u)). Differences of nearly equal numbers are avoided by
1 - cos x = 2 sin^2(x/2).
"""

from __future__ import annotations

import math

import numpy as np

from camgeo.numeric.arrays import FloatArray

HALVINGS = 60
"""Halvings in the search for the least offset: double precision resolves no more."""


def circle_count(tolerance: float, radius: float, most_turn: float) -> int:
    """Fewest chords of a whole circle within `tolerance` [mm] on both sides.

    No chord spans more than `most_turn` [rad], and there are at least three.
    """
    step = min(2.0 * _reach(tolerance, radius), most_turn)
    return max(3, _ceil(2.0 * math.pi / step))


def circle_offset(count: int, radius: float) -> float:
    """u [mm] of the vertices of `count` chords of a whole circle: r tan^2(pi/(2 count))."""
    return radius * math.tan(0.5 * math.pi / count) ** 2


def arc_count(tolerance: float, radius: float, sweep: float, most_turn: float) -> int:
    """Fewest chords within `tolerance` [mm] of an arc, its ends exact vertices.

    Parameters
    ----------
    sweep : angle of the arc [rad], positive.
    most_turn : largest span of a chord [rad]; those at the ends span less.
    """
    on_arc = min(2.0 * _end_reach(tolerance, radius), most_turn)
    plain = max(1, _ceil(sweep / on_arc))
    tolerance = min(tolerance, _offset_at_most(radius, most_turn))
    rest = sweep - 2.0 * _end_reach(tolerance, radius)
    return min(plain, 1 + max(0, _ceil(rest / (2.0 * _reach(tolerance, radius)))))


def arc_offset(count: int, radius: float, sweep: float) -> float:
    """Least u [mm] with which `count` chords with exact ends cover an arc of `sweep` [rad]."""
    low, high = 0.0, radius
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        reach = 2.0 * _end_reach(middle, radius) + 2.0 * (count - 1) * _reach(middle, radius)
        low, high = (middle, high) if reach < sweep else (low, middle)
    return high


def arc_angles(count: int, radius: float, sweep: float, offset: float) -> FloatArray:
    """(count + 1,) [rad] angles of the vertices along the arc, both ends included."""
    last = _end_reach(offset, radius) + _reach(offset, radius)
    if count < 3:
        return np.linspace(0.0, sweep, count + 1)
    inner = np.linspace(last, sweep - last, count - 1)
    return np.concatenate(([0.0], inner, [sweep]))


def _reach(offset: float, radius: float) -> float:
    """Half the angle [rad] of a chord between two vertices at r + u."""
    return 2.0 * math.asin(math.sqrt(min(offset / (radius + offset), 0.5)))


def _end_reach(offset: float, radius: float) -> float:
    """Angle [rad] from a vertex on the circle to where its chord touches that of r - u."""
    return 2.0 * math.asin(math.sqrt(min(0.5 * offset / radius, 0.5)))


def _offset_at_most(radius: float, turn: float) -> float:
    """u [mm] at which a chord between two vertices at r + u spans `turn` [rad]."""
    return radius * math.tan(0.25 * turn) ** 2


def _ceil(share: float) -> int:
    """Smallest whole number not below `share` by more than rounding."""
    return math.ceil(share * (1.0 - 2.0**-46))
