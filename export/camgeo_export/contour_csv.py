"""CSV of a contour: x, y and, if a heading names it, bulge; one vertex per row.

It is a table as `camgeo.numeric.columns` reads them all, with x and y as those of measured points.
The bulge is tan(sweep/4) of the piece that starts at the row, positive counter-clockwise, as in
DXF; a third column without a heading may as well be z. The last piece leads back to the first row.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Final

import numpy as np

from camgeo.errors import FileError, GeometryError
from camgeo.geometry.contour.contour import Contour
from camgeo.geometry.contour.foreign import Outlines
from camgeo.numeric.columns import NumberColumn, RequestedColumns, read_columns
from camgeo.studies.inspection import LENGTHS, measured_points
from camgeo.units import LengthUnit, counted

FEWEST: Final = 2
"""Two rows with bulges are a lens or a circle."""

COLUMNS: Final = RequestedColumns(LENGTHS, (NumberColumn("bulge", ("bulge",)),), FEWEST, named=True)


class ContourCsvReader:
    """Reads a contour from CSV."""

    def read(
        self,
        data: bytes,
        name: str,
        *,
        layer: str | None,
        unit: LengthUnit | None,
        gap: float,
        progress: Callable[[str], object] = lambda _: None,
    ) -> Outlines:
        """The only contour [mm], counter-clockwise; `unit` of a file that states none, mm if None.

        Raises FileError, with `name` and line, for anything not allowed.
        """
        if layer is not None:
            raise FileError(f"{name}: a CSV file has no layers; leave out the layer {layer!r}")
        try:
            rows = read_columns(data, name, COLUMNS)
            vertices = measured_points(rows, name, unit or "mm")
        except GeometryError as error:
            raise FileError(error.message) from None
        bulge = rows.values[2] if len(rows.values) > len(LENGTHS) else np.zeros(len(vertices))
        distinct = vertices != np.roll(vertices, -1)
        if not distinct[-1]:  # the first point repeated at the end closes the contour
            vertices, bulge, distinct = vertices[:-1], bulge[:-1], distinct[:-1]
        if not np.all(distinct):
            line = rows.lines[int(np.flatnonzero(~distinct)[0]) + 1]
            raise FileError(f"{name}, line {line}: the same point as in the previous row")
        if len(vertices) < FEWEST or (len(vertices) == FEWEST and not np.any(bulge)):
            raise FileError(
                f"{name}: {counted(len(vertices), 'point')} enclose nothing; give at least three"
            )
        contour = Contour.through(vertices, 4.0 * np.arctan(bulge))
        if contour.area == 0.0:
            raise FileError(f"{name}: the points enclose no area")
        return Outlines((contour.counter_clockwise(),))


READER = ContourCsvReader()
