"""Effect `reactions` against sums of forces and moments on the free bodies."""

from __future__ import annotations

from typing import Any, Final, cast

import numpy as np
import pytest

from camgeo.kinematics.mechanism.rollers import TranslatingRoller
from camgeo.kinematics.time_course import in_time
from tests.effects.bodies import (
    GUIDE,
    PLATE,
    ROLLER,
    ROUNDING,
    Bodies,
    along,
    cross,
    friction,
    inside,
    omega,
    pull,
    speed_of,
)
from tests.effects.scenes import course_of, design
from tests.findings import finding

ROCKER: Final = """
[effects.inertia]
moment_of_inertia = 0.012
roller_mass = 0.15
rocker_mass = 0.9
rocker_centre = [70, 30]
[effects.gravity]
angle = -75
[effects.spring]
kind = "compression"
stiffness = 6
preload = 900
anchor = [30, -60]
attachment = [60, 30]
[effects.load]
constant = 1.5
[effects.friction]
rolling = 0.2
pivot = 0.11
pivot_diameter = 22
pivot_viscous = 0.8
[effects.reactions]
"""


@pytest.mark.parametrize("rev", [30.0, 400.0])
def test_a_rocker_moves_as_all_that_acts_on_it(rev: float) -> None:
    """Forces on its masses give that of the pivot, and their moments about it leave nothing: of
    the cam, the spring, the weights, the load, the damper and the friction of the bearing.
    """
    made = design("shuttle", ROCKER, speed_of("shuttle", rev))
    bodies, speed, phi = made.effect("reactions").bodies, omega(made), inside(made)
    follower: Any = made.cam.follower
    pivot, swing, jet = follower.pivot, follower.swing_sense, made.cam.drive.motion.jet(phi)
    turn, rate = np.exp(1j * swing * jet[0]), swing * jet[1] * speed
    bent = 1j * swing * jet[2] * speed**2 - rate**2
    rocker, roller, end = (
        arm * turn for arm in (70.0 + 30.0j - pivot, follower.start_arm, 60.0 + 30.0j - pivot)
    )
    line = pivot + end - (30.0 - 60.0j)
    pressed = 900.0 - 6.0 * (np.abs(line) - abs(60.0 + 30.0j - (30.0 - 60.0j)))
    spring, cam = pressed * line / np.abs(line), bodies.of_cam(phi, "right")
    masses = 0.9e-3 * rocker + 0.15e-3 * roller
    held = bent * masses - 1.05e-3 * pull(-75.0) - spring - cam
    found = bodies.of_pivot(phi, "right")
    assert np.max(np.abs(found - held)) <= 10.0 * ROUNDING * np.max(np.abs(held))
    drag = np.sign(rate) * 0.5 * 0.11 * 22.0 * np.abs(found)
    couples = -1.5e3 * swing - 0.8e3 * rate - drag
    moments = cross(roller, cam) + cross(end, spring) + cross(masses, pull(-75.0)) + couples
    turned = (12.0 + 0.15e-3 * abs(follower.start_arm) ** 2) * swing * jet[2] * speed**2
    assert np.max(np.abs(moments - turned)) <= 1e3 * ROUNDING * np.max(np.abs(found))


@pytest.mark.parametrize("rev", [20.0, 200.0])
@pytest.mark.parametrize("way", ["ccw", "cw"])
def test_newton_in_a_guide_with_friction(way: str, rev: float) -> None:
    """Balance along the guide; across it, it is a beam on two supports under the force of the cam,
    the weight and the roller's bearing.
    """
    turned = [('"ccw"', '"cw"')] if way == "cw" else []
    table = {**GUIDE, **ROLLER, "guide_viscous": 0.0}
    text = PLATE + friction(table) + "\n[effects.reactions]"
    made = design("plate_translating", text, speed_of("plate_translating", rev), *turned)
    phi, follower = inside(made), cast(TranslatingRoller, made.cam.follower)
    reactions = made.effect("reactions")
    at = Bodies(made.cam, phi, made.effect("contact-force").normal(phi, "right"))
    out, weight = np.exp(1j * follower.guide_angle), 1.3e-3 * pull(-60.0)
    wanted, largest = at.guide_reactions(table, weight), np.max(np.abs(at.normal))
    timed = in_time(made.cam.drive.motion.jet(phi), course_of(made), phi)
    drag = table["guide"] * np.sum(np.abs(wanted), axis=0)
    drag *= np.sign(np.where(np.abs(timed[1]) > 1e-9, timed[1], 0.0))
    pressed = along(out, at.load(table) + weight) - 25.0 - (160.0 + 2.5 * timed[0]) - drag
    assert np.max(np.abs(pressed - 1.3e-3 * timed[2])) <= 10.0 * ROUNDING * largest
    off = reactions.bodies.of_cam(phi, "right") - at.load(table)
    assert np.max(np.abs(off)) <= 10.0 * ROUNDING * largest
    found = reactions.bodies.of_guide(phi, "right")
    assert np.max(np.abs(found - wanted)) <= 10.0 * ROUNDING * np.max(np.abs(wanted))
    for name, force in zip(("near", "far"), found, strict=True):
        told = finding(reactions.findings, f"largest-{name}-end-force")
        assert told.value >= np.max(np.abs(force)) * (1.0 - 1e-12)
        assert told.value == pytest.approx(np.max(np.abs(force)), rel=0.02)


MADE: Final = """
[effects.gravity]
angle = -50
[effects.inertia]
mass = 1.1
[effects.load]
constant = 60
[effects.balance]
material = "steel"
[effects.reactions]
bearings = [-35, 80]
"""


def test_bearings_of_the_camshaft_carry_the_disc_too() -> None:
    """Its centre of mass from `balance`, accelerated in a circle; moments about either bearing."""
    made = design("plate_translating", MADE, speed_of("plate_translating", 900.0))
    reactions, balance = made.effect("reactions"), made.effect("balance")
    phi = inside(made)
    turned = balance.centre * np.exp(1j * made.cam.rotation * phi)
    whole = balance.mass * (pull(-50.0) + omega(made) ** 2 * turned)
    whole = whole - reactions.bodies.of_cam(phi, "right")
    columns = {each.name: each.values(phi, "right") for each in reactions.columns}
    size = float(np.max(np.abs(whole)))
    assert np.max(np.abs(balance.mass * omega(made) ** 2 * turned)) > 0.05 * size
    bound = reactions.errors["camshaft load"].error
    assert 0.0 < bound <= 1e-6 * size
    allowed = bound + balance.unbalance_error * omega(made) ** 2 + 1e-6 * balance.mass * 9806.65
    found = columns["camshaft load"]
    assert np.max(np.abs(found - np.abs(whole))) <= allowed
    rows = np.array([[1.0, 1.0], [-35.0, 80.0]])  # sums of forces, and of moments about the disc
    shares = np.linalg.solve(rows, [1.0, 0.0])
    for name, share in zip(("first", "second"), shares, strict=True):
        assert columns[f"{name} bearing load"] == pytest.approx(abs(share) * found, rel=1e-13)
        assert reactions.errors[f"largest-{name}-bearing-load"].error <= bound


def test_a_disc_of_unknown_material_has_no_weight() -> None:
    tables = MADE.replace('[effects.balance]\nmaterial = "steel"\n', "")
    made = design("plate_translating", tables, speed_of("plate_translating", 900.0))
    reactions, phi = made.effect("reactions"), inside(made)
    (load,) = (each for each in reactions.columns if each.name == "camshaft load")
    assert np.all(load.values(phi, "right") == np.abs(reactions.bodies.of_cam(phi, "right")))
    assert not reactions.errors
