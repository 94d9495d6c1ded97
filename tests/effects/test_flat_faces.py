"""Effects of flat-faced followers, compared with vectors in the fixed frame.

Only places on the outline are taken from camgeo; its normal, the rotation of the rocker and all
velocities are differences of these. The forces on the follower follow from Newton's law with all
reactions.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
import pytest
from scipy.optimize import brentq

from camgeo.design.design import Design
from camgeo.errors import EffectError, SceneError
from camgeo.kinematics.mechanism.oscillating_flat import OscillatingFlat
from camgeo.kinematics.mechanism.translating_flat import TranslatingFlat
from camgeo.kinematics.time_course import in_time
from camgeo.numeric.arrays import ComplexArray, FloatArray, Side
from camgeo.scene.scene import parse_scene
from camgeo.scene.toml import template
from camgeo.units import TURN
from tests.effects.scenes import assert_refused, design
from tests.effects.test_physics import (
    DIFFERENCE,
    G,
    along,
    friction,
    inside,
    omega,
    pull,
    slope,
    turn_integral,
)
from tests.scene.test_flat_followers import LINKAGE

TAPPET: Final = """
[effects.inertia]
mass = 0.9
[effects.gravity]
angle = -60
[effects.spring]
stiffness = 12
preload = 150
[effects.load]
constant = 30
"""

ROCKER: Final = """
[effects.inertia]
moment_of_inertia = 0.002
rocker_mass = 0.6
rocker_centre = [-35, 62]
[effects.gravity]
angle = -75
[effects.spring]
kind = "torsion"
torsional_stiffness = 60
preload_torque = 9
[effects.load]
constant = 0.8
"""

GUIDED: Final = {
    "face": 0.11, "guide": 0.13, "guide_length": 42.0, "guide_overhang": 17.0, "guide_offset": -3.5,
    "guide_viscous": 0.02,
}  # fmt: skip
PIVOTED: Final = {"face": 0.12, "pivot": 0.1, "pivot_diameter": 16.0, "pivot_viscous": 0.05}

CASES: Final = {"tappet": (TAPPET, GUIDED), "flat_rocker": (ROCKER, PIVOTED)}

TELLING: Final = "\n[effects.contact-force]\n[effects.drive-torque]\n[effects.lift-off]\n"

ROTATION: Final = {"tappet": "ccw", "flat_rocker": "cw"}


def made_of(scene: str, effects: str, turned: bool = False, rev: float = 300.0) -> Design:
    """The fixture, which may turn the other way round."""
    now = ROTATION[scene]
    other = {"ccw": "cw", "cw": "ccw"}[now] if turned else now
    slow = "speed = 120\n" if scene == "tappet" else ""
    old = f'rotation = "{now}"\n{slow}'
    return design(scene, effects, (old, f'rotation = "{other}"\nspeed = {rev!r}\n'))


@dataclass(frozen=True)
class Bodies:
    """Cam and face in the fixed frame; velocities per unit of cam speed."""

    made: Design
    phi: FloatArray

    def contact(self, phi: FloatArray) -> ComplexArray:
        return np.asarray(
            self.made.cam.disc.pitch_curve.point(phi) * np.exp(1j * self.made.cam.rotation * phi)
        )

    def normal_at(self, phi: FloatArray) -> ComplexArray:
        """Away from the disc: the outline is run through against the sense of rotation."""
        tangent = slope(self.made.cam.disc.pitch_curve.point, phi)
        tangent = tangent / np.abs(tangent) * np.exp(1j * self.made.cam.rotation * phi)
        return np.asarray(1j * self.made.cam.rotation * tangent)

    @property
    def normal(self) -> ComplexArray:
        return self.normal_at(self.phi)

    @property
    def turning(self) -> FloatArray:
        """Angular velocity of the face, by the way its normal goes."""
        return np.asarray(np.imag(slope(self.normal_at, self.phi) / self.normal))

    @property
    def of_face(self) -> ComplexArray:
        """Velocity of the face's own point at the contact."""
        follower = self.made.cam.follower
        if isinstance(follower, OscillatingFlat):
            return np.asarray(1j * self.turning * (self.contact(self.phi) - follower.pivot))
        lift = slope(lambda x: self.made.cam.drive.motion.jet(x)[0], self.phi)
        return np.asarray(lift * follower.reach * self.normal)

    @property
    def slip(self) -> ComplexArray:
        """Of the face on the cam; it has to lie along the face.

        The turning is a difference of a difference, and the lever about the pivot, up to 100 mm,
        is some three times what slides.
        """
        found = self.of_face - 1j * self.made.cam.rotation * self.contact(self.phi)
        assert np.max(np.abs(along(self.normal, found))) <= 10.0 * DIFFERENCE * np.max(
            np.abs(found)
        )
        return np.asarray(found)

    def push(self, coefficient: float) -> ComplexArray:
        """Force of the cam on the face per unit of normal force."""
        return np.asarray(self.normal - coefficient * self.slip / np.abs(self.slip))


def on_pivot(made: Design, phi: FloatArray) -> ComplexArray:
    """(n,) weight and d'Alembert's force of the rocker, which load its pivot."""
    timed = in_time(made.cam.drive.motion.jet(phi), made.drive.time_course, phi)  # type: ignore[arg-type]  # the scene has a speed
    follower = made.cam.follower
    assert isinstance(follower, OscillatingFlat)
    swing = follower.swing_sense
    centre = (complex(-35.0, 62.0) - follower.pivot) * np.exp(1j * swing * timed[0])
    acceleration = (1j * swing * timed[2] - timed[1] ** 2) * centre
    return np.asarray(0.6e-3 * (pull(-75.0) - acceleration))


def by_newton(made: Design, table: dict[str, float], phi: FloatArray) -> FloatArray:
    """(n,) the normal force, from the balance of forces and moments on the follower.

    Which way reactions act is not known before: all signs are tried, and those that the answer
    keeps are it.
    """
    at, speed = Bodies(made, phi), omega(made)
    timed = in_time(made.cam.drive.motion.jet(phi), made.drive.time_course, phi)  # type: ignore[arg-type]  # the scene has a speed
    moving = np.sign(np.where(np.abs(timed[1]) > 1e-9 * speed, timed[1], 0.0))
    push, place, follower = at.push(table["face"]), at.contact(phi), made.cam.follower
    if isinstance(follower, OscillatingFlat):
        swing = follower.swing_sense
        centre = complex(-35.0, 62.0) - follower.pivot
        centre = centre * np.exp(1j * swing * timed[0])
        weight = 0.6e-3 * np.imag(np.conj(centre) * pull(-75.0))
        spring = 9e3 + 60e3 * timed[0]
        drag = 0.05e3 * timed[1]
        # The load is taken against a growing lift, and the spring closes the contact.
        needed = swing * 2.0 * timed[2] - weight + swing * (spring + drag + 0.8e3)
        lever = np.imag(np.conj(place - follower.pivot) * push)
        pin = 0.5 * table["pivot"] * table["pivot_diameter"] * swing * moving
        other = on_pivot(made, phi)

        def left(n: float, k: int) -> float:
            return float(n * lever[k] - pin[k] * abs(n * push[k] + other[k]) - needed[k])

        return np.array([brentq(left, 0.0, 1e5, (k,), 1e-11) for k in range(len(phi))])
    assert isinstance(follower, TranslatingFlat)
    out = np.exp(1j * follower.guide_angle)
    right = -1j * out
    own = 0.9e-3 * along(out, pull(-60.0)) - 30.0 - (150.0 + 12.0 * timed[0])
    needed = 0.9e-3 * timed[2] - own + table["guide_viscous"] * timed[1]
    height, beside = along(out, place), along(right, place) - table["guide_offset"]
    near = 30.0 + table["guide_overhang"]  # of the guide, which does not move
    far = near + table["guide_length"]
    found = np.zeros(len(phi))
    for k in range(len(phi)):
        ahead, aside = along(out, push[k]), along(right, push[k])
        weight = 0.9e-3 * along(right, pull(-60.0))
        for first, second in itertools.product((1.0, -1.0), repeat=2):
            drag = -table["guide"] * moving[k]
            rows = np.array([
                [ahead, drag * first, drag * second],
                [aside, 1.0, 1.0],
                [beside[k] * ahead - height[k] * aside, -near, -far],
            ])  # fmt: skip
            size, r1, r2 = np.linalg.solve(rows, [needed[k], -weight, height[k] * weight])
            if first * r1 >= 0.0 and second * r2 >= 0.0:
                found[k] = size
                break
        else:
            pytest.fail("no answer keeps its signs")
    return found


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("scene", CASES)
def test_newton_with_a_sliding_face(scene: str, turned: bool) -> None:
    """Normal force by Newton's law, and the torque as the moment of the force on the cam."""
    forces, table = CASES[scene]
    made = made_of(scene, forces + friction(table) + TELLING, turned)
    phi = inside(made)
    normal = made.effect("contact-force").normal(phi, "right")
    agreed = by_newton(made, table, phi)
    assert np.min(agreed) > 0.0
    # The normal is a difference here, and levers magnify it by a few.
    assert np.max(np.abs(normal - agreed)) <= 10.0 * DIFFERENCE * np.max(agreed)
    at = Bodies(made, phi)
    moment = np.imag(np.conj(at.contact(phi)) * normal * at.push(table["face"]))
    torque = made.effect("drive-torque").torque(phi, "right")
    scale = np.max(normal) * np.max(np.abs(at.contact(phi)))
    assert np.max(np.abs(torque - made.cam.rotation * moment)) <= DIFFERENCE * scale


@pytest.mark.parametrize("scene", CASES)
def test_power_of_the_drive_goes_into_energies_the_load_and_losses(scene: str) -> None:
    """T = dE/dphi + load + losses at every angle, and the face takes a good share of it."""
    forces, table = CASES[scene]
    made = made_of(scene, forces + friction(table) + TELLING)
    phi, speed = inside(made), omega(made)
    normal = made.effect("contact-force").normal(phi, "right")
    torque = made.effect("drive-torque").torque(phi, "right")
    at, follower = Bodies(made, phi), made.cam.follower
    rate = made.cam.drive.motion.jet(phi)[1]
    rubbed = table["face"] * normal * np.abs(at.slip)

    def lift(x: FloatArray) -> FloatArray:
        return np.asarray(made.cam.drive.motion.jet(x)[0])

    if isinstance(follower, OscillatingFlat):

        def stored(x: FloatArray) -> FloatArray:
            swing, moved = follower.swing_sense * lift(x), slope(lift, x) * speed
            centre = (complex(-35.0, 62.0) - follower.pivot) * np.exp(1j * swing)
            weight = -0.6e-3 * along(pull(-75.0), centre)
            spring = (9e3 + 60e3 * lift(x)) ** 2 / (2.0 * 60e3)
            return np.asarray(0.5 * 2.0 * moved**2 + weight + spring)

        load = 0.8e3 * rate
        held = np.abs(normal * at.push(table["face"]) + on_pivot(made, phi))
        rest = 0.5 * table["pivot"] * table["pivot_diameter"] * held * np.abs(rate)
        rest = rest + 1e3 * table["pivot_viscous"] * speed * rate**2
    else:
        out = np.exp(1j * math.radians(70.0))

        def stored(x: FloatArray) -> FloatArray:
            moved = slope(lift, x) * speed
            weight = -0.9e-3 * along(pull(-60.0), out) * lift(x)
            return np.asarray(0.5 * 0.9e-3 * moved**2 + weight + (150 + 12 * lift(x)) ** 2 / 24)

        load = 30.0 * rate
        rest = table["guide_viscous"] * speed * rate**2 + table["guide"] * np.abs(rate) * _held(
            made, table, phi, normal
        )
    losses = rubbed + rest
    scale = np.max(np.abs(torque)) + np.ptp(stored(phi))
    assert np.max(np.abs(torque - (slope(stored, phi) + load + losses))) <= DIFFERENCE * scale
    # In a rest the face rubs all the same, and nothing else takes power.
    rests = np.abs(rate) == 0.0
    assert np.any(rests)
    assert np.allclose(torque[rests], rubbed[rests], rtol=1e-8)
    assert np.min(rubbed) > 0.0


def _held(made: Design, table: dict[str, float], phi: FloatArray, normal: FloatArray) -> FloatArray:
    """Sum of both reactions of the guide, as of a beam on two supports."""
    at = Bodies(made, phi)
    out = np.exp(1j * math.radians(70.0))
    load, place = normal * at.push(table["face"]), at.contact(phi)
    near = 30.0 + table["guide_overhang"]
    beside = along(-1j * out, place) - table["guide_offset"]
    turning = beside * along(out, load) - along(out, place) * along(-1j * out, load)
    weight = 0.9e-3 * along(-1j * out, pull(-60.0))
    turning = turning - along(out, place) * weight
    across = along(-1j * out, load) + weight
    far = (turning + near * across) / table["guide_length"]
    return np.asarray(np.abs(far) + np.abs(far + across))


LINKED: Final = """
[effects.inertia]
mass = 2
coupler_mass = 0.4
[effects.gravity]
[effects.spring]
stiffness = 3
preload = 400
[effects.friction]
face = 0.1
pivot = 0.1
pivot_diameter = 20
slider = 5
[effects.drive-torque]
[effects.reactions]
"""


def test_work_of_a_linked_rocker_over_a_turn_is_lost_by_friction() -> None:
    """Masses, weights and the spring behind the linkage give back all that they take."""
    text = template("oscillating-flat")
    for old, new in (
        ("\n[[motion]]", f"{LINKAGE}\n[[motion]]"), ('direction = "outward"', "#"),
        ("to = 12", "to = 4"), ("base_radius = 45", "base_radius = 55"),
        ("face_offset = 6", "face_offset = 16"), ("\n[output]", f"{LINKED}\n[output]"),
    ):  # fmt: skip
        assert old in text
        text = text.replace(old, new, 1)
    made = Design(parse_scene(text))
    contact, drive = made.effect("contact-force"), made.effect("drive-torque")
    bodies = made.effect("reactions").bodies

    def lost(phi: FloatArray, side: Side) -> FloatArray:
        jet = made.cam.drive.motion.jet(phi, side)
        follower = made.cam.follower
        assert isinstance(follower, OscillatingFlat)
        height = follower.centre_distance * np.sin(follower.face_angle(jet[0])) + 16.0
        slide = np.abs(height - made.cam.rotation * 16.0 * follower.swing_sense * jet[1])
        pivot = np.abs(bodies.of_pivot(phi, side)) * np.abs(jet[1])  # mu d / 2 is 1 mm
        return np.asarray(0.1 * contact.normal(phi, side) * slide + pivot)

    work = turn_integral(drive.torque, drive.edges)
    slid = 5.0 * 2.0 * 4.0  # up and down the stroke
    assert work == pytest.approx(turn_integral(lost, drive.edges) + slid, rel=1e-11)


@pytest.mark.parametrize("scene", CASES)
def test_the_face_slides_as_its_column_says(scene: str) -> None:
    made = made_of(scene, "[effects.kinematics]")
    phi = inside(made)
    (column,) = [c for c in made.effect("kinematics").columns if c.name == "sliding velocity"]
    expected = np.abs(Bodies(made, phi).slip) * omega(made)
    found = np.abs(column.values(phi, "right"))
    assert np.max(np.abs(found - expected)) <= DIFFERENCE * np.max(expected)


@pytest.mark.parametrize("scene", CASES)
def test_at_the_speed_of_lift_off_the_force_touches_its_margin(scene: str) -> None:
    """Without friction, and with it; the speed is found from the slow scene."""
    forces, table = CASES[scene]
    effects = forces + friction(table) + TELLING + "margin = 15\n"
    slow = made_of(scene, effects, rev=10.0)
    (speed,) = [f for f in slow.effects.findings("lift-off") if f.name == "lift-off-speed"]
    assert speed.value is not None
    assert "the face first keeps less than 15 N" in speed.sentence
    for factor, sign in ((1.0, 0.0), (0.999, 1.0), (1.001, -1.0)):
        extremes = (
            made_of(scene, effects, rev=factor * speed.value).effect("contact-force").extremes
        )
        left = extremes.lowest.value - 15.0
        if sign == 0.0:
            assert abs(left) <= 1e-9 * extremes.magnitude
        else:
            assert sign * left > 0.0


def test_pressure_of_a_plane_on_the_cam() -> None:
    """p = sqrt(F E* / (pi L rho)), rho = h + h'' (Johnson, Contact Mechanics, eq. 4.45)."""
    pressing = "[effects.contact-pressure]\nwidth = 9\ncam_modulus = 206000\ncam_poisson = 0.3\n"
    pressing += "face_modulus = 110000\nface_poisson = 0.27\n"
    made = made_of("tappet", TAPPET + TELLING + pressing)
    phi = inside(made)
    normal = made.effect("contact-force").normal(phi, "right")
    jet = made.cam.drive.motion.jet(phi)
    modulus = 1.0 / ((1.0 - 0.09) / 206000.0 + (1.0 - 0.27**2) / 110000.0)
    expected = np.sqrt(normal * modulus / (math.pi * 9.0 * (30.0 + jet[0] + jet[2])))
    found = made.effect("contact-pressure").contact.pressure(phi, "right")
    assert np.allclose(found, expected, rtol=1e-12)
    rest = (
        "[effects.spring]\nstiffness = 5\npreload = 300\n[effects.contact-pressure]\nwidth = 10\n"
    )
    reported = made_of("tappet", rest).effect("contact-pressure").contact
    # In the lower rest 300 N press 10 mm of steel on steel, E* = 210000/1.82, on a circle of 30 mm:
    # sqrt(300 * 115384.615 / (pi * 10 * 30)) = 191.6457 MPa.
    assert reported.pressure(np.array([0.1]), "right")[0] == pytest.approx(191.6457, abs=5e-5)


def test_a_short_guide_jams_where_the_lever_of_the_contact_is_too_long() -> None:
    """Without friction at the face both ends bear N e / b: it jams from mu 2 e / b = 1 on."""
    scene = "[effects.spring]\nstiffness = 5\npreload = 100\n[effects.contact-force]\n"
    lever = np.max(made_of("tappet", "").cam.drive.motion.jet(np.linspace(0.0, TURN, 200001))[1])
    for factor in (0.999, 1.001):
        table = {"guide": factor * 12.0 / (2.0 * lever), "guide_length": 12.0}
        made = made_of("tappet", scene + friction(table))
        (margin,) = made.effects.findings("friction")
        if factor < 1.0:
            assert margin.severity == "warning"
            assert np.min(made.effect("contact-force").normal(np.linspace(0, 6, 99), "right")) > 0.0
        else:
            assert margin.severity == "broken"
            with pytest.raises(EffectError, match="friction absorbs the entire contact force"):
                made.effect("contact-force")


def test_a_cam_that_is_not_convex_has_no_forces() -> None:
    small = ("base_radius = 30", "base_radius = 3")
    made = design("tappet", TAPPET + friction(GUIDED) + TELLING, small)
    for name in ("friction", "contact-force", "drive-torque", "lift-off"):
        with pytest.raises(EffectError, match="a flat face touches only what is convex"):
            made.effect(name)
        *_, found = made.effects.findings(name)
        assert found.severity == "broken"


OF_ROLLER: Final = """
[effects.inertia]
roller_mass = 1
[effects.friction]
guide = 0.1
rolling = 1
[effects.contact-pressure]
roller_material = "steel"
width = 5
[effects.lift-off]
backlash = 0.1
"""

OF_FACE: Final = """
[effects.friction]
face = 0.1
[effects.contact-pressure]
face_material = "steel"
"""

REFUSED: Final = {
    "tappet": (
        OF_ROLLER,
        {
            "inertia.roller_mass", "friction.rolling", "friction.guide_length",
            "contact-pressure.roller_material", "lift-off.backlash",
        },
    ),
    "plate_translating": (OF_FACE, {"friction.face", "contact-pressure.face_material"}),
}  # fmt: skip


@pytest.mark.parametrize("scene", REFUSED)
def test_keys_of_another_follower_are_refused_at_once(scene: str) -> None:
    effects, keys = REFUSED[scene]
    with pytest.raises(SceneError) as error:
        design(scene, effects)
    assert {fault.key for fault in error.value.faults} >= {f"effects.{key}" for key in keys}


def test_a_rocker_has_no_guide_to_lie_aside() -> None:
    table = "guide_length = 3\nguide_offset = 1\n"
    for key in ("guide_length", "guide_offset"):
        assert_refused("flat_rocker", "friction", table, key, "this follower is a rocker")


def test_a_flat_rocker_has_its_own_masses_and_no_roller() -> None:
    made = made_of("flat_rocker", ROCKER)
    phi = np.linspace(0.0, TURN, 97)
    inertia: Any = made.effect("inertia")
    assert np.allclose(inertia.to_follower(phi, "right"), 2.0, rtol=1e-15)
    assert [each.name for each in inertia.masses] == ["rocker"]
    assert made.effect("gravity").findings[0].value == pytest.approx(0.6e-3 * G, rel=1e-12)
