"""Effects at the speed that `speed-fluctuation` finds: compared with own integrations, and with
runs whose speed is a hundred times as accurate.
"""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from camgeo.design.design import Design
from camgeo.dynamics.effects import feedback as feedback_module
from camgeo.dynamics.effects.registry import find_effect
from camgeo.dynamics.effects.results import SPEED_FLUCTUATION
from camgeo.dynamics.state.state import Used
from camgeo.errors import EffectError, SceneError
from camgeo.kinematics.time_course import TimeCourse, period
from camgeo.scene.scene import load_scene, parse_scene
from camgeo.studies.accuracy.survey import TIGHTER
from camgeo.units import RPM, TURN
from tests.effects.scenes import SCENES
from tests.effects.shafts import (
    MASS,
    PHI,
    PRELOAD,
    SCENE,
    SPRING,
    assert_true,
    lift,
    newton,
    settled,
    states_at,
)
from tests.findings import finding_values
from tests.long_form import LONG, examples

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
    assert error < 2e-5 * work["motor-work"]


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
    return Design(found.with_values({"effects.speed-fluctuation.tolerance": tolerance}))


@pytest.mark.parametrize("name", DRIVEN)
def test_rates_and_time_are_derivatives_of_one_another(name: str) -> None:
    course: TimeCourse = loaded(name, 1e-8).effect(SPEED_FLUCTUATION).course
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


@pytest.mark.parametrize("name", DRIVEN)
@pytest.mark.parametrize("tolerance", [1e-2, 1e-4, 1e-6, 1e-8, 1e-10])
def test_errors_are_true(name: str, tolerance: float) -> None:
    """Of each figure of each effect that depends on the speed."""
    rough, fine = (loaded(name, tolerance / each) for each in (1.0, TIGHTER))
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
    motor = {"moment_of_inertia": moment, "no_load_speed": speed, "stall_torque": stall}
    of = [scene(**motor, tolerance=tolerance) for tolerance in (1e-3, 1e-5)]
    for name in ("contact-force", "drive-torque", "kinematics"):
        try:
            own, best = (made.effect(name) for made in of)
        except EffectError:
            return
        assert_true(own, best, name)
