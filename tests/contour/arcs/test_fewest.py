"""The fewest G1 arcs: near the limit, tangent, proved, and never more for a wider tolerance."""

from __future__ import annotations

import math
from decimal import Decimal
from functools import cache
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings

from camgeo.errors import GeometryError, ToleranceError, UndercutError
from camgeo.geometry.contour import fewest_arcs as fewest_module
from camgeo.geometry.contour.arcs import fit_arcs
from camgeo.geometry.contour.contour import Fit
from camgeo.geometry.contour.fewest_arcs import Strands, fewest_arcs
from camgeo.geometry.contour.least_pieces import forced_pieces, least_arcs
from camgeo.geometry.outline.path import whole
from camgeo.geometry.pieces import smooth_pieces
from camgeo.geometry.pitch_curve import PitchCurve
from camgeo.geometry.working_curve import WorkingCurve
from camgeo.kinematics.mechanism.translating_roller import TranslatingRoller
from camgeo.kinematics.plan import MotionPlan, Move
from camgeo.numeric.arrays import IntArray
from tests.contour.cams import (
    FLANKS,
    TURN,
    Dense,
    curves,
    dense_flank,
    dwell,
    flank,
    move,
    translating,
)
from tests.contour.paths import PATHS, break_count, measured
from tests.contour.paths import SAGITTA as PATH_SAGITTA
from tests.contour.tangents import PLACE, check_shared_ends, check_tangent
from tests.laws import LAWS
from tests.long_form import examples

NOWHERE = np.empty(0, dtype=np.complex128)

SAGITTA = 2e-6
"""Chords of the dense curve by which is measured, see `Dense` [mm]."""

some = settings(
    max_examples=examples(4, long=6),
    deadline=None,
    suppress_health_check=[HealthCheck.too_slow, HealthCheck.filter_too_much],
)


@cache
def fitted(name: tuple[str, int], tolerance: float) -> Fit:
    """The fit of a fixture flank, made once for all tests that use it."""
    return fewest_arcs(whole(flank(*name)), tolerance)


def _check_target(curve: WorkingCurve, tolerance: float) -> int:
    """At most a tenth more arcs than the limit, and two for each break. Returns their number."""
    path = whole(curve)
    fit = fewest_arcs(path, tolerance)
    assert fit.deviation <= tolerance == fit.tolerance
    limit = 1.1 * least_arcs(path, tolerance) + 2 * break_count(path)
    assert len(fit.contour) <= limit
    return len(fit.contour)


@pytest.mark.parametrize("tolerance", [1e-2, 1e-3, 1e-4, 1e-5, 1e-6])
@pytest.mark.parametrize("name", FLANKS, ids=str)
def test_the_fast_fit_never_needs_fewer(name: tuple[str, int], tolerance: float) -> None:
    """The fit has whole pairs of arcs, and given tangents at the ends of pieces. That the fewest
    are near the limit on all fixture cams is tested end to end (`test_targets`).
    """
    fit = fitted(name, tolerance)
    assert fit.tolerance == tolerance
    assert len(fit_arcs(whole(flank(*name)), tolerance).contour) >= len(fit.contour)


@some
@given(curves())
def test_any_cam_is_near_the_limit(curve: WorkingCurve) -> None:
    counts = [_check_target(curve, tolerance) for tolerance in (1e-2, 1e-3, 1e-4, 1e-5, 1e-6)]
    assert counts == sorted(counts)


@pytest.mark.parametrize("tolerance", [0.02, 0.001])
@pytest.mark.parametrize("name", FLANKS, ids=str)
def test_deviation_is_proved_and_sharp(name: tuple[str, int], tolerance: float) -> None:
    fit = fitted(name, tolerance)
    assert fit.contour.area > 0.0
    found = dense_flank(name).measured(fit.contour)
    assert found <= fit.deviation + SAGITTA
    # The proof's own slack is 1 %, and dense sampling finds all but (1/100)^2 of an arc's bulge.
    # To this come the gaps at the feet: an offset times the sine of its tangent's turn, which is
    # less than 0.03 where the coarsest arcs turn by half a radian.
    assert fit.deviation <= 1.05 * found + 1e-9


@some
@given(curves())
def test_any_cam_is_proved_and_tangent(curve: WorkingCurve) -> None:
    fit = fewest_arcs(whole(curve), 0.002)
    assert Dense.of(curve).measured(fit.contour) <= fit.deviation + SAGITTA
    check_tangent(fit.contour, NOWHERE)
    check_shared_ends(fit.contour)


@pytest.mark.parametrize("tolerance", [0.1, 1e-5])
@pytest.mark.parametrize("name", FLANKS, ids=str)
def test_arcs_are_tangent_and_meet(name: tuple[str, int], tolerance: float) -> None:
    contour = fitted(name, tolerance).contour
    check_tangent(contour, NOWHERE)
    check_shared_ends(contour)


@some
@given(curves())
def test_breaks_are_joints_and_a_dwell_is_one_arc_about_the_axis(curve: WorkingCurve) -> None:
    contour = fewest_arcs(whole(curve), 0.01).contour
    for place in curve.point(curve.breaks):
        assert np.min(np.abs(contour.vertices - place)) <= PLACE
    found = sorted(contour.sweeps[contour.centres == 0.0].tolist())
    spans = sorted(piece.end - piece.start for piece in smooth_pieces(curve) if piece.dwell)
    assert found == pytest.approx(spans, rel=1e-15)


@pytest.mark.parametrize("name", FLANKS, ids=str)
def test_arcs_grow_by_the_third_root(name: tuple[str, int]) -> None:
    """Less the dwells, and one for each smooth piece: its ends, where point and tangent are given,
    cost two thirds of an arc, and whole numbers half a one.
    """
    curve = flank(*name)
    path = whole(curve)
    tolerances = [1e-3, 3e-4, 1e-4, 3e-5, 1e-5, 3e-6, 1e-6]
    counts = np.array([len(fitted(name, tolerance).contour) for tolerance in tolerances])
    free = counts - forced_pieces(path) - sum(not piece.dwell for piece in smooth_pieces(curve))
    slope = np.polyfit(np.log(tolerances), np.log(free), 1)[0]
    assert slope == pytest.approx(-1.0 / 3.0, abs=0.02)


@pytest.mark.parametrize("name", [("setzhub", -1), ("ring", 1)], ids=str)
def test_a_wider_tolerance_never_asks_for_more(name: tuple[str, int]) -> None:
    path = whole(flank(*name))
    tolerances = np.logspace(-0.5, -4.5, examples(13, long=25))
    counts = [len(fewest_arcs(path, tolerance).contour) for tolerance in tolerances]
    assert counts == sorted(counts)
    assert counts[0] < counts[-1]


def test_the_same_input_gives_the_same_bytes() -> None:
    path = whole(flank("setzhub", -1))
    first, second = fewest_arcs(path, 1e-4).contour, fewest_arcs(path, 1e-4).contour
    for name in ("vertices", "sweeps", "centres"):
        assert getattr(first, name).tobytes() == getattr(second, name).tobytes()


@pytest.mark.parametrize("tolerance", [0.05, 1e-3])
@pytest.mark.parametrize("name", PATHS)
def test_trimmed_paths(name: str, tolerance: float) -> None:
    """Corners, turns, and a cusp in one point."""
    path = PATHS[name]()
    fit = fewest_arcs(path, tolerance)
    assert fit.deviation <= tolerance
    limit = 1.1 * least_arcs(path, tolerance) + 2 * break_count(path)
    assert len(fit.contour) <= limit
    assert len(fit.contour) <= len(fit_arcs(path, tolerance).contour)
    assert measured(path, fit.contour) <= fit.deviation + PATH_SAGITTA


@pytest.mark.parametrize("tolerance", [1e-2, 1e-6])
@pytest.mark.parametrize("stroke", [1e-12, 1e-9, 1e-4])
def test_slight_strokes(stroke: float, tolerance: float) -> None:
    """Two arcs a move follow a stroke of less than the tolerance."""
    curve = translating(dwell(40), move(100, stroke), dwell(60), move(160, 0.0))
    contour = fewest_arcs(whole(curve), tolerance).contour
    assert len(contour) == 6 if stroke < tolerance else len(contour) <= 10
    check_tangent(contour, NOWHERE)


def test_a_move_of_a_millionth_of_a_radian() -> None:
    tiny = Decimal("0.00006")
    segments = (dwell(40), Move(Decimal(140) - tiny, 10.0, LAWS["polynomial-345"]))
    curve = translating(
        *segments, dwell(0), Move(tiny, 10.0, LAWS["straight-line"]), move(180, 0.0)
    )
    contour = fewest_arcs(whole(curve), 1e-3).contour
    assert len(contour) <= len(fit_arcs(whole(curve), 1e-3).contour)
    check_tangent(contour, NOWHERE)


@pytest.mark.parametrize("size", [1e-3, 1e6])
def test_counts_do_not_depend_on_the_unit(size: float) -> None:
    """A cam and a tolerance twice as large ask for the same arcs."""

    def count(scale: float) -> int:
        plan = MotionPlan((dwell(40), move(100, 0.2 * scale), dwell(60), move(160, 0.0)))
        pitch = PitchCurve(plan, TranslatingRoller(scale, 0.2 * scale), 1)
        fit = fewest_arcs(whole(WorkingCurve(pitch, -0.2 * scale)), 1e-5 * scale)
        assert fit.deviation <= 1e-5 * scale
        return len(fit.contour)

    assert count(size) == count(1.0)


def test_cam_that_rests_all_turn_is_a_circle() -> None:
    fit = fewest_arcs(whole(translating(dwell(360))), 1e-9)
    assert len(fit.contour) == 1
    assert fit.deviation < 1e-11


@pytest.mark.long
# The fast fit, which it falls back on, refuses the same in tests/contour/test_fit.
def test_tolerance_beyond_arithmetic_is_refused() -> None:
    with pytest.raises(ToleranceError, match="tolerance 1e-14 mm requested"):
        fewest_arcs(whole(flank("querhub", -1)), 1e-14)


def test_what_no_arcs_can_be_made_of_is_refused_as_by_the_fast_fit() -> None:
    torn = translating(dwell(40), move(140, 15.0, "straight-line"), dwell(60), move(120, 0.0))
    with pytest.raises(GeometryError, match="torn apart at cam angle 40 degrees"):
        fewest_arcs(whole(torn), 0.001)
    undercut = translating(move(40, 20.0), move(40, 0.0), dwell(280), roller=20.0)
    with pytest.raises(UndercutError, match="cusp or undercut between cam angles"):
        fewest_arcs(whole(undercut), 0.001)


def test_no_arc_exceeds_half_a_turn_where_the_tolerance_is_as_wide_as_the_cam() -> None:
    """But for dwells, which are one arc of any sweep."""
    curve = translating(move(180, 12.0, "simple-sine"), move(180, 0.0, "simple-sine"))
    contour = fewest_arcs(whole(curve), 30.0).contour
    assert np.max(np.abs(contour.sweeps)) <= math.pi
    assert np.sum(contour.sweeps) == pytest.approx(TURN)


def test_attempts_that_do_not_help_are_few(monkeypatch: pytest.MonkeyPatch) -> None:
    tried: list[int] = []

    def none(strands: Strands, pieces: IntArray, counts: IntArray) -> list[SimpleNamespace]:
        tried.append(int(np.sum(counts)))
        return [SimpleNamespace(deviation=math.inf) for _ in counts]

    monkeypatch.setattr(fewest_module, "arc_splines", none)
    monkeypatch.setattr(fewest_module, "LAID", 0)
    assert fewest_arcs(whole(flank("vorschub", -1)), 1e-2).deviation <= 1e-2
    assert len(tried) == 1
