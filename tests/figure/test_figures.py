"""Every figure is data: complete, finite, of JSON, and drawn mark by mark."""

from __future__ import annotations

import importlib.metadata
import json
import pkgutil
import subprocess
import sys
from collections.abc import Callable, Iterator
from dataclasses import fields, is_dataclass, replace
from functools import cache
from pathlib import Path
from types import SimpleNamespace
from typing import Any, get_args

import numpy as np
import pytest
from matplotlib.figure import Figure as Page

import camgeo
from camgeo import pictures
from camgeo.app.cli.command import RENDERERS
from camgeo.cam.cam import Disc
from camgeo.check.sizing.smallest import Sizing
from camgeo.check.sizing.task import RollerTask
from camgeo.geometry.outline.exact_flank import ExactFlank
from camgeo.geometry.outline.path import Flank
from camgeo.geometry.outline.replay import replay_outline
from camgeo.kinematics.laws.comparison import compare
from camgeo.kinematics.mechanism.slotted_lever import DrivenLever, SlottedLever
from camgeo.pictures import (
    accuracy,
    deviations,
    laws,
    plots,
    size,
    slotted_lever,
    sweep,  # noqa: F401  what `sweep` draws
)
from camgeo.pictures.model import (
    Area,
    Axis,
    Band,
    Circle,
    Entry,
    Field,
    Figure,
    Inset,
    Legend,
    Line,
    Mark,
    Panel,
    Rule,
    Style,
    Text,
    entries,
    grid,
    limits,
    log_limits,
    over,
)
from camgeo.studies.inspection import Deviations, Gap, LiftErrors
from camgeo_export.plots import draw, render
from tests import kept
from tests.cli.test_accuracy import made_up
from tests.export.stub_product import StubProduct
from tests.stability import report
from tests.stability.measure import Reading

FIXTURES = Path(__file__).parents[2] / "fixtures"


def of_size() -> Figure:
    design = camgeo.load(FIXTURES / "scenes" / "schnitt.toml")
    task = RollerTask.from_cam(design.cam)
    return size.figure(design.name, [(task, Sizing.solve(task, np.radians(45.0), 0.5))])


def of_disc(name: str) -> Disc:
    return camgeo.load(FIXTURES / "scenes" / f"{name}.toml").cam.disc


def of_replay() -> Figure:
    disc = of_disc("swallow_tail")
    found = replay_outline(disc.pitch_curve, disc.outline("inner").path, step=np.radians(1.0))
    return deviations.replay_figure(found, title="replay", unit="mm", scale=1.0, joints=(0.0, 1.0))


def of_stability() -> Figure:
    reading = Reading("curvature", "cams", "made up", 3.0, 0.25, 0.0, 1.0)
    return report.figure_of([reading, replace(reading, quantity="lift", error=3.0)], 4.0)


def of_inspection() -> Figure:
    flank = ExactFlank(of_disc("plate_translating").outline("inner").path, Flank.INNER)
    places = flank.places(np.linspace(0.0, 6.0, 40))
    found = Deviations(places, 0.004 * np.sin(places.phi), Gap(0.3, 6.0))
    return deviations.inspection_figure(
        found,
        LiftErrors.from_deviations(flank, found),
        title="measured",
        unit=("mm", 1.0),
        lift_unit=("mm", 1.0),
        tolerance=0.01,
        joints=(0.0, 1.0),
    )


OF_DATA: dict[str, Callable[[], Figure]] = {
    "inspection": of_inspection,
    "laws": lambda: laws.figure(compare("R-R", {})),
    "replay": of_replay,
    "size": of_size,
    "slotted-lever": lambda: slotted_lever.figure(DrivenLever(SlottedLever(60.0, 100.0), 20.0)),
    "stability": of_stability,
    "accuracy": lambda: accuracy.figure(made_up(), title="accuracy"),
}

SCENES = ("scenes/setzhub", "scenes/swallow_tail", "scenes/tappet", "effects/conjugate_lever")

MILLED = SCENES[:3]
"""Those that name a tool: only they have a program to be drawn."""

CASES = [*OF_DATA, *(f"{name} of {scene}" for scene in SCENES for name in plots.OWN
                     if name != "backplot" or scene in MILLED)]  # fmt: skip


@cache
def figure_of(case: str) -> Figure:
    if case in OF_DATA:
        return OF_DATA[case]()
    name, scene = case.split(" of ")
    return plots.find(name)(camgeo.load(FIXTURES / f"{scene}.toml").disc)


def parts(value: Any) -> Iterator[Any]:
    """A figure and all that is in it."""
    yield value
    if is_dataclass(value):
        for field in fields(value):
            yield from parts(getattr(value, field.name))
    elif isinstance(value, tuple):
        for each in value:
            yield from parts(each)


def marks(figure: Figure) -> list[Mark | Inset]:
    return [mark for panel in figure.panels for mark in panel.marks]


@pytest.mark.parametrize("case", CASES)
def test_a_figure_is_finite_data_that_cannot_be_changed(case: str) -> None:
    for part in parts(figure_of(case)):
        if isinstance(part, float):
            assert np.isfinite(part)
        elif isinstance(part, np.ndarray):
            assert not part.flags.writeable
            assert not np.any(np.isinf(part))
        elif isinstance(part, Panel):
            left, bottom, right, top = part.frame
            assert 0.0 <= left < right <= 1.0
            assert 0.0 <= bottom < top <= 1.0
        elif isinstance(part, Axis):
            assert part.limits[0] != part.limits[1]
            low, high = sorted(part.limits)
            assert all(low <= tick <= high for tick in part.ticks or ())
            assert part.names is None or len(part.names) == len(part.ticks or ())


@pytest.mark.parametrize("case", CASES)
def test_a_figure_is_json_without_nan(case: str) -> None:
    figure = figure_of(case)
    data = json.loads(json.dumps(figure.to_data(), allow_nan=False))
    assert data["kind"] == "figure"
    drawn = [mark["kind"] for panel in data["panels"] for mark in panel["marks"]]
    assert drawn == [type(mark).__name__.lower() for mark in marks(figure)]
    told_marks = [mark for panel in data["panels"] for mark in panel["marks"]]
    for mark, reported in zip(marks(figure), told_marks, strict=True):
        if isinstance(mark, Line):
            again = np.array(reported["points"], dtype=np.float64).reshape(-1, 2)
            assert np.array_equal(again, mark.points, equal_nan=True)


@pytest.mark.parametrize("case", CASES)
def test_every_name_in_a_legend_is_that_of_something_drawn(case: str) -> None:
    figure = figure_of(case)
    styles = {mark.style for part in parts(figure) if isinstance(mark := part, Line | Rule)}
    fills = {part.style for part in parts(figure) if isinstance(part, Area | Band | Circle | Field)}
    legends = [part for part in parts(figure) if isinstance(part, Legend)]
    for entry in (entry for legend in legends for entry in legend.entries):
        assert entry.label
        if case not in {"laws", "cam of scenes/tappet"} and "of the" not in entry.label:
            looks = styles if isinstance(entry.style, Style) else fills
            # A roller is a circle with a cross, and stands in the legend as a small one.
            assert entry.style in looks or entry.label.startswith("roller"), entry


def test_figures_are_as_kept() -> None:
    """Every mark of each: where there are many points, sums of them."""
    kept.compare("figure/figures.txt", ((case, kept.marks(figure_of(case))) for case in CASES))


def test_no_builder_loads_what_draws() -> None:
    modules = [each.name for each in pkgutil.iter_modules(pictures.__path__)]
    assert {"plots", "deviations"} <= {*modules}
    code = (
        f"import sys; from camgeo.pictures import {', '.join(modules)};"
        "sys.exit('matplotlib' in sys.modules or 'camgeo_export' in sys.modules)"
    )
    assert subprocess.run([sys.executable, "-c", code], capture_output=True).returncode == 0


# What draws ---------------------------------------------------------------------------------------


def test_there_is_one_renderer() -> None:
    (entry,) = importlib.metadata.entry_points(group=RENDERERS)
    assert entry.load() is render


SQUARE = over([0.2, 0.8, 0.8, 0.2], [0.2, 0.2, 0.8, 0.8])


def panel(*marked: Mark | Inset) -> Panel:
    return Panel((0.1, 0.1, 0.9, 0.9), Axis((0.0, 1.0)), Axis((0.0, 1.0)), marked)


def test_every_mark_is_known_to_what_draws_and_nothing_else() -> None:
    """How each is drawn, see tests/export/test_plots.py."""
    assert {*get_args(Mark), Inset} <= draw.registry.keys()
    with pytest.raises(TypeError, match="SimpleNamespace is not a mark"):
        draw(SimpleNamespace(), Page().add_subplot())


# Layout -------------------------------------------------------------------------------------------


def test_panels_of_a_grid_fill_it_row_by_row() -> None:
    frames = grid((10.0, 5.0), (1.0, 2.0, 0.5, 1.0), 2, 3, (0.5, 0.2))
    assert len(frames) == 6
    assert frames[0][0] == pytest.approx(0.1)
    assert frames[0][3] == pytest.approx(0.9)
    assert frames[-1][1:3] == pytest.approx((0.2, 0.8))
    sizes = {(round(right - left, 12), round(top - low, 12)) for left, low, right, top in frames}
    assert len(sizes) == 1
    (across, up) = sizes.pop()
    assert frames[1][0] - frames[0][2] == pytest.approx(0.2 * across)
    assert frames[0][1] - frames[3][3] == pytest.approx(0.5 * up)


def test_limits_hold_what_is_drawn_with_a_margin() -> None:
    assert limits([[1.0, 3.0], 2.0, np.nan]) == pytest.approx((0.9, 3.1))
    # A rule inside the margin takes no room, one beyond it takes a margin of its own.
    assert limits([[1.0, 3.0]], [3.05]) == pytest.approx((0.9, 3.1))
    assert limits([[1.0, 3.0]], [5.0]) == pytest.approx((0.8, 5.2))
    low, high = limits([[2.0, 2.0]])
    assert low < 2.0 < high
    assert limits([]) == (0.0, 1.0)
    assert log_limits([[1.0, 100.0]]) == pytest.approx((10.0**-0.1, 10.0**2.1))
    low, high = log_limits([[0.0, 5.0]])
    assert 0.0 < low < 5.0 < high


def test_rows_of_a_page_have_their_height() -> None:
    heights = [3.6, 10.0, 3.6, 5.07]
    found = plots.rooms(7.0, heights)
    assert {width for width, _ in found} == {7.0}
    # Sums of edges of a page of 2227 dots, each rounded a few times.
    assert [high for _, high in found] == pytest.approx(heights, rel=1e-13)


@pytest.mark.parametrize("span", [1e-3, 0.7, 90.0, 100.0, 180.0, 360.0])
@pytest.mark.parametrize("middle", [0.0, 33.0, -200.0])
def test_round_ticks_are_multiples_inside(span: float, middle: float) -> None:
    low, high = middle - 0.5 * span, middle + 0.5 * span
    ticks = slotted_lever.round_ticks((low, high), (1.0, 2.0, 5.0, 10.0), 7)
    assert low <= ticks[0] < ticks[-1] <= high
    steps = np.diff(ticks)
    assert len(ticks) <= 8
    # A step is the difference of two multiples, each rounded once.
    assert steps == pytest.approx(steps[0], abs=4.0 * np.spacing(max(abs(low), abs(high))))


def test_entries_are_of_named_marks_only() -> None:
    named = Line(SQUARE, Style("black"), "name")
    others = Line(SQUARE, Style("red")), Rule("x", 0.5, Style("black")), Text("a", (0.5, 0.5), 9.0)
    assert entries([*others, named]) == (Entry("name", Style("black")),)


# Plots by their names -----------------------------------------------------------------------------


def test_a_stack_is_as_wide_as_its_widest() -> None:
    stack = plots.stacked(StubProduct(), ["motion", "mechanism", "curvature"])
    assert {row.size[0] for row in stack.rows} == {stack.size[0]} == {10.0}
    assert stack.size[1] == pytest.approx(sum(row.size[1] for row in stack.rows))
    assert json.loads(json.dumps(stack.to_data(), allow_nan=False))["rows"][2]["kind"] == "figure"


def test_a_plot_of_another_distribution(monkeypatch: pytest.MonkeyPatch) -> None:
    def build(product: Any, size: Any = (3.0, 2.0)) -> Figure:
        return Figure(size, (panel(Text(product.name, (0.5, 0.5), 9.0)),))

    def entry_points(group: str, name: str | None = None) -> Any:
        assert group == plots.GROUP
        entry = importlib.metadata.EntryPoint("card", "cards:build", group)
        monkeypatch.setitem(sys.modules, "cards", SimpleNamespace(build=build))
        return importlib.metadata.EntryPoints([entry] if name in {None, "card"} else [])

    monkeypatch.setattr(plots, "entry_points", entry_points)
    assert "card" in plots.names()
    stack = plots.stacked(StubProduct(), ["card", "curvature"])
    assert [row.size for row in stack.rows] == [(7.0, 2.0), (7.0, 3.6)]
    assert render(stack, ".svg").startswith(b"<?xml")


CALLS = """
    plot milling/moved_clamps.toml backplot -o {}/backplot.svg
    plot scenes/groove.toml cam mechanism -o {}/groove.svg
    plot scenes/trimmed_ring.toml cam -o {}/ring.svg
    plot effects/yoke.toml mechanism -o {}/yoke.svg
    plot scenes/points.toml motion -o {}/points.svg
    plot refused/global_undercut.toml cam -o {}/undercut.svg
    plot scenes/inch.toml cams -o {}/none.svg
    size scenes/tappet.toml -o {}/size.svg
    size scenes/inch.toml -o {}/size-roller.svg
    laws --task U-U --curved 0.5 -o {}/laws.svg
    laws --task U-U --a0 6 --a1 -5 -o {}/laws-left-out.svg
    slotted-lever --frame 50 --crank 80 --speed 90 -o {}/slotted-lever.svg
    replay scenes/cut_lobe.toml --step 5 -o {}/replay.svg
    probe scenes/inch.toml --step 10 -o {}/points.csv
    inspect scenes/inch.toml {}/points.csv --tolerance 0.02 -o {}/inspect.svg
    compare scenes/inch.toml scenes/tappet.toml --ask diameter,peak:a -o {}/compare.svg
    tolerance tolerance/lever.toml --count 128 -o {}/tolerance.svg
    sweep scenes/inch.toml --vary follower.base_radius=-1,1,2 --vary cam.speed=60,90 \
        --ask transmission-angle,verdict --picture {}/map.svg
    sweep scenes/inch.toml --vary follower.base_radius=2,1,1.5 --ask peak:a,diameter \
        --picture {}/curves.svg
    sweep scenes/inch.toml --vary follower.base_radius=1:2 --samples 4 --ask diameter,max:mu \
        --least diameter --largest max:mu --picture {}/front.svg
    sweep scenes/inch.toml --vary follower.base_radius=0,1,2 --vary follower.roller_radius=0.2,0.3 \
        --vary motion.1.law=modified-sine,polynomial-345 --ask diameter --picture {}/axes.svg
    optimise scenes/inch.toml --vary follower.base_radius=1:3 --least diameter \
        --largest transmission-angle --evaluations 9 -o {}/optimise.svg
    optimise scenes/inch.toml --vary follower.base_radius=1:3 --least diameter \
        --keep transmission-angle>=60 --evaluations 9 -o {}/course.svg
"""


def test_what_commands_draw_is_as_kept(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def marks(figure: Figure, _suffix: str) -> bytes:
        return kept.marks(figure).encode()

    monkeypatch.chdir(FIXTURES)
    # The command last: the others, once imported, have its own.
    for module in ("cli.plot", "answers.sweep", "answers.optimise", "cli.command"):
        monkeypatch.setattr(f"camgeo.app.{module}.draw_figure", marks)
    calls = list(kept.called(CALLS, tmp_path))
    (tmp_path / "points.csv").unlink()
    kept.compare("figure/commands.txt", [*calls, *kept.files(tmp_path)])
