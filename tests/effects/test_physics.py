"""Effects together, compared with an independent formulation of the mechanics.

Energies come from places and lengths alone, and their rates from differences; losses from the
velocities of bodies in the fixed frame; forces from Newton's law, with the guide's reactions those
of a beam on two supports. Reactions are sums of forces and moments on the free bodies.
"""

from __future__ import annotations

import math
import re
import tomllib
from dataclasses import dataclass
from pathlib import Path
from random import Random
from typing import Any, Final, cast

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from camgeo.design.design import Design
from camgeo.dynamics.effects.contact import INNER, OUTER, carrier, sliding
from camgeo.dynamics.effects.forces import at_rates, cam_rates
from camgeo.errors import EffectError, GeometryError, SceneError
from camgeo.kinematics.mechanism.flat import OscillatingFlat, TranslatingFlat
from camgeo.kinematics.mechanism.rollers import TranslatingRoller
from camgeo.kinematics.time_course import in_time
from camgeo.numeric.arrays import ComplexArray, FloatArray, Side
from camgeo.scene.scene import parse_scene
from camgeo.scene.toml import template
from camgeo.units import TURN
from tests.effects.bodies import (
    DIFFERENCE,
    GUIDE,
    PIVOT,
    PLATE,
    ROLLER,
    ROUNDING,
    Bodies,
    along,
    cross,
    friction,
    inside,
    omega,
    pull,
    slope,
    speed_of,
)
from tests.effects.scenes import course_of, design
from tests.effects.test_pins import LINKED, drawn
from tests.findings import finding
from tests.integrals import cells, integrals
from tests.long_form import examples
from tests.scene.test_linkages import LINKAGE

MASSES_OF_ROCKER: Final = """
[effects.inertia]
moment_of_inertia = 0.012
roller_mass = 0.15
rocker_mass = 0.9
rocker_centre = [70, 30]
[effects.gravity]
angle = -75
"""

ROCKER: Final = f"""{MASSES_OF_ROCKER}
[effects.spring]
kind = "torsion"
torsional_stiffness = 40
preload_torque = 30
[effects.load]
constant = 1.5
"""

BEHIND_LINKAGE: Final = """
[effects.inertia]
mass = 1.2
moment_of_inertia = 0.004
roller_mass = 0.06
coupler_mass = 0.3
coupler_centre = 0.4
[effects.gravity]
angle = -110
[effects.spring]
stiffness = 3
preload = 480
[effects.load]
constant = 15
"""

TELLING: Final = """
[effects.contact-force]
[effects.lift-off]
[effects.drive-torque]
"""


@pytest.mark.parametrize("scene", ["plate_translating", "shuttle", "setzhub", "points", "ring"])
def test_conservative_torque_does_no_work_over_a_turn(scene: str) -> None:
    """Masses, weights and springs give back all that they take; with a speed curve as well."""
    forces = {"shuttle": ROCKER, "setzhub": BEHIND_LINKAGE}.get(scene, PLATE)
    changes = [speed_of(scene, 90.0)] if scene != "points" else []
    made = design(scene, forces + TELLING, *changes)
    drive = made.effect("drive-torque")
    low, high = cells(made.drive.smooth_angles[:-1], 16)
    work = np.sum(integrals(lambda phi: drive.torque(phi, "right"), low, high))
    peak = np.max(np.abs(drive.torque(np.linspace(0.0, TURN, 2001), "right")))
    assert peak > 0.0
    assert abs(work) <= ROUNDING * peak


MIRRORS: Final[dict[str, list[tuple[str, str]]]] = {
    "plate_translating": [('"ccw"', '"cw"'), ("offset = 12", "offset = -12")],
    "ring": [('rotation = "ccw"', 'rotation = "cw"'), ("guide_angle = 0", "guide_angle = 180")],
    "shuttle": [('"cw"', '"ccw"'), ("pivot = [110, 0]", 'pivot = [-110, 0]\narm_side = "cw"')],
    "groove": [
        ('rotation = "cw"', 'rotation = "ccw"'),
        ("pivot = [-96, -72]", "pivot = [96, -72]"),
        ('arm_side = "ccw"', 'arm_side = "cw"'),
        ("depth = 3.3 }", "depth = 3.3, angle = 180 }"),
    ],
}


@pytest.mark.parametrize("scene", MIRRORS)
def test_a_scene_and_its_mirror_image_have_the_same_forces(scene: str) -> None:
    """All columns of all effects, mirrored in the y axis, weights and centres too."""
    rocks = scene in ("shuttle", "groove")
    forces, table = (ROCKER, PIVOT) if rocks else (PLATE, GUIDE)
    effects = (
        f"{forces}{friction({**ROLLER, **table})}{TELLING}"
        "[effects.contact-pressure]\nwidth = 5\n[effects.kinematics]\n[effects.balance]\n"
        "[effects.vibration]\nnatural_frequency = 47\ndamping = 0.07\n"
    )
    mirrored = (
        effects.replace("angle = -60", "angle = -120")
        .replace("angle = -75", "angle = -105")
        .replace("rocker_centre = [70, 30]", "rocker_centre = [-70, 30]")
    )
    speed = [("[follower]\n", "speed = 90\n[follower]\n")] if scene == "ring" else []
    one = design(scene, effects, *speed)
    other = design(scene, mirrored, *speed, *MIRRORS[scene])
    phi = np.linspace(0.0, TURN, 333, endpoint=False) + 0.003
    pairs = list(zip(one.disc.columns(), other.disc.columns(), strict=True))
    assert len(pairs) >= 15
    for here, there in pairs:
        assert here.name == there.name
        first, second = here.values(phi, "right"), there.values(phi, "right")
        if here.name == "unbalance force x":
            second = -second
        scale = np.max(np.abs(first))
        # The outline is integrated to 1e-9 of what the disc weighs; all else is rounded.
        near = 1e-6 if here.name.startswith("unbalance") else 1e3 * ROUNDING
        assert np.max(np.abs(first - second)) <= near * scale, here.name


# Reactions: sums of forces and moments on the free bodies -----------------------------------------
PRESSED_ROCKER: Final = f"""{MASSES_OF_ROCKER}
[effects.spring]
kind = "compression"
stiffness = 6
preload = 900
anchor = [30, -60]
attachment = [60, 30]
[effects.load]
constant = 1.5
[effects.friction]
rolling = 0.2
pivot = 0.11
pivot_diameter = 22
pivot_viscous = 0.8
[effects.reactions]
"""


@pytest.mark.parametrize("rev", [30.0, 400.0])
def test_a_rocker_moves_as_all_that_acts_on_it(rev: float) -> None:
    """Forces on its masses give that of the pivot, and their moments about it leave nothing: of
    the cam, the spring, the weights, the load, the damper and the friction of the bearing.
    """
    made = design("shuttle", PRESSED_ROCKER, speed_of("shuttle", rev))
    bodies, speed, phi = made.effect("reactions").bodies, omega(made), inside(made)
    follower: Any = made.cam.follower
    pivot, swing, jet = follower.pivot, follower.swing_sense, made.cam.drive.motion.jet(phi)
    turn, rate = np.exp(1j * swing * jet[0]), swing * jet[1] * speed
    bent = 1j * swing * jet[2] * speed**2 - rate**2
    rocker, roller, end = (
        arm * turn for arm in (70.0 + 30.0j - pivot, follower.start_arm, 60.0 + 30.0j - pivot)
    )
    line = pivot + end - (30.0 - 60.0j)
    pressed = 900.0 - 6.0 * (np.abs(line) - abs(60.0 + 30.0j - (30.0 - 60.0j)))
    spring, cam = pressed * line / np.abs(line), bodies.of_cam(phi, "right")
    masses = 0.9e-3 * rocker + 0.15e-3 * roller
    held = bent * masses - 1.05e-3 * pull(-75.0) - spring - cam
    found = bodies.of_pivot(phi, "right")
    assert np.max(np.abs(found - held)) <= 10.0 * ROUNDING * np.max(np.abs(held))
    drag = np.sign(rate) * 0.5 * 0.11 * 22.0 * np.abs(found)
    couples = -1.5e3 * swing - 0.8e3 * rate - drag
    moments = cross(roller, cam) + cross(end, spring) + cross(masses, pull(-75.0)) + couples
    turned = (12.0 + 0.15e-3 * abs(follower.start_arm) ** 2) * swing * jet[2] * speed**2
    assert np.max(np.abs(moments - turned)) <= 1e3 * ROUNDING * np.max(np.abs(found))


@pytest.mark.parametrize("rev", [20.0, 200.0])
@pytest.mark.parametrize("way", ["ccw", "cw"])
def test_newton_in_a_guide_with_friction(way: str, rev: float) -> None:
    """Balance along the guide; across it, it is a beam on two supports under the force of the cam,
    the weight and the roller's bearing.
    """
    turned = [('"ccw"', '"cw"')] if way == "cw" else []
    table = {**GUIDE, **ROLLER, "guide_viscous": 0.0}
    text = PLATE + friction(table) + "\n[effects.reactions]"
    made = design("plate_translating", text, speed_of("plate_translating", rev), *turned)
    phi, follower = inside(made), cast(TranslatingRoller, made.cam.follower)
    reactions = made.effect("reactions")
    at = Bodies(made.cam, phi, made.effect("contact-force").normal(phi, "right"))
    out, weight = np.exp(1j * follower.guide_angle), 1.3e-3 * pull(-60.0)
    wanted, largest = at.guide_reactions(table, weight), np.max(np.abs(at.normal))
    timed = in_time(made.cam.drive.motion.jet(phi), course_of(made), phi)
    drag = table["guide"] * np.sum(np.abs(wanted), axis=0)
    drag *= np.sign(np.where(np.abs(timed[1]) > 1e-9, timed[1], 0.0))
    pressed = along(out, at.load(table) + weight) - 25.0 - (160.0 + 2.5 * timed[0]) - drag
    assert np.max(np.abs(pressed - 1.3e-3 * timed[2])) <= 10.0 * ROUNDING * largest
    off = reactions.bodies.of_cam(phi, "right") - at.load(table)
    assert np.max(np.abs(off)) <= 10.0 * ROUNDING * largest
    found = reactions.bodies.of_guide(phi, "right")
    assert np.max(np.abs(found - wanted)) <= 10.0 * ROUNDING * np.max(np.abs(wanted))
    for name, force in zip(("near", "far"), found, strict=True):
        told = finding(reactions.findings, f"largest-{name}-end-force")
        assert told.value >= np.max(np.abs(force)) * (1.0 - 1e-12)
        assert told.value == pytest.approx(np.max(np.abs(force)), rel=0.02)


MADE: Final = """
[effects.gravity]
angle = -50
[effects.inertia]
mass = 1.1
[effects.load]
constant = 60
[effects.balance]
material = "steel"
[effects.reactions]
bearings = [-35, 80]
"""


def test_bearings_of_the_camshaft_carry_the_disc_too() -> None:
    """Its centre of mass from `balance`, accelerated in a circle; moments about either bearing."""
    made = design("plate_translating", MADE, speed_of("plate_translating", 900.0))
    reactions, balance = made.effect("reactions"), made.effect("balance")
    phi = inside(made)
    turned = balance.centre * np.exp(1j * made.cam.rotation * phi)
    whole = balance.mass * (pull(-50.0) + omega(made) ** 2 * turned)
    whole = whole - reactions.bodies.of_cam(phi, "right")
    columns = {each.name: each.values(phi, "right") for each in reactions.columns}
    size = float(np.max(np.abs(whole)))
    assert np.max(np.abs(balance.mass * omega(made) ** 2 * turned)) > 0.05 * size
    bound = reactions.errors["camshaft load"].error
    assert 0.0 < bound <= 1e-6 * size
    allowed = bound + balance.unbalance_error * omega(made) ** 2 + 1e-6 * balance.mass * 9806.65
    found = columns["camshaft load"]
    assert np.max(np.abs(found - np.abs(whole))) <= allowed
    rows = np.array([[1.0, 1.0], [-35.0, 80.0]])  # sums of forces, and of moments about the disc
    shares = np.linalg.solve(rows, [1.0, 0.0])
    for name, share in zip(("first", "second"), shares, strict=True):
        assert columns[f"{name} bearing load"] == pytest.approx(abs(share) * found, rel=1e-13)
        assert reactions.errors[f"largest-{name}-bearing-load"].error <= bound


def test_a_disc_of_unknown_material_has_no_weight() -> None:
    tables = MADE.replace('[effects.balance]\nmaterial = "steel"\n', "")
    made = design("plate_translating", tables, speed_of("plate_translating", 900.0))
    reactions, phi = made.effect("reactions"), inside(made)
    (load,) = (each for each in reactions.columns if each.name == "camshaft load")
    assert np.all(load.values(phi, "right") == np.abs(reactions.bodies.of_cam(phi, "right")))
    assert not reactions.errors


# Power of the camshaft ----------------------------------------------------------------------------
# Against that of all forces and each loss, at any cam angle. Every loss is a reaction times the
# velocity with which its parts rub, and none is the rest of the sum: the bearing of the roller and
# the rolling on the flank, a face on its cam, the pivot under its whole force, both ends of a
# guide. By the principle of virtual work (Norton, Cam Design and Manufacturing Handbook, chapters
# on dynamics) the camshaft provides the sum.

FIXTURES: Final = [
    path
    for path in sorted((Path(__file__).parents[2] / "fixtures" / "effects").glob("*.toml"))
    if any(
        f"[effects.{force}]" in path.read_text("utf-8")
        for force in ("inertia", "gravity", "load", "spring")
    )
]
"""All scenes of effects that have a contact force."""

REST: Final = 1e-12
"""Largest residual of the balance, as a share of the largest power at any of the angles."""

STATED: Final = ("roller_pin", "rolling", "face", "pivot", "guide")


def rubbing(made: Design, table: dict[str, Any], phi: FloatArray) -> dict[str, FloatArray]:
    """(n,) power of each Coulomb loss by its name [N mm/s]."""
    bodies: Any = made.effect("reactions").bodies
    subject, contact = bodies.subject, bodies.contact
    omega = cam_rates(subject, phi, "right")[0]
    normal = contact.normal(phi, "right")
    follower, rotation = subject.cam.follower, subject.cam.rotation
    found = {name: np.zeros(len(phi)) for name in STATED}
    for sense, here in ((INNER, normal >= 0.0), (OUTER, normal < 0.0)):
        if not np.any(here):
            continue
        disc, flank = carrier(subject, sense)
        relative = disc.state.curve.relative_jet(phi[here], "right", order=1)
        pace = np.hypot(relative.along[1], relative.across[1])
        force = np.abs(normal[here]) * omega[here]
        if disc.cam.follower.roller_radius > 0.0:
            on_cam = -flank * rotation * pace / disc.cam.follower.roller_radius
            on_pin = rotation + on_cam - relative.turning
            radius = 0.5 * table.get("roller_pin_diameter", 0.0)
            found["roller_pin"][here] = (
                table.get("roller_pin", 0.0) * radius * force * np.abs(on_pin)
            )
            found["rolling"][here] = table.get("rolling", 0.0) * force * np.abs(on_cam)
        if table.get("face", 0.0):
            slip = sliding(disc, phi[here], "right")
            found["face"][here] = table["face"] * force * np.abs(slip)
    speed = np.abs(subject.state.motion.jet(phi, "right", 1)[1]) * omega
    if follower.pivot is not None:
        lever = 0.5 * table.get("pivot", 0.0) * table.get("pivot_diameter", 0.0)
        found["pivot"] = lever * np.abs(bodies.of_pivot(phi, "right")) * speed
    else:
        ends = np.abs(bodies.of_guide(phi, "right"))
        found["guide"] = table.get("guide", 0.0) * np.sum(ends, axis=0) * speed
    return found


def powers(made: Design, table: dict[str, Any], phi: FloatArray) -> tuple[Any, dict[str, Any]]:
    """(n,) power of the camshaft, and what each force and each loss takes of it [N mm/s]."""
    result: Any = made.effect("drive-torque")
    subject: Any = made.effect("reactions").bodies.subject
    rates = cam_rates(subject, phi, "right")
    rate = subject.state.motion.jet(phi, "right", 1)[1] * rates[0]
    taken = {
        each.name: -at_rates(each.coefficients(phi, "right"), rates) * rate
        for each in result.contact.forces
    }
    behind = result.contact.behind
    if behind is not None and behind.load is not None:  # it moves with the output, not the base
        pressed = behind.load.coefficients(phi, "right")[0]
        time = subject.state.course.time
        beyond = pressed * behind.response.states(time(phi) - time(np.zeros(1)), "right")[1]
        taken["load"] -= beyond
        taken["the elastic train"] += beyond
    return result.torque(phi, "right") * rates[0], {**taken, **rubbing(made, table, phi)}


def assert_told(made: Design, given: Any, taken: dict[str, Any], phi: FloatArray) -> None:
    """The columns of the effect are these powers."""
    told = {
        each.name: 1e3 * each.values(phi, "right") for each in made.effect("power-balance").columns
    }
    contact = sum(taken[name] for name in ("roller_pin", "rolling", "face"))
    own = {"drive power": given, **{f"power into {name}": each for name, each in taken.items()}}
    own |= {f"power lost {place}": contact for place in ("at the roller", "at the face")}
    own |= {f"power lost in the {name}": taken[name] for name in ("pivot", "guide")}
    largest = max(float(np.max(np.abs(each))) for each in (given, *taken.values()))
    for name, values in told.items():
        assert np.max(np.abs(values - own[name])) <= REST * largest, name
    whole = sum(each for name, each in told.items() if name != "drive power")
    assert np.max(np.abs(told["drive power"] - whole)) <= REST * largest


def assert_zero(given: Any, taken: dict[str, Any]) -> None:
    """Nothing is left of the power `given`; losses are never negative."""
    assert all(np.all(taken[name] >= 0.0) for name in STATED)
    largest = max(float(np.max(np.abs(each))) for each in (given, *taken.values()))
    assert np.max(np.abs(given - sum(taken.values()))) <= REST * largest


def scene_with(text: str, *effects: str) -> str:
    """The scene with these effects, as empty tables where it does not have them."""
    named = tomllib.loads(text).get("effects", {})
    return text + "".join(f"\n[effects.{each}]\n" for each in effects if each not in named)


@pytest.mark.parametrize("path", FIXTURES, ids=lambda each: each.stem)
def test_the_power_of_the_camshaft_is_that_of_all_forces_and_losses(path: Path) -> None:
    text = scene_with(
        path.read_text("utf-8"), "contact-force", "drive-torque", "reactions", "power-balance"
    )
    phi = np.random.default_rng(7).uniform(0.0, TURN, 200)
    made = Design(parse_scene(text, str(path)))
    table = tomllib.loads(text)["effects"].get("friction", {})
    given, taken = powers(made, table, phi)
    assert_zero(given, taken)
    assert_told(made, given, taken, phi)
    for name in STATED:
        assert np.any(taken[name] > 0.0) == bool(table.get(name, 0.0)), name


def varied(rng: Random) -> str:
    """A scene of effects or a linked one with other masses, forces, friction and speed."""
    name = rng.choice([*LINKED, *(path.stem for path in FIXTURES)])
    if name in LINKED:
        return drawn(rng, name, rubbing=True)[0].replace("[effects.drive-torque]", "")
    text = (FIXTURES[0].parent / f"{name}.toml").read_text("utf-8")
    head, *tables = re.split(r"\n(?=\[effects|\[state|\[output)", text)
    kept = ("inertia", "gravity", "load", "spring", "friction")
    tables = [each for each in tables if each.startswith(tuple(f"[effects.{one}]" for one in kept))]

    def other(found: re.Match[str]) -> str:
        return f"{found[1]}{float(found[2]) * rng.uniform(0.3, 1.5):.6g}"

    numbers = r"(?m)^((?:mass|roller_mass|preload|constant|guide|pivot|face|roller_pin|rolling|"
    numbers += r"(?:guide|pivot)_viscous|angle|torsional_stiffness) = )(-?[0-9.]+)"
    changed = [re.sub(numbers, other, each) for each in tables]
    return "\n".join((re.sub(r"(?m)^(speed = )([0-9.]+)", other, head), *changed)) + "\n"


@settings(max_examples=examples(4, long=300), deadline=None)
@given(st.randoms(use_true_random=False))
def test_the_balance_of_random_mechanisms(rng: Random) -> None:
    text = scene_with(varied(rng), "contact-force", "drive-torque", "reactions")
    phi = np.random.default_rng(3).uniform(0.0, TURN, 100)
    try:
        made = Design(parse_scene(text, str(FIXTURES[0])))
        given, taken = powers(made, tomllib.loads(text)["effects"].get("friction", {}), phi)
    except (EffectError, GeometryError, SceneError):
        return  # a few followers jam
    assert_zero(given, taken)


LEVER: Final = (Path(__file__).parents[2] / "fixtures/effects/lever.toml").read_text("utf-8")


RIGID: Final = re.sub(r"\[effects\.vibration\][^\[]*", "", LEVER)
"""Without its train, which a load deflects."""


def found_of(text: str) -> dict[str, float]:
    """Values of the findings of `power-balance` by their names."""
    made = Design(parse_scene(scene_with(text, "power-balance"), "lever.toml"))
    found = made.effects.findings("power-balance")
    return {each.name: each.value for each in found if each.value is not None}


def test_the_efficiency_is_the_share_of_the_load() -> None:
    """A constant torque Q against a rise by h takes Q h whatever the law: without friction all that
    the drive provides.
    """
    load = "\n[effects.load]\nsegments = [0, 40, 0, 0]\n"
    none = RIGID.replace("[effects.friction]\npivot = 0.1\npivot_diameter = 20\n", "")
    assert len(none) < len(RIGID) < len(LEVER)
    smooth, rough = found_of(none + load), found_of(RIGID + load)
    for found in (smooth, rough):
        assert found["work-load"] == pytest.approx(40.0 * math.radians(16.0), rel=1e-6)
    assert smooth["efficiency"] == pytest.approx(1.0, rel=2e-6)
    lost = sum(rough[name] for name in rough if name.endswith("-friction"))
    share = rough["work-load"] / (rough["work-load"] + lost)
    assert rough["efficiency"] == pytest.approx(share, rel=4e-6)


# Flat faces ---------------------------------------------------------------------------------------
# Only places on the outline are taken from camgeo; its normal, the rotation of the rocker and all
# velocities are differences of these. The forces on the follower follow from Newton's law with all
# reactions.


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

FACED_ROCKER: Final = """
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

CASES: Final = {
    "tappet": (TAPPET, GUIDED),
    "flat_rocker": (
        FACED_ROCKER,
        {"face": 0.12, "pivot": 0.1, "pivot_diameter": 16.0, "pivot_viscous": 0.05},
    ),
}


ROTATION: Final = {"tappet": "ccw", "flat_rocker": "cw"}


def made_of(scene: str, effects: str, turned: bool = False, rev: float = 300.0) -> Design:
    """The fixture, which may turn the other way round."""
    now = ROTATION[scene]
    other = {"ccw": "cw", "cw": "ccw"}[now] if turned else now
    slow = "speed = 120\n" if scene == "tappet" else ""
    old = f'rotation = "{now}"\n{slow}'
    return design(scene, effects, (old, f'rotation = "{other}"\nspeed = {rev!r}\n'))


@dataclass(frozen=True)
class OnFace:
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
    made: Design, table: dict[str, float], at: OnFace, normal: FloatArray
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
    at, normal = OnFace(made, phi), made.effect("contact-force").normal(phi, "right")
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
    at, normal = OnFace(made, phi), made.effect("contact-force").normal(phi, "right")
    out = np.exp(1j * made.cam.follower.guide_angle)  # type: ignore[attr-defined]  # it has a guide
    held = -along(-1j * out, 0.9e-3 * pull(-60.0))
    assert np.max(np.abs(result.bodies.of_guide(phi, "right")[0] - held)) <= 1e-12 * np.max(normal)
    told = {each.name: each.values(phi, "right") for each in result.columns}
    moment = normal * along(-1j * out, at.contact(phi))
    assert np.max(np.abs(1e3 * told["guide moment"] - moment)) <= 1e-9 * np.max(np.abs(moment))


FACE_LINKED: Final = """
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
        ("face_offset = 6", "face_offset = 16"), ("\n[output]", f"{FACE_LINKED}\n[output]"),
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
    expected = np.abs(OnFace(made, phi).slip) * omega(made)
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
