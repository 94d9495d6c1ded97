"""Motion laws of one motion task side by side (VDI 2143-1, Tafeln 2, 3 and 4, for any task)."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Final

from camgeo.errors import GeometryError
from camgeo.kinematics.laws import FAMILIES, LARGEST, build_law, find_family
from camgeo.kinematics.laws.law import (
    ROUNDING,
    Characteristic,
    Law,
    acceleration_jumps,
    characteristic,
)
from camgeo.kinematics.motion import TASKS, task_ends
from camgeo.numeric import checked

QUANTITIES: Final = (
    "velocity",
    "acceleration",
    "deceleration",
    "jerk",
    "braking_jerk",
    "moment",
    "braking_moment",
)
"""The characteristic values that are compared: C_v, C_a, C_a*, C_j, C_j*, C_Mdyn, C_Mdyn*."""

ZERO: Final = {"R": ("v", "a"), "G": ("a",), "U": ("v",), "B": ()}
"""The values that are zero at an end of each class: "v" velocity, "a" acceleration."""

MM2_PER_M2: Final = 1e6


@dataclass(frozen=True, slots=True)
class LawEntry:
    """One law of a comparison, or the reason why it does not exist.

    Attributes
    ----------
    name, task : the family and the motion task that were compared.
    law, values : the law and its characteristic values; None if `reason` says why there is none.
    shocks, jerks : ascending z at which f' (f'') jumps: at an end of the task R or U (R or G) where
        the law does not start or end with zero, and inside for f''.
    unbounded : those of `QUANTITIES` that are infinite because of a shock or jerk.
    ignored : stated parameters that the family does not take for the task.
    assumed : boundary values that the family takes, but that were not stated and are therefore 0.
    reason : why the law cannot be made; empty if it can.
    """

    name: str
    task: str
    law: Law | None = None
    values: Characteristic | None = None
    shocks: tuple[float, ...] = ()
    jerks: tuple[float, ...] = ()
    unbounded: frozenset[str] = frozenset()
    ignored: tuple[str, ...] = ()
    assumed: tuple[str, ...] = ()
    reason: str = ""

    @property
    def runs_back(self) -> bool:
        """Whether f' is negative somewhere."""
        values = self.values
        if values is None:
            return False
        return values.least_velocity.value < -ROUNDING * values.velocity.value

    @property
    def overshoots(self) -> bool:
        """Whether f leaves [0, 1]."""
        values = self.values
        if values is None:
            return False
        return values.lift.value > 1.0 + ROUNDING or values.least_lift.value < -ROUNDING

    def bounded(self, quantity: str) -> float | None:
        """The value of one of `QUANTITIES`; None if it is unbounded or there is no law."""
        if self.values is None or quantity in self.unbounded:
            return None
        value: float = getattr(self.values, quantity).value
        return value


@dataclass(frozen=True, slots=True)
class Running:
    """The speed, span and stroke of a move, by which the characteristic values are multiplied.

    Attributes
    ----------
    speed : omega of the cam, constant [rad/s], above 0.
    span : Phi, cam angle of the move [rad], above 0, at most a turn.
    stroke : S [mm], above 0.

    Raises
    ------
    GeometryError
        If one of them is not a number in its range.
    """

    speed: checked.Positive
    span: checked.Positive
    stroke: checked.Positive

    def __post_init__(self) -> None:
        checked.check_fields(self)
        if self.span > 2.0 * math.pi * (1.0 + ROUNDING):
            raise GeometryError(
                "cannot be more than one turn", key="span", value=f"{math.degrees(self.span):g}"
            )

    def physical(self, quantity: str, value: float) -> float:
        """The physical value of one of `QUANTITIES`, from its characteristic value.

        With k = omega/Phi (VDI 2143-1, eqs. (1) to (4) and (9) to (14) at constant omega): velocity
        S k C_v [mm/s], acceleration S k^2 C_a [mm/s^2], jerk S k^3 C_j [mm/s^3]. The torque at the
        camshaft against the inertia of a mass m on the follower, M = m a v/omega, is m C_Mdyn S^2
        omega^2/Phi^3; here for 1 kg [N m/kg], and 1 kg mm^2/s^2 is 1e-6 N m.
        """
        rate = self.speed / self.span
        if quantity.endswith("moment"):
            return value * self.stroke**2 * rate**2 / self.span / MM2_PER_M2
        order = {"velocity": 1, "acceleration": 2, "deceleration": 2, "jerk": 3, "braking_jerk": 3}
        return float(value * self.stroke * rate ** order[quantity])


def compare(
    task: str, parameters: Mapping[str, float], names: Sequence[str] = ()
) -> tuple[LawEntry, ...]:
    """Each family made for `task`, or those of `names`, with those of `parameters` that it takes.

    Parameters
    ----------
    task : one of `camgeo.kinematics.motion.TASKS`.
    parameters : parameters by the names that `make_law` takes.
    names : families or aliases, in the order to be listed; GeometryError if one is not known.
    """
    checked.one_of("task", task, TASKS)
    parameters = checked.by_name("parameters", parameters, LARGEST)
    checked.instances("names", names, (str,), "names of laws")
    families = [find_family(name) for name in dict.fromkeys(names)] or [
        family for family in FAMILIES.values() if task in family.tasks
    ]
    return tuple(_entry(family.name, task, parameters) for family in families)


def _entry(name: str, task: str, parameters: Mapping[str, float]) -> LawEntry:
    family = find_family(name)
    accepted = family.parameters.get(task, ())
    ignored = tuple(key for key in parameters if key not in accepted)
    accepted_values = {key: value for key, value in parameters.items() if key in accepted}
    try:
        law = build_law(name, task, accepted_values)
        entry = law_entry(law)
    except GeometryError as error:
        # An error about the task names the law already; that of a parameter needs its key and
        # value.
        prefix = f"{error.key} = {error.value}: " if error.value and error.key != "task" else ""
        return LawEntry(name, task, reason=f"{prefix}{error.message}")
    zero = (
        key
        for key in accepted
        if key[1:] in ("0", "1") and _is_zero(name, law, accepted_values, key)
    )
    return replace(entry, name=name, task=task, ignored=ignored, assumed=tuple(zero))


def law_entry(law: Law) -> LawEntry:
    """The entry of a single law, with all parameters that it was made with.

    Raises
    ------
    GeometryError
        As `characteristic`.
    """
    values, shocks = characteristic(law), _end_jumps(law, "v")
    jerks = tuple(sorted({*_end_jumps(law, "a"), *acceleration_jumps(law)}))
    unbounded = _unbounded(law, shocks, jerks)
    return LawEntry(law.name, law.task, law, values, shocks, jerks, unbounded)


def _is_zero(name: str, law: Law, accepted: Mapping[str, float], key: str) -> bool:
    """Whether the law has 0 for the boundary value `key` because it was not stated.

    An acceleration that follows from the inflection point is not 0, and the polynomial of free
    degree leaves values that are not stated open.
    """
    if key in accepted or name == "polynomial":
        return False
    end = law.start if key[1] == "0" else law.end
    return {"v": end.velocity, "a": end.acceleration, "j": end.jerk}[key[0]] == 0.0


def _end_jumps(law: Law, order: str) -> tuple[float, ...]:
    """z of the ends at which f' ("v") or f'' ("a") is not zero although the task requires it."""
    jumps = []
    for place, kind, end in zip((0.0, 1.0), task_ends(law.task), (law.start, law.end), strict=True):
        value = end.velocity if order == "v" else end.acceleration
        if order in ZERO[kind] and value != 0.0:
            jumps.append(place)
    return tuple(jumps)


def _unbounded(law: Law, shocks: tuple[float, ...], jerks: tuple[float, ...]) -> frozenset[str]:
    """The quantities that have no bound.

    A shock makes all but the velocity infinite, a jump of f'' the jerk, each in the part of the law
    where it lies. In a law without parts they concern both, as its values are those of the whole
    move.
    """
    quantities: set[str] = set()
    # After the velocity, values of the accelerating and of the decelerating part alternate.
    by_shock = (QUANTITIES[1::2], QUANTITIES[2::2])
    by_jerk = (("jerk",), ("braking_jerk",))
    for places, (first, second) in ((shocks, by_shock), (jerks, by_jerk)):
        for place in places:
            if law.inflection is None or place <= law.inflection:
                quantities.update(first)
            if law.inflection is None or place >= law.inflection:
                quantities.update(second)
    return frozenset(quantities)
