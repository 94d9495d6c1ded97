"""What accuracy buys, against bare sampling of both motions and the theory of its orders."""

from __future__ import annotations

import math
from functools import cache
from typing import Final

import numpy as np
import pytest

import camgeo
from camgeo.app.answers.accuracy import harmonics
from camgeo.design.design import Design
from camgeo.dynamics.effects.results import CONTACT_FORCE
from camgeo.geometry.contour.contour import Form
from camgeo.numeric.arrays import SIDES
from camgeo.studies.accuracy import benefit
from camgeo.studies.accuracy.benefit import BenefitRow, benefit_rows, exact_motion
from camgeo.units import RPM
from tests.answers.documents import FIXTURES
from tests.effects.scenes import design
from tests.findings import known

LOADED: Final = (
    "[effects.inertia]\nmoment_of_inertia = 0.02\n[effects.spring]\nstiffness = 3\npreload = 480\n"
)
SPEEDS: Final = (10.0, 30.0)


@cache
def setzhub() -> Design:
    return design("setzhub", LOADED)


@cache
def rows(form: Form) -> tuple[BenefitRow, ...]:
    return benefit_rows(setzhub(), (1e-1, 1e-3), SPEEDS, forms=(form,))


def written(form: Form, tolerance: float) -> Design:
    edits = {"state.motion": "written", "state.contour": form, "output.tolerance": tolerance}
    return Design(setzhub().scene.with_values(edits))


@pytest.mark.parametrize("form", ["arcs", "polyline"])
def test_the_deviation_is_that_of_dense_samples(form: Form) -> None:
    (row, _, _, _) = rows(form)
    state, demanded = written(form, 1e-1).effects.subject.state, setzhub().drive.plan
    phi = np.linspace(0.0, 2.0 * math.pi, 40001)
    off = SPEEDS[0] ** 2 * np.abs(state.output.jet(phi)[2] - demanded.jet(phi)[2])
    assert np.max(off) <= known(row.acceleration) * (1.0 + 1e-12)
    assert np.max(off) == pytest.approx(known(row.acceleration), rel=1e-2)
    jumps = []
    for shock in state.shocks:
        before, after = (state.output.jet(np.array([shock]), side)[1, 0] for side in SIDES)
        jumps.append(float(after - before))
    assert row.jump == pytest.approx(SPEEDS[0] * max(map(abs, jumps), default=0.0))
    assert bool(jumps) == (form == "polyline")


def test_acceleration_goes_with_the_square_of_the_speed_and_lift_off_does_not() -> None:
    for form in ("arcs", "polyline"):
        slow, fast, *_ = rows(form)
        assert fast.acceleration == pytest.approx(9.0 * known(slow.acceleration), rel=1e-12)
        assert fast.jump == pytest.approx(3.0 * slow.jump, rel=1e-12) if slow.jump else True
        assert fast.lift_off_speed == slow.lift_off_speed
        assert fast.ripple == pytest.approx(slow.ripple)


def test_at_the_speed_of_lift_off_the_lowest_force_is_none() -> None:
    (first, *_) = benefit_rows(setzhub(), (1e-2,), (10.0,), forms=("arcs",))
    (there,) = benefit_rows(setzhub(), (1e-2,), (known(first.lift_off_speed),), forms=("arcs",))
    assert abs(known(there.lowest)) <= 1e-9 * known(there.highest)
    assert there.lift_off_speed == pytest.approx(known(first.lift_off_speed), rel=1e-9)


def test_arcs_come_nearer_with_the_third_root_and_chords_do_not() -> None:
    """Over two decades by 100^(1/3), but for how the pieces fall; chords keep the acceleration off
    by that of a roller that turns about vertices.
    """
    coarse, fine = rows("arcs")[0], rows("arcs")[2]
    assert 0.5 < known(coarse.ripple) / known(fine.ripple) / 100.0 ** (1.0 / 3.0) < 2.0
    coarse, fine = rows("polyline")[0], rows("polyline")[2]
    assert known(fine.ripple) > 1.0
    assert 0.5 < known(coarse.ripple) / known(fine.ripple) < 2.0


def test_cubics_come_nearer_with_the_square_root() -> None:
    coarse, fine = rows("spline")[0], rows("spline")[2]
    assert 0.3 < known(coarse.ripple) / known(fine.ripple) / 100.0**0.5 < 3.0
    assert coarse.jump == fine.jump == 0.0


def test_the_force_is_off_by_the_inertia_of_what_the_acceleration_is_off() -> None:
    """At twice the speed the static forces cancel: dN grows with the acceleration alone."""
    made = benefit_rows(setzhub(), (1e-3,), (100.0, 200.0), forms=("arcs",))
    force = known(made[0].force)
    assert made[1].force == pytest.approx(4.0 * force, rel=1e-2)
    assert abs(known(made[0].lowest) - known(made[0].exact_lowest)) <= force * (1.0 + 1e-9)


@pytest.mark.parametrize("scene", ["querhub", "tappet", "flat_rocker"])
def test_without_forces_there_is_the_acceleration_alone(scene: str) -> None:
    (row,) = benefit_rows(design(scene, ""), (1e-2,), (5.0,), forms=("arcs",))
    assert row.acceleration is not None
    assert row.force is row.lowest is row.lift_off_speed is None
    assert row.fault == ""


def test_a_row_says_why_it_has_no_values() -> None:
    for scene in ("constant_breadth", "tappet"):
        (row,) = benefit_rows(design(scene, ""), (1e-2,), (5.0,), forms=("spline",))
        assert "a flat face on a contour of splines" in row.fault
        assert row.acceleration is row.ripple is row.strongest_octave is None


def test_joints_with_a_jump_of_the_acceleration_do_not_count_as_ripple() -> None:
    """A constant acceleration jumps from one end of its range to the other; within the tolerance of
    the place of a joint that is no deviation.
    """
    parabolic = design(
        "plate_translating", "", ('law = "modified-sine"', 'law = "quadratic-parabola"')
    )
    assert known(benefit_rows(parabolic, (1e-3,), (10.0,), forms=("arcs",))[0].ripple) < 0.5


def pressing(**state: str) -> Design:
    """A motor-driven press with an elastic train, at 300 rev/min."""
    scene = camgeo.load(FIXTURES / "effects" / "linked_press.toml").scene
    return Design(scene.with_values({"cam.speed": 300.0, "state": state}))


@pytest.mark.parametrize("output", ["elastic", "rigid"])
def test_forces_are_those_at_the_speed_asked_for_with_the_train_of_the_scene(output: str) -> None:
    """Whatever speed the motor of the scene finds; off by roundings of the largest force."""
    found = exact_motion(pressing(output=output), 300.0 * RPM)
    stated = pressing(output=output, speed="stated").effects.result(CONTACT_FORCE)
    assert (known(found.contact).behind is None) == (output == "rigid")
    phi = np.linspace(0.1, 6.2, 97)
    off = found.force(300.0 * RPM)(phi, "right") - stated.normal(phi, "right")
    assert np.max(np.abs(off)) <= 1e-12 * stated.extremes.magnitude


def test_the_lift_off_speed_is_that_of_the_effect() -> None:
    """For any speed at which it is asked for."""
    slow, fast = (exact_motion(pressing(output="rigid"), each * RPM) for each in (100.0, 300.0))
    effect = pressing(output="rigid", speed="stated").effects.result("lift-off")
    assert fast.lift_off_speed == 300.0 * RPM * effect.speed.value
    assert slow.lift_off_speed == pytest.approx(fast.lift_off_speed, rel=1e-12)


def test_an_elastic_train_on_too_many_pieces_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    """The acceleration is there, and the reason why there is no force."""
    monkeypatch.setattr(benefit, "MOST_PIECES", 20)
    (row,) = benefit_rows(pressing(), (1e-1,), (30.0,), forms=("polyline",))
    assert row.acceleration is not None
    assert row.force is row.lift_off_speed is None
    assert "up to 20 pieces" in row.fault


@pytest.mark.parametrize("name", ["groove_lever", "conjugate_lever", "yoke"])
def test_forces_on_a_follower_that_is_held_both_ways_are_those_of_the_effect(name: str) -> None:
    """Of both sides, each at its own speed; no speed is that of lift-off, as nothing lifts off."""
    made = camgeo.load(FIXTURES / "effects" / f"{name}.toml")
    for speed in (100.0, 600.0):
        (row,) = benefit_rows(made, (1e-2,), (speed * RPM,), forms=("arcs",))
        state = {"motion": "written", "contour": "arcs"}
        edits = {"cam.speed": speed, "output.tolerance": 1e-2, "state": state}
        own = Design(made.scene.with_values(edits)).effects.result(CONTACT_FORCE)
        demanded = Design(made.scene.with_values({"cam.speed": speed, "state": None}))
        exact = demanded.effects.result(CONTACT_FORCE)
        assert (row.lowest, row.highest) == (own.extremes.lowest.value, own.extremes.highest.value)
        assert row.exact_lowest == pytest.approx(exact.extremes.lowest.value, abs=1e-9)
        assert row.exact_highest == pytest.approx(exact.extremes.highest.value, rel=1e-12)
        assert row.exact_force == pytest.approx(exact.extremes.magnitude, rel=1e-12)
        assert row.lift_off_speed is row.exact_lift_off_speed is None
        assert row.fault == ""
        phi = np.linspace(0.0, 2.0 * math.pi, 20001)
        off = np.abs(own.normal(phi, "right") - exact.normal(phi, "right"))
        # Beside the joints at which the exact acceleration jumps; there the two are not compared.
        assert np.quantile(off, 0.999) <= known(row.force) <= 1.1 * np.max(off)


def test_the_strongest_octave_has_most_of_what_is_off() -> None:
    for row in rows("arcs"):
        assert row.octaves[known(row.strongest_octave)] == max(row.octaves)
    assert [harmonics(octave) for octave in range(4)] == ["1", "2-3", "4-7", "8-15"]
