"""The value table over its step: the bound of linear interpolation holds and is sharp."""

from __future__ import annotations

import math
from decimal import Decimal
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import camgeo
from camgeo.design.value_table import cam_angles
from camgeo.kinematics.laws.law import Law
from camgeo.kinematics.plan import Dwell, MotionPlan, Move
from camgeo.numeric.arrays import FloatArray
from camgeo.studies.accuracy.survey import interpolation_error, table_rows
from tests.laws import LAWS
from tests.strategies import laws

SCENES = Path(__file__).parents[2] / "fixtures" / "scenes"

SETZHUB = camgeo.load(SCENES / "setzhub.toml")

DENSE = 40
"""Points between two rows; the top of a parabola is missed by a part in 4 * 40^2 of it."""

some = settings(max_examples=25, deadline=None)


def measured(plan: MotionPlan, phi: FloatArray) -> float:
    """Largest difference found between the lift and its chords."""
    rows = np.append(phi, 2.0 * math.pi)
    shares = (np.arange(DENSE) + 0.5) / DENSE
    between = rows[:-1, None] + np.diff(rows)[:, None] * shares
    lift = plan.jet(rows[:-1] % (2.0 * math.pi))[0]
    ends = np.append(lift[1:], plan.jet(np.zeros(1))[0])
    chords = lift[:, None] + (ends - lift)[:, None] * shares
    exact = plan.jet(between.ravel())[0].reshape(between.shape)
    return float(np.max(np.abs(exact - chords)))


@given(laws(), laws(), st.sampled_from([Decimal("7.5"), Decimal(2), Decimal("0.3")]))
@some
def test_the_bound_holds_for_any_plan(rise: Law, fall: Law, step: Decimal) -> None:
    segments = (
        Move(Decimal(100), 20.0, rise),
        Dwell(Decimal("81.3")),
        Move(Decimal(120), 0.0, fall),
        Dwell(Decimal("58.7")),
    )
    plan = MotionPlan(segments)
    phi = np.radians(cam_angles(step))
    bound = interpolation_error(plan, phi)
    assert measured(plan, phi) <= bound * (1.0 + 1e-12) + 1e-13


@pytest.mark.parametrize("step", ["2", "0.5", "0.1"])
def test_the_bound_is_sharp_for_small_steps(step: str) -> None:
    plan = SETZHUB.scene.plan
    assert isinstance(plan, MotionPlan)
    phi = np.radians(cam_angles(Decimal(step)))
    bound, found = interpolation_error(plan, phi), measured(plan, phi)
    # s'' is all but constant over a step, but for the change that its peak's neighbourhood has in
    # one: (pi h / beta)^2/2 for a move beta = 80 degrees, 0.3 % at 2 degrees; the rest is `DENSE`.
    assert found <= bound <= 1.01 * found


def test_a_kink_between_two_rows_counts() -> None:
    plan = MotionPlan(
        (
            Move(Decimal(90), 10.0, LAWS["straight-line"]),
            Dwell(Decimal(90)),
            Move(Decimal(90), 0.0, LAWS["straight-line"]),
            Dwell(Decimal(90)),
        )
    )
    # Rows every 60 degrees: the kinks at 90, 270 lie in the middle of a step, j h/4.
    jump = 10.0 / (0.5 * math.pi)
    expected = jump * math.radians(60) / 4.0
    bound = interpolation_error(plan, np.radians(cam_angles(Decimal(60))))
    assert bound == pytest.approx(expected, rel=1e-12)
    # Rows on the kinks: nothing is lost but rounding.
    assert interpolation_error(plan, np.radians(cam_angles(Decimal(90)))) <= 1e-13


def test_rows_and_bytes_are_those_of_the_table() -> None:
    reported: list[str] = []
    rows = table_rows(SETZHUB, (Decimal(5), Decimal(1)), progress=reported.append)
    assert [row.rows for row in rows] == [72, 360]
    assert rows[0].size == len(SETZHUB.tabulated.table(Decimal(5)).csv().encode())
    assert all(row.seconds > 0.0 for row in rows)
    assert reported == ["value table, 5 degrees", "value table, 1 degrees"]
    # Twenty-five times from a fifth of the step: s'' is continuous here.
    assert rows[0].error / rows[1].error == pytest.approx(25.0, rel=0.02)
