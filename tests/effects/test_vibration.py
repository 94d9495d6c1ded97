"""Vibration of the follower train: the exact response, its findings, and the hard cases; and the
shock spectrum: what remains after each move, over its duration in natural periods.
"""

from __future__ import annotations

import math

import numpy as np
import pytest

from camgeo.design.design import Design
from camgeo.dynamics.effects import shock_spectrum as module
from camgeo.dynamics.effects.shock_spectrum import ShockSpectrum, measured
from camgeo.dynamics.effects.vibration import Vibration
from camgeo.dynamics.oscillator import steady
from camgeo.dynamics.oscillator.steady import (
    NODES,
    QUIET,
    PiecewiseSeries,
    Shock,
    most_cells,
    solve,
)
from camgeo.errors import EffectError
from camgeo.kinematics.laws import make_law
from camgeo.kinematics.time_course import in_time
from camgeo.numeric.arrays import FloatArray, Side
from camgeo.numeric.extremes import Extreme
from camgeo.units import TURN
from tests.effects.scenes import course_of, design
from tests.findings import effect_findings, finding
from tests.integrals import cells, integrals
from tests.laws import LAWS
from tests.numeric.test_oscillator import shock_of, shock_spectrum

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
    """x'' = -w^2 e - 2 D w e' at every angle, with e' from the differences of e; and x'' is the
    second derivative of the output, by the work over each piece: the change of x' is its integral.
    """
    found = result(scene, "natural_frequency = 31\ndamping = 0.04\ntolerance = 1e-12").output
    clock, course, w, step = found.clock, found.clock.course, TURN * 31.0, 1e-4
    inside = PHI[np.min(np.abs(PHI[:, np.newaxis] - clock.edges), axis=1) > 4.0 * step]
    around = [found.deflection(inside + k * step, "right") for k in (-2, -1, 1, 2)]
    slope = (around[0] - 8.0 * around[1] + 8.0 * around[2] - around[3]) / (12.0 * step)
    e, got = found.deflection(inside, "right"), found.acceleration(inside, "right")
    left = got + w * w * e + 2.0 * 0.04 * w * course.rates(inside)[0] * slope
    # The differences err by step^4 / 30 of the fifth derivative, (31 / 0.5 per rad)^5 / 62 by e'.
    assert np.max(np.abs(left)) <= 1e-6 * np.max(np.abs(got))

    def velocity(phi: FloatArray, side: Side) -> FloatArray:
        timed = in_time(clock.motion.jet(phi, side), course, phi)
        return np.asarray(timed[1] + found.states(phi, side)[1])

    low, high = cells(clock.edges[:-1], 30)
    before, after = velocity(low, "right"), velocity(high, "left")
    way = integrals(
        lambda phi: np.asarray(found.acceleration(phi, "right") / course.rates(phi)[0]), low, high
    )
    assert np.max(np.abs(way - (after - before))) <= 1e-9 * np.max(np.abs(before))


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
    found = result("plate_translating", f"natural_frequency = 60\ndamping = 0.03\n{second}")
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


# The shock spectrum -------------------------------------------------------------------------------


RATIOS = np.array([1e-6, 0.1, 0.3, 1.0, 1.7, 3.9, 12.2, 80.1])


def spectrum(scene: str, table: str = "", *changes: tuple[str, str]) -> ShockSpectrum:
    found = design(scene, f"[effects.shock-spectrum]\n{table}\n", *changes).effect("shock-spectrum")
    assert isinstance(found, ShockSpectrum)
    return found


@pytest.mark.parametrize("damping", [0.0, 0.1])
def test_a_move_of_the_scene_has_the_spectrum_of_its_law(damping: float) -> None:
    """Behind each other in the scene, at speed, shifted inflection and all."""
    rise, fall = spectrum("plate_translating", f"damping = {damping}").spectra
    place = (rise.move.start, rise.move.span)
    assert place == pytest.approx((math.radians(30.0), math.radians(100.0)), rel=1e-14)
    assert (rise.move.stroke, fall.move.stroke) == (20.0, 20.0)
    assert rise.residual(RATIOS) == pytest.approx(
        shock_spectrum(make_law("modified-sine"), RATIOS, damping), rel=0.0, abs=1e-13
    )
    skewed = make_law("polynomial-345", inflection=0.4)
    assert fall.residual(RATIOS) == pytest.approx(
        shock_spectrum(skewed, RATIOS, damping), rel=0.0, abs=1e-13
    )


def test_moves_of_one_law_are_measured_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """Whatever their strokes and spans, up or down; hundreds of them took a minute."""
    shocks = []

    def counted(shock: Shock, damping: float, end: float) -> tuple[Extreme, float | None]:
        shocks.append(shock)
        return measured(shock, damping, end)

    monkeypatch.setattr(module, "measured", counted)
    same = (("polynomial-345", "modified-sine"), ("inflection = 0.4", ""))
    found = spectrum("plate_translating", "", *same).spectra
    assert len(found) == 2
    assert len(shocks) == 1
    for each in found:
        worst, quiet = measured(each.move.shock, 0.0, 20.0)
        assert (each.worst.value, each.quiet) == pytest.approx((worst.value, quiet), rel=1e-9)


@pytest.mark.parametrize("span", [1e-2, 1e-4])
def test_a_very_short_move_has_the_spectrum_of_its_law_as_far_as_doubles_resolve_it(
    span: float,
) -> None:
    """The angle is rounded to some 1e-16; its series must not go after that in ever more pieces."""
    short = (("span = 100", f"span = {span:.6f}"), ("dwell = 70", f"dwell = {170.0 - span:.6f}"))
    rise = spectrum("plate_translating", "", *short).spectra[0]
    assert rise.move.shock.pieces.series.shape[1] < 100
    resolved = 1e-15 * math.tau / math.radians(span)
    assert rise.residual(RATIOS) == pytest.approx(
        shock_spectrum(make_law("modified-sine"), RATIOS), rel=0.0, abs=100.0 * resolved
    )


@pytest.mark.parametrize("name", ["quadratic-parabola", "modified-sine", "straight-line"])
def test_the_largest_residual_and_where_it_stays_small_are_those_of_a_fine_grid(name: str) -> None:
    grid = np.linspace(1.0, 40.0, 3901)
    move = shock_of(LAWS[name])
    worst, quiet = measured(move, 0.0, 40.0)
    values = move.residual(grid)
    # A peak between two points of the grid is higher by (2 pi 0.005)^2 / 2 at most.
    assert float(np.max(values)) <= worst.value <= 1.0005 * float(np.max(values))
    assert quiet is not None
    assert 0.0 <= quiet - float(grid[values > QUIET][-1]) <= 0.01
    assert move.residual(np.array([quiet]))[0] == pytest.approx(QUIET, rel=1e-9)


def test_a_short_range_says_what_it_saw() -> None:
    worst, quiet = measured(shock_of(make_law("cycloidal")), 0.0, 0.5)
    assert worst.value == pytest.approx(1.0, abs=1e-11)
    assert quiet is None
    found = spectrum("plate_translating", "highest_ratio = 2")
    assert [each.value for each in found.findings if each.name == "residual-small-from"] == [
        None
    ] * 2
    assert all("up to 2 natural periods" in each.sentence for each in found.findings[1::2])


def test_the_highest_ratio_costs_nothing_where_the_bound_says_enough() -> None:
    few, many = (
        spectrum("plate_translating", f"highest_ratio = {top}").findings for top in (20, 10000)
    )
    assert [each.value for each in few] == [each.value for each in many]


def test_moves_without_a_rest_between_them_are_one() -> None:
    """The feed cam rests once: there and back it is one move of 300 degrees."""
    (only,) = spectrum("feed").spectra
    assert (math.degrees(only.move.start), math.degrees(only.move.span)) == pytest.approx(
        (30.0, 300.0)
    )
    assert only.move.stroke == pytest.approx(35.3, rel=1e-12)
    # It comes back, so that a soft train is left by nothing.
    assert only.residual(np.array([1e-9]))[0] <= 1e-8


def test_a_joint_with_neither_velocity_nor_acceleration_is_a_rest() -> None:
    changes = (("[[motion]]\ndwell = 40\n\n", ""), ("dwell = 70", "dwell = 110"))
    found = spectrum("plate_translating", "", *changes)
    assert [round(math.degrees(each.move.start), 9) for each in found.spectra] == [30.0, 130.0]
    assert found.spectra[0].residual(RATIOS) == pytest.approx(
        shock_spectrum(make_law("modified-sine"), RATIOS), rel=0.0, abs=1e-13
    )


def test_a_move_across_the_start_of_the_turn() -> None:
    """The ring starts at rest; its last move ends where the turn does."""
    found = spectrum("ring")
    assert len(found.spectra) == 3
    total = found.spectra[-1].move
    assert math.degrees(total.start + total.span) == pytest.approx(360.0)
    for each in found.spectra:
        assert np.all(np.isfinite(each.residual(RATIOS)))


def test_a_speed_curve_changes_the_move() -> None:
    """Against the residual by summing up Duhamel's integral with the trapezoidal rule in angle."""
    made = design("points", "[effects.shock-spectrum]\ndamping = 0.02\n")
    found: ShockSpectrum = made.effect("shock-spectrum")
    course = course_of(made)
    for each in found.spectra:
        start, end = each.move.start, each.move.start + each.move.span
        phi = np.linspace(start, end, 200_001)
        t = course.time(phi)
        share = (t - t[0]) / (t[-1] - t[0])
        omega, alpha = course.rates(phi)[:2]
        jet = made.cam.drive.plan.jet(phi)
        # d2y/dshare2 dshare, by the angle
        forced = (jet[2] * omega**2 + jet[1] * alpha) / omega * (t[-1] - t[0]) / each.move.stroke
        for ratio in (0.7, 2.2, 5.3):
            w = 2.0 * math.pi * ratio
            root = math.sqrt(1.0 - 0.02**2)
            rate = w * complex(-0.02, root)
            values = np.exp(rate * (1.0 - share)) * forced
            total = abs(np.trapezoid(values, phi)) / (w * root)
            # The rule errs by the square of the step, 1e-10, times the second derivative.
            assert each.residual(np.array([ratio]))[0] == pytest.approx(total, rel=0.0, abs=1e-7)


@pytest.mark.parametrize("scene", ["shuttle", "measured"])
def test_a_cam_that_never_rests_has_no_spectrum(scene: str) -> None:
    made = design(scene, "[effects.shock-spectrum]\n")
    (finding,) = effect_findings(made)
    assert (finding.name, finding.severity) == ("shock-spectrum", "warning")
    assert "from rest to rest" in finding.sentence
    assert made.effect("shock-spectrum").spectra == ()


@pytest.mark.parametrize(
    ("law", "highest"),
    [("straight-line", 10), ("quadratic-parabola", 4), ("modified-sine", 4), ("modified-sine", 10)],
)
def test_what_stays_small_is_small_for_good(law: str, highest: int) -> None:
    """The highest ratio may be a zero of the spectrum, with more than 1 % behind it."""
    move = shock_of(LAWS[law])
    _, quiet = measured(move, 0.0, float(highest))
    beyond = np.linspace(highest if quiet is None else quiet, 60.0, 6001)
    assert (float(np.max(move.residual(beyond, 0.0))) > QUIET * (1.0 + 1e-9)) == (quiet is None)


@pytest.mark.parametrize("pieces", [1, 3, 40, 700])
@pytest.mark.parametrize("rate", [0.1, 30.0, 2000.0, 1e5])
def test_no_more_cells_are_made_than_blocks_are_counted_in(pieces: int, rate: float) -> None:
    steps = np.random.default_rng(pieces).uniform(0.01, 1.0, pieces)
    edges = np.concatenate(([0.0], np.cumsum(steps) / np.sum(steps)))
    made = PiecewiseSeries(edges, np.ones((len(NODES), pieces)), 0.0, 1.0)
    rates = np.full(pieces, complex(-0.3, 1.0) * rate)
    cells = len(solve(made, np.arange(pieces), rates).problem)
    assert cells <= most_cells(pieces, rates[:1])[0]


def test_blocks_change_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    move = shock_of(LAWS["straight-line"])
    ratios = np.linspace(1e-3, 300.0, 500)
    found = move.residual(ratios)
    monkeypatch.setattr(steady, "BLOCK", 100)
    assert move.residual(ratios).tolist() == found.tolist()
