"""Power of the camshaft against that of all forces and each loss, at any cam angle.

Every loss is a reaction times the velocity with which its parts rub, and none is the rest of the
sum: the bearing of the roller and the rolling on the flank, a face on its cam, the pivot under its
whole force, both ends of a guide. By the principle of virtual work (Norton, Cam Design and
Manufacturing Handbook, chapters on dynamics) the camshaft provides the sum.
"""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Any, Final

import numpy as np
import pytest

from camgeo.design import Design
from camgeo.effects.force import at_rates, rates_of
from camgeo.effects.touching import INNER, OUTER, carrier, sliding
from camgeo.numeric.arrays import FloatArray
from camgeo.scene.load import parse_scene
from camgeo.units import TURN

FORCES: Final = ("inertia", "gravity", "load", "spring")

FIXTURES: Final = [
    path
    for path in sorted((Path(__file__).parents[2] / "fixtures" / "effects").glob("*.toml"))
    if any(f"[effects.{force}]" in path.read_text("utf-8") for force in FORCES)
]
"""All scenes of effects that have a contact force."""

REST: Final = 1e-12
"""Largest residual of the balance, as a share of the largest power at any of the angles."""

STATED: Final = ("roller_pin", "rolling", "face", "pivot", "guide")


def rubbing(made: Design, table: dict[str, Any], phi: FloatArray) -> dict[str, FloatArray]:
    """(n,) power of each Coulomb loss by its name [N mm/s]."""
    bodies: Any = made.effect("reactions").bodies
    subject, contact = bodies.subject, bodies.contact
    omega = rates_of(subject, phi, "right")[0]
    normal = contact.normal(phi, "right")
    follower, rotation = subject.cam.follower, subject.cam.rotation
    found = {name: np.zeros(len(phi)) for name in STATED}
    for sense, here in ((INNER, normal >= 0.0), (OUTER, normal < 0.0)):
        if not np.any(here):
            continue
        disc, flank = carrier(subject, sense)
        relative = disc.state.curve.relative_jet(phi[here], "right", order=1)
        pace = np.hypot(relative.along[1], relative.across[1])
        force = np.abs(normal[here]) * omega[here]
        if disc.cam.follower.roller_radius > 0.0:
            on_cam = -flank * rotation * pace / disc.cam.follower.roller_radius
            on_pin = rotation + on_cam - relative.turning
            radius = 0.5 * table.get("roller_pin_diameter", 0.0)
            found["roller_pin"][here] = (
                table.get("roller_pin", 0.0) * radius * force * np.abs(on_pin)
            )
            found["rolling"][here] = table.get("rolling", 0.0) * force * np.abs(on_cam)
        if table.get("face", 0.0):
            slip = sliding(disc, phi[here], "right")
            found["face"][here] = table["face"] * force * np.abs(slip)
    speed = np.abs(subject.state.motion.jet(phi, "right", 1)[1]) * omega
    if follower.pivot is not None:
        # before a linkage the pivot rubs under the contact force alone, see `Loads.on_bearings`
        before_linkage = subject.drive.linkage is not None
        load = bodies.of_cam if before_linkage else bodies.of_pivot
        lever = 0.5 * table.get("pivot", 0.0) * table.get("pivot_diameter", 0.0)
        found["pivot"] = lever * np.abs(load(phi, "right")) * speed
    else:
        ends = np.abs(bodies.of_guide(phi, "right"))
        found["guide"] = table.get("guide", 0.0) * np.sum(ends, axis=0) * speed
    return found


def powers(made: Design, table: dict[str, Any], phi: FloatArray) -> tuple[Any, dict[str, Any]]:
    """(n,) power of the camshaft, and what each force and each loss takes of it [N mm/s]."""
    result: Any = made.effect("drive-torque")
    subject: Any = made.effect("reactions").bodies.subject
    rates = rates_of(subject, phi, "right")
    rate = subject.state.motion.jet(phi, "right", 1)[1] * rates[0]
    taken = {
        each.name: -at_rates(each.coefficients(phi, "right"), rates) * rate
        for each in result.contact.forces
    }
    return result.torque(phi, "right") * rates[0], {**taken, **rubbing(made, table, phi)}


def assert_balanced(made: Design, table: dict[str, Any], phi: FloatArray) -> dict[str, Any]:
    """The parts of the power, of which the losses are never negative."""
    given, taken = powers(made, table, phi)
    assert all(np.all(taken[name] >= 0.0) for name in STATED)
    largest = max(float(np.max(np.abs(each))) for each in (given, *taken.values()))
    assert np.max(np.abs(given - sum(taken.values()))) <= REST * largest
    return taken


def scene_with(text: str, *effects: str) -> str:
    """The scene with these effects, as empty tables where it does not have them."""
    named = tomllib.loads(text).get("effects", {})
    return text + "".join(f"\n[effects.{each}]\n" for each in effects if each not in named)


@pytest.mark.parametrize("path", FIXTURES, ids=lambda each: each.stem)
def test_the_power_of_the_camshaft_is_that_of_all_forces_and_losses(path: Path) -> None:
    text = scene_with(path.read_text("utf-8"), "contact-force", "drive-torque", "reactions")
    phi = np.random.default_rng(7).uniform(0.0, TURN, 500)
    made = Design(parse_scene(text, str(path)))
    table = tomllib.loads(text)["effects"].get("friction", {})
    taken = assert_balanced(made, table, phi)
    for name in STATED:
        assert np.any(taken[name] > 0.0) == bool(table.get(name, 0.0)), name
