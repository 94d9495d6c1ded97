"""Effects of conjugate pairs: the force of either disc, against Newton's law and energies.

Contact normals and ways of the rollers come from differences of places, forces of the lever from
its moment of inertia alone.
"""

from __future__ import annotations

import math
from typing import Any, Final

import numpy as np
import pytest

from camgeo.design.design import Design
from camgeo.errors import EffectError
from camgeo.kinematics.mechanism.rollers import OscillatingRoller
from camgeo.numeric.arrays import FloatArray, Side
from tests.effects.bodies import (
    DIFFERENCE,
    PIVOT,
    ROLLER,
    ROUNDING,
    Bodies,
    along,
    friction,
    inside,
    lift,
    omega,
    slope,
)
from tests.effects.scenes import design
from tests.effects.test_power_balance import assert_zero, powers

RIGHT: Final[Side] = "right"

MOMENT: Final = 14.0
MASS: Final = 1.6e-3
ROLLING: Final = 0.1e-3
LOAD: Final = {"conjugate_lever": 2.0e3, "conjugate_carriage": 60.0}
"""In N mm, and in N."""

OWN: Final = {
    "conjugate_lever": f"moment_of_inertia = {1e-3 * MOMENT}",
    "conjugate_carriage": f"mass = {1e3 * MASS}",
}

TELLING: Final = """
[effects.contact-force]
[effects.lift-off]
[effects.drive-torque]
"""


def forces(scene: str, load: float) -> str:
    scale = 1e-3 if scene == "conjugate_lever" else 1.0
    inertia = f"[effects.inertia]\n{OWN[scene]}\nroller_mass = {1e3 * ROLLING}\n"
    return f"{inertia}[effects.load]\nconstant = {scale * load!r}\n"


def inertia_of(made: Design) -> float:
    follower: Any = made.cam.follower
    if isinstance(follower, OscillatingRoller):
        return MOMENT + ROLLING * follower.arm**2
    return MASS + ROLLING


def both(made: Design, phi: FloatArray) -> tuple[FloatArray, FloatArray]:
    """The force of main and return disc, as the tables have them."""
    names = [column.name for column in made.effect("contact-force").columns]
    assert names == ["main contact force", "return contact force"]
    main, back = (column.values(phi, RIGHT) for column in made.effect("contact-force").columns)
    return main, back


@pytest.mark.parametrize("scene", OWN)
@pytest.mark.parametrize("load", [-2.5, 0.0, 0.7])
@pytest.mark.parametrize("rev", [40.0, 430.0])
def test_one_disc_pushes_and_both_together_do_the_work(scene: str, load: float, rev: float) -> None:
    """N_1 dn_1/dq + N_2 dn_2/dq = J d^2q/dt^2 + load, neither pulls, one of them is at rest."""
    asked = load * LOAD[scene]
    now = {"conjugate_lever": 240, "conjugate_carriage": 120}[scene]
    change = (f"speed = {now}\n", f"speed = {rev!r}\n")
    made = design(scene, forces(scene, asked) + TELLING, change)
    phi = inside(made)
    phi = phi[np.abs(made.cam.drive.motion.jet(phi)[1]) > 1e-6]
    main, back = both(made, phi)
    assert np.all(main >= 0.0)
    assert np.all(back >= 0.0)
    assert np.all((main == 0.0) | (back == 0.0))
    _, rate, bent = made.cam.drive.motion.jet(phi)[:3]
    # Way of either roller along its outward normal a unit of q, by vectors; it moves.
    first, second = (
        along(body.outward, body.velocity) / rate
        for body in (Bodies(each.cam, phi, np.ones(len(phi))) for each in made.discs)
    )
    assert np.all(first * second < 0.0)
    expected = inertia_of(made) * omega(made) ** 2 * bent + asked
    scale = np.max(np.abs(expected)) + inertia_of(made) * omega(made) ** 2 * np.max(np.abs(bent))
    assert np.max(np.abs(main * first + back * second - expected)) <= 2.0 * DIFFERENCE * scale
    if load == 0.0 or inertia_of(made) * omega(made) ** 2 * np.max(np.abs(bent)) > 2.0 * abs(asked):
        assert np.max(main) > 0.0
        assert np.max(back) > 0.0


def test_with_friction_the_drive_gives_what_is_stored_done_and_lost() -> None:
    table = {**ROLLER, **PIVOT}
    scene = "conjugate_lever"
    effects = forces(scene, LOAD[scene]) + friction(table) + TELLING + "[effects.reactions]"
    made = design(scene, effects)
    phi, speed, bodies = inside(made), omega(made), made.effect("reactions").bodies
    losses, jet = np.zeros(len(phi)), made.cam.drive.motion.jet(phi)
    follower: Any = made.cam.follower
    turn = 1j * follower.swing_sense
    arm = follower.start_arm * np.exp(turn * jet[0])
    other = -ROLLING * arm * (turn * jet[2] - jet[1] ** 2) * speed**2
    for disc, force in zip(made.discs, both(made, phi), strict=True):
        carries = force > 0.0
        assert np.any(carries)
        at, load = Bodies(disc.cam, phi[carries], force[carries]), other[carries]
        losses[carries] += at.losses(table, load)
        held = bodies.of_pivot(at.phi, RIGHT) + at.load(table) + load
        assert np.max(np.abs(held)) <= ROUNDING * 10.0 * np.max(force)
    velocity = slope(lambda x: lift(made, x), phi)
    losses += 1e3 * table["pivot_viscous"] * speed * velocity**2

    def energy(x: FloatArray) -> FloatArray:
        of_lift = slope(lambda y: lift(made, y), x)
        return np.asarray(
            0.5 * inertia_of(made) * (speed * of_lift) ** 2 + LOAD[scene] * lift(made, x)
        )

    torque = made.effect("drive-torque").torque(phi, RIGHT)
    scale = np.max(np.abs(torque)) + np.ptp(energy(phi))
    assert np.max(np.abs(torque - slope(energy, phi) - losses)) <= DIFFERENCE * scale
    assert np.max(losses) > 0.01 * np.max(np.abs(torque))


def test_each_disc_has_the_pressure_of_its_own_roller_and_flank() -> None:
    """p = sqrt(F E / (pi L R)), with the curvature of its flank.

    Johnson, Contact Mechanics, section 4.2, eq. (4.45): line contact of cylinders.
    """
    scene = "conjugate_lever"
    contact = "[effects.contact-pressure]\nwidth = 6\ncam_modulus = 210000\ncam_poisson = 0.3\n"
    contact += "roller_modulus = 100000\nroller_poisson = 0.25\n"
    made = design(scene, forces(scene, LOAD[scene]) + TELLING + contact)
    phi, columns = inside(made), made.effect("contact-pressure").columns
    modulus = 1.0 / ((1.0 - 0.3**2) / 210000.0 + (1.0 - 0.25**2) / 100000.0)
    for disc, force, column in zip(made.discs, both(made, phi), columns[::2], strict=True):
        assert column.name.endswith("contact pressure")
        bend = disc.cam.disc.inner_curve.curvature(phi)
        relative = 1.0 / disc.cam.follower.roller_radius + bend
        expected = np.sqrt(force * modulus * relative / (math.pi * 6.0))
        found = column.values(phi, RIGHT)
        assert np.max(np.abs(found - expected)) <= 1e-11 * np.max(expected)
        assert np.max(found) > 0.0


def test_discs_that_push_in_one_sense_carry_nothing_the_other_way() -> None:
    scene = "conjugate_lever"
    made = design(scene, forces(scene, 100.0) + TELLING, ("arm_angle = 84", "arm_angle = 8"))
    assert "form-closure" in [each.name for each in made.findings if each.severity == "broken"]
    with pytest.raises(EffectError) as caught:
        made.effect("contact-force")
    assert caught.value.finding == "jamming"


def test_a_limit_holds_either_disc() -> None:
    scene = "conjugate_lever"
    free = design(scene, forces(scene, 0.0) + TELLING)
    found = {each.name: each for each in free.effect("contact-force").findings}
    most = found["largest-contact-force"].value
    main, back = (found[f"largest-contact-force-{name}"].value for name in ("main", "return"))
    assert most is not None
    assert main is not None
    assert back is not None
    assert most == max(main, back) > min(main, back) > 0.0
    text = forces(scene, 0.0) + f"[effects.contact-force]\nlimit = {0.99 * most!r}\n"
    (largest, *_) = design(scene, text).effect("contact-force").findings
    assert largest.severity == "broken"


def test_a_weight_across_the_guide_rubs_alike_on_either_disc() -> None:
    """The side force of the return roller counts in the direction in which the weight's does."""
    scene = "conjugate_carriage"
    table = {"guide": 0.15}
    across = "[effects.gravity]\nangle = -30\n[effects.reactions]\n"
    made = design(scene, forces(scene, -2.0) + across + friction(table) + TELLING)
    phi = inside(made)
    main, back = both(made, phi)
    assert np.any(main > 0.0)
    assert np.any(back > 0.0)
    assert_zero(*powers(made, table, phi))


def test_a_trimmed_return_disc_does_not_have_a_motion_of_its_own() -> None:
    """Both sides move as demanded: what one of two discs has lost, the other one still holds."""
    limits, larger = ("[output]", '[limits]\nundercut = "trim"\n\n[output]'), "roller_radius = 46"
    made = design(
        "conjugate_lever",
        "[effects.load]\nconstant = 3\n[effects.contact-force]\n",
        limits,
        ("arm_angle = 84\narm = 70\nroller_radius = 12", f"arm_angle = 84\narm = 70\n{larger}"),
    )
    subject = made.effects.subject
    assert subject.returning is not None
    assert subject.returning.cam.disc.outline("inner").is_trimmed
    assert subject.returning.state.model == subject.state.model == "demanded"
    told = {each.name for each in made.effects.findings("contact-force")}
    assert "trimmed-motion" in told
