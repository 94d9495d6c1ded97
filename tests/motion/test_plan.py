"""Motion plans: joints, values on both sides of them, bounds, and what is refused."""

from __future__ import annotations

import math
from decimal import Decimal

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from camgeo.errors import GeometryError
from camgeo.kinematics.laws import FAMILIES, build_law, make_law
from camgeo.kinematics.motion import Jet, lift_range, pieces, turning_angles
from camgeo.kinematics.motion import MergedDwell as DwellSpan
from camgeo.kinematics.plan import MANY, Dwell, MotionPlan, Move, joints
from camgeo.kinematics.planning.planner import plan_motion
from camgeo.kinematics.planning.requests import MoveRequest, PointsRequest, Request, TableRequest
from camgeo.numeric.arrays import FloatArray, Side
from camgeo.units import TURN
from tests.integrals import cells as cells_between
from tests.laws import LAWS
from tests.motion.planning.wishes import move, planned, rest
from tests.reference import POLYNOMIAL
from tests.strategies import FAMILY_TASKS, attack, cam_angles, plans

EPS = 2.0**-52


def degrees(*spans: str) -> list[Decimal]:
    return [Decimal(span) for span in spans]


def rise_and_return(rise: str = "100", back: str = "120", rest: str = "140") -> MotionPlan:
    up, down, still = degrees(rise, back, rest)
    return MotionPlan((Move(up, 20.0, POLYNOMIAL), Move(down, 0.0, POLYNOMIAL), Dwell(still)))


def rounding(plan: MotionPlan, shift: float) -> FloatArray:
    """(4, 1) what values differ by that are 64 roundings and `shift` [rad] apart.

    Each changes by the next one times the shift. The jerk changes by at most 72 times its size a
    rad: 4 pi in a law, by 0.4 for the largest shift of the inflection, by 25 degrees.
    """
    sizes = np.maximum(np.max(np.abs(plan.jet(np.linspace(0.0, TURN, 1441))), axis=1), 1.0)
    slopes = np.append(sizes[1:], 72.0 * sizes[3])
    # The mesh of 1/4 degree is a hundredth of a move: it sees the peaks to a thousandth.
    return np.asarray(1.001 * (64.0 * EPS * sizes + shift * slopes))[:, np.newaxis]


ULP = math.ulp(TURN)
SIDES: tuple[Side, Side] = ("right", "left")


# Joints ---------------------------------------------------------------------------------------


def test_joints_are_sums_of_what_was_written() -> None:
    plan = MotionPlan((Dwell(Decimal("0.1")),) * 3600)
    assert plan.joints_deg[-1] == 360
    assert plan.joints_deg[3] == Decimal("0.3")
    counted = 0.0
    for _ in range(3600):  # sum() compensates from Python 3.12 on
        counted += 0.1
    assert counted != 360.0, "floats would close by themselves"


def test_digits_beyond_those_of_a_double_or_of_the_decimal_context_count() -> None:
    nearly, half, tiny = degrees("179." + "9" * 60, "180", "1e-60")
    assert MotionPlan((Dwell(nearly), Dwell(half), Dwell(tiny))).joints_deg[-1] == 360
    with pytest.raises(GeometryError) as caught:
        MotionPlan((Dwell(nearly), Dwell(half)))
    assert caught.value.value == "359." + "9" * 60


@pytest.mark.parametrize(
    ("spans", "total"),
    [
        (("120", "239.999"), "359.999"),
        (("120.0", "240.001"), "360.001"),
        (("0.1", "0.2"), "0.3"),
        ((), "0"),
    ],
)
def test_a_plan_that_does_not_close_is_refused_with_its_sum(
    spans: tuple[str, ...], total: str
) -> None:
    with pytest.raises(GeometryError) as caught:
        MotionPlan(tuple(Dwell(span) for span in degrees(*spans)))
    assert (caught.value.key, caught.value.value) == ("motion", total)
    assert f"add up to {total} degrees" in caught.value.message
    assert "exactly 360" in caught.value.message


def test_a_negative_span_is_refused() -> None:
    with pytest.raises(GeometryError, match="must be from 0 to 360") as caught:
        Dwell(Decimal(-40))
    assert caught.value.key == "span"


def test_a_plan_that_ends_elsewhere_is_refused_with_the_place() -> None:
    with pytest.raises(GeometryError, match=r"ends at 7\.5") as caught:
        MotionPlan((Move(Decimal(360), 7.5, POLYNOMIAL),))
    assert caught.value.key == "motion"


def test_a_move_in_no_time_is_refused_and_named() -> None:
    with pytest.raises(GeometryError, match="infinite velocity") as caught:
        MotionPlan(
            (
                Dwell(Decimal(100)),
                Move(Decimal(0), 5.0, POLYNOMIAL),
                Move(Decimal(260), 0.0, POLYNOMIAL),
            )
        )
    assert caught.value.key == "motion[2].span"  # counted as in the scene, from 1


def test_a_move_to_where_the_follower_is_rests() -> None:
    plan = MotionPlan(
        (
            Move(Decimal(0), 0.0, POLYNOMIAL),
            Move(Decimal(360), 0.0, POLYNOMIAL),
        )
    )
    assert plan.dwells == (DwellSpan(0.0, TURN),)
    assert plan.breaks.size == 0
    assert not np.any(plan.jet(np.linspace(0.0, TURN, 25)))


# Breaks, borders, dwells ----------------------------------------------------------------------


def test_the_end_of_a_move_that_begins_the_turn_is_a_break() -> None:
    law = LAWS["quadratic-parabola"]
    third = Decimal(120)
    plan = MotionPlan((Move(third, 1.0, law), Dwell(third), Move(third, 0.0, law)))
    expected = [math.radians(angle) for angle in (0.0, 60.0, 120.0, 240.0, 300.0)]
    assert plan.breaks == pytest.approx(expected, rel=4.0 * EPS)


def test_law_borders_are_breaks_and_region_borders_are_not() -> None:
    law = LAWS["inclined-sine"]
    assert law.borders == ()
    plan = MotionPlan((Move(Decimal(180), 5.0, law), Move(Decimal(180), 0.0, law)))
    assert plan.breaks.tolist() == [0.0, math.pi]
    assert len(plan.borders) == 2 * len(law.regions)
    law = LAWS["modified-trapezoid"]
    plan = MotionPlan((Move(Decimal(180), 5.0, law), Move(Decimal(180), 0.0, law)))
    inner = [math.pi * border for border in law.borders]
    expected = [0.0, *inner, math.pi, *(math.pi + angle for angle in inner)]
    assert plan.breaks == pytest.approx(expected, rel=2.0 * EPS)


@attack
@given(plan=plans())
def test_breaks_are_borders_and_all_lie_in_one_turn(plan: MotionPlan) -> None:
    assert set(plan.breaks.tolist()) <= set(plan.borders.tolist())
    assert np.all(np.diff(plan.borders) > 0.0)
    assert np.all((plan.borders >= 0.0) & (plan.borders < TURN))


@attack
@given(plan=plans())
def test_between_breaks_nothing_jumps(plan: MotionPlan) -> None:
    """At a border that is no break both sides are one formula in two forms: equal to rounding."""
    inner = np.array([border for border in plan.borders if border not in plan.breaks])
    gap = np.abs(plan.jet(inner, "right") - plan.jet(inner, "left"))
    assert np.all(gap <= rounding(plan, ULP))


def test_dwells_are_merged_also_across_cam_angle_0() -> None:
    up, down = Move(Decimal(60), 5.0, POLYNOMIAL), Move(Decimal(60), 0.0, POLYNOMIAL)
    plan = MotionPlan(
        (
            Dwell(Decimal(20)),
            Dwell(Decimal(10)),
            up,
            Dwell(Decimal(40)),
            Move(Decimal(30), 5.0, POLYNOMIAL),  # stays where it is
            down,
            Dwell(Decimal(0)),
            Dwell(Decimal(140)),
        )
    )
    joints = [math.radians(angle) for angle in (30.0, 90.0, 160.0, 220.0)]
    assert plan.breaks.tolist() == joints
    high, low = plan.dwells
    assert (high.start, high.span) == pytest.approx((joints[1], math.radians(70.0)), rel=4 * EPS)
    assert (low.start, low.span) == pytest.approx((joints[3], math.radians(170.0)), rel=4 * EPS)


def test_a_zero_dwell_between_moves_leaves_one_break() -> None:
    move = Move(Decimal(180), 5.0, POLYNOMIAL)
    plan = MotionPlan((move, Dwell(Decimal(0)), Move(Decimal(180), 0.0, POLYNOMIAL)))
    assert plan.breaks.tolist() == [0.0, math.pi]
    assert plan.dwells == ()


# Values ---------------------------------------------------------------------------------------


@attack
@given(plan=plans())
def test_joints_count_as_themselves_however_they_are_rounded(plan: MotionPlan) -> None:
    """An angle an ulp off the joint, as from degrees, must not fall into the other segment."""
    limit = rounding(plan, 2.0 * ULP)
    for side in SIDES:
        exact = plan.jet(plan.breaks, side)
        for neighbour in (np.nextafter(plan.breaks, 10.0), np.nextafter(plan.breaks, -10.0)):
            assert np.all(np.abs(plan.jet(neighbour, side) - exact) <= limit)


@attack
@given(plan=plans(), phi=cam_angles(), turns=st.integers(-1000, 1000))
def test_any_number_of_turns(plan: MotionPlan, phi: float, turns: int) -> None:
    """k turns are rounded to an ulp of 2 pi k, which the motion takes for a shift of the angle."""
    shift = 2.0 * math.ulp(TURN * (abs(turns) + 1)) + 4.0 * ULP
    near = np.abs(plan.breaks - phi)
    if np.any(np.minimum(near, TURN - near) <= shift):
        return  # across a break the values are not comparable
    here, there = (plan.jet(np.array([angle])) for angle in (phi, phi + TURN * turns))
    assert np.all(np.abs(here - there) <= rounding(plan, shift))


@pytest.mark.parametrize("angle", [math.nan, math.inf, -math.inf])
def test_cam_angles_must_be_finite(angle: float) -> None:
    with pytest.raises(GeometryError, match="finite"):
        rise_and_return().jet(np.array([0.0, angle]))


def test_no_angles_give_no_values() -> None:
    assert rise_and_return().jet(np.empty(0)).shape == (4, 0)


# Bounds ---------------------------------------------------------------------------------------


def cells(plan: MotionPlan, count: int) -> tuple[FloatArray, FloatArray]:
    """The turn in cells, `count` to each stretch between borders."""
    return cells_between(plan.borders, count)


def overshoot(plan: MotionPlan, low: FloatArray, high: FloatArray, bounds: FloatArray) -> float:
    """Largest excess of the values over `bounds`, as a share of the size of each quantity."""
    sizes = np.max(np.abs(plan.jet(np.linspace(0.0, TURN, 721))), axis=1)
    middle = plan.jet(0.5 * (low + high))[0]
    worst = -math.inf
    for share in (*np.linspace(0.0, 1.0, 33), 1e-9, 1.0 - 1e-9):
        phi = np.clip(low + share * (high - low), low, high)
        values = plan.jet(phi, "left" if share == 1.0 else "right").copy()
        values[0] -= middle
        excess = np.max(np.abs(values) - bounds, axis=1)
        worst = max(worst, float(np.max(excess / np.maximum(sizes, 1e-300))))
    return worst


@attack
@given(plan=plans(tuple(LAWS)), count=st.integers(1, 9))
def test_bounds_hold_all_over_their_cells(plan: MotionPlan, count: int) -> None:
    if all(isinstance(segment, Dwell) for segment in plan.segments):
        return
    low, high = cells(plan, count)
    bounds = plan.jet_and_bounds(low, high)[1]
    sizes = np.max(np.abs(plan.jet(np.linspace(0.0, TURN, 721))), axis=1)
    limit = np.max(rounding(plan, 2.0 * ULP)[:, 0] / np.maximum(sizes, 1e-300))
    assert overshoot(plan, low, high, bounds) <= limit


@attack
@given(plan=plans(), count=st.integers(1, 9))
def test_bounds_close_on_small_cells(plan: MotionPlan, count: int) -> None:
    """Half the width, at least half the excess over the values in the middle."""
    low, high = cells(plan, 8 * count)
    bounds = plan.jet_and_bounds(low, high)[1]
    values = np.abs(plan.jet(0.5 * (low + high)))
    jerk = bounds[3]
    half = 0.5 * (high - low)
    assert np.all(bounds[2] - values[2] <= half * jerk * (1.0 + 1e-9) + 1e-9)
    assert np.all(bounds[1] - values[1] <= half * (values[2] + half * jerk) * (1.0 + 1e-9) + 1e-9)


def test_equal_plans_are_equal_whatever_they_were_asked_for() -> None:
    def made(to: float = 10.0) -> MotionPlan:
        law = LAWS["modified-sine"]
        return MotionPlan((Dwell(Decimal(90)), Move(Decimal(120), to, law),
                           Move(Decimal(150), 0.0, law)))  # fmt: skip

    one, other = made(), made()
    one.jet(np.linspace(0.0, 6.0, 33))
    joints(one)
    assert one == other
    assert one != made(11.0)
    assert repr(one) == repr(other)
    assert "kept" not in repr(one)


# Range and pieces of a motion ------------------------------------------------------------------


class Wave:
    """A motion that overshoots between its borders: s = 3 sin(phi - 1)."""

    breaks = np.empty(0)
    borders = np.empty(0)
    dwells: tuple[DwellSpan, ...] = ()

    def jet(self, phi: FloatArray, side: Side = "right", order: int = 3) -> Jet:
        x = phi - 1.0
        return 3.0 * np.stack((np.sin(x), np.cos(x), -np.sin(x), -np.cos(x)))

    def jet_and_bounds(self, low: FloatArray, high: FloatArray) -> tuple[Jet, Jet]:
        return self.jet(0.5 * (low + high)), np.full((4, len(low)), 6.0)


@attack
@given(plan=plans(tuple(LAWS)))
def test_the_range_is_that_of_the_positions(plan: MotionPlan) -> None:
    targets = [0.0, *(segment.to for segment in plan.segments if isinstance(segment, Move))]
    low, high = lift_range(plan)
    assert (low, high) == (min(targets), max(targets))


def test_turning_points_inside_a_piece_are_found() -> None:
    # The value is flat there: the place to 1e-8 gives it to the last digit.
    assert lift_range(Wave()) == pytest.approx((-3.0, 3.0), rel=4e-16)


def test_a_motion_that_never_moves() -> None:
    assert lift_range(MotionPlan((Dwell(Decimal(360)),))) == (0.0, 0.0)


@attack
@given(plan=plans())
def test_pieces_fill_the_turn(plan: MotionPlan) -> None:
    found = pieces(plan)
    assert found[0][0] == 0.0
    assert found[-1][1] == TURN
    assert [end for _, end in found[:-1]] == [start for start, _ in found[1:]]
    assert [start for start, _ in found] == plan.borders.tolist()


def test_without_borders_the_turn_is_one_piece() -> None:
    assert pieces(Wave()) == [(0.0, TURN)]


def test_a_rest_that_rounds_to_zero_is_no_turning_point() -> None:
    """Near its ends this law's velocity is 1 - cos, which is 0 within 1e-8."""
    half = Decimal(180)
    law = LAWS["inclined-sine"]
    assert not len(turning_angles(MotionPlan((Move(half, 6.0, law), Move(half, 0.0, law)))))


# Pieces with one formula are evaluated together, each as if it were alone ----------------------


@pytest.mark.parametrize(("name", "task"), FAMILY_TASKS)
def test_laws_that_differ_by_numbers_have_equal_formulas(name: str, task: str) -> None:
    taken = FAMILIES[name].parameters[task]
    found = []
    for number in (0.4, 0.45):
        if "inflection" in taken:
            given = {"inflection": number}
        else:
            given = {
                key: value + number
                for key, value in {
                    "v0": 0.25,
                    "a0": 1.5,
                    "j0": 2.0,
                    "v1": 0.5,
                    "a1": -1.0,
                    "j1": 3.0,
                }.items()
                if key in taken
            }
        given |= {key: 0.3 + number for key in ("v0", "v1") if key in taken}
        found.append([region.formula for region in build_law(name, task, given).regions])
    assert found[0] == found[1]
    assert [hash(formula) for formula in found[0]] == [hash(formula) for formula in found[1]]


def check_each_alone(plan: MotionPlan, phi: np.ndarray[tuple[int], np.dtype[np.float64]]) -> None:
    """In order and shuffled, few and many at once, one by one: the same bits."""
    order = np.random.default_rng(1).permutation(len(phi))
    left = plan.jet(phi, "left")
    assert np.array_equal(plan.jet(phi[order], "left"), left[:, order])
    few = plan.jet(phi)
    assert np.array_equal(plan.jet(phi[order]), few[:, order])
    filled = np.concatenate((phi, np.linspace(0.0, TURN, 2 * MANY * len(plan.borders))))
    assert np.array_equal(plan.jet(filled)[:, : len(phi)], few)
    places = np.argsort(filled, kind="stable")
    assert np.array_equal(plan.jet(filled[places])[:, np.argsort(places)[: len(phi)]], few)
    for k in range(0, len(phi), 7):
        assert np.array_equal(plan.jet(phi[k : k + 1])[:, 0], few[:, k])


def test_an_assorted_plan() -> None:
    """Laws of every kind of formula, among them general motions, points and a table."""
    shares = np.linspace(0.0, 1.0, 12)
    asked: list[Request] = [
        MoveRequest(Decimal(40), 4.0, "polynomial-7"),
        MoveRequest(Decimal(40), 9.0, "auto"),
        MoveRequest(Decimal(30), 12.0, "modified-trapezoid"),
        MoveRequest(Decimal(40), 5.0, "scca", {"sine": 0.3, "cosine": 0.2, "curved": 0.8}),
        PointsRequest(Decimal(60), 8.0, np.array([0.3, 0.6]), np.array([6.0, 7.5])),
        TableRequest(Decimal(50), shares, 3.0 * shares * shares),
        MoveRequest(Decimal(40), 2.0, "polynomial-5"),
        MoveRequest(Decimal(60), 0.0, "modified-sine", {"inflection": 0.3}),
    ]
    plan = plan_motion(asked)
    inside = np.random.default_rng(3).uniform(0.0, TURN, 200)
    check_each_alone(plan, np.sort(np.concatenate((plan.borders, inside))))


@attack
@given(plan=plans(), seed=st.integers(0, 99))
def test_any_plan(plan: MotionPlan, seed: int) -> None:
    inside = np.random.default_rng(seed).uniform(0.0, TURN, 20)
    check_each_alone(plan, np.sort(np.concatenate((plan.borders, inside))))


# Joints: classes, order of continuity, sizes of jumps ---------------------------------------------


def orders(plan: MotionPlan) -> list[int]:
    """The order of continuity at each joint."""
    return [joint.order for joint in joints(plan)]


@pytest.mark.parametrize("size", [1e-9, 1e-3, 1.0, 1e9])
def test_order_and_class_do_not_depend_on_the_unit(size: float) -> None:
    plan = planned(
        rest(40),
        move(60, 5.0 * size),
        move(40, 15.0 * size, "straight-line"),
        move(60, 25.0 * size),
        move(160, 0.0),
    )
    found = joints(plan)
    assert [joint.before + joint.after for joint in found] == ["RR", "RR", "GG", "GG", "UU"]
    assert all(joint.order >= 2 for joint in found)
    speed = 10.0 * size / math.radians(40.0)
    assert [float(joint.left[1]) for joint in found[2:4]] == pytest.approx(
        [speed, speed], rel=1e-14
    )


@pytest.mark.parametrize("span", ["0.000001", "0.00001", "0.0001", "0.01"])
@pytest.mark.parametrize("at", [0, 1, 7, 359])
def test_the_rounding_of_a_short_span_is_no_jump(span: str, at: int) -> None:
    """Its length is the difference of two rounded cam angles, off by 5e-8 of the shortest."""
    short = Decimal(span)
    speed = 10.0 / math.radians(float(short))
    plan = planned(
        move(359 - at + 1 - short, -10.0, "polynomial-5", velocity=speed, acceleration=0.0),
        move(short, 0.0, "polynomial-5", velocity=0.3 * speed, acceleration=0.0),
        *([move(at, 0.0, "polynomial-5")] if at else []),
    )
    assert min(orders(plan)) >= 2


@pytest.mark.parametrize("part", [1e-6, 1e-3])
def test_a_small_jump_is_a_jump(part: float) -> None:
    """A velocity a millionth off is reported as order 0; one 1e-12 off, as by rounding, is not."""
    span = Decimal(90)
    slope = 1.0 + part

    def plan(velocity: float) -> MotionPlan:
        quintic = make_law("polynomial-5", "R-G", v1=velocity)
        back = make_law("polynomial-5", "G-R", v0=1.0)
        return MotionPlan(
            (
                Move(span, 10.0, quintic),
                Move(span, 20.0, back),
                Dwell(span),
                Move(span, 0.0, make_law("polynomial-345")),
            )
        )

    assert orders(plan(slope))[1] == 0
    assert orders(plan(1.0 + 1e-12))[1] >= 2


def test_a_move_of_no_length_has_no_joint_of_its_own() -> None:
    plan = MotionPlan(
        (
            Move(Decimal(120), 20.0, make_law("polynomial-345")),
            Dwell(Decimal(0)),
            Move(Decimal(240), 0.0, make_law("polynomial-345")),
            Dwell(Decimal(0)),
        )
    )
    assert [joint.cam_angle for joint in joints(plan)] == [0.0, math.radians(120.0)]


def test_a_turn_of_rest_has_one_joint_without_a_jump() -> None:
    (joint,) = joints(planned(rest(360)))
    assert (joint.cam_angle, joint.order, joint.before, joint.after) == (0.0, 3, "R", "R")


def test_a_gentle_side_is_not_judged_by_a_violent_one() -> None:
    """10 mm in a thousandth of a degree, and half a mm per rad^2 next to it."""
    plan = planned(
        rest(1),
        move("0.001", 10.0, "polynomial-5", velocity=0.0, acceleration=-0.5),
        move("178.999", 0.0, "polynomial-5"),
        rest(180),
    )
    turn = joints(plan)[2]
    assert turn.after == "U"
    assert turn.right[2] == pytest.approx(-0.5, rel=1e-9)


@attack
@given(plan=plans(tuple(LAWS)))
def test_each_joint_is_where_two_segments_meet_with_what_both_have_there(plan: MotionPlan) -> None:
    """Places and positions summed up from the segments; both sides from their laws alone."""
    starts, position, found = [Decimal(0)], 0.0, []
    for segment in plan.segments:
        if segment.span:
            law = segment.law if isinstance(segment, Move) else None
            to = segment.to if isinstance(segment, Move) else position
            found.append((law, math.radians(float(segment.span)), to - position, position))
            starts.append(starts[-1] + segment.span)
            position = to
    assume(all(not stroke or abs(stroke) > 1e-3 for _, _, stroke, _ in found))
    meeting = joints(plan)
    assert len(meeting) == len(found)
    for number, joint in enumerate(meeting):
        assert joint.cam_angle == pytest.approx(math.radians(float(starts[number])), abs=1e-14)
        assert joint.position == pytest.approx(found[number][3], abs=1e-12)
        sides = []
        for (law, span, stroke, start), z in ((found[number - 1], 1.0), (found[number], 0.0)):
            if law is None or not stroke:
                sides.append(([start, 0.0, 0.0, 0.0], "R"))
                continue
            values = law(np.array([z]))[:, 0]
            jet = [stroke * each / span**order for order, each in enumerate(values)]
            jet[0] += start
            v, a = (abs(each) > 1e-9 for each in values[1:3])
            sides.append((jet, {(0, 0): "R", (1, 0): "G", (0, 1): "U", (1, 1): "B"}[v, a]))
        assert (joint.before, joint.after) == (sides[0][1], sides[1][1])
        for side, (jet, _) in zip((joint.left, joint.right), sides, strict=True):
            for order in range(4):
                size = max(abs(each[0][order]) for each in sides) + 1.0
                assert side[order] == pytest.approx(jet[order], abs=2e-9 * size)
        jumps = [
            abs(one - other) > 1e-6 * max(abs(one), abs(other), 1e-6)
            for one, other in zip(sides[0][0], sides[1][0], strict=True)
        ]
        assert joint.order == (jumps.index(True) - 1 if any(jumps) else 3)
