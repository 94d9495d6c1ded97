"""All measurements of one design."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from decimal import Decimal
from typing import TYPE_CHECKING, Final

from camgeo.accuracy.bill import BillRow, bill_rows
from camgeo.accuracy.contours import NOT_WRITTEN, Progress, contour_rows, file_cost, reason
from camgeo.accuracy.knee import Knee, knee_of
from camgeo.accuracy.rows import (
    EFFORTS,
    FORMS,
    ContourRow,
    EffectRow,
    SolidRow,
    TableRow,
    in_length,
)
from camgeo.accuracy.tables import STEPS, table_rows
from camgeo.contour.contour import Effort, Form
from camgeo.design import Design
from camgeo.formats.dxf import FORMAT
from camgeo.scene.scene import Scene
from camgeo.units import MM_PER, LengthUnit

if TYPE_CHECKING:
    from camgeo.accuracy.benefit import BenefitRow

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
    complete: bool = True,
    bill: bool = False,
    benefits: Sequence[BenefitRow] = (),
    timed: bool = True,
    progress: Progress = lambda _: None,
) -> Survey:
    """Measure `design` at `tolerances` [mm], and its value table at `steps` [degrees].

    Parameters
    ----------
    ripple : whether the contours are also replayed.
    complete : whether not only the contour that the scene asks for is measured, but all forms and
        fits, programs, solids, value tables and effects.
    bill : whether all files are also built.
    benefits : what the contours do at one speed of the cam, if that is known.
    timed : whether seconds of computing matter; else contours are made once, and the knee does not
        depend on them.
    progress : called with the name of each step.

    Raises
    ------
    UndercutError
        If the cam has no outline.
    GeometryError
        If the part is impossible.
    """
    form, effort = own_contour(design.scene)
    forms, efforts = (FORMS, EFFORTS) if complete else ((form,), (effort,))
    contours = contour_rows(
        design, tolerances, ripple=ripple, progress=progress, forms=forms, efforts=efforts,
        programs=complete, timed=timed,
    )  # fmt: skip
    effects: tuple[EffectRow, ...] = ()
    if complete and design.scene.effects:
        from camgeo.accuracy.effects import effect_rows  # few scenes name an effect

        effects = effect_rows(design, progress=progress)
    return Survey(
        contours,
        solid_rows(design, tolerances, progress=progress) if complete else (),
        table_rows(design, steps, progress=progress) if complete else (),
        knee_of(
            own_rows(design.scene, contours),
            [row for row in benefits if row.form == form],
            timed=timed,
        ),
        tuple(row for row in effects if not row.rounded),
        tuple(row for row in effects if row.rounded),
        bill_rows(design, tolerances, progress=progress) if bill else (),
    )


def own_contour(scene: Scene) -> tuple[Form, Effort]:
    """Form and fit of the contour in the drawing of a scene."""
    return scene.output.options[FORMAT].form, scene.output.fit


def own_rows(scene: Scene, rows: Sequence[ContourRow]) -> tuple[ContourRow, ...]:
    """Those of the contour in the drawing of a scene."""
    return tuple(row for row in rows if (row.form, row.effort) == own_contour(scene))


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
                if tolerance == tolerances[0]:
                    file_cost(design.disc, name, tolerance, runs=1)
                rows.append(SolidRow(name, tolerance, file_cost(design.disc, name, tolerance)))
            except NOT_WRITTEN as error:
                rows.append(SolidRow(name, tolerance, fault=reason(error)))
    return tuple(rows)
