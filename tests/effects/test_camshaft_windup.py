"""Windup of the camshaft: compared with own integrations of Newton's law, and with runs that are a
hundred times as accurate.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from camgeo.design.design import Design
from camgeo.dynamics.effects.feedback import Passed, spread
from camgeo.dynamics.effects.forces import ElasticTrain
from camgeo.dynamics.effects.registry import find_effect
from camgeo.dynamics.effects.results import CAMSHAFT_WINDUP, DRIVE_TORQUE
from camgeo.dynamics.state.state import Used
from camgeo.errors import EffectError, SceneError
from camgeo.kinematics.time_course import period
from camgeo.numeric.arrays import FloatArray
from camgeo.scene.scene import load_scene, parse_scene
from camgeo.studies.accuracy.survey import TIGHTER
from camgeo.units import RPM, TURN
from tests.effects.scenes import SCENES
from tests.effects.shafts import (
    PHI,
    SCENE,
    SPEED,
    Rates,
    assert_true,
    lift,
    newton,
    over_turn,
    settled,
    states_at,
)
from tests.findings import finding_values
from tests.integrals import cells, integrals
from tests.long_form import examples

BASE = parse_scene(SCENE)

Case = tuple[float, float, float]
"""Stiffness [N m/rad], moment of inertia [kg m^2] and damping ratio of a shaft."""

CASES: tuple[Case, ...] = ((1200.0, 0.002, 0.1), (30.0, 0.003, 0.3), (400.0, 2e-4, 0.15))
"""A usual shaft, a soft one, and one with a light cam, whose follower is heavier than it."""

Train = tuple[float, float]
"""Natural frequency [Hz] and damping ratio of all the mass of the follower behind a spring."""

FRICTION = {"rolling": 0.5, "guide": 0.1, "guide_length": 60, "guide_overhang": 30}


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


INTEGRATED = 3e-8
"""Relative error of `solve_ivp` with its interpolant, and of what has not died out."""


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
    for own, each in zip(wanted, turn.sought, strict=False):
        error = each.bound.error + INTEGRATED * np.max(np.abs(own))
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
    plain = Passed.on_base

    def disturbed(self: Passed, phi: FloatArray, side: Any) -> FloatArray:
        return plain(self, phi, side) + off * np.outer([1.0, 0.0, 0.0, 0.0], np.sin(16.0 * phi))

    monkeypatch.setattr(Passed, "on_base", disturbed)
    monkeypatch.setattr(ElasticTrain, "error", off)
    found = shaft(case, 1e-1, train).effect(CAMSHAFT_WINDUP)
    for one, other in zip(exact.sought, found.sought, strict=True):
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
    rubbing: dict[str, Any] = {"effects.friction": FRICTION}
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


MOTOR = {"moment_of_inertia": 1, "no_load_speed": 600, "stall_torque": 90}


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


def assert_errors_true(rough: Design, fine: Design) -> None:
    for effect in rough.scene.effects:
        if CAMSHAFT_WINDUP in (effect, *[each.by for each in find_effect(effect).refined_by]):
            assert_true(rough.effect(effect), fine.effect(effect), effect)


@pytest.mark.parametrize("tolerance", [1e-2, 1e-4, 1e-6, 1e-8])
def test_errors_are_true(tolerance: float) -> None:
    scene = load_scene(SCENES.parent / "effects" / "camshaft_windup.toml")
    rough, fine = (
        Design(scene.with_values({"effects.camshaft-windup.tolerance": each}))
        for each in (tolerance, tolerance / TIGHTER)
    )
    assert_errors_true(rough, fine)


@settings(max_examples=examples(8, long=300), deadline=None)
@given(
    st.floats(1.0, 6.0).map(lambda power: 10.0**power), st.floats(1e-4, 0.1),
    st.sampled_from([0.0, 0.005, 0.05, 0.4]), st.sampled_from([1e-3, 1e-5, 1e-7]),
)  # fmt: skip
def test_errors_are_true_for_any_shaft(
    stiffness: float, moment: float, damping: float, tolerance: float
) -> None:
    case = (stiffness, moment, damping)
    rough, fine = shaft(case, tolerance), shaft(case, tolerance / TIGHTER)
    try:
        rough.effect(CAMSHAFT_WINDUP)
        fine.effect(CAMSHAFT_WINDUP)
    except EffectError:
        return
    assert_errors_true(rough, fine)
