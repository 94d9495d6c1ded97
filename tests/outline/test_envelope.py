"""Boxes of cells hold the flank, all of it, are not much too large, and are as many as it needs."""

from __future__ import annotations

import math
from decimal import Decimal
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from camgeo.design.design import Design
from camgeo.errors import GeometryError
from camgeo.geometry.outline import envelope as cells_module
from camgeo.geometry.outline.envelope import (
    STEEPEST,
    Envelope,
    FlankCells,
    divide,
    enclose,
    halved,
    overlapping,
)
from camgeo.geometry.pitch_curve import PitchCurve, WorkingCurve
from camgeo.kinematics.mechanism.linkage import LinkedMotion
from camgeo.kinematics.mechanism.linkages import SliderCrank
from camgeo.kinematics.mechanism.rollers import OscillatingRoller
from camgeo.kinematics.plan import Dwell, MotionPlan, Move
from camgeo.scene.scene import load_scene
from tests.reference import POLYNOMIAL, hard_case, pitch_curve_of
from tests.strategies import attack, signs, wild_pitch_curves


def cells_of(envelope: Envelope, parts: int) -> FlankCells:
    marks = np.append(envelope.borders, envelope.total)
    cuts = [np.linspace(a, b, parts + 1) for a, b in pairwise(marks)]
    low = np.concatenate([cut[:-1] for cut in cuts])
    high = np.concatenate([cut[1:] for cut in cuts])
    return enclose(envelope, low, high, np.arange(len(low)))


def envelope_of(pitch: PitchCurve, side: int) -> Envelope:
    return Envelope(WorkingCurve(pitch, side * pitch.follower.roller_radius))


@attack
@given(wild_pitch_curves(), signs(), st.integers(1, 40))
def test_a_box_holds_all_of_its_cell(pitch: PitchCurve, side: int, parts: int) -> None:
    envelope = envelope_of(pitch, side)
    try:
        cells = cells_of(envelope, parts)
    except GeometryError:  # Z' = 0
        return
    shares = np.linspace(0.0, 1.0, 25)[1:-1]
    places = cells.low[:, None] + (cells.high - cells.low)[:, None] * shares
    samples = envelope.samples(places.ravel())
    local = samples.points.reshape(places.shape) - cells.middle[:, None]
    local = local * np.conj(cells.tangent)[:, None]
    assert np.all(np.abs(local.real) <= cells.along[:, None])
    assert np.all(np.abs(local.imag) <= cells.across[:, None])
    tangents = samples.tangents.reshape(places.shape) * np.conj(cells.tangent)[:, None]
    assert np.all(np.abs(np.angle(tangents)) <= cells.turn[:, None] + 1e-15)
    # What is claimed to be certain is: the pace keeps its sign, the tangent turns one way.
    pace = samples.pace.reshape(places.shape)
    sure = cells.sign != 0.0
    assert np.all(np.sign(pace[sure]) == cells.sign[sure, None])
    turned = np.angle(tangents[:, 1:] * np.conj(tangents[:, :-1]))
    sure = cells.bend != 0.0
    assert np.all(turned[sure] * cells.bend[sure, None] >= -1e-13)


@attack
@given(wild_pitch_curves(), signs())
def test_boxes_of_halves_are_a_quarter_as_wide(pitch: PitchCurve, side: int) -> None:
    """They shrink with the square of the cell, which is what makes the search end soon."""
    envelope = envelope_of(pitch, side)
    try:
        coarse = cells_of(envelope, 64)
        fine = halved(envelope, coarse)
    except GeometryError:
        return
    assert np.array_equal(fine.low[0::2], coarse.low)
    assert np.array_equal(fine.high[1::2], coarse.high)
    for half in (fine.across[0::2], fine.across[1::2]):
        known = coarse.turn < 0.05
        # A quarter, but for what the bounds of the derivatives gain, which is only for the better.
        assert np.all(half[known] <= 0.3 * coarse.across[known] + 1e-12)


def test_as_many_cells_are_halved_as_may_be_and_no_more(monkeypatch: pytest.MonkeyPatch) -> None:
    envelope = envelope_of(pitch_curve_of({**hard_case("HC21c")[0], "kappa": 1}), -1)
    cells = cells_of(envelope, 4)
    borders = len(envelope.borders)
    for most, more in ((len(cells), 0), (len(cells) - 3 * borders, 3)):
        monkeypatch.setattr(cells_module, "MOST", most)
        monkeypatch.setattr(cells_module, "MORE", more)
        fine = halved(envelope, cells)
        assert len(fine) == 2 * len(cells)
        assert np.array_equal(fine.low[::2], cells.low)
        assert np.array_equal(fine.high[1::2], cells.high)
        assert np.array_equal(fine.origin, np.repeat(cells.origin, 2))
        monkeypatch.setattr(cells_module, "MOST", most - 1)
        with pytest.raises(GeometryError, match="bends too tightly to be resolved"):
            halved(envelope, cells)


def test_pairs_that_overlap_are_those_of_all_pairs(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of upright boxes, one by one; as many as may be examined, and no more."""
    envelope = envelope_of(pitch_curve_of({**hard_case("HC22")[0], "kappa": 1}), -1)
    cells = cells_of(envelope, 9)
    x, y = np.abs(cells.tangent.real), np.abs(cells.tangent.imag)
    wide, high = x * cells.along + y * cells.across, y * cells.along + x * cells.across
    left, right = cells.middle.real - wide, cells.middle.real + wide
    low, top = cells.middle.imag - high, cells.middle.imag + high
    one, other = np.triu_indices(len(cells), 1)
    beside = (left[one] <= right[other]) & (left[other] <= right[one])
    over = (low[one] <= top[other]) & (low[other] <= top[one])
    both = {*zip(one[beside & over].tolist(), other[beside & over].tolist(), strict=True)}
    monkeypatch.setattr(cells_module, "MOST_PAIRS", int(np.sum(beside)))
    first, second = overlapping(envelope, cells)
    assert np.all(first < second)
    assert {*zip(first.tolist(), second.tolist(), strict=True)} == both
    assert len(first) == len(both)
    monkeypatch.setattr(cells_module, "MOST_PAIRS", int(np.sum(beside)) - 1)
    with pytest.raises(GeometryError, match="lie too close to be separated"):
        overlapping(envelope, cells)


FOUND = Path(__file__).parents[2] / "fixtures" / "found"


NO_CUSPS = np.empty(0)


def flank_near_dead_centre(short: float) -> WorkingCurve:
    """For a cam whose linkage comes within a stroke of `short` [mm] of a dead centre at 120 deg."""
    linkage = SliderCrank(40.0, 60.0, math.radians(30.0), True, 1, 1, 1)
    stroke = max(linkage.dead_strokes) - short
    third = Decimal(120)
    plan = MotionPlan((Move(third, stroke, POLYNOMIAL), Dwell(third), Move(third, 0.0, POLYNOMIAL)))
    follower = OscillatingRoller(-60.0 + 10.0j, 55.0, 40.0, 3.0, direction=None)
    return WorkingCurve(PitchCurve(LinkedMotion(plan, linkage), follower, 1), -3.0)


@pytest.mark.parametrize("short", [1.0, 1e-2, 1e-4, 1e-6, 1e-8])
def test_the_cells_next_to_a_dead_centre_are_as_wide_as_they_are_far_from_it(short: float) -> None:
    """So their number grows with the logarithm of the distance: a few tens per decade."""
    found = divide(Envelope(flank_near_dead_centre(short)), NO_CUSPS).cells
    assert np.all(found.turn <= STEEPEST)
    assert len(found) <= 200 + 50 * abs(math.log10(short))


def test_few_cells_do_next_to_a_change_point() -> None:
    """There coupler, crank and lever are nearly in line, and the terms of a sum nearly cancel:
    bounds of their magnitudes would need 15,000 cells."""
    curve = Design(load_scene(FOUND / "near_dead_centre.toml")).cam.disc.inner_curve
    assert len(divide(Envelope(curve), NO_CUSPS).cells) <= 200


def test_an_unresolved_bend_is_reported_with_its_place(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr("camgeo.geometry.outline.envelope.NARROWEST", 1e-3)
    place = r"at cam angle 1(19|20)\.\d* deg .* too tightly to be resolved"
    with pytest.raises(GeometryError, match=place):
        divide(Envelope(flank_near_dead_centre(1e-8)), NO_CUSPS)


def test_no_flank_is_divided_at_a_dead_centre() -> None:
    with pytest.raises(GeometryError, match="dead centre"):
        divide(Envelope(flank_near_dead_centre(0.0)), NO_CUSPS)
