"""The mechanism as a diagram: disc, follower and linkage at cam angle 0 and at the far position.

The lengths that the scene states are numbered in the first view and listed with their keys below.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Final

import numpy as np

from camgeo.design.product import Product
from camgeo.errors import CamgeoError
from camgeo.kinematics.mechanism.sketch import Dimension, Guide, MechanismSketch, Place, Places
from camgeo.numeric.arrays import FloatArray, frozen
from camgeo.part.boundaries import largest_radius
from camgeo.part.part import Part
from camgeo.pictures import cam as pictured
from camgeo.pictures.model import (
    AUXILIARY,
    Area,
    Axis,
    Box,
    Circle,
    Figure,
    Fill,
    Line,
    Mark,
    Panel,
    Size,
    Style,
    Text,
    cam_angles,
    figure_data,
    grid,
    plane,
)
from camgeo.record import Brief
from camgeo.units import MM_PER, TURN, LengthUnit

SAGITTA = 1e-4
"""Sagitta of chords, relative to the base radius: far below the width of a printed line."""

COARSE = 1e-2
"""Tolerance of the outline that sets the picture's extent, relative to the base radius."""

LINK = Style("black", 1.8, cap="round")
FACE = Style("black", 3.0, cap="butt")
THIN = Style("black", 1.0)
BODY = Fill("white", "black", 1.2)

JOINT = 0.012
"""Radius of a joint, as a fraction of the square root of the picture's area."""

HATCHES = 5
"""Least number of strokes that mark a fixed body."""

STROKE = 1.6
"""Distance of those strokes along a guide, in radii of a joint."""

PAST = 4.0
"""How far a guide reaches beyond what moves in it, in radii of a joint."""

MEASURE = Style(AUXILIARY, 0.9, (6.0, 2.0))
"""Style of a length along which there is no link."""

NUMBER = 7.0
"""Size of the numbers of lengths [points]."""

NUMBER_GAP = 0.22
"""Least distance between these numbers [inch]."""

SHARES = (0.5, 0.35, 0.65, 0.25, 0.75, 0.42, 0.58)
"""Where on a length its number may stand, the best place first."""

SHORT = 0.5
"""A length shorter than this [inch] has its number beyond its end."""

BEYOND = 0.14
"""How far beyond its end [inch]."""

LISTED, PER_ROW = 0.22, 3
"""Height of a row of the list of lengths [inch], and how many stand in a row."""

ROOM = 0.07
"""Room around what is drawn, as a fraction of its size."""

WIDTH = 10.0
"""Width of the picture [inch]."""

HEIGHTS = (2.5, 9.0)
"""Least and greatest height of the two panes [inch]."""

HEAD = 0.75
"""Room for the titles [inch]."""

EDGE = 0.15
"""Room next to the panes and between them [inch]."""


def figure(product: Product, size: Size | None = None) -> Figure:
    """The mechanism in two positions at the same scale; the panes are as high as their contents."""
    parts = disc_parts(product)
    sketches = [
        (phi, product.pictured.mechanism_sketch(phi)) for phi in (0.0, product.cam.drive.far_angle)
    ]
    low, high = window(_reach(product, parts), [sketch for _, sketch in sketches])
    width, height = (high - low).real, (high - low).imag
    dimensions = sketches[0][1].dimensions
    foot = EDGE + LISTED * -(-len(dimensions) // PER_ROW)
    if size is None:
        pane = 0.5 * (WIDTH - 3.0 * EDGE)
        size = WIDTH, min(max(pane * height / width, HEIGHTS[0]), HEIGHTS[1]) + HEAD + EDGE + foot
    joint = JOINT * math.sqrt(width * height)
    sagitta = SAGITTA * product.cam.follower.base_radius
    axis = [_circle(0j, joint), *(_stroke(-way * joint, way * joint) for way in (2.2, 2.2j))]
    panels = []
    frames = grid(size, (EDGE, EDGE, HEAD, EDGE + foot), 1, 2, (0.0, 0.02))
    for number, (frame, (phi, sketch)) in enumerate(zip(frames, sketches, strict=True)):
        turn = cmath.exp(1j * product.cam.rotation * phi)
        marks = _disc_bodies(parts, turn, sagitta)
        measures: list[Mark] = []
        if number == 0:
            left, bottom, right, top = frame
            scale = min((right - left) * size[0] / width, (top - bottom) * size[1] / height)
            measures = _measures(dimensions, sketch, scale)
        panels.append(
            Panel(
                frame,
                Axis((low.real, high.real)),
                Axis((low.imag, high.imag)),
                (*marks, *_bodies(sketch, joint), *axis, *measures),
                f"cam angle {math.degrees(phi):.4g}°",
                equal=True,
                bare=True,
            )
        )
    title_place = 0.5, 1.0 - 0.1 / size[1]
    title = Text(product.name, title_place, 11.0, "figure", across="center", up="top")
    return Figure(size, tuple(panels), (title, *_listed(dimensions, product.unit, size)))


def window(reach: float, sketches: Sequence[MechanismSketch[Place]]) -> tuple[complex, complex]:
    """Lower left and upper right corner [mm] of what both panes show: at least the circle with the
    radius `reach` about the cam axis.
    """
    points = [sketch.points for sketch in sketches]
    corners = np.concatenate([*points, reach * np.array([1, 1j, -1, -1j])])
    low = complex(corners.real.min(), corners.imag.min())
    high = complex(corners.real.max(), corners.imag.max())
    room = ROOM * max((high - low).real, (high - low).imag) * (1.0 + 1.0j)
    return low - room, high + room


def _reach(product: Product, parts: tuple[Part, ...]) -> float:
    """Largest distance of discs and base circle from the cam axis [mm]."""
    reach = product.cam.follower.base_radius
    coarse = COARSE * reach
    radii = [largest_radius(part.outermost.arcs(coarse).contour) for part in parts]
    return max([reach, *radii])


def disc_parts(product: Product) -> tuple[Part, ...]:
    """The disc, and the return disc of a pair; none if a disc or its bore is impossible."""
    try:
        return tuple(disc.drawn.part for disc in product.discs)
    except CamgeoError:
        return ()


def _bodies(sketch: MechanismSketch[complex], joint: float) -> list[Mark]:
    marks: list[Mark] = [Line(plane(link), LINK, layer=5.0) for link in sketch.links]
    marks += [Line(plane(face), FACE, layer=5.0) for face in sketch.faces]
    for centre, radius in sketch.rollers:
        marks.append(_circle(centre, radius, 4.0))
        marks.append(_circle(centre, min(joint, 0.4 * radius)))
    for guide in sketch.guides:
        marks += _guide(guide, joint)
    marks += [_circle(point, joint) for point in sketch.joints]
    for point in sketch.shafts:
        marks += _shaft(point, joint)
    return marks


def _measures(
    dimensions: Sequence[Dimension[complex]], sketch: MechanismSketch[complex], scale: float
) -> list[Mark]:
    """The lengths with their numbers, at `scale` inches per mm; dashed lines where there is no
    link.
    """
    links = {frozenset(link) for link in sketch.links}
    marks: list[Mark] = []
    occupied: list[complex] = []
    for number, dimension in enumerate(dimensions, start=1):
        way = dimension.end - dimension.start
        if frozenset((dimension.start, dimension.end)) not in links:
            marks.append(Line(plane([dimension.start, dimension.end]), MEASURE, layer=4.5))
        if abs(way) * scale < SHORT:
            along = way / abs(way) if way else 1.0 + 0.0j
            places = [dimension.end + step * BEYOND / scale * along for step in (1.0, 2.5, 4.0)]
        else:
            places = [dimension.start + share * way for share in SHARES]

        def room(place: complex) -> float:
            return min((abs(place - other) for other in occupied), default=math.inf) * scale

        # The first place far enough from all numbers so far, or else the one farthest from them.
        position = next(
            (place for place in places if room(place) >= NUMBER_GAP), max(places, key=room)
        )
        occupied.append(position)
        marks.append(
            Text(
                str(number), (position.real, position.imag), NUMBER,
                across="center", up="center", box=Box(0.2, ring=True), layer=7.0,
            )
        )  # fmt: skip
    return marks


def _listed(dimensions: Sequence[Dimension[complex]], unit: LengthUnit, size: Size) -> list[Text]:
    """The lengths by their numbers: key of the scene and value, in rows from left to right."""
    rows = -(-len(dimensions) // PER_ROW)
    texts = []
    for number, dimension in enumerate(dimensions):
        row, column = divmod(number, PER_ROW)
        values = [f"{value / MM_PER[unit] + 0.0:.6g}" for value in dimension.value]
        value = f"[{', '.join(values)}]" if dimension.vector else values[0]
        place = (
            (EDGE + column * (size[0] - 2.0 * EDGE) / PER_ROW) / size[0],
            (EDGE + (rows - 0.5 - row) * LISTED) / size[1],
        )
        text = f"{number + 1}  {dimension.key} = {value} {unit}".replace("-", "−")
        texts.append(Text(text, place, 8.5, "figure", up="center"))
    return texts


def _circle(centre: complex, radius: float, layer: float = 6.0) -> Mark:
    return Circle((centre.real, centre.imag), radius, BODY, layer)


def _guide(guide: Guide[complex], joint: float) -> list[Mark]:
    """Two bars, hatched on the outside, on both sides of a rod or a block."""
    along, across = guide.direction * joint, 1j * guide.direction * joint
    marks: list[Mark] = []
    if guide.block:
        block = np.array([1.6 * along + across, across - 1.6 * along])
        block = np.concatenate((block, -block, block[:1])) + guide.middle
        marks.append(Area((plane(block),), BODY, layer=5.0, closed=False))
    else:
        across *= 0.5
    # The guide covers the whole travel of its slider, so that it is the same in all positions.
    way = [((point - guide.middle) * guide.direction.conjugate()).real for point in guide.travel]
    first, last = (min([0.0, *way]) - PAST * joint, max([0.0, *way]) + PAST * joint)
    count = max(HATCHES, round((last - first) / (STROKE * joint)))
    for side in (1.15, -1.15):
        foot = guide.middle + side * across
        marks.append(_stroke(foot + first * guide.direction, foot + last * guide.direction))
        for k in range(count):
            start = foot + (first + (k + 0.5) * (last - first) / count) * guide.direction
            outward = math.copysign(1.0, side) * 1j * guide.direction * joint
            marks.append(_stroke(start, start + outward - 0.8 * along))
    return marks


def _shaft(point: complex, joint: float) -> list[Mark]:
    """A joint on a small hatched stand."""
    left, right = point + joint * (-1.6 - 2.6j), point + joint * (1.6 - 2.6j)
    marks = [_stroke(point, end) for end in (left, right)]
    marks.append(_stroke(left - 0.7 * joint, right + 0.7 * joint))
    for k in range(HATCHES):
        start = left + (right - left) * (k / (HATCHES - 1))
        marks.append(_stroke(start, start - joint * (0.8 + 0.9j)))
    return [*marks, _circle(point, joint)]


def _stroke(start: complex, end: complex) -> Mark:
    return Line(plane([start, end]), THIN, layer=4.0)


# -- animation ------------------------------------------------------------------------------------
# A revolution of the mechanism as data: the discs, which turn, and all bodies in many positions.
#
# Everything is in the fixed frame with its origin in the cam axis, in mm; the discs at cam angle 0.


POSITIONS: Final = 240
"""Number of positions in a revolution, 1.5 degrees apart. Between two of them bodies move along
straight lines, which differ from their arcs by less than the width of a line."""

CHORDS: Final = 1.5e-4
"""Distance of the discs' chords from the flanks where these are sampled, at the ends and in the
middle of a chord, relative to the base radius. The picture is at least two base radii wide."""

PITCH: Final = Style(AUXILIARY, 0.8, (10.0, 3.0, 2.0, 3.0))
BASE: Final = Fill(edge=AUXILIARY, width=0.6, dashes=(5.0, 4.0))


@dataclass(frozen=True, slots=True)
class Way:
    """A guide: where it begins and ends [mm], and whether a slider (block) runs on it."""

    start: complex
    end: complex
    block: bool


@dataclass(frozen=True, slots=True, eq=False)
class Animation(Brief):
    """A revolution of the mechanism.

    Attributes
    ----------
    low, high : lower left and upper right corner of what is shown [mm].
    rotation : +1 if the cam turns counter-clockwise, -1 clockwise.
    turning : marks that turn with the cam, at cam angle 0 [mm].
    note : why there is no disc; empty if there is one.
    links : number of points of each link.
    rollers : radii of the rollers [mm].
    faces : number of flat faces.
    joints : number of joints that move.
    shafts : places of the fixed joints [mm].
    guides : the guides, which do not move.
    places : (POSITIONS, n, 2) [mm], at equal steps of the cam angle from 0: the points of the
        links, both ends of each face, the centres of rollers, joints, and sliders on guides.
    lifts : (POSITIONS,) of the follower, in `lift_unit`.
    lift_unit : that of the scene, or "°".
    """

    low: complex
    high: complex
    rotation: int
    turning: tuple[Mark, ...]
    note: str
    links: tuple[int, ...]
    rollers: tuple[float, ...]
    faces: int
    joints: int
    shafts: tuple[complex, ...]
    guides: tuple[Way, ...]
    places: FloatArray
    lifts: FloatArray
    lift_unit: str

    def to_data(self) -> dict[str, Any]:
        """The data as of `Figure.to_data`; a place is a list of two numbers."""
        data: dict[str, Any] = figure_data(self)
        return data


def animation(product: Product, *, moving: bool = False) -> Animation:
    """A revolution of the mechanism of `product`, with all discs of a conjugate pair.

    While something is being dragged (`moving`), discs whose flanks have no cusp are shown before
    flanks that cross themselves are trimmed. Everything else is the same either way.

    Raises
    ------
    CamgeoError
        If the mechanism has no position at some cam angle.
    """
    cam = product.cam
    angles = np.linspace(0.0, TURN, POSITIONS, endpoint=False)
    sketch = product.pictured.mechanism_sketches(angles)
    first = sketch.position(0)
    marks, reach, note = _turning(product, moving=moving)
    low, high = window(reach, [sketch])
    lifts = cam.drive.motion.jet(angles)[0]
    degrees = cam.lift_unit == "rad"
    # As much beyond what moves as in the still picture, whose joints are of this size.
    past = PAST * 0.012 * math.sqrt((high - low).real * (high - low).imag)
    return Animation(
        low,
        high,
        cam.rotation,
        marks,
        note,
        tuple(len(link) for link in first.links),
        tuple(radius for _, radius in first.rollers),
        len(first.faces),
        len(first.joints),
        first.shafts,
        tuple(_way(guide.middle, guide.direction, guide.travel, guide.block, past)
              for guide in first.guides),
        _places(sketch),
        frozen(np.degrees(lifts) if degrees else lifts / MM_PER[product.unit], np.float64),
        "°" if degrees else product.unit,
    )  # fmt: skip


def _turning(product: Product, *, moving: bool) -> tuple[tuple[Mark, ...], float, str]:
    """The marks that turn with the cam, how far they reach [mm], and why there is no disc."""
    cam = product.cam
    base = cam.follower.base_radius
    note = ""
    marks = _discs(product, moving=moving)
    if not marks:
        try:
            flank_marks = pictured.whole_flanks(product, product.pictured.trimmed_stretches, 1.0)[0]
        except CamgeoError:  # the findings say so
            flank_marks = []
        note = next((mark.text for mark in flank_marks if isinstance(mark, Text)), "no disc")
        marks += [mark for mark in flank_marks if not isinstance(mark, Text)]
    if cam.follower.has_pitch_curve:
        marks.append(Line(plane(cam.disc.pitch_curve.point(cam_angles())), PITCH))
    reach = max([base, *map(_farthest, marks)])
    marks.append(Circle((0.0, 0.0), base, BASE, layer=2.0))
    return tuple(marks), reach, note


def _discs(product: Product, *, moving: bool) -> list[Mark]:
    """The discs; none if they are impossible.

    Chords are sampled and not proved, as an animation has to follow a drag.
    """
    sagitta = CHORDS * product.cam.follower.base_radius
    if moving:
        try:
            parts = tuple(disc.drawn.untrimmed for disc in product.discs)
            return _disc_bodies(parts, 1.0, sagitta, sampled=True)
        except CamgeoError:  # such as undercut: then the trimmed disc is needed, which takes longer
            pass
    return _disc_bodies(disc_parts(product), 1.0, sagitta, sampled=True)


def _disc_bodies(
    parts: tuple[Part, ...], turn: complex, sagitta: float, *, sampled: bool = False
) -> list[Mark]:
    """The main disc and those behind it, see `camgeo.pictures.cam.whole_disc`."""
    marks: list[Mark] = []
    for number, part in enumerate(parts):
        if number:
            marks += pictured.disc_behind(part, turn, sagitta, sampled=sampled)
        else:
            marks += pictured.whole_disc(part, turn, sagitta, sampled=sampled)[0]
    return marks


def _farthest(mark: Mark) -> float:
    """The farthest point of an area or a line from the cam axis [mm]."""
    rings = (
        mark.rings if isinstance(mark, Area) else (mark.points,) if isinstance(mark, Line) else ()
    )
    return max((float(np.hypot(*ring.T).max()) for ring in rings), default=0.0)


def _way(
    middle: complex, direction: complex, travel: tuple[complex, ...], block: bool, past: float
) -> Way:
    ways = [((point - middle) * direction.conjugate()).real for point in travel] or [0.0]
    start, end = min(ways) - past, max(ways) + past
    return Way(middle + start * direction, middle + end * direction, block)


def _places(sketch: MechanismSketch[Places]) -> FloatArray:
    """See `Animation.places`."""
    points = [point for link in sketch.links for point in link]
    points += [point for face in sketch.faces for point in face]
    points += [centre for centre, _ in sketch.rollers]
    points += sketch.joints
    points += [guide.middle for guide in sketch.guides if guide.block]
    places = np.empty((POSITIONS, len(points)), np.complex128)
    for number, point in enumerate(points):
        places[:, number] = point
    return frozen(places.view(np.float64).reshape(POSITIONS, len(points), 2), np.float64)
