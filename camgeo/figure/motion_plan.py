"""The motion plan: what each segment requires, and what meets at each joint."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from camgeo.figure.layout import Strips
from camgeo.figure.marks import Box, Line, Mark, Style, Text, over
from camgeo.figure.model import Axis, Panel
from camgeo.figure.motion_diagram import NAME_PLACE, SMALL, Unit, number
from camgeo.figure.style import AUXILIARY, LINE, joint_marks, turn_axis
from camgeo.motion.joints import Joint, joints
from camgeo.motion.plan import Dwell, MotionPlan, Move, Segment
from camgeo.numeric.arrays import FloatArray, frozen
from camgeo.units import TURN

PLAN: Final = 2
"""Which of the `panels` has the plan itself."""

NUMBERS, CLASSES = 0.26, 0.36
"""Heights [inch] of the strips above and below the plan."""

BAND: Final = 0.5
"""Height [inch] of the laws' names when written across."""

LETTER: Final = 0.062
"""Width [inch] of a letter of the laws' names, a generous estimate."""

TURNED_GAP, NUMBER_GAP, LETTERS_GAP, CLASS_GAP = 0.15, 0.2, 0.3, 0.4
"""Least distances [inch] of names written upwards, of numbers, of tasks, of tasks with angles."""

FARTHEST: Final = 0.4
"""Largest distance [inch] of a task with its angle from its joint; farther off would mislead."""

TICK_GAP: Final = 0.17
"""Least distance [inch] of the numbers on the plan's vertical axis."""

REST: Final = Style(LINE, 2.6, cap="butt")
MOVE: Final = Style(LINE, 1.0, (5.0, 3.0))
DATA: Final = Style(LINE, 1.0)
JOINT: Final = Style("black", 0.0, marker="o", size=4.0)
LEADER: Final = Style(AUXILIARY, 0.6)

SAMPLES: Final = 721
"""Points of a motion by data: half a degree, finer than a printed line."""


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
    """What a picture shows of a motion plan.

    Attributes
    ----------
    joints : of the plan, as many as segments: joint k is where segment k begins.
    segments : by ascending cam angle, without those of zero length.
    """

    joints: tuple[Joint, ...]
    segments: tuple[PlanSegment, ...]


def plan_sketch(plan: MotionPlan) -> PlanSketch:
    """What a picture shows of `plan`."""
    return PlanSketch(joints(plan), tuple(_segment(plan, *each) for each in plan.stretches))


def _segment(plan: MotionPlan, segment: Segment, start: float, end: float) -> PlanSegment:
    if isinstance(segment, Dwell):
        return PlanSegment(start, end, "dwell", REST)
    if isinstance(segment, Move):
        return PlanSegment(start, end, segment.law.name, MOVE)
    phi = np.linspace(start, end, SAMPLES)
    positions = np.append(plan.jet(phi[:-1])[0], segment.to)
    course = frozen(np.column_stack((phi, positions)), np.float64)
    return PlanSegment(start, end, "data", DATA, course)


def panels(strips: Strips, sketch: PlanSketch, unit: Unit, below: float) -> list[Panel]:
    """The plan between its strips of text, with `below` [inch] free under it."""
    names = _names(sketch, strips.across)
    band = max(BAND, *(LETTER * len(name.text) + 0.2 for name in names if name.turned), 0.0)
    return [
        strips.words(band, _names_marks(sketch, names, band)),
        strips.words(NUMBERS, _numbers(sketch, strips.across)),
        _plan(strips, sketch, unit, strips.left_over - CLASSES - below),
        strips.words(CLASSES, _classes(sketch, strips.across)),
    ]


@dataclass(frozen=True, slots=True)
class _Name:
    """Text of a segment: its cam angle [degrees], and whether it is written upwards."""

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
        # Some would be hidden by their neighbours' names.
        turned[:] = True
        places = spread(middles, gap, 0.0, 360.0)
    return [
        _Name(f"{task} {s.label}" if up else text, float(place), bool(up))
        for task, s, text, place, up in zip(
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

    Least squares, by merging neighbours that are too close; inside [low, high], closer than `gap`
    where there is no room.
    """
    gap = min(gap, (high - low) / max(1, len(places) - 1))
    blocks: list[tuple[float, int]] = []  # mean of place - number * gap, count
    for index, place in enumerate(places):
        mean, count = float(place) - index * gap, 1
        while blocks and blocks[-1][0] >= mean:
            before, many = blocks.pop()
            mean, count = (mean * count + before * many) / (count + many), count + many
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
        at = name.place, leader + 0.02 if name.turned else 0.02
        text = Text(name.text, at, SMALL, across="center", up="bottom", spacing=1.0)
        marks.append(replace(text, turned=name.turned))
    return marks


def _joint_places(sketch: PlanSketch) -> FloatArray:
    """(n + 1,) cam angles [degrees] of the joints; the first once more at the end of the turn."""
    return np.degrees([*(joint.cam_angle for joint in sketch.joints), TURN])


def _numbers(sketch: PlanSketch, across: float) -> list[Mark]:
    """Numbers of the joints, in circles, each above its joint if there is room."""
    angles = _joint_places(sketch)
    places = spread(angles, NUMBER_GAP * 360.0 / across, 0.0, 360.0)
    marks: list[Mark] = []
    for index, (angle, place) in enumerate(zip(angles, places, strict=True)):
        text, at = str(index % len(sketch.joints) + 1), (float(place), 0.58)
        marks.append(Line(over([angle, place], [0.0, 0.3]), LEADER, clipped=False))
        marks.append(Text(text, at, 6.5, across="center", up="center", box=Box(0.22, ring=True)))
    return marks


def _plan(strips: Strips, sketch: PlanSketch, unit: Unit, height: float) -> Panel:
    """Positions at the joints; rests as thick lines, moves dashed from joint to joint."""
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
    room = 0.15 * (high - low) or 1.0
    levels = np.unique(np.round(positions, 9))
    apart = np.min(np.diff(levels), initial=math.inf) / (high - low + 2.0 * room) * height
    at_levels = bool(apart > TICK_GAP) and len(extent) == 1
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
    """What meets at each joint, R, G, U or B, both if they differ; and its cam angle."""
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
