"""Tolerance classes: published limits, and the formulas from which ISO 286-1 has its tables."""

from __future__ import annotations

import math
from collections.abc import Callable
from itertools import pairwise

import pytest

from camgeo.errors import GeometryError
from camgeo.studies.tolerancing.stated import HOLES, SHAFTS, class_limits

SIZES = (3, 6, 10, 18, 30, 50, 80, 120, 180, 250, 315, 400, 500)

FINE_SIZES = (3, 6, 10, 14, 18, 24, 30, 40, 50, 65, 80, 100, 120, 140, 160, 180, 200, 225, 250, 280,
              315, 355, 400, 450, 500)  # fmt: skip

UNITS = {5: 7, 6: 10, 7: 16, 8: 25, 9: 40, 10: 64, 11: 100, 12: 160, 13: 250, 14: 400, 15: 640,
         16: 1000}  # fmt: skip
"""Standard tolerances in tolerance units, ISO 286-1:1988, annex A."""

PUBLISHED = {
    # Sumitomo Electric, Dimensional tolerances for regularly used fits (JIS B 0401:1999), shafts
    ("d9", 0.5): (-45, -20),
    ("g5", 3.0): (-6, -2),
    ("b9", 35.0): (-232, -170),
    ("c9", 45.0): (-192, -130),
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
    ("r6", 3.0): (10, 16),
    ("s6", 50.0): (43, 59),
    ("t6", 24.1): (41, 54),
    ("t6", 40.0): (48, 64),
    ("u6", 18.1): (41, 54),
    ("u6", 25.0): (48, 61),
    ("u6", 65.0): (87, 106),
    # DME, Tables for determining metric tolerances, table 6, p. 281, and table 7, p. 285
    ("H11", 25.0): (0, 130),
    ("H12", 8.0): (0, 150),
    ("H13", 300.0): (0, 810),
    ("JS7", 3.5): (-6, 6),
    ("js9", 500.0): (-77.5, 77.5),
    ("K6", 20.0): (-11, 2),
    ("K8", 60.0): (-32, 14),
    ("M6", 150.0): (-33, -8),
    ("M7", 25.0): (-21, 0),
    ("M8", 6.0): (-16, 2),
    ("N6", 40.0): (-28, -12),
    ("N8", 110.0): (-58, -4),
    ("R7", 55.0): (-60, -30),
    # Machine Drawing (see iso286.json), tables 15.2 and 15.3: k is 0 for grades above 7 and below
    # 4, N for grades above 8, and M6 is an exception above 250 up to 315 mm
    ("k8", 100.0): (0, 54),
    ("k3", 100.0): (0, 6),
    ("k4", 100.0): (3, 13),
    ("N9", 100.0): (-87, 0),
    ("N9", 2.0): (-29, -4),
    ("M6", 280.0): (-41, -9),
    ("a11", 190.0): (-950, -660),
    ("h1", 2.0): (-0.8, 0),
    ("h16", 450.0): (-4000, 0),
    # Precise Metal, Tolerance tables for round bars
    ("h12", 3.0): (-100, 0),
    ("h12", 40.0): (-250, 0),
    ("h12", 250.0): (-460, 0),
}
"""Micrometres; a size that ends a range belongs to it."""

UPPER = {
    # FreeCAD, TechDraw, TaskHoleShaftFit.py: upper deviations in all ranges of sizes
    "c11": (-60, -70, -80, -95, -95, -110, -110, -120, -130, -140, -150, -170, -180, -200, -210,
            -230, -240, -260, -280, -300, -330, -360, -400, -440, -480),
    "r6": (16, 23, 28, 34, 34, 41, 41, 50, 50, 60, 62, 73, 76, 88, 90, 93, 106, 109, 113, 126, 130,
           144, 150, 166, 172),
    "s6": (20, 27, 32, 39, 39, 48, 48, 59, 59, 72, 78, 93, 101, 117, 125, 133, 151, 159, 169, 190,
           202, 226, 244, 272, 292),
    "K7": (0, 3, 5, 6, 6, 6, 6, 7, 7, 9, 9, 10, 10, 12, 12, 12, 13, 13, 13, 16, 16, 17, 17, 18, 18),
    "N7": (-4, -4, -4, -5, -5, -7, -7, -8, -8, -9, -9, -10, -10, -12, -12, -12, -14, -14, -14, -14,
           -14, -16, -16, -17, -17),
    "R7": (-10, -11, -13, -16, -16, -20, -20, -25, -25, -30, -32, -38, -41, -48, -50, -53, -60, -63,
           -67, -74, -78, -87, -93, -103, -109),
    "S7": (-14, -15, -17, -21, -21, -27, -27, -34, -34, -42, -48, -58, -66, -77, -85, -93, -105,
           -113, -123, -138, -150, -169, -187, -209, -229),
    # pon-osi.com, P7 of JIS B 0401-2
    "P7": (-6, -8, -9, -11, -11, -14, -14, -17, -17, -21, -21, -24, -24, -28, -28, -28, -33, -33,
           -33, -36, -36, -41, -41, -45, -45),
}  # fmt: skip

FORMULAS: dict[str, Callable[[float, float], float]] = {
    # Machine Drawing, table 15.4, p. 222, with D the geometric mean of a range
    "a": lambda d, _: -(265 + 1.3 * d) if d <= 120 else -3.5 * d,
    "b": lambda d, _: -(140 + 0.85 * d) if d <= 160 else -1.8 * d,
    "c": lambda d, _: -(95 + 0.8 * d),
    "s": lambda d, it7: it7 + 0.4 * d,
    "t": lambda d, it7: it7 + 0.63 * d,
    "u": lambda d, it7: it7 + d,
}


FORMULA_ABOVE = {"a": 0, "b": 0, "c": 40, "s": 50, "t": 50, "u": 50}
"""Sizes [mm]."""


@pytest.mark.parametrize(("name", "size"), PUBLISHED)
def test_published_limits(name: str, size: float) -> None:
    found = class_limits(name, size)
    assert [1000.0 * each for each in found] == pytest.approx(PUBLISHED[name, size], abs=1e-9)


@pytest.mark.parametrize("name", UPPER)
def test_published_upper_deviations(name: str) -> None:
    found = [1000.0 * class_limits(name, size)[1] for size in FINE_SIZES]
    assert found == pytest.approx(UPPER[name], abs=1e-9)


def test_standard_tolerances_follow_their_formula() -> None:
    """i = 0.45 D^(1/3) + 0.001 D micrometres, D the geometric mean of a range, rounded to few
    digits; the tables were rounded by hand, to within a tenth. IT1 is 0.8 + 0.02 D, and up to IT5
    each grade is wider than the one before by about the same ratio.
    """
    for low, high in pairwise(SIZES):
        mean = math.sqrt(low * high)
        i = 0.45 * mean ** (1.0 / 3.0) + 0.001 * mean
        widths = {grade: -1000.0 * class_limits(f"h{grade}", high)[0] for grade in range(1, 17)}
        for grade, units in UNITS.items():
            assert widths[grade] == pytest.approx(units * i, rel=0.1, abs=0.6)
        assert widths[1] == pytest.approx(0.8 + 0.02 * mean, rel=0.2)
        assert all(1.2 <= widths[each] / widths[each - 1] <= 1.8 for each in (2, 3, 4, 5))


def test_fundamental_deviations_follow_their_formulas() -> None:
    """d, e, f, g and n are powers of D; m is IT7 - IT6, and p at least IT7."""
    powers = {"d": (-16.0, 0.44), "e": (-11.0, 0.41), "f": (-5.5, 0.41), "g": (-2.5, 0.34)}
    for low, high in pairwise(SIZES):
        mean = math.sqrt(low * high)
        for letter, (factor, power) in powers.items():
            found = 1000.0 * class_limits(f"{letter}6", high)[1]
            assert found == pytest.approx(factor * mean**power, rel=0.06, abs=0.6)
        widths = {grade: 1000.0 * -class_limits(f"h{grade}", high)[0] for grade in (6, 7)}
        assert 1000.0 * class_limits("n6", high)[0] == pytest.approx(5.0 * mean**0.34, rel=0.06)
        assert 1000.0 * class_limits("m6", high)[0] == pytest.approx(widths[7] - widths[6])
        assert 0.0 <= 1000.0 * class_limits("p6", high)[0] - widths[7] <= 5.0 + 1e-9


def test_deviations_in_fine_ranges_follow_their_formulas() -> None:
    """a and b, c, s, t and u above 40 or 50 mm, within 5 %: below, c is up to 15 % more than its
    formula says, and s has another one. r is the geometric mean of p and s.
    """
    for low, high in pairwise(FINE_SIZES):
        mean = math.sqrt(low * high)
        it7 = -1000.0 * class_limits("h7", high)[0]
        for letter, formula in FORMULAS.items():
            side = 1 if letter in "abc" else 0
            if low >= FORMULA_ABOVE[letter]:
                found = 1000.0 * class_limits(f"{letter}6", high)[side]
                assert found == pytest.approx(formula(mean, it7), rel=0.05)
        p, r, s = (1000.0 * class_limits(f"{letter}6", high)[0] for letter in "prs")
        assert r == pytest.approx(math.sqrt(p * s), abs=2.0)


@pytest.mark.parametrize("letter", ["a", "b", "c", "d", "e", "f", "g", "h"])
def test_holes_are_shafts_reversed(letter: str) -> None:
    for size in SIZES:
        low, high = class_limits(f"{letter}8", size)
        assert class_limits(f"{letter.upper()}8", size) == pytest.approx((-high, -low))


@pytest.mark.parametrize("letter", ["k", "m", "n", "p", "r", "s", "t", "u"])
def test_a_hole_fits_the_finer_shaft_h_as_the_hole_h_fits_its_shaft(letter: str) -> None:
    """What delta is for: S7/h6 is the fit H7/s6, up to IT8 of K, M and N, and IT7 of the others."""
    last = 8 if letter in "kmn" else 7
    for size in FINE_SIZES[1:]:
        for grade in range(5, last + 1):
            if letter == "t" and size <= 24.0:
                continue
            if (letter, grade) == ("m", 6) and 250 < size <= 315:
                continue
            by_hole = clearances(f"H{grade}", f"{letter}{grade - 1}", size)
            by_shaft = clearances(f"{letter.upper()}{grade}", f"h{grade - 1}", size)
            assert by_shaft == pytest.approx(by_hole, abs=1e-12)


def clearances(hole: str, shaft: str, size: float) -> tuple[float, float]:
    (low, high), (least, most) = class_limits(hole, size), class_limits(shaft, size)
    return low - most, high - least


def test_each_class_is_as_wide_as_its_grade() -> None:
    """Whatever has a value; without a negative zero, which would be printed."""
    count = 0
    for letter in (*SHAFTS, *HOLES):
        for grade in range(1, 17):
            for size in FINE_SIZES:
                try:
                    low, high = class_limits(f"{letter}{grade}", float(size))
                except GeometryError:
                    continue
                least, zero = class_limits(f"h{grade}", float(size))
                assert high - low == pytest.approx(zero - least)
                assert "-0.0" not in (str(low), str(high))
                count += 1
    # of 13,600: none of K above IT8, of t up to 24 mm, of holes K to U in IT1 and IT2
    assert count == 13_600 - 8 * 24 - 2 * 16 * 6 - 8 * 2 * 25 + 2 * 6


@pytest.mark.parametrize(
    ("name", "size", "said"),
    [
        ("H17", 20.0, r"grade from IT1 to IT16, e\.g\. \"H7\""),
        ("V7", 20.0, r"letter of holes \(A, B, C, D, E, F, G, H, JS, K, M, N, P, R, S, T and U\)"),
        ("Hj", 20.0, "not a known tolerance class"),
        ("H7", 500.1, "up to 500 mm, and this one is 500.1 mm"),
        ("t6", 24.0, "there are none of t1 to t16 for sizes above 0 up to 24 mm, and this one is"),
        ("K9", 20.0, "no value in ISO 286-1: there are none of K9 to K16 for sizes above 3 up to"),
        ("P2", 20.0, "there are none of P1 to P2 for sizes above 0 up to 500 mm"),
        ("a11", 1.0, "there are none of a1 to a16 for sizes above 0 up to 1 mm"),
        ("h14", 0.9, "there are none of h14 to h16 for sizes above 0 up to 1 mm"),
        ("N9", 1.0, "there are none of N9 to N16 for sizes above 0 up to 1 mm"),
    ],
)
def test_classes_that_are_not_known(name: str, size: float, said: str) -> None:
    with pytest.raises(GeometryError, match=said):
        class_limits(name, size)
