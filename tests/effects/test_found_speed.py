"""Effects of a cam whose shaft turns unevenly, at the speed that `speed-fluctuation` or
`camshaft-windup` finds: compared with own integrations of Newton's law by `solve_ivp`, and with
runs that are a hundred times as accurate.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Sequence
from functools import cache
from typing import Any, Final

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from camgeo.design.design import Design
from camgeo.dynamics.effects import feedback as feedback_module
from camgeo.dynamics.effects.effect import Result
from camgeo.dynamics.effects.feedback import TrainForce, spread
from camgeo.dynamics.effects.forces import ElasticTrain
from camgeo.dynamics.effects.registry import find_effect
from camgeo.dynamics.effects.results import (
    CAMSHAFT_WINDUP,
    DRIVE_TORQUE,
    FINDERS,
    SPEED_FLUCTUATION,
)
from camgeo.dynamics.state.state import Used
from camgeo.errors import EffectError, SceneError
from camgeo.kinematics.time_course import period
from camgeo.numeric.arrays import FloatArray
from camgeo.scene.scene import load_scene, parse_scene
from camgeo.studies.accuracy.survey import TIGHTER, compare_figures
from camgeo.units import RPM, TURN
from tests.effects.scenes import SCENES
from tests.findings import finding_values
from tests.integrals import cells, integrals
from tests.long_form import LONG, examples

MASS, PRELOAD, SPRING, SPEED = 1.5, 250.0, 8.0, 500.0

SCENE: Final = f"""
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
"""

PHI: Final = np.linspace(0.003, TURN - 0.003, 400)

Lift = tuple[float, float, float]


def lift(phi: float) -> Lift:
    """s [mm] and its derivatives of the polynomial 10 x^3 - 15 x^4 + 6 x^5 up and down."""
    span = 0.5 * math.pi
    if phi >= 2.0 * span:
        return 0.0, 0.0, 0.0
    sign, x = (1.0, phi / span) if phi < span else (-1.0, 2.0 - phi / span)
    s = 20.0 * x**3 * (10.0 - 15.0 * x + 6.0 * x**2)
    s1 = 600.0 * x**2 * (1.0 - x) ** 2 / span * sign
    return s, s1, 1200.0 * x * (1.0 - x) * (1.0 - 2.0 * x) / span**2


Rates = Callable[[Lift, list[float]], Sequence[float]]
"""Of states over the cam angle, by the lift there."""


def newton(
    moment: float,
    drive: Callable[[list[float]], float],
    train: tuple[float, float] | None = None,
    others: Callable[[list[float]], list[float]] = lambda _: [],
) -> Rates:
    """Of the speed omega, x and v of a train, and `others` over the cam angle, in N, mm, s and t.

    J alpha = T - s' (m (s'' omega^2 + s' alpha) + P + k s) with the torque T of the `drive`. Before
    a train of the natural frequency w and the damping D the follower has no mass but that of it:
    J alpha = T - s' (F + P + k s) and m v' = F = m (w^2 (s - x) + 2 D w (s' omega - v)).
    """
    mass = 1e-3 * MASS

    def rates(place: Lift, state: list[float]) -> list[float]:
        (s, s1, s2), omega = place, state[0]
        left, behind = drive(state) - s1 * (PRELOAD + SPRING * s), []
        if train is None:
            alpha = (left - s1 * mass * s2 * omega**2) / (1e3 * moment + mass * s1**2)
        else:
            w, (x, v) = TURN * train[0], state[1:3]
            force = mass * (w * w * (s - x) + 2.0 * train[1] * w * (s1 * omega - v))
            alpha, behind = (left - s1 * force) / (1e3 * moment), [v / omega, force / mass / omega]
        return [alpha / omega, *behind, *others(state)]

    return rates


def over_turn(rates: Rates, state: FloatArray, **exact: float) -> list[Any]:
    """From a state on, piece by piece of the motion."""
    pieces: list[Any] = []
    for span in itertools.pairwise((0.0, 0.5 * math.pi, math.pi, TURN)):
        pieces.append(
            solve_ivp(
                lambda phi, y: rates(lift(min(phi, TURN)), y.tolist()),
                span, pieces[-1].y[:, -1] if pieces else state, "DOP853", dense_output=True,
                max_step=0.04, **exact,  # for the interpolant
            )
        )  # fmt: skip
    return pieces


def settled(rates: Rates, start: Sequence[float], repeated: int, **exact: float) -> list[Any]:
    """A turn once disturbances have died out; of the states so many come back, others are sums."""
    state, sums = np.array(start), np.array(start)[repeated:]
    for _ in range(80):
        pieces = over_turn(rates, state, **exact)
        before, state = state, np.append(pieces[-1].y[:repeated, -1], sums)
        sizes = np.max(np.abs(np.hstack([each.y for each in pieces])), axis=1)
        if np.all(np.abs(state - before) <= 1e-11 * sizes):
            break
    return pieces


def states_at(pieces: list[Any], phi: FloatArray = PHI) -> FloatArray:
    """(k, n) of a turn at cam angles [rad]."""
    return np.transpose([next(p for p in pieces if p.t[-1] >= each).sol(each) for each in phi])


def assert_true(own: Result, best: Result, what: object) -> None:
    """No figure is off by more than stated."""
    for each in compare_figures(own, best):
        assert each.holds, (what, each)


# A motor ------------------------------------------------------------------------------------------


MOMENT, NO_LOAD, STALL = 0.01, 620.0, 40.0

MOTOR = {"moment_of_inertia": MOMENT, "no_load_speed": NO_LOAD, "stall_torque": STALL}
TRAIN = {"natural_frequency": 200.0, "damping": 0.05}
RIGID, ELASTIC = {"output": "rigid"}, {"output": "elastic"}

BASE = parse_scene(SCENE)


def motor_torque(state: list[float]) -> float:
    """Its torque [N mm]."""
    return 1e3 * STALL * (1.0 - state[0] / (NO_LOAD * RPM))


DRIVEN = ("motor", "press", "tappet", "linked_press") if LONG else ("motor",)
"""Scenes with a motor before an elastic train; all but the one above take seconds."""


def scene(tolerance: float = 1e-11, **edits: Any) -> Design:
    """With keys of the motor, and of tables by their names; no speed is given."""
    motor = MOTOR | {key: edits.pop(key) for key in tuple(edits) if key in MOTOR}
    tables = {
        "cam.speed": None,
        "state": RIGID,
        "effects.vibration": TRAIN,
        "effects.speed-fluctuation": {**motor, "tolerance": tolerance},
    }
    tables |= {key.replace("__", "."): each for key, each in edits.items()}
    return Design(BASE.with_values(tables))


def test_the_contact_force_is_that_of_newtons_law() -> None:
    made = scene()
    rates = newton(MOMENT, motor_torque)
    (omega,) = states_at(settled(rates, [0.9 * NO_LOAD * RPM], 1, rtol=1e-12, atol=1e-12))
    alpha = [w * rates(lift(phi), [w])[0] for phi, w in zip(PHI, omega, strict=True)]
    s, s1, s2 = np.transpose([lift(each) for each in PHI])
    force = 1e-3 * MASS * (s2 * omega**2 + s1 * alpha) + PRELOAD + SPRING * s
    normal = made.effect("contact-force").normal(PHI, "right")
    along = 40.0 + s  # tan of the pressure angle: s' / (radius of the pitch curve)
    assert np.max(np.abs(normal - force * np.hypot(1.0, s1 / along))) <= 1e-8 * np.max(force)
    torque = made.effect("drive-torque").torque(PHI, "right")
    assert np.max(np.abs(torque - force * s1)) <= 1e-8 * np.max(np.abs(torque))
    # At the mean speed of the turn, the force would be another one.
    slow = 1e-3 * MASS * s2 * np.mean(omega) ** 2 + PRELOAD + SPRING * s
    assert np.max(np.abs(slow - force)) > 0.02 * np.max(force)


@pytest.mark.parametrize("name", DRIVEN)
def test_the_motor_does_the_work_that_the_cam_takes(name: str) -> None:
    """J omega domega is that of a periodic speed, 0 over a turn."""
    made = loaded(name, 1e-8)
    motor, drive = (made.effect(each) for each in (SPEED_FLUCTUATION, "drive-torque"))
    work = {each.name: each.value for each in (*motor.findings, *drive.findings)}
    error = motor.errors["motor-work"].error + drive.errors["work-per-turn"].error
    assert work["motor-work"] == pytest.approx(work["work-per-turn"], abs=error)
    assert error < 1.5e-5 * work["motor-work"]


INTEGRATED = 1e-8
"""Relative error of `solve_ivp`: of its interpolant, and 1e-9 of what is absolute, over a turn."""


@pytest.mark.parametrize(
    ("frequency", "damping", "moment"), [(200, 0.05, 0.01), (60, 0.2, 0.004), (20, 0.1, 0.004)]
)
def test_the_speed_before_an_elastic_train_is_that_of_the_coupled_equations(
    frequency: float, damping: float, moment: float
) -> None:
    train = {"natural_frequency": frequency, "damping": damping}
    made = scene(state=ELASTIC, effects__vibration=train, moment_of_inertia=moment, tolerance=1e-9)
    start = [NO_LOAD * RPM, 0.0, 0.0, 0.0]
    rates = newton(moment, motor_torque, (frequency, damping), lambda state: [motor_torque(state)])
    pieces = settled(rates, start, 3, rtol=1e-12, atol=1e-9)
    motor, own = made.effect(SPEED_FLUCTUATION), states_at(pieces)[0]
    (speed,) = motor.unknowns
    error = speed.bound.error + INTEGRATED * np.max(own)
    assert motor.course.rates(PHI)[0] == pytest.approx(own, abs=error)
    values = {each.name: each.value for each in motor.findings}
    work = 1e-3 * float(pieces[-1].y[3, -1])
    slope = STALL / (NO_LOAD * RPM)
    assert values["motor-work"] == pytest.approx(work, abs=TURN * slope * error)
    feedback = motor.feedback
    assert feedback is not None
    assert 1 < feedback.rounds <= 20
    assert feedback.residual / RPM == values["feedback"]
    # A rigid train gives another speed.
    course = scene(moment_of_inertia=moment).effect(SPEED_FLUCTUATION).course
    assert np.max(np.abs(course.rates(PHI)[0] - own)) > 1e4 * error


def test_a_loop_that_does_not_contract_is_refused_with_the_keys_that_break_it(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(feedback_module, "ROUNDS", 2)
    loose = scene(state=ELASTIC, tolerance=1e-9)
    with pytest.raises(EffectError, match=r'after 2 rounds .* output = "rigid"') as error:
        loose.effect(SPEED_FLUCTUATION)
    assert error.value.finding == "feedback"


def test_a_given_speed_changes_nothing_but_where_it_is_meant() -> None:
    free, held = scene(), scene(cam__speed=500)
    stated = scene(cam__speed=500, state={**RIGID, "speed": "stated"})
    plain = Design(BASE.with_values({"state": RIGID, "effects.vibration": TRAIN}))
    for name in plain.scene.effects:
        values = [
            [each.value for each in made.effect(name).findings if each.value is not None]
            for made in (free, held)
        ]
        assert values[0] == pytest.approx(values[1], rel=1e-12), name
        formerly, now = plain.effect(name), stated.effect(name)
        own, before = (
            [each for each in result.findings if each.name != "simplified"]
            for result in (now, formerly)
        )
        assert own == before
        assert now.errors == formerly.errors
        for one, other in zip(now.columns, formerly.columns, strict=True):
            assert np.array_equal(one.values(PHI, "left"), other.values(PHI, "left"))
        assert now.state == Used("demanded", "stated")


def test_a_speed_that_nothing_finds_is_refused_with_its_key() -> None:
    with pytest.raises(SceneError) as error:
        BASE.with_values({"state.speed": "found"})
    assert [each.key for each in error.value.faults] == ["state.speed"]
    with pytest.raises(SceneError) as error:
        scene(state={**RIGID, "speed": "stated"})
    assert {each.key for each in error.value.faults} >= {"effects.kinematics", "effects.inertia"}


def test_a_motor_that_stalls_leaves_the_speed_of_the_scene_or_none() -> None:
    weak: dict[str, Any] = {"stall_torque": 0.01, "effects__friction": {"rolling": 0.5}}
    alone = scene(**weak)
    with pytest.raises(EffectError) as error:
        alone.effect("kinematics")
    assert error.value.finding == "no-speed"
    assert "stalls" in alone.effects.findings("contact-force")[0].sentence
    given = scene(**weak, cam__speed=500)
    turn = finding_values(given.effect("kinematics").findings)["turn-time"]
    assert turn == pytest.approx(60.0 / 500.0)
    assert "simplified" in [each.name for each in given.effects.findings("kinematics")]


# The time course ---------------------------------------------------------------------------------


@cache
def loaded(name: str, tolerance: float) -> Design:
    """Before its elastic train."""
    if name == "motor":
        return scene(state=ELASTIC, tolerance=tolerance)
    found = load_scene(SCENES.parent / "effects" / f"{name}.toml")
    finder = SPEED_FLUCTUATION if SPEED_FLUCTUATION in found.effects else CAMSHAFT_WINDUP
    return Design(found.with_values({f"effects.{finder}.tolerance": tolerance}))


def test_alpha_jumps_where_the_law_does_and_nowhere_else() -> None:
    """A simple sine presses the roller, which takes torque as it rolls, harder at once."""
    moves = [{"law": "simple-sine", "span": 90, "to": to} for to in (20, 0)]
    edits: dict[str, Any] = {
        "motion": [*moves, {"dwell": 180}],
        "effects__friction": {"rolling": 0.5},
    }
    course = scene(**edits).effect(SPEED_FLUCTUATION).course
    right, left = (course.rates(course.borders, side) for side in ("right", "left"))
    size = np.max(np.abs(course.rates(PHI)[1]))
    jumps = np.abs(right[1] - left[1]) > 1e-4 * size
    assert np.array_equal(course.borders[jumps], course.jumps)
    assert len(course.jumps)
    assert right[0] == pytest.approx(left[0], rel=1e-9)


# Errors ------------------------------------------------------------------------------------------


def dependent(made: Design) -> list[str]:
    """The effects of a scene that depend on the speed that is found, and the one that finds it."""
    return [
        name
        for name in made.scene.effects
        if {*FINDERS} & {name, *(each.effect for each in find_effect(name).refined_by)}
    ]


def assert_errors_true(rough: Design, fine: Design) -> None:
    for name in dependent(rough):
        assert_true(rough.effect(name), fine.effect(name), name)


@pytest.mark.parametrize("name", [*DRIVEN, "camshaft_windup"])
@pytest.mark.parametrize("tolerance", [1e-2, 1e-4, 1e-6, 1e-8, 1e-10])
def test_errors_are_true(name: str, tolerance: float) -> None:
    """Of each figure of each of these effects, all of which state one."""
    rough, fine = (loaded(name, tolerance / each) for each in (1.0, TIGHTER))
    assert_errors_true(rough, fine)
    for result in (rough.effect(each) for each in dependent(rough) if each not in FINDERS):
        figures = {each.name for each in result.columns} | {*finding_values(result.findings)}
        assert figures <= {*result.errors}


def assert_true_if_found(rough: Design, fine: Design) -> None:
    """Where there is no steady speed, there are no figures."""
    try:
        for finder in {*FINDERS} & {*rough.scene.effects}:
            rough.effect(finder)
            fine.effect(finder)
    except EffectError:
        return
    assert_errors_true(rough, fine)


@settings(max_examples=examples(8, long=200), deadline=None)
@given(st.floats(2e-3, 0.5), st.floats(150.0, 900.0), st.floats(10.0, 200.0))
def test_errors_are_true_for_any_motor(moment: float, speed: float, stall: float) -> None:
    motor = {"moment_of_inertia": moment, "no_load_speed": speed, "stall_torque": stall}
    assert_true_if_found(*(scene(**motor, tolerance=tolerance) for tolerance in (1e-3, 1e-5)))


# Windup of the camshaft ---------------------------------------------------------------------------


Case = tuple[float, float, float]
"""Stiffness [N m/rad], moment of inertia [kg m^2] and damping ratio of a shaft."""

CASES: tuple[Case, ...] = ((1200.0, 0.002, 0.1), (30.0, 0.003, 0.3), (400.0, 2e-4, 0.15))
"""A usual shaft, a soft one, and one with a light cam, whose follower is heavier than it."""

Train = tuple[float, float]
"""Natural frequency [Hz] and damping ratio of all the mass of the follower behind a spring."""


def shaft(
    case: Case = CASES[0], tolerance: float = 1e-9, train: Train | None = None, **edits: Any
) -> Design:
    table = dict(zip(("stiffness", "moment_of_inertia", "damping"), case, strict=True))
    tables = {"effects.camshaft-windup": {**table, "tolerance": tolerance, **edits.pop("own", {})}}
    if train is not None:
        tables["effects.vibration"] = {"natural_frequency": train[0], "damping": train[1]}
    return Design(BASE.with_values({**tables, **edits}))


def figures(of: Design, name: str) -> dict[str, Any]:
    return {each.name: each for each in of.effects.findings(name)}


def shaft_rates(case: Case, train: Train | None = None) -> Rates:
    """Of the speed, with x and v of a train, and of the windup w: the shaft drives the cam by
    k w + c (Omega - omega), and dw/dt = Omega - omega.
    """
    drive, k = SPEED * RPM, 1e3 * case[0]
    c = 2.0 * case[2] * math.sqrt(k * 1e3 * case[1])
    return newton(
        case[1],
        lambda state: k * state[-1] + c * (drive - state[0]),
        train,
        lambda state: [drive / state[0] - 1.0],
    )


@pytest.mark.parametrize("case", CASES)
def test_the_motion_is_that_of_newtons_law(case: Case) -> None:
    turn = shaft(case).effect(CAMSHAFT_WINDUP)
    omega, windup = states_at(
        settled(shaft_rates(case), [SPEED * RPM, 0.0], 2, rtol=1e-12, atol=1e-13)
    )
    errors, columns = turn.errors, {each.name: each for each in turn.columns}
    own = np.radians(columns["windup"].values(PHI, "right"))
    size = np.max(np.abs(windup))
    assert np.max(np.abs(own - windup)) <= math.radians(errors["windup"].error) + 1e-8 * size
    speed = RPM * columns["cam speed"].values(PHI, "right")
    assert np.max(np.abs(speed - omega)) <= RPM * errors["cam speed"].error + 1e-9 * SPEED
    assert size > 0.001
    assert np.ptp(omega) > 0.01 * SPEED * RPM


SETTLED = 3e-8
"""Relative error of `solve_ivp` with its interpolant, and of what has not died out."""


@pytest.mark.parametrize(
    ("case", "train"), [(CASES[0], (150.0, 0.05)), ((600.0, 8e-4, 0.2), (60.0, 0.1))]
)
def test_before_an_elastic_train_the_motion_is_that_of_the_coupled_equations(
    case: Case, train: Train
) -> None:
    made = shaft(case, 1e-8, train)
    turn = made.effect(CAMSHAFT_WINDUP)
    start = [SPEED * RPM, 0.0, 0.0, 0.0]
    pieces = settled(shaft_rates(case, train), start, 4, rtol=1e-11, atol=1e-12)
    wanted = states_at(pieces)[[0, -1]]
    for own, each in zip(wanted, turn.unknowns, strict=False):
        error = each.bound.error + SETTLED * np.max(np.abs(own))
        assert np.max(np.abs(each.values(PHI) - own)) <= error, each.label
        assert each.bound.share <= 1e-8
    assert turn.feedback.ratio < 1.0
    found = figures(made, CAMSHAFT_WINDUP)
    assert found["feedback"].value == turn.feedback.residual / RPM
    assert found["elastic-train"].severity == "ok"
    assert "simplified" not in found
    # A rigid train gives another motion.
    off = shaft(case).effect(CAMSHAFT_WINDUP).turn.windup(PHI) - wanted[1]
    assert np.max(np.abs(off)) > 0.01 * np.max(np.abs(wanted[1]))


def test_the_error_of_the_force_of_the_train_is_in_that_of_the_motion(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """A force that is off by what the train states, with the swings of the shaft."""
    case, train, off = (600.0, 8e-4, 0.2), (60.0, 0.1), 0.5
    exact = shaft(case, 1e-5, train).effect(CAMSHAFT_WINDUP)
    plain = TrainForce.on_base

    def disturbed(self: TrainForce, phi: FloatArray, side: Any) -> FloatArray:
        return plain(self, phi, side) + off * np.outer([1.0, 0.0, 0.0, 0.0], np.sin(16.0 * phi))

    monkeypatch.setattr(TrainForce, "on_base", disturbed)
    monkeypatch.setattr(ElasticTrain, "error", off)
    found = shaft(case, 1e-1, train).effect(CAMSHAFT_WINDUP)
    for one, other in zip(exact.unknowns, found.unknowns, strict=True):
        change = np.max(np.abs(one.values(PHI) - other.values(PHI)))
        error = other.bound.error + one.bound.error
        assert 0.02 * error < change <= error, one.label


def test_a_resonance_of_the_train_is_refused_with_the_keys_that_do_without_it() -> None:
    made = shaft(tolerance=1e-8, train=(2.0 * SPEED / 60.0, 0.0))
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


def test_the_windup_is_what_the_cam_lags_behind_in_time() -> None:
    turn = shaft().effect(CAMSHAFT_WINDUP)
    lag = SPEED * RPM * turn.course.time(PHI) - PHI
    windup = turn.turn.windup(PHI)
    assert lag - lag[0] == pytest.approx(windup - windup[0], abs=1e-12)
    assert period(turn.course) == pytest.approx(60.0 / SPEED, rel=1e-12)


def test_the_shaft_does_the_work_that_the_cam_takes() -> None:
    rubbing: dict[str, Any] = {
        "effects.friction": {"rolling": 0.5, "guide": 0.1, "guide_length": 60, "guide_overhang": 30}
    }
    made = shaft(**rubbing)
    turn, drive = made.effect(CAMSHAFT_WINDUP), figures(made, DRIVE_TORQUE)
    torque = {each.name: each for each in turn.columns}["shaft torque"]
    low, high = cells(turn.turn.mesh.low, 1)
    work = float(np.sum(integrals(lambda phi: torque.values(phi, "right"), low, high)))
    assert work == pytest.approx(drive["work-per-turn"].value, rel=1e-7)
    assert work > 0.1


# What depends on it ------------------------------------------------------------------------------


def test_all_other_effects_are_for_the_cam_as_it_turns() -> None:
    made = shaft()
    for name in made.scene.effects:
        found = name not in {"spring"}
        assert made.effect(name).state == Used("demanded", "found" if found else "stated"), name
    speeds = made.effect("kinematics")
    course = made.effect(CAMSHAFT_WINDUP).course
    velocity = {each.name: each for each in speeds.columns}["velocity"].values(PHI, "right")
    own = [lift(each)[1] for each in PHI] * course.rates(PHI)[0]
    assert velocity == pytest.approx(own, abs=1e-9 * np.max(np.abs(own)))
    assert "camshaft-windup" in figures(made, "kinematics")["found-speed"].sentence
    by_scene: dict[str, Any] = {"state.speed": "stated"}
    stated = shaft(**by_scene)
    assert stated.effect("kinematics").state == Used("demanded", "stated")
    assert "camshaft-windup" in figures(stated, "kinematics")["simplified"].sentence


@pytest.mark.parametrize(
    ("edits", "key"),
    [
        ({"effects.speed-fluctuation": MOTOR}, ""),
        ({"cam.speed": None}, ""),
        ({"effects.camshaft-windup.stiffness": 0}, ".stiffness"),
        ({"effects.camshaft-windup.moment_of_inertia": 0}, ".moment_of_inertia"),
    ],
)
def test_no_scene_has_a_motor_and_a_drive_of_constant_speed(edits: Any, key: str) -> None:
    with pytest.raises(SceneError) as error:
        shaft().scene.with_values(edits)
    keys = [each.key for each in error.value.faults]
    assert f"effects.camshaft-windup{key}" in keys
    assert len(keys) == 1 or "cam.speed" in edits


@pytest.mark.parametrize(
    ("case", "name"), [((2.0, 1e-5, 0.02), "soft-shaft"), ((1e9, 1e-6, 0.1), "stiff-shaft")]
)
def test_no_answer_where_there_is_none(case: Case, name: str) -> None:
    with pytest.raises(EffectError) as error:
        shaft(case).effect(CAMSHAFT_WINDUP)
    assert error.value.finding == name


def test_findings_say_what_the_shaft_does() -> None:
    found = figures(shaft(own={"limit": 0.1}), CAMSHAFT_WINDUP)
    assert found["windup"].severity == "broken"
    assert found["windup"].value == pytest.approx(
        max(abs(found[f"{each}-windup"].value) for each in ("largest", "smallest"))
    )
    assert found["torque-reversal"].severity == "warning"
    natural = math.sqrt(CASES[0][0] / CASES[0][1]) / TURN
    assert found["natural-frequency"].value == pytest.approx(natural)
    undamped = shaft((5000.0, 0.002, 0.0)).effects.findings(CAMSHAFT_WINDUP)
    assert finding_values(undamped)["settling"] == pytest.approx(100.0, rel=1e-8)
    assert {each.name: each.severity for each in undamped}["settling"] == "warning"


@pytest.mark.parametrize("case", [CASES[0], (3000.0, 1e-4, 0.0)])
def test_a_disturbance_decays_as_stated(case: Case) -> None:
    """By the matrix of the Poincare map, from motions beside the steady one."""
    turn = shaft(case).effect(CAMSHAFT_WINDUP).turn
    start = np.array([turn.omega(np.zeros(1))[0], turn.windup(np.zeros(1))[0]])

    def after(state: FloatArray) -> Any:
        return over_turn(shaft_rates(case), state, rtol=1e-12, atol=1e-13)[-1].y[:, -1]

    steps = np.diag([1e-4 * SPEED * RPM, 1e-6])
    matrix = [(after(start + each) - after(start - each)) / (2.0 * np.max(each)) for each in steps]
    left = np.max(np.abs(np.linalg.eigvals(np.transpose(matrix))))
    assert turn.multiplier == pytest.approx(left, rel=1e-3)


# Errors ------------------------------------------------------------------------------------------


@settings(max_examples=examples(8, long=300), deadline=None)
@given(
    st.floats(1.0, 6.0).map(lambda power: 10.0**power), st.floats(1e-4, 0.1),
    st.sampled_from([0.0, 0.005, 0.05, 0.4]), st.sampled_from([1e-3, 1e-5, 1e-7]),
)  # fmt: skip
def test_errors_are_true_for_any_shaft(
    stiffness: float, moment: float, damping: float, tolerance: float
) -> None:
    case = (stiffness, moment, damping)
    assert_true_if_found(*(shaft(case, tolerance / each) for each in (1.0, TIGHTER)))
