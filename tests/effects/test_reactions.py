"""Effect `reactions` against sums of forces and moments on the free bodies."""

from __future__ import annotations

import itertools
from typing import Any, Final

import numpy as np
import pytest

from camgeo.design.design import Design
from camgeo.kinematics.mechanism.translating_roller import TranslatingRoller
from camgeo.numeric.arrays import ComplexArray, FloatArray
from camgeo.scene.scene import load_scene
from tests.effects.scenes import SCENES, assert_refused, design
from tests.effects.test_physics import (
    DIFFERENCE,
    GUIDE,
    PLATE,
    ROLLER,
    ROUNDING,
    Bodies,
    along,
    friction,
    inside,
    omega,
    pull,
    speed_of,
)
from tests.integrals import integrals

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


def cells_of(edges: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Eighths of the smooth pieces, low and high ends."""
    cuts = [np.linspace(low, high, 9) for low, high in itertools.pairwise(edges)]
    low = np.concatenate([each[:-1] for each in cuts])
    return low, np.concatenate([each[1:] for each in cuts])


def cross(a: Any, b: Any) -> Any:
    return np.imag(np.conj(a) * b)


@pytest.mark.parametrize("rev", [30.0, 400.0])
def test_momenta_of_a_rocker_change_by_all_that_acts_on_it(rev: float) -> None:
    """Over every cell: momentum by the forces, and angular momentum about the cam axis, where no
    reaction drops out, by their moments and the couples of load, bearing and damper.
    """
    made = design("shuttle", ROCKER, speed_of("shuttle", rev))
    bodies, speed = made.effect("reactions").bodies, omega(made)
    contact, motion = bodies.contact, made.cam.drive.motion
    follower: Any = made.cam.follower
    pivot, swing = follower.pivot, follower.swing_sense
    rocker, roller = bodies.loads.inertia.masses
    assert (rocker.name, roller.name) == ("rocker", "roller")

    def places(phi: FloatArray, side: Any) -> tuple[ComplexArray, ComplexArray, ComplexArray]:
        """Of the rocker's centre of mass, the roller and the end of the spring."""
        swung = swing * motion.jet(phi, side)[0]
        return tuple(
            pivot + (each - pivot) * np.exp(1j * swung)
            for each in (70.0 + 30.0j, pivot + follower.start_arm, 60.0 + 30.0j)
        )

    def acting(phi: FloatArray) -> Any:
        """Forces on the rocker with their places."""
        own, centre, end = places(phi, "right")
        line = end - (30.0 - 60.0j)
        force = 900.0 - 6.0 * (np.abs(line) - abs(60.0 + 30.0j - (30.0 - 60.0j)))
        return (
            (bodies.of_cam(phi, "right"), centre),
            (force * line / np.abs(line), end),
            (0.9e-3 * pull(-75.0), own),
            (0.15e-3 * pull(-75.0), centre),
            (bodies.of_pivot(phi, "right"), pivot),
        )

    def total(phi: FloatArray) -> Any:
        return np.asarray(sum(force for force, _ in acting(phi)) / speed + 0j)

    def moment(phi: FloatArray) -> FloatArray:
        rate = swing * motion.jet(phi, "right")[1] * speed
        couples = -1.5e3 * swing - 0.8e3 * rate
        drag = 0.5 * 0.11 * 22.0 * np.abs(bodies.of_pivot(phi, "right"))
        couples = couples - np.sign(rate) * drag
        found = sum(cross(place, force) for force, place in acting(phi)) + couples
        return np.asarray(found / speed)

    def momenta(phi: FloatArray, side: Any) -> tuple[ComplexArray, FloatArray]:
        rate = swing * motion.jet(phi, side)[1] * speed
        own, centre, _ = places(phi, side)
        linear = np.zeros(len(phi), dtype=np.complex128)
        angular = np.asarray((12.0 - 0.9e-3 * np.abs(own - pivot) ** 2) * rate)
        for mass, place in ((0.9e-3, own), (0.15e-3, centre)):
            velocity = 1j * rate * (place - pivot)
            linear = linear + mass * velocity
            angular = angular + mass * cross(place, velocity)
        return linear, angular

    low, high = cells_of(contact.edges)
    before, after = momenta(low, "right"), momenta(high, "left")
    force = np.max(np.abs(bodies.of_pivot(low, "right"))) / speed
    assert force * speed > 500.0
    assert np.max(np.abs(integrals(total, low, high) - (after[0] - before[0]))) <= ROUNDING * force
    gained = integrals(moment, low, high) - (after[1] - before[1])
    assert np.max(np.abs(gained)) <= ROUNDING * force * 200.0


@pytest.mark.parametrize("scene", ["plate_translating", "shuttle"])
def test_the_cam_presses_as_the_roller_s_balance_says(scene: str) -> None:
    """Against the forces of the independent bodies, whose normals are differences."""
    forces = PLATE if scene == "plate_translating" else ROCKER.replace("[effects.reactions]", "")
    table = ROLLER if scene == "plate_translating" else {"rolling": 0.2}
    more = friction(ROLLER) if scene == "plate_translating" else ""
    made = design(scene, f"{forces}{more}\n[effects.reactions]", speed_of(scene, 90.0))
    phi = inside(made)
    reactions = made.effect("reactions")
    normal = made.effect("contact-force").normal(phi, "right")
    wanted = Bodies(made.cam, phi, normal).load({"roller_pin": 0.0, "roller_pin_diameter": 0.0}
                                                | table)  # fmt: skip
    found = reactions.bodies.of_cam(phi, "right")
    assert np.max(np.abs(found - wanted)) <= DIFFERENCE * np.max(np.abs(wanted))


@pytest.mark.parametrize("way", ["ccw", "cw"])
def test_ends_of_a_guide_carry_the_side_force_and_the_weight(way: str) -> None:
    """A beam on two supports under the force of the cam, the weight and the roller's bearing."""
    turned = [('"ccw"', '"cw"')] if way == "cw" else []
    table = {**GUIDE, **ROLLER}
    text = PLATE + friction(table) + "\n[effects.reactions]"
    made = design("plate_translating", text, speed_of("plate_translating", 150.0), *turned)
    phi = inside(made)
    reactions, follower = made.effect("reactions"), made.cam.follower
    assert isinstance(follower, TranslatingRoller)
    out = np.exp(1j * follower.guide_angle)
    bodies = Bodies(made.cam, phi, made.effect("contact-force").normal(phi, "right"))
    load = along(-1j * out, bodies.load(table) + 1.3e-3 * pull(-60.0))
    near = along(out, bodies.centre(np.zeros(1)))[0] + table["guide_overhang"]
    height, pin = along(out, bodies.centre(phi)), -bodies.moments(table)[0]
    rows = np.array([[1.0, 1.0], [-near, -near - table["guide_length"]]])
    wanted = np.linalg.solve(rows, np.stack((-load, height * load - pin)))
    found = reactions.bodies.of_guide(phi, "right")
    assert np.max(np.abs(found - wanted)) <= DIFFERENCE * np.max(np.abs(wanted))
    for name, force in zip(("near", "far"), found, strict=True):
        (told,) = (each for each in reactions.findings if each.name == f"largest-{name}-end-force")
        assert told.value >= np.max(np.abs(force)) * (1.0 - 1e-12)
        assert told.value == pytest.approx(np.max(np.abs(force)), rel=0.02)


def test_friction_of_a_pivot_under_its_whole_load() -> None:
    """Of the lever, whose drive does nothing else over a turn."""
    path = SCENES.parent / "effects" / "lever.toml"
    rigid: dict[str, object] = {"effects.reactions": {}, "effects.vibration": None}
    made = Design(load_scene(path).with_values(rigid))
    (work,) = (
        each for each in made.effect("reactions").findings if each.name == "pivot-friction-work"
    )
    (taken,) = (
        each for each in made.effect("drive-torque").findings if each.name == "work-per-turn"
    )
    assert work.value == pytest.approx(taken.value, rel=1e-12)
    assert 1e3 * work.value == pytest.approx(84.1717, abs=5e-5)


def test_a_guide_without_ends_has_one_force() -> None:
    made = design("plate_translating", PLATE + "[effects.reactions]")
    result = made.effect("reactions")
    names = {each.name for each in result.findings}
    assert {"largest-guide-force", "largest-camshaft-load"} <= names
    phi = inside(made)
    assert np.all(result.bodies.of_guide(phi, "right")[1] == 0.0)
    shaft = np.abs(made.effect("contact-force").normal(phi, "right"))
    assert np.abs(result.bodies.of_cam(phi, "right")) == pytest.approx(shaft, rel=1e-13)


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


def test_both_bearings_at_one_place_are_refused() -> None:
    assert_refused(
        "plate_translating", "reactions", "bearings = [12, 12]", "bearings", "two places"
    )
    assert_refused("conjugate_lever", "reactions", "bearings = [0, 12]", "bearings", "single disc")
