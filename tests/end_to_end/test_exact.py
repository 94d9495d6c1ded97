"""The reference for measuring files: no part of it comes closer to the roller than it may."""

from __future__ import annotations

import numpy as np
import pytest

from tests.end_to_end.built import CHORDS, SCENES, Built
from tests.end_to_end.exact import half_width
from tests.end_to_end.features import DENSE
from tests.measuring import DensePath

PITCH = 100_000
"""Points of the pitch curve: chords of 2.4e-2 mm at most, four times as long as those of `CHORDS`,
so that they lie sixteen times as far off."""

TRIMMED = [
    path
    for path in SCENES
    if path.stem in ("swallow_tail", "cut_lobe", "trimmed_ring", "straight_moves")
]


@pytest.mark.parametrize("built", TRIMMED, indirect=True, ids=lambda path: path.stem)
def test_what_is_left_is_clear_of_the_roller(built: Built) -> None:
    assert built.is_trimmed
    pitch = DensePath(built.pitch.dense(PITCH))
    for flank in built.flanks:
        away = pitch.distances(flank.dense(DENSE // 10))
        assert np.min(away) >= half_width(built.design) - 16.0 * CHORDS
        assert np.max(away) <= half_width(built.design) + 16.0 * CHORDS
