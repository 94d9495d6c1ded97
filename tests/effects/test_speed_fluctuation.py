from __future__ import annotations

import itertools
import math
from collections.abc import Callable
from dataclasses import dataclass
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from camgeo.design.design import Design
from camgeo.dynamics.effects.effect import DataFile, Request, Results
from camgeo.dynamics.effects.forces import Force
from camgeo.dynamics.effects.speed_fluctuation import Motor, parse, parse_motor
from camgeo.dynamics.effects.speed_fluctuation.result import SpeedFluctuation, compute
from camgeo.errors import EffectError, GeometryError
from camgeo.numeric.arrays import FloatArray, Side
from camgeo.numeric.quadrature import piecewise_integral
from camgeo.units import RPM, TURN
from tests.effects.scenes import design
from tests.effects.test_drive_torque import (
    DefinedForce,
    Friction,
    damper,
    drive,
    finding,
    inertia,
    spring,
    value,
)

EPS = float(np.finfo(np.float64).eps)

NO_LOAD = 12.0
"""rad/s"""


@dataclass(frozen=True, slots=True)
class Law:
    """A drive torque made of the six rows of its law."""

    rows: Callable[[FloatArray], tuple[FloatArray | float, ...]]

    @property
    def contact(self) -> Any:
        return SimpleNamespace(lasting=(), normal_at=lambda phi, *_: np.ones(len(phi)))

    def law(self, phi: FloatArray, side: Side) -> FloatArray:
        return np.stack([row + np.zeros(len(phi)) for row in self.rows(phi)])


def steady(
    subject: Design,
    torque: Any,
    moment: float,
    stall: float,
    tolerance: float = 1e-9,
    **more: Any,
) -> SpeedFluctuation:
    """Moment of inertia [t mm^2], stall torque [N mm]."""
    motor = {} if "file" in more else {"stall_torque": stall, "no_load_speed": NO_LOAD}
    spec = parse({"moment_of_inertia": moment, **motor, **more})
    return compute(
        Request(subject.effects.subject, spec, Results({"drive-torque": torque}), tolerance)
    )


@pytest.fixture(scope="module")
def plate() -> Design:
    return design("plate_translating", "")


def driven(subject: Design, mass: float = 2e-3, share: float = 0.1) -> Any:
    friction = Friction(subject, share, 0.3) if share else None
    forces = (inertia(subject, mass), spring(subject, 90.0, 4.0), damper(subject, 0.2))
    return drive(subject, DefinedForce(subject, forces, friction))


def test_a_constant_load_is_met_on_the_motor_line(plate: Design) -> None:
    torque = Law(lambda phi: (600.0, 0.0, 0.0, 0.0, 1.0, 1.0))
    result = steady(plate, torque, 50.0, 2000.0)
    expected = NO_LOAD * (1.0 - 600.0 / 2000.0)
    phi = np.linspace(-1.0, 9.0, 333)
    assert np.max(np.abs(result.turn.omega(phi) / expected - 1.0)) <= 10.0 * EPS
    # In t, N, mm: alpha is a difference of torques of 600 N mm by J.
    assert np.max(np.abs(result.alpha(phi, "right"))) <= 10.0 * EPS * 2000.0 / 50.0
    assert result.fluctuation <= 20.0 * EPS
    assert result.mean_speed == pytest.approx(expected, rel=10.0 * EPS)
    # Power balance: what the motor gives a turn is the load's work.
    assert value(result, "motor-work") == pytest.approx(0.6 * TURN, rel=1e-13)


@pytest.mark.parametrize("stall", [1e9, 1e12])
def test_a_stiff_motor_keeps_the_speed(plate: Design, stall: float) -> None:
    """omega falls off the speed of no load by its torque over the slope of the motor's line."""
    torque = driven(plate)
    result = steady(plate, torque, 50.0, stall, 1e-12)
    phi = np.linspace(0.0, TURN, 500)
    cam = torque.at(phi, "right", np.full(500, NO_LOAD), np.zeros(500))
    slip = cam / stall
    # To first order; the second is the slip's change, (J omega slip') / (slope) by the slip:
    # 50 * 12 * (20 / rad) * 12 / stall of it.
    share = 50.0 * NO_LOAD**2 * 20.0 / stall
    largest = float(np.max(np.abs(slip)))
    assert (
        np.max(np.abs(result.turn.omega(phi) / NO_LOAD - 1.0 + slip)) <= share * largest + 8.0 * EPS
    )


def test_energy_is_kept_by_a_weak_motor(plate: Design) -> None:
    """(J + M q'^2) omega^2 / 2 + V = const except for the work of the motor, without friction."""
    mass, moment, stall = 2e-3, 40.0, 1e-2
    forces = (inertia(plate, mass), spring(plate, 90.0, 4.0))
    result = steady(plate, drive(plate, DefinedForce(plate, forces)), moment, stall, 1e-8)
    phi = np.linspace(0.0, TURN, 1000)
    q, q1 = plate.cam.drive.motion.jet(phi)[:2]
    omega = result.turn.omega(phi)
    energy = 0.5 * (moment + mass * q1**2) * omega**2 + 90.0 * q + 2.0 * q**2
    allowed = TURN * stall * np.max(np.abs(1.0 - omega / NO_LOAD))
    assert result.error is not None
    allowed += 2.0 * (result.error + EPS) * np.max(energy)
    assert np.ptp(energy) <= allowed
    assert result.fluctuation > 0.1  # there is something to be kept


def test_a_heavy_flywheel_fluctuates_by_the_stored_energy(plate: Design) -> None:
    """delta = (E_max - E_min) / (J omega^2) as J grows, the next term smaller by delta."""
    torque = drive(plate, DefinedForce(plate, (spring(plate, 90.0, 4.0),)), fluctuation=0.01)
    energy = 1e3 * value(torque, "energy-fluctuation")
    off = []
    for moment in (1e4, 1e5, 1e6):
        result = steady(plate, torque, moment, 1000.0, 1e-12)
        expected = energy / (moment * result.mean_speed**2)
        off.append(abs(result.fluctuation / expected - 1.0))
        # the motor's torque changes by delta / 2 of its slope, over half a turn at most
        assert off[-1] <= expected + 1000.0 * TURN / (moment * NO_LOAD**2)
    assert off[2] < 0.2 * off[1] < 0.04 * off[0]


@pytest.mark.parametrize(("share", "preload"), [(0.0, 90.0), (0.1, 90.0), (0.1, -20.0)])
def test_equation_of_motion_and_power_balance(plate: Design, share: float, preload: float) -> None:
    """With the last of these the contact force changes its sign: friction has kinks there."""
    friction = Friction(plate, share, 0.3) if share else None
    forces = (inertia(plate, 2e-3), spring(plate, preload, 4.0), damper(plate, 0.2))
    torque = drive(plate, DefinedForce(plate, forces, friction))
    moment, stall = 60.0, 4000.0
    result = steady(plate, torque, moment, stall, 1e-11)
    phi = np.linspace(0.0, TURN, 999)
    omega, alpha = result.turn.omega(phi), result.alpha(phi, "right")
    motor = stall * (1.0 - omega / NO_LOAD)
    cam = torque.at(phi, "right", omega, alpha)
    scale = np.max(np.abs(cam)) + stall
    assert np.max(np.abs(moment * alpha - motor + cam)) <= 50.0 * EPS * scale
    # alpha is the slope of omega^2 / 2: their integral over parts of the turn.
    for end in (1.0, 2.0, 4.5):
        edges = result.turn.mesh.low
        edges = np.append(edges[edges < end], end)
        found = piecewise_integral(lambda x: result.alpha(x, "right"), edges, 1e-12).value
        gone = 0.5 * float(np.diff(result.turn.omega(np.array([0.0, end])) ** 2)[0])
        largest = 0.5 * float(np.max(omega)) ** 2
        assert abs(found - gone) <= 4.0 * 1e-11 * largest

    def balance(x: FloatArray) -> FloatArray:
        speed = result.turn.omega(x)
        taken = torque.at(x, "right", speed, result.alpha(x, "right"))
        return np.asarray(stall * (1.0 - speed / NO_LOAD) - taken)

    # The cells end at the kinks of friction, which the edges do not know.
    cells = np.append(result.turn.mesh.low, TURN)
    left = piecewise_integral(balance, cells, 1e-12).value
    # The speed's error e changes J omega^2 / 2 by J omega^2 e, and the motor's torque by its slope.
    most = (moment * NO_LOAD**2 + TURN * stall) * 1e-11
    assert abs(left) <= 4.0 * most
    losses = value(result, "motor-work")
    assert losses > 0.0


@pytest.mark.parametrize("moment", [8.0, 100.0])
def test_against_a_general_integrator(plate: Design, moment: float) -> None:
    """A turn of DOP853 in omega over time-like steps comes back to where it began."""
    torque = driven(plate)
    stall = 5000.0
    result = steady(plate, torque, moment, stall, 1e-10)

    def slope(phi: float, y: FloatArray) -> list[float]:
        at, omega = np.array([phi]), math.sqrt(2.0 * y[0])
        motor = stall * (1.0 - omega / NO_LOAD)
        # The spring keeps the roller on its flank, where T is linear in alpha.
        two = np.array([0.0, 1.0])
        at_rest, at_one = torque.at(at + 0.0 * two, "right", omega + 0.0 * two, two)
        return [(motor - at_rest) / (moment + at_one - at_rest)]

    edges = plate.drive.smooth_angles
    start = 0.5 * float(result.turn.omega(np.zeros(1))[0]) ** 2
    y = start
    for low, high in itertools.pairwise(edges):
        inset = 1e-12 * (high - low)
        solution = solve_ivp(
            slope, (low + inset, high - inset), [y], method="DOP853", rtol=1e-8, atol=1e-8
        )
        y = float(solution.y[0, -1])
        expected = float(result.turn.omega(np.array([high]))[0])
        # Some dozen steps with errors of 1e-8 of y each.
        assert math.sqrt(2.0 * y) == pytest.approx(expected, rel=5e-7)
    assert y == pytest.approx(start, rel=1e-6)


@pytest.mark.parametrize("kinked", [False, True])
def test_the_error_holds_as_the_tolerance_falls(plate: Design, kinked: bool) -> None:
    """Against the tightest; kinks are of friction and, if so, of the motor's curve."""
    torque = driven(plate)
    file = DataFile("m.csv", b"n;M\n0;8\n60;7\n100;6\n112;2\n120;-3\n")
    more = {"file": file} if kinked else {}
    phi = np.linspace(0.0, TURN, 2000)
    best = steady(plate, torque, 9.0, 6000.0, 1e-13, **more).turn.omega(phi)
    reached = []
    for tolerance in (1e-3, 1e-6, 1e-9):
        result = steady(plate, torque, 9.0, 6000.0, tolerance, **more)
        assert result.error is not None
        assert 0.0 < result.error <= tolerance
        reached.append(float(np.max(np.abs(result.turn.omega(phi) - best)) / np.max(best)))
        assert reached[-1] <= result.error + 1e-13
    assert reached[-1] < reached[0]


def test_a_motor_too_weak_stalls_where_the_torque_beats_it(plate: Design) -> None:
    """With little inertia it comes to rest as soon as the static torque reaches its own."""
    torque = driven(plate, mass=1e-9)
    stall = 1000.0
    for moment in (1e-3, 1e-2):
        with pytest.raises(EffectError) as caught:
            steady(plate, torque, moment, stall)
        assert caught.value.finding == "stall"
        assert caught.value.value == stall / 1000.0
        phi = np.linspace(0.0, TURN, 36001)
        static = torque.static(phi, "right")
        place = phi[np.argmax(static > stall)]
        angle = caught.value.cam_angle
        assert angle is not None
        # The inertia carries it on by the kinetic energy over the missing torque, less than 1 deg.
        assert place - math.radians(0.25) <= angle <= place + math.radians(1.5)


def test_a_motor_too_weak_for_the_mean_torque_stalls(plate: Design) -> None:
    torque = driven(plate)
    mean = 1000.0 * value(torque, "mean-torque")
    for moment in (10.0, 1e4):
        with pytest.raises(EffectError) as caught:
            steady(plate, torque, moment, 0.3 * mean)
        assert caught.value.finding == "stall"
    # Inertia helps over the peak, so that little more than the mean will do.
    assert steady(plate, torque, 1e4, 1.5 * mean).mean_speed > 0.0


def test_the_slowest_orbits_are_found_where_newton_fails(plate: Design) -> None:
    """A motor that only just carries a light cam over its peak, at a near standstill."""
    torque = driven(plate, mass=1e-9)
    peak = 1000.0 * value(torque, "largest-static-torque")
    result = steady(plate, torque, 5.0, 1.01 * peak, 1e-6)
    phi = np.linspace(0.0, TURN, 2000)
    assert np.min(result.turn.omega(phi)) > 0.0
    assert result.fluctuation > 0.5


def test_the_limit(plate: Design) -> None:
    torque = driven(plate)
    fluctuation = steady(plate, torque, 60.0, 4000.0).fluctuation
    for factor, severity in ((1.01, "ok"), (0.99, "broken")):
        result = steady(plate, torque, 60.0, 4000.0, limit=factor * fluctuation)
        found = finding(result, "speed-fluctuation")
        assert (found.severity, found.value) == (severity, fluctuation)
    speed, motor = (each.values(np.zeros(1), "right")[0] for each in result.columns)
    assert speed * RPM == pytest.approx(float(result.turn.omega(np.zeros(1))[0]), rel=4.0 * EPS)
    assert 1000.0 * motor == pytest.approx(4000.0 * (1.0 - speed * RPM / NO_LOAD), abs=1e-9)
    low, high = value(result, "smallest-speed"), value(result, "largest-speed")
    assert (high - low) * RPM / result.mean_speed == pytest.approx(fluctuation, rel=1e-12)


def test_no_steady_state_with_shocks_or_a_follower_that_jams(plate: Design) -> None:
    subject = design("straight_moves", "")
    torque = drive(
        subject, DefinedForce(subject, (inertia(subject, 2e-3), spring(subject, 900.0, 0.0)))
    )
    with pytest.raises(EffectError) as caught:
        steady(subject, torque, 50.0, 9000.0)
    assert caught.value.finding == "shock"
    # Without a mass nothing jumps.
    light = drive(subject, DefinedForce(subject, (spring(subject, 900.0, 0.0),)))
    assert steady(subject, light, 500.0, 9000.0).mean_speed > 0.0

    def rows(phi: FloatArray) -> tuple[FloatArray | float, ...]:
        return 5.0, 0.0, 0.0, 0.0, np.where(phi > 3.0, np.nan, 1.0), 1.0

    with pytest.raises(EffectError) as caught:
        steady(plate, Law(rows), 50.0, 9000.0)
    assert caught.value.finding == "jamming"
    assert caught.value.cam_angle is not None
    assert caught.value.cam_angle > 3.0


def test_where_the_roller_would_have_to_be_pulled(plate: Design) -> None:
    torque = drive(plate, DefinedForce(plate, (inertia(plate, 2e-2), spring(plate, 20.0, 0.0))))
    result = steady(plate, torque, 60.0, 4000.0)
    assert result.lost_contact
    kept = steady(plate, driven(plate), 60.0, 4e3)
    assert not kept.lost_contact
    assert all(each.severity == "ok" for each in kept.findings)


def test_a_file_of_two_rows_is_the_line(plate: Design) -> None:
    torque = driven(plate)
    rpm = NO_LOAD / RPM
    file = DataFile("m.csv", f"speed [rev/min];torque [N m]\n0;4\n{rpm!r};0\n".encode())
    by_line = steady(plate, torque, 60.0, 4000.0)
    by_file = steady(plate, torque, 60.0, 0.0, file=file)
    assert by_file.mean_speed == pytest.approx(by_line.mean_speed, rel=1e-13)


def test_the_motor_goes_on_beyond_its_rows() -> None:
    motor = Motor(np.array([10.0, 20.0, 30.0]), np.array([50.0, 40.0, 10.0]))
    torque, slope = motor.torque(np.array([0.0, 15.0, 20.0, 25.0, 40.0]))
    assert torque.tolist() == [60.0, 45.0, 40.0, 25.0, -20.0]
    assert slope.tolist() == [-1.0, -1.0, -3.0, -3.0, -3.0]
    assert motor.no_load_speed == pytest.approx(100.0 / 3.0, rel=EPS)


@pytest.mark.parametrize(
    ("table", "key"),
    [
        ({}, "stall_torque"),
        ({"stall_torque": 1.0}, "no_load_speed"),
        ({"stall_torque": 0.0, "no_load_speed": 1.0}, "stall_torque"),
        ({"stall_torque": 1.0, "file": DataFile("m.csv", b"0;1\n1;0\n")}, "stall_torque"),
        ({"file": DataFile("m.csv", b"0;1\n1;2\n")}, "file"),
        ({"file": DataFile("m.csv", b"1;1\n0;0\n")}, "file"),
        ({"file": DataFile("m.csv", b"-1;1\n0;0\n")}, "file"),
    ],
)
def test_motors_that_are_refused(table: dict[str, Any], key: str) -> None:
    with pytest.raises(GeometryError) as caught:
        parse_motor(table)
    assert caught.value.key == key


@pytest.mark.parametrize("table", [{}, {"moment_of_inertia": 0.0}])
def test_a_shaft_without_inertia_is_refused(table: dict[str, Any]) -> None:
    with pytest.raises(GeometryError) as caught:
        parse({"stall_torque": 1.0, "no_load_speed": 1.0, **table})
    assert caught.value.key == "moment_of_inertia"


def test_forces_with_borders_of_their_own(plate: Design) -> None:
    """A load that jumps inside a piece: the cells end there, and high order is kept."""

    def coefficients(phi: FloatArray, side: Side) -> FloatArray:
        at = np.mod(phi, TURN)
        past = at >= 1.7 if side == "right" else at > 1.7
        zero = np.zeros(len(phi))
        return np.stack((np.where(past, -90.0, -50.0), zero, zero, zero))

    load = Force("load", coefficients, borders=np.array([1.7]))
    contact = DefinedForce(plate, (load,))
    result = steady(plate, drive(plate, contact), 60.0, 4000.0, 1e-12)
    mesh = result.turn.mesh
    assert 1.7 in mesh.low
    # Cells of a 24th of a turn at most, and their halves; hardly any had to be divided more.
    assert len(mesh.low) <= 100
    before, after = (result.alpha(np.array([1.7]), side)[0] for side in ("left", "right"))
    velocity = plate.cam.drive.motion.jet(np.array([1.7]))[1, 0]
    assert before - after == pytest.approx(40.0 * velocity / 60.0, rel=1e-9)


def test_from_the_scene() -> None:
    """With the real effects behind it; the table's units are those of a scene."""
    tables = """
[effects.inertia]
mass = 0.8
[effects.spring]
stiffness = 4
preload = 60
[effects.friction]
guide = 0.1
rolling = 0.05
[effects.drive-torque]
[effects.speed-fluctuation]
moment_of_inertia = 0.05
no_load_speed = 80
stall_torque = 20
tolerance = 1e-8
"""
    subject = design("plate_translating", tables)
    result = subject.effect("speed-fluctuation")
    assert result.error <= 1e-8
    torque = subject.effect("drive-torque")
    phi = np.linspace(0.0, TURN, 500)
    omega, alpha = result.turn.omega(phi), result.alpha(phi, "right")
    motor = 20e3 * (1.0 - omega / (80.0 * RPM))
    left = 50.0 * alpha - motor + torque.at(phi, "right", omega, alpha)
    assert np.max(np.abs(left)) <= 50.0 * EPS * 20e3
    assert 70.0 < value(result, "mean-speed") < 80.0


def test_the_same_scene_gives_the_same_numbers(plate: Design) -> None:
    phi = np.linspace(0.0, TURN, 100)
    first, second = (steady(plate, driven(plate), 9.0, 4000.0).turn.omega(phi) for _ in range(2))
    assert first.tobytes() == second.tobytes()
