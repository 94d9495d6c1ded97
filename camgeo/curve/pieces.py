"""The smooth pieces of a curve: the parts of the turn between neighbouring breaks."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from camgeo.curve.pitch_curve import PitchCurve
from camgeo.curve.together import curves_together
from camgeo.errors import GeometryError
from camgeo.motion.kept import kept_with_each, kept_with_owner
from camgeo.motion.motion import Dwell
from camgeo.numeric.arrays import BoolArray, ComplexArray, FloatArray, ascending, read_only
from camgeo.units import TURN


class HasBreaks(Protocol):
    """Any function of the cam angle that knows its breaks and dwells."""

    @property
    def breaks(self) -> FloatArray: ...

    @property
    def dwells(self) -> tuple[Dwell, ...]: ...


class HasBorders(HasBreaks, Protocol):
    """One that also knows where its formula changes, the breaks among them."""

    @property
    def borders(self) -> FloatArray: ...


@dataclass(frozen=True, slots=True)
class Piece:
    """A smooth piece over the cam angles [start, end] [rad]; end may exceed 2 pi, start may
    not.

    Its values are the right-hand ones at `start`, the left-hand ones at `end`. `centre` is the
    point [mm] about which it turns rigidly with the cam, the cam axis in a dwell; else None.
    """

    start: float
    end: float
    centre: complex | None = None

    @property
    def is_arc(self) -> bool:
        """Whether it is one arc."""
        return self.centre is not None

    @property
    def dwell(self) -> bool:
        """Whether it is an arc about the cam axis."""
        return self.centre == 0.0


def smooth_pieces(curve: HasBreaks) -> tuple[Piece, ...]:
    """The smooth pieces of one turn, in order; the last may reach across cam angle 0."""
    breaks = [float(angle) for angle in curve.breaks]
    dwell_starts = {dwell.start for dwell in curve.dwells}
    if not breaks:
        return (Piece(0.0, TURN, 0j if dwell_starts else None),)
    ends = [*breaks[1:], breaks[0] + TURN]
    return tuple(
        Piece(start, end, 0j if start in dwell_starts else None)
        for start, end in zip(breaks, ends, strict=True)
    )


WIDEST = np.pi / 32.0
"""Longest cell [rad]."""

MOST = 1_000_000
"""Most cells halved at once; a curve needs some hundred, plus one per segment of its motion."""


@kept_with_owner
def turn_cells(pitch: PitchCurve) -> tuple[FloatArray, FloatArray]:
    """Ends (n,), (n,) [rad] of cells that fill [0, 2 pi], none across a border."""
    grid = np.linspace(0.0, TURN, int(np.ceil(TURN / WIDEST)) + 1)
    ends = read_only(ascending(np.concatenate((grid, pitch.borders))))
    return ends[:-1], ends[1:]


@kept_with_each
def turn_enclosed(pitches: Sequence[PitchCurve]) -> list[tuple[ComplexArray, FloatArray]]:
    """`PitchCurve.jet_and_bounds` of the cells of the turn, of curves for `curves_together`."""
    low, high = turn_cells(pitches[0])
    found = []
    for curve, times in curves_together(pitches).blocks(len(low)):
        enclosed = curve.jet_and_bounds(np.tile(low, times), np.tile(high, times))
        for one in range(times):
            own = slice(one * len(low), (one + 1) * len(low))
            jet, bounds = enclosed[0][:, own].copy(), enclosed[1][:, own].copy()
            found.append((read_only(jet), read_only(bounds)))
    return found


def halves(low: FloatArray, high: FloatArray, which: BoolArray) -> tuple[FloatArray, FloatArray]:
    """Ends (2 k,), (2 k,) of the halves of the cells [low, high] (n,) [rad] selected by `which`.

    GeometryError if those are more than `MOST`.
    """
    low, high = low[which], high[which]
    if len(low) > MOST:
        place = math.degrees(low[0] % TURN)
        raise GeometryError(
            f"about cam angle {place:.6f} deg the pitch curve is too steep, or meets a limit too"
            f" exactly along a stretch, for {MOST:,} cells to decide what is left of the disc"
        )
    middle = 0.5 * (low + high)
    return np.concatenate((low, middle)), np.concatenate((middle, high))


def slowest(pitch: PitchCurve) -> float:
    """A lower bound of |Z'| [mm/rad] over the turn; negative where the cells are too wide to tell.

    |Z'| changes over half a cell of width 2 h by at most h |Z''| + h^2/2 max |Z'''|.
    """
    low, high = turn_cells(pitch)
    half = 0.5 * (high - low)
    jet, (_, _, third) = turn_enclosed(pitch)
    return float(np.min(np.abs(jet[1]) - half * (np.abs(jet[2]) + 0.5 * half * third)))
