"""Values of laws: side by side, against dense samples of each law, and the inverse relations:
lambda for a given acceleration, c for C_v or C_a, and refusals.
"""

from __future__ import annotations

import math
import re
from decimal import Decimal
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from camgeo.errors import GeometryError
from camgeo.kinematics.laws import BALANCES, FAMILIES, make_law
from camgeo.kinematics.laws.comparison import QUANTITIES, LawEntry, Running, compare, law_entry
from camgeo.kinematics.laws.law import Characteristic, Law, characteristic
from camgeo.kinematics.laws.pulse import Parts
from camgeo.kinematics.laws.sine_straight import LEAST, curved_for
from camgeo.kinematics.motion import TASKS
from camgeo.kinematics.planning.build import balanced, equal_accelerations
from camgeo.units import TURN
from tests.strategies import attack

GIVEN: dict[str, float] = {"inflection": 0.4, "v0": 0.8, "v1": 1.2, "curved": 0.7}

PLACES = np.linspace(0.0, 1.0, 4001)

BESIDE = 1e-7
"""How far from a border the one-sided values are taken."""


def jumping(law: Law, order: int) -> list[float]:
    """Inner borders at which f' (1) or f'' (2) differs from one side to the other."""
    found = []
    for border in law.borders:
        left, right = law(np.array([border - BESIDE, border + BESIDE]))[order]
        steep = max(float(np.max(np.abs(law(PLACES)[order + 1]))), 1.0)
        if abs(right - left) > 4.0 * BESIDE * steep:
            found.append(border)
    return found


def expected_jumps(law: Law) -> tuple[list[float], list[float]]:
    """Shocks and jerks: what an end of the task has to be and is not, and jumps inside."""
    shocks, jerks = [], []
    for place, kind in ((0.0, law.task[0]), (1.0, law.task[-1])):
        velocity, acceleration = (float(each[0]) for each in law(np.array([place]))[1:3])
        if kind in "RU" and abs(velocity) > 1e-12:
            shocks.append(place)
        if kind in "RG" and abs(acceleration) > 1e-12:
            jerks.append(place)
    return shocks, sorted({*jerks, *jumping(law, 2)})


@pytest.mark.parametrize("task", TASKS)
def test_each_law_for_a_task_is_there_with_what_samples_find(task: str) -> None:
    entries = compare(task, GIVEN)
    assert [each.name for each in entries] == [
        name for name, family in FAMILIES.items() if task in family.tasks
    ]
    for entry in entries:
        taken = FAMILIES[entry.name].parameters[task]
        assert entry.task == task
        assert entry.ignored == tuple(key for key in GIVEN if key not in taken)
        if entry.law is None or entry.values is None:
            assert entry.reason
            continue
        assert entry.reason == ""
        law = entry.law
        assert {key: law.parameters[key] for key in GIVEN if key in taken} == {
            key: value for key, value in GIVEN.items() if key in taken
        }
        shocks, jerks = expected_jumps(law)
        assert entry.shocks == pytest.approx(shocks, abs=1e-12)
        assert entry.jerks == pytest.approx(jerks, abs=1e-12)
        assert_values(entry)
        # Boundary values that it takes, that nobody gave, and that are 0.
        at = {"0": law.start, "1": law.end}
        zero = [
            key
            for key in taken
            if key[1:] in ("0", "1") and key not in GIVEN and entry.name != "polynomial"
            if {"v": at[key[1]].velocity, "a": at[key[1]].acceleration, "j": at[key[1]].jerk}[
                key[0]
            ] == 0.0
        ]  # fmt: skip
        assert list(entry.assumed) == zero
        f = law(PLACES)[0]
        assert entry.overshoots == bool(np.max(f) > 1.0 + 1e-9 or np.min(f) < -1e-9)
        assert entry.runs_back == bool(np.min(law(PLACES)[1]) < -1e-9)


def assert_values(entry: LawEntry) -> None:
    """They are those of the law, but for what a shock or a jerk of their part makes infinite."""
    law = entry.law
    assert law is not None
    assert entry.values == characteristic(law)
    unbounded = set()
    for places, both in (
        (entry.shocks, (QUANTITIES[1::2], QUANTITIES[2::2])),
        (entry.jerks, (("jerk",), ("braking_jerk",))),
    ):
        for place in places:
            unbounded |= (
                set(both[0]) if law.inflection is None or place <= law.inflection else set()
            )
            unbounded |= (
                set(both[1]) if law.inflection is None or place >= law.inflection else set()
            )
    assert entry.unbounded == unbounded
    for quantity in QUANTITIES:
        value = None if quantity in unbounded else getattr(entry.values, quantity).value
        assert entry.bounded(quantity) == value


def test_only_what_is_asked_for_is_compared_in_its_order() -> None:
    found = compare("R-R", {}, ["scca", "cycloidal", "scca", "simple-sine"])
    assert [each.name for each in found] == ["scca", "inclined-sine", "simple-sine"]
    (refused,) = compare("G-G", {}, ["inclined-sine"])
    assert refused.law is None
    assert refused.values is None
    assert refused.reason == "inclined-sine is made for R-R"
    assert refused.bounded("velocity") is None
    assert not refused.runs_back
    assert not refused.overshoots
    (wrong,) = compare("R-R", {"inflection": 1.5}, ["modified-sine"])
    assert wrong.reason.startswith("inflection = 1.5: ")
    for task, stated, names, key in (
        ("R-X", {}, (), "task"),
        ("R-R", {"inflection": math.nan}, (), "inflection"),
        ("R-R", {}, (3,), "names"),
        ("R-R", {}, ("cycloid",), "law"),
    ):
        with pytest.raises(GeometryError) as caught:
            compare(task, stated, names)  # type: ignore[arg-type]  # wrong on purpose
        assert caught.value.key == key


@pytest.mark.parametrize("name", ["modified-trapezoid", "polynomial-345"])
def test_physical_values_are_those_of_the_move_in_time(name: str) -> None:
    """By differences of the lift over time, and the torque as power over the cam's speed."""
    speed, span, stroke = 7.5, math.radians(80.0), 22.0
    running = Running(speed, span, stroke)
    law = make_law(name)
    values = {key: getattr(law_entry(law).values, key).value for key in QUANTITIES}
    time = np.linspace(0.0, span / speed, 200_001)
    step = time[1]
    lift = stroke * law(speed * time / span)[0]
    velocity = np.gradient(lift, step)
    acceleration = np.gradient(velocity, step)
    inner = slice(5, -5)
    # 1 kg, mm/s and mm/s^2: 1e-6 W a rad/s.
    torque = 1e-6 * velocity * acceleration / speed
    for quantity, expected, within in (
        ("velocity", np.max(velocity), 1e-4),
        ("acceleration", np.max(acceleration[inner]), 1e-3),
        ("deceleration", np.min(acceleration[inner]), 1e-3),
        ("moment", np.max(torque[inner]), 1e-3),
        ("braking_moment", np.min(torque[inner]), 1e-3),
    ):
        assert running.physical(quantity, values[quantity]) == pytest.approx(expected, rel=within)
    jerk = running.physical("jerk", values["jerk"])
    assert jerk == pytest.approx(values["jerk"] * stroke * (speed / span) ** 3, rel=1e-14)
    assert running.physical("braking_jerk", 2.0) == pytest.approx(
        running.physical("jerk", 2.0), rel=1e-15
    )


def test_a_move_is_at_most_a_turn() -> None:
    assert Running(1.0, TURN, 1.0).span == TURN
    with pytest.raises(GeometryError, match="more than one turn") as caught:
        Running(1.0, TURN * (1.0 + 1e-9), 1.0)
    assert (caught.value.key, caught.value.value) == ("span", "360")
    for name in ("speed", "span", "stroke"):
        with pytest.raises(GeometryError, match="above 0") as caught:
            Running(**({"speed": 1.0, "span": 1.0, "stroke": 1.0} | {name: 0.0}))
        assert caught.value.key == name


# The inverse relations ----------------------------------------------------------------------------
NEAR_END = 1e-6

SHAPED = [
    (name, task)
    for name, family in FAMILIES.items()
    for task in family.tasks
    if family.parts is not None
]
TURNS = [(name, task) for name, task in SHAPED if "U" in task and name != "sine-straight"]
"""Laws of one parameter that turn."""

BOUNDS = {
    "modified-trapezoid": 32.0 * math.pi**2 / (15.0 * math.pi**2 + 8.0),
    "harmonic-combination": math.pi**2 / 4.0,
    "simple-sine": math.pi**2 / 4.0,
}
"""|f''_U| at lambda = 0: VDI 2143-1, remarks on (179) and (201); the simple sine's is that of a
quarter of a cosine over the whole move."""


def inflections() -> st.SearchStrategy[float]:
    """lambda from 1e-6 to 1 - 1e-6."""
    near = st.floats(1.0, 6.0).map(lambda exponent: 10.0**-exponent)
    edge = st.sampled_from([NEAR_END, 0.5, 1.0 - NEAR_END])
    return st.one_of(edge, st.floats(0.01, 0.99), near, near.map(lambda lam: 1.0 - lam))


def parts_of(name: str, task: str, **given_: float) -> Parts:
    """The two parts of a law."""
    make = FAMILIES[name].parts
    assert make is not None
    return make(task, given_)


def both_ends(lam: float) -> float:
    """The smaller of the two parts."""
    return min(lam, 1.0 - lam)


@pytest.mark.parametrize(("name", "task"), SHAPED)
@given(lam=inflections(), v0=st.floats(-0.5, 0.5), v1=st.floats(-0.5, 0.5))
@attack
def test_lambda_from_the_peaks(name: str, task: str, lam: float, v0: float, v1: float) -> None:
    """From C_a and from C_a*, from anywhere in (0, 1).

    For velocities below 1/2 the peak of a part falls all the way with its own length, like 1/length
    where that is short and by a factor above 0.05 elsewhere, so the error of lambda is 20 times the
    rounding of the peak at most; 1e-13 of it allows for the peaks' dozen roundings.
    """
    given_ = {"v0": v0 * (task[0] == "G"), "v1": v1 * (task[-1] == "G")}
    given_ = {key: value for key, value in given_.items() if key in FAMILIES[name].parameters[task]}
    parts = parts_of(name, task, **given_)
    a, b = parts.amplitudes(Decimal(lam))
    # Where the part itself is long its peak hardly depends on it: |da/dl| is at least the bound's
    # tenth, so an ulp of the peak is a few ulp of 1.
    assert float(parts.inflection_for_start(float(a))) == pytest.approx(lam, abs=1e-13)
    assert float(parts.inflection_for_end(-float(b))) == pytest.approx(lam, abs=1e-13)


@pytest.mark.parametrize(("name", "task"), [turn for turn in TURNS if "G" not in turn[1]])
def test_an_acceleration_that_is_too_gentle_is_refused(name: str, task: str) -> None:
    """It runs from the bound, taken where the other part has no length, to infinity."""
    key, sign = ("a0", 1.0) if task[0] == "U" else ("a1", -1.0)
    bound = sign * BOUNDS[name]
    law = make_law(name, task, **{key: bound * (1.0 + 1e-6)})
    assert law.inflection is not None
    assert min(law.inflection, 1.0 - law.inflection) < 1e-5
    for wrong in (bound * (1.0 - 1e-6), 0.0, -bound, -1e6 * bound):
        with pytest.raises(GeometryError) as caught:
            make_law(name, task, **{key: wrong})
        assert caught.value.key == "acceleration"
        reported = re.search(r"must be (above|below) (\S+)$", caught.value.message)
        assert reported is not None
        if key == "a1":
            assert reported[1] == "below"
            # 6 digits are printed.
            assert float(reported[2]) == pytest.approx(bound, rel=1e-5)
            assert make_law(name, task, a1=float(reported[2]) * (1.0 + 1e-5)).end.acceleration < 0.0


@pytest.mark.parametrize(("velocity", "wanted", "lam"), [(2.5, -2.0, 0.763553000587)])
def test_gu_with_a_fast_start(velocity: float, wanted: float, lam: float) -> None:
    """The plus sign of (206) beyond v_G = 4 pi/(3 pi - 4)."""
    law = make_law("harmonic-combination", "G-U", v0=velocity, a1=wanted)
    assert law.inflection == pytest.approx(lam, abs=1e-12)  # 12 digits are given
    assert law.end.acceleration == pytest.approx(wanted, rel=1e-14)


@pytest.mark.parametrize("wanted", [-5.0, -3.0])
def test_gu_that_does_not_exist(wanted: float) -> None:
    """v_G = 5: a negative radicand, or both roots outside."""
    with pytest.raises(GeometryError, match="no inflection point"):
        make_law("harmonic-combination", "G-U", v0=5.0, a1=wanted)


# The sine-straight combination -----------------------------------------------------------------


def curves() -> st.SearchStrategy[float]:
    """c from 1e-6 to 1."""
    near = st.floats(0.0, 6.0).map(lambda exponent: 10.0**-exponent)
    return st.one_of(st.just(1.0), st.just(1.0 - NEAR_END), st.floats(0.01, 1.0), near)


@given(curved=curves(), lam=inflections())
@attack
def test_c_from_ca(curved: float, lam: float) -> None:
    law = make_law("sine-straight", "U-U", curved=curved, inflection=lam)
    product = lam * law.start.acceleration
    # (130) has a double root at c = pi/(2 (pi - 2)) = 1.376; up to c = 1 the slope
    # d(product)/dc / product = (2 c k - pi)/(pi c - k c^2) stays above 0.4, k = pi - 2.
    assert curved_for(product) == pytest.approx(curved, rel=2e-15)


@given(curved=curves(), lam=inflections())
@attack
def test_lambda_and_c_from_both_turns(curved: float, lam: float) -> None:
    law = make_law("sine-straight", "U-U", curved=curved, inflection=lam)
    wanted = {"a0": law.start.acceleration, "a1": law.end.acceleration}
    try:
        back = make_law("sine-straight", "U-U", **wanted)
    except GeometryError:
        assert curved > 1.0 - 1e-14  # gentlest of all, and rounded beyond it
        return
    # lambda = -a1/(a0 - a1) has an error of an ulp of 1, of which the shorter part has a multiple.
    size = 1e-15 / both_ends(lam) + 1e-14
    assert back.parameters["inflection"] == pytest.approx(lam, abs=1e-15)
    assert back.start.acceleration == pytest.approx(wanted["a0"], rel=size)
    assert back.end.acceleration == pytest.approx(wanted["a1"], rel=size)


@pytest.mark.parametrize(
    ("given_", "key", "words"),
    [
        ({"a0": -1.0, "a1": 1.0}, "acceleration", "a0 must be positive and a1 negative"),
        ({"a0": 6.0, "a1": 6.0}, "acceleration", "a0 must be positive and a1 negative"),
        ({"a0": 4.0, "a1": -4.0}, "acceleration", r"must be at least pi\^2/4 = 2.4674"),
        ({"a0": 4.0, "inflection": 0.5}, "acceleration", r"must be at least pi\^2/4 = 2.4674"),
        ({"a1": -4.0, "inflection": 0.5}, "acceleration", r"must be at least pi\^2/4 = 2.4674"),
        ({"a0": 9.0, "a1": -9.0, "inflection": 0.5}, "inflection", "already determine inflection"),
        ({"a0": 9.0, "a1": -9.0, "curved": 0.5}, "curved", "already determine curved"),
        ({"a0": 9.0, "inflection": 0.5, "curved": 0.5}, "curved", "already determine curved"),
    ],
)
def test_what_a_sine_straight_refuses(given_: dict[str, float], key: str, words: str) -> None:
    with pytest.raises(GeometryError, match=words) as caught:
        make_law("sine-straight", "U-U", **given_)
    assert caught.value.key == key


def test_the_gentlest_turns_are_those_of_the_simple_sine() -> None:
    sine = make_law("simple-sine", "U-U")
    assert 0.5 * sine.start.acceleration == pytest.approx(LEAST, rel=1e-15)
    assert curved_for(LEAST) == 1.0
    with pytest.raises(GeometryError):
        curved_for(LEAST * (1.0 - 1e-15))


@pytest.mark.parametrize(("name", "task"), [turn for turn in SHAPED if "U" in turn[1]])
def test_two_wishes_for_one_parameter_are_refused(name: str, task: str) -> None:
    if name == "sine-straight":
        return  # it has two parameters
    key = "a0" if task[0] == "U" else "a1"
    with pytest.raises(GeometryError, match="state only one of them") as caught:
        make_law(name, task, **{key: 9.0, "inflection": 0.5})
    assert caught.value.key == "inflection"


# Equal peaks of both parts: VDI 2143-1, sections 6.2, 6.6 and 6.8 ------------------------------


def peaks_of(values: Characteristic, quantity: str) -> tuple[float, float]:
    """The largest magnitudes in the first part of a law and in the second."""
    pairs = {
        "acceleration": (values.acceleration, values.deceleration),
        "jerk": (values.jerk, values.braking_jerk),
        "moment": (values.moment, values.braking_moment),
    }
    first, second = pairs[quantity]
    return abs(first.value), abs(second.value)


@pytest.mark.parametrize(
    ("law", "quantity", "inflection"),
    [
        # The guideline says 0.526, 0.513, 0.522 and 0.5, 0.667, 0.529; the digits by mpmath.
        ("modified-trapezoid", "acceleration", 0.526294328940461),
        ("modified-trapezoid", "jerk", 0.513156266902126),
        ("modified-trapezoid", "moment", 0.521792013349567),
        ("harmonic-combination", "acceleration", 0.5),
        ("harmonic-combination", "jerk", 2.0 / 3.0),
        ("harmonic-combination", "moment", 0.528787514567007),
    ],
)
def test_the_claims_of_the_guideline(law: str, quantity: str, inflection: float) -> None:
    for task in ("R-U", "U-R"):  # both counted from the rest
        found = balanced(law, task, quantity, {})
        assert found == pytest.approx(inflection, abs=1e-14)
        first, second = peaks_of(characteristic(make_law(law, task, inflection=found)), quantity)
        assert first == pytest.approx(second, rel=1e-12)


@pytest.mark.parametrize(
    ("name", "task", "given_", "inflection", "peak"),
    [
        ("modified-sine", "R-G", {"v1": 1.0}, pytest.approx(0.736048394432, abs=1e-12),
         pytest.approx(3.32727602442, abs=1e-11)),
        ("modified-sine", "G-G", {"v0": 0.5, "v1": 1.5}, pytest.approx(0.5, abs=1e-14),
         pytest.approx(math.pi / 2.0, rel=1e-14)),
        # A straight line, wherever it bends not.
        ("modified-sine", "G-G", {"v0": 1.0, "v1": 1.0}, 0.5, 0.0),
        ("harmonic-combination", "G-U", {"v0": 0.5}, pytest.approx(0.399963536211179, abs=1e-14),
         pytest.approx(3.92555940929420, rel=1e-13)),
        ("harmonic-combination", "U-G", {"v1": 0.5}, pytest.approx(0.399963536211179, abs=1e-14),
         pytest.approx(3.92555940929420, rel=1e-13)),
    ],
)  # fmt: skip
def test_check_values_of_constant_velocities(
    name: str, task: str, given_: dict[str, float], inflection: object, peak: object
) -> None:
    found = equal_accelerations(name, task, given_)
    assert found == inflection
    values = characteristic(make_law(name, task, inflection=found, **given_))
    assert peaks_of(values, "acceleration") == (peak, peak)


@attack
@given(v0=st.floats(-3.0, 4.0), v1=st.floats(-3.0, 4.0))
def test_any_two_velocities_are_balanced_or_refused(v0: float, v1: float) -> None:
    given_values = {"v0": v0, "v1": v1}
    try:
        found = equal_accelerations("modified-sine", "G-G", given_values)
    except GeometryError:
        # Section 7: there is none only where N0 N1 = 0; here N0 or N1 is nearly 0.
        m, q, d = 2.0 * math.pi**2 / (math.pi + 4.0), math.pi / 2.0, v1 - v0
        n0, n1 = m * (1.0 - v1) + q * d, m * (1.0 - v0) - q * d
        assert min(abs(n0), abs(n1)) < 1e-9
        return
    assume(1e-9 < found < 1.0 - 1e-9)
    values = characteristic(make_law("modified-sine", "G-G", inflection=found, **given_values))
    size = max(1.0, abs(values.acceleration.value))
    first, second = peaks_of(values, "acceleration")
    # The rounding of lambda moves the amplitudes by its part of the shorter length.
    assert first == pytest.approx(second, abs=1e-14 * size / min(found, 1.0 - found) + 1e-13 * size)


@pytest.mark.parametrize(
    ("name", "task"),
    [
        (name, task)
        for name, family in FAMILIES.items()
        for task in family.tasks
        if "inflection" in family.parameters[task] and task not in ("R-R", "U-U")
    ],
)
def test_both_parts_have_the_same_extreme_in_samples(name: str, task: str) -> None:
    """Of each quantity at the lambda found for it, and not at another one."""
    taken = FAMILIES[name].parameters[task]
    given_values = {key: value for key, value in (("v0", 0.6), ("v1", 0.9)) if key in taken}
    for quantity in BALANCES:
        found = balanced(name, task, quantity, given_values)
        apart = []
        for shift in (0.0, 0.05):
            law = make_law(name, task, **given_values, inflection=found + shift)
            assert law.inflection is not None
            z = np.concatenate([
                start + (end - start) * np.linspace(1e-9, 1.0 - 1e-9, 2001)
                for start, end in pairwise((0.0, *sorted({*law.borders, law.inflection}), 1.0))
            ])  # fmt: skip
            _, f1, f2, f3 = law(z)
            values = np.abs({"acceleration": f2, "jerk": f3, "moment": f1 * f2}[quantity])
            first = z < law.inflection
            apart.append(np.max(values[first]) / np.max(values[~first]) - 1.0)
        assert abs(apart[0]) <= 1e-5
        assert abs(apart[1]) > 1e-2


@pytest.mark.parametrize(
    ("name", "quantity", "message"),
    [
        ("straight-line", "acceleration", "straight-line has no inflection point"),
        ("straight-line", "jerk", "no inflection point makes the jerk equal in both parts of"),
        ("quadratic-parabola", "jerk", "equal in both parts of quadratic-parabola for R-R"),
    ],
)
def test_where_nothing_makes_them_equal_that_is_said(
    name: str, quantity: str, message: str
) -> None:
    with pytest.raises(GeometryError, match=message) as caught:
        balanced(name, "R-R", quantity, {})
    assert caught.value.key == "inflection"
