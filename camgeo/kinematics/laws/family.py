"""Families of motion laws: a family is one shape with parameters, for one or more motion tasks."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from decimal import Decimal, localcontext
from typing import Any, Final

from camgeo.errors import GeometryError
from camgeo.kinematics.laws.law import Law
from camgeo.kinematics.laws.pulse import DIGITS, Parts, law_of_two_pulses
from camgeo.numeric.checked import SMALLEST

LawParameters = Mapping[str, float]

COUNTED_FROM_END: Final = ("U-R", "U-G")
"""Tasks whose lambda VDI 2143-1 counts from the end of the move (sections 6.6.3 and 6.8.2)."""


@dataclass(frozen=True, slots=True)
class Option:
    """A parameter specific to a family, as a scene and `camgeo laws` take it.

    Attributes
    ----------
    name : key of a scene, and of the command line.
    symbol : its name in formulas and tables.
    text : its description, without the families that have it.
    schema : node of the JSON Schema that its values meet.
    default : its value where nothing else decides it.
    always : whether it has the default whenever it is omitted; otherwise other parameters may
        determine it.
    """

    name: str
    symbol: str
    text: str
    schema: Mapping[str, Any]
    default: float
    always: bool = True


CURVED: Final = Option(
    name="curved",
    symbol="c",
    text="part of the span that is not run at constant velocity, above 0 to 1",
    schema={
        "type": "number",
        "minimum": 1e-6,
        "maximum": 1,
        "x-allowed": "must be a number above 0 to 1 (from 1e-6), a part of the span",
    },
    default=1.0,
)
"""Squeezes the accelerations to both ends of the move."""


@dataclass(frozen=True, slots=True)
class Family:
    """A family of laws.

    Attributes
    ----------
    name : as written in a scene.
    parameters : by the tasks that the family is made for, the names of the parameters it takes.
    make : task, parameters -> law. The caller passes only names that the family takes, and numbers;
        `make` checks whether these are possible.
    parts : task, parameters -> the two pulses and their end velocities; None if the laws of the
        family do not consist of two pulses.
    options : its parameters that are neither the inflection point nor boundary values.
    aliases : its other names.
    """

    name: str
    parameters: Mapping[str, tuple[str, ...]]
    make: Callable[[str, LawParameters], Law]
    parts: Callable[[str, LawParameters], Parts] | None = None
    options: tuple[Option, ...] = ()
    aliases: tuple[str, ...] = ()

    @property
    def tasks(self) -> tuple[str, ...]:
        """The motion tasks that it is made for."""
        return tuple(self.parameters)


def boundary_parameters(task: str, orders: str = "va") -> tuple[str, ...]:
    """Names of the boundary values that the classes of both ends of `task` leave open.

    These are "v0", "a0", "v1", "a1" where velocity or acceleration need not be 0. A jerk is
    always free, so `orders` with "j" give "j0" and "j1" too.
    """
    names = []
    for end, number in ((task[0], "0"), (task[-1], "1")):
        free = {"R": "", "G": "v", "U": "a", "B": "va"}[end]
        names += [order + number for order in orders if order in free or order == "j"]
    return tuple(names)


def pulse_law(name: str, task: str, parts: Parts, parameters: LawParameters, **also: float) -> Law:
    """The law of two pulses whose inflection point `parameters` state, or determine by a0 or a1.

    `also` are the parameters that shaped the pulses; the law lists them with its own.
    """
    wanted = [key for key in ("inflection", "a0", "a1") if key in parameters]
    if len(wanted) > 1:
        raise GeometryError(
            f"{' and '.join(wanted)} each determine the inflection point; state only one of them",
            key=wanted[0],
            value=repr(parameters[wanted[0]]),
        )
    if "a0" in parameters:
        place = parts.inflection_for_start(parameters["a0"])
    elif "a1" in parameters:
        place = parts.inflection_for_end(parameters["a1"])
    else:
        place = inflection_point(task, parameters.get("inflection", 0.5))
    with localcontext(DIGITS):
        stated = 1 - place if task in COUNTED_FROM_END else place
    speeds = {key: parameters[key] for key in ("v0", "v1") if key in parameters}
    listed = {"inflection": float(stated), **also, **speeds}
    return law_of_two_pulses(name, task, parts, place, listed)


def inflection_point(task: str, stated: float) -> Decimal:
    """z of the inflection point, with 50 digits.

    `stated` is lambda, which VDI 2143-1 counts from the start of the move, but from its end for the
    tasks of `COUNTED_FROM_END`.
    """
    if not SMALLEST <= stated < 1.0:
        raise GeometryError(
            f"the inflection point must lie strictly between 0 and 1 (from {SMALLEST:g}); at its"
            " limits the acceleration would be infinite",
            key="inflection",
            value=repr(stated),
        )
    with localcontext(DIGITS):
        return 1 - Decimal(stated) if task in COUNTED_FROM_END else Decimal(stated)


def share(parameters: LawParameters, option: Option) -> Decimal:
    """The value of `option`, a fraction of 1, above 0 if its schema requires that; its default if
    `parameters` do not state it.
    """
    value = parameters.get(option.name, option.default)
    positive = option.schema["minimum"] > 0
    if not (SMALLEST <= value <= 1.0 or (value == 0.0 and not positive)):
        lowest = f"above 0 (from {SMALLEST:g})" if positive else f"at 0, or from {SMALLEST:g}"
        raise GeometryError(f"must lie {lowest} to 1", key=option.name, value=repr(value))
    return Decimal(value)
