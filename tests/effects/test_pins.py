"""Effect `reactions` of linkages, against Newton's law for every member with geometry of its own.

Joints close by circles here, their accelerations follow from the closed loops; all forces of the
members cut free are unknowns of one linear system. Virtual work, which camgeo's contact force comes
from, knows none of them.
"""

from __future__ import annotations

import cmath
import math
from dataclasses import dataclass
from random import Random
from typing import Any, Final

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from camgeo.design.design import Design
from camgeo.kinematics.mechanism.linkages import FourBar, SliderCrank, SliderDrivenCrank
from camgeo.numeric.arrays import ComplexArray, FloatArray
from camgeo.scene.scene import parse_scene
from tests.effects.bodies import along, cross, pull
from tests.effects.scenes import SCENES, course_of, design
from tests.long_form import examples

LINKED: Final = (
    "scenes/setzhub", "scenes/querhub", "scenes/schnitt", "scenes/vorschub", "scenes/four_bar",
    "scenes/crank_slider", "effects/linked_press", "effects/four_bar",
)  # fmt: skip

ROUNDING: Final = 1e-12
"""Of the largest force of the turn: the system's condition is some hundreds."""

ROUNDS: Final = 80
"""Of the fixed point of friction, each of which leaves less than half of the last change."""

Jets = tuple[ComplexArray, ComplexArray, ComplexArray]
"""A place and its first and second derivative over time, (n,) each."""


def drawn(rng: Random, name: str, *, rubbing: bool = False) -> tuple[str, dict[str, float]]:
    """The text of a scene with random masses and forces, and these, in internal units."""
    text = (SCENES.parent / f"{name}.toml").read_text("utf-8")
    text = text.split("\n[effects")[0]
    rocks, slides = "oscillating" in text, "slider-crank" in text
    far = "slider" if rocks and slides else "crank" if slides else "lever"

    def number(low: float, high: float) -> float:
        return float(f"{math.exp(rng.uniform(math.log(low), math.log(high))):.5g}")

    own = {
        "coupler_mass": number(0.05, 3.0), "coupler_centre": round(rng.random(), 3),
        "coupler_moment": number(1e-4, 1e-2), "roller_mass": number(0.01, 0.5),
    }  # fmt: skip
    if rocks:
        own |= {"moment_of_inertia": number(1e-3, 0.1), "rocker_mass": number(0.1, 3.0)}
    if far != "slider":
        own |= {"output_moment": number(1e-3, 0.1)}
    if not rocks or far == "slider":
        own |= {"mass": number(0.1, 5.0)}
    centre = [round(rng.uniform(-80.0, 80.0), 1) for _ in range(2)]
    stated = {**own, "angle": round(rng.uniform(-180.0, 180.0), 1), "load": number(1.0, 20.0)}
    tables = ["[effects.inertia]", *(f"{key} = {each!r}" for key, each in own.items())]
    if rocks:
        tables.append(f"rocker_centre = {centre}")
        stated |= {"centre_x": centre[0], "centre_y": centre[1]}
    tables += ["[effects.gravity]", f"angle = {stated['angle']}"]
    tables += ["[effects.load]", f"constant = {stated['load']}", "[effects.reactions]"]
    if far == "slider":
        stated |= {"stiffness": number(0.1, 5.0), "preload": number(10.0, 500.0)}
        stated |= {"slider": number(1.0, 20.0), "guide_viscous": number(1e-3, 0.1)}
        tables += [
            "[effects.spring]",
            *(f"{key} = {stated[key]}" for key in ("stiffness", "preload")),
        ]
        tables += [
            "[effects.friction]",
            *(f"{key} = {stated[key]}" for key in ("slider", "guide_viscous")),
        ]
    bearing = {"pivot": 0.3, "pivot_diameter": number(5.0, 30.0)}
    if not rocks:
        bearing = {"guide": 0.2, "guide_length": number(40.0, 90.0), "guide_overhang": 15.0}
    if rubbing:
        stated |= bearing
        if far != "slider":
            tables.append("[effects.friction]")
        place = tables.index("[effects.friction]") + 1
        tables[place:place] = [f"{key} = {each}" for key, each in bearing.items()]
    tables.append("[effects.drive-torque]")
    return text + "\n" + "\n".join(tables) + "\n", stated


@dataclass(frozen=True)
class Members:
    """The members of a linked cam at `phi`, with their accelerations at the speed of the scene."""

    made: Design
    phi: FloatArray

    @property
    def follower(self) -> Any:
        return self.made.cam.follower

    def jet(self, motion: Any) -> FloatArray:
        """(3, n) of a motion over time."""
        q = motion.jet(self.phi, "right", 2)
        omega, alpha = course_of(self.made).rates(self.phi)[:2]
        return np.stack((q[0], q[1] * omega, q[2] * omega**2 + q[1] * alpha))

    def turned(self, start: complex, angle: FloatArray) -> Jets:
        """A point at `start` about 0, turned by the angle (3, n)."""
        place = start * np.exp(1j * angle[0])
        return place, 1j * angle[1] * place, (1j * angle[2] - angle[1] ** 2) * place

    def joints(self) -> tuple[Jets, Jets, Any]:
        """T and P seen from the crank's shaft, as drawn, and dx of the far member's joint."""
        linkage: Any = self.made.cam.drive.linkage
        demanded = self.jet(self.made.drive.plan)
        if isinstance(linkage, FourBar):
            sense = linkage.lever_sense
            pin = self.turned(cmath.rect(linkage.lever, linkage.lever_angle), sense * demanded)
            way = 1j * sense * pin[0]
            pin = (pin[0] + linkage.shaft, *pin[1:])
            return self.closed(linkage, pin, linkage.branch), pin, way
        inner: Any = linkage.inner if isinstance(linkage, SliderDrivenCrank) else linkage
        assert isinstance(inner, SliderCrank)
        lean = inner.crank * math.sin(inner.deflection) * (-1.0 if inner.leans_away else 1.0)
        x = inner.slider_side * (inner.coupler + lean)
        height = inner.crank * math.cos(inner.deflection)
        start, left = complex(-x, height), -inner.stroke_direction
        flip = -1.0 if inner.mirrored else 1.0  # x is the other way

        def drawn_as(place: complex) -> complex:
            return complex(flip * place.real, place.imag)

        if linkage is inner:
            zeros = np.zeros(len(self.phi))
            pin = (drawn_as(start) + flip * left * demanded[0] + 0j,
                   flip * left * demanded[1] + 0j, flip * left * demanded[2] + 0j)  # fmt: skip
            tip = self.closed(linkage, pin, flip * inner.branch)
            return tip, pin, zeros + flip * left + 0j
        # The crank is demanded; the pin goes along the guide, on the side where it starts.
        tip = self.turned(drawn_as(start + inner.slider_side * inner.coupler), demanded)
        side = -inner.slider_side * flip
        beside = side * np.sqrt(inner.coupler**2 - (height - tip[0].imag) ** 2)
        rod = beside + 1j * (height - tip[0].imag)
        speed = along(rod, tip[1]) / rod.real
        gain = (along(rod, tip[2]) - np.abs(speed - tip[1]) ** 2) / rod.real
        turn = self.follower.way / (flip * left)
        pin = (tip[0] + rod, speed + 0j, gain + 0j)
        return (
            tuple(turn * each for each in tip),
            tuple(turn * each for each in pin),
            turn * 1j * tip[0],
        )

    def closed(self, linkage: Any, pin: Jets, branch: float) -> Jets:
        """The crank's tip, clockwise of the pin for a `branch` of 1, by intersecting circles."""
        far = np.abs(pin[0])
        cosine = (far**2 + linkage.crank**2 - linkage.coupler**2) / (2.0 * far * linkage.crank)
        bent = np.exp(-1j * branch * np.arccos(np.clip(cosine, -1.0, 1.0)))
        tip = linkage.crank * pin[0] / far * bent
        rod = pin[0] - tip
        speed = along(rod, pin[1]) / along(rod, 1j * tip)
        pace = 1j * speed * tip
        rest = along(rod, pin[2] + speed**2 * tip) + np.abs(pin[1] - pace) ** 2
        gain = rest / along(rod, 1j * tip)
        return tip, pace, (1j * gain - speed**2) * tip

    def push(self, roller: Jets) -> ComplexArray:
        """Normal of the pitch curve away from the disc."""
        sigma, omega = self.made.cam.rotation, course_of(self.made).rates(self.phi)[0]
        tangent = roller[1] / omega - 1j * sigma * roller[0]
        return np.asarray(1j * sigma * tangent / np.abs(tangent))


class System:
    """Unknown forces by name, and equations that they fulfil, for n cam angles."""

    def __init__(self, count: int, names: tuple[str, ...]) -> None:
        self.names, self.count = names, count
        self.rows: list[FloatArray] = []
        self.right: list[FloatArray] = []

    def moment(self, arms: dict[str, Any], known: Any) -> None:
        """The moments of unknown forces, x and y, at their `arms`, and of all else, vanish."""
        row = np.zeros((len(self.names), self.count))
        for name, arm in arms.items():
            row[self.names.index(f"{name}.x")] -= np.imag(arm)
            row[self.names.index(f"{name}.y")] += np.real(arm)
        self.rows.append(row)
        self.right.append(-np.asarray(known) * np.ones(self.count))

    def force(self, vectors: dict[str, float], sizes: dict[str, Any], known: Any) -> None:
        """The unknown forces, vectors and sizes in a known direction, and all else vanish."""
        for part, name in ((np.real, "x"), (np.imag, "y")):
            row = np.zeros((len(self.names), self.count))
            for each, sign in vectors.items():
                row[self.names.index(f"{each}.{name}")] += sign
            for each, way in sizes.items():
                row[self.names.index(each)] += part(way)
            self.rows.append(row)
            self.right.append(-part(np.asarray(known) * np.ones(self.count)))

    def with_size(self, name: str, moment: Any) -> None:
        """The last equation, with the `moment` of a force of unknown size."""
        self.rows[-1][self.names.index(name)] += moment

    def solved(self) -> dict[str, Any]:
        rows = np.moveaxis(np.array(self.rows), 2, 0)
        found = np.linalg.solve(rows, np.array(self.right).T[:, :, None])[:, :, 0]
        return {name: found[:, k] for k, name in enumerate(self.names)}


def cut_free(made: Design, phi: FloatArray, given: dict[str, float]) -> dict[str, Any]:
    """All forces in the joints, complex, and the contact force."""
    at, follower, linkage = Members(made, phi), made.cam.follower, made.cam.drive.linkage
    pivot, free = follower.pivot, pull(given["angle"])
    tip, pin, way = at.joints()
    own, demanded = at.jet(made.cam.drive.motion), at.jet(made.drive.plan)
    far_rocks = linkage.unit == "rad"  # type: ignore[union-attr]  # it has one
    near, far = (tip, pin) if pivot is not None else (pin, tip)
    share = given["coupler_centre"]
    centre = [(1.0 - share) * a + share * b for a, b in zip(tip, pin, strict=True)]
    rod = [b - a for a, b in zip(tip, pin, strict=True)]
    turning = np.imag(rod[2] / rod[0])
    weight = 1e-3 * given["coupler_mass"]
    names = ("A.x", "A.y", "B.x", "B.y", "N", "G")
    system = System(len(phi), (*names, "R.x", "R.y") if pivot is not None else names)
    # Coupler: -A and -B
    system.force({"A": -1.0, "B": -1.0}, {}, weight * (free - centre[2]))
    system.moment(
        {"A": centre[0] - near[0], "B": centre[0] - far[0]},
        -1e3 * given["coupler_moment"] * turning,
    )
    # Far member
    load = given["load"]
    if far_rocks:
        sense = np.sign(np.imag(np.conj(far[0] - _shaft(linkage)) * way))
        moment = -sense * (1e3 * load) - 1e3 * given["output_moment"] * sense * demanded[2]
        system.moment({"B": far[0] - _shaft(linkage)}, moment)
    else:
        mass = 1e-3 * given["mass"]
        pressed = made.effect("spring").force.far(np.zeros(1), "right")[0]
        assert abs(pressed[0]) == given["preload"]  # it presses either way, and relaxes
        spring = pressed - given["stiffness"] * demanded[0]
        rubbing = -given["slider"] * np.sign(demanded[1]) - given["guide_viscous"] * demanded[1]
        acting = (spring - load + rubbing) * way
        system.force({"B": 1.0}, {"G": 1j * way}, mass * free + acting - mass * demanded[2] * way)
    # Follower's member
    roller_mass = 1e-3 * given["roller_mass"]
    if pivot is not None:
        swing = at.turned(follower.start_arm, own)
        roller = (swing[0] + pivot, *swing[1:])
        body = at.turned(complex(given["centre_x"], given["centre_y"]) - pivot, own)
        mass = 1e-3 * given["rocker_mass"]
        push = at.push(roller)
        known = mass * (free - body[2]) + roller_mass * (free - swing[2])
        system.force({"A": 1.0, "R": 1.0}, {"N": push}, known)
        moment = cross(body[0], mass * free) + cross(swing[0], roller_mass * free)
        whole = 1e3 * given["moment_of_inertia"] + roller_mass * abs(follower.start_arm) ** 2
        system.moment({"A": near[0]}, moment - whole * own[2])
        system.with_size("N", cross(swing[0], push))
        resisted = {-1: np.sign(own[1])}
    else:
        roller = (follower.start_arm + follower.way * own[0], *(follower.way * own[1:]))
        push = at.push(roller)
        mass = 1e-3 * given["mass"] + roller_mass
        out = follower.way * math.copysign(1.0, follower.reach)
        system.force({"A": 1.0}, {"N": push, "G": -1j * out}, mass * (free - roller[2]))
        along_guide = follower.way * np.sign(own[1])
        resisted = {-2: along_guide.real, -1: along_guide.imag}
    if pivot is not None and far_rocks:  # the lever's shaft is no unknown: its force is -B
        system.rows.append(np.eye(len(system.names))[5][:, None] * np.ones(len(phi)))
        system.right.append(np.zeros(len(phi)))
        resisted = {row - 1: each for row, each in resisted.items()}
    frictionless = list(system.right)
    for _ in range(ROUNDS):  # what rubs goes with the forces: a fixed point
        found = system.solved()
        for name in ("A", "B", *(["R"] if pivot is not None else [])):
            found[name] = found[f"{name}.x"] + 1j * found[f"{name}.y"]
        if pivot is not None:
            lost = 0.5 * given.get("pivot", 0.0) * given.get("pivot_diameter", 0.0)
            lost = lost * np.abs(found["R"])
        else:
            b = given.get("guide_length", 1.0)
            a = given.get("guide_overhang", 0.0) - math.copysign(1.0, follower.reach) * own[0]
            lost = given.get("guide", 0.0) * np.abs(found["G"]) * (abs(a) + abs(a + b)) / b
        for row, each in resisted.items():
            system.right[row] = frictionless[row] + lost * each
    kept = (weight * (free - centre[2]), centre[1], 1e3 * given["coupler_moment"] * turning)
    return {
        **found,
        "near": near,
        "far": far,
        "way": way,
        "rod": rod,
        "coupler": kept,
        "roller": roller[1],
    }


def _shaft(linkage: Any) -> complex:
    return complex(getattr(linkage, "shaft", 0.0))


def angles(made: Design) -> FloatArray:
    """Inside of the smooth pieces."""
    edges = made.effect("contact-force").edges
    shares = np.array([0.05, 0.3, 0.5, 0.77, 0.95])
    return np.asarray((edges[:-1, None] + np.diff(edges)[:, None] * shares).ravel())


def assert_reactions(name: str, rng: Random, *, rubbing: bool = False) -> None:
    text, given = drawn(rng, name, rubbing=rubbing)
    made = Design(parse_scene(text, str(SCENES.parent / f"{name}.toml")))
    phi = angles(made)
    wanted = cut_free(made, phi, given)
    bodies = made.effect("reactions").bodies
    joints = bodies.loads.coupler.at_speed(phi, "right")
    size = max(float(np.max(np.abs(wanted[each]))) for each in ("A", "B", "N"))
    assert np.max(np.abs(joints.near - wanted["A"])) <= ROUNDING * size
    assert np.max(np.abs(joints.far - wanted["B"])) <= ROUNDING * size
    normal = made.effect("contact-force").normal(phi, "right")
    assert np.max(np.abs(normal - wanted["N"])) <= ROUNDING * size
    if made.cam.follower.pivot is not None:
        assert np.max(np.abs(bodies.of_pivot(phi, "right") - wanted["R"])) <= ROUNDING * size
    else:
        assert (
            np.max(np.abs(np.sum(bodies.of_guide(phi, "right"), axis=0) - wanted["G"]))
            <= ROUNDING * size
        )
    if made.drive.unit == "mm":
        held = wanted["G"] * 1j * wanted["way"]
        assert np.max(np.abs(joints.held - held)) <= ROUNDING * size
    else:
        assert np.max(np.abs(joints.held + wanted["B"])) <= ROUNDING * size

    # The powers of both pins move the coupler, and what passes the cam is that of the drive.
    force, velocity, turned = wanted["coupler"]
    powers = [along(joints.near, wanted["near"][1]), along(joints.far, wanted["far"][1])]
    gain = turned * np.imag(wanted["rod"][1] / wanted["rod"][0]) - along(force, velocity)
    most = size * float(np.max(np.abs(wanted["near"][1])))
    assert np.max(np.abs(sum(powers) + gain)) <= 10.0 * ROUNDING * most
    omega = course_of(made).rates(phi)[0]
    given_by_cam = along(bodies.of_cam(phi, "right"), wanted["roller"])
    power = made.effect("drive-torque").torque(phi, "right") * omega
    assert np.max(np.abs(given_by_cam - power)) <= 10.0 * ROUNDING * np.max(np.abs(power))


@pytest.mark.parametrize("name", LINKED)
def test_joints_carry_what_the_members_cut_free_ask_for(name: str) -> None:
    assert_reactions(name, Random(1))
    assert_reactions(name, Random(2), rubbing=True)


@settings(max_examples=examples(4, long=200), deadline=None)
@given(st.sampled_from(LINKED), st.randoms(use_true_random=False))
def test_joints_with_any_masses(name: str, rng: Random) -> None:
    assert_reactions(name, rng, rubbing=rng.random() < 0.5)


def test_pins_pass_on_what_an_elastic_train_takes() -> None:
    """The rocker alone: the cam, the coupler and its weight turn it, whatever is behind."""
    name = "effects/linked_press"
    text, given = drawn(Random(1), name)
    elastic = "[effects.vibration]\nstiffness = 400\ndamping = 0.05\n"
    made = Design(parse_scene(text + elastic, str(SCENES.parent / f"{name}.toml")))
    phi, contact = angles(made), made.effect("contact-force")
    assert contact.behind is not None
    at = Members(made, phi)
    own, tip = at.jet(made.cam.drive.motion), at.joints()[0]
    near = made.effect("reactions").bodies.loads.coupler.at_speed(phi, "right").near
    swing = at.turned(at.follower.start_arm, own)[0]
    body = at.turned(complex(given["centre_x"], given["centre_y"]) - at.follower.pivot, own)[0]
    roller, mass = 1e-3 * given["roller_mass"], 1e-3 * given["rocker_mass"]
    whole = 1e3 * given["moment_of_inertia"] + roller * abs(at.follower.start_arm) ** 2
    wanted = whole * own[2] - cross(mass * body + roller * swing, pull(given["angle"]))
    wanted = wanted - cross(tip[0], near)
    found = contact.demand(phi, "right")
    assert np.max(np.abs(found - wanted)) <= 10.0 * ROUNDING * float(np.max(np.abs(found)))
    rigid = Design(parse_scene(text, str(SCENES.parent / f"{name}.toml")))
    before = rigid.effect("reactions").bodies.loads.coupler.at_speed(phi, "right").near
    assert np.max(np.abs(near - before)) > 1e-3 * np.max(np.abs(before))


def test_no_mass_and_no_load_leave_the_pins_empty() -> None:
    tables = "[effects.inertia]\nmoment_of_inertia = 0.01\n[effects.reactions]"
    made = design("four_bar", tables)
    found = {each.name: each.value for each in made.effect("reactions").findings}
    assert found["largest-near-pin-force"] == found["largest-far-pin-force"] == 0.0
    assert "largest-slider-guide-force" not in found
    assert found["largest-pivot-force"] == found["largest-camshaft-load"]
