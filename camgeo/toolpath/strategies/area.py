"""What the strategies that clear areas share: coarse paths along walls, proved to keep off them."""

from __future__ import annotations

import math
from typing import Final

import numpy as np

from camgeo.contour.contour import Contour
from camgeo.contour.nearness import least_distance
from camgeo.errors import GeometryError, UndercutError
from camgeo.numeric.arrays import phase
from camgeo.part.part import Boundary
from camgeo.toolpath.cut import AreaCut, slack_of
from camgeo.toolpath.leads import flattest, started
from camgeo.toolpath.plane.spiral import Morph, paced
from camgeo.toolpath.plane.star import Star
from camgeo.toolpath.plane.track import Track

SPENT: Final = 3.0
"""Tolerances by which a roughing path is moved off the wall: its last round deviates by one, the
spiral before it by another, and the wall in the proof by the third."""

SHORTEST: Final = 0.05
"""Least length of a piece at which a round begins [mm]: shorter ones could vanish in rounding."""

STEEPER: Final = 3.0
"""How much faster than on a straight wall the engagement may grow with the depth of cut, where the
curvature of the wall jumps."""

EQUAL: Final = 1e-9
"""Rounding of a distance [mm]."""


def coarse(cut: AreaCut, tolerance: float) -> float:
    """Tolerance of roughing paths [mm], at least that of the program."""
    return max(tolerance, slack_of(cut.allowance))


def limit_of(cut: AreaCut, tolerance: float) -> float:
    """Largest engagement to plan for [rad], so that it holds for arcs within `tolerance` [mm].

    Where the tool states none it is that on a straight wall at the stepover.
    """
    radius, step = cut.tool.radius, cut.stepover
    limit = cut.tool.engagement or math.acos(max(-1.0, 1.0 - step / radius))
    # cos(limit) = 1 - depth / radius on a straight wall, and both turns may be a tolerance off.
    steep = radius * math.sin(min(limit, 0.5 * math.pi))
    return max(0.5 * limit, limit - STEEPER * 2.0 * tolerance / steep)


def along(wall: Boundary, cut: AreaCut, tolerance: float, farther: float = 0.0) -> Contour:
    """The path of the cutter's centre along a wall, off it by the allowance and `farther` [mm],
    counter-clockwise and within the coarse `tolerance` [mm].

    Raises
    ------
    GeometryError
        With key "tool", if the cutter does not reach the whole wall.
    """
    distance = cut.tool.radius + cut.allowance + farther + SPENT * tolerance
    try:
        return wall.offset(distance).arcs(tolerance, "fast").contour
    except UndercutError as error:
        raise GeometryError(
            f"the cutter is too large for the {wall.name}, which it has to clear {distance:g} mm"
            f" off ({error.message})",
            key="tool",
        ) from None


def require_clear(track: Track, wall: Boundary, cut: AreaCut, tolerance: float) -> None:
    """Prove that a cutter on `track` keeps off the wall by the allowance.

    Raises
    ------
    GeometryError
        With key "toolpath", if it does not.
    """
    fit = wall.arcs(tolerance, "fast")
    apart = least_distance(track, Track.around(fit.contour)) - fit.deviation
    if apart < cut.tool.radius + cut.allowance - EQUAL:
        short = cut.tool.radius + cut.allowance - apart
        raise GeometryError(f"{cut.name} comes {short:.3g} mm too near to the wall", "toolpath")


def star_of(contour: Contour, what: str) -> Star:
    """The contour seen from the cam axis.

    Raises
    ------
    GeometryError
        With key "toolpath", if rays from there meet it more than once.
    """
    star = Star.of(contour)
    if star is None:
        raise GeometryError(
            f"the {what} cannot be cleared by a spiral: rays from the cam axis meet the cutter's"
            " path more than once, or nearly along it",
            key="toolpath",
        )
    return star


def flattest_direction(path: Contour) -> float:
    """The direction [rad] of the flattest place of a path."""
    return phase(complex(started(path, next(flattest(path))).vertices[0]))


def off_joints(path: Contour, star: Star, direction: float) -> float:
    """The `direction` [rad] in which a round of the path begins, or that of a joint of its pieces
    next to it: no piece of a round is shorter than `SHORTEST`.
    """
    place = star.along(direction)
    joints = np.concatenate(([0.0], np.cumsum(path.lengths)))
    nearest = int(np.argmin(np.abs(joints - place)))
    if abs(joints[nearest] - place) >= SHORTEST:
        return direction
    turned = phase(complex(path.vertices[nearest % len(path)]) * np.exp(-1j * direction))
    return direction + turned


def spiral(
    cut: AreaCut, a: Star, b: Star, finish: float, tolerance: float, *, outward: bool
) -> Morph:
    """The spiral from a to b, outward in a hole, that ends in the direction `finish` [rad]."""
    return paced(
        a,
        b,
        sense=1 if outward == cut.climb else -1,
        side=-1 if cut.climb else 1,
        finish=finish,
        radius=cut.tool.radius,
        limit=limit_of(cut, tolerance),
        step=min(cut.stepover, 2.0 * (cut.tool.radius - cut.tool.corner_radius) or cut.stepover),
    )
