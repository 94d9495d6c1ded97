"""Positions of panels in a figure, and the limits of axes that contain what is drawn."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence

import numpy as np
from numpy.typing import ArrayLike

from camgeo.figure.marks import Line, Mark
from camgeo.figure.model import Axis, Frame, Panel
from camgeo.numeric.arrays import FloatArray

Size = tuple[float, float]
"""Width and height [inch]."""

Margins = tuple[float, float, float, float]
"""Left, right, upper and lower margin of a figure [inch]."""

MARGIN = 0.05
"""Space left free beyond what is drawn, as a fraction of its range."""

FLAT = 1e-15
"""A range that is a smaller fraction of its values than this counts as zero."""


def grid(
    size: Size,
    margins: Margins,
    rows: int = 1,
    columns: int = 1,
    gaps: tuple[float, float] = (0.0, 0.0),
) -> list[Frame]:
    """Frames of equal panels, row by row from the top.

    Parameters
    ----------
    gaps : between two rows and between two columns, as fractions of a panel.
    """
    (width, height), (left, right, top, bottom) = size, margins
    first, last = left / width, 1.0 - right / width
    high, low = 1.0 - top / height, bottom / height
    down = _steps(high - low, rows, gaps[0])
    across = _steps(last - first, columns, gaps[1])
    return [
        (first + start, high - foot, first + end, high - head)
        for head, foot in down
        for start, end in across
    ]


def box(left: float, bottom: float, width: float, height: float) -> Frame:
    """The frame of that width and height, all as fractions of the figure."""
    return left, bottom, left + width, bottom + height


class Strips:
    """Frames from the top of a figure downwards, between two margins [inch]."""

    def __init__(self, size: Size, left: float, right: float) -> None:
        self.width, self.height = size
        self.left = left
        self.across = self.width - left - right
        self.left_over = self.height

    def skip(self, height: float) -> None:
        """Leave `height` [inch] free."""
        self.left_over -= height

    def frame(self, height: float) -> Frame:
        """The next frame, `height` [inch] high."""
        self.left_over -= height
        return box(
            self.left / self.width,
            self.left_over / self.height,
            self.across / self.width,
            height / self.height,
        )

    def words(self, height: float, marks: list[Mark]) -> Panel:
        """A strip without axes, over one turn in degrees, of height 1."""
        x, y = Axis((0.0, 360.0)), Axis((0.0, 1.0))
        return Panel(self.frame(height), x, y, tuple(marks), bare=True)


def heights(lines: Iterable[Line]) -> list[FloatArray]:
    """The vertical coordinates of all points of `lines`."""
    return [line.points[:, 1] for line in lines]


def _steps(length: float, count: int, gap: float) -> list[tuple[float, float]]:
    """Where each of `count` equal parts of `length` begins and ends."""
    part = length / (count + gap * (count - 1))
    between = gap * part
    part = part * count / count  # keeps the last digits, on which names inside the files depend
    edges = np.cumsum([0.0, part, *[between, part] * (count - 1)])
    return [(float(a), float(b)) for a, b in edges.reshape(-1, 2)]


def rooms(width: float, heights: Sequence[float]) -> list[Size]:
    """The space for each of several rows of one page: their `heights` [inch] up to rounding.

    Rounded as matplotlib does when it divides a page of 100 dots per inch: names inside SVG files
    depend on the last digits of where panels are.
    """
    count, total = len(heights), sum(heights)
    down = np.cumsum([0.0, *(high * (1.0 / count * count / total) for high in heights)])
    edges = (1.0 - down) * (total * 100.0)
    return [(width, float(high)) for high in (edges[:-1] - edges[1:]) / 100.0]


def limits(
    drawn: Iterable[ArrayLike], rules: Iterable[float] = (), margin: float = MARGIN
) -> tuple[float, float]:
    """Limits of an axis that contain all values of `drawn`, with a margin.

    The `rules` are visible too: one within the margin takes no further room.
    """
    held = _values(drawn)
    low, high = _widened(held, margin)
    for rule in rules:
        held = np.append(held, rule)
        if not low <= rule <= high:
            low, high = _widened(held, margin)
    return low, high


def _widened(values: FloatArray, margin: float) -> tuple[float, float]:
    if not len(values):
        return 0.0, 1.0
    low, high = float(np.min(values)), float(np.max(values))
    if max(abs(low), abs(high)) == 0.0:
        low, high = -MARGIN, MARGIN
    elif high - low <= FLAT * max(abs(low), abs(high)):
        low, high = low - MARGIN * abs(low), high + MARGIN * abs(high)
    free = margin * (high - low)
    return low - free, high + free


def log_limits(drawn: Iterable[ArrayLike]) -> tuple[float, float]:
    """Limits of a logarithmic axis, likewise; a decade if nothing is drawn."""
    values = _values(drawn)
    values = values[values > 0.0]
    low, high = (float(np.min(values)), float(np.max(values))) if len(values) else (1.0, 10.0)
    if low == high:
        low = 10.0 ** (math.ceil(math.log10(low)) - 1)
        high = 10.0 ** (math.floor(math.log10(high)) + 1)
    first, last = np.log10([low, high])
    free = MARGIN * (last - first)
    return float(10.0 ** (first - free)), float(10.0 ** (last + free))


def round_ticks(
    limits: tuple[float, float], steps: Sequence[float], parts: int
) -> tuple[float, ...]:
    """Multiples within `limits` of the smallest step that divides them into at most `parts`.

    Parameters
    ----------
    steps : from 1 to 10 in ascending order; a step is one of them times a power of ten.
    """
    low, high = limits
    least = (high - low) / parts
    power = 10.0 ** math.floor(math.log10(least))
    step = next(each * power for each in steps if each * power >= least)
    first, last = math.ceil(low / step), math.floor(high / step)
    return tuple(number * step for number in range(first, last + 1))


def _values(drawn: Iterable[ArrayLike]) -> FloatArray:
    """All finite values."""
    values = np.concatenate([[], *(np.ravel(each) for each in drawn)])
    finite: FloatArray = values[np.isfinite(values)]
    return finite
