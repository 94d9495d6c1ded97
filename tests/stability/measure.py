"""A case of the stability suite and its measurements: error and conditioning in ulp.

A case has quantities at several places, in doubles and with many digits.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from mpmath import mp

from camgeo.errors import GeometryError
from camgeo.numeric.arrays import ComplexArray, FloatArray
from tests.stability.series import DIGITS, Number

Found = Callable[[FloatArray], tuple[FloatArray | ComplexArray, ...]]
Exact = Callable[..., tuple[Number, ...]]


@dataclass(frozen=True, slots=True, eq=False)
class Case:
    """Quantities of one law, table, linkage or cam at several places.

    The inputs are doubles, each taken as an exact number.

    Attributes
    ----------
    group : the part of the suite it belongs to, see `tests.stability.suite.GROUPS`.
    name : what is hard about it, in a few words.
    quantities : names of the computed quantities.
    places : (n,) the first input: z of a law, else the cam angle or the crank angle [rad]; for a
        root, a guess.
    parameters : the other inputs, in the order in which `exact` takes them.
    found : places (n,) -> an array (n,) for each quantity: what camgeo computes, real or complex.
    exact : place, parameters -> the quantities by formulas of their own, numbers of mpmath. Called
        with the inputs as they are, and with each in turn changed by half an ulp.
    """

    group: str
    name: str
    quantities: tuple[str, ...]
    places: tuple[float, ...]
    parameters: tuple[float, ...]
    found: Found
    exact: Exact


@dataclass(frozen=True, slots=True)
class Reading:
    """One quantity at one place.

    Attributes
    ----------
    quantity, group, case : what was computed, see `Case`.
    place : the place, z or cam angle [rad], or crank angle [rad] of a slotted lever.
    value : the exact value, rounded; the length of a vector.
    error : distance of camgeo's value from it [ulp]; infinite if camgeo gave none.
    conditioning : how far the exact value moves [ulp] if each input moves by half an ulp of its
        own: the sum over the inputs, one at a time.
    """

    quantity: str
    group: str
    case: str
    place: float
    value: float
    error: float
    conditioning: float

    @property
    def ratio(self) -> float:
        """Error over conditioning, or over 1 ulp where the conditioning is smaller."""
        return self.error / max(1.0, self.conditioning)

    @property
    def at(self) -> dict[str, float]:
        """The place under its name: z of a law, else the angle [deg] of the crank or the cam."""
        if self.group == "laws":
            return {"z": self.place}
        name = "crank" if self.group == "slotted-levers" else "cam"
        return {f"{name}_angle_deg": math.degrees(self.place)}


def measure(case: Case) -> tuple[Reading, ...]:
    """The readings of all quantities of a case, place by place.

    An ulp is that of the exact value, for a vector that of its length. Where rounding the inputs by
    half an ulp moves a value by more than its own magnitude, as near a zero, it is that of this
    movement.
    """
    found = _found(case)
    readings: list[Reading] = []
    with mp.workdps(DIGITS):
        for number, place in enumerate(case.places):
            inputs = [mp.mpf(value) for value in (place, *case.parameters)]
            exact = case.exact(*inputs)
            moved = [mp.mpf(0)] * len(exact)
            for index, value in enumerate((place, *case.parameters)):
                for total, change in enumerate(_changes(case, inputs, index, value, exact)):
                    moved[total] += change
            readings += [
                _reading(case, quantity, place, column[number], true, change)
                for quantity, column, true, change in zip(
                    case.quantities, found, exact, moved, strict=True
                )
            ]
    return tuple(readings)


def _found(case: Case) -> tuple[FloatArray | ComplexArray, ...]:
    """The values that camgeo computes; all NaN if it refuses the case."""
    try:
        return case.found(np.array(case.places))
    except GeometryError:
        return (np.full(len(case.places), math.nan),) * len(case.quantities)


def _changes(
    case: Case, inputs: list[Number], index: int, value: float, exact: tuple[Number, ...]
) -> list[Number]:
    """How far half an ulp of one input moves each quantity.

    At an end of its range, where one direction admits no mechanism, the other one counts.
    """
    half = mp.mpf(math.ulp(value)) / 2
    for step in (half, -half):
        changed = [*inputs]
        changed[index] += step
        try:
            moved = case.exact(*changed)
        except GeometryError:
            continue
        return [abs(new - old) for new, old in zip(moved, exact, strict=True)]
    raise GeometryError(f"{case.name}: no value of input {index} near {value!r} has a mechanism")


def _reading(
    case: Case, quantity: str, place: float, found: complex, true: Number, moved: Number
) -> Reading:
    size = float(abs(true))
    ulp = mp.mpf(math.ulp(max(size, float(moved))))
    reading = Reading(quantity, case.group, case.name, place, size, math.inf, float(moved / ulp))
    if not np.isfinite(found):
        return reading
    return replace(reading, error=float(abs(mp.mpmathify(found) - true) / ulp))
