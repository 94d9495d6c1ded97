"""Friction in pivots and guides under their whole loads, against own balances of free bodies."""

from __future__ import annotations

import itertools
import math
from typing import Any, Final

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import brentq

from camgeo.design.design import Design
from camgeo.dynamics.effects.bearing_friction import RubbingLaw, directions, jam_reserve
from camgeo.dynamics.effects.speed_fluctuation.result import _linear
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


def test_the_root_is_that_of_the_quadratic() -> None:
    """A single load: (p n - R)^2 = w^2 |A + B n|^2, of which the root with the sign of w counts."""
    own, per = np.array([[40.0 - 25.0j]]), np.array([[-0.3 + 1.1j]])
    for drag in (0.4, -0.4):
        free, demand = 0.9, 55.0
        a = free**2 - drag**2 * abs(per[0, 0]) ** 2
        b = free * demand + drag**2 * (np.conj(own) * per)[0, 0].real
        c = demand**2 - drag**2 * abs(own[0, 0]) ** 2
        root = math.sqrt(b * b - a * c)
        one = np.ones(1)
        (n,), _ = directions(demand * one, free * one, drag * one, own, per)
        assert n == pytest.approx((b + math.copysign(root, drag)) / a, rel=1e-13)


@pytest.mark.parametrize("rev", [30.0, 300.0, 900.0])
def test_a_lever_against_the_balance_of_its_free_body(rev: float) -> None:
    """Spring, inertia and contact as vectors; the moments about the pivot by Brent's method."""
    made = lever(**{"cam.speed": rev, "effects.lift-off": None, "effects.vibration": None,
                    "effects.contact-pressure": None})  # fmt: skip
    edges, follower = made.drive.smooth_angles, made.cam.follower
    phi = np.concatenate([np.linspace(a, b, 9)[1:-1] for a, b in itertools.pairwise(edges)])
    pivot, swing = complex(95.0, 10.0), follower.swing_sense
    jet, speed = made.cam.drive.motion.jet(phi), rev * math.pi / 30.0
    moving = np.sign(np.where(np.abs(jet[1]) > 1e-12, jet[1], 0.0))
    curve = made.cam.disc.pitch_curve.jet(phi)
    turned = np.exp(1j * made.cam.rotation * phi)
    tangent = curve[1] / np.abs(curve[1]) * turned
    push = 1j * made.cam.rotation * tangent  # outwards
    centre = curve[0] * turned
    end = pivot + (60.0 - 14.0j - pivot) * np.exp(1j * swing * jet[0])
    line = (40.0 + 70.0j) - end
    spring = line / np.abs(line) * (220.0 + 6.0 * (np.abs(line) - abs(-20.0 + 84.0j)))
    turning = swing * jet[2] * speed**2
    arm = centre - pivot
    masses = 0.08e-3 * (1j * turning - (jet[1] * speed) ** 2) * arm
    inertia = (1.6 + 0.08e-3 * np.abs(arm) ** 2) * turning
    about = np.imag(np.conj(end - pivot) * spring) - inertia
    own = masses - spring
    wanted = []
    for k in range(len(phi)):

        def left(n: float, k: int = k) -> float:
            contact = n * push[k]
            moment = np.imag(np.conj(arm[k]) * contact) + about[k]
            return float(moment - swing * moving[k] * abs(own[k] - contact))  # mu d / 2 = 1 mm

        wanted.append(brentq(left, 0.0, 1e5, xtol=1e-12, rtol=1e-14))
    normal = made.effect("contact-force").normal(phi, "right")
    assert np.max(np.abs(normal - wanted)) <= 1e-11 * np.max(wanted)


def test_without_friction_it_is_that_of_a_lever_without_bearings() -> None:
    """mu -> 0: the force tends to that without friction, in proportion to mu."""
    phi = np.linspace(0.6, 5.0, 40)

    def normal(mu: float) -> FloatArray:
        found = lever(**{"effects.friction.pivot": mu}).effect("contact-force")
        return np.asarray(found.normal(phi, "right"))

    bare = normal(0.0)
    first, second = (np.max(np.abs(normal(mu) - bare)) for mu in (1e-3, 1e-6))
    assert first / second == pytest.approx(1e3, rel=1e-2)
    assert second <= 1e-6 * np.max(bare)


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
        one = _linear(law.rows[:, k].tolist(), omega, alpha, 0.0)
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


ELASTIC: Final[dict[str, dict[str, Any]]] = {
    "lever": {"effects.friction.pivot": 0.4},
    "linked_press": {
        "effects.speed-fluctuation": None,
        "effects.friction.pivot": 0.4,
    },
}


# A rigid one is above; the speed of an elastic one with a loaded pivot is in `test_recorded`.
@pytest.mark.long
@pytest.mark.parametrize("name", ELASTIC)
def test_an_elastic_train_lifts_off_where_its_force_loads_the_pivot(name: str) -> None:
    """At the speed that is told the force of the steady state falls to 0, and not before."""
    scene = load_scene(SCENES.parent / "effects" / f"{name}.toml")
    scene = scene.with_values({**ELASTIC[name], "effects.contact-pressure": None})
    found = Design(scene).effects.findings("lift-off")
    (speed,) = (each.value for each in found if each.name == "lift-off-speed")
    assert speed is not None
    for factor, sign in ((1.0, 0), (0.999, 1), (1.001, -1)):
        made = Design(scene.with_values({"cam.speed": factor * speed}))
        extremes = made.effect("contact-force").extremes
        low = extremes.lowest.value / extremes.magnitude
        assert abs(low) <= 1e-7 if sign == 0 else sign * low > 1e-7
