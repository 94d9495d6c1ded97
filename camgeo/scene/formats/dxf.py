"""DXF: the drawing."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final, Literal

from camgeo.numeric.checked import instance, one_of
from camgeo.record import schema_beside
from camgeo.scene.formats.format import Format

if TYPE_CHECKING:
    from camgeo.geometry.contour.contour import Form

SINGLE: Final = "lines-and-arcs"

Entity = Literal["arcs", "lines-and-arcs", "polyline", "spline"]

ENTITIES: Final = ("arcs", SINGLE, "polyline", "spline")
"""The entities that curves are drawn as."""


@dataclass(frozen=True, slots=True)
class DxfSpec:
    """`[output.dxf]`: how curves are drawn, and what is drawn in addition to the part.

    Attributes
    ----------
    entity : "arcs" (polylines of lines and arcs), "lines-and-arcs" (the same as single entities),
        "polyline" (straight pieces only) or "spline" (cubic splines; dwells and turns stay arcs).
    auxiliary : whether pitch curve, base circle and centre mark are drawn too, on their own layers.
    """

    entity: Entity = "arcs"
    auxiliary: bool = True

    def __post_init__(self) -> None:
        one_of("output.dxf.entity", self.entity, ENTITIES)
        instance("output.dxf.auxiliary", self.auxiliary, bool, "true or false")

    @property
    def form(self) -> Form:
        """Of the contours: single lines and arcs are the arcs of a polyline."""
        return "arcs" if self.entity == SINGLE else self.entity


def parse(table: Mapping[str, Any]) -> DxfSpec:
    """The options of the table."""
    return DxfSpec(**table)


FORMAT: Final = Format("dxf", ".dxf", parse, schema_beside(__file__), ("follower",))
