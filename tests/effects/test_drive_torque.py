from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import pytest

from camgeo.check.finding import Finding
from camgeo.design.design import Design
from camgeo.dynamics.effects.drive_torque import EFFECT
from camgeo.dynamics.effects.drive_torque.result import compute, moment_of_inertia, stored_energy
from camgeo.dynamics.effects.effect import Request, Results
from camgeo.dynamics.effects.forces import Force, at_rates, total
from camgeo.dynamics.effects.results import DriveTorque
from camgeo.errors import EffectError, GeometryError
from camgeo.numeric.arrays import FloatArray, Side, merged
from camgeo.numeric.extremes import grid_of, roots_on_grid
from camgeo.numeric.quadrature import piecewise_integrals
from camgeo.units import RPM, TURN
from tests.effects.scenes import design

EPS = float(np.finfo(np.float64).eps)

LAWS = (
    ('law = "modified-sine"', 'law = "polynomial-345"'),
    ("inflection = 0.4\n", ""),
)
"""Changes that give plate_translating two plain polynomials: 20 mm over 100 and 120 degrees."""


@dataclass(frozen=True, slots=True)
class Friction:
    """Coulomb's friction in the guide, `share` of the normal force, and at the roller."""

    subject: Design
    share: float
    rolling: float

    def per_normal(self, phi: FloatArray, side: Side, sense: int) -> FloatArray:
        """The sense of sliding is one for each piece, also at its ends, where nothing moves."""
        edges = self.subject.drive.smooth_angles
        senses = np.sign(self.subject.cam.drive.motion.jet(edges[:-1] + 0.5 * np.diff(edges))[1])
        row = np.searchsorted(edges, phi, "right" if side == "right" else "left") - 1
        sliding = senses[np.clip(row, 0, len(senses) - 1)]
        return np.stack((-self.share * sliding, np.full(len(phi), self.rolling)))


@dataclass(frozen=True, slots=True)
class DefinedForce:
    """A contact force as the effect of this name gives it, by its definition."""

    subject: Design
    forces: Sequence[Force]
    friction: Friction | None = None
    bearings: None = None
    edges: FloatArray = field(init=False)

    def __post_init__(self) -> None:
        base = self.subject.drive.smooth_angles
        roots = roots_on_grid(lambda phi: self.normal(phi, "right"), grid_of(base))
        object.__setattr__(self, "edges", merged(np.concatenate((base, roots))))

    def required(self, phi: FloatArray, side: Side) -> FloatArray:
        return -total(self.forces, phi, side)

    @property
    def lasting(self) -> Sequence[Force]:
        return self.forces

    def struck(self, phi: FloatArray, side: Side) -> FloatArray:
        return np.asarray(np.abs(self.required(phi, side)[3]))

    def demand(self, phi: FloatArray, side: Side) -> FloatArray:
        course = self.subject.drive.time_course
        rates = np.zeros((2, len(phi))) if course is None else course.rates(phi)
        return at_rates(self.required(phi, side), rates)

    def released(self, phi: FloatArray, side: Side, rates: FloatArray) -> FloatArray:
        return at_rates(self.required(phi, side), rates)

    def normal_at(self, phi: FloatArray, side: Side, rates: FloatArray) -> FloatArray:
        force = at_rates(self.required(phi, side), rates)
        leverage = self.subject.cam.disc.pitch_curve.leverage(phi, side)
        if self.friction is None:
            return force / leverage
        sense = np.where(force * leverage >= 0.0, 1, -1)
        parts = [self.friction.per_normal(phi, side, each)[0] for each in (1, -1)]
        bracket = sense * leverage + np.where(sense > 0, *parts)
        with np.errstate(divide="ignore"):  # the torque is to find what jams
            return np.asarray(sense * force / bracket)

    def normal(self, phi: FloatArray, side: Side) -> FloatArray:
        course = self.subject.drive.time_course
        rates = np.zeros((2, len(phi))) if course is None else course.rates(phi)
        return self.normal_at(phi, side, rates)


def inertia(subject: Design, mass: float) -> Force:
    def coefficients(phi: FloatArray, side: Side) -> FloatArray:
        jet, zero = subject.cam.drive.motion.jet(phi, side), np.zeros(len(phi))
        return np.stack((zero, zero, -mass * jet[2], -mass * jet[1]))

    return Force("inertia", coefficients)


def spring(subject: Design, preload: float, stiffness: float) -> Force:
    """A constant force against growing q, and one that grows with q."""

    def coefficients(phi: FloatArray, side: Side) -> FloatArray:
        q, zero = subject.cam.drive.motion.jet(phi, side)[0], np.zeros(len(phi))
        return np.stack((-preload - stiffness * q, zero, zero, zero))

    return Force("spring", coefficients)


def damper(subject: Design, viscous: float) -> Force:
    def coefficients(phi: FloatArray, side: Side) -> FloatArray:
        velocity, zero = subject.cam.drive.motion.jet(phi, side)[1], np.zeros(len(phi))
        return np.stack((zero, -viscous * velocity, zero, zero))

    return Force("damper", coefficients)


def drive(
    subject: Design, contact: DefinedForce, tolerance: float = 1e-9, **table: float
) -> DriveTorque:
    given = Results({"contact-force": contact})
    return compute(Request(subject.effects.subject, EFFECT.parse(table), given, tolerance))


def finding(result: Any, name: str) -> Finding:
    found: tuple[Finding, ...] = tuple(each for each in result.findings if each.name == name)
    assert len(found) == 1
    return found[0]


def value(result: Any, name: str) -> float:
    found = finding(result, name).value
    assert found is not None
    return found


@pytest.mark.parametrize("scene", ["plate_translating", "groove", "setzhub", "feed", "points"])
def test_conservative_forces_do_no_work_over_a_turn(scene: str) -> None:
    """Also with the speed curve of "points": omega is the same after a turn."""
    subject = design(scene, "")
    reach = abs(subject.cam.follower.reach)
    forces = (inertia(subject, 1e-3 * reach**2), spring(subject, 60.0 * reach, 4.0 * reach**2))
    result = drive(subject, DefinedForce(subject, forces))
    peak = max(abs(value(result, "largest-torque")), abs(value(result, "smallest-torque")))
    assert abs(value(result, "mean-torque")) <= 1e-12 * peak
    assert abs(value(result, "work-per-turn")) <= 1e-12 * TURN * peak


def test_a_constant_load_takes_its_peak_where_the_velocity_does() -> None:
    """F s' at its largest: 4 pi / (4 + pi) h / beta for the modified sine (VDI 2143-1, C_v)."""
    subject = design("plate_translating", "")
    result = drive(subject, DefinedForce(subject, (spring(subject, 300.0, 0.0),)))
    rise = 4.0 * math.pi / (4.0 + math.pi) * 20.0 / math.radians(100.0)
    found = finding(result, "largest-torque")
    # The extreme is sought by golden section: its value is exact except for rounding.
    assert found.value == pytest.approx(300.0 * rise / 1000.0, rel=1e-13)
    # A parabola is flat to rounding within the square root of eps of its top.
    assert found.cam_angle == pytest.approx(math.radians(80.0), abs=1e-6)


def test_root_mean_square_of_a_constant_load() -> None:
    """The mean square of f' of the polynomial 3-4-5 is 900 B(5, 5) = 10 / 7."""
    subject = design("plate_translating", "", *LAWS)
    result = drive(subject, DefinedForce(subject, (spring(subject, 300.0, 0.0),)), 1e-12)
    turns = 1.0 / math.radians(100.0) + 1.0 / math.radians(120.0)
    rms = 300.0 * 20.0 * math.sqrt(10.0 / 7.0 * turns / TURN)
    # The rule is exact for the polynomial; what is left is rounding.
    assert value(result, "rms-torque") == pytest.approx(rms / 1000.0, rel=1e-13)


def test_root_mean_square_with_a_speed_curve_is_over_time() -> None:
    subject = design("points", "")
    result = drive(subject, DefinedForce(subject, (spring(subject, 60.0, 4.0),)))
    course = subject.drive.time_course
    assert course is not None
    # Midpoints in time, of 1e5 parts: the error of a periodic C1 integrand is far below 1e-6.
    duration = float(np.diff(course.time(np.array([0.0, TURN])))[0])
    times = (np.arange(100_000) + 0.5) / 100_000 * duration
    grid = np.linspace(0.0, TURN, 200_001)
    phi = np.interp(times, course.time(grid) - course.time(grid[:1]), grid)
    rms = math.sqrt(float(np.mean(result.torque(phi, "right") ** 2))) / 1000.0
    assert value(result, "rms-torque") == pytest.approx(rms, rel=1e-6)


def test_power_balance_at_every_angle() -> None:
    """Drive power is the force's power on the follower and the loss, which is never negative."""
    subject = design("plate_translating", "")
    friction = Friction(subject, 0.1, 0.3)
    forces = (inertia(subject, 2e-3), spring(subject, 60.0, 4.0), damper(subject, 0.5))
    contact = DefinedForce(subject, forces, friction)
    result = drive(subject, contact)
    phi = np.linspace(0.0, TURN, 2001)[1:-1]
    velocity = subject.cam.drive.motion.jet(phi)[1]
    normal = contact.normal(phi, "right")
    rolling = friction.rolling * np.abs(normal)
    sense = np.where(normal >= 0.0, 1, -1)
    sliding = friction.share * np.abs(normal) * np.abs(velocity)
    course = subject.drive.time_course
    assert course is not None
    force = at_rates(contact.required(phi, "right"), course.rates(phi))
    torque = result.torque(phi, "right")
    given = force * velocity + rolling + sliding
    scale = np.max(np.abs(torque))
    # Both sides take a few dozen roundings of quantities of this size.
    assert np.max(np.abs(torque - given)) <= 100.0 * EPS * scale
    leverage = subject.cam.disc.pitch_curve.leverage(phi)
    by_normal = sense * np.abs(normal) * leverage * velocity + rolling
    assert np.max(np.abs(torque - by_normal)) <= 100.0 * EPS * scale
    assert value(result, "mean-power") > 0.0


def test_static_and_dynamic_parts() -> None:
    subject = design("plate_translating", "")
    contact = DefinedForce(subject, (inertia(subject, 2e-3), spring(subject, 60.0, 4.0)))
    result = drive(subject, contact)
    phi = np.linspace(0.0, TURN, 721)
    s, s1, s2 = subject.cam.drive.motion.jet(phi)[:3]
    static, dynamic = (60.0 + 4.0 * s) * s1, 2e-3 * TURN**2 * s2 * s1  # 60 rev/min
    scale = np.max(np.abs(static))
    assert np.max(np.abs(result.static(phi, "right") - static)) <= 10.0 * EPS * scale
    assert (
        np.max(np.abs(result.torque(phi, "right") - result.static(phi, "right") - dynamic))
        <= 10.0 * EPS * scale
    )
    total_torque, slow, fast = (each.values(phi, "right") for each in result.columns)
    assert np.allclose(total_torque, slow + fast, rtol=0.0, atol=10.0 * EPS * scale)
    alpha = np.full(len(phi), 3.0)
    at = result.at(phi, "right", 2.0 * TURN + 0.0 * phi, alpha)
    assert np.max(np.abs(at - static - 4.0 * dynamic - 6e-3 * s1**2)) <= 20.0 * EPS * scale


def test_without_speed_there_is_only_the_static_part() -> None:
    subject = design("ring", "")
    result = drive(subject, DefinedForce(subject, (spring(subject, -60.0, 0.0),)))
    assert [each.name for each in result.columns] == ["drive torque"]
    names = {each.name for each in result.findings}
    assert "mean-power" not in names
    assert "largest-static-torque" not in names
    with pytest.raises(GeometryError) as caught:
        drive(subject, DefinedForce(subject, (spring(subject, -60.0, 0.0),)), fluctuation=0.01)
    assert caught.value.key == "effects.drive-torque.fluctuation"


def test_the_limit_holds_in_both_directions() -> None:
    subject = design("plate_translating", "")
    contact = DefinedForce(subject, (spring(subject, 300.0, 0.0),))
    largest = 1000.0 * value(drive(subject, contact), "largest-torque")
    smallest = 1000.0 * value(drive(subject, contact), "smallest-torque")
    assert largest > -smallest > 0.0
    between = 0.5 * (largest - smallest)
    result = drive(subject, contact, limit=between)
    assert finding(result, "largest-torque").severity == "broken"
    assert finding(result, "smallest-torque").severity == "ok"
    assert finding(result, "smallest-torque").limit == -between / 1000.0
    assert result.columns[0].limit == between / 1000.0


def test_the_follower_jams_where_friction_takes_all() -> None:
    subject = design("plate_translating", "")
    rise = np.radians(np.linspace(30.0, 130.0, 401))  # on the way down friction helps the cam
    mu = float(np.min(subject.cam.disc.pitch_curve.leverage(rise)))
    contact = DefinedForce(
        subject, (spring(subject, 60.0, 4.0),), Friction(subject, mu + 0.02, 0.0)
    )
    with pytest.raises(EffectError) as caught:
        drive(subject, contact)
    assert caught.value.finding == "jamming"
    assert caught.value.unit == "deg"
    place = np.array([caught.value.cam_angle])
    assert subject.cam.disc.pitch_curve.leverage(place)[0] <= mu + 0.02


def test_shocks_are_reported() -> None:
    subject = design("plate_translating", "")
    held = drive(
        subject, DefinedForce(subject, (inertia(subject, 2e-3), spring(subject, 90.0, 0.0)))
    )
    assert not [each for each in held.findings if each.severity != "ok"]
    jumping = design("straight_moves", "")
    moved = drive(
        jumping, DefinedForce(jumping, (inertia(jumping, 2e-3), spring(jumping, 900.0, 0.0)))
    )
    assert finding(moved, "shock").severity == "broken"
    light = drive(jumping, DefinedForce(jumping, (spring(jumping, 900.0, 0.0),)))
    assert "shock" not in {each.name for each in light.findings}


def test_energy_of_a_sinusoidal_torque() -> None:
    """T_m + A sin(k phi) lets the energy vary by 2 A / k."""

    def torque(phi: FloatArray) -> FloatArray:
        return np.asarray(5.0 + 3.0 * np.sin(2.0 * phi))

    stored = stored_energy(torque, 5.0, 0.0, np.linspace(0.0, TURN, 4), 1e-13)
    assert stored.span == pytest.approx(3.0, rel=1e-13)
    # E = -(3 / 2) (1 - cos 2 phi): smallest at 90 and 270 degrees
    assert stored.extremes.lowest.place == pytest.approx(math.pi / 2.0, abs=1e-12)


def test_energy_of_a_torque_that_jumps() -> None:
    """On for a quarter of the turn: 3 / 4 of its work comes from the flywheel."""
    edges = np.array([0.0, 0.5 * math.pi, TURN])

    def torque(phi: FloatArray) -> FloatArray:
        return np.where(phi < 0.5 * math.pi, 8.0, 0.0)

    stored = stored_energy(torque, 2.0, 0.0, edges, 1e-13)
    assert stored.span == pytest.approx(6.0 * 0.5 * math.pi, rel=1e-14)


def test_flywheel_of_a_published_example() -> None:
    """Khurmi and Gupta, Theory of Machines, example 16.1: a flywheel of 6.5 t with 1.8 m radius of
    gyration stores 56 kN m at 120 rev/min; its speeds are 121 and 119 rev/min.
    """
    moment = 6500.0 * 1.8**2  # kg m^2
    swing = 56e6 / (1e3 * moment * (120.0 * RPM) ** 2)
    assert round(120.0 * (1.0 + 0.5 * swing)) == 121
    assert round(120.0 * (1.0 - 0.5 * swing)) == 119
    assert moment_of_inertia(56e6, swing, 120.0 * RPM) == pytest.approx(1e3 * moment, rel=1e-15)


def test_the_flywheel_of_a_cam() -> None:
    subject = design("plate_translating", "")
    contact = DefinedForce(subject, (spring(subject, 300.0, 0.0),))
    result = drive(subject, contact, fluctuation=0.02)
    # A constant load stores F h on the way up and gives it back.
    assert value(result, "energy-fluctuation") == pytest.approx(6.0, rel=1e-12)
    assert value(result, "flywheel") == pytest.approx(6.0 / (0.02 * TURN**2), rel=1e-12)


@pytest.mark.parametrize("tolerance", [1e-3, 1e-6, 1e-9, 1e-13])
def test_the_error_is_within_the_tolerance_and_holds(tolerance: float) -> None:
    """Sharp peaks inside a piece, so that halving has to do the work."""
    subject = design("plate_translating", "")

    def coefficients(phi: FloatArray, side: Side) -> FloatArray:
        zero = np.zeros(len(phi))
        return np.stack((-1.0 / (0.01 + np.sin(4.5 * phi) ** 2), zero, zero, zero))

    contact = DefinedForce(subject, (Force("load", coefficients),))
    result = drive(subject, contact, tolerance)
    best = drive(subject, contact, 1e-13)
    assert result.error is not None
    assert result.error <= tolerance
    peak = value(best, "largest-torque")
    for name in ("mean-torque", "rms-torque"):
        gone = abs(value(result, name) - value(best, name))
        assert gone <= (result.error + 10.0 * EPS) * peak


def test_integrals_that_cannot_be_had_say_so() -> None:
    """Noise far above the tolerance stops at the largest number of stretches."""

    def noise(phi: FloatArray) -> FloatArray:
        return np.asarray(1.0 + 1e-3 * np.sin(1e12 * phi))

    _, error = piecewise_integrals(noise, np.array([0.0, TURN]), 1e-9)
    assert error > 1e-9 * TURN


def test_a_cam_without_forces_takes_no_torque() -> None:
    subject = design("plate_translating", "")
    result = drive(subject, DefinedForce(subject, (spring(subject, 0.0, 0.0),)), fluctuation=0.1)
    assert result.error == 0.0
    for name in ("largest-torque", "rms-torque", "mean-torque", "flywheel"):
        assert value(result, name) == 0.0


def test_from_the_scene() -> None:
    """With the real effects behind it: T is what the normal force and the roller ask for."""
    tables = """
[effects.inertia]
mass = 0.8
[effects.spring]
stiffness = 4
preload = 60
[effects.friction]
guide = 0.1
guide_viscous = 0.05
rolling = 0.05
[effects.drive-torque]
limit = 2
fluctuation = 0.02
"""
    subject = design("plate_translating", tables)
    result, contact = subject.effect("drive-torque"), subject.effect("contact-force")
    phi = np.linspace(0.0, TURN, 1001)[1:-1]
    normal = contact.normal(phi, "right")
    assert np.min(normal) > 0.0
    torque = (
        normal * subject.cam.disc.pitch_curve.leverage(phi) * subject.cam.drive.motion.jet(phi)[1]
    )
    torque += normal * contact.friction.per_normal(phi, "right", 1)[1]
    scale = np.max(np.abs(torque))
    assert np.max(np.abs(result.torque(phi, "right") - torque)) <= 50.0 * EPS * scale
    assert finding(result, "largest-torque").severity == "broken"
    assert finding(result, "largest-torque").limit == 2.0
    assert value(result, "mean-torque") > 0.0
    assert value(result, "flywheel") > 0.0
