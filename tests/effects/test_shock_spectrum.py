"""Shock spectrum: what remains after each move, over its duration in natural periods."""

from __future__ import annotations

import math

import numpy as np
import pytest

from camgeo.dynamics.effects import shock_spectrum as module
from camgeo.dynamics.effects.shock_spectrum import ShockSpectrum, measured
from camgeo.dynamics.oscillator import steady
from camgeo.dynamics.oscillator.steady import NODES, QUIET, Pieces, Shock, most_cells, solve
from camgeo.kinematics.laws import make_law
from camgeo.numeric.extremes import Extreme
from tests.effects.scenes import course_of, design
from tests.findings import effect_findings
from tests.laws import LAWS
from tests.numeric.shocks import shock_of, shock_spectrum

RATIOS = np.array([1e-6, 0.1, 0.3, 1.0, 1.7, 3.9, 12.2, 80.1])


def result(scene: str, table: str = "", *changes: tuple[str, str]) -> ShockSpectrum:
    found = design(scene, f"[effects.shock-spectrum]\n{table}\n", *changes).effect("shock-spectrum")
    assert isinstance(found, ShockSpectrum)
    return found


@pytest.mark.parametrize("damping", [0.0, 0.1])
def test_a_move_of_the_scene_has_the_spectrum_of_its_law(damping: float) -> None:
    """Behind each other in the scene, at speed, shifted inflection and all."""
    found = result("plate_translating", f"damping = {damping}")
    rise, fall = found.spectra
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
    found = result("plate_translating", "", *same).spectra
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
    rise = result("plate_translating", "", *short).spectra[0]
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
    found = result("plate_translating", "highest_ratio = 2")
    assert [each.value for each in found.findings if each.name == "residual-small-from"] == [
        None
    ] * 2
    assert all("up to 2 natural periods" in each.sentence for each in found.findings[1::2])


def test_the_highest_ratio_costs_nothing_where_the_bound_says_enough() -> None:
    few, many = (
        result("plate_translating", f"highest_ratio = {top}").findings for top in (20, 10000)
    )
    assert [each.value for each in few] == [each.value for each in many]


def test_moves_without_a_rest_between_them_are_one() -> None:
    """The feed cam rests once: there and back it is one move of 300 degrees."""
    (only,) = result("feed").spectra
    assert (math.degrees(only.move.start), math.degrees(only.move.span)) == pytest.approx(
        (30.0, 300.0)
    )
    assert only.move.stroke == pytest.approx(35.3, rel=1e-12)
    # It comes back, so that a soft train is left by nothing.
    assert only.residual(np.array([1e-9]))[0] <= 1e-8


def test_a_joint_with_neither_velocity_nor_acceleration_is_a_rest() -> None:
    changes = (("[[motion]]\ndwell = 40\n\n", ""), ("dwell = 70", "dwell = 110"))
    found = result("plate_translating", "", *changes)
    assert [round(math.degrees(each.move.start), 9) for each in found.spectra] == [30.0, 130.0]
    assert found.spectra[0].residual(RATIOS) == pytest.approx(
        shock_spectrum(make_law("modified-sine"), RATIOS), rel=0.0, abs=1e-13
    )


def test_a_move_across_the_start_of_the_turn() -> None:
    """The ring starts at rest; its last move ends where the turn does."""
    found = result("ring")
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
    largest = float(np.max(move.residual(beyond, 0.0)))
    assert (largest > QUIET * (1.0 + 1e-9)) == (quiet is None)


@pytest.mark.parametrize("pieces", [1, 3, 40, 700])
@pytest.mark.parametrize("rate", [0.1, 30.0, 2000.0, 1e5])
def test_no_more_cells_are_made_than_blocks_are_counted_in(pieces: int, rate: float) -> None:
    steps = np.random.default_rng(pieces).uniform(0.01, 1.0, pieces)
    edges = np.concatenate(([0.0], np.cumsum(steps) / np.sum(steps)))
    made = Pieces(edges, np.ones((len(NODES), pieces)), 0.0, 1.0)
    rates = np.full(pieces, complex(-0.3, 1.0) * rate)
    cells = len(solve(made, np.arange(pieces), rates).problem)
    assert cells <= most_cells(pieces, rates[:1])[0]


def test_blocks_change_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    move = shock_of(LAWS["straight-line"])
    ratios = np.linspace(1e-3, 300.0, 500)
    found = move.residual(ratios)
    monkeypatch.setattr(steady, "BLOCK", 100)
    assert move.residual(ratios).tolist() == found.tolist()
