"""The pitch curve: its curvature, its angles, its joints, and the leverage of a normal force, whose
work is that of the follower; its parallels; its smooth pieces, cells, bounds and extremes."""

from __future__ import annotations

import itertools
import math
from decimal import Decimal
from typing import Any

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from camgeo.check.disc import least_speed
from camgeo.errors import GeometryError
from camgeo.geometry import pieces
from camgeo.geometry.pieces import (
    Extremes,
    curvature_extremes,
    extremes,
    halves,
    smooth_pieces,
    turn_cells,
)
from camgeo.geometry.pitch_curve import BLOCK, PitchCurve, WorkingCurve, in_blocks, joints
from camgeo.kinematics.laws import make_law
from camgeo.kinematics.laws.law import Law
from camgeo.kinematics.mechanism.rollers import OscillatingRoller, TranslatingRoller
from camgeo.kinematics.plan import Dwell, MotionPlan, Move
from camgeo.numeric.arrays import SIDES, ComplexArray, FloatArray, Quantity, Side
from camgeo.units import TURN
from tests.integrals import cells, integrals
from tests.laws import LAWS
from tests.reference import POLYNOMIAL, hard_case, inner_of, mechanisms, outer_of, pitch_curve_of
from tests.strategies import BENT, SMOOTH, attack, pitch_curves, plans, wild_pitch_curves

QUADRATURE = 1e-9
"""What the rule of 24 points leaves of a sharp bend, for curves whose speed changes by 1 to 5."""


def steady(curve: PitchCurve) -> bool:
    """True if the rule of 24 points can follow: |Z'| stays off 0."""
    speed = np.abs(curve.jet(np.linspace(0.0, TURN, 721))[1])
    return bool(np.min(speed) > 0.2 * np.max(speed))


@attack
@given(curve=pitch_curves(BENT))
def test_curvature_is_the_turning_of_the_tangent(curve: PitchCurve) -> None:
    """Positive where convex: a convex curve run through clockwise, for sigma = +1, turns so."""
    assume(steady(curve))
    low, high = cells(curve.borders, 12)
    found = integrals(lambda phi: curve.curvature(phi) * np.abs(curve.jet(phi)[1]), low, high)
    ahead, behind = curve.jet(high, "left")[1], curve.jet(low, "right")[1]
    turned = -curve.rotation * np.angle(ahead / behind)
    assert np.max(np.abs(found - turned)) <= QUADRATURE * np.max(np.abs(found))


@attack
@given(curve=pitch_curves(BENT))
def test_the_slope_of_the_curvature_is_its_derivative(curve: PitchCurve) -> None:
    assume(steady(curve))
    low, high = cells(curve.borders, 12)
    found = integrals(curve.curvature_slope, low, high)
    change = curve.curvature(high, "left") - curve.curvature(low, "right")
    scale = np.max(np.abs(curve.curvature(np.linspace(0.0, TURN, 721))))
    assert np.max(np.abs(found - change)) <= QUADRATURE * scale


RIGHT = Decimal(90)


SPAN = math.radians(90.0)


def curve_with(law: Law) -> PitchCurve:
    plan = MotionPlan((Dwell(RIGHT), Move(RIGHT, 10.0, law), Dwell(RIGHT), Move(RIGHT, 0.0, law)))
    return PitchCurve(plan, TranslatingRoller(40.0, 5.0), 1)


@attack
@given(curve=pitch_curves(SMOOTH))
def test_smooth_laws_close_point_and_tangent(curve: PitchCurve) -> None:
    join = joints(curve)
    size = np.max(np.abs(curve.point(join.phi)))
    assert 0.0 in join.phi
    assert set(curve.breaks.tolist()) <= set(join.phi.tolist())
    assert np.max(join.gaps) <= 1e-14 * size
    # u and v of |Z'| may both be small: its direction is right to the lengths in it.
    assert np.max(join.turns) <= 1e-13 * size / np.min(np.abs(curve.jet(join.phi)[1]))


def test_a_straight_line_turns_the_tangent_by_the_angle_of_its_speed() -> None:
    join = joints(curve_with(make_law("straight-line")))
    speed = 10.0 / SPAN
    start = int(np.argmin(np.abs(join.phi - SPAN)))
    assert join.turns[start] == pytest.approx(math.atan2(speed, 40.0), rel=1e-12)
    assert np.max(join.gaps) <= 1e-13


EPS = float(np.finfo(np.float64).eps)


STEP = 1e-4
"""Step of the lift [mm or rad], for central differences."""


def turned(curve: PitchCurve, phi: FloatArray, along: ComplexArray) -> ComplexArray:
    """`along` (n,) of the cam, in the fixed frame."""
    there: ComplexArray = along * np.exp(1j * curve.rotation * phi)
    return there


def outward(curve: PitchCurve, phi: FloatArray) -> ComplexArray:
    """(n,) outward normals of the pitch curve in the fixed frame.

    For a cam that turns counter-clockwise the curve is run through clockwise: outside is to the
    left of its tangent.
    """
    tangent = curve.jet(phi)[1]
    return turned(curve, phi, 1j * curve.rotation * tangent / np.abs(tangent))


def centres(curve: PitchCurve, lift: FloatArray) -> ComplexArray:
    """(n,) roller centres in the fixed frame, the cam axis the origin."""
    jet = np.zeros((2, len(lift)))
    jet[0] = lift
    relative = curve.follower.relative_jet(jet, curve.rotation, 1)
    centre: ComplexArray = relative.along[0] + 1j * relative.across[0]
    centre *= np.exp(1j * relative.axis)
    return centre


def angles(curve: PitchCurve) -> FloatArray:
    """Some in each piece, rests among them, away from standstills of the roller in the cam."""
    phi, _ = cells(curve.borders, 7)
    phi = np.mod(phi + 1e-3, TURN)
    moving: FloatArray = phi[np.abs(curve.jet(phi)[1]) > 0.1]
    return moving


@attack
@given(curve=pitch_curves(BENT))
def test_it_is_the_way_along_the_normal_for_a_small_lift(curve: PitchCurve) -> None:
    """The cam stands, the follower is moved by hand."""
    phi = angles(curve)
    assume(len(phi))
    lift = curve.motion.jet(phi)[0]
    way = (centres(curve, lift + STEP) - centres(curve, lift - STEP)) / (2.0 * STEP)
    found = np.real(np.conj(outward(curve, phi)) * way)
    # A circle of the arm's radius leaves arm step^2/6 of the difference, a straight line nothing;
    # places up to 300 mm are rounded a few times, and the normal where |Z'| is small.
    arm = abs(curve.follower.reach)
    curved = arm * STEP**2 / 6.0 if isinstance(curve.follower, OscillatingRoller) else 0.0
    places = np.abs(centres(curve, lift))
    rounding = 16.0 * EPS * (places + arm + 200.0) / STEP
    normal = 64.0 * EPS * (places + 200.0) * (arm + 1.0) / np.abs(curve.jet(phi)[1])
    assert np.all(np.abs(curve.leverage(phi) - found) <= curved + rounding + normal)


@attack
@given(curve=pitch_curves(BENT))
def test_its_size_is_the_sine_of_the_transmission_angle(curve: PitchCurve) -> None:
    phi = angles(curve)
    assume(len(phi))
    arm = curve.follower.arm if isinstance(curve.follower, OscillatingRoller) else 1.0
    expected = arm * np.sin(curve.transmission_angle(phi))
    # u, its square and its root; atan2 and the sine: a few roundings each.
    assert np.abs(curve.leverage(phi)) == pytest.approx(expected, rel=8.0 * EPS, abs=1e-300)


@pytest.mark.parametrize("cells", [False, True])
@pytest.mark.parametrize("count", [0, 1, BLOCK - 1, BLOCK, BLOCK + 1, 2 * BLOCK, 3 * BLOCK + 7])
def test_blocks_cover_all_points_or_cells_once_in_order(count: int, cells: bool) -> None:
    sizes = []

    @in_blocks
    def function(_: None, x: FloatArray, other: Any) -> FloatArray:
        sizes.append(len(x))
        return np.stack((x, other if cells else (2.0 if other == "left" else np.nan) * x))

    x = np.arange(float(count))
    found = function(None, x, x + 0.5 if cells else "left")
    assert np.array_equal(found, np.stack((x, x + 0.5 if cells else 2.0 * x)))
    assert max(sizes) <= BLOCK
    assert sum(sizes) == count


def test_a_point_has_the_same_value_in_any_array() -> None:
    curve = pitch_curve_of(mechanisms()["T6_setzhub_sm_program"]["params"])
    phi = np.linspace(0.0, TURN, 2 * BLOCK + 11)
    some = slice(BLOCK - 3, BLOCK + 3)
    assert np.array_equal(curve.jet(phi)[:, some], curve.jet(phi[some]))
    assert np.array_equal(curve.curvature(phi)[some], curve.curvature(phi[some]))
    inner = inner_of(curve)
    assert np.array_equal(inner.point(phi)[some], inner.point(phi[some]))


PHI = np.linspace(0.0, TURN, 145)


by_name = pytest.mark.parametrize("name", mechanisms())
"""Cams without undercut, all of them, on either flank."""


@attack
@given(curve=pitch_curves(), distance=st.floats(-12.0, 12.0))
def test_an_offset_lies_square_to_the_pitch_curve(curve: PitchCurve, distance: float) -> None:
    z, z1 = curve.jet(PHI)[:2]
    normal = (WorkingCurve(curve, distance).point(PHI) - z) * np.conj(z1) / np.abs(z1)
    limit = 1e-14 * np.max(np.abs(z)) * np.max(np.abs(z1)) / np.min(np.abs(z1))
    # Run through clockwise for sigma = +1, a curve has its outside on the left.
    assert np.max(np.abs(normal - 1j * curve.rotation * distance)) <= limit


@attack
@given(curve=pitch_curves(SMOOTH), distance=st.floats(-8.0, 8.0))
def test_points_run_along_the_tangent_at_the_pace(curve: PitchCurve, distance: float) -> None:
    offset = WorkingCurve(curve, distance)
    low, high = cells(curve.borders, 12)
    speed = np.abs(curve.jet(PHI)[1])
    assume(np.min(speed) > 0.2 * np.max(speed))  # else 24 points do not follow it
    found = integrals(lambda phi: offset.tangent(phi) * offset.traced(phi)[2], low, high)
    change = offset.point(high, "left") - offset.point(low, "right")
    assert np.max(np.abs(found - change)) <= 1e-9 * np.max(np.abs(offset.point(PHI)))
    assert np.abs(offset.tangent(PHI)) == pytest.approx(np.ones(len(PHI)), rel=1e-14)


@attack
@given(curve=pitch_curves(SMOOTH), distance=st.floats(-8.0, 8.0))
def test_an_offset_turns_as_the_pitch_curve_does(curve: PitchCurve, distance: float) -> None:
    """kappa_d ds_d = kappa ds, and r_K of the offset is r_K + d."""
    offset = WorkingCurve(curve, distance)
    regular = offset.regularity(PHI)
    assume(np.min(np.abs(regular)) > 1e-3)
    kappa, speed = curve.curvature(PHI), np.abs(curve.jet(PHI)[1])
    assert regular == pytest.approx(1.0 + distance * kappa, rel=1e-15)
    turning = offset.curvature(PHI) * offset.traced(PHI)[2]
    assert turning == pytest.approx(kappa * speed, rel=1e-13)
    curved = np.abs(kappa) > 1e-4
    radius = 1.0 / offset.curvature(PHI)[curved]
    # A radius of at most 1e4 mm, and d added to it.
    assert radius == pytest.approx(1.0 / kappa[curved] + distance, rel=1e-13, abs=2e-12)


@by_name
def test_traced_is_point_tangent_and_pace(name: str) -> None:
    curve = pitch_curve_of(mechanisms()[name]["params"])
    for flank in (inner_of(curve), WorkingCurve(curve, 0.0), outer_of(curve)):
        for side in SIDES:
            points, tangents, pace = flank.traced(PHI, side)
            # The same sums in another order: some ulps of 100 mm, and of 1.
            assert np.max(np.abs(points - flank.point(PHI, side))) <= 1e-12
            assert np.max(np.abs(tangents - flank.tangent(PHI, side))) <= 1e-14
            assert pace == pytest.approx(
                np.abs(curve.jet(PHI, side)[1]) * flank.regularity(PHI, side), rel=1e-13, abs=1e-12
            )


@attack
@given(plan=plans())
def test_pieces_fill_one_turn_from_break_to_break(plan: MotionPlan) -> None:
    found = smooth_pieces(plan)
    assert sum(piece.end - piece.start for piece in found) == pytest.approx(TURN, rel=1e-15)
    for before, after in itertools.pairwise(found):
        assert before.end == after.start
    if plan.breaks.size:
        assert [piece.start for piece in found] == plan.breaks.tolist()


@attack
@given(plan=plans())
def test_rests_are_pieces_and_moves_are_not_rests(plan: MotionPlan) -> None:
    resting = [piece for piece in smooth_pieces(plan) if piece.dwell]
    dwells = sorted(plan.dwells, key=lambda dwell: dwell.start)
    assert [piece.start for piece in resting] == [dwell.start for dwell in dwells]
    spans = [piece.end - piece.start for piece in resting]
    assert spans == pytest.approx([dwell.span for dwell in dwells], rel=1e-14)


def test_a_rest_of_the_whole_turn() -> None:
    (piece,) = smooth_pieces(MotionPlan((Dwell(Decimal(360)),)))
    assert (piece.start, piece.end, piece.dwell) == (0.0, TURN, True)


def test_the_last_piece_may_reach_across_cam_angle_0() -> None:
    quarter = Decimal(90)
    plan = MotionPlan(
        (
            Dwell(quarter),
            Move(quarter, 5.0, POLYNOMIAL),
            Move(quarter, 0.0, POLYNOMIAL),
            Dwell(quarter),
        )
    )
    last = smooth_pieces(plan)[-1]
    assert last.dwell
    assert (last.start, last.end) == pytest.approx((0.75 * TURN, 1.25 * TURN), rel=1e-15)


def test_as_many_cells_are_halved_as_may_be_and_no_more(monkeypatch: pytest.MonkeyPatch) -> None:
    low, high = np.arange(7.0), np.arange(7.0) + 1.0
    which = np.array([True, False, True, True, True, False, True])
    monkeypatch.setattr(pieces, "MOST", 5)
    lows, highs = halves(low, high, which)
    assert sorted(zip(lows.tolist(), highs.tolist(), strict=True)) == [
        (k + part, k + part + 0.5) for k in (0, 2, 3, 4, 6) for part in (0.0, 0.5)
    ]
    monkeypatch.setattr(pieces, "MOST", 4)
    with pytest.raises(GeometryError, match="stays too close to a limit along a stretch"):
        halves(low, high, which)


@attack
@given(pitch=wild_pitch_curves())
def test_cells_of_a_turn_end_at_all_borders_and_bound_the_speed(pitch: PitchCurve) -> None:
    low, high = turn_cells(pitch)
    assert (low[0], high[-1]) == (0.0, TURN)
    assert np.array_equal(low[1:], high[:-1])
    assert np.all(np.isin(pitch.borders, low))
    assert np.max(high - low) <= np.pi / 32.0 + 1e-15
    assert least_speed(pitch) <= np.min(np.abs(pitch.jet(np.linspace(0.0, TURN, 2001))[1]))


def test_the_bound_is_no_bound_at_a_standstill() -> None:
    assert least_speed(pitch_curve_of(hard_case("HC18")[0])) <= 0.0


def test_of_a_circle_the_bound_is_near_its_radius() -> None:
    """Over a half cell h = pi/64 a point of a circle of radius 40 changes Z' by 40 (h + h^2/2)."""
    pitch = PitchCurve(MotionPlan((Dwell(Decimal(360)),)), TranslatingRoller(40.0, 5.0), 1)
    h = np.pi / 64.0
    assert least_speed(pitch) == pytest.approx(40.0 * (1.0 - h - 0.5 * h * h), rel=1e-12)


STEPS = np.concatenate(
    (np.logspace(-7, -2, 26), np.linspace(0.02, 0.98, 49), 1.0 - np.logspace(-2, -7, 26))
)
"""Shares of a stretch at which it is sampled, denser at its ends."""


def samples(found: Extremes) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Cam angles (k, m) in each stretch between neighbouring entries, and its end values (k, 1)."""
    wide = np.flatnonzero(np.diff(found.phi) > 1e-6)
    start, end = found.phi[wide, np.newaxis], found.phi[wide + 1, np.newaxis]
    ends = np.stack((found.values[wide], found.values[wide + 1]))
    low, high = np.min(ends, axis=0), np.max(ends, axis=0)
    return start + STEPS * (end - start), low[:, np.newaxis], high[:, np.newaxis]


@attack
@given(curve=pitch_curves(BENT))
def test_curvature_is_monotone_between_neighbouring_extremes(curve: PitchCurve) -> None:
    found = curvature_extremes(curve)
    phi, low, high = samples(found)
    values = curve.curvature(phi.ravel()).reshape(phi.shape)
    limit = 1e-12 * np.max(np.abs(found.values))
    assert np.all(values >= low - limit)
    assert np.all(values <= high + limit)


def test_an_extreme_next_to_a_break_is_found() -> None:
    """Nearer to the end of its piece than the first point of the grid."""
    sixth = Decimal(60)
    law = LAWS["polynomial-345"]
    plan = MotionPlan((Move(sixth, 1.0, law), Dwell(Decimal(240)), Move(sixth, 0.0, law)))
    top = 1e-4

    def value(phi: FloatArray, side: Side) -> FloatArray:
        return np.asarray(-((phi - top) ** 2))

    def slope(phi: FloatArray, side: Side) -> FloatArray:
        return np.asarray(-2.0 * (phi - top))

    assert plan.breaks[1] / 256.0 > top
    assert extremes(plan, value, slope).largest()[1] == pytest.approx(top, rel=1e-12)


def test_slopes_of_several_quantities_are_searched_together() -> None:
    half = Decimal(180)
    law = LAWS["modified-sine"]
    plan = MotionPlan((Move(half, 6.0, law), Move(half, 0.0, law)))

    def rows(which: int | slice) -> Quantity:
        return lambda phi, side: np.asarray(plan.jet(phi, side)[which])

    both = extremes(plan, rows(1), rows(slice(2, 4)))
    apart = [extremes(plan, rows(1), rows(order)) for order in (2, 3)]
    assert set(both.phi) == {*apart[0].phi, *apart[1].phi}


def test_entries_run_over_one_turn_with_both_sides_of_each_break() -> None:
    half = Decimal(180)
    law = LAWS["quadratic-parabola"]
    plan = MotionPlan((Move(half, 6.0, law), Move(half, 0.0, law)))

    def acceleration(phi: FloatArray, side: Side) -> FloatArray:
        return np.asarray(plan.jet(phi, side)[2])

    def jerk(phi: FloatArray, side: Side) -> FloatArray:
        return np.asarray(plan.jet(phi, side)[3])

    found = extremes(plan, acceleration, jerk)
    assert found.phi == pytest.approx(
        np.radians([0.0, 90.0, 90.0, 180.0, 180.0, 270.0, 270.0, 360.0]), rel=1e-15
    )
    assert np.sign(found.values).tolist() == [1, 1, -1, -1, -1, -1, 1, 1]
    assert found.smallest()[1] == pytest.approx(0.5 * math.pi, rel=1e-15)
    assert found.largest()[1] == 0.0
    assert not found.values.flags.writeable
