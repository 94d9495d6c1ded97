"""Motion plan and motion diagram (VDI 2143-1, section 3) over the cam angle.

The plan (Bewegungsplan) shows what is asked: joints, numbered, with their motion tasks, and the law
of each segment. The diagram (Bewegungsdiagramm) below shows what the follower does: lift and three
derivatives. With a linkage the plan is the slider's, the diagram the follower's.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any, Final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure, SubFigure
from matplotlib.lines import Line2D

from camgeo.files.product import PlanSketch, Product
from camgeo.numeric.arrays import FloatArray
from camgeo.units import MM_PER, RPM, TURN
from camgeo_export.plots.style import (
    AUXILIARY,
    LEFT,
    LIMIT,
    LINE,
    RIGHT,
    diagram_angles,
    over_cam_angle,
)

MARKS: Final = {"s": "", "s1": "′", "s2": "″", "s3": "‴"}
RATES: Final = {
    "s": ("", "v", "a", "jerk"),
    "ψ": ("", "dψ/dt", "d²ψ/dt²", "d³ψ/dt³"),
}
RAISED: Final = str.maketrans("0123456789", "⁰¹²³⁴⁵⁶⁷⁸⁹")
OVER_TIME: Final = ("", "/s", "/s²", "/s³")

size = (7.0, 10.0)

TOP, BOTTOM, NUMBERS, CLASSES, HEADING, PANEL, GAP = 0.32, 0.75, 0.26, 0.36, 0.34, 1.3, 0.09
"""Heights [inch] from the top: title, what is below the diagram, the strips above and below the
plan, the diagram's title, each panel and the gap between two."""

SECOND_SCALE: Final = 0.75
"""Right margin [inch] with a second scale."""

BAND: Final = 0.5
"""Height [inch] of the laws' names while they are written across."""

LETTER: Final = 0.062
"""Width [inch] of a letter of the laws' names, generously."""

SMALL: Final = 7.5
"""Size of the text of the plan [points]."""

TURNED_GAP, NUMBER_GAP, LETTERS_GAP, CLASS_GAP = 0.15, 0.2, 0.3, 0.4
"""Least distances [inch] of names written upwards, of numbers, of tasks, of tasks with angles."""

FARTHEST: Final = 0.4
"""A task with its angle that came to stand farther [inch] from its joint would mislead."""

TICK_GAP: Final = 0.17
"""Least distance [inch] of the numbers on the plan's vertical axis."""

NAME_PLACE: Final = 0.6
"""Distance [inch] of the names of the vertical axes to the left of them."""

HEADROOM: Final = 0.28
"""Above the curve of a panel, as a share of its range: room for the extremes."""

CLOSER: Final = 101
"""Points between two neighbours of an extreme: a half-degree in steps of 0.005 degrees."""

SAME: Final = 1e-10
"""Values that differ by less than this part of the largest are the same extreme."""

ANGLES: Final = {"lever": "χ", "crank": "θ"}
"""Symbols of demanded angles that are not the follower's own."""

Course = Callable[[FloatArray], FloatArray]
"""Values at cam angles [rad], in the unit of the panel."""

REST: Any = {"color": LINE, "linewidth": 2.6, "solid_capstyle": "butt"}
MOVE: Any = {"color": LINE, "linewidth": 1.0, "linestyle": (0, (5, 3))}
DATA: Any = {"color": LINE, "linewidth": 1.0}
JOINT: Any = {"marker": "o", "markersize": 4.0, "color": "black", "linestyle": "none"}
INFINITE: Any = {"marker": "^", "markersize": 5.5, "color": LIMIT, "linestyle": "none"}


@dataclass(frozen=True, slots=True)
class Unit:
    """How a length or angle is written: its unit, symbol, and how many of it are in 1 mm or rad."""

    name: str
    symbol: str
    scale: float


def draw(product: Product, figure: Figure | SubFigure) -> None:
    """Draw the motion plan above s, s', s'', s''' of the follower."""
    sketch = product.plan_sketch
    page = _Page(figure, second_scale=sketch.speed is not None)
    names = _names(sketch, page.across)
    band = max(BAND, *(LETTER * len(name.text) + 0.2 for name in names if name.turned), 0.0)
    unit = _unit(product, sketch.unit)
    if sketch.of in ANGLES:
        unit = replace(unit, symbol=ANGLES[sketch.of])

    page.skip(TOP)
    title = f"{product.name}: motion plan of the {sketch.of}"
    _draw_names(page.axes(band, bare=True), sketch, names, band)
    _draw_numbers(page.axes(NUMBERS, bare=True), sketch, page.across)
    diagram = HEADING + 4 * PANEL + 3 * GAP + BOTTOM
    plan = page.left_over - CLASSES - diagram
    _draw_plan(page.axes(plan), sketch, unit, plan)
    _draw_classes(page.axes(CLASSES, bare=True), sketch, page.across)
    page.title(title, 0.14)
    page.title(_diagram_title(product, sketch), page.height - page.left_over + 0.2)
    page.skip(HEADING)
    _draw_diagram(page, product, sketch)
    _legend(figure, page, sketch)


class _Page:
    """Axes one below the other in a figure, placed in inches."""

    def __init__(self, figure: Figure | SubFigure, *, second_scale: bool) -> None:
        self.figure = figure
        self.width = figure.bbox.width / figure.dpi
        self.height = figure.bbox.height / figure.dpi
        self.left_over = self.height
        self.right = SECOND_SCALE if second_scale else RIGHT

    @property
    def across(self) -> float:
        """Width [inch] of one turn."""
        return self.width - LEFT - self.right

    def skip(self, height: float) -> None:
        """Leave `height` [inch] free."""
        self.left_over -= height

    def axes(self, height: float, *, bare: bool = False) -> Axes:
        """The next axes, `height` [inch] high; a strip for text if `bare`."""
        self.left_over -= height
        axes = self.figure.add_axes(
            (
                LEFT / self.width,
                self.left_over / self.height,
                self.across / self.width,
                height / self.height,
            )
        )
        # aligned down the page, whatever the width of their numbers
        axes.yaxis.set_label_coords(-NAME_PLACE / self.across, 0.5)
        if bare:
            axes.set_axis_off()
            axes.set_xlim(0.0, 360.0)
            axes.set_ylim(0.0, 1.0)
        return axes

    def title(self, text: str, below_top: float) -> None:
        """A title, its middle `below_top` [inch] below the figure's upper edge."""
        self.figure.text(
            (LEFT + 0.5 * self.across) / self.width,
            1.0 - below_top / self.height,
            text,
            fontsize=10.0,
            ha="center",
            va="center",
        )


def _unit(product: Product, unit: str) -> Unit:
    if unit == "mm":
        return Unit(product.unit, "s", 1.0 / MM_PER[product.unit])
    return Unit("°", "ψ", math.degrees(1.0))


def _diagram_title(product: Product, sketch: PlanSketch) -> str:
    what = "lift s" if product.lift_unit == "mm" else "swing ψ"
    behind = "" if sketch.of == "follower" else " behind the linkage"
    speed = "" if sketch.speed is None else f" (right: at {sketch.speed / RPM:.4g} rev/min)"
    return f"motion diagram: {what} of the follower{behind}{speed}"


# The plan -----------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class _Name:
    """Text of a segment: at which angle [degrees] it is written, across or upwards."""

    text: str
    place: float
    turned: bool


def _names(sketch: PlanSketch, across: float) -> list[_Name]:
    """Task and law of each segment: across where they fit, else upwards, pushed apart."""
    tasks = _tasks(sketch)
    middles = np.degrees([0.5 * (s.start + s.end) for s in sketch.segments])
    halves = np.degrees([0.5 * (s.end - s.start) for s in sketch.segments])
    texts = [
        "\n".join((task, *_wrapped(s.label)))
        for task, s in zip(tasks, sketch.segments, strict=True)
    ]
    widths = np.array([max(map(len, text.split("\n"))) for text in texts]) * LETTER
    turned = widths * 360.0 / across > 2.0 * halves
    gap = TURNED_GAP * 360.0 / across
    places = middles.copy()
    places[turned] = spread(middles[turned], gap, 0.0, 360.0)
    if np.any(np.abs(places - middles) > halves):
        # Some would come to lie under their neighbours' names.
        turned[:] = True
        places = spread(middles, gap, 0.0, 360.0)
    return [
        _Name(f"{task} {s.label}" if up else text, float(place), bool(up))
        for task, s, text, place, up in zip(
            tasks, sketch.segments, texts, places, turned, strict=True
        )
    ]


def _tasks(sketch: PlanSketch) -> list[str]:
    """Motion task of each segment, as its ends are."""
    following = (*sketch.joints[1:], *sketch.joints[:1])
    return [f"{a.after}-{b.before}" for a, b in zip(sketch.joints, following, strict=True)]


def _wrapped(label: str) -> list[str]:
    """A law's name in lines, broken behind its hyphens."""
    parts = label.split("-")
    return [f"{part}-" for part in parts[:-1]] + parts[-1:]


def spread(places: FloatArray, gap: float, low: float, high: float) -> FloatArray:
    """`places` (n,), ascending, moved as little as may be until all are `gap` apart.

    Least squares, by merging neighbours that are too close; inside [low, high], closer than `gap`
    where there is no room.
    """
    gap = min(gap, (high - low) / max(1, len(places) - 1))
    blocks: list[tuple[float, int]] = []  # mean of place - number * gap, count
    for number, place in enumerate(places):
        mean, count = float(place) - number * gap, 1
        while blocks and blocks[-1][0] >= mean:
            before, many = blocks.pop()
            mean, count = (mean * count + before * many) / (count + many), count + many
        blocks.append((mean, count))
    levels = np.repeat([mean for mean, _ in blocks], [count for _, count in blocks])
    levels = np.clip(levels, low, high - gap * (len(places) - 1))
    moved: FloatArray = levels + gap * np.arange(len(places))
    return moved


def _draw_names(axes: Axes, sketch: PlanSketch, names: list[_Name], band: float) -> None:
    leader = 0.12 / band
    for segment, name in zip(sketch.segments, names, strict=True):
        middle = math.degrees(0.5 * (segment.start + segment.end))
        if name.turned:
            axes.plot([middle, name.place], [0.0, leader], color=AUXILIARY, linewidth=0.5)
        axes.text(
            name.place, leader + 0.02 if name.turned else 0.02, name.text,
            rotation=90.0 if name.turned else 0.0, ha="center", va="bottom", fontsize=SMALL,
            linespacing=1.0,
        )  # fmt: skip


def _joint_places(sketch: PlanSketch) -> FloatArray:
    """(n + 1,) cam angles [degrees] of the joints; the first once more at the end of the turn."""
    return np.degrees([*(joint.cam_angle for joint in sketch.joints), TURN])


def _draw_numbers(axes: Axes, sketch: PlanSketch, across: float) -> None:
    """Numbers of the joints, in circles, each above its joint if there is room."""
    angles = _joint_places(sketch)
    places = spread(angles, NUMBER_GAP * 360.0 / across, 0.0, 360.0)
    for index, (angle, place) in enumerate(zip(angles, places, strict=True)):
        axes.plot([angle, place], [0.0, 0.3], color=AUXILIARY, linewidth=0.6, clip_on=False)
        axes.text(
            place, 0.58, str(index % len(sketch.joints) + 1),
            ha="center", va="center", fontsize=6.5,
            bbox={"boxstyle": "circle,pad=0.22", "facecolor": "white", "linewidth": 0.7},
        )  # fmt: skip


def _draw_plan(axes: Axes, sketch: PlanSketch, unit: Unit, height: float) -> None:
    """Positions at the joints; rests as thick lines, moves dashed from joint to joint."""
    angles = _joint_places(sketch)
    positions = np.array([joint.position for joint in sketch.joints]) * unit.scale
    positions = np.append(positions, positions[0])
    extent = [positions]
    for index, segment in enumerate(sketch.segments):
        ends = slice(index, index + 2)
        if segment.course is not None:
            course = segment.course[:, 1] * unit.scale
            extent.append(course)
            axes.plot(np.degrees(segment.course[:, 0]), course, **DATA)
        else:
            axes.plot(angles[ends], positions[ends], **(REST if segment.is_dwell else MOVE))
    axes.plot(angles, positions, zorder=3, clip_on=False, **JOINT)
    over_cam_angle(axes, tuple(joint.cam_angle for joint in sketch.joints), label=False)
    axes.set_ylabel(f"{unit.symbol} [{unit.name}]")
    low, high = (float(limit(np.concatenate(extent))) for limit in (np.min, np.max))
    room = 0.15 * (high - low) or 1.0
    axes.set_ylim(low - room, high + room)
    levels = np.unique(np.round(positions, 9))
    apart = np.min(np.diff(levels), initial=math.inf) / (high - low + 2.0 * room) * height
    if apart > TICK_GAP and len(extent) == 1:
        axes.set_yticks(levels, [_number(level) for level in levels])


def _draw_classes(axes: Axes, sketch: PlanSketch, across: float) -> None:
    """What meets at each joint, R, G, U or B, both if they differ; and its cam angle."""
    angles = _joint_places(sketch)
    inch = 360.0 / across
    places = spread(angles, CLASS_GAP * inch, 0.0, 360.0)
    with_angles = bool(np.all(np.abs(places - angles) <= FARTHEST * inch))
    if not with_angles:
        places = spread(angles, LETTERS_GAP * inch, 0.0, 360.0)
    joints = (*sketch.joints, sketch.joints[0])
    for joint, angle, place in zip(joints, angles, places, strict=True):
        same = joint.before == joint.after
        text = joint.after if same else f"{joint.before}|{joint.after}"
        axes.plot([angle, place], [1.0, 0.82], color=AUXILIARY, linewidth=0.6, clip_on=False)
        axes.text(place, 0.8, text, ha="center", va="top", fontsize=SMALL, weight="bold")
        if with_angles:
            axes.text(place, 0.38, f"{angle:.6g}°", ha="center", va="top", fontsize=6.5)


# The diagram --------------------------------------------------------------------------------------


def _draw_diagram(page: _Page, product: Product, sketch: PlanSketch) -> None:
    unit = _unit(product, product.lift_unit)
    joints = tuple(joint.cam_angle for joint in sketch.joints)
    phi = diagram_angles(tuple(joint.cam_angle for joint in sketch.breaks))
    for order, (what, mark) in enumerate(MARKS.items()):
        if order:
            page.skip(GAP)
        axes = page.axes(PANEL)

        def course(angles: FloatArray, what: str = what) -> FloatArray:
            return product.quantity(what, angles) * unit.scale

        values = course(phi)
        axes.axhline(0.0, color="black", linewidth=0.5)
        # From the value at the end of the turn: a jump at cam angle 0 is one like the others.
        axes.plot([0.0, *np.degrees(phi)], [values[-1], *values], color=LINE)
        per = ("", "/rad", "/rad²", "/rad³")[order]
        axes.set_ylabel(f"{unit.symbol}{mark} [{unit.name}{per}]")
        over_cam_angle(axes, joints, label=what == "s3")
        _leave_room(axes)
        _tell_extremes(axes, course, phi)
        _mark_infinite(axes, sketch, order)
        if sketch.speed is not None and order:
            _second_scale(axes, unit, order, sketch.speed)


def _leave_room(axes: Axes) -> None:
    low, high = axes.get_ylim()
    axes.set_ylim(low, high + HEADROOM * (high - low))


def _tell_extremes(axes: Axes, course: Course, phi: FloatArray) -> None:
    """Largest and smallest value, with their first places, to the digits that are written.

    They are looked for between the neighbours of the largest of the drawn points.
    """
    values = course(phi)
    size = float(np.max(np.abs(values)))
    told = []
    for word, sign in (("max", 1.0), ("min", -1.0)):
        index = int(np.argmax(sign * values))
        around = slice(max(index - 1, 0), index + 2)
        closer = np.unique(
            np.concatenate((phi, np.linspace(phi[around][0], phi[around][-1], CLOSER)))
        )
        found = course(closer)
        extreme = float(np.max(sign * found)) * sign
        first = np.argmax(np.abs(found - extreme) <= SAME * size)
        told.append(f"{word} {_number(extreme)} at {math.degrees(closer[first]):.1f}°")
    axes.text(
        0.99, 0.95, ",  ".join(told), fontsize=SMALL,
        transform=axes.transAxes, ha="right", va="top",
        bbox={"facecolor": "white", "edgecolor": "none", "pad": 1.0},
    )  # fmt: skip


def _number(value: float) -> str:
    """Four digits, all of them before the point if there are more."""
    text = f"{value:.0f}" if 1e3 <= abs(value) < 1e7 else f"{value + 0.0:.4g}"
    return text.replace("-", "−")


def _infinite_at(sketch: PlanSketch, order: int) -> list[float]:
    """Cam angles [rad] at which the derivative is infinite for a lower one jumps."""
    return [joint.cam_angle for joint in sketch.breaks if joint.order + 1 < order]


def _mark_infinite(axes: Axes, sketch: PlanSketch, order: int) -> None:
    places = [math.degrees(angle) for angle in _infinite_at(sketch, order)]
    if places:
        axes.plot(places, np.zeros(len(places)), zorder=4, clip_on=False, **INFINITE)


def _second_scale(axes: Axes, unit: Unit, order: int, speed: float) -> None:
    """The derivative over time at a constant speed, on the right."""
    factor = speed**order
    low, high = (limit * factor for limit in axes.get_ylim())
    size = max(abs(low), abs(high))
    thousands = max(0, math.floor(math.log10(size) / 3.0)) if size > 0.0 else 0
    power = f"10{str(3 * thousands).translate(RAISED)} " if thousands else ""
    second = axes.twinx()
    second.grid(visible=False)
    second.set_ylim(low / 1000.0**thousands, high / 1000.0**thousands)
    second.set_ylabel(
        f"{RATES[unit.symbol][order]} [{power}{unit.name}{OVER_TIME[order]}]", fontsize=8.5
    )
    second.yaxis.set_label_coords(1.09, 0.5)


def _legend(figure: Figure | SubFigure, page: _Page, sketch: PlanSketch) -> None:
    rests = any(segment.is_dwell for segment in sketch.segments)
    data = any(segment.course is not None for segment in sketch.segments)
    moves = any(s.course is None and not s.is_dwell for s in sketch.segments)
    handles = [
        *([Line2D([], [], **REST, label="dwell")] if rests else []),
        *([Line2D([], [], **MOVE, label="move, made by its law")] if moves else []),
        *([Line2D([], [], **DATA, label="motion by data")] if data else []),
        Line2D([], [], **JOINT, label="joint"),
    ]
    if _infinite_at(sketch, 3):
        text = f"infinite: {'shock or ' if _infinite_at(sketch, 2) else ''}jerk"
        handles.append(Line2D([], [], **INFINITE, label=text))
    figure.legend(
        handles=handles,
        loc="lower center",
        bbox_to_anchor=((LEFT + 0.5 * page.across) / page.width, 0.05 / page.height),
        ncols=len(handles),
    )
