"""What play a conjugate pair of real discs leaves the follower: two replays held together.

Pressed against the main disc alone the follower makes the lift q_1, against the return disc alone
q_2. Each disc stops it on its side, so that it can be anywhere between them; where they overlap the
rollers are squeezed.
"""

from __future__ import annotations

import numpy as np

from camgeo.errors import GeometryError
from camgeo.motion.motion import Side
from camgeo.numeric.arrays import FloatArray, ascending
from camgeo.numeric.extremes import Extremes, piecewise_extremes
from camgeo.outline.replay_result import Replay
from camgeo.units import TURN


def play(main: Replay, other: Replay, phi: FloatArray, side: Side = "right") -> FloatArray:
    """(n,) play between the discs at the cam angles `phi` (n,) [rad], negative where they squeeze.

    In the unit of the lift [mm or rad]: outward times (q_2 - q_1), outward the sense of a lift that
    takes the main roller away from the cam axis.
    """
    outward = main.course.path.outward
    return outward * (other.course.lift(phi, side) - main.course.lift(phi, side))


def closing_error(main: Replay, other: Replay) -> Extremes:
    """Smallest and largest `play` over the turn, between all places where a disc's piece changes.

    Raises
    ------
    GeometryError
        If both discs push the follower in the same sense: there is nothing between them.
    """
    if main.course.path.outward == other.course.path.outward:
        raise GeometryError("the two discs push the follower in the same sense: they do not close")
    ends = np.array([0.0, TURN])
    borders = (ends, main.course.borders, other.course.borders, main.course.motion.borders)
    edges = ascending(np.clip(np.concatenate(borders), 0.0, TURN))
    return piecewise_extremes(lambda phi, side: play(main, other, phi, side), edges)
