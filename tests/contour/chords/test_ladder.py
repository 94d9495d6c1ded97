"""Numbers of straight pieces: one ladder for all tolerances, so layouts do not depend on them."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from camgeo.errors import ToleranceError
from camgeo.geometry.contour import fewest_chords as ladder_module
from camgeo.geometry.contour.fewest_chords import (
    Evened,
    Ladder,
    Stretched,
    StretchTable,
    evened,
    stretch_table,
)
from camgeo.geometry.working_curve import WorkingCurve
from camgeo.numeric.arrays import ComplexArray, FloatArray
from tests.contour.cams import TURN, curves, flank
from tests.long_form import examples

some = settings(
    max_examples=examples(7, long=12),
    deadline=None,
    suppress_health_check=[HealthCheck.too_slow, HealthCheck.filter_too_much],
)

SHARE = 1.01

MANY = 100_000


def stretched(curve: WorkingCurve) -> Stretched:
    """A whole curve without corners."""

    def place(phi: FloatArray) -> tuple[ComplexArray, ComplexArray]:
        return curve.point(phi), curve.tangent(phi)

    return Stretched(
        stretch_table(curve, 0.0, TURN), place, curve.point, curve.pitch.rotation, closed=True
    )


def straight(length: float) -> Stretched:
    """A straight line from 10 mm on, aslant; t is the share of its `length` [mm]."""
    along = (2.0 + 1.0j) / abs(2.0 + 1.0j)
    grid, none = np.linspace(0.0, 1.0, 101), np.zeros(100)
    table = StretchTable(grid, none, none, np.full(100, 0.01 * length), (), np.zeros(1))

    def points(t: FloatArray) -> ComplexArray:
        return np.asarray(10.0 + length * along * t, dtype=np.complex128)

    def place(t: FloatArray) -> tuple[ComplexArray, ComplexArray]:
        return points(t), np.full(len(t), along)

    return Stretched(table, place, points, 1, closed=False)


@pytest.mark.parametrize("most", [0.1, 1e-2])
def test_a_layout_does_not_depend_on_the_tolerance(most: float) -> None:
    """A flank without inflections: as many pieces are the same pieces, whatever was asked."""
    ladder = Ladder.of(stretched(flank("vorschub", -1)))
    laid: dict[int, ComplexArray] = {}
    for tolerance in np.geomspace(most, 0.9 * most, 12):
        chords, found = ladder.fewest(float(tolerance), SHARE, MANY)
        assert found <= tolerance
        same = laid.setdefault(len(chords.worst), chords.vertices)
        assert np.array_equal(same, chords.vertices)
    assert 1 < len(laid) < 12


def test_layouts_that_do_not_help_are_few(monkeypatch: pytest.MonkeyPatch) -> None:
    laid: list[int] = []

    def off(*arguments: Any) -> Evened:
        found = evened(*arguments)
        laid.append(len(found.chords.worst))
        return replace(found, chords=replace(found.chords, worst=10.0 * found.chords.worst))

    monkeypatch.setattr(ladder_module, "evened", off)
    monkeypatch.setattr(ladder_module, "LAID", 1_000)
    with pytest.raises(ToleranceError):
        Ladder.of(stretched(flank("vorschub", -1))).fewest(1e-3, SHARE, MANY)
    assert 1 < len(laid) < ladder_module.LAYOUTS
    assert sum(laid[:-1]) <= 1_000


@some
@given(curves(), st.floats(1e-5, 1.0), st.floats(1.0, 10.0))
def test_found_deviations_hold_and_counts_do_not_grow(
    curve: WorkingCurve, most: float, looser: float
) -> None:
    ladder = Ladder.of(stretched(curve))
    chords, found = ladder.fewest(most, SHARE, MANY)
    assert SHARE * float(np.max(chords.worst)) <= found <= most
    fewer, _ = ladder.fewest(looser * most, SHARE, MANY)
    assert len(fewer.worst) <= len(chords.worst)


@pytest.mark.parametrize("length", [1e-3, 5.0, 1e4])
def test_a_straight_stretch_is_one_piece(length: float) -> None:
    stretch = straight(length)
    chords, found = Ladder.of(stretch).fewest(1e-3, SHARE, MANY)
    assert len(chords.worst) == 1
    assert np.array_equal(chords.vertices, stretch.points(np.array([0.0, 1.0])))
    assert found <= 1e-14 * (10.0 + length)


def test_too_many_are_refused() -> None:
    ladder = Ladder.of(stretched(flank("setzhub", -1)))
    with pytest.raises(ToleranceError, match="more than 100 straight pieces"):
        ladder.fewest(1e-3, SHARE, 100)
