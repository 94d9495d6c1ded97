"""How a load on its output swings an elastic train at low speeds, where `elastic_speed` starts.

In the notation of that module, v' = s lambda v + f: with v = -f / (s lambda) + z,

    z' = s lambda z + f' / (s lambda),

and where f jumps by J, z jumps by J / (s lambda). The slower the cam, the less is left of a jump
when the next one comes; but right behind it P has s^2 Re sum D J / lambda at any speed.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Final

import numpy as np

from camgeo.effects.effect import Quantity
from camgeo.effects.elastic import ElasticTrain
from camgeo.effects.force import Force
from camgeo.motion.time_course import TimeCourse
from camgeo.numeric.arrays import SIDES, FloatArray, Side
from camgeo.units import TURN

SLOWEST: Final = 1e200
"""An s at which each vibration has decayed before the next one begins."""

SAMPLES: Final = 32
"""Times a period at which a vibration is looked at."""

MOST_PERIODS: Final = 128
"""Periods of the fastest mode of which this is done at most."""


def pressed(behind: ElasticTrain) -> FloatArray:
    """(m,) |D|."""
    return np.abs(behind.train.force(0).loaded)


def drifting(behind: ElasticTrain) -> float:
    """sum |D z| s^2 at most, but for what the jumps of f leave."""
    load, rates = behind.response.load, behind.train.rates
    if load is None:
        return 0.0
    apart = np.abs(rates) * -rates.real
    return float(np.sum(pressed(behind) / apart)) * load.pieces.steepest


def jumps_of(load: Force) -> FloatArray:
    """(k,) jump of f at each of its borders [N or N mm]."""
    before, after = (load.coefficients(load.borders, side)[0] for side in SIDES)
    return np.asarray(after - before)


def struck(behind: ElasticTrain, s: float, clock: TimeCourse) -> Quantity:
    """(n,) sum |D z| s that the jumps of f leave, at most, with the cam turning as in `clock`: each
    decays until the others, and until itself a turn later.
    """
    load, rates, period = behind.load, behind.train.rates, behind.response.base.period
    if load is None:
        return lambda phi, _side: np.zeros(len(phi))
    sizes, struck_at = np.abs(jumps_of(load)), clock.time(load.borders)

    def left(phi: FloatArray, side: Side) -> FloatArray:
        since = clock.time(phi)[:, np.newaxis] - struck_at
        since[since < 0.0 if side == "right" else since <= 0.0] += period
        found = np.zeros(len(phi))
        for weight, rate in zip(pressed(behind) / np.abs(rates), rates.real, strict=True):
            decayed = np.exp(s * rate * since) @ sizes
            found += weight * decayed / -np.expm1(s * rate * period)
        return found

    return left


def swings(behind: ElasticTrain) -> Iterator[tuple[float, FloatArray]]:
    """The place [rad] of each border of f, and (k,) what P / s^2 has more behind it than at rest,
    Re sum D J / lambda exp(lambda t), over a period of the slowest mode.
    """
    load, rates = behind.load, behind.train.rates
    if load is None:
        return
    swing = TURN / float(np.min(np.abs(rates)))
    periods = min(float(np.max(np.abs(rates))) * swing / TURN, MOST_PERIODS)
    times = np.linspace(0.0, swing, SAMPLES * math.ceil(periods) + 1)
    shapes = behind.train.force(0).loaded / rates
    free = np.real(np.exp(np.multiply.outer(times, rates)) @ shapes)
    for place, jump in zip(load.borders.tolist(), jumps_of(load).tolist(), strict=True):
        yield place, jump * free
