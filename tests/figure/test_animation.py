"""A turn of the mechanism as data: flanks stay in the window, with a disc and without."""

from __future__ import annotations

from pathlib import Path
from typing import Final

import numpy as np
import pytest

import camgeo
from camgeo.figure.animation import PITCH, animation
from camgeo.figure.marks import Area, Line

FIXTURES: Final = Path(__file__).parents[2] / "fixtures"

WITHOUT_DISC: Final = sorted((FIXTURES / "refused").glob("*.toml"))


@pytest.mark.parametrize(
    "path", [FIXTURES / "scenes" / "groove.toml", *WITHOUT_DISC], ids=lambda path: path.stem
)
def test_flanks_that_turn_stay_in_the_window(path: Path) -> None:
    """So do those that are undercut, which reach beyond the base circle, with the signs on them."""
    turn = animation(camgeo.load(path).disc)
    areas = [mark for mark in turn.turning if isinstance(mark, Area)]
    lines = [mark for mark in turn.turning if isinstance(mark, Line) and mark.style is not PITCH]
    points = np.concatenate(
        [*(ring for mark in areas for ring in mark.rings), *(mark.points for mark in lines)]
    )
    reach = float(np.hypot(*points.T).max())
    assert bool(turn.note) == (path in WITHOUT_DISC)
    assert max(turn.low.real, turn.low.imag, -turn.high.real, -turn.high.imag) <= -reach
