"""The search, on designs that are given by formulas, whose best is known."""

from __future__ import annotations

import numpy as np
import pytest

from camgeo.numeric.arrays import FloatArray
from camgeo.studies.optimise.optimise import OptimisationResult, directions, optimise, task_of
from tests.findings import known
from tests.optimise.cams import PLAIN, given

A, B, C = "follower.base_radius", "follower.arm", "cam.speed"


def found(*vary: str, goals: int = 1, evaluations: int = 2000, seed: int = 0) -> OptimisationResult:
    least = ["diameter", "peak:s"][:goals]
    return optimise(task_of(PLAIN, vary, least=least), seed=seed, evaluations=evaluations)


def test_where_limits_meet_at_an_angle(monkeypatch: pytest.MonkeyPatch) -> None:
    """Least x + y/10 with x >= |y - 5| + 1: the tip of a wedge, (1, 5), on no coordinate way."""

    def wedge(x: FloatArray) -> tuple[list[float], float]:
        return [x[0] + 0.1 * x[1]], x[0] - abs(x[1] - 5.0) - 1.0

    given(monkeypatch, wedge)
    result = found(f"{A}=0:10", f"{B}=0:10")
    assert result.best.point == pytest.approx((1.0, 5.0), rel=1e-6)
    assert known(result.made).feasible
    assert known(result.made).point == pytest.approx((1.0, 5.0), rel=3e-6)


def test_a_smooth_limit_in_more_numbers(monkeypatch: pytest.MonkeyPatch) -> None:
    """The nearest point of a plane to a corner of the box."""

    def plane(x: FloatArray) -> tuple[list[float], float]:
        return [float(x @ x)], float(np.sum(x)) - 3.0

    given(monkeypatch, plane)
    result = found(f"{A}=0:4", f"{B}=0:4", f"{C}=0:4")
    assert result.best.costs[0] == pytest.approx(3.0, rel=1e-6)
    assert result.best.costs[0] >= 3.0 - 1e-12


def test_lists_and_numbers_at_once(monkeypatch: pytest.MonkeyPatch) -> None:
    given(monkeypatch, lambda x: ([(x[0] - x[1]) ** 2 + (x[1] - 3.2) ** 2], 1.0))
    result = found(f"{A}=0:10", f"{B}=9,1,3,4,6")
    assert result.best.point == pytest.approx((3.0, 3.0), abs=1e-3)
    assert known(result.made).point[1] == 3


def test_of_lists_alone_all_are_tried(monkeypatch: pytest.MonkeyPatch) -> None:
    given(monkeypatch, lambda x: ([x[0] * x[1]], x[0] - 1.5))
    result = found(f"{A}=0:3:4", f"{B}=5,-7")
    assert (len(result.trials), result.ended) == (8, "all designs were tried")
    assert result.best.point == (3, -7)
    assert result.made == result.best


def test_the_same_seed_tries_the_same_designs(monkeypatch: pytest.MonkeyPatch) -> None:
    given(monkeypatch, lambda x: ([float(np.sum(np.sin(x)))], 1.0))
    vary = f"{A}=0:10", f"{B}=0:10"
    one, other = (found(*vary, evaluations=200, seed=7) for _ in range(2))
    assert [each.point for each in one.trials] == [each.point for each in other.trials]
    assert one.ended == "200 designs were allowed"
    third = found(*vary, evaluations=200, seed=8)
    assert [each.point for each in third.trials] != [each.point for each in one.trials]


def test_the_front_of_two_objectives(monkeypatch: pytest.MonkeyPatch) -> None:
    """x and 1/x over 1/4 to 4 with y to be 2: all of the front has y = 2, both ends are on it."""

    def costs(x: FloatArray) -> tuple[list[float], float]:
        away = (x[1] - 2.0) ** 2
        return [x[0] + away, 1.0 / x[0] + away], 1.0

    given(monkeypatch, costs)
    result = found(f"{A}=0.25:4", f"{B}=0:4", goals=2)
    xs = np.array([each.point[0] for each in result.front], dtype=float)
    assert xs[0] == pytest.approx(0.25, rel=1e-4)
    assert xs[-1] == pytest.approx(4.0, rel=1e-4)
    assert np.max(np.diff(xs)) < 1.0
    assert all(abs(float(each.point[1]) - 2.0) < 0.3 for each in result.front)
    assert 0.6 < float(known(result.made).point[0]) < 1.7  # 1 is as far from both ends


@pytest.mark.parametrize("count", [1, 2, 3, 4, 5])
def test_directions(count: int) -> None:
    ways = directions(count)
    assert np.array_equal(ways[:count], np.eye(count))
    assert np.allclose(np.sum(ways, axis=1), 1.0)
    assert len({tuple(each) for each in ways}) == len(ways) <= 15
