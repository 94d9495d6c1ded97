"""What all fits share: legs of a path, joints, numbers of pieces, and what decides between them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from camgeo.errors import ToleranceError, UndercutError
from camgeo.geometry.contour import fewest_chords as ladder_module
from camgeo.geometry.contour.arcs import OUTERMOST, Strands, arc_splines, tangent_turns
from camgeo.geometry.contour.fewest_chords import (
    ChordStretch,
    EqualErrorPieces,
    Ladder,
    StretchTable,
    require_regular,
    stretch_table,
)
from camgeo.geometry.contour.legs import (
    JOINT_DISTANCE,
    STEP,
    Bends,
    StretchLeg,
    TurnLeg,
    clearly_less,
    in_steps,
    least_counts,
    path_legs,
    sample_bends,
    separate_joints,
)
from camgeo.geometry.contour.proof import fit_until_proved
from camgeo.geometry.outline.path import Path, Pivot, Stretch, whole
from camgeo.geometry.pieces import SmoothPiece, smooth_pieces
from camgeo.geometry.pitch_curve import WorkingCurve
from camgeo.numeric.arrays import ComplexArray, FloatArray, IntArray
from camgeo.studies.accuracy.contours import forced_pieces, least_arcs, least_chords, least_cubics
from tests.contour.cams import FLANKS, TURN, dwell, flank, move, translating
from tests.contour.paths import break_count, cut_off_lobe, hard_curve, shocks
from tests.strategies import attack

CAM = translating(dwell(60), move(120, 15.0), dwell(60), move(120, 0.0))
"""Breaks at 0, 60, 180 and 240 degrees."""


@attack
@given(st.floats(0.0, 6.28), st.floats(0.01, 1.0))
def test_pieces_fill_the_stretch(start: float, share: float) -> None:
    end = start + share * TURN
    leg = StretchLeg(CAM, start, end, False, None)
    pieces = leg.pieces
    assert pieces[0].start == start
    assert pieces[-1].end == end
    assert all(one.end == other.start for one, other in pairwise(pieces))
    for piece in pieces:
        middle = math.degrees(0.5 * (piece.start + piece.end)) % 360.0
        assert piece.dwell == (middle < 60.0 or 180.0 < middle < 240.0)
    inner = {round(math.degrees(piece.start)) % 360 for piece in pieces[1:]}
    assert inner <= {0, 60, 180, 240}


@pytest.mark.parametrize("steps", [-2, -1, 0, 1, 2])
def test_no_sliver_next_to_a_break(steps: int) -> None:
    """The ends of a stretch a few ulp off a break make no piece of their own."""
    angle = math.radians(60.0)
    for _ in range(abs(steps)):
        angle = math.nextafter(angle, math.copysign(9.0, steps))
    pieces = StretchLeg(CAM, angle, angle + TURN, False, None).pieces
    assert len(pieces) == 4
    assert (pieces[0].start, pieces[-1].end) == (angle, angle + TURN)


def test_legs_begin_where_corners_and_arcs_end() -> None:
    (only,) = path_legs(cut_off_lobe())
    assert only.first == cut_off_lobe().pivots[0].centre
    assert not only.closed
    path = shocks(-1, 1)
    first, turn, second = path_legs(path)
    arc, corner = path.pivots
    assert (first.first, turn.first, second.first) == (corner.centre, arc.start, arc.end)


def test_degenerate_elements_are_no_legs() -> None:
    point = complex(CAM.point(np.array([1.0]))[0])
    tiny = 4.0 * math.ulp(1.0)
    path = Path(
        (
            Stretch(CAM, 1.0, 1.0 + TURN),
            Pivot(point, 8.0, 1j, -1e-17, 1.0, 1.0),
            Stretch(CAM, 1.0, 1.0 + tiny),
            Pivot(point, 0.0, 1j, -1.0, 1.0, 1.0),
        )
    )
    (leg,) = path_legs(path)
    assert (leg.start, leg.end) == (1.0, 1.0 + TURN)


@attack
@given(st.floats(0.01, 100.0), st.floats(0.01, 3.1), st.booleans(), st.floats(0.0, 1.0))
def test_arc_as_a_leg(radius: float, size: float, back: bool, share: float) -> None:
    sweep = -size if back else size
    centre, normal = 3.0 - 4.0j, np.exp(0.7j)
    pivot = Pivot(centre, radius, complex(normal), sweep, 0.0, 0.0)
    leg = TurnLeg(centre, pivot.start, pivot.end, sweep)
    # A point is rounded to some ulp of the centre's 5 mm and of the radius.
    rounding = 1e-15 * (5.0 + radius)
    ends = leg.point(np.array([0.0, leg.end]))
    assert np.abs(ends - np.array([pivot.start, pivot.end])).max() <= rounding
    t, step = np.array([share * size]), 1e-5
    jet, bounds = leg.jet_and_bounds(t, t)
    assert abs(jet[0] - leg.point(t)) <= rounding
    # Central differences: error step^2/6 of the radius, and rounding over the step.
    allowed = radius * step**2 / 6.0 + 2.0 * rounding / step
    for order in (0, 1):
        after, before = (leg.jet_and_bounds(at, at)[0][order] for at in (t + step, t - step))
        slope = (after - before) / (2.0 * step)
        assert abs(slope - jet[order + 1])[0] <= allowed
    points, tangents, pace = leg.traced(t)
    assert points == leg.point(t)
    assert tangents == pytest.approx(jet[1] / radius, rel=1e-12)
    assert pace == pytest.approx(np.abs(jet[1]), rel=1e-12)
    assert np.all(bounds >= np.abs(jet[1]) * (1.0 - 1e-12))
    assert leg.length == pytest.approx(radius * size, rel=1e-12)


CUSP = math.radians(78.9790897521664912236687251744)


def test_a_cusp_in_one_point_is_regular_and_beyond_is_not() -> None:
    """The samples' own middle falls on the cusp of HC21a."""
    piece = SmoothPiece(CUSP - 0.1, CUSP + 0.1)
    curve = hard_curve("HC21a")
    assert abs(curve.regularity(np.array([CUSP]))[0]) < 1e-13
    require_regular(curve, piece)
    with pytest.raises(UndercutError, match=r"between cam angles 73\.2495 and 84\.7087 degrees"):
        require_regular(WorkingCurve(curve.pitch, curve.distance * (1.0 + 1e-11)), piece)


@pytest.mark.parametrize(("roller", "regular"), [(39.999, True), (40.0, False), (40.001, False)])
def test_dwell_needs_a_radius(roller: float, regular: bool) -> None:
    pitch = translating(dwell(180), move(100, 1.0), move(80, 0.0)).pitch
    curve, piece = WorkingCurve(pitch, -roller), SmoothPiece(0.0, math.pi, 0j)
    if regular:
        require_regular(curve, piece)
        return
    with pytest.raises(UndercutError):
        require_regular(curve, piece)


def test_joints_near_a_cusp_are_kept_apart() -> None:
    curve = hard_curve("HC21a")
    near = np.geomspace(1e-7, 0.05, 200)
    joints = np.concatenate((CUSP - near[::-1], [CUSP], CUSP + near))
    points = curve.point(joints)
    least = JOINT_DISTANCE * np.max(np.abs(points))
    assert np.min(np.abs(np.diff(points))) < 1e-3 * least
    kept = separate_joints(curve, joints)
    assert (kept[0], kept[-1]) == (joints[0], joints[-1])
    assert np.all(np.isin(kept, joints))
    assert np.min(np.abs(np.diff(curve.point(kept)))) >= least
    # Those that are far enough from each other all stay.
    assert len(kept) >= np.count_nonzero(np.abs(np.diff(points)) >= least)


def test_refined_bends_are_linear_and_no_speed_is_negative() -> None:
    """At the end of a steep move the speed grows more than threefold from cell to cell."""
    steep, even = np.array([1e-3, 1e2, 1e4]), np.array([-1.0, 0.0, 1.0])
    fine = Bends(steep, even, even, even).refined()
    assert np.min(fine.speed) >= 0.0
    # Eight cells for one: in the outer half cells the straight line is carried on.
    np.testing.assert_allclose(fine.slope, (np.arange(24) - 11.5) / 8.0, atol=1e-15)


SIZES = st.floats(1e-12, 1e3)


@given(SIZES, st.integers(-9, 9))
def test_of_equal_deviations_neither_is_less(size: float, units: int) -> None:
    """Equal except for `units` of 1e-11."""
    other = np.array([size * (1.0 + 1e-11 * units)])
    assert not clearly_less(other, np.array([size]))[0]
    assert not clearly_less(np.array([size]), other)[0]


@given(SIZES)
def test_less_by_a_tenth_of_a_step_is_less(size: float) -> None:
    best = np.array([size, np.inf, size])
    found = np.array([size * (1.0 - 0.1 * STEP), size, np.nan])
    assert clearly_less(found, best).tolist() == [True, True, False]


@given(st.integers(-9_000, 9_000), st.floats(-0.499, 0.499))
def test_steps(number: int, part: float) -> None:
    """Numbers go to the nearest multiple of a step, which zero is too."""
    assert in_steps(np.array([(number + part) * STEP]))[0] == number * STEP


MOST = 2_000_000


def _least(step: float, needed: float, tried: list[int]) -> list[int]:
    """The least count within 0.5 mm, by those `tried`, of a curve that needs that many `needed`
    parts for it and has a step of `step` mm."""

    def make(wanted: Sequence[tuple[int, int]]) -> list[tuple[int, float]]:
        tried.extend(count for _, count in wanted)
        return [(count, max(step, 0.5 * (needed / count) ** 2)) for _, count in wanted]

    return least_counts(make, np.array([3.0]), 0.5, 0.01, order=2.0, most=MOST)


@pytest.mark.parametrize("step", [0.6, 2.0])
def test_a_step_of_the_curve_is_not_divided_further(step: float) -> None:
    tried: list[int] = []
    with pytest.raises(ToleranceError) as caught:
        _least(step, 1_000.0, tried)
    assert caught.value.reached == pytest.approx(step)
    assert max(tried) < 20_000 < MOST


@pytest.mark.parametrize("needed", [10.0, 3_000.0, 1.5e6])
def test_counts_that_help_are_tried_on(needed: float) -> None:
    (count,) = _least(0.0, needed, [])
    assert needed <= count <= 1.02 * needed + 2.0


def test_a_lower_aim_that_does_not_help_is_the_last() -> None:
    aims: list[float] = []

    def fit(aim: float) -> float:
        aims.append(aim)
        return aim

    with pytest.raises(ToleranceError) as caught:
        fit_until_proved(fit, lambda aim: 5.0 + 0.1 * aim, 1.0, 1.0)
    assert len(aims) == 2
    assert caught.value.reached == pytest.approx(5.0, rel=0.05)


def test_an_aim_out_of_reach_is_told_by_the_proof_before() -> None:
    def fit(aim: float) -> float:
        if aim < 0.5:
            raise ToleranceError("no count will do", 1.0, 0.3)
        return aim

    with pytest.raises(ToleranceError) as caught:
        fit_until_proved(fit, lambda _: 4.0, 1.0, 1.0)
    assert caught.value.reached == 4.0
    with pytest.raises(ToleranceError, match="no count will do"):
        fit_until_proved(fit, lambda _: 4.0, 0.1, 1.0)


EPS = 1e-3
POINTS = 1000
"""Points a smooth piece for differences, steps h of some 0.1 mm: the rounding of a double at 50 mm,
7e-15 mm, enters the fourth difference by 7e-15/h^4 = 1e-10/mm^3, a hundred thousandth of kappa^3;
the error of the differences is (h/50)^2."""


def test_a_disc_without_a_move_needs_its_one_arc() -> None:
    path = whole(translating(dwell(360), base=40.0, roller=8.0))
    assert least_arcs(path, EPS) == 0.0
    # Two-sided chords of a circle: 2 pi sqrt(r / (16 eps)) by the small sagitta that is meant.
    assert least_chords(path, EPS) == pytest.approx(2.0 * math.pi * math.sqrt(32.0 / 16.0 / EPS))
    assert least_cubics(path, EPS) == 0.0
    assert forced_pieces(path) == 1
    assert break_count(path) == 1


def _whole(values: FloatArray, steps: FloatArray, lengths: FloatArray) -> float:
    """Integral over a whole piece, of which the `steps` leave out a little at both ends."""
    share = np.sum(lengths) * POINTS / len(lengths) / np.sum(steps)
    return float(np.sum(values * steps) * share)


@pytest.mark.parametrize("name", [("setzhub", -1), ("groove", 1), ("plate_translating", -1)])
def test_integrals_agree_with_points_of_the_flank(name: tuple[str, int]) -> None:
    """Curvature by the turn of chords, and its differences, on dense points of each piece."""
    curve = flank(*name)
    chords = arcs = cubics = 0.0
    for piece in smooth_pieces(curve):
        points = curve.point(np.linspace(piece.start, piece.end, POINTS + 1)[:-1])
        chord = np.diff(points)
        length = np.abs(chord)
        step = 0.5 * (length[1:] + length[:-1])
        kappa = np.angle(chord[1:] / chord[:-1]) / step
        slope = np.diff(kappa) / length[1:-1]
        fourth = np.diff(slope) / step[1:-1] - kappa[1:-1] ** 3
        chords += 0.25 * _whole(np.sqrt(np.abs(kappa) / EPS), step, length)
        if not piece.dwell:
            arcs += 0.2002 * _whole(np.cbrt(np.abs(slope) / EPS), length[1:-1], length)
            cubics += 0.18996 * _whole((np.abs(fourth) / EPS) ** 0.25, step[1:-1], length)
    path = whole(curve)
    # Each sum takes a point or three of 1,000 at the ends of each piece for as large as its mean.
    assert least_chords(path, EPS) == pytest.approx(chords, rel=2e-3)
    assert least_arcs(path, EPS) == pytest.approx(arcs, rel=3e-3)
    assert least_cubics(path, EPS) == pytest.approx(cubics, rel=5e-3)


def _strands(name: tuple[str, int]) -> Strands:
    curve = flank(*name)
    pieces = [piece for piece in smooth_pieces(curve) if not piece.dwell]
    return Strands.from_pieces(curve, pieces, sample_bends(curve, pieces))


@pytest.mark.parametrize("name", FLANKS, ids=str)
def test_a_spline_depends_on_its_piece_and_number_alone(name: tuple[str, int]) -> None:
    strands = _strands(name)
    pieces: IntArray = np.arange(len(strands.difficulty.totals))
    together = arc_splines(strands, np.repeat(pieces, 2), np.tile([9, 14], len(pieces)))
    for number, count in ((0, 9), (1, 14)):
        for piece in pieces:
            (alone,) = arc_splines(strands, np.array([piece]), np.array([count]))
            other = together[2 * piece + number]
            # Sums over the batch round differently, some 1e-15; rounds that swing multiply it.
            assert alone.deviation == pytest.approx(other.deviation, rel=1e-9)
            assert alone.angles == pytest.approx(other.angles, abs=1e-9)


def test_a_circle_that_is_no_dwell_is_one_arc() -> None:
    """A rest taken for a move: constant curvature."""
    curve = translating(dwell(100), dwell(260))
    (piece,) = smooth_pieces(curve)
    short = type(piece)(0.0, 2.0)
    strands = Strands.from_pieces(curve, [short], sample_bends(curve, [short]))
    (spline,) = arc_splines(strands, np.array([0]), np.array([1]))
    assert spline.deviation <= 1e-13
    chain = spline.chain()
    assert abs(chain.centres[0]) <= 1e-13 * 32.0 * 4.0
    assert abs(chain.sweeps[0]) == pytest.approx(2.0, rel=1e-14)


PLACES = np.arange(1, 6) / 6


def _turned(places: FloatArray) -> tuple[FloatArray, FloatArray]:
    """C1 quadratics over [0, 1] with a knot in the middle that are 0 at both ends, and have the
    slope 1 at the start, or at the end, and 0 at the other.
    """
    rows = []
    for slopes in ((1.0, 0.0), (0.0, 1.0)):
        # Bends b, c of the halves: s0 + (b + c)/2 = s1 and s0 + 3 b/8 + c/8 = 0.
        b, c = np.linalg.solve([[0.5, 0.5], [0.375, 0.125]], [slopes[1] - slopes[0], -slopes[0]])
        late = np.maximum(places - 0.5, 0.0)
        rows.append(slopes[0] * places + 0.5 * b * places**2 + 0.5 * (c - b) * late**2)
    return rows[0], rows[1]


@given(
    st.lists(st.lists(st.floats(0.1, 10.0), min_size=1, max_size=6), min_size=1, max_size=4),
    st.integers(0, 2**32 - 1),
)
def test_the_sum_of_squares_is_least(chains: list[list[float]], seed: int) -> None:
    lengths = np.concatenate(chains)
    apart = np.random.default_rng(seed).normal(size=(len(lengths), len(PLACES)))
    last = np.cumsum([len(chain) for chain in chains]) - 1
    turns = tangent_turns(apart, lengths, last)
    first, second = _turned(PLACES)
    start = 0
    for chain in chains:
        # Each chain by itself, by another way of solving.
        stop = start + len(chain)
        rows = np.zeros((len(chain), len(PLACES), len(chain) + 1))
        for k, length in enumerate(chain):
            rows[k, :, k], rows[k, :, k + 1] = length * first, length * second
        weight = np.ones(len(chain))
        weight[[0, -1]] = math.sqrt(OUTERMOST)
        matrix = (weight[:, None, None] * rows).reshape(-1, len(chain) + 1)[:, 1:-1]
        right = -(weight[:, None] * apart[start:stop]).ravel()
        joints = np.zeros(len(chain) + 1)
        if len(chain) > 1:
            joints[1:-1] = np.linalg.lstsq(matrix, right, rcond=None)[0]
        # Bands of cosines up to 0.6: a condition of ten, times that of the lengths squared.
        scale = max(1.0, float(np.max(np.abs(joints))))
        assert turns[0, start:stop] == pytest.approx(joints[:-1], abs=1e-9 * scale)
        assert turns[1, start:stop] == pytest.approx(joints[1:], abs=1e-9 * scale)
        start = stop


SHARE = 1.01
MANY = 100_000


def stretched(curve: WorkingCurve) -> ChordStretch:
    """A whole curve without corners."""

    def place(phi: FloatArray) -> tuple[ComplexArray, ComplexArray]:
        return curve.point(phi), curve.tangent(phi)

    return ChordStretch(
        stretch_table(curve, 0.0, TURN), place, curve.point, curve.pitch.rotation, closed=True
    )


def straight(length: float) -> ChordStretch:
    """A straight line from 10 mm on, aslant; t is the share of its `length` [mm]."""
    along = (2.0 + 1.0j) / abs(2.0 + 1.0j)
    grid, none = np.linspace(0.0, 1.0, 101), np.zeros(100)
    table = StretchTable(grid, none, none, np.full(100, 0.01 * length), (), np.zeros(1))

    def points(t: FloatArray) -> ComplexArray:
        return np.asarray(10.0 + length * along * t, dtype=np.complex128)

    def place(t: FloatArray) -> tuple[ComplexArray, ComplexArray]:
        return points(t), np.full(len(t), along)

    return ChordStretch(table, place, points, 1, closed=False)


@pytest.mark.parametrize("most", [0.1, 1e-2])
def test_a_layout_does_not_depend_on_the_tolerance(most: float) -> None:
    """A flank without inflections: as many pieces are the same pieces, whatever was asked."""
    ladder = Ladder.from_stretch(stretched(flank("vorschub", -1)))
    laid: dict[int, ComplexArray] = {}
    for tolerance in np.geomspace(most, 0.9 * most, 12):
        chords, found = ladder.fewest(float(tolerance), SHARE, MANY)
        assert found <= tolerance
        same = laid.setdefault(len(chords.worst), chords.vertices)
        assert np.array_equal(same, chords.vertices)
    assert 1 < len(laid) < 12


def test_layouts_that_do_not_help_are_few(monkeypatch: pytest.MonkeyPatch) -> None:
    laid: list[int] = []
    plain = ladder_module.place_equal_error

    def off(*arguments: Any) -> EqualErrorPieces:
        found = plain(*arguments)
        laid.append(len(found.chords.worst))
        return replace(found, chords=replace(found.chords, worst=10.0 * found.chords.worst))

    monkeypatch.setattr(ladder_module, "place_equal_error", off)
    monkeypatch.setattr(ladder_module, "LAID", 1_000)
    with pytest.raises(ToleranceError):
        Ladder.from_stretch(stretched(flank("vorschub", -1))).fewest(1e-3, SHARE, MANY)
    assert 1 < len(laid) < ladder_module.LAYOUTS
    assert sum(laid[:-1]) <= 1_000


@pytest.mark.parametrize("length", [1e-3, 5.0, 1e4])
def test_a_straight_stretch_is_one_piece(length: float) -> None:
    stretch = straight(length)
    chords, found = Ladder.from_stretch(stretch).fewest(1e-3, SHARE, MANY)
    assert len(chords.worst) == 1
    assert np.array_equal(chords.vertices, stretch.points(np.array([0.0, 1.0])))
    assert found <= 1e-14 * (10.0 + length)


def test_too_many_are_refused() -> None:
    ladder = Ladder.from_stretch(stretched(flank("setzhub", -1)))
    with pytest.raises(ToleranceError, match="more than 100 straight pieces"):
        ladder.fewest(1e-3, SHARE, 100)
