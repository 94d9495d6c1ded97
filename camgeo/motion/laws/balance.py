"""The inflection point that makes an extreme of both parts of a law equal: the inverse relations.

VDI 2143-1 gives lambda for equal accelerations, equal jerks and equal dynamic moments of some laws
as numbers (sections 6.6.1 and 6.6.2); here it is computed for each law with an inflection point.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from decimal import localcontext
from typing import Final

import numpy as np

from camgeo.errors import GeometryError
from camgeo.motion.laws import BALANCES, LARGEST, find_family, law_of
from camgeo.motion.laws.characteristic import Characteristic, characteristic
from camgeo.motion.laws.family import COUNTED_FROM_END
from camgeo.motion.laws.pulse import DIGITS
from camgeo.motion.laws.two_pulses import Parts
from camgeo.numeric import checked
from camgeo.numeric.arrays import FloatArray
from camgeo.numeric.roots import bracketed_roots

Given = Mapping[str, float]

NEAREST: Final = 1e-6
"""How near to 0 and 1 an inflection point is sought."""

TINY: Final = 1e-300
"""Stands in for a part without acceleration when a logarithm is taken."""


def equal_accelerations(name: str, task: str, given: Given) -> float:
    """lambda, as VDI 2143-1 counts it, at which |C_a| = |C_a*|, from a quadratic.

    Parameters
    ----------
    name, task : a law with an inflection point, see `camgeo.motion.laws.make_law`.
    given : its other parameters.

    Raises
    ------
    GeometryError
        If the law has no inflection point, or none makes them equal.
    """
    place = _parts(name, task, given).inflection_for_equal_accelerations()
    with localcontext(DIGITS):
        return float(1 - place if task in COUNTED_FROM_END else place)


def balanced(name: str, task: str, quantity: str, given: Given) -> float:
    """lambda at which both parts have the same largest acceleration, jerk or dynamic moment.

    Parameters
    ----------
    quantity : one of `BALANCES`.

    Raises
    ------
    GeometryError
        If the law has no inflection point, or none makes them equal.
    """
    if checked.one_of("quantity", quantity, BALANCES) == "acceleration":
        return equal_accelerations(name, task, given)

    def difference(places: FloatArray) -> FloatArray:
        laws = (law_of(name, task, {**given, "inflection": float(lam)}) for lam in places)
        return np.array([_log_ratio(characteristic(law), quantity) for law in laws])

    # Of either part what is compared grows beyond all bounds where it is short: the range is a
    # bracket, and any place where they are equal is an answer.
    ends = np.array([NEAREST, 1.0 - NEAREST])
    low, high = difference(ends)
    if low * high >= 0.0:  # without jerk both parts are alike everywhere
        raise GeometryError(
            f"no inflection point makes the {quantity} equal in both parts of {name} for {task}",
            key="inflection",
        )
    return float(bracketed_roots(difference, ends[:1], ends[1:])[0])


def _parts(name: str, task: str, given: Given) -> Parts:
    """The parts of a law whose inflection point is sought."""
    family = find_family(name)
    if family.parts is None:
        raise GeometryError(f"{name} has no inflection point", key="inflection")
    return family.parts(
        checked.one_of("task", task, family.tasks), checked.by_name("parameters", given, LARGEST)
    )


def _log_ratio(values: Characteristic, quantity: str) -> float:
    first, second = {
        "jerk": (values.jerk, values.braking_jerk),
        "moment": (values.moment, values.braking_moment),
    }[quantity]
    return math.log(max(abs(first.value), TINY)) - math.log(max(abs(second.value), TINY))
