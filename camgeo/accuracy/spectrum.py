"""The spectrum of the ripple: harmonics of the cam's speed in the acceleration that is off.

The deviation of the output's velocity is smooth from piece to piece of the contour and bounded, so
its Fourier integrals are sums over the pieces; those of the acceleration follow by the factor i k,
jumps of the velocity included.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from camgeo.accuracy.benefit import slowed
from camgeo.design import Design
from camgeo.numeric.arrays import FloatArray, IntArray, grouped, merged
from camgeo.state.written import Writing

GAUSS: Final = (12, 16)
"""Nodes of Gauss's quadrature of a cell, and of the one that it is compared with."""

PHASE: Final = 2.0
"""Most by which the phase of the highest harmonic changes over a cell [rad]."""


@dataclass(frozen=True, slots=True, eq=False)
class Spectrum:
    """Harmonics of a ripple.

    Attributes
    ----------
    numbers : (n,) of the harmonics, from 1: number k has k times the frequency of the cam.
    amplitudes : (n,) of the output's acceleration that is off [mm/s^2 or rad/s^2].
    error : of each amplitude at most, in the same unit: the difference of two quadratures.
    """

    numbers: IntArray
    amplitudes: FloatArray
    error: float


def ripple_spectrum(design: Design, writing: Writing, speed: float, most: int) -> Spectrum:
    """The first `most` harmonics of the ripple of a contour at a constant `speed` [rad/s].

    Raises
    ------
    GeometryError, ToleranceError
        As of `camgeo.state.written.written`.
    """
    _, exact = slowed(design, speed)
    made = exact.written_as(writing).subject.state
    own = exact.subject.state
    edges = merged(np.concatenate((made.smooth_angles, own.smooth_angles)))
    widths = np.diff(edges)
    index, rank = grouped(np.maximum(1, np.ceil(widths * most / PHASE)).astype(np.intp))
    counts = np.bincount(index)
    width = (widths / counts)[index]
    low = edges[index] + rank * width
    found = []
    for nodes in GAUSS:
        places, weights = np.polynomial.legendre.leggauss(nodes)
        phi = (low[:, np.newaxis] + 0.5 * width[:, np.newaxis] * (1.0 + places)).ravel()
        shares = (0.5 * width[:, np.newaxis] * weights).ravel()
        off = shares * (made.output.jet(phi, "right", 1)[1] - own.output.jet(phi, "right", 1)[1])
        found.append(np.array([np.sum(off * np.exp(-1j * k * phi)) for k in range(1, most + 1)]))
    numbers = np.arange(1, most + 1)
    factor = speed**2 / np.pi * numbers
    error = float(np.max(factor * np.abs(found[1] - found[0]), initial=0.0))
    return Spectrum(numbers, factor * np.abs(found[1]), error)
