"""Motion laws by name, one module a family. Registering a family here puts it under test."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Final

from camgeo.errors import GeometryError
from camgeo.motion.laws.characteristic import Characteristic, characteristic
from camgeo.motion.laws.double_harmonic import DOUBLE_HARMONIC
from camgeo.motion.laws.family import Family
from camgeo.motion.laws.harmonic_combination import HARMONIC_COMBINATION
from camgeo.motion.laws.inclined_sine import INCLINED_SINE
from camgeo.motion.laws.law import Law
from camgeo.motion.laws.modified_sine import MODIFIED_SINE
from camgeo.motion.laws.modified_trapezoid import MODIFIED_TRAPEZOID
from camgeo.motion.laws.polynomial_345 import POLYNOMIAL_345
from camgeo.motion.laws.polynomial_4567 import POLYNOMIAL_4567
from camgeo.motion.laws.polynomials import POLYNOMIAL, POLYNOMIAL_5, POLYNOMIAL_7
from camgeo.motion.laws.quadratic_parabola import QUADRATIC_PARABOLA
from camgeo.motion.laws.scca import SCCA
from camgeo.motion.laws.simple_sine import SIMPLE_SINE
from camgeo.motion.laws.sine_straight import SINE_STRAIGHT
from camgeo.motion.laws.straight_line import STRAIGHT_LINE
from camgeo.numeric import checked

__all__ = [
    "ALIASES",
    "BALANCES",
    "FAMILIES",
    "LARGEST",
    "LAWS",
    "Characteristic",
    "characteristic",
    "find_family",
    "law_of",
    "make_law",
]

FAMILIES: Final[dict[str, Family]] = {
    family.name: family
    for family in (
        STRAIGHT_LINE,
        QUADRATIC_PARABOLA,
        SIMPLE_SINE,
        POLYNOMIAL_345,
        POLYNOMIAL_4567,
        INCLINED_SINE,
        MODIFIED_TRAPEZOID,
        MODIFIED_SINE,
        SCCA,
        SINE_STRAIGHT,
        HARMONIC_COMBINATION,
        DOUBLE_HARMONIC,
        POLYNOMIAL_5,
        POLYNOMIAL_7,
        POLYNOMIAL,
    )
}

ALIASES: Final[dict[str, str]] = {"cycloidal": "inclined-sine"}

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
        If there is none; it tells which there are.
    """
    known = (*FAMILIES, *ALIASES)
    if not checked.among(name, known):
        names = ", ".join(known)
        raise GeometryError(f"there is no such law; there are {names}", "law", checked.shown(name))
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
    return replace(family.make(task, values), recipe=(law_of, (family.name, task, dict(values))))


def make_law(name: str, task: str = "R-R", /, **parameters: float) -> Law:
    """The law of that name for a motion task.

    Parameters
    ----------
    name : a family of `FAMILIES`, or an alias.
    task : "R-R" to "B-B", see `camgeo.motion.task`.
    parameters : those that the family takes for the task, normalised: `inflection` (lambda, as VDI
        2143-1 counts it: from the start of the move, but from its end for U-R and U-G), `v0`, `a0`,
        `j0`, `v1`, `a1`, `j1` (f', f'', f''' at the ends), `curved`, `sine`, `cosine`.

    Raises
    ------
    GeometryError
        If there is no such law, it is not made for the task, does not take a parameter, or a value
        is not possible; it tells which there are, and which values would do.
    """
    return law_of(name, task, parameters)


LAWS: Final[dict[str, Law]] = {
    name: law_of(name, "R-R", {})
    for name, family in FAMILIES.items()
    if "R-R" in family.tasks and "inflection" in family.parameters["R-R"]
}
"""The symmetric laws from rest to rest that have an inflection point to be shifted."""
