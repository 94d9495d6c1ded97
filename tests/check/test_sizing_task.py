"""The terms of the conditions of sizing, compared with the pitch curve itself."""

from __future__ import annotations

import itertools
import math
from decimal import Decimal

import numpy as np
import pytest

from camgeo.check.sizing.task import Task, task_of
from camgeo.geometry.pitch_curve import PitchCurve
from camgeo.kinematics.mechanism.oscillating_roller import OscillatingRoller
from camgeo.kinematics.mechanism.translating_roller import TranslatingRoller
from camgeo.kinematics.plan import Dwell, MotionPlan, Move
from tests.cams import cam_of
from tests.check.sizing_scenes import BENT, EASY, required
from tests.reference import POLYNOMIAL


def agrees(task: Task) -> None:
    """The terms give transmission angle, curvature and the present design again."""
    curve = task.cam.disc.pitch_curve
    phi = np.linspace(0.0, 6.2, 500)
    terms = task.terms(phi)
    u, v = terms.across_and_along(task.present)
    np.testing.assert_allclose(
        np.arctan2(u, np.abs(v)), curve.transmission_angle(phi), rtol=0.0, atol=1e-13
    )
    np.testing.assert_allclose(
        terms.curvature(task.present), curve.curvature(phi), rtol=0.0, atol=1e-13
    )
    again = task.follower_at(task.present)
    np.testing.assert_allclose(
        PitchCurve(task.motion, again, task.cam.rotation).point(phi),
        curve.point(phi),
        rtol=0.0,
        atol=1e-11,
    )


@pytest.mark.parametrize("name", [*EASY, *BENT])
def test_every_scene_has_the_terms_of_its_pitch_curve(name: str) -> None:
    agrees(required(name)[0])


@pytest.mark.parametrize(
    ("kind", "side", "direction", "rotation"),
    list(itertools.product(("guide", "rocker"), (1, -1), (1, -1), (1, -1))),
)
def test_every_arrangement_has_the_terms_of_its_pitch_curve(
    kind: str, side: int, direction: int, rotation: int
) -> None:
    stroke = 12.0 if kind == "guide" else 0.3
    follower: TranslatingRoller | OscillatingRoller
    if kind == "guide":
        follower = TranslatingRoller(50.0, 6.0, 9.0 * side, 1.1, direction)
    else:
        follower = OscillatingRoller(70.0 - 40.0j, 75.0, 48.0, 6.0, side, direction)
    plan = MotionPlan(
        (
            Dwell(Decimal(40)),
            Move(Decimal(100), stroke, POLYNOMIAL),
            Move(Decimal(120), 0.0, POLYNOMIAL),
            Dwell(Decimal(100)),
        )
    )
    agrees(task_of(cam_of(plan, follower, rotation)))


@pytest.mark.parametrize("tangent", [1.7, -0.8])
def test_slack_is_extreme_where_it_says(tangent: float) -> None:
    task = required("setzhub")[0]
    found = task.slack(task.present, tangent)
    u, v = task.terms(np.linspace(0.0, 2.0 * math.pi, 20_001)).across_and_along(task.present)
    dense = u - tangent * v
    assert found.smallest()[0] == pytest.approx(np.min(dense), abs=1e-5)
    assert found.smallest()[0] <= np.min(dense)
    assert found.largest()[0] >= np.max(dense)
