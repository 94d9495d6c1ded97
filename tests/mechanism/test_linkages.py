"""What holds for every linkage, over random valid ones; each has a module of its own, too."""

from __future__ import annotations

import math
import pickle
import re
from dataclasses import dataclass, replace
from decimal import Decimal
from itertools import product
from typing import Any, Final

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from camgeo.check.machine import check_linkage
from camgeo.errors import GeometryError
from camgeo.geometry.together import alike, several
from camgeo.kinematics.mechanism.linkage import LinkedMotion, linked
from camgeo.kinematics.mechanism.linkages import FourBar, SliderCrank, SliderDrivenCrank
from camgeo.kinematics.plan import Dwell, MotionPlan, Move
from camgeo.numeric.arrays import SIDES, FloatArray
from camgeo.units import TURN
from tests.integrals import cells
from tests.long_form import examples
from tests.reference import POLYNOMIAL, plan_of, slider_crank_of, thesis_params
from tests.strategies import SMOOTH, attack, four_bars, plans, slider_cranks, slider_driven_cranks

ROUNDING: Final = 1e-11
"""As a share of the largest value. With 2 mm to spare the sines by which up to five times is
divided are 0.1 at least; lengths are up to 450 mm."""

few = settings(attack, max_examples=examples(8, long=25))


@dataclass(frozen=True)
class Kind:
    """A linkage as it is drawn, which closes from position 0 to `motion` [mm or rad].

    Attributes
    ----------
    drawn : the strategy.
    motion : as far as it closes.
    least : a derivative of which less is a matter of rounding.
    """

    drawn: st.SearchStrategy[Any]
    motion: float
    least: float


KINDS: Final = {
    "slider-crank": Kind(slider_cranks(8.0), 8.0, 0.01),
    "four-bar": Kind(four_bars(0.6), 0.6, 0.01),
    "slider-driven-crank": Kind(slider_driven_cranks(0.6), 0.6, 1.0),
}

by_kind = pytest.mark.parametrize("name", KINDS)


def size(values: FloatArray) -> float:
    return float(np.max(np.abs(values)))


@by_kind
@attack
@given(data=st.data())
def test_the_joints_of_the_drawing_are_a_loop_that_closes(name: str, data: st.DataObject) -> None:
    """Rods keep their lengths, the tip turns with the crank, the pin is where it is driven to."""
    kind = KINDS[name]
    linkage, count = data.draw(kind.drawn), 65
    position = np.linspace(0.0, kind.motion, count)
    pin, tip = linkage.joints(position)
    assert np.abs(pin - tip) == pytest.approx(np.full(count, linkage.coupler), rel=1e-13)
    assert np.abs(tip) == pytest.approx(np.full(count, linkage.crank), rel=1e-13)
    jet = np.zeros((4, count))
    jet[0], jet[1] = position, 1.0
    moved, rate = linkage.transform(jet)[:2]
    assert moved[0] == 0.0
    # The mean value theorem excludes a turn; a crank that rests, of a kite, rests to rounding.
    assert size(np.diff(moved)) < 2.0 * size(rate) * position[1] + 1e-14 * max(1.0, size(moved))
    driven = isinstance(linkage, SliderDrivenCrank)
    turned = tip[0] * np.exp(1j * (position if driven else moved))
    assert tip == pytest.approx(turned, abs=1e-11)
    if isinstance(linkage, FourBar):
        lever = (pin - linkage.shaft) / (pin[0] - linkage.shaft)
        assert lever == pytest.approx(np.exp(1j * linkage.lever_sense * position), abs=1e-12)
        assert np.all(np.sign(np.imag(np.conj(pin) * tip)) == -linkage.branch)
        return
    inner = linkage.inner if driven else linkage
    stroke = moved if driven else position
    assert pin - pin[0] == pytest.approx(inner.slider_sense * stroke, abs=1e-12 * linkage.coupler)
    if driven:
        assert len(set(np.sign((pin - tip).real))) == 1
    else:
        # +1: the tip lies clockwise of the pin seen from the shaft, the front of the linkage.
        side = np.sign(np.imag(np.conj(pin) * tip)) * (-1.0 if linkage.mirrored else 1.0)
        assert np.all(side == -linkage.branch)


@by_kind
@few
@given(data=st.data(), count=st.integers(1, 6))
def test_bounds_hold_all_over_their_cells_and_close_on_small_ones(
    name: str, data: st.DataObject, count: int
) -> None:
    kind = KINDS[name]
    motion = LinkedMotion(data.draw(plans(SMOOTH, kind.motion)), data.draw(kind.drawn))
    low, high = cells(motion.borders, count)
    bounds = motion.jet_and_bounds(low, high)[1]
    middle = motion.jet(0.5 * (low + high))[0]
    sizes = np.max(np.abs(motion.jet(np.linspace(0.0, TURN, 241))), axis=1)[:, np.newaxis]
    for share in np.linspace(0.0, 1.0, 25):
        phi = np.clip(low + share * (high - low), low, high)
        values = motion.jet(phi, "left" if share == 1.0 else "right").copy()
        values[0] -= middle
        assert np.all(np.abs(values) <= bounds + ROUNDING * np.maximum(sizes, kind.least))
    coarse, fine = (motion.jet_and_bounds(*cells(motion.borders, n))[1] for n in (64, 128))
    assert np.all(np.isfinite(coarse))
    assert np.max(fine[0]) <= 0.7 * np.max(coarse[0]) + 1e-15


LEVER: Final = FourBar(40.0, 70.0, 50.0, 90.0 + 10.0j, math.radians(95.0), -1, 1)
SLIDER: Final = SliderCrank(40.0, 60.0, math.radians(30.0), True, 1, 1, 1)
CRANK: Final = SliderDrivenCrank(SliderCrank(60.0, 50.0, math.radians(-25.0), True, 1, -1, 1))

DEAD: Final[tuple[tuple[Any, float, int, int], ...]] = (
    (LEVER, 4.0, 0, 1),
    (LEVER, 4.0, 1, -1),
    (LEVER, 4.0, 2, 1),
    (SLIDER, 150.0, 0, 1),
    (SLIDER, 150.0, 1, -1),
    (CRANK, 2.0, 0, 1),
    (CRANK, 2.0, 1, -1),
)
"""A linkage, how far to look for dead centres, which of them, and the side on which it closes."""


@pytest.mark.parametrize(("linkage", "reach", "number", "side"), DEAD)
def test_bounds_are_close_next_to_a_dead_centre(
    linkage: Any, reach: float, number: int, side: int
) -> None:
    """They exceed the values by at most a factor of 2.

    The width of a cell is a fiftieth of its distance from the dead centre. Values change with that
    distance, so bounds are compared with the largest one nearby.
    """
    dead = sorted(linkage.dead_positions(-reach, reach))[number]
    for distance in (1e-1, 1e-2, 1e-3, 1e-4):
        places = dead + side * distance * np.linspace(0.5, 1.5, 41)
        jet = np.zeros((4, len(places)))
        jet[0], jet[1] = places, 1.0
        largest = np.max(np.abs(linkage.transform(jet)), axis=1)
        bounds = np.array([[0.01 * distance], [1.0], [0.0], [0.0]])
        found = linkage.transform_bounds(jet[:, 20:21], bounds)[:, 0]
        assert np.all(found[1:] <= 2.0 * np.maximum(largest[1:], 0.1))


# Motions behind a linkage -----------------------------------------------------------------------

PHI = np.linspace(-1.0, 7.0, 41)

PARAMS = thesis_params("T5_schnitt", 1)
LINKAGE = slider_crank_of(PARAMS)


def test_in_a_rest_the_rocker_rests_exactly() -> None:
    motion = LinkedMotion(plan_of(PARAMS, 5.5), LINKAGE)
    phi = np.radians(np.linspace(81.0, 369.0, 17))
    assert not np.any(motion.jet(phi))
    # At the joint the right-hand side rests, the left-hand one still moves: its jerk is not zero.
    joint = motion.breaks[-1:]
    assert not np.any(motion.jet(joint)[1:])
    assert abs(motion.jet(joint, "left")[3][0]) > 1.0


def test_a_slider_that_never_moves_needs_no_room() -> None:
    motion = LinkedMotion(MotionPlan((Dwell(Decimal(360)),)), LINKAGE)
    assert not np.any(motion.jet(np.linspace(0.0, 6.0, 7)))


@pytest.mark.parametrize("stroke", [100.0, 140.0, 150.0, 155.0])
def test_however_short_the_gap_the_cam_angles_are_named(stroke: float) -> None:
    """Folded, crank and coupler keep the pin 40 mm off; the guide passes at 39.998 mm. They miss it
    over 0.8 mm of stroke, less than what lies between the points of any grid."""
    linkage = SliderCrank(40.0, 80.0, 0.01, True, 1, -1, 1)
    half = Decimal(180)
    plan = MotionPlan((Move(half, stroke, POLYNOMIAL), Move(half, 0.0, POLYNOMIAL)))
    with pytest.raises(GeometryError, match=r"misses by up to 0.00199998 mm") as caught:
        LinkedMotion(plan, linkage)
    angles = [float(text) for text in re.findall(r"\d+\.\d+", caught.value.message)[:4]]
    at_ends = plan.jet(np.radians(angles))[0]
    # Printed to ten digits: 1e-8 deg, by at most 150 mm by 15/8 by pi.
    assert linkage.missing_length(at_ends) == pytest.approx(np.zeros(4), abs=2e-8)
    # Once there and once back, the second time in the mirror of the first.
    assert angles == pytest.approx([360.0 - angle for angle in reversed(angles)], abs=1e-7)


def test_a_stroke_up_to_the_dead_centre_is_no_gap() -> None:
    """Rounding decides whether the last bit is missing; the check names the dead centre."""
    rng = np.random.default_rng(7)
    half = Decimal(180)
    for crank, coupler in rng.uniform(20.0, 150.0, (40, 2)):
        linkage = SliderCrank(float(crank), float(coupler), 0.3, True, 1, 1, 1)
        stroke = max(linkage.dead_strokes)
        plan = MotionPlan((Move(half, stroke, POLYNOMIAL), Move(half, 0.0, POLYNOMIAL)))
        if linkage.missing_length(np.array([-linkage.start_position]))[0] > 0.0:
            continue
        assert math.isfinite(LinkedMotion(plan, linkage).jet(np.array([1.0]))[0][0])


def test_what_was_asked_for_lately_is_recalled() -> None:
    plan = plan_of(PARAMS, 5.5)
    motion = linked(plan, LINKAGE)
    assert linked(plan, LINKAGE) is motion
    assert linked(plan, replace(LINKAGE, mirrored=True)) is not motion
    for order, side in product((1, 2, 3), SIDES):
        found = motion.jet(PHI, side, order)
        assert motion.jet(PHI.copy(), side, order) is found
        assert np.array_equal(found, LinkedMotion(plan, LINKAGE).jet(PHI, side, order))
    assert not motion.jet(PHI).flags.writeable
    cells_ = plan.borders[:-1], plan.borders[1:]
    assert motion.jet_and_bounds(*cells_) is motion.jet_and_bounds(*cells_)
    assert pickle.loads(pickle.dumps(motion)).kept == {}


def test_linkages_that_differ_in_more_than_numbers_are_not_one() -> None:
    """Each of several has its own numbers at its own places; words cannot be put side by side."""
    longer = replace(LINKAGE, coupler=LINKAGE.coupler + 2.0)
    which = np.array([0, 1, 1, 0])
    both = several([LINKAGE, longer], which)
    at = np.array([1.0, 2.0, 3.0, 4.0])
    alone = [each.missing_length(at) for each in (LINKAGE, longer)]
    assert both.missing_length(at).tolist() == [alone[k][n] for n, k in enumerate(which)]
    mixed = several([LINKAGE, replace(LINKAGE, leans_away=not LINKAGE.leans_away)], which)
    with pytest.raises(AttributeError, match="leans_away differs"):
        _ = mixed.leans_away
    assert alike(LINKAGE) == alike(longer)
    assert alike(LINKAGE) != alike(replace(LINKAGE, mirrored=not LINKAGE.mirrored))
    assert alike(LINKAGE) != alike(replace(LINKAGE, branch=-LINKAGE.branch))


def test_equal_motions_are_equal_whatever_they_were_asked_for() -> None:
    one, other = (LinkedMotion(plan_of(PARAMS, 5.5), LINKAGE) for _ in range(2))
    one.jet(np.linspace(0.0, 6.0, 33))
    one.jet_and_bounds(one.borders[:-1], one.borders[1:])
    assert one == other
    assert repr(one) == repr(other)
    assert "kept" not in repr(one)
    assert one != LinkedMotion(plan_of(PARAMS, 5.0), LINKAGE)


# Four-bars -------------------------------------------------------------------------------------


def test_a_rocker_may_turn_more_than_half_a_turn_with_no_jump() -> None:
    """A drag link: the shaft distance is the shortest, both levers turn all round, for ever."""
    linkage = FourBar(60.0, 70.0, 65.0, 20.0 + 0.0j, 0.3, 1, 1)
    turns = np.linspace(-3.0 * TURN, 3.0 * TURN, 6001)
    jet = np.zeros((4, 6001))
    jet[0], jet[1] = turns, 1.0
    swing = linkage.transform(jet)[0]
    assert np.max(np.abs(np.diff(swing))) < 0.05
    # Each turn of the lever is one of the crank.
    assert swing[-1] - swing[0] == pytest.approx(6.0 * TURN, rel=1e-13)
    assert not linkage.dead_positions(-9.0, 9.0)


PARALLELOGRAM = FourBar(40.0, 100.0, 40.0, 100.0 + 0.0j, math.radians(60.0), 1, -1)


def test_a_parallelogram_keeps_its_branch() -> None:
    jet = np.zeros((4, 50))
    jet[0], jet[1] = np.linspace(0.0, math.radians(110.0), 50), 1.0
    swing = PARALLELOGRAM.transform(jet)
    assert swing[0] == pytest.approx(jet[0], abs=1e-13)
    assert swing[1] == pytest.approx(np.ones(50), rel=1e-12)
    assert swing[2:] == pytest.approx(np.zeros((2, 50)), abs=1e-11)
    # Crank and coupler fold and stretch at the change points, with a double root each: 1e-8 rad.
    dead = np.degrees(PARALLELOGRAM.dead_positions(-2.0, 3.0))
    assert np.min(np.abs(dead - np.array([[-60.0], [120.0]])), axis=0) == pytest.approx(
        np.zeros(len(dead)), abs=1e-5
    )
    assert np.ptp(dead) == pytest.approx(180.0, abs=1e-5)


def test_a_change_point_is_a_dead_centre() -> None:
    """Passing it, the linkage could fold into the antiparallelogram: refused where it is moving."""
    third = Decimal(120)
    to = math.radians(130.0)
    plan = MotionPlan((Dwell(third), Move(third, to, POLYNOMIAL), Move(third, 0.0, POLYNOMIAL)))
    (found,) = check_linkage(LinkedMotion(plan, PARALLELOGRAM))
    assert (found.name, found.severity) == ("dead-centre", "no-disc")
    assert "at lever angle 120 deg" in found.sentence
    assert "with the lever angle kept between -59.9999 and 120 degrees" in found.sentence
    flat = replace(PARALLELOGRAM, lever_angle=0.0)
    with pytest.raises(GeometryError, match="dead centre"):
        flat.transform(np.array([[0.0], [1.0], [0.0], [0.0]]))
    assert not np.any(flat.transform(np.zeros((4, 3))))


def test_a_dead_centre_at_the_start_keeps_the_digits() -> None:
    """Crank and coupler stretched at motion 0: psi goes with the root of the motion, as HC05."""
    linkage = FourBar(40.0, 60.0, 50.0, 100.0 + 50.0j, -0.5 * math.pi, 1, 1)
    assert linkage.missing_length(np.zeros(1))[0] == pytest.approx(0.0, abs=1e-13)
    small = np.array([1e-12, 1e-10, 1e-8])
    jet = np.zeros((4, 3))
    jet[0], jet[1] = -small, -1.0
    if linkage.missing_length(np.array([-1e-3]))[0] > 0.0:
        jet = -jet
    found = linkage.transform(jet)
    # From the exact sum of the angles at shaft and tip: d = 100 - 50 x, cosine rule to first order.
    lost = 50.0 * small
    theta = np.sqrt(2.0 * lost * 60.0 / (40.0 * 100.0))
    assert np.abs(found[0]) == pytest.approx(theta, rel=1e-4)
    assert np.abs(found[1] * 2.0 * small) == pytest.approx(theta, rel=1e-4)


def test_dimensions_that_do_not_close_are_reported_with_a_coupler_that_does() -> None:
    with pytest.raises(GeometryError, match="coupler must be") as caught:
        FourBar(40.0, 20.0, 50.0, 150.0 + 0.0j, math.radians(90.0), 1, 1)
    assert caught.value.key == "linkage"
    least = math.hypot(150.0, 50.0) - 40.0
    assert f"{least:.6g} to" in caught.value.message
    FourBar(40.0, least + 1e-9, 50.0, 150.0 + 0.0j, math.radians(90.0), 1, 1)


# Slider-driven-cranks --------------------------------------------------------------------------


def test_a_crank_may_turn_over_and_over() -> None:
    linkage = SliderDrivenCrank(SliderCrank(30.0, 100.0, math.radians(40.0), True, 1, -1, 1))
    turns = np.linspace(-TURN, TURN, 2001)
    assert np.max(linkage.missing_length(turns)) < 0.0
    jet = np.zeros((4, 2001))
    jet[0] = turns
    stroke = linkage.transform(jet)[0]
    assert stroke[1000:] == pytest.approx(stroke[:1001], abs=1e-12)
    # Between its two dead points, coupler and crank on one line: Wirsig's geometry, by hand.
    height = linkage.inner.guide_height
    reach = math.sqrt(130.0**2 - height**2) - math.sqrt(70.0**2 - height**2)
    assert np.ptp(stroke) == pytest.approx(reach, rel=1e-4)


def test_at_its_dead_centre_it_may_rest_and_not_move() -> None:
    linkage = SliderDrivenCrank(SliderCrank(50.0, 30.0, math.radians(10.0), True, 1, -1, 1))
    dead = linkage.dead_positions(-math.pi, math.pi)
    assert linkage.missing_length(np.array(dead)) == pytest.approx(np.zeros(len(dead)), abs=1e-13)
    # Put exactly on it, as rounding allows.
    at = next(each for each in dead if linkage._along(linkage._drop(np.array([each])))[0] < 1e-5)
    jet = np.array([[at], [0.0], [0.0], [0.0]])
    assert not np.any(linkage.transform(jet)[1:])
    beyond = np.array([[at], [1.0], [0.0], [0.0]])
    beyond[0] += 1e-3 * np.sign(linkage.missing_length(np.array([at + 1e-3]))[0])
    with pytest.raises(GeometryError, match="dead centre"):
        linkage.transform(beyond)


def test_a_coupler_across_the_guide_at_stroke_0_is_refused() -> None:
    """The tip at the other branch lies under the pin: crank upright, coupler its height less."""
    inner = SliderCrank(100.0, 100.0, 0.0, True, 1, -1, -1)
    # d^2 = 2 l^2: the second tip is at (-l, 0), straight below the pin at (-l, l).
    assert abs(math.cos(inner.coupler_angle)) < 1e-14
    with pytest.raises(GeometryError, match="square to the guide") as caught:
        SliderDrivenCrank(inner)
    assert caught.value.key == "linkage"


# Slider-cranks ------------------------------------------------------------------------------------


def test_a_cell_that_may_reach_a_dead_centre_has_no_bound() -> None:
    linkage = SliderCrank(40.0, 60.0, math.radians(30.0), True, 1, 1, 1)
    full = linkage.crank + linkage.coupler
    reach = math.sqrt(full**2 - linkage.guide_height**2) - linkage.start_position
    jet = np.array([[reach - 1.0], [1.0], [0.0], [0.0]])
    near = linkage.transform_bounds(jet, np.array([[0.5], [1.0], [0.0], [0.0]]))
    assert np.all(np.isfinite(near))
    beyond = linkage.transform_bounds(jet, np.array([[2.0], [1.0], [0.0], [0.0]]))
    assert np.all(np.isinf(beyond))
    assert not np.any(linkage.transform_bounds(jet, np.zeros((4, 1))))


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
    assert abs(math.sin(replace(linkage, branch=-branch).coupler_angle)) > 0.01


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


# The coupler of `HANGING` stands across the guide where the tip is below the pin, 40 mm over the
# shaft: X = -sqrt(100^2 - 40^2), reached to the right from X = 60.
