"""The number of parts that a smooth piece needs: the least count that passes a trial.

Counts never grow when the tolerance is loosened: a trial depends only on its count, the search
ascends through counts that are the same for every tolerance, and its first count does not grow with
the tolerance either.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import TypeVar

import numpy as np

from camgeo.errors import ToleranceError
from camgeo.numeric.arrays import FloatArray

Made = TypeVar("Made")

FINE = 200
"""Up to this many parts each count is tried; above, counts grow by this fraction."""

TOGETHER = 64
"""Parts that are tried at once for one piece: the overhead of a call is that of some hundred
points."""

FAR = 0.8
"""Fraction of the expected increase to skip where the distance found is more than twice the aim."""


STUCK_AFTER, STUCK = 4.0, 0.9
"""Where so many times as many parts, beyond `FINE`, do not reduce the distance below this fraction,
their length is not to blame, because every stretch of a piece gets its share of them: the cam
angles of a step, or the points of a cusp, cannot be told apart."""


Make = Callable[[Sequence[tuple[int, int]]], Sequence[tuple[Made, float]]]
"""[(number of the piece, count), ...] -> the result for each and its largest distance [mm] found,
by any rule that depends only on the count."""


def least_counts(
    make: Make[Made],
    expected: FloatArray,
    aim: float,
    tolerance: float,
    *,
    order: float,
    most: int,
    together: int = TOGETHER,
) -> list[Made]:
    """The results of the least sufficient count for each of n pieces, which share their calls.

    Parameters
    ----------
    expected : (n,) the asymptotic count of each for small tolerances, a real number; the search
        begins there.
    order : power of the count with which the distance decreases.
    most : largest number of parts per piece.
    together : parts that are tried at once for one piece, unless a single count has more.

    Raises
    ------
    ToleranceError
        If no count comes within `aim` [mm].
    """
    counts = [ladder(float(value)) for value in expected]
    marks = [UNTRIED] * len(counts)
    done: dict[int, Made] = {}
    while len(done) < len(counts):
        wanted = []
        for piece, count in enumerate(counts):
            tried = 0
            while piece not in done and (not tried or tried + count <= together):
                wanted.append((piece, count))
                tried += count
                count = above(count)
        for (piece, count), (made, distance) in zip(wanted, make(wanted), strict=True):
            if piece in done:
                continue
            if distance <= aim:
                done[piece] = made
                continue
            counts[piece] = above(count)
            if not distance <= 2.0 * aim:
                share = (distance / aim) ** (1.0 / order) if aim > 0.0 else np.inf
                counts[piece] = max(counts[piece], ladder(FAR * min(share, 4.0) * count))
            marks[piece] = marked(marks[piece], count, distance)
            if is_stuck(marks[piece], count) or counts[piece] > most:
                raise stuck_at(distance, tolerance)
    return [done[piece] for piece in range(len(counts))]


Mark = tuple[int, float]
"""A number of parts that reduced the distance, and that distance [mm]."""

UNTRIED: Mark = (1, math.inf)


def marked(mark: Mark, count: int, distance: float) -> Mark:
    """The last number of parts that reduced the distance, after another one than `mark`'s."""
    return (count, distance) if distance <= STUCK * mark[1] else mark


def is_stuck(mark: Mark, count: int) -> bool:
    """Whether more parts than `count` are no use, if `mark` was the last of use, see `STUCK`."""
    return count >= STUCK_AFTER * max(mark[0], FINE)


def stuck_at(distance: float, tolerance: float) -> ToleranceError:
    """The error that no number of parts comes within `tolerance` [mm], but to `distance` [mm]."""
    reached = distance if math.isfinite(distance) else math.inf
    return ToleranceError("the pieces of the contour cannot follow the curve", tolerance, reached)


def too_many(most: int, what: str, tolerance: float) -> ToleranceError:
    """The error that `tolerance` [mm] needs more than `most` pieces, which are called `what`."""
    return ToleranceError(f"more than {most:,} {what} would be needed", tolerance, math.inf)


def above(count: int) -> int:
    """The next count to try after `count`."""
    return count + 1 + count // FINE


def ladder(value: float) -> int:
    """The least count on the list of trials that is not below `value`."""
    count = 1
    while count < value:
        count = above(count)
    return count
