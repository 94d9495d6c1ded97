"""Motion plan and motion diagram (VDI 2143-1, section 3) over the cam angle.

The plan (Bewegungsplan) shows what is required: numbered joints, the motion tasks between them, and
the law of each segment. The diagram (Bewegungsdiagramm) below shows what the follower does: its
lift and three derivatives. With a linkage the plan is that of its far end, and both ends have a
diagram.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from camgeo.cam.cam import Drive
from camgeo.check.disc import transmission_angle_limit
from camgeo.design.product import Product
from camgeo.geometry.outline.path import Flank
from camgeo.kinematics.motion import Motion
from camgeo.kinematics.plan import Dwell, Joint, MotionPlan, Move, Segment, breaks, joints
from camgeo.numeric.arrays import FloatArray, frozen
from camgeo.pictures.model import (
    AUXILIARY,
    CURVE,
    LEFT,
    LIMIT,
    LIMIT_STYLE,
    LINE,
    MARGINS,
    RIGHT,
    ZERO,
    Axis,
    Box,
    Entry,
    Figure,
    Frame,
    Legend,
    Line,
    Mark,
    Panel,
    Rule,
    Size,
    Style,
    Text,
    box,
    diagram_angles,
    entries,
    grid,
    joint_marks,
    limits,
    over,
    turn_axis,
)
from camgeo.units import MM_PER, RPM, TURN, LengthUnit, LiftUnit


class Strips:
    """Frames from the top of a figure downwards, between two margins [inch]."""

    def __init__(self, size: Size, left: float, right: float) -> None:
        self.width, self.height = size
        self.left = left
        self.across = self.width - left - right
        self.remaining = self.height

    def skip(self, height: float) -> None:
        """Leave `height` [inch] free."""
        self.remaining -= height

    def frame(self, height: float) -> Frame:
        """The next frame, `height` [inch] high."""
        self.remaining -= height
        return box(
            self.left / self.width,
            self.remaining / self.height,
            self.across / self.width,
            height / self.height,
        )

    def words(self, height: float, marks: list[Mark]) -> Panel:
        """A strip without axes: one revolution in degrees wide, and 1 high."""
        x, y = Axis((0.0, 360.0)), Axis((0.0, 1.0))
        return Panel(self.frame(height), x, y, tuple(marks), bare=True)


def diagram(
    size: Size, title: str, y: Axis, marks: list[Mark], joints: tuple[float, ...]
) -> Figure:
    """A figure of one panel over the cam angle, with a legend and its `joints` [rad]."""
    legend = Legend(entries(marks))
    everything = (*marks, *joint_marks(joints))
    panel = Panel(grid(size, MARGINS)[0], turn_axis(), y, everything, title, legend=legend)
    return Figure(size, (panel,))


# -- motion diagram -------------------------------------------------------------------------------
# The motion diagram: lift and three derivatives with their extremes; at constant speed also over
# time.


MARKS: Final = ("", "′", "″", "‴")
RATES: Final = ("", "v", "a", "jerk")
ANGULAR: Final = ("", "d{}/dt", "d²{}/dt²", "d³{}/dt³")
"""Suffixes of derivatives by the angle, and names of those by time: of a length, and of an
angle."""

RAISED: Final = str.maketrans("0123456789", "⁰¹²³⁴⁵⁶⁷⁸⁹")
PER_ANGLE: Final = ("", "/rad", "/rad²", "/rad³")
PER_TIME: Final = ("", "/s", "/s²", "/s³")

PANEL, GAP = 1.3, 0.09
"""Heights [inch] of each panel and of the gap between two."""

HEIGHT: Final = 4 * PANEL + 3 * GAP

NAME_PLACE: Final = 0.6
"""Distance of the names of the vertical axes to the left of these [inch]."""

SECOND_PLACE: Final = 0.09
"""Distance of the names of the second scales, as a fraction of the width."""

SMALL: Final = 7.5
"""Size of the text of plan and diagram [points]."""

HEADROOM: Final = 0.28
"""Space for the extremes above the curve of a panel, as a fraction of its range."""

CLOSER: Final = 101
"""Number of points between the two neighbours of an extreme: half a degree in steps of 0.005."""

SAME: Final = 1e-10
"""Values that differ by less than this fraction of the largest are the same extreme."""

INFINITE: Final = Style(LIMIT, 0.0, marker="^", size=5.5)
DOWNWARDS: Final = replace(INFINITE, marker="v")
SPIKE: Final = Style(LIMIT, 1.0)
"""Styles of an infinite value: a line from zero to a head at the edge of the curve's range."""

SPIKES_ROOM: Final = 0.25
"""Least fraction of a panel on the side of zero towards which a spike points."""


@dataclass(frozen=True, slots=True)
class UnitStyle:
    """How a length or angle is written: unit, symbol, and how many units make 1 mm or 1 rad."""

    name: str
    symbol: str
    scale: float


@dataclass(frozen=True, slots=True)
class Infinite:
    """A place at which a derivative is infinite because a lower one jumps.

    Attributes
    ----------
    cam_angle : [rad].
    upwards, downwards : in which direction it is infinite; both are true where the jump is more
        than one derivative below it, as the derivative of an impulse goes both ways.
    """

    cam_angle: float
    upwards: bool
    downwards: bool


def diagram_panels(
    strips: Strips, plan: MotionPlan, motion: Motion, unit: UnitStyle, speed: float | None
) -> list[Panel]:
    """A panel for the position and each derivative of `motion`, which follows from `plan`.

    With a constant `speed` [rad/s] there are second scales of the derivatives by time.
    """
    places = tuple(joint.cam_angle for joint in joints(plan))
    phi = diagram_angles(tuple(joint.cam_angle for joint in breaks(plan)))
    jet = motion.jet(phi) * unit.scale
    degrees = np.concatenate(([0.0], np.degrees(phi)))
    near = _near_extremes(phi, jet)
    nearby = motion.jet(near.ravel())[: len(MARKS)].reshape(len(MARKS), *near.shape) * unit.scale
    panels = []
    for order, mark in enumerate(MARKS):
        if order:
            strips.skip(GAP)
        values = jet[order]
        infinite = infinite_places(plan, motion, order)
        low, high = _range(values, infinite)
        y_limits = low, high + HEADROOM * (high - low)
        # The curve begins with the value at the end of the turn, so that a jump at cam angle 0 is
        # drawn like the others.
        curve = over(degrees, np.concatenate((values[-1:], values)))
        marks: list[Mark] = [ZERO, Line(curve, CURVE), *joint_marks(places)]
        marks += _spikes(infinite, low, high)
        closer = list(zip(near[order], nearby[order, order], strict=True))
        marks.append(_extremes(phi, values, closer, infinite))
        label = f"{unit.symbol}{mark} [{unit.name}{PER_ANGLE[order]}]"
        # A curve that is zero wherever it is finite has no scale: its range is arbitrary.
        ticks = (0.0,) if infinite and not np.any(values) else None
        second = None
        if speed is not None and order:
            second = _second_scale(y_limits, unit, order, speed, strips.across)
        panels.append(
            Panel(
                strips.frame(PANEL),
                turn_axis(numbered=order == 3),
                # At a fixed distance, so that names are aligned whatever the width of the numbers.
                Axis(y_limits, label, ticks=ticks, label_place=NAME_PLACE),
                tuple(marks),
                right=None if second is None else replace(second, ticks=ticks),
            )
        )
    return panels


def infinite_places(plan: MotionPlan, motion: Motion, order: int) -> list[Infinite]:
    """Where the derivative of that order of `motion` is infinite because a lower one jumps."""
    places = []
    for joint in breaks(plan):
        if joint.order + 1 < order:
            angle = np.array([joint.cam_angle])
            left, right = motion.jet(angle, "left"), motion.jet(angle)
            rises = bool(right[joint.order + 1, 0] > left[joint.order + 1, 0])
            both = joint.order + 2 < order  # the derivative of an impulse
            places.append(Infinite(joint.cam_angle, rises or both, not rises or both))
    return places


def _range(values: FloatArray, infinite: list[Infinite]) -> tuple[float, float]:
    """Lower and upper end of the curve's range, with room for what is infinite."""
    low, high = limits([values, 0.0])
    # So that the room on one side of zero is SPIKES_ROOM of the whole range.
    room = SPIKES_ROOM * (high - low) / (1.0 - SPIKES_ROOM)
    if any(place.downwards for place in infinite):
        low = min(low, -room)
    if any(place.upwards for place in infinite):
        high = max(high, room)
    return low, high


def _spikes(infinite: list[Infinite], low: float, high: float) -> list[Mark]:
    """A line from zero to a head at `low` or `high` for each infinite value."""
    marks: list[Mark] = []
    for end, style, angles in (
        (high, INFINITE, [place.cam_angle for place in infinite if place.upwards]),
        (low, DOWNWARDS, [place.cam_angle for place in infinite if place.downwards]),
    ):
        degrees = np.degrees(angles)
        if not len(degrees):
            continue
        # All lines in one mark, separated by gaps.
        ends = np.tile([0.0, end, math.nan], len(degrees))
        marks.append(Line(over(np.repeat(degrees, 3), ends), SPIKE, layer=4.0, clipped=False))
        marks.append(
            Line(over(degrees, np.full(len(degrees), end)), style, layer=4.0, clipped=False)
        )
    return marks


def number(value: float) -> str:
    """The number with four significant digits, or all digits before the decimal point."""
    text = f"{value:.0f}" if 1e3 <= abs(value) < 1e7 else f"{value + 0.0:.4g}"
    return text.replace("-", "−")


def _near_extremes(phi: FloatArray, jet: FloatArray) -> FloatArray:
    """(rows, 2, CLOSER) cam angles between the neighbours of the largest and of the smallest value
    of each row of `jet` at `phi`.
    """
    places = np.stack((np.argmax(jet, axis=1), np.argmin(jet, axis=1)), axis=1)
    starts = phi[np.maximum(places - 1, 0)]
    ends = phi[np.minimum(places + 1, len(phi) - 1)]
    return np.linspace(starts, ends, CLOSER, axis=-1)


def _extremes(
    phi: FloatArray,
    values: FloatArray,
    closer: list[tuple[FloatArray, FloatArray]],
    infinite: list[Infinite],
) -> Text:
    """The largest and the smallest value, each with its first cam angle, as a text.

    They are searched for among the drawn `values` at `phi`, and among denser ones (`closer`) next
    to the largest and the smallest of these, which suffices for the digits written. An `infinite`
    value takes precedence over finite ones.
    """
    size = float(np.max(np.abs(values)))
    lines = []
    for word, sign, (near, nearby) in zip(("max", "min"), (1.0, -1.0), closer, strict=True):
        beyond = [
            place.cam_angle
            for place in infinite
            if (place.upwards if sign > 0.0 else place.downwards)
        ]
        if beyond:
            end = "∞" if sign > 0.0 else "−∞"
            lines.append(f"{word} {end} at {math.degrees(min(beyond)):.1f}°")
            continue
        candidates, angles = np.concatenate((values, nearby)), np.concatenate((phi, near))
        extreme = float(np.max(sign * candidates)) * sign
        first = float(np.min(angles[np.abs(candidates - extreme) <= SAME * size]))
        lines.append(f"{word} {number(extreme)} at {math.degrees(first):.1f}°")
    return Text(
        ",  ".join(lines), (0.99, 0.95), SMALL, "panel", across="right", up="top", box=Box(1.0)
    )


def _second_scale(
    y_limits: tuple[float, float], unit: UnitStyle, order: int, speed: float, across: float
) -> Axis:
    """The second axis of a panel: the derivative by time at a constant speed [rad/s]."""
    factor = speed**order
    name = RATES[order] if unit.symbol == "s" else ANGULAR[order].format(unit.symbol)
    low, high = (limit * factor for limit in y_limits)
    size = max(abs(low), abs(high))
    # Large numbers are divided by a power of 1000, which the name of the axis states.
    thousands = max(0, math.floor(math.log10(size) / 3.0)) if size > 0.0 else 0
    power = f"10{str(3 * thousands).translate(RAISED)} " if thousands else ""
    return Axis(
        (low / 1000.0**thousands, high / 1000.0**thousands),
        f"{name} [{power}{unit.name}{PER_TIME[order]}]",
        label_size=8.5,
        label_place=SECOND_PLACE * across,
    )


# -- motion plan ----------------------------------------------------------------------------------
# The motion plan: the task of each segment, and the motion classes at each joint.


PLAN: Final = 2
"""Index of the panel with the plan itself."""

NUMBERS, CLASSES = 0.26, 0.36
"""Heights [inch] of the strips above and below the plan."""

BAND: Final = 0.5
"""Height of the strip for the laws' names where they are written horizontally [inch]."""

LETTER: Final = 0.062
"""Width of a letter of the laws' names [inch], a generous estimate."""

TURNED_GAP, NUMBER_GAP, LETTERS_GAP, CLASS_GAP = 0.15, 0.2, 0.3, 0.4
"""Least distances [inch] of names written upwards, of numbers, of motion classes, and of these with
angles."""

FARTHEST: Final = 0.4
"""Largest distance of a motion class with its angle from its joint [inch]; farther away, it would
mislead."""

TICK_GAP: Final = 0.17
"""Least distance of the numbers on the plan's vertical axis [inch]."""

REST: Final = Style(LINE, 2.6, cap="butt")
MOVE: Final = Style(LINE, 1.0, (5.0, 3.0))
DATA: Final = Style(LINE, 1.0)
JOINT: Final = Style("black", 0.0, marker="o", size=4.0)
LEADER: Final = Style(AUXILIARY, 0.6)

SAMPLES: Final = 721
"""Number of points of a motion by data, finer than a printed line."""


@dataclass(frozen=True, slots=True, eq=False)
class PlanSegment:
    """A segment of the motion plan, of any length but 0.

    Attributes
    ----------
    start, end : cam angles [rad] in [0, 2 pi].
    label : name of its motion law; "dwell", or "data" for a motion by data.
    style : of the drawing: REST, MOVE or DATA.
    course : (n, 2) cam angles [rad] and positions [unit of the plan] of a motion by data, which is
        prescribed as a whole; None for the others.
    """

    start: float
    end: float
    label: str
    style: Style
    course: FloatArray | None = None


@dataclass(frozen=True, slots=True, eq=False)
class PlanSketch:
    """The data of a motion plan that a picture shows.

    Attributes
    ----------
    joints : of the plan, as many as segments: joint k is where segment k begins.
    segments : by ascending cam angle, without those of zero length.
    """

    joints: tuple[Joint, ...]
    segments: tuple[PlanSegment, ...]


def plan_sketch(plan: MotionPlan) -> PlanSketch:
    """The data of `plan` that a picture shows."""
    return PlanSketch(joints(plan), tuple(_segment(plan, *stretch) for stretch in plan.stretches))


def _segment(plan: MotionPlan, segment: Segment, start: float, end: float) -> PlanSegment:
    if isinstance(segment, Dwell):
        return PlanSegment(start, end, "dwell", REST)
    if isinstance(segment, Move):
        return PlanSegment(start, end, segment.law.name, MOVE)
    phi = np.linspace(start, end, SAMPLES)
    positions = np.append(plan.jet(phi[:-1])[0], segment.to)
    course = frozen(np.column_stack((phi, positions)), np.float64)
    return PlanSegment(start, end, "data", DATA, course)


def plan_panels(strips: Strips, sketch: PlanSketch, unit: UnitStyle, below: float) -> list[Panel]:
    """The panels of the plan and its strips of text, with `below` [inch] left free under them."""
    names = _names(sketch, strips.across)
    band = max(BAND, *(LETTER * len(name.text) + 0.2 for name in names if name.turned), 0.0)
    return [
        strips.words(band, _names_marks(sketch, names, band)),
        strips.words(NUMBERS, _numbers(sketch, strips.across)),
        _plan(strips, sketch, unit, strips.remaining - CLASSES - below),
        strips.words(CLASSES, _classes(sketch, strips.across)),
    ]


@dataclass(frozen=True, slots=True)
class _Name:
    """Text of a segment: its cam angle [degrees], and whether it is written upwards."""

    text: str
    place: float
    turned: bool


def _names(sketch: PlanSketch, across: float) -> list[_Name]:
    """Task and law of each segment: horizontal where they fit, else upwards and spread."""
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
        # Names that were moved off their segments would be hidden by those of their neighbours.
        turned[:] = True
        places = spread(middles, gap, 0.0, 360.0)
    return [
        _Name(f"{task} {s.label}" if upwards else text, float(place), bool(upwards))
        for task, s, text, place, upwards in zip(
            tasks, sketch.segments, texts, places, turned, strict=True
        )
    ]


def _tasks(sketch: PlanSketch) -> list[str]:
    """Motion task of each segment, from its ends."""
    following = (*sketch.joints[1:], *sketch.joints[:1])
    return [f"{a.after}-{b.before}" for a, b in zip(sketch.joints, following, strict=True)]


def _wrapped(label: str) -> list[str]:
    """A law's name in lines, broken after its hyphens."""
    parts = label.split("-")
    return [f"{part}-" for part in parts[:-1]] + parts[-1:]


def spread(places: FloatArray, gap: float, low: float, high: float) -> FloatArray:
    """`places` (n,), ascending, moved as little as possible until all are `gap` apart.

    The solution is that of least squares, by merging neighbours that are too close (pool adjacent
    violators). It stays inside [low, high], closer than `gap` where there is no room.
    """
    gap = min(gap, (high - low) / max(1, len(places) - 1))
    blocks: list[tuple[float, int]] = []  # mean of place - number * gap, count
    for index, place in enumerate(places):
        mean, count = float(place) - index * gap, 1
        while blocks and blocks[-1][0] >= mean:
            earlier, many = blocks.pop()
            mean, count = (mean * count + earlier * many) / (count + many), count + many
        blocks.append((mean, count))
    levels = np.repeat([mean for mean, _ in blocks], [count for _, count in blocks])
    levels = np.clip(levels, low, high - gap * (len(places) - 1))
    moved: FloatArray = levels + gap * np.arange(len(places))
    return moved


def _names_marks(sketch: PlanSketch, names: list[_Name], band: float) -> list[Mark]:
    leader = 0.12 / band
    marks: list[Mark] = []
    for segment, name in zip(sketch.segments, names, strict=True):
        middle = math.degrees(0.5 * (segment.start + segment.end))
        if name.turned:
            points = over([middle, name.place], [0.0, leader])
            marks.append(Line(points, Style(AUXILIARY, 0.5)))
        place = name.place, leader + 0.02 if name.turned else 0.02
        text = Text(name.text, place, SMALL, across="center", up="bottom", spacing=1.0)
        marks.append(replace(text, turned=name.turned))
    return marks


def _joint_places(sketch: PlanSketch) -> FloatArray:
    """(n + 1,) cam angles [degrees] of the joints; the first once more at the end of the turn."""
    return np.degrees([*(joint.cam_angle for joint in sketch.joints), TURN])


def _numbers(sketch: PlanSketch, across: float) -> list[Mark]:
    """Numbers of the joints in circles, above their joints where there is room."""
    angles = _joint_places(sketch)
    places = spread(angles, NUMBER_GAP * 360.0 / across, 0.0, 360.0)
    marks: list[Mark] = []
    for index, (angle, place) in enumerate(zip(angles, places, strict=True)):
        text, name_place = str(index % len(sketch.joints) + 1), (float(place), 0.58)
        marks.append(Line(over([angle, place], [0.0, 0.3]), LEADER, clipped=False))
        marks.append(
            Text(text, name_place, 6.5, across="center", up="center", box=Box(0.22, ring=True))
        )
    return marks


def _plan(strips: Strips, sketch: PlanSketch, unit: UnitStyle, height: float) -> Panel:
    """The panel of positions at the joints: rests are thick lines, moves dashed ones."""
    angles = _joint_places(sketch)
    positions = np.array([joint.position for joint in sketch.joints]) * unit.scale
    positions = np.append(positions, positions[0])
    extent = [positions]
    marks: list[Mark] = []
    for index, segment in enumerate(sketch.segments):
        ends = slice(index, index + 2)
        points = over(angles[ends], positions[ends])
        if segment.course is not None:
            course = segment.course[:, 1] * unit.scale
            extent.append(course)
            points = over(np.degrees(segment.course[:, 0]), course)
        marks.append(Line(points, segment.style))
    marks.append(Line(over(angles, positions), JOINT, layer=3.0, clipped=False))
    low, high = (float(limit(np.concatenate(extent))) for limit in (np.min, np.max))
    room = 0.15 * (high - low) or 1.0  # a plan of a single rest has no range
    levels = np.unique(np.round(positions, 9))
    spacing = np.min(np.diff(levels), initial=math.inf) / (high - low + 2.0 * room) * height
    # Ticks at the positions themselves, unless they are too close or data has positions between.
    at_levels = bool(spacing > TICK_GAP) and len(extent) == 1
    return Panel(
        strips.frame(height),
        turn_axis(numbered=False),
        Axis(
            (low - room, high + room),
            f"{unit.symbol} [{unit.name}]",
            ticks=tuple(map(float, levels)) if at_levels else None,
            names=tuple(map(number, levels)) if at_levels else None,
            label_place=NAME_PLACE,
        ),
        (*marks, *joint_marks(tuple(joint.cam_angle for joint in sketch.joints))),
    )


def _classes(sketch: PlanSketch, across: float) -> list[Mark]:
    """The motion classes at each joint, R, G, U or B, both if they differ; and its cam angle."""
    angles = _joint_places(sketch)
    inch = 360.0 / across
    places = spread(angles, CLASS_GAP * inch, 0.0, 360.0)
    with_angles = bool(np.all(np.abs(places - angles) <= FARTHEST * inch))
    if not with_angles:
        places = spread(angles, LETTERS_GAP * inch, 0.0, 360.0)
    joints = (*sketch.joints, sketch.joints[0])
    marks: list[Mark] = []
    for joint, angle, place in zip(joints, angles, map(float, places), strict=True):
        same = joint.before == joint.after
        text = joint.after if same else f"{joint.before}|{joint.after}"
        marks.append(Line(over([angle, place], [1.0, 0.82]), LEADER, clipped=False))
        marks.append(Text(text, (place, 0.8), SMALL, across="center", up="top", bold=True))
        if with_angles:
            marks.append(Text(f"{angle:.6g}°", (place, 0.38), 6.5, across="center", up="top"))
    return marks


# -- motion ---------------------------------------------------------------------------------------


SIZE = (7.0, 10.0)
"""Size of plan and one diagram [inch]; a second diagram adds its height."""

TOP, BOTTOM, HEADING = 0.32, 0.75, 0.34
"""Heights [inch] of the title, of what is below the diagrams, and of a diagram's title."""

NUMBERED = 0.42
"""Height [inch] of the numbers and name of the cam angle between two diagrams."""

SECOND_SCALE: Final = 0.75
"""Right margin [inch] with a second scale."""

ANGLES: Final = {"lever": "χ", "crank": "θ"}
"""Symbols of prescribed angles that are not the follower's own."""

WHAT: Final = {("s", "follower"): "lift", ("s", "slider"): "stroke", ("ψ", "follower"): "swing"}
"""Name of a position, by its symbol and the member that it belongs to."""

NAMES: Final = (
    (REST, "dwell"),
    (MOVE, "move, made by its law"),
    (DATA, "motion by data"),
)


def figure(product: Product, size: Size | None = None) -> Figure:
    """The motion plan above s, s', s'', s''' of what is prescribed, and of the follower."""
    return drive_figure(product.name, product.unit, product.cam.drive, product.cam.lift_unit, size)


def drive_figure(
    name: str, length: LengthUnit, drive: Drive, lift_unit: LiftUnit, size: Size | None = None
) -> Figure:
    """Motion plan and motion diagrams of a drive, for a design without any cam.

    Parameters
    ----------
    length : unit of the scene.
    lift_unit : of the follower's own motion.
    """
    speed = drive.speed if drive.speed_curve is None else None
    sketch = plan_sketch(drive.plan)
    unit = _unit(drive.unit, length)
    if drive.demanded_member in ANGLES:
        unit = replace(unit, symbol=ANGLES[drive.demanded_member])
    ends: list[tuple[str, Motion, UnitStyle]] = [(drive.demanded_member, drive.plan, unit)]
    if drive.linkage is not None:
        ends.append(("follower", drive.motion, _unit(lift_unit, length)))
    size = size or (SIZE[0], SIZE[1] + (len(ends) - 1) * (HEADING + NUMBERED + HEIGHT))
    strips = Strips(size, LEFT, RIGHT if speed is None else SECOND_SCALE)
    strips.skip(TOP)
    below = len(ends) * (HEADING + HEIGHT) + (len(ends) - 1) * NUMBERED + BOTTOM
    panels = plan_panels(strips, sketch, unit, below)
    titles = [_title(strips, f"{name}: motion plan of the {drive.demanded_member}", 0.14)]
    right = "" if speed is None else f" (right: at {speed / RPM:.4g} rev/min)"
    for number, (whose, motion, motion_unit) in enumerate(ends):
        strips.skip(NUMBERED if number else 0.0)
        behind = " behind the linkage" if number else ""
        what = WHAT.get((motion_unit.symbol, whose), "angle")
        heading = f"motion diagram: {what} {motion_unit.symbol} of the {whose}{behind}{right}"
        titles.append(_title(strips, heading, size[1] - strips.remaining + 0.2))
        strips.skip(HEADING)
        panels += diagram_panels(strips, drive.plan, motion, motion_unit, speed)
    styles = {segment.style for segment in sketch.segments}
    entries = [Entry(name, style) for style, name in NAMES if style in styles]
    entries.append(Entry("joint", JOINT))
    shocks, jerks = (infinite_places(drive.plan, drive.plan, order) for order in (2, 3))
    if jerks:
        text = f"infinite: {'shock or ' if shocks else ''}jerk"
        entries.append(Entry(text, INFINITE))
    anchor = _middle(strips), 0.05 / strips.height
    legend = Legend(tuple(entries), "lower center", anchor, len(entries))
    return Figure(size, tuple(panels), tuple(titles), legend)


def _title(strips: Strips, text: str, below_top: float) -> Text:
    """A title, its middle `below_top` [inch] below the figure's upper edge."""
    place = _middle(strips), 1.0 - below_top / strips.height
    return Text(text, place, 10.0, "figure", across="center", up="center")


def _middle(strips: Strips) -> float:
    return (strips.left + 0.5 * strips.across) / strips.width


def _unit(unit: LiftUnit, length: LengthUnit) -> UnitStyle:
    if unit == "mm":
        return UnitStyle(length, "s", 1.0 / MM_PER[length])
    return UnitStyle("°", "ψ", math.degrees(1.0))


# -- diagrams -------------------------------------------------------------------------------------
# Diagrams of one panel over the cam angle: the curvature, and the transmission angle.


DIAGRAM_SIZE = (7.0, 3.6)

RATIO: Final = {Flank.INNER: 1.0, Flank.OUTER: -1.0}
"""Sign of the curvature that is critical for a flank: the inner flank becomes too sharp where the
pitch curve is convex."""

RATIO_STYLE: Final = Style(LIMIT, 1.0, (1.2, 1.6))


def curvature(product: Product, size: Size = DIAGRAM_SIZE) -> Figure:
    """Curvature of the pitch curve with the limits +-1/d, where d is the distance of the flanks.

    At these limits a flank has a cusp. Nearer to zero is the limit of r_R/r_K that the scene
    states, on the side of each flank in use.
    """
    disc, follower, joints = product.cam.disc, product.cam.follower, product.cam.drive.joints
    phi = diagram_angles(joints)
    scale = MM_PER[product.unit]
    kappa = disc.pitch_curve.curvature(phi) * scale
    what = "pitch curve" if follower.has_pitch_curve else "outline"
    marks: list[Mark] = [Line(over(np.degrees(phi), kappa), CURVE, what)]
    distance = disc.flank_distance
    cusps = [scale / distance, -scale / distance] if distance > 0.0 else []  # knife, face: none
    name = "r$_R$" if distance == follower.roller_radius else "(r$_R$ + c/2)"
    for cusp in cusps:
        label = f"cusp of a flank, ±1/{name}" if cusp > 0.0 else ""
        marks.append(Rule("y", cusp, LIMIT_STYLE, label))
    limit, flanks = product.judgement.limits.radius_ratio, product.cam.contact.flanks
    if follower.roller_radius == 0.0:  # a knife edge or a face, which fits any radius
        flanks = ()
    ratios = [RATIO[flank] * limit * scale / follower.roller_radius for flank in flanks]
    for number, level in enumerate(ratios):
        label = "" if number else f"limit r$_R$/r$_K$ = {limit:g}"
        marks.append(Rule("y", level, RATIO_STYLE, label))
    y_axis = Axis(limits([kappa], [*cusps, *ratios, 0.0]), f"curvature κ [1/{product.unit}]")
    title = f"{product.name}: curvature of the {what}"
    return diagram(size, title, y_axis, [*marks, ZERO], joints)


def transmission_angle(product: Product, size: Size = DIAGRAM_SIZE) -> Figure:
    """The transmission angle with the limit of the design."""
    joints = product.cam.drive.joints
    phi = diagram_angles(joints)
    angle = np.degrees(product.cam.disc.pitch_curve.transmission_angle(phi))
    marks: list[Mark] = [Line(over(np.degrees(phi), angle), CURVE, "transmission angle")]
    limit = math.degrees(transmission_angle_limit(product.cam, product.judgement.limits))
    marks.append(Rule("y", limit, LIMIT_STYLE, f"limit {limit:g}°"))
    low = min(float(angle.min()), limit)
    floor = max(0.0, 10.0 * float(np.floor(low / 10.0)) - 5.0)
    y_axis = Axis((floor, 95.0), "transmission angle μ [°]")
    return diagram(size, f"{product.name}: transmission angle", y_axis, marks, joints)


# -- readings -------------------------------------------------------------------------------------
# What a diagram over the cam angle shows, in numbers: the extremes of each of its curves.


CURVE_POINTS: Final = 100
"""A line of fewer points is not a curve but a joint, a spike, or part of a plan."""

MOST_CURVES: Final = 4
"""Largest number of curves in the sentence of a diagram; its table has all."""


@dataclass(frozen=True, slots=True)
class CurveExtremes:
    """The extremes of one curve.

    Attributes
    ----------
    name : name of the quantity, with its unit in brackets.
    low, high : smallest and largest value, infinite where the diagram says so.
    low_angle, high_angle : cam angle [rad] of the first place of each.
    limits : limits of the quantity, with their names in the diagram.
    """

    name: str
    low: float
    low_angle: float
    high: float
    high_angle: float
    limits: tuple[tuple[str, float], ...] = ()


def readings(figure: Figure) -> tuple[CurveExtremes, ...]:
    """The extremes of all curves of a figure over the cam angle, from the top."""
    return tuple(reading for panel in figure.panels for reading in _panel_readings(panel))


def format_value(value: float) -> str:
    """The number with five significant digits, and with a minus sign instead of a hyphen."""
    if math.isinf(value):
        return "∞" if value > 0.0 else "−∞"
    return f"{value + 0.0:.5g}".replace("-", "−")


def plain(text: str) -> str:
    """A text of a figure without the markup of subscripts."""
    return text.replace("$_", "").replace("$", "")


def _panel_readings(panel: Panel) -> Iterator[CurveExtremes]:
    """The extremes of the curves of a panel, if it is one over the cam angle."""
    if panel.bare or panel.x.limits != (0.0, 360.0):
        return
    limits = tuple(
        (plain(mark.label), mark.at)
        for mark in panel.marks
        if isinstance(mark, Rule) and mark.axis == "y" and mark.label
    )
    beyond = {}
    for style, value in ((INFINITE, math.inf), (DOWNWARDS, -math.inf)):
        places = [
            float(mark.points[0, 0])
            for mark in panel.marks
            if isinstance(mark, Line) and mark.style == style
        ]
        if places:
            beyond[value] = min(places)
    for mark in panel.marks:
        if isinstance(mark, Line) and len(mark.points) > CURVE_POINTS:
            x, y = mark.points.T
            low, high = int(np.nanargmin(y)), int(np.nanargmax(y))
            ends = [(float(y[k]), float(x[k])) for k in (low, high)]
            if -math.inf in beyond:
                ends[0] = -math.inf, beyond[-math.inf]
            if math.inf in beyond:
                ends[1] = math.inf, beyond[math.inf]
            name = _named(mark.label, panel.y.label)
            (lowest, lowest_degrees), (highest, highest_degrees) = ends
            angles = math.radians(lowest_degrees), math.radians(highest_degrees)
            yield CurveExtremes(name, lowest, angles[0], highest, angles[1], limits)


def _named(label: str, axis: str) -> str:
    """The name of a curve with the unit of its axis."""
    if not label or label.startswith("pitch curve") or label == "outline":
        return axis
    unit = axis[axis.index("[") :] if "[" in axis else ""
    return f"{label} {unit}".strip()
