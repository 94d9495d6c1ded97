"""SCCA laws: sine, constant, cosine acceleration, one family with two shares.

Of the half span, `sine` (b) is a quarter of a sine, `cosine` (d) a quarter of a cosine, and the
remainder constant acceleration (R. L. Norton, Cam Design and Manufacturing Handbook, section 3.7):
b = 1/4, d = 1/4 is the modified trapezoid, 1/4 and 3/4 the modified sine, 1/2 and 1/2 the inclined
sine, 0 and 0 the parabola, 0 and 1 the simple sine. `curved` (c) below 1 gives the variants with
constant velocity: the acceleration is squeezed into the outer c of the span, the middle 1 - c runs
straight.
"""

from __future__ import annotations

from decimal import Decimal, localcontext

from camgeo.errors import GeometryError
from camgeo.kinematics.laws.family import CURVED, Family, LawParameters, Option, pulse_law, share
from camgeo.kinematics.laws.law import Law
from camgeo.kinematics.laws.pulse import DIGITS, Parts, sine_pulse

PART_OF_ONE = {"type": "number", "minimum": 0, "maximum": 1}

SINE = Option(
    "sine", "b", "part of each half that is a quarter of a sine", PART_OF_ONE, default=0.25
)
COSINE = Option(
    "cosine",
    "d",
    "part of each half that is a quarter of a cosine, at most 1 - sine, the rest being constant"
    " acceleration",
    PART_OF_ONE,
    default=0.75,
)
OPTIONS = (SINE, COSINE, CURVED)
"""Their defaults make the modified sine."""

ROUNDING = Decimal("1e-15")
"""Largest rounding of the sum of two shares that add up to 1 as decimals, such as 0.1 and 0.9."""


def _shares(parameters: LawParameters) -> tuple[Decimal, Decimal, Decimal]:
    """Shares of sine, constant and cosine, which add up to 1."""
    sine, cosine = share(parameters, SINE), share(parameters, COSINE)
    constant = 1 - sine - cosine
    if constant < -ROUNDING:
        raise GeometryError(
            "the shares of sine and cosine add up to more than 1",
            key="sine",
            value=f"{float(sine):g} + {float(cosine):g}",
        )
    # Without a constant stretch the cosine takes all that the sine leaves, so that no sliver
    # remains.
    if constant < ROUNDING:
        return sine, Decimal(0), 1 - sine
    return sine, constant, cosine


def _parts(_task: str, parameters: LawParameters) -> Parts:
    curved = share(parameters, CURVED)
    with localcontext(DIGITS):
        pulse = sine_pulse(*(part * curved for part in _shares(parameters)))
    return Parts(pulse, pulse)


def _make(task: str, parameters: LawParameters) -> Law:
    shares = {option.name: parameters.get(option.name, option.default) for option in OPTIONS}
    rest = {key: value for key, value in parameters.items() if key == "inflection"}
    return pulse_law("scca", task, _parts(task, parameters), rest, **shares)


FAMILY = Family("scca", {"R-R": ("inflection", "sine", "cosine", "curved")}, _make, _parts, OPTIONS)
