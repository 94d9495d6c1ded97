"""The picture of a program shows what is in the way of each operation."""

from __future__ import annotations

from pathlib import Path

import numpy as np

import camgeo
from camgeo.pictures.backplot import CLAMP, figure
from camgeo.pictures.model import Area

SCENE = Path(__file__).parents[2] / "fixtures" / "milling" / "moved_clamps.toml"


def test_clamps_stand_where_they_are_during_each_operation() -> None:
    found = figure(camgeo.load(SCENE).disc)
    places = []
    for panel in found.panels:
        areas = [mark for mark in panel.marks if isinstance(mark, Area) and mark.style == CLAMP]
        boxes = [(np.min(area.rings[0], axis=0), np.max(area.rings[0], axis=0)) for area in areas]
        places.append({tuple(np.round(0.5 * (low + high), 9).tolist()) for low, high in boxes})
    edges = {(-62.0, 0.0), (62.0, 0.0)}
    first, strap = {*edges, (0.0, -40.0)}, {*edges, (0.0, 0.0)}
    assert places == [first, first, strap, strap]
    assert found.legend is not None
    assert "clamp or screw" in [entry.label for entry in found.legend.entries]
