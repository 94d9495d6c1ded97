"""Decisions of fits that the last digits of deviations do not change.

These digits depend on the processor: numpy, BLAS and the C library choose their kernels by what it
can do, and a deviation is a small difference of large coordinates. Rounds that move joints until
deviations are equal would carry them on, multiplied, into the places of joints.
"""

from __future__ import annotations

from typing import Final

import numpy as np

from camgeo.numeric.arrays import BoolArray, FloatArray

STEP: Final = 2.0**-10
"""Step in which logarithms of deviations are compared. Digits differ by some 1e-11 at a tolerance
of 1e-3 mm, so they hardly ever fall into different steps; and being uneven by half a step costs no
piece."""

CLEARLY: Final = 1.0 - 2.0**-20
"""A deviation below this fraction of another one is less. Of two that are equal to rounding, as of
mirror images, neither is less."""


def in_steps(logarithms: FloatArray) -> FloatArray:
    """(n,) multiples of `STEP`, the nearest to `logarithms` (n,)."""
    found: FloatArray = np.rint(logarithms / STEP) * STEP
    return found


def clearly_less(found: FloatArray, best: FloatArray) -> BoolArray:
    """(n,) whether a deviation `found` is less than `best`, which may be infinite."""
    less: BoolArray = found < CLEARLY * best
    return less
