"""What `camgeo accuracy` finds: what accuracy costs, and where more of it stops paying off."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

from camgeo.accuracy import survey as surveys
from camgeo.accuracy.knee import advice
from camgeo.accuracy.survey import TOLERANCES, Survey
from camgeo.answers.answer import Answer
from camgeo.design import Design
from camgeo.scene.scene import Scene
from camgeo.units import MM_PER


@dataclass(frozen=True, slots=True)
class Accuracy(Answer):
    """What accuracy costs.

    Attributes
    ----------
    scene : whose cam was measured.
    survey : what was measured.
    ripple : whether contours were replayed too.
    turns : whether the positions of the motion are angles.
    """

    command: ClassVar[str] = "accuracy"

    scene: Scene
    survey: Survey
    ripple: bool
    turns: bool

    @property
    def advice(self) -> str:
        """What is recommended, in words."""
        return advice(self.survey.knee)

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
                "interpolation_error": self.shown(row.error),
                "unit": self.unit,
            }
            for row in self.survey.tables
        )


def accuracy(
    design: Design,
    tolerances: Sequence[float] = TOLERANCES,
    *,
    ripple: bool | None = None,
    bill: bool = False,
    progress: Callable[[str], None] = lambda _: None,
) -> Accuracy:
    """Measure what accuracy costs.

    Parameters
    ----------
    tolerances : to measure [mm], the loosest first.
    ripple : whether contours are replayed too; None for what the scene says.
    bill : whether the scene is also built within each of them.
    progress : called with the name of each step.

    Raises
    ------
    UndercutError, GeometryError
        As `camgeo.accuracy.survey.survey`.
    """
    if ripple is None:
        ripple = design.scene.output.accuracy_ripple
    found = surveys.survey(design, tolerances, ripple=ripple, bill=bill, progress=progress)
    return Accuracy(design.scene, found, ripple, design.drive.unit == "rad")
