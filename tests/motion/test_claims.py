"""Claims of VDI 2143-1 about its laws: constants, approximations, distinguished inflection points,
and values that were worked out with many digits for all tasks.

The constants and equations are checked against the printed formulas at 50 digits and more; the
values also against camgeo.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from mpmath import mp, mpf

from camgeo.kinematics.laws import make_law
from camgeo.kinematics.laws.law import Law, characteristic
from tests.motion import printed
from tests.motion.oracle import DIGITS, decimal, exact, exact_pieces, ulps
from tests.motion.printed import Number, Pieces
from tests.reference import law_cases, law_of

TINY = mpf(10) ** -50

LIMIT = 8.0
"""ulp, see test_laws."""

CASES = law_cases()


@pytest.fixture(autouse=True)
def _digits() -> Any:
    with mp.workdps(DIGITS):
        yield


def rounds_to(value: Number, text: str) -> bool:
    """True if `text` is `value` rounded to the digits of `text`."""
    digits = len(text.partition(".")[2])
    return bool(abs(value - decimal(text)) <= mpf(10) ** -digits / 2)


def root(function: Callable[[Number], Number], low: str, high: str) -> Number:
    """The zero of `function` between two places where it has different signs."""
    a, b = decimal(low), decimal(high)
    assert function(a) * function(b) < 0
    return mp.findroot(function, (a, b), solver="anderson", tol=mpf(10) ** -80)


# R-U: the constants of section 6.6 ------------------------------------------------------------

pi = mp.pi


def moment_constants() -> dict[str, tuple[Number, Number]]:
    """Value and place of the extremes of f' f'' in their closed forms: (177), (178), (199)."""
    s = (-(1 + pi) + mp.sqrt((1 + pi) ** 2 + 8)) / 4
    c = (-3 * pi / 2 + mp.sqrt(9 * pi**2 / 4 + 8)) / 4
    h = (mp.sqrt(73) - 1) / 12
    return {
        "177": ((1 + pi + s) * mp.sqrt(1 - s**2) / (2 * pi), mpf(3) / 4 + mp.asin(s) / (2 * pi)),
        "178": ((3 * pi / 2 + c) * mp.sqrt(1 - c**2) / (2 * pi), mp.acos(c) / (2 * pi)),
        "199": ((1 + 3 * h) * mp.sqrt(1 - h**2) / 2, mpf(1) / 4 + 3 * mp.asin(h) / (2 * pi)),
    }


def test_177_constants() -> None:
    value, place = moment_constants()["177"]
    assert rounds_to(value, "0.6772")
    assert rounds_to(value, "0.677162827507424")
    assert rounds_to(place, "0.785")
    assert rounds_to(place, "0.785044444549303")


def test_178_constants() -> None:
    value, place = moment_constants()["178"]
    assert rounds_to(value, "0.7660")
    assert rounds_to(value, "0.766042244412414")
    assert rounds_to(place, "0.2186")
    assert rounds_to(place, "0.218615960948305")
    assert rounds_to(1 - place, "0.7814")
    assert rounds_to(1 - place, "0.781384039051695")


def test_199_constants() -> None:
    value, place = moment_constants()["199"]
    assert rounds_to(value, "1.1222")
    assert rounds_to(value, "1.12218485484549")
    assert rounds_to(place, "0.5746")
    assert rounds_to(place, "0.574598691497981")


def test_172_and_174_factors() -> None:
    first = (3 * pi + 2) / (2 * (pi + 2))
    assert rounds_to(first, "1.11102")
    assert rounds_to(first, "1.11101547035166")
    second = (3 * pi + 2) / (4 * pi)
    assert rounds_to(second, "0.90915")
    assert rounds_to(second, "0.909154943091895")


@pytest.mark.parametrize("inflection", [0.25, 0.5, 0.75])
def test_the_constants_are_those_of_the_law(inflection: float) -> None:
    """f' f'' has there the value claimed, and f''^2 + f' f''' = 0."""
    lam, m = mpf(inflection), 1 - mpf(inflection)
    constants = moment_constants()
    trapezoid, harmonic = printed.ru_trapezoid_amplitudes(lam), printed.ru_harmonic_amplitudes(lam)
    (v1, p1), (v2, p2), (v3, p3) = constants["177"], constants["178"], constants["199"]
    claims = [
        ("modified-trapezoid", p1 * lam, v1 * lam * trapezoid[0] ** 2),
        ("modified-trapezoid", p2 + (1 - p2) * lam, -v2 * m * trapezoid[1] ** 2),
        ("harmonic-combination", p3 * lam, v3 / pi * lam * harmonic[0] ** 2),
        ("harmonic-combination", (1 + lam) / 2, -m / pi * harmonic[1] ** 2),  # (200)
    ]
    for name, place, value in claims:
        _, _, f1, f2, f3 = exact(name, "R-U", {"inflection": inflection}, place)
        assert abs(f1 * f2 - value) < TINY
        assert abs(f2**2 + f1 * f3) < TINY
        found = characteristic(make_law(name, "R-U", inflection=inflection))
        extreme = found.moment if value > 0 else found.braking_moment
        assert ulps(extreme.value, value) <= 8.0
        assert extreme.place == pytest.approx(float(place), rel=1e-14)
    # (173) with (174), (196)
    speed = exact("modified-trapezoid", "R-U", {"inflection": inflection}, lam)[2]
    assert abs(speed - m * (3 * pi + 2) / (4 * pi) * abs(trapezoid[1])) < TINY
    assert abs(trapezoid[0] + m / lam * (3 * pi + 2) / (2 * (pi + 2)) * trapezoid[1]) < TINY
    speed = exact("harmonic-combination", "R-U", {"inflection": inflection}, lam)[2]
    assert abs(speed - 2 * m / pi * abs(harmonic[1])) < TINY


# R-U: distinguished inflection points ---------------------------------------------------------


def trapezoid_difference(quantity: str) -> Callable[[Number], Number]:
    """|starred| - |not starred| value of R-U trapezoids, over lambda."""
    rise, fall = moment_constants()["177"][0], moment_constants()["178"][0]

    def difference(lam: Number) -> Number:
        ca, cb = printed.ru_trapezoid_amplitudes(lam)
        return {
            "acceleration": -cb - ca,
            "jerk": -2 * pi / (1 - lam) * cb - 2 * pi / lam * ca,  # (175), (176)
            "moment": fall * (1 - lam) * cb**2 - rise * lam * ca**2,
        }[quantity]

    return difference


def harmonic_difference(quantity: str) -> Callable[[Number], Number]:
    """The same of the harmonic combination."""
    rise = moment_constants()["199"][0]

    def difference(lam: Number) -> Number:
        ca, cb = printed.ru_harmonic_amplitudes(lam)
        return {
            "acceleration": -cb - ca,
            "jerk": -pi / (2 * (1 - lam)) * cb - 2 * pi / lam * ca,  # (197), (198)
            "moment": (1 - lam) / pi * cb**2 - rise / pi * lam * ca**2,
        }[quantity]

    return difference


@pytest.mark.parametrize(
    ("quantity", "printed_value", "value"),
    [
        ("acceleration", "0.526", "0.526294328940461"),
        ("jerk", "0.513", "0.513156266902126"),
        ("moment", "0.522", "0.521792013349567"),
    ],
)
def test_equal_values_of_the_trapezoid(quantity: str, printed_value: str, value: str) -> None:
    lam = root(trapezoid_difference(quantity), "0.4", "0.6")
    assert rounds_to(lam, printed_value)
    assert rounds_to(lam, value)


@pytest.mark.parametrize(
    ("quantity", "printed_value", "value"),
    [
        ("acceleration", "0.500", "0.500000000000000"),
        ("jerk", "0.667", "0.666666666666667"),
        ("moment", "0.529", "0.528787514567007"),
    ],
)
def test_equal_values_of_the_harmonic(quantity: str, printed_value: str, value: str) -> None:
    lam = root(harmonic_difference(quantity), "0.4001", "0.7001")
    assert rounds_to(lam, printed_value)
    assert rounds_to(lam, value)


@pytest.mark.parametrize(
    ("name", "quantity", "lam"),
    [
        ("modified-trapezoid", "acceleration", 0.526294328940461),
        ("modified-trapezoid", "moment", 0.521792013349567),
        ("harmonic-combination", "acceleration", 0.5),
        ("harmonic-combination", "moment", 0.528787514567007),
    ],
)
def test_camgeo_has_them_equal_too(name: str, quantity: str, lam: float) -> None:
    """lambda to 5e-16; the ratio is about (1 - lambda)/lambda to a small power, so 8 times that."""
    found = characteristic(make_law(name, "R-U", inflection=lam))
    up, down = {
        "acceleration": (found.acceleration, found.deceleration),
        "moment": (found.moment, found.braking_moment),
    }[quantity]
    assert up.value == pytest.approx(-down.value, rel=16 * 5e-16)


@pytest.mark.parametrize(
    ("name", "lam"),
    [("modified-trapezoid", 0.513156266902126), ("harmonic-combination", 2.0 / 3.0)],
)
def test_camgeo_has_the_jerks_equal_that_are_claimed(name: str, lam: float) -> None:
    """C_j at z = 0 and C_j* just behind lambda; neither need be the extreme, see test_errata."""
    law = make_law(name, "R-U", inflection=lam)
    start, behind = law(np.array([0.0, lam]))[3]
    assert start == pytest.approx(-behind, rel=16 * 5e-16)


# Approximations, to their printed digits ------------------------------------------------------


def test_170_coefficients() -> None:
    scale = 32 * pi**2
    assert rounds_to((15 * pi**2 + 8) / scale, "0.49408")
    assert rounds_to(2 * (9 * pi**2 - 4 * pi + 8) / scale, "0.53358")
    assert rounds_to((3 * pi**2 - 8 * pi + 8) / scale, "0.03950")


def test_194_coefficients() -> None:
    """The last one with the erratum."""
    assert rounds_to(8 / (2 * pi**2), "0.40528")
    assert rounds_to((12 - pi) / (2 * pi**2), "0.44877")
    assert rounds_to((4 - pi) / (2 * pi**2), "0.04349")


def test_180_coefficients() -> None:
    a, b = 3 * pi**2 - 8 * pi + 8, 9 * pi**2 - 4 * pi + 8
    assert rounds_to(b / a, "6.75373")
    assert rounds_to((b / a) ** 2 - (8 + 15 * pi**2) / a, "33.10545")
    assert rounds_to(32 * pi**2 / a, "25.31465")


def test_202_coefficients() -> None:
    middle = (12 - pi) / (8 - 2 * pi)
    assert rounds_to(middle, "5.15979")
    assert rounds_to(middle**2 - 8 / (4 - pi), "17.30387")
    assert rounds_to(2 * pi**2 / (4 - pi), "22.99515")


LAMBDAS = [mpf(k) / 20 for k in range(5, 16)]
"""0.25 to 0.75, which the guideline recommends."""


def test_170_is_right_to_6_millionths() -> None:
    for lam in LAMBDAS:
        near = 1 / (decimal("-0.49408") + decimal("0.53358") * lam - decimal("0.03950") * lam**2)
        _, cb = printed.ru_trapezoid_amplitudes(lam)
        # Three coefficients, each to half a unit of the fifth digit, over the sum of them.
        bound = mpf(10) ** -5 / 2 * (1 + lam + lam**2) * abs(cb)
        assert abs(near / cb - 1) <= min(bound, decimal("6e-5"))


@pytest.mark.parametrize("name", ["modified-trapezoid", "harmonic-combination"])
def test_179_and_201_give_lambda_back_and_180_and_202_nearly(name: str) -> None:
    for lam in LAMBDAS:
        if name == "modified-trapezoid":
            f2 = abs(printed.ru_trapezoid_amplitudes(lam)[1])
            a, b = 3 * pi**2 - 8 * pi + 8, 9 * pi**2 - 4 * pi + 8
            back = b / a - mp.sqrt((b / a) ** 2 - (8 + pi**2 * (15 - 32 / f2)) / a)
            near = decimal("6.75373") - mp.sqrt(decimal("33.10545") + decimal("25.31465") / f2)
        else:
            f2 = abs(printed.ru_harmonic_amplitudes(lam)[1])
            middle = (12 - pi) / (8 - 2 * pi)
            back = middle - mp.sqrt(middle**2 - (8 - 2 * pi**2 / f2) / (4 - pi))
            near = decimal("5.15979") - mp.sqrt(decimal("17.30387") + decimal("22.99515") / f2)
        assert abs(back - lam) < TINY
        assert abs(near - lam) <= decimal("4.5e-6")


def test_180_has_the_wrong_limit_at_lambda_one() -> None:
    limit = decimal("6.75373") - mp.sqrt(decimal("33.10545"))
    assert rounds_to(limit, "0.999996")


def test_least_final_accelerations() -> None:
    """lambda = 0 of (179) and (201), where R-U laws begin."""
    assert rounds_to(-printed.ru_trapezoid_amplitudes(mpf(0) + TINY)[1], "2.02396251839392")
    assert rounds_to(-printed.ru_harmonic_amplitudes(mpf(0) + TINY)[1], "2.46740110027234")
    assert rounds_to(32 * pi**2 / (15 * pi**2 + 8), "2.02396251839392")
    assert rounds_to(pi**2 / 4, "2.46740110027234")


# Claims of the tables that do not hold --------------------------------------------------------

SYMMETRIC = [
    "quadratic-parabola",
    "simple-sine",
    "polynomial-345",
    "inclined-sine",
    "modified-trapezoid",
    "modified-sine",
]
"""The laws of section 6.1.1 without a shock."""


def test_tafel_2_the_parabola_has_the_least_c_a_and_not_the_least_c_v() -> None:
    found = {name: characteristic(make_law(name)) for name in SYMMETRIC}
    parabola = found.pop("quadratic-parabola")
    assert parabola.velocity.value == 2.0
    assert parabola.acceleration.value == 4.0
    for other in found.values():
        assert other.velocity.value <= parabola.velocity.value  # the highest
        assert other.acceleration.value > parabola.acceleration.value


def test_tafel_4_the_trapezoid_has_the_higher_jerk_only_behind_the_inflection() -> None:
    half = {"inflection": 0.5}
    trapezoid = exact_pieces("modified-trapezoid", "R-U", half)
    harmonic = exact_pieces("harmonic-combination", "R-U", half)

    def jerks(law: Pieces) -> tuple[Number, Number]:
        """C_j at z = 0, C_j* behind lambda = 1/2."""
        (behind,) = (piece for piece in law if piece.start == 0.5)
        return law[0].formula(mpf(0))[3], behind.formula(mpf("0.5"))[3]

    assert rounds_to(jerks(trapezoid)[0], "58.87")
    assert rounds_to(jerks(harmonic)[0], "65.53")
    assert jerks(trapezoid)[0] < jerks(harmonic)[0]
    # |C_j*| is the trapezoid's own, 52.99 to 16.38.
    assert rounds_to(jerks(harmonic)[1], "-16.38")
    assert abs(jerks(trapezoid)[1]) > abs(jerks(harmonic)[1])
    for name, law in (("modified-trapezoid", trapezoid), ("harmonic-combination", harmonic)):
        found = make_law(name, "R-U", inflection=0.5)(np.array([0.0, 0.5]))[3]
        assert [ulps(a, b) <= 8.0 for a, b in zip(found, jerks(law), strict=True)] == [True, True]


# G-G: check values of section 6.2 -------------------------------------------------------------


def gg_constants() -> tuple[Number, Number]:
    return 2 * pi**2 / (pi + 4), pi / 2


def test_gg_constants() -> None:
    m, q = gg_constants()
    assert rounds_to(m, "2.76397853527204548")
    assert rounds_to(q, "1.57079632679489662")
    assert rounds_to(m - q, "1.19318220847714886")
    assert abs(4 * pi / (3 * pi - 4) - decimal("2.31647")) < mpf(10) ** -5  # cut, not rounded


def test_gg_equal_accelerations_from_rest() -> None:
    m, q = gg_constants()
    ca = (m + mp.sqrt(m**2 + 4 * (m - q) * q)) / 2  # v0 = 0, v1 = 1: S = D = 1
    lam = q / (ca - (m - q))
    assert rounds_to(lam, "0.736048394432")
    assert rounds_to(ca, "3.32727602442")
    one, two = printed.gg_amplitudes(lam, mpf(0), mpf(1))
    assert abs(one - ca) < TINY
    assert abs(two + ca) < TINY
    found = characteristic(make_law("modified-sine", "R-G", inflection=float(lam), v1=1.0))
    assert found.acceleration.value == pytest.approx(float(ca), rel=4e-15)
    assert found.deceleration.value == pytest.approx(-float(ca), rel=4e-15)


def test_gg_equal_accelerations_of_one_sign() -> None:
    one, two = printed.gg_amplitudes(mpf("0.5"), mpf("0.5"), mpf("1.5"))
    assert abs(one - pi / 2) < TINY
    assert abs(two - pi / 2) < TINY
    law = make_law("modified-sine", "G-G", inflection=0.5, v0=0.5, v1=1.5)
    f2 = law(np.array([0.125, 0.875]))[2]
    assert ulps(f2[0], pi / 2) <= 8.0
    assert ulps(f2[1], pi / 2) <= 8.0


def test_gg_amplitudes() -> None:
    one, two = printed.gg_amplitudes(decimal("0.4"), decimal("0.5"), decimal("1.5"))
    assert rounds_to(one, "1.66519985637433")
    assert rounds_to(two, "1.50786064040861")
    law = make_law("modified-sine", "G-G", inflection=0.4, v0=0.5, v1=1.5)
    f2 = law(np.array([0.1, 0.85]))[2]
    assert f2 == pytest.approx([1.66519985637433, 1.50786064040861], abs=5e-15 + 2e-15)


# G-U: check values of section 6.8 -------------------------------------------------------------


def gu_roots(v: Number, deceleration: Number) -> list[Number]:
    """Both roots of (206) with (206a)."""
    middle = 12 - pi - 2 * pi**2 * (v / deceleration) * printed.kappa()
    middle /= 2 * (4 - pi)
    square = mp.sqrt(middle**2 - (8 - 2 * pi**2 / deceleration) / (4 - pi))
    return [middle - square, middle + square]


def test_206_needs_the_other_root_for_fast_starts() -> None:
    low, high = gu_roots(decimal("2.5"), mpf(2))
    assert not 0 < low < 1
    assert rounds_to(high, "0.763553000587")
    assert abs(printed.gu_harmonic_amplitudes(high, decimal("2.5"))[1] + 2) < TINY


def test_206_may_have_two_roots() -> None:
    k = decimal("7.9")
    low, high = gu_roots(decimal("1.02") / printed.kappa(), 2 * pi**2 / k)
    assert rounds_to(low, "0.149")
    assert rounds_to(high, "0.784")


def test_206_has_one_root_as_a_rule() -> None:
    low, high = gu_roots(mpf("0.5"), mpf(4))
    assert 0 < low < 1 < high
    assert abs(printed.gu_harmonic_amplitudes(low, mpf("0.5"))[1] + 4) < TINY


def test_gu_equal_accelerations() -> None:
    v = mpf("0.5")
    a = (7 * pi - 12) * v
    b = 8 * pi - 16 * v + 4 * pi * v
    c = 4 * pi - 8 * v
    lam = 2 * c / (b + mp.sqrt(b**2 - 4 * a * c))
    ca, cb = printed.gu_harmonic_amplitudes(lam, v)
    assert rounds_to(lam, "0.399963536211179")
    assert rounds_to(ca, "3.92555940929420")
    assert abs(ca + cb) < TINY
    law = make_law("harmonic-combination", "G-U", inflection=0.399963536211179, v0=0.5)
    found = characteristic(law)
    assert found.acceleration.value == pytest.approx(3.92555940929420, abs=5e-15 + 4e-15)
    assert found.deceleration.value == pytest.approx(-3.92555940929420, abs=5e-15 + 4e-15)


def test_gu_equal_accelerations_of_one_sign() -> None:
    v = mpf(2)
    lam = 2 - mp.sqrt(4 - (8 - 4 * pi / v) / (4 - pi))
    ca, cb = printed.gu_harmonic_amplitudes(lam, v)
    assert abs(ca + pi / 2 * v) < TINY
    assert abs(cb + pi / 2 * v) < TINY


@pytest.mark.parametrize("inflection", [0.25, 0.5, 0.75])
def test_gu_limits_of_the_initial_velocity(inflection: float) -> None:
    lam = mpf(inflection)
    straight = pi / (2 + (pi - 2) * lam)
    assert abs(printed.gu_harmonic_amplitudes(lam, straight)[0]) < TINY
    soft = 1 / (printed.kappa() * lam)
    assert abs(soft * lam - decimal("2.31647")) < mpf(10) ** -5
    assert abs(printed.gu_harmonic_amplitudes(lam, soft)[1]) < TINY


# Characteristic values and their places -------------------------------------------------------

TABLE: list[tuple[tuple[str, str, dict[str, float]], str]] = [
    (
        ("straight-line", "R-R", {}),
        ("1.00000000000000@0 0@0 0@0 0@0 0@0 0@0 0@0"),
    ),
    (
        ("quadratic-parabola", "R-R", {}),
        (
            "2.00000000000000@0.500000 4.00000000000000@0 -4.00000000000000@0.500000 "
            "0@0 0@0 "
            "8.00000000000000@0.500000 -8.00000000000000@0.500000"
        ),
    ),
    (
        ("simple-sine", "R-R", {}),
        (
            "1.57079632679490@0.500000 4.93480220054468@0 -4.93480220054468@1.00000 "
            "0@0 -15.5031383401499@0.500000 "
            "3.87578458503748@0.250000 -3.87578458503748@0.750000"
        ),
    ),
    (
        ("polynomial-345", "R-R", {}),
        (
            "1.87500000000000@0.500000 5.77350269189626@0.211325 -5.77350269189626@0.788675 "
            "60.0000000000000@0 -30.0000000000000@0.500000 "
            "6.69426872749579@0.311018 -6.69426872749579@0.688982"
        ),
    ),
    (
        ("inclined-sine", "R-R", {}),
        (
            "2.00000000000000@0.500000 6.28318530717959@0.250000 -6.28318530717959@0.750000 "
            "39.4784176043574@0 -39.4784176043574@0.500000 "
            "8.16209713905398@0.333333 -8.16209713905398@0.666667"
        ),
    ),
    (
        ("modified-trapezoid", "R-R", {}),
        (
            "2.00000000000000@0.500000 4.88812376281326@0.125000 -4.88812376281326@0.625000 "
            "61.4259748123673@0 -61.4259748123673@0.500000 "
            "8.08998098231315@0.392522 -8.08998098231315@0.607478"
        ),
    ),
    (
        ("modified-sine", "R-R", {}),
        (
            "1.75960338595377@0.500000 5.52795707054409@0.125000 -5.52795707054409@0.875000 "
            "69.4663572887243@0 -23.1554524295748@0.500000 "
            "5.45775276271938@0.287299 -5.45775276271938@0.712701"
        ),
    ),
    (
        ("polynomial-345", "R-R", {"inflection": 0.4}),
        (
            "1.87500000000000@0.400000 7.21687836487032@0.169060 -4.81125224324688@0.746410 "
            "93.7500000000000@0 -46.8750000000000@0.400000 "
            "8.36783590936974@0.248814 -5.57855727291316@0.626779"
        ),
    ),
    (
        ("inclined-sine", "R-R", {"inflection": 0.4}),
        (
            "2.00000000000000@0.400000 7.85398163397448@0.200000 -5.23598775598299@0.700000 "
            "61.6850275068085@0 -61.6850275068085@0.400000 "
            "10.2026214238175@0.266667 -6.80174761587832@0.600000"
        ),
    ),
    (
        ("modified-trapezoid", "R-R", {"inflection": 0.4}),
        (
            "2.00000000000000@0.400000 6.11015470351657@0.100000 -4.07343646901105@0.550000 "
            "95.9780856443239@0 -95.9780856443239@0.400000 "
            "10.1124762278914@0.314018 -6.74165081859429@0.528973"
        ),
    ),
    (
        ("modified-sine", "R-R", {"inflection": 0.4}),
        (
            "1.75960338595377@0.400000 6.90994633818011@0.100000 -4.60663089212008@0.850000 "
            "108.541183263632@0 -36.1803944212106@0.400000 "
            "6.82219095339922@0.229839 -4.54812730226615@0.655241"
        ),
    ),
    (
        ("modified-sine", "G-G", {"inflection": 0.5, "v0": 0.5, "v1": 0.5}),
        (
            "1.37980169297689@0.500000 2.76397853527205@0.125000 -2.76397853527205@0.875000 "
            "34.7331786443621@0 -11.5777262147874@0.500000 "
            "2.51377144572150@0.245919 -2.51377144572150@0.754081"
        ),
    ),
    (
        ("modified-sine", "G-G", {"inflection": 0.5, "v0": 0.5, "v1": 1.5}),
        (
            "1.50000000000000@1.00000 1.57079632679490@0.125000 0@0 "
            "19.7392088021787@0 -19.7392088021787@1.00000 "
            "2.16867986908951@0.882128 0@0"
        ),
    ),
    (
        ("modified-sine", "R-G", {"inflection": 0.5, "v1": 1.0}),
        (
            "1.37980169297689@0.500000 4.33477486206694@0.125000 -1.19318220847715@0.875000 "
            "54.4723874465409@0 -18.1574624821803@0.500000 "
            "3.35596657837405@0.287299 -1.34752984247561@0.819076"
        ),
    ),
    (
        ("modified-sine", "G-R", {"inflection": 0.5, "v0": 1.0}),
        (
            "1.37980169297689@0.500000 1.19318220847715@0.125000 -4.33477486206694@0.875000 "
            "54.4723874465409@1.00000 -18.1574624821803@0.500000 "
            "1.34752984247561@0.180924 -3.35596657837405@0.712701"
        ),
    ),
    (
        ("sine-straight", "U-U", {"inflection": 0.5, "curved": 0.5}),
        (
            "1.22203094070331@0.250000 7.67824685154591@0 -7.67824685154591@1.00000 "
            "0@0 -48.2438478025312@0.250000 "
            "4.69152761147346@0.125000 -4.69152761147346@0.875000"
        ),
    ),
    (
        ("simple-sine", "U-U", {"inflection": 0.5}),
        (
            "1.57079632679490@0.500000 4.93480220054468@0 -4.93480220054468@1.00000 "
            "0@0 -15.5031383401499@0.500000 "
            "3.87578458503748@0.250000 -3.87578458503748@0.750000"
        ),
    ),
    (
        ("modified-trapezoid", "R-U", {"inflection": 0.5}),
        (
            "1.91671849275941@0.500000 4.68457860554044@0.125000 -4.21648368591815@0.625000 "
            "58.8681509293191@0 -58.8681509293191@0.500000 "
            "7.43026281419175@0.392522 -6.80963090609399@0.609308"
        ),
    ),
    (
        ("modified-trapezoid", "R-U", {"inflection": 0.526294328940461}),
        (
            "1.92092499452582@0.526294 4.46029844708141@0.131574 -4.46029844708141@0.644721 "
            "53.2494464167184@0 -59.1609587566358@0.526294 "
            "7.09005555826422@0.413164 -7.21920114230625@0.629854"
        ),
    ),
    (
        ("harmonic-combination", "R-U", {"inflection": 0.5}),
        (
            "1.65984793038002@0.500000 5.21456606415810@0.125000 -5.21456606415810@1.00000 "
            "65.5281697552709@0 -21.8427232517570@0.500000 "
            "4.85647192785072@0.287299 -4.32769334471135@0.750000"
        ),
    ),
    (
        ("harmonic-combination", "R-U", {"inflection": 0.528787514567007}),
        (
            "1.66528348932757@0.528788 4.94682857678641@0.132197 -5.55125610838660@1.00000 "
            "58.7794525675433@0 -19.5931508558478@0.528788 "
            "4.62220757116251@0.303841 -4.62220757116251@0.764394"
        ),
    ),
    (
        ("modified-trapezoid", "U-R", {"inflection": 0.5}),
        (
            "1.91671849275941@0.500000 4.21648368591815@0 -4.68457860554044@0.625000 "
            "58.8681509293191@1.00000 -58.8681509293191@0.500000 "
            "6.80963090609399@0.390692 -7.43026281419175@0.607478"
        ),
    ),
    (
        ("harmonic-combination", "U-R", {"inflection": 0.5}),
        (
            "1.65984793038002@0.500000 5.21456606415810@0 -5.21456606415810@0.875000 "
            "65.5281697552709@1.00000 -21.8427232517570@0.500000 "
            "4.32769334471135@0.250000 -4.85647192785072@0.712701"
        ),
    ),
    (
        ("harmonic-combination", "G-U", {"inflection": 0.5, "v0": 0.5}),
        (
            "1.48071294488418@0.500000 3.08100058292856@0.125000 -4.65179690972346@1.00000 "
            "38.7169951881370@0 -14.6140509975789@0.500000 "
            "2.96960766624976@0.249400 -3.44398795059988@0.750000"
        ),
    ),
    (
        ("harmonic-combination", "U-G", {"inflection": 0.5, "v1": 0.5}),
        (
            "1.48071294488418@0.500000 4.65179690972346@0 -3.08100058292856@0.875000 "
            "38.7169951881370@1.00000 -14.6140509975789@0.500000 "
            "3.44398795059988@0.250000 -2.96960766624976@0.750600"
        ),
    ),
    (
        ("polynomial-5", "U-U", {"a0": 6.0, "a1": -6.0}),
        (
            "1.50000000000000@0.500000 6.00000000000000@0 -6.00000000000000@1.00000 "
            "-12.0000000000000@0 -12.0000000000000@0 "
            "3.46410161513775@0.211325 -3.46410161513775@0.788675"
        ),
    ),
]
"""max f', max and min f'', max and min f''', max and min f' f'', each with the least z that has it;
15 and 6 digits."""


PAIRS = ((0,), (1, 2), (1, 2), (3, 4), (3, 4), (5, 6), (5, 6))
"""Which of the seven extremes are of the same quantity."""


def assert_extremes(law: Law, expected: list[tuple[str, str]], value_limit: float) -> None:
    """Compare the characteristic values of `law` with max f', max and min f'', max and min of the
    jerk, max and min f' f'', each as value and place, half a unit of the last digit each.

    Where the law runs back, f' is a difference, and no value keeps more than what 1e-15 of the
    largest of its kind is.
    """
    found = characteristic(law)
    extremes = (
        found.velocity,
        found.largest_acceleration,
        found.least_acceleration,
        found.largest_jerk,
        found.least_jerk,
        found.largest_moment,
        found.least_moment,
    )
    largest = [max(abs(float(expected[k][0])) for k in pair) for pair in PAIRS]
    for extreme, (value, place), most in zip(extremes, expected, largest, strict=True):
        true = float(value)
        limit = value_limit * np.spacing(abs(true)) + half_a_unit(value)
        if found.least_velocity.value < 0.0:
            limit += 1e-15 * most
        assert abs(extreme.value - true) <= limit
        assert extreme.place == pytest.approx(
            float(place), abs=PLACE_LIMIT + half_a_unit(place), rel=0
        )


def half_a_unit(text: str) -> float:
    """Half a unit of the last digit of a decimal number; a bare 0 is exact."""
    mantissa, _, exponent = text.partition("e")
    digits = len(mantissa.partition(".")[2])
    return 0.5 * 10.0 ** (int(exponent or 0) - digits) if digits else 0.0


PLACE_LIMIT = 1e-14
"""A turning point comes from a closed form of a dozen roundings in z and 1 - z, or from a root that
Newton's method polished."""


@pytest.mark.parametrize(
    ("terms", "row"), TABLE, ids=[f"{name} {task} {p}" for (name, task, p), _ in TABLE]
)
def test_characteristic_values_and_places(
    terms: tuple[str, str, dict[str, float]], row: str
) -> None:
    name, task, parameters = terms
    cells = [cell.partition("@") for cell in row.split()]
    law = make_law(name, task, **parameters)
    assert_extremes(law, [(value, place) for value, _, place in cells], LIMIT)


@pytest.mark.parametrize("case", CASES, ids=[case["id"] for case in CASES])
def test_characteristic_values_are_the_extremes_of_the_reference(case: dict[str, Any]) -> None:
    extrema = case["extrema"]
    keys = ("f1", "max"), ("f2", "max"), ("f2", "min"), ("f3", "max"), ("f3", "min")
    cells = [extrema[key][end] for key, end in (*keys, ("P", "max"), ("P", "min"))]
    expected = [(cell["value"], cell["z"]) for cell in cells]
    assert_extremes(law_of(case), expected, LIMIT)
    found, true = characteristic(law_of(case)), float(extrema["f1"]["min"]["value"])
    # A difference of end velocity and what the acceleration takes off it.
    limit = 1e-15 * max(abs(found.velocity.value), abs(true))
    assert found.least_velocity.value == pytest.approx(true, abs=limit, rel=0)
