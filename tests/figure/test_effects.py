"""The picture of the effects: panels, units, limits, both sides of a jump."""

from __future__ import annotations

import itertools
from dataclasses import replace

import numpy as np
import pytest
from matplotlib.figure import Figure

from camgeo.design.product import Product
from camgeo.dynamics.effects.effect import Column
from camgeo.numeric.arrays import FloatArray, Side
from camgeo.pictures import effects
from camgeo.pictures.model import LIMIT
from camgeo.units import TURN
from tests.export.stub_product import StubProduct
from tests.figure import drawing

BORDER = 1.0


def stepped(phi: FloatArray, side: Side) -> FloatArray:
    """1 from the border on, 0 before."""
    after = phi >= BORDER if side == "right" else phi > BORDER
    return np.asarray(after, dtype=np.float64)


def wave(phi: FloatArray, _side: Side) -> FloatArray:
    return np.cos(phi)


STEP = Column("step", "N", stepped, borders=np.array([BORDER]))
WAVE = Column("wave", "N", wave, limit=1.5)
LENGTH = Column("way", "mm", wave)
RATE = Column("rate", "mm/s^2", wave)


def drawn(product: Product) -> Figure:
    return drawing.drawn(effects.figure(product))


def test_neighbours_of_one_unit_share_a_panel() -> None:
    columns = (STEP, WAVE, LENGTH, RATE, WAVE)
    assert effects.panels(columns) == [[STEP, WAVE], [LENGTH], [RATE], [WAVE]]
    figure = drawn(StubProduct(columns=lambda: columns))
    assert [axes.get_ylabel() for axes in figure.axes] == ["[N]", "[mm]", "[mm/s²]", "[N]"]
    legends = [axes.get_legend() for axes in figure.axes]
    reported = [[text.get_text() for text in legend.get_texts()] for legend in legends if legend]
    assert reported == [["step", "wave", "limit, wave"], ["way"], ["rate"], ["wave", "limit 1.5"]]


def test_the_names_stand_above_the_curves() -> None:
    figure = drawn(StubProduct(columns=lambda: (STEP, WAVE) * 2))
    [axes] = figure.axes
    legend = axes.get_legend()
    assert legend is not None
    bottom = legend.get_window_extent().y0
    for line in axes.lines:
        points = axes.transData.transform(np.asarray(line.get_xydata()))
        assert np.max(points[np.isfinite(points[:, 1]), 1]) < bottom


def test_a_panel_takes_as_many_curves_as_can_be_distinguished() -> None:
    many = (WAVE,) * (2 * len(effects.CURVES) + 1)
    assert [len(each) for each in effects.panels(many)] == [4, 4, 1]
    assert len(set(effects.CURVES)) == len(effects.CURVES)


def test_the_figure_grows_with_its_panels() -> None:
    def product(count: int) -> Product:
        return StubProduct(columns=lambda: (LENGTH, WAVE) * count)

    sizes = [effects.figure(product(count)).size for count in (1, 2, 3)]
    assert {width for width, _ in sizes} == {7.0}
    step = 2.0 * (effects.PANEL + effects.GAP)
    assert np.diff([height for _, height in sizes]) == pytest.approx([step, step])
    heights = {
        round(axes.get_position().height * figure.get_figheight(), 6)
        for count in (1, 3)
        for figure in [drawn(product(count))]
        for axes in figure.axes
    }
    # all panels are as high as they should, whatever their number: the margins are fixed
    assert len(heights) == 1
    assert heights.pop() == pytest.approx(effects.PANEL, rel=0.01)


@pytest.mark.parametrize("count", [1, 7, 8, 14, 15, 22])
def test_many_panels_stand_in_columns_and_none_on_another(count: int) -> None:
    """The page is never higher than its seven rows, and each column ends with the cam angle."""
    columns = tuple(replace(WAVE, unit=f"N{number % 2}") for number in range(count))
    figure = effects.figure(StubProduct(columns=lambda: columns))
    highest = effects.figure(StubProduct(columns=lambda: columns[:7])).size[1]
    assert figure.size[1] <= highest
    frames = [panel.frame for panel in figure.panels]
    assert len(frames) == count
    lefts = sorted({frame[0] for frame in frames})
    assert len(lefts) == -(-count // effects.ROWS)
    for left in lefts:
        own = [panel for panel in figure.panels if panel.frame[0] == left]
        assert [panel.x.numbered for panel in own] == [False] * (len(own) - 1) + [True]
        assert all(a.frame[1] > b.frame[3] for a, b in itertools.pairwise(own))
    assert all(
        frame[2] < left for frame in frames for left in lefts if left > frame[0]
    ), "columns overlap"  # fmt: skip


def test_a_limit_is_dashed_in_its_colour() -> None:
    [axes] = drawn(StubProduct(columns=lambda: (WAVE,))).axes
    [line] = [line for line in axes.lines if line.get_color() == LIMIT]
    assert line.get_linestyle() == "--"
    assert set(np.asarray(line.get_ydata()).tolist()) == {1.5}


def test_a_jump_is_drawn_upright_at_its_place() -> None:
    phi, values = effects.sampled(STEP, np.empty(0))
    at = np.flatnonzero(phi == BORDER)
    assert values[at].tolist() == [0.0, 1.0]
    assert np.all(np.diff(phi) >= 0.0)
    # from the value at the end of the turn, 1, to that at its start, 0
    assert phi[:2].tolist() == [0.0, 0.0]
    assert values[:2].tolist() == [1.0, 0.0]
    assert (phi[-1], values[-1]) == (TURN, 1.0)


def test_joints_of_the_motion_have_both_sides() -> None:
    free = replace(STEP, borders=np.empty(0))
    phi, values = effects.sampled(free, np.array([BORDER, 0.0, TURN]))
    assert values[phi == BORDER].tolist() == [0.0, 1.0]


def test_lengths_are_in_the_unit_of_the_scene() -> None:
    assert effects.shown_unit("mm", "inch") == ("inch", 1.0 / 25.4)
    assert effects.shown_unit("mm/s^3", "inch") == ("inch/s³", 1.0 / 25.4)
    assert effects.shown_unit("N/mm^2", "inch") == ("N/mm²", 1.0)
    assert effects.shown_unit("N", "inch") == ("N", 1.0)
    [axes] = drawn(StubProduct(unit="inch", columns=lambda: (LENGTH,))).axes
    line = max(axes.lines, key=lambda each: len(np.asarray(each.get_xdata())))
    assert np.max(np.asarray(line.get_ydata())) == pytest.approx(1.0 / 25.4)


def test_without_columns_it_says_so() -> None:
    [axes] = drawn(StubProduct()).axes
    assert "no effect" in axes.texts[0].get_text()
