"""The play of a follower between the two sides that hold it, and where they squeeze it.

On each side the contact bounds the follower's coordinate q. With n the outward normal of the disc
and L = n . dW/dq, a side of an inner flank lets q only grow where L > 0, and only fall where L < 0;
an outer flank the other way round. Where the sides deviate by dq_1 and dq_2, the follower can move
by

    play = play_0 - (e_1 dq_1 + e_2 dq_2), e = +1 where the side holds it from below, or -1,

play_0 that of the nominal machine: 0 between two discs, the breadth of a yoke less the width of its
cam. Where it is negative, the sides squeeze the follower by as much: something must give way.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Final

import numpy as np

from camgeo.numeric.arrays import FloatArray, merged
from camgeo.numeric.extremes import Extreme
from camgeo.tolerancing.freedoms import Deviations, Way
from camgeo.tolerancing.linear import Linear
from camgeo.tolerancing.replay import replayed
from camgeo.tolerancing.sensitivity import Sensitivities
from camgeo.tolerancing.sources import Source

ROUNDING: Final = 1e-12
"""Of 1 mm at the base circle: where both sides differ by less, they do the same."""


@dataclass(frozen=True, eq=False)
class Play(Linear):
    """The linear analysis of the play [mm or rad of the follower], in place of the position's.

    It is of a machine whose follower two sides hold, and does not depend on how it is set.
    """

    @cached_property
    def _sides(self) -> tuple[Sensitivities, Sensitivities]:
        assert self.stated.second is not None
        machines = (self.stated.machine, self.stated.second)
        first, second = (Sensitivities(each, self.angles) for each in machines)
        return first, second

    @cached_property
    def _from_below(self) -> tuple[FloatArray, FloatArray]:
        """(n,) e of each side."""
        first, second = (
            -each.machine.flank.sign * np.sign(each.nominal.leverage) for each in self._sides
        )
        return first, second

    @property
    def at_rest(self) -> FloatArray:
        """(n,) play of the nominal machine."""
        cam = self.stated.machine.cam
        if cam.breadth is None:
            return np.zeros(len(self.angles))
        return cam.yoke_breadth - cam.breadth.width(self.angles)

    def sensitivity(self, source: Source) -> FloatArray:
        """(units, n) play per unit; the base radius moves the zero of the lift, and no side."""
        rows = np.zeros((len(source.units), len(self.angles)))
        for row, unit in zip(rows, source.units, strict=True):
            if unit.freedom.way is not Way.SETTING:
                parts = [side.of_follower(unit) for side in self._sides]
                row -= np.sum(np.multiply(self._from_below, parts), axis=0)
        follower = self.stated.machine.cam.follower
        rows[np.abs(rows) <= ROUNDING * follower.lift_scale / follower.base_radius] = 0.0
        return rows

    @cached_property
    def _edges(self) -> FloatArray:
        """As of the position, with those of the width of a yoke's cam."""
        breadth = self.stated.machine.cam.breadth
        edges = self.stated.machine.cam.drive.smooth_angles
        return edges if breadth is None else merged(np.concatenate((edges, breadth.borders)))

    @property
    def least(self) -> Extreme:
        """The least play, mean less three standard deviations, over the turn."""
        return self._extremes(lambda each: each.band[0]).lowest

    @property
    def most(self) -> Extreme:
        """The largest play, mean and three standard deviations, over the turn."""
        return self._extremes(lambda each: each.band[1]).highest

    def errors(self, deviations: Deviations) -> FloatArray:
        """(m, n) by which the play of machines is off, by the exact motion on each side."""
        off = np.zeros((deviations.count, len(self.angles)))
        for side, sign in zip(self._sides, self._from_below, strict=True):
            found = replayed(side, deviations)
            off -= sign * (found.follower[0] + found.zero - side.lifts[0])
        return off
