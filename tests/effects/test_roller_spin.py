"""Effect `roller-spin` against the roller as a free body of its own."""

from __future__ import annotations

from typing import Any, Final

import numpy as np
import pytest

from camgeo.design.design import Design
from camgeo.scene.scene import load_scene
from camgeo.units import RPM
from tests.effects.bodies import (
    DIFFERENCE,
    PLATE,
    ROLLER,
    Bodies,
    cross,
    friction,
    inside,
    omega,
    slope,
    speed_of,
)
from tests.effects.scenes import SCENES, design

INERTIA: Final = 3e-2
"""[t mm^2]"""


def rolling(scene: str, rev: float, traction: float = 0.05, *changes: tuple[str, str]) -> Design:
    table = f"\n[effects.roller-spin]\nmoment_of_inertia = {1e-3 * INERTIA!r}\n"
    forces = "[effects.load]\nconstant = 40\n[effects.inertia]\nmoment_of_inertia = 0.01\n"
    forces = PLATE if scene == "plate_translating" else forces
    text = f"{forces}{friction(ROLLER)}{table}traction = {traction!r}"
    return design(scene, text, speed_of(scene, rev), *changes)


@pytest.mark.parametrize("scene", ["plate_translating", "shuttle"])
def test_it_rolls_on_its_flank(scene: str) -> None:
    """No slip at the contact, by velocities in the fixed frame."""
    made = rolling(scene, 90.0)
    phi = inside(made)
    bodies = Bodies(made.cam, phi, made.effect("contact-force").normal(phi, "right"))
    wanted = (bodies.roller, bodies.roller - bodies.turning)
    found = made.effect("roller-spin").rolling.spin(phi, "right")
    for own, other in zip(found, wanted, strict=False):
        assert np.max(np.abs(own / omega(made) - other)) <= DIFFERENCE * np.max(np.abs(other))
    (column,) = (each for each in made.effect("roller-spin").columns if each.name == "roller spin")
    assert column.values(phi, "right") == pytest.approx(found[1] / RPM)


@pytest.mark.parametrize("way", ["ccw", "cw"])
def test_its_angular_momentum_changes_by_friction_and_traction(way: str) -> None:
    """The force of the cam acts at the contact, along the tangent there."""
    turned = [('"ccw"', '"cw"')] if way == "cw" else []
    made = rolling("plate_translating", 200.0, 0.05, *turned)
    phi, roller = inside(made), made.effect("roller-spin").rolling
    at = Bodies(made.cam, phi, made.effect("contact-force").normal(phi, "right"))
    ahead = -made.cam.rotation * 1j * at.outward  # as the contact moves along the flank
    moment = cross(at.arm, roller.traction(phi, "right") * ahead) + sum(at.moments(ROLLER))
    gain = omega(made) * slope(lambda x: roller.spin(x, "right")[0], phi)
    assert np.max(np.abs(INERTIA * gain - moment)) <= 1e3 * DIFFERENCE * np.max(np.abs(moment))


def test_it_skids_where_the_traction_does_not_suffice() -> None:
    loose = rolling("plate_translating", 200.0, 1.0)
    roller, contact = loose.effect("roller-spin").rolling, loose.effect("contact-force")
    phi = np.linspace(0.0, contact.edges[-1], 20001)
    share = np.abs(roller.traction(phi, "right") / contact.normal(phi, "right"))
    needed = float(np.max(share))

    def told(traction: float) -> Any:
        found = rolling("plate_translating", 200.0, traction).effect("roller-spin").findings
        return next(each for each in found if each.name == "traction-reserve")

    assert told(1.01 * needed).severity == "ok"
    assert told(1.01 * needed).value > 0.0
    skids = told(0.99 * needed)
    assert skids.severity == "warning"
    assert "too little" in skids.sentence
    assert skids.value < 0.0


def test_in_a_groove_it_reverses_at_each_change_of_flanks() -> None:
    path = SCENES.parent / "effects" / "groove_lever.toml"
    table = {"moment_of_inertia": 4e-9, "traction": 0.06}
    made = Design(load_scene(path).with_values({"effects.roller-spin": table}))
    found = {each.name: each for each in made.effect("roller-spin").findings}
    changes = [each for each in made.effects.findings("lift-off") if each.name == "flank-change"]
    assert found["roller-reversal"].value == len(changes) == 4
    assert found["roller-reversal"].cam_angle == pytest.approx(changes[0].cam_angle)
    assert found["largest-roller-spin"].value > 0.0 > found["smallest-roller-spin"].value
