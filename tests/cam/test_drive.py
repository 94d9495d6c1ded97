"""The prescribed motion, what stands between it and the follower, and its course in time; many
drives, or discs, evaluated at once."""

from __future__ import annotations

import math
from dataclasses import replace
from decimal import Decimal
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from camgeo.cam.cam import Cam, Disc, Drive, smooth_angles
from camgeo.design.design import Design
from camgeo.errors import GeometryError
from camgeo.geometry.pitch_curve import BLOCK
from camgeo.kinematics.laws import make_law
from camgeo.kinematics.mechanism.linkages import FourBar, SliderCrank, SliderDrivenCrank
from camgeo.kinematics.mechanism.rollers import OscillatingRoller, TranslatingRoller
from camgeo.kinematics.plan import Dwell, MotionPlan, Move
from camgeo.kinematics.time_course import ConstantSpeed, SpeedCurve
from camgeo.numeric.arrays import FloatArray, Quantity, Side
from camgeo.scene.scene import load_scene
from camgeo.studies.sweep.rows import discs_together, drives_together
from camgeo.units import TURN, LiftUnit

SCENES = Path(__file__).parents[2] / "fixtures" / "scenes"


SINE = make_law("modified-sine")


STRAIGHT = make_law("straight-line")


PLAN = MotionPlan(
    (
        Dwell(Decimal(40)),
        Move(Decimal(90), 12.0, make_law("modified-trapezoid")),
        Move(Decimal(110), -3.0, SINE),
        Move(Decimal(120), 0.0, SINE),
    )
)


SLIDER = SliderCrank(100.0, 160.0, math.radians(15.0), True, 1, 1, 1)


LEVER = FourBar(70.0, 120.0, 85.0, 110 + 30j, 2.1, -1, -1)


CRANK = SliderDrivenCrank(SLIDER)


def uneven(rows: int = 8) -> SpeedCurve:
    """A disc that turns up to 12 % faster and slower, twice a turn."""
    phi = np.linspace(0.3, 0.3 + TURN, rows + 1)
    return SpeedCurve((phi - 0.06 * np.sin(2.0 * phi) - phi[0]) / 8.0, phi)


def swing(to: float) -> MotionPlan:
    return MotionPlan((Move(Decimal(150), to, SINE), Move(Decimal(210), 0.0, SINE)))


@pytest.mark.parametrize(
    ("linkage", "unit", "member"),
    [(SLIDER, "mm", "slider"), (LEVER, "rad", "lever"), (CRANK, "rad", "crank")],
)
def test_the_motion_is_that_of_the_near_end_of_the_linkage(
    linkage: SliderCrank | FourBar | SliderDrivenCrank, unit: LiftUnit, member: str
) -> None:
    plan = swing(20.0 if unit == "mm" else 0.5)
    drive = Drive(plan, linkage, unit)
    phi = np.linspace(0.1, 6.1, 13)
    far = plan.jet(phi)
    assert np.array_equal(drive.motion.jet(phi), linkage.transform(far))
    assert drive.demanded_of == member
    # From where the follower is, the far end is where the plan has it.
    assert drive.far_end is not None
    found = drive.far_end.place(phi, drive.motion.jet(phi)[0])
    assert found == pytest.approx(far[0], abs=1e-11 * (20.0 if unit == "mm" else 1.0))
    q = drive.motion.jet(phi)[0]
    there = drive.far_end.jet(phi, q)
    h = 1e-5 * (1.0 if drive.motion.jet(phi)[0].max() < 1.0 else 50.0)
    ahead, behind = (drive.far_end.jet(phi, q + step) for step in (h, -h))
    for order in (1, 2):
        rate = (ahead[order - 1] - behind[order - 1]) / (2.0 * h)
        assert there[order] == pytest.approx(rate, rel=1e-5, abs=1e-5 * np.max(np.abs(rate)))
    assert not np.any(there[3])
    wrong: LiftUnit = "rad" if unit == "mm" else "mm"
    with pytest.raises(GeometryError, match="in which the linkage's far end moves") as caught:
        Drive(plan, linkage, wrong)
    assert caught.value.key == "unit"
    assert caught.value.value == wrong
    assert repr(unit) in caught.value.message


@pytest.mark.parametrize("side", ["left", "right"])
@pytest.mark.parametrize("curve", [False, True])
def test_values_in_time_are_differences_of_the_lift_over_the_clock(side: Side, curve: bool) -> None:
    """Each derivative from central differences of the one before; one-sided at the borders."""
    course = uneven() if curve else ConstantSpeed(8.0)
    drive = Drive(PLAN, speed=8.0, speed_curve=uneven() if curve else None)
    phi = np.linspace(0.05, 6.2, 41)
    found = drive.in_time(phi, side)
    h = 1e-5
    ahead, behind = drive.in_time(phi + h, side), drive.in_time(phi - h, side)
    clock = course.time(phi + h) - course.time(phi - h)
    assert np.array_equal(found[0], PLAN.jet(phi)[0])
    for order in (1, 2, 3):
        size = np.max(np.abs(found[order]))
        differences = (ahead[order - 1] - behind[order - 1]) / clock
        assert np.max(np.abs(found[order] - differences)) <= 1e-5 * size
    # The modified trapezoid begins with a jump of the jerk alone.
    start = math.radians(40.0)
    left, right = (drive.in_time(np.array([start]), each)[:, 0] for each in ("left", "right"))
    assert np.array_equal(left, np.zeros(4))
    assert np.array_equal(right[:3], np.zeros(3))
    assert right[3] > 1e3


def test_a_curve_of_the_speed_counts_more_than_a_mean() -> None:
    curve = uneven()
    assert Drive(PLAN, speed=8.0, speed_curve=curve).time_course is curve
    assert Drive(PLAN, speed_curve=curve).time_course is curve
    course = Drive(PLAN, speed=8.0).time_course
    assert course == ConstantSpeed(8.0)


def test_without_a_speed_there_is_no_course_in_time() -> None:
    with pytest.raises(GeometryError, match=r"needs \[cam\] speed or speed_curve") as caught:
        Drive(PLAN).in_time(np.zeros(1))
    assert caught.value.key == "cam.speed"


def assert_smooth(drive: Drive) -> None:
    """Between two neighbours nothing jumps, and the velocity keeps its sign."""
    angles = drive.smooth_angles
    assert (angles[0], angles[-1]) == (0.0, TURN)
    assert np.all(np.diff(angles) > 0.0)
    courses = () if drive.time_course is None else (drive.time_course.borders,)
    for borders in (drive.motion.borders, *courses):
        apart = np.abs(borders[:, np.newaxis] - angles[np.newaxis])
        assert np.all(np.min(apart, axis=1, initial=math.inf) <= 1e-13)
    share = np.linspace(0.02, 0.98, 25)
    inside = angles[:-1, np.newaxis] + np.diff(angles)[:, np.newaxis] * share
    velocity = drive.motion.jet(inside.ravel())[1].reshape(inside.shape)
    assert np.all((np.min(velocity, axis=1) >= 0.0) | (np.max(velocity, axis=1) <= 0.0))


@pytest.mark.parametrize("name", ["points", "schnitt", "four_bar", "straight_moves", "tappet"])
def test_between_smooth_angles_the_motion_is_smooth_and_one_way(name: str) -> None:
    assert_smooth(Design(load_scene(SCENES / f"{name}.toml")).drive)


def test_smooth_angles_of_a_speed_curve_are_those_of_its_table_too() -> None:
    bare = Drive(PLAN)
    drive = Drive(PLAN, speed_curve=uneven(5))
    assert_smooth(bare)
    assert_smooth(drive)
    assert len(drive.smooth_angles) == len(bare.smooth_angles) + 5
    assert np.array_equal(drive.smooth_angles, smooth_angles(PLAN, uneven(5)))


def test_joints_are_where_the_segments_begin() -> None:
    assert np.degrees(Drive(PLAN).joints) == pytest.approx([0.0, 40.0, 130.0, 240.0], abs=1e-12)


def farthest(lifts: list[float]) -> float:
    """The far angle [degrees] of a plan with equal moves to these lifts."""
    span = Decimal(360) / len(lifts)
    spans = [span] * (len(lifts) - 1)
    moves = zip([*spans, Decimal(360) - sum(spans)], lifts, strict=True)
    drive = Drive(MotionPlan(tuple(Move(each, to, STRAIGHT) for each, to in moves)))
    return math.degrees(drive.far_angle)


def test_the_far_angle_is_the_first_at_which_the_motion_is_farthest() -> None:
    assert farthest([5.0, 0.0]) == pytest.approx(180.0)
    assert farthest([5.0, -6.0, 0.0, 0.0]) == pytest.approx(180.0)
    assert farthest([-5.0, 4.0, 5.0, 0.0]) == pytest.approx(90.0)
    assert farthest([1.0, 2.0, 9.0, 0.0]) == pytest.approx(270.0)
    assert Drive(MotionPlan((Dwell(Decimal(360)),))).far_angle == 0.0


def test_the_far_angle_may_lie_inside_a_move_through_points() -> None:
    drive = Design(load_scene(SCENES / "points.toml")).drive
    dense: FloatArray = np.linspace(0.0, TURN, 20001)
    lifts = np.abs(drive.plan.jet(dense)[0])
    assert drive.far_angle == pytest.approx(dense[np.argmax(lifts)], abs=5e-4)
    at = abs(drive.plan.jet(np.array([drive.far_angle]))[0, 0])
    assert at >= np.max(lifts) * (1.0 - 1e-15)


THERE_AND_BACK = MotionPlan((Move(Decimal(150), 20.0, SINE), Move(Decimal(210), 0.0, SINE)))


LINKAGE = SliderCrank(100.0, 160.0, math.radians(15.0), True, 1, 1, 1)


COUPLERS = (160.0, 170.0, 155.0, 181.0, 164.0)


def drives() -> list[Drive]:
    return [Drive(THERE_AND_BACK, replace(LINKAGE, coupler=each), speed=5.0) for each in COUPLERS]


def linked() -> list[Disc]:
    rocker = OscillatingRoller(-70.0 - 50.0j, 80.0, 60.0, 6.0, 1, None)
    return [
        Cam(drive, replace(rocker, base_radius=60.0 + number)).disc
        for number, drive in enumerate(drives())
    ]


def guided() -> list[Disc]:
    followers = [TranslatingRoller(50.0 + each, 6.0, 0.5 * each) for each in range(5)]
    return [Cam(Drive(THERE_AND_BACK), each).disc for each in followers]


def lift(drive: Drive) -> Quantity:
    return lambda phi, side: drive.motion.jet(phi, side)


def curvature(disc: Disc) -> Quantity:
    return disc.pitch_curve.curvature


@pytest.mark.parametrize("side", ["left", "right"])
@pytest.mark.parametrize("count", [1, 2, 5])
@pytest.mark.parametrize("length", [1, 37, 3 * BLOCK // 4])
@pytest.mark.parametrize(
    ("made", "joined", "quantity"),
    [
        (drives, drives_together, lift),
        (guided, discs_together, curvature),
        (linked, discs_together, curvature),
    ],
)
def test_each_has_its_own_values(
    made: Any, joined: Any, quantity: Any, count: int, side: Side, length: int
) -> None:
    together = joined(made()[:count])
    assert together.count == count
    phi = np.sort(np.concatenate((np.linspace(0.1, 6.2, length), THERE_AND_BACK.breaks)))[-length:]
    which = np.arange(len(phi)) % count
    alone = [quantity(each)(phi, side) for each in made()[:count]]
    assert np.array_equal(together.everywhere(quantity, phi, side), np.stack(alone, axis=-2))
    own = np.stack([alone[number][..., place] for place, number in enumerate(which)], axis=-1)
    assert np.array_equal(together.at(quantity, phi, side, which), own)
    assert len({each.tobytes() for each in alone}) == count


def test_those_that_are_put_together_stay_as_they_are() -> None:
    some, others = drives(), linked()
    joined = list(drives_together(some).blocks(7))
    assert [times for _, times in joined] == [5]
    assert joined[0][0].ledger is not some[0].ledger
    assert joined[0][0].motion is not some[0].motion
    assert next(iter(discs_together(others).blocks(7)))[0].ledger is not others[0].ledger
