"""Where the follower leaves its only flank."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from camgeo.numeric.extremes import Extreme


@dataclass(frozen=True, slots=True)
class Range:
    """A range of the turn, and the smallest value in it.

    Attributes
    ----------
    start, end : cam angles [rad] in [0, 2 pi]; the end is below the start if the range passes cam
        angle 0.
    lowest : the smallest value and its cam angle.
    """

    start: float
    end: float
    lowest: Extreme


@dataclass(frozen=True, slots=True)
class LostContact:
    """Where the follower leaves its only flank, at one speed of the cam.

    Attributes
    ----------
    ranges : in which the flank would have to pull, each with its lowest force [N].
    leaps : cam angles [rad] at which the velocity of a mass jumps away from the flank.
    """

    ranges: tuple[Range, ...] = ()
    leaps: tuple[float, ...] = ()

    def __bool__(self) -> bool:
        return bool(self.ranges or self.leaps)

    @property
    def lowest(self) -> Extreme | None:
        """The lowest force [N] of all ranges; None if there are only leaps."""
        return min((each.lowest for each in self.ranges), key=lambda low: low.value, default=None)
