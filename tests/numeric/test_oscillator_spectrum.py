from __future__ import annotations

import itertools
import math

import mpmath
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from camgeo.dynamics.oscillator.steady import SAMPLES
from camgeo.kinematics.laws import make_law
from camgeo.numeric.arrays import FloatArray
from tests.laws import LAWS
from tests.numeric.shocks import shock_of, shock_spectrum
from tests.strategies import attack

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


def test_many_ratios_at_once_are_each_alone() -> None:
    ratios = np.linspace(0.01, 30.0, 301)
    move = shock_of(make_law("modified-trapezoid"))
    together = move.residual(ratios)
    for place in (0, 1, 127, 128, 129, 300):
        alone = move.residual(ratios[place : place + 1])[0]
        assert together[place] == pytest.approx(alone, rel=0.0, abs=1e-15)
    assert move.residual(np.empty(0)).shape == (0,)


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
