"""What a scene says of the spectra it asks for."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True, slots=True)
class Spec:
    """What the scene says.

    Attributes
    ----------
    highest_ratio : up to which the spectrum is looked at.
    damping : damping ratio of the train.
    """

    highest_ratio: float = 10.0
    damping: float = 0.0


def parse(table: Mapping[str, Any]) -> Spec:
    """From the table of the scene."""
    return Spec(table.get("highest_ratio", 10.0), table.get("damping", 0.0))
