"""What deviations do to the follower, compared with the first-order formula dq = e / (dn/dq)."""

from __future__ import annotations

import numpy as np
import pytest

from camgeo.geometry.outline.exact_flank import ExactFlank
from camgeo.geometry.outline.path import Flank
from camgeo.geometry.outline.replay import replay_contour, replay_outline
from camgeo.numeric.arrays import FloatArray
from camgeo.studies.inspection import Deviations, Gap, LiftErrors, measured_contour
from camgeo.units import TURN
from tests.inspection.flanks import BUMP, KINDS, TRIMMED, bump, disc_of, every, flank_of


def pressed(name: str, side: Flank, count: int, *, height: float) -> LiftErrors:
    flank = flank_of(name, side)
    places = every(flank, count)
    values = bump(places.phi) * height / BUMP
    clearance = disc_of(name).cam.clearance
    return LiftErrors.from_deviations(
        flank, Deviations(places, values, Gap(0.0, 0.0)), clearance=clearance
    )


def in_mm(flank: ExactFlank, found: LiftErrors) -> FloatArray:
    """Errors of the lift as displacements of the roller or the face along its normal [mm]."""
    return found.errors * flank.curve.pitch.leverage(found.phi) * -flank.side.sign


@pytest.mark.parametrize(("name", "side"), [*KINDS, ("groove_clearance", Flank.OUTER)])
def test_a_disc_without_deviations_makes_the_demanded_motion(name: str, side: Flank) -> None:
    assert np.max(np.abs(in_mm(flank_of(name, side), pressed(name, side, 36, height=0.0)))) < 2e-6


@pytest.mark.parametrize(("name", "side"), TRIMMED)
def test_a_trimmed_disc_makes_the_motion_of_the_exact_one(name: str, side: Flank) -> None:
    found = pressed(name, side, 72, height=0.0)
    flank = flank_of(name, side)
    rest = ~np.isnan(flank.positions(found.phi))
    assert np.max(np.abs(in_mm(flank, found)[rest])) < 2e-5
    assert np.max(np.abs(found.errors)) < 1e-6


@pytest.mark.parametrize(("name", "side"), KINDS)
def test_five_micrometres_lift_the_follower_by_as_much_as_they_must(name: str, side: Flank) -> None:
    """The roller that rides on a slope of 5 um over 10 degrees misses it to the second order."""
    flank = flank_of(name, side)
    found = pressed(name, side, 720, height=BUMP)
    away = in_mm(flank, found)
    assert np.max(np.abs(away - bump(found.phi))) < 1e-4
    assert np.max(away) == pytest.approx(BUMP, abs=5e-6)
    peak = found.phi[int(np.argmax(away))]
    assert peak == pytest.approx(np.radians(60.0), abs=np.radians(0.5))


def test_a_roller_rides_on_peaks() -> None:
    """A dent that is narrower than the roller's contact is bridged, a peak of its size is not."""
    flank = flank_of("plate_translating", Flank.INNER)
    places = every(flank, 3600)
    reach = []
    for height in (0.01, -0.01):
        values = np.where(np.arange(3600) == 600, height, 0.0)
        found = LiftErrors.from_deviations(flank, Deviations(places, values, Gap(0.0, 0.0)))
        reach.append(found.extremes.magnitude)
    assert reach[0] > 0.0099
    assert reach[1] < 0.001


@pytest.mark.parametrize(("name", "side"), [("plate_translating", Flank.INNER), TRIMMED[0]])
def test_no_error_of_the_lift_is_beyond_its_extremes(name: str, side: Flank) -> None:
    flank, rng = flank_of(name, side), np.random.default_rng(39)
    places = flank.places(np.sort(rng.uniform(0.0, flank.total, 500)))
    found = Deviations(places, rng.uniform(-2e-3, 2e-3, 500), Gap(0.0, 0.0))
    pitch, clearance = flank.curve.pitch, disc_of(name).cam.clearance
    actual = replay_contour(pitch, measured_contour(flank, found), side).lift
    exact = replay_outline(pitch, flank.path, clearance=clearance).lift
    extremes = LiftErrors.from_deviations(flank, found, clearance=clearance).extremes
    dense = np.linspace(0.0, TURN, 180_001)[:-1]
    errors = actual.displacement(dense) - exact.displacement(dense)
    for end, sign in ((extremes.lowest, -1.0), (extremes.highest, 1.0)):
        assert np.max(sign * errors) <= sign * end.value + 1e-9 * extremes.magnitude
        at = np.array([end.place])
        assert float((actual.displacement(at) - exact.displacement(at))[0]) == pytest.approx(
            end.value, rel=1e-9
        )


@pytest.mark.parametrize(("name", "side"), [*KINDS, *TRIMMED])
def test_the_contour_is_the_outline_moved_by_the_deviation(name: str, side: Flank) -> None:
    """Its area is that of the parallel: to the first order larger by deviation times length."""
    flank = flank_of(name, side)
    places = every(flank, 60)
    areas = []
    for away in (0.0, 1e-3):
        found = Deviations(places, np.full(60, away), Gap(0.0, 0.0))
        areas.append(measured_contour(flank, found).area)
    contour = measured_contour(flank, Deviations(places, np.zeros(60), Gap(0.0, 0.0)))
    expected = 1e-3 * contour.length * -side.sign
    assert areas[1] - areas[0] == pytest.approx(expected, rel=1e-3)
