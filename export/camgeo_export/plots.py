"""A figure as the bytes of a file, drawn by matplotlib; the same figure gives the same bytes."""

from __future__ import annotations

import io
from collections.abc import Sequence
from dataclasses import dataclass
from functools import singledispatch
from typing import TYPE_CHECKING, Any, Final, Literal

import numpy as np
from matplotlib import rc_context
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import PolyCollection
from matplotlib.figure import Figure as Page
from matplotlib.figure import SubFigure
from matplotlib.lines import Line2D
from matplotlib.patches import Circle as Round
from matplotlib.patches import FancyArrowPatch, Patch, PathPatch, Rectangle
from matplotlib.path import Path
from matplotlib.transforms import Bbox

from camgeo.design.product import Product
from camgeo.design.writing import Written
from camgeo.pictures.model import (
    Area,
    Arrow,
    Axis,
    Band,
    Circle,
    Field,
    Figure,
    Fill,
    Inset,
    Legend,
    Line,
    Panel,
    Rule,
    Style,
    Text,
)
from camgeo.pictures.plots import of_design, stacked
from camgeo.scene.formats import format as plain
from camgeo.scene.formats.format import Format

if TYPE_CHECKING:
    from camgeo.design.design import Design

RC: Any = {
    "font.family": "DejaVu Sans",  # comes with matplotlib: the same bytes on each machine
    "font.size": 9.0,
    "axes.linewidth": 0.7,
    "axes.titlesize": 11.0,
    "axes.labelsize": 9.0,
    "axes.grid": True,
    "grid.color": "#d4d4d4",
    "grid.linewidth": 0.5,
    "axes.axisbelow": True,
    "lines.linewidth": 1.4,
    "xtick.direction": "in",
    "ytick.direction": "in",
    "legend.fontsize": 8.0,
    "legend.frameon": True,
    "legend.framealpha": 1.0,
    "legend.edgecolor": "#a0a0a0",
    "legend.fancybox": False,
    "axes.unicode_minus": True,
    "svg.fonttype": "path",
    "svg.hashsalt": "camgeo",
}

RESOLUTION = 150
"""Dots per inch of a PNG."""

ON_SCREEN = 96.0
"""Dots per inch of a page in a browser."""

# No time, no version: the bytes depend only on the figure.
METADATA: dict[str, dict[str, Any]] = {
    "svg": {"Date": None, "Creator": "camgeo"},
    "png": {"Software": "camgeo"},
    "pdf": {"CreationDate": None, "Creator": "camgeo", "Producer": None},
}


class Picture(Page):
    """A figure of matplotlib that a notebook shows, also where pyplot has not been imported."""

    def _repr_mimebundle_(self, include: object = None, exclude: object = None) -> Any:
        width, height = (round(ON_SCREEN * side) for side in self.get_size_inches())
        kind = "image/png"
        return {kind: self._repr_png_()}, {kind: {"width": width, "height": height}}

    def _repr_png_(self) -> bytes:
        return page_bytes(self, ".png")


def render(figure: Figure, suffix: str) -> bytes:
    """The figure as a file of kind `suffix`.

    Raises
    ------
    ValueError
        If `suffix` is not ".svg", ".png" or ".pdf".
    """
    return page_bytes(draw_page(figure), suffix)


@rc_context(RC)
def page_bytes(page: Page, suffix: str) -> bytes:
    """A page as a file of kind `suffix`; raises like `render`."""
    kind = suffix.removeprefix(".")
    if kind not in METADATA:
        raise ValueError(f"no figures of kind {suffix}; there are .svg, .png and .pdf")
    stream = io.BytesIO()
    page.savefig(stream, format=kind, dpi=RESOLUTION, metadata=METADATA[kind])
    return stream.getvalue()


def plot(design: Design, names: Sequence[str]) -> Picture:
    """The plots of those names, as `camgeo plot` draws them; see
    `camgeo.design.design.Design.plot`.
    """
    return draw_page(of_design(design, names)[0])


@rc_context(RC)
def draw_page(figure: Figure) -> Picture:
    """The figure as a page, to be saved in any kind of file."""
    page = Picture(figsize=figure.size)
    FigureCanvasAgg(page)
    if figure.rows:
        heights = [row.size[1] for row in figure.rows]
        places = page.subfigures(len(heights), 1, height_ratios=heights, hspace=0.0, squeeze=False)
        for row, place in zip(figure.rows, places[:, 0], strict=True):
            _fill(place, row)
    else:
        _fill(page, figure)
    return page


def _fill(place: Page | SubFigure, figure: Figure) -> None:
    panels = []
    for panel in figure.panels:
        left, bottom, right, top = panel.frame
        axes = place.add_axes(Bbox.from_extents(left, bottom, right, top))  # type: ignore[call-overload]  # takes a Bbox too, which the stubs lack
        _panel(axes, panel)
        panels.append(axes)
        if panel.right is not None:
            _further(axes.twinx(), panel.right, "y")
    for panel, axes in zip(figure.panels, panels, strict=True):
        if panel.above is not None:
            _further(axes.twiny(), panel.above, "x")
    if figure.aligned:
        column = place.add_gridspec(len(panels), 1)  # only panels in a grid are aligned
        for number, axes in enumerate(panels):
            frame = axes.get_position()
            axes.set_subplotspec(column[number, 0])
            axes.set_position(frame)
        place.align_ylabels(panels)
    for text in figure.texts:
        place.text(*text.at, text.text, **_text_style(text))
    if figure.legend is not None:
        place.legend(**_legend(figure.legend))


def _panel(axes: Axes, panel: Panel) -> None:
    if panel.bare:
        axes.set_axis_off()
    if panel.equal:
        axes.set_aspect("equal")
    _axis(axes, panel.x, "x")
    _axis(axes, panel.y, "y")
    for mark in panel.marks:
        draw(mark, axes)
    if panel.title:
        axes.set_title(panel.title, fontsize=panel.title_size, pad=panel.title_gap)
    if panel.legend is not None:
        axes.legend(**_legend(panel.legend))


def _axis(axes: Axes, axis: Axis, name: Literal["x", "y"]) -> None:
    mpl_axis = axes.xaxis if name == "x" else axes.yaxis
    if axis.log:
        axes.set(**{f"{name}scale": "log"})
    axes.set(**{f"{name}lim": axis.limits})
    if axis.ticks is not None:
        mpl_axis.set_ticks(axis.ticks, axis.names)
    if axis.powers is not None:
        axes.ticklabel_format(axis=name, style="sci", scilimits=axis.powers)
    if not axis.numbered:
        axes.tick_params(axis=name, labelbottom=False, labelleft=False)
    mpl_axis.set_label_text(axis.label, fontsize=axis.label_size)
    if axis.label_place is not None:
        offset = axis.label_place * axes.figure.dpi / axes.bbox.width
        mpl_axis.set_label_coords(
            1.0 + offset if str(mpl_axis.get_label_position()) == "right" else -offset, 0.5
        )


def _further(axes: Axes, axis: Axis, name: Literal["x", "y"]) -> None:
    """A second scale of a panel, on its other side."""
    axes.grid(visible=False)
    _axis(axes, axis, name)


def _legend(legend: Legend) -> dict[str, Any]:
    return {
        "handles": [_handle(entry.style, entry.label) for entry in legend.entries],
        "loc": legend.place,
        "bbox_to_anchor": legend.anchor,
        "ncols": legend.columns,
        "fontsize": legend.size,
        "borderaxespad": legend.gap,
        "borderpad": legend.pad,
        "labelspacing": legend.spacing,
    }


def _handle(style: Style | Fill, label: str) -> Artist:
    if isinstance(style, Style):
        return Line2D([], [], label=label, **_line(style))
    return Patch(label=label, **_area(style))


def _line(style: Style) -> dict[str, Any]:
    dashes = (0.0, style.dashes) if style.dashes else "-"
    return {
        "color": style.color,
        "linewidth": style.width,
        "linestyle": dashes if style.width else "none",
        "marker": style.marker or None,
        "markersize": style.size,
        "markerfacecolor": style.face or style.color,
        "markeredgecolor": style.edge or style.color,
        "markeredgewidth": style.edge_width,
        "solid_capstyle": style.cap,
        "solid_joinstyle": style.join,
    }


def _area(style: Fill) -> dict[str, Any]:
    return {
        "facecolor": style.face or "none",
        "edgecolor": style.edge or "none",
        "linewidth": style.width,
        **({"linestyle": (0.0, style.dashes)} if style.dashes else {}),
        **({"hatch": "///"} if style.hatched else {}),
        **({"alpha": style.opacity} if style.opacity < 1.0 else {}),
    }


def _text_style(text: Text) -> dict[str, Any]:
    box = text.box
    behind: dict[str, Any] = {}
    if box is not None and box.ring:
        behind = {"boxstyle": f"circle,pad={box.pad}", "facecolor": "white", "linewidth": 0.7}
    elif box is not None:
        behind = {"facecolor": "white", "edgecolor": "none", "pad": box.pad}
        if box.opacity < 1.0:
            behind["alpha"] = box.opacity
    return {
        "fontsize": text.size,
        "ha": text.across,
        "va": text.up,
        "rotation": 90.0 if text.turned else 0.0,
        "weight": "bold" if text.bold else "normal",
        "zorder": text.layer,
        **({"linespacing": text.spacing} if text.spacing else {}),
        **({"bbox": behind} if behind else {}),
    }


@singledispatch
def draw(mark: object, _axes: Axes) -> None:
    """Draw one mark."""
    raise TypeError(f"{type(mark).__name__} is not a mark")


@draw.register
def _(mark: Line, axes: Axes) -> None:
    axes.plot(
        mark.points[:, 0], mark.points[:, 1],
        zorder=mark.layer, clip_on=mark.clipped, **_line(mark.style),
    )  # fmt: skip


@draw.register
def _(mark: Rule, axes: Axes) -> None:
    rule = axes.axvline if mark.axis == "x" else axes.axhline
    rule(mark.at, zorder=mark.layer, **_line(mark.style))


@draw.register
def _(mark: Text, axes: Axes) -> None:
    shares = mark.of == "panel"
    if mark.offset is None:
        where = axes.transAxes if shares else axes.transData
        axes.text(*mark.at, mark.text, transform=where, **_text_style(mark))
    else:
        axes.annotate(
            mark.text, mark.at, mark.offset, "axes fraction" if shares else "data",
            "offset points", **_text_style(mark),
        )  # fmt: skip


@draw.register
def _(mark: Area, axes: Axes) -> None:
    outlines = [
        Path(np.vstack((ring, ring[:1])), closed=True) if mark.closed else Path(ring)
        for ring in mark.rings
    ]
    area = PathPatch(Path.make_compound_path(*outlines), zorder=mark.layer, **_area(mark.style))
    axes.add_patch(area)


@draw.register
def _(mark: Circle, axes: Axes) -> None:
    axes.add_patch(Round(mark.centre, mark.radius, zorder=mark.layer, **_area(mark.style)))


@draw.register
def _(mark: Arrow, axes: Axes) -> None:
    axes.add_patch(
        FancyArrowPatch(
            path=Path(mark.points), arrowstyle="-|>", mutation_scale=mark.head,
            color=mark.style.color, linewidth=mark.style.width, zorder=mark.layer,
        )
    )  # fmt: skip


@draw.register
def _(mark: Band, axes: Axes) -> None:
    _band(mark, axes)


def _band(mark: Band, axes: Axes) -> PolyCollection:
    fill = axes.fill_betweenx if mark.axis == "y" else axes.fill_between
    held = list(~np.isnan(mark.low))
    style = _area(mark.style)
    return fill(mark.places, mark.low, mark.high, where=held, zorder=mark.layer, **style)


@draw.register
def _(mark: Field, axes: Axes) -> None:
    clip = _band(mark.within, axes)
    clip.remove()
    field = axes.contourf(
        mark.x, mark.y, mark.values,
        levels=list(mark.between), colors=[mark.style.face], zorder=mark.layer,
    )  # fmt: skip
    field.set_clip_path(Path.make_compound_path(*clip.get_paths()), axes.transData)
    axes.add_patch(Rectangle((0.0, 0.0), 0.0, 0.0, **_area(mark.style)))  # empty, keeps the bytes


@draw.register
def _(mark: Inset, axes: Axes) -> None:
    side, style = mark.side, mark.style
    inset = axes.inset_axes((*mark.corner, side, side), transform=axes.transData, zorder=mark.layer)
    _panel(inset, mark.panel)
    x, y, seen = mark.window
    axes.indicate_inset(
        (x, y, seen, seen), inset,
        edgecolor=style.color, linewidth=style.width, alpha=1.0, zorder=mark.layer - 0.5,
    )  # fmt: skip


# -- writer ----------------------------------------------------------------------------------------
# SVG and PNG: a picture of the cam, for papers and web pages. For manufacturing use the DXF.


PAGE: Final = "picture"


@dataclass(frozen=True, slots=True)
class PictureWriter:
    """Writes a picture of the cam.

    Attributes
    ----------
    format : of the picture.
    """

    format: Format[None]

    def write(self, product: Product, tolerance: float) -> Written:
        """The picture; no tolerance applies to it."""
        known = product.pictured.known
        if PAGE not in known:
            known[PAGE] = draw_page(stacked(product, ["cam"]))
        return Written(page_bytes(known[PAGE], self.format.suffix))

    def measure(self, product: Product, data: bytes) -> None:
        """None: a picture is not meant to be measured."""


SVG = PictureWriter(plain.SVG)
PNG = PictureWriter(plain.PNG)
