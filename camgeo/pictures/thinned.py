"""Figures with as few points as are seen: for the browser, which draws them anew with every change.

A thinned line goes through some of the points of the line, and each of the others is within a
distance of it on paper: `READ` in diagrams, `SEEN` in an animation. Coordinates are rounded by at
most a quarter of that. So where the line was within d of a curve, the thinned one is within d and
1.25 times that distance.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import replace
from itertools import pairwise
from typing import Any, Final

import numpy as np

from camgeo.numeric.arrays import ComplexArray, FloatArray, IntArray, frozen
from camgeo.pictures.mechanism import Animation
from camgeo.pictures.model import Area, Figure, Line, Panel

READ: Final = 1.0 / 3200.0
"""Distance [inch] so small that numbers read off a line of a diagram are right to a few parts in
ten thousand of the height of its panel."""

SEEN: Final = 1.0 / 1600.0
"""Distance [inch] that nobody sees, an eighth of a dot of 200 per inch."""

SHARE: Final = 0.25
"""Of that, by which coordinates are rounded at most, along each axis by 1 / sqrt(2) of it."""

CURVE: Final = 100
"""A line of fewer points is drawn as it is; one of more keeps more than that, by which what reads
figures tells curves over the cam angle from joints and spikes."""

AIM: Final = 0.7
"""Share of the distance that points are placed for; what is farther off gets more of them."""


Scale = tuple[float, float]


def thinned(figure: Figure) -> Figure:
    """The figure with fewer points, and shorter numbers."""
    plain = [not (panel.x.log or panel.y.log) for panel in figure.panels]
    shown = [panel for panel, is_plain in zip(figure.panels, plain, strict=True) if is_plain]
    scales = [_scale(panel, figure.size) for panel in shown]
    fewer = iter(_thinned([panel.marks for panel in shown], scales, READ))
    panels = tuple(
        replace(panel, marks=next(fewer)) if is_plain else panel
        for panel, is_plain in zip(figure.panels, plain, strict=True)
    )
    return replace(figure, panels=panels, rows=tuple(map(thinned, figure.rows)))


PAPER: Final = 8.0
"""Longer side of an animation on paper [inch]."""


def thinned_turn(turn: Animation) -> Animation:
    """The animation likewise, `PAPER` wide or high."""
    extent = turn.high - turn.low
    scale = PAPER / max(extent.real, extent.imag)
    digits = _digits((scale, scale), SEEN)[0]
    return replace(
        turn,
        turning=_thinned([turn.turning], [(scale, scale)], SEEN)[0],
        places=frozen(np.round(turn.places, digits) + 0.0, np.float64),
    )


def _thinned(
    panels: Sequence[Sequence[Any]], scales: Sequence[Scale], most: float
) -> list[tuple[Any, ...]]:
    """The marks of panels likewise, all at once; what is neither line nor area stays.

    Parameters
    ----------
    scales : of each panel, inches on paper per unit of each axis.
    most : distance by which points are off on paper [inch].
    """
    both = list(zip(panels, scales, strict=True))
    lines = [(each.points, by) for marks, by in both for each in marks if isinstance(each, Line)]
    kept = iter(_kept(lines, most))
    found: list[tuple[Any, ...]] = []
    for marks, scale in both:
        digits = _digits(scale, most)
        fewer: list[Any] = []
        for mark in marks:
            if isinstance(mark, Line):
                fewer.append(replace(mark, points=_rounded(mark.points[next(kept)], digits)))
            elif isinstance(mark, Area):
                rings = tuple(_rounded(ring, digits) for ring in mark.rings)
                fewer.append(replace(mark, rings=rings))
            else:
                fewer.append(mark)
        found.append(tuple(fewer))
    return found


def _scale(panel: Panel, size: tuple[float, float]) -> Scale:
    """Inches on paper per unit of each axis."""
    (left, low, right, high), (width, height) = panel.frame, size
    across = (right - left) * width / abs(panel.x.limits[1] - panel.x.limits[0])
    up = (high - low) * height / abs(panel.y.limits[1] - panel.y.limits[0])
    return across, up


def _digits(scale: tuple[float, float], most: float) -> tuple[int, int]:
    """Decimals of both coordinates."""
    step = 2.0 * SHARE * most / math.sqrt(2.0)
    return math.ceil(math.log10(scale[0] / step)), math.ceil(math.log10(scale[1] / step))


def _rounded(points: FloatArray, digits: tuple[int, int]) -> FloatArray:
    rounded = [np.round(points[:, axis], digits[axis]) + 0.0 for axis in (0, 1)]
    return frozen(np.column_stack(rounded), np.float64)


def _kept(lines: Iterable[tuple[FloatArray, Scale]], most: float) -> list[slice | IntArray]:
    """Which points of each of `lines` are kept, both ends among them."""
    found: list[slice | IntArray] = []
    long: list[tuple[int, ComplexArray]] = []
    for number, (points, scale) in enumerate(lines):
        found.append(slice(None))
        if len(points) > CURVE + 1 and bool(np.all(np.isfinite(points))):
            long.append((number, (points * np.array(scale)).view(np.complex128)[:, 0]))
    if long:
        ends = np.cumsum([0, *(len(points) for _, points in long)])
        kept = few_of(np.concatenate([points for _, points in long]), ends, most)
        parts = np.split(kept, np.searchsorted(kept, ends[1:-1]))
        for (number, _), part, first in zip(long, parts, ends[:-1], strict=True):
            found[number] = part - first
    return found


def few_of(points: ComplexArray, ends: IntArray, most: float) -> IntArray:
    """Numbers, ascending, of points of several lines through which a polygon is near all of them.

    Parameters
    ----------
    points : (n,) of all lines, one line after the other.
    ends : where each line begins, and n.
    most : distance of any point from the chord across it.
    """
    kept = _placed(points, ends, AIM * most)
    while True:
        distance = _apart(points, kept)
        worst = np.maximum.reduceat(distance, kept)
        wrong = np.nonzero(worst > most)[0]
        if not len(wrong):
            return kept
        stops = np.append(kept[1:], len(points))
        more = [kept[k] + int(np.argmax(distance[kept[k] : stops[k]])) for k in wrong]
        kept = np.union1d(kept, more)


def _placed(points: ComplexArray, ends: IntArray, aim: float) -> IntArray:
    """Points about as dense as a smooth curve needs: a chord over m steps is off by m^2 |d| / 8, d
    the second difference of the points.
    """
    bend = np.zeros(len(points))
    bend[1:-1] = np.abs(points[2:] - 2.0 * points[1:-1] + points[:-2])
    bend[ends[:-1]] = bend[ends[1:] - 1] = 0.0
    density = np.minimum(np.sqrt(bend / (8.0 * aim)), 1.0)
    # Whatever its bends, each line keeps more than CURVE points.
    for first, last in pairwise(ends):
        density[first:last] = np.maximum(density[first:last], (CURVE + 4.0) / (last - first))
    stations = np.floor(np.cumsum(density))
    chosen = np.nonzero(np.diff(stations, prepend=-1.0) > 0.0)[0]
    return np.union1d(chosen, np.concatenate((ends[:-1], ends[1:] - 1)))


def _apart(points: ComplexArray, kept: IntArray) -> FloatArray:
    """(n,) distance of each point from the chord across it; 0 between two lines."""
    number = np.repeat(np.arange(len(kept)), np.diff(np.append(kept, len(points))))
    start = points[kept]
    way = np.append(start[1:], start[-1:]) - start
    square = np.maximum(way.real**2 + way.imag**2, np.finfo(np.float64).tiny)
    along = points - start[number]
    share = np.clip((along * way.conj()[number]).real / square[number], 0.0, 1.0)
    distance: FloatArray = np.abs(along - share * way[number])
    return distance
