"""Undercut is found even where the known extremes of the curvature do not show it."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given

from camgeo.curve.extremes import Extremes, curvature_extremes
from camgeo.curve.pitch_curve import PitchCurve
from camgeo.curve.working_curve import WorkingCurve
from camgeo.errors import GeometryError
from camgeo.numeric.arrays import frozen
from camgeo.outline.cusps import sure_bends, undercut_ranges
from tests.reference import hard_case, inner_of, pitch_curve_of
from tests.strategies import attack, signs, wild_pitch_curves


def ends_only(bends: Extremes, curve: PitchCurve) -> Extremes:
    """The extremes, reduced to those at breaks."""
    kept = np.isin(np.mod(bends.phi, 2.0 * math.pi), np.mod(curve.breaks, 2.0 * math.pi))
    kept[[0, -1]] = True
    return Extremes(frozen(bends.phi[kept], np.float64), frozen(bends.values[kept], np.float64))


@pytest.mark.parametrize("case", ["HC21b", "HC21c"])
def test_a_missed_extreme_is_found(case: str) -> None:
    """Of HC21b's loop of 0.029 degrees not one sample of 257 a piece need be inside."""
    params, expected = hard_case(case)
    flank = inner_of(pitch_curve_of({"kappa": 1, **params}))
    blind = ends_only(curvature_extremes(flank.pitch), flank.pitch)
    assert undercut_ranges(flank, blind) == [], "the extremes left do not show the loop"
    ((start, end),) = undercut_ranges(flank, sure_bends(flank, blind))
    assert math.degrees(start) == pytest.approx(float(expected["cusp1_phi_deg"]), abs=1e-9)
    assert math.degrees(end) == pytest.approx(float(expected["cusp2_phi_deg"]), abs=1e-9)


@attack
@given(wild_pitch_curves(), signs())
def test_blind_to_all_extremes_it_finds_the_same_ranges(pitch: PitchCurve, side: int) -> None:
    flank = WorkingCurve(pitch, side * pitch.follower.roller_radius)
    try:
        bends = curvature_extremes(pitch)
        seen = undercut_ranges(flank, bends)
        found = undercut_ranges(flank, sure_bends(flank, ends_only(bends, pitch)))
    except GeometryError:  # Z' = 0
        return
    margins = 1.0 + flank.distance * bends.values
    if np.min(np.abs(margins)) < 1e-6:
        return  # a range that only just is one may be found or not
    assert len(found) == len(seen)
    for one, other in zip(sorted(found), sorted(seen), strict=True):
        assert one == pytest.approx(other, abs=1e-9)


def test_where_nothing_is_missing_nothing_is_added() -> None:
    params, _ = hard_case("HC21c")
    flank = inner_of(pitch_curve_of({"kappa": 1, **params}))
    bends = curvature_extremes(flank.pitch)
    assert sure_bends(flank, bends) is bends
