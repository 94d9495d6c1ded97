"""Flights off the cam, against an event-driven integration of the free follower by scipy.

The oracle knows the demanded lift over the cam angle, and the data of the scene. It writes down its
own equation of motion of the free follower in time, with DOP853 at tolerances of 1e-13, and lands
where the lift is that of the cam again. It finds itself where the follower leaves.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from camgeo.design import Design
from camgeo.effects.lift_off import flight
from camgeo.errors import GeometryError
from camgeo.scene.load import load_scene, parse_scene
from camgeo.units import TURN
from tests.effects.scenes import SCENES, design

EFFECTS: Final = SCENES.parent / "effects"

GRAVITY: Final = 9806.65
"""[mm/s^2], standard gravity."""


def loaded(name: str, *changes: tuple[str, str]) -> Design:
    """The scene of an effect, with texts replaced that it has once, and a rigid train."""
    path: Path = EFFECTS / f"{name}.toml"
    text = path.read_text("utf-8")
    for old, new in changes:
        assert text.count(old) == 1, old
        text = text.replace(old, new)
    text += '\n[state]\noutput = "rigid"\n'
    return Design(parse_scene(text, str(path)))


@dataclass(frozen=True)
class Free:
    """A follower by its own data: its mass, and the force on it at a lift and a velocity."""

    of: Design
    omega: float
    mass: float
    force: Callable[[float, float], float]
    lever: Callable[[float], float]

    def lift(self, phi: float, order: int = 0) -> float:
        return float(self.of.cam.drive.plan.jet(np.array([phi % TURN]))[order, 0])

    def missing(self, phi: float) -> float:
        """What presses the follower on the cam, less what its acceleration takes."""
        here = self.force(self.lift(phi), self.omega * self.lift(phi, 1))
        return here - self.mass * self.omega**2 * self.lift(phi, 2)

    def flight(self, leaving: float, rate: float) -> tuple[float, float, float]:
        """Landing [rad], rate of the gap there [per s], largest gap, after `leaving` [rad]."""

        def motion(t: float, y: Any) -> list[float]:
            del t
            return [y[1], self.force(y[0], y[1]) / self.mass]

        def gap(t: float, y: Any) -> float:
            return float(y[0] - self.lift(leaving + self.omega * t))

        def closing(t: float, y: Any) -> float:
            return float(y[1] - self.omega * self.lift(leaving + self.omega * t, 1))

        gap.terminal, gap.direction = True, -1  # type: ignore[attr-defined]  # as scipy wants it
        begin = [self.lift(leaving), self.omega * self.lift(leaving, 1) + rate]
        # The gap opens with the third power of time; before that the event would be rounding.
        soon = 0.0 if rate else 2e-3 / self.omega
        first = solve_ivp(motion, (0.0, soon), begin, "DOP853", rtol=1e-13, atol=1e-14).y[:, -1]
        span = (soon, soon + TURN / self.omega)
        if rate:  # the first event would be the start itself
            first = np.array([begin[0] + 1e-13, begin[1]])
        found = solve_ivp(
            motion, span, first, "DOP853", rtol=1e-13, atol=1e-14, events=(gap, closing),
            max_step=0.02 / self.omega,
        )  # fmt: skip
        time = float(found.t_events[0][0])
        most = max(gap(t, y) for t, y in zip(found.t_events[1], found.y_events[1], strict=True))
        return leaving + self.omega * time, closing(time, found.y_events[0][0]), most


def press(speed: float, restitution: float = 0.0) -> Free:
    of = loaded(
        "lift_off_elastic",
        ("speed = 600", f"speed = {speed}"),
        ("[effects.lift-off]", f"[effects.lift-off]\nrestitution = {restitution}"),
        ("[effects.inertia]", "[effects.gravity]\n[effects.inertia]"),
    )
    weight = 1.5e-3 * GRAVITY * of.cam.follower.way.imag

    def lever(phi: float) -> float:
        start = of.cam.follower.base_radius
        return math.cos(math.atan(free.lift(phi, 1) / (start + free.lift(phi))))

    free = Free(of, speed * math.pi / 30.0, 1.5e-3, lambda q, v: -(60.0 + 2.0 * q) - weight, lever)
    return free


def lever() -> Free:
    """A rocker with a spring between two points, its weight, and a damper at its pivot."""
    of = loaded(
        "lever",
        ("speed = 300", "speed = 1200"),
        ("pivot = 0.1\n", "pivot = 0.1\npivot_viscous = 0.05\n"),
        ("[effects.contact-force]", "[effects.gravity]\n[effects.contact-force]"),
    )
    pivot, arm = complex(95, 10), of.cam.follower.start_arm
    anchor, attached = complex(40, 70) - pivot, complex(60, -14) - pivot
    sense, mass = of.cam.follower.swing_sense, 1.6 + 0.08e-3 * 85.0**2
    first = abs(attached - anchor)

    def force(q: float, rate: float) -> float:
        turn = cmath.exp(1j * sense * q)
        at = attached * turn
        pull = (anchor - at) / abs(anchor - at) * (220.0 + 6.0 * (abs(anchor - at) - first))
        weight = -0.08e-3 * GRAVITY * 1j
        torque = (at.conjugate() * pull + (arm * turn).conjugate() * weight).imag
        return sense * torque - 50.0 * rate

    def leverage(phi: float) -> float:
        return float(of.cam.disc.pitch_curve.leverage(np.array([phi % TURN]))[0])

    return Free(of, 1200.0 * math.pi / 30.0, mass, force, leverage)


def thrown() -> Free:
    """A follower whose velocity jumps to 0 at 140 degrees, and that goes on with the one it had."""
    of = design(
        "straight_moves",
        "[effects.inertia]\nmass = 1\n[effects.spring]\nstiffness = 50\npreload = 1e4\n"
        "[effects.lift-off]",
        ('undercut = "trim"', 'undercut = "refuse"'),
    )

    def leverage(phi: float) -> float:
        return float(of.cam.disc.pitch_curve.leverage(np.array([phi % TURN]))[0])

    return Free(of, 20.0 * math.pi / 30.0, 1e-3, lambda q, v: -(1e4 + 50.0 * q), leverage)


CASES: Final = {
    "short": lambda: press(400.0),
    "long": lambda: press(600.0),
    "rebounds": lambda: press(400.0, 0.4),
    "rocker": lever,
    "thrown": thrown,
}


@pytest.mark.parametrize("name", CASES)
def test_flights_are_those_of_a_free_follower(name: str) -> None:
    free = CASES[name]()
    result = free.of.effect("lift-off")
    flights = result.flights
    assert flights
    told = result.errors["impact-speed"].share
    assert told <= 1e-6
    leaving, rate = math.radians(140.0), 0.0
    if name == "thrown":
        rate = free.omega * 18.0 / math.radians(90.0)
    else:
        near = flights[0].leaving
        leaving = brentq(free.missing, near - 0.01, near + 0.01, xtol=1e-15)
    for number, each in enumerate(flights):
        assert each.leaving == pytest.approx(leaving, abs=1e-9)
        landing, closing, most = free.flight(leaving, rate)
        assert each.landing == pytest.approx(landing, abs=1e-8)
        assert each.speed == pytest.approx(abs(free.lever(landing) * closing), rel=1e-8)
        assert each.gap == pytest.approx(most, rel=1e-8)
        restitution = 0.4 if name == "rebounds" else 0.0
        following = flights[number + 1] if number + 1 < len(flights) else None
        if following is None or not (following.rebound or following.leaving == each.landing):
            break
        leaving, rate = landing, -restitution * closing


def test_errors_told_of_rough_flights_are_true(monkeypatch: pytest.MonkeyPatch) -> None:
    free = press(400.0, 0.4)
    exact = free.of.effect("lift-off").flights
    for orders in ((2, 3), (3, 4)):
        monkeypatch.setattr(flight, "ORDERS", orders)
        rough = free.of.effects.recomputed("lift-off", 1e-2).result("lift-off")
        assert len(rough.flights) == len(exact)
        for each, true in zip(rough.flights, exact, strict=True):
            assert abs(each.speed - true.speed) <= each.error * each.speed
            assert abs(each.gap - true.gap) <= each.error * each.gap
            assert each.error <= 1e-2
        assert max(each.error for each in rough.flights) > 1e-9


def test_where_no_landing_can_be_given_it_says_why() -> None:
    def told(*changes: tuple[str, str]) -> str:
        found = loaded("lift_off_elastic", *changes).effects.findings("lift-off")
        return next(each.sentence for each in found if each.name == "flight")

    far = told(("speed = 600", "speed = 1500"))
    assert "still off the inner flank where the next turn's first flight begins" in far
    held = loaded("lift_off_elastic", ("speed = 600", "speed = 300")).effects.findings("lift-off")
    assert "flight" not in {each.name for each in held}
    elastic = Design(load_scene(str(EFFECTS / "lift_off_elastic.toml"))).effects
    said = {each.sentence for each in elastic.findings("lift-off")}
    assert any("the free motion of an elastic train is not computed" in each for each in said)
    light = design(
        "plate_translating", "[effects.load]\nconstant = -50\n[effects.lift-off]"
    ).effects.findings("lift-off")
    assert "no landing is given: it needs [effects.inertia]" in {each.sentence for each in light}


def test_a_restitution_is_refused_where_the_follower_is_held_on_both_sides() -> None:
    held = loaded("groove_lever", ("[effects.lift-off]", "[effects.lift-off]\nrestitution = 0.2"))
    with pytest.raises(GeometryError, match="held on both sides") as caught:
        held.effect("lift-off")
    assert caught.value.key == "effects.lift-off.restitution"
