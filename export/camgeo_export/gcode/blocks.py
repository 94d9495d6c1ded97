"""Printed numbers, and the shares of the tolerance that they and the controller take."""

from __future__ import annotations

import math
from dataclasses import dataclass

from camgeo.errors import ToleranceError
from camgeo.toolpath.machine import ROUNDING_SHARE, ROUNDING_UNITS, Machine
from camgeo.units import MM_PER, LengthUnit

FEED_DECIMALS = 4
"""Decimals of a number that no profile limits, trailing zeros dropped."""


@dataclass(frozen=True, slots=True)
class Grid:
    """Printed coordinates: whole multiples of the last decimal.

    Attributes
    ----------
    decimals : printed.
    mm_per_unit : of the program's unit of length.
    """

    decimals: int
    mm_per_unit: float

    @property
    def _scale(self) -> int:
        scale: int = 10**self.decimals
        return scale

    def steps(self, length: float) -> int:
        """`length` [mm] in units of the last decimal, rounded."""
        return round(length / self.mm_per_unit * self._scale)

    def mm(self, steps: int) -> float:
        """What a reader makes of the printed number [mm]."""
        return steps / self._scale * self.mm_per_unit

    def text(self, steps: int, *, signed: bool = False) -> str:
        """The printed number; zero has no minus, and a plus only if `signed`."""
        whole, part = divmod(abs(steps), self._scale)
        sign = "-" if steps < 0 else "+" if signed else ""
        return f"{sign}{whole}.{part:0{self.decimals}d}"


def number(value: float, decimals: int = FEED_DECIMALS) -> str:
    """A feed or a speed with as many digits as it has, but at most `decimals` behind the point."""
    return f"{value:.{decimals}f}".rstrip("0").rstrip(".")


CHORD_SHARE = 0.05
"""Share of the tolerance for arcs that are written as chords: nearly straight ones, and those whose
radius the machine does not accept."""

PROOF_SHARE = 0.05
"""Share of the tolerance left for the slack of the bound by which the program is measured."""

LEAST_FIT = 0.1
"""Least share of the tolerance left for the fit where numbers are coarse."""

SLACK = 1e-6
"""Of shares: messages name a tolerance with six digits."""

LINE_SHARE = 0.3
"""Share of the tolerance for chords on a machine that gets lines alone."""

TRUSTED_SHARE = 0.5
"""A controller whose own arcs take more of the tolerance than this gets lines instead of them."""


@dataclass(frozen=True, slots=True)
class Budget:
    """Shares of the tolerance; all lengths in mm.

    Attributes
    ----------
    tolerance : the whole.
    decimals : of the printed coordinates, in the program's unit.
    rounding : largest deviation by printing with these decimals.
    chord : largest sagitta of an arc written as chords.
    blending : the P of path blending, 0 for the exact path.
    fit : what is left for the cutter path's lines and arcs.
    interpolation : how far the controller's own path departs from an arc.
    arcs : whether arcs are written as such, if the machine takes them; else as chords.
    """

    tolerance: float
    decimals: int
    rounding: float
    chord: float
    blending: float
    fit: float
    interpolation: float = 0.0
    arcs: bool = True


def budget(machine: Machine, unit: LengthUnit, tolerance: float) -> Budget:
    """The shares of `tolerance` [mm] on `machine`."""
    decimals = machine.decimals(unit, tolerance)
    step = 10.0**-decimals
    rounding = ROUNDING_UNITS * step * MM_PER[unit]
    interpolation = machine.arcs.interpolation
    arcs = interpolation <= TRUSTED_SHARE * tolerance
    if not arcs:
        interpolation = 0.0
    chord = (CHORD_SHARE if arcs else LINE_SHARE) * tolerance
    left = tolerance * (1.0 - PROOF_SHARE) - rounding - chord - interpolation
    # Coarse numbers may leave too little for it.
    blending = machine.smoothed(tolerance, left - LEAST_FIT * tolerance) or 0.0
    # rounded down to what is printed
    blending = math.floor(blending / MM_PER[unit] / step + 1e-9) * step * MM_PER[unit]
    fit = left - blending
    # Blending takes no more than leaves this, up to a rounding. A tolerance that a message has
    # named as the least is enough.
    if left < (LEAST_FIT - SLACK) * tolerance and rounding > ROUNDING_SHARE * tolerance:
        least = rounding / (left + rounding - LEAST_FIT * tolerance) * tolerance
        message = f"{decimals} decimals in a program are too coarse"
        raise ToleranceError(message, tolerance, least)
    if fit <= 0.0:
        raise ToleranceError(
            "nothing of the tolerance is left for the fit", tolerance, tolerance - fit
        )
    return Budget(tolerance, decimals, rounding, chord, blending, fit, interpolation, arcs)
