"""The smooth pieces of a curve: the parts of the turn between neighbouring breaks."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

from camgeo.motion.motion import Dwell
from camgeo.numeric.arrays import FloatArray
from camgeo.units import TURN


class HasBreaks(Protocol):
    """Any function of the cam angle that knows its breaks and dwells."""

    @property
    def breaks(self) -> FloatArray: ...

    @property
    def dwells(self) -> tuple[Dwell, ...]: ...


@dataclass(frozen=True, slots=True)
class Piece:
    """A smooth piece over the cam angles [start, end] [rad]; end may exceed 2 pi, start may
    not.

    Its values are the right-hand ones at `start`, the left-hand ones at `end`.
    """

    start: float
    end: float
    dwell: bool


def smooth_pieces(curve: HasBreaks) -> tuple[Piece, ...]:
    """The smooth pieces of one turn, in order; the last may reach across cam angle 0."""
    breaks = [float(angle) for angle in curve.breaks]
    dwell_starts = {dwell.start for dwell in curve.dwells}
    if not breaks:
        return (Piece(0.0, TURN, dwell=bool(dwell_starts)),)
    ends = [*breaks[1:], breaks[0] + TURN]
    return tuple(
        Piece(start, end, dwell=start in dwell_starts)
        for start, end in zip(breaks, ends, strict=True)
    )
