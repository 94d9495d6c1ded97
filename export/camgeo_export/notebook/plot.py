"""Plots of a design as figures of matplotlib."""

from __future__ import annotations

from collections.abc import Sequence

from camgeo.design import Design
from camgeo.figure.plots import of_design
from camgeo_export.plots.render import Picture, drawn


def plot(design: Design, names: Sequence[str]) -> Picture:
    """The plots of those names, as `camgeo plot` draws them; see `camgeo.design.Design.plot`."""
    return drawn(of_design(design, names)[0])
