"""The motion over the corners of a trimmed disc, and forces on them, against the replayed motion
differentiated in closed form.

The oracle knows the corner of the disc and nothing else. The roller touches it, so its centre is at
the distance r from it, on the path of the follower: mpmath solves that for the lift, differentiates
it, and takes the force along the line from the corner to the centre.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Final

import mpmath
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from camgeo.design.design import Design
from camgeo.dynamics.effects.results import CONTACT_FORCE, DRIVE_TORQUE
from camgeo.dynamics.state.written import FarMotion, OutlineState, ReplayedMotion
from camgeo.errors import EffectError, GeometryError
from camgeo.geometry.outline.roller import AS_DEMANDED
from camgeo.kinematics.motion import Jet, MergedDwell
from camgeo.numeric.arrays import SIDES, FloatArray, IntArray
from camgeo.units import TURN
from tests.effects.scenes import course_of, design
from tests.strategies import attack

SPEED: Final = 30.0 * math.pi / 30.0
"""Of both cams [rad/s]."""

GUIDED: Final = (
    "[effects.inertia]\nmass = 500\n[effects.spring]\nstiffness = 20\npreload = 2000\n"
    "[effects.contact-force]\n[effects.drive-torque]\n"
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
        assert made.effect(CONTACT_FORCE).normal(at, "right")[0] == pytest.approx(wanted, rel=1e-8)
        if DRIVE_TORQUE in made.scene.effects:
            torque = made.effect(DRIVE_TORQUE).torque(at, "right")[0]
            assert torque == pytest.approx(needed * jet[1], abs=1e-8 * abs(wanted))


@pytest.mark.parametrize(
    ("name", "text", "mass", "rate", "preload"),
    [
        ("swallow_tail", GUIDED, 0.5, 20.0, 2000.0),
        ("cut_lobe", GUIDED, 0.5, 20.0, 2000.0),
        (
            "trimmed_ring",
            (
                '[effects.inertia]\nmoment_of_inertia = 30\n[effects.spring]\nkind = "torsion"\n'
                "torsional_stiffness = 40\npreload_torque = 600\n[effects.contact-force]\n"
                "[effects.drive-torque]\n"
            ),
            30e3,
            40e3,
            600e3,
        ),
    ],
)
def test_the_force_on_a_corner_is_that_of_the_replayed_motion(
    name: str, text: str, mass: float, rate: float, preload: float
) -> None:
    assert_forces_on_corners(design(name, text), mass, rate, preload)


def test_no_roller_presses_on_a_corner_with_a_finite_pressure() -> None:
    trimmed = design("swallow_tail", f"{GUIDED}[effects.contact-pressure]\nwidth = 5\n")
    with pytest.raises(EffectError, match="sharp corner of the trimmed flank carries the roller"):
        trimmed.effect("contact-pressure")


# Behind a linkage or with a flat face -------------------------------------------------------------
# Oracles: the corner of the disc alone; of a flat face, the support of that corner,
# h = Re(conj(n) C exp(i sigma phi)), with h'' = -h.

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


def trimmed(scene: str) -> Design:
    text = (
        "[effects.inertia]\nmoment_of_inertia = 0.01\n[effects.contact-force]\n"
        if scene in ("four_bar", "flat_rocker")
        else "[effects.inertia]\nmass = 2\n[effects.contact-force]\n"
    )
    text += "[effects.kinematics]\n"
    sizes = {
        f"follower.{key}": value
        for key, value in {
            "four_bar": {"base_radius": 50, "roller_radius": 36},
            "crank_slider": {"base_radius": 55, "roller_radius": 40},
            "flat_rocker": {"base_radius": 8},
            "tappet": {"base_radius": 5},
        }[scene].items()
    }
    edits = {"limits.undercut": "trim", "limits.radius_ratio": None, **sizes}
    return Design(design(scene, text, *STEEPER[scene]).scene.with_values(edits))


def state_of(made: Design) -> OutlineState:
    state = made.effects.subject.state
    assert isinstance(state, OutlineState)
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


# The motion over the corners of a trimmed disc, as a motion like any other."""


TRIMMED = ("swallow_tail", "cut_lobe", "trimmed_ring", "straight_moves")


def replayed(name: str) -> ReplayedMotion:
    motion: Any = design(name, "").effects.subject.state.motion
    assert isinstance(motion, ReplayedMotion)
    return motion


@pytest.mark.parametrize("name", TRIMMED)
def test_each_derivative_is_that_of_the_one_before(name: str) -> None:
    motion = replayed(name)
    edges = np.append(motion.borders, motion.borders[0] + TURN)
    wide = np.flatnonzero(np.diff(edges) > 1e-3)
    middle, step = 0.5 * (edges[wide] + edges[wide + 1]), 1e-5
    before, here, after = (motion.jet(middle + k * step) for k in (-1, 0, 1))
    size = np.max(np.abs(motion.jet(np.linspace(0.0, TURN, 999))), axis=1)
    for order in range(3):
        slope = (after[order] - before[order]) / (2.0 * step)
        assert slope == pytest.approx(here[order + 1], abs=1e-6 * (size[order] + size[order + 1]))


@pytest.mark.parametrize("name", TRIMMED)
def test_it_breaks_where_corners_begin_and_end_and_is_the_demanded_one_beside_them(
    name: str,
) -> None:
    motion = replayed(name)
    phi = np.linspace(0.0, TURN, 5000)
    held = motion.on_corner(phi, "right")
    assert np.any(held)
    assert motion.jet(phi[~held]) == pytest.approx(motion.demanded.jet(phi[~held]), abs=0.0)
    assert np.all(motion.jet(phi[held])[0] != motion.demanded.jet(phi[held])[0])
    for start, end in motion.ranges:
        assert {start % TURN, end % TURN} <= {*motion.breaks.tolist()} & {*motion.borders.tolist()}
        inner = (motion.borders - start) % TURN
        assert not np.any((inner > 0.0) & (inner < end - start))
    jet, bounds = motion.jet_and_bounds(phi[:-1], phi[1:])
    middle = 0.5 * (phi[:-1] + phi[1:])
    assert jet == pytest.approx(motion.jet(middle), abs=0.0)
    assert np.array_equal(np.isinf(bounds[0]), motion.on_corner(middle, "right"))


@dataclass(frozen=True)
class Lying:
    """Corners of a disc between some of its borders, and demanded rests."""

    borders: FloatArray
    numbers: IntArray
    dwells: tuple[MergedDwell, ...]


@attack
@given(
    st.lists(st.integers(0, 71), min_size=2, max_size=6, unique=True),
    st.integers(0, 71),
    st.integers(1, 72),
    st.integers(0, 1),
)
def test_of_a_dwell_what_no_corner_interrupts_is_left(
    borders: list[int], start: int, span: int, first: int
) -> None:
    """Counted in cells of five degrees."""
    cell = TURN / 72.0
    places = np.sort(borders)
    numbers = np.where((np.arange(len(places)) + first) % 2, 0, AS_DEMANDED)
    dwell = MergedDwell(start * cell, span * cell)
    lying: Any = Lying(places * cell, numbers, (dwell,))
    left = ReplayedMotion(lying, lying).dwells
    middle = np.arange(72) + 0.5
    inside = np.zeros(72, dtype=np.int64)
    for each in left:
        inside += (middle - each.start / cell) % 72 < each.span / cell
    held = numbers[np.searchsorted(places, middle) - 1] != AS_DEMANDED
    assert np.array_equal(inside, ((middle - start) % 72 < span) & ~held)
