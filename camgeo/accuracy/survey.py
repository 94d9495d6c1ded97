"""All measurements of one design."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from decimal import Decimal
from typing import Final

from camgeo.accuracy.bill import BillRow, bill_rows
from camgeo.accuracy.contours import Progress, contour_rows, file_cost, reason
from camgeo.accuracy.knee import Knee, knee_of
from camgeo.accuracy.rows import ContourRow, EffectRow, SolidRow, TableRow, in_length
from camgeo.accuracy.tables import STEPS, table_rows
from camgeo.design import Design
from camgeo.errors import FileError, GeometryError, ToleranceError
from camgeo.units import MM_PER, LengthUnit

TOLERANCES: Final = (1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6)
"""Default tolerances [mm]. One more decade multiplies straight pieces and triangles by 3.16, and
with them the time of the survey: two thirds of it would go into files of some 7 MB."""

SOLIDS: Final = ("stl", "3mf", "step")
"""Names of the writers of solids."""


@dataclass(frozen=True, slots=True)
class Survey:
    """The cost of accuracy.

    Attributes
    ----------
    contours, solids, tables : the measured rows.
    knee : beyond which more cost gains nothing; None if nothing could be reached.
    effects : rows of the numerical effects that the scene names and that a tolerance changes.
    rounded : a row for each of the others, which reach rounding at once.
    bill : whole builds; empty if they were not asked for.
    """

    contours: tuple[ContourRow, ...]
    solids: tuple[SolidRow, ...]
    tables: tuple[TableRow, ...]
    knee: Knee | None
    effects: tuple[EffectRow, ...] = ()
    rounded: tuple[EffectRow, ...] = ()
    bill: tuple[BillRow, ...] = ()

    def in_length(self, length: LengthUnit) -> Survey:
        """The same with tolerances and deviations of contours, solids and builds in a unit of
        length; the knee stays in mm.
        """
        mm = MM_PER[length]
        return replace(
            self,
            contours=tuple(in_length(row, mm) for row in self.contours),
            solids=tuple(in_length(row, mm) for row in self.solids),
            bill=tuple(in_length(row, mm) for row in self.bill),
        )


def survey(
    design: Design,
    tolerances: Sequence[float] = TOLERANCES,
    steps: Sequence[Decimal] = STEPS,
    *,
    ripple: bool = False,
    solids: bool = True,
    bill: bool = False,
    progress: Progress = lambda _: None,
) -> Survey:
    """Measure `design` at `tolerances` [mm] and its value table at `steps` [degrees].

    Parameters
    ----------
    ripple : whether the contours are also replayed.
    solids : whether solids are also written, if the part has a thickness.
    bill : whether all files are also built.
    progress : called with the name of each step.

    Raises
    ------
    UndercutError
        If the cam has no outline.
    GeometryError
        If the part is impossible.
    """
    contours = contour_rows(design, tolerances, ripple=ripple, progress=progress)
    bodies = solid_rows(design, tolerances, progress=progress) if solids else ()
    tables = table_rows(design, steps, progress=progress)
    effects = _effects(design, progress)
    return Survey(
        contours,
        bodies,
        tables,
        knee_of(contours),
        tuple(row for row in effects if not row.rounded),
        tuple(row for row in effects if row.rounded),
        bill_rows(design, tolerances, progress=progress) if bill else (),
    )


def solid_rows(
    design: Design, tolerances: Sequence[float], *, progress: Progress
) -> tuple[SolidRow, ...]:
    """One row per format and tolerance [mm]; none if the part has no thickness."""
    if not design.disc.drawn.part.thickness:
        return ()
    rows = []
    for name in SOLIDS:
        for tolerance in tolerances:
            progress(f"{name}, {tolerance:g} mm")
            try:
                rows.append(SolidRow(name, tolerance, file_cost(design.disc, name, tolerance)))
            except (ToleranceError, GeometryError, FileError) as error:
                rows.append(SolidRow(name, tolerance, fault=reason(error)))
    return tuple(rows)


def _effects(design: Design, progress: Progress) -> tuple[EffectRow, ...]:
    if not design.scene.effects:
        return ()
    from camgeo.accuracy.effects import effect_rows  # few scenes name an effect

    return effect_rows(design, progress=progress)
