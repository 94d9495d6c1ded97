"""Long arrays evaluated in blocks that fit the processor's cache."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import wraps
from typing import Any, TypeVar, cast

import numpy as np
from numpy.typing import NDArray

from camgeo.numeric.arrays import FloatArray, Side

Method = TypeVar("Method", bound=Callable[..., NDArray[Any]])

BLOCK = 8192
"""Points per block: a dozen real arrays of that length fit into a second-level cache of 1 MB, and
the overhead of numpy's calls is spread over many points."""


def in_blocks(method: Method) -> Method:
    """`method(self, phi, side)`, (n,) -> (..., n), evaluated in blocks; a number becomes (1,)."""

    @wraps(method)
    def whole(owner: Any, phi: FloatArray, side: Side = "right") -> NDArray[Any]:
        phi = np.atleast_1d(phi)
        if len(phi) <= BLOCK:
            return method(owner, phi, side)
        blocks = np.array_split(phi, math.ceil(len(phi) / BLOCK))
        return np.concatenate([method(owner, block, side) for block in blocks], axis=-1)

    return cast("Method", whole)


def cells_in_blocks(method: Method) -> Method:
    """The same for `method(self, low, high)`, of the cells between two arrays (n,)."""

    @wraps(method)
    def whole(owner: Any, low: FloatArray, high: FloatArray) -> NDArray[Any]:
        if len(low) <= BLOCK:
            return method(owner, low, high)
        number = math.ceil(len(low) / BLOCK)
        blocks = zip(np.array_split(low, number), np.array_split(high, number), strict=True)
        return np.concatenate([method(owner, *block) for block in blocks], axis=-1)

    return cast("Method", whole)
