"""The smallest base circle, by perturbing it, and conditions that cannot be met."""

from __future__ import annotations

import math
from decimal import Decimal

import numpy as np
import pytest

from camgeo.app.answers.size import Side
from camgeo.check.sizing import bends
from camgeo.check.sizing.bends import conditions
from camgeo.check.sizing.smallest import active_conditions, rate, size
from camgeo.check.sizing.task import task_of
from camgeo.errors import GeometryError
from camgeo.kinematics.mechanism.translating_roller import TranslatingRoller
from camgeo.kinematics.plan import MotionPlan, Move
from camgeo.units import TURN
from tests.cams import cam_of
from tests.check.sizing_scenes import BENT, EASY, required
from tests.laws import LAWS


@pytest.mark.parametrize("name", [*EASY, *BENT])
def test_the_answer_keeps_its_requirement_and_no_smaller_one_does(name: str) -> None:
    task, angle, ratio = required(name)
    found = size(task, angle, ratio)
    assert found.answer is not None
    best = found.answer.place
    assert found.answer.transmission_angle.value >= angle - 1e-9
    assert found.answer.radius_ratio.value <= ratio + 1e-9
    assert {each.name for each in found.active} == (
        {"transmission-angle"} if name in EASY else {"transmission-angle", "radius-ratio"}
    )
    radius, start = found.answer.base_radius, task.start
    direction = np.angle(best - start)
    for shrink in (1e-7, 1e-5, 1e-3, 3e-2):
        # Both free parameters: a smaller base circle, and everywhere on it.
        turns = np.concatenate(([0.0], np.geomspace(1e-8, 1.0, 11)))
        for turn in (*turns, *-turns):
            theta = direction + turn
            if not -math.pi < theta < 0.0:
                continue
            place = start + radius * (1.0 - shrink) * np.exp(1j * theta)
            rating = rate(task, complex(place))
            assert (
                rating is None
                or rating.transmission_angle.value < angle
                or rating.radius_ratio.value > ratio
            ), (shrink, turn)


@pytest.mark.parametrize("name", BENT)
def test_no_smaller_circle_is_seen_anywhere(name: str) -> None:
    """A finer grid than that of the search, over all directions, at other cam angles."""
    task, angle, ratio = required(name)
    found = size(task, angle, ratio)
    assert found.answer is not None
    phi = np.linspace(0.0, 2.0 * math.pi, 721)
    now = conditions(task, math.tan(angle), ratio, phi)
    theta = np.linspace(-math.pi, 0.0, 400)
    for share in np.linspace(0.7, 0.9995, 8):
        places = task.start + share * found.answer.base_radius * np.exp(1j * theta)
        assert not np.any(now.met(places))


@pytest.mark.parametrize("rotation", [1, -1])
@pytest.mark.parametrize(("law", "roller"), [("polynomial-345", 15.0), ("modified-sine", 40.0)])
def test_a_roller_that_comes_to_the_axis_decides(law: str, roller: float, rotation: int) -> None:
    """A follower that is let in by 20 mm and turns there at once: nothing but that distance, and
    the transmission angle elsewhere, keeps the cam from being smaller."""
    half, angle = Decimal(180), math.radians(20.0)
    plan = MotionPlan((Move(half, 20.0, LAWS[law]), Move(half, 0.0, LAWS[law])))
    task = task_of(cam_of(plan, TranslatingRoller(100.0, roller, direction=-1), rotation))
    found = size(task, angle, 1.0)
    assert found.answer is not None
    dense = np.linspace(0.0, TURN, 721)

    def margins(place: complex) -> tuple[float, float, float]:
        curve = task.pitch_curve_at(place)
        return (
            float(np.min(np.abs(curve.point(dense)))) / roller - 1.0,
            1.0 - roller * float(np.max(curve.curvature(dense))),
            float(np.min(curve.transmission_angle(dense))) - angle,
        )

    best, radius = found.answer.place, found.answer.base_radius
    assert min(margins(best)) >= -1e-9
    assert margins(best)[0] <= 1e-8
    over = {each.name: each.cam_angle for each in found.active}
    assert over["roller-over-axis"] == pytest.approx(math.pi, abs=1e-6)
    assert "transmission-angle" in over
    for shrink in (1e-5, 1e-3, 0.03):
        for theta in np.angle(best) + np.linspace(-0.6, 0.6, 61):
            place = radius * (1.0 - shrink) * np.exp(1j * theta)
            assert place.imag > -20.0 or min(margins(complex(place))) < 0.0


def test_an_angle_that_no_place_keeps() -> None:
    """Setzhub's rocker swings by 23.866 degrees: mu <= 90 - psi_H/2 (mechanisms, section 5)."""
    task, _, ratio = required("setzhub")
    lift = task.motion.jet(np.radians([200.0]))[0]
    bound = 0.5 * math.pi - 0.5 * abs(float(lift[0]))
    found = size(task, bound + 1e-3, ratio)
    assert found.answer is None
    assert found.for_angle is None
    assert found.nearest_angle == pytest.approx(bound, abs=1e-5)
    assert found.nearest_angle is not None
    nearest = size(task, found.nearest_angle - 1e-3, 1.0)
    assert nearest.for_angle is not None


def test_however_large_the_roller_a_large_cam_takes_it() -> None:
    """Far out the pitch curve is a circle: r_G is about r_R/ratio there."""
    for name in ("vorschub", "groove"):
        task, angle, _ = required(name)
        roller = task.follower.roller_radius
        found = size(task, angle, 1e-3)
        assert found.answer is not None
        assert found.answer.radius_ratio.value <= 1e-3 * (1.0 + 1e-9)
        assert found.answer.base_radius == pytest.approx(roller / 1e-3, rel=0.1)
    huge = task_of(task.cam.sized(roller_radius=500.0))
    answer = size(huge, angle, 0.7).answer
    assert answer is not None
    assert {each.name for each in active_conditions(huge, answer, angle, 0.7)} == {
        "transmission-angle",
        "radius-ratio",
    }


def test_a_ratio_that_no_place_keeps(monkeypatch: pytest.MonkeyPatch) -> None:
    """Only where large cams are excluded, see above."""
    monkeypatch.setattr(bends, "REACH", 1.5)
    monkeypatch.setattr(bends, "ROOM", 0.0)
    task, angle, _ = required("vorschub")
    found = size(task, angle, 1e-3)
    assert found.answer is None
    assert found.for_angle is not None
    assert found.none_below == math.inf
    assert found.reach == pytest.approx(1.5 * found.for_angle.base_radius)
    assert found.nearest_ratio is not None
    assert found.nearest_ratio > 1e-3
    reported = Side(task, found, "mm").infeasible
    assert reported is not None
    assert (
        "there is no place without undercut and with r_R/r_K at most 0.001 up to a base" in reported
    )
    assert f"the smallest ratio found is about {found.nearest_ratio:.3g}" in reported


@pytest.mark.parametrize(
    ("angle", "ratio", "key"),
    [
        (0.0, 0.7, "transmission_angle"),
        (math.pi / 2.0, 0.7, "transmission_angle"),
        (math.nan, 0.7, "transmission_angle"),
        (1.0, 0.0, "radius_ratio"),
        (1.0, 1.1, "radius_ratio"),
    ],
)
def test_a_wrong_requirement_is_refused(angle: float, ratio: float, key: str) -> None:
    task, _, _ = required("setzhub")
    with pytest.raises(GeometryError) as caught:
        size(task, angle, ratio)
    assert caught.value.key == key
