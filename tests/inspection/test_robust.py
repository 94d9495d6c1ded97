"""Fits that pass over local errors of form, with the uncertainty that belongs to them."""

from __future__ import annotations

import numpy as np
import pytest

from camgeo.geometry.outline.path import Flank
from camgeo.studies.inspection import (
    PATIENT,
    ROBUST,
    Align,
    Alignment,
    Deviations,
    Frame,
    _alignment,
    _fit,
    _uncertainties,
    standard_error,
    weights,
)
from tests.inspection.flanks import AT, BUMP, KINDS, bump, every, flank_of, measured

SHIFT, TURN = 12.0 - 5.0j, 1.2


@pytest.mark.parametrize(("name", "side"), KINDS)
def test_five_micrometres_come_back_from_any_frame(name: str, side: Flank) -> None:
    """Least squares give part of them to shift and turn."""
    flank = flank_of(name, side)
    places = every(flank, 240)
    points = measured(places, bump(places.phi), SHIFT, TURN)
    found = Alignment.from_points(flank, points, Align.FREE, robust=True)
    high = Deviations.from_feet(flank, found.feet, found.deviations).extremes.highest
    assert high.value == pytest.approx(BUMP, abs=1e-4)
    assert abs(high.place - AT) < np.radians(1.5)
    assert abs(found.frame.shift - SHIFT) < 1e-5
    assert np.max(Alignment.from_points(flank, points, Align.FREE).deviations) < 0.96 * BUMP


def test_shift_and_turn_are_known_as_stated_despite_the_bump() -> None:
    """As for least squares, in 14 or more of 18."""
    flank = flank_of("plate_translating", Flank.INNER)
    places = every(flank, 60)
    rng = np.random.default_rng(11)
    inside = np.zeros(3, dtype=int)
    for _ in range(18):
        points = measured(places, 4.0 * bump(places.phi) + rng.normal(0.0, 1e-3, 60))
        frame = _fit(flank, points, Align.FREE, Frame(), 0.0, ROBUST, PATIENT, robust=True)
        found = _alignment(flank, points, Align.FREE, frame, 0.0)
        known, turn_known, _ = _uncertainties(found, flank.size, robust=True)
        assert known is not None
        inside += [
            abs(frame.shift.real) < known[0],
            abs(frame.shift.imag) < known[1],
            abs(frame.turn) < turn_known,
        ]
    assert np.all(inside >= 14)


def test_weights_fall_with_the_deviation_to_nothing() -> None:
    deviations = np.array([0.0, -1.0, 1.0, 2.0, -1.0, 100.0])
    found = weights(deviations, 0.0)
    scale = 1.0 / 0.6744897501960817
    expected = (1.0 - (1.0 / (4.685 * scale)) ** 2) ** 2
    assert found[0] == 1.0
    assert found[1] == found[2] == found[4] == pytest.approx(expected)
    assert expected > found[3] > found[5] == 0.0
    assert np.all(weights(np.zeros(3), 1e-9) == 1.0)


def test_the_standard_error_is_5_percent_above_that_of_least_squares() -> None:
    """Of normal errors: the asymptotic efficiency of the biweight is 95 %."""
    rng = np.random.default_rng(12)
    deviations = rng.normal(0.0, 2.0, 200_000)
    found = standard_error(deviations, 200_000, 0.0)
    assert found / 2.0 == pytest.approx(1.0 / np.sqrt(0.95), rel=0.01)
