"""The nearest value of a size at which a fault is gone, whatever the size and whatever the fault.

Where a condition is broken, the cam angle at which it is worst proves it broken for all values up
to the one at which the margin of that place alone vanishes. There another place may be the worst,
from which the search goes on: so it comes to the nearest value at which no place breaks anything,
step by step and from the broken side, and no window is jumped over. Along the way it solves
equations in one unknown.

What no place decides is left to the verdict on the value found. If it is a flank that crosses
itself, the search goes on where the neck is as wide as the roller; else in growing steps, from
which the limit is halved in.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Final, Protocol

import numpy as np

from camgeo.check.cures.conditions import Conditions, Discs
from camgeo.check.cures.neck import Neck, crossings, followed, narrowest
from camgeo.errors import GeometryError
from camgeo.numeric.arrays import FloatArray
from camgeo.numeric.roots import bracketed_roots

FIRST: Final = 0.005
"""First step, as a fraction of the scale, where no place of the cam says how far to go."""

GROWTH: Final = 1.5
"""Each such step is so many times the one before it."""

SPREAD: Final = 1.3
"""Each cell ends so many times as far from the present value as the one before it."""

LOST: Final = 1e-6
"""The first one where there is no mechanism, as beside the value at which a roller stands still."""

BEYOND: Final = 1e-7
"""A window narrower than this fraction of the scale is none: in the middle of it the cam has a cusp
up to rounding. Crossings are sought this far beyond the limit, where the flank touches itself."""

NARROW: Final = 5e-7
"""Width, as a fraction of the scale, to which a limit that is not a root is enclosed."""

ROUNDING: Final = 1e-13
"""A step that is no longer than this fraction of the scale ends at the limit."""

HOPS: Final = 200
"""Most places of the cam on the way to a window; five are usual."""

TRIALS: Final = 60
"""Most values that are judged."""

EDGE: Final = 1e-3
"""First cell of a place's margin, as a fraction of the scale; its neighbours grow with the
distance, as the margin becomes smoother."""

CURVED: Final = 3.0
"""A cell is halved unless the parabola through its ends and its middle, so many times as curved,
stays below 0."""

Excess = Mapping[str, float]
"""By how much limits are exceeded, by their names: positive where one is broken, infinite where it
is not known by how much."""

UNKNOWN: Final[Excess] = {"": math.inf}
"""That something is broken."""

STRAIGHT: Final = 0.03
"""By such a share of its distance from the nearer end a root between two values may be wrong, as
an excess is not quite linear."""

Along = Callable[[FloatArray], FloatArray]
"""(n,) values of a size -> (n,) margins at one place of the cam."""


def holds(excess: Excess) -> bool:
    """Whether no limit is exceeded."""
    return all(each <= 0.0 for each in excess.values())


class Knob(Protocol):
    """A size that may change.

    Attributes
    ----------
    start : its present value.
    scale : what a change of it is compared with.
    """

    @property
    def start(self) -> float: ...

    @property
    def scale(self) -> float: ...

    def make(self, value: float) -> Discs:
        """The discs with another value; GeometryError where there are none."""

    def worst(self, value: float, conditions: Conditions) -> Along | None:
        """The margins where one of the `conditions` is worst at `value`; None if all are kept.

        GeometryError where there is no mechanism.
        """


@dataclass(frozen=True, slots=True)
class Way:
    """A range of a size, and what must hold there.

    Attributes
    ----------
    knob : the size, which goes from its present value to `end`.
    conditions : at each place of the cam.
    judged : the verdict on a value that keeps the conditions.
    rounded : the value beside another that a designer would take, on which the verdict is asked
        for if it keeps the conditions.
    """

    knob: Knob
    end: float
    conditions: Conditions
    judged: Callable[[float], Excess]
    rounded: Callable[[float], float] | None = None

    @property
    def _away(self) -> float:
        return math.copysign(self.knob.scale, self.end - self.knob.start)

    def nearest(self) -> float | None:
        """The limit nearest to the present value beyond which everything holds; None if there is
        none.
        """
        knob, away = self.knob, self._away
        if self.end == knob.start:
            return None
        bad: float | None = None
        x, step, crossed = knob.start, FIRST, False
        for _ in range(TRIALS):
            limit = self.border(x)
            if limit is None:
                return None
            inside = limit + away * min(BEYOND, abs((self.end - limit) / away))
            wide = self._past_neck(inside) if crossed else None
            if not self.keeps(inside):
                x = inside
            elif wide is None and holds(self.judged(self._rounded(inside))):
                return limit if bad is None or limit != x else self._enclosed(bad, limit)
            elif wide is not None or (wide := self._past_neck(inside)) is not None:
                x, bad, crossed = wide, None, True
            else:
                x, bad, step = inside + away * step, inside, step * GROWTH
            if (x - self.end) * away >= 0.0:
                return None
        return None

    def _rounded(self, value: float) -> float:
        if self.rounded is None:
            return value
        rounded = self.rounded(value)
        return rounded if self.keeps(rounded) else value

    def border(self, x: float) -> float | None:
        """The first value from `x` on at which the conditions hold, up to rounding."""
        knob, lost = self.knob, LOST
        for _ in range(HOPS):
            if (x - self.end) * self._away > 0.0:
                return None
            try:
                along = knob.worst(x, self.conditions)
            except GeometryError:
                x, lost = x + self._away * lost, lost * GROWTH
                continue
            if along is None:
                return x
            root = first_root(along, x, self.end, knob.scale)
            if root is None or abs(root - x) <= ROUNDING * knob.scale:
                return root
            x = root
        return None

    def keeps(self, value: float) -> bool:
        """Whether the conditions hold."""
        try:
            return self.knob.worst(value, self.conditions) is None
        except GeometryError:
            return False

    def _enclosed(self, bad: float, good: float) -> float:
        """The limit between a value that is not accepted and one that is.

        By the secant of what is exceeded, a little to the side of the farther end, so that both
        ends move; by halves where that does not help.
        """
        beyond, within = self.judged(bad), self.judged(good)
        narrow, halve = NARROW * self.knob.scale, False
        while (width := abs(good - bad)) > narrow:
            exceeded = {name: each for name, each in beyond.items() if each > 0.0}
            share = 0.5
            told = all(each < math.inf and name in within for name, each in exceeded.items())
            if told and not halve:
                share = max(each / (each - within[name]) for name, each in exceeded.items())
                nearer = min(share, 1.0 - share)
                aside = max(narrow / (3.0 * width), STRAIGHT * nearer)
                share += math.copysign(aside, 0.5 - share)
            x = bad + share * (good - bad)
            found = self.judged(x) if self.keeps(x) else UNKNOWN
            if holds(found):
                good, within = x, found
            else:
                bad, beyond = x, found
            halve = abs(good - bad) > 0.5 * width
        return good

    def _past_neck(self, value: float) -> float | None:
        """Where the narrowest neck of discs that cross themselves is as wide as the roller, or up
        to where it is known to be narrower; None if they do not, or if nothing is known.
        """
        try:
            discs = self.knob.make(value)
            neck = narrowest(discs, crossings(discs))
        except GeometryError:
            return None
        if neck is None or neck.clearance >= 0.0:
            return None
        begun: Neck = neck

        def clearance(x: float) -> float:
            try:
                here = followed(self.knob.make(x), begun)
            except GeometryError:
                here = None
            return math.nan if here is None else here.clearance

        before, step = value, FIRST
        while (self.end - before) * self._away > 0.0:
            x = before + self._away * step
            if (x - self.end) * self._away > 0.0:
                x = self.end
            found = clearance(x)
            if found > 0.0:
                return _root(clearance, before, x)
            if math.isnan(found):
                return None if before == value else before
            before, step = x, step * GROWTH
        return before


def first_root(along: Along, start: float, end: float, scale: float) -> float | None:
    """The first value from `start` to `end` at which a margin, negative at first, vanishes.

    Cells in which it might reach 0 are halved: those where the parabola through three values, made
    more curved, does.
    """
    edges = _edges(start, end, scale)
    values = along(edges)
    settled = np.abs(np.diff(edges)) <= BEYOND * scale
    if values[0] >= 0.0:
        return start
    while True:
        across = np.flatnonzero(values >= 0.0)
        before = int(across[0]) - 1 if len(across) else len(settled)
        cells = np.flatnonzero(~settled[:before])
        if not len(cells):
            return _bracketed(along, edges[before], edges[before + 1]) if len(across) else None
        middles = 0.5 * (edges[cells] + edges[cells + 1])
        found = along(middles)
        split = _highest(values[cells], found, values[cells + 1]) >= 0.0
        settled[cells] = ~split | (np.abs(middles - edges[cells]) <= BEYOND * scale)
        places = cells[split] + 1
        edges, values = (
            np.insert(edges, places, middles[split]),
            np.insert(values, places, found[split]),
        )
        settled = np.insert(settled, places, settled[cells[split]])


def _bracketed(along: Along, low: float, high: float) -> float:
    return float(bracketed_roots(along, np.array([low]), np.array([high]))[0])


def _edges(start: float, end: float, scale: float) -> FloatArray:
    """Ends of cells from `start` to `end`, which grow with their distance."""
    reach = abs(end - start)
    first = min(EDGE * scale, reach)
    if first == 0.0:
        return np.array([start])
    count = 1 + math.ceil(math.log(reach / first) / math.log(SPREAD))
    away = math.copysign(1.0, end - start) * np.geomspace(first, reach, count)
    edges: FloatArray = np.append(start, start + away)
    edges[-1] = end
    return edges


def _highest(low: FloatArray, middle: FloatArray, high: FloatArray) -> FloatArray:
    """(n,) the largest value of the parabolas through three values, `CURVED` times as curved."""
    bend, slope = 0.5 * (low + high) - middle, 0.5 * (high - low)
    most = CURVED * np.abs(bend)
    with np.errstate(divide="ignore", invalid="ignore"):
        top, fall = middle + most, most - bend
        inside = top + 0.25 * slope * slope / fall
        inside = np.where(np.abs(slope) < 2.0 * fall, inside, -np.inf)
    return np.maximum(np.maximum(low, high), np.maximum(middle, inside))


def _root(function: Callable[[float], float], low: float, high: float) -> float:
    """The root of `function` between `low` and `high`, where it has opposite signs."""
    return _bracketed(lambda x: np.array([function(float(each)) for each in x]), low, high)
