"""Cam, roller and follower in the fixed frame, as vectors: the model that effects are held against.

Places and velocities are those of the roller's centre on its pitch curve; rotations, contacts and
forces follow from them here. Rates of energies are differences.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass
from typing import Any, Final

import numpy as np

from camgeo.cam.cam import Cam
from camgeo.design.design import Design
from camgeo.kinematics.mechanism.rollers import OscillatingRoller
from camgeo.numeric.arrays import ComplexArray, FloatArray
from tests.effects.scenes import course_of

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

ROLLER: Final = {"roller_pin": 0.02, "roller_pin_diameter": 8.0, "rolling": 0.03}
GUIDE: Final = {"guide": 0.12, "guide_length": 70.0, "guide_overhang": 45.0, "guide_viscous": 0.3}
PIVOT: Final = {"pivot": 0.11, "pivot_diameter": 22.0, "pivot_viscous": 0.8}

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
"""Of plate_translating."""


def friction(table: dict[str, float]) -> str:
    return "\n".join(["[effects.friction]", *(f"{key} = {each}" for key, each in table.items())])


def speed_of(scene: str, rev: float) -> tuple[str, str]:
    """The change of the scene's text that has it run at `rev` rev/min."""
    if scene == "ring":
        return 'rotation = "ccw"\n', f'rotation = "ccw"\nspeed = {rev!r}\n'
    now = {"plate_translating": 60, "shuttle": 120, "setzhub": 90, "groove": 30}[scene]
    return f"\nspeed = {now}\n", f"\nspeed = {rev!r}\n"


def omega(made: Design) -> float:
    return float(course_of(made).rates(np.zeros(1))[0, 0])


def lift(made: Design, phi: FloatArray) -> FloatArray:
    return np.asarray(made.cam.drive.motion.jet(phi)[0])


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


def cross(a: Any, b: Any) -> Any:
    return np.imag(np.conj(a) * b)


@dataclass(frozen=True)
class Bodies:
    """Cam, roller and follower at `phi`; velocities per unit of cam speed.

    `normal` is the force on the roller, above 0 of an inner flank.
    """

    cam: Cam
    phi: FloatArray
    normal: FloatArray

    def centre(self, phi: FloatArray) -> ComplexArray:
        turned: ComplexArray = self.cam.disc.pitch_curve.point(phi) * np.exp(
            1j * self.cam.rotation * phi
        )
        return turned

    @property
    def velocity(self) -> ComplexArray:
        """Of the roller's centre."""
        place, rate = self.cam.disc.pitch_curve.jet(self.phi)[:2]
        sigma = self.cam.rotation
        return np.asarray((rate + 1j * sigma * place) * np.exp(1j * sigma * self.phi))

    @property
    def outward(self) -> ComplexArray:
        """Normal of the pitch curve that points away from the disc."""
        rate, sigma = self.cam.disc.pitch_curve.jet(self.phi)[1], self.cam.rotation
        return np.asarray(1j * sigma * rate / np.abs(rate) * np.exp(1j * sigma * self.phi))

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
        return np.asarray(np.imag(self.velocity / (self.centre(self.phi) - follower.pivot)))

    @property
    def roller(self) -> FloatArray:
        """Angular velocity of the roller, whose material goes with the cam's at the contact."""
        of_cam = 1j * self.cam.rotation * (self.centre(self.phi) + self.arm)
        rate = (of_cam - self.velocity) / (1j * self.arm)
        assert np.max(np.abs(rate.imag)) <= ROUNDING * np.max(np.abs(rate.real))
        return np.asarray(rate.real)

    def moments(self, table: dict[str, float]) -> tuple[FloatArray, FloatArray]:
        """Of bearing and rolling on the roller [N mm]."""
        size = np.abs(self.normal)
        pin = 0.5 * table.get("roller_pin", 0.0) * table.get("roller_pin_diameter", 0.0) * size
        rolling = table["rolling"] * size
        return (
            -pin * np.sign(self.roller - self.turning),
            -rolling * np.sign(self.roller - self.cam.rotation),
        )

    def load(self, table: dict[str, float]) -> ComplexArray:
        """Force of the cam on the roller [N]: normal, and tangential by the roller's balance."""
        tangent = 1j * self.push
        pin, rolling = self.moments(table)
        share = -(pin + rolling) / cross(self.arm, tangent)
        return np.asarray(np.abs(self.normal) * self.push + share * tangent)

    def torque(self, table: dict[str, float]) -> FloatArray:
        """On the cam against its rotation [N mm], as the moment of that force about the axis."""
        place = self.centre(self.phi) + self.arm
        moment = cross(place, self.load(table)) + self.moments(table)[1]
        return np.asarray(self.cam.rotation * moment)

    def guide_reactions(self, table: dict[str, float], weight: complex) -> FloatArray:
        """(2, n) forces [N] to the right at both ends of the guide, a beam on two supports."""
        follower: Any = self.cam.follower
        out = np.exp(1j * follower.guide_angle)
        start = along(out, self.centre(np.zeros(1)))[0] + table["guide_overhang"]
        side = along(-1j * out, self.load(table) + weight)
        height, moment = along(out, self.centre(self.phi)), -self.moments(table)[0]
        rows = np.array([[1.0, 1.0], [-start, -start - table["guide_length"]]])
        return np.linalg.solve(rows, np.stack((-side, height * side - moment)))

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
        held = np.sum(np.abs(self.guide_reactions(table, other)), axis=0)
        return np.asarray(lost + table["guide"] * held * np.abs(self.velocity))
