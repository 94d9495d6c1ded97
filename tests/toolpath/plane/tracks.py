"""Random chains of lines and arcs, and dense points on them."""

from __future__ import annotations

import numpy as np

from camgeo.milling.track import Track
from camgeo.numeric.arrays import ComplexArray, FloatArray


def any_track(rng: np.random.Generator, count: int = 6, size: float = 10.0) -> Track:
    """Lines and arcs up to half a turn through `count` + 1 random points."""
    points = scattered(rng, count + 1, size)
    sweeps = rng.uniform(-3.0, 3.0, count)
    return through(points, np.where(rng.random(count) < 0.4, 0.0, sweeps))


def scattered(rng: np.random.Generator, count: int, size: float) -> ComplexArray:
    """Points in the square up to `size` from the origin."""
    found: ComplexArray = rng.uniform(-size, size, count) + 1j * rng.uniform(-size, size, count)
    return found


def through(points: ComplexArray, sweeps: FloatArray) -> Track:
    """The pieces between `points` (n + 1,) that turn by `sweeps` (n,)."""
    cot = 1.0 / np.tan(0.5 * np.where(sweeps == 0.0, 1.0, sweeps))
    chord = np.diff(points)
    centres = np.where(sweeps == 0.0, 0.0, points[:-1] + 0.5 * chord * (1.0 + 1j * cot))
    return Track(points, sweeps, centres)


def dense(track: Track, each: int) -> ComplexArray:
    """`each` points on every piece, both its ends among them."""
    share = np.linspace(0.0, 1.0, each)
    start, sweep, centre = (row[:, None] for row in (track.starts, track.sweeps, track.centres))
    lines = start + (track.ends[:, None] - start) * share
    arcs = centre + (start - centre) * np.exp(1j * sweep * share)
    return np.where(sweep == 0.0, lines, arcs).ravel()
