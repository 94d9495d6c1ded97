"""The fast fits: counts that never grow with the tolerance, their limits, and a proof that holds
for contours whose vertices lie off the curve."""

from __future__ import annotations

import math
from collections.abc import Callable
from decimal import Decimal
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from camgeo.geometry.contour.arcs import Biarcs, Ends, fit_arcs
from camgeo.geometry.contour.chords import fit_polyline
from camgeo.geometry.contour.contour import Contour, Fit
from camgeo.geometry.contour.fewest_arcs import fewest_arcs
from camgeo.geometry.contour.fewest_chords import fewest_chords
from camgeo.geometry.contour.least_pieces import forced_pieces, least_arcs, least_chords
from camgeo.geometry.contour.legs import above, ladder
from camgeo.geometry.contour.proof import deviation
from camgeo.geometry.contour.spline import highest
from camgeo.geometry.outline.path import Path, whole
from camgeo.geometry.pitch_curve import PitchCurve
from camgeo.geometry.working_curve import WorkingCurve
from camgeo.kinematics.mechanism.oscillating_roller import OscillatingRoller
from camgeo.kinematics.plan import Dwell, MotionPlan, Move
from tests.contour.cams import FLANKS, TURN, curves, dense_flank, flank, move, outline, polyline
from tests.contour.cams import translating as cam
from tests.contour.paths import break_count
from tests.laws import LAWS
from tests.long_form import examples

Fitter = Callable[[Path, float], Fit]

some = settings(
    max_examples=examples(6, long=10),
    deadline=None,
    suppress_health_check=[HealthCheck.too_slow, HealthCheck.filter_too_much],
)

SAGITTA = 2e-6
"""Sagitta of the dense curve used for measuring [mm]."""


def _counts(curve: WorkingCurve, fitter: Fitter, tolerances: list[float]) -> list[int]:
    return [len(fitter(whole(curve), tolerance).contour) for tolerance in tolerances]


@pytest.mark.parametrize(
    ("fitter", "finest", "steps"),
    [(fit_arcs, 1e-6, examples(21, long=61)), (fit_polyline, 1e-4, examples(14, long=41))],
)
@pytest.mark.parametrize("name", FLANKS, ids=str)
def test_counts_never_grow_with_the_tolerance(
    name: tuple[str, int], fitter: Fitter, finest: float, steps: int
) -> None:
    ladder_of = np.geomspace(1e-1, finest, steps).tolist()
    assert np.all(np.diff(_counts(flank(*name), fitter, ladder_of)) >= 0)


@some
@given(curves(), st.floats(-4.0, -1.0), st.floats(1e-3, 0.3))
def test_counts_of_any_cam_never_grow(curve: WorkingCurve, size: float, step: float) -> None:
    tolerances = [10.0 ** (size - k * step) for k in range(4)]
    for fitter in (fit_arcs, fit_polyline):
        assert np.all(np.diff(_counts(curve, fitter, tolerances)) >= 0)


def _check_arcs(path: Path, tolerance: float) -> None:
    count = len(fit_arcs(path, tolerance).contour) - forced_pieces(path)
    limit = least_arcs(path, tolerance)
    assert limit <= count <= 1.5 * limit + 2.0 * break_count(path)


@pytest.mark.parametrize("tolerance", [1e-2, 1e-3, 1e-4, 1e-5, 1e-6])
@pytest.mark.parametrize("name", FLANKS, ids=str)
def test_arcs_are_near_their_law(name: tuple[str, int], tolerance: float) -> None:
    _check_arcs(whole(flank(*name)), tolerance)


@settings(some, max_examples=examples(10, long=20))
@given(curves(), st.floats(-6.0, -2.0))
def test_arcs_of_any_cam_are_near_their_law(curve: WorkingCurve, size: float) -> None:
    _check_arcs(whole(curve), 10.0**size)


@pytest.mark.parametrize("name", FLANKS, ids=str)
def test_arcs_with_turned_tangents_beat_the_curves_own(name: tuple[str, int]) -> None:
    """Biarcs with the curve's own tangents need 0.2912 / 0.2002 of the limit and more."""
    path = whole(flank(*name))
    count = len(fit_arcs(path, 1e-6).contour) - forced_pieces(path)
    # The ends of a piece cost 1.3 spans, a whole number half a span, in the mean: two pairs.
    assert count <= 1.1 * least_arcs(path, 1e-6) + 4.0 * break_count(path)


@pytest.mark.parametrize("tolerance", [1e-2, 1e-4])
@pytest.mark.parametrize("name", FLANKS, ids=str)
def test_chords_are_near_their_law(name: tuple[str, int], tolerance: float) -> None:
    path = whole(flank(*name))
    count = len(fit_polyline(path, tolerance).contour)
    # With vertices on the curve sqrt(2) of the limit, which lets them lie on the other side.
    limit = np.sqrt(2.0) * least_chords(path, tolerance)
    assert 0.99 * limit <= count <= 1.02 * limit + 2 * break_count(path)


@pytest.mark.parametrize("tolerance", [1e-2, 1e-3])
@pytest.mark.parametrize("name", FLANKS, ids=str)
def test_bound_is_sharp_with_middles_off_the_curve(name: tuple[str, int], tolerance: float) -> None:
    """The middles of biarcs lie off the curve; across from them it leaves no gap."""
    fit = fit_arcs(whole(flank(*name)), tolerance)
    found = dense_flank(name).measured(fit.contour, 20_000)
    assert found - SAGITTA <= fit.deviation
    # 1 % is the proof's; dense sampling finds all but 1e-3 of a bulge of 100 points or more.
    assert fit.deviation <= 1.011 * found + SAGITTA


@settings(some, max_examples=8)
@given(
    st.sampled_from(FLANKS),
    st.sampled_from([1e-1, 1e-2]),
    st.integers(0, 2**32 - 1),
    st.sampled_from([-1.0, 0.0, 1.0]),
)
def test_vertices_off_the_curve(
    name: tuple[str, int], tolerance: float, seed: int, side: float
) -> None:
    """Arcs and chords with vertices off by the tolerance, on one side or on both."""
    curve = flank(*name)
    for fit in (fit_arcs(whole(curve), tolerance), fit_polyline(whole(curve), tolerance)):
        vertices, sweeps = fit.contour.vertices, fit.contour.sweeps
        chord = np.roll(vertices, -1) - np.roll(vertices, 1)
        signs = np.random.default_rng(seed).uniform(-1.0, 1.0, len(vertices))
        off = tolerance * np.where(side == 0.0, np.sign(signs), side)
        # Mostly across, a little along.
        moved = vertices + chord / np.abs(chord) * (1j * off + 0.1 * tolerance * signs)
        step = np.roll(moved, -1) - moved
        safe = np.where(sweeps == 0.0, 1.0, sweeps)
        centres = moved + 0.5 * step * (1.0 + 1j / np.tan(0.5 * safe))
        contour = Contour(moved, sweeps, np.where(sweeps == 0.0, 0.0, centres))
        bound = deviation(whole(curve), contour)
        found = dense_flank(name).measured(contour, 10_000)
        assert found - SAGITTA <= bound
        # A vertex counts as far as it is off, 1 % more, and a step along that is a tenth of it;
        # corners are hit by the samples to their distance from them times the turn of a piece.
        assert bound <= 1.05 * found + SAGITTA


def test_a_vertex_moved_along_the_curve_is_seen() -> None:
    """Two chords in line where the curve is straight: the distance across is nothing."""
    curve = flank("setzhub", -1)
    contour = fit_polyline(whole(curve), 1e-2).contour
    for index in range(0, len(contour), 50):
        vertices = contour.vertices.copy()
        ahead = vertices[(index + 1) % len(vertices)] - vertices[index]
        vertices[index] += 0.3 * ahead
        bound = deviation(whole(curve), polyline(vertices))
        assert bound >= dense_flank(("setzhub", -1)).measured(polyline(vertices), 4_000) - SAGITTA


def test_ladder_is_the_same_from_everywhere() -> None:
    rungs = [1]
    while rungs[-1] < 100_000:
        rungs.append(above(rungs[-1]))
    for value in (0.0, 1.0, 1.5, 57.2, 200.0, 201.0, 70_000.5):
        assert ladder(value) == next(rung for rung in rungs if rung >= value)
    assert max(b / a for a, b in pairwise(rungs[200:])) <= 1.0101


@given(st.lists(st.floats(-10.0, 10.0), min_size=4, max_size=4))
def test_highest_of_a_cubic(parts: list[float]) -> None:
    start, end, slope, end_slope = (np.array([part]) for part in parts)
    t = np.linspace(0.0, 1.0, 2001)[1:-1]
    square, cube = 3 * (end - start) - 2 * slope - end_slope, slope + end_slope - 2 * (end - start)
    values = np.abs(start + t * (slope + t * (square + t * cube)))
    found = highest(start, end, slope, end_slope)[0]
    largest = max(float(np.max(values)), abs(parts[0]), abs(parts[1]))
    # Samples 5e-4 apart miss (5e-4)^2/16 of a second derivative of 400 at most.
    assert max(found, abs(parts[0]), abs(parts[1])) == pytest.approx(largest, abs=1e-5)


@some
@given(curves(), st.floats(0.0, TURN), st.floats(0.02, 0.3), st.integers(1, 6))
def test_distances_of_biarcs(curve: WorkingCurve, start: float, span: float, count: int) -> None:
    """The distance found from six places a span is that of dense samples, also where tangents are
    turned off the curve's own at the joints between."""
    breaks = np.concatenate([curve.breaks - TURN, curve.breaks, curve.breaks + TURN, [start + 9.0]])
    end = min(start + span, float(np.min(breaks[breaks > start + 1e-9])))
    joints = np.linspace(start, end, count + 1)
    ends = Ends(*curve.traced(joints[-1:], "left"))
    biarcs = Biarcs.along(curve, joints, np.array([count]), ends)
    chain = biarcs.chain()
    points = curve.point(np.linspace(start, end, 4000)[:-1])
    contour = Contour(
        np.append(chain.vertices, biarcs.ends[-1]),
        np.append(chain.sweeps, 0.0),
        np.append(chain.centres, 0.0),
    )
    found = float(np.max(outline(contour).distances(points)))
    # Hermite's cubics leave 1/384 of the fourth derivative over a sixth of a span; what the proof
    # has in reserve is 1.5 %.
    assert np.max(biarcs.distances) == pytest.approx(found, rel=0.012, abs=1e-11)


@pytest.mark.parametrize("fitter", [fit_arcs, fewest_arcs, fit_polyline, fewest_chords])
def test_a_whole_turn_without_a_stroke(fitter: Fitter) -> None:
    """One smooth piece from a point to itself, whose chord has no length."""
    path = whole(cam(move(360, 0.0), base=40.0, roller=8.0))
    fit = fitter(path, 0.01)
    assert fit.deviation <= 0.01
    assert fit.contour.area == pytest.approx(math.pi * 32.0**2, abs=0.01 * 2.0 * math.pi * 32.0)


@pytest.mark.parametrize("fitter", [fit_arcs, fewest_arcs, fit_polyline])
def test_a_flank_that_runs_off_within_a_degree(fitter: Fitter) -> None:
    """A stroke in a quarter of a degree, too short for even samples of a turn."""
    segments = (
        Move(Decimal("0.255238"), 0.91154, LAWS["polynomial-4567"]), Dwell(Decimal("12.465865")),
        Move(Decimal("330.222967"), 0.0, LAWS["polynomial-345"]), Dwell(Decimal("17.05593")),
    )  # fmt: skip
    follower = OscillatingRoller(64.38 - 81.2j, 126.324, 73.39, 0.0105, -1, 1)
    path = whole(WorkingCurve(PitchCurve(MotionPlan(segments), follower, 1), -0.0105))
    fit = fitter(path, 0.07)
    # Placed anew, as when a file is read.
    assert deviation(path, fit.contour) <= 1.02 * fit.deviation <= 1.02 * 0.07
