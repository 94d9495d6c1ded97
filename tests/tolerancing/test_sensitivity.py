"""Exact sensitivities against two-sided differences of the exact motion, for all kinds."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from camgeo.errors import GeometryError
from camgeo.geometry.contour.contour import Contour
from camgeo.geometry.outline.replay import replay_contour
from camgeo.geometry.pitch_curve import PitchCurve, WorkingCurve
from camgeo.kinematics.mechanism.declared.registry import FOLLOWERS, LINKAGES
from camgeo.numeric.arrays import ComplexArray, FloatArray
from camgeo.studies.tolerancing import linear
from camgeo.studies.tolerancing.linear import replay_machines
from camgeo.studies.tolerancing.stated import (
    Deviations,
    Freedom,
    Sensitivities,
    UnitDeviation,
    Way,
    machine_dimensions,
)
from camgeo.units import TURN
from tests.tolerancing.machines import ANGLES, errors, fixture

MACHINES = (
    "plate_translating", "shuttle", "tappet", "flat_rocker", "ring", "groove", "setzhub",
    "four_bar", "crank_slider",
)  # fmt: skip
"""Scenes with every kind of follower and of linkage, on inner and outer flanks."""

STEP = 1e-3
"""Of the differences [mm or rad]; ten of them give an error a hundred times as large."""

ROUNDING = 1e-9
"""Of a difference, relative to the sensitivity: the motion's last digits over the step."""


def units_of(nominal: Sensitivities) -> dict[str, UnitDeviation]:
    """Of all dimensions, and of waves."""
    found = {key: each.unit for key, each in machine_dimensions(nominal.machine).items()}
    return found | {
        "cosine": UnitDeviation(Freedom(Way.WAVE, 5)),
        "sine": UnitDeviation(Freedom(Way.WAVE, 5), 1j),
        "clearance": UnitDeviation(Freedom(Way.GROWTH)),
    }


def difference(nominal: Sensitivities, unit: UnitDeviation, step: float) -> float:
    """Largest error of a two-sided difference."""
    upper, lower = errors(nominal, unit, step, -step)
    return float(np.max(np.abs((upper - lower) / (2.0 * step) - nominal.position_error(unit))))


def test_every_kind_has_a_machine() -> None:
    cams = [fixture(name).machine for name in MACHINES]
    assert {each.cam.follower.kind for each in cams} == set(FOLLOWERS)
    templates = {name for kind in LINKAGES.values() for name in kind.templates}
    assert len({type(each.linkage) for each in cams if each.linkage}) == len(templates)


@pytest.mark.parametrize("name", MACHINES)
def test_exact_sensitivities_are_the_limits_of_differences(name: str) -> None:
    nominal = fixture(name)
    for key, unit in units_of(nominal).items():
        small, large = (difference(nominal, unit, step) for step in (STEP, 10.0 * STEP))
        scale = float(np.max(np.abs(nominal.position_error(unit))))
        assert small <= 0.015 * large + ROUNDING * scale, key


def test_what_does_not_settle_is_told_with_its_place(monkeypatch: pytest.MonkeyPatch) -> None:
    """The first step is the linear error."""
    monkeypatch.setattr(linear, "STEPS", 1)
    nominal = fixture("tappet")
    unit = machine_dimensions(nominal.machine)["mounting.x"].unit
    worst = np.degrees(nominal.phi[np.argmax(np.abs(nominal.position_error(unit)))])
    assert worst > 1.0
    with pytest.raises(GeometryError, match=f"at cam angle {worst:.6g} deg"):
        errors(nominal, unit, 0.01)


@pytest.mark.parametrize("name", MACHINES)
def test_a_machine_without_deviations_makes_the_nominal_motion(name: str) -> None:
    nominal = fixture(name)
    machines = replay_machines(nominal, Deviations(1, {}))
    leverage = np.abs(nominal.nominal.leverage)
    np.testing.assert_allclose(machines.leverage[0], leverage, rtol=1e-12)
    found = machines.position[:, 0]
    demanded = nominal.positions[:3]
    scale = np.max(np.abs(demanded), axis=1, keepdims=True)
    np.testing.assert_allclose(found / scale, demanded / scale, rtol=0, atol=1e-11)


@pytest.mark.parametrize("name", MACHINES)
def test_velocity_and_acceleration_are_derivatives(name: str) -> None:
    """Of machines that deviate in everything at once, by differences along the cam angle.

    The error of a two-sided difference is h^2/6 of the derivative after the next.
    """
    nominal = fixture(name)
    units = units_of(nominal)
    sizes = {key: 0.02 * (1.0 + 0.1 * k) for k, key in enumerate(units)}
    values: dict[Freedom, ComplexArray] = {}
    for key, unit in units.items():
        size = sizes[key] * (0.05 if "angle" in key else 1.0)
        earlier = values.get(unit.freedom, np.zeros(1, complex))
        values[unit.freedom] = earlier + size * unit.factor
    deviations, step = Deviations(1, values), 1e-4
    borders = nominal.machine.cam.drive.motion.borders
    apart = np.abs(np.subtract.outer(ANGLES, borders)).min(axis=1)
    angles = ANGLES[apart > 0.05]  # the contact does not pass a border within a step

    def motion(shift: float) -> FloatArray:
        return replay_machines(replace(nominal, phi=angles + shift), deviations).position[:, 0]

    here = motion(0.0)
    slopes = (motion(step) - motion(-step)) / (2.0 * step)
    for order in (0, 1):
        scale = np.max(np.abs(here[order + 1]))
        np.testing.assert_allclose(slopes[order] / scale, here[order + 1] / scale, atol=3e-6)


@pytest.mark.parametrize(
    ("name", "key"),
    [("plate_translating", "offset"), ("shuttle", "arm"), ("shuttle", "roller_radius")],
)
def test_the_replay_of_contours_agrees(name: str, key: str) -> None:
    """`camgeo replay` presses another follower on a contour, which it computes in another way.

    It counts the lift from where that follower starts, so the same up to a constant. The contour's
    arcs follow the flank to the fourth power of a tenth of a degree.
    """
    nominal, size = fixture(name), 0.2
    cam = nominal.machine.cam
    changed = {key: getattr(cam.follower, key) + size}
    pitch = PitchCurve(cam.drive.motion, cam.sized(**changed).follower, cam.rotation)
    flank = WorkingCurve(cam.disc.pitch_curve, -cam.follower.roller_radius)
    points, tangents = flank.points_and_tangents(np.linspace(0.0, TURN, 3601)[:-1])
    turns = np.angle(np.roll(tangents, -1) / tangents)
    lift = replay_contour(pitch, Contour.through(points, turns).counter_clockwise()).lift
    exact = errors(nominal, machine_dimensions(nominal.machine)[f"follower.{key}"].unit, size)[0]
    apart = lift.displacement(nominal.phi) - cam.drive.motion.jet(nominal.phi)[0] - exact
    assert np.ptp(apart) <= 1e-6 * cam.follower.lift_scale
    assert np.ptp(exact) >= 1e-5 * cam.follower.lift_scale  # there is something to compare
