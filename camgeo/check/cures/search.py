"""The nearest value of a knob at which a cam is free of cusps and undercut."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from camgeo.check.cures.discs import Discs
from camgeo.check.cures.margin import Pairs, crossings_of, is_intact, margin
from camgeo.check.cures.neck import Neck, followed, narrowest
from camgeo.errors import GeometryError
from camgeo.numeric.arrays import FloatArray
from camgeo.numeric.roots import bracketed_roots
from camgeo.outline.cusps import CUSP

FIRST = 0.005
"""First step away from the present value, as a fraction of the scale. A range of cures narrower
than a step may be missed; half a per cent is less than what a designer rounds to."""

GROWTH = 2.0
"""Each step ends this many times farther from the present value than the one before it."""

BEYOND = 1e-7
"""Crossings are sought this fraction beyond the limit: at the limit itself the flank has a cusp or
touches itself, and closer to it the rounding of the curve decides."""

NARROW = 1e-9
"""Width, as a fraction of the scale, to which a limit that is not a root is enclosed."""

Make = Callable[[float], Discs]
"""The discs for a value of the knob; GeometryError where there are none."""


def nearest_cure(make: Make, start: float, end: float, scale: float) -> float | None:
    """The limit nearest to `start` on the way to `end` beyond which the discs are intact.

    For local undercut it is the root of the margin; for global undercut that of the neck's
    clearance, or, if there is no such neck, an intact value within `NARROW` of the limit. None if
    there is none on the way. A value without a mechanism is not intact.
    """
    away = 1.0 if end > start else -1.0
    before, regular, neck = start, False, None
    pairs = _pairs(make, start)
    if pairs:
        regular, neck = True, narrowest(make(start), pairs)
    for value in steps(start, end, scale):
        value = float(value)
        if _margin(make, value) <= CUSP:
            before, regular, neck = value, False, None
            continue
        if not regular:
            limit = root(lambda x: _margin(make, x), before, value)
            before = limit + away * min(BEYOND * scale, abs(value - limit))
            pairs = _pairs(make, before)
            if pairs == ():
                return limit
            regular, neck = True, narrowest(make(before), pairs) if pairs else None
        following = None if neck is None else followed(make(value), neck)
        if following is not None and following.clearance <= 0.0:
            before, neck = value, following  # it crosses for certain
            continue
        pairs = _pairs(make, value)
        if pairs == ():
            return _last_crossing(make, before, value, scale, neck)
        before, neck = value, narrowest(make(value), pairs) if pairs else None
    return None


def _last_crossing(make: Make, bad: float, good: float, scale: float, neck: Neck | None) -> float:
    """The limit of global undercut between a value that has it and one that is intact."""

    def clearance(value: float) -> float:
        here = None if neck is None else followed(make(value), neck)
        return -1.0 if here is None else here.clearance

    def intact(value: float) -> bool:
        try:
            return is_intact(make(value))
        except GeometryError:
            return False

    if neck is not None and clearance(bad) < 0.0 < clearance(good):
        limit = root(clearance, bad, good)
        if intact(limit + np.sign(good - bad) * min(BEYOND * scale, abs(good - limit))):
            return limit
    while abs(bad - good) > NARROW * scale:
        middle = 0.5 * (good + bad)
        if intact(middle):
            good = middle
        else:
            bad = middle
    return good


def steps(start: float, end: float, scale: float) -> FloatArray:
    """Values from `start`, excluded, to `end`, at geometrically growing distances."""
    reach = abs(end - start)
    if reach == 0.0:
        return np.empty(0)
    first = min(FIRST * scale, reach)
    count = int(np.ceil(np.log(reach / first) / np.log(GROWTH))) + 1
    values: FloatArray = start + np.geomspace(first, reach, count) * np.sign(end - start)
    values[-1] = end
    return values


def root(function: Callable[[float], float], low: float, high: float) -> float:
    """The root of `function` between `low` and `high`, where it has opposite signs."""

    def values(x: FloatArray) -> FloatArray:
        return np.array([function(float(each)) for each in x])

    return float(bracketed_roots(values, np.array([low]), np.array([high]))[0])


def _margin(make: Make, value: float) -> float:
    """The margin; -1 where there is no mechanism."""
    try:
        least = margin(make(value))
    except GeometryError:
        return -1.0
    return -1.0 if least is None else least


def _pairs(make: Make, value: float) -> Pairs | None:
    """See `crossings_of`; None also where there is no mechanism."""
    try:
        return crossings_of(make(value))
    except GeometryError:
        return None
