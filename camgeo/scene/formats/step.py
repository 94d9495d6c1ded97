"""STEP: the part as a solid for CAD programs."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Final, Literal

from camgeo.numeric.checked import one_of
from camgeo.record import schema_beside
from camgeo.scene.formats.format import BODY, Format

WALLS: Final = ("arcs", "spline")
"""What upright faces may follow."""


@dataclass(frozen=True, slots=True)
class StepSpec:
    """`[output.step]`: what the walls of the solid are.

    Attributes
    ----------
    walls : "arcs" (cylinders and planes) or "spline" (cubic splines drawn out along the axis;
        dwells and turns stay cylinders).
    """

    walls: Literal["arcs", "spline"] = "arcs"

    def __post_init__(self) -> None:
        one_of("output.step.walls", self.walls, WALLS)


def parse(table: Mapping[str, Any]) -> StepSpec:
    """The options of the table."""
    return StepSpec(**table)


NEEDS, RULES = BODY

FORMAT: Final = Format("step", ".step", parse, schema_beside(__file__), ("follower", *NEEDS), RULES)
