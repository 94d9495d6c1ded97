"""VDI 2143-1: its errata, with what the printed form gives and what is right, and its values.

What is right is the integral of the shape of the acceleration, see `exact_laws`; the numbers are
those of docs/laws/errata.md. Rounded constants of the guideline are checked to their digits.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from mpmath import mp, mpf

from camgeo.kinematics.laws import make_law
from camgeo.kinematics.laws.law import Law, characteristic
from tests.motion.exact_laws import DIGITS, Number, decimal, exact, exact_pieces, ulps, values_of
from tests.reference import law_cases, law_of

pi = mp.pi


@pytest.fixture(autouse=True)
def _digits() -> Any:
    with mp.workdps(DIGITS):
        yield


def rounds_to(value: Number, text: str) -> bool:
    """Whether `text` is `value` rounded to the digits of `text`."""
    mantissa, _, exponent = text.partition("e")
    unit = mpf(10) ** (int(exponent or 0) - len(mantissa.partition(".")[2]))
    return bool(abs(value - decimal(text)) <= unit / 2)


def turn_harmonic(lam: str, v0: str = "0") -> tuple[Number, Number]:
    """C_a and C_a* of the harmonic combination from velocity v0 to a turn."""
    given = {"inflection": decimal(lam), "v0": decimal(v0)}
    start = exact("harmonic-combination", "G-U", given, decimal(lam) / 4)
    return start[3], exact("harmonic-combination", "G-U", given, 1)[3]


def turn_trapezoid(lam: str) -> tuple[Number, Number]:
    """C_a and C_a* of the trapezoid from rest to turn."""
    given = {"inflection": decimal(lam)}
    level, end = (exact("modified-trapezoid", "R-U", given, z)[3] for z in (decimal(lam) / 2, 1))
    return level, end


def rounded_194(lam: str, square: str) -> Number:
    """C_a* by the rounded equation (194) with that coefficient of lambda^2."""
    place = decimal(lam)
    return 1 / (decimal("-0.40528") + decimal("0.44877") * place - decimal(square) * place**2)


KAPPA = (3 * mp.pi - 4) / (4 * mp.pi)


@pytest.mark.parametrize(
    ("wrong", "printed", "right", "value"),
    [
        pytest.param(*each, id=equation)
        for equation, *each in [
            # Equation, what is printed and its value, what is right and its value.
            *(
                # Both amplitudes go with C_a*, and f(1) with them.
                (
                    f"(194) f(1) at {lam}",
                    lambda lam=lam: rounded_194(lam, "0.04379") / turn_harmonic(lam)[1],
                    wrong,
                    lambda lam=lam: rounded_194(lam, "0.04349") / turn_harmonic(lam)[1],
                    "1.0000",
                )
                for lam, wrong in (("0.5", "0.99962"), ("0.75", "0.9982"), ("0.97", "0.975"))
            ),
            (
                "(194) C_a* at 0.999",
                lambda: rounded_194("0.999", "0.04379"),
                "-1512",
                lambda: turn_harmonic("0.999")[1],
                "-2763.6",
            ),
            (
                "(219) C_v",
                lambda: mpf("0.5") + abs(turn_harmonic("0.5", "0.5")[1]) / pi,
                "1.98071",
                lambda: abs(turn_harmonic("0.5", "0.5")[1]) / pi,
                "1.48071",
            ),
            (
                "(209) f'(0) where C_a < 0",
                lambda: mpf("1.6") * mp.sign(turn_harmonic("0.5", "1.6")[0]),
                "-1.6",
                lambda: exact("harmonic-combination", "G-U", {"inflection": 0.5, "v0": 1.6}, 0)[2],
                "1.6",
            ),
            (
                "(216) f(1) where C_a* > 0",
                lambda: 1 - KAPPA * 5 * (1 + mp.sign(turn_harmonic("0.5", "5")[1])) / 2,
                "-1.16",
                lambda: exact("harmonic-combination", "G-U", {"inflection": 0.5, "v0": 5}, 1)[0],
                "1.00",
            ),
            (
                "(221) after the change of signs",
                lambda: (turn_harmonic("0.4", "0.5")[1] * mpf("0.6") - pi / 4) / mpf("0.4"),
                "-7.852",
                lambda: -turn_harmonic("0.4", "0.5")[0],
                "-3.925",
            ),
            (
                "(203) f(0) without the change of signs",
                lambda: 1 + exact("harmonic-combination", "R-U", {}, 1)[0],
                "2",
                lambda: exact("harmonic-combination", "U-R", {}, 0)[0],
                "0",
            ),
            (
                "section 6.8.2 f'''(1) of U-R",
                lambda: -exact("harmonic-combination", "R-U", {}, 0)[4],
                "-65.528",
                lambda: exact("harmonic-combination", "U-R", {}, 1)[4],
                "65.528",
            ),
        ]
    ],
)
def test_the_printed_form_gives_another_value(
    wrong: Callable[[], Number], printed: str, right: Callable[[], Number], value: str
) -> None:
    assert rounds_to(wrong(), printed)
    assert rounds_to(right(), value)
    assert printed != value


@pytest.mark.parametrize(
    ("task", "given", "quantity", "value", "place"),
    [
        ("R-U", {"inflection": 0.999}, "deceleration", -2763.6, 1.0),  # (194)
        ("G-U", {"inflection": 0.5, "v0": 0.5}, "velocity", 1.48071, 0.5),  # (219)
        ("G-U", {"inflection": 0.5, "v0": 1.6}, "velocity", 1.6, 0.0),  # where C_a < 0
        ("U-G", {"inflection": 0.4, "v1": 0.5}, "deceleration", -3.925, 0.9),  # (221)
        ("U-R", {"inflection": 0.5}, "largest_jerk", 65.528, 1.0),  # section 6.8.2
    ],
)
def test_camgeo_has_the_right_value(
    task: str, given: dict[str, float], quantity: str, value: float, place: float
) -> None:
    found = getattr(characteristic(make_law("harmonic-combination", task, **given)), quantity)
    assert found.value == pytest.approx(value, rel=5e-5)
    assert found.place == pytest.approx(place, rel=1e-14)


@pytest.mark.parametrize(("lam", "v0", "v1"), [("0.5", "0", "0"), ("0.7", "-0.4", "2")])
def test_90_and_91_are_what_docs_say_is_lost(lam: str, v0: str, v1: str) -> None:
    """C_a and C_a* of docs/laws/modified-sine.md."""
    place, start, end = decimal(lam), decimal(v0), decimal(v1)
    given = {"inflection": place, "v0": start, "v1": end}
    k, mean = 2 * pi**2 / (pi + 4), place * start + (1 - place) * end
    first = (k * (1 - mean) + pi / 2 * (1 - place) * (end - start)) / place
    second = -(k * (1 - mean) - pi / 2 * place * (end - start)) / (1 - place)
    for z, amplitude in ((place / 4, first), (1 - (1 - place) / 4, second)):
        assert abs(exact("modified-sine", "G-G", given, z)[3] - amplitude) < mpf(10) ** -60


@pytest.mark.parametrize("inflection", [0.2, 0.5, 0.54, 0.9])
@pytest.mark.parametrize(
    ("name", "share"), [("modified-trapezoid", 1), ("harmonic-combination", 3)]
)
def test_the_least_jerk_may_lie_before_the_inflection(
    name: str, share: int, inflection: float
) -> None:
    """C_j* of (176) and (198) is the value behind it; before it there is -C_j or -C_j/3."""
    law = exact_pieces(name, "R-U", {"inflection": inflection})
    (before,) = (piece for piece in law if piece.end == mpf(inflection))
    (after,) = (piece for piece in law if piece.start == mpf(inflection))
    left, right = (values_of(piece, inflection)[4] for piece in (before, after))
    start = values_of(law[0], 0)[4]
    assert abs(left + start / share) < mpf(10) ** -60 * start
    found = characteristic(make_law(name, "R-U", inflection=inflection))
    assert ulps(found.least_jerk.value, min(left, right)) <= 8.0
    assert (left < right) == (inflection < 0.535898) or share == 1


def moment_constant(name: str, part: int) -> tuple[Number, Number]:
    """The largest |f' f''| of a part of R-U at lambda = 1/2 by its length and its C_a squared, and
    where it is, as a share of the part; camgeo's own extreme, which other tests compare."""
    found = characteristic(make_law(name, "R-U", inflection=0.5))
    extreme = found.braking_moment if part else found.moment
    peak = found.deceleration if part else found.acceleration
    return abs(mpf(extreme.value)) * 2 / mpf(peak.value) ** 2, 2 * mpf(extreme.place) - part


@pytest.mark.parametrize(
    ("text", "value"),
    [
        # (170), (172), (174)
        ("0.49408", lambda: (15 * pi**2 + 8) / (32 * pi**2)),
        ("0.53358", lambda: 2 * (9 * pi**2 - 4 * pi + 8) / (32 * pi**2)),
        ("0.03950", lambda: (3 * pi**2 - 8 * pi + 8) / (32 * pi**2)),
        ("1.11102", lambda: (3 * pi + 2) / (2 * (pi + 2))),
        ("0.90915", lambda: (3 * pi + 2) / (4 * pi)),
        ("1.11102", lambda: -turn_trapezoid("0.5")[0] / turn_trapezoid("0.5")[1]),
        # (177), (178), (199): the largest f' f'' over their amplitudes, and their places
        ("0.6772", lambda: moment_constant("modified-trapezoid", 0)[0]),
        ("0.785", lambda: moment_constant("modified-trapezoid", 0)[1]),
        ("0.7660", lambda: moment_constant("modified-trapezoid", 1)[0]),
        ("0.2186", lambda: moment_constant("modified-trapezoid", 1)[1]),
        ("1.1222", lambda: pi * moment_constant("harmonic-combination", 0)[0]),
        ("0.5746", lambda: moment_constant("harmonic-combination", 0)[1]),
        # (180), (202)
        ("6.75373", lambda: (9 * pi**2 - 4 * pi + 8) / (3 * pi**2 - 8 * pi + 8)),
        ("25.31465", lambda: 32 * pi**2 / (3 * pi**2 - 8 * pi + 8)),
        ("5.15979", lambda: (12 - pi) / (8 - 2 * pi)),
        ("17.30387", lambda: ((12 - pi) / (8 - 2 * pi)) ** 2 - 8 / (4 - pi)),
        ("22.99515", lambda: 2 * pi**2 / (4 - pi)),
        # (194), with the erratum
        ("0.40528", lambda: 8 / (2 * pi**2)),
        ("0.44877", lambda: (12 - pi) / (2 * pi**2)),
        ("0.04349", lambda: (4 - pi) / (2 * pi**2)),
    ],
)
def test_rounded_constants(text: str, value: Callable[[], Number]) -> None:
    assert rounds_to(value(), text)


@pytest.mark.parametrize("lam", ["0.25", "0.5", "0.75"])
def test_180_and_202_give_lambda_nearly(lam: str) -> None:
    for middle, square, factor, peak in (
        ("6.75373", "33.10545", "25.31465", turn_trapezoid(lam)[1]),
        ("5.15979", "17.30387", "22.99515", turn_harmonic(lam)[1]),
    ):
        near = decimal(middle) - mp.sqrt(decimal(square) + decimal(factor) / abs(peak))
        assert abs(near - decimal(lam)) <= decimal("4.5e-6")


def test_tafel_2_the_parabola_has_the_least_c_a_and_not_the_least_c_v() -> None:
    names = (
        "simple-sine",
        "polynomial-345",
        "inclined-sine",
        "modified-trapezoid",
        "modified-sine",
    )
    parabola = characteristic(make_law("quadratic-parabola"))
    for other in (characteristic(make_law(name)) for name in names):
        assert other.velocity.value <= parabola.velocity.value == 2.0
        assert other.acceleration.value > parabola.acceleration.value == 4.0


def test_tafel_4_the_trapezoid_has_the_higher_jerk_only_behind_the_inflection() -> None:
    trapezoid, harmonic = (
        make_law(name, "R-U", inflection=0.5)(np.array([0.0, 0.5]))[3]
        for name in ("modified-trapezoid", "harmonic-combination")
    )
    assert trapezoid == pytest.approx([58.868, -52.986], abs=5e-4)
    assert harmonic == pytest.approx([65.528, -16.382], abs=5e-4)


# Characteristic values and their places, of the reference and of the guideline -----------------

LIMIT = 8.0
"""ulp, see test_laws."""

CASES = law_cases()

TABLE: list[tuple[tuple[str, str, dict[str, float]], str]] = [
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
        ("sine-straight", "U-U", {"inflection": 0.5, "curved": 0.5}),
        (
            "1.22203094070331@0.250000 7.67824685154591@0 -7.67824685154591@1.00000 "
            "0@0 -48.2438478025312@0.250000 "
            "4.69152761147346@0.125000 -4.69152761147346@0.875000"
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
        ("harmonic-combination", "R-U", {"inflection": 0.528787514567007}),
        (
            "1.66528348932757@0.528788 4.94682857678641@0.132197 -5.55125610838660@1.00000 "
            "58.7794525675433@0 -19.5931508558478@0.528788 "
            "4.62220757116251@0.303841 -4.62220757116251@0.764394"
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
