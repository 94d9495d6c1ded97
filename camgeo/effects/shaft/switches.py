"""Where the side of a cam that carries changes."""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeVar

import numpy as np

from camgeo.effects.bearing_friction import LINEAR, RubbingLaw, with_reversals
from camgeo.effects.effect import Quantity
from camgeo.effects.shaft.rate import Drive, Shaft
from camgeo.numeric.arrays import FloatArray, merged
from camgeo.numeric.extremes import dips, grid_of
from camgeo.numeric.roots import roots_on_grid

AnyDrive = TypeVar("AnyDrive", bound=Drive)


def switches(
    law: Quantity,
    edges: FloatArray,
    laws: FloatArray,
    turned: Callable[[FloatArray], tuple[Shaft[AnyDrive], FloatArray]],
) -> FloatArray:
    """(k,) cam angles [rad] at which the side that carries changes, and with it the friction, or a
    force at an end of a guide.

    The acceleration has a kink there, which cells must not contain: one beside the end of a cell is
    seen at none of its nodes.

    Parameters
    ----------
    law : the torque law of the cam, smooth between `edges` (k,) [rad].
    laws : (6 or more, ...) the law somewhere, which shows of what kind it is.
    turned : the camshaft, as it is driven at n cam angles [rad], and y (n,) there.
    """
    linear = len(laws) == LINEAR
    if linear and np.array_equal(*laws[4:]):
        return np.empty(0)

    def push(phi: FloatArray) -> FloatArray:
        shaft, y = turned(phi)
        return shaft.push(law(phi, "right"), y)

    grid = grid_of(merged(np.concatenate((edges, dips(push, grid_of(edges))))))
    found = roots_on_grid(push, grid)
    if linear or not RubbingLaw.of(laws).collinear:
        return found

    def loads(phi: FloatArray) -> FloatArray:
        shaft, y = turned(phi)
        return shaft.loads(law(phi, "right"), y).real

    return with_reversals(loads, merged(np.concatenate((edges, found))))
