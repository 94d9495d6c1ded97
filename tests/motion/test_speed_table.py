from __future__ import annotations

import math
import re

import numpy as np
import pytest

from camgeo.errors import GeometryError
from camgeo.kinematics.tables import read_speed_table

ROWS = [(0.0, 0.0), (0.1, 30.0), (0.2, 90.0), (0.35, 200.0), (0.5, 300.0), (0.6, 360.0)]


def text(rows: list[tuple[float, float]], heading: str = "") -> str:
    return heading + "".join(f"{time},{angle}\n" for time, angle in rows)


def test_the_disc_is_where_the_rows_say() -> None:
    course = read_speed_table(text(ROWS, "t [s],phi [deg]\n"), "speed.csv")
    angles = np.radians([angle for _, angle in ROWS[:-1]])
    assert course.time(angles) == pytest.approx([time for time, _ in ROWS[:-1]], abs=1e-14)
    omega, alpha, _ = course.rates(angles)
    # By differences over a short time, whose error is h^2/6 of the third derivative, here < 1e-5.
    h = 1e-4
    t = course.time(angles) + 0.3
    mean = (course.spline.values(t + h, 0)[0] - course.spline.values(t - h, 0)[0]) / (2.0 * h)
    assert course.spline.values(t, 1)[1] == pytest.approx(mean, rel=1e-4)
    assert np.all(omega > 0.0)
    assert np.any(np.abs(alpha) > 1.0)
    # One turn takes 0.6 s, whatever the speed between.
    assert course.time(np.array([2.0 * math.pi])) == pytest.approx([0.6], abs=1e-14)


@pytest.mark.parametrize(
    ("rows", "message"),
    [
        ([(0.1, 0.0), *ROWS[1:]], "line 1: '0.1': the first time; allowed: 0"),
        ([(0.0, 1.0), *ROWS[1:]], "line 1: '1.0': the first angle; allowed: 0"),
        ([*ROWS[:2], (0.05, 95.0), *ROWS[2:]], "line 3: '0.05': the time before is 0.1"),
        ([*ROWS[:3], (0.3, 80.0), *ROWS[3:]], "line 4: '80.0': the angle before is 90.0"),
        (ROWS[:-1], "line 5: '300.0': the last angle; allowed: 360 degrees"),
        ([(0.0, 0.0), (0.5, 1.0), (0.6, 359.0), (1.0, 360.0)], "stand still or run backwards"),
        ([(0.0, 0.0), (1.0, 360.0)], "allowed: 4 rows or more"),
    ],
)
def test_faults_are_reported(rows: list[tuple[float, float]], message: str) -> None:
    with pytest.raises(GeometryError, match=re.escape(message)):
        read_speed_table(text(rows), "speed.csv")


def test_the_unit_of_the_time_is_seconds() -> None:
    with pytest.raises(GeometryError, match="the unit of the time; allowed: s"):
        read_speed_table(text(ROWS, "t [ms],phi [deg]\n"), "speed.csv")
