"""What `camgeo accuracy` finds: what accuracy costs, and where more of it stops paying off."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

from camgeo.accuracy import survey as surveys
from camgeo.accuracy.knee import advice, step_sentence
from camgeo.accuracy.rows import FORMS, ContourRow
from camgeo.accuracy.survey import TOLERANCES, Survey, own_contour, own_rows
from camgeo.answers.answer import Answer
from camgeo.contour.contour import Form
from camgeo.design import Design
from camgeo.scene.scene import Scene
from camgeo.units import MM_PER, RPM

if TYPE_CHECKING:
    from camgeo.accuracy.benefit import BenefitRow


@dataclass(frozen=True, slots=True)
class Accuracy(Answer):
    """What accuracy costs.

    Attributes
    ----------
    scene : whose cam was measured.
    survey : what was measured.
    ripple : whether contours were replayed too.
    turns : whether the positions of the motion are angles.
    complete : whether not only the contour that the scene asks for was measured.
    benefits : what each form does at one speed; empty if none was asked for.
    """

    command: ClassVar[str] = "accuracy"

    scene: Scene
    survey: Survey
    ripple: bool
    turns: bool
    complete: bool = True
    benefits: tuple[BenefitRow, ...] = ()

    @property
    def advice(self) -> str:
        """What is recommended, in words."""
        return advice(self.survey.knee)

    @property
    def step(self) -> str:
        """What the last step of accuracy up to there costs and buys, in words."""
        return step_sentence(self.survey.knee)

    @property
    def own(self) -> tuple[ContourRow, ...]:
        """The rows of the contour that the scene asks for."""
        return own_rows(self.scene, self.survey.contours)

    @property
    def enough(self) -> tuple[str, ...]:
        """Which of the tolerances is enough at the speed asked for, in words, for each form."""
        if not self.benefits:
            return ()
        from camgeo.accuracy.enough import of_each_form

        speed = self.benefits[0].speed / RPM
        return tuple(f"at {speed:g} rev/min: {each}" for each in of_each_form(self.benefits))

    @property
    def form(self) -> Form:
        """Of the contour in the drawing of the scene."""
        return own_contour(self.scene)[0]

    @property
    def unit(self) -> str:
        """Unit in which positions of the motion are shown."""
        return "deg" if self.turns else self.scene.unit

    def shown(self, lift: float) -> float:
        """A lift [mm or rad] in that unit."""
        return math.degrees(lift) if self.turns else lift / MM_PER[self.scene.unit]

    @property
    def tables(self) -> tuple[dict[str, Any], ...]:
        """The rows of value tables, with the errors of their lift in that unit."""
        return tuple(
            {
                "step_deg": row.step,
                "rows": row.rows,
                "bytes": row.size,
                "seconds": row.seconds,
                "spread": row.spread,
                "interpolation_error": self.shown(row.error),
                "unit": self.unit,
            }
            for row in self.survey.tables
        )

    @property
    def written(self) -> tuple[dict[str, Any], ...]:
        """What each form does at one speed, with accelerations in that unit."""
        return tuple(
            {
                "contour": row.form,
                "tolerance_mm": row.tolerance,
                "speed_rpm": row.speed / RPM,
                "acceleration": self._shown(row.acceleration),
                "exact_acceleration": self._shown(row.exact_acceleration),
                "jump": self._shown(row.jump),
                "unit": self.unit,
                "ripple": row.ripple,
                "force_N": row.force,
                "lowest_force_N": row.lowest,
                "highest_force_N": row.highest,
                "exact_lowest_force_N": row.exact_lowest,
                "exact_highest_force_N": row.exact_highest,
                "lift_off_rpm": _finite(row.lift_off),
                "exact_lift_off_rpm": _finite(row.exact_lift_off),
                "octaves": [self.shown(value) for value in row.octaves],
                "octave_error": self._shown(row.octave_error),
                "strongest_harmonic": row.strongest,
                "fault": row.fault,
            }
            for row in self.benefits
        )

    def _shown(self, value: float | None) -> float | None:
        return None if value is None else self.shown(value)


def _finite(speed: float | None) -> float | None:
    """[rev/min] of a speed [rad/s]; None for none, and for an infinite one."""
    return None if speed is None or math.isinf(speed) else speed / RPM


def accuracy(
    design: Design,
    tolerances: Sequence[float] = TOLERANCES,
    *,
    ripple: bool | None = None,
    complete: bool = True,
    bill: bool = False,
    speed: float | None = None,
    progress: Callable[[str], None] = lambda _: None,
) -> Accuracy:
    """Measure what accuracy costs.

    Parameters
    ----------
    tolerances : to measure [mm], the loosest first.
    ripple : whether contours are replayed too; None for what the scene says.
    speed : of the cam [rad/s] at which contours are judged by what they do; None for not.
    complete : whether all forms and fits of the contour are measured, and all other files, value
        tables and effects; else the contour that the scene asks for.
    bill : whether the scene is also built within each of them.
    progress : called with the name of each step.

    Raises
    ------
    UndercutError, GeometryError
        As `camgeo.accuracy.survey.survey`.
    """
    if ripple is None:
        ripple = design.scene.output.accuracy_ripple
    benefits: tuple[BenefitRow, ...] = ()
    if speed is not None:
        from camgeo.accuracy.benefit import benefit_rows  # a survey without a speed needs none

        forms = FORMS if complete else own_contour(design.scene)[:1]
        benefits = benefit_rows(design, tolerances, (speed,), forms=forms, progress=progress)
    found = surveys.survey(
        design, tolerances, ripple=ripple, complete=complete, bill=bill, benefits=benefits,
        progress=progress,
    )  # fmt: skip
    return Accuracy(design.scene, found, ripple, design.drive.unit == "rad", complete, benefits)
