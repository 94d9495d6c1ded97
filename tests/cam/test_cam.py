"""The prescribed motion, what stands between it and the follower, its course in time; the curves of
a disc, what remains of its flanks, its contact, and its width between the sides of a yoke."""

from __future__ import annotations

import math
from dataclasses import replace
from decimal import Decimal
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from camgeo.cam.cam import (
    ROUNDING,
    Breadth,
    Cam,
    Contact,
    Disc,
    Drive,
    Yoke,
    contact_by_name,
    smooth_angles,
)
from camgeo.design.design import Design
from camgeo.errors import GeometryError
from camgeo.geometry.outline.path import Flank, Stretch
from camgeo.geometry.outline.path import Path as Outline
from camgeo.geometry.pieces import Extremes
from camgeo.geometry.pitch_curve import BLOCK, PitchCurve, WorkingCurve
from camgeo.kinematics.laws import make_law
from camgeo.kinematics.mechanism.flat import TranslatingFlat
from camgeo.kinematics.mechanism.follower import Follower
from camgeo.kinematics.mechanism.linkages import FourBar, SliderCrank, SliderDrivenCrank
from camgeo.kinematics.mechanism.rollers import OscillatingRoller, TranslatingRoller
from camgeo.kinematics.plan import Dwell, MotionPlan, Move
from camgeo.kinematics.time_course import ConstantSpeed, SpeedCurve
from camgeo.numeric.arrays import FloatArray, Quantity, Side
from camgeo.scene.scene import load_scene
from camgeo.studies.sweep.rows import discs_together, drives_together
from camgeo.units import TURN, LiftUnit
from tests.strategies import SMOOTH, attack, plans, signs

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
    assert drive.demanded_member == member
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
    assert Drive(PLAN, speed=8.0).time_course == ConstantSpeed(8.0)


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
    assert_smooth(design(name).drive)


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
    drive = design("points").drive
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
    assert np.array_equal(together.paired_values(quantity, phi, side, which), own)
    assert len({each.tobytes() for each in alone}) == count


def test_those_that_are_put_together_stay_as_they_are() -> None:
    some, others = drives(), linked()
    joined = list(drives_together(some).blocks(7))
    assert [times for _, times in joined] == [5]
    assert joined[0][0].ledger is not some[0].ledger
    assert joined[0][0].motion is not some[0].motion
    assert next(iter(discs_together(others).blocks(7)))[0].ledger is not others[0].ledger


LAW = make_law("polynomial-345")


def plan(lift: float) -> MotionPlan:
    return MotionPlan(
        (Dwell(Decimal(70)), Move(Decimal(140), lift, LAW), Move(Decimal(150), 0.0, LAW))
    )


MM, RAD = Drive(plan(12.0)), Drive(plan(0.3), unit="rad")


SLIDE = TranslatingRoller(45.0, 7.0, 5.0, 0.7)


ROCKER = OscillatingRoller(-70.0 - 40.0j, 70.0, 50.0, 6.0)


FACE = TranslatingFlat(45.0)


ANGLES = np.linspace(0.0, TURN, 61)


@cache
def design(name: str) -> Design:
    return Design(load_scene(SCENES / f"{name}.toml"))


@pytest.mark.parametrize("clearance", [0.0, 0.08])
@pytest.mark.parametrize("rotation", [1, -1])
@pytest.mark.parametrize(("drive", "follower"), [(MM, SLIDE), (RAD, ROCKER)])
def test_both_flanks_run_beside_the_roller_centre(
    drive: Drive, follower: Follower, rotation: int, clearance: float
) -> None:
    cam = Cam(drive, follower, rotation, Contact.GROOVE, clearance)
    disc = cam.disc
    half = follower.roller_radius + 0.5 * clearance
    assert disc.flank_distance == pytest.approx(half, rel=1e-15)
    assert [name for name, _ in disc.flanks] == ["inner", "outer"]
    for flank, sign, (_, curve) in zip(Flank, (-1.0, 1.0), disc.flanks, strict=True):
        assert curve is disc.curve(flank)
        beside = curve.point(ANGLES) - disc.pitch_curve.point(ANGLES)
        assert np.abs(beside) == pytest.approx(half, rel=1e-12)
        # Away from the axis, as the disc's curves are without a hollow here.
        assert np.all(sign * (beside * np.conj(disc.pitch_curve.point(ANGLES))).real > 0.0)
    assert cam.distances == pytest.approx((-half, half))
    for contact, wanted in ((Contact.INNER, (-half,)), (Contact.OUTER, (half,))):
        one = Cam(drive, follower, rotation, contact, clearance)
        assert one.distances == pytest.approx(wanted)
        assert [name for name, _ in one.disc.flanks] == [contact.value]


@pytest.mark.parametrize("kind", [Cam, Disc])
def test_a_contact_goes_by_its_name(kind: type[Cam] | type[Disc]) -> None:
    made = kind(MM, SLIDE, contact="groove")  # type: ignore[arg-type]  # as who does not check types
    assert made.contact is Contact.GROOVE


def test_what_a_search_of_bends_misses_is_found_where_a_flank_needs_it(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Of the curvature only its values at the breaks: the largest one between is still there."""
    whole = design("swallow_tail").cam.disc
    wanted = whole.bends.largest()

    def ends_only(curve: PitchCurve) -> Extremes:
        return Extremes(curve.breaks, curve.curvature(curve.breaks))

    monkeypatch.setattr("camgeo.cam.cam.curvature_extremes", ends_only)
    again = Cam(whole.drive, whole.follower, whole.rotation).disc
    assert again.bends.largest() == pytest.approx(wanted, rel=1e-9)
    dropped = [np.array(each.outline("inner").dropped) for each in (again, whole)]
    assert dropped[0] == pytest.approx(dropped[1], abs=1e-9)


def test_a_flat_face_has_the_bends_of_its_contour() -> None:
    disc = Cam(MM, FACE).disc
    kappa = disc.pitch_curve.curvature(np.linspace(0.0, TURN, 2001))
    assert disc.bends.smallest()[0] <= np.min(kappa) <= np.max(kappa) <= disc.bends.largest()[0]
    assert disc.flank_distance == 0.0
    assert not disc.outline("inner").is_trimmed
    points = points_of(disc.inner_outline.path)
    assert min(abs(points - disc.pitch_curve.point(np.array([1.7]))[0])) < 0.5


def points_of(path: Outline) -> np.ndarray:
    """Points of the stretches of a path, some hundred of each turn."""
    found = []
    for each in path.stretches:
        phi = np.linspace(each.start, each.end, 2 + round(200 * (each.end - each.start)))
        found.append(each.curve.point(phi))
    return np.concatenate(found)


def test_a_groove_that_undercuts_nothing_keeps_both_flanks_whole() -> None:
    disc = design("groove_clearance").cam.disc
    inner, outer = disc.flank_paths
    assert inner is disc.outline("inner").path is disc.inner_outline.path
    assert outer is disc.outline("outer").path is disc.outer_outline.path
    for path, whole, curve in (
        (inner, disc.untrimmed_paths[0], disc.inner_curve),
        (outer, disc.untrimmed_paths[1], disc.outer_curve),
    ):
        assert not disc.inner_outline.is_trimmed
        assert points_of(path) == pytest.approx(points_of(whole), abs=1e-9)
        (stretch,) = path.stretches
        assert stretch.curve == curve
        assert stretch.end - stretch.start == pytest.approx(TURN)


@pytest.mark.parametrize(("contact", "used"), [("inner", 0), ("outer", 1)])
def test_the_flank_on_which_nothing_runs_is_the_whole_curve(contact: str, used: int) -> None:
    disc = Cam(MM, SLIDE, contact=Contact(contact)).disc
    paths = disc.flank_paths
    assert paths[used] is disc.outline(contact).path
    other = (disc.outer_curve, disc.inner_curve)[used]
    assert paths[1 - used].elements == (Stretch(other, 0.0, TURN),)


def test_a_trimmed_flank_loses_what_crosses_and_the_roller_its_stroke() -> None:
    """HC21c: what lies between cam angles 73.0697 and 84.2799 degrees is cut off."""
    disc = design("swallow_tail").cam.disc
    outline = disc.outline("inner")
    assert np.degrees(outline.dropped) == pytest.approx(np.array([[73.0697, 84.2799]]), abs=5e-5)
    assert disc.flank_paths[0] is outline.path
    assert len(points_of(disc.untrimmed_paths[0])) > len(points_of(outline.path))
    replay = disc.replay("inner")
    lost = replay.demanded[0] - replay.actual[0]
    at = np.degrees(replay.phi)
    assert np.max(np.abs(lost[(at < 73.0) | (at > 84.4)])) <= 1e-9
    assert 1e-4 < np.max(lost) < 0.1


def test_the_pitch_path_turns_where_the_velocity_jumps() -> None:
    straight = make_law("straight-line")
    moves = (Move(Decimal(120), 6.0, straight), Move(Decimal(240), 0.0, straight))
    disc = Cam(Drive(MotionPlan(moves)), SLIDE).disc
    path = disc.pitch_path
    assert sorted(np.degrees([each.phi_end for each in path.pivots]) % 360.0) == pytest.approx(
        [0.0, 120.0], abs=1e-9
    )
    pitch = WorkingCurve(disc.pitch_curve, 0.0)
    assert all(each.curve == pitch for each in path.stretches)
    lengths = [each.end - each.start for each in path.stretches]
    assert sum(lengths) == pytest.approx(TURN)


def test_another_size_or_motion_makes_another_cam_of_the_same_drive() -> None:
    cam = Cam(MM, SLIDE, -1, Contact.OUTER, 0.0)
    sized = cam.sized(roller_radius=8.5, base_radius=47.0)
    assert sized.drive is MM
    assert sized.follower == TranslatingRoller(47.0, 8.5, 5.0, 0.7)
    assert (sized.rotation, sized.contact) == (-1, Contact.OUTER)
    assert sized.ledger is not cam.ledger
    with pytest.raises(GeometryError):
        cam.sized(base_radius=4.0)  # less than the offset
    moved = cam.moved(plan(3.0))
    assert moved.drive.plan == plan(3.0)
    assert moved.drive.unit == "mm"
    assert moved.follower is SLIDE
    assert np.max(moved.disc.pitch_curve.motion.jet(ANGLES)[0]) == pytest.approx(3.0)
    assert moved.ledger is moved.drive.ledger
    assert cam.lift_unit == "mm"
    assert Cam(RAD, ROCKER).lift_unit == "rad"


INNER, OUTER = Flank.INNER, Flank.OUTER


@pytest.mark.parametrize(
    ("name", "flanks", "by_form", "inside", "plate", "push", "distances"),
    [
        ("inner", (INNER,), False, True, True, 1, {INNER: -3.0}),
        ("outer", (OUTER,), False, False, False, -1, {OUTER: 3.0}),
        ("groove", (INNER, OUTER), True, True, False, 1, {INNER: -3.0, OUTER: 3.0}),
    ],
)
def test_each_contact_by_its_flanks(
    name: str,
    flanks: tuple[Flank, ...],
    by_form: bool,
    inside: bool,
    plate: bool,
    push: int,
    distances: dict[Flank, float],
) -> None:
    """The inner flank lies within the pitch curve and pushes the follower outward."""
    contact = contact_by_name("follower.contact", name)
    assert contact.value == name
    assert contact.flanks == flanks
    assert contact.closed_by_form is by_form
    assert contact.runs_inside is inside
    assert contact.is_plate is plate
    assert contact.main is flanks[0]
    assert contact.push == push
    assert contact.distances(3.0) == distances
    assert list(contact.distances(3.0)) == list(flanks)


@pytest.mark.parametrize("value", ["Inner", "ring", "", None, 1, True])
def test_another_contact_is_refused_with_those_there_are(value: object) -> None:
    with pytest.raises(GeometryError, match='must be one of "inner", "outer", "groove"') as caught:
        contact_by_name("follower.contact", value)
    assert caught.value.key == "follower.contact"
    assert len(Contact) == 3


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
