"""The disc as a body, filled and with its edges: the whole or a window of it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import dropwhile, pairwise
from typing import Final

import numpy as np

from camgeo.design.pictured import CutOff
from camgeo.numeric.arrays import BoolArray, ComplexArray
from camgeo.part.part import Boundary, Part
from camgeo.part.spec import text_of
from camgeo.pictures.model import (
    LINE,
    RETURN_STYLE,
    Area,
    Axis,
    Entry,
    Fill,
    Inset,
    Line,
    Mark,
    Panel,
    Style,
    plane,
)

BODY = Fill("#e4e8ec", width=0.0)
GROOVE = Fill("#c2cad3", width=0.0)
EDGE = Style(LINE, 1.6)
LETTER = Style(LINE, 0.4)

FINE = 1e-3
"""Chords of a window, relative to its side."""


def whole(
    part: Part, scale: complex, sagitta: float, *, sampled: bool = False
) -> tuple[list[Mark], list[ComplexArray]]:
    """The part and its rings; `scale` units per mm, chords within `sagitta` [mm].

    A complex scale turns the part. If `sampled`, the chords are within `sagitta` only where flanks
    were sampled, and are found soonest; else they are those of the fewest arcs, proved.
    """
    marks: list[Mark] = []
    edges: list[Mark] = []
    drawn: list[ComplexArray] = []
    for boundaries, fill in _areas(part):
        rings = [ring * scale for ring in _rings(boundaries, sagitta, sampled=sampled)]
        marks.append(_area(rings, fill))
        drawn += rings
        for boundary, ring in zip(boundaries, rings, strict=True):
            style = _style(boundary)
            edges.append(Area((plane(ring),), Fill(edge=style.color, width=style.width)))
    return [*marks, *edges], drawn


def _style(boundary: Boundary) -> Style:
    """Of the edge along a boundary: thin along letters, whose strokes are narrow."""
    return LETTER if text_of(boundary.name) else EDGE


def behind(part: Part, scale: complex, sagitta: float, *, sampled: bool = False) -> list[Mark]:
    """The outline of the second disc of a conjugate pair, over the first one; see `whole`."""
    return [
        Line(plane(np.append(ring, ring[:1]) * scale), RETURN_STYLE, layer=3.0)
        for ring in _rings((part.outermost,), sagitta, sampled=sampled)
    ]


def near(part: Part, middle: complex, width: float) -> list[Mark]:
    """What lies in and near the square of side `width` [mm] around `middle`, in mm."""
    sagitta = FINE * width
    marks: list[Mark] = []
    for boundaries, fill in _areas(part):
        rings = _rings(boundaries, sagitta)
        inside = [clipped(ring, middle, 2.0 * width) for ring in rings]
        inside = [ring for ring in inside if len(ring)]
        if inside:
            marks.append(_area(inside, fill))
        for boundary, ring in zip(boundaries, rings, strict=True):
            edge = line_near(np.append(ring, ring[:1]), middle, width)
            marks.append(Line(plane(edge), _style(boundary)))
    return marks


def _areas(part: Part) -> list[tuple[tuple[Boundary, ...], Fill]]:
    """Areas of one filling each, as seen from above: the lowest layer of the disc, and upwards what
    is sunk in it, or stands on it.
    """
    disc = part.outermost
    seen = list(dropwhile(lambda layer: disc not in layer.boundaries, part.layers))
    found = [(seen[0].boundaries, BODY)]
    for lower, upper in pairwise(seen):
        if disc not in upper.boundaries:
            found.append((upper.boundaries, BODY))
            continue
        begins = tuple(each for each in upper.boundaries if each not in lower.boundaries)
        found.append((begins, GROOVE))
    return found


def _rings(
    boundaries: tuple[Boundary, ...], sagitta: float, *, sampled: bool = False
) -> list[ComplexArray]:
    """Points [mm] of each boundary."""
    rings = []
    for boundary in boundaries:
        contour = boundary.sampled(sagitta) if sampled else boundary.arcs(sagitta).contour
        rings.append(contour.points(sagitta))
    return rings


def _area(rings: list[ComplexArray], fill: Fill) -> Area:
    """The area between `rings`, one of them the outermost; the others are holes."""
    outer = max(rings, key=_area_of)
    return Area(tuple(plane(ring if ring is outer else ring[::-1]) for ring in rings), fill)


def _area_of(ring: ComplexArray) -> float:
    return 0.5 * float(np.sum((ring.conj() * np.roll(ring, -1)).imag))


# -- cut off --------------------------------------------------------------------------------------
# What is cut off from a flank: dashed in its own colour, its corner marked, and enlarged.
#
# A swallowtail is often only a thousandth of the disc wide; then an inset shows the largest one.


CUT: Final = "#c05a00"
"""Colour of what is not on the disc: in grey it lies between lines and grid."""

COURSE: Final = Style(CUT, 1.1, (3.0, 1.6))
CORNER: Final = Style(CUT, 0.0, marker="D", size=4.2, edge="white", edge_width=0.6)

SMALL: Final = 0.05
"""What is cut off is enlarged if it is smaller than this fraction of the disc."""

TINIEST: Final = 1e-5
"""But not below this fraction: the edges next to it would need contours finer than any file's."""

MARGIN: Final = 1.9
"""Side of what the inset shows, as a multiple of what is cut off."""

SIDES: Final = (0.34, 0.28, 0.22)
"""Sides tried for the inset, as fractions of the picture's smaller side."""

WORTH: Final = 3.0
"""An inset may lie this much farther away if it is larger by 1."""

RIM: Final = 0.07
TITLE: Final = 0.16
"""Space kept free around and above the inset, as fractions of its side."""

PLACES: Final = 13
"""Positions tried for the inset, along each side."""

Limits = tuple[float, float]

Window = Callable[[complex, float], list[Mark]]
"""Draws what lies around a point [mm], within a square of the given side [mm]."""


def cut_off_marks(found: Sequence[CutOff], scale: float) -> list[Mark]:
    """What is cut off, and its corners; `scale` units in 1 mm."""
    corners = np.array([each.corner for each in found]) * scale
    return [
        *(Line(plane(each.course * scale), COURSE, layer=2.5) for each in found),
        Line(plane(corners), CORNER, layer=2.6),
    ]


def cut_off_names(label: str) -> list[Entry]:
    """Names for the legend; `label` describes the dashed line."""
    return [Entry(label, COURSE), Entry("corner", CORNER)]


def enlarged(
    x: Limits,
    y: Limits,
    found: tuple[CutOff, ...],
    drawn: list[ComplexArray],
    size: float,
    scale: float,
    window: Window,
) -> tuple[tuple[Inset, ...], Limits]:
    """An inset of the largest part that is cut off, if it is small, in a free area.

    Parameters
    ----------
    x, y : limits of the picture.
    drawn : lines [unit of the picture] that must not be covered.
    size : of the disc [mm].
    scale : units of the picture per mm; the inset is drawn in mm.
    window : draws what is not cut off into the inset.

    Returns
    -------
    The inset, if any, and the limits of x, wider if room had to be made.
    """
    largest = max(found, key=_extent)
    extent = _extent(largest)
    if not TINIEST * size < extent < SMALL * size:
        return (), x
    place, side, x = _room(x, y, drawn, largest.corner * scale)
    middle, width = _middle(largest), MARGIN * extent
    times = side / (width * scale)
    corner = (middle - 0.5 * (1 + 1j) * width) * scale
    panel = Panel(
        (0.0, 0.0, 1.0, 1.0),
        Axis((middle.real - 0.5 * width, middle.real + 0.5 * width), ticks=()),
        Axis((middle.imag - 0.5 * width, middle.imag + 0.5 * width), ticks=()),
        (*window(middle, width), *cut_off_marks(found, 1.0)),
        f"{float(f'{times:.2g}'):,.0f} times as large",
        title_size=7.5,
        title_gap=2.5,
    )
    seen = corner.real, corner.imag, width * scale
    return (Inset(panel, place, side, seen, Style(CUT, 0.7)),), x


def clipped(ring: ComplexArray, middle: complex, width: float) -> ComplexArray:
    """The closed `ring` clipped to the square of side `width` around `middle`."""
    for outward in (1.0, 1j, -1.0, -1j):
        if not len(ring):
            break
        beyond = ((ring - middle) * np.conj(outward)).real - 0.5 * width
        following = np.roll(beyond, -1)
        inside = beyond <= 0.0
        crosses = inside != (following <= 0.0)
        share = np.divide(beyond, beyond - following, out=np.zeros_like(beyond), where=crosses)
        between = ring + share * (np.roll(ring, -1) - ring)
        pairs = np.column_stack((ring, between)).ravel()
        ring = pairs[np.column_stack((inside, crosses)).ravel()]
    return ring


def line_near(line: ComplexArray, middle: complex, width: float) -> ComplexArray:
    """The open `line`, NaN where it is outside a square three times as wide."""
    away = line - middle
    inside: BoolArray = np.maximum(np.abs(away.real), np.abs(away.imag)) < 1.5 * width
    return np.where(inside, line, complex(np.nan, np.nan))


def _extent(part: CutOff) -> float:
    return float(max(np.ptp(part.course.real), np.ptp(part.course.imag)))


def _middle(part: CutOff) -> complex:
    course = part.course
    x, y = ((np.max(each) + np.min(each)) / 2.0 for each in (course.real, course.imag))
    return complex(x, y)


def _room(
    x_limits: Limits, y_limits: Limits, drawn: list[ComplexArray], towards: complex
) -> tuple[tuple[float, float], float, Limits]:
    """Lower left corner and side of a square that covers nothing, and the limits of x.

    Room is made if necessary.
    """
    (left, right), (low, high) = x_limits, y_limits
    smaller = min(right - left, high - low)
    points = np.concatenate([_evenly(line, 0.01 * smaller) for line in drawn])
    found = []
    for side in (share * smaller for share in SIDES):
        rim, title = RIM * side, TITLE * side
        for x in np.linspace(left + rim, right - side - rim, PLACES):
            across = points[(points.real > x - rim) & (points.real < x + side + rim)].imag
            for y in np.linspace(low + rim, high - side - title, PLACES):
                if not np.any((across > y - rim) & (across < y + side + title)):
                    distance = abs(complex(x, y) + 0.5 * (1 + 1j) * side - towards)
                    found.append((distance - WORTH * side, float(x), float(y), side))
    if found:
        _, x, y, side = min(found)
        return (x, y), side, x_limits
    side = SIDES[0] * smaller
    y = min(max(towards.imag - 0.5 * side, low + RIM * side), high - (1.0 + TITLE) * side)
    return (right - RIM * side, y), side, (left, right + side)


def _evenly(line: ComplexArray, step: float) -> ComplexArray:
    """Points along `line`, at most `step` apart."""
    lengths = np.concatenate(([0.0], np.cumsum(np.abs(np.diff(line)))))
    places = np.linspace(0.0, lengths[-1], max(2, int(lengths[-1] / step) + 2))
    points: ComplexArray = np.interp(places, lengths, line)
    return points
