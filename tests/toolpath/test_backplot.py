"""Traces of a program: what is cut, in air, an entry or a traverse."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import camgeo
from camgeo.geometry.contour.contour import Contour
from camgeo.milling.cut import ContourCut
from camgeo.milling.milling import Heights, Tool
from camgeo.milling.moves import ArcFeed, Feed, Operation, Rapid, Toolpath, course_of
from camgeo.part.boundaries import ExactBoundary
from camgeo.pictures.backplot import plotted

SCENES = Path(__file__).resolve().parents[2] / "fixtures" / "scenes"

TOOL = Tool(number=1, diameter=6.0, spindle_speed=3000.0, feed=300.0, plunge_feed=100.0)

BLANK = (Contour.polygon(np.array([0.0, 100.0, 100.0 + 50.0j, 50.0j])),)


def test_kinds_of_a_program() -> None:
    """In from beside the blank, along it, down a ramp, and back through what is cut."""
    moves = (
        Rapid((-20.0, 25.0, 5.0)),
        Feed((-20.0, 25.0, -1.0), 100.0),
        Feed((-10.0, 25.0, -1.0), 300.0),
        Feed((20.0, 25.0, -1.0), 300.0),
        Feed((30.0, 25.0, -2.0), 100.0),
        ArcFeed((40.0, 25.0, -2.0), (35.0, 25.0), True, 300.0),
        Rapid((40.0, 25.0, 5.0)),
        Rapid((0.0, 0.0, 5.0)),
    )
    path = ExactBoundary("path", hole=False, exact=Contour.circle(10.0))
    cuts = [
        ContourCut(name=name, strategy="profile", tool=TOOL, top=0.0, depths=(-2.0,), centre=path)
        for name in ("first", "second")
    ]
    toolpath = Toolpath(Heights(5.0, 5.0), tuple(Operation(cut, moves) for cut in cuts))
    first, second = plotted(toolpath, BLANK, 0.0, 0.01)
    kinds = [trace.kind for trace in first.traces]
    assert kinds == ["entry", "air", "cut", "entry", "cut", "rapid"]
    assert first.length("air") == pytest.approx(10.0)
    assert first.length("entry") == pytest.approx(10.0)
    assert first.length("rapid") == pytest.approx(abs(40.0 + 25.0j))
    arc = first.traces[4].points
    assert abs(arc[0] - 30.0 - 25.0j) < 1e-12
    assert np.allclose(np.abs(arc - 35.0 - 25.0j), 5.0)
    # What the first operation cut is air for the second.
    assert [trace.kind for trace in second.traces] == ["entry", "air", "entry", "air", "rapid"]


def test_traces_have_the_length_of_the_course() -> None:
    design = camgeo.load(SCENES / "setzhub.toml")
    toolpath = design.disc.milled.toolpath(0.01)
    for each in plotted(toolpath, BLANK, 0.0, 1e-4):
        course = course_of(each.operation.moves)
        fed = sum(each.length(kind) for kind in ("cut", "air", "entry"))
        assert fed == pytest.approx(float(np.sum(course.lengths)), rel=1e-4)
