"""Ranges of undercut, for cams whose curvature jumps at breaks as well as for smooth ones."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from hypothesis import assume, given
from hypothesis import strategies as st

from camgeo.check.flank import check_undercut
from camgeo.design.design import Design
from camgeo.geometry.outline.cusps import undercut_ranges
from camgeo.geometry.pieces import curvature_extremes
from camgeo.geometry.pitch_curve import PitchCurve
from camgeo.geometry.working_curve import WorkingCurve
from camgeo.numeric.arrays import FloatArray
from camgeo.scene.scene import load_scene
from camgeo.units import TURN
from tests.strategies import BENT, attack, pitch_curves

SCENES = Path(__file__).parents[2] / "fixtures" / "scenes"

PHI: FloatArray = np.array([(k + 0.31) * TURN / 2000.0 for k in range(2000)])

ROUNDING = 1e-11
"""Rounding of 1 + d kappa, with d kappa up to about a hundred."""


def flank_at(curve: PitchCurve, share: float) -> WorkingCurve:
    """An offset that has a cusp where the curvature is this share of the way through its range."""
    bends = curvature_extremes(curve)
    low, high = bends.smallest()[0], bends.largest()[0]
    kappa = low + share * (high - low)
    assume(high - low > 1e-6)
    assume(abs(kappa) > 1e-4)
    return WorkingCurve(curve, -1.0 / kappa)


@attack
@given(curve=pitch_curves(BENT), share=st.floats(0.001, 0.999))
def test_the_ranges_are_where_the_flank_is_not_regular(curve: PitchCurve, share: float) -> None:
    flank = flank_at(curve, share)
    within = np.zeros(len(PHI), dtype=bool)
    for start, end in undercut_ranges(flank, curvature_extremes(curve)):
        if end > start:
            within |= (start < PHI) & (end > PHI)
        else:
            within |= (start < PHI) | (end > PHI)
    margin = flank.regularity(PHI)
    clear = np.abs(margin) > 1e-9  # of the edge, where rounding decides
    assert np.array_equal(within[clear], margin[clear] < 0.0)


@attack
@given(curve=pitch_curves(BENT), share=st.floats(0.001, 0.999))
def test_each_range_states_its_worst_margin(curve: PitchCurve, share: float) -> None:
    flank = flank_at(curve, share)
    found = check_undercut(flank, "inner", curvature_extremes(curve))
    assert {finding.severity for finding in found} == {"no-disc"}
    for finding in found:
        assert finding.value is not None
        assert finding.value < 0.0
        assert finding.cam_angle is not None
        place = np.array([finding.cam_angle])
        margins = [flank.regularity(place)[0], flank.regularity(place, "left")[0]]
        # The margin is right to the rounding of 1, the place to that of 2 pi.
        assert min(abs(margin - finding.value) for margin in margins) <= ROUNDING
    worst = min(finding.value for finding in found if finding.value is not None)
    assert np.min(flank.regularity(PHI)) >= worst - ROUNDING


@attack
@given(curve=pitch_curves(BENT), share=st.floats(0.001, 0.999))
def test_a_roller_a_millionth_smaller_than_the_limit_fits(curve: PitchCurve, share: float) -> None:
    """Below the tightest r_K of its sign nothing is found; above it there is no disc."""
    bends = curvature_extremes(curve)
    for kappa in (bends.largest()[0], bends.smallest()[0]):
        assume(abs(kappa) > 1e-4)
        if (kappa > 0.0) != (kappa == bends.largest()[0]):
            continue  # convex, or concave, everywhere: no roller is too large there
        limit = -1.0 / kappa
        (fits,) = check_undercut(WorkingCurve(curve, limit * (1.0 - 1e-6)), "inner", bends)
        assert fits.severity == "ok"
        above = check_undercut(WorkingCurve(curve, limit * (1.0 + 1e-6)), "inner", bends)
        assert {finding.severity for finding in above} == {"no-disc"}


def test_a_roller_as_large_as_the_base_circle_is_reported() -> None:
    """A rest between shocks is a cusp throughout; one joint lies a rounding before the first."""
    scene = load_scene(SCENES / "straight_moves.toml")
    found = Design(scene.with_values({"follower.roller_radius": 45})).findings
    assert found[0].name == "roller-over-axis"
