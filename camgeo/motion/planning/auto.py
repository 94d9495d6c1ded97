"""`law = "auto"`: the law of a move, chosen by its task and the quantities to keep small."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from functools import lru_cache, partial

from camgeo.errors import GeometryError
from camgeo.motion.laws import FAMILIES, law_of
from camgeo.motion.laws.balance import equal_accelerations
from camgeo.motion.laws.characteristic import Characteristic, acceleration_jumps, characteristic
from camgeo.motion.laws.law import Law
from camgeo.motion.planning.request import CRITERIA

DEFAULT: Mapping[str, float] = {"acceleration": 1.0}

STANDS_IN = {"velocity": "moment"}

GENTLEST, SHARPEST = 0.5, 4.0
"""Turns that are tried, as multiples of the gentlest one with equally large accelerations."""

STEPS = 12
"""Steps of the search between these; they leave 1 % of the turn."""

GAIN = 1e-3
"""What a turn between those tried must gain, as a fraction of the cost, to be taken."""

Rated = tuple[Law, Characteristic]

SLACK = 1e-9
"""A boundary value is met if its error is at most this fraction of the largest one."""

TIE = 1e-9
"""Costs that differ by less than this fraction are equal: where a turn decides the acceleration,
many laws share it."""

RUNS_BACK = 1e-9
"""A law overshoots if it leaves [0, 1] by more than this."""


def best_law(
    task: str,
    known: Mapping[str, float],
    parameters: Mapping[str, float],
    optimise: Mapping[str, float],
) -> Law:
    """The law for `task` that is best by `optimise` among those without jerk or shock.

    Parameters
    ----------
    task : "R-R" to "B-B".
    known : boundary values, normalised, "v0" to "a1".
    parameters : parameters stated by the designer; a family that does not take them is skipped.
    optimise : weights of velocity, acceleration, jerk, moment; each value counts as a multiple of
        the smallest that any law has. If empty, the acceleration alone.

    A law that overshoots is chosen only if all do. Of equal laws the first registered wins.
    """
    found = [law for name in FAMILIES for law in _candidates(name, task, known, parameters)]
    rated: Sequence[Rated] = [(law, characteristic(law)) for law in found]
    if not rated:
        raise GeometryError(
            f"no law for {task} with {_stated(parameters)} meets velocity and acceleration at"
            " both its ends; leave those out, or name a law, which then decides how sharply the"
            " motion turns",
            key=next(iter(parameters), "law"),
            value="auto",
        )
    rated = _tame(rated)
    costs = _costs(rated, optimise or DEFAULT)
    nearly = min(costs) * (1.0 + TIE)
    return next(law for (law, _), found in zip(rated, costs, strict=True) if found <= nearly)


@lru_cache(maxsize=64)
def best_turn(
    task: str, v0: float = 0.0, v1: float = 0.0, optimise: tuple[tuple[str, float], ...] = ()
) -> tuple[float, float] | None:
    """f'' at both ends of the law that is best by `optimise` with turns of any sharpness.

    Parameters
    ----------
    task : one with a turn, and none with general motion.
    v0, v1 : f' at the ends.
    optimise : as for `best_law`, in pairs. The moment stands in for the velocity, which is least
        with a turn as gentle or as sharp as it can be.

    Returns
    -------
    None if no law for the task has equally large accelerations, from which the search starts. From
    turn to turn both values are equal except for the sign.
    """
    if task[0] == "U" and task != "U-U":  # the mirror image
        mirrored = best_turn(f"{task[-1]}-U", v1, v0, optimise)
        return mirrored and (-mirrored[1], -mirrored[0])
    known = {"v0": v0, "v1": v1}
    own = [turn for name in FAMILIES if (turn := _own_turn(name, task, known))]
    if not own:
        return None
    middle = min(own, key=abs)
    weights: dict[str, float] = {}
    for name, weight in optimise or DEFAULT.items():
        weights[STANDS_IN.get(name, name)] = weights.get(STANDS_IN.get(name, name), 0.0) + weight

    def rated(name: str, turn: float) -> Sequence[Rated]:
        ends = {"a1": turn, **({"a0": -turn} if task == "U-U" else {})}
        return [(law, characteristic(law)) for law in _candidates(name, task, known | ends, {})]

    scale = _least([pair for name in FAMILIES for pair in rated(name, middle)], weights)

    def cost(name: str, turn: float) -> float:
        tame = [pair for pair in rated(name, turn) if not _overshoots(pair[1])]
        return min(_costs(tame, weights, scale), default=math.inf)

    best = min((cost(name, turn), turn) for name in FAMILIES for turn in own)
    for name in FAMILIES:
        if task in FAMILIES[name].tasks:
            turn = _lowest(partial(cost, name), GENTLEST * middle, SHARPEST * middle)
            found = cost(name, turn)
            if found < best[0] * (1.0 - GAIN):
                best = found, turn
    turn = best[1]
    return (-turn if task == "U-U" else 0.0), turn


def _own_turn(name: str, task: str, known: Mapping[str, float]) -> float | None:
    """f'' at the end of the law with equally large accelerations; None if there is none."""
    family = FAMILIES[name]
    if family.parts is None or task not in family.tasks:
        return None
    given = {key: value for key, value in known.items() if key in family.parameters[task]}
    try:
        place = equal_accelerations(name, task, given)
        return law_of(name, task, {**given, "inflection": place}).end.acceleration
    except GeometryError:
        return None


def _lowest(cost: Callable[[float], float], low: float, high: float) -> float:
    """Where `cost` is lowest between `low` and `high`, by golden-section search."""
    ratio = 0.5 * (math.sqrt(5.0) - 1.0)
    inner = [high - ratio * (high - low), low + ratio * (high - low)]
    costs = [cost(place) for place in inner]
    for _ in range(STEPS):
        if costs[0] <= costs[1]:
            high = inner[1]
            inner, costs = [high - ratio * (high - low), inner[0]], [0.0, costs[0]]
            costs[0] = cost(inner[0])
        else:
            low = inner[0]
            inner, costs = [inner[1], low + ratio * (high - low)], [costs[1], 0.0]
            costs[1] = cost(inner[1])
    return inner[0] if costs[0] <= costs[1] else inner[1]


def _tame(rated: Sequence[Rated]) -> Sequence[Rated]:
    """The laws that do not overshoot; all if each does."""
    return [pair for pair in rated if not _overshoots(pair[1])] or rated


def _least(rated: Sequence[Rated], weights: Mapping[str, float]) -> dict[str, float]:
    """The smallest value of each quantity that any law has."""
    return {name: min(size_of(values, name) for _, values in rated) for name in weights}


def _costs(
    rated: Sequence[Rated],
    weights: Mapping[str, float],
    least: Mapping[str, float] | None = None,
) -> list[float]:
    """Weighted sum of the values of each law, as multiples of the `least` ones."""
    least = least or _least(rated, weights)
    return [
        sum(
            weight * size_of(values, name) / least[name] if least[name] else 0.0
            for name, weight in weights.items()
        )
        for _, values in rated
    ]


def sizes_at(
    task: str, known: Mapping[str, float], optimise: Mapping[str, float]
) -> dict[str, float]:
    """Each criterion of the best law for `task` with these boundary values, see `best_law`."""
    values = characteristic(best_law(task, known, {}, optimise))
    return {name: size_of(values, name) for name in CRITERIA}


def size_of(values: Characteristic, name: str) -> float:
    """Largest magnitude of a quantity: "velocity", "acceleration", "jerk" or "moment"."""
    high, low = {
        "velocity": (values.velocity, values.least_velocity),
        "acceleration": (values.largest_acceleration, values.least_acceleration),
        "jerk": (values.largest_jerk, values.least_jerk),
        "moment": (values.largest_moment, values.least_moment),
    }[name]
    return max(abs(high.value), abs(low.value))


def _candidates(
    name: str, task: str, known: Mapping[str, float], parameters: Mapping[str, float]
) -> list[Law]:
    family = FAMILIES[name]
    if name == "polynomial" or task not in family.tasks:
        return []
    taken = family.parameters[task]
    if not parameters.keys() <= set(taken):
        return []
    given = {**parameters}
    given |= {key: known.get(key, 0.0) for key in taken if key[0] in "va" and key[1:] in ("0", "1")}
    try:
        if "inflection" in taken and "inflection" not in given and "U" not in task:
            if task != "R-R":
                given["inflection"] = equal_accelerations(name, task, given)
        elif "inflection" in given:
            given = {key: value for key, value in given.items() if key[0] != "a"}
        law = law_of(name, task, given)
    except GeometryError:
        return []
    return [law] if _fits(law, known) else []


def _fits(law: Law, known: Mapping[str, float]) -> bool:
    """Whether a law meets the boundary values and has no jump of the acceleration inside."""
    met = {
        "v0": law.start.velocity,
        "a0": law.start.acceleration,
        "v1": law.end.velocity,
        "a1": law.end.acceleration,
    }
    size = max(map(abs, known.values()), default=1.0)
    gaps = (abs(met[key] - known.get(key, 0.0)) for key in met)
    return max(gaps) <= SLACK * size and not acceleration_jumps(law)


def _overshoots(values: Characteristic) -> bool:
    return values.lift.value > 1.0 + RUNS_BACK or values.least_lift.value < -RUNS_BACK


def _stated(parameters: Mapping[str, float]) -> str:
    return ", ".join(f"{key} = {value:g}" for key, value in parameters.items()) or "none stated"
