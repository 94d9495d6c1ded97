"""What flights obey whatever the scene: energy, impulse, and the limits of the clearance.

The energies and impulses are those of the follower's own data at both ends of a flight, so that
nothing is integrated here.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from camgeo.design.design import Design
from camgeo.dynamics.effects.lift_off.flight import Flight
from camgeo.scene.scene import parse_scene
from camgeo.units import TURN
from tests.effects.scenes import SCENES
from tests.effects.test_flight import EFFECTS, GRAVITY, Free, loaded, press
from tests.long_form import examples

ROUNDING = 1e-13
"""Of a sum of some ten terms, relative to their sizes."""

MASS = 1.5e-3


def ends(free: Free, flights: tuple[Flight, ...], restitution: float) -> Any:
    """Angle, lift, velocity and acceleration of the cam at both ends of each flight, the velocity
    that of the follower, and with the second what the told errors make of it.
    """

    def closing_of(each: Flight) -> float:
        return -each.speed / free.lever(each.landing)

    for each in flights:
        rate = 0.0
        if each.rebound:  # from the landing at its leaving, perhaps turns before
            gone = [abs((other.landing - each.leaving + 1.0) % TURN - 1.0) for other in flights]
            assert min(gone) <= 1e-12
            rate = -restitution * closing_of(flights[gone.index(min(gone))])
        start = free.lift(each.leaving), free.omega * free.lift(each.leaving, 1) + rate
        closing = closing_of(each)
        pace = free.omega * free.lift(each.landing, 1)
        bend = free.omega * free.lift(each.landing, 2)
        off = each.error * abs(closing) + abs(bend) * each.late
        yield each, start, (free.lift(each.landing), pace + closing), (off, closing, pace)


@given(speed=st.floats(400.0, 900.0), restitution=st.sampled_from([0.0, 0.35, 0.8, 1.0]))
@settings(max_examples=examples(2, long=60), deadline=None)
def test_a_flight_keeps_its_energy_and_an_impact_loses_its_share(
    speed: float, restitution: float
) -> None:
    free = press(speed, restitution)
    weight = MASS * GRAVITY * free.of.cam.follower.way.imag
    flights = free.of.effect("lift-off").flights
    assert flights

    def stored(q: float, v: float) -> float:
        return 0.5 * MASS * v * v + (60.0 + q + weight) * q

    for each, start, end, (off, closing, pace) in ends(free, flights, restitution):
        before, after = stored(*start), stored(*end)
        push = abs(free.force(*end))
        told = MASS * abs(end[1]) * off + push * abs(pace) / free.omega * each.late
        assert abs(after - before) <= told + ROUNDING * (before + after), each
        lost = 0.5 * (1.0 - restitution**2) * MASS * closing**2
        assert each.energy == pytest.approx(lost, rel=1e-12)
    if restitution == 1.0:
        assert all(each.energy == 0.0 for each in flights)


@given(speed=st.floats(420.0, 900.0), viscous=st.floats(1e-3, 3e-2))
@settings(max_examples=examples(2, long=60), deadline=None)
def test_the_impulses_over_a_flight_add_up(speed: float, viscous: float) -> None:
    """With a constant load and viscous friction m dv + c dq + F dt = 0."""
    load = "[effects.spring]\nstiffness = 2\npreload = 60"
    of = loaded(
        "lift_off_elastic",
        ("speed = 600", f"speed = {speed}"),
        (load, f"[effects.load]\nconstant = 65\n[effects.friction]\nguide_viscous = {viscous}"),
    )
    free = Free(of, speed * math.pi / 30.0, MASS, lambda q, v: -65.0 - viscous * v)
    flights = of.effect("lift-off").flights
    assert flights
    for each, start, end, (off, _, pace) in ends(free, flights, 0.0):
        time = (each.landing - each.leaving) / free.omega
        parts = MASS * (end[1] - start[1]), viscous * (end[0] - start[0]), 65.0 * time
        told = MASS * off + (viscous * abs(pace) + 65.0) / free.omega * each.late
        sizes = MASS * (abs(end[1]) + abs(start[1])) + viscous * (end[0] + start[0]) + parts[2]
        assert abs(sum(parts)) <= told + ROUNDING * sizes


@pytest.mark.parametrize("name", ["groove_lever", "conjugate_lever"])
def test_without_clearance_nothing_flies_and_the_sides_change_alike(name: str) -> None:
    backlash = "backlash = 0.05" if name == "groove_lever" else "backlash = 0.03"
    some, none = loaded(name), loaded(name, (backlash, ""))
    held, still = some.effect("lift-off"), none.effect("lift-off")
    assert held.flights
    assert still.flights == ()
    assert still.flown == ()
    assert dict(still.errors) == {}
    assert still.changes == held.changes
    assert still.first == held.first
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
    assert bool(of.effect("lift-off").flown) == (least < 0.0 < most)
