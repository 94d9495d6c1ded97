"""What a scene says of the contact that is to be kept."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True, slots=True)
class Spec:
    """What the scene says.

    Attributes
    ----------
    margin : contact force that has to remain [N].
    backlash : clearance of the roller in a groove, or between two discs the play of the roller that
        comes to carry, along its normal [mm]; None if it is the scene's side clearance.
    """

    margin: float = 0.0
    backlash: float | None = None


def parse(table: Mapping[str, Any]) -> Spec:
    """From the table of the scene."""
    return Spec(table.get("margin", 0.0), table.get("backlash"))
