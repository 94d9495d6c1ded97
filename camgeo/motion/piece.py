"""The pieces of a motion plan: stretches of the turn with one formula, and how they are evaluated.

A plan may have thousands of pieces and is evaluated at a dozen cam angles or at thousands. Pieces
with equal formulas are evaluated in one call, each angle with the numbers of its piece; where there
are many more angles than pieces each piece has a call of its own, with nothing to look up.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from camgeo.motion.laws.law import Formula
from camgeo.motion.motion import Jet
from camgeo.numeric.arrays import FloatArray, IntArray, Side
from camgeo.units import TURN

if TYPE_CHECKING:  # only a motion by data needs splines
    from camgeo.motion.spline import Spline

BLOCK: Final = 8192
"""Angles evaluated at a time, so that intermediate results stay in the processor's cache."""

MANY: Final = 64
"""Mean number of angles per piece from which pieces are evaluated one by one."""

SNAP: Final = 4.0 * math.ulp(TURN)
"""Two cam angles [rad] closer than this are the same angle, rounded differently when converted from
degrees; the angle counts as the joint itself. A millionth of a degree is 5 million times wider."""

ULPS: Final = 2.0**-52 * 8.0
"""Rounding of the rate of a harmonic, as a fraction of it."""

COLUMNS: Final = 8
"""Numbers of a piece before those of its formula: start and end of the segment, one over its
length, origin, and the factors of the near value and the derivatives."""


@dataclass(frozen=True, slots=True)
class Piece:
    """A stretch of the turn with one formula; a dwell has none.

    s = origin + lift * (near value), with the near value f counted from the segment's start or
    g = 1 - f counted from its end.
    """

    start: float
    end: float
    origin: float
    lift: float = 0.0
    formula: Formula | None = None
    numbers: tuple[float, ...] = ()
    segment_start: float = 0.0
    segment_end: float = 1.0
    jerk_bound: float = 0.0
    from_end: bool = False
    spline: Spline | None = None
    harmonic: float = 0.0

    @property
    def rests(self) -> bool:
        """Whether nothing moves."""
        return self.formula is None

    @property
    def is_harmonic(self) -> bool:
        """Whether s''' = -s': the lift swings once a turn about a fixed middle."""
        return abs(self.harmonic - self.length) <= ULPS * self.length

    @property
    def length(self) -> float:
        """Cam angle of the whole segment [rad]."""
        return self.segment_end - self.segment_start

    @property
    def knots(self) -> FloatArray:
        """Cam angles [rad] inside the piece at which the polynomial of a spline changes."""
        if self.spline is None:
            return np.empty(0)
        inner = self.spline.knots[1:-1]
        angles: FloatArray = self.segment_start + inner * self.length
        return angles

    def spline_bounds(self, low: FloatArray, high: FloatArray) -> Jet:
        """(4, n) the result of `MotionPlan.jet_and_bounds` for cells of a piece with a spline."""
        assert self.spline is not None  # called for those only
        shares = [np.clip((a - self.segment_start) / self.length, 0.0, 1.0) for a in (low, high)]
        bounds = self.spline.cell_bounds(*shares)
        return bounds / self.length ** np.arange(4.0)[:, np.newaxis]


def spline_piece(spline: Spline, position: float, start: float, end: float) -> Piece:
    """The piece of a motion by data: `spline` over z in [0, 1], from `position`; a rest if it is
    constant.
    """
    if not np.any(spline.taylor[:, 1:]):
        return Piece(start, end, position + float(spline.taylor[0, 0]))

    def formula(z: FloatArray, _w: FloatArray, _: Any) -> FloatArray:
        return spline.values(np.clip(z, 0.0, 1.0))

    return Piece(
        start, end, position, 1.0, formula, (), start, end,
        jerk_bound=float(np.max(spline.bounds(3))), spline=spline,
    )  # fmt: skip


class Pieces:
    """The pieces of a turn as columns.

    Attributes
    ----------
    starts : (m,) cam angles [rad].
    jerk_limits : (m,) bounds of |s'''|.
    """

    def __init__(self, pieces: Sequence[Piece]) -> None:
        self.starts = np.array([piece.start for piece in pieces])
        start = np.array([piece.segment_start for piece in pieces])
        end = np.array([piece.segment_end for piece in pieces])
        lift, length = np.array([piece.lift for piece in pieces]), end - start
        near = np.where([piece.from_end for piece in pieces], -lift, lift)
        # Python's power and numpy's differ in the last bit.
        squares, cubes = (np.array([float(span) ** k for span in length]) for k in (2, 3))
        bounds = np.array([piece.jerk_bound for piece in pieces])
        self.jerk_limits = np.abs(lift) / cubes * bounds
        origin = np.array([piece.origin for piece in pieces])
        scale = (near, lift / length, lift / squares, lift / cubes)
        columns = np.stack((start, end, 1.0 / length, origin, *scale))
        self._formulas = [*dict.fromkeys(piece.formula for piece in pieces)]
        numbers = {formula: group for group, formula in enumerate(self._formulas)}
        self._group = np.array([numbers[piece.formula] for piece in pieces])
        self._row = np.empty(len(pieces), dtype=np.intp)
        self._tables = []
        for group in range(len(self._formulas)):
            own = np.flatnonzero(self._group == group)
            self._row[own] = np.arange(len(own))
            rest = np.array([pieces[place].numbers for place in own.tolist()]).T
            self._tables.append(np.concatenate((columns[:, own], rest)))

    def jet(self, phi: FloatArray, side: Side) -> Jet:
        """(4, n) lift and derivatives at `phi` (n,) in [0, 2 pi] [rad]."""
        out = np.empty((4, len(phi)))
        for first in range(0, len(phi), BLOCK):
            block = slice(first, first + BLOCK)
            here, there = phi[block], out[:, block]
            if len(here) > MANY * len(self.starts):
                for piece, places in self._parts(here, side):
                    group, row = int(self._group[piece]), int(self._row[piece])
                    self._write(group, row, here, there, places)
                continue
            pieces = self.at(here, side)
            groups, rows = self._group[pieces], self._row[pieces]
            for group in np.flatnonzero(np.bincount(groups)).tolist():
                places = np.flatnonzero(groups == group)
                self._write(group, rows[places], here, there, places)
        return out

    def at(self, phi: FloatArray, side: Side) -> IntArray:
        """(n,) the number of the piece in which each of `phi` (n,) lies."""
        nudge = SNAP if side == "right" else -SNAP
        return self.starts[1:].searchsorted(phi + nudge, side=side)

    def _parts(self, phi: FloatArray, side: Side) -> list[tuple[int, slice | IntArray]]:
        """Each piece in which some of `phi` (n,) lie, with their indices."""
        if not np.all(phi[1:] >= phi[:-1]):
            return [*places_of(self.at(phi, side))]
        nudge = SNAP if side == "right" else -SNAP
        inner = self.starts[1:] - nudge
        ends = np.searchsorted(phi, inner, side="left" if nudge > 0.0 else "right").tolist()
        found = enumerate(zip([0, *ends], [*ends, len(phi)], strict=True))
        return [(piece, slice(*bounds)) for piece, bounds in found if bounds[0] < bounds[1]]

    def _write(
        self,
        group: int,
        rows: int | IntArray,
        phi: FloatArray,
        out: Jet,
        places: slice | IntArray,
    ) -> None:
        """Write a formula's values to some places: of one piece, by its row, or of each its own."""
        numbers, formula = self._tables[group][:, rows], self._formulas[group]
        if formula is None:
            out[0, places], out[1:, places] = numbers[3], 0.0
            return
        phi, (start, end, rate) = phi[places], numbers[:3]
        values = formula((phi - start) * rate, (end - phi) * rate, numbers[COLUMNS:])
        target = out[:, places] if isinstance(places, slice) else values
        np.multiply(values, numbers[4:COLUMNS].reshape(4, -1), out=target)
        target[0] += numbers[3]
        if target is values:
            out[:, places] = values


def places_of(keys: IntArray) -> list[tuple[int, IntArray]]:
    """Each distinct one of `keys` (n,), ascending, with the indices at which it occurs."""
    order = np.argsort(keys, kind="stable")
    ends = np.flatnonzero(np.diff(keys[order])) + 1
    return [(int(keys[places[0]]), places) for places in np.split(order, ends) if len(places)]
