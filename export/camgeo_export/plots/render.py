"""Figures as files: the plots asked for, one above the other, with the same bytes each time."""

from __future__ import annotations

import difflib
from collections.abc import Callable, Sequence
from importlib.metadata import entry_points
from typing import Protocol

from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure, SubFigure

from camgeo.files.product import Product
from camgeo_export.plots import cam, curvature, effects, mechanism, motion, transmission_angle
from camgeo_export.plots.file import figure_file

GROUP = "camgeo.plots"
"""Entry points that add plots to those of this package."""


Size = tuple[float, float]


class Plot(Protocol):
    """A kind of figure: a module of this package, or any object of that shape.

    Attributes
    ----------
    size : width and height [inch] of the figure on its own, or what gives them for a product.
    """

    @property
    def size(self) -> Size | Callable[[Product], Size]: ...

    def draw(self, product: Product, figure: Figure | SubFigure) -> None:
        """Draw into the empty `figure`."""


PLOTS: dict[str, Plot] = {
    "motion": motion,
    "cam": cam,
    "mechanism": mechanism,
    "curvature": curvature,
    "transmission-angle": transmission_angle,
    "effects": effects,
}


def find(name: str) -> Plot:
    """The plot of that name; raises KeyError with the names there are."""
    if name in PLOTS:
        return PLOTS[name]
    others = {entry.name: entry for entry in entry_points(group=GROUP)}
    if name in others:
        plot: Plot = others[name].load()
        return plot
    known = [*PLOTS, *others]
    near = difflib.get_close_matches(name, known, 1)
    hint = f"; did you mean {near[0]}?" if near else ""
    raise KeyError(f"no plot {name!r}; there are {', '.join(known)}{hint}")


def render(names: Sequence[str], product: Product, suffix: str) -> bytes:
    """The plots `names` of `product` as a file of kind `suffix`: ".svg", ".png" or ".pdf"."""
    return figure_file(lambda: _figure(names, product), suffix)


def _figure(names: Sequence[str], product: Product) -> Figure:
    plots = [find(name) for name in names]
    sizes = [plot.size(product) if callable(plot.size) else plot.size for plot in plots]
    width = max(size[0] for size in sizes)
    heights = [size[1] for size in sizes]
    figure = Figure(figsize=(width, sum(heights)))
    FigureCanvasAgg(figure)
    rows = figure.subfigures(len(plots), 1, height_ratios=heights, hspace=0.0, squeeze=False)
    for plot, row in zip(plots, rows[:, 0], strict=True):
        plot.draw(product, row)
    return figure
