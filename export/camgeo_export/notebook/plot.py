"""Plots of a design as figures of matplotlib."""

from __future__ import annotations

from collections.abc import Sequence

from camgeo.design.design import Design
from camgeo.pictures.plots import of_design
from camgeo_export.plots import Picture, drawn


def plot(design: Design, names: Sequence[str]) -> Picture:
    """The plots of those names, as `camgeo plot` draws them; see
    `camgeo.design.design.Design.plot`.
    """
    return drawn(of_design(design, names)[0])
