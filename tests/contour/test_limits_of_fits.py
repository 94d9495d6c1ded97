"""Where fits give up: a distance that no number of parts and no lower aim reduces."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pytest

from camgeo.errors import ToleranceError
from camgeo.geometry.contour.legs import least_counts
from camgeo.geometry.contour.proof import proved

MOST = 2_000_000


def _least(step: float, needed: float, tried: list[int]) -> list[int]:
    """The least count within 0.5 mm, by those `tried`, of a curve that needs that many `needed`
    parts for it and has a step of `step` mm."""

    def make(wanted: Sequence[tuple[int, int]]) -> list[tuple[int, float]]:
        tried.extend(count for _, count in wanted)
        return [(count, max(step, 0.5 * (needed / count) ** 2)) for _, count in wanted]

    return least_counts(make, np.array([3.0]), 0.5, 0.01, order=2.0, most=MOST)


@pytest.mark.parametrize("step", [0.6, 2.0])
def test_a_step_of_the_curve_is_not_divided_further(step: float) -> None:
    tried: list[int] = []
    with pytest.raises(ToleranceError) as caught:
        _least(step, 1_000.0, tried)
    assert caught.value.reached == pytest.approx(step)
    assert max(tried) < 20_000 < MOST


@pytest.mark.parametrize("needed", [10.0, 3_000.0, 1.5e6])
def test_counts_that_help_are_tried_on(needed: float) -> None:
    (count,) = _least(0.0, needed, [])
    assert needed <= count <= 1.02 * needed + 2.0


def test_a_lower_aim_that_does_not_help_is_the_last() -> None:
    aims: list[float] = []

    def fit(aim: float) -> float:
        aims.append(aim)
        return aim

    with pytest.raises(ToleranceError) as caught:
        proved(fit, lambda aim: 5.0 + 0.1 * aim, 1.0, 1.0)
    assert len(aims) == 2
    assert caught.value.reached == pytest.approx(5.0, rel=0.05)


def test_an_aim_out_of_reach_is_told_by_the_proof_before() -> None:
    def fit(aim: float) -> float:
        if aim < 0.5:
            raise ToleranceError("no count will do", 1.0, 0.3)
        return aim

    with pytest.raises(ToleranceError) as caught:
        proved(fit, lambda _: 4.0, 1.0, 1.0)
    assert caught.value.reached == 4.0
    with pytest.raises(ToleranceError, match="no count will do"):
        proved(fit, lambda _: 4.0, 0.1, 1.0)
