"""What other modules see of a motion: the lift over the cam angle, and where its formula changes.

A `Jet` is the lift and its first three derivatives with respect to the cam angle at n angles, an
array (4, n): s, s', s'', s''' in mm (rad for an oscillating follower) per rad^k.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Final, Literal, Protocol

import numpy as np

from camgeo.errors import GeometryError
from camgeo.numeric import checked
from camgeo.numeric.arrays import FloatArray, IntArray, Side
from camgeo.numeric.extremes import INSIDE, isolated_roots, isolation_places
from camgeo.units import TURN

Jet = FloatArray

FULL_ORDER = 3


@dataclass(frozen=True, slots=True)
class MergedDwell:
    """A rest over its full length; neighbouring rests at the same position are merged.

    Attributes
    ----------
    start : cam angle at which it begins [rad] in [0, 2 pi).
    span : its length [rad], in (0, 2 pi]; start + span may exceed 2 pi.
    """

    start: float
    span: float


class Motion(Protocol):
    """The follower's lift over one turn of the cam, periodic."""

    @property
    def breaks(self) -> FloatArray:
        """(m,) cam angles in [0, 2 pi) [rad], ascending, where s' to s''' may jump; nothing is
        fitted across one of them.
        """

    @property
    def borders(self) -> FloatArray:
        """(k,) the breaks and all other places where the formula changes."""

    @property
    def dwells(self) -> tuple[MergedDwell, ...]:
        """All rests."""

    def jet(self, phi: FloatArray, side: Side = "right", order: int = FULL_ORDER) -> Jet:
        """(order + 1, n) lift and derivatives at `phi` (n,) [rad], any number of turns.

        A motion may return more orders than requested, never fewer.
        """

    def jet_and_bounds(self, low: FloatArray, high: FloatArray) -> tuple[Jet, Jet]:
        """The lift (4, n) in the middle of the cells [low, high], and bounds over them.

        These are upper bounds (4, n) of |s - s(middle)|, |s'|, |s''|, |s'''|.

        `low`, `high` (n,) [rad] in [0, 2 pi]; no cell reaches across a border.
        """


# -- extremes -------------------------------------------------------------------------------------
# Smallest and largest lift of a motion, exactly.


def pieces(motion: Motion) -> list[tuple[float, float]]:
    """The stretches [start, end] of the turn [rad] between neighbouring borders."""
    starts = [float(border) for border in motion.borders]
    if not starts or starts[0] > 0.0:
        starts.insert(0, 0.0)
    return list(zip(starts, [*starts[1:], TURN], strict=True))


def lift_range(motion: Motion) -> tuple[float, float]:
    """Smallest and largest lift [mm or rad] over a turn."""
    places = (motion.borders, np.zeros(1), turning_angles(motion))
    lift = motion.jet(np.concatenate(places))[0]
    return float(np.min(lift)), float(np.max(lift))


def turning_angles(motion: Motion) -> FloatArray:
    """(k,) cam angles [rad] inside the pieces at which the velocity changes its sign."""
    starts, ends = np.array(pieces(motion)).T
    places = isolation_places(np.append(starts, TURN))

    def of_order(order: int) -> Callable[[FloatArray, IntArray], FloatArray]:
        return lambda phi, _: np.asarray(motion.jet(phi, "right", 1)[order])

    velocity = of_order(1)
    known = velocity(places.ravel(), np.empty(0, dtype=np.intp)).reshape(1, *places.shape)
    roots, _ = isolated_roots(velocity, of_order(0), places, known)
    # A law that comes to rest at the end of its piece may round to 0 at the outermost place, which
    # is no change of sign.
    piece = np.searchsorted(starts, roots) - 1
    margin = 4.0 * INSIDE * (ends - starts)[piece]
    return np.asarray(roots[(roots - starts[piece] > margin) & (ends[piece] - roots > margin)])


# -- boundary -------------------------------------------------------------------------------------
# Boundary values of a motion, as far as they are known, and the motion tasks that they make.


Boundary = tuple[float | None, float | None]
"""Velocity s' and acceleration s'' at a point; None where it is free."""

FREE: Final[Boundary] = (None, None)


def checked_boundaries(key: str, given: Any, least: int, most: int) -> dict[int, Boundary]:
    """The boundaries `given` by index of the point, checked; GeometryError unless all indices are
    from `least` to `most`.
    """
    return {
        checked.whole(key, index, least, most): checked_boundary(key, values)
        for index, values in checked.instance(key, given, Mapping, "boundaries by index").items()
    }


def checked_boundary(key: str, values: Any) -> Boundary:
    """`values` as a boundary; GeometryError unless they are two numbers, None for a free one."""
    if not isinstance(values, tuple | list) or len(values) != 2:
        raise GeometryError(
            "must be a velocity and an acceleration, None for a free one",
            key,
            checked.value_text(values),
        )
    return checked.optional(key, values[0]), checked.optional(key, values[1])


End = Literal["R", "G", "U", "B"]

ENDS: Final[tuple[End, ...]] = ("R", "G", "U", "B")

TASKS: Final[tuple[str, ...]] = tuple(f"{start}-{end}" for start in ENDS for end in ENDS)
"""All sixteen pairs, "R-R" to "B-B" (VDI 2143-1, Tafel 1)."""

NAMES: Final[dict[End, str]] = {
    "R": "rest",
    "G": "constant velocity",
    "U": "reversal",
    "B": "general motion",
}


def end_class(velocity: float, acceleration: float) -> End:
    """The class of an end with that velocity and acceleration, in any unit."""
    if velocity == 0.0:
        return "R" if acceleration == 0.0 else "U"
    return "G" if acceleration == 0.0 else "B"


def task_ends(task: str) -> tuple[str, str]:
    """The classes at the start and at the end of `task`, one of `TASKS`."""
    return task[0], task[-1]
