"""A turn of the mechanism as data: what turns stays in the window, with a disc and without."""

from __future__ import annotations

from pathlib import Path
from typing import Final

import numpy as np
import pytest

import camgeo
from camgeo.pictures.mechanism import animation
from camgeo.pictures.model import Area, Line
from tests import kept

FIXTURES: Final = Path(__file__).parents[2] / "fixtures"

WHOLE: Final = ("groove", "conjugate_lever", "swallow_tail")

WITHOUT_DISC: Final = sorted((FIXTURES / "refused").glob("*.toml"))


@pytest.mark.parametrize(
    "path",
    [*(FIXTURES / "scenes" / f"{name}.toml" for name in WHOLE), *WITHOUT_DISC],
    ids=lambda path: path.stem,
)
def test_what_turns_stays_in_the_window(path: Path) -> None:
    """So do flanks that are undercut, with the signs on them, and the pitch curve around a disc."""
    turn = animation(camgeo.load(path).disc)
    areas = [mark for mark in turn.turning if isinstance(mark, Area)]
    lines = [mark for mark in turn.turning if isinstance(mark, Line)]
    points = np.concatenate(
        [*(ring for mark in areas for ring in mark.rings), *(mark.points for mark in lines)]
    )
    reach = float(np.hypot(*points.T).max())
    assert bool(turn.note) == (path in WITHOUT_DISC)
    assert max(turn.low.real, turn.low.imag, -turn.high.real, -turn.high.imag) <= -reach


TURNS: Final = ("scenes/setzhub", "scenes/groove", "scenes/conjugate_lever", "scenes/tappet",
                "effects/yoke", "refused/global_undercut")  # fmt: skip


def test_turns_are_as_kept() -> None:
    """What turns, slides and rocks, mark by mark and place by place, and in a drag."""
    kept.compare(
        "figure/turns.txt",
        (
            (f"{name}{', moving' if moving else ''}", kept.marks(animation(disc, moving=moving)))
            for name in TURNS
            for disc in [camgeo.load(FIXTURES / f"{name}.toml").disc]
            for moving in (False, True)
        ),
    )
