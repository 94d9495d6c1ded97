"""The speed at which a follower with an elastic train first leaves its flank, found without a gap.

It is searched from low speeds upwards, from an s = 1 / f at which no vibration can be large enough,
see `camgeo.effects.lift_off.least_reserve`. Where the smallest reserve at two s exceeds its fall
between them, contact is kept at all speeds between. Close to the crossing the steps shrink
quadratically.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from camgeo.effects.elastic import ElasticTrain
from camgeo.effects.lift_off.flank import Flank
from camgeo.effects.lift_off.least_reserve import LeastReserve, Point
from camgeo.effects.touching import TOUCH
from camgeo.numeric.arrays import FloatArray
from camgeo.numeric.extremes import Extreme, piecewise_extremes, piecewise_highest
from camgeo.numeric.oscillator.steady import SOFT

SEARCHED: Final = 4.0
"""Speeds are searched up to this multiple of that of the scene and of the lift-off speed of a rigid
train, whichever is higher."""

MOST_STEPS: Final = 1500
"""Speeds at which the response is computed; the steps are about as wide as the damping ratio."""

CLOSE: Final = 1e-12
"""Relative distance of the speed of lift-off and that up to which contact is kept."""

ROOT: Final = 1e-13
"""Relative distance of two steps towards a crossing at which it is found."""

BESIDE: Final = 1e-6
"""Relative distance at which the slope of g is taken."""

APART: Final = (1e-6, 1e-4, 1e-2)
"""Relative distances at which a crossing is looked for beside a known one."""

GROWTH: Final = 4.0
"""Factor between a step and the next one at most."""

SAFE: Final = 0.8
"""Share of the widest step that the last one lets expect."""


@dataclass(frozen=True, slots=True)
class ElasticSpeed:
    """What the search has found.

    Attributes
    ----------
    speed : at which contact is first lost, as a factor of that of the scene, with the cam angle
        [rad]; None if it is kept as far as was searched.
    kept : factor up to which contact is kept; 0 if none is.
    error : of `speed`.
    why : the search has ended before the end of its range; empty if it has not.
    """

    speed: Extreme | None = None
    kept: float = 0.0
    error: float = 0.0
    why: str = ""


def elastic_speed(
    flank: Flank,
    behind: ElasticTrain,
    edges: FloatArray,
    rigid: float,
    near: Extreme | None = None,
) -> ElasticSpeed:
    """The smallest speed at which the force on `flank` falls below its margin.

    Parameters
    ----------
    edges : (k,) cam angles [rad] from 0 to 2 pi between which the coefficients are smooth.
    rigid : the lift-off speed of a rigid train, as a factor of that of the scene.
    near : the speed at which a train that hardly differs leaves the flank: a crossing beside it is
        the first one too. None if none is known.
    """
    rates, period = behind.train.rates, behind.response.base.period
    if np.max(rates.real) >= 0.0:
        return ElasticSpeed(
            why="without damping the train resonates with a harmonic at ever lower speeds"
        )
    if behind.response.forcing.soft:
        return ElasticSpeed(why="the cam turns faster than the train vibrates")
    search = LeastReserve(flank, behind, edges)
    rest = piecewise_extremes(search.static, edges)
    if rest.lowest.value < -TOUCH * rest.magnitude:
        return ElasticSpeed(Extreme(0.0, rest.lowest.place))
    if rest.lowest.value <= TOUCH * rest.magnitude:
        return ElasticSpeed(why="nothing presses it on its flank at rest")
    swung = search.after_jumps()
    if swung is not None and swung.value < -TOUCH * rest.magnitude:
        return ElasticSpeed(Extreme(0.0, swung.place))
    widest = piecewise_highest(search.share, edges).value
    search = replace(search, widest=widest, largest=piecewise_highest(search.most, edges).value)
    beside = _beside(search, 1.0 / near.value) if near is not None and near.value else None
    if beside is not None:
        return beside
    fastest = float(np.min(np.abs(rates))) * period / SOFT
    end = 1.0 / min(SEARCHED * max(1.0, rigid if np.isfinite(rigid) else 1.0), fastest)
    start = search.start(rest.lowest.value)
    if start is None:
        return ElasticSpeed(why="where its load jumps the train may vibrate off it at any speed")
    return _first(search, max(start, 2.0 * end), end)


def _first(search: LeastReserve, start: float, end: float) -> ElasticSpeed:
    """The first crossing, from `start` down to `end`."""
    kept, lost = search.at(start), None
    step = 0.5 * (start - end)
    for _ in range(MOST_STEPS):
        trial = search.at(max(kept.s - step, end))
        if trial.lost:
            lost = _crossing(search, kept, trial)
            step = 0.5 * (kept.s - lost.s)
            continue
        least, sag = min(kept.floor, trial.floor), search.sag(kept, trial)
        if sag >= least:
            least = min(kept.g, trial.g)
        step = (kept.s - trial.s) * min(SAFE * math.sqrt(least / sag), GROWTH)
        if sag >= least:
            continue
        if trial.s <= end:
            return ElasticSpeed(kept=1.0 / end)
        per_square = sag / (kept.s - trial.s) ** 2
        kept = trial
        if lost is None:
            continue
        apart = kept.s - lost.s
        if apart <= CLOSE * lost.s:
            return _found(search, kept, lost)
        # The smaller g of the next step is then twice what the chord sags there.
        near = 2.0 * per_square * apart**2 / (kept.g / apart)
        step = apart - min(max(near, 0.5 * CLOSE * lost.s), 0.5 * apart)
    why = "its damping is so small that its resonances are too narrow to be searched one by one"
    return ElasticSpeed(kept=1.0 / kept.s, why=why)


def _beside(search: LeastReserve, s: float) -> ElasticSpeed | None:
    """The crossing beside `s`; None if there is none."""
    for apart in APART:
        kept, lost = (search.at(s * (1.0 + sign * apart)) for sign in (1.0, -1.0))
        if kept.g > 0.0 >= lost.g:
            return _found(search, kept, _crossing(search, kept, lost))
    return None


def _crossing(search: LeastReserve, kept: Point, lost: Point) -> Point:
    """Where g is 0 between `kept` and `lost`: by secants in a bracket (the Illinois method)."""
    ends = [(kept.s, kept.g), (lost.s, lost.g)]
    found = lost
    for _ in range(MOST_STEPS):
        (a, at_a), (b, at_b) = ends
        if abs(a - b) <= ROOT * lost.s:
            break
        s = a - at_a * (a - b) / (at_a - at_b)
        before, found = found, search.at(s)
        if abs(found.s - before.s) <= ROOT * lost.s or found.g == 0.0:
            break
        if (found.g > 0.0) == (at_b > 0.0):
            ends = [(a, 0.5 * at_a), (s, found.g)]
        else:
            ends = [(b, at_b), (s, found.g)]
    return found


def _found(search: LeastReserve, kept: Point, lost: Point) -> ElasticSpeed:
    """The crossing at `lost`, with contact kept up to just before it."""
    beside = search.at(lost.s * (1.0 + BESIDE))
    slope = abs(beside.g - lost.g) / (beside.s - lost.s)
    found = search.behind.at(1.0 / lost.s)
    off = search.widest * found.error / slope + (kept.s - lost.s)
    speed = Extreme(1.0 / lost.s, lost.lowest.place)
    return ElasticSpeed(speed, 1.0 / kept.s, speed.value * off / lost.s)
