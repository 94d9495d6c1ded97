"""What matplotlib is told to draw, each property of each artist; pictures and tables as files."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any, Final
from unittest.mock import Mock

import matplotlib as mpl
import numpy as np
import pytest
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import to_rgba
from matplotlib.figure import Figure as Page
from matplotlib.legend import Legend as LegendBox
from matplotlib.lines import Line2D
from matplotlib.patches import Circle as Round
from matplotlib.patches import FancyArrowPatch, Patch
from matplotlib.text import Annotation
from matplotlib.transforms import TransformedPath

from camgeo.cam.cam import Cam, Drive
from camgeo.errors import FileError, UnknownNameError
from camgeo.kinematics.mechanism.rollers import OscillatingRoller
from camgeo.pictures.model import (
    Area,
    Arrow,
    Axis,
    Band,
    Box,
    Circle,
    Entry,
    Field,
    Figure,
    Fill,
    Inset,
    Legend,
    Line,
    Mark,
    Panel,
    Rule,
    Style,
    Text,
    over,
)
from camgeo.pictures.plots import OWN, find, stacked
from camgeo.units import LengthUnit
from camgeo_export import plots
from camgeo_export.plots import PNG, SVG, draw_page, page_bytes, render
from camgeo_export.table import WRITER as CSV
from tests.export.stub_product import StubProduct, there_and_back

STYLES: Final = (
    Style("#12365c"),
    Style("red", 2.5, (3.0, 1.5), cap="butt", join="miter"),
    Style("black", 0.0, marker="s", size=4.0, face="#00ff00", edge="blue", edge_width=0.5),
    Style("gray", 1.0, marker="o", cap="round"),
)

FILLS: Final = (
    Fill("#c9dcee"),
    Fill(edge="red", width=2.0, dashes=(4.0, 2.0)),
    Fill("yellow", "black", hatched=True, opacity=0.4),
)

CURVE: Final = over([0.1, 0.4, 0.9], [0.2, 0.7, 0.3])


def page(*marks: Mark | Inset, **keys: Any) -> tuple[Page, Axes]:
    """A figure of one panel with these marks, drawn."""
    axis = Axis((0.0, 2.0))
    made = draw_page(
        Figure((4.0, 3.0), (replace(Panel((0.1, 0.2, 0.9, 0.8), axis, axis, marks), **keys),))
    )
    return made, made.axes[0]


def lay_out(made: Page) -> None:
    """Places are known once a figure has been drawn."""
    FigureCanvasAgg(made).draw()  # type: ignore[no-untyped-call]  # the stubs lack its types


def require(artist: Artist, **stated: Any) -> None:
    """That an artist has these properties."""
    assert {name: getattr(artist, f"get_{name}")() for name in stated} == stated


def lined(line: Line2D, style: Style) -> None:
    require(
        line, color=style.color, linewidth=style.width, marker=style.marker or "None",
        markersize=style.size, markerfacecolor=style.face or style.color,
        markeredgecolor=style.edge or style.color, markeredgewidth=style.edge_width,
        solid_capstyle=style.cap, solid_joinstyle=style.join,
    )  # fmt: skip
    assert line.is_dashed() == bool(style.dashes)
    assert (line.get_linestyle() in ("None", "none")) == (style.width == 0.0)


def filled(patch: Patch, fill: Fill) -> None:
    alpha = fill.opacity
    face = to_rgba(fill.face, alpha) if fill.face else (0.0, 0.0, 0.0, 0.0)
    assert patch.get_facecolor() == pytest.approx(face if fill.face else (*face[:3], 0.0))
    edge = to_rgba(fill.edge, alpha) if fill.edge else None
    found = to_rgba(patch.get_edgecolor())
    assert (found[3] > 0.0) == bool(fill.edge)
    assert edge is None or found == pytest.approx(edge)
    assert (patch.get_linewidth(), bool(patch.get_hatch())) == (fill.width, fill.hatched)
    solid = patch.get_linestyle() in ("solid", "-")
    assert (patch.get_alpha() or 1.0, solid) == (alpha, not fill.dashes)


@pytest.mark.parametrize("style", STYLES)
def test_lines_and_rules(style: Style) -> None:
    _, axes = page(
        Line(CURVE, style, layer=2.5, clipped=False), Rule("x", 0.3, style, layer=1.5),
        Rule("y", 0.6, style, layer=1.7),
    )  # fmt: skip
    for each in axes.lines:
        lined(each, style)
    line, upright, level = axes.lines
    assert np.array_equal(line.get_xydata(), CURVE)
    require(line, zorder=2.5, clip_on=False)
    require(upright, zorder=1.5, clip_on=True, xdata=[0.3, 0.3])
    require(level, zorder=1.7, clip_on=True, ydata=[0.6, 0.6])
    require(axes, xlim=(0.0, 2.0), ylim=(0.0, 2.0))


@pytest.mark.parametrize("fill", FILLS)
def test_areas_circles_and_bands(fill: Fill) -> None:
    ring, hole = CURVE, 0.5 * CURVE
    _, axes = page(
        Area((ring, hole), fill, layer=1.2), Area((ring,), fill, closed=False),
        Circle((0.5, 0.6), 0.25, fill, layer=1.4),
    )  # fmt: skip
    closed, opened, circle = axes.patches
    for each in axes.patches:
        filled(each, fill)
    vertices = closed.get_path().vertices
    assert np.array_equal(vertices, np.vstack((ring, ring[:1], hole, hole[:1])))
    assert np.array_equal(opened.get_path().vertices, ring)
    assert isinstance(circle, Round)
    require(circle, center=(0.5, 0.6), radius=0.25, zorder=1.4)
    assert (closed.get_zorder(), opened.get_zorder()) == (1.2, 1.0)


@pytest.mark.parametrize("axis", ["x", "y"])
def test_bands_leave_gaps_out_and_fields_lie_within_them(axis: Any) -> None:
    places = np.linspace(0.0, 1.0, 7)
    low = np.where(np.arange(7) == 3, np.nan, 0.1 * places)
    band = Band(axis, places, low, low + 0.5, Fill("#c9dcee", opacity=0.5), layer=1.3)
    values = np.add.outer(places, places)
    field = Field(places, places, values, (0.5, 1.2), Fill("#f0b8b4"), band, layer=1.6)
    _, axes = page(band, field)
    drawn_band, contours = axes.collections
    paths = drawn_band.get_paths()
    assert len(paths) == 2  # on both sides of the gap
    extent = np.vstack([each.vertices for each in paths])
    corners = np.array([extent.min(axis=0), extent.max(axis=0)])[:, :: 1 if axis == "x" else -1]
    assert corners == pytest.approx(np.array([[0.0, 0.0], [1.0, 0.6]]))
    assert (drawn_band.get_zorder(), contours.get_zorder()) == (1.3, 1.6)
    colours = np.array([each.get_facecolor()[0] for each in (drawn_band, contours)])
    assert colours == pytest.approx(np.array([to_rgba("#c9dcee", 0.5), to_rgba("#f0b8b4")]))
    sums = np.vstack([each.vertices for each in contours.get_paths()]).sum(axis=1)
    assert (sums.min(), sums.max()) == pytest.approx((0.5, 1.2))
    clip = contours.get_clip_path()
    assert isinstance(clip, TransformedPath)
    assert np.asarray(clip.get_fully_transformed_path().vertices).shape == extent.shape


def test_arrows_end_in_heads_of_their_size() -> None:
    _, axes = page(Arrow(CURVE, STYLES[1], 9.0, layer=2.2))
    (arrow,) = axes.patches
    assert isinstance(arrow, FancyArrowPatch)
    red = to_rgba("red")
    require(arrow, mutation_scale=9.0, edgecolor=red, facecolor=red, linewidth=2.5, zorder=2.2)


@pytest.mark.parametrize("of", ["data", "panel", "figure"])
@pytest.mark.parametrize("offset", [None, (3.0, -4.0)])
def test_texts_are_where_they_are_stated(of: Any, offset: Any) -> None:
    text = Text(
        "words", (0.4, 0.3), 7.0, of, offset, "right", "top", turned=True, bold=True, spacing=1.5,
        box=Box(0.3, 0.6), layer=3.5,
    )  # fmt: skip
    if of == "figure" and offset is not None:
        return  # only texts of panels have one
    made: Page
    if of == "figure":
        made = draw_page(Figure((4.0, 3.0), (), (text,)))
        (found,) = made.texts
        place = np.array([0.4 * 4.0, 0.3 * 3.0]) * made.dpi
    else:
        made, axes = page(text)
        (found,) = axes.texts
        where = axes.transAxes if of == "panel" else axes.transData
        place = where.transform((0.4, 0.3))
    if isinstance(found, Annotation):
        assert (found.xyann, found.xycoords) == (
            offset,
            ("axes fraction" if of == "panel" else "data"),
        )
        assert found.anncoords == "offset points"
    else:
        assert offset is None
        assert found.get_transform().transform(found.get_position()) == pytest.approx(place)
    require(
        found, text="words", fontsize=7.0, rotation=90.0, horizontalalignment="right",
        verticalalignment="top", fontweight="bold", zorder=3.5,
    )  # fmt: skip
    box = found.get_bbox_patch()
    assert box is not None
    require(box, alpha=0.6, facecolor=pytest.approx(to_rgba("white", 0.6)))
    assert made.get_size_inches() == pytest.approx((4.0, 3.0))


def test_plain_texts_and_rings() -> None:
    _, axes = page(
        Text("plain", (0.1, 0.1), 9.0), Text("1", (0.5, 0.5), 8.0, box=Box(0.2, ring=True))
    )
    plain, ring = axes.texts
    assert plain.get_bbox_patch() is None
    require(plain, rotation=0.0, fontweight="normal", horizontalalignment="left")
    patch = ring.get_bbox_patch()
    assert patch is not None
    assert type(patch.get_boxstyle()).__name__ == "Circle"
    require(patch, linewidth=0.7, alpha=None)


LEGEND: Final = Legend(
    (Entry("line", STYLES[1]), Entry("dots", STYLES[2]), Entry("area", FILLS[2])),
    "upper right", (0.9, 0.8), 2, 6.5, 0.3, 0.2, 0.1,
)  # fmt: skip


@pytest.mark.parametrize("whole", [False, True])
def test_legends_have_their_entries_at_their_place(whole: bool) -> None:
    made = draw_page(Figure((4.0, 3.0), legend=LEGEND)) if whole else page(legend=LEGEND)[0]
    (found,) = made.legends if whole else made.axes[0].findobj(LegendBox)
    for line, style in zip(found.get_lines(), STYLES[1:3], strict=True):
        lined(line, style)
    (area,) = found.get_patches()
    filled(area, FILLS[2])
    assert [each.get_text() for each in found.get_texts()] == ["line", "dots", "area"]
    assert {each.get_fontsize() for each in found.get_texts()} == {6.5}
    assert (found.borderaxespad, found.borderpad, found.labelspacing) == (0.3, 0.2, 0.1)
    lay_out(made)
    corner = found.get_window_extent()
    frame = made.bbox if whole else made.axes[0].bbox
    gap = 0.3 * 6.5 * made.dpi / 72.0
    x = frame.x0 + 0.9 * frame.width - gap
    y = frame.y0 + 0.8 * frame.height - gap
    assert (corner.x1, corner.y1) == pytest.approx((x, y), abs=1.0)


def test_axes_have_their_limits_ticks_and_labels() -> None:
    _, axes = page(
        x=Axis((3.0, 1.0), "angle", ticks=(1.0, 2.0), names=("one", "two"), label_size=7.0),
        y=Axis((1.0, 100.0), "size", log=True),
        title="title", title_size=8.0, title_gap=3.0,
    )  # fmt: skip
    require(
        axes, xlim=(3.0, 1.0), ylim=(1.0, 100.0), xscale="linear", yscale="log", xlabel="angle",
        ylabel="size", title="title", aspect="auto",
    )  # fmt: skip
    names = [each.get_text() for each in axes.get_xticklabels()]
    assert dict(zip(axes.get_xticks(), names, strict=True)) == {1.0: "one", 2.0: "two"}
    sizes = [each.get_fontsize() for each in (axes.xaxis.label, axes.yaxis.label, axes.title)]
    assert sizes == [7.0, 9.0, 8.0]
    assert axes.get_position().extents == pytest.approx((0.1, 0.2, 0.9, 0.8))
    assert axes.axison


@pytest.mark.parametrize("side", ["y", "right"])
def test_labels_have_their_distance_and_further_scales_their_side(side: str) -> None:
    made, axes = page(
        **{side: Axis((0.0, 5.0), "far", label_place=0.4)}, above=Axis((7.0, 8.0), "up")
    )
    own = axes if side == "y" else made.axes[1]
    up = made.axes[-1]
    require(up, xlim=(7.0, 8.0), xlabel="up")
    require(own, ylim=(0.0, 5.0))
    lay_out(made)
    x, _ = own.yaxis.label.get_transform().transform(own.yaxis.label.get_position())
    wanted = own.bbox.x0 - 0.4 * made.dpi if side == "y" else own.bbox.x1 + 0.4 * made.dpi
    assert x == pytest.approx(wanted, abs=1e-6)
    assert not any(each.get_visible() for each in up.get_xgridlines())


@pytest.mark.parametrize(("keys", "holds"), [
    ({"bare": True}, lambda axes: not axes.axison),
    ({"equal": True}, lambda axes: axes.get_aspect() == 1.0),
    ({"x": Axis((0.0, 1.0), numbered=False)},
     lambda axes: not any(each.label1.get_visible() for each in axes.xaxis.get_major_ticks())),
    ({"y": Axis((0.0, 1e6), powers=(-2, 3))},
     lambda axes: axes.yaxis.get_major_formatter()._powerlimits == (-2, 3)),
])  # fmt: skip
def test_panels_are_as_they_state(keys: dict[str, Any], holds: Callable[[Axes], bool]) -> None:
    assert holds(page(**keys)[1])
    assert not holds(page()[1])


def test_an_inset_enlarges_its_window() -> None:
    axis = Axis((0.2, 0.4))
    panel = Panel((0.0, 0.0, 1.0, 1.0), axis, axis, (Line(CURVE, STYLES[0]),))
    inset = Inset(panel, (1.2, 1.1), 0.6, (0.2, 0.2, 0.2), Style("red", 0.8), layer=5.0)
    made, axes = page(inset)
    (inner,) = axes.child_axes
    assert (inner.get_xlim(), inner.get_zorder()) == ((0.2, 0.4), 5.0)
    lined(inner.lines[0], STYLES[0])
    low, high = axes.transData.transform([(1.2, 1.1), (1.8, 1.7)])
    lay_out(made)
    box = inner.bbox
    assert (box.x0, box.y0, box.x1, box.y1) == pytest.approx((*low, *high), abs=1e-6)


def test_figures_stand_in_rows_and_files_are_of_their_kind() -> None:
    axis = Axis((0.0, 1.0))
    one = Figure((4.0, 1.0), (Panel((0.0, 0.0, 1.0, 1.0), axis, axis, ()),))
    other = Figure((4.0, 3.0), one.panels)
    made = draw_page(Figure((4.0, 4.0), rows=(one, other)))
    low, high = (each.get_window_extent() for each in made.axes)
    found = np.array([low.y0, low.height, high.y0, high.height]) / made.dpi
    assert found == pytest.approx(np.array([3.0, 1.0, 0.0, 3.0]), rel=1e-6, abs=1e-8)
    assert page_bytes(made, ".pdf").startswith(b"%PDF")
    with pytest.raises(ValueError, match=r"no figures of kind .gif; there are .svg, .png and .pdf"):
        page_bytes(made, ".gif")
    data, told = made._repr_mimebundle_()
    assert told["image/png"] == {"width": 384, "height": 384}
    assert data["image/png"] == page_bytes(made, ".png")


# Files of pictures and tables ---------------------------------------------------------------------


ROCKER = StubProduct(
    name="rocker",
    cam=Cam(
        Drive(there_and_back(math.radians(10.0)), unit="rad"),
        OscillatingRoller(70.0 + 20.0j, 60.0, 35.0, 8.0),
    ),
)


@pytest.mark.parametrize("unit", ["mm", "inch"])
def test_the_table_reads_back_to_the_bit(unit: LengthUnit) -> None:
    product = StubProduct(unit=unit)
    data = CSV.write(product, 0.001).data
    head, *rows, end = data.decode().split("\n")
    assert head == f"phi [deg],s [{unit}],inner x [{unit}],inner y [{unit}]"
    assert (len(rows), end, b"\r" in data) == (73, "", False)
    assert CSV.measure(product, data) == 0.0


def test_a_changed_length_is_measured_in_mm() -> None:
    product = StubProduct(unit="inch")
    rows = [line.split(",") for line in CSV.write(product, 0.001).data.decode().splitlines()]
    rows[4][2] = repr(float(rows[4][2]) + 0.5)
    data = "\n".join(map(",".join, rows)).encode()
    assert CSV.measure(product, data) == pytest.approx(12.7)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        (b"\n5.0,", b"\n5.1,", "angles, ratios or radii differ"),
        (b"phi [deg]", b"phi [rad]", "does not have this scene's columns"),
        (CSV.write(StubProduct(), 0.001).data, b"", "does not have this scene's columns and rows"),
        (b"\n5.0,", b"\nfive,", "not a number"),
    ],
)
def test_a_changed_table_is_refused(old: bytes, new: bytes, message: str) -> None:
    data = CSV.write(StubProduct(), 0.001).data
    assert old in data
    with pytest.raises(FileError, match=message):
        CSV.measure(StubProduct(), data.replace(old, new))


def test_both_pictures_are_of_one_page(monkeypatch: pytest.MonkeyPatch) -> None:
    """Drawn once, and saved as if it were the only one, whichever is first."""
    alone = {each: each.write(StubProduct(groove=True), 0.001).data for each in (SVG, PNG)}
    counted = Mock(wraps=stacked)
    monkeypatch.setattr(plots, "stacked", counted)
    for order in ((SVG, PNG), (PNG, SVG)):
        product = StubProduct(groove=True)
        assert all(each.write(product, 0.001).data == alone[each] for each in order)
    assert [each.args[1] for each in counted.call_args_list] == [["cam"], ["cam"]]


@pytest.mark.parametrize("name", OWN)
def test_every_plot_draws(name: str) -> None:
    assert render(stacked(ROCKER, [name]), ".svg").startswith(b"<?xml")


def test_a_pivot_is_drawn() -> None:
    assert ROCKER.pictured.follower_sketch.kind == "pivot"
    rocker, guided = (
        render(stacked(product, ["cam"]), ".svg") for product in (ROCKER, StubProduct())
    )
    assert rocker != guided


def test_plots_stack_and_leave_no_state() -> None:
    before = dict(mpl.rcParams)
    data = render(stacked(StubProduct(), ["motion", "transmission-angle"]), ".pdf")
    assert data.startswith(b"%PDF")
    assert data == render(stacked(StubProduct(), ["motion", "transmission-angle"]), ".pdf")
    assert dict(mpl.rcParams) == before


def test_an_unknown_plot_is_told_with_the_nearest() -> None:
    with pytest.raises(UnknownNameError, match='did you mean "motion"'):
        find("motoin")
