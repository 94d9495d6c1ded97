"""Pictures of sweeps: each design is where its values are, in the colour of its answer."""

from __future__ import annotations

from collections.abc import Sequence
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

from camgeo.errors import GeometryError, UnknownNameError
from camgeo.pictures.model import Figure, Line
from camgeo.pictures.sweep import (
    COLOURS,
    column,
    map_figure,
    objectives,
    require,
)
from camgeo.studies.sweep.family import Sample, family_of
from camgeo.studies.sweep.rows import DesignRow
from camgeo.studies.sweep.sweep import SweepResult
from tests.sweep.families import SETZHUB, family


def found(vary: Sequence[str], answer: Any, sample: Sample | None = None) -> SweepResult:
    """A result whose answers are made up: two numbers for each design."""
    designs = family_of(SETZHUB, vary, sample)
    rows = [DesignRow(point, answer(*point), ("mm", "")) for point in designs.points()]
    asked = tuple(SimpleNamespace(word=word) for word in ("diameter", "peak:mu"))
    return cast(SweepResult, SimpleNamespace(family=designs, rows=rows, questions=asked))


def lines(figure: Figure) -> list[Line]:
    return [mark for mark in figure.panels[0].marks if isinstance(mark, Line)]


def test_a_map_of_samples_has_a_point_for_each() -> None:
    result = found(
        ["follower.base_radius=40:60", "follower.arm=55:70"],
        lambda radius, arm: (float(radius + arm), None if radius > 55 else 1.0),
        Sample(32),
    )
    first, second = map_figure(result).rows
    for figure in (first, second):
        points = np.concatenate([line.points for line in lines(figure)])
        assert sorted(map(tuple, points)) == sorted(map(tuple, (row.point for row in result.rows)))
    assert [line.style.marker for line in lines(second)] == ["x", "o"]


def test_what_cannot_be_drawn_is_refused_before_it_is_computed() -> None:
    with pytest.raises(GeometryError, match="at most 20,000 designs, not 30,000 designs"):
        require(family("follower.base_radius=30:60:30000"), "parallel")
    three = family("follower.base_radius=1,2", "follower.arm=1,2", "cam.speed=1,2")
    with pytest.raises(GeometryError, match="a map has one or two variables, not 3"):
        require(three, "map")
    with pytest.raises(UnknownNameError, match='did you mean "diameter"'):
        objectives(["diameter", "mass"], ["diametr"], [])
    for least in (["diameter"], ["diameter", "diameter"]):
        with pytest.raises(GeometryError, match="two objectives or more"):
            objectives(["diameter", "mass"], least, [])


def test_words_and_numbers_alike() -> None:
    words = column("law", ["b", None, "a", "b"])
    assert words.words == ("b", "a")
    assert np.array_equal(words.values, [0.0, np.nan, 1.0, 0.0], equal_nan=True)
    assert words.axis.names == ("b", "a")
    assert words.colour(words.level(1.0)) == COLOURS[-1]
    same = column("x", [2, 2.0])
    assert same.colour(same.level(2.0)) == COLOURS[0]
    assert column("none", [None, None]).axis.limits == (0.0, 1.0)
