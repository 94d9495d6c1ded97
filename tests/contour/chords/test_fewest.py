"""Fewest straight pieces: near the limit, within tolerance on both sides, corners exact."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import cache

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from camgeo.errors import ToleranceError, UndercutError
from camgeo.geometry.contour.chords import fit_polyline
from camgeo.geometry.contour.contour import Fit
from camgeo.geometry.contour.fewest_chords import fewest_chords
from camgeo.geometry.contour.legs import StretchLeg, legs_of
from camgeo.geometry.outline.path import Path, whole
from camgeo.geometry.working_curve import WorkingCurve
from tests.contour.cams import FLANKS, Dense, curves, dense_flank, dwell, flank, move
from tests.contour.cams import translating as cam
from tests.contour.paths import PATHS, SAGITTA, measured
from tests.long_form import examples

flanks = pytest.mark.parametrize("name", FLANKS, ids=str)

some = settings(
    max_examples=examples(4, long=12),
    deadline=None,
    suppress_health_check=[HealthCheck.too_slow, HealthCheck.filter_too_much],
)

TOLERANCES = (1e-2, 1e-3, 1e-4, 1e-5, 1e-6)

COARSE = 0.05
"""Below this tolerance [mm] no tip of the paths is so sharp that only the angle of a chord counts;
there the limit, which counts sagittas alone, is none."""

ladder = pytest.mark.parametrize(
    "path",
    [
        *(pytest.param(lambda name=name: whole(flank(*name)), id=str(name)) for name in FLANKS),
        *(pytest.param(PATHS[name], id=name) for name in PATHS if "clockwise" not in name),
    ],
)

NOTHING = 2e-6
"""Chords of the dense curve by which is measured, see `Dense` [mm]."""


def limit(path: Path, tolerance: float) -> float:
    """Integral of sqrt(|kappa|/(16 tolerance)) ds by the midpoint rule, turns included."""
    total = 0.0
    for leg in legs_of(path):
        if not isinstance(leg, StretchLeg):
            total += leg.end * math.sqrt(leg.radius)
            continue
        for piece in leg.pieces:
            grid = np.linspace(piece.start, piece.end, 20_001)
            middle = 0.5 * (grid[1:] + grid[:-1])
            kappa = np.abs(leg.curve.curvature(middle))
            total += float(np.sum(np.sqrt(kappa) * leg.curve.pace(middle) * np.diff(grid)))
    return total / (4.0 * math.sqrt(tolerance))


@cache
def fitted(name: tuple[str, int], tolerance: float) -> Fit:
    """The fit of a fixture flank, made once for all tests that use it."""
    return fewest_chords(whole(flank(*name)), tolerance)


@flanks
def test_counts_are_near_the_limit_and_follow_its_law(name: tuple[str, int]) -> None:
    curve = flank(*name)
    path, breaks = whole(curve), len(curve.breaks)
    counts = []
    least = limit(path, 1.0)
    for tolerance in TOLERANCES:
        fit = fitted(name, tolerance)
        assert fit.deviation <= tolerance == fit.tolerance
        assert fit.contour.arc_count == 0
        counts.append(len(fit.contour))
        assert counts[-1] <= 1.03 * least / math.sqrt(tolerance) + breaks
    slope = math.log(counts[-1] / counts[0]) / math.log(TOLERANCES[-1] / TOLERANCES[0])
    assert slope == pytest.approx(-0.5, abs=0.02)
    assert counts == sorted(counts)


@flanks
def test_within_tolerance_on_both_sides(name: tuple[str, int]) -> None:
    fit = fitted(name, 1e-3)
    found = dense_flank(name).measured(fit.contour)
    assert found <= fit.deviation + NOTHING
    # The proof's own slack is 1 %; the fit leaves the rest to spare.
    assert fit.deviation <= 1.05 * found + 1e-9


@settings(some, max_examples=examples(4, long=8))
@given(curves(), st.sampled_from([1e-2, 1e-3, 1e-4]))
def test_any_cam(curve: WorkingCurve, tolerance: float) -> None:
    path = whole(curve)
    fit = fewest_chords(path, tolerance)
    assert len(fit.contour) <= 1.03 * limit(path, tolerance) + max(1, len(curve.breaks))
    assert len(fit.contour) <= len(fit_polyline(path, tolerance).contour)
    assert Dense.of(curve).measured(fit.contour) <= fit.deviation + NOTHING
    assert fit.deviation <= tolerance
    assert fit.contour.area > 0.0


@pytest.mark.parametrize("name", [name for name in PATHS if name != "cusp"])
def test_trimmed_outlines_keep_their_corners(name: str) -> None:
    path = PATHS[name]()
    fit = fewest_chords(path, 1e-3)
    assert measured(path, fit.contour) <= fit.deviation + SAGITTA
    assert fit.deviation <= 1e-3
    for pivot in path.pivots:
        assert np.any(fit.contour.vertices == pivot.start)
    assert len(fit.contour) < 0.75 * len(fit_polyline(path, 1e-3).contour)


def test_a_circle_needs_the_number_of_pieces_that_geometry_demands() -> None:
    """cos(pi/n) = (r - u)/(r + u); the proof takes 1.15 % of the tolerance, u the rest."""
    path = whole(cam(dwell(360)))
    least = math.pi / (2.0 * math.asin(math.sqrt(1e-3 / 32.001)))
    count = len(fewest_chords(path, 1e-3).contour)
    assert least <= count <= 1.008 * least + 1.0


def test_breaks_where_nothing_changes_need_no_chords_of_their_own() -> None:
    """Moves by nothing are a circle as well: joints of the plan alone add none."""
    path = whole(cam(dwell(40), move(140, 0.0), dwell(60), move(120, 0.0)))
    assert len(fewest_chords(path, 1e-3).contour) == len(
        fewest_chords(whole(cam(dwell(360))), 1e-3).contour
    )


@ladder
def test_counts_never_grow_with_the_tolerance(path: Callable[[], Path]) -> None:
    exact = path()
    least, breaks = limit(exact, 1.0), len(exact.stretches[0].curve.breaks)
    counts = []
    for tolerance in np.geomspace(0.3, 1e-4, examples(10, long=30)):
        counts.append(len(fewest_chords(exact, float(tolerance)).contour))
        if tolerance < COARSE:
            assert counts[-1] <= 1.03 * least / math.sqrt(tolerance) + breaks
    assert counts == sorted(counts)


@some
@given(curves(), st.floats(-4.0, -0.5), st.floats(0.5, 1.0))
def test_counts_of_any_cam_never_grow_with_the_tolerance(
    curve: WorkingCurve, size: float, share: float
) -> None:
    path, tolerance = whole(curve), 10.0**size
    tighter = fewest_chords(path, share * tolerance)
    assert len(fewest_chords(path, tolerance).contour) <= len(tighter.contour)


@pytest.mark.parametrize("size", [1e-3, 1e3])
@pytest.mark.parametrize("tolerance", [1e-2, 1e-4])
def test_size_does_not_matter(size: float, tolerance: float) -> None:
    def scaled(factor: float) -> Path:
        segments = dwell(40), move(140, 15.0 * factor), dwell(60), move(120, 0.0)
        return whole(cam(*segments, base=40.0 * factor, roller=8.0 * factor))

    one, other = (
        fewest_chords(scaled(1.0), tolerance),
        fewest_chords(scaled(size), size * tolerance),
    )
    assert len(one.contour) == len(other.contour)
    # Both are off by the same amount, except for rounding, which a tolerance of 1e-4 mm shows.
    assert other.deviation == pytest.approx(size * one.deviation, rel=1e-6)


def test_undercut_and_tolerance_beyond_arithmetic_are_refused() -> None:
    with pytest.raises(UndercutError, match="cusp or undercut"):
        fewest_chords(whole(cam(move(40, 20.0), move(40, 0.0), dwell(280), roller=20.0)), 1e-3)
    with pytest.raises(ToleranceError, match="tolerance 1e-14 mm requested"):
        fewest_chords(whole(flank("setzhub", -1)), 1e-14)


def test_same_bytes() -> None:
    path = whole(flank("schnitt", -1))
    one, other = fewest_chords(path, 1e-3), fewest_chords(path, 1e-3)
    assert np.array_equal(one.contour.vertices, other.contour.vertices)
    assert one.deviation == other.deviation
