"""The steady state of one mass against closed forms, and the shock spectrum of a move."""

from __future__ import annotations

import itertools
import math
from decimal import Decimal

import mpmath
import numpy as np
import pytest
from hypothesis import assume, example, given
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from camgeo.dynamics.oscillator import steady
from camgeo.dynamics.oscillator.steady import (
    MOST_PIECES,
    SAMPLES,
    Base,
    ResonanceError,
    Response,
    Shock,
    interpolated,
    series_values,
    shock,
    solve,
    steady_state,
    total_gain,
)
from camgeo.dynamics.oscillator.train import Train, one_mass
from camgeo.kinematics.laws import make_law
from camgeo.kinematics.laws.law import Law
from camgeo.kinematics.plan import Dwell, MotionPlan, Move
from camgeo.kinematics.time_course import ConstantSpeed, in_time
from camgeo.numeric.arrays import FloatArray, Side
from camgeo.units import TURN
from tests.laws import LAWS
from tests.strategies import attack


def shock_of(law: Law) -> Shock:
    """The move by `law`; velocities at its ends are shocks."""
    edges = np.array([0.0, *law.borders, 1.0])
    jumps = np.zeros(len(edges))
    jumps[0], jumps[-1] = law.start.velocity, -law.end.velocity
    return shock(lambda z: law(z)[0], lambda z: law(z)[2], edges, jumps)


def shock_spectrum(law: Law, ratios: FloatArray, damping: float = 0.0) -> FloatArray:
    """(n,) what remains after a move by `law`, as a share of the stroke."""
    return shock_of(law).residual(ratios, damping)


EPS = 2.0**-52
SMALLEST = 2.0**-1074
SMALLEST_NORMAL = 2.0**-1022


def cosine(edges: FloatArray) -> Base:
    """y = 1 - cos(2 pi t) over the period 1, cut at `edges`."""

    def jet(t: FloatArray, _: Side) -> FloatArray:
        cos, sin = np.cos(TURN * t), np.sin(TURN * t)
        return np.stack((1.0 - cos, TURN * sin, TURN**2 * cos, -(TURN**3) * sin))

    return Base(jet, edges)


def cam(rise: str = "modified-sine", fall: str = "polynomial-345") -> Base:
    """A double dwell of 20 mm; one turn lasts 1 s."""
    plan = MotionPlan(
        (
            Dwell(Decimal(30)),
            Move(Decimal(100), 20.0, make_law(rise)),
            Dwell(Decimal(40)),
            Move(Decimal(120), 0.0, make_law(fall)),
            Dwell(Decimal(70)),
        )
    )
    course = ConstantSpeed(TURN)

    def jet(t: FloatArray, side: Side) -> FloatArray:
        return in_time(plan.jet(TURN * t, side), course, TURN * t)

    return Base(jet, np.append(plan.borders, TURN) / TURN)


def triangle(t: FloatArray, side: Side) -> FloatArray:
    """Up in 0.25, down in 0.75."""
    up = t < 0.25 if side == "right" else t <= 0.25
    zero = np.zeros_like(t)
    lift = np.where(up, 4.0 * t, (1.0 - t) / 0.75)
    return np.stack((lift, np.where(up, 4.0, -1.0 / 0.75), zero, zero))


def loss(train: Train, period: float) -> float:
    """The smallest |1 - exp(lambda T)|: what rounding is divided by."""
    return float(np.min(np.abs(np.expm1(train.rates * period))))


# -- one mode ------------------------------------------------------------------------------------


def powers(rate: complex, count: int) -> list[mpmath.mpc]:
    """Integrals of exp(rate (1 - t)) t^j over [0, 1] by their recursion, with digits to lose."""
    with mpmath.workdps(40 + 8 * count):
        lam = mpmath.mpc(rate)
        found = [mpmath.expm1(lam) / lam]
        for j in range(1, count):
            found.append((j * found[-1] - 1) / lam)
        return found


@example(size=1.0, damping=0.0, factors=[5e-324])
@example(size=1.0, damping=0.5, factors=[5e-323, 0.0, -5e-323])
@attack
@given(
    size=st.floats(-6.0, 7.0).map(lambda power: 10.0**power),
    damping=st.floats(0.0, 0.999),
    factors=st.lists(st.floats(-1.0, 1.0), min_size=1, max_size=12),
)
def test_a_mode_under_a_polynomial_is_what_the_integrals_of_its_powers_say(
    size: float, damping: float, factors: list[float]
) -> None:
    rate = size * complex(-damping, math.sqrt(1.0 - damping**2))
    scale = sum(map(abs, factors))
    pieces = interpolated(
        lambda t: np.asarray(np.polynomial.polynomial.polyval(t, factors), dtype=np.float64),
        np.array([0.0, 1.0]),
        0.1,
    )
    assert pieces.series.shape[1] == 1 or scale < SMALLEST_NORMAL
    cells = solve(pieces, np.array([0]), np.array([rate]))
    got = total_gain(cells, np.zeros(1), 1.0)
    exact = complex(sum(c * x for c, x in zip(factors, powers(rate, len(factors)), strict=True)))
    # Some 25 roundings for each of at most 43 cells; the mode is at most scale, and scale by |rate|
    # times the degree. A subnormal result is rounded by half of the smallest number, whatever its
    # size: of fewer than 10,000, 24 and 34 at each of 17 nodes for the series and 8 for each of 25
    # coefficients on 43 cells.
    relative = 64.0 * EPS * scale * min(1.0, 24.0 / size)
    assert abs(got - exact) <= relative + 0.5 * 10_000 * SMALLEST


# -- the steady state ----------------------------------------------------------------------------


@attack
@given(
    ratio=st.floats(-6.0, 6.0).map(lambda power: 10.0**power),
    damping=st.one_of(st.just(0.0), st.floats(1e-3, 0.99)),
    cuts=st.lists(st.floats(0.01, 0.99), max_size=5, unique=True),
)
def test_a_single_harmonic_comes_back_as_its_transfer_says(
    ratio: float, damping: float, cuts: list[float]
) -> None:
    """e = Re(H exp(2 pi i t)) with H = -r^2 / (1 - r^2 + 2 i D r), r = 1 / ratio, less the mean."""
    train = one_mass(TURN * ratio, damping)
    assume(loss(train, 1.0) > 1e-3)
    response = steady_state(train, cosine(np.array([0.0, *sorted(cuts), 1.0])), 0.0)
    t = np.linspace(0.0, 1.0, 101)
    # r^2 / (1 - r^2 + 2 i D r), written so that it holds for every ratio
    factor = -1.0 / (ratio**2 - 1.0 + 2j * damping * ratio)
    wave = factor * np.exp(1j * TURN * t)
    exact = np.stack(
        (wave.real, (1j * TURN * wave).real, (-(TURN**2) * wave).real + TURN**2 * np.cos(TURN * t))
    )
    got = response.states(t, "right")
    share = np.abs(got - exact) / np.array(
        [[1.0], [TURN * max(1.0, ratio)], [TURN**2 * max(1.0, ratio) ** 2]]
    )
    # Near resonance the factor itself magnifies the rounding of w by its own magnitude.
    size = abs(factor)
    assert np.max(share) <= 1e-12 + 16.0 * EPS * size * max(1.0, size)
    assert np.max(share[0]) <= response.error + 16.0 * EPS * (1.0 + size * size)
    assert response.error <= 1e-11 + 64.0 * EPS * size * max(1.0, size)
    assert 2.0 * abs(response.harmonic(1)) == pytest.approx(
        abs(factor), rel=1e-11 + 8.0 * EPS * size
    )
    assert abs(response.harmonic(2)) == 0.0


@pytest.mark.parametrize("ratio", [1e-5, 0.04, 0.5, 7.3])
def test_lift_and_acceleration_as_forcing_give_the_same(
    ratio: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Also where the velocity jumps: what is a kick in one form is nothing in the other."""
    bases = (cam(), Base(triangle, np.array([0.0, 0.25, 1.0])))
    t = np.linspace(0.0, 1.0, 77)
    for base in bases:
        train = one_mass(TURN * ratio, 0.1)
        found = []
        for border in (math.inf, 0.0):
            monkeypatch.setattr(steady, "SOFT", border)
            response = steady_state(train, base, 0.0)
            assert response.forcing.soft == (border > 0.0)
            found.append(
                np.vstack((response.states(t, "right"), response.free_amplitude(t, "right")))
            )
        stroke = float(np.max(base.jet(t, "right")[0]))
        w = TURN * ratio
        # The acceleration's rounding grows with 1 / (w T)^2, which is why there are two forms; the
        # lift's comes back w^2 times in the acceleration.
        bound = stroke * 1e-13 * (1.0 + 1.0 / w**2) * np.array([1.0, 1.0 + w, 1.0 + w * w, 1.0])
        assert np.all(np.max(np.abs(found[0] - found[1]), axis=1) <= bound)


@pytest.mark.parametrize("ratio", [1.0, 3.0, 40.0])
def test_resonance_without_damping_has_no_steady_state(ratio: float) -> None:
    with pytest.raises(ResonanceError) as caught:
        steady_state(one_mass(TURN * ratio, 0.0), cam(), 0.0)
    assert caught.value.harmonic == ratio
    assert caught.value.frequency == pytest.approx(TURN * ratio, rel=1e-15)


def test_a_harmonic_that_the_base_does_not_have_is_no_resonance() -> None:
    response = steady_state(one_mass(TURN * 3.0, 0.0), cosine(np.array([0.0, 0.3, 1.0])), 0.0)
    t = np.linspace(0.0, 1.0, 51)
    assert response.states(t, "right")[0] == pytest.approx(-np.cos(TURN * t) / 8.0, abs=1e-13)
    assert response.harmonic(3) == 0.0
    with pytest.raises(ResonanceError):
        steady_state(one_mass(TURN, 0.0), cosine(np.array([0.0, 1.0])), 0.0)


def test_near_resonance_the_error_estimate_holds() -> None:
    """Against the closed form of the single harmonic, a millionth off it."""
    ratio = 1.0 + 1e-6
    response = steady_state(one_mass(TURN * ratio, 0.0), cosine(np.array([0.0, 0.4, 1.0])), 0.0)
    t = np.linspace(0.0, 1.0, 51)
    exact = -np.cos(TURN * t) / ((ratio - 1.0) * (ratio + 1.0))
    off = float(np.max(np.abs(response.states(t, "right")[0] - exact)))
    # The closed form itself magnifies the rounding of the ratio, by 1e6 twice.
    assert off <= response.error + 1e12 * EPS
    assert response.error <= 1e-2


def test_a_kink_that_is_no_edge_is_closed_in_on() -> None:
    """y'' = |t - c| less its mean, with the kink inside a piece: the error says what is left."""
    c = 0.3141592653589793
    mean = 0.5 * (c * c + (1.0 - c) ** 2)
    pieces = interpolated(lambda t: np.abs(t - c) - mean, np.array([0.0, 1.0]), 1e-14)
    assert 0.0 < pieces.error < 1e-13
    t = np.linspace(1e-3, 0.999, 333)
    place = np.clip(np.searchsorted(pieces.edges, t, "right") - 1, 0, len(pieces.edges) - 2)
    low, high = pieces.edges[place], pieces.edges[place + 1]
    values = series_values(pieces.series[:, place], (2.0 * t - low - high) / (high - low))
    assert np.max(np.abs(values - (np.abs(t - c) - mean))) <= 1e-11


def test_what_is_only_rounding_is_not_halved_without_end() -> None:
    """A force that is 0 but for its last digits is as rough on any piece; the error says so."""
    pieces = interpolated(lambda t: np.sin(1e9 * t * t) * 1e-17, np.array([0.0, 1.0]), 1e-14)
    assert len(pieces.edges) <= 2 * (MOST_PIECES + 1)
    assert 1e-18 < pieces.error < 1e-15


def test_a_base_at_rest_moves_nothing() -> None:
    def jet(t: FloatArray, _: Side) -> FloatArray:
        return np.zeros((4, len(t)))

    response = steady_state(one_mass(TURN * 3.0, 0.0), Base(jet, np.array([0.0, 1.0])), 0.0)
    assert np.all(response.states(np.linspace(0.0, 1.0, 9), "right") == 0.0)
    assert response.error == 0.0


def test_the_free_vibration_in_a_rest_dies_as_the_damping_says() -> None:
    base, w, damping = cam(), TURN * 11.0, 0.04
    response = steady_state(one_mass(w, damping), base, 0.0)
    t = np.array([131.0, 150.0, 169.0]) / 360.0
    amplitude = response.free_amplitude(t, "right")
    e, velocity = response.states(t, "right")[:2]
    damped = w * math.sqrt(1.0 - damping**2)
    assert amplitude == pytest.approx(np.hypot(e, (velocity + damping * w * e) / damped), rel=1e-11)
    assert amplitude == pytest.approx(amplitude[0] * np.exp(-damping * w * (t - t[0])), rel=1e-11)


def test_the_harmonics_are_those_of_the_deflection() -> None:
    response = steady_state(one_mass(TURN * 6.3, 0.05), cam(), 0.0)
    count = 4096
    series = np.fft.rfft(response.states(np.arange(count) / count, "right")[0]) / count
    for number in (1, 2, 6, 7, 20):
        # The third derivative of e jumps, so coefficients fall with k^-4 and fold back at k = 4096.
        assert abs(response.harmonic(number) - series[number]) <= 20.0 * 1e3 / 4096.0**4


def test_evaluation_in_any_order_is_that_of_each_alone() -> None:
    response: Response = steady_state(one_mass(TURN * 17.0, 0.01), cam(), 0.0)
    t = np.array([0.9, 0.1, 0.5, 0.1])
    together = response.states(t, "right")
    # The processor adds up four numbers at a time otherwise than one.
    alone = np.hstack([response.states(each[np.newaxis], "right") for each in t])
    assert together == pytest.approx(alone, rel=16.0 * EPS)
    assert together[:, 1] == pytest.approx(together[:, 3], rel=16.0 * EPS)


RATIOS = np.array(
    [1e-9, 1e-3, 0.1, 0.159, 0.16, 0.5, 0.99, 1.3, 2.5, 4.0, 7.7, 33.3, 211.4, 9999.3]
)


def closed_cycloidal(ratio: float) -> mpmath.mpf:
    """|sin(pi r)| / (pi r |1 - r^2|).

    The acceleration of the cycloidal law is 2 pi sin(2 pi z). With w = 2 pi r the integral of
    exp(i w (1 - z)) 2 pi sin(2 pi z) over [0, 1] is (2 pi)^2 (exp(i w) - 1) / ((2 pi)^2 - w^2)
    = (exp(i w) - 1) / (1 - r^2); its magnitude by w is that of the residual.
    """
    r = mpmath.mpf(ratio)
    return abs(mpmath.sin(mpmath.pi * r) / (mpmath.pi * r * (1 - r * r)))


def test_the_residual_of_a_cycloidal_rise_is_the_closed_form() -> None:
    with mpmath.workdps(40):
        exact = np.array([float(closed_cycloidal(float(ratio))) for ratio in RATIOS])
    got = shock_spectrum(make_law("cycloidal"), RATIOS)
    assert got == pytest.approx(exact, rel=0.0, abs=1e-14)
    # The residual falls with r^-3. Its pieces, of r^-2, cancel except for the rounding of their
    # phases, 2 pi r, so that it is known to r^-1.
    assert np.max(np.abs(got - exact) * RATIOS) <= 16.0 * 2.0**-52
    assert shock_spectrum(make_law("cycloidal"), np.ones(1))[0] == pytest.approx(0.5, abs=1e-14)


def modified_sine(ratio: float, damping: float) -> float:
    """Duhamel's integral of the modified sine, by quadrature with 30 digits.

    Its acceleration (VDI 2143-1, eqs. 57 to 65; Norton, chapter on double-dwell functions) is
    C sin(4 pi z) up to z = 1/8, C cos(4 pi (z - 1/8) / 3) up to 7/8 and C sin(4 pi (z - 1)) after,
    with C = 4 pi^2 / (4 + pi).
    """
    with mpmath.workdps(30):
        pi = mpmath.pi
        c = 4 * pi**2 / (4 + pi)
        w = 2 * pi * mpmath.mpf(ratio)
        rate = w * mpmath.mpc(-damping, mpmath.sqrt(1 - mpmath.mpf(damping) ** 2))
        eighth = mpmath.mpf(1) / 8
        parts = (
            (0, eighth, lambda z: mpmath.sin(4 * pi * z)),
            (eighth, 1 - eighth, lambda z: mpmath.cos(4 * pi * (z - eighth) / 3)),
            (1 - eighth, 1, lambda z: mpmath.sin(4 * pi * (z - 1))),
        )
        total = mpmath.mpc(0)
        for low, high, law in parts:
            cuts = mpmath.linspace(low, high, 2 + math.ceil(2.0 * ratio))
            total += mpmath.quad(lambda z, law=law: mpmath.exp(rate * (1 - z)) * c * law(z), cuts)
        return float(abs(total) / (w * mpmath.sqrt(1 - mpmath.mpf(damping) ** 2)))


@pytest.mark.parametrize("damping", [0.0, 0.05])
@pytest.mark.parametrize("ratio", [0.05, 0.15, 0.7, 1.0, 2.3, 3.9, 12.6])
def test_the_residual_of_a_modified_sine_is_duhamels_integral(ratio: float, damping: float) -> None:
    got = float(shock_spectrum(make_law("modified-sine"), np.array([ratio]), damping)[0])
    assert abs(got - modified_sine(ratio, damping)) <= 2e-14


def test_a_straight_line_is_two_kicks() -> None:
    """Without damping 2 |sin(pi r)| / (2 pi r): they are one duration apart."""
    got = shock_spectrum(make_law("straight-line"), RATIOS)
    assert got == pytest.approx(np.abs(np.sinc(RATIOS)), rel=0.0, abs=1e-12)


@attack
@given(
    name=st.sampled_from(sorted(LAWS)),
    ratio=st.floats(0.2, 300.0),
    damping=st.floats(0.0, 0.9),
)
def test_no_residual_exceeds_its_bound(name: str, ratio: float, damping: float) -> None:
    move = shock_of(LAWS[name])
    further = ratio * np.linspace(1.0, 3.0, 40)
    # The variation is taken at 68 points a piece.
    assert np.max(move.residual(further, damping)) <= 1.01 * move.bound(ratio, damping)


def test_a_train_that_is_soft_against_the_move_is_left_by_all_of_it() -> None:
    for law in LAWS.values():
        assert shock_spectrum(law, np.array([1e-12])) == pytest.approx(1.0, abs=1e-11)


@pytest.mark.parametrize("damping", [0.0, 0.1])
@pytest.mark.parametrize("name", ["cycloidal", "modified-trapezoid", "straight-line"])
def test_the_largest_deflection_is_that_of_the_integrated_equation(
    name: str, damping: float
) -> None:
    """d'' + 2 D w d' + w^2 d = -y'', each piece of the law by itself, with its kicks between."""
    law = make_law(name, "R-R")
    edges = [0.0, *law.borders, 1.0]
    kick = law.start.velocity, -law.end.velocity
    for ratio in (0.4, 1.0, 2.6, 7.3):
        w, state, largest = 2.0 * math.pi * ratio, np.array([0.0, -kick[0]]), 0.0

        def rate(z: float, d: FloatArray, w: float = w) -> list[float]:
            force = float(law(np.array([z]))[2][0])
            return [d[1], -force - 2.0 * damping * w * d[1] - w * w * d[0]]

        for low, high in itertools.pairwise(edges):
            times = np.linspace(low, high, 500)
            inner = (low + 1e-12, high - 1e-12)
            ran = solve_ivp(rate, inner, state, "DOP853", times.clip(*inner), rtol=1e-9, atol=1e-12)
            state, largest = ran.y[:, -1], max(largest, float(np.max(np.abs(ran.y[0]))))
        remains = float(shock_spectrum(law, np.array([ratio]), damping)[0])
        got = float(shock_of(law).largest(np.array([ratio]), damping)[0])
        sampled = 1.0 - math.cos(math.pi / SAMPLES)  # each misses a maximum by so much at most
        assert got == pytest.approx(max(largest, remains), rel=2.0 * sampled, abs=1e-8)
