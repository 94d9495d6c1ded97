"""Friction in pivots and guides under their whole loads, against own balances of free bodies."""

from __future__ import annotations

from typing import Any, Final

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import brentq

from camgeo.design.design import Design
from camgeo.dynamics.effects.bearing_friction import RubbingLaw, directions, jam_reserve, linear_at
from camgeo.numeric.arrays import FloatArray
from camgeo.scene.scene import load_scene
from tests.effects.scenes import SCENES
from tests.long_form import LONG, examples

ROUNDING: Final = 1e-12

NUMBERS: Final = st.floats(-1.0, 1.0)
VECTORS: Final = st.builds(complex, NUMBERS, NUMBERS)


def lever(**values: Any) -> Design:
    return Design(load_scene(SCENES.parent / "effects" / "lever.toml").with_values(values))


@given(
    st.floats(0.0, 1e3), st.floats(0.2, 1.0), st.floats(-0.9, 0.9),
    st.lists(st.tuples(VECTORS, VECTORS), min_size=1, max_size=2),
)  # fmt: skip
@settings(max_examples=examples(40, long=2000))
def test_the_balance_has_one_root(
    released: float, free: float, share: float, loads: list[tuple[complex, complex]]
) -> None:
    """h(n) = |R_0|: the root is met to rounding, and a bracketing search finds it too."""
    own = np.array([[a] for a, _ in loads], dtype=np.complex128) * 100.0
    per = np.array([[b] for _, b in loads], dtype=np.complex128)
    size = float(np.sum(np.abs(per)))
    drag = share * free / max(size, 1e-3)
    demand = released - drag * float(np.sum(np.abs(own)))

    def left(n: float) -> float:
        return free * n - drag * float(np.sum(np.abs(own + per * n))) - demand

    one = np.ones(1)
    assert jam_reserve(free * one, drag * one, per)[0] > 0.0
    (n,), _ = directions(demand * one, free * one, drag * one, own, per)
    terms = abs(demand) + abs(drag) * float(np.sum(np.abs(own) + np.abs(per) * n)) + free * n
    assert n >= -ROUNDING * terms / free
    assert abs(left(n)) <= ROUNDING * terms
    if released > 1e-3:
        wanted = brentq(left, 0.0, 1e7, xtol=1e-13, rtol=1e-14)
        assert n == pytest.approx(wanted, rel=1e-9, abs=1e-9)


@given(st.floats(1.0, 200.0), st.floats(-500.0, 500.0), st.floats(1e-4, 1.0), st.integers(0, 10))
@settings(max_examples=examples(20, long=1000))
def test_one_cam_angle_gives_what_many_do(
    omega: float, alpha: float, slowing: float, seed: int
) -> None:
    """The law for single numbers, and the linear law has the torque and the slope of the whole."""
    numbers = np.random.default_rng(seed)
    parts = [numbers.normal(size=(8, each)) for each in (1, 2)]
    own = (parts[0] @ np.ones((1, 2))).reshape(4, 2, 2)[:, :1] + 1j * numbers.normal(size=(4, 1, 2))
    law = RubbingLaw(
        demand=numbers.normal(size=(4, 2)) * 50.0,
        torque=np.array([[3.0, 2.0], [-3.0, -2.0]]),
        free=np.array([[5.0, 6.0], [-5.0, -6.0]]),
        drag=np.array([0.3, -0.3]),
        own=own,
        per=np.exp(1j * numbers.normal(size=(2, 1, 2))),
    )
    law = RubbingLaw.of(law.rows)
    linear = law.linear(omega, alpha)
    for k in range(2):
        one = linear_at(law.rows[:, k].tolist(), omega, alpha, 0.0)
        assert one == pytest.approx(linear[:, k].tolist(), rel=1e-9, abs=1e-9)

    def torque(omega: float, alpha: float) -> FloatArray:
        index, n, _ = law.solved(omega, alpha)
        return np.asarray(np.where(index == 0, law.torque[0], law.torque[1]) * n)

    c0, c1, c2, c3, gain, _ = linear
    force = c0 + omega * (c1 + omega * c2) + alpha * c3
    assert np.allclose(gain * force, torque(omega, alpha), rtol=1e-11, atol=1e-9)


@pytest.mark.parametrize("mu", [0.1, 0.4])
def test_at_lift_off_with_a_loaded_pivot_the_force_is_0(mu: float) -> None:
    """At the lift-off speed, and at a higher speed with the least preload and stiffness."""
    less = {"effects.vibration": None, "effects.contact-pressure": None,
            "effects.drive-torque": None, "effects.friction.pivot": mu}  # fmt: skip

    def told(**values: Any) -> dict[str, Any]:
        return {
            each.name: each.value for each in lever(**less, **values).effect("lift-off").findings
        }

    speed = told()["lift-off-speed"]
    fast = told(**{"cam.speed": 1300.0})
    changes: list[dict[str, Any]] = [{"cam.speed": speed}]
    changes += [
        {"cam.speed": 1300.0, f"effects.spring.{key}": fast[f"least-{key}"]}
        for key in ("preload", "stiffness")
    ]
    for change in changes:
        extremes = lever(**less, **change).effect("contact-force").extremes
        assert abs(extremes.lowest.value) <= 1e-9 * extremes.magnitude


def linked_press(**values: Any) -> Design:
    """Rigid, at the stated speed, with a pivot that takes much."""
    less = dict.fromkeys(("speed-fluctuation", "contact-pressure", "vibration", "balance"))
    changes = {f"effects.{name}": None for name in less} | {"effects.friction.pivot": 0.4}
    scene = load_scene(SCENES.parent / "effects" / "linked_press.toml")
    return Design(scene.with_values({**changes, **values}))


def test_at_lift_off_behind_a_linkage_the_force_is_0() -> None:
    """The spring presses on the slider, and loads the pivot through the coupler."""
    told = {each.name: each.value for each in linked_press().effects.findings("lift-off")}
    fast = {"cam.speed": 500.0}
    changes = [{"cam.speed": told["lift-off-speed"]}]
    if LONG:  # the least preload of a loaded pivot without a linkage is below
        over = {each.name: each.value for each in linked_press(**fast).effects.findings("lift-off")}
        assert (over["least-preload"] or 0.0) > 480.0
        changes.append({**fast, "effects.spring.preload": over["least-preload"]})
    for change in changes:
        extremes = linked_press(**change).effect("contact-force").extremes
        assert abs(extremes.lowest.value) <= 1e-9 * extremes.magnitude
