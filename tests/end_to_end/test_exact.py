"""The reference for measuring files: no part of it comes closer to the roller than it may."""

from __future__ import annotations

import math

import numpy as np
import pytest

from tests.end_to_end.built import CHORDS, SCENES, Built
from tests.end_to_end.exact import TURN, half_width
from tests.end_to_end.features import DENSE
from tests.measuring import DensePath
from tests.reference import hard_case

PITCH = 100_000
"""Points of the pitch curve: chords of 2.4e-2 mm at most, four times as long as those of `CHORDS`,
so that they lie sixteen times as far off."""

TRIMMED = [
    path
    for path in SCENES
    if path.stem in ("swallow_tail", "cut_lobe", "trimmed_ring", "straight_moves")
]

CORNERS = {
    "swallow_tail": 1,
    "cut_lobe": 1,
    "trimmed_ring": 2,
    "straight_moves": 2,
    "knife_edge": 1,
}

CROSSINGS = {
    "swallow_tail": ("HC21c", "crossing_phi1_deg", "crossing_phi2_deg"),
    "cut_lobe": ("HC22", "self_intersections_on_axis_phi_deg", "mirror_phi_deg"),
}
"""Hard cases, and where they name the cam angles of the crossing; of a list the first counts."""


@pytest.mark.parametrize("built", TRIMMED, indirect=True, ids=lambda path: path.stem)
def test_what_is_left_is_clear_of_the_roller(built: Built) -> None:
    assert built.is_trimmed
    pitch = DensePath(built.pitch.dense(PITCH))
    for flank in built.flanks:
        away = pitch.distances(flank.dense(DENSE // 10))
        assert np.min(away) >= half_width(built.design) - 16.0 * CHORDS
        assert np.max(away) <= half_width(built.design) + 16.0 * CHORDS


def test_corners_are_where_they_should_be(built: Built) -> None:
    name = built.design.name
    corners = [corner for flank in built.flanks for corner in flank.corners]
    assert len(corners) == CORNERS.get(name, 0)
    if name not in CROSSINGS:
        return
    case, *keys = CROSSINGS[name]
    _, expected = hard_case(case)
    named = [expected[key] for key in keys]
    before, after = (float(each[0] if isinstance(each, list) else each) for each in named)
    ((start, end),) = built.flanks[0].kept.stretches
    assert math.degrees(end - TURN) == pytest.approx(before, abs=1e-9)
    assert math.degrees(start) == pytest.approx(after, abs=1e-9)
    if "crossing_point" in expected:
        x, y = map(float, expected["crossing_point"])
        assert abs(corners[0] - complex(x, y)) < 1e-12
    else:
        radius = float(expected["radial_position_mm"][0])
        axis = math.radians(expected["lobe_axis_angle_deg"])
        assert abs(corners[0] - radius * np.exp(1j * axis)) < 1e-12
