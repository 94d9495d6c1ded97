"""Number of straight pieces for each bend of a stretch: one ladder for all tolerances.

The ladder is a property of the stretch. Its rungs are numbers of pieces, placed for equal
deviations whatever the tolerance; a tolerance takes the fewest pieces that meet it. So a looser
one, which can choose among all of these and more, never takes more.
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
"""The curve turns by at most this angle [rad] along a piece, however small its sagitta: the proof
needs both to run the same way."""

RUNGS = 1024
"""Rungs on which the number of pieces doubles: 0.07 % between two, less than a piece of 1000."""

FINEST = 60 * RUNGS
"""Last rung: beyond it there are more pieces than double precision can count."""

SHORT = 12
"""Bends of fewer pieces may get single pieces more than by the formula: it is asymptotic, and gives
too few between inflections close to each other."""

LAYOUTS, LAID = 250, 250_000
"""Most layouts tried, and most pieces in all of them; usually the first or second suffices."""


@dataclass(frozen=True, slots=True, eq=False)
class Ladder:
    """The possible numbers of pieces along a stretch.

    Attributes
    ----------
    stretch : of the pieces.
    unit : [mm] deviation on rung 0, where the table counts one piece.
    """

    stretch: Stretched
    unit: float

    @classmethod
    def of(cls, stretch: Stretched) -> Ladder:
        """The ladder of a stretch; the unit of a straight one is its own length."""
        table = stretch.table
        whole = 0.25 * float(np.sum(table.bends))
        return cls(stretch, whole * whole or float(np.sum(table.steps)))

    def fewest(self, most: float, share: float, most_pieces: int) -> tuple[Chords, float]:
        """The fewest pieces whose proved deviation is at most `most` [mm], and that deviation.

        Parameters
        ----------
        share : upper bound of the proved deviation, as a multiple of the deviation of the layout.
        most_pieces : largest number of pieces.

        Raises
        ------
        ToleranceError
            If no such number of pieces can meet the deviation in double precision.
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
        pieces = 0
        for _ in range(LAYOUTS):
            if pieces > LAID:
                break
            number, _, key, rung, plain = heapq.heappop(waiting)
            pieces += number
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
        """(b,) pieces for the bends on a rung; no later rung has fewer."""
        counts = self._bends(rung).counts()
        return np.maximum(counts, 3) if self.stretch.closed and len(counts) == 1 else counts

    def _last_rung(self, counts: IntArray, rung: int) -> int:
        """The last rung on which no bend needs more than its `counts` (b,); `rung` is one such."""
        low, step = rung, 1
        while low + step <= FINEST and np.all(self._counts(low + step) <= counts):
            low, step = low + step, 2 * step
        high = min(low + step, FINEST + 1)
        while high - low > 1:
            middle = (low + high) // 2
            low, high = (middle, high) if np.all(self._counts(middle) <= counts) else (low, middle)
        return low


def _worst(laid: Evened, counts: IntArray, aim: float) -> set[int]:
    """The one or two short bends of the piece with the largest deviation."""
    chords = laid.chords
    worst = int(np.argmax(np.maximum(chords.worst / aim, chords.turns / MOST_TURN)))
    bend = int(laid.bend[worst])
    bends = {bend, (bend + 1) % len(counts)} if laid.through[worst] else {bend}
    return {each for each in bends if counts[each] < SHORT}
