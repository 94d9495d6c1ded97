"""Turns determined by their neighbouring laws: how sharp they are, and that no jump remains."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from camgeo.errors import GeometryError
from camgeo.kinematics.laws import FAMILIES, make_law
from camgeo.kinematics.laws.law import Law, acceleration_jumps, characteristic
from camgeo.kinematics.plan import MotionPlan, joints
from camgeo.kinematics.planning.build import (
    best_law,
    best_reversal,
    criterion_size,
    equal_accelerations,
)
from camgeo.kinematics.planning.requests import CRITERIA, Request
from camgeo.kinematics.time_course import ConstantSpeed, plan_extremes
from tests.long_form import examples
from tests.motion.planning.wishes import laws, move, move_of, planned, rest, through
from tests.strategies import attack


def largest(plan: MotionPlan) -> float:
    """The largest acceleration."""
    return plan_extremes(plan, ConstantSpeed(1.0), "mm").acceleration.magnitude


def test_two_trapezoids_that_turn_back_need_no_rest_between_them() -> None:
    """A rise that states its inflection point decides the turn; the return meets it.

    From rest to
    rest both would have 4.888 S/Phi^2 (VDI 2143-1, Tafel 2), at a turn 4.460.
    """
    requests: list[Request] = [
        move(120, 10.0, "modified-trapezoid", balance="acceleration"),
        move(120, 0.0, "modified-trapezoid"),
        rest(120),
    ]
    plan = planned(*requests)
    assert laws(plan)[:2] == ["modified-trapezoid R-U", "modified-trapezoid U-R"]
    assert largest(plan) == pytest.approx(4.4603 * 10.0 / math.radians(120.0) ** 2, rel=1e-4)
    assert joints(plan)[1].order >= 2


@pytest.mark.parametrize("law", ["auto", "modified-trapezoid", "harmonic-combination"])
@pytest.mark.parametrize("back", [120, 60])
def test_a_turn_between_laws_suits_the_one_that_turns_more_sharply(law: str, back: int) -> None:
    """A turn stated less or more sharply makes the largest acceleration larger."""

    def asked(acceleration: float | None = None) -> list[Request]:
        rise = move(120, 10.0, law, acceleration=acceleration)
        return [rest(240 - back), rise, move(back, 0.0, law)]

    plan = planned(*asked())
    turn = float(joints(plan)[2].left[2])
    least = largest(plan)
    assert least == pytest.approx(abs(turn), rel=1e-12)
    for factor in (0.8, 0.95, 0.99, 1.01, 1.05, 1.25):
        try:
            other = planned(*asked(factor * turn))
        except GeometryError:
            continue  # too gentle for any inflection point
        assert largest(other) > least


@attack
@given(
    there=st.integers(20, 150),
    back=st.integers(20, 150),
    rests=st.booleans(),
    factor=st.floats(0.3, 3.0),
)
def test_auto_with_a_turn_has_nearly_the_least_acceleration(
    there: int, back: int, rests: bool, factor: float
) -> None:
    """Whatever the turn is stated to be; after the move comes a rest or another turn."""
    end = 360 - there - back
    ends = [rest(end)] if rests else [move(end / 2, 6.0), move(end / 2, 0.0)]
    plan = planned(move(there, 10.0), move(back, 0.0), *ends)
    turn = float(joints(plan)[1].left[2])
    stated = planned(move(there, 10.0, acceleration=factor * turn), move(back, 0.0), *ends)
    assert largest(plan) <= 1.01 * largest(stated)


@pytest.mark.parametrize("criterion", CRITERIA)
@pytest.mark.parametrize("task", ["R-U", "U-U", "G-U"])
def test_the_best_turn_is_the_best(task: str, criterion: str) -> None:
    """The best of all turns from half to four times as sharp; for the velocity, within a fifth."""
    known = {"v0": 0.5} if task == "G-U" else {}
    v0 = known.get("v0", 0.0)
    found = best_reversal(task, v0, 0.0, ((criterion, 1.0),))
    assert found is not None
    sizes = []
    for factor in (1.0, *np.geomspace(0.5, 4.0, examples(9, long=24))):
        ends = {"a1": factor * found[1]} | ({"a0": factor * found[0]} if task == "U-U" else {})
        law = best_law(task, known | ends, {}, {criterion: 1.0})
        sizes.append(criterion_size(characteristic(law), criterion))
    assert sizes[0] <= (1.2 if criterion == "velocity" else 1.001) * min(sizes)
    mirrored = best_reversal(task[::-1], 0.0, v0, ((criterion, 1.0),))
    assert mirrored == (-found[1], -found[0])


@pytest.mark.parametrize(("there", "back"), [(120, 120), (60, 150), (120, 40)])
def test_auto_with_a_turn_has_nearly_the_least_jerk(there: int, back: int) -> None:
    """A turn that suits the shorter move alone would cost the longer one four times as much."""

    def jerk(acceleration: float | None = None) -> float:
        plan = planned(
            move(there, 10.0, acceleration=acceleration, optimise={"jerk": 1.0}),
            move(back, 0.0, optimise={"jerk": 1.0}),
            rest(360 - there - back),
        )
        return plan_extremes(plan, ConstantSpeed(1.0), "mm").jerk.magnitude

    sharpest = -10.0 * 10.0 / math.radians(min(there, back)) ** 2
    assert jerk() <= 1.12 * min(
        jerk(factor * sharpest) for factor in np.geomspace(0.1, 1.2, examples(8, long=16))
    )


def test_beside_a_named_law_the_jerk_takes_the_smoothest_turn() -> None:
    """Two quintics with the least integral of s''' squared: f'' = -20/3 at the turn."""
    asked = move(120, 10.0, optimise={"jerk": 1.0}), move(120, 0.0, "harmonic-combination")
    plan = planned(rest(120), *asked)
    wanted = -20.0 / 3.0 * 10.0 / math.radians(120.0) ** 2
    assert joints(plan)[2].left[2] == pytest.approx(wanted, rel=1e-12)


@attack
@given(
    share=st.floats(0.05, 0.95),
    name=st.sampled_from(["inflection", "curved"]),
    spans=st.tuples(st.integers(30, 150), st.integers(30, 150)),
    middle=st.floats(-20.0, 8.0),
)
def test_a_law_with_one_choice_leaves_no_jump_beside_what_joins_to_any(
    share: float, name: str, spans: tuple[int, int], middle: float
) -> None:
    """One turn of a sine-straight combination then follows from the other."""
    plan = planned(
        move(spans[0], 18.0, "polynomial-5"),
        move(spans[1], 8.0, "sine-straight", parameters={name: share}),
        through(360 - spans[0] - spans[1], 0.0, (0.5, middle)),
    )
    assert move_of(plan, 1).law.parameters[name] == pytest.approx(share, rel=1e-9)
    assert min(joint.order for joint in joints(plan)) >= 2


@pytest.mark.parametrize("inflection", [0.24, 0.76])
def test_no_jump_beside_a_quintic(inflection: float) -> None:
    """The law is as gentle as it can be: what meets any turn never needs a sharper one."""
    plan = planned(
        move(60, 18.0, "polynomial-5"),
        move(220, 16.0, "polynomial-5"),
        move(80, 0.0, "sine-straight", parameters={"inflection": inflection}),
    )
    assert min(joint.order for joint in joints(plan)) >= 2
    assert move_of(plan, 2).law.parameters["curved"] == pytest.approx(1.0, abs=1e-6)


def test_a_law_with_one_choice_turns_as_sharply_as_its_neighbour_needs() -> None:
    """The neighbour cannot turn as gently as the law with one choice."""
    plan = planned(
        move(180, 18.0, "polynomial-5"),
        move(140, -10.0, "sine-straight", parameters={"inflection": 0.5}),
        move(40, 0.0, "sine-straight"),
    )
    assert min(joint.order for joint in joints(plan)) >= 2
    gentlest = 0.25 * math.pi**2 / 0.5 * 10.0 / math.radians(40.0) ** 2
    assert joints(plan)[2].left[2] >= gentlest * (1.0 - 1e-6)


@pytest.mark.parametrize("at_end", [False, True])
def test_a_stated_turn_decides_the_other_one(at_end: bool) -> None:
    """At either end of a law with one choice; a law that meets any turn adopts what follows."""
    first, last = (None, 150.0) if at_end else (-150.0, None)
    plan = planned(
        move(150, 18.0, "polynomial-5", acceleration=first),
        move(100, 8.0, "sine-straight", parameters={"inflection": 0.4}, acceleration=last),
        move(110, 0.0, "polynomial-5"),
    )
    found = joints(plan)
    assert min(joint.order for joint in found) >= 2
    assert found[1 + at_end].left[2] == pytest.approx(last if at_end else first, rel=1e-12)


def test_a_law_with_one_choice_beside_auto_leaves_no_jump() -> None:
    """The turn that suits auto gives way: the law keeps its middle, and auto meets its turn."""
    plan = planned(
        move(262, -5.0, "sine-straight", parameters={"curved": 0.15}), move(98, 0.0, "auto")
    )
    assert [joint.order >= 2 for joint in joints(plan)] == [True, True]


@pytest.mark.parametrize("first", [False, True])
def test_a_simple_sine_meets_the_sharper_turn_of_its_neighbour(first: bool) -> None:
    """The neighbour's gentlest turn over half the span is four times as sharp as the law's own."""
    ends: list[Request] = [move(135, 0.0, "polynomial-5"), move(90, 0.0, "polynomial-5")]
    laws_there = ("simple-sine", "sine-straight") if first else ("sine-straight", "simple-sine")
    spans = (90, 45) if first else (45, 90)
    plan = planned(move(spans[0], 5.0, laws_there[0]), move(spans[1], 0.0, laws_there[1]), *ends)
    turn = joints(plan)[1]
    assert turn.order >= 2
    gentlest = 0.5 * math.pi**2 * 5.0 / math.radians(45.0) ** 2
    assert turn.left[2] == pytest.approx(-gentlest, rel=1e-6)


@pytest.mark.parametrize("ratio", [1.0, 1e3, 1e7, 1e12])
def test_both_turns_of_a_sine_straight_combination_are_met_however_unequal(ratio: float) -> None:
    """Within the rounding of f''; the inflection point then lies 1e-12 from one end."""
    for a0, a1 in ((6.0, -6.0 * ratio), (6.0 * ratio, -6.0)):
        law = make_law("sine-straight", "U-U", a0=a0, a1=a1)
        assert law.start.acceleration == pytest.approx(a0, rel=1e-14)
        assert law.end.acceleration == pytest.approx(a1, rel=1e-14)


# The law that auto chooses ------------------------------------------------------------------------

Known = Mapping[str, float]

MESH = np.linspace(0.0, 1.0, 4001)


def sizes(law: Law) -> dict[str, float]:
    """Largest magnitudes on a mesh, both sides of each border: within 1e-5 of the exact ones."""
    _, f1, f2, f3 = law(np.concatenate([MESH, [x - 1e-12 for x in law.borders]]))
    values = {"velocity": f1, "acceleration": f2, "jerk": f3, "moment": f1 * f2}
    return {name: float(np.max(np.abs(each))) for name, each in values.items()}


def overshoots(law: Law) -> bool:
    f = law(MESH)[0]
    return bool(np.max(f) > 1.0 + 1e-7 or np.min(f) < -1e-7)


def smooth(law: Law, known: Known) -> bool:
    """The boundary values are met, and f'' has no jump inside."""
    met = (law.start.velocity, law.start.acceleration, law.end.velocity, law.end.acceleration)
    wanted = [known.get(key, 0.0) for key in ("v0", "a0", "v1", "a1")]
    if not np.allclose(met, wanted, rtol=1e-9, atol=1e-9):
        return False
    jumps = [abs(law(np.array([x]))[2][0] - law(np.array([x - 1e-12]))[2][0]) for x in law.borders]
    return max(jumps, default=0.0) < 1e-6 * max(1.0, sizes(law)["acceleration"])


def candidates(task: str, known: Known) -> list[Law]:
    """Every law of the registry that can be made for the task with these boundary values."""
    found = []
    for name, family in FAMILIES.items():
        if task not in family.tasks or name == "polynomial":
            continue
        taken = family.parameters[task]
        given: dict[str, Any] = {key: value for key, value in known.items() if key in taken}
        try:
            if "inflection" in taken and task in ("R-G", "G-R", "G-G"):
                given["inflection"] = equal_accelerations(name, task, given)
            law = make_law(name, task, **given)
        except GeometryError:
            continue
        if smooth(law, known):
            found.append(law)
    return [law for law in found if not overshoots(law)] or found


TASKS: list[tuple[str, tuple[str, ...]]] = [
    ("R-R", ()),
    ("R-U", ("a1",)),
    ("U-R", ("a0",)),
    ("U-U", ("a0", "a1")),
    ("R-G", ("v1",)),
    ("G-U", ("v0", "a1")),
    ("G-G", ("v0", "v1")),
    ("B-B", ("v0", "a0", "v1", "a1")),
]


@attack
@given(data=st.data(), criterion=st.sampled_from(CRITERIA))
def test_nothing_is_better(data: st.DataObject, criterion: str) -> None:
    task, keys = data.draw(st.sampled_from(TASKS))
    signs = {"a0": 1.0, "a1": -1.0, "v0": 1.0, "v1": 1.0}
    known = {key: signs[key] * data.draw(st.floats(0.2, 12.0)) for key in keys}
    chosen = best_law(task, known, {}, {criterion: 1.0})
    assert smooth(chosen, known)
    least = min(sizes(law)[criterion] for law in candidates(task, known))
    assert sizes(chosen)[criterion] <= least * (1.0 + 1e-4)


@pytest.mark.parametrize(
    ("criterion", "law"),
    [
        # Tafel 2 of VDI 2143-1, without the laws that jerk: least C_v and C_Mdyn modified sine,
        # least C_a modified trapezoid. The least f''' is the inclined sine's, 4 pi^2.
        ("velocity", "modified-sine"),
        ("acceleration", "modified-trapezoid"),
        ("jerk", "inclined-sine"),
        ("moment", "modified-sine"),
    ],
)
def test_from_rest_to_rest_it_is_the_one_the_guideline_names(criterion: str, law: str) -> None:
    plan = planned(rest(60), move(120, 20.0, optimise={criterion: 1.0}), rest(60), move(120, 0.0))
    assert laws(plan)[1] == f"{law} R-R"
    assert laws(plan)[3] == "modified-trapezoid R-R", "without a wish the acceleration counts"


def test_weights_trade_one_quantity_for_another() -> None:
    """Each counts as a multiple of the least there is; all weight on one end is that criterion."""
    jerk = best_law("R-R", {}, {}, {"jerk": 1.0, "acceleration": 1e-6})
    acceleration = best_law("R-R", {}, {}, {"jerk": 1e-6, "acceleration": 1.0})
    assert (jerk.name, acceleration.name) == ("inclined-sine", "modified-trapezoid")
    both = best_law("R-R", {}, {}, {"jerk": 0.5, "acceleration": 0.5})
    cost = {
        law.name: sizes(law)["jerk"] / (4.0 * math.pi**2)
        + sizes(law)["acceleration"] / sizes(acceleration)["acceleration"]
        for law in candidates("R-R", {})
    }
    assert cost[both.name] <= min(cost.values()) * (1.0 + 1e-4)


def test_a_stated_inflection_is_honoured() -> None:
    plan = planned(
        rest(60), move(120, 20.0, parameters={"inflection": 0.4}), rest(60), move(120, 0.0)
    )
    law = move_of(plan, 1).law
    assert law.parameters["inflection"] == 0.4
    assert law.inflection == 0.4


@pytest.mark.parametrize(
    ("name", "task"),
    [
        ("modified-trapezoid", "R-U"),
        ("modified-trapezoid", "U-R"),
        ("harmonic-combination", "U-R"),
        ("sine-straight", "U-U"),
        ("modified-sine", "R-R"),
    ],
)
@pytest.mark.parametrize("side", [0.0, 1.0])
def test_a_lopsided_law_has_no_jump(name: str, task: str, side: float) -> None:
    """Nor is one reported where a border, off by rounding, lies next to a steep acceleration."""
    for distance in np.geomspace(1e-6, 0.5, 60):
        law = make_law(name, task, inflection=float(abs(side - distance)))
        assert not acceleration_jumps(law)
    assert acceleration_jumps(make_law("quadratic-parabola", inflection=1e-6))
