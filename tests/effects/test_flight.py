"""Flights off the cam, against an event-driven integration of the free follower by scipy.

The oracle knows the demanded lift over the cam angle, and the data of the scene. It writes down its
own equation of motion of the free follower in time, with DOP853 at tolerances of 1e-13, and lands
where the lift is that of the cam again. It finds itself where the follower leaves.
"""

from __future__ import annotations

import cmath
import math
import re
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from camgeo.design.design import Design
from camgeo.dynamics.effects.lift_off import flight
from camgeo.scene.scene import load_scene, parse_scene
from camgeo.units import TURN
from tests.effects.scenes import SCENES, changed, design
from tests.long_form import LONG, examples

EFFECTS: Final = SCENES.parent / "effects"

GRAVITY: Final = 9806.65
"""[mm/s^2], standard gravity."""


def loaded(name: str, *changes: tuple[str, str]) -> Design:
    """The scene of an effect, with texts replaced that it has once, and a rigid train."""
    path: Path = EFFECTS / f"{name}.toml"
    text = changed(path.read_text("utf-8"), *changes)
    return Design(parse_scene(f'{text}\n[state]\noutput = "rigid"\n', str(path)))


@dataclass(frozen=True)
class Free:
    """A follower by its own data: its mass, and the force on it at a lift and a velocity."""

    of: Design
    omega: float
    mass: float
    force: Callable[[float, float], float]

    def lever(self, phi: float) -> float:
        """Way along the normal a unit of lift."""
        return float(self.of.cam.disc.pitch_curve.leverage(np.array([phi % TURN]))[0])

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
        span = (soon, soon + 3.0 * TURN / self.omega)
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
    return Free(of, speed * math.pi / 30.0, 1.5e-3, lambda q, v: -(60.0 + 2.0 * q) - weight)


def lever() -> Free:
    """A rocker with a spring between two points, its weight, and a damper at its pivot."""
    of = loaded(
        "lever",
        ("speed = 300", "speed = 1200"),
        ("pivot = 0.1\n", "pivot_viscous = 0.05\n"),
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

    return Free(of, 1200.0 * math.pi / 30.0, mass, force)


def thrown(speed: float = 20.0, stiffness: float = 50.0, preload: float = 1e4) -> Free:
    """A follower whose velocity jumps to 0 at 140 degrees, and that goes on with the one it had."""
    of = design(
        "straight_moves",
        f"[effects.inertia]\nmass = 1\n[effects.spring]\nstiffness = {stiffness}\n"
        f"preload = {preload}\n[effects.lift-off]",
        ('undercut = "trim"', 'undercut = "refuse"'),
        ("speed = 20", f"speed = {speed}"),
    )
    return Free(of, speed * math.pi / 30.0, 1e-3, lambda q, v: -(preload + stiffness * q))


CASES: Final[dict[str, Callable[[], Free]]] = {
    "short": lambda: press(400.0),
    "long": lambda: press(600.0),
    "beyond a turn": lambda: press(1500.0),
    "rebounds": lambda: press(400.0, 0.4),
    "rocker": lever,
    "thrown": thrown,
    "thrown over jumps of the velocity": lambda: thrown(600.0, 0.01, 10.0),
}


@pytest.mark.parametrize("name", CASES)
def test_flights_are_those_of_a_free_follower(name: str) -> None:
    free = CASES[name]()
    result = free.of.effect("lift-off")
    flights = result.flights
    assert flights
    assert result.errors["impact-speed"].share <= 1e-6
    leaving, rate = math.radians(140.0), 0.0
    if name.startswith("thrown"):
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
        lost = 0.5 * (1.0 - restitution**2) * free.mass * closing**2
        assert each.energy == pytest.approx(lost, rel=1e-8)
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
            if not each.rebound:  # else its beginning is rough too
                assert abs(each.landing - true.landing) <= each.late
        assert max(each.error for each in rough.flights) > 1e-9
        late = math.degrees(max(each.late for each in rough.flights))
        assert [each.value for each in rough.findings if each.name == "landing-angle"] == [late]


def test_where_no_landing_can_be_given_it_says_why() -> None:
    def told(*changes: tuple[str, str]) -> str:
        found = loaded("lift_off_elastic", *changes).effects.findings("lift-off")
        return next(each.sentence for each in found if each.name == "flight")

    far = told(("speed = 600", "speed = 20000"))
    assert "no landing is computed: the flight that begins at cam angle" in far
    assert "lasts longer than 8 turns" in far
    held = loaded("lift_off_elastic", ("speed = 600", "speed = 300")).effects.findings("lift-off")
    assert "flight" not in {each.name for each in held}
    elastic = Design(load_scene(str(EFFECTS / "lift_off_elastic.toml"))).effects
    said = {each.sentence for each in elastic.findings("lift-off")}
    assert any("all of its mass is behind the elastic train" in each for each in said)
    light = design(
        "plate_translating", "[effects.load]\nconstant = -50\n[effects.lift-off]"
    ).effects.findings("lift-off")
    why = "no landing is computed: it needs [effects.inertia]"
    assert any(why in each.sentence for each in light)


# Across a clearance -------------------------------------------------------------------------------


@dataclass(frozen=True)
class Roller:
    """A roller of a rocker by its own data, in the frame of the cam."""

    of: Design
    pivot: complex
    arm: complex
    swing: int
    rotation: int

    def centre(self, phi: float, q: float) -> tuple[complex, complex, complex]:
        """Z with its derivatives by phi and q."""
        turn, along = (
            cmath.exp(-1j * self.rotation * phi),
            self.arm * cmath.exp(1j * self.swing * q),
        )
        place = (self.pivot + along) * turn
        return place, -1j * self.rotation * place, 1j * self.swing * along * turn

    def lift(self, phi: float) -> Any:
        return self.of.cam.drive.plan.jet(np.array([phi % TURN]))[:, 0]

    def distance(self, phi: float, q: float) -> tuple[float, float, float]:
        """Distance from the pitch curve, outwards positive, with its derivatives by phi and q."""
        place, by_phi, by_q = self.centre(phi, q)
        theta = phi
        for _ in range(40):  # to the foot of the perpendicular; the curve bends little
            lift, rate = self.lift(theta)[:2]
            foot, turning, along = self.centre(theta, lift)
            tangent = turning + along * rate
            step = ((place - foot) * tangent.conjugate()).real / abs(tangent) ** 2
            theta += step
            if abs(step) < 1e-15:
                break
        normal = 1j * self.rotation * tangent / abs(tangent)

        def part(vector: complex) -> float:
            return float((vector * normal.conjugate()).real)

        return part(place - foot), part(by_phi), part(by_q)


@dataclass(frozen=True)
class Held:
    """A rocker between two walls, at which one of the `gaps` is 0: (sign, roller, width) each.

    A gap is width + sign times the distance of the roller from its pitch curve. Friction in the
    pivot takes `rubbed` at a cam angle.
    """

    of: Design
    omega: float
    mass: float
    force: Callable[[float, float], float]
    gaps: dict[int, tuple[float, Roller, float]]
    rubbed: Callable[[float], float] = lambda phi: 0.0

    def gap(self, side: int, phi: float, q: float) -> tuple[float, float, float]:
        sign, roller, width = self.gaps[side]
        distance, by_phi, by_q = roller.distance(phi, q)
        return width + sign * distance, sign * by_phi, sign * by_q

    def on_wall(self, side: int, phi: float) -> tuple[float, float]:
        """q and dq/dt of a follower that touches the wall."""
        q = self.gaps[side][1].lift(phi)[0]
        for _ in range(30):
            gap, by_phi, by_q = self.gap(side, phi, q)
            q -= gap / by_q
        return q, -by_phi / by_q * self.omega

    def push(self, side: int, phi: float) -> float:
        """What the wall has to provide, in the direction in which it pushes."""
        step = 1e-5
        q, rate = self.on_wall(side, phi)
        before, after = (self.on_wall(side, phi + sign * step)[1] for sign in (-1.0, 1.0))
        needed = self.mass * (after - before) / (2.0 * step) * self.omega - self.force(q, rate)
        needed += self.rubbed(phi)
        return needed * math.copysign(1.0, self.gap(side, phi, q)[2])

    def flight(self, left: int, leaving: float, begin: list[float], about: float) -> Any:
        """Landing [rad], side, impact speed, q and dq/dt there, of a flight about so long [rad]."""

        def motion(t: float, y: Any) -> list[float]:
            taken = self.rubbed(leaving + self.omega * t)
            return [y[1], (self.force(y[0], y[1]) - taken) / self.mass]

        def stop(side: int) -> Callable[[float, Any], float]:
            def event(t: float, y: Any) -> float:
                return self.gap(side, leaving + self.omega * t, float(y[0]))[0]

            event.terminal, event.direction = True, -1  # type: ignore[attr-defined]  # as solve_ivp reads it
            return event

        soon, sides = 0.05 * about / self.omega, list(self.gaps)
        exact = {"method": "DOP853", "rtol": 1e-12, "atol": 1e-15}
        first = solve_ivp(motion, (0.0, soon), begin, **exact).y[:, -1]
        found = solve_ivp(
            motion, (soon, 30.0 * soon), first, events=[stop(side) for side in sides],
            max_step=soon, **exact,
        )  # fmt: skip
        ((side, time, (q, rate)),) = (
            (side, times[0], y[0])
            for side, times, y in zip(sides, found.t_events, found.y_events, strict=True)
            if len(times)
        )
        landing = leaving + self.omega * time
        _, by_phi, by_q = self.gap(side, landing, q)
        return landing, side, abs(by_phi * self.omega + by_q * rate), q, rate


def rollers(of: Design) -> list[Roller]:
    subject = of.effects.subject
    found = [subject] if subject.returning is None else [subject, subject.returning]
    return [
        Roller(of, each.cam.follower.pivot or 0j, each.cam.follower.start_arm,
               each.cam.follower.swing_sense, each.cam.rotation)
        for each in found
    ]  # fmt: skip


def groove(restitution: float, backlash: float = 0.05) -> Held:
    of = loaded(
        "groove_lever",
        ("backlash = 0.05", f"backlash = {backlash}\nrestitution = {restitution}"),
        ("[effects.load]", "[effects.friction]\npivot_viscous = 0.02\n\n[effects.load]"),
    )
    (roller,) = rollers(of)
    half = 0.5 * backlash
    mass = 12.0 + 0.15e-3 * 80.0**2
    gaps = {1: (1.0, roller, half), -1: (-1.0, roller, half)}
    return Held(of, 6.0 * math.pi, mass, lambda q, rate: -800.0 - 20.0 * rate, gaps)


def pair(restitution: float, backlash: float = 0.03) -> Held:
    of = loaded(
        "conjugate_lever",
        ("backlash = 0.03", f"backlash = {backlash}\nrestitution = {restitution}"),
        ("segments = [0, 1.5, 4, 0.5, 0]   # N m", "constant = 0.5"),
    )
    main, back = rollers(of)
    mass = 12.0 + 0.18e-3 * 75.0**2
    gaps = {1: (1.0, main, 0.0), -1: (1.0, back, backlash)}
    omega = 8.0 * math.pi

    def rubbed(phi: float) -> float:
        """In the pivot, mu d / 2 = 1 mm, loaded by m a of the roller."""
        _, rate, second = main.lift(phi)[:3]
        return float(np.sign(rate)) * 0.18e-3 * 75.0 * omega**2 * math.hypot(second, rate * rate)

    return Held(of, omega, mass, lambda q, rate: -500.0, gaps, rubbed)


@pytest.mark.parametrize("restitution", [0.0, 0.4])
@pytest.mark.parametrize("make", [groove, pair])
def test_flights_across_a_clearance_are_those_of_a_free_follower(
    make: Callable[[float], Held], restitution: float
) -> None:
    held = make(restitution)
    result = held.of.effect("lift-off")
    flights = result.flights
    assert len(flights) >= 4
    assert any(each.rebound for each in flights) == (restitution > 0.0)
    before = 0.0, 0.0, 0.0
    for each in flights if LONG else flights[:8]:
        if each.rebound:
            leaving, q, rate = before
            assert each.leaving == pytest.approx(leaving, abs=1e-8)
            wall = held.on_wall(each.left, leaving)
            state = [wall[0], wall[1] - restitution * (rate - wall[1])]
        else:
            # The follower leaves where the force changes its sign; a step of the wall's second
            # difference is 1e-5, and its rounding 1e-16 / 1e-5 of the lift.
            near = (each.leaving - 1e-4, each.leaving + 1e-4)
            at = brentq(lambda phi: held.push(each.left, phi), *near)  # noqa: B023 - called at once
            assert each.leaving == pytest.approx(at, abs=1e-7)
            leaving, state = each.leaving, list(held.on_wall(each.left, each.leaving))
        about = each.landing - each.leaving
        landing, side, speed, q, rate = held.flight(each.left, leaving, state, about)
        before = landing, q, rate
        assert side == each.met
        assert each.landing == pytest.approx(landing, abs=1e-8)
        assert each.speed == pytest.approx(speed, rel=1e-8)
        wall = held.on_wall(side, landing)
        loss = 0.5 * (1.0 - restitution**2) * held.mass * (rate - wall[1]) ** 2
        assert each.energy == pytest.approx(loss, rel=1e-8)
    assert result.errors["impact-speed"].share <= 1e-6


def test_flights_behind_a_linkage_obey_lagrange() -> None:
    """M q'' + (dM/dq / 2) q'^2 = sum Q, with dM/dq from differences of M over q, from the lift and
    its rate at the leaving on. The slider has viscous friction."""
    path = EFFECTS / "linked_press.toml"
    text = path.read_text("utf-8").replace("speed = 90\n", "speed = 420\n")
    for name in ("load", "vibration", "speed-fluctuation", "drive-torque", "contact-pressure"):
        text = re.sub(rf"\[effects\.{name}\]\n(?:[^\[\n].*\n)*", "", text)
    of = Design(parse_scene(text.replace("slider = 4\n", ""), str(path)))
    contact, inertia = of.effect("contact-force"), of.effect("inertia")
    state, omega = of.effects.subject.state, 14.0 * math.pi
    free = [each for each in contact.forces if each is not inertia.force]
    (flight_,) = of.effect("lift-off").flights

    def lift(phi: float) -> Any:
        return state.motion.jet(np.array([phi % TURN]))[:, 0]

    def motion(phi: float, y: Any) -> list[float]:
        here = np.full(3, phi % TURN)
        q, rate = y[0] + np.array([-1e-5, 0.0, 1e-5]), np.full(3, y[1])
        mass = inertia.mass_terms(here, q)[0]
        bend = (mass[2] - mass[0]) / 4e-5
        push = sum(each.free_force(here, q, rate)[1] for each in free) - bend * y[1] ** 2
        # in the pivot it goes with the loads that the motion of the state makes without a contact
        push -= contact.bearings.noncontact_friction(
            here, "right", np.full((2, 3), [[omega], [0.0]])
        )[1]
        return [y[1] / omega, push / mass[1] / omega]

    start = lift(flight_.leaving)
    solved = solve_ivp(
        motion, (flight_.leaving, flight_.landing), [start[0], start[1] * omega], "DOP853",
        rtol=1e-12, atol=1e-14, max_step=0.05,
    )  # fmt: skip
    q, rate = solved.y[:, -1]
    end = lift(flight_.landing)
    closing = rate - end[1] * omega
    assert abs((q - end[0]) * omega / closing) <= 1e-8
    lever = state.curve.leverage(np.array([flight_.landing % TURN]))[0]
    assert flight_.speed == pytest.approx(abs(lever * closing), rel=1e-8)
    mass = inertia.mass_terms(np.array([flight_.landing % TURN]), np.array([q]))[0, 0]
    assert flight_.energy == pytest.approx(0.5 * mass * closing**2, rel=1e-8)


# The limits of the clearance ----------------------------------------------------------------------


@pytest.mark.parametrize("name", ["groove_lever", "conjugate_lever"])
def test_without_clearance_nothing_flies_and_the_sides_change_alike(name: str) -> None:
    backlash = "backlash = 0.05" if name == "groove_lever" else "backlash = 0.03"
    some, none = loaded(name), loaded(name, (backlash, ""))
    held, still = some.effect("lift-off"), none.effect("lift-off")
    assert held.flights
    assert (still.flights, still.flight_ranges) == ((), ())
    assert dict(still.errors) == {}
    assert (still.changes, still.first) == (held.changes, held.first)
    told = {each.name for each in none.effects.findings("lift-off")}
    assert not told & {"impact-speed", "largest-impact-speed", "impact-energy", "clearance-crossed"}
    phi = np.linspace(0.0, TURN, 50)
    forces = (each.effect("contact-force").normal(phi, "right") for each in (some, none))
    np.testing.assert_array_equal(*forces)


@pytest.mark.parametrize("restitution", [0.0, 0.4])
def test_in_a_clearance_that_is_never_crossed_it_flies_as_off_one_disc(restitution: float) -> None:
    """With 8 mm between two discs it falls back on the main one, as if that were alone."""
    text = (SCENES / "conjugate_carriage.toml").read_text("utf-8")
    text = text.replace("speed = 120", "speed = 600")
    head, rest = text.split("[follower.return]")
    single = head + rest[rest.index("\n[") :]
    tables = (
        "[effects.inertia]\nmass = 4\n[effects.spring]\nstiffness = 3\npreload = 250\n"
        f"[effects.contact-force]\n[effects.lift-off]\nrestitution = {restitution}\n"
    )
    two = Design(parse_scene(f"{text}{tables}backlash = 8\n", "two"))
    one = Design(parse_scene(single + tables, "one"))
    found, alone = (each.effect("lift-off").flights for each in (two, one))
    assert found
    assert len(found) == len(alone)
    for each, other in zip(found, alone, strict=True):
        assert not each.crossed
        # Between two discs a force below 1e-9 of the largest is no pull yet.
        assert each.leaving == pytest.approx(other.leaving, abs=1e-7)
        assert each.landing == pytest.approx(other.landing, abs=1e-9)
        assert each.speed == pytest.approx(other.speed, rel=1e-8)
        assert each.gap == pytest.approx(other.gap, rel=1e-8)


@given(speed=st.floats(30.0, 500.0), load=st.floats(-6.0, 6.0), backlash=st.floats(0.005, 0.1))
@settings(max_examples=examples(3, long=60), deadline=None)
def test_a_clearance_is_crossed_where_the_force_changes_its_sign(
    speed: float, load: float, backlash: float
) -> None:
    """Inertia M h'' and load of a rocker, sampled; near the limit clearance and samples decide."""
    text = (EFFECTS / "groove_lever.toml").read_text("utf-8")
    text = text.replace("speed = 180", f"speed = {speed}").replace("= 0.05", f"= {backlash}")
    of = Design(parse_scene(text.replace("constant = 0.8", f"constant = {load}"), "groove"))
    phi = np.linspace(0.0, TURN, 4001)[:-1]
    omega, moment = speed * math.pi / 30.0, 12.0 + 0.15e-3 * 80.0**2
    pull = moment * omega**2 * of.cam.drive.plan.jet(phi)[2] + 1e3 * load
    least, most = float(np.min(pull)), float(np.max(pull))
    if min(abs(least), abs(most)) < 0.05 * max(abs(least), abs(most)):
        return
    told = {each.name for each in of.effects.findings("contact-force")}
    assert ("clearance-crossed" in told) == (least < 0.0 < most)
    assert bool(of.effect("lift-off").flight_ranges) == (least < 0.0 < most)
