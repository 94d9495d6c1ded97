"""How the tolerance of a program is shared among all that moves the cutter off its path."""

from __future__ import annotations

import math
from dataclasses import dataclass

from camgeo.errors import ToleranceError
from camgeo.toolpath.machine import MOST_DECIMALS, Machine
from camgeo.units import MM_PER, LengthUnit

ROUNDING_SHARE = 0.3
"""Share of the tolerance for printed numbers; it decides the number of decimals: four at 1 um."""

ROUNDING_UNITS = 3.0
"""Deviation by rounding, in units of the last decimal: end points and centre each move by at most
half a diagonal, 0.71, and the radii at an arc's two ends then differ by at most 1.42."""

CHORD_SHARE = 0.05
"""Share of the tolerance for arcs that are written as chords: nearly straight ones, and those whose
radius the machine does not accept."""

PROOF_SHARE = 0.05
"""Share of the tolerance left for the slack of the bound by which the program is measured."""


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
    """

    tolerance: float
    decimals: int
    rounding: float
    chord: float
    blending: float
    fit: float
    interpolation: float = 0.0


def budget(machine: Machine, unit: LengthUnit, tolerance: float) -> Budget:
    """The shares of `tolerance` [mm] on `machine`."""
    finest = ROUNDING_SHARE * tolerance / (ROUNDING_UNITS * MM_PER[unit])
    decimals = max(machine.least_decimals(unit), math.ceil(-math.log10(finest)))
    if decimals > MOST_DECIMALS:
        least = ROUNDING_UNITS * MM_PER[unit] / 10.0**MOST_DECIMALS / ROUNDING_SHARE
        message = f"a program of {MOST_DECIMALS} decimals is too coarse"
        raise ToleranceError(message, tolerance, least)
    step = 10.0**-decimals
    rounding = ROUNDING_UNITS * step * MM_PER[unit]
    chord = CHORD_SHARE * tolerance
    blending = machine.blending.share * tolerance
    if blending < machine.blending.smallest * (1.0 - 1e-9):
        blending = 0.0
    # rounded down to what is printed
    blending = math.floor(blending / MM_PER[unit] / step + 1e-9) * step * MM_PER[unit]
    interpolation = machine.arcs.interpolation
    fit = tolerance * (1.0 - PROOF_SHARE) - rounding - chord - blending - interpolation
    if fit <= 0.0:
        raise ToleranceError("no share is left for the fit", tolerance, tolerance - fit)
    return Budget(tolerance, decimals, rounding, chord, blending, fit, interpolation)
