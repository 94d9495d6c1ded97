"""Long arrays in blocks that stay in the processor's cache."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from camgeo.numeric.arrays import FloatArray

Scalar = TypeVar("Scalar", bound=np.generic)

BLOCK = 8192
"""Points a block: a dozen real arrays of that length fit into a second-level cache of 1 MB, and the
overhead of numpy's calls is spread over many points (benchmarks/evaluate.py shows both)."""


def in_blocks(
    function: Callable[[FloatArray], NDArray[Scalar]], phi: FloatArray
) -> NDArray[Scalar]:
    """`function(phi)` for a function (n,) -> (..., n), computed block by block."""
    if len(phi) <= BLOCK:
        return function(phi)
    size = math.ceil(len(phi) / math.ceil(len(phi) / BLOCK))  # no small rest at the end
    first = function(phi[:size])
    out = np.empty((*first.shape[:-1], len(phi)), dtype=first.dtype)
    out[..., :size] = first
    for start in range(size, len(phi), size):
        out[..., start : start + size] = function(phi[start : start + size])
    return out
