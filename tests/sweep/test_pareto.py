"""The Pareto front, compared with its definition."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from camgeo.numeric.arrays import BoolArray, FloatArray
from camgeo.studies.optimise.optimise import front

COSTS = st.integers(1, 3).flatmap(
    lambda k: arrays(
        np.float64,
        st.tuples(st.integers(0, 25), st.just(k)),
        elements=st.sampled_from([0.0, 1.0, 2.0, 3.0, -1.5, np.nan, np.inf]),
    )
)
"""Few values, so that there are ties."""


def by_definition(costs: FloatArray) -> BoolArray:
    """No other row is nowhere worse and somewhere better."""
    whole = ~np.isnan(costs).any(axis=1)
    beaten = [
        any(np.all(other <= row) and np.any(other < row) for other in costs[whole]) for row in costs
    ]
    return whole & ~np.array(beaten, dtype=bool)


@given(COSTS)
def test_no_other_row_dominates(costs: FloatArray) -> None:
    assert np.array_equal(front(costs), by_definition(costs))
