"""Positions of a demanded motion: where it passes them, and how messages write them."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from camgeo.motion.extremes import pieces, turning_angles
from camgeo.numeric.arrays import BoolArray, FloatArray, IntArray, merged
from camgeo.numeric.roots import bracketed_roots

if TYPE_CHECKING:
    from camgeo.mechanism.linkage_protocol import Linkage, Member
    from camgeo.motion.motion import Motion

POSITIONS: Final[dict[Member, str]] = {
    "slider": "stroke",
    "lever": "lever angle",
    "crank": "crank angle",
}
"""What the demanded position is called."""


@dataclass(frozen=True, slots=True, eq=False)
class MonotoneRuns:
    """A motion cut into runs, on each of which it has one formula and one direction.

    Attributes
    ----------
    motion : the demanded motion.
    ends : (k,) cam angles [rad], ascending from 0 to a turn, where the runs begin and end.
    at_ends : (k,) positions there [mm or rad].
    """

    motion: Motion
    ends: FloatArray
    at_ends: FloatArray

    @property
    def range(self) -> tuple[float, float]:
        """Smallest and largest position [mm or rad]."""
        return float(np.min(self.at_ends)), float(np.max(self.at_ends))

    def cuts(self, marks: tuple[float, ...]) -> FloatArray:
        """(n,) the ends, and the cam angles at which the motion is at one of `marks`; ascending."""
        found = [self.ends]
        for mark in marks:
            passes = np.flatnonzero(self._passes(mark))
            found.append(self._between(mark, passes))
        return merged(np.concatenate(found))

    def first_angle(self, position: float) -> float:
        """The first cam angle [rad] at which the motion is at `position`, or nearest to it."""
        nearest = int(np.argmin(np.abs(self.at_ends - position)))
        passes = np.flatnonzero(self._passes(position))[:1]
        there = self.ends[self.at_ends == position][:1]
        found = np.concatenate((there, self._between(position, passes)))
        return float(np.min(found)) if len(found) else float(self.ends[nearest])

    def _passes(self, mark: float) -> BoolArray:
        beyond = np.sign(self.at_ends - mark)
        return np.asarray(beyond[:-1] * beyond[1:] < 0.0)

    def _between(self, mark: float, places: IntArray) -> FloatArray:
        def beyond(phi: FloatArray) -> FloatArray:
            return np.asarray(self.motion.jet(phi)[0] - mark)

        return bracketed_roots(beyond, self.ends[places], self.ends[places + 1])


def monotone_runs(motion: Motion) -> MonotoneRuns:
    """`motion` cut where its formula changes and where it turns back."""
    ends = merged(np.array([0.0, *(end for _, end in pieces(motion)), *turning_angles(motion)]))
    return MonotoneRuns(motion, ends, np.asarray(motion.jet(ends)[0]))


def locked_at(linkage: Linkage, demanded: Motion) -> tuple[float, float] | None:
    """First cam angle [rad] and position [mm or rad] at which the follower cannot move the far end.

    There dx/dq of `Linkage.per_follower` is infinite: a mass or a load at the far end needs an
    infinite force of the follower. None if the motion `demanded` of the far end stays clear of all
    such positions.
    """
    runs = monotone_runs(demanded)
    found = linkage.locked_positions(*runs.range)
    return min(((runs.first_angle(each), each) for each in found), default=None)


def position_text(linkage: Linkage, position: float) -> str:
    """A position of the demanded motion [mm or rad], in words."""
    if linkage.unit == "mm":
        return f"stroke {position:.6g} mm"
    return f"{POSITIONS[linkage.member]} {math.degrees(position):.6g} deg"
