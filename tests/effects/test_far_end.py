"""What has a mass or a load at the far end of a linkage, held against Newton's law of every member.

Lever or crank, coupler, and follower are cut free; the forces in both pins are solved for, with
accelerations from differences of places. Virtual work knows none of those forces.
"""

from __future__ import annotations

import math
from typing import Any, Final

import numpy as np
import pytest

from camgeo.design.design import Design
from camgeo.dynamics.effects.forces import at_rates
from camgeo.errors import EffectError
from camgeo.kinematics.mechanism.oscillating_roller import OscillatingRoller
from camgeo.numeric.arrays import ComplexArray, FloatArray
from tests.effects.scenes import assert_refused, design
from tests.effects.test_physics import (
    DIFFERENCE,
    Bodies,
    along,
    inside,
    lift,
    omega,
    pull,
    slope,
    stroke,
)
from tests.findings import effect_findings

COUPLER: Final = 0.3e-3
SHARE: Final = 0.35
COUPLER_MOMENT: Final = 1.7
OUTPUT: Final = 21.0
ROLLER: Final = 0.07e-3
OWN: Final = {"four_bar": 6.0, "crank_slider": 0.9e-3}
LOAD: Final = 2.5e3
ANGLE: Final = -75.0

EFFECTS: Final = f"""
[effects.inertia]
coupler_mass = {1e3 * COUPLER}
coupler_centre = {SHARE}
coupler_moment = {1e-3 * COUPLER_MOMENT}
output_moment = {1e-3 * OUTPUT}
roller_mass = {1e3 * ROLLER}
OWN
[effects.gravity]
angle = {ANGLE}
[effects.load]
constant = {1e-3 * LOAD}
[effects.contact-force]
[effects.drive-torque]
"""

SCENES: Final[dict[str, tuple[tuple[str, str], ...]]] = {
    "four_bar": (("speed = 60\n", "speed = 140\n"),),
    "crank_slider": (
        ("speed = 60\n", "speed = 140\n"),
        ("offset = 6\n", "offset = 6\nguide_angle = 35\n"),
    ),
}
"""Changes that let no term be small, and the guide lie across the axes."""


def made_of(scene: str) -> Design:
    own = "moment_of_inertia = 0.006" if scene == "four_bar" else "mass = 0.9"
    return design(scene, EFFECTS.replace("OWN", own), *SCENES[scene])


def cross(a: Any, b: Any) -> Any:
    return np.imag(np.conj(a) * b)


def joints(made: Design, phi: FloatArray) -> tuple[ComplexArray, ComplexArray]:
    """Pin and tip seen from the crank's shaft; the guide of a slider lies as the follower's."""
    assert made.cam.drive.linkage is not None
    found = made.cam.drive.linkage.joints(stroke(made, phi))
    if isinstance(made.cam.follower, OscillatingRoller):
        return found
    at = np.array([0.0, math.radians(100.0)])
    (roller,), (pin,) = (
        np.diff(each)
        for each in (
            Bodies(made.cam, at, at).centre(at),
            made.cam.drive.linkage.joints(stroke(made, at))[0],
        )
    )
    assert abs(roller) == pytest.approx(abs(pin), rel=1e-12)
    turn = roller / pin
    return turn * found[0], turn * found[1]


def coupler_centre(made: Design, phi: FloatArray) -> ComplexArray:
    pin, tip = joints(made, phi)
    return np.asarray(SHARE * pin + (1.0 - SHARE) * tip)


def twice(function: Any, made: Design, phi: FloatArray) -> Any:
    """Second derivative over time, by differences."""
    return omega(made) ** 2 * slope(lambda x: slope(lambda y: function(made, y), x), phi)


def turning(made: Design, phi: FloatArray) -> FloatArray:
    """Acceleration of the coupler's angle."""
    start = np.subtract(*joints(made, phi))

    def angle(_: Design, x: FloatArray) -> FloatArray:
        return np.angle(np.subtract(*joints(made, x)) / start)

    return np.asarray(twice(angle, made, phi))


def member_angle(made: Design, phi: FloatArray) -> FloatArray:
    """Of lever or crank, counter-clockwise; a positive demanded motion may be clockwise."""
    at, way = np.zeros(1), stroke(made, phi)
    far = 0 if isinstance(made.cam.follower, OscillatingRoller) else 1
    shaft = getattr(made.cam.drive.linkage, "shaft", 0.0) if far == 0 else 0.0
    arm, first = joints(made, phi)[far] - shaft, joints(made, at)[far] - shaft
    angle: FloatArray = np.angle(arm / first)
    assert np.max(np.abs(np.abs(angle) - np.abs(way))) <= 1e-12
    return angle


def statics(made: Design, phi: FloatArray) -> FloatArray:
    """R (n,): what the cam has to give on the follower's coordinate [N or N mm]."""
    pin, tip = joints(made, phi)
    centre = coupler_centre(made, phi)
    rocks = isinstance(made.cam.follower, OscillatingRoller)
    shaft = complex(getattr(made.cam.drive.linkage, "shaft", 0.0))
    far, arm = (pin, pin - shaft) if rocks else (tip, tip)
    near = tip if rocks else pin
    sense = np.sign(member_angle(made, phi) * stroke(made, phi))
    assert len(set(sense[sense != 0.0])) == 1
    torque = -LOAD * sense[sense != 0.0][0]  # counter-clockwise, on lever or crank
    needed = OUTPUT * twice(member_angle, made, phi) - torque
    push = COUPLER * (twice(coupler_centre, made, phi) - pull(ANGLE))
    turn = COUPLER_MOMENT * turning(made, phi)
    forces = []
    for k in range(len(phi)):
        # F on the far member and G on the near one, both from the coupler: x, y each.
        rows = np.zeros((4, 4))
        rows[0, :2] = -arm[k].imag, arm[k].real
        rows[1, [0, 2]] = rows[2, [1, 3]] = -1.0
        for column, joint in ((0, far[k] - centre[k]), (2, near[k] - centre[k])):
            rows[3, column : column + 2] = joint.imag, -joint.real
        found = np.linalg.solve(rows, [needed[k], push[k].real, push[k].imag, turn[k]])
        forces.append(complex(found[2], found[3]))
    on_follower = np.array(forces)
    own = OWN["four_bar" if rocks else "crank_slider"]
    centre_of_roller = Bodies(made.cam, phi, phi).centre(phi)
    if rocks:
        follower: Any = made.cam.follower
        assert isinstance(follower, OscillatingRoller)
        own = own + ROLLER * follower.arm**2
        moments = cross(tip, on_follower)
        moments = moments + cross(centre_of_roller - follower.pivot, ROLLER * pull(ANGLE))
        return np.asarray(own * twice(lift, made, phi) - moments)
    way = slope(lambda x: Bodies(made.cam, x, x).centre(x), phi) / slope(
        lambda x: lift(made, x), phi
    )
    weight = (own + ROLLER) * pull(ANGLE)
    return np.asarray((own + ROLLER) * twice(lift, made, phi) - along(way, on_follower + weight))


def moving(made: Design) -> FloatArray:
    """Angles at which the follower moves, where its way is known."""
    phi = inside(made)
    velocity = np.abs(made.cam.drive.motion.jet(phi)[1])
    return np.asarray(phi[velocity > 0.05 * np.max(velocity)])


@pytest.mark.parametrize("scene", SCENES)
def test_the_cam_gives_what_the_members_cut_free_ask_for(scene: str) -> None:
    made = made_of(scene)
    phi = moving(made)
    contact = made.effect("contact-force")
    rates = np.stack((np.full(len(phi), omega(made)), np.zeros(len(phi))))
    found = at_rates(contact.required(phi, "right"), rates)
    expected = statics(made, phi)
    # The way by differences is divided by a twentieth of the largest velocity at least.
    assert np.max(np.abs(found - expected)) <= 20.0 * DIFFERENCE * np.max(np.abs(expected))
    for name in ("inertia", "gravity", "load"):  # none of which is lost in the others
        force = made.effect(name).force.coefficients(phi, "right")
        reported = force[0] + omega(made) ** 2 * force[2]
        assert np.max(np.abs(reported)) > 1e-3 * np.max(np.abs(expected))


@pytest.mark.parametrize("scene", SCENES)
def test_power_of_the_drive_goes_into_energies_and_the_load(scene: str) -> None:
    made = made_of(scene)
    phi, speed = inside(made), omega(made)
    rocks = scene == "four_bar"

    def kinetic(x: FloatArray) -> FloatArray:
        rod = np.subtract(*joints(made, x))
        turn = np.imag(slope(lambda y: np.subtract(*joints(made, y)), x) / rod)
        own = OWN[scene] + ROLLER * (abs(made.cam.follower.start_arm) ** 2 if rocks else 1.0)
        energy = own * slope(lambda y: lift(made, y), x) ** 2
        energy = energy + OUTPUT * slope(lambda y: stroke(made, y), x) ** 2
        energy = energy + COUPLER * np.abs(slope(lambda y: coupler_centre(made, y), x)) ** 2
        return np.asarray(0.5 * speed**2 * (energy + COUPLER_MOMENT * turn**2))

    def weights(x: FloatArray) -> FloatArray:
        roller = Bodies(made.cam, x, x).centre(x)
        moments = (ROLLER if rocks else OWN[scene] + ROLLER) * roller
        return np.asarray(-along(pull(ANGLE), moments + COUPLER * coupler_centre(made, x)))

    def energy(x: FloatArray) -> FloatArray:
        return kinetic(x) + weights(x) + LOAD * stroke(made, x)

    torque = made.effect("drive-torque").torque(phi, "right")
    scale = np.max(np.abs(torque)) + np.ptp(energy(phi))
    assert np.max(np.abs(torque - slope(energy, phi))) <= DIFFERENCE * scale


LOCKING: Final = {
    # The lever comes into line with the coupler; the crank into line with it.
    "four_bar": ((("coupler = 120", "coupler = 60"), ("to = 22", "to = -60")), "lever"),
    "crank_slider": ((("to = -40", "to = -160"),), "crank"),
}


@pytest.mark.parametrize("scene", LOCKING)
@pytest.mark.parametrize("effect", ["load", "inertia"])
def test_a_far_end_that_cannot_be_moved_has_no_answer(scene: str, effect: str) -> None:
    changes, member = LOCKING[scene]
    tables = {
        "load": "[effects.load]\nconstant = 1",
        "inertia": "[effects.inertia]\noutput_moment = 0.01",
    }
    made = design(scene, tables[effect], *changes)
    with pytest.raises(EffectError, match="are in line at cam angle") as caught:
        made.effect(effect)
    assert caught.value.finding == f"locked-{member}"


def test_the_moment_of_what_turns_is_refused_where_nothing_does() -> None:
    for scene in ("setzhub", "plate_translating"):
        table = "output_moment = 0.01"
        assert_refused(scene, "inertia", table, "output_moment", "is for the lever")


def test_a_stiffness_swings_with_the_moment_at_the_far_end() -> None:
    vibration = "[effects.vibration]\ntorsional_stiffness = 900\n"
    made = design("four_bar", f"[effects.inertia]\noutput_moment = 0.018\n{vibration}")
    frequency = next(f for f in effect_findings(made) if f.name == "natural-frequency").value
    assert frequency == pytest.approx(math.sqrt(900.0 / 0.018) / (2.0 * math.pi), rel=1e-12)
