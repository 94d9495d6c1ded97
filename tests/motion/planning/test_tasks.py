"""The motion task of every joint, its velocity and acceleration: stated, fixed by a neighbour or
inferred; refusals with their reasons.
"""

from __future__ import annotations

import math
import re
from decimal import Decimal
from heapq import heappop

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from camgeo.errors import GeometryError
from camgeo.kinematics.laws import FAMILIES, make_law
from camgeo.kinematics.motion import TASKS
from camgeo.kinematics.plan import Joint, MotionPlan, joints
from camgeo.kinematics.planning.planner import plan_motion
from camgeo.kinematics.planning.requests import PositionUnit, Request, TableRequest
from camgeo.kinematics.splines import Spline
from camgeo.units import TURN
from tests.motion.planning.wishes import data_of, laws, move, move_of, planned, rest, table, through
from tests.strategies import attack


@pytest.mark.parametrize(
    ("requests", "wanted"),
    [
        # rests
        ([rest(60), move(90, 20.0), rest(60), move(150, 0.0)], ["R-R", "R-R"]),
        ([move(120, 20.0), rest(0), move(240, 0.0), rest(0)], ["R-R", "R-R"]),
        # one turn between two rests, or none
        ([rest(60), move(120, 20.0), move(180, 0.0)], ["R-U", "U-R"]),
        ([move(120, 20.0), move(240, 0.0)], ["U-U", "U-U"]),
        # a motion that goes on
        ([rest(60), move(120, 20.0), move(120, 30.0), move(60, 0.0)], ["R-B", "B-U", "U-R"]),
        ([rest(60), move(120, 20.0), move(120, 20.0), move(60, 0.0)], ["R-U", "U-U", "U-R"]),
        # straight lines
        (
            [rest(40), move(60, 5.0), move(40, 15.0, "straight-line"), move(220, 0.0)],
            ["R-G", "G-G", "G-R"],
        ),
        (
            [move(60, 5.0), move(40, 15.0, "straight-line"), move(60, 25.0), move(200, 0.0)],
            ["U-G", "G-G", "G-U", "U-U"],
        ),
        # laws that leave no choice
        ([move(120, 20.0, "polynomial-345"), move(240, 0.0)], ["R-R", "R-R"]),
        ([move(120, 20.0, "sine-straight"), move(240, 0.0)], ["U-U", "U-U"]),
        ([rest(60), move(120, 20.0, "harmonic-combination"), move(180, 0.0)], ["R-U", "U-R"]),
        ([rest(60), move(120, 20.0, "double-harmonic"), move(180, 0.0)], ["R-U", "U-R"]),
        ([move(120, 20.0, "simple-sine"), move(240, 0.0)], ["U-U", "U-U"]),
        # a turn between laws, where they have one; the sharpest first
        (
            [move(60, 20.0, "modified-trapezoid"), move(60, 0.0, "modified-trapezoid"), rest(240)],
            ["R-U", "U-R"],
        ),
        ([move(60, 20.0, "modified-trapezoid"), move(60, 0.0), rest(240)], ["R-U", "U-R"]),
        (
            [
                move(60, 20.0, "modified-trapezoid"),
                move(60, 0.0, "modified-trapezoid"),
                move(120, 20.0, "modified-trapezoid"),
                move(120, 0.0, "modified-trapezoid"),
            ],
            ["R-U", "U-R", "R-U", "U-R"],
        ),
        # but not beside a polynomial, nor where the motion continues
        (
            [move(60, 20.0, "modified-trapezoid"), move(60, 0.0, "polynomial-5"), rest(240)],
            ["R-R", "R-R"],
        ),
        (
            [move(60, 20.0, "modified-trapezoid"), move(60, 30.0, "modified-trapezoid"), rest(60),
             move(120, 0.0), rest(60)],
            ["R-R", "R-R", "R-R"],
        ),
        # nor where nothing else would fit
        (
            [move(200, 20.0, "modified-trapezoid"), move(160, 0.0, "simple-sine")],
            ["R-R", "R-R"],
        ),
        ([rest(60), move(120, 20.0, "simple-sine"), move(180, 0.0)], ["R-R", "R-R"]),
        # stated
        ([rest(60), move(120, 20.0, velocity=3.0), move(180, 0.0)], ["R-B", "B-R"]),
        (
            [rest(60), move(120, 20.0, velocity=3.0, acceleration=0.0), move(180, 0.0)],
            ["R-G", "G-R"],
        ),
        ([rest(60), move(120, 20.0, acceleration=0.0), move(180, 0.0)], ["R-R", "R-R"]),
        ([rest(60), move(120, 20.0, velocity=0.0), move(180, 0.0)], ["R-U", "U-R"]),
        (
            [rest(60), move(120, 20.0, velocity=0.0), move(100, 30.0), rest(0), move(80, 0.0)],
            ["R-U", "U-R", "R-R"],
        ),
        (
            [rest(60), move(120, 20.0, "modified-sine", velocity=3.0), move(180, 0.0)],
            ["R-G", "G-R"],
        ),
    ],
)  # fmt: skip
def test_tasks_are_derived(requests: list[Request], wanted: list[str]) -> None:
    found = [name.split()[-1] for name in laws(planned(*requests))]
    assert [task for task in found if task in TASKS] == wanted


def test_a_move_that_stays_where_it_is_between_rests_rests() -> None:
    plan = planned(rest(60), move(120, 0.0, "modified-sine"), rest(180))
    assert len(plan.dwells) == 1
    assert plan.dwells[0].span == 2.0 * math.pi


@pytest.mark.parametrize(
    "requests",
    [
        [move(360, 0.0)],
        [move(100, 0.0), move(260, 0.0, "polynomial-7")],
        [move(100, 0.0, "polynomial-5"), rest(100), move(160, 0.0)],
        [move(100, 0.0, velocity=0.0), rest(260)],
        [through(360, 0.0, (0.2, 0.0), (0.7, 0.0))],
        [table(100, [0.0, 0.0, 0.0]), move(260, 0.0)],
        [table(360, [0.0, 0.0, 0.0, 0.0])],
    ],
)
def test_what_nothing_moves_rests(requests: list[Request]) -> None:
    """It is planned as a dwell: proving the fit of a curve without movement takes seconds."""
    (dwell,) = planned(*requests).dwells
    assert dwell.span == 2.0 * math.pi


@pytest.mark.parametrize("law", ["polynomial-7", "polynomial"])
def test_a_jerk_stated_between_rests_is_met_without_a_stroke(law: str) -> None:
    plan = planned(rest(60), move(120, 0.0, law, jerk=3.0), rest(180))
    ends = np.radians([60.0, 180.0])
    assert plan.jet(ends[1:], "left")[:, 0] == pytest.approx([0.0, 0.0, 0.0, 3.0], abs=1e-14)
    assert list(plan.jet(ends[:1])[:3, 0]) == [0.0, 0.0, 0.0]
    assert len(planned(rest(60), move(120, 0.0, law, jerk=0.0), rest(180)).dwells) == 1


@pytest.mark.parametrize("law", ["polynomial-5", "polynomial-7", "polynomial", "auto"])
def test_a_move_that_returns_within_itself_keeps_what_is_stated(law: str) -> None:
    jerk = {"jerk": 3.0} if law in ("polynomial-7", "polynomial") else {}
    plan = planned(
        rest(60),
        move(60, 10.0, "polynomial-7", velocity=5.0, acceleration=-2.0, jerk=7.0),
        move(30, 10.0, law, velocity=-5.0, acceleration=1.0, **jerk),
        move(210, 0.0),
    )
    ends = [math.radians(120.0), math.radians(150.0)]
    right, left = plan.jet(np.array(ends)), plan.jet(np.array(ends), "left")
    assert list(right[:, 0][:3]) == pytest.approx([10.0, 5.0, -2.0], rel=1e-12)
    assert list(left[:, 1][:3]) == pytest.approx([10.0, -5.0, 1.0], rel=1e-12)
    if jerk:
        assert right[3, 0] == pytest.approx(7.0, rel=1e-9)
        assert left[3, 1] == pytest.approx(3.0, rel=1e-9)


MM = PositionUnit("mm", 1.0)

FAULTS: list[tuple[list[Request], str, str, str]] = [
    # a rest next to a stated value
    (
        [rest(60), move(120, 20.0, velocity=3.0), rest(60), move(120, 0.0)],
        "motion[2].velocity",
        "3 mm/rad",
        r"must be 0 at the end of a move that meets a rest \(or be left out\)",
    ),
    (
        [rest(60), move(120, 20.0, acceleration=-3.0), rest(0), move(180, 0.0)],
        "motion[2].acceleration",
        "-3 mm/rad^2",
        "must be 0 at the end of a move that meets a rest",
    ),
    # a straight line
    (
        [rest(60), move(90, 5.0, velocity=3.0), move(90, 15.0, "straight-line"), move(120, 0.0)],
        "motion[2].velocity",
        "3",
        "contradicts the straight line at this joint, whose velocity is 6.3662 mm/rad; leave it",
    ),
    (
        [
            rest(60),
            move(90, 5.0),
            move(90, 15.0, "straight-line", acceleration=1.0),
            move(120, 0.0),
        ],
        "motion[3].acceleration",
        "1",
        r"contradicts the straight line at this joint, whose acceleration is 0 mm/rad\^2",
    ),
    (
        [rest(60), move(90, 5.0, "straight-line", velocity=0.0), rest(90), move(120, 0.0)],
        "motion[2].velocity",
        "0",
        "contradicts the straight line at this joint, whose velocity is 3.1831 mm/rad",
    ),
    # a law that is not made for it
    (
        [
            rest(40),
            move(60, 5.0, "polynomial-345"),
            move(40, 15.0, "straight-line"),
            move(220, 0.0),
        ],
        "motion[2].law",
        "polynomial-345",
        (r"is made for R-R \(R rest, U reversal, G constant velocity, B general motion\); here the"
        r" move goes from rest to constant velocity \(R-G\), for which there are modified-sine,"
        " polynomial-5, polynomial-7, auto"),
    ),
    (
        [rest(40), move(60, 5.0, "sine-straight"), move(260, 0.0)],
        "motion[2].law",
        "sine-straight",
        r"from rest to rest or reversal \(R-R, R-U\), for which there are .*harmonic-combination",
    ),
    (
        [move(60, 5.0, "double-harmonic", velocity=2.0), move(300, 0.0)],
        "motion[1].law",
        "double-harmonic",
        "here the move goes from",
    ),
    # no stroke
    (
        [move(60, 5.0), move(60, 5.0, "sine-straight"), move(240, 0.0)],
        "motion[2].law",
        "sine-straight",
        "cannot make a move that ends where it starts; polynomial-5 and auto can, and a dwell",
    ),
    (
        [move(360, 0.0, "harmonic-combination")],
        "motion[1].law",
        "harmonic-combination",
        "cannot make a move",
    ),
    # a turn that the law cannot make
    (
        [rest(60), move(120, 20.0, "harmonic-combination", acceleration=-4.0), move(180, 0.0)],
        "motion[2].acceleration",
        "-4 mm/rad^2",
        (r"over 120 degrees and 20 mm, harmonic-combination for R-U ends with an acceleration below"
        r" -11.25 mm/rad\^2, but -4 mm/rad\^2 is needed here; polynomial-5 and auto meet any"),
    ),
    (
        [
            rest(60),
            move(120, -20.0, "auto", acceleration=4.0),
            move(120, 0.0, "modified-trapezoid"),
            rest(60),
        ],
        "motion[2].acceleration",
        "4 mm/rad^2",
        (r"over 120 degrees and 20 mm, modified-trapezoid for U-R starts with an acceleration above"
        r" 9.22816 mm/rad\^2, but 4 mm/rad\^2 is needed here"),
    ),
    (
        [move(180, 20.0, "sine-straight", acceleration=3.0), move(180, 0.0)],
        "motion[1].acceleration",
        "3 mm/rad^2",
        r"sine-straight for U-U ends with an acceleration below -5 mm/rad\^2, but 3 mm/rad",
    ),
    (
        [
            move(180, 20.0, "sine-straight", acceleration=-30.0),
            move(180, 0.0, acceleration=3.0),
        ],
        "motion[2].acceleration",
        "3 mm/rad^2",
        r"sine-straight for U-U starts with an acceleration above 5 mm/rad\^2, but 3 mm/rad",
    ),
    (
        [rest(60), move(100, 10.0, "harmonic-combination"), move(200, 30.0, "simple-sine"), rest(0),
         ],
        "motion",
        "",
        "ends at 30 mm",
    ),
    (
        [
            move(60, 10.0, "sine-straight"),
            move(60, 30.0, "sine-straight"),
            move(240, 0.0, "sine-straight"),
        ],
        "motion[1].law",
        "",
        "would stop for a moment at its end and then continue in the same direction",
    ),
    # stated, but the law has no freedom left
    (
        [move(60, 10.0, "simple-sine", velocity=0.0, acceleration=0.0), rest(60), move(240, 0.0)],
        "motion[1].acceleration",
        "0 mm/rad^2",
        r"cannot be met by simple-sine for R-R of motion\[1\], whose acceleration there is -45",
    ),
    (
        [
            move(90, 10.0, "simple-sine", acceleration=-30.0),
            move(90, 0.0, "simple-sine", acceleration=40.0),
            move(90, 10.0, "simple-sine", acceleration=-30.0),
            move(90, 0.0, "simple-sine", acceleration=40.0),
        ],
        "motion[",
        "",
        r"cannot be met by simple-sine for U-U",
    ),
    (
        [move(60, 10.0, "polynomial-5", jerk=3.0), move(300, 0.0)],
        "motion[1].jerk",
        "3",
        "is met only by polynomial-7 and polynomial; leave it out or name one of them",
    ),
    # numbers
    ([move(60, 10.0), move(300, 1.0)], "motion", "", "starts at 0 and ends at 1 mm, so it does"),
    ([move(60, 10.0), move(299, 0.0)], "motion", "359", "add up to 359 degrees"),
    ([move(0, 10.0), move(360, 0.0)], "motion[1].span", "0", "cannot change the position"),
    (
        [move("0.0001", 1.0, "polynomial-5"), move("359.9999", 0.0)],
        "motion[1].span",
        "0.0001",
        "is too short",
    ),
    (
        [through("0.001", 0.0, (0.2, 1.0), (0.4, 0.0)), move("359.999", 0.0)],
        "motion[1].points",
        "",
        "has points that are too close together beside the moves",
    ),
    (
        [move("359.999999", 5.0, "modified-trapezoid"), move("0.000001", 0.0)],
        "motion[1].law",
        "modified-trapezoid",
        r"speed up or slow down within .*e-1\d degrees of its 360, .* allowed: 8.1e-13 or more\.",
    ),
    ([table(360, [0.0, 5.0, 1.0])], "motion[1].file", "1.0", "the last point lies 1 away"),
    # parameters
    (
        [move(60, 10.0, "sine-straight", parameters={"sine": 0.5}), move(300, 0.0)],
        "motion[1].sine",
        "0.5",
        "takes no sine; its parameters",
    ),
    (
        [rest(60), move(120, 10.0, parameters={"inflection": 0.4}), move(180, 0.0)],
        "motion[2].inflection",
        "auto",
        "no law for R-U with inflection = 0.4 meets .* leave those parameters out, or",
    ),
]  # fmt: skip


@pytest.mark.parametrize(
    ("requests", "key", "value", "words"), FAULTS, ids=[f"{f[1]} {f[3][:40]}" for f in FAULTS]
)
def test_the_impossible_is_refused(
    requests: list[Request], key: str, value: str, words: str
) -> None:
    with pytest.raises(GeometryError) as caught:
        plan_motion(requests, MM)
    assert caught.value.key.startswith(key)
    assert re.search(words, caught.value.message), caught.value.message
    if value:
        assert caught.value.value.startswith(value)


def test_messages_are_in_the_unit_of_the_scene() -> None:
    requests: list[Request] = [
        rest(60),
        move(120, math.radians(20.0), "harmonic-combination", acceleration=math.radians(-4.0)),
        move(180, 0.0),
    ]
    with pytest.raises(GeometryError, match=r"20 deg, .* below -11\.25 deg/rad\^2") as caught:
        plan_motion(requests, PositionUnit("deg", math.radians(1.0)))
    assert caught.value.value == "-4 deg/rad^2"
    requests = [move(90, 25.4, velocity=3.0), move(90, 50.8, "straight-line"), move(180, 0.0)]
    with pytest.raises(GeometryError, match=r"velocity is 0\.63662 inch/rad"):
        plan_motion(requests, PositionUnit("inch", 25.4))
    with pytest.raises(GeometryError, match=r"velocity is 16\.1701 per rad"):
        plan_motion(requests)


def test_the_suggested_acceleration_works() -> None:
    """What the message names as possible is possible, on its side and no further."""

    def asked(acceleration: float) -> list[Request]:
        return [
            rest(60),
            move(120, 20.0, "modified-trapezoid", acceleration=acceleration),
            move(180, 0.0),
        ]

    with pytest.raises(GeometryError) as caught:
        plan_motion(asked(-1.0), MM)
    reported = re.search(r"below (\S+) mm", caught.value.message)
    assert reported is not None
    bound = float(reported[1])
    assert laws(planned(*asked(bound * (1.0 + 1e-4))))[1] == "modified-trapezoid R-U"
    with pytest.raises(GeometryError):
        planned(*asked(bound * (1.0 - 1e-4)))


@pytest.mark.parametrize("law", [name for name in FAMILIES if name != "straight-line"])
def test_a_law_that_does_not_fit_has_a_substitute_that_does(law: str) -> None:
    """After a straight line into a rest; each law that a message names is a way out."""

    def asked(name: str) -> list[Request]:
        return [rest(60), move(60, 5.0), move(60, 15.0, "straight-line"),
                move(120, 30.0, name), rest(0), move(60, 0.0)]  # fmt: skip

    try:
        planned(*asked(law))
    except GeometryError as error:
        reported = re.search(r"for which there are (.*)$", error.message)
        assert reported is not None
        names = reported[1].split(", ")
        assert law not in names
        for name in names:
            planned(*asked(name))
    else:
        assert "G-R" in FAMILIES[law].tasks or law == "polynomial"


def test_spans_of_many_digits_are_kept() -> None:
    plan = planned(rest("60.000000000000000000001"), move("299.999999999999999999999", 0.0))
    assert plan.joints_deg[1] == Decimal("60.000000000000000000001")


def test_tasks_of_many_segments_are_settled_in_time_in_proportion(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def looks(count: int) -> int:
        """How often a plan of so many named laws looks at a link."""
        seen = []

        def counted(due: list[int]) -> int:
            seen.append(due[0])
            return heappop(due)

        monkeypatch.setattr("camgeo.kinematics.planning.planner.heapq.heappop", counted)
        planned(
            *(move(Decimal(360) / count, float(1 - k % 2), "modified-sine") for k in range(count))
        )
        return len(seen)

    assert looks(160) <= 8.5 * looks(20)


# Velocities and accelerations of joints -----------------------------------------------------------


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
        through(120, 20.0, (0.25, 4.0), (0.5, 12.0), boundaries={0: (9.0, -3.0), 1: (None, 2.0)}),
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
    own = Spline.clamped(x, rows, start=(0.0, 0.0)).values(np.ones(1), 2, "left")[:, 0]
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
    [
        ((), "away from where it would close"),
        ((rest(0),), "the last row differs from the first one by 0.5"),
    ],
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
