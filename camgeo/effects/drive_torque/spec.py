"""What a scene says of the torque on the camshaft."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True, slots=True)
class Spec:
    """The table.

    Attributes
    ----------
    limit : largest torque allowed [N mm]; None if there is none.
    fluctuation : allowed fluctuation of the speed, for the flywheel; None if none is sought.
    """

    limit: float | None
    fluctuation: float | None


def parse(table: Mapping[str, Any]) -> Spec:
    """The table of the scene."""
    return Spec(table.get("limit"), table.get("fluctuation"))
