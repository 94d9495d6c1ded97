"""The solids of a design over the tolerance: triangles, bytes, seconds."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

from camgeo.accuracy.contours import Tell, file_cost, reason
from camgeo.accuracy.rows import SolidRow
from camgeo.design import Design
from camgeo.errors import GeometryError, ToleranceError

SOLIDS: Final = ("stl", "3mf")
"""Names of the writers."""


def solid_rows(design: Design, tolerances: Sequence[float], *, tell: Tell) -> tuple[SolidRow, ...]:
    """A row for each format and tolerance [mm]; none if the part has no thickness."""
    if not design.drawn.part.thickness:
        return ()
    rows = []
    for name in SOLIDS:
        for tolerance in tolerances:
            tell(f"{name}, {tolerance:g} mm")
            try:
                rows.append(SolidRow(name, tolerance, file_cost(design.disc, name, tolerance)))
            except (ToleranceError, GeometryError) as error:
                rows.append(SolidRow(name, tolerance, fault=reason(error)))
    return tuple(rows)
