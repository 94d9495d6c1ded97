"""CSV of a contour: x, y and, if there are arcs, bulge; one vertex per row.

The bulge is tan(sweep/4) of the piece that starts at the row, positive counter-clockwise, as in
DXF. The last piece leads back to the first row. A header and lines that begin with # are allowed.
"""

from __future__ import annotations

import numpy as np

from camgeo.contour.contour import Contour
from camgeo.reading import CONTOUR, check_text
from camgeo.units import MM_PER, LengthUnit
from camgeo.wording import counted
from camgeo_export.errors import FileError, finite

HEADERS = (("x", "y"), ("x", "y", "bulge"))

FEWEST = 2
"""Two rows with bulges are a lens or a circle."""


class ContourCsvReader:
    """Reads a contour from CSV."""

    def read(
        self, data: bytes, name: str, *, layer: str | None, unit: LengthUnit | None, gap: float
    ) -> tuple[Contour, ...]:
        """The only contour [mm], counter-clockwise; `unit` is that of the file, mm if None.

        Raises FileError, with `name` and line, for anything not allowed.
        """
        if layer is not None:
            raise FileError(f"{name}: a CSV file has no layers; leave out the layer {layer!r}")
        rows = _rows(data, name)
        x, y, bulge = np.array([row for _, row in rows]).T
        vertices = (x + 1j * y) * MM_PER[unit or "mm"]
        apart = vertices != np.roll(vertices, -1)
        if not apart[-1]:  # the first point repeated at the end closes the contour
            vertices, bulge, apart = vertices[:-1], bulge[:-1], apart[:-1]
        if not np.all(apart):
            line = rows[int(np.flatnonzero(~apart)[0]) + 1][0]
            raise FileError(f"{name}, line {line}: the same point as in the previous row")
        if len(vertices) < FEWEST or (len(vertices) == FEWEST and not np.any(bulge)):
            raise FileError(
                f"{name}: {counted(len(vertices), 'point')} enclosing nothing; give three or more"
            )
        contour = Contour.through(vertices, 4.0 * np.arctan(bulge))
        if contour.area == 0.0:
            raise FileError(f"{name}: the points enclose no area")
        return (contour.counter_clockwise(),)


def _rows(data: bytes, name: str) -> list[tuple[int, list[float]]]:
    """Line numbers and x, y, bulge of the rows."""
    check_text(data, CONTOUR, name)
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError:
        raise FileError(f"{name}: is not UTF-8 text") from None
    rows: list[tuple[int, list[float]]] = []
    width = 0
    for line, written in enumerate(text.splitlines(), start=1):
        if not written.strip() or written.lstrip().startswith("#"):
            continue
        count = 1 + written.count(",")
        if width and count != width:
            raise FileError(
                f"{name}, line {line}: {counted(count, 'value')} where {width} are expected"
            )
        if count not in (2, 3):
            raise FileError(
                f"{name}, line {line}: {counted(count, 'column')}; allowed: x, y and x, y, bulge"
            )
        cells = [cell.strip() for cell in written.split(",")]
        if not width:
            width = count
            if tuple(cell.lower() for cell in cells) in HEADERS:
                continue
        rows.append((line, [finite(cell, name, line) for cell in cells] + [0.0] * (3 - width)))
    if not rows:
        raise FileError(f"{name}: holds no points; allowed: rows x, y and x, y, bulge")
    return rows


READER = ContourCsvReader()
