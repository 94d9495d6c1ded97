"""Pictures of single questions: limits, programs, sizes, slotted levers, spectra."""

from __future__ import annotations

import itertools
import math
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import TypeVar

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.figure import Figure

import camgeo
from camgeo.check.disc import transmission_angle_limit
from camgeo.check.sizing.smallest import Sizing
from camgeo.check.sizing.task import RollerTask
from camgeo.design.design import Design
from camgeo.design.product import Product
from camgeo.dynamics.effects.effect import Column
from camgeo.kinematics.mechanism.slotted_lever import DrivenLever, SlottedLever
from camgeo.numeric.arrays import FloatArray, Side
from camgeo.pictures import effects
from camgeo.pictures.effects import spectrum_figure
from camgeo.pictures.model import LIMIT, Circle, Field, Line, Panel, Rule, Text
from camgeo.pictures.motion import RATIO, RATIO_STYLE, curvature
from camgeo.pictures.plots import SPECTRUM, of_design
from camgeo.pictures.size import figure as size_figure
from camgeo.pictures.slotted_lever import PANELS, crank_angles
from camgeo.pictures.slotted_lever import figure as lever_figure
from camgeo.scene.scene import parse_scene
from camgeo.units import MM_PER, RPM, TURN
from camgeo_export.plots import render
from tests.answers.documents import FIXTURES
from tests.export.stub_product import StubProduct
from tests.figure import drawing

SCENES = Path(__file__).parents[2] / "fixtures" / "scenes"


@pytest.mark.parametrize(
    ("name", "sides"),
    [("setzhub", {1.0}), ("groove_clearance", {1.0, -1.0}), ("inch", {1.0}), ("tappet", set())],
)
def test_the_limit_of_the_ratio_of_radii_is_in_the_picture(name: str, sides: set[float]) -> None:
    """The curve crosses a line just where its flank's finding breaks the limit.

    The value of a finding is r_R kappa of the worst place, and the line lies at limit/r_R.
    """
    product = camgeo.load(SCENES / f"{name}.toml").disc
    (panel,) = curvature(product).panels
    rules = {
        float(np.sign(mark.at)): mark.at
        for mark in panel.marks
        if isinstance(mark, Rule) and mark.style == RATIO_STYLE
    }
    assert set(rules) == sides
    (curve,) = [mark for mark in panel.marks if isinstance(mark, Line)]
    low, high = panel.y.limits
    roller = product.cam.follower.roller_radius / MM_PER[product.unit]
    findings = {item.name: item for item in product.findings}
    for flank, sign in RATIO.items():
        if sign not in rules:
            continue
        item, at = findings[f"radius-ratio-{flank}"], rules[sign]
        assert item.limit is not None
        assert item.value is not None
        assert low < at < high
        assert abs(at) * roller == pytest.approx(item.limit)
        worst = np.nanmax(sign * curve.points[:, 1])
        # Of the drawn points, a quarter of a degree apart, the worst one is near the exact place.
        assert max(worst, 0.0) * roller == pytest.approx(item.value, rel=1e-3, abs=1e-12)


LEVERS = {
    "exercise": SlottedLever(75.0, 150.0),
    "turning": SlottedLever(100.0, 50.0),
    "equal": SlottedLever(50.0, 50.0),
    "nearly equal": SlottedLever(1e9, 1e9 + 1.0),
    "short": SlottedLever(1.0, 1e8),
}


def drawn(driven: DrivenLever) -> tuple[Figure, list[Axes]]:
    page = drawing.drawn(lever_figure(driven))
    return page, page.axes[: len(PANELS)]


def driven_by(name: str) -> DrivenLever:
    return DrivenLever(LEVERS[name], 90.0 * RPM)


def curve_of(axes: Axes) -> FloatArray:
    (line,) = [line for line in axes.lines if len(np.asarray(line.get_xdata())) > 1000]
    return np.asarray(line.get_xydata(), dtype=np.float64)


def dots_of(axes: Axes) -> list[tuple[float, float]]:
    return [
        (float(x), float(y))
        for line in axes.lines
        if line.get_marker() == "o"
        for x, y in np.asarray(line.get_xydata(), dtype=np.float64)
    ]


@pytest.mark.parametrize("name", LEVERS)
def test_a_dot_lies_on_the_curve_at_every_extreme(name: str) -> None:
    driven = driven_by(name)
    _, panels = drawn(driven)
    for axes, (quantity, _, _) in zip(panels, PANELS, strict=True):
        curve, dots = curve_of(axes), dots_of(axes)
        own = [extreme for extreme in driven.extremes if extreme.quantity == quantity]
        texts = [text.get_text() for text in axes.texts]
        assert len(texts) == len(own)
        for extreme in own:
            scale = 180.0 / math.pi if quantity == "phi" else 1.0
            place, value = math.degrees(extreme.crank), scale * extreme.value
            assert min(abs(x - place) + abs(y - value) for x, y in dots) <= 1e-9 * abs(value)
            # Nothing drawn goes beyond it, and the curve reaches it.
            reached = curve[:, 1].max() if extreme.largest else curve[:, 1].min()
            assert reached == pytest.approx(value, rel=1e-6)


def test_the_time_stands_above_the_crank_angle() -> None:
    driven = driven_by("exercise")
    page, panels = drawn(driven)
    assert panels[-1].get_xlim() == (0.0, 360.0)
    assert page.axes[-1].get_xlim() == pytest.approx((0.0, 2.0 / 3.0))


@pytest.mark.parametrize("rpm", [0.01, 90.0, 3000.0])
@pytest.mark.parametrize("name", LEVERS)
def test_the_labels_lie_within_the_figure(name: str, rpm: float) -> None:
    page, panels = drawn(DrivenLever(LEVERS[name], rpm * RPM))
    width, height = page.canvas.get_width_height()
    for axes in panels:
        for text in (*axes.texts, axes.yaxis.label, axes.yaxis.get_offset_text()):
            if not text.get_text():
                continue
            box = text.get_window_extent()
            assert 0 <= box.x0 < box.x1 <= width
            assert 0 <= box.y0 < box.y1 <= height


def test_where_the_angle_is_undefined_the_curve_is_open() -> None:
    _, panels = drawn(driven_by("equal"))
    curve = curve_of(panels[0])
    assert 0.0 < curve[0, 0] < curve[-1, 0] < 360.0
    assert dots_of(panels[0]) == [(0.0, -90.0), (360.0, 90.0)]


def test_the_crank_angles_are_dense_where_the_acceleration_peaks() -> None:
    driven = driven_by("nearly equal")
    theta = crank_angles(driven)
    assert (theta[0], theta[-1]) == (0.0, 2.0 * math.pi)
    assert np.all(np.diff(theta) > 0.0)
    peak = driven.lever.largest_acceleration.place
    assert np.count_nonzero((theta > 0.1 * peak) & (theta < 10.0 * peak)) > 100


def sized(name: str, angle: float | None = None) -> tuple[RollerTask, Sizing]:
    design = camgeo.load(SCENES / f"{name}.toml")
    task = RollerTask.from_cam(design.cam)
    required = transmission_angle_limit(design.cam, design.scene.limits) if angle is None else angle
    return task, Sizing.solve(task, required, design.scene.limits.radius_ratio)


def panel_of(task: RollerTask, sizing: Sizing) -> Panel:
    (panel,) = size_figure("cam", [(task, sizing)]).panels
    return panel


def lines_of(panel: Panel) -> dict[str, Line]:
    return {mark.label: mark for mark in panel.marks if isinstance(mark, Line)}


def assert_inside(panel: Panel, x: float, y: float, radius: float = 0.0) -> None:
    """That a circle about a point is within the frame of a panel."""
    (left, right), (low, high) = panel.x.limits, panel.y.limits
    assert left < x - radius
    assert x + radius < right
    assert low < y - radius
    assert y + radius < high


@pytest.mark.parametrize("name", ["plate_translating", "setzhub", "schnitt"])
def test_base_circles_are_whole_and_each_name_has_its_region(name: str) -> None:
    """What is named is in the picture: a level of the ratio where the region has such places."""
    task, sizing = sized(name)
    sides = [(each, Sizing.solve(each, sizing.angle, sizing.ratio)) for each in task.sides]
    (panel,) = size_figure("cam", sides).panels
    circles = [mark for mark in panel.marks if isinstance(mark, Circle) and mark.style.dashes]
    assert len(circles) == len(sides)
    for circle in circles:
        assert_inside(panel, *circle.centre, circle.radius)
    assert panel.legend is not None
    labels = [entry.label for entry in panel.legend.entries]
    assert len(set(labels)) == len(labels)
    bent = [mark for mark in panel.marks if isinstance(mark, Field)]
    assert any("r$_K$" in label for label in labels) == bool(bent)


def test_a_picture_of_what_cannot_be_met() -> None:
    task, sizing = sized("setzhub", math.radians(80.0))
    assert sizing.answer is None
    marked = lines_of(panel_of(task, sizing))
    assert "present design" in marked
    assert "smallest" not in marked


PRESS = FIXTURES / "effects" / "press.toml"


Kind = TypeVar("Kind", Line, Rule)


def marks(design: Design, kind: type[Kind]) -> list[Kind]:
    (row,) = of_design(design, [SPECTRUM])[0].rows
    return [each for each in row.panels[0].marks if isinstance(each, kind)]


@cache
def steady() -> Design:
    """The press at the constant speed that it states, where both moves take as long."""
    text = PRESS.read_text(encoding="utf-8")
    return Design(parse_scene(f'{text}\n[state]\nspeed = "stated"\n'))


def test_curves_are_those_of_the_effect_and_equal_ones_are_drawn_once() -> None:
    design = steady()
    lines = {each.label: each for each in marks(design, Line)}
    found = design.effect(SPECTRUM)
    assert len(found.spectra) == 2  # both by one law
    where = "40 to 150° and 200 to 310°"
    for of, word in (
        (found.spectra[0].residual, "residual"),
        (found.spectra[1].largest, "largest"),
    ):
        points = lines[f"{word}, {where}"].points[::40]
        assert points[:, 1] == pytest.approx(100.0 * of(points[:, 0]), rel=1e-6)
    largest, remains = lines[f"largest, {where}"].points, lines[f"residual, {where}"].points
    assert np.all(largest[:, 1] >= remains[:, 1])


def test_the_train_of_the_scene_is_marked_at_the_natural_periods_of_each_move() -> None:
    design = steady()
    (rule,) = (each for each in marks(design, Rule) if each.axis == "x")
    # 110 degrees at 240 rev/min, and the frequency that the scene states
    frequency = design.scene.effects["vibration"]["natural_frequency"] / (2.0 * np.pi)
    assert rule.at == pytest.approx(110.0 / 360.0 / (240.0 / 60.0) * frequency, rel=1e-9)
    assert f"{frequency:.4g} Hz" in rule.label


def test_a_motion_without_a_move_from_rest_to_rest_says_so() -> None:
    drawn = spectrum_figure("swing", (), 10.0)
    (panel,) = drawn.panels
    (words,) = panel.marks
    assert isinstance(words, Text)
    assert words.text == "no move is from rest to rest"
    assert (panel.bare, words.at, panel.x.limits, panel.y.limits) == (
        True, (0.5, 0.5), (0.0, 1.0), (0.0, 1.0),
    )  # fmt: skip
    assert render(drawn, ".svg").startswith(b"<?xml")


# Effects ------------------------------------------------------------------------------------------
# The picture of the effects: panels, units, limits, both sides of a jump.


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


def effects_drawn(product: Product) -> Figure:
    return drawing.drawn(effects.figure(product))


def test_neighbours_of_one_unit_share_a_panel() -> None:
    columns = (STEP, WAVE, LENGTH, RATE, WAVE)
    assert effects.panels(columns) == [[STEP, WAVE], [LENGTH], [RATE], [WAVE]]
    figure = effects_drawn(StubProduct(columns=lambda: columns))
    assert [axes.get_ylabel() for axes in figure.axes] == ["[N]", "[mm]", "[mm/s²]", "[N]"]
    legends = [axes.get_legend() for axes in figure.axes]
    reported = [[text.get_text() for text in legend.get_texts()] for legend in legends if legend]
    assert reported == [["step", "wave", "limit, wave"], ["way"], ["rate"], ["wave", "limit 1.5"]]


def test_the_names_stand_above_the_curves() -> None:
    figure = effects_drawn(StubProduct(columns=lambda: (STEP, WAVE) * 2))
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
    [axes] = effects_drawn(StubProduct(columns=lambda: (WAVE,))).axes
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
    assert effects.display_unit("mm", "inch") == ("inch", 1.0 / 25.4)
    assert effects.display_unit("mm/s^3", "inch") == ("inch/s³", 1.0 / 25.4)
    assert effects.display_unit("N/mm^2", "inch") == ("N/mm²", 1.0)
    assert effects.display_unit("N", "inch") == ("N", 1.0)
    [axes] = effects_drawn(StubProduct(unit="inch", columns=lambda: (LENGTH,))).axes
    line = max(axes.lines, key=lambda each: len(np.asarray(each.get_xdata())))
    assert np.max(np.asarray(line.get_ydata())) == pytest.approx(1.0 / 25.4)


def test_without_columns_it_says_so() -> None:
    [axes] = effects_drawn(StubProduct()).axes
    assert "no effect" in axes.texts[0].get_text()
