"""Stated errors are true: no figure of a numerical effect is off by more than its result says.

Figures are the values of all findings and the columns over the turn, compared with those of a
computation to a hundredth of the tolerance.
"""

from __future__ import annotations

import math
from dataclasses import replace
from random import Random
from typing import Any, Final

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from camgeo.design.design import Design
from camgeo.dynamics.effects.effect import Bound, Result
from camgeo.dynamics.effects.graph import WithTrain
from camgeo.dynamics.effects.registry import EFFECTS, find_effect
from camgeo.dynamics.oscillator.steady import Response
from camgeo.errors import EffectError
from camgeo.numeric.arrays import FloatArray, Side
from camgeo.scene.scene import load_scene
from camgeo.studies.accuracy.survey import TIGHTER, compared, figures_of
from camgeo.units import TURN
from tests.effects.scenes import SCENES, design
from tests.long_form import LONG, examples

NAMES: Final = (
    "plate_translating", "setzhub", "groove", "inch", "querhub", "schnitt", "feed", "shuttle",
    "measured", "vorschub", "ring",
)  # fmt: skip
"""Scenes with rollers of all kinds; with friction the torque has kinks wherever the load changes
sides."""

TOLERANCES: Final = (1e-2, 1e-4, 1e-6, 1e-8, 1e-10) if LONG else (1e-2, 1e-5)

NUMERICAL: Final = tuple(name for name in EFFECTS if find_effect(name).numerical)


def drawn(rng: Random) -> Design:
    """A scene with all numerical effects, whose numbers range over decades."""
    name = rng.choice(NAMES)
    text = (SCENES / f"{name}.toml").read_text("utf-8")
    rocks = "oscillating" in text

    def number(low: float, high: float) -> str:
        return f"{math.exp(rng.uniform(math.log(low), math.log(high))):.3g}"

    moving = ("moment_of_inertia", (1e-4, 1e-1)) if rocks else ("mass", (0.1, 5.0))
    tables = [f"[effects.inertia]\n{moving[0]} = {number(*moving[1])}"]
    if rocks:
        kind = 'kind = "torsion"\ntorsional_stiffness = '
        tables.append(f"[effects.spring]\n{kind}{number(1, 50)}\npreload_torque = {number(1, 100)}")
    else:
        wire = f"diameter = 0.1\ncoil_diameter = 1\nactive_coils = {number(1, 20)}"
        tables.append(
            f"[effects.spring]\npreload = {number(10, 1e3)}\n[effects.spring.wire]\n{wire}\n"
            f"free_length = 90\ndensity = {number(1e-3, 1e5)}\n[effects.spring-surge]"
        )
    if rng.random() < 0.6:
        pivot = "\npivot = 0.1\npivot_diameter = 12" if rocks else ""
        tables.append(f"[effects.friction]\nrolling = 0.02{pivot}")
    tables.append("[effects.reactions]")
    motor = f"no_load_speed = {number(20, 600)}\nstall_torque = {number(5, 5e4)}"
    damping = f"damping = {rng.choice((0.0, 0.01, 0.1, 0.4))}"
    backlash = 'contact = "groove"' in text and "side_clearance" not in text
    tables += [
        "[effects.drive-torque]\nfluctuation = 0.05",
        f"[effects.speed-fluctuation]\nmoment_of_inertia = {number(1e-3, 10)}\n{motor}",
        f"[effects.vibration]\nnatural_frequency = {number(2, 500)}\n{damping}",
        "[effects.lift-off]" + (f"\nbacklash = {number(5e-3, 0.3)}" if backlash else ""),
        f"[effects.contact-pressure]\nwidth = {0.2 if name == 'inch' else 4}\nrating = 5000",
        "[effects.balance]",
    ]
    changes = [] if "\nspeed = " in text else [("[cam]\n", "[cam]\nspeed = 200\n")]
    return design(name, "\n".join(tables), *changes)


def result_of(of: Design, name: str, tolerance: float) -> Result | None:
    """The effect to a tolerance; None if it has no answer."""
    try:
        result: Result = of.effects.recomputed(name, tolerance).result(name)
    except EffectError:
        return None
    return result


def assert_true(of: Design, name: str, *tolerances: float) -> None:
    """Each is compared with the result to a hundredth."""
    for tolerance in tolerances:
        own, best = (result_of(of, name, each) for each in (tolerance, tolerance / TIGHTER))
        for each in compared(own, best) if own is not None and best is not None else ():
            assert each.holds, (name, tolerance, each)


@settings(max_examples=examples(2, long=50), deadline=None)
@given(st.randoms(use_true_random=False))
def test_no_figure_of_any_scene_is_off_by_more_than_stated(rng: Random) -> None:
    found = drawn(rng)
    for name in set(NUMERICAL) & found.scene.effects.keys():
        assert_true(found, name, *TOLERANCES)


def test_a_false_statement_is_seen() -> None:
    of = design("schnitt", KINKED)
    own, best = (result_of(of, "speed-fluctuation", each) for each in (1e-2, 1e-6))
    assert own is not None
    assert best is not None
    assert all(each.holds for each in compared(own, best))
    sure = {name: Bound(0.0, bound.scale) for name, bound in own.errors.items()}
    object.__setattr__(own, "errors", sure)
    assert {"cam speed", "motor-work"} <= {
        each.figure for each in compared(own, best) if not each.holds
    }


# What was off by more ----------------------------------------------------------------------------

KINKED: Final = (
    "[effects.inertia]\nmoment_of_inertia = 0.0635\n[effects.friction]\nrolling = 0.02\n"
    "[effects.speed-fluctuation]\nmoment_of_inertia = 1.21\nno_load_speed = 61.34\n"
    "stall_torque = 1700\n"
)
"""The load changes sides a hundredth of a degree after the end of a smooth piece."""


@pytest.mark.parametrize("tolerance", [1e-6, 1e-8])
def test_a_kink_that_no_node_sees(tolerance: float) -> None:
    assert_true(design("schnitt", KINKED), "speed-fluctuation", tolerance)


@pytest.mark.parametrize("tolerance", [1e-2, 1e-6])
def test_the_work_of_the_motor_is_as_accurate_as_stated(tolerance: float) -> None:
    """A strong motor, whose torque follows from a slip that is small compared with the speed."""
    strong = KINKED.replace("1700", "5e5")
    of = design("schnitt", strong)
    assert_true(of, "speed-fluctuation", tolerance)
    result = result_of(of, "speed-fluctuation", tolerance)
    assert result is not None
    for figure in ("motor-work", "mean-motor-power", "motor torque"):
        assert result.errors[figure].share <= tolerance


# Of an elastic train -----------------------------------------------------------------------------

TRAIN: Final = (
    "[effects.inertia]\n{mass}\n[effects.spring]\n{spring}\n[effects.load]\nconstant = 15\n"
    "[effects.friction]\nrolling = 0.02\n{friction}\n"
    "[effects.vibration]\nnatural_frequency = 90\ndamping = 0.05\n[effects.contact-force]\n"
    "[effects.contact-pressure]\nwidth = 4\nrating = 5000\n[effects.drive-torque]\n"
    "[effects.power-balance]\n[effects.reactions]\n"
    "[effects.roller-spin]\nmoment_of_inertia = 1e-5\ntraction = 0.05\n"
)
FOLLOWING: Final = (
    "contact-force", "contact-pressure", "drive-torque", "power-balance", "reactions",
    "roller-spin",
)  # fmt: skip
"""Effects whose figures follow from the force of the train; lift-off does too."""


def with_train(name: str) -> Design:
    rocks = name != "plate_translating"
    torsion = 'kind = "torsion"\ntorsional_stiffness = 20\npreload_torque = 60'
    values = {
        "mass": "moment_of_inertia = 0.01" if rocks else "mass = 0.8",
        "spring": torsion if rocks else "preload = 260\nstiffness = 4",
        "friction": "" if rocks else "guide = 0.08",
    }
    return design(name, TRAIN.format(**values))


@pytest.mark.parametrize("name", ["groove", "plate_translating"])
def test_a_force_of_the_train_off_by_its_error_moves_no_figure_by_more_than_stated(
    name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Whatever the course of the error, here of a train that is known to 0.05 N or N mm."""
    found = with_train(name)
    nodes = found.effects._nodes("contact-force")
    train = nodes.result("vibration")
    monkeypatch.setattr(Response, "error_of", lambda _self, _reading: 0.05)
    told = {each: found.effect(each) for each in FOLLOWING}
    for result in told.values():
        valued = {each.name for each in result.findings if each.value is not None}
        assert set(result.errors) == valued | {each.name for each in result.columns}
    alone = found.effects.recomputed("drive-torque").result("drive-torque")
    assert "drive torque" not in alone.errors  # of what depends on its tolerance only
    rng = np.random.default_rng(1)
    for count in (3, 0, 1, 17) if LONG else (3,):
        phase = rng.uniform(0.0, TURN)

        def way(phi: FloatArray, _side: Side, count: int = count, phase: float = phase) -> Any:
            return np.cos(count * phi + phase)

        off = replace(train, behind=train.behind._off(way))
        moved = WithTrain(nodes, off)
        for effect, result in told.items():
            own, other = figures_of(result), figures_of(moved.result(effect))
            assert own.keys() == other.keys()
            for figure, values in own.items():
                # A life goes with the power 10/3 of the load, of which the error is a thousandth.
                bound = 1.01 * result.errors[figure].error
                assert np.max(np.abs(values - other[figure])) <= bound, (effect, figure)
                assert bound <= 0.05 * result.errors[figure].scale, (effect, figure)


# Rounding ----------------------------------------------------------------------------------------


def test_conservative_forces_do_no_work() -> None:
    scene = Design(load_scene(str(SCENES.parent / "effects" / "motor_work_zero.toml")))
    values = {each.name: each.value for each in scene.effect("speed-fluctuation").findings}
    assert values["motor-work"] == 0.0
    assert values["mean-motor-power"] == 0.0
    assert values["largest-motor-torque"] > 0.9
