"""Effects together, compared with an independent formulation of the mechanics.

Energies come from places and lengths alone, and their rates from differences; losses from the
velocities of bodies in the fixed frame; forces from Newton's law, with the guide's reactions those
of a beam on two supports.
"""

from __future__ import annotations

from typing import Any, Final

import numpy as np
import pytest

from camgeo.design.design import Design
from camgeo.kinematics.mechanism.rollers import TranslatingRoller
from camgeo.numeric.arrays import FloatArray
from camgeo.units import TURN
from tests.effects.bodies import (
    DIFFERENCE,
    GUIDE,
    PIVOT,
    PLATE,
    ROLLER,
    ROUNDING,
    Bodies,
    along,
    friction,
    inside,
    lift,
    omega,
    pull,
    slope,
    speed_of,
)
from tests.effects.scenes import design
from tests.integrals import cells, integrals

ROCKER: Final = """
[effects.inertia]
moment_of_inertia = 0.012
roller_mass = 0.15
rocker_mass = 0.9
rocker_centre = [70, 30]
[effects.gravity]
angle = -75
[effects.spring]
kind = "torsion"
torsional_stiffness = 40
preload_torque = 30
[effects.load]
constant = 1.5
"""

LINKED: Final = """
[effects.inertia]
mass = 1.2
moment_of_inertia = 0.004
roller_mass = 0.06
coupler_mass = 0.3
coupler_centre = 0.4
[effects.gravity]
angle = -110
[effects.spring]
stiffness = 3
preload = 480
[effects.load]
constant = 15
"""

TELLING: Final = """
[effects.contact-force]
[effects.lift-off]
[effects.drive-torque]
"""

CASES: Final[dict[str, tuple[str, dict[str, float]]]] = {
    "plate_translating": (PLATE, {**ROLLER, **GUIDE}),
    "shuttle": (ROCKER, {**ROLLER, **PIVOT}),
}


def on_bearings(made: Design, phi: FloatArray) -> Any:
    """What loads pivot or guide besides the contact: weights, on a rocker d'Alembert's forces."""
    follower: Any = made.cam.follower
    if isinstance(follower, TranslatingRoller):
        return 1.3e-3 * pull(-60.0)
    swing, jet = follower.swing_sense, made.cam.drive.motion.jet(phi)
    bent = (1j * swing * jet[2] - jet[1] ** 2) * omega(made) ** 2 * np.exp(1j * swing * jet[0])
    rocker = 70.0 + 30.0j - follower.pivot
    return sum(
        mass * (pull(-75.0) - bent * arm)
        for mass, arm in ((0.15e-3, follower.start_arm), (0.9e-3, rocker))
    )


def energy(made: Design, phi: FloatArray) -> FloatArray:
    """Of masses, weights and spring [N mm]; rates of the masses are differences."""
    follower: Any = made.cam.follower
    rate = omega(made) * slope(lambda x: lift(made, x), phi)
    centre = Bodies(made.cam, phi, np.ones(len(phi))).centre(phi)
    (column,) = made.effect("spring").columns
    force = column.values(phi, "right")
    if isinstance(follower, TranslatingRoller):
        weights = 1.3e-3 * along(pull(-60.0), centre)
        return np.asarray(0.5 * 1.3e-3 * rate**2 - weights + force**2 / (2.0 * 2.5))
    turned = (70.0 + 30.0j - follower.pivot) * np.exp(1j * follower.swing_sense * lift(made, phi))
    weights = along(pull(-75.0), 0.15e-3 * centre + 0.9e-3 * turned)
    moment = 0.012e3 + 0.15e-3 * follower.arm**2
    return np.asarray(0.5 * moment * rate**2 - weights + 1e3 * force**2 / (2.0 * 40.0))


@pytest.mark.parametrize("rev", [7.0, 150.0])
@pytest.mark.parametrize(("scene", "load"), [("plate_translating", 25.0), ("shuttle", 1.5e3)])
def test_power_of_the_drive_goes_into_energies_the_load_and_losses(
    scene: str, load: float, rev: float
) -> None:
    """T omega = dE/dt + dV/dt + load + losses at every angle, all frictions at work."""
    forces, table = CASES[scene]
    made = design(scene, forces + friction(table) + TELLING, speed_of(scene, rev))
    phi = inside(made)
    at = Bodies(made.cam, phi, made.effect("contact-force").normal(phi, "right"))
    torque = made.effect("drive-torque").torque(phi, "right")
    rate = slope(lambda x: lift(made, x), phi)
    viscous = table.get("guide_viscous", 1e3 * table.get("pivot_viscous", 0.0))
    losses = at.losses(table, on_bearings(made, phi)) + viscous * omega(made) * rate**2
    assert np.all(losses >= 0.0)
    # A difference is as exact as what it is taken of: the energies, not their change alone.
    scale = np.max(np.abs(torque)) + np.ptp(energy(made, phi))
    stored = slope(lambda x: energy(made, x), phi)
    assert np.max(np.abs(torque - (stored + load * rate + losses))) <= DIFFERENCE * scale
    assert np.max(losses) > 0.01 * np.max(np.abs(torque))


@pytest.mark.parametrize("scene", ["plate_translating", "shuttle", "setzhub", "points", "ring"])
def test_conservative_torque_does_no_work_over_a_turn(scene: str) -> None:
    """Masses, weights and springs give back all that they take; with a speed curve as well."""
    forces = {"shuttle": ROCKER, "setzhub": LINKED}.get(scene, PLATE)
    changes = [speed_of(scene, 90.0)] if scene != "points" else []
    made = design(scene, forces + TELLING, *changes)
    drive = made.effect("drive-torque")
    low, high = cells(made.drive.smooth_angles[:-1], 16)
    work = np.sum(integrals(lambda phi: drive.torque(phi, "right"), low, high))
    peak = np.max(np.abs(drive.torque(np.linspace(0.0, TURN, 2001), "right")))
    assert peak > 0.0
    assert abs(work) <= ROUNDING * peak


MIRRORS: Final[dict[str, list[tuple[str, str]]]] = {
    "plate_translating": [('"ccw"', '"cw"'), ("offset = 12", "offset = -12")],
    "ring": [('rotation = "ccw"', 'rotation = "cw"'), ("guide_angle = 0", "guide_angle = 180")],
    "shuttle": [('"cw"', '"ccw"'), ("pivot = [110, 0]", 'pivot = [-110, 0]\narm_side = "cw"')],
    "groove": [
        ('rotation = "cw"', 'rotation = "ccw"'),
        ("pivot = [-96, -72]", "pivot = [96, -72]"),
        ('arm_side = "ccw"', 'arm_side = "cw"'),
        ("depth = 3.3 }", "depth = 3.3, angle = 180 }"),
    ],
}


@pytest.mark.parametrize("scene", MIRRORS)
def test_a_scene_and_its_mirror_image_have_the_same_forces(scene: str) -> None:
    """All columns of all effects, mirrored in the y axis, weights and centres too."""
    rocks = scene in ("shuttle", "groove")
    forces, table = (ROCKER, PIVOT) if rocks else (PLATE, GUIDE)
    effects = (
        f"{forces}{friction({**ROLLER, **table})}{TELLING}"
        "[effects.contact-pressure]\nwidth = 5\n[effects.kinematics]\n[effects.balance]\n"
        "[effects.vibration]\nnatural_frequency = 47\ndamping = 0.07\n"
    )
    mirrored = (
        effects.replace("angle = -60", "angle = -120")
        .replace("angle = -75", "angle = -105")
        .replace("rocker_centre = [70, 30]", "rocker_centre = [-70, 30]")
    )
    speed = [("[follower]\n", "speed = 90\n[follower]\n")] if scene == "ring" else []
    one = design(scene, effects, *speed)
    other = design(scene, mirrored, *speed, *MIRRORS[scene])
    phi = np.linspace(0.0, TURN, 333, endpoint=False) + 0.003
    pairs = list(zip(one.disc.columns(), other.disc.columns(), strict=True))
    assert len(pairs) >= 15
    for here, there in pairs:
        assert here.name == there.name
        first, second = here.values(phi, "right"), there.values(phi, "right")
        if here.name == "unbalance force x":
            second = -second
        scale = np.max(np.abs(first))
        # The outline is integrated to 1e-9 of what the disc weighs; all else is rounded.
        near = 1e-6 if here.name.startswith("unbalance") else 1e3 * ROUNDING
        assert np.max(np.abs(first - second)) <= near * scale, here.name
