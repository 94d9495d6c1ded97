"""What a scene says of the elastic train, and the train that follows from it."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Protocol

from camgeo.effects.effect import Request, Subject, demand_unit
from camgeo.errors import GeometryError
from camgeo.numeric.oscillator.train import Second, Train, one_mass, two_masses

TABLE = "effects.vibration"

FREQUENCY_KEYS = ("natural_frequency", "stiffness", "torsional_stiffness")


@dataclass(frozen=True, slots=True)
class Spec:
    """The table of the scene.

    Attributes
    ----------
    natural_frequency : of the first mass without the second [rad/s]; None if the stiffness says it.
    stiffness : at what makes the demanded motion [N/mm].
    torsional_stiffness : the same for a rocker without linkage [N mm/rad].
    damping : damping ratio.
    limit : largest error of the demanded motion [mm].
    limit_angle : the same for a rocker without linkage [rad].
    second : a second mass.
    """

    natural_frequency: float | None = None
    stiffness: float | None = None
    torsional_stiffness: float | None = None
    damping: float = 0.0
    limit: float | None = None
    limit_angle: float | None = None
    second: Second | None = None


class Inertia(Protocol):
    """What the effect `inertia` gives."""

    @property
    def moved(self) -> float:
        """What moves with the demanded motion [t or t mm^2]."""


def parse(table: Mapping[str, Any]) -> Spec:
    """From the table of the scene.

    Raises
    ------
    GeometryError
        If there is not exactly one of the keys that give the natural frequency, or it is zero.
    """
    given = [key for key in FREQUENCY_KEYS if table.get(key) is not None]
    if not given:
        raise GeometryError(
            "is missing, and so are stiffness and torsional_stiffness: one of the three is needed",
            key="natural_frequency",
        )
    if len(given) > 1:
        raise GeometryError(f"cannot stand beside {given[0]}: one of them is enough", key=given[1])
    if not table[given[0]] > 0.0:
        raise GeometryError(
            "must be above 0: nothing would move the follower", key=given[0], value="0"
        )
    second = table.get("second")
    return Spec(
        **{key: table.get(key) for key in (*FREQUENCY_KEYS, "limit", "limit_angle")},
        damping=table.get("damping", 0.0),
        second=None
        if second is None
        else Second(second["natural_frequency"], second["mass_ratio"], second.get("damping", 0.0)),
    )


def turns(subject: Subject) -> bool:
    """Whether the demanded motion is an angle."""
    return demand_unit(subject) == "rad"


def limit_of(subject: Subject, spec: Spec) -> float | None:
    """Largest error of the demanded motion that is allowed [mm or rad].

    Raises
    ------
    GeometryError
        If the limit is a length and the motion an angle, or the other way round.
    """
    _refuse(subject, spec.limit, "limit", angle=False)
    _refuse(subject, spec.limit_angle, "limit_angle", angle=True)
    return spec.limit_angle if turns(subject) else spec.limit


def train_of(request: Request) -> Train | None:
    """The elastic train; None if it is rigid, for there is no mass.

    With a stiffness k, w^2 = k / m for the mass m that [effects.inertia] gives. With a second mass
    m is both of them together, so that the first one is m / (1 + mass_ratio).

    Raises
    ------
    GeometryError
        If the stiffness is none of the demanded motion, or the masses are missing.
    """
    spec: Spec = request.spec
    _refuse(request.subject, spec.stiffness, "stiffness", angle=False)
    _refuse(request.subject, spec.torsional_stiffness, "torsional_stiffness", angle=True)
    frequency = spec.natural_frequency
    if frequency is None:
        stiffness = spec.stiffness if spec.stiffness is not None else spec.torsional_stiffness
        assert stiffness is not None  # `parse` refuses a table without
        inertia: Inertia | None = request.results.get("inertia")
        if inertia is None:
            raise GeometryError(
                "is missing: with a stiffness the natural frequency needs the masses",
                key="effects.inertia",
            )
        linkage = request.subject.linkage
        if inertia.moved == 0.0 and linkage is not None and linkage.member != "slider":
            raise GeometryError(
                "is missing: with a stiffness the natural frequency needs the moment of inertia at"
                " the far end of the linkage; or give natural_frequency",
                key="effects.inertia.output_moment",
            )
        if inertia.moved == 0.0:
            return None
        share = 1.0 if spec.second is None else 1.0 + spec.second.mass_ratio
        frequency = math.sqrt(share * stiffness / inertia.moved)
    if math.isinf(frequency):
        return None if spec.second is None else one_mass(spec.second.frequency, spec.second.damping)
    if spec.second is None:
        return one_mass(frequency, spec.damping)
    return two_masses(frequency, spec.damping, spec.second)


def _refuse(subject: Subject, value: float | None, key: str, *, angle: bool) -> None:
    if value is None or turns(subject) == angle:
        return
    motion, other = ("a length", "an angle") if angle else ("an angle", "a length")
    raise GeometryError(
        f"is for a demanded motion that is {other}; here it is {motion}", key=f"{TABLE}.{key}"
    )
