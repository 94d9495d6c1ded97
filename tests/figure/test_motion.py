"""Motion plan and motion diagram: what is drawn, where jumps are, and that nothing is moved far."""

from __future__ import annotations

import itertools
import math
from dataclasses import replace
from decimal import Decimal
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from matplotlib.axes import Axes
from matplotlib.figure import Figure

import camgeo
from camgeo.cam.cam import Drive
from camgeo.design.design import Design
from camgeo.design.product import Product
from camgeo.kinematics.laws import make_law
from camgeo.kinematics.plan import Dwell, MotionPlan, Move, breaks
from camgeo.numeric.arrays import FloatArray
from camgeo.pictures import motion
from camgeo.pictures.motion import plan_sketch, spread
from tests.export.stub_product import CAM, StubProduct
from tests.figure import drawing

SCENES = sorted((Path(__file__).parents[2] / "fixtures" / "scenes").glob("*.toml"))


def move(span: str, to: float, law: str) -> Move:
    return Move(Decimal(span), to, make_law(law))


HARSH = MotionPlan(
    (
        Dwell(Decimal(60)),
        move("90", 10.0, "straight-line"),
        Dwell(Decimal(0)),
        Dwell(Decimal(30)),
        move("60", 4.0, "quadratic-parabola"),
        move("120", 0.0, "inclined-sine"),
    )
)
"""Shocks at 60 and 150 degrees, jerks at 180, 210 and 240, all by their laws."""


def planned(speed: float | None = None) -> Product:
    """The stub with this plan, as a follower that translates."""
    return StubProduct(cam=replace(CAM, drive=Drive(HARSH, speed=speed)))


def drawn(product: Product) -> Figure:
    return drawing.drawn(motion.figure(product))


def texts(axes: Axes) -> list[str]:
    return [text.get_text() for text in axes.texts]


def panel(figure: Figure, label: str) -> Axes:
    (axes,) = [axes for axes in figure.axes if axes.get_ylabel().startswith(label)]
    return axes


def test_the_sketch_of_a_plan() -> None:
    sketch = plan_sketch(HARSH)
    labels = [segment.label for segment in sketch.segments]
    assert labels == ["dwell", "straight-line", "dwell", "quadratic-parabola", "inclined-sine"]
    # A segment of no length has neither a name nor a joint of its own.
    starts = [segment.start for segment in sketch.segments]
    assert starts == [joint.cam_angle for joint in sketch.joints]
    assert starts == [math.radians(angle) for angle in (0, 60, 150, 180, 240)]
    assert [segment.end for segment in sketch.segments] == [*starts[1:], math.radians(360)]
    found = [joint.cam_angle for joint in breaks(HARSH)]
    assert found == pytest.approx([*starts[:4], math.radians(210), starts[4]])


def test_joints_are_numbered_with_their_tasks() -> None:
    names, numbers, plan, classes, *_ = drawn(planned()).axes
    assert texts(numbers) == ["1", "2", "3", "4", "5", "1"]
    # From rest into a straight line the velocity jumps, R to G; a parabola starts as a turn.
    letters = [text for text in texts(classes) if "°" not in text]
    assert letters == ["R", "R|G", "G|R", "R|U", "U|R", "R"]
    angles = [text for text in texts(classes) if "°" in text]
    assert angles == ["0°", "60°", "150°", "180°", "240°", "360°"]
    reported = [text.replace("\n", " ").replace("- ", "-") for text in texts(names)]
    laws = ["dwell", "straight-line", "dwell", "quadratic-parabola", "inclined-sine"]
    tasks = ["R-R", "G-G", "R-R", "U-U", "R-R"]
    assert reported == [f"{task} {law}" for task, law in zip(tasks, laws, strict=True)]
    assert plan.get_ylabel() == "s [mm]"
    assert [text.get_text() for text in plan.get_yticklabels()] == ["0", "4", "10"]


def test_jumps_are_drawn_upright_with_both_values() -> None:
    """Within 1e-6 degrees of each break the curve goes from the left-hand to the right-hand value.

    `diagram_angles` steps 1e-9 rad to either side, 6e-8 degrees; s''' changes over it by less than
    1e-6 of its largest value, as its slope is at most 2 pi/(pi/3) of it per radian.
    """
    plan = HARSH
    figure = drawn(planned())
    for order, label in enumerate(["s [", "s′", "s″", "s‴"]):
        curve = max(panel_curves(figure, label), key=len)
        size = max(1.0, np.abs(curve[:, 1]).max())
        for angle in plan.breaks:
            near = curve[np.abs(curve[:, 0] - math.degrees(angle)) < 1e-6]
            values = [plan.jet(np.array([angle]), side)[order, 0] for side in ("left", "right")]
            for value in values:
                assert np.abs(near[:, 1] - value).min() < 1e-6 * size, (label, angle)


def panel_curves(figure: Figure, label: str) -> list[FloatArray]:
    # The plan has the same name as the lift; the diagram comes after it.
    axes = [axes for axes in figure.axes if axes.get_ylabel().startswith(label)][-1]
    return [np.column_stack(line.get_data()) for line in axes.lines]


def test_infinite_accelerations_and_jerks_point_the_way_of_the_jump() -> None:
    """A jump is infinite one way in the next derivative, and both ways in the one after it."""
    figure = drawn(planned())
    ways = {"^": "up", "v": "down"}
    marked: dict[str, list[float]] = {}
    for label in ("s′", "s″", "s‴"):
        for line in panel(figure, label).lines:
            if line.get_marker() in ways:
                places = [float(x) for x in np.asarray(line.get_xdata())]
                marked[f"{label} {ways[str(line.get_marker())]}"] = places
    assert list(marked) == ["s″ up", "s″ down", "s‴ up", "s‴ down"]
    assert marked["s″ up"] == pytest.approx([60.0])  # onto the straight line
    assert marked["s″ down"] == pytest.approx([150.0])
    assert marked["s‴ up"] == pytest.approx([60.0, 150.0, 210.0])  # last the turn of the parabola
    assert marked["s‴ down"] == pytest.approx([60.0, 150.0, 180.0, 240.0])


def test_no_finite_value_is_the_extreme_where_one_is_infinite() -> None:
    """Straight lines have no acceleration but at their ends, where it is infinite."""
    straight = MotionPlan((move("150", 10.0, "straight-line"), move("210", 0.0, "straight-line")))
    product = StubProduct(cam=replace(CAM, drive=Drive(straight, speed=1.0)))
    figure = drawn(product)
    assert texts(panel(figure, "s″")) == ["max ∞ at 0.0°,  min −∞ at 150.0°"]
    assert texts(panel(figure, "s‴")) == ["max ∞ at 0.0°,  min −∞ at 0.0°"]
    for label in ("s″", "a "):
        assert list(panel(figure, label).get_yticks()) == [0.0], "a scale of nothing"


by_scene = pytest.mark.parametrize("scene", SCENES, ids=lambda path: path.stem)


@cache
def drawn_scene(path: Path) -> tuple[Design, Figure]:
    """The design of a scene and its figure, drawn once."""
    design = camgeo.load(path)
    return design, drawn(design.disc)


@by_scene
def test_every_scene_is_drawn_with_titles_that_say_whose_motion(scene: Path) -> None:
    design, figure = drawn_scene(scene)
    plan, *diagrams = (text.get_text() for text in figure.texts)
    linked = design.drive.linkage is not None
    demanded = "follower" if design.cam.drive.linkage is None else design.cam.drive.linkage.member
    assert plan == f"{design.name}: motion plan of the {demanded}"
    assert [f" of the {demanded}" in diagrams[0], "behind the linkage" in diagrams[-1]] == [
        True,
        linked,
    ]
    assert len(diagrams) == 1 + linked
    # Nothing is cut off: all text lies on the page.
    width, height = figure.bbox.width, figure.bbox.height
    for axes in figure.axes:
        for text in (*axes.texts, axes.yaxis.label, axes.xaxis.label):
            box = text.get_window_extent()
            assert box.x0 >= 0.0 and box.x1 <= width and box.y0 >= 0.0 and box.y1 <= height, text  # noqa: PT018  # one condition, reported with the text


@by_scene
def test_names_of_laws_do_not_lie_on_each_other(scene: Path) -> None:
    names = drawn_scene(scene)[1].axes[0]
    boxes = sorted(
        (text.get_window_extent().x0, text.get_window_extent().x1) for text in names.texts
    )
    assert all(left[1] <= right[0] for left, right in itertools.pairwise(boxes))


PLACES = st.lists(st.floats(0.0, 360.0), min_size=1, max_size=30).map(sorted)


@given(PLACES, st.floats(0.1, 100.0))
def test_what_is_spread_is_in_order_apart_and_on_the_page(places: list[float], gap: float) -> None:
    moved = spread(np.array(places), gap, 0.0, 360.0)
    room = 360.0 / max(1, len(places) - 1)
    # Rounding: 30 steps of a gap of at most 360, a few units in the last place of 360 each.
    slack = 1e-9
    assert np.all(np.diff(moved) >= min(gap, room) - slack)
    assert moved[0] >= -slack
    assert moved[-1] <= 360.0 + slack


@given(PLACES, st.floats(0.001, 1.0))
def test_what_has_room_stays(places: list[float], share: float) -> None:
    apart = np.unique(np.round(places))
    if len(apart) > 1:
        moved = spread(apart, share * float(np.diff(apart).min()) * 0.999, 0.0, 360.0)
        # Positions are taken minus and plus number times gap: some units in the last place of 360.
        assert np.allclose(moved, apart, rtol=0.0, atol=1e-9)
