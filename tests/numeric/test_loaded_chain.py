"""Trains with a force on their output, against impedances and matrix exponentials."""

from __future__ import annotations

import math
from itertools import pairwise

import mpmath
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from camgeo.dynamics.oscillator.steady import Base, Forcing, ResonanceError, load_of, steady_state
from camgeo.dynamics.oscillator.train import EPS, Stage, Train, chain, one_mass
from camgeo.numeric.arrays import ComplexArray, FloatArray, Side
from camgeo.units import TURN
from tests.numeric.test_chain import CHAINS, HELD, polynomials
from tests.strategies import attack

EDGES = np.array([0.0, 0.1, 0.37, 0.55, 1.0])
VALUES = ((5.0, 5.0), (-30.0, 12.0), (12.0, 0.0), (0.0, 0.0))
"""The load at the start and the end of each piece, with a line between; it jumps twice."""


def load(t: FloatArray) -> FloatArray:
    place = np.clip(np.searchsorted(EDGES, t, "right") - 1, 0, len(VALUES) - 1)
    ends = np.array(VALUES)[place]
    share = (t - EDGES[place]) / np.diff(EDGES)[place]
    return np.asarray(ends[:, 0] + share * (ends[:, 1] - ends[:, 0]))


def at_rest() -> Base:
    def jet(t: FloatArray, _side: Side) -> FloatArray:
        return np.zeros((3, len(t)))

    return Base(jet, np.array([0.0, 1.0]))


def matrices(stages: list[Stage], output: int) -> tuple[mpmath.matrix, ...]:
    """Masses, dampers, springs and the place of the load, of M x'' + C x' + K x = b p."""
    count = len(stages)
    m, c, k, b = (mpmath.zeros(count, each) for each in (count, count, count, 1))
    b[output] = 1
    for i, each in enumerate(stages):
        m[i, i] = mpmath.mpf(each.mass)
        for matrix, own, ground in (
            (k, each.stiffness, each.ground_stiffness),
            (c, each.damping, each.ground_damping),
        ):
            matrix[i, i] += mpmath.mpf(own) + mpmath.mpf(ground)
            if i > 0:
                matrix[i - 1, i - 1] += mpmath.mpf(own)
                matrix[i, i - 1] -= mpmath.mpf(own)
                matrix[i - 1, i] -= mpmath.mpf(own)
    return m, c, k, b


def exact(stages: list[Stage], output: int, t: list[float]) -> FloatArray:
    """(n, 2, k) x and x' of each mass at `t`, with the base at rest: matrix exponentials of states
    to which p and p' belong.
    """
    with mpmath.workdps(40):
        count = len(stages)
        m, c, k, b = matrices(stages, output)
        inverse = m**-1
        system = mpmath.zeros(2 * count + 2)
        system[:count, count : 2 * count] = mpmath.eye(count)
        system[count : 2 * count, :count] = -inverse * k
        system[count : 2 * count, count : 2 * count] = -inverse * c
        system[count : 2 * count, 2 * count] = inverse * b
        system[2 * count, 2 * count + 1] = 1

        def moved(i: int, span: mpmath.mpf) -> tuple[mpmath.matrix, mpmath.matrix]:
            power = mpmath.expm(system * span)
            first, last = map(mpmath.mpf, VALUES[i])
            own = mpmath.matrix([first, (last - first) / (EDGES[i + 1] - mpmath.mpf(EDGES[i]))])
            return power[: 2 * count, : 2 * count], power[: 2 * count, 2 * count :] * own

        whole, gained = mpmath.eye(2 * count), mpmath.zeros(2 * count, 1)
        for i, (low, high) in enumerate(pairwise(EDGES.tolist())):
            step, added = moved(i, high - mpmath.mpf(low))
            whole, gained = step * whole, step * gained + added
        state = mpmath.lu_solve(mpmath.eye(2 * count) - whole, gained)
        found = np.zeros((count, 2, len(t)))
        for i, (low, high) in enumerate(pairwise(EDGES.tolist())):
            for number, place in enumerate(t):
                if low <= place < high:
                    step, added = moved(i, place - mpmath.mpf(low))
                    values = step * state + added
                    for row in range(2 * count):
                        found[row % count, row // count, number] = float(values[row])
            step, added = moved(i, high - mpmath.mpf(low))
            state = step * state + added
        return found


def summed(train: Train, weights: ComplexArray, s: complex) -> complex:
    """Re sum z v while the load is exp(s t)."""
    return complex(
        0.5 * np.sum(weights / (s - train.rates) + weights.conj() / (s - train.rates.conj()))
    )


@attack
@given(
    stages=st.lists(HELD, min_size=1, max_size=5),
    w=st.floats(-2.0, 3.0).map(lambda p: 10.0**p),
    data=st.data(),
)
def test_the_modes_add_up_to_the_compliance(
    stages: list[Stage], w: float, data: st.DataObject
) -> None:
    """Of motions and forces by a force on any mass."""
    output = data.draw(st.integers(0, len(stages) - 1))
    train, s = chain(stages, output), complex(0.3 * w, w)
    with mpmath.workdps(50):
        m, c, k, b = matrices(stages, output)
        z = mpmath.mpc(s)
        x = mpmath.lu_solve(m * z * z + c * z + k, b)
        before = [mpmath.mpf(0), *x[:-1]]
        links = [
            complex((each.stiffness + each.damping * z) * (one - other))
            for each, one, other in zip(stages, before, x, strict=True)
        ]
        moved = [complex(each) for each in x]
    for i in range(len(stages)):
        for read, wanted in ((train.deflection(i), moved[i]), (train.force(i), links[i])):
            told = np.abs(read.loaded) * (train.doubt + train.drift) / np.abs(s - train.rates)
            off = summed(train, np.asarray(read.loaded), s) - wanted
            assert abs(off) <= 32.0 * EPS * (float(np.sum(told)) + abs(wanted))


@pytest.mark.parametrize(("count", "output"), [(1, 0), (2, 1), (3, 2), (3, 0)])
def test_it_is_that_of_the_matrix_exponential(count: int, output: int) -> None:
    """With 40 digits, and the motion of the base besides; what is told of the error is true."""
    stages = CHAINS[count]
    train = chain(stages, output)
    t = np.array([0.0, 0.05, 0.1, 0.23, 0.47, 0.55, 0.83])
    wanted = exact(stages, output, t.tolist())
    moved = polynomials()
    both = steady_state(train, moved, 0.0, load_of(load, EDGES, 0.0))
    alone = steady_state(train, moved, 0.0)
    for i, each in enumerate(stages):
        got = both.states_of(i, t, "right") - alone.states_of(i, t, "right")
        for order, read in enumerate((train.deflection(i), train.velocity(i))):
            told = both.error_of(read) + alone.error_of(read)
            assert np.max(np.abs(got[order] - wanted[i, order])) <= told
        slip = wanted[i] - (wanted[i - 1] if i else 0.0)
        push = both.forces([i], t, "right")[0] - alone.forces([i], t, "right")[0]
        told = both.error_of(train.force(i)) + alone.error_of(train.force(i))
        rounding = 4.0 * EPS * each.stiffness * float(np.max(np.abs(wanted)))
        off = push + each.stiffness * slip[0] + each.damping * slip[1]
        assert np.max(np.abs(off)) <= told + rounding
        assert told <= 1e-11 * max(30.0, each.stiffness * 20.0)


@pytest.mark.parametrize("seed", range(12))
def test_errors_told_are_true(seed: int) -> None:
    """Of random trains of two masses, some near critical damping."""
    rng = np.random.default_rng(seed)
    ratio = 1.0 + rng.choice([0.0, 1e-12, 1e-7, 1e-4, 0.1, -0.6])
    k, m = rng.uniform(50.0, 5000.0), rng.uniform(0.1, 3.0)
    stages = [
        Stage(m, k, 2.0 * ratio * math.sqrt(k * m)),
        Stage(1e-4 * m, rng.uniform(1e-4, 1.0) * k, rng.uniform(0.0, 0.05)),
    ]
    t = np.array([0.03, 0.31, 0.5, 0.77])
    wanted = exact(stages, 1, t.tolist())
    response = steady_state(chain(stages), at_rest(), 0.0, load_of(load, EDGES, 0.0))
    for mass in range(2):
        off = np.max(np.abs(response.states_of(mass, t, "right")[0] - wanted[mass, 0]))
        told = response.error_of(response.train.deflection(mass))
        assert off <= told
        assert told <= 1e-6 * np.max(np.abs(wanted))


def test_the_acceleration_of_the_output_jumps_with_the_load() -> None:
    """By the jump over its mass; no other mass feels it at once."""
    stages = CHAINS[3]
    response = steady_state(chain(stages, 1), polynomials(), 0.0, load_of(load, EDGES, 0.0))
    at = EDGES[1:2]
    jumps = [
        response.states_of(i, at, "right") - response.states_of(i, at, "left") for i in range(3)
    ]
    told = response.error_of(response.train.acceleration(1))
    assert abs(jumps[1][2, 0] + 35.0 / stages[1].mass) <= 2.0 * told
    others = [jumps[i][2, 0] for i in (0, 2)] + [
        each[order, 0] for each in jumps for order in (0, 1)
    ]
    assert np.max(np.abs(others)) <= 2.0 * told


def test_a_constant_load_shortens_the_train_as_springs_in_series_do() -> None:
    train = chain([Stage(1.0, 300.0, 2.0), Stage(1.0, 150.0, 2.0)])
    steady = load_of(lambda t: np.full(len(t), -7.0), np.array([0.0, 1.0]), 0.0)
    response = steady_state(train, at_rest(), 0.0, steady)
    t = np.linspace(0.0, 1.0, 9)
    wanted = -7.0 * (1.0 / 300.0 + 1.0 / 150.0)
    assert response.states(t, "right")[0] == pytest.approx(wanted, rel=1e-12)
    assert response.at_rest(train.deflection(1), t, "left") == pytest.approx(wanted, rel=1e-12)
    assert response.forces([0, 1], t, "right") == pytest.approx(np.full((2, 9), 7.0), rel=1e-12)
    assert response.free_amplitude(t, "right") == pytest.approx(0.0, abs=1e-14)


def test_what_a_step_leaves_is_a_vibration_about_the_new_place_of_rest() -> None:
    """p / k (1 - cos w t) without damping, but for what is left after a turn."""
    w, damping = 40.0 * TURN, 0.02
    steps = load_of(lambda t: np.where(t < 0.5, 0.0, 9.0), np.array([0.0, 0.5, 1.0]), 0.0)
    response = steady_state(one_mass(w, damping), at_rest(), 0.0, steps)
    left = math.exp(-0.5 * damping * w)
    amplitude = float(response.free_amplitude(np.array([0.5]), "right")[0])
    assert amplitude == pytest.approx(9.0 / w**2 / math.sqrt(1.0 - damping**2), rel=2.0 * left)


def test_a_load_alone_resonates() -> None:
    train = one_mass(3.0 * TURN, 0.0)

    def steps(count: int) -> Forcing:
        edges = np.linspace(0.0, 1.0, 2 * count + 1)
        return load_of(lambda t: np.sign(np.sin(count * TURN * t)), edges, 0.0)

    with pytest.raises(ResonanceError) as raised:
        steady_state(train, at_rest(), 0.0, steps(1))
    assert raised.value.harmonic == 3
    response = steady_state(train, at_rest(), 0.0, steps(2))  # harmonics 2, 6, 10 ... alone
    beyond = (1.0 / 5.0 - 1.0 / 9.0) / TURN**2  # at rest it would yield by p / w^2
    assert abs(response.harmonic(2)) == pytest.approx(2.0 / math.pi * beyond, rel=1e-9)
    assert response.harmonic(3) == 0.0
