"""Pictures of sweeps: each design is where its values are, in the colour of its answer."""

from __future__ import annotations

from collections.abc import Sequence
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

from camgeo.errors import GeometryError, UnknownNameError
from camgeo.pictures.model import Area, Figure, Line
from camgeo.pictures.sweep import (
    COLOURS,
    FAILED,
    column,
    map_of,
    objectives,
    parallel,
    pareto,
    require,
)
from camgeo.studies.sweep.family import Sample, family_of
from camgeo.studies.sweep.rows import Row
from camgeo.studies.sweep.sweep import Result
from camgeo_export.plots import render
from tests.sweep.families import SETZHUB, family


def found(vary: Sequence[str], answer: Any, sample: Sample | None = None) -> Result:
    """A result whose answers are made up: two numbers for each design."""
    designs = family_of(SETZHUB, vary, sample)
    rows = [Row(point, answer(*point), ("mm", "")) for point in designs.points()]
    asked = tuple(SimpleNamespace(word=word) for word in ("diameter", "peak:mu"))
    result = SimpleNamespace(family=designs, rows=rows, asked=asked)
    return cast(Result, result)


def cells(figure: Figure) -> list[Area]:
    return [mark for mark in figure.panels[0].marks if isinstance(mark, Area)]


def lines(figure: Figure) -> list[Line]:
    return [mark for mark in figure.panels[0].marks if isinstance(mark, Line)]


def test_a_map_has_a_cell_for_each_design() -> None:
    result = found(
        ["follower.base_radius=40,50,70", "cam.rotation=cw,ccw"],
        lambda radius, sense: (None if radius == 50 and sense == "cw" else float(radius), 1.0),
    )
    first, second = map_of(result).rows
    areas = cells(first)
    assert len(areas) == 6
    corners = [(tuple(area.rings[0].min(axis=0)), tuple(area.rings[0].max(axis=0)))
               for area in areas]  # fmt: skip
    assert corners[0] == ((35.0, -0.5), (45.0, 0.5))
    assert corners[3] == ((45.0, 0.5), (60.0, 1.5))
    assert corners[4] == ((60.0, -0.5), (80.0, 0.5))
    faces = [area.style for area in areas]
    assert faces[2] == FAILED
    assert [face.face for face in faces[:2]] == [COLOURS[0]] * 2
    assert [face.face for face in faces[4:]] == [COLOURS[-1]] * 2
    legend = first.panels[0].legend
    assert legend is not None
    assert [entry.label for entry in legend.entries][-2:] == ["40 to 43.75", "no answer"]
    assert len(cells(second)) == 6
    assert render(map_of(result), ".svg").startswith(b"<?xml")


def test_a_map_of_samples_has_a_point_for_each() -> None:
    result = found(
        ["follower.base_radius=40:60", "follower.arm=55:70"],
        lambda radius, arm: (float(radius + arm), None if radius > 55 else 1.0),
        Sample(32),
    )
    first, second = map_of(result).rows
    for figure in (first, second):
        points = np.concatenate([line.points for line in lines(figure)])
        assert sorted(map(tuple, points)) == sorted(map(tuple, (row.point for row in result.rows)))
    assert [line.style.marker for line in lines(second)] == ["x", "o"]


def test_one_key_gives_curves() -> None:
    result = found(["follower.base_radius=60,40,50"], lambda radius: (2.0 * radius, None))
    first, _ = map_of(result).rows
    (line,) = lines(first)
    assert line.points.tolist() == [[40.0, 80.0], [50.0, 100.0], [60.0, 120.0]]


def test_parallel_axes_have_a_line_for_each_design_with_all_answers() -> None:
    result = found(
        ["follower.base_radius=40,50", "cam.rotation=cw,ccw", "follower.arm=60,61"],
        lambda radius, sense, arm: (float(arm), None if sense == "cw" else float(radius)),
    )
    figure = parallel(result)
    designs = [line for line in lines(figure) if len(line.points) == 5]
    assert len(designs) == 4
    assert len([line for line in lines(figure) if len(line.points) == 2]) == 5
    assert figure.panels[0].title == "setzhub: 4 designs, without 4 that lack an answer"
    for line in designs:
        assert np.all((line.points[:, 1] >= 0.0) & (line.points[:, 1] <= 1.0))
    assert designs[0].style.color == COLOURS[0]
    assert designs[-1].style.color == COLOURS[-1]


def test_the_front_is_drawn_in_its_order() -> None:
    result = found(
        ["follower.base_radius=40,45,50,55"],
        lambda radius: (float(radius), {40: 1.0, 45: 3.0, 50: 2.0, 55: 4.0}[radius]),
    )
    others, best = lines(pareto(result, ["diameter"], ["peak: mu"]))
    assert best.points.tolist() == [[40.0, 1.0], [45.0, 3.0], [55.0, 4.0]]
    assert others.points.tolist() == [[50.0, 2.0]]


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
