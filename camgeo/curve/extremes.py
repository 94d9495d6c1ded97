"""Extremes of a quantity over the turn, exactly: bracketed roots of its slope per smooth piece."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from camgeo.curve.pieces import HasBreaks, smooth_pieces
from camgeo.motion.motion import Side
from camgeo.numeric.arrays import FloatArray, frozen
from camgeo.numeric.roots import roots_on_grid
from camgeo.units import TURN

SAMPLES = 257
"""Grid points per smooth piece on which sign changes of a slope are looked for."""

INSIDE = 1e-8
"""How far inside a piece its ends are looked at, as a share of its length: far beyond the rounding
of a cam angle, and what lies between is as extreme at the end itself to this share squared."""

Quantity = Callable[[FloatArray, Side], FloatArray]


@dataclass(frozen=True, slots=True, eq=False)
class Extremes:
    """Values at all places where a quantity can be extreme.

    Attributes
    ----------
    phi : (k,) cam angles [rad], ascending over one turn from the first break on, which appears
        again as the last; a break appears twice in a row, for its two sides.
    values : (k,).
    """

    phi: FloatArray
    values: FloatArray

    def smallest(self) -> tuple[float, float]:
        """Smallest value and its cam angle [rad], the first of equals."""
        index = int(np.argmin(self.values))
        return float(self.values[index]), float(self.phi[index]) % TURN

    def largest(self) -> tuple[float, float]:
        """Largest value and its cam angle [rad], the first of equals."""
        index = int(np.argmax(self.values))
        return float(self.values[index]), float(self.phi[index]) % TURN


def extremes(curve: HasBreaks, value: Quantity, *slopes: Quantity) -> Extremes:
    """All local extremes of `value` over one turn.

    Parameters
    ----------
    curve : gives the smooth pieces.
    value : the quantity, (n,) at n cam angles, from the side asked for.
    slopes : functions whose zeros inside the pieces are the places to look at, besides the ends
        of the pieces from inside.
    """
    places: list[FloatArray] = []
    values: list[FloatArray] = []
    for piece in smooth_pieces(curve):
        start, end = np.array([piece.start]), np.array([piece.end])
        inner: list[FloatArray] = []
        if not piece.dwell:
            grid = np.linspace(piece.start, piece.end, SAMPLES)
            inside = INSIDE * (piece.end - piece.start)
            grid[[0, -1]] += (inside, -inside)  # from inside, where a slope may jump
            inner = [roots_on_grid(_right(slope), grid) for slope in slopes]
        middle = np.sort(np.concatenate([*inner, np.empty(0)]))
        places += [start, middle, end]
        values += [value(start, "right"), value(middle, "right"), value(end, "left")]
    return Extremes(
        frozen(np.concatenate(places), np.float64), frozen(np.concatenate(values), np.float64)
    )


def _right(quantity: Quantity) -> Callable[[FloatArray], FloatArray]:
    return lambda phi: quantity(phi, "right")
