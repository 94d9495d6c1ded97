"""Points that were measured in other axes."""

from __future__ import annotations

import pytest

from camgeo.geometry.outline.path import Flank
from camgeo.studies.inspection import other_axes
from tests.findings import known
from tests.inspection.flanks import every, flank_of, measured

SHIFT, TURN = 12.0 - 5.0j, 1.2


@pytest.mark.parametrize("mirrored", [False, True])
@pytest.mark.parametrize(
    ("name", "side"), [("plate_translating", Flank.INNER), ("groove", Flank.OUTER)]
)
def test_they_are_found(name: str, side: Flank, mirrored: bool) -> None:
    flank = flank_of(name, side)
    points = measured(every(flank, 90), 0.0, SHIFT, TURN)
    found = known(other_axes(flank, points.conj() if mirrored else points, 5.0))
    assert found.mirrored == mirrored
    assert found.frame.shift == pytest.approx(SHIFT, abs=1e-9)
    assert found.frame.turn == pytest.approx(TURN, abs=1e-9)
    assert found.left < 1e-9


def test_none_are_sought_for_errors_of_making_nor_found_of_another_disc() -> None:
    flank = flank_of("plate_translating", Flank.INNER)
    points = measured(every(flank, 90), 0.0, SHIFT, TURN)
    assert other_axes(flank, points, 0.05) is None
    assert other_axes(flank, points[:10], 5.0) is None
    assert other_axes(flank, every(flank_of("ring", Flank.OUTER), 90).points, 20.0) is None
