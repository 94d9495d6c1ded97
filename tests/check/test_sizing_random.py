"""Random cams: the size that is written keeps every limit of `camgeo check`, and no smaller one
does.

The checks themselves, which know nothing of sizing, decide whether a cam is sound.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from camgeo.cam.cam import Cam
from camgeo.check.finding import NO_OUTLINE, Limits
from camgeo.check.judge import disc_findings
from camgeo.check.sizing.rounding import exponent_of, rounded, rounded_face
from camgeo.check.sizing.smallest import size, size_for_face
from camgeo.check.sizing.task import FaceTask, Task, face_task_of, task_of
from camgeo.errors import GeometryError
from camgeo.geometry.outline.convex import convexity
from tests.check.sizing_random import face_cam, roller_cam
from tests.long_form import examples

ANGLES = (12.0, 30.0, 45.0)
RATIOS = (0.6, 0.8, 0.95, 1.0)
RADII = (0.0, 0.0, 2.0, 8.0)


def keeps(cam: Cam, angle: float, ratio: float) -> bool:
    """Whether the checks find nothing wrong, including that a roller does not jam in its groove."""
    limits = Limits(transmission_angle=angle, radius_ratio=ratio)
    bad = ("broken", *NO_OUTLINE)
    return not any(each.severity in bad for each in disc_findings(cam, limits))


def nearby(task: Task, place: complex, radius: float, seed: int) -> Iterator[complex]:
    """Places with a base radius: in all directions, and more of them near `place`."""
    theta = float(np.angle(place - task.start))
    turns = np.random.default_rng(seed).uniform(-math.pi, 0.0, 2)
    for way in (*(theta + np.array([0.0, 1e-6, -1e-6, 0.01, -0.01])), *turns):
        if -math.pi < way < 0.0:
            yield complex(task.start + radius * np.exp(1j * way))


def is_smaller(task: Task, place: complex, angle: float, ratio: float) -> bool:
    """Whether the cam axis may lie at `place`, according to the checks."""
    try:
        return keeps(task.cam_at(place), angle, ratio)
    except GeometryError:
        return False


def fits(task: FaceTask, radius: float, angle: float, least: float) -> bool:
    """Whether a flat-faced cam may have this base radius and keep radii of at least `least`."""
    try:
        cam = task.cam.sized(base_radius=radius)
    except GeometryError:
        return False
    return keeps(cam, angle, 1.0) and convexity(cam.disc.pitch_curve).radius[0] >= least


@given(
    st.integers(0, 10**6), st.sampled_from(ANGLES), st.sampled_from(RATIOS), st.sampled_from((1, 2))
)
@settings(max_examples=examples(2, long=300))
def test_the_size_of_a_roller_cam(seed: int, degrees: float, ratio: float, inches: int) -> None:
    cam, angle, unit = roller_cam(seed), math.radians(degrees), (1.0, 25.4)[inches - 1]
    for task in task_of(cam).sides:
        found = size(task, angle, ratio)
        if found.answer is None:
            # A swing too large for the angle: at most 90 degrees less half the swing can be kept.
            assert found.nearest_angle is not None
            assert found.nearest_angle < angle
            continue
        assert found.examined is not None
        place, limit = found.answer.place, found.answer.base_radius
        assert found.none_below <= limit * (1.0 + 1e-9)
        assert found.none_below >= limit * (1.0 - 5e-3)
        made = rounded(task, place, found.examined, angle, ratio, unit)
        assert made is not None
        assert keeps(made.cam, angle, ratio)
        last = unit * 10.0 ** exponent_of(limit, unit)
        written = made.cam.follower.base_radius
        assert limit * (1.0 - 1e-9) <= written
        assert written / last == pytest.approx(round(written / last), abs=1e-6)
        # One unit less in the last digit, and what is just below the limit.
        for radius in (written - 1.001 * last, limit * (1.0 - 1e-6)):
            if radius < limit:
                for other in nearby(task, place, radius, seed):
                    assert not is_smaller(task, other, angle, ratio)
        if found.exact:
            assert written < limit + 1.001 * last


@given(st.integers(0, 10**6), st.sampled_from(ANGLES), st.sampled_from(RADII))
@settings(max_examples=examples(4, long=600))
def test_the_size_of_a_flat_faced_cam(seed: int, degrees: float, least: float) -> None:
    cam, angle = face_cam(seed), math.radians(degrees)
    for task in face_task_of(cam).sides:
        found = size_for_face(task, angle, least)
        most = task.follower.farthest
        tried = np.linspace(0.0, most if math.isfinite(most) else 300.0, 14)[1:-1]
        if found.answer is None:
            assert not any(fits(task, float(radius), angle, least) for radius in tried)
            continue
        limit = found.answer.base_radius
        made = rounded_face(task, found.answer.place, angle, least, 1.0)
        assert made is not None
        written = made.cam.follower.base_radius
        assert fits(task, written, angle, least)
        assert limit <= written < limit + 1.001e-4
        smaller = (limit * (1.0 - 1e-6), written - 1e-4, *tried[tried < limit])
        assert not any(
            fits(task, float(radius), angle, least) for radius in smaller if radius < limit - 1e-9
        )
