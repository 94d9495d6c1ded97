"""Laws of motion that many tests use."""

from __future__ import annotations

from typing import Final

from camgeo.kinematics.laws import FAMILIES, make_law
from camgeo.kinematics.laws.law import Law

LAWS: Final[dict[str, Law]] = {
    name: make_law(name)
    for name, family in FAMILIES.items()
    if "R-R" in family.tasks and "inflection" in family.parameters["R-R"]
}
"""The symmetric laws from rest to rest that have an inflection point to be shifted."""
