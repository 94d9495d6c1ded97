"""Motion laws by name: a family is registered here by its name in `REGISTERED` alone."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from decimal import Decimal
from functools import lru_cache
from importlib import import_module
from typing import Final

from camgeo.errors import GeometryError, meant
from camgeo.kinematics.laws.family import (
    Family,
    LawParameters,
    Option,
    boundary_parameters,
    pulse_law,
)
from camgeo.kinematics.laws.law import Law
from camgeo.kinematics.laws.polynomials import FAMILIES as POLYNOMIALS
from camgeo.kinematics.laws.pulse import Parts, Pulse, sine_pulse
from camgeo.numeric import checked

# -- fixed pulses ---------------------------------------------------------------------------------
# Laws of two pulses whose only parameter of their own is the inflection point.
#
# The sines are of the SCCA family, see `camgeo.kinematics.laws.pulse.sine_pulse`.


def _sines(sine: str, constant: str, cosine: str) -> Pulse:
    return sine_pulse(Decimal(sine), Decimal(constant), Decimal(cosine))


def pulse_family(
    name: str, shapes: Mapping[str, tuple[Pulse, Pulse]], aliases: tuple[str, ...] = ()
) -> Family:
    """A family of two fixed pulses for each task, with the place of the inflection point.

    Its parameters are `inflection`; v0 and v1 for ends with constant velocity; and a0 or a1, the
    desired acceleration at an end with a reversal, which then determines the inflection.
    """

    def parts(task: str, parameters: LawParameters) -> Parts:
        first, second = shapes[task]
        return Parts(first, second, parameters.get("v0", 0.0), parameters.get("v1", 0.0))

    def make(task: str, parameters: LawParameters) -> Law:
        return pulse_law(name, task, parts(task, parameters), parameters)

    parameters = {task: ("inflection", *boundary_parameters(task)) for task in shapes}
    return Family(name, parameters, make, parts, aliases=aliases)


CONSTANT = _sines("0", "1", "0")
COSINE = _sines("0", "0", "1")
WHOLE_SINE = _sines("0.5", "0", "0.5")
TRAPEZOID = _sines("0.25", "0.5", "0.25")
TRAPEZOID_TURN = _sines("0", "0.75", "0.25")
MODIFIED = _sines("0.25", "0", "0.75")

PARABOLA = Pulse.polynomial((0, 2, -3, 1))
"""a = x (1 - x)(2 - x): f'' = 60 z (1 - z)(1 - 2 z) with z = x/2."""

QUARTIC = Pulse.polynomial((0, 0, 4, -8, 5, -1))
"""a = x^2 (2 - x)^2 (1 - x): f'' = 420 z^2 (1 - z)^2 (1 - 2 z) with z = x/2."""

PULSE_FAMILIES: Final[tuple[Family, ...]] = (
    # Quadratic parabola (Quadratische Parabel), VDI 2143-1 eqs. (24) to (29): constant
    # acceleration, the smallest of all laws from rest to rest, with three jerks.
    pulse_family("quadratic-parabola", {"R-R": (CONSTANT, CONSTANT)}),
    # Simple sine (Einfache Sinuslinie), VDI 2143-1 eqs. (30) to (32) and section 6.3.2. From
    # reversal to reversal it is free of jerks; from rest to rest f'' jumps at both ends.
    pulse_family("simple-sine", dict.fromkeys(("R-R", "U-U"), (COSINE, COSINE))),
    # 3-4-5 polynomial (Polynom 5. Grades), VDI 2143-1 eqs. (33) to (35).
    pulse_family("polynomial-345", {"R-R": (PARABOLA, PARABOLA)}),
    # 4-5-6-7 polynomial: f = 35 z^4 - 84 z^5 + 70 z^6 - 20 z^7, with f''' = 0 at both ends: the
    # 3-4-5 polynomial with the jerk continuous at the rests too (R. L. Norton, Cam Design and
    # Manufacturing Handbook, section 3.5).
    pulse_family("polynomial-4567", {"R-R": (QUARTIC, QUARTIC)}),
    # Inclined sine, cycloidal (Geneigte Sinuslinie, Helling-Bestehorn), VDI 2143-1 (36) to (38).
    pulse_family("inclined-sine", {"R-R": (WHOLE_SINE, WHOLE_SINE)}, aliases=("cycloidal",)),
    # Modified acceleration trapezoid (Modifiziertes Beschleunigungstrapez). From rest to rest VDI
    # 2143-1 eqs. (39) to (56), from rest to reversal (151) to (180), from reversal to rest its
    # mirror image (203) to (205).
    pulse_family(
        "modified-trapezoid",
        {
            "R-R": (TRAPEZOID, TRAPEZOID),
            "R-U": (TRAPEZOID, TRAPEZOID_TURN),
            "U-R": (TRAPEZOID_TURN, TRAPEZOID),
        },
    ),
    # Modified sine (Modifizierte Sinuslinie, Neklutin). From rest to rest VDI 2143-1 eqs. (57) to
    # (65), between two constant velocities (82) to (110), with the amplitudes that are lost in
    # print; section 6.5 for one constant velocity and a rest.
    pulse_family(
        "modified-sine", dict.fromkeys(("R-R", "G-G", "R-G", "G-R"), (MODIFIED, MODIFIED))
    ),
    # Harmonic combination (Harmonische Kombination): sines first, then a quarter of a cosine to the
    # reversal. From rest to reversal VDI 2143-1 eqs. (181) to (202), from constant velocity to
    # reversal (206) to (224); the mirror images for the way back (sections 6.6.3 and 6.8.2).
    pulse_family(
        "harmonic-combination",
        {
            **dict.fromkeys(("R-U", "G-U"), (MODIFIED, COSINE)),
            **dict.fromkeys(("U-R", "U-G"), (COSINE, MODIFIED)),
        },
    ),
)


# -- laws -----------------------------------------------------------------------------------------


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

TABLED: Final = {family.name: family for family in (*PULSE_FAMILIES, *POLYNOMIALS)}

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
`camgeo.kinematics.planning.build`."""

LARGEST: Final = 1e50
"""Largest magnitude of a parameter. The velocity of the steepest scene, as a multiple of the
smallest stroke, is 1e42; with parameters above this limit the values of a law overflow."""


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
        raise GeometryError(f"is not a motion law; {hint}", "law", checked.value_text(name))
    return FAMILIES[ALIASES.get(name, name)]


def build_law(name: str, task: str, parameters: Mapping[str, float]) -> Law:
    """The law of that name for a motion task; parameters and errors are those of `make_law`."""
    family = find_family(name)
    if not checked.among(task, family.parameters):
        tasks = ", ".join(family.tasks)
        raise GeometryError(f"{family.name} is made for {tasks}", "task", checked.value_text(task))
    accepted = family.parameters[task]
    values = checked.by_name("parameters", parameters, LARGEST)
    for key in values:
        if key not in accepted:
            known = ", ".join(accepted) or "none"
            raise GeometryError(
                f"{family.name} for {task} takes no {key}; its parameters: {known}",
                key=key,
                value=repr(values[key]),
            )
    return _cached_law(family.name, task, tuple(values.items()))


@lru_cache(maxsize=256)
def _cached_law(name: str, task: str, values: tuple[tuple[str, float], ...]) -> Law:
    """The law with these checked values, cached: the moves of a plan and of its variants share a
    few laws.
    """
    parameters = dict(values)
    return replace(
        FAMILIES[name].make(task, parameters), recipe=(build_law, (name, task, parameters))
    )


def make_law(name: str, task: str = "R-R", /, **parameters: float) -> Law:
    """The law of that name for a motion task.

    Parameters
    ----------
    name : a family of `FAMILIES`, or an alias.
    task : "R-R" to "B-B", see `camgeo.kinematics.motion`.
    parameters : those that the family takes for the task, normalised: `inflection` (lambda, as VDI
        2143-1 counts it: from the start of the move, but from its end for U-R and U-G), `v0`, `a0`,
        `j0`, `v1`, `a1`, `j1` (f', f'', f''' at the ends), `curved`, `sine`, `cosine`.

    Raises
    ------
    GeometryError
        If there is no such law, if it is not made for the task or does not take a parameter, or if
        a value is not possible; the message states what exists and which values are possible.
    """
    return build_law(name, task, parameters)
