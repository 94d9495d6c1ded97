"""Cases of the motion laws: everywhere, near their ends, strongly shifted, for several tasks."""

from __future__ import annotations

from typing import Final

from camgeo.kinematics.laws import make_law
from camgeo.numeric.arrays import FloatArray
from tests.motion.exact_laws import HALVES
from tests.motion.exact_laws import exact as exact_law
from tests.stability.measure import Case
from tests.stability.series import Number

GROUP: Final = "laws"

QUANTITIES: Final = ("f", "1 - f", "f'", "f''", "f'''")

NEAR: Final = 1e-12
"""Distance from the ends, where the polynomials are 1e-35 or less."""

SHIFTS: Final = (0.5, 0.3, 1e-6, 1.0 - 1e-6)
"""lambda: symmetric, moderate, and hard case HC13 with its mirror image."""

SHARES: Final = (NEAR, 0.07, 0.19, 0.42, 0.63, 0.91, 1.0 - NEAR)
"""Places as fractions of a half, or of the whole; none is a border of a law."""

OTHERS: Final[tuple[tuple[str, str, str, dict[str, float]], ...]] = (
    ("scca, b 0.3, d 0.2", "scca", "R-R", {"sine": 0.3, "cosine": 0.2}),
    ("scca, b 0.25, d 0.75", "scca", "R-R", {"sine": 0.25, "cosine": 0.75}),
    ("polynomial-7, j0 20, j1 -30", "polynomial-7", "R-R", {"j0": 20.0, "j1": -30.0}),
    ("polynomial-7, j0 -50, j1 0", "polynomial-7", "R-R", {"j0": -50.0, "j1": 0.0}),
    ("polynomial-5 R-U, a1 -4", "polynomial-5", "R-U", {"a1": -4.0}),
    ("polynomial-5 G-G, v0 0.5, v1 1.75", "polynomial-5", "G-G", {"v0": 0.5, "v1": 1.75}),
    ("polynomial-5 B-B, v0 -0.25, a0 3, v1 1.5, a1 -2", "polynomial-5", "B-B",
     {"v0": -0.25, "a0": 3.0, "v1": 1.5, "a1": -2.0}),
    ("polynomial-7 G-B, v0 1.25, j0 10, v1 0.5, a1 4, j1 -20", "polynomial-7", "G-B",
     {"v0": 1.25, "j0": 10.0, "v1": 0.5, "a1": 4.0, "j1": -20.0}),
    ("polynomial B-B, v0 0.75, a1 -3", "polynomial", "B-B", {"v0": 0.75, "a1": -3.0}),
    ("double-harmonic R-U", "double-harmonic", "R-U", {}),
)  # fmt: skip
"""Label, name, motion task and parameters."""


def cases() -> tuple[Case, ...]:
    """All cases of this module."""
    shifted = [_shifted(name, inflection) for name in HALVES for inflection in SHIFTS]
    return (*shifted, *(_case(*each) for each in OTHERS))


def _shifted(name: str, inflection: float) -> Case:
    halves = [share * inflection for share in SHARES]
    halves += [inflection + share * (1.0 - inflection) for share in SHARES]
    places = tuple(z for z in halves if 0.0 < z < 1.0 and z != inflection)
    label = f"{inflection:g}" if inflection < 0.9 else f"1 - {1.0 - inflection:.0e}"
    return _case(f"{name}, lambda {label}", name, "R-R", {"inflection": inflection}, places)


def _case(
    label: str,
    name: str,
    task: str,
    given: dict[str, float],
    places: tuple[float, ...] = SHARES,
) -> Case:
    law = make_law(name, task, **given)

    def found(z: FloatArray) -> tuple[FloatArray, ...]:
        f, f1, f2, f3 = law(z)
        return f, law.complement(z), f1, f2, f3

    def exact(z: Number, *values: Number) -> tuple[Number, ...]:
        return exact_law(name, task, dict(zip(given, values, strict=True)), z)

    return Case(GROUP, label, QUANTITIES, places, tuple(given.values()), found, exact)
