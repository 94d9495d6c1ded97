"""Motion laws by name, one module a family. Registering a family here puts it under test."""

from __future__ import annotations

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

__all__ = [
    "ALIASES",
    "FAMILIES",
    "LAWS",
    "Characteristic",
    "characteristic",
    "find_family",
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


def find_family(name: str) -> Family:
    """The family of that name or alias; KeyError if there is none."""
    return FAMILIES[ALIASES.get(name, name)]


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
        If there is no such law; it tells which there are, and which values would do.
    """
    try:
        family = find_family(name)
    except KeyError:
        names = ", ".join((*FAMILIES, *ALIASES))
        raise GeometryError(
            f"there is no such law; there are {names}", key="law", value=name
        ) from None
    return family.law(task, parameters)


LAWS: Final[dict[str, Law]] = {
    name: family.law("R-R", {})
    for name, family in FAMILIES.items()
    if "R-R" in family.tasks and "inflection" in family.parameters["R-R"]
}
"""The symmetric laws from rest to rest that have an inflection point to be shifted."""
