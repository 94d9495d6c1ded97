from __future__ import annotations

import math
import pickle
import re
from dataclasses import replace
from decimal import Decimal

import numpy as np
import pytest

from camgeo.errors import GeometryError
from camgeo.kinematics.mechanism.linked_motion import LinkedMotion, linked
from camgeo.kinematics.mechanism.several import alike, several
from camgeo.kinematics.mechanism.slider_crank import SliderCrank
from camgeo.kinematics.plan import Dwell, MotionPlan, Move
from camgeo.numeric.arrays import Side
from tests.reference import POLYNOMIAL, plan_of, slider_crank_of, thesis_params

PARAMS = thesis_params("T5_schnitt", 1)
LINKAGE = slider_crank_of(PARAMS)


def test_breaks_borders_and_rests_are_those_of_the_slider() -> None:
    plan = plan_of(PARAMS, 5.5)
    motion = LinkedMotion(plan, LINKAGE)
    assert motion.breaks is plan.breaks
    assert motion.borders is plan.borders
    assert motion.dwells == plan.dwells


def test_in_a_rest_the_rocker_rests_exactly() -> None:
    motion = LinkedMotion(plan_of(PARAMS, 5.5), LINKAGE)
    phi = np.radians(np.linspace(81.0, 369.0, 17))
    assert not np.any(motion.jet(phi))
    # At the joint the right-hand side rests, the left-hand one still moves: its jerk is not zero.
    joint = motion.breaks[-1:]
    assert not np.any(motion.jet(joint)[1:])
    assert abs(motion.jet(joint, "left")[3][0]) > 1.0


def test_a_stroke_too_long_is_refused_also_where_both_ends_of_it_fit() -> None:
    """Both ends fit, but between them the pin comes nearer than the linkage can fold."""
    linkage = SliderCrank(40.0, 90.0, math.radians(10.0), True, 1, -1, 1)
    stroke = 2.0 * linkage.start_position  # to the mirrored place on the other side
    ends = np.array([0.0, stroke])
    assert np.all(linkage.missing_length(ends) <= 1e-9)
    half = Decimal(180)
    plan = MotionPlan((Move(half, stroke, POLYNOMIAL), Move(half, 0.0, POLYNOMIAL)))
    with pytest.raises(GeometryError, match="does not close between cam angles") as caught:
        LinkedMotion(plan, linkage)
    assert caught.value.key == "linkage"
    # Folded, crank and coupler keep the pin 50 mm off; the guide passes the shaft at 39.4 mm.
    missing = 50.0 - linkage.guide_height
    assert f"misses by up to {missing:.6g} mm" in caught.value.message


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
    """The same read-only arrays for equal requests, and those of a motion that recalls nothing."""
    plan, other = plan_of(PARAMS, 5.5), plan_of(PARAMS, 5.5)
    motion = linked(plan, LINKAGE)
    assert linked(plan, LINKAGE) is motion
    assert linked(plan, replace(LINKAGE, mirrored=True)) is not motion
    phi = np.linspace(-1.0, 7.0, 41)
    sides: tuple[Side, ...] = ("right", "left")
    for order in (1, 2, 3):
        for side in sides:
            found = motion.jet(phi, side, order)
            assert motion.jet(phi.copy(), side, order) is found
            assert np.array_equal(found, LinkedMotion(other, LINKAGE).jet(phi, side, order))
    assert not motion.jet(phi).flags.writeable
    low, high = plan.borders[:-1], plan.borders[1:]
    cells = motion.jet_and_bounds(low, high)
    assert motion.jet_and_bounds(low, high) is cells
    assert np.array_equal(cells, LinkedMotion(other, LINKAGE).jet_and_bounds(low, high))
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
