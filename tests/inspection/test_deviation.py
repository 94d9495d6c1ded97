"""Deviations over the cam angle: errors of form come back, with their scatter."""

from __future__ import annotations

import numpy as np
import pytest

from camgeo.errors import GeometryError
from camgeo.geometry.outline.exact_flank import ExactFlank
from camgeo.geometry.outline.path import Flank
from camgeo.numeric.arrays import ComplexArray
from camgeo.studies.inspection import Align, Alignment, Deviations
from tests.inspection.flanks import AT, BUMP, KINDS, bump, every, flank_of, measured


def by_datum(flank: ExactFlank, points: ComplexArray, align: Align = Align.DATUM) -> Deviations:
    found = Alignment.from_points(flank, points, align)
    return Deviations.from_feet(flank, found.feet, found.deviations)


@pytest.mark.parametrize(("name", "side"), KINDS)
def test_five_micrometres_over_20_degrees_come_back(name: str, side: Flank) -> None:
    flank = flank_of(name, side)
    places = every(flank, 360)
    high = by_datum(flank, measured(places, bump(places.phi))).extremes.highest
    assert high.value == pytest.approx(BUMP, abs=1e-4)
    assert abs(high.place - AT) < np.radians(1.0)
    low = by_datum(flank, measured(places, -bump(places.phi))).extremes.lowest
    assert low.value == pytest.approx(-BUMP, abs=1e-4)


@pytest.mark.parametrize(("name", "side"), KINDS)
def test_eccentricity_shows_by_datum_and_as_a_shift_by_a_fit(name: str, side: Flank) -> None:
    """5 um across a flank whose normals point in all directions: 5 um where one is parallel."""
    flank = flank_of(name, side)
    places = every(flank, 240)
    rng = np.random.default_rng(6)
    shift = BUMP * np.exp(1j)
    found = by_datum(flank, measured(places, 0.0, shift)).extremes
    assert found.highest.value == pytest.approx(BUMP, abs=1e-5)
    assert found.lowest.value == pytest.approx(-BUMP, abs=1e-5)
    for noise in (0.0, 1e-3):
        points = measured(places, rng.normal(0.0, noise, 240), shift)
        free = Alignment.from_points(flank, points, Align.FREE)
        assert free.shift_uncertainty is not None
        off = free.frame.shift - shift
        # Twice the stated 95 % is exceeded one time in 10,000.
        assert abs(off.real) <= 2.0 * free.shift_uncertainty[0] + 1e-9
        assert abs(off.imag) <= 2.0 * free.shift_uncertainty[1] + 1e-9
        assert free.shift_uncertainty[0] < 4e-4
    assert np.max(np.abs(free.deviations)) < 5e-3


def test_scatter_is_that_of_the_readings_whatever_the_form() -> None:
    flank = flank_of("plate_translating", Flank.INNER)
    places = every(flank, 1440)
    rng = np.random.default_rng(7)
    noise = rng.normal(0.0, 1e-3, 1440)
    form = 0.05 * np.cos(3.0 * places.phi) + bump(places.phi)
    found = by_datum(flank, measured(places, noise + form))
    # Three standard deviations of the scatter of 1,440 readings are 8 %: its square is the mean of
    # squares of second differences, whose correlations of -2/3 and 1/6 nearly double the variance.
    assert found.scatter == pytest.approx(1e-3, rel=0.08)
    assert np.max(np.abs(found.values - form)) < found.uncertainty < 5e-3
    assert found.form == pytest.approx(np.sqrt(np.mean(form**2)), rel=0.01)
    assert by_datum(flank, measured(places, noise)).form == 0.0


def test_uneven_points_scatter_as_even_ones_do() -> None:
    flank = flank_of("plate_translating", Flank.INNER)
    rng = np.random.default_rng(8)
    places = flank.places(np.sort(rng.uniform(0.0, flank.total, 1000)))
    found = by_datum(flank, measured(places, rng.normal(0.0, 1e-3, 1000)))
    assert found.scatter == pytest.approx(1e-3, rel=0.1)


def test_places_are_ordered_and_repeated_readings_averaged() -> None:
    flank = flank_of("plate_translating", Flank.INNER)
    places = every(flank, 24)
    points = np.concatenate((measured(places, 0.002), measured(places, 0.004)))
    found = by_datum(flank, np.random.default_rng(9).permutation(points))
    assert len(found.values) == 24
    assert found.values == pytest.approx(np.full(24, 0.003), abs=1e-12)
    assert np.all(np.diff(found.places.course) > 0.0)
    assert found.widest.width == pytest.approx(2.0 * np.pi / 24)


def test_the_widest_gap_may_pass_cam_angle_0() -> None:
    flank = flank_of("plate_translating", Flank.INNER)
    places = flank.places(np.radians(np.arange(20.0, 340.0, 4.0)))
    found = by_datum(flank, measured(places, 0.0))
    assert np.degrees(found.widest.width) == pytest.approx(44.0)
    assert np.degrees(found.widest.place) == pytest.approx(336.0)


def test_too_few_places_are_refused() -> None:
    flank = flank_of("plate_translating", Flank.INNER)
    points = np.tile(measured(every(flank, 11), 0.0), 3)
    with pytest.raises(GeometryError, match=r"12 places of the flank or more.*there are 11"):
        by_datum(flank, points)


def test_the_profile_is_the_width_of_the_zone() -> None:
    flank = flank_of("groove", Flank.OUTER)
    places = every(flank, 36)
    away = np.linspace(-0.03, 0.01, 36)
    found = by_datum(flank, measured(places, away))
    assert found.profile == pytest.approx(0.06, abs=1e-12)
    assert found.root_mean_square == pytest.approx(np.sqrt(np.mean(away**2)), abs=1e-12)
