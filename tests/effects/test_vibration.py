"""Vibration of the follower train: the exact response, its findings, and the hard cases."""

from __future__ import annotations

import math

import numpy as np
import pytest

from camgeo.design.design import Design
from camgeo.dynamics.effects.vibration import Vibration
from camgeo.errors import EffectError
from camgeo.kinematics.laws import make_law
from camgeo.kinematics.time_course import in_time
from camgeo.numeric.arrays import FloatArray, Side
from camgeo.units import TURN
from tests.effects.scenes import design
from tests.findings import finding
from tests.integrals import cells, integrals
from tests.numeric.shocks import shock_spectrum

PHI = np.linspace(0.0, TURN, 721)[:-1]


def made(scene: str, table: str, *changes: tuple[str, str], before: str = "") -> Design:
    return design(scene, f"{before}[effects.vibration]\n{table}\n", *changes)


def result(scene: str, table: str, *changes: tuple[str, str], before: str = "") -> Vibration:
    found = made(scene, table, *changes, before=before).effect("vibration")
    assert isinstance(found, Vibration)
    return found


def frequencies(found: Vibration) -> list[float | None]:
    return [each.value for each in found.findings if each.name == "natural-frequency"]


# -- the response --------------------------------------------------------------------------------


def test_after_a_rest_longer_than_the_transient_a_move_leaves_what_its_spectrum_says() -> None:
    """Modified sine by 20 mm in 100/360 s at 60 rev/min, behind a rest of 100 degrees.

    Of what was before 20 mm exp(-0.2 2 pi 90 100/360) = 3e-13 mm are left when it starts.
    """
    found = result("plate_translating", "natural_frequency = 90\ndamping = 0.2\ntolerance = 1e-13")
    (first, _) = (each for each in found.findings if each.name == "residual-vibration")
    share = shock_spectrum(make_law("modified-sine"), np.array([90.0 * 100.0 / 360.0]), 0.2)
    assert first.cam_angle == math.radians(130.0)
    assert first.value == pytest.approx(20.0 * float(share[0]), rel=0.0, abs=1e-12)
    settling = finding(found.findings, "settling")
    assert settling.value == pytest.approx(math.exp(-0.2 * TURN * 90.0 * 40.0 / 360.0), rel=1e-12)
    assert "longer than the transient" in settling.sentence


@pytest.mark.parametrize(
    "scene", ["plate_translating", "groove", "shuttle", "setzhub", "feed", "measured", "points"]
)
def test_the_output_obeys_its_equation_of_motion(scene: str) -> None:
    """x'' = -w^2 e - 2 D w e' at every angle, with e' from the differences of e."""
    found = result(scene, "natural_frequency = 31\ndamping = 0.04\ntolerance = 1e-12")
    w, step = TURN * 31.0, 1e-4
    inside = PHI[
        (np.min(np.abs(PHI[:, np.newaxis] - found.output.clock.edges), axis=1) > 4.0 * step)
    ]
    around = [found.output.deflection(inside + k * step, "right") for k in (-2, -1, 1, 2)]
    slope = (around[0] - 8.0 * around[1] + 8.0 * around[2] - around[3]) / (12.0 * step)
    omega = found.output.clock.course.rates(inside)[0]
    e = found.output.deflection(inside, "right")
    got = found.output.acceleration(inside, "right")
    size = float(np.max(np.abs(got)))
    # The differences err by step^4 / 30 of the fifth derivative, (31 / 0.5 per rad)^5 / 62 by e'.
    assert np.max(np.abs(got + w * w * e + 2.0 * 0.04 * w * omega * slope)) <= 1e-6 * size


@pytest.mark.parametrize("scene", ["plate_translating", "groove", "feed", "measured", "points"])
def test_the_acceleration_is_the_second_derivative_of_the_output(scene: str) -> None:
    """By the work over each piece: the change of x'^2 / 2 is the integral of x'' x'."""
    found = result(scene, "natural_frequency = 17\ndamping = 0.1\ntolerance = 1e-12")
    clock, course = found.output.clock, found.output.clock.course

    def velocity(phi: FloatArray, side: Side) -> FloatArray:
        timed = in_time(clock.motion.jet(phi, side), course, phi)
        return np.asarray(timed[1] + found.output.states(phi, side)[1])

    def per_angle(phi: FloatArray) -> FloatArray:
        return np.asarray(found.output.acceleration(phi, "right") / course.rates(phi)[0])

    low, high = cells(clock.edges[:-1], 30)
    before, after = velocity(low, "right"), velocity(high, "left")
    size = float(np.max(np.abs(before)))
    assert np.max(np.abs(integrals(per_angle, low, high) - (after - before))) <= 1e-9 * size


def test_the_largest_values_are_those_of_a_fine_grid() -> None:
    found = result("plate_translating", "natural_frequency = 40.3\ndamping = 0.01")
    fine = np.linspace(0.0, TURN, 200_001)
    deflection = np.abs(found.output.deflection(fine, "right"))
    acceleration = np.abs(found.output.acceleration(fine, "right"))
    error = finding(found.findings, "largest-motion-error")
    top = finding(found.findings, "largest-output-acceleration")
    # On the grid the peak is missed by half a step: (40.3 pi / 200000)^2 / 2 of it.
    assert error.value == pytest.approx(float(np.max(deflection)), rel=1e-6)
    assert error.value >= float(np.max(deflection))
    assert top.value == pytest.approx(float(np.max(acceleration)), rel=1e-6)
    assert error.cam_angle == pytest.approx(float(fine[np.argmax(deflection)]), abs=1e-4)


# -- where the data come from --------------------------------------------------------------------


@pytest.mark.parametrize(
    ("scene", "inertia", "table", "square"),
    [
        ("plate_translating", "mass = 0.8", "stiffness = 500", 500.0 / 0.8e-3),
        ("groove", "moment_of_inertia = 0.05", "torsional_stiffness = 2000", 2000.0 / 0.05),
        ("four_bar", "output_moment = 0.018", "torsional_stiffness = 900", 900.0 / 0.018),
    ],
)
def test_stiffness_and_mass_are_a_natural_frequency(
    scene: str, inertia: str, table: str, square: float
) -> None:
    """Of which the square [1/s^2] is their quotient."""
    hertz = math.sqrt(square) / TURN
    found = result(scene, f"{table}\ndamping = 0.1", before=f"[effects.inertia]\n{inertia}\n")
    assert frequencies(found) == pytest.approx([hertz], rel=1e-12)
    other = result(scene, f"natural_frequency = {hertz!r}\ndamping = 0.1")
    assert found.output.deflection(PHI, "right") == pytest.approx(
        other.output.deflection(PHI, "right"), rel=0.0, abs=1e-13
    )


def test_a_rocker_has_its_stiffness_and_limit_as_an_angle() -> None:
    table = "torsional_stiffness = 2000\ndamping = 0.05\nlimit_angle = 0.005"
    found = result("groove", table, before="[effects.inertia]\nmoment_of_inertia = 0.05\n")
    error = finding(found.findings, "largest-motion-error")
    assert (error.unit, error.severity) == ("deg", "broken")
    assert error.limit == pytest.approx(0.005, rel=1e-14)
    output = (found.output.deflection(PHI, "right"), found.output.acceleration(PHI, "right"))
    for column, own in zip(found.columns[:2], output, strict=True):
        assert column.values(PHI, "right") == pytest.approx(np.degrees(own), rel=1e-14)
    assert (found.columns[0].unit, found.columns[0].limit) == ("deg", error.limit)


# -- hard cases ----------------------------------------------------------------------------------


def test_near_resonance_warns_and_far_from_it_does_not() -> None:
    tables = ("40.01", "40.5", "40\ndamping = 0.05")
    near, far, damped = (
        finding(result("plate_translating", f"natural_frequency = {each}").findings, "resonance")
        for each in tables
    )
    assert (near.severity, far.severity, damped.severity) == ("warning", "ok", "ok")
    # 1 / ((40.01 / 40)^2 - 1) of a harmonic comes back as deflection.
    assert near.value == pytest.approx(1.0 / ((40.01 / 40.0) ** 2 - 1.0), rel=1e-10)


def test_rounding_magnified_beyond_the_tolerance_is_refused() -> None:
    table = "natural_frequency = 40.0000001\ntolerance = 1e-13"
    with pytest.raises(EffectError, match="the tolerance is"):
        made("plate_translating", table).effect("vibration")


@pytest.mark.parametrize("frequency", ["1e-6", "1e12"])
def test_extreme_frequencies_have_finite_answers(frequency: str) -> None:
    """So soft that the mass stands still, or so stiff that it follows: with and without damping."""
    for damping in (0.0, 0.5):
        found = result("plate_translating", f"natural_frequency = {frequency}\ndamping = {damping}")
        for each in found.findings:
            # A harmonic may be the natural frequency itself, and be no part of the motion.
            assert each.name == "resonance" or each.value is not None
            assert each.value is None or math.isfinite(each.value)
        e = found.output.deflection(PHI, "right")
        if float(frequency) < 1.0:
            assert np.ptp(found.output.clock.motion.jet(PHI)[0] + e) <= 1e-4  # of 20 mm
        else:
            assert np.max(np.abs(e)) <= 1e-15


def test_a_peak_behind_a_shock_is_found_however_stiff_the_train() -> None:
    """A straight line out of a rest: e = -v exp(-D w t) sin(w' t) / w', w' = w sqrt(1 - D^2).

    Its first peak is v exp(-D acos(D) / sqrt(1 - D^2)) / w, a quarter of a period behind the shock.
    """
    changes = ('law = "modified-sine"', 'law = "straight-line"')
    frequency, damping = 1e5, 0.5
    table = f"natural_frequency = {frequency}\ndamping = {damping}"
    error = finding(result("plate_translating", table, changes).findings, "largest-motion-error")
    root = math.sqrt(1.0 - damping**2)
    velocity = 20.0 / (100.0 / 360.0)
    peak = velocity * math.exp(-damping * math.acos(damping) / root) / (TURN * frequency)
    assert error.value == pytest.approx(peak, rel=1e-9)


def test_a_second_mass_has_two_natural_frequencies_and_the_output() -> None:
    second = "second = { natural_frequency = 90, mass_ratio = 0.2, damping = 0.02 }"
    table = f"natural_frequency = 60\ndamping = 0.03\n{second}"
    found = result("plate_translating", table)
    # Undamped: x^2 - x (60^2 + 1.2 90^2) + (60 90)^2 = 0 for the squares; damping changes D^2.
    middle = 60.0**2 + 1.2 * 90.0**2
    root = math.sqrt(middle**2 - 4.0 * (60.0 * 90.0) ** 2)
    exact = [math.sqrt(0.5 * (middle - root)), math.sqrt(0.5 * (middle + root))]
    assert frequencies(found) == pytest.approx(exact, rel=2e-3)


# -- masses one by one ---------------------------------------------------------------------------


def test_masses_one_by_one_are_the_train_of_frequencies() -> None:
    """60 Hz and 0.03, and on it 90 Hz and 0.02 with a fifth of the mass: 0.5 kg and 0.1 kg."""
    old = "natural_frequency = 60\ndamping = 0.03\n"
    old += "second = { natural_frequency = 90, mass_ratio = 0.2, damping = 0.02 }"
    rows = [
        f"{{ mass = {mass}, stiffness = {1e-3 * mass * (TURN * hertz) ** 2}, damping = {damping} }}"
        for mass, hertz, damping in ((0.5, 60.0, 0.03), (0.1, 90.0, 0.02))
    ]
    one, other = (
        result("plate_translating", table) for table in (old, f"masses = [{', '.join(rows)}]")
    )
    for first, second in zip(one.columns, other.columns, strict=False):
        values = first.values(PHI, "right")
        size = float(np.max(np.abs(values)))
        assert np.max(np.abs(values - second.values(PHI, "right"))) <= 1e-12 * size
    assert (one.links, other.links) == (0, 2)
    assert len(other.columns) == len(one.columns) + 2


def test_the_forces_in_the_springs_move_what_is_behind_them() -> None:
    """With dampers as N s/mm and as ratios, a closing spring, and the output in the middle."""
    rows = (
        "{ mass = 0.5, stiffness = 400, viscous = 0.2 }",
        "{ mass = 0.2, stiffness = 900, damping = 0.1 }",
        "{ mass = 0.1, stiffness = 700, ground_stiffness = 5, ground_viscous = 0.01 }",
    )
    found = result("plate_translating", f"output = 2\nmasses = [{', '.join(rows)}]")
    response = found.output.response
    assert response is not None
    clock = found.output.clock
    t = clock.time(PHI)
    y = clock.jet(t, "right")
    x = np.array([response.states_of(mass, t, "right") for mass in range(3)])
    x[:, :2] += y[:2]
    off = x[1, 0] - y[0] - found.output.deflection(PHI, "right")
    assert np.max(np.abs(off)) <= 1e-14 * float(np.max(y[0]))
    forces = [column.values(PHI, "right") for column in found.columns[2:]]
    first = 400.0 * (y[0] - x[0, 0]) + 0.2 * (y[1] - x[0, 1])
    second = 2.0 * 0.1 * math.sqrt(900.0 * 0.2e-3) * (x[0, 1] - x[1, 1])
    second += 900.0 * (x[0, 0] - x[1, 0])
    last = 0.1e-3 * x[2, 2] + 5.0 * x[2, 0] + 0.01 * x[2, 1]
    whole = 0.5e-3 * x[0, 2] + 0.2e-3 * x[1, 2] + last
    for got, wanted in ((0, first), (0, whole), (1, second), (2, last)):
        size = float(np.max(np.abs(wanted)))
        assert np.max(np.abs(forces[got] - wanted)) <= 1e-10 * size
    largest = [each for each in found.findings if each.name == "largest-train-force"]
    assert [each.value for each in largest] == pytest.approx(
        [float(np.max(np.abs(each))) for each in forces], rel=2e-3
    )
    assert [each.unit for each in largest] == ["N"] * 3


def test_forty_masses_are_a_train_like_any_other() -> None:
    """Equal masses on equal springs: 2 w sin(pi / 162) is the lowest frequency."""
    row = "{ mass = 0.01, stiffness = 20, damping = 0.02 }"
    found = result("plate_translating", f"masses = [{', '.join([row] * 40)}]")
    lowest = 2.0 * math.sqrt(20.0 / 1e-5) * math.sin(math.pi / 162.0) / TURN
    assert frequencies(found)[0] == pytest.approx(lowest, rel=1e-12)
    assert len(frequencies(found)) == 40
    assert found.error is not None
    assert found.error <= 1e-6


def test_a_mode_beyond_critical_damping_has_a_time_constant() -> None:
    """m s^2 + c s + k = 0 with 1 kg, 2 N s/mm and 0.36 N/mm: -0.2 1/s and -1.8 1/s, by 1000."""
    found = result("plate_translating", "masses = [{ mass = 1, stiffness = 360, viscous = 2 }]")
    values = [each.value for each in found.findings if each.name == "time-constant"]
    assert values == pytest.approx([1.0 / 200.0, 1.0 / 1800.0], rel=1e-12)
    assert not frequencies(found)


def test_moments_are_for_a_rocker() -> None:
    row = "{ moment = 0.05, torsional_stiffness = 2000, damping = 0.05 }"
    found = result("groove", f"moments = [{row}]")
    assert frequencies(found) == pytest.approx([200.0 / TURN], rel=1e-14)
    force = finding(found.findings, "largest-train-force")
    assert force.unit == "N m"
    top = finding(found.findings, "largest-output-acceleration").value
    assert force.value == pytest.approx(0.05 * math.radians(top), rel=1e-12)
