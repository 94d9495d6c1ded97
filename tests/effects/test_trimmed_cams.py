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
from tests.effects.scenes import course_of, design

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


def place_of(follower: Any) -> Place:
    return (on_guide if follower.lift_unit == "mm" else on_rocker)(follower)


def derivatives(gap: Callable[[Any, Any], Any], phi: float, guess: float) -> list[float]:
    """Lift and its first three derivatives at `phi`, by the gap over lift and cam angle."""

    def lift(angle: Any) -> Any:
        return mpmath.findroot(lambda q: gap(q, angle), guess)

    with mpmath.workdps(30):
        return [float(mpmath.diff(lift, mpmath.mpf(float(phi)), k)) for k in range(4)]


def corner_of(trimmed: Design, phi: float) -> complex:
    """The corner [mm] of the disc that the roller touches at `phi` [rad], in the cam."""
    cam, curve = trimmed.cam, trimmed.effects.subject.state.curve
    centre = complex(curve.point(np.array([phi]))[0])
    pivots = cam.disc.outline(cam.contact.main).path.pivots
    return min((each.centre for each in pivots), key=lambda at: abs(at - centre))


def assert_forces_on_corners(
    made: Design, mass: float, rate: float = 0.0, preload: float = 0.0
) -> None:
    """m q'' and the spring over the lever of the line from corner to centre; the torque is N n'."""
    cam, state = made.cam, made.effects.subject.state
    assert state.model == "outline"
    place, radius = place_of(cam.follower), mpmath.mpf(cam.follower.roller_radius)
    ranges = state.motion.ranges  # type: ignore[attr-defined]  # of this model
    for phi in (low + share * (high - low) for low, high in ranges for share in (0.2, 0.9)):
        at = np.array([phi])
        corner, own = mpmath.mpmathify(corner_of(made, phi)), state.motion.jet(at)[:, 0]

        def seen(angle: Any, corner: Any = corner) -> Any:
            return corner * mpmath.expj(cam.rotation * angle)

        def gap(lift: Any, angle: Any, seen: Any = seen) -> Any:
            return abs(place(lift) - seen(angle)) - radius

        jet = derivatives(gap, phi, float(own[0]))
        assert own == pytest.approx(jet, abs=1e-8 * max(map(abs, jet)))
        q = mpmath.mpf(jet[0])
        normal = (place(q) - seen(phi)) / radius
        lever = float(mpmath.re(mpmath.conj(normal) * mpmath.diff(place, q)))
        spring = -math.copysign(preload, lever) - rate * jet[0]  # it closes the contact
        needed = mass * jet[2] * course_of(made).rates(at)[0, 0] ** 2 - spring
        wanted = cam.contact.push * needed / lever  # negative on an outer flank
        found = made.effect(CONTACT_FORCE).normal(at, "right")[0]
        assert found == pytest.approx(wanted, rel=1e-8)
        if DRIVE_TORQUE in made.scene.effects:
            torque = made.effect(DRIVE_TORQUE).torque(at, "right")[0]
            assert torque == pytest.approx(needed * jet[1], abs=1e-8 * abs(wanted))


@pytest.mark.parametrize(
    ("name", "text", "mass", "rate", "preload"),
    [
        ("swallow_tail", GUIDED, 0.5, 20.0, 2000.0),
        ("cut_lobe", GUIDED, 0.5, 20.0, 2000.0),
        ("trimmed_ring", ROCKING, 30e3, 40e3, 600e3),
    ],
)
def test_the_force_on_a_corner_is_that_of_the_replayed_motion(
    name: str, text: str, mass: float, rate: float, preload: float
) -> None:
    assert_forces_on_corners(design(name, text), mass, rate, preload)


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
