"""Motion laws by name, one module each. Registering a law here is what puts it under test."""

from __future__ import annotations

from typing import Final

from camgeo.motion.laws.inclined_sine import INCLINED_SINE
from camgeo.motion.laws.law import HalfLaw, Law, symmetric
from camgeo.motion.laws.modified_sine import MODIFIED_SINE
from camgeo.motion.laws.modified_trapezoid import MODIFIED_TRAPEZOID
from camgeo.motion.laws.polynomial_345 import POLYNOMIAL_345
from camgeo.motion.laws.quadratic_parabola import QUADRATIC_PARABOLA
from camgeo.motion.laws.simple_sine import SIMPLE_SINE
from camgeo.motion.laws.straight_line import STRAIGHT_LINE

HALVES: Final[dict[str, HalfLaw]] = {
    half.name: half
    for half in (
        STRAIGHT_LINE,
        QUADRATIC_PARABOLA,
        SIMPLE_SINE,
        POLYNOMIAL_345,
        INCLINED_SINE,
        MODIFIED_TRAPEZOID,
        MODIFIED_SINE,
    )
}

LAWS: Final[dict[str, Law]] = {name: symmetric(half) for name, half in HALVES.items()}
"""The symmetric laws from rest to rest (task R-R)."""

ALIASES: Final[dict[str, str]] = {"cycloidal": "inclined-sine"}


def find_law(name: str) -> Law:
    """Return the law of that name or alias; KeyError if there is none."""
    return LAWS[ALIASES.get(name, name)]
