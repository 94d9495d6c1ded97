"""The senses in which follower and slider move, between the cam angles at which they change."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from camgeo.motion.motion import Side
from camgeo.numeric.arrays import FloatArray
from camgeo.units import TURN

if TYPE_CHECKING:
    from camgeo.motion.motion import Motion

SHARES: Final = (0.25, 0.5, 0.75)
"""Of a piece at which its velocity is looked at; the fastest of them tells the sense."""

ROUNDING: Final = 8.0 * math.ulp(TURN)
"""An angle nearer to an edge [rad] is that edge, after full turns too."""


@dataclass(frozen=True, slots=True, eq=False)
class Senses:
    """The sense of a velocity over the turn, +1, -1, or 0 in a rest.

    A velocity itself tells it badly: it is 0 at both ends of every move, where Coulomb's friction
    is not.

    Attributes
    ----------
    edges : (k,) cam angles [rad] from 0 to 2 pi, ascending, between which the sense is one.
    signs : (k - 1,) the senses.
    """

    edges: FloatArray
    signs: FloatArray

    def __call__(self, phi: FloatArray, side: Side) -> FloatArray:
        """(n,) the sense at `phi` (n,) [rad], on that side of it."""
        nudge = ROUNDING if side == "right" else -ROUNDING
        piece = np.searchsorted(self.edges, np.mod(phi, TURN) + nudge) - 1
        return self.signs[piece % len(self.signs)]


def senses_of(motion: Motion, edges: FloatArray) -> Senses:
    """The senses of `motion` between `edges` (k,) [rad]."""
    low, span = edges[:-1], np.diff(edges)
    velocity = np.stack([motion.jet(low + share * span, "right", 1)[1] for share in SHARES])
    fastest = np.argmax(np.abs(velocity), axis=0)
    return Senses(edges, np.sign(velocity[fastest, np.arange(len(low))]))
