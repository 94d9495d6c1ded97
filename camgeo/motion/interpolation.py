"""The nodal values of an interpolating spline, by a banded Cholesky factorisation."""

from __future__ import annotations

import numpy as np

from camgeo.motion.spline_energy import (
    OF_CHORD,
    SLOPES,
    node_scales,
    pieces,
    positions,
)
from camgeo.numeric.arrays import BoolArray, FloatArray


def interpolate(
    step: FloatArray, chord: FloatArray, nodes: FloatArray, fixed: BoolArray, ring: bool
) -> FloatArray:
    """(n, 3) nodal values with the least energy; `nodes` holds the prescribed ones."""
    from scipy.linalg import cho_solve_banded, cholesky_banded

    count = len(nodes)
    scale = node_scales(step, ring)
    moments, ends = pieces(step, scale, ring)
    # The moments see the positions only through the chord, which is exact where positions cancel.
    rows = moments[:, :, SLOPES] * ((step / np.min(step)) ** -2.5)[:, np.newaxis, np.newaxis]
    shift = OF_CHORD * (chord * (step / np.min(step)) ** -2.5)[:, np.newaxis]
    place = 2 * positions(count, ring)[ends][:, :, np.newaxis] + np.arange(2)
    place = place.reshape(-1, 4)

    held = np.zeros(2 * count, dtype=np.bool_)
    own = 2 * positions(count, ring)[:, np.newaxis] + np.arange(2)
    held[own] = fixed[:, 1:]
    unknown = np.zeros(2 * count)
    unknown[own] = nodes[:, 1:] * np.stack((scale, scale**2), axis=1)

    width = 5 if ring else 3
    stiffness = np.einsum("mki,mkj->mij", rows, rows)
    diagonal = np.zeros(2 * count)
    np.add.at(diagonal, place, np.einsum("mii->mi", stiffness))
    balance = 1.0 / np.sqrt(diagonal)
    banded = np.zeros((width + 1, 2 * count))
    for i in range(4):
        for j in range(4):
            low, high = place[:, i], place[:, j]
            free = (low >= high) & ~held[low] & ~held[high]
            entry = stiffness[free, i, j] * balance[low[free]] * balance[high[free]]
            np.add.at(banded, (low[free] - high[free], high[free]), entry)
    banded[0, held] = 1.0
    factor = cholesky_banded(banded, lower=True)
    for _ in range(2):  # the second time with what rounding has left
        strain = np.einsum("mki,mi->mk", rows, unknown[place]) + shift
        force = np.zeros(2 * count)
        np.add.at(force, place, -np.einsum("mki,mk->mi", rows, strain))
        force[held] = 0.0
        unknown += balance * cho_solve_banded((factor, True), balance * force)

    out = nodes.copy()
    free_slopes = unknown[own] / np.stack((scale, scale**2), axis=1)
    out[:, 1:] = np.where(fixed[:, 1:], nodes[:, 1:], free_slopes)
    return out
