"""The numerical effects of a design over their tolerance: computing time and error.

Every figure, that is the value of each finding and each column over a turn, is compared with that
of a computation to a tolerance at least `TIGHTER` times as small. What a result states as its error
holds if no figure is off by more.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from camgeo.accuracy.clock import repeated
from camgeo.accuracy.contours import Progress, reason
from camgeo.accuracy.rows import EffectRow
from camgeo.design import Design
from camgeo.effects.effect import Bound, Column, Result
from camgeo.errors import EffectError, GeometryError, ToleranceError
from camgeo.numeric.arrays import FloatArray
from camgeo.numeric.rounding import SHARE
from camgeo.units import TURN

TOLERANCES: Final = (1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10)
"""Tolerances measured, see `camgeo.effects.effect.Bound`."""

TIGHTER: Final = 100.0
"""Factor from the tolerance of the reference to those of the rows compared with it."""

ROUNDED: Final = 1e-11
"""Errors up to this share are those of rounding, which no tolerance changes: some thousand
roundings, as many as a chain of motion, mechanism, forces and a sum over the turn has."""

ANGLES: Final = 720
"""Cam angles over a turn at which columns are compared."""

OFFSET: Final = 0.381966
"""Offset of the first of these angles from 0, as a fraction of their spacing: the ends of a motion,
where a quantity may jump, are hardly ever among them."""

Figures = dict[str, FloatArray]
"""The values of findings, in order, and of columns over the turn, by name."""


@dataclass(frozen=True, slots=True)
class Off:
    """How far a figure is off.

    Attributes
    ----------
    figure : name of the finding or column.
    off : from the reference, in the unit of the figure.
    bound : what the result states.
    """

    figure: str
    off: float
    bound: Bound

    @property
    def share(self) -> float:
        """Relative to the scale of the figure."""
        return Bound(self.off, self.bound.scale).share

    @property
    def holds(self) -> bool:
        """Whether the figure is off by no more than stated."""
        return self.off <= self.bound.error


def effect_rows(
    design: Design, tolerances: Sequence[float] = TOLERANCES, *, progress: Progress
) -> tuple[EffectRow, ...]:
    """Rows of the numerical effects that the scene names.

    One for each of `tolerances`, the loosest first; a row states why it has no answer. An effect
    that reaches rounding at the loosest tolerance has this row alone, see `EffectRow.rounded`.
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
    reference = _reference(design, name, tolerances, progress)
    rows: list[EffectRow] = []
    for tolerance in tolerances:
        progress(f"{name}, {tolerance:g}")
        row, result = _row(design, name, tolerance)
        if result is not None and reference is not None and reference[0] * TIGHTER <= tolerance:
            row = _compared(row, result, reference[1])
        if row.rounded and not rows:
            return [row]
        rows.append(replace(row, rounded=False))
    return rows


def _reference(
    design: Design, name: str, tolerances: Sequence[float], progress: Progress
) -> tuple[float, Result] | None:
    """The most accurate result, with its tolerance; None if there is no answer.

    It is `TIGHTER` than the tightest of `tolerances`, or what rounding leaves of that. Computing it
    first keeps what does not depend on the tolerance out of the times of the rows.
    """
    tightest = tolerances[-1]
    for tolerance in (tightest / TIGHTER, tightest, *reversed(tolerances[:-1])):
        progress(f"{name}, reference to {tolerance:g}")
        try:
            return tolerance, _result(design, name, tolerance)
        except (EffectError, GeometryError, ToleranceError):  # which a row will state
            continue
    return None


def _result(design: Design, name: str, tolerance: float) -> Result:
    """The effect recomputed; the effects that it depends on are computed only once."""
    result: Result = design.effects.recomputed(name, tolerance).result(name)
    return result


def _row(design: Design, name: str, tolerance: float) -> tuple[EffectRow, Result | None]:
    """A row without its difference, and the result."""
    row = EffectRow(name, tolerance)
    try:
        result, timing = repeated(
            lambda clock: clock.step(name, lambda: _result(design, name, tolerance))
        )
    except (EffectError, GeometryError, ToleranceError) as error:
        return replace(row, fault=reason(error)), None
    return replace(
        row, seconds=timing.seconds[name], error=result.error, spread=timing.spread
    ), result


def _compared(row: EffectRow, result: Result, reference: Result) -> EffectRow:
    """The row with the differences; a figure that is off by more than stated is a fault."""
    found = compared(result, reference)
    wrong = [each.figure for each in found if not each.holds]
    largest = max(found, key=lambda each: each.share, default=None)
    off = None if largest is None else largest.share
    return replace(
        row,
        difference=off,
        figure="" if largest is None or not off else largest.figure,
        rounded=max(off or 0.0, row.error or 0.0) <= ROUNDED and not wrong,
        fault=f"off by more than estimated: {', '.join(wrong)}" if wrong else "",
    )


def compared(result: Result, reference: Result) -> tuple[Off, ...]:
    """All figures that both results have, with their differences.

    A figure without an error is exact to rounding, `camgeo.numeric.rounding.SHARE` of its largest
    magnitude.
    """
    own, best = figures_of(result), figures_of(reference)
    found = []
    for name, values in own.items():
        if name not in best or best[name].shape != values.shape:
            continue
        size = float(max(np.max(np.abs(values)), np.max(np.abs(best[name]))))
        bound = result.errors.get(name, Bound(SHARE * size, size))
        found.append(Off(name, float(np.max(np.abs(values - best[name]))), bound))
    return tuple(found)


def figures_of(result: Result) -> Figures:
    """All figures of a result."""
    found: dict[str, list[float]] = {}
    for finding in result.findings:
        if finding.value is not None:
            found.setdefault(finding.name, []).append(finding.value)
    figures = {name: np.array(values, dtype=np.float64) for name, values in found.items()}
    return figures | {column.name: _sampled(column) for column in result.columns}


def _sampled(column: Column) -> FloatArray:
    phi: FloatArray = (np.arange(ANGLES, dtype=np.float64) + OFFSET) * (TURN / ANGLES)
    return column.values(phi, "right")
