"""The numerical effects of a design over their tolerance: computing time and error."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any, Final

import numpy as np

from camgeo.accuracy.contours import Progress, reason, timed
from camgeo.accuracy.rows import EffectRow
from camgeo.design import Design
from camgeo.effects.effect import Column, Result
from camgeo.errors import EffectError, GeometryError, ToleranceError
from camgeo.numeric.arrays import FloatArray
from camgeo.units import TURN

TOLERANCES: Final = (1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10)
"""Tolerances measured, relative to the largest magnitude of an effect's results."""

ANGLES: Final = 720
"""Cam angles over a turn at which the results are compared."""

OFFSET: Final = 0.381966
"""Offset of the first of these angles from 0, as a fraction of their spacing: the ends of a motion,
where a quantity may jump, are hardly ever among them."""

Values = dict[str, FloatArray]
"""Quantities to compare, by unit."""


def effect_rows(
    design: Design, tolerances: Sequence[float] = TOLERANCES, *, progress: Progress
) -> tuple[EffectRow, ...]:
    """One row per numerical effect that the scene names and per tolerance of `tolerances`.

    A row states why it has no answer.
    """
    rows: list[EffectRow] = []
    for name in design.scene.effects:
        if design.effects.effect(name).numerical:
            rows += _rows(design, name, sorted(tolerances, reverse=True), progress)
    return tuple(rows)


def _rows(
    design: Design, name: str, tolerances: Sequence[float], progress: Progress
) -> list[EffectRow]:
    """The rows of one effect, the loosest first."""
    rows, found = [], []
    _warm(design, name, tolerances[0])
    for tolerance in tolerances:
        progress(f"{name}, {tolerance:g}")
        row, values = _row(design, name, tolerance)
        rows.append(row)
        found.append(values)
    best = max((k for k, values in enumerate(found) if values is not None), default=0)
    return [
        row if k == best else replace(row, difference=difference(values, found[best]))
        for k, (row, values) in enumerate(zip(rows, found, strict=True))
    ]


def _result(design: Design, name: str, tolerance: float) -> Result:
    """The effect recomputed; the effects that it depends on are computed only once."""
    result: Result = design.effects.recomputed(name, tolerance).result(name)
    return result


def _warm(design: Design, name: str, tolerance: float) -> None:
    """Compute what does not depend on a tolerance, so that its time is in no row."""
    try:
        _result(design, name, tolerance)
    except (EffectError, GeometryError, ToleranceError):  # which the row will state
        return


def _row(design: Design, name: str, tolerance: float) -> tuple[EffectRow, Values | None]:
    """A row without its difference, and the quantities from which that is computed."""
    row = EffectRow(name, tolerance)
    try:
        result, seconds = timed(lambda: _result(design, name, tolerance))
        values = compared(result)
    except (EffectError, GeometryError, ToleranceError) as error:
        return replace(row, fault=reason(error)), None
    return replace(row, seconds=seconds, error=result.error), values


def compared(result: Result) -> Values:
    """The quantities to compare: the first column, else the values of the findings."""
    if result.columns:
        return {result.columns[0].unit: _sampled(result.columns[0])}
    found: dict[str, list[float]] = {}
    for finding in result.findings:
        if finding.value is not None:
            found.setdefault(finding.unit, []).append(finding.value)
    return {unit: np.array(values, dtype=np.float64) for unit, values in found.items()}


def _sampled(column: Column) -> FloatArray:
    phi: FloatArray = (np.arange(ANGLES, dtype=np.float64) + OFFSET) * (TURN / ANGLES)
    return column.values(phi, "right")


def difference(values: Values | None, best: Values | None) -> float | None:
    """Largest difference, relative to the largest magnitude among quantities of the same unit.

    None if there is nothing to compare, or if the results hold different quantities.
    """
    if not values or best is None or _shapes(values) != _shapes(best):
        return None
    shares = [_share(values[unit], best[unit]) for unit in values]
    return max(shares)


def _shapes(values: Values) -> dict[str, Any]:
    return {unit: array.shape for unit, array in values.items()}


def _share(values: FloatArray, best: FloatArray) -> float:
    scale = max(float(np.max(np.abs(best))), float(np.max(np.abs(values))))
    return float(np.max(np.abs(values - best))) / scale if scale > 0.0 else 0.0
