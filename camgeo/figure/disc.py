"""The disc as a body, filled and with its edges: the whole or a window of it."""

from __future__ import annotations

from itertools import dropwhile, pairwise

import numpy as np

from camgeo.figure import cut_off
from camgeo.figure.marks import Area, Fill, Line, Mark, Style, plane
from camgeo.figure.style import LINE, RETURN_STYLE
from camgeo.numeric.arrays import ComplexArray
from camgeo.part.engraving import text_of
from camgeo.part.part import Boundary, Part

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
        inside = [cut_off.clipped(ring, middle, 2.0 * width) for ring in rings]
        inside = [ring for ring in inside if len(ring)]
        if inside:
            marks.append(_area(inside, fill))
        for boundary, ring in zip(boundaries, rings, strict=True):
            edge = cut_off.near(np.append(ring, ring[:1]), middle, width)
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
    if sampled:
        return [boundary.sampled(sagitta).points(sagitta) for boundary in boundaries]
    return [boundary.arcs(sagitta).contour.points(sagitta) for boundary in boundaries]


def _area(rings: list[ComplexArray], fill: Fill) -> Area:
    """The area between `rings`, one of them the outermost; the others are holes."""
    outer = max(rings, key=_area_of)
    return Area(tuple(plane(ring if ring is outer else ring[::-1]) for ring in rings), fill)


def _area_of(ring: ComplexArray) -> float:
    return 0.5 * float(np.sum((ring.conj() * np.roll(ring, -1)).imag))
