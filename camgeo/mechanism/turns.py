"""Angles any number of turns apart."""

from __future__ import annotations

import math
from collections.abc import Iterable

import numpy as np

from camgeo.numeric.arrays import BoolArray, FloatArray
from camgeo.units import TURN


def within(angles: Iterable[float], low: float, high: float) -> tuple[float, ...]:
    """Those in [low, high] [rad] of `angles` and all that lie whole turns from them, ascending."""
    found = {
        angle + TURN * turns
        for angle in angles
        for turns in range(math.ceil((low - angle) / TURN), math.floor((high - angle) / TURN) + 1)
    }
    return tuple(sorted(found))


def cosine_range(low: FloatArray, high: FloatArray) -> tuple[FloatArray, FloatArray]:
    """(n,) least and largest cosine over each range [low, high] of angles (n,) [rad]."""
    at_ends = np.cos(low), np.cos(high)
    least = np.where(_passes(low, high, math.pi), -1.0, np.minimum(*at_ends))
    most = np.where(_passes(low, high, 0.0), 1.0, np.maximum(*at_ends))
    return least, most


def _passes(low: FloatArray, high: FloatArray, angle: float) -> BoolArray:
    passed: BoolArray = np.floor((high - angle) / TURN) >= np.ceil((low - angle) / TURN)
    return passed
