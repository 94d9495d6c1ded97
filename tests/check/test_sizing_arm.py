"""The arm within a range: scaling, no better one nearby, refusals."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from camgeo.check.sizing.rounding import size_with_arm, with_arm
from camgeo.check.sizing.smallest import size
from camgeo.check.sizing.task import task_of
from camgeo.errors import GeometryError
from camgeo.kinematics.mechanism.oscillating_roller import OscillatingRoller
from tests.check.sizing_scenes import required


def test_for_the_angle_alone_all_scales_and_the_shortest_arm_is_best() -> None:
    task, angle, _ = required("setzhub")
    small = task_of(task.cam.sized(roller_radius=1e-3))
    found = [size(with_arm(small, arm), angle, 1.0).answer for arm in (30.0, 60.0)]
    assert found[0] is not None
    assert found[1] is not None
    assert found[1].place == pytest.approx(2.0 * found[0].place, rel=1e-11)
    sized, sizing = size_with_arm(small, angle, 1.0, 30.0, 60.0)
    assert isinstance(sized.follower, OscillatingRoller)
    assert sized.follower.arm == 30.0
    assert sizing.answer == found[0]


@pytest.mark.parametrize("contact", ["inner", "outer"])
def test_no_other_arm_of_the_range_is_better(contact: str) -> None:
    task, angle, ratio = required("schnitt")
    task = task_of(replace(task.cam, contact=contact))  # type: ignore[arg-type]  # the name of a contact
    low, high = 12.0, 60.0
    sized, sizing = size_with_arm(task, angle, ratio, low, high)
    assert isinstance(sized.follower, OscillatingRoller)
    assert low <= sized.follower.arm <= high
    assert sizing.answer is not None
    assert sizing.answer.transmission_angle.value >= angle - 1e-9
    assert sizing.answer.radius_ratio.value <= ratio + 1e-9
    for arm in (low, 40.0, *(sized.follower.arm * np.array([0.97, 1.03]))):
        if low <= arm <= high:
            other = size(with_arm(task, float(arm)), angle, ratio).answer
            assert other is not None
            # The best arm inside the range is found to 1e-3 of itself.
            assert other.base_radius >= sizing.answer.base_radius * (1.0 - 1e-3)


@pytest.mark.parametrize(
    ("name", "low", "high", "key"),
    [
        ("plate_translating", 30.0, 60.0, "follower.kind"),
        ("setzhub", 60.0, 30.0, "arm"),
        ("setzhub", 5.0, 30.0, "arm"),
        ("setzhub", 30.0, float("inf"), "arm"),
        ("setzhub", float("nan"), 30.0, "arm"),
    ],
)
def test_what_is_no_range_is_refused(name: str, low: float, high: float, key: str) -> None:
    task, angle, ratio = required(name)
    with pytest.raises(GeometryError) as caught:
        size_with_arm(task, angle, ratio, low, high)
    assert caught.value.key == key
