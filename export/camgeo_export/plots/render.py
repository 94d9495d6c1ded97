"""Figures as files: the plots asked for, one above the other, with the same bytes each time."""

from __future__ import annotations

import difflib
import io
from collections.abc import Sequence
from importlib.metadata import entry_points
from typing import Any, Protocol

from matplotlib import rc_context
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure, SubFigure

from camgeo.files.product import Product
from camgeo_export.plots import cam, curvature, motion, transmission_angle
from camgeo_export.plots.style import RC

GROUP = "camgeo.plots"
"""Entry points that add plots to those of this package."""


class Plot(Protocol):
    """A kind of figure: a module of this package, or any object of that shape.

    Attributes
    ----------
    size : width and height [inch] of the figure on its own.
    """

    @property
    def size(self) -> tuple[float, float]: ...

    def draw(self, product: Product, figure: Figure | SubFigure) -> None:
        """Draw into the empty `figure`."""


PLOTS: dict[str, Plot] = {
    "motion": motion,
    "cam": cam,
    "curvature": curvature,
    "transmission-angle": transmission_angle,
}

RESOLUTION = 150
"""Dots per inch of a PNG."""

# No time, no version: the bytes depend on the product only.
METADATA: dict[str, dict[str, Any]] = {
    "svg": {"Date": None, "Creator": "camgeo"},
    "png": {"Software": "camgeo"},
    "pdf": {"CreationDate": None, "Creator": "camgeo", "Producer": None},
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
    kind = suffix.removeprefix(".")
    if kind not in METADATA:
        raise ValueError(f"no figures of kind {suffix}; there are .svg, .png and .pdf")
    plots = [find(name) for name in names]
    with rc_context({**RC, "svg.hashsalt": "camgeo"}):
        width = max(plot.size[0] for plot in plots)
        heights = [plot.size[1] for plot in plots]
        figure = Figure(figsize=(width, sum(heights)))
        FigureCanvasAgg(figure)
        rows = figure.subfigures(len(plots), 1, height_ratios=heights, hspace=0.0, squeeze=False)
        for plot, row in zip(plots, rows[:, 0], strict=True):
            plot.draw(product, row)
        stream = io.BytesIO()
        figure.savefig(stream, format=kind, dpi=RESOLUTION, metadata=METADATA[kind])
    return stream.getvalue()
