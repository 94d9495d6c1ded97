"""Velocity and acceleration of joints: stated, fixed by a neighbour, inferred."""

from __future__ import annotations

import math
from decimal import Decimal

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from camgeo.errors import GeometryError
from camgeo.kinematics.laws import make_law
from camgeo.kinematics.plan import Joint, MotionPlan, joints
from camgeo.kinematics.planning.requests import Request, TableRequest
from camgeo.kinematics.splines import clamped_spline
from camgeo.units import TURN
from tests.motion.planning.wishes import data_of, laws, move, move_of, planned, rest, table, through
from tests.strategies import attack


def at(plan: MotionPlan, degrees: float) -> Joint:
    """The joint at that cam angle."""
    (found,) = [
        joint for joint in joints(plan) if math.isclose(joint.cam_angle, math.radians(degrees))
    ]
    return found


def energy(plan: MotionPlan) -> float:
    """Integral of s''' squared over the turn, of polynomials: Gauss, exact up to degree 9."""
    places, weights = np.polynomial.legendre.leggauss(5)
    total = 0.0
    for first, last in zip(plan.joints_deg[:-1], plan.joints_deg[1:], strict=True):
        start, end = math.radians(float(first)), math.radians(float(last))
        angles = 0.5 * (start + end) + 0.5 * (end - start) * places
        total += 0.5 * (end - start) * float(weights @ plan.jet(angles)[3] ** 2)
    return total


ASKED = st.fixed_dictionaries(
    {"first": st.integers(20, 120), "second": st.integers(20, 120)}
    | {name: st.floats(5.0, 30.0) for name in ("low", "high")}
)


def chain(asked: dict[str, float], **also: float) -> list[Request]:
    """Up in two steps from a rest and back to it; `also` is stated where the steps meet."""
    first, second = asked["first"], asked["second"]
    return [
        rest(30),
        move(first, asked["low"], "polynomial-5", **also),
        move(second, asked["low"] + asked["high"], "polynomial-5"),
        move(330 - first - second, 0.0, "polynomial-5"),
    ]


@given(asked=ASKED, change=st.floats(0.01, 0.5), sign=st.sampled_from([-1.0, 1.0]))
@attack
def test_what_is_inferred_has_the_least_jerk(
    asked: dict[str, float], change: float, sign: float
) -> None:
    """Stated otherwise, the integral of s''' squared is larger."""
    plan = planned(*chain(asked))
    joint = joints(plan)[2]
    velocity, acceleration = float(joint.left[1]), float(joint.left[2])
    stated = planned(*chain(asked, velocity=velocity, acceleration=acceleration))
    least = energy(plan)
    assert energy(stated) == pytest.approx(least, rel=1e-9)
    size = abs(velocity) + abs(acceleration)
    other = planned(*chain(asked, velocity=velocity + sign * change * size))
    assert energy(other) > least
    other = planned(*chain(asked, velocity=velocity, acceleration=acceleration + change * size))
    assert energy(other) > least


@given(asked=ASKED)
@attack
def test_points_and_polynomials_are_the_same_motion(asked: dict[str, float]) -> None:
    """A move through a point is two quintics that meet as smoothly as can be."""
    moves = chain(asked)
    first, second = asked["first"], asked["second"]
    way = float(first / (first + second))
    points: list[Request] = [
        rest(30),
        through(first + second, asked["low"] + asked["high"], (way, asked["low"])),
        moves[3],
    ]
    angles = np.linspace(0.0, 6.28, 63)
    one, other = planned(*moves).jet(angles), planned(*points).jet(angles)
    for order in range(4):
        size = np.max(np.abs(one[order]))
        # The point's place is the share of the span, rounded; the solve takes 1e-12.
        assert np.max(np.abs(one[order] - other[order])) <= 1e-9 * size


def test_a_law_stated_in_full_decides_its_turn_and_the_neighbour_meets_it() -> None:
    plan = planned(
        rest(60),
        move(120, 20.0, "modified-trapezoid", parameters={"inflection": 0.526}),
        move(180, 0.0, "harmonic-combination"),
    )
    law = make_law("modified-trapezoid", "R-U", inflection=0.526)
    wanted = law.end.acceleration * 20.0 / math.radians(120.0) ** 2
    joint = at(plan, 180.0)
    assert joint.order >= 2
    assert joint.left[2] == pytest.approx(wanted, rel=1e-13)
    assert joint.right[2] == pytest.approx(wanted, rel=1e-12)


@pytest.mark.parametrize("balance", ["acceleration", "jerk", "moment"])
def test_a_balanced_law_decides_its_turn(balance: str) -> None:
    plan = planned(
        rest(60), move(120, 20.0, "harmonic-combination", balance=balance), move(180, 0.0)
    )
    wanted = {"acceleration": 0.5, "jerk": 2.0 / 3.0, "moment": 0.528787514567007}[balance]
    assert move_of(plan, 1).law.parameters["inflection"] == pytest.approx(wanted, abs=1e-14)
    assert at(plan, 180.0).order >= 2


def test_the_gentlest_law_meets_the_sharpest() -> None:
    """Of two laws of one parameter the one that turns more sharply decides, wherever it stands."""
    for requests in (
        [move(298, 20.0, "simple-sine"), move(62, 0.0, "simple-sine")],
        [move(62, 20.0, "simple-sine"), move(298, 0.0, "simple-sine")],
    ):
        plan = planned(*requests)
        short = [move_of(plan, k).law for k in (0, 1) if plan.segments[k].span == 62]
        assert [law.parameters["inflection"] for law in short] == [0.5]
        assert sorted(joint.order >= 2 for joint in joints(plan)) == [False, True]


def test_an_inferred_turn_suits_its_neighbouring_laws() -> None:
    """Left alone the integral of s''' squared would turn the wrong way round here."""
    plan = planned(
        move("153.7", 20.0, "sine-straight"),
        through("145.2", 0.0, (0.5, 6.42)),
        move("13.5", 10.0),
        move("47.6", 0.0),
    )
    for joint in joints(plan):
        assert joint.order >= 2
    assert joints(plan)[0].right[2] > 0.0
    assert joints(plan)[1].left[2] < 0.0


@given(asked=ASKED)
@attack
def test_once_a_turn_is_made_sharper_the_rest_is_still_the_smoothest(
    asked: dict[str, float],
) -> None:
    """Joints between polynomials keep s''' continuous next to a turn that a law decides."""
    first, second = asked["first"], asked["second"]
    plan = planned(
        move(first, 20.0, "sine-straight"),
        move(second, 10.0, "polynomial-5"),
        move(360 - first - second, 0.0, "polynomial-5"),
    )
    assert joints(plan)[2].order == 3


def test_stated_values_of_points_are_met() -> None:
    plan = planned(
        rest(60),
        through(120, 20.0, (0.25, 4.0), (0.5, 12.0), given={0: (9.0, -3.0), 1: (None, 2.0)}),
        move(180, 0.0),
    )
    assert laws(plan)[:2] == ["rest", "data"]
    inner = plan.jet(np.radians([90.0, 120.0]))
    assert list(inner[:3, 0]) == pytest.approx([4.0, 9.0, -3.0], rel=1e-12)
    assert [inner[0, 1], inner[2, 1]] == pytest.approx([12.0, 2.0], rel=1e-12)
    assert data_of(plan, 1).report is None


# Tables ----------------------------------------------------------------------------------------


def wave(count: int) -> np.ndarray[tuple[int], np.dtype[np.float64]]:
    """A closed lift of two waves, the last row the first one again."""
    x = np.linspace(0.0, TURN, count)
    lift = 10.0 * (1.0 - np.cos(x)) + 2.0 * np.sin(2.0 * x)
    lift[-1] = lift[0]
    return lift


def test_a_table_of_a_turn_passes_every_row_and_closes_smoothly() -> None:
    rows = wave(73)
    plan = planned(table(360, rows))
    phi = np.linspace(0.0, TURN, 73)
    assert plan.jet(phi[:-1])[0] == pytest.approx(rows[:-1] - rows[0], abs=1e-12)
    (joint,) = joints(plan)
    assert joint.order == 3, "the seam is no joint for a periodic spline"
    assert len(plan.breaks) == 0
    assert len(plan.borders) == 72, "but the polynomial changes at every row"
    report = data_of(plan, 0).report
    assert report is not None
    assert report.largest_deviation <= 1e-12


def test_a_smoothed_table_stays_within_what_is_allowed_and_is_smoother() -> None:
    noise = 1e-3 * np.sin(1e4 * np.arange(181.0) ** 2)
    noise[-1] = noise[0]
    rows = wave(181) + noise
    rough, smooth = planned(table(360, rows)), planned(table(360, rows, smoothing=2e-3))
    phi = np.linspace(0.0, TURN, 2000)
    found = data_of(smooth, 0).report
    assert found is not None
    rows_at = smooth.jet(np.linspace(0.0, TURN, 181)[:-1])[0]
    worst = np.max(np.abs(rows_at - (rows[:-1] - rows[0])))
    assert found.largest_deviation == pytest.approx(worst, abs=1e-12)
    assert worst <= 2e-3
    jerk_of = [np.max(np.abs(plan.jet(phi)[3])) for plan in (rough, smooth)]
    true = np.max(np.abs(-10.0 * np.sin(phi) - 16.0 * np.cos(2.0 * phi)))
    assert jerk_of[0] > 20.0 * true, "passing every row follows the noise"
    assert jerk_of[1] < 2.0 * true


def test_a_table_gives_its_neighbours_its_values() -> None:
    """The spline, free where its neighbour does not rest, decides; the next law adopts that."""
    x = np.linspace(0.0, 1.0, 31)
    rows = 8.0 * x**3 * (4.0 - 3.0 * x)
    plan = planned(rest(60), table(90, rows), move(210, 0.0))
    assert laws(plan)[1] == "data"
    start, end = joints(plan)[1:3]
    assert (start.before, start.after, start.order >= 2) == ("R", "R", True)
    assert end.order >= 2
    length = math.radians(90.0)
    own = clamped_spline(x, rows, start=(0.0, 0.0)).values(np.ones(1), 2, "left")[:, 0]
    assert end.left[1] == pytest.approx(own[1] / length, rel=1e-9)
    assert end.right[2] == pytest.approx(own[2] / length**2, rel=1e-9)


def test_two_tables_meet_smoothly() -> None:
    first = np.array([0.0, 2.0, 5.0, 7.0, 8.0])
    plan = planned(table(180, first), table(180, first[::-1]))
    assert all(joint.order >= 2 for joint in joints(plan))


def test_a_table_that_does_not_return_is_reported() -> None:
    with pytest.raises(GeometryError, match="ends at 3") as caught:
        planned(rest(60), table(300, [0.0, 1.0, 2.0, 3.0]))
    assert caught.value.key.startswith("motion")


@pytest.mark.parametrize(
    ("before", "words"),
    [((), "off where it would close"), ((rest(0),), "the last row lies 0.5 off the first one")],
)
def test_a_turn_that_does_not_close_is_reported(before: tuple[Request, ...], words: str) -> None:
    with pytest.raises(GeometryError, match=words) as caught:
        planned(*before, table(360, [0.0, 1.0, 2.0, 1.0, 0.5]))
    assert caught.value.key == f"motion[{len(before) + 1}].file"


@pytest.mark.parametrize("closing", [True, False])
def test_a_table_of_a_turn_rests_at_a_rest_of_no_length(closing: bool) -> None:
    """Whether it has its closing row or not."""
    count = 73 if closing else 72
    rows, shares = wave(73), np.arange(73) / 72
    plan = planned(rest(0), TableRequest(Decimal(360), shares[:count], rows[:count], None))
    assert not np.any(plan.jet(np.zeros(1))[:3])
    assert plan.jet(np.zeros(1), "left")[:3] == pytest.approx(np.zeros((3, 1)), abs=1e-9)
    assert plan.jet(TURN * shares[:-1])[0] == pytest.approx(rows[:-1], abs=1e-12)
