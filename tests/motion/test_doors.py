"""Every part of motion checks its values at its own door: a right answer, or the key and why.

Whatever is handed in, no error but camgeo's own comes out, and no warning of numpy's (the tests
make errors of them); what is accepted gives finite values.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from decimal import Decimal
from fractions import Fraction
from functools import partial
from typing import Any

import numpy as np
import pytest

from camgeo.app.answers.table import law_table
from camgeo.errors import GeometryError
from camgeo.kinematics.laws import FAMILIES, make_law
from camgeo.kinematics.laws.comparison import Running, compare
from camgeo.kinematics.laws.law import characteristic
from camgeo.kinematics.plan import Dwell, MotionPlan, Move, SplineMove, breaks
from camgeo.kinematics.planning.build import balanced
from camgeo.kinematics.planning.planner import plan_motion
from camgeo.kinematics.planning.requests import MoveRequest, PointsRequest, TableRequest
from camgeo.kinematics.splines import Spline, clamped_spline, periodic_spline, smooth_clamped_spline
from camgeo.kinematics.tables import read_lift_table, read_speed_table
from camgeo.kinematics.time_course import ConstantSpeed, SpeedCurve, plan_extremes, time_extremes
from camgeo.units import TURN
from tests.long_form import examples

NUMBERS: tuple[Any, ...] = (
    *(math.nan, math.inf, -math.inf, -1.0, 0.0, -0.0, 5e-324, -5e-324, 1e-310, 1e-30, 1e-9, 0.5),
    *(1.0 - 2.0**-53, 1.0, 1.0 + 2.0**-52, 3.0, 60.0, 1e6, 1e12, 1e30, 1e50, 1e100, 1e308, -1e308),
    *(np.float64(0.3), np.float32(0.3), np.int64(1), 3, Fraction(1, 3), 10**400),
    *(Decimal("0.5"), Decimal("NaN"), Decimal("sNaN"), Decimal("1e-7"), Decimal("1e400")),
)
NASTY = (*NUMBERS, "1", b"x", None, True, 1j, [1.0], {}, object(), np.ones(3))


def some_of(key: str) -> tuple[Any, ...]:
    """All that is no number; of numbers, which cost more as they may be accepted, every fifth, from
    another one on for each key.
    """
    step = examples(5, long=1)
    return (*NUMBERS[sum(map(ord, key)) % step :: step], math.nan, *NASTY[len(NUMBERS) :])


LAW = make_law("polynomial-345")
PHI = np.linspace(0.0, TURN, 37)
X, Y = [0.0, 1.0, 2.0, 3.0], [0.0, 1.0, 0.0, 2.0]
PLAN = MotionPlan((Dwell(Decimal(60)), Move(Decimal(150), 5.0, LAW), Move(Decimal(150), 0.0, LAW)))


def used(plan: MotionPlan) -> None:
    """Ask a plan for all that it is asked for."""
    assert np.all(np.isfinite(plan.jet(PHI)))
    plan.jet_and_bounds(PHI[:-1], PHI[:-1] + 1e-9)
    breaks(plan)
    for found in (
        time_extremes(plan, ConstantSpeed(9.0)),
        plan_extremes(plan, ConstantSpeed(9)),
    ):
        assert math.isfinite(found.jerk.magnitude)


def finite(spline: Spline) -> None:
    places = np.linspace(spline.knots[0], spline.knots[-1], 9)
    assert np.all(np.isfinite(spline.values(places)))


def planned(move: MoveRequest | PointsRequest | TableRequest) -> None:
    rest = Decimal(300) - move.span
    used(plan_motion([Dwell(Decimal(60)), move, MoveRequest(rest, 0.0, "polynomial-5")]))


def changed(values: list[float], place: int, value: Any) -> Any:
    return [*values[:place], value, *values[place + 1 :]]


DOORS: dict[str, Callable[[Any], object]] = {
    "dwell": Dwell,
    "move.span": lambda v: used(MotionPlan((Move(v, 5.0, LAW), Move(Decimal(300), 0.0, LAW)))),
    "move.to": lambda v: used(
        MotionPlan((Move(Decimal(60), v, LAW), Move(Decimal(300), 0.0, LAW)))
    ),
    "move.law": lambda v: Move(Decimal(60), 1.0, v),
    "move.scale": lambda v: Move(Decimal(60), 1.0, LAW, v),
    "spline move": lambda v: SplineMove(Decimal(60), 1.0, v),
    "plan": MotionPlan,
    "plan of it": lambda v: MotionPlan((v,)),
    "planned": plan_motion,
    "planned of it": lambda v: plan_motion([v]),
    "request.span": lambda v: planned(MoveRequest(v, 5.0, "auto")),
    "request.to": lambda v: planned(MoveRequest(Decimal(90), v, "modified-sine")),
    "request.velocity": lambda v: planned(MoveRequest(Decimal(90), 5.0, "auto", velocity=v)),
    "request.jerk": lambda v: planned(MoveRequest(Decimal(90), 5.0, "polynomial-7", jerk=v)),
    "request.inflection": lambda v: planned(
        MoveRequest(Decimal(90), 5.0, "auto", parameters={"inflection": v})
    ),
    "request.weights": lambda v: planned(
        MoveRequest(Decimal(90), 5.0, "auto", optimise={"jerk": v})
    ),
    "points.share": lambda v: planned(
        PointsRequest(Decimal(90), 5.0, changed([0.3, 0.6], 1, v), np.array([1.0, 2.0]))
    ),
    "points.position": lambda v: planned(
        PointsRequest(Decimal(90), 5.0, np.array([0.3, 0.6]), changed([1.0, 2.0], 1, v))
    ),
    "points.given": lambda v: planned(
        PointsRequest(Decimal(90), 5.0, np.array([0.3]), np.array([1.0]), {0: (v, None)})
    ),
    "table.share": lambda v: planned(
        TableRequest(Decimal(90), changed([0.0, 0.3, 0.6, 1.0], 2, v), np.array(Y))
    ),
    "table.lift": lambda v: planned(
        TableRequest(Decimal(90), np.array([0.0, 0.3, 0.6, 1.0]), changed(Y, 2, v))
    ),
    "speed": lambda v: time_extremes(PLAN, ConstantSpeed(v)),
    "curve.t": lambda v: time_extremes(
        PLAN, SpeedCurve(changed([0.0, 0.1, 0.2, 0.3, 0.4], 1, v), np.linspace(0.0, TURN, 5))
    ),
    "curve.phi": lambda v: SpeedCurve(np.arange(5.0), changed([0.0, 2.0, 3.0, 5.0, TURN], 2, v)),
    "spline": lambda v: Spline(v, v),
    "spline.taylor": lambda v: Spline(np.arange(2.0), changed([0.0] * 6, 3, v)),
    "spline.rise": lambda v: Spline(np.arange(2.0), np.ones((1, 6)), periodic=True, rise=v),
    "points.x": lambda v: finite(clamped_spline(changed(X, 1, v), np.array(Y))),
    "points.y": lambda v: finite(periodic_spline(np.array(X), changed(Y, 1, v), 4.0)),
    "points.start": lambda v: finite(clamped_spline(np.array(X), np.array(Y), (v, None))),
    "points.end": lambda v: finite(clamped_spline(np.array(X), np.array(Y), end=v)),
    "points.inner": lambda v: finite(clamped_spline(np.array(X), np.array(Y), inner={1: (v, v)})),
    "points.period": lambda v: finite(periodic_spline(np.array(X), np.array(Y), v)),
    "points.rise": lambda v: finite(periodic_spline(np.array(X), np.array(Y), 4.0, v)),
    "points.gap": lambda v: finite(periodic_spline(np.array(X), np.array(Y), 4.0, gap=v)),
    "smoothing": lambda v: smooth_clamped_spline(np.array(X), np.array(Y), largest_deviation=v),
    "lift file": lambda v: read_lift_table(v, "a.csv"),
    "lift file.span": lambda v: read_lift_table("0;0\n3;1\n", "a.csv", v),
    "speed file": lambda v: read_speed_table(v, "a.csv"),
    "law.name": make_law,
    "law.task": lambda v: make_law("polynomial-5", v),
    "table of values": lambda v: law_table(LAW, v),
    "running.speed": lambda v: Running(v, 1.0, 1.0).physical("jerk", 5.0),
    "running.span": lambda v: Running(1.0, v, 1.0).physical("moment", 5.0),
    "compare.given": lambda v: compare("R-R", {"inflection": v}, ("modified-sine",)),
    "compare.names": lambda v: compare("R-R", {}, v),
    "compare.task": lambda v: compare(v, {}),
    "balance.quantity": lambda v: balanced("scca", "R-R", v, {}),
    "balance.task": lambda v: balanced("scca", v, "jerk", {}),
}


def refusal(call: Callable[[], object]) -> GeometryError | None:
    """Why a call is refused; None if it is not."""
    try:
        call()
    except GeometryError as error:
        return error
    return None


@pytest.mark.parametrize("name", DOORS)
def test_a_door_answers_or_explains_its_refusal(name: str) -> None:
    tried = some_of(name)
    refused = [refusal(partial(DOORS[name], value)) for value in tried]
    assert any(refused)
    for value, why in zip(tried, refused, strict=True):
        if why is not None:
            assert why.key or "a.csv, line" in why.message, (value, why)
            assert why.message, value


def tried_law(name: str, task: str, given: dict[str, Any]) -> None:
    """Make a law, and ask it for its values."""
    law = make_law(name, task, **given)
    assert np.all(np.isfinite(law(np.linspace(0.0, 1.0, 41))))
    characteristic(law)


@pytest.mark.parametrize(
    ("name", "task"), [(name, task) for name, each in FAMILIES.items() for task in each.tasks]
)
def test_a_law_takes_a_parameter_or_names_it(name: str, task: str) -> None:
    taken = FAMILIES[name].parameters[task]
    for key in taken:
        for value in some_of(f"{name} {task} {key}"):
            why = refusal(partial(tried_law, name, task, {key: value}))
            assert why is None or why.key, value
    rng = np.random.default_rng(1)
    numbers = [value for value in NUMBERS if isinstance(value, float)]
    for _ in range(examples(3, long=20)):
        given = {key: numbers[rng.integers(len(numbers))] for key in taken if rng.random() < 0.7}
        why = refusal(partial(tried_law, name, task, given))
        assert why is None or why.message, given
