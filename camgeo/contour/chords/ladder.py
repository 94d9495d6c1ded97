"""How many straight pieces each bend of a stretch gets: one ladder for all tolerances.

The ladder is a property of the stretch. On its rungs stand numbers of pieces, laid out to deviate
alike whatever the tolerance; a tolerance takes the fewest pieces that keep it. So a looser one,
which has the choice of all of these and more, never takes more.
"""

from __future__ import annotations

import heapq
import math
from dataclasses import dataclass

import numpy as np

from camgeo.contour.chords.evened import EVEN, Bends, Evened, bends_of, evened
from camgeo.contour.chords.two_sided import Chords, Stretched
from camgeo.contour.counts import too_many
from camgeo.errors import ToleranceError
from camgeo.numeric.arrays import IntArray

MOST_TURN = 0.5
"""The curve beside a piece turns by at most this angle [rad], however small its sagitta: the proof
wants the two to run the same way."""

RUNGS = 1024
"""Rungs on which the number of pieces doubles: 0.07 % between two, less than a piece of 1000."""

FINEST = 60 * RUNGS
"""Last rung: there are more pieces than can be counted in double precision."""

SHORT = 12
"""Bends of fewer pieces may get single ones more than the formula gives them: it is one of limits,
and beside inflections close to each other it falls short."""

LAYOUTS = 250
"""Layouts tried at most; mostly the first or second will do."""


@dataclass(frozen=True, slots=True, eq=False)
class Ladder:
    """The numbers of pieces that may be laid along a stretch.

    Attributes
    ----------
    stretch : it.
    unit : [mm] deviation on rung 0, where the table counts one piece.
    """

    stretch: Stretched
    unit: float

    @classmethod
    def of(cls, stretch: Stretched) -> Ladder:
        """The ladder of a stretch; a straight one has its own length for a unit."""
        table = stretch.table
        whole = 0.25 * float(np.sum(table.bends))
        return cls(stretch, whole * whole or float(np.sum(table.steps)))

    def fewest(self, most: float, share: float, most_pieces: int) -> tuple[Chords, float]:
        """The fewest pieces of which the proof finds at most `most` [mm], and what it finds.

        Parameters
        ----------
        share : what the proof finds at most, as a share of the deviation of the layout.
        most_pieces : more are refused.

        Raises
        ------
        ToleranceError
            If so few pieces cannot keep the deviation, in double precision.
        """
        rung = max(math.ceil(0.5 * RUNGS * math.log2(share * self.unit / most)), -FINEST)
        reached = math.inf
        seen: set[bytes] = set()
        waiting: list[tuple[int, int, bytes, int, bool]] = []

        def wait(counts: IntArray, rung: int, *, plain: bool) -> None:
            key = counts.tobytes()
            if key not in seen:
                seen.add(key)
                heapq.heappush(waiting, (int(np.sum(counts)), -plain, key, rung, plain))

        wait(self._counts(rung), rung, plain=True)
        for _ in range(LAYOUTS):
            number, _, key, rung, plain = heapq.heappop(waiting)
            if number > most_pieces:
                raise too_many(most_pieces, "straight pieces", most)
            counts = np.frombuffer(key, dtype=np.intp)
            rung = self._last_rung(counts, rung)
            bends = self._bends(rung)
            aim = self._aim(rung) * bends.least(counts)
            laid = evened(self.stretch, aim, counts, MOST_TURN)
            chords = laid.chords
            found = math.hypot(share * float(np.max(chords.worst)), chords.gap)
            if np.max(chords.turns) <= MOST_TURN * EVEN:
                reached = min(reached, found)
                if found <= most:
                    return chords, found
            if plain and rung < FINEST:
                wait(self._counts(rung + 1), rung + 1, plain=True)
            for bend in _worst(laid, counts, aim):
                more = counts.copy()
                more[bend] += 1
                wait(more, rung, plain=False)
        raise ToleranceError("straight pieces cannot follow the curve", most, reached)

    def _aim(self, rung: int) -> float:
        return self.unit * math.exp2(-2.0 * rung / RUNGS)

    def _bends(self, rung: int) -> Bends:
        table = self.stretch.table
        shares = table.shares(self._aim(rung), MOST_TURN)
        return bends_of(self.stretch, shares, np.ones(len(table.inflections)))

    def _counts(self, rung: int) -> IntArray:
        """(b,) pieces for the bends on a rung; on no later one there are fewer."""
        counts = self._bends(rung).counts()
        return np.maximum(counts, 3) if self.stretch.closed and len(counts) == 1 else counts

    def _last_rung(self, counts: IntArray, rung: int) -> int:
        """The last rung on which no bend wants more than its `counts` (b,); one is `rung`."""
        low, step = rung, 1
        while low + step <= FINEST and np.all(self._counts(low + step) <= counts):
            low, step = low + step, 2 * step
        high = min(low + step, FINEST + 1)
        while high - low > 1:
            middle = (low + high) // 2
            low, high = (middle, high) if np.all(self._counts(middle) <= counts) else (low, middle)
        return low


def _worst(laid: Evened, counts: IntArray, aim: float) -> set[int]:
    """The short bends to which the piece belongs that is farthest off, one or two."""
    chords = laid.chords
    worst = int(np.argmax(np.maximum(chords.worst / aim, chords.turns / MOST_TURN)))
    bend = int(laid.bend[worst])
    beside = {bend, (bend + 1) % len(counts)} if laid.through[worst] else {bend}
    return {each for each in beside if counts[each] < SHORT}
