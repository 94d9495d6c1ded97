"""A slot cut by loops: wider than the cutter, deep, and at a bounded engagement.

Down by a helix, and along the wall by full circles that touch the cutter's path there from its free
side, each a little ahead of the one before it, with the path itself between them. A circle of a
radius below that of the cutter sweeps a whole disc, so the next one is engaged at most where it is
ahead of that disc: by the crossings of two circles, at every place of the next circle and of the
way onto it. The path along the wall is run all round, so that no cusps are left on it.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from itertools import pairwise
from typing import Final

import numpy as np

from camgeo.errors import GeometryError
from camgeo.geometry.contour.contour import Contour, Effort
from camgeo.milling.cut import AreaCut, Cut
from camgeo.milling.milling import Heights
from camgeo.milling.moves import Move, too_long
from camgeo.milling.strategies.around import descend
from camgeo.milling.strategies.walk import (
    SPENT,
    Walk,
    along,
    coarse,
    cut_of_kind,
    limit_of,
    require_clear,
)
from camgeo.milling.track import Track, chained, flattest, started
from camgeo.reading import PROGRAM_LINES

NARROWEST: Final = 0.1
"""Radius of a loop as a share of that of the cutter, at least."""

HOLLOW: Final = 0.45
"""Radius of a loop as a share of that of the path, where it bends towards the loops, at most."""

SHORTER: Final = 0.97
"""Share by which a step is tried shorter until the loops are near enough."""

PLACES: Final = 721
"""Of a loop at which its engagement is compared."""

ROUNDING: Final = 1e-4
"""Angle [rad] by which it may be larger between these."""

BISECTED: Final = 40
"""Steps of a bisection."""

MOVES: Final = 4
"""Of a loop at least: the way to it, two of its cutting part, and the way back."""

SHORTEST: Final = 1e-3
"""Of a step, as a share of the cutter's radius: a limit that asks for less cannot be kept."""


def trochoid(cut: Cut, heights: Heights, tolerance: float, effort: Effort) -> list[Move]:  # noqa: ARG001  all strategies are called alike
    """A slot of at most the width `cut.slot` along the first wall, to each depth in turn without
    leaving it.

    Raises
    ------
    GeometryError
        If the cutter is too large for the wall or the slot, or no step keeps the engagement.
    """
    cut = cut_of_kind(cut, AreaCut, "clears an area")
    fine, wall = coarse(cut, tolerance), cut.walls[0]
    path = along(wall, cut, fine)
    path = started(path, next(flattest(path)))
    path = path if wall.hole == cut.climb else path.reversed()
    walk = Walk(cut, heights)
    size = _loop(cut, path, walk.free, fine)
    steps = list(_steps(cut, Track.around(path), walk.free, size, fine))
    level = chained([track for track, _ in steps])
    for each in cut.walls:
        require_clear(level, each, cut, fine)
    # The round of the helix at its depth: its floor is still sloping.
    helix = _circle(Track.around(path), 0.0, walk.free, size)
    for above, z in pairwise((cut.top, *cut.depths)):
        descend(walk, helix, above, z)
        walk.follow(helix)
        for track, air in steps:
            walk.follow(track, air=air)
    walk.follow(helix.between(0.0, 0.5 * helix.length))
    walk.up()
    return walk.moves


def _loop(cut: AreaCut, path: Contour, free: int, fine: float) -> float:
    """Radius of the loops [mm]."""
    radius = cut.tool.radius
    size = 0.5 * cut.slot - radius - SPENT * fine
    if size < NARROWEST * radius:
        raise GeometryError(
            f"the cutter is too large for loops in a slot of {cut.slot:.4g} mm; the largest that"
            f" fits has {_hundredths((cut.slot - 2.0 * SPENT * fine) / (1.0 + NARROWEST)):g} mm",
            "tool", f"{cut.tool.diameter:g}",
        )  # fmt: skip
    whole, hollow = size, path.radii[path.sweeps * free > 0.0]
    size = min(size, HOLLOW * float(np.min(hollow, initial=np.inf)))
    if size < NARROWEST * radius or (len(cut.walls) > 1 and size < whole):
        raise GeometryError(
            f"there is no room for loops in the hollows of the {cut.walls[0].name}", "tool",
            f"{cut.tool.diameter:g}",
        )  # fmt: skip
    return size


def _hundredths(diameter: float) -> float:
    """The diameter [mm] in whole hundredths, no larger."""
    return math.floor(100.0 * diameter) / 100.0


def _circle(path: Track, place: float, free: int, size: float) -> Track:
    """A full circle that touches the path at `place` [mm] along it, on its free side."""
    (point,), (heading,) = path.at(np.array([place]))
    centre = complex(point + free * 1j * heading * size)
    return Track.arc(complex(point), centre, free * 2.0 * math.pi)


def _steps(
    cut: AreaCut, path: Track, free: int, size: float, fine: float
) -> Iterator[tuple[Track, bool]]:
    """Ways along the path, each followed by a circle in two parts, and whether each is in air.

    A circle leaves the material slightly behind its half: its middle is `largest` ahead at most.
    """
    length, limit = path.length, limit_of(cut, fine)
    largest = min(cut.stepover, ahead(size, cut.tool.radius, limit))
    least = SHORTEST * cut.tool.radius
    if largest < least:
        raise GeometryError(
            "is too small for loops along the wall", "tool.engagement", f"{math.degrees(limit):g}"
        )
    if MOVES * len(cut.depths) * length > PROGRAM_LINES * largest:
        raise too_long()
    cutting = size * (math.pi + math.asin(min(0.5 * largest / size, 1.0)))
    place, before = 0.0, _circle(path, 0.0, free, size)
    while place < length:
        step = min(largest, length - place)
        # Where the path bends away from the loops their middles are farther apart than the steps.
        while step > least and _apart(before, _circle(path, place + step, free, size)) > largest:
            step *= SHORTER
        end = place + step if length - place - step > least else length
        yield path.between(place, end), False
        before = _circle(path, end, free, size)
        yield before.between(0.0, cutting), False
        yield before.between(cutting, before.length), True
        place = end


def _apart(one: Track, other: Track) -> float:
    return abs(complex(one.centres[0] - other.centres[0]))


def ahead(size: float, radius: float, limit: float) -> float:
    """How far a loop may be ahead of the one before it [mm] for an engagement of `limit` [rad].

    Parameters
    ----------
    size : radius of the loops [mm], below that of the cutter.
    radius : of the cutter [mm].
    """
    low, high = 0.0, 2.0 * (size + radius)
    for _ in range(BISECTED):
        middle = 0.5 * (low + high)
        if engaged(size, radius, middle) <= limit - ROUNDING:
            low = middle
        else:
            high = middle
    return low


def engaged(size: float, radius: float, apart: float) -> float:
    """Largest engagement [rad] on a loop whose middle is `apart` [mm] from that of the one before.

    The cutter is in material outside the disc that the loop before has swept: up to its crossings
    with the circle around that disc, which lie about the ray from the middle of the disc. Ahead of
    that ray's normal it is engaged the more, the more the ray leans forward.
    """
    around = np.linspace(-np.pi, 0.0, PLACES)
    # Of the cutter's centre, seen from the middle of the loop before; the next is at `apart`.
    arm = apart + size * np.exp(1j * around)
    far = np.abs(arm)
    reach = size + radius
    cosine = (reach * reach - far * far - radius * radius) / (2.0 * far * radius)
    half = np.arccos(np.clip(cosine, -1.0, 1.0))
    turned = np.abs(np.angle(1j * np.exp(1j * around) / arm))
    angles = np.minimum(turned + half, 0.5 * np.pi) - np.maximum(turned - half, -0.5 * np.pi)
    return float(np.max(np.maximum(angles, 0.0)))
