"""Sine-straight combination (Sinus-Gerade-Kombination) for U-U, VDI 2143-1 section 6.3.

Quarters of a cosine over c lambda and c (1 - lambda), eqs. (111) to (119), a straight line between
them; c = 1 is the simple sine.
"""

from __future__ import annotations

import math
from dataclasses import replace
from decimal import Decimal, localcontext

from camgeo.errors import GeometryError
from camgeo.kinematics.laws.family import (
    CURVED,
    Family,
    LawParameters,
    boundary_parameters,
    pulse_law,
    share,
)
from camgeo.kinematics.laws.law import Law
from camgeo.kinematics.laws.pulse import DIGITS, PI, Parts, law_of_two_pulses, sine_pulse

LEAST = math.pi**2 / 4.0
"""Least value of a0 |a1|/(a0 + |a1|), that of the simple sine."""

SINE_STRAIGHT_CURVED = replace(CURVED, default=0.5, always=False)
"""The option c. Its default, that of the guideline's Tafel 3, counts if neither c nor two
accelerations are stated."""


def _make(task: str, parameters: LawParameters) -> Law:
    values = dict(parameters)
    if "a0" in values and "a1" in values:
        place, curved = _from_accelerations(values)
        shape = {"inflection": float(place), "curved": curved}
        return law_of_two_pulses("sine-straight", task, _parts(task, shape), place, shape)
    if "inflection" in values and ("a0" in values or "a1" in values):
        values = _from_inflection(values)
    rest = {key: value for key, value in values.items() if key != "curved"}
    curved = values.get("curved", SINE_STRAIGHT_CURVED.default)
    return pulse_law("sine-straight", task, _parts(task, values), rest, curved=curved)


def _parts(_task: str, parameters: LawParameters) -> Parts:
    pulse = sine_pulse(Decimal(0), Decimal(0), share(parameters, SINE_STRAIGHT_CURVED))
    return Parts(pulse, pulse)


def _from_accelerations(parameters: dict[str, float]) -> tuple[Decimal, float]:
    """lambda = r/(1 + r) with r = |a1/a0| (eq. 127), and c, from the accelerations at both ends.

    lambda has 50 digits, because 1 - lambda determines a1 and may be tiny.
    """
    a0, a1 = parameters.pop("a0"), parameters.pop("a1")
    if not (a0 > 0.0 > a1):
        raise GeometryError(
            "a sine-straight combination accelerates first and then decelerates: a0 must be"
            " positive and a1 negative",
            key="acceleration",
            value=f"{a0:g}, {a1:g}",
        )
    if parameters:
        raise GeometryError(
            f"a0 and a1 already determine {' and '.join(parameters)}; leave out one or the other",
            key=next(iter(parameters)),
        )
    with localcontext(DIGITS):
        place = -Decimal(a1) / (Decimal(a0) - Decimal(a1))
        product = float(Decimal(a0) * place)
    return place, curved_for(product)


def _from_inflection(parameters: dict[str, float]) -> dict[str, float]:
    """lambda, and c from lambda and the acceleration at one end (eq. 130)."""
    inflection = parameters["inflection"]
    product = (
        parameters["a0"] * inflection
        if "a0" in parameters
        else -parameters["a1"] * (1.0 - inflection)
    )
    if "curved" in parameters:
        raise GeometryError(
            "inflection and acceleration already determine curved; leave out one of them",
            key="curved",
        )
    return {"inflection": inflection, "curved": curved_for(product)}


def curved_for(product: float) -> float:
    """c from lambda C_a, or from (1 - lambda)|C_a*| (eq. (130), restored).

    Raises GeometryError below pi^2/4, which the simple sine has.
    """
    if not product >= LEAST:
        raise GeometryError(
            "no sine-straight combination reverses as gently as this: inflection times the"
            f" normalised acceleration is {product:.6g}, but must be at least pi^2/4 = {LEAST:.6g}",
            key="acceleration",
            value=f"{product:.6g}",
        )
    with localcontext(DIGITS):
        k = PI - 2
        # The smaller root, without cancellation: k c^2 - pi c + pi^2/(2 product) = 0.
        square = PI * PI * (1 - 2 * k / Decimal(product))
        return min(1.0, float(PI * PI / Decimal(product) / (PI + square.sqrt())))


FAMILY = Family(
    "sine-straight",
    {"U-U": ("inflection", "curved", *boundary_parameters("U-U"))},
    _make,
    _parts,
    (SINE_STRAIGHT_CURVED,),
)
