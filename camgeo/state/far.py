"""The motion of the far end of a linkage that the follower drives."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from camgeo.errors import GeometryError
from camgeo.mechanism.linkage_protocol import Linkage
from camgeo.motion.kept import Answers
from camgeo.motion.motion import FULL_ORDER, Dwell, Jet, Motion
from camgeo.numeric.arrays import FloatArray, Side, read_only

STEPS = 12
"""Most Newton steps; from a demanded position that is off by a tolerance a few are enough."""

SETTLED = 1e-9
"""After a step below this share of the largest position no other one is needed: the next would be
of the order of its square."""


@dataclass(frozen=True)
class FarMotion:
    """The motion of the far end for a motion of the follower near the demanded one; see `Motion`.

    With q = T(x) from the far end's position x to the follower's coordinate q, the chain rule gives
    q' = T_1 x', q'' = T_1 x'' + T_2 x'^2 and q''' = T_1 x''' + 3 T_2 x' x'' + T_3 x'^3.

    Attributes
    ----------
    follower : the motion of the follower.
    linkage : between both.
    demanded : of the far end, near which its positions are sought.
    """

    follower: Motion
    linkage: Linkage
    demanded: Motion
    _jets: Answers[Jet] = field(default_factory=Answers, init=False, repr=False, compare=False)

    @property
    def breaks(self) -> FloatArray:
        """See `Motion`."""
        return self.follower.breaks

    @property
    def borders(self) -> FloatArray:
        """See `Motion`."""
        return self.follower.borders

    @property
    def dwells(self) -> tuple[Dwell, ...]:
        """See `Motion`: it rests with the follower."""
        return self.follower.dwells

    def jet(self, phi: FloatArray, side: Side = "right", order: int = FULL_ORDER) -> Jet:
        """See `Motion`. Read-only, and the same values for recent requests, like those of a plan.

        Raises
        ------
        GeometryError
            If the follower goes beyond a dead centre of the linkage, or rests there.
        """
        jet = self._jets.recall(lambda: read_only(self._jet(phi, side)), side, phi)
        return jet[: order + 1]

    def _jet(self, phi: FloatArray, side: Side) -> Jet:
        """(4, n) position and derivatives."""
        own = self.follower.jet(phi, side, FULL_ORDER)
        x = self.demanded.jet(phi, side, 1)[0].copy()
        scale = max(1.0, float(np.max(np.abs(x), initial=0.0)))
        sense = np.sign(self._along(x, 1)[1])
        for _ in range(STEPS):
            here, slope = self._along(x, 1)
            if np.any(slope * sense <= 0.0):  # beyond a dead centre the far end moves the other way
                raise _at_dead_centre()
            step = (own[0] - here) / slope
            x = x + step
            if np.max(np.abs(step), initial=0.0) <= SETTLED * scale:
                break
        else:
            raise _at_dead_centre()
        _, first, second, third = self._along(x, FULL_ORDER)
        out = np.empty_like(own)
        out[0] = x
        out[1] = own[1] / first
        out[2] = (own[2] - second * out[1] ** 2) / first
        out[3] = (own[3] - 3.0 * second * out[1] * out[2] - third * out[1] ** 3) / first
        return out

    def _along(self, x: FloatArray, order: int) -> Jet:
        """(order + 1, n) the follower's coordinate and its derivatives by the position `x` (n,)."""
        way = np.zeros((4, len(x)))
        way[0], way[1] = x, 1.0
        return self.linkage.transform(way, order)

    def jet_and_bounds(self, low: FloatArray, high: FloatArray) -> tuple[Jet, Jet]:
        """See `Motion`: without any bound."""
        jet = self.jet(0.5 * (low + high))
        return jet, np.full_like(jet, np.inf)


def _at_dead_centre() -> GeometryError:
    return GeometryError(
        "the far end does not follow what the disc makes the follower do: the linkage is at a dead"
        " centre",
        key="linkage",
    )
