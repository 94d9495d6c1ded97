"""The picture of a mechanism and its turn: lengths can be read, what turns stays in the window."""

from __future__ import annotations

import itertools
import math
from pathlib import Path
from typing import Final

import numpy as np
import pytest

import camgeo
from camgeo.kinematics.mechanism.sketch import Dimension, MechanismSketch
from camgeo.pictures import mechanism
from camgeo.pictures.mechanism import animation
from camgeo.pictures.model import Area, Line, Text
from tests import kept

SCENES = sorted((Path(__file__).parents[2] / "fixtures" / "scenes").glob("*.toml"))


@pytest.mark.parametrize("scene", SCENES, ids=lambda path: path.stem)
def test_each_number_of_a_length_stands_in_the_list(scene: Path) -> None:
    product = camgeo.load(scene).disc
    figure = mechanism.figure(product)
    first, second = figure.panels
    numbers = [mark for mark in first.marks if isinstance(mark, Text)]
    assert not any(isinstance(mark, Text) for mark in second.marks)
    _, *listed = figure.texts
    assert [mark.text for mark in numbers] == [text.text.split()[0] for text in listed]
    dimensions = product.pictured.mechanism_sketch(0.0).dimensions
    for each, text in zip(dimensions, listed, strict=True):
        assert f"  {each.key} = " in text.text
        assert text.text.endswith(f" {product.unit}")
    # They lie in the panel, and on the page below it.
    (left, right), (low, high) = first.x.limits, first.y.limits
    for mark in numbers:
        assert left <= mark.at[0] <= right
        assert low <= mark.at[1] <= high
    assert all(0.0 < text.at[1] < first.frame[1] for text in listed)
    scale = (first.frame[2] - first.frame[0]) * figure.size[0] / (right - left)
    for one, other in itertools.combinations(numbers, 2):
        assert math.dist(one.at, other.at) * scale >= 0.5 * mechanism.APART


def test_a_length_of_nothing_has_its_number_beside_it() -> None:
    """As that of a pivot so near to the cam axis that a picture shows them as one."""
    places = [0j, 1e-300 + 0j, 1.0 + 0.0j]
    dimensions = [Dimension("arm", 0j, each) for each in places]
    scale = 0.05
    marks = mechanism._measures(dimensions, MechanismSketch(), scale)
    numbers = [mark for mark in marks if isinstance(mark, Text)]
    assert [mark.text for mark in numbers] == ["1", "2", "3"]
    for mark, place in zip(numbers, places, strict=True):
        away = abs(complex(*mark.at) - place) * scale
        assert mechanism.BEYOND * (1.0 - 1e-9) <= away <= 4.0 * mechanism.BEYOND * (1.0 + 1e-9)


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
