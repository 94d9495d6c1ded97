"""DXF: the drawing."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Annotated, Final, Literal

from camgeo.numeric.checked import CheckedFields, Truth, instance_from_table, one_of
from camgeo.record import stored_schema
from camgeo.scene.formats.format import Format

if TYPE_CHECKING:
    from camgeo.geometry.contour.contour import Form

SINGLE: Final = "lines-and-arcs"

Entity = Literal["arcs", "lines-and-arcs", "polyline", "spline"]

ENTITIES: Final = ("arcs", SINGLE, "polyline", "spline")
"""The entities that curves are drawn as."""


@dataclass(frozen=True, slots=True)
class DxfSpec(CheckedFields, path="output.dxf."):
    """`[output.dxf]`: how curves are drawn, and what is drawn in addition to the part.

    Attributes
    ----------
    entity : "arcs" (polylines of lines and arcs), "lines-and-arcs" (the same as single entities),
        "polyline" (straight pieces only) or "spline" (cubic splines; dwells and turns stay arcs).
    auxiliary : whether pitch curve, base circle and centre mark are drawn too, on their own layers.
    """

    entity: Annotated[Entity, partial(one_of, choices=ENTITIES)] = "arcs"
    auxiliary: Truth = True

    @property
    def form(self) -> Form:
        """Form of the contours: single lines and arcs are those of a polyline."""
        return "arcs" if self.entity == SINGLE else self.entity


FORMAT: Final = Format(
    "dxf", ".dxf", partial(instance_from_table, DxfSpec), stored_schema(__file__), ("follower",)
)
