"""The Pareto front: designs that no other one beats in every objective."""

from __future__ import annotations

import numpy as np

from camgeo.numeric.arrays import BoolArray, FloatArray


def front(costs: FloatArray) -> BoolArray:
    """(n,) which rows of `costs` (n, k), less being better, no other row dominates.

    A row dominates another if it is nowhere worse and somewhere better; equal rows stay together. A
    row with a NaN has no place in the order: it neither dominates nor is on the front.
    """
    found = np.zeros(len(costs), dtype=bool)
    whole = np.flatnonzero(~np.isnan(costs).any(axis=1))
    # In lexical order a row can only be dominated by an earlier one that is on the front itself.
    order = whole[np.lexsort(costs[whole].T[::-1])]
    kept = np.empty((0, costs.shape[1]))
    for row in order:
        here = costs[row]
        beaten = np.all(kept <= here, axis=1) & np.any(kept < here, axis=1)
        if not beaten.any():
            found[row] = True
            if not (len(kept) and np.array_equal(kept[-1], here)):
                kept = np.vstack((kept, here))
    return found
