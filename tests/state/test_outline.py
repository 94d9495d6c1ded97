"""Trimmed discs whose followers have a linkage or a flat face, as the state of motion.

Oracles: the corner of the disc alone, as in `tests.effects.test_trimmed_cams`; of a flat face, the
support of that corner, h = Re(conj(n) C exp(i sigma phi)), with h'' = -h.
"""

from __future__ import annotations

import math
from typing import Any, Final

import numpy as np
import pytest

from camgeo.design.design import Design
from camgeo.dynamics.effects.results import CONTACT_FORCE
from camgeo.dynamics.state.written import FarMotion, OfOutline
from camgeo.errors import GeometryError
from camgeo.kinematics.motion import Jet
from camgeo.numeric.arrays import SIDES
from tests.effects.scenes import course_of, design
from tests.effects.test_trimmed_cams import assert_forces_on_corners

STEEPER: Final = {
    "four_bar": (
        ("span = 110\nto = 22", "span = 50\nto = 22"),
        ("span = 110\nto = 0", "span = 50\nto = 0"),
        ("dwell = 60", "dwell = 180"),
    ),
    "crank_slider": (
        ("span = 110\nto = -40", "span = 60\nto = -40"),
        ("span = 120\nto = 0", "span = 60\nto = 0"),
        ("dwell = 50", "dwell = 160"),
    ),
    "flat_rocker": (
        ('rotation = "cw"', 'rotation = "cw"\nspeed = 100'),
        ("face = [60, 100]\n", ""),
    ),
    "tappet": (("face = [-9, 11]\n", ""),),
}
"""Moves that undercut, and no limits of a face."""

SIZES: Final = {
    "four_bar": {"base_radius": 50, "roller_radius": 36},
    "crank_slider": {"base_radius": 55, "roller_radius": 40},
    "flat_rocker": {"base_radius": 8},
    "tappet": {"base_radius": 5},
}

ROCKING: Final = "[effects.inertia]\nmoment_of_inertia = 0.01\n[effects.contact-force]\n"
GUIDED: Final = "[effects.inertia]\nmass = 2\n[effects.contact-force]\n"


def trimmed(scene: str) -> Design:
    text = ROCKING if scene in ("four_bar", "flat_rocker") else GUIDED
    text += "[effects.kinematics]\n"
    sizes = {f"follower.{key}": value for key, value in SIZES[scene].items()}
    edits = {"limits.undercut": "trim", "limits.radius_ratio": None, **sizes}
    return Design(design(scene, text, *STEEPER[scene]).scene.with_values(edits))


def state_of(made: Design) -> OfOutline:
    state = made.effects.subject.state
    assert isinstance(state, OfOutline)
    return state


@pytest.mark.parametrize(("scene", "mass"), [("four_bar", 10.0), ("crank_slider", 2e-3)])
def test_the_force_on_a_corner_of_a_linked_cam_is_that_of_its_motion(
    scene: str, mass: float
) -> None:
    assert_forces_on_corners(trimmed(scene), mass)


@pytest.mark.parametrize("scene", ["four_bar", "crank_slider"])
def test_the_far_end_moves_with_the_follower_over_the_corners(scene: str) -> None:
    made = trimmed(scene)
    state, linkage = state_of(made), made.drive.linkage
    assert linkage is not None
    phi = np.linspace(0.0, 6.28, 999)
    own, far, plan = (each.jet(phi) for each in (state.motion, state.output, made.drive.plan))
    for mine, back in zip(own, linkage.transform(far), strict=True):
        assert back == pytest.approx(mine, abs=1e-9 * (1.0 + float(np.max(np.abs(mine)))))
    held = state.on_corner(phi, "right")
    scale = np.max(np.abs(plan), axis=1)[:, None]
    assert np.all(np.abs(far - plan)[:, ~held] <= 1e-9 * (1.0 + scale))
    assert np.max(np.abs(far - plan)[0]) > 1e-4
    for name in ("kinematics", "contact-force"):
        (told,) = (each for each in made.effects.findings(name) if each.name == "trimmed-motion")
        assert (
            "these figures are for the motion that the trimmed inner flank makes" in told.sentence
        )


@pytest.mark.parametrize("scene", ["tappet", "flat_rocker"])
def test_a_face_that_rocks_over_a_corner_is_pushed_along_its_normal(scene: str) -> None:
    made = trimmed(scene)
    state, course, cam = state_of(made), course_of(made), made.cam
    follower: Any = cam.follower
    corners = [each.centre for each in cam.disc.outline("inner").path.pivots]
    found = made.effect(CONTACT_FORCE).normal
    assert len(corners) == len(state.motion.ranges)
    for low, high in state.motion.ranges:
        phi = np.linspace(low, high, 9)[1:-1]
        contact = state.curve.point(phi)
        corner = corners[int(np.argmin(np.abs(np.array(corners) - contact[0])))]
        assert np.all(np.abs(contact - corner) <= 1e-9)
        jet, omega = state.motion.jet(phi), course.rates(phi)[0]
        seen = corner * np.exp(1j * cam.rotation * phi)
        if scene == "tappet":
            away = (np.conj(np.exp(1j * follower.guide_angle)) * seen).real
            assert jet[0] == pytest.approx(away - follower.base_radius, abs=1e-9)
            assert jet[2] == pytest.approx(-away, abs=1e-9)
            assert jet[3] == pytest.approx(-jet[1], abs=1e-9)
            wanted = -2e-3 * away * omega**2
        else:
            # The vertex lies on the face, face_offset from the parallel through the pivot.
            reach = np.abs(seen - complex(follower.pivot))
            lever = np.sqrt(reach**2 - follower.face_offset**2)
            wanted = 10.0 * jet[2] * omega**2 / lever
        assert np.all(state.on_corner(phi, "right"))
        assert found(phi, "right") == pytest.approx(wanted, rel=1e-9)
    ends = np.array(state.motion.ranges).ravel()
    before, after = (state.motion.jet(ends, side) for side in SIDES)
    assert after[:2] == pytest.approx(before[:2], abs=1e-8)
    assert state.order == 1
    assert not state.shocks


def test_with_less_undercut_the_motion_comes_to_the_demanded_one() -> None:
    """The radius of curvature lacks u at its minimum, which it leaves with the power p of the
    angle. So what is cut off is u^(1/p) wide, and the loss is as u^(1 + 2/p): 2 for p = 2, and no
    less than 5/3 for p up to 3.
    """
    found = []
    for radius in (5.0, 7.0, 8.0):
        made = Design(trimmed("tappet").scene.with_values({"follower.base_radius": radius}))
        (bent,) = (each for each in made.findings if each.name == "convexity")
        phi = np.linspace(0.0, 6.28, 2000)
        off = np.abs(state_of(made).output.jet(phi)[0] - made.drive.plan.jet(phi)[0])
        loss = made.cam.disc.replay("inner").largest_loss.value
        assert np.max(off) == pytest.approx(loss, rel=1e-3)
        assert bent.value is not None
        found.append((math.log(-bent.value), math.log(loss)))
    slopes = np.diff([each[1] for each in found]) / np.diff([each[0] for each in found])
    assert np.all((slopes > 5.0 / 3.0) & (slopes < 2.1))
    whole = Design(trimmed("tappet").scene.with_values({"follower.base_radius": 12.0}))
    assert whole.effects.subject.state.model == "demanded"


class Squared:
    """A linkage q = x^2, whose dead centre is at 0."""

    def transform(self, jet: Jet, order: int = 3) -> Jet:
        x, v = jet[0], jet[1]
        return np.stack((x * x, 2.0 * x * v, 2.0 * v * v, np.zeros_like(x)))[: order + 1]


class Constant:
    """Rests at `value`."""

    def __init__(self, value: float) -> None:
        self.value = value

    def jet(self, phi: Any, side: Any = "right", order: int = 3) -> Jet:
        del side
        found = np.zeros((order + 1, len(phi)))
        found[0] = self.value
        return found


def far_end(follower: float, start: float) -> Any:
    far: Any = FarMotion(Constant(follower), Squared(), Constant(start))  # type: ignore[arg-type]  # enough of each
    return far.jet(np.zeros(1))[0, 0]


@pytest.mark.parametrize(("follower", "start"), [(0.25, 1.0), (0.25, -1.0), (4.0, 0.9)])
def test_the_far_end_stays_on_its_side_of_a_dead_centre(follower: float, start: float) -> None:
    assert far_end(follower, start) == pytest.approx(math.copysign(math.sqrt(follower), start))


@pytest.mark.parametrize(("follower", "start"), [(-0.1, 1.0), (0.5, 0.0), (-1e-3, -0.01)])
def test_beyond_a_dead_centre_there_is_no_far_end(follower: float, start: float) -> None:
    with pytest.raises(GeometryError, match="dead centre"):
        far_end(follower, start)
