"""Tolerance classes: published limits, and the formulas from which ISO 286-1 has its tables."""

from __future__ import annotations

import math
from itertools import pairwise

import pytest

from camgeo.errors import GeometryError
from camgeo.tolerancing.iso286 import limits_of

SIZES = (3, 6, 10, 18, 30, 50, 80, 120, 180, 250, 315, 400, 500)

UNITS = {5: 7, 6: 10, 7: 16, 8: 25, 9: 40, 10: 64, 11: 100}
"""Standard tolerances in tolerance units, ISO 286-1:1988, annex A."""

PUBLISHED = {
    # Sumitomo Electric, Dimensional tolerances for regularly used fits (JIS B 0401:1999), shafts
    ("d9", 0.5): (-45, -20),
    ("g5", 3.0): (-6, -2),
    ("d9", 18.1): (-117, -65),
    ("e7", 30.0): (-61, -40),
    ("f7", 20.0): (-41, -20),
    ("g6", 20.0): (-20, -7),
    ("h6", 20.0): (-13, 0),
    ("js6", 20.0): (-6.5, 6.5),
    ("k6", 20.0): (2, 15),
    ("m6", 20.0): (8, 21),
    ("n6", 20.0): (15, 28),
    ("p6", 20.0): (22, 35),
    ("g6", 65.0): (-29, -10),
    # DME, Tables for determining metric tolerances, table 6, p. 281, and table 7, p. 285
    ("H11", 25.0): (0, 130),
    ("JS7", 3.5): (-6, 6),
    ("js9", 500.0): (-77.5, 77.5),
    # Machine Drawing (see iso286.json), table 15.2: k is 0 for grades above 7
    ("k8", 100.0): (0, 54),
}
"""Micrometres; a size that ends a range belongs to it."""


@pytest.mark.parametrize(("name", "size"), PUBLISHED)
def test_published_limits(name: str, size: float) -> None:
    found = limits_of(name, size)
    assert [1000.0 * each for each in found] == pytest.approx(PUBLISHED[name, size], abs=1e-9)


def test_standard_tolerances_follow_their_formula() -> None:
    """i = 0.45 D^(1/3) + 0.001 D micrometres, D the geometric mean of a range, rounded to few
    digits; the tables were rounded by hand, to within a tenth.
    """
    for low, high in pairwise(SIZES):
        mean = math.sqrt(low * high)
        i = 0.45 * mean ** (1.0 / 3.0) + 0.001 * mean
        for grade, units in UNITS.items():
            below, above = limits_of(f"h{grade}", high)
            assert 1000.0 * (above - below) == pytest.approx(units * i, rel=0.1, abs=0.6)


def test_fundamental_deviations_follow_their_formulas() -> None:
    """d, e, f, g and n are powers of D; m is IT7 - IT6, and p at least IT7."""
    powers = {"d": (-16.0, 0.44), "e": (-11.0, 0.41), "f": (-5.5, 0.41), "g": (-2.5, 0.34)}
    for low, high in pairwise(SIZES):
        mean = math.sqrt(low * high)
        for letter, (factor, power) in powers.items():
            found = 1000.0 * limits_of(f"{letter}6", high)[1]
            assert found == pytest.approx(factor * mean**power, rel=0.06, abs=0.6)
        widths = {grade: 1000.0 * -limits_of(f"h{grade}", high)[0] for grade in (6, 7)}
        assert 1000.0 * limits_of("n6", high)[0] == pytest.approx(5.0 * mean**0.34, rel=0.06)
        assert 1000.0 * limits_of("m6", high)[0] == pytest.approx(widths[7] - widths[6])
        assert 0.0 <= 1000.0 * limits_of("p6", high)[0] - widths[7] <= 5.0 + 1e-9


@pytest.mark.parametrize("letter", ["d", "e", "f", "g", "h"])
def test_holes_are_shafts_reversed(letter: str) -> None:
    for size in SIZES:
        low, high = limits_of(f"{letter}8", size)
        assert limits_of(f"{letter.upper()}8", size) == pytest.approx((-high, -low))


@pytest.mark.parametrize(
    ("name", "size", "said"),
    [
        ("H4", 20.0, "grade from IT5 to IT11"),
        ("K7", 20.0, r"letter of holes \(D, E, F, G, H and JS\)"),
        ("Hj", 20.0, "no tolerance class"),
        ("H7", 500.1, "up to 500 mm, and this one is 500.1 mm"),
    ],
)
def test_classes_that_are_not_known(name: str, size: float, said: str) -> None:
    with pytest.raises(GeometryError, match=said):
        limits_of(name, size)
