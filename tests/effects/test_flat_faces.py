"""Effects of flat-faced followers, compared with vectors in the fixed frame.

Only places on the outline are taken from camgeo; its normal, the rotation of the rocker and all
velocities are differences of these. The forces on the follower follow from Newton's law with all
reactions.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
import pytest

from camgeo.design.design import Design
from camgeo.errors import EffectError
from camgeo.kinematics.mechanism.flat import OscillatingFlat, TranslatingFlat
from camgeo.kinematics.time_course import in_time
from camgeo.numeric.arrays import ComplexArray, FloatArray, Side
from camgeo.scene.scene import parse_scene
from camgeo.scene.toml import template
from camgeo.units import TURN
from tests.effects.bodies import (
    DIFFERENCE,
    along,
    cross,
    friction,
    inside,
    omega,
    pull,
    slope,
)
from tests.effects.scenes import course_of, design
from tests.integrals import cells, integrals
from tests.scene.test_linkages import LINKAGE

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


def left_over(
    made: Design, table: dict[str, float], at: Bodies, normal: FloatArray
) -> tuple[FloatArray, Any]:
    """(n,) what the balance of the follower leaves of the `normal` force, and the force of its
    pivot or those of both ends of its guide, which keep the other balances.
    """
    timed = in_time(made.cam.drive.motion.jet(at.phi), course_of(made), at.phi)
    moving = np.sign(np.where(np.abs(timed[1]) > 1e-9 * omega(made), timed[1], 0.0))
    push, place = normal * at.push(table["face"]), at.contact(at.phi)
    follower = made.cam.follower
    if isinstance(follower, OscillatingFlat):
        swing = follower.swing_sense
        centre = (complex(-35.0, 62.0) - follower.pivot) * np.exp(1j * swing * timed[0])
        bent = (1j * swing * timed[2] - timed[1] ** 2) * centre
        held = 0.6e-3 * (bent - pull(-75.0)) - push
        # The load is taken against a growing lift, and the spring closes the contact.
        needed = 2.0 * timed[2] - swing * cross(centre, 0.6e-3 * pull(-75.0))
        needed = needed + 9e3 + 60e3 * timed[0] + 0.05e3 * timed[1] + 0.8e3
        lost = 0.5 * table["pivot"] * table["pivot_diameter"] * np.abs(held) * moving
        return swing * cross(place - follower.pivot, push) - lost - needed, held
    assert isinstance(follower, TranslatingFlat)
    out, weight = np.exp(1j * follower.guide_angle), 0.9e-3 * pull(-60.0)
    height, beside = along(out, place), along(-1j * out, place) - table["guide_offset"]
    near = 30.0 + table["guide_overhang"]  # of the guide, which does not move
    rows = np.array([[1.0, 1.0], [-near, -near - table["guide_length"]]])
    side = along(-1j * out, push + weight)
    ends = np.linalg.solve(rows, np.stack((-side, height * side - beside * along(out, push))))
    lost = table["guide"] * np.sum(np.abs(ends), axis=0) * moving
    needed = 0.9e-3 * timed[2] - along(out, weight) + 30.0 + 150.0 + 12.0 * timed[0]
    return along(out, push) - lost - needed - table["guide_viscous"] * timed[1], ends


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("scene", CASES)
def test_newton_with_a_sliding_face(scene: str, turned: bool) -> None:
    """Normal force and reactions by Newton's law, the torque as the moment of the force on the
    cam.
    """
    forces, table = CASES[scene]
    made = made_of(scene, forces + friction(table) + TELLING + "[effects.reactions]", turned)
    phi, bodies = inside(made), made.effect("reactions").bodies
    at, normal = Bodies(made, phi), made.effect("contact-force").normal(phi, "right")
    assert np.min(normal) > 0.0
    left, held = left_over(made, table, at, normal)
    push = normal * at.push(table["face"])
    # The normal is a difference here, and levers magnify it by a few.
    reach = np.max(np.abs(at.contact(phi)))
    size = np.max(normal) * (1.0 if made.cam.lift_unit == "mm" else reach)
    assert np.max(np.abs(left)) <= 10.0 * DIFFERENCE * size
    of_bearing = bodies.of_guide if made.cam.lift_unit == "mm" else bodies.of_pivot
    assert np.max(np.abs(of_bearing(phi, "right") - held)) <= 10.0 * DIFFERENCE * np.max(normal)
    assert np.max(np.abs(bodies.of_cam(phi, "right") - push)) <= DIFFERENCE * np.max(normal)
    torque = made.effect("drive-torque").torque(phi, "right")
    moment = made.cam.rotation * cross(at.contact(phi), push)
    assert np.max(np.abs(torque - moment)) <= DIFFERENCE * np.max(normal) * reach
    # In a rest the face rubs all the same, and nothing else takes power.
    rests = made.cam.drive.motion.jet(phi)[1] == 0.0
    assert np.any(rests)
    rubbed = table["face"] * normal * np.abs(at.slip)
    assert np.allclose(torque[rests], rubbed[rests], rtol=1e-8)


def test_a_guide_of_no_stated_length_has_one_force_and_a_moment() -> None:
    """The contact of the face lies aside of the guide's axis."""
    made = made_of("tappet", f"{TAPPET}[effects.reactions]")
    phi, result = inside(made), made.effect("reactions")
    at, normal = Bodies(made, phi), made.effect("contact-force").normal(phi, "right")
    out = np.exp(1j * made.cam.follower.guide_angle)  # type: ignore[attr-defined]  # it has a guide
    held = -along(-1j * out, 0.9e-3 * pull(-60.0))
    assert np.max(np.abs(result.bodies.of_guide(phi, "right")[0] - held)) <= 1e-12 * np.max(normal)
    told = {each.name: each.values(phi, "right") for each in result.columns}
    moment = normal * along(-1j * out, at.contact(phi))
    assert np.max(np.abs(1e3 * told["guide moment"] - moment)) <= 1e-9 * np.max(np.abs(moment))


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
        follower: Any = made.cam.follower
        height = follower.centre_distance * np.sin(follower.face_angle(jet[0])) + 16.0
        slide = np.abs(height - made.cam.rotation * 16.0 * follower.swing_sense * jet[1])
        pivot = np.abs(bodies.of_pivot(phi, side)) * np.abs(jet[1])  # mu d / 2 is 1 mm
        return np.asarray(0.1 * contact.normal(phi, side) * slide + pivot)

    low, high = cells(drive.edges[:-1], 16)

    def over_turn(of: Any) -> float:
        return float(np.sum(integrals(lambda phi: of(phi, "right"), low, high)))

    slid = 5.0 * 2.0 * 4.0  # up and down the stroke
    assert over_turn(drive.torque) == pytest.approx(over_turn(lost) + slid, rel=1e-11)


@pytest.mark.parametrize("scene", CASES)
def test_the_face_slides_as_its_column_says(scene: str) -> None:
    made = made_of(scene, "[effects.kinematics]")
    phi = inside(made)
    (column,) = [c for c in made.effect("kinematics").columns if c.name == "sliding velocity"]
    expected = np.abs(Bodies(made, phi).slip) * omega(made)
    found = np.abs(column.values(phi, "right"))
    assert np.max(np.abs(found - expected)) <= DIFFERENCE * np.max(expected)


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
