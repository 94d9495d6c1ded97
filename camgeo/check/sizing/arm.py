"""The arm of an oscillating follower, sought within a range together with the cam axis.

For a given swing all lengths of a rocker scale with the arm l_3: places of the cam axis as P/l_3,
curvatures as kappa l_3. For the transmission angle alone the smallest base circle is therefore
proportional to the arm, and the shortest arm gives the smallest. The roller does not scale: it is
large relative to a short arm, so with r_R <= ratio r_K the best arm may lie inside the range.
No arm above r_G,best/r_G,mu times the shortest one can be better, which bounds the search.
"""

from __future__ import annotations

import math

import numpy as np

from camgeo.check.sizing.smallest import Sizing, size
from camgeo.check.sizing.task import Task, task_of
from camgeo.errors import GeometryError

ARMS = 7
"""Number tried first, in equal ratios from the shortest to the longest that can be better."""

SECTIONS = 14
"""Golden sections of the two intervals about the best of them: to 1e-3 of an interval."""

ROUNDS = 150
"""The sections end when the sizings of all arms have taken so many rounds: where global undercut
decides, one takes a dozen, and the best arm is found less closely."""

CLOSE = 1e-3
"""If an arm longer than the shortest by this fraction is no better, the shortest is the best."""

GOLDEN = 0.5 * (math.sqrt(5.0) - 1.0)


def with_arm(task: Task, arm: float) -> Task:
    """The same mechanism with an arm of `arm` [mm], pivot and base circle scaled with it."""
    follower = task.follower
    scale = arm / follower.arm
    pivot, base_radius = follower.pivot * scale, follower.base_radius * scale
    return task_of(task.cam.sized(arm=arm, pivot=pivot, base_radius=base_radius))


def size_with_arm(
    task: Task, angle: float, ratio: float, low: float, high: float
) -> tuple[Task, Sizing]:
    """The mechanism with the arm that gives the smallest base circle, and its sizing.

    Parameters
    ----------
    angle, ratio : as for `size`.
    low, high : the shortest and the longest arm [mm].

    Raises
    ------
    GeometryError
        With key "follower.kind" for a follower without an arm, "arm" if the range is invalid or
        lets the roller reach the pivot; and as `size` does.
    """
    if task.held is None:
        raise GeometryError(
            "only an oscillating roller follower has an arm to be sized",
            key="follower.kind",
            value=task.follower.kind,
        )
    roller = task.follower.roller_radius
    if not (roller < low <= high < math.inf):
        raise GeometryError(
            f"must be two lengths, the shorter one first, above the roller radius, {roller:g} mm:"
            " the roller must not reach the pivot",
            key="arm",
            value=f"{low:g} {high:g}",
        )
    tried: dict[float, Sizing] = {}

    def radius(arm: float) -> float:
        if arm not in tried:
            tried[arm] = size(with_arm(task, arm), angle, ratio)
        answer = tried[arm].answer
        return math.inf if answer is None else answer.base_radius

    def result(arm: float) -> tuple[Task, Sizing]:
        return with_arm(task, arm), tried[arm]

    shortest = radius(low)
    alone = tried[low].for_angle
    if alone is None or shortest == alone.base_radius or low == high:
        return result(low)
    per_arm = alone.base_radius / low
    high = min(high, shortest / per_arm)
    arms = [float(arm) for arm in np.geomspace(low, high, ARMS)]
    for arm in arms:
        if arm * per_arm < min(radius(each) for each in tried):
            radius(arm)
    if all(math.isinf(radius(arm)) for arm in tried):
        return result(low)
    best = min(tried, key=radius)
    if best == low and radius(low * (1.0 + CLOSE)) >= radius(low):
        return result(low)
    step = (high / low) ** (1.0 / (ARMS - 1))
    left, right = max(low, best / step), min(high, best * step)
    for _ in range(SECTIONS):
        if right <= left * (1.0 + 1e-4) or sum(each.rounds for each in tried.values()) > ROUNDS:
            break
        first = right * (left / right) ** GOLDEN
        second = left * (right / left) ** GOLDEN
        if radius(first) <= radius(second):
            right = second
        else:
            left = first
    return result(min(tried, key=radius))
