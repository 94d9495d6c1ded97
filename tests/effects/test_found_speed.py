"""Effects at the speed that `speed-fluctuation` finds: compared with own integrations, and with
runs whose speed is a hundred times as accurate.
"""

from __future__ import annotations

import itertools
import math
from functools import cache
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from camgeo.design.design import Design
from camgeo.dynamics.effects import feedback as feedback_module
from camgeo.dynamics.effects.effect import Result
from camgeo.dynamics.effects.registry import find_effect
from camgeo.dynamics.effects.results import SPEED_FLUCTUATION
from camgeo.dynamics.state.state import Used
from camgeo.errors import EffectError, SceneError
from camgeo.kinematics.time_course import ConstantSpeed, TimeCourse, period
from camgeo.numeric.arrays import FloatArray
from camgeo.scene.scene import parse_scene
from camgeo.studies.accuracy.survey import TIGHTER, compared
from camgeo.units import RPM, TURN
from tests.effects.scenes import SCENES
from tests.long_form import LONG, examples

MASS, PRELOAD, STIFFNESS = 1.5, 60.0, 2.0
MOMENT, NO_LOAD, STALL = 0.01, 620.0, 40.0

MOTOR = f"""
camgeo = 1
name = "motor"
[cam]
rotation = "ccw"
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
[state]
output = "rigid"
[part]
thickness = 12
[effects.inertia]
mass = {MASS}
[effects.spring]
stiffness = {STIFFNESS}
preload = {PRELOAD}
[effects.contact-force]
[effects.drive-torque]
[effects.kinematics]
[effects.vibration]
natural_frequency = 200
damping = 0.05
[effects.speed-fluctuation]
moment_of_inertia = {MOMENT}
no_load_speed = {NO_LOAD}
stall_torque = {STALL}
tolerance = 1e-11
"""
"""A motor drives the cam, and no speed is given."""

RIGID = 'output = "rigid"'

DRIVEN = ("motor", "press", "tappet", "linked_press") if LONG else ("motor",)
"""Scenes with a motor before an elastic train; all but the one above take seconds."""


def scene(*changes: tuple[str, str], text: str = MOTOR) -> Design:
    for old, new in changes:
        assert text.count(old) == 1, old
        text = text.replace(old, new)
    return Design(parse_scene(text))


def lift(phi: float) -> tuple[float, float, float]:
    """s [mm] and its derivatives of the polynomial 10 x^3 - 15 x^4 + 6 x^5 up and down."""
    span = 0.5 * math.pi
    if phi >= 2.0 * span:
        return 0.0, 0.0, 0.0
    sign, x = (1.0, phi / span) if phi < span else (-1.0, 2.0 - phi / span)
    s = 20.0 * x**3 * (10.0 - 15.0 * x + 6.0 * x**2)
    s1 = 600.0 * x**2 * (1.0 - x) ** 2 / span * sign
    return s, s1, 1200.0 * x * (1.0 - x) * (1.0 - 2.0 * x) / span**2


def alpha_of(phi: float, omega: float) -> float:
    """J alpha = T_m - s' (m (s'' omega^2 + s' alpha) + P + k s), in N, mm, s and t."""
    s, s1, s2 = lift(phi)
    motor = 1e3 * STALL * (1.0 - omega / (NO_LOAD * RPM))
    force = 1e-3 * MASS * s2 * omega**2 + PRELOAD + STIFFNESS * s
    return (motor - s1 * force) / (1e3 * MOMENT + 1e-3 * MASS * s1**2)


@cache
def integrated() -> Any:
    """The speed over a turn once a disturbance has died out, from Newton's law in time."""
    ends = [0.0, 0.5 * math.pi, math.pi, TURN]
    omega = 0.9 * NO_LOAD * RPM
    for turn in range(60):
        before, pieces = omega, []
        for low, high in itertools.pairwise(ends):
            found = solve_ivp(
                lambda phi, y: [alpha_of(min(phi, TURN), y[0]) / y[0], 1.0 / y[0]],
                (low, high), [omega, 0.0], "DOP853", dense_output=True, rtol=1e-13, atol=1e-13,
            )  # fmt: skip
            pieces.append(found)
            omega = float(found.y[0, -1])
        if turn and abs(omega - before) < 1e-13 * omega:
            break
    return pieces


def speeds_at(phi: FloatArray) -> FloatArray:
    """omega [rad/s] as `integrated`."""
    return np.array([next(p for p in integrated() if p.t[-1] >= each).sol(each)[0] for each in phi])


PHI = np.linspace(0.003, TURN - 0.003, 400)


def test_the_contact_force_is_that_of_newtons_law() -> None:
    made = scene()
    omega = speeds_at(PHI)
    alpha = [alpha_of(*each) for each in zip(PHI, omega, strict=True)]
    s, s1, s2 = np.transpose([lift(each) for each in PHI])
    force = 1e-3 * MASS * (s2 * omega**2 + s1 * alpha) + PRELOAD + STIFFNESS * s
    normal = made.effect("contact-force").normal(PHI, "right")
    along = 40.0 + s  # tan of the pressure angle: s' / (radius of the pitch curve)
    assert np.max(np.abs(normal - force * np.hypot(1.0, s1 / along))) <= 1e-8 * np.max(force)
    torque = made.effect("drive-torque").torque(PHI, "right")
    assert np.max(np.abs(torque - force * s1)) <= 1e-8 * np.max(np.abs(torque))
    # At the mean speed of the turn, the force would be another one.
    slow = 1e-3 * MASS * s2 * np.mean(omega) ** 2 + PRELOAD + STIFFNESS * s
    assert np.max(np.abs(slow - force)) > 0.02 * np.max(force)


@pytest.mark.parametrize("name", DRIVEN)
def test_the_motor_does_the_work_that_the_cam_takes(name: str) -> None:
    """J omega domega is that of a periodic speed, 0 over a turn."""
    made = loaded(name, "1e-8")
    motor, drive = (made.effect(each) for each in (SPEED_FLUCTUATION, "drive-torque"))
    work = {each.name: each.value for each in (*motor.findings, *drive.findings)}
    error = motor.errors["motor-work"].error + drive.errors["work-per-turn"].error
    assert work["motor-work"] == pytest.approx(work["work-per-turn"], abs=error)
    assert error < 1e-5 * work["motor-work"]


def coupled(frequency: float, damping: float, moment: float) -> tuple[Design, Any]:
    """A motor, the cam and all its mass behind a spring, and the same over a turn by `solve_ivp`.

    J omega' = T_m - s' (F + P + K s), m v' = F = k (s - x) + c (s' omega - v), x' = v, over time,
    once all disturbances have died out.
    """
    made = scene(
        (RIGID, 'output = "elastic"'),
        ("natural_frequency = 200", f"natural_frequency = {frequency}"),
        ("damping = 0.05", f"damping = {damping}"),
        (f"moment_of_inertia = {MOMENT}", f"moment_of_inertia = {moment}"),
        ("tolerance = 1e-11", "tolerance = 1e-9"),
    )
    w, mass = TURN * frequency, 1e-3 * MASS

    def rate(phi: float, y: FloatArray) -> list[float]:
        omega, x, v, _ = y.tolist()
        s, s1, _ = lift(min(phi, TURN))
        force = mass * (w * w * (s - x) + 2.0 * damping * w * (s1 * omega - v))
        motor = 1e3 * STALL * (1.0 - omega / (NO_LOAD * RPM))
        torque = s1 * (force + PRELOAD + STIFFNESS * s)
        alpha = (motor - torque) / (1e3 * moment)
        return [alpha / omega, v / omega, force / mass / omega, motor]

    state, ends = np.array([NO_LOAD * RPM, 0.0, 0.0, 0.0]), [0.0, 0.5 * math.pi, math.pi, TURN]
    for _ in range(40):
        before, pieces = state[:3].copy(), []
        state[3] = 0.0
        for span in itertools.pairwise(ends):
            found = solve_ivp(rate, span, state, "DOP853", dense_output=True, rtol=1e-12, atol=1e-9)
            pieces.append(found)
            state = found.y[:, -1]
        if abs(state[0] - before[0]) < 1e-11 * state[0]:
            break
    return made, pieces


INTEGRATED = 1e-8
"""Relative error of `solve_ivp`: of its interpolant, and 1e-9 of what is absolute, over a turn."""


@pytest.mark.parametrize(
    ("frequency", "damping", "moment"), [(200, 0.05, 0.01), (60, 0.2, 0.004), (20, 0.1, 0.004)]
)
def test_the_speed_before_an_elastic_train_is_that_of_the_coupled_equations(
    frequency: float, damping: float, moment: float
) -> None:
    made, pieces = coupled(frequency, damping, moment)
    motor = made.effect(SPEED_FLUCTUATION)
    own = np.array([next(p for p in pieces if p.t[-1] >= each).sol(each)[0] for each in PHI])
    (speed,) = motor.sought
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
    rigid = scene((f"moment_of_inertia = {MOMENT}", f"moment_of_inertia = {moment}"))
    course = rigid.effect(SPEED_FLUCTUATION).course
    assert np.max(np.abs(course.rates(PHI)[0] - own)) > 1e4 * error


def test_a_loop_that_does_not_contract_is_refused_with_the_keys_that_break_it(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(feedback_module, "ROUNDS", 2)
    loose = scene((RIGID, 'output = "elastic"'), ("tolerance = 1e-11", "tolerance = 1e-9"))
    with pytest.raises(EffectError, match=r'after 2 rounds .* output = "rigid"') as error:
        loose.effect(SPEED_FLUCTUATION)
    assert error.value.finding == "feedback"


def test_velocity_and_duration_are_those_of_the_integrated_speed() -> None:
    made = scene()
    turn = sum(float(each.y[1, -1]) for each in integrated())
    times = {each.name: each.value for each in made.effect("kinematics").findings}
    assert times["turn-time"] == pytest.approx(turn, rel=1e-9)
    columns = {each.name: each for each in made.effect("kinematics").columns}
    velocity = columns["velocity"].values(PHI, "right")
    own = np.array([lift(each)[1] for each in PHI]) * speeds_at(PHI)
    assert np.max(np.abs(velocity - own)) <= 1e-8 * np.max(np.abs(own))


def test_all_results_say_for_which_state_they_are() -> None:
    made = scene()
    dependent = {"inertia", "contact-force", "drive-torque", "kinematics", "vibration"}
    for name in made.scene.effects:
        used = made.effect(name).state
        found = name in {*dependent, SPEED_FLUCTUATION}
        assert used == Used("demanded", "found" if found else "stated"), name
        told = [each.name for each in made.effects.findings(name)]
        assert ("found-speed" in told) == (name in dependent)


def test_a_given_speed_changes_nothing_but_where_it_is_meant() -> None:
    given = ('rotation = "ccw"\n', 'rotation = "ccw"\nspeed = 500\n')
    free, held = scene(), scene(given)
    stated = scene(given, (RIGID, f'{RIGID}\nspeed = "stated"'))
    cut = MOTOR.index("[effects.speed-fluctuation]")
    plain = scene(given, text=MOTOR[:cut])
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
    cut = MOTOR.index("[effects.speed-fluctuation]")
    with pytest.raises(SceneError) as error:
        scene(
            ('rotation = "ccw"\n', 'rotation = "ccw"\nspeed = 500\n'),
            (RIGID, f'{RIGID}\nspeed = "found"'),
            text=MOTOR[:cut],
        )
    assert [each.key for each in error.value.faults] == ["state.speed"]
    with pytest.raises(SceneError) as error:
        scene((RIGID, f'{RIGID}\nspeed = "stated"'))
    assert {each.key for each in error.value.faults} >= {"effects.kinematics", "effects.inertia"}


def test_a_motor_that_stalls_leaves_the_speed_of_the_scene_or_none() -> None:
    rubbing = "stall_torque = 0.01\n[effects.friction]\nrolling = 0.5"
    weak = (f"stall_torque = {STALL}\ntolerance = 1e-11", rubbing)
    alone = scene(weak)
    with pytest.raises(EffectError) as error:
        alone.effect("kinematics")
    assert error.value.finding == "no-speed"
    assert "stalls" in alone.effects.findings("contact-force")[0].sentence
    given = scene(weak, ('rotation = "ccw"\n', 'rotation = "ccw"\nspeed = 500\n'))
    turn = {each.name: each.value for each in given.effect("kinematics").findings}["turn-time"]
    assert turn == pytest.approx(60.0 / 500.0)
    assert "simplified" in [each.name for each in given.effects.findings("kinematics")]


# The time course ---------------------------------------------------------------------------------


@cache
def loaded(name: str, tolerance: str, train: str = "elastic") -> Design:
    if name == "motor":
        changes = (
            (RIGID, f'output = "{train}"'),
            ("tolerance = 1e-11", f"tolerance = {tolerance}"),
        )
        return scene(*changes)
    folder = SCENES.parent / "effects"
    text = (folder / f"{name}.toml").read_text("utf-8")
    table = "[effects.speed-fluctuation]\n"
    assert text.count(table) == 1
    text = text.replace(table, f"{table}tolerance = {tolerance}\n")
    text += f'\n[state]\noutput = "{train}"\n'
    return Design(parse_scene(text, str(folder / f"{name}.toml")))


@pytest.mark.parametrize("name", DRIVEN)
def test_rates_and_time_are_derivatives_of_one_another(name: str) -> None:
    course: TimeCourse = loaded(name, "1e-8").effect(SPEED_FLUCTUATION).course
    edges = np.append(course.borders, TURN)
    wide = np.flatnonzero(np.diff(edges) > 1e-3)
    phi, step = 0.5 * (edges[wide] + edges[wide + 1]) + 1e-4, 1e-5
    before, here, after = (course.rates(phi + k * step) for k in (-1, 0, 1))
    omega = here[0]
    pace = 2.0 * step / (course.time(phi + step) - course.time(phi - step))
    assert pace == pytest.approx(omega, rel=1e-8)
    assert (after[0] - before[0]) / (2.0 * step) * omega == pytest.approx(
        here[1], abs=1e-6 * np.max(np.abs(here[1]))
    )
    turn = period(course)
    assert course.time(phi + TURN) - course.time(phi) == pytest.approx(turn, rel=1e-13)
    assert np.array_equal(course.rates(phi - TURN)[0], course.rates(phi)[0]) or course.rates(
        phi - TURN
    )[0] == pytest.approx(omega, rel=1e-12)


def test_alpha_jumps_where_the_law_does_and_nowhere_else() -> None:
    """A simple sine presses the roller, which takes torque as it rolls, harder at once."""
    text = MOTOR.replace("polynomial-345", "simple-sine") + "[effects.friction]\nrolling = 0.5\n"
    course = scene(text=text).effect(SPEED_FLUCTUATION).course
    right, left = (course.rates(course.borders, side) for side in ("right", "left"))
    size = np.max(np.abs(course.rates(PHI)[1]))
    jumps = np.abs(right[1] - left[1]) > 1e-4 * size
    assert np.array_equal(course.borders[jumps], course.jumps)
    assert len(course.jumps)
    assert right[0] == pytest.approx(left[0], rel=1e-9)


def test_a_constant_speed_has_no_side() -> None:
    course = ConstantSpeed(3.0)
    assert np.array_equal(course.rates(PHI, "left"), course.rates(PHI, "right"))


# Errors ------------------------------------------------------------------------------------------


def assert_true(own: Result, best: Result, what: str) -> None:
    for each in compared(own, best):
        assert each.holds, (what, each)


@pytest.mark.parametrize("name", DRIVEN)
@pytest.mark.parametrize("tolerance", ["1e-2", "1e-4", "1e-6", "1e-8", "1e-10"])
def test_errors_are_true(name: str, tolerance: str) -> None:
    """Of each figure of each effect that depends on the speed."""
    rough, fine = (loaded(name, f"{float(tolerance) / each:g}") for each in (1.0, TIGHTER))
    for effect in rough.scene.effects:
        if SPEED_FLUCTUATION not in [each.by for each in find_effect(effect).refined_by]:
            continue
        own, best = rough.effect(effect), fine.effect(effect)
        figures = {each.name for each in own.columns}
        figures |= {each.name for each in own.findings if each.value is not None}
        assert figures <= {*own.errors}
        assert_true(own, best, effect)


@settings(max_examples=examples(8, long=200), deadline=None)
@given(st.floats(2e-3, 0.5), st.floats(150.0, 900.0), st.floats(10.0, 200.0))
def test_errors_are_true_for_any_motor(moment: float, speed: float, stall: float) -> None:
    of = [
        scene(
            (f"moment_of_inertia = {MOMENT}", f"moment_of_inertia = {moment!r}"),
            (f"no_load_speed = {NO_LOAD}", f"no_load_speed = {speed!r}"),
            (f"stall_torque = {STALL}", f"stall_torque = {stall!r}"),
            ("tolerance = 1e-11", f"tolerance = {tolerance}"),
        )
        for tolerance in ("1e-3", "1e-5")
    ]
    for name in ("contact-force", "drive-torque", "kinematics"):
        try:
            own, best = (made.effect(name) for made in of)
        except EffectError:
            return
        assert_true(own, best, name)


def test_a_false_statement_is_seen() -> None:
    rough, fine = (loaded("motor", each) for each in ("1e-2", "1e-8"))
    own, best = (each.effect("contact-force") for each in (rough, fine))
    sure: Any = object.__new__(type(own))
    for field in own.__dataclass_fields__:
        object.__setattr__(sure, field, {} if field == "errors" else getattr(own, field))
    assert not all(each.holds for each in compared(sure, best))
