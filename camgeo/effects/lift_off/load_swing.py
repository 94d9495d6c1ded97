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

from camgeo.effects.elastic import ElasticTrain
from camgeo.numeric.arrays import SIDES, FloatArray
from camgeo.numeric.rounding import SHARE
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


def struck(behind: ElasticTrain, s: float) -> float:
    """sum |D z| s that the jumps of f leave, at most: each decays until the others and until itself
    a turn later.
    """
    load, rates = behind.response.load, behind.train.rates
    if load is None:
        return 0.0
    period, jumps = behind.response.base.period, np.abs(load.pieces.jumps)
    real = jumps > SHARE * load.pieces.largest
    jumps, times = jumps[real], load.pieces.edges[:-1][real]
    since = (times[:, np.newaxis] - times) % period
    left = np.zeros(len(times))
    for weight, rate in zip(pressed(behind), rates, strict=True):
        decayed = np.exp(s * rate.real * since) @ jumps
        left += weight / abs(rate) * decayed / -np.expm1(s * rate.real * period)
    return float(np.max(left, initial=0.0))


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
    for place in load.borders.tolist():
        before, after = (load.coefficients(np.array([place]), side)[0, 0] for side in SIDES)
        yield place, np.asarray((after - before) * free)
