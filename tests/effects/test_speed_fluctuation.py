"""Speed fluctuation on a motor: the equation of motion, its limits, and what has no answer."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from camgeo.design.design import Design
from camgeo.dynamics.effects import speed_fluctuation as steady_module
from camgeo.dynamics.effects.effect import DataFile, Request, Results
from camgeo.dynamics.effects.speed_fluctuation import SpeedFluctuation, compute
from camgeo.dynamics.effects.tables import Motor
from camgeo.dynamics.effects.tables import parse_speed_fluctuation as parse
from camgeo.errors import EffectError
from camgeo.numeric.arrays import FloatArray, Side
from camgeo.numeric.quadrature import piecewise_integral
from camgeo.scene.scene import load_scene
from camgeo.units import RPM, TURN
from tests.effects.scenes import SCENES, design
from tests.findings import finding, finding_values

EPS = float(np.finfo(np.float64).eps)

NO_LOAD = 12.0
"""rad/s"""


@dataclass(frozen=True, slots=True)
class Law:
    """A drive torque made of the six rows of its law."""

    rows: Callable[[FloatArray], tuple[FloatArray | float, ...]]

    @property
    def contact(self) -> Any:
        return SimpleNamespace(lasting=(), normal_at_rates=lambda phi, *_: np.ones(len(phi)))

    def law(self, phi: FloatArray, side: Side) -> FloatArray:
        return np.stack([row + np.zeros(len(phi)) for row in self.rows(phi)])


def steady(
    made: Design,
    moment: float,
    stall: float,
    tolerance: float = 1e-9,
    torque: Any = None,
    **more: Any,
) -> SpeedFluctuation:
    """Moment of inertia [t mm^2], stall torque [N mm]."""
    motor = {} if "file" in more else {"stall_torque": stall, "no_load_speed": NO_LOAD}
    spec = parse({"moment_of_inertia": moment, **motor, **more})
    given = Results({"drive-torque": torque or made.effect("drive-torque")})
    return compute(Request(made.effects.subject, spec, given, tolerance))


def driven(
    mass: float = 2.0, load: float = 0.0, preload: float = 90.0, rubbing: str = ""
) -> Design:
    """A follower with friction, a load against its motion [N], and a spring."""
    return design(
        "plate_translating",
        f"[effects.inertia]\nmass = {mass!r}\n[effects.load]\nconstant = {load!r}\n"
        f"[effects.spring]\nstiffness = 4\npreload = {preload!r}\n[effects.friction]\n"
        f"rolling = 0.3\nguide_viscous = 0.2\n{rubbing}\n[effects.drive-torque]\n",
    )


@pytest.fixture(scope="module")
def plate() -> Design:
    return driven()


def test_a_constant_load_is_met_on_the_motor_line(plate: Design) -> None:
    torque = Law(lambda phi: (600.0, 0.0, 0.0, 0.0, 1.0, 1.0))
    result = steady(plate, 50.0, 2000.0, torque=torque)
    expected = NO_LOAD * (1.0 - 600.0 / 2000.0)
    phi = np.linspace(-1.0, 9.0, 333)
    assert np.max(np.abs(result.turn.omega(phi) / expected - 1.0)) <= 10.0 * EPS
    # In t, N, mm: alpha is a difference of torques of 600 N mm by J.
    assert np.max(np.abs(result.alpha(phi, "right"))) <= 10.0 * EPS * 2000.0 / 50.0
    assert result.fluctuation <= 20.0 * EPS
    assert result.mean_speed == pytest.approx(expected, rel=10.0 * EPS)
    # Power balance: what the motor gives a turn is the load's work.
    assert finding_values(result.findings)["motor-work"] == pytest.approx(0.6 * TURN, rel=1e-13)


@pytest.mark.parametrize("load", [0.0, -110.0])
def test_equation_of_motion_and_power_balance(load: float) -> None:
    """With the second one the contact force changes its sign: friction has kinks there."""
    made, moment, stall = driven(load=load, rubbing="guide = 0.1"), 60.0, 4000.0
    torque, result = made.effect("drive-torque"), steady(made, moment, stall, 1e-11)
    phi = np.linspace(0.0, TURN, 999)
    omega, alpha = result.turn.omega(phi), result.alpha(phi, "right")
    motor = stall * (1.0 - omega / NO_LOAD)
    cam = torque.torque_at_rates(phi, "right", omega, alpha)
    scale = np.max(np.abs(cam)) + stall
    assert np.max(np.abs(moment * alpha - motor + cam)) <= 50.0 * EPS * scale
    # alpha is the slope of omega^2 / 2: their integral over parts of the turn.
    for end in (1.0, 2.0, 4.5):
        edges = result.turn.mesh.low
        edges = np.append(edges[edges < end], end)
        found = piecewise_integral(lambda x: result.alpha(x, "right"), edges, 1e-12).value
        gone = 0.5 * float(np.diff(result.turn.omega(np.array([0.0, end])) ** 2)[0])
        assert abs(found - gone) <= 4.0 * 1e-11 * 0.5 * float(np.max(omega)) ** 2

    def balance(x: FloatArray) -> FloatArray:
        speed = result.turn.omega(x)
        taken = torque.torque_at_rates(x, "right", speed, result.alpha(x, "right"))
        return np.asarray(stall * (1.0 - speed / NO_LOAD) - taken)

    # The cells end at the kinks of friction, which the edges do not know.
    left = piecewise_integral(balance, np.append(result.turn.mesh.low, TURN), 1e-12).value
    # The speed's error e changes J omega^2 / 2 by J omega^2 e, and the motor's torque by its slope.
    assert abs(left) <= 4.0 * (moment * NO_LOAD**2 + TURN * stall) * 1e-11
    assert finding_values(result.findings)["motor-work"] > 0.0
    assert bool(result.lost_contact) == (load < 0.0)


@pytest.mark.parametrize("kinked", [False, True])
def test_the_error_holds_as_the_tolerance_falls(plate: Design, kinked: bool) -> None:
    """Against the tightest; kinks are of friction and, if so, of the motor's curve."""
    file = DataFile("m.csv", b"n;M\n0;8\n60;7\n100;6\n112;2\n120;-3\n")
    more = {"file": file} if kinked else {}
    phi = np.linspace(0.0, TURN, 2000)
    best = steady(plate, 9.0, 6000.0, 1e-13, **more).turn.omega(phi)
    reached = []
    for tolerance in (1e-3, 1e-6, 1e-9):
        result = steady(plate, 9.0, 6000.0, tolerance, **more)
        assert result.error is not None
        assert 0.0 < result.error <= tolerance
        reached.append(float(np.max(np.abs(result.turn.omega(phi) - best)) / np.max(best)))
        assert reached[-1] <= result.error + 1e-13
    assert reached[-1] < reached[0]


def test_a_motor_too_weak_stalls_where_the_torque_beats_it() -> None:
    """With little inertia it comes to rest as soon as the static torque reaches its own."""
    light, stall, phi = driven(mass=1e-6), 1000.0, np.linspace(0.0, TURN, 36001)
    place = phi[np.argmax(light.effect("drive-torque").static(phi, "right") > stall)]
    for moment in (1e-3, 1e-2):
        with pytest.raises(EffectError) as caught:
            steady(light, moment, stall)
        assert (caught.value.finding, caught.value.value) == ("stall", stall / 1000.0)
        angle = caught.value.cam_angle
        assert angle is not None
        # The inertia carries it on by the kinetic energy over the missing torque, less than 1 deg.
        assert place - math.radians(0.25) <= angle <= place + math.radians(1.5)


def test_a_motor_too_weak_for_the_mean_torque_stalls(plate: Design) -> None:
    mean = 1000.0 * finding_values(plate.effects.findings("drive-torque"))["mean-torque"]
    for moment in (10.0, 1e4):
        with pytest.raises(EffectError) as caught:
            steady(plate, moment, 0.3 * mean)
        assert caught.value.finding == "stall"
    # Inertia helps over the peak, so that little more than the mean will do.
    assert steady(plate, 1e4, 1.5 * mean).mean_speed > 0.0


def test_the_slowest_orbits_are_found_where_newton_fails() -> None:
    """A motor that only just carries a light cam over its peak, at a near standstill."""
    light = driven(mass=1e-6)
    peak = 1000.0 * finding_values(light.effects.findings("drive-torque"))["largest-static-torque"]
    result = steady(light, 5.0, 1.01 * peak, 1e-6)
    assert np.min(result.turn.omega(np.linspace(0.0, TURN, 2000))) > 0.0
    assert result.fluctuation > 0.5


def test_the_limit(plate: Design) -> None:
    fluctuation = steady(plate, 60.0, 4000.0).fluctuation
    for factor, severity in ((1.01, "ok"), (0.99, "broken")):
        result = steady(plate, 60.0, 4000.0, limit=factor * fluctuation)
        found = finding(result.findings, "speed-fluctuation")
        assert (found.severity, found.value) == (severity, fluctuation)
    speed, motor = (each.values(np.zeros(1), "right")[0] for each in result.columns)
    assert speed * RPM == pytest.approx(float(result.turn.omega(np.zeros(1))[0]), rel=4.0 * EPS)
    assert 1000.0 * motor == pytest.approx(4000.0 * (1.0 - speed * RPM / NO_LOAD), abs=1e-9)
    low, high = (
        finding_values(result.findings)[f"{name}-speed"] for name in ("smallest", "largest")
    )
    assert (high - low) * RPM / result.mean_speed == pytest.approx(fluctuation, rel=1e-12)


def test_no_steady_state_with_a_follower_that_jams(plate: Design) -> None:
    def rows(phi: FloatArray) -> tuple[FloatArray | float, ...]:
        return 5.0, 0.0, 0.0, 0.0, np.where(phi > 3.0, np.nan, 1.0), 1.0

    with pytest.raises(EffectError) as caught:
        steady(plate, 50.0, 9000.0, torque=Law(rows))
    assert caught.value.finding == "jamming"
    assert caught.value.cam_angle is not None
    assert caught.value.cam_angle > 3.0


def test_the_motor_goes_on_beyond_its_rows() -> None:
    motor = Motor(np.array([10.0, 20.0, 30.0]), np.array([50.0, 40.0, 10.0]))
    torque, slope = motor.torque(np.array([0.0, 15.0, 20.0, 25.0, 40.0]))
    assert torque.tolist() == [60.0, 45.0, 40.0, 25.0, -20.0]
    assert slope.tolist() == [-1.0, -1.0, -3.0, -3.0, -3.0]
    assert motor.no_load_speed == pytest.approx(100.0 / 3.0, rel=EPS)


def test_cells_end_where_a_force_has_a_border(tmp_path: Path) -> None:
    """A load that bends inside a piece; hardly any of the cells has to be divided more."""
    (tmp_path / "load.csv").write_text("0;50\n97;50\n98;90\n360;50\n", "utf-8")
    text = (SCENES / "plate_translating.toml").read_text("utf-8")
    scene = tmp_path / "scene.toml"
    scene.write_text(
        f'{text}\n[effects.load]\nfile = "load.csv"\n[effects.drive-torque]\n', "utf-8"
    )
    mesh = steady(Design(load_scene(scene)), 60.0, 4000.0, 1e-12).turn.mesh
    for degrees in (97.0, 98.0):
        assert np.min(np.abs(mesh.low - math.radians(degrees))) <= 4.0 * EPS
    # Cells of a 24th of a turn at most, and their halves.
    assert len(mesh.low) <= 100


def test_a_mesh_has_no_more_cells_than_allowed(
    plate: Design, monkeypatch: pytest.MonkeyPatch
) -> None:
    """That bounds memory."""
    sizes: list[int] = []
    newton_step = steady_module.newton_step

    def noted(shaft: Any, mesh: Any, state: Any) -> Any:
        sizes.append(len(mesh.low))
        return newton_step(shaft, mesh, state)

    monkeypatch.setattr(steady_module, "newton_step", noted)
    steady(plate, 9.0, 6000.0, 1e-9)
    most = (max(sizes) - 1) // 2  # the finer mesh has twice as many
    assert most > min(sizes)
    sizes.clear()
    monkeypatch.setattr(steady_module, "MOST_CELLS", most)
    with pytest.raises(EffectError):
        steady(plate, 9.0, 6000.0, 1e-9)
    assert max(sizes) <= 2 * most
