"""The smallest base circle, by perturbing it, and what cannot be met."""

from __future__ import annotations

import math

import numpy as np
import pytest

from camgeo.check.sizing.bends import conditions
from camgeo.check.sizing.smallest import rate, size
from camgeo.check.sizing.task import tangent_of
from camgeo.errors import GeometryError
from tests.check.sizing_scenes import BENT, EASY, required


@pytest.mark.parametrize("name", [*EASY, *BENT])
def test_the_answer_keeps_its_requirement_and_no_smaller_one_does(name: str) -> None:
    task, angle, ratio = required(name)
    found = size(task, angle, ratio)
    assert found.answer is not None
    best = found.answer.place
    assert found.answer.transmission_angle[0] >= angle - 1e-9
    assert found.answer.radius_ratio[0] <= ratio + 1e-9
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
                or rating.transmission_angle[0] < angle
                or rating.radius_ratio[0] > ratio
            ), (shrink, turn)


@pytest.mark.parametrize("name", BENT)
def test_no_smaller_circle_is_seen_anywhere(name: str) -> None:
    """A finer grid than that of the search, over all directions, at other cam angles."""
    task, angle, ratio = required(name)
    found = size(task, angle, ratio)
    assert found.answer is not None
    phi = np.linspace(0.0, 2.0 * math.pi, 721)
    now = conditions(task, tangent_of(angle), ratio, phi)
    theta = np.linspace(-math.pi, 0.0, 400)
    for share in np.linspace(0.7, 0.9995, 8):
        places = task.start + share * found.answer.base_radius * np.exp(1j * theta)
        assert not np.any(now.met(places))


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


def test_a_ratio_that_no_place_keeps() -> None:
    """A very large roller: the circles that would do lie beyond what is looked at."""
    task, angle, _ = required("vorschub")
    found = size(task, angle, 1e-3)
    assert found.answer is None
    assert found.for_angle is not None
    assert found.nearest_ratio is not None
    assert found.nearest_ratio > 1e-3


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
