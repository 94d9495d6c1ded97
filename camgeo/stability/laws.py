"""Cases of the motion laws from rest to rest: everywhere, near their ends, strongly shifted."""

from __future__ import annotations

from typing import Final

from camgeo.motion.laws import make_law
from camgeo.motion.laws.law import Law
from camgeo.numeric.arrays import FloatArray
from camgeo.stability.case import Case, Found
from camgeo.stability.high_precision import Number
from camgeo.stability.lifts import HALVES, lift, scca_lift, septic_lift
from camgeo.stability.series import Series, variable

GROUP: Final = "laws"

QUANTITIES: Final = ("f", "1 - f", "f'", "f''", "f'''")

NEAR: Final = 1e-12
"""Distance from the ends: there the polynomials are 1e-35 and less."""

SHIFTS: Final = (0.5, 0.3, 1e-6, 1.0 - 1e-6)
"""lambda: symmetric, moderate, and hard case HC13 with its mirror image."""

SHARES: Final = (NEAR, 0.07, 0.19, 0.42, 0.63, 0.91, 1.0 - NEAR)
"""Places as shares of a half, or of the whole; none is a border of a law."""

TERMS: Final = 4


def cases() -> tuple[Case, ...]:
    """All cases of this module."""
    shifted = [_shifted(name, inflection) for name in HALVES for inflection in SHIFTS]
    shared = [_scca(0.3, 0.2), _scca(0.25, 0.75)]
    return (*shifted, *shared, _septic(20.0, -30.0), _septic(-50.0, 0.0))


def _shifted(name: str, inflection: float) -> Case:
    def exact(z: Number, lam: Number) -> tuple[Number, ...]:
        return _values(*lift(name, *_both(z), lam))

    law = make_law(name, "R-R", inflection=inflection)
    halves = [share * inflection for share in SHARES]
    halves += [inflection + share * (1.0 - inflection) for share in SHARES]
    places = tuple(z for z in halves if 0.0 < z < 1.0 and z != inflection)
    label = f"{inflection:g}" if inflection < 0.9 else f"1 - {1.0 - inflection:.0e}"
    return Case(
        GROUP, f"{name}, lambda {label}", QUANTITIES, places, (inflection,), _found(law), exact
    )


def _scca(sine: float, cosine: float) -> Case:
    def exact(z: Number, b: Number, d: Number) -> tuple[Number, ...]:
        at, rest = _both(z)
        return _values(scca_lift(at, rest, b, d), scca_lift(rest, at, b, d))

    law = make_law("scca", "R-R", sine=sine, cosine=cosine)
    name = f"scca, b {sine:g}, d {cosine:g}"
    return Case(GROUP, name, QUANTITIES, SHARES, (sine, cosine), _found(law), exact)


def _septic(j0: float, j1: float) -> Case:
    def exact(z: Number, jerk_start: Number, jerk_end: Number) -> tuple[Number, ...]:
        f = septic_lift(*_both(z), jerk_start, jerk_end)
        return _values(f, 1 - f)

    law = make_law("polynomial-7", "R-R", j0=j0, j1=j1)
    name = f"polynomial-7, j0 {j0:g}, j1 {j1:g}"
    return Case(GROUP, name, QUANTITIES, SHARES, (j0, j1), _found(law), exact)


def _both(z: Number) -> tuple[Series, Series]:
    """z and 1 - z as series of the change of z."""
    return variable(z, 1, TERMS), variable(1 - z, -1, TERMS)


def _found(law: Law) -> Found:
    def found(z: FloatArray) -> tuple[FloatArray, ...]:
        f, f1, f2, f3 = law(z)
        return f, law.complement(z), f1, f2, f3

    return found


def _values(f: Series, rest: Series) -> tuple[Number, ...]:
    return (f.terms[0], rest.terms[0], *(f.derivative(order) for order in (1, 2, 3)))
