"""STEP: the part as a solid for CAD programs."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from typing import Annotated, Final, Literal

from camgeo.numeric.checked import CheckedFields, instance_from_table, one_of
from camgeo.record import stored_schema
from camgeo.scene.formats.format import BODY, Format

WALLS: Final = ("arcs", "spline")
"""Curves that the upright faces may follow."""


@dataclass(frozen=True, slots=True)
class StepSpec(CheckedFields, path="output.step."):
    """`[output.step]`: what the walls of the solid are.

    Attributes
    ----------
    walls : "arcs" (cylinders and planes) or "spline" (cubic splines drawn out along the axis;
        dwells and turns stay cylinders).
    """

    walls: Annotated[Literal["arcs", "spline"], partial(one_of, choices=WALLS)] = "arcs"


NEEDS, RULES = BODY

FORMAT: Final = Format(
    "step",
    ".step",
    partial(instance_from_table, StepSpec),
    stored_schema(__file__),
    ("follower", *NEEDS),
    RULES,
)
