"""Trains of any number of masses, against closed forms, matrix exponentials and an integrator."""

from __future__ import annotations

import math
from itertools import pairwise

import mpmath
import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from camgeo.dynamics.oscillator.steady import Base, Response, steady_state
from camgeo.dynamics.oscillator.train import EPS, Stage, Train, chain, one_mass
from camgeo.numeric.arrays import ComplexArray, FloatArray, Side
from camgeo.units import TURN
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


def exact(stages: list[Stage], t: list[float], digits: int = 40) -> FloatArray:
    """(n, 2, k) x and x' of each mass at `t`, with the matrix exponential of each piece.

    The polynomial of the base is part of the state: p_j = tau^j / j!, p_j' = p_{j-1}.
    """
    with mpmath.workdps(digits):
        count = len(stages)
        system = mpmath.zeros(2 * count + 6)
        for i, each in enumerate(stages):
            system[i, count + i] = 1
            for j, (k, c) in (
                (i, (each.stiffness, each.damping)),
                (i, (each.ground_stiffness, each.ground_damping)),
            ):
                system[count + i, j] -= mpmath.mpf(k) / each.mass
                system[count + i, count + j] -= mpmath.mpf(c) / each.mass
            if i > 0:
                for at, col, sign, m in (
                    (i, i - 1, 1, each.mass),
                    (i - 1, i, 1, stages[i - 1].mass),
                    (i - 1, i - 1, -1, stages[i - 1].mass),
                ):
                    system[count + at, col] += sign * mpmath.mpf(each.stiffness) / m
                    system[count + at, count + col] += sign * mpmath.mpf(each.damping) / m
        for j in range(1, 6):
            system[2 * count + j, 2 * count + j - 1] = 1
        first = stages[0]
        whole, gained = mpmath.eye(2 * count), mpmath.zeros(2 * count, 1)

        def moved(piece: int, span: mpmath.mpf) -> tuple[mpmath.matrix, mpmath.matrix]:
            """What a state becomes, and what is added to it, `span` behind the start of a piece."""
            low, high, factors = PIECES[piece]
            length = mpmath.mpf(high) - mpmath.mpf(low)
            own = system.copy()
            rises = [LIFT * f * mpmath.factorial(j) / length**j for j, f in enumerate(factors)]
            for j, rise in enumerate(rises):
                own[count, 2 * count + j] += first.stiffness * rise / first.mass
                if j > 0:
                    own[count, 2 * count + j - 1] += first.damping * rise / first.mass
            power = mpmath.expm(own * span)
            return power[: 2 * count, : 2 * count], power[: 2 * count, 2 * count]

        for i, (low, high, _) in enumerate(PIECES):
            step, added = moved(i, mpmath.mpf(high) - mpmath.mpf(low))
            whole, gained = step * whole, step * gained + added
        state = mpmath.lu_solve(mpmath.eye(2 * count) - whole, gained)
        found = np.zeros((count, 2, len(t)))
        for i, (low, high, _) in enumerate(PIECES):
            for number, place in enumerate(t):
                if low <= place < high:
                    step, added = moved(i, mpmath.mpf(place) - mpmath.mpf(low))
                    values = step * state + added
                    for row in range(2 * count):
                        found[row % count, row // count, number] = float(values[row])
            step, added = moved(i, mpmath.mpf(high) - mpmath.mpf(low))
            state = step * state + added
        return found


def states(response: Response, t: FloatArray, side: Side = "right") -> FloatArray:
    """(n, 3, k) x, x' and x'' of all masses."""
    base = response.base.jet(t, side)
    found = [
        response.states_of(mass, t, side) + np.stack((base[0], base[1], 0.0 * t))
        for mass in range(len(response.train.shapes))
    ]
    return np.array(found)


def pulls(stages: list[Stage], x: FloatArray, base: FloatArray) -> FloatArray:
    """(n, k) the force in each spring and damper, positive if it pushes the mass behind it."""
    before = np.concatenate(([base[:2]], x[:-1, :2]))
    stiff = np.array([[each.stiffness] for each in stages])
    damp = np.array([[each.damping] for each in stages])
    return np.asarray(stiff * (before - x[:, :2])[:, 0] + damp * (before - x[:, :2])[:, 1])


def impedance(stages: list[Stage], s: complex) -> tuple[list[complex], list[complex]]:
    """x_i and the forces of the links while the base moves by exp(s t), with 50 digits."""
    with mpmath.workdps(50):
        s = mpmath.mpc(s)
        x, force = [mpmath.mpf(1)], [mpmath.mpf(0)]
        for number in range(len(stages) - 1, -1, -1):
            each = stages[number]
            own = (each.mass * s + each.ground_damping) * s + each.ground_stiffness
            force.append(force[-1] + own * x[-1])
            x.append(x[-1] + force[-1] / (each.stiffness + each.damping * s))
        moved = [complex(value / x[-1]) for value in x[-2::-1]]
        return moved, [complex(value / x[-1]) for value in force[:0:-1]]


def of_reading(
    train: Train, weights: ComplexArray, lift: float, slope: float, s: complex
) -> complex:
    """The `Reading` while the base moves by exp(s t)."""
    parts = weights / (s - train.rates) + weights.conj() / (s - train.rates.conj())
    return complex(-0.5 * s * s * np.sum(parts) + lift + slope * s)


SIZES = st.floats(-1.0, 1.0).map(lambda power: 10.0**power)
ANY = st.one_of(st.just(0.0), st.floats(-3.0, 1.0).map(lambda power: 10.0**power))
STAGES = st.builds(Stage, SIZES, SIZES.map(lambda k: 400.0 * k), ANY.map(lambda c: 10.0 * c))
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
    moved, pushed = impedance(stages, s)
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
    stages = [Stage(1e3, 1e15, 0.0), Stage(1e-6, 1e-3, 2.0 * damping * math.sqrt(1e-9))]
    train = chain(stages)
    w = math.sqrt(1e-3 / 1e-6)
    wanted = [w * complex(-damping, math.sqrt(1.0 - damping**2)), 1j * math.sqrt(1e12)]
    # The coupling is the ratio of the masses times that of the stiffnesses, far below rounding.
    assert train.poles.imag == pytest.approx([each.imag for each in wanted], rel=64.0 * EPS)
    assert train.poles[0].real == pytest.approx(wanted[0].real, rel=64.0 * EPS)


# -- the steady state ----------------------------------------------------------------------------


@pytest.mark.parametrize("count", [1, 2, 3])
def test_it_is_that_of_the_matrix_exponential(count: int) -> None:
    """With 40 digits; what is told of the error is true, of motions and forces."""
    stages = CHAINS[count]
    t = np.array([0.0, 0.05, 0.1, 0.23, 0.47, 0.55, 0.83])
    wanted = exact(stages, t.tolist())
    response = steady_state(chain(stages), polynomials(), 0.0)
    got = states(response, t)
    base = response.base.jet(t, "right")
    pushed = response.forces(range(count), t, "right")
    wanted_forces = pulls(stages, wanted, base)
    for mass in range(count):
        train = response.train
        assert response.error_of(train.deflection(mass)) <= 1e-11 * LIFT
        for order, read in enumerate((train.deflection(mass), train.velocity(mass))):
            off = np.max(np.abs(got[mass, order] - wanted[mass, order]))
            assert off <= response.error_of(read)
        # The reference forms the deflection from the masses' motions, to their rounding.
        rounding = 4.0 * EPS * LIFT * stages[mass].stiffness
        off = np.max(np.abs(pushed[mass] - wanted_forces[mass]))
        assert off <= response.error_of(train.force(mass)) + rounding


@pytest.mark.parametrize("count", [2, 40, 3, 7])
def test_it_solves_the_equations_as_an_integrator_does(count: int) -> None:
    from scipy.integrate import solve_ivp

    rng = np.random.default_rng(count)
    sizes = rng.uniform(0.5, 2.0, (count, 5)) * [1.0, 4e4, 20.0, 300.0, 2.0]
    stages = [Stage(*row) for row in sizes.tolist()]
    base = polynomials()
    response = steady_state(chain(stages), base, 0.0)
    m = sizes[:, :1]

    def rate(t: float, z: FloatArray, side: Side) -> FloatArray:
        x = z.reshape(2, count).T[:, :, np.newaxis]
        forces = pulls(stages, x, base.jet(np.array([t]), side))
        net = forces - np.append(forces[1:], [[0.0]], axis=0)
        net -= sizes[:, 3:4] * x[:, 0] + sizes[:, 4:5] * x[:, 1]
        return np.concatenate((x[:, 1, 0], (net / m)[:, 0]))

    for low, high in pairwise(base.edges[:3]):
        begin = states(response, np.array([low]))[:, :2, 0].T.ravel()
        found = solve_ivp(
            lambda t, z, middle=0.5 * (low + high): rate(t, z, "right" if t < middle else "left"),
            (low, high),
            begin,
            "DOP853",
            rtol=1e-11,
            atol=1e-12,
        )
        end = states(response, np.array([high]), "left")[:, :2, 0].T.ravel()
        off = np.abs(found.y[:, -1] - end)
        assert np.max(off[:count]) <= 1e-8  # of 20 mm, and what the tolerance adds up to
        assert np.max(off[count:]) <= 1e-8 * 400.0  # the highest natural frequency


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
            response.error_of(read) + 16.0 * EPS * float(np.max(np.abs(value)))
            for read, value in zip(
                (train.deflection(i), train.velocity(i), train.acceleration(i)), x[i], strict=True
            )
        ]
        own = response.error_of(train.force(i)) + 16.0 * EPS * float(np.max(np.abs(forces[i])))
        if i + 1 < len(stages):
            own += response.error_of(train.force(i + 1))
            own += 16.0 * EPS * float(np.max(np.abs(forces[i + 1])))
        held = each.ground_stiffness * x[i, 0] + each.ground_damping * x[i, 1]
        off = np.max(np.abs(each.mass * x[i, 2] + held - net[i]))
        allowed = each.mass * told[2] + each.ground_stiffness * told[0]
        assert off <= allowed + each.ground_damping * told[1] + own
        before = (train.deflection(i - 1), train.velocity(i - 1)) if i else ()
        slack = [response.error_of(read) for read in before] or [0.0, 0.0]
        off = np.max(np.abs(forces[i] - bent[i]))
        rounding = 16.0 * EPS * (each.stiffness * LIFT + each.damping * 400.0)
        allowed = each.stiffness * (told[0] + slack[0]) + each.damping * (told[1] + slack[1])
        assert off <= allowed + own + rounding
    first = states(response, np.zeros(1), "right")[:, :2, 0]
    last = states(response, np.ones(1), "left")[:, :2, 0]
    for i in range(len(stages)):
        for order, read in enumerate((train.deflection(i), train.velocity(i))):
            scale = 16.0 * EPS * float(np.max(np.abs(x[i, order])))
            assert abs(first[i, order] - last[i, order]) <= 2.0 * response.error_of(read) + scale


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
    wanted = exact(stages, t.tolist())
    for share in (0.0, 1e-9, 1e-5):
        response = steady_state(chain(stages), polynomials(), share)
        got = states(response, t)
        for mass in range(2):
            off = np.max(np.abs(got[mass, 0] - wanted[mass, 0]))
            assert off <= response.error_of(response.train.deflection(mass))


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


def test_a_closing_spring_shortens_the_train_as_springs_in_series_do() -> None:
    """So slowly that nothing else acts: (1 - k / (k + g)) of the lift is missing."""
    train = chain([Stage(1e-9, 300.0, 0.002), Stage(1e-9, 150.0, 0.002, 20.0)])
    response = steady_state(train, polynomials(), 0.0)
    t = np.array([0.45, 0.5, 0.54])
    both = 1.0 / (1.0 / 300.0 + 1.0 / 150.0)
    push = LIFT / (1.0 / both + 1.0 / 20.0)
    assert response.states(t, "right")[0] == pytest.approx(-push / both, rel=1e-9)
    assert response.forces([0, 1], t, "right") == pytest.approx(np.full((2, 3), push), rel=1e-9)


# -- one and two masses --------------------------------------------------------------------------


def test_two_masses_have_the_equations_of_their_own_page() -> None:
    """e_1'' = -2 D w e_1' - w^2 e_1 + m r - y'', e_2'' = -r - y'': the roots of

    (s^2 + a s + w^2 + m (b s + v^2)) (s^2 + b s + v^2) = m (b s + v^2)^2, a = 2 D w, b = 2 D_2 v.
    """
    w, damping, v, ratio, other = 4.3, 0.05, 9.0, 0.3, 0.02
    a, b = 2.0 * damping * w, 2.0 * other * v
    link = np.polynomial.Polynomial([v * v, b])
    first = np.polynomial.Polynomial([w * w, a, 1.0]) + ratio * link
    second = link + np.polynomial.Polynomial([0.0, 0.0, 1.0])
    roots = (first * second - ratio * link**2).roots()
    roots = roots[roots.imag > 0.0]
    train = chain([Stage(1.0, w * w, a), Stage(ratio, ratio * v * v, ratio * b)])
    assert train.poles == pytest.approx(roots[np.argsort(np.abs(roots))], rel=1e-13)


def test_a_small_second_mass_leaves_the_first_one_as_it_is() -> None:
    """To the first order in the ratio of the masses."""
    base, t = polynomials(), np.linspace(0.0, 1.0, 101)
    w, v = TURN * 4.3, TURN * 9.0
    alone = steady_state(one_mass(w, 0.05), base, 0.0).states(t, "right")[0]
    off = []
    for ratio in (1e-4, 1e-6, 1e-8):
        stages = [Stage(1.0, w * w, 0.1 * w), Stage(ratio, ratio * v * v, ratio * 0.1 * v)]
        found = steady_state(chain(stages, 0), base, 0.0).states(t, "right")[0]
        off.append(np.max(np.abs(found - alone)))
    assert off[0] / off[1] == pytest.approx(100.0, rel=0.01)
    assert off[1] / off[2] == pytest.approx(100.0, rel=0.01)


def test_masses_on_stiff_springs_are_one() -> None:
    base, t = polynomials(), np.linspace(0.0, 1.0, 101)
    w = TURN * 5.1
    one = steady_state(one_mass(w, 0.06), base, 0.0).states(t, "right")[0]
    off = []
    for stiff in (100.0, 1000.0):
        link = Stage(0.25, stiff**2 * w * w, stiff * w)
        stages = [Stage(0.25, w * w, 0.12 * w), link, link, link]
        found = steady_state(chain(stages), base, 0.0).states(t, "right")[0]
        off.append(np.max(np.abs(found - one)))
    assert off[0] < 1e-3 * float(np.max(np.abs(one)))
    assert off[0] / off[1] == pytest.approx(100.0, rel=0.1)  # with the inverse of the stiffness
