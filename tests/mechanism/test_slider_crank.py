from __future__ import annotations

import math
from dataclasses import replace
from decimal import Decimal
from typing import Any

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from mpmath import mp, mpf

from camgeo.errors import GeometryError
from camgeo.kinematics.laws import make_law
from camgeo.kinematics.mechanism.linkage import locked_at
from camgeo.kinematics.mechanism.linked_motion import LinkedMotion
from camgeo.kinematics.mechanism.slider_crank import SliderCrank
from camgeo.kinematics.plan import Dwell, MotionPlan, Move
from camgeo.numeric.arrays import ComplexArray, FloatArray
from camgeo.units import TURN
from tests.integrals import cells, integrals
from tests.mechanism.bounds import assert_bounds_are_close, assert_bounds_hold
from tests.strategies import SMOOTH, attack, plans, slider_cranks

STROKE = 8.0  # of the linkages drawn
STROKES = np.linspace(0.0, STROKE, 33)

ROUNDING = 1e-12
"""As a share of the largest value. Linkages keep 2 mm from closing, so that sin(v - theta), by
which up to five times is divided, is 0.1 at least and rounds to 1e-14 at worst."""


def pin_and_tip(linkage: SliderCrank, stroke: FloatArray) -> tuple[ComplexArray, ComplexArray]:
    x = linkage.start_position + linkage.stroke_direction * stroke
    pin = -x + 1j * linkage.guide_height
    return np.asarray(pin), linkage.crank * np.exp(1j * linkage.crank_angle(stroke))


@attack
@given(linkage=slider_cranks())
def test_the_coupler_keeps_its_length(linkage: SliderCrank) -> None:
    pin, tip = pin_and_tip(linkage, STROKES)
    assert np.abs(pin - tip) == pytest.approx(np.full(33, linkage.coupler), rel=1e-13)


@attack
@given(linkage=slider_cranks())
def test_the_branch_is_the_side_of_the_tip(linkage: SliderCrank) -> None:
    """+1: the crank tip lies clockwise of the pin seen from the rocker shaft."""
    pin, tip = pin_and_tip(linkage, STROKES)
    assert np.all(np.sign(np.imag(np.conj(pin) * tip)) == -linkage.branch)


@attack
@given(linkage=slider_cranks(), stroke=st.floats(0.0, STROKE))
def test_newton_on_the_closed_loop_finds_the_same_rocker(
    linkage: SliderCrank, stroke: float
) -> None:
    """|P - l_sk e^{i theta}| = l_4 solved at 40 digits from the angle found, with derivatives by
    differences of the solution."""
    (start,) = linkage.crank_angle(np.array([stroke]))
    with mp.workdps(40):
        height = mpf(linkage.crank) * mp.cos(mpf(linkage.deflection))

        def solved(s: Any) -> Any:
            x = mpf(linkage.start_position) + linkage.stroke_direction * s
            theta = mpf(float(start))
            for _ in range(6):
                dx = -x - linkage.crank * mp.cos(theta)
                dy = height - linkage.crank * mp.sin(theta)
                gap = dx**2 + dy**2 - mpf(linkage.coupler) ** 2
                slope = 2 * linkage.crank * (dx * mp.sin(theta) - dy * mp.cos(theta))
                theta -= gap / slope
            return theta

        theta = solved(mpf(stroke))
        step = mpf(10) ** -10
        ahead, behind = solved(mpf(stroke) + step), solved(mpf(stroke) - step)
        slope = float((ahead - behind) / (2 * step))
        bend = float((ahead - 2 * theta + behind) / step**2)
        assert float(theta) == pytest.approx(float(start), abs=2e-14)
    jet = np.array([[stroke], [1.0], [0.0], [0.0]])
    sense = -1.0 if linkage.mirrored else 1.0
    found = sense * linkage.transform(jet)[:, 0]
    assert found[1] == pytest.approx(slope, rel=ROUNDING, abs=ROUNDING / linkage.crank)
    assert found[2] == pytest.approx(bend, rel=ROUNDING, abs=ROUNDING / linkage.crank)


@attack
@given(linkage=slider_cranks(), plan=plans(SMOOTH, STROKE))
def test_each_derivative_is_the_derivative_of_the_one_before(
    linkage: SliderCrank, plan: MotionPlan
) -> None:
    motion = LinkedMotion(plan, linkage)
    low, high = cells(plan.borders, 6)
    change = motion.jet(high, "left")[:3] - motion.jet(low, "right")[:3]
    found = integrals(lambda phi: motion.jet(phi)[1:], low, high)
    sizes = np.max(np.abs(motion.jet(np.linspace(0.0, TURN, 241))), axis=1)[:3, np.newaxis]
    assert np.all(np.abs(found - change) <= ROUNDING * np.maximum(sizes, 0.01))


@attack
@given(linkage=slider_cranks())
def test_mirrored_turns_the_rocker_the_other_way(linkage: SliderCrank) -> None:
    jet = np.stack((STROKES, np.ones(33), -2.0 * np.ones(33), 3.0 * np.ones(33)))
    other = replace(linkage, mirrored=not linkage.mirrored)
    assert np.array_equal(linkage.transform(jet), -other.transform(jet))


@attack
@given(linkage=slider_cranks())
def test_the_swing_starts_at_zero_without_jumps(linkage: SliderCrank) -> None:
    fine = np.linspace(0.0, STROKE, 400)
    jet = np.zeros((4, 400))
    jet[0] = fine
    swing = linkage.transform(jet)[0]
    assert swing[0] == 0.0
    assert np.all((swing > -math.pi) & (swing <= math.pi))
    # 0.02 mm a step, by a lever of crank times sin(v - theta), 30 mm times 0.1.
    assert np.max(np.abs(np.diff(swing))) < 0.02 / 3.0 * 2.0


@attack
@given(linkage=slider_cranks(), plan=plans(SMOOTH, STROKE), count=st.integers(1, 6))
def test_bounds_hold_all_over_their_cells(
    linkage: SliderCrank, plan: MotionPlan, count: int
) -> None:
    motion = LinkedMotion(plan, linkage)
    assert_bounds_hold(motion, count, ROUNDING, 0.01)


@attack
@given(linkage=slider_cranks(), plan=plans(SMOOTH, STROKE))
def test_bounds_are_finite_on_small_cells_and_close_on_the_swing(
    linkage: SliderCrank, plan: MotionPlan
) -> None:
    motion = LinkedMotion(plan, linkage)
    coarse, fine = (
        float(np.max(motion.jet_and_bounds(*cells(plan.borders, count))[1][0]))
        for count in (64, 128)
    )
    assert math.isfinite(coarse)
    assert fine <= 0.7 * coarse + 1e-15


def test_bounds_are_close_next_to_a_dead_centre() -> None:
    linkage = SliderCrank(40.0, 60.0, math.radians(30.0), True, 1, 1, 1)
    low, high = sorted(linkage.dead_strokes)
    assert_bounds_are_close(linkage, high, -1, 2.0)
    assert_bounds_are_close(linkage, low, 1, 2.0)


def test_a_cell_that_may_reach_a_dead_centre_has_no_bound() -> None:
    linkage = SliderCrank(40.0, 60.0, math.radians(30.0), True, 1, 1, 1)
    full = linkage.crank + linkage.coupler
    reach = math.sqrt(full**2 - linkage.guide_height**2) - linkage.start_position
    jet = np.array([[reach - 1.0], [1.0], [0.0], [0.0]])
    near = linkage.transform_bounds(jet, np.array([[0.5], [1.0], [0.0], [0.0]]))
    assert np.all(np.isfinite(near))
    beyond = linkage.transform_bounds(jet, np.array([[2.0], [1.0], [0.0], [0.0]]))
    assert np.all(np.isinf(beyond))
    rest = linkage.transform_bounds(jet, np.zeros((4, 1)))
    assert not np.any(rest)


# The questions of the thesis ------------------------------------------------------------------


@pytest.mark.parametrize("leans_away", [True, False])
@pytest.mark.parametrize("slider_side", [1, -1])
def test_at_stroke_0_the_slider_lies_where_the_words_say(
    leans_away: bool, slider_side: int
) -> None:
    """Wirsig, section 3.3: s_0 = l_4 -+ l_sk sin(alpha_sk), to the left for +1."""
    linkage = SliderCrank(40.0, 70.0, math.radians(30.0), leans_away, slider_side, 1, 1)
    assert linkage.guide_height == pytest.approx(40.0 * math.sqrt(0.75), rel=1e-15)
    expected = slider_side * (50.0 if leans_away else 90.0)
    assert linkage.start_position == pytest.approx(expected, rel=1e-15)


@pytest.mark.parametrize(
    ("leans_away", "slider_side", "branch", "start"),
    [(True, 1, 1, 60.0), (True, -1, -1, 120.0), (False, 1, 1, 120.0)],
)
def test_the_dimensions_are_those_of_a_coupler_parallel_to_the_guide(
    leans_away: bool, slider_side: int, branch: int, start: float
) -> None:
    """The three consistent answers of mechanisms.md 4.2; the other branch is off."""
    linkage = SliderCrank(40.0, 70.0, math.radians(30.0), leans_away, slider_side, 1, branch)
    assert math.sin(linkage.coupler_angle) == pytest.approx(0.0, abs=1e-14)
    assert math.degrees(linkage.start_angle) == pytest.approx(start, rel=1e-14)
    other = replace(linkage, branch=-branch)
    assert abs(math.sin(other.coupler_angle)) > 0.01


@pytest.mark.parametrize("direction", [1, -1])
def test_a_positive_stroke_goes_in_the_stated_direction(direction: int) -> None:
    linkage = SliderCrank(40.0, 70.0, math.radians(30.0), True, 1, direction, 1)
    x, distance = linkage.pin(np.array([0.0, 3.0]))
    assert x == pytest.approx([50.0, 50.0 + 3.0 * direction], rel=1e-15)
    assert distance == pytest.approx(np.hypot(x, linkage.guide_height), rel=1e-15)


@attack
@given(linkage=slider_cranks())
def test_at_stroke_0_a_linkage_closes_by_definition(linkage: SliderCrank) -> None:
    assert linkage.missing_length(np.zeros(1))[0] <= 0.0


@attack
@given(linkage=slider_cranks())
def test_at_the_dead_strokes_nothing_is_missing_and_nothing_to_spare(linkage: SliderCrank) -> None:
    missing = linkage.missing_length(np.array(linkage.dead_strokes))
    # Roots of squares of lengths up to 300 mm.
    assert np.max(np.abs(missing)) <= 1e-12
    assert len(linkage.dead_strokes) in (2, 4)


def test_a_dead_centre_can_be_rested_in_but_not_left() -> None:
    linkage = SliderCrank(40.0, 60.0, math.pi / 2.0, False, 1, -1, 1)
    assert linkage.missing_length(np.zeros(1))[0] == pytest.approx(0.0, abs=2e-14)
    assert not np.any(linkage.transform(np.zeros((4, 1))))
    with pytest.raises(GeometryError, match="dead centre") as caught:
        linkage.transform(np.array([[0.0], [0.0], [1.0], [0.0]]))
    assert caught.value.key == "linkage"


@pytest.mark.parametrize("mirrored", [False, True])
def test_the_swing_at_a_stroke_does_not_depend_on_the_others(mirrored: bool) -> None:
    """Not in its last bit: within half a turn, beyond it, and at rest in a dead centre."""
    across = SliderCrank(60.0, 92.0, -1.134, True, 1, 1, 1, mirrored)
    dead = SliderCrank(40.0, 60.0, math.pi / 2.0, False, 1, -1, -1, mirrored)
    moving = np.zeros((4, 4))
    moving[0], moving[1] = (-60.0, 0.0, 3.0, -200.0), (1.0, 0.0, -1.0, 2.0)
    resting = np.zeros((4, 3))
    resting[0] = 0.0, 3.0, -0.0
    assert abs(across.crank_angle(moving[0]) - across.start_angle)[3] > math.pi
    for linkage, jet in ((across, moving), (dead, resting)):
        together = linkage.transform(jet)
        for place in range(jet.shape[1]):
            alone = linkage.transform(jet[:, [place]])
            assert alone.tobytes() == together[:, [place]].tobytes()


# Joints, for masses and loads ------------------------------------------------------------------


@attack
@given(linkage=slider_cranks())
def test_the_joints_of_the_drawing_are_a_linkage_that_closes(linkage: SliderCrank) -> None:
    """Both joints at their distances, the pin along x in the stated direction, the tip with psi."""
    pin, tip = linkage.joints(STROKES)
    assert np.abs(pin - tip) == pytest.approx(np.full(33, linkage.coupler), rel=1e-13)
    assert np.abs(tip) == pytest.approx(np.full(33, linkage.crank), rel=1e-15)
    assert pin - pin[0] == pytest.approx(linkage.slider_sense * STROKES, abs=1e-13)
    jet = np.zeros((4, 33))
    jet[0] = STROKES
    turned = tip[0] * np.exp(1j * linkage.transform(jet)[0])
    # Some 1e-14 of the angle at sin(v - theta) >= 0.1, times 150 mm.
    assert tip == pytest.approx(turned, abs=1e-11)


@attack
@given(linkage=slider_cranks())
def test_a_linkage_seen_from_behind_has_left_and_right_changed(linkage: SliderCrank) -> None:
    front, back = (replace(linkage, mirrored=mirrored) for mirrored in (False, True))
    for one, other in zip(front.joints(STROKES), back.joints(STROKES), strict=True):
        assert np.array_equal(-np.conj(one), other)
    assert front.slider_sense == -back.slider_sense
    # Unmirrored it is the frame of the formulas.
    pin, tip = pin_and_tip(linkage, STROKES)
    assert front.joints(STROKES)[0] == pytest.approx(pin, abs=1e-13)
    assert front.joints(STROKES)[1] == pytest.approx(tip, abs=1e-13)


@attack
@given(linkage=slider_cranks())
def test_the_way_a_radian_of_swing_is_that_of_the_joints(linkage: SliderCrank) -> None:
    """ds/dpsi is the reciprocal of `transform`; the rod between pin and tip keeps its length."""
    pin, tip = linkage.joints(STROKES)
    assume(np.min(np.abs((pin - tip).real)) > 0.05 * linkage.coupler)
    slide = linkage.per_follower(STROKES)
    jet = np.zeros((4, 33))
    jet[0], jet[1] = STROKES, 1.0
    assert slide * linkage.transform(jet)[1] == pytest.approx(np.ones(33), rel=1e-12)
    # Along the coupler pin and tip have one velocity: that of the slider and of the turning crank.
    rod = np.conj(pin - tip) / linkage.coupler
    along = (rod * linkage.slider_sense * slide).real
    assert along == pytest.approx((rod * 1j * tip).real, abs=1e-11 * np.max(np.abs(slide)))


def test_a_printed_connecting_rod_turns_as_printed() -> None:
    """A Mathcad sheet of a slider-crank with the crank at 45 degrees, 1 rad/s: theta_3 = 159.295
    degrees, omega_3 = 0.378 rad/s, piston 9.744 in/s ("Slider-crank Analysis",
    coursehero.com/file/6680931/fourbar-mathcad). The angles give b = 2 a, the piston a = 10 in."""
    linkage = SliderCrank(10.0, 20.0, math.pi / 2.0, False, -1, 1, -1)  # in line, stretched out
    stroke = 30.0 - (10.0 * math.cos(math.pi / 4.0) + math.sqrt(400.0 - 50.0))
    pin, tip = linkage.joints(np.array([stroke]))
    assert math.degrees(float(np.angle(tip[0]))) == pytest.approx(45.0, rel=1e-12)
    assert 180.0 + math.degrees(float(np.angle(pin[0] - tip[0]))) == pytest.approx(
        159.295, abs=5e-4
    )
    slide = linkage.per_follower(np.array([stroke]))
    assert abs(slide[0]) == pytest.approx(9.744, abs=5e-4)
    turn = (linkage.slider_sense * slide - 1j * tip) / (1j * (pin - tip))  # of the coupler
    assert abs(turn[0]) == pytest.approx(0.378, abs=5e-4)


def test_at_a_dead_centre_the_slider_rests_while_the_rocker_turns() -> None:
    linkage = SliderCrank(40.0, 60.0, math.pi / 2.0, False, 1, -1, 1)
    assert abs(linkage.per_follower(np.zeros(1))[0]) <= 1e-12


# The coupler of `HANGING` stands across the guide where the tip is below the pin, 40 mm over the
# shaft: X = -sqrt(100^2 - 40^2), reached to the right from X = 60.
HANGING = SliderCrank(100.0, 60.0, 0.0, True, 1, -1, 1)
ACROSS = 60.0 + math.sqrt(100.0**2 - 40.0**2)


def there_and_back(stroke: float) -> MotionPlan:
    law = make_law("polynomial-345")
    moves = Move(Decimal(150), stroke, law), Move(Decimal(150), 0.0, law)
    return MotionPlan((Dwell(Decimal(60)), *moves))


def test_a_coupler_across_the_guide_locks_the_slider() -> None:
    found = locked_at(HANGING, there_and_back(155.0))
    assert found is not None
    phi, stroke = found
    assert stroke == pytest.approx(ACROSS, rel=1e-14)
    assert math.radians(60.0) < phi < math.radians(210.0)  # on the way there
    (at,) = there_and_back(155.0).jet(np.array([phi]))[0]
    assert at == pytest.approx(stroke, rel=1e-13)
    pin, tip = HANGING.joints(np.array([stroke]))
    assert (pin - tip)[0] == pytest.approx(60.0j, abs=1e-12)
    # Before and after it the rocker turns the other way for the same stroke.
    jet = np.zeros((4, 2))
    jet[:2] = [[ACROSS - 1e-3, ACROSS + 1e-3], [1.0, 1.0]]
    assert np.prod(HANGING.transform(jet)[1]) < 0.0


def test_one_that_keeps_clear_of_it_does_not() -> None:
    assert locked_at(HANGING, there_and_back(150.0)) is None
    # The other branch passes the pin's stroke with its tip elsewhere.
    other = SliderCrank(100.0, 60.0, 0.0, True, -1, 1, -1)
    assert locked_at(other, there_and_back(150.0)) is None
    assert locked_at(other, there_and_back(155.0)) is not None


def test_a_stroke_that_ends_there_is_locked_at_its_end() -> None:
    found = locked_at(HANGING, there_and_back(ACROSS))
    assert found is not None
    # There the stroke is flat: its angle is known to the third root of rounding.
    assert found[0] == pytest.approx(math.radians(210.0), abs=1e-4)


def test_exactly_across_there_is_no_ratio() -> None:
    with pytest.raises(GeometryError, match="square to the guide") as caught:
        HANGING.per_follower(np.array([0.0, ACROSS]))
    assert caught.value.key == "linkage"
    # Next to it the ratio has a pole of the first order, whose next term is a 1e-7th of it;
    # l_4 cos v rounds to 1e-13 of some 1e-6 mm.
    near = HANGING.per_follower(ACROSS + np.array([-2e-6, -1e-6, 1e-6, 2e-6]))
    assert near[[1, 2]] == pytest.approx(2.0 * near[[0, 3]], rel=1e-6)
