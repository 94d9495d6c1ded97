"""Motion laws by name: a family is registered here by its name in `REGISTERED` alone."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import lru_cache
from importlib import import_module
from typing import Final

from camgeo.errors import GeometryError, meant
from camgeo.motion.laws import fixed_pulses, polynomials
from camgeo.motion.laws.family import Family, Option
from camgeo.motion.laws.law import Law
from camgeo.numeric import checked

REGISTERED: Final = (
    "straight-line",
    "quadratic-parabola",
    "simple-sine",
    "polynomial-345",
    "polynomial-4567",
    "inclined-sine",
    "modified-trapezoid",
    "modified-sine",
    "scca",
    "sine-straight",
    "harmonic-combination",
    "double-harmonic",
    "polynomial-5",
    "polynomial-7",
    "polynomial",
)
"""Names of the families. Each is the `FAMILY` of the module of its name, or is in a table of
families that differ by a few numbers."""

TABLED: Final = {family.name: family for family in (*fixed_pulses.FAMILIES, *polynomials.FAMILIES)}

FAMILIES: Final[dict[str, Family]] = {
    name: TABLED.get(name) or import_module(f"{__name__}.{name.replace('-', '_')}").FAMILY
    for name in REGISTERED
}

ALIASES: Final[dict[str, str]] = {
    alias: name for name, family in FAMILIES.items() for alias in family.aliases
}

OPTIONS: Final[dict[str, Option]] = {
    option.name: option for family in FAMILIES.values() for option in family.options
}
"""The parameters specific to families, by name; their defaults are the families'."""

BALANCES: Final = ("acceleration", "jerk", "moment")
"""Quantities of which both parts of a law can have the same extreme, see
`camgeo.motion.laws.balance`."""

LARGEST: Final = 1e50
"""Largest magnitude of a parameter: the velocity of the steepest scene, as a part of the smallest
stroke, has 1e42. Values of a law with larger ones overflow."""


def find_family(name: str) -> Family:
    """The family of that name or alias.

    Raises
    ------
    GeometryError
        If there is none; the message suggests a name, or lists them all.
    """
    known = (*FAMILIES, *ALIASES)
    if not checked.among(name, known):
        hint = meant(str(name), known) or f"there are {', '.join(known)}"
        raise GeometryError(f"is not a motion law; {hint}", "law", checked.shown(name))
    return FAMILIES[ALIASES.get(name, name)]


def law_of(name: str, task: str, given: Mapping[str, float]) -> Law:
    """The law of that name for a motion task, with the parameters `given`, see `make_law`."""
    family = find_family(name)
    if not checked.among(task, family.parameters):
        tasks = ", ".join(family.tasks)
        raise GeometryError(f"{family.name} is made for {tasks}", "task", checked.shown(task))
    taken = family.parameters[task]
    values = checked.by_name("parameters", given, LARGEST)
    for key in values:
        if key not in taken:
            known = ", ".join(taken) or "none"
            raise GeometryError(
                f"{family.name} for {task} takes no {key}; its parameters: {known}",
                key=key,
                value=repr(values[key]),
            )
    return _made(family.name, task, tuple(values.items()))


@lru_cache(maxsize=256)
def _made(name: str, task: str, values: tuple[tuple[str, float], ...]) -> Law:
    """The law itself: the moves of a plan and of its variants share a few laws."""
    given = dict(values)
    return replace(FAMILIES[name].make(task, given), recipe=(law_of, (name, task, given)))


def make_law(name: str, task: str = "R-R", /, **parameters: float) -> Law:
    """The law of that name for a motion task.

    Parameters
    ----------
    name : a family of `FAMILIES`, or an alias.
    task : "R-R" to "B-B", see `camgeo.motion.boundary`.
    parameters : those that the family takes for the task, normalised: `inflection` (lambda, as VDI
        2143-1 counts it: from the start of the move, but from its end for U-R and U-G), `v0`, `a0`,
        `j0`, `v1`, `a1`, `j1` (f', f'', f''' at the ends), `curved`, `sine`, `cosine`.

    Raises
    ------
    GeometryError
        If there is no such law, it is not made for the task, does not take a parameter, or a value
        is not possible; the message states which exist, and which values would do.
    """
    return law_of(name, task, parameters)
