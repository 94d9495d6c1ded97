"""The spectrum of the ripple: harmonics of the cam's speed in the acceleration that is off.

The deviation of the output's velocity is smooth from piece to piece of the contour and bounded, so
its Fourier integrals are sums over the pieces; those of the acceleration follow by the factor i k,
jumps of the velocity included.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from camgeo.numeric.arrays import FloatArray, IntArray, grouped, merged
from camgeo.state.state import State

OCTAVES: Final = 9
"""Of a spectrum: the first is harmonic 1, the second 2 and 3, the last 256 to 511."""

MOST: Final = 2**OCTAVES - 1
"""Harmonics in them."""

GAUSS: Final = (12, 16)
"""Nodes of Gauss's quadrature of a cell, and of the one that it is compared with."""

PHASE: Final = 2.0
"""Most by which the phase of the highest harmonic changes over a cell [rad]."""

EPS: Final = float(np.finfo(np.float64).eps)


def harmonics(octave: int) -> str:
    """Those of an octave, from 0, in words: "1", "2-3", "4-7" and so on."""
    first = 2**octave
    return f"{first}-{2 * first - 1}" if octave else "1"


@dataclass(frozen=True, slots=True, eq=False)
class Spectrum:
    """Harmonics of a ripple at a constant speed of 1 rad/s; they go with the square of the speed.

    Attributes
    ----------
    numbers : (n,) of the harmonics, from 1: number k has k times the frequency of the cam.
    amplitudes : (n,) of the output's acceleration that is off [mm or rad per rad^2].
    error : of each amplitude at most, in the same unit: the difference of two quadratures, and the
        rounding of their sums.
    """

    numbers: IntArray
    amplitudes: FloatArray
    error: float

    @property
    def octaves(self) -> FloatArray:
        """(m,) effective value of the harmonics 1, 2 to 3, 4 to 7, ..., in the same unit."""
        starts = 2 ** np.arange(int(np.log2(len(self.numbers) + 1))) - 1
        return np.asarray(np.sqrt(0.5 * np.add.reduceat(self.amplitudes**2, starts)))

    @property
    def strongest(self) -> int:
        """The number of the harmonic with the largest amplitude."""
        return int(self.numbers[np.argmax(self.amplitudes)])


def ripple_spectrum(made: State, exact: State, most: int = MOST) -> Spectrum:
    """The first `most` harmonics of the ripple of the motion `made`, which should be `exact`."""
    edges = merged(np.concatenate((made.smooth_angles, exact.smooth_angles)))
    widths = np.diff(edges)
    index, rank = grouped(np.maximum(1, np.ceil(widths * most / PHASE)).astype(np.intp))
    counts = np.bincount(index)
    width = (widths / counts)[index]
    low = edges[index] + rank * width
    numbers = np.arange(1, most + 1)
    found, sizes = [], []
    for nodes in GAUSS:
        places, weights = np.polynomial.legendre.leggauss(nodes)
        phi = (low[:, np.newaxis] + 0.5 * width[:, np.newaxis] * (1.0 + places)).ravel()
        shares = (0.5 * width[:, np.newaxis] * weights).ravel()
        term = shares * (made.output.jet(phi, "right", 1)[1] - exact.output.jet(phi, "right", 1)[1])
        term, turn = term.astype(np.complex128), np.exp(-1j * phi)
        sizes.append(float(np.sum(np.abs(term))))
        sums = np.empty(most, np.complex128)
        for k in range(most):
            term *= turn
            sums[k] = np.sum(term)
        found.append(sums)
    # Each product turns by a phase rounded like phi, and is itself rounded.
    rounded = numbers * 8.0 * EPS * max(sizes)
    factor = numbers / np.pi
    error = float(np.max(factor * (np.abs(found[1] - found[0]) + rounded), initial=0.0))
    return Spectrum(numbers, factor * np.abs(found[1]), error)
