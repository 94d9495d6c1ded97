"""Cases of the motion laws: everywhere, near their ends, strongly shifted, for several tasks."""

from __future__ import annotations

from typing import Final

from camgeo.kinematics.laws import make_law
from camgeo.kinematics.laws.law import Law
from camgeo.numeric.arrays import FloatArray
from tests.stability.high_precision import Number
from tests.stability.lifts import (
    HALVES,
    boundary_lift,
    double_harmonic_lift,
    lift,
    scca_lift,
    septic_lift,
)
from tests.stability.measure import Case, Exact
from tests.stability.series import Series, variable

GROUP: Final = "laws"

QUANTITIES: Final = ("f", "1 - f", "f'", "f''", "f'''")

NEAR: Final = 1e-12
"""Distance from the ends, where the polynomials are 1e-35 or less."""

SHIFTS: Final = (0.5, 0.3, 1e-6, 1.0 - 1e-6)
"""lambda: symmetric, moderate, and hard case HC13 with its mirror image."""

SHARES: Final = (NEAR, 0.07, 0.19, 0.42, 0.63, 0.91, 1.0 - NEAR)
"""Places as fractions of a half, or of the whole; none is a border of a law."""

TERMS: Final = 4

BOUNDARIES: Final[tuple[tuple[str, str, dict[str, float]], ...]] = (
    ("polynomial-5", "R-U", {"a1": -4.0}),
    ("polynomial-5", "G-G", {"v0": 0.5, "v1": 1.75}),
    ("polynomial-5", "B-B", {"v0": -0.25, "a0": 3.0, "v1": 1.5, "a1": -2.0}),
    ("polynomial-7", "G-B", {"v0": 1.25, "j0": 10.0, "v1": 0.5, "a1": 4.0, "j1": -20.0}),
    ("polynomial", "B-B", {"v0": 0.75, "a1": -3.0}),
)
"""Polynomials by name, motion task and boundary values."""

ORDERS: Final = {"v": 1, "a": 2, "j": 3}

MET: Final = {"polynomial-5": "va", "polynomial-7": "vaj", "polynomial": ""}
"""Values of a polynomial at both ends, zero where none is given."""


def cases() -> tuple[Case, ...]:
    """All cases of this module."""
    shifted = [_shifted(name, inflection) for name in HALVES for inflection in SHIFTS]
    shared = [_scca(0.3, 0.2), _scca(0.25, 0.75)]
    met = [_boundary(*each) for each in BOUNDARIES]
    return (
        *shifted, *shared, _septic(20.0, -30.0), _septic(-50.0, 0.0), *met, _double_harmonic(),
    )  # fmt: skip


def _shifted(name: str, inflection: float) -> Case:
    def exact(z: Number, lam: Number) -> tuple[Number, ...]:
        return _values(*lift(name, *_both(z), lam))

    law = make_law(name, "R-R", inflection=inflection)
    halves = [share * inflection for share in SHARES]
    halves += [inflection + share * (1.0 - inflection) for share in SHARES]
    places = tuple(z for z in halves if 0.0 < z < 1.0 and z != inflection)
    label = f"{inflection:g}" if inflection < 0.9 else f"1 - {1.0 - inflection:.0e}"
    return _case(f"{name}, lambda {label}", law, exact, inflection, places=places)


def _scca(sine: float, cosine: float) -> Case:
    def exact(z: Number, b: Number, d: Number) -> tuple[Number, ...]:
        at, rest = _both(z)
        return _values(scca_lift(at, rest, b, d), scca_lift(rest, at, b, d))

    law = make_law("scca", "R-R", sine=sine, cosine=cosine)
    name = f"scca, b {sine:g}, d {cosine:g}"
    return _case(name, law, exact, sine, cosine)


def _septic(j0: float, j1: float) -> Case:
    def exact(z: Number, jerk_start: Number, jerk_end: Number) -> tuple[Number, ...]:
        f = septic_lift(*_both(z), jerk_start, jerk_end)
        return _values(f, 1 - f)

    law = make_law("polynomial-7", "R-R", j0=j0, j1=j1)
    name = f"polynomial-7, j0 {j0:g}, j1 {j1:g}"
    return _case(name, law, exact, j0, j1)


def _boundary(name: str, task: str, given: dict[str, float]) -> Case:
    keys = {key + end for key in MET[name] for end in "01"} | set(given)

    def exact(z: Number, *values: Number) -> tuple[Number, ...]:
        known = dict(zip(given, values, strict=True))
        ends = [
            {ORDERS[key[0]]: known.get(key, 0) for key in sorted(keys) if key[1] == end}
            for end in "01"
        ]
        f = boundary_lift(_both(z)[0], *ends)
        return _values(f, 1 - f)

    law = make_law(name, task, **given)
    label = ", ".join((f"{name} {task}", *(f"{key} {value:g}" for key, value in given.items())))
    return _case(label, law, exact, *given.values())


def _double_harmonic() -> Case:
    def exact(z: Number) -> tuple[Number, ...]:
        f = double_harmonic_lift(_both(z)[0])
        return _values(f, 1 - f)

    law = make_law("double-harmonic", "R-U")
    return _case("double-harmonic R-U", law, exact)


def _case(
    name: str, law: Law, exact: Exact, *parameters: float, places: tuple[float, ...] = SHARES
) -> Case:
    def found(z: FloatArray) -> tuple[FloatArray, ...]:
        f, f1, f2, f3 = law(z)
        return f, law.complement(z), f1, f2, f3

    return Case(GROUP, name, QUANTITIES, places, parameters, found, exact)


def _both(z: Number) -> tuple[Series, Series]:
    """z and 1 - z as series of the change of z."""
    return variable(z, 1, TERMS), variable(1 - z, -1, TERMS)


def _values(f: Series, rest: Series) -> tuple[Number, ...]:
    return (f.terms[0], rest.terms[0], *(f.derivative(order) for order in (1, 2, 3)))
