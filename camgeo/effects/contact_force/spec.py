"""What a scene says of the contact force."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Final

from camgeo.effects.results import GRAVITY, INERTIA, LOAD, SPRING

FORCES: Final = (INERTIA, GRAVITY, LOAD, SPRING)
"""Effects that are forces on the follower, besides friction."""


@dataclass(frozen=True, slots=True)
class Spec:
    """What the scene says: `limit` is the largest force allowed [N], None for none."""

    limit: float | None = None


def parse(table: Mapping[str, Any]) -> Spec:
    """From the table of the scene."""
    return Spec(table.get("limit"))
