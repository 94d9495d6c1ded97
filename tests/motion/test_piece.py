"""Pieces with one formula are evaluated together, and each as if it were alone."""

from __future__ import annotations

import math
from decimal import Decimal

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from camgeo.kinematics.laws import FAMILIES, law_of
from camgeo.kinematics.plan import MANY, MotionPlan, Move
from camgeo.kinematics.planning.planner import plan_motion
from camgeo.kinematics.planning.requests import MoveRequest, PointsRequest, Request, TableRequest
from camgeo.units import TURN
from tests.strategies import FAMILY_TASKS, attack, plans

VALUES = {"v0": 0.25, "a0": 1.5, "j0": 2.0, "v1": 0.5, "a1": -1.0, "j1": 3.0}


@pytest.mark.parametrize(("name", "task"), FAMILY_TASKS)
def test_laws_that_differ_by_numbers_have_equal_formulas(name: str, task: str) -> None:
    taken = FAMILIES[name].parameters[task]
    found = []
    for number in (0.4, 0.45):
        if "inflection" in taken:
            given = {"inflection": number}
        else:
            given = {key: value + number for key, value in VALUES.items() if key in taken}
        given |= {key: 0.3 + number for key in ("v0", "v1") if key in taken}
        found.append([region.formula for region in law_of(name, task, given).regions])
    assert found[0] == found[1]
    assert [hash(formula) for formula in found[0]] == [hash(formula) for formula in found[1]]


def assorted() -> MotionPlan:
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
    return plan_motion(asked)


def check_each_alone(plan: MotionPlan, phi: np.ndarray[tuple[int], np.dtype[np.float64]]) -> None:
    """In order and shuffled, few and many at once, one by one: the same bits."""
    few = plan.jet(phi)
    order = np.random.default_rng(1).permutation(len(phi))
    assert np.array_equal(plan.jet(phi[order]), few[:, order])
    filled = np.concatenate((phi, np.linspace(0.0, TURN, 2 * MANY * len(plan.borders))))
    assert np.array_equal(plan.jet(filled)[:, : len(phi)], few)
    places = np.argsort(filled, kind="stable")
    assert np.array_equal(plan.jet(filled[places])[:, np.argsort(places)[: len(phi)]], few)
    for k in range(0, len(phi), 7):
        assert np.array_equal(plan.jet(phi[k : k + 1])[:, 0], few[:, k])


def test_an_assorted_plan() -> None:
    plan = assorted()
    inside = np.random.default_rng(3).uniform(0.0, TURN, 200)
    check_each_alone(plan, np.sort(np.concatenate((plan.borders, inside))))


@attack
@given(plan=plans(), seed=st.integers(0, 99))
def test_any_plan(plan: MotionPlan, seed: int) -> None:
    inside = np.random.default_rng(seed).uniform(0.0, TURN, 20)
    check_each_alone(plan, np.sort(np.concatenate((plan.borders, inside))))


def test_thousands_of_pieces_are_those_of_a_few() -> None:
    """Each of 2,000 moves by two laws equals that in a plan with nothing else."""
    count = 2000
    span = Decimal(360) / count
    laws = law_of("modified-sine", "R-R", {"inflection": 0.4}), law_of("polynomial-5", "R-R", {})
    plan = MotionPlan(tuple(Move(span, float(k % 2 == 0), laws[k % 3 == 0]) for k in range(count)))
    width = math.radians(360.0 / count)
    z = np.array([0.05, 0.3, 0.45, 0.7, 0.95])
    for k in (0, 1, 2, 1203, 1998):
        f, f1, f2, f3 = laws[k % 3 == 0](z)
        sign = 1.0 if k % 2 == 0 else -1.0
        expected = sign * np.stack((f, f1 / width, f2 / width**2, f3 / width**3))
        expected[0] += float(k % 2)
        # The cam angle is rounded: 1e-15 of a turn are 2e-12 of a move.
        found = plan.jet((k + z) * width)
        size = np.max(np.abs(expected), axis=1, keepdims=True)
        assert np.all(np.abs(found - expected) <= 1e-10 * size)
