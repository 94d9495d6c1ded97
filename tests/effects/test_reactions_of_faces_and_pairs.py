"""Effect `reactions` of flat faces and conjugate pairs, against Newton's law for the free follower.

The contact and its normal are found here: of a face where its velocity and that of the cam agree
across it, of a roller across the way of its centre in the turning cam.
"""

from __future__ import annotations

from typing import Any, Final

import numpy as np
import pytest

from camgeo.design.design import Design
from camgeo.numeric.arrays import ComplexArray, FloatArray
from tests.effects.bodies import along, cross, pull
from tests.effects.scenes import design
from tests.effects.test_pins import Members, angles

ROUNDING: Final = 1e-12
"""Of the largest force of the turn."""

MASS: Final = 0.4e-3
MOMENT: Final = 9.0
CENTRE: Final = complex(-20.0, 35.0)
FACE: Final = 0.09

TABLES: Final = """
[effects.inertia]
OWN
[effects.gravity]
angle = -70
[effects.load]
constant = LOAD
[effects.reactions]
[effects.friction]
"""

GUIDE: Final = {"guide_length": 60.0, "guide_overhang": 22.0, "guide_offset": 3.0}

ROCKER: Final = (
    f"moment_of_inertia = {1e-3 * MOMENT}\nrocker_mass = {1e3 * MASS}\n"
    f"rocker_centre = [{CENTRE.real}, {CENTRE.imag}]"
)


def made_of(scene: str, own: str, load: float, more: str, *changes: tuple[str, str]) -> Design:
    return design(scene, TABLES.replace("OWN", own).replace("LOAD", repr(load)) + more, *changes)


def touch(at: Members, normal: ComplexArray, height: FloatArray, turning: FloatArray) -> Any:
    """The contact of a face at `height` over the cam axis, and the way of its friction.

    The face turns about the pivot at `turning`, or moves along its guide; `normal` is outward.
    """
    follower, sigma = at.follower, at.made.cam.rotation
    course = at.made.drive.time_course
    assert course is not None
    omega = course.rates(at.phi)[0]
    right = -1j * normal
    if follower.pivot is None:
        lift = at.jet(at.made.cam.drive.motion)
        velocity = follower.way * lift[1]
        place = along(normal, velocity) / along(normal, 1j * sigma * omega * right)
        point = height * normal + place * right
    else:
        # (i sigma omega - i turning) (h n + x r) + i turning p has no part along n.
        rest = along(normal, 1j * turning * follower.pivot)
        place = -rest / along(normal, 1j * (sigma * omega - turning) * right)
        point = height * normal + place * right
        velocity = 1j * turning * (point - follower.pivot)
    dragged = along(right, 1j * sigma * omega * point - velocity)
    return point, np.sign(dragged) * right, place


@pytest.mark.parametrize("way", ["ccw", "cw"])
@pytest.mark.parametrize("stated", [True, False])
def test_a_face_tilts_its_guide(way: str, stated: bool) -> None:
    turned = [('"ccw"', '"cw"')] if way == "cw" else []
    table = {"face": FACE, **(GUIDE if stated else {})}
    text = "\n".join(f"{key} = {each}" for key, each in table.items())
    made = made_of("tappet", f"mass = {1e3 * MASS}", 90.0, text, *turned)
    phi, follower = angles(made), made.cam.follower
    at = Members(made, phi)
    lift = at.jet(made.cam.drive.motion)
    out = follower.way
    normal = np.full(len(phi), out)
    height = follower.base_radius + lift[0]
    point, drag, place = touch(at, normal, height, np.zeros(len(phi)))
    bodies = made.effect("reactions").bodies
    pressed = made.effect("contact-force").normal(phi, "right")
    on_face = pressed * normal + FACE * np.abs(pressed) * drag
    size = float(np.max(np.abs(pressed)))
    assert np.max(np.abs(bodies.of_cam(phi, "right") - on_face)) <= ROUNDING * size
    weight = MASS * pull(-70.0)
    side = along(-1j * out, on_face + weight)
    if not stated:
        assert np.max(np.abs(bodies.of_guide(phi, "right")[0] + side)) <= ROUNDING * size
        told = {each.name: each.values for each in made.effect("reactions").columns}
        moment = 1e3 * told["guide moment"](phi, "right")
        assert np.max(np.abs(moment - pressed * place)) <= 100.0 * ROUNDING * size
        return
    near = follower.base_radius + GUIDE["guide_overhang"]
    rows = np.array([[1.0, 1.0], [-near, -near - GUIDE["guide_length"]]])
    axis = -1j * out * GUIDE["guide_offset"]
    # Moments about the foot of the guide's axis; the weight acts on it.
    moment = cross(point - axis, on_face) - height * along(-1j * out, weight)
    wanted = np.linalg.solve(rows, np.stack((-side, -moment)))
    found = bodies.of_guide(phi, "right")
    assert np.max(np.abs(wanted)) > 0.1 * size
    assert np.max(np.abs(found - wanted)) <= 10.0 * ROUNDING * size
    gain = along(out, on_face + weight) - 90.0 - MASS * lift[2]
    assert np.max(np.abs(gain)) <= 10.0 * ROUNDING * size


def test_a_swinging_face_loads_its_pivot() -> None:
    changes = ('rotation = "cw"\n', 'rotation = "cw"\nspeed = 500\n')
    made = made_of("flat_rocker", ROCKER, 2.5, f"face = {FACE}", changes)
    phi, at = angles(made), Members(made, angles(made))
    follower = at.follower
    own = follower.swing_sense * at.jet(made.cam.drive.motion)
    start: Any = follower
    normal = start.normal(np.zeros(1))[0] * np.exp(1j * own[0])
    foot = follower.start_arm * np.exp(1j * own[0])
    point, drag, _ = touch(at, normal, along(normal, foot + follower.pivot), own[1])
    pressed = made.effect("contact-force").normal(phi, "right")
    on_face = pressed * normal + FACE * np.abs(pressed) * drag
    arm = at.turned(CENTRE - follower.pivot, own)
    size = float(np.max(np.abs(pressed)))
    bodies = made.effect("reactions").bodies
    wanted = MASS * (arm[2] - pull(-70.0)) - on_face
    assert np.max(np.abs(bodies.of_pivot(phi, "right") - wanted)) <= 10.0 * ROUNDING * size
    moments = cross(point - follower.pivot, on_face) + cross(arm[0], MASS * pull(-70.0))
    gain = moments - follower.swing_sense * 2.5e3 - MOMENT * own[2]
    assert np.max(np.abs(gain)) <= 1e3 * ROUNDING * size


@pytest.mark.parametrize("scene", ["conjugate_lever", "conjugate_carriage"])
def test_the_disc_of_a_pair_that_carries_loads_pivot_or_guide(scene: str) -> None:
    rocks = scene == "conjugate_lever"
    own = f"{ROCKER if rocks else f'mass = {1e3 * MASS}'}\nroller_mass = 0.2"
    speed = (f"speed = {240 if rocks else 120}\n", "speed = 700\n")
    made = made_of(scene, own, 1.0, "", speed)
    phi, returning = angles(made), made.effects.subject.returning
    assert returning is not None
    at = Members(made, phi)
    follower = at.follower
    lift = at.jet(made.cam.drive.motion)
    pressed = made.effect("contact-force").normal(phi, "right")
    assert np.any(pressed > 0.0)
    assert np.any(pressed < 0.0)
    rollers: list[Any] = []
    each: Any
    for each in (follower, returning.cam.follower):
        if rocks:
            swing = at.turned(each.start_arm, follower.swing_sense * lift)
            rollers.append((swing[0] + each.pivot, *swing[1:]))
        else:
            rollers.append((each.start_arm + each.way * lift[0], *(each.way * lift[1:])))
    pushes = [at.push(each) for each in rollers]
    on_follower = np.where(pressed > 0.0, pressed * pushes[0], -pressed * pushes[1])
    size, bodies = float(np.max(np.abs(pressed))), made.effect("reactions").bodies
    assert np.max(np.abs(bodies.of_cam(phi, "right") - on_follower)) <= ROUNDING * size
    roller = 0.2e-3 * (pull(-70.0) - rollers[0][2])
    if not rocks:
        right = -1j * follower.way
        wanted = -along(right, on_follower + (MASS + 0.2e-3) * pull(-70.0))
        assert np.max(np.abs(bodies.of_guide(phi, "right")[0] - wanted)) <= ROUNDING * size
        return
    arm = at.turned(CENTRE - follower.pivot, follower.swing_sense * lift)
    wanted = MASS * (arm[2] - pull(-70.0)) - roller - on_follower
    assert np.max(np.abs(bodies.of_pivot(phi, "right") - wanted)) <= ROUNDING * size
    place = np.where(pressed > 0.0, rollers[0][0], rollers[1][0]) - follower.pivot
    moments = cross(place, on_follower) + cross(arm[0], MASS * pull(-70.0))
    moments = moments + cross(rollers[0][0] - follower.pivot, roller)
    gain = moments - follower.swing_sense * 1e3 - MOMENT * follower.swing_sense * lift[2]
    assert np.max(np.abs(gain)) <= 1e3 * ROUNDING * size
