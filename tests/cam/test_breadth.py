"""The width of a disc between the two sides of a yoke, and the second side."""

from __future__ import annotations

import math
from decimal import Decimal

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from camgeo.cam.cam import ROUNDING, Breadth, Cam, Drive, Yoke
from camgeo.errors import GeometryError
from camgeo.geometry.pitch_curve import PitchCurve
from camgeo.kinematics.laws import make_law
from camgeo.kinematics.mechanism.translating_flat import TranslatingFlat
from camgeo.kinematics.mechanism.translating_roller import TranslatingRoller
from camgeo.kinematics.plan import Dwell, MotionPlan, Move
from camgeo.units import TURN
from tests.strategies import SMOOTH, attack, plans, signs

LAW = make_law("polynomial-345")

TRAPEZOID = make_law("modified-trapezoid", inflection=0.4)

UNEVEN = MotionPlan(
    (
        Dwell(Decimal(35)),
        Move(Decimal(105), 16.0, TRAPEZOID),
        Dwell(Decimal(50)),
        Move(Decimal(170), 0.0, LAW),
    )
)


def even(lift: float) -> MotionPlan:
    """The second half of the turn undoes the first."""
    return MotionPlan((Move(Decimal(180), lift, LAW), Move(Decimal(180), 0.0, LAW)))


def test_the_width_is_that_of_both_sides_with_its_derivative_and_its_breaks() -> None:
    phi = np.linspace(0.01, TURN + 0.01, 100)
    h = 1e-5
    for reach in (1, -1):
        breadth = Breadth(UNEVEN, 40.0, reach)
        here, there = (UNEVEN.jet(angles)[0] for angles in (phi, phi + math.pi))
        wanted = (40.0 + reach * here) + (40.0 + reach * there)
        assert breadth.width(phi) == pytest.approx(wanted, rel=1e-14)
        rise = (breadth.width(phi + h) - breadth.width(phi - h)) / (2.0 * h)
        assert breadth.slope(phi) == pytest.approx(rise, abs=1e-8)
    starts = np.cumsum([0.0, 35.0, 105.0, 50.0])
    law_jumps = [35.0 + 105.0 * each for each in TRAPEZOID.borders]
    both = {each % 360.0 for start in (*starts, *law_jumps) for each in (start, start + 180.0)}
    found = np.degrees(breadth.breaks)
    assert np.all(np.diff(found) > 0.0)
    assert set(np.round(found, 9)) <= {round(each, 9) for each in both}
    assert set(np.round(found, 9)) >= {
        round(each, 9) for start in starts for each in (start, (start + 180.0) % 360.0)
    }
    assert len(breadth.dwells) == 0


def test_at_a_shock_the_slope_has_two_sides() -> None:
    straight = make_law("straight-line")
    plan = MotionPlan((Move(Decimal(120), 12.0, straight), Move(Decimal(240), 0.0, straight)))
    breadth = Breadth(plan, 30.0, -1)
    rise, fall = 12.0 / math.radians(120.0), -12.0 / math.radians(240.0)
    at = np.radians([120.0, 300.0])  # the peak, and half a turn on
    assert breadth.slope(at) == pytest.approx(2 * [-(fall + fall)], rel=1e-12)
    assert breadth.slope(at, "left") == pytest.approx(2 * [-(rise + fall)], rel=1e-12)
    assert np.degrees(breadth.breaks) == pytest.approx([0.0, 120.0, 180.0, 300.0], abs=1e-12)


@attack
@given(plan=plans(SMOOTH, 20.0), reach=signs())
def test_range_and_what_follows_from_it_are_those_of_dense_samples(
    plan: MotionPlan, reach: int
) -> None:
    breadth = Breadth(plan, 50.0, reach)
    dense = breadth.width(np.linspace(0.0, TURN, 3601))
    (least, at_least), (most, at_most) = breadth.range
    # Between two samples a parabola rises by an eighth of the square of the step.
    slack = 0.2 * (TURN / 3600) ** 2 * 20.0 * 1000.0
    assert dense.min() - slack <= least <= dense.min() + 1e-12
    assert dense.max() - 1e-12 <= most <= dense.max() + slack
    there = breadth.width(np.array([at_least, at_most]))
    assert there == pytest.approx([least, most], rel=1e-13)
    assert breadth.best == pytest.approx(0.5 * (least + most), rel=1e-15)
    assert breadth.variation == pytest.approx(most - least, abs=1e-12 * most)
    assert breadth.play(most) == 0.0
    for apart in (0.5, -0.5, 1e-3, -1e-3):
        assert breadth.play(most + apart) == pytest.approx(apart, abs=1e-12)


def test_widths_that_differ_by_rounding_are_equal_and_a_little_more_is_not() -> None:
    for lift in (20.0, 7.3):
        breadth = Breadth(even(lift), 40.0, 1)
        assert breadth.variation == 0.0
        assert breadth.best == pytest.approx(80.0 + lift, rel=1e-15)
        most = breadth.range[1][0]
        for size in (0.9, -0.9):
            assert breadth.play(most * (1.0 + size * ROUNDING)) == 0.0
        for size in (1.1, -1.1):
            assert breadth.play(most * (1.0 + size * ROUNDING)) != 0.0
    # From a width of 80 + 7 at the start of the turn to one of 80 + 7 + more after a quarter of it.
    for share in (0.9, 1.1, -0.9, -1.1):
        more = share * ROUNDING * 87.0
        ends = (3.5, 7.0, 3.5 + more, 0.0)
        breadth = Breadth(MotionPlan(tuple(Move(Decimal(90), to, LAW) for to in ends)), 40.0, 1)
        wanted = abs(more) if abs(share) > 1.0 else 0.0
        assert breadth.variation == pytest.approx(wanted, rel=1e-2)


@pytest.mark.parametrize("angle", [0.4, 0.0, -0.4, math.pi, -math.pi])
@pytest.mark.parametrize("direction", [1, -1])
@pytest.mark.parametrize("kind", ["roller", "face"])
def test_both_sides_of_the_yoke_are_its_breadth_apart_at_every_cam_angle(
    angle: float, direction: int, kind: str
) -> None:
    """On an even motion the second side, a follower with the same lift, touches the same disc."""
    plan, lift = even(14.0), np.linspace(0.0, TURN, 50)
    first: TranslatingRoller | TranslatingFlat
    if kind == "roller":
        first = TranslatingRoller(45.0, 6.0, 0.0, angle, direction)
    else:
        first = TranslatingFlat(45.0, angle, direction)
    breadth = Breadth(plan, first.base_radius, first.reach)
    second = breadth.opposite(first)
    assert isinstance(second, type(first))
    assert -math.pi <= second.guide_angle <= math.pi
    assert abs(second.guide_angle - first.guide_angle) == pytest.approx(math.pi)
    assert second.direction == -direction
    assert breadth.best == pytest.approx(90.0 + direction * 14.0, rel=1e-14)
    assert first.base_radius + second.base_radius == pytest.approx(breadth.best, rel=1e-14)
    for rotation in (1, -1):
        one, other = (PitchCurve(plan, each, rotation) for each in (first, second))
        way = np.exp(1j * (angle - rotation * lift))
        heights = [(np.conj(way) * each.point(lift)).real for each in (one, other)]
        assert heights[0] - heights[1] == pytest.approx(breadth.best, rel=1e-12)
        # The same disc: what the second side touches, the first touched half a turn before.
        assert other.point(lift) == pytest.approx(one.point(lift + math.pi), abs=1e-11)


def test_a_yoke_without_room_for_its_second_side_is_refused() -> None:
    """Inward the second side is at h - lift: 0 is no place for it, a hair more is."""
    for lift in (40.0, 41.0):
        breadth = Breadth(even(lift), 40.0, -1)
        with pytest.raises(GeometryError, match="leaves no room for the second side") as caught:
            breadth.opposite(TranslatingRoller(40.0, 5.0, direction=-1))
        assert caught.value.key == "follower.yoke"
    least = Breadth(even(39.999), 40.0, -1).opposite(TranslatingRoller(40.0, 5.0, direction=-1))
    assert least.base_radius == pytest.approx(1e-3, abs=1e-12)


@pytest.mark.parametrize("value", [0.0, -3.0, math.nan, True, "66"])
def test_a_breadth_that_is_no_length_is_refused(value: float) -> None:
    with pytest.raises(GeometryError, match=r"above 0 \(mm\)") as caught:
        Yoke(value)
    assert caught.value.key == "follower.yoke.breadth"


@given(breadth=st.floats(60.0, 120.0))
def test_the_breadth_of_a_cams_yoke_is_the_stated_or_the_best(breadth: float) -> None:
    drive, follower = Drive(UNEVEN), TranslatingRoller(45.0, 6.0)
    alone = Cam(drive, follower)
    assert alone.breadth is None
    assert alone.opposite is None
    assert alone.yoke_breadth == 0.0
    free, stated = (Cam(drive, follower, yoke=Yoke(each)) for each in (None, breadth))
    assert stated.yoke_breadth == breadth
    assert free.breadth == Breadth(UNEVEN, 45.0, 1.0)
    assert free.breadth is not None
    assert free.yoke_breadth == free.breadth.best == pytest.approx(98.0, abs=16.0)
    assert free.opposite is not None
    assert free.opposite.follower == free.breadth.opposite(follower)
    assert free.opposite.drive is drive
