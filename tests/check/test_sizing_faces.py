"""The smallest base circle for a flat face: closed forms, and the support function itself."""

from __future__ import annotations

import itertools
import math
from decimal import Decimal
from pathlib import Path

import numpy as np
import pytest

import camgeo
from camgeo.check.sizing.smallest import rate_face, size_for_face
from camgeo.check.sizing.task import FaceTask, face_task_of
from camgeo.errors import GeometryError
from camgeo.geometry.outline.convex import touch
from camgeo.kinematics.mechanism.oscillating_flat import OscillatingFlat
from camgeo.kinematics.mechanism.translating_flat import TranslatingFlat
from camgeo.kinematics.plan import Dwell, MotionPlan, Move
from tests.cams import cam_of
from tests.laws import LAWS
from tests.reference import POLYNOMIAL

SCENES = Path(__file__).parents[2] / "fixtures" / "scenes"
ANGLE = math.radians(45.0)


def plan_of(stroke: float, law: str = "polynomial-345") -> MotionPlan:
    return MotionPlan(
        (
            Dwell(Decimal(30)),
            Move(Decimal(100), stroke, LAWS[law]),
            Dwell(Decimal(40)),
            Move(Decimal(90), 0.0, LAWS[law]),
            Dwell(Decimal(100)),
        )
    )


def rocker(side: int = 1, direction: int = 1, rotation: int = 1, **other: float) -> FaceTask:
    follower = OscillatingFlat(-70 + 50j, 35.0, other.get("offset", 8.0), side, direction)
    return face_task_of(cam_of(plan_of(math.radians(12.0)), follower, rotation))


@pytest.mark.parametrize("direction", [1, -1])
@pytest.mark.parametrize("least", [0.0, 6.0])
def test_on_a_guide_it_is_the_largest_of_minus_lift_and_acceleration(
    direction: int, least: float
) -> None:
    """r_G = rho - min kappa_F (s + s''); for an F-cam of 3-4-5 moves in the return."""
    task = face_task_of(cam_of(plan_of(9.0), TranslatingFlat(60.0, direction=direction)))
    found = size_for_face(task, ANGLE, least)
    assert found.answer is not None
    span, best = math.radians(90.0), math.inf
    z = np.linspace(0.0, 1.0, 200_001)
    for width in (math.radians(100.0), span):
        lift = z**3 * (10.0 + z * (6.0 * z - 15.0))
        bend = 60.0 * z * (1.0 - z) * (1.0 - 2.0 * z) / width**2
        best = min(best, float(np.min(direction * 9.0 * (lift + bend))))
    assert found.answer.base_radius == pytest.approx(least - best, abs=5e-7)
    assert found.answer.transmission_angle.value == pytest.approx(0.5 * math.pi)
    assert {each.name for each in found.active} == {"convexity"}
    assert found.exact


def test_a_jump_of_the_acceleration_counts_from_both_sides() -> None:
    """A parabola decelerates from its middle on: -(s + s'') = stroke (4/span^2 - 1/2)."""
    task = face_task_of(cam_of(plan_of(9.0, "quadratic-parabola"), TranslatingFlat(60.0)))
    found = size_for_face(task, ANGLE, 0.0)
    assert found.answer is not None
    expected = 9.0 * (4.0 / math.radians(90.0) ** 2 - 0.5)
    assert found.answer.base_radius == pytest.approx(expected, abs=5e-7)


@pytest.mark.parametrize(
    ("side", "direction", "rotation"), list(itertools.product((1, -1), (1, -1), (1, -1)))
)
def test_the_conditions_are_those_of_the_support_function(
    side: int, direction: int, rotation: int
) -> None:
    task = rocker(side, direction, rotation)
    asked = task.asked(ANGLE, 3.0)
    phi = np.linspace(0.0, 2.0 * math.pi, 300)
    x, y = task.present.real, -task.present.imag
    at = touch(task.pitch_curve_at(task.present), phi)
    expected = {
        "convexity": at.pace[0] - 3.0 * at.turn[0],
        "face-over-axis": at.distance - asked.clearance,
        "transmission-angle": at.contact[0] - 8.0,
    }
    for name, values in expected.items():
        a, b, c = task.rows(name, phi, "right", asked)
        np.testing.assert_allclose(a * x + b * y - c, values, rtol=0.0, atol=1e-10)


def test_turning_the_cam_the_other_way_is_the_other_side() -> None:
    one, other = rocker(1, 1, 1), rocker(-1, 1, -1)
    first, second = (size_for_face(task, ANGLE, 0.0).answer for task in (one, other))
    assert first is not None
    assert second is not None
    assert first.base_radius == pytest.approx(second.base_radius, rel=1e-12)


def test_the_transmission_angle_decides_where_the_face_lies_far_beyond_the_pivot() -> None:
    """q >= tan mu |f|: at the largest admissible f a smaller base circle gives more leverage."""
    task = rocker(offset=60.0)
    assert size_for_face(task, math.radians(40.0), 0.0).answer is not None
    found = size_for_face(task, math.radians(70.0), 0.0)
    assert found.answer is None
    assert found.hopeless is None


def test_what_no_size_can_do() -> None:
    """A face that turns with the cam and faster; one whose velocity jumps; one at rest."""
    quick = MotionPlan(
        (
            Dwell(Decimal(30)),
            Move(Decimal(20), math.radians(40.0), POLYNOMIAL),
            Move(Decimal(310), 0.0, POLYNOMIAL),
        )
    )
    task = face_task_of(cam_of(quick, OscillatingFlat(-70 + 50j, 35.0), 1))
    reasons = [size_for_face(side, ANGLE, 0.0).hopeless for side in task.sides]
    assert sum("turns back" in (each or "") for each in reasons) == 1
    rated = [rate_face(side, side.present) for side in task.sides]
    assert [each is None for each in rated] == ["turns back" in (why or "") for why in reasons]
    jumping = face_task_of(cam_of(plan_of(9.0, "straight-line"), TranslatingFlat(60.0)))
    found = size_for_face(jumping, ANGLE, 0.0)
    assert found.answer is None
    assert "a flat face needs a motion without shocks" in (found.hopeless or "")
    still = face_task_of(cam_of(MotionPlan((Dwell(Decimal(360)),)), TranslatingFlat(60.0)))
    with pytest.raises(GeometryError, match="does not move"):
        size_for_face(still, ANGLE, 0.0)


@pytest.mark.parametrize(
    ("angle", "radius", "key"),
    [
        (0.0, 0.0, "transmission_angle"),
        (1.0, -1.0, "radius_of_curvature"),
        (1.0, math.inf, "radius_of_curvature"),
        (1.0, math.nan, "radius_of_curvature"),
    ],
)
def test_a_wrong_requirement_is_refused(angle: float, radius: float, key: str) -> None:
    task = face_task_of(camgeo.load(SCENES / "tappet.toml").cam)
    with pytest.raises(GeometryError) as caught:
        size_for_face(task, angle, radius)
    assert caught.value.key == key
