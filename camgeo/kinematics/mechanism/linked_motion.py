"""A linkage ahead of the follower: a motion derived from another by the chain rule."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, field
from decimal import ROUND_CEILING, ROUND_FLOOR, Context
from itertools import pairwise
from typing import TYPE_CHECKING, Final

import numpy as np

from camgeo.errors import GeometryError
from camgeo.kinematics.mechanism.linkage import BACK, OUT, POSITIONS, Linkage, Size, monotone_runs
from camgeo.kinematics.mechanism.triangle import ROUNDING
from camgeo.kinematics.mechanism.values import able
from camgeo.kinematics.motion import FULL_ORDER, Dwell, Jet, Motion, lift_range
from camgeo.numeric.arrays import FloatArray, Side, read_only
from camgeo.numeric.kept import Answers, Kept, kept_with_owner
from camgeo.record import Pickled
from camgeo.units import TURN, counted

if TYPE_CHECKING:
    from camgeo.kinematics.plan import MotionPlan


@dataclass(frozen=True, slots=True)
class LinkedMotion(Pickled):
    """The follower's motion, given the motion demanded of the far end of its linkage.

    Attributes
    ----------
    demanded : the motion of the linkage's far end [mm or rad, see `Linkage.unit`].
    linkage : turns it into the follower's own motion: a rocker's angle [rad], counter-clockwise
        positive, or a stroke [mm].
    kept : the last result of each function of the motion, see `kept_with_owner`.

    Raises
    ------
    GeometryError
        With key "motion" or "linkage", if the value is no such thing; with "linkage" also if the
        linkage fails to close somewhere in the turn, with each range of cam angles, the missing
        length, and what would close it.
    """

    demanded: Motion
    linkage: Linkage
    _jets: Answers[Jet] = field(default_factory=Answers, init=False, repr=False, compare=False)
    _bounds: Answers[tuple[Jet, Jet]] = field(
        default_factory=Answers, init=False, repr=False, compare=False
    )
    kept: Kept = field(default_factory=dict, init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        able("motion", self.demanded, "jet_and_bounds", "a motion over the cam angle")
        able("linkage", self.linkage, "transform_bounds", "a linkage")
        _, gap = self.tightest()
        if gap <= ROUNDING * (self.linkage.crank + self.linkage.coupler):
            return

        raise GeometryError(why_open(self.linkage, self.demanded), key="linkage")

    def tightest(self, within: tuple[float, float] | None = None) -> tuple[float, float]:
        """The position [mm or rad] nearest to a dead centre, or farthest beyond it, and the missing
        length there [mm], negative if there is some to spare.

        `within` is the range of the demanded motion, if it is already known.
        """
        low, high = lift_range(self.demanded) if within is None else within
        positions = np.array([low, high, *self.linkage.turning_positions(low, high)])
        missing = self.linkage.missing_length(positions)
        worst = int(np.argmax(missing))
        return float(positions[worst]), float(missing[worst])

    @property
    def breaks(self) -> FloatArray:
        """See `Motion`."""
        return self.demanded.breaks

    @property
    def borders(self) -> FloatArray:
        """See `Motion`."""
        return self.demanded.borders

    @property
    def dwells(self) -> tuple[Dwell, ...]:
        """See `Motion`."""
        return self.demanded.dwells

    def jet(self, phi: FloatArray, side: Side = "right", order: int = FULL_ORDER) -> Jet:
        """(order + 1, n) follower's motion and derivatives, see `Motion.jet`.

        Read-only, and the same array for recent requests, like those of a plan.
        """
        phi = np.array(phi, dtype=np.float64, ndmin=1)  # a copy of our own

        def made() -> Jet:
            return read_only(self.linkage.transform(self.demanded.jet(phi, side, order), order))

        return self._jets.recall(made, (side, order), phi)

    def jet_and_bounds(self, low: FloatArray, high: FloatArray) -> tuple[Jet, Jet]:
        """See `Motion.jet_and_bounds`; recalled as `jet` is."""

        def made() -> tuple[Jet, Jet]:
            middle, bounds = self.demanded.jet_and_bounds(low, high)
            jet = self.linkage.transform(middle, FULL_ORDER)
            return read_only(jet), read_only(self.linkage.transform_bounds(middle, bounds))

        return self._bounds.recall(made, None, low, high)


@kept_with_owner
def linked(plan: MotionPlan, linkage: Linkage) -> LinkedMotion:
    """The follower's motion for a `plan` of the far end of `linkage`; GeometryError if it does not
    close.
    """
    return LinkedMotion(plan, linkage)


# -- closing --------------------------------------------------------------------------------------
# Exactly where a linkage does not close, and what would close it.


SIZES: Final[tuple[Size, ...]] = ("coupler", "crank")

DIGITS: Final = 6
"""Significant digits of the numbers in a cure, rounded to the side on which the linkage closes."""

FARTHEST: Final = 1e6
"""A length this many times that of crank and coupler counts as infinite, its reciprocal as 0."""

MOST_LISTED: Final = 4
"""Most ranges of cam angles that a message lists."""

AT_START: Final = 1e-7
"""A dead centre this close to position 0, as a fraction of a turn or of crank and coupler, is at 0:
where it is also a turning position, only half its digits are known."""


@dataclass(frozen=True, slots=True)
class Opening:
    """A range of cam angles in which the linkage does not close.

    Attributes
    ----------
    start, end : its first and last cam angle [rad].
    missing : the largest missing length in it [mm].
    place : the cam angle at which it is that large [rad].
    """

    start: float
    end: float
    missing: float
    place: float


def openings(linkage: Linkage, motion: Motion) -> tuple[Opening, ...]:
    """The ranges of cam angles in which `linkage` does not close, by ascending cam angle.

    Empty if it closes everywhere. The turn is cut where the motion reverses, where the missing
    length is 0 and where it may have an extreme: between two cuts it keeps its sign.
    """
    runs = monotone_runs(motion)
    low, high = runs.range
    marks = (*linkage.dead_positions(low, high), *linkage.turning_positions(low, high))
    cuts = runs.cuts(marks)
    places = np.empty(2 * len(cuts) - 1)
    places[::2], places[1::2] = cuts, 0.5 * (cuts[:-1] + cuts[1:])
    missing = linkage.missing_length(motion.jet(places)[0])
    open_at = missing > ROUNDING * (linkage.crank + linkage.coupler)
    edges = np.flatnonzero(np.diff(np.concatenate(([False], open_at, [False]))))
    found = []
    for first, after in edges.reshape(-1, 2):
        worst = int(first + np.argmax(missing[first:after]))
        # Cuts have even indices: a range open in a middle reaches to the cuts on either side.
        start, end = places[first - first % 2], places[after - 1 + (after - 1) % 2]
        found.append(Opening(float(start), float(end), float(missing[worst]), float(places[worst])))
    if not found:  # narrower than the rounding of the cam angle
        worst = int(np.argmax(missing))
        if missing[worst] > 0.0:
            place = float(places[worst])
            found.append(Opening(place, place, float(missing[worst]), place))
    return tuple(found)


def clear_range(linkage: Linkage, way: int = BACK) -> tuple[float, float]:
    """The range of positions [mm or rad] about 0 without a dead centre; infinite if there is none.

    Where position 0 is a dead centre itself, the range on the side on which the linkage closes.
    With `way` `OUT` it is free of positions in which the far end cannot be driven, too.
    """
    scale = linkage.crank + linkage.coupler
    far, about = (math.inf, scale) if linkage.unit == "mm" else (TURN, math.pi)
    marks = linkage.dead_positions(-far, far)
    if way == OUT:
        marks += linkage.locked_positions(-far, far)
    near = AT_START * about
    low = max((mark for mark in marks if mark < -near), default=-math.inf)
    high = min((mark for mark in marks if mark > near), default=math.inf)
    if any(abs(mark) <= near for mark in marks):
        halfway = np.array([max(low, -about), min(high, about)]) / 2.0
        closes = linkage.missing_length(halfway) <= 0.0
        low, high = (low if closes[0] else 0.0), (high if closes[1] else 0.0)
    return low, high


def closing_sizes(
    linkage: Linkage, size: Size, low: float, high: float
) -> tuple[float, float] | None:
    """Smallest and largest length [mm] of that member with which the linkage closes.

    At all positions from `low` to `high`, everything else unchanged; of several ranges of lengths
    the one nearest to the present length. 0 and infinity where nothing bounds it; None if there is
    no such length, or none is known.
    """
    all_limits = linkage.size_limits(size, low, high)
    if not all_limits:
        return None
    scale = linkage.crank + linkage.coupler
    least, most = scale / FARTHEST, scale * FARTHEST
    limits = sorted(limit for limit in all_limits if least < limit < most)
    found: list[tuple[float, float]] = []
    for start, end in pairwise((0.0, *limits, math.inf)):
        middle = 0.5 * (start + end) if math.isfinite(end) else 2.0 * max(start, scale)
        if start == end or not _closes(linkage, size, middle, low, high):
            continue
        if found and found[-1][1] == start:
            start = found.pop()[0]
        found.append((start, end))
    present = linkage.coupler if size == "coupler" else linkage.crank
    return min(found, key=lambda each: max(each[0] - present, present - each[1]), default=None)


def why_open(linkage: Linkage, motion: Motion) -> str:
    """Where `linkage`, which does not close throughout `motion`, is open; what would close it."""
    found = openings(linkage, motion)
    gaps = [
        f"{math.degrees(each.start):.10g} and {math.degrees(each.end):.10g}"
        for each in found[:MOST_LISTED]
    ]
    left = len(found) - MOST_LISTED
    more = f" and in {counted(left, 'more range')}" if left > 0 else ""
    missing = max(each.missing for each in found)
    low, high = lift_range(motion)
    cures = [*_size_texts(linkage, low, high), *kept_between(linkage)]
    cured = f"; it closes {_listed(cures)}" if cures else ""
    return (
        f"the linkage does not close between cam angles {' and between '.join(gaps)} degrees{more}:"
        f" it misses by up to {missing:.6g} mm{cured}"
    )


def kept_between(linkage: Linkage, way: int = BACK) -> list[str]:
    """In words, the `clear_range` of positions of `linkage`.

    Empty if all positions do, or if the range is too narrow to be printed.
    """
    low, high = clear_range(linkage, way)
    scale, unit = (1.0, "mm") if linkage.unit == "mm" else (math.degrees(1.0), "degrees")
    least, most = printed(scale * low, ROUND_CEILING), printed(scale * high, ROUND_FLOOR)
    what = f"with the {POSITIONS[linkage.member]} kept"
    if (math.isinf(low) and math.isinf(high)) or least == most:
        return []
    if math.isinf(low):
        return [f"{what} below {most} {unit}"]
    if math.isinf(high):
        return [f"{what} above {least} {unit}"]
    return [f"{what} between {least} and {most} {unit}"]


def printed(value: float, rounding: str) -> str:
    """`value` to a few digits, rounded up (`ROUND_CEILING`) or down (`ROUND_FLOOR`)."""
    return f"{Context(prec=DIGITS, rounding=rounding).create_decimal(value).normalize():f}"


def _size_texts(linkage: Linkage, low: float, high: float) -> Iterator[str]:
    for size in SIZES:
        found = closing_sizes(linkage, size, low, high)
        if found is None:
            continue
        least, most = printed(found[0], ROUND_CEILING), printed(found[1], ROUND_FLOOR)
        if math.isinf(found[1]):
            yield f"with a {size} of at least {least} mm"
        elif found[0] == 0.0:
            yield f"with a {size} of at most {most} mm"
        elif float(least) <= float(most):
            yield f"with a {size} of {least} to {most} mm"


def _closes(linkage: Linkage, size: Size, length: float, low: float, high: float) -> bool:
    try:
        other = linkage.resized(size, length)
    except GeometryError:
        return False
    positions = np.array([low, high, *other.turning_positions(low, high)])
    return bool(np.all(other.missing_length(positions) <= 0.0))


def _listed(words: list[str]) -> str:
    return ", ".join(words[:-1]) + (", or " if len(words) > 1 else "") + words[-1]
