"""Errata of VDI 2143-1: each printed form fails by the residual that it is known for, each
corrected one holds, and camgeo has the corrected one.

"Fails" and "holds" mean the conditions that a law is made for: f(1) = 1, f'(0) = f'_G, continuity.
"""

from __future__ import annotations

import math
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from mpmath import mp, mpf

from camgeo.kinematics.laws import make_law
from camgeo.kinematics.laws.law import characteristic
from tests.motion import printed
from tests.motion.oracle import (
    DIGITS,
    decimal,
    exact,
    exact_pieces,
    integrated,
    shape_of,
    ulps,
    values_of,
)
from tests.motion.printed import Exact, Number, Piece, Pieces
from tests.reference import law_cases, law_terms
from tests.strategies import attack, inflections

HOLDS = mpf(10) ** -80
"""Residual of a right formula: of 100 digits lambda = 1e-6 costs 12, in C_a/lambda."""

CASES = law_cases()


@pytest.fixture(autouse=True)
def _digits() -> Any:
    with mp.workdps(DIGITS):
        yield


def residual(law: Pieces, v0: Number = 0, v1: Number = 0) -> Number:
    """Largest error of f(0) = 0, f'(0) = v0, f(1) = 1, f'(1) = v1 and jump of f, f', f'' inside."""
    first, last = law[0].formula(mpf(0)), law[-1].formula(mpf(1))
    errors = [first[0], first[1] - v0, last[0] - 1, last[1] - v1]
    for left, right in pairwise(law):
        before, after = left.formula(left.end), right.formula(right.start)
        errors += [a - b for a, b in zip(before[:3], after[:3], strict=True)]
    return max(abs(error) for error in errors)


def near(value: Number, published: str, units: float = 1.0) -> bool:
    """True if `value` is `published` to so many units of its last digit."""
    mantissa, _, exponent = published.lower().partition("e")
    digits = len(mantissa.partition(".")[2])
    unit = mpf(10) ** (int(exponent or 0) - digits)
    return bool(abs(value - decimal(published)) <= units * unit)


# The corrected formulas are right -------------------------------------------------------------


@pytest.mark.parametrize("case", CASES, ids=[case["id"] for case in CASES])
def test_the_corrected_print_gives_all_digits_of_the_reference(case: dict[str, Any]) -> None:
    """30 digits, cut at half a unit of the last: 5e-30; what is 0 there is 0 to 60 digits."""
    terms = law_terms(case)
    for point in case["points"]:
        keys = ("f", "g", "f1") if point.get("border") else ("f", "g", "f1", "f2", "f3")
        values = exact(*terms, float.fromhex(point["z_hex"]))
        for key, value in zip(keys, values, strict=False):
            true = decimal(point[key])
            assert abs(value - true) <= mpf(10) ** -28 * abs(true) + mpf(10) ** -60


@pytest.mark.parametrize("case", CASES, ids=[case["id"] for case in CASES])
def test_the_corrected_print_has_the_limits_of_the_reference_at_borders(
    case: dict[str, Any],
) -> None:
    law = exact_pieces(*law_terms(case))
    for border in case["borders"]:
        true_place = decimal(border["z"])
        for side in ("left", "right"):
            ends = [(p, p.end if side == "left" else p.start) for p in law]
            piece, place = min(ends, key=lambda entry: abs(entry[1] - true_place))
            if abs(place - true_place) > mpf(10) ** -28:
                assert true_place in (0, 1)  # no limit from outside
                continue
            values = values_of(piece, place)
            keys = ("f", "g", "f1", f"f2_{side}", f"f3_{side}")
            for key, value in zip(keys, values, strict=True):
                true = decimal(border[key])
                assert abs(value - true) <= mpf(10) ** -28 * abs(true) + mpf(10) ** -60


def boundary_velocity() -> st.SearchStrategy[float]:
    return st.one_of(st.just(0.0), st.floats(-5.0, 5.0))


TWO_AMPLITUDES = [
    ("modified-sine", "G-G"),
    ("modified-sine", "R-R"),
    ("modified-trapezoid", "R-R"),
    ("modified-trapezoid", "R-U"),
    ("harmonic-combination", "R-U"),
    ("harmonic-combination", "G-U"),
    ("sine-straight", "U-U"),
    ("simple-sine", "U-U"),
    ("simple-sine", "R-R"),
]
"""Laws that their shape of f'' and their boundary values determine."""


@pytest.mark.parametrize(("name", "task"), TWO_AMPLITUDES)
@attack
@given(
    lam=inflections(),
    v0=boundary_velocity(),
    v1=boundary_velocity(),
    share=st.floats(1e-6, 1.0),
    z=st.floats(0.0, 1.0),
)
def test_the_corrected_print_is_the_integral_of_its_shape(
    name: str, task: str, lam: float, v0: float, v1: float, share: float, z: float
) -> None:
    """Two ways to the law: printed formulas and amplitudes, or none of them. To 60 of 100 digits:
    lambda and c down to 1e-6 cost the equations of the amplitudes at most 36."""
    parameters = {"inflection": lam}
    if task[0] == "G":
        parameters["v0"] = v0
    if task == "G-G":
        parameters["v1"] = v1
    if name == "sine-straight":
        parameters["curved"] = share
    with mp.workdps(DIGITS):
        p = {key: mpf(value) for key, value in parameters.items()}
        other = integrated(shape_of(name, task, p), p.get("v0", mpf(0)), p.get("v1", mpf(0)))
        law = exact_pieces(name, task, parameters)
        assert len(law) == len(other)
        for one, two in zip(law, other, strict=True):
            assert abs(one.start - two.start) < mpf(10) ** -60
            place = one.start + mpf(z) * (one.end - one.start)
            for a, b in zip(values_of(one, place), values_of(two, place), strict=True):
                assert abs(a - b) <= mpf(10) ** -60 * (1 + abs(a))


# (194): the coefficient of lambda^2 -----------------------------------------------------------


def rounded_amplitudes(lam: Number, square: str) -> tuple[Number, Number]:
    """C_a and C_a* by (195) and (194) with that coefficient of lambda^2."""
    cb = 1 / (decimal("-0.40528") + decimal("0.44877") * lam - decimal(square) * lam**2)
    return -(1 - lam) / lam * cb, cb


@pytest.mark.parametrize(
    ("lam", "published"), [("0.5", "-3.8e-4"), ("0.75", "-1.8e-3"), ("0.97", "-2.5e-2")]
)
def test_194_misses_the_end_with_the_printed_coefficient(lam: str, published: str) -> None:
    place = decimal(lam)
    law = printed.ru_harmonic(place, rounded_amplitudes(place, "0.04379"))
    assert near(law[-1].formula(mpf(1))[0] - 1, published)
    corrected = printed.ru_harmonic(place, rounded_amplitudes(place, "0.04349"))
    assert abs(corrected[-1].formula(mpf(1))[0] - 1) <= decimal("2.0e-5")  # five digits
    assert residual(printed.ru_harmonic(place)) < HOLDS  # (193)


def test_194_misses_the_final_acceleration_by_nearly_half() -> None:
    lam = decimal("0.999")
    assert near(rounded_amplitudes(lam, "0.04379")[1], "-1512", 0.5)
    assert near(printed.ru_harmonic_amplitudes(lam)[1], "-2763.6", 0.5)
    found = characteristic(make_law("harmonic-combination", "R-U", inflection=0.999))
    assert found.deceleration.value == pytest.approx(-2763.6, abs=0.05)
    assert found.deceleration.place == 1.0


def test_194_has_the_coefficient_that_193_demands() -> None:
    assert near((4 - mp.pi) / (2 * mp.pi**2), "0.04349", 0.5)
    assert not near((4 - mp.pi) / (2 * mp.pi**2), "0.04379", 0.5)


# (219): C_v of G-U ----------------------------------------------------------------------------


def test_219_second_form_adds_the_initial_velocity_once_too_often() -> None:
    lam, v = mpf("0.5"), mpf("0.5")
    ca, cb = printed.gu_harmonic_amplitudes(lam, v)
    right = printed.gu_harmonic(lam, v)[1].formula(lam)[1]
    as_printed = 2 * (1 - lam) / mp.pi * abs(cb) + v
    assert near(as_printed, "1.98071", 0.5)
    assert near(right, "1.48071", 0.5)
    assert abs(as_printed - v - right) < HOLDS
    assert abs(2 * lam / mp.pi * ca + v - right) < HOLDS  # the first form
    found = characteristic(make_law("harmonic-combination", "G-U", inflection=0.5, v0=0.5))
    assert ulps(found.velocity.value, right) <= 8.0
    assert found.velocity.place == 0.5


def test_219_holds_only_for_a_positive_c_a() -> None:
    """Else the follower starts with its highest velocity."""
    lam, v = mpf("0.5"), mpf("1.6")
    ca, _ = printed.gu_harmonic_amplitudes(lam, v)
    assert ca < 0
    assert printed.gu_harmonic(lam, v)[1].formula(lam)[1] < v
    found = characteristic(make_law("harmonic-combination", "G-U", inflection=0.5, v0=1.6))
    assert found.velocity.value == 1.6
    assert found.velocity.place == 0.0


# (208), (209), (212), (213) and (216): f'_G inside the bracket --------------------------------


def gu_as_printed(lam: Number, v0: Number) -> Pieces:
    """G-U with f'_G z/|C_a| and f'_G/|C_a*| inside the brackets, which C_a and -C_a* multiply."""
    ca, cb = printed.gu_harmonic_amplitudes(lam, v0)
    first, second, third = printed.gu_harmonic(lam, v0)

    def moved(piece: Piece, slope: Number) -> Piece:
        def formula(z: Number) -> Exact:
            f, f1, f2, f3 = piece.formula(z)
            return f - v0 * z + slope * z, f1 - v0 + slope, f2, f3

        return Piece(piece.start, piece.end, formula)

    def last(z: Number) -> Exact:
        f, f1, f2, f3 = third.formula(z)
        constant = printed.kappa() * v0 * lam
        return f - constant - cb / abs(cb) * constant, f1, f2, f3

    slope = ca * (v0 / abs(ca))
    return moved(first, slope), moved(second, slope), Piece(third.start, third.end, last)


def test_208_to_213_start_with_the_wrong_sign_where_c_a_is_negative() -> None:
    lam, v = mpf("0.5"), mpf("1.6")
    law = gu_as_printed(lam, v)
    assert abs(law[0].formula(mpf(0))[1] + v) < HOLDS  # -f'_G: off by 3.2
    jump = law[2].formula(lam)[0] - law[1].formula(lam)[0]
    assert abs(jump - mpf("1.6")) < HOLDS
    assert residual(printed.gu_harmonic(lam, v), v0=v) < HOLDS


@pytest.mark.parametrize(("lam", "v"), [("0.5", "0.5"), ("0.25", "1.25"), ("0.75", "-2")])
def test_208_to_216_are_right_for_the_usual_signs(lam: str, v: str) -> None:
    ca, cb = printed.gu_harmonic_amplitudes(decimal(lam), decimal(v))
    assert ca > 0
    assert cb < 0
    assert residual(gu_as_printed(decimal(lam), decimal(v)), v0=decimal(v)) < HOLDS


def test_208_to_213_divide_zero_by_zero_where_the_start_is_straight() -> None:
    lam = mpf("0.5")
    v = mp.pi / (2 + (mp.pi - 2) * lam)
    assert abs(printed.gu_harmonic_amplitudes(lam, v)[0]) < HOLDS
    with pytest.raises(ZeroDivisionError):
        _ = mpf(0) * (v / abs(mpf(0)))
    law = printed.gu_harmonic(lam, v)
    assert residual(law, v0=v) < HOLDS
    assert abs(law[0].formula(lam / 8)[0] - v * lam / 8) < HOLDS


def test_216_misses_the_end_where_the_final_acceleration_is_positive() -> None:
    lam, v = mpf("0.5"), mpf("5")
    assert near(abs(gu_as_printed(lam, v)[2].formula(mpf(1))[0] - 1), "2.16", 0.5)
    assert residual(printed.gu_harmonic(lam, v), v0=v) < HOLDS


@pytest.mark.parametrize(
    ("inflection", "v0"), [(0.5, 1.6), (0.5, 0.5), (0.25, 1.5), (0.75, -2.0), (0.3, 7.0)]
)
def test_camgeo_has_208_to_216_right_for_all_signs(inflection: float, v0: float) -> None:
    law = make_law("harmonic-combination", "G-U", inflection=inflection, v0=v0)
    z = np.array([0.0, inflection, 1.0])
    f, f1, _, _ = law(z)
    assert f[0] == 0.0
    assert f[2] == 1.0
    assert f1[0] == v0
    assert f1[2] == 0.0
    true = exact("harmonic-combination", "G-U", {"inflection": inflection, "v0": v0}, inflection)
    assert f[1] == pytest.approx(float(true[0]), abs=1e-15 * (1.0 + abs(float(true[0]))), rel=0)


# U-R and U-G: changing signs ------------------------------------------------------------------


def test_221_after_the_change_of_signs_is_wrong() -> None:
    lam, v = mpf("0.4"), mpf("0.5")
    ca, cb = printed.gu_harmonic_amplitudes(lam, v)
    after = (cb * (1 - lam) - v * mp.pi / 2) / lam  # (221) with -C_a* for C_a*
    assert near(after, "-7.852", 0.5)
    assert near(-ca, "-3.925", 0.5)
    found = characteristic(make_law("harmonic-combination", "U-G", inflection=0.4, v1=0.5))
    assert ulps(found.deceleration.value, -printed.gu_harmonic_amplitudes(mpf(0.4), v)[0]) <= 8.0


@pytest.mark.parametrize(
    ("name", "amplitudes"), [("harmonic", True), ("harmonic", False), ("trapezoid", False)]
)
def test_203_needs_the_change_of_signs_inside_f(name: str, amplitudes: bool) -> None:
    """f_UR = 1 + f(1 - z): without C_a -> -C_a, C_a* -> -C_a* it starts at 2."""
    lam = mpf("0.5")
    if amplitudes:
        ca, cb = printed.ru_harmonic_amplitudes(lam)
        flipped = printed.ru_harmonic(lam, (-ca, -cb))
        assert abs(1 + flipped[-1].formula(mpf(1))[0]) < HOLDS
        # (204) and (205) with the signs changed are the mirror image.
        for z in (mpf("0.1"), mpf("0.6"), mpf("0.9")):
            true = exact("harmonic-combination", "U-R", {"inflection": 0.5}, z)
            piece = next(p for p in flipped[::-1] if p.start <= 1 - z)
            f, f1, f2, _ = piece.formula(1 - z)
            assert abs(1 + f - true[0]) < HOLDS
            assert abs(-f1 - true[2]) < HOLDS
            assert abs(f2 - true[3]) < HOLDS
        return
    forward = printed.ru_harmonic(lam) if name == "harmonic" else printed.ru_trapezoid(lam)
    assert abs(1 + forward[-1].formula(mpf(1))[0] - 2) < HOLDS
    assert residual(printed.mirrored(forward)) < HOLDS


@pytest.mark.parametrize("name", ["harmonic-combination", "modified-trapezoid"])
@pytest.mark.parametrize("inflection", [0.25, 0.5, 0.9])
def test_camgeo_mirrors_u_r_without_a_change_of_signs(name: str, inflection: float) -> None:
    forward = make_law(name, "R-U", inflection=inflection)
    back = make_law(name, "U-R", inflection=inflection)
    z = np.arange(1, 64) / 64.0 - 1.0 / 1024.0
    assert np.array_equal(back(z)[0], forward.complement(1.0 - z))
    assert np.array_equal(back(z)[1], forward(1.0 - z)[1])
    assert np.array_equal(back(z)[2], -forward(1.0 - z)[2])
    assert np.array_equal(back(z)[3], forward(1.0 - z)[3])
    assert back(np.zeros(1))[0][0] == 0.0


def test_the_jerk_keeps_its_sign_in_the_mirror() -> None:
    """Sections 6.6.3 and 6.8.2 have all characteristic values but C_v change sign."""
    end = exact("harmonic-combination", "U-R", {"inflection": 0.5}, 1)
    assert near(end[4], "65.528", 0.5)
    found = characteristic(make_law("harmonic-combination", "U-R", inflection=0.5))
    forward = characteristic(make_law("harmonic-combination", "R-U", inflection=0.5))
    assert ulps(found.largest_jerk.value, end[4]) <= 8.0
    assert found.largest_jerk.place == 1.0
    assert found.largest_jerk.value == forward.largest_jerk.value
    assert found.least_jerk.value == forward.least_jerk.value
    assert found.acceleration.value == -forward.deceleration.value
    assert found.deceleration.value == -forward.acceleration.value
    # The places of these are rounded.
    assert found.moment.value == pytest.approx(-forward.braking_moment.value, rel=4e-16)
    assert found.braking_moment.value == pytest.approx(-forward.moment.value, rel=4e-16)


# (76) to (81): the lost bars ------------------------------------------------------------------


@pytest.mark.parametrize("lam", [0.05, 0.4, 0.8])
@pytest.mark.parametrize("name", ["polynomial-345", "inclined-sine", "modified-sine"])
def test_76_to_81_have_the_values_of_the_base_law_on_the_right(name: str, lam: float) -> None:
    """As printed, C_a = C_a/(2 lambda) would leave only lambda = 1/2; (77) and (81) are
    magnitudes, and (78), (79) both positive."""
    base, law = characteristic(make_law(name)), characteristic(make_law(name, inflection=lam))
    rise, fall = 2.0 * lam, 2.0 * (1.0 - lam)
    assert law.velocity.value == pytest.approx(base.velocity.value, rel=1e-15)
    assert law.acceleration.value == pytest.approx(base.acceleration.value / rise, rel=2e-15)
    assert law.deceleration.value == pytest.approx(-base.acceleration.value / fall, rel=2e-15)
    assert law.moment.value == pytest.approx(base.moment.value / rise, rel=2e-15)
    assert law.braking_moment.value == pytest.approx(-base.moment.value / fall, rel=2e-15)
    start, end = (exact(name, "R-R", {"inflection": lam}, z)[4] for z in (0, 1))
    assert start > 0
    assert end > 0
    f3 = make_law(name, inflection=lam)(np.array([0.0, 1.0]))[3]
    assert ulps(f3[0], start) <= 8.0
    assert ulps(f3[1], end) <= 8.0
    assert float(start / end) == pytest.approx((fall / rise) ** 2, rel=1e-14)


# (82) to (94) and (130): lost -----------------------------------------------------------------


@pytest.mark.parametrize(
    ("lam", "v0", "v1"),
    [("0.5", "0", "0"), ("0.7", "-0.4", "2"), ("0.4", "3", "-1"), ("1e-6", "5", "-5")],
)
def test_90_and_91_make_95_to_110_continuous(lam: str, v0: str, v1: str) -> None:
    law = printed.gg_modified_sine(decimal(lam), decimal(v0), decimal(v1))
    assert residual(law, decimal(v0), decimal(v1)) < HOLDS
    assert abs(law[0].formula(mpf(0))[2]) < HOLDS
    assert abs(law[-1].formula(mpf(1))[2]) < HOLDS * 10**12  # sin 2 pi times C_a*
    # The velocity at the inflection point, (92).
    mean = decimal(lam) * decimal(v0) + (1 - decimal(lam)) * decimal(v1)
    middle = mean + 4 * mp.pi / (mp.pi + 4) * (1 - mean)
    assert abs(law[1].formula(decimal(lam))[1] - middle) < HOLDS * 10**6


def test_104_is_the_form_anchored_at_the_end() -> None:
    lam, v0, v1 = mpf("0.7"), mpf("-0.4"), mpf("2")
    m = 1 - lam
    _, cb = printed.gg_amplitudes(lam, v0, v1)
    s = m / (2 * mp.pi)
    third = printed.gg_modified_sine(lam, v0, v1)[2]
    for z in (lam, mpf("0.8"), 1 - m / 4):
        p = 2 * mp.pi * (z + (3 - 5 * lam) / 2) / (3 * m)
        anchored = 1 + v1 * (z - 1) - cb * s * (z - 1 - 4 * m / mp.pi - 9 * s * mp.sin(p))
        assert abs(third.formula(z)[0] - anchored) < HOLDS


@pytest.mark.parametrize(("lam", "c"), [("0.3", "0.8"), ("0.5", "1"), ("0.9", "0.001")])
def test_130_gives_c_back(lam: str, c: str) -> None:
    place, share = decimal(lam), decimal(c)
    ca = printed.uu_sine_straight(place, share)[0].formula(mpf(0))[2]
    root = mp.sqrt(1 - 2 * (mp.pi - 2) / (place * ca))
    assert abs(mp.pi / (2 * (mp.pi - 2)) * (1 - root) - share) < mpf(10) ** -50
    assert abs(mp.pi / (2 * share * (1 + share * (2 / mp.pi - 1)) * ca) - place) < HOLDS  # (128)


# (176), (198): C_j* is not the least f''' -----------------------------------------------------


@pytest.mark.parametrize("inflection", [0.2, 0.5, 0.54, 0.9])
@pytest.mark.parametrize(
    ("name", "share"), [("modified-trapezoid", 1), ("harmonic-combination", 3)]
)
def test_the_least_jerk_may_lie_before_the_inflection(
    name: str, share: int, inflection: float
) -> None:
    law = exact_pieces(name, "R-U", {"inflection": inflection})
    lam = mpf(inflection)
    (before,) = (piece for piece in law if piece.end == lam)
    (after,) = (piece for piece in law if piece.start == lam)
    start = law[0].formula(mpf(0))[3]
    left, right = before.formula(lam)[3], after.formula(lam)[3]
    assert abs(left + start / share) < HOLDS * start  # -C_j or -C_j/3
    found = characteristic(make_law(name, "R-U", inflection=inflection))
    assert ulps(found.least_jerk.value, min(left, right)) <= 8.0
    if name == "harmonic-combination":
        assert (left < right) == (inflection < 0.535898)
        assert near(2 / (2 + mp.sqrt(3)), "0.535898", 0.5)


# (166): a different look ----------------------------------------------------------------------


@pytest.mark.parametrize("lam", ["0.1", "0.5", "0.9"])
def test_166_is_right_as_printed(lam: str) -> None:
    place = decimal(lam)
    _, cb = printed.ru_trapezoid_amplitudes(place)
    z = (3 * place + 5) / 8
    as_printed = cb * ((z - 1) ** 2 / 2 - 1 / abs(cb))
    assert abs(printed.ru_trapezoid(place)[-1].formula(z)[0] - as_printed) < HOLDS


@pytest.mark.parametrize("lam", ["1e-6", "0.5", "0.999999"])
def test_169_and_193_have_the_factor_one_minus_lambda(lam: str) -> None:
    place, pi = decimal(lam), mp.pi
    trapezoid = -32 * pi**2 / (1 - place) / (15 * pi**2 + 8 - (3 * pi**2 - 8 * pi + 8) * place)
    harmonic = -2 * pi**2 / (1 - place) / (8 - (4 - pi) * place)
    for factored, amplitudes in (
        (trapezoid, printed.ru_trapezoid_amplitudes(place)),
        (harmonic, printed.ru_harmonic_amplitudes(place)),
    ):
        assert abs(factored / amplitudes[1] - 1) < HOLDS
    assert math.isclose(float(printed.gu_harmonic_amplitudes(place, mpf(0))[1] / harmonic), 1.0)
