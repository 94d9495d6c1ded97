"""The knee as pictures of what accuracy costs show it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from camgeo.accuracy.knee import advice
from camgeo.accuracy.survey import Survey
from camgeo.units import RPM

if TYPE_CHECKING:
    from camgeo.accuracy.benefit import BenefitRow


@dataclass(frozen=True, slots=True)
class Marked:
    """The knee as it is drawn: its tolerance [mm], its name, and its reason in words."""

    tolerance: float
    name: str
    reason: str


def marked(survey: Survey, benefits: Sequence[BenefitRow]) -> Marked | None:
    """The knee of the benefits, of one form, if they have one, else that of the costs, or None."""
    if benefits:
        from camgeo.accuracy.enough import enough, words  # a survey without a speed needs none

        found = enough(benefits)
        if found is not None:
            name = f"enough at {found.row.speed / RPM:g} rev/min"
            return Marked(found.row.tolerance, name, words(found))
    if survey.knee is None:
        return None
    return Marked(survey.knee.row.tolerance, "advice", advice(survey.knee))
