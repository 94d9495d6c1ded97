"""The front view: the part from above, with centre lines, pitch curve and base circle."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence

import numpy as np

from camgeo.contour.contour import Contour
from camgeo.sheet.hidden import chains_of
from camgeo.sheet.marks import Chain, Label, Layer, Mark, Round, line
from camgeo.sheet.shape import Shape
from camgeo.sheet.stretch import cut_out

DASH_DOT = (8.4, 1.05, 0.25, 1.05)
"""Line 04.1 of ISO 128-2 for lines 0.35 wide: dash, gap, dot, gap [mm of paper]."""

DASH_DOTS = (8.4, 1.05, 0.25, 1.05, 0.25, 1.05)
"""Line 05.1: the same with two dots."""

PATTERNS = {"CENTRE": DASH_DOT, "BASE_CIRCLE": DASH_DOTS}

BEYOND = 4.0
"""How far centre lines go beyond what they are of [mm of paper]."""

SMALL_BEYOND = 2.0
"""The same of holes."""


def outlines(shape: Shape) -> list[Mark]:
    """The edges of the part as they are seen from above."""
    return [mark for edge in shape.edges for mark in chains_of(shape, edge)]


def hole_centres(shape: Shape, scale: float) -> list[Mark]:
    """Centre lines of round boundaries off the cam axis: radial and along their pitch circle."""
    marks: list[Mark] = []
    circles: set[float] = set()
    for edge in shape.edges:
        if edge.circle is None or abs(edge.circle[0]) <= 1e-9 * shape.size:
            continue
        centre, radius = edge.circle
        outward = centre / abs(centre)
        far = radius + SMALL_BEYOND / scale
        marks.append(line(centre - far * outward, centre + far * outward, "CENTRE"))
        alike = [other for other in shape.edges if other.circle is not None
                 and math.isclose(abs(other.circle[0]), abs(centre), rel_tol=1e-9)]  # fmt: skip
        if len(alike) > 1:
            if not any(math.isclose(each, abs(centre), rel_tol=1e-9) for each in circles):
                circles.add(abs(centre))
                marks.append(Round(0j, abs(centre), "CENTRE"))
        else:
            across = far * 1j * outward
            marks.append(line(centre - across, centre + across, "CENTRE"))
    return marks


def in_dashes(marks: Iterable[Mark], scale: float) -> Iterator[Mark]:
    """The marks of a view, with its centre lines and auxiliary curves in dashes and dots.

    These are lines of their own: many programs know no patterns, have patterns of another size, or
    begin them anew at each vertex, so that a curve of short arcs is drawn solid.
    """
    for mark in marks:
        pattern = PATTERNS.get(getattr(mark, "layer", ""))
        if pattern is None or isinstance(mark, Label):
            yield mark
        elif isinstance(mark, Round):
            circle = Contour.circle(mark.radius, mark.centre)
            yield from dashed(circle, scale, mark.layer, pattern)
        elif isinstance(mark, Chain) and len(mark.vertices) == 2:
            yield from _dashed_line(mark, scale, pattern)
        else:
            yield mark


def dashed(
    contour: Contour, scale: float, layer: Layer, pattern: Sequence[float]
) -> Iterator[Chain]:
    """A closed contour in dashes and dots, with a whole number of patterns around it."""
    total = float(np.cumsum(contour.lengths)[-1])
    count = max(1, round(total * scale / sum(pattern)))
    stretch = total / (count * sum(pattern))
    place = -0.5 * pattern[0] * stretch
    for number in range(count * len(pattern)):
        size = pattern[number % len(pattern)] * stretch
        if number % 2 == 0:
            yield cut_out(contour, place % total, size, layer)
        place += size


def dashed_stretch(mark: Chain, scale: float, pattern: Sequence[float]) -> Iterator[Chain]:
    """Lines and arcs end to end in dashes, a closed chain with a whole number of patterns around
    it, an open one with a dash at each end; what is too short for a gap stays as it is.
    """
    contour = Contour.through(mark.vertices, mark.sweeps)
    if mark.closed:
        yield from dashed(contour, scale, mark.layer, pattern)
        return
    length = float(np.sum(contour.lengths[:-1]))
    count = round((length * scale - pattern[0]) / sum(pattern))
    if count < 1:
        yield mark
        return
    share = length / (count * sum(pattern) + pattern[0])
    place = 0.0
    for number in range(count * len(pattern) + 1):
        size = pattern[number % len(pattern)] * share
        if number % 2 == 0:
            yield cut_out(contour, place, min(size, length - place), mark.layer)
        place += size


def _dashed_line(mark: Chain, scale: float, pattern: Sequence[float]) -> Iterator[Chain]:
    """A straight line that begins and ends with a dash; a short one is one dash."""
    start, end = (complex(each) for each in mark.vertices)
    length = abs(end - start) * scale
    count = round((length - pattern[0]) / sum(pattern))
    if count < 1:
        yield mark
        return
    share = 1.0 / (count * sum(pattern) + pattern[0])
    place = 0.0
    for number in range(count * len(pattern) + 1):
        size = pattern[number % len(pattern)] * share
        if number % 2 == 0:
            way = end - start
            yield line(start + place * way, start + (place + size) * way, mark.layer)
        place += size
