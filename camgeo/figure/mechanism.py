"""The mechanism as a diagram: disc, follower and linkage at cam angle 0 and at the far position.

The lengths that the scene states are numbered in the first view and listed with their keys below.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Sequence

import numpy as np

from camgeo.errors import CamgeoError
from camgeo.figure import disc
from camgeo.figure.layout import Size, grid
from camgeo.figure.marks import Area, Box, Circle, Fill, Line, Mark, Style, Text, plane
from camgeo.figure.model import Axis, Figure, Panel
from camgeo.figure.style import AUXILIARY
from camgeo.mechanism.sketch import Dimension, Guide, MechanismSketch, Place
from camgeo.part.boundaries import largest_radius
from camgeo.part.part import Part
from camgeo.product.product import Product
from camgeo.units import MM_PER, LengthUnit

SAGITTA = 1e-4
"""Chords of the picture, relative to the base radius: far below a printed line."""

COARSE = 1e-2
"""Tolerance of the outline that sets the picture's extent, relative to the base radius."""

LINK = Style("black", 1.8, cap="round")
FACE = Style("black", 3.0, cap="butt")
THIN = Style("black", 1.0)
BODY = Fill("white", "black", 1.2)

JOINT = 0.012
"""Radius of a joint, as a fraction of the square root of the picture's area."""

HATCHES = 5
"""Number of strokes that mark a fixed body, at least."""

STROKE = 1.6
"""Distance of those strokes along a guide, in joints."""

PAST = 4.0
"""How far a guide reaches beyond what moves in it, in joints."""

MEASURE = Style(AUXILIARY, 0.9, (6.0, 2.0))
"""A length that no body shows."""

NUMBER = 7.0
"""Size of the numbers of lengths [points]."""

APART = 0.22
"""Least distance [inch] of these numbers."""

SHARES = (0.5, 0.35, 0.65, 0.25, 0.75, 0.42, 0.58)
"""Where on a length its number may stand, the best place first."""

SHORT = 0.5
"""A length shorter than this [inch] has its number beyond its end."""

BEYOND = 0.14
"""How far beyond [inch]."""

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
    """The mechanism twice, both to the same scale; the panes as high as their contents."""
    parts = parts_of(product)
    sketches = [
        (phi, product.pictured.mechanism_sketch(phi)) for phi in (0.0, product.cam.drive.far_angle)
    ]
    low, high = window(_reach(product, parts), [sketch for _, sketch in sketches])
    across, up = (high - low).real, (high - low).imag
    dimensions = sketches[0][1].dimensions
    foot = EDGE + LISTED * -(-len(dimensions) // PER_ROW)
    if size is None:
        pane = 0.5 * (WIDTH - 3.0 * EDGE)
        size = WIDTH, min(max(pane * up / across, HEIGHTS[0]), HEIGHTS[1]) + HEAD + EDGE + foot
    joint = JOINT * math.sqrt(across * up)
    sagitta = SAGITTA * product.cam.follower.base_radius
    panels = []
    frames = grid(size, (EDGE, EDGE, HEAD, EDGE + foot), 1, 2, (0.0, 0.02))
    for number, (frame, (phi, sketch)) in enumerate(zip(frames, sketches, strict=True)):
        turn = cmath.exp(1j * product.cam.rotation * phi)
        marks: list[Mark] = []
        for part in parts[:1]:
            marks += disc.whole(part, turn, sagitta)[0]
        for part in parts[1:]:
            marks += disc.behind(part, turn, sagitta)
        measures: list[Mark] = []
        if number == 0:
            left, bottom, right, top = frame
            scale = min((right - left) * size[0] / across, (top - bottom) * size[1] / up)
            measures = _measures(dimensions, sketch, scale)
        panels.append(
            Panel(
                frame,
                Axis((low.real, high.real)),
                Axis((low.imag, high.imag)),
                (*marks, *_bodies(sketch, joint), *_axis(joint), *measures),
                f"cam angle {math.degrees(phi):.4g}°",
                equal=True,
                bare=True,
            )
        )
    at = 0.5, 1.0 - 0.1 / size[1]
    title = Text(product.name, at, 11.0, "figure", across="center", up="top")
    return Figure(size, tuple(panels), (title, *_listed(dimensions, product.unit, size)))


def window(reach: float, sketches: Sequence[MechanismSketch[Place]]) -> tuple[complex, complex]:
    """Lower left and upper right corner [mm] of what both panes show, at least `reach` around."""
    points = [sketch.points for sketch in sketches]
    corners = np.concatenate([*points, reach * np.array([1, 1j, -1, -1j])])
    low = complex(corners.real.min(), corners.imag.min())
    high = complex(corners.real.max(), corners.imag.max())
    room = ROOM * max((high - low).real, (high - low).imag) * (1.0 + 1.0j)
    return low - room, high + room


def _reach(product: Product, parts: tuple[Part, ...]) -> float:
    """How far discs and base circle reach [mm]."""
    reach = product.cam.follower.base_radius
    coarse = COARSE * reach
    found = [largest_radius(part.outermost.arcs(coarse).contour) for part in parts]
    return max([reach, *found])


def parts_of(product: Product) -> tuple[Part, ...]:
    """The disc and, of a pair, the return disc; none if one or its bore is impossible."""
    try:
        return tuple(each.drawn.part for each in product.discs)
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
    """Each length with its number, at `scale` inches per mm; a dashed line where no link is."""
    links = {frozenset(link) for link in sketch.links}
    marks: list[Mark] = []
    taken: list[complex] = []
    for number, each in enumerate(dimensions, start=1):
        way = each.end - each.start
        if frozenset((each.start, each.end)) not in links:
            marks.append(Line(plane([each.start, each.end]), MEASURE, layer=4.5))
        if abs(way) * scale < SHORT:
            along = way / abs(way) if way else 1.0 + 0.0j
            places = [each.end + step * BEYOND / scale * along for step in (1.0, 2.5, 4.0)]
        else:
            places = [each.start + share * way for share in SHARES]

        def room(place: complex) -> float:
            return min((abs(place - other) for other in taken), default=math.inf) * scale

        at = next((place for place in places if room(place) >= APART), max(places, key=room))
        taken.append(at)
        marks.append(
            Text(
                str(number), (at.real, at.imag), NUMBER,
                across="center", up="center", box=Box(0.2, ring=True), layer=7.0,
            )
        )  # fmt: skip
    return marks


def _listed(dimensions: Sequence[Dimension[complex]], unit: LengthUnit, size: Size) -> list[Text]:
    """The lengths by their numbers: key of the scene and value, in rows from left to right."""
    rows = -(-len(dimensions) // PER_ROW)
    texts = []
    for number, each in enumerate(dimensions):
        row, column = divmod(number, PER_ROW)
        values = [f"{value / MM_PER[unit] + 0.0:.6g}" for value in each.value]
        value = f"[{', '.join(values)}]" if each.vector else values[0]
        at = (
            (EDGE + column * (size[0] - 2.0 * EDGE) / PER_ROW) / size[0],
            (EDGE + (rows - 0.5 - row) * LISTED) / size[1],
        )
        text = f"{number + 1}  {each.key} = {value} {unit}".replace("-", "−")
        texts.append(Text(text, at, 8.5, "figure", up="center"))
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
    # The whole way of a slider, so that the guide is the same wherever the slider is.
    way = [((at - guide.middle) * guide.direction.conjugate()).real for at in guide.travel]
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


def _axis(joint: float) -> list[Mark]:
    return [_circle(0j, joint), *(_stroke(-way * joint, way * joint) for way in (2.2, 2.2j))]


def _stroke(start: complex, end: complex) -> Mark:
    return Line(plane([start, end]), THIN, layer=4.0)
