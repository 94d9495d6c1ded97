"""The value table of a design over its step: rows, bytes, and the error of interpolation.

Between two rows a step h apart a lift s with a continuous velocity departs from its chord by at
most max|s''| h^2/8. A jump j of the velocity at the distance x after a row adds j x (h - x)/h.
"""

from __future__ import annotations

from collections.abc import Sequence
from decimal import Decimal
from functools import partial
from typing import Final

import numpy as np

from camgeo.accuracy.clock import Clock, repeated
from camgeo.accuracy.contours import Progress
from camgeo.accuracy.rows import TableRow
from camgeo.design import Design
from camgeo.motion.motion import Motion
from camgeo.numeric.arrays import FloatArray, ascending
from camgeo.product.value_table import cam_angles
from camgeo.units import TURN

STEPS: Final = tuple(
    Decimal(text) for text in ("10", "5", "2", "1", "0.5", "0.2", "0.1", "0.05", "0.02", "0.01")
)
"""Steps measured [degrees]."""

CELL: Final = np.radians(0.05)
"""Largest cell [rad] over which |s''| is bounded. The bound exceeds the largest value in the cell
by the change of s'' over half of it: some thousandths of the peak of a law of 40 degrees."""


def table_rows(
    design: Design, steps: Sequence[Decimal], *, progress: Progress
) -> tuple[TableRow, ...]:
    """One row per step [degrees]; the lift is that of the motion plan.

    The effects that columns are of are computed before, as no step changes them.
    """
    if steps:
        design.tabulated.table(max(steps))
    rows = []
    for step in steps:
        progress(f"value table, {step} degrees")

        def made(step: Decimal = step) -> tuple[int, int]:
            table = design.tabulated.table(step)
            return len(table.values), len(table.encoded())

        (count, size), timing = repeated(partial(Clock.step, name="table", work=made))
        error = interpolation_error(design.scene.plan, np.radians(cam_angles(step)))
        rows.append(TableRow(step, count, size, timing.seconds["table"], error, timing.spread))
    return tuple(rows)


def interpolation_error(motion: Motion, phi: FloatArray) -> float:
    """Bound [mm or rad] of |s - chord| over a turn, chords between the rows `phi`.

    Parameters
    ----------
    motion : whose lift is interpolated.
    phi : (n,) [rad] ascending in [0, 2 pi), the first 0; the last chord ends at 2 pi.
    """
    rows = np.append(phi, TURN)
    parts = max(1, int(np.ceil(np.max(np.diff(rows)) / CELL)))
    shares = np.arange(parts) / parts
    cuts = (rows[:-1, None] + np.diff(rows)[:, None] * shares).ravel()
    borders = motion.borders[(motion.borders > 0.0) & (motion.borders < TURN)]
    cuts = ascending(np.concatenate((cuts, borders, [TURN])))
    low, high = cuts[:-1], cuts[1:]
    _, bounds = motion.jet_and_bounds(low, high)
    # Each cell lies in one chord, as the rows are among the cuts.
    chord = np.clip(np.searchsorted(rows, 0.5 * (low + high), side="right") - 1, 0, len(phi) - 1)
    largest = np.zeros(len(phi))
    np.maximum.at(largest, chord, bounds[2])
    steps = np.diff(rows)
    errors = largest * steps**2 / 8.0
    kinks = motion.breaks[(motion.breaks > 0.0) & (motion.breaks < TURN)]
    if len(kinks):
        jumps = np.abs(motion.jet(kinks, "right", 1)[1] - motion.jet(kinks, "left", 1)[1])
        place = np.clip(np.searchsorted(rows, kinks, side="right") - 1, 0, len(phi) - 1)
        behind = kinks - rows[place]
        np.add.at(errors, place, jumps * behind * (steps[place] - behind) / steps[place])
    return float(np.max(errors))
