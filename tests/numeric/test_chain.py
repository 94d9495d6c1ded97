"""Trains of any number of masses, against closed forms, impedances and matrix exponentials."""

from __future__ import annotations

import math
from itertools import pairwise
from typing import Any

import mpmath
import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

import camgeo
from camgeo.dynamics.oscillator.steady import (
    Base,
    Forcing,
    ResonanceError,
    Response,
    load_forcing,
    steady_state,
)
from camgeo.dynamics.oscillator.train import EPS, Stage, Train, chain, one_mass
from camgeo.numeric.arrays import ComplexArray, FloatArray, Side
from camgeo.units import TURN
from tests.effects.recorded import FIXTURES, differences
from tests.effects.recorded_scenes import of_fixture, small
from tests.strategies import attack

LIFT = 20.0

PIECES = (
    (0.0, 0.1, (0.0,)),
    (0.1, 0.4, (0.0, 0.0, 0.0, 10.0, -15.0, 6.0)),
    (0.4, 0.55, (1.0,)),
    (0.55, 1.0, (1.0, 0.0, 0.0, -10.0, 15.0, -6.0)),
)
"""A double dwell with polynomials 3-4-5: start, end, coefficients over the share of the piece."""


def polynomials(
    pieces: tuple[tuple[float, float, tuple[float, ...]], ...] = PIECES, lift: float = LIFT
) -> Base:
    edges = np.array([pieces[0][0], *(each[1] for each in pieces)])

    def jet(t: FloatArray, side: Side) -> FloatArray:
        place = np.clip(np.searchsorted(edges, t, side) - 1, 0, len(pieces) - 1)
        out = np.zeros((3, len(t)))
        for i, (low, high, factors) in enumerate(pieces):
            own = place == i
            law = np.polynomial.Polynomial(np.multiply(lift, factors))
            for order in range(3):
                values = law.deriv(order)((t[own] - low) / (high - low))
                out[order, own] = values / (high - low) ** order
        return out

    return Base(jet, edges)


def matrices(stages: list[Stage]) -> tuple[mpmath.matrix, ...]:
    """Masses, dampers and springs of M x'' + C x' + K x = what acts on the masses."""
    count = len(stages)
    m, c, k = (mpmath.zeros(count) for _ in range(3))
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
    return m, c, k


Acting = list[tuple[float, float, list[Any]]]
"""Start and end of a piece, and derivatives, from order 0, of what acts at its start."""


def moved_base(first: Stage) -> Acting:
    """What the moving base does to the first mass."""
    acting = []
    for low, high, factors in PIECES:
        span = mpmath.mpf(high) - mpmath.mpf(low)
        rises = [LIFT * f * mpmath.factorial(j) / span**j for j, f in enumerate((*factors, 0.0))]
        acting.append(
            (low, high, [first.stiffness * y + first.damping * v for y, v in pairwise(rises)])
        )
    return acting


def exact(stages: list[Stage], mass: int, acting: Acting, t: list[float]) -> FloatArray:
    """(n, 2, k) x and x' of each mass at `t` in the steady state of what acts on one `mass`, with
    the matrix exponential of each piece.

    The polynomial that acts is part of the state: p_j = tau^j / j!, p_j' = p_{j-1}.
    """
    count = len(stages)
    m, c, k = matrices(stages)
    inverse = m**-1
    system = mpmath.zeros(2 * count + 6)
    system[:count, count : 2 * count] = mpmath.eye(count)
    system[count : 2 * count, :count] = -inverse * k
    system[count : 2 * count, count : 2 * count] = -inverse * c
    for j in range(1, 6):
        system[2 * count + j, 2 * count + j - 1] = 1

    def moved(forces: list[Any], span: Any) -> tuple[mpmath.matrix, mpmath.matrix]:
        """What a state becomes, and what is added to it, `span` behind the start of a piece."""
        own = system.copy()
        for j, force in enumerate(forces):
            own[count + mass, 2 * count + j] = force / m[mass, mass]
        power = mpmath.expm(own * span)
        return power[: 2 * count, : 2 * count], power[: 2 * count, 2 * count]

    steps = [moved(forces, mpmath.mpf(high) - mpmath.mpf(low)) for low, high, forces in acting]
    whole, gained = mpmath.eye(2 * count), mpmath.zeros(2 * count, 1)
    for step, added in steps:
        whole, gained = step * whole, step * gained + added
    state = mpmath.lu_solve(mpmath.eye(2 * count) - whole, gained)
    found = np.zeros((count, 2, len(t)))
    for (low, high, forces), (step, added) in zip(acting, steps, strict=True):
        for number, place in enumerate(t):
            if low <= place < high:
                own, more = moved(forces, mpmath.mpf(place) - mpmath.mpf(low))
                found[:, :, number] = np.array(own * state + more, float).reshape(2, count).T
        state = step * state + added
    return found


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


def loaded() -> Acting:
    """The load on a mass."""
    acting: Acting = []
    for (low, high), ends in zip(pairwise(EDGES.tolist()), VALUES, strict=True):
        first, last = map(mpmath.mpf, ends)
        acting.append((low, high, [first, (last - first) / (mpmath.mpf(high) - mpmath.mpf(low))]))
    return acting


def states(response: Response, t: FloatArray, side: Side = "right") -> FloatArray:
    """(n, 3, k) x, x' and x'' of all masses."""
    base = response.base.jet(t, side)
    found = [
        response.mass_states(mass, t, side) + np.stack((base[0], base[1], 0.0 * t))
        for mass in range(len(response.train.shapes))
    ]
    return np.array(found)


def pulls(stages: list[Stage], x: FloatArray, base: FloatArray) -> FloatArray:
    """(n, k) the force in each spring and damper, positive if it pushes the mass behind it."""
    before = np.concatenate(([base[:2]], x[:-1, :2]))
    stiff = np.array([[each.stiffness] for each in stages])
    damp = np.array([[each.damping] for each in stages])
    return np.asarray(stiff * (before - x[:, :2])[:, 0] + damp * (before - x[:, :2])[:, 1])


def answers(stages: list[Stage], s: complex, output: int | None) -> tuple[list[complex], ...]:
    """x_i, and the forces of the links, with 50 digits: while the base moves by exp(s t), or while
    exp(s t) acts on the mass `output`."""
    with mpmath.workdps(50):
        m, c, k = matrices(stages)
        z = mpmath.mpc(s)
        acting = mpmath.zeros(len(stages), 1)
        base = int(output is None)
        acting[output or 0] = stages[0].stiffness + stages[0].damping * z if base else 1
        x = mpmath.lu_solve(m * z * z + c * z + k, acting)
        links = [
            complex((each.stiffness + each.damping * z) * (one - other))
            for each, one, other in zip(stages, [mpmath.mpf(base), *x[:-1]], x, strict=True)
        ]
        return [complex(each) for each in x], links


def of_reading(
    train: Train, weights: ComplexArray, lift: float, slope: float, s: complex
) -> complex:
    """The `Reading` while the base moves by exp(s t)."""
    parts = weights / (s - train.rates) + weights.conj() / (s - train.rates.conj())
    return complex(-0.5 * s * s * np.sum(parts) + lift + slope * s)


SIZES = st.floats(-1.0, 1.0).map(lambda power: 10.0**power)
ANY = st.one_of(st.just(0.0), st.floats(-3.0, 1.0).map(lambda power: 10.0**power))
HELD = st.builds(
    Stage,
    SIZES,
    SIZES.map(lambda k: 400.0 * k),
    ANY.map(lambda c: 10.0 * c),
    ANY.map(lambda g: 100.0 * g),
    ANY.map(lambda h: 10.0 * h),
)

CHAINS = {
    1: [Stage(0.7, 300.0, 1.3, 20.0, 0.4)],
    2: [Stage(0.7, 300.0, 1.3), Stage(0.2, 500.0, 0.6, 15.0, 0.2)],
    3: [Stage(1.0, 900.0, 9.0), Stage(0.3, 2000.0, 0.0, 30.0), Stage(0.5, 700.0, 2.0)],
}


# -- the modes -----------------------------------------------------------------------------------


@pytest.mark.parametrize("count", [1, 2, 3, 7, 40, 100])
def test_equal_masses_have_the_frequencies_of_the_closed_form(count: int) -> None:
    """2 w sin((2 k - 1) pi / (2 (2 n + 1))) with one end fixed and one free."""
    train = chain([Stage(0.3, 0.3 * 49.0)] * count)
    angles = (2.0 * np.arange(1, count + 1) - 1.0) * math.pi / (2.0 * (2 * count + 1))
    assert np.all(train.poles.real == 0.0)
    assert train.poles.imag == pytest.approx(14.0 * np.sin(angles), rel=8.0 * EPS)


@pytest.mark.parametrize("count", [2, 7, 40])
def test_damping_in_proportion_to_stiffness_damps_each_mode_with_its_frequency(count: int) -> None:
    """lambda^2 + b w_k^2 lambda + w_k^2 = 0; with b w_k above 2 a mode does not oscillate."""
    b, w = 0.11, 14.0
    train = chain([Stage(0.3, 0.3 * w * w, 0.3 * w * w * b)] * count)
    angles = (2.0 * np.arange(1, count + 1) - 1.0) * math.pi / (2.0 * (2 * count + 1))
    own = (2.0 * w * np.sin(angles)).astype(np.complex128)
    ratio = 0.5 * b * own
    root = np.sqrt(ratio * ratio - 1.0)
    wanted = np.concatenate((own * (-ratio + root), own * (-ratio - root)))
    wanted = wanted[wanted.imag >= 0.0]
    wanted = wanted[np.argsort(np.abs(wanted))]
    assert len(train.poles) == len(wanted)
    # A root is magnified by 1 / |sqrt(D^2 - 1)| near critical damping.
    near = 1.0 / np.min(np.abs(root))
    assert np.max(np.abs(train.poles / wanted - 1.0)) <= 64.0 * EPS * (1.0 + near) * count


@attack
@given(stages=st.lists(HELD, min_size=1, max_size=6), w=st.floats(-2.0, 3.0).map(lambda p: 10.0**p))
def test_the_modes_add_up_to_the_impedance_of_the_chain(stages: list[Stage], w: float) -> None:
    train = chain(stages)
    s = complex(0.3 * w, w)
    moved, pushed = answers(stages, s, None)
    peak = max(1.0, *map(abs, moved))
    # The sum of the modes' magnitudes, each with the rounding told.
    for mass in range(len(stages)):
        read = train.deflection(mass)
        told = np.abs(read.weights) * (train.doubt + train.drift) / np.abs(s - train.rates)
        off = of_reading(train, read.weights, read.lift, read.slope, s) - (moved[mass] - 1.0)
        assert abs(off) <= 32.0 * EPS * (abs(s) ** 2 * float(np.sum(told)) + peak)
        push = train.force(mass)
        told = np.abs(push.weights) * (train.doubt + train.drift) / np.abs(s - train.rates)
        size = abs(s) ** 2 * float(np.sum(told)) + abs(push.lift) + abs(push.slope * s)
        off = of_reading(train, push.weights, push.lift, push.slope, s) - pushed[mass]
        assert abs(off) <= 32.0 * EPS * (size + abs(pushed[mass]))


@pytest.mark.parametrize(
    "damping", [0.999, 1.0 - 1e-9, 1.0, 1.0 + 1e-12, 1.0 + 1e-6, 1.3, 30.0, 1e4]
)
def test_critical_damping_and_beyond_are_as_exact_as_any(damping: float) -> None:
    """The transfer of one mass, which is smooth there, though its modes are not."""
    w, s = 31.0, 1j * 23.0
    train = one_mass(w, damping)
    wanted = -s * s / (s * s + 2.0 * damping * w * s + w * w)
    read = train.deflection(0)
    got = of_reading(train, read.weights, read.lift, read.slope, s)
    assert abs(got - wanted) <= 256.0 * EPS * abs(wanted)


@pytest.mark.parametrize("damping", [0.0, 0.2])
def test_masses_and_stiffnesses_may_differ_by_many_powers_of_ten(damping: float) -> None:
    """A light mass on a soft spring behind a heavy one on a stiff spring has its own frequency."""
    train = chain([Stage(1e3, 1e15, 0.0), Stage(1e-6, 1e-3, 2.0 * damping * math.sqrt(1e-9))])
    w = math.sqrt(1e-3 / 1e-6)
    wanted = [w * complex(-damping, math.sqrt(1.0 - damping**2)), 1j * math.sqrt(1e12)]
    # The coupling is the ratio of the masses times that of the stiffnesses, far below rounding.
    assert train.poles.imag == pytest.approx([each.imag for each in wanted], rel=64.0 * EPS)
    assert train.poles[0].real == pytest.approx(wanted[0].real, rel=64.0 * EPS)


# -- the steady state ----------------------------------------------------------------------------


@attack
@given(stages=st.lists(HELD, min_size=1, max_size=5))
def test_motions_and_forces_obey_newton(stages: list[Stage]) -> None:
    """m x'' of each mass is what its springs and dampers exert, with the forces told, which are
    those of the deflections; and the state comes back after a turn.
    """
    train = chain(stages)
    assume(np.max(train.poles.real) < -1e-3)
    response = steady_state(train, polynomials(), 0.0)
    t = np.linspace(0.013, 0.987, 37)
    x = states(response, t)
    forces = response.forces(range(len(stages)), t, "right")
    bent = pulls(stages, x, response.base.jet(t, "right"))
    net = forces - np.append(forces[1:], [0.0 * t], axis=0)
    for i, each in enumerate(stages):
        told = [
            response.reading_error(read) + 16.0 * EPS * float(np.max(np.abs(value)))
            for read, value in zip(
                (train.deflection(i), train.velocity(i), train.acceleration(i)), x[i], strict=True
            )
        ]
        own = response.reading_error(train.force(i)) + 16.0 * EPS * float(np.max(np.abs(forces[i])))
        if i + 1 < len(stages):
            own += response.reading_error(train.force(i + 1))
            own += 16.0 * EPS * float(np.max(np.abs(forces[i + 1])))
        held = each.ground_stiffness * x[i, 0] + each.ground_damping * x[i, 1]
        off = np.max(np.abs(each.mass * x[i, 2] + held - net[i]))
        allowed = each.mass * told[2] + each.ground_stiffness * told[0]
        assert off <= allowed + each.ground_damping * told[1] + own
        before = (train.deflection(i - 1), train.velocity(i - 1)) if i else ()
        slack = [response.reading_error(read) for read in before] or [0.0, 0.0]
        off = np.max(np.abs(forces[i] - bent[i]))
        rounding = 16.0 * EPS * (each.stiffness * LIFT + each.damping * 400.0)
        allowed = each.stiffness * (told[0] + slack[0]) + each.damping * (told[1] + slack[1])
        assert off <= allowed + own + rounding
    first = states(response, np.zeros(1), "right")[:, :2, 0]
    last = states(response, np.ones(1), "left")[:, :2, 0]
    for i in range(len(stages)):
        for order, read in enumerate((train.deflection(i), train.velocity(i))):
            scale = 16.0 * EPS * float(np.max(np.abs(x[i, order])))
            assert (
                abs(first[i, order] - last[i, order]) <= 2.0 * response.reading_error(read) + scale
            )


@pytest.mark.parametrize("seed", range(12))
def test_errors_told_are_true(seed: int) -> None:
    """Of random trains of two masses, some near critical damping, against 40 digits."""
    rng = np.random.default_rng(seed)
    ratio = 1.0 + rng.choice([0.0, 1e-12, 1e-7, 1e-4, 0.1, -0.6])
    k, m = rng.uniform(50.0, 5000.0), rng.uniform(0.1, 3.0)
    stages = [
        Stage(m, k, 2.0 * ratio * math.sqrt(k * m)),
        Stage(1e-4 * m, rng.uniform(1e-4, 1.0) * k, rng.uniform(0.0, 0.05)),
    ]
    t = np.array([0.03, 0.31, 0.5, 0.77])
    with mpmath.workdps(40):
        moved = exact(stages, 0, moved_base(stages[0]), t.tolist())
        under_load = exact(stages, 1, loaded(), t.tolist())
    found = [(steady_state(chain(stages), polynomials(), x), moved) for x in (0.0, 1e-9, 1e-5)]
    by_load = steady_state(chain(stages), at_rest(), 0.0, load_forcing(load, EDGES, 0.0))
    for response, wanted in (*found, (by_load, under_load)):
        for mass in range(2):
            told = response.reading_error(response.train.deflection(mass))
            assert np.max(np.abs(states(response, t)[mass, 0] - wanted[mass, 0])) <= told
            assert told <= 1e-6 * np.max(np.abs(wanted)) or response is not by_load


def test_the_amplitude_in_a_rest_is_not_exceeded_at_critical_damping() -> None:
    """(a + b t) exp(-w t): |a| + |b| / w, and in between damping ratios nothing leaps."""
    found = []
    for damping in (1.0 - 1e-7, 1.0, 1.0 + 1e-7):
        w = 14.0
        response = steady_state(one_mass(w, damping), polynomials(), 0.0)
        e, velocity = response.states(np.array([0.4]), "right")[:2, 0]
        amplitude = float(response.free_amplitude(np.array([0.4]), "right")[0])
        assert amplitude == pytest.approx(abs(e) + abs(velocity + w * e) / w, rel=1e-6)
        rest = response.states(np.linspace(0.4, 0.55, 50), "left")[0]
        assert np.max(np.abs(rest)) <= amplitude
        found.append(amplitude)
    assert found == pytest.approx([found[1]] * 3, rel=1e-6)


# -- under load ----------------------------------------------------------------------------------


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
    moved, links = answers(stages, s, output)
    for i in range(len(stages)):
        for read, wanted in ((train.deflection(i), moved[i]), (train.force(i), links[i])):
            told = np.abs(read.loaded) * (train.doubt + train.drift) / np.abs(s - train.rates)
            off = summed(train, np.asarray(read.loaded), s) - wanted
            assert abs(off) <= 32.0 * EPS * (float(np.sum(told)) + abs(wanted))


@pytest.mark.parametrize(("count", "output"), [(1, 0), (2, 1), (3, 2), (3, 0)])
def test_under_load_it_is_that_of_the_matrix_exponential(count: int, output: int) -> None:
    """With 40 digits, and the motion of the base besides; what is told of the error is true."""
    stages = CHAINS[count]
    train = chain(stages, output)
    t = np.array([0.0, 0.05, 0.1, 0.23, 0.47, 0.55, 0.83])
    with mpmath.workdps(40):
        wanted = exact(stages, output, loaded(), t.tolist())
    moved = polynomials()
    both = steady_state(train, moved, 0.0, load_forcing(load, EDGES, 0.0))
    alone = steady_state(train, moved, 0.0)
    for i, each in enumerate(stages):
        got = both.mass_states(i, t, "right") - alone.mass_states(i, t, "right")
        for order, read in enumerate((train.deflection(i), train.velocity(i))):
            told = both.reading_error(read) + alone.reading_error(read)
            assert np.max(np.abs(got[order] - wanted[i, order])) <= told
        slip = wanted[i] - (wanted[i - 1] if i else 0.0)
        push = both.forces([i], t, "right")[0] - alone.forces([i], t, "right")[0]
        told = both.reading_error(train.force(i)) + alone.reading_error(train.force(i))
        rounding = 4.0 * EPS * each.stiffness * float(np.max(np.abs(wanted)))
        off = push + each.stiffness * slip[0] + each.damping * slip[1]
        assert np.max(np.abs(off)) <= told + rounding
        assert told <= 1e-11 * max(30.0, each.stiffness * 20.0)


def test_the_acceleration_of_the_output_jumps_with_the_load() -> None:
    """By the jump over its mass; no other mass feels it at once."""
    stages = CHAINS[3]
    response = steady_state(chain(stages, 1), polynomials(), 0.0, load_forcing(load, EDGES, 0.0))
    at = EDGES[1:2]
    jumps = [
        response.mass_states(i, at, "right") - response.mass_states(i, at, "left") for i in range(3)
    ]
    told = response.reading_error(response.train.acceleration(1))
    assert abs(jumps[1][2, 0] + 35.0 / stages[1].mass) <= 2.0 * told
    others = [jumps[i][2, 0] for i in (0, 2)] + [
        each[order, 0] for each in jumps for order in (0, 1)
    ]
    assert np.max(np.abs(others)) <= 2.0 * told


def test_a_constant_load_shortens_the_train_as_springs_in_series_do() -> None:
    train = chain([Stage(1.0, 300.0, 2.0), Stage(1.0, 150.0, 2.0)])
    steady = load_forcing(lambda t: np.full(len(t), -7.0), np.array([0.0, 1.0]), 0.0)
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
    steps = load_forcing(lambda t: np.where(t < 0.5, 0.0, 9.0), np.array([0.0, 0.5, 1.0]), 0.0)
    response = steady_state(one_mass(w, damping), at_rest(), 0.0, steps)
    left = math.exp(-0.5 * damping * w)
    amplitude = float(response.free_amplitude(np.array([0.5]), "right")[0])
    assert amplitude == pytest.approx(9.0 / w**2 / math.sqrt(1.0 - damping**2), rel=2.0 * left)


def test_a_load_alone_resonates() -> None:
    train = one_mass(3.0 * TURN, 0.0)

    def steps(count: int) -> Forcing:
        edges = np.linspace(0.0, 1.0, 2 * count + 1)
        return load_forcing(lambda t: np.sign(np.sin(count * TURN * t)), edges, 0.0)

    with pytest.raises(ResonanceError) as raised:
        steady_state(train, at_rest(), 0.0, steps(1))
    assert raised.value.harmonic == 3
    response = steady_state(train, at_rest(), 0.0, steps(2))  # harmonics 2, 6, 10 ... alone
    beyond = (1.0 / 5.0 - 1.0 / 9.0) / TURN**2  # at rest it would yield by p / w^2
    assert abs(response.harmonic(2)) == pytest.approx(2.0 / math.pi * beyond, rel=1e-9)
    assert response.harmonic(3) == 0.0


# The record ------------------------------------------------------------------------------------


def test_trains_have_the_results_of_the_record() -> None:
    made = {
        name: small(name)
        for name in (
            "train of two under load",
            "elastic train under load",
            "elastic train",
            "resonance",
            "jumps of the velocity",
        )
    }
    made["rocker before a train of moments"] = of_fixture("rocker before a train of moments")
    made["valve_train"] = camgeo.load(FIXTURES / "effects" / "valve_train.toml")
    assert not [each for name, design in made.items() for each in differences(name, design)]
