"""Fits of measured points to the exact flank, and how far they are known."""

from __future__ import annotations

import math

import numpy as np
import pytest

import camgeo
from camgeo.errors import GeometryError
from camgeo.geometry.outline.exact_flank import ExactFlank
from camgeo.geometry.outline.path import Flank
from camgeo.studies.inspection import (
    Align,
    Alignment,
    Frame,
    _alignment,
    _fit,
    _jacobian,
    _uncertainties,
)
from tests.inspection.flanks import KINDS, SCENES, every, flank_of, measured

SHIFT, TURN = 3.1 - 2.2j, 2.0


def round_flank() -> ExactFlank:
    """A disc that only dwells: a circle about the cam axis."""
    scene = camgeo.load(SCENES / "plate_translating.toml").scene
    design = camgeo.Design(scene.with_values({"motion": [{"dwell": 360}]}))
    return ExactFlank(design.cam.disc.outline(Flank.INNER).path, Flank.INNER)


@pytest.mark.parametrize(("name", "side"), KINDS)
def test_exact_points_come_back_from_any_frame(name: str, side: Flank) -> None:
    flank = flank_of(name, side)
    places = every(flank, 90)
    found = Alignment.from_points(flank, measured(places, 0.0, SHIFT, TURN), Align.FREE)
    assert abs(found.frame.shift - SHIFT) < 1e-9
    assert abs(found.frame.turn - TURN) < 1e-10
    assert np.max(np.abs(found.deviations)) < 1e-9
    turned = Alignment.from_points(flank, measured(places, 0.0, 0j, -0.7), Align.ROTATION)
    assert turned.frame.shift == 0j
    assert abs(turned.frame.turn + 0.7) < 1e-10
    assert turned.shift_uncertainty is None


@pytest.mark.parametrize(("name", "side"), KINDS)
def test_the_jacobian_is_the_derivative_of_the_distances(name: str, side: Flank) -> None:
    flank = flank_of(name, side)
    points = measured(every(flank, 24), 0.01)
    rows = _jacobian(flank.feet(points), flank.size)
    step = 1e-5
    for column, frames in enumerate(
        [[Frame(sign * step) for sign in (1, -1)],
         [Frame(sign * step * 1j) for sign in (1, -1)],
         [Frame(0j, sign * step / flank.size) for sign in (1, -1)]]
    ):  # fmt: skip
        ahead, behind = (flank.feet(frame.inward(points)).distances for frame in frames)
        slopes = (behind - ahead) / (2.0 * step)
        assert np.max(np.abs(slopes - rows[:, column])) < 1e-7


def test_shift_and_turn_are_known_as_stated() -> None:
    """Of 36 fits to points with 1 um of noise the true values lie within the stated range of 95 %
    in 29 or more each: a binomial variable is below that one time in 5,000.
    """
    flank = flank_of("plate_translating", Flank.INNER)
    places = every(flank, 40)
    rng = np.random.default_rng(3)
    inside = np.zeros(3, dtype=int)
    shift, turn = 0.004 + 0.003j, 1e-4
    for _ in range(36):
        points = measured(places, rng.normal(0.0, 1e-3, 40), shift, turn)
        frame = _fit(flank, points, Align.FREE, Frame(shift, turn), 0.0, 1e-9)
        found = _alignment(flank, points, Align.FREE, frame, 0.0)
        known, turn_known, _ = _uncertainties(found, flank.size)
        assert known is not None
        off = frame.shift - shift, frame.turn - turn
        inside += [
            abs(off[0].real) < known[0],
            abs(off[0].imag) < known[1],
            abs(off[1]) < turn_known,
        ]
    assert np.all(inside >= 29)
    assert np.all(inside <= 36)


def test_a_round_cam_does_not_show_its_turn() -> None:
    flank = round_flank()
    rng = np.random.default_rng(4)
    points = measured(every(flank, 72), rng.normal(0.0, 1e-3, 72), 0.01 - 0.02j, 1.0)
    found = Alignment.from_points(flank, points, Align.FREE)
    assert found.turn_uncertainty == math.inf
    assert found.other_turn is None
    assert abs(found.frame.shift - (0.01 - 0.02j)) < 1e-3
    assert Alignment.from_points(flank, points, Align.ROTATION).turn_uncertainty == math.inf


def test_a_cam_that_repeats_itself_tells_its_other_turns() -> None:
    scene = camgeo.load(SCENES / "plate_translating.toml").scene
    lobe = [
        {"law": "polynomial-345", "span": 60, "to": 8},
        {"law": "polynomial-345", "span": 60, "to": 0},
        {"dwell": 60},
    ]
    design = camgeo.Design(scene.with_values({"motion": lobe * 2}))
    flank = ExactFlank(design.cam.disc.outline(Flank.INNER).path, Flank.INNER)
    found = Alignment.from_points(flank, measured(every(flank, 120), 0.0, 0j, 0.2), Align.ROTATION)
    assert found.frame.turn == pytest.approx(0.2, abs=1e-9)
    assert found.other_turn == pytest.approx(0.2 - math.pi, abs=1e-9)


def test_points_that_cannot_be_fitted_are_refused() -> None:
    flank = flank_of("plate_translating", Flank.INNER)
    with pytest.raises(GeometryError, match="needs 11 points or more, and there are 10"):
        Alignment.from_points(flank, every(flank, 10).points, Align.FREE)
    alike = np.full(20, every(flank, 4).points[1])
    with pytest.raises(GeometryError):
        Alignment.from_points(flank, alike, Align.FREE)


def test_the_centres_of_a_ball_fit_its_radius_off_the_flank() -> None:
    flank = flank_of("ring", Flank.OUTER)
    places = every(flank, 60)
    found = Alignment.from_points(flank, measured(places, 1.5, SHIFT, 0.3), Align.FREE, 1.5)
    assert abs(found.frame.shift - SHIFT) < 1e-9
    assert np.max(np.abs(found.deviations)) < 1e-9


def test_no_error_of_form_sways_the_fit_farther() -> None:
    flank = flank_of("plate_translating", Flank.INNER)
    places = every(flank, 90)
    rng = np.random.default_rng(5)
    for waves in range(1, 6):
        form = 1e-3 * np.cos(waves * places.phi + rng.uniform(0.0, 6.0))
        found = Alignment.from_points(flank, measured(places, form), Align.FREE)
        size = float(np.sqrt(np.mean(form**2)))
        shift, turn = (size * each for each in found.sway)
        assert abs(found.frame.shift) < 1.001 * shift
        assert abs(found.frame.turn) < 1.001 * turn


def test_frames_are_moved_as_parts_are() -> None:
    frame = Frame(1.0 + 2.0j, 0.5).moved(0.25j, 0.125)
    point = np.array([3.0 - 1.0j])
    outer = Frame(1.0 + 2.0j, 0.5).inward(point)
    assert frame.inward(point) == pytest.approx((outer - 0.25j) * np.exp(-0.125j), abs=1e-14)
    assert Frame(0j, 3.0).moved(0j, 1.0).turn == pytest.approx(4.0 - 2.0 * math.pi)
