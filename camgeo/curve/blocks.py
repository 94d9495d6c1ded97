"""Long arrays in blocks that stay in the processor's cache."""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from camgeo.numeric.arrays import FloatArray

Scalar = TypeVar("Scalar", bound=np.generic)

BLOCK = 4096
"""Points a block: a dozen arrays of complex numbers of that length fit into a second-level cache
of 1 MB, and the overhead of numpy's calls is still spread over many points."""


def in_blocks(
    function: Callable[[FloatArray], NDArray[Scalar]], phi: FloatArray
) -> NDArray[Scalar]:
    """`function(phi)` for a function (n,) -> (..., n), computed block by block."""
    if len(phi) <= BLOCK:
        return function(phi)
    parts = [function(phi[start : start + BLOCK]) for start in range(0, len(phi), BLOCK)]
    return np.concatenate(parts, axis=-1)
