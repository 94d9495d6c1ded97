"""Cells of cam angle in which a flight is integrated, and the nodes in them."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Final, Self

import numpy as np

from camgeo.numeric.arrays import FloatArray
from camgeo.units import TURN
from camgeo.wording import cam_angle

FIRST_CELL: Final = 2.0**-16
"""Length of the first cell as a share of a smooth piece; each cell is twice as long as the one
before, so that a short flight is resolved as well as a long one."""

LONGEST_CELL: Final = 0.25
"""Largest length of a cell as a share of a smooth piece, before cells are halved."""

MOST_HALVINGS: Final = 6
"""Largest number of times that all cells are halved to reach a tolerance."""

ORDERS: Final = (16, 24)
"""Nodes per cell of the solution for the error estimate, and of the final one."""

ROUNDING: Final = 1e-12
"""An estimated error below this share is rounding, whatever the tolerance."""

CLOSE: Final = 1e-14
"""Change of the gap, as a share of its size, at which they end."""

NOISE: Final = 2.0**-50
"""Rounding of the forces, a share of the largest; it moves the gap, however small that is."""

ROUNDED: Final = 2.0**-52
"""Rounding of a lift, a share of the largest."""

MOST_AT_ONCE: Final = 64
"""Cells that are evaluated at a time at most."""

Polynomial = np.polynomial.Chebyshev


class StiffError(ArithmeticError):
    """Picard's iteration does not converge in a cell; words say where shorter ones do not help."""


SLOW: Final = 1e-6
"""Share of a rate at which viscous friction has gone; what is left of a jump is not."""


def why_stiff(angle: float, rate: FloatArray, force: Callable[[FloatArray], FloatArray]) -> str:
    """That a follower turns round near a cam `angle` [rad], and that the `force` on it, at a rate
    (n,), jumps with the sign of this; empty if it does not.
    """
    least, most = float(np.min(rate)), float(np.max(rate))
    if not least < 0.0 < most:
        return ""
    back, ahead = (force(np.full_like(rate, SLOW * end)) for end in (least, most))
    if np.allclose(back, ahead, rtol=SLOW, atol=0.0):
        return ""
    return (
        f"off the cam it turns round near cam angle {cam_angle(angle, '.0f')} deg, and friction"
        " that jumps there to the other side is not followed"
    )


@dataclass(frozen=True, slots=True, eq=False)
class Nodes:
    """The Chebyshev nodes of a cell.

    Attributes
    ----------
    places : (n,) of the nodes, from -1 to 1, ascending.
    fit : (n, n) from the values at the nodes to coefficients.
    gain : (n, n) from these values to the integral from the start of the cell to each node, with
        half the length of the cell as the unit.
    """

    places: FloatArray
    fit: FloatArray
    gain: FloatArray

    @classmethod
    def of(cls, count: int) -> Self:
        """So many nodes."""
        places = np.cos(np.pi * (np.arange(count) + 0.5) / count)[::-1]
        matrix = np.polynomial.chebyshev.chebvander(places, count - 1)
        fit = np.asarray(np.linalg.inv(matrix), dtype=np.float64)
        grown = np.polynomial.chebyshev.chebint(fit, lbnd=-1.0)
        return cls(places, fit, np.polynomial.chebyshev.chebvander(places, count) @ grown)

    def over(self, ends: tuple[float, float], pace: FloatArray) -> FloatArray:
        """(n, n) from values at the nodes of the cell with these `ends` to their integral over time
        to each node, where the cell is passed with the `pace` (n,) [rad/s].
        """
        return np.asarray(0.5 * (ends[1] - ends[0]) * self.gain / pace)

    def function(self, values: FloatArray, ends: tuple[float, float]) -> Polynomial:
        """With these `values` (n,) at the nodes of the cell with these `ends`."""
        return Polynomial(self.fit @ values, ends)

    def integral(self, values: FloatArray, start: float, ends: tuple[float, float]) -> Polynomial:
        """The integral of that, which is `start` where the cell starts."""
        return self.function(values, ends).integ(lbnd=ends[0]) + start


def cells_from(
    start: float, edges: FloatArray, share: float, turns: int = 1
) -> Iterator[tuple[float, float]]:
    """Cells [rad] over so many `turns` from `start`, short at first, none across one of `edges`.

    `share` scales their lengths.
    """
    first, end = math.floor(start / TURN), start + turns * TURN
    ahead = np.concatenate([edges[:-1] + (first + turn) * TURN for turn in range(turns + 1)])
    stops = [start, *ahead[(ahead > start) & (ahead < end)], end]
    size = share * FIRST_CELL
    for low, high in itertools.pairwise(stops):
        length = high - low
        if length <= 8.0 * math.ulp(high):
            continue
        place = low
        while place < high:
            end = min(place + max(size * length, math.ulp(high)), high)
            if high - end < 0.5 * size * length:
                end = high
            yield float(place), float(end)
            place = end
            size = min(2.0 * size, share * LONGEST_CELL)
