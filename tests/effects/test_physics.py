"""Effects together, compared with an independent formulation of the mechanics.

Energies come from places and lengths alone, and their rates from differences; losses from the
velocities of bodies in the fixed frame; forces from Newton's law, with the guide's reactions those
of a beam on two supports.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
import pytest

from camgeo.cam.cam import Cam
from camgeo.design.design import Design
from camgeo.kinematics.mechanism.oscillating_roller import OscillatingRoller
from camgeo.kinematics.mechanism.translating_roller import TranslatingRoller
from camgeo.kinematics.time_course import in_time
from camgeo.numeric.arrays import ComplexArray, FloatArray
from camgeo.units import RPM, TURN
from tests.effects.scenes import design

STEP: Final = 2e-3
"""Of the differences [rad]."""

CENTRAL: Final = (4.0 / 5.0, -1.0 / 5.0, 4.0 / 105.0, -1.0 / 280.0)
"""Coefficients of the central difference of eighth order (Fornberg, "Generation of finite
difference formulas on arbitrarily spaced grids", Math. Comp. 51 (1988), table 1)."""

DIFFERENCE: Final = 1e-9
"""Error of a difference of differences: rounding, 1e-16 of places ten times a lift, is divided by
the step twice, 1e-15 / 4e-6 = 3e-10; what the formula leaves out is h^8 / 630 times a ninth
derivative, 1e-16 for laws that go with the eighth harmonic of the turn."""

ROUNDING: Final = 1e-12
"""A few thousand roundings of the largest force, as in the tests of the contact force."""

G: Final = 9806.65

PLATE: Final = """
[effects.inertia]
mass = 1.1
roller_mass = 0.2
[effects.gravity]
angle = -60
[effects.spring]
stiffness = 2.5
preload = 160
[effects.load]
constant = 25
"""

ROCKER: Final = """
[effects.inertia]
moment_of_inertia = 0.012
roller_mass = 0.15
rocker_mass = 0.9
rocker_centre = [70, 30]
[effects.gravity]
angle = -75
[effects.spring]
kind = "torsion"
torsional_stiffness = 40
preload_torque = 30
[effects.load]
constant = 1.5
"""

LINKED: Final = """
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

ROLLER: Final = {"roller_pin": 0.02, "roller_pin_diameter": 8.0, "rolling": 0.03}
GUIDE: Final = {"guide": 0.12, "guide_length": 70.0, "guide_overhang": 45.0, "guide_viscous": 0.3}
PIVOT: Final = {"pivot": 0.11, "pivot_diameter": 22.0, "pivot_viscous": 0.8}
SLIDER: Final = {"slider": 6.0, "guide_viscous": 0.08}

TELLING: Final = """
[effects.contact-force]
[effects.lift-off]
[effects.drive-torque]
"""

CASES: Final[dict[str, tuple[str, dict[str, float]]]] = {
    "plate_translating": (PLATE, {**ROLLER, **GUIDE}),
    "shuttle": (ROCKER, {**ROLLER, **PIVOT}),
    "setzhub": (LINKED, {**ROLLER, **PIVOT, **SLIDER}),
}


def friction(table: dict[str, float]) -> str:
    return "\n".join(["[effects.friction]", *(f"{key} = {each}" for key, each in table.items())])


def speed_of(scene: str, rev: float) -> tuple[str, str]:
    """The change of the scene's text that has it run at `rev` rev/min."""
    if scene == "ring":
        return 'rotation = "ccw"\n', f'rotation = "ccw"\nspeed = {rev!r}\n'
    now = {"plate_translating": 60, "shuttle": 120, "setzhub": 90, "groove": 30}[scene]
    return f"\nspeed = {now}\n", f"\nspeed = {rev!r}\n"


def omega(made: Design) -> float:
    course = made.drive.time_course
    assert course is not None
    return float(course.rates(np.zeros(1))[0, 0])


def inside(made: Design, keep_off: float = 9.0 * STEP, count: int = 11) -> FloatArray:
    """Angles between the borders of the motion, so far off that no difference crosses one."""
    edges = made.drive.smooth_angles
    found = [
        np.linspace(low + keep_off, high - keep_off, count)
        for low, high in itertools.pairwise(edges)
        if high - low > 3.0 * keep_off
    ]
    return np.concatenate(found)


def slope(function: Any, phi: FloatArray) -> Any:
    """Derivative over the cam angle by differences."""
    return sum(
        weight / STEP * (function(phi + k * STEP) - function(phi - k * STEP))
        for k, weight in enumerate(CENTRAL, start=1)
    )


def pull(angle: float) -> complex:
    return G * complex(math.cos(math.radians(angle)), math.sin(math.radians(angle)))


def along(a: Any, b: Any) -> Any:
    return np.real(np.conj(a) * b)


@dataclass(frozen=True)
class Bodies:
    """Cam, roller and follower in the fixed frame at `phi`; velocities per unit of cam speed."""

    cam: Cam
    phi: FloatArray
    normal: FloatArray

    def centre(self, phi: FloatArray) -> ComplexArray:
        turned: ComplexArray = self.cam.disc.pitch_curve.point(phi) * np.exp(
            1j * self.cam.rotation * phi
        )
        return turned

    @property
    def outward(self) -> ComplexArray:
        """Normal of the pitch curve that points away from the disc."""
        curve = slope(self.cam.disc.pitch_curve.point, self.phi)
        tangent = curve / np.abs(curve) * np.exp(1j * self.cam.rotation * self.phi)
        return np.asarray(-1j * tangent if self.ahead else 1j * tangent)

    @property
    def ahead(self) -> bool:
        """Whether the roller goes round the disc counter-clockwise."""
        return self.cam.rotation < 0

    @property
    def push(self) -> ComplexArray:
        """Unit vector of the force on the roller."""
        return np.asarray(np.sign(self.normal) * self.outward)

    @property
    def arm(self) -> ComplexArray:
        """From the roller's centre to the contact."""
        return np.asarray(-self.cam.follower.roller_radius * self.push)

    @property
    def turning(self) -> FloatArray:
        """Angular velocity of the follower."""
        follower = self.cam.follower
        if not isinstance(follower, OscillatingRoller):
            return np.zeros(len(self.phi))
        rate = slope(self.centre, self.phi) / (self.centre(self.phi) - follower.pivot)
        return np.asarray(rate.imag)

    @property
    def roller(self) -> FloatArray:
        """Angular velocity of the roller, which rolls."""
        of_cam = 1j * self.cam.rotation * (self.centre(self.phi) + self.arm)
        rate = (of_cam - slope(self.centre, self.phi)) / (1j * self.arm)
        return np.asarray(rate.real)

    def moments(self, table: dict[str, float]) -> tuple[FloatArray, FloatArray]:
        """Of bearing and rolling on the roller [N mm]."""
        size = np.abs(self.normal)
        pin = 0.5 * table["roller_pin"] * table["roller_pin_diameter"] * size
        rolling = table["rolling"] * size
        return (
            -pin * np.sign(self.roller - self.turning),
            -rolling * np.sign(self.roller - self.cam.rotation),
        )

    def load(self, table: dict[str, float]) -> ComplexArray:
        """Force of the cam on the roller [N]: normal, and tangential by the roller's balance."""
        tangent = 1j * self.push
        pin, rolling = self.moments(table)
        share = -(pin + rolling) / np.imag(np.conj(self.arm) * tangent)
        return np.asarray(np.abs(self.normal) * self.push + share * tangent)

    def guide_reactions(self, table: dict[str, float], weight: complex) -> FloatArray:
        """(2, n) magnitudes [N] at both ends of the guide, as of a beam on two supports."""
        follower = self.cam.follower
        assert isinstance(follower, TranslatingRoller)
        out = np.exp(1j * follower.guide_angle)
        start = along(out, self.centre(np.zeros(1)))[0] + table["guide_overhang"]
        load, (pin, _) = self.load(table) + weight, self.moments(table)
        height = along(out, self.centre(self.phi))
        found = []
        for y, force, moment in zip(height, along(-1j * out, load), -pin, strict=True):
            rows = np.array([[1.0, 1.0], [-start, -(start + table["guide_length"])]])
            found.append(np.abs(np.linalg.solve(rows, [-force, y * force - moment])))
        return np.array(found).T

    def losses(self, table: dict[str, float], other: Any) -> FloatArray:
        """Of the bearings and the rolling, per unit of cam speed [N mm].

        `other` is what loads the pivot or the guide besides the contact, with its inertia.
        """
        pin, rolling = self.moments(table)
        lost = np.abs(pin * (self.roller - self.turning))
        lost += np.abs(rolling * (self.roller - self.cam.rotation))
        if isinstance(self.cam.follower, OscillatingRoller):
            moment = 0.5 * table["pivot"] * table["pivot_diameter"]
            moment *= np.abs(self.load(table) + other)
            return np.asarray(lost + moment * np.abs(self.turning))
        velocity = np.abs(slope(self.centre, self.phi))
        held = np.sum(self.guide_reactions(table, other), axis=0)
        return np.asarray(lost + table["guide"] * held * velocity)


def on_bearings(made: Design, phi: FloatArray, speed: float) -> Any:
    """What loads pivot or guide besides the contact: weights, on a rocker d'Alembert's forces, and
    that of a coupler, which `test_pins` cuts free.
    """
    follower: Any = made.cam.follower
    if isinstance(follower, TranslatingRoller):
        return 1.3e-3 * pull(-60.0)
    masses = [(0.15e-3, follower.start_arm), (0.9e-3, 70.0 + 30.0j - follower.pivot)]
    angle, found = -75.0, np.zeros(len(phi), dtype=np.complex128)
    if made.cam.drive.linkage is not None:
        masses, angle = [(0.06e-3, follower.start_arm)], -110.0
        found += made.effect("reactions").bodies.pins.at(phi, "right").near
    for mass, start in masses:

        def place(x: FloatArray, start: complex = start) -> Any:
            return start * np.exp(1j * follower.swing_sense * lift(made, x))

        acceleration = slope(lambda x: slope(place, x), phi) * speed**2
        found += mass * (pull(angle) - acceleration)
    return found


def lift(made: Design, phi: FloatArray) -> FloatArray:
    return np.asarray(made.cam.drive.motion.jet(phi)[0])


def stroke(made: Design, phi: FloatArray) -> FloatArray:
    return np.asarray(made.cam.drive.plan.jet(phi)[0])


def joints(made: Design, phi: FloatArray) -> tuple[ComplexArray, ComplexArray]:
    """Pin and tip of the linkage, seen from the pivot, once they fit its lengths and ways."""
    linkage = made.cam.drive.linkage
    assert linkage is not None
    pin, tip = linkage.joints(stroke(made, phi))
    small = 1e-13 * (linkage.crank + linkage.coupler)
    assert np.max(np.abs(np.abs(pin - tip) - linkage.coupler)) <= small
    assert np.max(np.abs(np.abs(tip) - linkage.crank)) <= small
    turned = tip * np.exp(-1j * lift(made, phi))
    assert np.max(np.abs(turned - turned[0])) <= small
    way = np.abs(pin - pin[0]) - np.abs(stroke(made, phi) - stroke(made, phi[:1]))
    assert np.max(np.abs(way)) <= small
    return pin, tip


def kinetic(made: Design, phi: FloatArray) -> FloatArray:
    """Kinetic energy per square of the cam's speed [t mm^2], from ways that are differenced."""
    of_lift = slope(lambda x: lift(made, x), phi)
    follower: Any = made.cam.follower
    if isinstance(follower, TranslatingRoller):
        return np.asarray(0.5 * 1.3e-3 * of_lift**2)
    if made.cam.drive.linkage is None:
        return np.asarray(0.5 * (0.012e3 + 0.15e-3 * follower.arm**2) * of_lift**2)
    pin = slope(lambda x: joints(made, x)[0], phi)
    tip = slope(lambda x: joints(made, x)[1], phi)
    at = joints(made, phi)
    rod = np.imag((pin - tip) / (at[0] - at[1]))
    energy = (0.004e3 + 0.06e-3 * follower.arm**2) * of_lift**2
    energy = energy + 1.2e-3 * np.abs(pin) ** 2 + 0.3e-3 * np.abs(0.6 * tip + 0.4 * pin) ** 2
    moment = 0.3e-3 * made.cam.drive.linkage.coupler**2 / 12.0
    return np.asarray(0.5 * (energy + moment * rod**2))


def weights(made: Design, phi: FloatArray) -> FloatArray:
    """Potential energy of the weights [N mm]."""
    follower: Any = made.cam.follower
    centre = Bodies(made.cam, phi, np.ones(len(phi))).centre(phi)
    if isinstance(follower, TranslatingRoller):
        return np.asarray(-1.3e-3 * along(pull(-60.0), centre))
    if made.cam.drive.linkage is None:
        at_0 = Bodies(made.cam, phi, phi).centre(np.zeros(1))[0] - follower.pivot
        turned = (centre - follower.pivot) / at_0
        rocker = (complex(70.0, 30.0) - follower.pivot) * turned
        return np.asarray(-along(pull(-75.0), 0.15e-3 * centre + 0.9e-3 * rocker))
    pin, tip = joints(made, phi)
    moments = 0.06e-3 * centre + 1.2e-3 * pin + 0.3e-3 * (0.6 * tip + 0.4 * pin)
    return np.asarray(-along(pull(-110.0), moments))


def spring_energy(made: Design, phi: FloatArray) -> FloatArray:
    """Of a linear spring, by its force alone: F^2 / (2 k) [N mm]."""
    (column,) = made.effect("spring").columns
    force = column.values(phi, "right")
    if made.cam.drive.linkage is not None:
        return np.asarray(force**2 / (2.0 * 3.0))
    if isinstance(made.cam.follower, TranslatingRoller):
        return np.asarray(force**2 / (2.0 * 2.5))
    return np.asarray(1e3 * force**2 / (2.0 * 40.0))


def load_of(scene: str) -> float:
    return {"plate_translating": 25.0, "shuttle": 1.5e3, "setzhub": 15.0}[scene]


@pytest.mark.parametrize("rev", [7.0, 150.0])
@pytest.mark.parametrize("scene", CASES)
def test_power_of_the_drive_goes_into_energies_the_load_and_losses(scene: str, rev: float) -> None:
    """T omega = dE/dt + dV/dt + load + losses at every angle, all frictions at work."""
    forces, table = CASES[scene]
    made = design(
        scene, forces + friction(table) + TELLING + "[effects.reactions]", speed_of(scene, rev)
    )
    phi, speed = inside(made), omega(made)
    normal = made.effect("contact-force").normal(phi, "right")
    torque = made.effect("drive-torque").torque(phi, "right")
    velocity = slope(lambda x: lift(made, x), phi)
    way = slope(lambda x: stroke(made, x), phi)

    def energy(x: FloatArray) -> FloatArray:
        return kinetic(made, x) * speed**2 + weights(made, x) + spring_energy(made, x)

    stored = slope(energy, phi)
    load = load_of(scene) * way
    losses = Bodies(made.cam, phi, normal).losses(table, on_bearings(made, phi, speed))
    if "slider" in table:
        losses = losses + table["slider"] * np.abs(way) + table["guide_viscous"] * speed * way**2
    elif "guide_viscous" in table:
        losses = losses + table["guide_viscous"] * speed * velocity**2
    losses = losses + 1e3 * table.get("pivot_viscous", 0.0) * speed * velocity**2
    assert np.all(losses >= 0.0)
    # A difference is as exact as what it is taken of: the energies, not their change alone.
    scale = np.max(np.abs(torque)) + np.ptp(energy(phi))
    assert np.max(np.abs(torque - (stored + load + losses))) <= DIFFERENCE * scale
    assert np.max(losses) > 0.01 * np.max(np.abs(torque))


GAUSS: Final = np.polynomial.legendre.leggauss(20)


def turn_integral(function: Any, edges: FloatArray, cuts: int = 16) -> float:
    """Over a turn, by Gauss's rule on sixteenths of its smooth pieces."""
    nodes, weight = GAUSS
    cells = np.concatenate(
        [np.linspace(low, high, cuts + 1)[:-1] for low, high in itertools.pairwise(edges)]
        + [edges[-1:]]
    )
    half = 0.5 * np.diff(cells)[:, np.newaxis]
    phi = cells[:-1, np.newaxis] + half * (1.0 + nodes)
    return float(np.sum(half * weight * function(phi.ravel(), "right").reshape(phi.shape)))


@pytest.mark.parametrize("scene", [*CASES, "points", "ring"])
def test_conservative_torque_does_no_work_over_a_turn(scene: str) -> None:
    """Masses, weights and springs give back all that they take; with a speed curve as well."""
    forces = {"points": PLATE, "ring": PLATE}.get(scene) or CASES[scene][0]
    changes = [speed_of(scene, 90.0)] if scene != "points" else []
    made = design(scene, forces + TELLING, *changes)
    drive = made.effect("drive-torque")
    work = turn_integral(drive.torque, made.drive.smooth_angles)
    peak = np.max(np.abs(drive.torque(np.linspace(0.0, TURN, 2001), "right")))
    assert peak > 0.0
    assert abs(work) <= ROUNDING * peak


@pytest.mark.parametrize("rev", [20.0, 200.0])
@pytest.mark.parametrize("side", [1, -1])
def test_newton_in_a_guide_with_friction(rev: float, side: int) -> None:
    """Three equations of balance for the normal force and both reactions of the guide.

    Which way each of the three acts is not known before: all eight answers are tried, and the one
    that keeps its own signs is it.
    """
    table = {**GUIDE, **ROLLER, "guide_viscous": 0.0}
    turned = [('"ccw"', '"cw"')] if side < 0 else []
    scene = "plate_translating"
    made = design(scene, PLATE + friction(table) + TELLING, speed_of(scene, rev), *turned)
    phi, speed = inside(made), omega(made)
    found = made.effect("contact-force").normal(phi, "right")
    follower = made.cam.follower
    assert isinstance(follower, TranslatingRoller)
    out = np.exp(1j * follower.guide_angle)
    timed = in_time(made.cam.drive.motion.jet(phi), made.drive.time_course, phi)  # type: ignore[arg-type]  # the scene has a speed
    own = 1.3e-3 * along(out, pull(-60.0)) - 25.0 - (160.0 + 2.5 * timed[0])
    needed = 1.3e-3 * timed[2] - own
    unit = Bodies(made.cam, phi, np.ones(len(phi)))
    near = along(out, unit.centre(np.zeros(1)))[0] + table["guide_overhang"]
    far = near + table["guide_length"]
    height = along(out, unit.centre(phi))
    moving = np.sign(np.where(np.abs(timed[1]) > 1e-9 * speed, timed[1], 0.0))
    by_flank = {}
    for flank in (1.0, -1.0):
        at = Bodies(made.cam, phi, np.full(len(phi), flank))
        by_flank[flank] = (at.load(table), -at.moments(table)[0])
    agreed = np.zeros(len(phi))
    for k in range(len(phi)):
        for flank, first, second in itertools.product((1.0, -1.0), repeat=3):
            load, moment = (each[k] for each in by_flank[flank])
            drag = -table["guide"] * moving[k]
            across, weight = along(-1j * out, load), 1.3e-3 * along(-1j * out, pull(-60.0))
            rows = np.array(
                [
                    [along(out, load), drag * first, drag * second],
                    [across, 1.0, 1.0],
                    [-height[k] * across + moment, -near, -far],
                ]
            )
            size, r1, r2 = np.linalg.solve(rows, [needed[k], -weight, height[k] * weight])
            if size >= 0.0 and first * r1 >= 0.0 and second * r2 >= 0.0:
                agreed[k] = flank * size
                break
        else:
            pytest.fail("no answer keeps its signs")
    # The normal is had by a difference here, which the leverage of the guide magnifies.
    assert np.max(np.abs(found - agreed)) <= DIFFERENCE * np.max(np.abs(found))


@pytest.mark.parametrize("scene", CASES)
def test_torque_is_the_moment_of_the_forces_on_the_cam(scene: str) -> None:
    """Normal and tangential force at the working curve, and rolling friction's moment."""
    forces, table = CASES[scene]
    made = design(scene, forces + friction(table) + TELLING)
    phi = inside(made)
    normal = made.effect("contact-force").normal(phi, "right")
    at = Bodies(made.cam, phi, normal)
    flank = np.where(
        normal > 0.0, made.cam.disc.inner_curve.point(phi), made.cam.disc.outer_curve.point(phi)
    )
    touching = flank * np.exp(1j * made.cam.rotation * phi)
    assert np.max(np.abs(touching - at.centre(phi) - at.arm)) <= DIFFERENCE * np.max(np.abs(flank))
    moment = np.imag(np.conj(touching) * at.load(table)) + at.moments(table)[1]
    found = made.effect("drive-torque").torque(phi, "right")
    # The arm about the axis is a small share of the place, through which the force nearly passes.
    scale = np.max(np.abs(normal)) * np.max(np.abs(flank))
    assert np.max(np.abs(found - made.cam.rotation * moment)) <= DIFFERENCE * scale


LIFTED: Final = {
    "plate_translating": PLATE.replace("preload = 160", "preload = 60"),
    "ring": PLATE.replace("preload = 160", "preload = 140").replace("= 25", "= -25"),
    "shuttle": ROCKER,
    "setzhub": LINKED,
}


@pytest.mark.parametrize("margin", [0.0, 20.0])
@pytest.mark.parametrize("scene", LIFTED)
def test_at_the_speed_of_lift_off_the_force_touches_its_margin(scene: str, margin: float) -> None:
    viscous = {"shuttle": {"pivot_viscous": 0.4}}.get(scene, {"guide_viscous": 0.2})
    effects = LIFTED[scene] + friction(viscous) + TELLING
    effects = effects.replace("[effects.lift-off]", f"[effects.lift-off]\nmargin = {margin}")
    slow = design(scene, effects, speed_of(scene, 1.0))
    (speed,) = [f for f in slow.effects.findings("lift-off") if f.name == "lift-off-speed"]
    assert speed.value is not None
    assert speed.value > 1.0
    for factor, sign in ((1.0, 0.0), (0.999, 1.0), (1.001, -1.0)):
        made = design(scene, effects, speed_of(scene, factor * speed.value))
        extremes = made.effect("contact-force").extremes
        inner = made.cam.contact == "inner"
        low = extremes.lowest.value if inner else -extremes.highest.value
        place = (extremes.lowest if inner else extremes.highest).place
        if sign == 0.0:
            # Where the force is least its slope is 0: the place counts with its square.
            assert abs(low - margin) <= 1e-10 * extremes.magnitude
            assert speed.cam_angle is not None
            assert abs(math.remainder(place - speed.cam_angle, TURN)) <= 1e-4
        else:
            assert sign * (low - margin) > 0.0


def test_an_outer_flank_lifts_off_as_its_mirrored_inner_one() -> None:
    """A roller that a positive lift moves inwards in a ring is pushed as one outwards on a disc.

    The generalised forces are the same, so that contact is lost at the same speed and place, and
    the same spring keeps it; the normal force itself differs, as its leverage does.
    """
    effects = """
[effects.inertia]
mass = 1.1
[effects.spring]
stiffness = 0.2
preload = 4
[effects.load]
constant = 2
[effects.contact-force]
[effects.lift-off]
"""
    offset = ("offset = 12", "offset = 0")
    speed = speed_of("plate_translating", 200.0)
    disc = design("plate_translating", effects, offset, speed)
    ring = design(
        "plate_translating", effects, offset, speed,
        ('direction = "outward"', 'direction = "inward"'),
        ('contact = "inner"', 'contact = "outer"'),
        ("bore = 25", "rim = 160"),
        ("keyway = { width = 8, depth = 3.3, angle = 90 }\n", ""),
    )  # fmt: skip
    pair = [
        {each.name: each for each in made.effects.findings("lift-off")} for made in (disc, ring)
    ]
    assert pair[0].keys() == pair[1].keys()
    for name in ("lift-off-speed", "least-preload", "least-stiffness"):
        one, other = (each[name] for each in pair)
        assert one.value is not None
        assert one.value > 0.0
        assert one.value == pytest.approx(other.value, rel=ROUNDING)
        assert one.severity == other.severity
        assert one.cam_angle == pytest.approx(other.cam_angle, abs=1e-6)
    assert pair[0]["lift-off"].cam_range == pytest.approx(pair[1]["lift-off"].cam_range, abs=1e-9)


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


def test_flanks_of_a_groove_change_where_force_and_load_cancel() -> None:
    """Angles at which J q'' omega^2 + load = 0, by bisection of the law's second derivative."""
    from scipy.optimize import brentq

    effects = "[effects.inertia]\nmoment_of_inertia = 0.012\n[effects.load]\nconstant = 0.05\n"
    made = design("groove", effects + TELLING, speed_of("groove", 120.0))
    speed = omega(made)

    def needed(phi: float) -> float:
        return float(0.012e3 * made.cam.drive.motion.jet(np.array([phi]))[2, 0] * speed**2 + 0.05e3)

    grid = np.linspace(0.0, TURN, 20001)
    values = 0.012e3 * made.cam.drive.motion.jet(grid)[2] * speed**2 + 0.05e3
    places = np.flatnonzero(values[:-1] * values[1:] < 0.0)
    roots = [brentq(needed, grid[k], grid[k + 1], xtol=1e-14) for k in places]
    changes = [f.cam_angle for f in made.effects.findings("lift-off") if f.name == "flank-change"]
    assert len(changes) == len(roots) >= 4
    # A root is had as exactly as the force, by its slope; at a jump of the force exactly.
    assert np.max(np.abs(np.array(changes) - np.array(roots))) <= 1e-9
    before = made.effect("contact-force").normal(np.array(roots) - 1e-6, "right")
    after = made.effect("contact-force").normal(np.array(roots) + 1e-6, "right")
    assert np.all(before * after < 0.0)


@pytest.mark.parametrize("scene", ["plate_translating", "groove"])
def test_pressure_by_the_curvature_of_the_flank(scene: str) -> None:
    """p = sqrt(F E / (pi L R)) with the flank's own curvature, from its points alone.

    Johnson, Contact Mechanics, section 4.2, eq. (4.45): line contact of cylinders.
    """
    rocks = scene == "groove"
    effects = (ROCKER if rocks else PLATE) + TELLING
    contact = "[effects.contact-pressure]\nwidth = 6\ncam_modulus = 210000\ncam_poisson = 0.3\n"
    contact += "roller_modulus = 100000\nroller_poisson = 0.25\n"
    made = design(scene, effects + contact)
    phi = inside(made)
    normal = made.effect("contact-force").normal(phi, "right")
    modulus = 1.0 / ((1.0 - 0.3**2) / 210000.0 + (1.0 - 0.25**2) / 100000.0)

    def bend(curve: Any) -> FloatArray:
        """Curvature, positive where the flank is convex seen from outside of the disc."""
        first = slope(curve.point, phi)
        second = slope(lambda x: slope(curve.point, x), phi)
        return np.asarray(
            -made.cam.rotation * np.imag(np.conj(first) * second) / np.abs(first) ** 3
        )

    roller = made.cam.follower.roller_radius
    # The disc lies outside of its outer flank, where what is convex is hollow for the roller.
    relative = np.where(
        normal > 0.0,
        1.0 / roller + bend(made.cam.disc.inner_curve),
        1.0 / roller - bend(made.cam.disc.outer_curve),
    )
    expected = np.sqrt(np.abs(normal) * modulus * relative / (math.pi * 6.0))
    column = made.effect("contact-pressure").columns[0]
    found = column.values(phi, "right")
    assert column.name == "contact pressure"
    # A second difference of places of the size of the cam: 1e-16 * 100 mm / 4e-6 by the radius.
    assert np.max(np.abs(found - expected)) <= 1e-8 * np.max(expected)


def test_a_heavy_flywheel_runs_at_the_speed_whose_mean_torque_is_the_motors() -> None:
    """Departures from the drive torque at constant speed fall as 1 / J."""
    effects = PLATE + friction({**GUIDE, **ROLLER}) + TELLING
    off = []
    for moment in (30.0, 300.0):
        motor = f"moment_of_inertia = {moment}\nno_load_speed = 100\nstall_torque = 40\n"
        made = design("plate_translating", f"{effects}[effects.speed-fluctuation]\n{motor}")
        turn, drive = made.effect("speed-fluctuation"), made.effect("drive-torque")
        phi = inside(made)
        constant = np.full(len(phi), turn.mean_speed)
        own = drive.at(phi, "right", turn.turn.omega(phi), turn.alpha(phi, "right"))
        held = drive.at(phi, "right", constant, np.zeros(len(phi)))
        off.append(float(np.max(np.abs(own - held))))
        rev = turn.mean_speed / RPM
        steady = design("plate_translating", effects, speed_of("plate_translating", rev))
        again = steady.effect("drive-torque").torque(phi, "right")
        assert np.max(np.abs(again - held)) <= ROUNDING * np.max(np.abs(held))
        edges = steady.effect("drive-torque").edges
        mean = turn_integral(steady.effect("drive-torque").torque, edges) / TURN
        line = 40e3 * (1.0 - turn.mean_speed / (100.0 * RPM))
        # The torque is about linear in small changes of speed, whose mean over time is 0, and that
        # over the angle of second order: the fluctuation's square, by the slope of the motor.
        assert abs(mean - line) <= 40e3 * turn.fluctuation**2 + 1e-6 * np.max(np.abs(held))
    # What goes with 1 / J^2 is a share of the fluctuation, 0.0016, times what the motor's slope and
    # the largest moment about the shaft magnify it by, some ten.
    assert off[1] == pytest.approx(off[0] / 10.0, rel=0.05)


def test_a_stiff_train_bends_by_its_own_acceleration() -> None:
    """x - s = -a / w^2 except for what goes with 1 / w^3: jerks, damping, and their transients.

    A jump of the acceleration's rate j leaves a vibration of j / w^3, which has died down by
    exp(-z w T) when it comes again after a turn; the damper adds 2 z j / w^3.
    """
    for frequency in (60.0, 240.0):
        damping = 0.1
        vibration = f"[effects.vibration]\nnatural_frequency = {frequency}\ndamping = {damping}\n"
        made = design("plate_translating", vibration)
        w = frequency * TURN
        phi = np.linspace(0.0, TURN, 5000, endpoint=False)
        timed = in_time(made.cam.drive.plan.jet(phi), made.drive.time_course, phi)  # type: ignore[arg-type]  # the scene has a speed
        found = made.effect("vibration").output.deflection(phi, "right")
        left = np.max(np.abs(found + timed[2] / w**2))
        edges = made.drive.smooth_angles
        both = [
            in_time(made.cam.drive.plan.jet(edges, side), made.drive.time_course, edges)[3]  # type: ignore[arg-type]  # the scene has a speed
            for side in ("right", "left")
        ]
        jumps = float(np.sum(np.abs(both[0] - both[1])))
        jerk = float(np.max(np.abs(timed[3])))
        died = -math.expm1(-damping * w)
        # The snap s'''' / w^4 of the next order is the jerk times a harmonic of the motion by w.
        bound = (jumps / math.sqrt(1.0 - damping**2) / died + 2.0 * damping * jerk) / w**3
        assert left <= 1.1 * bound
        assert left <= 0.2 * np.max(np.abs(found))
