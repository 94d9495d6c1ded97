"""Windup of the camshaft: compared with own integrations of Newton's law in time, with the limit of
a stiff shaft, and with runs that are a hundred times as accurate.
"""

from __future__ import annotations

import itertools
import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from camgeo.design.design import Design
from camgeo.dynamics.effects.feedback import Passed, spread
from camgeo.dynamics.effects.forces import ElasticTrain
from camgeo.dynamics.effects.registry import find_effect
from camgeo.dynamics.effects.results import CAMSHAFT_WINDUP, DRIVE_TORQUE
from camgeo.dynamics.state.state import Used
from camgeo.errors import EffectError, SceneError
from camgeo.kinematics.time_course import period
from camgeo.numeric.arrays import FloatArray
from camgeo.scene.scene import parse_scene
from camgeo.studies.accuracy.survey import TIGHTER, compared
from camgeo.units import RPM, TURN
from tests.effects.scenes import SCENES
from tests.long_form import examples

MASS, PRELOAD, SPRING, SPEED = 1.5, 250.0, 8.0, 500.0
STIFFNESS, MOMENT, DAMPING = 1200.0, 0.002, 0.1

SCENE = f"""
camgeo = 1
name = "shaft"
[cam]
rotation = "ccw"
speed = {SPEED}
[follower]
kind = "translating-roller"
base_radius = 40
roller_radius = 10
[[motion]]
law = "polynomial-345"
span = 90
to = 20
[[motion]]
law = "polynomial-345"
span = 90
to = 0
[[motion]]
dwell = 180
[part]
thickness = 12
[effects.inertia]
mass = {MASS}
[effects.spring]
stiffness = {SPRING}
preload = {PRELOAD}
[effects.contact-force]
[effects.drive-torque]
[effects.kinematics]
[effects.camshaft-windup]
stiffness = {STIFFNESS}
moment_of_inertia = {MOMENT}
damping = {DAMPING}
tolerance = 1e-9
"""

FRICTION = """
[effects.friction]
rolling = 0.5
guide = 0.1
guide_length = 60
guide_overhang = 30
"""

PHI = np.linspace(0.003, TURN - 0.003, 400)


def scene(*changes: tuple[str, str], text: str = SCENE) -> Design:
    for old, new in changes:
        assert text.count(old) == 1, old
        text = text.replace(old, new)
    return Design(parse_scene(text))


def shaft(stiffness: float, moment: float, damping: float, tolerance: str = "1e-9") -> Design:
    return scene(
        (f"stiffness = {STIFFNESS}\n", f"stiffness = {stiffness!r}\n"),
        (f"moment_of_inertia = {MOMENT}", f"moment_of_inertia = {moment!r}"),
        (f"damping = {DAMPING}", f"damping = {damping!r}"),
        ("tolerance = 1e-9", f"tolerance = {tolerance}"),
    )


def figures(of: Design, name: str) -> dict[str, Any]:
    return {each.name: each for each in of.effects.findings(name)}


def lift(phi: float) -> tuple[float, float, float]:
    """s [mm] and its derivatives of the polynomial 10 x^3 - 15 x^4 + 6 x^5 up and down."""
    span = 0.5 * math.pi
    if phi >= 2.0 * span:
        return 0.0, 0.0, 0.0
    sign, x = (1.0, phi / span) if phi < span else (-1.0, 2.0 - phi / span)
    s = 20.0 * x**3 * (10.0 - 15.0 * x + 6.0 * x**2)
    s1 = 600.0 * x**2 * (1.0 - x) ** 2 / span * sign
    return s, s1, 1200.0 * x * (1.0 - x) * (1.0 - 2.0 * x) / span**2


def settled(stiffness: float, moment: float, damping: float) -> tuple[FloatArray, FloatArray]:
    """Windup and speed at `PHI` once a disturbance has died out, from Newton's law in time.

    (J + m s'^2) phi'' = k w + c (Omega - phi') - s' (m s'' phi'^2 + P + K s) and w' = Omega - phi',
    from rest of the shaft, in N, mm, s and t; each piece of the motion ends where it does.
    """
    drive, k, j, m = SPEED * RPM, 1e3 * stiffness, 1e3 * moment, 1e-3 * MASS
    c = 2.0 * damping * math.sqrt(k * j)

    def rates(_: float, state: Any) -> list[float]:
        phi, omega, w = state
        s, s1, s2 = lift(phi)
        moved = k * w + c * (drive - omega) - s1 * (m * s2 * omega**2 + PRELOAD + SPRING * s)
        return [omega, moved / (j + m * s1**2), drive - omega]

    state = [0.0, drive, 0.0]
    ends = [0.0, 0.5 * math.pi, math.pi, TURN]
    for _ in range(80):
        before, pieces = np.array(state), []
        state[0] = 0.0
        for low, high in itertools.pairwise(ends):

            def end(_: float, state: Any, high: float = high) -> float:
                return float(state[0]) - high

            end.terminal = True  # type: ignore[attr-defined]  # an event of scipy's
            # inside the piece: its polynomials, not those beyond its end
            found = solve_ivp(
                lambda t, y, low=low, high=high: rates(t, [min(max(y[0], low), high), *y[1:]]),
                (0.0, 2.0 * (high - low) / drive), state, "DOP853",
                events=end, dense_output=True, rtol=1e-12, atol=1e-13,
            )  # fmt: skip
            pieces.append((low, high, found.t[-1], found.sol))
            state = [high, *found.y_events[0][0][1:]]
        if np.max(np.abs(before[1:] - state[1:]) / [drive, 1.0]) < 1e-11:
            break
    values = []
    for phi in PHI:
        low, _, last, sol = next(each for each in pieces if each[1] >= phi)
        time = brentq(lambda t, sol=sol, phi=phi: sol(t)[0] - phi, 0.0, last, xtol=1e-16)
        values.append(sol(time)[1:])
    return np.array(values)[:, 1], np.array(values)[:, 0]


CASES = ((1200.0, 0.002, 0.1), (30.0, 0.003, 0.3), (400.0, 2e-4, 0.15))
"""A usual shaft, a soft one, and one with a light cam, whose follower is heavier than it."""


@pytest.mark.parametrize("case", CASES)
def test_the_motion_is_that_of_newtons_law(case: tuple[float, float, float]) -> None:
    turn = shaft(*case).effect(CAMSHAFT_WINDUP)
    windup, omega = settled(*case)
    errors, columns = turn.errors, {each.name: each for each in turn.columns}
    own = np.radians(columns["windup"].values(PHI, "right"))
    size = np.max(np.abs(windup))
    assert np.max(np.abs(own - windup)) <= math.radians(errors["windup"].error) + 1e-8 * size
    speed = RPM * columns["cam speed"].values(PHI, "right")
    assert np.max(np.abs(speed - omega)) <= RPM * errors["cam speed"].error + 1e-9 * SPEED
    assert size > 0.001
    assert np.ptp(omega) > 0.01 * SPEED * RPM


# Before an elastic train --------------------------------------------------------------------------


def elastic(
    case: tuple[float, float, float], frequency: float, damping: float, tolerance: str = "1e-8"
) -> Design:
    """The shaft with all the mass of its follower behind a spring."""
    train = f"[effects.vibration]\nnatural_frequency = {frequency!r}\ndamping = {damping!r}\n"
    stiffness, moment, own = case
    return scene(
        (f"stiffness = {STIFFNESS}\n", f"stiffness = {stiffness!r}\n"),
        (f"moment_of_inertia = {MOMENT}", f"moment_of_inertia = {moment!r}"),
        (f"damping = {DAMPING}", f"damping = {own!r}"),
        ("tolerance = 1e-9", f"tolerance = {tolerance}\n{train}"),
    )


def coupled(
    case: tuple[float, float, float], frequency: float, damping: float
) -> tuple[FloatArray, FloatArray]:
    """Windup and speed at `PHI` by `solve_ivp`, once all disturbances have died out.

    J phi'' = k w + c (Omega - phi') - s' (F + P + K s), m v' = F = m (n^2 (s - x) + 2 D n (s' phi'
    - v)), x' = v and w' = Omega - phi', over the cam angle, with the natural frequency n.
    """
    drive, k, j, mass = SPEED * RPM, 1e3 * case[0], 1e3 * case[1], 1e-3 * MASS
    c, n = 2.0 * case[2] * math.sqrt(k * j), TURN * frequency

    def rates(phi: float, state: Any) -> list[float]:
        omega, w, x, v = state.tolist()
        s, s1, _ = lift(min(phi, TURN))
        force = mass * (n * n * (s - x) + 2.0 * damping * n * (s1 * omega - v))
        moved = k * w + c * (drive - omega) - s1 * (force + PRELOAD + SPRING * s)
        return [moved / j / omega, drive / omega - 1.0, v / omega, force / mass / omega]

    state, ends = np.array([drive, 0.0, 0.0, 0.0]), [0.0, 0.5 * math.pi, math.pi, TURN]
    for _ in range(40):
        before, pieces = state, []
        for span in itertools.pairwise(ends):
            found = solve_ivp(
                rates, span, state, "DOP853", dense_output=True, rtol=1e-11, atol=1e-12,
                max_step=0.04,  # for the interpolant
            )  # fmt: skip
            pieces.append(found)
            state = found.y[:, -1]
        if np.max(np.abs(state - before) / [drive, 0.01, 1.0, 100.0]) < 1e-9:
            break
    values = [next(each for each in pieces if each.t[-1] >= phi).sol(phi) for phi in PHI]
    return np.array(values)[:, 1], np.array(values)[:, 0]


INTEGRATED = 3e-8
"""Relative error of `solve_ivp` with its interpolant, and of what has not died out."""


@pytest.mark.parametrize(
    ("case", "frequency", "damping"),
    [(CASES[0], 150.0, 0.05), ((600.0, 8e-4, 0.2), 60.0, 0.1)],
)
def test_before_an_elastic_train_the_motion_is_that_of_the_coupled_equations(
    case: tuple[float, float, float], frequency: float, damping: float
) -> None:
    made = elastic(case, frequency, damping)
    turn = made.effect(CAMSHAFT_WINDUP)
    windup, omega = coupled(case, frequency, damping)
    for own, each in zip((omega, windup), turn.sought, strict=True):
        error = each.bound.error + INTEGRATED * np.max(np.abs(own))
        assert np.max(np.abs(each.values(PHI) - own)) <= error, each.label
        assert each.bound.share <= 1e-8
    feedback = turn.feedback
    assert feedback is not None
    assert feedback.ratio < 1.0
    found = figures(made, CAMSHAFT_WINDUP)
    assert found["feedback"].value == feedback.residual / RPM
    assert found["elastic-train"].severity == "ok"
    assert "simplified" not in found
    # A rigid train gives another motion.
    rigid = shaft(*case).effect(CAMSHAFT_WINDUP)
    assert np.max(np.abs(rigid.turn.windup(PHI) - windup)) > 0.01 * np.max(np.abs(windup))


def test_the_error_of_the_force_of_the_train_is_in_that_of_the_motion(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """A force that is off by what the train states, with the swings of the shaft."""
    case, off = (600.0, 8e-4, 0.2), 0.5
    exact = elastic(case, 60.0, 0.1, "1e-5").effect(CAMSHAFT_WINDUP)
    plain = Passed.on_base

    def disturbed(self: Passed, phi: FloatArray, side: Any) -> FloatArray:
        return plain(self, phi, side) + off * np.outer([1.0, 0.0, 0.0, 0.0], np.sin(16.0 * phi))

    monkeypatch.setattr(Passed, "on_base", disturbed)
    monkeypatch.setattr(ElasticTrain, "error", off)
    found = elastic(case, 60.0, 0.1, "1e-1").effect(CAMSHAFT_WINDUP)
    for one, other in zip(exact.sought, found.sought, strict=True):
        change = np.max(np.abs(one.values(PHI) - other.values(PHI)))
        error = other.bound.error + one.bound.error
        assert 0.02 * error < change <= error, one.label


def test_a_resonance_of_the_train_is_refused_with_the_keys_that_do_without_it() -> None:
    made = elastic(CASES[0], 2.0 * SPEED / 60.0, 0.0)
    with pytest.raises(
        EffectError, match=r'resonance.*output = "rigid".*speed = "stated"'
    ) as error:
        made.effect(CAMSHAFT_WINDUP)
    assert error.value.finding == "feedback"
    told = figures(made, "kinematics")
    assert "found-speed" not in told  # they are for the speed of the drive
    assert "camshaft-windup" in told["simplified"].sentence


@pytest.mark.parametrize("damping", [0.02, 0.3])
def test_the_spread_of_an_error_is_that_of_the_worst_one(damping: float) -> None:
    """x' = -a x + d is off by d / a; x'' + 2 D n x' + n^2 x = d by coth(pi D / 2 / sqrt(1 - D^2))
    d / n^2, the integral of the size of its answer to an impulse.
    """
    spans = np.full(100, TURN / 100)
    ones = np.ones((100, 8, 1))
    found = spread(spans, -3.0 * ones[..., np.newaxis], 0.5 * ones)
    assert 0.5 / 3.0 <= found[0] * (1.0 + 1e-12) <= 0.55 / 3.0
    n = 12.5
    slopes = np.zeros((100, 8, 2, 2))
    slopes[..., 0, :] = -2.0 * damping * n, -n * n
    slopes[..., 1, 0] = 1.0
    found = spread(spans, slopes, np.concatenate((ones, 0.0 * ones), axis=2))
    worst = 1.0 / np.tanh(0.5 * math.pi * damping / math.sqrt(1.0 - damping**2)) / n**2
    assert 0.9 * worst <= found[1] <= 6.0 * worst


# Errors of the solution ---------------------------------------------------------------------------


def test_the_windup_is_what_the_cam_lags_behind_in_time() -> None:
    turn = scene().effect(CAMSHAFT_WINDUP)
    lag = SPEED * RPM * turn.course.time(PHI) - PHI
    windup = turn.turn.windup(PHI)
    assert lag - lag[0] == pytest.approx(windup - windup[0], abs=1e-12)
    assert period(turn.course) == pytest.approx(60.0 / SPEED, rel=1e-12)


def test_the_shaft_does_the_work_that_the_cam_takes() -> None:
    made = scene(("[effects.contact-force]", FRICTION + "[effects.contact-force]"))
    turn, drive = made.effect(CAMSHAFT_WINDUP), figures(made, DRIVE_TORQUE)
    torque = {each.name: each for each in turn.columns}["shaft torque"]
    ends = np.append(turn.turn.mesh.low, TURN)
    nodes, weights = np.polynomial.legendre.leggauss(12)
    half = 0.5 * np.diff(ends)
    phi = (ends[:-1] + half)[:, np.newaxis] + half[:, np.newaxis] * nodes
    work = float(np.sum(half * (torque.values(phi.ravel(), "right").reshape(phi.shape) @ weights)))
    assert work == pytest.approx(drive["work-per-turn"].value, rel=1e-7)
    assert work > 0.1


# What depends on it ------------------------------------------------------------------------------


def test_all_other_effects_are_for_the_cam_as_it_turns() -> None:
    made = scene()
    for name in made.scene.effects:
        found = name not in {"spring"}
        assert made.effect(name).state == Used("demanded", "found" if found else "stated"), name
    speeds = made.effect("kinematics")
    course = made.effect(CAMSHAFT_WINDUP).course
    velocity = {each.name: each for each in speeds.columns}["velocity"].values(PHI, "right")
    own = [lift(each)[1] for each in PHI] * course.rates(PHI)[0]
    assert velocity == pytest.approx(own, abs=1e-9 * np.max(np.abs(own)))
    assert "camshaft-windup" in figures(made, "kinematics")["found-speed"].sentence
    stated = scene(("[part]", '[state]\nspeed = "stated"\n[part]'))
    assert stated.effect("kinematics").state == Used("demanded", "stated")
    assert "camshaft-windup" in figures(stated, "kinematics")["simplified"].sentence


def test_no_scene_has_a_motor_and_a_drive_of_constant_speed() -> None:
    motor = (
        "[effects.speed-fluctuation]\nmoment_of_inertia = 1\nno_load_speed = 600\nstall_torque = 90"
    )
    with pytest.raises(SceneError) as error:
        scene(text=SCENE + motor)
    assert [each.key for each in error.value.faults] == ["effects.camshaft-windup"]
    with pytest.raises(SceneError) as error:
        scene((f"speed = {SPEED}\n", ""))
    assert "effects.camshaft-windup" in [each.key for each in error.value.faults]
    for key, value in (("stiffness", STIFFNESS), ("moment_of_inertia", MOMENT)):
        with pytest.raises(SceneError) as error:
            scene((f"\n{key} = {value}\n", f"\n{key} = 0\n"))
        assert [each.key for each in error.value.faults] == [f"effects.camshaft-windup.{key}"]


def test_no_answer_where_there_is_none() -> None:
    names = {}
    for case in ((2.0, 1e-5, 0.02), (1e9, 1e-6, 0.1)):
        with pytest.raises(EffectError) as error:
            shaft(*case).effect(CAMSHAFT_WINDUP)
        names[case[0]] = error.value.finding
    assert names == {2.0: "soft-shaft", 1e9: "stiff-shaft"}


def test_findings_say_what_the_shaft_does() -> None:
    made = scene((f"damping = {DAMPING}", f"damping = {DAMPING}\nlimit = 0.1"))
    found = figures(made, CAMSHAFT_WINDUP)
    assert found["windup"].severity == "broken"
    assert found["windup"].value == pytest.approx(
        max(abs(found[f"{each}-windup"].value) for each in ("largest", "smallest"))
    )
    assert found["torque-reversal"].severity == "warning"
    assert found["natural-frequency"].value == pytest.approx(math.sqrt(STIFFNESS / MOMENT) / TURN)
    undamped = figures(shaft(5000.0, 0.002, 0.0), CAMSHAFT_WINDUP)
    assert undamped["settling"].value == pytest.approx(100.0, rel=1e-8)
    assert undamped["settling"].severity == "warning"


@pytest.mark.parametrize("case", [CASES[0], (3000.0, 1e-4, 0.0)])
def test_a_disturbance_decays_as_stated(case: tuple[float, float, float]) -> None:
    """By the matrix of the Poincare map, from motions beside the steady one."""
    stiffness, moment, damping = case
    turn = shaft(*case).effect(CAMSHAFT_WINDUP).turn
    drive, k, j, m = SPEED * RPM, 1e3 * stiffness, 1e3 * moment, 1e-3 * MASS
    c = 2.0 * damping * math.sqrt(k * j)

    def rates(phi: float, state: Any) -> list[float]:
        omega, w = state
        s, s1, s2 = lift(phi)
        moved = k * w + c * (drive - omega) - s1 * (m * s2 * omega**2 + PRELOAD + SPRING * s)
        return [moved / (j + m * s1**2) / omega, drive / omega - 1.0]

    def after(state: Any) -> Any:
        for low, high in itertools.pairwise([0.0, 0.5 * math.pi, math.pi, TURN]):
            state = solve_ivp(rates, (low, high), state, "DOP853", rtol=1e-12, atol=1e-13).y[:, -1]
        return state

    start = np.array([turn.omega(np.zeros(1))[0], turn.windup(np.zeros(1))[0]])
    steps = np.diag([1e-4 * drive, 1e-6])
    matrix = [(after(start + each) - after(start - each)) / (2.0 * np.max(each)) for each in steps]
    left = np.max(np.abs(np.linalg.eigvals(np.transpose(matrix))))
    assert turn.multiplier == pytest.approx(left, rel=1e-3)


# Errors ------------------------------------------------------------------------------------------


def assert_true(rough: Design, fine: Design) -> None:
    for effect in rough.scene.effects:
        if CAMSHAFT_WINDUP not in (effect, *[each.by for each in find_effect(effect).refined_by]):
            continue
        for each in compared(rough.effect(effect), fine.effect(effect)):
            assert each.holds, (effect, each)


def fixture(tolerance: float) -> Design:
    path = SCENES.parent / "effects" / "camshaft_windup.toml"
    text = path.read_text("utf-8")
    table = "[effects.camshaft-windup]\n"
    assert text.count(table) == 1
    return Design(parse_scene(text.replace(table, f"{table}tolerance = {tolerance:g}\n")))


@pytest.mark.parametrize("tolerance", [1e-2, 1e-4, 1e-6, 1e-8])
def test_errors_are_true(tolerance: float) -> None:
    assert_true(fixture(tolerance), fixture(tolerance / TIGHTER))


@settings(max_examples=examples(8, long=300), deadline=None)
@given(
    st.floats(1.0, 6.0).map(lambda power: 10.0**power), st.floats(1e-4, 0.1),
    st.sampled_from([0.0, 0.005, 0.05, 0.4]), st.sampled_from([1e-3, 1e-5, 1e-7]),
)  # fmt: skip
def test_errors_are_true_for_any_shaft(
    stiffness: float, moment: float, damping: float, tolerance: float
) -> None:
    rough, fine = (
        shaft(stiffness, moment, damping, f"{each:g}") for each in (tolerance, tolerance / TIGHTER)
    )
    try:
        rough.effect(CAMSHAFT_WINDUP)
        fine.effect(CAMSHAFT_WINDUP)
    except EffectError:
        return
    assert_true(rough, fine)
