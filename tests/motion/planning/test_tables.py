from __future__ import annotations

import math

import numpy as np
import pytest

from camgeo.errors import GeometryError
from camgeo.kinematics.plan import joints
from camgeo.kinematics.splines import clamped_spline
from tests.motion.planning.wishes import data_of, laws, move, planned, rest, table

TURN = 2.0 * math.pi


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


def test_a_turn_that_does_not_close_is_reported() -> None:
    with pytest.raises(GeometryError, match="off where it would close") as caught:
        planned(table(360, [0.0, 1.0, 2.0, 1.0, 0.5]))
    assert caught.value.key == "motion[1].file"
