"""Forces of trimmed cams, against the replayed motion differentiated in closed form.

The oracle knows the corner of the disc and nothing else. The roller touches it, so its centre is at
the distance r from it, on the path of the follower: mpmath solves that for the lift, differentiates
it, and takes the force along the line from the corner to the centre.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, Final

import mpmath
import numpy as np
import pytest

from camgeo.design.design import Design
from camgeo.dynamics.effects.results import CONTACT_FORCE, DRIVE_TORQUE
from camgeo.errors import EffectError
from camgeo.numeric.arrays import Side
from tests.effects.scenes import design

SPEED: Final = 30.0 * math.pi / 30.0
"""Of both cams [rad/s]."""

GUIDED: Final = (
    "[effects.inertia]\nmass = 500\n[effects.spring]\nstiffness = 20\npreload = 2000\n"
    "[effects.contact-force]\n[effects.drive-torque]\n"
)
ROCKING: Final = (
    '[effects.inertia]\nmoment_of_inertia = 30\n[effects.spring]\nkind = "torsion"\n'
    "torsional_stiffness = 40\npreload_torque = 600\n[effects.contact-force]\n"
    "[effects.drive-torque]\n"
)

Place = Callable[[Any], Any]
"""Of the roller centre relative to the cam axis [mm], by the lift."""


def on_guide(follower: Any) -> Place:
    start = mpmath.sqrt(mpmath.mpf(follower.base_radius) ** 2 - mpmath.mpf(follower.offset) ** 2)
    way = mpmath.mpmathify(follower.way)
    # The guide passes the axis at the offset, to the right looking along it.
    return lambda lift: way * (start + lift - 1j * mpmath.mpf(follower.offset))


def on_rocker(follower: Any) -> Place:
    pivot, arm = mpmath.mpmathify(follower.pivot), mpmath.mpmathify(follower.start_arm)
    return lambda lift: pivot + arm * mpmath.expj(follower.swing_sense * lift)


def corner_of(trimmed: Design, phi: float) -> complex:
    """The corner [mm] of the disc that the roller touches at `phi` [rad], in the cam."""
    cam, curve = trimmed.cam, trimmed.effects.subject.state.curve
    centre = complex(curve.point(np.array([phi]))[0])
    pivots = cam.disc.outline(cam.contact.main).path.pivots
    return min((each.centre for each in pivots), key=lambda at: abs(at - centre))


CASES: Final[list[tuple[str, str, Callable[[Any], Place], float, float, float]]] = [
    ("swallow_tail", GUIDED, on_guide, 0.5, 20.0, 2000.0),
    ("cut_lobe", GUIDED, on_guide, 0.5, 20.0, 2000.0),
    ("trimmed_ring", ROCKING, on_rocker, 30e3, 40e3, 600e3),
]


@pytest.mark.parametrize(("name", "text", "path", "mass", "rate", "preload"), CASES)
def test_the_force_on_a_corner_is_that_of_the_replayed_motion(
    name: str, text: str, path: Callable[[Any], Place], mass: float, rate: float, preload: float
) -> None:
    """m q'' and the spring over the lever of the line from corner to centre; the torque is N n'."""
    trimmed = design(name, text)
    cam, state = trimmed.cam, trimmed.effects.subject.state
    assert state.model == "outline"
    force, torque = trimmed.effect(CONTACT_FORCE), trimmed.effect(DRIVE_TORQUE)
    place = path(cam.follower)
    radius = mpmath.mpf(cam.follower.roller_radius)
    ranges = state.motion.ranges  # type: ignore[attr-defined]  # of this model
    for phi in (low + share * (high - low) for low, high in ranges for share in (0.2, 0.9)):
        at = np.array([phi])
        corner = mpmath.mpmathify(corner_of(trimmed, phi))
        guess = float(state.motion.jet(at)[0, 0])

        def seen(angle: Any, corner: Any = corner) -> Any:
            return corner * mpmath.expj(cam.rotation * angle)

        def lift(angle: Any, guess: float = guess) -> Any:
            return mpmath.findroot(lambda trial: abs(place(trial) - seen(angle)) - radius, guess)

        with mpmath.workdps(30):
            q = lift(phi)
            normal = (place(q) - seen(phi)) / radius
            lever = mpmath.re(mpmath.conj(normal) * mpmath.diff(place, q))
            velocity, acceleration = mpmath.diff(lift, phi), mpmath.diff(lift, phi, 2)
            spring = -mpmath.sign(lever) * preload - rate * q  # it closes the contact
            needed = mass * acceleration * SPEED**2 - spring
            wanted = cam.contact.push * needed / lever  # negative on an outer flank
        size = abs(float(wanted))
        assert guess == pytest.approx(float(q), abs=1e-10)
        assert force.normal(at, "right")[0] == pytest.approx(float(wanted), abs=1e-9 * size)
        drive = float(needed * velocity)
        assert torque.torque(at, "right")[0] == pytest.approx(drive, abs=1e-8 * size)


def test_the_force_jumps_with_the_acceleration_at_both_ends_of_a_corner() -> None:
    trimmed = design("cut_lobe", GUIDED)
    force, state = trimmed.effect(CONTACT_FORCE), trimmed.effects.subject.state
    ranges = state.motion.ranges  # type: ignore[attr-defined]  # of this model
    ends = np.array([ranges[0][0], ranges[-1][1]])
    sides: tuple[Side, ...] = ("left", "right")
    jets, forces = ([of(ends, side) for side in sides] for of in (state.motion.jet, force.normal))
    lever = state.curve.leverage(ends)
    jump = 0.5 * SPEED**2 * (jets[1][2] - jets[0][2]) / lever
    assert np.all(np.abs(jump) > 1.0)
    assert forces[1] - forces[0] == pytest.approx(jump, rel=1e-6)
    assert jets[0][:2] == pytest.approx(jets[1][:2], abs=1e-9)


def test_no_roller_presses_on_a_corner_with_a_finite_pressure() -> None:
    trimmed = design("swallow_tail", f"{GUIDED}[effects.contact-pressure]\nwidth = 5\n")
    with pytest.raises(EffectError, match="sharp corner of the trimmed flank carries the roller"):
        trimmed.effect("contact-pressure")


@pytest.mark.parametrize("name", ["swallow_tail", "cut_lobe"])
def test_without_friction_the_cam_gets_back_what_it_gives(name: str) -> None:
    """Masses and spring are conservative on any motion that closes."""
    works = {each.name: each for each in design(name, GUIDED).effects.findings("drive-torque")}
    assert works["work-per-turn"].value == 0.0
