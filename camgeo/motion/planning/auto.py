"""`law = "auto"`: the law of a move, chosen by its task and the quantities to keep small."""

from __future__ import annotations

from collections.abc import Mapping

from camgeo.errors import GeometryError
from camgeo.motion.laws import FAMILIES, law_of
from camgeo.motion.laws.balance import equal_accelerations
from camgeo.motion.laws.characteristic import Characteristic, acceleration_jumps, characteristic
from camgeo.motion.laws.law import Law

DEFAULT: Mapping[str, float] = {"acceleration": 1.0}

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
    rated = [(law, characteristic(law)) for law in found]
    if not rated:
        raise GeometryError(
            f"no law for {task} with {_stated(parameters)} meets velocity and acceleration at"
            " both its ends; leave those out, or name a law, which then decides how sharply the"
            " motion turns",
            key=next(iter(parameters), "law"),
            value="auto",
        )
    tame = [pair for pair in rated if not _overshoots(pair[1])]
    rated = tame or rated
    weights = optimise or DEFAULT
    least = {name: min(size_of(values, name) for _, values in rated) for name in weights}

    def cost(pair: tuple[Law, Characteristic]) -> float:
        return sum(
            weight * size_of(pair[1], name) / least[name] if least[name] else 0.0
            for name, weight in weights.items()
        )

    costs = [cost(pair) for pair in rated]
    nearly = min(costs) * (1.0 + TIE)
    return next(law for (law, _), found in zip(rated, costs, strict=True) if found <= nearly)


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
