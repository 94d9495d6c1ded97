"""The interface of a motion to the later stages: lift over the cam angle, and its borders.

A `Jet` is the lift and its first three derivatives with respect to the cam angle at n angles, an
array (4, n): s, s', s'', s''' in mm (rad for an oscillating follower) per rad^k.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

from camgeo.numeric.arrays import FloatArray, Side

Jet = FloatArray

FULL_ORDER = 3


@dataclass(frozen=True, slots=True)
class Dwell:
    """A rest over its full length; neighbouring rests at the same position are merged.

    Attributes
    ----------
    start : cam angle at which it begins [rad] in [0, 2 pi).
    span : its length [rad], in (0, 2 pi]; start + span may exceed 2 pi.
    """

    start: float
    span: float


class Motion(Protocol):
    """The follower's lift over one turn of the cam, periodic.

    Attributes
    ----------
    breaks : (m,) cam angles in [0, 2 pi) [rad], ascending, where s' to s''' may jump; nothing is
        fitted across one of them.
    borders : (k,) the breaks and all other places where the formula changes.
    dwells : all rests.
    """

    @property
    def breaks(self) -> FloatArray: ...

    @property
    def borders(self) -> FloatArray: ...

    @property
    def dwells(self) -> tuple[Dwell, ...]: ...

    def jet(self, phi: FloatArray, side: Side = "right", order: int = FULL_ORDER) -> Jet:
        """(order + 1, n) lift and derivatives at `phi` (n,) [rad], any number of turns.

        A motion may return more orders than it is asked for, never fewer.
        """

    def jet_and_bounds(self, low: FloatArray, high: FloatArray) -> tuple[Jet, Jet]:
        """The lift (4, n) in the middle of the cells [low, high], and bounds over them.

        These are upper bounds (4, n) of |s - s(middle)|, |s'|, |s''|, |s'''|.

        `low`, `high` (n,) [rad] in [0, 2 pi]; no cell reaches across a border.
        """
